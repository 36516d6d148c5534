//! Values that Python gives: texts with units, or numbers in SI units.

use crate::failure;
use eng::{Dimension, Quantity};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyFloat, PyMapping, PyString};

/// The paths and values of a mapping.
pub fn settings<'py>(
    set: Option<&Bound<'py, PyAny>>,
) -> PyResult<Vec<(String, Bound<'py, PyAny>)>> {
    let Some(set) = set else {
        return Ok(Vec::new());
    };
    let items = set.cast::<PyMapping>()?.items()?;
    items.iter().map(|item| item.extract()).collect()
}

/// The quantity for something of a dimension. `name` says in messages which value it is.
pub fn quantity(name: &str, value: &Bound<'_, PyAny>, dimension: Dimension) -> PyResult<Quantity> {
    let py = value.py();
    // `float` of a quantity of pint would lose its unit
    let known = value.is_instance_of::<PyString>() || value.is_instance_of::<PyFloat>();
    let foreign = match known {
        true => None,
        false => {
            let quantities = py.import("englang._quantities")?;
            Some(quantities.call_method1("text_of", (name, value))?)
        }
    };
    let value = foreign.as_ref().unwrap_or(value);
    if let Ok(text) = value.extract::<String>() {
        let parsed = text.parse::<Quantity>();
        return parsed.map_err(|error| failure::setting(py, &format!("{name}: {error}")));
    }
    let number = match value.is_instance_of::<PyBool>() {
        true => None,
        false => value.extract::<f64>().ok(),
    };
    match number {
        Some(number) => Ok(Quantity::si(number, dimension)),
        None => Err(PyTypeError::new_err(format!(
            "{name}: a value is a text with a unit, such as \"250 mm\", or a number in SI units, not {}",
            value.get_type().name()?
        ))),
    }
}

/// The number in SI units of a quantity such as "250 mm".
#[pyfunction]
pub fn si(py: Python<'_>, text: &str) -> PyResult<f64> {
    let parsed = text.parse::<Quantity>();
    let quantity = parsed.map_err(|error| failure::setting(py, &error.to_string()))?;
    Ok(quantity.value())
}

/// The exception for an error about the value with a name.
pub fn refused(py: Python<'_>, name: &str, error: &eng::Error) -> PyErr {
    match error.report() {
        Some(_) => failure::raised(py, error, None),
        None => failure::setting(py, &format!("{name}: {error}")),
    }
}
