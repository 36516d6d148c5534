//! Elastic surfaces in the balance of their bodies: modal forces `Ψᵀ f`, and the blocks of the step's matrix.
//!
//! With the answers y of a field for its element, its drives x and the unknown u of the step, where
//! `δb = Ψ δa` and `δḃ = w Ψ δa` with the weight w of velocities,
//!
//! ```text
//! δy = ∂y/∂x δx + S_y Ψ δa        S = ∂/∂b + w ∂/∂ḃ
//! δ(Ψᵀ f) = Ψᵀ (∂f/∂x δx + S_f Ψ δa)
//! ```
//!
//! The first term of δy is part of the element's own derivatives.

use super::matrix::{Filling, Lane, Seen, expand_rows, expanded};
use super::plan::SurfacePlan;
use super::{Dynamics, shape_rows};
use crate::elements::Batch;
use crate::field::LaneField;
use crate::model::Model;
use crate::surface::SurfaceModel;
use eng_system::dense::{add_product_of_six, add_scaled};

/// Room for the blocks of one surface.
#[derive(Clone, Debug, Default)]
pub(super) struct SurfaceWork {
    /// S_y Ψ: answers × modes.
    answers: Vec<f64>,
    /// S: all answers × shapes.
    shapes: Vec<f64>,
    /// A marker's wrench by the modes.
    wrench: Vec<f64>,
    /// Rows over other motions.
    rows: Vec<f64>,
    /// A block of the matrix.
    block: Vec<f64>,
}

/// A vector of so many zeros.
fn zeros(room: &mut Vec<f64>, count: usize) -> &mut Vec<f64> {
    room.clear();
    room.resize(count, 0.0);
    room
}

impl Dynamics {
    /// Amplitudes of the elastic surfaces and their rates (`SurfaceModel::motion`).
    pub fn surfaces(&self) -> &[f64] {
        &self.at.surfaces
    }

    /// Places the surfaces at the present amplitudes of their bodies and given velocities.
    pub fn place_surfaces(&mut self, model: &Model, velocity: &[f64]) {
        for surface in &model.surfaces {
            let (amplitudes, rates) =
                self.at.surfaces[surface.motion()].split_at_mut(surface.shapes);
            surface.content_of(
                &self.at.pose[surface.pose..surface.pose + surface.modes],
                amplitudes,
            );
            let velocities = &velocity[surface.velocity..surface.velocity + surface.modes];
            surface.content_of(velocities, rates);
        }
    }

    /// Writes the change of the surfaces' motion along a vector of body velocities: rates, and no change of
    /// the amplitudes.
    pub(super) fn rates_along(&mut self, model: &Model, along: &[f64]) {
        for surface in &model.surfaces {
            let motion = &mut self.work.surfaces[surface.motion()];
            let (amplitudes, rates) = motion.split_at_mut(surface.shapes);
            amplitudes.fill(0.0);
            let velocities = &along[surface.velocity..surface.velocity + surface.modes];
            surface.content_of(velocities, rates);
        }
    }

    /// `out += factor Σ Ψᵀ f` of given forces of all surfaces.
    pub(super) fn add_shape_forces(model: &Model, forces: &[f64], factor: f64, out: &mut [f64]) {
        for surface in &model.surfaces {
            let modal = &mut out[surface.velocity..surface.velocity + surface.modes];
            surface.add_modal_force(factor, &forces[surface.forces()], modal);
        }
    }
}

impl<'a> Filling<'a> {
    /// The surface of a field with its places.
    fn planned(&self, field: &LaneField) -> Option<(&'a SurfaceModel, &'a SurfacePlan)> {
        let index = field.surface?;
        // a body whose support leaves it no mode has no block
        self.model
            .surfaces
            .get(index)
            .filter(|surface| surface.modes > 0)?;
        Some((
            self.model.surfaces.get(index)?,
            self.plan.surfaces.get(index)?,
        ))
    }

    /// Adds the blocks of the surfaces of an element by the modes of their bodies and by the element's states.
    pub(super) fn surfaces(&mut self, batch: &Batch, pair: usize, lane: Lane) {
        for (field, drive, answer) in batch.fields_of(pair, lane.lane) {
            let Some((surface, plan)) = self.planned(field) else {
                continue;
            };
            self.by_modes(field, surface, plan);
            self.element_by_modes(lane, (field, answer), surface, plan);
            self.states_of_surface(lane, (field, drive, answer), surface, plan);
        }
    }

    /// Fills `S_y Ψ`, and adds `Ψᵀ S_f Ψ`.
    fn by_modes(&mut self, field: &LaneField, surface: &SurfaceModel, plan: &SurfacePlan) {
        let (count, modes) = (surface.shapes, surface.modes);
        let work = &mut self.work.surface;
        let shapes = zeros(&mut work.shapes, (field.own.answers + count) * count);
        for (row, slopes) in shapes.chunks_exact_mut(count).zip(field.slopes_from(0)) {
            let (amplitudes, rates) = slopes[field.own.drives..].split_at(count);
            row.copy_from_slice(amplitudes);
            add_scaled(row, self.velocity_weight, rates);
        }
        let (of_element, of_shapes) = work.shapes.split_at(field.own.answers * count);
        let answers = zeros(&mut work.answers, field.own.answers * modes);
        surface.add_by_modes(of_element, answers);
        let by_modes = zeros(&mut work.rows, count * modes);
        surface.add_by_modes(of_shapes, by_modes);
        let block = zeros(&mut work.block, modes * modes);
        surface.add_on_modes(by_modes, modes, block);
        self.plan
            .table
            .get(plan.modal)
            .add(self.values, block, -1.0);
    }

    /// Adds the derivatives of the element's wrenches by the modes, through the answers.
    fn element_by_modes(
        &mut self,
        lane: Lane,
        (field, answer): (&LaneField, usize),
        surface: &SurfaceModel,
        plan: &SurfacePlan,
    ) {
        let modes = surface.modes;
        for (own, marker) in self.model.elements[lane.index].markers.iter().enumerate() {
            let Some(place) = plan.of_body[own] else {
                continue;
            };
            let wrench = zeros(&mut self.work.surface.wrench, 6 * modes);
            let first = lane.rows + 6 * own;
            let answers = self.work.surface.answers.chunks_exact(modes);
            for (a, by_modes) in answers.enumerate().take(field.own.answers) {
                let direction = (lane.answers + answer + a) * lane.length + first;
                let slopes = &self.work.elements.tangents[direction..direction + 6];
                for (row, slope) in wrench.chunks_exact_mut(modes).zip(slopes) {
                    add_scaled(row, slope[lane.lane], by_modes);
                }
            }
            let model = &self.model.markers[*marker];
            let (reach, at) = (model.reach(), self.at.jacobian_at[*marker]);
            let in_reach = zeros(&mut self.work.surface.rows, reach * modes);
            let jacobian = &self.at.jacobians[at..at + 6 * reach];
            add_product_of_six(in_reach, jacobian, &self.work.surface.wrench);
            let width = model.body.map_or(0, |body| self.model.bodies[body].width());
            let block = zeros(&mut self.work.surface.block, width * modes);
            let shape = shape_rows(model, &self.at.shapes, self.at.shape_at[*marker]);
            expand_rows(shape, in_reach, modes, block);
            self.plan.table.get(place).add(self.values, block, -1.0);
        }
    }

    /// Adds the derivatives of the rates of the element's states by the modes, and of the modal forces by the states.
    fn states_of_surface(
        &mut self,
        lane: Lane,
        (field, drive, answer): (&LaneField, usize, usize),
        surface: &SurfaceModel,
        plan: &SurfacePlan,
    ) {
        let Some([of_states, by_states]) = plan.states else {
            return;
        };
        let (modes, states) = (surface.modes, lane.states);
        let first = lane.rows + 6 * lane.markers;
        let block = zeros(&mut self.work.surface.block, states * modes);
        let answers = self.work.surface.answers.chunks_exact(modes);
        for (a, by_modes) in answers.enumerate().take(field.own.answers) {
            let direction = (lane.answers + answer + a) * lane.length + first;
            let slopes = &self.work.elements.tangents[direction..direction + states];
            for (row, slope) in block.chunks_exact_mut(modes).zip(slopes) {
                add_scaled(row, slope[lane.lane], by_modes);
            }
        }
        self.plan.table.get(of_states).add(self.values, block, -1.0);
        let rows = zeros(&mut self.work.surface.rows, surface.shapes * states);
        let slopes = field.slopes_from(field.own.answers);
        for (row, slopes) in rows.chunks_exact_mut(states).zip(slopes) {
            for (s, x) in row.iter_mut().enumerate() {
                let direction = (12 * lane.markers + s) * lane.length + lane.drives + drive;
                let drives = &self.work.elements.tangents[direction..];
                let changes = slopes[..field.own.drives].iter().zip(drives);
                *x = changes.map(|(slope, drive)| slope * drive[lane.lane]).sum();
            }
        }
        let block = zeros(&mut self.work.surface.block, modes * states);
        surface.add_on_modes(rows, states, block);
        self.plan.table.get(by_states).add(self.values, block, -1.0);
    }

    /// Adds the derivatives of the modal forces by the body of a marker of the element, whose outputs are in `columns`.
    pub(super) fn surfaces_by_body(&mut self, batch: &Batch, pair: usize, lane: Lane, seen: Seen) {
        for (field, drive, _) in batch.fields_of(pair, lane.lane) {
            let Some((surface, plan)) = self.planned(field) else {
                continue;
            };
            let Some(place) = plan.by_body[seen.own] else {
                continue;
            };
            let Seen { reach, width, .. } = seen;
            let first = (lane.drives + drive) * reach;
            let columns = &self.work.columns[first..first + field.own.drives * reach];
            let rows = zeros(&mut self.work.surface.rows, surface.shapes * reach);
            let slopes = field.slopes_from(field.own.answers);
            for (row, slopes) in rows.chunks_exact_mut(reach).zip(slopes) {
                for (slope, column) in slopes.iter().zip(columns.chunks_exact(reach)) {
                    add_scaled(row, *slope, column);
                }
            }
            let shape = shape_rows(seen.model, &self.at.shapes, self.at.shape_at[seen.marker]);
            expanded(shape, rows, reach, width, &mut self.work.line);
            let block = zeros(&mut self.work.surface.block, surface.modes * width);
            surface.add_on_modes(&self.work.line, width, block);
            self.plan.table.get(place).add(self.values, block, -1.0);
        }
    }
}
