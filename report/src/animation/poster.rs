//! A still picture of an animation, for paper and for readers without scripts.

use super::image::{Canvas, Vertex};
use super::quaternion::{cross, direction, dot, minus, rotated};
use super::solid::Solid;
use super::{Animation, NodeField, Pose, Surface, kind_of};

/// Pixels: 16 to 9, a choice.
const WIDTH: usize = 1200;
const HEIGHT: usize = 675;
/// The picture's share of the sheet. A choice.
const FILL: f64 = 0.94;
/// Towards the viewer, y up; the viewer of a page starts here, too. A choice: from the side and above, so
/// that all three axes are seen.
pub(super) const VIEW: [f64; 3] = [0.75, 0.45, 1.0];
/// Shades of the kinds of bodies, in the order of the glTF file's colours.
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

/// Colours of a field from its low to its high end, those of the page's viewer: cividis (Nuñez, Anderton and
/// Renslow 2018).
pub const LEVELS: [[f64; 3]; 5] = [
    [0.0, 34.0, 78.0],
    [65.0, 77.0, 107.0],
    [124.0, 123.0, 120.0],
    [188.0, 173.0, 108.0],
    [254.0, 232.0, 56.0],
];

/// The values of a field's colours, in its unit.
#[derive(Clone, Debug, PartialEq)]
pub struct Range {
    /// Name of the field.
    pub name: String,
    /// Unit of the values.
    pub unit: String,
    /// The value at which the colours begin.
    pub low: f64,
    /// The value at which the colours end.
    pub high: f64,
    /// The largest value. It is above `high` if a few sharp edges have so large values that they would take most of the
    /// colours.
    pub largest: f64,
}

impl Range {
    /// From 0 to 1.
    pub fn share(&self, value: f64) -> f64 {
        let width = self.high - self.low;
        if width > 0.0 {
            ((value - self.low) / width).clamp(0.0, 1.0)
        } else {
            0.0
        }
    }
}

/// The colour of a share of the range; a share that is no number has the lowest.
pub fn level(share: f64) -> [f64; 3] {
    let last = LEVELS.len() - 1;
    let place = share.clamp(0.0, 1.0) * last as f64;
    let below = (place as usize).min(last - 1);
    let part = place - below as f64;
    let (from, to) = (LEVELS[below], LEVELS[below + 1]);
    let part = if part.is_finite() { part } else { 0.0 };
    [0, 1, 2].map(|i| from[i] + part * (to[i] - from[i]))
}

struct Facet {
    corners: [[f64; 3]; 3],
    shade: [u8; 3],
}

impl Animation {
    /// The range of the first field of the flexible bodies, whose colours end where a hundredth of the nodes
    /// has more than twice.
    pub(super) fn first_field(&self) -> Option<Range> {
        let first = self.flexible.iter().flat_map(|b| &b.fields).next()?;
        let mut values: Vec<f64> = self
            .flexible
            .iter()
            .filter_map(|body| body.fields.iter().find(|f| f.name == first.name))
            .flat_map(|field| field.values.iter().copied())
            .filter(|value| value.is_finite())
            .collect();
        values.sort_by(f64::total_cmp);
        let (low, largest) = (*values.first()?, *values.last()?);
        // a choice: the last hundredth of the nodes may be a singular corner, and takes the whole scale only
        // if it is less than twice the rest
        let most = *values.get((0.99 * (values.len() - 1) as f64) as usize)?;
        Some(Range {
            name: first.name.clone(),
            unit: first.unit.clone(),
            low,
            high: if most > 0.0 && most < 0.5 * largest {
                most
            } else {
                largest
            },
            largest,
        })
    }

    /// All bodies at the first time, deformed at the scale, as a PNG with a transparent background. Each kind
    /// has its colour; bodies with the field have the colours of the field, films those of their pressure.
    pub(super) fn to_poster(&self, colored: Option<&Range>) -> Vec<u8> {
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
        let kinds = self.kinds();
        let shade_of = |name: &str| {
            let kind = kinds.iter().position(|kind| *kind == kind_of(name));
            SHADES[kind.unwrap_or(0) % SHADES.len()]
        };
        let mut add = |surface: &Surface,
                       moved: &[[f64; 3]],
                       pose: &Pose,
                       shade: [f64; 3],
                       field: Option<(&NodeField, &Range)>| {
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
                let shade = match field {
                    Some((field, range)) => {
                        let value = |node: &u32| field.values.get(*node as usize).copied();
                        let sum: f64 = triangle.iter().filter_map(value).sum();
                        level(range.share(sum / 3.0))
                    }
                    None => shade,
                };
                facets.push(Facet {
                    corners: [a, b, c],
                    // a choice: a face along the light keeps 45 % of its shade, so that it does not turn
                    // black
                    shade: shade.map(|s| (s * (0.45 + 0.55 * light.abs())) as u8),
                });
            }
        };
        for body in &self.flexible {
            let moved: Vec<[f64; 3]> = body
                .surface
                .nodes
                .iter()
                .zip(body.displacements(0))
                .map(|(node, d)| [0, 1, 2].map(|i| node[i] + self.scale * d[i]))
                .collect();
            let pose = body.poses.first().copied().unwrap_or(Pose::HOME);
            let field = colored.and_then(|range| {
                let field = body.fields.iter().find(|f| f.name == range.name)?;
                Some((field, range))
            });
            add(&body.surface, &moved, &pose, shade_of(&body.name), field);
        }
        let [low, high] = self.films.range();
        let range = Range {
            name: String::new(),
            unit: String::new(),
            low,
            high,
            largest: high,
        };
        for film in &self.films.surfaces {
            let field = film.field(0, &self.films.unit);
            let hill = self.films.hill(film, &field.values);
            let moved: Vec<[f64; 3]> = (film.surface.nodes.iter().zip(hill))
                .map(|(node, d)| [0, 1, 2].map(|i| node[i] + d[i]))
                .collect();
            let pose = film.poses.first().copied().unwrap_or(Pose::HOME);
            add(
                &film.surface,
                &moved,
                &pose,
                LEVELS[0],
                Some((&field, &range)),
            );
        }
        for body in &self.rigid {
            let solid = Solid::of(&body.parts);
            let pose = body.poses.first().copied().unwrap_or(Pose::HOME);
            let shade = shade_of(&body.name);
            add(&solid.surface, &solid.surface.nodes, &pose, shade, None);
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
    /// A frame as large as the sheet allows.
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
            // 1e-9 (m) prevents a division by the zero size of a flat view
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
