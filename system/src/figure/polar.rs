//! `polar`: tips of vectors, and loads of journals on their shells.

use super::argument::{CYCLES, option, place};
use super::{Figure, FigureRow, Given, Kind, Picture, Takes, Unplanned, Value};
use crate::dimension::Dimension;
use crate::expression::Expression;

/// Vectors; of journals the load on their shells.
#[derive(Clone, Debug, PartialEq)]
pub struct Polar {
    /// The vectors.
    pub vectors: Vec<Vector>,
    /// The last cycles, or all samples.
    pub cycles: Option<u32>,
}

/// A vector of a polar diagram.
#[derive(Clone, Debug, PartialEq)]
pub struct Vector {
    /// The analysis.
    pub analysis: String,
    /// `main[5].force`; for a journal `main[5]`.
    pub path: String,
    /// Whether it is the load of a journal's pin on its shell, −force; otherwise a recorded vector.
    pub load: bool,
    /// Component along x.
    pub x: Expression,
    /// Component along y.
    pub y: Expression,
    /// The angle by which the drawn axes are turned about z.
    pub turned_by: Option<Expression>,
}

pub(super) const ROW: FigureRow = FigureRow {
    name: "polar",
    about: "the tips of vectors in a plane; of journals the loads of the pins on their shells",
    arguments: &[
        place("vectors", Takes::Vectors, "journals or recorded vectors"),
        option(
            "turned_by",
            Takes::Signals(Some(Dimension::ANGLE)),
            "the angle by which the drawn axes are turned about z, one for all or one for each",
        ),
        CYCLES,
    ],
    plan,
};

fn plan(given: &Given) -> Result<Figure, Unplanned> {
    let Some(Value::Vectors(vectors, shown)) = given.find("vectors") else {
        return Err(Unplanned::Absent("vectors"));
    };
    let mut vectors = vectors.clone();
    let words = ("vectors", "angles");
    if let Some(turned) = given.for_each("turned_by", vectors.len(), words)? {
        for (vector, angle) in vectors.iter_mut().zip(turned) {
            vector.turned_by = Some(angle);
        }
    }
    Ok(Figure::of(
        shown,
        Picture::Polar(Polar {
            vectors,
            cycles: given.count("cycles"),
        }),
    ))
}

impl Kind for Polar {
    fn expressions(&self) -> Vec<&Expression> {
        let vectors = self.vectors.iter();
        vectors
            .flat_map(|v| [&v.x, &v.y].into_iter().chain(&v.turned_by))
            .collect()
    }
}
