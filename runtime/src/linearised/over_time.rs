//! A test for coefficients that depend on time alone: a spring whose stiffness is a function of time, a
//! pendulum with a shaken pivot, a varying load beside the axis of a body.
//!
//! The compiler states for every class whether its loads, rates and constraints depend on time. If none does,
//! there is nothing to test, exactly. Otherwise the equations are formed again at later times in the same
//! position: turning bodies have made whole turns, and drives have moved their bodies. A drive is steady if its
//! constraints then hold with the same velocities and accelerations. A load that only excites does not change
//! the coefficients, and passes.
//!
//! **Times.** They extend from a microsecond to a day, each 1.618 times the one before. So every period contains
//! five or more of them, and no period can hide a change. A later step is found, too; a pulse between two times
//! is not. With turning bodies the times are whole turns, and their numbers are Fibonacci's.

use super::constancy::{Here, SLIGHT, fastest, gone_on, sliding, turning};
use super::equations::Equations;
use crate::acceleration::AccelerationSystem;
use crate::assembly::rows::{At, inputs};
use crate::dynamics::Dynamics;
use crate::elements::call;
use crate::error::{Moment, RuntimeError, Timed, TimedElement};
use crate::model::Model;
use crate::state::State;
use eng_system::code::Function;
use std::f64::consts::TAU;

/// First and last time after the state (s). Choices: loads over time of a machine have periods from some
/// microseconds to hours; the last time is a day.
const TIMES: [f64; 2] = [1e-6, 1e5];
/// Ratio of a time to the one before: the golden ratio, so that numbers of turns follow Fibonacci's.
const GOLDEN: f64 = 1.618_033_988_749_895;
/// Limit of turns, and of sliding in lengths of the model. Up to it rounding stays below [`STEADY`].
const FARTHEST: f64 = 2e3;
/// Largest difference of position, velocity and acceleration after a steady drive, as a share of the model's
/// size and speed. A choice: positions after 1597 turns are rounded to 1e-12.
const STEADY: f64 = 1e-8;
/// Residual (SI) above which a row does not hold. A choice: assembled rows are closed to 1e-10 in scaled
/// units, and drives of another motion leave far more.
const OPEN: f64 = 1e-7;

/// The elements that change coefficients with time alone.
pub(super) struct OverTime {
    pub elements: Vec<TimedElement>,
    /// Time after the state (s).
    pub later: f64,
    /// Change of the eigenvalues at that time as a share of their size; infinite if it is not known.
    pub change: f64,
}

/// The times after the state at which the coefficients are compared (s).
fn times(model: &Model, state: &State) -> Vec<f64> {
    let fastest = fastest(model, state);
    if fastest > 0.0 {
        let numbers = std::iter::successors(Some([1.0, 2.0]), |[a, b]| Some([*b, a + b]));
        return numbers
            .map(|[turns, _]| turns)
            .take_while(|turns| *turns <= FARTHEST)
            .map(|turns| turns * TAU / fastest)
            .collect();
    }
    let slides = sliding(model, state)
        .into_iter()
        .fold(0.0_f64, |most, (_, speed)| most.max(speed));
    let last = if slides > 0.0 {
        TIMES[1].min(FARTHEST * model.length / slides)
    } else {
        TIMES[1]
    };
    std::iter::successors(Some(TIMES[0]), |time| Some(time * GOLDEN))
        .take_while(|time| *time <= last)
        .collect()
}

/// Whether the state `now` equals the state `before` after the steady motion that leads to `gone`.
fn steady(model: &Model, before: &State, gone: &State, now: &State) -> bool {
    let motion_rate = fastest(model, before).max(1.0);
    let near =
        |a: &[f64], b: &[f64], allowed: f64| a.iter().zip(b).all(|(a, b)| (a - b).abs() <= allowed);
    let scaled = |a: &[f64], b: &[f64], motion_rate: f64| {
        let scales = model.velocity_scales();
        a.iter()
            .zip(b)
            .zip(&scales)
            .all(|((a, b), scale)| (a - b).abs() <= STEADY * scale * motion_rate)
    };
    near(&gone.pose, &now.pose, STEADY * model.length.min(1.0))
        && scaled(&gone.velocity, &now.velocity, motion_rate)
        && scaled(
            &before.acceleration,
            &now.acceleration,
            motion_rate * motion_rate,
        )
}

/// The change of the eigenvalues with time alone, as a share of their size, if it is at most [`SLIGHT`].
/// Otherwise the error lists the elements that change them.
pub(super) fn over_time(
    model: &Model,
    state: &State,
    here: &Here<'_>,
    moment: Moment,
) -> Result<f64, OverTime> {
    let dynamic = |e: &usize| model.elements[*e].dynamic;
    let all = || (0..model.elements.len()).filter(dynamic);
    let loads: Vec<usize> = all()
        .filter(|e| model.class(*e).facts.loads_over_time)
        .collect();
    let drives: Vec<usize> = all()
        .filter(|e| model.class(*e).facts.rows_over_time)
        .collect();
    if loads.is_empty() && drives.is_empty() {
        return Ok(0.0);
    }
    let turns = turning(model, state);
    let mut bodies = turns.clone();
    bodies.extend(sliding(model, state).into_iter().map(|(b, _)| b));
    let mut most = 0.0_f64;
    for later in times(model, state) {
        let gone = gone_on(model, state, &bodies, later);
        let changed = || -> Result<f64, RuntimeError> {
            let mut moved = gone.clone();
            let mut dynamics = Dynamics::new(model);
            let mut system = AccelerationSystem::new(model)?;
            if !drives.is_empty() {
                system.restore(model, &mut dynamics, &mut moved, moment)?;
            }
            system.accelerations(model, &mut dynamics, &mut moved, moment)?;
            if loads.is_empty() && steady(model, state, &gone, &moved) {
                return Ok(0.0);
            }
            let there = Equations::of_both_sides(model, &moved, moment)?;
            Ok(if turns.is_empty() {
                here.change_in_place(model, &there)
            } else {
                here.change(model, &there)
            })
        };
        // without equations at that position nothing shows that they are constant
        let change = changed().unwrap_or(f64::INFINITY);
        if change > SLIGHT {
            return Err(OverTime {
                elements: named(model, state, &gone, [&loads, &drives]),
                later,
                change,
            });
        }
        most = most.max(change);
    }
    Ok(most)
}

/// An element's rows, loads and rates, or their derivatives, in the position of a state at another time (s),
/// without loads on the ground and derivatives along it; `None` if the class refuses them.
fn numbers(model: &Model, element: usize, state: &State, time: f64, of: Timed) -> Option<Vec<f64>> {
    let class = model.class(element);
    let index = model.elements[element].class;
    let at = At {
        time,
        pose: &state.pose,
        velocity: &state.velocity,
        states: &state.states,
        rotations: &state.rotations,
    };
    let given = inputs(model, element, &at);
    let length = class.layout.residual_len() as usize;
    let mut out = vec![[0.0; 2]; length];
    if of == Timed::Load {
        call(model, index, Function::Residual, &given, &mut out).ok()?;
        return Some(out.into_iter().map(|pair| pair[0]).collect());
    }
    let (rows, markers) = (class.layout.rows as usize, class.layout.markers as usize);
    let on_ground = |marker: usize| {
        let index = model.elements[element].markers.get(marker);
        index.is_some_and(|index| model.markers[*index].body.is_none())
    };
    let loads_ground = |i: usize| i >= rows && i < rows + 6 * markers && on_ground((i - rows) / 6);
    let of_ground = |d: usize| d < 12 * markers && on_ground(d / 6 % markers);
    let (tape, count) = (class.tape as usize, class.layout.directions() as usize);
    let mut seed = vec![[0.0; 2]; tape + count];
    call(model, index, Function::Linearize, &given, &mut seed[..tape]).ok()?;
    let mut all = Vec::with_capacity(count * length);
    for direction in (0..count).filter(|d| !of_ground(*d)) {
        seed[tape + direction] = [1.0; 2];
        call(model, index, Function::Tangent, &seed, &mut out).ok()?;
        seed[tape + direction] = [0.0; 2];
        let entries = out.iter().enumerate();
        all.extend(
            entries
                .filter(|(i, _)| !loads_ground(*i))
                .map(|(_, pair)| pair[0]),
        );
    }
    Some(all)
}

/// The elements that change with time, each with its change. Of drives these are the ones whose rows do not hold
/// in the position of the steady motion.
fn named(
    model: &Model,
    state: &State,
    gone: &State,
    [loads, drives]: [&[usize]; 2],
) -> Vec<TimedElement> {
    let differs = |element: usize, of: Timed| {
        let numbers = |time: f64| numbers(model, element, state, time, of);
        let (Some(now), Some(then)) = (numbers(state.time), numbers(gone.time)) else {
            return false;
        };
        // numbers that do not depend on time have the same bits
        now != then
    };
    let open = |element: usize| {
        let rows = model.class(element).rows.len();
        numbers(model, element, gone, gone.time, Timed::Load)
            .is_none_or(|found| found[..rows].iter().any(|x| x.abs() > OPEN))
    };
    let named = |element: usize, timed: Timed| TimedElement {
        origin: model.compiled.system.elements[element].origin.clone(),
        timed,
    };
    let mut found: Vec<TimedElement> = Vec::new();
    for of in [Timed::Coefficients, Timed::Load] {
        let change = loads.iter().filter(|e| differs(**e, of));
        found.extend(change.map(|e| named(*e, of)));
        if !found.is_empty() {
            break;
        }
    }
    found.extend(
        drives
            .iter()
            .filter(|e| open(**e))
            .map(|e| named(*e, Timed::Motion)),
    );
    if found.is_empty() {
        let kind = |of: Timed| move |e: &usize| named(*e, of);
        found.extend(loads.iter().map(kind(Timed::Load)));
        found.extend(drives.iter().map(kind(Timed::Motion)));
    }
    found
}
