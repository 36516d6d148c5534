//! States of elements at rest: creep has ended, pressures are even.
//!
//! At fixed positions Newton's method brings the rates f(q, 0, z) of all states to zero. Then the bodies find their
//! balance with these states, and so on. Each round leaves the share of a state's move that the bodies answer,
//! such as `k_fast/(k_slow + k_fast)` of a mount that creeps; extrapolation of the rounds removes it.

use super::RESTS;
use crate::dynamics::Dynamics;
use crate::error::RuntimeError;
use crate::model::Model;
use crate::start::Obstacle;
use crate::state::State;
use eng_system::significant::short;
use nalgebra::{DMatrix, DVector};

/// Most rounds between states and bodies. A choice: extrapolation ends after about as many rounds as there
/// are states that answer, and plain rounds with a share of one half after fifty.
const ROUNDS: usize = 60;
/// Rounds that the extrapolation remembers. A choice: each may remove the share of one state or of one group
/// of states.
const PAIRS: usize = 6;
/// Most steps of Newton's method at fixed positions. A choice: laws of states are smooth, so that a few
/// serve.
const STEPS: usize = 20;
/// Step of the differences, as a share of a state's size. A choice: the error of central differences is its
/// square, and rounding, 1e-10, only slows down Newton's method.
const STEP: f64 = 1e-6;
/// Share of a state's size up to which its last move counts as none. Some thousand rounding units, because
/// rates cancel at rest.
const STILL: f64 = 1e-13;
/// Share of the largest singular value below which a direction of states has no rest of its own. A choice
/// above the rounding of the decomposition.
const RANK: f64 = 1e-12;

/// Brings the states of elements to rest. `balance` brings the bodies into balance with them. The state is in
/// balance, and its states may change. Returns the result of the last `balance`, if there was one.
///
/// # Errors
/// Those of `balance` and of the evaluation. States that find no rest remain, and [`moving`] names them.
pub(super) fn settle<F, E>(
    model: &Model,
    state: &mut State,
    mut balance: impl FnMut(&mut State) -> Result<Result<F, E>, RuntimeError>,
) -> Result<Result<Option<F>, E>, RuntimeError> {
    let sizes: Vec<f64> = model
        .state_scales
        .iter()
        .zip(&state.states)
        .map(|(scale, z)| scale.max(z.abs()))
        .collect();
    let mut last_found = None;
    // the last moves of the states, and the changes of the moves to rest along them
    let mut pairs: Vec<(DVector<f64>, DVector<f64>)> = Vec::new();
    let mut before: Option<(DVector<f64>, DVector<f64>)> = None;
    for _ in 0..ROUNDS {
        let plain = moves_to_rest(model, state, &sizes)?;
        if let Some((moved, last)) = before {
            pairs.push((moved, &plain - last));
            if pairs.len() > PAIRS {
                pairs.remove(0);
            }
        }
        let improved = extrapolated(&plain, &pairs);
        if improved.amax() <= STILL {
            break;
        }
        for (k, moved) in improved.iter().enumerate() {
            state.states[k] += moved * sizes[k];
        }
        match balance(state)? {
            Ok(found) => last_found = Some(found),
            Err(stop) => return Ok(Err(stop)),
        }
        before = Some((improved, plain));
    }
    Ok(Ok(last_found))
}

/// The move to the fixed point of rounds whose move is `plain`: `r − Σ γ_j (Δz_j + Δr_j)` with the least `|r
/// − Σ γ_j Δr_j|` (D. G. Anderson, J. ACM 12 (1965) 547). All moves are shares of the states' sizes.
fn extrapolated(plain: &DVector<f64>, pairs: &[(DVector<f64>, DVector<f64>)]) -> DVector<f64> {
    if pairs.is_empty() {
        return plain.clone();
    }
    let changes: Vec<DVector<f64>> = pairs.iter().map(|(_, change)| change.clone()).collect();
    let changes = DMatrix::from_columns(&changes);
    let parts = changes.svd(true, true);
    let rank = RANK * parts.singular_values.amax();
    let Ok(shares) = parts.solve(plain, rank) else {
        return plain.clone();
    };
    let mut improved = plain.clone();
    for ((moved, change), share) in pairs.iter().zip(shares.iter()) {
        improved -= (moved + change) * *share;
    }
    match improved.iter().all(|x| x.is_finite()) {
        true => improved,
        false => plain.clone(),
    }
}

/// Rates of all states at the positions of a state, with bodies at rest. In SI per second.
fn rates(model: &Model, state: &State, states: &[f64]) -> Result<DVector<f64>, RuntimeError> {
    let mut dynamics = Dynamics::new(model);
    dynamics.place(model, state.time, &state.pose, &state.velocity);
    dynamics.gather(model, states, &state.multipliers, &state.rotations);
    dynamics.evaluate(model)?;
    Ok(DVector::from_column_slice(dynamics.rates()))
}

/// The moves of all states, as shares of their sizes, to zero rates at fixed positions.
fn moves_to_rest(
    model: &Model,
    state: &State,
    sizes: &[f64],
) -> Result<DVector<f64>, RuntimeError> {
    let count = model.states;
    let mut states = state.states.clone();
    for _ in 0..STEPS {
        let here = rates(model, state, &states)?;
        let mut slopes = DMatrix::zeros(count, count);
        for k in 0..count {
            let step = STEP * sizes[k];
            let mut moved = states.clone();
            moved[k] += step;
            let above = rates(model, state, &moved)?;
            moved[k] = states[k] - step;
            let below = rates(model, state, &moved)?;
            let column = (above - below) * (0.5 / STEP);
            slopes.set_column(k, &column);
        }
        // slow and fast states count alike
        let mut due = -here;
        for i in 0..count {
            let most = slopes.row(i).amax();
            if most > 0.0 {
                slopes.row_mut(i).scale_mut(1.0 / most);
                due[i] /= most;
            } else {
                due[i] = 0.0;
            }
        }
        let parts = slopes.svd(true, true);
        let rank = RANK * parts.singular_values.amax();
        let Ok(step) = parts.solve(&due, rank) else {
            break;
        };
        if step.iter().any(|x| !x.is_finite()) {
            break;
        }
        for (k, moved) in step.iter().enumerate() {
            states[k] += moved * sizes[k];
        }
        if step.amax() <= STILL {
            break;
        }
    }
    let moves = states.iter().zip(&state.states).zip(sizes);
    let moves = moves.map(|((moved, from), size)| (moved - from) / size);
    Ok(DVector::from_iterator(count, moves))
}

/// A state of an element that changes though nothing moves: the balance holds for a moment only.
pub(super) fn moving(model: &Model, state: &State) -> Result<Option<Obstacle>, RuntimeError> {
    let rates = rates(model, state, &state.states)?;
    for (at, (rate, value)) in rates.iter().zip(&state.states).enumerate() {
        let scale = model.state_scales[at].max(value.abs());
        let moves = rate.abs() > RESTS * scale;
        if let Some((element, name)) = model.state_named(at).filter(|_| moves) {
            return Ok(Some(Obstacle {
                origin: model.compiled.system.elements[element].origin.clone(),
                message: format!(
                    "its state `{name}` changes by {} % per second",
                    short(100.0 * rate.abs() / scale, 4)
                ),
                carried: 0.0,
            }));
        }
    }
    Ok(None)
}
