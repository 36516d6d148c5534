//! Analyses of one state: the equilibrium, in which nothing moves and all loads balance, and the assembled position.
//!
//! The equilibrium solves
//!
//! ```text
//! −Q_g − Σ JᵀW + Gᵀλ = 0        Φ(q, t) = 0        v = 0, v̇ = 0
//! ```
//!
//! with the machinery of the start ([`crate::start::balance`]). A drive holds the position that it has at the
//! time, even if it states a speed. A position that `start` states is only the first value of the search,
//! because the force that would hold it there is not part of the model. Only an angle of the cycle that the
//! analysis states is held, and the report gives the effort.
//!
//! States of elements come to rest with the bodies ([`settling`]): creep has ended, pressures are even.
//!
//! In the balance of a steady motion the speeds that `start` and drives state continue, and the cycle's angle
//! is held: it is the quasi-static start without the positions that `start` states.

mod settling;

use crate::error::RuntimeError;
use crate::model::Model;
use crate::simulation::{Options, Simulation, assembled};
use crate::start::balance::Terms;
use crate::start::{Equilibrium, Obstacle, StartReport, balanced, turn};
use crate::state::State;
use crate::transient::{Observer, Sample};
use eng_system::analysis::Static;
use eng_system::code::Compiled;
use eng_system::dense::largest_difference;
use eng_system::system::Extent;

/// Rounds in which an angle of the cycle is held: the balance moves it by the square of its own moves. A
/// choice: a move of a hundredth is rounding after four.
const ROUNDS: usize = 6;
/// Share of a state's scale by which it may change in a second. A choice: at this rate a state takes more
/// than a day to change by a tenth.
const RESTS: f64 = 1e-6;

/// Finds the equilibrium of a `static` analysis. `observer` gets the report, one sample, and warnings.
///
/// # Errors
/// [`RuntimeError::NoEquilibrium`] with the body or element that moves on; errors of assembly and evaluation.
pub fn run_static(
    compiled: &Compiled,
    overrides: &[Option<f64>],
    wanted: &Static,
    observer: &mut dyn Observer,
) -> Result<(), RuntimeError> {
    let options = Options::default();
    let (model, mut state) = assembled(compiled, overrides, &options)?;
    let found = equilibrium(&model, &mut state, wanted)?;
    let report = StartReport::Equilibrium(found);
    observer.started(&report);
    let simulation = if wanted.turning {
        Simulation::begun(model, state, options, report)?
    } else {
        Simulation::resting(model, state, report)?
    };
    observe(simulation, observer)
}

/// Assembles a model and shows its position as the one sample. `observer` gets it with the warnings.
///
/// # Errors
/// Those of assembly and evaluation.
pub fn run_assemble(
    compiled: &Compiled,
    overrides: &[Option<f64>],
    observer: &mut dyn Observer,
) -> Result<(), RuntimeError> {
    observe(
        Simulation::new(compiled, overrides, Options::default())?,
        observer,
    )
}

/// Gives one sample, of the last accepted state, and the warnings.
fn observe(mut simulation: Simulation, observer: &mut dyn Observer) -> Result<(), RuntimeError> {
    let mut values = vec![0.0; simulation.model().compiled.system.channels.len()];
    simulation.evaluate_channels(&mut values)?;
    // the only sample: nothing is left to break off
    let _ = observer.sample(&Sample {
        time: simulation.time(),
        cycle_angle: simulation.cycle_angle(),
        cycle_rate: simulation.cycle_rate(),
        values: &values,
        energy: simulation.energy(),
        eccentricities: &simulation.eccentricities(),
        pose: simulation.sampled_pose(),
        velocity: &simulation.sampled_state().velocity,
        states: &simulation.sampled_state().states,
        fields: &simulation.sampled_fields(),
    });
    for warning in simulation.take_warnings() {
        observer.warning(&warning);
    }
    Ok(())
}

fn equilibrium(
    model: &Model,
    state: &mut State,
    wanted: &Static,
) -> Result<Equilibrium, RuntimeError> {
    if let Some(at) = wanted.at {
        turn::bring(model, state, at, false)?;
    }
    if !wanted.turning {
        state.velocity.fill(0.0);
    }
    // without bodies nothing moves
    if model.velocities == 0 {
        return Ok(Equilibrium::default());
    }
    let refused = |obstacle: Obstacle| RuntimeError::NoEquilibrium {
        origin: Box::new(obstacle.origin),
        message: obstacle.message,
        carried: obstacle.carried,
        turning: wanted.turning,
        films: !model.compiled.system.journals.is_empty(),
    };
    let held = wanted.at.filter(|at| matches!(at, Extent::Angle(_)));
    let terms = Terms {
        positions: false,
        cycle: wanted.turning || held.is_some(),
        rest: !wanted.turning,
    };
    let mut iterations = 0;
    let mut balance = |state: &mut State| {
        let found = held_balance(model, state, wanted, terms)?;
        iterations += found.as_ref().map_or(0, |found| found.iterations);
        Ok(found)
    };
    let mut found = balance(state)?.map_err(refused)?;
    if wanted.turning {
        return Ok(found);
    }
    if settling::moving(model, state)?.is_some() {
        let settled = settling::settle(model, state, &mut balance)?.map_err(refused)?;
        found = settled.unwrap_or(found);
    }
    found.iterations = iterations;
    match settling::moving(model, state)? {
        Some(obstacle) => Err(refused(obstacle)),
        None => Ok(found),
    }
}

/// The balance with the cycle at the stated angle, which a balance at rest moves by the square of its own moves.
fn held_balance(
    model: &Model,
    state: &mut State,
    wanted: &Static,
    terms: Terms,
) -> Result<Result<Equilibrium, Obstacle>, RuntimeError> {
    let mut found = match balanced(model, state, terms)? {
        Ok(found) => found,
        Err(obstacle) => return Ok(Err(obstacle)),
    };
    let held = wanted.at.filter(|at| matches!(at, Extent::Angle(_)));
    let Some(at) = held.filter(|_| !wanted.turning) else {
        return Ok(Ok(found));
    };
    for _ in 0..ROUNDS {
        let before = state.pose.clone();
        turn::bring(model, state, at, true)?;
        state.velocity.fill(0.0);
        let again = match balanced(model, state, terms)? {
            Ok(again) => again,
            Err(obstacle) => return Ok(Err(obstacle)),
        };
        found = Equilibrium {
            iterations: found.iterations + again.iterations,
            portions: found.portions,
            ..again
        };
        // a thousandth of the position tolerance: another round would change nothing that a result shows
        if largest_difference(&before, &state.pose) <= 1e-3 * model.tolerance {
            break;
        }
    }
    Ok(Ok(found))
}
