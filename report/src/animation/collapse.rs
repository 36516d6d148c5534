//! Finds nodes of a surface that can be removed. It moves one end of an edge onto the other, beginning with
//! the edges whose removal changes the surface least.
//!
//! The cost of an end is the sum of squared distances to the planes of all triangles that were merged into
//! it, weighted by their areas (m⁴): M. Garland, P. Heckbert, "Surface simplification using quadric error
//! metrics", SIGGRAPH 1997. The end that stays does not move, so that it is still a node of the mesh.

use super::quaternion::{cross, dot, minus};
use std::cmp::Ordering;
use std::collections::{BTreeSet, BinaryHeap};

/// Share of an edge's length to the fourth that is added to its cost: in a plane short edges go first, and
/// triangles stay compact. A choice.
const LENGTH: f64 = 1e-3;
/// Weight of planes across a rim, in squares of the edge. A choice: rims keep their form before surfaces do.
const RIM: f64 = 10.0;
/// A triangle may turn by no more than the angle with this cosine, 73°. A choice: a triangle that turns over
/// would show its back.
const TURN: f64 = 0.3;

type Vector = [f64; 3];

/// Sum of w (n·x + d)² over planes: the six of n nᵀ, three of n d, d².
#[derive(Clone, Copy, Default)]
struct Quadric([f64; 10]);

impl Quadric {
    /// The plane through a point with a normal of any length, of a weight.
    fn plane(normal: Vector, point: Vector, weight: f64) -> Quadric {
        let length = dot(normal, normal).sqrt();
        if length <= 0.0 {
            return Quadric::default();
        }
        let [a, b, c] = normal.map(|x| x / length);
        let d = -dot([a, b, c], point);
        let terms = [
            a * a,
            b * b,
            c * c,
            a * b,
            b * c,
            a * c,
            a * d,
            b * d,
            c * d,
            d * d,
        ];
        Quadric(terms.map(|x| weight * x))
    }

    fn add(&mut self, other: &Quadric) {
        for (a, b) in self.0.iter_mut().zip(other.0) {
            *a += b;
        }
    }

    fn at(&self, [x, y, z]: Vector) -> f64 {
        let q = &self.0;
        let squares = q[0] * x * x + q[1] * y * y + q[2] * z * z;
        let mixed = q[3] * x * y + q[4] * y * z + q[5] * x * z;
        squares + 2.0 * (mixed + q[6] * x + q[7] * y + q[8] * z) + q[9]
    }
}

/// A node that may go into another.
struct Candidate {
    cost: f64,
    goes: usize,
    stays: usize,
    /// Changes of both when the cost was found.
    ages: [u32; 2],
}

impl Ord for Candidate {
    /// The cheapest candidate is the greatest. Equal costs are ordered by number.
    fn cmp(&self, other: &Candidate) -> Ordering {
        other
            .cost
            .total_cmp(&self.cost)
            .then(other.goes.cmp(&self.goes))
            .then(other.stays.cmp(&self.stays))
    }
}

impl PartialOrd for Candidate {
    fn partial_cmp(&self, other: &Candidate) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Candidate {
    fn eq(&self, other: &Candidate) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Candidate {}

/// A surface from which nodes are removed. All indices are those of `places` and were checked when it was
/// made.
struct Surface<'a> {
    places: &'a [Vector],
    triangles: Vec<[usize; 3]>,
    /// Triangles that are left, by node.
    around: Vec<BTreeSet<usize>>,
    quadrics: Vec<Quadric>,
    ages: Vec<u32>,
}

impl Surface<'_> {
    fn neighbours(&self, node: usize) -> BTreeSet<usize> {
        self.around[node]
            .iter()
            .flat_map(|t| self.triangles[*t])
            .filter(|other| *other != node)
            .collect()
    }

    fn normal(&self, corners: [usize; 3]) -> Vector {
        let [a, b, c] = corners.map(|node| self.places[node]);
        cross(minus(b, a), minus(c, a))
    }

    /// Planes of the triangles at a node, and planes across the rim where an edge has but one.
    fn quadric(&self, node: usize) -> Quadric {
        let mut sum = Quadric::default();
        for t in &self.around[node] {
            let corners = self.triangles[*t];
            let normal = self.normal(corners);
            let area = 0.5 * dot(normal, normal).sqrt();
            sum.add(&Quadric::plane(normal, self.places[node], area));
            for other in corners.into_iter().filter(|other| *other != node) {
                let shared = self.around[node].intersection(&self.around[other]).count();
                if shared == 1 {
                    let edge = minus(self.places[other], self.places[node]);
                    let across = cross(edge, normal);
                    let weight = RIM * dot(edge, edge);
                    sum.add(&Quadric::plane(across, self.places[node], weight));
                }
            }
        }
        sum
    }

    fn candidate(&self, goes: usize, stays: usize) -> Candidate {
        let place = self.places[stays];
        let edge = minus(place, self.places[goes]);
        let mut sum = self.quadrics[goes];
        sum.add(&self.quadrics[stays]);
        let square = dot(edge, edge);
        Candidate {
            cost: sum.at(place).max(0.0) + LENGTH * square * square,
            goes,
            stays,
            ages: [self.ages[goes], self.ages[stays]],
        }
    }

    /// Whether the surface remains a surface without turned triangles.
    fn allowed(&self, goes: usize, stays: usize) -> bool {
        let shared = self.around[goes].intersection(&self.around[stays]).count();
        let common = self
            .neighbours(goes)
            .intersection(&self.neighbours(stays))
            .count();
        if shared == 0 || common != shared {
            return false;
        }
        self.around[goes]
            .iter()
            .filter(|t| !self.around[stays].contains(t))
            .all(|t| {
                let before = self.triangles[*t];
                let after = before.map(|node| if node == goes { stays } else { node });
                let (a, b) = (self.normal(before), self.normal(after));
                dot(a, b) > TURN * (dot(a, a) * dot(b, b)).sqrt()
            })
    }

    fn draw_together(&mut self, goes: usize, stays: usize) {
        let own = std::mem::take(&mut self.around[goes]);
        for t in own {
            if self.triangles[t].contains(&stays) {
                for node in self.triangles[t] {
                    self.around[node].remove(&t);
                }
            } else {
                let corners = &mut self.triangles[t];
                *corners = corners.map(|node| if node == goes { stays } else { node });
                self.around[stays].insert(t);
            }
        }
        let merged = self.quadrics[goes];
        self.quadrics[stays].add(&merged);
        self.ages[goes] += 1;
        self.ages[stays] += 1;
    }
}

/// For each of `places` the place that represents it, which is the place itself if it remains. At most `most`
/// places remain, or as few as the surface allows. Triangles hold indices of `places`. Triangles with other
/// indices, or with one index twice, are left out.
pub fn collapsed(places: &[Vector], triangles: &[[usize; 3]], most: usize) -> Vec<usize> {
    let mut surface = Surface {
        places,
        triangles: triangles
            .iter()
            .copied()
            .filter(|[a, b, c]| a != b && b != c && a != c)
            .filter(|t| t.iter().all(|node| *node < places.len()))
            .collect(),
        around: vec![BTreeSet::new(); places.len()],
        quadrics: Vec::new(),
        ages: vec![0; places.len()],
    };
    for (index, corners) in surface.triangles.iter().enumerate() {
        for node in corners {
            surface.around[*node].insert(index);
        }
    }
    surface.quadrics = (0..places.len())
        .map(|node| surface.quadric(node))
        .collect();
    let mut stands: Vec<usize> = (0..places.len()).collect();
    let mut heap: BinaryHeap<Candidate> = BinaryHeap::new();
    for node in 0..places.len() {
        for other in surface.neighbours(node) {
            heap.push(surface.candidate(node, other));
        }
    }
    let mut left = places.len();
    while left > most
        && let Some(Candidate {
            goes, stays, ages, ..
        }) = heap.pop()
    {
        let now = [surface.ages[goes], surface.ages[stays]];
        if now != ages || !surface.allowed(goes, stays) {
            continue;
        }
        surface.draw_together(goes, stays);
        stands[goes] = stays;
        left -= 1;
        for other in surface.neighbours(stays) {
            heap.push(surface.candidate(stays, other));
            heap.push(surface.candidate(other, stays));
        }
    }
    // chains end at a node that stays
    for node in 0..stands.len() {
        let mut end = node;
        while stands[end] != end {
            end = stands[end];
        }
        stands[node] = end;
    }
    stands
}
