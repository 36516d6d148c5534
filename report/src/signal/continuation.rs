//! What a signal would be beyond its ends, by linear prediction.

use std::f64::consts::FRAC_PI_2;

/// Most coefficients of a prediction.
const LARGEST_ORDER: usize = 400;
/// Shares of the mean square that are added to the diagonal of the normal equations, the first with which they can be solved: of the
/// many solutions of a signal of few sinusoids it takes that of the smallest coefficients.
const RIDGES: [f64; 4] = [1e-12, 1e-11, 1e-10, 1e-8];
/// A continuation ends where it outgrows the signal by this: what decays forwards grows backwards.
const GROWTH: f64 = 4.0;

/// A signal with what a linear prediction puts before and after it, faded to zero over at most the signal's length.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Continued {
    /// Before, the signal itself, after.
    pub values: Vec<f64>,
    /// Samples before the signal.
    pub before: usize,
}

/// Continues a signal without trend at both ends.
///
/// Each sample is taken as a sum of earlier ones, x[n] = Σₖ aₖ·x[n − k·s], k = 1…p, and likewise of later ones; the a are those of
/// the least squares of both over the whole signal (the modified covariance method; Kay, "Modern Spectral Estimation", 1988,
/// §7.5). p is a third of the samples, at most 400, and s the stride with which p·s reaches over that third. A sum of up to p/2
/// sinusoids, growing or decaying ones included, obeys such a law exactly. What is predicted is weighted by cos², from 1 at the end of the
/// signal to 0, so that a transform sees no edge.
pub(super) fn continued(values: &[f64]) -> Continued {
    let size = values.iter().fold(0.0f64, |most, x| most.max(x.abs()));
    if size == 0.0 || !size.is_finite() {
        return Continued {
            values: values.to_vec(),
            before: 0,
        };
    }
    let forwards: Vec<f64> = values.iter().map(|x| x / size).collect();
    let backwards: Vec<f64> = forwards.iter().rev().copied().collect();
    let reach = forwards.len() / 3;
    let stride = reach.div_ceil(LARGEST_ORDER).max(1);
    let coefficients = coefficients(&forwards, reach / stride, stride);
    let after = predicted(&forwards, &coefficients, stride);
    let before = predicted(&backwards, &coefficients, stride);
    let count = before.len();
    let before = before.into_iter().rev().map(|x| size * x);
    let after = after.into_iter().map(|x| size * x);
    Continued {
        values: before.chain(values.iter().copied()).chain(after).collect(),
        before: count,
    }
}

/// The coefficients a₁…aₚ; of too few samples those of a signal that stays where it is.
fn coefficients(x: &[f64], order: usize, stride: usize) -> Vec<f64> {
    let hold = vec![1.0];
    if order < 2 {
        return hold;
    }
    let (count, reach) = (x.len(), order * stride);
    let at = |n: usize| x.get(n).copied().unwrap_or_default();
    // products[i][j] = Σ x[n − i·s]·x[n − j·s] over n = p·s … N − 1; each row follows from the one before
    let width = order + 1;
    let mut products = vec![0.0; width * width];
    for j in 0..width {
        let sum: f64 = (reach..count).map(|n| at(n) * at(n - j * stride)).sum();
        set(&mut products, j, sum);
    }
    for i in 1..width {
        for j in i..width {
            let mut sum = get(&products, (i - 1) * width + j - 1);
            for n in 0..stride {
                let (first, last) = (reach + n, count + n);
                sum += at(first - i * stride) * at(first - j * stride)
                    - at(last - i * stride) * at(last - j * stride);
            }
            set(&mut products, i * width + j, sum);
        }
    }
    let product = |i: usize, j: usize| get(&products, i.min(j) * width + i.max(j));
    let mut matrix = vec![0.0; order * order];
    let mut right = vec![0.0; order];
    for i in 1..=order {
        for j in 1..=i {
            let both = product(i, j) + product(order - i, order - j);
            set(&mut matrix, (i - 1) * order + j - 1, both);
        }
        set(&mut right, i - 1, product(0, i) + product(order, order - i));
    }
    let mean = (0..order)
        .map(|i| get(&matrix, i * (order + 1)))
        .sum::<f64>()
        / order as f64;
    RIDGES
        .into_iter()
        .find_map(|ridge| {
            let mut matrix = matrix.clone();
            for i in 0..order {
                let value = get(&matrix, i * (order + 1)) + ridge * mean;
                set(&mut matrix, i * (order + 1), value);
            }
            solved(matrix, right.clone())
        })
        .unwrap_or(hold)
}

fn get(values: &[f64], place: usize) -> f64 {
    values.get(place).copied().unwrap_or_default()
}

fn set(values: &mut [f64], place: usize, value: f64) {
    if let Some(entry) = values.get_mut(place) {
        *entry = value;
    }
}

/// The solution of equations with a symmetric positive matrix, of which the lower triangle is given row by row (Cholesky); `None`
/// where it is not positive.
fn solved(mut matrix: Vec<f64>, mut right: Vec<f64>) -> Option<Vec<f64>> {
    let order = right.len();
    for i in 0..order {
        for j in 0..=i {
            let (upper, lower) = matrix.split_at_mut(i * order);
            let own = lower.get(..j)?;
            let sum = if i == j {
                own.iter().map(|x| x * x).sum::<f64>()
            } else {
                let other = upper.get(j * order..j * order + j)?;
                own.iter().zip(other).map(|(a, b)| a * b).sum()
            };
            let rest = lower.get(j)? - sum;
            *lower.get_mut(j)? = if i == j {
                if !(rest > 0.0 && rest.is_finite()) {
                    return None;
                }
                rest.sqrt()
            } else {
                rest / upper.get(j * order + j)?
            };
        }
    }
    for i in 0..order {
        let row = matrix.get(i * order..i * order + i)?;
        let sum: f64 = row.iter().zip(&right).map(|(a, b)| a * b).sum();
        let value = (right.get(i)? - sum) / matrix.get(i * order + i)?;
        *right.get_mut(i)? = value;
    }
    for i in (0..order).rev() {
        let below = (i + 1..order).map(|k| get(&matrix, k * order + i) * get(&right, k));
        let value = (right.get(i)? - below.sum::<f64>()) / matrix.get(i * order + i)?;
        *right.get_mut(i)? = value;
    }
    Some(right)
}

/// What follows a signal of size 1, faded to zero.
fn predicted(x: &[f64], coefficients: &[f64], stride: usize) -> Vec<f64> {
    let count = x.len();
    let mut whole = x.to_vec();
    whole.reserve(count);
    for n in count..2 * count {
        let next: f64 = coefficients
            .iter()
            .enumerate()
            .map(|(k, a)| a * get(&whole, n - (k + 1) * stride))
            .sum();
        if !(next.abs() <= GROWTH) {
            break;
        }
        whole.push(next);
    }
    let mut after = whole.split_off(count);
    let width = (after.len() + 1) as f64;
    for (k, value) in after.iter_mut().enumerate() {
        let weight = libm::cos(FRAC_PI_2 * (k + 1) as f64 / width);
        *value *= weight * weight;
    }
    after
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// What was predicted, its weight taken off again.
    fn unfaded(found: &Continued, count: usize) -> Vec<f64> {
        let after = &found.values[found.before + count..];
        let width = (after.len() + 1) as f64;
        let weight = |k: usize| libm::cos(FRAC_PI_2 * (k + 1) as f64 / width);
        (0..after.len() / 2)
            .map(|k| after[k] / (weight(k) * weight(k)))
            .collect()
    }

    #[test]
    fn sinusoids_and_decays_go_on_as_they_are() {
        let law = |n: usize| {
            let t = n as f64;
            libm::sin(0.03374 * t + 0.3)
                + 0.3 * libm::cos(0.7757 * t + 1.0)
                + 2.0 * libm::exp(-0.004 * t) * libm::cos(0.2 * t)
        };
        for count in [300, 2000, 3001] {
            let values: Vec<f64> = (0..count).map(law).collect();
            let found = continued(&values);
            let after = unfaded(&found, count);
            assert!(after.len() == count / 2, "{}", after.len());
            for (k, value) in after.iter().enumerate() {
                assert!((value - law(count + k)).abs() < 1e-5, "{count}: {k}");
            }
            assert_eq!(&found.values[found.before..found.before + count], values);
        }
    }

    #[test]
    fn a_periodic_pulse_comes_again() {
        let law = |n: usize| libm::exp(20.0 * (libm::cos(TAU * n as f64 / 300.0) - 1.0));
        let values: Vec<f64> = (0..2000).map(|n| law(n) - 0.1).collect();
        let after = unfaded(&continued(&values), 2000);
        for (k, value) in after.iter().enumerate() {
            assert!((value - law(2000 + k) + 0.1).abs() < 1e-5, "{k}");
        }
    }

    #[test]
    fn anything_else_stays_of_its_size() {
        for count in [0, 1, 2, 3, 5, 6, 7, 50, 1000] {
            let zeros = vec![0.0; count];
            assert_eq!(continued(&zeros).values, zeros);
            // a chirp, and numbers without any law
            let chirp: Vec<f64> = (0..count)
                .map(|n| libm::sin(1e-4 * (n * n) as f64))
                .collect();
            let noise: Vec<f64> = (0..count)
                .map(|n| 1e200 * (libm::sin(1e4 * libm::sin(n as f64 + 0.5))))
                .collect();
            for values in [chirp, noise] {
                let size = values.iter().fold(0.0f64, |m, x| m.max(x.abs()));
                let found = continued(&values);
                assert!(found.values.len() <= 3 * count && found.before <= count);
                assert!(
                    found
                        .values
                        .iter()
                        .all(|x| x.abs() <= 1.000_001 * GROWTH * size)
                );
            }
        }
    }
}
