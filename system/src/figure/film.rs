//! `film`: a quantity in the cells of the films of bearings at a moment.

use super::argument::place;
use super::{Figure, FigureRow, Given, Journals, Kind, Picture, Takes, Unplanned, Value};
use crate::dimension::DisplayUnit;
use crate::expression::Expression;
use crate::field::FILM_CELLS;

/// A quantity over angle and width of some bearings.
#[derive(Clone, Debug, PartialEq)]
pub struct FilmMap {
    /// The bearings.
    pub journals: Journals,
    /// The quantity, its place in [`FILM_CELLS`].
    pub quantity: usize,
    /// The moment: a number.
    pub at: Expression,
    /// Whether the moment is a time (s) and not an angle of the cycle (rad).
    pub by_time: bool,
}

const WORDS: [&str; FILM_CELLS.len()] = {
    let mut words = [""; FILM_CELLS.len()];
    let mut at = 0;
    while at < words.len() {
        words[at] = FILM_CELLS[at].name;
        at += 1;
    }
    words
};

pub(super) const ROW: FigureRow = FigureRow {
    name: "film",
    about: "a quantity in the cells of oil films at a moment of the last cycle",
    arguments: &[
        place(
            "journals",
            Takes::Films,
            "journals whose films are solved on cells",
        ),
        place("quantity", Takes::Word(&WORDS), "the quantity in the cells"),
        place(
            "at",
            Takes::Moment,
            "an angle of the cycle, or a time; the nearest recorded moment is drawn",
        ),
    ],
    plan,
};

fn plan(given: &Given) -> Result<Figure, Unplanned> {
    let Some(Value::Films(journals, cycle)) = given.find("journals") else {
        return Err(Unplanned::Absent("journals"));
    };
    let Some(Value::Moment(at, by_time)) = given.find("at") else {
        return Err(Unplanned::Absent("at"));
    };
    if !by_time && !cycle {
        return Err(Unplanned::NoCycle("at", "`at`"));
    }
    let quantity = match given.find("quantity") {
        Some(Value::Word(at)) => *at,
        _ => return Err(Unplanned::Absent("quantity")),
    };
    let shown = FILM_CELLS.get(quantity);
    let shown = shown.ok_or(Unplanned::Absent("quantity"))?;
    let (symbol, scale) = shown.unit;
    Ok(Figure {
        quantity: shown.name.replace('_', " "),
        display: DisplayUnit {
            symbol: symbol.to_owned(),
            scale,
            offset: 0.0,
        },
        picture: Picture::Film(FilmMap {
            journals: journals.clone(),
            quantity,
            at: at.clone(),
            by_time: *by_time,
        }),
    })
}

impl Kind for FilmMap {
    fn expressions(&self) -> Vec<&Expression> {
        vec![&self.at]
    }

    fn analyses(&self) -> Vec<&str> {
        let journals = self.journals.iter();
        journals.map(|(analysis, _)| analysis.as_str()).collect()
    }
}
