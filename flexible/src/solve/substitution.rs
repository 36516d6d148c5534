//! Solutions with a factor: a branch of its tree after the other downwards, then upwards, branches on several threads.
//!
//! Right-hand sides are rows of a matrix here, in the order of elimination. A branch collects what it subtracts from
//! rows above it. These sums are subtracted in the order of the branches, so the bits do not depend on the threads.

use super::numeric::{Pair, Pairs, each};
use super::panels::Panels;
use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::{
    solve_lower_triangular_in_place, solve_unit_lower_triangular_in_place,
    solve_unit_upper_triangular_in_place, solve_upper_triangular_in_place,
};
use faer::{Accum, MatMut, MatRef, Par};
use std::ops::Range;

/// Rows of a panel above the branches that one thread multiplies.
const SHARE: usize = 1024;
/// A panel of fewer values is ready before a thread has started.
const SMALL: usize = 200_000;

/// A factor and a number of right-hand sides.
pub(super) struct Substitution<'a> {
    pub(super) panels: &'a Panels,
    pub(super) values: &'a [f64],
    pub(super) pairs: &'a Pairs,
    /// Number of right-hand sides.
    pub(super) count: usize,
}

/// A branch at work: its rows of the right-hand sides, and those above it.
struct Branch<'a> {
    panels: Range<usize>,
    first: usize,
    own: &'a mut [f64],
    rows: &'a [u32],
    above: &'a mut [f64],
}

/// Memory of a thread.
#[derive(Default)]
struct Scratch {
    gathered: Vec<f64>,
    place: Vec<u32>,
}

impl Substitution<'_> {
    /// Solves in the place of the right-hand sides.
    pub(super) fn solve(&self, x: &mut [f64], threads: usize) {
        let branches = self.panels.branches();
        let rows: Vec<Vec<u32>> = branches
            .iter()
            .map(|branch| self.panels.above(branch))
            .collect();
        let mut above: Vec<Vec<f64>> = rows
            .iter()
            .map(|rows| vec![0.0; rows.len() * self.count])
            .collect();
        let mut workers: Vec<Scratch> = Vec::new();
        workers.resize_with(threads.max(1), Scratch::default);
        let top = self.panels.top();
        each(
            self.split(x, &rows, &mut above),
            &mut workers,
            |branch, worker| {
                self.down_branch(branch, worker);
            },
        );
        for (rows, above) in rows.iter().zip(&above) {
            for (&row, sums) in rows.iter().zip(above.chunks_exact(self.count)) {
                let own = &mut x[row as usize * self.count..][..self.count];
                own.iter_mut().zip(sums).for_each(|(x, sum)| *x += sum);
            }
        }
        let mut gathered = Vec::new();
        for &panel in &top {
            let columns = self.panels.columns(panel);
            let (head, tail) = x.split_at_mut(columns.end * self.count);
            let own = &mut head[columns.start * self.count..];
            self.down(panel, own);
            self.products(panel, own, &mut gathered, &mut workers);
            let rows = self.panels.rows(panel);
            for (&row, product) in rows.iter().zip(gathered.chunks_exact(self.count)) {
                let place = (row as usize - columns.end) * self.count;
                let own = &mut tail[place..place + self.count];
                own.iter_mut().zip(product).for_each(|(x, y)| *x += y);
            }
        }
        for &panel in top.iter().rev() {
            let columns = self.panels.columns(panel);
            let (head, tail) = x.split_at_mut(columns.end * self.count);
            gathered.clear();
            for &row in self.panels.rows(panel) {
                let place = (row as usize - columns.end) * self.count;
                gathered.extend_from_slice(&tail[place..place + self.count]);
            }
            let own = &mut head[columns.start * self.count..];
            self.up(panel, own, &gathered, &mut workers);
        }
        for (rows, above) in rows.iter().zip(&mut above) {
            for (&row, above) in rows.iter().zip(above.chunks_exact_mut(self.count)) {
                above.copy_from_slice(&x[row as usize * self.count..][..self.count]);
            }
        }
        each(
            self.split(x, &rows, &mut above),
            &mut workers,
            |branch, worker| {
                self.up_branch(branch, worker);
            },
        );
    }

    /// The branches with their rows.
    fn split<'a>(
        &self,
        x: &'a mut [f64],
        rows: &'a [Vec<u32>],
        above: &'a mut [Vec<f64>],
    ) -> Vec<Branch<'a>> {
        let (mut rest, mut at) = (x, 0);
        let mut branches = Vec::new();
        let outer = rows.iter().zip(above);
        for (panels, (rows, above)) in self.panels.branches().iter().zip(outer) {
            let first = self.panels.columns(panels.start).start;
            let end = self.panels.columns(panels.end - 1).end;
            let (_, from_here) = rest.split_at_mut((first - at) * self.count);
            let (own, after) = from_here.split_at_mut((end - first) * self.count);
            branches.push(Branch {
                panels: panels.clone(),
                first,
                own,
                rows,
                above,
            });
            (rest, at) = (after, end);
        }
        branches
    }

    fn down_branch(&self, branch: Branch<'_>, worker: &mut Scratch) {
        let Branch {
            panels,
            first,
            own,
            rows,
            above,
        } = branch;
        self.number(rows, worker);
        let end = first + own.len() / self.count;
        for panel in panels {
            let columns = self.panels.columns(panel);
            let begin = (columns.start - first) * self.count;
            let length = columns.len() * self.count;
            let x = &mut own[begin..begin + length];
            self.down(panel, x);
            self.products(panel, x, &mut worker.gathered, &mut [()]);
            let products = worker.gathered.chunks_exact(self.count);
            for (&row, product) in self.panels.rows(panel).iter().zip(products) {
                let row = row as usize;
                let target = if row < end {
                    &mut own[(row - first) * self.count..][..self.count]
                } else {
                    &mut above[worker.place[row] as usize * self.count..][..self.count]
                };
                target.iter_mut().zip(product).for_each(|(x, y)| *x += y);
            }
        }
    }

    fn up_branch(&self, branch: Branch<'_>, worker: &mut Scratch) {
        let Branch {
            panels,
            first,
            own,
            rows,
            above,
        } = branch;
        self.number(rows, worker);
        let end = first + own.len() / self.count;
        for panel in panels.rev() {
            worker.gathered.clear();
            for &row in self.panels.rows(panel) {
                let row = row as usize;
                worker.gathered.extend_from_slice(if row < end {
                    &own[(row - first) * self.count..][..self.count]
                } else {
                    &above[worker.place[row] as usize * self.count..][..self.count]
                });
            }
            let columns = self.panels.columns(panel);
            let begin = (columns.start - first) * self.count;
            let length = columns.len() * self.count;
            let x = &mut own[begin..begin + length];
            self.up(panel, x, &worker.gathered, &mut [()]);
        }
    }

    /// Notes the places of the rows above a branch.
    fn number(&self, rows: &[u32], worker: &mut Scratch) {
        let size = self.panels.columns(self.panels.count() - 1).end;
        worker.place.resize(size, 0);
        for (place, &row) in rows.iter().enumerate() {
            worker.place[row as usize] = place as u32;
        }
    }

    /// A panel downwards: `x = L⁻¹ x`.
    fn down(&self, panel: usize, x: &mut [f64]) {
        let (matrix, width) = self.matrix(panel);
        if let Some(order) = self.order(panel) {
            let old = x.to_vec();
            for (&from, to) in order.iter().zip(x.chunks_exact_mut(self.count)) {
                to.copy_from_slice(&old[from as usize * self.count..][..self.count]);
            }
        }
        let (top, _) = matrix.split_at_row(width);
        let x = MatMut::from_row_major_slice_mut(x, width, self.count);
        if self.pairs.below.is_empty() {
            solve_lower_triangular_in_place(top, x, Par::Seq);
        } else {
            solve_unit_lower_triangular_in_place(top, x, Par::Seq);
        }
    }

    /// Minus the products of a panel for the rows below it.
    fn products<W: Send>(&self, panel: usize, x: &[f64], out: &mut Vec<f64>, workers: &mut [W]) {
        let (matrix, width) = self.matrix(panel);
        let (_, bottom) = matrix.split_at_row(width);
        let x = MatRef::from_row_major_slice(x, width, self.count);
        out.clear();
        out.resize(bottom.nrows() * self.count, 0.0);
        let shares = out.chunks_mut(SHARE * self.count).enumerate().collect();
        let workers = self.needed(panel, workers);
        each(shares, workers, |(share, out): (usize, &mut [f64]), _| {
            let count = out.len() / self.count;
            let rows = bottom.subrows(share * SHARE, count);
            let out = MatMut::from_row_major_slice_mut(out, count, self.count);
            matmul(out, Accum::Replace, rows, x, -1.0, Par::Seq);
        });
    }

    /// One worker for a panel with few values, else all.
    fn needed<'a, W>(&self, panel: usize, workers: &'a mut [W]) -> &'a mut [W] {
        let few = self.panels.place(panel).len() < SMALL;
        let count = if few { 1 } else { workers.len() };
        &mut workers[..count]
    }

    /// A panel upwards: `x = L⁻ᵀ (B⁻¹ x − L_belowᵀ below)`.
    fn up<W: Send>(&self, panel: usize, x: &mut [f64], below: &[f64], workers: &mut [W]) {
        let (matrix, width) = self.matrix(panel);
        let (top, bottom) = matrix.split_at_row(width);
        let order = self.order(panel);
        if order.is_some() {
            let columns = self.panels.columns(panel);
            self.divide(top, &self.pairs.below[columns], x);
        }
        let mut sums = vec![0.0; bottom.nrows().div_ceil(SHARE) * x.len()];
        let shares = sums.chunks_exact_mut(x.len());
        let shares = shares
            .zip(below.chunks(SHARE * self.count))
            .enumerate()
            .collect();
        let workers = self.needed(panel, workers);
        each(
            shares,
            workers,
            |(share, (sum, below)): (usize, (&mut [f64], &[f64])), _| {
                let count = below.len() / self.count;
                let rows = bottom.subrows(share * SHARE, count);
                let below = MatRef::from_row_major_slice(below, count, self.count);
                let sum = MatMut::from_row_major_slice_mut(sum, width, self.count);
                matmul(sum, Accum::Replace, rows.transpose(), below, -1.0, Par::Seq);
            },
        );
        for sum in sums.chunks_exact(x.len()) {
            x.iter_mut().zip(sum).for_each(|(x, y)| *x += y);
        }
        let rows = MatMut::from_row_major_slice_mut(&mut *x, width, self.count);
        if let Some(order) = order {
            solve_unit_upper_triangular_in_place(top.transpose(), rows, Par::Seq);
            let old = x.to_vec();
            for (&to, from) in order.iter().zip(old.chunks_exact(self.count)) {
                x[to as usize * self.count..][..self.count].copy_from_slice(from);
            }
        } else {
            solve_upper_triangular_in_place(top.transpose(), rows, Par::Seq);
        }
    }

    /// `B⁻¹ x`.
    fn divide(&self, top: MatRef<'_, f64>, below: &[f64], x: &mut [f64]) {
        let mut row = 0;
        while let Some(&coupling) = below.get(row) {
            let (_, rest) = x.split_at_mut(row * self.count);
            if coupling == 0.0 || row + 1 == below.len() {
                let pivot = top[(row, row)];
                rest[..self.count].iter_mut().for_each(|x| *x /= pivot);
                row += 1;
            } else {
                let pair = Pair::at(top, row, coupling);
                let (x, y) = rest.split_at_mut(self.count);
                for (x, y) in x.iter_mut().zip(y) {
                    [*x, *y] = pair.divide([*x, *y]);
                }
                row += 2;
            }
        }
    }

    fn matrix(&self, panel: usize) -> (MatRef<'_, f64>, usize) {
        let width = self.panels.columns(panel).len();
        let values = &self.values[self.panels.place(panel)];
        let matrix = MatRef::from_column_major_slice(values, self.panels.height(panel), width);
        (matrix, width)
    }

    /// The order of the pivots of a panel, for an indefinite matrix.
    fn order(&self, panel: usize) -> Option<&[u32]> {
        self.pairs
            .forward
            .get(self.panels.columns(panel))
            .filter(|order| !order.is_empty())
    }
}
