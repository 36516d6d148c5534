//! Shear panels: `CSHEAR` with the section of `PSHEAR`. A panel resists one strain, its shear: it is one spring between the
//! displacements of its corners, with rods along its sides if `PSHEAR` states them, and with masses at its corners.
//!
//! S. J. Garvey (The quadrilateral shear panel, Aircraft Engineering 23, 1951) gives the shear flow in any quadrilateral, and
//! NASTRAN has his panel (The NASTRAN Theoretical Manual, NASA SP-221, §5.3), with a formula for each kind of quadrilateral.
//! One formula for all kinds: the quadrilateral is the projective image of a square. With D the point where its diagonals meet,
//! `D = x₁ + t (x₃ − x₁) = x₂ + s (x₄ − x₂)`, its corners have the weights `w = 2 (1 − t), 2 (1 − s), 2 t, 2 s`, and
//! `x = Σ N_i w_i x_i / W`, `W = Σ N_i w_i` with the bilinear functions N of the square. The lines of the square become the
//! two families of lines along which the panel has no normal stress, with the flow q = C W². Angles between them that differ
//! from a right one by θ add normal stresses to the energy, `q²/(2 G T) (1 + 2 tan² θ/(1 + ν))`. The sides pass the flow on to
//! the corners in halves:
//!
//! ```text
//! e = 2 t (1 − t) (x₃ − x₁)·(u₁ − u₃) − 2 s (1 − s) (x₄ − x₂)·(u₂ − u₄)     energy e²/(2 z)
//! z = H/(G T) ∫∫ W (1 + 2 tan² θ/(1 + ν)) dξ dη       H = 16 A t (1 − t) s (1 − s)
//! ```
//!
//! A warped panel is projected along the common normal of its diagonals: its forces are along the diagonals all the same.

use std::collections::BTreeMap;

use super::beams::Around;
use super::card::Card;
use super::lines::At;
use super::masses::distinct;
use super::properties::Properties;
use super::vector::norm;
use crate::element::quadrature::unit_interval;
use crate::error::FileProblem;
use crate::fe::vector::{cross, dot, scale, subtract};
use crate::mesh::{Mesh, PointMass, Spring, along_axes};

#[derive(Clone, Debug)]
struct PanelCard {
    order: u64,
    id: u64,
    property: u64,
    corners: [u64; 4],
    at: At,
}

/// `PSHEAR`.
#[derive(Clone, Debug)]
struct PanelSection {
    material: u64,
    thickness: f64,
    mass_per_area: f64,
    /// Effectiveness of the sides 1–2 and 3–4, and of 2–3 and 1–4.
    stretch: [f64; 2],
    at: At,
}

/// Cards of shear panels.
#[derive(Debug, Default)]
pub(super) struct Panels {
    cards: Vec<PanelCard>,
    sections: BTreeMap<u64, PanelSection>,
}

impl Panels {
    /// Reads a card; `false` if it is none of these.
    pub fn read(&mut self, card: &Card) -> Result<bool, FileProblem> {
        match card.name.as_str() {
            "CSHEAR" => self.panel(card)?,
            "PSHEAR" => self.section(card)?,
            _ => return Ok(false),
        }
        Ok(true)
    }

    /// `CSHEAR EID PID G1 G2 G3 G4`.
    fn panel(&mut self, card: &Card) -> Result<(), FileProblem> {
        let id = card.id(0, "EID")?;
        let property = card.optional_id(1, "PID")?.filter(|id| *id > 0);
        self.cards.push(PanelCard {
            order: card.order,
            id,
            property: property.unwrap_or(id),
            corners: [
                card.id(2, "G1")?,
                card.id(3, "G2")?,
                card.id(4, "G3")?,
                card.id(5, "G4")?,
            ],
            at: card.at.clone(),
        });
        Ok(())
    }

    /// `PSHEAR PID MID T NSM F1 F2`.
    fn section(&mut self, card: &Card) -> Result<(), FileProblem> {
        let id = card.id(0, "PID")?;
        let section = PanelSection {
            material: card.id(1, "MID")?,
            thickness: card.real(2, "T")?,
            mass_per_area: card.real_or_zero(3, "NSM")?,
            stretch: [card.real_or_zero(4, "F1")?, card.real_or_zero(5, "F2")?],
            at: card.at.clone(),
        };
        let [f1, f2] = section.stretch;
        if section.thickness <= 0.0 || f1 < 0.0 || f2 < 0.0 {
            return Err(card.problem(
                "T is not above zero, or F1 or F2 is negative",
                "state the thickness of the panel, and shares of its stiffness along its sides that are zero or positive",
            ));
        }
        if self.sections.insert(id, section).is_some() {
            return Err(card.problem(
                &format!("property {id} of shear panels is defined twice"),
                "renumber or remove one of them",
            ));
        }
        Ok(())
    }

    /// The springs and masses of all panels. `mass_scale` multiplies densities and added mass (`PARAM,WTMASS`).
    pub fn springs(
        &mut self,
        around: &Around,
        properties: &Properties,
        mass_scale: f64,
        mesh: &Mesh,
    ) -> Result<(Vec<Spring>, Vec<PointMass>), FileProblem> {
        self.cards.sort_by_key(|card| card.order);
        distinct(
            "shear panel",
            self.cards.iter().map(|card| (card.id, &card.at)),
        )?;
        let (mut springs, mut masses) = (Vec::new(), Vec::new());
        for card in &self.cards {
            let Some(section) = self.sections.get(&card.property) else {
                return Err(card.at.problem(
                    format!(
                        "shear panel {} uses property {}, which is missing",
                        card.id, card.property
                    ),
                    "add its PSHEAR card, or INCLUDE the file that holds it",
                ));
            };
            let user = || format!("shear panel {}", card.id);
            let mut nodes = [0; 4];
            for (node, corner) in nodes.iter_mut().zip(card.corners) {
                *node = around.lookup.require(corner, &user, &card.at)?;
            }
            let places = nodes.map(|node| around.position(node));
            let Some(panel) = Panel::new(places) else {
                return Err(card.at.problem(
                    format!("shear panel {} has a corner of 180° or more, or crossed sides", card.id),
                    "list its corners in their order around the panel, and divide a panel that is not convex",
                ));
            };
            let [young, poisson, shear, density] =
                properties.shear_of(section.material, &section.at)?;
            let spring = |stiffness: f64, terms: &[(usize, [f64; 3])]| Spring {
                id: card.id,
                stiffness,
                terms: (terms.iter())
                    .flat_map(|(corner, vector)| {
                        let components =
                            along_axes(&mesh.nodes, &mesh.frames, nodes[*corner], *vector);
                        (0..3)
                            .zip(components)
                            .map(|(k, factor)| (nodes[*corner], k, factor))
                    })
                    // rounding of cosines
                    .filter(|(_, _, factor)| factor.abs() > 1e-12)
                    .collect(),
                grounded: false,
            };
            let (stiffness, terms) = panel.shear(shear * section.thickness, poisson);
            springs.push(spring(stiffness, &terms));
            for (stiffness, terms) in panel.sides(section.stretch, section.thickness) {
                springs.push(spring(young * stiffness, &terms));
            }
            let per_area = mass_scale * (density * section.thickness + section.mass_per_area);
            for (node, area) in nodes.into_iter().zip(panel.shares()) {
                let mut matrix = [[0.0; 6]; 6];
                for (i, row) in matrix.iter_mut().enumerate().take(3) {
                    row[i] = per_area * area;
                }
                if per_area != 0.0 {
                    masses.push(PointMass {
                        id: card.id,
                        node,
                        matrix,
                    });
                }
            }
        }
        Ok((springs, masses))
    }
}

/// The vectors at corners whose products with the displacements add up to the extension of a spring.
type Terms = Vec<(usize, [f64; 3])>;

/// The shape of a panel.
struct Panel {
    places: [[f64; 3]; 4],
    diagonals: [[f64; 3]; 2],
    area: f64,
    /// Where each diagonal meets the other one, as a share of its length.
    shares: [f64; 2],
}

impl Panel {
    /// `None` if it is not convex.
    fn new(places: [[f64; 3]; 4]) -> Option<Self> {
        let [a, b, c, d] = places;
        let diagonals = [subtract(c, a), subtract(d, b)];
        let normal = cross(diagonals[0], diagonals[1]);
        let whole = dot(normal, normal);
        let side = subtract(b, a);
        // both in the plane of the diagonals: cross products along their common normal
        let share = |diagonal: [f64; 3]| dot(cross(side, diagonal), normal) / whole;
        let shares = [share(diagonals[1]), share(diagonals[0])];
        let convex = shares
            .iter()
            // a choice: three corners on one line but for the digits of a file make no panel
            .all(|share| *share > 1e-6 && *share < 1.0 - 1e-6);
        (whole > 0.0 && convex).then(|| Panel {
            places,
            diagonals,
            area: 0.5 * whole.sqrt(),
            shares,
        })
    }

    /// Stiffness and terms of the shear for G T (force/length) and Poisson's ratio; see the head of the file. The terms
    /// have no unit.
    fn shear(&self, rigidity: f64, poisson: f64) -> (f64, Terms) {
        let [t, s] = self.shares;
        let [first, second] = self.diagonals;
        let length = norm(first);
        // the corners in the plane of the diagonals, the first one at the origin, the first diagonal along x
        let axis = scale(1.0 / length, first);
        let across = cross(scale(0.5 / self.area, cross(first, second)), axis);
        let corner = |place: [f64; 3]| {
            let from = subtract(place, self.places[0]);
            [dot(from, axis), dot(from, across)]
        };
        let weights = [2.0 * (1.0 - t), 2.0 * (1.0 - s), 2.0 * t, 2.0 * s];
        let jacobian = 16.0 * self.area * t * (1.0 - t) * s * (1.0 - s);
        let mut sum = 0.0;
        for (x, along) in unit_interval(POINTS) {
            for (y, beside) in unit_interval(POINTS) {
                let values = [(1.0 - x) * (1.0 - y), x * (1.0 - y), x * y, (1.0 - x) * y];
                let slopes = [[y - 1.0, x - 1.0], [1.0 - y, -x], [y, x], [-y, 1.0 - x]];
                // homogeneous coordinates, and their slopes
                let mut at = [0.0; 3];
                let mut tangents = [[0.0; 3]; 2];
                for (i, place) in self.places.into_iter().enumerate() {
                    let [u, v] = corner(place);
                    for (k, value) in [u, v, 1.0].into_iter().enumerate() {
                        at[k] += values[i] * weights[i] * value;
                        for (tangent, slope) in tangents.iter_mut().zip(slopes[i]) {
                            tangent[k] += slope * weights[i] * value;
                        }
                    }
                }
                let [a, b] = tangents.map(|tangent| {
                    [0, 1]
                        .map(|k: usize| (tangent[k] * at[2] - at[k] * tangent[2]) / (at[2] * at[2]))
                });
                let slant = (a[0] * b[0] + a[1] * b[1]) / (a[0] * b[1] - a[1] * b[0]);
                sum += along * beside * at[2] * (1.0 + 2.0 * slant * slant / (1.0 + poisson));
            }
        }
        let flexibility = jacobian * sum / rigidity;
        let unit = self.area.sqrt();
        let first = scale(2.0 * t * (1.0 - t) / unit, first);
        let second = scale(2.0 * s * (1.0 - s) / unit, second);
        let terms = vec![
            (0, first),
            (1, scale(-1.0, second)),
            (2, scale(-1.0, first)),
            (3, second),
        ];
        (self.area / flexibility, terms)
    }

    /// Area over length and terms of the rods along the sides: F T A/(L₁ + L₂) for an effectiveness up to 1.01, else F T²/2
    /// (MSC Nastran, Quick Reference Guide, PSHEAR, remark 2).
    fn sides(&self, stretch: [f64; 2], thickness: f64) -> Vec<(f64, Terms)> {
        let mut rods = Vec::new();
        for (factor, pairs) in stretch
            .into_iter()
            .zip([[(0, 1), (2, 3)], [(1, 2), (0, 3)]])
        {
            let sides =
                pairs.map(|(a, b): (usize, usize)| subtract(self.places[b], self.places[a]));
            let lengths = sides.map(norm);
            // Nastran's limit between a factor and a number of thicknesses
            let area = if factor <= 1.01 {
                factor * thickness * self.area / (lengths[0] + lengths[1])
            } else {
                0.5 * factor * thickness * thickness
            };
            if factor == 0.0 {
                continue;
            }
            for (((a, b), side), length) in pairs.into_iter().zip(sides).zip(lengths) {
                let along = scale(1.0 / length, side);
                rods.push((area / length, vec![(a, scale(-1.0, along)), (b, along)]));
            }
        }
        rods
    }

    /// The area of each corner: the panel is its four triangles of three corners, each by half (NASTRAN-95, `emastq.f`).
    fn shares(&self) -> [f64; 4] {
        [0, 1, 2, 3].map(|i: usize| {
            let [before, here, after] =
                [(i + 3) % 4, i, (i + 1) % 4].map(|k: usize| self.places[k]);
            let triangle = 0.5 * norm(cross(subtract(after, here), subtract(before, here)));
            (self.area + triangle) / 6.0
        })
    }
}

/// Points along a side of the square for the energy. A choice: ten Gauss points are exact to degree 19, and
/// the integrand is smooth.
const POINTS: usize = 10;
