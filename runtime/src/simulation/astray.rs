//! Bodies that run away from the model: a force with the wrong sign, a table with a wrong unit.
//!
//! Distance alone is no mistake: what is thrown flies on. A body that flies at a constant speed takes nine tenths of its time for the last
//! decade of its way, and one under a constant force two thirds. One whose motion grows e-fold takes a sixth or less.

use crate::model::Model;
use crate::state::State;

/// Distance from the ground's origin, in lengths of the model, from which a body is watched.
const WATCHED: f64 = 1e5;
/// Distance, in lengths of the model, at which it has left.
const LEFT: f64 = 1e6;
/// Largest share of the time of a run that a body which runs away takes from the one to the other.
const SUDDEN: f64 = 0.25;

/// Where the farthest body is on its way.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) enum Astray {
    /// All are near.
    #[default]
    Near,
    /// One is far away since this time (s).
    Far(f64),
    /// A run that begins far away, or came there as bodies fly: nothing is said of it.
    Flies,
}

impl Astray {
    /// At the begin of a run.
    pub fn begin(model: &Model, state: &State) -> Astray {
        match farthest(model, state) {
            Some((_, far)) if far > WATCHED * model.length => Astray::Flies,
            _ => Astray::Near,
        }
    }

    /// For a checkpoint.
    pub fn number(self) -> f64 {
        match self {
            Astray::Near => f64::INFINITY,
            Astray::Far(since) => since,
            Astray::Flies => f64::NAN,
        }
    }

    /// From a checkpoint.
    pub fn from_number(number: f64) -> Astray {
        match number {
            _ if number.is_nan() => Astray::Flies,
            f64::INFINITY => Astray::Near,
            since => Astray::Far(since),
        }
    }

    /// After a step: a body that runs away, and its distance from the ground's origin (m).
    pub fn after_step(&mut self, model: &Model, state: &State) -> Option<(usize, f64)> {
        if *self == Astray::Flies {
            return None;
        }
        let (body, far) = farthest(model, state)?;
        if *self == Astray::Near && far > WATCHED * model.length {
            *self = Astray::Far(state.time);
        }
        match *self {
            Astray::Far(since) if far > LEFT * model.length => {
                if state.time - since < SUDDEN * state.time {
                    return Some((body, far));
                }
                *self = Astray::Flies;
                None
            }
            _ => None,
        }
    }
}

/// The body farthest from the ground's origin, and how far it is (m).
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
