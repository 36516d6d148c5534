//! Ties and supports: elimination, chains, frames, held averages.

use crate::fe_meshes::*;
use eng_flexible::fe::{Assembled, Reduction, Rules, assemble};
use eng_flexible::mesh::{ElementKind, Frame, Mesh, Support, Tie};
use eng_flexible::solve::{EigenOptions, Modes, lowest_modes};

const ALL: u8 = 0b111111;

fn bar_with_end() -> (Mesh, Vec<u32>, Vec<u32>) {
    let mesh = bar(ElementKind::Hexahedron20, [4, 1, 2], [0.4, 0.04, 0.06]);
    let root = nodes_where(&mesh, |x| x[0] < 1e-9);
    let end = nodes_where(&mesh, |x| x[0] > 0.4 - 1e-9);
    (mesh, root, end)
}

fn rigid(id: u64, independent: u32, nodes: &[u32]) -> Tie {
    Tie::Rigid {
        id,
        independent,
        dependent: nodes.iter().map(|node| (*node, ALL)).collect(),
    }
}

fn averaging(id: u64, reference: u32, nodes: &[u32]) -> Tie {
    Tie::Averaging {
        id,
        reference,
        reference_components: ALL,
        independent: nodes.iter().map(|node| (*node, 1.0, 0b111)).collect(),
    }
}

fn reduced(mesh: &Mesh, held: &[Support]) -> (Assembled, Reduction) {
    let structure = assemble(mesh, &Rules::default()).unwrap();
    let reduction = Reduction::new(mesh, &structure, held).unwrap();
    (structure, reduction)
}

/// A turn about an axis that is none of the basic ones.
fn skew_frame() -> Frame {
    let (s, c) = 0.6_f64.sin_cos();
    let (t, d) = 0.3_f64.sin_cos();
    // about z, then about the new y
    Frame {
        rotation: [[c * d, -s, c * t], [s * d, c, s * t], [-t, 0.0, d]],
    }
}

/// Numbers without pattern.
fn wild(count: usize) -> Vec<f64> {
    (0..count)
        .map(|i| (i as f64 * 0.7351).sin() + 0.3 * (i as f64 * 1.917).cos())
        .collect()
}

fn at(structure: &Assembled, full: &[f64], node: u32) -> [f64; 3] {
    let first = structure.freedoms.of(node).start;
    [0, 1, 2].map(|axis| full[first + axis])
}

/// The congruence `Tᵀ A T` with dense matrices.
fn dense_reduced(structure: &Assembled, reduction: &Reduction) -> Vec<Vec<f64>> {
    let size = reduction.size();
    let mut result = Vec::new();
    for column in 0..size {
        let unit: Vec<f64> = (0..size)
            .map(|i| f64::from(u8::from(i == column)))
            .collect();
        let full = reduction.expand(1, &unit);
        result.push(reduction.gather(1, &times(&structure.stiffness, &full)));
    }
    result
}

#[test]
fn the_reduced_matrix_is_the_congruence_also_with_frames_and_chains() {
    let (mut mesh, root, end) = bar_with_end();
    let centre = add_node(&mut mesh, [0.45, 0.01, 0.02]);
    let far = add_node(&mut mesh, [0.6, -0.1, 0.1]);
    mesh.frames.push(skew_frame());
    for node in [centre, end[2], root[3], root[4]] {
        mesh.nodes[node as usize].frame = Some(0);
    }
    // a chain in the order in which it can't be resolved
    mesh.ties.push(rigid(5, centre, &[far]));
    mesh.ties.push(averaging(9, centre, &end));
    mesh.ties.push(Tie::Equation {
        id: 11,
        terms: vec![(root[0], 1, 2.0), (root[1], 1, -1.0), (root[3], 0, 0.5)],
    });
    let supports = [
        Support {
            node: root[3],
            components: 0b101,
        },
        Support {
            node: root[4],
            components: 0b010,
        },
        Support {
            node: root[2],
            components: 0b111,
        },
    ];
    let (structure, reduction) = reduced(&mesh, &supports);
    let dense = dense_reduced(&structure, &reduction);
    let sparse = reduction.reduce(&structure.stiffness).unwrap();
    let most = largest(sparse.values());
    for (column, exact) in dense.iter().enumerate() {
        let unit: Vec<f64> = (0..dense.len())
            .map(|i| f64::from(u8::from(i == column)))
            .collect();
        for (x, y) in times(&sparse, &unit).iter().zip(exact) {
            assert!((x - y).abs() < 1e-12 * most, "{x} {y}");
        }
    }
    let full = reduction.expand(1, &wild(reduction.size()));
    // supports in their frames
    let frame = skew_frame().rotation;
    let along = |node: u32, axis: usize| -> f64 {
        let u = at(&structure, &full, node);
        (0..3).map(|k| frame[k][axis] * u[k]).sum()
    };
    assert!(along(root[3], 0).abs() < 1e-14 && along(root[3], 2).abs() < 1e-14);
    assert!(along(root[3], 1).abs() > 1e-3);
    assert!(along(root[4], 1).abs() < 1e-14);
    assert_eq!(at(&structure, &full, root[2]), [0.0; 3]);
    // the equation: the third freedom is held
    let balance = 2.0 * at(&structure, &full, root[0])[1] - at(&structure, &full, root[1])[1]
        + 0.5 * along(root[3], 0);
    assert!(balance.abs() < 1e-13);
    // the far node turns with the centre, which averages the face
    let range = structure.freedoms.of(centre);
    let turn = &full[range.start + 3..range.end];
    let arm = [0.15, -0.11, 0.08];
    let (u, v) = (at(&structure, &full, centre), at(&structure, &full, far));
    let expected = [
        u[0] + turn[1] * arm[2] - turn[2] * arm[1],
        u[1] + turn[2] * arm[0] - turn[0] * arm[2],
        u[2] + turn[0] * arm[1] - turn[1] * arm[0],
    ];
    for (x, y) in v.iter().zip(expected) {
        assert!((x - y).abs() < 1e-12, "{v:?} {expected:?}");
    }
}

/// Rotations count by the mean distance of the nodes; a node without weight is none of them.
#[test]
fn a_node_without_weight_leads_nothing() {
    let centre_of = |without_weight: bool| {
        let (mut mesh, root, end) = bar_with_end();
        let turning = add_node(&mut mesh, [0.4, 0.02, 0.03]);
        let centre = add_node(&mut mesh, [0.45, 0.01, 0.02]);
        mesh.ties.push(averaging(1, turning, &end));
        let mut independent: Vec<(u32, f64, u8)> =
            end.iter().map(|node| (*node, 1.0, 0b111)).collect();
        independent.push((turning, 2.0, ALL));
        if without_weight {
            independent.push((root[0], 0.0, ALL));
        }
        mesh.ties.push(Tie::Averaging {
            id: 2,
            reference: centre,
            reference_components: ALL,
            independent,
        });
        let (structure, reduction) = reduced(&mesh, &[]);
        let full = reduction.expand(1, &wild(reduction.size()));
        full[structure.freedoms.of(centre)].to_vec()
    };
    assert_eq!(centre_of(true), centre_of(false));
}

#[test]
fn a_force_on_an_averaging_centre_spreads_by_weight() {
    let (mut mesh, _, end) = bar_with_end();
    let centre = add_node(&mut mesh, [0.5, 0.1, -0.05]);
    mesh.ties.push(Tie::Averaging {
        id: 1,
        reference: centre,
        reference_components: ALL,
        independent: end
            .iter()
            .enumerate()
            .map(|(i, node)| (*node, 1.0 + 0.2 * i as f64, 0b111))
            .collect(),
    });
    let (structure, reduction) = reduced(&mesh, &[]);
    for component in 0..6 {
        let mut force = vec![0.0; structure.freedoms.size()];
        force[structure.freedoms.of(centre).start + component] = 1.0;
        let spread = reduction.gather(1, &force);
        // the sum and the moment about the centre are those of the force
        let mut sum = [0.0; 6];
        let mut nodes = 0;
        for (freedom, f) in reduction.free().iter().zip(&spread) {
            if *f == 0.0 {
                continue;
            }
            let (node, axis) = structure.freedoms.owner(*freedom as usize).unwrap();
            assert!(end.contains(&node));
            nodes += 1;
            let p = mesh.nodes[node as usize].position;
            let arm = [p[0] - 0.5, p[1] - 0.1, p[2] + 0.05];
            let axis = usize::from(axis);
            sum[axis] += f;
            sum[3 + (axis + 1) % 3] += arm[(axis + 2) % 3] * f;
            sum[3 + (axis + 2) % 3] -= arm[(axis + 1) % 3] * f;
        }
        assert!(nodes > 0);
        for (i, x) in sum.iter().enumerate() {
            let exact = f64::from(u8::from(i == component));
            assert!((x - exact).abs() < 1e-11, "{component}: {sum:?}");
        }
    }
    // through the weighted centre, by weight alone
    let total: f64 = (0..end.len()).map(|i| 1.0 + 0.2 * i as f64).sum();
    let mut middle = [0.0; 3];
    for (i, node) in end.iter().enumerate() {
        for (m, p) in middle.iter_mut().zip(mesh.nodes[*node as usize].position) {
            *m += (1.0 + 0.2 * i as f64) / total * p;
        }
    }
    mesh.nodes[centre as usize].position = middle;
    let (structure, reduction) = reduced(&mesh, &[]);
    let mut force = vec![0.0; structure.freedoms.size()];
    force[structure.freedoms.of(centre).start + 1] = 1.0;
    let spread = reduction.gather(1, &force);
    for (i, node) in end.iter().enumerate() {
        let freedom = structure.freedoms.of(*node).start as u32 + 1;
        let place = reduction.free().binary_search(&freedom).unwrap();
        let share = (1.0 + 0.2 * i as f64) / total;
        assert!(agrees(spread[place], share, 1e-11));
    }
}

#[test]
fn an_averaging_centre_can_be_held() {
    let (mut mesh, root, end) = bar_with_end();
    let first = add_node(&mut mesh, [0.0, 0.02, 0.03]);
    let second = add_node(&mut mesh, [0.4, 0.02, 0.03]);
    mesh.ties.push(averaging(1, first, &root));
    mesh.ties.push(averaging(2, second, &end));
    let (structure, reduction) = reduced(&mesh, &held(&[first, second], ALL));
    let solids = structure.freedoms.size() - 12;
    assert_eq!(reduction.size(), solids - 12);
    let full = reduction.expand(1, &wild(reduction.size()));
    for (nodes, centre) in [(&root, first), (&end, second)] {
        let origin = mesh.nodes[centre as usize].position;
        let mut mean = [0.0; 3];
        let mut turn = [0.0; 3];
        for node in nodes {
            let u = at(&structure, &full, *node);
            let p = mesh.nodes[*node as usize].position;
            let r = [0, 1, 2].map(|k: usize| p[k] - origin[k]);
            for k in 0..3 {
                mean[k] += u[k];
                turn[k] += r[(k + 1) % 3] * u[(k + 2) % 3] - r[(k + 2) % 3] * u[(k + 1) % 3];
            }
        }
        assert!(largest(&mean) < 1e-11, "{mean:?}");
        assert!(largest(&turn) < 1e-12, "{turn:?}");
        for freedom in structure.freedoms.of(centre) {
            assert!(full[freedom].abs() < 1e-11);
        }
    }
    // held once at one end and again through its nodes: redundant, not wrong
    let mut twice = held(&[first], ALL);
    twice.extend(held(&root, 0b111));
    let (structure, reduction) = reduced(&mesh, &twice);
    assert_eq!(
        reduction.size(),
        structure.freedoms.size() - 12 - 3 * root.len()
    );
    // frequencies lie between those with the face free and with the face clamped
    let lowest = |held: &[Support]| {
        let (structure, reduction) = reduced(&mesh, held);
        let stiffness = reduction.reduce_stiffness(&structure.stiffness).unwrap();
        let mass = reduction.reduce_mass(&structure.mass).unwrap();
        let options = EigenOptions::default();
        lowest_modes(&stiffness, &mass, Modes::Count(1), &options)
            .unwrap()
            .eigenvalues[0]
    };
    let (soft, hard) = (lowest(&held(&[first], ALL)), lowest(&held(&root, 0b111)));
    assert!(soft > 0.5 * hard && soft < hard, "{soft} {hard}");
}

#[test]
fn a_rigid_face_is_stiffer_than_an_averaged_one_and_holds_when_clamped() {
    let deflection = |make: fn(u64, u32, &[u32]) -> Tie| {
        let mut mesh = bar(ElementKind::Hexahedron20, [12, 2, 3], [0.4, 0.04, 0.06]);
        let root = nodes_where(&mesh, |x| x[0] < 1e-9);
        let end = nodes_where(&mesh, |x| x[0] > 0.4 - 1e-9);
        let tip = add_node(&mut mesh, [0.4, 0.02, 0.03]);
        mesh.ties.push(make(1, tip, &end));
        let (structure, reduction) = reduced(&mesh, &held(&root, 0b111));
        let mut force = vec![0.0; structure.freedoms.size()];
        let freedom = structure.freedoms.of(tip).start + 2;
        force[freedom] = 1000.0;
        solve(&structure, &reduction, &force)[freedom]
    };
    let (stiff, soft) = (deflection(rigid), deflection(averaging));
    // P L³/3EI + P L/(5/6 GA)
    let (width, height, length) = (0.04, 0.06, 0.4_f64);
    let moment: f64 = width * height * height * height / 12.0;
    let modulus = YOUNG / (2.0 * (1.0 + POISSON));
    let beam = 1000.0 * length.powi(3) / (3.0 * YOUNG * moment)
        + 1000.0 * length / (5.0 / 6.0 * modulus * width * height);
    assert!(stiff < soft);
    // the clamped root cannot contract sideways, so that the solid is a little stiffer
    assert!(
        agrees(stiff, beam, 0.02) && agrees(soft, beam, 0.02),
        "{stiff} {soft} {beam}"
    );
}

#[test]
fn contradictions_name_ties_nodes_and_components() {
    let (mesh, _, end) = bar_with_end();
    let tied = |ties: Vec<Tie>| {
        let mut mesh = mesh.clone();
        for position in [[0.5, 0.0, 0.0], [0.6, 0.1, 0.0]] {
            add_node(&mut mesh, position);
        }
        mesh.ties = ties;
        let structure = assemble(&mesh, &Rules::default()).unwrap();
        problem(Reduction::new(&mesh, &structure, &[]))
    };
    let count = mesh.nodes.len() as u32;
    let (one, two) = (count, count + 1);
    let id = |node: u32| u64::from(node) + 1;
    let twice = tied(vec![
        rigid(21, one, &end[..3]),
        rigid(22, two, &[end[1], one]),
    ]);
    assert!(twice.contains("21") && twice.contains("22"), "{twice}");
    assert!(twice.contains(&format!("node {}", id(end[1]))), "{twice}");
    let circle = tied(vec![
        rigid(31, one, &[two]),
        rigid(32, two, &[one]),
        rigid(33, end[0], &[one]),
    ]);
    assert!(circle.contains("two ties"), "{circle}");
    let circle = tied(vec![rigid(31, one, &[two, end[0]]), rigid(32, two, &[one])]);
    assert!(circle.contains("circle: 31, 32"), "{circle}");
    let selfish = tied(vec![rigid(41, one, &[one, two, end[0]])]);
    assert!(
        selfish.contains("41") && selfish.contains("itself"),
        "{selfish}"
    );
    let line: Vec<u32> = end
        .iter()
        .copied()
        .filter(|node| {
            let p = mesh.nodes[*node as usize].position;
            p[1] == 0.0
        })
        .collect();
    assert!(line.len() > 2);
    let spin = tied(vec![averaging(51, one, &line), rigid(52, one, &[two])]);
    assert!(spin.contains("51") && spin.contains("component"), "{spin}");
    let negative = tied(vec![
        Tie::Averaging {
            id: 61,
            reference: one,
            reference_components: 7,
            independent: vec![(end[0], -1.0, 7), (end[1], 1.0, 7)],
        },
        rigid(62, one, &[two]),
    ]);
    assert!(
        negative.contains("61") && negative.contains("weight"),
        "{negative}"
    );
    let nothing = tied(vec![
        Tie::Equation {
            id: 71,
            terms: vec![(end[0], 0, 0.0), (end[1], 0, 1.0)],
        },
        rigid(72, end[0], &[one, two]),
    ]);
    assert!(nothing.contains("equation 71"), "{nothing}");
}

#[test]
fn nodes_on_a_line_determine_what_they_can() {
    // the spin about the line through them is not requested
    let (mut mesh, _, end) = bar_with_end();
    let line: Vec<u32> = end
        .iter()
        .copied()
        .filter(|node| mesh.nodes[*node as usize].position[1] == 0.0)
        .collect();
    let centre = add_node(&mut mesh, [0.4, 0.0, 0.03]);
    mesh.ties.push(Tie::Averaging {
        id: 1,
        reference: centre,
        reference_components: 0b011111,
        independent: line.iter().map(|node| (*node, 1.0, 0b111)).collect(),
    });
    let structure = assemble(&mesh, &Rules::default()).unwrap();
    let reduction = Reduction::new(&mesh, &structure, &[]).unwrap();
    // the spin remains without stiffness, and a message reports it
    let message = problem(reduction.reduce_stiffness(&structure.stiffness));
    let id = mesh.nodes[centre as usize].id;
    assert!(
        message.contains(&format!("component 6 of node {id}")),
        "{message}"
    );
}
