//! Surfaces with fewer nodes, all of them nodes of the mesh, so that places and shapes stay those of the
//! mesh.

use eng_report::animation::collapsed;
use std::collections::BTreeMap;

/// A surface of some nodes of a mesh.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Thinned {
    /// Indices of the nodes in the mesh.
    pub nodes: Vec<u32>,
    /// Three indices into `nodes` for each triangle.
    pub triangles: Vec<[u32; 3]>,
    /// For each node of the whole surface the index in `nodes` of the node that represents it.
    pub stands_for: BTreeMap<u32, u32>,
}

/// The surface of `triangles` between nodes of a mesh, with at most `most` nodes, or with the fewest that the merging of nodes
/// can reach.
pub(super) fn thin(
    triangles: &[[u32; 3]],
    place: &dyn Fn(u32) -> [f64; 3],
    most: usize,
) -> Thinned {
    let mut used: Vec<u32> = triangles.as_flattened().to_vec();
    used.sort_unstable();
    used.dedup();
    if used.len() <= most {
        return gather(triangles, &used, |node| node);
    }
    let places: Vec<[f64; 3]> = used.iter().map(|node| place(*node)).collect();
    let local: Vec<[usize; 3]> = triangles
        .iter()
        .map(|t| t.map(|node| used.binary_search(&node).unwrap_or(0)))
        .collect();
    let stands = collapsed(&places, &local, most);
    let of: BTreeMap<u32, u32> = used
        .iter()
        .zip(stands)
        .filter_map(|(node, stands)| Some((*node, *used.get(stands)?)))
        .collect();
    gather(triangles, &used, |node| {
        of.get(&node).copied().unwrap_or(node)
    })
}

fn gather(triangles: &[[u32; 3]], used: &[u32], of: impl Fn(u32) -> u32) -> Thinned {
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
        assert_eq!(few.nodes.len(), 200);
        assert!(few.nodes.iter().all(|n| *n < 1681));
        let known = |n: &u32| (*n as usize) < few.nodes.len();
        assert!(few.triangles.as_flattened().iter().all(known));
        assert_eq!(few.stands_for.len(), 1681);
        // a flat sheet is as large as it was
        let area: f64 = few
            .triangles
            .iter()
            .map(|t| {
                let [a, b, c] = t.map(|n| place(few.nodes[n as usize]));
                0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]))
            })
            .sum();
        assert!((area - 1600.0).abs() < 1e-9, "{area}");
    }
}
