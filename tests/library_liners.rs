//! Pistons in their play by `std.liners`: modes between two walls, a film that is squeezed, a barrel at rest, and the force of a guide.

use crate::library_run::{close, column, integrate, largest, last, run};
use nalgebra::{Matrix2, SymmetricEigen};
use std::f64::consts::TAU;

/// A piston between both walls of a bore along z. Its centre of mass is 8 mm above its marker.
fn piston(gravity: &str, skirt: &str, analysis: &str) -> String {
    format!(
        "use std.liners.*
        fn barrel(height: Length) -> Length = 20 um*((height - 5 mm)/(30 mm))^2
        model Bore {{
            gravity = {gravity} m/s^2
            marker bore = [0, 0, 0] mm
            body piston {{ mass = 0.5 kg; inertia = [0.45, 0.4, 0.4] g*m^2; center_of_mass = [0, 0, 8] mm; marker axis = origin }}
            joint plane = PistonPlane(piston.axis, bore)
            force wall[k in 1..2] = Skirt(piston.axis, bore, bore: 86 mm, side: [1, -1][k], width: 40 mm, layer: 20 MPa/mm, {skirt})
        }}
        analysis it = {analysis}"
    )
}

/// Without play both walls are one spring at each height: a rigid body that moves across and tilts on two springs.
#[test]
fn a_piston_without_play_has_the_modes_of_two_springs() {
    let skirt = "bottom: -40 mm, top: 20 mm, heights: 2, roughness: 0.01 um";
    let results = run(&piston("[0, 0, 0]", skirt, "linear(Bore())"), "it");
    let (mass, inertia, spring) = (0.5_f64, 0.4e-3_f64, 0.04 * 0.03 * 2e10);
    // places of the springs above the centre of mass: -25 mm and 5 mm above the marker
    let places = [-0.033, -0.003];
    let coupled = spring * places.iter().sum::<f64>() / (mass * inertia).sqrt();
    let tilting = spring * places.iter().map(|z| z * z).sum::<f64>() / inertia;
    let balance = Matrix2::new(2.0 * spring / mass, coupled, coupled, tilting);
    let mut due: Vec<f64> = SymmetricEigen::new(balance)
        .eigenvalues
        .iter()
        .map(|s| s.sqrt() / TAU)
        .collect();
    due.sort_by(f64::total_cmp);
    let found = column(&results, "frequency");
    let found: Vec<f64> = found.iter().copied().filter(|f| *f > 1.0).collect();
    assert_eq!(found.len(), 2);
    for (found, due) in found.iter().zip(&due) {
        close("frequency", *found, *due, 1e-5);
    }
}

/// Mean gap of rough surfaces.
fn film(gap: f64, roughness: f64) -> f64 {
    (gap + gap.hypot(0.8 * roughness)) / 2.0
}

/// Gravity across the bore: the piston falls through its play and squeezes the oil, with one height at its centre of mass.
#[test]
fn oil_between_piston_and_wall_is_squeezed() {
    let skirt = "clearance: 40 um, bottom: -12 mm, top: 28 mm, heights: 1, viscosity: 10 mPa*s";
    let analysis = "transient(Bore(), duration: 100 ms, sample: 0.5 ms)";
    let results = run(&piston("[490.5, 0, 0]", skirt, analysis), "it");
    let area = 0.04 * 0.04;
    let push = |gap: f64, closing: f64| {
        let mean = film(gap, 1e-6);
        let squeezed = 0.01 * 0.04 * 0.04_f64.powi(3) * closing.max(0.0) / mean.powi(3);
        area * 2e10 * (mean - gap) + squeezed
    };
    let falling = |_: f64, y: &[f64; 2]| {
        let net = push(40e-6 + y[0], -y[1]) - push(40e-6 - y[0], y[1]);
        [y[1], 490.5 + net / 0.5]
    };
    let mut y = [0.0; 2];
    let mut miss = 0.0_f64;
    for (k, found) in column(&results, "plane.across").iter().enumerate() {
        if k > 0 {
            y = integrate(&falling, y, 0.0, 5e-7, 1000);
        }
        miss = miss.max((found - y[0]).abs());
    }
    println!("{:.3e} m of {:.3e} m", miss, y[0]);
    assert!(y[0] > 15e-6 && miss < 2e-9, "{miss} of {}", y[0]);
    assert!(last(&results, "plane.tilt").abs() < 1e-9);
}

/// A barrel at rest on one wall: place and tilt where the springs of four heights balance weight and moment.
#[test]
fn a_barrel_rests_on_its_wall() {
    let skirt = "clearance: 40 um, bottom: -40 mm, top: 20 mm, heights: 4, profile: barrel";
    let results = run(&piston("[981, 0, 0]", skirt, "static(Bore())"), "it");
    let (across, tilt) = (last(&results, "plane.across"), last(&results, "plane.tilt"));
    let (mut force, mut moment) = (0.0, 0.0);
    for i in 0..4 {
        let height = -0.04 + 0.015 * (f64::from(i) + 0.5);
        let radius = 0.043 - 40e-6 - 20e-6 * ((height - 0.005) / 0.03).powi(2);
        for side in [1.0, -1.0] {
            let place = across + height * tilt.sin() + side * radius * tilt.cos();
            let gap = 0.043 - side * place;
            let load = 0.015 * 0.04 * 2e10 * (film(gap, 1e-6) - gap);
            force -= side * load;
            // about the centre of mass
            let lever = (height - 0.008) * tilt.cos() - side * radius * tilt.sin();
            moment -= side * load * lever;
        }
    }
    println!("{across:.3e} m, {tilt:.3e}, {force:.6} N, {moment:.2e} N m");
    close("weight", force, -0.5 * 981.0, 1e-6);
    assert!(moment.abs() < 1e-6 * 490.0 * 0.03, "{moment}");
}

/// A fired single: without play the force on stiff walls is that of a guide.
#[test]
fn without_play_the_walls_push_as_a_guide() {
    let text = |guide: &str| {
        format!(
            "use std.cylinder.{{WeighedRod, radial}}
            use std.engine.*
            use std.liners.Skirt
            use std.gas.{{ClosedCycle, wiebe}}
            use std.journals.Impedance
            use std.layouts.single
            use std.oils.SAE_10W40
            model Single {{
                part engine = Engine(
                    layout: single(), order: [1], bore: 86 mm, stroke: 86 mm, rod_length: 143 mm, spacing: 92 mm,
                    numbered_from: timing_end, seen_from: timing_end, sense: clockwise,
                    main_diameter: 54 mm, main_width: 20 mm, main_clearance: radial(15 um), big_ends: hinge, pin_diameter: 48 mm,
                    law: Impedance, oil: SAE_10W40, oil_temperature: 90 degC, piston_mass: 0.45 kg,
                    rod: WeighedRod(big_end: 0.42 kg, small_end: 0.18 kg, big_radius: 28 mm, small_radius: 14 mm),
                    crankshaft: Crank(mass: 20 kg, inertia: [250, 260, 42] g*m^2),
                    gas: ClosedCycle(stroke: 86 mm, compression_ratio: 10.5, heat: 0.8 kJ, burnt: wiebe(begin: -18 deg, duration: 50 deg)),
                    flywheel_mass: 11 kg, flywheel_inertia: 112 g*m^2, block_mass: 70 kg, block_inertia: [2, 2, 1] kg*m^2,
                    {guide} speed: 2000 rpm, drive_line: constant_speed,
                )
                gravity = engine.up*(-9.81 m/s^2)
            }}
            analysis run = transient(Single(), duration: 2 rev, sample: 2 deg)"
        )
    };
    let skirt = "piston_guide: skirt, skirt_law: Skirt(bottom: -40 mm, top: 10 mm, width: 40 mm, layer: 200 MPa/mm, loss: 100 s/m),";
    let (held, pushed) = (run(&text(""), "run"), run(&text(skirt), "run"));
    let path = "engine.cylinder[1].side_force";
    let (due, found) = (column(&held, path), column(&pushed, path));
    let squares = due
        .iter()
        .zip(found)
        .map(|(due, found)| (due - found).powi(2));
    let miss = (squares.sum::<f64>() / due.len() as f64).sqrt();
    let peak = largest(due);
    println!("{miss:.2} of {peak:.0} N");
    assert!(miss < 2e-3 * peak, "{miss} of {peak}");
}
