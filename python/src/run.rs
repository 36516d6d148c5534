//! Results of a run.

use crate::column::Column;
use crate::failure;
use crate::gradient::Gradient;
use crate::packing;
use crate::report::{Report, Source};
use crate::table::{Table, refused};
use arrow_array::RecordBatch;
use eng::results::Selection;
use eng::run::RunOutcome;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyCapsule, PyDict, PyTuple};
use std::path::PathBuf;
use std::sync::OnceLock;

/// The results of an analysis: a table with a column for each channel, in the units of the text. Everything that reads Arrow
/// takes it as it is: `polars.DataFrame(run)`, `pyarrow.table(run)`, `pandas.DataFrame.from_arrow(run)`.
#[pyclass(frozen, mapping, module = "englang._native")]
pub struct Run {
    outcome: RunOutcome,
    /// Tables of copies of its gradients, which reports read from the outcome.
    gradients: Vec<Py<Gradient>>,
    program: eng::Program,
    /// Its warnings, as JSON.
    messages: String,
    batch: OnceLock<RecordBatch>,
}

impl Run {
    /// The results of an analysis of a program.
    pub fn new(py: Python<'_>, outcome: RunOutcome, program: eng::Program) -> PyResult<Run> {
        let messages = eng::render::json(&outcome.diagnostics, program.texts());
        Run::with_messages(py, outcome, program, messages)
    }

    /// The results of an analysis of a program with its warnings as JSON.
    pub fn with_messages(
        py: Python<'_>,
        outcome: RunOutcome,
        program: eng::Program,
        messages: String,
    ) -> PyResult<Run> {
        let gradients = outcome.gradients.iter().cloned();
        let tables = gradients.map(|gradient| Py::new(py, Gradient::new(gradient)));
        Ok(Run {
            gradients: tables.collect::<PyResult<_>>()?,
            outcome,
            program,
            messages,
            batch: OnceLock::new(),
        })
    }

    /// Its numbers for reports.
    pub fn source(&self) -> Source<'_> {
        let results = &self.outcome.results;
        let run = eng::post::Run::new(results, &self.outcome.machine);
        Source {
            analysis: results.analysis(),
            hash: results.metadata().get("source_hash"),
            run: run
                .with_motion(self.outcome.motion.as_ref())
                .with_gradients(&self.outcome.gradients),
        }
    }

    fn table(&self) -> Table<'_> {
        Table {
            results: &self.outcome.results,
            batch: &self.batch,
        }
    }
}

#[pymethods]
impl Run {
    /// The name of the analysis.
    #[getter]
    fn analysis(&self) -> &str {
        self.outcome.results.analysis()
    }

    /// The name of the model.
    #[getter]
    fn model(&self) -> &str {
        self.outcome.results.model()
    }

    /// The names of the columns.
    #[getter]
    fn columns(&self) -> Vec<&str> {
        self.table().columns()
    }

    /// The units of the columns.
    #[getter]
    fn units<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        self.table().units(py)
    }

    /// The entries that result files keep of a run: parameters, version, hash of the texts, facts about the start.
    #[getter]
    fn metadata<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let entries = PyDict::new(py);
        for (key, value) in self.outcome.results.metadata() {
            entries.set_item(key, value)?;
        }
        Ok(entries)
    }

    /// The point of a sweep: the values of its indices in the units of the text.
    #[getter]
    fn point<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let point = PyDict::new(py);
        for index in &self.outcome.point {
            point.set_item(&index.name, index.display.from_si(index.value))?;
        }
        Ok(point)
    }

    /// The warnings of the run.
    #[getter]
    fn warnings<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        failure::diagnostics(py, &self.messages)
    }

    /// The derivatives of the channels by the parameters of `gradients`, by the paths of these.
    #[getter]
    fn gradients<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let gradients = PyDict::new(py);
        for gradient in &self.gradients {
            gradients.set_item(gradient.get().parameter(), gradient)?;
        }
        Ok(gradients)
    }

    /// Facts about the run, a line each: steps, iterations, energy.
    #[getter]
    fn facts(&self) -> Vec<&str> {
        self.outcome.facts.iter().map(String::as_str).collect()
    }

    /// The reason why the run ended early; `None` for a whole run.
    #[getter]
    fn failure(&self) -> Option<&str> {
        self.outcome.results.failure()
    }

    /// A column in the unit of the text.
    fn column(&self, py: Python<'_>, path: &str) -> PyResult<Column> {
        self.table().column(py, path)
    }

    /// The numbers of a column in the unit of the text, as an array of NumPy for reading. It is no copy.
    fn __getitem__<'py>(&self, py: Python<'py>, path: &str) -> PyResult<Bound<'py, PyAny>> {
        self.table().array(py, path)
    }

    /// The numbers of a column in SI units, as an array of NumPy for reading.
    fn si<'py>(&self, py: Python<'py>, path: &str) -> PyResult<Bound<'py, PyAny>> {
        self.table().si(py, path)
    }

    fn __contains__(&self, path: &str) -> bool {
        self.outcome.results.column(path).is_some()
    }

    /// The number of samples.
    fn __len__(&self) -> usize {
        self.outcome.results.samples()
    }

    /// The run with the columns of some patterns only, such as `"main[*].force.*"`; time and cycle stay.
    #[pyo3(signature = (*patterns))]
    fn select(&self, py: Python<'_>, patterns: &Bound<'_, PyTuple>) -> PyResult<Run> {
        let patterns: Vec<String> = patterns.extract()?;
        let selection = Selection::new(patterns.iter().map(String::as_str));
        let selected = selection.apply(&self.outcome.results);
        let gradients = self.gradients.iter();
        let gradients = gradients.map(|gradient| gradient.get().select(py, &selection));
        let outcome = RunOutcome {
            results: selected.map_err(|error| refused(py, error))?,
            gradients: gradients.collect::<PyResult<_>>()?,
            ..self.outcome.clone()
        };
        Run::with_messages(py, outcome, self.program.clone(), self.messages.clone())
    }

    /// Evaluates a report of the text over this run alone, or the derivatives of its values by a parameter of `gradients`.
    #[pyo3(signature = (name, *, by=None))]
    fn report(&self, py: Python<'_>, name: &str, by: Option<&str>) -> PyResult<Report> {
        let by = match by {
            None => None,
            Some(path) => {
                let mut gradients = self.outcome.gradients.iter();
                let found = gradients.find(|gradient| gradient.parameter == path);
                let missing = || {
                    format!(
                        "the run has no gradients by {path}: run it with gradients=[\"{path}\"]"
                    )
                };
                let found = found.ok_or_else(|| failure::setting(py, &missing()))?;
                Some((path, &found.unit))
            }
        };
        Report::evaluated(py, &self.program, name, by, &[self.source()])
    }

    /// All that this run has, as bytes for `Analysis.restored` of the same analysis in another process.
    fn packed<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let bytes = py.detach(|| packing::packed(&self.outcome, &self.messages));
        let bytes = bytes.map_err(|error| failure::setting(py, &error.to_string()))?;
        Ok(PyBytes::new(py, &bytes))
    }

    /// Writes `ANALYSIS.parquet` into a folder, as `eng run` does, and returns its path.
    fn write_parquet(&self, py: Python<'_>, folder: PathBuf) -> PyResult<PathBuf> {
        let written = py.detach(|| self.outcome.results.write_parquet(&folder));
        written.map_err(|error| refused(py, error))
    }

    /// The schema of the table, for programs that read Arrow.
    fn __arrow_c_schema__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyCapsule>> {
        self.table().schema(py)
    }

    /// The table, for programs that read Arrow. They share its memory. The request for another schema may be ignored, by the
    /// rules of the protocol.
    #[pyo3(signature = (requested_schema=None))]
    fn __arrow_c_stream__<'py>(
        &self,
        py: Python<'py>,
        requested_schema: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyCapsule>> {
        let _ = requested_schema;
        self.table().stream(py)
    }

    fn __repr__(&self) -> String {
        let results = &self.outcome.results;
        format!(
            "<Run {} of {}: {} samples, {} columns>",
            results.analysis(),
            results.model(),
            results.samples(),
            results.columns().len()
        )
    }
}
