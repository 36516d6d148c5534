//! Sources of velocities of a steady motion: stated velocities, pins in shells, dampers and springs.

use super::eccentricity::{
    axis_rates, eccentricity_rates, marker_jacobian, rates_of_axes, rates_of_eccentricities,
};
use super::motion::{SteadyMotion, rows_of};
use crate::assembly::at;
use crate::assembly::rows::{self, Along, Rows};
use crate::elements;
use crate::error::RuntimeError;
use crate::model::Model;
use crate::state::State;
use eng_system::code::Function;
use eng_system::system::Role;
use nalgebra::{DMatrix, DVector};

/// Share of an element's largest stiffness below which a direction does not count as held. A choice: a load
/// has such slopes by rounding, or through the small tilt of its frame. If they counted, a velocity would be
/// decided by them instead of by the weaker kinds of conditions.
const SOFT: f64 = 1e-6;

/// Share of a torque below which its change by a turn of 1 rad is rounding. A choice some decades above the rounding of
/// a torque that turns in the axes of its marker and is constant for an observer at rest.
const CONSTANT: f64 = 1e-12;

/// A source of velocities. [`super::motion`] has their order.
#[derive(Clone, Debug)]
pub(super) enum Source {
    /// Some of the rows of stated velocities.
    Stated(Rows, Vec<usize>),
    /// These velocities themselves.
    Own(Vec<usize>),
    /// Pins that rest in their shells.
    Pins(Vec<rows::Preference>),
    /// Pins whose axes rest in their shells.
    Axes(Vec<rows::Preference>),
    /// Elements whose loads do not change: dampers or springs.
    Loads(Vec<usize>),
}

impl Source {
    /// The rates that a source of films sets to zero; `None` of another source. In m/s for eccentricities,
    /// and in 1/s for axes.
    pub fn film_rates(&self, model: &Model, pose: &[f64], velocity: &[f64]) -> Option<Vec<f64>> {
        match self {
            Source::Pins(pins) => Some(rates_of_eccentricities(model, pins, pose, velocity)),
            Source::Axes(pins) => Some(rates_of_axes(model, pins, pose, velocity)),
            Source::Stated(..) | Source::Own(_) | Source::Loads(_) => None,
        }
    }
}

impl SteadyMotion {
    /// The rows `matrix · y + values` of a source, which should be zero for the scaled velocities y.
    pub(super) fn rows_of_source(
        &self,
        model: &Model,
        state: &State,
        source: &Source,
    ) -> Result<(DVector<f64>, DMatrix<f64>), RuntimeError> {
        let n = model.velocities;
        let homogeneous = |matrix: DMatrix<f64>| (DVector::zeros(matrix.nrows()), matrix);
        let (values, mut matrix) = match source {
            Source::Stated(rows, chosen) => {
                let mut resting = state.clone();
                resting.velocity.fill(0.0);
                let (values, matrix) = rows.evaluate(model, &at(&resting), Along::Velocity)?;
                (values.select_rows(chosen), matrix.select_rows(chosen))
            }
            Source::Own(chosen) => homogeneous(DMatrix::from_fn(chosen.len(), n, |i, j| {
                f64::from(u8::from(chosen[i] == j))
            })),
            Source::Pins(pins) => homogeneous(eccentricity_rates(model, pins, state)),
            Source::Axes(pins) => homogeneous(axis_rates(model, pins, state)),
            Source::Loads(elements) => {
                let mut parts = Vec::new();
                for element in elements {
                    parts.extend(self.load_derivatives(model, state, *element)?);
                }
                let rows = parts.iter().map(DMatrix::nrows).sum();
                let mut all = DMatrix::zeros(rows, n);
                let mut first = 0;
                for part in parts {
                    all.rows_mut(first, part.nrows()).copy_from(&part);
                    first += part.nrows();
                }
                homogeneous(all)
            }
        };
        self.scale_columns(&mut matrix);
        Ok((values, matrix))
    }

    /// Derivatives of an element's wrenches with respect to velocities and positions, each scaled to the size
    /// of one. Soft rows are zero. Those of torques are as an observer at rest sees them: a brake between ground and a
    /// leaning shaft has a torque of constant direction, although it circles in the axes of the shaft.
    pub(crate) fn load_derivatives(
        &self,
        model: &Model,
        state: &State,
        element: usize,
    ) -> Result<Vec<DMatrix<f64>>, RuntimeError> {
        let class_index = model.elements[element].class;
        let class = &model.compiled.system.classes[class_index];
        let layout = &class.layout;
        let markers = &model.elements[element].markers;
        let (rows, wrenches) = (layout.rows as usize, 6 * layout.markers as usize);
        let tape = class.tape as usize;
        let mut work = vec![[0.0; 2]; tape + layout.directions() as usize];
        let mut out = vec![[0.0; 2]; layout.residual_len() as usize];
        let inputs = rows::inputs(model, element, &at(state));
        let mut present = vec![[0.0; 2]; layout.residual_len() as usize];
        elements::call(
            model,
            class_index,
            Function::Residual,
            &inputs,
            &mut present,
        )?;
        elements::call(
            model,
            class_index,
            Function::Linearize,
            &inputs,
            &mut work[..tape],
        )?;
        let torques = (0..wrenches).filter(|i| i % 6 >= 3);
        let torque = torques.fold(0.0_f64, |most, i| most.max(present[rows + i][0].abs()));
        let mut made = Vec::new();
        for by_twist in [true, false] {
            if by_twist && !class.facts.uses_twist {
                continue;
            }
            let mut matrix = DMatrix::zeros(wrenches, model.velocities);
            for (k, marker) in markers.iter().enumerate() {
                let Some((first, jacobian)) = marker_jacobian(model, *marker, state) else {
                    continue;
                };
                let base = if by_twist {
                    layout.twist_direction(k as u32)
                } else {
                    layout.pose_direction(k as u32)
                } as usize;
                for d in 0..6 {
                    work[tape + base + d] = [1.0; 2];
                    elements::call(model, class_index, Function::Tangent, &work, &mut out)?;
                    work[tape + base + d] = [0.0; 2];
                    for i in 0..wrenches {
                        // a torque is stated in the axes of its marker and turns with them
                        let turned = match (d.checked_sub(3), (i % 6).checked_sub(3)) {
                            (Some(about), Some(along)) if !by_twist && i / 6 == k => {
                                turned(&present[rows + 6 * k + 3..][..3], about, along)
                            }
                            _ => 0.0,
                        };
                        // a force counts with the model's length as its arm, to be comparable with a torque
                        let arm = if i % 6 < 3 { model.length } else { 1.0 };
                        let slope = (out[rows + i][0] + turned) * arm;
                        for w in 0..jacobian.ncols() {
                            matrix[(i, first + w)] += slope * jacobian[(d, w)];
                        }
                    }
                }
            }
            let mut scaled = matrix.clone();
            self.scale_columns(&mut scaled);
            let largest = scaled.row_iter().fold(0.0_f64, |w, r| w.max(r.norm()));
            let least = if by_twist { 0.0 } else { CONSTANT * torque };
            if largest > least && largest.is_finite() {
                for i in 0..wrenches {
                    let keep = scaled.row(i).norm() > SOFT * largest;
                    matrix.row_mut(i).scale_mut(f64::from(u8::from(keep)));
                }
            } else {
                // an open contact has no slope here but may have one elsewhere, so its rows remain
                matrix.fill(0.0);
            }
            made.push(matrix);
        }
        Ok(made)
    }
}

/// Component `along` of the rate of a vector that turns about the axis `about` at 1 rad/s (0…2 for x…z).
fn turned(vector: &[[f64; 2]], about: usize, along: usize) -> f64 {
    match (3 + along - about) % 3 {
        // e_y × z = x, e_z × x = y, e_x × y = z
        2 => vector[3 - about - along][0],
        1 => -vector[3 - about - along][0],
        _ => 0.0,
    }
}

/// Four sources: stated velocities other than zero, stated zeros, zeros beside another velocity of one statement,
/// and guessed velocities.
pub(super) fn stated(model: &Model, state: &State) -> Result<[Source; 4], RuntimeError> {
    let of = |exact| {
        rows_of(model, |e| {
            model.compiled.system.elements[e].role == Role::StartVelocity { exact }
        })
    };
    let mut resting = state.clone();
    resting.velocity.fill(0.0);
    let stated = of(true);
    let (values, _) = stated.evaluate(model, &at(&resting), Along::Velocity)?;
    let (moving, zeros): (Vec<usize>, Vec<usize>) =
        (0..stated.len()).partition(|i| values[*i] != 0.0);
    let moves = |i: &usize| {
        let of = |i: usize| stated.owners[i].0;
        moving.iter().any(|j| of(*j) == of(*i))
    };
    let (beside, still) = zeros.into_iter().partition(moves);
    let guessed = of(false);
    let all = (0..guessed.len()).collect();
    Ok([
        Source::Stated(stated.clone(), moving),
        Source::Stated(stated.clone(), still),
        Source::Stated(stated, beside),
        Source::Stated(guessed, all),
    ])
}
