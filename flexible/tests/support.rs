//! Helpers of several test files: files of `tests/data`, distances of lists, flexibilities, damaged texts.

use crate::nastran_deck::is_consistent;
use eng_flexible::mesh::Mesh;
use eng_flexible::reduce::Reduced;
use eng_flexible::{Files, FlexibleError, Place};
use std::io::{self, Read};
use std::path::Path;

/// The files of a folder of `tests/data`.
pub struct Data(pub &'static str);

/// The files of `tests/data` itself.
pub const DATA: Data = Data("");

impl Files for Data {
    fn open(&self, name: &str) -> io::Result<Box<dyn Read>> {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data");
        Ok(Box::new(std::fs::File::open(
            folder.join(self.0).join(name),
        )?))
    }
}

/// The largest relative difference of two lists of equal length.
pub fn apart(found: &[f64], exact: &[f64]) -> f64 {
    assert_eq!(found.len(), exact.len());
    let pairs = found.iter().zip(exact);
    pairs.map(|(x, y)| (x / y - 1.0).abs()).fold(0.0, f64::max)
}

/// Φ ω⁻² Φᵀ at all freedoms of the markers from one on: the body's flexibility, which does not depend on the signs
/// of modes.
pub fn flexibility(reduced: &Reduced, first: usize) -> Vec<f64> {
    let n = reduced.body.invariants.modes;
    let rows: Vec<&[f64]> = reduced.body.markers[first..]
        .iter()
        .flat_map(|m| {
            m.translation
                .chunks_exact(n)
                .chain(m.rotation.chunks_exact(n))
        })
        .collect();
    let mut out = Vec::new();
    for a in &rows {
        for b in &rows {
            let terms = (0..n).map(|i| a[i] * b[i] / reduced.body.invariants.stiffness[i * n + i]);
            out.push(terms.sum());
        }
    }
    out
}

/// A text with other bytes at some places.
pub fn changed(text: &str, changes: &[(usize, u8)]) -> Vec<u8> {
    let mut bytes = text.as_bytes().to_vec();
    for (place, byte) in changes {
        bytes[*place] = *byte;
    }
    bytes
}

/// A text with lines that are lost (0), doubled (1) or exchanged.
pub fn shuffled(text: &str, changes: &[(usize, usize, u8)]) -> String {
    let mut lines = text.lines().collect::<Vec<_>>();
    for (from, to, what) in changes {
        let (from, to) = (from % lines.len(), to % lines.len());
        match what {
            0 => drop(lines.remove(from)),
            1 => lines.insert(to, lines[from]),
            _ => lines.swap(from, to),
        }
    }
    lines.join("\n")
}

/// A mesh is consistent, or a refusal names one of the files, a line and the remedy. `whole` are words of problems
/// of a whole file.
pub fn read_or_refused(read: Result<Mesh, FlexibleError>, files: [&str; 2], whole: [&str; 2]) {
    match read {
        Ok(mesh) => is_consistent(&mesh),
        Err(FlexibleError::File(problem)) => {
            assert!(files.contains(&problem.file.as_str()));
            assert!(!problem.advice.is_empty(), "{problem}");
            assert!(
                matches!(problem.place, Place::Line(1..))
                    || whole.iter().any(|text| problem.problem.contains(text)),
                "{problem}"
            );
        }
        Err(error) => panic!("{error}"),
    }
}
