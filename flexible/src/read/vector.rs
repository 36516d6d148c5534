//! Rotations of frames, and the axes of beams.

use crate::fe::vector::cross;

/// A rotation matrix, row-major; its columns are the axes.
pub(super) type Rotation = [[f64; 3]; 3];

/// No rotation.
pub(super) const IDENTITY: Rotation = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// The length of a vector, without overflow: `fe::vector::norm` rounds otherwise, and frames would change in
/// their last digits.
pub(super) fn norm(a: [f64; 3]) -> f64 {
    libm::hypot(libm::hypot(a[0], a[1]), a[2])
}

/// A vector of length 1; `None` for one without direction.
pub(super) fn unit(a: [f64; 3]) -> Option<[f64; 3]> {
    let length = norm(a);
    (length > 0.0 && length.is_finite()).then(|| a.map(|x| x / length))
}

/// Frame → basic.
pub(super) fn rotate(rotation: &Rotation, a: [f64; 3]) -> [f64; 3] {
    rotation.map(|row| row[0] * a[0] + row[1] * a[1] + row[2] * a[2])
}

/// The rotation with these axes as columns.
pub(super) fn from_axes(x: [f64; 3], y: [f64; 3], z: [f64; 3]) -> Rotation {
    [[x[0], y[0], z[0]], [x[1], y[1], z[1]], [x[2], y[2], z[2]]]
}

/// First rotation after the second: `a · b`.
pub(super) fn product(a: &Rotation, b: &Rotation) -> Rotation {
    let column = |j: usize| rotate(a, b.map(|row| row.get(j).copied().unwrap_or(0.0)));
    from_axes(column(0), column(1), column(2))
}

/// Axes of a beam from `first` to `second` with a vector in its first plane: x along it, y in that plane, z
/// completes. `None` if the beam has no length, or the vector has no part across it (less than 1e-8 of its
/// length).
pub(super) fn beam_axes(along: [f64; 3], orientation: [f64; 3]) -> Option<Rotation> {
    let x = unit(along)?;
    let z = cross(x, unit(orientation)?);
    // half of the digits of a number: a vector nearer to the axis has no certain direction across it
    if norm(z) < 1e-8 {
        return None;
    }
    let z = unit(z)?;
    Some(from_axes(x, cross(z, x), z))
}
