//! Constraints at velocity and acceleration level: their gradients, Φ̇ and γ.

use super::{Dynamics, shape_rows};
use crate::chain::{self, CURVED_REACH, Motion};
use crate::elements::{self, not_finite};
use crate::error::RuntimeError;
use crate::model::{ElementModel, Model};
use eng_system::code::Function;
use eng_system::dense::{add_scaled, dot};

/// Each marker of a dynamic element with constraints: the element, the marker, the element's rows, and where the
/// marker's derivatives of the first row are among the gradients.
fn constrained(model: &Model) -> impl Iterator<Item = (&ElementModel, usize, usize, usize)> {
    let dynamic = model.elements.iter().filter(|e| e.dynamic);
    dynamic.flat_map(move |element| {
        let rows = model.compiled.system.classes[element.class].layout.rows as usize;
        let markers = element.markers.iter().enumerate();
        markers
            .filter(move |_| rows > 0)
            .map(move |(k, marker)| (element, *marker, rows, element.gradient + 6 * k))
    })
}

impl Dynamics {
    /// Φ̇ and γ at the gathered inputs. γ needs [`Dynamics::constraint_gradients`] of the same pose.
    pub fn velocity_level(&mut self, model: &Model, velocity: &[f64]) -> Result<(), RuntimeError> {
        self.rate_level(model)?;
        self.complete_accelerations(model, velocity);
        Ok(())
    }

    /// Φ̇ at the gathered inputs, and γ without the accelerations of the markers at v̇ = 0: see
    /// [`Dynamics::complete_accelerations`].
    pub fn rate_level(&mut self, model: &Model) -> Result<(), RuntimeError> {
        for batch in &self.batches {
            let layout = model.compiled.system.classes[batch.class].layout;
            let rows = layout.rows as usize;
            if rows == 0 {
                continue;
            }
            for pair in 0..batch.pairs.len() {
                let out = &mut self.work.elements.outputs[..2 * rows];
                batch.evaluate(model, pair, Function::Velocity, self.at.time, out)?;
                for lane in 0..batch.lanes(pair) {
                    let element = &model.elements[batch.pairs[pair][lane]];
                    for i in 0..rows {
                        self.constraint_rates[element.row + i] = out[i][lane];
                        self.constraint_accelerations[element.row + i] = out[rows + i][lane];
                    }
                }
            }
        }
        Ok(())
    }

    /// Completes γ after [`Dynamics::rate_level`] of the same place: an element's γ is for zero accelerations of its
    /// markers, and those at v̇ = 0 come off. Needs [`Dynamics::constraint_gradients`] of the same pose.
    pub fn complete_accelerations(&mut self, model: &Model, velocity: &[f64]) {
        for (element, marker, rows, gradient) in constrained(model) {
            let Some(b) = model.markers[marker].body else {
                continue;
            };
            let bias = self.marker_bias(model, marker, &velocity[model.bodies[b].velocity..]);
            for i in 0..rows {
                let at = gradient + i * 6 * element.markers.len();
                let g = &self.gradients[at..at + 6];
                let share: f64 = g.iter().zip(&bias).map(|(g, x)| g * x).sum();
                self.constraint_accelerations[element.row + i] -= share;
            }
        }
    }

    /// G of every element at its markers, at the gathered inputs.
    pub fn constraint_gradients(&mut self, model: &Model) -> Result<(), RuntimeError> {
        for batch in &mut self.batches {
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
                    self.at.time,
                    &mut self.work.elements,
                )?;
                for lane in 0..batch.lanes(pair) {
                    let index = batch.pairs[pair][lane];
                    let at = model.elements[index].gradient;
                    for i in 0..rows {
                        for d in 0..columns {
                            let g = self.work.elements.tangents[d * length + i][lane];
                            if !g.is_finite() {
                                return Err(not_finite(model, index, self.at.time));
                            }
                            self.gradients[at + i * columns + d] = g;
                        }
                    }
                }
            }
        }
        Ok(())
    }

    /// J x of a marker for a vector of its body's velocities; zeros on ground.
    pub fn marker_along(&self, model: &Model, marker: usize, x: &[f64]) -> [f64; 6] {
        let model_marker = &model.markers[marker];
        let Some(body) = model_marker.body else {
            return [0.0; 6];
        };
        let reach = model_marker.reach();
        let at = self.at.jacobian_at[marker];
        let frame = self.frame(model, body);
        let along = Motion::new(&frame, model_marker, x).numbers();
        std::array::from_fn(|d| {
            let row = &self.at.jacobians[at + d * reach..at + (d + 1) * reach];
            dot(row, &along)
        })
    }

    /// J̇ v of a marker for its body's velocities `v`; zeros on ground.
    pub fn marker_bias(&self, model: &Model, marker: usize, v: &[f64]) -> [f64; 6] {
        match model.markers[marker].body {
            Some(body) => {
                let frame = self.frame(model, body);
                let placed = self.placed(model, marker, &frame);
                chain::bias(&frame, &placed, &model.markers[marker], v)
            }
            None => [0.0; 6],
        }
    }

    /// Calls `put(row, first velocity, block row)` for each row and body of the stored gradients: G J, width long.
    pub fn body_gradients(&mut self, model: &Model, mut put: impl FnMut(usize, usize, &[f64])) {
        for element in model.elements.iter().filter(|e| e.dynamic) {
            let rows = model.compiled.system.classes[element.class].rows.len();
            let columns = 6 * element.markers.len();
            for (k, marker) in element.markers.iter().enumerate() {
                let Some(b) = model.markers[*marker].body else {
                    continue;
                };
                let body = &model.bodies[b];
                let marker_model = &model.markers[*marker];
                let reach = marker_model.reach();
                let at = self.at.jacobian_at[*marker];
                for i in 0..rows {
                    let mut seen = [0.0; CURVED_REACH];
                    for d in 0..6 {
                        let g = self.gradients[element.gradient + i * columns + 6 * k + d];
                        let row = &self.at.jacobians[at + d * reach..at + (d + 1) * reach];
                        add_scaled(&mut seen, g, row);
                    }
                    self.work.line.clear();
                    self.work.line.resize(body.width(), 0.0);
                    chain::expand(
                        shape_rows(marker_model, &self.at.shapes, self.at.shape_at[*marker]),
                        &seen[..reach],
                        reach,
                        body.width(),
                        &mut self.work.line,
                    );
                    put(element.row + i, body.velocity, &self.work.line);
                }
            }
        }
    }
}
