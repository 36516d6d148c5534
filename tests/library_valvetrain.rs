//! Parts of valve trains of `std.valvetrain` against closed forms and another integrator.

use crate::library_run::{close, column, integrate, largest, last, refusal, run};
use std::f64::consts::PI;

/// Coefficients of `1 + c2 s² + cp s^p + cq s^q + cr s^r` with value, slope, acceleration and its rate zero at s = 1, by elimination.
fn polydyne(powers: [i32; 4]) -> [f64; 4] {
    let mut rows: [[f64; 5]; 4] = std::array::from_fn(|order| {
        std::array::from_fn(|k| match k {
            4 => -f64::from(u8::from(order == 0)),
            _ => (0..order as i32)
                .map(|i| f64::from(powers[k] - i))
                .product(),
        })
    });
    for k in 0..4 {
        let pivot = rows[k].map(|x| x / rows[k][k]);
        rows[k] = pivot;
        for i in (0..4).filter(|i| *i != k) {
            let factor = rows[i][k];
            for (x, p) in rows[i].iter_mut().zip(pivot) {
                *x -= factor * p;
            }
        }
    }
    rows.map(|row| row[4])
}

/// A name, and lift, slope (mm/rad) and curvature (mm/rad²) at s = 0.3 of a half of 60 deg, for a lift of 9 mm.
#[test]
fn laws_of_lift_have_their_slopes() {
    let half = PI / 3.0;
    let s = 0.3_f64;
    let u = 1.0 - s;
    let powers = [2, 8, 14, 20];
    let fuller = polydyne(powers);
    let sum = |of: &dyn Fn(f64, i32) -> f64| -> f64 {
        fuller
            .iter()
            .zip(powers)
            .map(|(c, p)| c * of(f64::from(p), p))
            .sum()
    };
    let cases = [
        (
            "harmonic_lift",
            4.5 * (1.0 + (PI * s).cos()),
            -4.5 * PI / half * (PI * s).sin(),
            -4.5 * PI * PI / half / half * (PI * s).cos(),
        ),
        (
            "cycloidal_lift",
            9.0 * (u - (2.0 * PI * u).sin() / (2.0 * PI)),
            -9.0 / half * (1.0 - (2.0 * PI * u).cos()),
            9.0 / half / half * 2.0 * PI * (2.0 * PI * u).sin(),
        ),
        (
            "polynomial_lift",
            9.0 * (1.0 - s * s).powf(4.0),
            -72.0 * s / half * (1.0 - s * s).powf(3.0),
            -72.0 / half / half * (1.0 - s * s).powf(2.0) * (1.0 - 7.0 * s * s),
        ),
        (
            "polydyne_lift",
            9.0 * (1.0 + sum(&|_, p| s.powi(p))),
            9.0 / half * sum(&|q, p| q * s.powi(p - 1)),
            9.0 / half / half * sum(&|q, p| q * (q - 1.0) * s.powi(p - 2)),
        ),
    ];
    for (law, lift, slope, curvature) in cases {
        let text = format!(
            "use std.valvetrain.*
            use std.joints.Revolute
            fn profile = {law}(lift: 9 mm, half: 60 deg)
            model Cam {{
                gravity = [0, 0, 0] m/s^2
                body wheel {{ mass = 1 kg; inertia = [1, 1, 1] g*m^2; marker hub = origin }}
                joint bearing = Revolute(wheel.hub, ground)
                output lift[i in 1..4] = profile([0, 18, 60, -61][i]*1 deg)
                output rise[i in 1..4] = slope(profile, [0, 18, 60, -61][i]*1 deg)
                output bend = curvature(profile, 18 deg)
            }}
            analysis run = assemble(Cam())"
        );
        let results = run(&text, "run");
        close(law, last(&results, "lift[1]"), 9e-3, 1e-12);
        close("lift", last(&results, "lift[2]"), 1e-3 * lift, 1e-12);
        close("slope", last(&results, "rise[2]"), 1e-3 * slope, 1e-12);
        close("curvature", last(&results, "bend"), 1e-3 * curvature, 1e-11);
        for path in ["lift[3]", "lift[4]", "rise[3]", "rise[4]"] {
            assert!(last(&results, path).abs() < 1e-12, "{law} {path}");
        }
    }
}

/// A tappet of 150 g on a cam, pressed by a spring of 30 N/mm.
fn tappet(speed: &str, drive: &str) -> String {
    format!(
        "use std.valvetrain.*
        use std.joints.{{Translational, Revolute}}
        use std.drives.PrescribedRotation
        use std.forces.LinearSpring
        model Train {{
            gravity = [0, 0, 0] m/s^2
            marker guide = [0, 0, 0] mm
            marker top = [0, 0, 60] mm
            marker axle = at([0, 0, -30] mm, z: [0, 1, 0])
            body cam {{ mass = 1 kg; inertia = [0.6, 0.3, 0.6] g*m^2; marker main = at(origin, z: [0, 1, 0]) }}
            body tappet {{ mass = 0.15 kg; inertia = [0.05, 0.05, 0.01] g*m^2; marker stem = origin }}
            joint bearing = Revolute(cam.main, axle)
            joint slide = Translational(tappet.stem, guide)
            start slide.travel = 0 mm
            start bearing.angle = -100 deg
            start der(bearing.angle) = {speed}
            {drive}
            force contact = FlatTappet(tappet.stem, guide, cam.main, axle, profile: polynomial_lift(lift: 9 mm, half: 65 deg),
                base_radius: 50 mm, face_radius: 18 mm, stiffness: 20 N/um, damping: 200 N*s/m, base: 10 um)
            force spring = LinearSpring(tappet.stem, top, stiffness: 30 N/mm, free_length: 70 mm)
        }}
        analysis run = transient(Train(), duration: 10 ms, sample: 10 us)"
    )
}

/// At 6000 rpm of the cam the tappet leaves it past the nose and falls back: its path against another integrator.
#[test]
fn a_tappet_leaves_its_cam_as_another_integrator_says() {
    let text = tappet(
        "6000 rpm",
        "drive turn = PrescribedRotation(cam.main, axle, speed: 6000 rpm, initial: -100 deg)",
    );
    let results = run(&text, "run");
    let omega = 200.0 * PI;
    let profile = |angle: f64| {
        let s = (angle + PI).rem_euclid(2.0 * PI) - PI;
        let half = 65.0_f64.to_radians();
        let share = 1.0 - (s / half) * (s / half);
        if share > 0.0 {
            (
                9e-3 * share.powf(4.0),
                -72e-3 * s / half / half * share.powf(3.0),
            )
        } else {
            (0.0, 0.0)
        }
    };
    let law = |t: f64, y: &[f64; 2]| {
        let (lift, slope) = profile(omega * t - 100.0_f64.to_radians());
        let depth = (1e-5 + lift - y[0]).max(0.0);
        let rate = slope * omega - y[1];
        let push =
            2e7 * depth * (1.0 + 200.0 / 2e7 * rate * depth / (depth * depth + 1e-12)).max(0.0);
        [y[1], (push - 3e4 * (y[0] + 0.01)) / 0.15]
    };
    let travel = column(&results, "slide.travel");
    let (mut y, mut worst) = ([0.0; 2], 0.0_f64);
    for (k, found) in travel.iter().enumerate() {
        worst = worst.max((found - y[0]).abs());
        y = integrate(&law, y, k as f64 * 1e-5, 1e-8, 1000);
    }
    println!("tappet: {:.1e} of the lift", worst / 9e-3);
    assert!(worst < 1e-3 * 9e-3, "{worst}");
    assert!(
        largest(column(&results, "contact.gap")) > 1e-4,
        "it never left the cam"
    );
}

/// A free cam and its tappet: what the motion loses is in the spring, the contact and the heat.
#[test]
fn a_cam_gives_its_energy_to_the_tappet() {
    let results = run(&tappet("3000 rpm", ""), "run");
    let (time, loss) = (
        column(&results, "time"),
        column(&results, "contact.power_loss"),
    );
    let (kinetic, held) = (
        column(&results, "energy.kinetic"),
        column(&results, "contact.stored_energy"),
    );
    let travel = column(&results, "slide.travel");
    let mut heat = 0.0;
    let (mut least, mut most) = (f64::MAX, f64::MIN);
    for k in 0..time.len() {
        if k > 0 {
            heat += 0.5 * (loss[k] + loss[k - 1]) * (time[k] - time[k - 1]);
        }
        let spring = 0.5 * 3e4 * (travel[k] + 0.01) * (travel[k] + 0.01);
        let total = kinetic[k] + held[k] + spring + heat;
        least = least.min(total);
        most = most.max(total);
    }
    let change = largest(kinetic) - kinetic.iter().fold(f64::MAX, |m, x| m.min(*x));
    println!("energy: {:.1e} of {change}", (most - least) / change);
    assert!(most - least < 1e-3 * change, "{least} {most}");
}

/// Under a constant load the element sinks with `F/A π d h³/(12 μ l)/A`, after the first compression `F V/(B A²)`.
#[test]
fn a_lash_adjuster_leaks_down_at_a_constant_rate() {
    let text = "use std.valvetrain.HydraulicLashAdjuster
        use std.joints.Translational
        use std.forces.ExternalForce
        force Drag(a: Marker, b: Marker, damping: Damping) {
            apply force -damping*dot(a.velocity - b.velocity, b.z)*b.z on a against b
        }
        model Lash {
            gravity = [0, 0, 0] m/s^2
            marker seat = [0, 0, 0] mm
            body plunger { mass = 0.05 kg; inertia = [0.05, 0.05, 0.05] g*m^2; marker top = origin; start position = [0, 0, 10] mm }
            joint slide = Translational(plunger.top, seat)
            force element = HydraulicLashAdjuster(plunger.top, seat, diameter: 11 mm, gap: 6 um, seal: 8 mm, volume: 0.3 cc, supply: 3 bar, viscosity: 10 mPa*s, spring: 0 N)
            force press = ExternalForce(plunger.top, load: [0, 0, -1000] N)
            force drag = Drag(plunger.top, seat, damping: 1000 N*s/m)
        }
        analysis lash = transient(Lash(), duration: 0.1 s, sample: 1 ms)";
    let results = run(text, "lash");
    let area = PI / 4.0 * 0.011 * 0.011;
    let leak = PI * 0.011 * 6e-6_f64.powi(3) / (12.0 * 0.01 * 0.008);
    let (time, place) = (column(&results, "time"), column(&results, "slide.travel"));
    let (k, end) = (time.len() / 2, time.len() - 1);
    let rate = (place[k] - place[end]) / (time[end] - time[k]);
    // the drag carries a little of the load
    let due = leak / area / area * 1000.0 / (1.0 + 1000.0 * leak / area / area);
    close("rate", rate, due, 1e-5);
    let first = 0.01 - place[k] - due * time[k];
    close(
        "compression",
        first,
        1000.0 * 0.3e-6 / (1.2e9 * area * area),
        2e-2,
    );
}

/// The row of masses between fixed ends has the frequencies `n/π √(k/m) sin(j π/2n)`; the first is near the
/// surge `√(k/m)/2`.
#[test]
fn a_valve_spring_surges() {
    let text = "use std.valvetrain.ValveSpring
        model Surge {
            gravity = [0, 0, 0] m/s^2
            marker seat = [0, 0, 0] mm
            marker upper = [0, 0, 40] mm
            part spring = ValveSpring(seat, upper, stiffness: 30 N/mm, spring_mass: 60 g, free_length: 50 mm, installed: 40 mm, masses: 8)
        }
        analysis modes = linear(Surge())
        analysis rest = static(Surge())";
    let results = run(text, "modes");
    let frequency = column(&results, "frequency");
    let rate = (30e3_f64 / 0.06).sqrt();
    for j in 1..=8 {
        let due = 8.0 / PI * rate * (f64::from(j) * PI / 16.0).sin();
        let nearest = frequency.iter().fold(f64::MAX, |m, f| {
            if (f - due).abs() < (m - due).abs() {
                *f
            } else {
                m
            }
        });
        // springs shorter than their last micrometre are rounded
        close("mode", nearest, due, 1e-6);
    }
    let first = frequency
        .iter()
        .copied()
        .filter(|f| *f > 1.0)
        .fold(f64::MAX, f64::min);
    close("surge", first, rate / 2.0, 1e-2);
    close("load", last(&run(text, "rest"), "spring.load"), 300.0, 1e-6);
}

/// A plunger with a roller of 12 mm, whose axis follows a circle of 32 mm about a point 5 mm beside the axle.
const ROLLER: &str = "use std.valvetrain.RollerCam
        use std.joints.Translational
        use std.drives.ConstantSpeed
        use std.forces.LinearSpring
        fn rise(angle: Angle) -> Length = 5 mm*cos(angle) + sqrt((32 mm)^2 - (5 mm*sin(angle))^2) - 27 mm
        model Disc {
            gravity = [0, 0, 0] m/s^2
            marker axle = [0, 0, 0] mm
            marker bore = at([0, 0, 0] mm, z: [1, 0, 0])
            marker top = [90, 0, 0] mm
            body cam { mass = 1 kg; inertia = [1, 1, 1] g*m^2; marker main = origin }
            body plunger { mass = 0.3 kg; inertia = [1, 1, 1] g*m^2; marker axis = at(origin, z: [1, 0, 0]); marker roller = origin }
            drive turn = ConstantSpeed(cam.main, axle, speed: 60 rad/s, initial: 30 deg)
            joint guide = Translational(plunger.axis, bore) { branch travel > 0 mm }
            force spring = LinearSpring(plunger.roller, top, stiffness: 20 N/mm, free_length: 80 mm)
            force contact = RollerCam(plunger.roller, cam.main, base: 27 mm, roller_radius: 12 mm, profile: rise, stiffness: 200 N/um, damping: 6 kN*s/m)
            start guide.travel = 36 mm
        }
        analysis run = transient(Disc(), duration: 250 ms, sample: 1 ms)";

/// A roller of 12 mm on a disc of 20 mm whose centre is 5 mm beside its axle: the plunger of 0.3 kg moves as the slide of a slider-crank
/// whose rod is as long as both radii. Force along the normal, and torque on the cam by virtual work.
#[test]
fn a_roller_rides_on_an_eccentric_disc() {
    let results = run(ROLLER, "run");
    let time = column(&results, "time");
    let mut checked = 0;
    for (k, t) in time.iter().enumerate().filter(|(_, t)| **t > 0.1) {
        let (angle, omega) = (30.0_f64.to_radians() + 60.0 * t, 60.0);
        let (sin, cos) = angle.sin_cos();
        let root = (0.032_f64.powi(2) - (0.005 * sin).powi(2)).sqrt();
        let travel = 0.005 * cos + root;
        let lean = 0.005 * sin / root;
        // the slope of the travel by the angle, and its second derivative
        let slope = -0.005 * sin - 0.005 * cos * lean;
        let bend = -0.005 * cos
            - 0.005_f64.powi(2)
                * ((cos * cos - sin * sin) / root + (0.005 * sin * cos).powi(2) / root.powi(3));
        let along = 0.3 * bend * omega * omega + 20e3 * (0.08 - (0.09 - travel));
        let value = |path: &str| column(&results, path)[k];
        // the contact is up to 2.7 um deep
        assert!((value("guide.travel") - travel).abs() < 4e-6, "{t}");
        let load = along / lean.atan().cos();
        assert!(
            (value("contact.load") / load - 1.0).abs() < 1e-3,
            "{t}: {} {load}",
            value("contact.load")
        );
        let torque = along * slope;
        assert!(
            (value("turn.torque.z") - torque).abs() < 2e-3 * 1.5,
            "{t}: {} {torque}",
            value("turn.torque.z")
        );
        assert!((value("contact.pressure_angle").abs() - lean.abs().atan()).abs() < 2e-4);
        checked += 1;
    }
    assert!(checked > 100);
}

/// The pad of 12 mm on the same disc, with a friction of 0.1: force along the normal and across it, torque on the cam, heat.
#[test]
fn a_pad_rubs_on_its_cam() {
    let rubbing = "damping: 6 kN*s/m, friction: 0.1, creep: 1 mm/s)";
    let results = run(&ROLLER.replace("damping: 6 kN*s/m)", rubbing), "run");
    let mut checked = 0;
    for (k, t) in column(&results, "time").iter().enumerate() {
        if *t < 0.1 {
            continue;
        }
        let omega = 60.0;
        let (sin, cos) = (30.0_f64.to_radians() + omega * t).sin_cos();
        let root = (0.032_f64.powi(2) - (0.005 * sin).powi(2)).sqrt();
        let lean = 0.005 * sin / root;
        let travel = 0.005 * cos + root;
        let slope = -0.005 * sin - 0.005 * cos * lean;
        let bend = -0.005 * cos
            - 0.005_f64.powi(2)
                * ((cos * cos - sin * sin) / root + (0.005 * sin * cos).powi(2) / root.powi(3));
        let along = 0.3 * bend * omega * omega + 20e3 * (0.08 - (0.09 - travel));
        // from the centre of the disc to that of the pad, and a quarter of a turn ahead of it
        let normal = [root / 0.032, -0.005 * sin / 0.032];
        let ahead = [-normal[1], normal[0]];
        let touch = [
            0.005 * cos + 0.020 * normal[0],
            0.005 * sin + 0.020 * normal[1],
        ];
        let seen = [omega * (slope + touch[1]), -omega * touch[0]];
        let sliding = seen[0] * ahead[0] + seen[1] * ahead[1];
        let rub = -0.1 * sliding.signum();
        let load = along / (normal[0] + rub * ahead[0]);
        let force = [0, 1].map(|i| load * (normal[i] + rub * ahead[i]));
        let value = |path: &str| column(&results, path)[k];
        close("load", value("contact.load"), load, 1e-3);
        close(
            "heat",
            value("contact.power_loss"),
            0.1 * load * sliding.abs(),
            1e-3,
        );
        let torque = touch[0] * force[1] - touch[1] * force[0];
        assert!(
            (value("turn.torque.z") - torque).abs() < 2e-3 * 3.4,
            "{t}: {} {torque}",
            value("turn.torque.z")
        );
        // the friction acts on the face of the pad, and the guide holds its moment
        let held = -0.012 * rub * load;
        assert!((value("guide.torque.y") + held).abs() < 1e-3, "{t}: {held}");
        checked += 1;
    }
    assert!(checked > 100);
}

/// A roller falls on the back of its cam just where its angle from the nose jumps by a turn. The lift is the same on both sides, so a
/// long step that meets both goes on, and the bounce is that of short steps.
#[test]
fn a_roller_falls_on_the_back_of_its_cam() {
    for law in [
        "harmonic_lift",
        "cycloidal_lift",
        "polynomial_lift",
        "polydyne_lift",
    ] {
        let text = ROLLER
            .replace("use std.valvetrain.RollerCam", "use std.valvetrain.*")
            .replace(
                "profile: rise",
                &format!("profile: {law}(lift: 5 mm, half: 60 deg)"),
            )
            .replace("base: 27 mm", "base: 32 mm")
            .replace("bore = at([0, 0, 0]", "bore = at([0, 3, 0]")
            .replace("top = [90, 0, 0]", "top = [90, 3, 0]")
            .replace("initial: 30 deg", "initial: 170 deg")
            .replace("travel = 36 mm", "travel = 32 mm")
            .replace(", damping: 6 kN*s/m", "")
            .replace("duration: 250 ms", "duration: 8 ms");
        let bounced = last(&run(&text, "run"), "contact.gap");
        let short = text.replace("sample: 1 ms", "sample: 20 us");
        let due = last(&run(&short, "run"), "contact.gap");
        assert!(due > 1e-4, "{law}: {due}");
        close(law, bounced, due, 1e-3);
    }
}

/// The powers 4, 6, 8 of `polydyne_lift` are the law `(1 - s²)⁴`.
#[test]
fn a_polydyne_of_low_powers_is_the_polynomial() {
    let text = "
            use std.valvetrain.*
            use std.joints.Revolute
            fn general = polydyne_lift(lift: 9 mm, half: 60 deg, powers: [4, 6, 8])
            fn special = polynomial_lift(lift: 9 mm, half: 60 deg)
            model Cam {
                gravity = [0, 0, 0] m/s^2
                body wheel { mass = 1 kg; inertia = [1, 1, 1] g*m^2; marker hub = origin }
                joint bearing = Revolute(wheel.hub, ground)
                output miss = max(abs(general(i*7 deg) - special(i*7 deg)) for i in -9..9)
            }
            analysis run = assemble(Cam())";
    let miss = last(&run(text, "run"), "miss");
    assert!(miss < 1e-15 * 9.0, "{miss}");
}

/// The curvature of a cam under a flat face is that of its nose, `base_radius + lift - 8 lift/half²`; the contact moves by the largest
/// slope, that at `half/√7`.
#[test]
fn a_flat_tappet_refuses_a_cam_that_it_cannot_follow() {
    let half = 65.0_f64.to_radians();
    let least = 72.0 / half / half - 9.0;
    let aside = 72.0 / half * (6.0_f64 / 7.0).powi(3) / 7.0_f64.sqrt();
    let text = |base: f64, face: f64| {
        let drive =
            "drive turn = PrescribedRotation(cam.main, axle, speed: 600 rpm, initial: -100 deg)";
        tappet("600 rpm", drive)
            .replace("base_radius: 50 mm", &format!("base_radius: {base} mm"))
            .replace("face_radius: 18 mm", &format!("face_radius: {face} mm"))
            .replace("duration: 10 ms", "duration: 20 us")
    };
    run(&text(1.001 * least, 1.001 * aside), "run");
    let told = refusal(&text(0.999 * least, 1.001 * aside), "run");
    assert!(
        told.contains("radius of curvature of this cam falls to"),
        "{told}"
    );
    let told = refusal(&text(1.001 * least, 0.999 * aside), "run");
    assert!(told.contains("the largest slope of the lift"), "{told}");
    // straight lines between points: each point of the flanks is an edge, or a hollow that no flat face touches
    let points = "fn profile(angle: Angle) -> Length = 9 mm*max(1 - abs(angle)/(65 deg), 0)";
    let corner = text(200.0, 18.0)
        .replace("        model Train", &format!("{points}\n model Train"))
        .replace("polynomial_lift(lift: 9 mm, half: 65 deg)", "profile");
    let told = refusal(&corner, "run");
    assert!(
        told.contains("radius of curvature of this cam falls to"),
        "{told}"
    );
    // a table that ends at the base circle, and is read around the cam
    let ends =
        "table profile(a: Angle) -> Length = points([-65, -30, 0, 30, 65] deg, [0, 5, 9, 5, 0] mm)";
    let told = refusal(&corner.replace(points, ends), "run");
    assert!(
        told.contains("table profile is read before its first point")
            && told.contains("`periodic:`"),
        "{told}"
    );
}

/// The path of the axis has the curvature `(R - R'')/R²` at the nose, where R' is zero: the largest roller has its inverse as radius.
#[test]
fn a_roller_that_would_cut_away_the_nose_is_refused() {
    let half = 65.0_f64.to_radians();
    let radius = 39.0;
    let most = radius * radius / (radius + 72.0 / half / half);
    let text = |roller: f64| {
        ROLLER
            .replace(
                "use std.valvetrain.RollerCam",
                "use std.valvetrain.{RollerCam, polynomial_lift}",
            )
            .replace(
                "profile: rise",
                "profile: polynomial_lift(lift: 9 mm, half: 65 deg)",
            )
            .replace(
                "base: 27 mm, roller_radius: 12 mm",
                &format!("base: 30 mm, roller_radius: {roller} mm"),
            )
            .replace("duration: 250 ms", "duration: 20 us")
            .replace("sample: 1 ms", "sample: 10 us")
    };
    run(&text(0.999 * most), "run");
    let told = refusal(&text(1.001 * most), "run");
    assert!(told.contains("it would cut away the nose"), "{told}");
    let told = refusal(&text(30.1), "run");
    assert!(
        told.contains("the radii of base circle and roller together"),
        "{told}"
    );
}
