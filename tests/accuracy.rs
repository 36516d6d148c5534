//! Accuracy of tight tolerances: only rounding limits it, and a message reports a tolerance below rounding.

use eng::{Model, Simulation, Sources};
use eng_runtime::RuntimeError;
use std::path::Path;

/// A light shaft with an unbalance, in a film whose damping outweighs its inertia by far.
const ROTOR: &str = "
use std.joints.{ParallelAxes, PointOnPlane}
use std.journals.Short
model Rotor {
    gravity = [0, -9.81, 0] m/s^2
    marker shell = [0, 0, 0] mm
    body shaft {
        mass = 0.4 kg
        inertia = [1, 1, 1] g*m^2
        center_of_mass = [0.03, 0.01, 0] mm
        marker pin = origin
        start position = [2, -10, 0] um
        start angular_velocity = [0, 0, 1]*(6000 rpm)
    }
    joint upright = ParallelAxes(shaft.pin, shell)
    joint thrust = PointOnPlane(shaft.pin, shell)
    journal film = Short(shaft.pin, shell, diameter: 30 mm, width: 8 mm, radial_clearance: 30 um, viscosity: 10 mPa*s)
}";

fn model(text: &str, name: &str) -> Model {
    eng::check(&Sources::from_text("m.eng", text), "m.eng")
        .into_program()
        .unwrap_or_else(|report| panic!("{report}"))
        .model(name)
        .unwrap_or_else(|error| panic!("{error}"))
}

fn values<const N: usize>(
    model: &Model,
    simulation: &mut Simulation,
    paths: [&str; N],
) -> [f64; N] {
    paths.map(|path| {
        let channel = model.channel(path).expect("a channel");
        simulation.value(channel).expect("a value")
    })
}

fn to_the_end(mut simulation: Simulation, end: f64) -> Simulation {
    while simulation.time() < end {
        simulation
            .runtime()
            .step_within(end)
            .unwrap_or_else(|error| panic!("{error}"));
    }
    simulation
}

const FILM: [&str; 2] = ["film.force.x", "film.force.y"];

/// The film's force after 4 ms in steps of h, and the largest error of its components.
fn film_after(model: &Model, h: f64) -> [f64; 2] {
    let simulation = model.simulation().fixed_step_to(h, 1e-4).start();
    let mut simulation = to_the_end(simulation.unwrap_or_else(|e| panic!("{e}")), 4e-3);
    values(model, &mut simulation, FILM)
}

/// Forces of a film follow the step's square down to 1e-7 of themselves.
#[test]
fn forces_of_films_converge_to_rounding() {
    let model = model(ROTOR, "Rotor");
    let [eight, four, two, one] = [8e-6, 4e-6, 2e-6, 1e-6].map(|h| film_after(&model, h));
    let exact: [f64; 2] = std::array::from_fn(|i| (4.0 * one[i] - two[i]) / 3.0);
    let size = exact[0].hypot(exact[1]);
    let error =
        |found: [f64; 2]| (found[0] - exact[0]).abs().max((found[1] - exact[1]).abs()) / size;
    let errors = [eight, four, two, one].map(error);
    println!("{size} N: {errors:?}");
    for pair in errors[..3].windows(2) {
        let ratio = pair[0] / pair[1];
        assert!((3.7..4.3).contains(&ratio), "{errors:?}");
    }
    assert!(errors[3] < 1e-7, "{errors:?}");
    let mut before = f64::INFINITY;
    for tolerance in [1.0, 1e-1, 1e-2, 1e-3, 1e-4, 1e-5] {
        let simulation = model.simulation().tolerance(tolerance).start();
        let mut simulation = to_the_end(simulation.unwrap_or_else(|e| panic!("{e}")), 4e-3);
        let found = error(values(&model, &mut simulation, FILM));
        println!(
            "tolerance {tolerance}: {found:.2e}, {:?}",
            simulation.statistics()
        );
        assert!(found < 0.4 * before, "{tolerance}: {found:e}");
        before = found;
    }
    assert!(before < 1e-7, "{before:e}");
}

/// At the usual tolerance the error of the iterations is below that of the steps: reactions of 0.4 N beside forces of
/// 6 kN are those of iterations to 1e-12. Both runs have the same steps. With ten times the goal the error is 1.6e-3.
#[test]
fn iterations_leave_little_in_small_reactions() {
    const SMALL: [&str; 6] = [
        "big_end[1].force.z",
        "big_end[2].force.z",
        "big_end[1].torque.x",
        "big_end[2].torque.x",
        "mounts.force.z",
        "mounts.torque.x",
    ];
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/inline4");
    let model = eng::check(
        &Sources::folder(&folder).expect("the example's folder"),
        "by_hand.eng",
    )
    .into_program()
    .unwrap_or_else(|report| panic!("{report}"))
    .model("Inline4")
    .unwrap_or_else(|error| panic!("{error}"));
    let combustion = model.parameter("combustion").expect("a parameter");
    let run = |tolerance: f64| -> Vec<[f64; 6]> {
        let mut simulation = model
            .simulation()
            .set(combustion, "0".parse().expect("a number"))
            .expect("a parameter")
            .fixed_step_to(1e-5, tolerance)
            .start()
            .unwrap_or_else(|error| panic!("{error}"));
        (0..400)
            .map(|_| {
                simulation.step().unwrap_or_else(|error| panic!("{error}"));
                values(&model, &mut simulation, SMALL)
            })
            .collect()
    };
    let (usual, fine) = (run(1.0), run(1e-3));
    for (i, name) in SMALL.iter().enumerate() {
        let of = |row: &[f64; 6]| row[i];
        let least = fine.iter().map(of).fold(f64::INFINITY, f64::min);
        let swing = fine.iter().map(of).fold(f64::NEG_INFINITY, f64::max) - least;
        let off = usual
            .iter()
            .zip(&fine)
            .fold(0.0_f64, |w, (a, b)| w.max((a[i] - b[i]).abs()));
        println!("{name}: {:.1e} of {swing}", off / swing);
        assert!(off < 1e-4 * swing, "{name}: {off:e} of {swing}");
    }
}

/// A slider-crank that coasts, at a distance from the origin.
const COASTING: &str = "
use std.joints.{Revolute, PointOnLine, Translational}
model Coasting {
    gravity = [-9.81, 0, 0] m/s^2
    marker rail = [300, 200, 0] mm
    marker bore = at([300, 200, 0] mm, z: [1, 0, 0])
    body crank {
        mass = 2 kg; inertia = [6, 6, 4] g*m^2
        marker main = origin
        marker pin = [40, 0, 0] mm
        start angular_velocity = [0, 0, 1]*(3000 rpm)
    }
    body rod { mass = 0.6 kg; inertia = [2.5, 0.1, 2.5] g*m^2; marker big = [0, -40, 0] mm; marker small = [0, 100, 0] mm }
    body piston { mass = 0.5 kg; inertia = [0.5, 0.4, 0.4] g*m^2; marker pin = origin; marker crown = at(origin, z: [1, 0, 0]) }
    joint main = Revolute(crank.main, rail)
    joint big_end = Revolute(rod.big, crank.pin)
    joint wrist = PointOnLine(rod.small, piston.pin)
    joint liner = Translational(piston.crown, bore) { branch travel > 0 mm }
    start rotation(crank.main, rail) = 20 deg
}";

/// A tolerance below rounding is refused. The least tolerance that the message names works: steps do not shrink to
/// nothing.
#[test]
fn tolerances_below_rounding_are_refused_and_the_least_is_kept() {
    for (text, name) in [(ROTOR, "Rotor"), (COASTING, "Coasting")] {
        let model = model(text, name);
        let least = match model.simulation().tolerance(1e-12).start() {
            Err(eng::Error::Run { cause, .. }) => match *cause {
                RuntimeError::Rounding { least, .. } => least,
                other => panic!("{other}"),
            },
            Err(other) => panic!("{other}"),
            Ok(_) => panic!("{name}: it starts"),
        };
        let mut simulation = model
            .simulation()
            .tolerance(least)
            .start()
            .unwrap_or_else(|error| panic!("{error}"));
        for _ in 0..2000 {
            simulation
                .step()
                .unwrap_or_else(|error| panic!("{name} at {least:e}: {error}"));
        }
        println!("{name}: {least:e}, {} s in 2000 steps", simulation.time());
        let rejected = simulation.statistics().rejected;
        assert!(
            rejected < 200 && simulation.time() > 2e-5,
            "{name}: {rejected}"
        );
    }
}

/// A kilogram on an undamped spring, a micrometre from its place: ten times the tolerance of positions, which
/// is 1e-7 m here.
fn on_a_spring(stiffness: f64, travel: f64) -> Model {
    let text = format!(
        "
use std.joints.Translational
use std.forces.LinearSpring
model Stiff {{
    gravity = [0, 0, 0] m/s^2
    marker rail = at([0, 0, 0] mm, z: [1, 0, 0])
    marker anchor = at([-100, 0, 0] mm, z: [1, 0, 0])
    body slider {{ mass = 1 kg; inertia = [1, 1, 1] g*m^2; marker pin = at(origin, z: [1, 0, 0]); accept inertia }}
    joint guide = Translational(slider.pin, rail)
    force spring = LinearSpring(slider.pin, anchor, stiffness: {stiffness:e} N/m, damping: 0 N*s/m, free_length: 100 mm)
    start guide.travel = {travel:e} m
}}"
    );
    model(&text, "Stiff")
}

/// An undamped vibration keeps its amplitude within the tolerance, or a warning reports that the steps damp it. There
/// is no warning about vibrations that the steps follow, or that are smaller than the tolerance.
#[test]
fn a_vibration_that_the_steps_damp_is_told() {
    const AMPLITUDE: f64 = 1e-6;
    const TOLERANCE: f64 = 1e-7;
    let mut told = 0;
    for exponent in 3..=15 {
        let stiffness = 10_f64.powi(exponent);
        let model = on_a_spring(stiffness, AMPLITUDE);
        for fixed in [None, Some(1e-5)] {
            let start = match fixed {
                None => model.simulation().start(),
                Some(step) => model.simulation().fixed_step(step).start(),
            };
            let mut simulation = to_the_end(start.unwrap_or_else(|e| panic!("{e}")), 0.01);
            let runtime = simulation.runtime();
            let state = runtime.state();
            let (x, v) = (state.pose[0], state.velocity[0]);
            let amplitude = (x * x + v * v / stiffness).sqrt();
            let damped = runtime.damped();
            println!("{stiffness:e} N/m, {fixed:?}: {amplitude:e} m, {damped:?}");
            match damped {
                None => assert!(
                    (amplitude - AMPLITUDE).abs() < TOLERANCE,
                    "{stiffness:e} N/m, {fixed:?}: {amplitude:e} m"
                ),
                Some(damped) => {
                    told += 1;
                    assert!(exponent > 6, "{stiffness:e} N/m: {damped:?}");
                    assert_eq!(damped.body.path, "slider");
                    // one step says the frequency of a single vibration well enough to name it
                    let ratio = damped.frequency / stiffness.sqrt();
                    assert!((0.8..1.2).contains(&ratio), "{stiffness:e} N/m: {damped:?}");
                }
            }
        }
        let small = on_a_spring(stiffness, 1e-3 * TOLERANCE)
            .simulation()
            .start();
        let mut small = to_the_end(small.unwrap_or_else(|e| panic!("{e}")), 1e-3);
        assert_eq!(small.runtime().damped(), None, "{stiffness:e} N/m");
    }
    assert!(told >= 9, "{told} of 26");
}

/// A drive turns a wheel at a constant speed from any angle. It does no work, and rounding of the angle does
/// not shorten the steps.
#[test]
fn a_steady_drive_does_no_work_wherever_it_begins() {
    for angle in [0.0, 10.0, 63.0, 200.0, 350.0] {
        let text = format!(
            "
use std.joints.Revolute
use std.drives.PrescribedRotation
model Wheel {{
    gravity = [0, 0, 0] m/s^2
    marker base = [0, 0, 0] mm
    body wheel {{ mass = 1.5 kg; inertia = [4, 4, 5] g*m^2; marker hub = origin }}
    joint bearing = Revolute(wheel.hub, base)
    drive turn = PrescribedRotation(wheel.hub, base, speed: -12345 rpm, initial: {angle} deg)
}}"
        );
        let start = model(&text, "Wheel").simulation().start();
        let mut simulation = to_the_end(start.unwrap_or_else(|e| panic!("{e}")), 0.01);
        let steps = simulation.statistics().steps;
        let energy = simulation.runtime().energy();
        println!(
            "{angle} deg: {:e} of {} J in {steps} steps",
            energy.constraints, energy.kinetic
        );
        assert!(
            energy.constraints.abs() < 1e-9 * energy.kinetic,
            "{angle} deg: {:e} of {} J",
            energy.constraints,
            energy.kinetic
        );
    }
}
