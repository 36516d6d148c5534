//! From stated and guessed positions to positions and velocities that satisfy every constraint.
//!
//! 1. Bodies with a stated position are placed there. The others are placed one by one along the joints to
//!    placed bodies ([`placement`]). A placed neighbour turns about its joint where a body does not reach it
//!    otherwise.
//! 2. Gauss–Newton steps of smallest norm close the loops ([`closing`]). Stated positions have a larger
//!    weight. Rows of guesses take part at first and are then dropped. Redundant but consistent rows do no
//!    harm.
//! 3. If a loop remains open or a branch condition fails, the bodies around it are displaced at random and
//!    closed again.
//! 4. Ground markers that coincide with their partners are fixed.
//!    Pins of journals prefer the middle of their shells, after all stated values, and after guesses inside of
//!    their clearances.
//! 5. Velocities: smallest kinetic energy that satisfies `Φ̇ = 0` and the start rows ([`velocity`]).

pub mod chains;
pub mod closing;
pub mod gradients;
pub mod independent;
pub mod lock;
pub mod placement;
pub mod rows;
pub mod velocity;

use crate::error::RuntimeError;
use crate::model::Model;
use crate::rotation::{M3, V3, quaternion};
use crate::state::State;
use chains::held_lengths;
use eng_system::system::{ConditionKind, Role, Rotation};
use rows::{At, Rows};
use std::f64::consts::PI;

/// Size of a scaled row (m over the model's length, or rad) below which it is closed. A choice: six decades
/// above the rounding of a position, and far below the tolerance of positions.
pub const CLOSED: f64 = 1e-10;

/// Whether a scaled row is closed; NaN is not.
pub fn is_closed(size: f64) -> bool {
    size < CLOSED
}

/// Borrowed parts of a state, for evaluating rows.
pub fn at(state: &State) -> At<'_> {
    At {
        time: state.time,
        pose: &state.pose,
        velocity: &state.velocity,
        states: &state.states,
        rotations: &state.rotations,
    }
}

/// Assembles positions and velocities. Fixes the model's ground markers.
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
    let mut places = placement::Stated::default();
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
        places.position.push(info.position.is_some());
        places.orientation.push(info.orientation.is_some());
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

    check_guesses(model, &state)?;

    // the equations of such a joint place no body, so a body that it joins to the ground stays at its first position
    for body in joined_to_ground(model) {
        places.position[body] = true;
    }
    let stated: Vec<bool> = places
        .position
        .iter()
        .zip(&places.orientation)
        .map(|(position, orientation)| *position || *orientation)
        .collect();

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
    let begin = state.clone();
    placement::place(model, &exact, &mut state, &places)?;
    let closed = closing::close_all(model, &all, &exact, &conditioned, &stated, &mut state);
    match closed {
        Err(error @ (RuntimeError::OpenLoop { .. } | RuntimeError::Branch { .. })) => {
            let lists = [&*all, &*exact, &*conditioned];
            let starts = contradicting(model, lists, (&places, stated.as_slice()), &begin);
            let origins = starts.iter().map(|e| system.elements[*e].origin.clone());
            return Err(match starts.len() {
                0 | 1 => error,
                _ => RuntimeError::Contradiction {
                    starts: origins.collect(),
                },
            });
        }
        closed => closed?,
    }
    if closing::a_guess_keeps_a_pin_out(model, &state)
        && let Some(free) = without_guesses(model, begin, [&exact, &conditioned], places, stated)
    {
        state = free;
    }
    freeze(model, &state);
    settle_turns(model, &mut state)?;
    check_branches(model, &state)?;
    velocity::assemble(model, &mut state)?;
    Ok(state)
}

/// The bodies that a joint with equations of lengths joins to `ground`. A ground marker without a place of its own follows
/// the other marker of its element, so these equations hold at any position. Forces and drives on such markers hold no
/// position: a damper to the ground on a flywheel leaves the flywheel to its bolts.
fn joined_to_ground(model: &Model) -> Vec<usize> {
    let joints = model.constraining().filter(|e| held_lengths(model, *e) > 0);
    let markers = joints.flat_map(|e| model.elements[e].markers.iter());
    markers
        .filter_map(|marker| model.markers[model.markers[*marker].placed_at?].body)
        .collect()
}

/// The assembly as if the text had no guesses; `None` if it does not close, or leaves a pin outside of its shell. A body
/// that is joined to the ground stays at its guess, because nothing else places it.
fn without_guesses(
    model: &Model,
    mut state: State,
    [exact, conditioned]: [&[usize]; 2],
    mut places: placement::Stated,
    mut stated: Vec<bool>,
) -> Option<State> {
    let joined = joined_to_ground(model);
    for (body, guessed) in closing::guessed(model).enumerate() {
        if guessed && !joined.contains(&body) {
            let pose = model.bodies[body].pose;
            state.pose[pose..pose + 7].copy_from_slice(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]);
            places.position[body] = false;
            places.orientation[body] = false;
            stated[body] = false;
        }
    }
    placement::place(model, exact, &mut state, &places).ok()?;
    closing::close_all(model, exact, exact, conditioned, &stated, &mut state).ok()?;
    (!closing::a_guess_keeps_a_pin_out(model, &state)).then_some(state)
}

/// The largest number of starts and drives of which a contradiction is searched. A choice: each costs an
/// assembly, and a message with this many helps nobody.
const MOST_STARTS: usize = 24;

/// A smallest set of starts and drives that do not hold together: leaving out any one of them lets the rest close.
/// Empty if the joints alone do not close. Each of them is left out in turn, for good if the rest stays open without
/// it. `begin` is the state before bodies are placed.
fn contradicting(
    model: &Model,
    lists: [&[usize]; 3],
    (places, stated): (&placement::Stated, &[bool]),
    begin: &State,
) -> Vec<usize> {
    let system = &model.compiled.system;
    let states_a_place = |e: &&usize| match system.elements[**e].role {
        Role::StartPosition { exact } => exact,
        Role::Dynamic => model.class(**e).facts.rows_over_time,
        _ => false,
    };
    let [_, exact, _] = lists;
    let mut found: Vec<usize> = exact.iter().filter(states_a_place).copied().collect();
    if found.len() > MOST_STARTS {
        return Vec::new();
    }
    let mut left_out = Vec::new();
    for element in found.clone() {
        left_out.push(element);
        let [all, exact, conditioned] = lists.map(|elements| {
            let kept = elements.iter().filter(|e| !left_out.contains(e));
            kept.copied().collect::<Vec<usize>>()
        });
        let mut state = begin.clone();
        // a trial without a value counts as open: the error of the whole is reported
        let closes = placement::place(model, &exact, &mut state, places)
            .and_then(|()| {
                let lists = (&*all, &*exact, &*conditioned);
                closing::close_near(model, lists, stated, &mut state)
            })
            .is_ok_and(|bad| bad.is_empty());
        match closes {
            true => left_out.truncate(left_out.len() - 1),
            false => found.retain(|other| *other != element),
        }
    }
    found
}

/// Largest distance of a guessed body from all others, in sizes of the largest body. A choice: metres in
/// place of millimetres make a factor of a thousand.
const FAR: f64 = 1e3;

/// Refuses a guess very far away. Closing the loops would take thousands of steps with an arbitrary end;
/// probably a unit is wrong.
fn check_guesses(model: &Model, state: &State) -> Result<(), RuntimeError> {
    let system = &model.compiled.system;
    let of_bodies = |e: usize| {
        model.elements[e]
            .markers
            .iter()
            .map(|m| model.markers[*m].body)
    };
    let rows = |wanted: &dyn Fn(&Role) -> bool| -> Vec<usize> {
        (0..model.elements.len())
            .filter(|e| wanted(&system.elements[*e].role) && !model.class(*e).rows.is_empty())
            .collect()
    };
    let joints = rows(&|role| *role == Role::Dynamic);
    let stated = rows(&|role| *role == Role::StartPosition { exact: true });
    for (index, (body, info)) in model.bodies.iter().zip(&system.bodies).enumerate() {
        let touches = |e: &&usize| of_bodies(**e).any(|b| b == Some(index));
        if info.position.is_none() || stated.iter().any(|e| touches(&e)) {
            continue;
        }
        let place = V3::from_column_slice(&state.pose[body.pose..body.pose + 3]);
        // the partners in its joints that have a position
        let partners = joints
            .iter()
            .filter(touches)
            .flat_map(|e| &model.elements[*e].markers);
        let distance = partners
            .map(|m| &model.markers[*m])
            .filter(|marker| marker.body != Some(index) && marker.placed_at.is_none())
            .map(|marker| match marker.body {
                None => (place - marker.position).norm(),
                Some(other) => {
                    let p = model.bodies[other].pose;
                    (place - V3::from_column_slice(&state.pose[p..p + 3])).norm()
                }
            })
            .reduce(f64::min);
        if let Some(distance) = distance
            && distance > FAR * model.length
        {
            return Err(RuntimeError::FarGuess {
                origin: Box::new(body.origin.clone()),
                distance,
                length: model.length,
            });
        }
    }
    Ok(())
}

/// Least value of a satisfied branch condition (SI). Loops close far more exactly, so rounding cannot admit a
/// false solution on the border of two branches.
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
        Some(violated) => Err(wrong_branch(model, state, *violated)),
        None => Ok(()),
    }
}

/// The error of a violated branch condition: (element, condition, value).
fn wrong_branch(model: &Model, state: &State, violated: (usize, usize, f64)) -> RuntimeError {
    let (element, condition, value) = violated;
    let condition = &model.class(element).conditions[condition];
    RuntimeError::Branch {
        origin: Box::new(model.compiled.system.elements[element].origin.clone()),
        condition: condition.text.clone(),
        dimension: condition.dimension,
        value,
        chain: chains::through(model, element, state).map(Box::new),
    }
}

/// Moves each ground marker that follows another to the position of that one.
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

/// Difference between the rows of two turns (SI) that is only rounding: rows of some radians round to 1e-15.
const TURN_MARGIN: f64 = 1e-12;

/// Chooses the turn of each rotation in the rows: the one with the smallest rows, and among equals the one
/// nearest to 0.
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
        // a choice: an angle between two bodies of an assembled model is within half a turn, gears multiply
        // it, and four turns cover the usual ratios
        for turn in [0.0, 1.0, -1.0, 2.0, -2.0, 3.0, -3.0, 4.0, -4.0] {
            state.rotations[first..first + count].fill(2.0 * PI * turn);
            let values = rows.values(model, &at(state))?;
            // rounding must not choose a farther turn
            if values.norm() < best.0 * (1.0 - 1e-9) - TURN_MARGIN {
                best = (values.norm(), turn);
            }
        }
        state.rotations[first..first + count].fill(2.0 * PI * best.1);
    }
    Ok(())
}

/// Sets unwrapped angles at the start. They are in (−π, π], unless a start states an angle (`400 deg`) or
/// rows decide.
///
/// A stated angle keeps its stated turns. Other angles between the same two markers take the same value, with
/// the opposite sign if they are measured the other way. Angles between other markers of the same two bodies
/// take the nearest turn. Rows of the model have priority: if they do not hold with this turn, the angle
/// keeps the turn with the smallest rows.
fn settle_turns(model: &Model, state: &mut State) -> Result<(), RuntimeError> {
    let system = model.compiled.system.clone();
    let starts = |e: usize| matches!(system.elements[e].role, Role::StartPosition { .. });
    let chosen: Vec<usize> = (0..model.elements.len())
        .filter(|e| system.elements[*e].role != Role::Output)
        .collect();
    choose_turns(model, &chosen, state)?;
    let markers: Vec<_> = (0..model.markers.len())
        .map(|m| rows::marker(model, m, &state.pose, &state.velocity))
        .collect();
    let mut angles = state.rotations.clone();
    let from = crate::elements::Inputs {
        time: state.time,
        markers: &markers,
        states: &state.states,
        multipliers: &[],
        rotations: &state.rotations,
        moving: &[],
        memory: None,
        surfaces: &[],
    };
    crate::outputs::Watch::new(model, |_| true).unwrap(model, &from, &mut angles)?;

    let pair = |e: usize, rotation: &Rotation| {
        let markers = &model.elements[e].markers;
        Some([
            *markers.get(rotation.turning as usize)?,
            *markers.get(rotation.reference as usize)?,
        ])
    };
    let nearest = |angle: f64, to: f64| angle + 2.0 * PI * libm::round((to - angle) / (2.0 * PI));
    let mut stated = Vec::new();
    for (e, element) in system
        .elements
        .iter()
        .enumerate()
        .filter(|(e, _)| starts(*e))
    {
        for (k, rotation) in element.rotations.iter().enumerate() {
            let Some(markers) = pair(e, rotation) else {
                continue;
            };
            let angle = &mut angles[model.elements[e].rotation + k];
            if let Some(slot) = rotation.stated {
                *angle = nearest(*angle, model.slot(slot));
            }
            stated.push((markers, *angle));
        }
    }
    for (e, element) in system
        .elements
        .iter()
        .enumerate()
        .filter(|(e, _)| !starts(*e))
    {
        let first = model.elements[e].rotation;
        let alone = angles.clone();
        for (k, rotation) in element.rotations.iter().enumerate() {
            if let Some(markers) = pair(e, rotation)
                && let Some(to) = stated_between(model, markers, &stated)
            {
                angles[first + k] = nearest(angles[first + k], to);
            }
        }
        if element.role == Role::Dynamic && angles != alone && !model.class(e).rows.is_empty() {
            let rows = Rows::new(model, vec![e]);
            let left = |rotations: &[f64]| {
                let at = At {
                    rotations,
                    ..at(state)
                };
                let values = rows.values(model, &at)?;
                Ok::<f64, RuntimeError>(values.norm())
            };
            // rounding must not choose, as in [`choose_turns`]
            if left(&angles)? > left(&alone)? * (1.0 + 1e-9) + TURN_MARGIN {
                angles = alone;
            }
        }
    }
    state.rotations.copy_from_slice(&angles);
    Ok(())
}

/// The stated angle of one marker from another (rad): the angle of these two markers, else that of other
/// markers of the same bodies.
fn stated_between(model: &Model, markers: [usize; 2], stated: &[([usize; 2], f64)]) -> Option<f64> {
    let bodies = |markers: [usize; 2]| markers.map(|m| model.markers[m].body);
    let signed = |same: &dyn Fn([usize; 2]) -> bool| {
        stated.iter().find_map(|([turning, reference], angle)| {
            if same([*turning, *reference]) {
                Some(*angle)
            } else {
                same([*reference, *turning]).then_some(-angle)
            }
        })
    };
    signed(&|pair| pair == markers).or_else(|| signed(&|pair| bodies(pair) == bodies(markers)))
}
