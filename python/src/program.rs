//! Checked programs.

use crate::analysis::Analysis;
use crate::failure::{self, plain};
use crate::model::Model;
use crate::report::{Report, Source};
use crate::run::Run;
use eng::{Checked, Error, HostError, Sources};
use pyo3::exceptions::{PyFileNotFoundError, PyOSError};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyTuple};
use std::collections::BTreeMap;
use std::path::PathBuf;

/// A checked text: its models, analyses and reports.
#[pyclass(frozen, module = "englang._native")]
pub struct Program {
    inner: eng::Program,
    /// Warnings and notes of the check, as JSON.
    messages: String,
}

/// Reads and checks a model's file with all that it uses from its folder.
#[pyfunction]
pub fn load(py: Python<'_>, path: PathBuf) -> PyResult<Program> {
    let opened = py.detach(|| eng::open(&path));
    program(
        py,
        opened.map_err(|error| match error {
            HostError::NotFound(_) => PyFileNotFoundError::new_err(error.to_string()),
            _ => PyOSError::new_err(error.to_string()),
        })?,
    )
}

/// Checks a text. `files` are further texts that it uses: other models and data, by their names.
#[pyfunction]
#[pyo3(signature = (text, *, name="model.eng", files=None))]
pub fn from_text(
    py: Python<'_>,
    text: String,
    name: &str,
    files: Option<BTreeMap<String, String>>,
) -> PyResult<Program> {
    let mut texts = files.unwrap_or_default();
    texts.insert(name.to_owned(), text);
    let sources = Sources::from_texts(texts);
    program(py, py.detach(|| eng::check(&sources, name)))
}

fn program(py: Python<'_>, checked: Checked) -> PyResult<Program> {
    let report = checked.report();
    let messages = eng::render::json(report.diagnostics(), report.texts());
    let inner = checked.into_program();
    let inner = inner.map_err(|report| failure::raised(py, &Error::Report(report), None))?;
    Ok(Program { inner, messages })
}

#[pymethods]
impl Program {
    /// The file's name.
    #[getter]
    fn file(&self) -> &str {
        self.inner.file()
    }

    /// The names of its models.
    #[getter]
    fn models(&self) -> Vec<&str> {
        self.inner.models()
    }

    /// The names of its analyses, in the order of the text.
    #[getter]
    fn analyses(&self) -> Vec<&str> {
        self.inner.analyses()
    }

    /// The names of its reports, in the order of the text.
    #[getter]
    fn reports(&self) -> Vec<&str> {
        let reports = self.inner.reports().iter();
        reports.map(|report| report.name.as_str()).collect()
    }

    /// Hash of the texts, without reports.
    #[getter]
    fn source_hash(&self) -> String {
        self.inner.source_hash()
    }

    /// Names and contents of the files that it has opened, for a copy in another process.
    fn contents<'py>(&self, py: Python<'py>) -> PyResult<Vec<(String, Bound<'py, PyBytes>)>> {
        let contents = py.detach(|| self.inner.contents());
        let contents = contents.map_err(|error| PyOSError::new_err(error.to_string()))?;
        let shared = contents.into_iter();
        Ok(shared
            .map(|(name, bytes)| (name, PyBytes::new(py, &bytes)))
            .collect())
    }

    /// Warnings and notes of the check.
    #[getter]
    fn warnings<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        failure::diagnostics(py, &self.messages)
    }

    /// Compiles a model.
    fn model(&self, py: Python<'_>, name: &str) -> PyResult<Model> {
        let inner = py.detach(|| self.inner.model(name)).map_err(plain(py))?;
        Ok(Model { inner })
    }

    /// Compiles the model of an analysis. A model with the same constants is compiled once.
    fn analysis(&self, py: Python<'_>, name: &str) -> PyResult<Analysis> {
        let inner = py.detach(|| self.inner.analysis(name)).map_err(plain(py))?;
        Ok(Analysis::new(inner, self.inner.clone()))
    }

    /// Evaluates a report of the text over runs of this text.
    #[pyo3(signature = (name, *runs))]
    fn report(&self, py: Python<'_>, name: &str, runs: &Bound<'_, PyTuple>) -> PyResult<Report> {
        let runs: Vec<Py<Run>> = runs.extract()?;
        let sources: Vec<Source<'_>> = runs.iter().map(|run| run.get().source()).collect();
        Report::evaluated(py, &self.inner, name, None, &sources)
    }

    fn __repr__(&self) -> String {
        format!(
            "<Program {}: {} models, {} analyses>",
            self.inner.file(),
            self.inner.models().len(),
            self.inner.analyses().len()
        )
    }
}
