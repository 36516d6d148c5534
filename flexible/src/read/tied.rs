//! Tied and glued surfaces: the nodes of one surface follow the faces of another.
//!
//! A node follows the nearest place of a face: `u = Σ N_a u_a + ω × g`, with the face's shape functions there, the
//! gap g from that place to the node, and the rotation ω of the face,
//!
//! ```text
//! c = Σ_α a^α × u,α     ω = c − ½ n (n·c)
//! ```
//!
//! with the dual tangents a^α, the slopes u,α of the face's motion along its coordinates, and the unit normal
//! n. So rigid motions cost nothing, and no other motion of a plane face is lost. Where a face of shells
//! turns the gap by its rotations, `ω = Σ N_a θ_a`. Where the deck adjusts the nodes, they move onto the
//! faces first. Lengths are in units of the file.

use std::collections::HashMap;

use crate::element::{ElementKind, Shape};
use crate::fe::vector::{Vector, add, cross, dot, norm, scale, subtract};
use crate::mesh::{Frame, Node, Tie, along_axes};

/// Share of the mean size of the faces that a node may be beside or above them, if the deck states none. A
/// choice: meshes of two sides of a curved surface differ by less, and a node farther away is on another
/// surface.
const BESIDE: f64 = 0.05;

/// A face: its corners, then its mid-side nodes.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Face {
    pub kind: ElementKind,
    pub nodes: Vec<u32>,
}

impl Face {
    /// The face with these corners, each with the node between it and the next one.
    pub fn new(ring: &[(u32, Option<u32>)]) -> Option<Self> {
        let corners = ring.iter().map(|(corner, _)| *corner);
        let middles: Option<Vec<u32>> = ring.iter().map(|(_, middle)| *middle).collect();
        let kind = ElementKind::of_face(ring.len(), middles.is_some())?;
        Some(Face {
            kind,
            nodes: corners.chain(middles.into_iter().flatten()).collect(),
        })
    }

    fn places(&self, nodes: &[Node]) -> Vec<Vector> {
        let own = self.nodes.iter();
        own.map(|node| position(nodes, *node)).collect()
    }
}

fn position(nodes: &[Node], node: u32) -> Vector {
    let node = nodes.get(node as usize);
    node.map_or([0.0; 3], |node| node.position)
}

/// The nearest place of a face.
#[derive(Clone, Copy, Debug)]
struct Place {
    face: usize,
    at: [f64; 2],
    place: Vector,
    distance: f64,
}

/// Nodes tied to a surface.
#[derive(Debug, Default)]
pub(super) struct Tied {
    pub ties: Vec<Tie>,
    /// New places of nodes.
    pub moved: Vec<(u32, Vector)>,
    /// Mean size of the faces.
    pub size: f64,
    /// Largest distance of a tied node from its face.
    pub gap: f64,
    /// Number of nodes that are too far from any face.
    pub far: usize,
}

/// The surfaces of a tie, and the options of its card.
pub(super) struct Request<'a> {
    /// Nodes that follow.
    pub nodes: &'a [u32],
    pub faces: &'a [Face],
    /// Largest distance; without one 5 % of the mean size of the faces.
    pub tolerance: Option<f64>,
    pub adjust: bool,
    /// Nodes whose rotations an element uses; with `None` no rotation follows.
    pub turning: Option<&'a [bool]>,
    /// Nodes whose rotations turn the gap, if all nodes of a face are among them: those of shells. Without them the face
    /// turns it.
    pub arms: Option<&'a [bool]>,
    /// Whether only nodes follow whose gap is along the normal of the face, up to 5 % of the mean size of the faces: a
    /// node beside the surface stays free.
    pub facing: bool,
}

impl Tied {
    /// The nodes that follow.
    pub fn followers(&self) -> impl Iterator<Item = u32> {
        self.ties.iter().filter_map(|tie| match tie {
            Tie::Equation { terms, .. } => terms.first().map(|(node, ..)| *node),
            _ => None,
        })
    }
}

/// Ties nodes to the faces that are near enough. The first tie has the number `first`.
pub(super) fn tied(nodes: &[Node], frames: &[Frame], request: &Request, first: u64) -> Tied {
    let grid = Grid::new(nodes, request.faces);
    let mut out = Tied {
        size: grid.size,
        ..Tied::default()
    };
    // rounding of places on the boundary of the tolerance is no gap
    let tolerance = request.tolerance.unwrap_or(BESIDE * grid.size) + 1e-9 * grid.size;
    for node in request.nodes {
        let found = grid.nearest(position(nodes, *node), tolerance);
        let Some(found) = found.filter(|found| found.distance <= tolerance) else {
            out.far += 1;
            continue;
        };
        let Some(face) = request.faces.get(found.face) else {
            continue;
        };
        if face.nodes.contains(node) {
            continue;
        }
        let shape = Shape::at(face.kind, [found.at[0], found.at[1], 0.0]);
        let mut gap = subtract(position(nodes, *node), found.place);
        if request.facing {
            let [r, s] = tangents(&shape, &face.places(nodes));
            let normal = cross(r, s);
            let along = dot(gap, normal) / dot(normal, normal);
            if norm(subtract(gap, scale(along, normal))) > BESIDE * grid.size {
                out.far += 1;
                continue;
            }
        }
        out.gap = out.gap.max(found.distance);
        if request.adjust && found.distance > 0.0 {
            out.moved.push((*node, found.place));
            gap = [0.0; 3];
        }
        let all = |list: &[bool]| {
            let own = face.nodes.iter();
            own.copied()
                .all(|node| list.get(node as usize) == Some(&true))
        };
        let follower = Follower {
            nodes,
            arms: request.arms.is_some_and(all),
            frames,
            node: *node,
            face,
            gap,
            shape,
        };
        let turns = request.turning.is_some_and(|turning| {
            let turns = |node: &u32| turning.get(*node as usize) == Some(&true);
            turns(node) && face.nodes.iter().all(turns)
        });
        follower.follow(turns, first, &mut out.ties);
    }
    out
}

/// A node at a place of a face.
struct Follower<'a> {
    nodes: &'a [Node],
    frames: &'a [Frame],
    node: u32,
    face: &'a Face,
    gap: Vector,
    /// Whether the rotations of the face's nodes turn the gap.
    arms: bool,
    shape: Shape,
}

impl Follower<'_> {
    fn follow(&self, turns: bool, first: u64, ties: &mut Vec<Tie>) {
        let nodes = self.nodes;
        let places = self.face.places(nodes);
        let [r, s] = tangents(&self.shape, &places);
        let normal = cross(r, s);
        let square = dot(normal, normal);
        // a^r = s × n/|n|², a^s = n × r/|n|²
        let dual = [cross(s, normal), cross(normal, r)].map(|x| scale(1.0 / square, x));
        let unit = scale(1.0 / square.sqrt(), normal);
        let freedoms: u8 = if turns { 6 } else { 3 };
        for freedom in 0..freedoms {
            let axis = [0, 1, 2].map(|i| if i == freedom % 3 { 1.0 } else { 0.0 });
            let axis = match nodes.get(self.node as usize).and_then(|node| node.frame) {
                Some(frame) => self.frames.get(frame as usize).map_or(axis, |frame| {
                    frame.rotation.map(|row| row[usize::from(freedom % 3)])
                }),
                None => axis,
            };
            let mut terms = vec![(self.node, freedom, 1.0)];
            // (ω × g)·d = ω·m
            let whole = cross(self.gap, axis);
            let moment = subtract(whole, scale(0.5 * dot(whole, unit), unit));
            for (local, node) in self.face.nodes.iter().enumerate() {
                let mut vector = scale(self.shape.values[local], axis);
                if freedom < 3 && !self.arms {
                    for (dual, slope) in dual.iter().zip(self.shape.slopes[local]) {
                        vector = add(vector, scale(slope, cross(moment, *dual)));
                    }
                }
                let arm = match freedom < 3 && self.arms {
                    true => scale(self.shape.values[local], whole),
                    false => [0.0; 3],
                };
                for (first, vector) in [(freedom / 3 * 3, vector), (3, arm)] {
                    let own = along_axes(nodes, self.frames, *node, vector);
                    for (k, factor) in (first..).zip(own) {
                        // rounding of cosines
                        if factor.abs() > 1e-12 {
                            terms.push((*node, k, -factor));
                        }
                    }
                }
            }
            ties.push(Tie::Equation {
                id: first + ties.len() as u64,
                terms,
            });
        }
    }
}

/// ∂x/∂r and ∂x/∂s.
fn tangents(shape: &Shape, places: &[Vector]) -> [Vector; 2] {
    [0, 1].map(|axis: usize| {
        let own = places.iter().zip(&shape.slopes);
        own.fold([0.0; 3], |sum, (place, slopes)| {
            add(sum, scale(slopes[axis], *place))
        })
    })
}

fn at(kind: ElementKind, places: &[Vector], [r, s]: [f64; 2]) -> (Vector, [Vector; 2]) {
    let shape = Shape::at(kind, [r, s, 0.0]);
    let own = places.iter().zip(&shape.values);
    let place = own.fold([0.0; 3], |sum, (place, n)| add(sum, scale(*n, *place)));
    (place, tangents(&shape, places))
}

/// Reference coordinates of the corners.
fn corners(kind: ElementKind) -> &'static [[f64; 2]] {
    match kind.corner_count() {
        3 => &[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]],
        _ => &[[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]],
    }
}

/// The nearest place of a face to a point, and its distance: inside, if the nearest one on the whole surface is
/// inside, else on a side. Gauss–Newton steps.
fn nearest(kind: ElementKind, places: &[Vector], point: Vector) -> ([f64; 2], Vector, f64) {
    let corners = corners(kind);
    let mut best = ([0.0; 2], [0.0; 3], f64::INFINITY);
    let mut take = |reference: [f64; 2]| {
        let (place, _) = at(kind, places, reference);
        let distance = norm(subtract(point, place));
        if distance < best.2 {
            best = (reference, place, distance);
        }
    };
    let [r, s, _] = kind.description().centre;
    let mut inside = [r, s];
    for _ in 0..STEPS {
        let (place, [r, s]) = at(kind, places, inside);
        let away = subtract(point, place);
        let (rr, rs, ss) = (dot(r, r), dot(r, s), dot(s, s));
        let (x, y) = (dot(r, away), dot(s, away));
        let determinant = rr * ss - rs * rs;
        let step = [
            (ss * x - rs * y) / determinant,
            (rr * y - rs * x) / determinant,
        ];
        inside = [inside[0] + step[0], inside[1] + step[1]];
        let most = step[0].abs().max(step[1].abs());
        // rounding of coordinates in −1…1; and a place outside by a whole face belongs to another one
        if most.is_nan() || most < 1e-14 || inside.iter().any(|x| x.abs() > 3.0) {
            break;
        }
    }
    let [r, s] = inside;
    let lies = match corners.len() {
        3 => r >= 0.0 && s >= 0.0 && r + s <= 1.0,
        _ => r.abs() <= 1.0 && s.abs() <= 1.0,
    };
    if lies {
        take(inside);
    }
    for (i, first) in corners.iter().enumerate() {
        let second = corners.get(i + 1).or(corners.first()).unwrap_or(first);
        let side = [second[0] - first[0], second[1] - first[1]];
        let on = |x: f64| [first[0] + x * side[0], first[1] + x * side[1]];
        let mut x: f64 = 0.5;
        for _ in 0..STEPS {
            let (place, [r, s]) = at(kind, places, on(x));
            let tangent = add(scale(side[0], r), scale(side[1], s));
            let step = dot(tangent, subtract(point, place)) / dot(tangent, tangent);
            let next = (x + step).clamp(0.0, 1.0);
            // rounding of a coordinate in 0…1
            if next.is_nan() || (next - x).abs() < 1e-14 {
                break;
            }
            x = next;
        }
        take(on(x));
    }
    best
}

/// Most steps to the nearest place. Plane faces need one or two. A choice: curved ones need some more.
const STEPS: usize = 30;

/// The farthest cell from the origin, along each axis. A choice that fits into an integer, in place of an
/// overflow.
const FARTHEST: f64 = 1e9;

/// Most cells of the rings around a node, for each face. Beyond them every face is tried. A choice: a cell is
/// looked up about as fast as a face is compared.
const WALKED: usize = 64;

/// Faces by the cells of a grid that they touch.
struct Grid {
    /// Kind and places of each face.
    faces: Vec<(ElementKind, Vec<Vector>)>,
    cells: HashMap<[i64; 3], Vec<usize>>,
    /// Mean size of the faces.
    size: f64,
    /// Width of a cell.
    width: f64,
    /// First and last cell.
    ends: [[i64; 3]; 2],
}

impl Grid {
    fn new(nodes: &[Node], faces: &[Face]) -> Self {
        let faces: Vec<_> = faces
            .iter()
            .map(|face| (face.kind, face.places(nodes)))
            .collect();
        let extent = |places: &[Vector]| {
            let ends = |pick: fn(f64, f64) -> f64, start: f64| -> Vector {
                [0, 1, 2].map(|axis: usize| places.iter().fold(start, |sum, x| pick(sum, x[axis])))
            };
            (
                ends(f64::min, f64::INFINITY),
                ends(f64::max, f64::NEG_INFINITY),
            )
        };
        let (mut sum, mut most) = (0.0, 0.0f64);
        for (_, places) in &faces {
            let (low, high) = extent(places);
            let size = norm(subtract(high, low)) / 2.0f64.sqrt();
            sum += size;
            most = most.max(size);
        }
        let size = sum / faces.len().max(1) as f64;
        let mut grid = Grid {
            faces: Vec::new(),
            cells: HashMap::new(),
            size,
            // a face touches a limited number of cells
            width: size.max(0.125 * most).max(f64::MIN_POSITIVE),
            ends: [[i64::MAX; 3], [i64::MIN; 3]],
        };
        for (index, (_, places)) in faces.iter().enumerate() {
            let (low, high) = extent(places);
            // a curved face reaches beyond its nodes
            let beyond = 0.25 * norm(subtract(high, low));
            let first = grid.cell(low.map(|x| x - beyond));
            let last = grid.cell(high.map(|x| x + beyond));
            for axis in 0..3 {
                grid.ends[0][axis] = grid.ends[0][axis].min(first[axis]);
                grid.ends[1][axis] = grid.ends[1][axis].max(last[axis]);
            }
            for x in first[0]..=last[0] {
                for y in first[1]..=last[1] {
                    for z in first[2]..=last[2] {
                        grid.cells.entry([x, y, z]).or_default().push(index);
                    }
                }
            }
        }
        grid.faces = faces;
        grid
    }

    fn cell(&self, place: Vector) -> [i64; 3] {
        place.map(|x| libm::floor(x / self.width).clamp(-FARTHEST, FARTHEST) as i64)
    }

    /// The nearest place of all faces within a distance.
    fn nearest(&self, point: Vector, tolerance: f64) -> Option<Place> {
        let centre = self.cell(point);
        // no face is in rings before and after these
        let (mut first, mut last) = (0, 0);
        for (here, (low, high)) in centre
            .into_iter()
            .zip(self.ends[0].into_iter().zip(self.ends[1]))
        {
            first = first
                .max(low.saturating_sub(here))
                .max(here.saturating_sub(high));
            last = last
                .max(here.saturating_sub(low))
                .max(high.saturating_sub(here));
        }
        let mut best: Option<Place> = None;
        let mut seen = Vec::new();
        let mut walked = 0;
        for ring in first..=last {
            let reached = (ring - 1) as f64 * self.width;
            if reached > tolerance || best.is_some_and(|best| best.distance <= reached) {
                break;
            }
            // far from all faces the rings have more cells than there are faces
            walked = self.size(centre, ring).saturating_add(walked);
            if walked > WALKED * self.faces.len().saturating_add(1) {
                for index in 0..self.faces.len() {
                    self.improve(&mut best, index, point);
                }
                break;
            }
            for cell in self.ring(centre, ring) {
                for index in self.cells.get(&cell).into_iter().flatten() {
                    if !seen.contains(index) {
                        seen.push(*index);
                        self.improve(&mut best, *index, point);
                    }
                }
            }
        }
        best
    }

    /// Takes a face if it is nearer.
    fn improve(&self, best: &mut Option<Place>, index: usize, point: Vector) {
        let Some((kind, places)) = self.faces.get(index) else {
            return;
        };
        let (at, place, distance) = nearest(*kind, places, point);
        if best.is_none_or(|best| distance < best.distance) {
            *best = Some(Place {
                face: index,
                at,
                place,
                distance,
            });
        }
    }

    /// The cells of the grid along an axis up to this number of steps from another.
    fn range(&self, centre: [i64; 3], steps: i64, axis: usize) -> std::ops::RangeInclusive<i64> {
        let low = (centre[axis] - steps).max(self.ends[0][axis]);
        low..=(centre[axis] + steps).min(self.ends[1][axis])
    }

    /// The number of cells up to this number of steps from another.
    fn size(&self, centre: [i64; 3], steps: i64) -> usize {
        (0..3).fold(1_usize, |product, axis| {
            let range = self.range(centre, steps, axis);
            let count = (range.end() - range.start()).saturating_add(1).max(0);
            product.saturating_mul(usize::try_from(count).unwrap_or(usize::MAX))
        })
    }

    /// The cells of the grid at this number of steps from another.
    fn ring(&self, centre: [i64; 3], steps: i64) -> Vec<[i64; 3]> {
        let range = |axis| self.range(centre, steps, axis);
        let mut cells = Vec::new();
        for x in range(0) {
            for y in range(1) {
                for z in range(2) {
                    let away = [x - centre[0], y - centre[1], z - centre[2]];
                    if away.iter().any(|x| x.abs() == steps) {
                        cells.push([x, y, z]);
                    }
                }
            }
        }
        cells
    }
}

/// The sentence about a tie, or none if its surfaces meet everywhere. `place` is that of the card, and `reach` names the
/// largest distance.
pub(super) fn doubt(
    place: &str,
    name: &str,
    tied: &Tied,
    count: usize,
    reach: &str,
) -> Option<String> {
    if tied.far > 0 {
        return Some(format!(
            "{place}: {} of {count} nodes of the surface {name} are farther from the other surface than the {reach}, and stay free",
            tied.far
        ));
    }
    // a choice: gaps of less are the digits of the file
    (tied.gap > 1e-6 * tied.size).then(|| {
        format!(
            "{place}: the tie of the surface {name} bridges a gap of up to {:.3e} (units of the file)",
            tied.gap
        )
    })
}
