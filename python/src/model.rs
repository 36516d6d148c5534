//! Compiled models, and descriptions of their parameters, inputs and channels.

use crate::failure::plain;
use crate::quantities::{quantity, refused, settings};
use crate::simulation::Simulation;
use eng::{DisplayUnit, Interpolation, ParameterInfo, StepControl};
use pyo3::prelude::*;

/// A number of a model that changes without compiling again. `value` and the open limits `lower` and `upper` are in `unit`;
/// `shown*si_scale + si_offset` is a value in SI units.
#[pyclass(frozen, get_all, module = "englang")]
pub struct Parameter {
    path: String,
    unit: String,
    dimension: String,
    value: f64,
    lower: f64,
    upper: f64,
    si_scale: f64,
    si_offset: f64,
}

#[pymethods]
impl Parameter {
    fn __repr__(&self) -> String {
        format!("<Parameter {} = {} {}>", self.path, self.value, self.unit)
    }
}

/// Parameters with their values (SI), in the same order.
pub fn parameters(infos: Vec<ParameterInfo>, values: &[f64]) -> Vec<Parameter> {
    let valued = infos.into_iter().zip(values);
    let shown = valued.map(|(info, value)| Parameter {
        value: info.display.from_si(*value),
        lower: info.display.from_si(info.limits.0),
        upper: info.display.from_si(info.limits.1),
        path: info.path,
        dimension: info.dimension.to_string(),
        si_scale: info.display.scale,
        si_offset: info.display.offset,
        unit: info.display.symbol,
    });
    shown.collect()
}

/// A number that a program sets while a simulation runs. The open limits are in `unit`.
#[pyclass(frozen, get_all, module = "englang")]
pub struct Input {
    path: String,
    unit: String,
    dimension: String,
    lower: f64,
    upper: f64,
    interpolation: &'static str,
}

#[pymethods]
impl Input {
    fn __repr__(&self) -> String {
        format!("<Input {} in {}>", self.path, self.unit)
    }
}

/// A column that a run records. `frame` names the axes of a component, and is empty for a scalar.
#[pyclass(frozen, get_all, module = "englang")]
pub struct Channel {
    path: String,
    unit: String,
    dimension: String,
    frame: String,
}

#[pymethods]
impl Channel {
    fn __repr__(&self) -> String {
        format!("<Channel {} in {}>", self.path, self.unit)
    }
}

/// A compiled model.
#[pyclass(frozen, module = "englang")]
pub struct Model {
    /// The library's model.
    pub inner: eng::Model,
}

#[pymethods]
impl Model {
    /// The model's name.
    #[getter]
    fn name(&self) -> &str {
        self.inner.name()
    }

    /// One line: bodies, elements, unknowns, bytes of code.
    #[getter]
    fn summary(&self) -> String {
        self.inner.summary()
    }

    /// All parameters with their values in the text.
    #[getter]
    fn parameters(&self, py: Python<'_>) -> PyResult<Vec<Parameter>> {
        let values = self.inner.simulation().parameter_values();
        let values = values.map_err(plain(py))?;
        Ok(parameters(self.inner.parameters(), &values))
    }

    /// All inputs.
    #[getter]
    fn inputs(&self) -> Vec<Input> {
        let inputs = self.inner.inputs().into_iter();
        let described = inputs.map(|info| Input {
            lower: info.display.from_si(info.limits.0),
            upper: info.display.from_si(info.limits.1),
            path: info.path,
            dimension: info.dimension.to_string(),
            unit: info.display.symbol,
            interpolation: match info.interpolation {
                Interpolation::Hold => "hold",
                Interpolation::Linear => "linear",
                Interpolation::Cubic => "cubic",
            },
        });
        described.collect()
    }

    /// All channels.
    #[getter]
    fn channels(&self) -> Vec<Channel> {
        let channels = self.inner.channels().into_iter();
        let described = channels.map(|info| {
            let DisplayUnit { symbol, .. } = info.display;
            Channel {
                path: info.path,
                unit: symbol,
                dimension: info.dimension.to_string(),
                frame: info.frame,
            }
        });
        described.collect()
    }

    /// Starts a simulation, or continues one from a checkpoint of the same model with the same parameters.
    #[pyo3(signature = (set=None, *, step=None, tolerance=None, checkpoint=None))]
    fn simulation(
        &self,
        py: Python<'_>,
        set: Option<&Bound<'_, PyAny>>,
        step: Option<&Bound<'_, PyAny>>,
        tolerance: Option<f64>,
        checkpoint: Option<Vec<u8>>,
    ) -> PyResult<Simulation> {
        let mut builder = self.inner.simulation();
        for (path, value) in settings(set)? {
            let found = self.inner.parameter(&path);
            let parameter = found.map_err(|error| refused(py, &path, &error))?;
            let info = self.inner.describe(parameter).map_err(plain(py))?;
            let value = quantity(&path, &value, info.dimension)?;
            builder = builder
                .set(parameter, value)
                .map_err(|error| refused(py, &path, &error))?;
        }
        builder = match steps(step, tolerance)? {
            None => builder,
            Some(control) => builder.stepping(control),
        };
        let started = py.detach(|| match checkpoint {
            Some(bytes) => builder.resume(&bytes),
            None => builder.start(),
        });
        let inner = started.map_err(plain(py))?;
        Ok(Simulation::new(inner, self.inner.clone()))
    }

    fn __repr__(&self) -> String {
        format!("<Model {}>", self.inner.summary())
    }
}

/// The steps that a caller states in place of those of the text.
pub fn steps(
    step: Option<&Bound<'_, PyAny>>,
    tolerance: Option<f64>,
) -> PyResult<Option<StepControl>> {
    let step = match step {
        None => None,
        Some(value) => {
            let step = quantity("step", value, eng::Dimension::TIME)?;
            if step.dimension() != eng::Dimension::TIME {
                let message = format!("step: a step is a time, such as \"10 us\", not {step}");
                return Err(crate::failure::setting(value.py(), &message));
            }
            Some(step.value())
        }
    };
    Ok(StepControl::stated(step, tolerance))
}
