//! The start of a motion, as assembled or in balance with a steady or repeating motion, and the turn of the
//! assembled machine without forces.
//!
//! Assembly gives positions that close every joint, and velocities of least energy. A turning engine that
//! starts there rings: the films do not carry its pins in these positions, and its flexible bodies are
//! straight. The **quasi-static start** solves for a state with these properties:
//!
//! - All stated values hold: every `start` row, the cycle's angle, and the position of every body with a
//!   stated motion.
//! - The motion is steady ([`motion`]). Modal rates, the rates of the eccentricities seen from their shells,
//!   and the relative rates of springs are zero and remain zero. Turning flexible bodies have the bending of
//!   the motion that repeats.
//! - All other freedoms are in balance ([`balance`]) with the inertia of that motion, gas, gravity and the
//!   films.
//!
//! The accelerations at the start of the simulation are then those of the steady motion, except along the
//! held directions. There the loads of the moment speed the engine up or slow it down. The start removes the
//! ringing of stiff modes and films. It is no periodic state: the slow modes of the drive line begin with the
//! stated twist.

pub mod balance;
pub mod eccentricity;
pub mod hanging;
pub mod motion;
pub(crate) mod picking;
mod source;
pub mod turn;
pub mod turn_extremes;

use crate::dynamics::Dynamics;
use crate::elements::Inputs;
use crate::error::RuntimeError;
use crate::model::Model;
use crate::outputs::{Outputs, Watch};
use crate::state::State;
use balance::{Balance, Terms};
use eng_system::significant::short;
use eng_system::system::{ConditionKind, Origin, Role, Start};

/// The kind of start of a simulation.
#[derive(Clone, Debug, PartialEq)]
pub enum StartReport {
    /// As assembled.
    Assembled,
    /// In quasi-static balance.
    QuasiStatic(Equilibrium),
    /// No start: the state is the equilibrium of a `static` analysis.
    Equilibrium(Equilibrium),
    /// As assembled, because the balance was not found.
    NoBalance(Obstacle),
    /// From a checkpoint.
    Resumed,
}

/// A quasi-static start.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Equilibrium {
    /// Freedoms in balance.
    pub freedoms: usize,
    /// Further freedoms, with neither stiffness nor load: they keep their positions.
    pub idle: usize,
    /// Newton iterations.
    pub iterations: usize,
    /// Number of portions of the load.
    pub portions: usize,
    /// Position of the pin in each film.
    pub journals: Vec<JournalStart>,
    /// Held directions with the force that would hold each: they are not in balance.
    pub held: Vec<Held>,
    /// The escape from a balance at rest that is upside down. `None` for a stable one, and if a body moves or
    /// is held.
    pub unstable: Option<Unstable>,
    /// The bending of turning flexible bodies, if there are any.
    pub turning: Option<Turning>,
}

/// The bending of turning flexible bodies at the start.
#[derive(Clone, Debug, PartialEq)]
pub enum Turning {
    /// The bending of the repeating motion. It distinguishes loads that turn with the body from loads that
    /// are fixed in space.
    Repeating {
        /// Number of equal parts of the period in the solution.
        angles: usize,
        /// The period (s).
        period: f64,
        /// Change of the start from half as many angles, as a share of the largest bending.
        change: f64,
    },
    /// The bending of the repeating motion, in films: the motion was integrated from a balance until it
    /// repeated.
    Followed {
        /// Number of integrated periods.
        periods: usize,
        /// The period (s).
        period: f64,
        /// Change over the last period, as a share of a clearance or of the largest bending.
        change: f64,
    },
    /// As if all loads turned with the body, for the given reason.
    WithTheBody {
        /// A body that turns.
        origin: Origin,
        /// The reason why no repeating motion was found.
        reason: String,
    },
}

/// An unstable balance at rest: the smallest push leads away from it.
#[derive(Clone, Debug, PartialEq)]
pub struct Unstable {
    /// The body that moves most.
    pub origin: Origin,
    /// Time (s) in which a small deviation grows e-fold.
    pub time: f64,
}

/// A journal at the start.
#[derive(Clone, Debug, PartialEq)]
pub struct JournalStart {
    /// Path of the journal.
    pub path: String,
    /// |e|/c.
    pub ratio: f64,
}

/// A direction that is not in balance.
#[derive(Clone, Debug, PartialEq)]
pub struct Held {
    /// The holder: the path of a `start`, or the cycle.
    pub origin: Origin,
    /// The generalised force that would hold it, in its row's unit (N for lengths, N m for angles).
    pub effort: f64,
    /// Whether the row is a length.
    pub is_length: bool,
}

/// The obstacle to a balance.
#[derive(Clone, Debug, PartialEq)]
pub struct Obstacle {
    /// The journal, body or element.
    pub origin: Origin,
    /// Its effect.
    pub message: String,
    /// Part of the load with a balance, 0…1. At 1 the balance breaks a condition.
    pub carried: f64,
}

impl Equilibrium {
    /// Writes the search and the properties of the balance.
    fn details(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if self.portions > 1 {
            write!(f, " in {} portions of the load", self.portions)?;
        }
        let ratios = self.journals.iter().map(|j| j.ratio);
        if let (Some(low), Some(high)) = (ratios.clone().reduce(f64::min), ratios.reduce(f64::max))
        {
            write!(f, "; eccentricity ratios {low:.3} to {high:.3}")?;
        }
        for held in &self.held {
            let unit = if held.is_length { "N" } else { "N m" };
            write!(
                f,
                "; {} held with {:.4} {unit}",
                held.origin.path, held.effort
            )?;
        }
        match &self.turning {
            Some(Turning::Repeating {
                angles,
                period,
                change,
            }) => write!(
                f,
                "; turning flexible bodies as in the motion that repeats after {:.4} ms, at {angles} angles to {}",
                1e3 * period,
                short(*change, 2)
            )?,
            Some(Turning::Followed {
                periods,
                period,
                change,
            }) => write!(
                f,
                "; turning flexible bodies and their films as in the motion that repeats after {:.4} ms, followed for {periods} \
                 periods to {}",
                1e3 * period,
                short(*change, 2)
            )?,
            Some(Turning::WithTheBody { reason, .. }) => write!(
                f,
                "; turning flexible bodies as if all loads turned with them: {reason}"
            )?,
            None => {}
        }
        if let Some(unstable) = &self.unstable {
            write!(
                f,
                "; unstable: a small deviation of {} grows by the factor e in {} s",
                unstable.origin.path,
                short(unstable.time, 3)
            )?;
        }
        Ok(())
    }
}

impl std::fmt::Display for StartReport {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            StartReport::Assembled => f.write_str("start: as assembled"),
            StartReport::Resumed => f.write_str("start: from a checkpoint"),
            StartReport::QuasiStatic(e) => {
                write!(
                    f,
                    "start: quasi-static; {} freedoms in balance after {} iterations",
                    e.freedoms, e.iterations
                )?;
                e.details(f)
            }
            StartReport::Equilibrium(e) => {
                let counted = |count: usize, what: &str| match count {
                    1 => format!("1 {what}"),
                    _ => format!("{count} {what}s"),
                };
                write!(
                    f,
                    "equilibrium: {} in balance after {}",
                    counted(e.freedoms, "freedom"),
                    counted(e.iterations, "iteration")
                )?;
                e.details(f)?;
                if e.idle > 0 {
                    let idle = counted(e.idle, "freedom");
                    write!(f, "; {idle} without stiffness or load, left in place")?;
                }
                Ok(())
            }
            StartReport::NoBalance(o) if o.carried >= 1.0 => write!(
                f,
                "start: as assembled; in the quasi-static balance a condition does not hold: {}: {}",
                o.origin.path, o.message
            ),
            StartReport::NoBalance(o) => write!(
                f,
                "start: as assembled; no quasi-static balance with more than {:.3} % of the load: {}: {}",
                100.0 * o.carried,
                o.origin.path,
                o.message
            ),
        }
    }
}

/// Whether the default start is quasi-static: the cycle turns at the start, and the model has journals or
/// flexible bodies. Without these nothing rings, and the assembled start serves.
fn is_turning_engine(model: &Model, state: &State) -> Result<bool, RuntimeError> {
    let Some(cycle) = &model.compiled.system.cycle else {
        return Ok(false);
    };
    if model.compiled.system.journals.is_empty() && model.bodies.iter().all(|b| b.modes() == 0) {
        return Ok(false);
    }
    let mut watch = Outputs::watching(model, cycle.element as usize)?;
    let mut dynamics = Dynamics::new(model);
    dynamics.place(model, state.time, &state.pose, &state.velocity);
    watch.evaluate(model, &dynamics, state)?;
    Ok(watch.watched_values[1] != 0.0)
}

/// A `require` on states that fails in the balance, such as a pin that would touch its shell.
fn forbidden(model: &Model, state: &State) -> Result<Option<Obstacle>, RuntimeError> {
    let elements = &model.compiled.system.elements;
    let mut watch = Watch::new(model, |e| {
        matches!(elements[e].role, Role::Dynamic | Role::Output)
    });
    let mut dynamics = Dynamics::new(model);
    dynamics.place(model, state.time, &state.pose, &state.velocity);
    let from = Inputs {
        memory: None,
        ..dynamics.inputs_at(state)
    };
    let mut found = None;
    watch.violations(
        model,
        &from,
        &[],
        |kind| *kind == ConditionKind::Require,
        |violation, values| {
            let condition = &model.class(violation.element).conditions[violation.condition];
            found.get_or_insert_with(|| Obstacle {
                origin: elements[violation.element].origin.clone(),
                message: condition.message_with(values),
                carried: 1.0,
            });
        },
    )?;
    Ok(found)
}

/// Brings an assembled state to the start of the analysis.
pub fn begin(model: &Model, state: &mut State, start: Start) -> Result<StartReport, RuntimeError> {
    let wanted = match start {
        Start::Assembled => false,
        Start::QuasiStatic => true,
        Start::Automatic => is_turning_engine(model, state)?,
    };
    // without bodies nothing moves
    if !wanted || model.velocities == 0 {
        return Ok(StartReport::Assembled);
    }
    Ok(match balanced(model, state, Terms::START)? {
        Ok(equilibrium) => StartReport::QuasiStatic(equilibrium),
        Err(obstacle) => StartReport::NoBalance(obstacle),
    })
}

/// Eccentricity ratios of the thinnest film at which further searches begin. A centred film has no wedge:
/// derivatives there belong to one of many cavities, and a starved film has no pressure at all. The values
/// are a choice, from half of the clearance to nearly all of it. Each is tried only if earlier ones found
/// nothing, so a further one costs time only in models without a balance so far.
const LEANS: [f64; 3] = [0.5, 0.8, 0.95];

/// Brings a state into balance. If there is an obstacle, the state does not change.
///
/// # Errors
/// Those of evaluation, such as a field that has no solution at the state.
pub(crate) fn balanced(
    model: &Model,
    state: &mut State,
    terms: Terms,
) -> Result<Result<Equilibrium, Obstacle>, RuntimeError> {
    has_fields(model, state)?;
    let mut obstacle = match searched(model, state, terms, false)? {
        Ok(found) => return Ok(Ok(found)),
        Err(obstacle) => obstacle,
    };
    let rigid = model.bodies.iter().all(|body| body.modes() == 0);
    let films = !model.compiled.system.journals.is_empty();
    if !(rigid && films) || terms.rest {
        return Ok(Err(obstacle));
    }
    if let Ok(found) = searched(model, state, terms, true)? {
        return Ok(Ok(found));
    }
    for ratio in LEANS {
        let leaning = Balance::new(model, state, terms, true)
            .and_then(|mut balance| balance.leaning(state, ratio));
        let Ok(Some(mut leaning)) = leaning else {
            break;
        };
        if let Ok(found) = searched(model, &mut leaning, terms, true)? {
            state.copy_from(&leaning);
            return Ok(Ok(found));
        }
    }
    if let Some((journal, ratio)) = closed_film(model, state) {
        obstacle = Obstacle {
            message: format!(
                "the search begins with a gap below zero, because the assembly puts the pin at {} of the clearance: {}: {}",
                short(ratio, 4),
                obstacle.origin.path,
                obstacle.message
            ),
            origin: journal,
            ..obstacle
        };
    }
    Ok(Err(obstacle))
}

/// The journal with the most eccentric pin, and its ratio, if this pin lies outside of its clearance.
fn closed_film(model: &Model, state: &State) -> Option<(Origin, f64)> {
    let system = &model.compiled.system;
    let ratios = eccentricity::film_ratios(model, &state.pose);
    let (journal, ratio) = (system.journals.iter().zip(ratios))
        .max_by(|(_, a), (_, b)| a.total_cmp(b))
        .filter(|(_, ratio)| *ratio >= 1.0)?;
    let element = &system.elements[journal.element as usize];
    Some((element.origin.clone(), ratio))
}

/// Searches from a state. If there is an obstacle, the state does not change.
fn searched(
    model: &Model,
    state: &mut State,
    terms: Terms,
    again: bool,
) -> Result<Result<Equilibrium, Obstacle>, RuntimeError> {
    let mut trial = state.clone();
    let solved = Balance::new(model, &trial, terms, again).and_then(|mut b| b.solve(&mut trial));
    match solved {
        Ok(equilibrium) => {
            if let Some(obstacle) = forbidden(model, &trial)? {
                return Ok(Err(obstacle));
            }
            state.copy_from(&trial);
            Ok(Ok(equilibrium))
        }
        Err(balance::Stop::Obstacle(obstacle)) => Ok(Err(obstacle)),
        Err(balance::Stop::Error(error)) => Err(error),
    }
}

/// Refuses a state at which a field has no solution: no search can begin there.
fn has_fields(model: &Model, state: &State) -> Result<(), RuntimeError> {
    let mut dynamics = Dynamics::new(model);
    dynamics.place(model, state.time, &state.pose, &state.velocity);
    dynamics.gather(model, &state.states, &state.multipliers, &state.rotations);
    match dynamics.evaluate(model) {
        Err(
            error @ RuntimeError::NotFinite {
                because: Some(_), ..
            },
        ) => Err(error),
        _ => Ok(()),
    }
}
