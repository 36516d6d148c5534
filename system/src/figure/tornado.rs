//! `tornado`: changes of a value, the largest first.

use super::argument::{option, place};
use super::{Figure, FigureRow, Given, Kind, Picture, Signals, Takes, Unplanned};
use crate::expression::{Expression, Member};

/// Changes of a value by parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct Tornado {
    /// The changes, under the names of their parameters.
    pub members: Vec<Member>,
    /// The share by which every parameter changes, if the text states one.
    pub change: Option<f64>,
}

pub(super) const ROW: FigureRow = FigureRow {
    name: "tornado",
    about: "changes of a value by parameters, as bars sorted by their size",
    arguments: &[
        place(
            "x",
            Takes::Changes("change"),
            "a value with `change`, or changes such as `gradient(moft, oil_temperature)*5 K`",
        ),
        option(
            "change",
            Takes::Change,
            "the share by which each parameter in the `gradients` of the analysis changes",
        ),
    ],
    plan,
};

fn plan(given: &Given) -> Result<Figure, Unplanned> {
    let of = given.signals("x")?;
    let tornado = Tornado {
        members: of.members.clone(),
        change: given.number("change"),
    };
    Ok(Figure::of(&of.shown, Picture::Tornado(tornado)))
}

impl Kind for Tornado {
    fn expressions(&self) -> Vec<&Expression> {
        Signals::expressions(&self.members)
    }
}
