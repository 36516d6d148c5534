//! The numbers of a point: its row of the sweep's table, and the values of reports.

use super::{Manifest, Points, Prepare, Study, StudyError};
use crate::analysis::{Analysis, Failed};
use crate::post::{self, Run};
use crate::quantity::NamedUnit;
use crate::results::{Column, PointRow, PointTable, Results};
use crate::run::RunOutcome;
use crate::tables::sweep;
use eng_grammar::{Diagnostic, Diagnostics, SourceMap};
use eng_system::report::{EntryKind, Report};
use eng_system::system::Rows;
use eng_system::{Dimension, DisplayUnit};

/// Hexadecimal digits of a point's identity: 64 bits distinguish all points that anyone computes.
const DIGITS: usize = 16;

/// States of points.
pub(crate) const COMPLETE: &str = "complete";
const FAILED: &str = "failed";
const STOPPED: &str = "stopped";

impl Study {
    /// The columns of all points without values, with the metadata of the study. They do not depend on the slice: the
    /// columns of all models of the study are among them, in the order of its points.
    pub(super) fn columns_of_points(&self, models: &[Analysis]) -> Result<Results, StudyError> {
        let Some(first) = models.first() else {
            return Err(StudyError::Points(format!(
                "the model accepts the parameters of no point of {}; `eng check` names them",
                self.analysis()
            )));
        };
        let mut header = Results::new(self.analysis(), first.model().name());
        let Manifest {
            version,
            file,
            source_hash,
            identity,
            points,
            design,
            ..
        } = &self.manifest;
        header.set_metadata("version", version);
        header.set_metadata("file", file);
        header.set_metadata("source_hash", source_hash);
        header.set_metadata("study", identity);
        header.set_metadata("points", points.to_string());
        if let Some(design) = design {
            header.set_metadata("design", design);
        }
        let own = first.header()?;
        for (key, value) in own.metadata() {
            let fixed = match key.strip_prefix("parameter.") {
                // others may vary from point to point, or depend on those that do
                Some(path) => first.sets(path),
                None => key == "rows" || key.starts_with("override."),
            };
            if fixed {
                header.set_metadata(key, value);
            }
        }
        for analysis in models {
            let empty = RunOutcome {
                results: analysis.header()?,
                motion: None,
                machine: analysis.machine()?,
                diagnostics: Diagnostics::new(),
                facts: Vec::new(),
                point: analysis.point().to_vec(),
                periodic: (analysis.kind().rows() == Rows::Cycle).then_some((0, false)),
                gradients: Vec::new(),
                made_before: false,
                timings: None,
            };
            for column in self.numbers(&empty).0.columns() {
                if PointTable::is_reserved(&column.path) {
                    return Err(StudyError::Points(format!(
                        "every table of points has a column `{}` of its own; give this variable, parameter or output of {} another name",
                        column.path,
                        self.analysis()
                    )));
                }
                if header.column(&column.path).is_none() {
                    header.push(Column {
                        values: Vec::new(),
                        ..column.clone()
                    })?;
                }
            }
        }
        Ok(header)
    }

    /// An analysis of each model of the study whose parameters the model accepts: the points of a sweep may have other
    /// constants.
    pub(super) fn models<E: From<StudyError>>(
        &self,
        prepare: Prepare<'_, E>,
    ) -> Result<Vec<Analysis>, E> {
        let names = match &self.points {
            Points::Table { base, .. } => {
                // the parameters of a point may be refused, those of the text are not
                let points = self.analyses(1, 1, prepare)?;
                return Ok(points.iter().map(|point| base.named_as(point)).collect());
            }
            Points::Sweep(names) => names,
        };
        let mut found: Vec<Analysis> = Vec::new();
        let mut known = Vec::new();
        for name in names {
            let plan = self.program.plan(name).map_err(StudyError::from)?;
            let model = (plan.model, &plan.constants);
            if !known.contains(&model) {
                let analysis = self.program.analysis(name).map_err(StudyError::from)?;
                let analysis = prepare(analysis)?;
                if analysis.bound().is_ok() {
                    known.push(model);
                    found.push(analysis);
                }
            }
        }
        Ok(found)
    }

    /// The numbers of a point's outcome (SI), and the remarks of its reports: values that are not made, and
    /// requirements that do not hold.
    fn numbers(&self, outcome: &RunOutcome) -> (Results, String) {
        let results = &outcome.results;
        if results.are_modes() || results.are_responses() {
            return (sweep::stacked(self.analysis(), &[outcome]), String::new());
        }
        let (mut table, mut said) = (sweep::table(&[outcome]), Vec::new());
        if matches!(self.points, Points::Table { .. }) {
            let run = Run::new(&outcome.results, &outcome.machine);
            let runs = [run.with_gradients(&outcome.gradients)];
            for report in self.program.reports() {
                self.values(&self.own(report), &runs, &mut table, &mut said);
            }
        }
        (table, said.join("; "))
    }

    /// The values and requirements of a report that need this analysis alone.
    fn own(&self, report: &Report) -> Report {
        let mut own = report.clone();
        own.entries.retain(|entry| {
            let figure = matches!(entry.kind, EntryKind::Figure(_));
            !figure && entry.analyses() == [self.analysis()]
        });
        own
    }

    /// Adds the values of a report: `report.size.highest`, `report.size.both[2]` of several, and `report.size.holds` (1 or 0) for its requirements.
    fn values(
        &self,
        report: &Report,
        runs: &[Run<'_>],
        table: &mut Results,
        said: &mut Vec<String>,
    ) {
        let evaluated = post::evaluate(report, runs);
        for entry in &evaluated.entries {
            match &entry.outcome {
                Ok(post::Outcome::Condition {
                    holds: false,
                    advise: false,
                    message,
                }) => said.push(message.clone()),
                Err(error) => said.push(format!("{} is not made: {error}", entry.name)),
                Ok(_) => {}
            }
        }
        let mut push = |path: String, dimension, display: DisplayUnit, value: f64| {
            // a report has each name once, and no channel begins with `report.`
            let _ = table.push(Column {
                path,
                dimension,
                display,
                frame: String::new(),
                values: vec![value],
            });
        };
        let units = &self.program.typed().program;
        for (entry, made) in report.entries.iter().zip(&evaluated.entries) {
            let EntryKind::Value { members, display } = &entry.kind else {
                continue;
            };
            let unit = NamedUnit::new(&display.symbol, units);
            let dimension = unit.map_or(Dimension::ONE, NamedUnit::dimension);
            let numbers = match &made.outcome {
                Ok(post::Outcome::Value(numbers, _)) => numbers.as_slice(),
                _ => &[],
            };
            for place in 0..members.len() {
                let index = match members.len() {
                    1 => String::new(),
                    _ => format!("[{}]", place + 1),
                };
                let path = format!("report.{}.{}{index}", report.name, entry.name);
                let value = numbers.get(place).map_or(f64::NAN, |number| number.value);
                push(path, dimension, display.clone(), value);
            }
        }
        let required = |kind: &EntryKind| matches!(kind, EntryKind::Require { advise: false, .. });
        if report.entries.iter().any(|entry| required(&entry.kind)) {
            let path = format!("report.{}.holds", report.name);
            let holds = f64::from(u8::from(!evaluated.fails()));
            push(path, Dimension::ONE, DisplayUnit::si(Dimension::ONE), holds);
        }
    }

    /// The rows of a point that has ended.
    ///
    /// # Errors
    /// A failure of the system, which is no property of the point.
    pub(super) fn rows(
        &self,
        point: u64,
        analysis: &Analysis,
        ended: Result<RunOutcome, Failed<RunOutcome>>,
    ) -> Result<Vec<PointRow>, StudyError> {
        let row = PointRow {
            point,
            state: COMPLETE.to_owned(),
            code: String::new(),
            message: String::new(),
            place: String::new(),
            warnings: String::new(),
            identity: identity(analysis),
            values: Vec::new(),
        };
        let variable = |path: &str| {
            let own = analysis.point().iter().find(|value| value.name == path);
            own.map(|value| value.value)
        };
        let error = match ended {
            Ok(outcome) => {
                let (numbers, message) = self.numbers(&outcome);
                let row = PointRow {
                    message,
                    warnings: codes(&outcome.diagnostics),
                    ..row
                };
                // a point without modes in the range has a row, too
                let count = numbers.samples().max(1);
                return Ok((0..count)
                    .map(|index| {
                        let value = |path: &str| {
                            let values = &numbers.column(path)?.values;
                            values.get(index).copied().or_else(|| variable(path))
                        };
                        PointRow {
                            values: self.shown(point, value),
                            ..row.clone()
                        }
                    })
                    .collect());
            }
            Err(Failed { error, .. }) => error,
        };
        let Some(report) = error.report() else {
            return Err(StudyError::from(*error));
        };
        let first = report.diagnostics().iter().next();
        Ok(vec![PointRow {
            state: if error.is_stopped() { STOPPED } else { FAILED }.to_owned(),
            code: first.map_or(String::new(), |message| message.code.to_owned()),
            message: first.map_or_else(|| error.to_string(), |message| message.title.clone()),
            place: first.map_or(String::new(), |message| place(message, report.texts())),
            values: self.shown(point, variable),
            ..row
        }])
    }

    /// The bits of a row in display units. The columns of a design have its own numbers.
    fn shown(&self, point: u64, value: impl Fn(&str) -> Option<f64>) -> Vec<u64> {
        let stated = self.stated(point);
        let columns = self.header.columns().iter().enumerate();
        columns
            .map(|(index, column)| {
                let shown = stated.get(index).copied().or_else(|| {
                    let value = value(&column.path)?;
                    Some(column.display.from_si(value))
                });
                match shown {
                    Some(shown) if !shown.is_nan() => shown.to_bits(),
                    _ => f64::NAN.to_bits(),
                }
            })
            .collect()
    }
}

/// Hash of everything that decides the numbers of a point.
pub(super) fn identity(analysis: &Analysis) -> String {
    let mut identity = analysis.fingerprint();
    identity.truncate(DIGITS);
    identity
}

/// The codes of messages, each once.
fn codes(messages: &Diagnostics) -> String {
    let mut codes: Vec<&str> = Vec::new();
    for message in messages.iter() {
        if !codes.contains(&message.code) {
            codes.push(message.code);
        }
    }
    codes.join(" ")
}

/// `engine.eng:12`, the place of a message.
fn place(message: &Diagnostic, texts: &SourceMap) -> String {
    let labels = &message.labels;
    let label = labels.iter().find(|label| label.primary).or(labels.first());
    let found = label.and_then(|label| {
        let (line, _) = texts.line_column(label.span.source, label.span.start)?;
        Some(format!("{}:{line}", texts.get(label.span.source)?.name))
    });
    found.unwrap_or_default()
}
