//! Continues a signal beyond its ends by linear prediction.

/// Most coefficients of a prediction. A choice: two for each of 200 sinusoids, and the effort grows with the
/// square.
const LARGEST_ORDER: usize = 400;
/// Shares of the mean square that are added to the diagonal of the normal equations. The first share with
/// which they can be solved is used. A signal of few sinusoids has many solutions, and this one has the
/// smallest coefficients. The shares are a choice from rounding upwards.
const RIDGES: [f64; 4] = [1e-12, 1e-11, 1e-10, 1e-8];
/// A continuation ends where it is this many times as large as the signal. A choice: a prediction that grows
/// has lost the signal.
pub const GROWTH: f64 = 4.0;
/// Length of a continuation in lengths of the signal, and its largest number of samples. Choices: a filter
/// has forgotten the ends after that, and its transform takes no time.
const LENGTH: (usize, usize) = (4, 65_536);
/// Samples beyond one period from which on a signal is compared with itself a period before. A choice: fewer
/// may agree by chance.
const COMPARED: usize = 8;

/// A signal with its continuations before and after it, which fade to zero.
#[derive(Clone, Debug, PartialEq)]
pub struct Continued {
    /// The samples before the signal, of the signal, and after it.
    pub values: Vec<f64>,
    /// Samples before the signal.
    pub before: usize,
}

/// Continues a signal without trend at both ends.
///
/// Linear prediction takes each sample as a sum of earlier samples, x[n] = Σₖ aₖ·x[n − k·s], k = 1…p, and
/// also of later ones. The coefficients a give the least sum of squares of both errors over the whole signal
/// (the modified covariance method; Kay, "Modern Spectral Estimation", 1988, §7.5). p is a third of the
/// samples, at most 400, and s the stride with which p·s reaches over that third. A sum of up to p/2
/// sinusoids, growing or decaying ones included, obeys such a law exactly.
///
/// With a `period` (samples), a signal that is longer than the period continues with its values one period
/// before, x[n] = x[n − period] + y[n]. Only the change y is predicted, so a cycle may have any shape.
///
/// The weight of the continuation falls from 1 at the end of the signal to 0, with three continuous
/// derivatives. So a transform has no edge.
pub fn continued(values: &[f64], period: Option<usize>) -> Continued {
    let size = values.iter().fold(0.0f64, |most, x| most.max(x.abs()));
    if size == 0.0 || !size.is_finite() {
        return Continued {
            values: values.to_vec(),
            before: 0,
        };
    }
    let forwards: Vec<f64> = values.iter().map(|x| x / size).collect();
    let backwards: Vec<f64> = forwards.iter().rev().copied().collect();
    let count = values.len();
    let length = count.saturating_mul(LENGTH.0).min(LENGTH.1.max(count));
    let period = period.filter(|p| *p > 0 && p.saturating_add(COMPARED) <= count);
    let side = |x: &[f64]| -> Vec<f64> {
        let mut after = match period {
            Some(period) => repeated(x, period, length),
            None => predicted(x, length),
        };
        fade(&mut after);
        after.iter().map(|x| size * x).collect()
    };
    let after = side(&forwards);
    let mut all = side(&backwards);
    let before = all.len();
    all.reverse();
    all.extend(values);
    all.extend(after);
    Continued {
        values: all,
        before,
    }
}

/// The continuation of a signal that repeats except for a change from period to period. The change is
/// predicted.
fn repeated(x: &[f64], period: usize, length: usize) -> Vec<f64> {
    let change: Vec<f64> = x
        .iter()
        .skip(period)
        .zip(x)
        .map(|(x, old)| x - old)
        .collect();
    let size = change.iter().fold(0.0f64, |most, x| most.max(x.abs()));
    let mut coming = if size > 0.0 {
        let scaled: Vec<f64> = change.iter().map(|x| x / size).collect();
        predicted(&scaled, length)
    } else {
        Vec::new()
    };
    fade(&mut coming);
    let mut whole = x.to_vec();
    for k in 0..length {
        let next = get(&whole, x.len() + k - period) + size * get(&coming, k);
        if next.is_nan() || next.abs() > GROWTH {
            break;
        }
        whole.push(next);
    }
    whole.split_off(x.len())
}

/// Weights the values, t from 0 to 1 over them.
fn fade(values: &mut [f64]) {
    let width = (values.len() + 1) as f64;
    for (k, value) in values.iter_mut().enumerate() {
        *value *= weight((k + 1) as f64 / width);
    }
}

/// The weight of a continuation at a share t of its length: 1 − (35t⁴ − 84t⁵ + 70t⁶ − 20t⁷).
pub fn weight(t: f64) -> f64 {
    1.0 - t * t * t * t * (35.0 + t * (-84.0 + t * (70.0 - 20.0 * t)))
}

/// The coefficients a₁…aₚ. For too few samples they are those of a constant signal.
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

/// The solution of equations with a symmetric positive matrix, of which the lower triangle is given row by
/// row (Cholesky); `None` if the matrix is not positive.
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

/// The continuation of a signal of size 1 by linear prediction with the coefficients of least squares. If it
/// outgrows the signal (a signal that decays forwards grows backwards), Burg's coefficients are used, whose
/// continuation never grows.
fn predicted(x: &[f64], length: usize) -> Vec<f64> {
    let reach = x.len() / 3;
    let stride = reach.div_ceil(LARGEST_ORDER).max(1);
    let found = followed(x, &coefficients(x, reach / stride, stride), stride, length);
    // if rounding alone causes growth, the growth comes late
    if found.len() >= length.min(x.len()) {
        return found;
    }
    followed(x, &burg(x, reach.min(LARGEST_ORDER)), 1, length)
}

/// The continuation x[n] = Σₖ aₖ·x[n − k·s], up to the sample that outgrows the signal.
fn followed(x: &[f64], coefficients: &[f64], stride: usize, length: usize) -> Vec<f64> {
    let count = x.len();
    let mut whole = x.to_vec();
    whole.reserve(length);
    for n in count..count + length {
        let before = |k: usize| n.checked_sub((k + 1) * stride);
        let next: f64 = coefficients
            .iter()
            .enumerate()
            .map(|(k, a)| a * before(k).map_or(0.0, |n| get(&whole, n)))
            .sum();
        if next.is_nan() || next.abs() > GROWTH {
            break;
        }
        whole.push(next);
    }
    whole.split_off(count)
}

/// Burg's coefficients a₁…aₚ (Kay, §7.6): each order takes the reflection k = 2·Σf·b/Σ(f² + b²) of the errors
/// f and b of prediction forwards and backwards. |k| ≤ 1, so the continuation does not grow.
fn burg(x: &[f64], order: usize) -> Vec<f64> {
    let mut forwards = x.to_vec();
    let mut backwards = x.to_vec();
    let mut found: Vec<f64> = Vec::with_capacity(order);
    let whole: f64 = x.iter().map(|x| x * x).sum();
    for _ in 0..order {
        // pairs of an error at n and one at n − 1
        let ahead = forwards.get(1..).unwrap_or_default().to_vec();
        backwards.pop();
        let (product, squares) = ahead
            .iter()
            .zip(&backwards)
            .fold((0.0, 0.0), |(product, squares), (f, b)| {
                (product + f * b, squares + f * f + b * b)
            });
        // the rest of the errors is rounding, 1e-10 of the signal
        if squares <= 1e-20 * whole {
            break;
        }
        let reflection = 2.0 * product / squares;
        let mirrored: Vec<f64> = found.iter().rev().map(|a| reflection * a).collect();
        for (a, mirrored) in found.iter_mut().zip(mirrored) {
            *a -= mirrored;
        }
        found.push(reflection);
        forwards = ahead
            .iter()
            .zip(&backwards)
            .map(|(f, b)| f - reflection * b)
            .collect();
        for (b, f) in backwards.iter_mut().zip(&ahead) {
            *b -= reflection * f;
        }
    }
    found
}
