//! `eng watch`.

mod changes;
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
use changes::{Changes, Files, Looks};
use earlier::Earlier;
use eng_grammar::SourceMap;
use std::collections::BTreeMap;
use std::time::{Instant, SystemTime, UNIX_EPOCH};

/// The most analyses that the line of a round names in a list. A choice: the line fits on a wide terminal.
const MOST_NAMES: usize = 6;

pub(super) fn watch(arguments: &WatchArguments, console: &mut Terminal<'_>) -> Result<(), Stop> {
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
    rounds(arguments, &mut Looks::default(), console)
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
fn time_of_day(now: SystemTime) -> String {
    let seconds = now
        .duration_since(UNIX_EPOCH)
        .map_or(0, |since| since.as_secs() % 86_400);
    let (hours, minutes) = (seconds / 3600, seconds / 60 % 60);
    format!("{hours:02}:{minutes:02}:{:02} UTC", seconds % 60)
}

#[cfg(test)]
mod tests {
    use super::super::Console;
    use super::super::arguments::{Arguments, Command};
    use super::*;
    use crate::Results;
    use clap::Parser;
    use std::path::{Path, PathBuf};
    use std::time::Duration;

    /// A pendulum with a part and a table in files of their own.
    const MODEL: &str = "
use parts.reach
use std.joints.Revolute
model Swing {
    param load: Mass = 1 kg
    gravity = [0, -9.81, 0] m/s^2
    marker pivot = [0, 0, 0] mm
    table push(t: Time) -> Force = csv(\"push.csv\", columns: [\"t [s]\", \"f [N]\"], extrapolation: hold)
    body bob { mass = load; inertia = [2, 2, 2] g*m^2; marker top = [0, 1, 0]*reach }
    joint pin = Revolute(bob.top, pivot)
    start pin.angle = 30 deg
    output height = dot(bob.origin.origin, ground.y) as mm
    output pushed = push(time) as N
}
analysis one = transient(Swing(), duration: 20 ms, sample: 10 ms)
analysis two = transient(Swing(load: 2 kg), duration: 30 ms, sample: 10 ms)
report ends { value lowest \"Lowest\" = minimum(one.height) as mm }
";
    const PARTS: &str = "const reach: Length = 400 mm\n";
    const PUSH: &str = "t [s],f [N]\n0,1\n1,2\n2,3\n";

    /// A folder of its own with the model, removed afterwards.
    struct Folder(PathBuf);

    impl Folder {
        fn new(name: &str) -> Folder {
            let name = format!("eng-watch-{name}-{}", std::process::id());
            let folder = Folder(std::env::temp_dir().join(name));
            let _ = std::fs::remove_dir_all(&folder.0);
            std::fs::create_dir_all(&folder.0).expect("a folder");
            folder.write("swing.eng", MODEL);
            folder.write("parts.eng", PARTS);
            folder.write("push.csv", PUSH);
            folder
        }

        fn write(&self, name: &str, text: &str) {
            std::fs::write(self.0.join(name), text).expect("a file");
        }

        /// Writes the model with another text in place of a part of it.
        fn change(&self, old: &str, new: &str) {
            let text = MODEL.replace(old, new);
            assert_ne!(text, MODEL, "{new}");
            self.write("swing.eng", &text);
        }

        fn remove(&self, name: &str) {
            std::fs::remove_file(self.0.join(name)).expect("a file");
        }

        fn samples(&self, analysis: &str) -> usize {
            let path = self.0.join(format!("out/{analysis}.parquet"));
            Results::read_parquet(&path).expect("results").samples()
        }

        /// Names of the files of results that are not whole.
        fn unfinished(&self) -> Vec<String> {
            let entries = std::fs::read_dir(self.0.join("out")).expect("a folder");
            let names = entries.map(|e| e.expect("an entry").file_name());
            names
                .map(|name| name.to_string_lossy().into_owned())
                .filter(|name| !name.ends_with(".parquet"))
                .collect()
        }

        /// Watches the model while the steps happen one after the other. Returns the output.
        fn watch(&self, more: &[&str], steps: Vec<Step<'_>>) -> String {
            let model = self.0.join("swing.eng");
            let mut words: Vec<&str> = vec!["eng", "watch", model.to_str().expect("a path")];
            let out = self.0.join("out");
            if !more.contains(&"--check") {
                words.extend(["--no-plots", "--out", out.to_str().expect("a path")]);
            }
            words.extend(more);
            let arguments = Arguments::try_parse_from(words).expect("right words");
            let Command::Watch(arguments) = arguments.command else {
                panic!("another command");
            };
            let (mut output, mut errors) = (Vec::new(), Vec::new());
            let mut console = Console {
                output: &mut output,
                errors: &mut errors,
                colored_output: false,
                colored_errors: false,
                live: false,
            };
            let mut script = Script {
                folder: &self.0,
                steps: steps.into_iter().collect(),
                files: Files::new(),
            };
            let ended = rounds(&arguments, &mut script, &mut Terminal::new(&mut console));
            assert!(ended.is_ok());
            output.extend(errors);
            String::from_utf8(output).expect("a text")
        }
    }

    impl Drop for Folder {
        fn drop(&mut self) {
            let _ = std::fs::remove_dir_all(&self.0);
        }
    }

    /// A step of a script.
    enum Step<'s> {
        /// While the command waits.
        Waits(Box<dyn FnOnce() + 's>),
        /// At the first question of a run.
        Runs(Box<dyn FnOnce() + 's>),
    }

    fn waits<'s>(step: impl FnOnce() + 's) -> Step<'s> {
        Step::Waits(Box::new(step))
    }

    /// Changes by a script. A step that changes none of the watched files fails the test.
    struct Script<'s> {
        folder: &'s Path,
        steps: std::collections::VecDeque<Step<'s>>,
        files: Files,
    }

    impl Script<'_> {
        fn differ(&self) -> bool {
            let mut files = self.files.iter();
            files.any(|(path, stamp)| Stamp::of(path) != *stamp)
        }
    }

    impl Changes for Script<'_> {
        fn watch(&mut self, files: Files) {
            let folder = self.folder.canonicalize().expect("a folder");
            let inside =
                |path: &PathBuf| path.starts_with(&folder) || path.starts_with(self.folder);
            assert!(files.keys().all(inside), "{files:?}");
            self.files = files;
        }

        fn came(&mut self) -> bool {
            let due = matches!(self.steps.front(), Some(Step::Runs(_)));
            if due && let Some(Step::Runs(step)) = self.steps.pop_front() {
                step();
            }
            self.differ()
        }

        fn wait(&mut self) -> bool {
            // a change during the round
            if self.differ() {
                return true;
            }
            match self.steps.pop_front() {
                Some(Step::Waits(step)) => {
                    step();
                    assert!(self.differ(), "nothing that is watched has changed");
                    true
                }
                Some(Step::Runs(_)) => panic!("no run was asked"),
                None => false,
            }
        }
    }

    /// The ends of the lines of rounds, after their times.
    fn lines(said: &str) -> Vec<&str> {
        said.lines()
            .filter(|line| line.contains(" UTC, round "))
            .filter_map(|line| line.split_once(" s: "))
            .map(|(_, end)| end)
            .collect()
    }

    #[test]
    fn a_change_runs_what_it_touches() {
        let folder = Folder::new("touches");
        let said = folder.watch(
            &[],
            vec![
                waits(|| folder.change("\nuse parts", "\n// a comment\nuse parts")),
                waits(|| folder.change("20 ms", "40 ms")),
                waits(|| folder.change("20 ms", "40 mm")),
                waits(|| folder.change("20 ms", "40 ms ")),
                waits(|| folder.change("\"Lowest\"", "\"The lowest\"")),
                waits(|| folder.write("parts.eng", "const reach: Length = 300 mm\n")),
                waits(|| folder.write("push.csv", "t [s],f [N]\n0,1\n1,22\n2,3\n")),
                waits(|| std::fs::write(folder.0.join("swing.eng"), "").expect("a file")),
                waits(|| folder.write("swing.eng", MODEL)),
            ],
        );
        let due = [
            "ran one, two; watching 3 files",
            "kept one, two; watching 3 files",
            "ran one; kept two; watching 3 files",
            "not done: see the messages above",
            "kept one, two; watching 3 files",
            // the text has 20 ms again
            "ran one; kept two; watching 3 files",
            "ran one, two; watching 3 files",
            "ran one, two; watching 3 files",
            "not done: see the messages above",
            "kept one, two; watching 3 files",
        ];
        assert_eq!(lines(&said), due, "{said}");
        // the words of the report are shown if they, or numbers in it, are new
        let shown = |words: &str| {
            let lines = said.lines().map(str::trim_start);
            lines.filter(|line| line.starts_with(words)).count()
        };
        assert_eq!((shown("Lowest"), shown("The lowest")), (3, 3), "{said}");
        assert!(said.contains("duration: 40 mm"), "{said}");
        assert_eq!((folder.samples("one"), folder.samples("two")), (3, 4));
        assert_eq!(folder.unfinished(), [""; 0]);
    }

    #[test]
    fn a_change_during_a_run_stops_it() {
        let folder = Folder::new("stops");
        folder.change("30 ms", "1e4 s");
        let said = folder.watch(
            &["--threads", "1", "--analysis", "two", "--patient"],
            vec![
                Step::Runs(Box::new(|| folder.change("30 ms", "30 mm"))),
                waits(|| {
                    assert_eq!(folder.unfinished(), [""; 0]);
                    assert!(!folder.0.join("out/two.parquet").exists());
                    folder.change("30 ms", "50 ms");
                }),
            ],
        );
        let due = [
            "stopped by a change: two; watching 3 files",
            "not done: see the messages above",
            "ran two; watching 3 files",
        ];
        assert_eq!(lines(&said), due, "{said}");
        assert_eq!(folder.samples("two"), 6);
    }

    #[test]
    fn files_that_go_and_come_are_watched() {
        let folder = Folder::new("comes");
        folder.remove("push.csv");
        let said = folder.watch(
            &["--quiet"],
            vec![
                waits(|| folder.write("push.csv", PUSH)),
                waits(|| folder.remove("swing.eng")),
                waits(|| folder.write("swing.eng", MODEL)),
                waits(|| folder.remove("parts.eng")),
                waits(|| {
                    folder.remove("out/one.parquet");
                    folder.write("parts.eng", PARTS);
                }),
            ],
        );
        let missing = "not done: see the messages above";
        let due = [
            missing,
            "ran one, two; watching 3 files",
            missing,
            "kept one, two; watching 3 files",
            missing,
            "ran one; kept two; watching 3 files",
        ];
        assert_eq!(lines(&said), due, "{said}");
        assert!(!said.contains("wrote"), "{said}");
    }

    #[test]
    fn an_analysis_that_fails_is_run_again() {
        let folder = Folder::new("fails");
        folder.change(
            "joint pin = Revolute(bob.top, pivot)",
            "param limit: AngularVelocity = 100 rpm
    joint pin = Revolute(bob.top, pivot) { require abs(speed) < limit else \"too fast\" }",
        );
        let text = std::fs::read_to_string(folder.0.join("swing.eng")).expect("a text");
        let text = text.replace("load: 2 kg", "limit: 0.5 rpm");
        folder.write("swing.eng", &text);
        let said = folder.watch(
            &["--quiet"],
            vec![waits(|| folder.write("swing.eng", &format!("\n{text}")))],
        );
        let due = [
            "ran one; failed: two; watching 3 files",
            "kept one; failed: two; watching 3 files",
        ];
        assert_eq!(lines(&said), due, "{said}");
        assert_eq!(said.matches("two failed").count(), 2, "{said}");
    }

    #[test]
    fn a_check_runs_nothing() {
        let folder = Folder::new("check");
        let said = folder.watch(
            &["--check"],
            vec![
                waits(|| folder.change("1 kg", "1 kgg")),
                waits(|| folder.write("swing.eng", MODEL)),
            ],
        );
        let due = [
            "checked; watching 3 files",
            "not done: see the messages above",
            "checked; watching 3 files",
        ];
        assert_eq!(lines(&said), due, "{said}");
        assert!(said.contains("kgg"), "{said}");
        assert!(!folder.0.join("out").exists());
    }

    #[test]
    fn the_time_of_day_is_utc() {
        let moment = UNIX_EPOCH + Duration::from_secs(86_400 * 20_000 + 3 * 3600 + 25 * 60 + 45);
        assert_eq!(time_of_day(moment), "03:25:45 UTC");
    }
}
