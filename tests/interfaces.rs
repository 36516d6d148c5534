//! Numbers of models whose classes share texts, lengths and values: the text of an interface holds in each
//! class.

use eng::{Program, Sources};

fn program(text: &str) -> Program {
    eng::check(&Sources::from_text("m.eng", text), "m.eng")
        .into_program()
        .unwrap_or_else(|report| panic!("{report}"))
}

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
