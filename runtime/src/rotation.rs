//! Rotations: unit quaternions (w, x, y, z), the exponential map and its tangent operator.
//!
//! Increments are in body axes: `A ← A exp(θ~)`.

use nalgebra::{Matrix3, Vector3};

/// Vector in space.
pub type V3 = Vector3<f64>;
/// Matrix 3×3.
pub type M3 = Matrix3<f64>;
/// Unit quaternion w, x, y, z.
pub type Quaternion = [f64; 4];

/// `v~`, so that `v~ w = v × w`.
pub fn skew(v: &V3) -> M3 {
    M3::new(0.0, -v.z, v.y, v.z, 0.0, -v.x, -v.y, v.x, 0.0)
}

/// Quaternion of the rotation vector θ (rad).
pub fn exponential(theta: &V3) -> Quaternion {
    let angle_squared = theta.norm_squared();
    let (w, factor) = if angle_squared < 1e-6 {
        // cos(θ/2) and sin(θ/2)/θ as series: the next terms are below 1e-20.
        (
            1.0 - angle_squared / 8.0 + angle_squared * angle_squared / 384.0,
            0.5 - angle_squared / 48.0 + angle_squared * angle_squared / 3840.0,
        )
    } else {
        let angle = libm::sqrt(angle_squared);
        (libm::cos(0.5 * angle), libm::sin(0.5 * angle) / angle)
    };
    [w, factor * theta.x, factor * theta.y, factor * theta.z]
}

/// Product of quaternions: the rotation `a` after which, in the turned axes, `b` follows.
pub fn product(a: &Quaternion, b: &Quaternion) -> Quaternion {
    [
        a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
        a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
        a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
        a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0],
    ]
}

/// The quaternion of unit length in the same direction; identity for zero.
pub fn normalized(q: &Quaternion) -> Quaternion {
    let norm = libm::sqrt(q.iter().map(|x| x * x).sum::<f64>());
    if norm > 0.0 {
        q.map(|x| x / norm)
    } else {
        [1.0, 0.0, 0.0, 0.0]
    }
}

/// Rotation matrix of a unit quaternion.
pub fn matrix(q: &Quaternion) -> M3 {
    let [w, x, y, z] = *q;
    M3::new(
        1.0 - 2.0 * (y * y + z * z),
        2.0 * (x * y - w * z),
        2.0 * (x * z + w * y),
        2.0 * (x * y + w * z),
        1.0 - 2.0 * (x * x + z * z),
        2.0 * (y * z - w * x),
        2.0 * (x * z - w * y),
        2.0 * (y * z + w * x),
        1.0 - 2.0 * (x * x + y * y),
    )
}

/// Quaternion of a rotation matrix (Shepperd 1978: the largest of the four squares is the divisor).
pub fn quaternion(a: &M3) -> Quaternion {
    let trace = a[(0, 0)] + a[(1, 1)] + a[(2, 2)];
    let candidates = [trace, a[(0, 0)], a[(1, 1)], a[(2, 2)]];
    let mut best = 0;
    for (i, c) in candidates.iter().enumerate() {
        if *c > candidates[best] {
            best = i;
        }
    }
    let q = match best {
        0 => [
            1.0 + trace,
            a[(2, 1)] - a[(1, 2)],
            a[(0, 2)] - a[(2, 0)],
            a[(1, 0)] - a[(0, 1)],
        ],
        1 => [
            a[(2, 1)] - a[(1, 2)],
            1.0 + 2.0 * a[(0, 0)] - trace,
            a[(0, 1)] + a[(1, 0)],
            a[(0, 2)] + a[(2, 0)],
        ],
        2 => [
            a[(0, 2)] - a[(2, 0)],
            a[(0, 1)] + a[(1, 0)],
            1.0 + 2.0 * a[(1, 1)] - trace,
            a[(1, 2)] + a[(2, 1)],
        ],
        _ => [
            a[(1, 0)] - a[(0, 1)],
            a[(0, 2)] + a[(2, 0)],
            a[(1, 2)] + a[(2, 1)],
            1.0 + 2.0 * a[(2, 2)] - trace,
        ],
    };
    normalized(&q)
}

/// Tangent operator T(θ) of the exponential in body axes: `d exp(θ~) = exp(θ~) (T dθ)~`,
/// `T = I − (1 − cos θ)/θ² θ~ + (θ − sin θ)/θ³ θ~θ~` (Brüls, Cardona, Arnold 2012, equation 18).
pub fn tangent(theta: &V3) -> M3 {
    let s = theta.norm_squared();
    let (c1, c2) = if s < 1e-2 {
        // series: the next terms are below 1e-15, and the closed forms lose two digits and more here
        (
            0.5 - s * (1.0 / 24.0 - s * (1.0 / 720.0 - s * (1.0 / 40320.0 - s / 3_628_800.0))),
            1.0 / 6.0 - s * (1.0 / 120.0 - s * (1.0 / 5040.0 - s / 362_880.0)),
        )
    } else {
        let angle = libm::sqrt(s);
        (
            (1.0 - libm::cos(angle)) / s,
            (angle - libm::sin(angle)) / (s * angle),
        )
    };
    let t = skew(theta);
    M3::identity() - t * c1 + t * t * c2
}

/// `∂(T(θ) w)/∂θ` for frozen w, of the other trivialisation `T(θ) = tangent(−θ) = I + b θ~ + c θ~θ~`,
/// `d exp(θ~) = (T dθ)~ exp(θ~)`: with `b = (1 − cos φ)/φ²`, `c = (φ − sin φ)/φ³`, `s = φ² = θ·θ` it is
/// `−b w~ + 2 b_s (θ×w) θᵀ − c ((θ×w)~ + θ~w~) + 2 c_s (θ×(θ×w)) θᵀ`.
pub fn tangent_along(theta: &V3, w: &V3) -> M3 {
    let s = theta.norm_squared();
    let (b, c, b_s, c_s) = if s < 1e-2 {
        // series, as in `tangent`
        (
            0.5 - s * (1.0 / 24.0 - s * (1.0 / 720.0 - s * (1.0 / 40320.0 - s / 3_628_800.0))),
            1.0 / 6.0 - s * (1.0 / 120.0 - s * (1.0 / 5040.0 - s / 362_880.0)),
            -1.0 / 24.0 + s * (2.0 / 720.0 - s * (3.0 / 40320.0 - s * 4.0 / 3_628_800.0)),
            -1.0 / 120.0 + s * (2.0 / 5040.0 - s * (3.0 / 362_880.0 - s * 4.0 / 39_916_800.0)),
        )
    } else {
        let angle = libm::sqrt(s);
        let (sin, cos) = (libm::sin(angle), libm::cos(angle));
        let sinc = sin / angle;
        let (b, c) = ((1.0 - cos) / s, (1.0 - sinc) / s);
        (
            b,
            c,
            (0.5 * sinc - b) / s,
            -((cos - sinc) / (2.0 * s) + c) / s,
        )
    };
    let once = theta.cross(w);
    let twice = theta.cross(&once);
    skew(w) * -b + once * theta.transpose() * (2.0 * b_s)
        - (skew(&once) + skew(theta) * skew(w)) * c
        + twice * theta.transpose() * (2.0 * c_s)
}

/// Inverse of [`tangent`]: `I + ½θ~ + (1 − θ/2 cot θ/2)/θ² θ~θ~`, for |θ| < 2π.
pub fn inverse_tangent(theta: &V3) -> M3 {
    let s = theta.norm_squared();
    let c = if s < 1e-2 {
        // series, as in `tangent`
        1.0 / 12.0 + s * (1.0 / 720.0 + s * (1.0 / 30240.0 + s / 1_209_600.0))
    } else {
        let half = 0.5 * libm::sqrt(s);
        (1.0 - half * libm::cos(half) / libm::sin(half)) / s
    };
    let t = skew(theta);
    M3::identity() + t * 0.5 + t * t * c
}

/// Adds a block to a matrix stored by rows of `width` numbers.
pub fn add_block(out: &mut [f64], width: usize, row: usize, column: usize, block: &M3) {
    for i in 0..3 {
        for j in 0..3 {
            out[(row + i) * width + column + j] += block[(i, j)];
        }
    }
}

/// Rotation vector of a quaternion, |θ| ≤ π. In rad, in the axes of both frames.
pub fn logarithm(q: &Quaternion) -> V3 {
    let q = if q[0] < 0.0 { q.map(|x| -x) } else { *q };
    let v = V3::new(q[1], q[2], q[3]);
    let sine = v.norm();
    if sine < 1e-12 {
        // the angle over its sine differs from one by a sixth of the square, far below rounding
        v * 2.0
    } else {
        v * (2.0 * libm::atan2(sine, q[0]) / sine)
    }
}

/// The turn from one orientation to another, in the axes of the first (rad).
pub fn turn_between(from: &[f64], to: &[f64]) -> V3 {
    let back: Quaternion = [from[0], -from[1], -from[2], -from[3]];
    let to: Quaternion = [to[0], to[1], to[2], to[3]];
    logarithm(&product(&back, &to))
}
