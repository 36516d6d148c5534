//! Openings of the pin, which turn over the cells of the shell.
//!
//! An opening of the pin covers a share x of the largest width m that it can have in common with a column of
//! cells. With `s = m x² (3 − 2x)`, m as a share of the column, each cell of the rows that the opening
//! reaches has a link to the oil of the opening, and its faces come closer to it:
//!
//! ```text
//! conductance of the link       k s/(1 − s + δ)        k = h³/12μ times the sum of both aspect ratios of the cell, twice
//! distance of a side from its face          (1 − s) times that of a cell without opening
//! length of a face at an end                (1 − s) times that of a cell without opening
//! ```
//!
//! Only an opening that reaches over an end covers cells at this end. Its oil does not flow through the gap to the end.
//!
//! So an uncovered cell has its usual equation, and a covered one the pressure of the opening, except for a
//! part δ. Where the edges lie on lines of the grid, the equations are those of an opening of the shell. In
//! between they change with the turn with continuous slopes. An error of the place of an edge, half a cell at
//! most, is left.
//!
//! An opening of the shell takes precedence over one of the pin: its cells have no such link.

use crate::film::{Film, Level, LevelWork, Work};
use crate::inputs::TURN;
use std::f64::consts::TAU;

/// δ: share by which the pressure of a covered cell may differ from that of its opening, roughly. A choice:
/// the square root of the rounding unit, so that neither the pressure nor the digits of the matrix lose more
/// than eight digits.
const LEAK: f64 = 1e-8;

/// Length that an opening of a length L (rad), whose first edge lies `start` behind the first line of a column (in 0 to
/// 2π), shares with this column of a width, and the slope of this length by `start`.
fn shared(start: f64, length: f64, width: f64) -> [f64; 2] {
    let end = start + length;
    let mut sum = [0.0; 2];
    if start < width {
        let inside = end < width;
        sum[0] += end.min(width) - start;
        sum[1] -= f64::from(u8::from(!inside));
    }
    // the end of an opening that comes round again
    if end > TAU {
        let inside = end < TAU + width;
        sum[0] += (end - TAU).min(width);
        sum[1] += f64::from(u8::from(inside));
    }
    sum
}

impl Film {
    /// Shares of the cells that openings of the pin cover, with their slopes by the turn, and the factors
    /// that these shares make of the weights of links. Does nothing for a film without such openings.
    pub(crate) fn set_turning(&self, level: &Level, state: &mut LevelWork, x: &[f64]) {
        let grid = &level.grid;
        if grid.feedings.is_empty() {
            return;
        }
        state.covered.fill([0.0; 2]);
        for (feeding, factor) in grid.feedings.iter().zip(&mut state.turning) {
            let column = feeding.cell / grid.across;
            let [from, to] = self.source.openings[feeding.opening].around;
            let start = (from + x[TURN] - grid.angles[column]).rem_euclid(TAU);
            let width = grid.cells[feeding.cell].sector;
            let [length, by_turn] = shared(start, to - from, width);
            let most = width.min(to - from);
            let (share, by_turn) = ((length / most).min(1.0), by_turn / most);
            let covered = most / width * share * share * (3.0 - 2.0 * share);
            let slope = most / width * 6.0 * share * (1.0 - share) * by_turn;
            let left = 1.0 - covered + LEAK;
            *factor = [covered / left, slope * (1.0 + LEAK) / (left * left)];
            let own = &mut state.covered[feeding.cell];
            *own = [own[0] + covered, own[1] + slope];
        }
        let (first, ends) = (grid.feedings.len(), grid.ends(&self.source));
        let links = grid.links.iter().zip(&grid.reaches).skip(first);
        for ((link, reaches), factor) in links.zip(state.turning[first..].iter_mut()) {
            if link.a == ends || link.b == ends {
                let cell = link.a.min(link.b);
                let [covered, slope] = state.covered.get(cell).copied().unwrap_or_default();
                *factor = [(1.0 - covered).max(0.0), -slope];
                continue;
            }
            let (mut near, mut slope) = (0.0, 0.0);
            for (side, reach) in [(link.a, reaches[0]), (link.b, reaches[1])] {
                // fixed places have no reach
                let covered = state.covered.get(side).copied().unwrap_or_default();
                near += reach * (1.0 - covered[0]);
                slope -= reach * covered[1];
            }
            let whole = reaches[0] + reaches[1];
            let near = near.max(LEAK.sqrt() * whole);
            *factor = [whole / near, -whole * slope / (near * near)];
        }
    }
}

/// The factors of all links and the shares of all cells at inputs of a film, each with its slope by the turn.
pub fn factors_and_shares(film: &Film, work: &mut Work, x: &[f64]) -> [Vec<[f64; 2]>; 2] {
    let (level, state) = (&film.levels[0], &mut work.levels[0]);
    film.set_gap(level, state, x);
    [state.turning.clone(), state.covered.clone()]
}
