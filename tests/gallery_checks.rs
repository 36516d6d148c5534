//! Examples of the gallery against closed forms, linear equations and an independent integrator.

use crate::library_levers::Finger;
use crate::library_run::{
    close, column, compared, integral, integrate, last, line, run, statistics, stop,
};
use crate::library_thrust::sliding_pad;
use eng::results::Results;
use nalgebra::{
    DMatrix, Matrix2x3, Matrix3, Matrix3x6, Matrix4, Matrix6, RowVector3, Vector2, Vector3,
    Vector4, Vector6,
};
use std::f64::consts::{PI, TAU};

type C = nalgebra::Complex<f64>;

/// The start of the fan: time and heat against quadratures of inertia over torque, with Kloss' torque and a rigid belt. At the breakdown
/// torque the two spans differ by the torque that fan and wheel take.
#[test]
fn a_fan_starts_in_the_time_of_its_quadrature() {
    let text = include_str!("../examples/start_up/start_up.eng");
    let (field, inertia) = (50.0 * PI, 0.08 + 4.0 / 2.25);
    let load = |speed: f64| 76.0 * (speed / field).powi(2);
    for (analysis, connection) in [("direct", 1.0), ("star", 1.0 / 3.0)] {
        let motor = |speed: f64| {
            let slip = (1.0 - speed / field) / 0.15;
            500.0 * connection / (slip + 1.0 / slip)
        };
        let results = run(text, analysis);
        let time = column(&results, "time");
        let speed = column(&results, "motor_bearing.speed");
        let behind = speed.iter().position(|speed| *speed > 44.0 * PI);
        let end = behind.expect("a start") - 1;
        let speeds: Vec<f64> = (0..=4000)
            .map(|i| speed[end] * f64::from(i) / 4000.0)
            .collect();
        let times = speeds.iter().map(|s| inertia / (motor(*s) - load(*s)));
        let times: Vec<f64> = times.collect();
        close("time", time[end], integral(&speeds, &times), 5e-5);
        let heats = speeds.iter().zip(&times);
        let heats: Vec<f64> = heats.map(|(s, t)| t * motor(*s) * (field - s)).collect();
        let heat = integral(&time[..=end], &column(&results, "slip_heat")[..=end]);
        close("heat", heat, integral(&speeds, &heats), 5e-4);
        let torque = column(&results, "motor.torque");
        let at = (0..torque.len()).max_by(|a, b| torque[*a].total_cmp(&torque[*b]));
        let at = at.expect("samples");
        let due = torque[at] - 0.08 * (torque[at] - load(speed[at])) / inertia;
        let spans = [
            column(&results, "tight.load")[at],
            column(&results, "slack.load")[at],
        ];
        close("belt", (spans[0] - spans[1]) * 0.1, due, 1e-3);
    }
}

/// The swing, let go at three angles: the way down lasts `K(sin(a/2))/ω`, K by the arithmetic-geometric mean; speed by energy and pull by
/// Newton's equations at every sample.
#[test]
fn a_swing_swings_as_its_elliptic_integral_says() {
    let text = include_str!("../examples/swing/swing.eng");
    let (mass, length, gravity): (f64, f64, f64) = (30.0, 2.0, 9.81);
    let inertia = 1.5 + mass * length * length;
    let pull = mass * gravity * length / inertia;
    for (place, degrees) in [(1, 10.0_f64), (2, 60.0), (3, 120.0)] {
        let begin = degrees.to_radians();
        let (mut a, mut b) = (1.0, (begin / 2.0).cos());
        for _ in 0..8 {
            (a, b) = ((a + b) / 2.0, (a * b).sqrt());
        }
        let results = run(text, &format!("release[{place}]"));
        let (time, angle) = (column(&results, "time"), column(&results, "hinge.angle"));
        let at = angle.iter().position(|angle| *angle < 0.0).expect("a way");
        let share = angle[at - 1] / (angle[at - 1] - angle[at]);
        let down = time[at - 1] + share * (time[at] - time[at - 1]);
        close("way down", down, PI / 2.0 / a / pull.sqrt(), 5e-5);
        let due: Vec<[f64; 2]> = angle
            .iter()
            .map(|angle| {
                let square = 2.0 * pull * (angle.cos() - begin.cos()).max(0.0);
                let along = gravity * angle.cos() + length * square;
                let across = (gravity - length * pull) * angle.sin();
                [length * square.sqrt(), mass * along.hypot(across)]
            })
            .collect();
        follows(&results, &due, &[("speed", 5e-4), ("pull", 1e-4)]);
    }
}

const MOUNTS: &str = include_str!("../examples/mounts/mounts.eng");

/// The power unit of the example `mounts`: places of its mounts from its centre of mass, and their shares of its weight of 180 kg.
const ARMS: [[f64; 3]; 3] = [[0.15, 0.42, 0.06], [0.15, -0.42, 0.06], [-0.55, 0.0, -0.04]];
const SHARES: [f64; 3] = [11.0 / 28.0, 11.0 / 28.0, 3.0 / 14.0];
const MASSES: [f64; 6] = [180.0, 180.0, 180.0, 9.0, 16.0, 14.0];

/// Displacement of an arm under the displacement and the rotation of the unit.
fn lever([x, y, z]: [f64; 3]) -> Matrix3x6<f64> {
    Matrix3x6::new(
        1.0, 0.0, 0.0, 0.0, z, -y, //
        0.0, 1.0, 0.0, -z, 0.0, x, //
        0.0, 0.0, 1.0, y, -x, 0.0,
    )
}

/// Static and fast stiffness of the rubber along the three axes of a mount.
fn rubber_mount(k: usize) -> (Vector3<f64>, Vector3<f64>) {
    let (slow, fast) = if k == 2 {
        (130e3, 70e3)
    } else {
        (190e3, 100e3)
    };
    (
        Vector3::new(80e3, 60e3, slow),
        Vector3::new(40e3, 30e3, fast),
    )
}

/// Stiffness of the weight against a roll or a pitch: the mounts push at their heights over the centre of mass.
fn weight_stiffness() -> Vector6<f64> {
    let heights = ARMS.iter().zip(SHARES).map(|(arm, share)| arm[2] * share);
    let stiffness = 180.0 * 9.81 * heights.sum::<f64>();
    Vector6::new(0.0, 0.0, 0.0, stiffness, stiffness, 0.0)
}

/// The modes of the power unit on rubber: eigenvalues of its 12 equations of motion and 9 of creep.
#[test]
fn a_power_unit_has_the_modes_of_its_equations() {
    let inverse = Matrix6::from_diagonal(&Vector6::from(MASSES.map(|mass| 1.0 / mass)));
    let mut held = Matrix6::from_diagonal(&weight_stiffness());
    let mut a = DMatrix::<f64>::zeros(21, 21);
    a.fixed_view_mut::<6, 6>(0, 6).fill_with_identity();
    for (k, arm) in ARMS.into_iter().enumerate() {
        let lever = lever(arm);
        let (slow, fast) = rubber_mount(k);
        held += lever.transpose() * Matrix3::from_diagonal(&(slow + fast)) * lever;
        let pulled = inverse * lever.transpose() * Matrix3::from_diagonal(&fast);
        let creep = 12 + 3 * k;
        a.fixed_view_mut::<6, 3>(6, creep).copy_from(&pulled);
        a.fixed_view_mut::<3, 6>(creep, 0)
            .copy_from(&(lever / 8e-3));
        a.fixed_view_mut::<3, 3>(creep, creep)
            .fill_diagonal(-1.0 / 8e-3);
    }
    a.fixed_view_mut::<6, 6>(6, 0).copy_from(&(-inverse * held));
    let mut due: Vec<C> = a.complex_eigenvalues().iter().copied().collect();
    due.retain(|root| root.im > 1.0);
    due.sort_by(|a, b| a.im.total_cmp(&b.im));
    assert_eq!(due.len(), 6);
    let results = run(MOUNTS, "rubber_modes");
    for (i, due) in due.iter().enumerate() {
        close(
            "frequency",
            column(&results, "frequency")[i],
            due.im / TAU,
            1e-8,
        );
        close(
            "damping",
            column(&results, "damping_ratio")[i],
            -due.re / due.norm(),
            1e-7,
        );
    }
}

/// Load over displacement of the power unit under `e^{st}`, with the complex stiffness of its mounts.
fn unit(s: C, fluid: bool) -> Matrix6<C> {
    let creep = s * 8e-3 / (s * 8e-3 + 1.0);
    let channel = s * 4e6 + 1.2e8;
    let piston = 2.5e-3_f64.powi(2);
    let filled = s * 200.0 + 190e3 + s * channel * piston / (s * channel * 3e-11 + 1.0);
    let own = Vector6::from(MASSES).map(|mass| s * s * mass);
    let mut balance = Matrix6::from_diagonal(&(own + weight_stiffness().map(C::from)));
    for (k, arm) in ARMS.into_iter().enumerate() {
        let lever = lever(arm).map(C::from);
        let (slow, fast) = rubber_mount(k);
        let mut stiffness = slow.map(C::from) + fast.map(|fast| creep * fast);
        if fluid && k < 2 {
            stiffness[2] = filled;
        }
        balance += lever.transpose() * Matrix3::from_diagonal(&stiffness) * lever;
    }
    balance
}

/// The force on the frame over a push on the crank, `1 − m s² z`, at every frequency of the response.
#[test]
fn a_pushed_power_unit_passes_on_what_its_equations_say() {
    for (analysis, fluid) in [("rubber_pushed", false), ("fluid_pushed", true)] {
        let results = run(MOUNTS, analysis);
        let mut worst = 0.0_f64;
        for (row, frequency) in column(&results, "frequency").iter().enumerate() {
            let s = C::new(0.0, TAU * frequency);
            let mut load = Vector6::<C>::zeros();
            load[2] = C::from(1.0);
            load[4] = C::from(-0.08);
            let moved = unit(s, fluid).lu().solve(&load).expect("a damped unit");
            let due = -s * s * moved[2] * 180.0 + 1.0;
            let [size, phase] =
                ["reached", "reached.phase"].map(|path| column(&results, path)[row]);
            worst = worst.max((C::from_polar(size, phase) - due).norm() / due.norm());
        }
        println!("{analysis}: {worst:.1e}");
        assert!(worst < 1e-6, "{analysis}: {worst}");
    }
}

/// The share of the free force that reaches the frame, `1 − m s² z/F` with the displacement z of the centre of mass from six equations with
/// complex stiffnesses: near the bounce, between both resonances of the fluid, and at idle.
#[test]
fn a_power_unit_passes_on_what_its_equations_say() {
    for (place, rpm) in [(3, 300.0), (7, 500.0), (13, 800.0)] {
        let omega = rpm * TAU / 60.0;
        let s = C::new(0.0, 2.0 * omega);
        // the free force acts 80 mm before the centre of mass; the torque is a sine about x
        let force = 4.0 * 0.55 * 0.045 * 0.3 * omega * omega;
        let mut load = Vector6::<C>::zeros();
        load[2] = C::from(force);
        load[3] = C::new(0.0, -90.0);
        load[4] = C::from(-0.08 * force);
        for (analysis, fluid) in [("rubber", false), ("hydraulic", true)] {
            let moved = unit(s, fluid).lu().solve(&load).expect("a damped unit");
            let due = -s * s * moved[2] * 180.0 / force + 1.0;
            let results = run(MOUNTS, &format!("{analysis}[{place}]"));
            let angle = column(&results, "cycle.angle");
            let phases: Vec<f64> = angle.iter().map(|angle| 2.0 * angle).collect();
            let found = line(column(&results, "passed").iter().copied(), &phases);
            let miss = (found - due).norm() / due.norm();
            println!("{analysis} at {rpm} rpm: {found} for {due}, {miss:.1e}");
            assert!(miss < 2e-3, "{analysis} at {rpm} rpm: {found} for {due}");
        }
    }
}

/// Second and fourth order of the force of a slider-crank over the first one, from throw over rod.
fn orders_of_a_slider(ratio: f64) -> (f64, f64) {
    (
        ratio + ratio.powi(3) / 4.0 + 15.0 * ratio.powi(5) / 128.0,
        -(ratio.powi(3) / 4.0 + 3.0 * ratio.powi(5) / 16.0),
    )
}

/// Lines of channels over the cycle's angle, each with its order and value due, to a share of a force.
fn lines_are(results: &Results, lines: &[(&str, f64, C)], share: f64) {
    let angle = column(results, "cycle.angle");
    for (path, order, due) in lines {
        let phases: Vec<f64> = angle.iter().map(|angle| order * angle).collect();
        let found = line(column(results, path).iter().copied(), &phases);
        println!("{path}, order {order}: {found} for {due}");
        assert!(
            (found - due).norm() < share,
            "{path}, order {order}: {found} for {due}"
        );
    }
}

/// The samples of channels against those due, each to a share of its root mean square.
fn follows<const N: usize>(results: &Results, due: &[[f64; N]], paths: &[(&str, f64); N]) {
    for (channel, (path, tolerance)) in paths.iter().enumerate() {
        let found = column(results, path);
        assert_eq!(found.len(), due.len());
        let misses = found
            .iter()
            .zip(due)
            .map(|(found, due)| (found - due[channel]).powi(2));
        let sizes = due.iter().map(|due| due[channel].powi(2));
        let miss = (misses.sum::<f64>() / sizes.sum::<f64>()).sqrt();
        println!("{path}: {miss:.1e}");
        assert!(miss < *tolerance, "{path}: {miss}");
    }
}

/// The single: orders 1, 2 and 4 of the force on its frame against the series of a slider-crank, `F (cos a + A2 cos 2a + A4 cos 4a)` with
/// the first order balanced in part. The crank moves in its films, which costs a thousandth of F.
#[test]
fn a_single_is_balanced_as_the_series_says() {
    let text = include_str!("../examples/single_balanced/single_balanced.eng");
    let full = 0.44 * 31.05e-3 * (4000.0 * TAU / 60.0_f64).powi(2);
    let (second, fourth) = orders_of_a_slider(31.05 / 107.0);
    for (analysis, crank, shaft) in [
        ("bare", 0.0, 0.0),
        ("half", 0.5, 0.0),
        ("balanced", 0.5, 0.5),
    ] {
        let lines = [
            ("upward", 1.0, C::new(full * (1.0 - crank - shaft), 0.0)),
            ("across", 1.0, C::new(0.0, full * (crank - shaft))),
            ("upward", 2.0, C::new(full * second, 0.0)),
            ("across", 2.0, C::new(0.0, 0.0)),
            ("upward", 4.0, C::new(full * fourth, 0.0)),
        ];
        lines_are(&run(text, analysis), &lines, 2e-3 * full);
    }
}

/// The boxer twin: its couple is the force of one cylinder times the distance of both. The counterweights balance a share of the first
/// order about the vertical axis, and bring as much about that of the cylinders. No order of the force is left.
#[test]
fn a_boxer_has_a_couple_and_no_force() {
    let text = include_str!("../examples/boxer_twin/boxer_twin.eng");
    let full = 0.58 * 36.5e-3 * (4000.0 * TAU / 60.0_f64).powi(2);
    let couple = full * 0.06;
    let (second, _) = orders_of_a_slider(36.5 / 125.0);
    for (analysis, share) in [("bare", 0.0), ("half", 0.5)] {
        let results = run(text, analysis);
        let couples = [
            ("yaw", 1.0, C::new(couple * (1.0 - share), 0.0)),
            ("pitch", 1.0, C::new(0.0, couple * share)),
            ("yaw", 2.0, C::new(couple * second, 0.0)),
            ("pitch", 2.0, C::new(0.0, 0.0)),
        ];
        lines_are(&results, &couples, 4e-3 * couple);
        let forces = [
            ("across", 1.0, C::new(0.0, 0.0)),
            ("across", 2.0, C::new(0.0, 0.0)),
        ];
        lines_are(&results, &forces, 2e-3 * full);
        // the heat begins close to samples, and films state their clearance as the length that they resolve
        let work = column(&results, "energy.work_of_loads");
        let open = column(&results, "energy.imbalance");
        let open = open.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        assert!(
            open < 1e-5 * work[work.len() - 1].abs(),
            "{analysis}: {open} J"
        );
    }
}

/// The V-twins: with half of the oscillating masses balanced, a first order of `cos(angle)` of that of one cylinder is left, which turns
/// against the crank; the second orders of both banks add up. Order 1/2 of the torque is that of two pulses of gas, `360° − angle` apart.
/// The heavy crank moves in its films, which costs 4 thousandths of F.
#[test]
fn v_twins_shake_and_fire_as_their_angle_says() {
    let text = include_str!("../examples/v_twin/v_twin.eng");
    let speed = 3000.0 * TAU / 60.0;
    let full = 0.6 * 0.05 * speed * speed;
    let (second, _) = orders_of_a_slider(50.0 / 190.0);
    for (place, degrees) in [(1, 45.0_f64), (2, 60.0), (3, 90.0)] {
        // the pin is on bank 1 at the angle 0
        let half = (degrees / 2.0).to_radians();
        let left = C::from_polar(full * (2.0 * half).cos(), half);
        let twice = C::from_polar(2.0 * full * second, 2.0 * half);
        let results = run(text, &format!("twin[{place}]"));
        let lines = [
            ("upward", 1.0, left),
            ("across", 1.0, left * C::i()),
            ("upward", 2.0, twice * half.cos() * (2.0 * half).cos()),
            (
                "across",
                2.0,
                -twice * C::i() * half.sin() * (2.0 * half).sin(),
            ),
            ("upward", 0.5, C::new(0.0, 0.0)),
        ];
        lines_are(&results, &lines, 5e-3 * full);
        let angle = column(&results, "cycle.angle");
        let phases: Vec<f64> = angle.iter().map(|angle| angle / 2.0).collect();
        let power = column(&results, "engine.cylinder[1].gas.indicated_power");
        let pulse = line(power.iter().map(|power| power / speed), &phases);
        let later = (360.0 - degrees).to_radians() / 2.0;
        let both = pulse * (C::from_polar(1.0, -later) + 1.0);
        let torque = line(
            column(&results, "engine.brake_torque").iter().copied(),
            &phases,
        );
        println!("{degrees}: {torque} for {both}, of one pulse {pulse}");
        assert!((torque - both).norm() < 3e-3 * both.norm());
    }
}

/// The V6: orders of its torque are those of six pulses of gas at its firing angles. The third order of the inertia of six pistons,
/// `m r² w² (3/4 l + 9/32 l³)` each with l throw over rod, is in phase with split pins, and cancels with common ones.
#[test]
fn a_split_crank_moves_the_pulses_of_a_v6() {
    let text = include_str!("../examples/v6_split/v6_split.eng");
    let speed = 2000.0 * TAU / 60.0;
    let ratio: f64 = 38.0 / 140.0;
    let inertia = 0.56 * (0.038 * speed).powi(2);
    let third = 6.0 * inertia * (0.75 * ratio + 9.0 / 32.0 * ratio.powi(3));
    let fired = [
        ("common", [0.0, 660.0, 240.0, 180.0, 480.0, 420.0], 0.0),
        ("split", [0.0, 600.0, 240.0, 120.0, 480.0, 360.0], third),
    ];
    for (analysis, angles, third) in fired {
        let results = run(text, analysis);
        let angle = column(&results, "cycle.angle");
        let power = column(&results, "engine.cylinder[1].gas.indicated_power");
        for order in [0.5, 1.0, 1.5, 3.0] {
            let phases: Vec<f64> = angle.iter().map(|angle| order * angle).collect();
            let pulse = line(power.iter().map(|power| power / speed), &phases);
            let later = angles.map(|angle: f64| C::from_polar(1.0, -order * angle.to_radians()));
            let mut due = pulse * later.iter().sum::<C>();
            if order == 3.0 {
                due += C::new(0.0, third);
            }
            let lines = [("engine.brake_torque", order, due)];
            lines_are(&results, &lines, 8e-3 * pulse.norm());
        }
    }
}

/// Heights of the six bodies of the valve spring and lift of the valve, then their rates.
type Valve = [f64; 14];

/// Push of the cam and of the seat on the valve of the example `valvetrain`.
fn valve_pushes(t: f64, y: &Valve, omega: f64) -> [f64; 2] {
    let half = 65.0_f64.to_radians();
    let angle = (omega * t).rem_euclid(TAU) - PI;
    let share = (1.0 - (angle / half).powi(2)).max(0.0);
    let lift = 9.15e-3 * share.powi(4);
    let slope = -8.0 * 9.15e-3 * angle / half.powi(2) * share.powi(3);
    [
        stop(
            lift - 0.15e-3 - y[6],
            slope * omega - y[13],
            [30e6, 600.0, 1e-6],
        ),
        stop(-y[6], -y[13], [40e6, 1.2e3, 2e-6]),
    ]
}

/// Tension of the piece of the spring between two bodies, seat and valve at its ends.
fn valve_tension(y: &Valve, i: usize) -> f64 {
    let (near, near_rate) = if i == 0 {
        (0.0, 0.0)
    } else {
        (y[i - 1], y[i + 6])
    };
    let (far, far_rate) = if i == 6 {
        (0.04 - y[6], -y[13])
    } else {
        (y[i], y[i + 7])
    };
    let pieces = if i == 0 || i == 6 { 12.0 } else { 6.0 };
    30e3 * pieces * (far - near - 0.052 / pieces) + 1.5 * (far_rate - near_rate)
}

/// The valve at the resonance of its spring, and at a speed at which the tappet leaves the cam: the cycle that another integrator reaches.
#[test]
fn a_valve_moves_as_another_integrator_says() {
    let text = include_str!("../examples/valvetrain/valvetrain.eng");
    for (place, rpm) in [(1, 2200.0), (3, 3000.0)] {
        let omega = rpm * TAU / 60.0;
        let motion = |t: f64, y: &Valve| -> Valve {
            let [cam, seat] = valve_pushes(t, y, omega);
            let tension: [f64; 7] = std::array::from_fn(|i| valve_tension(y, i));
            std::array::from_fn(|i| match i {
                0..7 => y[i + 7],
                7..13 => (tension[i - 6] - tension[i - 7]) / 7.5e-3,
                _ => (cam + seat + tension[6]) / 0.11,
            })
        };
        let sample = TAU / omega / 720.0;
        let mut y: Valve = std::array::from_fn(|i| match i {
            0..6 => 0.04 * (i as f64 + 0.5) / 6.0,
            6 => -9e-6,
            _ => 0.0,
        });
        let mut due = Vec::new();
        for k in 0..=14 * 720 {
            let t = f64::from(k) * sample;
            if k >= 13 * 720 {
                let [cam, seat] = valve_pushes(t, &y, omega);
                let surge = -valve_tension(&y, 6) - 30e3 * (0.012 + y[6]);
                due.push([y[6], cam, seat, surge]);
            }
            y = integrate(&motion, y, t, sample / 20.0, 20);
        }
        let results = run(text, &format!("ride[{place}]"));
        let paths = [
            ("lift", 1e-4),
            ("tappet.load", 3e-3),
            ("seat.load", 3e-3),
            ("surge", 1e-2),
        ];
        follows(&results, &due, &paths);
    }
}

/// The ball of the lash adjuster sinks while the valve is open, with hot and with cold oil: its push by inverse dynamics of the finger, the
/// trapped oil by its compressibility and Hagen and Poiseuille's flow through the gap.
#[test]
fn a_lash_adjuster_sinks_by_its_leak() {
    let text = include_str!("../examples/valvetrain/finger.eng");
    let area = PI / 4.0 * 0.011 * 0.011;
    // way of the ball over pressure, by the compressed oil
    let compliance = 0.3e-6 / (1.2e9 * area);
    for (analysis, viscosity) in [("hot[1]", 0.01), ("cold", 0.06)] {
        let results = run(text, analysis);
        let [time, cam, ball, lift] =
            ["time", "cycle.angle", "ball_height", "valve.lift"].map(|path| column(&results, path));
        // after the contacts have come to rest
        let open = |lift: &f64| *lift > 2e-3;
        let first = lift.iter().position(open).expect("an open valve");
        let end = lift.iter().rposition(open).expect("an open valve");
        let flow = PI * 0.011 * 6e-6_f64.powi(3) / (12.0 * viscosity * 8e-3);
        let pressure = |k: usize| {
            let (ball, half) = (ball[k], PI / 3.0);
            (Finger { ball, half }.ball_push(cam[k], 20.0 * PI) - 20.0) / area
        };
        let start = pressure(first);
        let (mut leak, mut before, mut miss, mut size) = (0.0, start, 0.0, 0.0);
        for k in first + 1..=end {
            let now = pressure(k);
            leak += flow * (before + now) / 2.0 * (time[k] - time[k - 1]) / area;
            before = now;
            let due = -leak - (now - start) * compliance;
            miss += (ball[k] - ball[first] - due).powi(2);
            size += due * due;
        }
        let miss = (miss / size).sqrt();
        println!("{analysis}: leak {leak:.3e} m, miss {miss:.1e}");
        assert!(miss < 1e-2, "{analysis}: {miss}");
        let sunk = ball[first] - ball[end];
        let due = leak + (before - start) * compliance;
        println!("{analysis}: sinks by {sunk} for {due}");
        assert!((sunk / due - 1.0).abs() < 1e-2, "{sunk} for {due}");
    }
}

const DRIVELINE: &str = include_str!("../examples/driveline/driveline.eng");
/// Inertia of the engine, of the gearbox, and stiffness between them, of the example `driveline`.
const DUAL: [f64; 3] = [0.1, 0.08, 350.0];
const SOLID: [f64; 3] = [0.16, 0.02, 3000.0];

/// The acceleration of the gearbox under both orders of the engine: two inertias, and a shaft that ends at a constant speed.
#[test]
fn a_gearbox_vibrates_as_its_linear_equations_say() {
    for (place, rpm) in [(1, 800.0), (7, 2000.0)] {
        for (analysis, [engine, input, stiffness]) in [("dual", DUAL), ("solid", SOLID)] {
            let results = run(DRIVELINE, &format!("{analysis}[{place}]"));
            for (order, torque) in [(2.0, 90.0), (4.0, 25.0)] {
                let s = C::new(0.0, order * rpm * TAU / 60.0);
                let flywheel = s * 2.0 + stiffness;
                let front = s * s * engine + flywheel;
                let back = s * s * input + flywheel + s + 300.0;
                let due = s * s * flywheel * torque / (front * back - flywheel * flywheel);
                let share = 3e-3 * due.norm();
                lines_are(&results, &[("input_acceleration", order, due)], share);
            }
        }
    }
}

/// The teeth of the loose gear at 800 rpm: closed behind the dual-mass flywheel, with the path of another integrator; in a rattle behind
/// the solid one. The rattle is chaotic: two runs of the other integrator with starts 1e-9 rad apart differ by 12 % in the share of the
/// time in contact and by 4 % in the mean load.
#[test]
fn a_loose_gear_rattles_behind_a_solid_flywheel_alone() {
    let omega = 800.0 * TAU / 60.0;
    let push = |y: &[f64; 6]| {
        let depth = 0.033 * y[1] + 0.0495 * y[2];
        let rate = 0.033 * y[4] + 0.0495 * y[5];
        let law = [1.5e8, 400.0, 1e-6];
        stop(depth - 60e-6, rate, law) - stop(-depth - 60e-6, -rate, law)
    };
    for (analysis, [engine, input, stiffness]) in [("quiet", DUAL), ("rattle", SOLID)] {
        // angles of engine, gearbox and gear less those of the steady turn
        let motion = |t: f64, y: &[f64; 6]| {
            let gas = 60.0 + 90.0 * (2.0 * omega * t).cos() + 25.0 * (4.0 * omega * t).cos();
            let flywheel = stiffness * (y[0] - y[1]) + 2.0 * (y[3] - y[4]);
            let shaft = 300.0 * y[1] + y[4];
            let drag = 0.01 * (y[5] - 2.0 / 3.0 * omega);
            [
                y[3],
                y[4],
                y[5],
                (gas - flywheel) / engine,
                (flywheel - shaft - 0.033 * push(y)) / input,
                (-0.0495 * push(y) - drag) / 2e-3,
            ]
        };
        let wind = 60.0 / 300.0;
        let mut y = [
            wind + 60.0 / stiffness,
            wind,
            -2.0 / 3.0 * wind,
            0.0,
            0.0,
            0.0,
        ];
        let mut due = Vec::new();
        for k in 0..=15_000 {
            if k >= 7500 {
                due.push(push(&y));
            }
            y = integrate(&motion, y, f64::from(k) * 1e-4, 2e-6, 50);
        }
        let results = run(DRIVELINE, analysis);
        let found = &column(&results, "mesh.load")[7500..];
        assert_eq!(found.len(), due.len());
        if analysis == "quiet" {
            let least = |load: &[f64]| load.iter().copied().fold(f64::MAX, f64::min);
            close("least", least(found), least(&due), 1e-3);
            let (found, due) = (statistics(found), statistics(&due));
            assert!(found[0] == 1.0 && due[0] == 1.0, "{found:?}, {due:?}");
            close("mean", found[2], due[2], 1e-4);
            close("rms", found[3], due[3], 1e-4);
        } else {
            compared(statistics(found), statistics(&due), [0.2, 0.2, 0.08, 0.08]);
        }
    }
}

/// The car that starts: slip, torque of the shaft and heat of the clutch by another integrator; the sum of the moments of momentum is that
/// of the engine's torque.
#[test]
fn a_car_starts_as_another_integrator_says() {
    let (engine, input, car) = (0.16, 0.02, 0.75);
    let capacity = |t: f64| {
        let share = (t / 0.5).clamp(0.0, 1.0);
        150.0 * share.powi(3) * (10.0 - 15.0 * share + 6.0 * share * share)
    };
    // twist of the shaft, speeds of engine, input and car, heat
    let motion = |t: f64, y: &[f64; 5]| {
        let clutch = capacity(t) * (y[1] - y[2]).tanh();
        let shaft = 300.0 * y[0] + y[2] - y[3];
        [
            y[2] - y[3],
            (80.0 - clutch) / engine,
            (clutch - shaft) / input,
            shaft / car,
            clutch * (y[1] - y[2]),
        ]
    };
    let results = run(DRIVELINE, "launch");
    let begin = 1500.0 * TAU / 60.0;
    let mut y = [0.0, begin, 0.0, 0.0, 0.0];
    let mut due = Vec::new();
    let time = column(&results, "time");
    for k in 0..time.len() {
        due.push([y[1] - y[2], -300.0 * y[0] - (y[2] - y[3]), y[3]]);
        if let Some(next) = time.get(k + 1) {
            y = integrate(&motion, y, time[k], (next - time[k]) / 50.0, 50);
        }
    }
    let paths = [
        ("slip", 1e-4),
        ("shaft.torque", 1e-3),
        ("car_bearing.speed", 1e-4),
    ];
    follows(&results, &due, &paths);
    close(
        "heat",
        integral(time, column(&results, "clutch.power_loss")),
        y[4],
        1e-4,
    );
    let end = |path: &str| last(&results, path);
    let momentum = engine * end("engine_bearing.speed")
        + input * end("input_bearing.speed")
        + car * end("car_bearing.speed");
    close(
        "momentum",
        momentum,
        engine * begin + 80.0 * end("time"),
        1e-6,
    );
}

/// Loads of the four ends of the skirt of the example `piston_slap`: side of the wall, lever about the pin's height, load, heat.
/// The state is the place across of the piston and its tilt, and their rates.
fn skirt_loads(y: &[f64; 4]) -> [[f64; 4]; 4] {
    let (sin, cos) = y[1].sin_cos();
    [(0.015, -1.0), (0.015, 1.0), (-0.03, -1.0), (-0.03, 1.0)].map(|(place, side): (f64, f64)| {
        let lever = place * cos - side * 0.043 * sin;
        let depth = side * (y[0] + place * sin) + 0.043 * cos - 0.043 - 40e-6;
        let rate = side * (y[2] + lever * y[3]);
        let pressed = (depth + depth.hypot(1e-6)) / 2.0;
        let load = stop(pressed, rate, [30e6, 3e3, 2e-6]);
        [side, lever, load, (load - 30e6 * pressed) * rate]
    })
}

/// Newton's and Euler's equations of that piston and of the rod's small end, which keeps its distance from the crank's pin.
fn slapping(t: f64, y: &[f64; 4], offset: f64) -> [f64; 4] {
    let omega = 50.0 * PI;
    let (rod, small, mass, inertia, center, weight) =
        (0.145, 0.6 * 0.045 / 0.145, 0.5, 0.4e-3, 0.008, 9.81);
    let (sin, cos) = y[1].sin_cos();
    let pin = Vector2::new((omega * t).cos(), (omega * t).sin()) * 0.043;
    let pin_velocity = Vector2::new(-pin.y, pin.x) * omega;
    // from the crank's pin to that of the piston, which is `offset` beside the axis, at negative y
    let across = y[0] - offset * cos - pin.y;
    let arm = Vector2::new((rod * rod - across * across).sqrt(), across);
    let of_small = Matrix2x3::new(1.0, 0.0, offset * cos, 0.0, 1.0, offset * sin);
    let of_center = Matrix2x3::new(1.0, 0.0, -center * sin, 0.0, 1.0, center * cos);
    let free = of_small * Vector3::new(0.0, y[2], y[3]) - pin_velocity;
    let rates = Vector3::new(-arm.dot(&free) / arm.x, y[2], y[3]);
    let relative = of_small * rates - pin_velocity;
    let own = y[3] * y[3];
    let small_bias = Vector2::new(-offset * sin, offset * cos) * own;
    let center_bias = Vector2::new(-center * cos, -center * sin) * own;
    let down = Vector2::new(weight, 0.0);
    let late = ((omega * t - 10.0_f64.to_radians() + TAU).rem_euclid(2.0 * TAU) - TAU)
        / 35.0_f64.to_radians();
    let gas = 44e5 * (-late * late).exp() * PI / 4.0 * 0.086 * 0.086;
    let mut force = -(of_small.transpose() * (small_bias + down)) * small
        - of_center.transpose() * (center_bias + down) * mass;
    force.x -= gas;
    for [side, lever, load, _] in skirt_loads(y) {
        force.y -= side * load;
        force.z -= side * load * lever;
    }
    let masses = of_small.transpose() * of_small * small
        + of_center.transpose() * of_center * mass
        + Matrix3::from_diagonal(&Vector3::new(0.0, 0.0, inertia));
    let held: RowVector3<f64> = arm.transpose() * of_small;
    let mut balance = Matrix4::zeros();
    balance.fixed_view_mut::<3, 3>(0, 0).copy_from(&masses);
    balance
        .fixed_view_mut::<3, 1>(0, 3)
        .copy_from(&-held.transpose());
    balance.fixed_view_mut::<1, 3>(3, 0).copy_from(&held);
    let turning = -arm.dot(&(small_bias + pin * omega * omega)) - relative.norm_squared();
    let due = Vector4::new(force.x, force.y, force.z, turning);
    let found = balance.lu().solve(&due).expect("a mechanism that moves");
    [y[2], y[3], found.y, found.z]
}

/// The piston with its pin towards the thrust side, in the middle, and beyond it: the cycle that another integrator reaches.
#[test]
fn a_piston_slaps_as_another_integrator_says() {
    let text = include_str!("../examples/piston_slap/piston_slap.eng");
    for (place, offset) in [(1, -1e-3), (2, 0.0), (3, 1e-3)] {
        let sample = 0.08 / 720.0;
        let motion = |t: f64, y: &[f64; 4]| slapping(t, y, offset);
        let mut y = [0.0; 4];
        let mut due = Vec::new();
        for k in 0..=4 * 720 {
            if k >= 3 * 720 {
                let loads = skirt_loads(&y);
                let thrust = loads[0][2] + loads[2][2];
                let heat: f64 = loads.iter().map(|end| end[3]).sum();
                due.push([y[0], y[1], thrust, heat]);
            }
            y = integrate(&motion, y, f64::from(k) * sample, sample / 20.0, 20);
        }
        let results = run(text, &format!("slap[{place}]"));
        let paths = [
            ("across", 1e-3),
            ("tilt", 1e-3),
            ("thrust_side", 1e-3),
            ("heat", 1e-2),
        ];
        follows(&results, &due, &paths);
    }
}

/// The thrust bearing under the clutch: load and heat of both faces by Reynolds' equation on cells at the gaps of the run. The law leaves
/// out a part of the drag of the pressure.
#[test]
fn a_clutch_presses_the_pads_as_reynolds_equation_says() {
    let text = include_str!("../examples/thrust/thrust.eng");
    for (place, rpm, heat_share) in [(1, 700.0, 0.06), (2, 2500.0, 0.025), (3, 6000.0, 0.015)] {
        let results = run(text, &format!("press[{place}]"));
        let time = column(&results, "time");
        let held = time.iter().position(|t| *t > 0.199).expect("a sample");
        let gap = column(&results, "thrust.minimum_film")[held];
        let radius = 0.0365;
        let length = radius * 50.0_f64.to_radians();
        let speed = radius * rpm * TAU / 60.0;
        // SAE 5W-30 at 100 degC
        let viscosity = 0.074928e-3 * (1070.5_f64 / 220.04).exp();
        let faces = [gap, 180e-6 - gap].map(|gap| {
            // the mean gap of rough surfaces that do not penetrate
            let mean = (gap + gap.hypot(0.8 * 0.6e-6 + 18e-9)) / 2.0;
            let pad = [length, 0.011, mean, 25e-6, 0.8, viscosity];
            let (coarse, fine) = (sliding_pad(pad, 50), sliding_pad(pad, 100));
            [0, 1].map(|k| 6.0 * speed * (fine[k] + (fine[k] - coarse[k]) / 3.0))
        });
        close("load", faces[0][0] - faces[1][0], 2000.0, 2e-4);
        let ring = (0.042_f64.powi(4) - 0.031_f64.powi(4)) / (4.0 * radius.powi(3) * 0.011);
        let heat = (faces[0][1] + faces[1][1]) * ring * speed;
        close(
            "heat",
            column(&results, "thrust.power_loss")[held],
            heat,
            heat_share,
        );
    }
}

/// The row of four: second and fourth order of its force, which the shafts balance in part, and the couple of two shafts at two heights,
/// the force of one of them times the distance.
#[test]
fn balance_shafts_take_the_second_order() {
    let text = include_str!("../examples/balancer/balancer.eng");
    let full = 4.0 * 0.58 * 0.046 * (5500.0 * TAU / 60.0_f64).powi(2);
    let (second, fourth) = orders_of_a_slider(46.0 / 150.0);
    let share = 1e-2 * full * second;
    let bare = [
        ("upward", 2.0, C::new(full * second, 0.0)),
        ("upward", 4.0, C::new(full * fourth, 0.0)),
        ("across", 2.0, C::new(0.0, 0.0)),
    ];
    lines_are(&run(text, "bare"), &bare, share);
    let balanced = [
        ("upward", 2.0, C::new(0.0, 0.0)),
        ("upward", 4.0, C::new(full * fourth, 0.0)),
        ("across", 2.0, C::new(0.0, 0.0)),
    ];
    let runs = ["level", "raised"].map(|analysis| run(text, analysis));
    let rolls = runs.each_ref().map(|results| {
        lines_are(results, &balanced, share);
        let angle = column(results, "cycle.angle");
        let phases: Vec<f64> = angle.iter().map(|angle| 2.0 * angle).collect();
        line(column(results, "roll").iter().copied(), &phases)
    });
    // the raised shaft pushes by half of the second order, against y at first
    let due = C::new(0.0, full * second / 2.0 * 0.09);
    let couple = rolls[1] - rolls[0];
    println!("couple {couple} for {due}");
    assert!(
        (couple - due).norm() < 3e-3 * due.norm(),
        "{couple} for {due}"
    );
}

/// A pulley of the example `timing`: centre, radius, angle, and the rates of centre and angle.
#[derive(Clone, Copy)]
struct Pulley {
    center: Vector2<f64>,
    radius: f64,
    angle: f64,
    velocity: Vector2<f64>,
    spin: f64,
}

/// A span from one pulley to another: its tension, and the forces and torques of the chain on both, from the points at which the chain
/// touches. `side` is 1 on the left. The radius of a pulley at the back of the chain is negative. `begin` is the span as assembled.
fn span(
    begin: [Pulley; 2],
    now: [Pulley; 2],
    side: f64,
    damping: f64,
) -> (f64, [(Vector2<f64>, f64); 2]) {
    let touching = |[a, b]: [Pulley; 2]| {
        let arm = b.center - a.center;
        let along = arm / arm.norm();
        let sine = (a.radius - b.radius) / arm.norm();
        let left = Vector2::new(-along.y, along.x);
        let normal = along * sine + left * (side * (1.0 - sine * sine).sqrt());
        let free = arm + normal * (b.radius - a.radius);
        (normal, free)
    };
    let ((old_normal, old), (normal, free)) = (touching(begin), touching(now));
    // the normal turns by less than half a turn
    let turned = (old_normal.x * normal.y - old_normal.y * normal.x).atan2(old_normal.dot(&normal));
    let [a, b] = now;
    let wound = a.radius * (a.angle - turned) - b.radius * (b.angle - turned);
    let stretch = free.norm() - old.norm() + side * wound;
    let along = free / free.norm();
    let rate =
        along.dot(&(b.velocity - a.velocity)) + side * (a.radius * a.spin - b.radius * b.spin);
    let tension = (500.0 + 6e5 / old.norm() * stretch + damping * rate).max(0.0);
    let pull = along * tension;
    let on = |pulley: Pulley, force: Vector2<f64>| {
        let lever = normal * pulley.radius;
        (force, lever.x * force.y - lever.y * force.x)
    };
    (tension, [on(a, pull), on(b, -pull)])
}

/// Crank, cam and roller of the example `timing`. The state has the angles of cam and roller and the way of the roller, and their rates.
fn pulleys(t: f64, y: &[f64; 6], omega: f64) -> [Pulley; 3] {
    let swing = 0.4_f64.to_radians();
    let pulley = |x: f64, place: f64, radius, angle, rise, spin| Pulley {
        center: Vector2::new(x, place),
        radius,
        angle,
        velocity: Vector2::new(0.0, rise),
        spin,
    };
    let crank = omega * t + swing * (2.0 * omega * t).sin();
    let crank_spin = omega + 2.0 * omega * swing * (2.0 * omega * t).cos();
    [
        pulley(0.0, 0.0, 0.024, crank, 0.0, crank_spin),
        pulley(0.22, 0.0, 0.048, y[0], 0.0, y[3]),
        pulley(0.105, -0.034 + y[2], -0.02, y[1], y[5], y[4]),
    ]
}

/// Tensions of the three spans, and the torques on cam and roller and the force on the roller along its guide.
fn chain(t: f64, y: &[f64; 6], omega: f64) -> ([f64; 3], [f64; 3]) {
    let begin = pulleys(0.0, &[0.0; 6], omega);
    let [crank, cam, roller] = pulleys(t, y, omega);
    let (tight, [_, on_cam]) = span([begin[0], begin[1]], [crank, cam], 1.0, 150.0);
    let (low, [_, on_roller]) = span([begin[0], begin[2]], [crank, roller], -1.0, 300.0);
    let (high, [also_cam, also_roller]) = span([begin[1], begin[2]], [cam, roller], 1.0, 300.0);
    let pushed = on_roller.0.y + also_roller.0.y;
    (
        [tight, low, high],
        [on_cam.1 + also_cam.1, on_roller.1 + also_roller.1, pushed],
    )
}

/// The chain at 4000 rpm, slack and tight: the cycle that another integrator reaches, with forces from the points of touch.
#[test]
fn a_chain_runs_as_another_integrator_says() {
    let text = include_str!("../examples/timing/timing.eng");
    let omega = 4000.0 * TAU / 60.0;
    for (analysis, damping, tolerance) in [("soft[4]", 50.0, 1e-2), ("firm[4]", 3e3, 2e-3)] {
        let motion = |t: f64, y: &[f64; 6]| {
            let crank = pulleys(t, y, omega)[0].angle;
            let load = 5.0 + 14.0 * (2.0 * crank).cos() + 5.0 * (4.0 * crank).cos();
            let (_, [on_cam, on_roller, pushed]) = chain(t, y, omega);
            let spring = 1e4 * (0.0803 - 0.06 - y[2]) - damping * y[5];
            [
                y[3],
                y[4],
                y[5],
                (on_cam - load) / 2.4e-3,
                on_roller / 2e-5,
                (pushed + spring) / 0.22,
            ]
        };
        let results = run(text, analysis);
        let time = column(&results, "time");
        let mut y = [0.0, 0.0, 0.0, omega / 2.0, -1.2 * omega, 0.0];
        y = integrate(&motion, y, 0.0, time[0] / 60_000.0, 60_000);
        let mut due = Vec::new();
        for k in 0..time.len() {
            let (tensions, _) = chain(time[k], &y, omega);
            due.push([y[0] - omega * time[k] / 2.0, y[2], tensions[0], tensions[2]]);
            if let Some(next) = time.get(k + 1) {
                y = integrate(&motion, y, time[k], (next - time[k]) / 20.0, 20);
            }
        }
        let paths = ["cam_error", "guide.travel", "tight.load", "high.load"];
        follows(&results, &due, &paths.map(|path| (path, tolerance)));
    }
}
