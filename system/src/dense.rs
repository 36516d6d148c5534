//! Products with small dense blocks, in loops of fixed order that become vector instructions.

/// Partial sums of a scalar product. Four doubles fill a vector register.
const LANES: usize = 4;

/// `Σ a_i b_i`, as long as the shorter one. Four partial sums: the order is fixed, and the four sums do not wait
/// for each other.
#[inline]
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    let n = a.len().min(b.len());
    let (a, rest_a) = a[..n].as_chunks::<LANES>();
    let (b, rest_b) = b[..n].as_chunks::<LANES>();
    let mut sums = [0.0; LANES];
    for (a, b) in a.iter().zip(b) {
        for i in 0..LANES {
            sums[i] += a[i] * b[i];
        }
    }
    let rest: f64 = rest_a.iter().zip(rest_b).map(|(a, b)| a * b).sum();
    (sums[0] + sums[2]) + (sums[1] + sums[3]) + rest
}

/// The largest magnitude, 0 of no number.
pub fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most, x| most.max(x.abs()))
}

/// The largest magnitude of numbers over their scales.
pub fn largest_scaled(values: &[f64], scales: &[f64]) -> f64 {
    let pairs = values.iter().zip(scales);
    pairs.fold(0.0, |most, (x, scale)| most.max((x / scale).abs()))
}

/// The largest difference between numbers of two lists.
pub fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    let pairs = a.iter().zip(b);
    pairs.fold(0.0, |most, (a, b)| most.max((a - b).abs()))
}

/// `out += factor x`.
#[inline]
pub fn add_scaled(out: &mut [f64], factor: f64, x: &[f64]) {
    for (y, x) in out.iter_mut().zip(x) {
        *y += factor * x;
    }
}

/// `out += factor · M x` for a square row-major block.
#[inline]
pub fn add_product(out: &mut [f64], factor: f64, block: &[f64], x: &[f64]) {
    if x.is_empty() {
        return;
    }
    for (y, row) in out.iter_mut().zip(block.chunks_exact(x.len())) {
        *y += factor * dot(row, x);
    }
}

/// `out += Mᵀ x` for a row-major block with as many columns as `out` is long.
#[inline]
pub fn add_transposed(out: &mut [f64], block: &[f64], x: &[f64]) {
    if out.is_empty() {
        return;
    }
    for (factor, row) in x.iter().zip(block.chunks_exact(out.len())) {
        add_scaled(out, *factor, row);
    }
}

/// `out += Σ_k factors[k] · rows[k]` for six rows, one after the other in `rows`, as long as `out`.
#[inline]
pub fn add_six(out: &mut [f64], factors: &[f64; 6], rows: &[f64]) {
    let n = out.len();
    if n == 0 || rows.len() < 6 * n {
        return;
    }
    let [a, b, c, d, e, g]: [&[f64]; 6] = std::array::from_fn(|k| &rows[k * n..(k + 1) * n]);
    let f = factors;
    for i in 0..n {
        out[i] +=
            (f[0] * a[i] + f[1] * b[i]) + (f[2] * c[i] + f[3] * d[i]) + (f[4] * e[i] + f[5] * g[i]);
    }
}

/// `out += leftᵀ right` for six rows each, row-major: as many rows as `left` has columns, as long as those of `right`.
#[inline]
pub fn add_product_of_six(out: &mut [f64], left: &[f64], right: &[f64]) {
    let (height, width) = (left.len() / 6, right.len() / 6);
    if width == 0 {
        return;
    }
    for (r, line) in out.chunks_exact_mut(width).take(height).enumerate() {
        let factors = std::array::from_fn(|k| left[k * height + r]);
        add_six(line, &factors, right);
    }
}
