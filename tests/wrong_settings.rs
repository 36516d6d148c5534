//! Messages about settings, options and files of earlier runs that do not fit.

use std::path::{Path, PathBuf};
use std::process::Command;

const MODEL: &str = "
use std.joints.Revolute
const teeth = 3
model Spin {
    const discs = 2
    param mass: Mass = 1 kg
    gravity = [0, 0, 0] m/s^2
    marker pivot = [0, 0, 0] mm
    body disc { mass = mass*discs; inertia = [1, 1, 1] g*m^2; marker hub = origin; start angular_velocity = [0, 0, 1]*(600 rpm) }
    joint pin = Revolute(disc.hub, pivot)
    cycle angle = rotation(disc.hub, pivot) { period = 360 deg }
    output ratio = cycle.angle/teeth as deg
}
analysis turns = transient(Spin(), duration: 1 rev, sample: 10 deg)
analysis fine = periodic(Spin(), sample: 1e-9 deg)
";

fn folder(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("eng-settings-{name}-{}", std::process::id()));
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).expect("a folder");
    std::fs::write(folder.join("spin.eng"), MODEL).expect("written");
    folder
}

/// Exit code, output and messages.
fn eng(folder: &Path, arguments: &[&str]) -> (Option<i32>, String, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_eng"));
    let output = command
        .current_dir(folder)
        .args(arguments)
        .output()
        .expect("eng runs");
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("UTF-8");
    (
        output.status.code(),
        text(output.stdout),
        text(output.stderr),
    )
}

const TURNS: [&str; 5] = ["run", "spin.eng", "--analysis", "turns", "--no-plots"];

#[test]
fn a_constant_is_told_as_one() {
    let folder = folder("constant");
    for (setting, says) in [
        ("discs=3", "discs is a `const`, not a parameter"),
        ("discs=3", "Spin(discs: …)"),
        ("teeth=4", "teeth is a `const` of the file"),
        ("mas=2kg", "did you mean mass?"),
    ] {
        let (code, _, errors) = eng(&folder, &[&TURNS[..], &["--set", setting]].concat());
        assert_eq!(code, Some(2), "{errors}");
        assert!(errors.contains(says), "{errors}");
    }
    // a model of another file
    let other = "use spin.Spin\nanalysis other = transient(Spin(), duration: 1 ms, sample: 1 ms)\n";
    std::fs::write(folder.join("other.eng"), other).expect("written");
    let (code, _, errors) = eng(&folder, &["run", "other.eng", "--set", "discs=3"]);
    assert_eq!(code, Some(2), "{errors}");
    assert!(errors.contains("Spin(discs: …)"), "{errors}");
    std::fs::remove_dir_all(&folder).expect("removed");
}

#[test]
fn an_option_is_told_in_degrees_with_its_place() {
    let folder = folder("option");
    let (code, _, errors) = eng(&folder, &["run", "spin.eng", "--analysis", "fine"]);
    assert_eq!(code, Some(1), "{errors}");
    assert!(errors.contains("samples 1e-9° apart"), "{errors}");
    assert!(errors.contains("a cycle of 360°"), "{errors}");
    assert!(errors.contains("spin.eng:15:10"), "{errors}");
    std::fs::remove_dir_all(&folder).expect("removed");
}

#[test]
fn motion_that_is_gone_and_runs_that_are_not_complete_are_told() {
    let folder = folder("gone");
    let (code, said, errors) = eng(&folder, &TURNS);
    assert_eq!(code, Some(0), "{errors}");
    assert!(!said.contains("its motion is missing"), "{said}");
    let results = folder.join("results/spin");
    std::fs::remove_file(results.join("turns.motion.parquet")).expect("removed");
    let resumed = [&TURNS[..], &["--resume"]].concat();
    let (_, said, _) = eng(&folder, &resumed);
    assert!(said.contains("its motion is missing"), "{said}");
    // as a killed run leaves it
    std::fs::rename(
        results.join("turns.parquet"),
        results.join("turns.partial.arrows"),
    )
    .expect("renamed");
    let report = ["report", "spin.eng", "--analysis", "turns"];
    let (code, _, errors) = eng(&folder, &report);
    assert_eq!(code, Some(2), "{errors}");
    assert!(errors.contains("turns was interrupted"), "{errors}");
    assert!(errors.contains("eng run spin.eng --resume"), "{errors}");
    std::fs::remove_dir_all(&folder).expect("removed");
}

#[test]
fn moments_outside_the_kept_motion_are_told() {
    let folder = folder("moments");
    let (code, _, errors) = eng(&folder, &TURNS);
    assert_eq!(code, Some(0), "{errors}");
    let report = ["report", "spin.eng", "--analysis", "turns", "--stress-at"];
    let (code, _, errors) = eng(&folder, &[&report[..], &["5 s"]].concat());
    assert_eq!(code, Some(0), "{errors}");
    let says = "turns: no stresses at 5 s: the motion has no such moment";
    assert!(errors.contains(says), "{errors}");
    std::fs::remove_dir_all(&folder).expect("removed");
}

/// A body that begins at rest turns too far within a step of the length of the run.
#[test]
fn a_step_as_long_as_the_run_turns_a_body_too_far() {
    let folder = folder("long_step");
    let swing = "use std.joints.Revolute
model Swing {
    gravity = [0, -9.81, 0] m/s^2
    marker pivot = [0, 0, 0] mm
    body bob { mass = 1.2 kg; inertia = [2, 2, 2] g*m^2; marker top = [0, 400, 0] mm }
    joint pin = Revolute(bob.top, pivot)
    start pin.angle = 30 deg
}
analysis swing = transient(Swing(), duration: 5 s, sample: 10 ms)
";
    std::fs::write(folder.join("swing.eng"), swing).expect("written");
    for step in ["1s", "5s", "1h"] {
        let run = ["run", "swing.eng", "--no-plots", "--step", step];
        let (code, _, errors) = eng(&folder, &run);
        assert_eq!(code, Some(1), "{step}: {errors}");
        assert!(
            errors.contains("E0701") && errors.contains("turns bob by"),
            "{errors}"
        );
    }
    let (code, _, errors) = eng(
        &folder,
        &["run", "swing.eng", "--no-plots", "--step", "10ms"],
    );
    assert_eq!(code, Some(0), "{errors}");
    let _ = std::fs::remove_dir_all(&folder);
}

const CHOICE: &str = "
choice Sense = forward | backward
model Spin {
    const sense: Sense = forward
    param mass: Mass = 1 kg
    gravity = [0, 0, 0] m/s^2
    body disc { mass = mass; inertia = [1, 1, 1] g*m^2; start velocity = [if sense == forward then 1 else if sense == backward then -1, 0, 0] m/s }
    output way = dot(disc.origin.velocity, ground.x)*1 s as m
    output doubled = dot(disc.origin.velocity, ground.x)*(mass/(1 kg)) as m/s
}
analysis slides = transient(Spin(), duration: 10 ms, sample: 1 ms)
analysis each[s in [Sense.forward, Sense.backward]] = transient(Spin(sense: s), duration: 10 ms, sample: 1 ms)
";

#[test]
fn a_word_of_a_choice_replaces_that_of_the_text() {
    let sources = eng::Sources::from_text("spin.eng", CHOICE);
    let checked = eng::check(&sources, "spin.eng");
    let program = checked.into_program().expect("a right text");
    let last = |analysis: &eng::Analysis, channel: &str| {
        let outcome = analysis.run(&mut |_| {}).expect("it runs");
        let mut columns = outcome.results.columns().iter();
        let column = columns.find(|column| column.path == channel);
        let values = &column.expect("a column").values;
        values.last().copied().expect("a sample")
    };
    let slides = || program.analysis("slides").expect("an analysis");
    assert_eq!(last(&slides(), "way"), 1.0);
    let mass = slides().parameter("mass").expect("a parameter");
    let heavy = slides()
        .set(mass, "3 kg".parse().expect("a mass"))
        .expect("set");
    let back = heavy.choose("sense", "backward").expect("a word");
    assert_eq!(last(&back, "way"), -1.0);
    // the mass that was set before stays
    assert_eq!(last(&back, "doubled"), -3.0);
    let told = |word: &str| vec![format!("sense = {word} in place of the word of the text")];
    assert_eq!(back.replaced(), told("backward"));
    let again = back.choose("sense", "forward").expect("a word");
    assert_eq!(last(&again, "doubled"), 3.0);
    assert_eq!(again.replaced(), told("forward"));

    let failed = |analysis: eng::Analysis, path: &str, word: &str| {
        let failed = analysis.choose(path, word).expect_err("no such word");
        failed.to_string()
    };
    assert_eq!(
        failed(slides(), "sense", "forwards"),
        "`forwards` is no word of sense: its words are forward, backward"
    );
    assert!(failed(slides(), "sens", "forward").contains("no parameter"));
    let each = program.analysis("each[1]").expect("an analysis");
    assert!(failed(each, "sense", "forward").contains("varies sense from point to point"));
}

#[test]
fn set_takes_a_word() {
    let folder = folder("choice");
    std::fs::write(folder.join("spin.eng"), CHOICE).expect("written");
    let run = [
        "run",
        "spin.eng",
        "--analysis",
        "slides",
        "--no-plots",
        "--set",
    ];
    let (code, said, errors) = eng(&folder, &[&run[..], &["sense=backward"]].concat());
    assert_eq!(code, Some(0), "{errors}");
    assert!(said.contains("sense = backward"), "{said}");
    let (code, _, errors) = eng(&folder, &[&run[..], &["sense=3"]].concat());
    assert_eq!(code, Some(2), "{errors}");
    assert!(
        errors.contains("its words are forward, backward"),
        "{errors}"
    );
    std::fs::remove_dir_all(&folder).expect("removed");
}
