//! Gradients of periodic motions: closed forms, central differences of motions that repeat closely, and refusals.

use crate::gradients::{analysis, differences, exact, run, size, value};
use crate::support::program;
use eng::{Analysis, Outcome, Results};

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
    param damping: Damping = 200 N*s/m
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
pub(crate) fn motor_wheel(more: &str) -> String {
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

/// Amplitude and phase in closed form. A deviation shrinks by 0.21 in a cycle.
#[test]
fn a_shaken_table_has_the_derivatives_of_its_amplitude() {
    let program = program(&shaker(
        "analysis shaken = periodic(Shaker(), sample: 20 deg, change: 1e-5)",
    ));
    let paths = ["stiffness", "damping", "offset", "speed", "rotor_mass"];
    let plain = analysis(&program, "shaken").stepping(exact(2e-4));
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
        assert_eq!(got.len(), 19);
        let errors: Vec<f64> = got.iter().zip(&due).map(|(a, b)| a - b).collect();
        let error = size(&errors) / size(&due);
        println!("x by {}: {error:.1e}", gradient.parameter);
        assert!(error < 4e-4, "{}: {error}", gradient.parameter);
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
    let program = program(&motor_wheel(
        "analysis turns = periodic(Wheel(), sample: 30 deg, change: 1e-7, cycles: 400)",
    ));
    let plain = analysis(&program, "turns").stepping(exact(2e-4));
    let paths = ["stall", "drag", "offset"];
    let outcome = run(&plain.clone().gradients(&paths).unwrap());
    for (index, path) in paths.iter().enumerate() {
        let names = ["speed", "hinge.force.x", "hinge.force.y"];
        let error = worst(&plain, &outcome, index, &names, 1e-2);
        assert!(error < 1e-4, "{path}: {error}");
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

/// A rotor in Ocvirk's bearing.
fn rotor(more: &str) -> String {
    format!(
        "
use std.joints.Spherical
use std.journals.Short
use std.drives.PrescribedRotation
model Rotor {{
    param unbalance: Length = 0 mm
    gravity = [-9.81, 0, 0] m/s^2
    marker axis = [0, 0, 0] mm
    marker foot = [0, 0, -200] mm
    body rotor {{
        mass = 20 kg
        inertia = [300, 300, 40] g*m^2
        center_of_mass = [1, 0, 0]*unbalance
        marker neck = origin
        marker end = [0, 0, -200] mm
        start angular_velocity = [0, 0, 314] rad/s
    }}
    joint thrust = Spherical(rotor.end, foot)
    drive turn = PrescribedRotation(rotor.neck, axis, speed: 314 rad/s)
    journal main = Short(pin: rotor.neck, shell: axis, diameter: 40 mm, width: 15 mm,
        radial_clearance: 20 um, viscosity: 20 mPa*s)
    cycle angle = rotation(rotor.neck, axis) {{ period = 360 deg }}
}}
{more}
"
    )
}

/// Ocvirk's bearing at a steady load: see `gradients::the_eccentricity_of_a_short_bearing_follows_its_clearance`. The start
/// is not in balance.
#[test]
fn the_eccentricity_of_a_short_bearing_follows_its_clearance() {
    let program = program(&rotor(
        "analysis steady = periodic(Rotor(), sample: 30 deg, change: 1e-6, cycles: 200, start: assembled)",
    ));
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

/// An unbalance leads the pin round an orbit in the film, whose force is no linear function of the orbit.
#[test]
fn the_orbit_of_a_short_bearing_has_the_derivatives_of_differences() {
    let program = program(&rotor(
        "analysis orbit = periodic(Rotor(unbalance: 50 um), sample: 20 deg, change: 1e-7, cycles: 200)",
    ));
    let plain = analysis(&program, "orbit").stepping(exact(1e-4));
    let paths = ["main.radial_clearance", "unbalance"];
    let outcome = run(&plain.clone().gradients(&paths).unwrap());
    for (index, path) in paths.iter().enumerate() {
        let names = ["main.minimum_film", "main.film_ratio", "main.power_loss"];
        let error = worst(&plain, &outcome, index, &names, 1e-3);
        assert!(error < 1e-4, "{path}: {error}");
    }
}

/// The damper of the table loses `W = π c Ω |X|²` in a cycle. Nothing reads this work, and it grows in each cycle.
#[test]
fn a_work_has_the_derivative_of_its_growth_in_a_cycle() {
    let with = |of_stiffness: &str| {
        let text = shaker("analysis shaken = periodic(Shaker(), sample: 30 deg, change: 1e-4)");
        let text = text.replace(
            "    apply force -(stiffness*away",
            &format!(
                "    state work: Energy = 0 J scale 1 J
    der(work) = damping*rate^2
    output lost: Energy = work
    apply force -(stiffness*{of_stiffness}away"
            ),
        );
        program(&text)
    };
    let paths = ["damping", "speed"];
    let program = with("");
    let plain = analysis(&program, "shaken").stepping(exact(2e-4));
    let outcome = run(&plain.clone().gradients(&paths).unwrap());
    let at = ["stiffness", "damping", "offset", "speed", "rotor_mass"];
    let at = at.map(|path| value(&plain, path));
    let loss = |at: [f64; 5]| {
        let [re, im] = amplitude(at);
        std::f64::consts::PI * at[1] * at[3] * (re * re + im * im)
    };
    let works = column(&outcome.results, "mount.lost");
    assert!(
        works[0] > 2.0 * loss(at),
        "the work counts from the start on"
    );
    for (gradient, index) in outcome.gradients.iter().zip([1, 3]) {
        let h = 1e-4 * at[index];
        let [mut above, mut below] = [at; 2];
        above[index] += h;
        below[index] -= h;
        let due = (loss(above) - loss(below)) / (2.0 * h);
        let got = column(&gradient.results, "mount.lost");
        let last = got[got.len() - 1];
        println!("work by {}: {last:.6e} for {due:.6e}", gradient.parameter);
        assert!(got[0] == 0.0, "{}", got[0]);
        assert!((last / due - 1.0).abs() < 1e-3, "{last} for {due}");
    }
    // a spring that reads the work is another one in each cycle, if only by a little
    let program = with("(1 + 1e-9*work/(1 J))*");
    let coarse = analysis(&program, "shaken").stepping(exact(1e-3));
    let message = refusal(&coarse.gradients(&paths).unwrap());
    println!("{message}");
    assert!(message.contains("a deviation of mount "), "{message}");
}

/// Wagons on soft springs beside a wheel whose friction stops it anywhere. The numbers of a deviation of all wagons are far
/// larger than that of the wheel, which alone stays.
#[test]
fn a_free_wheel_beside_a_long_train_is_refused() {
    let text = |spring: &str| {
        format!(
            "
use std.joints.{{Revolute, Translational}}
use std.drives.PrescribedRotation
force Mount(a: Marker, b: Marker, stiffness: Stiffness, damping: Damping) {{
    apply force -(stiffness*dot(a.origin - b.origin, b.z) + damping*dot(a.velocity - b.velocity, b.z))*b.z on a against b
}}
force Friction(a: Marker, b: Marker, stiffness: TorsionalStiffness) {{
    let sine = dot(a.x, b.y)
    apply torque -(1 N*m*s/rad*dot(a.angular_velocity - b.angular_velocity, b.z) + stiffness*1 rad*sine)*b.z on a against b
}}
model Train {{
    param stiffness: Stiffness = 10 N/m
    gravity = [0, 0, -1] m/s^2
    marker wall[i in 1..8] = [i*10, 0, 0] mm
    marker stand = origin
    body shaft {{ mass = 1 kg; inertia = [1, 1, 1] g*m^2; marker hub = origin; start angular_velocity = [0, 0, 100] rad/s }}
    body wheel {{ mass = 1 kg; inertia = [10, 10, 10] g*m^2; marker hub = origin }}
    body wagon[i in 1..8] {{
        mass = 1 kg
        inertia = [1, 1, 1] g*m^2
        marker eye = origin
        start position = [i*10, 0, 0] mm
    }}
    joint bearing = Revolute(shaft.hub, stand)
    joint pivot = Revolute(wheel.hub, stand)
    joint rail[i in 1..8] = Translational(wagon[i].eye, wall[i])
    drive turn = PrescribedRotation(shaft.hub, stand, speed: 100 rad/s)
    force mount[i in 1..8] = Mount(wagon[i].eye, wall[i], stiffness: stiffness, damping: 5 N*s/m)
    force friction = Friction(wheel.hub, stand, stiffness: {spring})
    cycle angle = rotation(shaft.hub, stand) {{ period = 360 deg }}
    output place: 1 = dot(wheel.hub.x, stand.x)
    output sag: Length = dot(wagon[1].eye.origin, ground.z)
}}
analysis rolls = periodic(Train(), sample: 180 deg, change: 1e-3, cycles: 100, gradients: [stiffness])
"
        )
    };
    let message = refusal(&analysis(&program(&text("0 N*m/rad")), "rolls"));
    println!("{message}");
    assert!(message.contains("a deviation of wheel "), "{message}");
    // with a spring the wheel returns, and a wagon sags by `m g/k`
    let outcome = run(&analysis(&program(&text("5 N*m/rad")), "rolls"));
    let got = column(&outcome.gradients[0].results, "sag");
    println!("sag: {got:?}");
    for got in got {
        assert!((got * 10.0 * 10.0 - 1.0).abs() < 2e-3, "{got}");
    }
}

/// A complete run is not run again. Its gradients are read, or made again if they are missing.
#[test]
fn a_complete_run_keeps_its_gradients() {
    let program = program(&rotor(
        "analysis orbit = periodic(Rotor(unbalance: 50 um), sample: 90 deg, change: 1 %, gradients: [unbalance])",
    ));
    let folder = std::env::temp_dir().join(format!("eng-repeated-{}", std::process::id()));
    let recording = |resume| eng::results::Recording {
        folder: Some(folder.clone()),
        resume,
        ..Default::default()
    };
    let made = |resume| run(&analysis(&program, "orbit").record(recording(resume)));
    let films = |outcome: &Outcome| {
        assert_eq!(outcome.gradients.len(), 1);
        column(&outcome.gradients[0].results, "main.minimum_film").to_vec()
    };
    let first = made(false);
    let again = made(true);
    assert!(!first.made_before && again.made_before);
    for (a, b) in films(&first).iter().zip(films(&again)) {
        assert!((a / b - 1.0).abs() < 1e-14, "{a} and {b}");
    }
    std::fs::remove_file(folder.join("orbit.gradients.parquet")).unwrap();
    let anew = made(true);
    assert!(!anew.made_before);
    assert_eq!(films(&first), films(&anew));
    std::fs::remove_dir_all(folder).unwrap();
}

/// All reasons without gradients, of motions in time and of those that repeat.
#[test]
fn motions_without_gradients_are_refused_with_their_reasons() {
    let shaken = |text: &str, more: &str| {
        let weakly = shaker(text).replace("200 N*s/m", "60 N*s/m");
        weakly.replace("1 kg\n    grav", more)
    };
    let slow =
        "analysis shaken = periodic(Shaker(), sample: 30 deg, cycles: 3, gradients: [stiffness])";
    let short = "analysis shaken = periodic(Shaker(), sample: 30 deg, change: 30 %, cycles: 3, gradients: [damping])";
    let few =
        "analysis shaken = periodic(Shaker(), sample: 30 deg, cycles: 2, gradients: [offset])";
    let unused = "analysis shaken = periodic(Shaker(), gradients: [unused])";
    let zero = "analysis shaken = transient(Shaker(), duration: 10 ms, gradients: [zero])";
    let driven = "analysis shaken = periodic(Shaker(), gradients: [force])";
    let zero_param = "1 kg\n    param unused: Length = 1 mm\n    param zero: Force = 0 N\n    input force: Force = 0 N\n    grav";
    let free =
        motor_wheel("analysis shaken = periodic(Wheel(), sample: 30 deg, gradients: [offset])")
            .replace("(stall - drag*rate)", "0*(stall - drag*rate)");
    let jumping =
        motor_wheel("analysis shaken = periodic(Wheel(), sample: 10 deg, gradients: [stall])")
            .replace(
                "(stall - drag*rate)",
                "(stall - drag*rate + (if dot(a.x, b.x) > 0 then 0.2*stall else 0*stall))",
            );
    let film = rotor("analysis shaken = periodic(Rotor(), gradients: [unbalance])")
        .replace("Short", "Film");
    let cases = [
        ("does not repeat", shaken(slow, "1 kg\n    grav")),
        ("repeats too late", shaken(short, "1 kg\n    grav")),
        ("too few cycles", shaken(few, "1 kg\n    grav")),
        ("no effect", shaken(unused, zero_param)),
        ("zero without limits", shaken(zero, zero_param)),
        ("an input", shaken(driven, zero_param)),
        ("a start that stays", free),
        ("a jump", jumping),
        ("a film on cells", film),
    ];
    let said = cases.iter().map(|(name, text)| {
        let message = refusal(&analysis(&program(text), "shaken"));
        format!("{name}: {message}")
    });
    insta::assert_snapshot!(said.collect::<Vec<_>>().join("\n"));
}
