//! Columns of results as tables of Arrow, which runs and gradients share.

use crate::column::Column;
use crate::failure;
use arrow_array::ffi_stream::FFI_ArrowArrayStream;
use arrow_array::{Array, Float64Array, RecordBatch, RecordBatchIterator};
use arrow_schema::ffi::FFI_ArrowSchema;
use eng::Results;
use eng::results::ResultsError;
use pyo3::exceptions::{PyKeyError, PyRuntimeError};
use pyo3::prelude::*;
use pyo3::types::{PyCapsule, PyDict};
use std::sync::OnceLock;

/// Results, with their columns in display units, which are made at their first use.
pub struct Table<'t> {
    pub results: &'t Results,
    pub batch: &'t OnceLock<RecordBatch>,
}

/// The exception for an error about results.
pub fn refused(py: Python<'_>, error: ResultsError) -> PyErr {
    failure::raised(py, &error.into(), None)
}

/// A column as an array of NumPy on the same memory.
fn array<'py>(py: Python<'py>, column: Column) -> PyResult<Bound<'py, PyAny>> {
    PyModule::import(py, "numpy")?.call_method1("asarray", (column,))
}

impl<'t> Table<'t> {
    fn batch(&self, py: Python<'_>) -> PyResult<&'t RecordBatch> {
        if let Some(batch) = self.batch.get() {
            return Ok(batch);
        }
        let made = py.detach(|| self.results.record_batch());
        let made = made.map_err(|error| refused(py, error))?;
        // if two threads make it, both have made the same
        Ok(self.batch.get_or_init(|| made))
    }

    fn found(&self, path: &str) -> PyResult<&'t eng::results::Column> {
        let missing = || ResultsError::NoColumn(path.to_owned());
        let column = self.results.column(path);
        column.ok_or_else(|| PyKeyError::new_err(missing().to_string()))
    }

    /// The names of the columns.
    pub fn columns(&self) -> Vec<&'t str> {
        let columns = self.results.columns().iter();
        columns.map(|column| column.path.as_str()).collect()
    }

    /// The units of the columns.
    pub fn units<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let units = PyDict::new(py);
        for column in self.results.columns() {
            units.set_item(&column.path, &column.display.symbol)?;
        }
        Ok(units)
    }

    /// A column in the unit of the text.
    pub fn column(&self, py: Python<'_>, path: &str) -> PyResult<Column> {
        let found = self.found(path)?;
        let array = self.batch(py)?.column_by_name(path);
        let values = array.and_then(|array| array.as_any().downcast_ref::<Float64Array>());
        let values = values.ok_or_else(|| PyRuntimeError::new_err("a column without numbers"))?;
        let unit = &found.display.symbol;
        Ok(Column::new(path, unit, &found.frame, values.clone()))
    }

    /// A column in the unit of the text, as an array of NumPy.
    pub fn array<'py>(&self, py: Python<'py>, path: &str) -> PyResult<Bound<'py, PyAny>> {
        array(py, self.column(py, path)?)
    }

    /// A column in SI units, as an array of NumPy.
    pub fn si<'py>(&self, py: Python<'py>, path: &str) -> PyResult<Bound<'py, PyAny>> {
        let found = self.found(path)?;
        let values = Float64Array::from(found.values.clone());
        let unit = eng::DisplayUnit::si(found.dimension).symbol;
        array(py, Column::new(path, &unit, &found.frame, values))
    }

    /// The schema, for programs that read Arrow.
    pub fn schema<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyCapsule>> {
        let schema = FFI_ArrowSchema::try_from(self.batch(py)?.schema_ref().as_ref());
        let schema = schema.map_err(|error| PyRuntimeError::new_err(error.to_string()))?;
        PyCapsule::new_with_value(py, schema, c"arrow_schema")
    }

    /// The columns, for programs that read Arrow.
    pub fn stream<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyCapsule>> {
        let batch = self.batch(py)?.clone();
        let schema = batch.schema();
        let reader = RecordBatchIterator::new(std::iter::once(Ok(batch)), schema);
        let stream = FFI_ArrowArrayStream::new(Box::new(reader));
        PyCapsule::new_with_value(py, stream, c"arrow_array_stream")
    }
}
