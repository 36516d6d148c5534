//! The exact matrix of a step, filled at the places of its plan.

use super::plan::{MatrixPlan, Place};
use super::{Dynamics, Placement, Workspace, frame_of, shape_rows};
use crate::body::Weights;
use crate::chain::{self, CURVED_REACH, Motion, Placed, REACH};
use crate::elements::{self, Batch, not_finite};
use crate::error::RuntimeError;
use crate::model::{MarkerModel, Model};
use crate::rotation::{M3, V3};
use eng_system::code::Pair;
use eng_system::dense::{add_product_of_six, add_scaled};

/// The tangents T of bodies: the derivative of a body's turn by its increment.
type Turn<'a> = &'a dyn Fn(usize) -> M3;

/// The numbers of a class, and one of its elements in a lane.
#[derive(Clone, Copy)]
pub(super) struct Lane {
    pub index: usize,
    pub lane: usize,
    pub markers: usize,
    pub rows: usize,
    pub states: usize,
    pub length: usize,
    /// First row of the drives of fields, and first direction of their answers.
    pub drives: usize,
    pub answers: usize,
    uses_twist: bool,
}

/// One marker of an element, on a body.
#[derive(Clone, Copy)]
pub(super) struct Seen<'a> {
    /// Its index among the element's markers.
    pub own: usize,
    /// Its index among the model's markers.
    pub marker: usize,
    pub model: &'a MarkerModel,
    body: usize,
    /// The number of the body's motions that it sees.
    pub reach: usize,
    /// The number of all motions of the body.
    pub width: usize,
}

/// The matrix during the addition of elements, with the parts of the dynamics that are read and written.
pub(super) struct Filling<'a> {
    pub plan: &'a MatrixPlan,
    pub model: &'a Model,
    turn: Turn<'a>,
    pub values: &'a mut [f64],
    pub work: &'a mut Workspace,
    pub at: &'a Placement,
    wrenches: &'a [f64],
    /// Weight of the velocities in the unknown.
    pub velocity_weight: f64,
}

impl MatrixPlan {
    /// Fills the unscaled matrix of a step: `∂/∂(u, y, λ)` of `[M v̇ − Q − ΣJᵀW; ẏ − f; Φ]`, with
    /// `δq = T(u) δu`, `δv = weights.velocity δu`, `δv̇ = weights.acceleration δu` and
    /// `δẏ = state_weight δy`. Exact at the gathered inputs and the wrenches of the last evaluation.
    #[allow(clippy::too_many_arguments)]
    pub fn fill(
        &self,
        model: &Model,
        dynamics: &mut Dynamics,
        velocity: &[f64],
        acceleration: &[f64],
        increment: &[f64],
        weights: Weights,
        state_weight: f64,
        values: &mut [f64],
    ) -> Result<(), RuntimeError> {
        values.fill(0.0);
        let turn = |body: usize| {
            let v = model.bodies[body].velocity + 3;
            crate::rotation::tangent(&V3::new(increment[v], increment[v + 1], increment[v + 2]))
        };
        self.fill_bodies(
            model,
            dynamics,
            velocity,
            acceleration,
            weights,
            &turn,
            values,
        );
        dynamics.fill_columns(model, velocity, weights, &turn);
        dynamics.work.sums.clear();
        dynamics.work.sums.resize(self.sums, 0.0);
        dynamics.work.pulls.fill([0.0; 6]);
        let mut filling = Filling {
            plan: self,
            model,
            turn: &turn,
            values,
            work: &mut dynamics.work,
            at: &dynamics.at,
            wrenches: &dynamics.wrenches,
            velocity_weight: weights.velocity,
        };
        for batch in &mut dynamics.batches {
            filling.batch(batch)?;
        }
        filling.couplings();
        for k in 0..model.states {
            values[self.diagonal[model.velocities + k]] += state_weight;
        }
        Ok(())
    }

    /// Adds the inertia of the bodies.
    #[allow(clippy::too_many_arguments)]
    fn fill_bodies(
        &self,
        model: &Model,
        dynamics: &mut Dynamics,
        velocity: &[f64],
        acceleration: &[f64],
        weights: Weights,
        turn: &dyn Fn(usize) -> M3,
        values: &mut [f64],
    ) {
        for (index, body) in model.bodies.iter().enumerate() {
            let width = body.width();
            let range = body.velocity..body.velocity + width;
            let block = &mut dynamics.work.block[..width * width];
            block.fill(0.0);
            body.add_inertia_matrix(
                &frame_of(&dynamics.at.pose, &dynamics.at.frames, body, index),
                &velocity[range.clone()],
                &acceleration[range],
                &model.gravity,
                weights,
                &turn(index),
                &mut dynamics.work.bending,
                block,
            );
            self.table.get(self.bodies[index]).add(values, block, 1.0);
        }
    }
}

impl Filling<'_> {
    fn batch(&mut self, batch: &mut Batch) -> Result<(), RuntimeError> {
        let class = &self.model.compiled.system.classes[batch.class];
        let layout = &class.layout;
        let markers = layout.markers as usize;
        let states = layout.states as usize;
        let twists = if class.facts.uses_twist {
            6 * markers..12 * markers
        } else {
            0..0
        };
        let directions = [0..6 * markers, twists, 12 * markers..12 * markers + states];
        for pair in 0..batch.pairs.len() {
            elements::differentiate(
                self.model,
                batch,
                pair,
                &directions,
                self.at.time,
                &mut self.work.elements,
            )?;
            for lane in 0..batch.lanes(pair) {
                let lane = Lane {
                    index: batch.pairs[pair][lane],
                    lane,
                    markers,
                    rows: layout.rows as usize,
                    states,
                    length: layout.residual_len() as usize,
                    drives: layout.drive(0) as usize,
                    answers: layout.answer_direction(0) as usize,
                    uses_twist: class.facts.uses_twist,
                };
                self.element(batch, pair, lane)?;
                self.surfaces(batch, pair, lane);
            }
        }
        Ok(())
    }

    fn element(&mut self, batch: &Batch, pair: usize, lane: Lane) -> Result<(), RuntimeError> {
        let model = self.model;
        for (own, marker) in model.elements[lane.index].markers.iter().enumerate() {
            let seen = &model.markers[*marker];
            let Some(body) = seen.body else {
                continue;
            };
            let seen = Seen {
                own,
                marker: *marker,
                model: seen,
                body,
                reach: seen.reach(),
                width: model.bodies[body].width(),
            };
            self.outputs_along(lane, seen)?;
            self.rows(lane, seen);
            self.states_by_body(lane, seen);
            self.forces(lane, seen);
            self.surfaces_by_body(batch, pair, lane, seen);
            self.turning_wrench(lane, seen);
        }
        self.states_by_states(lane)
    }

    /// Writes all outputs of the element along the reach of a marker into `columns`, length × reach.
    fn outputs_along(&mut self, lane: Lane, seen: Seen) -> Result<(), RuntimeError> {
        let reach = seen.reach;
        let at = self.at.jacobian_at[seen.marker];
        let range = at..at + 6 * reach;
        let columns = &mut self.work.columns[..lane.length * reach];
        columns.fill(0.0);
        let along = Along::new(&self.work.elements.tangents, lane);
        let pose = &self.work.pose_columns[range.clone()];
        along.add(6 * seen.own, 0, pose, reach, columns);
        if lane.uses_twist {
            let first = 6 * lane.markers + 6 * seen.own;
            let twist = &self.work.twist_columns[range];
            along.add(first, lane.rows, twist, reach, columns);
        }
        if columns.iter().any(|x| !x.is_finite()) {
            return Err(not_finite(self.model, lane.index, self.at.time));
        }
        Ok(())
    }

    /// Adds the derivatives of the constraints by the body, and of the body's balance by the multipliers.
    fn rows(&mut self, lane: Lane, seen: Seen) {
        let Some((by_body, by_rows)) = self.plan.elements[lane.index].constraint[seen.own] else {
            return;
        };
        let Seen { reach, width, .. } = seen;
        let shape = shape_rows(seen.model, &self.at.shapes, self.at.shape_at[seen.marker]);
        let table = &self.plan.table;
        let line = &mut self.work.line;
        expanded(
            shape,
            &self.work.columns[..lane.rows * reach],
            reach,
            width,
            line,
        );
        table.get(by_body).add(self.values, line, 1.0);
        // ∂/∂λ of the wrench is −Gᵀ: Jᵀ Gᵀ, without T.
        let block = &mut self.work.block[..lane.rows * reach];
        block.fill(0.0);
        let at = self.at.jacobian_at[seen.marker];
        let along = Along::new(&self.work.elements.tangents, lane);
        along.add(
            6 * seen.own,
            0,
            &self.at.jacobians[at..at + 6 * reach],
            reach,
            block,
        );
        expanded(shape, block, reach, width, line);
        table.get(by_rows).add_transposed(self.values, line, 1.0);
    }

    /// Adds the derivatives of the states' rates by the body, and of the body's balance by the states.
    fn states_by_body(&mut self, lane: Lane, seen: Seen) {
        let Some((by_body, by_states)) = self.plan.elements[lane.index].state[seen.own] else {
            return;
        };
        let Seen { reach, width, .. } = seen;
        let shape = shape_rows(seen.model, &self.at.shapes, self.at.shape_at[seen.marker]);
        let table = &self.plan.table;
        let first = lane.rows + 6 * lane.markers;
        let rates = first * reach..(first + lane.states) * reach;
        expanded(
            shape,
            &self.work.columns[rates],
            reach,
            width,
            &mut self.work.line,
        );
        table.get(by_body).add(self.values, &self.work.line, -1.0);
        let at = self.at.jacobian_at[seen.marker];
        let jacobian = &self.at.jacobians[at..at + 6 * reach];
        let tangents = &self.work.elements.tangents;
        let block = &mut self.work.block[..lane.states * reach];
        block.fill(0.0);
        for (s, row) in block.chunks_exact_mut(reach).enumerate() {
            let direction = (12 * lane.markers + s) * lane.length + lane.rows + 6 * seen.own;
            for (d, jacobian) in jacobian.chunks_exact(reach).enumerate() {
                add_scaled(row, tangents[direction + d][lane.lane], jacobian);
            }
        }
        expanded(shape, block, reach, width, &mut self.work.line);
        table
            .get(by_states)
            .add_transposed(self.values, &self.work.line, -1.0);
    }

    /// Adds the derivatives of the forces on all markers of the element by the body of this marker.
    fn forces(&mut self, lane: Lane, seen: Seen) {
        let reach = seen.reach;
        let plan = &self.plan.elements[lane.index];
        for (i, other) in self.model.elements[lane.index].markers.iter().enumerate() {
            let Some(place) = plan.force[i * lane.markers + seen.own] else {
                continue;
            };
            let height = self.model.markers[*other].reach();
            let to = self.at.jacobian_at[*other];
            let block = &mut self.work.block[..height * reach];
            block.fill(0.0);
            let first = (lane.rows + 6 * i) * reach;
            add_product_of_six(
                block,
                &self.at.jacobians[to..to + 6 * height],
                &self.work.columns[first..first + 6 * reach],
            );
            self.put(place, height * reach);
        }
    }

    /// Adds the chain's own second-order term: the frozen wrench turns with the body.
    fn turning_wrench(&mut self, lane: Lane, seen: Seen) {
        let Seen {
            own, marker, reach, ..
        } = seen;
        let Some(place) = self.plan.elements[lane.index].force[own * lane.markers + own] else {
            return;
        };
        let body = &self.model.bodies[seen.body];
        let frame = frame_of(&self.at.pose, &self.at.frames, body, seen.body);
        let placed = match &self.at.placed[marker] {
            Some((placed, _)) => *placed,
            None => Placed::new(&frame, seen.model),
        };
        let first = self.model.elements[lane.index].wrench + 6 * own;
        let wrench = &self.wrenches[first..first + 6];
        let block = &mut self.work.block[..reach * reach];
        chain::force_by_pose(&frame.rotation, &placed, wrench, block);
        chain::turn_columns(block, reach, reach, &(self.turn)(seen.body));
        self.put(place, reach * reach);
        if reach == CURVED_REACH {
            let jacobian = &self.at.jacobians[self.at.jacobian_at[marker]..];
            for (w, row) in wrench.iter().zip(jacobian.chunks_exact(reach)) {
                add_scaled(&mut self.work.pulls[marker], *w, &row[6..]);
            }
        }
    }

    /// Adds the derivatives of an element's state rates by its states.
    fn states_by_states(&mut self, lane: Lane) -> Result<(), RuntimeError> {
        let Some(place) = self.plan.elements[lane.index].own else {
            return Ok(());
        };
        let n = lane.states;
        let tangents = &self.work.elements.tangents;
        let block = &mut self.work.block[..n * n];
        for r in 0..n {
            for s in 0..n {
                let direction = (12 * lane.markers + s) * lane.length;
                let output = lane.rows + 6 * lane.markers + r;
                block[r * n + s] = tangents[direction + output][lane.lane];
            }
        }
        if block.iter().any(|x| !x.is_finite()) {
            return Err(not_finite(self.model, lane.index, self.at.time));
        }
        self.plan.table.get(place).add(self.values, block, -1.0);
        Ok(())
    }

    /// Subtracts the first numbers of `block`, an element's block between two markers.
    fn put(&mut self, place: Place, count: usize) {
        let block = &self.work.block[..count];
        match place {
            Place::Matrix(index) => self.plan.table.get(index).add(self.values, block, -1.0),
            Place::Sum(at) => add_scaled(&mut self.work.sums[at..at + count], 1.0, block),
        }
    }

    /// Adds the summed blocks of markers, expanded by the modes of their bodies.
    fn couplings(&mut self) {
        let model = self.model;
        for coupling in &self.plan.couplings {
            let height = model.bodies[coupling.rows].width();
            let width = model.bodies[coupling.columns].width();
            let block = &mut self.work.block[..height * width];
            block.fill(0.0);
            for (first, second, at) in &coupling.markers {
                let [left, right] = [*first, *second].map(|m| &model.markers[m]);
                let sum = &self.work.sums[*at..*at + left.reach() * right.reach()];
                let rows = shape_rows(right, &self.at.shapes, self.at.shape_at[*second]);
                expanded(rows, sum, right.reach(), width, &mut self.work.line);
                let rows = shape_rows(left, &self.at.shapes, self.at.shape_at[*first]);
                expand_rows(rows, &self.work.line, width, block);
                // each marker is paired with itself once, so its pull is added once
                if let (Some(shape), true) = (&left.shape, first == second) {
                    shape.add_pull(&self.work.pulls[*first], width, 6, &mut block[6 * width..]);
                }
            }
            let table = &self.plan.table;
            table.get(coupling.block).add(self.values, block, -1.0);
        }
    }
}

impl Dynamics {
    /// Pose J T and twist ∂(Jv)/∂q T + weights.velocity J of each marker along its body's increment, in its
    /// reach.
    fn fill_columns(
        &mut self,
        model: &Model,
        velocity: &[f64],
        weights: Weights,
        turn: &dyn Fn(usize) -> M3,
    ) {
        for (index, marker) in model.markers.iter().enumerate() {
            let Some(b) = marker.body else { continue };
            let (placed, motion) = match &self.at.placed[index] {
                Some(known) => *known,
                None => {
                    let body = &model.bodies[b];
                    let frame = frame_of(&self.at.pose, &self.at.frames, body, b);
                    let v = &velocity[body.velocity..];
                    (Placed::new(&frame, marker), Motion::new(&frame, marker, v))
                }
            };
            let reach = placed.reach();
            let range = self.at.jacobian_at[index]..self.at.jacobian_at[index] + 6 * reach;
            let t = turn(b);
            let pose = &mut self.work.pose_columns[range.clone()];
            pose.copy_from_slice(&self.at.jacobians[range.clone()]);
            chain::turn_columns(pose, 6, reach, &t);
            let twist = &mut self.work.twist_columns[range.clone()];
            chain::twist_by_pose(&self.at.frames[b].1, &placed, &motion, twist);
            chain::turn_columns(twist, 6, reach, &t);
            add_scaled(twist, weights.velocity, &self.at.jacobians[range]);
        }
    }
}

/// Derivatives of an element's outputs, direction by direction.
struct Along<'a> {
    tangents: &'a [Pair],
    lane: usize,
    length: usize,
}

impl Along<'_> {
    fn new(tangents: &[Pair], lane: Lane) -> Along<'_> {
        Along {
            tangents,
            lane: lane.lane,
            length: lane.length,
        }
    }

    /// `out += ∂(outputs from `from` on)/∂(six directions from `first` on) · six rows`, rows of `reach`
    /// numbers.
    fn add(&self, first: usize, from: usize, six: &[f64], reach: usize, out: &mut [f64]) {
        match reach {
            REACH => self.add_wide::<REACH>(first, from, six, out),
            CURVED_REACH => self.add_wide::<CURVED_REACH>(first, from, six, out),
            _ => self.add_wide::<6>(first, from, six, out),
        }
    }

    fn add_wide<const R: usize>(&self, first: usize, from: usize, six: &[f64], out: &mut [f64]) {
        let (six, _) = six.as_chunks::<R>();
        let (out, _) = out.as_chunks_mut::<R>();
        for (d, row) in six.iter().enumerate() {
            let begin = (first + d) * self.length;
            let tangents = &self.tangents[begin..begin + self.length];
            for (x, g) in out.iter_mut().zip(tangents).skip(from) {
                let g = g[self.lane];
                if g != 0.0 {
                    for r in 0..R {
                        x[r] += g * row[r];
                    }
                }
            }
        }
    }
}

/// Rows over a marker's reach as rows over its body's velocities, in `line`; `shape`: see [`chain::expand`].
pub(super) fn expanded(
    shape: &[f64],
    block: &[f64],
    reach: usize,
    width: usize,
    line: &mut Vec<f64>,
) {
    line.clear();
    line.resize(block.len() / reach * width, 0.0);
    chain::expand(shape, block, reach, width, line);
}

/// Rows of a marker's reach, `width` long each, added to the rows of its body's velocities. No force acts
/// along the numbers beyond the twelfth.
pub(super) fn expand_rows(shape: &[f64], block: &[f64], width: usize, out: &mut [f64]) {
    let (rigid, modal) = block.split_at(6 * width);
    let (rigid_out, modal_out) = out.split_at_mut(6 * width);
    add_scaled(rigid_out, 1.0, rigid);
    let six = 6 * (modal_out.len() / width);
    if let (Some(rows), Some(modal)) = (shape.get(..six), modal.get(..6 * width)) {
        add_product_of_six(modal_out, rows, modal);
    }
}
