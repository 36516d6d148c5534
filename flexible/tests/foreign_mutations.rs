//! Files of matrices and modes with all kinds of damage: readers may refuse them, with the remedy,
//! but never panic.

use crate::foreign_files::*;
use eng_flexible::read::matrix::*;
use eng_flexible::{FileProblem, FlexibleError};
use proptest::prelude::*;

const NODES: [i64; 3] = [11, 12, 40];
const MODES: [(i64, f64); 2] = [(1, 1024.0), (2, 4096.0)];

/// Reads a file in the format of the end of its name. A refusal states the remedy.
fn try_read(name: &str, bytes: Vec<u8>) {
    let file = OneFile(bytes);
    let refused = |problem: FileProblem| {
        assert_eq!(problem.file, name);
        assert!(
            !problem.advice.is_empty() && !problem.problem.is_empty(),
            "{problem}"
        );
    };
    for matrix in ["", "KGG"] {
        match read_by_name(&file, name, matrix) {
            Err(problem) => refused(problem),
            Ok(matrix) => {
                for (row, column, value) in &matrix.entries {
                    assert!((*row as usize) < matrix.rows && (*column as usize) < matrix.columns);
                    assert!(value.is_finite());
                }
                match matrix.to_symmetric(MatrixKind::Mass) {
                    Err(FlexibleError::Matrix { problem, advice }) => {
                        assert!(problem.starts_with(name) && !advice.is_empty(), "{problem}");
                    }
                    Err(error) => panic!("{error}"),
                    Ok(symmetric) => assert_eq!(symmetric.size(), matrix.rows),
                }
            }
        }
    }
    let modes = match name {
        "a.op2" => Some(read_op2_modes(&file, name)),
        "a.pch" => Some(read_punch_modes(&file, name)),
        "a.frd" => Some(read_frd_modes(&file, name)),
        _ => None,
    };
    match modes {
        Some(Err(problem)) => refused(problem),
        Some(Ok(modes)) => {
            for mode in &modes.modes {
                assert_eq!(mode.shape.len(), modes.nodes.len());
            }
        }
        None => {}
    }
    if name == "a.dof"
        && let Err(problem) = read_calculix_freedoms(&file, name)
    {
        refused(problem);
    }
}

/// A file of every format.
fn samples() -> Vec<(&'static str, Vec<u8>)> {
    let k = || Dense::symmetric("KGG", 6);
    let mut samples = Vec::new();
    for layout in [Layout::Dense, Layout::Strings, Layout::Big] {
        samples.push(("a.op4", op4_binary(&[k()], layout, false, false, false)));
        samples.push(("a.op4", op4_binary(&[k()], layout, true, true, true)));
        samples.push(("a.op4", op4_text(&[k()], layout, false).into_bytes()));
    }
    for wide in [false, true] {
        let mut op2 = Op2::new(wide, wide, wide);
        op2.points(&[(40, 1), (7, 2), (12, 1)]);
        op2.matrix(&k(), 2);
        op2.eigenvalues(&MODES);
        op2.modes("OUGV1", &[(1, 1.0, 1), (2, 2.0, 1)], &NODES, plain_shape);
        samples.push(("a.op2", op2.finish()));
    }
    let points = (1..=6).map(|freedom| (9, freedom)).collect::<Vec<_>>();
    samples.push(("a.bdf", dmig(&k(), &points, true).into_bytes()));
    samples.push(("a.pch", punch(&MODES, &NODES).into_bytes()));
    samples.push(("a.frd", frd(&MODES, &NODES).into_bytes()));
    samples.push((
        "a.mtx",
        b"1 1 2.5\n2 1 -1.0\n1 2 -1.0\n2 2 3.5e+01\n".to_vec(),
    ));
    samples.push((
        "a.mtx",
        b"** k\n7,1,7,1,2.5\n8,1,7,1,-1.\n8,1,8,1,3.5D0\n".to_vec(),
    ));
    samples.push((
        "a.sti",
        b"1 1 2.5000000000000e+00\n1 2 -1.0\n2 2 3.5e+01\n".to_vec(),
    ));
    samples.push(("a.dof", b"1.1\n1.2\n1.3\n27.1\n".to_vec()));
    samples
}

#[test]
fn the_files_themselves_are_read() {
    for (name, bytes) in samples() {
        let file = OneFile(bytes);
        match name {
            "a.frd" => assert!(read_frd_modes(&file, name).is_ok()),
            "a.pch" => assert!(read_punch_modes(&file, name).is_ok()),
            "a.dof" => assert!(read_calculix_freedoms(&file, name).is_ok()),
            _ => {
                let matrix =
                    read_by_name(&file, name, "").unwrap_or_else(|error| panic!("{error}"));
                let symmetric = matrix.to_symmetric(MatrixKind::Mass);
                assert!(symmetric.is_ok(), "{name}: {symmetric:?}");
            }
        }
        if name == "a.op2" {
            assert!(read_op2_modes(&file, name).is_ok());
        }
    }
}

#[test]
fn cut_at_every_byte() {
    for (name, bytes) in samples() {
        for end in 0..bytes.len() {
            try_read(name, bytes[..end].to_vec());
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn bytes_changed(changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..5)) {
        for (name, mut bytes) in samples() {
            for (place, byte) in &changes {
                let place = place.index(bytes.len());
                bytes[place] = *byte;
            }
            try_read(name, bytes);
        }
    }

    #[test]
    fn bits_flipped(changes in prop::collection::vec((any::<prop::sample::Index>(), 0..8_u8), 1..4)) {
        for (name, mut bytes) in samples() {
            for (place, bit) in &changes {
                let place = place.index(bytes.len());
                bytes[place] ^= 1 << bit;
            }
            try_read(name, bytes);
        }
    }

    #[test]
    fn characters_put_anywhere(
        changes in prop::collection::vec((any::<prop::sample::Index>(), prop::sample::select(b"0123456789.+-*,ED$ \nG".to_vec())), 1..6)
    ) {
        for (name, mut bytes) in samples() {
            for (place, byte) in &changes {
                let place = place.index(bytes.len());
                bytes[place] = *byte;
            }
            try_read(name, bytes);
        }
    }

    #[test]
    fn bytes_lost_or_doubled(from in any::<prop::sample::Index>(), count in 1..40_usize, doubled in any::<bool>()) {
        for (name, mut bytes) in samples() {
            let from = from.index(bytes.len());
            let end = (from + count).min(bytes.len());
            if doubled {
                let part = bytes[from..end].to_vec();
                bytes.splice(from..from, part);
            } else {
                bytes.drain(from..end);
            }
            try_read(name, bytes);
        }
    }

    #[test]
    fn any_bytes(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        for name in ["a.op4", "a.op2", "a.pch", "a.frd", "a.mtx", "a.sti", "a.dof"] {
            try_read(name, bytes.clone());
        }
    }
}
