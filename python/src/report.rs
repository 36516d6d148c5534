//! Reports of a text over runs.

use crate::failure;
use eng::DisplayUnit;
use eng::post::{EvaluatedReport, Outcome, by_parameter, evaluate};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// A condition of a report: its message with the values, and whether it holds. A condition that only advises gives a warning.
#[pyclass(frozen, get_all, module = "englang._native")]
pub struct Condition {
    message: String,
    holds: bool,
    advises: bool,
}

#[pymethods]
impl Condition {
    fn __repr__(&self) -> String {
        match self.holds {
            true => "<Condition holds>".to_owned(),
            false => format!("<Condition does not hold: {}>", self.message),
        }
    }
}

/// A report of the text, evaluated over runs.
#[pyclass(frozen, module = "englang._native")]
pub struct Report {
    inner: EvaluatedReport,
}

/// A run on its way to a report: its analysis, the hash of its texts, its numbers.
pub struct Source<'r> {
    pub analysis: &'r str,
    pub hash: Option<&'r String>,
    pub run: eng::post::Run<'r>,
}

impl Report {
    /// Evaluates a report of a program, or the derivatives of its values by a parameter with a unit.
    pub fn evaluated(
        py: Python<'_>,
        program: &eng::Program,
        name: &str,
        by: Option<(&str, &DisplayUnit)>,
        sources: &[Source<'_>],
    ) -> PyResult<Report> {
        let reports = program.reports();
        let Some(report) = reports.iter().find(|report| report.name == name) else {
            let known: Vec<&str> = reports.iter().map(|report| report.name.as_str()).collect();
            let known = known.join(", ");
            let message = format!("there is no report {name}; there are: {known}");
            return Err(failure::setting(py, &message));
        };
        let hash = program.source_hash();
        if let Some(other) = sources.iter().find(|source| source.hash != Some(&hash)) {
            let message = format!("the results of {} are of another text", other.analysis);
            return Err(failure::setting(py, &message));
        }
        let runs: Vec<eng::post::Run<'_>> = sources.iter().map(|source| source.run).collect();
        let inner = py.detach(|| match by {
            Some((parameter, unit)) => evaluate(&by_parameter(report, parameter, unit), &runs),
            None => evaluate(report, &runs),
        });
        Ok(Report { inner })
    }

    /// Calls a function with the name, the unit and the number of each value.
    fn each<E>(&self, mut value: impl FnMut(String, &str, f64) -> Result<(), E>) -> Result<(), E> {
        for entry in &self.inner.entries {
            let Ok(Outcome::Value(numbers, display)) = &entry.outcome else {
                continue;
            };
            for number in numbers {
                let name = match number.name.as_str() {
                    "" => entry.name.clone(),
                    member => format!("{}.{member}", entry.name),
                };
                value(name, &display.symbol, display.from_si(number.value))?;
            }
        }
        Ok(())
    }
}

#[pymethods]
impl Report {
    /// Its name.
    #[getter]
    fn name(&self) -> &str {
        &self.inner.name
    }

    /// Its title.
    #[getter]
    fn title(&self) -> &str {
        &self.inner.title
    }

    /// Its values in the units of the text. The name of one of several numbers is `value.channel`.
    #[getter]
    fn values<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let values = PyDict::new(py);
        self.each(|name, _, number| values.set_item(name, number))?;
        Ok(values)
    }

    /// The units of the values.
    #[getter]
    fn units<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let units = PyDict::new(py);
        self.each(|name, unit, _| units.set_item(name, unit))?;
        Ok(units)
    }

    /// Its conditions, in the order of the text.
    #[getter]
    fn conditions(&self) -> Vec<Condition> {
        let entries = self.inner.entries.iter();
        let conditions = entries.filter_map(|entry| match &entry.outcome {
            Ok(Outcome::Condition {
                holds,
                message,
                advise,
            }) => Some(Condition {
                message: message.clone(),
                holds: *holds,
                advises: *advise,
            }),
            _ => None,
        });
        conditions.collect()
    }

    /// Whether all its `require` hold.
    #[getter]
    fn holds(&self) -> bool {
        !self.inner.fails()
    }

    /// Its figures as texts of SVG.
    #[getter]
    fn figures<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let figures = PyDict::new(py);
        for entry in &self.inner.entries {
            if let Ok(Outcome::Figure(figure)) = &entry.outcome {
                figures.set_item(&entry.name, figure.to_svg())?;
            }
        }
        Ok(figures)
    }

    /// The entries that the runs do not give, with the reasons.
    #[getter]
    fn missing<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let missing = PyDict::new(py);
        for entry in &self.inner.entries {
            if let Err(reason) = &entry.outcome {
                missing.set_item(&entry.name, reason.to_string())?;
            }
        }
        Ok(missing)
    }

    fn __repr__(&self) -> String {
        format!(
            "<Report {}: {} entries>",
            self.inner.name,
            self.inner.entries.len()
        )
    }
}
