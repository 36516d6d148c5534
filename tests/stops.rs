//! Runs that end at a condition: the moment is that of closed forms, at any distance of samples, and each result tells it.

use crate::support::{outcome, program as checked};
use eng::{Outcome, Program, Sources};
use std::f64::consts::PI;

/// A disc under a constant torque, and a block on a spring.
const MODELS: &str = "
use std.joints.{Revolute, Translational}

force Motor(a: Marker, b: Marker, torque: Torque) {
    apply torque torque*b.z on a against b
    output power = torque*dot(a.angular_velocity - b.angular_velocity, b.z) as W
}

component Machine(stand: Marker) {
    body disc { mass = 1 kg; inertia = [10, 10, 10] g*m^2; marker hub = origin }
    joint hinge = Revolute(disc.hub, stand)
    force motor = Motor(disc.hub, stand, torque: 2 N*m)
    output speed: AngularVelocity = dot(disc.hub.angular_velocity, stand.z) as rpm
}

model Bench {
    param limit: AngularVelocity = 1000 rpm
    gravity = [0, 0, 0] m/s^2
    marker stand = origin
    part machine = Machine(stand)
    cycle angle = rotation(machine.disc.hub, stand) { period = 360 deg }
    output turned = rotation(machine.disc.hub, stand)
}

model Swing {
    gravity = [0, 0, 0] m/s^2
    marker bore = origin
    body block { mass = 1 kg; inertia = [1, 1, 1] g*m^2; marker way = origin }
    joint guide = Translational(block.way, bore)
    force spring = Pull(block.way, bore)
    start guide.travel = 0 mm
    start guide.speed = 1 m/s
    output way = guide.travel
}

force Pull(a: Marker, b: Marker) {
    apply force -(100 N/m)*dot(a.origin - b.origin, b.z)*b.z on a against b
}
";

fn program(analysis: &str) -> Program {
    checked(&format!("{MODELS}\n{analysis}"))
}

fn run(analysis: &str) -> Outcome {
    outcome(&program(&format!("analysis run = {analysis}")), "run")
}

/// The last number of a column (SI).
fn last(outcome: &Outcome, path: &str) -> f64 {
    let column = outcome.results.column(path).expect("a column");
    *column.values.last().expect("a sample")
}

/// The moment at which a run stopped (s).
fn stopped(outcome: &Outcome) -> f64 {
    let summary = outcome.summary.as_ref().expect("a summary");
    summary.stopped.as_ref().expect("a stop").moment.time
}

/// 2 N m speed up 10 g m² to 1000 rpm in `J ω/T`, whatever samples, steps and durations are.
#[test]
fn a_run_up_ends_at_its_speed() {
    let due = 0.01 * 1000.0 * PI / 30.0 / 2.0;
    for (settings, limit) in [
        ("duration: 10 s", 1e-9),
        ("duration: 10 s, sample: 3 s", 1e-9),
        ("duration: 1000 rev, sample: 10 deg", 1e-9),
        ("duration: 1000 rev, sample: 1 s", 1e-9),
        ("duration: 10 s, step: 0.7 ms", 1e-9),
        ("duration: 0.6 s, step: 13 ms, sample: 0.2 s", 1e-9),
    ] {
        let outcome = run(&format!(
            "transient(Bench(), {settings}, stop: machine.speed > limit)"
        ));
        let time = stopped(&outcome);
        assert!(
            (time - due).abs() < limit * due,
            "{settings}: {time}, {due}"
        );
        assert_eq!(last(&outcome, "time").to_bits(), time.to_bits());
        let speed = last(&outcome, "machine.speed") * 30.0 / PI;
        assert!((speed - 1000.0).abs() < 1e-6, "{settings}: {speed} rpm");
        let angle = last(&outcome, "cycle.angle");
        let due = 0.5 * 200.0 * due * due;
        assert!(
            (angle - due).abs() < 1e-8 * due,
            "{settings}: {angle}, {due}"
        );
        let told = outcome.results.stopped().expect("metadata");
        assert!(
            told.starts_with("machine.speed > limit at t = 0.5235987"),
            "{told}"
        );
        assert_eq!(outcome.results.metadata()["stop"], "machine.speed > limit");
    }
    // samples lie before the end and at it
    let outcome =
        run("transient(Bench(), duration: 10 s, sample: 0.1 s, stop: machine.speed > 1000 rpm)");
    let times = &outcome.results.column("time").expect("a column").values;
    assert_eq!(times.len(), 7, "{times:?}");
}

/// A run whose condition never holds ends as without it, with the same last sample.
#[test]
fn a_condition_that_never_holds_ends_nothing() {
    let plain = run("transient(Bench(), duration: 0.3 s, sample: 0.1 s)");
    let outcome =
        run("transient(Bench(), duration: 0.3 s, sample: 0.1 s, stop: machine.speed > limit)");
    assert!(
        outcome
            .summary
            .as_ref()
            .expect("a summary")
            .stopped
            .is_none()
    );
    assert_eq!(outcome.results.stopped(), None);
    let [a, b] = [&plain, &outcome].map(|o| last(o, "turned"));
    assert!((a - b).abs() < 1e-12 * a, "{a} {b}");
    // a limit that is reached behind the end
    let late =
        run("transient(Bench(), duration: 523.598 ms, sample: 0.1 s, stop: machine.speed > limit)");
    assert!(late.results.stopped().is_none());
}

/// A swing `0.1 m sin(10/s t)`: the condition holds for a part of the period alone, down to a hundredth of a step, and the run ends
/// where it begins to hold.
#[test]
fn a_short_excursion_is_not_stepped_over() {
    for sample in ["1 ms", "50 ms", "2 s"] {
        for (condition, due) in [
            ("way > 50 mm", 0.5_f64.asin() / 10.0),
            ("way > 99.9999 mm", 0.999_999_f64.asin() / 10.0),
            ("-way > 99.999 mm", (PI + 0.999_99_f64.asin()) / 10.0),
            ("guide.speed < -0.9 m/s", (PI - 0.9_f64.acos()) / 10.0),
            (
                "way < 50 mm and guide.speed < 0 m/s",
                (PI - 0.5_f64.asin()) / 10.0,
            ),
            (
                "not (way < 80 mm) or guide.speed < 0 m/s",
                0.8_f64.asin() / 10.0,
            ),
            ("abs(way) > 30 mm", 0.3_f64.asin() / 10.0),
            (
                "(if time > 0.2 s then way else 0 mm) < -20 mm",
                (PI + 0.2_f64.asin()) / 10.0,
            ),
        ] {
            let outcome = run(&format!(
                "transient(Swing(), duration: 2 s, sample: {sample}, stop: {condition})"
            ));
            let time = stopped(&outcome);
            // near its largest value the way changes by a micrometre in 0.1 ms
            let limit = if condition.contains("99.99") {
                2e-5
            } else {
                2e-6
            };
            println!("{condition} at {sample}: {time} s, {:.1e} off", time - due);
            assert!(
                (time - due).abs() < limit,
                "{condition} at {sample}: {time}, {due}"
            );
        }
    }
}

/// Each point of a sweep tells whether and when its condition ended it; the index may stand in the condition.
#[test]
fn points_of_a_sweep_tell_where_they_stopped() {
    let program = program(
        "analysis runs[s in [500, 1000, 4000] rpm] = transient(Bench(), duration: 0.6 s, sample: 0.1 s, stop: machine.speed > s)",
    );
    let outcomes = (1..=3).map(|k| {
        let analysis = program.analysis(&format!("runs[{k}]")).expect("a point");
        eng::run::run(&analysis, false, &mut |_| {})
            .unwrap_or_else(|failed| panic!("{}", failed.error))
    });
    let outcomes: Vec<_> = outcomes.collect();
    let ends: Vec<Option<&str>> = outcomes.iter().map(|o| o.results.stopped()).collect();
    assert!(
        ends[0].is_some() && ends[1].is_some() && ends[2].is_none(),
        "{ends:?}"
    );
    assert!(
        outcomes[1]
            .facts
            .iter()
            .any(|fact| fact.starts_with("ended by its condition machine.speed > s at t = 0.5235")),
        "{:?}",
        outcomes[1].facts
    );
}

/// A program that steps the simulation stands at the condition, keeps this over a checkpoint, and steps no further.
#[test]
fn a_simulation_stands_where_its_condition_begins_to_hold() {
    let program =
        program("analysis run = transient(Bench(), duration: 10 s, stop: machine.speed > limit)");
    let analysis = program.analysis("run").expect("an analysis");
    let due = 0.01 * 1000.0 * PI / 30.0 / 2.0;
    let prepared = || analysis.simulation().expect("a simulation");
    let mut simulation = prepared().start().expect("a start");
    assert_eq!(simulation.advance(0.2).expect("steps"), 0.2);
    assert!(simulation.stopped().is_none());
    let reached = simulation.advance(2.0).expect("steps");
    assert!((reached - due).abs() < 1e-9, "{reached}");
    assert_eq!(simulation.time(), reached);
    let speed = analysis
        .model()
        .channel("machine.speed")
        .expect("a channel");
    let value = simulation.value(speed).expect("a value") * 30.0 / PI;
    assert!((value - 1000.0).abs() < 1e-6, "{value}");
    let stopped = simulation.stopped().expect("a stop");
    assert_eq!(stopped.condition, "machine.speed > limit");
    let refused = simulation.advance(3.0).expect_err("no step").to_string();
    assert!(
        refused.contains("has ended the simulation: machine.speed > limit"),
        "{refused}"
    );
    let bytes = simulation.checkpoint();
    let mut resumed = prepared().resume(&bytes).expect("resumes");
    assert_eq!(resumed.stopped(), Some(stopped));
    assert!(resumed.step().is_err());
    // the model alone has no condition
    let model = program.model("Bench").expect("a model");
    let mut free = model.simulation().start().expect("a start");
    assert_eq!(free.advance(1.0).expect("steps"), 1.0);
}

/// The message of a text that is refused, at the check or by the run.
fn refusal(analysis: &str) -> String {
    let text = format!("{MODELS}\nanalysis run = {analysis}");
    match eng::check(&Sources::from_text("m.eng", &text), "m.eng").into_program() {
        Err(report) => report.to_string(),
        Ok(program) => match program
            .analysis("run")
            .map(|analysis| analysis.run(&mut |_| {}))
        {
            Err(error) => error.to_string(),
            Ok(Err(failed)) => failed.error.to_string(),
            Ok(Ok(_)) => panic!("{analysis} runs"),
        },
    }
}

#[test]
fn wrong_conditions_are_refused_with_their_reason() {
    for (stop, reasons) in [
        ("machine.spede > 3 rpm", vec!["spede", "speed"]),
        ("machine.speed", vec!["`stop` of an analysis"]),
        ("machine.speed > 3 mm", vec!["machine.speed > 3 mm"]),
        (
            "time > 1 s",
            vec!["does not depend on the motion", "duration"],
        ),
        ("limit > 3 rpm", vec!["does not depend on the motion"]),
        (
            "machine.hinge.force.x > 3 N",
            vec!["outputs only", "reaction"],
        ),
        ("der(machine.speed) > 3 rad/s^2", vec!["outside of outputs"]),
        (
            "turned == 3 rad",
            vec!["steps pass an exact value", "`<` or `>`"],
        ),
        (
            "machine.speed < limit",
            vec!["holds at the start already", "t = 0 s"],
        ),
        ("nothing > 3 mm", vec!["nothing"]),
    ] {
        let said = refusal(&format!("transient(Bench(), duration: 1 s, stop: {stop})"));
        for reason in reasons {
            assert!(said.contains(reason), "{stop}: {said}");
        }
        assert!(said.contains("m.eng:"), "{stop}: {said}");
    }
    let with_gradients = refusal(
        "transient(Bench(), duration: 1 s, gradients: [limit], stop: machine.speed > limit)",
    );
    assert!(with_gradients.contains("no `stop`"), "{with_gradients}");
    for kind in [
        "periodic(Bench(), stop: turned > 1 rad)",
        "linear(Bench(), stop: turned > 1 rad)",
    ] {
        let said = refusal(kind);
        assert!(
            said.contains("no parameter `stop`") || said.contains("`stop`"),
            "{said}"
        );
    }
}
