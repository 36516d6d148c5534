//! Springs under the weights of bodies: how far they yield, and which way they push before any motion.

use super::{
    ROUNDING, answers, answers_of, free_motions, loads, springs, tangents_of, unit_gradients,
};
use crate::assembly::at;
use crate::assembly::rows::inputs;
use crate::elements::{self, Scratch};
use crate::error::RuntimeError;
use crate::model::Model;
use crate::rotation::{M3, V3};
use crate::state::State;
use eng_system::code::Function;
use nalgebra::{DMatrix, DVector};

/// Least eigenvalue (1/s) of states that relax: slower ones hold a load for minutes. A choice: a mount that
/// takes longer stands for the weight like a spring.
const RELAXES: f64 = 0.01;
/// Most steps of the search for eigenvalues of a few states. A choice: usually each eigenvalue takes a few.
const SCHUR_STEPS: usize = 1000;
/// Largest rotation of a sinking body, as its displacement at the model's length over the sinking distance. A
/// choice: with more of it, the body swings on other supports.
const UPRIGHT: f64 = 0.2;
/// Least share of the weight of a body that its springs carry, for a statement about their forces. A choice: joints
/// and films carry the rest, and a spring across gravity carries rounding.
const CARRIED: f64 = 0.1;
/// Forces of springs along gravity, as shares of the weight that they carry, that are a mistake of a sign. A preload
/// against the weight has −1, no preload 0, and a preload with the wrong sign 1. Springs that press a light part
/// onto a stop have far more. The limits are a choice: the preload may be made for a part of the weight, or for
/// parts that films carry.
const WRONG_SIGN: std::ops::Range<f64> = 0.4..3.0;

/// Share of the weight up to which preloads balance it. A choice: mounts are chosen for a level machine, and masses are
/// known to some per cent.
const BALANCES: f64 = 0.15;

/// Small motions of all bodies under their weights.
struct Sinking {
    /// The state, at rest.
    rest: State,
    /// Direction of gravity (inertial, unit length).
    down: V3,
    /// Small moves of all velocities (m, rad).
    moves: DVector<f64>,
    /// Whether an element whose states are its stiffness holds each body.
    held: Vec<bool>,
}

impl Sinking {
    /// The moves `u = N V (Vᵀ Nᵀ K N V)⁻¹ Vᵀ Nᵀ f` of [`sag`]; `None` without gravity or springs, and for flexible
    /// bodies.
    fn of(model: &Model, state: &State, gravity: V3) -> Result<Option<Sinking>, RuntimeError> {
        let size = gravity.norm();
        let none =
            size == 0.0 || !size.is_finite() || !(0..model.elements.len()).any(|e| loads(model, e));
        if none || model.bodies.iter().any(|body| body.modes() > 0) {
            return Ok(None);
        }
        let mut rest = state.clone();
        rest.velocity.fill(0.0);
        let scales = model.velocity_scales();
        let all: Vec<usize> = (0..model.velocities).collect();
        let basis = free_motions(&unit_gradients(model, &rest, &all)?);
        let [stiffness, _] = answers(model, &rest)?;
        // the loads of a displacement x are −K x
        let reduced = basis.tr_mul(&stiffness.scaled(model, &scales).times(&basis));
        let reduced = (&reduced + reduced.transpose()) * -0.5;
        if reduced.ncols() == 0 || reduced.iter().any(|x| !x.is_finite()) {
            return Ok(None);
        }
        let mut weights = DVector::zeros(model.velocities);
        for body in &model.bodies {
            let frame = body.frame(&rest.pose);
            let force = gravity * body.mass();
            let moment = body.center().cross(&(frame.rotation.transpose() * force));
            for i in 0..3 {
                weights[body.velocity + i] = force[i] * scales[body.velocity + i];
                weights[body.velocity + 3 + i] = moment[i] * scales[body.velocity + 3 + i];
            }
        }
        let eigen = reduced.symmetric_eigen();
        let largest = eigen.eigenvalues.amax();
        let load = basis.transpose() * weights;
        let mut way = DVector::zeros(eigen.eigenvalues.len());
        for (value, vector) in eigen
            .eigenvalues
            .iter()
            .zip(eigen.eigenvectors.column_iter())
        {
            if *value > ROUNDING * largest {
                way += vector * (vector.dot(&load) / value);
            }
        }
        let moved = &basis * way;
        let moves = DVector::from_fn(moved.len(), |i, _| moved[i] * scales[i]);
        Ok(Some(Sinking {
            held: held_by_states(model, state, &rest)?,
            rest,
            down: gravity / size,
            moves,
        }))
    }

    /// The markers of an element that may carry weight: it has two, loads them, and is on no body that states hold.
    fn carries(&self, model: &Model, element: usize) -> Option<[usize; 2]> {
        let &[a, b] = model.elements[element].markers.as_slice() else {
            return None;
        };
        let held = |m: usize| {
            let body = model.markers[m].body;
            body.is_some_and(|body| self.held[body])
        };
        (loads(model, element) && !held(a) && !held(b)).then_some([a, b])
    }

    /// Displacement of a marker (m) and rotation of its body, as a displacement at the model's length (m).
    fn displaced(&self, model: &Model, marker: usize) -> (V3, f64) {
        let marker = &model.markers[marker];
        let Some(body) = marker.body.map(|b| &model.bodies[b]) else {
            return (V3::zeros(), 0.0);
        };
        let part = |first: usize| {
            let at = body.velocity + first;
            V3::from_fn(|i, _| self.moves[at + i])
        };
        let (shift, turn) = (part(0), part(3));
        let rotation = body.frame(&self.rest.pose).rotation;
        let shift = shift + rotation * turn.cross(&marker.position);
        (shift, turn.norm() * model.length)
    }

    /// Change of an element's force along gravity in the moves, over its greatest stiffness (m).
    fn gives_way(&self, model: &Model, element: usize) -> Result<f64, RuntimeError> {
        let [stiffness, _] = answers_of(model, &self.rest, element..element + 1)?;
        let change = stiffness.times(&self.column());
        let of_body = |marker: &usize| {
            let body = model.markers[*marker].body?;
            let force = V3::from_column_slice(&change.as_slice()[6 * body..6 * body + 3]);
            let own = stiffness.0.get(&(body, body))?;
            let own = M3::from_fn(|i, j| own[6 * i + j]);
            let greatest = own.singular_values().max();
            (greatest > 0.0).then(|| force.dot(&self.down).abs() / greatest)
        };
        let ways = model.elements[element].markers.iter().filter_map(of_body);
        Ok(ways.fold(0.0, f64::max))
    }

    /// The moves as a matrix of one column.
    fn column(&self) -> DMatrix<f64> {
        DMatrix::from_column_slice(self.moves.len(), 1, self.moves.as_slice())
    }

    /// Forces of an element along gravity on the bodies of its markers: before the moves, and their change in the
    /// moves (N).
    fn forces(
        &self,
        model: &Model,
        element: usize,
    ) -> Result<Vec<(usize, [f64; 2])>, RuntimeError> {
        let own = &model.elements[element];
        let layout = &model.class(element).layout;
        let mut out = vec![[0.0; 2]; layout.residual_len() as usize];
        let inputs = inputs(model, element, &at(&self.rest));
        elements::call(model, own.class, Function::Residual, &inputs, &mut out)?;
        let [stiffness, _] = answers_of(model, &self.rest, element..element + 1)?;
        let change = stiffness.times(&self.column());
        let mut found: Vec<(usize, [f64; 2])> = Vec::new();
        for (place, marker) in own.markers.iter().enumerate() {
            let Some(body) = model.markers[*marker].body else {
                continue;
            };
            let first = layout.rows as usize + 6 * place;
            let before = V3::from_fn(|i, _| out[first + i][0]).dot(&self.down);
            match found.iter_mut().find(|(known, _)| *known == body) {
                Some((_, [known, _])) => *known += before,
                None => {
                    let change = V3::from_column_slice(&change.as_slice()[6 * body..6 * body + 3]);
                    found.push((body, [before, change.dot(&self.down)]));
                }
            }
        }
        Ok(found)
    }
}

/// The bodies that elements hold whose states are their stiffness: they have no other stiffness, or their states do
/// not relax at rest. Gas holds its piston and not the engine around it, whose weight is on its mounts.
fn held_by_states(model: &Model, state: &State, rest: &State) -> Result<Vec<bool>, RuntimeError> {
    let firings = &model.compiled.system.firings;
    let mut held = vec![false; model.bodies.len()];
    for (index, element) in model.elements.iter().enumerate() {
        let stateful = element.dynamic && model.class(index).layout.states > 0;
        if !stateful || springs(model, state, index)? && relaxes(model, rest, index)? {
            continue;
        }
        let gas = firings.iter().find(|f| f.element as usize == index);
        for (place, marker) in element.markers.iter().enumerate() {
            let holds = gas.is_none_or(|gas| gas.piston as usize == place);
            if let Some(body) = model.markers[*marker].body.filter(|_| holds) {
                held[body] = true;
            }
        }
    }
    Ok(held)
}

/// The spring that yields most under gravity (m/s², inertial), and its deflection (m). This is an estimate
/// from the stiffness `K` at a position, at rest. Let `N` be the free motions, `f` the weights and `V` the
/// directions in which `Nᵀ (K + Kᵀ) N/2` is positive. The bodies move by `u = N V (Vᵀ Nᵀ K N V)⁻¹ Vᵀ Nᵀ f`.
/// The deflection is `Δ/k`: the change `Δ` of the spring's own force along gravity in this move, over the
/// spring's greatest stiffness `k`. The displacement of its ends would include sideways swing, because across
/// its axis a stretched spring has only the stiffness of a pendulum, `F/L` with its force `F` and length `L`.
/// For a spring that is softer along gravity than across, the estimate is too small.
///
/// `None` if no spring yields, if the bodies turn as they sink (a weak spring on a pendulum), and for bodies
/// on an element whose states are its stiffness: it has no other stiffness, or its states do not relax at
/// rest.
///
/// # Errors
///
/// Those of evaluating the elements.
pub fn sag(
    model: &Model,
    state: &State,
    gravity: V3,
) -> Result<Option<(usize, f64)>, RuntimeError> {
    let Some(sinking) = Sinking::of(model, state, gravity)? else {
        return Ok(None);
    };
    let mut found: Option<(usize, f64)> = None;
    for element in 0..model.elements.len() {
        let Some(markers) = sinking.carries(model, element) else {
            continue;
        };
        let [(of_a, turn_a), (of_b, turn_b)] = markers.map(|m| sinking.displaced(model, m));
        let ends = (of_a - of_b).dot(&sinking.down).abs();
        if turn_a.max(turn_b) >= UPRIGHT * ends {
            continue;
        }
        let way = sinking.gives_way(model, element)?;
        if found.is_none_or(|(_, most)| way > most) && springs(model, state, element)? {
            found = Some((element, way));
        }
    }
    Ok(found)
}

/// Springs that push a body along gravity before it moves, although they carry its weight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pushed {
    /// Index of the body.
    pub body: usize,
    /// Index of the spring that pushes most.
    pub spring: usize,
    /// Force along gravity of this spring and those of its declaration, or of all springs of the body, before any
    /// motion (N).
    pub force: f64,
    /// The weight that all springs of the body carry together (N).
    pub carried: f64,
    /// Whether it is the force of all springs.
    pub all: bool,
}

/// A spring of a body: the index of the element, its force along gravity before any motion, and the weight that it
/// carries (N).
type Spring = (usize, f64, f64);

/// The first body whose springs push it along gravity (m/s², inertial) with a force of the size of the weight that
/// they carry, or would carry it if those of one declaration pushed in the other direction: a preload, or gravity, has the
/// wrong sign. The weight that a spring carries is the change of its force in the small moves of [`sag`].
///
/// # Errors
///
/// Those of evaluating the elements.
pub fn pushed_down(
    model: &Model,
    state: &State,
    gravity: V3,
) -> Result<Option<Pushed>, RuntimeError> {
    let Some(sinking) = Sinking::of(model, state, gravity)? else {
        return Ok(None);
    };
    let mut springs_of: Vec<Vec<Spring>> = vec![Vec::new(); model.bodies.len()];
    for element in 0..model.elements.len() {
        // the answers of a field are not known here
        if sinking.carries(model, element).is_none()
            || model.class(element).layout.answers > 0
            || !springs(model, state, element)?
        {
            continue;
        }
        for (body, [force, change]) in sinking.forces(model, element)? {
            springs_of[body].push((element, force, -change));
        }
    }
    let found = springs_of.iter().enumerate().find_map(|(body, springs)| {
        let weight = model.bodies[body].mass() * gravity.norm();
        wrong_sign(model, body, springs, weight)
    });
    Ok(found)
}

/// The springs of a body of some weight (N) whose force has the wrong sign.
fn wrong_sign(model: &Model, body: usize, springs: &[Spring], weight: f64) -> Option<Pushed> {
    let sum = |of: &dyn Fn(&Spring) -> f64| springs.iter().map(of).sum::<f64>();
    let (force, carried) = (
        sum(&|spring: &Spring| spring.1),
        sum(&|spring: &Spring| spring.2),
    );
    if carried <= CARRIED * weight {
        return None;
    }
    let most = springs.iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
    if WRONG_SIGN.contains(&(force / carried)) {
        return Some(Pushed {
            body,
            spring: most.0,
            force,
            carried,
            all: true,
        });
    }
    let declared = |spring: &Spring| {
        let elements = &model.compiled.system.elements;
        elements[spring.0].origin.used_at
    };
    let alone = springs.iter().find_map(|spring| {
        let own = springs.iter().filter(|s| declared(s) == declared(spring));
        let own: f64 = own.map(|s| s.1).sum();
        let turned = force - 2.0 * own;
        (own > CARRIED * carried && (carried + turned).abs() < BALANCES * carried)
            .then_some((spring.0, own))
    });
    alone.map(|(spring, force)| Pushed {
        body,
        spring,
        force,
        carried,
        all: false,
    })
}

/// Whether the states of an element relax to values of their own while nothing moves, so that its stiffness after
/// a long time is that with its present states: no eigenvalue of the derivative of their rates by the states is near zero.
fn relaxes(model: &Model, rest: &State, index: usize) -> Result<bool, RuntimeError> {
    let layout = &model.class(index).layout;
    let states = layout.states as usize;
    let (first, length) = (
        layout.state_direction(0) as usize,
        layout.residual_len() as usize,
    );
    let rates = (layout.rows + 6 * layout.markers) as usize;
    let mut scratch = Scratch::new(model);
    let tangents = tangents_of(model, index, rest, first..first + states, &mut scratch)?;
    let slopes = DMatrix::from_fn(states, states, |i, j| {
        tangents[(first + j) * length + rates + i][0]
    });
    if slopes.iter().any(|x| !x.is_finite()) {
        return Ok(false);
    }
    let schur = nalgebra::Schur::try_new(slopes, f64::EPSILON, SCHUR_STEPS);
    Ok(schur.is_some_and(|schur| {
        let rates = schur.complex_eigenvalues();
        rates
            .iter()
            .all(|rate| libm::hypot(rate.re, rate.im) > RELAXES)
    }))
}
