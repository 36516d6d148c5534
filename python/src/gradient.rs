//! Derivatives of a run by a parameter.

use crate::column::Column;
use crate::table::{Table, refused};
use arrow_array::RecordBatch;
use eng::results::Selection;
use pyo3::prelude::*;
use pyo3::types::{PyCapsule, PyDict};
use std::sync::OnceLock;

/// The derivatives of the channels of a run by a parameter: a table with the samples of the run. Each number is
/// in the channel's unit per the parameter's unit. Everything that reads Arrow takes it as it is.
#[pyclass(frozen, mapping, module = "englang._native")]
pub struct Gradient {
    inner: eng::Gradient,
    batch: OnceLock<RecordBatch>,
}

impl Gradient {
    /// The derivatives by a parameter.
    pub fn new(inner: eng::Gradient) -> Gradient {
        Gradient {
            inner,
            batch: OnceLock::new(),
        }
    }

    /// The derivatives of some channels.
    pub fn select(&self, py: Python<'_>, selection: &Selection) -> PyResult<eng::Gradient> {
        let selected = selection.apply(&self.inner.results);
        Ok(eng::Gradient {
            results: selected.map_err(|error| refused(py, error))?,
            ..self.inner.clone()
        })
    }

    fn table(&self) -> Table<'_> {
        Table {
            results: &self.inner.results,
            batch: &self.batch,
        }
    }
}

#[pymethods]
impl Gradient {
    /// The path of the parameter.
    #[getter]
    pub fn parameter(&self) -> &str {
        &self.inner.parameter
    }

    /// The unit of the parameter.
    #[getter]
    fn unit(&self) -> &str {
        &self.inner.unit.symbol
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

    /// A column in the units of the text.
    fn column(&self, py: Python<'_>, path: &str) -> PyResult<Column> {
        self.table().column(py, path)
    }

    /// The numbers of a column in the units of the text, as an array of NumPy for reading. It is no copy.
    fn __getitem__<'py>(&self, py: Python<'py>, path: &str) -> PyResult<Bound<'py, PyAny>> {
        self.table().array(py, path)
    }

    /// The numbers of a column in SI units, as an array of NumPy for reading.
    fn si<'py>(&self, py: Python<'py>, path: &str) -> PyResult<Bound<'py, PyAny>> {
        self.table().si(py, path)
    }

    fn __contains__(&self, path: &str) -> bool {
        self.inner.results.column(path).is_some()
    }

    /// The number of samples.
    fn __len__(&self) -> usize {
        self.inner.results.samples()
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
        format!(
            "<Gradient of {} by {}: {} samples, {} columns>",
            self.inner.results.analysis(),
            self.inner.parameter,
            self.inner.results.samples(),
            self.inner.results.columns().len()
        )
    }
}
