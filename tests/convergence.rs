//! Order of convergence of whole programs: positions, velocities, reactions, and the audit of energy.

use eng::{Model, Simulation, Sources};

/// A slider-crank that coasts, against gravity and a torsional spring and damper on its crank.
const COASTING: &str = "
use std.joints.{Revolute, PointOnLine, Translational}
use std.forces.TorsionSpring
model Coasting {
    gravity = [-9.81, 0, 0] m/s^2
    marker rail = [0, 0, 0] mm
    marker bore = at([0, 0, 0] mm, z: [1, 0, 0])
    body crank {
        mass = 2 kg; inertia = [6, 6, 4] g*m^2; center_of_mass = [5, 0, 0] mm
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
    force brake = TorsionSpring(crank.main, rail, stiffness: 60 N*m/rad, damping: 0.2 N*m*s/rad)
    output place: Length = dot(piston.pin.origin, bore.z) as mm
    output speed: Velocity = dot(piston.pin.velocity, bore.z) as m/s
    output wall: Force = liner.force.x as N
}";

fn model(text: &str, name: &str) -> Model {
    eng::check(&Sources::from_text("m.eng", text), "m.eng")
        .into_program()
        .unwrap_or_else(|report| panic!("{report}"))
        .model(name)
        .unwrap_or_else(|error| panic!("{error}"))
}

fn values(model: &Model, simulation: &mut Simulation) -> [f64; 3] {
    ["place", "speed", "wall"].map(|path| {
        let channel = model.channel(path).expect("a channel");
        simulation.value(channel).expect("a value")
    })
}

/// Channels at the end of 5 ms, reached in `steps` steps whose lengths follow `pattern` over and over.
fn at_the_end(model: &Model, steps: usize, pattern: &[f64]) -> [f64; 3] {
    const END: f64 = 5e-3;
    let total: f64 = (0..steps).map(|k| pattern[k % pattern.len()]).sum();
    let mut simulation = model
        .simulation()
        .fixed_step(END)
        .start()
        .unwrap_or_else(|error| panic!("{error}"));
    let mut time = 0.0;
    for k in 0..steps {
        time += END * pattern[k % pattern.len()] / total;
        let end = if k + 1 == steps { END } else { time };
        simulation
            .runtime()
            .step_within(end)
            .unwrap_or_else(|error| panic!("{error}"));
    }
    assert_eq!(simulation.time(), END);
    values(model, &mut simulation)
}

#[test]
fn positions_velocities_and_reactions_converge_with_second_order() {
    let model = model(COASTING, "Coasting");
    let exact = at_the_end(&model, 12_000, &[1.0]);
    let names = ["position", "velocity", "reaction"];
    for (kind, pattern) in [("fixed", vec![1.0]), ("varying", vec![1.0, 0.6, 1.3, 0.8])] {
        let errors: Vec<[f64; 3]> = [150, 300, 600]
            .iter()
            .map(|steps| {
                let found = at_the_end(&model, *steps, &pattern);
                std::array::from_fn(|i| (found[i] - exact[i]).abs())
            })
            .collect();
        for (i, name) in names.iter().enumerate() {
            for pair in errors.windows(2) {
                let order = (pair[0][i] / pair[1][i]).log2();
                println!(
                    "{kind} steps, {name}: error {:.2e}, order {order:.3}",
                    pair[1][i]
                );
                assert!(
                    (1.9..2.6).contains(&order),
                    "{kind} steps: the {name} converges with order {order:.3}"
                );
            }
        }
    }
}

/// Work of spring, damper and gravity against kinetic energy: the audit closes, and better with smaller tolerances.
#[test]
fn the_audit_of_energy_closes() {
    let model = model(COASTING, "Coasting");
    let mut worst = Vec::new();
    for tolerance in [1.0, 0.1, 0.01] {
        let mut simulation = model
            .simulation()
            .tolerance(tolerance)
            .start()
            .unwrap_or_else(|error| panic!("{error}"));
        let start = simulation.energy().kinetic;
        let mut miss = 0.0_f64;
        while simulation.time() < 0.04 {
            simulation.step().unwrap_or_else(|error| panic!("{error}"));
            miss = miss.max(simulation.energy().imbalance().abs() / start);
        }
        println!("tolerance {tolerance}: imbalance {miss:.2e} of the energy at the start");
        worst.push(miss);
    }
    assert!(worst[0] < 1e-3 && worst[2] < 1e-5, "{worst:?}");
    assert!(
        worst[1] < 0.5 * worst[0] && worst[2] < 0.5 * worst[1],
        "{worst:?}"
    );
}

#[test]
fn a_spectral_radius_of_one_is_refused_with_constraints() {
    let error = model(COASTING, "Coasting")
        .simulation()
        .rho_infinity(1.0)
        .start()
        .expect_err("it is refused");
    assert!(error.to_string().contains("below 1"), "{error}");
}
