//! Bodies reduced from matrices and mode shapes of files: our own written in every format, and CalculiX's.

use std::collections::BTreeMap;
use std::io::{self, Read};
use std::path::PathBuf;

use crate::foreign_files::{
    Dense, Layout, Op2, dmig, format_of, mesh_of_nodes, op4_binary, op4_text,
};
use crate::support::{Data, apart, flexibility};
use eng_flexible::fe::{Rules, assemble};
use eng_flexible::foreign::{ForeignMatrices, GivenModes, MatrixFile, RowOrder};
use eng_flexible::markers::{MarkerPlace, MarkerRequest, Selection, Spider};
use eng_flexible::mesh::{Code, Frame, Mesh};
use eng_flexible::read::abaqus::read_inp;
use eng_flexible::read::matrix::{
    ForeignFreedoms, ForeignMatrix, ForeignMode, ForeignModes, MatrixFormat, ShapeFrame,
    read_frd_modes, read_matrix,
};
use eng_flexible::reduce::{Interface, Reduced, Request, Term, reduce};
use eng_flexible::solve::Modes;
use eng_flexible::sparse::SymmetricMatrix;
use eng_flexible::units::MeshUnits;
use eng_flexible::{Files, FlexibleError};
use eng_system::mesh_files::Stated as _;

const DATA: Data = Data("calculix");

/// Files in memory.
#[derive(Default)]
struct Memory(BTreeMap<String, Vec<u8>>);

impl Memory {
    fn with(mut self, name: &str, bytes: impl Into<Vec<u8>>) -> Self {
        self.0.insert(name.into(), bytes.into());
        self
    }
}

impl Files for Memory {
    fn open(&self, name: &str) -> io::Result<Box<dyn Read>> {
        let found = self.0.get(name).ok_or(io::ErrorKind::NotFound)?;
        Ok(Box::new(io::Cursor::new(found.clone())))
    }
}

fn units() -> MeshUnits {
    MeshUnits::named("mm_tonne_s").unwrap()
}

/// A twisted bar of six 20-node bricks, 70 nodes numbered with gaps, in mm, tonne, s.
fn bar() -> Mesh {
    read_inp(&DATA, "twisted.inp.gz", Code::CalculiX).unwrap()
}

fn in_si(mut mesh: Mesh) -> Mesh {
    mesh.convert(&units());
    mesh
}

/// Its left end as an averaging spider, the right one as a rigid one, and a node between.
fn request(terms: Vec<Term>) -> Request {
    let end = |name: &str, set: &str, tie: Spider| MarkerRequest {
        axes: eng_flexible::markers::MESH_AXES,
        name: name.into(),
        place: MarkerPlace::Gathered {
            nodes: Selection::Set(set.into()),
            tie,
            center: None,
        },
    };
    Request {
        markers: vec![
            end("left", "ENDL", Spider::Averaging),
            end("right", "ENDR", Spider::Rigid),
            MarkerRequest {
                axes: eng_flexible::markers::MESH_AXES,
                name: "middle".into(),
                place: MarkerPlace::Node(64),
            },
        ],
        terms,
        damping_ratio: 0.02,
        damping_up_to: 3000.0,
        ..Request::default()
    }
}

fn at(marker: usize, components: u8) -> Interface {
    Interface { marker, components }
}

/// Static modes at the markers and normal ones.
fn sum() -> Vec<Term> {
    vec![
        Term::Static(vec![at(0, 0b11_1111), at(1, 0b11_1111), at(2, 0b111)]),
        normal(9),
    ]
}

fn normal(count: usize) -> Term {
    Term::Normal {
        modes: Modes::Count(count),
        fixed: vec![],
    }
}

fn done(result: Result<Reduced, FlexibleError>) -> Reduced {
    result.unwrap_or_else(|error| panic!("{error} ({})", error.advice()))
}

/// Both triangles as columns; `places` has the place of each row among all.
fn dense(name: &'static str, matrix: &SymmetricMatrix, places: &[usize], size: usize) -> Dense {
    let mut columns = vec![vec![0.0; size]; size];
    for column in 0..matrix.size() {
        let (rows, values) = matrix.column(column);
        for (row, value) in rows.iter().zip(values) {
            let (i, j) = (places[*row as usize], places[column]);
            columns[j][i] = *value;
            columns[i][j] = *value;
        }
    }
    Dense {
        name,
        rows: size,
        columns,
    }
}

fn exponent(value: f64, digits: usize) -> String {
    format!("{value:.digits$e}")
}

/// Lines `row column value` with this number of digits after the point.
fn lines(matrix: &Dense, digits: usize, upper: bool) -> String {
    let mut text = String::new();
    for (column, values) in matrix.columns.iter().enumerate() {
        for (row, value) in values.iter().enumerate() {
            if *value != 0.0 && (!upper || row <= column) {
                text += &format!("{} {}  {}\n", row + 1, column + 1, exponent(*value, digits));
            }
        }
    }
    text
}

/// Lines `node, freedom, node, freedom, value` of one triangle.
fn pairs(matrix: &Dense, rows: &[(u64, u8)]) -> String {
    let mut text = String::new();
    for (column, values) in matrix.columns.iter().enumerate() {
        for (row, value) in values.iter().enumerate().take(column + 1) {
            if *value != 0.0 {
                let ((n, f), (m, g)) = (rows[row], rows[column]);
                text += &format!("{n},{f}, {m},{g}, {}\n", exponent(*value, 15));
            }
        }
    }
    text
}

type Two<'a> = (MatrixFile<'a>, MatrixFile<'a>);

fn from(files: &dyn Files, (stiffness, mass): Two, per_node: Option<u8>) -> ForeignMatrices {
    ForeignMatrices::read(files, stiffness, mass, per_node, units()).unwrap()
}

/// Two files, each in the format of the end of its name.
fn files<'a>(stiffness: (&'a str, &'a str), mass: (&'a str, &'a str)) -> Two<'a> {
    let file = |(file, name)| MatrixFile {
        file,
        format: format_of(file),
        name,
        freedoms: None,
    };
    (file(stiffness), file(mass))
}

/// The list applies to both files.
fn with_freedoms<'a>((stiffness, mass): Two<'a>, list: &'a str) -> Two<'a> {
    let freedoms = Some(list);
    (
        MatrixFile {
            freedoms,
            ..stiffness
        },
        mass,
    )
}

/// The bar's matrices in its own units, rows as the mesh has its nodes (which are sorted).
struct Own {
    rows: Vec<(u64, u8)>,
    stiffness: SymmetricMatrix,
    mass: SymmetricMatrix,
}

fn own() -> Own {
    let mesh = bar();
    let full = assemble(&mesh, &Rules::default()).unwrap();
    assert!(mesh.nodes.windows(2).all(|pair| pair[0].id < pair[1].id));
    Own {
        rows: mesh
            .nodes
            .iter()
            .flat_map(|node| (1..=3).map(|freedom| (node.id, freedom)))
            .collect(),
        stiffness: full.stiffness,
        mass: full.mass.assembled().unwrap(),
    }
}

#[test]
fn matrices_of_every_format_give_the_bodies_of_their_own_code() {
    let own = own();
    let size = own.rows.len();
    assert_eq!(size, 210);
    let plain: Vec<usize> = (0..size).collect();
    let (k, m) = (
        dense("KGG", &own.stiffness, &plain, size),
        dense("MGG", &own.mass, &plain, size),
    );
    // as Nastran has them: six freedoms a node, those of rotations empty
    let six: Vec<usize> = (0..size).map(|row| row / 3 * 6 + row % 3).collect();
    let (k6, m6) = (
        dense("KGG", &own.stiffness, &six, 2 * size),
        dense("MGG", &own.mass, &six, 2 * size),
    );
    let expected = done(reduce(in_si(bar()), &request(sum())));
    assert_eq!(expected.body.frequencies.len(), 24);
    assert!(
        expected.report.warnings.is_empty(),
        "{:?}",
        expected.report.warnings
    );
    let stiff = flexibility(&expected, 0);
    let largest = stiff.iter().fold(0.0_f64, |w, x| w.max(x.abs()));
    let check = |what: &str, matrices: ForeignMatrices, tolerance: f64| {
        let asked = Request {
            matrices: Some(matrices),
            ..request(sum())
        };
        let reduced = done(reduce(in_si(bar()), &asked));
        let worst = apart(&reduced.body.frequencies, &expected.body.frequencies);
        let flexible = flexibility(&reduced, 0)
            .iter()
            .zip(&stiff)
            .map(|(x, y)| (x - y).abs() / largest)
            .fold(0.0, f64::max);
        let mass = (reduced.body.invariants.mass / expected.body.invariants.mass - 1.0).abs();
        println!(
            "{what}: frequencies {worst:.1e}, flexibility {flexible:.1e}, mass {mass:.1e}, rigid {:.1e} {:?}",
            reduced.report.rigid_residual, reduced.report.warnings
        );
        assert!(worst < tolerance, "{what}: {worst:e}");
        assert!(flexible < tolerance, "{what}: {flexible:e}");
        assert!(mass < tolerance);
        assert!(!reduced.report.supported);
        assert_eq!(
            reduced.report.warnings.is_empty(),
            tolerance < 1e-5,
            "{what}"
        );
        if tolerance > 1e-5 {
            assert!(reduced.report.warnings[0].contains("about 1"), "{what}");
        }
    };
    for (layout, big_endian, wide) in [
        (Layout::Dense, false, false),
        (Layout::Strings, true, false),
        (Layout::Big, false, true),
    ] {
        let bytes = op4_binary(&[k.clone(), m.clone()], layout, false, big_endian, wide);
        let memory = Memory::default().with("km.op4", bytes);
        let names = files(("km.op4", "KGG"), ("km.op4", "MGG"));
        let what = format!("OP4 binary {layout:?}, big-endian {big_endian}, wide {wide}");
        check(&what, from(&memory, names, Some(3)), 1e-8);
    }
    let text = op4_text(&[k6.clone(), m6.clone()], Layout::Strings, false);
    let memory = Memory::default().with("km.op4", text);
    let names = files(("km.op4", "KGG"), ("km.op4", "MGG"));
    check(
        "OP4 text, six freedoms a node",
        from(&memory, names, Some(6)),
        1e-8,
    );

    let mut op2 = Op2::new(false, false, true);
    let mesh = bar();
    let points: Vec<(i64, i64)> = mesh.nodes.iter().map(|node| (node.id as i64, 1)).collect();
    op2.points(&points);
    op2.matrix(&k6, 2);
    op2.matrix(&m6, 2);
    let memory = Memory::default().with("km.op2", op2.finish());
    let names = files(("km.op2", "KGG"), ("km.op2", "MGG"));
    check("OP2", from(&memory, names, None), 1e-8);

    let memory = Memory::default()
        .with("k.mtx", lines(&k, 15, false))
        .with("m.mtx", pairs(&m, &own.rows));
    let mut mixed = from(&memory, files(("k.mtx", ""), ("m.mtx", "")), None);
    mixed.order = RowOrder::Listed(ForeignFreedoms {
        rows: own.rows.clone(),
    });
    check("Abaqus .mtx", mixed, 1e-8);

    let names: String = own.rows.iter().map(|(n, f)| format!("{n}.{f}\n")).collect();
    let memory = Memory::default()
        .with("k.sti", lines(&k, 13, true))
        .with("m.mas", lines(&m, 13, true))
        .with("k.dof", names);
    let sti = with_freedoms(files(("k.sti", ""), ("m.mas", "")), "k.dof");
    check("CalculiX .sti", from(&memory, sti, None), 1e-7);

    let memory = Memory::default().with(
        "km.pch",
        dmig(&k, &own.rows, true) + &dmig(&m, &own.rows, false),
    );
    let names = files(("km.pch", "KGG"), ("km.pch", "MGG"));
    check("DMIG punch", from(&memory, names, None), 1e-4);
}

/// Nodes with analysis frames of their own: the file's rows are along these.
#[test]
fn rows_in_analysis_frames_are_turned() {
    let own = own();
    let mut mesh = bar();
    let mut turn = vec![None; mesh.nodes.len()];
    for (index, node) in mesh
        .nodes
        .iter_mut()
        .enumerate()
        .filter(|(i, _)| i % 3 == 1)
    {
        let (s, c) = (0.3 + 0.1 * index as f64).sin_cos();
        let (t, d) = (0.7 * index as f64).sin_cos();
        // about z, then about the new x
        let rotation = [[c, -s * d, s * t], [s, c * d, -c * t], [0.0, t, d]];
        node.frame = Some(mesh.frames.len() as u32);
        mesh.frames.push(Frame { rotation });
        turn[index] = Some(rotation);
    }
    let size = own.rows.len();
    let plain: Vec<usize> = (0..size).collect();
    let turned = |matrix: &SymmetricMatrix| -> ForeignMatrix {
        let basic = dense("A", matrix, &plain, size).columns;
        let axis = |row: usize| -> [f64; 3] {
            match turn[row / 3] {
                Some(rotation) => [0, 1, 2].map(|i: usize| rotation[i][row % 3]),
                None => [0, 1, 2].map(|i: usize| if i == row % 3 { 1.0 } else { 0.0 }),
            }
        };
        let mut entries = Vec::new();
        for i in 0..size {
            for j in 0..=i {
                let (a, b) = (axis(i), axis(j));
                let mut value = 0.0;
                for (p, x) in a.iter().enumerate() {
                    for (q, y) in b.iter().enumerate() {
                        value += x * y * basic[i / 3 * 3 + p][j / 3 * 3 + q];
                    }
                }
                entries.push((i as u32, j as u32, value));
            }
        }
        ForeignMatrix {
            file: "turned".into(),
            name: String::new(),
            rows: size,
            columns: size,
            symmetric: true,
            entries,
            freedoms: Some(ForeignFreedoms {
                rows: own.rows.clone(),
            }),
        }
    };
    let expected = done(reduce(in_si(bar()), &request(sum())));
    let asked = Request {
        matrices: Some(ForeignMatrices {
            stiffness: turned(&own.stiffness),
            mass: turned(&own.mass),
            order: RowOrder::OfFile,
            units: units(),
        }),
        ..request(sum())
    };
    let reduced = done(reduce(in_si(mesh), &asked));
    let worst = apart(&reduced.body.frequencies, &expected.body.frequencies);
    assert!(worst < 1e-8, "{worst:e}");
    let (found, exact) = (flexibility(&reduced, 0), flexibility(&expected, 0));
    let largest = exact.iter().fold(0.0_f64, |w, x| w.max(x.abs()));
    for (x, y) in found.iter().zip(&exact) {
        assert!((x - y).abs() < 1e-8 * largest);
    }
}

fn calculix(name: &str) -> ForeignMatrices {
    let [k, m, dof] = ["sti", "mas", "dof"].map(|end| format!("{name}.{end}.gz"));
    let names = with_freedoms(files((&k, ""), (&m, "")), &dof);
    from(&DATA, names, None)
}

fn hertz(name: &str, rigid: usize) -> Vec<f64> {
    let text = std::fs::read_to_string(
        PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/data/calculix/eigenvalues.json"),
    );
    let all: serde_json::Value = serde_json::from_str(&text.unwrap()).unwrap();
    all[name]
        .as_array()
        .unwrap()
        .iter()
        .skip(rigid)
        .map(|x| x.as_f64().unwrap().sqrt() / (2.0 * std::f64::consts::PI))
        .collect()
}

/// CalculiX's own matrices give its own frequencies: free, with ties that it eliminated, and held by it.
#[test]
fn matrices_of_calculix_give_its_frequencies() {
    for (name, mesh, rigid) in [
        ("twisted", "twisted.inp.gz", 6),
        ("tied", "tied.inp.gz", 6),
        ("held", "twisted.inp.gz", 0),
    ] {
        let exact = hertz(name, rigid);
        let asked = Request {
            markers: vec![],
            matrices: Some(calculix(name)),
            ..request(vec![normal(exact.len())])
        };
        let reduced = done(reduce(
            in_si(read_inp(&DATA, mesh, Code::CalculiX).unwrap()),
            &asked,
        ));
        let worst = apart(&reduced.body.frequencies, &exact);
        println!(
            "{name}: {worst:.1e}, rigid {:.1e}, {:?}",
            reduced.report.rigid_residual, reduced.report.warnings
        );
        assert!(worst < 1e-7, "{name}: {worst:e}");
        assert_eq!(reduced.report.supported, name == "held");
        if name == "held" {
            assert_eq!(reduced.report.warnings.len(), 1);
            assert!(
                reduced.report.warnings[0].contains("so the body is held to the ground there"),
                "{:?}",
                reduced.report.warnings
            );
        }
    }
}

/// The elements of the mesh by CalculiX's rules have the matrices of its files.
#[test]
fn own_elements_by_the_rules_of_calculix_are_its_matrices() {
    let terms = sum();
    let own = Request {
        rules: Rules::calculix(),
        ..request(terms.clone())
    };
    let foreign = Request {
        matrices: Some(calculix("twisted")),
        ..request(terms)
    };
    let (own, foreign) = (
        done(reduce(in_si(bar()), &own)),
        done(reduce(in_si(bar()), &foreign)),
    );
    let worst = apart(&foreign.body.frequencies, &own.body.frequencies);
    println!("{worst:.1e}");
    assert!(worst < 1e-8, "{worst:e}");
    let estimate = foreign.report.estimate.unwrap();
    let (mass, straight) = (foreign.report.body.mass, estimate.mass);
    println!("{mass} kg, {straight} kg between straight edges");
    assert!((mass / straight - 1.0).abs() < 1e-2);
}

/// A list of nodes is a sufficient mesh for markers at nodes.
#[test]
fn a_body_of_nodes_alone() {
    let mesh = bar();
    let nodes: Vec<(u64, [f64; 3])> = mesh.nodes.iter().map(|n| (n.id, n.position)).collect();
    let mut only = request(vec![
        Term::Static(vec![at(0, 0b111)]),
        Term::Constraint(vec![at(0, 0b111), at(1, 0b110)]),
        normal(6),
    ]);
    only.markers = [64, 10]
        .map(|id| MarkerRequest {
            axes: eng_flexible::markers::MESH_AXES,
            name: format!("node {id}"),
            place: MarkerPlace::Node(id),
        })
        .to_vec();
    let with = done(reduce(
        in_si(mesh),
        &Request {
            matrices: Some(calculix("twisted")),
            ..only.clone()
        },
    ));
    only.matrices = Some(calculix("twisted"));
    let reduced = done(reduce(in_si(mesh_of_nodes(&nodes)), &only));
    assert_eq!(reduced.body, with.body);
    assert_eq!(reduced.report.estimate, None);
}

/// Modes of CalculiX's results, six digits, on its matrices: rigid ones are dropped, the others keep their frequencies.
#[test]
fn given_shapes_of_a_file_are_a_mode_set() {
    let modes = read_frd_modes(&DATA, "twisted.frd.gz").unwrap();
    assert_eq!(modes.modes.len(), 14);
    let given = Term::Given(GivenModes {
        modes,
        units: units(),
    });
    let mut asked = request(vec![given.clone()]);
    asked.rules = Rules::calculix();
    asked.markers.remove(1); // a rigid spider is another structure
    let reduced = done(reduce(in_si(bar()), &asked));
    let exact = hertz("twisted", 6);
    let worst = apart(&reduced.body.frequencies, &exact);
    println!("{worst:.1e} {:?}", reduced.report.warnings);
    assert!(worst < 1e-6, "{worst:e}");
    assert_eq!(reduced.report.dropped.len(), 6);
    assert_eq!(reduced.report.sources[0], "given 7");
    assert_eq!(reduced.report.modes[0].description, "given 7");
    assert!(reduced.report.warnings[0].contains("6 digits"));
    // vectors that others span already are noise and are dropped
    let mut twice = asked.clone();
    twice.terms = vec![normal(8), given];
    let both = done(reduce(in_si(bar()), &twice));
    assert_eq!(both.report.dropped.len(), 14, "{:?}", both.report.dropped);
}

/// Shapes of a body with a rigid spider: its centre is found from the nodes it ties; and shapes in analysis frames.
#[test]
fn given_shapes_follow_ties_and_frames() {
    let body = done(reduce(in_si(bar()), &request(vec![normal(8)])));
    let n = body.body.invariants.modes;
    let size = body.freedoms.size();
    let nodes: Vec<u64> = bar().nodes.iter().map(|node| node.id).collect();
    let shapes: Vec<ForeignMode> = (0..n)
        .map(|mode| ForeignMode {
            number: mode as u64 + 1,
            eigenvalue: None,
            shape: (0..nodes.len() as u32)
                .map(|node| {
                    let mut values = [0.0; 6];
                    for (value, freedom) in values.iter_mut().zip(body.freedoms.of(node)) {
                        // millimetres
                        *value = 1e3 * body.shapes[mode * size + freedom];
                    }
                    values
                })
                .collect(),
        })
        .collect();
    let modes = ForeignModes {
        file: "shapes".into(),
        nodes,
        modes: shapes,
        frame: ShapeFrame::Analysis,
        digits: 16,
        warnings: vec![],
    };
    let given = GivenModes {
        modes,
        units: units(),
    };
    let found = done(reduce(
        in_si(bar()),
        &request(vec![Term::Given(given.clone())]),
    ));
    assert!(apart(&found.body.frequencies, &body.body.frequencies) < 1e-9);
    for (marker, own) in found.body.markers.iter().zip(&body.body.markers) {
        let largest = own.rotation.iter().fold(0.0_f64, |w, x| w.max(x.abs()));
        for (x, y) in marker.rotation.iter().zip(&own.rotation) {
            assert!((x - y).abs() <= 1e-8 * largest, "{x} {y}");
        }
    }
    assert!(
        found.report.warnings.is_empty(),
        "{:?}",
        found.report.warnings
    );
    // frames: the same shapes along their axes
    let mut framed = bar();
    let rotation = [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]];
    framed.frames.push(Frame { rotation });
    framed
        .nodes
        .iter_mut()
        .for_each(|node| node.frame = Some(0));
    let mut along = given.clone();
    for mode in &mut along.modes.modes {
        for values in &mut mode.shape {
            // x' = y, y' = −x
            let [x, y, ..] = *values;
            values[0] = y;
            values[1] = -x;
        }
    }
    let turned = done(reduce(in_si(framed), &request(vec![Term::Given(along)])));
    assert!(apart(&turned.body.frequencies, &body.body.frequencies) < 1e-9);
    // shapes of a structure without the rigid spider don't fit one with it
    let free = Request {
        markers: vec![],
        ..request(vec![normal(1)])
    };
    let free = done(reduce(in_si(bar()), &free));
    let mut wrong = given;
    wrong.modes.modes.truncate(1);
    let size = free.freedoms.size();
    for (node, values) in wrong.modes.modes[0].shape.iter_mut().enumerate() {
        for (value, freedom) in values.iter_mut().zip(free.freedoms.of(node as u32)) {
            *value = free.shapes[freedom] * if node % 2 == 0 { 1.0 } else { -1.0 };
        }
    }
    assert_eq!(free.shapes.len(), size);
    let error = reduce(in_si(bar()), &request(vec![Term::Given(wrong)])).unwrap_err();
    assert!(
        error
            .to_string()
            .contains("ties and supports of the body remove"),
        "{error}"
    );
}

#[test]
fn read_matrix_is_what_foreign_matrices_hold() {
    let read = read_matrix(&DATA, "twisted.sti.gz", MatrixFormat::CalculiX, "").unwrap();
    let dof = calculix("twisted").stiffness;
    assert_eq!((read.rows, &read.entries), (210, &dof.entries));
    assert_eq!(dof.freedoms.unwrap().rows.len(), 210);
}
