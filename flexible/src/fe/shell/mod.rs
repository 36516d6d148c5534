//! Shells: stiffness and mass of thin and thick plates and curved shells of three or four nodes.
//!
//! An element is a list of points with the rows of its nine strains ([`ShellPoint`]), so stiffness, stress
//! and geometric stiffness read the same rows. A material line moves by `u + z θ × n` at the height z along
//! the director n of its node. At a point with tangents e₁, e₂ and normal n the strains are
//!
//! ```text
//! ε₁₁ ε₂₂ 2ε₁₂   of the middle surface (–)      κ₁₁ κ₂₂ 2κ₁₂   their change with z (1/m)
//! γ₁ γ₂          between normal and surface (–)  δ = θ·n − ½ n·curl u   drilling (–)
//! ```
//!
//! Forces and moments per length are `[N; M; Q; k δ] = C [ε; κ; γ; δ]`. The forms are
//! [`quadrilateral`]: MITC4 with an enhanced membrane, and [`triangle`]: DKMT with a constant membrane or
//! Felippa's optimal one.
//!
//! **Drilling.** The rotation about the normal has no stiffness in a shell's theory. Here δ is held by
//! `k = G t min(1, t²/h²)` with the element's size h (the term of T. J. R. Hughes, F. Brezzi, Comput. Methods
//! Appl. Mech. Eng. 72, 1989, with this factor). A rigid motion has δ = 0, so it costs nothing. On a curved
//! surface of radius R the normals of neighbours differ by h/R. A soft k lets their twists part, by `h²/R²` of
//! the twist with this factor; a stiff one locks, here by `h²/R²` of the bending. So both errors vanish with
//! the mesh. With a constant factor one of them does not. A moment about the normal turns a node far: it is
//! a job for beams and ties that spread it. The membrane of [`Variant::Drilling`] triangles has these
//! rotations itself, and needs no k.
//!
//! [`Variant::Drilling`]: crate::mesh::Variant::Drilling
//!
//! The mass is consistent, with the rotary inertia ρ t³/12 of the directors; the rotation about the normal
//! has none.

mod law;
mod quadrilateral;
mod triangle;

pub(super) use law::{Law, Plate};

use super::check::{list, wrong};
use super::rules::{MassRule, Spread, spread};
use super::vector::{Vector, cross, dot, norm, scale};
use crate::element::{ElementKind, MOST_NODES, Shape};
use crate::error::FlexibleError;
use crate::fe::solid::tangents;

/// Most nodes of a shell.
pub(super) const NODES: usize = 4;

/// Most freedoms of a shell: six for each node (translations, then rotations).
pub(super) const WIDTH: usize = 6 * NODES;

/// Number of strains.
pub(super) const STRAINS: usize = 9;

/// Rows of strains over the freedoms of the element's nodes.
pub(super) type Rows = [[f64; WIDTH]; STRAINS];

/// Places of nodes relative to the first one (m).
pub(super) type Places = [Vector; MOST_NODES];

/// A point of the stiffness.
#[derive(Clone, Debug)]
pub(super) struct ShellPoint {
    /// Area that it stands for (m²).
    pub area: f64,
    /// Strains for a unit of each freedom (1/m and – of translations and rotations; κ 1/m², 1/m).
    pub rows: Rows,
    /// The law that belongs to the strains.
    pub law: Law,
}

/// Stiffness and mass of a shell over `count` nodes.
#[derive(Clone, Debug)]
pub(super) struct ShellMatrices {
    /// Stiffness over the six freedoms of each node (N/m, N, N m).
    pub stiffness: [[f64; WIDTH]; WIDTH],
    /// Mass of each pair of nodes, the same in all directions (kg).
    pub mass: [[f64; NODES]; NODES],
    /// Rotary inertia of each pair of nodes (kg m²).
    pub rotary: [[[[f64; 3]; 3]; NODES]; NODES],
}

/// A shell whose middle surface has nodes at `places`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shell<'a> {
    pub kind: ElementKind,
    pub places: &'a Places,
    /// Whether rotations about the normal belong to the membrane.
    pub drilling: bool,
    /// Its section and material.
    pub plate: &'a Plate,
}

impl Shell<'_> {
    fn count(&self) -> usize {
        self.kind.node_count().min(NODES)
    }

    /// The points of the stiffness.
    ///
    /// # Errors
    /// The area for a unit of the reference domain (m²) where the element is folded or flat.
    pub fn points(&self) -> Result<Vec<ShellPoint>, f64> {
        match self.count() {
            3 => triangle::points(self.places, self.plate, self.drilling),
            _ => quadrilateral::points(self.places, self.plate),
        }
    }

    /// Stiffness `∫ Bᵀ C B dA` and mass `∫ N_a N_b m dA`, `∫ N_a N_b j (n_a·n_b I − n_b n_aᵀ) dA`.
    ///
    /// # Errors
    /// As [`Shell::points`].
    pub fn matrices(&self, rule: MassRule) -> Result<ShellMatrices, f64> {
        let mut out = ShellMatrices {
            stiffness: [[0.0; WIDTH]; WIDTH],
            mass: [[0.0; NODES]; NODES],
            rotary: [[[[0.0; 3]; 3]; NODES]; NODES],
        };
        for point in self.points()? {
            add_stiffness(&point, 6 * self.count(), &mut out.stiffness);
        }
        self.add_mass(rule, &mut out);
        Ok(out)
    }

    fn add_mass(&self, rule: MassRule, out: &mut ShellMatrices) {
        let count = self.count();
        let directors = self.directors();
        let mut inertia = [[0.0; NODES]; NODES];
        for point in (self.kind.description().mass)() {
            let shape = Shape::at(self.kind, point.at);
            let [r, s, _] = tangents(&shape, self.places, count);
            let area = point.weight * norm(cross(r, s));
            let (mass, rotary) = self.plate.inertia(&shape.values);
            let values = &shape.values[..count];
            for (table, factor) in [(&mut out.mass, mass), (&mut inertia, rotary)] {
                for (row, first) in table.iter_mut().zip(values) {
                    for (sum, second) in row.iter_mut().zip(values) {
                        *sum += factor * area * first * second;
                    }
                }
            }
        }
        if spread(self.kind, rule) != Spread::Consistent {
            for table in [&mut out.mass, &mut inertia] {
                for (a, row) in table.iter_mut().enumerate() {
                    let sum = row.iter().sum();
                    *row = [0.0; NODES];
                    row[a] = sum;
                }
            }
        }
        for a in 0..count {
            for b in 0..count {
                let (first, second) = (directors[a], directors[b]);
                let along = dot(first, second);
                for (i, row) in out.rotary[a][b].iter_mut().enumerate() {
                    for (j, entry) in row.iter_mut().enumerate() {
                        let same = if i == j { along } else { 0.0 };
                        *entry = inertia[a][b] * (same - second[i] * first[j]);
                    }
                }
            }
        }
    }

    /// The unit normals of the middle surface at its nodes.
    fn directors(&self) -> [Vector; NODES] {
        let corners: &[[f64; 2]] = match self.count() {
            3 => &triangle::CORNERS,
            _ => &quadrilateral::CORNERS,
        };
        let mut directors = [[0.0; 3]; NODES];
        for (director, [r, s]) in directors.iter_mut().zip(corners) {
            let shape = Shape::at(self.kind, [*r, *s, 0.0]);
            let [r, s, _] = tangents(&shape, self.places, self.count());
            let normal = cross(r, s);
            *director = scale(1.0 / norm(normal), normal);
        }
        directors
    }
}

/// The error for folded or flat shells, with their ids and areas for a unit of the reference domain (m²).
pub(super) fn folded(faults: &[(u64, f64)]) -> FlexibleError {
    wrong(
        format!(
            "{} folded or flat: {}",
            match faults.len() {
                1 => "1 shell is".to_owned(),
                count => format!("{count} shells are"),
            },
            list(
                faults
                    .iter()
                    .map(|(id, area)| format!("element {id} (area {area:.3e} m²)"))
            )
        ),
        "repair the mesh: order the nodes around the element, and use a triangle where two of them are one",
    )
}

/// Adds `Bᵀ C B dA`.
fn add_stiffness(point: &ShellPoint, width: usize, stiffness: &mut [[f64; WIDTH]; WIDTH]) {
    let mut forces = [[0.0; WIDTH]; STRAINS];
    for (row, law) in forces.iter_mut().zip(&point.law.0) {
        for (c, strain) in law.iter().zip(&point.rows) {
            if *c == 0.0 {
                continue;
            }
            for (sum, x) in row.iter_mut().zip(strain).take(width) {
                *sum += c * point.area * x;
            }
        }
    }
    for (force, strain) in forces.iter().zip(&point.rows) {
        for (line, x) in stiffness.iter_mut().zip(strain).take(width) {
            if *x == 0.0 {
                continue;
            }
            for (sum, y) in line.iter_mut().zip(force).take(width) {
                *sum += x * y;
            }
        }
    }
}

/// Adds a vector to the columns of a row from `first` on.
fn put(row: &mut [f64; WIDTH], first: usize, factor: f64, vector: Vector) {
    for (x, v) in row.iter_mut().skip(first).zip(vector) {
        *x += factor * v;
    }
}
