//! The search for the cavity: an active set on cells of pressure and cells of content.
//!
//! Outflow of a cell, with carried flow `q_c = ½ωR Δz h` and conductance `k = h³/12μ` times length over
//! distance:
//!
//! ```text
//! Σ [q_c ϑ_up + k (q_own − q_other)] + A (ϑ ḣ + ϑ̇ h) = 0      ϑ_up: of the side the surfaces come from
//! ```
//!
//! The unknown of a cell is q where it is full and ϑ in the cavity, where q = 0. With
//! [`Cavitation::Reynolds`] ϑ is 1 in the equation, and a cell in the cavity has an outflow ≥ 0 instead. For
//! a given set both are linear; the set changes where the solution breaks an inequality. This is Newton's
//! method on `min(p, 1 − ϑ)`, or on `min(p, outflow)`.

use crate::error::FilmError;
use crate::film::{Film, Level, LevelWork};
use crate::grid::Grid;
use crate::inputs::SPIN;
use crate::source::Cavitation;

/// Rounds after which only half of the cells that want to change do so, in case a set came back.
const DAMPED: usize = 40;

/// Most rounds.
const ROUNDS: usize = 200;

/// Numbers that a round may break an inequality by: rounding of a solution, relative to its largest number or
/// to the parts of a sum.
const ROUNDING: f64 = 1e-12;

/// Share of its outflow that a steady cell of the cavity loses. A ring of cells without oil has no unique
/// content; this makes it dry.
const DRYING: f64 = 1e-12;

impl Film {
    /// Finds the cavity of one grid from the guess in `full`; the number of rounds. `past` is the step and
    /// the content before it.
    ///
    /// # Errors
    /// If the cavity is not found.
    pub(crate) fn search(
        &self,
        level: &Level,
        state: &mut LevelWork,
        rule: Cavitation,
        x: &[f64],
        past: Option<(f64, &[f64])>,
    ) -> Result<usize, FilmError> {
        let grid = &level.grid;
        if rule == Cavitation::Half {
            state.full.fill(true);
        }
        let mut moving = 0;
        for round in 1..=ROUNDS {
            self.assemble(grid, state, rule, x[SPIN], past);
            state.matrix.factor();
            state.matrix.solve(&mut state.unknown, &mut state.scratch);
            for (cell, data) in grid.cells.iter().enumerate() {
                if data.held.is_some() {
                    continue;
                }
                let unknown = state.unknown[cell];
                let (q, content) = match (state.full[cell], rule) {
                    (true, _) => (unknown, 1.0),
                    (false, Cavitation::MassConserving) => (0.0, unknown),
                    (false, _) => (0.0, 1.0),
                };
                state.q[cell] = q;
                state.content[cell] = content;
            }
            if rule == Cavitation::Half {
                return Ok(round);
            }
            if rule == Cavitation::Reynolds {
                slack(grid, state, x[SPIN]);
            }
            match change(grid, state, rule, round) {
                Some(cell) => moving = cell,
                None => return Ok(round),
            }
        }
        Err(FilmError::NotConverged {
            rounds: ROUNDS,
            place: grid.place(moving),
        })
    }

    /// Matrix and right-hand side of the present set.
    fn assemble(
        &self,
        grid: &Grid,
        state: &mut LevelWork,
        rule: Cavitation,
        spin: f64,
        past: Option<(f64, &[f64])>,
    ) {
        let conserving = rule == Cavitation::MassConserving;
        let count = grid.cells.len();
        state.matrix.clear(border(grid, &state.full));
        state.unknown.fill(0.0);
        state.diagonal.fill(0.0);
        for (at, link) in grid.links.iter().enumerate() {
            let (carried, conductance) = (
                spin * link.carry * state.link_gap[at],
                state.conductance[at][0],
            );
            let upwind = if carried >= 0.0 { link.a } else { link.b };
            // content of the cavity is an unknown: the flow it gives is a number of the matrix
            let unknown_content = conserving && upwind < count && !state.full[upwind];
            let known = match conserving {
                true if unknown_content => 0.0,
                true if upwind < count => carried,
                true => carried * state.content[upwind],
                false => carried,
            };
            for (row, sign) in [(link.a, 1.0), (link.b, -1.0)] {
                if row >= count
                    || grid.cells[row].held.is_some()
                    || !(conserving || state.full[row])
                {
                    continue;
                }
                state.unknown[row] -= sign * known;
                if unknown_content {
                    state.matrix.add(row, upwind, sign * carried);
                    if row == upwind {
                        state.diagonal[row] += carried.abs();
                    }
                }
                for (side, direction) in [(link.a, 1.0), (link.b, -1.0)] {
                    if side >= count {
                        state.unknown[row] -= sign * direction * conductance * state.q[side];
                    } else if state.full[side] {
                        state.matrix.add(row, side, sign * direction * conductance);
                    }
                }
            }
        }
        for (cell, data) in grid.cells.iter().enumerate() {
            if data.held.is_some() || !(conserving || state.full[cell]) {
                state.matrix.add(cell, cell, 1.0);
                continue;
            }
            let (rate, gap) = (
                data.area * state.cell_rate[cell],
                data.area * state.cell_gap[cell],
            );
            if state.full[cell] {
                let filling = past.map_or(0.0, |(step, before)| (1.0 - before[cell]) * gap / step);
                state.unknown[cell] -= rate + filling;
                continue;
            }
            let mut diagonal = rate;
            match past {
                Some((step, before)) => {
                    diagonal += gap / step;
                    state.unknown[cell] += before[cell] * gap / step;
                }
                None => diagonal += DRYING * state.diagonal[cell],
            }
            state.diagonal[cell] += diagonal;
            state.matrix.add(cell, cell, diagonal);
        }
    }
}

/// The column with most cells of the cavity and of openings. If it has no others, the border is cut.
fn border(grid: &Grid, full: &[bool]) -> usize {
    let free = |column: usize| {
        let cells = column * grid.across..(column + 1) * grid.across;
        cells
            .filter(|cell| full[*cell] && grid.cells[*cell].held.is_none())
            .count()
    };
    (0..grid.around)
        .min_by_key(|column| free(*column))
        .unwrap_or(0)
}

/// Outflow of each cell at the present pressure, for the rule that has no content.
fn slack(grid: &Grid, state: &mut LevelWork, spin: f64) {
    for (slack, (cell, rate)) in state
        .slack
        .iter_mut()
        .zip(grid.cells.iter().zip(&state.cell_rate))
    {
        let squeezed = cell.area * rate;
        *slack = [squeezed, squeezed.abs()];
    }
    for (at, link) in grid.links.iter().enumerate() {
        let carried = spin * link.carry * state.link_gap[at];
        let pressed = state.conductance[at][0] * (state.q[link.a] - state.q[link.b]);
        let size = carried.abs() + pressed.abs();
        for (side, sign) in [(link.a, 1.0), (link.b, -1.0)] {
            if let Some([sum, parts]) = state.slack.get_mut(side) {
                *sum += sign * (carried + pressed);
                *parts += size;
            }
        }
    }
}

/// Moves cells that break an inequality to the other set; the last of them.
///
/// A cell whose gap closes faster than its content leaves within the step has no positive diagonal: it fills.
fn change(grid: &Grid, state: &mut LevelWork, rule: Cavitation, round: usize) -> Option<usize> {
    let highest = state
        .q
        .iter()
        .fold(0.0_f64, |highest, q| highest.max(q.abs()));
    let mut changed = None;
    for (cell, data) in grid.cells.iter().enumerate() {
        if data.held.is_some() {
            continue;
        }
        let wants = match (state.full[cell], rule) {
            (true, _) => state.q[cell] < -ROUNDING * highest,
            (false, Cavitation::MassConserving) => {
                state.content[cell] > 1.0 + ROUNDING || state.diagonal[cell] <= 0.0
            }
            (false, _) => state.slack[cell][0] < -ROUNDING * state.slack[cell][1],
        };
        if !wants {
            continue;
        }
        changed = Some(cell);
        // from here on some pattern of cells repeats itself: another half of them changes each round
        let hash = (cell.wrapping_add(round).wrapping_mul(0x9E37_79B9) >> 7) % 2;
        if round <= DAMPED || hash == 0 {
            state.full[cell] = !state.full[cell];
        }
    }
    changed
}
