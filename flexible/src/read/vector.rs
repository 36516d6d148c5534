//! Rotations of frames, and the axes of beams.

pub(super) use crate::axes::{IDENTITY, Rotation, from_axes, product, rotate};
use crate::fe::vector::cross;

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
