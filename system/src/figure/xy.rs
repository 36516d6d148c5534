//! `xy`: a signal over another one, such as pressure over volume.

use super::argument::{CYCLES, place};
use super::{Figure, FigureRow, Given, Kind, Picture, Recorded, Signals, Takes, Unplanned};
use crate::expression::{Expression, Member};

/// Signals over other signals of the same samples.
#[derive(Clone, Debug, PartialEq)]
pub struct Xy {
    /// The signals along the abscissa, one for each of the others.
    pub x: Vec<Expression>,
    /// The abscissa.
    pub shown: Recorded,
    /// The signals along the ordinate.
    pub y: Vec<Member>,
    /// The last cycles, or all samples.
    pub cycles: Option<u32>,
}

pub(super) const ROW: FigureRow = FigureRow {
    name: "xy",
    about: "signals over other signals of the same samples, such as pressure over volume",
    arguments: &[
        place(
            "x",
            Takes::Signals(None),
            "the signal along the abscissa, one for all or one for each of `y`",
        ),
        place(
            "y",
            Takes::OrdinatesOfRows,
            "the signals along the ordinate",
        ),
        CYCLES,
    ],
    plan,
};

fn plan(given: &Given) -> Result<Figure, Unplanned> {
    let (x, y) = (given.signals("x")?, given.signals("y")?);
    let words = ("signals `y`", "signals `x`");
    let over = given.for_each("x", y.members.len(), words)?;
    let cycles = given.count("cycles");
    if cycles.is_some() && !y.cycle {
        return Err(Unplanned::NoCycle("cycles", "`cycles`"));
    }
    Ok(Figure::of(
        &y.shown,
        Picture::Xy(Xy {
            x: over.unwrap_or_default(),
            shown: x.shown.clone(),
            y: y.members.clone(),
            cycles,
        }),
    ))
}

impl Kind for Xy {
    fn expressions(&self) -> Vec<&Expression> {
        let mut all = Signals::expressions(&self.y);
        all.extend(&self.x);
        all
    }

    fn paired(&self) -> Vec<(&Expression, &Expression)> {
        // the last cycles of two runs may agree
        if self.cycles.is_some() {
            return Vec::new();
        }
        let y = self.y.iter().map(|member| &member.expression);
        self.x.iter().zip(y).collect()
    }
}
