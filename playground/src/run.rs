//! Runs of the analyses of a text: messages, reports, figures, tables and the columns of the results.

use crate::check::Found;
use crate::request::{Request, refusal};
use eng::post::{self, EvaluatedReport};
use eng::render::{Document, document};
use eng::report::{Entry, make};
use eng::run::{Event, RunOutcome, run_while};
use eng::{Failed, Program, Progress, figures_of, outcome_text, sweep_texts};
use eng_grammar::Diagnostics;
use serde::Serialize;
use std::ops::ControlFlow;

/// The answer to a run. `messages` are those of the check and of the runs.
#[derive(Debug, Serialize)]
struct Answer<'a> {
    messages: Document<'a>,
    /// The reason why the playground stopped the run, with the share of the run that the results have.
    stopped: Option<&'a str>,
    analyses: Vec<Analysis>,
    /// The tables over the points of sweeps, as `eng run` prints them.
    sweeps: Vec<String>,
    /// Analyses without results, with the reason if it is not among the messages.
    missing: Vec<Missing>,
    reports: Vec<Report>,
}

/// An analysis with results.
#[derive(Debug, Serialize)]
struct Analysis {
    name: String,
    /// The reason of a run that ended early; its results are those up to there.
    failure: Option<String>,
    /// Facts and tables as `eng run` prints them.
    text: String,
    /// The figures that `eng run` draws without a `report`.
    figures: Vec<Figure>,
    columns: Vec<Column>,
}

/// A column of results. Its numbers are `count` of the numbers of the answer, from `first` on, in the unit.
#[derive(Debug, Serialize)]
struct Column {
    path: String,
    unit: String,
    first: usize,
    count: usize,
}

#[derive(Debug, Serialize)]
struct Missing {
    name: String,
    reason: Option<String>,
}

/// A drawing, or the reason why there is none.
#[derive(Debug, Serialize)]
struct Figure {
    title: String,
    svg: Option<String>,
    missing: Option<String>,
}

impl Figure {
    fn new(title: String, drawn: Result<String, String>) -> Figure {
        let (svg, missing) = match drawn {
            Ok(svg) => (Some(svg), None),
            Err(reason) => (None, Some(reason)),
        };
        Figure {
            title,
            svg,
            missing,
        }
    }
}

/// A report of the text.
#[derive(Debug, Serialize)]
struct Report {
    name: String,
    title: String,
    text: String,
    entries: Vec<ReportEntry>,
}

#[derive(Debug, Serialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
enum ReportEntry {
    Value {
        title: String,
        text: String,
        numbers: Vec<Number>,
    },
    Figure {
        #[serde(flatten)]
        figure: Figure,
        text: String,
    },
    Condition {
        title: String,
        holds: bool,
        advises: bool,
        message: String,
    },
    Missing {
        title: String,
        reason: String,
    },
}

/// A number as the command prints it.
#[derive(Debug, Serialize)]
struct Number {
    /// Its channel or analysis, if there are several.
    name: String,
    shown: String,
}

/// Runs with their answer.
#[derive(Debug)]
pub struct Ran {
    /// The answer, as JSON.
    pub text: String,
    /// The numbers of all columns.
    pub numbers: Vec<f64>,
    /// For a page: the program, its file and the outcomes.
    source: Option<(Program, String, Vec<RunOutcome>)>,
}

impl Ran {
    fn refused(text: String) -> Ran {
        Ran {
            text,
            numbers: Vec::new(),
            source: None,
        }
    }

    /// The page of `eng report` about these runs, as HTML; or the reason why there is none, as text.
    pub fn page(&self) -> Result<String, String> {
        let Some((program, file, outcomes)) = &self.source else {
            return Err("nothing has run".to_owned());
        };
        let results: Vec<_> = outcomes.iter().map(|outcome| &outcome.results).collect();
        let described = program.describe(&results);
        let described = described.map_err(|error| error.to_string())?;
        let (mut entries, mut modes) = (Vec::new(), Vec::new());
        for (outcome, described) in outcomes.iter().zip(described) {
            let (results, motion) = (outcome.results.clone(), outcome.motion.clone());
            let in_time = !results.are_modes() && !results.are_responses();
            let mut entry = Entry::new(results, motion, described, Vec::new());
            entry.outcome.gradients.clone_from(&outcome.gradients);
            match in_time {
                true => entries.push(entry),
                false => modes.push(entry),
            }
        }
        if entries.is_empty() {
            return Err("a page needs an analysis of a motion".to_owned());
        }
        let made = make(eng::report::Request {
            file,
            entries: &entries,
            modes: &modes,
            reports: program.reports(),
            command: "the playground",
            ..eng::report::Request::default()
        });
        made.map(|made| made.html)
            .map_err(|error| error.to_string())
    }
}

/// Checks the text of a request and runs its analyses. `goes_on` is called after each step with the progress of the
/// present analysis; false ends the runs, with the results up to there.
pub fn run(request: &Request, goes_on: &mut dyn FnMut(Progress) -> bool) -> Ran {
    let found = match Found::new(request) {
        Ok(found) => found,
        Err(refused) => return Ran::refused(refused),
    };
    let mut runs = Runs {
        messages: found.messages.clone(),
        goes_on,
        over: None,
        outcomes: Vec::new(),
        missing: Vec::new(),
    };
    let program = found.program();
    if let Some(program) = program {
        let names = program.analyses();
        if names.is_empty() {
            return Ran::refused(refusal(
                "the text has no analysis to run; write one: analysis run = transient(…)",
            ));
        }
        runs.all(program, &names);
    }
    let Runs {
        messages,
        over,
        outcomes,
        missing,
        ..
    } = runs;
    let mut numbers = Vec::new();
    let report = found.report();
    let answer = Answer {
        messages: document(&messages, report.texts()),
        stopped: over.as_deref(),
        analyses: outcomes
            .iter()
            .map(|outcome| analysis(outcome, &mut numbers))
            .collect(),
        sweeps: sweep_texts(&outcomes),
        missing,
        reports: program.map_or_else(Vec::new, |program| reports(program, &outcomes)),
    };
    match serde_json::to_string(&answer) {
        Ok(text) => Ran {
            text,
            numbers,
            source: program.map(|program| (program.clone(), request.name.clone(), outcomes)),
        },
        Err(error) => Ran::refused(refusal(&error.to_string())),
    }
}

/// Runs in progress.
struct Runs<'h> {
    messages: Diagnostics,
    goes_on: &'h mut dyn FnMut(Progress) -> bool,
    /// Why the page ended the runs.
    over: Option<String>,
    outcomes: Vec<RunOutcome>,
    missing: Vec<Missing>,
}

impl Runs<'_> {
    fn all(&mut self, program: &Program, names: &[&str]) {
        for (name, analysis) in names.iter().zip(program.analyses_of(names)) {
            if self.over.is_some() {
                self.miss(name, Some("not begun".to_owned()));
                continue;
            }
            let ran = match analysis {
                Ok(analysis) => run_while(&analysis, true, &mut |event| match event {
                    Event::Progress(progress) if !self.stepped(progress) => ControlFlow::Break(()),
                    _ => ControlFlow::Continue(()),
                }),
                Err(error) => Err(Failed::from(error)),
            };
            match ran {
                Ok(outcome) => self.keep(outcome),
                Err(failed) => self.failed(name, failed),
            }
        }
    }

    /// Notes progress of the present analysis. Returns whether it goes on.
    fn stepped(&mut self, progress: Progress) -> bool {
        let goes_on = (self.goes_on)(progress);
        if !goes_on {
            let percent = 100.0 * progress.fraction;
            self.over = Some(format!(
                "stopped at {percent:.1} % of the run, at the end of the playground's time: allow more time, shorten the run, or use the command `eng`, which is several times faster"
            ));
        }
        goes_on
    }

    fn failed(&mut self, name: &str, failed: Failed<RunOutcome>) {
        let Failed { error, partial } = failed;
        // the answer has the reason of the playground
        let stopped = error.is_stopped();
        let report = error.report().filter(|_| !stopped);
        if let Some(report) = report {
            self.tell(report.diagnostics());
        }
        let first = report.and_then(|report| report.diagnostics().iter().next());
        let reason = match (first, stopped) {
            (Some(message), _) => message.title.clone(),
            (None, true) => "stopped by the playground".to_owned(),
            (None, false) => error.to_string(),
        };
        match partial {
            Some(mut outcome) => {
                if stopped || outcome.results.failure().is_none() {
                    outcome.results.set_failure(&reason);
                }
                self.keep(*outcome);
            }
            None => self.miss(name, Some(reason).filter(|_| report.is_none())),
        }
    }

    fn keep(&mut self, outcome: RunOutcome) {
        self.tell(&outcome.diagnostics);
        self.outcomes.push(outcome);
    }

    fn miss(&mut self, name: &str, reason: Option<String>) {
        let name = name.to_owned();
        self.missing.push(Missing { name, reason });
    }

    /// Adds messages, each once: analyses of one model often have the same.
    fn tell(&mut self, messages: &Diagnostics) {
        for message in messages.iter() {
            if !self.messages.iter().any(|known| known == message) {
                self.messages.push(message.clone());
            }
        }
    }
}

fn analysis(outcome: &RunOutcome, numbers: &mut Vec<f64>) -> Analysis {
    let columns = outcome.results.columns().iter().map(|column| {
        let first = numbers.len();
        numbers.extend(column.shown());
        Column {
            path: column.path.clone(),
            unit: column.display.symbol.clone(),
            first,
            count: column.values.len(),
        }
    });
    Analysis {
        columns: columns.collect(),
        name: outcome.results.analysis().to_owned(),
        failure: outcome.results.failure().map(ToOwned::to_owned),
        text: outcome_text(outcome),
        figures: figures_of(outcome)
            .into_iter()
            .map(|(title, drawn)| {
                let drawn = drawn.map(|figure| figure.to_svg());
                Figure::new(title, drawn.map_err(|error| error.to_string()))
            })
            .collect(),
    }
}

/// The reports about these runs. A report of other analyses alone has no numbers.
fn reports(program: &Program, outcomes: &[RunOutcome]) -> Vec<Report> {
    let runs: Vec<post::Run<'_>> = outcomes
        .iter()
        .map(|outcome| {
            let run = post::Run::new(&outcome.results, &outcome.machine);
            run.with_motion(outcome.motion.as_ref())
                .with_gradients(&outcome.gradients)
        })
        .collect();
    let reports = program.reports().iter();
    reports
        .map(|report| in_words(post::evaluate(report, &runs)))
        .collect()
}

fn in_words(report: EvaluatedReport) -> Report {
    let entries = report.entries.into_iter().map(|entry| {
        let (title, text) = (entry.title, entry.text);
        match entry.outcome {
            Ok(post::Outcome::Value(numbers, display)) => ReportEntry::Value {
                numbers: numbers
                    .into_iter()
                    .map(|number| Number {
                        shown: display.text(number.value),
                        name: number.name,
                    })
                    .collect(),
                title,
                text,
            },
            Ok(post::Outcome::Figure(figure)) => ReportEntry::Figure {
                figure: Figure::new(title, Ok(figure.to_svg())),
                text,
            },
            Ok(post::Outcome::Condition {
                holds,
                message,
                advise,
            }) => ReportEntry::Condition {
                title,
                holds,
                advises: advise,
                message,
            },
            Err(error) => ReportEntry::Missing {
                title,
                reason: error.to_string(),
            },
        }
    });
    Report {
        entries: entries.collect(),
        name: report.name,
        title: report.title,
        text: report.text,
    }
}
