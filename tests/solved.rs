//! `solve`: values and derivatives against closed forms, and a constraint against the same mechanism without `solve`.

use crate::support::{column, program};
use eng::results::Results;

fn run(text: &str, analysis: &str) -> Result<Results, String> {
    let analysis = program(text)
        .analysis(analysis)
        .unwrap_or_else(|error| panic!("{error}"));
    let outcome = analysis.run(&mut |_| {});
    outcome
        .map(|outcome| outcome.results)
        .map_err(|failed| failed.error.to_string())
}

/// Kepler's equation E − e sin E = M at a mean anomaly M that grows evenly: E' = n/(1 − e cos E) and
/// E'' = −e sin E E'²/(1 − e cos E). Two circles x² + y² = R², (x − d)² + y² = r² cross at x = (d² + R² −
/// r²)/(2 d). A body has the mass of a zero of parameters alone.
#[test]
fn values_and_rates_are_those_of_closed_forms() {
    let text = "use std.joints.Revolute
        fn kepler(anomaly: Angle, mean: Angle) -> Angle = anomaly - 0.6 rad*sin(anomaly) - mean
        fn circles(at: Length[2], apart: Length) -> Area[2] =
            [at.x^2 + at.y^2 - (50 mm)^2, (at.x - apart)^2 + at.y^2 - (40 mm)^2]
        fn cube(mass: Mass, wanted: Mass^3) -> Mass^3 = mass^3 - wanted
        model Orbit {
            param wanted: Mass^3 = 27 kg^3
            gravity = [0, 0, 0] m/s^2
            marker axis = [0, 0, 0] mm
            body wheel { mass = solve(cube(wanted: wanted), 2 kg); inertia = [1, 1, 1] kg*m^2; marker hub = origin }
            joint hinge = Revolute(wheel.hub, axis)
            start der(hinge.angle) = 2 rad/s
            let mean = rotation(wheel.hub, axis)
            let anomaly = solve(kepler(mean: mean), mean)
            let rate = der(anomaly)
            output mean_anomaly: Angle = mean
            output eccentric: Angle = anomaly
            output first: AngularVelocity = rate
            output second = der(rate)
            let apart = 60 mm + 5 mm*sin(mean)
            let crossing = solve(circles(apart: apart), [45 mm, 30 mm])
            output place = [crossing[1], crossing[2], apart]
            output moved = [der(crossing[1]), der(crossing[2])]
            output mass = wheel.mass
        }
        analysis orbit = transient(Orbit(), duration: 3 s, sample: 0.05 s)";
    let results = run(text, "orbit").unwrap_or_else(|error| panic!("{error}"));
    let of = |path: &str| column(&results, path);
    assert!((of("mass")[0] - 3.0).abs() < 1e-12, "{}", of("mass")[0]);
    assert!(of("mean_anomaly").len() == 61 && of("mean_anomaly")[60] > 5.9);
    for k in 0..61 {
        let (mean, e) = (of("mean_anomaly")[k], of("eccentric")[k]);
        assert!((e - 0.6 * e.sin() - mean).abs() < 1e-13, "{mean}: {e}");
        let rate = 2.0 / (1.0 - 0.6 * e.cos());
        let second = -0.6 * e.sin() * rate * rate / (1.0 - 0.6 * e.cos());
        assert!((of("first")[k] / rate - 1.0).abs() < 1e-9, "{mean}: {rate}");
        assert!(
            (of("second")[k] - second).abs() < 1e-8 * (1.0 + second.abs()),
            "{mean}: {second}"
        );
        let d = of("place.z")[k];
        let x = (d * d + 0.05 * 0.05 - 0.04 * 0.04) / (2.0 * d);
        let y = (0.05 * 0.05 - x * x).sqrt();
        assert!((of("place.x")[k] - x).abs() < 1e-14 && (of("place.y")[k] - y).abs() < 1e-14);
        let closing = 0.005 * mean.cos() * 2.0;
        let along = closing * (1.0 - (0.05_f64.powi(2) - 0.04_f64.powi(2)) / (d * d)) / 2.0;
        assert!((of("moved.x")[k] - along).abs() < 1e-12, "{along}");
        assert!((of("moved.y")[k] + x * along / y).abs() < 1e-12);
    }
}

/// A roller on an eccentric disc, with the contact point from `solve`, moves as one on a rod between both
/// centres: the two are one mechanism. This needs value, rate, second rate and the derivatives of the
/// constraint.
#[test]
fn a_roller_on_a_curve_moves_as_on_a_rod() {
    let text = "use std.joints.{Revolute, Translational, Distance}
        use std.forces.LinearSpring
        /// A roller on the curve of a cam, a circle beside the axis.
        joint OnCurve(roller: Marker, cam: Marker, radius: Length, disc: Length, beside: Length) {
            let seen = local(roller.origin - cam.origin, cam)
            let p = [seen.x, seen.y]
            fn curve(angle: Angle) -> Length[2] = [beside + disc*cos(angle), disc*sin(angle)]
            fn along(angle: Angle) -> Area = dot(p - curve(angle), [-disc*sin(angle), disc*cos(angle)])
            let angle = solve(along, atan2(p.y, p.x))
            constrain norm(p - curve(angle)) == radius
            output contact = angle as deg
        }
        model Cam {
            const rod: Bool = false
            gravity = [0, -9.81, 0] m/s^2
            marker axis = [0, 0, 0] mm
            marker guide = at([0, 0, 0] mm, z: [0, 1, 0])
            marker top = [0, 150, 0] mm
            body cam {
                mass = 2 kg; inertia = [2, 2, 3] g*m^2
                marker hub = origin
                marker centre = [8, 0, 0] mm
            }
            body roller { mass = 0.3 kg; inertia = [1, 1, 1] g*m^2; marker axle = at(origin, z: [0, 1, 0]); guess position = [0, 40, 0] mm }
            joint hinge = Revolute(cam.hub, axis)
            joint slide = Translational(roller.axle, guide) { branch travel > 0 mm }
            joint contact if not rod = OnCurve(roller.axle, cam.hub, radius: 10 mm, disc: 30 mm, beside: 8 mm)
            joint link if rod = Distance(roller.origin, cam.centre, length: 40 mm)
            force spring = LinearSpring(roller.axle, top, stiffness: 5 N/mm, damping: 3 N*s/m, free_length: 160 mm)
            start hinge.angle = 20 deg
            start der(hinge.angle) = 60 rad/s
            output height = slide.travel
            output turned = hinge.angle
            output push = slide.force in axis
            output acceleration = dot(roller.axle.acceleration, axis.y)
        }
        analysis curve = transient(Cam(), duration: 0.2 s, sample: 1 ms, step: 50 us)
        analysis rod = transient(Cam(rod: true), duration: 0.2 s, sample: 1 ms, step: 50 us)";
    let [curve, rod] =
        ["curve", "rod"].map(|a| run(text, a).unwrap_or_else(|error| panic!("{error}")));
    for path in ["height", "turned", "push.x", "acceleration"] {
        let (a, b) = (column(&curve, path), column(&rod, path));
        let swing = b.iter().fold(0.0_f64, |w, x| w.max((x - b[0]).abs()));
        let off = a
            .iter()
            .zip(b)
            .fold(0.0_f64, |w, (x, y)| w.max((x - y).abs()));
        assert!(
            a.len() == 201 && swing > 0.0 && off < 1e-9 * swing,
            "{path}: {off} of {swing}"
        );
    }
}

/// Without a zero near the estimate the run stops, and names the function, its last value and the time.
#[test]
fn a_missing_zero_stops_the_run() {
    let text = "use std.joints.Revolute
        fn above(x: Length, lifted: Length) -> Area = x^2 + lifted^2
        force Push(a: Marker, b: Marker) {
            let turned = rotation(a, b)
            let x = solve(above(lifted: 20 mm*turned/(1 rad)), 10 mm)
            apply torque 1 N*x*b.z on a against b
        }
        model Lost {
            gravity = [0, 0, 0] m/s^2
            marker axis = [0, 0, 0] mm
            body wheel { mass = 1 kg; inertia = [1, 1, 1] kg*m^2; marker hub = origin }
            joint hinge = Revolute(wheel.hub, axis)
            force push = Push(wheel.hub, axis)
            start hinge.angle = 1 rad
        }
        analysis lost = transient(Lost(), duration: 0.1 s, sample: 1 ms, start: assembled)";
    let error = match run(text, "lost") {
        Ok(_) => panic!("it ran"),
        Err(error) => error,
    };
    assert!(
        error.contains("finds no zero of `above(lifted: 20 mm*turned/(1 rad))`"),
        "{error}"
    );
    let missed = error
        .lines()
        .find(|line| line.contains("the condition fails by"));
    assert!(missed.is_some_and(|line| line.ends_with(" mm")), "{error}");
}

/// Equations that depend on each other do not determine the unknowns, even where they have zeros.
#[test]
fn equations_that_depend_on_each_other_stop_the_run() {
    let alone = "fn f(v: 1[2], t: 1) -> 1[2] = [v[1] + v[2] - t, 2*v[1] + 2*v[2] - 2*t]";
    let all =
        "fn f(v: 1[3], t: 1) -> 1[3] = [v[1] + v[2] + v[3] - t, v[1] - v[2], 2*v[1] + v[3] - t]";
    let rounding =
        "fn f(v: 1[2], t: 1) -> 1[2] = [0.1*v[1] + 0.2*v[2] - t, 0.3*v[1] + 0.6*v[2] - 3*t]";
    for (function, estimate, fails) in [
        (alone, "[0, 0]", true),
        (all, "[0, 0, 0]", true),
        (rounding, "[0, 0]", true),
        (
            "fn f(v: 1[2], t: 1) -> 1[2] = [v[1] + v[2] - t, v[1] + 1.0001*v[2] - t]",
            "[0, 0]",
            false,
        ),
    ] {
        let text = format!(
            "use std.joints.Revolute
        {function}
        force Push(a: Marker, b: Marker) {{
            let turned = rotation(a, b)/(1 rad)
            let v = solve(f(t: turned), {estimate})
            apply torque 1 N*m*v[1]*b.z on a against b
        }}
        model Bench {{
            gravity = [0, 0, 0] m/s^2
            marker axis = [0, 0, 0] mm
            body wheel {{ mass = 1 kg; inertia = [1, 1, 1] kg*m^2; marker hub = origin }}
            joint hinge = Revolute(wheel.hub, axis)
            force push = Push(wheel.hub, axis)
            start hinge.angle = 1 rad
        }}
        analysis run = transient(Bench(), duration: 10 ms, sample: 1 ms, start: assembled)"
        );
        match run(&text, "run") {
            Ok(_) => assert!(!fails, "{function} ran"),
            Err(error) => {
                let told = ["finds no zero of `f(t: turned)`", "push is not finite"];
                assert!(fails && told.iter().any(|t| error.contains(t)), "{error}");
            }
        }
    }
}
