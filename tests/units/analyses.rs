//! Fingerprints, motion, patience and clock of runs; cycles and their repetition.

use crate::support::{program, program_with_bar};
use eng::internals::run::{Estimate, Patience, fingerprints, in_words};
use eng::internals::{Repetition, Slowest, cycle_angle, last_cycle, reduced, shifted};
use eng::motion::{BodyMotion, moments};
use std::collections::BTreeMap;
use std::time::Duration;

const MODEL: &str = "
use std.joints.Revolute
force Fan(a: Marker, b: Marker, factor: Torque/AngularVelocity) {
    apply torque -factor*dot(a.angular_velocity - b.angular_velocity, b.z)*b.z on a against b
}
model Rig {
    param air: Torque/AngularVelocity = 2 N*m*s/rad
    gravity = [0, 0, 0] m/s^2
    marker housing = [0, 0, 0] mm
    body rotor { mass = 5 kg; inertia = [20, 20, 40] g*m^2; marker axis = origin }
    joint bearing = Revolute(rotor.axis, housing)
    force fan = Fan(rotor.axis, housing, factor: air)
    start bearing.speed = 3000 rpm
}
analysis coast = transient(Rig(), duration: 20 ms, sample: 1 ms)
analysis brief = transient(Rig(air: 3 N*m*s/rad), duration: 10 ms, sample: 1 ms)
report ends { value slowest = minimum(coast.bearing.speed) as rpm }
";

/// For both analyses of a text the fingerprint, and that without the texts.
fn of_both(text: &str) -> [(String, String); 2] {
    let program = program(text);
    ["coast", "brief"].map(|name| fingerprints(&program.analysis(name).expect("an analysis")))
}

#[test]
fn a_change_touches_the_analyses_whose_numbers_it_may_change() {
    let before = of_both(MODEL);
    assert_eq!(of_both(MODEL), before, "the same text");
    for (old, new, texts, due) in [
        // a comment moves all places
        ("\nuse std", "\n// a comment\nuse std", true, [false, false]),
        ("value slowest", "value last", false, [false, false]),
        ("param air", "param  air", true, [false, false]),
        ("20 ms", "30 ms", true, [true, false]),
        ("air: 3 N", "air: 4 N", true, [false, true]),
        ("5 kg", "6 kg", true, [true, true]),
        ("-factor*dot", "-2*factor*dot", true, [true, true]),
        ("3000 rpm", "2000 rpm", true, [true, true]),
    ] {
        let text = MODEL.replace(old, new);
        assert_ne!(text, MODEL);
        let now = of_both(&text);
        for ((before, now), due) in before.iter().zip(&now).zip(due) {
            assert_eq!(before.0 != now.0, texts, "{new}");
            assert_eq!(before.1 != now.1, due, "{new}");
        }
    }
}

/// A bar that is held at its foot and pushed at its tip; the outputs are those of the element code.
const HELD: &str = "
    force Push(a: Marker, b: Marker, x: Force) {
        apply force x*b.x on a
    }
    model Held {
        marker wall = [0, 0, 0] mm
        flexible bar {
            mesh = nastran(\"bar.bdf\", units: mm_tonne_s)
            support = foot
            modes = static(at: tip) + normal(2)
            damping = 20 %
            marker foot = patch(center: [0, 0, 0] mm, normal: z, radius: 15 mm, tie: rigid)
            marker tip = patch(center: [0, 0, 200] mm, normal: z, radius: 15 mm)
        }
        force load = Push(bar.tip, wall, x: 1000 N)
        output tip_x: Length = dot(bar.tip.origin - wall.origin, wall.x)
    }
    analysis push = transient(Held(), duration: 2 ms, sample: 4 us)";

#[test]
fn amplitudes_and_shapes_give_the_markers_motion() {
    let program = program_with_bar(HELD);
    let analysis = program.analysis("push").unwrap();
    let outcome = analysis.run(&mut |_| {}).unwrap();
    let motion = &outcome.motion;
    assert_eq!(motion.analysis(), "push.motion");
    // 500 intervals: every second, the last among them
    assert_eq!(motion.samples(), 251);
    assert_eq!(
        motion.metadata().get("motion").map(String::as_str),
        Some("the whole run, one of 2 samples")
    );
    let (times, angles) = moments(motion);
    assert!((times[250] - 2e-3).abs() < 1e-12 && angles.is_none());
    let own = BodyMotion::of(motion, "bar").unwrap();
    assert!(BodyMotion::of(motion, "rod").is_err());
    let body = reduced(&analysis.model().reductions()[0]);
    let tip = body.markers.iter().find(|m| m.name == "tip").unwrap();
    let shown = &outcome.results.column("tip_x").unwrap().values;
    let largest = shown.iter().copied().fold(0.0, f64::max);
    assert!(largest > 1e-4, "{largest}");
    for (index, amplitudes) in own.amplitudes.iter().enumerate() {
        let moved: f64 = tip
            .translation
            .iter()
            .zip(amplitudes)
            .map(|(t, a)| t * a)
            .sum();
        let expected = shown[2 * index] - tip.position[0];
        assert!(
            (moved - expected).abs() < 1e-9 * largest,
            "{moved} {expected}"
        );
        assert_eq!(own.orientations[index], [1.0, 0.0, 0.0, 0.0]);
    }
}

/// Looks every half second at a run whose done part is a function of time; the time of the stop, and the
/// remaining time.
fn stopped(done: impl Fn(f64) -> f64) -> Option<(f64, f64)> {
    let mut patience = Patience::default();
    (1..200_000).find_map(|half| {
        let passed = f64::from(half) * 0.5;
        match patience.check(Duration::from_secs_f64(passed), done(passed), 1000) {
            Estimate::Lost(left) => Some((passed, left)),
            Estimate::Soon | Estimate::Now | Estimate::Slowing(_) => None,
        }
    })
}

/// The time of the first warning about a run that slows down.
fn slowed(done: impl Fn(f64) -> f64) -> Option<f64> {
    let mut patience = Patience::default();
    (1..20_000).find_map(|half| {
        let passed = f64::from(half) * 0.5;
        let estimate = patience.check(Duration::from_secs_f64(passed), done(passed), 1000);
        matches!(estimate, Estimate::Slowing(_)).then_some(passed)
    })
}

/// The pace falls e-fold every half minute, and the end is never reached.
#[test]
fn runs_whose_steps_shrink_are_noticed() {
    let shrinking = |t: f64| 0.25 * (1.0 - libm::exp(-t / 30.0));
    assert!(slowed(shrinking).is_some_and(|passed| passed < 150.0));
    // at one pace, however long it takes; and with a phase that is slow, but no minute long
    assert_eq!(slowed(|t| t / 36_000.0), None);
    assert_eq!(
        slowed(|t| (t.min(20.0) + (t - 29.0).max(0.0)) / 300.0),
        None
    );
}

#[test]
fn hopeless_runs_are_stopped_after_two_checks() {
    let (passed, left) = stopped(|t| 1e-9 * t).unwrap();
    assert_eq!(passed, 10.0);
    assert!((left - (1e9 - 10.0)).abs() < 1.0, "{left}");
    assert_eq!(stopped(|_| 0.0), Some((10.0, f64::INFINITY)));
    // This run makes no progress after an hour. The next check may still see a part of the motion, and
    // the two checks after it see none. Each check is a fifth later than the one before, at whole half
    // seconds.
    let (passed, left) = stopped(|t| t.min(3600.0) / 7200.0).unwrap();
    let latest = 3600.0 * 1.2_f64.powi(3) + 3.0;
    assert!((3600.0..latest).contains(&passed), "{passed}");
    assert_eq!(left, f64::INFINITY);
}

/// Steps of a second whose first is a ten-millionth of the run, each 1.5 times as long as the one before: the first
/// ten say nothing about the pace.
#[test]
fn short_first_steps_are_no_pace() {
    let mut patience = Patience::default();
    let (mut done, mut step) = (0.0, 1e-7);
    for steps in 1..=60 {
        let estimate = patience.check(Duration::from_secs(steps), done, steps);
        assert!(!matches!(estimate, Estimate::Lost(_)), "{steps}");
        done += step;
        step = (1.5 * step).min(1e-3);
    }
    // without a step for minutes there is a pace: none
    let mut patience = Patience::default();
    let stopped = (1..400).find(|passed| {
        let estimate = patience.check(Duration::from_secs(*passed), 0.0, 3);
        matches!(estimate, Estimate::Lost(_))
    });
    assert_eq!(stopped, Some(144));
}

#[test]
fn runs_that_end_within_a_day_are_left_alone() {
    assert_eq!(stopped(|t| t / (20.0 * 3600.0)), None);
    // short first steps; a phase of nine seconds that is a thousand times as slow
    assert_eq!(stopped(|t| (t - 4.9).max(1e-9 * t) / 3600.0), None);
    assert_eq!(
        stopped(|t| (t.min(100.0) + (t - 109.0).max(0.0)) / 3600.0),
        None
    );
}

#[test]
fn times_in_words() {
    for (seconds, words) in [
        (900.0, "about 15 minutes"),
        (4.0 * 3600.0, "about 4 hours"),
        (3.0 * 86400.0, "about 3 days"),
        (3.2e9, "about 101 years"),
        (1e20, "about 3e12 years"),
        (f64::INFINITY, "for ever"),
    ] {
        assert_eq!(in_words(seconds), words);
    }
}

/// The sum of all readings is within the time of another clock around them: no time counts in two phases.
#[test]
#[cfg(unix)]
fn phases_do_not_overlap() {
    use eng::internals::run::clock;
    let (mut outer, mut inner) = (clock(), clock());
    let mut phases = Duration::ZERO;
    for _ in 0..3 {
        let mut sum = 0.0_f64;
        for _ in 0..1_000_000 {
            sum += std::hint::black_box(1.0);
        }
        assert!(sum > 0.0);
        phases += inner();
    }
    let whole = outer();
    assert!(phases <= whole, "{phases:?} {whole:?}");
}

/// A thread that sleeps takes no processor time, and one that computes does.
#[test]
#[cfg(unix)]
fn only_computing_counts() {
    let mut clock = eng::internals::run::clock();
    std::thread::sleep(Duration::from_millis(50));
    let asleep = clock();
    let begun = std::time::Instant::now();
    let (mut awake, mut sum) = (Duration::ZERO, 0.0_f64);
    while awake < Duration::from_millis(20) && begun.elapsed() < Duration::from_secs(60) {
        for _ in 0..1000 {
            sum += std::hint::black_box(1.0);
        }
        awake += clock();
    }
    assert!(sum > 0.0);
    assert!(asleep < Duration::from_millis(10), "{asleep:?}");
    assert!(awake >= Duration::from_millis(20), "{awake:?}");
}

#[test]
fn rounding_does_not_move_an_angle_into_the_cycle_before() {
    let period = Some(4.0);
    for (angle, due) in [(9.0, 1.0), (-1.0, 3.0), (8.0 - 1e-9, 0.0), (3.9, 3.9)] {
        assert!((cycle_angle(angle, period) - due).abs() < 1e-12, "{angle}");
    }
    assert_eq!(cycle_angle(-1e-9, None), -1e-9);
    assert_eq!(shifted(vec![8.0 - 1e-9, 9.0], period)[1], 1.0);
    assert_eq!(shifted(vec![-3.0, -4.0], period), [1.0, 0.0]);
}

#[test]
fn a_last_cycle_has_either_sense() {
    let forwards: Vec<f64> = (0..=10).map(f64::from).collect();
    let backwards: Vec<f64> = forwards.iter().map(|angle| -angle).collect();
    for angle in [&forwards, &backwards] {
        assert_eq!(last_cycle(Some(angle), Some(4.0)), Some(6));
        assert_eq!(last_cycle(Some(angle), Some(10.0)), Some(0));
        assert_eq!(last_cycle(Some(angle), Some(11.0)), None);
    }
}

#[test]
fn the_metadata_give_it_back() {
    for (repeats, factor) in [(true, Some(0.1 + 0.2)), (false, None)] {
        let slowest = Some(Slowest {
            channel: "main[1].eccentricity.x".to_owned(),
            change: 1.0 / 3.0,
            factor,
        });
        for slowest in [slowest, None] {
            let found = Repetition {
                cycles: 40,
                repeats,
                slowest,
                noise: repeats.then(|| "tolerance: 0.01".to_owned()),
                erratic: !repeats,
            };
            let kept = found.metadata().into_iter();
            let kept: BTreeMap<String, String> =
                kept.map(|(key, value)| (key.to_owned(), value)).collect();
            assert!(kept.keys().all(|key| Repetition::is_key(key)));
            assert_eq!(Repetition::of(&kept), Some(found));
        }
    }
    assert_eq!(Repetition::of(&BTreeMap::new()), None);
}
