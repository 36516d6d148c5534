//! Held directions of a balance: stated positions, moving parts, and directions that nothing holds.

use super::describing::not_finite;
use super::{Balance, NEUTRAL, Place, Stop};
use crate::assembly::at;
use crate::assembly::rows::{Along, Rows};
use crate::dynamics::Dynamics;
use crate::elements::Inputs;
use crate::error::RuntimeError;
use crate::outputs::Outputs;
use crate::start::picking::unit_rows;
use crate::state::State;
use eng_system::system::{Origin, Role};
use nalgebra::{DMatrix, DVector};
use std::collections::BTreeSet;

/// Singular value, as a share of the largest, below which rows depend on each other. A choice above rounding:
/// the inverse mass spreads the values of independent rows by the ratio of heavy to light bodies, so a larger
/// limit could drop a row of a heavy one.
const LEAST_ROW: f64 = 1e-12;

/// Rows of moving parts (scaled velocities). Each has the origin of its statement, and whether it is a
/// length.
type Moving = (DMatrix<f64>, Vec<(Origin, bool)>);

/// The values that hold in a balance besides the constraints, and whether anything moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Terms {
    /// Positions that `start` states.
    pub positions: bool,
    /// The cycle's angle.
    pub cycle: bool,
    /// Nothing moves, even if the text or a drive states speeds.
    pub rest: bool,
}

impl Terms {
    /// The terms of a quasi-static start.
    pub const START: Terms = Terms {
        positions: true,
        cycle: true,
        rest: false,
    };
}

impl Balance<'_> {
    /// Rows of stated motions, and of the cycle's angle.
    pub(super) fn what_moves(&mut self, state: &State) -> Result<Moving, Stop> {
        let model = self.model;
        let system = &model.compiled.system;
        let mut rows: Vec<(Vec<f64>, Origin, bool)> = Vec::new();
        let starts = Rows::new(
            model,
            (0..model.elements.len())
                .filter(|e| {
                    !self.terms.rest
                        && system.elements[*e].role == Role::StartVelocity { exact: true }
                        && !model.class(*e).rows.is_empty()
                })
                .collect(),
        );
        let mut resting = state.clone();
        resting.velocity.fill(0.0);
        let (values, mut matrix) = starts.evaluate(model, &at(&resting), Along::Velocity)?;
        for (mut column, scale) in matrix.column_iter_mut().zip(self.motion.scales()) {
            column.scale_mut(*scale);
        }
        if let Some(cycle) = &system.cycle
            && self.terms.cycle
        {
            let row = self.cycle_rate(cycle.element as usize, state)?;
            rows.push((row, cycle.origin.clone(), false));
        }
        for (i, (element, row)) in starts.owners.iter().enumerate() {
            if values[i] != 0.0 {
                let length = model.class(*element).rows[*row].dimension
                    == eng_system::Dimension::LENGTH.over(eng_system::Dimension::TIME);
                rows.push((
                    matrix.row(i).iter().copied().collect(),
                    system.elements[*element].origin.clone(),
                    length,
                ));
            }
        }
        let fixed = DMatrix::from_fn(rows.len(), model.velocities, |i, j| rows[i].0[j]);
        Ok((fixed, rows.into_iter().map(|(_, o, l)| (o, l)).collect()))
    }

    /// Coefficients of the cycle's rate in scaled velocities. The rate is affine in them.
    pub(super) fn cycle_rate(&mut self, element: usize, state: &State) -> Result<Vec<f64>, Stop> {
        let model = self.model;
        let mut watch = Outputs::watching(model, element)?;
        let mut moving = state.clone();
        moving.velocity.fill(0.0);
        moving.acceleration.fill(0.0);
        self.dynamics
            .place(model, moving.time, &moving.pose, &moving.velocity);
        let mut rate = |dynamics: &mut Dynamics, moving: &State| -> Result<f64, RuntimeError> {
            // only velocities differ from the state before
            for i in 0..watch.markers().len() {
                dynamics.place_marker(model, watch.markers()[i], &moving.velocity);
            }
            watch.evaluate(model, dynamics, moving)?;
            Ok(watch.watched_values[1])
        };
        let still = rate(&mut self.dynamics, &moving)?;
        let mut row = vec![0.0; model.velocities];
        for i in self.velocities_of(element) {
            let scale = self.motion.scales()[i];
            moving.velocity[i] = scale;
            row[i] = rate(&mut self.dynamics, &moving)? - still;
            moving.velocity[i] = 0.0;
        }
        Ok(row)
    }

    /// The cycle's angle at a position (rad), unwrapped with the angles of the state.
    pub(super) fn cycle_angle(&mut self, element: usize, state: &State) -> Result<f64, Stop> {
        let mut watch = Outputs::watching(self.model, element)?;
        self.dynamics
            .place(self.model, state.time, &state.pose, &state.velocity);
        watch.evaluate(self.model, &self.dynamics, state)?;
        Ok(watch.watched_values[0])
    }

    /// Velocities on which an element's outputs can depend. If it reads other elements' outputs, these are
    /// all velocities.
    fn velocities_of(&self, element: usize) -> Vec<usize> {
        let model = self.model;
        if !model.compiled.system.elements[element].signals.is_empty() {
            return (0..model.velocities).collect();
        }
        let bodies: BTreeSet<usize> = model.elements[element]
            .markers
            .iter()
            .filter_map(|m| model.markers[*m].body)
            .collect();
        bodies
            .iter()
            .map(|b| &model.bodies[*b])
            .flat_map(|b| b.velocity..b.velocity + b.width())
            .collect()
    }

    /// Values and rows (scaled velocities) of all directions that may be held.
    pub(super) fn holds(
        &self,
        state: &State,
    ) -> Result<(DVector<f64>, DMatrix<f64>), RuntimeError> {
        let n = self.model.velocities;
        let (values, matrix) = self.stated.evaluate(self.model, &at(state), Along::Pose)?;
        let count = matrix.nrows();
        let rows = DMatrix::from_fn(count + self.fixed.nrows(), n, |i, j| {
            if i < count {
                matrix[(i, j)] * self.motion.scales()[j]
            } else {
                self.fixed[(i - count, j)]
            }
        });
        let values = DVector::from_fn(rows.nrows(), |i, _| if i < count { values[i] } else { 0.0 });
        Ok((values, rows))
    }

    /// Values and rows of the held directions at a position. The values are scaled positions, the rows are
    /// unit rows in scaled velocities.
    pub(super) fn held(&self, state: &State) -> Result<(DVector<f64>, DMatrix<f64>), RuntimeError> {
        if let Some(rows) = &self.turned {
            return Ok((DVector::zeros(rows.nrows()), rows.clone()));
        }
        let (mut values, mut rows) = self.holds(state)?;
        for (i, factor) in self.factors.iter().enumerate() {
            values[i] *= factor;
            rows.row_mut(i).scale_mut(*factor);
        }
        let (values, rows) = (
            values.select_rows(&self.holding),
            rows.select_rows(&self.holding),
        );
        let count = rows.nrows();
        let all = DMatrix::from_fn(count + self.neutral.nrows(), rows.ncols(), |i, j| {
            if i < count {
                rows[(i, j)]
            } else {
                self.neutral[(i - count, j)]
            }
        });
        let values = DVector::from_fn(all.nrows(), |i, _| if i < count { values[i] } else { 0.0 });
        Ok((values, all))
    }

    /// Computes the multipliers that carry the load at the present position with the least remaining
    /// acceleration, `λ = −(A M⁻¹ Aᵀ)⁻¹ A M⁻¹ r`, with the rows A of the constraints and held directions.
    /// They hold a hanging body.
    pub(super) fn carry(&mut self, place: &mut Place) -> Result<(), Stop> {
        let model = self.model;
        let (n, m) = (model.velocities, model.rows);
        place.state.multipliers.fill(0.0);
        let residual = self.residual(place)?.rows(0, n).into_owned();
        let matrix = self.matrix(&place.state)?;
        let count = matrix.nrows() - n;
        if count == 0 {
            return Ok(());
        }
        let rows = matrix.view((n, 0), (count, n)).into_owned();
        let mut mass = self.motion.mass(model, &place.state);
        // a part without mass or inertia would leave the mass without an inverse
        let floor = 1e-12 * mass.diagonal().amax();
        for i in 0..n {
            mass[(i, i)] += floor;
        }
        let mass = mass.cholesky().ok_or_else(|| not_finite(model))?;
        let across = mass.solve(&rows.transpose());
        let wanted = -(across.transpose() * residual);
        // if rows depend on each other, the least multipliers are chosen
        let Some(carried) = crate::singular::decompose(&rows * &across).and_then(|svd| {
            svd.solve(&wanted, LEAST_ROW * svd.singular_values.amax())
                .ok()
        }) else {
            return Err(not_finite(model));
        };
        for (i, scale) in model.row_scales().iter().enumerate().take(m) {
            place.state.multipliers[i] = carried[i] * self.unit / scale;
        }
        Ok(())
    }

    /// Finds freedoms without stiffness at the present position: small singular values of the stiffness in
    /// mass-normalised coordinates of the free space, over the square of the motion's `motion_rate` (1/s).
    pub(super) fn find_neutral(
        &mut self,
        state: &State,
        free: &DMatrix<f64>,
        motion_rate: f64,
    ) -> Result<(), Stop> {
        let model = self.model;
        if free.ncols() == 0 {
            return Ok(());
        }
        let mut place = Place {
            state: state.clone(),
            efforts: DVector::zeros(0),
        };
        self.carry(&mut place)?;
        self.residual(&place)?;
        let mut matrix = self.matrix(&place.state)?;
        // without its centrifugal softening, because a shaft at a critical speed is not a free part
        self.add_softening(state, -1.0, &mut matrix);
        let free = self.free_stiffness(&place.state, &matrix, free)?;
        let svd = crate::singular::decompose(free.stiffness / (motion_rate * motion_rate))
            .ok_or_else(|| not_finite(model))?;
        let right = svd.v_t.ok_or_else(|| not_finite(model))?;
        let weak: Vec<usize> = (0..right.nrows())
            .filter(|i| svd.singular_values[*i] <= NEUTRAL[usize::from(self.again)])
            .collect();
        self.neutral = right.select_rows(&weak) * free.moves.transpose();
        unit_rows(&mut self.neutral, 0.0);
        self.freedoms -= weak.len();
        Ok(())
    }

    /// Unwraps the angles of a search at rest, which may turn by more than half a turn. A start keeps the turns of the
    /// assembled state.
    pub(super) fn follow_turns(&mut self, place: &mut Place) -> Result<(), Stop> {
        if !self.terms.rest {
            return Ok(());
        }
        let state = &place.state;
        self.dynamics
            .place(self.model, state.time, &state.pose, &self.velocity);
        let from = Inputs {
            memory: None,
            ..self.dynamics.inputs_at(state)
        };
        let mut rotations = state.rotations.clone();
        self.watch.unwrap(self.model, &from, &mut rotations)?;
        place.state.rotations = rotations;
        Ok(())
    }
}
