//! Numbers of models whose classes share texts, lengths and values: the text of an interface holds in each
//! class.

use crate::support::program;

/// The first values of columns of the analysis `r`.
fn first<'a>(text: &str, columns: &[(&'a str, f64)]) -> Vec<(&'a str, f64)> {
    let outcome = program(text)
        .analysis("r")
        .expect("an analysis")
        .run(&mut |_| {})
        .unwrap_or_else(|failed| panic!("{}", failed.error));
    columns
        .iter()
        .map(|(name, _)| {
            let column = outcome.results.column(name);
            let column = column.unwrap_or_else(|| panic!("no column {name}"));
            (*name, column.values[0])
        })
        .collect()
}

fn assert_first(text: &str, columns: &[(&str, f64)]) {
    for ((name, found), (_, due)) in first(text, columns).into_iter().zip(columns) {
        assert!(
            (found - due).abs() < 1e-12 * due.abs(),
            "{name}: {found} instead of {due}"
        );
    }
}

/// An array decides the length for its class and its interface, by an argument or by its default. A class
/// reads the states of its interface and gives their rates. Defaults may name later parameters.
#[test]
fn lengths_states_and_defaults_reach_every_text_of_a_class() {
    let text = "
interface Counts { param n: Int = 2; param w: Length[n] = [1, 2] mm }
component Repeated() : Counts { output o = sum(w) as mm }
interface Arrays { param w: Length[n]; output twice = 2*n }
component Inherits() : Arrays { output o = sum(w)/n as mm }
component Repeats(w: Length[n], c: Length[n]) : Arrays { output o = sum(w)/n + c[n] as mm }
component Usual(w: Length[n] = [1, 2] mm) { output o = sum(w)/n as mm }
force Pushes(a: Marker, w: Length[n] = [1, 2] mm) {
    apply force [0, 0, 1] N*sum(w)/(1 mm)/n on a
    output many[i in 1..n] = i*w[i] as mm
    output along[i in 2..3] = i*a.x in ground
}
component Later(x: Length = 2*y, y: Length = 2 mm) { output o = x as mm }
force LaterForce(a: Marker, x: Force = 2*y, y: Force = 2 N) { apply force [0, 0, 1]*x on a; output o = x as N }
interface Decays { param a: Marker; state p: Force = 3 N; apply force [0, 0, 1]*p on a }
force Slow() : Decays { der(p) = -p/(1 s); output load = p as N; output rate = der(p) as N/s }
const numbers = [1, 2, 3] mm
const rows = [[1, 2, 3], [4, 5, 6]] mm
model Bench {
    accept loose
    gravity = [0, 0, -9.81] m/s^2
    body block { mass = 2 kg; inertia = [4, 4, 4] g*m^2 }
    part repeated = Repeated(n: 3, w: [1, 2, 3] mm)
    part inherits = Inherits(w: [1, 2, 3] mm)
    part repeats = Repeats([1, 2] mm, [3, 4] mm)
    part usual = Usual()
    force pushes = Pushes(block.origin)
    part later = Later()
    part given = Later(y: 3 mm)
    force later_force = LaterForce(block.origin)
    force slow = Slow(block.origin)
    output of_range = sum(numbers[2..3]) as mm
    output column = sum(rows[*, 2]) as mm
    output row = sum(rows[2, *]) as mm
    output corner = sum(rows[1..2, 3]) as mm
    output many = sum(pushes.many) as mm
    output last = pushes.many[2] as mm
    output third = pushes.along[3].x
}
analysis r = transient(Bench(), duration: 1 ms, sample: 1 ms)
";
    let columns = [
        ("repeated.o", 6e-3),
        ("inherits.o", 2e-3),
        ("inherits.twice", 6.0),
        ("repeats.o", 5.5e-3),
        ("repeats.twice", 4.0),
        ("usual.o", 1.5e-3),
        ("pushes.many[1]", 1e-3),
        ("pushes.many[2]", 4e-3),
        ("pushes.along[3].x", 3.0),
        ("later.o", 4e-3),
        ("given.o", 6e-3),
        ("later_force.o", 4.0),
        ("slow.load", 3.0),
        ("slow.rate", -3.0),
        ("of_range", 5e-3),
        ("column", 7e-3),
        ("row", 15e-3),
        ("corner", 9e-3),
        ("many", 5e-3),
        ("last", 4e-3),
        ("third", 3.0),
    ];
    assert_first(text, &columns);
}

/// The mass of a body is a value of the model, also as an argument.
#[test]
fn the_mass_of_a_body_is_a_mass() {
    let text = "
fn weight(x: Mass) -> Force = x*9.81 m/s^2
component Heavy(load: Mass) { output o = load*1 m/s^2 as N }
model Bench {
    accept loose
    gravity = [0, 0, -9.81] m/s^2
    body block { mass = 2 kg; inertia = [4, 4, 4] g*m^2 }
    body rod[i in 1..3] { mass = i*1 kg; inertia = [4, 4, 4] g*m^2 }
    output pull = weight(block.mass)
    output all = sum(rod[*].mass) as kg
    output second = rod[2].mass as g
    part heavy = Heavy(2*rod[3].mass)
}
analysis r = transient(Bench(), duration: 1 ms, sample: 1 ms)
";
    let columns = [
        ("pull", 19.62),
        ("all", 6.0),
        ("second", 2.0),
        ("heavy.o", 6.0),
    ];
    assert_first(text, &columns);
}

/// A use through an interface has the order of the interface, for any order of the class and any arguments
/// that the class has already.
#[test]
fn arguments_through_an_interface_follow_its_order() {
    let text = "
interface Law { param a: Marker; param near: Force; param far: Force; output o: Force }
force Turned(far: Force, gain: 1, near: Force, a: Marker) : Law { apply force [0, 0, 1]*near on a; output o: Force = gain*(far - near) as N }
component Use(a: Marker, law: Law = Turned(gain: 10)) { force f = law(a, 1 N, 3 N) }
component Named(a: Marker, law: Law) { force f = law(a, far: 3 N, near: 1 N) }
model Bench {
    accept loose
    gravity = [0, 0, -9.81] m/s^2
    body block { mass = 2 kg; inertia = [4, 4, 4] g*m^2 }
    part one = Use(block.origin)
    part two = Named(block.origin, Turned(gain: 20))
}
analysis r = transient(Bench(), duration: 1 ms, sample: 1 ms)
";
    assert_first(text, &[("one.f.o", 20.0), ("two.f.o", 40.0)]);
}

/// A component may state the cycle: its angle is known in parts before it, in durations and in samples.
#[test]
fn a_component_states_the_cycle() {
    let text = "
use std.joints.Revolute
force Brake(a: Marker, b: Marker) { apply torque -1 N*m*cycle.angle/(1 rad)*b.z on a against b; output angle = cycle.angle as deg }
component Before(a: Marker, b: Marker) { force brake = Brake(a, b) }
component Crank(at: Marker) {
    body web { mass = 2 kg; inertia = [4, 4, 4] g*m^2; marker main = origin }
    joint hinge = Revolute(web.main, at)
    cycle angle = rotation(web.main, at) { period = 720 deg }
    start hinge.angle = 30 deg
    start der(hinge.angle) = 100 rad/s
}
model Bench {
    gravity = [0, -9.81, 0] m/s^2
    marker seat = [0, 0, 0] mm
    part before = Before(crank.web.main, seat)
    part crank = Crank(seat)
}
analysis r = transient(Bench(), duration: 0.1 rev, sample: 6 deg)
";
    let program = program(text);
    let analysis = program.analysis("r").expect("an analysis");
    let outcome = analysis.run(&mut |_| {});
    let outcome = outcome.unwrap_or_else(|failed| panic!("{}", failed.error));
    let angles = &outcome
        .results
        .column("before.brake.angle")
        .expect("an angle")
        .values;
    let due: Vec<f64> = (0..=6)
        .map(|k| (30.0 + 6.0 * f64::from(k)).to_radians())
        .collect();
    assert_eq!(angles.len(), due.len());
    for (found, due) in angles.iter().zip(due) {
        assert!((found - due).abs() < 1e-6, "{found} instead of {due}");
    }
}

/// A law whose depth is an argument, and the same law that computes it: the rate of the argument is exact
/// through the call.
#[test]
fn a_class_differentiates_its_argument() {
    let text = |parameters: &str, own: &str, argument: &str| {
        format!(
            "use std.joints.Revolute
fn height(a: Length) -> Length = a + a^3/(1 m^2)
force Cushion(a: Marker, b: Marker{parameters}) {{
    {own}
    let push = -(2 N/mm*depth + 30 N*s/m*der(depth))
    apply force push*ground.y on a against b
    output rate = der(depth) as m/s
}}
model Swing {{
    gravity = [0, -9.81, 0] m/s^2
    marker pivot = [0, 0, 0] mm
    body bob {{ mass = 1 kg; inertia = [1, 1, 1] g*m^2; marker top = [0, 0.4, 0] m }}
    joint pin = Revolute(bob.top, pivot)
    let drop = dot(bob.origin.origin - pivot.origin, ground.y)
    force cushion = Cushion(bob.origin, pivot{argument})
    start pin.angle = 60 deg
}}
analysis swing = transient(Swing(), duration: 0.5 s, sample: 5 ms)"
        )
    };
    let run = |text: &str| {
        let program = eng::check(&eng::Sources::from_text("m.eng", text), "m.eng").into_program();
        let program = program.unwrap_or_else(|report| panic!("{report}"));
        let analysis = program.analysis("swing").expect("an analysis");
        let outcome = analysis
            .run(&mut |_| {})
            .unwrap_or_else(|f| panic!("{}", f.error));
        let column = |path: &str| outcome.results.column(path).expect(path).values.clone();
        (column("pin.angle"), column("cushion.rate"))
    };
    let given = run(&text(", depth: Length", "", ", depth: height(drop)"));
    let own = "let drop = dot(a.origin - b.origin, ground.y)
    let depth = height(drop)";
    let computed = run(&text("", own, ""));
    let swing = |x: &[f64]| x.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    assert!(swing(&computed.1) > 1.0);
    for (a, b) in [(&given.0, &computed.0), (&given.1, &computed.1)] {
        let off = a.iter().zip(b.iter()).map(|(a, b)| (a - b).abs());
        assert!(off.fold(0.0, f64::max) <= 1e-9 * swing(b));
    }
}

/// Numbers of a record that a class gets are parameters of the element, defaults that follow others included;
/// words and counts are not.
#[test]
fn records_of_a_class_are_parameters() {
    let text = "use std.joints.Revolute
record Shape {
    let lemon: Length
    let high: Length = 2*lemon
    let count: Int = 3
    fn area() -> Area = count*lemon*high
}
const Known = Shape(lemon: 5 mm)
force Rub(a: Marker, b: Marker, profile: Shape, others: Shape[n] = [Shape(lemon: 1 mm)], own: Shape = Shape(lemon: 7 mm, high: 1 mm)) {
    apply torque -profile.high*1 N*b.z on a against b
    output high = profile.high as mm
    output area = profile.area() as mm^2
    output far = sum(o.high for o in others) + own.high as mm
}
model Swing {
    gravity = [0, -9.81, 0] m/s^2
    marker pivot = [0, 0, 0] mm
    param lemon: Length = 3 mm
    body bob { mass = 1 kg; inertia = [1, 1, 1] g*m^2; marker top = [0, 1, 0] m }
    joint pin = Revolute(bob.top, pivot)
    force one = Rub(bob.top, pivot, profile: Shape(lemon: lemon), others: [Known, Shape(lemon: 1 mm, high: 9 mm)])
    force two = Rub(bob.top, pivot, profile: Known)
    force three = Rub(bob.top, pivot, profile: Shape(4 mm, 8 mm))
}
analysis r = transient(Swing(), duration: 1 ms, sample: 1 ms)";
    let program = program(text);
    let first = |settings: &[(&str, &str)], path: &str| {
        let mut analysis = program.analysis("r").expect("an analysis");
        for (path, value) in settings {
            let parameter = analysis.parameter(path).unwrap_or_else(|e| panic!("{e}"));
            analysis = analysis
                .set(parameter, value.parse().expect("a value"))
                .expect("it fits");
        }
        let outcome = analysis
            .run(&mut |_| {})
            .unwrap_or_else(|f| panic!("{}", f.error));
        outcome.results.column(path).expect(path).values[0]
    };
    let near = |found: f64, due: f64| assert!((found - due).abs() < 1e-12, "{found} {due}");
    near(first(&[], "one.high"), 6e-3);
    near(first(&[], "one.far"), 20e-3);
    // a default follows the number that it reads, in the record and in its functions
    near(first(&[("one.profile.lemon", "4 mm")], "one.high"), 8e-3);
    near(first(&[("one.profile.lemon", "4 mm")], "one.area"), 96e-6);
    near(first(&[("lemon", "4 mm")], "one.high"), 8e-3);
    near(first(&[("one.profile.high", "1 mm")], "one.area"), 9e-6);
    near(first(&[("one.others[2].high", "1 mm")], "one.far"), 12e-3);
    near(first(&[("one.own.high", "2 mm")], "one.far"), 21e-3);
    // a number that the text states stays, even if the default would be the same
    near(
        first(&[("three.profile.lemon", "6 mm")], "three.high"),
        8e-3,
    );
    // a constant of the file is another record in each element
    near(first(&[("two.profile.lemon", "1 mm")], "two.high"), 2e-3);
    near(first(&[("two.profile.lemon", "1 mm")], "one.far"), 20e-3);
    let analysis = program.analysis("r").expect("an analysis");
    assert!(analysis.parameter("one.profile.count").is_err());
}
