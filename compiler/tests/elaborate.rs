//! Elaboration of small models: counts, paths, numbers, shared classes.

use eng_compiler::elaborate::{Elaborated, analyses, elaborate};
use eng_compiler::resolve::resolve;
use eng_grammar::{Diagnostics, SourceMap};
use eng_system::code::BindCode;
use eng_system::host::{Host, HostError};
use eng_system::system::{AnalysisKind, Extent, Role};

#[test]
fn factors_behind_units_are_values() {
    let model = r#"
use units.*
unit bolt = 3 kg
model Numbers {
    const reach = 5 mm
    const two = 2
    require abs(2 N/mm*reach*two - 20 N) < 1e-12 N else "a product"
    require abs(1/2 N*two - 1/(1 N)) < 1e-12/(1 N) else "behind a quotient"
    require abs(3 N/(reach*two)*reach^2 - 7.5e-3 N*m) < 1e-15 N*m else "a bracket"
    require abs(2 N*reach^(1/2)*two^-1*reach^(1/2) - 5e-3 N*m) < 1e-15 N*m else "powers"
    require abs(2 m*bolt - 6 m*kg) < 1e-12 m*kg else "a unit of this file"
    require abs(2 m*nut - 10 m*kg) < 1e-12 m*kg else "a unit of a file that is read later"
    body block { mass = 1 kg*two; inertia = [1, 1, 1] g*m^2 }
}
"#;
    let host = Texts(vec![
        ("root.eng", format!("use later.*\n{model}")),
        (
            "later.eng",
            "use units.*\nlet early = 2 m*nut\nuse last.*".into(),
        ),
        ("last.eng", "use units.*\nunit nut = 5 kg".into()),
        ("units.eng", UNITS.into()),
    ]);
    let mut sources = SourceMap::new();
    let mut diagnostics = Diagnostics::new();
    let program = resolve("root.eng", &host, &[], &mut sources, &mut diagnostics);
    let typed = eng_compiler::check::check(program, &sources, &mut diagnostics);
    assert!(!diagnostics.has_errors(), "{diagnostics:?}");
    let model = typed
        .program
        .lookup(typed.program.root(), "Numbers")
        .expect("the model");
    let made = elaborate(&typed, &mut sources, &host, model, &[], &mut diagnostics);
    assert!(
        made.is_some() && !diagnostics.has_errors(),
        "{diagnostics:?}"
    );
}

struct Texts(Vec<(&'static str, String)>);

impl Host for Texts {
    fn read_text(&self, path: &str) -> Result<String, HostError> {
        self.0
            .iter()
            .find(|(name, _)| *name == path)
            .map(|(_, text)| text.clone())
            .ok_or_else(|| HostError::NotFound(path.into()))
    }
}

const UNITS: &str = r#"
dimension Length
dimension Mass
dimension Time
dimension Angle
dimension Velocity = Length/Time
dimension AngularVelocity = Angle/Time
dimension Force = Mass*Length/Time^2
dimension Stiffness = Force/Length
dimension MomentOfInertia = Mass*Length^2
unit m: Length
unit kg: Mass
unit s: Time
unit rad: Angle
unit mm = 1e-3 m
unit g = 1e-3 kg
unit N = 1 kg*m/s^2
unit deg = pi/180 rad
unit rpm = 2*pi/60 rad/s
"#;

const MODEL: &str = r#"
joint Revolute(a: Marker, b: Marker) {
    constrain a.origin == b.origin
    constrain dot(b.z, a.x) == 0
    constrain dot(b.z, a.y) == 0
    branch dot(a.z, b.z) > 0
    output angle = rotation(a, b) as deg
    output speed = der(angle)
}
force Spring(a: Marker, b: Marker, stiffness: Stiffness, free: Length = 10 mm) {
    require free > 0 mm else "free length {free as mm}"
    let d = a.origin - b.origin
    let length = norm(d, floor: 1e-9 m)
    output tension = stiffness*(length - free)
    apply force -tension/length*d on a against b
}
model Chain {
    const count = 3
    param step: Length = 100 mm in (1 mm, 1 m)
    gravity = [0, -9.81, 0] m/s^2
    body link[i in 1..count] {
        mass = 2 kg
        inertia = [1, 2, 2] g*m^2
        marker tail = [-1, 0, 0]*step/2
        marker head = [1, 0, 0]*step/2
    }
    marker wall = [0, 0, 0] mm
    joint first = Revolute(link[1].tail, wall)
    joint pin[i in 2..count] = Revolute(link[i].tail, link[i - 1].head)
    force spring = Spring(link[count].head, wall, stiffness: 5 N/mm)
    start first.angle = 30 deg
    output bend[i in 2..count] = pin[i].angle - 1 deg
    output reach = norm(link[count].head.origin) as mm
    cycle angle = rotation(link[1].tail, ground) { period = 720 deg }
}
analysis swing = transient(Chain(step: 50 mm), duration: 1 s, sample: 1 deg)
analysis long[n in 2..4] = assemble(Chain(count: n))
"#;

fn run(model: &str) -> (Option<Elaborated>, Diagnostics, usize) {
    let host = Texts(vec![("chain.eng", model.to_owned())]);
    let library = [("std.prelude", UNITS)];
    let mut sources = SourceMap::new();
    let mut diagnostics = Diagnostics::new();
    let program = resolve("chain.eng", &host, &library, &mut sources, &mut diagnostics);
    let typed = eng_compiler::check::check(program, &sources, &mut diagnostics);
    let plans = analyses(&typed, &mut sources, &host, &mut diagnostics);
    let Some(plan) = plans.first() else {
        return (None, diagnostics, 0);
    };
    assert_eq!(plan.analysis.origin.path, "swing");
    assert_eq!(plan.analysis.set, [("step".to_owned(), 0.05)]);
    match &plan.analysis.kind {
        AnalysisKind::Transient(t) => {
            assert_eq!(t.duration, Extent::Time(1.0));
            assert!(matches!(t.sample, Extent::Angle(a) if (a - 1f64.to_radians()).abs() < 1e-15));
        }
        other => panic!("swing is a transient, not {other:?}"),
    }
    let made = elaborate(
        &typed,
        &mut sources,
        &host,
        plan.model,
        &plan.constants,
        &mut diagnostics,
    );
    (made, diagnostics, plans.len())
}

#[test]
fn a_chain_becomes_a_flat_system() {
    let (made, diagnostics, plans) = run(MODEL);
    let errors: Vec<_> = diagnostics.iter().filter(|d| d.is_error()).collect();
    assert!(errors.is_empty(), "{errors:#?}");
    let made = made.expect("no errors, so a system");
    assert_eq!(plans, 4);
    let system = &made.system;
    assert_eq!(system.bodies.len(), 3);
    let dynamic: Vec<_> = system
        .elements
        .iter()
        .filter(|e| e.role == Role::Dynamic)
        .collect();
    assert_eq!(dynamic.len(), 4);
    // three revolutes share one class
    assert_eq!(dynamic[0].class, dynamic[1].class);
    assert_eq!(dynamic[1].class, dynamic[2].class);
    let revolute = &system.classes[dynamic[0].class as usize];
    assert_eq!(revolute.rows.len(), 5);
    assert_eq!(revolute.rows[0].text, "a.origin == b.origin (x)");
    assert_eq!(revolute.layout.rotations, 1);
    assert_eq!(revolute.layout.constants, 0);
    let paths: Vec<&str> = system.channels.iter().map(|c| c.path.as_str()).collect();
    for wanted in [
        "first.angle",
        "pin[2].force.x",
        "spring.tension",
        "bend[3]",
        "reach",
    ] {
        assert!(paths.contains(&wanted), "{wanted} is not in {paths:?}");
    }
    let force = system
        .channels
        .iter()
        .find(|c| c.path == "pin[2].force.x")
        .expect("a channel");
    assert_eq!(force.frame, "link[1].head");
    assert_eq!(force.display.symbol, "N");
    assert!(system.cycle.is_some());
}

#[test]
fn parameters_bind_by_path() {
    let (made, _, _) = run(MODEL);
    let made = made.expect("a system");
    let index = |path: &str| {
        made.system
            .parameters
            .iter()
            .position(|p| p.origin.path == path)
            .unwrap_or_else(|| panic!("no parameter {path}"))
    };
    let mut overrides = vec![None; made.system.parameters.len()];
    let before = made
        .bind
        .bind(&overrides, &made.system.tables)
        .expect("defaults fit");
    assert!((before.parameters[index("spring.stiffness")] - 5000.0).abs() < 1e-9);
    assert_eq!(before.parameters[index("spring.free")], 0.01);
    let head = made
        .system
        .markers
        .iter()
        .find(|m| m.origin.path == "link[2].head")
        .expect("a marker");
    assert!((before.slots[head.position[0].0 as usize] - 0.05).abs() < 1e-15);
    overrides[index("step")] = Some(0.3);
    let after = made
        .bind
        .bind(&overrides, &made.system.tables)
        .expect("fits");
    assert!((after.slots[head.position[0].0 as usize] - 0.15).abs() < 1e-15);
    overrides[index("step")] = Some(2.0);
    let error = made
        .bind
        .bind(&overrides, &made.system.tables)
        .expect_err("outside its limits");
    assert_eq!(
        error.to_string(),
        "step = 2000 mm is outside its limits: it must be above 1 mm and below 1000 mm"
    );
    overrides[index("step")] = None;
    overrides[index("spring.free")] = Some(-0.02);
    let error = made
        .bind
        .bind(&overrides, &made.system.tables)
        .expect_err("a require fails");
    assert_eq!(error.to_string(), "spring: free length -20 mm");
}

/// A condition may choose one of two conditions by a parameter.
#[test]
fn a_condition_chooses_between_conditions() {
    let model = MODEL.replace(
        "require free > 0 mm else",
        "require if stiffness > 6 N/mm then free > 5 mm else free > 2 mm else",
    );
    let (made, diagnostics, _) = run(&model);
    let errors: Vec<_> = diagnostics.iter().filter(|d| d.is_error()).collect();
    assert!(errors.is_empty(), "{errors:#?}");
    let made = made.expect("no errors, so a system");
    let index = |path: &str| {
        let mut parameters = made.system.parameters.iter();
        parameters
            .position(|parameter| parameter.origin.path == path)
            .unwrap_or_else(|| panic!("no parameter {path}"))
    };
    for (stiffness, free, holds) in [
        (5e3, 3e-3, true),
        (5e3, 1e-3, false),
        (7e3, 6e-3, true),
        (7e3, 3e-3, false),
    ] {
        let mut overrides = vec![None; made.system.parameters.len()];
        overrides[index("spring.stiffness")] = Some(stiffness);
        overrides[index("spring.free")] = Some(free);
        let bound = made.bind.bind(&overrides, &made.system.tables);
        assert_eq!(bound.is_ok(), holds, "{stiffness} N/m, {free} m");
    }
}

/// A text that the checker refuses is elaborated nevertheless: an internal error at the place, never a
/// default or a panic.
#[test]
fn what_the_checks_should_have_found_is_an_internal_error() {
    for (wrong, place) in [
        ("mass = 2 kg", "mass = tons"),
        ("inertia = [1, 2, 2] g*m^2", "inertia = 3 g*m^2"),
        ("gravity = ", "levity = "),
        ("start first.angle", "start count"),
        (
            "output reach = norm(link[count].head.origin)",
            "output reach = wall",
        ),
        ("{ period = 720 deg }", "{ }"),
    ] {
        let text = MODEL.replacen(wrong, place, 1);
        assert_ne!(text, MODEL, "{wrong}");
        let (made, diagnostics, _) = run(&text);
        assert!(made.is_none(), "{place}");
        let codes: Vec<&str> = diagnostics
            .iter()
            .filter(|d| d.is_error())
            .map(|d| d.code)
            .collect();
        assert!(
            codes.contains(&eng_compiler::codes::INTERNAL),
            "{place}: {diagnostics:#?}"
        );
    }
}

/// The order of the text does not matter: an element is made after those that it needs.
#[test]
fn an_element_may_need_one_that_stands_after_it() {
    let force = "force twist = Twist(link[1].head, wall, turn: pin[3].angle)\n    joint first";
    let class = "force Twist(a: Marker, b: Marker, turn: Angle) { apply force cos(turn)*1 N*a.x on a against b }\nmodel Chain";
    let text = MODEL
        .replacen("joint first", force, 1)
        .replacen("model Chain", class, 1);
    let (made, diagnostics, _) = run(&text);
    let errors: Vec<_> = diagnostics.iter().filter(|d| d.is_error()).collect();
    assert!(errors.is_empty(), "{errors:#?}");
    let system = made.expect("a system").system;
    let twist = system
        .elements
        .iter()
        .find(|e| e.origin.path == "twist")
        .expect("an element");
    // the two markers of its own and those of the joint that it measures
    assert_eq!(twist.markers.len(), 4);
}

/// The type of a list states the dimension of its sum. A sum of whole numbers is whole.
#[test]
fn the_sum_of_an_empty_list_is_zero() {
    let model = MODEL
        .replace(
            "model Chain {",
            "fn total(loads: Force[n]) -> Force = sum(loads)\nmodel Chain {",
        )
        .replace(
            "const count = 3",
            "const count = 3
    const one = 1 + sum(k for k in 3..1)
    require total([]) == 0 N else \"a parameter\"
    require sum(1 mm for k in 3..1) + 2 mm == 2 mm else \"a list of lengths\"
    marker spare[i in 1..one] = [0, 0, 0] mm",
        );
    let (made, diagnostics, _) = run(&model);
    let errors: Vec<_> = diagnostics.iter().filter(|d| d.is_error()).collect();
    assert!(errors.is_empty(), "{errors:#?}");
    let made = made.expect("no errors, so a system");
    assert_eq!(made.system.repeated["spare"], [[1]]);
}

/// The value of a parameter with all defaults of a model, by its path.
fn default_of(made: &Elaborated, path: &str) -> f64 {
    let none = vec![None; made.system.parameters.len()];
    let bound = made.bind.bind(&none, &made.system.tables).expect("it fits");
    let paths = made.system.parameters.iter().map(|p| &p.origin.path);
    let (_, value) = paths
        .zip(&bound.parameters)
        .find(|(known, _)| *known == path)
        .expect("a parameter");
    *value
}

/// The checker finds the parameter of an argument, and elaboration uses it.
#[test]
fn arguments_go_where_the_checker_reads_them() {
    let text = MODEL
        .replace("Chain(step: 50 mm)", "Chain(4, 50 mm)")
        // a value does not hide the function of its name
        .replace("const count = 3", "const count = 3\n    let norm = 2");
    let (made, diagnostics, _) = run(&text);
    let errors: Vec<_> = diagnostics.iter().filter(|d| d.is_error()).collect();
    assert!(errors.is_empty(), "{errors:#?}");
    assert_eq!(made.expect("a system").system.bodies.len(), 4);
}

/// The model with a record of sizes and the declarations that use it.
fn with_sizes(declared: &str) -> String {
    let record = "record Sizes {\n    let first: Length = 1 mm\n    let second: Length\n}";
    MODEL
        .replace("model Chain {", &format!("{record}\nmodel Chain {{"))
        .replace(
            "const count = 3",
            &format!("const count = 3\n    {declared}"),
        )
}

/// `first` has a default, and comes before the field that has none.
#[test]
fn a_record_takes_its_fields_in_order_and_an_analysis_hands_on_all() {
    let text = with_sizes("const sizes = Sizes(second: 60 mm)")
        .replace(
            "param step: Length = 100 mm",
            "param step: Length = sizes.first",
        )
        .replace(
            "Chain(step: 50 mm)",
            "Chain(step: 50 mm, sizes: Sizes(70 mm, 60 mm))",
        );
    let (made, diagnostics, _) = run(&text);
    let errors: Vec<_> = diagnostics.iter().filter(|d| d.is_error()).collect();
    assert!(errors.is_empty(), "{errors:#?}");
    assert_eq!(default_of(&made.expect("a system"), "step"), 0.07);
}

/// A parameter that is a record or a vector has a path for each number.
#[test]
fn an_analysis_sets_the_numbers_of_records_and_vectors() {
    let declared = "param sizes: Sizes = Sizes(second: 60 mm)
    param spot: Vector<Length> = [1, 2, 3] mm";
    let text = with_sizes(declared).replace(
        "assemble(Chain(count: n))",
        "assemble(Chain(count: n, sizes: Sizes(70 mm, 60 mm), spot: [4, 5, 6] mm))",
    );
    let host = Texts(vec![("chain.eng", text)]);
    let library = [("std.prelude", UNITS)];
    let mut sources = SourceMap::new();
    let mut diagnostics = Diagnostics::new();
    let program = resolve("chain.eng", &host, &library, &mut sources, &mut diagnostics);
    let typed = eng_compiler::check::check(program, &sources, &mut diagnostics);
    let plans = analyses(&typed, &mut sources, &host, &mut diagnostics);
    assert!(!diagnostics.has_errors(), "{diagnostics:?}");
    let set = &plans.last().expect("an analysis").analysis.set;
    let due = [
        ("sizes.first", 0.07),
        ("sizes.second", 0.06),
        ("spot[1]", 0.004),
        ("spot[2]", 0.005),
        ("spot[3]", 0.006),
    ];
    assert_eq!(set.len(), due.len());
    for ((path, value), (due_path, due)) in set.iter().zip(due) {
        assert_eq!(path, due_path);
        assert!((value - due).abs() < 1e-15, "{path}: {value}");
    }
    let made = elaborate(
        &typed,
        &mut sources,
        &host,
        plans[0].model,
        &plans[0].constants,
        &mut diagnostics,
    );
    let made = made.expect("a system");
    for (path, _) in due {
        let mut parameters = made.system.parameters.iter();
        assert!(parameters.any(|p| p.origin.path == path), "{path}");
    }
}

/// A marker in the axes of another one of its body: place and axes follow, and a turn is about its own axis.
#[test]
fn markers_stand_in_the_axes_of_other_markers() {
    let text = MODEL.replace(
        "model Chain {",
        "model Chain {\n    marker liner = at([10, 20, 30] mm, z: [0, 1, 0], x: [0, 0, 1])\n    marker seat = at([1, 2, 3] mm, in: liner, about: z, by: 90 deg)\n    output seat_x = dot(seat.x, liner.y)\n",
    );
    let (made, diagnostics, _) = run(&text);
    let errors: Vec<_> = diagnostics.iter().filter(|d| d.is_error()).collect();
    assert!(errors.is_empty(), "{errors:#?}");
    let made = made.expect("a system");
    let none = vec![None; made.system.parameters.len()];
    let bound = made.bind.bind(&none, &made.system.tables).expect("it fits");
    let seat = made
        .system
        .markers
        .iter()
        .find(|m| m.origin.path == "seat")
        .expect("a marker");
    let value = |slot: &eng_system::system::Slot| bound.slots[slot.0 as usize];
    // the liner's axes in the ground: x is z, y is x, z is y
    let place: Vec<f64> = seat.position.iter().map(value).collect();
    for (found, exact) in place.iter().zip([12e-3, 23e-3, 31e-3]) {
        assert!((found - exact).abs() < 1e-15, "{place:?}");
    }
    // turned about the liner's z: x is the liner's y, y the opposite of its x
    let axes: Vec<f64> = seat.orientation.iter().map(value).collect();
    for (found, exact) in axes
        .iter()
        .zip([1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, -1.0, 0.0])
    {
        assert!((found - exact).abs() < 1e-15, "{axes:?}");
    }
}

/// A marker stands in the axes of another one of its body wherever that one stands in the text.
#[test]
fn a_marker_may_stand_in_the_axes_of_a_later_one() {
    let markers = [
        "marker liner = at([10, 20, 30] mm, z: [0, 1, 0], x: [0, 0, 1])",
        "marker seat = at([1, 2, 3] mm, in: liner)",
    ];
    for [first, second] in [markers, [markers[1], markers[0]]] {
        let text = MODEL.replace(
            "model Chain {",
            &format!("model Chain {{\n    body block {{ mass = 1 kg; inertia = [1, 1, 1] g*m^2; {first}; {second} }}\n"),
        );
        let (made, diagnostics, _) = run(&text);
        let errors: Vec<_> = diagnostics.iter().filter(|d| d.is_error()).collect();
        assert!(errors.is_empty(), "{errors:#?}");
        let made = made.expect("a system");
        let none = vec![None; made.system.parameters.len()];
        let bound = made.bind.bind(&none, &made.system.tables).expect("it fits");
        let mut markers = made.system.markers.iter();
        let seat = markers.find(|m| m.origin.path == "block.seat");
        let seat = seat.expect("a marker").position;
        for (found, exact) in seat.iter().zip([12e-3, 23e-3, 31e-3]) {
            let found = bound.slots[found.0 as usize];
            assert!((found - exact).abs() < 1e-15, "{found} {exact}");
        }
    }
}

/// A component without arguments needs no parentheses where it is defined.
#[test]
fn a_component_needs_no_parentheses() {
    for head in ["component Weight {", "component Weight() {"] {
        let text = MODEL
            .replace(
                "model Chain {",
                &format!("{head} body lead {{ mass = 1 kg; inertia = [1, 1, 1] g*m^2 }} }}\nmodel Chain {{"),
            )
            .replace("const count = 3", "const count = 3\n    part weight = Weight()");
        let (made, diagnostics, _) = run(&text);
        let errors: Vec<_> = diagnostics.iter().filter(|d| d.is_error()).collect();
        assert!(errors.is_empty(), "{errors:#?}");
        let bodies = &made.expect("a system").system.bodies;
        assert_eq!(bodies.len(), 4);
        assert!(bodies.iter().any(|b| b.origin.path == "weight.lead"));
    }
}
