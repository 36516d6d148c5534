//! Simulations that a program steps.

use crate::failure::plain;
use crate::quantities::{quantity, refused};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyTuple};

/// A running simulation. Numbers are in SI units. One thread at a time may use it.
#[pyclass(module = "englang")]
pub struct Simulation {
    inner: eng::Simulation,
    model: eng::Model,
}

impl Simulation {
    /// A started simulation of a model.
    pub fn new(inner: eng::Simulation, model: eng::Model) -> Simulation {
        Simulation { inner, model }
    }
}

#[pymethods]
impl Simulation {
    /// Time (s).
    #[getter]
    fn time(&self) -> f64 {
        self.inner.time()
    }

    /// Angle of the cycle (rad) since the start; `None` for a model without a cycle.
    #[getter]
    fn cycle_angle(&self) -> Option<f64> {
        self.inner.cycle_angle().map(|angle| angle.value())
    }

    /// One step of the integrator. Returns the time reached (s).
    fn step(&mut self, py: Python<'_>) -> PyResult<f64> {
        py.detach(|| self.inner.step()).map_err(plain(py))
    }

    /// Steps up to a time (s), which no step crosses. Returns the time reached.
    fn advance(&mut self, py: Python<'_>, to: f64) -> PyResult<f64> {
        py.detach(|| self.inner.advance(to)).map_err(plain(py))
    }

    /// Sets an input from the present time on.
    fn set_input(&mut self, path: &str, value: &Bound<'_, PyAny>) -> PyResult<()> {
        let py = value.py();
        let named = |error: eng::Error| refused(py, path, &error);
        let input = self.model.input(path).map_err(named)?;
        let info = self.model.describe(input.parameter()).map_err(named)?;
        let value = quantity(path, value, info.dimension)?;
        self.inner.set_quantity(input, value).map_err(named)
    }

    /// The value of a channel at the present state.
    fn value(&mut self, py: Python<'_>, path: &str) -> PyResult<f64> {
        let channel = self.model.channel(path).map_err(plain(py))?;
        self.inner.value(channel).map_err(plain(py))
    }

    /// Plans the reading of channels. Calling the plan returns their values at the present state.
    #[pyo3(signature = (*paths))]
    fn watch(slf: Bound<'_, Self>, paths: &Bound<'_, PyTuple>) -> PyResult<Reading> {
        let py = slf.py();
        let simulation = slf.borrow();
        let paths: Vec<String> = paths.extract()?;
        let channels = paths.iter().map(|path| simulation.model.channel(path));
        let channels = channels.collect::<Result<Vec<_>, _>>().map_err(plain(py))?;
        let inner = simulation.inner.watch(&channels).map_err(plain(py))?;
        Ok(Reading {
            values: vec![0.0; channels.len()],
            inner,
            simulation: slf.clone().unbind(),
        })
    }

    /// The state as bytes. A simulation that continues from them gives the same bits as this one.
    fn checkpoint<'py>(&mut self, py: Python<'py>) -> Bound<'py, PyBytes> {
        PyBytes::new(py, &self.inner.checkpoint())
    }

    fn __repr__(&self) -> String {
        format!(
            "<Simulation of {} at {} s>",
            self.model.name(),
            self.inner.time()
        )
    }
}

/// A plan for reading channels of a simulation.
#[pyclass(module = "englang")]
pub struct Reading {
    inner: eng::Reading,
    values: Vec<f64>,
    simulation: Py<Simulation>,
}

#[pymethods]
impl Reading {
    /// The values (SI) at the present state, in the order of the plan.
    fn __call__<'py>(&mut self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        let mut simulation = self.simulation.try_borrow_mut(py)?;
        let read = simulation.inner.read(&mut self.inner, &mut self.values);
        read.map_err(plain(py))?;
        PyTuple::new(py, &self.values)
    }
}
