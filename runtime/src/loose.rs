//! Motions of an assembled model that nothing holds: no constraint prevents them, and no force responds to
//! their displacement or velocity.
//!
//! Let G be the gradients of the constraints and N a basis of their null space. Let K and D be the
//! derivatives of all loads with respect to pose and velocity, at rest. A motion `N z` is unconstrained (loose) if
//! `Nᵀ K N z = 0` and `Nᵀ D N z = 0`, also after a finite distance along it: a contact with play responds
//! only there. Loads that do not change with the motion (gas, gravity) hold nothing. Bodies count as rigid.
//! The motion that turns the cycle is the purpose of the machine, so it is left out.

mod sinking;

pub use sinking::{Pushed, pushed_down, sag};

use crate::assembly::at;
use crate::assembly::gradients::Gradients;
use crate::assembly::independent::Independent;
use crate::assembly::rows::{Along, At, Rows, inputs};
use crate::body::BodyModel;
use crate::chain;
use crate::elements::{self, Scratch};
use crate::error::RuntimeError;
use crate::model::Model;
use crate::rotation::V3;
use crate::state::{State, move_pose};
use eng_system::code::{Function, Pair};
use nalgebra::{DMatrix, DVector};
use std::collections::BTreeMap;
use std::f64::consts::PI;

/// Singular value, as a share of the largest one, below which it counts as zero. It is about the root of the
/// rounding unit, because singular values come from the eigenvalues of squares.
const NONE: f64 = 1e-7;
/// Distances along a motion (in model lengths, or rad) at which loads are evaluated again. Choices: a play of
/// a bearing or a stop is within a hundredth, that of a contact between parts within a third of their size.
const WAYS: [f64; 6] = [0.01, -0.01, 0.05, -0.05, 0.3, -0.3];
/// Share of a motion below which a body does not take part. A choice, a decade above [`NONE`].
const NO_PART: f64 = 1e-6;
/// A translation is pure if the rotation is below this share of it, and the reverse (both as displacements at
/// the model's length). A choice: an axis in a message has three digits.
const PURE: f64 = 1e-3;
/// Largest displacement of a centre of mass in a rotation about it, as a share of the model's length per
/// radian. A choice: gravity would hold a centre farther off with a pendulum of some frequency.
const CENTRED: f64 = 1e-3;

/// Unconstrained motions of a group of connected bodies.
#[derive(Clone, Debug, PartialEq)]
pub struct Loose {
    /// Indices of the bodies that move: the heaviest, then the others in their order.
    pub bodies: Vec<usize>,
    /// Number of independent motions.
    pub motions: usize,
    /// Number of directions of space in which the heaviest body moves.
    pub directions: usize,
    /// For a single motion that is a translation: its direction (inertial, unit length).
    pub along: Option<V3>,
    /// For a single motion that is a rotation: its axis (inertial, unit length), and whether it moves the
    /// centres of mass. If it does, gravity or spin may hold it.
    pub about: Option<(V3, bool)>,
}

/// The unconstrained motions of a model at a position.
///
/// # Errors
///
/// Those of evaluating the elements.
pub fn loose(model: &Model, state: &State) -> Result<Vec<Loose>, RuntimeError> {
    let mut rest = state.clone();
    rest.velocity.fill(0.0);
    let scales = model.velocity_scales();
    let rigid: Vec<usize> = model
        .bodies
        .iter()
        .flat_map(|body| body.velocity..body.velocity + 6)
        .collect();
    let gradients = unit_gradients(model, &rest, &rigid)?;
    let turning = cycle_row(model, &rest);
    let loads = (0..model.elements.len()).any(|e| loads(model, e));
    if !loads
        && turning.is_none()
        && let Some(factor) = Independent::alone(&gradients)
    {
        return Ok(groups(model, &rest, |body| factor.projected(6 * body, 6)));
    }
    let basis = free_motions(&gradients);
    let mut held = DMatrix::zeros(0, basis.ncols());
    for answers in answers(model, &rest)? {
        let scaled = answers.scaled(model, &scales);
        let reduced = basis.tr_mul(&scaled.times(&basis));
        let largest = reduced.amax();
        // if no load responds to any free motion, the remaining stiffness is rounding of that of held
        // directions
        if largest > ROUNDING * scaled.largest() && largest.is_finite() {
            held = stacked(&held, &(reduced / largest));
        }
    }
    if let Some(turning) = turning {
        let row = DMatrix::from_fn(1, rigid.len(), |_, j| turning[rigid[j]] * scales[rigid[j]]);
        let row = row * &basis;
        let largest = row.amax();
        if largest > NONE {
            held = stacked(&held, &(row / largest));
        }
    }
    let mut motions = &basis * null_space(&held);
    // some loads respond only after a distance: a contact with play, a spring that is slack at first
    let mut answered = Vec::new();
    for column in (0..motions.ncols()).filter(|_| loads) {
        let along = motions.columns(column, 1).into_owned();
        if is_answered(model, &rest, &rigid, &along)? {
            answered.push(column);
        }
    }
    motions = motions.remove_columns_at(&answered);
    Ok(of_motions(model, &rest, &motions))
}

/// Whether an element loads bodies.
fn loads(model: &Model, element: usize) -> bool {
    model.elements[element].dynamic && model.class(element).facts.applies_load
}

/// Whether a load responds to a motion, or to its velocity, at one of the [`WAYS`] along it.
fn is_answered(
    model: &Model,
    rest: &State,
    rigid: &[usize],
    along: &DMatrix<f64>,
) -> Result<bool, RuntimeError> {
    let scales = model.velocity_scales();
    let mut increment = vec![0.0; model.velocities];
    for (part, index) in along.iter().zip(rigid) {
        increment[*index] = part * scales[*index];
    }
    for way in WAYS {
        let mut moved = rest.clone();
        move_pose(model, &rest.pose, &increment, way, &mut moved.pose);
        for answers in answers(model, &moved)? {
            let scaled = answers.scaled(model, &scales);
            let answer = along.dot(&scaled.times(along)).abs();
            if answer.is_finite() && answer > NONE * scaled.largest() {
                return Ok(true);
            }
        }
    }
    Ok(false)
}

fn stacked(a: &DMatrix<f64>, b: &DMatrix<f64>) -> DMatrix<f64> {
    let mut out = DMatrix::zeros(a.nrows() + b.nrows(), b.ncols());
    out.rows_mut(0, a.nrows()).copy_from(a);
    out.rows_mut(a.nrows(), b.nrows()).copy_from(b);
    out
}

/// An orthonormal basis of the null space of a matrix, from the eigenvectors of its square.
fn null_space(matrix: &DMatrix<f64>) -> DMatrix<f64> {
    let columns = matrix.ncols();
    if matrix.nrows() == 0 || columns == 0 {
        return DMatrix::identity(columns, columns);
    }
    let eigen = (matrix.transpose() * matrix).symmetric_eigen();
    let largest = eigen.eigenvalues.amax();
    let chosen: Vec<usize> = (0..columns)
        .filter(|i| eigen.eigenvalues[*i] <= NONE * NONE * largest.max(f64::MIN_POSITIVE))
        .collect();
    DMatrix::from_fn(columns, chosen.len(), |i, j| {
        eigen.eigenvectors[(i, chosen[j])]
    })
}

/// Gradients of the constraints by the velocities of rigid bodies, or by all, in scaled velocities and with rows of
/// unit length.
fn unit_gradients(
    model: &Model,
    rest: &State,
    velocities: &[usize],
) -> Result<Gradients, RuntimeError> {
    let rows = Rows::new(model, model.constraining().collect());
    let (mut values, mut matrix) = rows.gradients(model, &at(rest), Along::Pose)?;
    rows.scale_gradients(model, &mut values, &mut matrix);
    let (gradients, _) = matrix.columns(velocities, |_| 1.0).unit_rows();
    Ok(gradients)
}

/// The motions that constraints leave, in scaled velocities: an orthonormal basis.
fn free_motions(gradients: &Gradients) -> DMatrix<f64> {
    if !gradients.is_finite() {
        return DMatrix::zeros(gradients.ncols(), 0);
    }
    match Independent::alone(gradients) {
        Some(factor) => factor.basis(),
        None => null_space(&gradients.dense()),
    }
}

/// Whether the loads of an element change with the positions of its markers at rest. Those of a damper or a
/// brake do not.
///
/// # Errors
///
/// Those of evaluating the element.
pub fn springs(model: &Model, state: &State, element: usize) -> Result<bool, RuntimeError> {
    let mut rest = state.clone();
    rest.velocity.fill(0.0);
    let [stiffness, _] = answers_of(model, &rest, element..element + 1)?;
    Ok(stiffness.largest() > 0.0)
}

/// The markers of an element that take loads, at rest at a position, with one of its markers after the other moved a
/// little along the axes of the ground: a contact loads its markers only while it touches.
///
/// # Errors
///
/// Those of evaluating the element.
pub fn loaded(model: &Model, state: &State, element: usize) -> Result<Vec<bool>, RuntimeError> {
    let mut rest = state.clone();
    rest.velocity.fill(0.0);
    let own = &model.elements[element];
    let layout = &model.class(element).layout;
    let markers = own.markers.len();
    let mut found = vec![false; markers];
    let here = inputs(model, element, &at(&rest));
    let mut out = vec![[0.0; 2]; layout.residual_len() as usize];
    for marker in 0..layout.markers {
        for axis in 0..3 {
            for way in WAYS {
                let mut moved = here.clone();
                let place = layout.marker(marker) as usize + axis;
                moved[place] = moved[place].map(|x| x + way * model.length);
                elements::call(model, own.class, Function::Residual, &moved, &mut out)?;
                let wrenches = out.iter().skip(layout.rows as usize).take(6 * markers);
                for (at, value) in wrenches.enumerate() {
                    found[at / 6] |= value[0] != 0.0;
                }
            }
        }
    }
    Ok(found)
}

/// Share of a torque up to which its change by a turn is rounding of the angle. A choice: sums of angles
/// round to 1e-15, and stiff springs multiply this.
const SAME: f64 = 1e-9;

/// The change of an element's torques by one more turn of its angles, at rest (N m): `2π k` for a spring with the
/// stiffness `k`, and 0 for a torque over a wrapped angle.
///
/// # Errors
///
/// Those of evaluating the element.
pub fn wound(model: &Model, state: &State, element: usize) -> Result<f64, RuntimeError> {
    let mut rest = state.clone();
    rest.velocity.fill(0.0);
    let own = &model.elements[element];
    let layout = &model.class(element).layout;
    let torques = |rest: &State| -> Result<Vec<f64>, RuntimeError> {
        let mut out = vec![[0.0; 2]; layout.residual_len() as usize];
        let inputs = inputs(model, element, &at(rest));
        elements::call(model, own.class, Function::Residual, &inputs, &mut out)?;
        let wrenches = out.iter().skip(layout.rows as usize);
        let wrenches = wrenches.take(6 * own.markers.len()).enumerate();
        let torques = wrenches.filter(|(at, _)| at % 6 >= 3);
        Ok(torques.map(|(_, value)| value[0]).collect())
    };
    let before = torques(&rest)?;
    for angle in rest
        .rotations
        .iter_mut()
        .skip(own.rotation)
        .take(layout.rotations as usize)
    {
        *angle += 2.0 * PI;
    }
    let after = torques(&rest)?;
    let largest =
        |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, |a: f64, b| a.max(b.abs()));
    let change = largest(&mut before.iter().zip(&after).map(|(a, b)| b - a));
    let size = largest(&mut before.iter().chain(&after).copied());
    Ok(if change > SAME * size { change } else { 0.0 })
}

/// The kinetic energy of all bodies as rigid ones (J).
pub fn kinetic_energy(model: &Model, state: &State) -> f64 {
    let of = |body: &BodyModel| {
        let part = |first: usize| {
            let at = body.velocity + first;
            V3::from_fn(|i, _| state.velocity[at + i])
        };
        let (velocity, turning) = (part(0), part(3));
        let arm = body.frame(&state.pose).rotation * turning.cross(&body.center());
        0.5 * body.mass() * velocity.norm_squared()
            + body.mass() * velocity.dot(&arm)
            + 0.5 * turning.dot(&(body.inertia() * turning))
    };
    model.bodies.iter().map(of).sum()
}

/// Share of the largest stiffness below which a stiffness is rounding. A choice some decades above the
/// rounding unit, because stiffnesses of held directions cancel on free motions.
const ROUNDING: f64 = 1e-11;
/// Derivatives of loads by motions of rigid bodies: a block of 6 × 6 numbers, row-major, for each loaded body and
/// each body whose motion changes its loads. Few bodies of a large model touch each other.
#[derive(Clone, Debug, Default)]
struct Answers(BTreeMap<(usize, usize), [f64; 36]>);

impl Answers {
    /// The same blocks by scaled velocities on both sides.
    fn scaled(mut self, model: &Model, scales: &[f64]) -> Answers {
        for ((loaded, mover), block) in &mut self.0 {
            let (rows, columns) = (
                model.bodies[*loaded].velocity,
                model.bodies[*mover].velocity,
            );
            for (at, x) in block.iter_mut().enumerate() {
                *x *= scales[rows + at / 6] * scales[columns + at % 6];
            }
        }
        self
    }

    /// The largest magnitude.
    fn largest(&self) -> f64 {
        let all = self.0.values().flatten();
        all.fold(
            0.0,
            |w, x| if x.is_nan() { f64::NAN } else { x.abs().max(w) },
        )
    }

    /// `A x` for columns with six numbers a body.
    fn times(&self, x: &DMatrix<f64>) -> DMatrix<f64> {
        let mut out = DMatrix::zeros(x.nrows(), x.ncols());
        for (mut to, from) in out.column_iter_mut().zip(x.column_iter()) {
            for ((loaded, mover), block) in &self.0 {
                for (i, row) in block.as_chunks::<6>().0.iter().enumerate() {
                    let along = row.iter().enumerate();
                    to[6 * loaded + i] += along.map(|(j, a)| a * from[6 * mover + j]).sum::<f64>();
                }
            }
        }
        out
    }
}

/// `Jᵀ ∂W/∂x J` of all loads, with respect to pose and to twist.
fn answers(model: &Model, rest: &State) -> Result<[Answers; 2], RuntimeError> {
    answers_of(model, rest, 0..model.elements.len())
}

/// The same for some elements.
fn answers_of(
    model: &Model,
    rest: &State,
    elements: std::ops::Range<usize>,
) -> Result<[Answers; 2], RuntimeError> {
    let mut found = [Answers::default(), Answers::default()];
    for index in elements {
        let element = &model.elements[index];
        let class = model.class(index);
        if !loads(model, index) {
            continue;
        }
        let layout = &class.layout;
        let (rows, length) = (layout.rows as usize, layout.residual_len() as usize);
        let mut scratch = Scratch::new(model);
        let motion = 0..layout.state_direction(0) as usize;
        let tangents = tangents_of(model, index, rest, motion, &mut scratch)?;
        let jacobians: Vec<Option<(usize, Vec<f64>)>> = element
            .markers
            .iter()
            .map(|marker| {
                let marker = &model.markers[*marker];
                let body = &model.bodies[marker.body?];
                let mut jacobian = vec![0.0; 6 * body.width()];
                chain::jacobian(body, &body.frame(&rest.pose), marker, &mut jacobian);
                Some((marker.body?, jacobian))
            })
            .collect();
        for (k, moved) in jacobians.iter().enumerate() {
            let Some((mover, by)) = moved else { continue };
            let bases = [
                layout.pose_direction(k as u32),
                layout.twist_direction(k as u32),
            ];
            for (Answers(blocks), base) in found.iter_mut().zip(bases) {
                for (l, loaded) in jacobians.iter().enumerate() {
                    let Some((body, on)) = loaded else { continue };
                    let block = blocks.entry((*body, *mover)).or_insert([0.0; 36]);
                    let (height, width) =
                        (model.bodies[*body].width(), model.bodies[*mover].width());
                    for d in 0..6 {
                        let out = &tangents[(base as usize + d) * length..][..length];
                        for (at, x) in block.iter_mut().enumerate() {
                            let force: f64 = (0..6)
                                .map(|c| out[rows + 6 * l + c][0] * on[c * height + at / 6])
                                .sum();
                            *x += force * by[d * width + at % 6];
                        }
                    }
                }
            }
        }
    }
    Ok(found)
}

/// The derivatives of an element's outputs along some directions, at rest.
fn tangents_of<'s>(
    model: &Model,
    index: usize,
    rest: &State,
    directions: std::ops::Range<usize>,
    scratch: &'s mut Scratch,
) -> Result<&'s [Pair], RuntimeError> {
    let mut batches = elements::batches(model, &[index], false);
    let At { time, .. } = at(rest);
    for batch in &mut batches {
        batch
            .inputs_mut(0)
            .copy_from_slice(&inputs(model, index, &at(rest)));
        let directions = std::slice::from_ref(&directions);
        elements::differentiate(model, batch, 0, directions, time, scratch)?;
    }
    Ok(&scratch.tangents)
}

/// The derivative of the cycle's angle, if it is one between two markers.
fn cycle_row(model: &Model, rest: &State) -> Option<DVector<f64>> {
    let system = &model.compiled.system;
    let cycle = system.cycle.as_ref()?.element as usize;
    let rotation = system.elements.get(cycle)?.rotations.first()?;
    let markers = &model.elements.get(cycle)?.markers;
    let reference = *markers.get(rotation.reference as usize)?;
    let axis = crate::assembly::rows::marker(model, reference, &rest.pose, &rest.velocity)
        .rotation
        .column(2)
        .into_owned();
    let mut row = DVector::zeros(model.velocities);
    for (marker, sign) in [(rotation.turning, 1.0), (rotation.reference, -1.0)] {
        let marker = &model.markers[*markers.get(marker as usize)?];
        let Some(body) = marker.body else { continue };
        let body = &model.bodies[body];
        let along = body.frame(&rest.pose).rotation.transpose() * axis;
        for i in 0..3 {
            row[body.velocity + 3 + i] += sign * along[i];
        }
    }
    Some(row)
}

/// Groups motions (columns, in scaled velocities of rigid bodies, orthonormal) by the bodies that they move together.
pub(crate) fn of_motions(model: &Model, state: &State, motions: &DMatrix<f64>) -> Vec<Loose> {
    groups(model, state, |body| {
        motions * motions.rows(6 * body, 6).transpose()
    })
}

/// Groups motions by the bodies that they move together. `projected` gives the six columns of a body in the
/// projector on the motions, in scaled velocities of rigid bodies: the motions of all bodies that go with
/// each velocity of this body.
fn groups(model: &Model, rest: &State, projected: impl Fn(usize) -> DMatrix<f64>) -> Vec<Loose> {
    let count = model.bodies.len();
    let mut group: Vec<usize> = (0..count).collect();
    let mut own = Vec::with_capacity(count);
    for a in 0..count {
        let columns = projected(a);
        for b in 0..a {
            if group[a] != group[b] && columns.rows(6 * b, 6).norm() > NO_PART {
                let (from, to) = (group[a], group[b]);
                group
                    .iter_mut()
                    .filter(|g| **g == from)
                    .for_each(|g| *g = to);
            }
        }
        own.push(columns.rows(6 * a, 6).into_owned());
    }
    let mut found = Vec::new();
    for first in 0..count {
        let mut bodies: Vec<usize> = (0..count)
            .filter(|b| group[*b] == first && own[*b].norm() > NO_PART)
            .collect();
        if bodies.is_empty() {
            continue;
        }
        let trace: f64 = bodies.iter().map(|b| own[*b].trace()).sum();
        let mass = |b: &usize| model.bodies[*b].mass();
        let heaviest =
            (0..bodies.len()).fold(0, |best, i| match mass(&bodies[i]) > mass(&bodies[best]) {
                true => i,
                false => best,
            });
        bodies[..=heaviest].rotate_right(1);
        let count = libm::round(trace).max(1.0) as usize;
        let (along, about) = match count {
            1 => single(model, rest, &own[bodies[0]], &bodies),
            _ => (None, None),
        };
        // the squares of the singular values of its part of the motions
        let moves = own[bodies[0]].view((0, 0), (3, 3)).into_owned();
        let squares = moves.symmetric_eigenvalues();
        found.push(Loose {
            directions: (squares.iter())
                .filter(|square| **square > NO_PART * NO_PART)
                .count(),
            bodies,
            motions: count,
            along,
            about,
        });
    }
    found
}

/// Direction or axis of a group's single motion, from the projector of its heaviest body.
fn single(
    model: &Model,
    rest: &State,
    own: &DMatrix<f64>,
    bodies: &[usize],
) -> (Option<V3>, Option<(V3, bool)>) {
    let Some(heaviest) = bodies.first() else {
        return (None, None);
    };
    let eigen = own.clone().symmetric_eigen();
    let (index, _) = eigen.eigenvalues.argmax();
    let vector = eigen.eigenvectors.column(index);
    let moved = V3::new(vector[0], vector[1], vector[2]);
    let turned = V3::new(vector[3], vector[4], vector[5]);
    if turned.norm() < PURE * moved.norm() {
        return (Some(moved.normalize()), None);
    }
    let body = &model.bodies[*heaviest];
    let frame = body.frame(&rest.pose);
    let axis = frame.rotation * turned;
    let center = moved + axis.cross(&(frame.rotation * body.center())) / model.length;
    let swings = center.norm() > CENTRED * axis.norm() || bodies.len() > 1;
    (None, Some((axis.normalize(), swings)))
}
