//! The discrete Fourier transform of any length.
//!
//! Lengths with small prime factors use mixed radices (Cooley and Tukey 1965). Other lengths use a
//! convolution whose length is a power of two (Bluestein 1970). Roots of unity come from `libm`, so the same
//! input gives the same bits everywhere.

use std::f64::consts::TAU;

/// Largest prime factor without Bluestein's convolution. A choice: a transform of a prime takes its square of
/// products, a convolution three transforms of more than twice the length.
const LARGEST_RADIX: usize = 31;

/// A complex number.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Complex {
    /// Real part.
    pub re: f64,
    /// Imaginary part.
    pub im: f64,
}

impl Complex {
    /// `re + i·im`.
    pub fn new(re: f64, im: f64) -> Self {
        Complex { re, im }
    }

    /// Modulus.
    pub fn abs(self) -> f64 {
        libm::hypot(self.re, self.im)
    }

    /// Argument (rad), in (−π, π].
    pub fn arg(self) -> f64 {
        libm::atan2(self.im, self.re)
    }

    fn conjugate(self) -> Self {
        Complex::new(self.re, -self.im)
    }

    fn times(self, other: Self) -> Self {
        Complex::new(
            self.re * other.re - self.im * other.im,
            self.re * other.im + self.im * other.re,
        )
    }

    fn plus(self, other: Self) -> Self {
        Complex::new(self.re + other.re, self.im + other.im)
    }

    fn minus(self, other: Self) -> Self {
        Complex::new(self.re - other.re, self.im - other.im)
    }
}

/// `X[k] = Σₙ x[n]·exp(−2πi·k·n/N)`, k = 0…N−1, not scaled. Empty input gives empty output.
pub fn transform(values: &[Complex]) -> Vec<Complex> {
    let length = values.len();
    match factors(length) {
        Some(factors) => {
            let roots = roots(length);
            let mut output = vec![Complex::default(); length];
            mixed(values, 0, 1, &mut output, &factors, &roots);
            output
        }
        None => bluestein(values),
    }
}

/// `x[n] = 1/N·Σₖ X[k]·exp(+2πi·k·n/N)`: the inverse of [`transform`].
pub fn inverse(values: &[Complex]) -> Vec<Complex> {
    let turned: Vec<Complex> = values.iter().map(|v| v.conjugate()).collect();
    let scale = 1.0 / values.len().max(1) as f64;
    transform(&turned)
        .into_iter()
        .map(|v| Complex::new(v.re * scale, -v.im * scale))
        .collect()
}

/// [`transform`] of real values.
pub fn transform_real(values: &[f64]) -> Vec<Complex> {
    let complex: Vec<Complex> = values.iter().map(|v| Complex::new(*v, 0.0)).collect();
    transform(&complex)
}

/// Factors, fours first; `None` if one is too large.
fn factors(mut length: usize) -> Option<Vec<usize>> {
    let mut factors = Vec::new();
    if length == 0 {
        return Some(factors);
    }
    while length.is_multiple_of(4) {
        factors.push(4);
        length /= 4;
    }
    let mut radix = 2;
    while length > 1 {
        if radix > LARGEST_RADIX {
            return None;
        }
        if length.is_multiple_of(radix) {
            factors.push(radix);
            length /= radix;
        } else {
            radix += 1;
        }
    }
    Some(factors)
}

/// exp(−2πi·k/N) for k = 0…N−1.
fn roots(length: usize) -> Vec<Complex> {
    (0..length).map(|k| root(k as u64, length as u64)).collect()
}

fn root(numerator: u64, denominator: u64) -> Complex {
    let (sine, cosine) = libm::sincos(TAU * (numerator as f64 / denominator as f64));
    Complex::new(cosine, -sine)
}

/// Transform of `input[offset + stride·n]` into `output`, whose length is the product of `factors`;
/// `stride`·that length = number of `roots`.
fn mixed(
    input: &[Complex],
    offset: usize,
    stride: usize,
    output: &mut [Complex],
    factors: &[usize],
    roots: &[Complex],
) {
    let Some((&radix, rest)) = factors.split_first() else {
        if let (Some(out), Some(value)) = (output.first_mut(), input.get(offset)) {
            *out = *value;
        }
        return;
    };
    let part = output.len() / radix;
    for (index, chunk) in output.chunks_exact_mut(part).enumerate() {
        mixed(
            input,
            offset + index * stride,
            stride * radix,
            chunk,
            rest,
            roots,
        );
    }
    let mut terms = [Complex::default(); LARGEST_RADIX];
    let turn = roots.len() / radix;
    for k in 0..part {
        for (index, term) in terms.iter_mut().enumerate().take(radix) {
            // index·k·stride < radix·part·stride = number of roots
            *term = output[index * part + k].times(roots[index * k * stride]);
        }
        match radix {
            2 => {
                output[k] = terms[0].plus(terms[1]);
                output[part + k] = terms[0].minus(terms[1]);
            }
            4 => {
                let (even, odd) = (terms[0].plus(terms[2]), terms[1].plus(terms[3]));
                let (upper, lower) = (terms[0].minus(terms[2]), terms[1].minus(terms[3]));
                let quarter = Complex::new(lower.im, -lower.re);
                output[k] = even.plus(odd);
                output[part + k] = upper.plus(quarter);
                output[2 * part + k] = even.minus(odd);
                output[3 * part + k] = upper.minus(quarter);
            }
            _ => {
                for q in 0..radix {
                    let mut sum = terms[0];
                    for (index, term) in terms.iter().enumerate().take(radix).skip(1) {
                        sum = sum.plus(term.times(roots[(index * q % radix) * turn]));
                    }
                    output[q * part + k] = sum;
                }
            }
        }
    }
}

/// k·n = (k² + n² − (k − n)²)/2 turns the transform into a convolution with a chirp.
fn bluestein(values: &[Complex]) -> Vec<Complex> {
    let length = values.len();
    let chirp: Vec<Complex> = (0..length as u64)
        // the square is reduced in integers, so that the angle stays exact
        .map(|k| {
            let period = 2 * length as u64;
            root(
                ((u128::from(k) * u128::from(k)) % u128::from(period)) as u64,
                period,
            )
        })
        .collect();
    let padded = (2 * length).next_power_of_two();
    let mut signal = vec![Complex::default(); padded];
    let mut kernel = vec![Complex::default(); padded];
    for (index, (value, chirp)) in values.iter().zip(&chirp).enumerate() {
        signal[index] = value.times(*chirp);
        kernel[index] = chirp.conjugate();
        if index > 0 {
            kernel[padded - index] = chirp.conjugate();
        }
    }
    let product: Vec<Complex> = transform(&signal)
        .into_iter()
        .zip(transform(&kernel))
        .map(|(a, b)| a.times(b))
        .collect();
    inverse(&product)
        .into_iter()
        .zip(&chirp)
        .map(|(value, chirp)| value.times(*chirp))
        .collect()
}
