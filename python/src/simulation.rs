//! Simulations that a program steps.

use crate::failure::plain;
use crate::quantities::{quantity, refused};
use crate::watch::Signals;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyTuple};
use std::sync::Mutex;

/// A running simulation. Numbers are in SI units. One thread at a time may use it.
#[pyclass(frozen, module = "englang")]
pub struct Simulation {
    inner: Mutex<eng::Simulation>,
    model: eng::Model,
}

impl Simulation {
    /// A started simulation of a model.
    pub fn new(inner: eng::Simulation, model: eng::Model) -> Simulation {
        Simulation {
            inner: Mutex::new(inner),
            model,
        }
    }

    /// Calls a function on the simulation, without the interpreter's lock. It does not wait for another thread, because that
    /// thread may wait for the interpreter.
    fn used<R: Send>(
        &self,
        py: Python<'_>,
        work: impl FnOnce(&mut eng::Simulation) -> R + Send,
    ) -> PyResult<R> {
        let done = py.detach(|| {
            let inner = self.inner.try_lock();
            inner.ok().map(|mut simulation| work(&mut simulation))
        });
        done.ok_or_else(|| PyRuntimeError::new_err("another thread uses the simulation"))
    }
}

#[pymethods]
impl Simulation {
    /// Time (s).
    #[getter]
    fn time(&self, py: Python<'_>) -> PyResult<f64> {
        self.used(py, |simulation| simulation.time())
    }

    /// Angle of the cycle (rad) since the start; `None` for a model without a cycle.
    #[getter]
    fn cycle_angle(&self, py: Python<'_>) -> PyResult<Option<f64>> {
        let angle = self.used(py, |simulation| simulation.cycle_angle())?;
        Ok(angle.map(|angle| angle.value()))
    }

    /// One step of the integrator. Returns the time reached (s).
    fn step(&self, py: Python<'_>) -> PyResult<f64> {
        self.used(py, |simulation| simulation.step())?
            .map_err(plain(py))
    }

    /// Steps up to a time (s), which no step crosses. Returns the time reached. Ctrl-C ends it at a step.
    fn advance(&self, py: Python<'_>, to: f64) -> PyResult<f64> {
        let mut signals = Signals::new();
        let reached = self.used(py, |simulation| {
            simulation.advance_while(to, &mut |_| signals.look(|_| Ok(())))
        })?;
        match signals.raised {
            Some(raised) => Err(raised),
            None => reached.map_err(plain(py)),
        }
    }

    /// Sets an input from the present time on.
    fn set_input(&self, path: &str, value: &Bound<'_, PyAny>) -> PyResult<()> {
        let py = value.py();
        let named = |error: eng::Error| refused(py, path, &error);
        let input = self.model.input(path).map_err(named)?;
        let info = self.model.describe(input.parameter()).map_err(named)?;
        let value = quantity(path, value, info.dimension)?;
        self.used(py, |simulation| simulation.set_quantity(input, value))?
            .map_err(named)
    }

    /// The value of a channel at the present state.
    fn value(&self, py: Python<'_>, path: &str) -> PyResult<f64> {
        let channel = self.model.channel(path).map_err(plain(py))?;
        self.used(py, |simulation| simulation.value(channel))?
            .map_err(plain(py))
    }

    /// Plans the reading of channels. Calling the plan returns their values at the present state.
    #[pyo3(signature = (*paths))]
    fn watch(slf: Bound<'_, Self>, paths: &Bound<'_, PyTuple>) -> PyResult<Reading> {
        let (py, simulation) = (slf.py(), slf.get());
        let paths: Vec<String> = paths.extract()?;
        let channels = paths.iter().map(|path| simulation.model.channel(path));
        let channels = channels.collect::<Result<Vec<_>, _>>().map_err(plain(py))?;
        let inner = simulation.used(py, |simulation| simulation.watch(&channels))?;
        Ok(Reading {
            values: vec![0.0; channels.len()],
            inner: inner.map_err(plain(py))?,
            simulation: slf.clone().unbind(),
        })
    }

    /// The state as bytes. A simulation that continues from them gives the same bits as this one.
    fn checkpoint<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let bytes = self.used(py, |simulation| simulation.checkpoint())?;
        Ok(PyBytes::new(py, &bytes))
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let time = self.time(py)?;
        Ok(format!("<Simulation of {} at {time} s>", self.model.name()))
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
        let (inner, values) = (&mut self.inner, &mut self.values);
        let read = |simulation: &mut eng::Simulation| simulation.read(inner, values);
        self.simulation.get().used(py, read)?.map_err(plain(py))?;
        PyTuple::new(py, &self.values)
    }
}
