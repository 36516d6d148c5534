//! Kinds of bodies: inertia, gravity, and their derivatives.
//!
//! Velocity of a body: `v = [ṙ (inertial, m/s); ω (body axes, rad/s); ȧ (modal)]`. Everything that depends on
//! the kind of a body is a match here or in [`crate::chain`].

use crate::flexible::{Flexible, Work};
pub use crate::frame::{BodyFrame, Weights};
use crate::rotation::{M3, V3, add_block, matrix, skew};
use eng_system::system::Origin;

/// Inertia of a rigid body.
#[derive(Clone, Debug, PartialEq)]
pub struct Rigid {
    /// Mass (kg).
    pub mass: f64,
    /// Centre of mass in the body frame (m).
    pub center: V3,
    /// Inertia about the frame's ORIGIN, body axes (kg m²): `J_c + m (c·c I − c cᵀ)`.
    pub inertia: M3,
}

/// The kind of a body.
#[derive(Clone, Debug, PartialEq)]
pub enum BodyKind {
    /// Rigid.
    Rigid(Rigid),
    /// Flexible, with a floating frame.
    Flexible(Flexible),
}

/// A body with the indices of its numbers in the state.
#[derive(Clone, Debug, PartialEq)]
pub struct BodyModel {
    /// Path and places.
    pub origin: Origin,
    /// Its kind.
    pub kind: BodyKind,
    /// First of its 7 + n pose numbers: r, quaternion, modal amplitudes.
    pub pose: usize,
    /// First of its 6 + n velocities.
    pub velocity: usize,
}

fn vector(x: &[f64]) -> V3 {
    V3::new(x[0], x[1], x[2])
}

impl BodyModel {
    /// Modal amplitudes.
    pub fn modes(&self) -> usize {
        match &self.kind {
            BodyKind::Rigid(_) => 0,
            BodyKind::Flexible(b) => b.modes(),
        }
    }

    /// Velocities: 6 + modes.
    pub fn width(&self) -> usize {
        6 + self.modes()
    }

    /// Mass (kg).
    pub fn mass(&self) -> f64 {
        match &self.kind {
            BodyKind::Rigid(b) => b.mass,
            BodyKind::Flexible(b) => b.constants.mass,
        }
    }

    /// Centre of mass in the body frame (m), undeformed.
    pub fn center(&self) -> V3 {
        match &self.kind {
            BodyKind::Rigid(b) => b.center,
            BodyKind::Flexible(b) => b.center(),
        }
    }

    /// Inertia about the frame's origin, body axes (kg m²), undeformed.
    pub fn inertia(&self) -> &M3 {
        match &self.kind {
            BodyKind::Rigid(b) => &b.inertia,
            BodyKind::Flexible(b) => b.undeformed_inertia(),
        }
    }

    /// Reference frame from the state's pose numbers.
    pub fn frame<'a>(&self, pose: &'a [f64]) -> BodyFrame<'a> {
        let p = &pose[self.pose..];
        BodyFrame {
            position: vector(p),
            rotation: matrix(&[p[3], p[4], p[5], p[6]]),
            amplitudes: &p[7..7 + self.modes()],
        }
    }

    /// Adds `M v̇ − Q_v − Q_g` (N, N m in body axes), and a flexible body's elastic and damping forces. For a
    /// rigid body it follows from the virtual power of `m ẍ` over the body: force
    /// `m (r̈ + A(ω̇×c + ω×(ω×c)) − g)`, torque about the origin `J ω̇ + ω×Jω + m c×Aᵀ(r̈ − g)`.
    pub fn add_inertia(
        &self,
        frame: &BodyFrame,
        v: &[f64],
        rate: &[f64],
        gravity: &V3,
        work: &mut Work,
        out: &mut [f64],
    ) {
        match &self.kind {
            BodyKind::Rigid(b) => {
                let omega = vector(&v[3..]);
                let acceleration = vector(rate) - gravity;
                let alpha = vector(&rate[3..]);
                let a = &frame.rotation;
                let force = (acceleration
                    + a * (alpha.cross(&b.center) + omega.cross(&omega.cross(&b.center))))
                    * b.mass;
                let torque = b.inertia * alpha
                    + omega.cross(&(b.inertia * omega))
                    + b.center.cross(&(a.transpose() * acceleration)) * b.mass;
                for i in 0..3 {
                    out[i] += force[i];
                    out[3 + i] += torque[i];
                }
            }
            BodyKind::Flexible(b) => b.add_inertia(frame, v, rate, gravity, work, out),
        }
    }

    /// Adds the mass matrix, row-major width × width.
    pub fn add_mass(&self, frame: &BodyFrame, work: &mut Work, out: &mut [f64]) {
        let width = self.width();
        match &self.kind {
            BodyKind::Rigid(b) => {
                let coupling = frame.rotation * skew(&b.center) * b.mass;
                add_block(out, width, 0, 0, &(M3::identity() * b.mass));
                add_block(out, width, 0, 3, &(-coupling));
                add_block(out, width, 3, 0, &(-coupling.transpose()));
                add_block(out, width, 3, 3, &b.inertia);
            }
            BodyKind::Flexible(b) => b.add_mass(frame, 1.0, work, out),
        }
    }

    /// Adds the derivative of [`BodyModel::add_inertia`] along the step's unknown, row-major width × width:
    /// `weights.acceleration M + weights.velocity ∂/∂v + ∂/∂q T`, where `turn` is T of the rotation.
    #[allow(clippy::too_many_arguments)]
    pub fn add_inertia_matrix(
        &self,
        frame: &BodyFrame,
        v: &[f64],
        rate: &[f64],
        gravity: &V3,
        weights: Weights,
        turn: &M3,
        work: &mut Work,
        out: &mut [f64],
    ) {
        let width = self.width();
        match &self.kind {
            BodyKind::Rigid(b) => {
                let omega = vector(&v[3..]);
                let acceleration = vector(rate) - gravity;
                let alpha = vector(&rate[3..]);
                let a = &frame.rotation;
                let c = skew(&b.center);
                let w = skew(&omega);
                let coupling = a * c * b.mass;
                add_block(
                    out,
                    width,
                    0,
                    0,
                    &(M3::identity() * (b.mass * weights.acceleration)),
                );
                let by_omega = a * (skew(&omega.cross(&b.center)) + w * c) * (-b.mass);
                let centre_acceleration =
                    alpha.cross(&b.center) + omega.cross(&omega.cross(&b.center));
                let by_turn = a * skew(&centre_acceleration) * (-b.mass) * turn;
                add_block(
                    out,
                    width,
                    0,
                    3,
                    &(coupling * (-weights.acceleration) + by_omega * weights.velocity + by_turn),
                );
                add_block(
                    out,
                    width,
                    3,
                    0,
                    &(coupling.transpose() * (-weights.acceleration)),
                );
                let gyroscopic = w * b.inertia - skew(&(b.inertia * omega));
                let by_turn = c * skew(&(a.transpose() * acceleration)) * b.mass * turn;
                add_block(
                    out,
                    width,
                    3,
                    3,
                    &(b.inertia * weights.acceleration + gyroscopic * weights.velocity + by_turn),
                );
            }
            BodyKind::Flexible(b) => {
                b.add_inertia_matrix(frame, v, rate, gravity, weights, turn, work, out);
            }
        }
    }

    /// Kinetic energy, potential of gravity (zero at the inertial origin), strain energy (J), power lost in
    /// the body's own damping (W).
    pub fn energy(&self, frame: &BodyFrame, v: &[f64], gravity: &V3, work: &mut Work) -> [f64; 4] {
        match &self.kind {
            BodyKind::Rigid(b) => {
                let velocity = vector(v);
                let omega = vector(&v[3..]);
                let arm = frame.rotation * omega.cross(&b.center);
                let kinetic = 0.5 * b.mass * velocity.norm_squared()
                    + b.mass * velocity.dot(&arm)
                    + 0.5 * omega.dot(&(b.inertia * omega));
                let center = frame.position + frame.rotation * b.center;
                [kinetic, -b.mass * gravity.dot(&center), 0.0, 0.0]
            }
            BodyKind::Flexible(b) => b.energy(frame, v, gravity, work),
        }
    }
}
