//! Matrices of other codes: the numbers that are written are read, in every variant.

use crate::foreign_files::*;
use eng_flexible::read::matrix::*;
use eng_flexible::{FileProblem, Place};

const LAYOUTS: [Layout; 3] = [Layout::Dense, Layout::Strings, Layout::Big];

fn read(bytes: Vec<u8>, file: &str, name: &str) -> ForeignMatrix {
    match read_by_name(&OneFile(bytes), file, name) {
        Ok(matrix) => matrix,
        Err(problem) => panic!("{problem} ({})", problem.advice),
    }
}

fn problem(bytes: Vec<u8>, file: &str, name: &str) -> FileProblem {
    match read_by_name(&OneFile(bytes), file, name) {
        Err(problem) => problem,
        Ok(matrix) => panic!("read without a problem: {matrix:?}"),
    }
}

/// Largest difference of two matrices, as a part of the entries.
fn difference(found: &[Vec<f64>], expected: &[Vec<f64>]) -> f64 {
    assert_eq!(found.len(), expected.len());
    let pairs = found.iter().flatten().zip(expected.iter().flatten());
    pairs.fold(0.0, |worst: f64, (a, b)| {
        worst.max((a - b).abs() / b.abs().max(1e-300))
    })
}

/// Checks the conversion of a symmetric matrix.
fn converts(matrix: &ForeignMatrix, expected: &Dense, within: f64) {
    let symmetric = matrix
        .to_symmetric(MatrixKind::Mass)
        .unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(symmetric.size(), expected.rows);
    let lower = ForeignMatrix {
        symmetric: true,
        entries: (0..symmetric.size())
            .flat_map(|column| {
                let (rows, values) = symmetric.column(column);
                let entries = rows.iter().zip(values);
                entries.map(move |(row, value)| (*row, column as u32, *value))
            })
            .collect(),
        ..matrix.clone()
    };
    let found = Dense::read(&lower);
    assert!(difference(&found, &expected.columns) <= within);
}

#[test]
fn op4_in_binary_is_read_exactly_in_every_variant() {
    for layout in LAYOUTS {
        for single in [false, true] {
            for (big_endian, wide) in [(false, false), (true, false), (false, true), (true, true)] {
                let [k, phi] = [
                    Dense::symmetric("KAA", 23),
                    Dense::rectangular("PHA", 23, 4),
                ];
                let [k, phi] = if single {
                    [k.single(), phi.single()]
                } else {
                    [k, phi]
                };
                let file = op4_binary(&[k.clone(), phi.clone()], layout, single, big_endian, wide);
                let found = read(file.clone(), "a.op4", "KAA");
                assert_eq!(
                    (found.rows, found.columns, found.symmetric),
                    (23, 23, false)
                );
                assert_eq!(Dense::read(&found), k.columns, "{layout:?} {single} {wide}");
                converts(&found, &k, 0.0);
                assert_eq!(Dense::read(&read(file, "a.OP4", "pha")), phi.columns);
            }
        }
    }
}

#[test]
fn op4_as_text_is_read_to_the_last_digit() {
    for layout in LAYOUTS {
        for single in [false, true] {
            let [k, phi] = [
                Dense::symmetric("KAA", 23),
                Dense::rectangular("PHA", 23, 4),
            ];
            // 17 digits are a double
            let file = op4_text(&[k.clone(), phi.clone()], layout, single).into_bytes();
            assert_eq!(
                Dense::read(&read(file.clone(), "a.op4", "KAA")),
                k.columns,
                "{layout:?}"
            );
            assert_eq!(Dense::read(&read(file, "a.op4", "PHA")), phi.columns);
        }
    }
}

#[test]
fn long_strings_and_many_rows() {
    // a length of 32769 words and more makes the word of a string negative
    let matrix = Dense::rectangular("V", 20_000, 2);
    for layout in LAYOUTS {
        let file = op4_binary(std::slice::from_ref(&matrix), layout, false, false, false);
        assert_eq!(Dense::read(&read(file, "v.op4", "")), matrix.columns);
    }
}

#[test]
fn gzip_is_unpacked() {
    use std::io::Write;
    let k = Dense::symmetric("KGG", 12);
    let mut packed = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
    packed
        .write_all(&op4_binary(
            std::slice::from_ref(&k),
            Layout::Strings,
            false,
            true,
            false,
        ))
        .and_then(|()| packed.flush())
        .unwrap_or_else(|error| panic!("{error}"));
    let bytes = packed.finish().unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(Dense::read(&read(bytes, "k.op4.gz", "")), k.columns);
}

#[test]
fn problems_of_op4_say_what_and_where() {
    let k = [Dense::symmetric("KAA", 5), Dense::symmetric("MAA", 6)];
    let file = op4_binary(&k, Layout::Dense, false, false, false);
    let missing = problem(file.clone(), "a.op4", "MGG");
    assert_eq!(missing.problem, "contains no matrix MGG");
    assert_eq!(missing.advice, "the file contains KAA (5 × 5), MAA (6 × 6)");
    assert!(
        problem(file.clone(), "a.op4", "")
            .advice
            .contains("name one")
    );
    // cut inside the last record, and after a whole one
    let cut = problem(file[..file.len() - 6].to_vec(), "a.op4", "MAA");
    assert!(cut.problem.contains("ends inside a record"), "{cut}");
    let cut = problem(file[..file.len() - 28].to_vec(), "a.op4", "MAA");
    assert!(
        cut.problem
            .contains("inside matrix MAA, after column 6 of 6"),
        "{cut}"
    );
    assert!(
        matches!(cut.place, Place::Record { record: 12, .. }),
        "{cut:?}"
    );
    // a complex one
    let mut complex = file.clone();
    complex[16] = 4;
    let complex = problem(complex, "a.op4", "KAA");
    assert!(
        complex.problem.contains("matrix KAA is complex"),
        "{complex}"
    );
    // no OP4 at all
    let other = problem(b"\x89PNG....".to_vec(), "a.op4", "KAA");
    assert!(other.problem.contains("no OP4 file"), "{other}");
    // NaN
    let mut k = Dense::symmetric("KAA", 5);
    k.columns[1][2] = f64::NAN;
    let nan = problem(
        op4_binary(&[k], Layout::Dense, false, false, false),
        "a.op4",
        "KAA",
    );
    assert!(
        nan.problem.contains("contains NaN at row 3, column 2"),
        "{nan}"
    );
    let text = op4_text(&[Dense::symmetric("KAA", 5)], Layout::Dense, false);
    let lines = text.lines().collect::<Vec<_>>();
    let stars = lines[2].replace(&lines[2][..23], &"*".repeat(23));
    let bad = text.replacen(lines[2], &stars, 1);
    let bad = problem(bad.into_bytes(), "a.op4", "KAA");
    assert_eq!(bad.place, Place::Line(3));
    let short = text.replacen(lines[2], &lines[2][..20], 1);
    let short = problem(short.into_bytes(), "a.op4", "KAA");
    assert!(short.problem.contains("has 20 characters"), "{short}");
}

#[test]
fn dmig_has_freedoms_and_one_triangle() {
    let k = Dense::symmetric("KAAX", 13);
    let points = (0..13_u64)
        .map(|i| {
            if i < 12 {
                (100 + i / 6, (i % 6 + 1) as u8)
            } else {
                (900, 0)
            }
        })
        .collect::<Vec<_>>();
    for one_triangle in [true, false] {
        let text = dmig(&k, &points, one_triangle)
            + "$ more\n"
            + &dmig(&Dense::symmetric("MAAX", 12), &points, true);
        let found = read(text.into_bytes(), "k.pch", "KAAX");
        assert_eq!(found.symmetric, one_triangle);
        // the fourth freedom has no entry and so no row
        let kept = (0..13).filter(|i| *i != 3).collect::<Vec<_>>();
        let rows = kept.iter().map(|i| points[*i]).collect::<Vec<_>>();
        assert_eq!(
            found.freedoms.as_ref().map(|freedoms| &freedoms.rows),
            Some(&rows)
        );
        let columns = kept
            .iter()
            .map(|j| kept.iter().map(|i| k.columns[*j][*i]).collect::<Vec<_>>())
            .collect::<Vec<_>>();
        // nine digits after the point
        assert!(difference(&Dense::read(&found), &columns) < 6e-10);
        let symmetric = found.to_symmetric(MatrixKind::Stiffness);
        assert_eq!(symmetric.map(|matrix| matrix.size()), Ok(12));
    }
}

#[test]
fn dmig_in_small_and_free_fields() {
    let small = "DMIG    K              0       6       2       0                       2
DMIG    K              1       1               1       1      3.
DMIG    K              1       2               1       1     -1.
               1       2      4.
";
    let free = "DMIG,K,0,6,2,0\nDMIG,K,1,1,,1,1,3.\nDMIG,K,1,2,,1,1,-1.\n,1,2,4.\n";
    for deck in [small, free] {
        let found = read(deck.into(), "k.bdf", "");
        assert_eq!(
            found.entries,
            [(0, 0, 3.0), (0, 1, -1.0), (1, 1, 4.0)],
            "{deck}"
        );
    }
    let lost = problem(b"DMIG,K,1,1,,1,1,3.\n".to_vec(), "k.bdf", "K");
    assert!(lost.problem.contains("before the head"), "{lost}");
    assert_eq!(lost.place, Place::Line(1));
    let complex = problem(
        b"DMIG,K,0,6,4,0\nDMIG,K,1,1,,1,1,3.,1.\n".to_vec(),
        "k.bdf",
        "K",
    );
    assert!(complex.problem.contains("complex"), "{complex}");
    let numbered = read(
        b"DMIG,P,0,9,2,0,,,3\nDMIG,P,2,0,,7,1,3.\n".to_vec(),
        "p.pch",
        "P",
    );
    assert_eq!((numbered.rows, numbered.columns), (1, 3));
    assert_eq!(numbered.entries, [(0, 1, 3.0)]);
    let blank = problem(
        b"DMIG,P,0,9,2,0\nDMIG,P,2,0,,7,1,3.\n".to_vec(),
        "p.pch",
        "P",
    );
    assert!(blank.problem.contains("NCOL is missing"), "{blank}");
    assert_eq!(blank.place, Place::Line(1));
    let few = problem(
        b"DMIG,P,0,9,2,0,,,1\nDMIG,P,2,0,,7,1,3.\n".to_vec(),
        "p.pch",
        "P",
    );
    assert!(
        few.problem
            .contains("column 2 is beyond NCOL, which states 1"),
        "{few}"
    );
}

/// Lines `row column value` of a triangle or all.
fn coordinates(matrix: &Dense, keep: fn(usize, usize) -> bool) -> Vec<u8> {
    let mut text = String::new();
    for (column, values) in matrix.columns.iter().enumerate() {
        for (row, value) in values.iter().enumerate() {
            if *value != 0.0 && keep(row, column) {
                text += &format!("{:10} {:10} {value:.16e}\n", row + 1, column + 1);
            }
        }
    }
    text.into_bytes()
}

#[test]
fn calculix_triangle_and_abaqus_coordinates() {
    let k = Dense::symmetric("", 15);
    let upper = read(coordinates(&k, |row, column| row <= column), "k.sti", "");
    assert!(upper.symmetric);
    assert_eq!(Dense::read(&upper), k.columns);
    converts(&upper, &k, 0.0);
    let dof = (0..15)
        .map(|i| format!("{}.{}\n", i / 3 + 7, i % 3 + 1))
        .collect::<String>();
    let freedoms = read_calculix_freedoms(&OneFile(dof.into_bytes()), "k.dof");
    let freedoms = freedoms.unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(freedoms.rows[4], (8, 2));
    assert!(upper.clone().with_freedoms(freedoms.clone()).is_ok());
    let fewer = ForeignFreedoms {
        rows: freedoms.rows[1..].to_vec(),
    };
    assert!(upper.with_freedoms(fewer).is_err());
    let both = read(coordinates(&k, |_, _| true), "k.mtx", "");
    assert!(!both.symmetric);
    assert_eq!(Dense::read(&both), k.columns);
    converts(&both, &k, 0.0);
}

#[test]
fn abaqus_matrix_input_names_nodes() {
    let text = b"** matrix\n7,1, 7,1,  3.0e+00\n12,2, 7,1, -1.\n12,2, 12,2, 4.D0\n".to_vec();
    let found = read(text, "k_STIF1.mtx", "");
    assert_eq!(found.entries, [(0, 0, 3.0), (1, 0, -1.0), (1, 1, 4.0)]);
    assert_eq!(
        found.freedoms,
        Some(ForeignFreedoms {
            rows: vec![(7, 1), (12, 2)]
        })
    );
    assert!(found.symmetric);
    let held = problem(b"1 1 1e36\n".to_vec(), "k.mtx", "");
    assert!(held.problem.contains("support"), "{held}");
    let element = problem(b"**\n*USER ELEMENT,NODES=2,LINEAR\n".to_vec(), "k.mtx", "");
    assert_eq!(element.place, Place::Line(2));
    assert!(
        problem(b"0 1 1.\n".to_vec(), "k.mtx", "")
            .advice
            .contains("numbers from 1")
    );
    assert!(
        problem(b"1 1 nan\n".to_vec(), "k.sti", "")
            .problem
            .contains("finite")
    );
    assert!(
        problem(Vec::new(), "k.mas", "")
            .problem
            .contains("no entry")
    );
}

fn matrix(symmetric: bool, size: usize, entries: &[(u32, u32, f64)]) -> ForeignMatrix {
    ForeignMatrix {
        file: "f".into(),
        name: "K".into(),
        rows: size,
        columns: size,
        symmetric,
        entries: entries.to_vec(),
        freedoms: Some(ForeignFreedoms {
            rows: vec![(5, 1), (5, 2), (6, 3)],
        }),
    }
}

#[test]
fn conversion_refuses_what_is_no_symmetric_matrix() {
    let say = |matrix: &ForeignMatrix, kind| match matrix.to_symmetric(kind) {
        Ok(found) => panic!("converted: {found:?}"),
        Err(error) => error.to_string(),
    };
    let stiffness = MatrixKind::Stiffness;
    let diagonal = [(0, 0, 2.0), (1, 1, 3.0), (2, 2, 1e6)];
    let with = |more: &[(u32, u32, f64)]| [&diagonal[..], more].concat();
    // the worst of two
    let wrong = matrix(
        false,
        3,
        &with(&[(0, 1, 1.0), (1, 0, 1.0 + 1e-6), (0, 2, 0.5)]),
    );
    let text = say(&wrong, stiffness);
    assert!(
        text.starts_with("f: matrix K is not symmetric: the worst entry, at row 3 (node 6, freedom 3), column 1, is 0, and its mirror image is 0.5"),
        "{text}"
    );
    // 1e-10 of the row's norm is rounding: the mean is taken
    let near = matrix(false, 3, &with(&[(0, 1, 1.0), (1, 0, 1.0 + 4e-10)]));
    let near = near
        .to_symmetric(stiffness)
        .unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(near.column(0).1, [2.0, 1.0 + 2e-10]);
    // in one triangle entries add, and those of both sides must agree
    let twice = matrix(true, 3, &with(&[(0, 1, 1.0), (0, 1, 0.5), (1, 0, 1.5)]));
    let twice = twice
        .to_symmetric(stiffness)
        .unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(twice.column(0).1, [2.0, 1.5]);
    let other = matrix(true, 3, &with(&[(0, 1, 1.0), (1, 0, 2.0)]));
    assert!(say(&other, stiffness).contains("not symmetric"));
    let negative = matrix(true, 3, &[(0, 0, 1.0), (1, 1, -2.0)]);
    assert!(
        say(&negative, MatrixKind::Mass)
            .contains("-2 on its diagonal at row 2 (node 5, freedom 2)")
    );
    assert!(negative.to_symmetric(stiffness).is_ok());
    assert!(say(&matrix(true, 3, &[(0, 0, f64::INFINITY)]), stiffness).contains("inf"));
    assert!(say(&matrix(true, 3, &[(0, 3, 1.0)]), stiffness).contains("row 1, column 4"));
    assert!(
        say(&matrix(true, 4_000_000_000, &[(0, 0, 1.0)]), stiffness).contains("only 1 entries")
    );
    let mut rectangular = matrix(false, 3, &diagonal);
    rectangular.columns = 4;
    assert!(say(&rectangular, stiffness).contains("3 × 4"));
}
