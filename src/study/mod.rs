//! Studies: many points of one analysis in a folder of parts, which any number of processes fill.
//!
//! The points come from a sweep of the text or from a table ([`Design`]). A process computes a slice of them and writes
//! one part. The numbers of a point depend on the point alone, so the collected table has the same bytes for all slicings.
//!
//! ```text
//! out/runup/study.json                    the study: its identity and the number of its points
//! out/runup/part-00001-00064.parquet      a part, whole or absent
//! out/runup/part-00065-00128.points       the points so far of a part that is computed
//! out/runup.points.parquet                all points
//! ```

mod dataset;
pub(crate) mod design;
mod journal;
mod numbers;
pub(crate) mod plan;
mod run;

pub use dataset::{Collected, Dataset, Failure, Standing, Worker};
pub(crate) use dataset::{in_words, points_in_words};
pub use design::{Design, DesignError};
pub use plan::{Scheduler, Script};
pub use run::{OnEvent, PartOutcome, SliceOptions};

use crate::analysis::Analysis;
use crate::error::Error;
use crate::model::{Parameter, hexadecimal};
use crate::program::{Bodies, Program};
use crate::quantity::{NamedUnit, QuantityError};
use crate::results::{Results, ResultsError};
use eng_system::DisplayUnit;
use eng_system::system::PointValue;
use serde::{Deserialize, Serialize};
use sha2::Digest;
use std::path::PathBuf;

/// A study that cannot be made, run or collected.
#[derive(Debug, thiserror::Error)]
pub enum StudyError {
    /// A failure of the model or of the system.
    #[error(transparent)]
    Model(#[from] Error),
    /// A table that is no design.
    #[error(transparent)]
    Design(#[from] DesignError),
    /// A column of a design that the model refuses.
    #[error("{}: the column {column}: {message}", design.display())]
    Column {
        /// The design.
        design: PathBuf,
        /// The name of the column.
        column: String,
        /// The reason.
        message: String,
    },
    /// An analysis without points, or with too many sources of them.
    #[error("{0}")]
    Points(String),
    /// Parts of another study.
    #[error("{}: {message}", path.display())]
    Other {
        /// The folder or file.
        path: PathBuf,
        /// The difference and the remedy.
        message: String,
    },
    /// Points without a part.
    #[error(
        "{missing} of {points} points are missing: {ranges}; run them, or take those that are there by --partial"
    )]
    Missing {
        /// Number of the missing points.
        missing: usize,
        /// All points.
        points: usize,
        /// The missing ones in words.
        ranges: String,
    },
}

impl From<ResultsError> for StudyError {
    fn from(error: ResultsError) -> StudyError {
        StudyError::Model(error.into())
    }
}

/// What all parts of a study have in common.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Manifest {
    pub analysis: String,
    pub model: String,
    pub file: String,
    pub version: String,
    pub source_hash: String,
    /// The file of the design.
    pub design: Option<String>,
    pub points: u64,
    /// Hash of everything that decides the numbers of the points.
    pub identity: String,
}

/// The source of the points.
#[derive(Debug)]
enum Points {
    /// Analyses of the text with an index, by their names.
    Sweep(Vec<String>),
    /// Rows of a table.
    Table {
        base: Box<Analysis>,
        design: Design,
        columns: Vec<(Parameter, PointValue, NamedUnit)>,
    },
}

/// A study of a program.
#[derive(Debug)]
pub struct Study {
    program: Program,
    points: Points,
    manifest: Manifest,
    /// The columns of its numbers without values, with its metadata.
    header: Results,
}

/// Gives an analysis the settings of the study: parameters, steps.
pub type Prepare<'p, E> = &'p dyn Fn(Analysis) -> Result<Analysis, E>;

impl Study {
    /// The study of an analysis: of its index, or of a design. It reduces flexible bodies.
    ///
    /// # Errors
    /// An analysis without points; columns of the design that are no parameters of its model; those of `prepare`.
    pub fn new<E: From<StudyError>>(
        program: &Program,
        name: &str,
        design: Option<Design>,
        prepare: Prepare<'_, E>,
    ) -> Result<Study, E> {
        let (points, first) = points(program, name, design, Bodies::Reduced, prepare)?;
        let mut study = Study {
            program: program.clone(),
            manifest: Manifest {
                analysis: name.to_owned(),
                model: first.model().name().to_owned(),
                file: program.file().to_owned(),
                version: env!("CARGO_PKG_VERSION").to_owned(),
                source_hash: program.source_hash(),
                design: points.design_name(),
                points: points.len() as u64,
                identity: points.identity(program, &first),
            },
            points,
            header: Results::new(name, first.model().name()),
        };
        let models = study.models(prepare)?;
        study.header = study.columns_of_points(&models)?;
        Ok(study)
    }

    /// The number of points of a study. Flexible bodies are not reduced, which may take long.
    ///
    /// # Errors
    /// Those of [`Study::new`].
    pub fn count<E: From<StudyError>>(
        program: &Program,
        name: &str,
        design: Option<Design>,
        prepare: Prepare<'_, E>,
    ) -> Result<usize, E> {
        let (points, _) = points(program, name, design, Bodies::Rigid, prepare)?;
        Ok(points.len())
    }

    /// Name of the analysis.
    pub fn analysis(&self) -> &str {
        &self.manifest.analysis
    }

    /// Number of points.
    pub fn points(&self) -> usize {
        self.manifest.points as usize
    }

    /// The analyses of the points `from..=to`, counted from 1.
    fn analyses<E: From<StudyError>>(
        &self,
        from: usize,
        to: usize,
        prepare: Prepare<'_, E>,
    ) -> Result<Vec<Analysis>, E> {
        match &self.points {
            Points::Sweep(names) => {
                let names = names.get(from.saturating_sub(1)..to).unwrap_or_default();
                let names: Vec<&str> = names.iter().map(String::as_str).collect();
                let made = self.program.analyses_of(&names).into_iter();
                made.map(|analysis| prepare(analysis.map_err(StudyError::from)?))
                    .collect()
            }
            Points::Table {
                base,
                design,
                columns,
            } => Ok((from..=to)
                .map(|point| {
                    let rows = columns.iter().zip(&design.columns);
                    let values = rows.map(|((parameter, value, unit), column)| {
                        let stated = column.values.get(point.saturating_sub(1)).copied();
                        let value = PointValue {
                            value: unit.of(stated.unwrap_or(f64::NAN)).value(),
                            ..value.clone()
                        };
                        (*parameter, value)
                    });
                    base.at_point(values.collect())
                })
                .collect()),
        }
    }

    /// The numbers of a design's row, as its file states them; none for a sweep.
    fn stated(&self, point: u64) -> Vec<f64> {
        let columns = match &self.points {
            Points::Sweep(_) => [].as_slice(),
            Points::Table { design, .. } => design.columns.as_slice(),
        };
        let row = point.saturating_sub(1) as usize;
        let values = columns.iter().map(|column| column.values.get(row).copied());
        values.flatten().collect()
    }
}

impl Points {
    fn len(&self) -> usize {
        match self {
            Points::Sweep(names) => names.len(),
            Points::Table { design, .. } => design.points(),
        }
    }

    fn design_name(&self) -> Option<String> {
        match self {
            Points::Sweep(_) => None,
            Points::Table { design, .. } => {
                let name = design.path.file_name().unwrap_or_default();
                Some(name.to_string_lossy().into_owned())
            }
        }
    }

    /// Hash of everything that decides the numbers of all points.
    fn identity(&self, program: &Program, first: &Analysis) -> String {
        let mut hash = sha2::Sha256::new();
        hash.update(first.fingerprint());
        for (mesh, contents) in program.meshes() {
            hash.update(format!("{mesh} {contents}\n"));
        }
        match self {
            Points::Sweep(names) => {
                for plan in names.iter().filter_map(|name| program.plan(name).ok()) {
                    hash.update(format!("{plan:?}"));
                }
            }
            Points::Table { design, .. } => {
                for column in &design.columns {
                    hash.update(format!("{} [{}]\n", column.path, column.unit));
                    for value in &column.values {
                        hash.update(value.to_le_bytes());
                    }
                }
            }
        }
        hexadecimal(&hash.finalize())
    }
}

/// The points of a study and an analysis of its model, with these bodies.
fn points<E: From<StudyError>>(
    program: &Program,
    name: &str,
    design: Option<Design>,
    bodies: Bodies,
    prepare: Prepare<'_, E>,
) -> Result<(Points, Analysis), E> {
    let analysis = |name: &str| {
        let made = program.analyses_with(&[name], bodies).pop();
        let made = made.unwrap_or_else(|| program.analysis(name));
        prepare(made.map_err(StudyError::from)?)
    };
    let Some(design) = design else {
        let names = sweep(program, name)?;
        let first = analysis(names.first().map_or("", String::as_str))?;
        return Ok((Points::Sweep(names), first));
    };
    if program.plan(name).is_err() && sweep(program, name).is_ok() {
        return Err(E::from(StudyError::Points(format!(
            "{name} has points of its own: a design needs an analysis without an index"
        ))));
    }
    let base = analysis(name)?;
    let columns = columns(program, &base, &design)?;
    let points = Points::Table {
        base: Box::new(base.clone()),
        design,
        columns,
    };
    Ok((points, base))
}

/// Names of the points of a sweep.
fn sweep(program: &Program, name: &str) -> Result<Vec<String>, StudyError> {
    let known = program.analyses();
    let own = known.iter().filter(|known| {
        let (base, index) = known.split_once('[').unwrap_or((known, ""));
        base == name && !index.is_empty()
    });
    let names: Vec<String> = own.map(ToString::to_string).collect();
    if !names.is_empty() {
        return Ok(names);
    }
    // an analysis that does not exist has a message of its own
    program.plan(name)?;
    Err(StudyError::Points(format!(
        "{name} is one analysis without points: give it an index in the text, or a table of points by --design"
    )))
}

/// The parameters of a design's columns, with their units.
fn columns(
    program: &Program,
    base: &Analysis,
    design: &Design,
) -> Result<Vec<(Parameter, PointValue, NamedUnit)>, StudyError> {
    let columns = design.columns.iter().map(|column| {
        let refused = |message: String| StudyError::Column {
            design: design.path.clone(),
            column: column.path.clone(),
            message,
        };
        if base.chooses(&column.path) {
            return Err(refused(
                "this is a choice of words, which decides the structure; state it in the text or by --set".to_owned(),
            ));
        }
        let parameter = base.parameter(&column.path);
        let parameter = parameter.map_err(|error| refused(error.to_string()))?;
        let info = base.model().describe(parameter)?;
        let unit = NamedUnit::new(&column.unit, &program.typed().program);
        let unit = unit.map_err(|error: QuantityError| refused(error.to_string()))?;
        let shown = &info.display.symbol;
        for value in &column.values {
            let checked = base.model().checked(parameter, unit.of(*value));
            checked.map_err(|error| match (&error, column.unit.is_empty()) {
                (Error::Dimension { .. }, true) => refused(format!(
                    "it states no unit; write the unit into its name: {} [{shown}]",
                    column.path
                )),
                (Error::Dimension { .. }, false) => refused(format!(
                    "{} does not fit; write a unit such as {} [{shown}]",
                    column.unit, column.path
                )),
                _ => refused(error.to_string()),
            })?;
        }
        if base.sets(&column.path) {
            return Err(refused(
                "--set gives it one value for all points; leave one of both out".to_owned(),
            ));
        }
        let value = PointValue {
            name: column.path.clone(),
            value: f64::NAN,
            dimension: info.dimension,
            display: match column.unit.is_empty() {
                true => DisplayUnit::si(info.dimension),
                false => unit.display(&column.unit),
            },
        };
        Ok((parameter, value, unit))
    });
    columns.collect()
}
