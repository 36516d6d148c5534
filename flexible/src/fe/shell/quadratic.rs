//! Shells with mid-side nodes: MITC9 (M. L. Bucalem, K.-J. Bathe, Int. J. Numer. Methods Eng. 36, 1993) for
//! quadrilaterals; for triangles the plate MITC7 (K.-J. Bathe, F. Brezzi, S. W. Cho, Comput. Struct. 32, 1989)
//! with the membrane of MITC6a (P.-S. Lee, K.-J. Bathe, Comput. Struct. 82, 2004).
//!
//! The covariant strains of [`super::surface`] are taken at a few places of the element, and from there by
//! polynomials. So neither the shear nor the membrane of a curved element locks, and the strains of an element
//! with straight sides and nodes in their middles stay those of its displacements.
//!
//! **Quadrilateral.** With `g = 1/√3` and `a = √0.6`:
//!
//! ```text
//! rr, κ_rr, γ_r   at r = ±g, s = −a, 0, a     linear in r, quadratic in s
//! ss, κ_ss, γ_s   at r = −a, 0, a, s = ±g     quadratic in r, linear in s
//! rs, κ_rs        at r = ±g, s = ±g           linear in each
//! ```
//!
//! The ninth node is inside: its displacement, and the rotation of its director, less those of the eight nodes,
//! have the function `(1 − r²)(1 − s²)`. The displacement is an inner node of the mesh with its own mass: without
//! its inertia the frequencies of thick plates and membranes would be too low. The rotation, and the displacement
//! of a membrane, are eliminated here. The mean over the element of the strains of the middle surface and of the
//! curvatures is that of the strains before the tying, so that constant stresses are in balance in distorted
//! elements.
//!
//! **Triangle.** With `p, q = ½ ∓ 1/√12` the strains along the sides, rr, ss and `tt = rr + ss − 2 rs`, are
//! linear, from two places on the side and one inside. γ_r and γ_s are
//!
//! ```text
//! γ_r = a₁ + b₁ r + c₁ s + s (d r + e s)     γ_s = a₂ + b₂ r + c₂ s − r (d r + e s)
//! ```
//!
//! so that the shear along each side is linear. The eight numbers follow from it at two places on each side,
//! and from the means of both components. The rotation of the director has a part `27 r s (1 − r − s)`, which is
//! eliminated here; its curvature is not tied.

use super::condense::{Modes, condense};
use super::law::Plate;
use super::surface::{COVARIANT, Covariant, Geometry, Motion, Surface};
use super::{NINTH_NODE, Rows, STRAINS, ShellPoint, WIDTH};
use crate::element::quadrature::{Point, quadrilateral, triangle_3, triangle_7};
use crate::element::{ElementKind, Shape};
use crate::fe::vector::dot;

/// Eliminated freedoms inside: rotations about two tangents, and the displacement of a membrane.
const INNER: usize = 5;

/// First column of the inner node.
const NINTH: usize = 6 * NINTH_NODE;

/// Columns: freedoms of the nodes, then the eliminated ones.
const ALL: usize = WIDTH + INNER;

/// Strains of the curvature by that of the middle surface.
const CURVATURE: usize = 3;

/// Strains that keep their mean: those of the middle surface, and curvatures.
const MEAN: usize = 6;

/// Adds a covariant strain at a sampled place, times a factor, to one of the tied strains.
struct Share {
    to: usize,
    place: usize,
    from: usize,
    factor: f64,
}

/// The sampled places, and the tied strains at a place.
struct Tying {
    places: Vec<[f64; 2]>,
    shares: fn([f64; 2]) -> Vec<Share>,
    /// The function of the rotations inside.
    bubble: fn([f64; 2]) -> Motion,
}

/// The points of the stiffness, with rows over the freedoms of all nodes of this kind.
///
/// # Errors
/// The area for a unit of the reference domain (m²) where the element is folded or flat.
pub(super) fn points(
    kind: ElementKind,
    geometry: &Geometry,
    plate: &Plate,
) -> Result<Vec<ShellPoint>, f64> {
    let directors = geometry.directors()?;
    let (tying, integration) = match kind.corner_count() {
        4 => (of_quadrilateral(), quadrilateral(3)),
        _ => (of_triangle(), triangle_7()),
    };
    let middle = geometry.middle()?;
    let ninth = kind.corner_count() == 4;
    let sample = |at: [f64; 2], surface: &Surface| {
        let mut rows = surface.covariant::<ALL>(&directors);
        let bubble = (tying.bubble)(at);
        if ninth {
            surface.stretch(&mut rows, NINTH, bubble, &surface.director(&directors));
        }
        add_rotations(&mut rows, surface, bubble, &middle);
        rows
    };
    let mut sampled = Vec::with_capacity(tying.places.len());
    for at in &tying.places {
        let surface = geometry.at(*at, None)?;
        sampled.push(sample(*at, &surface));
    }
    let mut surfaces = Vec::with_capacity(integration.len());
    for Point { at, weight } in integration {
        let at = [at[0], at[1]];
        let surface = geometry.at(at, Some(middle.axes[0]))?;
        surfaces.push((at, weight * surface.area, surface));
    }
    let whole: f64 = surfaces.iter().map(|(_, area, _)| area).sum();
    // the nodes stand half as far apart as the corners
    let square = 0.25 * whole;
    let mut mean = [[0.0; ALL]; MEAN];
    let mut tied = Vec::with_capacity(surfaces.len());
    for (at, area, surface) in &surfaces {
        let mut covariant = [[0.0; ALL]; COVARIANT];
        for share in (tying.shares)(*at) {
            let from = &sampled[share.place][share.from];
            for (sum, x) in covariant[share.to].iter_mut().zip(from) {
                *sum += share.factor * x;
            }
        }
        let untied = sample(*at, surface);
        if !ninth {
            for strain in 3..MEAN {
                covariant[strain][WIDTH..].copy_from_slice(&untied[strain][WIDTH..]);
            }
        }
        let rows = surface.along_tangents(&covariant);
        let untied = surface.along_tangents(&untied);
        for ((sum, untied), tied) in mean.iter_mut().zip(&untied).zip(&rows) {
            for ((sum, x), y) in sum.iter_mut().zip(untied).zip(tied) {
                *sum += area / whole * (x - y);
            }
        }
        tied.push(rows);
    }
    let (mut found, mut modes) = (Vec::new(), Vec::new());
    for ((at, area, surface), mut tied) in surfaces.into_iter().zip(tied) {
        for (row, mean) in tied.iter_mut().zip(&mean) {
            row.iter_mut().zip(mean).for_each(|(x, y)| *x += y);
        }
        let mut rows: Rows = [[0.0; WIDTH]; STRAINS];
        let mut inner: Modes<INNER> = [[0.0; INNER]; STRAINS];
        for ((row, inner), all) in rows.iter_mut().zip(&mut inner).zip(&tied) {
            let (own, others) = all.split_at(WIDTH);
            row.copy_from_slice(own);
            inner.copy_from_slice(others);
        }
        rows[8] = surface.drilling();
        if ninth {
            surface.spin(&mut rows[8], NINTH, (tying.bubble)(at).slopes);
        }
        if plate.is_membrane() {
            for (row, inner) in rows.iter_mut().zip(&mut inner) {
                let (own, inner) = (&mut row[NINTH..NINTH + 3], &mut inner[2..]);
                own.swap_with_slice(inner);
            }
        }
        let corners = Shape::at(kind.linear(), [at[0], at[1], 0.0]);
        let side = surface.tangent[0];
        found.push(ShellPoint {
            area,
            rows,
            law: plate.law(&corners.values, &surface.axes, side, square),
            axes: surface.axes,
            side,
            at,
        });
        modes.push(inner);
    }
    condense(&mut found, &modes);
    Ok(found)
}

/// Adds the columns of rotations of the director inside about the tangents of the middle.
fn add_rotations(rows: &mut Covariant<ALL>, surface: &Surface, bubble: Motion, middle: &Surface) {
    let [first, second, normal] = middle.axes;
    let mut full = [[0.0; 3]; COVARIANT];
    surface.turn(&mut full, 0, bubble, normal);
    for (row, full) in rows.iter_mut().zip(full) {
        row[WIDTH] = dot(full, first);
        row[WIDTH + 1] = dot(full, second);
    }
}

/// Shares of a strain of the middle surface, and of the curvature.
fn share(shares: &mut Vec<Share>, to: usize, place: usize, from: usize, factor: f64) {
    if factor == 0.0 {
        return;
    }
    for step in [0, CURVATURE] {
        shares.push(Share {
            to: to + step,
            place,
            from: from + step,
            factor,
        });
    }
}

/// Values at `−g` and `g` of the linear functions on two places.
fn on_two(x: f64) -> [f64; 2] {
    let share = 3.0f64.sqrt() * x;
    [0.5 * (1.0 - share), 0.5 * (1.0 + share)]
}

/// Values of the quadratic functions on `−a, 0, a`.
fn on_three(x: f64) -> [f64; 3] {
    let side = 0.6f64.sqrt();
    let share = x / side;
    [
        0.5 * share * (share - 1.0),
        1.0 - share * share,
        0.5 * share * (share + 1.0),
    ]
}

fn of_quadrilateral() -> Tying {
    let (g, a) = ((1.0f64 / 3.0).sqrt(), 0.6f64.sqrt());
    let mut places = Vec::with_capacity(16);
    places.extend([-a, 0.0, a].into_iter().flat_map(|s| [[-g, s], [g, s]]));
    places.extend([-a, 0.0, a].into_iter().flat_map(|r| [[r, -g], [r, g]]));
    places.extend([[-g, -g], [g, -g], [-g, g], [g, g]]);
    let shares = |[r, s]: [f64; 2]| {
        let mut shares = Vec::with_capacity(44);
        for (axis, (along, across)) in [(r, s), (s, r)].into_iter().enumerate() {
            for (i, second) in on_three(across).into_iter().enumerate() {
                for (j, first) in on_two(along).into_iter().enumerate() {
                    let (place, factor) = (6 * axis + 2 * i + j, first * second);
                    share(&mut shares, axis, place, axis, factor);
                    let (to, from) = (6 + axis, 6 + axis);
                    shares.push(Share {
                        to,
                        place,
                        from,
                        factor,
                    });
                }
            }
        }
        for (i, second) in on_two(s).into_iter().enumerate() {
            for (j, first) in on_two(r).into_iter().enumerate() {
                share(&mut shares, 2, 12 + 2 * i + j, 2, first * second);
            }
        }
        shares
    };
    let bubble = |[r, s]: [f64; 2]| Motion {
        value: (1.0 - r * r) * (1.0 - s * s),
        slopes: [-2.0 * r * (1.0 - s * s), -2.0 * s * (1.0 - r * r)],
    };
    Tying {
        places,
        shares,
        bubble,
    }
}

/// Places of the strain along each side of the triangle: two on the side, one inside.
fn along_sides() -> [[[f64; 2]; 3]; 3] {
    let step = (1.0f64 / 12.0).sqrt();
    let (p, q, top) = (0.5 - step, 0.5 + step, (1.0f64 / 3.0).sqrt());
    [
        [[p, 0.0], [q, 0.0], [p, top]],
        [[0.0, p], [0.0, q], [top, p]],
        [[q, p], [p, q], [p, p]],
    ]
}

fn of_triangle() -> Tying {
    let mut places = along_sides().as_flattened().to_vec();
    places.extend(triangle_3().iter().map(|point| [point.at[0], point.at[1]]));
    let shares = |at: [f64; 2]| {
        let mut shares = Vec::with_capacity(60);
        for (side, own) in along_sides().iter().enumerate() {
            for (i, factor) in barycentric(own, at).into_iter().enumerate() {
                let place = 3 * side + i;
                match side {
                    0 | 1 => {
                        share(&mut shares, side, place, side, factor);
                        share(&mut shares, 2, place, side, factor);
                    }
                    // tt = rr + ss − 2 rs
                    _ => {
                        share(&mut shares, 2, place, 0, -factor);
                        share(&mut shares, 2, place, 1, -factor);
                        share(&mut shares, 2, place, 2, factor);
                    }
                }
            }
        }
        // place, and factors of γ_r and γ_s there
        let samples = [
            (0, [1.0, 0.0]),
            (1, [1.0, 0.0]),
            (3, [0.0, 1.0]),
            (4, [0.0, 1.0]),
            (7, [-1.0, 1.0]),
            (6, [-1.0, 1.0]),
        ];
        let mut add = |index: usize, place: usize, components: [f64; 2]| {
            let mut unit = [0.0; 8];
            unit[index] = 1.0;
            for (to, value) in triangle_shear(unit, at).into_iter().enumerate() {
                for (from, component) in components.into_iter().enumerate() {
                    shares.push(Share {
                        to: 6 + to,
                        place,
                        from: 6 + from,
                        factor: value * component,
                    });
                }
            }
        };
        for (index, (place, components)) in samples.into_iter().enumerate() {
            add(index, place, components);
        }
        // the mean is that of three places
        let third = 1.0 / 3.0;
        for place in 9..12 {
            add(6, place, [third, 0.0]);
            add(7, place, [0.0, third]);
        }
        shares
    };
    let bubble = |[r, s]: [f64; 2]| Motion {
        value: 27.0 * r * s * (1.0 - r - s),
        slopes: [
            27.0 * s * (1.0 - 2.0 * r - s),
            27.0 * r * (1.0 - r - 2.0 * s),
        ],
    };
    Tying {
        places,
        shares,
        bubble,
    }
}

/// Values of the linear functions on three places.
fn barycentric([a, b, c]: &[[f64; 2]; 3], at: [f64; 2]) -> [f64; 3] {
    let area = |p: [f64; 2], q: [f64; 2], r: [f64; 2]| {
        (q[0] - p[0]) * (r[1] - p[1]) - (r[0] - p[0]) * (q[1] - p[1])
    };
    let whole = area(*a, *b, *c);
    [area(at, *b, *c), area(*a, at, *c), area(*a, *b, at)].map(|x| x / whole)
}

/// γ_r and γ_s from the shear along the sides at `p` and `q` (γ_r on s = 0, γ_s on r = 0, γ_s − γ_r at `r = p`
/// and `r = q` on the third side), and the means of both.
fn triangle_shear(samples: [f64; 8], [r, s]: [f64; 2]) -> [f64; 2] {
    let [low_r, high_r, low_s, high_s, low_t, high_t, mean_r, mean_s] = samples;
    // value at 0 and slope of a linear function by its values at p and q
    let line = |low: f64, high: f64| {
        let slope = 3.0f64.sqrt() * (high - low);
        (0.5 * (low + high) - 0.5 * slope, slope)
    };
    let (a1, b1) = line(low_r, high_r);
    let (a2, c2) = line(low_s, high_s);
    let (h0, h1) = line(low_t, high_t);
    // c₁ + e = f and b₂ − d = g by the third side; then d − 2 e and 2 d − e by the means
    let f = a2 + c2 - a1 - h0;
    let g = h1 + c2 + b1 - f;
    let first = mean_r - a1 - b1 / 3.0;
    let second = mean_s - a2 - c2 / 3.0;
    let e = 4.0 * (second - 2.0 * first + (2.0 * f - g) / 3.0);
    let d = 2.0 * e + 12.0 * first - 4.0 * f;
    let (c1, b2) = (f - e, g + d);
    let bubble = d * r + e * s;
    [
        a1 + b1 * r + c1 * s + s * bubble,
        a2 + b2 * r + c2 * s - r * bubble,
    ]
}
