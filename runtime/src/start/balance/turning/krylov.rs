//! Solution of the linear system of all angles, which needs only products with its matrix.

/// A solution with its residual.
#[derive(Clone, Debug, PartialEq)]
pub struct Solution {
    /// x.
    pub x: Vec<f64>,
    /// |b − A x| over |b|.
    pub residual: f64,
    /// Products with A.
    pub products: usize,
}

/// `a·b`.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// `|a|`.
fn norm(a: &[f64]) -> f64 {
    libm::sqrt(dot(a, a))
}

/// `A x = b` by the method of generalised minimal residuals, preconditioned from the right: `A P⁻¹ y = b`,
/// `x = P⁻¹ y`. It ends when the residual is below `goal` of |b|, or after `most` products. (Y. Saad, M. H.
/// Schultz, SIAM J. Sci. Stat. Comput. 7 (1986) 856; two rounds of modified Gram–Schmidt make the basis, and
/// Givens' rotations solve the least squares.)
///
/// # Errors
/// The first error of a product or of the preconditioner.
pub fn gmres<E>(
    mut multiply: impl FnMut(&[f64]) -> Result<Vec<f64>, E>,
    mut precondition: impl FnMut(&[f64]) -> Result<Vec<f64>, E>,
    b: &[f64],
    goal: f64,
    most: usize,
) -> Result<Solution, E> {
    let size = norm(b);
    if size == 0.0 {
        return Ok(Solution {
            x: vec![0.0; b.len()],
            residual: 0.0,
            products: 0,
        });
    }
    let mut basis: Vec<Vec<f64>> = vec![b.iter().map(|x| x / size).collect()];
    // columns of the triangle, the rotations, and the rotated right side
    let mut triangle: Vec<Vec<f64>> = Vec::new();
    let mut rotations: Vec<[f64; 2]> = Vec::new();
    let mut right = vec![size];
    for k in 0..most {
        let Some(last) = basis.get(k) else { break };
        let mut next = multiply(&precondition(last)?)?;
        let before = norm(&next);
        let mut column = vec![0.0; k + 1];
        for _ in 0..2 {
            for (h, v) in column.iter_mut().zip(&basis) {
                let share = dot(&next, v);
                *h += share;
                for (x, y) in next.iter_mut().zip(v) {
                    *x -= share * y;
                }
            }
        }
        let rest = norm(&next);
        for (i, [c, s]) in rotations.iter().enumerate() {
            let (a, b) = (column[i], column[i + 1]);
            column[i] = c * a + s * b;
            column[i + 1] = c * b - s * a;
        }
        let length = libm::hypot(column[k], rest);
        if !length.is_finite() || length == 0.0 {
            break;
        }
        let (c, s) = (column[k] / length, rest / length);
        column[k] = length;
        rotations.push([c, s]);
        triangle.push(column);
        let open = right[k];
        right[k] = c * open;
        right.push(-s * open);
        // a smaller rest is rounding: the basis then contains the solution, and the loop ends below
        if rest > f64::EPSILON * before {
            basis.push(next.iter().map(|x| x / rest).collect());
        }
        if (s * open).abs() <= goal * size {
            break;
        }
    }
    let count = triangle.len();
    let mut y = vec![0.0; count];
    for i in (0..count).rev() {
        let known: f64 = (i + 1..count).map(|k| triangle[k][i] * y[k]).sum();
        y[i] = (right[i] - known) / triangle[i][i];
    }
    let mut x = vec![0.0; b.len()];
    for (factor, v) in y.iter().zip(&basis) {
        for (x, v) in x.iter_mut().zip(v) {
            *x += factor * v;
        }
    }
    Ok(Solution {
        x: precondition(&x)?,
        residual: right[count].abs() / size,
        products: count,
    })
}
