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
use crate::film::{Film, Level, LevelWork, Side, Work};
use crate::grid::Grid;
use crate::inputs::SPIN;
use crate::ring::OWN;
use crate::source::Cavitation;
use eng_system::dense::largest;

/// Rounds after which only half of the cells that break an inequality change. This ends a cycle of sets. A
/// choice: a search without a cycle is Newton's method and ends long before, so damping never slows it down.
const DAMPED: usize = 40;

/// Most rounds. A choice: a film that has found no cavity after 160 damped rounds is refused with the place
/// at which cells still change.
const ROUNDS: usize = 200;

/// Amount by which a round may break an inequality: the rounding of a solution, relative to its largest
/// number or to the terms of a sum. Rounding alone is some 1e-16 times the numbers of cells in a row; a limit
/// near it would change cells at the edge of the cavity for ever, and a much larger one leaves suction in the
/// film.
const ROUNDING: f64 = 1e-12;

/// Share of its outflow that a steady cell of the cavity loses. A ring of cells without oil has no unique
/// content; this makes it dry. The share is a choice: after a turn over hundreds of cells the oil is still
/// right to nine digits, and the matrix is far from singular.
const DRYING: f64 = 1e-12;

impl Film {
    /// Finds the cavity on one grid from the guess in `full`, and returns the number of rounds. `past` has
    /// the step and the content before it.
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
            state.limited.fill(false);
        }
        let mut moving = 0;
        for round in 1..=ROUNDS {
            self.assemble(grid, state, rule, x[SPIN], past);
            state.matrix.factor(
                border(grid, &state.sides, x[SPIN] >= 0.0),
                x[SPIN] >= 0.0,
                rule != Cavitation::MassConserving && grid.edges.is_empty(),
            );
            state.matrix.solve(&mut state.unknown);
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

    /// Share of the area whose cells are at the edge of the cavity in the last solution: they have neither
    /// pressure nor outflow, as all cells of a centred film at rest. There the outputs have other derivatives
    /// on both sides, and [`Film::tangent`] gives those of one side. The share is known for the rule
    /// [`Cavitation::Reynolds`] alone; for the others it is zero.
    #[must_use]
    pub fn undecided(&self, work: &Work) -> f64 {
        let (level, state) = (&self.levels[0], &work.levels[0]);
        if self.source.cavitation == Cavitation::MassConserving {
            return 0.0;
        }
        let highest = largest(&state.q);
        let (mut all, mut undecided) = (0.0, 0.0);
        for (at, cell) in level.grid.cells.iter().enumerate() {
            all += cell.area;
            let [outflow, parts] = state.slack[at];
            let edge = match state.full[at] {
                true => state.q[at].abs() <= ROUNDING * highest,
                false => outflow.abs() <= ROUNDING * parts,
            };
            if edge && cell.held.is_none() {
                undecided += cell.area;
            }
        }
        undecided / all
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
        set_sides(grid, state, conserving);
        let (rows, sides) = (state.matrix.rows.as_mut_slice(), state.sides.as_slice());
        let known = state.unknown.as_mut_slice();
        rows.fill([0.0; 5]);
        known.fill(0.0);
        for ((link, gap), conductance) in grid
            .links
            .iter()
            .zip(&state.link_gap)
            .zip(&state.conductance)
        {
            let (a, b) = (sides[link.a], sides[link.b]);
            let carried = spin * link.carry * gap;
            let [own, other] = [conductance * a.pressed, conductance * b.pressed];
            // content of the cavity is an unknown: the flow it gives is a number of the matrix
            let (flow, from_a, from_b) = if spin >= 0.0 {
                (carried * a.content, carried * a.carrying, 0.0)
            } else {
                (carried * b.content, 0.0, carried * b.carrying)
            };
            let row = &mut rows[link.a];
            row[OWN] += own + from_a;
            row[link.toward] = from_b - other;
            let row = &mut rows[link.b];
            row[OWN] += other - from_b;
            row[link.toward + 1] = -own - from_a;
            known[link.a] += conductance * b.q - flow;
            known[link.b] += conductance * a.q + flow;
        }
        for (edge, limited) in grid.edges.iter().zip(&state.limited) {
            let factors = edge.factors(*limited);
            let [own, inner, fixed] = factors.map(|factor| factor * state.conductance[edge.link]);
            let [first, second] = edge.cells;
            rows[first][OWN] += own * sides[first].pressed;
            rows[first][edge.toward] += inner * sides[second].pressed;
            known[first] -= fixed * sides[edge.fixed].q;
        }
        for (cell, data) in grid.cells.iter().enumerate() {
            let side = &sides[cell];
            let known = &mut known[cell];
            if side.pressed == 0.0 && side.carrying == 0.0 {
                rows[cell] = [1.0, 0.0, 0.0, 0.0, 0.0];
                *known = 0.0;
                continue;
            }
            let (rate, gap) = (
                data.area * state.cell_rate[cell],
                data.area * state.cell_gap[cell],
            );
            if state.full[cell] {
                let filling = past.map_or(0.0, |(step, before)| (1.0 - before[cell]) * gap / step);
                *known -= rate + filling;
                continue;
            }
            let diagonal = &mut rows[cell][OWN];
            match past {
                Some((step, before)) => {
                    *diagonal += rate + gap / step;
                    *known += before[cell] * gap / step;
                }
                None => *diagonal += rate + DRYING * *diagonal,
            }
        }
    }
}

/// Sorts the cells by the present set.
fn set_sides(grid: &Grid, state: &mut LevelWork, conserving: bool) {
    let (cells, fixed) = state.sides.split_at_mut(grid.cells.len());
    for ((side, data), full) in cells.iter_mut().zip(&grid.cells).zip(&state.full) {
        let (free, full) = (data.held.is_none(), *full);
        let carrying = conserving && !full;
        *side = Side {
            pressed: f64::from(u8::from(free && full)),
            carrying: f64::from(u8::from(free && carrying)),
            q: 0.0,
            content: f64::from(u8::from(!carrying)),
        };
    }
    let first = grid.cells.len();
    for (at, side) in fixed.iter_mut().enumerate() {
        side.q = state.q[first + at];
        side.content = if conserving {
            state.content[first + at]
        } else {
            1.0
        };
    }
}

/// The cheapest column for the border. It has the fewest unknowns, and of equal ones the fewest full cells
/// in it and in the column behind it: only full cells couple in both directions.
fn border(grid: &Grid, sides: &[Side], eastwards: bool) -> usize {
    let count = |column: usize| {
        let cells = &sides[column * grid.across..(column + 1) * grid.across];
        cells.iter().fold((0, 0), |(unknown, full), side| {
            let pressed = usize::from(side.pressed != 0.0);
            let carrying = usize::from(side.carrying != 0.0);
            (unknown + pressed + carrying, full + pressed)
        })
    };
    let step = if eastwards { 1 } else { grid.around - 1 };
    (0..grid.around)
        .min_by_key(|column| {
            let (unknown, full) = count(*column);
            (unknown, full + count((column + step) % grid.around).1)
        })
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
        // the outflow is needed for cells of the cavity alone
        if state.sides[link.a].pressed + state.sides[link.b].pressed == 2.0 {
            continue;
        }
        let carried = spin * link.carry * state.link_gap[at];
        let pressed = state.conductance[at] * (state.q[link.a] - state.q[link.b]);
        let size = carried.abs() + pressed.abs();
        for (side, sign) in [(link.a, 1.0), (link.b, -1.0)] {
            if let Some([sum, parts]) = state.slack.get_mut(side) {
                *sum += sign * (carried + pressed);
                *parts += size;
            }
        }
    }
    for (edge, limited) in grid.edges.iter().zip(&state.limited) {
        let drop = edge.outward * edge.drop(*limited, |side| state.q[side]);
        let pressed = state.conductance[edge.link] * drop;
        let [sum, parts] = &mut state.slack[edge.cells[0]];
        *sum += pressed;
        *parts += pressed.abs();
    }
}

/// Moves cells that break an inequality to the other set, and returns the last of them.
///
/// A cell whose gap closes faster than its content leaves within the step has no positive diagonal: it fills.
fn change(grid: &Grid, state: &mut LevelWork, rule: Cavitation, round: usize) -> Option<usize> {
    let highest = largest(&state.q);
    let mut changed = None;
    for (edge, limited) in grid.edges.iter().zip(&mut state.limited) {
        let next = edge.is_at_limit(*limited, ROUNDING * highest, |side| state.q[side]);
        if next != *limited {
            (*limited, changed) = (next, Some(edge.cells[0]));
        }
    }
    for (cell, data) in grid.cells.iter().enumerate() {
        if data.held.is_some() {
            continue;
        }
        let wants = match (state.full[cell], rule) {
            (true, _) => state.q[cell] < -ROUNDING * highest,
            (false, Cavitation::MassConserving) => {
                state.content[cell] > 1.0 + ROUNDING || state.matrix.rows[cell][OWN] <= 0.0
            }
            (false, _) => state.slack[cell][0] < -ROUNDING * state.slack[cell][1],
        };
        if !wants {
            continue;
        }
        changed = Some(cell);
        // the sets may repeat in a cycle from here on: each round changes another half of the cells, which
        // multiplicative hashing by 2³² over the golden ratio chooses
        let hash = (cell.wrapping_add(round).wrapping_mul(0x9E37_79B9) >> 7) % 2;
        if round <= DAMPED || hash == 0 {
            state.full[cell] = !state.full[cell];
        }
    }
    changed
}
