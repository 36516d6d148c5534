//! The shell of four nodes: MITC4 (E. N. Dvorkin, K.-J. Bathe, Eng. Comput. 1, 1984) with a membrane enhanced
//! by four strains (J. C. Simo, M. S. Rifai, Int. J. Numer. Methods Eng. 29, 1990).
//!
//! With tangents g_r = ∂x/∂r, g_s, the director `d = Σ N_a n_a` of the nodes' normals and its motion `β = Σ
//! N_a θ_a × n_a` the covariant strains are
//!
//! ```text
//! e_αβ = ½ (g_α·u,β + g_β·u,α)                 κ_αβ = ½ (g_α·β,β + g_β·β,α + d,α·u,β + d,β·u,α)
//! γ_α  = g_α·β + d·u,α    γ_r at the middles of the sides s = ±1, γ_s at those of r = ±1, linear between
//! ```
//!
//! They vanish in a rigid motion also if the four nodes are in no plane. The sampled γ does not lock in thin
//! plates. The enhanced strains (j₀/j) T₀ [r, s, (r, s)] vanish in the mean over the element, so constant
//! strains stay exact, and a rectangle bends in its plane without locking. They are eliminated here.

use super::{Law, NODES, Places, Rows, STRAINS, ShellPoint, WIDTH, law::Plate, put};
use crate::element::{ElementKind, Shape};
use crate::fe::solid::tangents;
use crate::fe::vector::{Vector, cross, dot, norm, scale, subtract};

/// Reference coordinates of the nodes.
pub(super) const CORNERS: [[f64; 2]; NODES] = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];

/// Number of enhanced strains.
const ENHANCED: usize = 4;

/// Rows of the enhanced membrane strains, then of the drilling.
type Enhanced = [[f64; ENHANCED]; 4];

/// The strains that the enhanced modes change, by the lines of [`Enhanced`].
const CHANGED: [usize; 4] = [0, 1, 2, 8];

/// The surface at a place of the reference domain.
struct Surface {
    shape: Shape,
    /// ∂x/∂r, ∂x/∂s (m).
    tangent: [Vector; 2],
    /// Unit tangents and normal.
    axes: [Vector; 3],
    /// Components along the unit tangents of the contravariant basis (1/m).
    dual: [[f64; 2]; 2],
    /// Area for a unit of the reference domain (m²).
    area: f64,
}

impl Surface {
    /// The surface at a place. The first unit tangent is the part of `first` in the surface.
    fn at(places: &Places, at: [f64; 2], first: Option<Vector>) -> Result<Self, f64> {
        let shape = Shape::at(ElementKind::Quadrilateral4, [at[0], at[1], 0.0]);
        let [r, s, _] = tangents(&shape, places, NODES);
        let normal = cross(r, s);
        let area = norm(normal);
        if area.is_nan() || area <= 1e-9 * norm(r) * norm(s) {
            return Err(area);
        }
        let normal = scale(1.0 / area, normal);
        let first = first.unwrap_or(r);
        let along = subtract(first, scale(dot(first, normal), normal));
        let length = norm(along);
        if length.is_nan() || length <= 1e-9 * norm(first) {
            return Err(area);
        }
        let first = scale(1.0 / length, along);
        let second = cross(normal, first);
        let jacobian = [r, s].map(|g| [dot(g, first), dot(g, second)]);
        let [[a, b], [c, d]] = jacobian;
        let determinant = a * d - b * c;
        Ok(Surface {
            shape,
            tangent: [r, s],
            axes: [first, second, normal],
            dual: [
                [d / determinant, -c / determinant],
                [-b / determinant, a / determinant],
            ],
            area,
        })
    }

    /// Slopes of a node's function in r and s.
    fn slopes(&self, node: usize) -> [f64; 2] {
        let [r, s, _] = self.shape.slopes[node];
        [r, s]
    }

    /// The director's slopes in r and s, and the director.
    fn director(&self, directors: &[Vector; NODES]) -> ([Vector; 2], Vector) {
        let mut slopes = [[0.0; 3]; 2];
        let mut director = [0.0; 3];
        for (node, own) in directors.iter().enumerate() {
            let [r, s] = self.slopes(node);
            for axis in 0..3 {
                slopes[0][axis] += r * own[axis];
                slopes[1][axis] += s * own[axis];
                director[axis] += self.shape.values[node] * own[axis];
            }
        }
        (slopes, director)
    }

    /// From covariant strains (rr, ss, 2 rs) to those along the unit tangents (11, 22, 2 12).
    fn transformation(&self) -> [[f64; 3]; 3] {
        let [[r1, r2], [s1, s2]] = self.dual;
        [
            [r1 * r1, s1 * s1, r1 * s1],
            [r2 * r2, s2 * s2, r2 * s2],
            [2.0 * r1 * r2, 2.0 * s1 * s2, r1 * s2 + s1 * r2],
        ]
    }
}

/// The points of the stiffness: 2 × 2.
///
/// # Errors
/// The area for a unit of the reference domain (m²) where the element is folded or flat.
pub(super) fn points(places: &Places, plate: &Plate) -> Result<Vec<ShellPoint>, f64> {
    let middle = Surface::at(places, [0.0, 0.0], None)?;
    let mut directors = [[0.0; 3]; NODES];
    for (director, corner) in directors.iter_mut().zip(CORNERS) {
        let surface = Surface::at(places, corner, None)?;
        *director = surface.axes[2];
    }
    // crossed sides turn the normal round
    for (i, first) in directors.iter().enumerate() {
        for second in &directors[..i] {
            if dot(*first, *second) <= 0.05 {
                return Err(-middle.area);
            }
        }
    }
    let shear = Shear::new(places, &directors)?;
    let place = (1.0f64 / 3.0).sqrt();
    let (mut found, mut enhanced) = (Vec::with_capacity(4), Vec::with_capacity(4));
    for [r, s] in CORNERS {
        let at = [r * place, s * place];
        let surface = Surface::at(places, at, Some(middle.axes[0]))?;
        found.push(ShellPoint {
            area: surface.area,
            rows: rows(&surface, &directors, &shear, at),
            law: plate.law(&surface.shape.values, &surface.axes, 4.0 * middle.area),
            axes: surface.axes,
            at,
        });
        enhanced.push(enhanced_rows(&middle, &surface, at));
    }
    enhance(&mut found, &enhanced);
    Ok(found)
}

/// Rows of γ_r at s = −1 and s = 1, of γ_s at r = −1 and r = 1.
struct Shear {
    rows: [[f64; WIDTH]; 4],
}

impl Shear {
    fn new(places: &Places, directors: &[Vector; NODES]) -> Result<Self, f64> {
        let mut rows = [[0.0; WIDTH]; 4];
        let at = [[0.0, -1.0], [0.0, 1.0], [-1.0, 0.0], [1.0, 0.0]];
        for (index, (row, at)) in rows.iter_mut().zip(at).enumerate() {
            let surface = Surface::at(places, at, None)?;
            let along = index / 2;
            let tangent = surface.tangent[along];
            let (_, director) = surface.director(directors);
            for (node, own) in directors.iter().enumerate() {
                let slope = surface.slopes(node)[along];
                put(row, 6 * node, slope, director);
                let value = surface.shape.values[node];
                put(row, 6 * node + 3, value, cross(*own, tangent));
            }
        }
        Ok(Shear { rows })
    }
}

/// The strains at a point without the enhanced ones.
fn rows(surface: &Surface, directors: &[Vector; NODES], shear: &Shear, at: [f64; 2]) -> Rows {
    let mut covariant = [[0.0; WIDTH]; 6];
    let [r, s] = surface.tangent;
    let ([director_r, director_s], _) = surface.director(directors);
    let mut rows = [[0.0; WIDTH]; STRAINS];
    for (node, own) in directors.iter().enumerate() {
        let [slope_r, slope_s] = surface.slopes(node);
        let (moved, turned) = (6 * node, 6 * node + 3);
        let (turned_r, turned_s) = (cross(*own, r), cross(*own, s));
        put(&mut covariant[0], moved, slope_r, r);
        put(&mut covariant[1], moved, slope_s, s);
        put(&mut covariant[2], moved, slope_s, r);
        put(&mut covariant[2], moved, slope_r, s);
        put(&mut covariant[3], turned, slope_r, turned_r);
        put(&mut covariant[4], turned, slope_s, turned_s);
        put(&mut covariant[5], turned, slope_s, turned_r);
        put(&mut covariant[5], turned, slope_r, turned_s);
        put(&mut covariant[3], moved, slope_r, director_r);
        put(&mut covariant[4], moved, slope_s, director_s);
        put(&mut covariant[5], moved, slope_s, director_r);
        put(&mut covariant[5], moved, slope_r, director_s);
        // drilling: θ·n − ½ (e₂·u,₁ − e₁·u,₂)
        let [first, second, normal] = surface.axes;
        let slope = |i: usize| slope_r * surface.dual[0][i] + slope_s * surface.dual[1][i];
        put(&mut rows[8], turned, surface.shape.values[node], normal);
        put(&mut rows[8], moved, -0.5 * slope(0), second);
        put(&mut rows[8], moved, 0.5 * slope(1), first);
    }
    for (i, line) in surface.transformation().iter().enumerate() {
        for (j, factor) in line.iter().enumerate() {
            for k in 0..WIDTH {
                rows[i][k] += factor * covariant[j][k];
                rows[3 + i][k] += factor * covariant[3 + j][k];
            }
        }
    }
    let [below, above, left, right] = &shear.rows;
    for k in 0..WIDTH {
        let along_r = 0.5 * ((1.0 - at[1]) * below[k] + (1.0 + at[1]) * above[k]);
        let along_s = 0.5 * ((1.0 - at[0]) * left[k] + (1.0 + at[0]) * right[k]);
        for i in 0..2 {
            rows[6 + i][k] = along_r * surface.dual[0][i] + along_s * surface.dual[1][i];
        }
    }
    rows
}

/// `(j₀/j) T₀ E` with r in rr, s in ss, r and s in 2 rs. These strains are those of displacements 1 − r² and 1
/// − s², whose rotation ½ n·curl u is r/(2 j) and −s/(2 j) for the last two.
fn enhanced_rows(middle: &Surface, surface: &Surface, [r, s]: [f64; 2]) -> Enhanced {
    let factor = middle.area / surface.area;
    let modes = [(0, r), (1, s), (2, r), (2, s)];
    let [xx, yy, xy] = middle
        .transformation()
        .map(|line| modes.map(|(component, value)| factor * line[component] * value));
    let turn = 0.5 / surface.area;
    [xx, yy, xy, [0.0, 0.0, -turn * r, turn * s]]
}

/// Adds the enhanced strains that minimise the energy. A membrane without stiffness has none.
fn enhance(points: &mut [ShellPoint], enhanced: &[Enhanced]) {
    let mut own = [[0.0; ENHANCED]; ENHANCED];
    let mut coupling = [[0.0; WIDTH]; ENHANCED];
    for (point, modes) in points.iter().zip(enhanced) {
        let Law(law) = &point.law;
        // forces of the enhanced strains
        let forces = |mode: usize, strain: usize| -> f64 {
            let forces = CHANGED.iter().zip(modes);
            forces
                .map(|(i, own)| own[mode] * law[*i][strain])
                .sum::<f64>()
                * point.area
        };
        for a in 0..ENHANCED {
            for (b, sum) in own[a].iter_mut().enumerate() {
                let terms = CHANGED.iter().zip(modes);
                *sum += terms.map(|(i, own)| forces(a, *i) * own[b]).sum::<f64>();
            }
            for strain in [0, 1, 2, 3, 4, 5, 8] {
                let force = forces(a, strain);
                if force != 0.0 {
                    for (sum, x) in coupling[a].iter_mut().zip(&point.rows[strain]) {
                        *sum += force * x;
                    }
                }
            }
        }
    }
    if !solve(&mut own, &mut coupling) {
        return;
    }
    for (point, modes) in points.iter_mut().zip(enhanced) {
        for (changed, modes) in CHANGED.iter().zip(modes) {
            let row = &mut point.rows[*changed];
            for (mode, amplitudes) in modes.iter().zip(&coupling) {
                for (x, amplitude) in row.iter_mut().zip(amplitudes) {
                    *x -= mode * amplitude;
                }
            }
        }
    }
}

/// Solves for all columns in place by elimination; `false` for a matrix that is not positive definite.
fn solve(matrix: &mut [[f64; ENHANCED]; ENHANCED], columns: &mut [[f64; WIDTH]; ENHANCED]) -> bool {
    let most = (0..ENHANCED).fold(0.0, |most: f64, i| most.max(matrix[i][i]));
    for pivot in 0..ENHANCED {
        let value = matrix[pivot][pivot];
        if value.is_nan() || value <= 1e-12 * most {
            return false;
        }
        let (row, column) = (matrix[pivot], columns[pivot]);
        for other in (0..ENHANCED).filter(|other| *other != pivot) {
            let factor = matrix[other][pivot] / value;
            for (x, y) in matrix[other].iter_mut().zip(row) {
                *x -= factor * y;
            }
            for (x, y) in columns[other].iter_mut().zip(column) {
                *x -= factor * y;
            }
        }
    }
    for (i, line) in columns.iter_mut().enumerate() {
        let value = matrix[i][i];
        line.iter_mut().for_each(|x| *x /= value);
    }
    true
}
