//! `periodic`: whole cycles until the motion repeats.

use super::argument::{
    GRADIENTS, PLAIN_ANGLE, POSITIVE, RHO, START, STEP, TOLERANCE, argument, limit,
};
use super::{
    AnalysisKind, Extent, Given, Integration, Kind, KindRow, Limit, Named, Names, Rows, Start,
    Takes, Unplanned,
};

/// Defaults of `change` and `cycles`, and most cycles. Choices: a thousandth of a swing is not seen in a figure and is near the
/// errors of the usual tolerance. A motion that has not repeated after 40 cycles decays slowly, and the report states its
/// decay.
const PLAIN_CHANGE: f64 = 1e-3;
const PLAIN_CYCLES: u32 = 40;
const MOST_CYCLES: f64 = 1e5;

/// A transient that runs until the cycle repeats; its result is the last cycle.
#[derive(Clone, Debug, PartialEq)]
pub struct Periodic {
    /// Distance of the samples (rad of the cycle angle), shortened so that whole ones fill a cycle.
    pub sample: f64,
    /// Settings of its integration.
    pub integration: Integration,
    /// Largest change from cycle to cycle, and largest estimated distance to the limit, as a share of each
    /// channel's swing.
    pub change: f64,
    /// Most cycles.
    pub cycles: u32,
    /// Parameters by which the channels are differentiated.
    pub gradients: Vec<Named>,
}

pub(super) const ROW: KindRow = KindRow {
    name: "periodic",
    about: "the last cycle of a run that continues until the motion repeats",
    also_called: &[],
    needs_cycle: Some("runs cycle by cycle"),
    arguments: &[
        STEP,
        TOLERANCE,
        RHO,
        argument(
            "sample",
            Takes::Angle,
            "deg",
            POSITIVE,
            "the sampling interval, 0.5° by default",
        ),
        argument(
            "change",
            Takes::Number,
            "%",
            &[limit(
                |x| x > 0.0 && x < 1.0,
                "positive and below 1; 0.1 % is the default",
            )],
            "the largest change that counts as a repeat, 0.1 % of a peak-to-peak value by default",
        ),
        argument(
            "cycles",
            Takes::Count,
            "",
            &[
                Limit {
                    fits: |x| x >= 2.0,
                    due: "at least 2",
                    label_and_help: Some((
                        "too few to see one repeat",
                        "it is the number of cycles after which to give up; 40 is the default",
                    )),
                },
                limit(|x| x <= MOST_CYCLES, "at most 100000; 40 is the default"),
            ],
            "the number of cycles after which to give up, 40 by default",
        ),
        GRADIENTS,
        START,
    ],
    apart: &[],
    plan,
};

fn plan(given: &Given) -> Result<AnalysisKind, Unplanned> {
    Ok(AnalysisKind::Periodic(Periodic {
        sample: given.number("sample").unwrap_or(PLAIN_ANGLE),
        integration: given.integration(Start::Automatic),
        change: given.number("change").unwrap_or(PLAIN_CHANGE),
        // within its limits
        cycles: given.number("cycles").map_or(PLAIN_CYCLES, |x| x as u32),
        gradients: given.names("gradients").unwrap_or_default(),
    }))
}

impl Kind for Periodic {
    fn integration(&self) -> Option<&Integration> {
        Some(&self.integration)
    }

    fn integration_mut(&mut self) -> Option<&mut Integration> {
        Some(&mut self.integration)
    }

    fn sampling(&self) -> Option<(Extent, Option<Extent>)> {
        Some((Extent::Angle(self.sample), None))
    }

    fn named(&self) -> Vec<(&'static str, Names, &[Named])> {
        vec![("gradients", Names::Parameters, &self.gradients)]
    }

    fn gradients(&self) -> Option<&[Named]> {
        Some(&self.gradients)
    }

    fn gradients_mut(&mut self) -> Option<&mut Vec<Named>> {
        Some(&mut self.gradients)
    }

    fn rows(&self) -> Rows {
        Rows::Cycle
    }
}
