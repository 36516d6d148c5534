//! States within the last step.

use super::Integrator;
use crate::model::Model;
use crate::rotation::{V3, inverse_tangent, tangent, tangent_along};
use crate::state::{State, move_pose};

impl Integrator {
    /// The state at a fraction 0…1 of the last step: cubic in positions (rotations in the increment from the
    /// step's beginning) and in velocities, from values and rates at both ends. With Radau IIA positions are of fifth degree,
    /// with the accelerations at both ends, and velocities are their rates. Not projected.
    pub fn interpolate(&self, model: &Model, fraction: f64, work: &mut [f64], out: &mut State) {
        let (from, to) = (&self.previous, &self.current);
        let h = to.time - from.time;
        let s = fraction;
        let value = s * s * (3.0 - 2.0 * s);
        let rate_from = h * s * (1.0 - s) * (1.0 - s);
        let rate_to = -h * s * s * (1.0 - s);
        for body in &model.bodies {
            let v = body.velocity;
            for i in v..v + body.width() {
                work[i] = value * self.increment[i]
                    + rate_from * from.velocity[i]
                    + rate_to * to.velocity[i];
            }
            let theta = V3::new(
                self.increment[v + 3],
                self.increment[v + 4],
                self.increment[v + 5],
            );
            let end = inverse_tangent(&theta)
                * V3::new(to.velocity[v + 3], to.velocity[v + 4], to.velocity[v + 5]);
            for i in 0..3 {
                let k = v + 3 + i;
                work[k] = value * theta[i] + rate_from * from.velocity[k] + rate_to * end[i];
            }
        }
        move_pose(model, &from.pose, work, 1.0, &mut out.pose);
        let hermite =
            |a: f64, b: f64, da: f64, db: f64| a + value * (b - a) + rate_from * da + rate_to * db;
        for i in 0..model.velocities {
            out.velocity[i] = hermite(
                from.velocity[i],
                to.velocity[i],
                from.acceleration[i],
                to.acceleration[i],
            );
            out.acceleration[i] =
                from.acceleration[i] + s * (to.acceleration[i] - from.acceleration[i]);
        }
        for i in 0..model.states {
            out.states[i] = hermite(from.states[i], to.states[i], from.rates[i], to.rates[i]);
            out.rates[i] = from.rates[i] + s * (to.rates[i] - from.rates[i]);
        }
        for i in 0..model.rows {
            out.multipliers[i] =
                from.multipliers[i] + s * (to.multipliers[i] - from.multipliers[i]);
        }
        out.rotations.copy_from_slice(&to.rotations);
        out.time = from.time + s * h;
        if self.is_radau() && h > 0.0 {
            self.interpolate_smoothly(model, fraction, work, out);
        }
    }

    /// Positions of fifth degree from values, rates and second rates at both ends of the last step, and their rates.
    fn interpolate_smoothly(&self, model: &Model, s: f64, work: &mut [f64], out: &mut State) {
        let (from, to) = (&self.previous, &self.current);
        let h = to.time - from.time;
        let (s2, s3) = (s * s, s * s * s);
        // weights of the increment, of h v at both ends and of h² v̇ at both ends, and their rates
        let values = [
            s3 * (10.0 - 15.0 * s + 6.0 * s2),
            s - s3 * (6.0 - 8.0 * s + 3.0 * s2),
            -s3 * (4.0 - 7.0 * s + 3.0 * s2),
            0.5 * s2 - s3 * (1.5 - 1.5 * s + 0.5 * s2),
            s3 * (0.5 - s + 0.5 * s2),
        ];
        let rates = [
            30.0 * s2 * (1.0 - 2.0 * s + s2),
            1.0 - s2 * (18.0 - 32.0 * s + 15.0 * s2),
            -s2 * (12.0 - 28.0 * s + 15.0 * s2),
            s - s2 * (4.5 - 6.0 * s + 2.5 * s2),
            s2 * (1.5 - 4.0 * s + 2.5 * s2),
        ];
        let sum = |weights: &[f64; 5], data: &[f64; 5]| -> f64 {
            weights.iter().zip(data).map(|(w, x)| w * x).sum()
        };
        for body in &model.bodies {
            let v = body.velocity;
            let vector = |list: &[f64]| V3::new(list[v + 3], list[v + 4], list[v + 5]);
            let theta = vector(&self.increment);
            let rate = inverse_tangent(&theta) * vector(&to.velocity);
            let second = second_rate(&theta, &rate, &vector(&to.acceleration));
            for i in 0..body.width() {
                let k = v + i;
                let turns = i.checked_sub(3).filter(|j| *j < 3);
                let (end, bend) = turns.map_or((to.velocity[k], to.acceleration[k]), |j| {
                    (rate[j], second[j])
                });
                let data = [
                    self.increment[k],
                    h * from.velocity[k],
                    h * end,
                    h * h * from.acceleration[k],
                    h * h * bend,
                ];
                work[k] = sum(&values, &data);
                out.velocity[k] = sum(&rates, &data) / h;
            }
            let turned = tangent(&vector(work)) * vector(&out.velocity);
            out.velocity[v + 3..v + 6].copy_from_slice(turned.as_slice());
        }
        move_pose(model, &from.pose, work, 1.0, &mut out.pose);
    }
}

/// The second rate of a rotation vector θ with the rate w (rad/s) whose body has the angular acceleration a (rad/s², body axes):
/// `T(θ) ẅ = a − Ṫ w`.
pub fn second_rate(theta: &V3, w: &V3, a: &V3) -> V3 {
    // `tangent_along` has the tangent of the other trivialisation, T(−θ)
    let turning = tangent_along(&-theta, w) * w;
    inverse_tangent(theta) * (a + turning)
}
