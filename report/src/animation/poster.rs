//! A still picture of an animation: on paper, and where no script runs.

use super::quaternion::{cross, direction, dot, minus, rotated};
use super::solid::Solid;
use super::{Animation, Pose, Surface};
use crate::figure::svg::coordinate;
use std::fmt::Write;

const WIDTH: f64 = 960.0;
const HEIGHT: f64 = 540.0;
/// The picture's share of the sheet.
const FILL: f64 = 0.92;
/// More triangles than this are thinned out to the largest.
const MANY: usize = 6000;
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

struct Facet {
    depth: f64,
    points: [(f64, f64); 3],
    shade: [f64; 3],
    area: f64,
}

impl Animation {
    /// All bodies at the first time, deformed at the scale, as SVG; painted from back to front.
    pub fn to_poster(&self) -> String {
        let towards = direction(VIEW);
        let right = direction(cross([0.0, 1.0, 0.0], towards));
        let up = cross(towards, right);
        let turn = self.up.rotation();
        let (center, _) = self.bounds();
        let center = rotated(turn, center);
        let view = |pose: &Pose, point: [f64; 3]| -> ([f64; 3], (f64, f64)) {
            let place = minus(rotated(turn, pose.place(point)), center);
            let flat = (dot(place, right), -dot(place, up));
            (place, flat)
        };
        let mut facets: Vec<Facet> = Vec::new();
        let mut lines: Vec<[(f64, f64); 2]> = Vec::new();
        let mut add = |surface: &Surface, moved: &[[f64; 3]], pose: &Pose, shade: [f64; 3]| {
            for triangle in &surface.triangles {
                let corner = |index: usize| {
                    let node = triangle.get(index).map_or(0, |n| *n as usize);
                    moved.get(node).map(|point| view(pose, *point))
                };
                let (Some(a), Some(b), Some(c)) = (corner(0), corner(1), corner(2)) else {
                    continue;
                };
                let normal = cross(minus(b.0, a.0), minus(c.0, a.0));
                let light = dot(direction(normal), towards).abs();
                let area = dot(normal, normal).sqrt();
                facets.push(Facet {
                    depth: dot(a.0, towards) + dot(b.0, towards) + dot(c.0, towards),
                    points: [a.1, b.1, c.1],
                    shade: shade.map(|s| s * (0.45 + 0.55 * light)),
                    area,
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
                    lines.push([view(&pose, *from).1, view(&pose, *to).1]);
                }
            }
        }
        if facets.len() > MANY {
            facets.sort_by(|a, b| b.area.total_cmp(&a.area));
            facets.truncate(MANY);
        }
        facets.sort_by(|a, b| a.depth.total_cmp(&b.depth));
        let all = facets
            .iter()
            .flat_map(|f| f.points)
            .chain(lines.iter().copied().flatten());
        let frame = Frame::around(all);
        drawn(&facets, &lines, &frame)
    }
}

/// From the plane of the picture (m) to pixels.
struct Frame {
    middle: (f64, f64),
    scale: f64,
}

impl Frame {
    /// As large as the sheet allows.
    fn around(points: impl Iterator<Item = (f64, f64)>) -> Frame {
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for (x, y) in points {
            low = [low[0].min(x), low[1].min(y)];
            high = [high[0].max(x), high[1].max(y)];
        }
        let size = [high[0] - low[0], high[1] - low[1]];
        if !size.iter().all(|s| s.is_finite()) {
            return Frame {
                middle: (0.0, 0.0),
                scale: 1.0,
            };
        }
        Frame {
            middle: ((low[0] + high[0]) / 2.0, (low[1] + high[1]) / 2.0),
            scale: FILL * (WIDTH / size[0].max(1e-9)).min(HEIGHT / size[1].max(1e-9)),
        }
    }
}

fn drawn(facets: &[Facet], lines: &[[(f64, f64); 2]], frame: &Frame) -> String {
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" aria-hidden=\"true\">\n"
    );
    let at = |(x, y): (f64, f64)| {
        format!(
            "{} {}",
            coordinate(WIDTH / 2.0 + frame.scale * (x - frame.middle.0)),
            coordinate(HEIGHT / 2.0 + frame.scale * (y - frame.middle.1))
        )
    };
    for facet in facets {
        let [r, g, b] = facet.shade.map(|s| s.clamp(0.0, 255.0) as u8);
        let [p, q, s] = facet.points.map(at);
        let color = format!("#{r:02x}{g:02x}{b:02x}");
        // the stroke closes the seams between neighbours; writing to a String cannot fail
        let _ = writeln!(
            text,
            "<path d=\"M{p}L{q}L{s}z\" fill=\"{color}\" stroke=\"{color}\" stroke-width=\"0.5\"/>"
        );
    }
    for [from, to] in lines {
        let _ = writeln!(
            text,
            "<path d=\"M{}L{}\" stroke=\"#555555\" stroke-width=\"2\"/>",
            at(*from),
            at(*to)
        );
    }
    text.push_str("</svg>\n");
    text
}
