//! Matrices of another code that make no body, and the messages about them.

use crate::foreign_files::{OneFile, mesh_of_nodes};
use eng_flexible::FlexibleError;
use eng_flexible::foreign::{ForeignMatrices, RowOrder};
use eng_flexible::mesh::Mesh;
use eng_flexible::read::matrix::{ForeignFreedoms, ForeignMatrix, MatrixFormat, read_matrix};
use eng_flexible::reduce::{Reduced, Request, Term, reduce};
use eng_flexible::solve::Modes;
use eng_flexible::units::MeshUnits;
use eng_system::mesh_files::Stated as _;

/// Four nodes at the corners of a tetrahedron, 1 m long.
fn mesh() -> Mesh {
    mesh_of_nodes(&[
        (1, [0.0; 3]),
        (2, [1.0, 0.0, 0.0]),
        (3, [0.0, 1.0, 0.0]),
        (4, [0.0, 0.0, 1.0]),
    ])
}

fn matrix(file: &str, freedoms: &[(u64, u8)], entries: Vec<(u32, u32, f64)>) -> ForeignMatrix {
    ForeignMatrix {
        file: file.into(),
        name: String::new(),
        rows: freedoms.len(),
        columns: freedoms.len(),
        symmetric: true,
        entries,
        freedoms: Some(ForeignFreedoms {
            rows: freedoms.to_vec(),
        }),
    }
}

/// All translations of the nodes of [`mesh`].
fn translations() -> Vec<(u64, u8)> {
    let of = |node: u64| (1u8..4).map(move |freedom| (node, freedom));
    (1..5).flat_map(of).collect()
}

/// Bars of 1 MN/m between all nodes and no other stiffness: rigid motion stretches none of them.
fn bars() -> ForeignMatrix {
    let mesh = mesh();
    let mut entries = Vec::new();
    for a in 0..4u32 {
        for b in a + 1..4 {
            let ends = [a, b].map(|node| mesh.nodes[node as usize].position);
            let d: [f64; 3] = std::array::from_fn(|k| ends[1][k] - ends[0][k]);
            let square: f64 = d.iter().map(|x| x * x).sum();
            for i in 0..6u32 {
                for j in 0..=i {
                    let node = |i: u32| if i < 3 { a } else { b };
                    let sign = if (i < 3) == (j < 3) { 1.0 } else { -1.0 };
                    let value = sign * 1e6 * d[i as usize % 3] * d[j as usize % 3] / square;
                    entries.push((3 * node(i) + i % 3, 3 * node(j) + j % 3, value));
                }
            }
        }
    }
    matrix("k", &translations(), entries)
}

/// A mass (kg) at each node, along x, y and z.
fn masses(along: [f64; 3]) -> ForeignMatrix {
    let entries = (0..12).map(|row: u32| (row, row, along[row as usize % 3]));
    matrix("m", &translations(), entries.collect())
}

fn reduced(mesh: Mesh, k: ForeignMatrix, m: ForeignMatrix) -> Result<Reduced, FlexibleError> {
    let matrices = ForeignMatrices {
        stiffness: k,
        mass: m,
        order: RowOrder::OfFile,
        units: MeshUnits::named("m_kg_s").unwrap(),
    };
    let normal = Term::Normal {
        modes: Modes::Count(2),
        fixed: vec![],
    };
    let request = Request {
        terms: vec![normal],
        matrices: Some(matrices),
        ..Request::default()
    };
    reduce(mesh, &request)
}

fn refused(mesh: Mesh, k: ForeignMatrix, m: ForeignMatrix, says: &str, advises: &str) {
    let error = reduced(mesh, k, m).unwrap_err();
    let text = error.to_string();
    assert!(text.contains(says), "{text}");
    assert!(!text.contains("NaN"), "{text}");
    assert!(error.advice().contains(advises), "{}", error.advice());
}

#[test]
fn masses_that_depend_on_the_direction_are_told() {
    let alike = reduced(mesh(), bars(), masses([2.0; 3])).unwrap();
    assert_eq!(alike.report.warnings, Vec::<String>::new());
    assert!((alike.report.body.mass - 8.0).abs() < 1e-12);
    let told = reduced(mesh(), bars(), masses([4.0, 2.0, 2.0])).unwrap();
    let warnings = told.report.warnings.join("\n");
    for part in [
        "16 kg along x",
        "8 kg along y",
        "8 kg along z",
        "10.667 kg, the mean",
    ] {
        assert!(warnings.contains(part), "{warnings}");
    }
    // rounding of a file of six digits
    let near = reduced(mesh(), bars(), masses([2.00001, 2.0, 2.0])).unwrap();
    assert_eq!(near.report.warnings, Vec::<String>::new());
}

/// Masses and springs in x alone: the message names the missing freedoms, and does not report a
/// resistance to rigid motion.
#[test]
fn a_chain_along_one_line_is_no_body() {
    let freedoms = [(1, 1), (2, 1), (3, 1)];
    let chain = mesh_of_nodes(&[(1, [0.0; 3]), (2, [1.0, 0.0, 0.0]), (3, [2.0, 0.0, 0.0])]);
    let springs = vec![
        (0, 0, 1e3),
        (1, 0, -1e3),
        (1, 1, 2e3),
        (2, 1, -1e3),
        (2, 2, 1e3),
    ];
    refused(
        chain,
        matrix("k", &freedoms, springs),
        matrix("m", &freedoms, (0..3).map(|row| (row, row, 1.0)).collect()),
        "freedoms without mass and stiffness: y and z of node 1, y and z of node 2, y and z of node 3",
        "masses and springs along a line",
    );
}

#[test]
fn a_stiffness_of_the_wrong_sign_is_told() {
    let mut turned = bars();
    turned.entries.iter_mut().for_each(|entry| entry.2 *= -1.0);
    refused(
        mesh(),
        turned,
        masses([2.0; 3]),
        "not positive semidefinite",
        "write −K",
    );
    let mut partly = bars();
    partly.entries.push((4, 4, -1e8));
    refused(
        mesh(),
        partly,
        masses([2.0; 3]),
        "at freedom 2 of node 2, and 1 of its 12 diagonal entries are negative",
        "negative springs",
    );
}

#[test]
fn exchanged_matrices_are_told() {
    let says = "but they do as mass and stiffness";
    let unit = masses([2.0; 3]);
    refused(mesh(), unit.clone(), bars(), says, "exchange the two files");
    // a mass that couples the nodes, as of solids
    let mut coupled = unit;
    for axis in 0..3u32 {
        for (a, b) in [(1u32, 0u32), (2, 1), (3, 2)] {
            coupled.entries.push((3 * a + axis, 3 * b + axis, 0.3));
        }
    }
    assert!(reduced(mesh(), bars(), coupled.clone()).is_ok());
    refused(mesh(), coupled, bars(), says, "exchange the two files");
}

#[test]
fn a_file_of_the_matrix_market_is_told_as_such() {
    let text = "%%MatrixMarket matrix coordinate real symmetric\n2 2 3\n1 1 2\n2 1 -2\n2 2 2\n";
    for format in [MatrixFormat::Abaqus, MatrixFormat::CalculiX] {
        let error =
            read_matrix(&OneFile(text.as_bytes().to_vec()), "k.mtx", format, "").unwrap_err();
        assert!(error.to_string().contains("MatrixMarket"), "{error}");
        assert!(error.advice().contains("line of sizes"), "{error}");
    }
    // its advice
    let stripped = OneFile(b"1 1 2\n2 1 -2\n2 2 2\n".to_vec());
    let found = read_matrix(&stripped, "k.mtx", MatrixFormat::Abaqus, "").unwrap();
    assert_eq!(
        (found.rows, found.symmetric, found.entries.len()),
        (2, true, 3)
    );
}
