//! Outputs, conditions and unwrapped angles of elements at a state.

use crate::dynamics::Dynamics;
use crate::elements::{self, Batch, Inputs, Scratch, not_finite, undefined};
use crate::error::RuntimeError;
use crate::field::Demand;
use crate::model::Model;
use crate::state::State;
use eng_system::code::Function;
use eng_system::system::ConditionKind;
use std::collections::BTreeSet;

/// Outputs of some elements, in an order in which each element comes after those whose channels it reads.
#[derive(Clone, Debug)]
pub struct Outputs {
    levels: Vec<Vec<Batch>>,
    /// The markers of the elements, in order.
    markers: Vec<usize>,
    /// The elements with fields, in order: element, level, batch, pair, lane.
    fields: Vec<[usize; 5]>,
    scratch: Scratch,
    /// Accelerations of `markers`, at the places of the model's markers.
    accelerations: Vec<[f64; 6]>,
    /// Channels of each element: (output, channel).
    channels: Vec<Vec<(usize, usize)>>,
    /// Values of the channels. Those of other elements are NaN.
    pub values: Vec<f64>,
    watched: Option<usize>,
    /// First two outputs of the watched element.
    pub watched_values: [f64; 2],
    /// Further outputs, which may have no channel: element and output.
    follows: Vec<(usize, usize)>,
    /// Their values.
    pub followed: Vec<f64>,
}

impl Outputs {
    /// Outputs for all channels of the model.
    pub fn all(model: &Model) -> Result<Outputs, RuntimeError> {
        let system = &model.compiled.system;
        let wanted: BTreeSet<usize> = system.channels.iter().map(|c| c.element as usize).collect();
        Outputs::of(model, wanted, None)
    }

    /// The outputs of some elements, and those that they need.
    pub fn of_elements(
        model: &Model,
        elements: impl IntoIterator<Item = usize>,
    ) -> Result<Outputs, RuntimeError> {
        Outputs::of(model, elements.into_iter().collect(), None)
    }

    /// The outputs of one element, and those that it needs.
    pub fn watching(model: &Model, element: usize) -> Result<Outputs, RuntimeError> {
        Outputs::of(model, BTreeSet::from([element]), Some(element))
    }

    /// Some outputs (element and output), and those that they need.
    pub fn following(model: &Model, follows: Vec<(usize, usize)>) -> Result<Outputs, RuntimeError> {
        let elements = follows.iter().map(|(element, _)| *element).collect();
        Ok(Outputs {
            followed: vec![f64::NAN; follows.len()],
            follows,
            ..Outputs::of(model, elements, None)?
        })
    }

    fn of(
        model: &Model,
        wanted: BTreeSet<usize>,
        watched: Option<usize>,
    ) -> Result<Outputs, RuntimeError> {
        let system = &model.compiled.system;
        let mut level: Vec<Option<usize>> = vec![None; model.elements.len()];
        let mut open = vec![false; model.elements.len()];
        // depth first over the signals; the stack has the elements whose signals are not all in order yet
        for root in wanted {
            let mut stack = vec![root];
            while let Some(&element) = stack.last() {
                if level[element].is_some() {
                    stack.pop();
                    continue;
                }
                let mut height = 0;
                let mut waiting = false;
                for signal in &system.elements[element].signals {
                    let source = system.channels[*signal as usize].element as usize;
                    match level[source] {
                        Some(l) => height = height.max(l + 1),
                        None => {
                            if open[source] || source == element {
                                return Err(RuntimeError::Malformed {
                                    what: format!(
                                        "{}: outputs read each other",
                                        system.elements[element].origin.path
                                    ),
                                });
                            }
                            stack.push(source);
                            waiting = true;
                        }
                    }
                }
                open[element] = true;
                if !waiting {
                    level[element] = Some(height);
                    stack.pop();
                }
            }
        }
        let highest = level.iter().flatten().max().copied();
        let levels: Vec<Vec<Batch>> = (0..highest.map_or(0, |h| h + 1))
            .map(|l| {
                let members: Vec<usize> =
                    (0..level.len()).filter(|e| level[*e] == Some(l)).collect();
                elements::batches(model, &members, true)
            })
            .collect();
        let mut channels = vec![Vec::new(); model.elements.len()];
        for (index, channel) in system.channels.iter().enumerate() {
            channels[channel.element as usize].push((channel.output as usize, index));
        }
        let markers: BTreeSet<usize> = (0..level.len())
            .filter(|element| level[*element].is_some())
            .flat_map(|element| model.elements[element].markers.iter().copied())
            .collect();
        Ok(Outputs {
            fields: with_fields(&levels),
            levels,
            markers: markers.into_iter().collect(),
            scratch: Scratch::new(model),
            accelerations: vec![[0.0; 6]; model.markers.len()],
            channels,
            values: vec![f64::NAN; system.channels.len()],
            watched,
            watched_values: [0.0; 2],
            follows: Vec::new(),
            followed: Vec::new(),
        })
    }

    /// The numbers with which the fields of the elements were solved at the last evaluation, element by element: see
    /// [`Batch::solved_with`].
    pub fn fields(&self) -> Vec<f64> {
        let mut numbers = Vec::new();
        for [_, level, batch, pair, lane] in &self.fields {
            self.levels[*level][*batch].solved_with(*pair, *lane, &mut numbers);
        }
        numbers
    }

    /// The markers that the outputs read.
    pub fn markers(&self) -> &[usize] {
        &self.markers
    }

    /// Evaluates the outputs at a state. `dynamics` must have placed their markers there.
    pub fn evaluate(
        &mut self,
        model: &Model,
        dynamics: &Dynamics,
        state: &State,
    ) -> Result<(), RuntimeError> {
        for &index in &self.markers {
            let Some(b) = model.markers[index].body else {
                continue;
            };
            let body = &model.bodies[b];
            let range = body.velocity..body.velocity + body.width();
            let mut x = dynamics.marker_bias(model, index, &state.velocity[range.clone()]);
            let along = dynamics.marker_along(model, index, &state.acceleration[range]);
            for (x, a) in x.iter_mut().zip(along) {
                *x += a;
            }
            self.accelerations[index] = x;
        }
        let from = dynamics.inputs_at(state);
        for batches in &mut self.levels {
            for batch in batches {
                elements::gather(model, batch, &from);
                batch.begin_as(dynamics.batches());
                batch.solve_fields(model, state.time, Demand::Readings, &mut self.scratch)?;
                let class = &model.compiled.system.classes[batch.class];
                let layout = class.layout;
                let count = class.outputs.len();
                for pair in 0..batch.pairs.len() {
                    let members = batch.pairs[pair];
                    let inputs = batch.inputs_mut(pair);
                    for (lane, index) in members.iter().enumerate() {
                        let element = &model.elements[*index];
                        for (k, marker) in element.markers.iter().enumerate() {
                            let at = layout.acceleration(k as u32) as usize;
                            for (i, x) in self.accelerations[*marker].iter().enumerate() {
                                inputs[at + i][lane] = *x;
                            }
                        }
                        for k in 0..layout.states {
                            inputs[layout.state_rate(k) as usize][lane] =
                                state.rates[element.state + k as usize];
                        }
                        let signals = &model.compiled.system.elements[*index].signals;
                        for (k, signal) in signals.iter().enumerate() {
                            inputs[layout.signal(k as u32) as usize][lane] =
                                self.values[*signal as usize];
                        }
                    }
                    if count == 0 {
                        continue;
                    }
                    elements::call(
                        model,
                        batch.class,
                        Function::Outputs,
                        batch.inputs(pair),
                        &mut self.scratch.outputs[..count],
                    )?;
                    for lane in 0..batch.lanes(pair) {
                        let index = members[lane];
                        for (output, channel) in &self.channels[index] {
                            let value = self.scratch.outputs[*output][lane];
                            if !value.is_finite() {
                                let inputs = batch.inputs(pair);
                                return Err(undefined(
                                    model,
                                    index,
                                    state.time,
                                    Function::Outputs,
                                    inputs,
                                    lane,
                                ));
                            }
                            self.values[*channel] = value;
                        }
                        for ((element, output), value) in
                            self.follows.iter().zip(&mut self.followed)
                        {
                            if *element == index {
                                *value = self.scratch.outputs[*output][lane];
                            }
                        }
                        if self.watched == Some(index) && count >= 2 {
                            self.watched_values =
                                [self.scratch.outputs[0][lane], self.scratch.outputs[1][lane]];
                        }
                    }
                }
            }
        }
        Ok(())
    }
}

/// The places of the elements with fields, in the order of the elements.
fn with_fields(levels: &[Vec<Batch>]) -> Vec<[usize; 5]> {
    let mut places = Vec::new();
    for (level, batches) in levels.iter().enumerate() {
        for (at, batch) in batches.iter().enumerate().filter(|(_, b)| b.has_fields()) {
            for (pair, elements) in batch.pairs.iter().enumerate() {
                for (lane, element) in elements.iter().enumerate().take(batch.lanes(pair)) {
                    places.push([*element, level, at, pair, lane]);
                }
            }
        }
    }
    places.sort_unstable();
    places
}

/// A failed condition.
#[derive(Clone, Debug, PartialEq)]
pub struct Violation {
    /// The element.
    pub element: usize,
    /// Index into its class's conditions.
    pub condition: usize,
    /// The value that should be positive.
    pub value: f64,
}

/// Conditions and rotations of elements.
#[derive(Clone, Debug)]
pub struct Watch {
    conditions: Vec<Batch>,
    rotations: Vec<Batch>,
    scratch: Scratch,
}

impl Watch {
    /// Watches the elements that fulfil `which`.
    pub fn new(model: &Model, which: impl Fn(usize) -> bool) -> Watch {
        let pick = |wanted: &dyn Fn(usize) -> bool| -> Vec<usize> {
            (0..model.elements.len())
                .filter(|e| which(*e) && wanted(*e))
                .collect()
        };
        Watch {
            conditions: elements::batches(
                model,
                &pick(&|e| !model.class(e).conditions.is_empty()),
                false,
            ),
            rotations: elements::batches(
                model,
                &pick(&|e| model.class(e).layout.rotations > 0),
                false,
            ),
            scratch: Scratch::new(model),
        }
    }

    /// Reports each condition of `which` that is not positive, with a function for the values of all entries
    /// of its class's conditions. NaN counts as a failure. Fields that `solved` has at the same numbers are
    /// not solved again.
    pub fn violations(
        &mut self,
        model: &Model,
        from: &Inputs,
        solved: &[Batch],
        which: impl Fn(&ConditionKind) -> bool,
        mut report: impl FnMut(Violation, &dyn Fn(usize) -> f64),
    ) -> Result<(), RuntimeError> {
        for batch in &mut self.conditions {
            elements::gather(model, batch, from);
            let class = &model.compiled.system.classes[batch.class];
            if class.facts.conditions_read_fields {
                let (time, scratch) = (from.time, &mut self.scratch);
                batch.solve_fields_unless(model, time, Demand::Conditions, solved, scratch)?;
            }
            let conditions = &class.conditions;
            for pair in 0..batch.pairs.len() {
                let out = &mut self.scratch.outputs[..conditions.len()];
                elements::call(
                    model,
                    batch.class,
                    Function::Conditions,
                    batch.inputs(pair),
                    out,
                )?;
                for lane in 0..batch.lanes(pair) {
                    for (k, condition) in conditions.iter().enumerate() {
                        let value = out[k][lane];
                        if which(&condition.kind)
                            && !matches!(value.partial_cmp(&0.0), Some(std::cmp::Ordering::Greater))
                        {
                            report(
                                Violation {
                                    element: batch.pairs[pair][lane],
                                    condition: k,
                                    value,
                                },
                                &|entry| out.get(entry).map_or(f64::NAN, |pair| pair[lane]),
                            );
                        }
                    }
                }
            }
        }
        Ok(())
    }

    /// Unwrapped angles at the inputs. The references in the inputs are those of the state before.
    pub fn unwrap(
        &mut self,
        model: &Model,
        from: &Inputs,
        rotations: &mut [f64],
    ) -> Result<(), RuntimeError> {
        for batch in &mut self.rotations {
            elements::gather(model, batch, from);
            let count = model.compiled.system.classes[batch.class].layout.rotations as usize;
            for pair in 0..batch.pairs.len() {
                let out = &mut self.scratch.outputs[..count];
                elements::call(
                    model,
                    batch.class,
                    Function::Rotations,
                    batch.inputs(pair),
                    out,
                )?;
                for lane in 0..batch.lanes(pair) {
                    let index = batch.pairs[pair][lane];
                    for (k, angle) in out.iter().enumerate() {
                        if !angle[lane].is_finite() {
                            return Err(not_finite(model, index, from.time));
                        }
                        rotations[model.elements[index].rotation + k] = angle[lane];
                    }
                }
            }
        }
        Ok(())
    }
}
