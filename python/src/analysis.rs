//! Analyses of a program, and their runs.

use crate::failure::{self, plain};
use crate::model::{Model, Parameter, parameters, steps};
use crate::packing::{self, RestoreError};
use crate::quantities::{quantity, refused, settings};
use crate::run::Run;
use crate::watch::Watch;
use eng::Failed;
use eng::results::{Recording, Selection};
use eng::run::{Event, run_while};
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::num::NonZeroUsize;
use std::ops::ControlFlow;
use std::path::PathBuf;

/// An analysis of the text with its compiled model. It does not change: `set` returns another one.
#[pyclass(frozen, module = "englang._native")]
pub struct Analysis {
    inner: eng::Analysis,
    program: eng::Program,
}

impl Analysis {
    /// An analysis of a program.
    pub fn new(inner: eng::Analysis, program: eng::Program) -> Analysis {
        Analysis { inner, program }
    }

    /// The analysis with values in place of those of the text.
    fn with(&self, py: Python<'_>, set: Option<&Bound<'_, PyAny>>) -> PyResult<eng::Analysis> {
        let mut analysis = self.inner.clone();
        for (path, value) in settings(set)? {
            let named = |error: eng::Error| refused(py, &path, &error);
            analysis = if analysis.chooses(&path) {
                let word: String = value.extract()?;
                py.detach(|| analysis.choose(&path, word.trim()))
                    .map_err(named)?
            } else {
                let parameter = analysis.parameter(&path).map_err(named)?;
                let info = analysis.model().describe(parameter).map_err(named)?;
                let value = quantity(&path, &value, info.dimension)?;
                analysis.set(parameter, value).map_err(named)?
            };
        }
        Ok(analysis)
    }
}

#[pymethods]
impl Analysis {
    /// Its name.
    #[getter]
    fn name(&self) -> &str {
        self.inner.name()
    }

    /// Its compiled model.
    #[getter]
    fn model(&self) -> Model {
        Model {
            inner: self.inner.model().clone(),
        }
    }

    /// All parameters of its model with the values of this analysis.
    #[getter]
    fn parameters(&self, py: Python<'_>) -> PyResult<Vec<Parameter>> {
        let values = self.inner.parameter_values().map_err(plain(py))?;
        Ok(parameters(self.inner.model().parameters(), &values))
    }

    /// The point of a sweep: the values of its indices in the units of the text.
    #[getter]
    fn point<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let point = PyDict::new(py);
        for index in self.inner.point() {
            point.set_item(&index.name, index.display.from_si(index.value))?;
        }
        Ok(point)
    }

    /// The analysis with other parameters, or with other words of choices.
    fn set(&self, py: Python<'_>, set: &Bound<'_, PyAny>) -> PyResult<Analysis> {
        let inner = self.with(py, Some(set))?;
        Ok(Analysis::new(inner, self.program.clone()))
    }

    /// Runs the analysis; `englang.Analysis.run` explains the arguments.
    #[pyo3(signature = (set=None, *, step=None, tolerance=None, channels=None, folder=None, resume=false,
        threads=1, gradients=None, patient=false, progress=None))]
    // Python names its arguments
    #[expect(
        clippy::too_many_arguments,
        reason = "all but one have a name in each call"
    )]
    fn run(
        &self,
        py: Python<'_>,
        set: Option<&Bound<'_, PyAny>>,
        step: Option<&Bound<'_, PyAny>>,
        tolerance: Option<f64>,
        channels: Option<Vec<String>>,
        folder: Option<PathBuf>,
        resume: bool,
        threads: usize,
        gradients: Option<Vec<String>>,
        patient: bool,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Run> {
        let Some(threads) = NonZeroUsize::new(threads) else {
            return Err(failure::setting(py, "threads: a run needs at least one"));
        };
        let channels = channels.unwrap_or_default();
        let mut analysis = self.with(py, set)?.threads(threads).record(Recording {
            folder,
            resume,
            channels: Selection::new(channels.iter().map(String::as_str)),
            last: None,
        });
        if let Some(control) = steps(step, tolerance)? {
            analysis = analysis.stepping(control);
        }
        if let Some(paths) = gradients {
            analysis = analysis.gradients(&paths).map_err(plain(py))?;
        }
        let mut watch = Watch::new(progress);
        let ran = py.detach(|| {
            run_while(&analysis, patient, &mut |event| match event {
                Event::Progress(now) => watch.look(&now),
                _ => ControlFlow::Continue(()),
            })
        });
        let (error, outcome) = match ran {
            Ok(outcome) => (None, Some(outcome)),
            Err(Failed { error, partial }) => (Some(error), partial.map(|partial| *partial)),
        };
        let run = outcome.map(|outcome| Run::new(py, outcome, self.program.clone()));
        let run = run.transpose()?;
        let partial = |run: Option<Run>| -> PyResult<Option<Bound<'_, PyAny>>> {
            let run = run.map(|run| Bound::new(py, run)).transpose()?;
            Ok(run.map(Bound::into_any))
        };
        match (watch.raised(), error, run) {
            (Some(raised), ..) if !raised.is_instance_of::<PyKeyboardInterrupt>(py) => Err(raised),
            (Some(_), _, run) => Err(failure::interrupted(py, partial(run)?)),
            (None, None, Some(run)) => Ok(run),
            (None, Some(error), run) => Err(failure::raised(py, &error, partial(run)?)),
            // a run without an error has an outcome
            (None, None, None) => Err(failure::setting(py, "the run has no results")),
        }
    }

    /// A run of this analysis that another process has packed.
    fn restored(&self, py: Python<'_>, packed: &[u8]) -> PyResult<Run> {
        let restored = py.detach(|| packing::restored(packed, &self.inner));
        let (outcome, messages) = match restored {
            Ok(restored) => restored,
            Err(RestoreError::Model(error)) => return Err(plain(py)(*error)),
            Err(error) => return Err(failure::setting(py, &error.to_string())),
        };
        Run::with_messages(py, outcome, self.program.clone(), messages)
    }

    fn __repr__(&self) -> String {
        format!(
            "<Analysis {} of {}>",
            self.inner.name(),
            self.inner.model().name()
        )
    }
}
