//! Results of a run.

use crate::column::Column;
use crate::failure;
use crate::report::{Report, Source};
use arrow_array::ffi_stream::FFI_ArrowArrayStream;
use arrow_array::{Array, Float64Array, RecordBatch, RecordBatchIterator};
use arrow_schema::ffi::FFI_ArrowSchema;
use eng::results::{ResultsError, Selection};
use eng::run::RunOutcome;
use pyo3::exceptions::{PyKeyError, PyRuntimeError};
use pyo3::prelude::*;
use pyo3::types::{PyCapsule, PyDict, PyTuple};
use std::path::PathBuf;
use std::sync::OnceLock;

/// The results of an analysis: a table with a column for each channel, in the units of the text. Everything that reads Arrow
/// takes it as it is: `polars.DataFrame(run)`, `pyarrow.table(run)`, `pandas.DataFrame.from_arrow(run)`.
#[pyclass(frozen, mapping, module = "englang")]
pub struct Run {
    outcome: RunOutcome,
    program: eng::Program,
    /// The columns in display units, made at their first use.
    batch: OnceLock<RecordBatch>,
}

impl Run {
    /// The results of an analysis of a program.
    pub fn new(outcome: RunOutcome, program: eng::Program) -> Run {
        Run {
            outcome,
            program,
            batch: OnceLock::new(),
        }
    }

    /// Its numbers for reports.
    pub fn source(&self) -> Source<'_> {
        let results = &self.outcome.results;
        let run = eng::post::Run::new(results, &self.outcome.machine);
        Source {
            analysis: results.analysis(),
            hash: results.metadata().get("source_hash"),
            run: run.with_motion(self.outcome.motion.as_ref()),
        }
    }

    fn batch(&self, py: Python<'_>) -> PyResult<&RecordBatch> {
        if let Some(batch) = self.batch.get() {
            return Ok(batch);
        }
        let made = py.detach(|| self.outcome.results.record_batch());
        let made = made.map_err(|error| refused(py, error))?;
        // if two threads make it, both have made the same
        Ok(self.batch.get_or_init(|| made))
    }

    fn found(&self, path: &str) -> PyResult<&eng::results::Column> {
        let missing = || ResultsError::NoColumn(path.to_owned());
        let column = self.outcome.results.column(path);
        column.ok_or_else(|| PyKeyError::new_err(missing().to_string()))
    }
}

/// The exception for an error about results.
fn refused(py: Python<'_>, error: ResultsError) -> PyErr {
    failure::raised(py, &error.into(), None)
}

/// A column as an array of NumPy on the same memory.
fn array<'py>(py: Python<'py>, column: Column) -> PyResult<Bound<'py, PyAny>> {
    PyModule::import(py, "numpy")?.call_method1("asarray", (column,))
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
        let columns = self.outcome.results.columns().iter();
        columns.map(|column| column.path.as_str()).collect()
    }

    /// The units of the columns.
    #[getter]
    fn units<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let units = PyDict::new(py);
        for column in self.outcome.results.columns() {
            units.set_item(&column.path, &column.display.symbol)?;
        }
        Ok(units)
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
        let (messages, texts) = (&self.outcome.diagnostics, self.program.texts());
        failure::diagnostics(py, &eng::render::json(messages, texts))
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
        let found = self.found(path)?;
        let array = self.batch(py)?.column_by_name(path);
        let values = array.and_then(|array| array.as_any().downcast_ref::<Float64Array>());
        let values = values.ok_or_else(|| PyRuntimeError::new_err("a column without numbers"))?;
        let unit = &found.display.symbol;
        Ok(Column::new(path, unit, &found.frame, values.clone()))
    }

    /// The numbers of a column in the unit of the text, as an array of NumPy for reading. It is no copy.
    fn __getitem__<'py>(&self, py: Python<'py>, path: &str) -> PyResult<Bound<'py, PyAny>> {
        array(py, self.column(py, path)?)
    }

    /// The numbers of a column in SI units, as an array of NumPy for reading.
    fn si<'py>(&self, py: Python<'py>, path: &str) -> PyResult<Bound<'py, PyAny>> {
        let found = self.found(path)?;
        let values = Float64Array::from(found.values.clone());
        let unit = eng::DisplayUnit::si(found.dimension).symbol;
        array(py, Column::new(path, &unit, &found.frame, values))
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
        let outcome = RunOutcome {
            results: selected.map_err(|error| refused(py, error))?,
            ..self.outcome.clone()
        };
        Ok(Run::new(outcome, self.program.clone()))
    }

    /// Evaluates a report of the text over this run alone; see `Program.report`.
    fn report(&self, py: Python<'_>, name: &str) -> PyResult<Report> {
        Report::evaluated(py, &self.program, name, &[self.source()])
    }

    /// Writes `ANALYSIS.parquet` into a folder, as `eng run` does, and returns its path.
    fn write_parquet(&self, py: Python<'_>, folder: PathBuf) -> PyResult<PathBuf> {
        let written = py.detach(|| self.outcome.results.write_parquet(&folder));
        written.map_err(|error| refused(py, error))
    }

    /// The schema of the table, for programs that read Arrow.
    fn __arrow_c_schema__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyCapsule>> {
        let schema = FFI_ArrowSchema::try_from(self.batch(py)?.schema_ref().as_ref());
        let schema = schema.map_err(|error| PyRuntimeError::new_err(error.to_string()))?;
        PyCapsule::new_with_value(py, schema, c"arrow_schema")
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
        let batch = self.batch(py)?.clone();
        let schema = batch.schema();
        let reader = RecordBatchIterator::new(std::iter::once(Ok(batch)), schema);
        let stream = FFI_ArrowArrayStream::new(Box::new(reader));
        PyCapsule::new_with_value(py, stream, c"arrow_array_stream")
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
