//! The shell of three nodes: the plate DKMT (I. Katili, Int. J. Numer. Methods Eng. 36, 1993) and the optimal
//! membrane with drilling rotations (C. A. Felippa, Comput. Methods Appl. Mech. Eng. 192, 2003).
//!
//! **Plate.** In the plane of the element `w = n·u`, `β₁ = θ·e₂`, `β₂ = −θ·e₁`. The rotations are linear, with
//! a quadratic part Δβ of the component along each side (length L, from node i to j):
//!
//! ```text
//! Δβ = −3/(2 (1 + φ)) ((w_j − w_i)/L + ½ (β_i + β_j))     φ = 12 D/(S L²)     γ = −⅔ φ Δβ
//! ```
//!
//! D is the bending stiffness and S the shear stiffness along the side; γ between the sides is linear. Thin
//! plates have φ = 0, which is the triangle DKT.
//!
//! **Membrane.** The usual one has constant strains, as in the codes, and is stiff in its own plane. That with
//! drilling rotations (`CTRIAR`) has constant strains `Lᵀ u/(A t)` and strains `3/2 √β₀ T_e Q_i θ̃` that vanish
//! in the mean, with the rotations θ̃ less that of the sides, α_b = 3/2, `β₀ = ½ (1 − 4 ν²)`, at least 0.01.
//! In its plane a rectangle of such triangles bends exactly, whatever its aspect ratio. But on a curved
//! surface of radius R it locks where the square of its side is above R t: there the facets' normals differ
//! too much for the rotations that they share.

use super::{
    Places, Rows, STRAINS, ShellPoint, WIDTH,
    law::{Law, Plate},
};
use crate::element::{ElementKind, Shape};
use crate::fe::vector::{Vector, cross, dot, norm, scale, subtract};

/// Reference coordinates of the nodes.
pub(super) const CORNERS: [[f64; 2]; 3] = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];

/// The sides, from node to node.
const SIDES: [[usize; 2]; 3] = [[0, 1], [1, 2], [2, 0]];

/// Freedoms in the plane of a node: displacements along both axes, drilling rotation.
type InPlane = [f64; 9];

/// A triangle in its plane.
struct Plane {
    axes: [Vector; 3],
    place: [[f64; 2]; 3],
    area: f64,
}

impl Plane {
    fn new(places: &Places) -> Result<Self, f64> {
        let sides = [
            subtract(places[1], places[0]),
            subtract(places[2], places[0]),
        ];
        let normal = cross(sides[0], sides[1]);
        let double = norm(normal);
        // sides that are parallel but for the digits of a file have no normal
        if double.is_nan() || double <= 1e-9 * norm(sides[0]) * norm(sides[1]) {
            return Err(double);
        }
        let first = scale(1.0 / norm(sides[0]), sides[0]);
        let normal = scale(1.0 / double, normal);
        let second = cross(normal, first);
        let at = |i: usize| {
            let from = subtract(places[i], places[0]);
            [dot(from, first), dot(from, second)]
        };
        Ok(Plane {
            axes: [first, second, normal],
            place: [at(0), at(1), at(2)],
            area: 0.5 * double,
        })
    }

    fn x(&self, i: usize, j: usize) -> f64 {
        self.place[i][0] - self.place[j][0]
    }

    fn y(&self, i: usize, j: usize) -> f64 {
        self.place[i][1] - self.place[j][1]
    }

    /// Slopes of the nodes' linear functions along both axes (1/m).
    fn slopes(&self) -> [[f64; 2]; 3] {
        [[1, 2], [2, 0], [0, 1]]
            .map(|[j, k]| [self.y(j, k), self.x(k, j)].map(|x| 0.5 * x / self.area))
    }
}

/// The points of the stiffness: the middles of the sides.
///
/// # Errors
/// Twice the area (m²) of a flat element.
pub(super) fn points(
    places: &Places,
    plate: &Plate,
    drilling: bool,
) -> Result<Vec<ShellPoint>, f64> {
    let plane = Plane::new(places)?;
    let centre = Shape::at(ElementKind::Triangle3, [1.0 / 3.0, 1.0 / 3.0, 0.0]);
    let square = 2.0 * plane.area;
    let along = subtract(places[1], places[0]);
    let law = plate.law(&centre.values, &plane.axes, along, square);
    let sides = Side::all(&plane, &law);
    let membrane = Membrane::new(&plane, &law.0, drilling);
    let point = |side: usize| {
        let [a, b] = SIDES[side];
        let mut weight = [0.0; 3];
        (weight[a], weight[b]) = (0.5, 0.5);
        let shape = Shape::at(ElementKind::Triangle3, [weight[1], weight[2], 0.0]);
        let mut rows = [[0.0; WIDTH]; STRAINS];
        for (row, plane_row) in rows.iter_mut().zip(membrane.strain(side)) {
            for (k, x) in plane_row.into_iter().enumerate() {
                let (node, which) = (k / 3, k % 3);
                let (first, axis) = match which {
                    2 => (6 * node + 3, plane.axes[2]),
                    _ => (6 * node, plane.axes[which]),
                };
                super::put(row, first, x, axis);
            }
        }
        plate_rows(&plane, &sides, weight, &mut rows);
        if !drilling {
            drilling_row(&plane, weight, &mut rows[8]);
        }
        ShellPoint {
            area: plane.area / 3.0,
            rows,
            law: plate.law(&shape.values, &plane.axes, along, square),
            axes: plane.axes,
            side: along,
            at: [weight[1], weight[2]],
        }
    };
    Ok((0..3).map(point).collect())
}

/// Adds the row of `θ·n − ½ (e₂·u,₁ − e₁·u,₂)` at the barycentric place `weight`.
fn drilling_row(plane: &Plane, weight: [f64; 3], row: &mut [f64; WIDTH]) {
    let [first, second, normal] = plane.axes;
    for (node, ([x, y], weight)) in plane.slopes().into_iter().zip(weight).enumerate() {
        super::put(row, 6 * node, -0.5 * x, second);
        super::put(row, 6 * node, 0.5 * y, first);
        super::put(row, 6 * node + 3, weight, normal);
    }
}

/// A side of the plate.
struct Side {
    /// Direction in the plane.
    cosine: f64,
    sine: f64,
    /// Rows over (w, β₁, β₂) of the three nodes.
    bulge: InPlane,
    shear: InPlane,
}

impl Side {
    fn all(plane: &Plane, law: &Law) -> [Side; 3] {
        SIDES.map(|[i, j]| {
            let (x, y) = (plane.x(j, i), plane.y(j, i));
            let length = libm::hypot(x, y);
            let (cosine, sine) = (x / length, y / length);
            let bending = law.bending_along([cosine, sine]);
            let shear = law.shear_along([cosine, sine]);
            // a membrane has neither
            let phi = match shear {
                0.0 => 0.0,
                shear => 12.0 * bending / (shear * length * length),
            };
            let factor = -1.5 / (1.0 + phi);
            let mut bulge = [0.0; 9];
            for (node, sign) in [(i, -1.0), (j, 1.0)] {
                bulge[3 * node] = factor * sign / length;
                bulge[3 * node + 1] = factor * 0.5 * cosine;
                bulge[3 * node + 2] = factor * 0.5 * sine;
            }
            Side {
                cosine,
                sine,
                bulge,
                shear: bulge.map(|x| -2.0 / 3.0 * phi * x),
            }
        })
    }
}

/// Adds the rows of curvatures and shear at the barycentric place `weight`.
fn plate_rows(plane: &Plane, sides: &[Side; 3], weight: [f64; 3], rows: &mut Rows) {
    let slopes = plane.slopes();
    let mut curvature = [[0.0; 9]; 3];
    for (node, [x, y]) in slopes.iter().enumerate() {
        curvature[0][3 * node + 1] += x;
        curvature[1][3 * node + 2] += y;
        curvature[2][3 * node + 1] += y;
        curvature[2][3 * node + 2] += x;
    }
    let mut shear = [[0.0; 9]; 2];
    for (side, [i, j]) in sides.iter().zip(SIDES) {
        let slope = |axis: usize| 4.0 * (weight[i] * slopes[j][axis] + weight[j] * slopes[i][axis]);
        let (x, y) = (slope(0), slope(1));
        for (k, bulge) in side.bulge.iter().enumerate() {
            curvature[0][k] += x * side.cosine * bulge;
            curvature[1][k] += y * side.sine * bulge;
            curvature[2][k] += (y * side.cosine + x * side.sine) * bulge;
        }
    }
    // at each node the shear along its two sides gives both components
    for node in 0..3 {
        let (out, back) = (&sides[node], &sides[(node + 2) % 3]);
        let determinant = out.cosine * back.sine - back.cosine * out.sine;
        let share = weight[node] / determinant;
        let [first, second] = &mut shear;
        for (sum, (a, b)) in first.iter_mut().zip(out.shear.iter().zip(back.shear)) {
            *sum += share * (back.sine * a - out.sine * b);
        }
        for (sum, (a, b)) in second.iter_mut().zip(out.shear.iter().zip(back.shear)) {
            *sum += share * (out.cosine * b - back.cosine * a);
        }
    }
    let [first, second, normal] = plane.axes;
    let mut spread = |target: usize, own: &InPlane| {
        for node in 0..3 {
            super::put(&mut rows[target], 6 * node, own[3 * node], normal);
            super::put(&mut rows[target], 6 * node + 3, own[3 * node + 1], second);
            super::put(&mut rows[target], 6 * node + 3, -own[3 * node + 2], first);
        }
    };
    for (i, own) in curvature.iter().enumerate() {
        spread(3 + i, own);
    }
    for (i, own) in shear.iter().enumerate() {
        spread(6 + i, own);
    }
}

/// The membrane's strains over the freedoms in the plane.
struct Membrane {
    constant: [InPlane; 3],
    /// Part of the rotations beyond that of the sides.
    hierarchical: [InPlane; 3],
    natural: [[f64; 3]; 3],
    squares: [f64; 3],
    area: f64,
    factor: f64,
}

impl Membrane {
    fn new(plane: &Plane, law: &[[f64; STRAINS]; STRAINS], drilling: bool) -> Self {
        let area = plane.area;
        let squares = SIDES.map(|[i, j]| {
            let (x, y) = (plane.x(j, i), plane.y(j, i));
            x * x + y * y
        });
        let poisson = match (law[0][0] * law[1][1]).sqrt() {
            0.0 => 0.0,
            mean => law[0][1] / mean,
        };
        let (basic, beta) = match drilling {
            true => (1.5, (0.5 * (1.0 - 4.0 * poisson * poisson)).max(0.01)),
            false => (0.0, 0.0),
        };
        let mut constant = [[0.0; 9]; 3];
        for node in 0..3 {
            let (next, last) = ((node + 1) % 3, (node + 2) % 3);
            let (b, c) = (plane.y(next, last), plane.x(last, next));
            let scale = 0.5 / area;
            constant[0][3 * node] = scale * b;
            constant[1][3 * node + 1] = scale * c;
            constant[2][3 * node] = scale * c;
            constant[2][3 * node + 1] = scale * b;
            let turn = basic / 6.0 * scale;
            let (y_out, y_in) = (plane.y(node, last), plane.y(next, node));
            let (x_out, x_in) = (plane.x(last, node), plane.x(node, next));
            constant[0][3 * node + 2] = turn * b * (y_out - y_in);
            constant[1][3 * node + 2] = turn * c * (x_out - x_in);
            constant[2][3 * node + 2] = 2.0 * turn * (x_out * y_out - x_in * y_in);
        }
        let mut hierarchical = [[0.0; 9]; 3];
        for (row, own) in hierarchical.iter_mut().enumerate() {
            for node in 0..3 {
                let (next, last) = ((node + 1) % 3, (node + 2) % 3);
                own[3 * node] = plane.x(last, next) / (4.0 * area);
                own[3 * node + 1] = plane.y(last, next) / (4.0 * area);
            }
            own[3 * row + 2] = 1.0;
        }
        let [l21, l32, l13] = squares;
        let scale = 0.25 / (area * area);
        let x = |i: usize, j: usize| plane.x(i - 1, j - 1);
        let y = |i: usize, j: usize| plane.y(i - 1, j - 1);
        let natural = [
            [
                y(2, 3) * y(1, 3) * l21,
                y(3, 1) * y(2, 1) * l32,
                y(1, 2) * y(3, 2) * l13,
            ],
            [
                x(2, 3) * x(1, 3) * l21,
                x(3, 1) * x(2, 1) * l32,
                x(1, 2) * x(3, 2) * l13,
            ],
            [
                (y(2, 3) * x(3, 1) + x(3, 2) * y(1, 3)) * l21,
                (y(3, 1) * x(1, 2) + x(1, 3) * y(2, 1)) * l32,
                (y(1, 2) * x(2, 3) + x(2, 1) * y(3, 2)) * l13,
            ],
        ]
        .map(|row| row.map(|x| scale * x));
        Membrane {
            constant,
            hierarchical,
            natural,
            squares,
            area,
            factor: 1.5 * beta.sqrt(),
        }
    }

    /// Natural strains for the rotations, at the middle of a side: the mean of those of its nodes.
    fn rotations(&self, side: usize) -> [[f64; 3]; 3] {
        let [i, j] = SIDES[side];
        let (a, b) = (QS[i], QS[j]);
        std::array::from_fn(|row| {
            let scale = 2.0 / 3.0 * self.area / self.squares[row];
            std::array::from_fn(|column| scale * 0.5 * (a[row][column] + b[row][column]))
        })
    }

    /// Strains at the middle of a side.
    fn strain(&self, side: usize) -> [InPlane; 3] {
        let rotations = self.rotations(side);
        let mut strain = self.constant;
        for (i, row) in strain.iter_mut().enumerate() {
            for (j, rotation) in rotations.iter().enumerate() {
                for (k, own) in rotation.iter().zip(&self.hierarchical) {
                    let factor = self.factor * self.natural[i][j] * k;
                    for (x, h) in row.iter_mut().zip(own) {
                        *x += factor * h;
                    }
                }
            }
        }
        strain
    }
}

/// Felippa's numbers β₁ … β₉ of the matrices Q at the three nodes, by sides 12, 23, 31.
const QS: [[[f64; 3]; 3]; 3] = [
    [[1.0, 2.0, 1.0], [0.0, 1.0, -1.0], [-1.0, -1.0, -2.0]],
    [[-2.0, -1.0, -1.0], [1.0, 1.0, 2.0], [-1.0, 0.0, 1.0]],
    [[1.0, -1.0, 0.0], [-1.0, -2.0, -1.0], [2.0, 1.0, 1.0]],
];
