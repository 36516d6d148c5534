//! The command's behaviour with an engine whose answers are known.

use eng::cli::{
    AssemblyOutcome, CheckOutcome, Console, Engine, EngineError, JournalGeometry, Progress,
    ReductionOutcome, RunOptions, RunOutcome, Setting, run_on,
};
use eng::plot::Upright;
use eng::results::{Column, Results};
use eng_grammar::{Diagnostic, Diagnostics, SourceMap, Span};
use eng_system::{Dimension, DisplayUnit};
use std::f64::consts::PI;
use std::path::{Path, PathBuf};

/// Two analyses of one journal that turns round once in 720°.
#[derive(Default)]
struct Known {
    wrong: bool,
    fails: bool,
    settings: Vec<Setting>,
    options: RunOptions,
    ran: Vec<String>,
}

impl Known {
    fn diagnostics(&self, sources: &mut SourceMap) -> Diagnostics {
        let id = sources.add("known.eng", "model Known {}\n");
        let mut diagnostics = Diagnostics::new();
        if self.wrong {
            diagnostics.push(
                Diagnostic::error("E0001", "the model is empty")
                    .at(Span::new(id, 6, 11), "nothing in it"),
            );
        }
        diagnostics
    }
}

fn column(path: &str, symbol: &str, scale: f64, frame: &str, values: Vec<f64>) -> Column {
    Column {
        path: path.to_owned(),
        dimension: Dimension::ONE,
        display: DisplayUnit {
            symbol: symbol.to_owned(),
            scale,
            offset: 0.0,
        },
        frame: frame.to_owned(),
        values,
    }
}

fn outcome(analysis: &str) -> RunOutcome {
    let turns: Vec<f64> = (0..=1440).map(|i| f64::from(i) * PI / 360.0).collect();
    let mut results = Results::new(analysis, "Known");
    let sine = |size: f64| {
        turns
            .iter()
            .map(|a| size * libm::sin(a / 2.0))
            .collect::<Vec<_>>()
    };
    let cosine = |size: f64| {
        turns
            .iter()
            .map(|a| size * libm::cos(a / 2.0))
            .collect::<Vec<_>>()
    };
    let columns = [
        Column::time(turns.iter().map(|a| a / 400.0).collect()),
        Column::cycle_angle(turns.clone()),
        column("main[1].force.x", "kN", 1e3, "block.main[1]", cosine(-3e3)),
        column("main[1].force.y", "kN", 1e3, "block.main[1]", sine(-2e3)),
        column(
            "main[1].eccentricity.x",
            "um",
            1e-6,
            "block.main[1]",
            cosine(2e-5),
        ),
        column(
            "main[1].eccentricity.y",
            "um",
            1e-6,
            "block.main[1]",
            sine(2e-5),
        ),
        column(
            "main[1].minimum_film",
            "um",
            1e-6,
            "",
            vec![7e-6; turns.len()],
        ),
        column("main[1].power_loss", "W", 1.0, "", vec![150.0; turns.len()]),
        column("vertical[1]", "kN", 1e3, "", cosine(-3e3)),
    ];
    for column in columns {
        results.push(column).unwrap();
    }
    RunOutcome {
        results,
        motion: None,
        journals: vec![JournalGeometry {
            path: "main[1]".to_owned(),
            diameter: 0.054,
            width: 0.02,
            radial_clearance: 27e-6,
        }],
        cycle_period: Some(4.0 * PI),
        upright: Upright::X,
        firing: vec![(Some(1), 0.0)],
        diagnostics: Diagnostics::new(),
        facts: vec!["1440 steps".to_owned()],
        point: Vec::new(),
        periodic: None,
    }
}

impl Engine for Known {
    fn options(&mut self, options: RunOptions) {
        self.options = options;
    }

    fn check(&mut self, model: &Path) -> Result<CheckOutcome, EngineError> {
        if model != Path::new("known.eng") {
            return Err(EngineError::System(format!("{}: none", model.display())));
        }
        let mut sources = SourceMap::new();
        let diagnostics = self.diagnostics(&mut sources);
        Ok(CheckOutcome {
            sources,
            diagnostics,
            analyses: ["fired", "sweep[1]", "sweep[2]"]
                .map(str::to_owned)
                .to_vec(),
        })
    }

    fn reduce(&mut self) -> Result<ReductionOutcome, EngineError> {
        Ok(ReductionOutcome::default())
    }

    fn assemble(&mut self) -> Result<AssemblyOutcome, EngineError> {
        Ok(AssemblyOutcome {
            facts: ["Known: 1 journal", "fired: 5 freedoms"]
                .map(str::to_owned)
                .to_vec(),
            ..AssemblyOutcome::default()
        })
    }

    fn run(
        &mut self,
        analysis: &str,
        settings: &[Setting],
        progress: &mut dyn FnMut(Progress),
    ) -> Result<RunOutcome, EngineError> {
        self.ran.push(analysis.to_owned());
        self.settings = settings.to_vec();
        progress(Progress {
            fraction: 0.5,
            time: 0.01,
            cycle_angle: Some(PI),
            cycles: None,
        });
        if let Some(setting) = settings.iter().find(|s| s.path != "speed") {
            return Err(EngineError::Usage(format!("no parameter {}", setting.path)));
        }
        if self.fails {
            let mut diagnostics = Diagnostics::new();
            diagnostics.push(Diagnostic::error("E0900", "Newton stalls at 412.3 °CA"));
            return Err(EngineError::Model {
                diagnostics,
                partial: Some(Box::new(outcome(analysis))),
            });
        }
        Ok(outcome(analysis))
    }
}

/// Exit code, output, errors.
fn run(engine: &mut Known, arguments: &[&str]) -> (u8, String, String) {
    let (mut output, mut errors) = (Vec::new(), Vec::new());
    let code = run_on(
        std::iter::once("eng")
            .chain(arguments.iter().copied())
            .map(Into::into),
        engine,
        &mut Console {
            output: &mut output,
            errors: &mut errors,
            colored_output: false,
            colored_errors: false,
            live: false,
        },
    );
    let text = |bytes| String::from_utf8(bytes).unwrap();
    (code, text(output), text(errors))
}

fn folder(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("eng-command-{name}-{}", std::process::id()));
    let _ = std::fs::remove_dir_all(&folder);
    folder
}

fn files(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}

#[test]
fn a_run_writes_files_and_prints_a_table() {
    let folder = folder("run");
    let out = folder.to_string_lossy().into_owned();
    let mut engine = Known::default();
    let (code, output, errors) = run(
        &mut engine,
        &[
            "run",
            "known.eng",
            "--analysis",
            "sweep",
            "--set",
            "speed=5000 rpm",
            "--out",
            &out,
            "--csv",
        ],
    );
    assert_eq!((code, errors.as_str()), (0, ""));
    assert_eq!(engine.ran, ["sweep[1]", "sweep[2]"]);
    assert_eq!(engine.settings[0].value, "5000 rpm");
    insta::assert_snapshot!(output.replace(&out, "OUT"));
    assert_eq!(files(&folder).join("\n"), files_of_two_analyses());
    let picture = std::fs::read_to_string(folder.join("sweep[1]-vertical.svg")).unwrap();
    assert!(picture.contains(">TDC 1</text>") && picture.contains("firing dead centre"));
    let read = Results::read_parquet(folder.join("sweep[1].parquet")).unwrap();
    assert_eq!(
        read.column("main[1].force.x").unwrap().frame,
        "block.main[1]"
    );
    std::fs::remove_dir_all(&folder).unwrap();
}

fn files_of_two_analyses() -> String {
    let mut names = Vec::new();
    for analysis in ["sweep[1]", "sweep[2]"] {
        names.extend(["csv", "parquet"].map(|kind| format!("{analysis}.{kind}")));
    }
    for figure in ["journal-force-x", "journal-force-y", "orbits", "vertical"] {
        for analysis in ["sweep[1]", "sweep[2]"] {
            names.extend(["png", "svg"].map(|kind| format!("{analysis}-{figure}.{kind}")));
        }
    }
    for figure in ["journal-force-x", "vertical"] {
        names.extend(["png", "svg"].map(|kind| format!("sweep[1]-sweep[2]-{figure}.{kind}")));
    }
    names.sort();
    names.join("\n")
}

#[test]
fn quiet_and_no_plots() {
    let folder = folder("quiet");
    let out = folder.to_string_lossy().into_owned();
    let arguments = [
        "run",
        "known.eng",
        "--analysis",
        "fired",
        "--out",
        &out,
        "--quiet",
        "--no-plots",
    ];
    let (code, output, errors) = run(&mut Known::default(), &arguments);
    assert_eq!((code, output.as_str(), errors.as_str()), (0, "", ""));
    assert_eq!(files(&folder), ["fired.parquet"]);
    std::fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn a_wrong_model_exits_with_1_and_is_not_run() {
    let mut engine = Known {
        wrong: true,
        ..Known::default()
    };
    let (code, output, errors) = run(&mut engine, &["run", "known.eng"]);
    assert_eq!((code, output.as_str()), (1, ""));
    assert!(
        errors.contains("error[E0001]") && engine.ran.is_empty(),
        "{errors}"
    );
    let (code, output, _) = run(&mut engine, &["check", "known.eng"]);
    assert_eq!(code, 1);
    assert!(output.contains("nothing in it"), "{output}");
    let (code, output, errors) = run(&mut engine, &["check", "known.eng", "--format", "json"]);
    assert_eq!((code, errors.as_str()), (1, ""));
    let document: serde_json::Value = serde_json::from_str(&output).unwrap();
    assert_eq!(document["diagnostics"][0]["column"], 7);
}

#[test]
fn a_failed_run_exits_with_1_and_keeps_what_there_is() {
    let folder = folder("failed");
    let out = folder.to_string_lossy().into_owned();
    let mut engine = Known {
        fails: true,
        ..Known::default()
    };
    let (code, _, errors) = run(&mut engine, &["run", "known.eng", "--out", &out]);
    assert_eq!(code, 1);
    // the others run, too: points of a sweep do not stand or fall together
    assert_eq!(engine.ran, ["fired", "sweep[1]", "sweep[2]"]);
    assert!(
        errors.contains("412.3 °CA") && errors.contains("are kept"),
        "{errors}"
    );
    // under a name of its own, beside what an earlier run left
    assert!(folder.join("fired.failed.parquet").exists());
    assert!(!folder.join("fired.parquet").exists());
    std::fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn unknown_names_and_refused_files_exit_with_2() {
    let mut engine = Known::default();
    let (code, _, errors) = run(&mut engine, &["run", "known.eng", "--analysis", "unfired"]);
    assert_eq!(code, 2);
    assert!(
        errors.contains("no analysis unfired; it has fired, sweep[1], sweep[2]"),
        "{errors}"
    );
    let (code, _, errors) = run(&mut engine, &["run", "known.eng", "--set", "sped=1 rpm"]);
    assert_eq!((code, errors.trim()), (2, "error: no parameter sped"));
    let (code, _, errors) = run(&mut engine, &["run", "other.eng"]);
    assert_eq!((code, errors.trim()), (2, "error: other.eng: none"));
    let folder = folder("file-in-the-way");
    std::fs::write(&folder, "not a folder").unwrap();
    let out = folder.to_string_lossy().into_owned();
    let (code, _, errors) = run(&mut engine, &["run", "known.eng", "--out", &out]);
    assert_eq!(code, 2);
    assert!(errors.contains(&out), "{errors}");
    std::fs::remove_file(&folder).unwrap();
}

#[test]
fn a_clean_check_says_so() {
    let (code, output, errors) = run(&mut Known::default(), &["check", "known.eng"]);
    assert_eq!((code, errors.as_str()), (0, ""));
    assert_eq!(
        output,
        "Known: 1 journal\nfired: 5 freedoms\nno errors, no warnings\n"
    );
}
