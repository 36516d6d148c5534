//! The derivatives of the channels of a run by parameters of its model.

use super::Analysis;
use crate::error::Error;
use crate::results::{
    Column, Gradient, Results, ResultsError, derivative_of, derived_from, gradients_file,
    read_gradients, remove_if_there, write_gradients,
};
use eng_runtime::SampleGradient;
use eng_system::analysis::{Named, Names};
use eng_system::recorded::{Recorded, recorded};
use eng_system::system::Location;

impl Analysis {
    /// Differentiates the channels by parameters, in place of those of the text: see [`Outcome::gradients`]. In a path `[*]`
    /// stands for every index.
    ///
    /// # Errors
    /// No such parameter; one that is named twice; another kind of analysis than `transient` and `periodic`.
    ///
    /// [`Outcome::gradients`]: super::Outcome::gradients
    pub fn gradients<P: AsRef<str>>(mut self, paths: &[P]) -> Result<Self, Error> {
        let at = self.plan.origin.used_at.unwrap_or(Location {
            source: 0,
            start: 0,
            end: 0,
        });
        let named: Vec<Named> = paths
            .iter()
            .map(|path| Named {
                path: path.as_ref().to_owned(),
                at,
            })
            .collect();
        let system = &self.model.compiled().system;
        let known = system.paths_of(Names::Parameters);
        if let Err(misnamed) = Names::Parameters.indices(&named, &known) {
            let path = named
                .get(misnamed.index)
                .map_or("", |name| name.path.as_str());
            if misnamed.again {
                return Err(Error::GradientTwice {
                    path: path.to_owned(),
                });
            }
            return Err(match self.parameter(path) {
                Err(error) => error,
                Ok(_) => Error::OtherModel,
            });
        }
        match self.plan.kind.gradients_mut() {
            Some(gradients) => *gradients = named,
            None if named.is_empty() => {}
            None => {
                return Err(Error::NoGradients {
                    analysis: self.name().to_owned(),
                });
            }
        }
        Ok(self)
    }

    /// The gradients of a run that begins.
    pub(super) fn gradient_columns(&self) -> Vec<GradientColumns> {
        let Some(gradients) = self.plan.kind.gradients() else {
            return Vec::new();
        };
        let system = &self.model.compiled().system;
        let known = system.paths_of(Names::Parameters);
        // the run itself reports wrong names; here they give no columns
        let found = Names::Parameters.indices(gradients, &known);
        let parameters = found.unwrap_or_default().into_iter();
        let found = parameters.filter_map(|index| system.parameters.get(index));
        found
            .map(|parameter| {
                let head = 1 + if system.cycle.is_some() { 2 } else { 0 };
                let recorded = recorded(system);
                let (head, rest) = recorded.split_at(head);
                let own = |column: &Recorded| Column {
                    path: column.path.clone(),
                    dimension: column.dimension,
                    display: column.display.clone(),
                    frame: column.frame.clone(),
                    values: Vec::new(),
                };
                let derived = |column: &Recorded| Column {
                    path: derivative_of(&column.path).to_owned(),
                    dimension: column.dimension.over(parameter.dimension),
                    display: column.display.over(&parameter.display),
                    ..own(column)
                };
                let mut columns: Vec<Column> = head.iter().map(own).collect();
                let channels = rest.iter().take(system.channels.len());
                columns.extend(head.iter().chain(channels).map(derived));
                GradientColumns {
                    columns,
                    parameter: parameter.origin.path.clone(),
                    unit: parameter.display.clone(),
                }
            })
            .collect()
    }

    /// The gradients that an earlier complete run left beside its results. `None` if its text names gradients that are not there,
    /// as after a run that was killed between its results and them.
    pub(super) fn gradients_left(&self, results: &Results) -> Option<Vec<Gradient>> {
        let wanted = self.gradient_columns();
        let Some(folder) = self.recorded_to().filter(|_| !wanted.is_empty()) else {
            return Some(Vec::new());
        };
        let left = read_gradients(folder, results).unwrap_or_default();
        let names = left.iter().map(|gradient| &gradient.parameter);
        names
            .eq(wanted.iter().map(|columns| &columns.parameter))
            .then_some(left)
    }

    /// Writes gradients into the folder of the results, and removes those of an earlier text.
    pub(super) fn write_gradients(
        &self,
        gradients: &[Gradient],
        of: &Results,
    ) -> Result<(), ResultsError> {
        let Some(folder) = self.recorded_to() else {
            return Ok(());
        };
        let path = gradients_file(folder, self.name());
        if !gradients.is_empty() {
            return write_gradients(&path, gradients, of);
        }
        remove_if_there(&path)
    }
}

/// The derivatives by a parameter during a run.
#[derive(Debug)]
pub(super) struct GradientColumns {
    columns: Vec<Column>,
    parameter: String,
    unit: eng_system::DisplayUnit,
}

impl GradientColumns {
    /// Adds a sample: its time and cycle, and the derivatives there (SI).
    pub fn push(&mut self, head: &[f64], sample: SampleGradient<'_>) {
        let cycle = sample.cycle.iter().take(head.len().saturating_sub(1));
        let derived = std::iter::once(&sample.time).chain(cycle);
        let row = head.iter().chain(derived).chain(sample.channels);
        for (column, value) in self.columns.iter_mut().zip(row) {
            column.values.push(*value);
        }
    }

    /// The gradients at the kept samples of a run, of its kept channels.
    pub fn finish(self, kept: &Results) -> Result<Gradient, ResultsError> {
        let mut results = kept.without_columns();
        for mut column in self.columns {
            let of = derived_from(&column.path).unwrap_or(&column.path);
            if kept.column(of).is_some() {
                let first = column.values.len().saturating_sub(kept.samples());
                column.values.drain(..first);
                results.push(column)?;
            }
        }
        Ok(Gradient {
            parameter: self.parameter,
            unit: self.unit,
            results,
        })
    }
}
