//! Closing of loops: Gauss–Newton with smallest steps, and random displacements if it ends on a wrong branch.

use super::gradients::Gradients;
use super::rows::{Along, Preference, Rows, smallest_solution};
use super::{at, choose_turns, is_closed, violated_branches};
use crate::body::BodyModel;
use crate::elements::undefined;
use crate::error::RuntimeError;
use crate::model::Model;
use crate::rotation::{exponential, normalized, product, quaternion};
use crate::state::{State, move_pose};
use eng_system::dense::largest;
use eng_system::system::Role;
use nalgebra::DVector;
use std::collections::BTreeSet;

/// Mobility of a body with a stated position, relative to one without. A choice: it moves a thousandth as
/// far, that is only where the others cannot close the loops.
const STATED: f64 = 1e-3;
/// Mobility of a body's modes, relative to its motion as a whole. A choice: bodies bend only where rigid
/// motions do not close the loops, but then the steps of the search still reach them.
const BENDING: f64 = 1e-2;

/// Deterministic pseudo-random numbers in −1…1 (a linear congruential generator with Knuth's MMIX constants).
#[derive(Clone, Debug)]
pub struct Numbers(u64);

impl Numbers {
    /// The sequence of a seed.
    pub fn new(seed: u64) -> Numbers {
        Numbers(
            // one step of another generator of this kind spreads small seeds over all bits
            seed.wrapping_mul(2_862_933_555_777_941_757)
                .wrapping_add(3_037_000_493),
        )
    }
    /// The next number.
    pub fn draw(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}

/// Moves the bodies until the rows close. `mobility` is by velocity index, and 0 holds a velocity. Returns
/// the largest scaled row.
pub fn close(
    model: &Model,
    rows: &Rows,
    mobility: &[f64],
    state: &mut State,
    limit: usize,
) -> Result<f64, RuntimeError> {
    let active: Vec<usize> = (0..mobility.len()).filter(|i| mobility[*i] > 0.0).collect();
    let columns = model.velocity_scales();
    let mut trial = state.clone();
    let measure = |state: &mut State| -> Result<(DVector<f64>, Gradients), RuntimeError> {
        choose_turns(model, &rows.elements, state)?;
        let (mut values, mut matrix) = rows.gradients(model, &at(state), Along::Pose)?;
        rows.scale_gradients(model, &mut values, &mut matrix);
        Ok((values, matrix))
    };
    let (mut values, mut matrix) = measure(state)?;
    for _ in 0..limit {
        // rounding of a scaled row: nothing is left to correct
        if values.amax() < 1e-14 {
            break;
        }
        let reduced = matrix.columns(&active, |j| mobility[j]);
        let Some(step) = smallest_solution(&reduced, &(-&values)) else {
            break;
        };
        let mut increment = vec![0.0; mobility.len()];
        for (j, i) in active.iter().enumerate() {
            increment[*i] = step[j] * mobility[*i];
        }
        let largest = largest(&increment);
        // below the rounding of a scaled position a step moves nothing
        if largest < 1e-15 {
            break;
        }
        for (x, s) in increment.iter_mut().zip(&columns) {
            *x *= s;
        }
        // no move is longer than the model or a radian: beyond that the linear equations mean nothing
        let mut factor = (1.0 / largest).min(1.0);
        let mut better = None;
        // fourteen halvings: a step that does not help at 6e-5 of its length leads nowhere. A choice
        for _ in 0..14 {
            move_pose(model, &state.pose, &increment, factor, &mut trial.pose);
            let (v, m) = measure(&mut trial)?;
            // Armijo's rule with its usual share: a decrease by rounding alone is none
            if v.norm() < values.norm() * (1.0 - 1e-4 * factor) {
                better = Some((v, m));
                break;
            }
            factor *= 0.5;
        }
        let Some((v, m)) = better else { break };
        std::mem::swap(&mut state.pose, &mut trial.pose);
        state.rotations.copy_from_slice(&trial.rotations);
        values = v;
        matrix = m;
    }
    choose_turns(model, &rows.elements, state)?;
    Ok(if values.is_empty() {
        0.0
    } else {
        values.amax()
    })
}

/// Mobility of all bodies. Stated bodies move little, and bodies bend only if loops do not close otherwise.
/// Dimensionless, by velocity index.
fn mobility(model: &Model, stated: &[bool]) -> Vec<f64> {
    let mut m = vec![0.0; model.velocities];
    for (body, stated) in model.bodies.iter().zip(stated) {
        set_mobility(body, if *stated { STATED } else { 1.0 }, &mut m);
    }
    m
}

/// Sets the mobility of a body; that of its modes is far smaller.
pub fn set_mobility(body: &BodyModel, mobility: f64, all: &mut [f64]) {
    let first = body.velocity;
    all[first..first + 6].fill(mobility);
    all[first + 6..first + body.width()].fill(BENDING * mobility.min(STATED));
}

/// The bodies an element touches.
pub fn bodies_of(model: &Model, element: usize) -> BTreeSet<usize> {
    model.elements[element]
        .markers
        .iter()
        .filter_map(|m| model.markers[*m].body)
        .collect()
}

/// Elements among `exact` that remain open or on a wrong branch.
fn offending(
    model: &Model,
    exact: &[usize],
    conditioned: &[usize],
    state: &State,
) -> Result<Vec<usize>, RuntimeError> {
    let mut found = BTreeSet::new();
    let rows = Rows::new(model, exact.to_vec());
    let values = rows.values(model, &at(state))?;
    for (i, (element, _)) in rows.owners.iter().enumerate() {
        if !is_closed(values[i].abs() / rows.scales[i]) {
            found.insert(*element);
        }
    }
    for (element, _, _) in violated_branches(model, conditioned, state)? {
        found.insert(element);
    }
    Ok(found.into_iter().collect())
}

/// Moves pins into their shells and surfaces into touch as far as the other rows allow. Bodies with a stated
/// position do not follow such a preference. Surfaces that cannot touch, such as those of a stop on the other
/// side, have no influence.
fn follow_preferences(
    model: &Model,
    all: &[usize],
    mut preferences: Vec<Preference>,
    stated: &[bool],
    state: &mut State,
) -> Result<(), RuntimeError> {
    if preferences.is_empty() {
        return Ok(());
    }
    let mut free = mobility(model, stated);
    for (body, stated) in model.bodies.iter().zip(stated) {
        if *stated {
            free[body.velocity..body.velocity + body.width()].fill(0.0);
        }
    }
    let begin = state.clone();
    loop {
        let rows = Rows::new(model, all.to_vec()).with(model, &preferences);
        // counts of steps here and below are choices: Newton's method needs few near a solution, and the last
        // search of a state, which decides, gets more
        close(model, &rows, &free, state, 60)?;
        let count = preferences.len();
        preferences.retain(|preference| {
            preference.is_inside() || preference.is_fulfilled(model, &at(state))
        });
        if preferences.len() == count {
            return Ok(());
        }
        *state = begin.clone();
    }
}

/// Moves the pins into their shells without the guesses, if guesses keep a pin out of its shell. Guesses are
/// only the first values of the search. A guess inside of all clearances stays, because a film lets the pin
/// be anywhere there.
fn leave_guesses(
    model: &Model,
    exact: &[usize],
    stated: &[bool],
    state: &mut State,
) -> Result<(), RuntimeError> {
    if !a_guess_keeps_a_pin_out(model, state) {
        return Ok(());
    }
    let mut preferences = super::rows::preferences(model);
    preferences.retain(Preference::is_inside);
    let held = stated.iter().zip(guessed(model));
    let held: Vec<bool> = held.map(|(stated, guessed)| *stated && !guessed).collect();
    follow_preferences(model, exact, preferences, &held, state)?;
    let rows = Rows::new(model, exact.to_vec());
    close(model, &rows, &mobility(model, &held), state, 80)?;
    Ok(())
}

/// Whether the text guesses the position or orientation of each body.
pub fn guessed(model: &Model) -> impl Iterator<Item = bool> {
    let bodies = model.compiled.system.bodies.iter();
    bodies.map(|body| !body.guessed_at.is_empty())
}

/// Whether the text has a guess, and a pin is outside of its shell.
pub fn a_guess_keeps_a_pin_out(model: &Model, state: &State) -> bool {
    let guess = Role::StartPosition { exact: false };
    let mut elements = model.compiled.system.elements.iter();
    (guessed(model).any(|guessed| guessed) || elements.any(|e| e.role == guess))
        && super::rows::preferences(model)
            .iter()
            .any(|preference| preference.is_inside() && !preference.is_fulfilled(model, &at(state)))
}

/// Closes all rows from the given position: first with guesses, then without, and again with the axes of markers
/// aligned. Returns the elements that remain open or on a wrong branch.
pub(super) fn close_near(
    model: &Model,
    (all, exact, conditioned): (&[usize], &[usize], &[usize]),
    stated: &[bool],
    state: &mut State,
) -> Result<Vec<usize>, RuntimeError> {
    let every = mobility(model, stated);
    follow_preferences(model, all, super::rows::preferences(model), stated, state)?;
    if all.len() > exact.len() {
        close(model, &Rows::new(model, all.to_vec()), &every, state, 60)?;
    }
    let rows = Rows::new(model, exact.to_vec());
    close(model, &rows, &every, state, 80)?;
    leave_guesses(model, exact, stated, state)?;
    let bad = offending(model, exact, conditioned, state)?;
    if bad.is_empty() {
        return Ok(bad);
    }
    // A joint may close with its axes exchanged, on the border of its branches. Aligning its markers' axes
    // avoids this.
    let mut trial = state.clone();
    for element in &bad {
        align(model, stated, *element, &mut trial);
    }
    close(model, &rows, &every, &mut trial, 80)?;
    let found = offending(model, exact, conditioned, &trial)?;
    if found.len() < bad.len() {
        *state = trial;
        return Ok(found);
    }
    Ok(bad)
}

/// Closes all rows on the right branches.
pub fn close_all(
    model: &Model,
    all: &[usize],
    exact: &[usize],
    conditioned: &[usize],
    stated: &[bool],
    state: &mut State,
) -> Result<(), RuntimeError> {
    let mut bad = close_near(model, (all, exact, conditioned), stated, state)?;
    let every = mobility(model, stated);
    let rows = Rows::new(model, exact.to_vec());
    let mut numbers = Numbers::new(1);
    // a choice: two trials for each element, and an end for large models, in which each costs much
    for _ in 0..(2 * model.elements.len()).min(40) {
        let Some(first) = bad.first().copied() else {
            break;
        };
        if !shake(
            model,
            exact,
            conditioned,
            stated,
            first,
            &mut numbers,
            state,
        )? {
            break;
        }
        close(model, &rows, &every, state, 80)?;
        bad = offending(model, exact, conditioned, state)?;
    }
    // if this fails, the search begins at other positions
    let begin = state.clone();
    // a choice: a new beginning of all bodies costs as much as the whole search before
    for _ in 0..6 {
        if bad.is_empty() {
            return Ok(());
        }
        let mut trial = begin.clone();
        for (index, body) in model.bodies.iter().enumerate() {
            if !stated[index] {
                // half of the model's length, a choice: far enough for another branch, and not far from the
                // other bodies
                turn_body(model, body.pose, &mut numbers, &mut trial, 0.5);
            }
        }
        close(model, &rows, &every, &mut trial, 80)?;
        let found = offending(model, exact, conditioned, &trial)?;
        if found.len() < bad.len() {
            bad = found;
            *state = trial;
        }
    }
    if bad.is_empty() {
        return Ok(());
    }
    let values = rows.values(model, &at(state))?;
    let mut open: Vec<(f64, usize)> = (0..rows.len())
        .map(|i| (values[i].abs() / rows.scales[i], i))
        .filter(|(size, _)| !is_closed(*size))
        .collect();
    open.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    if open.is_empty() {
        if let Some(violated) = violated_branches(model, conditioned, state)?.first() {
            return Err(super::wrong_branch(model, state, *violated));
        }
        return Ok(());
    }
    // a row may be NaN, from a table without a value at the start or from an undefined expression
    if let Some((_, i)) = open.iter().find(|(size, _)| !size.is_finite()) {
        let (element, _) = rows.owners[*i];
        let inputs = super::rows::inputs(model, element, &at(state));
        let function = eng_system::code::Function::Residual;
        let time = state.time;
        return Err(undefined(model, element, time, function, &inputs, 0));
    }
    open.truncate(6);
    let chain = open
        .iter()
        .find_map(|(_, i)| super::chains::through(model, rows.owners[*i].0, state));
    Err(RuntimeError::OpenLoop {
        chain: chain.map(Box::new),
        rows: open
            .iter()
            .map(|(_, i)| {
                let (element, row) = rows.owners[*i];
                model.named_row(element, row, values[*i])
            })
            .collect(),
    })
}

/// Turns a body without a stated position about its marker, so that the axes of an element's two markers
/// agree.
fn align(model: &Model, stated: &[bool], element: usize, state: &mut State) {
    let markers = model.elements[element].markers.as_slice();
    let (&[a, b], Some(_)) = (markers, model.class(element).rows.first()) else {
        return;
    };
    for (own, other) in [(a, b), (b, a)] {
        let Some(body) = model.markers[own].body.filter(|body| !stated[*body]) else {
            continue;
        };
        let [place, target] =
            [own, other].map(|m| super::rows::marker(model, m, &state.pose, &state.velocity));
        let marker = &model.markers[own];
        let rotation = target.rotation * marker.orientation.transpose();
        let position = place.position - rotation * marker.position;
        let pose = model.bodies[body].pose;
        state.pose[pose..pose + 3].copy_from_slice(position.as_slice());
        state.pose[pose + 3..pose + 7].copy_from_slice(&quaternion(&rotation));
        return;
    }
}

fn turn_body(model: &Model, pose: usize, numbers: &mut Numbers, state: &mut State, reach: f64) {
    for i in 0..3 {
        state.pose[pose + i] += reach * model.length * numbers.draw();
    }
    let axis = crate::rotation::V3::new(numbers.draw(), numbers.draw(), numbers.draw());
    // an axis that is drawn shorter has no certain direction; its turn is then smaller than half a turn
    let theta = axis * (std::f64::consts::PI / axis.norm().max(0.1) * numbers.draw());
    let old = [
        state.pose[pose + 3],
        state.pose[pose + 4],
        state.pose[pose + 5],
        state.pose[pose + 6],
    ];
    let new = normalized(&product(&old, &exponential(&theta)));
    state.pose[pose + 3..pose + 7].copy_from_slice(&new);
}

/// Displaces the bodies around an element at random until all their elements close on the right branch. Other
/// bodies are held.
fn shake(
    model: &Model,
    exact: &[usize],
    conditioned: &[usize],
    stated: &[bool],
    element: usize,
    numbers: &mut Numbers,
    state: &mut State,
) -> Result<bool, RuntimeError> {
    let mut cluster: BTreeSet<usize> = bodies_of(model, element);
    for radius in 0..3 {
        if radius > 0 {
            let mut wider = cluster.clone();
            for e in exact {
                let touched = bodies_of(model, *e);
                if !touched.is_disjoint(&cluster) {
                    wider.extend(touched);
                }
            }
            if wider == cluster {
                break;
            }
            cluster = wider;
        }
        let mobile: Vec<usize> = cluster.iter().copied().filter(|b| !stated[*b]).collect();
        if mobile.is_empty() {
            continue;
        }
        let mut mobility = vec![0.0; model.velocities];
        for b in &mobile {
            let body = &model.bodies[*b];
            set_mobility(body, 1.0, &mut mobility);
        }
        let touches = |e: &usize| bodies_of(model, *e).iter().any(|b| mobile.contains(b));
        let near: Vec<usize> = exact.iter().copied().filter(touches).collect();
        let near_conditioned: Vec<usize> = conditioned.iter().copied().filter(touches).collect();
        let rows = Rows::new(model, near.clone());
        // choices: the bodies of one element have few ways to close, those around it more
        for _ in 0..if radius == 0 { 10 } else { 40 } {
            let mut trial = state.clone();
            for b in &mobile {
                turn_body(model, model.bodies[*b].pose, numbers, &mut trial, 1.0);
            }
            let size = close(model, &rows, &mobility, &mut trial, 60)?;
            if is_closed(size) && violated_branches(model, &near_conditioned, &trial)?.is_empty() {
                *state = trial;
                return Ok(true);
            }
        }
    }
    Ok(false)
}
