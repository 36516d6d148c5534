//! The kinematic chain: from bodies to markers and back, the same for every law.
//!
//! A marker has the undeformed position `s` in its body and the axes `C` (marker → body). On a flexible body
//! with amplitudes a, its shape ([`crate::shape`]) gives the displacement `u(a)` and the rotation `θ(a)` with
//! the derivatives Φt and Φr. Then `p = s + u`, and `E = exp(θ~)` turns the marker. On a rigid body u and θ
//! are zero.
//!
//! ```text
//! x = r + A p                    R = A E C
//! ẋ = ṙ + A (ω × p + Φt ȧ)       ω_m = Cᵀ Eᵀ (ω + T Φr ȧ)              (m/s; rad/s in marker axes)
//! [δx; δπ_m] = J [δr; δπ; δa]    J = [I, −A p~, A Φt; 0, CᵀEᵀ, CᵀEᵀ T Φr]
//! ```
//!
//! with `T(θ) = Σ θ~ᵏ/(k+1)!`, the exact `d exp(θ~) = (T dθ)~ exp(θ~)`. With `T = I` velocity constraints
//! would not be the rates of the position constraints. The twist is `J v`, the generalised force of a wrench
//! `W` is `Jᵀ W`, and the marker's acceleration is `J v̇ + J̇ v`. With frozen W and v, `∂(JᵀW)/∂q` and
//! `∂(Jv)/∂q` make Newton's matrix exact.
//!
//! A marker depends on the shape of its body only through `u` and `θ`. So all of the above is computed in the
//! marker's *reach*. On a rigid body the reach has six numbers, `(δr, δπ)`. On a flexible one it has twelve,
//! `(δr, δπ, δu = Φt δa, δθ = Φr δa)`, like a body of six modes with unit shapes. Sums over elements are made
//! in the reach. Φ expands them once for each marker, so their cost does not depend on the number of modes.
//! For a shape of second order Φ depends on a, and the reach has six more numbers: the changes of u̇ and θ̇
//! with δa at frozen ȧ.

use crate::body::{BodyFrame, BodyModel};
use crate::rotation::{M3, V3, add_block, exponential, matrix, skew, tangent, tangent_along};
use crate::shape::MarkerShape;
use eng_system::dense::add_six;

/// Size of the reach of a marker with a linear shape.
pub const REACH: usize = 12;
/// Size of the reach of a marker with a shape of second order.
pub const CURVED_REACH: usize = 18;

/// Size of the reach of a marker with this shape.
pub fn reach_of(shape: Option<&MarkerShape>) -> usize {
    match shape {
        None => 6,
        Some(shape) if shape.is_curved() => CURVED_REACH,
        Some(_) => REACH,
    }
}

/// A marker with its numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct MarkerModel {
    /// Index of its body; `None` for ground.
    pub body: Option<usize>,
    /// Position in the body frame (m).
    pub position: V3,
    /// Marker → body.
    pub orientation: M3,
    /// Its motion with the modes of a flexible body; `None` on a rigid body.
    pub shape: Option<MarkerShape>,
    /// The marker with which it coincides at the start, until assembly has placed it.
    pub placed_at: Option<usize>,
}

impl MarkerModel {
    /// Size of its reach: see the head of this module.
    pub fn reach(&self) -> usize {
        reach_of(self.shape.as_ref())
    }
}

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

/// Position and orientation of a marker in its deformed body.
#[derive(Clone, Copy, Debug)]
pub struct Placed {
    /// p (m, body axes).
    pub position: V3,
    /// E C: marker → body.
    pub orientation: M3,
    /// Additional data on a flexible body.
    bent: Option<Bent>,
    reach: usize,
}

#[derive(Clone, Copy, Debug)]
struct Bent {
    /// θ (rad, body axes).
    theta: V3,
    /// T(θ).
    turn: M3,
}

/// The motion of a body as far as a marker depends on it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// ṙ (m/s, inertial).
    pub velocity: V3,
    /// ω (rad/s, body axes).
    pub omega: V3,
    /// u̇ = Φt ȧ (m/s, body axes).
    pub rate: V3,
    /// θ̇ = Φr ȧ (rad/s, body axes).
    pub turning: V3,
}

impl Placed {
    /// The marker's placement at the amplitudes of a frame.
    pub fn new(frame: &BodyFrame, marker: &MarkerModel) -> Placed {
        let Some(shape) = &marker.shape else {
            return Placed {
                position: marker.position,
                orientation: marker.orientation,
                bent: None,
                reach: 6,
            };
        };
        let (displacement, theta) = shape.displacement(frame.amplitudes);
        Placed {
            position: marker.position + displacement,
            orientation: matrix(&exponential(&theta)) * marker.orientation,
            // increments in body axes use the other trivialisation: T(θ) = tangent(−θ)
            bent: Some(Bent {
                theta,
                turn: tangent(&-theta),
            }),
            reach: reach_of(Some(shape)),
        }
    }

    /// Six, twelve or eighteen; see the head of this module.
    pub fn reach(&self) -> usize {
        self.reach
    }
}

impl Motion {
    /// The motion from a body's velocities, or from another vector of that kind, at the amplitudes of a
    /// frame.
    pub fn new(frame: &BodyFrame, marker: &MarkerModel, v: &[f64]) -> Motion {
        let (rate, turning) = match &marker.shape {
            Some(shape) => shape.rate(frame.amplitudes, &v[6..6 + shape.modes()]),
            None => (V3::zeros(), V3::zeros()),
        };
        Motion {
            velocity: V3::new(v[0], v[1], v[2]),
            omega: V3::new(v[3], v[4], v[5]),
            rate,
            turning,
        }
    }

    /// The same as numbers of the marker's reach.
    pub fn numbers(&self) -> [f64; REACH] {
        let mut out = [0.0; REACH];
        for (part, x) in
            out.chunks_exact_mut(3)
                .zip([&self.velocity, &self.omega, &self.rate, &self.turning])
        {
            part.copy_from_slice(x.as_slice());
        }
        out
    }
}

/// Expands rows over a marker's reach to rows over its body's velocities: `out += block · [1, 0; 0, Φ]`, with
/// the rows Φ of [`MarkerShape::fill_rows`], empty on a rigid body.
pub fn expand(shape: &[f64], block: &[f64], reach: usize, width: usize, out: &mut [f64]) {
    let six = 6 * width.saturating_sub(6);
    for (row, line) in block.chunks_exact(reach).zip(out.chunks_exact_mut(width)) {
        for (x, y) in line[..6].iter_mut().zip(row) {
            *x += y;
        }
        let parts = shape.chunks_exact(six.max(1));
        for (factors, rows) in row[6..].as_chunks::<6>().0.iter().zip(parts) {
            add_six(&mut line[6..], factors, rows);
        }
    }
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
pub fn kinematics(frame: &BodyFrame, marker: &MarkerModel, v: &[f64]) -> MarkerKinematics {
    if marker.shape.is_none() {
        return rigid_kinematics(frame, marker, v);
    }
    let (placed, motion) = (Placed::new(frame, marker), Motion::new(frame, marker, v));
    seen(&frame.rotation, &frame.position, &placed, &motion)
}

/// [`kinematics`] of a marker on a rigid body.
pub fn rigid_kinematics(frame: &BodyFrame, marker: &MarkerModel, v: &[f64]) -> MarkerKinematics {
    let (velocity, angular_velocity) = rigid_twist(&frame.rotation, marker, v);
    MarkerKinematics {
        position: frame.position + frame.rotation * marker.position,
        rotation: frame.rotation * marker.orientation,
        velocity,
        angular_velocity,
    }
}

/// Velocity of a marker's origin (m/s, inertial) and its angular velocity (rad/s, marker axes) on a rigid body.
pub fn rigid_twist(rotation: &M3, marker: &MarkerModel, v: &[f64]) -> (V3, V3) {
    let omega = V3::new(v[3], v[4], v[5]);
    (
        V3::new(v[0], v[1], v[2]) + rotation * omega.cross(&marker.position),
        marker.orientation.transpose() * omega,
    )
}

/// [`kinematics`] of a marker from its placement and the pose of its body.
pub fn seen(rotation: &M3, origin: &V3, placed: &Placed, motion: &Motion) -> MarkerKinematics {
    let (velocity, angular_velocity) = twist(rotation, placed, motion);
    MarkerKinematics {
        position: origin + rotation * placed.position,
        rotation: rotation * placed.orientation,
        velocity,
        angular_velocity,
    }
}

/// Velocity of a marker's origin (m/s, inertial) and its angular velocity (rad/s, marker axes).
pub fn twist(rotation: &M3, placed: &Placed, motion: &Motion) -> (V3, V3) {
    let mut arm = motion.omega.cross(&placed.position);
    let mut spin = motion.omega;
    if let Some(bent) = &placed.bent {
        arm += motion.rate;
        spin += bent.turn * motion.turning;
    }
    (
        motion.velocity + rotation * arm,
        placed.orientation.transpose() * spin,
    )
}

/// J, row-major 6 × width.
pub fn jacobian(body: &BodyModel, frame: &BodyFrame, marker: &MarkerModel, out: &mut [f64]) {
    let placed = Placed::new(frame, marker);
    let mut block = [0.0; 6 * CURVED_REACH];
    let block = &mut block[..6 * placed.reach()];
    jacobian_in_reach(&frame.rotation, &placed, block);
    out[..6 * body.width()].fill(0.0);
    let mut rows = Vec::new();
    if let Some(shape) = &marker.shape {
        rows.resize(shape.length(), 0.0);
        shape.fill_rows(frame.amplitudes, frame.amplitudes, &mut rows);
    }
    expand(&rows, block, placed.reach(), body.width(), out);
}

/// J of a marker on a rigid body. Overwrites the six rows.
pub fn rigid_jacobian(frame: &BodyFrame, marker: &MarkerModel, out: &mut [[f64; 6]]) {
    let arm = -(frame.rotation * skew(&marker.position));
    for (i, row) in out.iter_mut().take(6).enumerate() {
        *row = if i < 3 {
            let mut row = [0.0, 0.0, 0.0, arm[(i, 0)], arm[(i, 1)], arm[(i, 2)]];
            row[i] = 1.0;
            row
        } else {
            let axis = marker.orientation.column(i - 3);
            [0.0, 0.0, 0.0, axis[0], axis[1], axis[2]]
        };
    }
}

/// J in the marker's reach, row-major 6 × reach. Overwrites `out`.
pub fn jacobian_in_reach(rotation: &M3, placed: &Placed, out: &mut [f64]) {
    let width = placed.reach();
    out[..6 * width].fill(0.0);
    let back = placed.orientation.transpose();
    add_block(out, width, 0, 0, &M3::identity());
    add_block(out, width, 0, 3, &-(rotation * skew(&placed.position)));
    add_block(out, width, 3, 3, &back);
    if let Some(bent) = &placed.bent {
        add_block(out, width, 0, 6, rotation);
        add_block(out, width, 3, 9, &(back * bent.turn));
    }
}

/// `∂(J v)/∂q` for frozen v in the marker's reach, row-major 6 × reach. Overwrites `out`. For ẋ:
/// `A (δπ × (ω×p + u̇) + ω × δu + δu̇)`. For ω_m, with `y = ω + T θ̇`:
/// `CᵀEᵀ (y × T δθ + ∂(T θ̇)/∂θ δθ + T δθ̇)`, θ̇ frozen in the second term.
pub fn twist_by_pose(rotation: &M3, placed: &Placed, motion: &Motion, out: &mut [f64]) {
    let width = placed.reach();
    out[..6 * width].fill(0.0);
    let arm = motion.omega.cross(&placed.position) + motion.rate;
    add_block(out, width, 0, 3, &-(rotation * skew(&arm)));
    if let Some(bent) = &placed.bent {
        add_block(out, width, 0, 6, &(rotation * skew(&motion.omega)));
        let spin = motion.omega + bent.turn * motion.turning;
        let by_theta = skew(&spin) * bent.turn + tangent_along(&bent.theta, &motion.turning);
        let back = placed.orientation.transpose();
        add_block(out, width, 3, 9, &(back * by_theta));
        if width == CURVED_REACH {
            add_block(out, width, 0, 12, rotation);
            add_block(out, width, 3, 15, &(back * bent.turn));
        }
    }
}

/// `∂(Jᵀ W)/∂q` for a frozen wrench (force inertial, torque marker axes) in the marker's reach, row-major
/// reach × reach. Overwrites `out`. [`MarkerShape::add_pull`] adds the change of the expansion by Φ(a). With
/// `f = AᵀF`, `t = E C τ`: `JᵀW = [F; p×f + t; f; Tᵀ t]`, `δf = f × δπ`, `δt = T δθ × t`, and
/// `Tᵀ(θ) = T(−θ)`.
pub fn force_by_pose(rotation: &M3, placed: &Placed, wrench: &[f64], out: &mut [f64]) {
    let width = placed.reach();
    let force = rotation.transpose() * V3::new(wrench[0], wrench[1], wrench[2]);
    let cross = skew(&force);
    out[..width * width].fill(0.0);
    add_block(out, width, 3, 3, &(skew(&placed.position) * cross));
    if let Some(bent) = &placed.bent {
        let torque = placed.orientation * V3::new(wrench[3], wrench[4], wrench[5]);
        let torque_by_theta = -(skew(&torque) * bent.turn);
        add_block(out, width, 3, 6, &-cross);
        add_block(out, width, 3, 9, &torque_by_theta);
        add_block(out, width, 6, 3, &cross);
        let by_theta =
            bent.turn.transpose() * torque_by_theta - tangent_along(&-bent.theta, &torque);
        add_block(out, width, 9, 9, &by_theta);
    }
}

/// `J̇ v` of a marker on a body with the velocities `v` of that body, from its placement.
pub fn bias(frame: &BodyFrame, placed: &Placed, marker: &MarkerModel, v: &[f64]) -> [f64; 6] {
    let swing = match &marker.shape {
        Some(shape) => shape.swing(&v[6..6 + shape.modes()]),
        None => (V3::zeros(), V3::zeros()),
    };
    let motion = Motion::new(frame, marker, v);
    acceleration_bias(&frame.rotation, placed, &motion, &swing)
}

/// `J̇ v`: acceleration of the marker (ẍ inertial m/s², ω̇ in marker axes rad/s²) at `v̇ = 0`. With the
/// second rates `swing` (ü, θ̈) of u and θ it is `A (ω×(ω×p) + 2 ω×u̇ + ü)` and
/// `CᵀEᵀ (ω × T θ̇ + ∂(T θ̇)/∂θ θ̇ + T θ̈)`.
fn acceleration_bias(
    rotation: &M3,
    placed: &Placed,
    motion: &Motion,
    swing: &(V3, V3),
) -> [f64; 6] {
    let omega = &motion.omega;
    let mut arm = omega.cross(&omega.cross(&placed.position));
    let mut spin = V3::zeros();
    if let Some(bent) = &placed.bent {
        arm += omega.cross(&motion.rate) * 2.0 + swing.0;
        let turning = omega.cross(&(bent.turn * motion.turning))
            + tangent_along(&bent.theta, &motion.turning) * motion.turning
            + bent.turn * swing.1;
        spin = placed.orientation.transpose() * turning;
    }
    let x = rotation * arm;
    [x.x, x.y, x.z, spin.x, spin.y, spin.z]
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
