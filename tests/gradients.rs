//! Gradients of transients: closed forms, central differences over whole runs, and the bits of the run itself.
//!
//! The differences run with fixed steps and are extrapolated (Richardson): `(4 D(ε) − D(2ε))/3` with `D` central.

use crate::support::{program, program_of};
use eng::{Analysis, Gradient, Outcome, Program, Quantity, Results, StepControl};
use std::path::Path;

pub(crate) fn analysis(program: &Program, name: &str) -> Analysis {
    match program.analysis(name) {
        Ok(analysis) => analysis,
        Err(error) => panic!("{error}"),
    }
}

pub(crate) fn run(analysis: &Analysis) -> Outcome {
    match analysis.run(&mut |_| {}) {
        Ok(outcome) => outcome,
        Err(failed) => panic!("{}", failed.error),
    }
}

fn refusal(analysis: &Analysis) -> String {
    match analysis.run(&mut |_| {}) {
        Ok(_) => panic!("it must be refused"),
        Err(failed) => failed.error.to_string(),
    }
}

/// The value (SI) of a parameter.
pub(crate) fn value(analysis: &Analysis, path: &str) -> f64 {
    let infos = analysis.model().parameters();
    let index = infos.iter().position(|info| info.path == path).unwrap();
    analysis.parameter_values().unwrap()[index]
}

/// A run with another value (SI) of a parameter.
fn run_at(analysis: &Analysis, path: &str, value: f64) -> Results {
    let parameter = analysis.parameter(path).unwrap();
    let dimension = analysis.model().describe(parameter).unwrap().dimension;
    let changed = analysis
        .clone()
        .set(parameter, Quantity::si(value, dimension));
    run(&changed.unwrap()).results
}

/// Channels of a gradient: all columns behind time, cycle and their derivatives.
fn channels(gradient: &Gradient) -> Vec<&str> {
    let columns = gradient.results.columns().iter().map(|c| c.path.as_str());
    columns
        .filter(|path| !["time", "cycle.angle", "cycle.speed"].contains(path))
        .filter(|path| !path.ends_with(".gradient"))
        .collect()
}

/// The numbers of `get` at four values of a parameter around its own make a central difference of fourth order,
/// `(8 (f(ε) − f(−ε)) − (f(2ε) − f(−2ε)))/12ε`, with ε as a share of the parameter. It is the extrapolation of the differences
/// over ε and 2ε.
pub(crate) fn differences(
    plain: &Analysis,
    path: &str,
    share: f64,
    get: impl Fn(&Analysis) -> Vec<f64>,
) -> Vec<f64> {
    let p = value(plain, path);
    let step = share * p;
    let parameter = plain.parameter(path).unwrap();
    let dimension = plain.model().describe(parameter).unwrap().dimension;
    let at = |k: f64| {
        let changed = plain
            .clone()
            .set(parameter, Quantity::si(p + k * step, dimension));
        get(&changed.unwrap())
    };
    let [a, b, c, d] = [1.0, -1.0, 2.0, -2.0].map(at);
    let over = |i: usize| (8.0 * (a[i] - b[i]) - (c[i] - d[i])) / (12.0 * step);
    (0..a.len()).map(over).collect()
}

pub(crate) fn size(x: &[f64]) -> f64 {
    x.iter().fold(0.0_f64, |most, x| most.max(x.abs()))
}

/// Largest error of the gradients by a parameter p against differences of whole runs, with its channel. It is a share of the
/// largest derivative of the channel, or of the largest of these: a tenth of the largest derivative of the same dimension,
/// 10⁻⁴ of the channel over p, 10⁻⁶ (SI) over p. Below these a derivative is rounding.
fn worst(plain: &Analysis, gradient: &Gradient, share: f64) -> (f64, String) {
    let mut worst = (0.0, String::new());
    let path = gradient.parameter.as_str();
    let p = value(plain, path);
    let base = run(plain).results;
    let names = channels(gradient);
    let rows = gradient.results.samples();
    let expected = differences(plain, path, share, |analysis| {
        let results = run(analysis).results;
        let columns = names
            .iter()
            .map(|name| &results.column(name).unwrap().values);
        columns.flatten().copied().collect()
    });
    for (channel, expected) in names.iter().zip(expected.chunks(rows)) {
        let got = gradient.results.column(channel).unwrap();
        let alike = gradient.results.columns().iter();
        let alike = alike.filter(|other| other.dimension == got.dimension);
        let largest = alike.map(|other| size(&other.values)).fold(0.0, f64::max);
        let of_value = 1e-4 * size(&base.column(channel).unwrap().values);
        let least = (0.1 * largest).max(of_value.max(1e-6) / p);
        let errors: Vec<f64> = got
            .values
            .iter()
            .zip(expected)
            .map(|(x, y)| x - y)
            .collect();
        let error = size(&errors) / size(expected).max(least);
        if error > worst.0 {
            worst = (error, (*channel).to_owned());
        }
    }
    worst
}

fn pendulum(more: &str) -> String {
    format!(
        "
use std.joints.Revolute

model Pendulum {{
    param length: Length = 1 m
    param mass: Mass = 1 kg
    param start_angle: Angle = 0.5 rad
    param pull: Acceleration = 9.81 m/s^2
    param unused: Length = 1 m
    const sides: Int = 3
    gravity = [0, -1, 0]*pull
    marker pivot = [0, 0, 0] mm
    body bob {{ mass = mass; inertia = [1e-6, 1e-6, 1e-6] kg*m^2; marker top = [0, 1, 0]*length }}
    joint pin = Revolute(bob.top, pivot)
    start pin.angle = start_angle
    output x = dot(bob.origin.origin, ground.x)
    output a = dot(bob.origin.acceleration, ground.y)
    output turn = pin.angle
    output rate = pin.speed
}}

{more}
"
    )
}

/// Steps whose equations are solved to rounding: the error of the iteration is one of the differences.
pub(crate) fn exact(step: f64) -> StepControl {
    StepControl::FixedTo {
        step,
        tolerance: 1e-5,
    }
}

#[test]
fn a_pendulum_has_the_derivatives_of_differences() {
    let text = pendulum("analysis swing = transient(Pendulum(), duration: 3 s, sample: 0.1 s)");
    let program = program(&text);
    let plain = analysis(&program, "swing").stepping(exact(1e-4));
    let paths = ["length", "start_angle", "pull"];
    let outcome = run(&plain.clone().gradients(&paths).unwrap());
    assert_eq!(outcome.gradients.len(), 3);
    for gradient in &outcome.gradients {
        let (error, channel) = worst(&plain, gradient, 4e-3);
        println!(
            "pendulum by {}: {error:.1e} ({channel})",
            gradient.parameter
        );
        assert!(error < 1e-6, "{}: {error} of {channel}", gradient.parameter);
    }
}

#[test]
fn a_run_has_the_same_bits_with_gradients() {
    for steps in ["step: 2 ms", "tolerance: 0.1"] {
        let text = pendulum(&format!(
            "analysis swing = transient(Pendulum(), duration: 1 s, sample: 0.1 s, {steps}, gradients: [length, pull])"
        ));
        let program = program(&text);
        same_bits(&analysis(&program, "swing"), 2);
    }
}

/// Samples at cycle angles, which the gradients solve with the factors of the motion, beside films and error control.
#[test]
fn an_engine_has_the_same_bits_with_gradients() {
    let text = "analysis short = transient(Inline4(), duration: 40 deg, sample: 1 deg)";
    let program = engine(text);
    let paths = ["main[3].radial_clearance", "oil_temperature"];
    let short = analysis(&program, "short").gradients(&paths);
    same_bits(&short.unwrap(), 2);
}

/// The channels and the summary of a run with gradients by a number of parameters are those of a run without.
fn same_bits(with: &Analysis, count: usize) {
    let without = with.clone().gradients::<&str>(&[]).unwrap();
    let (with, without) = (run(with), run(&without));
    assert_eq!(with.gradients.len(), count);
    for (a, b) in with.results.columns().iter().zip(without.results.columns()) {
        let bits = |values: &[f64]| values.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&a.values), bits(&b.values), "{}", a.path);
    }
    assert_eq!(with.summary, without.summary);
}

/// θ = θ₀ cos ωt with `ω² = g l/(l² + i/m)` and small θ₀: `∂θ/∂l = −θ₀ t sin(ωt) ∂ω/∂l`.
#[test]
fn the_period_of_a_pendulum_follows_its_length() {
    let text = pendulum(
        "analysis swing = transient(Pendulum(start_angle: 1e-4 rad), duration: 5 s, sample: 0.25 s, step: 0.2 ms)",
    );
    let program = program(&text);
    let outcome = run(&analysis(&program, "swing").gradients(&["length"]).unwrap());
    let gradient = &outcome.gradients[0];
    let column = gradient.results.column("turn").unwrap();
    assert_eq!(column.display.symbol, "deg/m");
    let (l, i, g) = (1.0_f64, 1e-6, 9.81);
    let omega = (g * l / (l * l + i)).sqrt();
    let by_length = 0.5 / omega * g * (i - l * l) / ((l * l + i) * (l * l + i));
    let times = &gradient.results.column("time").unwrap().values;
    for (t, got) in times.iter().zip(&column.values) {
        let expected = -1e-4 * t * (omega * t).sin() * by_length;
        assert!(
            (got - expected).abs() < 1e-5 * 1e-4 * 5.0,
            "{t} s: {got} for {expected}"
        );
    }
}

/// Samples at angles of a crank that turns at its speed: their times depend on the speed.
#[test]
fn a_slider_crank_has_the_derivatives_of_differences() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/slider_crank/slider_crank.eng");
    let program = program(&std::fs::read_to_string(path).unwrap());
    let plain = analysis(&program, "inertia").stepping(exact(5e-5));
    let paths = [
        "speed",
        "throw",
        "rod_length",
        "rod_mass",
        "rod_center",
        "piston_mass",
    ];
    let outcome = run(&plain.clone().gradients(&paths).unwrap());
    for gradient in &outcome.gradients {
        let (error, channel) = worst(&plain, gradient, 1e-3);
        println!(
            "slider-crank by {}: {error:.1e} ({channel})",
            gradient.parameter
        );
        assert!(error < 1e-6, "{}: {error} of {channel}", gradient.parameter);
    }
}

/// A round shaft of steel along z, 20 mm thick and 0.4 m long, of eight beams. Node 1 is at the origin.
fn shaft() -> String {
    let (area, moment) = (3.1416e-4, 7.854e-9);
    let mut deck = format!(
        "BEGIN BULK\nMAT1,1,2.1e11,,0.3,7850.\nPBAR,1,1,{area:e},{moment:e},{moment:e},{:e}\n",
        2.0 * moment
    );
    for node in 1..=9 {
        deck += &format!("GRID,{node},,0.,0.,{:.4}\n", 0.05 * f64::from(node - 1));
    }
    for piece in 1..=8 {
        deck += &format!("CBAR,{piece},1,{piece},{},1.,0.,0.\n", piece + 1);
    }
    deck + "ENDDATA\n"
}

/// A rotor with an unbalanced disc in two films. Its shaft is flexible, with and without stiffness from stresses.
#[test]
fn a_flexible_rotor_has_the_derivatives_of_differences() {
    for stiffened in [false, true] {
        let text = format!(
            "
use std.joints.{{Fixed, PointOnPlane}}
use std.drives.PrescribedRotation
use std.forces.LinearSpring
use std.journals.Short
model Rotor {{
    param speed: AngularVelocity = 100 rad/s
    param disc_mass: Mass = 2 kg
    param unbalance: Length = 20 um
    param clearance: Length = 20 um
    param thickness: DynamicViscosity = 0.02 Pa*s
    param spring: Stiffness = 2e5 N/m
    param high: Length = 0.1 m
    gravity = [0, -9.81, 0] m/s^2
    marker left = [0, 0, 0] m
    marker right = [0, 0, 0.4] m
    marker over = [0, 1, 0]*high + [0, 0, 0.2] m
    flexible shaft {{
        mesh = nastran(\"shaft.bdf\", units: m_kg_s)
        modes = static(at: [left, right, middle], freedoms: [x, y]) + normal(4)
        damping = rayleigh(mass: 0 s^-1, stiffness: 1e-5 s)
        geometric_stiffness = {stiffened}
        marker left = node(1)
        marker middle = node(5)
        marker right = node(9)
        start angular_velocity = [0, 0, 1]*speed
    }}
    body disc {{
        mass = disc_mass
        inertia = [0.8, 0.8, 1.6] g*m^2
        center_of_mass = [1, 0, 0]*unbalance
        marker hub = origin
    }}
    joint fit = Fixed(disc.hub, shaft.middle)
    joint thrust = PointOnPlane(shaft.left, left)
    journal film[j in 1..2] = Short(pin: [shaft.left, shaft.right][j], shell: [left, right][j], diameter: 20 mm, width: 10 mm,
        radial_clearance: clearance, viscosity: thickness)
    force pull = LinearSpring(shaft.middle, over, stiffness: spring, damping: 20 N*s/m, free_length: 0.1 m)
    drive turn = PrescribedRotation(shaft.left, left, speed: speed)
    output sag: Length = dot(shaft.middle.origin - shaft.left.origin, ground.y)
    output aside: Length = dot(shaft.middle.origin - shaft.left.origin, ground.x)
    output speed_aside: Velocity = dot(disc.hub.velocity, ground.x)
    output lift: Length = dot(shaft.right.origin, ground.y)
}}
analysis turns = transient(Rotor(), duration: 4 ms, sample: 0.2 ms, start: assembled)
analysis rests = transient(Rotor(), duration: 4 ms, sample: 0.2 ms, start: quasi_static)
"
        );
        let program = program_of(&[("m.eng", &text), ("shaft.bdf", &shaft())]);
        let plain = analysis(&program, "turns").stepping(exact(2e-5));
        let cases = [
            ("speed", 2e-2),
            ("disc_mass", 1e-2),
            ("unbalance", 1e-2),
            ("clearance", 3e-3),
            ("thickness", 1e-2),
            ("spring", 1e-2),
            ("high", 1e-5),
        ];
        let outcome = run(&plain
            .clone()
            .gradients(&cases.map(|(path, _)| path))
            .unwrap());
        let times = outcome.results.column("time").unwrap().values.clone();
        let names = ["sag", "aside", "lift", "film[2].minimum_film"];
        for (gradient, (path, share)) in outcome.gradients.iter().zip(cases) {
            let column = |name: &str| &gradient.results.column(name).unwrap().values;
            let expected = differences(&plain, path, share, |at| held(at, &names, &times));
            // rounding: of positions over the increment in the differences, of modal forces in the gradients
            let rounding = if stiffened { 5e-13 } else { 5e-14 } / (share * value(&plain, path));
            for (name, expected) in names.iter().zip(expected.chunks(times.len())) {
                let error = size(&missed(column(name), expected));
                println!("{name} by {path}: {:.1e}", error / size(expected));
                let most = 1e-6 * size(expected) + rounding;
                assert!(error < most, "{name} by {path}: {error} of {most}");
            }
            // recorded forces, in the middle of their errors: see `held`
            let force = "film[1].force.y";
            let expected = differences(&plain, path, share, |at| {
                run(at).results.column(force).unwrap().values.clone()
            });
            let errors = missed(column(force), &expected);
            let error = errors[errors.len() / 2];
            println!("{force} by {path}: {:.1e}", error / size(&expected));
            // the rounding of positions, times the stiffness of the film, the weight that it carries over its clearance
            let most = 3e-5 * size(&expected) + rounding * 15.0 / 2e-5;
            assert!(error < most, "{force} by {path}: {error} of {most}");
        }
        // the search for the bending of the turning shaft ends before it is smooth
        let rests = analysis(&program, "rests").gradients(&["disc_mass"]);
        let message = refusal(&rests.unwrap());
        assert!(
            message.contains("the start is not a smooth function of"),
            "{message}"
        );
    }
}

/// Sizes of errors, sorted.
fn missed(got: &[f64], expected: &[f64]) -> Vec<f64> {
    let pairs = got.iter().zip(expected);
    let mut errors: Vec<f64> = pairs.map(|(x, y)| (x - y).abs()).collect();
    errors.sort_by(f64::total_cmp);
    errors
}

/// A cantilever of eight beams and a spring at its end begin in balance. With the deflection of the end alone (by three modes
/// of unit loads) `(k + k_b) u = k u_0 − F`, and the motion keeps it.
#[test]
fn a_bent_bar_in_balance_follows_its_spring() {
    let text = "
use std.joints.Fixed
use std.forces.LinearSpring
model Bar {
    param spring: Stiffness = 2e4 N/m
    param slack: Length = 0.099 m
    gravity = [0, 0, 0] m/s^2
    marker wall = [0, 0, 0] m
    marker over = [0, 0.1, 0.4] m
    flexible bar {
        mesh = nastran(\"shaft.bdf\", units: m_kg_s)
        modes = static(at: [left, right], freedoms: [x, y, rx, ry]) + normal(4)
        damping = 5 %
        marker left = node(1)
        marker right = node(9)
    }
    joint weld = Fixed(bar.left, wall)
    force pull = LinearSpring(bar.right, over, stiffness: spring, free_length: slack)
    output up: Length = dot(bar.right.origin, ground.y)
}
analysis rests = transient(Bar(), duration: 2 ms, sample: 1 ms, start: quasi_static)
";
    let program = program_of(&[("m.eng", text), ("shaft.bdf", &shaft())]);
    let outcome = run(&analysis(&program, "rests")
        .gradients(&["spring", "slack"])
        .unwrap());
    // a beam of Bernoulli: its places are small beside its length, so its end moves straight up
    let (spring, stretch) = (2e4, 1e-3);
    let beam = 3.0 * 2.1e11 * 7.854e-9 / 0.4_f64.powi(3);
    let due = [
        stretch * beam / (spring + beam).powi(2),
        -spring / (spring + beam),
    ];
    for (gradient, due) in outcome.gradients.iter().zip(due) {
        let got = &gradient.results.column("up").unwrap().values;
        println!("up by {}: {got:?} for {due:e}", gradient.parameter);
        for got in got {
            assert!((got / due - 1.0).abs() < 2e-6, "{got} for {due}");
        }
    }
}

/// The largest difference between the gradients of two runs, as a share of the largest derivative of the same dimension, or of a
/// hundredth of the largest channel of this dimension over the parameter.
fn apart(plain: &Analysis, of: &Outcome, exact: &Outcome) -> f64 {
    let mut most = 0.0_f64;
    for (gradient, exact_one) in of.gradients.iter().zip(&exact.gradients) {
        let p = value(plain, &gradient.parameter);
        for name in channels(gradient) {
            let [got, due] = [gradient, exact_one].map(|g| g.results.column(name).unwrap());
            let largest = |results: &Results, like: &str| {
                let like = results.column(like).unwrap().dimension;
                let alike = results.columns().iter().filter(|c| c.dimension == like);
                alike.map(|c| size(&c.values)).fold(0.0, f64::max)
            };
            let least = 0.01 * largest(&exact.results, name) / p;
            let scale = largest(&exact_one.results, name).max(least);
            most = most.max(size(&missed(&got.values, &due.values)) / scale);
        }
    }
    most
}

/// Under error control the gradients differ from those of small fixed steps, and the less the smaller the tolerance.
#[test]
fn controlled_steps_have_the_gradients_of_the_motion() {
    let text = pendulum(
        "analysis swing = transient(Pendulum(), duration: 3 s, sample: 0.1 s, step: 0.1 ms)",
    );
    let program = program(&text);
    let fine = analysis(&program, "swing").gradients(&["length", "start_angle", "pull"]);
    let fine = fine.unwrap();
    let exact = run(&fine);
    let errors = [1.0, 0.1, 0.01].map(|tolerance| {
        let outcome = run(&fine.clone().stepping(StepControl::Tolerance(tolerance)));
        apart(&fine, &outcome, &exact)
    });
    println!("tolerances of 1, 0.1, 0.01: {errors:?}");
    for (error, most) in errors.iter().zip([3e-4, 7e-5, 1.5e-5]) {
        assert!(*error < most, "{errors:?}");
    }
}

/// Samples at cycle angles within controlled steps.
#[test]
fn controlled_steps_of_a_slider_crank_have_the_gradients_of_the_motion() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/slider_crank/slider_crank.eng");
    let program = program(&std::fs::read_to_string(path).unwrap());
    let fine = analysis(&program, "inertia").stepping(exact(5e-5));
    let fine = fine.gradients(&["speed", "throw", "rod_mass"]).unwrap();
    let outcome = run(&fine.clone().stepping(StepControl::Tolerance(1.0)));
    let error = apart(&fine, &outcome, &run(&fine));
    println!("slider-crank: {error:.1e}");
    assert!(error < 1e-8, "{error}");
}

/// The error of the linear prediction falls with the square of the change.
#[test]
fn predictions_are_right_to_second_order() {
    let text = pendulum(
        "analysis swing = transient(Pendulum(), duration: 3 s, sample: 0.5 s, step: 2 ms)",
    );
    let program = program(&text);
    let plain = analysis(&program, "swing");
    let outcome = run(&plain.clone().gradients(&["length"]).unwrap());
    let of = |results: &Results| results.column("x").unwrap().values.clone();
    let (base, slope) = (of(&outcome.results), of(&outcome.gradients[0].results));
    let miss = |change: f64| {
        let there = of(&run_at(&plain, "length", 1.0 + change));
        let errors = (0..base.len()).map(|i| (there[i] - base[i] - slope[i] * change).abs());
        errors.fold(0.0_f64, f64::max)
    };
    let misses = [1e-2, 5e-3, 2.5e-3].map(miss);
    for pair in misses.windows(2) {
        let ratio = pair[0] / pair[1];
        assert!((3.8..4.2).contains(&ratio), "{misses:?}");
    }
}

#[test]
fn what_has_no_gradients_is_refused() {
    let text = pendulum(
        "analysis swing = transient(Pendulum(), duration: 0.1 s)
         analysis modes = linear(Pendulum())",
    );
    let program = program(&text);
    let swing = analysis(&program, "swing");
    let message = swing
        .clone()
        .gradients(&["lenght"])
        .unwrap_err()
        .to_string();
    assert!(message.contains("length"), "{message}");
    let message = swing.clone().gradients(&["sides"]).unwrap_err().to_string();
    assert!(message.contains("`const`"), "{message}");
    let message = swing
        .clone()
        .gradients(&["mass", "mass"])
        .unwrap_err()
        .to_string();
    assert!(message.contains("twice"), "{message}");
    let modes = analysis(&program, "modes");
    let message = modes.gradients(&["mass"]).unwrap_err().to_string();
    assert!(message.contains("transient"), "{message}");
    let message = refusal(&swing.gradients(&["unused"]).unwrap());
    assert!(
        message.contains("unused changes no number of the motion"),
        "{message}"
    );
}

/// Channels that read positions and velocities alone, at the ends of steps, as the integrator holds them. Recorded samples
/// are projected with a matrix that a run keeps for several steps, and runs with other parameters keep it for other ones: their
/// differences have this noise.
fn held(analysis: &Analysis, names: &[&str], times: &[f64]) -> Vec<f64> {
    let mut simulation = analysis.simulation().unwrap().start().unwrap();
    let channels: Vec<_> = names
        .iter()
        .map(|name| analysis.model().channel(name).unwrap())
        .collect();
    let watch = simulation.watch(&channels).unwrap();
    let Ok(mut watch) = watch.unprojected() else {
        panic!("{names:?} read accelerations");
    };
    let mut read = vec![vec![0.0; times.len()]; names.len()];
    let mut now = vec![0.0; names.len()];
    for (row, time) in times.iter().enumerate() {
        if *time > simulation.time() {
            simulation.advance(*time).unwrap();
        }
        simulation.read(&mut watch, &mut now).unwrap();
        for (column, x) in read.iter_mut().zip(&now) {
            column[row] = *x;
        }
    }
    read.concat()
}

/// The four-cylinder engine of the examples, with an analysis.
fn engine(analysis: &str) -> Program {
    let read = |name: &str| {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/inline4");
        std::fs::read_to_string(folder.join(name)).unwrap()
    };
    let text = format!("{}\n{analysis}\n", read("by_hand.eng"));
    program_of(&[("m.eng", &text), ("pressure.csv", &read("pressure.csv"))])
}

/// The fired engine with its films, from its balance on through the firing of cylinder 1.
#[test]
fn a_fired_engine_has_the_derivatives_of_differences() {
    let program = engine("analysis short = transient(Inline4(), duration: 2.5 ms, sample: 0.1 ms)");
    let plain = analysis(&program, "short").stepping(exact(1e-5));
    let paths = ["main[3].radial_clearance", "oil_temperature", "combustion"];
    let outcome = run(&plain.clone().gradients(&paths).unwrap());
    let times = outcome.results.column("time").unwrap().values.clone();
    let films = ["main[3].minimum_film", "main[1].minimum_film"];
    let torque = ["brake_torque"];
    let cases: [(&str, &[&str]); 3] = [
        ("main[3].radial_clearance", &films[..1]),
        ("oil_temperature", &[films[0], films[1], torque[0]]),
        ("combustion", &[films[0], torque[0]]),
    ];
    for (gradient, (path, names)) in outcome.gradients.iter().zip(cases) {
        assert_eq!(gradient.parameter, path);
        let expected = differences(&plain, path, 1e-3, |at| held(at, names, &times));
        for (name, expected) in names.iter().zip(expected.chunks(times.len())) {
            let got = &gradient.results.column(name).unwrap().values;
            let errors: Vec<f64> = got.iter().zip(expected).map(|(x, y)| x - y).collect();
            let error = size(&errors) / size(expected);
            println!("{name} by {path}: {error:.1e}");
            assert!(error < 1e-6, "{name} by {path}: {error}");
        }
    }
    // recorded forces, in the middle of their errors: see `held`
    let forces = ["vertical[2]", "vertical[3]", "vertical[4]", "vertical[5]"];
    let expected = differences(&plain, paths[0], 1e-2, |at| {
        let results = run(at).results;
        let columns = forces
            .iter()
            .map(|name| &results.column(name).unwrap().values);
        columns.flatten().copied().collect()
    });
    for (name, expected) in forces.iter().zip(expected.chunks(times.len())) {
        let got = &outcome.gradients[0].results.column(name).unwrap().values;
        let mut errors: Vec<f64> = got
            .iter()
            .zip(expected)
            .map(|(x, y)| (x - y).abs())
            .collect();
        errors.sort_by(f64::total_cmp);
        let error = errors[errors.len() / 2] / size(expected);
        println!("{name} by {}: {error:.1e}", paths[0]);
        assert!(error < 2e-5, "{name}: {error}");
    }
}

/// The load W of Ocvirk's bearing at a steady speed, `W = (μ ω R L³/4c²) f(ε)` with
/// `f(ε) = ε √(16ε² + π²(1 − ε²))/(1 − ε²)²` (G. B. DuBois, F. W. Ocvirk, NACA report 1157, 1953). A given load and speed leave
/// `f(ε)/c²` constant, so `dε/dc = 2 f/(c f')`.
#[test]
fn the_eccentricity_of_a_short_bearing_follows_its_clearance() {
    let program = program(
        "
use std.joints.Spherical
use std.journals.Short
use std.drives.PrescribedRotation
model Rotor {
    gravity = [-9.81, 0, 0] m/s^2
    marker axis = [0, 0, 0] mm
    marker foot = [0, 0, -200] mm
    body rotor {
        mass = 20 kg
        inertia = [300, 300, 40] g*m^2
        marker neck = origin
        marker end = [0, 0, -200] mm
        start angular_velocity = [0, 0, 314] rad/s
    }
    joint thrust = Spherical(rotor.end, foot)
    drive turn = PrescribedRotation(rotor.neck, axis, speed: 314 rad/s)
    journal main = Short(pin: rotor.neck, shell: axis, diameter: 40 mm, width: 15 mm,
        radial_clearance: 20 um, viscosity: 20 mPa*s)
    cycle angle = rotation(rotor.neck, axis) { period = 360 deg }
}
analysis steady = transient(Rotor(), duration: 5 ms, sample: 1 ms, start: quasi_static)
",
    );
    let outcome = run(&analysis(&program, "steady")
        .gradients(&["main.radial_clearance"])
        .unwrap());
    let column = |results: &Results, name: &str| results.column(name).unwrap().values.clone();
    let ratios = column(&outcome.results, "main.film_ratio");
    let slopes = column(&outcome.gradients[0].results, "main.film_ratio");
    let f = |e: f64| {
        let rest = 1.0 - e * e;
        e * (16.0 * e * e + std::f64::consts::PI.powi(2) * rest).sqrt() / (rest * rest)
    };
    for (e, slope) in ratios.iter().zip(&slopes) {
        let by_e = (f(e + 1e-6) - f(e - 1e-6)) / 2e-6;
        let due = 2.0 * f(*e) / (20e-6 * by_e);
        println!("ratio {e:.4}: {slope:.6e} for {due:.6e}");
        assert!((slope / due - 1.0).abs() < 1e-5, "{slope} for {due}");
    }
}

/// A warning of the gradients has a label of its own, and the places of the function and of its use.
#[test]
fn a_kink_of_the_motion_is_told_at_its_place() {
    let program = program(
        "
use std.joints.Translational
force Press(a: Marker, b: Marker, rate: Stiffness) {
    let depth = dot(a.origin - b.origin, b.z)
    apply force -rate*max(depth, 0 mm)*b.z on a against b
}
model Mass {
    param rate: Stiffness = 1 N/mm
    gravity = [0, 0, 0] m/s^2
    marker wall = [0, 0, 0] mm
    body block { mass = 1 kg; inertia = [1, 1, 1] g*m^2; marker eye = origin }
    joint rail = Translational(block.eye, wall)
    force press = Press(block.eye, wall, rate: rate)
    start rail.travel = -0.1 mm
    start rail.speed = 0.1 m/s
}
analysis lands = transient(Mass(), duration: 2 ms, sample: 1 ms, gradients: [rate])
",
    );
    let outcome = match eng::run::run(&analysis(&program, "lands"), false, &mut |_| {}) {
        Ok(outcome) => outcome,
        Err(failed) => panic!("{}", failed.error),
    };
    let text = eng::render::human(
        &outcome.diagnostics,
        program.texts(),
        eng::render::Colors::None,
    );
    println!("{text}");
    assert!(
        text.contains("press: the motion stands at its kink"),
        "{text}"
    );
    assert!(text.contains("this function"), "{text}");
    assert!(!text.contains("the condition fails"), "{text}");
}
