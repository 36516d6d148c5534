//! Calls of element code.
//!
//! Instances of a class are evaluated in pairs, and their inputs are in arrays that live as long as the model.

use crate::chain::MarkerKinematics;
use crate::error::{Moment, RuntimeError, Undefined};
use crate::field::{self, Demand, LaneField, Own, Task, Trouble, Wanted};
use crate::memory::Memory;
use crate::model::Model;
use eng_system::code::{ElementCode, Function, Pair};
use eng_system::field::{KERNELS, drives};
use eng_system::layout::{ANGULAR_VELOCITY, InputLayout, MARKER_WIDTH, ROTATION, VELOCITY};
use std::collections::BTreeMap;

/// The sources of the inputs of all elements.
#[derive(Clone, Copy, Debug)]
pub struct Inputs<'a> {
    /// Time (s).
    pub time: f64,
    /// Poses and twists.
    pub markers: &'a [MarkerKinematics],
    /// States of all dynamic elements.
    pub states: &'a [f64],
    /// Multipliers of all dynamic elements; empty for zeros.
    pub multipliers: &'a [f64],
    /// Rotation references of all elements; empty for zeros.
    pub rotations: &'a [f64],
    /// Slots that follow the inputs; empty for those at the start of a run.
    pub moving: &'a [f64],
    /// Numbers that fields remember; without them fields are in balance.
    pub memory: Option<&'a Memory>,
    /// Amplitudes of elastic surfaces and their rates ([`crate::surface::SurfaceModel::motion`]); empty for zeros.
    pub surfaces: &'a [f64],
}

/// Instances of one class, two by two.
#[derive(Clone, Debug)]
pub struct Batch {
    /// Index of the class.
    pub class: usize,
    /// The elements in lanes 0 and 1. For an odd number of elements the last pair has the same element twice.
    pub pairs: Vec<[usize; 2]>,
    stride: usize,
    inputs: Vec<Pair>,
    /// Constants that follow the inputs.
    moving: Vec<Moving>,
    /// Fields of both lanes, pair after pair; empty for a class without fields. The second lane has none if it
    /// repeats the first.
    fields: Vec<Vec<LaneField>>,
    /// The part of the fields' solution that is known at the gathered state.
    solved: Solved,
    /// Whether several threads work on the fields: at least two of them have [`LARGE`] cells or more.
    shared: bool,
    /// Room for the tasks of the threads.
    tasks: Vec<Task>,
    /// Room for the numbers with which a field continues.
    kept: Vec<f64>,
    /// Derivatives of a lane of a pair in place of those at the inputs ([`Replaced`]).
    replaced: Vec<([usize; 2], Vec<f64>)>,
}

/// Derivatives of elements that take the place of those at the state itself: the index of an element, and its
/// derivatives as [`Scratch::tangents`] has them.
pub type Replaced = BTreeMap<usize, Vec<f64>>;

/// A constant that follows the inputs: its place in the inputs of a batch, its lane, and its slot among those that
/// move.
#[derive(Clone, Copy, Debug)]
struct Moving {
    at: usize,
    lane: usize,
    slot: usize,
}

/// Least number of cells of a field for which another thread saves time. A film with so many cells takes about 40 µs.
const LARGE: usize = 400;

/// Share of a field with one-sided derivatives above which its linearised equations are refused. The cells on
/// the line where a pressure ends are a smaller share. A choice: of a film of 20 cells around and more, a
/// line of cells is a twentieth, and a film at rest all of them.
const ONE_SIDED: f64 = 0.2;

/// The known part of the solution of fields at the gathered state.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Solved {
    Nothing,
    Answers,
    Slopes,
}

impl Batch {
    /// The pair and the lane of an element.
    pub fn place_of(&self, element: usize) -> Option<[usize; 2]> {
        let at = (self.pairs.as_flattened().iter()).position(|member| *member == element)?;
        Some([at / 2, at % 2])
    }

    /// Takes derivatives in place of those at the inputs.
    pub fn replace(&mut self, replaced: &Replaced) {
        let own = replaced.iter().filter_map(|(element, derivatives)| {
            Some((self.place_of(*element)?, derivatives.clone()))
        });
        self.replaced = own.collect();
    }

    /// Whether its elements have fields.
    pub fn has_fields(&self) -> bool {
        !self.fields.is_empty()
    }
    /// Number of different elements in a pair.
    pub fn lanes(&self, pair: usize) -> usize {
        let [a, b] = self.pairs[pair];
        if a == b { 1 } else { 2 }
    }
    /// Inputs of a pair.
    pub fn inputs(&self, pair: usize) -> &[Pair] {
        &self.inputs[pair * self.stride..(pair + 1) * self.stride]
    }
    /// Inputs of a pair, for writing.
    pub fn inputs_mut(&mut self, pair: usize) -> &mut [Pair] {
        &mut self.inputs[pair * self.stride..(pair + 1) * self.stride]
    }

    /// Calls a function of the class at the inputs of a pair.
    ///
    /// # Errors
    /// An element with a number that is not finite.
    pub fn evaluate(
        &self,
        model: &Model,
        pair: usize,
        function: Function,
        time: f64,
        out: &mut [Pair],
    ) -> Result<(), RuntimeError> {
        let inputs = self.inputs(pair);
        call(model, self.class, function, inputs, out)?;
        let mut lanes = 0..self.lanes(pair);
        match lanes.find(|lane| out.iter().any(|number| !number[*lane].is_finite())) {
            Some(lane) => {
                let index = self.pairs[pair][lane];
                Err(undefined(model, index, time, function, inputs, lane))
            }
            None => Ok(()),
        }
    }
}

/// Makes batches of elements, in the order of their classes.
///
/// With `outputs`, the inputs include accelerations, rates and signals.
pub fn batches(model: &Model, elements: &[usize], outputs: bool) -> Vec<Batch> {
    let system = &model.compiled.system;
    let mut made = Vec::new();
    for (index, class) in system.classes.iter().enumerate() {
        let members: Vec<usize> = elements
            .iter()
            .copied()
            .filter(|e| model.elements[*e].class == index)
            .collect();
        if members.is_empty() {
            continue;
        }
        let layout = &class.layout;
        let stride = if outputs {
            layout.outputs_len()
        } else {
            layout.len()
        } as usize;
        let pairs: Vec<[usize; 2]> = members
            .chunks(2)
            .map(|c| [c[0], *c.last().unwrap_or(&c[0])])
            .collect();
        let mut inputs = vec![[0.0; 2]; stride * pairs.len()];
        let mut moving = Vec::new();
        for (p, pair) in pairs.iter().enumerate() {
            for (lane, element) in pair.iter().enumerate() {
                for (k, constant) in model.elements[*element].constants.iter().enumerate() {
                    inputs[p * stride + layout.constant(k as u32) as usize][lane] = *constant;
                }
                for (k, slot) in &model.elements[*element].moving {
                    moving.push(Moving {
                        at: p * stride + layout.constant(*k as u32) as usize,
                        lane,
                        slot: *slot,
                    });
                }
            }
        }
        let fields = match layout.answers {
            0 => Vec::new(),
            _ => (pairs.iter())
                .flat_map(|[a, b]| {
                    let second = (a != b).then(|| lane_fields(model, *b));
                    [lane_fields(model, *a), second.unwrap_or_default()]
                })
                .collect(),
        };
        let cells = pairs.as_flattened().iter().zip(&fields);
        let cells = cells.flat_map(|(element, _)| &model.kernels[*element]);
        let large = cells.filter(|kernel| kernel.grid().cells() >= LARGE);
        made.push(Batch {
            shared: model.thread_pool.is_some() && large.count() > 1,
            tasks: Vec::new(),
            kept: Vec::new(),
            replaced: Vec::new(),
            class: index,
            pairs,
            stride,
            inputs,
            moving,
            fields,
            solved: Solved::Nothing,
        });
    }
    made
}

/// The fields of an element with memory of their own.
fn lane_fields(model: &Model, element: usize) -> Vec<LaneField> {
    let sources = &model.compiled.system.elements[element].fields;
    let kernels = &model.kernels[element];
    let mut memory = model.elements[element].memory;
    let differentiated = &model.class(element).facts.differentiated;
    let mut answer = 0;
    (sources.iter().zip(kernels).enumerate())
        .filter_map(|(field, (source, made))| {
            let kernel = KERNELS.get(source.kernel as usize)?;
            let drives: u32 = drives(kernel, source.openings)
                .map(|(_, count)| count)
                .sum();
            let own = Own {
                drives: drives as usize,
                answers: kernel.answer_count() as usize,
            };
            let read = differentiated.get(answer..).unwrap_or(&[]);
            answer += own.answers;
            let shapes = made.shapes();
            let (drives, answers) = (own.drives + 2 * shapes, own.answers + shapes);
            let surfaces = model.surfaces.iter();
            let surface = surfaces
                .enumerate()
                .find(|(_, surface)| surface.element == element && surface.field == field)
                .map(|(index, _)| index);
            let first = memory;
            memory += made.memory();
            Some(LaneField {
                memory: first,
                before: vec![0.0; made.memory()],
                since: None,
                waits: false,
                solver: made.solver(read),
                drives: vec![0.0; drives],
                answers: vec![0.0; answers],
                readings: vec![0.0; kernel.reading_count() as usize],
                is_read: false,
                slopes: vec![0.0; answers * drives],
                has_slopes: false,
                own,
                surface,
            })
        })
        .collect()
}

impl Batch {
    /// Solves the fields at the gathered state and writes the requested numbers to the inputs. Does nothing for a
    /// class without fields.
    pub fn solve_fields(
        &mut self,
        model: &Model,
        time: f64,
        demand: Demand,
        scratch: &mut Scratch,
    ) -> Result<(), RuntimeError> {
        self.solve_fields_unless(model, time, demand, &[], scratch)
    }

    /// The same, but takes the solutions of other batches ([`Batch::keep_memory`]) whose fields have the same numbers.
    pub fn solve_fields_unless(
        &mut self,
        model: &Model,
        time: f64,
        demand: Demand,
        known: &[Batch],
        scratch: &mut Scratch,
    ) -> Result<(), RuntimeError> {
        let class = self.class;
        let solved = self.solved > Solved::Nothing && demand.is_answers();
        if self.fields.is_empty() || solved {
            return Ok(());
        }
        let layout = model.compiled.system.classes[self.class].layout;
        let common = layout.len() as usize;
        let length = layout.residual_len() as usize;
        let first_drive = layout.drive(0) as usize;
        for pair in 0..self.pairs.len() {
            let out = &mut scratch.outputs[..length];
            let inputs = &mut self.inputs[pair * self.stride..][..common];
            call(model, self.class, Function::Residual, inputs, out)?;
            for (lane, element) in self.pairs[pair].into_iter().enumerate() {
                let mut drive = first_drive;
                for (at, field) in self.fields[2 * pair + lane].iter_mut().enumerate() {
                    let own = &mut field.drives[..field.own.drives];
                    for (x, number) in own.iter_mut().zip(&out[drive..]) {
                        *x = number[lane];
                    }
                    let same = field_of(known, class, element, at);
                    let same = same.filter(|same| same.is_solved_as(field));
                    field.waits = same.is_none();
                    if let Some(same) = same {
                        field.copy_from(same);
                    }
                    drive += field.own.drives;
                }
            }
        }
        self.work(model, time, Wanted::Solution(demand))?;
        for (pair, [first, second]) in self.pairs.iter().enumerate() {
            let inputs = &mut self.inputs[pair * self.stride..][..common];
            let repeated = first == second;
            for lane in 0..2 {
                let mut answer = layout.answer(0) as usize;
                let mut reading = layout.reading(0) as usize;
                for field in &self.fields[2 * pair + lane] {
                    let mut put = |at: usize, numbers: &[f64]| {
                        for (place, x) in inputs[at..].iter_mut().zip(numbers) {
                            place[lane] = *x;
                            if repeated {
                                place[1] = *x;
                            }
                        }
                    };
                    put(answer, &field.answers[..field.own.answers]);
                    put(reading, &field.readings);
                    answer += field.own.answers;
                    reading += field.readings.len();
                }
            }
        }
        self.solved = Solved::Answers;
        Ok(())
    }

    /// Solves all fields that wait. If several have no solution, the error is that of the first. The others
    /// are solved to the end. So their next solutions begin from the same cavities, and have the same bits,
    /// for any number of threads.
    fn work(&mut self, model: &Model, time: f64, wanted: Wanted) -> Result<(), RuntimeError> {
        let mut worst: Option<(usize, Trouble)> = None;
        let mut failed = |at: usize, done: Result<(), Trouble>| {
            let first = worst.as_ref().is_none_or(|(known, _)| at < *known);
            if let (Err(trouble), true) = (done, first) {
                worst = Some((at, trouble));
            }
        };
        match model.thread_pool.as_ref().filter(|_| self.shared) {
            None => {
                for (at, fields) in self.fields.iter_mut().enumerate() {
                    failed(at, field::work(fields, wanted));
                }
            }
            Some(thread_pool) => {
                let tasks = &mut self.tasks;
                for (at, fields) in self.fields.iter_mut().enumerate() {
                    if fields.iter().any(|field| field.waits) {
                        tasks.push(Task {
                            at,
                            fields: std::mem::take(fields),
                            wanted,
                            done: Ok(()),
                        });
                    }
                }
                let sent = tasks.len();
                thread_pool.work(tasks);
                let lost = tasks.len() < sent;
                for task in tasks.drain(..) {
                    self.fields[task.at] = task.fields;
                    failed(task.at, task.done);
                }
                if lost {
                    return Err(RuntimeError::Malformed {
                        what: "the solution of a field ended in a panic".into(),
                    });
                }
            }
        }
        let Some((at, trouble)) = worst else {
            return Ok(());
        };
        let mut error = not_finite(model, self.pairs[at / 2][at % 2], time);
        if let (RuntimeError::NotFinite { because, .. }, Trouble::Solver(cause)) =
            (&mut error, trouble)
        {
            *because = Some(Box::new(Undefined::Field(cause)));
        }
        Err(error)
    }

    /// Appends for each field of a lane the numbers of its last solution: its drives, the time since the
    /// beginning of the step (s; zero in balance), and its memory at that beginning.
    pub fn solved_with(&self, pair: usize, lane: usize, numbers: &mut Vec<f64>) {
        for field in self.fields.get(2 * pair + lane).into_iter().flatten() {
            numbers.extend_from_slice(&field.drives);
            numbers.push(field.since.unwrap_or(0.0));
            numbers.extend_from_slice(&field.before);
        }
    }

    /// Appends the numbers from which searches for solutions nearby begin well.
    pub fn found(&self, numbers: &mut Vec<f64>) {
        for field in self.fields.iter().flatten() {
            field.solver.found(numbers);
        }
    }

    /// Lets the next searches begin as those of the same fields in other batches do.
    pub fn begin_as(&mut self, others: &[Batch]) {
        let class = self.class;
        let elements = self.pairs.as_flattened();
        for (element, fields) in elements.iter().zip(&mut self.fields) {
            for (at, field) in fields.iter_mut().enumerate() {
                if let Some(other) = field_of(others, class, *element, at) {
                    self.kept.clear();
                    other.solver.kept(&mut self.kept);
                    field.solver.keep(&self.kept);
                }
            }
        }
    }

    /// Lets the next searches begin at such numbers, and returns those after them.
    pub fn begin_at<'n>(&mut self, mut numbers: &'n [f64]) -> &'n [f64] {
        for field in self.fields.iter_mut().flatten() {
            numbers = field.solver.begin_at(numbers);
        }
        numbers
    }

    /// Appends the numbers with which the fields continue.
    pub fn kept(&self, numbers: &mut Vec<f64>) {
        for field in self.fields.iter().flatten() {
            field.kept(numbers);
        }
    }

    /// Takes such numbers, and returns those after them.
    pub fn keep<'n>(&mut self, mut numbers: &'n [f64]) -> &'n [f64] {
        for field in self.fields.iter_mut().flatten() {
            numbers = field.keep(numbers);
        }
        numbers
    }

    /// The first element with a field whose derivatives differ on both sides at its last solution.
    pub fn undecided(&self) -> Option<usize> {
        let elements = self.pairs.iter().flatten();
        let mut fields = elements.zip(&self.fields);
        fields
            .find(|(_, fields)| fields.iter().any(|f| f.solver.undecided() > ONE_SIDED))
            .map(|(element, _)| *element)
    }

    /// Writes the memory of the fields at their last solution to its places, and reads the numbers that
    /// conditions compare.
    pub fn keep_memory(&mut self, model: &Model, numbers: &mut [f64]) {
        let read = model.compiled.system.classes[self.class]
            .facts
            .conditions_read_fields;
        for field in self.fields.iter_mut().flatten() {
            if read {
                field.solver.read(&mut field.readings, false);
                field.is_read = true;
            }
            let place = field.memory..field.memory + field.before.len();
            if let Some(place) = numbers.get_mut(place).filter(|place| !place.is_empty()) {
                field.solver.accept(place);
            }
        }
    }

    /// The derivatives of the fields' answers at the gathered state.
    fn slopes_of_fields(
        &mut self,
        model: &Model,
        time: f64,
        scratch: &mut Scratch,
    ) -> Result<(), RuntimeError> {
        if self.fields.is_empty() || self.solved == Solved::Slopes {
            return Ok(());
        }
        self.solve_fields(model, time, Demand::Answers, scratch)?;
        for field in self.fields.iter_mut().flatten() {
            field.waits = true;
        }
        self.work(model, time, Wanted::Slopes)?;
        self.solved = Solved::Slopes;
        Ok(())
    }

    /// Derivatives of the fields' answers, which may be those of an earlier state.
    fn kept_slopes_of_fields(
        &mut self,
        model: &Model,
        time: f64,
        scratch: &mut Scratch,
    ) -> Result<(), RuntimeError> {
        if self.fields.iter().flatten().all(|field| field.has_slopes) {
            return Ok(());
        }
        self.slopes_of_fields(model, time, scratch)
    }

    /// The fields of a lane, each with the numbers of its first drive and of its first answer.
    pub(crate) fn fields_of(
        &self,
        pair: usize,
        lane: usize,
    ) -> impl Iterator<Item = (&LaneField, usize, usize)> {
        let fields = self.fields.get(2 * pair + lane).into_iter().flatten();
        fields.scan((0, 0), |(drive, answer), field| {
            let found = (field, *drive, *answer);
            *drive += field.own.drives;
            *answer += field.own.answers;
            Some(found)
        })
    }

    /// The change of each answer of a lane with changes of the drives, and of the motion of all surfaces
    /// (empty for none): `put(answer, change)`.
    fn answers_along(
        &self,
        model: &Model,
        (pair, lane): (usize, usize),
        change: impl Fn(usize) -> f64,
        surfaces: &[f64],
        mut put: impl FnMut(usize, f64),
    ) {
        for (field, drive, answer) in self.fields_of(pair, lane) {
            let surface = motion_of(model, field, surfaces);
            let changes = field.changes(0, |i| change(drive + i), surface);
            for (k, sum) in changes.take(field.own.answers).enumerate() {
                put(answer + k, sum);
            }
        }
    }

    /// Writes the changes of the forces of shapes along the derivatives in `scratch.outputs`, and along the
    /// motion of the surfaces, to their places.
    pub fn shape_forces_along(
        &self,
        model: &Model,
        pair: usize,
        surfaces: &[f64],
        scratch: &Scratch,
        out: &mut [f64],
    ) {
        let first = model.compiled.system.classes[self.class].layout.drive(0) as usize;
        for lane in 0..self.lanes(pair) {
            for (field, drive, _) in self.fields_of(pair, lane) {
                let Some(surface) = field.surface else {
                    continue;
                };
                let change = |i: usize| scratch.outputs[first + drive + i][lane];
                let motion = motion_of(model, field, surfaces);
                let changes = field.changes(field.own.answers, change, motion);
                for (place, sum) in out[model.surfaces[surface].forces()]
                    .iter_mut()
                    .zip(changes)
                {
                    *place = sum;
                }
            }
        }
    }

    /// Writes the forces of the shapes of all elastic surfaces to their places.
    pub fn shape_forces(&self, model: &Model, out: &mut [f64]) {
        for field in self.fields.iter().flatten() {
            if let Some(surface) = field.surface {
                out[model.surfaces[surface].forces()].copy_from_slice(field.shape_forces());
            }
        }
    }
}

/// A field of an element in one of several batches.
fn field_of(batches: &[Batch], class: usize, element: usize, field: usize) -> Option<&LaneField> {
    let own = batches.iter().filter(|batch| batch.class == class);
    own.flat_map(|batch| batch.pairs.as_flattened().iter().zip(&batch.fields))
        .find(|(member, _)| **member == element)
        .and_then(|(_, fields)| fields.get(field))
}

/// The motion of a field's surface among that of all; empty without one.
fn motion_of<'a>(model: &Model, field: &LaneField, surfaces: &'a [f64]) -> &'a [f64] {
    let motion = field
        .surface
        .map(|surface| model.surfaces[surface].motion());
    motion.and_then(|range| surfaces.get(range)).unwrap_or(&[])
}

/// Writes one marker's eighteen numbers into a lane.
pub(crate) fn write_marker(inputs: &mut [Pair], at: usize, lane: usize, m: &MarkerKinematics) {
    let [rotation, velocity, spin] =
        [ROTATION, VELOCITY, ANGULAR_VELOCITY].map(|first| at + first as usize);
    for i in 0..3 {
        inputs[at + i][lane] = m.position[i];
        for j in 0..3 {
            inputs[rotation + 3 * i + j][lane] = m.rotation[(i, j)];
        }
        inputs[velocity + i][lane] = m.velocity[i];
        inputs[spin + i][lane] = m.angular_velocity[i];
    }
}

/// Gathers the common inputs of every pair of a batch.
pub fn gather(model: &Model, batch: &mut Batch, from: &Inputs) {
    batch.solved = Solved::Nothing;
    let layout = model.compiled.system.classes[batch.class].layout;
    for field in batch.fields.iter_mut().flatten() {
        field.is_read = false;
        let past = from.memory.filter(|_| !field.before.is_empty());
        let past = past.and_then(|all| all.past(from.time, field.memory, field.before.len()));
        field.since = past.map(|past| past.step);
        if let Some(past) = past {
            field.before.copy_from_slice(past.memory);
        }
        let motion = motion_of(model, field, from.surfaces);
        let first = field.own.drives;
        match motion.is_empty() {
            true => field.drives[first..].fill(0.0),
            false => field.drives[first..].copy_from_slice(motion),
        }
    }
    debug_assert_eq!(MARKER_WIDTH, 18);
    for moving in &batch.moving {
        if let Some(value) = from.moving.get(moving.slot) {
            batch.inputs[moving.at][moving.lane] = *value;
        }
    }
    for p in 0..batch.pairs.len() {
        let pair = batch.pairs[p];
        let inputs = &mut batch.inputs[p * batch.stride..(p + 1) * batch.stride];
        inputs[InputLayout::TIME as usize] = [from.time; 2];
        for (lane, index) in pair.iter().enumerate() {
            let element = &model.elements[*index];
            for (k, marker) in element.markers.iter().enumerate() {
                write_marker(
                    inputs,
                    layout.marker(k as u32) as usize,
                    lane,
                    &from.markers[*marker],
                );
            }
            for k in 0..layout.states {
                inputs[layout.state(k) as usize][lane] = from.states[element.state + k as usize];
            }
            for k in 0..layout.rows {
                let value = if element.dynamic && !from.multipliers.is_empty() {
                    from.multipliers[element.row + k as usize]
                } else {
                    0.0
                };
                inputs[layout.multiplier(k) as usize][lane] = value;
            }
            for k in 0..layout.rotations {
                let value = if from.rotations.is_empty() {
                    0.0
                } else {
                    from.rotations[element.rotation + k as usize]
                };
                inputs[layout.rotation(k) as usize][lane] = value;
            }
        }
    }
}

/// Calls a function of a class.
pub fn call(
    model: &Model,
    class: usize,
    function: Function,
    inputs: &[Pair],
    outputs: &mut [Pair],
) -> Result<(), RuntimeError> {
    let code: &dyn ElementCode = model.compiled.code[class].as_ref();
    if code.call(function, inputs, outputs, &model.compiled.system.tables) {
        Ok(())
    } else {
        Err(RuntimeError::Malformed {
            what: format!(
                "class {} refuses {function:?}",
                model.compiled.system.classes[class].name
            ),
        })
    }
}

/// Scratch for the functions of the largest class.
#[derive(Clone, Debug)]
pub struct Scratch {
    /// Outputs of a call.
    pub outputs: Vec<Pair>,
    /// Tape, then the seed.
    pub tape: Vec<Pair>,
    /// Derivatives: direction after direction, each as long as the residual.
    pub tangents: Vec<Pair>,
}

impl Scratch {
    /// Scratch with the sizes that the model's classes need.
    pub fn new(model: &Model) -> Scratch {
        let (mut outputs, mut tape, mut tangents) = (0, 0, 0);
        for class in &model.compiled.system.classes {
            let l = &class.layout;
            let residual = l.residual_len() as usize;
            outputs = outputs
                .max(residual)
                .max(2 * l.rows as usize)
                .max(class.outputs.len())
                .max(class.conditions.len())
                .max(l.rotations as usize);
            tape = tape.max((class.tape + l.directions()) as usize);
            tangents = tangents.max(l.directions() as usize * residual);
        }
        Scratch {
            outputs: vec![[0.0; 2]; outputs],
            tape: vec![[0.0; 2]; tape],
            tangents: vec![[0.0; 2]; tangents],
        }
    }
}

/// Fills `scratch.tangents` with the derivatives along `directions` (a range of the layout's), at the inputs
/// of a pair. Directions outside the range do not change.
pub fn differentiate(
    model: &Model,
    batch: &mut Batch,
    pair: usize,
    directions: &[std::ops::Range<usize>],
    time: f64,
    scratch: &mut Scratch,
) -> Result<(), RuntimeError> {
    batch.slopes_of_fields(model, time, scratch)?;
    let class = &model.compiled.system.classes[batch.class];
    let tape = class.tape as usize;
    let count = class.layout.directions() as usize;
    let length = class.layout.residual_len() as usize;
    call(
        model,
        batch.class,
        Function::Linearize,
        batch.inputs(pair),
        &mut scratch.tape[..tape],
    )?;
    scratch.tape[tape..tape + count].fill([0.0; 2]);
    let layout = class.layout;
    let answers = layout.answer_direction(0) as usize..count;
    for range in directions.iter().chain([&answers]) {
        for d in range.clone() {
            let answer = d.checked_sub(answers.start);
            if answer.is_some_and(|answer| class.facts.differentiated.get(answer) == Some(&false)) {
                // nothing follows this answer
                scratch.tangents[d * length..(d + 1) * length].fill([0.0; 2]);
                continue;
            }
            scratch.tape[tape + d] = [1.0; 2];
            call(
                model,
                batch.class,
                Function::Tangent,
                &scratch.tape[..tape + count],
                &mut scratch.tangents[d * length..(d + 1) * length],
            )?;
            scratch.tape[tape + d] = [0.0; 2];
        }
    }
    // by the chain rule, answers follow the drives
    let (drive, length) = (layout.drive(0) as usize, length);
    let (by_motion, by_answers) = scratch.tangents.split_at_mut(answers.start * length);
    let lanes = if answers.is_empty() {
        0
    } else {
        batch.lanes(pair)
    };
    for lane in 0..lanes {
        for d in directions.iter().cloned().flatten() {
            let (outputs, drives) = by_motion[d * length..(d + 1) * length].split_at_mut(drive);
            let change = |i: usize| drives[i][lane];
            batch.answers_along(model, (pair, lane), change, &[], |answer, sum| {
                let slopes = &by_answers[answer * length..];
                for (output, slope) in outputs.iter_mut().zip(slopes) {
                    output[lane] += slope[lane] * sum;
                }
            });
        }
    }
    for ([of, lane], derivatives) in &batch.replaced {
        for (number, replaced) in scratch.tangents.iter_mut().zip(derivatives) {
            if *of == pair {
                number[*lane] = *replaced;
            }
        }
    }
    Ok(())
}

/// Calls [`Function::Tangent`] with the seeds that `scratch` has after its tape, at the inputs of a pair, and
/// with changes of the motion of all surfaces. Writes the derivatives to `scratch.outputs`. Those of fields may be
/// of an earlier state.
pub fn differentiate_along(
    model: &Model,
    batch: &mut Batch,
    pair: usize,
    time: f64,
    surfaces: &[f64],
    scratch: &mut Scratch,
) -> Result<(), RuntimeError> {
    batch.kept_slopes_of_fields(model, time, scratch)?;
    let class = &model.compiled.system.classes[batch.class];
    let layout = class.layout;
    let (tape, count) = (class.tape as usize, layout.directions() as usize);
    let length = layout.residual_len() as usize;
    let inputs = batch.inputs(pair);
    call(
        model,
        batch.class,
        Function::Linearize,
        inputs,
        &mut scratch.tape[..tape],
    )?;
    let tangent = |scratch: &mut Scratch| {
        let seeds = &scratch.tape[..tape + count];
        let out = &mut scratch.outputs[..length];
        call(model, batch.class, Function::Tangent, seeds, out)
    };
    tangent(scratch)?;
    if layout.answers == 0 {
        return Ok(());
    }
    let drive = layout.drive(0) as usize;
    let first = tape + layout.answer_direction(0) as usize;
    for lane in 0..batch.lanes(pair) {
        let (seeds, outputs) = (&mut scratch.tape, &scratch.outputs);
        let change = |i: usize| outputs[drive + i][lane];
        batch.answers_along(model, (pair, lane), change, surfaces, |answer, sum| {
            seeds[first + answer][lane] = sum;
        });
    }
    tangent(scratch)
}

/// The error of an element that gives no number. It names a table that the element's function evaluates
/// outside its points.
pub fn undefined(
    model: &Model,
    element: usize,
    time: f64,
    function: Function,
    inputs: &[Pair],
    lane: usize,
) -> RuntimeError {
    let mut error = not_finite(model, element, time);
    let compiled = &model.compiled;
    let code = compiled
        .system
        .elements
        .get(element)
        .and_then(|e| compiled.code.get(e.class as usize));
    if let (RuntimeError::NotFinite { because, .. }, Some(code)) = (&mut error, code) {
        let [first, second] = code.outside(function, inputs, &compiled.system.tables);
        let outside = if lane == 0 { first } else { second };
        *because = outside.map(|outside| Box::new(Undefined::Table(outside)));
    }
    error
}

/// The error for an element whose numbers are not finite.
pub fn not_finite(model: &Model, element: usize, time: f64) -> RuntimeError {
    RuntimeError::NotFinite {
        origin: Box::new(model.compiled.system.elements[element].origin.clone()),
        because: None,
        moment: Moment {
            time,
            cycle_angle: None,
        },
    }
}
