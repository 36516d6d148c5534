//! The kinematic chain: from bodies to markers and back, the same for every law.
//!
//! A marker at the place `s` of a rigid body, with axes `C` (marker → body):
//!
//! ```text
//! x = r + A s          R = A C
//! ẋ = ṙ + A (ω × s)    ω_m = Cᵀ ω              (m/s; rad/s in marker axes)
//! [δx; δπ_m] = J [δr; δπ]                       J = [I, −A s~; 0, Cᵀ]
//! ```
//!
//! The twist is `J v`, the generalised force of a wrench `W` is `Jᵀ W`, and the marker's acceleration `J v̇ + J̇ v`.
//! With frozen W and v, `∂(JᵀW)/∂q` and `∂(Jv)/∂q` are what makes Newton's matrix exact.

use crate::body::{BodyFrame, BodyKind, BodyModel};
use crate::model::MarkerModel;
use crate::rotation::{M3, V3, skew};

/// Pose and twist of a marker.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MarkerKinematics {
    /// Origin (m, inertial).
    pub position: V3,
    /// Marker → inertial.
    pub rotation: M3,
    /// Velocity of the origin (m/s, inertial).
    pub velocity: V3,
    /// Angular velocity (rad/s, marker axes).
    pub angular_velocity: V3,
}

/// Pose and twist of a marker on ground.
pub fn ground(marker: &MarkerModel) -> MarkerKinematics {
    MarkerKinematics {
        position: marker.position,
        rotation: marker.orientation,
        velocity: V3::zeros(),
        angular_velocity: V3::zeros(),
    }
}

/// Pose and twist of a marker on a body with the velocities `v` of that body.
pub fn kinematics(
    body: &BodyModel,
    frame: &BodyFrame,
    marker: &MarkerModel,
    v: &[f64],
) -> MarkerKinematics {
    match &body.kind {
        BodyKind::Rigid(_) => {
            let omega = V3::new(v[3], v[4], v[5]);
            MarkerKinematics {
                position: frame.position + frame.rotation * marker.position,
                rotation: frame.rotation * marker.orientation,
                velocity: V3::new(v[0], v[1], v[2])
                    + frame.rotation * omega.cross(&marker.position),
                angular_velocity: marker.orientation.transpose() * omega,
            }
        }
    }
}

/// J, row-major 6 × width.
pub fn jacobian(body: &BodyModel, frame: &BodyFrame, marker: &MarkerModel, out: &mut [f64]) {
    let width = body.width();
    match &body.kind {
        BodyKind::Rigid(_) => {
            let arm = -(frame.rotation * skew(&marker.position));
            for i in 0..3 {
                for j in 0..3 {
                    out[i * width + j] = if i == j { 1.0 } else { 0.0 };
                    out[i * width + 3 + j] = arm[(i, j)];
                    out[(3 + i) * width + j] = 0.0;
                    out[(3 + i) * width + 3 + j] = marker.orientation[(j, i)];
                }
            }
        }
    }
}

/// `∂(J v)/∂q` for frozen v, row-major 6 × width, written: `δẋ = A (δπ × (ω × s))`.
pub fn twist_by_pose(
    body: &BodyModel,
    frame: &BodyFrame,
    marker: &MarkerModel,
    v: &[f64],
    out: &mut [f64],
) {
    let width = body.width();
    match &body.kind {
        BodyKind::Rigid(_) => {
            let omega = V3::new(v[3], v[4], v[5]);
            let block = -(frame.rotation * skew(&omega.cross(&marker.position)));
            out[..6 * width].fill(0.0);
            for i in 0..3 {
                for j in 0..3 {
                    out[i * width + 3 + j] = block[(i, j)];
                }
            }
        }
    }
}

/// `∂(Jᵀ W)/∂q` for a frozen wrench (force inertial, torque marker axes), row-major width × width, written:
/// the torque `s × AᵀF` turns as `s~ (AᵀF)~ δπ`.
pub fn force_by_pose(
    body: &BodyModel,
    frame: &BodyFrame,
    marker: &MarkerModel,
    wrench: &[f64],
    out: &mut [f64],
) {
    let width = body.width();
    match &body.kind {
        BodyKind::Rigid(_) => {
            let force = frame.rotation.transpose() * V3::new(wrench[0], wrench[1], wrench[2]);
            let block = skew(&marker.position) * skew(&force);
            out[..width * width].fill(0.0);
            for i in 0..3 {
                for j in 0..3 {
                    out[(3 + i) * width + 3 + j] = block[(i, j)];
                }
            }
        }
    }
}

/// `J̇ v`: acceleration of the marker (ẍ inertial m/s², ω̇ in marker axes rad/s²) at `v̇ = 0`.
pub fn acceleration_bias(
    body: &BodyModel,
    frame: &BodyFrame,
    marker: &MarkerModel,
    v: &[f64],
) -> [f64; 6] {
    match &body.kind {
        BodyKind::Rigid(_) => {
            let omega = V3::new(v[3], v[4], v[5]);
            let x = frame.rotation * omega.cross(&omega.cross(&marker.position));
            [x.x, x.y, x.z, 0.0, 0.0, 0.0]
        }
    }
}

/// Multiplies the pose columns of a row-major `rows` × width block by T of the step's rotation, in place.
pub fn turn_columns(block: &mut [f64], rows: usize, width: usize, turn: &M3) {
    for i in 0..rows {
        let row = &mut block[i * width + 3..i * width + 6];
        let old = [row[0], row[1], row[2]];
        for (j, value) in row.iter_mut().enumerate() {
            *value = old[0] * turn[(0, j)] + old[1] * turn[(1, j)] + old[2] * turn[(2, j)];
        }
    }
}
