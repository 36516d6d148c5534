//! Derivatives of constraints and loads along a vector of body velocities, and those of the loads alone.

use super::Dynamics;
use crate::elements;
use crate::error::RuntimeError;
use crate::model::{ElementModel, Model};
use eng_system::code::Pair;
use eng_system::layout::InputLayout;
use eng_system::system::ElementClass;
use nalgebra::DMatrix;

impl Dynamics {
    /// `G x` for a vector of body velocities, at the present place and inputs.
    pub fn constraints_along(
        &mut self,
        model: &Model,
        along: &[f64],
        out: &mut [f64],
    ) -> Result<(), RuntimeError> {
        // a constraint does not depend on a field
        self.work.surfaces.fill(0.0);
        self.tangents(
            model,
            along,
            |class| class.layout.rows > 0,
            InputLayout::pose_direction,
            |element, class, lane, tangent| {
                for (i, value) in tangent[..class.layout.rows as usize].iter().enumerate() {
                    out[element.row + i] = value[lane];
                }
            },
        )
    }

    /// `out += factor Σ Jᵀ ∂W/∂v x` for a vector x of body velocities: the response of dampers and films to a
    /// change of velocity. The slopes of films may be those of the last matrix: its factors filter the error of a step
    /// with this response, and new slopes of an elastic film cost as much as ten solutions.
    pub fn add_damping_forces(
        &mut self,
        model: &Model,
        along: &[f64],
        factor: f64,
        out: &mut [f64],
    ) -> Result<(), RuntimeError> {
        let mut wrenches = std::mem::take(&mut self.work.wrenches);
        wrenches.fill(0.0);
        self.work.shape_forces.fill(0.0);
        self.rates_along(model, along);
        let done = self.tangents(
            model,
            along,
            |class| class.facts.uses_twist,
            InputLayout::twist_direction,
            |element, class, lane, tangent| {
                let first = class.layout.rows as usize;
                let count = 6 * class.layout.markers as usize;
                for (i, value) in tangent[first..first + count].iter().enumerate() {
                    wrenches[element.wrench + i] = value[lane];
                }
            },
        );
        if done.is_ok() {
            self.add_wrenches(model, &wrenches, factor, out);
            Self::add_shape_forces(model, &self.work.shape_forces, factor, out);
        }
        self.work.wrenches = wrenches;
        done
    }

    /// Calls `put(element, class, lane, tangent)` with the tangent of each element of the classes `of` along the
    /// markers' motions that belong to `along`, from `direction` of its inputs on.
    fn tangents(
        &mut self,
        model: &Model,
        along: &[f64],
        of: impl Fn(&ElementClass) -> bool,
        direction: impl Fn(&InputLayout, u32) -> u32,
        mut put: impl FnMut(&ElementModel, &ElementClass, usize, &[Pair]),
    ) -> Result<(), RuntimeError> {
        let time = self.at.time;
        for b in 0..self.batches.len() {
            let class_index = self.batches[b].class;
            let class = &model.compiled.system.classes[class_index];
            if !of(class) {
                continue;
            }
            let layout = &class.layout;
            let tape = class.tape as usize;
            let directions = layout.directions() as usize;
            let length = layout.residual_len() as usize;
            for pair in 0..self.batches[b].pairs.len() {
                self.work.elements.tape[tape..tape + directions].fill([0.0; 2]);
                for lane in 0..2 {
                    let element = &model.elements[self.batches[b].pairs[pair][lane]];
                    for (k, marker) in element.markers.iter().enumerate() {
                        let Some(body) = model.markers[*marker].body else {
                            continue;
                        };
                        let body = &model.bodies[body];
                        let x = &along[body.velocity..body.velocity + body.width()];
                        let seeds = tape + direction(layout, k as u32) as usize;
                        for (d, value) in self.marker_along(model, *marker, x).iter().enumerate() {
                            self.work.elements.tape[seeds + d][lane] = *value;
                        }
                    }
                }
                let scratch = &mut self.work.elements;
                let batch = &mut self.batches[b];
                let surfaces = &self.work.surfaces;
                elements::differentiate_along(model, batch, pair, time, surfaces, scratch)?;
                batch.shape_forces_along(
                    model,
                    pair,
                    surfaces,
                    scratch,
                    &mut self.work.shape_forces,
                );
                for lane in 0..self.batches[b].lanes(pair) {
                    let element = &model.elements[self.batches[b].pairs[pair][lane]];
                    put(element, class, lane, &self.work.elements.outputs[..length]);
                }
            }
        }
        Ok(())
    }

    /// The derivatives of one element at the gathered inputs, as `elements::Scratch::tangents`
    /// has them; empty for an element that is not dynamic.
    pub fn derivatives_of(
        &mut self,
        model: &Model,
        element: usize,
    ) -> Result<Vec<f64>, RuntimeError> {
        let layout = model.class(element).layout;
        let count = layout.directions() as usize;
        let directions = 0..layout.answer_direction(0) as usize;
        for batch in &mut self.batches {
            let Some([pair, lane]) = batch.place_of(element) else {
                continue;
            };
            let scratch = &mut self.work.elements;
            let directions = [directions.clone()];
            elements::differentiate(model, batch, pair, &directions, self.at.time, scratch)?;
            let numbers = &scratch.tangents[..count * layout.residual_len() as usize];
            return Ok(numbers.iter().map(|number| number[lane]).collect());
        }
        Ok(Vec::new())
    }

    /// Calls `put(element, ∂W/∂pose, ∂W/∂twist)` for each element with loads, at the gathered inputs. Rows are the
    /// wrenches on its markers, columns the displacements and rotations, or their rates, of its markers (6 each).
    pub fn load_derivatives(
        &mut self,
        model: &Model,
        mut put: impl FnMut(usize, DMatrix<f64>, DMatrix<f64>),
    ) -> Result<(), RuntimeError> {
        for batch in &mut self.batches {
            let class = &model.compiled.system.classes[batch.class];
            if !class.facts.applies_load {
                continue;
            }
            let layout = class.layout;
            let (rows, count) = (layout.rows as usize, 6 * layout.markers as usize);
            let length = layout.residual_len() as usize;
            for pair in 0..batch.pairs.len() {
                let directions = [0..count, count..2 * count];
                let scratch = &mut self.work.elements;
                elements::differentiate(model, batch, pair, &directions, self.at.time, scratch)?;
                for lane in 0..batch.lanes(pair) {
                    let block = |first: usize| {
                        DMatrix::from_fn(count, count, |i, d| {
                            scratch.tangents[(first + d) * length + rows + i][lane]
                        })
                    };
                    put(batch.pairs[pair][lane], block(0), block(count));
                }
            }
        }
        Ok(())
    }
}
