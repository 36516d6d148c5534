//! The kinematic chain: from bodies to markers and back, the same for every law.
//!
//! A marker at the undeformed place `s` of a body, with axes `C` (marker → body). On a flexible body with amplitudes a its shape
//! rows give the displacement `u = Φt a` and the rotation `θ = Φr a`, so that `p = s + u`, and `E = exp(θ~)` turns the marker
//! (both zero on a rigid body):
//!
//! ```text
//! x = r + A p                    R = A E C
//! ẋ = ṙ + A (ω × p + Φt ȧ)       ω_m = Cᵀ Eᵀ (ω + T Φr ȧ)              (m/s; rad/s in marker axes)
//! [δx; δπ_m] = J [δr; δπ; δa]    J = [I, −A p~, A Φt; 0, CᵀEᵀ, CᵀEᵀ T Φr]
//! ```
//!
//! with `T(θ) = Σ θ~ᵏ/(k+1)!`, the exact `d exp(θ~) = (T dθ)~ exp(θ~)`: with `T = I` velocity constraints would not be the
//! rates of the position constraints. The twist is `J v`, the generalised force of a wrench `W` is `Jᵀ W`, and the marker's
//! acceleration `J v̇ + J̇ v`. With frozen W and v, `∂(JᵀW)/∂q` and `∂(Jv)/∂q` are what makes Newton's matrix exact.

use crate::body::{BodyFrame, BodyModel};
use crate::model::{MarkerModel, MarkerShape};
use crate::rotation::{M3, V3, exponential, matrix, skew, tangent, tangent_along};

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

/// Where a marker stands in its deformed body.
#[derive(Clone, Copy, Debug)]
struct Placed<'a> {
    /// p (m, body axes).
    position: V3,
    /// E C: marker → body.
    orientation: M3,
    /// θ (rad, body axes).
    theta: V3,
    /// T(θ).
    turn: M3,
    shape: Option<&'a MarkerShape>,
}

impl<'a> Placed<'a> {
    fn new(frame: &BodyFrame, marker: &'a MarkerModel) -> Placed<'a> {
        let mut placed = Placed {
            position: marker.position,
            orientation: marker.orientation,
            theta: V3::zeros(),
            turn: M3::identity(),
            shape: marker.shape.as_ref(),
        };
        if let Some(shape) = placed.shape {
            placed.position += along(&shape.translation, frame.amplitudes);
            placed.theta = along(&shape.rotation, frame.amplitudes);
            placed.orientation = matrix(&exponential(&placed.theta)) * marker.orientation;
            // the other trivialisation than that of increments in body axes: T(θ) = tangent(−θ)
            placed.turn = tangent(&(-placed.theta));
        }
        placed
    }

    /// Φt ȧ and Φr ȧ.
    fn rates(&self, v: &[f64]) -> (V3, V3) {
        match self.shape {
            Some(shape) => (
                along(&shape.translation, &v[6..]),
                along(&shape.rotation, &v[6..]),
            ),
            None => (V3::zeros(), V3::zeros()),
        }
    }
}

/// Three rows times a vector.
fn along(rows: &[f64], x: &[f64]) -> V3 {
    let n = rows.len() / 3;
    let row = |i: usize| -> f64 {
        rows[i * n..(i + 1) * n]
            .iter()
            .zip(x)
            .map(|(r, x)| r * x)
            .sum()
    };
    V3::new(row(0), row(1), row(2))
}

/// `out += block · rows`: three rows from `row` on, modal columns from `column` on.
fn put_modal(out: &mut [f64], width: usize, row: usize, block: &M3, rows: &[f64]) {
    let n = rows.len() / 3;
    for i in 0..3 {
        let line = &mut out[(row + i) * width + 6..(row + i) * width + 6 + n];
        for k in 0..3 {
            let factor = block[(i, k)];
            if factor != 0.0 {
                for (x, r) in line.iter_mut().zip(&rows[k * n..(k + 1) * n]) {
                    *x += factor * r;
                }
            }
        }
    }
}

/// `out += rowsᵀ · block` at the modal rows, three columns from `column` on.
fn put_modal_rows(out: &mut [f64], width: usize, column: usize, rows: &[f64], block: &M3) {
    let n = rows.len() / 3;
    for m in 0..n {
        for j in 0..3 {
            let x: f64 = (0..3).map(|k| rows[k * n + m] * block[(k, j)]).sum();
            out[(6 + m) * width + column + j] += x;
        }
    }
}

fn put(out: &mut [f64], width: usize, row: usize, column: usize, block: &M3) {
    for i in 0..3 {
        for j in 0..3 {
            out[(row + i) * width + column + j] += block[(i, j)];
        }
    }
}

fn omega_of(v: &[f64]) -> V3 {
    V3::new(v[3], v[4], v[5])
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
    let omega = omega_of(v);
    let placed = Placed::new(frame, marker);
    let (rate, turning) = placed.rates(v);
    MarkerKinematics {
        position: frame.position + frame.rotation * placed.position,
        rotation: frame.rotation * placed.orientation,
        velocity: V3::new(v[0], v[1], v[2])
            + frame.rotation * (omega.cross(&placed.position) + rate),
        angular_velocity: placed.orientation.transpose() * (omega + placed.turn * turning),
    }
}

/// J, row-major 6 × width.
pub fn jacobian(body: &BodyModel, frame: &BodyFrame, marker: &MarkerModel, out: &mut [f64]) {
    let width = body.width();
    let placed = Placed::new(frame, marker);
    out[..6 * width].fill(0.0);
    let back = placed.orientation.transpose();
    put(out, width, 0, 0, &M3::identity());
    put(
        out,
        width,
        0,
        3,
        &-(frame.rotation * skew(&placed.position)),
    );
    put(out, width, 3, 3, &back);
    if let Some(shape) = placed.shape {
        put_modal(out, width, 0, &frame.rotation, &shape.translation);
        put_modal(out, width, 3, &(back * placed.turn), &shape.rotation);
    }
}

/// `∂(J v)/∂q` for frozen v, row-major 6 × width, written. Of ẋ: `A (δπ × (ω×p + Φtȧ) + ω × Φt δa)`. Of ω_m, with
/// `y = ω + T Φr ȧ`: `CᵀEᵀ (y × T δθ + ∂(T θ̇)/∂θ δθ)`, θ̇ frozen.
pub fn twist_by_pose(
    body: &BodyModel,
    frame: &BodyFrame,
    marker: &MarkerModel,
    v: &[f64],
    out: &mut [f64],
) {
    let width = body.width();
    let omega = omega_of(v);
    let placed = Placed::new(frame, marker);
    let (rate, turning) = placed.rates(v);
    out[..6 * width].fill(0.0);
    let seen = omega.cross(&placed.position) + rate;
    put(out, width, 0, 3, &-(frame.rotation * skew(&seen)));
    if let Some(shape) = placed.shape {
        put_modal(
            out,
            width,
            0,
            &(frame.rotation * skew(&omega)),
            &shape.translation,
        );
        let spin = omega + placed.turn * turning;
        let by_theta = skew(&spin) * placed.turn + tangent_along(&placed.theta, &turning);
        put_modal(
            out,
            width,
            3,
            &(placed.orientation.transpose() * by_theta),
            &shape.rotation,
        );
    }
}

/// `∂(Jᵀ W)/∂q` for a frozen wrench (force inertial, torque marker axes), row-major width × width, written. With `f = AᵀF`,
/// `t = E C τ`: `JᵀW = [F; p×f + t; Φtᵀf + Φrᵀ Tᵀ t]`, `δf = f × δπ`, `δt = T δθ × t`, and `Tᵀ(θ) = T(−θ)`.
pub fn force_by_pose(
    body: &BodyModel,
    frame: &BodyFrame,
    marker: &MarkerModel,
    wrench: &[f64],
    out: &mut [f64],
) {
    let width = body.width();
    let placed = Placed::new(frame, marker);
    let force = frame.rotation.transpose() * V3::new(wrench[0], wrench[1], wrench[2]);
    let cross = skew(&force);
    out[..width * width].fill(0.0);
    put(out, width, 3, 3, &(skew(&placed.position) * cross));
    if let Some(shape) = placed.shape {
        let torque = placed.orientation * V3::new(wrench[3], wrench[4], wrench[5]);
        let torque_by_theta = -(skew(&torque) * placed.turn);
        put_modal(out, width, 3, &-cross, &shape.translation);
        put_modal(out, width, 3, &torque_by_theta, &shape.rotation);
        put_modal_rows(out, width, 3, &shape.translation, &cross);
        let by_theta =
            placed.turn.transpose() * torque_by_theta - tangent_along(&(-placed.theta), &torque);
        let n = body.modes();
        for i in 0..n {
            for k in 0..3 {
                let left: f64 = (0..3)
                    .map(|l| shape.rotation[l * n + i] * by_theta[(l, k)])
                    .sum();
                for j in 0..n {
                    out[(6 + i) * width + 6 + j] += left * shape.rotation[k * n + j];
                }
            }
        }
    }
}

/// `J̇ v`: acceleration of the marker (ẍ inertial m/s², ω̇ in marker axes rad/s²) at `v̇ = 0`:
/// `A (ω×(ω×p) + 2 ω×Φtȧ)` and `CᵀEᵀ (ω × T θ̇ + ∂(T θ̇)/∂θ θ̇)`.
pub fn acceleration_bias(frame: &BodyFrame, marker: &MarkerModel, v: &[f64]) -> [f64; 6] {
    let omega = omega_of(v);
    let placed = Placed::new(frame, marker);
    let (rate, turning) = placed.rates(v);
    let x =
        frame.rotation * (omega.cross(&omega.cross(&placed.position)) + omega.cross(&rate) * 2.0);
    let spin = placed.orientation.transpose()
        * (omega.cross(&(placed.turn * turning))
            + tangent_along(&placed.theta, &turning) * turning);
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
