//! Gas laws of `std.gas`: corners of the ideal cycles, compressors, flow through an orifice.

use crate::library_run::{close, column, integral, integrate, largest, run};

const CRANK: &str = "use std.gas.*
    use std.joints.{Revolute, PointOnLine, Translational}
    use std.drives.ConstantSpeed
    component Crank(speed: AngularVelocity, rail: Marker, bore: Marker) {
        body crank { mass = 4 kg; inertia = [9, 9, 9] g*m^2; marker main = origin; marker pin = [0, 40, 0] mm }
        body rod { mass = 0.3 kg; inertia = [0.75, 0.06, 0.76] g*m^2; marker big = [0, -60, 0] mm; marker small = [0, 80, 0] mm }
        body piston { mass = 0.35 kg; inertia = [0.2, 0.3, 0.2] g*m^2; marker pin = origin; marker crown = at(origin, z: [0, 1, 0]) }
        drive turn = ConstantSpeed(crank.main, rail, speed: speed)
        joint big_end = Revolute(rod.big, crank.pin)
        joint wrist = PointOnLine(rod.small, piston.pin)
        joint guide = Translational(piston.crown, bore) { branch travel > 0 mm }
    }";

/// A cylinder of 86 mm × 80 mm, ratio 10, whose heat of 1.2 kJ burns from `begin` in `duration`.
fn otto(begin: &str, duration: &str, heat: &str) -> String {
    format!(
        "{CRANK}
    model Otto {{
        gravity = [0, 0, 0] m/s^2
        marker rail = [0, 0, 0] mm
        marker bore = at([0, 0, 0] mm, z: [0, 1, 0])
        part unit = Crank(3000 rpm, rail, bore)
        cycle angle = rotation(unit.crank.main, rail) {{ period = 720 deg }}
        force gas = ClosedCycle(unit.piston.crown, bore, bore: 86 mm, firing: 0 deg, ambient: 1 bar, scale: 1, top: 180 mm, stroke: 80 mm,
            compression_ratio: 10, heat: {heat}, burnt: wiebe(begin: {begin}, duration: {duration}))
    }}
    analysis run = periodic(Otto(), sample: 0.1 deg)"
    )
}

const KAPPA: f64 = 1.33;

#[test]
fn a_closed_charge_follows_the_isentrope_and_burns_at_constant_volume() {
    for (begin, duration, heat) in [
        ("-15 deg", "50 deg", "0 J"),
        ("-0.25 deg", "0.5 deg", "1.2 kJ"),
    ] {
        let results = run(&otto(begin, duration, heat), "run");
        let angle = column(&results, "cycle.angle");
        let pressure: Vec<f64> = column(&results, "gas.gauge_pressure")
            .iter()
            .map(|p| p + 1e5)
            .collect();
        let volume = column(&results, "gas.volume_of_gas");
        // angles after the firing dead centre, in degrees
        let theta = |k: usize| {
            let degrees = angle[k].to_degrees().rem_euclid(720.0);
            if degrees > 360.0 {
                degrees - 720.0
            } else {
                degrees
            }
        };
        let invariant = |from: f64, to: f64| -> Vec<f64> {
            let at = (0..angle.len()).filter(|k| theta(*k) > from && theta(*k) < to);
            at.map(|k| pressure[k] * volume[k].powf(KAPPA)).collect()
        };
        for (from, to) in [(-110.0, -1.0), (1.0, 110.0)] {
            let values = invariant(from, to);
            assert!(values.len() > 1000);
            let spread = largest(&values) / values.iter().fold(f64::MAX, |m, x| m.min(*x)) - 1.0;
            println!("isentrope from {from} to {to}: {spread:.1e}");
            assert!(spread < 2e-4, "{spread}");
        }
        // constant volume: the rise of the invariant is (κ − 1) Q V^(κ − 1)
        let clearance = std::f64::consts::PI / 4.0 * 0.086 * 0.086 * 0.08 / 9.0;
        let (cold, hot) = (invariant(-110.0, -1.0), invariant(1.0, 110.0));
        let rise = (hot[hot.len() / 2] - cold[cold.len() / 2]) / clearance.powf(KAPPA);
        if heat == "0 J" {
            assert!(rise.abs() < 1e3, "{rise}");
        } else {
            close("rise", rise, (KAPPA - 1.0) * 1200.0 / clearance, 1e-3);
        }
        // the work of the cycle is that of pressure over volume
        let work = integral(
            column(&results, "time"),
            column(&results, "gas.indicated_power"),
        );
        let gauge: Vec<f64> = pressure.iter().map(|p| p - 1e5).collect();
        close("work", work, integral(volume, &gauge), 1e-4);
    }
}

/// The closed form of the cycle, with valves that open and close at once.
#[test]
fn a_closed_cycle_without_a_state_has_the_pressure_of_its_class() {
    let text = format!(
        "{CRANK}
    fn closed_form = closed_cycle(bore: 86 mm, stroke: 80 mm, rod_length: 140 mm, compression_ratio: 10, heat: 1.2 kJ, begin: -22 deg,
        duration: 52 deg, intake: 0.95 bar, ramp: 0.1 deg, blowdown: 0.1 deg)
    model Both {{
        gravity = [0, 0, 0] m/s^2
        marker rail = [0, 0, 0] mm
        marker bore = at([0, 0, 0] mm, z: [0, 1, 0])
        part unit = Crank(1000 rpm, rail, bore)
        cycle angle = rotation(unit.crank.main, rail) {{ period = 720 deg }}
        force gas = ClosedCycle(unit.piston.crown, bore, bore: 86 mm, firing: 0 deg, top: 180 mm, stroke: 80 mm, compression_ratio: 10,
            heat: 1.2 kJ, burnt: wiebe(begin: -22 deg, duration: 52 deg), intake: 0.95 bar, ramp: 0.1 deg, lag: 0.01 ms)
        let after = wrapped(cycle.angle - 0 deg, 720 deg, from: -360 deg)
        output after_firing = after as deg
        output closed: Pressure = closed_form(after + 0 deg) - 1.01325 bar as bar
    }}
    analysis run = periodic(Both(), sample: 1 deg)"
    );
    let results = run(&text, "run");
    let after = column(&results, "after_firing");
    let found = column(&results, "closed");
    let due = column(&results, "gas.gauge_pressure");
    let mut worst = 0.0_f64;
    for ((after, found), due) in after.iter().zip(found).zip(due) {
        if after.to_degrees().abs() < 130.0 {
            worst = worst.max((found - due).abs() / (due + 101_325.0));
        }
    }
    println!("{worst:.1e} between the valves' angles");
    assert!(worst < 1e-3, "{worst}");
    close("peak", largest(found), largest(due), 2e-4);
}

#[test]
fn a_heat_burns_by_wiebes_share() {
    let text = "use std.gas.*
    use std.joints.Revolute
    model Shares {
        gravity = [0, 0, 0] m/s^2
        body wheel { mass = 1 kg; inertia = [1, 1, 1] g*m^2; marker hub = origin }
        joint bearing = Revolute(wheel.hub, ground)
        output share[i in 1..6] = wiebe([-20, 5, 20, 40, 41, 60][i]*1 deg, begin: -10 deg, duration: 50 deg, shape: 1.5)
        output both = double_wiebe(5 deg, begin: -10 deg, duration: 50 deg, second_begin: 0 deg, second_duration: 40 deg, share: 30 %)
        output parts = 0.3*wiebe(5 deg, begin: -10 deg, duration: 50 deg) + 0.7*wiebe(5 deg, begin: 0 deg, duration: 40 deg, shape: 1)
        output critical = orifice_flow(5 bar, 1 bar, 400 K, 1 cm^2, 1.4, gas_constant_of_air) as g/s
        output slow = orifice_flow(1 bar, 0.995 bar, 400 K, 1 cm^2, 1.4, gas_constant_of_air, laminar: 1e-9) as g/s
        output back = orifice_flow(1 bar, 2 bar, 400 K, 1 cm^2, 1.4, gas_constant_of_air) as g/s
    }
    analysis run = assemble(Shares())";
    let results = run(text, "run");
    let value = |path: &str| column(&results, path)[0];
    let share = |y: f64| 1.0 - (-6.908 * y.powf(2.5)).exp();
    assert_eq!(value("share[1]"), 0.0);
    close("share", value("share[2]"), share(0.3), 1e-12);
    close("share", value("share[3]"), share(0.6), 1e-12);
    // the rate goes on after the nominal end
    close("share", value("share[4]"), share(1.0), 1e-12);
    close("share", value("share[5]"), share(1.02), 1e-12);
    close("share", value("share[6]"), share(1.4), 1e-12);
    close("both", value("both"), value("parts"), 1e-12);
    let gas = 287.053 * 400.0;
    let factor = (2.0_f64 / 2.4).powf(2.4 / 0.8);
    close(
        "critical",
        value("critical"),
        1e-4 * 5e5 * (1.4_f64 / gas).sqrt() * factor,
        1e-5,
    );
    // Bernoulli's flow with the density at the orifice is right to the first order of the fall
    let density = 1e5 / gas;
    close(
        "slow",
        value("slow"),
        1e-4 * (2.0 * density * 500.0).sqrt(),
        5e-3,
    );
    assert_eq!(value("back"), 0.0);
}

/// A compressor of 60 mm × 80 mm with 5 % of clearance between 1 and 5 bar.
fn compressor(speed: &str, gas: &str) -> String {
    format!(
        "{CRANK}
    const valve = PlateValve(plate: 4 cm^2, port: 10 cm^2, lift: 2 mm, mass: 0.2 g, stiffness: 0.1 N/mm, preload: 0.01 N, damping: 0.1 N*s/m, stop: 20 N/mm)
    model Compressor {{
        gravity = [0, 0, 0] m/s^2
        marker rail = [0, 0, 0] mm
        marker bore = at([0, 0, 0] mm, z: [0, 1, 0])
        part unit = Crank({speed}, rail, bore)
        cycle angle = rotation(unit.crank.main, rail) {{ period = 360 deg }}
        force gas = {gas}(unit.piston.crown, bore, bore: 60 mm, top: 180 mm, clearance: {} cc, suction: 1 bar, delivery: 5 bar, {})
    }}
    analysis run = periodic(Compressor(), sample: 0.1 deg)",
        0.05 * swept() * 1e6,
        if gas == "IdealCompressor" {
            "suction_port: 20 cm^2, delivery_port: 20 cm^2"
        } else {
            "suction_valve: valve, delivery_valve: valve"
        }
    )
}

fn swept() -> f64 {
    std::f64::consts::PI / 4.0 * 0.06 * 0.06 * 0.08
}

/// Volumetric efficiency `1 + c − c π^(1/κ)` and work `κ/(κ − 1) p V (π^((κ − 1)/κ) − 1)` of the ideal cycle;
/// light plates give nearly the same.
#[test]
fn compressors_have_the_efficiency_and_work_of_the_ideal_cycle() {
    let efficiency = 1.05 - 0.05 * 5.0_f64.powf(1.0 / 1.4);
    let work = 3.5 * 1e5 * swept() * efficiency * (5.0_f64.powf(0.4 / 1.4) - 1.0);
    let due_mass = efficiency * swept() * 1e5 / (287.053 * 293.0);
    for (gas, speed, tolerance) in [
        ("IdealCompressor", "300 rpm", 1e-3),
        ("PlateCompressor", "300 rpm", 3e-3),
    ] {
        let results = run(&compressor(speed, gas), "run");
        let time = column(&results, "time");
        let into = integral(time, column(&results, "gas.suction_flow"));
        let out = integral(time, column(&results, "gas.delivery_flow"));
        close("mass in", into, due_mass, tolerance);
        close("mass out", out, due_mass, tolerance);
        let power = integral(time, column(&results, "gas.indicated_power"));
        // the ideal cycle's work counts from vacuum on both sides, as the ambient pressure does none in a cycle
        close("work", -power, work, 2.0 * tolerance);
    }
}

/// Fall of the piston from its dead centre over the stroke of 80 mm, throw over rod 2/7.
fn fallen(theta: f64) -> f64 {
    let ratio = 40.0 / 140.0;
    let cosine = (1.0 - (ratio * theta.sin()).powi(2)).sqrt();
    (1.0 - theta.cos() + (1.0 - cosine) / ratio) / 2.0
}

/// Heat to the walls (W) at 3000 rpm by Woschni's coefficient as Heywood states it, with the state at the closing of the intake.
fn to_walls(pressure: f64, volume: f64) -> f64 {
    let area = std::f64::consts::PI / 4.0 * 0.086 * 0.086;
    let (swept, first) = (
        area * 0.08,
        area * 0.08 * (1.0 / 9.0 + fallen(-135.0_f64.to_radians())),
    );
    let temperature = 350.0 * pressure * volume / (1e5 * first);
    let motored = 1e5 * (first / volume).powf(KAPPA);
    let speed = 2.28 * 2.0 * 0.08 * 50.0
        + 3.24e-3 * swept * 350.0 / (100.0 * first) * (pressure - motored).max(0.0) / 1e3;
    let coefficient = 3.26
        * 0.086_f64.powf(-0.2)
        * (pressure / 1e3).powf(0.8)
        * temperature.powf(-0.55)
        * speed.powf(0.8);
    coefficient * (2.0 * area + 4.0 * volume / 0.086) * (temperature - 420.0)
}

/// Pressure and lost heat of the closed part of a cycle against another integrator, from 100° before the dead centre to 100° after it.
#[test]
fn walls_take_heat_as_woschni_says() {
    let walls = "burnt: wiebe(begin: -15 deg, duration: 50 deg),
            walls: Woschni(wall_temperature: 420 K, charge_temperature: 350 K, rod_ratio: 2/7))";
    let text = otto("-15 deg", "50 deg", "1.2 kJ")
        .replace("burnt: wiebe(begin: -15 deg, duration: 50 deg))", walls);
    let results = run(&text, "run");
    let angle = column(&results, "cycle.angle");
    let theta: Vec<f64> = angle
        .iter()
        .map(|a| (a.to_degrees() + 360.0).rem_euclid(720.0) - 360.0)
        .collect();
    let at = |due: f64| {
        theta
            .iter()
            .position(|t| (t - due).abs() < 0.01)
            .expect("a sample")
    };
    let area = std::f64::consts::PI / 4.0 * 0.086 * 0.086;
    let omega = 100.0 * std::f64::consts::PI;
    let volume = |t: f64| area * 0.08 * (1.0 / 9.0 + fallen(t));
    let burning = |t: f64| {
        let y = (t + 15.0_f64.to_radians()) / 50.0_f64.to_radians();
        let rate = 6.908 * 3.0 * y.powi(2) * (-6.908 * y.powi(3)).exp() / 50.0_f64.to_radians();
        if y > 0.0 { 1200.0 * rate } else { 0.0 }
    };
    // over the angle: pressure and heat to the walls
    let closed = |t: f64, y: &[f64; 2]| {
        let lost = to_walls(y[0], volume(t)) / omega;
        let rise = (volume(t + 1e-5) - volume(t - 1e-5)) / 2e-5;
        [
            ((KAPPA - 1.0) * (burning(t) - lost) - KAPPA * y[0] * rise) / volume(t),
            lost,
        ]
    };
    let gauge = column(&results, "gas.gauge_pressure");
    let (from, to) = (-100.0_f64.to_radians(), 100.0_f64.to_radians());
    let first = [gauge[at(-100.0)] + 1e5, 0.0];
    let due = integrate(&closed, first, from, (to - from) / 20_000.0, 20_000);
    close("pressure", gauge[at(100.0)] + 1e5, due[0], 1e-4);
    let time = column(&results, "time");
    let lost = column(&results, "gas.heat_to_walls");
    // the cycle begins at the dead centre
    let part = |begin: usize, end: usize| integral(&time[begin..=end], &lost[begin..=end]);
    let last = time.len() - 1;
    close(
        "heat",
        part(0, at(100.0)) + part(at(-100.0), last),
        due[1],
        1e-4,
    );
}

/// The four strokes take 720°: another cycle would leave out strokes, or burn twice in one.
#[test]
fn a_gas_of_four_strokes_refuses_another_cycle() {
    let text = otto("-15 deg", "50 deg", "1 kJ").replace("period = 720 deg", "period = 360 deg");
    let sources = eng::Sources::from_texts([("model.eng".to_owned(), text)]);
    let Err(report) = eng::check(&sources, "model.eng").into_program().map(drop) else {
        panic!("a cycle of two strokes");
    };
    let report = report.to_string();
    assert!(
        report.contains("a cycle of 360 deg: this gas has the four strokes of 720 deg"),
        "{report}"
    );
}
