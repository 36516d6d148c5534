//! One planar triangulation that respects every outline, with a quadratic edge wherever an arc permits it.

use super::arrangement::{Arrangement, Edge};
use super::error::StackError;
use super::piece::{Point, apart, cross, difference, dot, middle, sum, times};
use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation as _};
use std::collections::BTreeMap;

/// Inner points keep this share of the size from outlines. A choice: it is between half and all of the height
/// of an equal triangle, 0.87 of the size, so that triangles at an outline are not flat.
const CLEAR: f64 = 0.55;
/// Distance of inner points by the size: rows of equal triangles.
const SPACING: f64 = 1.0;
/// How often the inner points are moved and triangulated again. A choice: the points move little after the
/// first round.
const ROUNDS: usize = 3;
/// How often each inner point moves in a round. A choice: more would move points over triangles that are not
/// made again before the next round.
const SWEEPS: usize = 4;
/// A height of a triangle below this share of the size is a fault of the outlines. A choice: a fifth of the
/// distance at which points are one.
const THIN: f64 = 2e-5;
/// Least of the Bernstein coefficients of a triangle's Jacobian, by that of its corners alone. A choice:
/// positive coefficients prove a positive Jacobian; a fifth keeps the strains of curved triangles regular.
const LEAST_JACOBIAN: f64 = 0.2;

/// Triangles of six nodes in the plane, with the outlines that they are in.
#[derive(Debug, Default)]
pub(super) struct Plane {
    /// Corners, then middles of edges.
    pub points: Vec<Point>,
    /// Corners in positive sense, then the middles of the edges 12, 23, 31.
    pub triangles: Vec<[u32; 6]>,
    /// For each different outline its triangles, ascending.
    pub inside: Vec<Vec<u32>>,
    /// For each edge of the outlines whether it is straight in the place of an arc.
    pub straightened: Vec<bool>,
}

/// Triangulates the outlines.
pub(super) fn triangulate(arranged: &Arrangement, size: f64) -> Result<Plane, StackError> {
    let mut inner = lattice(arranged, size);
    for _ in 0..ROUNDS {
        let corners = delaunay(arranged, &inner)?;
        smooth(&arranged.vertices, &mut inner, &corners);
    }
    let corners = delaunay(arranged, &inner)?;
    let mut points = arranged.vertices.clone();
    points.extend(&inner);
    let neighbours = Neighbours::new(&corners);
    let inside: Vec<Vec<u32>> = arranged
        .polygons
        .iter()
        .map(|polygon| neighbours.inside(polygon, &corners))
        .collect();
    let mut used = vec![false; corners.len()];
    for index in inside.iter().flatten() {
        if let Some(used) = used.get_mut(*index as usize) {
            *used = true;
        }
    }
    Ok(with_middles(arranged, points, &corners, &used, inside))
}

/// The triangles on both sides of each edge.
struct Neighbours {
    across: BTreeMap<[u32; 2], Vec<u32>>,
}

impl Neighbours {
    fn new(corners: &[[u32; 3]]) -> Self {
        let mut across: BTreeMap<[u32; 2], Vec<u32>> = BTreeMap::new();
        for (index, triangle) in (0..).zip(corners) {
            for edge in edges(triangle) {
                across.entry(edge).or_default().push(index);
            }
        }
        Neighbours { across }
    }

    /// The triangles inside of a polygon, ascending. An odd number of its sides is between them and the outside. No
    /// position decides this, so vertices that leave a straight line by rounding cannot change it.
    fn inside(&self, polygon: &[u32], corners: &[[u32; 3]]) -> Vec<u32> {
        let mut sides: BTreeMap<[u32; 2], bool> = BTreeMap::new();
        let next = polygon.iter().cycle().skip(1);
        for (a, b) in polygon.iter().zip(next) {
            *sides.entry(sorted([*a, *b])).or_default() ^= true;
        }
        let is_side = |edge: &[u32; 2]| sides.get(edge) == Some(&true);
        let mut state: Vec<Option<bool>> = vec![None; corners.len()];
        let mut open: Vec<(u32, bool)> = Vec::new();
        let outer = |(_, triangles): &(&[u32; 2], &Vec<u32>)| triangles.len() == 1;
        if let Some((edge, triangles)) = self.across.iter().find(outer) {
            open.extend(triangles.iter().map(|triangle| (*triangle, is_side(edge))));
        }
        while let Some((triangle, inside)) = open.pop() {
            let (Some(state), Some(corners)) = (
                state.get_mut(triangle as usize),
                corners.get(triangle as usize),
            ) else {
                continue;
            };
            if state.is_some() {
                continue;
            }
            *state = Some(inside);
            for edge in edges(corners) {
                let beyond = inside ^ is_side(&edge);
                let others = self.across.get(&edge).into_iter().flatten();
                open.extend(
                    others
                        .filter(|other| **other != triangle)
                        .map(|t| (*t, beyond)),
                );
            }
        }
        let found = (0..).zip(state);
        found
            .filter(|(_, state)| *state == Some(true))
            .map(|(triangle, _)| triangle)
            .collect()
    }
}

/// The edges of a triangle, each with its lower vertex first.
fn edges([a, b, c]: &[u32; 3]) -> [[u32; 2]; 3] {
    [sorted([*a, *b]), sorted([*b, *c]), sorted([*c, *a])]
}

/// Points in rows of equal triangles, inside of the outlines and clear of them.
fn lattice(arranged: &Arrangement, size: f64) -> Vec<Point> {
    let polygons: Vec<Vec<Point>> = arranged
        .polygons
        .iter()
        .map(|polygon| {
            let points = polygon.iter();
            points
                .filter_map(|vertex| arranged.vertices.get(*vertex as usize).copied())
                .collect()
        })
        .collect();
    let boxes: Vec<[Point; 2]> = polygons.iter().map(|polygon| bounds(polygon)).collect();
    let [low, high] = bounds(&arranged.vertices);
    let (across, up) = (SPACING * size, SPACING * size * 0.75_f64.sqrt());
    // the rows are symmetric about both axes of the plane
    let (first, last) = (libm::floor(low[1] / up), libm::ceil(high[1] / up));
    let (left, right) = (
        libm::floor(low[0] / across) - 1.0,
        libm::ceil(high[0] / across) + 1.0,
    );
    let chords: Vec<[Point; 2]> = arranged
        .edges
        .iter()
        .map(|edge| {
            edge.ends.map(|end| {
                arranged
                    .vertices
                    .get(end as usize)
                    .copied()
                    .unwrap_or_default()
            })
        })
        .collect();
    let mut found = Vec::new();
    let mut row = first;
    while row <= last {
        let y = up * row;
        let near: Vec<&[Point; 2]> = chords
            .iter()
            .filter(|[a, b]| a[1].min(b[1]) - size <= y && y <= a[1].max(b[1]) + size)
            .collect();
        let odd = (row - 2.0 * libm::floor(0.5 * row)) * 0.5;
        let mut column = left;
        while column <= right {
            let point = [across * (column + odd), y];
            let covered = polygons
                .iter()
                .zip(&boxes)
                .any(|(polygon, bounds)| within(bounds, point) && contains(polygon, point));
            if covered
                && near
                    .iter()
                    .all(|chord| to_chord(chord, point) >= CLEAR * size)
            {
                found.push(point);
            }
            column += 1.0;
        }
        row += 1.0;
    }
    found
}

/// The distance of a point from a chord.
fn to_chord([a, b]: &[Point; 2], point: Point) -> f64 {
    let along = difference(*b, *a);
    let share = dot(difference(point, *a), along) / dot(along, along);
    apart(point, sum(*a, times(share.clamp(0.0, 1.0), along)))
}

fn bounds(points: &[Point]) -> [Point; 2] {
    let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    for point in points {
        for axis in 0..2 {
            low[axis] = low[axis].min(point[axis]);
            high[axis] = high[axis].max(point[axis]);
        }
    }
    [low, high]
}

fn within([low, high]: &[Point; 2], point: Point) -> bool {
    (0..2).all(|axis| low[axis] <= point[axis] && point[axis] <= high[axis])
}

/// Whether a polygon contains a point: an odd number of its sides crosses the ray along the first axis.
fn contains(polygon: &[Point], point: Point) -> bool {
    let mut odd = false;
    let next = polygon.iter().cycle().skip(1);
    for (a, b) in polygon.iter().zip(next) {
        if (a[1] > point[1]) != (b[1] > point[1]) {
            let share = (point[1] - a[1]) / (b[1] - a[1]);
            odd ^= point[0] < a[0] + share * (b[0] - a[0]);
        }
    }
    odd
}

/// The constrained Delaunay triangulation of vertices, inner points and edges: corners in positive sense.
fn delaunay(arranged: &Arrangement, inner: &[Point]) -> Result<Vec<[u32; 3]>, StackError> {
    let failed = |at: Point, why: &str| StackError::Plane {
        at,
        why: why.to_owned(),
    };
    let mut plane = ConstrainedDelaunayTriangulation::<Point2<f64>>::new();
    let mut handles = Vec::with_capacity(arranged.vertices.len() + inner.len());
    let mut insert = |plane: &mut ConstrainedDelaunayTriangulation<Point2<f64>>, point: Point| {
        // spade refuses numbers that its exact predicates would lose
        let [x, y] = point.map(|x| if x.abs() < 1e-30 { 0.0 } else { x });
        let handle = plane
            .insert(Point2::new(x, y))
            .map_err(|error| failed(point, &error.to_string()))?;
        if handle.index() != handles.len() {
            return Err(failed(point, "two of their points coincide"));
        }
        handles.push(handle);
        Ok(())
    };
    for point in &arranged.vertices {
        insert(&mut plane, *point)?;
    }
    for point in inner {
        insert(&mut plane, *point)?;
    }
    for edge in &arranged.edges {
        let [from, to] = edge.ends.map(|end| handles.get(end as usize).copied());
        let (Some(from), Some(to)) = (from, to) else {
            return Err(failed(edge.middle, "an edge has no ends"));
        };
        // an edge that already exists is returned, too; none is returned where another outline is in the way
        if plane.try_add_constraint(from, to).is_empty() && !plane.exists_constraint(from, to) {
            return Err(failed(edge.middle, "two of their edges cross"));
        }
    }
    Ok(plane
        .inner_faces()
        .map(|face| face.vertices().map(|vertex| vertex.fix().index() as u32))
        .collect())
}

/// Moves inner points towards the mean of their triangles' centres, weighted by area. A point stays if a triangle at it
/// would become worse than the worst before.
fn smooth(fixed: &[Point], inner: &mut [Point], corners: &[[u32; 3]]) {
    let mut around: Vec<Vec<[u32; 3]>> = vec![Vec::new(); inner.len()];
    for triangle in corners {
        for corner in triangle {
            let index = (*corner as usize).checked_sub(fixed.len());
            if let Some(list) = index.and_then(|index| around.get_mut(index)) {
                list.push(*triangle);
            }
        }
    }
    for _ in 0..SWEEPS {
        for (index, triangles) in around.iter().enumerate() {
            let number = (fixed.len() + index) as u32;
            let place = |corner: u32, moved: Option<Point>| match moved {
                Some(moved) if corner == number => moved,
                _ => {
                    let corner = corner as usize;
                    let inner = || inner.get(corner - fixed.len());
                    let found = fixed.get(corner).or_else(inner);
                    found.copied().unwrap_or_default()
                }
            };
            let worst = |moved: Option<Point>| {
                let all = triangles
                    .iter()
                    .map(|t| quality(t.map(|c| place(c, moved))));
                all.fold(f64::INFINITY, f64::min)
            };
            let (mut weight, mut mean) = (0.0, [0.0; 2]);
            for triangle in triangles {
                let [a, b, c] = triangle.map(|corner| place(corner, None));
                let area = cross(difference(b, a), difference(c, a));
                weight += area;
                mean = sum(mean, times(area / 3.0, sum(a, sum(b, c))));
            }
            let moved = times(1.0 / weight, mean);
            if weight > 0.0
                && worst(Some(moved)) >= worst(None)
                && let Some(point) = inner.get_mut(index)
            {
                *point = moved;
            }
        }
    }
}

/// Twice the area by the square of the longest edge: √3/2 for equal edges, negative if inverted.
fn quality([a, b, c]: [Point; 3]) -> f64 {
    let longest = apart(a, b).max(apart(b, c)).max(apart(c, a));
    cross(difference(b, a), difference(c, a)) / (longest * longest)
}

/// Adds the middles of edges, on arcs where the triangles on both sides permit it.
fn with_middles(
    arranged: &Arrangement,
    mut points: Vec<Point>,
    corners: &[[u32; 3]],
    used: &[bool],
    inside: Vec<Vec<u32>>,
) -> Plane {
    let along: BTreeMap<[u32; 2], (usize, &Edge)> = arranged
        .edges
        .iter()
        .enumerate()
        .map(|(index, edge)| (sorted(edge.ends), (index, edge)))
        .collect();
    let mut straightened = vec![false; arranged.edges.len()];
    let mut middles: BTreeMap<[u32; 2], u32> = BTreeMap::new();
    // the edge and the middle of its chord, of nodes on arcs
    let mut straight: Vec<Option<(usize, Point)>> = vec![None; points.len()];
    let mut triangles = Vec::with_capacity(corners.len());
    for [a, b, c] in corners {
        let mut nodes = [*a, *b, *c, 0, 0, 0];
        for (k, ends) in [[*a, *b], [*b, *c], [*c, *a]].into_iter().enumerate() {
            let key = sorted(ends);
            nodes[3 + k] = *middles.entry(key).or_insert_with(|| {
                let [from, to] =
                    key.map(|end| points.get(end as usize).copied().unwrap_or_default());
                let chord = middle(from, to);
                let curved = along.get(&key).filter(|(_, edge)| edge.curved);
                points.push(curved.map_or(chord, |(_, edge)| edge.middle));
                straight.push(curved.map(|(index, _)| (*index, chord)));
                points.len() as u32 - 1
            });
        }
        triangles.push(nodes);
    }
    for (triangle, _) in triangles.iter().zip(used).filter(|(_, used)| **used) {
        // straight edges have a positive Jacobian. A straight edge helps one neighbour, and may harm the
        // other: both are looked at again.
        while let Some(node) = bent_too_far(triangle, &points, &straight) {
            make_straight(node, &mut points, &mut straight, &mut straightened);
        }
    }
    loop {
        let mut bad = triangles.iter().zip(used).filter(|(_, used)| **used);
        let Some(node) = bad.find_map(|(t, _)| bent_too_far(t, &points, &straight)) else {
            break;
        };
        make_straight(node, &mut points, &mut straight, &mut straightened);
    }
    Plane {
        points,
        triangles,
        inside,
        straightened,
    }
}

/// Moves a node from its arc to the chord.
fn make_straight(
    node: u32,
    points: &mut [Point],
    straight: &mut [Option<(usize, Point)>],
    straightened: &mut [bool],
) {
    let taken = straight.get_mut(node as usize).and_then(Option::take);
    if let (Some((edge, chord)), Some(point)) = (taken, points.get_mut(node as usize)) {
        *point = chord;
        if let Some(straightened) = straightened.get_mut(edge) {
            *straightened = true;
        }
    }
}

fn sorted([a, b]: [u32; 2]) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

/// The curved edge of a triangle that is farthest from its chord, if the triangle's Jacobian may vanish.
fn bent_too_far(
    triangle: &[u32; 6],
    points: &[Point],
    straight: &[Option<(usize, Point)>],
) -> Option<u32> {
    let chord = |node: u32| {
        straight
            .get(node as usize)
            .copied()
            .flatten()
            .map(|(_, chord)| chord)
    };
    if triangle.iter().skip(3).all(|node| chord(*node).is_none()) {
        return None;
    }
    let place = triangle.map(|node| points.get(node as usize).copied().unwrap_or_default());
    let [a, b, c, ..] = place;
    let least = jacobian(&place).into_iter().fold(f64::INFINITY, f64::min);
    if least >= LEAST_JACOBIAN * cross(difference(b, a), difference(c, a)) {
        return None;
    }
    let rise = |node: u32| {
        let at = points.get(node as usize).copied().unwrap_or_default();
        chord(node).map_or(0.0, |chord| apart(at, chord))
    };
    triangle
        .iter()
        .skip(3)
        .copied()
        .filter(|node| chord(*node).is_some())
        .max_by(|a, b| rise(*a).total_cmp(&rise(*b)))
}

/// Bernstein coefficients of the Jacobian of a triangle of six nodes, a polynomial of degree two. If all are positive,
/// so is the Jacobian everywhere.
///
/// With the control points P of the edges' quadratic Bézier curves (the corners, and 2 m − (a + b)/2 for an edge from a
/// to b with the middle m), ∂x/∂r and ∂x/∂s are linear with the values 2 (P₁₀ − P₀₀), … at the corners. The coefficient
/// of a corner is the product there, that of an edge the mean of the two mixed products.
pub(super) fn jacobian(place: &[Point; 6]) -> [f64; 6] {
    let [a, b, c, ab, bc, ca] = *place;
    let control = |from: Point, to: Point, at: Point| difference(times(2.0, at), middle(from, to));
    let (ab, bc, ca) = (control(a, b, ab), control(b, c, bc), control(c, a, ca));
    // ∂x/∂r and ∂x/∂s at the corners a, b, c
    let r = [difference(ab, a), difference(b, ab), difference(bc, ca)].map(|d| times(2.0, d));
    let s = [difference(ca, a), difference(bc, ab), difference(c, ca)].map(|d| times(2.0, d));
    let mixed = |i: usize, j: usize| 0.5 * (cross(r[i], s[j]) + cross(r[j], s[i]));
    [
        mixed(0, 0),
        mixed(1, 1),
        mixed(2, 2),
        mixed(0, 1),
        mixed(1, 2),
        mixed(2, 0),
    ]
}

impl Plane {
    /// The points of a triangle.
    pub fn places(&self, triangle: u32) -> [Point; 6] {
        let nodes = self.triangles.get(triangle as usize).copied();
        let point = |node: u32| self.points.get(node as usize).copied();
        nodes
            .unwrap_or_default()
            .map(|node| point(node).unwrap_or_default())
    }

    /// Area of a triangle: the mean of the Bernstein coefficients of its Jacobian, halved.
    pub fn area(&self, triangle: u32) -> f64 {
        jacobian(&self.places(triangle)).into_iter().sum::<f64>() / 12.0
    }

    /// Refuses triangles that are too thin, of an outline that belongs to a section.
    pub fn thin(&self, outline: usize, section: usize, size: f64) -> Result<(), StackError> {
        for triangle in self.inside.get(outline).into_iter().flatten() {
            let [a, b, c, ..] = self.places(*triangle);
            let longest = apart(a, b).max(apart(b, c)).max(apart(c, a));
            let height = cross(difference(b, a), difference(c, a)) / longest;
            let least = jacobian(&self.places(*triangle))
                .into_iter()
                .fold(f64::INFINITY, f64::min);
            if !(height > THIN * size && least > 0.0) {
                return Err(StackError::Close {
                    at: times(1.0 / 3.0, sum(a, sum(b, c))),
                    gap: height.max(0.0),
                    section,
                });
            }
        }
        Ok(())
    }
}
