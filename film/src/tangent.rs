//! Exact derivatives of the outputs, by adjoints on the cavity of the last solution.
//!
//! At a solution `R(u, x) = 0` an output `y = g(u, x)` has `dy/dx = ∂g/∂x − λᵀ ∂R/∂x` with `Aᵀ λ = ∂g/∂u`, `A
//! = ∂R/∂u`. All inputs but the pressures act through the gap, its rate, ω and μ: the sensitivities by gap
//! and rate of each place come first, and are then summed with the weights of the inputs.

use crate::film::{Film, Level, LevelWork, Work};
use crate::inputs::{
    ECCENTRICITY, END_PRESSURE, FORCE, MOMENT, RATE, SHAPE_FORCE, SPIN, SUPPLY, TILT, TILT_RATE,
    TORQUE, TURN, VISCOSITY,
};
use crate::source::{Cavitation, Feed};

impl Film {
    /// Derivatives of the outputs by the inputs at the last solution of `work`, output by output: `outputs()
    /// × inputs()` numbers.
    ///
    /// They are those of the discrete outputs, except where a cell changes sides: there the derivatives on
    /// both sides differ by the order of a cell, and this is the one of the present set. The content before a
    /// step is constant.
    pub fn tangent(&self, work: &mut Work, dy_dx: &mut [f64]) {
        let (level, inputs) = (&self.levels[0], self.inputs());
        let past = work.step.map(|step| (step, work.before.as_slice()));
        let (state, x) = (&mut work.levels[0], work.inputs.as_slice());
        dy_dx.fill(0.0);
        for (output, row) in dy_dx.chunks_exact_mut(inputs).enumerate() {
            if self.source.half_width && (MOMENT..TORQUE).contains(&output) {
                continue;
            }
            self.weigh(level, state, output);
            self.direct(level, state, x, output, row);
            self.solve_adjoint(level, state, x, output);
            self.sum_links(level, state, x, output, row);
            self.sum_cells(level, state, x, output, past, row);
            for slope in row.iter_mut() {
                *slope *= self.halves();
            }
            if self.source.half_width {
                row[TILT..SPIN].fill(0.0);
            }
        }
    }

    /// Derivatives of an output by the pressure of each cell and fixed place, to `adjoint`.
    fn weigh(&self, level: &Level, state: &mut LevelWork, output: usize) {
        state.adjoint.fill(0.0);
        let count = level.grid.cells.len();
        for (at, cell) in level.grid.cells.iter().enumerate() {
            let [cos, sin] = cell.mean_normal;
            state.adjoint[at] = cell.area
                * match output {
                    FORCE => -cos,
                    1 => -sin,
                    MOMENT => cell.z * sin,
                    3 => -cell.z * cos,
                    TORQUE => state.pin_slope[at][0],
                    _ => level.shapes[2][(output - SHAPE_FORCE) * count + at],
                };
        }
        if output == TORQUE {
            for (link, gap) in level.grid.links.iter().zip(&state.link_gap) {
                state.adjoint[link.a] -= link.carry * gap;
                state.adjoint[link.b] += link.carry * gap;
            }
        }
    }

    /// Torque of the shear in a cell for `ϑ e^(α p) = 1`, N m.
    fn shear(&self, level: &Level, state: &LevelWork, x: &[f64], cell: usize) -> f64 {
        let speed = self.source.radius * self.source.radius * x[SPIN];
        x[VISCOSITY] * speed * level.grid.cells[cell].area / state.cell_gap[cell]
    }

    /// Adds the derivatives by the pressures of openings and ends at fixed pressure in the film.
    fn direct(&self, level: &Level, state: &LevelWork, x: &[f64], output: usize, row: &mut [f64]) {
        let count = level.grid.cells.len();
        let openings = self.source.openings.len();
        for (at, opening) in self.source.openings.iter().enumerate() {
            if opening.feed == Feed::Pressure {
                row[SUPPLY + at] += state.adjoint[count + at];
            }
        }
        row[END_PRESSURE] += state.adjoint[count + openings];
        for (at, cell) in level.grid.cells.iter().enumerate() {
            let Some(opening) = cell
                .held
                .filter(|opening| self.source.openings[*opening].feed == Feed::Pressure)
            else {
                continue;
            };
            row[SUPPLY + opening] += state.adjoint[at];
            if output == TORQUE {
                row[SUPPLY + opening] +=
                    self.shear(level, state, x, at) * self.source.piezo * state.pressure[at][1];
            }
        }
    }

    /// Whether the row of a cell is an equation of the film, and not a fixed number.
    fn is_equation(&self, level: &Level, state: &LevelWork, cell: usize) -> bool {
        let conserving = self.source.cavitation == Cavitation::MassConserving;
        level.grid.cells[cell].held.is_none() && (conserving || state.full[cell])
    }

    /// Replaces the derivatives by pressure in `adjoint` by λ; 0 at fixed places.
    fn solve_adjoint(&self, level: &Level, state: &mut LevelWork, x: &[f64], output: usize) {
        let count = level.grid.cells.len();
        for at in 0..count {
            let slope = state.pressure[at][1];
            let mut sum = if state.full[at] {
                state.adjoint[at] * slope
            } else {
                0.0
            };
            if output == TORQUE {
                let shear = self.shear(level, state, x, at);
                sum += if state.full[at] {
                    shear * self.source.piezo * slope * slope
                } else {
                    shear
                };
            }
            state.unknown[at] = if self.is_equation(level, state, at) {
                sum
            } else {
                0.0
            };
        }
        state
            .matrix
            .solve_transposed(&mut state.unknown, &mut state.scratch);
        state.adjoint.fill(0.0);
        for at in 0..count {
            if self.is_equation(level, state, at) {
                state.adjoint[at] = state.unknown[at];
            }
        }
    }

    /// Adds the changes by the gap at the links, ω, μ and the fixed pressures.
    fn sum_links(
        &self,
        level: &Level,
        state: &LevelWork,
        x: &[f64],
        output: usize,
        row: &mut [f64],
    ) {
        let (count, links) = (level.grid.cells.len(), level.grid.links.len());
        let openings = self.source.openings.len();
        let first = SUPPLY + openings;
        for (at, link) in level.grid.links.iter().enumerate() {
            let drop = state.adjoint[link.a] - state.adjoint[link.b];
            let gap = state.link_gap[at];
            let upwind = if x[SPIN] * link.carry * gap >= 0.0 {
                link.a
            } else {
                link.b
            };
            let content = state.content[upwind];
            let [conductance, slope] = state.conductance[at];
            let q_drop = state.q[link.a] - state.q[link.b];
            let mut by_gap = -drop * (x[SPIN] * link.carry * content + slope * q_drop);
            if output == TORQUE {
                by_gap -= link.carry * (state.pressure[link.a][0] - state.pressure[link.b][0]);
            }
            by_gap *= state.continued[0][at];
            let [cos, sin] = link.normal;
            row[ECCENTRICITY] -= by_gap * cos;
            row[ECCENTRICITY + 1] -= by_gap * sin;
            row[TILT] -= by_gap * cos * link.z;
            row[TILT + 1] -= by_gap * sin * link.z;
            row[TURN] += by_gap * state.link_turn[at];
            row[SPIN] -= drop * link.carry * gap * content;
            row[VISCOSITY] += drop * conductance * q_drop / x[VISCOSITY];
            for (side, sign) in [(link.a, 1.0), (link.b, -1.0)] {
                let Some(fixed) = side.checked_sub(count) else {
                    continue;
                };
                let place = if fixed == openings {
                    END_PRESSURE
                } else {
                    SUPPLY + fixed
                };
                if fixed == openings || self.source.openings[fixed].feed == Feed::Pressure {
                    // dq/dp of the fixed place
                    let transform = 1.0 - self.source.piezo * state.q[side];
                    row[place] -= sign * drop * conductance * transform;
                }
            }
            for shape in 0..self.source.shapes.len() {
                row[first + shape] += by_gap * level.shapes[0][shape * links + at];
            }
        }
    }

    /// Adds the changes by the gap and its rate in the cells, ω and μ.
    fn sum_cells(
        &self,
        level: &Level,
        state: &LevelWork,
        x: &[f64],
        output: usize,
        past: Option<(f64, &[f64])>,
        row: &mut [f64],
    ) {
        let (count, shapes) = (level.grid.cells.len(), self.source.shapes.len());
        let first = SUPPLY + self.source.openings.len();
        let speed = self.source.radius * self.source.radius;
        for (at, cell) in level.grid.cells.iter().enumerate() {
            let adjoint = state.adjoint[at];
            let by_rate = -adjoint * cell.area * state.content[at];
            let mut by_gap = match past {
                Some((step, before)) => {
                    -adjoint * cell.area * (state.content[at] - before[at]) / step
                }
                None => 0.0,
            };
            let [slope, turned_slope] = state.pin_slope[at];
            if output == TORQUE {
                let factor = self.shear_factor(state, at);
                by_gap -= self.shear(level, state, x, at) * factor / state.cell_gap[at];
                let over = speed * factor * cell.area / state.cell_gap[at];
                row[SPIN] += x[VISCOSITY] * over;
                row[VISCOSITY] += x[SPIN] * over;
                row[TURN] += cell.area * state.pressure[at][0] * turned_slope;
            }
            by_gap *= state.continued[1][at];
            let [cos, sin] = cell.normal;
            row[ECCENTRICITY] -= by_gap * cos;
            row[ECCENTRICITY + 1] -= by_gap * sin;
            row[TILT] -= by_gap * cos * cell.z;
            row[TILT + 1] -= by_gap * sin * cell.z;
            let [cos, sin] = cell.mean_normal;
            row[RATE] -= by_rate * cos;
            row[RATE + 1] -= by_rate * sin;
            row[TILT_RATE] -= by_rate * cos * cell.z;
            row[TILT_RATE + 1] -= by_rate * sin * cell.z;
            row[SPIN] -= by_rate * slope;
            row[TURN] += by_gap * state.cell_turn[at] - by_rate * x[SPIN] * turned_slope;
            for shape in 0..shapes {
                row[first + shape] += by_gap * level.shapes[1][shape * count + at];
                row[first + shapes + shape] += by_rate * level.shapes[2][shape * count + at];
            }
        }
    }
}
