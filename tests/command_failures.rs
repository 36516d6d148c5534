//! Messages of the command about failures: as JSON if it is chosen, without escape sequences of texts or names,
//! and within bounded time.

use crate::support::Temporary;
use eng::results::Results;
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

struct Folder(Temporary);

impl Folder {
    fn new(name: &str) -> Folder {
        let folder = Temporary::new(&format!("failures-{name}"));
        Folder(folder)
    }

    fn with(name: &str, model: &str) -> Folder {
        let folder = Folder::new(name);
        std::fs::write(folder.path("model.eng"), model).unwrap();
        folder
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    fn eng(&self, arguments: &[&str]) -> Output {
        Command::new(env!("CARGO_BIN_EXE_eng"))
            .current_dir(&self.0)
            .args(arguments)
            .output()
            .unwrap()
    }
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

/// Output and errors one after the other.
fn said(output: &Output) -> String {
    text(&output.stdout) + &text(&output.stderr)
}

const SWING: &str = "use std.joints.Revolute
model Swing {
    param length: Length = 1 m
    gravity = [0, -9.81, 0] m/s^2
    marker pivot = [0, 0, 0] mm
    body bob { mass = 1 kg; inertia = [1, 1, 1] g*m^2; marker top = [0, 1, 0]*length }
    joint pin = Revolute(bob.top, pivot)
    start pin.angle = 30 deg
}
analysis swing = transient(Swing(), duration: 100 ms, sample: 10 ms)
";

/// A table in a file that is read at the check.
const TABLED: &str =
    "table push(t: Time) -> Force = csv(\"push.csv\", columns: [\"t [s]\", \"F [N]\"])
model Pushed { output thrust = push(time) as N }
";

#[cfg(unix)]
fn pipe(path: &Path) {
    assert!(Command::new("mkfifo").arg(path).status().unwrap().success());
}

#[cfg(unix)]
#[test]
fn every_failure_of_a_check_is_json_where_that_is_asked_for() {
    let folder = Folder::with("json", "model Wrong { mass = }\n");
    std::fs::create_dir(folder.path("folder.eng")).unwrap();
    std::fs::write(folder.path("latin.eng"), b"// \xe9\n").unwrap();
    std::fs::write(folder.path("tabled.eng"), TABLED).unwrap();
    pipe(&folder.path("pipe.eng"));
    pipe(&folder.path("push.csv"));
    for (arguments, exit, code) in [
        (&["check", "--format", "json"][..], 2, "E9902"),
        (&["check", "--format=json", "a.eng", "--wrong"], 2, "E9902"),
        (&["chek", "a.eng", "--format", "json"], 2, "E9902"),
        (&["check", "none.eng", "--format", "json"], 2, "E9903"),
        (&["check", "folder.eng", "--format", "json"], 2, "E9903"),
        (&["check", "pipe.eng", "--format", "json"], 2, "E9903"),
        (&["check", "latin.eng", "--format", "json"], 1, "E0201"),
        (&["check", "tabled.eng", "--format", "json"], 1, "E0518"),
        (&["check", "model.eng", "--format", "json"], 1, "E0101"),
    ] {
        let output = folder.eng(arguments);
        assert_eq!(output.status.code(), Some(exit), "{arguments:?}");
        assert_eq!(text(&output.stderr), "", "{arguments:?}");
        let document: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(document["version"], 1);
        assert_eq!(document["errors"], 1, "{document:#}");
        let first = &document["diagnostics"][0];
        assert_eq!(first["code"], code, "{arguments:?}: {document:#}");
        assert!(!first["title"].as_str().unwrap().is_empty());
    }
    // help is no failure
    let help = folder.eng(&["check", "--help", "--format", "json"]);
    assert!(help.status.success() && text(&help.stdout).contains("Usage"));
}

#[cfg(unix)]
#[test]
fn pipes_are_no_files() {
    let folder = Folder::with("pipe", TABLED);
    pipe(&folder.path("push.csv"));
    pipe(&folder.path("run.parquet"));
    pipe(&folder.path("run.partial.arrows"));
    for arguments in [
        &["check", "model.eng"][..],
        &["results", "run.parquet"],
        &["results", "run.partial.arrows"],
        &["export", "run.parquet", "--to", "csv"],
    ] {
        let output = folder.eng(arguments);
        assert!(!output.status.success(), "{arguments:?}");
        let said = said(&output);
        assert!(said.contains("a pipe or a device"), "{arguments:?}: {said}");
    }
}

#[cfg(unix)]
#[test]
fn nothing_of_a_text_or_a_name_acts_on_the_terminal() {
    let hostile = "\u{1b}]0;owned\u{7}\u{1b}[31mred\u{9b}0m\u{202e}";
    let folder = Folder::with("escape", &format!("const a = nothing // {hostile}\n"));
    let name = format!("{hostile}.eng");
    std::fs::write(folder.path(&name), SWING.replace("1 kg", "1 kh")).unwrap();
    let good = format!("{hostile}-good.eng");
    std::fs::write(folder.path(&good), SWING).unwrap();
    let set = format!("{hostile}=1 m");
    for arguments in [
        &["check", "model.eng"][..],
        &["check", "model.eng", "--format", "json"],
        &["check", &name],
        &["check", &name, "--format", "json"],
        &["run", &name],
        &["run", &good, "--no-plots"],
        &["run", &good, "--set", &set],
        &["run", &good, "--analysis", hostile],
        &["run", &good, hostile],
        &["check", &good, hostile, "--format", "json"],
        &["results", hostile],
        &["explain", hostile],
        &["report", &good],
    ] {
        let said = said(&folder.eng(arguments));
        let acts = |c: char| (c.is_control() && c != '\n') || c == '\u{202e}';
        assert!(!said.contains(acts), "{arguments:?}: {said:?}");
        let shown = said.contains("owned");
        assert!(
            shown || arguments[1] == "model.eng",
            "{arguments:?}: {said}"
        );
    }
}

#[cfg(unix)]
#[test]
fn unfinished_results_are_not_written_through_a_link() {
    let folder = Folder::with("link", SWING);
    let victim = folder.path("victim");
    let results = folder.path("results/model");
    std::fs::create_dir_all(&results).unwrap();
    for name in [
        "swing.partial.arrows",
        "swing.motion.partial.arrows",
        "swing.checkpoint",
    ] {
        std::fs::write(&victim, "precious").unwrap();
        let link = results.join(name);
        std::os::unix::fs::symlink(&victim, &link).unwrap();
        let output = folder.eng(&["run", "model.eng", "--no-plots"]);
        assert_eq!(
            std::fs::read_to_string(&victim).unwrap(),
            "precious",
            "{name}"
        );
        // a short run may need no checkpoint
        if name != "swing.checkpoint" || !output.status.success() {
            assert_eq!(output.status.code(), Some(2), "{name}");
            let said = said(&output);
            assert!(
                said.contains(name) && said.contains("this is a link"),
                "{said}"
            );
        }
        let _ = std::fs::remove_file(&link);
    }
}

/// A message that several points of a sweep have is printed once, and a line names all of them.
#[test]
fn a_message_of_a_sweep_names_its_points() {
    let model = "force Watch(a: Marker, b: Marker, limit: Length) {
            advise far: dot(a.origin - b.origin, b.z) < limit else \"far away\"
            apply force 0 N*b.z on a against b
        }
        model Block {
            param limit: Length = 5 mm
            gravity = [0, 0, 0] m/s^2
            marker floor = [0, 0, 0] mm
            body block { mass = 1 kg; inertia = [1, 1, 1] g*m^2; start position = [0, 0, 10] mm }
            force watch = Watch(block.origin, floor, limit: limit)
        }
        analysis still[l in [1, 20, 2] mm] = transient(Block(limit: l), duration: 1 ms, sample: 1 ms, start: assembled)";
    let folder = Folder::with("points", model);
    let output = folder.eng(&["run", "model.eng", "--no-plots"]);
    let said = text(&output.stderr);
    assert_eq!(said.matches("watch: far away").count(), 2, "{said}");
    assert!(
        said.contains("W0711 concerns 2 of 3 analyses, still[1], still[3]: watch: far away"),
        "{said}"
    );
}

#[test]
fn a_parameter_is_set_once() {
    let folder = Folder::with("once", SWING);
    let output = folder.eng(&[
        "run",
        "model.eng",
        "--set",
        "length=2 m",
        "--set",
        "length = 3 m",
    ]);
    assert_eq!(output.status.code(), Some(2));
    let said = text(&output.stderr);
    assert!(
        said.contains("--set length is given twice: 2 m and 3 m"),
        "{said}"
    );
}

#[test]
fn steps_and_tolerance_are_stated_on_the_command_line() {
    let folder = Folder::with("step", SWING);
    let run = |arguments: &[&str]| {
        let output = folder.eng(&[&["run", "model.eng", "--no-plots"], arguments].concat());
        assert!(output.status.success(), "{}", said(&output));
        let results = Results::read_parquet(folder.path("results/model/swing.parquet")).unwrap();
        (text(&output.stdout), results)
    };
    let steps = |said: &str| -> u32 {
        let line = said.lines().find(|line| line.contains(" steps, ")).unwrap();
        line.split_whitespace().next().unwrap().parse().unwrap()
    };
    let (plain, results) = run(&[]);
    let overrides = |results: &Results| -> Vec<(String, String)> {
        let metadata = results.metadata().clone().into_iter();
        metadata
            .filter(|(key, _)| key.starts_with("override."))
            .collect()
    };
    assert_eq!(overrides(&results), []);
    let (fixed, results) = run(&["--step", "100 us"]);
    assert_eq!(steps(&fixed), 1000);
    assert!(
        fixed.contains(
            " s in place of tolerance = 1, which the text states or which is the default"
        ),
        "{fixed}"
    );
    assert_eq!(
        overrides(&results),
        [("override.step".to_owned(), "0.0001 s".to_owned())]
    );
    let (fine, results) = run(&["--tolerance", "0.001"]);
    assert!(steps(&fine) > 2 * steps(&plain), "{fine}{plain}");
    assert_eq!(
        overrides(&results),
        [("override.tolerance".to_owned(), "0.001".to_owned())]
    );
    let (exact, results) = run(&["--step", "100 us", "--tolerance", "0.001"]);
    assert_eq!(steps(&exact), 1000);
    assert_eq!(
        overrides(&results),
        [(
            "override.step".to_owned(),
            "0.0001 s, solved to a tolerance of 0.001".to_owned()
        )]
    );
    let refused = folder.eng(&["run", "model.eng", "--tolerance", "1e-12"]);
    let refused = said(&refused);
    assert!(
        refused.contains("E0716") && refused.contains("the smallest possible one is about"),
        "{refused}"
    );
    for (wrong, says) in [
        (&["--step", "1 mm"][..], "a step is a time"),
        (&["--step", "0 s"], "must be positive"),
        (&["--tolerance=-1"], "must be positive"),
        (&["--tolerance", "nan"], "must be positive"),
        (
            &["--tolerance", "0", "--step", "1 ms"],
            "--tolerance: it must be positive",
        ),
    ] {
        let output = folder.eng(&[&["run", "model.eng"], wrong].concat());
        assert_eq!(output.status.code(), Some(2), "{wrong:?}");
        assert!(said(&output).contains(says), "{}", said(&output));
    }
}

#[cfg(unix)]
#[test]
fn what_runs_left_is_read_from_files_alone() {
    let folder = Folder::with("left", SWING);
    let run = ["run", "model.eng", "--no-plots", "--resume"];
    for name in ["swing.checkpoint", "swing.partial.arrows"] {
        let left = folder.path("results/model").join(name);
        std::fs::create_dir_all(left.parent().unwrap()).unwrap();
        pipe(&left);
        let output = folder.eng(&run);
        assert_eq!(output.status.code(), Some(2), "{name}");
        let said = said(&output);
        assert!(
            said.contains(name) && said.contains("a pipe or a device"),
            "{said}"
        );
        std::fs::remove_file(&left).unwrap();
    }
    let meshes = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/mesh");
    for name in ["bar.eng", "bar.bdf"] {
        std::fs::copy(meshes.join(name), folder.path(name)).unwrap();
    }
    let reduce = || {
        Command::new(env!("CARGO_BIN_EXE_eng"))
            .current_dir(&folder.0)
            .env("ENG_CACHE", folder.path("cache"))
            .args(["reduce", "bar.eng"])
            .output()
            .unwrap()
    };
    let first = reduce();
    assert!(first.status.success(), "{}", said(&first));
    for kept in std::fs::read_dir(folder.path("cache")).unwrap() {
        let kept = kept.unwrap().path();
        std::fs::remove_file(&kept).unwrap();
        pipe(&kept);
    }
    assert_eq!(said(&reduce()), said(&first));
}

#[test]
fn models_without_a_body_are_checked() {
    let model = "model Empty { gravity = [0, 0, 0] m/s^2; param q: Length = 1 mm; output a = q*2 }
analysis t = transient(Empty(), duration: 1 s)
analysis s = assemble(Empty())
";
    let folder = Folder::with("empty", model);
    let output = folder.eng(&["check", "model.eng"]);
    assert!(output.status.success(), "{}", said(&output));
    assert!(said(&output).contains("t: assembles; 0 velocities"));
    assert!(
        folder
            .eng(&["run", "model.eng", "--no-plots"])
            .status
            .success()
    );
}

#[test]
fn outputs_replace_no_input_and_no_other_output() {
    let tabled =
        "table given(t: Time) -> Force = csv(\"push.csv\", columns: [\"t [s]\", \"F [N]\"])
model Pushed { gravity = [0, 0, 0] m/s^2; output thrust = given(time) as N }
analysis push = transient(Pushed(), duration: 1 s)
";
    let folder = Folder::with("outputs", SWING);
    std::fs::write(folder.path("tabled.eng"), tabled).unwrap();
    std::fs::write(folder.path("push.csv"), "t [s],F [N]\n0,1\n1,2\n").unwrap();
    let ok = folder.eng(&["run", "model.eng", "--no-plots"]);
    assert!(ok.status.success(), "{}", said(&ok));
    let results = "results/model/swing.parquet";
    let kept = ["model.eng", "push.csv", "tabled.eng", results].map(|name| {
        let path = folder.path(name);
        (std::fs::read(&path).unwrap(), path)
    });
    #[cfg(unix)]
    std::os::unix::fs::symlink("model.eng", folder.path("page.html")).unwrap();
    #[cfg(not(unix))]
    std::fs::copy(folder.path("model.eng"), folder.path("page.html")).unwrap();
    for (arguments, says) in [
        (
            &["report", "model.eng", "--out", "./model.eng"][..],
            "the command reads this file",
        ),
        (
            &["report", "model.eng", "--out", "page.html"],
            "the command reads this file",
        ),
        (
            &["report", "model.eng", "--gltf", "tabled.eng"],
            "the ending of models",
        ),
        (
            &["report", "model.eng", "--out", results],
            "the command reads this file",
        ),
        (
            &["report", "model.eng", "--out", "old.parquet"],
            "the ending of results",
        ),
        (
            &["report", "model.eng", "--gltf", "x.html", "--out", "x.html"],
            "are one file",
        ),
        (
            &["report", "model.eng", "--figures", "push.csv"],
            "push.csv is a file, not a folder",
        ),
        (
            &["export", results, "--to", "csv", "--out", results],
            "the command reads this file",
        ),
        (
            &["export", results, "--to", "csv", "--out", "model.eng"],
            "the ending of models",
        ),
        (
            &["run", "tabled.eng", "--csv", "--out", "."],
            "the command reads this file",
        ),
        (
            &["run", "model.eng", "--out", "model.eng"],
            "model.eng is a file, not a folder",
        ),
        (
            &["run", "model.eng", "--out", "push.csv/below"],
            "push.csv is a file, not a folder",
        ),
    ] {
        if cfg!(not(unix)) && arguments.contains(&"page.html") {
            continue;
        }
        let output = folder.eng(arguments);
        assert_eq!(
            output.status.code(),
            Some(2),
            "{arguments:?}: {}",
            said(&output)
        );
        let said = said(&output);
        assert!(said.contains(says), "{arguments:?}: {said}");
        assert!(!said.contains("wrote"), "{arguments:?}: {said}");
        for (bytes, path) in &kept {
            assert!(
                &std::fs::read(path).unwrap() == bytes,
                "{arguments:?}: {}",
                path.display()
            );
        }
        assert!(!folder.path("x.html").exists(), "{arguments:?}");
    }
    let page = folder.eng(&["report", "model.eng", "--out", "x.html", "--gltf", "x.glb"]);
    assert!(page.status.success(), "{}", said(&page));
}

#[test]
fn a_copy_under_another_name_is_the_same_model() {
    let folder = Folder::with("copy", SWING);
    assert!(
        folder
            .eng(&["run", "model.eng", "--no-plots"])
            .status
            .success()
    );
    std::fs::copy(folder.path("model.eng"), folder.path("copy.eng")).unwrap();
    let left = "results/model";
    let report = folder.eng(&["report", "copy.eng", "--results", left]);
    assert!(
        report.status.success() && !said(&report).contains("warning"),
        "{}",
        said(&report)
    );
    let resumed = folder.eng(&["run", "copy.eng", "--no-plots", "--resume", "--out", left]);
    let told = said(&resumed);
    assert!(told.contains("was complete"), "{told}");
    for name in ["swing.parquet", "swing.motion.parquet"] {
        let line = format!("{name} is complete, nothing was written\n");
        assert!(told.contains(&line), "{told}");
    }
    assert!(!told.contains("  wrote "), "{told}");
}

#[test]
fn names_of_points_alone_keep_their_results_apart() {
    let folder = Folder::with("points", SWING);
    for name in ["...eng", "..eng"] {
        std::fs::copy(folder.path("model.eng"), folder.path(name)).unwrap();
        let output = folder.eng(&["run", name, "--no-plots"]);
        assert!(output.status.success(), "{}", said(&output));
        let results = Path::new("results").join(name).join("swing.parquet");
        assert!(
            folder.path(".").join(results).is_file(),
            "{}",
            said(&output)
        );
    }
}

#[test]
fn an_argument_is_one_line_of_a_message_and_says_something() {
    let folder = Folder::with("line", SWING);
    let output = folder.eng(&["run", "model.eng", "--analysis", "a\nerror: b"]);
    assert_eq!(text(&output.stderr).lines().count(), 1, "{}", said(&output));
    for channels in ["", " , ", "height,"] {
        let output = folder.eng(&["run", "model.eng", "--channels", channels]);
        assert_eq!(output.status.code(), Some(2), "{channels:?}");
        assert!(
            said(&output).contains("a pattern of several"),
            "{}",
            said(&output)
        );
    }
    let whirl = SWING.replace(
        "analysis swing = transient(Swing(), duration: 100 ms, sample: 10 ms)",
        "analysis swing = linear(Swing(), frozen: true)",
    );
    std::fs::write(folder.path("whirl.eng"), whirl).unwrap();
    let output = folder.eng(&["run", "whirl.eng", "--last", "1 rev"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(
        said(&output).contains("its rows are modes"),
        "{}",
        said(&output)
    );
}

#[test]
fn of_very_many_mistakes_a_hundred_are_shown() {
    let wrong: String = (0..20_000)
        .map(|i| format!("const a{i} = missing{i}\n"))
        .collect();
    let folder = Folder::with("many", &wrong);
    let output = folder.eng(&["check", "model.eng"]);
    assert_eq!(output.status.code(), Some(1));
    let said = said(&output);
    assert_eq!(said.matches("error[").count(), 100, "{}", said.len());
    assert!(
        said.ends_with("… and 19900 more messages\n20000 errors, 0 warnings\n"),
        "{}",
        said.lines().last().unwrap()
    );
    let thousand: String = wrong.lines().take(1000).flat_map(|l| [l, "\n"]).collect();
    std::fs::write(folder.path("model.eng"), thousand).unwrap();
    let output = folder.eng(&["check", "model.eng", "--format", "json"]);
    let document: Value = serde_json::from_str(&text(&output.stdout)).unwrap();
    assert_eq!(document["diagnostics"].as_array().unwrap().len(), 100);
    assert_eq!(
        (&document["errors"], &document["more"]),
        (&1000.into(), &900.into())
    );
}

/// A name beyond those that are shown is not compared with all others, so it has no suggestion.
#[test]
fn only_the_first_hundred_unknown_names_have_a_suggestion() {
    for line in [
        "const a{} = knwon\n",
        "const a{}: Lenth = 1 mm\n",
        "const a{} = 1 mmm\n",
    ] {
        let wrong: String = (0..500)
            .map(|i| line.replace("{}", &i.to_string()))
            .collect();
        let text = format!("const known = 1\n{wrong}");
        let sources = eng::Sources::from_texts([("model.eng".to_owned(), text)]);
        let report = eng::check(&sources, "model.eng").report();
        let messages = report.diagnostics();
        assert_eq!(messages.len(), 500, "{line}");
        let suggested = messages.iter().filter(|message| !message.fixes.is_empty());
        let suggested = suggested.count();
        assert!((100..=101).contains(&suggested), "{line}: {suggested}");
    }
}

#[test]
fn of_very_many_unknown_types_and_units_a_hundred_are_shown() {
    for line in ["const a{}: Lenth{} = 1 mm\n", "const a{} = 1 mmm{}\n"] {
        let wrong: String = (0..20_000)
            .map(|i| line.replace("{}", &i.to_string()))
            .collect();
        let folder = Folder::with("types", &wrong);
        let output = folder.eng(&["check", "model.eng"]);
        let said = said(&output);
        assert!(
            said.ends_with("… and 19900 more messages\n20000 errors, 0 warnings\n"),
            "{}",
            said.lines().last().unwrap()
        );
    }
}

#[test]
fn a_very_long_name_is_shown_in_short() {
    let name = "n".repeat(10_000_000);
    let folder = Folder::with(
        "name",
        &format!("const {name} = missing\nconst b = {name}s\n"),
    );
    let output = folder.eng(&["check", "model.eng"]);
    assert_eq!(output.status.code(), Some(1));
    let said = said(&output);
    assert!(said.len() < 20_000, "{} bytes", said.len());
}

/// A force that jumps with the condition `{way}` and drives the body back to the jump from both sides.
const RUBBED: &str = "force Rub(a: Marker, b: Marker) {
    let way = dot(a.origin - b.origin, b.y)
    let v = der(way)
    apply force (if {way} then -20 N else 20 N)*b.y on a against b
}
model Rubbed {
    gravity = [0, -9.81, 0] m/s^2
    marker wall = [0, 0, 0] mm
    body bob { mass = 1 kg; inertia = [1, 1, 1] g*m^2 }
    force rub = Rub(bob.origin, wall)
    output height = dot(bob.origin.origin, ground.y) as mm
}
analysis a = transient(Rubbed(), duration: 1e6 s, sample: 1 s)
";

#[test]
fn a_force_that_holds_the_motion_at_its_jump_is_refused() {
    let folder = Folder::with("rub", &RUBBED.replace("{way}", "v > 0 m/s"));
    let output = folder.eng(&["run", "model.eng", "--no-plots"]);
    assert_eq!(output.status.code(), Some(1));
    let told = text(&output.stderr);
    assert!(
        told.contains("error[E0770]: the force of rub jumps by 4"),
        "{told}"
    );
    assert!(told.contains("the motion stays at the jump"), "{told}");
    assert!(told.contains("model.eng:10:11"), "{told}");
}

/// The same beside a spring and beside a damper: the load of the other law changes while the body sticks.
#[test]
fn a_force_that_holds_the_motion_beside_other_loads_is_refused() {
    let text = RUBBED
        .replace("{way}", "v > 0 m/s")
        .replace("[0, -9.81, 0]", "[0, 0, 0]");
    for (name, more) in [("spring", "100 N/m*way"), ("damper", "20 N*s/m*v")] {
        let text = text
            .replace(
                "(if v > 0 m/s then -20 N else 20 N)",
                &format!("(-{more} + (if v > 0 m/s then -20 N else 20 N))"),
            )
            .replace(
                "inertia = [1, 1, 1] g*m^2 }",
                "inertia = [1, 1, 1] g*m^2; start velocity = [0, 1, 0] m/s }",
            )
            .replace(
                "duration: 1e6 s, sample: 1 s",
                "duration: 2 s, sample: 10 ms",
            );
        let folder = Folder::with(name, &text);
        let output = folder.eng(&["run", "model.eng", "--no-plots"]);
        let told = said(&output);
        assert_eq!(output.status.code(), Some(1), "{told}");
        assert!(
            told.contains("error[E0770]: the force of rub jumps by 4"),
            "{told}"
        );
    }
}

/// A block sticks under a friction that is zero at rest itself: the jump has two parts. The length of the model, which sets the
/// tolerance of positions, does not decide whether the run ends.
#[test]
fn friction_with_a_value_at_rest_is_refused_at_any_length_of_the_model() {
    for far in ["20", "40", "100", "150"] {
        let text = format!(
            "use std.joints.Translational
force Dry(a: Marker, b: Marker) {{
    let v = dot(a.velocity - b.velocity, b.z)
    apply force (if v > 0 m/s then -1 N else if v < 0 m/s then 1 N else 0 N)*b.z on a against b
}}
model Stick {{
    gravity = [0, 0, 0] m/s^2
    marker wall = [0, 0, 0] mm
    body block {{ mass = 1 kg; inertia = [1, 1, 1] g*m^2; marker eye = origin; marker far = [{far}, 0, 0] mm }}
    joint rail = Translational(block.eye, wall)
    force dry = Dry(block.eye, wall)
    start rail.speed = 0.1 m/s
    output place = block.far.origin in ground as mm
}}
analysis run = transient(Stick(), duration: 0.2 s)
"
        );
        let folder = Folder::with("third", &text);
        let output = folder.eng(&["run", "model.eng", "--no-plots"]);
        let told = said(&output);
        assert_eq!(output.status.code(), Some(1), "{told}");
        assert!(
            told.contains("error[E0770]: the force of dry jumps by 2 N"),
            "{far} mm: {told}"
        );
    }
}

/// A piston under dry friction comes to rest at mid-stroke of a slider-crank that nothing drives. Steps across the jump have no
/// solution, so they end before it, again and again.
#[test]
fn dry_friction_that_holds_a_mechanism_is_refused() {
    for other in ["else -20 N", "else if v < 0 m/s then -20 N else 0 N"] {
        let text = format!(
            "use std.joints.{{Revolute, PointOnLine, Translational}}
force Dry(a: Marker, b: Marker) {{
    let v = dot(a.velocity - b.velocity, b.z)
    apply force -(if v > 0 m/s then 20 N {other})*b.z on a against b
}}
model Crank {{
    gravity = [0, 0, 0] m/s^2
    marker rail = [0, 0, 0] mm
    marker bore = at([0, 0, 0] mm, z: [1, 0, 0])
    body crank {{ mass = 2 kg; inertia = [2, 2, 2] g*m^2; marker main = origin; marker pin = [20, 0, 0] mm }}
    body rod {{ mass = 0.4 kg; inertia = [0.1, 1, 1] g*m^2; center_of_mass = [40, 0, 0] mm; marker big = origin; marker small = [120, 0, 0] mm }}
    body piston {{ mass = 0.5 kg; inertia = [1, 1, 1] g*m^2; marker pin = origin; marker crown = at(origin, z: [1, 0, 0]) }}
    joint main = Revolute(crank.main, rail)
    joint big_end = Revolute(rod.big, crank.pin)
    joint wrist = PointOnLine(rod.small, piston.pin)
    joint liner = Translational(piston.crown, bore) {{ branch travel > 0 mm }}
    force dry = Dry(piston.crown, bore)
    start main.angle = 30 deg
    start der(main.angle) = 12 rad/s
}}
analysis run = transient(Crank(), duration: 0.6 s, sample: 5 ms)
"
        );
        let folder = Folder::with("stick", &text);
        let output = folder.eng(&["run", "model.eng", "--no-plots"]);
        let told = said(&output);
        assert_eq!(output.status.code(), Some(1), "{told}");
        assert!(
            told.contains("error[E0770]: the force of dry jumps by 40 N"),
            "{told}"
        );
    }
}

/// Asks after every step for the cause of its length, and stops after some.
struct Asked {
    steps: u64,
    causes: Vec<eng::StepLimit>,
}

impl eng::Watch for Asked {
    fn progress(&mut self, now: eng::Progress) -> eng::Verdict {
        if now.steps < self.steps {
            eng::Verdict::Explain
        } else {
            eng::Verdict::Stop
        }
    }

    fn short_steps(&mut self, slow: &eng::Slow) {
        assert!(slow.step > 0.0, "{slow}");
        self.causes.push((*slow.limit).clone());
    }
}

/// The cause of short steps does not depend on the step after which it is asked for: a computer of another speed asks
/// after another one.
#[test]
fn every_step_at_a_jump_names_it() {
    let text = RUBBED.replace("{way}", "way > 0 mm");
    let sources = eng::Sources::from_texts([("model.eng".to_owned(), text)]);
    let program = eng::check(&sources, "model.eng").into_program().unwrap();
    let analysis = program.analysis("a").unwrap();
    let mut asked = Asked {
        steps: 20_000,
        causes: Vec::new(),
    };
    let _ = analysis.run_watched(&mut asked);
    // before the body meets the jump for the first time, errors limit the steps
    let met = |cause: &eng::StepLimit| matches!(cause, eng::StepLimit::Jump(_));
    let first = asked.causes.iter().position(met).unwrap();
    assert!(first < 100, "{first}");
    assert!(asked.causes.len() > 20_000);
    for (step, cause) in asked.causes.iter().enumerate().skip(first) {
        assert!(met(cause), "step {step}: {cause}");
    }
}

#[test]
fn a_run_that_nobody_waits_for_is_stopped_with_its_reason() {
    let folder = Folder::with("chatter", &RUBBED.replace("{way}", "way > 0 mm"));
    let output = folder.eng(&["run", "model.eng", "--no-plots"]);
    assert_eq!(output.status.code(), Some(1));
    let told = text(&output.stderr);
    // after some seconds, while it runs
    assert!(told.contains("warning[W0770]: a advances slowly"), "{told}");
    assert!(told.contains("error[E0771]"), "{told}");
    assert!(told.contains("the force of rub jumps by 4"), "{told}");
    assert!(told.contains("model.eng:10:11"), "{told}");
    assert!(told.contains("at this pace the rest takes about"), "{told}");
    assert!(told.contains("--patient"), "{told}");
}
