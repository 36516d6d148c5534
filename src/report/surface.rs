//! Surfaces with fewer nodes: each cell of a grid keeps one of its nodes, so that places and shapes stay those of the mesh.

use std::collections::BTreeMap;

/// A surface of some nodes of a mesh.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Thinned {
    /// Indices of the nodes in the mesh.
    pub nodes: Vec<u32>,
    /// Three of `nodes` each, by place in that list.
    pub triangles: Vec<[u32; 3]>,
    /// For each node of the whole surface the place in `nodes` of that which stands for it.
    pub stands_for: BTreeMap<u32, u32>,
    /// Side of a cell (m); zero where all nodes are kept.
    pub cell: f64,
}

/// A cell and the side to which the surface there looks, which keeps both faces of a thin wall apart.
type Key = ([i64; 3], u8);

/// The surface of `triangles` between nodes of a mesh with no more than `most` nodes, or as few as a coarse grid leaves.
pub(super) fn thin(
    triangles: &[[u32; 3]],
    place: &dyn Fn(u32) -> [f64; 3],
    most: usize,
) -> Thinned {
    let mut used: Vec<u32> = triangles.as_flattened().to_vec();
    used.sort_unstable();
    used.dedup();
    if used.len() <= most {
        return gather(triangles, &used, |node| node, 0.0);
    }
    let sides = sides(triangles, place);
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for node in &used {
        for (axis, x) in place(*node).into_iter().enumerate() {
            low[axis] = low[axis].min(x);
            high[axis] = high[axis].max(x);
        }
    }
    let size = (0..3).map(|i| high[i] - low[i]).fold(0.0, f64::max);
    let mut cell = size / 256.0;
    loop {
        let mut cells: BTreeMap<Key, Vec<u32>> = BTreeMap::new();
        for node in &used {
            let p = place(*node);
            let at = [0, 1, 2].map(|i| ((p[i] - low[i]) / cell).floor() as i64);
            let side = sides.get(node).copied().unwrap_or(0);
            cells.entry((at, side)).or_default().push(*node);
        }
        // cells as large as the body leave no more than one a side
        if cells.len() <= most || cell.is_nan() || cell >= size {
            let mut chosen = BTreeMap::new();
            for members in cells.values() {
                let middle = middle(members, place);
                for node in members {
                    chosen.insert(*node, nearest(members, middle, place).unwrap_or(*node));
                }
            }
            let of = |node: u32| chosen.get(&node).copied().unwrap_or(node);
            return gather(triangles, &used, of, cell);
        }
        cell *= 1.12;
    }
}

fn middle(nodes: &[u32], place: &dyn Fn(u32) -> [f64; 3]) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for node in nodes {
        for (sum, x) in sum.iter_mut().zip(place(*node)) {
            *sum += x / nodes.len() as f64;
        }
    }
    sum
}

fn nearest(nodes: &[u32], to: [f64; 3], place: &dyn Fn(u32) -> [f64; 3]) -> Option<u32> {
    let distance = |node: &u32| {
        let p = place(*node);
        (0..3).map(|i| (p[i] - to[i]) * (p[i] - to[i])).sum::<f64>()
    };
    nodes
        .iter()
        .copied()
        .min_by(|a, b| distance(a).total_cmp(&distance(b)))
}

/// Along which of ±x, ±y, ±z the surface at each node looks most.
fn sides(triangles: &[[u32; 3]], place: &dyn Fn(u32) -> [f64; 3]) -> BTreeMap<u32, u8> {
    let mut normals: BTreeMap<u32, [f64; 3]> = BTreeMap::new();
    for triangle in triangles {
        let [a, b, c] = triangle.map(place);
        let u = [0, 1, 2].map(|i| b[i] - a[i]);
        let v = [0, 1, 2].map(|i| c[i] - a[i]);
        let normal = [
            u[1] * v[2] - u[2] * v[1],
            u[2] * v[0] - u[0] * v[2],
            u[0] * v[1] - u[1] * v[0],
        ];
        for node in triangle {
            let sum = normals.entry(*node).or_insert([0.0; 3]);
            for (sum, x) in sum.iter_mut().zip(normal) {
                *sum += x;
            }
        }
    }
    normals
        .into_iter()
        .map(|(node, n)| {
            let [x, y, z] = n.map(f64::abs);
            let axis = if x >= y && x >= z {
                0
            } else if y >= z {
                1
            } else {
                2
            };
            let along = n.get(usize::from(axis)).copied().unwrap_or(0.0);
            (node, 2 * axis + u8::from(along < 0.0))
        })
        .collect()
}

fn gather(triangles: &[[u32; 3]], used: &[u32], of: impl Fn(u32) -> u32, cell: f64) -> Thinned {
    let mut places: BTreeMap<u32, u32> = used.iter().map(|n| (of(*n), 0)).collect();
    for (index, place) in (0u32..).zip(places.values_mut()) {
        *place = index;
    }
    let at = |node: u32| places.get(&of(node)).copied().unwrap_or(0);
    let kept = triangles
        .iter()
        .map(|t| t.map(at))
        .filter(|[a, b, c]| a != b && b != c && a != c);
    let mut seen = std::collections::BTreeSet::new();
    let triangles = kept
        .filter(|t| {
            let mut key = *t;
            key.sort_unstable();
            seen.insert(key)
        })
        .collect();
    Thinned {
        triangles,
        stands_for: used.iter().map(|node| (*node, at(*node))).collect(),
        nodes: places.keys().copied().collect(),
        cell,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A grid of `n` × `n` squares in the plane z = 0.
    fn sheet(n: u32) -> Vec<[u32; 3]> {
        let at = |i, j| i * (n + 1) + j;
        (0..n)
            .flat_map(|i| (0..n).map(move |j| (i, j)))
            .flat_map(|(i, j)| {
                let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                [[a, b, c], [a, c, d]]
            })
            .collect()
    }

    #[test]
    fn few_nodes_stay_as_they_are_and_many_are_thinned_to_nodes_of_the_mesh() {
        let triangles = sheet(40);
        let place = |node: u32| [f64::from(node / 41), f64::from(node % 41), 0.0];
        let whole = thin(&triangles, &place, 41 * 41);
        assert_eq!((whole.nodes.len(), whole.triangles.len()), (1681, 3200));
        assert_eq!(whole.triangles, triangles);
        let few = thin(&triangles, &place, 200);
        assert!(
            few.nodes.len() <= 200 && few.nodes.len() > 100,
            "{}",
            few.nodes.len()
        );
        assert!(few.cell > 2.0 && few.nodes.iter().all(|n| *n < 1681));
        let known = |n: &u32| (*n as usize) < few.nodes.len();
        assert!(few.triangles.as_flattened().iter().all(known));
        assert_eq!(few.stands_for.len(), 1681);
        // the sheet is still as large, less half a cell at each side
        let area: f64 = few
            .triangles
            .iter()
            .map(|t| {
                let [a, b, c] = t.map(|n| place(few.nodes[n as usize]));
                0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]))
            })
            .sum();
        let side = 40.0 - 1.2 * few.cell;
        assert!(area > side * side && area <= 1600.0 + 1e-9, "{area}");
    }
}
