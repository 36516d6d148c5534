//! Surfaces with fewer nodes.

use eng_report::animation::collapsed;
use eng_report::internals::quaternion::{cross, dot, minus};

type Vector = [f64; 3];

/// A ball of radius 1: `rows` circles of twice as many nodes, and two poles.
fn ball(rows: usize) -> (Vec<Vector>, Vec<[usize; 3]>) {
    let around = 2 * rows;
    let mut places = vec![[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]];
    for row in 1..=rows {
        let polar = std::f64::consts::PI * row as f64 / (rows + 1) as f64;
        for k in 0..around {
            let turn = std::f64::consts::TAU * k as f64 / around as f64;
            let (sine, cosine) = libm::sincos(turn);
            let (radius, height) = libm::sincos(polar);
            places.push([radius * cosine, radius * sine, height]);
        }
    }
    let at = |row: usize, k: usize| 2 + row * around + k % around;
    let mut triangles = Vec::new();
    for k in 0..around {
        triangles.push([0, at(0, k), at(0, k + 1)]);
        triangles.push([1, at(rows - 1, k + 1), at(rows - 1, k)]);
        for row in 0..rows - 1 {
            triangles.push([at(row, k), at(row + 1, k), at(row + 1, k + 1)]);
            triangles.push([at(row, k), at(row + 1, k + 1), at(row, k + 1)]);
        }
    }
    (places, triangles)
}

fn volume(places: &[Vector], triangles: &[[usize; 3]], stands: &[usize]) -> f64 {
    triangles
        .iter()
        .map(|t| {
            let [a, b, c] = t.map(|node| places[stands[node]]);
            dot(a, cross(b, c)) / 6.0
        })
        .sum()
}

#[test]
fn a_ball_keeps_its_size_with_a_tenth_of_its_nodes() {
    let (places, triangles) = ball(30);
    assert_eq!(places.len(), 1802);
    let stands = collapsed(&places, &triangles, 180);
    let mut kept: Vec<usize> = stands.clone();
    kept.sort_unstable();
    kept.dedup();
    assert_eq!(kept.len(), 180);
    assert!(kept.iter().all(|node| stands[*node] == *node));
    let all: Vec<usize> = (0..places.len()).collect();
    let (whole, small) = (
        volume(&places, &triangles, &all),
        volume(&places, &triangles, &stands),
    );
    assert!(small > 0.96 * whole && small < whole, "{small} {whole}");
    // closed as before: each edge that is left has two triangles
    let mut edges = std::collections::BTreeMap::new();
    for t in &triangles {
        let [a, b, c] = t.map(|node| stands[node]);
        if a != b && b != c && a != c {
            for (p, q) in [(a, b), (b, c), (c, a)] {
                *edges.entry((p.min(q), p.max(q))).or_insert(0) += 1;
            }
        }
    }
    assert!(edges.values().all(|count| *count == 2));
    // the nearest kept node is near
    for (node, end) in stands.iter().enumerate() {
        let off = minus(places[node], places[*end]);
        assert!(dot(off, off).sqrt() < 0.6, "{node}");
    }
}

#[test]
fn a_flat_sheet_keeps_its_rim() {
    let n = 20;
    let places: Vec<Vector> = (0..=n)
        .flat_map(|i| (0..=n).map(move |j| [i as f64, j as f64, 0.0]))
        .collect();
    let at = |i: usize, j: usize| i * (n + 1) + j;
    let triangles: Vec<[usize; 3]> = (0..n)
        .flat_map(|i| (0..n).map(move |j| (i, j)))
        .flat_map(|(i, j)| {
            [
                [at(i, j), at(i + 1, j), at(i + 1, j + 1)],
                [at(i, j), at(i + 1, j + 1), at(i, j + 1)],
            ]
        })
        .collect();
    let stands = collapsed(&places, &triangles, 60);
    let area: f64 = triangles
        .iter()
        .map(|t| {
            let [a, b, c] = t.map(|node| places[stands[node]]);
            0.5 * cross(minus(b, a), minus(c, a))[2]
        })
        .sum();
    assert!((area - 400.0).abs() < 1e-9, "{area}");
    for corner in [at(0, 0), at(n, 0), at(0, n), at(n, n)] {
        assert_eq!(stands[corner], corner);
    }
}

#[test]
fn what_is_no_surface_is_left_alone() {
    assert!(collapsed(&[], &[], 0).is_empty());
    let places = [[0.0; 3], [1.0, 0.0, 0.0], [f64::NAN; 3]];
    let stands = collapsed(&places, &[[0, 0, 1], [0, 1, 9], [0, 1, 2]], 1);
    assert_eq!(stands.len(), 3);
}
