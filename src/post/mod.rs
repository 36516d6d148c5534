//! Evaluates the reports of a text over results: numbers, conditions, figures.
//!
//! May contain: arithmetic over recorded channels. Must not contain: the search of names and the check of
//! units (the compiler), the treatment of signals and the drawing of figures (`eng_report`), files.
//!
//! ```
//! let text = "
//!     use std.joints.Revolute
//!     model Pendulum {
//!         gravity = [0, -9.81, 0] m/s^2
//!         marker pivot = [0, 0, 0] mm
//!         body bob { mass = 1 kg; inertia = [1, 1, 1] g*m^2; marker top = [0, 1, 0] m }
//!         joint pin = Revolute(bob.top, pivot)
//!         start pin.angle = 10 deg
//!     }
//!     analysis swing = transient(Pendulum(), duration: 1 s)
//!     report swings { value widest = maximum(abs(swing.pin.angle)) as deg }";
//! let program = eng::check(&eng::Sources::from_text("pendulum.eng", text), "pendulum.eng").into_program()?;
//! let analysis = program.analysis("swing")?;
//! let outcome = analysis.run(&mut |_| {}).map_err(|failed| failed.error)?;
//! let machine = analysis.machine()?;
//! let runs = [eng::post::Run::new(&outcome.results, &machine)];
//! let report = eng::post::evaluate(&program.reports()[0], &runs);
//! let widest = report.values("widest")?[0].value;
//! assert!((widest.to_degrees() - 10.0).abs() < 1e-6);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod evaluate;
mod gradient;
pub(crate) mod natural;
mod operation;
pub(crate) mod picture;
mod sampling;
pub(crate) mod sampling_limits;
mod section;
mod spectra;
mod table;
pub(crate) mod track;

pub(crate) use picture::{ORDERS, capital};
pub(crate) use section::section;
pub use table::text;

use crate::machine::Machine;
use crate::results::{Gradient, Results};
use eng_report::figure::Figure;
use eng_report::signal::SignalError;
use eng_system::DisplayUnit;
use eng_system::place::Location;
use eng_system::report::{EntryKind, MessagePart, Report};
use evaluate::Evaluator;

/// An entry that the results do not give.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PostError {
    /// Analyses without results.
    #[error("there are no results of {}; run it first", .0.join(", "))]
    NotRun(Vec<String>),
    /// A channel that was not kept.
    #[error("the results of {analysis} have no {path}; perhaps `--channels` left it out")]
    NoChannel {
        /// The analysis.
        analysis: String,
        /// The column.
        path: String,
    },
    /// A run without the derivatives by a parameter.
    #[error(
        "the results of {analysis} have no gradients by {parameter}; run it with `gradients: [{parameter}]`"
    )]
    NoGradient {
        /// The analysis.
        analysis: String,
        /// The parameter.
        parameter: String,
    },
    /// A share of a parameter that is zero.
    #[error(
        "{parameter} of {analysis} is zero, so a share of it is no change; draw changes of your own: `gradient(…)` times each"
    )]
    ZeroParameter {
        /// The analysis.
        analysis: String,
        /// The parameter.
        parameter: String,
    },
    /// A function without a known derivative by a parameter.
    #[error("`{function}` has no known derivative {why}")]
    NoDerivative {
        /// Its name.
        function: String,
        /// The circumstance, as the rest of the sentence.
        why: String,
    },
    /// No entry of that name.
    #[error("the report has no value {0}")]
    NoValue(String),
    /// Signals with other samples, by their runs; those of one run by themselves.
    #[error(
        "{first} and {second} have different samples ({detail}); `resample(a, like: b)` gives the signal a at the samples of the signal b"
    )]
    Samples {
        /// The analysis or signal of the left side.
        first: String,
        /// The analysis or signal of the right side.
        second: String,
        /// The difference.
        detail: String,
    },
    /// A frequency outside of a response.
    #[error("{analysis} has no response at {frequency}: it reaches from {range}")]
    OutsideResponse {
        /// The analysis.
        analysis: String,
        /// The frequency.
        frequency: String,
        /// The lowest and the highest frequency of the response.
        range: String,
    },
    /// A response that changes too much between two points.
    #[error(
        "{analysis}: the response changes by more than a fifth between the points beside {frequency}; state more `points` for the analysis"
    )]
    SteepResponse {
        /// The analysis.
        analysis: String,
        /// The frequency.
        frequency: String,
    },
    /// Samples without equal distances.
    #[error(
        "{0}: the samples are evenly spaced neither in time nor in crank angle; run it with a `sample:` at which they are"
    )]
    Uneven(String),
    /// Too few samples for frequencies.
    #[error("{analysis}: frequencies need at least 4 samples, and there are {count}")]
    Few {
        /// The analysis.
        analysis: String,
        /// Number of the samples.
        count: usize,
    },
    /// A shaft at rest, or no shaft.
    #[error("{0}: the cycle does not turn, so that there are no orders")]
    NoSpeed(String),
    /// A frequency that the samples do not resolve.
    #[error(
        "{analysis}: {stated} is too fast for samples {held}; run it with `sample: {needed}` or less"
    )]
    TooFast {
        /// The analysis.
        analysis: String,
        /// The frequency or order.
        stated: String,
        /// Distance of the samples, and the highest frequency that they resolve.
        held: String,
        /// A distance that is small enough.
        needed: String,
    },
    /// A frequency, or the width of a band, with less than a period in the signal.
    #[error("{analysis}: {stated} has no whole period in the signal, which is {length} long")]
    TooSlow {
        /// The analysis.
        analysis: String,
        /// The frequency, order or width.
        stated: String,
        /// Length of the signal.
        length: String,
    },
    /// A speed that changes too much for frequencies to be orders.
    #[error(
        "{analysis}: the speed changes from {speeds}, so samples at equal distances of {lie} give no {asked}; run it with a `sample:` in {needed}"
    )]
    SpeedChanges {
        /// The analysis.
        analysis: String,
        /// Lowest to highest speed.
        speeds: String,
        /// The quantity in which the samples are even.
        lie: &'static str,
        /// The quantity that they do not give.
        asked: &'static str,
        /// The unit of samples that give it.
        needed: &'static str,
    },
    /// Two runs with one speed in a figure over speed.
    #[error(
        "{first} and {second} both turn at {speed}: a picture over the speed cannot separate them"
    )]
    SameSpeed {
        /// An analysis.
        first: String,
        /// Another one.
        second: String,
        /// The speed of both.
        speed: String,
    },
    /// A block that does not fit the samples.
    #[error("{analysis}: a block of {block} is {why}")]
    Block {
        /// The analysis.
        analysis: String,
        /// Length of the block.
        block: String,
        /// The reason.
        why: String,
    },
    /// Samples beyond those of the resampled signal.
    #[error(
        "{analysis} covers only {own}, but the samples of {other} in `like` cover {asked}: take the same part of both, such as by `last` or `last_cycle`"
    )]
    Outside {
        /// The analysis that is resampled.
        analysis: String,
        /// The analysis that gives the wanted samples.
        other: String,
        /// From its first sample to its last.
        own: String,
        /// From the first wanted sample to the last.
        asked: String,
    },
    /// A mode that a linear analysis does not have.
    #[error("{analysis} has no mode {number}: it has {count}")]
    NoMode {
        /// The analysis.
        analysis: String,
        /// The wanted number of a mode, from 1.
        number: u32,
        /// Number of the modes.
        count: usize,
    },
    /// A frequency without a mode nearby.
    #[error("{analysis} has no mode within 10 % of {frequency}: {nearest}")]
    NoModeNear {
        /// The analysis.
        analysis: String,
        /// The wanted value.
        frequency: String,
        /// The nearest values.
        nearest: String,
    },
    /// A part that is longer than the run.
    #[error("{analysis}: the results are shorter than the last {part}")]
    Short {
        /// The analysis.
        analysis: String,
        /// The wanted value.
        part: String,
    },
    /// A journal that the model does not have any more.
    #[error("{analysis} has no journal {path}")]
    NoJournal {
        /// The analysis.
        analysis: String,
        /// The journal.
        path: String,
    },
    /// No motion beside the results.
    #[error("{0}: the results have no motion, which the picture of a film needs; run it again")]
    NoMotion(String),
    /// A journal without cells, or a motion without the numbers of its film.
    #[error("the motion of {analysis} does not have the film of {path}; run it again")]
    NoFilm {
        /// The analysis.
        analysis: String,
        /// The journal.
        path: String,
    },
    /// A moment that the motion does not have.
    #[error(
        "the motion of {analysis} has no moment at {moment}: the results have the last cycle alone"
    )]
    NoMoment {
        /// The analysis.
        analysis: String,
        /// The moment.
        moment: String,
    },
    /// A film that cannot be solved as in the run.
    #[error("the film of {path} in {analysis}: {source}")]
    Film {
        /// The analysis.
        analysis: String,
        /// The journal.
        path: String,
        /// The reason.
        source: eng_system::field::FieldError,
    },
    /// A signal that cannot be evaluated.
    #[error("{analysis}: {source}")]
    Signal {
        /// The analysis.
        analysis: String,
        /// The reason.
        source: SignalError,
    },
    /// A value that is no number.
    #[error("{0} is not a finite number")]
    NotFinite(String),
    /// A tree that no checked text gives.
    #[error("expected a {due}, found a {found}")]
    Shape {
        /// The necessary kind.
        due: &'static str,
        /// The found kind.
        found: &'static str,
    },
}

/// The results of an analysis with the machine behind them.
#[derive(Clone, Copy, Debug)]
pub struct Run<'r> {
    pub(crate) results: &'r Results,
    pub(crate) machine: &'r Machine,
    pub(crate) motion: Option<&'r Results>,
    pub(crate) gradients: &'r [Gradient],
}

impl<'r> Run<'r> {
    /// A run from computed results, or from results of a file.
    pub fn new(results: &'r Results, machine: &'r Machine) -> Run<'r> {
        Run {
            results,
            machine,
            motion: None,
            gradients: &[],
        }
    }

    /// With the motion that the run kept: figures of films need it.
    #[must_use]
    pub fn with_motion(self, motion: Option<&'r Results>) -> Run<'r> {
        Run { motion, ..self }
    }

    /// With the gradients of the run: values by `gradient` need them.
    #[must_use]
    pub fn with_gradients(self, gradients: &'r [Gradient]) -> Run<'r> {
        Run { gradients, ..self }
    }
}

/// A number of a report.
#[derive(Clone, Debug, PartialEq)]
pub struct Number {
    /// Its channel or analysis, if a value has several: `vertical[5]`, `runup[3]`.
    pub name: String,
    /// SI.
    pub value: f64,
}

/// The result of an entry.
#[derive(Clone, Debug, PartialEq)]
pub enum Outcome {
    /// A picture.
    Figure(Box<Figure>),
    /// Numbers with their display unit.
    Value(Vec<Number>, DisplayUnit),
    /// Whether a condition holds.
    Condition {
        /// Whether it holds.
        holds: bool,
        /// The message if it does not hold, with the values.
        message: String,
        /// Whether it is an `advise`, which gives a warning and no failure.
        advise: bool,
    },
}

/// An entry of a report with the numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Evaluated {
    /// `peak`.
    pub name: String,
    /// `Largest force`.
    pub title: String,
    /// `///` lines before it.
    pub text: String,
    /// The text of the entry.
    pub written: String,
    /// Its result, or the reason why there is none.
    pub outcome: Result<Outcome, PostError>,
    /// Whether it is a `require` that the results of its analyses do not decide.
    pub undecided: bool,
    /// Whether it is a figure or a value that the results of its analyses do not give although they were kept.
    pub missing: bool,
    /// Its place in the text.
    pub place: Location,
}

impl Evaluated {
    /// The name of one of its numbers: the title, and the channel or analysis if there are several numbers.
    fn name_of(&self, number: &Number) -> String {
        if number.name.is_empty() {
            self.title.clone()
        } else {
            format!("{}, {}", self.title, number.name)
        }
    }
}

/// A report with the numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct EvaluatedReport {
    /// `bearings`.
    pub name: String,
    /// `Main bearings at 4000 rpm`.
    pub title: String,
    /// `///` lines before it.
    pub text: String,
    /// In the order of the text.
    pub entries: Vec<Evaluated>,
    /// Analyses whose runs ended early, with the reason. Their numbers describe only a part of the run.
    pub partial: Vec<(String, String)>,
}

impl EvaluatedReport {
    /// The numbers of a value.
    ///
    /// # Errors
    /// No value of that name, or one that the results do not give.
    pub fn values(&self, name: &str) -> Result<&[Number], PostError> {
        let entry = self.entries.iter().find(|entry| entry.name == name);
        match entry.map(|entry| &entry.outcome) {
            Some(Ok(Outcome::Value(numbers, _))) => Ok(numbers),
            Some(Err(error)) => Err(error.clone()),
            _ => Err(PostError::NoValue(name.to_owned())),
        }
    }

    /// The figures and values that results of whole runs do not give, with the reasons.
    pub fn faults(&self) -> impl Iterator<Item = (&Evaluated, &PostError)> {
        let missing = move |entry: &&Evaluated| self.partial.is_empty() && entry.missing;
        let entries = self.entries.iter().filter(missing);
        entries.filter_map(|entry| Some((entry, entry.outcome.as_ref().err()?)))
    }

    /// Whether a `require` does not hold, or cannot be decided although its analyses were run.
    pub fn fails(&self) -> bool {
        self.entries.iter().any(|entry| {
            let broken = matches!(
                entry.outcome,
                Ok(Outcome::Condition {
                    holds: false,
                    advise: false,
                    ..
                })
            );
            broken || entry.undecided
        })
    }
}

/// Evaluates a report over results. An entry that lacks data holds its error, and the other entries are
/// evaluated.
pub fn evaluate(report: &Report, runs: &[Run<'_>]) -> EvaluatedReport {
    let mut named: Vec<&str> = Vec::new();
    let entries = report
        .entries
        .iter()
        .map(|entry| {
            let analyses = entry.analyses();
            for name in &analyses {
                if !named.contains(name) {
                    named.push(name);
                }
            }
            let missing: Vec<String> = analyses
                .iter()
                .filter(|name| runs.iter().all(|run| run.results.analysis() != **name))
                .map(ToString::to_string)
                .collect();
            let outcome = if missing.is_empty() {
                outcome(&entry.kind, &entry.title, &Evaluator::new(runs))
            } else {
                Err(PostError::NotRun(missing))
            };
            let required = matches!(entry.kind, EntryKind::Require { advise: false, .. });
            let made = !matches!(outcome, Err(PostError::NotRun(_)));
            let kept = !matches!(
                outcome,
                Err(PostError::NotRun(_) | PostError::NoChannel { .. } | PostError::NoMotion(_))
            );
            let shown = !matches!(entry.kind, EntryKind::Require { .. });
            Evaluated {
                undecided: required && made && outcome.is_err(),
                missing: shown && kept && outcome.is_err(),
                name: entry.name.clone(),
                title: entry.title.clone(),
                text: entry.text.clone(),
                written: entry.written.clone(),
                outcome,
                place: entry.place,
            }
        })
        .collect();
    let partial = runs
        .iter()
        .filter(|run| named.contains(&run.results.analysis()))
        .filter_map(|run| {
            let state = run.results.metadata().get(crate::results::STATE)?;
            let reason = state.strip_prefix("failed: ")?;
            Some((run.results.analysis().to_owned(), reason.to_owned()))
        })
        .collect();
    EvaluatedReport {
        name: report.name.clone(),
        title: report.title.clone(),
        text: report.text.clone(),
        entries,
        partial,
    }
}

/// The derivatives of a report by a parameter with a unit: a report with the values of the first one, each differentiated, and
/// without other entries. The runs must be differentiated by this parameter.
pub fn by_parameter(report: &Report, parameter: &str, unit: &DisplayUnit) -> Report {
    let values = report.entries.iter().filter_map(|entry| {
        let EntryKind::Value { members, display } = &entry.kind else {
            return None;
        };
        let mut entry = entry.clone();
        let derivatives = members.iter().map(|member| member.derivative(parameter));
        entry.kind = EntryKind::Value {
            members: derivatives.collect(),
            display: display.over(unit),
        };
        Some(entry)
    });
    Report {
        entries: values.collect(),
        ..report.clone()
    }
}

/// Draws a figure of results.
///
/// # Errors
/// Results that do not give it.
pub fn draw(
    figure: &eng_system::figure::Figure,
    title: &str,
    runs: &[Run<'_>],
) -> Result<Figure, PostError> {
    picture::figure(figure, title, &Evaluator::new(runs))
}

fn outcome(kind: &EntryKind, title: &str, evaluator: &Evaluator<'_>) -> Result<Outcome, PostError> {
    match kind {
        EntryKind::Figure(figure) => {
            let drawn = picture::figure(figure, title, evaluator)?;
            Ok(Outcome::Figure(Box::new(drawn)))
        }
        EntryKind::Value { members, display } => {
            let names = track::names(members);
            let numbers = members
                .iter()
                .zip(names)
                .map(|(member, name)| {
                    let value = evaluator.number(&member.expression)?;
                    if !value.is_finite() {
                        let of = if name.is_empty() { title } else { &name };
                        return Err(PostError::NotFinite(of.to_owned()));
                    }
                    Ok(Number { name, value })
                })
                .collect::<Result<Vec<_>, PostError>>()?;
            Ok(Outcome::Value(numbers, display.clone()))
        }
        EntryKind::Require {
            members,
            message,
            advise,
        } => {
            let mut failing = None;
            for (place, member) in members.iter().enumerate() {
                if !evaluator.truth(member)? {
                    failing.get_or_insert(place);
                }
            }
            let holds = failing.is_none();
            // the message shows the first member of a list that does not hold
            let place = failing.unwrap_or(0);
            let mut shown = String::new();
            for part in message {
                match part {
                    MessagePart::Text(text) => shown.push_str(text),
                    MessagePart::Value(values, display) => {
                        if let Some(value) = values.get(place).or(values.first()) {
                            shown.push_str(&display.text(evaluator.number(value)?));
                        }
                    }
                }
            }
            Ok(Outcome::Condition {
                holds,
                message: shown,
                advise: *advise,
            })
        }
    }
}
