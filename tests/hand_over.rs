//! Reduced bodies as files for other codes: read back, and compared with the body and with a closed form.
//! `.ci/bodies.py` reads the same files with other programs.

use eng::{BodyFile, BodyFormat, Program, Reduction, Sources};
use eng_flexible::Files;
use eng_flexible::read::matrix::{ForeignMatrix, read_abaqus_matrix, read_dmig, read_op4};
use nalgebra::{DMatrix, DVector};
use std::io::{Cursor, Read};
use std::path::Path;
use std::process::{Command, Output};

struct Written(Vec<BodyFile>);

impl Files for Written {
    fn open(&self, name: &str) -> std::io::Result<Box<dyn Read>> {
        let file = self.0.iter().find(|file| file.name == name);
        let file = file.ok_or(std::io::ErrorKind::NotFound)?;
        Ok(Box::new(Cursor::new(file.contents.clone())))
    }
}

fn bar(body: &str) -> Reduction {
    reduced(
        include_str!("mesh/bar.bdf"),
        &format!(
            "{body}; damping = 1 %; marker tip = patch(center: [0, 0, 200] mm, normal: z, radius: 15 mm)
            marker foot = patch(center: [0, 0, 0] mm, normal: z, radius: 15 mm, tie: rigid)"
        ),
    )
}

/// The only body of a model, from a deck in mm, t and s.
fn reduced(deck: &str, body: &str) -> Reduction {
    let text = format!(
        "model Bar {{ gravity = [0, 0, 0] m/s^2
            flexible bar {{ mesh = nastran(\"bar.bdf\", units: mm_tonne_s); {body} }} }}"
    );
    let sources = Sources::from_texts([
        ("bar.eng".to_owned(), text),
        ("bar.bdf".to_owned(), deck.to_owned()),
    ]);
    let program: Program = match eng::check(&sources, "bar.eng").into_program() {
        Ok(program) => program,
        Err(report) => panic!("{report}"),
    };
    program.model("Bar").expect("a model").reductions()[0].clone()
}

/// A matrix of a file as a dense one; one triangle is mirrored.
fn dense(matrix: &ForeignMatrix, rows: usize, columns: usize) -> DMatrix<f64> {
    let mut values = DMatrix::zeros(rows, columns);
    for &(row, column, value) in &matrix.entries {
        let (row, column) = (row as usize, column as usize);
        values[(row, column)] = value;
        if matrix.symmetric {
            values[(column, row)] = value;
        }
    }
    values
}

fn close(a: &DMatrix<f64>, b: &DMatrix<f64>, relative: f64) {
    assert!((a - b).amax() <= relative * b.amax(), "{a} {b}");
}

#[test]
fn a_free_body_keeps_its_frequencies_in_every_format() {
    let bar = bar("modes = static(at: tip, freedoms: [x, y, z]) + normal(6)");
    let frequencies = bar.frequencies();
    let size = 6 + frequencies.len();
    let op4 = Written(bar.files(BodyFormat::Op4, 1).expect("files"));
    let of_op4 = |name: &str, rows| {
        let matrix = read_op4(&op4, "bar.op4", name).expect("a matrix");
        assert_eq!((matrix.rows, matrix.columns), (rows, size));
        dense(&matrix, rows, size)
    };
    let [stiffness, mass, damping] = ["KENG", "MENG", "BENG"].map(|name| of_op4(name, size));
    // M⁻¹ᐟ² K M⁻¹ᐟ²
    let root = mass.clone().cholesky().expect("a positive mass").l();
    let inverse = root.try_inverse().expect("an inverse");
    let mut found = (&inverse * &stiffness * inverse.transpose())
        .symmetric_eigen()
        .eigenvalues
        .iter()
        .map(|value| value.abs().sqrt() / std::f64::consts::TAU)
        .collect::<Vec<_>>();
    found.sort_by(f64::total_cmp);
    assert!(found[5] < 1e-3 * found[6], "{found:?}");
    for (found, expected) in found[6..].iter().zip(frequencies) {
        assert!((found / expected - 1.0).abs() < 1e-9, "{found} {expected}");
    }
    // points of Nastran: two markers, then the coordinates. A coordinate without entries is not in its matrix.
    let dmig = Written(bar.files(BodyFormat::Dmig, 1001).expect("files"));
    for (name, expected) in [("KENG", &stiffness), ("MENG", &mass), ("BENG", &damping)] {
        let matrix = read_dmig(&dmig, "bar.bdf", name).expect("a matrix");
        let rows = matrix.freedoms.clone().expect("freedoms").rows;
        let left = size - rows.len();
        assert!(
            rows.iter()
                .all(|(point, freedom)| *point >= 1003 && *freedom == 0)
        );
        assert_eq!(rows[0].0, 1003 + left as u64);
        let found = dense(&matrix, rows.len(), rows.len());
        let part = expected.view((left, left), (rows.len(), rows.len()));
        close(&found, &part.into_owned(), 1e-9);
    }
    let abaqus = Written(bar.files(BodyFormat::Abaqus, 1).expect("files"));
    for (kind, expected) in [
        ("stiffness", &stiffness),
        ("mass", &mass),
        ("damping", &damping),
    ] {
        let matrix = read_abaqus_matrix(&abaqus, &format!("bar.{kind}.mtx"), "").expect("a matrix");
        let rows = matrix.freedoms.clone().expect("freedoms").rows;
        let left = size - rows.len();
        let found = dense(&matrix, rows.len(), rows.len());
        let part = expected.view((left, left), (rows.len(), rows.len()));
        close(&found, &part.into_owned(), 1e-15);
    }
}

/// The only body of a model that reads files of Abaqus' deck `bar.inp`.
fn read_back(files: &[BodyFile], modes: usize) -> Result<Reduction, String> {
    let text = format!(
        "model Bar {{ gravity = [0, 0, 0] m/s^2
            flexible bar {{
                mesh = abaqus(\"bar.inp\", units: si); modes = normal({modes}); damping = 1 %
                marker tip = node(1); marker foot = node(2)
            }} }}"
    );
    let texts = files.iter().map(|file| {
        let text = String::from_utf8(file.contents.clone()).expect("a text");
        (file.name.clone(), text)
    });
    let sources = Sources::from_texts(texts.chain([("bar.eng".to_owned(), text)]));
    match eng::check(&sources, "bar.eng").into_program() {
        Ok(program) => match program.model("Bar") {
            Ok(model) => Ok(model.reductions()[0].clone()),
            Err(error) => Err(error.to_string()),
        },
        Err(report) => Err(report.to_string()),
    }
}

/// Eng reads its own deck of Abaqus: frame and markers are nodes, amplitudes are scalar points.
#[test]
fn a_deck_of_abaqus_is_read_back() {
    let bar = bar("modes = static(at: tip, freedoms: [x, y, z]) + normal(6)");
    let files = bar.files(BodyFormat::Abaqus, 1).expect("files");
    let back = read_back(&files, bar.frequencies().len()).expect("a body");
    assert_eq!(back.frequencies().len(), bar.frequencies().len());
    for (found, exact) in back.frequencies().iter().zip(bar.frequencies()) {
        assert!((found / exact - 1.0).abs() < 1e-9, "{found} {exact}");
    }
    // rigid motion and flexibility between the markers, which do not depend on the choice of the frame and of
    // the modes
    let whole = |body: &Reduction| {
        let size = 6 + body.frequencies().len();
        let files = Written(body.files(BodyFormat::Op4, 1).expect("files"));
        let read = |name: &str, rows: usize| {
            dense(
                &read_op4(&files, "bar.op4", name).expect("a matrix"),
                rows,
                size,
            )
        };
        let (k, m, l) = (read("KENG", size), read("MENG", size), read("LENG", 12));
        let square = (2.0 * std::f64::consts::PI * 100.0_f64).powi(2);
        let dynamic = k - m * square;
        &l * dynamic.lu().solve(&l.transpose()).expect("a motion")
    };
    close(&whole(&back), &whole(&bar), 1e-8);
    // without the set of modal nodes their freedoms are displacements, which a rigid motion would strain
    let plain: Vec<BodyFile> = files
        .iter()
        .map(|file| {
            let text = String::from_utf8(file.contents.clone()).expect("a text");
            let text = text.replace("_MODAL_FREEDOMS", "_OTHERS");
            BodyFile {
                name: file.name.clone(),
                contents: text.into_bytes(),
            }
        })
        .collect();
    let report = read_back(&plain, 3).expect_err("amplitudes are no displacements");
    assert!(report.contains("freedoms have no stiffness"), "{report}");
}

/// Cantilever under a force at its tip, as the whole mesh yields and as a beam: `F L³/(3 E I)` and shear
/// `F L/(k G A)`, with k by Cowper (J. Appl. Mech. 33 (1966) 335).
#[test]
fn a_held_body_bends_as_a_cantilever() {
    let bar = bar("support = foot; modes = static(at: tip, freedoms: [x, y, z]) + normal(2)");
    let size = 6 + bar.frequencies().len();
    let files = Written(bar.files(BodyFormat::Op4, 1).expect("files"));
    let stiffness = dense(&read_op4(&files, "bar.op4", "KENG").expect("K"), size, size);
    let motion = dense(&read_op4(&files, "bar.op4", "LENG").expect("L"), 12, size);
    let elastic = stiffness.view((6, 6), (size - 6, size - 6)).into_owned();
    // the frame is fixed; the tip is the first marker
    let along_x: DVector<f64> = motion.row(0).columns(6, size - 6).transpose();
    let bent = elastic.cholesky().expect("a stiffness").solve(&along_x);
    let (young, poisson, side, length) = (210e9, 0.3, 0.02f64, 0.2f64);
    let second = side.powi(4) / 12.0;
    let shear = young / (2.0 * (1.0 + poisson));
    let cowper = 10.0 * (1.0 + poisson) / (12.0 + 11.0 * poisson);
    let expected =
        length.powi(3) / (3.0 * young * second) + length / (cowper * shear * side * side);
    let found = along_x.dot(&bent);
    // eight hexahedra in a row are 2.4 % stiffer than the beam
    assert!((found / expected - 1.0).abs() < 3e-2, "{found} {expected}");
    // the flexibility of the whole mesh, in um/kN with six digits
    let text = bar.text();
    let line = text.lines().find(|line| line.contains("static tip.x "));
    let of_mesh = line.and_then(|line| line.split_whitespace().last());
    let of_mesh: f64 = of_mesh
        .and_then(|word| word.parse().ok())
        .expect("a flexibility");
    assert!(
        (found * 1e9 / of_mesh - 1.0).abs() < 1e-5,
        "{found} {of_mesh}"
    );
    // a turn of the frame moves the tip by its lever
    assert!((motion[(0, 4)] - length).abs() < 1e-12, "{motion}");
    assert!((motion[(1, 3)] + length).abs() < 1e-12, "{motion}");
}

/// Four beams without mass between five lumps, in no plane.
const LUMPS: &str = "GRID,1,,0.,0.,0.
GRID,2,,100.,10.,0.
GRID,3,,180.,90.,20.
GRID,4,,150.,160.,110.
GRID,5,,60.,170.,180.
CBAR,1,1,1,2,0.,0.,1.
CBAR,2,1,2,3,0.,0.,1.
CBAR,3,1,3,4,1.,0.,0.
CBAR,4,1,4,5,1.,0.,0.
PBAR,1,1,100.,800.,900.,1500.
MAT1,1,2.1+5,,.3
CONM2,11,1,,1.-3
CONM2,12,2,,2.-3
CONM2,13,3,,1.5-3
CONM2,14,4,,3.-3
CONM2,15,5,,2.5-3
";

/// The numbers of a record group, without lines of comments.
fn record(text: &str, number: usize) -> Vec<f64> {
    let head = format!("** RECORD GROUP {number},");
    let lines = text
        .lines()
        .skip_while(|line| !line.starts_with(&head))
        .skip(1);
    let lines =
        lines.take_while(|line| !line.starts_with("** RECORD") && !line.starts_with("** END"));
    let lines = lines.filter(|line| !line.starts_with("**"));
    lines
        .flat_map(str::split_whitespace)
        .map(|word| word.parse().expect("a number"))
        .collect()
}

/// The data of MBDyn's joint against the sums that its manual states, over the five lumps and their shapes. The body is held at
/// one lump: the shapes of a free body have no momentum, so two sums would be zero.
#[test]
fn the_data_of_a_modal_joint_are_sums_over_lumps() {
    let markers: String = (1..=5)
        .map(|k| format!("marker m{k} = node({k}); "))
        .collect();
    let bar = reduced(
        LUMPS,
        &format!("support = m1; modes = normal(8); damping = 1 %; {markers}"),
    );
    let files = bar.files(BodyFormat::Mbdyn, 1).expect("files");
    let text = std::str::from_utf8(&files[1].contents).expect("a text");
    assert_eq!(files[1].name, "bar.fem");
    let n = bar.frequencies().len();
    assert!(text.contains(&format!("REV0 5 {n} 0 0 0\n")), "{text}");
    let places: [Vec<f64>; 3] = [5, 6, 7].map(|number| record(text, number));
    let shapes = record(text, 8);
    assert_eq!(shapes.len(), 5 * n * 6);
    let masses = [1.0, 2.0, 1.5, 3.0, 2.5];
    let vector = |values: [f64; 3]| nalgebra::Vector3::from(values);
    let place = |lump: usize| vector([0, 1, 2].map(|axis| places[axis][lump]));
    let shape = |lump: usize, mode: usize| {
        let first = (mode * 5 + lump) * 6;
        vector([0, 1, 2].map(|axis| shapes[first + axis]))
    };
    let sum = |part: &dyn Fn(usize) -> nalgebra::Matrix3<f64>| {
        (0..5)
            .map(|lump| masses[lump] * part(lump))
            .sum::<nalgebra::Matrix3<f64>>()
    };
    let total: f64 = masses.iter().sum();
    let centre = (0..5)
        .map(|k| masses[k] / total * place(k))
        .sum::<nalgebra::Vector3<f64>>();
    let about = sum(&|k| {
        let arm = (place(k) - centre).cross_matrix();
        -arm * arm
    });
    let rigid: Vec<f64> = [total]
        .into_iter()
        .chain(centre.iter().copied())
        .chain(about.transpose().iter().copied())
        .collect();
    let mut expected = vec![(12, rigid)];
    let columns = |part: &dyn Fn(usize, usize) -> nalgebra::Vector3<f64>| {
        let column = |mode: usize| {
            (0..5)
                .map(|k| masses[k] * part(k, mode))
                .sum::<nalgebra::Vector3<f64>>()
        };
        DMatrix::from_fn(3, n, |row, mode| column(mode)[row])
    };
    let by_rows = |matrix: DMatrix<f64>| matrix.transpose().as_slice().to_vec();
    expected.push((14, by_rows(columns(&|k, mode| shape(k, mode)))));
    expected.push((
        15,
        by_rows(columns(&|k, mode| place(k).cross(&shape(k, mode)))),
    ));
    let wide = |columns: usize, part: &dyn Fn(usize) -> nalgebra::Matrix3<f64>| {
        let parts: Vec<_> = (0..columns).map(part).collect();
        by_rows(DMatrix::from_fn(3, 3 * columns, |row, column| {
            parts[column / 3][(row, column % 3)]
        }))
    };
    expected.push((
        16,
        wide(n, &|mode| {
            sum(&|k| -place(k).cross_matrix() * shape(k, mode).cross_matrix())
        }),
    ));
    let crossed = |j: usize, k: usize| {
        (0..5)
            .map(|lump| masses[lump] * shape(lump, j).cross(&shape(lump, k)))
            .sum::<nalgebra::Vector3<f64>>()
    };
    expected.push((
        17,
        by_rows(DMatrix::from_fn(3, n * n, |row, pair| {
            crossed(pair / n, pair % n)[row]
        })),
    ));
    expected.push((
        18,
        wide(n * n, &|pair| {
            sum(&|k| shape(k, pair / n).cross_matrix() * shape(k, pair % n).cross_matrix())
        }),
    ));
    expected.push((
        9,
        by_rows(DMatrix::from_fn(n, n, |i, j| {
            (0..5)
                .map(|k| masses[k] * shape(k, i).dot(&shape(k, j)))
                .sum()
        })),
    ));
    for (number, expected) in expected {
        let found = record(text, number);
        assert_eq!(found.len(), expected.len(), "record group {number}");
        let size = expected
            .iter()
            .fold(0.0_f64, |size, value| size.max(value.abs()));
        for (found, expected) in found.iter().zip(&expected) {
            let error = (found - expected).abs();
            assert!(
                error <= 1e-11 * size,
                "record group {number}: {found} {expected} of {size}"
            );
        }
    }
    // the joint has the frequencies of the body
    let matrix = |number: usize| DMatrix::from_row_slice(n, n, &record(text, number));
    let (mass, stiffness, damping) = (matrix(9), matrix(10), matrix(13));
    for (mode, frequency) in bar.frequencies().iter().enumerate() {
        let found = (stiffness[(mode, mode)] / mass[(mode, mode)]).sqrt();
        let exact = std::f64::consts::TAU * frequency;
        assert!((found / exact - 1.0).abs() < 1e-9, "{found} {exact}");
        let share = damping[(mode, mode)] / (2.0 * exact * mass[(mode, mode)]);
        assert!((share - 0.01).abs() < 1e-9, "{share}");
    }
}

fn reduce(folder: &Path, words: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_eng"))
        .current_dir(folder)
        .env("ENG_CACHE", folder.join("cache"))
        .arg("reduce")
        .args(words)
        .output()
        .expect("the command runs")
}

/// A bar whose ends are held in some freedoms is a simply supported beam.
#[test]
fn a_support_may_hold_single_freedoms() {
    let mut deck =
        String::from("PBAR,1,1,100.,833.3333,833.3333,1400.\nMAT1,1,210000.,,.3,7.85-9\n");
    for node in 1..=21 {
        deck += &format!("GRID,{node},,{:.1},0.,0.\n", 50.0 * f64::from(node - 1));
    }
    for bar in 1..=20 {
        deck += &format!("CBAR,{bar},1,{bar},{},0.,0.,1.\n", bar + 1);
    }
    let body = reduced(
        &deck,
        "support = [held(at: left, freedoms: [x, y, z, rx]), held(at: right, freedoms: [y, z])]; modes = normal(3)
            damping = 1 %; marker left = node(1); marker right = node(21)",
    );
    // (π/L)² √(E I/(ρ A)) in both planes; the inertia of the sections takes 4e-5
    let first = std::f64::consts::FRAC_PI_2 * libm::sqrt(210e9 * 833.3333e-12 / (7850.0 * 1e-4));
    let found = body.frequencies();
    for (frequency, expected) in found.iter().zip([first, first, 4.0 * first]) {
        assert!((frequency / expected - 1.0).abs() < 3e-4, "{found:?}");
    }
}

#[test]
fn the_command_writes_bodies_or_says_why_not() {
    let folder = std::env::temp_dir().join(format!("eng-hand-over-{}", std::process::id()));
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).expect("a folder");
    let meshes = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/mesh");
    for name in ["bar.eng", "bar.bdf"] {
        std::fs::copy(meshes.join(name), folder.join(name)).expect("a copy");
    }
    let done = reduce(
        &folder,
        &["bar.eng", "--to", "dmig", "--out", "out", "--body", "bar"],
    );
    let said = String::from_utf8_lossy(&done.stdout).into_owned();
    assert!(done.status.success() && said.contains("bar.bdf"), "{said}");
    let json = std::fs::read_to_string(folder.join("out/bar.json")).expect("a description");
    assert!(
        json.contains("\"rotation z\"") && json.contains("\"mode 1\""),
        "{json}"
    );
    // every node moves along x; node 9999 is not in the mesh
    let values = "  1.00000E+00  0.00000E+00  0.00000E+00\n";
    let nodes: String = (1..=104)
        .chain([9999])
        .map(|node| format!("{node:10}\n{values}"))
        .collect();
    let heading = "\n\n\n\n\n         1         2         2         8         2         3\n         2         4         1         7\n  2.50000E+02  0.00000E+00  0.00000E+00  0.00000E+00\n";
    let shapes = format!("    -1\n    55\n{heading}{nodes}    -1\n");
    std::fs::write(folder.join("shapes.unv"), shapes).expect("a file of shapes");
    let done = reduce(&folder, &["bar.eng", "--compare", "shapes.unv"]);
    let said = String::from_utf8_lossy(&done.stdout).into_owned();
    let line = "compared with shapes.unv: 104 of its 105 nodes are in the mesh\n";
    let (_, table) = said.split_once(line).expect("a comparison");
    let row: Vec<&str> = table
        .lines()
        .nth(1)
        .unwrap_or("")
        .split_whitespace()
        .collect();
    let ["7", "250.0000", nearest, ours, difference, "%", assurance] = row[..] else {
        panic!("{table}");
    };
    let number = |text: &str| text.parse::<f64>().expect("a number");
    assert!((1.0..=9.0).contains(&number(nearest)), "{table}");
    let expected = 100.0 * (number(ours) / 250.0 - 1.0);
    assert!((number(difference) - expected).abs() < 1e-3, "{table}");
    // bending along x, but not the same everywhere
    assert!((0.4..0.9).contains(&number(assurance)), "{table}");
    let mut refusals = String::new();
    for words in [
        &["bar.eng", "--to", "op4"][..],
        &["bar.eng", "--out", "elsewhere"],
        &[
            "bar.eng",
            "--to",
            "op4",
            "--out",
            "elsewhere",
            "--body",
            "crank",
        ],
        &[
            "bar.eng",
            "--to",
            "dmig",
            "--out",
            "elsewhere",
            "--first-point",
            "0",
        ],
        &[
            "bar.eng",
            "--to",
            "abaqus",
            "--out",
            "elsewhere",
            "--first-point",
            "99999999",
        ],
        &["bar.eng", "--to", "op4", "--out", "bar.bdf"],
        &["bar.eng", "--body", "bar"],
        &["bar.eng", "--compare", "none.op2"],
        &["bar.eng", "--compare", "bar.eng"],
        &["bar.eng", "--compare", "bar.bdf"],
        &["bar.eng", "--compare", "shapes.unv", "--body", "crank"],
    ] {
        let output = reduce(&folder, words);
        assert_eq!(output.status.code(), Some(2), "{words:?}");
        assert!(!folder.join("elsewhere").exists(), "{words:?}");
        let said = String::from_utf8_lossy(&output.stderr);
        let line = said
            .lines()
            .find(|line| line.starts_with("error"))
            .unwrap_or_default();
        refusals.push_str(line);
        refusals.push('\n');
    }
    insta::assert_snapshot!(refusals);
    std::fs::remove_dir_all(&folder).expect("the folder goes");
}
