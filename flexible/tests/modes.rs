//! Mode sets of an elastic box against dense solutions of the whole structure.

use crate::systems;
use eng_flexible::modes::interface::Interface;
use eng_flexible::modes::normal::normal_modes;
use eng_flexible::modes::statics::{attachment_modes, constraint_modes};
use eng_flexible::modes::{Boundary, Candidate, Load, ModeSet, Structure};
use eng_flexible::solve::Modes;
use eng_flexible::sparse::{SymmetricMatrix, SymmetricOperator};
use faer::prelude::Solve;

const ELEMENTS: [u32; 3] = [6, 2, 3];

/// The six rigid motions of the box's nodes, x running fastest, edge 1 m.
fn motions() -> Vec<f64> {
    let nodes = ELEMENTS.map(|n| n + 1);
    let mut places = Vec::new();
    for z in 0..nodes[2] {
        for y in 0..nodes[1] {
            for x in 0..nodes[0] {
                places.push([f64::from(x), f64::from(y), f64::from(z)]);
            }
        }
    }
    let size = 3 * places.len();
    let mut out = vec![0.0; 6 * size];
    for (node, [x, y, z]) in places.into_iter().enumerate() {
        let turns = [[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]];
        for k in 0..3 {
            out[k * size + 3 * node + k] = 1.0;
            for i in 0..3 {
                out[(3 + k) * size + 3 * node + i] = turns[k][i];
            }
        }
    }
    out
}

fn node(x: u32, y: u32, z: u32) -> u32 {
    let nodes = ELEMENTS.map(|n| n + 1);
    (z * nodes[1] + y) * nodes[0] + x
}

fn unit(label: &str, node: u32, axis: u32) -> Load {
    Load {
        label: label.into(),
        entries: vec![(3 * node + axis, 1.0)],
    }
}

fn interface() -> Vec<Load> {
    let end = node(6, 1, 2);
    vec![
        unit("left.x", node(0, 0, 0), 0),
        unit("left.y", node(0, 0, 0), 1),
        unit("left.z", node(0, 2, 3), 2),
        unit("middle.y", node(3, 1, 1), 1),
        // a load spread over two nodes
        Load {
            label: "right.x".into(),
            entries: vec![(3 * end, 0.5), (3 * node(6, 1, 1), 0.5)],
        },
        unit("right.y", end, 1),
        unit("right.z", end, 2),
    ]
}

fn candidates(name: &str, size: usize, vectors: &[f64]) -> Vec<Candidate> {
    vectors
        .chunks_exact(size)
        .enumerate()
        .map(|(i, vector)| Candidate {
            label: format!("{name} {}", i + 1),
            vector: vector.to_vec(),
            noise: 0.0,
        })
        .collect()
}

fn product(matrix: &SymmetricMatrix, x: &[f64]) -> Vec<f64> {
    let mut y = vec![0.0; x.len()];
    matrix.apply(x.len() / matrix.size(), x, &mut y);
    y
}

fn dot(x: &[f64], y: &[f64]) -> f64 {
    x.iter().zip(y).map(|(x, y)| x * y).sum()
}

fn check_orthonormal(k: &SymmetricMatrix, m: &SymmetricMatrix, set: &ModeSet) {
    let size = k.size();
    for (i, (x, lambda)) in set
        .vectors
        .chunks_exact(size)
        .zip(&set.eigenvalues)
        .enumerate()
    {
        let (kx, mx) = (product(k, x), product(m, x));
        for (j, (y, other)) in set
            .vectors
            .chunks_exact(size)
            .zip(&set.eigenvalues)
            .enumerate()
        {
            let (mass, stiffness) = (dot(y, &mx), dot(y, &kx));
            let (one, own) = if i == j { (1.0, *lambda) } else { (0.0, 0.0) };
            assert!((mass - one).abs() < 1e-9, "{i} {j}: {mass}");
            assert!(
                (stiffness - own).abs() < 1e-8 * (lambda * other).sqrt(),
                "{i} {j}: {stiffness}"
            );
        }
    }
}

/// With static modes, the reduced box has the displacements of the whole one under interface loads.
#[test]
fn static_modes_make_static_answers_exact() {
    let (k, m) = systems::elastic_box(ELEMENTS);
    let size = k.size();
    let structure = Structure::free(&k, &m, motions()).unwrap();
    let loads = interface();
    let statics = attachment_modes(&structure, &loads).unwrap();
    let normal = normal_modes(None, &structure, Modes::Count(4), &Boundary::AsIs).unwrap();
    let mut all = candidates("static", size, &statics);
    all.extend(candidates("normal", size, &normal.vectors));
    let set = ModeSet::new(&structure, all).unwrap();
    assert_eq!((set.len(), set.dropped.len()), (11, 0));
    check_orthonormal(&k, &m, &set);
    // a dense solution with inertia relief: K + M R RᵀM is regular and gives the relieved displacement in mean axes
    let rigid = motions();
    let mr = product(&m, &rigid);
    let gram = faer::Mat::from_fn(6, 6, |i, j| {
        dot(
            &rigid[i * size..(i + 1) * size],
            &mr[j * size..(j + 1) * size],
        )
    });
    let inverse = gram.partial_piv_lu();
    let relief = |f: &[f64]| -> Vec<f64> {
        let share = faer::Mat::from_fn(6, 1, |i, _| dot(&rigid[i * size..(i + 1) * size], f));
        let c = inverse.solve(&share);
        (0..size)
            .map(|row| f[row] - (0..6).map(|i| mr[i * size + row] * c[(i, 0)]).sum::<f64>())
            .collect()
    };
    let dense = systems::dense(&k);
    let stabilised = faer::Mat::from_fn(size, size, |i, j| {
        dense[(i, j)]
            + 1e4
                * (0..6)
                    .map(|a| mr[a * size + i] * mr[a * size + j])
                    .sum::<f64>()
    });
    let factor = stabilised.partial_piv_lu();
    let mut f = vec![0.0; size];
    for (number, load) in loads.iter().enumerate() {
        for (freedom, x) in &load.entries {
            f[*freedom as usize] += x * (1.0 + number as f64);
        }
    }
    let balanced = relief(&f);
    let exact = factor.solve(&faer::Mat::from_fn(size, 1, |i, _| balanced[i]));
    // reduced: a_i = φ_i·f / ω_i²
    let mut reduced = vec![0.0; size];
    for (x, lambda) in set.vectors.chunks_exact(size).zip(&set.eigenvalues) {
        let a = dot(x, &f) / lambda;
        for (u, x) in reduced.iter_mut().zip(x) {
            *u += a * x;
        }
    }
    let largest = (0..size).fold(0.0_f64, |w, i| w.max(exact[(i, 0)].abs()));
    for i in 0..size {
        let miss = (reduced[i] - exact[(i, 0)]).abs() / largest;
        assert!(miss < 1e-8, "freedom {i}: {miss:e}");
    }
}

#[test]
fn normal_modes_of_a_free_box_are_its_elastic_ones() {
    let (k, m) = systems::elastic_box(ELEMENTS);
    let structure = Structure::free(&k, &m, motions()).unwrap();
    let found = normal_modes(None, &structure, Modes::Count(12), &Boundary::AsIs).unwrap();
    let all = systems::dense_eigenvalues(&k, &m);
    for (found, exact) in found.eigenvalues.iter().zip(&all[6..]) {
        assert!((found / exact - 1.0).abs() < 1e-9, "{found} {exact}");
    }
    let set = ModeSet::new(&structure, candidates("normal", k.size(), &found.vectors)).unwrap();
    check_orthonormal(&k, &m, &set);
}

/// Constraint and fixed-interface modes: frequencies of the free box from above, converging; the interface's
/// own span exact.
#[test]
fn craig_bampton_sets_converge_from_above() {
    let (k, m) = systems::elastic_box(ELEMENTS);
    let size = k.size();
    let all = systems::dense_eigenvalues(&k, &m);
    let held: Vec<u32> = [node(0, 0, 0), node(0, 2, 3), node(6, 1, 1), node(6, 2, 0)]
        .iter()
        .flat_map(|n| (0..3).map(move |axis| 3 * n + axis))
        .collect();
    let structure = Structure::free(&k, &m, motions()).unwrap();
    let rows: Vec<Load> = held
        .iter()
        .map(|freedom| Load {
            label: format!("freedom {freedom}"),
            entries: vec![(*freedom, 1.0)],
        })
        .collect();
    let constraint = constraint_modes(&structure, &rows).unwrap();
    // the same by loads
    let looked = Interface::new(&structure, &rows).unwrap();
    assert_eq!((looked.left(), looked.plain()), (0, Some(held.clone())));
    let by_loads = looked
        .constraint_modes(&attachment_modes(&structure, &rows).unwrap())
        .unwrap();
    for (x, y) in constraint.iter().zip(&by_loads) {
        assert!((x - y).abs() < 1e-10, "{x} {y}");
    }
    for (mode, freedom) in constraint.chunks_exact(size).zip(&held) {
        for other in &held {
            let expected = if other == freedom { 1.0 } else { 0.0 };
            assert!((mode[*other as usize] - expected).abs() < 1e-12);
        }
        let force = product(&k, mode);
        let scale = force.iter().fold(0.0_f64, |w, x| w.max(x.abs()));
        for (row, x) in force.iter().enumerate() {
            assert!(
                held.contains(&(row as u32)) || x.abs() < 1e-9 * scale,
                "row {row}: {x}"
            );
        }
    }
    let misses: Vec<f64> = [4, 16]
        .into_iter()
        .map(|count| {
            let fixed = normal_modes(
                None,
                &structure,
                Modes::Count(count),
                &Boundary::Fixed(rows.clone()),
            )
            .unwrap();
            let mut sum = candidates("constraint", size, &constraint);
            sum.extend(candidates("fixed", size, &fixed.vectors));
            let set = ModeSet::new(&structure, sum).unwrap();
            // twelve constraint modes hold the six rigid motions, which are no modes of the set
            assert_eq!(set.len() + set.dropped.len(), 12 + count);
            assert_eq!(set.dropped.len(), 6);
            check_orthonormal(&k, &m, &set);
            let miss = set.eigenvalues[0] / all[6] - 1.0;
            assert!(miss > -1e-9, "{miss}");
            miss
        })
        .collect();
    assert!(
        misses[1] < 0.3 * misses[0] && misses[1] < 0.02,
        "{misses:?}"
    );
}

#[test]
fn what_depends_on_the_rest_is_dropped_and_named() {
    let (k, m) = systems::elastic_box(ELEMENTS);
    let size = k.size();
    let structure = Structure::free(&k, &m, motions()).unwrap();
    let statics = attachment_modes(&structure, &interface()).unwrap();
    let mut all = candidates("static", size, &statics);
    let sum: Vec<f64> = (0..size)
        .map(|i| statics[i] - 3.0 * statics[size + i])
        .collect();
    all.push(Candidate {
        label: "sum".into(),
        vector: sum,
        noise: 0.0,
    });
    all.push(Candidate {
        label: "rigid".into(),
        vector: motions()[4 * size..5 * size].to_vec(),
        noise: 0.0,
    });
    let set = ModeSet::new(&structure, all).unwrap();
    let dropped: Vec<&str> = set.dropped.iter().map(|d| d.label.as_str()).collect();
    assert_eq!(dropped, ["sum", "rigid"]);
    assert_eq!(set.len(), 7);
}

#[test]
fn a_supported_box_needs_no_relief() {
    let (k, m) = systems::elastic_box(ELEMENTS);
    let held: Vec<bool> = (0..k.size())
        .map(|i| i % 21 == 0 || i % 21 == 1 || i % 21 == 2)
        .collect();
    let (k, m) = (k.without(&held).unwrap(), m.without(&held).unwrap());
    let structure = Structure::supported(&k, &m);
    let load = Load {
        label: "tip".into(),
        entries: vec![(k.size() as u32 - 1, 1.0)],
    };
    let modes = attachment_modes(&structure, std::slice::from_ref(&load)).unwrap();
    let force = product(&k, &modes);
    for (i, x) in force.iter().enumerate() {
        let expected = if i + 1 == k.size() { 1.0 } else { 0.0 };
        assert!((x - expected).abs() < 1e-9, "{i}: {x}");
    }
    assert!(load.displacement(&modes) > 0.0);
}

#[test]
fn a_mechanism_and_a_held_free_body_are_told() {
    let (k, m) = systems::elastic_box(ELEMENTS);
    // the body is not supported, but the request states that it is
    let structure = Structure::supported(&k, &m);
    assert!(attachment_modes(&structure, &interface()).is_err());
    let mut held = vec![false; k.size()];
    held[0] = true;
    let (fewer_k, fewer_m) = (k.without(&held).unwrap(), m.without(&held).unwrap());
    let size = k.size();
    let cut: Vec<f64> = motions()
        .chunks_exact(size)
        .flat_map(|v| v[1..].to_vec())
        .collect();
    let error = Structure::free(&fewer_k, &fewer_m, cut).unwrap_err();
    assert!(
        error.to_string().contains("resists its rigid motion"),
        "{error}"
    );
}

/// The mean over some nodes, as in an averaging tie.
fn mean(label: &str, nodes: &[u32], axis: u32) -> Load {
    Load {
        label: label.into(),
        entries: nodes
            .iter()
            .map(|n| (3 * n + axis, 1.0 / nodes.len() as f64))
            .collect(),
    }
}

/// `Zᵀ A Z`, where the columns of Z span the motions that the rows allow. Each row gives up the freedom of its first
/// entry.
fn restricted(matrix: &SymmetricMatrix, rows: &[Load]) -> SymmetricMatrix {
    let size = matrix.size();
    let given_up: Vec<u32> = rows.iter().map(|row| row.entries[0].0).collect();
    let kept: Vec<u32> = (0..size as u32).filter(|f| !given_up.contains(f)).collect();
    let columns: Vec<Vec<f64>> = kept
        .iter()
        .map(|freedom| {
            let mut z = vec![0.0; size];
            z[*freedom as usize] = 1.0;
            for row in rows {
                let (own, factor) = row.entries[0];
                let other = row.entries.iter().find(|(f, _)| f == freedom);
                z[own as usize] = other.map_or(0.0, |(_, x)| -x / factor);
            }
            z
        })
        .collect();
    let images: Vec<Vec<f64>> = columns.iter().map(|z| product(matrix, z)).collect();
    let mut entries = Vec::new();
    for (i, z) in columns.iter().enumerate() {
        for (j, image) in images.iter().enumerate().take(i + 1) {
            entries.push((i as u32, j as u32, dot(z, image)));
        }
    }
    SymmetricMatrix::from_triplets(kept.len(), &entries).unwrap()
}

/// Mean motions of faces and a node, held together: constraint modes by their definition, fixed modes against
/// a dense solution.
#[test]
fn mean_motions_are_held_like_freedoms() {
    let (k, m) = systems::elastic_box(ELEMENTS);
    let size = k.size();
    let structure = Structure::free(&k, &m, motions()).unwrap();
    let left: Vec<u32> = (0..4)
        .flat_map(|z| (0..3).map(move |y| node(0, y, z)))
        .collect();
    let right: Vec<u32> = (0..4).map(|z| node(6, 1, z)).collect();
    let mut rows: Vec<Load> = (0..3).map(|axis| mean("left", &left, axis)).collect();
    rows.extend((1..3).map(|axis| mean("right", &right, axis)));
    // turning about x, by the upper and lower edge
    rows.push(Load {
        label: "left.rx".into(),
        entries: vec![(3 * node(1, 0, 3) + 1, 0.5), (3 * node(1, 1, 0) + 1, -0.5)],
    });
    rows.push(unit("middle.z", node(3, 1, 1), 2));
    let looked = Interface::new(&structure, &rows).unwrap();
    assert_eq!((looked.left(), looked.plain()), (0, None));
    let modes = constraint_modes(&structure, &rows).unwrap();
    let space = restricted(&k, &rows);
    for (number, mode) in modes.chunks_exact(size).enumerate() {
        for (other, row) in rows.iter().enumerate() {
            let expected = if other == number { 1.0 } else { 0.0 };
            assert!((row.displacement(mode) - expected).abs() < 1e-11);
        }
        // forces are along the rows alone, so they do no work on any other motion
        let force = product(&k, mode);
        // one of these modes is a rigid motion, and without forces
        let scale = k
            .values()
            .iter()
            .chain(mode)
            .fold(0.0_f64, |w, x| w.max(x.abs()));
        let given_up: Vec<u32> = rows.iter().map(|row| row.entries[0].0).collect();
        for freedom in (0..size as u32).filter(|f| !given_up.contains(f)) {
            let mut work = force[freedom as usize];
            for row in &rows {
                if let Some((_, x)) = row.entries.iter().find(|(f, _)| *f == freedom) {
                    let (own, factor) = row.entries[0];
                    work -= x / factor * force[own as usize];
                }
            }
            assert!(work.abs() < 1e-12 * scale, "{freedom}: {work}");
        }
    }
    let exact = systems::dense_eigenvalues(&space, &restricted(&m, &rows));
    for request in [Modes::Count(9), Modes::UpTo(0.5 * (exact[8] + exact[9]))] {
        let found =
            normal_modes(None, &structure, request, &Boundary::Fixed(rows.clone())).unwrap();
        assert_eq!((found.eigenvalues.len(), found.sturm.count), (9, 9));
        for (value, exact) in found.eigenvalues.iter().zip(&exact) {
            assert!((value / exact - 1.0).abs() < 1e-9, "{value} {exact}");
        }
        for vector in found.vectors.chunks_exact(size) {
            let largest = vector.iter().fold(0.0_f64, |w, x| w.max(x.abs()));
            for row in &rows {
                assert!(row.displacement(vector).abs() < 1e-11 * largest);
            }
        }
    }
}

/// Means along a line leave axial motion and spin: these are neither fixed modes nor in the way.
#[test]
fn what_collinear_journals_leave_is_no_mode() {
    let (k, m) = systems::elastic_box(ELEMENTS);
    let size = k.size();
    let structure = Structure::free(&k, &m, motions()).unwrap();
    let rows: Vec<Load> = [0, 3, 6]
        .iter()
        .flat_map(|x| {
            let pair = [node(*x, 1, 1), node(*x, 1, 2)];
            [1, 2].map(|axis| mean(&format!("journal {x}"), &pair, axis))
        })
        .collect();
    let looked = Interface::new(&structure, &rows).unwrap();
    assert_eq!(looked.left(), 2);
    let modes = constraint_modes(&structure, &rows).unwrap();
    for (number, mode) in modes.chunks_exact(size).enumerate() {
        for (other, row) in rows.iter().enumerate() {
            let expected = if other == number { 1.0 } else { 0.0 };
            assert!((row.displacement(mode) - expected).abs() < 1e-10);
        }
    }
    let fixed = normal_modes(
        None,
        &structure,
        Modes::Count(5),
        &Boundary::Fixed(rows.clone()),
    )
    .unwrap();
    let exact = systems::dense_eigenvalues(&restricted(&k, &rows), &restricted(&m, &rows));
    assert!(exact[1].abs() < 1e-6 * exact[2]);
    for (value, exact) in fixed.eigenvalues.iter().zip(&exact[2..]) {
        assert!((value / exact - 1.0).abs() < 1e-9, "{value} {exact}");
    }
    let mut all = candidates("constraint", size, &modes);
    all.extend(candidates("fixed", size, &fixed.vectors));
    let set = ModeSet::new(&structure, all).unwrap();
    // of six constraint modes four are rigid motions
    assert_eq!((set.len(), set.dropped.len()), (7, 4), "{:?}", set.dropped);
    check_orthonormal(&k, &m, &set);
    let free = systems::dense_eigenvalues(&k, &m);
    for (value, exact) in set.eigenvalues.iter().zip(&free[6..]) {
        assert!(value / exact - 1.0 > -1e-9, "{value} {exact}");
    }
    // the static answer to loads at the interface that balance each other is exact
    let bending = Load {
        label: "bending".into(),
        entries: [(0, 1.0), (2, -2.0), (4, 1.0)]
            .iter()
            .flat_map(|(row, load)| rows[*row].entries.iter().map(move |(f, x)| (*f, x * load)))
            .collect(),
    };
    let own = attachment_modes(&structure, std::slice::from_ref(&bending)).unwrap();
    let exact = bending.displacement(&own);
    let spanned: f64 = set
        .vectors
        .chunks_exact(size)
        .zip(&set.eigenvalues)
        .map(|(mode, value)| bending.displacement(mode).powi(2) / value)
        .sum();
    assert!(
        (spanned / exact - 1.0).abs() < 1e-9,
        "{spanned:e} {exact:e}"
    );
}

#[test]
fn an_interface_that_repeats_itself_is_told() {
    let (k, m) = systems::elastic_box(ELEMENTS);
    let structure = Structure::free(&k, &m, motions()).unwrap();
    let (a, b) = (node(0, 0, 0), node(6, 2, 3));
    let rows = vec![
        unit("left.x", a, 0),
        unit("right.x", b, 0),
        mean("both.x", &[a, b], 0),
    ];
    let error = constraint_modes(&structure, &rows).unwrap_err().to_string();
    assert!(
        error.ends_with("moves only with the other freedoms of the interface"),
        "{error}"
    );
    // of freedoms that are held anyway a mean says nothing new
    normal_modes(None, &structure, Modes::Count(2), &Boundary::Fixed(rows)).unwrap();
    let rows = vec![mean("one.x", &[a, b], 0), mean("two.x", &[b, a], 0)];
    let error =
        normal_modes(None, &structure, Modes::Count(2), &Boundary::Fixed(rows)).unwrap_err();
    let error = error.to_string();
    assert!(
        error.ends_with("moves only with the other freedoms of the interface"),
        "{error}"
    );
    let none = vec![Load {
        label: "held".into(),
        entries: vec![],
    }];
    let error = constraint_modes(&structure, &none).unwrap_err();
    assert_eq!(error.to_string(), "held is held by a support already");
}
