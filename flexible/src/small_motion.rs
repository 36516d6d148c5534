//! The linear equations of a reduced body for small motions: mass, stiffness and damping, as other codes take them.
//!
//! The coordinates are `q = [r, φ, a]`: the small displacement r of the frame's origin (m), the small rotation φ of the
//! frame (rad), and the amplitudes a of the modes. Forces on them are a force, a torque about the frame's origin, and
//! generalised forces of the modes. The equations are `M q̈ + D q̇ + K q = Lᵀ f`, and the markers move by
//! `u = L q`. With the mass m, the first moment s and the inertia I of the rest, and the invariants of
//! `eng_system::reduced`:
//!
//! ```text
//!     │ m 1     −s×   Rtᵀ M Φ │        │ 0  0  0    │        │ 1  −p×  T │   translation of a marker at p
//! M = │ s×       I    Rrᵀ M Φ │    K = │ 0  0  0    │    L = │ 0   1   R │   its rotation
//!     │ sym.          Φᵀ M Φ  │        │ 0  0  ΦᵀKΦ │
//! ```
//!
//! They follow from the kinetic energy of the floating frame at rest, to second order; all axes are those of the body.
//! Gyroscopic and centrifugal terms, geometric stiffness and elastic surfaces are not part of them.

use crate::fe::vector::cross;
use eng_system::reduced::ReducedBody;

/// Coordinates of the frame: three translations, three rotations.
pub const RIGID: usize = 6;

/// A dense matrix, row by row.
#[derive(Clone, Debug, PartialEq)]
pub struct Dense {
    rows: usize,
    columns: usize,
    values: Vec<f64>,
}

impl Dense {
    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Number of columns.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Rows one after the other.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// A matrix of zeros.
    pub fn zero(rows: usize, columns: usize) -> Dense {
        Dense {
            rows,
            columns,
            values: vec![0.0; rows * columns],
        }
    }

    /// An entry; zero outside of the matrix.
    pub fn at(&self, row: usize, column: usize) -> f64 {
        let index = row * self.columns + column;
        let inside = column < self.columns;
        self.values
            .get(index)
            .filter(|_| inside)
            .copied()
            .unwrap_or(0.0)
    }

    fn set(&mut self, row: usize, column: usize, value: f64) {
        if let Some(entry) = self.values.get_mut(row * self.columns + column) {
            *entry = value;
        }
    }

    fn set_both(&mut self, row: usize, column: usize, value: f64) {
        self.set(row, column, value);
        self.set(column, row, value);
    }
}

/// The equations of small motions of a reduced body.
#[derive(Clone, Debug, PartialEq)]
pub struct SmallMotion {
    /// M (6 + n square; kg, kg m, kg m², and those of the amplitudes).
    pub mass: Dense,
    /// K.
    pub stiffness: Dense,
    /// D.
    pub damping: Dense,
    /// L: six rows for each marker of the body, in its order.
    pub motion: Dense,
}

/// Component i of the motion of a point p by a unit turn about axis k: of `e_k × p`.
fn turned(p: [f64; 3], i: usize, k: usize) -> f64 {
    let axis = [0, 1, 2].map(|l| if l == k { 1.0 } else { 0.0 });
    cross(axis, p).get(i).copied().unwrap_or(0.0)
}

impl SmallMotion {
    /// The equations of a body whose invariants have no defect.
    pub fn new(body: &ReducedBody) -> SmallMotion {
        let constants = &body.invariants;
        let n = constants.modes;
        let size = RIGID + n;
        let block = |values: &[f64], row: usize, column: usize| {
            values.get(row * n + column).copied().unwrap_or(0.0)
        };
        let mut mass = Dense::zero(size, size);
        for i in 0..3 {
            mass.set(i, i, constants.mass);
            for k in 0..3 {
                mass.set_both(i, 3 + k, turned(constants.first_moment, i, k));
                let inertia = constants.inertia.get(i).and_then(|row| row.get(k));
                mass.set(3 + i, 3 + k, inertia.copied().unwrap_or(0.0));
            }
            for mode in 0..n {
                mass.set_both(i, RIGID + mode, block(&constants.translation, i, mode));
                mass.set_both(3 + i, RIGID + mode, block(&constants.rotation, i, mode));
            }
        }
        let mut stiffness = Dense::zero(size, size);
        let mut damping = Dense::zero(size, size);
        for row in 0..n {
            for column in 0..n {
                let place = (RIGID + row, RIGID + column);
                mass.set(place.0, place.1, block(&constants.modal_mass, row, column));
                stiffness.set(place.0, place.1, block(&constants.stiffness, row, column));
                damping.set(place.0, place.1, block(&constants.damping, row, column));
            }
        }
        let mut motion = Dense::zero(RIGID * body.markers.len(), size);
        for (index, marker) in body.markers.iter().enumerate() {
            for i in 0..3 {
                let (along, about) = (RIGID * index + i, RIGID * index + 3 + i);
                motion.set(along, i, 1.0);
                motion.set(about, 3 + i, 1.0);
                for k in 0..3 {
                    motion.set(along, 3 + k, turned(marker.position, i, k));
                }
                for mode in 0..n {
                    motion.set(along, RIGID + mode, block(&marker.translation, i, mode));
                    motion.set(about, RIGID + mode, block(&marker.rotation, i, mode));
                }
            }
        }
        SmallMotion {
            mass,
            stiffness,
            damping,
            motion,
        }
    }
}
