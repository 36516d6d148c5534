//! What a mesh holds, and the shape of its solids and shells.
//!
//! Two numbers of the corners measure the shape of an element, whatever its mid-side nodes: the longest side by the
//! shortest, and its sharpest corner. At a corner with unit vectors a, b, c along its sides this is `a·(b × c)`, of a
//! shell `n·(a × b)` with the normal n, times a factor so that an element of equal sides has 1: √2 for tetrahedra and
//! pyramids, 2/√3 for wedges and triangles. It is the Jacobian of the corner by the lengths of its sides. A corner without
//! volume has 0, an inverted one is negative.

use std::collections::BTreeMap;

use super::check::{Role, role};
use super::form::plain_name;
use super::vector::{Vector, add, cross, dot, norm, scale, subtract};
use crate::element::{ElementKind, TRIANGLE};
use crate::mesh::{Element, Mesh};
use serde::{Deserialize, Serialize};

/// Sides above which an element is poor: the longest by the shortest. A choice, in the range of the limits
/// that preprocessors have.
pub const LONG: f64 = 20.0;
/// Corner below which an element is poor, as a share of that of an element of equal sides. A choice, in the
/// range of the limits that preprocessors have.
pub const SHARP: f64 = 0.2;

/// A number of an element and its place.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Worst {
    /// The number.
    pub value: f64,
    /// The element's number in the file.
    pub element: u64,
    /// The mean of its corners (m).
    pub place: [f64; 3],
}

/// What a mesh holds.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Inventory {
    /// Solids and shells by the names of their file's code, with their counts.
    pub elements: Vec<(String, usize)>,
    /// Beams and rods.
    pub lines: usize,
    /// Springs, bushings included, each direction apart.
    pub springs: usize,
    /// Point masses.
    pub masses: usize,
    /// Rigid elements, averaging elements and equations.
    pub ties: usize,
    /// Solids and shells above [`LONG`] or below [`SHARP`].
    pub poor: usize,
    /// The largest ratio of the sides of a solid or shell.
    pub longest: Option<Worst>,
    /// The sharpest corner of a solid or shell.
    pub sharpest: Option<Worst>,
}

impl Inventory {
    /// The inventory of a mesh.
    pub fn of(mesh: &Mesh) -> Self {
        let mut counts: BTreeMap<String, usize> = BTreeMap::new();
        let mut own = Inventory {
            springs: mesh.springs.len(),
            masses: mesh.point_masses.len(),
            ties: mesh.ties.len(),
            ..Inventory::default()
        };
        for element in &mesh.elements {
            match role(mesh, element) {
                Some(Role::Solid(_) | Role::Shell(_)) => {
                    *counts.entry(plain_name(mesh, element.kind)).or_default() += 1;
                    own.measure(mesh, element);
                }
                _ if element.kind.corner_count() == 2 => own.lines += 1,
                _ => {}
            }
        }
        own.elements = counts.into_iter().collect();
        own
    }

    fn measure(&mut self, mesh: &Mesh, element: &Element) {
        let corners: Vec<Vector> = (mesh.nodes_of(element).iter())
            .take(element.kind.corner_count())
            .filter_map(|node| mesh.nodes.get(*node as usize))
            .map(|node| node.position)
            .collect();
        let Some((ratio, corner)) = shape(element.kind, &corners) else {
            return;
        };
        let sum = corners.iter().fold([0.0; 3], |sum, x| add(sum, *x));
        let worst = |value| Worst {
            value,
            element: element.id,
            place: scale(1.0 / corners.len() as f64, sum),
        };
        self.poor += usize::from(ratio > LONG || corner < SHARP);
        if self.longest.is_none_or(|known| ratio > known.value) {
            self.longest = Some(worst(ratio));
        }
        if self.sharpest.is_none_or(|known| corner < known.value) {
            self.sharpest = Some(worst(corner));
        }
    }
}

/// The longest side by the shortest, and the sharpest corner. `None` for lines. Both are dimensionless.
fn shape(kind: ElementKind, corners: &[Vector]) -> Option<(f64, f64)> {
    let count = corners.len();
    let mut sharpest = f64::INFINITY;
    let (mut longest, mut shortest) = (0.0_f64, f64::INFINITY);
    let mut unit = |from: usize, to: usize| -> Option<Vector> {
        let side = subtract(*corners.get(to)?, *corners.get(from)?);
        let length = norm(side);
        longest = longest.max(length);
        shortest = shortest.min(length);
        Some(match length {
            0.0 => [0.0; 3],
            length => scale(1.0 / length, side),
        })
    };
    if kind.is_solid() {
        let (ends, factor) = kind.description().corner_edges;
        for (corner, [a, b, c]) in ends.iter().enumerate() {
            let [a, b, c] = [unit(corner, *a)?, unit(corner, *b)?, unit(corner, *c)?];
            sharpest = sharpest.min(factor * dot(a, cross(b, c)));
        }
    } else if count > 2 {
        let [first, second, third] = [corners.first()?, corners.get(1)?, corners.get(2)?];
        let last = corners.get(3).unwrap_or(first);
        // of the diagonals, or of two sides of a triangle
        let normal = cross(subtract(*third, *first), subtract(*last, *second));
        let length = norm(normal);
        let factor = if count == 3 { TRIANGLE } else { 1.0 };
        for corner in 0..count {
            let [a, b] = [
                unit(corner, (corner + 1) % count)?,
                unit(corner, (corner + count - 1) % count)?,
            ];
            let sine = match length {
                0.0 => 0.0,
                length => dot(cross(a, b), normal) / length,
            };
            sharpest = sharpest.min(factor * sine);
        }
    }
    sharpest
        .is_finite()
        .then_some((longest / shortest, sharpest))
}
