//! Constraints and wrenches along a vector of body velocities, by one tangent an element.

use crate::dynamics::Dynamics;
use crate::elements;
use crate::error::RuntimeError;
use crate::model::{ElementModel, Model};
use eng_system::code::{Function, Pair};
use eng_system::layout::InputLayout;
use eng_system::system::ElementClass;

/// `G x` for a vector of body velocities, at the place and the inputs of `dynamics`.
pub fn constraints_along(
    model: &Model,
    dynamics: &mut Dynamics,
    along: &[f64],
    out: &mut [f64],
) -> Result<(), RuntimeError> {
    tangents(
        model,
        dynamics,
        along,
        |class| class.layout.rows > 0,
        InputLayout::pose_direction,
        |_, element, class, lane, tangent| {
            for (i, value) in tangent[..class.layout.rows as usize].iter().enumerate() {
                out[element.row + i] = value[lane];
            }
        },
    )
}

/// Sets the wrenches of `dynamics` to `∂W/∂v x` for a vector x of body velocities: what dampers and films answer a change of velocity.
pub fn wrenches_along(
    model: &Model,
    dynamics: &mut Dynamics,
    along: &[f64],
) -> Result<(), RuntimeError> {
    dynamics.wrenches.fill(0.0);
    tangents(
        model,
        dynamics,
        along,
        |class| class.uses_twist,
        InputLayout::twist_direction,
        |wrenches, element, class, lane, tangent| {
            let first = class.layout.rows as usize;
            let count = 6 * class.layout.markers as usize;
            for (i, value) in tangent[first..first + count].iter().enumerate() {
                wrenches[element.wrench + i] = value[lane];
            }
        },
    )
}

/// Calls `put(wrenches of the dynamics, element, class, lane, tangent)` with the tangent of each element of the classes `of` along the
/// markers' motions that belong to `along`, from `direction` of its inputs on.
fn tangents(
    model: &Model,
    dynamics: &mut Dynamics,
    along: &[f64],
    of: impl Fn(&ElementClass) -> bool,
    direction: impl Fn(&InputLayout, u32) -> u32,
    mut put: impl FnMut(&mut [f64], &ElementModel, &ElementClass, usize, &[Pair]),
) -> Result<(), RuntimeError> {
    for b in 0..dynamics.batches.len() {
        let class_index = dynamics.batches[b].class;
        let class = &model.compiled.system.classes[class_index];
        if !of(class) {
            continue;
        }
        let layout = &class.layout;
        let tape = class.tape as usize;
        let directions = layout.directions() as usize;
        let length = layout.residual_len() as usize;
        for pair in 0..dynamics.batches[b].pairs.len() {
            elements::call(
                model,
                class_index,
                Function::Linearize,
                dynamics.batches[b].inputs(pair),
                &mut dynamics.scratch.tape[..tape],
            )?;
            dynamics.scratch.tape[tape..tape + directions].fill([0.0; 2]);
            for lane in 0..2 {
                let element = &model.elements[dynamics.batches[b].pairs[pair][lane]];
                for (k, marker) in element.markers.iter().enumerate() {
                    let Some(body) = model.markers[*marker].body else {
                        continue;
                    };
                    let body = &model.bodies[body];
                    let x = &along[body.velocity..body.velocity + body.width()];
                    let seeds = tape + direction(layout, k as u32) as usize;
                    for (d, value) in dynamics.marker_along(model, *marker, x).iter().enumerate() {
                        dynamics.scratch.tape[seeds + d][lane] = *value;
                    }
                }
            }
            elements::call(
                model,
                class_index,
                Function::Tangent,
                &dynamics.scratch.tape[..tape + directions],
                &mut dynamics.scratch.outputs[..length],
            )?;
            for lane in 0..dynamics.batches[b].lanes(pair) {
                let element = &model.elements[dynamics.batches[b].pairs[pair][lane]];
                put(
                    &mut dynamics.wrenches,
                    element,
                    class,
                    lane,
                    &dynamics.scratch.outputs[..length],
                );
            }
        }
    }
    Ok(())
}
