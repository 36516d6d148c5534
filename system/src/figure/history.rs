//! `history`: curves over crank angle or time.

use super::argument::{option, place, words};
use super::{Argument, Figure, FigureRow, Given, Kind, Picture, Signals, Takes, Unplanned};
use crate::expression::{Expression, Member};

/// Curves over crank angle or time.
#[derive(Clone, Debug, PartialEq)]
pub struct History {
    /// The signals of each panel.
    pub panels: Vec<Vec<Member>>,
    /// Whether the abscissa is time.
    pub by_time: bool,
}

const OVER: [(&str, bool); 2] = [("crank_angle", false), ("time", true)];

pub(super) const ROW: FigureRow = FigureRow {
    name: "history",
    about: "curves over crank angle or time",
    arguments: &[
        Argument {
            more: true,
            ..place(
                "signals",
                Takes::Ordinates,
                "the signals of a panel; further arguments are further panels",
            )
        },
        option(
            "over",
            Takes::Word(&words(&OVER)),
            "the abscissa; the crank angle if the models have a cycle, else the time",
        ),
    ],
    plan,
};

fn plan(given: &Given) -> Result<Figure, Unplanned> {
    let panels = given.panels("signals")?;
    let cycle = panels.iter().all(|panel| panel.cycle);
    let by_time = match given.word("over", &OVER) {
        Some(false) if !cycle => return Err(Unplanned::NoCycle("over", "a crank angle")),
        stated => stated.unwrap_or(!cycle),
    };
    let shown = &given.signals("signals")?.shown;
    Ok(Figure::of(
        shown,
        Picture::History(History {
            panels: panels.iter().map(|panel| panel.members.clone()).collect(),
            by_time,
        }),
    ))
}

impl Kind for History {
    fn expressions(&self) -> Vec<&Expression> {
        let panels = self.panels.iter();
        panels
            .flat_map(|panel| Signals::expressions(panel))
            .collect()
    }
}
