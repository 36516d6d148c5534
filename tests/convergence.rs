//! Order of convergence of whole programs: positions, velocities, reactions, and the audit of energy.

use eng::{Model, Simulation, Sources};

/// A slider-crank that coasts, against gravity and a torsional spring and damper on its crank.
const COASTING: &str = include_str!("benchmarks/coasting.eng");

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

/// Work of spring, damper and gravity against kinetic energy: the balance closes, and closes better with smaller
/// tolerances.
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

/// A V-twin, motored: its crank and overhung flywheel float on two films, whose damping answers a micron a
/// second with newtons.
const VTWIN: &str = "
use std.joints.{Revolute, PointOnLine, PointOnPlane, Translational, Fixed}
use std.drives.ConstantSpeed
use std.journals.Impedance
use std.forces.TorsionSpring
use std.oils.SAE_10W40
model VTwin {
    param speed: AngularVelocity = 6000 rpm
    param throw: Length = 34 mm
    const lean = [45, -45] deg
    gravity = [-9.81, 0, 0] m/s^2
    cycle angle = rotation(crank.flange, ground) { period = 720 deg }
    body crank {
        mass = 9 kg
        inertia = [40, 42, 14] g*m^2
        center_of_mass = [-2, 0, 0] mm
        marker main[j in 1..2] = [0 mm, 0 mm, (2*j - 3)*45 mm]
        marker pin[i in 1..2] = [throw, 0 mm, (2*i - 3)*11 mm]
        marker flange = [0, 0, 75] mm
        guess position = [10, 0, 0] um
        start angular_velocity = [0, 0, 1]*speed
    }
    body block {
        mass = 25 kg
        inertia = [0.5, 0.5, 0.4] kg*m^2
        marker main[j in 1..2] = [0 mm, 0 mm, (2*j - 3)*45 mm]
        marker liner[i in 1..2] = at([0 mm, 0 mm, (2*i - 3)*11 mm], z: [cos(lean[i]), sin(lean[i]), 0], x: [-sin(lean[i]), cos(lean[i]), 0])
        marker support = origin
    }
    body rod[i in 1..2] {
        mass = 0.4 kg
        inertia = [0.1, 1.2, 1.25] g*m^2
        marker big = [-35, 0, 0] mm
        marker small = [85, 0, 0] mm
    }
    body piston[i in 1..2] {
        mass = 0.38 kg
        inertia = [0.5, 0.4, 0.4] g*m^2
        marker pin = origin
        marker bore = at(origin, z: [1, 0, 0])
    }
    body flywheel {
        mass = 3 kg
        inertia = [0.504, 0.504, 1]*(0.02 kg*m^2)
        center_of_mass = [0, 0, 10] mm
        marker hub = origin
    }
    body dyno {
        mass = 20 kg
        inertia = [0.2, 0.2, 0.4] kg*m^2
        marker hub = origin
        guess position = [0, 0, 300] mm
    }
    joint mounts = Fixed(block.support, ground)
    joint thrust = PointOnPlane(crank.main[1], block.main[1])
    journal main[j in 1..2] = Impedance(
        pin: crank.main[j], shell: block.main[j],
        diameter: 46 mm, width: 24 mm, radial_clearance: 25 um,
        viscosity: SAE_10W40.viscosity(105 degC),
    )
    joint big_end[i in 1..2] = Revolute(rod[i].big, crank.pin[i])
    joint wrist[i in 1..2] = PointOnLine(rod[i].small, piston[i].pin)
    joint liner[i in 1..2] = Translational(piston[i].bore, block.liner[i]) { branch travel > 0 mm }
    joint bolts = Fixed(flywheel.hub, crank.flange)
    drive turn = ConstantSpeed(dyno.hub, ground, speed: speed)
    force coupling = TorsionSpring(flywheel.hub, dyno.hub, stiffness: 5e3 N*m/rad, damping: 3 N*m*s/rad)
    output piston_acceleration[i in 1..2]: Acceleration = dot(piston[i].pin.acceleration, block.liner[i].z)
    output pin_acceleration[j in 1..2]: Acceleration = dot(crank.main[j].acceleration, ground.x)
    output flange_acceleration: AngularAcceleration = dot(crank.flange.angular_acceleration, crank.flange.z)
}
analysis usual = transient(VTwin(), duration: 1 rev, sample: 2 deg)
analysis fine = transient(VTwin(), duration: 1 rev, sample: 2 deg, tolerance: 0.01)
";

/// Accelerations of the pins, and reactions that are small beside those of the pistons, are as accurate as all others
/// at the default tolerance. The reference is a hundredth of it, and the error of each sample counts as a share of
/// the channel's swing.
#[test]
fn small_accelerations_and_reactions_are_right_at_the_default_tolerance() {
    let program = eng::check(&Sources::from_text("v.eng", VTWIN), "v.eng")
        .into_program()
        .unwrap_or_else(|report| panic!("{report}"));
    let [usual, fine] = ["usual", "fine"].map(|analysis| {
        program
            .analysis(analysis)
            .unwrap_or_else(|error| panic!("{error}"))
            .run(&mut |_| {})
            .unwrap_or_else(|failed| panic!("{}", failed.error))
            .results
    });
    for (channel, bound) in [
        ("pin_acceleration[1]", 1e-2),
        ("pin_acceleration[2]", 5e-3),
        ("piston_acceleration[1]", 1e-5),
        ("bolts.force.x", 5e-3),
        ("bolts.force.y", 5e-3),
        ("bolts.force.z", 1e-2),
        ("big_end[1].torque.x", 5e-3),
        ("big_end[2].force.z", 5e-3),
        ("main[1].force.x", 1e-3),
        ("energy.kinetic", 1e-2),
    ] {
        let column = |results: &eng::Results| {
            results
                .column(channel)
                .unwrap_or_else(|| panic!("no {channel}"))
                .values
                .clone()
        };
        let (found, due) = (column(&usual), column(&fine));
        assert_eq!(found.len(), due.len());
        let (low, high) = due
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| {
                (l.min(*x), h.max(*x))
            });
        let worst = found
            .iter()
            .zip(&due)
            .map(|(a, b)| (a - b).abs() / (high - low))
            .enumerate()
            .fold((0, 0.0_f64), |w, x| if x.1 > w.1 { x } else { w });
        println!(
            "{channel}: {:.1e} of its swing {:.3e} at sample {}",
            worst.1,
            high - low,
            worst.0
        );
        assert!(
            worst.1 < bound,
            "{channel}: {:.2e} at sample {}",
            worst.1,
            worst.0
        );
    }
}

/// A blow of 4 N s within 0.4 ms, after a tenth of a second in which nothing moves: no step is longer than
/// the distance of samples.
#[test]
fn a_load_shorter_than_free_steps_is_seen() {
    const STRUCK: &str = "
        use std.joints.Translational
        use std.forces.Actuator
        table blow(t: Time) -> Force = points([0, 0.1, 0.1002, 0.1004, 1] s, [0, 0, 20, 0, 0] kN, interpolation: monotone)
        model Struck {
            gravity = [0, 0, 0] m/s^2
            marker wall = [0, 0, 0] mm
            body block { mass = 2 kg; inertia = [1, 1, 1] g*m^2 }
            joint rail = Translational(block.origin, wall)
            force hammer = Actuator(block.origin, wall, thrust: blow)
        }
        analysis strike = transient(Struck(), duration: 0.2 s, sample: 0.1 ms)";
    let program = eng::check(&Sources::from_text("m.eng", STRUCK), "m.eng")
        .into_program()
        .unwrap_or_else(|report| panic!("{report}"));
    let outcome = program
        .analysis("strike")
        .expect("an analysis")
        .run(&mut |_| {})
        .unwrap_or_else(|failed| panic!("{}", failed.error));
    let speed = outcome
        .results
        .column("rail.speed")
        .expect("a column")
        .shown();
    let last = speed.last().expect("samples");
    assert!((last - 2.0).abs() < 2e-3, "{last} m/s");
}
