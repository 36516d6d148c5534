//! Lints: each message states its name, and a text accepts it at its element, in a part, or for the whole
//! model.

use eng::assembled::Assembled;
use eng::render::{Colors, human};
use eng::report::Described;
use eng::{Program, Sources};
use std::path::PathBuf;

/// A file of its own in a folder of its own, removed afterwards.
struct Text(PathBuf);

impl Text {
    fn new(name: &str, text: &str) -> Text {
        let folder = std::env::temp_dir().join(format!("eng-lints-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a folder");
        std::fs::write(folder.join("model.eng"), text).expect("a file");
        Text(folder)
    }

    /// The output of `eng check`: messages and facts.
    fn check(&self) -> (String, Assembled) {
        let checked = eng::check(&Sources::folder(&self.0).expect("a folder"), "model.eng");
        let program = checked.program().expect("a sound model");
        let assembled = program.assemble().expect("a sound model");
        let report = checked.report();
        let mut all = report.diagnostics().clone();
        all.extend(assembled.diagnostics.clone());
        (human(&all, report.texts(), Colors::None), assembled)
    }

    fn program(&self) -> Program {
        eng::check(&Sources::folder(&self.0).expect("a folder"), "model.eng")
            .into_program()
            .expect("a sound model")
    }
}

impl Drop for Text {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// A text with a lint of a class on its parameters, one on its motion, one of a function, one on constants and one of the language.
fn text(class: &str, function: &str, part: &str, body: &str, model: &str) -> String {
    format!(
        "use std.joints.Revolute
fn doubled(x: 1) -> 1 {{
    advise small: x < 1 else \"a factor of {{x}} is large\"
    2*x
}}
force Spring(a: Marker, b: Marker, stiffness: TorsionalStiffness, factor: 1) {{
    advise soft: stiffness < 1 N*m/rad else \"a stiffness of {{stiffness as N*m/rad}} is large\"
    advise near: dot(a.x, b.x) > 0.9 else \"far\"
    apply torque -doubled(factor)*stiffness*dot(cross(b.x, a.x), b.z)*b.z on a against b
}}
component Bob(count: Int) {{
    advise few: count < 2 else \"{{count}} are many\"
    marker pivot = [0, 0, 0] mm
    body bob {{
        mass = 1 kg
        inertia = [1, 1, 1] kg*m^2
        marker top = [0, 1, 0] m
        marker end = [0, -1, 0] m
        marker low = [0, -3, 0] m
        {body}
    }}
    joint pin = Revolute(bob.top, pivot)
    force spring = Spring(bob.top, pivot, stiffness: 2 N*m/rad, factor: 3) {{ {class}; {function} }}
    output ends = norm(bob.end.origin - bob.low.origin)
}}
model Swing {{
    gravity = [0, -20, 0] m/s^2
    part one[i in 1..2] = Bob(count: 3) {{ {part} }}
    start one[1].pin.angle = 60 deg
    {model}
}}
analysis run = transient(Swing(), duration: 1 ms, sample: 1 ms)
analysis again = transient(Swing(), duration: 2 ms, sample: 1 ms)
"
    )
}

const NAMES: [&str; 5] = ["soft", "near", "small", "few", "gravity"];

/// Names of the lints in the messages.
fn told(text: &str) -> Vec<&'static str> {
    let named = |name: &&str| text.contains(&format!("`accept {name}`"));
    NAMES.into_iter().filter(named).collect()
}

#[test]
fn every_lint_is_told_once_with_its_name() {
    let (said, assembled) = Text::new("told", &text("", "", "", "", "")).check();
    assert_eq!(told(&said), NAMES, "{said}");
    for name in NAMES {
        assert_eq!(
            said.matches(&format!("`accept {name}`")).count(),
            1,
            "{said}"
        );
    }
    // two instances and two analyses
    assert!(
        said.contains("one[1].spring, one[2].spring: a stiffness of 2 N*m/rad is large"),
        "{said}"
    );
    assert!(!assembled.facts.iter().any(|f| f.starts_with("accepted")));
}

#[test]
fn a_lint_is_accepted_where_it_stands_in_a_part_or_in_the_model() {
    let cases = [
        (text("accept soft", "", "", "", ""), "soft"),
        (text("", "accept small", "", "", ""), "small"),
        (text("", "", "accept few", "", ""), "few"),
        (text("", "", "accept soft", "", ""), "soft"),
        (text("", "", "accept near", "", ""), "near"),
        (text("", "", "", "", "accept few"), "few"),
        (text("", "", "", "", "accept gravity"), "gravity"),
    ];
    for (text, name) in cases {
        let (said, assembled) = Text::new(&format!("accepted-{name}"), &text).check();
        let left: Vec<&str> = NAMES.into_iter().filter(|n| *n != name).collect();
        assert_eq!(told(&said), left, "{name}: {said}");
        assert!(!said.contains("W0750"), "{said}");
        let listed = assembled
            .facts
            .iter()
            .filter(|f| f.starts_with("accepted: "));
        // lints that are known when the text is compiled are no longer counted here
        assert_eq!(
            listed.count(),
            usize::from(name != "few"),
            "{name}: {:?}",
            assembled.facts
        );
    }
}

#[test]
fn an_acceptance_that_nothing_needs_is_told() {
    let text = text(
        "accept fast_is_no_lint",
        "accept loose",
        "",
        "accept small",
        "",
    );
    let (said, _) = Text::new("needless", &text).check();
    assert_eq!(said.matches("warning[W0550]").count(), 1, "{said}");
    // `loose` of the spring and `small` of the body; the warning that is no lint appears once
    assert_eq!(said.matches("warning[W0750]").count(), 2, "{said}");
    assert_eq!(told(&said), NAMES, "{said}");
}

#[test]
fn a_report_lists_what_is_accepted() {
    let text = Text::new("report", &text("accept soft", "", "", "", "accept near"));
    let program = text.program();
    let analysis = program.analysis("run").expect("an analysis");
    let ran = eng::run::run(&analysis, false, &mut |_| {}).expect("a run");
    let described: Vec<Described> = program.describe(&[&ran.results]).expect("a model");
    assert_eq!(
        described[0].accepted,
        [
            "near of Swing".to_owned(),
            "soft of one[1].spring, one[2].spring: a stiffness of 2 N*m/rad is large".to_owned()
        ]
    );
    let codes: Vec<&str> = ran.diagnostics.iter().map(|d| d.code).collect();
    assert!(!codes.contains(&"W0711"), "`near` is accepted: {codes:?}");
}

/// A weight on a slanted spring swings aside by far more than the spring is stretched. Only its stretch, m
/// g/k, counts.
#[test]
fn a_pendulum_on_a_spring_does_not_sag() {
    let of = |stiffness: &str| {
        format!(
            "use std.forces.LinearSpring
model Pendulum {{
    gravity = [0, 0, -9.81] m/s^2
    marker base = [0, 0, 0] mm
    body bob {{ mass = 1.5 kg; inertia = [1, 1, 1] g*m^2; marker hook = origin; start position = [300, 100, -900] mm }}
    force spring = LinearSpring(bob.hook, base, stiffness: {stiffness}, free_length: 950 mm, damping: 0.5 N*s/m)
}}
analysis swings = transient(Pendulum(), duration: 10 ms)
"
        )
    };
    for (index, (stiffness, due)) in [
        ("30000 N/m", None),
        ("300 N/m", None),
        ("20 N/m", Some("736 mm")),
    ]
    .into_iter()
    .enumerate()
    {
        let (said, _) = Text::new(&format!("pendulum-{index}"), &of(stiffness)).check();
        assert_eq!(said.contains("W0764"), due.is_some(), "{said}");
        assert!(due.is_none_or(|due| said.contains(due)), "{said}");
    }
}

/// A torsional spring between axes that are `tilt` degrees apart, with an acceptance or none.
fn across(tilt: f64, accepted: &str) -> String {
    let (sine, cosine) = tilt.to_radians().sin_cos();
    format!(
        "use std.joints.Revolute
use std.forces.TorsionSpring
model Spring {{
    gravity = [0, 0, 0] m/s^2
    marker axis = origin
    marker end = at(origin, z: [{sine}, 0, {cosine}])
    body disc {{ mass = 1 kg; inertia = [5, 6, 7] g*m^2; marker hub = origin }}
    joint pivot = Revolute(disc.hub, axis)
    force shaft = TorsionSpring(disc.hub, end, stiffness: 10 N*m/rad) {{ {accepted} }}
}}
analysis run = transient(Spring(), duration: 1 ms)
"
    )
}

#[test]
fn an_angle_about_an_axis_across_the_shaft_is_askew() {
    for (tilt, told) in [
        (0.0, false),
        (4.9, false),
        (5.1, true),
        (90.0, true),
        (174.9, true),
        (175.1, false),
    ] {
        let (said, _) = Text::new(&format!("askew{tilt}"), &across(tilt, "")).check();
        assert_eq!(said.contains("W0766"), told, "{tilt}: {said}");
    }
    let (said, _) = Text::new("askew", &across(90.0, "accept askew")).check();
    assert_eq!(said, "");
}

#[test]
fn a_pin_across_its_shell_is_askew() {
    for (axis, told) in [("[0, 0, 1]", false), ("[1, 0, 0]", true)] {
        let text = format!(
            "use std.journals.Short
model Shaft {{
    gravity = [0, 0, 0] m/s^2
    marker shell = at(origin, z: {axis})
    body shaft {{ mass = 1 kg; inertia = [5, 6, 7] g*m^2; marker pin = origin; start rotation = [0, 0, 0] deg; start angular_velocity = [0, 0, 600] rpm }}
    journal film = Short(pin: shaft.pin, shell: shell, diameter: 50 mm, width: 20 mm, radial_clearance: 25 um, viscosity: 12 mPa*s)
}}
analysis run = transient(Shaft(), duration: 1 ms)
"
        );
        let (said, _) = Text::new(&format!("pin{told}"), &text).check();
        assert_eq!(said.contains("W0766"), told, "{said}");
    }
}
