//! Condensed bodies: interface nodes with the modal freedoms of a Craig–Bampton reduction, in every form in
//! which other codes write them. The condensation is computed here with dense algebra from CalculiX's
//! matrices of a twisted bar.

use std::collections::BTreeMap;
use std::io::{self, Read};

use crate::foreign_files::{Dense, Layout, dmig, op4_text};
use crate::support::Data;
use eng_flexible::foreign::{ForeignMatrices, GivenModes, MatrixFile};
use eng_flexible::markers::{MESH_AXES, MarkerPlace, MarkerRequest};
use eng_flexible::mesh::{Code, Mesh};
use eng_flexible::read::abaqus::read_inp;
use eng_flexible::read::matrix::{
    MatrixFormat, read_calculix_freedoms, read_frd_modes, read_matrix,
};
use eng_flexible::read::{MeshFormat, read_mesh};
use eng_flexible::reduce::{Interface, Reduced, Request, Term, reduce};
use eng_flexible::solve::Modes;
use eng_flexible::units::MeshUnits;
use eng_flexible::{Files, FlexibleError};
use eng_system::mesh_files::Stated as _;
use faer::linalg::solvers::Solve as _;
use faer::{Mat, Side};

/// Files of CalculiX, and others in memory.
#[derive(Clone, Default)]
pub struct Memory(BTreeMap<String, String>);

impl Memory {
    pub fn with(mut self, name: &str, text: String) -> Self {
        self.0.insert(name.into(), text);
        self
    }
}

impl Files for Memory {
    fn open(&self, name: &str) -> io::Result<Box<dyn Read>> {
        if let Some(text) = self.0.get(name) {
            return Ok(Box::new(io::Cursor::new(text.clone().into_bytes())));
        }
        Data("calculix").open(name)
    }
}

pub fn units() -> MeshUnits {
    MeshUnits::named("mm_tonne_s").unwrap()
}

pub fn in_si(mut mesh: Mesh) -> Mesh {
    mesh.convert(&units());
    mesh
}

pub fn bar() -> Mesh {
    read_inp(&Memory::default(), "twisted.inp.gz", Code::CalculiX).unwrap()
}

pub fn file<'a>(
    file: &'a str,
    format: MatrixFormat,
    name: &'a str,
    list: Option<&'a str>,
) -> MatrixFile<'a> {
    MatrixFile {
        file,
        format,
        name,
        freedoms: list,
    }
}

pub fn of_bar() -> ForeignMatrices {
    let list = Some("twisted.dof.gz");
    let stiffness = file("twisted.sti.gz", MatrixFormat::CalculiX, "", list);
    let mass = file("twisted.mas.gz", MatrixFormat::CalculiX, "", list);
    ForeignMatrices::read(&Memory::default(), stiffness, mass, None, units()).unwrap()
}

/// Number of modal freedoms.
const MODES: usize = 6;

/// The first number of a modal freedom.
const FIRST: u64 = 9001;

/// The condensed bar: its interface, and the rows and matrices in mm, tonne, s.
pub struct Condensed {
    pub nodes: Vec<(u64, [f64; 3])>,
    pub rows: Vec<(u64, u8)>,
    pub stiffness: Mat<f64>,
    pub mass: Mat<f64>,
    /// The freedoms of the whole mesh.
    pub all: Vec<(u64, u8)>,
    /// Their motion by the freedoms of the rows.
    pub basis: Mat<f64>,
}

impl Condensed {
    fn matrix(&self, name: &'static str, matrix: &Mat<f64>) -> Dense {
        Dense {
            name,
            rows: matrix.nrows(),
            columns: (0..matrix.ncols())
                .map(|j| (0..matrix.nrows()).map(|i| matrix[(i, j)]).collect())
                .collect(),
        }
    }

    fn dense(&self) -> [Dense; 2] {
        [
            self.matrix("KAAX", &self.stiffness),
            self.matrix("MAAX", &self.mass),
        ]
    }

    /// Grid points, modal points and their sets, in the form of EXTSEOUT.
    fn cards(&self) -> String {
        let mut text = String::from("BEGIN SUPER=10\n");
        for (id, [x, y, z]) in &self.nodes {
            text += &format!(
                "GRID*   {id:16}{:16}{x:16.9}{y:16.9}\n*       {z:16.9}\n",
                ""
            );
        }
        for mode in 0..MODES as u64 {
            text += &format!("SPOINT,{}\n", FIRST + mode);
        }
        text
    }

    fn extrn(&self) -> String {
        let mut pairs: Vec<String> = self
            .nodes
            .iter()
            .map(|(id, _)| format!("{id},123"))
            .collect();
        pairs.extend((0..MODES as u64).map(|mode| format!("{},0", FIRST + mode)));
        let mut text = String::new();
        for (line, four) in pairs.chunks(4).enumerate() {
            let head = if line == 0 { "EXTRN" } else { "" };
            text += &format!("{head},{}\n", four.join(","));
        }
        text
    }
}

fn dense_of(file: &str) -> Mat<f64> {
    let matrix = read_matrix(&Memory::default(), file, MatrixFormat::CalculiX, "").unwrap();
    let mut out = Mat::zeros(matrix.rows, matrix.rows);
    for (row, column, value) in matrix.entries {
        out[(row as usize, column as usize)] = value;
        out[(column as usize, row as usize)] = value;
    }
    out
}

fn part(matrix: &Mat<f64>, rows: &[usize], columns: &[usize]) -> Mat<f64> {
    Mat::from_fn(rows.len(), columns.len(), |i, j| {
        matrix[(rows[i], columns[j])]
    })
}

/// Craig and Bampton (AIAA J. 6 (1968) 1313): `u_i = −K_ii⁻¹ K_ib u_b + Φ η` with the lowest modes Φ of the
/// held interface. Their scale is arbitrary and differs from mode to mode.
pub fn condensed() -> Condensed {
    let (stiffness, mass) = (dense_of("twisted.sti.gz"), dense_of("twisted.mas.gz"));
    let list = read_calculix_freedoms(&Memory::default(), "twisted.dof.gz").unwrap();
    let mesh = bar();
    let corner = |set: &str| {
        mesh.sets[set]
            .nodes()
            .iter()
            .step_by(2)
            .copied()
            .collect::<Vec<_>>()
    };
    let mut kept: Vec<u32> = corner("ENDL").into_iter().chain(corner("ENDR")).collect();
    kept.sort_by_key(|node| mesh.nodes[*node as usize].id);
    let nodes: Vec<(u64, [f64; 3])> = kept
        .iter()
        .map(|node| &mesh.nodes[*node as usize])
        .map(|node| (node.id, node.position))
        .collect();
    let is_kept = |row: &(u64, u8)| nodes.iter().any(|(id, _)| *id == row.0);
    let (mut held, free): (Vec<usize>, Vec<usize>) =
        (0..list.rows.len()).partition(|row| is_kept(&list.rows[*row]));
    held.sort_by_key(|row| list.rows[*row]);
    let inner = part(&stiffness, &free, &free).llt(Side::Lower).unwrap();
    let psi = inner.solve(part(&stiffness, &free, &held));
    // M φ = λ⁻¹ K φ, with K = L Lᵀ
    let lower = inner.L().to_owned();
    let inverse = lower
        .partial_piv_lu()
        .solve(Mat::<f64>::identity(free.len(), free.len()));
    let pencil = &inverse * part(&mass, &free, &free) * inverse.transpose();
    let found = pencil.self_adjoint_eigen(Side::Lower).unwrap();
    let phi = inverse.transpose() * found.U();
    let size = held.len() + MODES;
    let mut basis = Mat::<f64>::zeros(list.rows.len(), size);
    for (column, row) in held.iter().enumerate() {
        basis[(*row, column)] = 1.0;
    }
    for (i, row) in free.iter().enumerate() {
        for column in 0..held.len() {
            basis[(*row, column)] = -psi[(i, column)];
        }
        for mode in 0..MODES {
            // eigenvalues ascend, and the lowest frequencies are the largest of them
            let scale = 3.0 + 10.0 * mode as f64;
            basis[(*row, held.len() + mode)] = scale * phi[(i, free.len() - 1 - mode)];
        }
    }
    let mut rows: Vec<(u64, u8)> = held.iter().map(|row| list.rows[*row]).collect();
    rows.extend((0..MODES as u64).map(|mode| (FIRST + mode, 0)));
    let symmetric =
        |matrix: Mat<f64>| Mat::from_fn(size, size, |i, j| 0.5 * (matrix[(i, j)] + matrix[(j, i)]));
    Condensed {
        nodes,
        rows,
        stiffness: symmetric(basis.transpose() * &stiffness * &basis),
        mass: symmetric(basis.transpose() * &mass * &basis),
        all: list.rows,
        basis,
    }
}

/// Markers at the nodes of the interface, and all the shapes that the condensed body has.
pub fn request(condensed: &Condensed) -> Request {
    let interface: Vec<Interface> = (0..condensed.nodes.len())
        .map(|marker| Interface {
            marker,
            components: 0b111,
        })
        .collect();
    Request {
        markers: condensed
            .nodes
            .iter()
            .map(|(id, _)| MarkerRequest {
                axes: MESH_AXES,
                name: format!("node {id}"),
                place: MarkerPlace::Node(*id),
            })
            .collect(),
        terms: vec![
            Term::Constraint(interface.clone()),
            Term::Normal {
                modes: Modes::Count(MODES),
                fixed: interface,
            },
        ],
        damping_ratio: 0.02,
        damping_up_to: f64::INFINITY,
        ..Request::default()
    }
}

pub fn done(result: Result<Reduced, FlexibleError>) -> Reduced {
    result.unwrap_or_else(|error| panic!("{error} ({})", error.advice()))
}

/// The largest difference of two lists, by the largest entry.
pub fn apart(found: &[f64], exact: &[f64]) -> f64 {
    assert_eq!(found.len(), exact.len());
    let largest = exact.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    let differences = found.iter().zip(exact).map(|(x, y)| (x - y).abs());
    differences.fold(0.0, f64::max) / largest
}

/// `Φ (k − ω² m)⁻¹ Φᵀ` between the translations of all markers: it depends neither on signs nor on scales of
/// modes.
pub fn flexibility(reduced: &Reduced, hertz: f64) -> Vec<f64> {
    let square = (2.0 * std::f64::consts::PI * hertz).powi(2);
    let n = reduced.body.invariants.modes;
    let markers = reduced.body.markers.iter();
    let rows: Vec<&[f64]> = markers
        .flat_map(|m| m.translation.chunks_exact(n))
        .collect();
    let constants = &reduced.body.invariants;
    let at = |i: usize| constants.stiffness[i * n + i] - square * constants.modal_mass[i * n + i];
    let entry = |a: &[f64], b: &[f64]| (0..n).map(|i| a[i] * b[i] / at(i)).sum();
    rows.iter()
        .flat_map(|a| rows.iter().map(|b| entry(a, b)))
        .collect()
}

fn whole(condensed: &Condensed) -> Reduced {
    let asked = Request {
        matrices: Some(of_bar()),
        ..request(condensed)
    };
    done(reduce(in_si(bar()), &asked))
}

/// The bodies of every form are that of the whole mesh with the same shapes.
#[test]
fn condensed_bodies_of_every_form_are_those_of_the_mesh() {
    let own = condensed();
    let exact = whole(&own);
    assert_eq!(exact.body.frequencies.len(), own.rows.len() - 6);
    let check = |what: &str,
                 files: Memory,
                 mesh: (&str, MeshFormat),
                 matrices: [MatrixFile; 2],
                 limit: f64| {
        let [stiffness, mass] = matrices;
        let matrices = ForeignMatrices::read(&files, stiffness, mass, None, units())
            .unwrap_or_else(|error| panic!("{what}: {error} ({})", error.advice()));
        let asked = Request {
            matrices: Some(matrices),
            ..request(&own)
        };
        let found = done(reduce(
            in_si(read_mesh(&files, mesh.0, mesh.1).unwrap()),
            &asked,
        ));
        let frequencies = found.body.frequencies.iter().zip(&exact.body.frequencies);
        let worst = frequencies
            .map(|(x, y)| (x / y - 1.0).abs())
            .fold(0.0, f64::max);
        // at rest, and at a frequency between the first modes: the whole answer of the markers to loads at them
        let flexible = [0.0, 1.3 * exact.body.frequencies[0]]
            .map(|hertz| apart(&flexibility(&found, hertz), &flexibility(&exact, hertz)))
            .into_iter()
            .fold(0.0, f64::max);
        let (a, b) = (&found.body.invariants, &exact.body.invariants);
        let rigid = (a.mass / b.mass - 1.0)
            .abs()
            .max(apart(&a.first_moment, &b.first_moment))
            .max(apart(a.inertia.as_flattened(), b.inertia.as_flattened()));
        println!(
            "{what}: frequencies {worst:.1e}, flexibility {flexible:.1e}, rigid {rigid:.1e}, {:?}",
            found.report.warnings
        );
        assert!(worst < limit && flexible < limit && rigid < limit, "{what}");
        assert!(!found.report.supported);
        assert!(found.report.warnings[0].contains("and its 6 modal freedoms have no place"));
    };
    let [k, m] = own.dense();
    let punch =
        own.cards() + &own.extrn() + &dmig(&k, &own.rows, true) + &dmig(&m, &own.rows, true);
    let files = Memory::default().with("se.pch", punch);
    let of = |name| file("se.pch", MatrixFormat::Dmig, name, None);
    check(
        "DMIG of EXTSEOUT",
        files,
        ("se.pch", MeshFormat::Nastran),
        [of("KAAX"), of("MAAX")],
        1e-4,
    );

    let sets = "ASET1,123,".to_owned()
        + &own
            .nodes
            .iter()
            .map(|(id, _)| id.to_string())
            .collect::<Vec<_>>()
            .join(",ENDT,")
            .replace(",ENDT,", "\nASET1,123,")
        + "\nQSET1,0,9001,THRU,9006\n";
    for (what, order) in [
        ("OP4 with EXTRN", own.extrn()),
        ("OP4 with ASET and QSET", sets),
    ] {
        let files = Memory::default()
            .with("se.bdf", own.cards() + &order)
            .with("se.op4", op4_text(&own.dense(), Layout::Dense, false));
        let of = |name| file("se.op4", MatrixFormat::Op4, name, None);
        check(
            what,
            files,
            ("se.bdf", MeshFormat::Nastran),
            [of("KAAX"), of("MAAX")],
            1e-8,
        );
    }

    let files = tables(&own);
    let of = |name| file(name, MatrixFormat::Csv, "", Some("rows.txt"));
    check(
        "CSV",
        files,
        ("nodes.csv", MeshFormat::Csv),
        [of("k.csv"), of("m.csv")],
        1e-8,
    );

    let files = tables(&own).with("sub.mtx", substructure(&own));
    let of = || file("sub.mtx", MatrixFormat::Abaqus, "", None);
    check(
        "substructure of Abaqus",
        files,
        ("nodes.csv", MeshFormat::Csv),
        [of(), of()],
        1e-8,
    );
}

/// A dense matrix as text.
pub fn table(matrix: &Mat<f64>) -> String {
    let line = |i: usize| {
        (0..matrix.ncols())
            .map(|j| format!("{:e}", matrix[(i, j)]))
            .collect::<Vec<_>>()
            .join(",")
    };
    (0..matrix.nrows()).map(|i| line(i) + "\n").collect()
}

/// Nodes, matrices and rows as tables.
pub fn tables(own: &Condensed) -> Memory {
    let mut nodes = String::from("node,x,y,z\n");
    for (id, [x, y, z]) in &own.nodes {
        nodes += &format!("{id},{x},{y},{z}\n");
    }
    let rows = own
        .rows
        .iter()
        .map(|(id, freedom)| format!("{id}.{freedom}\n"));
    Memory::default()
        .with("nodes.csv", nodes)
        .with("k.csv", table(&own.stiffness))
        .with("m.csv", table(&own.mass))
        .with("rows.txt", rows.collect())
}

/// The form of `*SUBSTRUCTURE MATRIX OUTPUT`; modal freedoms are nodes with one freedom.
fn substructure(own: &Condensed) -> String {
    let ids = own.nodes.iter().map(|(id, _)| *id);
    let ids: Vec<String> = ids
        .chain((0..MODES as u64).map(|mode| FIRST + mode))
        .map(|id| id.to_string())
        .collect();
    let mut text = format!(
        "**\n** ABAQUS\n** SUBSTRUCTURE GENERATION: Z1\n**\n*USER ELEMENT, NODES={:12}, LINEAR\n** ELEMENT NODES\n",
        ids.len()
    );
    for ten in ids.chunks(10) {
        text += &format!("** {}\n", ten.join(", "));
    }
    text += &format!("1, 2, 3\n{}, 1\n", own.nodes.len() + 1);
    for (kind, matrix) in [("STIFFNESS", &own.stiffness), ("MASS", &own.mass)] {
        text += &format!("*MATRIX,TYPE={kind}\n");
        for i in 0..matrix.nrows() {
            let row: Vec<String> = (0..=i)
                .map(|j| {
                    // the modes of the held interface are orthogonal to the constraint modes, up to rounding
                    let couples = (own.rows[i].1 == 0) == (own.rows[j].1 == 0)
                        && (own.rows[i].1 != 0 || i == j);
                    let value = if couples || kind == "MASS" {
                        matrix[(i, j)]
                    } else {
                        0.0
                    };
                    format!("{value:.16e}")
                })
                .collect();
            for four in row.chunks(4) {
                text += &format!(" {},\n", four.join(", "));
            }
        }
    }
    text
}

/// The condensed bar as tables, in SI.
fn reduce_tables(own: &Condensed, asked: Request) -> Result<Reduced, FlexibleError> {
    let files = tables(own);
    let of = |name| file(name, MatrixFormat::Csv, "", Some("rows.txt"));
    let matrices = ForeignMatrices::read(&files, of("k.csv"), of("m.csv"), None, units())?;
    let asked = Request {
        matrices: Some(matrices),
        ..asked
    };
    reduce(
        in_si(read_mesh(&files, "nodes.csv", MeshFormat::Csv)?),
        &asked,
    )
}

/// The bar held at four nodes of one end. Momentum and angular momentum of the modes are those of the mesh,
/// and with them the part of `R_rᵀ M E_k Φ` that follows from them.
#[test]
fn constants_of_condensed_bodies() {
    let own = condensed();
    let held = |asked: Request| {
        let at = |markers: std::ops::Range<usize>| -> Vec<Interface> {
            let all = |marker| Interface {
                marker,
                components: 0b111,
            };
            markers.map(all).collect()
        };
        let free = at(4..asked.markers.len());
        Request {
            support: at(0..4),
            terms: vec![
                Term::Constraint(free.clone()),
                Term::Normal {
                    modes: Modes::Count(MODES),
                    fixed: free,
                },
            ],
            ..asked
        }
    };
    let asked = Request {
        matrices: Some(of_bar()),
        ..held(request(&own))
    };
    let exact = done(reduce(in_si(bar()), &asked));
    let found = done(reduce_tables(&own, held(request(&own))));
    assert_eq!(found.report.warnings, Vec::<String>::new());
    let n = found.body.frequencies.len();
    for mode in 0..8 {
        let [a, b] = [&found, &exact].map(|body| body.body.frequencies[mode]);
        println!("mode {}: {a} Hz, {b} Hz", mode + 1);
        assert!((a / b - 1.0).abs() < 1e-9, "{a} {b}");
        let sign = |body: &Reduced| {
            body.body.invariants.translation[mode..]
                .iter()
                .step_by(n)
                .take(3)
                .fold(
                    0.0_f64,
                    |most, x| if x.abs() > most.abs() { *x } else { most },
                )
                .signum()
        };
        let row = |body: &Reduced, block: &[f64]| -> [f64; 3] {
            std::array::from_fn(|axis| block[axis * n + mode] * sign(body))
        };
        let parts = |body: &Reduced| -> Vec<f64> {
            let constants = &body.body.invariants;
            let by = &constants.rotation_by_shape;
            let antimetric = [(0, 1), (1, 2), (2, 0)]
                .map(|(k, r)| sign(body) * (by[k][r * n + mode] - by[r][k * n + mode]));
            let scale = constants.mass.sqrt();
            let mut all: Vec<f64> = row(body, &constants.translation)
                .map(|x| x / scale)
                .to_vec();
            all.extend(row(body, &constants.rotation));
            all.extend(antimetric);
            all
        };
        let apart = apart(&parts(&found), &parts(&exact));
        println!("momentum {apart:.1e}");
        assert!(apart < 1e-8, "{:?} {:?}", parts(&found), parts(&exact));
    }
}

/// Wrong files, each with its message.
#[test]
fn wrong_tables_and_substructures_are_refused() {
    let own = condensed();
    let message = |files: Memory, matrix: MatrixFile| {
        let mesh = match read_mesh(&files, "nodes.csv", MeshFormat::Csv) {
            Ok(mesh) => mesh,
            Err(error) => return format!("{error} → {}", error.advice()),
        };
        let result = ForeignMatrices::read(
            &files,
            matrix,
            file("m.csv", MatrixFormat::Csv, "", None),
            None,
            units(),
        )
        .and_then(|matrices| {
            let asked = Request {
                matrices: Some(matrices),
                ..request(&own)
            };
            reduce(in_si(mesh), &asked)
        });
        let error = result.unwrap_err();
        format!("{error} → {}", error.advice())
    };
    let table = file("k.csv", MatrixFormat::Csv, "", Some("rows.txt"));
    let nodes = |text: &str| message(tables(&own).with("nodes.csv", text.to_owned()), table);
    let sub = file("sub.mtx", MatrixFormat::Abaqus, "", None);
    let text = substructure(&own);
    let without = |what: &str| {
        text.lines()
            .filter(|line| !line.contains(what))
            .map(|line| format!("{line}\n"))
            .collect::<String>()
    };
    let cut = text
        .lines()
        .take(40)
        .map(|line| format!("{line}\n"))
        .collect::<String>();
    let with = |text: String| message(tables(&own).with("sub.mtx", text), sub);
    let mut told = String::new();
    for (name, text) in [
        ("other columns", nodes("node,x,y\n1,0,0\n")),
        ("a node without place", nodes("node,x,y,z\n101,0,0\n")),
        ("a node twice", nodes("101,0,0,0\n101,1,0,0\n")),
        ("no node", nodes("# nothing\n")),
        (
            "a short row",
            message(tables(&own).with("k.csv", "1,2\n3\n".into()), table),
        ),
        (
            "a word",
            message(tables(&own).with("k.csv", "1,2\n3,x\n".into()), table),
        ),
        (
            "no list of rows",
            message(tables(&own), file("k.csv", MatrixFormat::Csv, "", None)),
        ),
        ("no nodes of the substructure", with(without("** 1"))),
        ("a cut file", with(cut)),
        (
            "an unsymmetric one",
            with(text.replace("LINEAR", "LINEAR, UNSYMM")),
        ),
        (
            "another matrix",
            with(text.replace("TYPE=STIFFNESS", "TYPE=STRUCTURAL DAMPING")),
        ),
    ] {
        told += &format!("{name}:\n  {}\n", text.replace(" → ", "\n  → "));
    }
    let shapes = Request {
        terms: vec![Term::Given(GivenModes {
            modes: read_frd_modes(&Memory::default(), "twisted.frd.gz").unwrap(),
            units: units(),
        })],
        ..request(&own)
    };
    let error = reduce_tables(&own, shapes).unwrap_err();
    told += &format!(
        "shapes without modal freedoms:\n  {error}\n  → {}\n",
        error.advice()
    );
    insta::assert_snapshot!(told);
}

/// Two nodes without rotations do not show how the body turns about their line.
#[test]
fn nodes_on_a_line_are_refused() {
    let files = Memory::default()
        .with("nodes.csv", "1,0,0,0\n2,100,0,0\n".into())
        .with(
            "k.csv",
            "1 0 0 -1 0 0\n0 0 0 0 0 0\n0 0 0 0 0 0\n-1 0 0 1 0 0\n0 0 0 0 0 0\n0 0 0 0 0 0\n"
                .into(),
        )
        .with(
            "m.csv",
            "2 0 0 1 0 0\n0 3 0 0 1 0\n0 0 3 0 0 1\n1 0 0 2 0 0\n0 1 0 0 3 0\n0 0 1 0 0 3\n".into(),
        );
    let of = |name| file(name, MatrixFormat::Csv, "", None);
    let matrices =
        ForeignMatrices::read(&files, of("k.csv"), of("m.csv"), Some(3), units()).unwrap();
    let asked = Request {
        matrices: Some(matrices),
        terms: vec![Term::Normal {
            modes: Modes::Count(1),
            fixed: vec![],
        }],
        ..Request::default()
    };
    let error = reduce(
        in_si(read_mesh(&files, "nodes.csv", MeshFormat::Csv).unwrap()),
        &asked,
    )
    .unwrap_err();
    assert!(error.to_string().contains("lie on one line"), "{error}");
}
