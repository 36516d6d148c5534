//! The surface of a shell at a place of its reference domain, and the strains of its nodes' motion there.
//!
//! With tangents g_r = ∂x/∂r, g_s, the director `d = Σ N_a n_a` of the nodes' normals and its motion `β = Σ
//! N_a θ_a × n_a` the covariant strains are
//!
//! ```text
//! e_αβ = ½ (g_α·u,β + g_β·u,α)                 κ_αβ = ½ (g_α·β,β + g_β·β,α + d,α·u,β + d,β·u,α)
//! γ_α  = g_α·β + d·u,α
//! ```
//!
//! They vanish in a rigid motion, whatever surface the nodes lie in.

use super::{NODES, Places, quadrilateral, triangle};
use crate::element::{ElementKind, Shape};
use crate::fe::solid::tangents;
use crate::fe::vector::{Vector, cross, dot, norm, scale, subtract};

/// Number of covariant strains: rr, ss, 2 rs of the middle surface, then of the curvature, then γ_r and γ_s.
pub(super) const COVARIANT: usize = 8;

/// Rows of the covariant strains over `W` columns, of which the first are the freedoms of the nodes.
pub(super) type Covariant<const W: usize> = [[f64; W]; COVARIANT];

/// Normals of the nodes.
pub(super) type Directors = [Vector; NODES];

/// Reference coordinates of the nodes; zeros after the last one.
pub(super) fn reference(kind: ElementKind) -> [[f64; 2]; NODES] {
    let corners: &[[f64; 2]] = match kind.corner_count() {
        3 => &triangle::CORNERS,
        _ => &quadrilateral::CORNERS,
    };
    let mut places = [[0.0; 2]; NODES];
    places[..corners.len()].copy_from_slice(corners);
    let middles = places[corners.len()..].iter_mut();
    for (place, [a, b]) in middles.zip(kind.midside_edges()) {
        *place = [0, 1].map(|i: usize| 0.5 * (corners[*a][i] + corners[*b][i]));
    }
    places
}

/// The nodes of a shell in space.
#[derive(Clone, Debug)]
pub(super) struct Geometry {
    kind: ElementKind,
    /// Places in the middle surface (m).
    pub places: Places,
}

impl Geometry {
    pub fn new(kind: ElementKind, places: &Places) -> Self {
        Geometry {
            kind,
            places: *places,
        }
    }

    /// Number of nodes.
    pub fn count(&self) -> usize {
        self.kind.node_count().min(NODES)
    }

    /// The unit normals at the nodes.
    ///
    /// # Errors
    /// The area for a unit of the reference domain (m²) where the element is folded or flat.
    pub fn directors(&self) -> Result<Directors, f64> {
        let mut directors = [[0.0; 3]; NODES];
        let own = directors.iter_mut().zip(reference(self.kind));
        for (director, at) in own.take(self.count()) {
            *director = self.at(at, None)?.axes[2];
        }
        // crossed sides turn the normal round
        for (i, first) in directors.iter().enumerate().take(self.count()) {
            for second in &directors[..i] {
                // normals at two nodes that are nearly perpendicular, beyond 87°: a choice
                if dot(*first, *second) <= 0.05 {
                    return Err(-self.middle()?.area);
                }
            }
        }
        Ok(directors)
    }

    /// The surface in the middle.
    ///
    /// # Errors
    /// As [`Geometry::directors`].
    pub fn middle(&self) -> Result<Surface, f64> {
        let [r, s, _] = self.kind.description().centre;
        self.at([r, s], None)
    }

    /// The surface at a place. The first unit tangent is the part of `first` in the surface, or of ∂x/∂r.
    ///
    /// # Errors
    /// As [`Geometry::directors`].
    pub fn at(&self, at: [f64; 2], first: Option<Vector>) -> Result<Surface, f64> {
        let shape = Shape::at(self.kind, [at[0], at[1], 0.0]);
        let count = self.count();
        let [r, s, _] = tangents(&shape, &self.places, count);
        let normal = cross(r, s);
        let area = norm(normal);
        // sides that are parallel but for the digits of a file have no normal
        if area.is_nan() || area <= 1e-9 * norm(r) * norm(s) {
            return Err(area);
        }
        let normal = scale(1.0 / area, normal);
        let first = first.unwrap_or(r);
        let along = subtract(first, scale(dot(first, normal), normal));
        let length = norm(along);
        // the same for a first axis along the normal
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
            count,
            tangent: [r, s],
            axes: [first, second, normal],
            dual: [
                [d / determinant, -c / determinant],
                [-b / determinant, a / determinant],
            ],
            area,
        })
    }
}

/// The surface at a place of the reference domain.
pub(super) struct Surface {
    pub shape: Shape,
    /// Number of nodes.
    count: usize,
    /// ∂x/∂r, ∂x/∂s (m).
    pub tangent: [Vector; 2],
    /// Unit tangents and normal.
    pub axes: [Vector; 3],
    /// Components along the unit tangents of the contravariant basis (1/m).
    pub dual: [[f64; 2]; 2],
    /// Area for a unit of the reference domain (m²).
    pub area: f64,
}

impl Surface {
    /// Slopes of a node's function in r and s.
    pub fn slopes(&self, node: usize) -> [f64; 2] {
        let [r, s, _] = self.shape.slopes[node];
        [r, s]
    }

    /// The director's slopes in r and s, and the director.
    pub fn director(&self, directors: &Directors) -> ([Vector; 2], Vector) {
        let mut slopes = [[0.0; 3]; 2];
        let mut director = [0.0; 3];
        for (node, own) in directors.iter().enumerate().take(self.count) {
            let [r, s] = self.slopes(node);
            for axis in 0..3 {
                slopes[0][axis] += r * own[axis];
                slopes[1][axis] += s * own[axis];
                director[axis] += self.shape.values[node] * own[axis];
            }
        }
        (slopes, director)
    }

    /// Rows of the covariant strains over the freedoms of the nodes.
    pub fn covariant<const W: usize>(&self, directors: &Directors) -> Covariant<W> {
        let mut rows = [[0.0; W]; COVARIANT];
        let director = self.director(directors);
        for (node, own) in directors.iter().enumerate().take(self.count) {
            let motion = Motion {
                value: self.shape.values[node],
                slopes: self.slopes(node),
            };
            self.stretch(&mut rows, 6 * node, motion, &director);
            self.turn(&mut rows, 6 * node + 3, motion, *own);
        }
        rows
    }

    /// Adds the strains of a displacement with these values, in the three columns from `first` on.
    pub fn stretch<const W: usize>(
        &self,
        rows: &mut Covariant<W>,
        first: usize,
        Motion { slopes: [r, s], .. }: Motion,
        ([director_r, director_s], director): &([Vector; 2], Vector),
    ) {
        let [along_r, along_s] = self.tangent;
        for (row, factor, vector) in [
            (0, r, along_r),
            (1, s, along_s),
            (2, s, along_r),
            (2, r, along_s),
            (3, r, *director_r),
            (4, s, *director_s),
            (5, s, *director_r),
            (5, r, *director_s),
            (6, r, *director),
            (7, s, *director),
        ] {
            super::put(&mut rows[row], first, factor, vector);
        }
    }

    /// Adds the strains of a rotation of the director `own`, in the three columns from `first` on.
    pub fn turn<const W: usize>(
        &self,
        rows: &mut Covariant<W>,
        first: usize,
        Motion {
            value,
            slopes: [r, s],
        }: Motion,
        own: Vector,
    ) {
        // g·(θ × n) = θ·(n × g)
        let [turned_r, turned_s] = self.tangent.map(|tangent| cross(own, tangent));
        for (row, factor, vector) in [
            (3, r, turned_r),
            (4, s, turned_s),
            (5, s, turned_r),
            (5, r, turned_s),
            (6, value, turned_r),
            (7, value, turned_s),
        ] {
            super::put(&mut rows[row], first, factor, vector);
        }
    }

    /// The row of `θ·n − ½ (e₂·u,₁ − e₁·u,₂)` over the freedoms of the nodes.
    pub fn drilling<const W: usize>(&self) -> [f64; W] {
        let mut row = [0.0; W];
        for node in 0..self.count {
            let value = self.shape.values[node];
            super::put(&mut row, 6 * node + 3, value, self.axes[2]);
            self.spin(&mut row, 6 * node, self.slopes(node));
        }
        row
    }

    /// Adds `−½ (e₂·u,₁ − e₁·u,₂)` of a displacement with these slopes, in the three columns from `first` on.
    pub fn spin(&self, row: &mut [f64], first: usize, [r, s]: [f64; 2]) {
        let [along, across, _] = self.axes;
        let slope = |i: usize| r * self.dual[0][i] + s * self.dual[1][i];
        super::put(row, first, -0.5 * slope(0), across);
        super::put(row, first, 0.5 * slope(1), along);
    }

    /// Covariant strains along the unit tangents: the first eight of the strains of a shell.
    pub fn along_tangents<const W: usize>(&self, covariant: &Covariant<W>) -> Covariant<W> {
        let mut rows = [[0.0; W]; COVARIANT];
        let mut add = |row: usize, factor: f64, from: usize| {
            for (sum, x) in rows[row].iter_mut().zip(&covariant[from]) {
                *sum += factor * x;
            }
        };
        for (i, line) in self.transformation().iter().enumerate() {
            for (j, factor) in line.iter().enumerate() {
                add(i, *factor, j);
                add(3 + i, *factor, 3 + j);
            }
        }
        for i in 0..2 {
            for (j, dual) in self.dual.iter().enumerate() {
                add(6 + i, dual[i], 6 + j);
            }
        }
        rows
    }

    /// From covariant strains (rr, ss, 2 rs) to those along the unit tangents (11, 22, 2 12).
    pub fn transformation(&self) -> [[f64; 3]; 3] {
        let [[r1, r2], [s1, s2]] = self.dual;
        [
            [r1 * r1, s1 * s1, r1 * s1],
            [r2 * r2, s2 * s2, r2 * s2],
            [2.0 * r1 * r2, 2.0 * s1 * s2, r1 * s2 + s1 * r2],
        ]
    }
}

/// A shape function at a place.
#[derive(Clone, Copy)]
pub(super) struct Motion {
    pub value: f64,
    /// In r and s.
    pub slopes: [f64; 2],
}
