//! Shells: stiffness and mass of thin and thick plates and curved shells.
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
//! Forces and moments per length are `[N; M; Q; k δ] = C [ε; κ; γ; δ]`. There are three forms:
//!
//! * [`quadrilateral`]: MITC4 with an enhanced membrane; for Nastran, with its residual bending flexibility
//! * [`triangle`]: DKMT with a constant membrane or Felippa's optimal one
//! * [`quadratic`]: MITC9 and MITC6 for shells with mid-side nodes
//!
//! **Drilling.** The rotation about the normal has no stiffness in a shell's theory. Here δ is held by
//! `k = G t min(1, t²/h²)` with the distance h of the nodes (the term of T. J. R. Hughes, F. Brezzi, Comput. Methods
//! Appl. Mech. Eng. 72, 1989, with this factor). A rigid motion has δ = 0, so it costs nothing. On a curved
//! surface of radius R the normals of neighbours differ by h/R. With a soft k the twists of neighbours differ,
//! and with this factor the error is `h²/R²` of the twist. A stiff k locks, and with this factor the error is
//! `h²/R²` of the bending. So both errors vanish as the mesh is refined. With a constant factor one of them
//! does not. A moment about the normal turns a node by a large angle, so beams and ties must spread it. The
//! membrane of [`Variant::Drilling`] triangles has these rotations itself, and needs no k.
//!
//! [`Variant::Drilling`]: crate::mesh::Variant::Drilling
//!
//! The mass is consistent, with the rotary inertia ρ t³/12 of the directors; the rotation about the normal
//! has none.
//!
//! **Offset.** A middle surface beside the nodes hangs on them by rigid arms r along their normals: its places
//! and motions are `x + r` and `u + θ × r`. The element is made in the middle surface. So its own bending stays
//! free of its stretching, as in a beam with an eccentric axis.

mod condense;
mod curved;
mod laminate;
mod law;
mod quadratic;
mod quadrilateral;
mod recovery;
mod surface;
mod triangle;

pub(super) use curved::too_curved;
pub(super) use law::{Law, Plate};
pub(super) use quadrilateral::Rotations;
pub(super) use recovery::shell_stresses;

use self::surface::Geometry;
use super::check::list;
use super::rules::{MassRule, Spread, spread};
use super::vector::{Vector, add, cross, dot, norm, scale, subtract};
use crate::element::{ElementKind, MOST_NODES, Shape};
use crate::error::FlexibleError;
use crate::fe::solid::{Present, tangents};
use eng_system::significant::short;

/// Most nodes of a shell, its inner one included.
pub(super) const NODES: usize = 9;

/// The inner node of a quadrilateral with mid-side nodes, by its number in the element.
const NINTH_NODE: usize = 8;

/// The number of inner nodes of a shell. Each has three displacements. A membrane would leave the one along its
/// normal free.
pub(super) fn inner_count(kind: ElementKind, membrane: bool) -> u32 {
    u32::from(kind == ElementKind::Quadrilateral8 && !membrane)
}

/// Most corners of a shell.
const CORNERS: usize = 4;

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
    /// Area that it represents (m²).
    pub area: f64,
    /// Strains for a unit of each freedom: 1/m for a translation and – for a rotation, and for κ 1/m² and
    /// 1/m.
    pub rows: Rows,
    /// The law that belongs to the strains.
    pub law: Law,
    /// Two unit tangents, along which the strains are, and the normal.
    pub axes: [Vector; 3],
    /// Direction of the element's first side there.
    pub side: Vector,
    /// Place in the reference domain.
    pub at: [f64; 2],
}

/// Stiffness and mass of a shell over `count` nodes.
#[derive(Clone, Debug)]
pub(super) struct ShellMatrices {
    /// Stiffness over the six freedoms of each node (N/m, N, N m).
    pub stiffness: [[f64; WIDTH]; WIDTH],
    /// Mass of each pair of nodes, the same in all directions (kg).
    pub mass: [[f64; NODES]; NODES],
    /// Mass between the translations of the first node and the rotations of the second (kg m); `None` for a
    /// section with its mass in the surface of the nodes.
    pub coupling: Option<[[[[f64; 3]; 3]; NODES]; NODES]>,
    /// Rotary inertia of each pair of nodes (kg m²).
    pub rotary: [[[[f64; 3]; 3]; NODES]; NODES],
}

/// A shell.
#[derive(Clone, Debug)]
pub(super) struct Shell<'a> {
    kind: ElementKind,
    /// The nodes that are there. All others are in the middle of their side.
    present: &'a Present,
    /// All nodes of its kind in the middle surface.
    geometry: Geometry,
    /// From the nodes to the middle surface (m).
    arms: [Vector; NODES],
    /// Unit normals at the nodes.
    directors: [Vector; NODES],
    /// Whether rotations about the normal belong to the membrane.
    drilling: bool,
    /// How the directors of a quadrilateral of four nodes turn between them.
    rotations: Rotations,
    /// Its section and material.
    plate: &'a Plate,
}

impl<'a> Shell<'a> {
    /// A shell with its nodes at `places`. With `drilling` the rotations about the normal belong to the
    /// membrane. Only quadrilaterals of four nodes have `rotations`.
    pub fn new(
        kind: ElementKind,
        present: &'a Present,
        places: &Places,
        drilling: bool,
        rotations: Rotations,
        plate: &'a Plate,
    ) -> Self {
        let mut all = [[0.0; 3]; MOST_NODES];
        for (local, place) in present.locals().zip(places) {
            all[local] = *place;
        }
        for (local, [a, b]) in absent(kind, present) {
            all[local] = scale(0.5, add(all[a], all[b]));
        }
        let mut shell = Shell {
            kind,
            present,
            geometry: Geometry::new(kind, &all),
            arms: [[0.0; 3]; NODES],
            directors: [[0.0; 3]; NODES],
            drilling: drilling && !plate.is_membrane(),
            rotations,
            plate,
        };
        shell.directors = shell.normals();
        // a folded element has no normals; its points report it
        let sound = shell.directors.iter().flatten().all(|x| x.is_finite());
        if sound && shell.is_beside() {
            let corners = kind.corner_count();
            for (index, place) in all.iter_mut().enumerate().take(shell.count()) {
                let of = |corner: usize| plate.offsets.get(corner).copied().unwrap_or(0.0);
                let offset = match index.checked_sub(corners) {
                    None => of(index),
                    Some(edge) => {
                        let ends = kind.midside_edges().get(edge);
                        ends.map_or(0.0, |[a, b]| 0.5 * (of(*a) + of(*b)))
                    }
                };
                let arm = scale(offset, shell.directors[index]);
                shell.arms[index] = arm;
                *place = add(*place, arm);
            }
            shell.geometry = Geometry::new(kind, &all);
        }
        shell
    }

    fn count(&self) -> usize {
        self.geometry.count()
    }

    /// The nodes that are there, with the inner one, by their numbers in the element.
    fn nodes(&self) -> impl Iterator<Item = usize> {
        let inner = inner_count(self.kind, self.plate.is_membrane());
        let inner = (inner > 0).then_some(NINTH_NODE);
        self.present.locals().chain(inner)
    }

    /// Whether the middle surface is beside the nodes.
    fn is_beside(&self) -> bool {
        self.plate.offsets != [0.0; CORNERS]
    }

    /// The points of the stiffness, with rows over the freedoms of the nodes that are there.
    ///
    /// # Errors
    /// The area for a unit of the reference domain (m²) where the element is folded or flat.
    pub fn points(&self) -> Result<Vec<ShellPoint>, f64> {
        let mut points = match self.count() {
            3 => triangle::points(&self.geometry.places, self.plate, self.drilling)?,
            4 => quadrilateral::points(&self.geometry, self.plate, self.rotations)?,
            _ => quadratic::points(self.kind, &self.geometry, self.plate)?,
        };
        let absent = absent(self.kind, self.present);
        for row in points.iter_mut().flat_map(|point| &mut point.rows) {
            for (local, ends) in &absent {
                self.remove_midside(row, *local, *ends);
            }
            if self.is_beside() {
                for node in self.present.locals() {
                    let own = vector(row, 6 * node);
                    put(row, 6 * node + 3, 1.0, cross(self.arms[node], own));
                }
            }
            if !absent.is_empty() {
                let all = *row;
                *row = [0.0; WIDTH];
                for (own, local) in row.chunks_exact_mut(6).zip(self.nodes()) {
                    own.copy_from_slice(&all[6 * local..6 * local + 6]);
                }
            }
        }
        Ok(points)
    }

    /// Gives the row of an absent mid-side node to the corners beside it. Its side bends with the constant
    /// curvature of their rotations, so that it does not lock: with the side l from one to the other
    /// `θ = ½ (θ_a + θ_b)` and `u = ½ (u_a + u_b) − ⅛ n n·((θ_b − θ_a) × l)`.
    fn remove_midside(&self, row: &mut [f64; WIDTH], local: usize, [a, b]: [usize; 2]) {
        let (moved, turned) = (vector(row, 6 * local), vector(row, 6 * local + 3));
        let normal = self.directors[local];
        let side = subtract(self.geometry.places[b], self.geometry.places[a]);
        let sag = scale(0.125 * dot(moved, normal), cross(side, normal));
        for (corner, sign) in [(a, 1.0), (b, -1.0)] {
            put(row, 6 * corner, 0.5, moved);
            put(row, 6 * corner + 3, 0.5, turned);
            put(row, 6 * corner + 3, sign, sag);
        }
    }

    /// Stiffness `∫ Bᵀ C B dA` and mass `∫ N_a N_b (m v_a·v_b + f (v_a·β_b + β_a·v_b) + j β_a·β_b) dA` with
    /// the motion `v = u + θ × r` of the middle surface and `β = θ × n` of the directors. m, f and j are the
    /// mass per area (kg/m²), its first moment (kg/m) and the rotary inertia per area (kg) about the middle
    /// surface.
    ///
    /// # Errors
    /// As [`Shell::points`].
    pub fn matrices(&self, rule: MassRule) -> Result<ShellMatrices, f64> {
        let mut out = ShellMatrices {
            stiffness: [[0.0; WIDTH]; WIDTH],
            mass: [[0.0; NODES]; NODES],
            coupling: None,
            rotary: [[[[0.0; 3]; 3]; NODES]; NODES],
        };
        let width = 6 * self.nodes().count();
        for point in self.points()? {
            add_stiffness(&point, width, &mut out.stiffness);
        }
        self.add_mass(rule, &mut out);
        Ok(out)
    }

    fn add_mass(&self, rule: MassRule, out: &mut ShellMatrices) {
        let (own, count) = (self.present.locals().count(), self.nodes().count());
        let mut tables = [[[0.0; NODES]; NODES]; 3];
        for point in (self.kind.description().mass)() {
            let full = Shape::at(self.kind, point.at);
            let [r, s, _] = tangents(&full, &self.geometry.places, self.count());
            let area = point.weight * norm(cross(r, s));
            let corners = Shape::at(self.kind.linear(), point.at);
            let mut values = self.present.shape(&full).values;
            if count > own {
                let [r, s, _] = point.at;
                values[own] = (1.0 - r * r) * (1.0 - s * s);
            }
            let values = &values[..count];
            for (table, factor) in tables.iter_mut().zip(self.plate.inertia(&corners.values)) {
                for (row, first) in table.iter_mut().zip(values) {
                    for (sum, second) in row.iter_mut().zip(values) {
                        *sum += factor * area * first * second;
                    }
                }
            }
        }
        let spread = spread(self.kind, rule);
        for table in &mut tables {
            lump(table, own, spread);
        }
        let [mass, first_moment, mut inertia] = tables;
        if spread == Spread::Equal {
            // a point at the distance f/m from the surface: no inertia of its own
            for a in 0..own {
                let (m, f) = (mass[a][a], first_moment[a][a]);
                inertia[a][a] = if m > 0.0 { f * f / m } else { 0.0 };
            }
        }
        out.mass = mass;
        let beside =
            self.arms != [[0.0; 3]; NODES] || first_moment.iter().flatten().any(|x| *x != 0.0);
        let mut coupling = [[[[0.0; 3]; 3]; NODES]; NODES];
        for (a, local_a) in self.nodes().enumerate() {
            for (b, local_b) in self.nodes().enumerate() {
                let [(arm_a, n_a), (arm_b, n_b)] =
                    [local_a, local_b].map(|node| (self.arms[node], self.directors[node]));
                let rotary = &mut out.rotary[a][b];
                add_product(inertia[a][b], n_a, n_b, rotary);
                if !beside {
                    continue;
                }
                let (m, f) = (mass[a][b], first_moment[a][b]);
                add_product(m, arm_a, arm_b, rotary);
                add_product(f, arm_a, n_b, rotary);
                add_product(f, n_a, arm_b, rotary);
                let [x, y, z] = add(scale(m, arm_b), scale(f, n_b));
                coupling[a][b] = [[0.0, z, -y], [-z, 0.0, x], [y, -x, 0.0]];
            }
        }
        out.coupling = beside.then_some(coupling);
    }

    /// The unit normals of the surface at its nodes.
    fn normals(&self) -> [Vector; NODES] {
        let mut normals = [[0.0; 3]; NODES];
        let own = normals.iter_mut().zip(surface::reference(self.kind));
        for (unit, at) in own.take(self.count()) {
            let shape = Shape::at(self.kind, [at[0], at[1], 0.0]);
            let [r, s, _] = tangents(&shape, &self.geometry.places, self.count());
            let normal = cross(r, s);
            *unit = scale(1.0 / norm(normal), normal);
        }
        normals
    }
}

/// The mid-side nodes that are not there, each with the corners beside it.
fn absent(kind: ElementKind, present: &Present) -> Vec<(usize, [usize; 2])> {
    let corners = kind.corner_count();
    let edges = kind.midside_edges().iter().enumerate();
    edges
        .map(|(edge, ends)| (corners + edge, *ends))
        .filter(|(local, _)| present.locals().all(|own| own != *local))
        .collect()
}

/// Brings a table of pairs of nodes to its diagonal. The inner node after the first `count` ones keeps its own.
fn lump(table: &mut [[f64; NODES]; NODES], count: usize, spread: Spread) {
    let nodes = table.iter().take(count);
    let whole: f64 = nodes.flat_map(|row| &row[..count]).sum();
    let diagonal: f64 = (0..count).map(|a| table[a][a]).sum();
    for (a, row) in table.iter_mut().enumerate() {
        let own = match spread {
            Spread::Consistent => return,
            _ if a >= count => row[a],
            Spread::RowSum => row.iter().sum(),
            Spread::Equal => whole / count as f64,
            Spread::ScaledDiagonal if diagonal == 0.0 => 0.0,
            Spread::ScaledDiagonal => row[a] * whole / diagonal,
        };
        *row = [0.0; NODES];
        row[a] = own;
    }
}

/// Three columns of a row from `first` on.
fn vector(row: &[f64; WIDTH], first: usize) -> Vector {
    std::array::from_fn(|k| row[first + k])
}

/// Adds the matrix of `factor (θ_a × p)·(θ_b × q)`: p·q I − q pᵀ.
fn add_product(factor: f64, p: Vector, q: Vector, block: &mut [[f64; 3]; 3]) {
    let along = dot(p, q);
    for (i, row) in block.iter_mut().enumerate() {
        for (j, entry) in row.iter_mut().enumerate() {
            let same = if i == j { along } else { 0.0 };
            *entry += factor * (same - q[i] * p[j]);
        }
    }
}

/// The error for folded or flat shells, with their ids and areas for a unit of the reference domain (m²).
pub(super) fn folded(faults: &[(u64, f64)]) -> FlexibleError {
    FlexibleError::structure(
        format!(
            "{} folded or flat: {}",
            match faults.len() {
                1 => "1 shell is".to_owned(),
                count => format!("{count} shells are"),
            },
            list(
                faults
                    .iter()
                    .map(|(id, area)| format!("element {id} (area {} m²)", short(*area, 4)))
            )
        ),
        "repair the mesh: order the nodes around the element, and use a triangle where two nodes coincide",
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
fn put(row: &mut [f64], first: usize, factor: f64, vector: Vector) {
    for (x, v) in row.iter_mut().skip(first).zip(vector) {
        *x += factor * v;
    }
}
