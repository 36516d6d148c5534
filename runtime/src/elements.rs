//! Calls of element code. Instances of a class are evaluated in pairs, and their inputs are in arrays that
//! live as long as the model.

use crate::chain::MarkerKinematics;
use crate::error::RuntimeError;
use crate::model::Model;
use eng_system::code::{ElementCode, Function, Pair};
use eng_system::layout::{InputLayout, MARKER_WIDTH};

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
}

/// A constant that follows the inputs: its place in the inputs of a batch, its lane, and its slot among those that
/// move.
#[derive(Clone, Copy, Debug)]
struct Moving {
    at: usize,
    lane: usize,
    slot: usize,
}

impl Batch {
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
        made.push(Batch {
            class: index,
            pairs,
            stride,
            inputs,
            moving,
        });
    }
    made
}

/// Writes one marker's eighteen numbers into a lane.
fn write_marker(inputs: &mut [Pair], at: usize, lane: usize, m: &MarkerKinematics) {
    for i in 0..3 {
        inputs[at + i][lane] = m.position[i];
        for j in 0..3 {
            inputs[at + 3 + 3 * i + j][lane] = m.rotation[(i, j)];
        }
        inputs[at + 12 + i][lane] = m.velocity[i];
        inputs[at + 15 + i][lane] = m.angular_velocity[i];
    }
}

/// Gathers the common inputs of every pair of a batch.
pub fn gather(model: &Model, batch: &mut Batch, from: &Inputs) {
    let layout = model.compiled.system.classes[batch.class].layout;
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
    batch: &Batch,
    pair: usize,
    directions: &[std::ops::Range<usize>],
    scratch: &mut Scratch,
) -> Result<(), RuntimeError> {
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
    for range in directions {
        for d in range.clone() {
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
    Ok(())
}
