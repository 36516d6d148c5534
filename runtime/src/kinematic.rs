//! Kinematic analyses: the mechanism turned at a prescribed speed, and the reactions by inverse dynamics.
//!
//! With the constraints Φ(q, t), the middle e(q) of each pin in its shell, and the angle α(q) of the cycle,
//! the motion fulfils
//!
//! ```text
//! Φ(q, t) = 0        e(q) = 0        α(q) = α₀ + Ω t
//! ```
//!
//! at each sample, to rounding. The last equation takes part only if no drive determines the cycle. Ω is the
//! speed that `start` states. Modal amplitudes keep their first values. Velocities and accelerations follow
//! from the first and second derivatives of the equations. All these equations together must determine every
//! body. A mechanism with further free motions is refused with their names.
//!
//! Let B be the gradients of the equations. Element loads Q are those of the laws at this motion, and the
//! reactions are a solution of
//!
//! ```text
//! Bᵀ λ = Q − M v̇
//! ```
//!
//! It always exists. If rows of B depend on each other, reactions along their dependence have no place in
//! this balance: only stiffnesses and clearances decide them. Channels that contain such a reaction are left
//! out and named ([`Shared`]). A channel that does not depend on the shared part, such as a sum, remains.
//!
//! A film exerts nothing at the middle of its shell, neither load nor friction. The reaction of e is the
//! bearing load. In place of one film, which carries no moment, the tilt of a body may be free. Then the axis
//! of the pin is held parallel to that of its shell, and the reaction has the moment too.
//!
//! States of elements, such as the pressure of a gas, follow the motion ([`states`]). Over a range of angles
//! they begin with the values with which a cycle repeats, over a time with those of the text.
//!
//! Each sample stands by itself, so a load may have kinks and jumps between samples. A velocity that jumps
//! would need an impulse. It is refused.

mod balance;
mod following;
mod mechanism;
mod piece;
mod states;

use crate::error::{Moment, RuntimeError};
use crate::model::Model;
use crate::simulation::Energy;
use crate::start::turn::REACHED;
use crate::state::State;
use crate::transient::{Advance, Observer, Sample, Verdict, countable};
use balance::Balance;
use eng_system::analysis::Kinematic;
use eng_system::code::Compiled;
use eng_system::significant::short;
use eng_system::system::{Extent, Origin};
use mechanism::Mechanism;

pub use balance::Shared;

/// Moments at which the reactions are examined for dependences, as shares of the range. Choices: the first,
/// and three that are no simple shares of it, because a mechanism may be singular at quarters of a turn.
const EXAMINED: [f64; 4] = [0.0, 0.137, 0.389, 0.731];
/// Share of the first rate of a cycle below which it stands. A choice above the rounding of rates.
const STANDS: f64 = 1e-6;
/// Rounds in which the time of a sample follows its angle. A choice: they are Newton's method, whose error
/// squares from round to round.
const RETIMED: usize = 12;

/// The columns of a kinematic analysis after time and cycle, and the assumptions of its results.
#[derive(Clone, Debug, PartialEq)]
pub struct Determined {
    /// Channels with a value, in their order.
    pub channels: Vec<usize>,
    /// Channels without one, which contain shared reactions.
    pub left_out: Vec<usize>,
    /// Elements that share reactions.
    pub shared: Vec<Shared>,
    /// Whether the analysis itself turns the cycle; otherwise a drive does.
    pub turned: bool,
    /// Elements whose pins are in the middle of their shells.
    pub centred: Vec<Origin>,
    /// Flexible bodies, which count as rigid.
    pub rigid: Vec<Origin>,
}

/// Prepares an analysis and decides which channels have a value.
///
/// # Errors
/// Those of assembly; [`RuntimeError::NotKinematic`] for a mechanism whose motion is not determined.
pub fn kinematic_columns(
    compiled: &Compiled,
    overrides: &[Option<f64>],
    kinematic: &Kinematic,
) -> Result<Determined, RuntimeError> {
    Ok(prepared(compiled, overrides, kinematic)?.determined)
}

/// Runs a kinematic analysis. The values of its samples are the torque of the cycle, if there is one, and the
/// channels of [`Determined::channels`].
///
/// # Errors
/// Those of [`kinematic_columns`], and positions that the mechanism does not reach.
pub fn run_kinematic(
    compiled: &Compiled,
    overrides: &[Option<f64>],
    kinematic: &Kinematic,
    observer: &mut dyn Observer,
) -> Result<Determined, RuntimeError> {
    let mut run = prepared(compiled, overrides, kinematic)?;
    if run.mechanism.has_states() {
        run.begin_with_states()?;
    }
    let mut state = run.begin()?;
    let journals = vec![[0.0; 2]; compiled.system.journals.len()];
    for index in 0..=run.count {
        if index > 0 {
            run.follow(&mut state, index)?;
        }
        if !run.determined.shared.is_empty() {
            let recorded = &run.determined.channels;
            run.balance
                .refuse_shared(&mut run.mechanism, &mut state, recorded)?;
        }
        let balanced = run.balance.balance(&mut run.mechanism, &mut state)?;
        for warning in run.balance.take_warnings() {
            observer.warning(&warning);
        }
        let mut values = Vec::with_capacity(run.determined.channels.len() + 1);
        values.extend(balanced.torque);
        let channels = run.determined.channels.iter();
        values.extend(channels.map(|channel| balanced.channels[*channel]));
        let cycle = run.mechanism.cycle(&state)?;
        let sample = Sample {
            time: state.time,
            cycle_angle: cycle.map(|c| c[0]),
            cycle_rate: cycle.map(|c| c[1]),
            values: &values,
            energy: Energy::default(),
            eccentricities: &journals,
            pose: &state.pose,
            velocity: &state.velocity,
            states: &state.states,
            fields: &[],
        };
        if observer.sample(&sample).is_break() {
            break;
        }
        observer.stepped();
        let advance = Advance {
            fraction: index as f64 / run.count.max(1) as f64,
            time: state.time,
            cycle_angle: cycle.map(|c| c[0]),
            steps: index as u64,
        };
        if observer.progress(&advance) == Verdict::Stop {
            break;
        }
    }
    Ok(run.determined)
}

/// An analysis at its start.
struct Prepared {
    mechanism: Mechanism,
    balance: Balance,
    start: State,
    grid: Grid,
    /// Samples after the first one.
    count: usize,
    determined: Determined,
}

/// The moments of the samples.
#[derive(Clone, Copy)]
enum Grid {
    /// Distance (s).
    Time(f64),
    /// First angle, signed distance (rad) and rate (rad/s) at the start.
    Angle([f64; 3]),
}

fn prepared(
    compiled: &Compiled,
    overrides: &[Option<f64>],
    kinematic: &Kinematic,
) -> Result<Prepared, RuntimeError> {
    countable(kinematic)?;
    let (mut mechanism, start) = Mechanism::new(compiled, overrides)?;
    let (grid, count, whole) = grid(&mut mechanism, &start, kinematic)?;
    let balance = Balance::new(&mechanism)?;
    let mut run = Prepared {
        determined: Determined {
            channels: Vec::new(),
            left_out: Vec::new(),
            shared: Vec::new(),
            turned: mechanism.is_turned(),
            centred: mechanism.centred(),
            rigid: mechanism.rigid(),
        },
        mechanism,
        balance,
        start,
        grid,
        count,
    };
    let mut state = run.begin()?;
    let mut examined = run.balance.examination(&run.mechanism);
    for share in EXAMINED {
        run.follow_to(&mut state, share * whole)?;
        run.balance
            .examine(&mut run.mechanism, &mut state, &mut examined)?;
    }
    (run.determined.channels, run.determined.left_out) = run.balance.channels(&examined);
    run.determined.shared = run.balance.shared(&run.mechanism, &examined);
    Ok(run)
}

/// The samples, their count after the first, and the whole range in the unit of the grid.
fn grid(
    mechanism: &mut Mechanism,
    start: &State,
    kinematic: &Kinematic,
) -> Result<(Grid, usize, f64), RuntimeError> {
    // a range of a whole number of samples has its last one in spite of rounding
    let counted = |whole: f64, part: f64| libm::floor(whole / part + 1e-6) as usize;
    match (kinematic.over, kinematic.sample) {
        (Some(Extent::Time(whole)), Extent::Time(part)) => {
            Ok((Grid::Time(part), counted(whole, part), whole))
        }
        (over, Extent::Angle(part)) => {
            let Some([angle, rate]) = mechanism.cycle(start)? else {
                return Err(RuntimeError::NoCycle);
            };
            let whole = match over {
                Some(Extent::Angle(whole)) => whole,
                _ => mechanism.period().unwrap_or(std::f64::consts::TAU),
            };
            if rate.abs() <= STANDS * start.fastest_turn(&mechanism.model) || rate == 0.0 {
                return Err(RuntimeError::CycleStands {
                    moment: Moment {
                        time: start.time,
                        cycle_angle: Some(angle),
                    },
                    angle,
                });
            }
            let sense = rate.signum();
            let grid = Grid::Angle([angle, sense * part, rate]);
            Ok((grid, counted(whole, part), whole))
        }
        _ => Err(RuntimeError::Options {
            message: "`sample` and `over` are both angles or both times".into(),
        }),
    }
}

impl Prepared {
    /// The first state. The equations of the mechanism are those of this state afterwards.
    fn begin(&mut self) -> Result<State, RuntimeError> {
        let mut state = self.start.clone();
        self.mechanism.complete(&mut state)?;
        Ok(state)
    }

    /// Brings a state to a sample from the one before. Refuses states that have not repeated after a whole cycle on the way.
    fn follow(&mut self, state: &mut State, index: usize) -> Result<(), RuntimeError> {
        let part = match self.grid {
            Grid::Time(part) => part,
            Grid::Angle([_, part, _]) => part.abs(),
        };
        let to = index as f64 * part;
        let Some(period) = self.repeating() else {
            return self.follow_to(state, to);
        };
        let from = (index as f64 - 1.0) * part;
        let mut cycles = libm::floor(from / period + REACHED) + 1.0;
        while cycles * period <= to * (1.0 + REACHED) {
            // a sample at a whole cycle has its own angle
            self.follow_to(state, to.min(cycles * period))?;
            self.mechanism
                .require_kept(&self.start.states, &state.states)?;
            cycles += 1.0;
        }
        self.follow_to(state, to)
    }

    /// Brings a state to a place of the range, in the unit of the grid, in the sense of the motion.
    fn follow_to(&mut self, state: &mut State, at: f64) -> Result<(), RuntimeError> {
        match self.grid {
            Grid::Time(_) => self.mechanism.advance(state, self.start.time + at),
            Grid::Angle([first, part, rate]) => {
                let target = first + part.signum() * at;
                for _ in 0..RETIMED {
                    let Some([now, speed]) = self.mechanism.cycle(state)? else {
                        return Err(RuntimeError::NoCycle);
                    };
                    // the rounding of an angle grows with it
                    if (target - now).abs() <= REACHED * (1.0 + target.abs()) {
                        return Ok(());
                    }
                    if speed * rate <= STANDS * rate * rate {
                        return Err(self.mechanism.refused(
                            None,
                            format!(
                                "the cycle comes to rest at {}°, so samples by its angle end there",
                                short(now.to_degrees(), 5)
                            ),
                            "state the range as a time, such as `over: 50 ms, sample: 0.1 ms`",
                        ));
                    }
                    let time = state.time + (target - now) / speed;
                    self.mechanism.advance(state, time)?;
                }
                Ok(())
            }
        }
    }
}

/// The path and the places of an element.
fn origin_of(model: &Model, element: usize) -> Origin {
    model.compiled.system.elements[element].origin.clone()
}
