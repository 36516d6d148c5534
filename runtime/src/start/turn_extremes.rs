//! Quantities that lints follow through the dry turn.

use super::turn::Place;
use crate::dynamics::Dynamics;
use crate::error::RuntimeError;
use crate::model::Model;
use crate::outputs::Outputs;
use eng_system::lint::Extreme;

/// Share of the swing within which two values count as equally large: the first of them is the largest. It is
/// far above the rounding of an output and far below a difference that a lint could mean.
const ALIKE: f64 = 1e-9;

/// The quantities at the positions of a turn.
#[derive(Debug)]
pub struct Following {
    outputs: Outputs,
    dynamics: Dynamics,
    extremes: Vec<Extreme>,
    /// Angle of the cycle (rad) at each position.
    angles: Vec<f64>,
    /// Values of each quantity (SI) at each position.
    values: Vec<Vec<f64>>,
}

impl Following {
    /// The quantities of a model; `None` if no lint follows any.
    ///
    /// # Errors
    /// Outputs that read each other.
    pub fn new(model: &Model) -> Result<Option<Following>, RuntimeError> {
        let followed = &model.compiled.system.followed;
        if followed.is_empty() {
            return Ok(None);
        }
        let outputs = followed
            .iter()
            .map(|followed| (followed.element as usize, followed.output as usize));
        Ok(Some(Following {
            outputs: Outputs::following(model, outputs.collect())?,
            dynamics: Dynamics::new(model),
            extremes: followed.iter().map(|followed| followed.extreme).collect(),
            angles: Vec::new(),
            values: vec![Vec::new(); followed.len()],
        }))
    }

    /// Adds a position.
    ///
    /// # Errors
    /// A quantity that has no value there.
    pub fn look(&mut self, place: &Place<'_>) -> Result<(), RuntimeError> {
        let Place {
            model,
            state,
            angle,
        } = *place;
        self.dynamics
            .place(model, state.time, &state.pose, &state.velocity);
        self.outputs.evaluate(model, &self.dynamics, state)?;
        self.angles.push(angle);
        for (values, value) in self.values.iter_mut().zip(&self.outputs.followed) {
            values.push(*value);
        }
        Ok(())
    }

    /// The number of each quantity, after a whole turn.
    pub fn numbers(&self) -> Vec<f64> {
        let numbers = self.extremes.iter().zip(&self.values);
        numbers
            .map(|(extreme, values)| match extreme {
                Extreme::Largest => largest(&self.angles, values).1,
                Extreme::WhereLargest => largest(&self.angles, values).0,
                Extreme::Smallest => {
                    let turned: Vec<f64> = values.iter().map(|x| -x).collect();
                    -largest(&self.angles, &turned).1
                }
            })
            .collect()
    }
}

/// Where a quantity is largest, and its value there: the vertex of the parabola through the largest value and
/// its neighbours. The last position is the first of the next turn. Angles in rad, values in their own unit;
/// both results are NaN for values that are no numbers.
pub(crate) fn largest(angles: &[f64], values: &[f64]) -> (f64, f64) {
    let most = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let least = values.iter().copied().fold(f64::INFINITY, f64::min);
    let alike = ALIKE * (most - least);
    let Some(at) = values.iter().position(|x| *x >= most - alike) else {
        return (f64::NAN, f64::NAN);
    };
    let last = values.len().saturating_sub(1);
    let closed = last > 1 && (values[last] - values[0]).abs() <= ALIKE.sqrt() * (most - least);
    let period = angles[last] - angles[0];
    // the neighbours, each with its distance in angle
    let neighbour = |forward: bool| -> Option<(f64, f64)> {
        let (there, turns) = match forward {
            true if at < last => (at + 1, 0.0),
            true if closed => (1, 1.0),
            false if at > 0 => (at - 1, 0.0),
            false if closed => (last - 1, -1.0),
            _ => return None,
        };
        Some((
            angles[there] + turns * period - angles[at],
            values[there] - values[at],
        ))
    };
    let (Some((a, fa)), Some((b, fb))) = (neighbour(false), neighbour(true)) else {
        return (angles[at], values[at]);
    };
    // f(s) = p s + q s² through (0, 0), (a, fa), (b, fb)
    let q = (fa / a - fb / b) / (a - b);
    let p = fa / a - q * a;
    let s = -p / (2.0 * q);
    // a vertex beside a position by rounding is at the position
    let s = if s.abs() <= ALIKE * (b - a) { 0.0 } else { s };
    if !(q < 0.0 && s.is_finite() && s.abs() <= a.abs().max(b.abs())) {
        return (angles[at], values[at]);
    }
    (angles[at] + s, values[at] + p * s + q * s * s)
}
