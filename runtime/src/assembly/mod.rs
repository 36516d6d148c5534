//! From stated and guessed places to positions and velocities that satisfy every constraint.
//!
//! 1. Bodies with a stated place stand there. The others are placed one by one along the joints that lead to placed bodies
//!    ([`placement`]).
//! 2. Loops are closed by Gauss–Newton steps of smallest norm ([`closing`]); stated places weigh more. Rows of guesses take
//!    part first and are then left out. Redundant but consistent rows do no harm.
//! 3. Where a loop stays open or a branch condition fails, the bodies around it are shaken and closed again.
//! 4. Ground markers that lie on their partners are frozen.
//! 5. Velocities: smallest kinetic energy that satisfies `Φ̇ = 0` and the start rows ([`velocity`]).

pub mod closing;
pub mod placement;
pub mod rows;
pub mod velocity;

use crate::error::RuntimeError;
use crate::model::Model;
use crate::rotation::{M3, quaternion};
use crate::state::State;
use eng_system::system::{ConditionKind, Role};
use rows::{At, Rows};
use std::f64::consts::PI;

/// A scaled row (m over the model's length, or rad) below this is closed.
pub const CLOSED: f64 = 1e-10;

/// Whether a scaled row is closed; NaN is not.
pub fn is_closed(size: f64) -> bool {
    size < CLOSED
}

/// A place to look from: borrowed parts of a state.
pub fn at(state: &State) -> At<'_> {
    At {
        time: state.time,
        pose: &state.pose,
        velocity: &state.velocity,
        states: &state.states,
        rotations: &state.rotations,
    }
}

/// Assembles positions and velocities; freezes the model's ground markers.
pub fn assemble(model: &mut Model) -> Result<State, RuntimeError> {
    let mut state = State::new(model);
    let system = model.compiled.system.clone();
    for (index, element) in system.elements.iter().enumerate() {
        if model.elements[index].dynamic {
            for (k, slot) in element.state_start.iter().enumerate() {
                state.states[model.elements[index].state + k] = model.slot(*slot);
            }
        }
    }
    let mut stated = Vec::with_capacity(model.bodies.len());
    for (body, info) in model.bodies.iter().zip(&system.bodies) {
        let p = body.pose;
        if let Some(position) = &info.position {
            for (i, slot) in position.iter().enumerate() {
                state.pose[p + i] = model.slot(*slot);
            }
        }
        if let Some(orientation) = &info.orientation {
            let matrix = M3::from_row_slice(&orientation.map(|slot| model.slot(slot)));
            state.pose[p + 3..p + 7].copy_from_slice(&quaternion(&matrix));
        }
        stated.push(info.position.is_some() || info.orientation.is_some());
    }
    if state
        .pose
        .iter()
        .chain(&state.states)
        .any(|x| !x.is_finite())
    {
        return Err(RuntimeError::Malformed {
            what: "a start value is not finite".to_string(),
        });
    }

    // what a marker follows holds its body where that stands: there is nothing to place it by
    for marker in &model.markers {
        if let Some(body) = marker
            .placed_at
            .and_then(|partner| model.markers[partner].body)
        {
            stated[body] = true;
        }
    }

    let has_rows = |e: &usize| !model.class(*e).rows.is_empty();
    let follows = |e: &usize| {
        model.elements[*e]
            .markers
            .iter()
            .any(|m| model.markers[*m].placed_at.is_some())
    };
    let all: Vec<usize> = (0..model.elements.len())
        .filter(|e| {
            matches!(
                system.elements[*e].role,
                Role::Dynamic | Role::StartPosition { .. }
            ) && !follows(e)
                && has_rows(e)
        })
        .collect();
    let exact: Vec<usize> = all
        .iter()
        .copied()
        .filter(|e| system.elements[*e].role != Role::StartPosition { exact: false })
        .collect();
    let conditioned: Vec<usize> = (0..model.elements.len())
        .filter(|e| {
            system.elements[*e].role == Role::Dynamic
                && !follows(e)
                && model
                    .class(*e)
                    .conditions
                    .iter()
                    .any(|c| c.kind == ConditionKind::Branch)
        })
        .collect();
    placement::place(model, &all, &mut state, &stated)?;
    closing::close_all(model, &all, &exact, &conditioned, &stated, &mut state)?;
    freeze(model, &state);
    settle_turns(model, &mut state)?;
    check_branches(model, &state)?;
    velocity::assemble(model, &mut state)?;
    Ok(state)
}

/// A branch is taken where its condition exceeds this (SI): closing is far more exact, so that a false solution on the border of
/// two branches is not let in by rounding.
const BRANCH_MARGIN: f64 = 1e-9;

/// Values of violated branch conditions: (element, condition, value).
pub fn violated_branches(
    model: &Model,
    elements: &[usize],
    state: &State,
) -> Result<Vec<(usize, usize, f64)>, RuntimeError> {
    let mut violated = Vec::new();
    for e in elements {
        let values = rows::conditions(model, *e, &at(state))?;
        for (k, condition) in model.class(*e).conditions.iter().enumerate() {
            let holds = values[k] > BRANCH_MARGIN;
            if condition.kind == ConditionKind::Branch && !holds {
                violated.push((*e, k, values[k]));
            }
        }
    }
    Ok(violated)
}

fn check_branches(model: &Model, state: &State) -> Result<(), RuntimeError> {
    let all: Vec<usize> = (0..model.elements.len())
        .filter(|e| model.elements[*e].dynamic)
        .collect();
    match violated_branches(model, &all, state)?.first() {
        Some((element, condition, value)) => Err(RuntimeError::Branch {
            origin: Box::new(model.compiled.system.elements[*element].origin.clone()),
            condition: model.class(*element).conditions[*condition].text.clone(),
            value: *value,
        }),
        None => Ok(()),
    }
}

/// Puts each ground marker that follows another where that one is.
fn freeze(model: &mut Model, state: &State) {
    for index in 0..model.markers.len() {
        if let Some(partner) = model.markers[index].placed_at {
            let place = rows::marker(model, partner, &state.pose, &state.velocity);
            let marker = &mut model.markers[index];
            marker.position = place.position;
            marker.orientation = place.rotation;
            marker.placed_at = None;
        }
    }
}

/// Chooses the turn of each rotation that occurs in rows: the one that leaves least of them; among equals the nearest to 0.
pub fn choose_turns(
    model: &Model,
    elements: &[usize],
    state: &mut State,
) -> Result<(), RuntimeError> {
    for e in elements {
        let count = model.class(*e).layout.rotations as usize;
        if count == 0 || model.class(*e).rows.is_empty() {
            continue;
        }
        let first = model.elements[*e].rotation;
        let rows = Rows::new(model, vec![*e]);
        let mut best = (f64::INFINITY, 0.0);
        for turn in [0.0, 1.0, -1.0, 2.0, -2.0, 3.0, -3.0, 4.0, -4.0] {
            state.rotations[first..first + count].fill(2.0 * PI * turn);
            let (values, _) = rows.evaluate(model, &at(state), rows::Along::Pose)?;
            if values.norm() < best.0 * (1.0 - 1e-9) {
                best = (values.norm(), turn);
            }
        }
        state.rotations[first..first + count].fill(2.0 * PI * best.1);
    }
    Ok(())
}

/// Unwrapped angles at the start. A start row that states more than half a turn between two bodies (`400 deg`) decides the turn of the
/// other rotations between them: each takes the turn nearest to it.
fn settle_turns(model: &Model, state: &mut State) -> Result<(), RuntimeError> {
    let system = model.compiled.system.clone();
    let bodies = |e: usize| -> Vec<Option<usize>> {
        model.elements[e]
            .markers
            .iter()
            .map(|m| model.markers[*m].body)
            .collect()
    };
    let mut watch = crate::outputs::Watch::new(model, |_| true);
    let markers: Vec<_> = (0..model.markers.len())
        .map(|m| rows::marker(model, m, &state.pose, &state.velocity))
        .collect();
    let starts: Vec<usize> = (0..model.elements.len())
        .filter(|e| {
            matches!(system.elements[*e].role, Role::StartPosition { .. })
                && model.class(*e).layout.rotations == 1
                && model.class(*e).layout.markers == 2
        })
        .collect();
    choose_turns(
        model,
        &(0..model.elements.len())
            .filter(|e| system.elements[*e].role != Role::Output)
            .collect::<Vec<_>>(),
        state,
    )?;
    let mut angles = state.rotations.clone();
    let unwrap = |references: &[f64], angles: &mut [f64], watch: &mut crate::outputs::Watch| {
        let from = crate::elements::Inputs {
            time: state.time,
            markers: &markers,
            states: &state.states,
            multipliers: &[],
            rotations: references,
        };
        watch.unwrap(model, &from, angles)
    };
    unwrap(&state.rotations, &mut angles, &mut watch)?;
    for e in 0..model.elements.len() {
        let element = &model.elements[e];
        let count = model.class(e).layout.rotations as usize;
        if count == 0 || matches!(system.elements[e].role, Role::StartPosition { .. }) {
            continue;
        }
        let own = bodies(e);
        for start in &starts {
            let pair = bodies(*start);
            if own.contains(&pair[0]) && own.contains(&pair[1]) {
                let reversed = own.len() == 2 && own[0] == pair[1] && pair[0] != pair[1];
                let stated =
                    angles[model.elements[*start].rotation] * if reversed { -1.0 } else { 1.0 };
                for angle in &mut angles[element.rotation..element.rotation + count] {
                    *angle += 2.0 * PI * libm::round((stated - *angle) / (2.0 * PI));
                }
                break;
            }
        }
    }
    state.rotations.copy_from_slice(&angles);
    Ok(())
}
