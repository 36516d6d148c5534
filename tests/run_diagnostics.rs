//! Mistakes that appear only when a model is assembled or runs: a folder of such models, their
//! messages as snapshots, and every code at least once.

use eng::codes::{self, RUNNING};
use eng::render::{Colors, human};
use eng::{Error, Failed, Progress, Sources, Verdict};
use eng_grammar::{Diagnostics, SourceMap};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// The messages of each analysis of a file.
fn messages(path: &Path) -> (SourceMap, Vec<(String, Diagnostics)>) {
    let sources = Sources::folder(path.parent().expect("a folder")).expect("a folder");
    let file = path.file_name().expect("a name").to_string_lossy();
    let program = eng::check(&sources, &file)
        .into_program()
        .unwrap_or_else(|report| panic!("{report}: the check finds it"));
    let mut found = Vec::new();
    let assembled = program.assemble().expect("what assembling finds");
    let told = assembled.diagnostics.iter();
    let mut locks = Diagnostics::new();
    told.filter(|d| [codes::NO_TURN, codes::BENDING_START].contains(&d.code))
        .for_each(|d| locks.push(d.clone()));
    if !locks.is_empty() {
        found.push(("check".to_owned(), locks));
    }
    for name in program.analyses() {
        let mut diagnostics = Diagnostics::new();
        let analysis = program.analysis(name).expect("an analysis");
        match eng::run::run(&analysis, false, &mut |_| {}) {
            Ok(outcome) => diagnostics.extend(outcome.diagnostics),
            Err(Failed { error, partial }) => {
                if let Some(partial) = partial {
                    diagnostics.extend(partial.diagnostics);
                }
                let report = error.report();
                let report = report.unwrap_or_else(|| panic!("{}: {error}", path.display()));
                diagnostics.extend(report.diagnostics().clone());
            }
        }
        found.push((name.to_owned(), diagnostics));
    }
    // the check alone reports items that no run needs
    let assembled = assembled.diagnostics;
    let mut needless = Diagnostics::new();
    for diagnostic in assembled.iter() {
        if diagnostic.code == codes::ACCEPT_UNUSED {
            needless.push(diagnostic.clone());
        }
    }
    if !needless.is_empty() {
        found.push(("check".to_owned(), needless));
    }
    (program.texts().as_ref().clone(), found)
}

fn fixtures() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/diagnostics/run");
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder)
        .expect("a folder")
        .map(|entry| entry.expect("an entry").path())
        .filter(|path| path.extension().is_some_and(|e| e == "eng"))
        .collect();
    files.sort();
    files
}

#[test]
fn models_that_fail_raise_every_code_of_a_run() {
    let mut settings = insta::Settings::clone_current();
    // line numbers of the library change; the text of the lines is shown
    settings.add_filter(r"(std/\w+\.eng):\d+:\d+", "$1");
    // last digits are the integrator's business
    settings.add_filter(r"(t = \d+\.\d{2})\d+(e-?\d+)? s", "$1…$2 s");
    settings.add_filter(r"point: \S+ (ms|s) past", "point: … $1 past");
    settings.add_filter(r"falls below \S+ s", "falls below … s");
    settings.add_filter(
        r"changes by \S+ % (of its peak-to-peak value from)",
        "changes by … % $1",
    );
    settings.add_filter(r"`tolerance: \S+` brings", "`tolerance: …` brings");
    settings.add_filter(r"(projected on the constraints): \S+ mm", "$1: … mm");
    settings.add_filter(r"(fails by \d)\.\d+e", "$1…e");
    settings.add_filter(r"(?m)^ *(\d+ )?(│|┌|·|=)", "  $2");
    let mut raised: BTreeSet<&str> = BTreeSet::new();
    for path in fixtures() {
        let (sources, found) = messages(&path);
        let texts: Vec<String> = found
            .iter()
            .map(|(analysis, diagnostics)| {
                format!("{analysis}\n{}", human(diagnostics, &sources, Colors::None))
            })
            .collect();
        let name = path.file_stem().expect("a name").to_string_lossy();
        settings.bind(|| insta::assert_snapshot!(name.as_ref(), texts.join("\n")));
        let codes: BTreeSet<&str> = found
            .iter()
            .flat_map(|(_, diagnostics)| diagnostics.iter().map(|d| d.code))
            .collect();
        let text = std::fs::read_to_string(&path).expect("a fixture");
        let named = text.strip_prefix("// ").and_then(|t| t.split(':').next());
        for named in named.expect("a first line").split(", ") {
            assert!(
                codes.contains(named),
                "{}: {named} is not raised but {codes:?}",
                path.display()
            );
        }
        raised.extend(codes);
    }
    raised.extend(from_programs());
    let known: BTreeSet<&str> = RUNNING.iter().map(|code| code.code).collect();
    assert_eq!(raised, known);
}

const SWING: &str = "
    use std.joints.Revolute
    model Swing {
        gravity = [0, -9.81, 0] m/s^2
        marker wall = [0, 0, 0] mm
        body bob { mass = 1 kg; inertia = [1, 1, 1] g*m^2; marker top = [0, 1, 0] m }
        joint pin = Revolute(bob.top, wall)
    }";

/// Codes of errors that no text can cause, but a program that embeds a model can.
fn from_programs() -> Vec<&'static str> {
    let program = eng::check(&Sources::from_text("swing.eng", SWING), "swing.eng")
        .into_program()
        .expect("a sound model");
    let model = program.model("Swing").expect("a model");
    let code = |error: Error| match error {
        Error::Run { report, .. } | Error::Report(report) => {
            report.diagnostics().iter().next().map(|d| d.code)
        }
        other => panic!("{other}"),
    };
    let options = model
        .simulation()
        .rho_infinity(1.0)
        .start()
        .expect_err("damps nothing");
    let checkpoint = model
        .simulation()
        .resume(b"no checkpoint")
        .expect_err("not a checkpoint");
    let text = format!("{SWING}\n    analysis run = transient(Swing(), duration: 1 s)");
    let program = eng::check(&Sources::from_text("swing.eng", text), "swing.eng")
        .into_program()
        .expect("a sound model");
    let analysis = program.analysis("run").expect("an analysis");
    let stopped = analysis.run_watched(&mut |now: Progress| match now.steps {
        5.. => Verdict::Stop,
        _ => Verdict::GoOn,
    });
    let stopped = stopped.expect_err("stopped");
    // without a folder, the computed samples are in the outcome
    assert_eq!(stopped.partial.map(|made| made.results.samples()), Some(1));
    let [only] = model.parameters().try_into().expect("one parameter");
    let input = model.input(&only.path).expect_err("a parameter");
    [options, checkpoint, *stopped.error, input]
        .into_iter()
        .filter_map(code)
        .collect()
}

#[test]
fn codes_that_only_programs_can_raise() {
    assert_eq!(
        from_programs(),
        [
            codes::OPTIONS,
            codes::CHECKPOINT,
            codes::STOPPED,
            codes::INPUT
        ]
    );
}

/// No argument of a program causes a panic.
#[test]
fn a_handle_of_another_model_is_refused() {
    let text = format!(
        "{SWING}
        model Other {{
            param first: Length = 1 m
            param second: Length = 2 m
            output sum = first + second
        }}"
    );
    let program = eng::check(&Sources::from_text("two.eng", text), "two.eng")
        .into_program()
        .expect("sound models");
    let (swing, other) = (program.model("Swing"), program.model("Other"));
    let (swing, other) = (swing.expect("a model"), other.expect("a model"));
    let second = other.parameter("second").expect("a parameter");
    let length = "3 m".parse().expect("a quantity");
    assert_eq!(swing.parameters().len(), 1);
    let refused = swing.simulation().set(second, length);
    assert!(matches!(refused, Err(Error::OtherModel)));
    assert!(other.simulation().set(second, length).is_ok());
}
