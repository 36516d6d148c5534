//! Solutions with a supernodal factor `L Lᵀ`, for several right-hand sides side by side.
//!
//! A factor is far larger than the caches, so that a solution takes the time to read it: once for eight right-hand sides, whose entries of
//! a row fill a cache line. Columns of a supernode go four at a time, so that what they act on is read and written once for the four.

use super::factor::{Analysis, Block};
use super::product::{Lanes, TOGETHER};
use faer::traits::pulp::{Arch, Simd, WithSimd};

/// Columns taken together.
const PANEL: usize = 4;

/// Solves `L Lᵀ x = b` in place for right-hand sides one after the other: `values` are the factor's, in the analysed order.
pub(super) fn solve_positive(analysis: &Analysis, values: &[f64], right_hand_sides: &mut [f64]) {
    let size = analysis.size();
    if size == 0 {
        return;
    }
    let most = analysis.blocks().map(|block| block.rows()).max();
    let mut packed = vec![[0.0; TOGETHER]; size];
    let mut local = vec![[0.0; TOGETHER]; most.unwrap_or(0)];
    let order = analysis.ordering().forward();
    for columns in right_hand_sides.chunks_mut(size * TOGETHER) {
        for (lane, column) in columns.chunks_exact(size).enumerate() {
            for (packed, row) in packed.iter_mut().zip(order) {
                packed[lane] = column[*row as usize];
            }
        }
        Arch::new().dispatch(Substitution {
            analysis,
            values,
            x: &mut packed,
            local: &mut local,
        });
        for (lane, column) in columns.chunks_exact_mut(size).enumerate() {
            for (packed, row) in packed.iter().zip(order) {
                column[*row as usize] = packed[lane];
            }
        }
    }
}

/// Both substitutions, with the widest vectors that the processor has: the same operations in the same order, whatever their width.
struct Substitution<'a> {
    analysis: &'a Analysis,
    values: &'a [f64],
    /// Right-hand sides in the order of elimination, then solutions.
    x: &'a mut [Lanes],
    /// Rows of one supernode.
    local: &'a mut [Lanes],
}

impl WithSimd for Substitution<'_> {
    type Output = ();

    // code for the processor comes of what is inlined here
    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Substitution {
            analysis,
            values,
            x,
            local,
        } = self;
        for block in analysis.blocks() {
            let (own, below) = local[..block.rows()].split_at_mut(block.width);
            own.copy_from_slice(&x[block.first..block.first + block.width]);
            below.fill([0.0; TOGETHER]);
            forward(
                &block,
                &values[block.values.clone()],
                &mut local[..block.rows()],
            );
            let (own, below) = local[..block.rows()].split_at(block.width);
            x[block.first..block.first + block.width].copy_from_slice(own);
            for (change, row) in below.iter().zip(block.below) {
                for (x, change) in x[*row as usize].iter_mut().zip(change) {
                    *x += change;
                }
            }
        }
        for block in analysis.blocks().rev() {
            let (own, below) = local[..block.rows()].split_at_mut(block.width);
            own.copy_from_slice(&x[block.first..block.first + block.width]);
            for (value, row) in below.iter_mut().zip(block.below) {
                *value = x[*row as usize];
            }
            backward(
                &block,
                &values[block.values.clone()],
                &mut local[..block.rows()],
            );
            x[block.first..block.first + block.width].copy_from_slice(&local[..block.width]);
        }
    }
}

/// The columns of a panel from `first` on, each from its diagonal entry's row on.
#[inline(always)]
fn panel<'a>(values: &'a [f64], rows: usize, first: usize) -> [&'a [f64]; PANEL] {
    std::array::from_fn(|k| {
        let start = (first + k) * rows;
        &values[start + first..start + rows]
    })
}

/// `y = L⁻¹ y` of a supernode's own rows, and what that takes from the rows below.
#[inline(always)]
fn forward(block: &Block, values: &[f64], y: &mut [Lanes]) {
    let rows = block.rows();
    let mut first = 0;
    while first + PANEL <= block.width {
        let columns = panel(values, rows, first);
        let (head, tail) = y[first..rows].split_at_mut(PANEL);
        for k in 0..PANEL {
            let pivot = columns[k][k];
            for lane in 0..TOGETHER {
                head[k][lane] /= pivot;
            }
            for i in k + 1..PANEL {
                let factor = columns[k][i];
                for lane in 0..TOGETHER {
                    head[i][lane] -= factor * head[k][lane];
                }
            }
        }
        let [one, two, three, four] = [head[0], head[1], head[2], head[3]];
        let [a, b, c, d] = columns.map(|column| &column[PANEL..]);
        for ((((y, a), b), c), d) in tail.iter_mut().zip(a).zip(b).zip(c).zip(d) {
            for lane in 0..TOGETHER {
                y[lane] -= (a * one[lane] + b * two[lane]) + (c * three[lane] + d * four[lane]);
            }
        }
        first += PANEL;
    }
    for column in first..block.width {
        let factors = &values[column * rows + column..(column + 1) * rows];
        let Some((own, tail)) = y[column..rows].split_first_mut() else {
            continue;
        };
        for x in own.iter_mut() {
            *x /= factors[0];
        }
        for (y, factor) in tail.iter_mut().zip(&factors[1..]) {
            for lane in 0..TOGETHER {
                y[lane] -= factor * own[lane];
            }
        }
    }
}

/// `y = L⁻ᵀ y` of a supernode's own rows, with those below known.
#[inline(always)]
fn backward(block: &Block, values: &[f64], y: &mut [Lanes]) {
    let rows = block.rows();
    let panels = block.width / PANEL * PANEL;
    for column in (panels..block.width).rev() {
        let factors = &values[column * rows + column..(column + 1) * rows];
        let Some((own, tail)) = y[column..rows].split_first_mut() else {
            continue;
        };
        for (y, factor) in tail.iter().zip(&factors[1..]) {
            for lane in 0..TOGETHER {
                own[lane] -= factor * y[lane];
            }
        }
        for x in own.iter_mut() {
            *x /= factors[0];
        }
    }
    for first in (0..panels).step_by(PANEL).rev() {
        let columns = panel(values, rows, first);
        let (head, tail) = y[first..rows].split_at_mut(PANEL);
        let mut sums = [[0.0f64; TOGETHER]; PANEL];
        let [a, b, c, d] = columns.map(|column| &column[PANEL..]);
        for ((((y, a), b), c), d) in tail.iter().zip(a).zip(b).zip(c).zip(d) {
            for lane in 0..TOGETHER {
                sums[0][lane] += a * y[lane];
                sums[1][lane] += b * y[lane];
                sums[2][lane] += c * y[lane];
                sums[3][lane] += d * y[lane];
            }
        }
        for k in (0..PANEL).rev() {
            for i in k + 1..PANEL {
                let factor = columns[k][i];
                for lane in 0..TOGETHER {
                    sums[k][lane] += factor * head[i][lane];
                }
            }
            for lane in 0..TOGETHER {
                head[k][lane] = (head[k][lane] - sums[k][lane]) / columns[k][k];
            }
        }
    }
}
