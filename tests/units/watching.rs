//! `eng watch` with changes by a script, and the changes of files that it waits for.

use eng::Results;
use eng::cli::Console;
use eng::internals::cli::{
    Changes, Files, Looks, MOST_WAITS, Stamp, at_rest, run_with, time_of_day,
};
use std::path::{Path, PathBuf};
use std::time::{Duration, UNIX_EPOCH};

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
        assert_eq!(run_with(&words, &mut script, &mut console), 0);
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
        let inside = |path: &PathBuf| path.starts_with(&folder) || path.starts_with(self.folder);
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

#[test]
fn a_round_waits_until_files_are_at_rest() {
    let mut seen = [1, 2, 3, 3, 4].into_iter();
    at_rest(|| seen.next());
    assert_eq!(seen.next(), Some(4));
    // a file that never rests
    let mut looks = 0..;
    at_rest(|| looks.next());
    assert_eq!(looks.next(), Some(MOST_WAITS + 1));
}

#[test]
fn files_that_come_change_and_go_are_seen() {
    let path = std::env::temp_dir().join(format!("eng-looks-{}", std::process::id()));
    let _ = std::fs::remove_file(&path);
    let mut looks = Looks::default();
    let seen = || Files::from([(path.clone(), Stamp::of(&path))]);
    looks.watch(seen());
    assert!(!looks.came());
    for text in ["one", "two or three"] {
        std::fs::write(&path, text).expect("a file");
        assert!(looks.wait(), "{text}");
        looks.watch(seen());
        assert!(!looks.differ(), "{text}");
    }
    std::fs::remove_file(&path).expect("a file");
    assert!(looks.wait());
}
