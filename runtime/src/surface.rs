//! Elastic surfaces: the parts of flexible bodies that fields press on.
//!
//! A surface has K shapes. The modes of its body move them by `b = Ψ a` and `ḃ = Ψ ȧ`, which are drives of
//! the field after those that the element computes. The generalised forces f of the shapes are answers after
//! the others, and `Ψᵀ f` acts on the modes ([`eng_system::reduced::ReducedSurface`]).

use eng_system::dense::{add_scaled, add_transposed, dot};

/// A surface under a field.
#[derive(Clone, Debug, PartialEq)]
pub struct SurfaceModel {
    /// The element of the field.
    pub element: usize,
    /// Index of the field among those of the element.
    pub field: usize,
    /// The flexible body.
    pub body: usize,
    /// Index of the marker among those of the reduced body.
    pub marker: usize,
    /// Its modes, n.
    pub modes: usize,
    /// Ψ, K × n, row-major (m per unit of amplitude).
    pub content: Vec<f64>,
    /// First amplitude of the body among the pose numbers.
    pub pose: usize,
    /// First modal rate of the body among the velocities.
    pub velocity: usize,
    /// First of its shapes among those of all surfaces.
    pub first: usize,
    /// Number of its shapes, K.
    pub shapes: usize,
}

impl SurfaceModel {
    /// The places of its amplitudes, and of their rates after them, among those of all surfaces.
    pub fn motion(&self) -> std::ops::Range<usize> {
        2 * self.first..2 * (self.first + self.shapes)
    }

    /// The places of its forces among those of all surfaces.
    pub fn forces(&self) -> std::ops::Range<usize> {
        self.first..self.first + self.shapes
    }

    /// `out = Ψ x` for amplitudes or rates of the body's modes.
    pub fn content_of(&self, x: &[f64], out: &mut [f64]) {
        for (sum, row) in out
            .iter_mut()
            .zip(self.content.chunks_exact(self.modes.max(1)))
        {
            *sum = dot(row, x);
        }
    }

    /// `out += factor Ψᵀ f` on the modes of the body.
    pub fn add_modal_force(&self, factor: f64, forces: &[f64], out: &mut [f64]) {
        for (force, row) in forces
            .iter()
            .zip(self.content.chunks_exact(self.modes.max(1)))
        {
            add_scaled(out, factor * force, row);
        }
    }

    /// `out += block Ψ` for rows over the shapes; rows of `out` are over the modes.
    pub fn add_by_modes(&self, block: &[f64], out: &mut [f64]) {
        let rows = out.chunks_exact_mut(self.modes.max(1));
        for (line, row) in rows.zip(block.chunks_exact(self.shapes.max(1))) {
            add_transposed(line, &self.content, row);
        }
    }

    /// `out += Ψᵀ block` for one row of `width` numbers each shape; `out` has one row each mode.
    pub fn add_on_modes(&self, block: &[f64], width: usize, out: &mut [f64]) {
        let rows = block.chunks_exact(width.max(1));
        for (content, row) in self.content.chunks_exact(self.modes.max(1)).zip(rows) {
            for (factor, line) in content.iter().zip(out.chunks_exact_mut(width.max(1))) {
                add_scaled(line, *factor, row);
            }
        }
    }
}
