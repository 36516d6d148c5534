//! The exact matrix of a step: where its blocks lie, and how they are filled.

use super::{Dynamics, frame_of, not_finite, shape_rows};
use crate::body::Weights;
use crate::chain::{self, CURVED_REACH, Motion, Placed, REACH};
use crate::dense::{add_product_of_six, add_scaled};
use crate::elements;
use crate::error::RuntimeError;
use crate::linear::{BlockTable, Pattern, PatternBuilder, Runs};
use crate::model::Model;
use crate::rotation::{M3, V3};
use eng_system::code::Pair;
use std::collections::BTreeMap;

/// Where the blocks of the step's matrix lie. Unknowns: velocities' increments, states, multipliers.
#[derive(Clone, Debug)]
pub struct MatrixPlan {
    /// The pattern.
    pub pattern: Pattern,
    /// Its runs.
    pub runs: Runs,
    table: BlockTable,
    bodies: Vec<usize>,
    /// Blocks of each dynamic element, in the order in which [`MatrixPlan::fill`] visits them.
    elements: Vec<ElementPlan>,
    /// Pairs of bodies whose markers' blocks are summed before they are expanded by the modes.
    couplings: Vec<Coupling>,
    /// Numbers of these sums.
    sums: usize,
    diagonal: Vec<usize>,
}

/// Where an element's block between two markers goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Place {
    /// Both see six numbers of their bodies: into the matrix.
    Matrix(usize),
    /// To the sum that begins here.
    Sum(usize),
}

/// Blocks between the markers of two bodies, of which one is flexible.
#[derive(Clone, Debug)]
struct Coupling {
    block: usize,
    rows: usize,
    columns: usize,
    /// Markers of both, and the begin of their sum.
    markers: Vec<(usize, usize, usize)>,
}

#[derive(Clone, Debug, Default)]
struct ElementPlan {
    /// markers × markers, where both are on bodies.
    force: Vec<Option<Place>>,
    /// rows by body of marker; body of marker by rows.
    constraint: Vec<Option<(usize, usize)>>,
    /// states by body of marker; body of marker by states.
    state: Vec<Option<(usize, usize)>>,
    /// states by states.
    own: Option<usize>,
}

impl MatrixPlan {
    /// Plans the matrix of a step.
    pub fn new(model: &Model) -> MatrixPlan {
        let states_at = model.velocities;
        let rows_at = model.velocities + model.states;
        let size = rows_at + model.rows;
        let mut builder = PatternBuilder::new(size);
        let body_range = |marker: usize| {
            model.markers[marker].body.map(|b| {
                let body = &model.bodies[b];
                body.velocity..body.velocity + body.width()
            })
        };
        for body in &model.bodies {
            let range = body.velocity..body.velocity + body.width();
            builder.reserve(range.clone(), range);
        }
        let ranges = |index: usize| {
            let element = &model.elements[index];
            let layout = model.compiled.system.classes[element.class].layout;
            let rows = rows_at + element.row..rows_at + element.row + layout.rows as usize;
            let states =
                states_at + element.state..states_at + element.state + layout.states as usize;
            (rows, states)
        };
        let loads = |index: usize| {
            // Rows alone couple the bodies as well, through the second derivatives of Φ.
            let class = model.class(index);
            class.applies_load || !class.rows.is_empty()
        };
        for (index, element) in model.elements.iter().enumerate().filter(|(_, e)| e.dynamic) {
            let (rows, states) = ranges(index);
            builder.reserve(states.clone(), states.clone());
            for i in element.markers.iter().filter_map(|m| body_range(*m)) {
                builder.reserve(rows.clone(), i.clone());
                builder.reserve(i.clone(), rows.clone());
                builder.reserve(states.clone(), i.clone());
                builder.reserve(i.clone(), states.clone());
                if loads(index) {
                    for j in element.markers.iter().filter_map(|m| body_range(*m)) {
                        builder.reserve(i.clone(), j);
                    }
                }
            }
        }
        let pattern = builder.finish();
        let mut table = BlockTable::default();
        let bodies = model
            .bodies
            .iter()
            .map(|b| table.find(&pattern, b.velocity, b.velocity..b.velocity + b.width()))
            .collect();
        let mut plans = Vec::new();
        let mut sums = 0;
        let mut summed: BTreeMap<(usize, usize), BTreeMap<(usize, usize), usize>> = BTreeMap::new();
        for (index, element) in model.elements.iter().enumerate() {
            let mut plan = ElementPlan::default();
            if element.dynamic {
                let (rows, states) = ranges(index);
                for m in &element.markers {
                    for n in &element.markers {
                        let (first, second) = (&model.markers[*m], &model.markers[*n]);
                        let block = match (first.body, second.body) {
                            (Some(i), Some(j)) if loads(index) => {
                                let (height, width) = (first.reach(), second.reach());
                                Some(if height.max(width) == 6 {
                                    let (i, j) =
                                        (model.bodies[i].velocity, model.bodies[j].velocity);
                                    Place::Matrix(table.find(&pattern, i, j..j + 6))
                                } else {
                                    let sum = summed
                                        .entry((i, j))
                                        .or_default()
                                        .entry((*m, *n))
                                        .or_insert(sums);
                                    if *sum == sums {
                                        sums += height * width;
                                    }
                                    Place::Sum(*sum)
                                })
                            }
                            _ => None,
                        };
                        plan.force.push(block);
                    }
                    let range = body_range(*m);
                    let pair = |other: &std::ops::Range<usize>, table: &mut BlockTable| {
                        let i = range.clone()?;
                        (!other.is_empty()).then(|| {
                            (
                                table.find(&pattern, other.start, i.clone()),
                                table.find(&pattern, i.start, other.clone()),
                            )
                        })
                    };
                    plan.constraint.push(pair(&rows, &mut table));
                    plan.state.push(pair(&states, &mut table));
                }
                if !states.is_empty() {
                    plan.own = Some(table.find(&pattern, states.start, states));
                }
            }
            plans.push(plan);
        }
        let couplings = summed
            .into_iter()
            .map(|((i, j), markers)| {
                let (rows, columns) = (&model.bodies[i], &model.bodies[j]);
                let range = columns.velocity..columns.velocity + columns.width();
                Coupling {
                    block: table.find(&pattern, rows.velocity, range),
                    rows: i,
                    columns: j,
                    markers: markers.into_iter().map(|((m, n), at)| (m, n, at)).collect(),
                }
            })
            .collect();
        let diagonal = (0..size)
            .map(|i| pattern.block(i, i..i + 1).starts[0])
            .collect();
        MatrixPlan {
            runs: Runs::new(&pattern),
            pattern,
            table,
            bodies,
            elements: plans,
            couplings,
            sums,
            diagonal,
        }
    }

    /// Fills the unscaled matrix of a step: `∂/∂(u, y, λ)` of `[M v̇ − Q − ΣJᵀW; ẏ − f; Φ]`, with `δq = T(u) δu`,
    /// `δv = weights.velocity δu`, `δv̇ = weights.acceleration δu` and `δẏ = state_weight δy`. Exact at the gathered inputs and
    /// the wrenches of the last evaluation.
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
        dynamics.sums.clear();
        dynamics.sums.resize(self.sums, 0.0);
        dynamics.pulls.fill([0.0; 6]);
        let Dynamics {
            batches,
            scratch,
            block,
            columns,
            sums,
            pulls,
            line,
            placed,
            shapes,
            shape_at,
            pose,
            frames,
            jacobians,
            jacobian_at,
            pose_columns,
            twist_columns,
            wrenches,
            time,
            ..
        } = dynamics;
        for batch in batches.iter() {
            let class = &model.compiled.system.classes[batch.class];
            let layout = &class.layout;
            let count = layout.markers as usize;
            let rows = layout.rows as usize;
            let states = layout.states as usize;
            let length = layout.residual_len() as usize;
            let poses = 0..6 * count;
            let twists = if class.uses_twist {
                6 * count..12 * count
            } else {
                0..0
            };
            let own = 12 * count..12 * count + states;
            for pair in 0..batch.pairs.len() {
                elements::differentiate(
                    model,
                    batch,
                    pair,
                    &[poses.clone(), twists.clone(), own.clone()],
                    scratch,
                )?;
                for lane in 0..batch.lanes(pair) {
                    let index = batch.pairs[pair][lane];
                    let element = &model.elements[index];
                    let plan = &self.elements[index];
                    let tangents = &scratch.tangents[..];
                    let tangent = |direction: usize, output: usize| {
                        tangents[direction * length + output][lane]
                    };
                    for (j, marker) in element.markers.iter().enumerate() {
                        let own = &model.markers[*marker];
                        let Some(b) = own.body else {
                            continue;
                        };
                        let (width, reach) = (model.bodies[b].width(), own.reach());
                        let rows_of_own = shape_rows(own, shapes, shape_at[*marker]);
                        let at = jacobian_at[*marker];
                        let range = at..at + 6 * reach;
                        let jacobian = &jacobians[range.clone()];
                        // All outputs along this marker's reach: length × reach.
                        let columns = &mut columns[..length * reach];
                        columns.fill(0.0);
                        let seen = Along {
                            tangents,
                            lane,
                            length,
                        };
                        seen.add(6 * j, 0, &pose_columns[range.clone()], reach, columns);
                        if class.uses_twist {
                            let first = 6 * count + 6 * j;
                            seen.add(first, rows, &twist_columns[range], reach, columns);
                        }
                        if columns.iter().any(|x| !x.is_finite()) {
                            return Err(not_finite(model, index, *time));
                        }
                        if let Some((by_body, by_rows)) = plan.constraint[j] {
                            expanded(rows_of_own, &columns[..rows * reach], reach, width, line);
                            self.table.get(by_body).add(values, line, 1.0);
                            // ∂/∂λ of the wrench is −Gᵀ: Jᵀ Gᵀ, without T.
                            let block = &mut block[..rows * reach];
                            block.fill(0.0);
                            seen.add(6 * j, 0, jacobian, reach, block);
                            expanded(rows_of_own, block, reach, width, line);
                            self.table.get(by_rows).add_transposed(values, line, 1.0);
                        }
                        if let Some((by_body, by_states)) = plan.state[j] {
                            let own_rates = &columns[(rows + 6 * count) * reach..];
                            expanded(rows_of_own, own_rates, reach, width, line);
                            self.table.get(by_body).add(values, line, -1.0);
                            let block = &mut block[..states * reach];
                            block.fill(0.0);
                            for (s, row) in block.chunks_exact_mut(reach).enumerate() {
                                for (d, jacobian) in jacobian.chunks_exact(reach).enumerate() {
                                    let g = tangent(12 * count + s, rows + 6 * j + d);
                                    add_scaled(row, g, jacobian);
                                }
                            }
                            expanded(rows_of_own, block, reach, width, line);
                            self.table.get(by_states).add_transposed(values, line, -1.0);
                        }
                        for (i, other) in element.markers.iter().enumerate() {
                            let Some(place) = plan.force[i * count + j] else {
                                continue;
                            };
                            let height = model.markers[*other].reach();
                            let to = jacobian_at[*other];
                            let block = &mut block[..height * reach];
                            block.fill(0.0);
                            let first = (rows + 6 * i) * reach;
                            add_product_of_six(
                                block,
                                &jacobians[to..to + 6 * height],
                                &columns[first..first + 6 * reach],
                            );
                            self.put(place, block, values, sums);
                        }
                        // The chain's own second-order term: the frozen wrench turns with the body.
                        if let Some(place) = plan.force[j * count + j] {
                            let frame = frame_of(pose, frames, &model.bodies[b], b);
                            let placed = match &placed[*marker] {
                                Some((placed, _)) => *placed,
                                None => Placed::new(&frame, own),
                            };
                            let block = &mut block[..reach * reach];
                            chain::force_by_pose(
                                &frame.rotation,
                                &placed,
                                &wrenches[element.wrench + 6 * j..element.wrench + 6 * j + 6],
                                block,
                            );
                            chain::turn_columns(block, reach, reach, &turn(b));
                            self.put(place, block, values, sums);
                            if reach == CURVED_REACH {
                                let wrench = &wrenches[element.wrench + 6 * j..];
                                for (w, row) in wrench.iter().zip(jacobian.chunks_exact(reach)) {
                                    add_scaled(&mut pulls[*marker], *w, &row[6..]);
                                }
                            }
                        }
                    }
                    if let Some(place) = plan.own {
                        let block = &mut block[..states * states];
                        for r in 0..states {
                            for s in 0..states {
                                block[r * states + s] =
                                    tangent(12 * count + s, rows + 6 * count + r);
                            }
                        }
                        if block.iter().any(|x| !x.is_finite()) {
                            return Err(not_finite(model, index, *time));
                        }
                        self.table.get(place).add(values, block, -1.0);
                    }
                }
            }
        }
        for coupling in &self.couplings {
            let (height, width) = (
                model.bodies[coupling.rows].width(),
                model.bodies[coupling.columns].width(),
            );
            let block = &mut block[..height * width];
            block.fill(0.0);
            for (first, second, at) in &coupling.markers {
                let [left, right] = [*first, *second].map(|m| &model.markers[m]);
                let sum = &sums[*at..*at + left.reach() * right.reach()];
                let rows = shape_rows(right, shapes, shape_at[*second]);
                expanded(rows, sum, right.reach(), width, line);
                let rows = shape_rows(left, shapes, shape_at[*first]);
                expand_rows(rows, line, width, block);
                // markers of one body meet themselves once
                if let (Some(shape), true) = (&left.shape, first == second) {
                    shape.add_pull(&pulls[*first], width, 6, &mut block[6 * width..]);
                }
            }
            self.table.get(coupling.block).add(values, block, -1.0);
        }
        for k in 0..model.states {
            values[self.diagonal[model.velocities + k]] += state_weight;
        }
        Ok(())
    }

    /// An element's block between two markers, to be subtracted.
    fn put(&self, place: Place, block: &[f64], values: &mut [f64], sums: &mut [f64]) {
        match place {
            Place::Matrix(index) => self.table.get(index).add(values, block, -1.0),
            Place::Sum(at) => add_scaled(&mut sums[at..at + block.len()], 1.0, block),
        }
    }

    /// Inertia of the bodies.
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
            let block = &mut dynamics.block[..width * width];
            block.fill(0.0);
            body.add_inertia_matrix(
                &frame_of(&dynamics.pose, &dynamics.frames, body, index),
                &velocity[range.clone()],
                &acceleration[range],
                &model.gravity,
                weights,
                &turn(index),
                &mut dynamics.bending,
                block,
            );
            self.table.get(self.bodies[index]).add(values, block, 1.0);
        }
    }
}

impl Dynamics {
    /// Pose J T and twist ∂(Jv)/∂q T + weights.velocity J of each marker along its body's increment, in its reach.
    fn fill_columns(
        &mut self,
        model: &Model,
        velocity: &[f64],
        weights: Weights,
        turn: &dyn Fn(usize) -> M3,
    ) {
        for (index, marker) in model.markers.iter().enumerate() {
            let Some(b) = marker.body else { continue };
            let (placed, motion) = match &self.placed[index] {
                Some(known) => *known,
                None => {
                    let body = &model.bodies[b];
                    let frame = frame_of(&self.pose, &self.frames, body, b);
                    let v = &velocity[body.velocity..];
                    (Placed::new(&frame, marker), Motion::new(&frame, marker, v))
                }
            };
            let reach = placed.reach();
            let range = self.jacobian_at[index]..self.jacobian_at[index] + 6 * reach;
            let t = turn(b);
            let pose = &mut self.pose_columns[range.clone()];
            pose.copy_from_slice(&self.jacobians[range.clone()]);
            chain::turn_columns(pose, 6, reach, &t);
            let twist = &mut self.twist_columns[range.clone()];
            chain::twist_by_pose(&self.frames[b].1, &placed, &motion, twist);
            chain::turn_columns(twist, 6, reach, &t);
            add_scaled(twist, weights.velocity, &self.jacobians[range]);
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
    /// `out += ∂(outputs from `from` on)/∂(six directions from `first` on) · six rows`, rows of `reach` numbers.
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
fn expanded(shape: &[f64], block: &[f64], reach: usize, width: usize, line: &mut Vec<f64>) {
    line.clear();
    line.resize(block.len() / reach * width, 0.0);
    chain::expand(shape, block, reach, width, line);
}

/// Rows of a marker's reach, `width` long each, added to the rows of its body's velocities. No force acts along the numbers
/// beyond the twelfth.
fn expand_rows(shape: &[f64], block: &[f64], width: usize, out: &mut [f64]) {
    let (rigid, modal) = block.split_at(6 * width);
    let (rigid_out, modal_out) = out.split_at_mut(6 * width);
    add_scaled(rigid_out, 1.0, rigid);
    let six = 6 * (modal_out.len() / width);
    if let (Some(rows), Some(modal)) = (shape.get(..six), modal.get(..6 * width)) {
        add_product_of_six(modal_out, rows, modal);
    }
}
