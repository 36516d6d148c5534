//! Points and weights for integrating over the elements' reference domains.
//!
//! | domain | coordinates | size |
//! | --- | --- | --- |
//! | hexahedron | ξ, η, ζ ∈ [−1, 1] | 8 |
//! | wedge | r, s ≥ 0, r + s ≤ 1; t ∈ [−1, 1] | 1 |
//! | tetrahedron | r, s, t ≥ 0, r + s + t ≤ 1 | 1/6 |
//! | pyramid | x, y ∈ [−1, 1], ζ ∈ [0, 1]; ξ = x (1 − ζ), η = y (1 − ζ) | 4/3 |
//! | quadrilateral | ξ, η ∈ [−1, 1] | 4 |
//! | triangle | r, s ≥ 0, r + s ≤ 1 | 1/2 |
//!
//! Simplices and pyramids of any degree come from Gauss–Jacobi rules on collapsed coordinates (A. H. Stroud,
//! Approximate Calculation of Multiple Integrals, 1971, §2.4–2.5): all weights are positive, all points
//! inside.

/// A point of a rule.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Place in the reference domain; unused coordinates are zero.
    pub at: [f64; 3],
    /// Weight; the weights sum to the size of the domain.
    pub weight: f64,
}

/// A place on the unit interval and its weight.
type LinePoint = (f64, f64);

/// Value and derivative of the Jacobi polynomial P_n^(α,0) at `x`, by the three-term recurrence (Abramowitz
/// and Stegun 22.7.1).
fn jacobi(n: usize, alpha: f64, x: f64) -> (f64, f64) {
    let (mut previous, mut previous_slope) = (1.0, 0.0);
    if n == 0 {
        return (previous, previous_slope);
    }
    let mut value = alpha + 1.0 + (alpha + 2.0) * (x - 1.0) / 2.0;
    let mut slope = (alpha + 2.0) / 2.0;
    for k in 2..=n {
        let k = k as f64;
        let double = 2.0 * k + alpha;
        let left = 2.0 * k * (k + alpha) * (double - 2.0);
        let factor = (double - 1.0) * (double * (double - 2.0) * x + alpha * alpha);
        let factor_slope = (double - 1.0) * double * (double - 2.0);
        let back = 2.0 * (k + alpha - 1.0) * (k - 1.0) * double;
        let next = (factor * value - back * previous) / left;
        let next_slope = (factor_slope * value + factor * slope - back * previous_slope) / left;
        (previous, previous_slope) = (value, slope);
        (value, slope) = (next, next_slope);
    }
    (value, slope)
}

/// The `n`-point Gauss–Jacobi rule for ∫₀¹ (1 − t)^α f(t) dt, exact for polynomials f up to degree 2n − 1.
/// Roots are isolated by signs on a fine grid (n ≤ 10 is far from its resolution) and polished by Newton;
/// weights are 1/((1 − x²) P′(x)²).
fn gauss_jacobi(n: usize, alpha: f64) -> Vec<LinePoint> {
    // a choice: the nearest roots of ten points are many cells apart
    const CELLS: usize = 400;
    let mut points = Vec::with_capacity(n);
    // shifted by an irrational part of a cell, so that no root (0 among them) falls on the grid
    let grid = |i: usize| (-1.0 + 2.0 * (i as f64 - 0.382_966) / CELLS as f64).clamp(-1.0, 1.0);
    for i in 0..=CELLS {
        let (mut low, mut high) = (grid(i), grid(i + 1));
        let sign = jacobi(n, alpha, low).0 > 0.0;
        if (jacobi(n, alpha, high).0 > 0.0) == sign {
            continue;
        }
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if (jacobi(n, alpha, middle).0 > 0.0) == sign {
                low = middle;
            } else {
                high = middle;
            }
        }
        let mut x = 0.5 * (low + high);
        for _ in 0..2 {
            let (value, slope) = jacobi(n, alpha, x);
            x -= value / slope;
        }
        let slope = jacobi(n, alpha, x).1;
        points.push((0.5 * (1.0 + x), 1.0 / ((1.0 - x * x) * slope * slope)));
    }
    points
}

/// The Gauss–Legendre rule of `n` points on [−1, 1].
fn legendre(n: usize) -> Vec<LinePoint> {
    gauss_jacobi(n, 0.0)
        .into_iter()
        .map(|(t, weight)| (2.0 * t - 1.0, 2.0 * weight))
        .collect()
}

/// The Gauss–Legendre rule of `n` points on [0, 1]: place and weight, exact to degree 2n − 1.
pub fn unit_interval(n: usize) -> Vec<(f64, f64)> {
    gauss_jacobi(n, 0.0)
}

/// The rule of one point, for a direction that an element does not have.
const ONE: [LinePoint; 1] = [(0.0, 1.0)];

/// The points of three rules, the first outermost, made of a place and a weight of each rule.
fn lattice(rules: [&[LinePoint]; 3], point: impl Fn([LinePoint; 3]) -> Point) -> Vec<Point> {
    let [outer, middle, inner] = rules;
    let mut points = Vec::with_capacity(outer.len() * middle.len() * inner.len());
    for &a in outer {
        for &b in middle {
            points.extend(inner.iter().map(|&c| point([a, b, c])));
        }
    }
    points
}

/// `n`³ Gauss points of the hexahedron: exact to degree 2n − 1 in each coordinate.
pub fn hexahedron(n: usize) -> Vec<Point> {
    let line = legendre(n);
    lattice([&line, &line, &line], |[(z, wz), (y, wy), (x, wx)]| Point {
        at: [x, y, z],
        weight: wx * wy * wz,
    })
}

/// 14 points on the cube for degree 5: six on the axes, eight on the diagonals (B. M. Irons, Int. J. Numer.
/// Meth. Eng. 3, 1971).
pub fn hexahedron_14() -> Vec<Point> {
    let axis = libm::sqrt(19.0 / 30.0);
    let diagonal = libm::sqrt(19.0 / 33.0);
    let mut points = Vec::with_capacity(14);
    for sign in [-1.0, 1.0] {
        for direction in 0..3 {
            let mut at = [0.0; 3];
            at[direction] = sign * axis;
            points.push(Point {
                at,
                weight: 320.0 / 361.0,
            });
        }
        for [second, third] in [[-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]] {
            points.push(Point {
                at: [sign * diagonal, second * diagonal, third * diagonal],
                weight: 121.0 / 361.0,
            });
        }
    }
    points
}

/// `n`² Gauss points of the quadrilateral: exact to degree 2n − 1 in each coordinate.
pub fn quadrilateral(n: usize) -> Vec<Point> {
    let line = legendre(n);
    lattice([&ONE, &line, &line], |[_, (y, wy), (x, wx)]| Point {
        at: [x, y, 0.0],
        weight: wx * wy,
    })
}

/// The centre of the triangle, exact to degree 1.
pub fn triangle_1() -> Vec<Point> {
    vec![Point {
        at: [1.0 / 3.0, 1.0 / 3.0, 0.0],
        weight: 0.5,
    }]
}

/// The symmetric triangle rule of three inner points, exact to degree 2.
pub fn triangle_3() -> Vec<Point> {
    let (near, far) = (1.0 / 6.0, 2.0 / 3.0);
    [[near, near, 0.0], [far, near, 0.0], [near, far, 0.0]]
        .map(|at| Point {
            at,
            weight: 1.0 / 6.0,
        })
        .to_vec()
}

/// The symmetric triangle rule of seven inner points (J. Radon, Monatsh. Math. Phys. 52, 1948), exact to degree
/// 5.
pub fn triangle_7() -> Vec<Point> {
    let root = 15.0f64.sqrt();
    let mut points = vec![([1.0 / 3.0; 2], 9.0 / 80.0)];
    for sign in [-1.0, 1.0] {
        let near = (6.0 + sign * root) / 21.0;
        let far = 1.0 - 2.0 * near;
        let weight = (155.0 + sign * root) / 2400.0;
        points.extend([[near, near], [far, near], [near, far]].map(|at| (at, weight)));
    }
    points
        .into_iter()
        .map(|([r, s], weight)| Point {
            at: [r, s, 0.0],
            weight,
        })
        .collect()
}

/// A triangle rule of `n`² points, exact to degree 2n − 1.
pub fn triangle(n: usize) -> Vec<Point> {
    let (along, across) = (gauss_jacobi(n, 1.0), gauss_jacobi(n, 0.0));
    lattice([&ONE, &along, &across], |[_, (r, wr), (s, ws)]| Point {
        at: [r, s * (1.0 - r), 0.0],
        weight: wr * ws,
    })
}

/// The centre of the tetrahedron, exact to degree 1.
pub fn tetrahedron_1() -> Vec<Point> {
    vec![Point {
        at: [0.25; 3],
        weight: 1.0 / 6.0,
    }]
}

/// The symmetric tetrahedron rule of four points, exact to degree 2: barycentric (5 + 3√5)/20 and (5 −
/// √5)/20.
pub fn tetrahedron_4() -> Vec<Point> {
    let root = 5.0f64.sqrt();
    let (far, near) = ((5.0 + 3.0 * root) / 20.0, (5.0 - root) / 20.0);
    [
        [near, near, near],
        [far, near, near],
        [near, far, near],
        [near, near, far],
    ]
    .map(|at| Point {
        at,
        weight: 1.0 / 24.0,
    })
    .to_vec()
}

/// A tetrahedron rule of `n`³ points, exact to degree 2n − 1.
pub fn tetrahedron(n: usize) -> Vec<Point> {
    let lines = [2.0, 1.0, 0.0].map(|power| gauss_jacobi(n, power));
    lattice(
        lines.each_ref().map(Vec::as_slice),
        |[(r, wr), (s, ws), (t, wt)]| {
            let rest = 1.0 - r;
            Point {
                at: [r, s * rest, t * (1.0 - s) * rest],
                weight: wr * ws * wt,
            }
        },
    )
}

/// The wedge: a triangle rule times `n` Gauss points along t.
pub fn wedge(triangle: &[Point], n: usize) -> Vec<Point> {
    let mut points = Vec::with_capacity(triangle.len() * n);
    for &(t, wt) in &legendre(n) {
        for point in triangle {
            points.push(Point {
                at: [point.at[0], point.at[1], t],
                weight: point.weight * wt,
            });
        }
    }
    points
}

/// The pyramid: `n`³ points, exact to degree 2n − 1 in each of the collapsed coordinates; the weights hold
/// the map's (1 − ζ)².
pub fn pyramid(n: usize) -> Vec<Point> {
    let (line, up) = (legendre(n), gauss_jacobi(n, 2.0));
    lattice([&up, &line, &line], |[(z, wz), (y, wy), (x, wx)]| Point {
        at: [x, y, z],
        weight: wx * wy * wz,
    })
}
