//! Motions that constraints demand, with corners: where the demanded acceleration jumps, the motion starts
//! again; where the demanded velocity or position jumps, the run is refused by name. All motions are compared
//! with closed forms.

use crate::support::{program, refused};
use eng::Outcome;

const SAMPLES: [&str; 5] = ["0.3 ms", "2 ms", "7 ms", "50 ms", "0.2 s"];

/// A block of 2 kg on a rail, held along `way` of the time. It draws a block of 1 kg on a spring of 1 kN/m.
fn drawn(way: &str, more: &str, settings: &str) -> String {
    format!(
        "
        use std.joints.Translational
        {more}
        drive Along(a: Marker, b: Marker) {{
            constrain dot(a.origin - b.origin, b.z) == {way}
        }}
        force Spring(a: Marker, b: Marker, rail: Marker) {{
            apply force (-1 kN/m*dot(a.origin - b.origin, rail.z))*rail.z on a against b
        }}
        model Drawn {{
            gravity = [0, 0, 0] m/s^2
            marker rail = [0, 0, 0] mm
            body block {{ mass = 2 kg; inertia = [1, 1, 1] g*m^2 }}
            body free {{ mass = 1 kg; inertia = [1, 1, 1] g*m^2 }}
            joint guide = Translational(block.origin, rail)
            joint slide = Translational(free.origin, rail)
            drive along = Along(block.origin, rail)
            force spring = Spring(free.origin, block.origin, rail)
        }}
        analysis run = transient(Drawn(), {settings})"
    )
}

fn ran(text: &str) -> Outcome {
    let program = program(text);
    let analysis = program.analysis("run").expect("an analysis");
    let outcome = analysis.run(&mut |_| {});
    outcome.unwrap_or_else(|failed| panic!("{}\n{text}", failed.error))
}

fn column<'a>(outcome: &'a Outcome, path: &str) -> &'a [f64] {
    &outcome.results.column(path).expect("a column").values
}

/// The demanded acceleration jumps at 0.1 s from `before` to 20 m/s². The drive's force is that of both
/// blocks, the free one swings about the way that lags by a/ω², and the works close the energy.
#[test]
fn a_demanded_acceleration_may_jump() {
    let pace = 1000.0_f64.sqrt();
    let table = "table stroke(t: Time) -> Length = points([0, 0.05, 0.1] s, [0, 0, 0] mm, extrapolation: linear)
        fn late(t: Time) -> Time = max(t - 100 ms, 0 s)";
    for (way, before) in [
        ("10 m/s^2*max(0 s, time - 0.1 s)^2", 0.0),
        (
            "(if time > 0.1 s then 10 m/s^2*(time - 0.1 s)^2 else 0 mm)",
            0.0,
        ),
        (
            "(if time >= 100 ms then 10 m/s^2*late(time)*late(time) else stroke(time))",
            0.0,
        ),
        ("10 m/s^2*(time - 0.1 s)*abs(time - 0.1 s)", -20.0),
        ("(1 m/s*time + 10 m/s^2*max(0 s, time - 0.1 s)^2)", 0.0),
    ] {
        for sample in SAMPLES {
            let settings = format!("duration: 0.2 s, sample: {sample}");
            let outcome = ran(&drawn(way, table, &settings));
            let [time, force, at, energy, work] = [
                "time",
                "along.force.z",
                "slide.travel",
                "energy.imbalance",
                "energy.work_of_drives",
            ]
            .map(|path| column(&outcome, path));
            let steady = if way.starts_with("(1 m/s") { 1.0 } else { 0.0 };
            let speed = if before == 0.0 { steady } else { 2.0 };
            // x − s is a swing about −a/ω², from the start of each part
            let swing = |a: f64, [gap, rate]: [f64; 2], t: f64| {
                let (sine, cosine) = (pace * t).sin_cos();
                let mean = -a / (pace * pace);
                [
                    mean + (gap - mean) * cosine + rate / pace * sine,
                    rate * cosine - (gap - mean) * pace * sine,
                ]
            };
            // the free block begins at rest
            let at_start = [if before == 0.0 { 0.0 } else { 0.1 }, -speed];
            let (mut worst, mut missed) = (0.0_f64, 0.0_f64);
            for (k, t) in time.iter().enumerate() {
                let late = (t - 0.1).max(0.0);
                let (a, gap) = match late > 0.0 {
                    true => (20.0, swing(20.0, swing(before, at_start, 0.1), late)[0]),
                    false => (before, swing(before, at_start, *t)[0]),
                };
                let way = match before == 0.0 {
                    true => steady * t + 10.0 * late * late,
                    false => 10.0 * (t - 0.1) * (t - 0.1).abs(),
                };
                worst = worst.max((at[k] - way - gap).abs());
                if (t - 0.1).abs() > 1e-6 {
                    missed = missed.max((force[k] - 2.0 * a + 1000.0 * gap).abs());
                }
            }
            let turned = work.iter().fold(0.0_f64, |most, w| most.max(w.abs()));
            let open = energy.iter().fold(0.0_f64, |most, e| most.max(e.abs())) / turned;
            println!("{way} at {sample}: {worst:.1e} m, {missed:.1e} N, energy {open:.1e}");
            assert!(worst < 2e-6, "{way} at {sample}: {worst:.1e} m");
            assert!(missed < 4e-3, "{way} at {sample}: {missed:.1e} N");
            assert!(open < 2e-5, "{way} at {sample}: {open:.1e} of the work");
        }
    }
}

/// Two blocks of 1 kg on rails across each other; the way of the second is a function `lift` of that of the first, `x`.
fn guided(lift: &str, more: &str, settings: &str) -> String {
    format!(
        "
        use std.joints.Translational
        {more}
        joint Guide(a: Marker, b: Marker, x_frame: Marker, z_frame: Marker) {{
            let x = dot(a.origin - x_frame.origin, x_frame.z)
            constrain dot(b.origin - z_frame.origin, z_frame.z) == {lift}
        }}
        model Guided {{
            gravity = [0, 0, 0] m/s^2
            marker across = at([0, 0, 0] mm, z: [1, 0, 0])
            marker up = origin
            body first {{ mass = 1 kg; inertia = [1, 1, 1] g*m^2; marker eye = at(origin, z: [1, 0, 0]) }}
            body second {{ mass = 1 kg; inertia = [1, 1, 1] g*m^2 }}
            joint rail = Translational(first.eye, across)
            joint slide = Translational(second.origin, up)
            joint guide = Guide(first.eye, second.origin, across, up)
            start rail.travel = 0 mm
            start rail.speed = 1 m/s
        }}
        analysis run = transient(Guided(), {settings})"
    )
}

/// A flat guide becomes a parabola at 50 mm: the demanded acceleration of the second block jumps there from 0
/// to 2 m/s² κ. Energy gives the speed, and its integral the place.
#[test]
fn a_guide_may_change_its_curvature() {
    let (curvature, corner) = (10.0_f64, 0.05);
    for lift in [
        "5 m^-1*max(x - 50 mm, 0 mm)^2",
        "(if x > 50 mm then 5 m^-1*(x - 50 mm)^2 else 0 mm)",
    ] {
        for sample in SAMPLES {
            let settings = format!("duration: 0.2 s, sample: {sample}");
            let outcome = ran(&guided(lift, "", &settings));
            let [time, x, speed] =
                ["time", "rail.travel", "rail.speed"].map(|path| column(&outcome, path));
            let (mut worst, mut missed) = (0.0_f64, 0.0_f64);
            for (k, t) in time.iter().enumerate() {
                let u = curvature * (x[k] - corner).max(0.0);
                let root = (1.0 + u * u).sqrt();
                // arc length, at a speed of 1 m/s
                let due = x[k].min(corner) + (u * root + u.asinh()) / (2.0 * curvature);
                worst = worst.max((due - t).abs());
                missed = missed.max((speed[k] * root - 1.0).abs());
            }
            println!("{lift} at {sample}: {worst:.1e} s, {missed:.1e} of the speed");
            assert!(worst < 2e-6, "{lift} at {sample}: {worst:.1e} s");
            assert!(missed < 2e-5, "{lift} at {sample}: {missed:.1e}");
        }
    }
}

/// A demanded velocity or position that jumps ends the run, with the element, the size of the jump and the
/// expression. This does not depend on the distance of samples, and fixed steps find it, too.
#[test]
fn a_demanded_velocity_must_not_jump() {
    let tables = "table ramp(t: Time) -> Length = points([0, 50, 100] ms, [0, 50, 100] mm, extrapolation: hold)
        table steep(t: Time) -> Length = points([0, 100, 200] ms, [0, 10, 100] mm, interpolation: monotone, extrapolation: hold)
        table chart(t: Time, n: 1) -> Length = points([0, 50, 100] ms, [0, 1], [[0, 0], [50, 50], [100, 100]] mm, t: hold, n: hold)
        fn stroke(t: Time) -> Length = 20 mm/(1 rad)*wrapped(t/(100 ms)*1 rad, 1.3 rad, from: -1 rad)";
    for (way, told) in [
        (
            "1 m/s*max(0 s, time - 0.1 s)",
            ["velocity", "1000 mm/s", "max(0 s, time - 0.1 s)"],
        ),
        (
            "(if time > 0.1 s then 2 m/s*(time - 0.1 s) else 0 mm)",
            ["velocity", "2000 mm/s", "time > 0.1 s"],
        ),
        (
            "500 mm/s*abs(time - 0.1 s)",
            ["velocity", "1000 mm/s", "abs(time - 0.1 s)"],
        ),
        (
            "1 m/s*min(time, 0.1 s)",
            ["velocity", "1000 mm/s", "min(time, 0.1 s)"],
        ),
        (
            "1 m/s*max(0 s, time)",
            ["velocity", "1000 mm/s", "max(0 s, time)"],
        ),
        ("ramp(time)", ["velocity", "1000 mm/s", "ramp(time)"]),
        (
            "(if time > 0.1 s then 10 mm else 0 mm)",
            ["position", "10 mm", "time > 0.1 s"],
        ),
        ("stroke(time)", ["position", "26 mm", "wrapped("]),
        (
            "chart(time, 0.5)",
            ["velocity", "1000 mm/s", "chart(time, 0.5)"],
        ),
        (
            "10 mm*curvature(steep, time)*(1 s)^2/(1 m)",
            ["position", "", "curvature(steep, time)"],
        ),
        (
            "10 mm*slope(steep, time)*(1 s)/(1 m)",
            ["velocity", "", "slope(steep, time)"],
        ),
        (
            "5 mm/(1 rad)*acos(cos(10 rad/s*time - 1 rad))",
            ["velocity", "100 mm/s", "acos("],
        ),
        (
            "5 mm/(1 rad)*asin(sin(10 rad/s*time + 90 deg - 1 rad))",
            ["velocity", "100 mm/s", "asin("],
        ),
        (
            "1 mm/(1 rad)*atan2(sin(10 rad/s*time - 181 deg), cos(10 rad/s*time - 181 deg))",
            ["position", "6.28", "atan2("],
        ),
        (
            "(if (time - 0.1 s)^3 > 0 s^3 then 1 m/s*(time - 0.1 s) else 0 mm)",
            ["velocity", "1000 mm/s", "(time - 0.1 s)^3 > 0 s^3"],
        ),
    ] {
        let settings = SAMPLES.map(|sample| format!("duration: 0.2 s, sample: {sample}"));
        let fixed = "duration: 0.2 s, sample: 10 ms, step: 0.7 ms".to_owned();
        for settings in settings.into_iter().chain([fixed]) {
            let message = refused(&program(&drawn(way, tables, &settings)), "run");
            for part in told.iter().chain(&["E0774", "along"]) {
                assert!(
                    message.contains(part),
                    "{way}, {settings}: no {part} in\n{message}"
                );
            }
        }
    }
    for (lift, told) in [
        (
            "0.5*max(x - 50 mm, 0 mm)",
            ["velocity", "500 mm/s", "max(x - 50 mm, 0 mm)"],
        ),
        (
            "0.5*abs(x - 50 mm)",
            ["velocity", "1000 mm/s", "abs(x - 50 mm)"],
        ),
        ("profile(x)", ["velocity", "200 mm/s", "profile(x)"]),
        (
            "(if x > 50 mm then 3 mm else 0 mm)",
            ["position", "3 mm", "x > 50 mm"],
        ),
    ] {
        let profile = "table profile(x: Length) -> Length = points([-950, -450, 50] mm, [0, 0.1, 0.2] m, extrapolation: hold)";
        let settings = SAMPLES.map(|sample| format!("duration: 0.2 s, sample: {sample}"));
        let fixed = "duration: 0.2 s, sample: 10 ms, step: 0.7 ms".to_owned();
        for settings in settings.into_iter().chain([fixed]) {
            let message = refused(&program(&guided(lift, profile, &settings)), "run");
            for part in told.iter().chain(&["E0774", "guide"]) {
                assert!(
                    message.contains(part),
                    "{lift}, {settings}: no {part} in\n{message}"
                );
            }
        }
    }
}

/// Corners that change no demanded velocity are none: both ends of `step`, a table with level ends, a
/// `wrapped` angle in a function that repeats with it, a corner that no step reaches, one in a branch that is
/// not selected, and one at which the motion rests.
#[test]
fn smooth_corners_are_passed() {
    let tables = "use std.math.step
        fn round(a: Angle) -> Length = 10 mm*cos(a)";
    for (way, end) in [
        ("100 mm*step((time - 0.1 s)/(50 ms))", 0.1),
        (
            "round(wrapped(time*50 rad/s, 360 deg))",
            0.01 * 10.0_f64.cos(),
        ),
        ("10 mm*max(0, time/(1 s) - 0.3)", 0.0),
        (
            "(if time > 0.5 s then 1 mm*abs(time/(0.1 s) - 1) else 3 mm)",
            0.003,
        ),
        ("10 mm*max(0, min(1 - time/(0.1 s), -0.5))", 0.0),
    ] {
        let mut energy = 1e-9_f64;
        for sample in SAMPLES {
            let outcome = ran(&drawn(
                way,
                tables,
                &format!("duration: 0.2 s, sample: {sample}"),
            ));
            let travel = column(&outcome, "guide.travel");
            let found = travel[travel.len() - 1];
            assert!((found - end).abs() < 1e-9, "{way} at {sample}: {found} m");
            let [open, work, kinetic] = [
                "energy.imbalance",
                "energy.work_of_drives",
                "energy.kinetic",
            ]
            .map(|path| column(&outcome, path));
            let size = |x: &[f64]| x.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
            // a way that rests takes no work; two samples alone may show the spring at rest
            energy = energy.max(size(work)).max(size(kinetic));
            let share = size(open) / energy;
            println!("{way} at {sample}: energy {share:.1e}");
            assert!(share < 1e-4, "{way} at {sample}: energy {share:.1e}");
        }
    }
}

/// Functions that touch zero without a slope demand no jump, whatever the distance of samples and however the
/// steps end there.
#[test]
fn functions_that_touch_zero_demand_no_jump() {
    for (way, end) in [
        ("max(0 mm, 1 mm*sin(360 deg/(4 ms)*time)^3)", 0.0),
        ("max(0 mm, 10 m/s^2*time*abs(time))", 0.4),
        (
            "max(0 mm, 1 mm*sin(360 deg/(40 ms)*time)*abs(sin(360 deg/(40 ms)*time)))",
            0.0,
        ),
    ] {
        let samples = SAMPLES.map(|sample| format!("sample: {sample}"));
        for settings in samples
            .iter()
            .map(String::as_str)
            .chain(["sample: 2 ms, step: 0.1 ms"])
        {
            let outcome = ran(&drawn(way, "", &format!("duration: 0.2 s, {settings}")));
            let travel = column(&outcome, "guide.travel");
            let found = travel[travel.len() - 1];
            assert!((found - end).abs() < 1e-9, "{way}, {settings}: {found} m");
        }
    }
}

/// A way along the points of a `monotone` table: its acceleration jumps at each point. Steps end there, at
/// any distance of samples, and a table over several periods has points in each of them.
#[test]
fn points_of_monotone_tables_end_steps() {
    let tables = "table rise(t: Time) -> Length = points([0, 20, 50, 70, 110, 130, 200] ms, [0, 1, 12, 15, 70, 78, 80] mm, interpolation: monotone)
        table round(t: Time) -> Length = points([0, 7, 18, 30, 40] ms, [0, 2, 3, 1, 0] mm, interpolation: monotone, periodic: 40 ms)";
    for (way, ends) in [("rise(time)", 5), ("round(time)", 19)] {
        // two samples alone may show the spring at rest
        let mut energy = 1e-9_f64;
        for sample in SAMPLES {
            let outcome = ran(&drawn(
                way,
                tables,
                &format!("duration: 0.2 s, sample: {sample}"),
            ));
            let [open, work, kinetic] = [
                "energy.imbalance",
                "energy.work_of_drives",
                "energy.kinetic",
            ]
            .map(|path| column(&outcome, path));
            let size = |x: &[f64]| x.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
            energy = energy.max(size(work)).max(size(kinetic));
            let share = size(open) / energy;
            let kinks = outcome.summary.expect("a summary").statistics.kinks;
            println!("{way} at {sample}: energy {share:.1e}, {kinks} shorter trials");
            assert!(share < 1e-4, "{way} at {sample}: energy {share:.1e}");
            assert!(kinks >= ends, "{way} at {sample}: {kinks} trials");
        }
    }
}

/// A start at a corner belongs to the side to which the motion goes: along `|x|` the second block rises at
/// the same speed whether the first one goes to the right or to the left.
#[test]
fn a_start_at_a_corner_goes_both_ways() {
    for (speed, lift) in [
        ("1", "0.5*abs(x)"),
        ("-1", "0.5*abs(x)"),
        ("1", "max(0.5*x, -0.5*x)"),
        ("-1", "max(0.5*x, -0.5*x)"),
        ("-1", "(if x >= 0 mm then 0.5*x else -0.5*x)"),
        ("1", "(if x > 0 mm then 0.5*x else -0.5*x)"),
    ] {
        for settings in ["sample: 20 ms", "sample: 20 ms, step: 1 ms"] {
            let text = guided(lift, "", &format!("duration: 0.1 s, {settings}"));
            let text = text.replace("rail.speed = 1 m/s", &format!("rail.speed = {speed} m/s"));
            let outcome = ran(&text);
            let worst = |path: &str, due: f64| {
                let misses = column(&outcome, path).iter().map(|x| (x.abs() - due).abs());
                misses.fold(0.0_f64, f64::max)
            };
            let (rail, slide) = (worst("rail.speed", 1.0), worst("slide.speed", 0.5));
            println!("{lift}, {speed}, {settings}: {rail:.1e} and {slide:.1e} m/s");
            assert!(rail < 1e-9, "{lift}, {speed}: {rail}");
            assert!(slide < 1e-9, "{lift}, {speed}: {slide}");
            let rises = column(&outcome, "slide.speed").iter().all(|x| *x > 0.0);
            assert!(rises, "{lift}, {speed}: it falls");
        }
    }
}

/// Where the demanded acceleration jumps at the start, the first sample has the force after it, as all others
/// have: 2 kg · 20 m/s².
#[test]
fn the_first_sample_is_behind_a_kink() {
    for way in [
        "10 m/s^2*max(0 s, time)^2",
        "(if time > 0 s then 10 m/s^2*time^2 else 0 mm)",
        "10 m/s^2*time*abs(time)",
    ] {
        let outcome = ran(&drawn(way, "", "duration: 0.02 s, sample: 1 ms"));
        let [time, force] = ["time", "along.force.z"].map(|path| column(&outcome, path));
        assert_eq!(time[0], 0.0);
        println!("{way}: {:.1e} N at the start", force[0] - 40.0);
        // the spring to the free block has no force yet
        assert!((force[0] - 40.0).abs() < 1e-6, "{way}: {} N", force[0]);
        assert!((force[1] - 40.0).abs() < 0.1, "{way}: {} N", force[1]);
    }
}

/// A run warns of a fixed step over a jump of the demanded acceleration, if the error of this step is larger
/// than the tolerance of positions. It does not warn of a step over a smooth corner, or of a step that is
/// short enough.
#[test]
fn fixed_steps_over_corners_are_told() {
    for (way, step, told) in [
        ("10 m/s^2*max(0 s, time - 0.1 s)^2", "0.7 ms", true),
        ("10 m/s^2*max(0 s, time - 0.1 s)^2", "0.1 ms", false),
        ("10 m/s^3*max(0 s, time - 0.1 s)^3", "0.7 ms", false),
        ("100 mm*sin(10 rad/s*time)", "0.7 ms", false),
    ] {
        let outcome = ran(&drawn(
            way,
            "",
            &format!("duration: 0.2 s, sample: 10 ms, step: {step}"),
        ));
        let found = outcome.summary.expect("a summary").overlooked;
        assert_eq!(found.is_some(), told, "{way}, {step}: {found:?}");
        if let Some(found) = found {
            let jump = found.jump.as_ref().expect("a jump").size.clone();
            assert!((jump.value - 20.0).abs() < 0.1, "{jump:?}");
            assert!(found.text.contains("max(0 s, time - 0.1 s)"), "{found:?}");
        }
    }
}
