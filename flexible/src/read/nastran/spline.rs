//! The curve of `RSPLINE`: points between two independent ones follow a thin elastic tube through all.
//!
//! The tube is straight from point to point. It bends by Euler and Bernoulli's theory, without shear, and
//! has equal stiffness in bending and torsion, `E I = G J`, and `E A = 8 E I/D²` along itself. No force acts
//! at the points between. So the wrench f on the last point p_m (force, moment about p_m) is that of the
//! whole tube. With the motion `R_kc` of p_k by a rigid motion of c,
//!
//! ```text
//! u_k = R_k0 u_0 + Y_k f      Y_k = Σ_{s ≤ k} R_kc Z_s R_mcᵀ     (c: middle of the segment s)
//! f   = Y_m⁻¹ (u_m − R_m0 u_0)
//! ```
//!
//! `Z_s` is the relative motion of the ends of a segment of length l along t, by a wrench at its middle:
//! rotation `l/EI`, translation `l³/(12 EI)` across and `l D²/(8 EI)` along t. The source is the routine
//! `CRSPLS` of NASTRAN-95 (COSMIC), which NASA has published; MSC's description says no more than "an elastic tube".

use super::rigid::{Freedom, direction, solve};
use super::vector::{norm, unit};
use crate::fe::vector::{cross, dot, scale, subtract};
use crate::mesh::{Frame, Node};

/// Translations, then rotations.
type Matrix = [[f64; 6]; 6];

/// An equation: node, freedom, coefficient. The first freedom depends on the others.
pub(super) type Terms = Vec<(u32, u8, f64)>;

/// Why a spline has no equations.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Problem {
    /// Neighbours at one place; the index of the second one.
    Together(usize),
    /// The tube is too thin for the digits of a number.
    Thin,
}

/// The equations of the points between the independent ends of one spline. `points` are in order along the
/// curve: node, and its dependent freedoms as bits; those of the two ends are not used. `diameter` is that of
/// the tube (length of the deck). Freedoms that are not named are not tied.
///
/// # Errors
/// See [`Problem`].
pub(super) fn equations(
    points: &[(u32, u8)],
    diameter: f64,
    nodes: &[Node],
    frames: &[Frame],
) -> Result<Vec<Terms>, Problem> {
    let place = |node: u32| (nodes.get(node as usize)).map_or([0.0; 3], |node| node.position);
    let places: Vec<[f64; 3]> = points.iter().map(|(node, _)| place(*node)).collect();
    let mut length = 0.0;
    for (i, pair) in places.windows(2).enumerate() {
        let [first, second] = [pair[0], pair[1]];
        if first == second {
            return Err(Problem::Together(i + 1));
        }
        length += norm(subtract(second, first));
    }
    // lengths as shares of the curve's length: entries are of order 1
    let places: Vec<[f64; 3]> = places.iter().map(|at| scale(1.0 / length, *at)).collect();
    let (Some(&[start, ..]), Some(&[.., end])) =
        (places.first_chunk::<1>(), places.last_chunk::<1>())
    else {
        return Ok(Vec::new());
    };
    let mut sums = Vec::with_capacity(places.len());
    let mut flexibility = [[0.0; 6]; 6];
    for pair in places.windows(2) {
        let part = Segment::new(pair[0], pair[1], diameter / length);
        sums.push(part);
        add(&mut flexibility, &part.moved(end, end));
    }
    let inverse = inverse(&flexibility).ok_or(Problem::Thin)?;
    let ends = [points.first(), points.last()].map(|point| point.map_or(0, |(node, _)| *node));
    let mut all = Vec::new();
    for (k, ((node, freedoms), at)) in points.iter().zip(&places).enumerate() {
        if k == 0 || k + 1 == points.len() {
            continue;
        }
        let mut reached = [[0.0; 6]; 6];
        for part in sums.iter().take(k) {
            add(&mut reached, &part.moved(*at, end));
        }
        let of_end = product(&reached, &inverse);
        let mut of_start = transfer(start, *at);
        add(
            &mut of_start,
            &product(&of_end, &transfer(start, end)).map(|row| row.map(|value| -value)),
        );
        for freedom in (0..6).filter(|bit| freedoms >> bit & 1 == 1) {
            let row = Row {
                own: (*node, freedom),
                length,
                nodes,
                frames,
            };
            let mut terms = vec![(*node, freedom, 1.0)];
            row.add(ends[0], &of_start, &mut terms);
            row.add(ends[1], &of_end, &mut terms);
            all.push(terms);
        }
    }
    Ok(all)
}

/// The freedom of a point between.
struct Row<'a> {
    own: Freedom,
    length: f64,
    nodes: &'a [Node],
    frames: &'a [Frame],
}

impl Row<'_> {
    /// Adds the freedoms of an end, with the motion of the point by that of the end in basic axes.
    fn add(&self, end: u32, motion: &Matrix, terms: &mut Terms) {
        let axis = |(node, freedom): Freedom| {
            (self.nodes.get(node as usize))
                .map_or([0.0; 3], |node| direction(node, freedom, self.frames))
        };
        let mine = axis(self.own);
        let turns = self.own.1 >= 3;
        for freedom in 0..6 {
            let other = axis((end, freedom));
            let (row, column) = (3 * usize::from(turns), 3 * usize::from(freedom >= 3));
            let mut value = 0.0;
            for (line, a) in motion.iter().skip(row).zip(mine) {
                for (entry, b) in line.iter().skip(column).zip(other) {
                    value += a * entry * b;
                }
            }
            // rounding of cosines
            if value.abs() < 1e-12 {
                continue;
            }
            let unit = match (turns, freedom >= 3) {
                (false, true) => self.length,
                (true, false) => 1.0 / self.length,
                _ => 1.0,
            };
            terms.push((end, freedom, -value * unit));
        }
    }
}

/// A straight piece of the tube: its middle, and its flexibility there.
#[derive(Clone, Copy)]
struct Segment {
    middle: [f64; 3],
    flexibility: Matrix,
}

impl Segment {
    fn new(first: [f64; 3], second: [f64; 3], diameter: f64) -> Self {
        let along = subtract(second, first);
        let length = norm(along);
        let axis = unit(along).unwrap_or([0.0; 3]);
        let across = length * length * length / 12.0;
        let stretch = length * diameter * diameter / 8.0;
        let mut flexibility = [[0.0; 6]; 6];
        for (i, a) in axis.into_iter().enumerate() {
            for (j, b) in axis.into_iter().enumerate() {
                flexibility[i][j] = (stretch - across) * a * b;
            }
            flexibility[i][i] += across;
            flexibility[i + 3][i + 3] = length;
        }
        Segment {
            middle: std::array::from_fn(|i| 0.5 * (first[i] + second[i])),
            flexibility,
        }
    }

    /// The motion of `at` by a wrench at `end`: `R Z Rᵀ`.
    fn moved(&self, at: [f64; 3], end: [f64; 3]) -> Matrix {
        let right = transpose(&transfer(self.middle, end));
        product(
            &transfer(self.middle, at),
            &product(&self.flexibility, &right),
        )
    }
}

/// The motion of `to` by a rigid motion of `from`: `u + θ × (to − from)`, θ.
fn transfer(from: [f64; 3], to: [f64; 3]) -> Matrix {
    let arm = subtract(to, from);
    std::array::from_fn(|i| {
        std::array::from_fn(|j| {
            if i == j {
                1.0
            } else if i < 3 && j >= 3 {
                let axis = |k: usize| std::array::from_fn(|l| if l == k { 1.0 } else { 0.0 });
                dot(cross(axis(j - 3), arm), axis(i))
            } else {
                0.0
            }
        })
    })
}

fn transpose(a: &Matrix) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| a[j][i]))
}

fn product(a: &Matrix, b: &Matrix) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| (0..6).map(|k| a[i][k] * b[k][j]).sum()))
}

fn add(a: &mut Matrix, b: &Matrix) {
    for (row, other) in a.iter_mut().zip(b) {
        for (value, other) in row.iter_mut().zip(other) {
            *value += other;
        }
    }
}

/// The inverse of a symmetric matrix; `None` if it is singular to the digits of [`solve`].
fn inverse(matrix: &Matrix) -> Option<Matrix> {
    let mut columns = [[0.0; 6]; 6];
    for (i, column) in columns.iter_mut().enumerate() {
        let mut right = [0.0; 6];
        right[i] = 1.0;
        *column = solve(*matrix, right)?;
    }
    Some(columns)
}
