//! Outlines of sections: their lines, area and errors.

use super::error::StackError;
use super::piece::{Piece, apart};
use crate::error::mm;
use eng_system::stack::Section;
use std::f64::consts::TAU;

/// Two points nearer than this share of the largest extent are one, as far as an outline's own shape counts.
/// A choice: above rounding, and below any detail.
const SAME: f64 = 1e-9;
/// Least area by the square of the circumference. A strip of 1:1000 has 1/4000. A choice: outlines of less
/// are a line that was stated twice.
const LEAST_AREA: f64 = 1e-6;

/// The lines of an outline.
#[derive(Clone, Debug)]
pub(crate) struct Outline {
    pub pieces: Vec<Piece>,
    /// Its area (m²).
    pub area: f64,
    /// Its circumference (m).
    pub circumference: f64,
}

/// Reads the outline of a section, whose number counts from 1.
pub(crate) fn outline(section: &Section, number: usize) -> Result<Outline, StackError> {
    let wrong = |what: &str, due: &'static str, value: String| StackError::Number {
        what: format!("section {number}: {what}"),
        due,
        value,
        section: Some(number),
    };
    for corner in &section.corners {
        for coordinate in corner.place {
            // larger coordinates would not fit into the squares of areas
            if coordinate.is_nan() || coordinate.abs() >= 1e6 {
                return Err(wrong(
                    "each coordinate of a corner",
                    "between -1000 km and 1000 km",
                    format!("{} mm", mm(coordinate)),
                ));
            }
        }
        if corner.bend.is_nan() || corner.bend.abs() >= TAU {
            return Err(wrong(
                "each bend of a corner",
                "between -360 and 360 deg",
                format!("{:.4} deg", corner.bend.to_degrees()),
            ));
        }
    }
    if section.corners.len() < 2 {
        return Err(StackError::NoArea { section: number });
    }
    let next = section.corners.iter().cycle().skip(1);
    let pieces: Vec<Piece> = section
        .corners
        .iter()
        .zip(next)
        .map(|(corner, next)| Piece::new(corner.place, next.place, corner.bend))
        .collect();
    let count = pieces.len();
    let extent = pieces
        .iter()
        .flat_map(|piece| piece.bounds())
        .flatten()
        .fold(0.0, |largest: f64, x| largest.max(x.abs()));
    let tolerance = SAME * extent;
    for (k, piece) in pieces.iter().enumerate() {
        if apart(piece.from, piece.to) <= tolerance {
            return Err(StackError::SamePlace {
                section: number,
                first: k + 1,
                second: (k + 1) % count + 1,
                at: piece.from,
            });
        }
    }
    crossing(&pieces, number, tolerance)?;
    let circumference: f64 = pieces.iter().map(Piece::length).sum();
    let area = 0.5 * pieces.iter().map(Piece::twice_area).sum::<f64>().abs();
    if area.is_nan() || area <= LEAST_AREA * circumference * circumference {
        return Err(StackError::NoArea { section: number });
    }
    Ok(Outline {
        pieces,
        area,
        circumference,
    })
}

/// Refuses lines that meet elsewhere than in the corners between neighbours.
fn crossing(pieces: &[Piece], section: usize, tolerance: f64) -> Result<(), StackError> {
    let count = pieces.len();
    for (i, a) in pieces.iter().enumerate() {
        for (j, b) in pieces.iter().enumerate().skip(i + 1) {
            // the corners that both lines have
            let mut shared = Vec::new();
            if j == i + 1 {
                shared.push(a.to);
            }
            if (j + 1) % count == i {
                shared.push(a.from);
            }
            let mut met = a.common(b, tolerance);
            // lines on one carrier meet in their ends
            met.extend(
                [a.from, a.to]
                    .into_iter()
                    .filter(|p| b.distance(*p) <= tolerance),
            );
            met.extend(
                [b.from, b.to]
                    .into_iter()
                    .filter(|p| a.distance(*p) <= tolerance),
            );
            let beside = |p: &Point2| {
                shared
                    .iter()
                    // a choice: lines that leave a corner at a small angle meet beside it within their
                    // rounding
                    .all(|corner| apart(*p, *corner) > 100.0 * tolerance)
            };
            if let Some(at) = met.into_iter().find(beside) {
                return Err(StackError::Crossing {
                    section,
                    first: i + 1,
                    second: j + 1,
                    at,
                });
            }
            // two lines between the same two corners
            if count == 2 && same_line(a, b, tolerance) {
                return Err(StackError::NoArea { section });
            }
        }
    }
    Ok(())
}

type Point2 = [f64; 2];

fn same_line(a: &Piece, b: &Piece, tolerance: f64) -> bool {
    apart(a.at(0.5), b.at(0.5)) <= tolerance
}
