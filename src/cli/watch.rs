//! `eng watch`.

pub(crate) mod changes;
mod earlier;

use super::Stop;
use super::arguments::{CheckArguments, Format, WatchArguments};
use super::check;
use super::files::{folder_of, or_stop};
use super::open::{open, without_errors};
use super::outcomes::Outcomes;
use super::run::{Due, conclude, due, recording, run_all, set_once, steps};
use super::terminal::Terminal;
use crate::counted::counted;
use crate::motion::SUFFIX;
use crate::program::Checked;
use crate::results::discard;
use crate::sources::Stamp;
use changes::{Changes, Files};
use earlier::Earlier;
use eng_grammar::SourceMap;
use std::collections::BTreeMap;
use std::time::{Instant, SystemTime, UNIX_EPOCH};

/// The most analyses that the line of a round names in a list. A choice: the line fits on a wide terminal.
const MOST_NAMES: usize = 6;

pub(super) fn watch(
    arguments: &WatchArguments,
    changes: &mut dyn Changes,
    console: &mut Terminal<'_>,
) -> Result<(), Stop> {
    let run = &arguments.run;
    // mistakes of the command line end the command, those of a text do not
    or_stop(set_once(&run.settings.set), console)?;
    or_stop(steps(&run.settings), console)?;
    or_stop(recording(run, &folder_of(run), run.resume), console)?;
    if !run.model.is_file()
        && let Err(refusal) = open(&run.model)
    {
        return Err(refusal.show(&SourceMap::new(), console));
    }
    rounds(arguments, changes, console)
}

/// Checks and runs at the beginning and after each change, as long as changes come.
fn rounds(
    arguments: &WatchArguments,
    changes: &mut dyn Changes,
    console: &mut Terminal<'_>,
) -> Result<(), Stop> {
    let mut watching = Watching {
        arguments,
        earlier: Earlier::default(),
        has_run: false,
    };
    for number in 1.. {
        let began = Instant::now();
        let ended = match watching.round(changes, console) {
            Ok(ended) => ended,
            Err(Stop::Code(_)) => "not done: see the messages above".to_owned(),
            Err(unwritten @ Stop::Output(_)) => return Err(unwritten),
        };
        let seconds = began.elapsed().as_secs_f64();
        writeln!(
            console.output,
            "{}, round {number}, {seconds:.2} s: {ended}",
            time_of_day(SystemTime::now())
        )?;
        // without a reader, nobody waits for a further round
        if console.output.is_closed() || !changes.wait() {
            break;
        }
    }
    Ok(())
}

struct Watching<'a> {
    arguments: &'a WatchArguments,
    earlier: Earlier,
    /// Whether a round has begun to run. Later ones continue no run of another text.
    has_run: bool,
}

impl Watching<'_> {
    /// Checks the model, and runs the analyses that are due. Returns the words for the end of the round's line.
    fn round(
        &mut self,
        changes: &mut dyn Changes,
        console: &mut Terminal<'_>,
    ) -> Result<String, Stop> {
        let arguments = self.arguments;
        let model = &arguments.run.model;
        // its stamp before it is read; without a model there is nothing else to watch
        let own = Files::from([(model.clone(), Stamp::of(model))]);
        let checked = match open(model) {
            Ok(checked) => checked,
            Err(refusal) => {
                changes.watch(own);
                return Err(refusal.show(&SourceMap::new(), console));
            }
        };
        let files = |checked: &Checked| {
            let mut files = own.clone();
            files.extend(checked.asked());
            files
        };
        changes.watch(files(&checked));
        let ended = match arguments.check {
            true => self.check(&checked, console),
            false => self.run(&checked, changes, console),
        };
        // assemblies and reductions read further files
        changes.watch(files(&checked));
        let found = checked.asked().into_values().flatten().count();
        let watched = counted(found, "file", "files");
        Ok(format!("{}; watching {watched}", ended?))
    }

    fn check(&self, checked: &Checked, console: &mut Terminal<'_>) -> Result<String, Stop> {
        let arguments = CheckArguments {
            model: self.arguments.run.model.clone(),
            positions: false,
            timings: false,
            format: Format::Human,
        };
        check::tell(checked, &arguments, console)?;
        Ok("checked".to_owned())
    }

    fn run(
        &mut self,
        checked: &Checked,
        changes: &mut dyn Changes,
        console: &mut Terminal<'_>,
    ) -> Result<String, Stop> {
        let arguments = &self.arguments.run;
        let program = without_errors(checked, console)?;
        let folder = folder_of(arguments);
        let resume = arguments.resume && !self.has_run;
        let all = due(arguments, program, &folder, resume, console)?;
        self.has_run = true;
        let mut outcomes = Outcomes::new(arguments, program, &folder);
        outcomes.made = self.earlier.made();
        let names: Vec<&str> = all.iter().map(|(name, _)| *name).collect();
        let fingerprints = fingerprints(&all);
        let (mut kept, mut touched) = (Vec::new(), Vec::new());
        for (name, analysis) in all {
            let own = fingerprints.get(name);
            match own.is_some_and(|own| self.earlier.hand_over(name, own, &mut outcomes)) {
                true => kept.push(name),
                false => touched.push((name, analysis)),
            }
        }
        let begun: Vec<&str> = touched.iter().map(|(name, _)| *name).collect();
        let ran = run_all(touched, &mut outcomes, &mut || changes.came(), console);
        let place = |name: &str| names.iter().position(|other| *other == name);
        let completed = &mut outcomes.completed;
        completed.sort_by_key(|outcome| place(outcome.results.analysis()));
        let concluded = match ran {
            Ok(false) => conclude(&outcomes, begun.len(), console).map(Some),
            Ok(true) => Ok(None),
            Err(stop) => Err(stop),
        };
        let ended = Ended::new(kept, &begun, &outcomes);
        let whole = matches!(concluded, Ok(Some(_)));
        self.earlier.keep(outcomes, whole, &fingerprints);
        let holds = concluded?;
        if holds.is_none() {
            for name in &ended.stopped {
                // their samples are those of another text
                or_stop(discard(&folder, name), console)?;
                or_stop(discard(&folder, &format!("{name}{SUFFIX}")), console)?;
            }
        }
        Ok(ended.text(holds))
    }
}

/// The fingerprints of the analyses that can be run.
fn fingerprints(due: &[Due<'_>]) -> BTreeMap<String, String> {
    due.iter()
        .filter_map(|(name, analysis)| {
            let analysis = analysis.as_ref().ok()?;
            Some(((*name).to_owned(), analysis.fingerprint_without_texts()))
        })
        .collect()
}

/// The analyses of a round by their ends.
struct Ended<'n> {
    ran: Vec<&'n str>,
    /// Those whose numbers the change cannot touch.
    kept: Vec<&'n str>,
    failed: Vec<&'n str>,
    /// Those that have not ended, because a file changed.
    stopped: Vec<&'n str>,
}

impl<'n> Ended<'n> {
    fn new(kept: Vec<&'n str>, begun: &[&'n str], outcomes: &Outcomes<'_>) -> Ended<'n> {
        let mut ended = Ended {
            ran: Vec::new(),
            kept,
            failed: Vec::new(),
            stopped: Vec::new(),
        };
        for &name in begun {
            let mut completed = outcomes.completed.iter();
            let list = if completed.any(|outcome| outcome.results.analysis() == name) {
                &mut ended.ran
            } else if outcomes.failures.iter().any(|failed| failed == name) {
                &mut ended.failed
            } else {
                &mut ended.stopped
            };
            list.push(name);
        }
        ended
    }

    /// `ran fired, cold; kept unfired`. `holds` states whether the reports hold; it is `None` after a change during the round.
    fn text(&self, holds: Option<bool>) -> String {
        let lists = [
            ("ran", &self.ran),
            ("kept", &self.kept),
            ("failed:", &self.failed),
            ("stopped by a change:", &self.stopped),
        ];
        let lists = lists.into_iter().filter(|(_, names)| !names.is_empty());
        let mut parts: Vec<String> = lists
            .map(|(head, names)| {
                let shown: Vec<&str> = names.iter().take(MOST_NAMES).copied().collect();
                let more = match names.len().saturating_sub(MOST_NAMES) {
                    0 => String::new(),
                    more => format!(" and {more} more"),
                };
                format!("{head} {}{more}", shown.join(", "))
            })
            .collect();
        if holds == Some(false) {
            parts.push("a report fails".to_owned());
        }
        parts.join("; ")
    }
}

/// `10:31:07 UTC`. The standard library knows no other time of day.
pub fn time_of_day(now: SystemTime) -> String {
    let seconds = now
        .duration_since(UNIX_EPOCH)
        .map_or(0, |since| since.as_secs() % 86_400);
    let (hours, minutes) = (seconds / 3600, seconds / 60 % 60);
    format!("{hours:02}:{minutes:02}:{:02} UTC", seconds % 60)
}
