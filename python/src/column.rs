//! A column of results, whose numbers Python reads without a copy.

use arrow_array::Float64Array;
use pyo3::exceptions::{PyBufferError, PyIndexError};
use pyo3::ffi;
use pyo3::prelude::*;
use pyo3::types::{PyIterator, PyMemoryView};
use std::ffi::{c_int, c_void};

/// A column of results: 64-bit floats with a unit. `memoryview` and `numpy.asarray` read it without a copy.
#[pyclass(frozen, module = "englang")]
pub struct Column {
    /// `main[5].force.x`.
    #[pyo3(get)]
    path: String,
    /// The unit of its numbers.
    #[pyo3(get)]
    unit: String,
    /// The axes of a component, as a path; empty for a scalar.
    #[pyo3(get)]
    frame: String,
    values: Float64Array,
    /// Length, for views.
    shape: [ffi::Py_ssize_t; 1],
    /// Bytes from number to number, for views.
    strides: [ffi::Py_ssize_t; 1],
}

impl Column {
    /// A column of numbers without nulls.
    pub fn new(path: &str, unit: &str, frame: &str, values: Float64Array) -> Column {
        Column {
            path: path.to_owned(),
            unit: unit.to_owned(),
            frame: frame.to_owned(),
            shape: [values.len() as ffi::Py_ssize_t],
            strides: [size_of::<f64>() as ffi::Py_ssize_t],
            values,
        }
    }
}

#[pymethods]
impl Column {
    fn __len__(&self) -> usize {
        self.values.len()
    }

    fn __getitem__(&self, index: isize) -> PyResult<f64> {
        let from_end = self.values.len().checked_add_signed(index);
        let place = usize::try_from(index).ok().or(from_end);
        let value = place.and_then(|place| self.values.values().get(place));
        value
            .copied()
            .ok_or_else(|| PyIndexError::new_err("the column has no such sample"))
    }

    fn __iter__<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyIterator>> {
        PyMemoryView::from(slf.as_any())?.try_iter()
    }

    fn __repr__(&self) -> String {
        format!(
            "<Column {} in {}: {} values>",
            self.path,
            self.unit,
            self.values.len()
        )
    }

    /// Gives a view of the numbers, for reading only.
    // SAFETY: Python calls this slot with a `view` that is null or may be written; all else is checked or owned here.
    #[expect(unsafe_code, reason = "the buffer protocol of Python is in C")]
    unsafe fn __getbuffer__(
        slf: Bound<'_, Self>,
        view: *mut ffi::Py_buffer,
        flags: c_int,
    ) -> PyResult<()> {
        if view.is_null() {
            return Err(PyBufferError::new_err("there is no place for the view"));
        }
        if flags & ffi::PyBUF_WRITABLE == ffi::PyBUF_WRITABLE {
            // SAFETY: `view` is not null, and its owner expects no object after an error.
            unsafe { (*view).obj = std::ptr::null_mut() };
            return Err(PyBufferError::new_err("results are for reading only"));
        }
        let asked = |flag: c_int| flags & flag == flag;
        let column = slf.get();
        let values = column.values.values();
        let filled = ffi::Py_buffer {
            buf: values.as_ptr().cast_mut().cast::<c_void>(),
            len: size_of_val::<[f64]>(values) as ffi::Py_ssize_t,
            itemsize: size_of::<f64>() as ffi::Py_ssize_t,
            readonly: 1,
            ndim: 1,
            format: match asked(ffi::PyBUF_FORMAT) {
                true => c"d".as_ptr().cast_mut(),
                false => std::ptr::null_mut(),
            },
            shape: match asked(ffi::PyBUF_ND) {
                true => column.shape.as_ptr().cast_mut(),
                false => std::ptr::null_mut(),
            },
            strides: match asked(ffi::PyBUF_STRIDES) {
                true => column.strides.as_ptr().cast_mut(),
                false => std::ptr::null_mut(),
            },
            suboffsets: std::ptr::null_mut(),
            internal: std::ptr::null_mut(),
            obj: slf.clone().into_any().into_ptr(),
        };
        // SAFETY: `view` is not null and may be written. The pointers stay valid as long as the view: `obj` keeps the column, a
        // frozen object at a fixed place, which owns `values`, `shape` and `strides`; the format is static. Consumers do not write,
        // because `readonly` is set.
        unsafe { view.write(filled) };
        Ok(())
    }
}
