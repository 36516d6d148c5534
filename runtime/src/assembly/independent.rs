//! Rows that are clearly independent, without a dense decomposition: their smallest solution, the motions that they
//! leave, and the few rows that need a dense analysis.
//!
//! The smallest solution of `A x = b` is `x = Aᵀ (A Aᵀ)⁻¹ b`. Few rows of a mechanism touch the same body, so the
//! Cholesky factor of `A Aᵀ` is kept within its envelope: from the first entry of each row to the diagonal, with the
//! rows in the order of E. Cuthill and J. McKee (Proc. 24th Nat. Conf. ACM, 1969, 157). A chain of n bodies costs as
//! much as n times a body. The pivot of a row of unit length is the square of its distance from the span of the rows
//! before it. The squared matrix has the squared condition. So pivots must be above `CLEAR`, and refinement against
//! A itself removes the error of the square (Å. Björck, Numerical Methods for Least Squares Problems, 1996, section
//! 6.6).

use super::gradients::Gradients;
use eng_system::dense::dot;
use nalgebra::{DMatrix, DVector};

/// Up to so many rows, dense decompositions take milliseconds and see weaker dependences. A choice: their
/// effort grows with the cube of this number.
pub const FEW: usize = 150;
/// Square of the distance of a row of unit length from the others, below which it may depend on them. It is far above
/// the rounding of the square. The joint at the end of a straight chain of n bodies is `n^(−3/2)` from the others, as
/// the end of a beam of n parts.
const CLEAR: f64 = 1e-12;
/// Distance of a row of unit length from others, below which it depends on them. It is about the root of the
/// rounding unit, because the distance comes from squares.
const NONE: f64 = 1e-7;
/// Share of a row below which another row has no part in a dependence. A choice, a decade below [`NONE`].
const NO_PART: f64 = 1e-8;
/// Most refinements. Each removes a factor of the rounding of the square. A choice: at [`CLEAR`] this factor
/// is 1e-4, and four reach rounding.
const REFINEMENTS: usize = 6;
/// Distance of a row of unit length from others, below which it depends on them for a solution: as much as
/// counts as zero among singular values.
const DEPENDENT: f64 = 1e-9;
/// Change of the rows, as a share of the right side, with which conjugate gradients end; and their rounds at
/// least. Rounding of sums over many rows is near this. The rounds are a choice: the method ends after as
/// many rounds as there are different singular values, and few rows depend on each other.
const CHANGE: f64 = 1e-13;
const ROUNDS: usize = 100;
/// Share of its right side and solution that a system may miss. As for [`CHANGE`]: the rounding of sums over
/// many rows.
const REST: f64 = 1e-13;

/// The factor of `A Aᵀ` for the clearly independent rows of A, which have unit length.
pub struct Independent {
    rows: Gradients,
    sizes: DVector<f64>,
    /// The rows of the factor in their order; the others are unclear.
    order: Vec<usize>,
    first: Vec<usize>,
    factor: Vec<Vec<f64>>,
    /// Rows that may depend on others, with the rows in the dependence.
    unclear: Vec<(usize, Vec<usize>)>,
}

impl Independent {
    /// `None` if a number is not finite.
    pub fn of(matrix: &Gradients) -> Option<Independent> {
        let sizes = matrix.sizes();
        if !sizes.iter().all(|size| size.is_finite()) {
            return None;
        }
        let mut rows = matrix.clone();
        rows.scale(|i, _| 1.0 / sizes[i]);
        let mut found = Independent {
            order: Vec::new(),
            first: Vec::new(),
            factor: Vec::new(),
            unclear: Vec::new(),
            sizes,
            rows,
        };
        // the rows of the factor so far that touch each column
        let mut touching: Vec<Vec<(usize, f64)>> = vec![Vec::new(); matrix.ncols()];
        for row in neighbours(&found.rows) {
            found.append(row, &mut touching);
        }
        Some(found)
    }

    /// Adds a row to the factor, or to the unclear ones.
    fn append(&mut self, row: usize, touching: &mut [Vec<(usize, f64)>]) {
        let entries = &self.rows.rows()[row];
        if entries.is_empty() || self.sizes[row] == 0.0 {
            self.unclear.push((row, Vec::new()));
            return;
        }
        let count = self.order.len();
        let others = entries.iter().filter_map(|(j, _)| touching[*j].first());
        let first = others.map(|(k, _)| *k).min().unwrap_or(count);
        let mut line = vec![0.0; count + 1 - first];
        for (j, a) in entries {
            for (k, b) in &touching[*j] {
                line[k - first] += a * b;
            }
            line[count - first] += a * a;
        }
        for k in first..count {
            let from = first.max(self.first[k]);
            let above = &self.factor[k];
            let product = dot(
                &line[from - first..k - first],
                &above[from - self.first[k]..k - self.first[k]],
            );
            line[k - first] = (line[k - first] - product) / above[k - self.first[k]];
        }
        let pivot = line[count - first] - dot(&line[..count - first], &line[..count - first]);
        if pivot.is_nan() || pivot <= CLEAR {
            let mut shares = vec![0.0; count];
            shares[first..].copy_from_slice(&line[..count - first]);
            self.solve_upper(&mut shares);
            let part = (shares.iter().zip(&self.order)).filter(|(x, _)| x.abs() > NO_PART);
            let part = part.map(|(_, other)| *other).collect();
            self.unclear.push((row, part));
            return;
        }
        line[count - first] = libm::sqrt(pivot);
        for (j, a) in &self.rows.rows()[row] {
            touching[*j].push((count, *a));
        }
        self.first.push(first);
        self.factor.push(line);
        self.order.push(row);
    }

    fn solve_upper(&self, rhs: &mut [f64]) {
        for (i, (line, first)) in self.factor.iter().zip(&self.first).enumerate().rev() {
            rhs[i] /= line[i - first];
            let own = rhs[i];
            for (x, a) in rhs[*first..i].iter_mut().zip(line) {
                *x -= a * own;
            }
        }
    }

    /// `(A Aᵀ)⁻¹ y` of the rows of the factor, in the order of all rows; others are zero.
    fn solve(&self, y: &DVector<f64>) -> DVector<f64> {
        let mut rhs: Vec<f64> = self.order.iter().map(|row| y[*row]).collect();
        for (i, (line, first)) in self.factor.iter().zip(&self.first).enumerate() {
            let sum = dot(&line[..i - first], &rhs[*first..i]);
            rhs[i] = (rhs[i] - sum) / line[i - first];
        }
        self.solve_upper(&mut rhs);
        let mut out = DVector::zeros(y.len());
        for (row, x) in self.order.iter().zip(rhs) {
            out[*row] = x;
        }
        out
    }

    /// The part of x along the rows of the factor comes off.
    pub fn free(&self, x: &mut DVector<f64>) {
        // twice: the second pass removes the rounding error of the first
        for _ in 0..2 {
            let along = self.solve(&self.rows.times(x));
            self.rows.add_transposed(&(-along), x);
        }
    }

    /// The factor of many rows, if it decides about all their dependences.
    pub fn alone(matrix: &Gradients) -> Option<Independent> {
        let factor = (matrix.nrows() > FEW).then(|| Independent::of(matrix))??;
        factor.is_decided().then_some(factor)
    }

    /// The factor of many rows, if all of them are clearly independent.
    pub fn all(matrix: &Gradients) -> Option<Independent> {
        let factor = (matrix.nrows() > FEW).then(|| Independent::of(matrix))??;
        factor.unclear.is_empty().then_some(factor)
    }

    /// The free parts of some velocities that follow each other, a column each: `P = 1 − Aᵀ (A Aᵀ)⁻¹ A`.
    pub fn projected(&self, first: usize, count: usize) -> DMatrix<f64> {
        let mut out = DMatrix::zeros(self.rows.ncols(), count);
        for (i, mut column) in out.column_iter_mut().enumerate() {
            let mut x = DVector::zeros(self.rows.ncols());
            x[first + i] = 1.0;
            self.free(&mut x);
            column.copy_from(&x);
        }
        out
    }

    /// An orthonormal basis of the motions that the rows of the factor leave. The columns of the projector P
    /// on them are taken in turn, the one with the longest rest first; the rests are orthogonal (Cholesky's
    /// decomposition of P with pivots, which are clear because P is a projector).
    pub fn basis(&self) -> DMatrix<f64> {
        let size = self.rows.ncols();
        let projected = |j: usize| {
            let mut x = DVector::zeros(size);
            x[j] = 1.0;
            self.free(&mut x);
            x
        };
        let mut rest: Vec<f64> = (0..size).map(|j| projected(j)[j]).collect();
        let count = size - self.order.len();
        let mut basis = DMatrix::zeros(size, count);
        for k in 0..count {
            let j = (0..size).fold(0, |best, j| if rest[j] > rest[best] { j } else { best });
            let mut x = projected(j);
            // twice: the second pass removes the rounding error of the first
            for _ in 0..2 {
                let others = basis.columns(0, k);
                let along = others.tr_mul(&x);
                x.gemv(-1.0, &others, &along, 1.0);
            }
            x.normalize_mut();
            for (rest, x) in rest.iter_mut().zip(x.iter()) {
                *rest -= x * x;
            }
            basis.set_column(k, &x);
        }
        basis
    }

    /// The unclear rows and the rows on which they may depend, in their order.
    pub fn dependent_part(&self) -> Vec<usize> {
        let rows = self.unclear.iter();
        let mut part: Vec<usize> = rows
            .flat_map(|(row, others)| others.iter().copied().chain([*row]))
            .collect();
        part.sort_unstable();
        part.dedup();
        part
    }

    /// Whether each unclear row depends on those of the factor, so that it holds no other motion.
    pub fn is_decided(&self) -> bool {
        self.depends_within(NONE)
    }

    /// Whether each unclear row is at most this far from those of the factor.
    fn depends_within(&self, distance: f64) -> bool {
        self.unclear.iter().all(|(row, _)| {
            let mut rest = DVector::zeros(self.rows.ncols());
            for (j, a) in &self.rows.rows()[*row] {
                rest[*j] = *a;
            }
            self.free(&mut rest);
            rest.norm() <= distance
        })
    }

    /// The smallest x with `A₁ x = b` for the rows of the factor, which have unit length, to rounding; `None`
    /// if it is not.
    fn exact(&self, scaled: &DVector<f64>) -> Option<DVector<f64>> {
        let mut wanted = DVector::zeros(scaled.len());
        for row in &self.order {
            wanted[*row] = scaled[*row];
        }
        let left = |x: &DVector<f64>| {
            let of_all = self.rows.times(x);
            let mut left = DVector::zeros(scaled.len());
            for row in &self.order {
                left[*row] = wanted[*row] - of_all[*row];
            }
            left
        };
        let mut solution = DVector::zeros(self.rows.ncols());
        let mut rest = wanted.clone();
        for _ in 0..REFINEMENTS {
            let before = rest.amax();
            let along = self.solve(&rest);
            self.rows.add_transposed(&along, &mut solution);
            rest = left(&solution);
            if rest.amax() > 0.5 * before {
                break;
            }
        }
        (rest.amax() <= REST * wanted.amax().max(solution.amax())).then_some(solution)
    }
}

/// The smallest solution x of `A x = b` in the least-squares sense, to rounding where all rows can hold.
/// `None` if the rows are neither clearly independent of the others nor dependent on them; another method
/// must decide then.
///
/// Rows that depend on those of the factor, `A₂ = C A₁`, leave the smallest solution among
/// `x = A₁ᵀ (A₁ A₁ᵀ)⁻¹ y`. The y of least squares follows by conjugate gradients (`least_squares`), which
/// need no C.
pub fn solution(matrix: &Gradients, rhs: &DVector<f64>) -> Option<DVector<f64>> {
    let factor = Independent::of(matrix)?;
    if factor.unclear.is_empty() {
        let scaled = rhs.component_div(&factor.sizes);
        return factor.exact(&scaled);
    }
    let decided = factor.depends_within(DEPENDENT);
    decided.then(|| least_squares(&factor, matrix, rhs))?
}

/// `x = A₁ᵀ (A₁ A₁ᵀ)⁻¹ y` of least `|A x − b|²`: conjugate gradients for y (M. R. Hestenes and E. Stiefel, J.
/// Res. Nat. Bur. Stand. 49 (1952) 409, in the form for least squares) from the solution that holds the rows
/// of the factor. `None` if they do not end.
fn least_squares(
    factor: &Independent,
    matrix: &Gradients,
    rhs: &DVector<f64>,
) -> Option<DVector<f64>> {
    let scaled = rhs.component_div(&factor.sizes);
    let mut x = factor.exact(&scaled)?;
    // y of a gradient g by x, in the metric of the unknowns: (A₁ A₁ᵀ)⁻¹ A₁ g
    let of_gradient = |rest: &DVector<f64>| {
        let mut gradient = DVector::zeros(matrix.ncols());
        matrix.add_transposed(rest, &mut gradient);
        factor.solve(&factor.rows.times(&gradient))
    };
    let motion = |y: &DVector<f64>| {
        let mut x = DVector::zeros(matrix.ncols());
        factor.rows.add_transposed(&factor.solve(y), &mut x);
        x
    };
    let mut rest = rhs - matrix.times(&x);
    let mut gradient = of_gradient(&rest);
    let mut direction = gradient.clone();
    let mut size = gradient.norm_squared();
    let least = CHANGE * rhs.norm();
    for _ in 0..ROUNDS.max(matrix.nrows()) {
        let step = motion(&direction);
        let change = matrix.times(&step);
        let changes = change.norm();
        let length = size / (changes * changes);
        if size == 0.0 || length * changes <= least {
            return Some(x);
        }
        if !length.is_finite() {
            return None;
        }
        x.axpy(length, &step, 1.0);
        rest.axpy(-length, &change, 1.0);
        gradient = of_gradient(&rest);
        let before = std::mem::replace(&mut size, gradient.norm_squared());
        direction = &gradient + direction * (size / before);
    }
    None
}

/// The rows in an order in which neighbours, which share columns, follow each other.
fn neighbours(rows: &Gradients) -> Vec<usize> {
    let mut touching: Vec<Vec<usize>> = vec![Vec::new(); rows.ncols()];
    for (i, row) in rows.rows().iter().enumerate() {
        for (j, _) in row {
            touching[*j].push(i);
        }
    }
    let mut seen = vec![false; rows.nrows()];
    let mut spread = vec![false; rows.ncols()];
    // a row that touches few others is an end of the mechanism
    let reach = |i: &usize| {
        let row = &rows.rows()[*i];
        row.iter().map(|(j, _)| touching[*j].len()).sum::<usize>()
    };
    let mut starts: Vec<usize> = (0..rows.nrows()).collect();
    starts.sort_by_key(|i| (reach(i), *i));
    let mut order = Vec::with_capacity(rows.nrows());
    for start in starts {
        if seen[start] {
            continue;
        }
        seen[start] = true;
        let mut next = order.len();
        order.push(start);
        while let Some(row) = order.get(next).copied() {
            next += 1;
            for (j, _) in &rows.rows()[row] {
                if std::mem::replace(&mut spread[*j], true) {
                    continue;
                }
                for other in &touching[*j] {
                    if !std::mem::replace(&mut seen[*other], true) {
                        order.push(*other);
                    }
                }
            }
        }
    }
    order
}
