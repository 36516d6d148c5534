//! The values of a factor, panel by panel, on several threads.
//!
//! A panel takes the products of its sources, from the first to the last, is factored at its diagonal, and divides the
//! rows below by it. Threads compute whole branches side by side. The panels above all branches follow one after the
//! other, and threads share their rows. The rows of a share do not depend on the number of threads, so that neither do
//! the bits.

use super::panels::Panels;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::{lblt, llt};
use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::{
    solve_lower_triangular_in_place, solve_unit_lower_triangular_in_place,
};
use faer::perm::PermRef;
use faer::{Accum, ColMut, MatMut, MatRef, Par};
use std::sync::{Mutex, PoisonError};

/// Rows of a share. A share of this many rows and the widest panel fit into a cache of one megabyte.
const SHARE: usize = 384;
/// A panel of fewer values is ready before a thread has started.
const SMALL: usize = 40_000;

/// The pairs of rows of an indefinite factor.
#[derive(Debug, Default)]
pub(super) struct Pairs {
    /// Entries below the diagonal of B; zero for a row that is a pivot alone.
    pub(super) below: Vec<f64>,
    /// The rows of each panel in the order of their pivots, counted from its first row, and the inverse.
    pub(super) forward: Vec<u32>,
    pub(super) inverse: Vec<u32>,
}

/// Why a factorisation ended early.
pub(super) enum Stopped {
    /// The pivot of this column is not positive.
    NotPositive(usize),
    /// There is not enough memory.
    Memory,
}

impl Stopped {
    fn order(&self) -> usize {
        match self {
            Stopped::NotPositive(column) => *column,
            Stopped::Memory => usize::MAX,
        }
    }
}

/// Memory of a thread.
struct Scratch {
    stack: MemBuffer,
    product: Vec<f64>,
    scaled: Vec<f64>,
}

impl Scratch {
    fn new(widest: usize) -> Result<Self, Stopped> {
        let stack =
            llt::factor::cholesky_in_place_scratch::<f64>(widest, Par::Seq, Default::default())
                .or(lblt::factor::cholesky_in_place_scratch::<u32, f64>(
                    widest,
                    Par::Seq,
                    Default::default(),
                ))
                .or(faer::perm::permute_cols_in_place_scratch::<u32, f64>(
                    SHARE, widest,
                ));
        Ok(Scratch {
            stack: MemBuffer::try_new(stack).map_err(|_| Stopped::Memory)?,
            product: Vec::new(),
            scaled: Vec::new(),
        })
    }
}

/// The values and pairs of some neighbouring panels. The pairs of a positive matrix are empty.
struct Part<'a> {
    values: &'a mut [f64],
    below: &'a mut [f64],
    forward: &'a mut [u32],
    inverse: &'a mut [u32],
}

fn cut<T>(slice: &mut [T], at: usize) -> (&mut [T], &mut [T]) {
    slice.split_at_mut(at.min(slice.len()))
}

impl<'a> Part<'a> {
    /// The first values and columns, and the others.
    fn split(self, values: usize, columns: usize) -> (Part<'a>, Part<'a>) {
        let (values, more_values) = cut(self.values, values);
        let (below, more_below) = cut(self.below, columns);
        let (forward, more_forward) = cut(self.forward, columns);
        let (inverse, more_inverse) = cut(self.inverse, columns);
        (
            Part {
                values,
                below,
                forward,
                inverse,
            },
            Part {
                values: more_values,
                below: more_below,
                forward: more_forward,
                inverse: more_inverse,
            },
        )
    }

    /// The same part for a shorter time.
    fn again(&mut self) -> Part<'_> {
        Part {
            values: self.values,
            below: self.below,
            forward: self.forward,
            inverse: self.inverse,
        }
    }
}

/// Panels that are ready, from one on.
struct Earlier<'a> {
    panels: &'a Panels,
    values: &'a [f64],
    below: &'a [f64],
    /// The first value and the first column.
    first: (usize, usize),
    indefinite: bool,
}

impl<'a> Earlier<'a> {
    /// A panel, and the entries of B below its diagonal.
    fn panel(&self, panel: usize) -> (MatRef<'a, f64>, &'a [f64]) {
        let columns = self.panels.columns(panel);
        let place = self.panels.place(panel);
        let values = &self.values[place.start - self.first.0..place.end - self.first.0];
        let below = if self.indefinite {
            &self.below[columns.start - self.first.1..columns.end - self.first.1]
        } else {
            &[]
        };
        let height = self.panels.height(panel);
        (
            MatRef::from_column_major_slice(values, height, columns.len()),
            below,
        )
    }
}

/// Factors the values in their place. The pairs have the size of the matrix for an indefinite one and are empty else.
pub(super) fn factor(
    panels: &Panels,
    values: &mut [f64],
    pairs: &mut Pairs,
    threads: usize,
) -> Result<(), Stopped> {
    let Some(last) = panels.count().checked_sub(1) else {
        return Ok(());
    };
    let size = panels.columns(last).end;
    let widths = (0..=last).map(|panel| panels.columns(panel).len());
    let widest = widths.max().unwrap_or(0);
    let mut whole = Part {
        values,
        below: &mut pairs.below,
        forward: &mut pairs.forward,
        inverse: &mut pairs.inverse,
    };
    let indefinite = !whole.below.is_empty();
    let mut workers = (0..threads.max(1))
        .map(|_| Scratch::new(widest))
        .collect::<Result<Vec<_>, _>>()?;
    branches(panels, whole.again(), size, &mut workers)?;
    let mut local = vec![0u32; size];
    for panel in panels.top() {
        let (columns, place) = (panels.columns(panel), panels.place(panel));
        let (earlier, rest) = whole.again().split(place.start, columns.start);
        let (own, _) = rest.split(place.len(), columns.len());
        let earlier = Earlier {
            panels,
            values: earlier.values,
            below: earlier.below,
            first: (0, 0),
            indefinite,
        };
        let count = if place.len() < SMALL {
            1
        } else {
            workers.len()
        };
        one(&earlier, panel, own, &mut local, &mut workers[..count])?;
    }
    Ok(())
}

/// Factors the branches, each on one thread.
fn branches(
    panels: &Panels,
    whole: Part<'_>,
    size: usize,
    workers: &mut [Scratch],
) -> Result<(), Stopped> {
    let mut tasks = Vec::new();
    let (mut rest, mut at) = (whole, (0, 0));
    for branch in panels.branches() {
        let first = (
            panels.place(branch.start).start,
            panels.columns(branch.start).start,
        );
        let end = (
            panels.place(branch.end - 1).end,
            panels.columns(branch.end - 1).end,
        );
        let (_, from_here) = rest.split(first.0 - at.0, first.1 - at.1);
        let (own, after) = from_here.split(end.0 - first.0, end.1 - first.1);
        tasks.push((branch.clone(), first, own));
        (rest, at) = (after, end);
    }
    let failures = Mutex::new(Vec::new());
    each(tasks, workers, |(branch, first, mut own), worker| {
        let mut local = vec![0u32; size];
        for panel in branch {
            let (columns, place) = (panels.columns(panel), panels.place(panel));
            let indefinite = !own.below.is_empty();
            let (earlier, rest) = own
                .again()
                .split(place.start - first.0, columns.start - first.1);
            let (one_part, _) = rest.split(place.len(), columns.len());
            let earlier = Earlier {
                panels,
                values: earlier.values,
                below: earlier.below,
                first,
                indefinite,
            };
            let worker = std::slice::from_mut(&mut *worker);
            if let Err(stopped) = one(&earlier, panel, one_part, &mut local, worker) {
                failures
                    .lock()
                    .unwrap_or_else(PoisonError::into_inner)
                    .push(stopped);
                return;
            }
        }
    });
    // the first one in the order of elimination, whichever thread was faster
    let failures = failures
        .into_inner()
        .unwrap_or_else(PoisonError::into_inner);
    failures
        .into_iter()
        .min_by_key(Stopped::order)
        .map_or(Ok(()), Err)
}

/// Does tasks, each with the memory of a worker. With several workers each has a thread of its own.
pub(super) fn each<T: Send, W: Send>(
    tasks: Vec<T>,
    workers: &mut [W],
    work: impl Fn(T, &mut W) + Sync,
) {
    if let [worker] = workers {
        tasks.into_iter().for_each(|task| work(task, worker));
        return;
    }
    if let ([_], Some(worker)) = (&tasks[..], workers.first_mut()) {
        return tasks.into_iter().for_each(|task| work(task, worker));
    }
    let tasks = Mutex::new(tasks.into_iter());
    std::thread::scope(|scope| {
        for worker in workers {
            let (tasks, work) = (&tasks, &work);
            scope.spawn(move || {
                loop {
                    let next = tasks.lock().unwrap_or_else(PoisonError::into_inner).next();
                    let Some(task) = next else { return };
                    work(task, worker);
                }
            });
        }
    });
}

/// The rows of a matrix in shares, each with the number of its first row.
fn shares(matrix: MatMut<'_, f64>) -> Vec<(usize, MatMut<'_, f64>)> {
    let mut shares = Vec::new();
    let (mut rest, mut first) = (matrix, 0);
    while rest.nrows() > SHARE {
        let (share, below) = rest.split_at_row_mut(SHARE);
        shares.push((first, share));
        (rest, first) = (below, first + SHARE);
    }
    shares.push((first, rest));
    shares
}

/// Factors one panel. Its shares of rows are tasks of the workers.
fn one(
    earlier: &Earlier<'_>,
    panel: usize,
    part: Part<'_>,
    local: &mut [u32],
    workers: &mut [Scratch],
) -> Result<(), Stopped> {
    let panels = earlier.panels;
    let columns = panels.columns(panel);
    let (width, height) = (columns.len(), panels.height(panel));
    for (place, row) in columns.clone().enumerate() {
        local[row] = place as u32;
    }
    for (place, &row) in panels.rows(panel).iter().enumerate() {
        local[row as usize] = (width + place) as u32;
    }
    let local = &*local;
    let matrix = MatMut::from_column_major_slice_mut(&mut *part.values, height, width);
    each(shares(matrix), workers, |(first, share), worker| {
        update(earlier, panel, first, share, local, worker);
    });
    let Some(worker) = workers.first_mut() else {
        return Err(Stopped::Memory);
    };
    let stack = MemStack::new(&mut worker.stack);
    let matrix = MatMut::from_column_major_slice_mut(part.values, height, width);
    let (mut top, bottom) = matrix.split_at_row_mut(width);
    if !earlier.indefinite {
        let done = llt::factor::cholesky_in_place(
            top.as_mut(),
            Default::default(),
            Par::Seq,
            stack,
            Default::default(),
        );
        if let Err(llt::factor::LltError::NonPositivePivot { index }) = done {
            return Err(Stopped::NotPositive(columns.start + index));
        }
        let top = top.as_ref();
        each(shares(bottom), workers, |(_, share), _| {
            solve_lower_triangular_in_place(top, share.transpose_mut(), Par::Seq);
        });
        return Ok(());
    }
    lblt::factor::cholesky_in_place(
        top.as_mut(),
        ColMut::from_slice_mut(&mut *part.below).as_diagonal_mut(),
        &mut *part.forward,
        &mut *part.inverse,
        Par::Seq,
        stack,
        Default::default(),
    );
    let (top, below) = (top.as_ref(), &*part.below);
    let order = PermRef::new_checked(&*part.forward, &*part.inverse, width);
    each(shares(bottom), workers, |(_, mut share), worker| {
        let stack = MemStack::new(&mut worker.stack);
        faer::perm::permute_cols_in_place(share.as_mut(), order, stack);
        solve_unit_lower_triangular_in_place(top, share.as_mut().transpose_mut(), Par::Seq);
        divide(top, below, share);
    });
    Ok(())
}

/// Subtracts the products of the sources from some rows of a panel, from `first` on.
fn update(
    earlier: &Earlier<'_>,
    panel: usize,
    first: usize,
    mut share: MatMut<'_, f64>,
    local: &[u32],
    worker: &mut Scratch,
) {
    let panels = earlier.panels;
    let columns = panels.columns(panel);
    let (first, end) = (first as u32, (first + share.nrows()) as u32);
    for &source in panels.sources(panel) {
        let source = source as usize;
        let rows = panels.rows(source);
        let from = rows.partition_point(|&row| (row as usize) < columns.start);
        let across = &rows[from..];
        let across = &across[..across.partition_point(|&row| (row as usize) < columns.end)];
        let start = from + rows[from..].partition_point(|&row| local[row as usize] < first);
        let rows = &rows[start..];
        let rows = &rows[..rows.partition_point(|&row| local[row as usize] < end)];
        let (Some(&row), Some(&column)) = (rows.first(), across.first()) else {
            continue;
        };
        let (matrix, below) = earlier.panel(source);
        let width = matrix.ncols();
        let left = matrix.subrows(width + start, rows.len());
        let mut right = matrix.subrows(width + from, across.len());
        if earlier.indefinite {
            worker.scaled.clear();
            worker.scaled.resize(across.len() * width, 0.0);
            let scaled =
                MatMut::from_column_major_slice_mut(&mut worker.scaled, across.len(), width);
            multiplied(matrix, below, right, scaled);
            right = MatRef::from_column_major_slice(&worker.scaled, across.len(), width);
        }
        let (row, column) = (
            (local[row as usize] - first) as usize,
            column as usize - columns.start,
        );
        let last = |rows: &[u32]| rows.last().map_or(0, |&row| local[row as usize] as usize);
        let adjacent = last(rows) + 1 == first as usize + row + rows.len()
            && last(across) + 1 == column + across.len();
        if adjacent {
            let own = share
                .as_mut()
                .submatrix_mut(row, column, rows.len(), across.len());
            matmul(own, Accum::Add, left, right.transpose(), -1.0, Par::Seq);
            continue;
        }
        worker.product.clear();
        worker.product.resize(rows.len() * across.len(), 0.0);
        let product =
            MatMut::from_column_major_slice_mut(&mut worker.product, rows.len(), across.len());
        matmul(
            product,
            Accum::Replace,
            left,
            right.transpose(),
            1.0,
            Par::Seq,
        );
        for (&column, product) in across.iter().zip(worker.product.chunks_exact(rows.len())) {
            let own = share.as_mut().col_mut(column as usize - columns.start);
            // the columns of a panel are contiguous
            if let Some(own) = own.try_as_col_major_mut() {
                let own = own.as_slice_mut();
                for (&row, product) in rows.iter().zip(product) {
                    own[(local[row as usize] - first) as usize] -= product;
                }
            }
        }
    }
}

/// `R B` of rows of a panel with its diagonal B. In an overflow the last entry below the diagonal may be no number.
fn multiplied(
    panel: MatRef<'_, f64>,
    below: &[f64],
    rows: MatRef<'_, f64>,
    mut out: MatMut<'_, f64>,
) {
    let mut column = 0;
    while let Some(&coupling) = below.get(column) {
        if coupling == 0.0 || column + 1 == below.len() {
            let pivot = panel[(column, column)];
            for row in 0..rows.nrows() {
                out[(row, column)] = pivot * rows[(row, column)];
            }
            column += 1;
        } else {
            let (one, two) = (panel[(column, column)], panel[(column + 1, column + 1)]);
            for row in 0..rows.nrows() {
                let (x, y) = (rows[(row, column)], rows[(row, column + 1)]);
                out[(row, column)] = one * x + coupling * y;
                out[(row, column + 1)] = coupling * x + two * y;
            }
            column += 2;
        }
    }
}

/// A pair of pivots: a block of two rows and columns on the diagonal.
pub(super) struct Pair {
    /// The entries on the diagonal, as shares of the coupling, which is the largest entry of the block.
    one: f64,
    two: f64,
    coupling: f64,
    /// Of the block divided by its coupling.
    determinant: f64,
}

impl Pair {
    /// The pair whose first pivot is at a column of a panel.
    pub(super) fn at(panel: MatRef<'_, f64>, column: usize, coupling: f64) -> Pair {
        let one = panel[(column, column)] / coupling;
        let two = panel[(column + 1, column + 1)] / coupling;
        Pair {
            one,
            two,
            coupling,
            determinant: one * two - 1.0,
        }
    }

    /// The inverse of the block times two numbers.
    pub(super) fn divide(&self, numbers: [f64; 2]) -> [f64; 2] {
        let [x, y] = numbers.map(|x| x / self.coupling);
        [
            (self.two * x - y) / self.determinant,
            (self.one * y - x) / self.determinant,
        ]
    }
}

/// `R B⁻¹` of rows of a panel, in their place.
fn divide(panel: MatRef<'_, f64>, below: &[f64], mut rows: MatMut<'_, f64>) {
    let mut column = 0;
    while let Some(&coupling) = below.get(column) {
        if coupling == 0.0 || column + 1 == below.len() {
            let pivot = panel[(column, column)];
            for row in 0..rows.nrows() {
                rows[(row, column)] /= pivot;
            }
            column += 1;
        } else {
            let pair = Pair::at(panel, column, coupling);
            for row in 0..rows.nrows() {
                let [x, y] = pair.divide([rows[(row, column)], rows[(row, column + 1)]]);
                rows[(row, column)] = x;
                rows[(row, column + 1)] = y;
            }
            column += 2;
        }
    }
}
