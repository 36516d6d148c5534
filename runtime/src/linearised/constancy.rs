//! Whether the coefficients remain constant while bodies turn.
//!
//! The test turns every body on by two finite angles, with the velocity in its own axes kept, and advances
//! time with them. Shapes and states do not change. There it forms the equations again, with the
//! accelerations of that position. Coefficients are constant if these have not changed in ground axes: the
//! mass M, the allowed moves `Π = N NᵀM`, `ΠᵀKΠ`, `ΠᵀCΠ` and the blocks of the states. They do not depend on
//! the choice of N. If all of them are constant, N can be constant too, and the equations in x hold at every
//! moment.
//!
//! If this test fails, `variation` computes the effect of the change on the modes. Coefficients whose change
//! moves no eigenvalue by more than a thousandth ([`SLIGHT`]) are held, and the result reports it. Example: a
//! round rotor tilted by its bearings. A drive about an axis fixed in space allows it other small rotations
//! at every angle; they differ by the tilt.
//!
//! `leaving` makes the same test for motions that do not turn: a slider in motion, a body far from the
//! position where forces balance.
//! `over_time` tests coefficients that depend on time alone.
//!
//! A wheel of revolution on its axis passes the test, in films too. Three kinds of bodies fail: those of
//! unequal inertia, those with a load or joint beside their axis, and those that bend in a film or on a joint
//! of another body. Their bending is in axes that turn with the body.

use super::equations::Equations;
use super::variation::Modal;
use crate::acceleration::AccelerationSystem;
use crate::dynamics::Dynamics;
use crate::error::{Leaving, LeavingBody, Moment, RuntimeError, TurningBody, Varies};
use crate::model::{Model, TOLERANCE_OF_LENGTH};
use crate::rotation::{V3, exponential, matrix};
use crate::state::{State, move_pose};
use nalgebra::{DMatrix, DVector};
use std::cell::OnceCell;
use std::ops::Range;

/// Angular velocity (rad/s) below which a body does not turn: a tenth of a turn in a minute. A slower body
/// settles, or its motion is rounding. The same number is the limit of speeds and accelerations over the
/// model's length (1/s, 1/s²). A choice: a smaller limit would call the last motion of a settling body a
/// rotation, a larger one would overlook slow shafts.
const AT_REST: f64 = 1e-2;
/// Angles (rad) of the fastest body. Both are below a quarter turn, because the angle between two bodies that
/// turn against each other is followed only up to half a turn. They are no simple parts of a turn, at which a
/// body of several equal sides would look alike.
const ANGLES: [f64; 2] = [0.7, 1.5];
/// Largest change of a constant coefficient, as a share of the largest of its kind between the same two
/// bodies. A choice: some digits above the errors of positions, to which coefficients are derivatives.
const SAME: f64 = 1e-6;
/// Largest change by rounding, as a share of the largest coefficient of all. A choice some decades above the
/// rounding unit, because coefficients are sums over links.
const ROUNDING: f64 = 1e-11;
/// Change of the eigenvalues, as a share of their size, up to which changing coefficients are held. A choice:
/// eigenvalues are printed with as many digits.
pub(super) const SLIGHT: f64 = 1e-3;
/// Changes of entries, as shares of the largest entry between the same two bodies and of the largest of all,
/// that are not slight in any mode. Choices: with changes as large, the effect on the modes need not be
/// computed.
const GROSS: [f64; 2] = [0.1, 1e-3];
/// A tenth of a clearance, in position tolerances.
const OF_CLEARANCE: f64 = 100.0;
/// See [`reach`]. A hundredth of the model's length is a choice.
const FOLLOWED: f64 = 1e-2;
/// Share of the largest stiffness below which nothing holds a direction. A choice above the rounding of a
/// stiffness.
const HELD: f64 = 1e-10;
/// Distance of an axis from the body's origin, as a share of the model's length, below which it passes
/// through the origin. A choice: stated positions differ by less.
const ON_AXIS: f64 = 1e-4;

/// Coefficients in ground axes, free of the choice of N; lengths and angles scaled by the model's.
struct Coefficients {
    mass: DMatrix<f64>,
    moves: DMatrix<f64>,
    stiffness: DMatrix<f64>,
    damping: DMatrix<f64>,
    /// S (as loads) and R, T and U (per move).
    of_states: [DMatrix<f64>; 4],
}

impl Coefficients {
    fn new(model: &Model, equations: &Equations) -> Coefficients {
        let e = equations;
        let scales = model.velocity_scales();
        let by_rows = |mut matrix: DMatrix<f64>, inverse: bool| {
            for (i, s) in scales.iter().enumerate() {
                let factor = if inverse { 1.0 / s } else { *s };
                matrix.row_mut(i).scale_mut(factor);
            }
            matrix
        };
        let by_columns = |matrix: DMatrix<f64>| by_rows(matrix.transpose(), false).transpose();
        // MN: the loads with the same work as a vector in x
        let loads = &e.mass * &e.basis;
        let both =
            |matrix: &DMatrix<f64>| by_columns(by_rows(&loads * matrix * loads.transpose(), false));
        Coefficients {
            mass: by_columns(by_rows(e.mass.clone(), false)),
            moves: by_columns(by_rows(&e.basis * loads.transpose(), true)),
            stiffness: both(&e.stiffness),
            damping: both(&e.damping),
            of_states: [
                by_rows(&loads * &e.by_states, false),
                by_columns(&e.rates_by_place * loads.transpose()),
                by_columns(&e.rates_by_velocity * loads.transpose()),
                e.rates_by_states.clone(),
            ],
        }
    }

    /// Whether no entry differs by more than a `share` of the largest entry of its kind between the same two
    /// bodies, with a lower limit: a `floor` of all entries. For this limit mass, damping and stiffness are
    /// compared at a rate (rad/s). `groups` are ranges of the velocities that have one unit and one body.
    fn same(
        &self,
        other: &Coefficients,
        groups: &[Range<usize>],
        rate_scale: f64,
        [share, floor]: [f64; 2],
    ) -> bool {
        let largest = |a: &DMatrix<f64>, b: &DMatrix<f64>| a.amax().max(b.amax());
        let mass = largest(&self.mass, &other.mass);
        let damping = largest(&self.damping, &other.damping);
        let stiffness = largest(&self.stiffness, &other.stiffness);
        let of_all = mass * rate_scale + damping + stiffness / rate_scale;
        same_blocks(&self.mass, &other.mass, groups, share, floor * mass)
            && same_blocks(&self.moves, &other.moves, groups, share, floor)
            && same_blocks(&self.damping, &other.damping, groups, share, floor * of_all)
            && same_blocks(
                &self.stiffness,
                &other.stiffness,
                groups,
                share,
                floor * of_all * rate_scale,
            )
            && self
                .of_states
                .iter()
                .zip(&other.of_states)
                .all(|(a, b)| (a - b).amax() <= share * largest(a, b))
    }
}

/// The coefficients at the state, for comparison with others.
pub(super) struct Here<'a> {
    equations: &'a Equations,
    coefficients: Coefficients,
    groups: Vec<Range<usize>>,
    modal: OnceCell<Option<Modal<'a>>>,
    /// rad/s: measures mass, damping and stiffness by each other.
    rate_scale: f64,
}

impl<'a> Here<'a> {
    pub fn new(model: &Model, state: &State, equations: &'a Equations) -> Here<'a> {
        Here {
            equations,
            coefficients: Coefficients::new(model, equations),
            groups: groups(model),
            modal: OnceCell::new(),
            rate_scale: fastest(model, state).max(1.0),
        }
    }

    fn same(&self, there: &Coefficients, shares: [f64; 2]) -> bool {
        self.coefficients
            .same(there, &self.groups, self.rate_scale, shares)
    }

    fn modal(&self) -> Option<&Modal<'a>> {
        self.modal
            .get_or_init(|| Modal::new(self.equations))
            .as_ref()
    }

    /// Change of the eigenvalues by the coefficients after the bodies have turned, as a share of their size.
    /// It is zero for equal coefficients, and infinite if they differ grossly or if the change is not known.
    pub fn change(&self, model: &Model, there: &Equations) -> f64 {
        let coefficients = Coefficients::new(model, there);
        if self.same(&coefficients, [SAME, ROUNDING]) {
            return 0.0;
        }
        if !self.same(&coefficients, GROSS) {
            return f64::INFINITY;
        }
        self.modal()
            .map_or(f64::INFINITY, |modal| modal.change(there))
    }

    /// The same for coefficients in the same position. No body has turned, so no rounding of a rotation enters,
    /// and a change in a soft direction beside a stiff one counts too.
    pub fn change_in_place(&self, model: &Model, there: &Equations) -> f64 {
        match self.modal() {
            Some(modal) => modal.change(there),
            None => self.change(model, there),
        }
    }
}

fn same_blocks(
    a: &DMatrix<f64>,
    b: &DMatrix<f64>,
    groups: &[Range<usize>],
    share: f64,
    floor: f64,
) -> bool {
    groups.iter().all(|rows| {
        groups.iter().all(|columns| {
            let view = |m: &DMatrix<f64>| {
                m.view((rows.start, columns.start), (rows.len(), columns.len()))
                    .into_owned()
            };
            let (a, b) = (view(a), view(b));
            (&a - &b).amax() <= share * a.amax().max(b.amax()) + floor
        })
    })
}

/// Places, rotations and single shapes of every body among the velocities.
fn groups(model: &Model) -> Vec<Range<usize>> {
    let mut groups = Vec::new();
    for body in &model.bodies {
        let v = body.velocity;
        groups.extend([v..v + 3, v + 3..v + 6]);
        groups.extend((v + 6..v + body.width()).map(|i| i..i + 1));
    }
    groups
}

/// ω of a body (rad/s, body axes).
fn spin(state: &State, first: usize) -> V3 {
    V3::new(
        state.velocity[first + 3],
        state.velocity[first + 4],
        state.velocity[first + 5],
    )
}

/// Bodies that turn.
pub(super) fn turning(model: &Model, state: &State) -> Vec<usize> {
    let turns = |index: &usize| spin(state, model.bodies[*index].velocity).norm() > AT_REST;
    (0..model.bodies.len()).filter(turns).collect()
}

/// The largest change of a body's spin from one state to another (rad/s).
pub(super) fn change_of_spin(model: &Model, from: &State, to: &State) -> f64 {
    let change = |v: usize| (spin(to, v) - spin(from, v)).norm();
    model
        .bodies
        .iter()
        .fold(0.0_f64, |most, body| most.max(change(body.velocity)))
}

/// Bodies that do not turn and move, with their speeds (m/s).
pub(super) fn sliding(model: &Model, state: &State) -> Vec<(usize, f64)> {
    let speed = |first: usize| V3::from_column_slice(&state.velocity[first..first + 3]).norm();
    (0..model.bodies.len())
        .filter(|b| spin(state, model.bodies[*b].velocity).norm() <= AT_REST)
        .map(|b| (b, speed(model.bodies[b].velocity)))
        .filter(|(_, speed)| *speed > AT_REST * model.length)
        .collect()
}

/// Share of the model's length, or angle (rad), over which a motion that does not turn is followed. With
/// films it is a tenth of a clearance.
fn reach(model: &Model) -> f64 {
    let share = model.tolerance / model.length;
    // smaller than without journals, but not by rounding
    if share < 0.99 * TOLERANCE_OF_LENGTH {
        OF_CLEARANCE * share
    } else {
        FOLLOWED
    }
}

/// A motion without turning along which the coefficients change. It comes from velocities of bodies that do
/// not turn, or from accelerations, except those of steady turning.
///
/// With velocities, all bodies move on until the fastest has moved by the [`reach`]. With accelerations, the
/// bodies move towards the position where forces balance, `K δ = NᵀM v̇`, which is infinitely far if nothing
/// holds them. A position nearer than the reach counts as rest. Free fall, steady travel and linear systems
/// pass, because nothing changes along their motion.
pub(super) fn leaving(
    model: &Model,
    state: &State,
    here: &Here<'_>,
    moment: Moment,
) -> Option<LeavingBody> {
    let reach = reach(model);
    let same = |there: Result<Equations, RuntimeError>| {
        // without equations at that position nothing shows that they are constant
        there.is_ok_and(|there| here.same(&Coefficients::new(model, &there), [SAME, ROUNDING]))
    };
    let sliding = sliding(model, state);
    if let Some((body, speed)) = sliding
        .iter()
        .copied()
        .reduce(|a, b| if b.1 > a.1 { b } else { a })
    {
        let mut bodies = turning(model, state);
        bodies.extend(sliding.iter().map(|(b, _)| *b));
        let time = reach * model.length / speed;
        if ![1.0, 2.0]
            .into_iter()
            .all(|n| same(turned_on(model, state, &bodies, n * time, moment)))
        {
            return Some(LeavingBody {
                origin: model.bodies[body].origin.clone(),
                leaving: Leaving::Moves(speed),
            });
        }
    }
    let (moves, acceleration) = towards_balance(model, state, here.equations)?;
    let scales = model.velocity_scales();
    let (first, size) = farthest(&moves, &scales);
    if size < reach {
        return None;
    }
    let along = here.equations.in_body_axes(moves * (reach / size));
    if same(moved_by(model, state, along.as_slice(), moment)) {
        return None;
    }
    let body = model
        .bodies
        .iter()
        .rfind(|body| body.velocity <= first)
        .or(model.bodies.first())?;
    Some(LeavingBody {
        origin: body.origin.clone(),
        leaving: Leaving::Unbalanced(acceleration),
    })
}

/// Index and size of the largest number relative to its scale.
fn farthest(x: &DVector<f64>, scales: &[f64]) -> (usize, f64) {
    let sizes = x.iter().zip(scales).map(|(x, s)| (x / s).abs());
    sizes.enumerate().fold(
        (0, 0.0),
        |most, now| if now.1 > most.1 { now } else { most },
    )
}

/// Moves (ground axes) to the position where forces balance, from the equations of the state, and the largest
/// acceleration of a body (m/s²). `None` at rest. In a direction that nothing holds the move is one length of
/// the model.
fn towards_balance(
    model: &Model,
    state: &State,
    equations: &Equations,
) -> Option<(DVector<f64>, f64)> {
    let ground = |x: &[f64]| equations.in_ground_axes(DVector::from_column_slice(x));
    let velocity = ground(&state.velocity);
    let mut acceleration = ground(&state.acceleration);
    for body in turning(model, state) {
        let first = model.bodies[body].velocity;
        let at = |x: &DVector<f64>, i: usize| V3::new(x[i], x[i + 1], x[i + 2]);
        let steady = at(&velocity, first + 3).cross(&at(&velocity, first));
        for i in 0..3 {
            acceleration[first + i] -= steady[i];
        }
    }
    let scales = model.velocity_scales();
    let rates = equations.basis.transpose() * (&equations.mass * acceleration);
    let free = &equations.basis * &rates;
    let (_, size) = farthest(&free, &scales);
    if size.is_nan() || size <= AT_REST {
        return None;
    }
    let largest = model.bodies.iter().map(|body| {
        let first = body.velocity;
        V3::new(free[first], free[first + 1], free[first + 2]).norm()
    });
    let largest = largest.fold(0.0, f64::max);
    let decomposed = crate::singular::decompose(equations.stiffness.clone())?;
    let stiffest = decomposed.singular_values.amax();
    let mut way = if stiffest > 0.0 {
        decomposed.solve(&rates, HELD * stiffest).ok()?
    } else {
        DVector::zeros(rates.len())
    };
    let left = &rates - &equations.stiffness * &way;
    let (_, falls) = farthest(&(&equations.basis * &left), &scales);
    if falls > AT_REST.max(SAME * size) {
        way += left / falls;
    }
    Some((&equations.basis * way, largest))
}

/// The equations after a move of the bodies (body axes), projected onto the constraints.
fn moved_by(
    model: &Model,
    state: &State,
    moves: &[f64],
    moment: Moment,
) -> Result<Equations, RuntimeError> {
    let mut moved = state.clone();
    move_pose(model, &state.pose, moves, 1.0, &mut moved.pose);
    let mut dynamics = Dynamics::new(model);
    let mut system = AccelerationSystem::new(model)?;
    system.restore(model, &mut dynamics, &mut moved, moment)?;
    system.accelerations(model, &mut dynamics, &mut moved, moment)?;
    Equations::of_both_sides(model, &moved, moment)
}

/// The angular speed of the fastest turning body (rad/s); zero if none turns.
pub(super) fn fastest(model: &Model, state: &State) -> f64 {
    turning(model, state)
        .into_iter()
        .map(|b| spin(state, model.bodies[b].velocity).norm())
        .fold(0.0, f64::max)
}

/// The axis of the fastest turning body, a unit vector in ground axes; `None` if none turns.
pub(super) fn axis(model: &Model, state: &State) -> Option<V3> {
    let of = |index: usize| spin(state, model.bodies[index].velocity).norm();
    let fastest = turning(model, state)
        .into_iter()
        .reduce(|a, b| if of(b) > of(a) { b } else { a })?;
    let body = &model.bodies[fastest];
    let q = &state.pose[body.pose + 3..body.pose + 7];
    let axis = matrix(&[q[0], q[1], q[2], q[3]]) * spin(state, body.velocity);
    Some(axis / axis.norm())
}

/// Whether two sets of equations are equal up to a `share` of the largest entry of each kind. `rate_scale` (rad/s)
/// makes mass, damping and stiffness comparable.
pub(super) fn alike(model: &Model, both: [&Equations; 2], rate_scale: f64, share: f64) -> bool {
    let [a, b] = both.map(|e| Coefficients::new(model, e));
    // entries may also differ by a thousandth of the share of the largest of all, a choice: smaller ones move
    // no mode
    a.same(&b, &groups(model), rate_scale, [share, 1e-3 * share])
}

/// The state after `bodies` have moved on for a time (s). Each turning body turns about its own axis, which
/// is fixed in space, with its velocity in its own axes kept. The others move straight on. Accelerations are
/// those of the given state.
pub(super) fn gone_on(model: &Model, state: &State, bodies: &[usize], time: f64) -> State {
    let mut moved = state.clone();
    // drives that depend on time move on with the bodies
    moved.time += time;
    let mut increment = vec![0.0; model.velocities];
    for index in bodies {
        let (first, pose) = (model.bodies[*index].velocity, model.bodies[*index].pose);
        let own = spin(state, first);
        if own.norm() <= AT_REST {
            for i in first..first + 3 {
                increment[i] = state.velocity[i] * time;
            }
            continue;
        }
        increment[first + 3..first + 6].copy_from_slice((own * time).as_slice());
        let q = &state.pose[pose + 3..pose + 7];
        let rotation = matrix(&[q[0], q[1], q[2], q[3]]);
        let axis = rotation * own;
        let v = &state.velocity[first..first + 3];
        let v = V3::new(v[0], v[1], v[2]);
        // vector from the origin to the axis
        let to_axis = axis.cross(&v) / axis.norm_squared();
        if to_axis.norm() <= ON_AXIS * model.length {
            continue;
        }
        let about = matrix(&exponential(&(axis * time)));
        let shift = to_axis - about * to_axis;
        increment[first..first + 3].copy_from_slice(shift.as_slice());
        let turned = about * v;
        moved.velocity[first..first + 3].copy_from_slice(turned.as_slice());
    }
    move_pose(model, &state.pose, &increment, 1.0, &mut moved.pose);
    moved
}

/// The equations after `bodies` have moved on for a time (s).
fn turned_on(
    model: &Model,
    state: &State,
    bodies: &[usize],
    time: f64,
    moment: Moment,
) -> Result<Equations, RuntimeError> {
    let mut moved = gone_on(model, state, bodies, time);
    let mut dynamics = Dynamics::new(model);
    let mut system = AccelerationSystem::new(model)?;
    system.accelerations(model, &mut dynamics, &mut moved, moment)?;
    Equations::of_both_sides(model, &moved, moment)
}

/// The change of the eigenvalues, as a share of their size, by the turning of the bodies, if it is at most
/// [`SLIGHT`]. Otherwise the error is the list of the bodies that change the coefficients.
///
/// With `name`, each such body is found by a test of its own. Otherwise the first turning body represents
/// all.
pub(super) fn varying(
    model: &Model,
    state: &State,
    here: &Here<'_>,
    moment: Moment,
    name: bool,
) -> Result<f64, Vec<TurningBody>> {
    let bodies = turning(model, state);
    let fastest = fastest(model, state);
    if bodies.is_empty() {
        return Ok(0.0);
    }
    let at = |bodies: &[usize], angle: f64| {
        turned_on(model, state, bodies, angle / fastest, moment).ok()
    };
    // without the equations nothing shows that they are constant
    let change = |bodies: &[usize]| {
        let mut most = 0.0_f64;
        for angle in ANGLES {
            let there = at(bodies, angle);
            most = most.max(there.map_or(f64::INFINITY, |there| here.change(model, &there)));
            if most > SLIGHT {
                break;
            }
        }
        most
    };
    let most = change(&bodies);
    if most <= SLIGHT {
        return Ok(most);
    }
    let describe = |index: usize| {
        let body = &model.bodies[index];
        let v = body.velocity;
        let rigid = [v..v + 3, v + 3..v + 6];
        let unequal = || {
            ANGLES.into_iter().any(|angle| {
                at(&[index], angle).is_some_and(|there| {
                    let there = Coefficients::new(model, &there);
                    !same_blocks(&here.coefficients.mass, &there.mass, &rigid, SAME, 0.0)
                })
            })
        };
        let varies = if body.modes() > 0 {
            Varies::Shapes
        } else if unequal() {
            Varies::Inertia
        } else {
            Varies::Loads
        };
        TurningBody {
            origin: body.origin.clone(),
            speed: spin(state, body.velocity).norm(),
            varies,
        }
    };
    if !name {
        return Err(vec![describe(bodies[0])]);
    }
    let alone: Vec<usize> = bodies
        .iter()
        .copied()
        .filter(|b| model.bodies[*b].modes() > 0 || change(&[*b]) > SLIGHT)
        .collect();
    let named = if alone.is_empty() { bodies } else { alone };
    Err(named.into_iter().map(describe).collect())
}
