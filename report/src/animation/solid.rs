//! Triangles and lines of a rigid body's parts.

use super::quaternion::{cross, direction, minus};
use super::{Part, Surface};

/// Sides of a cylinder. A choice: it looks round.
pub const SIDES: u32 = 24;

/// All visible triangles and lines of a rigid body.
#[derive(Debug, Default)]
pub struct Solid {
    /// All triangles.
    pub surface: Surface,
    /// Ends of the pieces of lines.
    pub segments: Vec<[f64; 3]>,
}

impl Solid {
    /// The triangles and lines of parts.
    pub fn of(parts: &[Part]) -> Solid {
        let mut solid = Solid::default();
        for part in parts {
            match part {
                Part::Box { center, size } => solid.push_box(*center, *size),
                Part::Cylinder { from, to, radius } => solid.push_cylinder(*from, *to, *radius),
                Part::Line { points } => {
                    for pair in points.windows(2) {
                        solid.segments.extend(pair);
                    }
                }
                Part::Mesh(surface) => solid.push(&surface.nodes, &surface.triangles),
            }
        }
        solid
    }

    fn push(&mut self, nodes: &[[f64; 3]], triangles: &[[u32; 3]]) {
        let first = self.surface.nodes.len() as u32;
        self.surface.nodes.extend(nodes);
        self.surface
            .triangles
            .extend(triangles.iter().map(|t| t.map(|node| first + node)));
    }

    fn push_box(&mut self, center: [f64; 3], size: [f64; 3]) {
        let nodes: Vec<[f64; 3]> = (0..8)
            .map(|corner| {
                [0, 1, 2].map(|axis| {
                    let side = if corner >> axis & 1 == 1 { 0.5 } else { -0.5 };
                    center[axis] + side * size[axis]
                })
            })
            .collect();
        const QUADS: [[u32; 4]; 6] = [
            [0, 2, 3, 1],
            [4, 5, 7, 6],
            [0, 1, 5, 4],
            [2, 6, 7, 3],
            [0, 4, 6, 2],
            [1, 3, 7, 5],
        ];
        let triangles: Vec<[u32; 3]> = QUADS
            .iter()
            .flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]])
            .collect();
        self.push(&nodes, &triangles);
    }

    fn push_cylinder(&mut self, from: [f64; 3], to: [f64; 3], radius: f64) {
        let axis = direction(minus(to, from));
        // the coordinate axis least along the cylinder
        let mut other = [1.0, 0.0, 0.0];
        // above 1/√3, and another coordinate axis lies farther from the cylinder
        if axis[0].abs() > 0.6 {
            other = [0.0, 1.0, 0.0];
        }
        let first = direction(cross(axis, other));
        let second = cross(axis, first);
        let mut nodes = vec![from, to];
        for side in 0..SIDES {
            let angle = std::f64::consts::TAU * f64::from(side) / f64::from(SIDES);
            let (sine, cosine) = libm::sincos(angle);
            for end in [from, to] {
                nodes.push(
                    [0, 1, 2].map(|i| end[i] + radius * (cosine * first[i] + sine * second[i])),
                );
            }
        }
        let mut triangles = Vec::new();
        for side in 0..SIDES {
            let here = 2 + 2 * side;
            let next = 2 + 2 * ((side + 1) % SIDES);
            triangles.extend([
                [0, next, here],
                [1, here + 1, next + 1],
                [here, next, next + 1],
                [here, next + 1, here + 1],
            ]);
        }
        self.push(&nodes, &triangles);
    }
}
