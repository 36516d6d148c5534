//! Whole meshes through the Nastran reader.

use crate::nastran_deck;
use std::io::{self, Read};

use crate::nastran_deck::{Memory, close};
use crate::support::DATA;
use eng_flexible::mesh::{ElementKind, Mesh, Tie};
use eng_flexible::read::nastran::read_bulk;
use eng_flexible::{Files, Place};

/// The folder of test data, and one deck in memory.
struct Data(Memory);

impl Files for Data {
    fn open(&self, name: &str) -> io::Result<Box<dyn Read>> {
        self.0.open(name).or_else(|_| DATA.open(name))
    }
}

fn read(deck: &str) -> Mesh {
    let data = Data(Memory::new(&[("deck.bdf", deck)]));
    match read_bulk(&data, "deck.bdf") {
        Ok(mesh) => mesh,
        Err(error) => panic!("{error}"),
    }
}

/// Volume of a tetrahedron of the given corners.
fn volume(mesh: &Mesh, corners: [u32; 4]) -> f64 {
    let [a, b, c, d] = corners.map(|node| mesh.nodes[node as usize].position);
    let from_a = |p: [f64; 3]| [p[0] - a[0], p[1] - a[1], p[2] - a[2]];
    let (u, v, w) = (from_a(b), from_a(c), from_a(d));
    (u[0] * (v[1] * w[2] - v[2] * w[1])
        + u[1] * (v[2] * w[0] - v[0] * w[2])
        + u[2] * (v[0] * w[1] - v[1] * w[0]))
        / 6.0
}

/// Largest distance of a mid-side node from the middle of its edge, as a part of the edge's length.
fn worst_middle(mesh: &Mesh, edges: &[(usize, usize)], corners: usize) -> f64 {
    let mut worst = 0.0_f64;
    for element in &mesh.elements {
        let nodes = mesh.nodes_of(element);
        for (k, (i, j)) in edges.iter().enumerate() {
            let at = |n: usize| mesh.nodes[nodes[n] as usize].position;
            let (a, b, m) = (at(*i), at(*j), at(corners + k));
            let square = |v: [f64; 3]| v.iter().map(|x| x * x).sum::<f64>();
            let edge = square([b[0] - a[0], b[1] - a[1], b[2] - a[2]]);
            let off = square([0, 1, 2].map(|x: usize| m[x] - 0.5 * (a[x] + b[x])));
            worst = worst.max((off / edge).sqrt());
        }
    }
    worst
}

#[test]
fn bar_of_20_node_hexahedra() {
    let mesh = read("INCLUDE 'bar20.bdf.gz'\n");
    assert_eq!((mesh.nodes.len(), mesh.elements.len()), (849, 120));
    assert!(
        mesh.elements
            .iter()
            .all(|e| e.kind == ElementKind::Hexahedron20)
    );
    // every mid-side node is in the middle of the edge that the order of the mesh says
    let edges = [
        (0, 1),
        (1, 2),
        (2, 3),
        (3, 0),
        (4, 5),
        (5, 6),
        (6, 7),
        (7, 4),
        (0, 4),
        (1, 5),
        (2, 6),
        (3, 7),
    ];
    assert!(worst_middle(&mesh, &edges, 8) < 1e-6);
    assert_eq!(mesh.materials[0].young, 2.06e11);
    assert_eq!(mesh.materials[0].poisson, 0.3);
    assert_eq!(mesh.materials[0].density, 7850.0);
    assert_eq!(mesh.sets["pid:1"].nodes().len(), 849);
    let end = mesh.nodes.iter().filter(|node| node.position[0] == 0.0);
    assert_eq!(end.count(), 29);
}

#[test]
fn bar_of_8_node_hexahedra() {
    let mesh = read("INCLUDE 'bar8.bdf.gz'\n");
    assert_eq!((mesh.nodes.len(), mesh.elements.len()), (1435, 960));
    let total: f64 = mesh
        .elements
        .iter()
        .map(|element| {
            let n = mesh.nodes_of(element);
            [
                [0, 1, 3, 4],
                [1, 2, 3, 6],
                [4, 6, 5, 1],
                [4, 7, 6, 3],
                [1, 3, 4, 6],
            ]
            .iter()
            .map(|corners| volume(&mesh, corners.map(|i: usize| n[i])))
            .sum::<f64>()
        })
        .sum();
    // 0.4 × 0.04 × 0.06 m of 7850 kg/m³; coordinates are rounded to 1 nm
    assert!((total * 7850.0 - 7.536).abs() < 1e-8, "{total}");
}

#[test]
fn crankshaft() {
    let mesh = read("INCLUDE 'crank_m.bdf.gz'\n");
    assert_eq!((mesh.nodes.len(), mesh.elements.len()), (31_277, 17_384));
    assert_eq!(mesh.connectivity.len(), 173_840);
    assert!(
        mesh.nodes
            .iter()
            .enumerate()
            .all(|(i, n)| n.id == i as u64 + 1)
    );
    let volumes = mesh
        .elements
        .iter()
        .map(|element| {
            let nodes = mesh.nodes_of(element);
            volume(&mesh, [nodes[0], nodes[1], nodes[2], nodes[3]])
        })
        .collect::<Vec<_>>();
    assert!(volumes.iter().all(|volume| *volume > 0.0));
    // straight edges cut the rounds: 22.542 of the exact 22.738 kg
    let mass = 7850.0 * volumes.iter().sum::<f64>();
    assert!((mass - 22.542).abs() < 1e-3, "{mass}");
    // curved edges bulge, wrong ones would be off by half an edge
    let edges = [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)];
    let worst = worst_middle(&mesh, &edges, 4);
    assert!(worst < 0.2, "{worst}");
    assert_eq!(
        mesh.unread
            .iter()
            .map(|unread| (unread.name.as_str(), unread.count))
            .collect::<Vec<_>>(),
        [("EIGRL", 1), ("PARAM", 2)]
    );
}

#[test]
fn crankshaft_with_spiders() {
    for name in ["rbe2", "rbe3"] {
        let mesh = read(&format!(
            "INCLUDE 'crank_m.bdf.gz'\nINCLUDE 'crank_m_{name}.bdf.gz'\n"
        ));
        assert_eq!(mesh.nodes.len(), 31_288);
        assert_eq!(mesh.ties.len(), 11);
        assert_eq!(mesh.interface.len(), 11);
        assert!(
            mesh.interface
                .iter()
                .all(|freedoms| freedoms.components == 63)
        );
        let sizes =
            mesh.ties
                .iter()
                .map(|tie| match tie {
                    Tie::Rigid {
                        independent,
                        dependent,
                        ..
                    } => {
                        assert!(
                            dependent.iter().all(|(_, components)| *components
                                == if name == "rbe2" { 63 } else { 0 })
                        );
                        (*independent, dependent.len())
                    }
                    Tie::Averaging {
                        reference,
                        reference_components,
                        independent,
                        ..
                    } => {
                        assert_eq!(*reference_components, 63);
                        assert!(independent.iter().all(|(_, w, c)| (*w, *c) == (1.0, 7)));
                        (*reference, independent.len())
                    }
                    Tie::Equation { .. } => panic!("an equation"),
                })
                .collect::<Vec<_>>();
        // the first main journal: 234 nodes on a cylinder of 55 mm about the reference node
        let (reference, count) = sizes[0];
        assert_eq!(count, 234);
        let centre = mesh.nodes[reference as usize];
        assert_eq!(centre.id, 9_000_001);
        close(centre.position[0], 0.013, 1.0);
        let on_journal = match &mesh.ties[0] {
            Tie::Rigid { dependent, .. } => dependent.iter().map(|(node, _)| *node).collect(),
            Tie::Averaging { independent, .. } => {
                independent.iter().map(|(node, ..)| *node).collect()
            }
            Tie::Equation { .. } => Vec::new(),
        };
        for node in on_journal {
            let [_, y, z] = mesh.nodes[node as usize].position;
            assert!(((y * y + z * z).sqrt() - 0.0275).abs() < 2e-9);
        }
    }
}

#[test]
fn a_cut_file_is_told() {
    let mut bytes = Vec::new();
    DATA.open("bar8.bdf.gz")
        .and_then(|mut file| file.read_to_end(&mut bytes))
        .expect("test data");
    bytes.truncate(bytes.len() / 2);
    let mut files = Memory::default();
    files.0.insert("deck.bdf".into(), bytes);
    let problem = nastran_deck::problem_of(&files);
    assert!(matches!(problem.place, Place::Line(100..)), "{problem}");
    assert!(
        problem.problem.contains("reading stopped here"),
        "{problem}"
    );
}
