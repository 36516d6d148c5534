//! `eng explain` as a process.

use std::process::{Command, Output};
use std::sync::atomic::{AtomicUsize, Ordering};

fn eng(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_eng"))
        .args(arguments)
        .output()
        .expect("the command starts")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

#[test]
fn a_code_is_explained_with_an_example() {
    for written in ["E0301", "e0301"] {
        let output = eng(&["explain", written]);
        assert_eq!(output.status.code(), Some(0));
        assert_eq!(
            text(&output.stdout),
            "E0301: a number has no unit where a quantity is expected\n\
             \n\
             Every quantity has a unit. A zero needs one, too.\n\
             \n\
             wrong:\n    param bore: Length = 86\n\
             right:\n    param bore: Length = 86 mm\n"
        );
    }
}

#[test]
fn every_code_is_listed_and_explained() {
    let list = text(&eng(&["explain"]).stdout);
    let listed: Vec<&str> = list.lines().filter_map(|l| l.split(' ').next()).collect();
    let known: Vec<&str> = eng::codes::all().iter().map(|code| code.code).collect();
    assert_eq!(listed, known);
    for code in eng::codes::all() {
        let mut written = Vec::new();
        let exit = explain(code.code, &mut written);
        let written = text(&written);
        assert_eq!(exit, 0, "{}", code.code);
        assert!(written.starts_with(&format!("{}: {}\n\n", code.code, code.title)));
        assert!((3..=24).contains(&written.lines().count()), "{written}");
        let width = written.lines().map(|line| line.chars().count()).max();
        assert!(width <= Some(160), "{written}");
    }
}

/// In this process, because a process for each code would take too long.
fn explain(code: &str, output: &mut Vec<u8>) -> u8 {
    let mut console = eng::cli::Console {
        output,
        errors: &mut Vec::new(),
        colored_output: false,
        colored_errors: false,
        live: false,
    };
    eng::cli::run_on(["eng", "explain", code].map(Into::into), &mut console)
}

#[test]
fn arguments_are_explained_by_their_kinds() {
    for (argument, kind) in [("gradients", "transient"), ("inputs", "linear")] {
        let mut written = Vec::new();
        assert_eq!(explain(argument, &mut written), 0);
        let begin = format!("`{argument}` is an argument of the analysis `{kind}`: ");
        let written = text(&written).replace('\n', " ");
        assert!(written.contains(&begin), "{written}");
    }
}

#[test]
fn an_unknown_code_is_answered_by_the_nearest() {
    for (asked, near) in [("E301", "E0301"), ("E0O1", "E01"), ("w501", "W0501")] {
        let output = eng(&["explain", asked]);
        assert_eq!(output.status.code(), Some(2), "{asked}");
        assert!(output.stdout.is_empty());
        let errors = text(&output.stderr);
        assert!(errors.contains(&format!("did you mean {near}")), "{errors}");
    }
    // another number is another code
    for asked in ["nothing", "E9999"] {
        let output = eng(&["explain", asked]);
        assert_eq!(output.status.code(), Some(2));
        assert_eq!(
            text(&output.stderr),
            format!(
                "error: `{asked}` is no code, word, function, analysis, figure, lint or name of the library\n\
                 `eng explain` lists all codes; `eng explain MODEL.eng {asked}` looks in a model\n"
            )
        );
    }
}

/// The tables of analyses and figures give the name and the meaning of each argument.
#[test]
fn analyses_and_figures_are_explained() {
    let output = eng(&["explain", "periodic"]);
    assert_eq!(output.status.code(), Some(0));
    let told = text(&output.stdout);
    assert!(
        told.starts_with("`periodic` is an analysis: the last cycle of a run that continues"),
        "{told}"
    );
    assert!(
        told.contains("\n    sample (deg)  the sampling interval, 0.5° by default\n"),
        "{told}"
    );
    for row in eng_system::figure::KINDS {
        let output = eng(&["explain", row.name]);
        assert_eq!(output.status.code(), Some(0));
        let told = text(&output.stdout);
        assert!(
            told.starts_with(&format!("`{}` is a figure: ", row.name)),
            "{told}"
        );
        for argument in row.arguments {
            assert!(told.contains(argument.about), "{told}");
        }
    }
}

/// Functions give their forms and their meaning.
#[test]
fn functions_are_explained() {
    let output = eng(&["explain", "norm"]);
    assert_eq!(output.status.code(), Some(0));
    assert!(
        text(&output.stdout).starts_with("`norm(v)`, `norm(v, floor: f)`: the length of a vector")
    );
    let output = eng(&["explain", "wrapped"]);
    assert!(
        text(&output.stdout)
            .starts_with("`wrapped(angle, period, from: -180 deg)`: the angle less")
    );
}

/// Words, built-in names, modules, lints and items of interfaces are explained.
#[test]
fn words_modules_and_lints_are_explained() {
    for (asked, told) in [
        (
            "place",
            vec!["`place` is a word of the language: `place a on b` in a class"],
        ),
        ("joint", vec!["a class of constraints between markers"]),
        ("input", vec!["changes during a run"]),
        ("pi", vec!["3.14159"]),
        ("time", vec!["the time since the start"]),
        (
            "std.engine",
            vec![
                "std.engine: a module of the library",
                "Engine",
                "a component",
            ],
        ),
        (
            "loose",
            vec!["`loose` is a lint: nothing holds a body", "`accept loose`"],
        ),
        ("usual", vec!["usual: a lint of `", "advise usual: "]),
        (
            "Impedance.minimum_film",
            vec!["an output of `std.journals`", "output minimum_film"],
        ),
    ] {
        let output = eng(&["explain", asked]);
        assert_eq!(output.status.code(), Some(0), "{asked}");
        let found = text(&output.stdout);
        for part in told {
            assert!(found.contains(part), "{asked}: no {part} in\n{found}");
        }
    }
}

const SWING: &str = "use std.joints.Revolute
use std.forces.TorsionSpring
model Swing {
    param stiffness: TorsionalStiffness = 3 N*m/rad
    marker pivot = [0, 0, 0] mm
    body bob {
        mass = 1.2 kg
        inertia = [2, 2, 2] g*m^2
        marker top = [0, 400, 0] mm
    }
    joint pin = Revolute(bob.top, pivot)
    force spring = TorsionSpring(bob.top, pivot, stiffness: stiffness, damping: 2 N*m*s/rad)
    output height = dot(bob.origin.origin, ground.y) as mm
    input push: Force = 0 N
    part leg[i in 1..2] = Leg(pivot)
}
component Leg(top: Marker) {
    body bone { mass = 1 kg; inertia = [1, 1, 1] g*m^2; marker end = [0, 1, 0] m; marker hole[i in 1..2] = [0, 0, i] mm }
    joint hip = Revolute(bone.end, top)
    output swing = hip.angle as deg
}
analysis swing = transient(Swing(), duration: 1 s)
";

/// Runs `eng explain` on a file with the model.
fn part(path: &[&str]) -> Output {
    // tests run at the same time, so each call has a folder of its own
    let number = CALLS.fetch_add(1, Ordering::Relaxed);
    let name = format!("eng-explain-{}-{number}", std::process::id());
    let folder = std::env::temp_dir().join(name);
    std::fs::create_dir_all(&folder).expect("a folder");
    let file = folder.join("swing.eng");
    std::fs::write(&file, SWING).expect("the model");
    let mut arguments = vec!["explain", file.to_str().expect("a name")];
    arguments.extend(path);
    let output = eng(&arguments);
    std::fs::remove_dir_all(&folder).expect("the folder");
    output
}

static CALLS: AtomicUsize = AtomicUsize::new(0);

#[test]
fn a_part_of_a_model_is_explained() {
    let told = |path: &[&str]| {
        let output = part(path);
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        text(&output.stdout)
    };
    let list = told(&[]);
    for line in [
        "bob",
        "pin          Revolute",
        "spring       TorsionSpring  swing.eng:12",
    ] {
        assert!(list.contains(line), "{line} in {list}");
    }
    let spring = told(&["spring"]);
    for line in [
        "spring: a force of the class TorsionSpring, which fills DampingLaw",
        "force spring = TorsionSpring(bob.top, pivot, stiffness: stiffness",
        "a       bob.top  bob",
        "b       pivot    ground",
        "damping     2 N*m*s/rad  swing.eng:12",
        "takes no freedom; applies loads that depend on velocities",
        "twist       deg",
        "    interface DampingLaw {",
        "    /// Spring and damper about b.z.",
        "        apply torque moment*b.z on a against b",
    ] {
        assert!(spring.contains(line), "{line} in {spring}");
    }
    let leg = told(&["leg[1]"]);
    for line in [
        "leg[1]: a part\n",
        "leg[1].bone  body      swing.eng:18",
        "leg[1].hip   Revolute  swing.eng:19",
        "outputs: leg[1].swing\n",
    ] {
        assert!(leg.contains(line), "{line} in {leg}");
    }
    assert!(told(&["leg"]).starts_with("leg: several items\n"));
    assert!(
        told(&["leg[2].swing"])
            .starts_with("leg[2].swing: an output of the part leg[2], stated at")
    );
    assert!(told(&["leg[1].bone.hole"]).contains("leg[1].bone.hole[2]  marker"));
    let pin = told(&["pin"]);
    assert!(pin.contains("takes 5 freedoms\n"), "{pin}");
    assert_eq!(pin.matches("std/joints.eng:").count(), 6, "{pin}");
    for (path, line) in [
        (
            "bob",
            "bob: a rigid body with six freedoms, stated at swing.eng:6\n  mass 1.2 kg",
        ),
        ("bob", "bob.top      0  400   0  pin and spring"),
        ("bob.top", "at [0, 400, 0] mm of its body"),
        (
            "bob.origin",
            "bob.origin: a marker on bob, which every body has\n",
        ),
        (
            "stiffness",
            "stiffness: a parameter, 3 N*m/rad, stated at swing.eng:4",
        ),
        ("pin.force", "pin.force.y in N, along pivot"),
        (
            "height",
            "height: an output of the model Swing, stated at swing.eng:13",
        ),
        ("push", "push: an input, 0 N, stated at swing.eng:14"),
    ] {
        assert!(told(&[path]).contains(line), "{line} in {}", told(&[path]));
    }
}

/// The error names the range. The text of the item would look as if the index were there.
#[test]
fn an_index_out_of_range_is_refused() {
    for (asked, told) in [
        (
            "leg[3]",
            "there is no leg[3] in the model: the indices of leg are 1 to 2",
        ),
        (
            "leg[0].hip",
            "there is no leg[0] in the model: the indices of leg are 1 to 2",
        ),
        (
            "leg[1].bone.hole[9]",
            "there is no leg[1].bone.hole[9] in the model: the indices of leg[1].bone.hole are 1 to 2",
        ),
        (
            "pin[1]",
            "there is no pin[1] in the model: pin has no index",
        ),
        (
            "leg[1].bone[1].hole[1]",
            "there is no leg[1].bone[1] in the model: leg[1].bone has no index",
        ),
    ] {
        let output = part(&[asked]);
        assert_eq!(output.status.code(), Some(2), "{asked}");
        assert_eq!(text(&output.stdout), "", "{asked}");
        let errors = text(&output.stderr);
        assert!(errors.contains(told), "{errors}");
    }
}

#[test]
fn a_path_that_a_model_has_not_is_refused() {
    let output = part(&["sprign"]);
    assert_eq!(output.status.code(), Some(2));
    let errors = text(&output.stderr);
    assert!(
        errors.contains("there is no sprign in the model; did you mean spring?"),
        "{errors}"
    );
    let output = eng(&["explain", "E0301", "main[1]"]);
    assert_eq!(output.status.code(), Some(2));
    let errors = text(&output.stderr);
    assert!(
        errors.contains("`eng explain MODEL.eng main[1]`"),
        "{errors}"
    );
}

/// Definitions of a text and of the library give their kind, place, comment and text.
#[test]
fn definitions_are_explained() {
    let folder = std::env::temp_dir().join(format!("eng_explained_{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    let model = folder.join("rig.eng");
    let written = "/// The springs.\nconst count = 2\nchoice Side = left | right\nunit dash = 3 mm\n\
        record Size { let a: Length }\nfn twice(x: Length) -> Length = 2*x\n\
        model Rig {\n    param reach: Length = 3 mm\n    let far = twice(reach)\n    gravity = [0, 0, 0] m/s^2\n    \
        body bob { mass = 1 kg; inertia = [1, 1, 1] g*m^2 }\n    output seen = far*count as mm\n}\n\
        analysis run = assemble(Rig())\n";
    std::fs::write(&model, written).expect("written");
    let path = model.to_str().expect("a path");
    for (name, begin) in [
        (
            "count",
            "count: a constant, stated at rig.eng:2\n    /// The springs.\n    const count = 2\n",
        ),
        (
            "right",
            "right: a choice, stated at rig.eng:3\n    choice Side = left | right\n",
        ),
        (
            "dash",
            "dash: a unit, stated at rig.eng:4\n    unit dash = 3 mm\n",
        ),
        (
            "Size",
            "Size: a record, stated at rig.eng:5\n    record Size { let a: Length }\n",
        ),
        ("twice", "twice: a function, stated at rig.eng:6\n"),
        (
            "far",
            "far: a value, stated at rig.eng:9\n    let far = twice(reach)\n",
        ),
        ("Rig.far", "Rig.far: a value, stated at rig.eng:9\n"),
        (
            "run",
            "run: an analysis, stated at rig.eng:14\n    analysis run = assemble(Rig())\n",
        ),
        ("Rig", "model Rig\n"),
        (
            "Revolute",
            "Revolute: a joint of `std.joints`, stated at std/joints.eng:",
        ),
    ] {
        let output = eng(&["explain", path, name]);
        assert_eq!(text(&output.stderr), "", "{name}");
        let told = text(&output.stdout);
        assert!(told.starts_with(begin), "{name}: {told}");
    }
    for (name, begin) in [
        ("mm", "mm: a unit of `std.units`, stated at std/units.eng:"),
        (
            "std.joints.Screw",
            "std.joints.Screw: a joint of `std.joints`, stated at ",
        ),
        (
            "Stiffness",
            "Stiffness: a dimension of `std.units`, stated at ",
        ),
    ] {
        let told = text(&eng(&["explain", name]).stdout);
        assert!(told.starts_with(begin), "{name}: {told}");
    }
    // a wrong name has its own answer
    let output = eng(&["explain", path, "nowhere"]);
    assert!(!output.status.success());
    assert!(text(&output.stderr).starts_with("error: there is no nowhere in the model"));
    std::fs::remove_dir_all(&folder).expect("removed");
}

/// Items that a condition leaves out are explained from the text, with the conditions of all items on their path.
#[test]
fn items_that_are_left_out_are_explained() {
    let folder = std::env::temp_dir().join(format!("eng_left_out_{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    let model = folder.join("shaft.eng");
    let written = "use std.joints.Revolute
component Pulley(hub: Marker, damped: Bool = true) {
    body ring if damped {
        mass = 0.8 kg
        inertia = [2, 2, 4] g*m^2
        marker bore = origin
    }
    joint bush if damped = Revolute(ring.bore, hub)
}
model Shaft {
    const pulleys = 2
    gravity = [0, -9.81, 0] m/s^2
    marker bearing = [0, 0, 0] mm
    body shaft { mass = 5 kg; inertia = [30, 30, 10] g*m^2; marker hub[i in 1..2] = [0, 0, 50*i] mm; marker seat = origin }
    joint hinge = Revolute(shaft.seat, bearing)
    part pulley[i in 1..2] if i <= pulleys = Pulley(shaft.hub[i], damped: i == 1)
}
analysis run = assemble(Shaft())
";
    std::fs::write(&model, written).expect("written");
    let path = model.to_str().expect("a path");
    for (name, lines) in [
        (
            "pulley[2].bush",
            [
                "pulley[2].bush: a joint, stated at shaft.eng:8\n",
                "    joint bush if damped = Revolute(ring.bore, hub)\n",
                "  pulley[2] exists only where `i <= pulleys` holds\n",
                "  it exists only where `damped` holds\n",
            ],
        ),
        (
            "pulley[2].ring.bore",
            [
                "pulley[2].ring.bore: a marker, stated at shaft.eng:6\n",
                "    marker bore = origin\n",
                "  pulley[2] exists only where `i <= pulleys` holds\n",
                "  pulley[2].ring exists only where `damped` holds\n",
            ],
        ),
    ] {
        let output = eng(&["explain", path, name]);
        assert_eq!(text(&output.stderr), "", "{name}");
        let found = text(&output.stdout);
        for line in lines {
            assert!(found.contains(line), "{name}: no {line} in\n{found}");
        }
    }
    // an index beyond the range is not one that the condition leaves out
    let output = eng(&["explain", path, "pulley[3].bush"]);
    assert_eq!(output.status.code(), Some(2));
    // what exists is explained by its numbers, and an item that the text has not is refused
    let output = eng(&["explain", path, "pulley[1].bush"]);
    let found = text(&output.stdout);
    assert!(found.contains("takes 5 freedoms\n"), "{found}");
    let output = eng(&["explain", path, "pulley[2].brush"]);
    assert_eq!(output.status.code(), Some(2));
    std::fs::remove_dir_all(&folder).expect("removed");
}
