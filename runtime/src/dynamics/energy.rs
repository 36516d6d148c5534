//! Energies of the bodies, powers of loads and constraints.

use super::{Dynamics, frame_of};
use crate::elements::{self, Batch, Scratch};
use crate::error::RuntimeError;
use crate::model::Model;
use eng_system::code::Function;
use eng_system::dense::dot;
use eng_system::layout::VELOCITY;

impl Dynamics {
    /// Kinetic energy, gravity's potential, strain energy (J), power lost in the bodies' own damping (W).
    pub fn energy(&mut self, model: &Model, velocity: &[f64]) -> [f64; 4] {
        let mut total = [0.0; 4];
        for (index, body) in model.bodies.iter().enumerate() {
            let own = body.energy(
                &frame_of(&self.at.pose, &self.at.frames, body, index),
                &velocity[body.velocity..],
                &model.gravity,
                &mut self.work.bending,
            );
            for (t, x) in total.iter_mut().zip(own) {
                *t += x;
            }
        }
        total
    }

    /// Power of the loads and of the constraints on the bodies (W) at the last evaluation. With Φ̇ = 0 the power of
    /// the constraints is `−λᵀ G twist = λᵀ Φ_t`: that of drives alone. The second form, with `Φ_t = Φ̇ − G twist`,
    /// leaves out the power of the velocities' error in the constraints.
    pub fn powers(
        &mut self,
        model: &Model,
        multipliers: &[f64],
    ) -> Result<(f64, f64), RuntimeError> {
        let (mut loads, mut constraints) = (0.0, 0.0);
        for element in model.elements.iter().filter(|e| e.dynamic) {
            for (k, marker) in element.markers.iter().enumerate() {
                let m = &self.at.markers[*marker];
                let w = &self.wrenches[element.wrench + 6 * k..element.wrench + 6 * k + 6];
                for i in 0..3 {
                    loads += w[i] * m.velocity[i] + w[3 + i] * m.angular_velocity[i];
                }
            }
        }
        for surface in &model.surfaces {
            let rates = &self.at.surfaces[surface.motion()][surface.shapes..];
            loads += dot(&self.shape_forces[surface.forces()], rates);
        }
        for batch in &self.batches {
            let class = &model.compiled.system.classes[batch.class];
            let rows = class.layout.rows as usize;
            if rows == 0 {
                continue;
            }
            for pair in 0..batch.pairs.len() {
                let inputs = batch.inputs(pair);
                let scratch = &mut self.work.elements;
                let rates = &mut scratch.tangents[..2 * rows];
                elements::call(model, batch.class, Function::Velocity, inputs, rates)?;
                // without time of its own, Φ̇ is G twist
                if class.facts.rows_over_time {
                    along_twists(model, batch, pair, scratch)?;
                } else {
                    scratch.outputs[..rows].copy_from_slice(&scratch.tangents[..rows]);
                }
                let (along, rates) = (&scratch.outputs, &scratch.tangents);
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

/// Writes the derivatives of the residual of a pair along the twists of its markers into the outputs.
fn along_twists(
    model: &Model,
    batch: &Batch,
    pair: usize,
    scratch: &mut Scratch,
) -> Result<(), RuntimeError> {
    let class = &model.compiled.system.classes[batch.class];
    let (layout, tape) = (&class.layout, class.tape as usize);
    let length = layout.residual_len() as usize;
    let inputs = batch.inputs(pair);
    let work = &mut scratch.tape[..tape + layout.directions() as usize];
    elements::call(
        model,
        batch.class,
        Function::Linearize,
        inputs,
        &mut work[..tape],
    )?;
    work[tape..].fill([0.0; 2]);
    for k in 0..layout.markers {
        let from = (layout.marker(k) + VELOCITY) as usize;
        let to = tape + layout.pose_direction(k) as usize;
        work[to..to + 6].copy_from_slice(&inputs[from..from + 6]);
    }
    let out = &mut scratch.outputs[..length];
    elements::call(model, batch.class, Function::Tangent, work, out)
}
