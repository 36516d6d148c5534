//! All outlines in one plane, divided where they meet, and the edges of elements along them.

use super::error::StackError;
use super::piece::{Piece, Point, apart, cross, difference, length, middle};
use std::collections::{BTreeMap, BTreeSet};

/// Most lines of different outlines. A choice: each line is compared with all others, and more come from a
/// mistake in a loop of the text.
const MOST_LINES: usize = 4000;
/// Points nearer than this share of the size are one. A choice: stated numbers of a drawing meet as well as
/// this, and two points nearer to each other would make triangles as thin.
const SAME: f64 = 1e-4;
/// Largest angle of an arc that one edge covers (rad): 16 edges make a circle. A choice: with their middle
/// nodes on the arc, the area of the circle is 5e-5 too small.
const WIDEST: f64 = std::f64::consts::PI / 8.0 * (1.0 + 1e-9);
/// An edge along an arc rises above its chord by at most this share of its distance to the nearest other
/// line. A choice: a quarter leaves the triangle between them clearly positive.
const RISE: f64 = 0.25;
/// Arcs are divided for this reason into edges of this share of the size, and no finer. A choice: finer ones
/// would make most of the nodes of a mesh; edges there become straight instead.
const FINEST: f64 = 0.125;
/// Edges at a step of the body are at most this share of the size long. A choice: stresses are high at a
/// step, so its edges are finer.
const STEP: f64 = 0.6;
/// How often edges whose chords cross are divided. A choice: each division quarters the rise of an edge, so
/// twelve leave less than a ten-millionth of it.
const ROUNDS: usize = 12;

/// An edge of elements along an outline.
#[derive(Clone, Copy, Debug)]
pub(super) struct Edge {
    /// Its ends, by number of the vertex.
    pub ends: [u32; 2],
    /// The point in its middle on the line.
    pub middle: Point,
    /// Whether it is part of an arc.
    pub curved: bool,
}

/// The outlines with common vertices.
#[derive(Debug, Default)]
pub(super) struct Arrangement {
    pub vertices: Vec<Point>,
    pub edges: Vec<Edge>,
    /// For each different outline its vertices in order, by the chords of its edges.
    pub polygons: Vec<Vec<u32>>,
}

/// A part of a line between neighbouring vertices.
#[derive(Debug)]
struct Part {
    ends: [u32; 2],
    piece: Piece,
}

/// Outlines divided into the parts that they have in common, and these into edges.
#[derive(Debug)]
pub(super) struct Division {
    vertices: Vec<Point>,
    parts: Vec<Part>,
    chains: Chains,
    /// For each part its edges in order.
    edges: Vec<Vec<Piece>>,
    size: f64,
}

/// Divides outlines into edges. `outlines` are those that differ, each with the index of a section that has it.
/// `neighbours` are pairs of outlines whose sections touch.
pub(super) fn divide(
    outlines: &[(usize, Vec<Piece>)],
    neighbours: &BTreeSet<[usize; 2]>,
    size: f64,
) -> Result<Division, StackError> {
    let tolerance = SAME * size;
    let count: usize = outlines.iter().map(|(_, pieces)| pieces.len()).sum();
    if count > MOST_LINES {
        return Err(StackError::Corners {
            corners: count,
            most: MOST_LINES,
        });
    }
    let mut vertices = Vec::new();
    let (parts, chains) = parts(outlines, &mut vertices, tolerance);
    let steps = steps(outlines, neighbours, &parts, &chains);
    let mut division = Division {
        vertices,
        edges: edges_of(&parts, &steps, size, tolerance),
        parts,
        chains,
        size,
    };
    division.without_crossing();
    Ok(division)
}

impl Division {
    /// The outlines with the vertices of the edges.
    pub fn arranged(&self) -> Arrangement {
        let mut result = Arrangement {
            vertices: self.vertices.clone(),
            ..Arrangement::default()
        };
        let mut chain_of_part: Vec<Vec<u32>> = Vec::with_capacity(self.parts.len());
        for (part, pieces) in self.parts.iter().zip(&self.edges) {
            let mut start = part.ends[0];
            let mut chain = vec![start];
            for (k, piece) in pieces.iter().enumerate() {
                let end = if k + 1 == pieces.len() {
                    part.ends[1]
                } else {
                    result.vertices.push(piece.to);
                    result.vertices.len() as u32 - 1
                };
                result.edges.push(Edge {
                    ends: [start, end],
                    middle: piece.at(0.5),
                    curved: piece.arc.is_some(),
                });
                chain.push(end);
                start = end;
            }
            chain_of_part.push(chain);
        }
        for chain in &self.chains {
            let mut polygon = Vec::new();
            for (part, reversed) in chain {
                let vertices = chain_of_part.get(*part).map(Vec::as_slice).unwrap_or(&[]);
                // the last vertex of a part is the first of the next
                let count = vertices.len().saturating_sub(1);
                match reversed {
                    false => polygon.extend(vertices.iter().take(count)),
                    true => polygon.extend(vertices.iter().rev().take(count)),
                }
            }
            result.polygons.push(polygon);
        }
        result
    }

    /// Halves those of some edges that are not too short. Whether there were any. `chosen` has an entry for
    /// each edge of the arrangement.
    pub fn halve(&mut self, chosen: &[bool]) -> bool {
        let mut any = false;
        let mut chosen = chosen.iter();
        for edges in &mut self.edges {
            for edge in std::mem::take(edges) {
                let long = apart(edge.from, edge.to) > FINEST * self.size;
                if chosen.next() == Some(&true) && edge.arc.is_some() && long {
                    edges.extend(halves(&edge));
                    any = true;
                } else {
                    edges.push(edge);
                }
            }
        }
        if any {
            self.without_crossing();
        }
        any
    }

    /// Halves arcs whose chords cross, those that rise more above their chord.
    fn without_crossing(&mut self) {
        for _ in 0..ROUNDS {
            let crossing = crossing(&self.edges);
            if !crossing.contains(&true) {
                return;
            }
            let mut crossing = crossing.into_iter();
            for edges in &mut self.edges {
                for edge in std::mem::take(edges) {
                    match crossing.next() {
                        Some(true) => edges.extend(halves(&edge)),
                        _ => edges.push(edge),
                    }
                }
            }
        }
    }
}

/// The number of the vertex at a point, which is made if there is none.
fn vertex(vertices: &mut Vec<Point>, point: Point, tolerance: f64) -> u32 {
    let known = vertices
        .iter()
        .position(|other| apart(*other, point) <= tolerance);
    let index = known.unwrap_or_else(|| {
        vertices.push(point);
        vertices.len() - 1
    });
    index as u32
}

/// For each outline its parts in order, and whether each is passed from its end to its start.
type Chains = Vec<Vec<(usize, bool)>>;

/// The parts of all outlines between their common vertices, each once.
fn parts(
    outlines: &[(usize, Vec<Piece>)],
    vertices: &mut Vec<Point>,
    tolerance: f64,
) -> (Vec<Part>, Chains) {
    let all: Vec<&Piece> = outlines.iter().flat_map(|(_, pieces)| pieces).collect();
    for piece in &all {
        vertex(vertices, piece.from, tolerance);
    }
    let boxes: Vec<[Point; 2]> = all.iter().map(|piece| piece.bounds()).collect();
    for (i, (first, first_box)) in all.iter().zip(&boxes).enumerate() {
        for (second, second_box) in all.iter().zip(&boxes).skip(i + 1) {
            if overlap(first_box, second_box, tolerance) {
                for point in first.common(second, tolerance) {
                    vertex(vertices, point, tolerance);
                }
            }
        }
    }
    let mut parts: Vec<Part> = Vec::new();
    let mut known: BTreeMap<[u32; 2], Vec<usize>> = BTreeMap::new();
    let mut chains = Vec::new();
    for (_, pieces) in outlines {
        let mut chain = Vec::new();
        for piece in pieces {
            for part in divided(piece, vertices, tolerance) {
                let [a, b] = part.ends;
                let same = known.entry([a.min(b), a.max(b)]).or_default();
                let at = part.piece.at(0.5);
                let found = same.iter().copied().find(|k| {
                    let other = parts.get(*k).map(|other| other.piece.at(0.5));
                    // a choice: middles of two arcs between the same ends differ by some times the difference
                    // of their ends
                    other.is_some_and(|other| apart(other, at) <= 10.0 * tolerance)
                });
                let index = found.unwrap_or_else(|| {
                    same.push(parts.len());
                    parts.push(part);
                    parts.len() - 1
                });
                let reversed = parts.get(index).is_some_and(|part| part.ends != [a, b]);
                chain.push((index, reversed));
            }
        }
        chains.push(chain);
    }
    (parts, chains)
}

/// The parts of a line between the vertices on it.
fn divided(piece: &Piece, vertices: &[Point], tolerance: f64) -> Vec<Part> {
    let bounds = piece.bounds();
    let mut on: Vec<(f64, u32)> = Vec::new();
    let (mut first, mut last) = (0, 0);
    for (index, point) in vertices.iter().enumerate() {
        if !overlap(&bounds, &[*point, *point], tolerance) {
            continue;
        }
        let index = index as u32;
        if apart(*point, piece.from) <= tolerance {
            first = index;
        } else if apart(*point, piece.to) <= tolerance {
            last = index;
        } else if piece.distance(*point) <= tolerance {
            on.push((piece.share(*point), index));
        }
    }
    on.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut stops = vec![(0.0, first)];
    stops.extend(on);
    stops.push((1.0, last));
    let point = |index: u32| vertices.get(index as usize).copied().unwrap_or_default();
    stops
        .windows(2)
        .filter_map(|pair| match pair {
            [a, b] => Some(Part {
                ends: [a.1, b.1],
                piece: piece.part((a.0, point(a.1)), (b.0, point(b.1))),
            }),
            _ => None,
        })
        .collect()
}

/// Whether two boxes have a common point, within a tolerance.
fn overlap(a: &[Point; 2], b: &[Point; 2], tolerance: f64) -> bool {
    (0..2).all(|axis| a[0][axis] <= b[1][axis] + tolerance && b[0][axis] <= a[1][axis] + tolerance)
}

/// For each part whether it lies inside of a neighbouring section: there the body has a step, and stresses rise.
fn steps(
    outlines: &[(usize, Vec<Piece>)],
    neighbours: &BTreeSet<[usize; 2]>,
    parts: &[Part],
    chains: &Chains,
) -> Vec<bool> {
    let mut steps = vec![false; parts.len()];
    for [a, b] in neighbours {
        for (own, other) in [(a, b), (b, a)] {
            let (Some(chain), Some((_, around))) = (chains.get(*own), outlines.get(*other)) else {
                continue;
            };
            for (index, _) in chain {
                if let (Some(part), Some(step)) = (parts.get(*index), steps.get_mut(*index)) {
                    *step |= winds(around, part.piece.at(0.5));
                }
            }
        }
    }
    steps
}

/// Whether a point is inside of an outline: its lines turn once around it.
fn winds(outline: &[Piece], point: Point) -> bool {
    let turned: f64 = outline.iter().map(|piece| piece.turns(point)).sum();
    turned.abs() > std::f64::consts::PI
}

/// The edges of each part: none is longer than the size, and those of an arc follow it well.
fn edges_of(parts: &[Part], steps: &[bool], size: f64, tolerance: f64) -> Vec<Vec<Piece>> {
    let boxes: Vec<[Point; 2]> = parts.iter().map(|part| part.piece.bounds()).collect();
    let mut all = Vec::with_capacity(parts.len());
    for (part, step) in parts.iter().zip(steps) {
        let piece = part.piece;
        let longest = if *step { STEP * size } else { size };
        // a length of a whole number of sizes must not get one edge more by rounding
        let mut count = libm::ceil(piece.length() / longest * (1.0 - 1e-9)).max(1.0);
        if let Some(arc) = piece.arc {
            let turns = piece.length() / arc.radius;
            count = count.max(libm::ceil(turns / WIDEST));
        }
        let count = count as usize;
        let point = |k: usize| piece.at(k as f64 / count as f64);
        let share = |k: usize| k as f64 / count as f64;
        let mut edges = Vec::with_capacity(count);
        for k in 0..count {
            let edge = piece.part((share(k), point(k)), (share(k + 1), point(k + 1)));
            near(edge, part, parts, &boxes, (size, tolerance), &mut edges);
        }
        all.push(edges);
    }
    all
}

/// Divides an edge of an arc where another line is near, and adds its parts to `edges`.
fn near(
    edge: Piece,
    part: &Part,
    parts: &[Part],
    boxes: &[[Point; 2]],
    (size, tolerance): (f64, f64),
    edges: &mut Vec<Piece>,
) {
    let chord = apart(edge.from, edge.to);
    let at = edge.at(0.5);
    let rise = rise(&edge);
    if edge.arc.is_none() || chord <= FINEST * size || rise <= tolerance {
        edges.push(edge);
        return;
    }
    let wanted = rise / RISE;
    let close = parts.iter().zip(boxes).any(|(other, bounds)| {
        !std::ptr::eq(other, part)
            && overlap(bounds, &[at, at], wanted)
            && other.piece.distance(at) < wanted
    });
    if !close {
        edges.push(edge);
        return;
    }
    for half in halves(&edge) {
        near(half, part, parts, boxes, (size, tolerance), edges);
    }
}

fn halves(edge: &Piece) -> [Piece; 2] {
    let at = edge.at(0.5);
    [
        edge.part((0.0, edge.from), (0.5, at)),
        edge.part((0.5, at), (1.0, edge.to)),
    ]
}

/// The height of an arc above its chord.
fn rise(edge: &Piece) -> f64 {
    apart(edge.at(0.5), middle(edge.from, edge.to))
}

/// For each edge whether its chord crosses another one and must be divided: of two, the arc that rises more.
fn crossing(parts: &[Vec<Piece>]) -> Vec<bool> {
    let all: Vec<&Piece> = parts.iter().flatten().collect();
    let mut crossing = vec![false; all.len()];
    for (i, a) in all.iter().enumerate() {
        for (j, b) in all.iter().enumerate().skip(i + 1) {
            if !(a.arc.is_some() || b.arc.is_some()) || !chords_cross(a, b) {
                continue;
            }
            let (first, second) = (rise(a), rise(b));
            for (index, own, other) in [(i, first, second), (j, second, first)] {
                if own > 0.0
                    // of two edges that rise nearly alike both are divided, so that symmetric outlines stay
                    // symmetric
                    && own >= 0.99 * other
                    && let Some(crosses) = crossing.get_mut(index)
                {
                    *crosses = true;
                }
            }
        }
    }
    crossing
}

/// Whether the chords of two edges cross inside of both.
fn chords_cross(a: &Piece, b: &Piece) -> bool {
    let low = |p: &Piece, axis: usize| p.from[axis].min(p.to[axis]);
    let high = |p: &Piece, axis: usize| p.from[axis].max(p.to[axis]);
    if (0..2).any(|axis| low(a, axis) > high(b, axis) || low(b, axis) > high(a, axis)) {
        return false;
    }
    let side = |p: &Piece, point: Point| {
        let along = difference(p.to, p.from);
        cross(along, difference(point, p.from)) / length(along)
    };
    // rounding of a distance: edges that touch do not cross
    let tiny = 1e-12 * (apart(a.from, a.to) + apart(b.from, b.to));
    let opposite = |x: f64, y: f64| (x > tiny && y < -tiny) || (x < -tiny && y > tiny);
    opposite(side(a, b.from), side(a, b.to)) && opposite(side(b, a.from), side(b, a.to))
}
