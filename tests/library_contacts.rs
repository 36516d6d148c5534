//! Contacts and friction of `std.contacts` against closed forms, quadrature and another integrator.

use crate::library_run::{close, column, integral, integrate, largest, last, refusal, run};

/// A ball that flies at a plate with a speed; `law` is the contact.
fn thrown(law: &str, speed: &str, duration: &str, sample: &str) -> String {
    format!(
        "use std.contacts.*
        use std.materials.Steel
        model Throw {{
            gravity = [0, 0, 0] m/s^2
            marker plate = [0, 0, 0] mm
            body ball {{ mass = 0.1 kg; inertia = [4, 4, 4] mg*m^2; start position = [0, 0, 10.01] mm; start velocity = [0, 0, -1]*{speed} }}
            force contact = {law}
            output speed = dot(ball.origin.velocity, ground.z) as m/s
        }}
        analysis run = transient(Throw(), duration: {duration}, sample: {sample})"
    )
}

/// The time from the first to the last touch, by linear interpolation of the gap.
fn touch_time(time: &[f64], gap: &[f64]) -> f64 {
    let crossings: Vec<f64> = time
        .windows(2)
        .zip(gap.windows(2))
        .filter(|(_, g)| (g[0] > 0.0) != (g[1] > 0.0))
        .map(|(t, g)| t[0] + (t[1] - t[0]) * g[0] / (g[0] - g[1]))
        .collect();
    assert_eq!(crossings.len(), 2, "{crossings:?}");
    crossings[1] - crossings[0]
}

#[test]
fn a_ball_leaves_with_the_restitution_that_its_loss_states() {
    for restitution in [0.1, 0.2, 0.5, 0.9, 0.99] {
        let law = format!(
            "HuntCrossley(ball.origin, plate, reach: 10 mm, reference_load: 60 N, reference_depth: 10 um,
                loss: restitution_loss({restitution}, 2 m/s))"
        );
        let results = run(&thrown(&law, "2 m/s", "3 ms", "5 us"), "run");
        close(
            "restitution",
            last(&results, "speed"),
            2.0 * restitution,
            1e-4,
        );
        let heat = integral(
            column(&results, "time"),
            column(&results, "contact.power_loss"),
        );
        close("heat", heat, 0.2 * (1.0 - restitution * restitution), 2e-3);
    }
    // another exponent has the same loss
    let law = "HuntCrossley(ball.origin, plate, reach: 10 mm, reference_load: 60 N, reference_depth: 10 um, exponent: 1,
        loss: restitution_loss(0.6, 2 m/s))";
    let results = run(&thrown(law, "2 m/s", "3 ms", "5 us"), "run");
    close("exponent 1", last(&results, "speed"), 1.2, 1e-4);
}

/// Largest depth `(5 m v²/(4 k))^(2/5)` and time 2.9432 depth/v of Hertz's impact.
#[test]
fn elastic_balls_touch_as_long_as_hertz_says() {
    let modulus = 210e9 / (2.0 * (1.0 - 0.09));
    let impact = |radius: f64, mass: f64, speed: f64| {
        let stiffness = 4.0 / 3.0 * modulus * radius.sqrt();
        (1.25 * mass * speed * speed / stiffness).powf(0.4)
    };
    let law = "SphereOnPlane(ball.origin, plate, reach: 10 mm, ball: Steel, plate: Steel)";
    let results = run(&thrown(law, "0.2 m/s", "0.4 ms", "0.2 us"), "run");
    let gap = column(&results, "contact.gap");
    let depth = impact(0.01, 0.1, 0.2);
    close(
        "depth",
        -gap.iter().fold(f64::MAX, |m, x| m.min(*x)),
        depth,
        1e-4,
    );
    close(
        "time",
        touch_time(column(&results, "time"), gap),
        2.943_2 * depth / 0.2,
        1e-4,
    );
    close("speed", last(&results, "speed"), 0.2, 1e-4);
    let two = "use std.contacts.SphereOnSphere
        use std.materials.Steel
        model Two {
            gravity = [0, 0, 0] m/s^2
            body ball[i in 1..2] {
                mass = 0.1 kg; inertia = [4, 4, 4] mg*m^2
                start position = [0, 0, [0, 20.01][i]] mm; start velocity = [0, 0, [0, -0.2][i]] m/s
            }
            force contact = SphereOnSphere(ball[1].origin, ball[2].origin, radius_a: 10 mm, radius_b: 10 mm, ball_a: Steel, ball_b: Steel)
            output speed[i in 1..2] = dot(ball[i].origin.velocity, ground.z) as m/s
        }
        analysis run = transient(Two(), duration: 0.4 ms, sample: 0.2 us)";
    let results = run(two, "run");
    let depth = impact(0.005, 0.05, 0.2);
    let found = touch_time(column(&results, "time"), column(&results, "contact.gap"));
    close("two balls", found, 2.943_2 * depth / 0.2, 1e-4);
    close("first ball", last(&results, "speed[1]"), -0.2, 1e-4);
    assert!(last(&results, "speed[2]").abs() < 2e-5);
}

#[test]
fn a_stop_is_a_spring_and_its_heat_is_the_energy_lost() {
    let law = "EndStop(ball.origin, plate, reach: 10 mm, stiffness: 10 kN/mm)";
    let results = run(&thrown(law, "0.2 m/s", "0.5 ms", "0.2 us"), "run");
    let (time, gap) = (column(&results, "time"), column(&results, "contact.gap"));
    close(
        "depth",
        -gap.iter().fold(f64::MAX, |m, x| m.min(*x)),
        0.2 * 1e-4,
        1e-4,
    );
    close(
        "time",
        touch_time(time, gap),
        std::f64::consts::PI * 1e-4,
        1e-4,
    );
    let law = "EndStop(ball.origin, plate, reach: 10 mm, stiffness: 10 kN/mm, damping: 300 N*s/m)";
    let results = run(&thrown(law, "0.2 m/s", "0.5 ms", "0.2 us"), "run");
    let rebound = last(&results, "speed");
    let law = |_: f64, y: &[f64; 2]| {
        let depth = (-y[0]).max(0.0);
        let stiffness = (1e7 - 300.0 * y[1] / (depth * depth + 1e-10).sqrt()).max(0.0);
        [y[1], depth * stiffness / 0.1]
    };
    let due = integrate(&law, [0.0, -0.2], 0.0, 1e-8, 45_000)[1];
    close("rebound", rebound, due, 2e-4);
    let heat = integral(
        column(&results, "time"),
        column(&results, "contact.power_loss"),
    );
    close("heat", heat, 0.05 * (0.04 - rebound * rebound), 1e-4);
}

/// A slug of 1 kg flies 10 mm between two stops at 1 m/s: each bounce takes half a period of the mass on the stiffness. With damping its
/// loss of energy is the heat.
#[test]
fn a_slug_bounces_between_two_stops() {
    let text = |damping: f64, run: &str| {
        format!(
            "use std.contacts.WayStops
            use std.joints.Translational
            model Between {{
                gravity = [0, 0, 0] m/s^2
                marker middle = [0, 0, 0] mm
                body slug {{ mass = 1 kg; inertia = [1, 1, 1] g*m^2; marker eye = origin }}
                joint guide = Translational(slug.eye, middle)
                force stops = WayStops(slug.eye, middle, way: 5 mm, stiffness: 1 kN/mm, damping: {damping} N*s/m)
                start guide.travel = 0 mm
                start guide.speed = 1 m/s
            }}
            analysis run = transient(Between(), {run})"
        )
    };
    // two turns to and fro, and 2 ms
    let time = 1e3 * (2.0 * (0.02 + 2.0 * std::f64::consts::PI * 1e-3) + 2e-3);
    let results = run(
        &text(0.0, &format!("duration: {time} ms, sample: 20 us")),
        "run",
    );
    let travel = column(&results, "guide.travel");
    close("reached", largest(travel), 6e-3, 1e-4);
    close("place", last(&results, "guide.travel"), 2e-3, 3e-4);
    close(
        "energy",
        largest(column(&results, "stops.stored_energy")),
        0.5,
        2e-4,
    );
    let results = run(&text(200.0, "duration: 60 ms, sample: 10 us"), "run");
    let heat = integral(
        column(&results, "time"),
        column(&results, "stops.power_loss"),
    );
    let speed = last(&results, "guide.speed");
    close("heat", heat, 0.5 * (1.0 - speed * speed), 1e-3);
}

/// The load of a pin in its bush is the integral of the pressure over the arc of contact.
#[test]
fn a_pin_in_a_bush_is_carried_by_the_pressure_of_its_layer() {
    let text = "use std.contacts.{PinInBush, layer_stiffness}
        use std.materials.Aluminium
        use std.joints.ParallelAxes
        model Bush {
            param weight: Mass = 100 kg
            gravity = [0, -10, 0] m/s^2
            marker shell = [0, 0, 0] mm
            body pin { mass = weight; inertia = [1, 1, 1] kg*m^2; marker axis = origin; start position = [0, -20, 0] um }
            joint upright = ParallelAxes(pin.axis, shell)
            force bush = PinInBush(pin.axis, shell, diameter: 20 mm, width: 15 mm, clearance: 30 um, layer: layer_stiffness(Aluminium, 2 mm))
            output place = dot(pin.axis.origin, ground.y) as um
            param layer: Pressure/Length = layer_stiffness(Aluminium, 2 mm)
        }
        analysis light = static(Bush(weight: 1 kg))
        analysis heavy = static(Bush(weight: 3000 kg))";
    let layer = 70e9 * 0.7 / (1.3 * 0.4 * 2e-3);
    for (analysis, weight) in [("light", 10.0), ("heavy", 30_000.0)] {
        let results = run(text, analysis);
        let e = -last(&results, "place");
        let half = (30e-6 / e).acos();
        const N: usize = 20_000;
        let pressure = |k: usize| {
            let angle = half * (k as f64 + 0.5) / N as f64;
            layer * (e * angle.cos() - 30e-6) * angle.cos()
        };
        let sum: f64 = (0..N).map(pressure).sum();
        let load = 2.0 * sum * half / N as f64 * 0.01 * 0.015;
        close(analysis, load, weight, 1e-6);
        close(
            "pressure",
            last(&results, "bush.maximum_pressure"),
            layer * (e - 30e-6),
            1e-6,
        );
    }
}

/// A block of 1 kg under 10 N: the law of the sliding speed, and a spring that pulls it at 1 mm/s.
fn block(law: &str, start: &str) -> String {
    format!(
        "use std.contacts.*
        use std.joints.Translational
        force Pull(a: Marker, b: Marker, stiffness: Stiffness, speed: Velocity) {{
            let pull = stiffness*(speed*time - dot(a.origin - b.origin, b.z))
            apply force pull*b.z on a against b
        }}
        model Block {{
            param pull: Stiffness = 0 N/m
            gravity = [0, 0, 0] m/s^2
            marker rail = [0, 0, 0] mm
            body block {{ mass = 1 kg; inertia = [1, 1, 1] g*m^2; start velocity = [0, 0, {start}] m/s }}
            joint guide = Translational(block.origin, rail)
            force rub = {law}
            force spring = Pull(block.origin, rail, stiffness: pull, speed: 1 mm/s)
        }}
        analysis slide = transient(Block(), duration: 0.3 s, sample: 1 ms)
        analysis pulled = transient(Block(pull: 1 N/mm), duration: 10 s, sample: 10 ms)
        analysis exact = transient(Block(pull: 1 N/mm), duration: 10 s, sample: 10 ms, tolerance: 0.01)"
    )
}

const SHARED: &str = "block.origin, rail, normal_load: 10 N, static_friction: 0.3, kinetic_friction: 0.12, stribeck_speed: 1 mm/s";

#[test]
fn a_block_slows_down_by_its_kinetic_friction() {
    let text = block(&format!("Friction({SHARED}, creep: 0.1 mm/s)"), "0.5");
    let results = run(&text, "slide");
    close(
        "speed",
        last(&results, "guide.speed"),
        0.5 - 1.2 * 0.3,
        1e-7,
    );
    let heat = integral(column(&results, "time"), column(&results, "rub.power_loss"));
    close("heat", heat, 0.5 * (0.25 - 0.14 * 0.14), 1e-6);
}

/// Stick-slip of a block on bristles, against another integrator; the largest pull is the static friction.
/// The moment of a break-away depends exponentially on the creep before it, so errors of the bristles' deflection add up to slips
/// that come early or late.
#[test]
fn bristles_stick_and_slip_as_another_integrator_says() {
    let text = block(
        &format!(
            "LuGre({SHARED}, bristle_stiffness: 100 N/mm, bristle_damping: 300 N*s/m, viscous: 0.4 N*s/m)"
        ),
        "0",
    );
    let law = |t: f64, y: &[f64; 3]| {
        let [place, speed, bristle] = *y;
        let limit = 10.0 * (0.12 + 0.18 * (-(speed / 1e-3) * (speed / 1e-3)).exp());
        let rate = speed - 1e5 * speed.abs() * bristle / limit;
        let friction = 1e5 * bristle + 300.0 * rate + 0.4 * speed;
        [speed, 1e3 * (1e-3 * t - place) - friction, rate]
    };
    let (mut y, mut due) = ([0.0; 3], Vec::new());
    for k in 0..=1000 {
        due.push(y[0]);
        y = integrate(&law, y, f64::from(k) * 0.01, 1e-5, 1000);
    }
    for (analysis, limit) in [("pulled", 2e-3), ("exact", 2e-4)] {
        let results = run(&text, analysis);
        let travel = column(&results, "guide.travel");
        assert_eq!(travel.len(), due.len());
        let off = travel.iter().zip(&due).map(|(x, y)| (x - y).abs());
        let off = off.fold(0.0, f64::max) / largest(travel);
        println!("stick-slip, {analysis}: {off:.1e} of the travel");
        assert!(off < limit, "{analysis}: {off}");
    }
    let results = run(&text, "exact");
    let load = largest(
        &column(&results, "rub.load")
            .iter()
            .map(|x| -x)
            .collect::<Vec<_>>(),
    );
    // the creep before it makes the friction fall below its static limit of 3 N
    assert!(load > 2.7 && load <= 3.0, "{load}");
}

/// A steel roller at rest under its load, and its largest depth in an elastic impact: `m v^2/2 = 9/19 F depth` with Palmgren's load.
#[test]
fn a_roller_is_pressed_as_palmgren_says() {
    let load = |depth: f64| (1e3 * depth / 3.84e-5 * 12.0_f64.powf(0.8)).powf(10.0 / 9.0);
    let law = "CylinderOnPlane(ball.origin, plate, reach: 10 mm, length: 12 mm)";
    let text =
        thrown(law, "0 m/s", "1 ms", "1 us").replace("[0, 0, 0] m/s^2", "[0, 0, -9810] m/s^2");
    let text = text.replace(
        "analysis run = transient(Throw(), duration: 1 ms, sample: 1 us)",
        "analysis run = static(Throw())",
    );
    close(
        "rest",
        load(-last(&run(&text, "run"), "contact.gap")),
        981.0,
        1e-6,
    );
    let results = run(&thrown(law, "2 m/s", "1 ms", "0.2 us"), "run");
    let depth = -column(&results, "contact.gap")
        .iter()
        .copied()
        .fold(f64::MAX, f64::min);
    close("impact", 9.0 / 19.0 * load(depth) * depth, 0.2, 1e-3);
    close("speed", last(&results, "speed"), 2.0, 1e-4);
}

/// A contact that begins deep has a warning: the marker of its plane is most often where the body begins. A touch has none.
#[test]
fn a_contact_that_begins_deep_has_a_warning() {
    // `ground` itself begins where the ball is
    for (b, due) in [("ground", true), ("inner", true), ("plate", false)] {
        for (law, name) in [
            (
                "HuntCrossley(ball.origin, {b}, reach: 7 mm, reference_load: 60 N, reference_depth: 10 um)",
                "inside",
            ),
            (
                "EndStop(ball.origin, {b}, reach: 7 mm, stiffness: 1 kN/mm)",
                "inside",
            ),
            (
                "CylinderOnPlane(ball.origin, {b}, reach: 7 mm, length: 10 mm)",
                "inside",
            ),
            (
                "SphereOnSphere(ball.origin, {b}, radius_a: 4 mm, radius_b: 3 mm, ball_a: Steel, ball_b: Steel)",
                "deep",
            ),
        ] {
            let law = law.replace("{b}", b);
            let text = format!(
                "use std.contacts.*
                use std.materials.Steel
                model Drop {{
                    marker plate = [0, 0, -6.9] mm
                    marker inner = [0, 0, -4] mm
                    body ball {{ mass = 0.1 kg; inertia = [4, 4, 4] mg*m^2; start position = [0, 0, 0] mm }}
                    force contact = {law}
                }}
                analysis run = transient(Drop(), duration: 0.1 us, sample: 0.1 us)"
            );
            let program =
                eng::check(&eng::Sources::from_text("m.eng", &text), "m.eng").into_program();
            let outcome = program.unwrap().analysis("run").unwrap().run(&mut |_| {});
            let warnings = outcome
                .unwrap_or_else(|failed| panic!("{}", failed.error))
                .warnings;
            let found = warnings.iter().any(|warning| warning.name == name);
            assert_eq!(found, due, "{law}: {warnings:?}");
        }
    }
}

#[test]
fn wrong_numbers_are_refused() {
    for (law, says) in [
        (
            "EndStop(ball.origin, plate, stiffness: -1 N/mm)",
            "must be positive",
        ),
        (
            "SphereOnPlane(ball.origin, plate, ball: Steel, plate: Steel)",
            "the radius of the ball is `reach`",
        ),
        (
            "HuntCrossley(ball.origin, plate, reference_load: 1 N, reference_depth: 1 um, exponent: 0.5)",
            "infinite at the first touch",
        ),
        (
            "HuntCrossley(ball.origin, plate, reference_load: 1 N, reference_depth: 1 um, loss: restitution_loss(1.2, 1 m/s))",
            "a restitution of 1.2",
        ),
    ] {
        let message = refusal(&thrown(law, "1 m/s", "1 ms", "0.1 ms"), "run");
        assert!(message.contains(says), "{message}");
    }
}
