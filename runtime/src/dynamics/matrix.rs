//! The exact matrix of a step: where its blocks lie, and how they are filled.

use super::{Dynamics, frame_of, not_finite};
use crate::body::Weights;
use crate::chain;
use crate::elements;
use crate::error::RuntimeError;
use crate::linear::{BlockTable, Pattern, PatternBuilder};
use crate::model::Model;
use crate::rotation::V3;

/// Where the blocks of the step's matrix lie. Unknowns: velocities' increments, states, multipliers.
#[derive(Clone, Debug)]
pub struct MatrixPlan {
    /// The pattern.
    pub pattern: Pattern,
    table: BlockTable,
    bodies: Vec<usize>,
    /// Blocks of each dynamic element, in the order in which [`MatrixPlan::fill`] visits them.
    elements: Vec<ElementPlan>,
    diagonal: Vec<usize>,
}

#[derive(Clone, Debug, Default)]
struct ElementPlan {
    /// markers × markers, where both are on bodies.
    force: Vec<Option<usize>>,
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
        for (index, element) in model.elements.iter().enumerate() {
            let mut plan = ElementPlan::default();
            if element.dynamic {
                let (rows, states) = ranges(index);
                for m in &element.markers {
                    for n in &element.markers {
                        let block = match (body_range(*m), body_range(*n)) {
                            (Some(i), Some(j)) if loads(index) => {
                                Some(table.find(&pattern, i.start, j))
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
        let diagonal = (0..size)
            .map(|i| pattern.block(i, i..i + 1).starts[0])
            .collect();
        MatrixPlan {
            pattern,
            table,
            bodies,
            elements: plans,
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
        // Pose J T and twist ∂(Jv)/∂q T + weights.velocity J of each marker along its body's increment.
        for (index, marker) in model.markers.iter().enumerate() {
            let Some(b) = marker.body else { continue };
            let body = &model.bodies[b];
            let width = body.width();
            let range = dynamics.jacobian_at[index]..dynamics.jacobian_at[index] + 6 * width;
            let t = turn(b);
            let pose = &mut dynamics.pose_columns[range.clone()];
            pose.copy_from_slice(&dynamics.jacobians[range.clone()]);
            chain::turn_columns(pose, 6, width, &t);
            let twist = &mut dynamics.twist_columns[range.clone()];
            chain::twist_by_pose(
                body,
                &frame_of(&dynamics.pose, &dynamics.frames, body, b),
                marker,
                &velocity[body.velocity..],
                twist,
            );
            chain::turn_columns(twist, 6, width, &t);
            for (x, j) in twist.iter_mut().zip(&dynamics.jacobians[range]) {
                *x += weights.velocity * j;
            }
        }
        let Dynamics {
            batches,
            scratch,
            block,
            columns,
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
                    let tangent = |direction: usize, output: usize| {
                        scratch.tangents[direction * length + output][lane]
                    };
                    for (j, marker) in element.markers.iter().enumerate() {
                        let Some(b) = model.markers[*marker].body else {
                            continue;
                        };
                        let width = model.bodies[b].width();
                        let at = jacobian_at[*marker];
                        // All outputs along this body's increment: length × width.
                        let columns = &mut columns[..length * width];
                        columns.fill(0.0);
                        for d in 0..6 {
                            let pose = &pose_columns[at + d * width..at + (d + 1) * width];
                            for o in 0..length {
                                let g = tangent(6 * j + d, o);
                                if g != 0.0 {
                                    for (x, p) in
                                        columns[o * width..(o + 1) * width].iter_mut().zip(pose)
                                    {
                                        *x += g * p;
                                    }
                                }
                            }
                            if class.uses_twist {
                                let twist = &twist_columns[at + d * width..at + (d + 1) * width];
                                for o in rows..length {
                                    let g = tangent(6 * count + 6 * j + d, o);
                                    if g != 0.0 {
                                        for (x, p) in columns[o * width..(o + 1) * width]
                                            .iter_mut()
                                            .zip(twist)
                                        {
                                            *x += g * p;
                                        }
                                    }
                                }
                            }
                        }
                        if columns.iter().any(|x| !x.is_finite()) {
                            return Err(not_finite(model, index, *time));
                        }
                        if let Some((by_body, _)) = plan.constraint[j] {
                            self.table
                                .get(by_body)
                                .add(values, &columns[..rows * width], 1.0);
                        }
                        if let Some((by_body, _)) = plan.state[j] {
                            self.table.get(by_body).add(
                                values,
                                &columns[(rows + 6 * count) * width..],
                                -1.0,
                            );
                        }
                        for (i, other) in element.markers.iter().enumerate() {
                            let Some(place) = plan.force[i * count + j] else {
                                continue;
                            };
                            let Some(c) = model.markers[*other].body else {
                                continue;
                            };
                            let height = model.bodies[c].width();
                            let to = jacobian_at[*other];
                            let block = &mut block[..height * width];
                            block.fill(0.0);
                            for d in 0..6 {
                                let wrench = &columns
                                    [(rows + 6 * i + d) * width..(rows + 6 * i + d + 1) * width];
                                let jacobian = &jacobians[to + d * height..to + (d + 1) * height];
                                for (r, g) in jacobian.iter().enumerate() {
                                    if *g != 0.0 {
                                        for (x, w) in
                                            block[r * width..(r + 1) * width].iter_mut().zip(wrench)
                                        {
                                            *x += g * w;
                                        }
                                    }
                                }
                            }
                            self.table.get(place).add(values, block, -1.0);
                        }
                        // The chain's own second-order term: the frozen wrench turns with the body.
                        if let Some(place) = plan.force[j * count + j] {
                            let block = &mut block[..width * width];
                            chain::force_by_pose(
                                &model.bodies[b],
                                &frame_of(pose, frames, &model.bodies[b], b),
                                &model.markers[*marker],
                                &wrenches[element.wrench + 6 * j..element.wrench + 6 * j + 6],
                                block,
                            );
                            let v = model.bodies[b].velocity + 3;
                            let t = crate::rotation::tangent(&V3::new(
                                increment[v],
                                increment[v + 1],
                                increment[v + 2],
                            ));
                            chain::turn_columns(block, width, width, &t);
                            self.table.get(place).add(values, block, -1.0);
                        }
                        // ∂/∂λ of the wrench is −Gᵀ: rows of Jᵀ Gᵀ, without T.
                        if let Some((_, by_rows)) = plan.constraint[j] {
                            let block = &mut block[..width * rows];
                            block.fill(0.0);
                            for d in 0..6 {
                                let jacobian = &jacobians[at + d * width..at + (d + 1) * width];
                                for r in 0..rows {
                                    let g = tangent(6 * j + d, r);
                                    if g != 0.0 {
                                        for (w, x) in jacobian.iter().enumerate() {
                                            block[w * rows + r] += g * x;
                                        }
                                    }
                                }
                            }
                            self.table.get(by_rows).add(values, block, 1.0);
                        }
                        if let Some((_, by_states)) = plan.state[j] {
                            let block = &mut block[..width * states];
                            block.fill(0.0);
                            for d in 0..6 {
                                let jacobian = &jacobians[at + d * width..at + (d + 1) * width];
                                for s in 0..states {
                                    let g = tangent(12 * count + s, rows + 6 * j + d);
                                    for (w, x) in jacobian.iter().enumerate() {
                                        block[w * states + s] += g * x;
                                    }
                                }
                            }
                            self.table.get(by_states).add(values, block, -1.0);
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
        for k in 0..model.states {
            values[self.diagonal[model.velocities + k]] += state_weight;
        }
        Ok(())
    }
}
