//! States within the last step.

use super::Integrator;
use crate::model::Model;
use crate::rotation::{V3, inverse_tangent};
use crate::state::{State, move_pose};

impl Integrator {
    /// The state at a fraction 0…1 of the last step: cubic in positions (rotations in the increment from the
    /// step's beginning) and in velocities, from values and rates at both ends. Not projected.
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
    }
}
