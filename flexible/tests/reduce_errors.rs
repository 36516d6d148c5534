//! Messages and advice about bad meshes, matrices and shapes, as a user reads them.

use crate::fe_meshes;

use std::collections::BTreeMap;
use std::fmt::Write;

use crate::fe_meshes::bar;
use crate::foreign_files::{Dense, Layout, OneFile, Op2, op4_binary};
use eng_flexible::FlexibleError;
use eng_flexible::fe::{Rules, assemble};
use eng_flexible::foreign::{ForeignMatrices, MatrixFile, RowOrder};
use eng_flexible::markers::{MarkerPlace, MarkerRequest};
use eng_flexible::mesh::{Code, ElementKind, Mesh, Property, Section, ShellSection};
use eng_flexible::read::matrix::{
    ForeignFreedoms, ForeignMatrix, MatrixFormat, read_op2_matrix, read_op4,
};
use eng_flexible::read::{abaqus::read_inp, nastran::read_bulk};
use eng_flexible::reduce::{Interface, Request, Term, reduce};
use eng_flexible::solve::Modes;
use eng_flexible::units::MeshUnits;
use eng_system::mesh_files::Stated as _;

#[derive(Default)]
struct Answers(String);

impl Answers {
    fn note<T>(&mut self, what: &str, result: Result<T, impl Into<FlexibleError>>) {
        let error: FlexibleError = match result {
            Ok(_) => panic!("{what} is not refused"),
            Err(error) => error.into(),
        };
        writeln!(self.0, "{what}:\n  {error}\n  → {}", error.advice()).unwrap();
    }
}

fn request() -> Request {
    Request {
        terms: vec![Term::Normal {
            modes: Modes::Count(4),
            fixed: vec![],
        }],
        damping_up_to: 3000.0,
        ..Request::default()
    }
}

fn beam() -> Mesh {
    bar(ElementKind::Hexahedron8, [4, 2, 2], [0.4, 0.1, 0.1])
}

/// The mesh without the nodes that no element names.
fn compact(mut mesh: Mesh) -> Mesh {
    let mut used = BTreeMap::new();
    for node in &mesh.connectivity {
        used.insert(*node, 0u32);
    }
    for (place, index) in used.values_mut().enumerate() {
        *index = place as u32;
    }
    mesh.nodes = used.keys().map(|node| mesh.nodes[*node as usize]).collect();
    mesh.connectivity
        .iter_mut()
        .for_each(|node| *node = used[node]);
    mesh
}

/// Two cubes of eight bricks each, which share an edge: a hinge.
fn hinge() -> Mesh {
    let mut mesh = bar(ElementKind::Hexahedron8, [4, 2, 4], [0.4, 0.1, 0.4]);
    let keep: Vec<_> = mesh
        .elements
        .iter()
        .filter(|element| {
            let nodes = mesh.nodes_of(element);
            let middle = |axis: usize| {
                let sum: f64 = nodes
                    .iter()
                    .map(|n| mesh.nodes[*n as usize].position[axis])
                    .sum();
                sum / 8.0 > 0.2
            };
            middle(0) == middle(2)
        })
        .copied()
        .collect();
    let mut connectivity = Vec::new();
    let mut elements = Vec::new();
    for mut element in keep {
        let nodes = mesh.nodes_of(&element).to_vec();
        element.first = connectivity.len() as u32;
        connectivity.extend(nodes);
        elements.push(element);
    }
    mesh.elements = elements;
    mesh.connectivity = connectivity;
    compact(mesh)
}

#[test]
fn meshes() {
    let mut answers = Answers::default();
    answers.note(
        "a node that is not in the deck",
        read_bulk(
            &OneFile(
                b"BEGIN BULK\nGRID,1,,0.,0.,0.\nGRID,2,,1.,0.,0.\nGRID,3,,0.,1.,0.\nCTETRA,7,1,1,2,3,4\nPSOLID,1,1\nMAT1,1,2.+11,,.3,7850.\nENDDATA\n"
                    .to_vec(),
            ),
            "crank.bdf",
        ),
    );
    answers.note(
        "the same for Abaqus",
        read_inp(
            &OneFile(
                b"*NODE\n1,0,0,0\n2,1,0,0\n3,0,1,0\n*ELEMENT, TYPE=C3D4, ELSET=E\n7,1,2,3,4\n"
                    .to_vec(),
            ),
            "crank.inp",
            Code::Abaqus,
        ),
    );
    answers.note("a hinge", reduce(hinge(), &request()));
    let marker = Request {
        markers: vec![MarkerRequest {
            axes: eng_flexible::markers::MESH_AXES,
            name: "end".into(),
            place: MarkerPlace::Node(1),
        }],
        terms: vec![Term::Static(vec![Interface {
            marker: 0,
            components: 0b1,
        }])],
        ..request()
    };
    answers.note("a load on a hinge", reduce(hinge(), &marker));
    let mut parts = beam();
    parts
        .elements
        .retain(|element| !matches!(element.id % 4, 2));
    answers.note("two parts", reduce(compact(parts), &request()));
    let mut inverted = beam();
    let first = inverted.elements[5].first as usize;
    inverted.connectivity.swap(first, first + 1);
    answers.note("an inverted element", reduce(inverted, &request()));
    let mut flat = beam();
    for node in &mut flat.nodes {
        node.position[2] = 0.0;
    }
    answers.note("a flat mesh", reduce(flat, &request()));
    let mut shell = beam();
    shell.properties.push(Property {
        name: "skin".into(),
        material: Some(0),
        section: Section::Shell(ShellSection::plate(0.0)),
    });
    fe_meshes::add_element(&mut shell, ElementKind::Quadrilateral4, 1, &[0, 1, 2, 3]);
    answers.note("a shell without thickness", reduce(shell, &request()));
    let mut light = beam();
    light.materials[0].density = 0.0;
    answers.note("no mass", reduce(light, &request()));
    let mut negative = beam();
    negative.materials[0].density = -7850.0;
    answers.note("negative mass", reduce(negative, &request()));
    let fixed = Request {
        support: vec![Interface {
            marker: 0,
            components: 0b111,
        }],
        ..marker.clone()
    };
    answers.note("held at one node", reduce(beam(), &fixed));
    let many = Request {
        terms: vec![Term::Normal {
            modes: Modes::Count(400),
            fixed: vec![],
        }],
        ..request()
    };
    answers.note("more modes than freedoms", reduce(beam(), &many));
    insta::assert_snapshot!(answers.0);
}

fn sparse(file: &str, size: usize, entries: Vec<(u32, u32, f64)>) -> ForeignMatrix {
    ForeignMatrix {
        file: file.into(),
        name: String::new(),
        rows: size,
        columns: size,
        symmetric: true,
        entries,
        freedoms: None,
    }
}

fn matrices(mesh: &Mesh) -> ForeignMatrices {
    let full = assemble(mesh, &Rules::default()).unwrap();
    let entries = |matrix: &eng_flexible::sparse::SymmetricMatrix| {
        let mut entries = Vec::new();
        for column in 0..matrix.size() {
            let (rows, values) = matrix.column(column);
            let values = rows.iter().zip(values);
            entries.extend(values.map(|(row, value)| (*row, column as u32, *value)));
        }
        entries
    };
    let size = full.freedoms.size();
    ForeignMatrices {
        stiffness: sparse("k.op4", size, entries(&full.stiffness)),
        mass: sparse("m.op4", size, entries(&full.mass.assembled().unwrap())),
        order: RowOrder::Ascending(3),
        units: MeshUnits::named("si").unwrap(),
    }
}

fn with(change: impl FnOnce(&mut ForeignMatrices)) -> Result<(), FlexibleError> {
    let mesh = beam();
    let mut matrices = matrices(&mesh);
    change(&mut matrices);
    let asked = Request {
        matrices: Some(matrices),
        ..request()
    };
    reduce(mesh, &asked).map(|_| ())
}

#[test]
fn foreign_matrices() {
    with(|_| ()).unwrap();
    let mut answers = Answers::default();
    let mut wrong = |what: &str, change: &dyn Fn(&mut ForeignMatrices)| {
        answers.note(what, with(|matrices| change(matrices)));
    };
    wrong("six freedoms a node", &|m| m.order = RowOrder::Ascending(6));
    wrong("another mesh", &|m| {
        m.stiffness.rows -= 3;
        m.stiffness.columns -= 3;
        let size = m.stiffness.rows as u32;
        m.stiffness
            .entries
            .retain(|(i, j, _)| *i < size && *j < size);
    });
    wrong("no list of freedoms", &|m| m.order = RowOrder::OfFile);
    let listed = |count: u64, first: u64| {
        RowOrder::Listed(ForeignFreedoms {
            rows: (0..count)
                .flat_map(|node| (1..=3).map(move |f| (first + node, f)))
                .collect(),
        })
    };
    wrong("a short list", &|m| m.order = listed(44, 1));
    wrong("nodes that are not there", &|m| m.order = listed(45, 31));
    wrong("a freedom twice", &|m| {
        m.order = RowOrder::Listed(ForeignFreedoms {
            rows: (0..135)
                .map(|row| (1 + row / 3, 1 + (row % 2) as u8))
                .collect(),
        });
    });
    wrong("a hole in the file", &|m| {
        m.stiffness.entries[17].2 = f64::NAN
    });
    wrong("not square", &|m| m.stiffness.columns += 1);
    wrong("not symmetric", &|m| {
        m.stiffness.symmetric = false;
        let mirrored: Vec<_> = m
            .stiffness
            .entries
            .iter()
            .filter(|(i, j, _)| i != j)
            .map(|(i, j, x)| (*j, *i, 1.001 * x))
            .collect();
        m.stiffness.entries.extend(mirrored);
    });
    wrong("a negative mass", &|m| {
        for entry in m
            .mass
            .entries
            .iter_mut()
            .filter(|(i, j, _)| i == j)
            .take(40)
        {
            entry.2 *= -1.0;
        }
    });
    wrong("stiffness and mass exchanged", &|m| {
        std::mem::swap(&mut m.stiffness, &mut m.mass);
    });
    wrong("no mass at all", &|m| m.mass.entries.clear());
    wrong("single precision, cut again", &|m| {
        for entry in &mut m.stiffness.entries {
            entry.2 = format!("{:.3e}", entry.2).parse().unwrap();
        }
    });
    wrong("springs to the ground", &|m| {
        for entry in m.stiffness.entries.iter_mut().filter(|(i, j, _)| i == j) {
            entry.2 *= 1.01;
        }
    });
    wrong("rows of another order", &|m| {
        let RowOrder::Listed(mut list) = listed(45, 1) else {
            return;
        };
        list.rows.reverse();
        m.order = RowOrder::Listed(list);
    });
    wrong("a node that nothing holds", &|m| {
        let cut = |i: u32| (60..63).contains(&i);
        m.stiffness.entries.retain(|(i, j, _)| !cut(*i) && !cut(*j));
    });
    wrong("disconnected parts", &|m| {
        let left = |i: u32| i / 3 % 5 < 2;
        let middle = |i: u32| i / 3 % 5 == 2;
        for matrix in [&mut m.stiffness, &mut m.mass] {
            matrix.entries.retain(|(i, j, _)| left(*i) == left(*j));
        }
        assert!(m.stiffness.entries.iter().any(|(i, _, _)| middle(*i)));
    });
    insta::assert_snapshot!(answers.0);
    // wrong units cannot be refused; they give a warning
    let mesh = beam();
    let mut matrices = matrices(&mesh);
    matrices.units = MeshUnits::named("mm_tonne_s").unwrap();
    let asked = Request {
        matrices: Some(matrices),
        ..request()
    };
    let reduced = reduce(mesh, &asked).unwrap();
    assert_eq!(
        reduced.report.warnings,
        [
            "the mass matrix has 31400 kg, but the volumes and densities of the mesh give 31.4 kg: check the units, and look for masses of the run that the mesh lacks"
        ]
    );
}

#[test]
fn damaged_files() {
    let mut answers = Answers::default();
    let matrix = Dense::symmetric("KGG", 30);
    let op4 = op4_binary(
        std::slice::from_ref(&matrix),
        Layout::Strings,
        false,
        false,
        false,
    );
    let read = |bytes: Vec<u8>| read_op4(&OneFile(bytes), "k.op4", "KGG");
    read(op4.clone()).unwrap();
    answers.note(
        "OP4 cut in a record",
        read(op4[..op4.len() / 2 + 3].to_vec()),
    );
    answers.note("OP4 cut in its head", read(op4[..10].to_vec()));
    let swapped = |bytes: &[u8]| -> Vec<u8> {
        bytes
            .chunks(2)
            .flat_map(|pair| pair.iter().rev().copied())
            .collect()
    };
    answers.note("OP4 with bytes swapped in pairs", read(swapped(&op4)));
    let mut mixed = op4.clone();
    mixed[32..36].reverse();
    answers.note("OP4 with a record of the other byte order", read(mixed));
    let mut nan = matrix.clone();
    nan.columns[4][4] = f64::NAN;
    answers.note(
        "OP4 with a NaN",
        read(op4_binary(
            &[nan.clone()],
            Layout::Dense,
            false,
            true,
            false,
        )),
    );
    answers.note(
        "OP4 of text that is none",
        read(b"SOL 103\nCEND\n".to_vec()),
    );
    let op2 = |matrix: &Dense| {
        let mut file = Op2::new(false, false, true);
        file.matrix(matrix, 2);
        file.finish()
    };
    let read = |bytes: Vec<u8>| read_op2_matrix(&OneFile(bytes), "k.op2", "KGG");
    let whole = op2(&matrix);
    read(whole.clone()).unwrap();
    answers.note(
        "OP2 cut in a record",
        read(whole[..whole.len() / 2 + 1].to_vec()),
    );
    // after the record that holds the middle
    let mut end = 0;
    while end < whole.len() / 2 {
        let length = u32::from_le_bytes(whole[end..end + 4].try_into().unwrap());
        end += length as usize + 8;
    }
    answers.note("OP2 cut between records", read(whole[..end].to_vec()));
    answers.note("OP2 with bytes swapped in pairs", read(swapped(&whole)));
    answers.note("OP2 with a NaN", read(op2(&nan)));
    let from = |text: &str| {
        let file = |file| MatrixFile {
            file,
            format: MatrixFormat::CalculiX,
            name: "",
            freedoms: None,
        };
        let units = MeshUnits::named("si").unwrap();
        ForeignMatrices::read(
            &OneFile(text.as_bytes().to_vec()),
            file("k.sti"),
            file("m.mas"),
            None,
            units,
        )
    };
    answers.note("a matrix file with a word", from("1 1 2.0\n1 2 x\n"));
    answers.note("a matrix file with a NaN", from("1 1 2.0\n2 2 NaN\n"));
    answers.note("an empty matrix file", from(""));
    insta::assert_snapshot!(answers.0);
}
