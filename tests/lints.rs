//! Lints: each message states its name, and a text accepts it at its element, in a part, or for the whole
//! model.

use crate::support::Temporary;
use eng::assembled::Assembled;
use eng::render::{Colors, human};
use eng::report::Described;
use eng::{Program, Sources};

/// A file of its own in a folder of its own, removed afterwards.
struct Text(Temporary);

impl Text {
    fn new(name: &str, text: &str) -> Text {
        let folder = Temporary::new(&format!("lints-{name}"));
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

/// A text with a lint of a class on its parameters, one on its motion, one of a function, one on constants
/// and one of the language.
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

/// A lint with an index fails several times for one element: the message shows the values of all.
#[test]
fn a_lint_with_an_index_shows_each_index() {
    let text = "use std.joints.Revolute
force Springs(a: Marker, b: Marker, stiffness: TorsionalStiffness[n]) {
    advise[k in 1..n] soft: stiffness[k] < 1 N*m/rad else \"spring {k} has {stiffness[k] as N*m/rad}\"
    apply torque -sum(stiffness)*dot(cross(b.x, a.x), b.z)*b.z on a against b
}
model Swing {
    gravity = [0, 0, 0] m/s^2
    marker pivot = [0, 0, 0] mm
    body bob { mass = 1 kg; inertia = [1, 1, 1] kg*m^2; marker top = [0, 1, 0] m }
    joint pin = Revolute(bob.top, pivot)
    force few = Springs(bob.top, pivot, stiffness: [0.5, 2, 3] N*m/rad)
    force many = Springs(bob.top, pivot, stiffness: [2, 3, 4, 5, 6, 7] N*m/rad)
}
analysis run = transient(Swing(), duration: 1 ms, sample: 1 ms)
";
    let (said, _) = Text::new("indexed", text).check();
    assert_eq!(said.matches("`accept soft`").count(), 1, "{said}");
    for shown in [
        "few: spring 2 has 2 N*m/rad",
        "likewise: spring 3 has 3 N*m/rad",
        "likewise many",
    ] {
        assert!(said.contains(shown), "{shown}: {said}");
    }
    let text = text.replace(
        "    force few = Springs(bob.top, pivot, stiffness: [0.5, 2, 3] N*m/rad)\n",
        "",
    );
    let (said, _) = Text::new("many-indexed", &text).check();
    for shown in [
        "many: spring 1 has 2 N*m/rad",
        "likewise: spring 4 has 5 N*m/rad",
        "likewise 2 more",
    ] {
        assert!(said.contains(shown), "{shown}: {said}");
    }
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

/// A body on a mount with states: rubber that creeps yields by m g/k after a long time. A spring whose stretch is a state is known by
/// its states alone, so nothing is said.
#[test]
fn a_mount_with_states_sags() {
    let rubber = |stiffness: &str| {
        format!(
            "force mount = ElastomerMount(block.eye, foot, stiffness: [1, 1, 1]*{stiffness}, fast_stiffness: [0.5, 0.5, 0.5]*{stiffness},
        relaxation: 2 ms, torsional_stiffness: [30, 30, 30] kN*m/rad)"
        )
    };
    let stretch = "force mount = Stretch(block.eye, foot)".to_owned();
    for (index, (mount, due)) in [
        (rubber("300 N/mm"), None),
        (rubber("300 N/m"), Some("2616 mm")),
        (stretch, None),
    ]
    .into_iter()
    .enumerate()
    {
        let text = format!(
            "use std.mounts.ElastomerMount
force Stretch(a: Marker, b: Marker) {{
    state stretch: Length = 0 mm scale 1 mm
    der(stretch) = der(dot(a.origin - b.origin, b.z))
    apply force -(300 N/m*stretch + 0.1 N/m*dot(a.origin - b.origin, b.z))*b.z on a against b
}}
model Mounted {{
    gravity = [0, 0, -9.81] m/s^2
    marker foot = [0, 0, 0] mm
    body block {{ mass = 80 kg; inertia = [1, 1, 1] kg*m^2; marker eye = origin; marker top = [0, 0, 200] mm; accept unused }}
    {mount}
}}
analysis swings = transient(Mounted(), duration: 10 ms)
"
        );
        let (said, _) = Text::new(&format!("mounted-{index}"), &text).check();
        assert_eq!(said.contains("W0764"), due.is_some(), "{said}");
        assert!(due.is_none_or(|due| said.contains(due)), "{said}");
    }
}

/// A block on two mounts whose preloads have some share of its weight: right, with one or both signs wrong, with gravity upwards,
/// without preload, and far above the weight.
#[test]
fn a_preload_along_gravity_has_a_warning() {
    for (index, ([front, rear], gravity, due)) in [
        ([0.5, 0.5], -9.81, None),
        ([0.3, 0.7], -9.81, None),
        ([0.0, 0.0], -9.81, None),
        // one mount alone cannot be told from a pair of springs against each other if the sum is not the weight
        (
            [-0.5, 0.5],
            -9.81,
            Some("in the other direction the springs of block would carry its weight of 785 N"),
        ),
        (
            [-0.5, -0.5],
            -9.81,
            Some("push it along gravity with 785 N, and the weight that they carry is 785 N"),
        ),
        ([0.5, 0.5], 9.81, Some("push it along gravity with 785 N")),
        // springs against each other
        ([-4.0, 5.0], -9.81, None),
        ([-20.0, -20.0], -9.81, None),
    ]
    .into_iter()
    .enumerate()
    {
        let text = format!(
            "use std.mounts.ElastomerMount
model Mounted {{
    gravity = [0, 0, {gravity}] m/s^2
    marker foot[k in 1..2] = [[-200, 200][k], 0, 0] mm
    body block {{ mass = 80 kg; inertia = [4, 4, 4] kg*m^2; marker eye[k in 1..2] = [[-200, 200][k], 0, 0] mm }}
    force front = ElastomerMount(block.eye[1], foot[1], stiffness: [1, 1, 1]*200 N/mm, fast_stiffness: [1, 1, 1]*90 N/mm,
        relaxation: 2 ms, torsional_stiffness: [1, 1, 1]*8 kN*m/rad, preload: [0, 0, {front}]*(80 kg*9.81 m/s^2))
    force rear = ElastomerMount(block.eye[2], foot[2], stiffness: [1, 1, 1]*200 N/mm, fast_stiffness: [1, 1, 1]*90 N/mm,
        relaxation: 2 ms, torsional_stiffness: [1, 1, 1]*8 kN*m/rad, preload: [0, 0, {rear}]*(80 kg*9.81 m/s^2))
}}
analysis swings = transient(Mounted(), duration: 10 ms)
"
        );
        let (said, _) = Text::new(&format!("preloads-{index}"), &text).check();
        assert_eq!(said.contains("W0764"), due.is_some(), "{index}: {said}");
        assert!(due.is_none_or(|due| said.contains(due)), "{index}: {said}");
    }
}

/// A static term at a marker that no element loads has a warning with the name of the marker. An acceptance in the body covers it.
#[test]
fn a_static_term_without_load_has_a_warning() {
    for (index, (term, accepted, due)) in [
        ("static(at: tip)", "", false),
        (
            "static(at: tip) + static(at: side, freedoms: [x, y])",
            "",
            true,
        ),
        ("static(at: [tip, side])", "", true),
        (
            "static(at: tip) + static(at: side, freedoms: x)",
            "accept unloaded",
            false,
        ),
    ]
    .into_iter()
    .enumerate()
    {
        let text = format!(
            "use std.joints.Fixed
model Bar {{
    gravity = [-9.81, 0, 0] m/s^2
    flexible bar {{
        mesh = nastran(\"bar.bdf\", units: mm_tonne_s)
        support = foot
        modes = {term} + normal(3)
        damping = 1 %
        marker foot = patch(center: [0, 0, 0] mm, normal: z, radius: 15 mm, tie: rigid)
        marker tip = patch(center: [0, 0, 200] mm, normal: z, radius: 15 mm)
        marker side = patch(center: [10, 0, 100] mm, normal: x, radius: 15 mm)
        {accepted}
    }}
    body disc {{ mass = 0.5 kg; inertia = [0.4, 0.4, 0.7] g*m^2; marker hub = origin }}
    joint bolt = Fixed(disc.hub, bar.tip)
}}
analysis hang = assemble(Bar())
"
        );
        let folder = Text::new(&format!("unloaded-{index}"), &text);
        std::fs::write(folder.0.join("bar.bdf"), include_str!("mesh/bar.bdf")).expect("a mesh");
        let (said, _) = folder.check();
        let told = said.contains("bar: no element loads the marker `side` of this static term");
        assert_eq!(told, due, "{term}: {said}");
        assert!(due || !said.contains("W0505"), "{term}: {said}");
        assert!(!said.contains("accepts nothing"), "{term}: {said}");
    }
}

/// Loads that are zero at the start have their static mode: one that each of two parameters of zero switches on, and that is zero
/// again with both; one that two of three parameters switch on, and the third off; and one that is a state alone.
#[test]
fn a_load_that_is_zero_at_the_start_has_its_static_mode() {
    for (name, law) in [
        (
            "switched",
            "let stretch = dot(a.origin - b.origin, b.z)
    apply force (scale*stretch - off*stretch)*(1 kN/mm)*b.z on a against b",
        ),
        (
            "paired",
            "let way = dot(a.origin - b.origin, b.z)/(1 mm)
    apply force (scale*way - off*way)*(other*way)*(1 N)*b.z on a against b",
        ),
        (
            "state",
            "state push: Force = 0 N scale 10 N
    der(push) = (5 N - push)/(1 s)
    apply force (1 - off)*push*b.z on a against b",
        ),
    ] {
        let text = format!(
            "force Push(a: Marker, b: Marker, scale: 1 = 0, off: 1 = 0, other: 1 = 0) {{
    {law}
}}
model Bar {{
    gravity = [0, 0, 0] m/s^2
    flexible bar {{
        mesh = nastran(\"bar.bdf\", units: mm_tonne_s)
        support = foot
        modes = static(at: tip, freedoms: z) + normal(3)
        damping = 1 %
        marker foot = patch(center: [0, 0, 0] mm, normal: z, radius: 15 mm, tie: rigid)
        marker tip = patch(center: [0, 0, 200] mm, normal: z, radius: 15 mm)
    }}
    marker wall = [0, 0, 200] mm
    force push = Push(bar.tip, wall)
}}
analysis stands = assemble(Bar())
"
        );
        let folder = Text::new(&format!("late-{name}"), &text);
        std::fs::write(folder.0.join("bar.bdf"), include_str!("mesh/bar.bdf")).expect("a mesh");
        let (said, _) = folder.check();
        assert!(!said.contains("error"), "{name}: {said}");
        assert!(!said.contains("W0505"), "{name}: {said}");
    }
}

/// A message shows a list with the unit of its numbers.
#[test]
fn a_message_shows_lists() {
    let text = "model Shown {
    const order: Int[3] = [1, 3, 2]
    let places = [[10, 20] mm, [30, 40] mm]
    advise lists: length(order) > 3 else \"the order {order}, at {places as cm}\"
    gravity = [0, 0, 0] m/s^2
    body block { mass = 1 kg; inertia = [1, 1, 1] kg*m^2 }
}
analysis stands = assemble(Shown())
";
    let (said, _) = Text::new("lists", text).check();
    let due = "the order [1, 3, 2], at [[1 cm, 2 cm], [3 cm, 4 cm]]";
    assert!(said.contains(due), "{said}");
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

/// A slider-crank of throw 40 mm and rod 130 mm at 100 rad/s, whose piston's distance is an output. `lints`
/// stand in the model, `part` in the component around it, `class` in a force.
fn crank_with(class: &str, part: &str, lints: &str) -> String {
    format!(
        "use std.joints.{{Revolute, PointOnLine, Translational}}
use std.drives.PrescribedRotation
force Watched(piston: Marker, head: Marker, dead: Angle = 0 deg) {{
    let travel = dot(piston.origin - head.origin, head.z)
    let stroke = largest(travel) - smallest(travel)
    {class}
    apply force 0 N*head.z on piston against head
    output at = travel as mm
}}
component Mechanism(rail: Marker, bore: Marker, throw: Length) {{
    body crank {{
        mass = 10 kg
        inertia = [50, 50, 40] g*m^2
        marker main = origin
        marker pin = [1, 0, 0]*throw
        start angular_velocity = [0, 0, 100] rad/s
    }}
    body rod {{
        mass = 2 kg
        inertia = [0.6, 6, 6] g*m^2
        center_of_mass = [50, 0, 0] mm
        marker big = origin
        marker small = [130, 0, 0] mm
    }}
    body piston {{
        mass = 1.9 kg
        inertia = [2.5, 2, 2] g*m^2
        marker pin = origin
        marker crown = at(origin, z: [1, 0, 0])
    }}
    joint main = Revolute(crank.main, rail)
    drive turn = PrescribedRotation(crank.main, rail, speed: 100 rad/s)
    joint big_end = Revolute(rod.big, crank.pin)
    joint wrist = PointOnLine(rod.small, piston.pin)
    joint liner = Translational(piston.crown, bore) {{ branch travel > 0 mm }}
    force watched = Watched(piston.crown, bore)
    let stroke = largest(liner.travel) - smallest(liner.travel)
    {part}
}}
model Crank {{
    gravity = [0, 0, 0] m/s^2
    param throw: Length = 40 mm
    param longest: Length = 79.9 mm
    marker rail = [0, 0, 0] mm
    marker bore = at([0, 0, 0] mm, z: [1, 0, 0])
    part unit = Mechanism(rail, bore, throw)
    cycle angle = rotation(unit.crank.main, rail) {{ period = 720 deg }}
    {lints}
}}
analysis run = transient(Crank(), duration: 1 rev, sample: 5 deg)
"
    )
}

/// The numbers of a message after a word.
fn numbers_behind(said: &str, word: &str) -> Vec<f64> {
    let at = said
        .find(word)
        .unwrap_or_else(|| panic!("no {word}: {said}"));
    let line = said[at + word.len()..].lines().next().expect("a line");
    line.split_whitespace()
        .filter_map(|piece| piece.trim_matches([',', ';', ':']).parse().ok())
        .collect()
}

#[test]
fn lints_of_a_turn_have_the_extremes_of_the_mechanism() {
    let class = "advise long: stroke < 79.9 mm else \"Class {stroke as mm}\"
    advise dead: abs(wrapped(where_largest(travel) - dead, 360 deg)) > 1 deg else
        \"Dead {wrapped(where_largest(travel) - dead, 360 deg) as deg}\"";
    let part = "advise half: stroke < 79.9 mm else \"Part {stroke as mm}\"";
    let model = "let speed = dot(unit.piston.pin.velocity, bore.z)
    advise fast: max(largest(speed), -smallest(speed)) < 4 m/s else
        \"Speed {largest(speed) as m/s} , {smallest(speed) as m/s} , {where_largest(speed) as deg}\"
    advise quiet: largest(speed) < 1 km/s else \"never\"
    advise longer: largest(dot(unit.piston.pin.origin, bore.z)) < longest else \"reach {longest as mm}\"";
    let (said, _) = Text::new("turn", &crank_with(class, part, model)).check();
    let near = |found: f64, due: f64, within: f64| {
        assert!(
            (found - due).abs() <= within,
            "{found} instead of {due}: {said}"
        );
    };
    near(numbers_behind(&said, "Class")[0], 80.0, 2e-3);
    near(numbers_behind(&said, "Part")[0], 80.0, 2e-3);
    near(numbers_behind(&said, "Dead")[0], 0.0, 0.05);
    assert!(
        !said.contains("never") && said.contains("reach 79.9 mm"),
        "{said}"
    );
    // ẋ = −r ω (sin φ + λ sin 2φ/(2 √(1 − λ² sin² φ))), its least value by a fine search
    let (r, omega, ratio) = (0.04, 100.0, 40.0 / 130.0);
    let speed = |phi: f64| {
        let s = libm::sin(phi);
        let root = libm::sqrt(1.0 - ratio * ratio * s * s);
        -r * omega * (s + ratio * libm::sin(2.0 * phi) / (2.0 * root))
    };
    let angles = (0..72_000).map(|k| f64::from(k) * std::f64::consts::PI / 36_000.0);
    let fastest = angles.clone().map(speed).fold(f64::INFINITY, f64::min);
    let at = angles
        .max_by(|a, b| speed(*a).total_cmp(&speed(*b)))
        .expect("angles");
    let told = numbers_behind(&said, "Speed");
    near(told[0], -fastest, 2e-3 * fastest.abs());
    near(told[1], fastest, 2e-3 * fastest.abs());
    // the first of the two turns of the cycle
    near(told[2], at.to_degrees(), 0.2);
}

#[test]
fn lints_of_a_turn_follow_the_parameters_of_an_analysis() {
    let lint =
        "advise long: largest(dot(unit.piston.pin.origin, bore.z)) < 175 mm else \"too long\"";
    let text = crank_with("", "", lint);
    let (said, _) = Text::new("turn-short", &text).check();
    assert!(!said.contains("too long"), "{said}");
    let longer = text.replace("Crank(), duration", "Crank(throw: 50 mm), duration");
    let (said, _) = Text::new("turn-longer", &longer).check();
    assert!(said.contains("too long"), "{said}");
    let accepted = longer.replace("    param longest", "    accept long\n    param longest");
    let (said, assembled) = Text::new("turn-accepted", &accepted).check();
    assert!(!said.contains("too long"), "{said}");
    assert!(
        assembled
            .facts
            .iter()
            .any(|f| f.starts_with("accepted: long"))
    );
}

#[test]
fn a_piston_runs_too_fast_for_any_engine() {
    let engine = std::fs::read_to_string("examples/slider_crank/slider_crank.eng").expect("a file");
    let gas = "    force gas = GasPressure(piston.crown, head, bore: 100 mm, pressure: trace)
    marker head = at([300, 0, 0] mm, z: [1, 0, 0])
    cycle angle";
    let table = "use std.forces.GasPressure
table trace(theta: CrankAngle) -> AbsolutePressure = points([0, 20, 120, 600, 700] deg, [40, 60, 2, 1, 20] bar, interpolation: monotone, periodic: 720 deg)
model SliderCrank {";
    let engine = engine
        .replace("    cycle angle", gas)
        .replace("model SliderCrank {", table)
        .replace("period = 360 deg", "period = 720 deg");
    let (said, _) = Text::new("piston-slow", &engine).check();
    assert!(!said.contains("piston runs"), "{said}");
    let fast = engine.replace("= 2000 rpm", "= 8000 rpm");
    let (said, _) = Text::new("piston-fast", &fast).check();
    // r ω √(1 + λ²) to within a percent
    let due = 0.0685 * 8000.0 * std::f64::consts::PI / 30.0 * libm::hypot(1.0, 68.5 / 207.0);
    let told = numbers_behind(&said, "the piston runs at");
    assert!((told[0] / due - 1.0).abs() < 0.01, "{said}");
}

/// A machine that does not assemble has no lints of its start, so nothing tells whether it needs an acceptance of one.
#[test]
fn an_acceptance_is_kept_if_the_machine_does_not_assemble() {
    let model = |angle: &str| {
        format!(
            "use std.joints.Revolute
            use std.drives.PrescribedRotation
            model Wheel {{
                gravity = [0, 0, 0] m/s^2
                accept loose
                marker hub = [0, 0, 0] mm
                body disc {{ mass = 1 kg; inertia = [1, 1, 1] g*m^2; marker eye = origin }}
                joint pin = Revolute(disc.eye, hub)
                drive spin = PrescribedRotation(disc.eye, hub, speed: 100 rpm)
                start pin.angle = {angle} deg
            }}
            analysis run = transient(Wheel(), duration: 10 ms, sample: 1 ms)"
        )
    };
    let (open, _) = Text::new("open", &model("30")).check();
    assert!(open.contains("E0703") && !open.contains("W0750"), "{open}");
    let (closed, _) = Text::new("closed", &model("0")).check();
    assert!(closed.contains("W0750"), "{closed}");
}

/// A condition inside of a part of the library fails by a number of the user's text: the user's line of the part comes first, and the
/// text of the library after it.
#[test]
fn a_condition_inside_of_a_part_shows_the_line_that_makes_the_part() {
    let text = "use std.valvetrain.Valve
        model Bench {
            gravity = [0, 0, 0] m/s^2
            marker seat = at([0, 0, 0] mm, z: [0, 1, 0])
            part valve = Valve(seat, valve_mass: 80 g, installed: 35 mm, stem_height: 38 mm, stiffness: -5 N/mm, free_length: 45 mm,
                seat_stiffness: 50 N/um, seat_damping: 2 kN*s/m)
        }
        analysis run = transient(Bench(), duration: 1 ms, sample: 1 ms)";
    let (said, _) = Text::new("part", text).check();
    // the lint of the part itself, and that of its spring
    for title in ["valve: the spring presses", "valve.spring: a stiffness of"] {
        let message = said.split("\n\n").find(|part| part.contains(title));
        let message = message.unwrap_or_else(|| panic!("{title}: {said}"));
        let part = message.find("valve: in this part").expect("the part");
        let library = message.find("std/").expect("the library");
        assert!(part < library, "{message}");
    }
}
