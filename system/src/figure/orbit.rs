//! `orbit`: paths of pins in their clearance circles.

use super::argument::{CYCLES, place};
use super::{Figure, FigureRow, Given, Journals, Kind, Picture, Takes, Unplanned, Value};
use crate::dimension::DisplayUnit;
use crate::expression::Expression;

/// Paths of pins.
#[derive(Clone, Debug, PartialEq)]
pub struct Orbit {
    /// The journals.
    pub journals: Journals,
    /// The last cycles, or all samples.
    pub cycles: Option<u32>,
}

pub(super) const ROW: FigureRow = FigureRow {
    name: "orbit",
    about: "the paths of pins in their clearance circles",
    arguments: &[place("journals", Takes::Journals, "the journals"), CYCLES],
    plan,
};

fn plan(given: &Given) -> Result<Figure, Unplanned> {
    match given.find("journals") {
        Some(Value::Journals(journals)) => {
            Ok(Orbit::figure(journals.clone(), given.count("cycles")))
        }
        _ => Err(Unplanned::Absent("journals")),
    }
}

impl Orbit {
    /// The figure of some journals.
    pub fn figure(journals: Journals, cycles: Option<u32>) -> Figure {
        Figure {
            quantity: "Eccentricity".to_owned(),
            display: DisplayUnit {
                symbol: "µm".to_owned(),
                scale: 1e-6,
                offset: 0.0,
            },
            picture: Picture::Orbit(Orbit { journals, cycles }),
        }
    }
}

impl Kind for Orbit {
    fn expressions(&self) -> Vec<&Expression> {
        Vec::new()
    }

    fn analyses(&self) -> Vec<&str> {
        let journals = self.journals.iter();
        journals.map(|(analysis, _)| analysis.as_str()).collect()
    }
}
