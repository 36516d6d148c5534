//! `static`: the equilibrium.

use super::argument::{argument, limit};
use super::{AnalysisKind, Counted, Extent, Given, Kind, KindRow, Rows, Takes, Unplanned};

/// The state in which nothing moves and all loads balance; or the balance of a steady motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Static {
    /// The place from which the search begins. An angle of the cycle is held.
    pub at: Option<Extent>,
    /// Whether the motion that `start` and drives state continues.
    pub turning: bool,
}

pub(super) const ROW: KindRow = KindRow {
    name: "static",
    about: "the equilibrium at rest, or of a steady motion",
    also_called: &["statics", "equilibrium", "balance", "rest"],
    needs_cycle: None,
    arguments: &[
        argument(
            "at",
            Takes::Extent(Counted::ByCycle),
            "deg",
            &[limit(f64::is_finite, "finite")],
            "the angle of the cycle, which is held, or the moment; the start by default",
        ),
        argument(
            "turning",
            Takes::Switch,
            "",
            &[],
            "whether the stated motion continues, with its inertia and its films; at rest by default",
        ),
    ],
    apart: &[],
    plan,
};

fn plan(given: &Given) -> Result<AnalysisKind, Unplanned> {
    let at = given.extent("at");
    if matches!(at, Some(Extent::Time(time)) if time < 0.0) {
        return Err(Unplanned::Refused {
            argument: "at",
            title: "`at` must not be before the start",
            label: "this time is negative",
            help: "the run begins at 0 s; state a later time, or an angle of the cycle, which may be negative",
        });
    }
    Ok(AnalysisKind::Static(Static {
        at,
        turning: given.switch("turning"),
    }))
}

impl Kind for Static {
    fn rows(&self) -> Rows {
        Rows::State
    }
}
