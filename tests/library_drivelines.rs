//! Parts of drive lines of `std.drivelines` against closed forms and another integrator.

use crate::library_run::{
    Complex, close, column, integral, integrate, largest, last, over, plus, root, run, times,
};
use std::f64::consts::PI;

/// A disc of 2 g m² in a bearing, with an element to the frame.
fn disc(law: &str, spin: &str, more: &str, analysis: &str) -> String {
    format!(
        "use std.drivelines.*
        use std.joints.Revolute
        use std.forces.ExternalTorque
        model Disc {{
            gravity = [0, 0, 0] m/s^2
            accept idle
            marker frame = [0, 0, 0] mm
            body disc {{ mass = 1 kg; inertia = [2, 2, 2] g*m^2; marker hub = origin; start angular_velocity = [0, 0, {spin}] rad/s }}
            joint bearing = Revolute(disc.hub, frame)
            force law = {law}
            {more}
        }}
        analysis run = {analysis}"
    )
}

#[test]
fn a_damped_disc_decays() {
    let text = disc(
        "RotationalDamper(disc.hub, frame, damping: 0.01 N*m*s/rad)",
        "100",
        "",
        "transient(Disc(), duration: 0.2 s)",
    );
    let results = run(&text, "run");
    close(
        "speed",
        last(&results, "bearing.speed"),
        100.0 * (-1.0_f64).exp(),
        1e-6,
    );
    let heat = integral(column(&results, "time"), column(&results, "law.power_loss"));
    close("heat", heat, 10.0 * (1.0 - (-2.0_f64).exp()), 1e-5);
}

/// The root of `J s² + k + Σ k_i s τ_i/(1 + s τ_i)` is frequency and decay; stiffness and loss are its parts at s = iω.
#[test]
fn rubber_rings_at_the_complex_root() {
    let text = disc(
        "RubberRing(disc.hub, frame, stiffness: 2 kN*m/rad, branch_stiffness: [100, 200, 300] N*m/rad, relaxation: [0.3, 1, 3] ms)",
        "0",
        "output stiff = rubber_stiffness(2 kN*m/rad, [100, 200, 300] N*m/rad, [0.3, 1, 3] ms, 1000 rad/s) as N*m/rad
         output lost = rubber_loss([100, 200, 300] N*m/rad, [0.3, 1, 3] ms, 1000 rad/s) as N*m/rad",
        "linear(Disc())",
    );
    let stiffness = |s: Complex| {
        let branch = |k: f64, relaxation: f64| {
            let x = times(s, (relaxation, 0.0));
            times((k, 0.0), over(x, plus((1.0, 0.0), x)))
        };
        [(100.0, 0.3e-3), (200.0, 1e-3), (300.0, 3e-3)]
            .iter()
            .fold((2000.0, 0.0), |sum, (k, t)| plus(sum, branch(*k, *t)))
    };
    let balance = |s: Complex| plus(times((2e-3, 0.0), times(s, s)), stiffness(s));
    let pole = root(&balance, (-10.0, 1000.0));
    let size = pole.0.hypot(pole.1);
    let results = run(&text, "run");
    let frequency = column(&results, "frequency");
    let at = frequency
        .iter()
        .position(|f| *f > 1.0)
        .expect("an oscillation");
    close("frequency", frequency[at], pole.1 / (2.0 * PI), 1e-9);
    close(
        "damping",
        column(&results, "damping_ratio")[at],
        -pole.0 / size,
        1e-8,
    );
    let text = text.replace("linear(Disc())", "transient(Disc(), duration: 1 us)");
    let results = run(&text, "run");
    let due = stiffness((0.0, 1000.0));
    close("stiffness", last(&results, "stiff"), due.0, 1e-12);
    close("loss", last(&results, "lost"), due.1, 1e-12);
}

/// A ring of 2 g m² in the silicone of a housing that vibrates by ±1 deg at 150 Hz: the mean heat is
/// `ω Im K |φ|²/2`, and it is largest near the damping J ω.
#[test]
fn the_heat_of_a_viscous_damper_is_largest_at_its_optimum() {
    let omega = 2.0 * PI * 150.0;
    let optimum = 2e-3 * omega;
    let mut heats = Vec::new();
    for factor in [0.5, 1.0, 2.0] {
        let damping = factor * optimum;
        let text = format!(
            "use std.drivelines.ViscousDamper
            use std.joints.Revolute
            use std.drives.PrescribedAngle
            fn shake(t: Time) -> Angle = 1 deg*sin({omega} rad/s*t)
            model Damper {{
                gravity = [0, 0, 0] m/s^2
                accept idle
                marker frame = [0, 0, 0] mm
                body housing {{ mass = 1 kg; inertia = [2, 2, 2] g*m^2; marker hub = origin }}
                body ring {{ mass = 1 kg; inertia = [2, 2, 2] g*m^2; marker hub = origin }}
                joint bearing = Revolute(housing.hub, frame)
                joint bush = Revolute(ring.hub, housing.hub)
                drive shaker = PrescribedAngle(housing.hub, frame, angle_at: shake)
                force silicone = ViscousDamper(ring.hub, housing.hub, damping: {damping} N*m*s/rad, stiffness: 100 kN*m/rad)
            }}
            analysis run = transient(Damper(), duration: 0.2 s, sample: {} us)",
            1e6 / 150.0 / 40.0
        );
        let results = run(&text, "run");
        let (time, loss) = (
            column(&results, "time"),
            column(&results, "silicone.power_loss"),
        );
        let from = time.len() - 1 - 40 * 5;
        let period = time[time.len() - 1] - time[from];
        let heat = integral(&time[from..], &loss[from..]) / period;
        // complex stiffness of spring and damper in series, and the ring's motion relative to the housing
        let dash = (0.0, omega * damping);
        let stiffness = over(times((1e5, 0.0), dash), plus((1e5, 0.0), dash));
        let ring = (-2e-3 * omega * omega, 0.0);
        let relative = over((-ring.0, 0.0), plus(stiffness, ring));
        let angle = PI / 180.0 * relative.0.hypot(relative.1);
        close(
            "heat",
            heat,
            0.5 * omega * stiffness.1 * angle * angle,
            2e-3,
        );
        heats.push(heat);
    }
    assert!(heats[1] > heats[0] && heats[1] > heats[2], "{heats:?}");
}

const ARCS: &str = "DualMassFlywheel(disc.hub, frame, stiffness: 20 N*m/rad, second_stiffness: 60 N*m/rad, free_play: 2 deg,
    second_stage: 20 deg, friction: 0.5 N*m, creep: 0.01 rad/s)";

#[test]
fn a_dual_mass_flywheel_has_two_stages_and_a_loop() {
    for (torque, due) in [
        (4.0, 2.0 + (4.0_f64 / 20.0).to_degrees()),
        (
            -20.0,
            -20.0 - ((20.0 - 20.0 * 18.0_f64.to_radians()) / 60.0).to_degrees(),
        ),
    ] {
        let load = format!("force load = ExternalTorque(disc.hub, load: [0, 0, {torque}] N*m)");
        let results = run(&disc(ARCS, "0", &load, "static(Disc())"), "run");
        close(
            "angle",
            last(&results, "bearing.angle").to_degrees(),
            due,
            1e-9,
        );
    }
    let text = format!(
        "use std.drives.PrescribedAngle
        fn slow(t: Time) -> Angle = 30 deg*sin(2 rad/s*t)\n{}",
        disc(
            ARCS,
            "1.0471975511965976",
            "drive shaker = PrescribedAngle(disc.hub, frame, angle_at: slow)",
            "transient(Disc(), duration: 3.14159265358979 s, sample: 1 ms)",
        )
    );
    let results = run(&text, "run");
    let work: Vec<f64> = column(&results, "law.torque")
        .iter()
        .zip(column(&results, "bearing.speed"))
        .map(|(torque, speed)| -torque * speed)
        .collect();
    let area = integral(column(&results, "time"), &work);
    close("loop", area, 4.0 * 0.5 * 30.0_f64.to_radians(), 1e-3);
}

/// Two discs of 2 and 4 g m²: they meet after `J Δω/M`, and the heat is `J Δω²/2`.
#[test]
fn a_clutch_turns_the_slip_to_heat() {
    let text = "use std.drivelines.Clutch
        use std.joints.Revolute
        model Pair {
            gravity = [0, 0, 0] m/s^2
            marker frame = [0, 0, 0] mm
            body disc[i in 1..2] { mass = 1 kg; inertia = [2, 2, 2*i] g*m^2; marker hub = origin; start angular_velocity = [0, 0, [100, 0][i]] rad/s }
            joint bearing[i in 1..2] = Revolute(disc[i].hub, frame)
            force clutch = Clutch(disc[1].hub, disc[2].hub, capacity: 1 N*m, creep: 0.01 rad/s)
            output slip = bearing[1].speed - bearing[2].speed as rad/s
        }
        analysis run = transient(Pair(), duration: 0.2 s, sample: 0.1 ms)";
    let results = run(text, "run");
    let (time, slip) = (column(&results, "time"), column(&results, "slip"));
    let inertia = 2e-3 * 4e-3 / 6e-3;
    let at = time.iter().position(|t| *t > 0.1).expect("a sample");
    close("slip at 0.1 s", slip[at], 100.0 - time[at] / inertia, 1e-6);
    assert!(last(&results, "slip").abs() < 1e-6);
    let heat = integral(time, column(&results, "clutch.power_loss"));
    close("heat", heat, 0.5 * inertia * 1e4, 1e-5);
}

/// A disc that winds up a freewheel returns with its speed after half a period, then turns freely; braked and
/// driven, it engages again.
#[test]
fn a_freewheel_holds_in_one_sense() {
    let law = "OneWay(disc.hub, frame, stiffness: 2 kN*m/rad, lag: 0.1 deg)";
    let results = run(
        &disc(
            law,
            "10",
            "",
            "transient(Disc(), duration: 20 ms, sample: 2 us)",
        ),
        "run",
    );
    let torque: Vec<f64> = column(&results, "law.torque").iter().map(|x| -x).collect();
    close(
        "torque",
        largest(&torque),
        10.0 * (2e-3_f64 * 2000.0).sqrt(),
        1e-5,
    );
    close("speed", last(&results, "bearing.speed"), -10.0, 1e-5);
    let held = torque.iter().filter(|t| **t > 0.0).count() as f64 * 2e-6;
    close("time", held, PI * (2e-3_f64 / 2000.0).sqrt(), 2e-3);
    // free turning backwards against 0.2 N m; at rest after 0.1 s, it is caught within the lag and swings
    // about the balance
    let load = "force load = ExternalTorque(disc.hub, load: [0, 0, 0.2] N*m)";
    let results = run(
        &disc(
            law,
            "-10",
            load,
            "transient(Disc(), duration: 0.3 s, sample: 0.1 ms)",
        ),
        "run",
    );
    let (time, angle) = (column(&results, "time"), column(&results, "bearing.angle"));
    let at = time.iter().position(|t| *t > 0.09).expect("a sample");
    close(
        "free",
        angle[at],
        -10.0 * time[at] + 50.0 * time[at] * time[at],
        1e-6,
    );
    let back = -0.5 + 0.1_f64.to_radians();
    // the most that its spring can take: m x = c x²/2 behind the lag
    let most =
        back + 1e-4 + (2.0 * 0.2 * 0.1_f64.to_radians() / 2000.0).sqrt() + 2.0 * 0.2 / 2000.0;
    let from = time.iter().position(|t| *t > 0.105).expect("a sample");
    let later = largest(&angle[from..]);
    assert!(later > -0.5 && later < most, "{later} {most}");
}

#[test]
fn machines_run_up_as_their_curves_say() {
    let text = "use std.drivelines.*
        use std.joints.Revolute
        fn falling(speed: AngularVelocity) -> Torque = 10 N*m - 0.05 N*m*s/rad*speed
        model Machines {
            gravity = [0, 0, 0] m/s^2
            marker frame = [0, 0, 0] mm
            body rotor[i in 1..4] { mass = 1 kg; inertia = [11, 11, 20] g*m^2; marker hub = origin; start angular_velocity = [0, 0, [0, 0, 100, 0][i]] rad/s }
            joint bearing[i in 1..4] = Revolute(rotor[i].hub, frame)
            force curve = TorqueCurve(rotor[1].hub, frame, torque_at: falling)
            force motor = InductionMotor(rotor[2].hub, frame, synchronous_speed: 150 rad/s, breakdown_torque: 20 N*m, breakdown_slip: 20 %)
            force fan = Propeller(rotor[3].hub, frame, torque_there: 5 N*m, speed_there: 100 rad/s)
            force brake = Dyno(rotor[4].hub, frame, target: 100 rad/s, proportional: 1 N*m*s/rad, integral: 20 N*m/rad)
        }
        analysis run = transient(Machines(), duration: 0.5 s, sample: 1 ms)";
    let results = run(text, "run");
    close(
        "curve",
        last(&results, "bearing[1].speed"),
        200.0 * (1.0 - (-0.05_f64 * 0.5 / 0.02).exp()),
        1e-7,
    );
    // time of the run-up: ∫ J dω/M over the slip
    let slip = 1.0 - column(&results, "bearing[2].speed")[150] / 150.0;
    let time = 0.02 * 150.0 / 40.0 * ((1.0 - slip * slip) / 0.4 + 0.2 * (1.0 / slip).ln());
    close("motor", time, column(&results, "time")[150], 1e-6);
    close(
        "fan",
        last(&results, "bearing[3].speed"),
        100.0 / (1.0 + 0.5 * 5.0 / (0.02 * 100.0)),
        1e-6,
    );
    let law = |_: f64, y: &[f64; 2]| [y[1] - 100.0, -(y[1] - 100.0 + 20.0 * y[0]) / 0.02];
    let due = integrate(&law, [0.0, 0.0], 0.0, 1e-5, 50_000)[1];
    close("dyno", last(&results, "bearing[4].speed"), due, 1e-6);
}

/// Gears of 31 and 62 mm, 100 mm apart, in fixed bearings.
fn gears(backlash: &str, more: &str, start: &str, analysis: &str) -> String {
    format!(
        "use std.drivelines.*
        use std.joints.Revolute
        use std.forces.ExternalTorque
        force Swing(a: Marker, b: Marker, amplitude: Torque, speed: AngularVelocity) {{
            apply torque amplitude*sin(speed*time)*b.z on a against b
        }}
        model Gears {{
            gravity = [0, 0, 0] m/s^2
            marker frame = [0, 0, 0] mm
            marker bore = [100, 0, 0] mm
            body gear[i in 1..2] {{ mass = 1 kg; inertia = [1, 1, i] g*m^2; marker hub = origin; start angular_velocity = [0, 0, {start}[i]] rad/s }}
            joint first = Revolute(gear[1].hub, frame)
            joint second = Revolute(gear[2].hub, bore)
            force mesh = GearMesh(gear[1].hub, gear[2].hub, frame, base_radius_a: 31 mm, base_radius_b: 62 mm, center_distance: 100 mm,
                stiffness: 200 N/um, backlash: {backlash}, damping: 500 N*s/m)
            {more}
        }}
        analysis run = {analysis}"
    )
}

#[test]
fn gears_push_along_the_line_of_action() {
    let load = "force drive = ExternalTorque(gear[1].hub, load: [0, 0, 31] N*m)
            force brake = ExternalTorque(gear[2].hub, load: [0, 0, 62] N*m)";
    let results = run(&gears("20 um", load, "[0, 0]", "static(Gears())"), "run");
    let angle = 0.93_f64.acos();
    close("load", last(&results, "mesh.load"), 1000.0, 1e-9);
    close(
        "approach",
        last(&results, "mesh.transmission_error"),
        15e-6,
        1e-6,
    );
    close(
        "pressure angle",
        last(&results, "mesh.pressure_angle"),
        angle,
        1e-9,
    );
    // the bearing holds the gear against the teeth: they push a back and away from b
    close(
        "across",
        last(&results, "first.force.y"),
        1000.0 * angle.cos(),
        1e-9,
    );
    close(
        "apart",
        last(&results, "first.force.x"),
        1000.0 * angle.sin(),
        1e-9,
    );
    close(
        "other",
        last(&results, "second.force.x"),
        -1000.0 * angle.sin(),
        1e-9,
    );
    let results = run(&gears("20 um", load, "[0, 0]", "linear(Gears())"), "run");
    let rate = 0.031_f64.powi(2) / 1e-3 + 0.062_f64.powi(2) / 2e-3;
    let frequency = column(&results, "frequency");
    // the damping of full depth, at 5 um of a soft depth of 1 um
    let damping = 500.0 * 5.0 / 26.0_f64.sqrt() * rate;
    let square = 2e8 * rate - damping * damping / 4.0;
    close(
        "frequency",
        largest(frequency),
        square.sqrt() / (2.0 * PI),
        1e-6,
    );
}

/// Gears that rattle in their backlash, against another integrator in small steps.
#[test]
fn gears_rattle_as_another_integrator_says() {
    let load = "force swing = Swing(gear[1].hub, frame, amplitude: 20 N*m, speed: 600 rad/s)
            force drag[i in 1..2] = RotationalDamper(gear[i].hub, frame, damping: 0.02 N*m*s/rad)";
    let text = gears(
        "100 um",
        load,
        "[0, 0]",
        "transient(Gears(), duration: 20 ms, sample: 0.1 ms)",
    );
    let results = run(&text, "run");
    let law = |t: f64, y: &[f64; 4]| {
        let approach = 0.031 * y[0] + 0.062 * y[1];
        let rate = 0.031 * y[2] + 0.062 * y[3];
        let push = |depth: f64, rate: f64| {
            let depth = depth.max(0.0);
            depth * (2e8 + 500.0 * rate / (depth * depth + 1e-12).sqrt()).max(0.0)
        };
        let load = push(approach - 50e-6, rate) - push(-approach - 50e-6, -rate);
        let swing = 20.0 * (600.0 * t).sin();
        [
            y[2],
            y[3],
            (swing - 0.031 * load - 0.02 * y[2]) / 1e-3,
            (-0.062 * load - 0.02 * y[3]) / 2e-3,
        ]
    };
    let (mut y, mut worst) = ([0.0; 4], 0.0_f64);
    let (first, second) = (
        column(&results, "first.angle"),
        column(&results, "second.angle"),
    );
    for k in 0..first.len() {
        worst = worst
            .max((first[k] - y[0]).abs())
            .max((second[k] - y[1]).abs());
        y = integrate(&law, y, k as f64 * 1e-4, 1e-7, 1000);
    }
    let swing = largest(first) - first.iter().fold(f64::MAX, |m, x| m.min(*x));
    println!("rattle: {:.1e} of the swing", worst / swing);
    assert!(worst < 1e-3 * swing, "{worst} of {swing}");
}

/// A belt of two spans over 50 and 80 mm: bearings carry both tensions along the tangents; a torque divides
/// the tensions.
#[test]
fn a_belt_pulls_along_its_tangents() {
    let text = "use std.drivelines.*
        use std.joints.{Revolute, Fixed}
        use std.forces.ExternalTorque
        model Belt {
            gravity = [0, 0, 0] m/s^2
            marker frame = [0, 0, 0] mm
            marker bore = [300, 0, 0] mm
            body pulley[i in 1..2] { mass = 1 kg; inertia = [1, 1, 1] g*m^2; marker hub = origin }
            joint first = Fixed(pulley[1].hub, frame)
            joint second = Revolute(pulley[2].hub, bore)
            force upper = BeltSpan(pulley[1].hub, pulley[2].hub, frame, radius_a: 50 mm, radius_b: 80 mm, center_distance: 300 mm, side: left, rigidity: 100 kN, preload: 200 N)
            force lower = BeltSpan(pulley[1].hub, pulley[2].hub, frame, radius_a: 50 mm, radius_b: 80 mm, center_distance: 300 mm, side: right, rigidity: 100 kN, preload: 200 N)
            force load = ExternalTorque(pulley[2].hub, load: [0, 0, 8] N*m)
        }
        analysis run = static(Belt())
        analysis modes = linear(Belt())";
    let results = run(text, "run");
    let cosine = (0.09_f64 - 0.03 * 0.03).sqrt() / 0.3;
    close("upper", last(&results, "upper.load"), 150.0, 1e-9);
    close("lower", last(&results, "lower.load"), 250.0, 1e-9);
    close(
        "pull",
        last(&results, "first.force.x"),
        -400.0 * cosine,
        1e-9,
    );
    // the spans lean towards the smaller pulley: the pull across is the difference of tensions times sin(beta)
    close(
        "across",
        last(&results, "first.force.y").abs(),
        100.0 * 0.1,
        1e-9,
    );
    close(
        "torque",
        last(&results, "first.torque.z").abs(),
        0.05 * 100.0,
        1e-9,
    );
    let results = run(text, "modes");
    let stiffness = 2.0 * 1e5 / (0.3 * cosine) * 0.08 * 0.08;
    close(
        "frequency",
        largest(column(&results, "frequency")),
        (stiffness / 1e-3_f64).sqrt() / (2.0 * PI),
        1e-6,
    );
}

/// Two roller pendulums on a turning carrier swing at the order `sqrt(R/l (1 + m (R + l)²/J))`.
#[test]
fn a_pendulum_absorber_swings_at_its_order() {
    let text = "use std.drivelines.PendulumAbsorber
        use std.joints.Revolute
        model Absorber {
            gravity = [0, 0, 0] m/s^2
            marker frame = [0, 0, 0] mm
            body carrier {
                mass = 5 kg
                inertia = [20, 20, 30] g*m^2
                marker hub = origin
                marker bore[k in 1..2] = at([[80, -80][k], 0, 0] mm, x: [[1, -1][k], 0, 0], z: [0, 0, 1])
                start angular_velocity = [0, 0, 200] rad/s
            }
            joint bearing = Revolute(carrier.hub, frame)
            part absorber[k in 1..2] = PendulumAbsorber(carrier.bore[k], bob_mass: 0.3 kg, bob_inertia: 0.1 g*m^2, length: 20 mm)
            start absorber[1].links.swing = 0.5 deg
            start absorber[2].links.swing = 0.5 deg
        }
        analysis run = transient(Absorber(), duration: 0.2 s, sample: 0.1 ms)";
    let results = run(text, "run");
    let (time, swing) = (
        column(&results, "time"),
        column(&results, "absorber[1].swing"),
    );
    let crossings: Vec<f64> = time
        .windows(2)
        .zip(swing.windows(2))
        .filter(|(_, s)| s[0] < 0.0 && s[1] >= 0.0)
        .map(|(t, s)| t[0] - (t[1] - t[0]) * s[0] / (s[1] - s[0]))
        .collect();
    let periods = crossings.len() - 1;
    let order = 2.0 * PI * periods as f64 / (crossings[periods] - crossings[0]) / 200.0;
    let due = (4.0 * (1.0 + 0.6 * 0.01 / 30.2e-3_f64)).sqrt();
    close("order", order, due, 2e-4);
}

/// On a carrier of constant speed the damped bob swings as `exp(-d t/(2 m))` at the order `sqrt(R/l)`. Nothing warns of its place or of
/// a missing guide.
#[test]
fn a_damped_pendulum_absorber_comes_to_rest() {
    let text = "use std.drivelines.PendulumAbsorber
        use std.drives.PrescribedRotation
        use std.joints.Revolute
        model Absorber {
            gravity = [0, 0, 0] m/s^2
            marker frame = [0, 0, 0] mm
            body carrier {
                mass = 5 kg
                inertia = [20, 20, 30] g*m^2
                marker hub = origin
                marker bore = at([80, 0, 0] mm, x: [1, 0, 0], z: [0, 0, 1])
            }
            joint bearing = Revolute(carrier.hub, frame)
            drive turn = PrescribedRotation(carrier.hub, frame, speed: 200 rad/s)
            cycle angle = rotation(carrier.hub, frame) { period = 360 deg }
            part absorber = PendulumAbsorber(carrier.bore, bob_mass: 0.3 kg, bob_inertia: 0.1 g*m^2, length: 20 mm, damping: 6 N*s/m)
            start absorber.links.swing = 0.5 deg
        }
        analysis run = transient(Absorber(), duration: 0.15 s, sample: 0.1 ms, start: assembled)";
    let at_rest = text.replace("            start absorber.links.swing = 0.5 deg\n", "");
    for text in [text, &at_rest] {
        let program = eng::check(&eng::Sources::from_text("m.eng", text), "m.eng")
            .into_program()
            .unwrap_or_else(|report| panic!("{report}"));
        let assembled = program.assemble().expect("a machine");
        assert!(
            assembled.diagnostics.is_empty(),
            "{:?}",
            assembled.diagnostics
        );
    }
    let results = run(text, "run");
    let (time, swing) = (column(&results, "time"), column(&results, "absorber.swing"));
    // the swing at the rate w = sqrt(n^2 - r^2) with r = d/(2 m), begun at rest
    let (rate, free) = (10.0_f64, 400.0_f64);
    let damped = (free * free - rate * rate).sqrt();
    let amplitude = 0.5_f64.to_radians();
    let mut worst = 0.0_f64;
    for (t, found) in time.iter().zip(swing) {
        let due = amplitude
            * (-rate * t).exp()
            * ((damped * t).cos() + rate / damped * (damped * t).sin());
        worst = worst.max((found - due).abs());
    }
    println!(
        "damped pendulum: {:.1e} of its first swing",
        worst / amplitude
    );
    assert!(worst < 5e-3 * amplitude, "{worst}");
}

/// The balance of a disc on rubber under a constant torque is that after a long time: the spring alone holds it. The silicone oil of
/// the second disc holds none.
#[test]
fn rubber_at_rest_has_crept() {
    let text = "use std.drivelines.*
        use std.forces.{TorsionSpring, ExternalTorque}
        use std.joints.Revolute
        model Discs {
            gravity = [0, 0, 0] m/s^2
            marker frame = [0, 0, 0] mm
            body disc[i in 1..2] { mass = 1 kg; inertia = [1, 1, 2] g*m^2; marker hub = origin }
            joint bearing[i in 1..2] = Revolute(disc[i].hub, frame)
            force load[i in 1..2] = ExternalTorque(disc[i].hub, load: [0, 0, 7] N*m)
            force rubber = RubberRing(disc[1].hub, frame, stiffness: 700 N*m/rad, branch_stiffness: [90, 50, 70] N*m/rad,
                relaxation: [0.3, 1, 3] ms)
            force spring = TorsionSpring(disc[2].hub, frame, stiffness: 350 N*m/rad)
            force oil = ViscousDamper(disc[2].hub, frame, damping: 0.5 N*m*s/rad, stiffness: 900 N*m/rad)
        }
        analysis rest = static(Discs())";
    let results = run(text, "rest");
    close("rubber", last(&results, "bearing[1].angle"), 0.01, 1e-9);
    close("oil", last(&results, "bearing[2].angle"), 0.02, 1e-9);
}
