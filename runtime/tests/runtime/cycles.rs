//! Motions that repeat, and the progress of their cycles.

use eng_runtime::internals::{Motion, Moved, Progress, distance_of_two, foreseen};

/// The comparison of the last of some cycles of one state, each of 24 samples.
fn cycles_of(motion: &mut Motion, cycles: usize, state: impl Fn(usize, usize) -> f64) -> Moved {
    let mut moved = Moved::default();
    for cycle in 0..cycles {
        let samples: Vec<f64> = (0..24).map(|sample| state(cycle, sample)).collect();
        moved = motion.next(&[], &samples);
    }
    moved
}

#[test]
fn a_state_counts_by_its_largest_value() {
    let peak = |cycle, sample| {
        let wave = libm::sin(0.25 * f64::from(sample as u32));
        100.0 * wave + 1e-3 * (cycle % 2) as f64
    };
    let moved = cycles_of(&mut Motion::of_states(&[1.0]), 2, peak);
    // 1e-3 of an error of 1e-4 times about 100
    assert!((moved.beyond - 0.1).abs() < 1e-3, "{moved:?}");
}

#[test]
fn an_impact_at_another_moment_counts_by_its_share_of_the_cycle() {
    // the speed of a plate beside its stop differs by four tolerances at some of 24 samples
    let moved = |differing: usize| {
        let speed = move |cycle: usize, sample: usize| {
            let later = cycle % 2 == 1 && sample < differing;
            1.0 + if later { 4e-4 } else { 0.0 }
        };
        cycles_of(&mut Motion::of_states(&[1.0]), 2, speed).beyond
    };
    for (differing, due) in [(1, 4.0 / libm::sqrt(24.0)), (6, 2.0), (24, 4.0)] {
        let found = moved(differing);
        assert!((found - due).abs() < 1e-2, "{differing}: {found} {due}");
    }
}

#[test]
fn a_slow_drift_below_noise_at_one_sample_does_not_repeat() {
    let noise = [0.5, -0.3, 0.2, -0.6, 0.4, -0.1, 0.3, -0.5, 0.1, -0.4];
    let with = |drift: f64| {
        let state = move |cycle: usize, sample: usize| {
            let peak = if sample == 11 { noise[cycle] } else { 0.0 };
            1e-4 * (0.7 * peak + drift * cycle as f64)
        };
        cycles_of(&mut Motion::of_states(&[1.0]), 10, state)
    };
    // by the noise the cycles differ at one sample, so its factor says nothing
    assert!(with(0.0).repeats(0.3), "{:?}", with(0.0));
    let drifts = with(0.14);
    assert!(drifts.beyond <= 1.0, "{drifts:?}");
    assert!(!drifts.repeats(0.3), "{drifts:?}");
}

#[test]
fn two_cycles_show_a_decay_or_a_motion_that_repeats() {
    // a film that settles within the cycle is no measure of a slower motion
    assert_eq!(distance_of_two(8e-3, 1e-3, 1.0), 8e-3);
    // a mount that decays by 0.9 a cycle is far from its limit
    assert!((distance_of_two(8e-3, 0.9, 1.0) - 7.2e-2).abs() < 1e-12);
    // differences that do not decay: the noise of steps, or a drift
    assert_eq!(distance_of_two(3e-3, 4.0, 1e-4), 3e-3);
    assert!((distance_of_two(3e-3, 4.0, 2e-3) - 1.8e-2).abs() < 1e-12);
}

#[test]
fn progress_grows_while_every_cycle_is_predicted_to_be_the_last() {
    let mut progress = Progress::default();
    let mut last = 0.0;
    for tenth in 1..9990 {
        let expected = foreseen((tenth - 1) / 10, 0.0, 1000);
        let now = progress.advance(0.1 * f64::from(tenth), expected);
        assert!(now > last && now < 1.0, "{tenth}: {last} {now}");
        last = now;
    }
}

#[test]
fn progress_grows_where_more_cycles_are_foreseen() {
    let mut progress = Progress::default();
    // three cycles are foreseen at first, then thirty
    let mut last = 0.0;
    for tenth in 1..=300 {
        let run = 0.1 * f64::from(tenth);
        let now = progress.advance(run, if run < 2.5 { 3.0 } else { 30.0 });
        assert!(now > last, "{run}");
        last = now;
    }
    assert!((last - 1.0).abs() < 1e-12, "{last}");
}
