//! Surfaces with fewer nodes, all of them nodes of the mesh, so that places and shapes stay those of the
//! mesh.

use eng_report::animation::collapsed;
use std::collections::BTreeMap;

/// A surface of some nodes of a mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct Thinned {
    /// Indices of the nodes in the mesh.
    pub nodes: Vec<u32>,
    /// Three indices into `nodes` for each triangle.
    pub triangles: Vec<[u32; 3]>,
    /// For each node of the whole surface the index in `nodes` of the node that represents it.
    pub stands_for: BTreeMap<u32, u32>,
}

/// The surface of `triangles` between nodes of a mesh, with at most `most` nodes, or with the fewest that the merging of nodes
/// can reach.
pub fn thin(triangles: &[[u32; 3]], place: &dyn Fn(u32) -> [f64; 3], most: usize) -> Thinned {
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
