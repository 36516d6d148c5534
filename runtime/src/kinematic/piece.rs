//! A piece of a prescribed motion between two states close together.

use crate::model::Model;
use crate::rotation::{V3, inverse_tangent, tangent, tangent_along};
use crate::state::{State, move_pose, offset};

/// The motion from one state to the next.
///
/// The increment x of each coordinate from the first state is Hermite's polynomial of fifth degree, which has the
/// places, velocities and accelerations of both ends. The coordinates of a rotation are those of its rotation vector ψ
/// from the first state, in body axes. With the tangent T(ψ), `ω = T ψ̇` and `ω̇ = T ψ̈ + Ṫ ψ̇`. At the first state T
/// is the identity and `Ṫ ψ̇ = 0`.
///
/// For a harmonic motion that turns by φ in the piece, the error of x is `φ⁶/46080` of its amplitude.
pub(super) struct Piece<'a> {
    pub from: &'a State,
    to: &'a State,
    /// For each velocity, the factors of `s … s⁵` of x, with the share s of the time.
    factors: Vec<[f64; 5]>,
}

impl<'a> Piece<'a> {
    pub fn between(model: &Model, from: &'a State, to: &'a State) -> Piece<'a> {
        let increment = offset(model, &from.pose, &to.pose);
        let (mut velocity, mut acceleration) = (to.velocity.clone(), to.acceleration.clone());
        for body in &model.bodies {
            let v = body.velocity;
            let three = |of: &[f64]| V3::new(of[v + 3], of[v + 4], of[v + 5]);
            let psi = three(&increment);
            let inverse = inverse_tangent(&psi);
            let rate = inverse * three(&to.velocity);
            // `tangent_along` is of T(−ψ)
            let turning = -tangent_along(&-psi, &rate) * rate;
            let second = inverse * (three(&to.acceleration) - turning);
            for i in 0..3 {
                velocity[v + 3 + i] = rate[i];
                acceleration[v + 3 + i] = second[i];
            }
        }
        let h = to.time - from.time;
        let factors = (0..model.velocities).map(|i| {
            let (first, bend) = (h * from.velocity[i], 0.5 * h * h * from.acceleration[i]);
            // the ends' place, velocity and acceleration beyond these two terms
            let place = increment[i] - first - bend;
            let rate = h * velocity[i] - first - 2.0 * bend;
            let second = h * h * acceleration[i] - 2.0 * bend;
            [
                first,
                bend,
                10.0 * place - 4.0 * rate + 0.5 * second,
                -15.0 * place + 7.0 * rate - second,
                6.0 * place - 3.0 * rate + 0.5 * second,
            ]
        });
        let factors = factors.collect();
        Piece { from, to, factors }
    }

    /// The time of the piece (s); negative for a motion backwards.
    pub fn duration(&self) -> f64 {
        self.to.time - self.from.time
    }

    /// Gives a state the time, the pose and the velocities at a share of the time. Unwrapped angles remain those of
    /// the first state.
    pub fn place(&self, model: &Model, share: f64, out: &mut State) {
        out.time = self.from.time + share * self.duration();
        let increment: Vec<f64> = (self.factors.iter())
            .map(|f| {
                share * (f[0] + share * (f[1] + share * (f[2] + share * (f[3] + share * f[4]))))
            })
            .collect();
        move_pose(model, &self.from.pose, &increment, 1.0, &mut out.pose);
        for (rate, f) in out.velocity.iter_mut().zip(&self.factors) {
            let [a, b, c, d, e] = [f[0], 2.0 * f[1], 3.0 * f[2], 4.0 * f[3], 5.0 * f[4]];
            *rate = (a + share * (b + share * (c + share * (d + share * e)))) / self.duration();
        }
        for body in &model.bodies {
            let v = body.velocity + 3;
            let of = |x: &[f64]| V3::new(x[v], x[v + 1], x[v + 2]);
            let turning = tangent(&of(&increment)) * of(&out.velocity);
            out.velocity[v..v + 3].copy_from_slice(turning.as_slice());
        }
    }
}
