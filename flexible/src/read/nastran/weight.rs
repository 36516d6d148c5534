//! The weight check of Nastran in comments: the table that `PARAM,GRDPNT` prints, if somebody has copied it into the deck.

use super::lines::At;
use crate::fe::vector::add;
use crate::mesh::{Mesh, WeightCheck};
use crate::read::number;

/// Words above the table that name the point to which the centre refers; 0 is the origin.
const REFERENCE: &str = "REFERENCE POINT =";
/// Words above the masses and centres.
const HEADING: &str = "MASS AXIS SYSTEM (S)";

/// The largest difference of the masses of two directions, as a part of them. The printed digits are seven.
const EQUAL: f64 = 1e-6;

/// The lines of the first whole table among the comments.
#[derive(Debug, Default)]
pub(super) struct WeightTable {
    reference: Option<u64>,
    /// Place of the heading.
    at: Option<At>,
    /// Mass and centre by the directions x, y, z.
    rows: Vec<[f64; 4]>,
}

impl WeightTable {
    /// Takes the text of a comment.
    pub fn comment(&mut self, text: &str, at: &At) {
        if self.rows.len() == 3 {
            return;
        }
        if let Some((_, point)) = text.split_once(REFERENCE) {
            self.reference = point.trim().parse().ok();
        }
        if text.contains(HEADING) {
            self.at = Some(at.clone());
            self.rows.clear();
        } else if self.at.is_some() {
            match row(text, self.rows.len()) {
                Some(row) => self.rows.push(row),
                None => self.at = None,
            }
        }
    }

    /// The mass and its centre in a mesh in the units of the deck. Without the place of the reference point the centre is unknown.
    /// `None` without a whole table, or if the mass is not the same in all directions. Nastran prints the mass before its scale
    /// (`PARAM,WTMASS`).
    pub fn check(&self, mesh: &Mesh, scale: f64) -> Option<WeightCheck> {
        let at = self.at.as_ref()?;
        let [x, y, z] = <[[f64; 4]; 3]>::try_from(self.rows.as_slice()).ok()?;
        let [mass, others @ ..] = [x, y, z].map(|row| row[0]);
        if mass <= 0.0
            || !mass.is_finite()
            || others
                .iter()
                .any(|other| (other / mass - 1.0).abs() > EQUAL)
        {
            return None;
        }
        // the mass of a direction has no place along it
        let centre = [y[1], x[2], x[3]];
        let nodes = &mesh.nodes;
        let reference = match self.reference? {
            0 => Some([0.0; 3]),
            id => nodes.iter().find(|node| node.id == id).map(|n| n.position),
        };
        Some(WeightCheck {
            mass: scale * mass,
            centre: reference.map(|point| add(point, centre)),
            place: (at.file.to_string(), at.line),
        })
    }
}

/// The row of a direction: its name, mass and centre.
fn row(text: &str, direction: usize) -> Option<[f64; 4]> {
    let mut words = text.split_whitespace();
    let name = words.next()?;
    if ["X", "Y", "Z"].get(direction) != Some(&name) {
        return None;
    }
    let mut row = [0.0; 4];
    for value in &mut row {
        *value = number::real(words.next()?)?;
    }
    Some(row)
}
