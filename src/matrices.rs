//! The matrices of small motions under inputs, `ξ̇ = A ξ + B u`, `y = C ξ + D u`, as a JSON file beside the
//! modes of a `linear` analysis.
//!
//! ```text
//! { "model": "Driveline", "analysis": "small", "linearised": "at 0 s", "coefficients": "constant",
//!   "freedoms": 2, "states": 0,
//!   "inputs": [ { "path": "brake", "unit": "kg*m^2/s^2" } ], "outputs": [ { "path": "speed", "unit": "1/s" } ],
//!   "A": [ [0.0, 1.0, …], … ], "B": …, "C": …, "D": … }
//! ```
//!
//! All numbers are SI. A row of a matrix is a list. ξ has the coordinates of the freedoms, their rates, and the states
//! of elements.

use crate::analysis::Analysis;
use crate::modes::{coefficients, linearised_at};
use crate::results::{ResultsError, file_stem, remove_if_there, replace_file};
use eng_grammar::Diagnostic;
use eng_runtime::LinearModes;
use eng_system::analysis::Names;
use eng_system::significant::short;
use eng_system::{Dimension, DisplayUnit};
use nalgebra::DMatrix;
use serde::Serialize;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Ending of the file's name.
const ENDING: &str = ".matrices.json";
/// Most steady gains that a run prints. A choice: the file has all.
const MOST_GAINS: usize = 6;

/// The file with the matrices of an analysis in a folder.
pub(crate) fn file_of(folder: &Path, analysis: &str) -> PathBuf {
    folder.join(format!("{}{ENDING}", file_stem(analysis)))
}

/// An input or output.
#[derive(Serialize)]
struct Signal {
    path: String,
    /// The SI unit in base symbols.
    unit: String,
    #[serde(skip)]
    display: DisplayUnit,
}

#[derive(Serialize)]
struct Document<'a> {
    model: &'a str,
    analysis: &'a str,
    linearised: String,
    coefficients: &'a str,
    freedoms: usize,
    states: usize,
    inputs: &'a [Signal],
    outputs: &'a [Signal],
    #[serde(rename = "A")]
    a: Vec<Vec<f64>>,
    #[serde(rename = "B")]
    b: Vec<Vec<f64>>,
    #[serde(rename = "C")]
    c: Vec<Vec<f64>>,
    #[serde(rename = "D")]
    d: Vec<Vec<f64>>,
}

fn rows(matrix: &DMatrix<f64>) -> Vec<Vec<f64>> {
    matrix
        .row_iter()
        .map(|row| row.iter().copied().collect())
        .collect()
}

impl Analysis {
    /// Inputs and outputs of the matrices, in their order.
    fn signals(&self) -> [Vec<Signal>; 2] {
        let system = &self.model().compiled().system;
        let signal = |path: &str, dimension: Dimension, display: &DisplayUnit| Signal {
            path: path.to_owned(),
            unit: dimension.to_string(),
            // a change has no shifted zero
            display: DisplayUnit {
                offset: 0.0,
                ..display.clone()
            },
        };
        // the run that made the matrices has found all names
        let indices = |wanted: Names| -> Vec<usize> {
            let lists = self.kind().named().into_iter();
            let mut own = lists.filter(|(_, names, _)| *names == wanted);
            let paths = system.paths_of(wanted);
            let found = own
                .next()
                .and_then(|(.., list)| wanted.indices(list, &paths).ok());
            found.unwrap_or_default()
        };
        let inputs = indices(Names::Inputs).into_iter().filter_map(|k| {
            let parameter = system.inputs.get(k)?.parameter;
            let found = system.parameters.get(parameter as usize)?;
            Some(signal(&found.origin.path, found.dimension, &found.display))
        });
        let outputs = indices(Names::Channels).into_iter().filter_map(|k| {
            let found = system.channels.get(k)?;
            Some(signal(&found.path, found.dimension, &found.display))
        });
        [inputs.collect(), outputs.collect()]
    }

    /// Writes the matrices into the folder of the results, and removes those of an earlier text.
    pub(crate) fn write_matrices(&self, modes: Option<&LinearModes>) -> Result<(), ResultsError> {
        let Some(folder) = self.recorded_to() else {
            return Ok(());
        };
        let path = file_of(folder, self.name());
        let found = modes.and_then(|modes| Some((modes, modes.matrices.as_ref()?)));
        let Some((modes, matrices)) = found else {
            return remove_if_there(&path);
        };
        let [inputs, outputs] = self.signals();
        let document = Document {
            model: self.model().name(),
            analysis: self.name(),
            linearised: linearised_at(modes),
            coefficients: coefficients(modes),
            freedoms: matrices.freedoms,
            states: matrices.states,
            inputs: &inputs,
            outputs: &outputs,
            a: rows(&matrices.a),
            b: rows(&matrices.b),
            c: rows(&matrices.c),
            d: rows(&matrices.d),
        };
        replace_file(&path, |file| -> std::io::Result<()> {
            serde_json::to_writer(&mut *file, &document)?;
            file.write_all(b"\n")
        })
        .map_err(|source| ResultsError::File { path, source })
    }

    /// A warning for outputs that no input moves, and one for each input that moves no output. Of a vector some
    /// components may well be unmoved.
    pub(crate) fn unmoved(&self, modes: &LinearModes) -> Vec<Diagnostic> {
        let Some(matrices) = &modes.matrices else {
            return Vec::new();
        };
        let [inputs, outputs] = self.signals().map(|signals| {
            let paths = signals.into_iter().map(|signal| signal.path);
            paths.collect::<Vec<String>>()
        });
        let pairs = matrices.independent();
        let is_unmoved = |row: usize, column: usize| pairs.contains(&[row, column]);
        let vector = |row: usize| {
            let path = outputs.get(row).map_or("", String::as_str);
            let ends = [".x", ".y", ".z"].into_iter();
            ends.filter_map(|end| path.strip_suffix(end))
                .next()
                .unwrap_or(path)
        };
        let by_none = |row: usize| (0..inputs.len()).all(|column| is_unmoved(row, column));
        let mut still: Vec<String> = Vec::new();
        for row in 0..outputs.len() {
            let whole = (0..outputs.len()).filter(|other| vector(*other) == vector(row));
            if whole.clone().all(by_none) && !still.iter().any(|known| known == vector(row)) {
                still.push(vector(row).to_owned());
            }
        }
        let mut found = Vec::new();
        if !still.is_empty() {
            found.push(crate::failure::independent(&still, &inputs, self.origin()));
        }
        let idle = inputs.iter().enumerate().filter(|(column, _)| {
            let moves = (0..outputs.len()).any(|row| !by_none(row));
            moves && (0..outputs.len()).all(|row| is_unmoved(row, *column))
        });
        let others = outputs.iter().filter(|path| !still.contains(*path));
        let others: Vec<String> = others.cloned().collect();
        found.extend(idle.map(|(_, input)| {
            crate::failure::independent(&others, std::slice::from_ref(input), self.origin())
        }));
        found
    }

    /// Lines about the matrices: their size, and the steady gains `D − C A⁻¹ B` if the motion has no zero eigenvalue.
    pub(crate) fn facts_of_matrices(&self, modes: &LinearModes) -> Vec<String> {
        let Some(matrices) = &modes.matrices else {
            return Vec::new();
        };
        let [inputs, outputs] = self.signals();
        let mut facts = vec![format!(
            "A is {0} × {0}, B {0} × {1}, C {2} × {0}",
            matrices.a.nrows(),
            inputs.len(),
            outputs.len()
        )];
        let Some(gains) = matrices.gains().filter(|_| modes.zeros == 0) else {
            return facts;
        };
        let pairs = outputs.iter().enumerate().flat_map(|(row, output)| {
            let inputs = inputs.iter().enumerate();
            inputs.map(move |(column, input)| (row, output, column, input))
        });
        for (row, output, column, input) in pairs.take(MOST_GAINS) {
            let shown = gains[(row, column)] * input.display.scale / output.display.scale;
            facts.push(format!(
                "steady gain of {} by {}: {} {} per {}",
                output.path,
                input.path,
                short(shown, 6),
                output.display.symbol,
                input.display.symbol
            ));
        }
        facts
    }
}
