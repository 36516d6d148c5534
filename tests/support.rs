//! Helpers of several test files: programs of texts, runs, refusals, columns, decays, a mesh, and folders.

use eng::{Outcome, Program, Results, Sources};
use std::fmt::Write;
use std::ops::Deref;
use std::path::{Path, PathBuf};

/// The program of a text.
pub fn program(text: &str) -> Program {
    program_of(&[("m.eng", text)])
}

/// The program of a text beside the mesh `bar.bdf`.
pub fn program_with_bar(text: &str) -> Program {
    program_of(&[("m.eng", text), ("bar.bdf", include_str!("mesh/bar.bdf"))])
}

/// The program of texts under their file names. The first is the model.
pub fn program_of(texts: &[(&str, &str)]) -> Program {
    let sources = texts
        .iter()
        .map(|(name, text)| ((*name).to_owned(), (*text).to_owned()));
    eng::check(&Sources::from_texts(sources), texts[0].0)
        .into_program()
        .unwrap_or_else(|report| panic!("{report}"))
}

/// The outcome of an analysis.
pub fn outcome(program: &Program, analysis: &str) -> Outcome {
    program
        .analysis(analysis)
        .unwrap_or_else(|error| panic!("{error}"))
        .run(&mut |_| {})
        .unwrap_or_else(|failed| panic!("{}", failed.error))
}

/// The message with which the run of an analysis is refused.
pub fn refused(program: &Program, analysis: &str) -> String {
    let analysis = program.analysis(analysis).expect("an analysis");
    match analysis.run(&mut |_| {}) {
        Ok(outcome) => panic!("not refused: {:?}", outcome.modes),
        Err(failed) => failed.error.to_string(),
    }
}

/// A column in SI units.
pub fn column<'r>(results: &'r Results, path: &str) -> &'r [f64] {
    let column = results.column(path);
    &column.unwrap_or_else(|| panic!("no column {path}")).values
}

/// s and p with which samples repeat `y(k+2) = s y(k+1) − p y(k)` best.
pub fn recurrence(values: &[f64]) -> (f64, f64) {
    let mut normal = [0.0; 5];
    for w in values.windows(3) {
        let (a, b, y) = (w[1], -w[0], w[2]);
        for (sum, x) in normal.iter_mut().zip([a * a, a * b, b * b, a * y, b * y]) {
            *sum += x;
        }
    }
    let [aa, ab, bb, ay, by] = normal;
    let det = aa * bb - ab * ab;
    ((ay * bb - by * ab) / det, (aa * by - ab * ay) / det)
}

/// λ of a decay that is sampled every h, real and imaginary part: `z² = s z − p`, `λ = ln z/h`.
pub fn decay(values: &[f64], h: f64) -> (f64, f64) {
    let (s, p) = recurrence(values);
    (0.5 * p.ln() / h, (0.5 * s / p.sqrt()).acos() / h)
}

/// Bulk data of a square beam along x, 1 m long, in twenty pieces.
pub fn slender_beam(side: f64, young: f64, density: f64) -> String {
    let moment = side.powi(4) / 12.0;
    let mut deck = format!(
        "BEGIN BULK\nMAT1,1,{young:e},,0.3,{density:e}\nPBAR,1,1,{:e},{moment:e},{moment:e},{:e}\nGRID,1,,0.,0.,0.\n",
        side * side,
        1.69 * moment
    );
    for piece in 1..=20 {
        let x = f64::from(piece) / 20.0;
        writeln!(deck, "GRID,{},,{x:.6},0.,0.", piece + 1).expect("a line");
        writeln!(deck, "CBAR,{piece},1,{piece},{},0.,0.,1.", piece + 1).expect("a line");
    }
    deck + "ENDDATA\n"
}

/// An empty folder of its own below that of temporary files, removed afterwards.
pub struct Temporary(pub PathBuf);

impl Temporary {
    /// No two tests may share the name.
    pub fn new(name: &str) -> Temporary {
        let folder = std::env::temp_dir().join(format!("eng-{name}-{}", std::process::id()));
        let _ = std::fs::remove_dir_all(&folder);
        std::fs::create_dir_all(&folder).expect("a folder");
        Temporary(folder)
    }
}

impl Deref for Temporary {
    type Target = Path;

    fn deref(&self) -> &Path {
        &self.0
    }
}

impl AsRef<Path> for Temporary {
    fn as_ref(&self) -> &Path {
        &self.0
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}
