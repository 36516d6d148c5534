//! The command on small models, run inside of this process: its prints, its files and its exit
//! codes.

use crate::support::Temporary;
use eng::cli::{Console, run_on};
use eng::results::Results;
use std::io::{self, Write};
use std::path::Path;

/// A shaft in one journal, turned at a speed, at two of them.
const ROTOR: &str = "
use std.joints.Spherical
use std.journals.Short
use std.drives.PrescribedRotation
model Rotor {
    param speed: AngularVelocity = 3000 rpm
    gravity = [-9.81, 0, 0] m/s^2
    marker axis = [0, 0, 0] mm
    marker foot = [0, 0, -200] mm
    body rotor {
        mass = 20 kg
        inertia = [300, 300, 40] g*m^2
        marker neck = origin
        marker end = [0, 0, -200] mm
        start angular_velocity = [0, 0, 1]*speed
    }
    joint thrust = Spherical(rotor.end, foot)
    drive turn = PrescribedRotation(rotor.neck, axis, speed: speed)
    journal main[j in 1..1] = Short(pin: rotor.neck, shell: axis, diameter: 40 mm, width: 15 mm,
        radial_clearance: 20 um, viscosity: 20 mPa*s)
    cycle angle = rotation(rotor.neck, axis) { period = 360 deg }
    output weight[j in 1..1] = main[j].force.x as N
}
analysis slow = transient(Rotor(), duration: 2 rev, sample: 10 deg, start: assembled)
analysis fast = transient(Rotor(speed: 4000 rpm), duration: 2 rev, sample: 10 deg, start: assembled)
";

/// A pendulum, in an analysis and in a sweep.
const SWING: &str = "
use std.joints.Revolute
model Swing {
    param length: Length = 400 mm in (10 mm, 2 m)
    param load: Mass = 1 kg
    gravity = [0, -9.81, 0] m/s^2
    marker pivot = [0, 0, 0] mm
    body bob { mass = load; inertia = [2, 2, 2] g*m^2; marker top = [0, 1, 0]*length }
    joint pin = Revolute(bob.top, pivot)
    start pin.angle = 30 deg
    output height = dot(bob.origin.origin, ground.y) as mm
}
analysis one = transient(Swing(), duration: 100 ms, sample: 10 ms)
analysis two[l in [0.3, 0.4] m] = transient(Swing(length: l), duration: 100 ms, sample: 10 ms)
";

/// A folder of its own with a model, removed afterwards.
struct Folder(Temporary);

impl Folder {
    fn new(name: &str, model: &str) -> Folder {
        let folder = Temporary::new(&format!("command-{name}"));
        std::fs::write(folder.join("model.eng"), model).unwrap();
        Folder(folder)
    }

    fn path(&self, name: &str) -> String {
        self.0.join(name).to_string_lossy().into_owned()
    }

    fn files(&self, name: &str) -> Vec<String> {
        let mut names: Vec<String> = std::fs::read_dir(self.0.join(name))
            .unwrap()
            .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
            .collect();
        names.sort();
        names
    }

    /// Exit code, output and errors of a command on the model, with results in `out`.
    fn eng(&self, command: &str, arguments: &[&str]) -> (u8, String, String) {
        let (mut output, mut errors) = (Vec::new(), Vec::new());
        let mut words = vec!["eng".to_owned(), command.to_owned(), self.path("model.eng")];
        if command == "run" {
            words.extend(["--out".to_owned(), self.path("out")]);
        }
        words.extend(arguments.iter().map(ToString::to_string));
        let code = run_on(
            words.into_iter().map(Into::into),
            &mut Console {
                output: &mut output,
                errors: &mut errors,
                colored_output: false,
                colored_errors: false,
                live: false,
            },
        );
        let text = |bytes| {
            String::from_utf8(bytes)
                .unwrap()
                .replace(&self.path("out"), "OUT")
        };
        (code, text(output), text(errors))
    }
}

/// An output that fails after its first bytes.
struct Failing {
    with: io::ErrorKind,
    written: usize,
}

impl Write for Failing {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.written > 0 {
            return Err(self.with.into());
        }
        self.written += bytes.len();
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// Exit code and errors of a command whose output fails.
fn with_failing_output(with: io::ErrorKind, words: &[&str]) -> (u8, String) {
    let (mut output, mut errors) = (Failing { with, written: 0 }, Vec::new());
    let words = std::iter::once("eng").chain(words.iter().copied());
    let code = run_on(
        words.map(Into::into),
        &mut Console {
            output: &mut output,
            errors: &mut errors,
            colored_output: false,
            colored_errors: false,
            live: false,
        },
    );
    (code, String::from_utf8(errors).unwrap())
}

/// `eng … | head -1`: the work is done to its end, and the exit code is that of the work.
#[test]
fn a_closed_output_loses_no_work() {
    let folder = Folder::new("closed", SWING);
    let (model, out) = (folder.path("model.eng"), folder.path("out"));
    let run = ["run", model.as_str(), "--out", out.as_str(), "--no-plots"];
    let closed = io::ErrorKind::BrokenPipe;
    assert_eq!(with_failing_output(closed, &run).0, 0);
    let tables = ["one", "two", "two[1]", "two[2]"].map(|name| format!("{name}.parquet"));
    let files = folder.files("out");
    for table in &tables {
        assert!(files.contains(table), "{table} in {files:?}");
    }
    assert_eq!(
        with_failing_output(closed, &["explain"]),
        (0, String::new())
    );
    let (code, errors) = with_failing_output(io::ErrorKind::StorageFull, &["explain"]);
    assert_eq!(code, 2);
    assert!(errors.starts_with("error: the output: "), "{errors}");
}

#[test]
fn a_run_writes_files_and_prints_a_table() {
    let folder = Folder::new("run", ROTOR);
    let (code, output, errors) = folder.eng("run", &["--csv", "--threads", "1"]);
    assert_eq!((code, errors.as_str()), (0, ""));
    // numbers are those of other tests: here it is the form that counts
    let mut form = insta::Settings::clone_current();
    form.add_filter(r"\d+ steps.*", "[steps]");
    form.add_filter(r"energy: .*", "[energy]");
    form.bind(|| insta::assert_snapshot!(output));
    assert_eq!(folder.files("out"), files_of_two_analyses());
    let read = Results::read_parquet(Path::new(&folder.path("out/fast.parquet"))).unwrap();
    let speed = &read.metadata()["parameter.speed"];
    assert!(speed.starts_with("4000"), "{speed}");
    assert_eq!(read.samples(), 73);
}

#[test]
fn gradients_are_a_file_of_their_own() {
    use arrow_array::{Float64Array, StringArray};
    use parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;
    let folder = Folder::new("gradients", SWING);
    let run = ["--analysis", "one", "--no-plots", "--quiet"];
    let gradients = [
        "--gradients",
        "length",
        "--gradients",
        "load",
        "--channels",
        "height",
    ];
    let (code, _, errors) = folder.eng("run", &[&run[..], &gradients[..]].concat());
    assert_eq!((code, errors.as_str()), (0, ""));
    let path = folder.path("out/one.gradients.parquet");
    let file = std::fs::File::open(&path).unwrap();
    let mut reader = ParquetRecordBatchReaderBuilder::try_new(file)
        .unwrap()
        .build()
        .unwrap();
    let batch = reader.next().unwrap().unwrap();
    assert_eq!(batch.num_rows(), 2 * 11);
    let names: Vec<String> = batch
        .schema()
        .fields()
        .iter()
        .map(|f| f.name().clone())
        .collect();
    let due = [
        "parameter",
        "parameter_unit",
        "time",
        "time.gradient",
        "height",
    ];
    assert_eq!(names, due);
    assert_eq!(
        batch.schema().field(4).metadata()["unit"],
        "mm/parameter_unit"
    );
    let text = |name: &str, row: usize| {
        let column = batch.column_by_name(name).unwrap().as_any();
        column
            .downcast_ref::<StringArray>()
            .unwrap()
            .value(row)
            .to_owned()
    };
    assert_eq!(
        [text("parameter", 10), text("parameter_unit", 10)],
        ["length", "mm"]
    );
    assert_eq!(
        [text("parameter", 11), text("parameter_unit", 11)],
        ["load", "kg"]
    );
    // at the start the height is −l cos 30°
    let height = batch.column_by_name("height").unwrap().as_any();
    let slope = height.downcast_ref::<Float64Array>().unwrap().value(0);
    assert!((slope + 30f64.to_radians().cos()).abs() < 1e-9, "{slope}");
    // they are no results, and a run without gradients removes them
    assert!(Results::read(Path::new(&path)).is_err());
    let (code, _, errors) = folder.eng("run", &run);
    assert_eq!((code, errors.as_str()), (0, ""));
    assert!(!Path::new(&path).exists());
    let (code, _, errors) = folder.eng("run", &[&run[..], &["--gradients", "lenght"]].concat());
    assert_eq!(code, 2);
    assert!(
        errors.contains("--gradients: there is no parameter lenght"),
        "{errors}"
    );
}

/// The page and the reports of a later run read the gradients of an earlier one.
#[test]
fn reports_read_the_gradients_of_earlier_runs() {
    let text = SWING.replace(
        "sample: 10 ms)\nanalysis two",
        "sample: 10 ms, gradients: [length, load])\nanalysis two",
    );
    let report = "
report slopes {
    value by_length = gradient(minimum(one.height), length) as mm/m
    value by_load = gradient(minimum(one.height), load) as mm/kg
    value other = minimum(two[1].height)
    figure parts = tornado([gradient(minimum(one.height), length)*1 mm, gradient(minimum(one.height), load)*1 g])
}
";
    let folder = Folder::new("slopes", &(text + report));
    let (code, first, errors) = folder.eng("run", &["--analysis", "one", "--no-plots"]);
    assert_eq!((code, errors.as_str()), (0, ""));
    let line = |text: &str, name: &str| {
        let line = text.lines().find(|line| line.contains(name));
        line.unwrap_or_else(|| panic!("{text}")).trim().to_owned()
    };
    let (by_length, by_load) = (line(&first, "By length"), line(&first, "By load"));
    // at the start the height is −l cos 30°, and it falls a little from there
    assert!(by_length.ends_with("-868.7 mm/m"), "{by_length}");
    let (code, second, errors) = folder.eng("run", &["--analysis", "two", "--no-plots"]);
    assert_eq!((code, errors.as_str()), (0, ""));
    assert_eq!(
        (line(&second, "By length"), line(&second, "By load")),
        (by_length, by_load)
    );
    let (code, _, errors) = folder.eng("report", &["--results", &folder.path("out")]);
    assert_eq!((code, errors.as_str()), (0, ""));
    // gradients of another run of the analysis, or damaged ones, are refused
    let path = folder.path("out/one.gradients.parquet");
    let whole = std::fs::read(&path).unwrap();
    let (code, _, _) = folder.eng(
        "run",
        &[
            "--analysis",
            "one",
            "--quiet",
            "--no-plots",
            "--set",
            "length=500 mm",
        ],
    );
    assert_eq!(code, 0);
    for bytes in [&whole[..], &whole[..whole.len() / 2], b"none"] {
        std::fs::write(&path, bytes).unwrap();
        let (code, _, errors) = folder.eng("run", &["--analysis", "two", "--no-plots"]);
        assert_eq!(code, 2, "{errors}");
        assert!(
            errors.contains("holds no gradients of these results of one"),
            "{errors}"
        );
    }
}

fn files_of_two_analyses() -> Vec<String> {
    let mut names = Vec::new();
    for analysis in ["slow", "fast"] {
        names.extend(["csv", "parquet", "motion.parquet"].map(|kind| format!("{analysis}.{kind}")));
        for figure in ["journal-force-x", "journal-force-y", "orbits", "weight"] {
            names.extend(["png", "svg"].map(|kind| format!("{analysis}-{figure}.{kind}")));
        }
    }
    for figure in ["journal-force-x", "weight"] {
        names.extend(["png", "svg"].map(|kind| format!("slow-fast-{figure}.{kind}")));
    }
    names.sort();
    names
}

#[test]
fn quiet_and_no_plots() {
    let folder = Folder::new("quiet", SWING);
    let arguments = ["--analysis", "one", "--quiet", "--no-plots"];
    let (code, output, errors) = folder.eng("run", &arguments);
    assert_eq!((code, output.as_str(), errors.as_str()), (0, "", ""));
    assert_eq!(folder.files("out"), ["one.motion.parquet", "one.parquet"]);
}

#[test]
fn a_wrong_model_exits_with_1_and_is_not_run() {
    let folder = Folder::new(
        "wrong",
        "model Known { mass = 1 }\nanalysis a = assemble(Known())",
    );
    let (code, output, errors) = folder.eng("run", &[]);
    assert_eq!((code, output.as_str()), (1, ""));
    assert!(errors.contains("error[E"), "{errors}");
    assert_eq!(folder.files("."), ["model.eng"]);
    let (code, output, errors) = folder.eng("check", &[]);
    assert_eq!((code, errors.as_str()), (1, ""));
    assert!(output.contains("error[E"), "{output}");
    let (code, output, errors) = folder.eng("check", &["--format", "json"]);
    assert_eq!((code, errors.as_str()), (1, ""));
    let document: serde_json::Value = serde_json::from_str(&output).unwrap();
    assert_eq!(document["diagnostics"][0]["column"], 15);
}

#[test]
fn a_failed_run_exits_with_1_and_the_others_run() {
    // the limits of `length` refuse the first point alone
    let folder = Folder::new("failed", &SWING.replace("[0.3, 0.4] m", "[3, 0.4] m"));
    let (code, output, errors) = folder.eng("run", &["--no-plots"]);
    assert_eq!(code, 1);
    assert!(errors.contains("two[1] failed"), "{errors}");
    for name in ["one.parquet", "two[2].parquet"] {
        assert!(
            folder.files("out").iter().any(|file| file == name),
            "{output}"
        );
    }
}

#[test]
fn unknown_names_and_refused_files_exit_with_2() {
    let folder = Folder::new("names", SWING);
    let (code, _, errors) = folder.eng("run", &["--analysis", "unfired"]);
    assert_eq!(code, 2);
    assert!(
        errors.contains("no analysis unfired; it has one, two[1..2]"),
        "{errors}"
    );
    let (code, _, errors) = folder.eng("run", &["--set", "loud=1 kg"]);
    assert_eq!(code, 2);
    let told = "error: --set loud: there is no parameter loud; did you mean load?";
    assert_eq!(errors.trim(), told);
    assert_eq!(folder.files("out"), [""; 0], "nothing was run");
    std::fs::remove_dir_all(folder.path("out")).unwrap();
    std::fs::write(folder.path("out"), "not a folder").unwrap();
    let (code, _, errors) = folder.eng("run", &[]);
    assert_eq!(code, 2);
    assert!(errors.contains("OUT"), "{errors}");
    std::fs::remove_file(folder.path("model.eng")).unwrap();
    let (code, _, errors) = folder.eng("run", &[]);
    assert_eq!(code, 2);
    assert!(errors.starts_with("error: there is no file "), "{errors}");
}

#[test]
fn a_clean_check_says_so() {
    let folder = Folder::new("clean", SWING);
    let (code, output, errors) = folder.eng("check", &[]);
    assert_eq!((code, errors.as_str()), (0, ""));
    let lines: Vec<&str> = output.lines().collect();
    assert!(lines[0].starts_with("Swing: 1 body"), "{output}");
    assert_eq!(
        lines[1],
        "one: assembles; 6 velocities, 5 constraint equations, 1 freedom"
    );
    assert_eq!(lines.last(), Some(&"no errors, no warnings"));
}

/// The frequency lies beyond the response: the page and the terminal say so.
#[test]
fn a_report_tells_values_that_it_cannot_make() {
    let model = "
use std.joints.Translational
use std.forces.LinearSpring
force Push(a: Marker, b: Marker, load: Force) { apply force load*b.z on a against b }
model Cart {
    input push: Force = 0 N
    gravity = [0, 0, 0] m/s^2
    marker wall = [0, 0, 0] mm
    body block { mass = 2 kg; inertia = [1, 1, 1] g*m^2; marker eye = origin }
    joint rail = Translational(block.eye, wall)
    force spring = LinearSpring(block.eye, wall, stiffness: 3 N/mm, damping: 4 N*s/m, free_length: 100 mm)
    force drive = Push(block.eye, wall, load: push)
    start rail.travel = 100 mm
}
analysis s = response(Cart(), to: push, of: [rail.travel], from: 1 Hz, up_to: 100 Hz)
analysis t = transient(Cart(), duration: 10 ms, sample: 1 ms)
report r { value beyond = at_frequency(s.rail.travel, 300 Hz) }
";
    let folder = Folder::new("beyond", model);
    let (code, _, errors) = folder.eng("run", &["--no-plots"]);
    let due = "`beyond` of the report `r` is not made: s has no response at 300 Hz: it reaches from 1 to 100 Hz";
    assert_eq!(code, 1);
    assert!(errors.contains(due), "{errors}");
    let (code, _, errors) = folder.eng("report", &["--results", &folder.path("out")]);
    assert_eq!(code, 0);
    assert!(errors.contains(&format!("warning: {due}")), "{errors}");
}

/// `eng fmt` writes only files that may be written, and only texts that it can read.
#[test]
fn fmt_keeps_line_ends_and_read_only_files() {
    const MESSY: &str = "param bore:Length=86mm\r\n// end\r\n";
    const TIDY: &str = "param bore: Length = 86 mm\r\n// end\r\n";
    let folder = Folder::new("fmt", MESSY);
    let model = folder.path("model.eng");
    let lock = |locked: bool| {
        let mut rights = std::fs::metadata(&model).unwrap().permissions();
        rights.set_readonly(locked);
        std::fs::set_permissions(&model, rights).unwrap();
    };
    lock(true);
    let (code, _, errors) = folder.eng("fmt", &[]);
    assert_eq!(code, 2);
    assert!(errors.contains("read-only"), "{errors}");
    assert_eq!(std::fs::read_to_string(&model).unwrap(), MESSY);
    lock(false);
    assert_eq!(folder.eng("fmt", &[]).0, 0);
    assert_eq!(std::fs::read_to_string(&model).unwrap(), TIDY);
    assert_eq!(folder.eng("fmt", &["--check"]).0, 0);
    for (bytes, words) in [
        (&b"// \xe9\n"[..], "the byte 0xe9 in line 1, column 4"),
        (b"\xff\xfea\0", "UTF-16"),
        (b"// a\rparam b = 1\r", "carriage return"),
    ] {
        std::fs::write(&model, bytes).unwrap();
        for command in ["fmt", "check"] {
            let (code, output, errors) = folder.eng(command, &[]);
            assert!(code > 0, "{command}");
            let said = output + &errors;
            assert!(said.contains(words), "{command}: {said}");
        }
    }
}

#[test]
fn a_text_without_an_item_is_told() {
    for text in ["", "\u{feff}", "// model Rotor { }\n"] {
        let folder = Folder::new("empty", text);
        let (code, output, _) = folder.eng("check", &[]);
        assert_eq!(code, 0, "{text:?}");
        assert!(output.contains("W0202"), "{text:?}: {output}");
    }
    // a file for others to use
    let folder = Folder::new("functions", "fn twice(x: Length) -> Length = 2*x\n");
    let (code, output, _) = folder.eng("check", &[]);
    assert_eq!((code, output.as_str()), (0, "no errors, no warnings\n"));
}

#[cfg(unix)]
#[test]
fn a_model_that_may_not_be_read_is_no_wrong_model() {
    use std::os::unix::fs::PermissionsExt;
    let folder = Folder::new("locked", SWING);
    let model = folder.path("model.eng");
    std::fs::set_permissions(&model, std::fs::Permissions::from_mode(0o0)).unwrap();
    // the administrator reads everything
    if std::fs::File::open(&model).is_err() {
        let (code, _, errors) = folder.eng("run", &[]);
        assert_eq!(code, 2, "{errors}");
        assert!(errors.contains("model.eng: "), "{errors}");
    }
}

#[test]
fn numbers_that_are_none_are_told_in_plain_words() {
    let folder = Folder::new("numbers", SWING);
    for (words, told) in [
        (
            ["--tolerance", "-1"],
            "--tolerance: it must be positive and finite, not -1",
        ),
        (["--step", "-1us"], "--step: it must be positive and finite"),
        (["--threads", "0"], "give a whole number from 1"),
        (["--threads", "-2"], "give a whole number from 1"),
    ] {
        let (code, _, errors) = folder.eng("run", &words);
        assert_eq!(code, 2, "{errors}");
        assert!(
            errors.contains(told) && !errors.contains("-- -"),
            "{errors}"
        );
    }
    std::fs::remove_dir_all(&folder.0.0).unwrap();
    let (code, _, errors) = folder.eng("new", &[]);
    assert_eq!(code, 2);
    assert!(errors.contains("there is no folder"), "{errors}");
}
