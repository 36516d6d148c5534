//! The gap at links and cells, its rates, and the pressures of the fixed places.

use crate::error::FilmError;
use crate::film::{Film, Level, LevelWork};
use crate::grid::place;
use crate::inputs::{
    ECCENTRICITY, END_PRESSURE, RATE, SPIN, SUPPLY, TILT, TILT_RATE, TURN, VISCOSITY,
};
use crate::results::THICKEST;
use crate::source::{Cavitation, Feed};

impl Film {
    /// Gap, its rate and the conductance of the links:
    ///
    /// ```text
    /// h = c + s(θ, z) − (e + z t)·n + s_p(θ − φ, z) + Σ b ψ
    /// ḣ = −(ė + z ṫ)·n − ω ∂s_p/∂θ + Σ ḃ ψ                 means over a cell
    /// ```
    pub(crate) fn set_gap(&self, level: &Level, state: &mut LevelWork, x: &[f64]) {
        let [ex, ey] = [x[ECCENTRICITY], x[ECCENTRICITY + 1]];
        let [tx, ty] = [x[TILT], x[TILT + 1]];
        let eccentric =
            |normal: [f64; 2], z: f64| (ex + z * tx) * normal[0] + (ey + z * ty) * normal[1];
        let grid = &level.grid;
        for (gap, site) in state.gaps[0].iter_mut().zip(&grid.sites) {
            *gap = site.base - eccentric(site.normal, site.z);
        }
        for (gap, cell) in state.gaps[1].iter_mut().zip(&grid.cells) {
            *gap = cell.base - eccentric(cell.normal, cell.z);
        }
        for (rate, cell) in state.cell_rate.iter_mut().zip(&grid.cells) {
            let [x_rate, y_rate] = [
                x[RATE] + cell.z * x[TILT_RATE],
                x[RATE + 1] + cell.z * x[TILT_RATE + 1],
            ];
            *rate = -x_rate * cell.mean_normal[0] - y_rate * cell.mean_normal[1];
        }
        self.add_pin_profile(level, state, x);
        self.set_turning(level, state, x);
        let shapes = self.source.shapes.len();
        let first = SUPPLY + self.source.openings.len();
        let (amplitudes, rates) = x[first..first + 2 * shapes].split_at(shapes);
        level.shapes[0].add_sum(amplitudes, &mut state.gaps[0]);
        level.shapes[1].add_sum(amplitudes, &mut state.gaps[1]);
        level.shapes[2].add_sum(rates, &mut state.cell_rate);
        self.set_flow(level, state, x);
    }

    /// The numbers that surfaces and oil have at the gaps h and their rates: carrying gaps,
    /// conductance, shear.
    fn set_flow(&self, level: &Level, state: &mut LevelWork, x: &[f64]) {
        let (surfaces, grid, spin) = (&self.surfaces, &level.grid, x[SPIN]);
        let factor = 1.0 / (12.0 * x[VISCOSITY]);
        for (at, link) in grid.links.iter().enumerate() {
            let gap = state.gaps[0][at];
            let carried = surfaces.carried(gap);
            state.link_gap[at] = carried[0];
            state.carried_slope[0][at] = carried[1];
            let conducted = surfaces.conducted(gap, carried, spin, link.carry == 0.0);
            state.conductance[at] = link.weight * state.turning[at][0] * factor * conducted.value;
            state.conductance_slope[at] = [conducted.by_gap, conducted.by_spin];
        }
        for (at, cell) in grid.cells.iter().enumerate() {
            let gap = state.gaps[1][at];
            let carried = surfaces.carried(gap);
            state.cell_gap[at] = carried[0];
            state.carried_slope[1][at] = carried[1];
            state.shear[at] = surfaces.sheared(carried, spin);
            let [by_rate, by_gap] = surfaces.squeezed(carried);
            state.rate_slope[at] = [by_rate, by_gap * state.cell_rate[at]];
            state.cell_rate[at] *= by_rate;
            // an opening is deep: its surfaces do not touch
            if cell.held.is_none() {
                let whole = 1.0 - state.covered[at][0];
                state.touching[at] = surfaces.touching(gap).map(|number| whole * number);
            }
        }
    }

    fn add_pin_profile(&self, level: &Level, state: &mut LevelWork, x: &[f64]) {
        if self.source.pin_profile.is_empty() {
            return;
        }
        let (grid, half, turn) = (&level.grid, self.source.width / 2.0, x[TURN]);
        for (at, site) in grid.sites.iter().enumerate() {
            let (value, slope) = self.source.pin_profile(site.angle - turn, site.z / half);
            state.gaps[0][at] += value;
            state.link_turn[at] = -slope;
        }
        for (at, cell) in grid.cells.iter().enumerate() {
            let zeta = cell.z / half;
            let (value, slope) = self.source.pin_profile(cell.angle - turn, zeta);
            state.gaps[1][at] += value;
            state.cell_turn[at] = -slope;
            let west = self
                .source
                .pin_profile(cell.angle - cell.sector / 2.0 - turn, zeta);
            let east = self
                .source
                .pin_profile(cell.angle + cell.sector / 2.0 - turn, zeta);
            state.pin_slope[at] = [
                (east.0 - west.0) / cell.sector,
                (west.1 - east.1) / cell.sector,
            ];
            state.cell_rate[at] -= x[SPIN] * state.pin_slope[at][0];
        }
    }

    /// Pressure and content of openings and ends.
    pub(crate) fn set_fixed(&self, level: &Level, state: &mut LevelWork, x: &[f64]) {
        let first = level.grid.cells.len();
        for (at, opening) in self.source.openings.iter().enumerate() {
            let (pressure, content) = match opening.feed {
                Feed::Pressure => (x[SUPPLY + at], 1.0),
                // for rules without content the gap is full
                Feed::Content(_) if self.source.cavitation != Cavitation::MassConserving => {
                    (0.0, 1.0)
                }
                Feed::Content(content) => (0.0, content),
            };
            state.q[first + at] = self.transformed(pressure);
            state.content[first + at] = content;
        }
        let ends = first + self.source.openings.len();
        state.q[ends] = self.transformed(x[END_PRESSURE]);
        state.content[ends] = 1.0;
        for (cell, data) in level.grid.cells.iter().enumerate() {
            if let Some(opening) = data.held {
                state.q[cell] = state.q[first + opening];
                state.content[cell] = state.content[first + opening];
                state.full[cell] = true;
            }
        }
    }

    /// q of a pressure: with Barus' oil, `μ = μ₀ exp(α p)`, the unknown `q = (1 − exp(−α p))/α` makes `∇p/μ =
    /// ∇q/μ₀`. Pressures and q in Pa. Beyond the thickest oil q grows linearly.
    fn transformed(&self, pressure: f64) -> f64 {
        match self.source.piezo {
            0.0 => pressure,
            piezo => {
                let thickest = libm::log(THICKEST) / piezo;
                let beyond = (pressure - thickest).max(0.0);
                -libm::expm1(-piezo * pressure.min(thickest)) / piezo + beyond / THICKEST
            }
        }
    }

    /// Refuses surfaces that touch at a face or in the middle of a cell.
    pub(crate) fn check_gap(&self, state: &LevelWork) -> Result<(), FilmError> {
        // a smooth film with a floor has a solution at every iterate, and rough surfaces at every
        // distance
        if self.source.floor > 0.0 || self.surfaces.is_rough() {
            return Ok(());
        }
        let grid = &self.levels[0].grid;
        let refuse = |gap: f64, angle: f64, z: f64| {
            let place = place(angle, z);
            Err(FilmError::NoGap { gap, place })
        };
        let (link, at_link) = thinnest(&state.gaps[0]);
        let (cell, in_cell) = thinnest(&state.gaps[1]);
        if at_link <= 0.0 && at_link <= in_cell {
            return refuse(at_link, grid.sites[link].angle, grid.sites[link].z);
        }
        if in_cell <= 0.0 {
            return refuse(in_cell, grid.cells[cell].angle, grid.cells[cell].z);
        }
        Ok(())
    }
}

/// The least gap and its number.
fn thinnest(gaps: &[f64]) -> (usize, f64) {
    let mut least = (0, f64::INFINITY);
    for (at, gap) in gaps.iter().enumerate() {
        if *gap < least.1 {
            least = (at, *gap);
        }
    }
    least
}
