//! Mistakes of engineers, one at a time in correct models: how many of them a message reports before a run, and how
//! near to the mistake.
//!
//! Each file of `tests/mistakes` has the model, the expected code (`A or B` if both are right, `none` if the mistake is
//! known to pass), the mistake in words, and the lines before and after. A mistake counts as reported if the check of
//! the changed model raises the expected code, which the correct model does not raise. It counts as near if a label of
//! that message in the model's own text is within three lines of the change. A missing item has no line of its own:
//! then the line of the item that lacks it counts, too (`lacking:`).

use crate::support::Temporary;
use eng::Sources;
use eng_grammar::{Diagnostic, SourceMap};
use std::path::{Path, PathBuf};
use std::sync::Mutex;

/// The mistakes, those that are reported before a run, and those reported near their place. `docs/validation.md`
/// states these figures.
const FIGURES: [usize; 3] = [338, 331, 308];
/// Lines that count as near.
const LINES: usize = 3;

struct Mistake {
    name: String,
    base: String,
    code: String,
    /// For a missing item: the line of the item that lacks it.
    lacking: Option<String>,
    before: String,
    after: String,
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn mistakes() -> Vec<Mistake> {
    let folder = root().join("tests/mistakes");
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder)
        .expect("a folder")
        .map(|entry| entry.expect("an entry").path())
        .filter(|path| path.extension().is_some_and(|e| e == "mistake"))
        .collect();
    files.sort();
    files.iter().map(|file| mistake(file)).collect()
}

fn mistake(file: &Path) -> Mistake {
    let name = file
        .file_stem()
        .expect("a name")
        .to_string_lossy()
        .into_owned();
    let text = std::fs::read_to_string(file).expect("a file");
    let (head, change) = text.split_once("---- before\n").expect("the lines before");
    let (before, after) = change.split_once("---- after\n").expect("the lines after");
    let stated = |key: &str| {
        let line = head.lines().find_map(|line| line.strip_prefix(key));
        line.unwrap_or_else(|| panic!("{name}: {key}"))
            .trim()
            .to_owned()
    };
    Mistake {
        base: stated("in:"),
        code: stated("expected:"),
        lacking: head
            .lines()
            .find_map(|line| line.strip_prefix("lacking:"))
            .map(|text| text.trim().to_owned()),
        before: before.to_owned(),
        after: after.to_owned(),
        name,
    }
}

impl Mistake {
    /// The changed text, and the line (from 1) of the first change.
    fn seeded(&self, right: &str) -> (String, usize) {
        let found: Vec<usize> = right
            .match_indices(&self.before)
            .map(|(at, _)| at)
            .collect();
        assert_eq!(
            found.len(),
            1,
            "{}: the lines before stand once in {}",
            self.name,
            self.base
        );
        let at = found[0];
        let same = (self.before.lines().zip(self.after.lines()))
            .take_while(|(a, b)| a == b)
            .count();
        let line = right[..at].matches('\n').count() + 1 + same;
        (right.replacen(&self.before, &self.after, 1), line)
    }
}

/// All messages of `eng check` about a file.
fn said(file: &Path) -> (Vec<Diagnostic>, SourceMap) {
    let sources = Sources::folder(file.parent().expect("a folder")).expect("a folder");
    let name = file.file_name().expect("a name").to_string_lossy();
    let checked = eng::check(&sources, &name);
    let report = checked.report();
    let mut all: Vec<Diagnostic> = report.diagnostics().iter().cloned().collect();
    if let Some(program) = checked.program() {
        let assembled = program.assemble().expect("a checked model");
        all.extend(assembled.diagnostics.iter().cloned());
    }
    (all, report.texts().clone())
}

/// Lines of a message's labels in the model's own text.
fn lines(diagnostic: &Diagnostic, sources: &SourceMap, file: &str) -> Vec<usize> {
    let own = |label: &&eng_grammar::Label| {
        sources
            .get(label.span.source)
            .is_some_and(|source| source.name == file)
    };
    let line = |label: &eng_grammar::Label| {
        sources
            .line_column(label.span.source, label.span.start)
            .map(|(line, _)| line)
    };
    diagnostic
        .labels
        .iter()
        .filter(own)
        .filter_map(line)
        .collect()
}

/// A folder with a model and its files, removed afterwards.
struct Bench(Temporary);

impl Bench {
    fn new(base: &str) -> Bench {
        let name = base.replace(['/', '.'], "_");
        let folder = Temporary::new(&format!("mistakes-{name}"));
        let beside = root().join(base);
        for entry in std::fs::read_dir(beside.parent().expect("a folder")).expect("a folder") {
            let path = entry.expect("an entry").path();
            if path.is_file() && path.extension().is_some_and(|e| e != "eng") {
                std::fs::copy(&path, folder.join(path.file_name().expect("a name")))
                    .expect("a copy");
            }
        }
        Bench(folder)
    }
}

enum Outcome {
    Near,
    Far(Vec<usize>),
    Silent(Vec<String>),
}

fn outcome(mistake: &Mistake, right: &str, bench: &Bench) -> (Outcome, usize) {
    let (text, line) = mistake.seeded(right);
    let name = format!("{}.eng", mistake.name);
    let file = bench.0.join(&name);
    let mut places = vec![line];
    if let Some(lacking) = &mistake.lacking {
        let at = text.lines().position(|line| line.contains(lacking));
        places.push(1 + at.unwrap_or_else(|| panic!("{}: {lacking}", mistake.name)));
    }
    std::fs::write(&file, text).expect("a file");
    let (all, sources) = said(&file);
    let wanted = |d: &&Diagnostic| mistake.code.split(" or ").any(|code| code == d.code);
    let expected: Vec<&Diagnostic> = all.iter().filter(wanted).collect();
    if expected.is_empty() {
        let codes = all
            .iter()
            .map(|d| format!("{}: {}", d.code, d.title))
            .collect();
        return (Outcome::Silent(codes), line);
    }
    let at: Vec<usize> = expected
        .iter()
        .flat_map(|d| lines(d, &sources, &name))
        .collect();
    let near = |l: &usize| places.iter().any(|place| l.abs_diff(*place) <= LINES);
    let near = at.iter().any(near);
    (
        if near {
            Outcome::Near
        } else {
            Outcome::Far(at)
        },
        line,
    )
}

#[test]
fn mistakes_are_told_before_a_run_and_at_their_place() {
    let mistakes = mistakes();
    assert!(mistakes.len() >= 100, "{}", mistakes.len());
    let mut bases: Vec<String> = mistakes.iter().map(|m| m.base.clone()).collect();
    bases.sort();
    bases.dedup();
    let benches: Vec<(String, String, Bench)> = bases
        .into_iter()
        .map(|base| {
            let text = std::fs::read_to_string(root().join(&base)).expect("a model");
            let bench = Bench::new(&base);
            (base, text, bench)
        })
        .collect();
    let found: Mutex<Vec<(usize, Outcome, usize)>> = Mutex::new(Vec::new());
    let next = std::sync::atomic::AtomicUsize::new(0);
    std::thread::scope(|scope| {
        for _ in 0..std::thread::available_parallelism().map_or(1, usize::from) {
            scope.spawn(|| {
                while let Some((index, mistake)) = {
                    let index = next.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
                    mistakes.get(index).map(|m| (index, m))
                } {
                    let bench = benches.iter().find(|(base, ..)| *base == mistake.base);
                    let (_, right, bench) = bench.expect("its model");
                    let (outcome, line) = outcome(mistake, right, bench);
                    found.lock().expect("no panic").push((index, outcome, line));
                }
            });
        }
    });
    let mut found = found.into_inner().expect("no panic");
    found.sort_by_key(|(index, ..)| *index);
    let (mut told, mut near) = (0, 0);
    let mut wrong = Vec::new();
    for (index, outcome, line) in &found {
        let mistake = &mistakes[*index];
        match outcome {
            Outcome::Near => {
                told += 1;
                near += 1;
            }
            Outcome::Far(at) => {
                told += 1;
                println!("{} (line {line}): told at lines {at:?}", mistake.name);
            }
            Outcome::Silent(codes) => {
                println!(
                    "{} (line {line}): not told by {}: {codes:?}",
                    mistake.name, mistake.code
                );
                if mistake.code != "none" {
                    wrong.push(&mistake.name);
                }
            }
        }
    }
    let share = |part: usize| part as f64 / mistakes.len() as f64;
    println!(
        "{} mistakes: {told} told before a run ({:.1} %), {near} within {LINES} lines ({:.1} %)",
        mistakes.len(),
        100.0 * share(told),
        100.0 * share(near)
    );
    assert!(
        wrong.is_empty(),
        "not told by the code that is expected: {wrong:?}"
    );
    assert_eq!([mistakes.len(), told, near], FIGURES);
    let page = std::fs::read_to_string(root().join("docs/validation.md")).expect("a page");
    let stated = format!("{told} of {}; {near}", mistakes.len());
    assert!(page.contains(&stated), "docs/validation.md: {stated}");
}

/// Correct models raise no message: the models of the mistakes, machines of many kinds, the examples except the
/// paper's, and the benchmarks.
#[test]
fn right_models_are_quiet() {
    for folder in [
        "tests/mistakes/bases",
        "tests/good",
        "tests/benchmarks",
        "tests/mesh",
        "examples/inline4",
        "examples/slider_crank",
        "examples/swing",
        "examples/concept",
        "examples/v6",
        "examples/v6_split",
        "examples/compressor",
        "examples/torsion_six",
        "examples/start_up",
        "examples/piston_slap",
        "examples/driveline",
        "examples/valvetrain",
        "examples/v_twin",
        "examples/boxer_twin",
        "examples/single_balanced",
        "examples/mounts",
        "examples/balancer",
        "examples/big_end",
        "examples/squeezer",
        "examples/thrust",
        "examples/timing",
    ] {
        let mut files: Vec<PathBuf> = std::fs::read_dir(root().join(folder))
            .expect("a folder")
            .map(|entry| entry.expect("an entry").path())
            .filter(|path| path.extension().is_some_and(|e| e == "eng"))
            .collect();
        files.sort();
        for file in files {
            // their load is written by the test that runs them
            let loaded = ["loaded_bearing.eng", "given_load.eng"];
            if loaded.iter().any(|name| file.ends_with(name)) {
                continue;
            }
            let (all, _) = said(&file);
            let titles: Vec<&String> = all.iter().map(|d| &d.title).collect();
            assert!(titles.is_empty(), "{}: {titles:?}", file.display());
        }
    }
}

/// The paper compares mode sets that leave loads out, and its engine raises no other message.
#[test]
fn the_papers_engine_warns_of_its_mode_sets_alone() {
    let (all, _) = said(&root().join("examples/paper/paper.eng"));
    let titles: Vec<&str> = all.iter().map(|d| d.title.as_str()).collect();
    assert_eq!(titles, ["some loads of block have no static mode"; 3]);
}
