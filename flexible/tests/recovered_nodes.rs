//! Nodes that a matrix recovers from the freedoms of a condensed body: against the whole mesh, against our own reduction that is
//! read back, and with the matrices of superelements as NX Nastran wrote them. Wrong files, each with its message.

use crate::craig_bampton::{
    Condensed, Memory, apart, bar, condensed, done, file, flexibility, in_si, of_bar, request,
    table, tables, units,
};
use crate::support::Data;
use eng_flexible::foreign::{ForeignMatrices, MatrixFile, RecoveryMatrix};
use eng_flexible::markers::{MESH_AXES, MarkerPlace, MarkerRequest};
use eng_flexible::mesh::Mesh;
use eng_flexible::read::matrix::MatrixFormat;
use eng_flexible::read::nastran::read_bulk;
use eng_flexible::read::{MeshFormat, read_mesh};
use eng_flexible::recover::{Recovery, Surface};
use eng_flexible::reduce::{Interface, Reduced, Request, Term, outline, reduce};
use eng_flexible::small_motion::{RIGID, SmallMotion};
use eng_flexible::solve::Modes;
use eng_flexible::store::{Key, StoredBody};
use eng_flexible::units::MeshUnits;
use eng_flexible::{Files, FlexibleError, Part};
use eng_system::mesh_files::Stated as _;
use faer::Mat;
use std::io::{self, Read};

/// A node inside of the bar, which no end has.
const INNER: u64 = 64;

fn at_node(id: u64) -> MarkerRequest {
    MarkerRequest {
        axes: MESH_AXES,
        name: format!("node {id}"),
        place: MarkerPlace::Node(id),
    }
}

/// The recovery matrix of the condensed bar: rows of nodes of the mesh, in the order of the mesh's file.
struct Recovering {
    interface: Memory,
    asked: Request,
    matrix: Mat<f64>,
    rows: Vec<(u64, u8)>,
    nodes: Mesh,
    tolerance: f64,
}

impl Recovering {
    /// With the rows of the wanted nodes.
    fn new(own: &Condensed, wanted: impl Fn(u64) -> bool) -> Self {
        let kept: Vec<usize> = (0..own.all.len())
            .filter(|row| wanted(own.all[*row].0))
            .collect();
        Recovering {
            interface: tables(own),
            asked: request(own),
            matrix: Mat::from_fn(kept.len(), own.basis.ncols(), |i, j| {
                own.basis[(kept[i], j)]
            }),
            rows: kept.into_iter().map(|row| own.all[row]).collect(),
            nodes: in_si(bar()),
            tolerance: 1e-3,
        }
    }

    /// With the rows of all nodes outside of the interface.
    fn inner(own: &Condensed) -> Self {
        Recovering::new(own, |id| own.nodes.iter().all(|(kept, _)| *kept != id))
    }

    /// Keeps some rows and columns of the matrix alone.
    fn keep(&mut self, rows: &[usize], columns: usize) {
        let kept = Mat::from_fn(rows.len(), columns, |i, j| self.matrix[(rows[i], j)]);
        self.matrix = kept;
        self.rows = rows.iter().map(|row| self.rows[*row]).collect();
    }

    fn files(&self) -> Memory {
        let rows = self.rows.iter();
        let rows = rows.map(|(id, freedom)| format!("{id}.{freedom}\n"));
        (self.interface.clone())
            .with("t.csv", table(&self.matrix))
            .with("t_rows.txt", rows.collect())
    }

    /// The body of the tables with one more marker.
    fn request(&self, inner: u64) -> Result<(Mesh, Request), FlexibleError> {
        let files = self.files();
        let of = |name, list| file(name, MatrixFormat::Csv, "", Some(list));
        let (k, m) = (of("k.csv", "rows.txt"), of("m.csv", "rows.txt"));
        let matrices = ForeignMatrices::read(&files, k, m, None, units())?;
        let t = of("t.csv", "t_rows.txt");
        let nodes = (self.nodes.clone(), units());
        let recovery = RecoveryMatrix::read(&files, t, None, nodes, self.tolerance)?;
        let mut asked = Request {
            matrices: Some(matrices),
            recovery: Some(recovery),
            ..self.asked.clone()
        };
        asked.markers.push(at_node(inner));
        let mesh = read_mesh(&files, "nodes.csv", MeshFormat::Csv)?;
        Ok((in_si(mesh), asked))
    }

    fn reduced(&self, inner: u64) -> Result<Reduced, FlexibleError> {
        let (mesh, asked) = self.request(inner)?;
        reduce(mesh, &asked)
    }

    /// The message about a wrong file, which belongs to the recovery.
    fn refused(&self) -> String {
        let error = self.reduced(INNER).expect_err("a wrong file");
        assert_eq!(error.part(), Some(Part::Recovery), "{error}");
        assert!(!error.advice().is_empty(), "{error}");
        error.to_string()
    }
}

/// The static displacements of all nodes of a mesh with freedoms under a unit load at each translation of the last marker.
fn displacements(reduced: &Reduced, ids: &[u64]) -> Vec<f64> {
    let n = reduced.body.invariants.modes;
    let size = reduced.freedoms.size();
    let index = reduced.mesh.node_index();
    let marker = reduced.body.markers.last().expect("a marker");
    let stiffness = &reduced.body.invariants.stiffness;
    let mut found = Vec::new();
    for id in ids {
        for component in 0..3u8 {
            let freedom = reduced.freedoms.freedom(index[id], component).unwrap();
            for row in marker.translation.chunks_exact(n) {
                let terms = (0..n).map(|mode| {
                    row[mode] * reduced.shapes[mode * size + freedom] / stiffness[mode * n + mode]
                });
                found.push(terms.sum());
            }
        }
    }
    found
}

fn stored(reduced: Reduced) -> StoredBody {
    StoredBody::new(reduced, Default::default(), Key([0; 32]), Vec::new())
}

/// The volume that triangles enclose; positive if they are anticlockwise as seen from outside.
fn volume(mesh: &Mesh) -> f64 {
    let surface = Surface::new(mesh);
    let place = |node: u32| mesh.nodes[node as usize].position;
    let six = surface.triangles().iter().map(|corners| {
        let [a, b, c] = corners.map(place);
        a[0] * (b[1] * c[2] - b[2] * c[1])
            + a[1] * (b[2] * c[0] - b[0] * c[2])
            + a[2] * (b[0] * c[1] - b[1] * c[0])
    });
    six.sum::<f64>() / 6.0
}

/// All nodes of the mesh, from the freedoms of an interface at its ends: their displacements are those of the mesh that is reduced
/// with the same shapes. A marker may be at one of them. The pictures have the surface of the mesh.
#[test]
fn recovered_nodes_move_as_those_of_the_mesh() {
    let own = condensed();
    let recovering = Recovering::new(&own, |_| true);
    let found = done(recovering.reduced(INNER));
    let mut asked = Request {
        matrices: Some(of_bar()),
        ..request(&own)
    };
    asked.markers.push(at_node(INNER));
    let exact = done(reduce(in_si(bar()), &asked));

    let facts = found.report.recovered.clone().expect("recovered nodes");
    let ids: Vec<u64> = bar().nodes.iter().map(|node| node.id).collect();
    assert_eq!(facts.nodes, ids.len());
    let deviation = facts.deviation.expect("a free body");
    let moved = apart(&displacements(&found, &ids), &displacements(&exact, &ids));
    let flexible = apart(&flexibility(&found, 0.0), &flexibility(&exact, 0.0));
    println!("displacements {moved:.1e}, markers {flexible:.1e}, rigid motions {deviation:.1e}");
    assert!(moved < 1e-8, "{moved}");
    assert!(flexible < 1e-8, "{flexible}");
    assert!(deviation < 1e-8, "{deviation}");

    // the equations are in the shapes, and the table counts the nodes of the interface alone
    assert!(found.mesh.ties.is_empty());
    assert_eq!(found.report.nodes, own.nodes.len());
    let [drawn, whole] = [&found.mesh, &in_si(bar())].map(volume);
    assert!((drawn / whole - 1.0).abs() < 0.02, "{drawn} {whole}");
    let body = stored(found);
    let triangles = Surface::new(&bar()).triangles().len();
    assert_eq!(body.surface.triangles().len(), triangles);
    // pictures have no stress, because no row states one
    let recovery = Recovery::of_stored(&body).unwrap();
    let stress = recovery.stress_at_nodes(&body.surface.nodes()).unwrap();
    assert!(stress.nodes().is_empty());
    let read = StoredBody::from_bytes(&body.to_bytes().unwrap()).unwrap();
    assert_eq!(read.shapes, body.shapes);
}

/// The check of a model, which computes no modes, finds the markers at recovered nodes and the errors of the matrix.
#[test]
fn an_outline_has_markers_at_recovered_nodes() {
    let own = condensed();
    let mut recovering = Recovering::new(&own, |id| id == INNER);
    recovering.nodes.elements.clear();
    recovering.nodes.nodes.retain(|node| node.id == INNER);
    let (mesh, asked) = recovering.request(INNER).unwrap();
    let checked = outline(mesh, &asked).unwrap();
    let last = checked.rigid().markers.last().cloned();
    let last = last.expect("a marker");
    assert_eq!(last.position, recovering.nodes.nodes[0].position);
    recovering.matrix[(0, 0)] += 0.1;
    let (mesh, asked) = recovering.request(INNER).unwrap();
    let error = outline(mesh, &asked).expect_err("a wrong matrix");
    assert_eq!(error.part(), Some(Part::Recovery));
}

/// The body of `eng reduce --to numpy`, read as matrices of a node at its origin with its modes as scalar points, and `shapes` as
/// its recovery. Node 1 carries the frame: `u = R r + Φ a`.
#[test]
fn our_own_body_is_read_back_with_its_nodes() {
    let free = Request {
        terms: vec![Term::Normal {
            modes: Modes::Count(8),
            fixed: Vec::new(),
        }],
        markers: vec![at_node(INNER)],
        damping_ratio: 0.01,
        damping_up_to: f64::INFINITY,
        ..Request::default()
    };
    let asked = Request {
        matrices: Some(of_bar()),
        ..free.clone()
    };
    let exact = done(reduce(in_si(bar()), &asked));
    let motion = SmallMotion::new(&exact.body);
    let n = exact.body.invariants.modes;
    let body = stored(exact.clone());
    let every: Vec<u32> = (0..exact.mesh.nodes.len() as u32).collect();
    let shapes = Recovery::of_stored(&body).unwrap().nodes(&every).unwrap();
    let places: Vec<[f64; 3]> = exact.mesh.nodes.iter().map(|node| node.position).collect();
    let moved = Mat::from_fn(3 * places.len(), RIGID + n, |row, column| {
        let (node, along) = (row / 3, row % 3);
        let [x, y, z] = places[node];
        let turned = [[0.0, z, -y], [-z, 0.0, x], [y, -x, 0.0]];
        match column {
            0..3 => f64::from(along == column),
            3..6 => turned[along][column - 3],
            _ => shapes.rows()[(6 * node + along) * n + column - RIGID],
        }
    });
    let square = |dense: &eng_flexible::small_motion::Dense| {
        table(&Mat::from_fn(RIGID + n, RIGID + n, |i, j| dense.at(i, j)))
    };
    let origin = 10_000;
    let mut rows: String = (1..=6).map(|k| format!("{origin}.{k}\n")).collect();
    rows.extend((0..n).map(|mode| format!("{}.0\n", 20_000 + mode)));
    let recovered: String = exact.mesh.nodes.iter().fold(String::new(), |text, node| {
        (1..=3).fold(text, |text, k| text + &format!("{}.{k}\n", node.id))
    });
    let mut nodes = String::new();
    for node in &exact.mesh.nodes {
        let [x, y, z] = node.position;
        nodes += &format!("{},{x:e},{y:e},{z:e}\n", node.id);
    }
    let files = Memory::default()
        .with("origin.csv", format!("{origin},0,0,0\n"))
        .with("nodes.csv", nodes)
        .with("k.csv", square(&motion.stiffness))
        .with("m.csv", square(&motion.mass))
        .with("rows.txt", rows)
        .with("t.csv", table(&moved))
        .with("t_rows.txt", recovered);
    let of = |name, list| file(name, MatrixFormat::Csv, "", Some(list));
    let (k, m) = (of("k.csv", "rows.txt"), of("m.csv", "rows.txt"));
    let t = of("t.csv", "t_rows.txt");
    let nodes = read_mesh(&files, "nodes.csv", MeshFormat::Csv).unwrap();
    let si = MeshUnits::SI;
    let asked = Request {
        matrices: Some(ForeignMatrices::read(&files, k, m, None, si).unwrap()),
        recovery: Some(RecoveryMatrix::read(&files, t, None, (nodes, si), 1e-3).unwrap()),
        ..free
    };
    let interface = read_mesh(&files, "origin.csv", MeshFormat::Csv).unwrap();
    let found = done(reduce(interface, &asked));
    let pairs = found.body.frequencies.iter().zip(&exact.body.frequencies);
    let worst = pairs.map(|(a, b)| (a / b - 1.0).abs()).fold(0.0, f64::max);
    let ids: Vec<u64> = exact.mesh.nodes.iter().map(|node| node.id).collect();
    let moved = apart(&displacements(&found, &ids), &displacements(&exact, &ids));
    let deviation = found
        .report
        .recovered
        .as_ref()
        .and_then(|own| own.deviation);
    println!("frequencies {worst:.1e}, displacements {moved:.1e}, rigid motions {deviation:?}");
    assert!(worst < 1e-9, "{worst}");
    assert!(moved < 1e-9, "{moved}");
    assert!(deviation.expect("a free body") < 1e-12);
}

/// Wrong files, each with a message that names its place.
#[test]
fn wrong_recoveries_are_refused() {
    let own = condensed();
    let whole = || Recovering::new(&own, |_| true);
    let inner = || Recovering::inner(&own);
    let told = |change: &dyn Fn(&mut Recovering), mut recovering: Recovering| {
        change(&mut recovering);
        let told = recovering.refused();
        println!("{told}");
        told
    };
    let exchanged = |recovering: &mut Recovering| {
        for row in 0..recovering.matrix.nrows() {
            let first = recovering.matrix[(row, 0)];
            recovering.matrix[(row, 0)] = recovering.matrix[(row, 4)];
            recovering.matrix[(row, 4)] = first;
        }
    };
    // with nodes of the interface by the identity, without them by rigid motions
    let text = told(&exchanged, whole());
    let first = own.nodes[0].0;
    assert!(
        text.contains(&format!("component 1 of node {first}")),
        "{text}"
    );
    let text = told(&exchanged, inner());
    assert!(
        text.contains("of the interface does not move node"),
        "{text}"
    );
    let text = told(&|own| own.matrix[(0, 0)] += 0.1, inner());
    let row = inner().rows[0].0;
    assert!(text.contains(&format!("node {row} rigidly")), "{text}");

    let fewer = |own: &mut Recovering| {
        let every: Vec<usize> = (0..own.rows.len()).collect();
        own.keep(&every, own.matrix.ncols() - 1);
    };
    let text = told(&fewer, inner());
    let count = own.rows.len();
    assert!(
        text.contains(&format!(
            "has {} columns, but the stiffness has {count} rows",
            count - 1
        )),
        "{text}"
    );
    let missing = |own: &mut Recovering| {
        own.nodes.nodes.retain(|node| node.id != INNER);
        own.nodes.elements.clear();
    };
    let text = told(&missing, inner());
    assert!(
        text.contains("rows of 1 nodes that `nodes` does not have: 64"),
        "{text}"
    );
    let surplus = |own: &mut Recovering| {
        own.nodes.elements.clear();
        let kept = (0..own.rows.len()).filter(|row| own.rows[*row].0 != INNER);
        let kept: Vec<usize> = kept.collect();
        own.keep(&kept, own.matrix.ncols());
    };
    let text = told(&surplus, inner());
    assert!(text.contains("has no rows of 1 of its nodes: 64"), "{text}");
    let partly = |own: &mut Recovering| {
        let all_but_one: Vec<usize> = (0..own.rows.len() - 1).collect();
        own.keep(&all_but_one, own.matrix.ncols());
    };
    let text = told(&partly, inner());
    assert!(text.contains("for its components 1, 2 alone"), "{text}");
    let text = told(&|own| own.rows[1] = own.rows[0], inner());
    assert!(text.contains("two rows of component 1"), "{text}");
    let text = told(
        &|own| {
            for node in &mut own.nodes.nodes {
                node.position[0] += 1e-3;
            }
        },
        inner(),
    );
    assert!(text.contains("has two places, 1 mm apart"), "{text}");

    // a list of another length is an error of the reader
    let mut short = inner();
    short.rows.pop();
    let error = short.reduced(INNER).expect_err("a row too few in the list");
    assert!(error.to_string().contains("freedoms"), "{error}");
    assert_eq!(error.part(), Some(Part::Recovery));
    // the elements of a mesh are no interface
    let (_, asked) = whole().request(INNER).unwrap();
    let error = reduce(in_si(bar()), &asked).expect_err("a mesh with elements");
    assert!(
        error.to_string().contains("the mesh has elements"),
        "{error}"
    );
    let asked = Request {
        matrices: None,
        ..asked
    };
    let error = reduce(in_si(bar()), &asked).expect_err("no matrices");
    assert!(
        error.advice().contains("give `stiffness` and `mass`"),
        "{error}"
    );
}

/// A deviation that the text accepts is stated.
#[test]
fn a_tolerance_accepts_a_deviation() {
    let own = condensed();
    let mut recovering = Recovering::inner(&own);
    recovering.matrix[(0, 0)] += 0.1;
    recovering.tolerance = 0.5;
    let found = done(recovering.reduced(INNER));
    let deviation = found.report.recovered.and_then(|own| own.deviation);
    assert!((deviation.unwrap() - 0.1).abs() < 0.05, "{deviation:?}");
}

/// A cell whose corner has no rows is left out, and a note counts it.
#[test]
fn cells_without_rows_are_left_out() {
    let own = condensed();
    let recovering = Recovering::new(&own, |id| id != INNER);
    let inner = recovering.nodes.nodes[0].id;
    let found = done(recovering.reduced(inner));
    let warnings = &found.report.warnings;
    let noted = |text: &&String| text.contains("no rows of 1 of the nodes in `nodes`: 64");
    assert!(warnings.iter().any(|text| noted(&text)), "{warnings:?}");
    let triangles = |mesh: &Mesh| Surface::new(mesh).triangles().len();
    assert!(triangles(&found.mesh) < triangles(&bar()));
}

const SUPERELEMENTS: Data = Data("superelements");

/// The grid points of the recovered displacements of a superelement of pyYeti's tests, from its decks.
const GRIDS: &str = "CORD2R,10,0,0.,0.,0.,1.,0.,0.
,0.,1.,0.
GRID,4,0,900.,0.,300.,0
GRID,16,0,2100.,300.,300.,0
GRID,45,0,150.,-930.,150.,0
GRID,60,0,450.,-930.,150.,10
";

/// A deck of some of these grid points, and the files of NX.
struct Deck(Vec<&'static str>);

impl Files for Deck {
    fn open(&self, name: &str) -> io::Result<Box<dyn Read>> {
        if name != "inner.bdf" {
            return SUPERELEMENTS.open(name);
        }
        let wanted = |line: &&str| {
            !line.starts_with("GRID")
                || self
                    .0
                    .iter()
                    .any(|id| line.starts_with(&format!("GRID,{id},")))
        };
        let lines: Vec<&str> = GRIDS.lines().filter(wanted).collect();
        Ok(Box::new(io::Cursor::new(lines.join("\n").into_bytes())))
    }
}

/// A superelement with its feet held, and its recovered grid points; `TUG1` of the `.pch` gives the rows of `MUG1`.
fn superelement(name: &str, inner: Vec<&'static str>) -> Result<Reduced, FlexibleError> {
    let units = MeshUnits::named("m_kg_s").unwrap();
    let (op4, pch) = (format!("{name}.op4"), format!("{name}.pch"));
    let files = Deck(inner);
    let of = |name| MatrixFile {
        file: &op4,
        format: MatrixFormat::Op4,
        name,
        freedoms: None,
    };
    let nodes = read_bulk(&files, "inner.bdf")?;
    let feet = [3, 11, 19, 27];
    let held = |marker| Interface {
        marker,
        components: 0b11_1111,
    };
    let asked = Request {
        markers: feet.map(at_node).to_vec(),
        support: (0..feet.len()).map(held).collect(),
        terms: vec![Term::Normal {
            modes: Modes::Count(8),
            fixed: Vec::new(),
        }],
        matrices: Some(ForeignMatrices::read(
            &files,
            of("KXX"),
            of("MXX"),
            None,
            units,
        )?),
        recovery: Some(RecoveryMatrix::read(
            &files,
            of("MUG1"),
            None,
            (nodes, units),
            1e-3,
        )?),
        damping_ratio: 0.01,
        damping_up_to: f64::INFINITY,
        ..Request::default()
    };
    reduce(read_bulk(&files, &pch)?, &asked)
}

/// `MUG1` of NX recovers grid points inside of the frame: rigid motions to the digits of the file, and shapes as SciPy computes
/// them from pyYeti's reading, `T φ` with `φᵀ M φ = 1`.
#[test]
fn displacements_of_a_superelement() {
    let found = done(superelement("inboard", vec!["4", "16"]));
    let facts = found.report.recovered.clone().expect("recovered nodes");
    assert_eq!(facts.nodes, 6);
    assert!(facts.deviation.expect("a free body") < 1e-7, "{facts:?}");
    assert!(facts.title.ends_with("MUG1"), "{facts:?}");
    let index = found.mesh.node_index();
    let expected = [
        (
            2,
            16,
            [
                0.0011928097810596,
                -0.8904834985733032,
                0.8907063603401184,
                0.005881593562662602,
                0.000119239055493381,
                0.000365523068467155,
            ],
        ),
        (
            3,
            16,
            [
                -0.257860779762268,
                0.6986286640167236,
                0.0788817629218102,
                0.001275583053939045,
                0.00047561337123625,
                -0.001435579499229789,
            ],
        ),
        (
            2,
            4,
            [
                -0.001961134141311,
                0.8775993585586548,
                0.8779930472373962,
                -0.005977150518447161,
                -0.0000632210940239,
                0.0000424519494118,
            ],
        ),
    ];
    for (mode, id, expected) in expected {
        let shape = |component: u8| {
            let freedom = found.freedoms.freedom(index[&id], component).unwrap();
            found.shapes[mode * found.freedoms.size() + freedom]
        };
        let shape: Vec<f64> = (0..6).map(shape).collect();
        let sign = (shape[1] * expected[1]).signum();
        for (k, (own, other)) in shape.iter().zip(expected).enumerate() {
            let limit = if k < 3 { 1e-6 } else { 1e-8 };
            assert!(
                (sign * own - other).abs() < limit,
                "mode {mode}, node {id}: {own} {other}"
            );
        }
    }
}

/// AUTOSPC of that run held the freedoms 3 and 5 of grid point 60, as its table of singularities prints, so their rows are zero.
/// Freedom 3 is along x.
#[test]
fn a_grid_point_with_a_held_freedom_is_named() {
    let error = superelement("outboard", vec!["45", "60"]).expect_err("a held freedom");
    let told = error.to_string();
    assert!(
        told.contains("a rigid translation along x of the interface does not move node 60 rigidly"),
        "{told}"
    );
    let error = superelement("outboard", vec!["45"]).expect_err("a grid point is missing");
    assert!(
        error.to_string().contains("`nodes` does not have: 60"),
        "{error}"
    );
}
