//! A still picture of an animation: on paper, and where no script runs.

use super::image::{Canvas, Vertex};
use super::quaternion::{cross, direction, dot, minus, rotated};
use super::solid::Solid;
use super::{Animation, Pose, Surface};

/// Pixels.
const WIDTH: usize = 1200;
const HEIGHT: usize = 675;
/// The picture's share of the sheet.
const FILL: f64 = 0.94;
/// Towards the viewer, y up; the viewer of a page starts here, too.
pub(super) const VIEW: [f64; 3] = [0.75, 0.45, 1.0];
/// Shades of the bodies, in the order of the glTF file's colours.
const SHADES: [[f64; 3]; 6] = [
    [142.0, 175.0, 205.0],
    [205.0, 205.0, 205.0],
    [228.0, 184.0, 112.0],
    [110.0, 178.0, 155.0],
    [205.0, 155.0, 185.0],
    [150.0, 150.0, 150.0],
];
/// Lines of rigid bodies.
const LINES: [u8; 3] = [110, 110, 110];

struct Facet {
    corners: [[f64; 3]; 3],
    shade: [u8; 3],
}

impl Animation {
    /// All bodies at the first time, deformed at the scale, as a PNG with transparent ground.
    pub fn to_poster(&self) -> Vec<u8> {
        let towards = direction(VIEW);
        let right = direction(cross([0.0, 1.0, 0.0], towards));
        let up = cross(towards, right);
        let turn = self.up.rotation();
        // right, down, towards the viewer
        let view = |pose: &Pose, point: [f64; 3]| -> [f64; 3] {
            let place = rotated(turn, pose.place(point));
            [dot(place, right), -dot(place, up), dot(place, towards)]
        };
        let mut facets: Vec<Facet> = Vec::new();
        let mut lines: Vec<[[f64; 3]; 2]> = Vec::new();
        let mut add = |surface: &Surface, moved: &[[f64; 3]], pose: &Pose, shade: [f64; 3]| {
            let seen: Vec<[f64; 3]> = moved.iter().map(|point| view(pose, *point)).collect();
            for triangle in &surface.triangles {
                let corner = |index: usize| {
                    let node = triangle.get(index).map_or(0, |n| *n as usize);
                    seen.get(node).copied()
                };
                let (Some(a), Some(b), Some(c)) = (corner(0), corner(1), corner(2)) else {
                    continue;
                };
                let [_, _, light] = direction(cross(minus(b, a), minus(c, a)));
                facets.push(Facet {
                    corners: [a, b, c],
                    shade: shade.map(|s| (s * (0.45 + 0.55 * light.abs())) as u8),
                });
            }
        };
        let bodies = self.flexible.len();
        for (index, body) in self.flexible.iter().enumerate() {
            let moved: Vec<[f64; 3]> = body
                .surface
                .nodes
                .iter()
                .zip(body.displacements(0))
                .map(|(node, d)| [0, 1, 2].map(|i| node[i] + self.scale * d[i]))
                .collect();
            let pose = body.poses.first().copied().unwrap_or(Pose::HOME);
            add(&body.surface, &moved, &pose, SHADES[index % SHADES.len()]);
        }
        for (index, body) in self.rigid.iter().enumerate() {
            let solid = Solid::of(&body.parts);
            let pose = body.poses.first().copied().unwrap_or(Pose::HOME);
            let shade = SHADES[(bodies + index) % SHADES.len()];
            add(&solid.surface, &solid.surface.nodes, &pose, shade);
            for pair in solid.segments.chunks_exact(2) {
                if let [from, to] = pair {
                    lines.push([view(&pose, *from), view(&pose, *to)]);
                }
            }
        }
        let frame = Frame::around(
            facets
                .iter()
                .flat_map(|f| f.corners)
                .chain(lines.iter().copied().flatten()),
        );
        let mut canvas = Canvas::new(WIDTH, HEIGHT);
        for facet in &facets {
            canvas.triangle(facet.corners.map(|c| frame.vertex(c)), facet.shade);
        }
        // an edge of a solid lies in its faces
        let lift = 1e-3 * WIDTH as f64 / frame.scale;
        for [from, to] in lines {
            canvas.line(frame.vertex(from), frame.vertex(to), lift, LINES);
        }
        canvas.to_png()
    }
}

/// From the plane of the picture (m) to pixels.
struct Frame {
    middle: [f64; 2],
    scale: f64,
}

impl Frame {
    /// As large as the sheet allows.
    fn around(points: impl Iterator<Item = [f64; 3]>) -> Frame {
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for [x, y, _] in points {
            low = [low[0].min(x), low[1].min(y)];
            high = [high[0].max(x), high[1].max(y)];
        }
        let size = [high[0] - low[0], high[1] - low[1]];
        if !size.iter().all(|s| s.is_finite()) {
            return Frame {
                middle: [0.0; 2],
                scale: 1.0,
            };
        }
        let (width, height) = (WIDTH as f64, HEIGHT as f64);
        Frame {
            middle: [(low[0] + high[0]) / 2.0, (low[1] + high[1]) / 2.0],
            scale: FILL * (width / size[0].max(1e-9)).min(height / size[1].max(1e-9)),
        }
    }

    fn vertex(&self, [x, y, near]: [f64; 3]) -> Vertex {
        Vertex {
            x: WIDTH as f64 / 2.0 + self.scale * (x - self.middle[0]),
            y: HEIGHT as f64 / 2.0 + self.scale * (y - self.middle[1]),
            near,
        }
    }
}
