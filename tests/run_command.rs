//! The command on models of its own folder: files of failed runs, settings, folders, messages.

use crate::support::Temporary;
use eng::results::Results;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

struct Folder(Temporary);

impl Folder {
    fn new(name: &str, model: &str) -> Folder {
        let folder = Temporary::new(&format!("run-{name}"));
        std::fs::write(folder.join("model.eng"), model).unwrap();
        Folder(folder)
    }

    fn eng(&self, arguments: &[&str]) -> Output {
        Command::new(env!("CARGO_BIN_EXE_eng"))
            .current_dir(&self.0)
            .args(arguments)
            .output()
            .unwrap()
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    /// The files of results, without the name of their text.
    fn files(&self) -> Vec<String> {
        let mut names: Vec<String> = std::fs::read_dir(self.path("results/model"))
            .unwrap()
            .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
            .filter(|name| name != ".text")
            .collect();
        names.sort();
        names
    }
}

fn errors(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn text(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// A slider whose thrust is a table of 50 ms; with a longer run it is left.
const PUSHED: &str = "
use std.joints.Translational
use std.forces.Actuator
table push(t: Time) -> Force = points([0, 50] ms, [0, 1] N)
model Pushed {
    param load: Mass = 1 kg
    param end: 1 = 1
    gravity = [0, -9.81, 0] m/s^2
    marker rail = [0, 0, 0] mm
    body slider { mass = load; inertia = [1, 1, 1] g*m^2 }
    joint guide = Translational(slider.origin, rail)
    force motor = Actuator(slider.origin, rail, thrust: scaled)
    fn scaled(t: Time) -> Force = push(t*end)
    output speed = guide.speed
}
analysis go = transient(Pushed(), duration: 40 ms, sample: 1 ms)
";

#[test]
fn a_failed_run_leaves_the_results_of_an_earlier_one() {
    let folder = Folder::new("failed", PUSHED);
    let output = folder.eng(&["run", "model.eng", "--csv", "--no-plots"]);
    assert!(output.status.success(), "{}", errors(&output));
    let good = ["go.csv", "go.motion.parquet", "go.parquet"];
    assert_eq!(folder.files(), good);
    let before = std::fs::read(folder.path("results/model/go.parquet")).unwrap();

    // the table is left after 25 ms
    let output = folder.eng(&["run", "model.eng", "--csv", "--set", "end=2"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(
        errors(&output).contains("E0713")
            && errors(&output)
                .contains("go failed; the results up to the failure are kept as go.failed"),
        "{}",
        errors(&output)
    );
    let after = std::fs::read(folder.path("results/model/go.parquet")).unwrap();
    assert!(before == after, "the earlier results were replaced");
    let failed = Results::read_parquet(folder.path("results/model/go.failed.parquet")).unwrap();
    assert!(
        failed
            .failure()
            .unwrap()
            .contains("table push is read beyond its last point")
    );
    // the last one, at 25 ms, reads the table at its last point, but for rounding
    assert_eq!(failed.samples(), 26);
    let files = folder.files();
    assert!(
        files
            .iter()
            .filter(|name| !good.contains(&name.as_str()))
            .all(|name| name.contains(".failed.")),
        "{files:?}"
    );
    let listed = text(&folder.eng(&["results", "results/model"]));
    assert!(
        listed.contains("go.failed.parquet; the run failed: "),
        "{listed}"
    );

    // a good run removes the files of the failed one
    let output = folder.eng(&["run", "model.eng", "--csv"]);
    assert!(output.status.success(), "{}", errors(&output));
    let files = folder.files();
    assert!(
        !files.iter().any(|name| name.contains("failed")),
        "{files:?}"
    );
}

#[test]
fn a_run_that_fails_before_its_first_sample_leaves_nothing() {
    let model = PUSHED.replace("push(t*end)", "push(t*end - 1 ms)");
    let folder = Folder::new("first", &model);
    let output = folder.eng(&["run", "model.eng"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(
        errors(&output).contains("before its first point"),
        "{}",
        errors(&output)
    );
    assert_eq!(folder.files(), Vec::<String>::new());
}

const SWUNG: &str = "
use std.joints.Revolute
model Swing {
    param length: Length = 400 mm in (10 mm, 2 m)
    param load: Mass = 1 kg
    gravity = [0, -9.81, 0] m/s^2
    marker pivot = [0, 0, 0] mm
    body bob { mass = load; inertia = [2, 2, 2] g*m^2; marker top = [0, 1, 0]*length }
    joint pin = Revolute(bob.top, pivot)
    start pin.angle = 30 deg
}
analysis plain = assemble(Swing())
analysis heavy = assemble(Swing(load: 3 kg))
analysis sweep[s in 100 mm .. 300 mm by 100 mm] = assemble(Swing(length: s, load: 2 kg))
analysis one[s in [200 mm]] = assemble(Swing(length: s))
analysis long = assemble(Swing(length: 3 m))
";

#[test]
fn a_parameter_that_a_sweep_varies_cannot_be_set() {
    let folder = Folder::new("set", SWUNG);
    let run = |analysis: &str, set: &str| {
        folder.eng(&["run", "model.eng", "--analysis", analysis, "--set", set])
    };
    for analysis in ["sweep", "sweep[2]", "one"] {
        let output = run(analysis, "length=250mm");
        assert_eq!(output.status.code(), Some(2), "{analysis}");
        let told = errors(&output);
        assert!(
            told.contains("--set length: ")
                && told.contains(" varies length from point to point, so it can't be set"),
            "{told}"
        );
    }
    let output = run("plain", "length=250mm");
    assert!(
        output.status.success() && !text(&output).contains("not"),
        "{}",
        text(&output)
    );
    // `--set` of a parameter that an analysis states gives a note, also if no point of the sweep varies it
    for (analysis, stated) in [("heavy", "3 kg"), ("sweep", "2 kg")] {
        let output = run(analysis, "load=5kg");
        assert!(output.status.success(), "{}", errors(&output));
        let told = format!("load = 5 kg, not {stated} as the text states");
        assert!(text(&output).contains(&told), "{}", text(&output));
    }
}

#[test]
fn a_value_outside_its_limits_is_told_with_its_places() {
    let folder = Folder::new("limits", SWUNG);
    let output = folder.eng(&["run", "model.eng", "--analysis", "long"]);
    assert_eq!(output.status.code(), Some(1));
    let told = errors(&output);
    assert!(
        told.contains(
            "length = 3000 mm is outside its limits: it must be above 10 mm and below 2000 mm"
        ),
        "{told}"
    );
    assert!(
        told.contains("model.eng:4:") && told.contains("set by this analysis"),
        "{told}"
    );
    let output = folder.eng(&[
        "run",
        "model.eng",
        "--analysis",
        "plain",
        "--set",
        "length=1 mm",
    ]);
    let told = errors(&output);
    assert!(
        told.contains("length = 1 mm is outside its limits")
            && told.contains("set for this run: by --set"),
        "{told}"
    );
}

#[test]
fn an_obstacle_to_results_is_found_before_the_run() {
    // the run refuses such steps at its start
    let model = PUSHED.replace(
        "duration: 40 ms, sample: 1 ms",
        "duration: 40 ms, sample: 1 ms, step: 1e-14 s",
    );
    let folder = Folder::new("way", &model);
    let output = folder.eng(&["run", "model.eng", "--out", "free"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(errors(&output).contains("E0701"), "{}", errors(&output));
    std::fs::write(folder.path("file"), "").unwrap();
    std::fs::create_dir_all(folder.path("parquet/go.parquet")).unwrap();
    std::fs::create_dir_all(folder.path("csv/go.csv")).unwrap();
    for out in ["file", "file/below", "parquet", "csv", "/proc/none"] {
        let output = folder.eng(&["run", "model.eng", "--csv", "--out", out]);
        assert_eq!(output.status.code(), Some(2), "{out}");
        assert!(errors(&output).contains(out), "{}", errors(&output));
    }
    assert!(!Path::new("/proc/none").exists());
}

const TURNED: &str = "
use std.joints.PointOnPlane
use std.journals.{Impedance, Short, JournalLaw}
use std.oils.{ISO_VG_46, ISO_VG_32, VogelOil}
use std.drives.PrescribedRotation
model Rotor {
    const law: JournalLaw = Impedance
    const oil: VogelOil = ISO_VG_46
    param speed: AngularVelocity = SPEED
    param clearance: Length = 60 um
    param temperature: Temperature = 60 degC
    gravity = [-9.81, 0, 0] m/s^2
    marker axis = [0, 0, 0] mm
    marker seat[j in 1..2] = [0 mm, 0 mm, (j - 1.5)*300 mm]
    body rotor {
        mass = 20 kg
        inertia = [300, 300, 40] g*m^2
        center_of_mass = [2.5, 0, 30000] um
        marker mid = origin
        marker neck[j in 1..2] = [0 mm, 0 mm, (j - 1.5)*300 mm]
        start angular_velocity = [0, 0, 1]*speed
        start position = [-15, 5, 0] um
    }
    joint thrust = PointOnPlane(rotor.mid, axis)
    drive turn = PrescribedRotation(rotor.mid, axis, speed: speed)
    journal b[j in 1..2] = law(pin: rotor.neck[j], shell: seat[j], diameter: 40 mm, width: 20 mm,
        radial_clearance: clearance, viscosity: oil.viscosity(temperature))
    cycle angle = rotation(rotor.mid, axis) { period = 360 deg }
    output film[j in 1..2] = b[j].minimum_film as um
}
analysis run = transient(Rotor(), duration: 60 ms, sample: 0.5 ms)
analysis short = transient(Rotor(law: Short, oil: ISO_VG_32), duration: 60 ms, sample: 0.5 ms)
analysis cold = assemble(Rotor(temperature: -100 degC))
";

#[test]
fn check_tells_what_is_advised_and_required_of_parameters() {
    let model: Vec<String> = TURNED
        .replace("SPEED", "3000 rpm")
        .lines()
        .filter(|line| !line.starts_with("analysis short"))
        .map(|line| {
            line.replace(
                "analysis run",
                "analysis again = assemble(Rotor())\nanalysis run",
            )
        })
        .collect();
    let folder = Folder::new("advice", &model.join("\n"));
    let output = folder.eng(&["check", "model.eng"]);
    assert_eq!(output.status.code(), Some(1));
    let told = text(&output);
    // two journals and all analyses: once
    assert_eq!(told.matches("warning[W0720]").count(), 1, "{told}");
    assert!(
        told.contains("b[1], b[2]: a radial clearance of 60 um"),
        "{told}"
    );
    assert!(told.contains("clearance is stated here"), "{told}");
    assert!(told.contains("is it the diametral clearance?"), "{told}");
    assert_eq!(told.matches("error[E0720]").count(), 1, "{told}");
    assert!(
        told.contains("Vogel's equation of this oil holds above -97.43 degC, not at -100 degC"),
        "{told}"
    );
}

/// The printed rows of the journals: peak load, film and friction of each.
fn rows(output: &Output) -> Vec<Vec<f64>> {
    text(output)
        .lines()
        .filter(|line| line.trim_start().starts_with("b["))
        .map(|line| {
            let numbers: Vec<f64> = line
                .split_whitespace()
                .skip(1)
                .map(|x| x.parse().unwrap())
                .collect();
            vec![numbers[0], numbers[3], numbers[6]]
        })
        .collect()
}

#[test]
fn a_shaft_that_turns_backwards_has_a_last_cycle_too() {
    let run = |name: &str, speed: &str| {
        let folder = Folder::new(name, &TURNED.replace("SPEED", speed));
        let output = folder.eng(&[
            "run",
            "model.eng",
            "--no-plots",
            "--analysis",
            "run",
            "--analysis",
            "short",
        ]);
        assert!(output.status.success(), "{}", errors(&output));
        assert_eq!(
            text(&output).matches("over the last cycle").count(),
            2,
            "{}",
            text(&output)
        );
        rows(&output)
    };
    let (forwards, backwards) = (run("forwards", "3000 rpm"), run("backwards", "-3000 rpm"));
    assert_eq!(forwards.len(), 4);
    // the starting place is no mirror image, but a revolution later it is forgotten
    for (a, b) in forwards.iter().zip(&backwards) {
        for (x, y) in a.iter().zip(b) {
            assert!((x / y - 1.0).abs() < 0.05, "{forwards:?} {backwards:?}");
        }
    }
    // the other law and oil were taken
    assert!(
        (forwards[0][2] / forwards[2][2] - 1.0).abs() > 0.1,
        "{forwards:?}"
    );
}

#[test]
fn a_very_long_line_is_shown_around_the_place() {
    let terms = vec!["1 mm"; 240].join(" + ");
    let wide = format!("[{}]", vec!["1.5 mm"; 800].join(", "));
    let model = format!(
        "model Rig {{ let a = {terms}; let b = {wide}; output c = lenght(b) + 1; output d = a as mm }}\n"
    );
    assert!(model.len() > 6000);
    let folder = Folder::new("long", &model);
    let output = folder.eng(&["check", "model.eng"]);
    assert_eq!(output.status.code(), Some(1));
    let told = text(&output);
    assert!(told.contains("lenght") && told.contains('…'), "{told}");
    assert!(told.len() < 3000, "{} bytes: {told}", told.len());
    // its place is that in the file
    let column = model.find("lenght").unwrap() + 1;
    assert!(told.contains(&format!("model.eng:1:{column}")), "{told}");
}

#[test]
fn help_tells_where_results_go_and_the_exit_codes() {
    let folder = Folder::new("help", "");
    let told = text(&folder.eng(&["run", "--help"]));
    for part in [
        "ANALYSIS.parquet",
        "ANALYSIS.failed.parquet",
        "Exit codes: 0",
        "results/MODEL",
    ] {
        assert!(told.contains(part), "{part}: {told}");
    }
}

/// The phases of a check. The turn without forces is one of them.
#[test]
fn timings_of_a_check_have_every_phase() {
    let lines = TURNED
        .lines()
        .filter(|line| !line.starts_with("analysis cold"));
    let model = lines
        .collect::<Vec<_>>()
        .join("\n")
        .replace("SPEED", "3000 rpm");
    let folder = Folder::new("check-timings", &model);
    let plain = folder.eng(&["check", "model.eng"]);
    assert!(plain.status.success(), "{}", errors(&plain));
    assert!(!text(&plain).contains("processor time"), "{}", text(&plain));
    let output = folder.eng(&["check", "model.eng", "--timings"]);
    assert!(output.status.success(), "{}", errors(&output));
    let told = text(&output);
    let line = told
        .lines()
        .find(|line| line.starts_with("processor time: "));
    let line = line.unwrap_or_else(|| panic!("{told}"));
    assert!(told.starts_with(&text(&plain)), "{told}");
    let mut sum = 0.0;
    for phase in [
        "reading",
        "types",
        "elaboration",
        "meshes",
        "reports",
        "machine code",
        "assembly",
        "turns without forces",
        "lints",
    ] {
        let (_, rest) = line.split_once(&format!(" {phase} ")).unwrap();
        // a fast machine assembles in less than the last digit: no phase alone is above zero for sure
        sum += rest.split_once(" s").unwrap().0.parse::<f64>().unwrap();
    }
    assert!(sum > 0.0, "{line}");
    // a text with mistakes has the first phases alone
    let wrong = Folder::new("check-timings-wrong", "model M { let x = 3 mm + 1 s }");
    let output = wrong.eng(&["check", "model.eng", "--timings"]);
    assert!(
        text(&output).contains("0 turns without forces 0.000 s"),
        "{}",
        text(&output)
    );
    let output = folder.eng(&["check", "model.eng", "--timings", "--format", "json"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(
        errors(&output).contains("--timings prints no JSON"),
        "{}",
        errors(&output)
    );
}

/// The phases of a run with their times, which one clock measures: `timings::tests` show that they do not overlap.
#[test]
fn timings_have_every_phase_and_change_no_result() {
    let folder = Folder::new("timings", &TURNED.replace("SPEED", "3000 rpm"));
    let run = |more: &[&str]| {
        let first = ["run", "model.eng", "--no-plots", "--analysis", "run"];
        let output = folder.eng(&[&first, more].concat());
        assert!(output.status.success(), "{}", errors(&output));
        let columns = Results::read(folder.path("results/model/run.parquet")).unwrap();
        let columns = columns.columns().iter();
        let bits = columns.map(|c| c.values.iter().map(|x| x.to_bits()).collect());
        let bits: Vec<Vec<u64>> = bits.collect();
        (text(&output), bits)
    };
    let (plain, expected) = run(&[]);
    assert!(!plain.contains("processor time"), "{plain}");
    let (told, found) = run(&["--timings", "--threads", "1"]);
    assert_eq!(found, expected);
    let lines = told
        .lines()
        .filter(|line| line.contains("processor time: "));
    let told: String = lines.collect();
    let mut sum = 0.0;
    for phase in [
        "start",
        "steps",
        "samples",
        "files",
        "error of the cells",
        "check",
        "reductions and machine code",
        "tables, pictures and reports",
    ] {
        let (_, rest) = told.split_once(&format!("{phase} ")).unwrap();
        let seconds: f64 = rest.split_once(" s").unwrap().0.parse().unwrap();
        assert!(seconds >= 0.0, "{phase}: {told}");
        sum += seconds;
    }
    assert!(sum > 0.0, "{told}");
}
