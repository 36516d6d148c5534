//! Thrust bearings of `std.thrust` against Reynolds' equation on cells, a closed form and an integral.

use crate::library_run::{close, column, integral, integrate, last, refusal, run};
use std::f64::consts::{PI, TAU};

/// A shaft of 20 kg, upright in a guide. The ring is 60 mm to 80 mm wide, the end float 0.2 mm.
fn upright(bearing: &str, analysis: &str) -> String {
    format!(
        "use std.thrust.*
        use std.journals.Roughness
        use std.joints.Cylindrical
        use std.drives.PrescribedRotation
        model Shaft {{
            param speed: AngularVelocity = 3000 rpm
            param mass: Mass = 20 kg
            gravity = [0, 0, -9.81] m/s^2
            marker house = [0, 0, 0] mm
            body shaft {{
                mass = mass
                inertia = [0.1, 0.1, 0.05]*mass/(20 kg)*(1 kg*m^2)
                marker collar = origin
                start angular_velocity = [0, 0, 1]*speed
            }}
            joint bearing = Cylindrical(shaft.collar, house)
            drive turn = PrescribedRotation(shaft.collar, house, speed: speed)
            force thrust = {bearing}
        }}
        analysis it = {analysis}"
    )
}

const RING: &str =
    "inner_diameter: 60 mm, outer_diameter: 80 mm, end_float: 200 um, viscosity: 10 mPa*s";

/// The weight sinks on the oil of a flat ring. The damping of the film comes from an integral of the pressure over the ring.
#[test]
fn a_weight_sinks_on_a_ring_of_oil() {
    let text = upright(
        &format!("PlainThrust(shaft.collar, house, {RING})"),
        "transient(Shaft(), duration: 100 ms, sample: 1 ms)",
    );
    let results = run(&text, "it");
    // h^3/(12 mu) dp/dr = v (r^2 - m^2)/(2 r); the pressure is zero at both edges
    let (inner, outer, viscosity) = (0.03_f64, 0.04_f64, 0.01);
    let neutral = (outer * outer - inner * inner) / (2.0 * (outer / inner).ln());
    let radii: Vec<f64> = (0..=2000).map(|i| inner + 5e-6 * f64::from(i)).collect();
    let slopes: Vec<f64> = radii
        .iter()
        .map(|r| 6.0 * viscosity * (r - neutral / r))
        .collect();
    let moments: Vec<f64> = radii
        .iter()
        .zip(&slopes)
        .map(|(r, s)| -PI * r * r * s)
        .collect();
    let damping = -integral(&radii, &moments);
    let falling = |_: f64, y: &[f64; 2]| {
        let push = damping * (-y[1]).max(0.0) / (1e-4 + y[0]).powi(3)
            - damping * y[1].max(0.0) / (1e-4 - y[0]).powi(3);
        [y[1], push / 20.0 - 9.81]
    };
    let due = integrate(&falling, [0.0; 2], 0.0, 2e-6, 50_000);
    let gap = last(&results, "thrust.minimum_film");
    close("gap", gap, 1e-4 + due[0], 3e-4);
    // half of the float away the other face pushes nothing
    close(
        "load",
        last(&results, "thrust.force"),
        damping * -due[1] / (1e-4 + due[0]).powi(3),
        1e-3,
    );
    // the shear of both films at 3000 rpm
    let shear =
        PI / 2.0 * viscosity * (outer.powi(4) - inner.powi(4)) * (1.0 / gap + 1.0 / (2e-4 - gap));
    close(
        "torque",
        last(&results, "thrust.friction_torque"),
        shear * 100.0 * PI,
        1e-5,
    );
}

/// On rough faces the weight comes to rest where the integral of Greenwood and Tripp carries it.
#[test]
fn a_weight_rests_on_asperities() {
    let rough = "roughness: Roughness(sigma: 0.5 um, asperity: 3e-3, modulus: 1 GPa, boundary_friction: 0.1)";
    let text = upright(
        &format!("PlainThrust(shaft.collar, house, {RING}, {rough})"),
        "transient(Shaft(speed: 1 rpm), duration: 60 s, sample: 0.5 s)",
    );
    let results = run(&text, "it");
    let ratio = last(&results, "thrust.minimum_film") / 0.5e-6;
    let heights: Vec<f64> = (0..=20_000).map(|i| ratio + 5e-4 * f64::from(i)).collect();
    let share: Vec<f64> = heights
        .iter()
        .map(|s| (s - ratio).powf(2.5) * (-s * s / 2.0).exp() / TAU.sqrt())
        .collect();
    let area = PI * (0.04_f64.powi(2) - 0.03_f64.powi(2));
    close(
        "load",
        area * 3e-3 * 1e9 * integral(&heights, &share),
        196.2,
        1e-3,
    );
    close("part", last(&results, "thrust.asperity_part"), 1.0, 1e-3);
}

/// Load and torque over speed, of one pad by Reynolds' equation on cells: its length and width, gap at the land, depth and
/// share of the taper, and viscosity.
pub fn sliding_pad(pad: [f64; 6], along: usize) -> [f64; 2] {
    let [length, width, gap, depth, taper, viscosity] = pad;
    let across = along / 5;
    let (dx, dz) = (length / along as f64, width / across as f64);
    let height = |x: f64| gap + depth * (1.0 - x / (taper * length)).max(0.0);
    let line = across + 1;
    let mut pressure = vec![0.0_f64; (along + 1) * line];
    let edge: Vec<f64> = (0..along).map(|i| height((i as f64 + 0.5) * dx)).collect();
    for _ in 0..3000 {
        for i in 1..along {
            let flow = [edge[i - 1], edge[i]].map(|h| h.powi(3) * dz / dx);
            let side = (edge[i - 1].powi(3) + edge[i].powi(3)) / 2.0 * dx / dz;
            let source = 6.0 * viscosity * (edge[i - 1] - edge[i]) * dz;
            for j in 1..across {
                let at = i * line + j;
                let around = flow[0] * pressure[at - line] + flow[1] * pressure[at + line];
                let beside = side * (pressure[at - 1] + pressure[at + 1]);
                let due = (around + beside + source) / (flow[0] + flow[1] + 2.0 * side);
                pressure[at] += 1.85 * (due - pressure[at]);
            }
        }
    }
    let load = pressure.iter().sum::<f64>() * dx * dz;
    // the surface that slides feels the shear of the flow by its own motion and half of the slope of the pressure
    let drag = (0..along).map(|i| {
        let slopes = (0..=across).map(|j| pressure[(i + 1) * line + j] - pressure[i * line + j]);
        viscosity / edge[i] * dx * width + edge[i] / 2.0 * slopes.sum::<f64>() * dz
    });
    [load, drag.sum()]
}

/// A shaft turns on its pads: they carry its weight at the gap at which Reynolds' equation on cells does. A light shaft has a thick
/// film, a heavy one a thin film. The drag of the law leaves out a part of that of the pressure.
#[test]
fn pads_carry_as_reynolds_equation_says() {
    for (mass, analysis, drag_share) in [("20 kg", "20", 0.01), ("400 kg", "400", 0.05)] {
        let weight: f64 = analysis.parse::<f64>().expect("a mass") * 9.81;
        let text = upright(
            &format!(
                "TaperLandThrust(shaft.collar, house, {RING}, pads: 6, pad_angle: 50 deg, depth: 30 um)"
            ),
            &format!("transient(Shaft(mass: {mass}), duration: 2 s, sample: 10 ms)"),
        );
        let results = run(&text, "it");
        let gap = last(&results, "thrust.minimum_film");
        let length = 0.035 * 50.0_f64.to_radians();
        let speed = 0.035 * 100.0 * PI;
        let faces = [gap, 2e-4 - gap].map(|gap| {
            let pad = [length, 0.01, gap, 30e-6, 0.8, 0.01];
            let (coarse, fine) = (sliding_pad(pad, 50), sliding_pad(pad, 100));
            [0, 1].map(|k| 6.0 * speed * (fine[k] + (fine[k] - coarse[k]) / 3.0))
        });
        close("load", faces[0][0] - faces[1][0], weight, 2e-4);
        let due = (faces[0][1] + faces[1][1]) * 0.035;
        // the shear of the law has the third power of the radius over the ring, the pad of the cells the middle one
        let ring = (0.04_f64.powi(4) - 0.03_f64.powi(4)) / (4.0 * 0.035_f64.powi(3) * 0.01);
        close(
            "torque",
            last(&results, "thrust.friction_torque"),
            due * ring,
            drag_share,
        );
        let speeds = column(&results, "bearing.sliding_speed");
        assert!(speeds[speeds.len() - 1].abs() < 1e-9);
    }
}

/// The pads of a shaft that turns the other way need the other sense, and carry the same load. Against their sense they carry none.
#[test]
fn pads_have_a_sense() {
    let turning = |sense: &str, speed: &str| {
        let pads = format!("pads: 6, pad_angle: 50 deg, depth: 30 um, sense: {sense}");
        upright(
            &format!("TaperLandThrust(shaft.collar, house, {RING}, {pads})"),
            &format!("transient(Shaft(speed: {speed}), duration: 1 s, sample: 10 ms)"),
        )
    };
    let gap = |text: &str| last(&run(text, "it"), "thrust.minimum_film");
    let forward = gap(&turning("1", "3000 rpm"));
    let backward = gap(&turning("-1", "-3000 rpm"));
    close("backward", backward, forward, 1e-9);
    let message = refusal(&turning("-1", "3000 rpm"), "it");
    assert!(message.contains("the collar touches a face"), "{message}");
}

#[test]
fn a_collar_that_touches_smooth_faces_is_refused() {
    let text = upright(
        &format!("PlainThrust(shaft.collar, house, {RING})"),
        "transient(Shaft(), duration: 1 ms, sample: 0.1 ms)",
    );
    let text = text.replace(
        "marker collar = origin",
        "marker collar = [0, 0, 0.15] mm; start position = [0, 0, 0] mm",
    );
    let message = refusal(&text, "it");
    assert!(message.contains("the collar touches a face"), "{message}");
}
