//! Gradients of periodic motions: closed forms, central differences of motions that repeat closely, and refusals.

use crate::gradients::{analysis, differences, run, size, value};
use crate::support::{program, program_of};
use eng::{Analysis, Outcome, Program, Results};
use std::path::Path;

/// A table on a spring along z. A rotor with an offset of its mass turns on it at a given speed about x.
fn shaker(more: &str) -> String {
    format!(
        "
use std.joints.{{Revolute, Translational}}
use std.drives.PrescribedRotation

force Mount(a: Marker, b: Marker, stiffness: Stiffness, damping: Damping) {{
    let away = dot(a.origin - b.origin, b.z)
    let rate = dot(a.velocity - b.velocity, b.z)
    apply force -(stiffness*away + damping*rate)*b.z on a against b
}}

model Shaker {{
    param stiffness: Stiffness = 4e4 N/m
    param damping: Damping = 60 N*s/m
    param offset: Length = 2 mm
    param speed: AngularVelocity = 80 rad/s
    param rotor_mass: Mass = 1 kg
    gravity = [0, 0, 0] m/s^2
    marker wall = origin
    body table {{
        mass = 4 kg
        inertia = [10, 10, 10] g*m^2
        marker eye = origin
        marker axle = at([0, 0, 0] mm, z: [1, 0, 0])
    }}
    body rotor {{
        mass = rotor_mass
        inertia = [1, 1, 1] g*m^2
        center_of_mass = [0, 0, 1]*offset
        marker hub = at([0, 0, 0] mm, z: [1, 0, 0])
        start angular_velocity = [1, 0, 0]*speed
    }}
    joint rail = Translational(table.eye, wall)
    joint hinge = Revolute(rotor.hub, table.axle)
    drive turn = PrescribedRotation(rotor.hub, table.axle, speed: speed)
    force mount = Mount(table.eye, wall, stiffness: stiffness, damping: damping)
    cycle angle = rotation(rotor.hub, table.axle) {{ period = 360 deg }}
    output x: Length = dot(table.eye.origin, ground.z)
}}

{more}
"
    )
}

/// A wheel with an offset of its mass. A torque that falls with the speed turns it, so its speed and the time of a cycle are
/// results, and the speed approaches its limit slowly.
pub(crate) fn wheel(more: &str) -> String {
    format!(
        "
use std.joints.Revolute

force Engine(a: Marker, b: Marker, stall: Torque, drag: TorsionalDamping) {{
    let rate = dot(a.angular_velocity - b.angular_velocity, b.z)
    apply torque (stall - drag*rate)*b.z on a against b
}}

model Wheel {{
    param stall: Torque = 2 N*m
    param drag: TorsionalDamping = 0.02 N*m*s/rad
    param offset: Length = 20 mm
    param pull: Acceleration = 9.81 m/s^2
    gravity = [0, -1, 0]*pull
    marker stand = origin
    body rotor {{
        mass = 1 kg
        inertia = [6, 6, 12] g*m^2
        center_of_mass = [1, 0, 0]*offset
        marker hub = origin
        start angular_velocity = [0, 0, 90] rad/s
    }}
    joint hinge = Revolute(rotor.hub, stand)
    force engine = Engine(rotor.hub, stand, stall: stall, drag: drag)
    cycle angle = rotation(rotor.hub, stand) {{ period = 360 deg }}
    output speed: AngularVelocity = hinge.speed
}}

{more}
"
    )
}

fn column<'r>(results: &'r Results, name: &str) -> &'r [f64] {
    &results.column(name).unwrap().values
}

fn refusal(analysis: &Analysis) -> String {
    match analysis.run(&mut |_| {}) {
        Ok(_) => panic!("it must be refused"),
        Err(failed) => failed.error.to_string(),
    }
}

/// `X = m e Ω²/(k − (M + m) Ω² + i c Ω)`, real and imaginary part, with `x = Re(X e^{iθ})` of the table.
fn amplitude([k, c, e, speed, m]: [f64; 5]) -> [f64; 2] {
    let load = m * e * speed * speed;
    let [re, im] = [k - (4.0 + m) * speed * speed, c * speed];
    let square = re * re + im * im;
    [load * re / square, -load * im / square]
}

/// Amplitude and phase in closed form. A deviation shrinks by 0.62 in a cycle.
#[test]
fn a_shaken_table_has_the_derivatives_of_its_amplitude() {
    let program = program(&shaker(
        "analysis shaken = periodic(Shaker(), sample: 5 deg, change: 1e-5, tolerance: 0.01)",
    ));
    let paths = ["stiffness", "damping", "offset", "speed", "rotor_mass"];
    let plain = analysis(&program, "shaken");
    let outcome = run(&plain.clone().gradients(&paths).unwrap());
    let at: Vec<f64> = paths.iter().map(|path| value(&plain, path)).collect();
    let at: [f64; 5] = at.try_into().unwrap();
    for (index, gradient) in outcome.gradients.iter().enumerate() {
        let h = 1e-4 * at[index];
        let near = |factor: f64| {
            let mut there = at;
            there[index] += factor * h;
            amplitude(there)
        };
        let (above, below) = (near(1.0), near(-1.0));
        let slope = [0, 1].map(|part| (above[part] - below[part]) / (2.0 * h));
        let angles = column(&gradient.results, "cycle.angle");
        let due: Vec<f64> = angles
            .iter()
            .map(|angle| slope[0] * angle.cos() - slope[1] * angle.sin())
            .collect();
        let got = column(&gradient.results, "x");
        assert_eq!(got.len(), 73);
        let errors: Vec<f64> = got.iter().zip(&due).map(|(a, b)| a - b).collect();
        let error = size(&errors) / size(&due);
        println!("x by {}: {error:.1e}", gradient.parameter);
        assert!(error < 1e-4, "{}: {error}", gradient.parameter);
        // t = θ/Ω from the beginning of the cycle on
        let times = column(&gradient.results, "time.gradient");
        for (time, angle) in times.iter().zip(angles) {
            let due = match index {
                3 => -(angle - angles[0]) / (at[3] * at[3]),
                _ => 0.0,
            };
            assert!((time - due).abs() < 1e-9, "{time} for {due}");
        }
        assert!(size(column(&gradient.results, "cycle.angle.gradient")) == 0.0);
    }
}

/// The largest error of the derivatives of channels by a parameter against differences of whole analyses, as a share of
/// the largest derivative of the channel.
fn worst(plain: &Analysis, outcome: &Outcome, at: usize, names: &[&str], share: f64) -> f64 {
    let gradient = &outcome.gradients[at];
    let expected = differences(plain, &gradient.parameter, share, |analysis| {
        let results = run(analysis).results;
        let columns = names.iter().map(|name| column(&results, name).to_vec());
        columns.collect::<Vec<_>>().concat()
    });
    let count = gradient.results.samples();
    let mut worst = 0.0_f64;
    for (name, expected) in names.iter().zip(expected.chunks(count)) {
        let got = column(&gradient.results, name);
        let errors: Vec<f64> = got.iter().zip(expected).map(|(a, b)| a - b).collect();
        let error = size(&errors) / size(expected);
        println!("{name} by {}: {error:.1e}", gradient.parameter);
        worst = worst.max(error);
    }
    worst
}

/// The time of a cycle is a result. The slow motion leaves 0.9 of a deviation after a cycle.
#[test]
fn a_wheel_that_finds_its_speed_has_the_derivatives_of_differences() {
    let program = program(&wheel(
        "analysis turns = periodic(Wheel(), sample: 10 deg, change: 1e-7, cycles: 400, tolerance: 0.01)",
    ));
    let plain = analysis(&program, "turns");
    let paths = ["stall", "drag", "offset"];
    let outcome = run(&plain.clone().gradients(&paths).unwrap());
    for index in 0..paths.len() {
        let names = ["speed", "hinge.force.x", "hinge.force.y"];
        let error = worst(&plain, &outcome, index, &names, 1e-2);
        assert!(error < 1e-4, "{}: {error}", paths[index]);
    }
    // the weight has no work over a cycle, so the mean speed over time is stall/drag but for the square of its small changes
    let due = [1.0 / 0.02, -2.0 / (0.02 * 0.02), 0.0];
    for (gradient, due) in outcome.gradients.iter().zip(due) {
        let times = column(&outcome.results, "time");
        let period = times[times.len() - 1] - times[0];
        let shifts = column(&gradient.results, "time.gradient");
        let got = -std::f64::consts::TAU * shifts[shifts.len() - 1] / (period * period);
        let scale = 100.0 / value(&plain, &gradient.parameter);
        println!("mean speed by {}: {got} for {due}", gradient.parameter);
        assert!((got - due).abs() < 1e-4 * scale, "{got} for {due}");
    }
}

/// The recorded motion and its summary are those of an analysis without gradients.
#[test]
fn a_periodic_analysis_has_the_same_bits_with_gradients() {
    let program = program(&shaker(
        "analysis shaken = periodic(Shaker(), sample: 15 deg, gradients: [stiffness, speed])",
    ));
    let with = analysis(&program, "shaken");
    let without = with.clone().gradients::<&str>(&[]).unwrap();
    let (with, without) = (run(&with), run(&without));
    assert_eq!(with.gradients.len(), 2);
    for (a, b) in with.results.columns().iter().zip(without.results.columns()) {
        let bits = |values: &[f64]| values.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&a.values), bits(&b.values), "{}", a.path);
    }
    for gradient in &with.gradients {
        for name in ["time", "cycle.angle", "cycle.speed"] {
            assert_eq!(
                column(&gradient.results, name),
                column(&with.results, name),
                "{name}"
            );
        }
    }
    assert_eq!(with.summary, without.summary);
    assert_eq!(with.periodic, without.periodic);
}

/// Ocvirk's bearing at a steady load: see `gradients::the_eccentricity_of_a_short_bearing_follows_its_clearance`. The start
/// is not in balance.
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
analysis steady = periodic(Rotor(), sample: 30 deg, change: 1e-6, cycles: 200, start: assembled)
",
    );
    let outcome = run(&analysis(&program, "steady")
        .gradients(&["main.radial_clearance"])
        .unwrap());
    let ratios = column(&outcome.results, "main.film_ratio");
    let slopes = column(&outcome.gradients[0].results, "main.film_ratio");
    let f = |e: f64| {
        let rest = 1.0 - e * e;
        e * (16.0 * e * e + std::f64::consts::PI.powi(2) * rest).sqrt() / (rest * rest)
    };
    for (e, slope) in ratios.iter().zip(slopes) {
        let by_e = (f(e + 1e-6) - f(e - 1e-6)) / 2e-6;
        let due = 2.0 * f(*e) / (20e-6 * by_e);
        println!("ratio {e:.4}: {slope:.6e} for {due:.6e}");
        assert!((slope / due - 1.0).abs() < 1e-4, "{slope} for {due}");
    }
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

/// The fired engine in its repeated motion: a clearance changes its own film most.
#[test]
fn a_fired_engine_has_the_derivatives_of_differences() {
    let program = engine(
        "analysis settled = periodic(Inline4(), sample: 10 deg, change: 1e-5, tolerance: 0.1)",
    );
    let plain = analysis(&program, "settled");
    let path = "main[3].radial_clearance";
    let outcome = run(&plain.clone().gradients(&[path]).unwrap());
    let names = ["main[3].minimum_film", "main[3].force.x", "main[3].force.y"];
    let error = worst(&plain, &outcome, 0, &names, 2e-2);
    assert!(error < 1e-3, "{error}");
}

/// A wheel that nothing brakes keeps every speed, so the parameters do not decide it.
#[test]
fn a_motion_that_keeps_its_start_is_refused() {
    let text = wheel("analysis turns = periodic(Wheel(), sample: 30 deg, gradients: [offset])");
    let text = text.replace("(stall - drag*rate)", "0*(stall - drag*rate)");
    let message = refusal(&analysis(&program(&text), "turns"));
    println!("{message}");
    assert!(
        message.contains("a deviation of rotor does not decay"),
        "{message}"
    );
}

/// All reasons without gradients, of motions in time and of those that repeat.
#[test]
fn motions_without_gradients_are_refused_with_their_reasons() {
    let shaken = |text: &str, more: &str| shaker(text).replace("1 kg\n    grav", more);
    let slow =
        "analysis shaken = periodic(Shaker(), sample: 30 deg, cycles: 3, gradients: [stiffness])";
    let short = "analysis shaken = periodic(Shaker(), sample: 30 deg, change: 30 %, cycles: 3, gradients: [damping])";
    let unused = "analysis shaken = periodic(Shaker(), gradients: [unused])";
    let zero = "analysis shaken = transient(Shaker(), duration: 10 ms, gradients: [zero])";
    let driven = "analysis shaken = periodic(Shaker(), gradients: [force])";
    let zero_param = "1 kg\n    param unused: Length = 1 mm\n    param zero: Force = 0 N\n    input force: Force = 0 N\n    grav";
    let free = wheel("analysis shaken = periodic(Wheel(), sample: 30 deg, gradients: [offset])")
        .replace("(stall - drag*rate)", "0*(stall - drag*rate)");
    let jumping = wheel("analysis shaken = periodic(Wheel(), sample: 10 deg, gradients: [stall])")
        .replace(
            "(stall - drag*rate)",
            "(stall - drag*rate + (if rate > 100 rad/s then 0.2*stall else 0*stall))",
        );
    let film = "
use std.joints.Spherical
use std.journals.Film
use std.drives.PrescribedRotation
model Rotor {
    param clearance: Length = 20 um
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
    journal main = Film(pin: rotor.neck, shell: axis, diameter: 40 mm, width: 15 mm,
        radial_clearance: clearance, viscosity: 20 mPa*s)
    cycle angle = rotation(rotor.neck, axis) { period = 360 deg }
}
analysis shaken = periodic(Rotor(), gradients: [clearance])
";
    let cases = [
        ("does not repeat", shaken(slow, "1 kg\n    grav")),
        ("repeats too late", shaken(short, "1 kg\n    grav")),
        ("no effect", shaken(unused, zero_param)),
        ("zero without limits", shaken(zero, zero_param)),
        ("an input", shaken(driven, zero_param)),
        ("a start that stays", free),
        ("a jump", jumping),
        ("a film on cells", film.to_owned()),
    ];
    let said = cases.iter().map(|(name, text)| {
        let message = refusal(&analysis(&program(text), "shaken"));
        format!("{name}: {message}")
    });
    insta::assert_snapshot!(said.collect::<Vec<_>>().join("\n"));
}
