//! Rotations by unit quaternions (w, x, y, z), for pictures. Those of the motion are in the crate `runtime`,
//! which this crate does not use.

/// A quaternion scaled to unit length; one of length zero becomes the identity.
pub fn normalised(q: [f64; 4]) -> [f64; 4] {
    let length = q.iter().map(|c| c * c).sum::<f64>().sqrt();
    if length > 0.0 && length.is_finite() {
        q.map(|c| c / length)
    } else {
        [1.0, 0.0, 0.0, 0.0]
    }
}

/// A·v = v + 2w·(u × v) + 2u × (u × v), q = (w, u) of unit length.
pub fn rotated(q: [f64; 4], v: [f64; 3]) -> [f64; 3] {
    let [w, x, y, z] = q;
    let u = [x, y, z];
    let first = cross(u, v);
    let second = cross(u, first);
    [0, 1, 2].map(|i| v[i] + 2.0 * (w * first[i] + second[i]))
}

/// The cross product a × b.
pub fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// The scalar product a·b.
pub fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The difference a − b.
pub fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|i| a[i] - b[i])
}

/// A vector scaled to length 1; a vector of length zero does not change.
pub(super) fn direction(v: [f64; 3]) -> [f64; 3] {
    let length = dot(v, v).sqrt();
    if length > 0.0 {
        v.map(|c| c / length)
    } else {
        v
    }
}

/// The one of q and −q, which are the same rotation, that is nearer to `before`, so that interpolation takes
/// the short way.
pub fn nearer(before: [f64; 4], q: [f64; 4]) -> [f64; 4] {
    let product: f64 = before.iter().zip(&q).map(|(a, b)| a * b).sum();
    if product < 0.0 { q.map(|c| -c) } else { q }
}
