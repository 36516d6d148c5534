//! Small rotations in ground axes instead of each body's own.
//!
//! The runtime's increments are `u = (δr, δπ, δa)`, with π in body axes. In ground axes they are
//! `(δr, δθ, δa)` with `δθ = A δπ`. Then `δω = Aᵀ θ̇` exactly, for any ω of the body. A symmetric rotor
//! between supports at rest has constant coefficients in ground axes, but not in body axes. So `u = B x`,
//! `δv = B ẋ`, `δv̇ = B (ẍ − Ŵ ẋ)` with `B = diag(1, Aᵀ, 1)` and `Ŵ = diag(0, ω~, 0)`, ω in ground axes.

use crate::dynamics::Dynamics;
use crate::model::Model;
use crate::rotation::{M3, V3};
use nalgebra::{DMatrix, DVectorViewMut};

/// Orientation and angular velocity of one body.
#[derive(Clone, Copy, Debug)]
struct Turning {
    /// First of its rotations among the velocities.
    first: usize,
    /// A, body → ground.
    rotation: M3,
    /// ω in ground axes (rad/s).
    spin: V3,
}

/// Orientations and angular velocities of all bodies.
#[derive(Clone, Debug)]
pub(super) struct GroundAxes(Vec<Turning>);

impl GroundAxes {
    /// The axes at the position of the dynamics, with these velocities (in the runtime's form).
    pub fn new(model: &Model, dynamics: &Dynamics, velocity: &[f64]) -> GroundAxes {
        let turning = |(index, body): (usize, &crate::body::BodyModel)| {
            let rotation = dynamics.frame(model, index).rotation;
            let first = body.velocity + 3;
            let own = V3::new(velocity[first], velocity[first + 1], velocity[first + 2]);
            Turning {
                first,
                rotation,
                spin: rotation * own,
            }
        };
        GroundAxes(model.bodies.iter().enumerate().map(turning).collect())
    }

    /// `X ← X B`: converts columns of the runtime's increments to ground axes.
    pub fn columns(&self, matrix: &mut DMatrix<f64>) {
        for t in &self.0 {
            let block = matrix.columns(t.first, 3) * t.rotation.transpose();
            matrix.columns_mut(t.first, 3).copy_from(&block);
        }
    }

    /// `X ← Bᵀ X`: converts rows of torques from body axes to ground axes.
    pub fn rows(&self, matrix: &mut DMatrix<f64>) {
        for t in &self.0 {
            let block = t.rotation * matrix.rows(t.first, 3);
            matrix.rows_mut(t.first, 3).copy_from(&block);
        }
    }

    /// `x ← B x`.
    pub fn to_body(&self, mut x: DVectorViewMut<'_, f64>) {
        for t in &self.0 {
            let part = t.rotation.transpose() * x.fixed_rows::<3>(t.first);
            x.fixed_rows_mut::<3>(t.first).copy_from(&part);
        }
    }

    /// `x ← B⁻¹ x`.
    pub fn to_ground(&self, mut x: DVectorViewMut<'_, f64>) {
        for t in &self.0 {
            let part = t.rotation * x.fixed_rows::<3>(t.first);
            x.fixed_rows_mut::<3>(t.first).copy_from(&part);
        }
    }

    /// `X Ŵ` for a matrix in ground axes.
    pub fn times_turning(&self, matrix: &DMatrix<f64>) -> DMatrix<f64> {
        let mut out = DMatrix::zeros(matrix.nrows(), matrix.ncols());
        for t in &self.0 {
            let block = matrix.columns(t.first, 3) * crate::rotation::skew(&t.spin);
            out.columns_mut(t.first, 3).copy_from(&block);
        }
        out
    }

    /// `E M − M E` with `E = diag(ω~, ω~, 0)`: the rate of the mass matrix in ground axes of bodies that turn
    /// without changing shape.
    pub fn turned(&self, mass: &DMatrix<f64>) -> DMatrix<f64> {
        let mut along = DMatrix::zeros(mass.nrows(), mass.ncols());
        for t in &self.0 {
            for first in [t.first - 3, t.first] {
                let block = crate::rotation::skew(&t.spin) * mass.rows(first, 3);
                along.rows_mut(first, 3).copy_from(&block);
            }
        }
        // M is symmetric, E is not: (E M)ᵀ = −M E
        &along + along.transpose()
    }

    /// `ω × δθ` of every body's rotation in a vector of ground axes, converted to body axes: `W B x`, the
    /// term of the runtime's bracket.
    pub fn bracket(&self, x: &[f64], out: &mut [f64]) {
        out.fill(0.0);
        for t in &self.0 {
            let theta = V3::new(x[t.first], x[t.first + 1], x[t.first + 2]);
            let turned = t.rotation.transpose() * t.spin.cross(&theta);
            out[t.first..t.first + 3].copy_from_slice(turned.as_slice());
        }
    }
}
