//! OP2 files, and mode shapes of other codes.

use crate::foreign_files::*;
use eng_flexible::FileProblem;
use eng_flexible::read::matrix::*;

const NODES: [i64; 3] = [11, 12, 40];
const MODES: [(i64, f64); 2] = [(1, 1024.0), (2, 4096.0)];
const VARIANTS: [(bool, bool, bool); 5] = [
    (false, false, false),
    (true, false, false),
    (false, true, false),
    (true, true, true),
    (false, false, true),
];

fn good<T>(found: Result<T, FileProblem>) -> T {
    found.unwrap_or_else(|problem| panic!("{problem} ({})", problem.advice))
}

fn bad<T: std::fmt::Debug>(found: Result<T, FileProblem>) -> FileProblem {
    match found {
        Err(problem) => problem,
        Ok(found) => panic!("read without a problem: {found:?}"),
    }
}

/// Checks shapes of [`MODES`] at [`NODES`]; `freedoms` of six exist.
fn are_the_modes(modes: &ForeignModes, freedoms: usize, eigenvalues: [f64; 2], within: f64) {
    assert_eq!(modes.nodes, NODES.map(|node| node as u64));
    assert_eq!(modes.modes.len(), 2);
    for (mode, ((number, _), eigenvalue)) in modes.modes.iter().zip(MODES.iter().zip(eigenvalues)) {
        assert_eq!(mode.number, *number as u64);
        let found = mode.eigenvalue.unwrap_or(f64::NAN);
        assert!((found - eigenvalue).abs() <= within * eigenvalue, "{found}");
        for (row, node) in mode.shape.iter().zip(NODES) {
            for (freedom, value) in row.iter().enumerate() {
                let expected = if freedom < freedoms {
                    plain_shape(*number, node, freedom)
                } else {
                    0.0
                };
                assert_eq!(*value, expected);
            }
        }
    }
}

/// A file with points, a matrix over all of them, a reduced one, eigenvalues and modes.
fn op2((big_endian, wide, release): (bool, bool, bool), kind: i64) -> Vec<u8> {
    let mut op2 = Op2::new(big_endian, wide, release);
    op2.points(&[(40, 1), (7, 2), (12, 1)]);
    let kgg = Dense::symmetric("KGG", 13);
    let kaa = Dense::symmetric("KAA", 5);
    op2.matrix(&if kind == 1 { kgg.single() } else { kgg }, kind);
    op2.matrix(&if kind == 1 { kaa.single() } else { kaa }, kind);
    op2.eigenvalues(&MODES);
    op2.modes("OUGV1", &[(1, 1.0, 1), (2, 2.0, 1)], &NODES, plain_shape);
    op2.finish()
}

#[test]
fn op2_matrices_are_read_exactly_in_every_variant() {
    for variant in VARIANTS {
        for kind in [1, 2] {
            let file = OneFile(op2(variant, kind));
            let kgg = Dense::symmetric("KGG", 13);
            let kgg = if kind == 1 { kgg.single() } else { kgg };
            let found = good(read_op2_matrix(&file, "a.op2", "KGG"));
            assert_eq!(Dense::read(&found), kgg.columns, "{variant:?} {kind}");
            let rows = found
                .freedoms
                .map(|freedoms| freedoms.rows)
                .unwrap_or_default();
            assert_eq!(rows.len(), 13);
            assert_eq!(
                (rows[0], rows[5], rows[6], rows[7], rows[12]),
                ((40, 1), (40, 6), (7, 0), (12, 1), (12, 6))
            );
            let kaa = good(read_op2_matrix(&file, "a.op2", "KAA"));
            assert_eq!((kaa.rows, kaa.freedoms), (5, None));
        }
    }
}

#[test]
fn op2_modes_are_read_in_every_variant() {
    for variant in VARIANTS {
        let modes = good(read_op2_modes(&OneFile(op2(variant, 2)), "a.op2"));
        are_the_modes(&modes, 6, [1024.0, 4096.0], 0.0);
        assert_eq!(modes.frame, ShapeFrame::Analysis);
        assert_eq!(modes.digits, if variant.1 { 15 } else { 7 });
        assert!(
            modes
                .warnings
                .iter()
                .any(|text| text.contains("2 values of scalar points"))
        );
    }
    // one block a mode, no LAMA, a second subcase, the same in the basic frame
    let mut op2 = Op2::new(false, false, false);
    for mode in [1, 2] {
        op2.modes("BOUGV1", &[(mode, 0.0, 1)], &NODES, |_, _, _| 9.0);
        op2.modes(
            "OUGV1",
            &[(mode, MODES[mode as usize - 1].1, 1)],
            &NODES,
            plain_shape,
        );
    }
    op2.modes("OUGV1", &[(1, 5.0, 2)], &NODES, plain_shape);
    let modes = good(read_op2_modes(&OneFile(op2.finish()), "a.op2"));
    are_the_modes(&modes, 6, [1024.0, 4096.0], 0.0);
    assert!(
        modes
            .warnings
            .iter()
            .any(|text| text.contains("modes of later subcases than the first were not read: 1"))
    );
}

#[test]
fn problems_of_op2_say_what_and_where() {
    let file = op2((false, false, false), 2);
    let missing = bad(read_op2_matrix(&OneFile(file.clone()), "a.op2", "MGG"));
    assert_eq!(
        missing.advice,
        "the file contains KGG (13 × 13), KAA (5 × 5)"
    );
    let cut = bad(read_op2_matrix(
        &OneFile(file[..3000].to_vec()),
        "a.op2",
        "KGG",
    ));
    assert!(cut.problem.contains("ends"), "{cut}");
    let text = bad(read_op2_matrix(
        &OneFile(b"formatted".to_vec()),
        "a.op2",
        "KGG",
    ));
    assert!(text.problem.contains("no OP2 file"), "{text}");
    let mut op2 = Op2::new(false, false, false);
    op2.matrix(&Dense::symmetric("KGG", 4), 4);
    let complex = bad(read_op2_matrix(&OneFile(op2.finish()), "a.op2", "KGG"));
    assert!(
        complex.problem.contains("matrix KGG is complex"),
        "{complex}"
    );
    let mut nan = Dense::symmetric("KGG", 6);
    nan.columns[1][0] = f64::NAN;
    let mut op2 = Op2::new(true, false, false);
    op2.matrix(&nan, 2);
    let nan = bad(read_op2_matrix(&OneFile(op2.finish()), "a.op2", "KGG"));
    assert!(
        nan.problem.contains("contains NaN at row 1, column 2"),
        "{nan}"
    );
    let mut op2 = Op2::new(false, false, false);
    op2.modes("OUGV1", &[(1, 1.0, 1)], &NODES, plain_shape);
    op2.modes("OUGV1", &[(2, 1.0, 1)], &NODES[1..], plain_shape);
    let other = bad(read_op2_modes(&OneFile(op2.finish()), "a.op2"));
    assert!(
        other.problem.contains("mode 2 is stated at 2 nodes"),
        "{other}"
    );
    let mut op2 = Op2::new(false, false, false);
    op2.matrix(&Dense::symmetric("KGG", 4), 2);
    let none = bad(read_op2_modes(&OneFile(op2.finish()), "a.op2"));
    assert!(none.problem.contains("no mode shape"), "{none}");
}

#[test]
fn punched_modes() {
    let text = punch(&MODES, &NODES);
    let modes = good(read_punch_modes(
        &OneFile(text.clone().into_bytes()),
        "a.pch",
    ));
    are_the_modes(&modes, 6, [1024.0, 4096.0], 0.0);
    let complex = text.replace("$REAL OUTPUT     ", "$REAL-IMAGINARY  ");
    let complex = bad(read_punch_modes(&OneFile(complex.into_bytes()), "a.pch"));
    assert!(complex.problem.contains("complex"), "{complex}");
    let lines = text.lines().collect::<Vec<_>>();
    let lost = [&lines[..6], &lines[7..]].concat().join("\n");
    let lost = bad(read_punch_modes(&OneFile(lost.into_bytes()), "a.pch"));
    assert!(lost.to_string().starts_with("a.pch:7: "), "{lost}");
    assert!(
        lost.problem.contains("rotations of grid point 11"),
        "{lost}"
    );
}

#[test]
fn modes_of_calculix() {
    let text = frd(&MODES, &NODES);
    let modes = good(read_frd_modes(&OneFile(text.clone().into_bytes()), "a.frd"));
    let eigenvalue = |frequency: f64| (2.0 * std::f64::consts::PI * frequency).powi(2);
    are_the_modes(&modes, 3, [eigenvalue(1024.0), eigenvalue(4096.0)], 1e-6);
    assert!(
        modes.warnings[0].contains("6 digits"),
        "{:?}",
        modes.warnings
    );
    let cut = bad(read_frd_modes(
        &OneFile(text.as_bytes()[..text.len() - 8].to_vec()),
        "a.frd",
    ));
    assert!(cut.problem.contains("ends before"), "{cut}");
    let bad_number = text.replacen("2.35000E+01", "       NaN ", 1);
    assert_ne!(bad_number, text);
    let nan = bad(read_frd_modes(&OneFile(bad_number.into_bytes()), "a.frd"));
    assert!(nan.problem.contains("finite"), "{nan}");
}
