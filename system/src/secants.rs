//! Secants: differences of earlier corrections that show the error of a kept matrix.
//!
//! With the kept matrix A and the residual r, the correction `z = −A⁻¹r` changes by `Δz = −A⁻¹J Δx` along a move Δx,
//! with the exact matrix J. Newton's correction d solves `A⁻¹J d = z`. So for the part of z that the last moves
//! span, d is known without J:
//!
//! ```text
//! |z − Σ γ_j Δz_j| least        d = z − Σ γ_j (Δx_j + Δz_j)
//! ```
//!
//! For A = J the second sum is zero. Pairs of earlier steps are used, too, until the matrix is computed again: J
//! changes slowly, and slow directions of the iteration, such as pins in films, are the same at each step. (D. G.
//! Anderson, J. ACM 12 (1965) 547; H.-R. Fang, Y. Saad, Numer. Linear Algebra Appl. 16 (2009) 197.)

use crate::dense::{add_scaled, dot};

/// Most pairs. A choice: a kept matrix is slow along few directions, and each pair costs two products a
/// correction.
const PAIRS: usize = 6;
/// Share of its own square below which a pivot of the normal equations is dropped: the pair repeats the
/// others. A choice: the sine of the angle to the others is then a hundredth, and the error of the pair would
/// be enlarged a hundred times.
const REPEATS: f64 = 1e-4;
/// A correction that secants enlarge by more than this factor is left as it is. A choice: a matrix that
/// contracts by a third or better needs less.
const LARGEST_GROWTH: f64 = 3.0;

/// The last moves and the changes of corrections along them, in a ring: `next` is the oldest when it is full.
#[derive(Clone, Debug, PartialEq)]
pub struct Secants {
    size: usize,
    /// Δz of unit length, and Δx + Δz in the same measure, pair after pair.
    changes: Vec<f64>,
    errors: Vec<f64>,
    /// Products of the changes.
    products: [[f64; PAIRS]; PAIRS],
    count: usize,
    /// The place of the next pair.
    next: usize,
    /// Largest share of a move that the kept matrix missed, `|Δx + Δz|/|Δx|`.
    missed: f64,
}

impl Secants {
    /// No pairs yet, for corrections of this size.
    pub fn new(size: usize) -> Secants {
        Secants {
            size,
            changes: vec![0.0; PAIRS * size],
            errors: vec![0.0; PAIRS * size],
            products: [[0.0; PAIRS]; PAIRS],
            count: 0,
            next: 0,
            missed: 0.0,
        }
    }

    /// Forgets all pairs, because the matrix is another one.
    pub fn clear(&mut self) {
        (self.count, self.next, self.missed) = (0, 0, 0.0);
    }

    /// Largest share of a move that the kept matrix missed: the contraction of an iteration without secants.
    pub fn missed(&self) -> f64 {
        self.missed
    }

    /// Adds the pair of the corrections before and after a move.
    pub fn add(&mut self, moved: &[f64], before: &[f64], after: &[f64]) {
        let size = self.size;
        let own = self.next * size..(self.next + 1) * size;
        let change = &mut self.changes[own.clone()];
        for (c, (a, b)) in change.iter_mut().zip(after.iter().zip(before)) {
            *c = a - b;
        }
        let length = libm::sqrt(dot(change, change));
        if !(length > 0.0 && length.is_finite()) {
            // the oldest pair is overwritten, and nothing came in its place
            (self.count, self.next) = (0, 0);
            return;
        }
        let scale = 1.0 / length;
        let error = &mut self.errors[own.clone()];
        let (mut miss, mut way) = (0.0_f64, 0.0_f64);
        for (e, (c, m)) in error.iter_mut().zip(change.iter_mut().zip(moved)) {
            (miss, way) = (miss.max((m + *c).abs()), way.max(m.abs()));
            *e = scale * (m + *c);
            *c *= scale;
        }
        self.missed = self.missed.max(miss / way);
        let place = self.next;
        self.count = (self.count + 1).min(PAIRS);
        self.next = (self.next + 1) % PAIRS;
        for other in 0..self.count {
            let product = dot(
                &self.changes[own.clone()],
                &self.changes[other * size..(other + 1) * size],
            );
            self.products[place][other] = product;
            self.products[other][place] = product;
        }
    }

    /// Improves a correction of the kept matrix with the pairs.
    pub fn improve(&self, correction: &mut [f64]) {
        let n = self.count;
        let mut shares = [0.0; PAIRS];
        for (k, share) in shares[..n].iter_mut().enumerate() {
            *share = dot(
                &self.changes[k * self.size..(k + 1) * self.size],
                correction,
            );
        }
        // L D Lᵀ of the normal equations; a pair that repeats others has no share
        let mut factors = self.products;
        let mut kept = [true; PAIRS];
        for i in 0..n {
            for j in 0..i {
                if kept[j] {
                    let share = factors[i][j] / factors[j][j];
                    let column = factors.map(|row| row[j]);
                    let own = factors[i][j + 1..=i].iter_mut();
                    for (factor, other) in own.zip(&column[j + 1..=i]) {
                        *factor -= share * other;
                    }
                    shares[i] -= share * shares[j];
                }
            }
            kept[i] = factors[i][i] > REPEATS;
        }
        for i in (0..n).rev() {
            if !kept[i] {
                shares[i] = 0.0;
                continue;
            }
            let mut sum = shares[i];
            for k in i + 1..n {
                sum -= factors[k][i] * shares[k];
            }
            shares[i] = sum / factors[i][i];
        }
        let largest = |x: &[f64]| x.iter().fold(0.0_f64, |w, x| w.max(x.abs()));
        let before = largest(correction);
        for (k, share) in shares[..n].iter().enumerate() {
            add_scaled(
                correction,
                -share,
                &self.errors[k * self.size..(k + 1) * self.size],
            );
        }
        let after = largest(correction);
        if after > LARGEST_GROWTH * before {
            for (k, share) in shares[..n].iter().enumerate() {
                add_scaled(
                    correction,
                    *share,
                    &self.errors[k * self.size..(k + 1) * self.size],
                );
            }
        }
    }

    /// The numbers of a checkpoint.
    pub fn numbers(&self) -> Vec<f64> {
        let mut all = vec![self.count as f64, self.next as f64, self.missed];
        all.extend(&self.changes);
        all.extend(&self.errors);
        all.extend(self.products.as_flattened());
        all
    }

    /// Takes the numbers of a checkpoint.
    pub fn set_numbers(&mut self, numbers: &[f64]) {
        let [count, next, missed, rest @ ..] = numbers else {
            return;
        };
        (self.count, self.next) = ((*count as usize).min(PAIRS), *next as usize % PAIRS);
        self.missed = *missed;
        let (changes, rest) = rest.split_at(self.changes.len());
        let (errors, products) = rest.split_at(self.errors.len());
        self.changes.copy_from_slice(changes);
        self.errors.copy_from_slice(errors);
        self.products.as_flattened_mut().copy_from_slice(products);
    }
}
