//! Forces, constraints and their derivatives at a state.
//!
//! Marker blocks of the elements are carried to body coordinates.
//!
//! Signs: an element's wrench W is its loads minus `Gᵀλ`, with the gradients G of its constraints at its
//! markers and their multipliers λ. So `M v̇ − Q_v − Q_g − Σ JᵀW = 0` is `M v̇ + Φ_qᵀ λ = Q`, with the mass
//! M, the inertia Q_v of the velocities, gravity Q_g, the Jacobian J of each marker's twist, the gradients
//! Φ_q of all constraints in the bodies' velocities, and all other loads Q.

mod energy;
mod levels;
mod matrix;
mod plan;
mod surfaces;
mod tangents;

pub use plan::MatrixPlan;

use crate::body::{BodyFrame, BodyModel};
use crate::chain::{self, CURVED_REACH, MarkerKinematics, Motion, Placed, REACH};
use crate::elements::{self, Batch, Inputs, Replaced, Scratch};
use crate::error::RuntimeError;
use crate::field::Demand;
use crate::flexible::Work;
use crate::inputs::Signals;
use crate::memory::Memory;
use crate::model::{MarkerModel, Model};
use crate::rotation::{M3, V3};
use crate::state::State;
use eng_system::code::Function;
use eng_system::dense::add_scaled;
use eng_system::layout::InputLayout;
use surfaces::SurfaceWork;

/// Bodies and markers at one position and velocity.
#[derive(Clone, Debug)]
struct Placement {
    time: f64,
    /// Pose numbers of the bodies.
    pose: Vec<f64>,
    /// Their frames' origins and orientations.
    frames: Vec<(V3, M3)>,
    /// Poses and twists of the markers.
    markers: Vec<MarkerKinematics>,
    /// Placement of the markers in flexible bodies, and their motion with these bodies.
    placed: Vec<Option<(Placed, Motion)>>,
    /// Rows of the shapes of second order at the present position, marker after marker.
    shapes: Vec<f64>,
    shape_at: Vec<usize>,
    /// J of each marker in its reach, 6 × reach each.
    jacobians: Vec<f64>,
    jacobian_at: Vec<usize>,
    /// Amplitudes of the elastic surfaces and their rates.
    surfaces: Vec<f64>,
}

/// Memory that is reused between evaluations. Nothing in it outlives a call.
#[derive(Clone, Debug)]
struct Workspace {
    /// Memory of the element functions.
    elements: Scratch,
    /// Columns of pose and twist along the step's unknown.
    pose_columns: Vec<f64>,
    twist_columns: Vec<f64>,
    /// A block of the matrix, and all outputs of an element along a marker's reach.
    block: Vec<f64>,
    columns: Vec<f64>,
    /// Sums of the elements' blocks between markers of flexible bodies.
    sums: Vec<f64>,
    /// Loads on the marker's displacement and rotation along the shapes of second order, one marker after the
    /// other (body axes).
    pulls: Vec<[f64; 6]>,
    /// One row over a body's velocities.
    line: Vec<f64>,
    /// Memory of the flexible bodies.
    bending: Work,
    /// Wrenches and forces of shapes that are not those of the last evaluation.
    wrenches: Vec<f64>,
    shape_forces: Vec<f64>,
    /// Changes of the motion of surfaces.
    surfaces: Vec<f64>,
    /// Memory of the blocks of elastic surfaces.
    surface: SurfaceWork,
}

/// All values at one state. They change together: a caller can read them, and only an evaluation writes them.
#[derive(Clone, Debug)]
pub struct Dynamics {
    at: Placement,
    /// The inputs at the time of the placement.
    signals: Signals,
    /// Inputs of the dynamic elements.
    batches: Vec<Batch>,
    /// Numbers that their fields remember.
    memory: Memory,
    /// Constraint values (m, rad).
    constraints: Vec<f64>,
    /// Φ̇ at the given velocities.
    constraint_rates: Vec<f64>,
    /// γ of `G v̇ = γ`, at body level.
    constraint_accelerations: Vec<f64>,
    /// Wrenches of the elements on their markers.
    wrenches: Vec<f64>,
    /// Generalised forces of the shapes of elastic surfaces (N).
    shape_forces: Vec<f64>,
    /// Rates of the states.
    rates: Vec<f64>,
    /// G of each element at its markers, row-major rows × 6 markers.
    gradients: Vec<f64>,
    work: Workspace,
}

/// A body's frame from the cached origins and orientations.
fn frame_of<'a>(
    pose: &'a [f64],
    frames: &[(V3, M3)],
    body: &BodyModel,
    index: usize,
) -> BodyFrame<'a> {
    let (position, rotation) = frames[index];
    let first = body.pose + 7;
    BodyFrame {
        position,
        rotation,
        amplitudes: &pose[first..first + body.modes()],
    }
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
    let reach = model.markers.iter().map(MarkerModel::reach).max();
    let reach = reach.unwrap_or(REACH);
    width.max(reach) * width.max(rows).max(reach)
}

/// The rows that expand a marker's reach. A linear shape has its own rows. Those of other shapes are cached
/// from `at` on.
fn shape_rows<'a>(marker: &'a MarkerModel, cached: &'a [f64], at: usize) -> &'a [f64] {
    match &marker.shape {
        Some(shape) if shape.is_curved() => &cached[at..at + shape.length()],
        Some(shape) => shape.rows(),
        None => &[],
    }
}

impl Dynamics {
    /// Dynamics with the sizes of a model.
    pub fn new(model: &Model) -> Dynamics {
        let dynamic: Vec<usize> = (0..model.elements.len())
            .filter(|e| model.elements[*e].dynamic)
            .collect();
        let mut jacobian_at = Vec::with_capacity(model.markers.len());
        let mut total = 0;
        for marker in &model.markers {
            jacobian_at.push(total);
            total += marker.body.map_or(0, |_| 6 * marker.reach());
        }
        let mut shape_at = Vec::with_capacity(model.markers.len());
        let mut cached = 0;
        for marker in &model.markers {
            shape_at.push(cached);
            let curved = marker.shape.iter().filter(|shape| shape.is_curved());
            cached += curved.map(|shape| shape.length()).sum::<usize>();
        }
        let size = matrix_size(model);
        let shapes = model.surfaces.iter().map(|surface| surface.shapes).sum();
        Dynamics {
            at: Placement {
                time: 0.0,
                pose: vec![0.0; model.poses],
                frames: vec![(V3::zeros(), M3::identity()); model.bodies.len()],
                markers: model.markers.iter().map(chain::ground).collect(),
                placed: vec![None; model.markers.len()],
                shapes: vec![0.0; cached],
                shape_at,
                jacobians: vec![0.0; total],
                jacobian_at,
                surfaces: vec![0.0; 2 * shapes],
            },
            signals: Signals::new(model),
            batches: elements::batches(model, &dynamic, false),
            memory: Memory::new(model),
            constraints: vec![0.0; model.rows],
            constraint_rates: vec![0.0; model.rows],
            constraint_accelerations: vec![0.0; model.rows],
            wrenches: vec![0.0; model.wrenches],
            shape_forces: vec![0.0; shapes],
            rates: vec![0.0; model.states],
            gradients: vec![0.0; model.gradients],
            work: Workspace {
                elements: Scratch::new(model),
                pose_columns: vec![0.0; total],
                twist_columns: vec![0.0; total],
                block: vec![0.0; size],
                columns: vec![0.0; size],
                sums: Vec::new(),
                pulls: vec![[0.0; 6]; model.markers.len()],
                line: Vec::new(),
                bending: Work::default(),
                wrenches: vec![0.0; model.wrenches],
                shape_forces: vec![0.0; shapes],
                surfaces: vec![0.0; 2 * shapes],
                surface: SurfaceWork::default(),
            },
        }
    }

    /// The inputs.
    pub fn signals(&self) -> &Signals {
        &self.signals
    }

    /// The inputs, for setting them. Place the dynamics again afterwards.
    pub fn signals_mut(&mut self) -> &mut Signals {
        &mut self.signals
    }

    /// Slots that follow the inputs, at the time of the placement.
    pub fn moving(&self) -> &[f64] {
        self.signals.values()
    }

    /// Pose numbers of the placement.
    pub fn pose(&self) -> &[f64] {
        &self.at.pose
    }

    /// Numbers that fields remember.
    pub fn memory(&self) -> &Memory {
        &self.memory
    }

    /// Numbers that fields remember, for setting them. Gather again afterwards.
    pub fn memory_mut(&mut self) -> &mut Memory {
        &mut self.memory
    }

    /// Writes the memory of all fields at the gathered state, which is accepted. Their solutions are known there
    /// after an evaluation.
    pub fn keep_memory(&mut self, model: &Model) -> Result<(), RuntimeError> {
        let time = self.at.time;
        let numbers = self.memory.accept(time);
        for batch in &mut self.batches {
            batch.solve_fields(model, time, Demand::Answers, &mut self.work.elements)?;
            batch.keep_memory(model, numbers);
        }
        Ok(())
    }

    /// Replaces `numbers` by those of the fields' last solutions that give a search for a solution nearby a
    /// good beginning, such as the cavity of a film. [`Dynamics::kept`] has more of them.
    pub fn found(&self, numbers: &mut Vec<f64>) {
        numbers.clear();
        for batch in &self.batches {
            batch.found(numbers);
        }
    }

    /// Lets the next searches of the fields begin at numbers of [`Dynamics::found`].
    pub fn begin_at(&mut self, mut numbers: &[f64]) {
        for batch in &mut self.batches {
            numbers = batch.begin_at(numbers);
        }
    }

    /// All numbers on which the next searches of the fields depend: fields that take them give the same bits.
    pub fn kept(&self) -> Vec<f64> {
        let mut numbers = Vec::new();
        for batch in &self.batches {
            batch.kept(&mut numbers);
        }
        numbers
    }

    /// Lets all fields continue with numbers of [`Dynamics::kept`].
    pub fn keep(&mut self, mut numbers: &[f64]) {
        for batch in &mut self.batches {
            numbers = batch.keep(numbers);
        }
    }

    /// Poses and twists of the markers.
    pub fn markers(&self) -> &[MarkerKinematics] {
        &self.at.markers
    }

    /// Takes derivatives of elements in place of those at the gathered inputs.
    pub fn replace(&mut self, replaced: &Replaced) {
        for batch in &mut self.batches {
            batch.replace(replaced);
        }
    }

    /// The first element with a field whose derivatives differ on both sides at the evaluated state.
    pub fn undecided(&self) -> Option<usize> {
        self.batches.iter().find_map(Batch::undecided)
    }

    /// The dynamic elements with their inputs.
    pub fn batches(&self) -> &[Batch] {
        &self.batches
    }

    /// Φ (m, rad) of the last evaluation.
    pub fn constraints(&self) -> &[f64] {
        &self.constraints
    }

    /// Φ̇ (m/s, rad/s) of the last [`Dynamics::velocity_level`].
    pub fn constraint_rates(&self) -> &[f64] {
        &self.constraint_rates
    }

    /// γ of `G v̇ = γ` at body level (m/s², rad/s²), of the last [`Dynamics::velocity_level`].
    pub fn constraint_accelerations(&self) -> &[f64] {
        &self.constraint_accelerations
    }

    /// Wrenches of the elements on their markers (N, N m) of the last evaluation.
    pub fn wrenches(&self) -> &[f64] {
        &self.wrenches
    }

    /// Rates of the states of the last evaluation.
    pub fn rates(&self) -> &[f64] {
        &self.rates
    }

    /// Frame and shape of a body at the present position.
    pub fn frame(&self, model: &Model, body: usize) -> BodyFrame<'_> {
        frame_of(&self.at.pose, &self.at.frames, &model.bodies[body], body)
    }

    /// Adds the mass matrix of a body at the present position, row-major width × width.
    pub fn add_mass(&mut self, model: &Model, index: usize, out: &mut [f64]) {
        let body = &model.bodies[index];
        let frame = frame_of(&self.at.pose, &self.at.frames, body, index);
        body.add_mass(&frame, &mut self.work.bending, out);
    }

    /// Sets frames, markers and marker Jacobians.
    pub fn place(&mut self, model: &Model, time: f64, pose: &[f64], velocity: &[f64]) {
        self.place_frames(model, time, pose);
        for index in 0..model.markers.len() {
            self.place_marker(model, index, velocity);
        }
        self.place_surfaces(model, velocity);
    }

    /// Sets frames and these markers alone, for outputs that see no other.
    pub fn place_some(&mut self, model: &Model, state: &State, markers: &[usize]) {
        self.place_frames(model, state.time, &state.pose);
        for index in markers {
            self.place_marker(model, *index, &state.velocity);
        }
        self.place_surfaces(model, &state.velocity);
    }

    fn place_frames(&mut self, model: &Model, time: f64, pose: &[f64]) {
        self.at.time = time;
        self.signals.follow(model, time);
        self.at.pose.copy_from_slice(pose);
        for (cached, body) in self.at.frames.iter_mut().zip(&model.bodies) {
            let frame = body.frame(pose);
            *cached = (frame.position, frame.rotation);
        }
    }

    /// Gives the placed bodies other velocities: twists of markers, rows of curved shapes and rates of surfaces follow.
    pub fn place_velocities(&mut self, model: &Model, velocity: &[f64]) {
        for index in 0..model.markers.len() {
            self.place_velocity(model, index, velocity);
        }
        self.place_surfaces(model, velocity);
    }

    /// [`Dynamics::place_velocities`] of one marker.
    fn place_velocity(&mut self, model: &Model, index: usize, velocity: &[f64]) {
        let marker = &model.markers[index];
        let Some(b) = marker.body else {
            return;
        };
        let body = &model.bodies[b];
        let v = &velocity[body.velocity..];
        let frame = frame_of(&self.at.pose, &self.at.frames, body, b);
        let (linear, angular) = match &mut self.at.placed[index] {
            None => chain::rigid_twist(&frame.rotation, marker, v),
            Some((placed, motion)) => {
                *motion = Motion::new(&frame, marker, v);
                chain::twist(&frame.rotation, placed, motion)
            }
        };
        if let Some(shape) = &marker.shape
            && shape.is_curved()
        {
            let first = self.at.shape_at[index];
            let rows = &mut self.at.shapes[first..first + shape.length()];
            shape.fill_rows(frame.amplitudes, &v[6..body.width()], rows);
        }
        let seen = &mut self.at.markers[index];
        (seen.velocity, seen.angular_velocity) = (linear, angular);
    }

    /// Places one marker again, at the present poses and other velocities of the bodies.
    pub fn place_marker(&mut self, model: &Model, index: usize, velocity: &[f64]) {
        let marker = &model.markers[index];
        let Some(b) = marker.body else {
            self.at.markers[index] = chain::ground(marker);
            return;
        };
        let body = &model.bodies[b];
        let frame = frame_of(&self.at.pose, &self.at.frames, body, b);
        let v = &velocity[body.velocity..];
        let at = self.at.jacobian_at[index];
        let Some(shape) = &marker.shape else {
            self.at.markers[index] = chain::rigid_kinematics(&frame, marker, v);
            let (out, _) = self.at.jacobians[at..].as_chunks_mut::<6>();
            chain::rigid_jacobian(&frame, marker, out);
            return;
        };
        if shape.is_curved() {
            let first = self.at.shape_at[index];
            let rows = &mut self.at.shapes[first..first + shape.length()];
            shape.fill_rows(frame.amplitudes, &v[6..body.width()], rows);
        }
        let placed = Placed::new(&frame, marker);
        let motion = Motion::new(&frame, marker, v);
        self.at.markers[index] = chain::seen(&frame.rotation, &frame.position, &placed, &motion);
        chain::jacobian_in_reach(
            &frame.rotation,
            &placed,
            &mut self.at.jacobians[at..at + 6 * placed.reach()],
        );
        self.at.placed[index] = Some((placed, motion));
    }

    /// Placement of a marker in its body.
    fn placed(&self, model: &Model, index: usize, frame: &BodyFrame) -> Placed {
        match &self.at.placed[index] {
            Some((placed, _)) => *placed,
            None => Placed::new(frame, &model.markers[index]),
        }
    }

    /// Places the markers at a state and gathers the inputs of the dynamic elements. Without multipliers they
    /// are zero.
    pub fn set_state(&mut self, model: &Model, state: &State, multipliers: &[f64]) {
        self.place(model, state.time, &state.pose, &state.velocity);
        self.gather(model, &state.states, multipliers, &state.rotations);
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
            time: self.at.time,
            markers: &self.at.markers,
            states,
            multipliers,
            rotations,
            moving: self.signals.values(),
            memory: Some(&self.memory),
            surfaces: &self.at.surfaces,
        };
        for batch in &mut self.batches {
            elements::gather(model, batch, &from);
        }
    }

    /// The inputs of elements at a state, at whose motion the markers are placed.
    pub fn inputs_at<'a>(&'a self, state: &'a State) -> Inputs<'a> {
        Inputs {
            time: state.time,
            markers: &self.at.markers,
            states: &state.states,
            multipliers: &state.multipliers,
            rotations: &state.rotations,
            moving: self.signals.values(),
            memory: Some(&self.memory),
            surfaces: &self.at.surfaces,
        }
    }

    /// Constraint values, wrenches and rates at the gathered inputs.
    pub fn evaluate(&mut self, model: &Model) -> Result<(), RuntimeError> {
        self.evaluate_for(model, Demand::Answers)
    }

    /// The same for a demand.
    pub fn evaluate_for(&mut self, model: &Model, demand: Demand) -> Result<(), RuntimeError> {
        self.evaluate_classes(model, demand, |_| true)
    }

    /// Constraint values at the gathered inputs. Wrenches and rates of elements without constraints remain those of
    /// the evaluation before.
    pub fn evaluate_constraints(&mut self, model: &Model) -> Result<(), RuntimeError> {
        self.evaluate_classes(model, Demand::Answers, |layout| layout.rows > 0)
    }

    fn evaluate_classes(
        &mut self,
        model: &Model,
        demand: Demand,
        of: impl Fn(&InputLayout) -> bool,
    ) -> Result<(), RuntimeError> {
        self.signals.defined(model)?;
        for batch in &mut self.batches {
            if !of(&model.compiled.system.classes[batch.class].layout) {
                continue;
            }
            let scratch = &mut self.work.elements;
            batch.solve_fields(model, self.at.time, demand, scratch)?;
            batch.shape_forces(model, &mut self.shape_forces);
            let layout = model.compiled.system.classes[batch.class].layout;
            let (rows, wrenches, states) = (
                layout.rows as usize,
                6 * layout.markers as usize,
                layout.states as usize,
            );
            let length = layout.residual_len() as usize;
            for pair in 0..batch.pairs.len() {
                let out = &mut self.work.elements.outputs[..length];
                batch.evaluate(model, pair, Function::Residual, self.at.time, out)?;
                for lane in 0..batch.lanes(pair) {
                    let element = &model.elements[batch.pairs[pair][lane]];
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

    /// `out += factor (Σ Jᵀ W + Σ Ψᵀ f)` of the last evaluation.
    pub fn add_forces(&self, model: &Model, factor: f64, out: &mut [f64]) {
        self.add_wrenches(model, &self.wrenches, factor, out);
        Self::add_shape_forces(model, &self.shape_forces, factor, out);
    }

    /// `out += factor Σ Jᵀ W` of given wrenches of the elements on their markers.
    fn add_wrenches(&self, model: &Model, wrenches: &[f64], factor: f64, out: &mut [f64]) {
        for element in model.elements.iter().filter(|e| e.dynamic) {
            for (k, marker) in element.markers.iter().enumerate() {
                let Some(b) = model.markers[*marker].body else {
                    continue;
                };
                let body = &model.bodies[b];
                let marker_model = &model.markers[*marker];
                let reach = marker_model.reach();
                let at = self.at.jacobian_at[*marker];
                let wrench = &wrenches[element.wrench + 6 * k..element.wrench + 6 * k + 6];
                let jacobian = &self.at.jacobians[at..at + 6 * reach];
                if reach == 6 {
                    let mut force = [0.0; 6];
                    for (w, row) in wrench.iter().zip(jacobian.as_chunks::<6>().0) {
                        for i in 0..6 {
                            force[i] += w * row[i];
                        }
                    }
                    add_scaled(&mut out[body.velocity..body.velocity + 6], factor, &force);
                    continue;
                }
                let mut force = [0.0; CURVED_REACH];
                let force = &mut force[..reach];
                for (w, row) in wrench.iter().zip(jacobian.chunks_exact(reach)) {
                    add_scaled(force, factor * w, row);
                }
                let range = body.velocity..body.velocity + body.width();
                let rows = shape_rows(marker_model, &self.at.shapes, self.at.shape_at[*marker]);
                chain::expand(rows, force, reach, body.width(), &mut out[range]);
            }
        }
    }

    /// `out += M v̇ − Q_v − Q_g`.
    pub fn add_inertia(
        &mut self,
        model: &Model,
        velocity: &[f64],
        acceleration: &[f64],
        out: &mut [f64],
    ) {
        for (index, body) in model.bodies.iter().enumerate() {
            let range = body.velocity..body.velocity + body.width();
            body.add_inertia(
                &frame_of(&self.at.pose, &self.at.frames, body, index),
                &velocity[range.clone()],
                &acceleration[range.clone()],
                &model.gravity,
                &mut self.work.bending,
                &mut out[range],
            );
        }
    }
}
