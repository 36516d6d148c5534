//! The path of the bodies in a period, approximated with rigid bodies: the steady motion, followed until it
//! repeats.

use super::super::{Balance, Place};
use super::{NoOrbit, TURNS, singular};
use crate::dynamics::Dynamics;
use crate::elements::Inputs;
use crate::error::RuntimeError;
use crate::model::Model;
use crate::outputs::{Outputs, Watch};
use crate::rotation::turn_between;
use crate::start::motion::modal;
use crate::state::State;
use eng_system::dense::largest_scaled;
use eng_system::significant::short;
use std::f64::consts::TAU;

/// Angles per turn without a cycle. They resolve orders below 8, the fine grid below 16. A choice: loads
/// fixed in space and unbalances have orders up to two.
const OF_A_TURN: usize = 16;
/// Angles per turn with a cycle. They resolve orders below 24, the fine grid below 48. A choice: the inertia
/// and gas of engines have more orders than turning shafts, and the effort of a start grows with the square
/// of this number.
const OF_A_CYCLE: usize = 48;
/// Turns after which a motion without a cycle must have repeated. A choice: gears of small whole numbers of
/// teeth repeat earlier, and all angles of all these turns are unknowns at once.
const MOST_TURNS: usize = 20;
/// Steps between two angles of the fine grid. They are a sixty-fourth of a turn or less, so the error of the
/// fourth-order scheme over a turn, 2πh⁴/120 for a simple swing, is 5e-6 rad and below [`BACK`].
const STEPS: usize = 2;
/// Share of a turn within which a body has completed its turns. A choice: two speeds with a common period may
/// be stated with rounding in their fifth digit.
const ROUND: f64 = 1e-3;
/// Share of the model's length, or rad, within which a position has returned. A choice: above the error of
/// the steps, and small against the steps of the grid. A motion that returns less well has no period of this
/// length, and its derivatives would see a jump there.
const BACK: f64 = 1e-4;

/// States at equal parts of a period.
pub(super) struct Path {
    /// Positions and velocities, twice as many as in the coarse grid.
    pub states: Vec<State>,
    /// The period (s).
    pub period: f64,
}

impl Path {
    /// Follows the steady motion from a position until it repeats.
    pub fn new(balance: &Balance, place: &Place) -> Result<Path, NoOrbit> {
        let model = balance.model;
        let cycle = cycle_time(balance, place)?;
        let (part, turns, count) = match cycle {
            Some((time, turns)) => (time, 1, 2 * even(turns * OF_A_CYCLE as f64)),
            None => (slowest_turn(balance)?, MOST_TURNS, 2 * OF_A_TURN),
        };
        let step = part / count as f64;
        let mut watch = Watch::new(model, |_| true);
        let mut dynamics = Dynamics::new(model);
        let mut states = Vec::new();
        let mut now = place.state.clone();
        let motion = &balance.motion;
        now.velocity = motion.velocity(model, &now).map_err(singular)?;
        let first = now.clone();
        let mut off = String::new();
        for _ in 0..turns {
            for _ in 0..count {
                states.push(now.clone());
                for _ in 0..STEPS {
                    let from = now.clone();
                    let h = step / STEPS as f64;
                    now.velocity = motion
                        .advance(model, &from, &from.velocity, h, &mut now)
                        .map_err(singular)?;
                }
                unwrap(model, &mut watch, &mut dynamics, &mut now)?;
            }
            match returned(model, &first, &now) {
                Ok(()) => {
                    let period = now.time - first.time;
                    return Ok(Path { states, period });
                }
                Err((body, by)) => {
                    let by = short(by, 2);
                    off = format!("{body} is off by {by} of the model's size or of a radian");
                }
            }
        }
        Err(NoOrbit::Reason(if cycle.is_some() {
            format!("the motion does not repeat after a cycle: {off}")
        } else {
            format!("the motion does not repeat within {MOST_TURNS} turns: {off}")
        }))
    }
}

fn even(x: f64) -> usize {
    (2.0 * libm::ceil(0.5 * x)).max(OF_A_TURN as f64) as usize
}

/// Time of a cycle (s) and its turns, if the model has a cycle that turns.
fn cycle_time(balance: &Balance, place: &Place) -> Result<Option<(f64, f64)>, RuntimeError> {
    let model = balance.model;
    let Some(cycle) = &model.compiled.system.cycle else {
        return Ok(None);
    };
    let mut watch = Outputs::watching(model, cycle.element as usize)?;
    let mut dynamics = Dynamics::new(model);
    let mut state = place.state.clone();
    state.velocity.copy_from_slice(&balance.velocity);
    // shapes swing and have no mean speed
    for i in modal(model) {
        state.velocity[i] = 0.0;
    }
    dynamics.place(model, state.time, &state.pose, &state.velocity);
    watch.evaluate(model, &dynamics, &state)?;
    let (period, rate) = (model.slot(cycle.period), watch.watched_values[1].abs());
    Ok((rate > TURNS * balance.motion_rate).then_some((period / rate, period / TAU)))
}

/// Time after which a motion repeats (s), and its turns: those of the cycle, or those after which all turning
/// bodies have completed their turns.
pub(super) fn period_of(balance: &Balance, place: &Place) -> Result<(f64, f64), NoOrbit> {
    if let Some(cycle) = cycle_time(balance, place)? {
        return Ok(cycle);
    }
    let turn = slowest_turn(balance)?;
    let comes_round = |time: f64| {
        balance.model.bodies.iter().all(|body| {
            let spin = &balance.velocity[body.velocity + 3..body.velocity + 6];
            let turns = libm::sqrt(spin.iter().map(|x| x * x).sum()) * time / TAU;
            (turns - libm::round(turns)).abs() <= ROUND
        })
    };
    (1..=MOST_TURNS)
        .map(|turns| turns as f64)
        .find(|turns| comes_round(turns * turn))
        .map(|turns| (turns * turn, turns))
        .ok_or_else(|| {
            NoOrbit::Reason(format!(
                "the motion does not repeat within {MOST_TURNS} turns"
            ))
        })
}

/// Time of a turn (s) of the slowest turning flexible body.
fn slowest_turn(balance: &Balance) -> Result<f64, NoOrbit> {
    let speeds = balance
        .model
        .bodies
        .iter()
        .filter(|b| b.modes() > 0)
        .map(|b| {
            let v = &balance.velocity[b.velocity + 3..b.velocity + 6];
            libm::sqrt(v.iter().map(|x| x * x).sum())
        });
    let slowest = speeds
        .filter(|s| *s > TURNS * balance.motion_rate)
        .reduce(f64::min);
    match slowest {
        Some(speed) => Ok(TAU / speed),
        None => Err(NoOrbit::Reason("the motion has no period".to_owned())),
    }
}

/// The unwrapped angles at a state.
pub(super) fn unwrap(
    model: &Model,
    watch: &mut Watch,
    dynamics: &mut Dynamics,
    state: &mut State,
) -> Result<(), RuntimeError> {
    dynamics.place(model, state.time, &state.pose, &state.velocity);
    let mut rotations = state.rotations.clone();
    let from = Inputs {
        memory: None,
        ..dynamics.inputs_at(state)
    };
    watch.unwrap(model, &from, &mut rotations)?;
    state.rotations = rotations;
    Ok(())
}

/// Checks that a state has returned to a position with its velocities, up to whole turns. The error is the
/// body with the largest deviation, and this deviation.
fn returned<'a>(model: &'a Model, first: &State, now: &State) -> Result<(), (&'a str, f64)> {
    let scales = model.velocity_scales();
    let motion_rate = largest_scaled(&first.velocity, &scales);
    let mut worst = ("", 0.0);
    for body in &model.bodies {
        let (a, b) = (&first.pose[body.pose..], &now.pose[body.pose..]);
        let moved = (0..3).map(|i| (a[i] - b[i]).abs() / model.length);
        let rates = (body.velocity..body.velocity + 6)
            // velocities may miss ten times as much as positions, because they follow from the positions,
            // divided by the small arms of a mechanism. A choice
            .map(|i| 0.1 * (first.velocity[i] - now.velocity[i]).abs() / (motion_rate * scales[i]));
        let off = moved
            .chain(rates)
            .fold(turn_between(&a[3..7], &b[3..7]).norm(), f64::max);
        if off > worst.1 || off.is_nan() {
            worst = (body.origin.path.as_str(), off);
        }
    }
    if worst.1 <= BACK { Ok(()) } else { Err(worst) }
}
