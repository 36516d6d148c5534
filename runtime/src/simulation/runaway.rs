//! Bodies that run away from the model: a force with the wrong sign, a table with a wrong unit.
//!
//! Distance alone is no mistake, because a thrown body flies on. A body at constant speed takes nine tenths
//! of its time for the last decade of its distance, and one under a constant force two thirds. A body whose
//! motion grows exponentially takes a sixth or less.

use crate::model::Model;
use crate::state::State;

/// Distance from the ground's origin, in lengths of the model, above which a body is watched. A choice: no
/// machine throws a part this far on purpose, and a vehicle of metres may drive as far, slowly.
const WATCHED: f64 = 1e5;
/// Distance, in lengths of the model, at which a body has left. A choice: ten times the first distance, so
/// that the time between both shows how fast it goes. Positions there have lost six digits.
const LEFT: f64 = 1e6;
/// Largest share of the run's time that a body running away takes from the first distance to the second. A
/// choice: at a constant speed nine tenths of the time pass between them.
const SUDDEN: f64 = 0.25;

/// The progress of the farthest body.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) enum Runaway {
    /// All are near.
    #[default]
    Near,
    /// One is far away since this time (s).
    Far(f64),
    /// The body began far away or flew there, which is no mistake.
    Flies,
}

impl Runaway {
    /// The state at the beginning of a run.
    pub fn begin(model: &Model, state: &State) -> Runaway {
        match farthest(model, state) {
            Some((_, far)) if far > WATCHED * model.length => Runaway::Flies,
            _ => Runaway::Near,
        }
    }

    /// The state as a number, for a checkpoint.
    pub fn number(self) -> f64 {
        match self {
            Runaway::Near => f64::INFINITY,
            Runaway::Far(since) => since,
            Runaway::Flies => f64::NAN,
        }
    }

    /// The state from the number in a checkpoint.
    pub fn from_number(number: f64) -> Runaway {
        match number {
            _ if number.is_nan() => Runaway::Flies,
            f64::INFINITY => Runaway::Near,
            since => Runaway::Far(since),
        }
    }

    /// Updates the state after a step. Returns a body that runs away, with its distance from the ground's
    /// origin (m).
    pub fn after_step(&mut self, model: &Model, state: &State) -> Option<(usize, f64)> {
        if *self == Runaway::Flies {
            return None;
        }
        let (body, far) = farthest(model, state)?;
        if *self == Runaway::Near && far > WATCHED * model.length {
            *self = Runaway::Far(state.time);
        }
        match *self {
            Runaway::Far(since) if far > LEFT * model.length => {
                if state.time - since < SUDDEN * state.time {
                    return Some((body, far));
                }
                *self = Runaway::Flies;
                None
            }
            _ => None,
        }
    }
}

/// The body farthest from the ground's origin, and its distance (m).
fn farthest(model: &Model, state: &State) -> Option<(usize, f64)> {
    model
        .bodies
        .iter()
        .enumerate()
        .filter_map(|(index, body)| {
            let [x, y, z] = *state.pose.get(body.pose..)?.first_chunk::<3>()?;
            Some((index, libm::sqrt(x * x + y * y + z * z)))
        })
        .max_by(|a, b| a.1.total_cmp(&b.1))
}
