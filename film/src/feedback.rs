//! The feedback of an elastic surface: the matrix of Newton's method for its amplitudes.
//!
//! With the derivatives of the forces by the amplitudes, ∂f/∂b, and by their rates, ∂f/∂ḃ, and the compliance C,
//!
//! ```text
//! G = I − C ∂f/∂b − (1/Δ) C ∂f/∂ḃ
//! ```
//!
//! Both products are kept: another length Δ of the step needs other factors, and no derivatives.

use eng_system::dense::add_scaled;
use eng_system::secants::Secants;

/// G and its factors.
#[derive(Clone, Debug)]
pub(crate) struct Feedback {
    count: usize,
    /// `C ∂f/∂b` and `C ∂f/∂ḃ`, row by row, and whether they are made.
    products: [Vec<f64>; 2],
    made: bool,
    /// The factors L and U of G in one square, and the row that was exchanged with each column's own.
    factors: Vec<f64>,
    exchanged: Vec<usize>,
    /// 1/Δ of the factors; no number without factors.
    by_step: f64,
    /// Differences of earlier corrections with these factors.
    pub secants: Secants,
}

/// The rows of the derivatives that G needs.
pub(crate) struct Slopes<'a> {
    /// Derivatives of the outputs by the inputs, output by output, and their number of inputs.
    pub rows: &'a [f64],
    pub inputs: usize,
    /// The output of the first shape's force, and the input of the first amplitude. The rates follow the amplitudes.
    pub force: usize,
    pub amplitude: usize,
}

impl Feedback {
    /// Nothing is made yet, for this number of shapes.
    pub fn new(count: usize) -> Feedback {
        Feedback {
            count,
            made: false,
            products: [vec![0.0; count * count], vec![0.0; count * count]],
            factors: vec![0.0; count * count],
            exchanged: vec![0; count],
            by_step: f64::NAN,
            secants: Secants::new(count),
        }
    }

    /// Forgets all.
    pub fn forget(&mut self) {
        (self.made, self.by_step) = (false, f64::NAN);
    }

    /// Whether both products are there.
    pub fn is_made(&self) -> bool {
        self.made
    }

    /// Whether there are factors for the inverse length of a step.
    pub fn is_factored(&self, by_step: f64) -> bool {
        self.by_step == by_step
    }

    /// The numbers of both products.
    pub fn products(&self) -> impl Iterator<Item = f64> + '_ {
        self.products.iter().flatten().copied()
    }

    /// Takes both products, and returns the numbers after them; nothing is taken if there are too few.
    pub fn take<'n>(&mut self, numbers: &'n [f64]) -> Option<&'n [f64]> {
        let (first, others) = numbers.split_at_checked(self.products[0].len())?;
        let (second, rest) = others.split_at_checked(self.products[1].len())?;
        self.products[0].copy_from_slice(first);
        self.products[1].copy_from_slice(second);
        (self.made, self.by_step) = (true, f64::NAN);
        Some(rest)
    }

    /// Makes both products.
    pub fn make(&mut self, compliance: &[f64], slopes: &Slopes) {
        let count = self.count;
        for (part, product) in self.products.iter_mut().enumerate() {
            product.fill(0.0);
            let first = slopes.amplitude + part * count;
            for (sums, line) in rows(product, count).zip(compliance.chunks_exact(count.max(1))) {
                for (shape, factor) in line
                    .iter()
                    .enumerate()
                    .filter(|(_, factor)| **factor != 0.0)
                {
                    add_scaled(sums, *factor, &slopes.of_force(shape)[first..first + count]);
                }
            }
        }
        (self.made, self.by_step) = (true, f64::NAN);
    }

    /// Factors G for the inverse length of a step, 0 for a film without a step; `false` if G is singular.
    /// Factors of this step stay.
    pub fn factor(&mut self, by_step: f64) -> bool {
        if self.by_step == by_step {
            return true;
        }
        self.by_step = f64::NAN;
        self.secants.clear();
        let [by_amplitude, by_rate] = &self.products;
        for (own, (a, r)) in self
            .factors
            .iter_mut()
            .zip(by_amplitude.iter().zip(by_rate))
        {
            *own = -a - by_step * r;
        }
        for row in 0..self.count {
            self.factors[row * self.count + row] += 1.0;
        }
        let regular = eliminate(&mut self.factors, &mut self.exchanged);
        if regular {
            self.by_step = by_step;
        }
        regular
    }

    /// Replaces right-hand sides, a row of `width` numbers for each shape, by the solutions.
    pub fn solve(&self, sides: &mut [f64], width: usize) {
        substitute(&self.factors, &self.exchanged, sides, width);
    }
}

impl Slopes<'_> {
    /// Derivatives of the force of a shape by all inputs. In N over the unit of the input.
    pub fn of_force(&self, shape: usize) -> &[f64] {
        &self.rows[(self.force + shape) * self.inputs..][..self.inputs]
    }
}

/// Replaces right-hand sides, a row of `width` numbers for each unknown, by the solutions. Factors and exchanged rows are those
/// of [`eliminate`].
pub(crate) fn substitute(factors: &[f64], exchanged: &[usize], sides: &mut [f64], width: usize) {
    let count = exchanged.len();
    for (column, other) in exchanged.iter().enumerate().filter(|(c, o)| c != *o) {
        let (above, below) = sides.split_at_mut(other * width);
        above[column * width..][..width].swap_with_slice(&mut below[..width]);
    }
    for row in 1..count {
        let (above, own) = sides.split_at_mut(row * width);
        let line = &factors[row * count..row * count + row];
        for (factor, solved) in line.iter().zip(above.chunks_exact(width)) {
            add_scaled(&mut own[..width], -factor, solved);
        }
    }
    for row in (0..count).rev() {
        let (above, below) = sides.split_at_mut((row + 1) * width);
        let own = &mut above[row * width..];
        let line = &factors[row * count..(row + 1) * count];
        for (factor, solved) in line[row + 1..].iter().zip(below.chunks_exact(width)) {
            add_scaled(own, -factor, solved);
        }
        let inverse = 1.0 / line[row];
        own.iter_mut().for_each(|number| *number *= inverse);
    }
}

/// Rows of a length of at least one.
fn rows(matrix: &mut [f64], length: usize) -> impl Iterator<Item = &mut [f64]> {
    matrix.chunks_exact_mut(length.max(1))
}

/// Replaces a square matrix, row by row, by its factors L U, and writes the row that was exchanged with each
/// column's; `false` if it is singular. (Gauß, with the largest pivot of the column.)
pub(crate) fn eliminate(matrix: &mut [f64], exchanged: &mut [usize]) -> bool {
    let count = exchanged.len();
    for column in 0..count {
        let size = |row: usize| matrix[row * count + column].abs();
        let pivot = (column..count).fold(
            column,
            |best, row| if size(row) > size(best) { row } else { best },
        );
        let value = matrix[pivot * count + column];
        if value == 0.0 || !value.is_finite() {
            return false;
        }
        exchanged[column] = pivot;
        if pivot != column {
            let (above, below) = matrix.split_at_mut(pivot * count);
            above[column * count..][..count].swap_with_slice(&mut below[..count]);
        }
        let (above, below) = matrix.split_at_mut((column + 1) * count);
        let pivots = &above[column * count..];
        for row in below.chunks_exact_mut(count) {
            let factor = row[column] / value;
            row[column] = factor;
            if factor != 0.0 {
                add_scaled(&mut row[column + 1..], -factor, &pivots[column + 1..]);
            }
        }
    }
    true
}
