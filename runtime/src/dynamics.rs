//! Forces, constraints and their derivatives at a state: marker blocks of the elements carried to body coordinates.
//!
//! Signs: an element's wrench is its loads minus `Gᵀλ`, so that `M v̇ − Q_v − Q_g − Σ JᵀW = 0` is
//! `M v̇ + Φ_qᵀ λ = Q`.

use crate::body::{BodyFrame, Weights};
use crate::chain::{self, MarkerKinematics};
use crate::elements::{self, Batch, Inputs, Scratch};
use crate::error::{Moment, RuntimeError};
use crate::linear::{BlockTable, Pattern, PatternBuilder};
use crate::model::Model;
use crate::rotation::{M3, V3};
use eng_system::code::Function;

/// Everything evaluated at one state, and room for it.
#[derive(Clone, Debug)]
pub struct Dynamics {
    /// Frames of the bodies.
    pub frames: Vec<BodyFrame>,
    /// Poses and twists of the markers.
    pub markers: Vec<MarkerKinematics>,
    /// Dynamic elements.
    pub batches: Vec<Batch>,
    /// Scratch of the element functions.
    pub scratch: Scratch,
    /// Constraint values (m, rad).
    pub constraints: Vec<f64>,
    /// Φ̇ at the given velocities.
    pub constraint_rates: Vec<f64>,
    /// γ of `G v̇ = γ`, at body level.
    pub constraint_accelerations: Vec<f64>,
    /// Wrenches of the elements on their markers.
    pub wrenches: Vec<f64>,
    /// Rates of the states.
    pub rates: Vec<f64>,
    /// G of each element at its markers, row-major rows × 6 markers.
    pub gradients: Vec<f64>,
    /// J of each marker, at 6 × width each.
    jacobians: Vec<f64>,
    jacobian_at: Vec<usize>,
    /// Columns of pose and twist along the step's unknown.
    pose_columns: Vec<f64>,
    twist_columns: Vec<f64>,
    block: Vec<f64>,
    columns: Vec<f64>,
    time: f64,
}

fn matrix_size(model: &Model) -> usize {
    let width = model.bodies.iter().map(|b| b.width()).max().unwrap_or(6);
    let rows = model
        .compiled
        .system
        .classes
        .iter()
        .map(|c| c.layout.residual_len() as usize)
        .max()
        .unwrap_or(6);
    width.max(6) * width.max(rows).max(6)
}

impl Dynamics {
    /// Room for a model.
    pub fn new(model: &Model) -> Dynamics {
        let dynamic: Vec<usize> = (0..model.elements.len())
            .filter(|e| model.elements[*e].dynamic)
            .collect();
        let mut jacobian_at = Vec::with_capacity(model.markers.len());
        let mut total = 0;
        for marker in &model.markers {
            jacobian_at.push(total);
            total += marker.body.map_or(0, |b| 6 * model.bodies[b].width());
        }
        let size = matrix_size(model);
        Dynamics {
            frames: vec![
                BodyFrame {
                    position: V3::zeros(),
                    rotation: M3::identity()
                };
                model.bodies.len()
            ],
            markers: model.markers.iter().map(chain::ground).collect(),
            batches: elements::batches(model, &dynamic, false),
            scratch: Scratch::new(model),
            constraints: vec![0.0; model.rows],
            constraint_rates: vec![0.0; model.rows],
            constraint_accelerations: vec![0.0; model.rows],
            wrenches: vec![0.0; model.wrenches],
            rates: vec![0.0; model.states],
            gradients: vec![0.0; model.gradients],
            jacobians: vec![0.0; total],
            jacobian_at,
            pose_columns: vec![0.0; total],
            twist_columns: vec![0.0; total],
            block: vec![0.0; size],
            columns: vec![0.0; size],
            time: 0.0,
        }
    }

    /// Sets frames, markers and marker Jacobians.
    pub fn place(&mut self, model: &Model, time: f64, pose: &[f64], velocity: &[f64]) {
        self.time = time;
        for (frame, body) in self.frames.iter_mut().zip(&model.bodies) {
            *frame = body.frame(pose);
        }
        for (index, marker) in model.markers.iter().enumerate() {
            match marker.body {
                None => self.markers[index] = chain::ground(marker),
                Some(b) => {
                    let body = &model.bodies[b];
                    self.markers[index] = chain::kinematics(
                        body,
                        &self.frames[b],
                        marker,
                        &velocity[body.velocity..],
                    );
                    let at = self.jacobian_at[index];
                    chain::jacobian(
                        body,
                        &self.frames[b],
                        marker,
                        &mut self.jacobians[at..at + 6 * body.width()],
                    );
                }
            }
        }
    }

    /// Gathers the inputs of the dynamic elements.
    pub fn gather(
        &mut self,
        model: &Model,
        states: &[f64],
        multipliers: &[f64],
        rotations: &[f64],
    ) {
        let from = Inputs {
            time: self.time,
            markers: &self.markers,
            states,
            multipliers,
            rotations,
        };
        for batch in &mut self.batches {
            elements::gather(model, batch, &from);
        }
    }

    /// Constraint values, wrenches and rates at the gathered inputs.
    pub fn evaluate(&mut self, model: &Model) -> Result<(), RuntimeError> {
        for batch in &self.batches {
            let layout = model.compiled.system.classes[batch.class].layout;
            let (rows, wrenches, states) = (
                layout.rows as usize,
                6 * layout.markers as usize,
                layout.states as usize,
            );
            let length = layout.residual_len() as usize;
            for pair in 0..batch.pairs.len() {
                let out = &mut self.scratch.outputs[..length];
                elements::call(
                    model,
                    batch.class,
                    Function::Residual,
                    batch.inputs(pair),
                    out,
                )?;
                for lane in 0..batch.lanes(pair) {
                    let index = batch.pairs[pair][lane];
                    let element = &model.elements[index];
                    if out.iter().any(|o| !o[lane].is_finite()) {
                        return Err(not_finite(model, index, self.time));
                    }
                    for i in 0..rows {
                        self.constraints[element.row + i] = out[i][lane];
                    }
                    for i in 0..wrenches {
                        self.wrenches[element.wrench + i] = out[rows + i][lane];
                    }
                    for i in 0..states {
                        self.rates[element.state + i] = out[rows + wrenches + i][lane];
                    }
                }
            }
        }
        Ok(())
    }

    /// `out += factor Σ Jᵀ W` of the last evaluation.
    pub fn add_forces(&self, model: &Model, factor: f64, out: &mut [f64]) {
        for element in model.elements.iter().filter(|e| e.dynamic) {
            for (k, marker) in element.markers.iter().enumerate() {
                let Some(b) = model.markers[*marker].body else {
                    continue;
                };
                let body = &model.bodies[b];
                let width = body.width();
                let at = self.jacobian_at[*marker];
                let wrench = &self.wrenches[element.wrench + 6 * k..element.wrench + 6 * k + 6];
                let target = &mut out[body.velocity..body.velocity + width];
                for (i, w) in wrench.iter().enumerate() {
                    let row = &self.jacobians[at + i * width..at + (i + 1) * width];
                    for (t, j) in target.iter_mut().zip(row) {
                        *t += factor * j * w;
                    }
                }
            }
        }
    }

    /// `out += M v̇ − Q_v − Q_g`.
    pub fn add_inertia(
        &self,
        model: &Model,
        velocity: &[f64],
        acceleration: &[f64],
        out: &mut [f64],
    ) {
        for (body, frame) in model.bodies.iter().zip(&self.frames) {
            let range = body.velocity..body.velocity + body.width();
            body.add_inertia(
                frame,
                &velocity[range.clone()],
                &acceleration[range.clone()],
                &model.gravity,
                &mut out[range],
            );
        }
    }

    /// Φ̇ and γ at the gathered inputs. γ needs [`Dynamics::constraint_gradients`] of the same pose.
    pub fn velocity_level(&mut self, model: &Model, velocity: &[f64]) -> Result<(), RuntimeError> {
        for batch in &self.batches {
            let layout = model.compiled.system.classes[batch.class].layout;
            let rows = layout.rows as usize;
            if rows == 0 {
                continue;
            }
            for pair in 0..batch.pairs.len() {
                let out = &mut self.scratch.outputs[..2 * rows];
                elements::call(
                    model,
                    batch.class,
                    Function::Velocity,
                    batch.inputs(pair),
                    out,
                )?;
                for lane in 0..batch.lanes(pair) {
                    let index = batch.pairs[pair][lane];
                    let element = &model.elements[index];
                    if out.iter().any(|o| !o[lane].is_finite()) {
                        return Err(not_finite(model, index, self.time));
                    }
                    for i in 0..rows {
                        self.constraint_rates[element.row + i] = out[i][lane];
                        self.constraint_accelerations[element.row + i] = out[rows + i][lane];
                    }
                    // The class's γ is for zero accelerations of the markers; those at v̇ = 0 come off.
                    let columns = 6 * element.markers.len();
                    for (k, marker) in element.markers.iter().enumerate() {
                        let Some(b) = model.markers[*marker].body else {
                            continue;
                        };
                        let body = &model.bodies[b];
                        let bias = chain::acceleration_bias(
                            body,
                            &self.frames[b],
                            &model.markers[*marker],
                            &velocity[body.velocity..],
                        );
                        for i in 0..rows {
                            let at = element.gradient + i * columns + 6 * k;
                            let g = &self.gradients[at..at + 6];
                            let share: f64 = g.iter().zip(&bias).map(|(g, x)| g * x).sum();
                            self.constraint_accelerations[element.row + i] -= share;
                        }
                    }
                }
            }
        }
        Ok(())
    }

    /// G of every element at its markers, at the gathered inputs.
    pub fn constraint_gradients(&mut self, model: &Model) -> Result<(), RuntimeError> {
        for batch in &self.batches {
            let layout = model.compiled.system.classes[batch.class].layout;
            let rows = layout.rows as usize;
            if rows == 0 {
                continue;
            }
            let columns = 6 * layout.markers as usize;
            let length = layout.residual_len() as usize;
            for pair in 0..batch.pairs.len() {
                elements::differentiate(
                    model,
                    batch,
                    pair,
                    std::slice::from_ref(&(0..columns)),
                    &mut self.scratch,
                )?;
                for lane in 0..batch.lanes(pair) {
                    let index = batch.pairs[pair][lane];
                    let at = model.elements[index].gradient;
                    for i in 0..rows {
                        for d in 0..columns {
                            let g = self.scratch.tangents[d * length + i][lane];
                            if !g.is_finite() {
                                return Err(not_finite(model, index, self.time));
                            }
                            self.gradients[at + i * columns + d] = g;
                        }
                    }
                }
            }
        }
        Ok(())
    }

    /// J of a marker on a body, row-major 6 × width.
    pub fn marker_jacobian(&self, model: &Model, marker: usize) -> Option<&[f64]> {
        let body = model.markers[marker].body?;
        let at = self.jacobian_at[marker];
        Some(&self.jacobians[at..at + 6 * model.bodies[body].width()])
    }

    /// Calls `put(row, first velocity, block row)` for each row and body of the stored gradients: G J, width long.
    pub fn body_gradients(&self, model: &Model, mut put: impl FnMut(usize, usize, &[f64])) {
        let mut line = [0.0; 6];
        let mut long = Vec::new();
        for element in model.elements.iter().filter(|e| e.dynamic) {
            let rows = model.compiled.system.classes[element.class].rows.len();
            let columns = 6 * element.markers.len();
            for (k, marker) in element.markers.iter().enumerate() {
                let Some(b) = model.markers[*marker].body else {
                    continue;
                };
                let body = &model.bodies[b];
                let width = body.width();
                let at = self.jacobian_at[*marker];
                let line: &mut [f64] = if width <= 6 {
                    &mut line[..width]
                } else {
                    long.resize(width, 0.0);
                    &mut long[..width]
                };
                for i in 0..rows {
                    line.fill(0.0);
                    for d in 0..6 {
                        let g = self.gradients[element.gradient + i * columns + 6 * k + d];
                        for (x, j) in line
                            .iter_mut()
                            .zip(&self.jacobians[at + d * width..at + (d + 1) * width])
                        {
                            *x += g * j;
                        }
                    }
                    put(element.row + i, body.velocity, line);
                }
            }
        }
    }

    /// Kinetic energy and gravity's potential (J).
    pub fn energy(&self, model: &Model, velocity: &[f64]) -> (f64, f64) {
        let mut total = (0.0, 0.0);
        for (body, frame) in model.bodies.iter().zip(&self.frames) {
            let (kinetic, potential) =
                body.energy(frame, &velocity[body.velocity..], &model.gravity);
            total.0 += kinetic;
            total.1 += potential;
        }
        total
    }

    /// Power of the loads and of the constraints on the bodies (W) at the last evaluation. With Φ̇ = 0 the constraints'
    /// is `−λᵀ G twist = λᵀ Φ_t`: that of drives alone. The second form is taken, with `Φ_t = Φ̇ − G twist`, so that what
    /// velocities miss the constraints by counts for nothing.
    pub fn powers(
        &mut self,
        model: &Model,
        multipliers: &[f64],
    ) -> Result<(f64, f64), RuntimeError> {
        let (mut loads, mut constraints) = (0.0, 0.0);
        for element in model.elements.iter().filter(|e| e.dynamic) {
            for (k, marker) in element.markers.iter().enumerate() {
                let m = &self.markers[*marker];
                let w = &self.wrenches[element.wrench + 6 * k..element.wrench + 6 * k + 6];
                for i in 0..3 {
                    loads += w[i] * m.velocity[i] + w[3 + i] * m.angular_velocity[i];
                }
            }
        }
        for batch in &self.batches {
            let class = &model.compiled.system.classes[batch.class];
            let layout = &class.layout;
            let rows = layout.rows as usize;
            if rows == 0 {
                continue;
            }
            let tape = class.tape as usize;
            let directions = layout.directions() as usize;
            let length = layout.residual_len() as usize;
            for pair in 0..batch.pairs.len() {
                let inputs = batch.inputs(pair);
                elements::call(
                    model,
                    batch.class,
                    Function::Linearize,
                    inputs,
                    &mut self.scratch.tape[..tape],
                )?;
                self.scratch.tape[tape..tape + directions].fill([0.0; 2]);
                for k in 0..layout.markers {
                    let at = layout.marker(k) as usize + 12;
                    for i in 0..6 {
                        self.scratch.tape[tape + layout.pose_direction(k) as usize + i] =
                            inputs[at + i];
                    }
                }
                elements::call(
                    model,
                    batch.class,
                    Function::Tangent,
                    &self.scratch.tape[..tape + directions],
                    &mut self.scratch.outputs[..length],
                )?;
                let along = &self.scratch.outputs[..rows];
                let rates = &mut self.scratch.tangents[..2 * rows];
                elements::call(model, batch.class, Function::Velocity, inputs, rates)?;
                for lane in 0..batch.lanes(pair) {
                    let element = &model.elements[batch.pairs[pair][lane]];
                    for i in 0..rows {
                        let multiplier = multipliers[element.row + i];
                        loads += multiplier * along[i][lane];
                        constraints += multiplier * (rates[i][lane] - along[i][lane]);
                    }
                }
            }
        }
        Ok((loads, constraints))
    }
}

/// The error for an element whose numbers are not finite.
pub fn not_finite(model: &Model, element: usize, time: f64) -> RuntimeError {
    RuntimeError::NotFinite {
        origin: model.compiled.system.elements[element].origin.clone(),
        moment: Moment {
            time,
            cycle_angle: None,
        },
    }
}

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
                &dynamics.frames[index],
                &velocity[range.clone()],
                &acceleration[range],
                &model.gravity,
                weights,
                &turn(index),
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
                &dynamics.frames[b],
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
                                &frames[b],
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
