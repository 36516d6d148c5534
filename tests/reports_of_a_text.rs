//! `report` blocks through the whole chain: from a text whose signals are known in closed form to values,
//! figures, files and pages.

use eng::post::{EvaluatedReport, Outcome, PostError, Run, evaluate};
use eng::{Machine, Program, Results, Sources};
use eng_report::figure::{Abscissa, Figure, History};
use std::f64::consts::{PI, TAU};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// A disc that turns at a constant speed; its outputs are made of time and cycle angle.
const MODEL: &str = "
use std.joints.Revolute
model Spin {
    param speed: AngularVelocity = 1200 rpm
    gravity = [0, 0, 0] m/s^2
    marker pivot = [0, 0, 0] mm
    body disc { mass = 1 kg; inertia = [1, 1, 1] g*m^2; marker hub = origin; start angular_velocity = [0, 0, 1]*speed }
    joint pin = Revolute(disc.hub, pivot)
    cycle angle = rotation(disc.hub, pivot) { period = 720 deg }
    output wave[k in 1..2]: Force = 1 kN + k*3 kN*sin(2*pi * 50 Hz * time) + 0.5 kN*cos(2*pi * 2 kHz * time) as kN
    output ripple: Force = 2 kN*cos(4*cycle.angle - 1 rad) + 1 kN * speed/(1000 rpm)*cos(2*cycle.angle)
    output arm: Vector2<Length> = [3 mm*cos(cycle.angle), 3 mm*sin(cycle.angle)] in ground
}
analysis timed = transient(Spin(), duration: 0.2 s, sample: 0.1 ms)
analysis turned = transient(Spin(), duration: 4 rev, sample: 0.5 deg)
analysis coarse = transient(Spin(), duration: 4 rev, sample: 1 deg)
analysis runup[s in 600 rpm .. 1800 rpm by 600 rpm] = transient(Spin(speed: s), duration: 4 rev, sample: 1 deg)
analysis steady = periodic(Spin(), sample: 1 deg)
const limit = 9 kN
";

struct Ran {
    program: Program,
    results: Vec<(Results, Machine)>,
}

impl Ran {
    fn new(reports: &str, analyses: &[&str]) -> Ran {
        Ran::of(MODEL, reports, analyses)
    }

    fn of(model: &str, reports: &str, analyses: &[&str]) -> Ran {
        let text = format!("{model}{reports}");
        let checked = eng::check(&Sources::from_text("spin.eng", text), "spin.eng");
        let program = checked
            .into_program()
            .unwrap_or_else(|report| panic!("{report}"));
        let results = analyses
            .iter()
            .map(|name| {
                let analysis = program
                    .analysis(name)
                    .unwrap_or_else(|error| panic!("{error}"));
                let outcome = analysis
                    .run(&mut |_| {})
                    .unwrap_or_else(|failed| panic!("{}", failed.error));
                let model = analysis.machine().expect("its numbers");
                (outcome.results, model)
            })
            .collect();
        Ran { program, results }
    }

    fn report(&self) -> EvaluatedReport {
        let runs: Vec<Run<'_>> = self
            .results
            .iter()
            .map(|(results, model)| Run::new(results, model))
            .collect();
        evaluate(&self.program.reports()[0], &runs)
    }
}

fn values(report: &EvaluatedReport, name: &str) -> Vec<f64> {
    report
        .values(name)
        .unwrap_or_else(|error| panic!("{name}: {error}"))
        .iter()
        .map(|number| number.value)
        .collect()
}

fn value(report: &EvaluatedReport, name: &str) -> f64 {
    let all = values(report, name);
    assert_eq!(all.len(), 1, "{name}");
    all[0]
}

fn figure<'r>(report: &'r EvaluatedReport, name: &str) -> &'r Figure {
    let entry = report.entries.iter().find(|entry| entry.name == name);
    match &entry.expect("an entry").outcome {
        Ok(Outcome::Figure(figure)) => figure,
        other => panic!("{name}: {other:?}"),
    }
}

fn history<'r>(report: &'r EvaluatedReport, name: &str) -> &'r History {
    match figure(report, name) {
        Figure::History(history) => history,
        other => panic!("{name}: {other:?}"),
    }
}

fn near(found: f64, expected: f64, relative: f64) {
    assert!(
        (found - expected).abs() <= relative * expected.abs(),
        "{found} instead of {expected}"
    );
}

#[test]
fn values_of_a_signal_in_closed_form() {
    let ran = Ran::new(
        "report exact {
            value mean = mean(timed.wave[1..2])
            value effective = rms(timed.wave[1..2])
            let ac = timed.wave[1] - mean(timed.wave[1])
            value alternating = rms(ac)
            value first = amplitude(timed.wave[2], 50 Hz)
            value high = amplitude(timed.wave[2], 2 kHz)
            value level = decibel(rms(ac), reference: 1e-6 N)
            value difference = rms(timed.wave[2] - timed.wave[1])
            value share = rms(timed.wave[2] - timed.wave[1])/rms(ac) as %
            value span = mean(abs(timed.time - 0.1 s))
            value late = minimum(last(timed.time, 50 ms))
            value arm = maximum(norm(timed.arm))
            value larger = max(mean(timed.wave[1..2]))
            value both = sum(amplitude(timed.wave[1..2], 50 Hz))
            value same = maximum(abs(max(timed.wave[1], timed.wave[2]) - max([timed.wave[1], timed.wave[2]])))
        }",
        &["timed"],
    );
    let report = ran.report();
    // 1 kN + 3k kN of 50 Hz + 0.5 kN of 2 kHz over whole periods of both
    let square = |k: f64| 1.0 + (9.0 * k * k + 0.25) / 2.0;
    for (k, (mean, effective)) in values(&report, "mean")
        .into_iter()
        .zip(values(&report, "effective"))
        .enumerate()
    {
        near(mean, 1e3, 1e-10);
        near(effective, 1e3 * square(k as f64 + 1.0).sqrt(), 1e-10);
    }
    let alternating = 1e3 * (square(1.0) - 1.0).sqrt();
    near(value(&report, "alternating"), alternating, 1e-10);
    near(value(&report, "first"), 6e3, 1e-10);
    near(value(&report, "high"), 500.0, 1e-10);
    near(
        value(&report, "level"),
        20.0 * (alternating / 1e-6).log10(),
        1e-10,
    );
    near(value(&report, "difference"), 3e3 / 2f64.sqrt(), 1e-10);
    near(
        value(&report, "share"),
        3e3 / 2f64.sqrt() / alternating,
        1e-10,
    );
    near(value(&report, "span"), 0.05, 1e-10);
    near(value(&report, "late"), 0.15, 1e-9);
    near(value(&report, "arm"), 3e-3, 1e-12);
    near(value(&report, "larger"), 1e3, 1e-10);
    near(value(&report, "both"), 9e3, 1e-10);
    assert_eq!(value(&report, "same"), 0.0);
    let units: Vec<String> = report
        .entries
        .iter()
        .filter_map(|entry| match &entry.outcome {
            Ok(Outcome::Value(_, display)) => Some(display.symbol.clone()),
            _ => None,
        })
        .collect();
    assert_eq!(units[0], "kN", "as the channel is shown");
    assert!(units.contains(&"dB re 1e-6 N".to_owned()) && units.contains(&"%".to_owned()));
}

#[test]
fn spectra_are_exact_over_frequency_and_order() {
    let ran = Ran::new(
        "report exact {
            figure lines = spectrum(timed.wave[1..2], axis: frequency, up_to: 3 kHz, window: rectangular)
            figure kept = spectrum(timed.wave[1], axis: frequency, up_to: 100 Hz, window: rectangular, mean: kept)
            figure blocks = spectrum(timed.wave[1], axis: frequency, window: hann, block: 40 ms, overlap: 50 %)
            figure level = spectrum(timed.wave[1], axis: frequency, window: flat_top, reference: 1 N)
            figure orders = spectrum(turned.ripple, up_to: 10, window: rectangular)
            figure converted = spectrum(turned.ripple, up_to: 200 Hz, window: rectangular)
        }",
        &["timed", "turned"],
    );
    let report = ran.report();
    let at = |name: &str, curve: usize, place: f64| {
        let panel = &history(&report, name).panels[0];
        let nearest = (0..panel.x.len())
            .min_by(|a, b| {
                (panel.x[*a] - place)
                    .abs()
                    .total_cmp(&(panel.x[*b] - place).abs())
            })
            .expect("a line");
        near(panel.x[nearest], place, 1e-6);
        panel.curves[curve].values[nearest]
    };
    near(at("lines", 0, 50.0), 3.0, 1e-10);
    near(at("lines", 1, 50.0), 6.0, 1e-10);
    near(at("lines", 1, 2000.0), 0.5, 1e-10);
    let lines = history(&report, "lines");
    assert_eq!(lines.panels[0].curves[1].name, "wave[2]");
    assert_eq!(lines.ordinate.unit, "kN");
    let rest: f64 = lines.panels[0]
        .x
        .iter()
        .zip(&lines.panels[0].curves[0].values)
        .filter(|(x, _)| (**x - 50.0).abs() > 1.0 && (**x - 2000.0).abs() > 1.0)
        .map(|(_, y)| *y)
        .fold(0.0, f64::max);
    assert!(rest < 3e-10, "{rest:e}");
    assert!(
        lines
            .subtitle
            .contains("rectangular window, resolution 5.0000 Hz"),
        "{}",
        lines.subtitle
    );
    near(at("kept", 0, 0.0), 1.0, 1e-10);
    near(at("blocks", 0, 50.0), 3.0, 1e-10);
    let blocks = history(&report, "blocks");
    assert!(
        blocks
            .subtitle
            .contains("rms of 9 blocks of 400 samples, overlap 50 %"),
        "{}",
        blocks.subtitle
    );
    near(at("level", 0, 50.0), 20.0 * 3e3f64.log10(), 1e-10);
    assert_eq!(history(&report, "level").ordinate.unit, "dB re 0.001 kN");
    // the angle of a sample is found to the solver's rounding
    near(at("orders", 0, 4.0), 2e3, 1e-6);
    near(at("orders", 0, 2.0), 1.2e3, 1e-6);
    near(at("converted", 0, 80.0), 2e3, 1e-6);
}

#[test]
fn places_cycles_and_sweeps() {
    let ran = Ran::new(
        "report exact {
            let wave = turned.ripple - 1.2 kN*cos(2*turned.cycle.angle)
            value place = maximum_at(last_cycle(wave))
            value low = minimum_at(wave)
            value clock = maximum_at(wave, over: time)
            value cycle = peak_to_peak(last_cycle(turned.cycle.angle, cycles: 2))
            value begin = minimum_at(last_cycle(turned.cycle.angle))
            value part = peak_to_peak(last(turned.cycle.angle, 180 deg))
            value second = amplitude(runup[*].ripple, 2, window: rectangular)
            value again = rms(resample(turned.ripple, like: coarse.ripple) - coarse.ripple)/rms(coarse.ripple)
            figure tracks = order_track(runup[*].ripple, orders: [2, 4], window: rectangular)
            figure fall = waterfall(runup[*].ripple, up_to: 10)
            figure map = campbell(runup[*].ripple, up_to: 300 Hz, orders: [2, 4])
            figure paths = polar(turned.arm, turned_by: turned.cycle.angle, cycles: 1)
            figure mixed = history([turned.ripple, coarse.ripple], timed.wave[1], over: crank_angle)
        }",
        &["timed", "turned", "coarse", "runup[1]", "runup[2]", "runup[3]"],
    );
    let report = ran.report();
    // of the top 4θ = 1 + 2πn the first that no sample exceeds
    let place = value(&report, "place").to_degrees();
    let off = (place - 1f64.to_degrees() / 4.0).rem_euclid(90.0);
    assert!(
        off.min(90.0 - off) < 1e-4 && (0.0..720.0).contains(&place),
        "{place}"
    );
    let low =
        (value(&report, "low").to_degrees() - 45.0 - 1f64.to_degrees() / 4.0).rem_euclid(90.0);
    assert!(low.min(90.0 - low) < 1e-4, "{low}");
    let clock = (value(&report, "clock") * 40.0 * PI - 0.25).rem_euclid(PI / 2.0);
    assert!(clock.min(PI / 2.0 - clock) < 1e-5, "{clock}");
    near(value(&report, "cycle"), 8.0 * PI, 1e-9);
    assert!(value(&report, "begin").abs() < 1e-6);
    near(value(&report, "part"), PI, 1e-9);
    for (found, speed) in values(&report, "second")
        .into_iter()
        .zip([600.0, 1200.0, 1800.0])
    {
        near(found, speed, 1e-6);
    }
    assert!(
        value(&report, "again") < 1e-5,
        "{}",
        value(&report, "again")
    );
    let tracks = history(&report, "tracks");
    assert_eq!(tracks.panels.len(), 1);
    for (x, speed) in tracks.panels[0].x.iter().zip([600.0, 1200.0, 1800.0]) {
        near(*x, speed, 1e-6);
    }
    assert_eq!(tracks.panels[0].curves[1].name, "order 4");
    for amplitude in &tracks.panels[0].curves[1].values {
        near(*amplitude, 2e3, 1e-6);
    }
    let Figure::Waterfall(fall) = figure(&report, "fall") else {
        panic!("no waterfall");
    };
    assert_eq!(fall.figure.map.speeds(), [600.0, 1200.0, 1800.0]);
    let Figure::Campbell(map) = figure(&report, "map") else {
        panic!("no Campbell diagram");
    };
    assert_eq!(
        (map.orders.as_slice(), map.figure.limit),
        (&[2.0, 4.0][..], Some(300.0))
    );
    // an arm that turns with the shaft stands still in the shaft's axes
    let Figure::Polar(paths) = figure(&report, "paths") else {
        panic!("no polar diagram");
    };
    assert_eq!(paths.curves[0].angle.len(), 1441);
    let scale = if paths.unit == "mm" { 3.0 } else { 3e-3 };
    for (x, y) in paths.curves[0].x.iter().zip(&paths.curves[0].y) {
        assert!(
            (x - scale).abs() < 1e-9 * scale && y.abs() < 1e-9 * scale,
            "{x} {y}"
        );
    }
    // curves with other samples stand in panels of their own
    assert_eq!(history(&report, "mixed").panels.len(), 3);
}

/// The band of a cycle that repeats is exact. Over angle, 1 kHz at 1200 rpm is the 50th order.
#[test]
fn bands_of_a_repeating_cycle() {
    let ran = Ran::new(
        "report exact {
            value low = rms(low_pass(steady.ripple, 3))
            value high = rms(high_pass(steady.ripple, 60 Hz))
            value band = rms(band(steady.ripple, 3, 5))
            value half = rms(low_pass(steady.ripple, 4, butterworth: 3))
            value ends = maximum(abs(band(steady.ripple, 1, 5) - steady.ripple))
            figure shown = history(low_pass(steady.ripple, 3))
            figure lines = spectrum(steady.ripple, up_to: 6)
        }",
        &["steady"],
    );
    let report = ran.report();
    near(value(&report, "low"), 1.2e3 / 2f64.sqrt(), 1e-6);
    near(value(&report, "high"), 2e3 / 2f64.sqrt(), 1e-6);
    near(value(&report, "band"), 2e3 / 2f64.sqrt(), 1e-6);
    // gain 1/(1 + (f/4)^6): 1/2 at the limit, 64/65 an octave below
    let (second, fourth): (f64, f64) = (1.2e3 * 64.0 / 65.0, 1e3);
    near(
        value(&report, "half"),
        ((second * second + fourth * fourth) / 2.0).sqrt(),
        1e-6,
    );
    assert!(value(&report, "ends") < 1e-3, "{}", value(&report, "ends"));
    let shown = history(&report, "shown");
    assert!(
        shown.subtitle.ends_with(
            "low-pass 3 orders, brick-wall, gain ½ at the limits, zero phase, taken as periodic"
        ),
        "{}",
        shown.subtitle
    );
    // no window is stated, and the cycle repeats
    assert!(
        history(&report, "lines")
            .subtitle
            .contains("rectangular window")
    );
}

/// Filters are exact at the ends of a transient, too. A last cycle is filtered around its end.
#[test]
fn bands_of_transients_hold_at_the_ends() {
    let ran = Ran::new(
        "report exact {
            let slow = 1 kN + 3 kN*sin(2*pi * 50 Hz * timed.time)
            let fast = 0.5 kN*cos(2*pi * 2 kHz * timed.time)
            value low = maximum(abs(low_pass(timed.wave[1], 500 Hz) - slow))
            value high = maximum(abs(high_pass(timed.wave[1], 500 Hz) - fast))
            value band = maximum(abs(band(timed.wave[1], 1 kHz, 3 kHz) - fast))
            value smooth = maximum(abs(low_pass(timed.wave[1], 300 Hz, butterworth: 10) - slow))
            value part = maximum(abs(low_pass(last(timed.wave[1], 73 ms), 500 Hz) - last(slow, 73 ms)))
            let fourth = 2 kN*cos(4*turned.cycle.angle - 1 rad)
            value whole = maximum(abs(band(turned.ripple, 3, 5) - fourth))
            value cycle = maximum(abs(band(last_cycle(turned.ripple), 3, 5) - last_cycle(fourth)))
            value after = maximum(abs(last_cycle(band(turned.ripple, 3, 5)) - last_cycle(fourth)))
            figure round = history(band(last_cycle(turned.ripple), 3, 5))
            figure on = history(band(turned.ripple, 3, 5))
        }",
        &["timed", "turned"],
    );
    let report = ran.report();
    for name in [
        "low", "high", "band", "smooth", "part", "whole", "cycle", "after",
    ] {
        let found = value(&report, name);
        println!("{name}: {found:.1e} N of 4.5 kN");
        assert!(found < 1e-5 * 4.5e3, "{name}: {found:e} N");
    }
    let subtitle = |name: &str| history(&report, name).subtitle.clone();
    assert!(subtitle("round").ends_with("taken as periodic"));
    assert!(
        subtitle("on")
            .ends_with("continued beyond the ends cycle by cycle, the change by linear prediction")
    );
}

/// Quantities that the samples do not resolve are refused, in the units of the text and with the remedy.
#[test]
fn what_samples_cannot_tell_is_refused() {
    let ran = Ran::new(
        "report beyond {
            value high = rms(high_pass(timed.wave[1], 6 kHz))
            value low = rms(low_pass(timed.wave[1], 6 kHz))
            value band = rms(band(timed.wave[1], 1 kHz, 6 kHz))
            value order = amplitude(turned.ripple, 400)
            value frequency = amplitude(turned.ripple, 8 kHz)
            value slow = amplitude(timed.wave[1], 3 Hz)
            value drift = rms(low_pass(timed.wave[1], 3 Hz))
            value narrow = rms(band(timed.wave[1], 50 Hz, 52 Hz))
            value long = rms(resample(last(turned.ripple, 2 rev), like: coarse.ripple))
            figure block = spectrum(timed.wave[1], axis: frequency, block: 300 ms)
            figure point = spectrum(timed.wave[1], axis: frequency, block: 0.1 ms)
            figure turns = spectrum(turned.ripple, block: 6 rev)
            figure orders = order_track(runup[*].ripple, orders: [2, 200])
            figure along = order_track(turned.ripple, orders: 2, block: 5 rev)
            figure half = order_track(turned.ripple, orders: [2, 0.1], block: 2 rev)
            figure axis = spectrum(turned.ripple, up_to: 1000)
            figure map = waterfall(runup[*].ripple, up_to: 300)
            figure same = waterfall(equal[*].ripple)
            value odd = maximum(max(timed.time - 1 s, log(timed.time/(1 s) - 1)*1 s))
            value none = decibel(0*rms(timed.wave[1]), reference: 1 N)
        }
        analysis equal[k in 1..2] = transient(Spin(), duration: k*4 rev, sample: 1 deg)",
        &[
            "timed", "turned", "coarse", "runup[1]", "runup[2]", "runup[3]", "equal[1]", "equal[2]",
        ],
    );
    let report = ran.report();
    let error = |name: &str| {
        let entry = report.entries.iter().find(|entry| entry.name == name);
        match &entry.expect("an entry").outcome {
            Err(error) => error.to_string(),
            other => panic!("{name}: {other:?}"),
        }
    };
    let fast =
        "is too fast for samples every 100 us, which resolve less than 5 kHz; run it with `sample:";
    for name in ["high", "low", "band"] {
        assert_eq!(error(name), format!("timed: 6 kHz {fast} 83 us` or less"));
    }
    assert_eq!(
        error("order"),
        "turned: order 400 is too fast for samples every 0.5 deg, which resolve less than order 360; run it with `sample: 0.44 deg` or less"
    );
    // evenly sampled over time, too
    assert!(error("frequency").starts_with("turned: 8 kHz is too fast for samples every 69.44 us"));
    let period = "has no whole period in the signal, which is 200 ms long";
    assert_eq!(error("slow"), format!("timed: 3 Hz {period}"));
    assert_eq!(error("drift"), format!("timed: 3 Hz {period}"));
    assert_eq!(
        error("narrow"),
        format!("timed: the width from 50 Hz to 52 Hz {period}")
    );
    assert_eq!(
        error("long"),
        "turned covers only 720.000000 deg to 1440.000000 deg, but the samples of coarse in `like` cover 0.000000 deg to 1440.000000 deg: take the same part of both, such as by `last` or `last_cycle`"
    );
    assert_eq!(
        error("block"),
        "timed: a block of 300 ms is longer than the signal, 200 ms"
    );
    assert_eq!(
        error("point"),
        "timed: a block of 100 us is shorter than two samples, which are 100 us apart"
    );
    assert_eq!(
        error("turns"),
        "turned: a block of 6 rev is longer than the signal, 4 rev"
    );
    assert_eq!(
        error("orders"),
        "runup[1]: order 200 is too fast for samples every 1 deg, which resolve less than order 180; run it with `sample: 0.89 deg` or less"
    );
    assert_eq!(
        error("along"),
        "turned: a block of 5 rev is longer than the signal, 4 rev"
    );
    assert_eq!(
        error("half"),
        "turned: order 0.1 has no whole period in the signal, which is 2 rev long"
    );
    let axis = history(&report, "axis");
    assert!(
        axis.subtitle
            .contains("the samples resolve no more than order 360"),
        "{}",
        axis.subtitle
    );
    let Figure::Waterfall(map) = figure(&report, "map") else {
        panic!("no waterfall");
    };
    assert!(
        map.figure
            .subtitle
            .ends_with("the samples resolve no more than order 180"),
        "{}",
        map.figure.subtitle
    );
    assert_eq!(
        error("same"),
        "equal[1] and equal[2] both turn at 1200 rpm: a picture over the speed cannot separate them"
    );
    // a value that is no number is not skipped
    assert!(
        error("odd").contains("is not a finite number"),
        "{}",
        error("odd")
    );
    assert_eq!(error("none"), "the level of 0 is not a finite number");
}

/// With a changing speed, orders cannot be converted to frequencies.
#[test]
fn a_run_up_has_no_frequencies_by_orders() {
    let ran = Ran::new(
        "model Faster {
            gravity = [0, 0, 0] m/s^2
            marker pivot = [0, 0, 0] mm
            body disc { mass = 1 kg; inertia = [1, 1, 1] g*m^2; marker hub = origin; start angular_velocity = [0, 0, 1]*600 rpm }
            joint pin = Revolute(disc.hub, pivot)
            force motor = Motor(disc.hub, pivot)
            cycle angle = rotation(disc.hub, pivot) { period = 720 deg }
            output ripple: Force = 2 kN*cos(4*cycle.angle)
        }
        force Motor(a: Marker, b: Marker) { apply torque (0.1 N*m)*b.z on a against b }
        analysis up = transient(Faster(), duration: 40 rev, sample: 1 deg)
        report speeds {
            value frequency = rms(band(up.ripple, 50 Hz, 100 Hz))
            value order = maximum(abs(band(up.ripple, 3, 5) - up.ripple))
            value line = amplitude(up.ripple, 50 Hz)
            figure spectrum = spectrum(up.ripple, axis: frequency)
            figure orders = spectrum(up.ripple, axis: order)
            figure tracks = order_track(up.ripple, orders: 4, block: 4 rev)
        }",
        &["up"],
    );
    let report = ran.report();
    let due = "so samples at equal distances of crank angle give no frequencies; run it with a `sample:` in milliseconds";
    for name in ["frequency", "line", "spectrum"] {
        let entry = report
            .entries
            .iter()
            .find(|e| e.name == name)
            .expect("an entry");
        let error = entry.outcome.clone().expect_err("no speed");
        assert!(
            matches!(error, PostError::SpeedChanges { .. }) && error.to_string().ends_with(due),
            "{error}"
        );
    }
    // of the angle's law nothing is lost
    assert!(value(&report, "order") < 0.1, "{}", value(&report, "order"));
    for name in ["orders", "tracks"] {
        let _ = figure(&report, name);
    }
}

/// The angle of a cycle that repeats counts from its beginning, in every cycle; a shaft turns either way.
#[test]
fn angles_are_of_the_cycle() {
    let ran = Ran::new(
        "analysis late = transient(Spin(), duration: 6.5 rev, sample: 1 deg)
        analysis back = transient(Spin(speed: -1200 rpm), duration: 4 rev, sample: 1 deg)
        report angles {
            let wave = 2 kN*cos(0.5*steady.cycle.angle - 1 rad)
            value at = maximum_at(wave)
            value begin = minimum(steady.cycle.angle)
            value end = maximum(steady.cycle.angle)
            figure shown = history(steady.ripple)
            value late_begin = minimum(last_cycle(late.cycle.angle))
            value late_end = maximum(last_cycle(late.cycle.angle))
            value same = rms(steady.ripple - last_cycle(coarse.ripple))
            value back_at = maximum_at(last_cycle(2 kN*cos(0.5*back.cycle.angle + 1 rad)))
            value back_order = amplitude(last_cycle(back.ripple), 4, window: rectangular)
            value back_band = rms(band(last_cycle(back.ripple), 3, 5))
        }",
        &["steady", "late", "coarse", "back"],
    );
    let report = ran.report();
    near(value(&report, "at"), 2.0, 1e-4);
    assert!(value(&report, "begin").abs() < 1e-6);
    near(value(&report, "end"), 2.0 * TAU, 1e-9);
    let x = &history(&report, "shown").panels[0].x;
    assert!(x[0].abs() < 1e-4 && (x[x.len() - 1] - 720.0).abs() < 1e-4);
    near(value(&report, "late_begin"), PI, 1e-6);
    near(value(&report, "late_end"), 5.0 * PI, 1e-6);
    assert!(value(&report, "same") < 1e-3, "{}", value(&report, "same"));
    near(value(&report, "back_at"), -2.0, 1e-4);
    near(value(&report, "back_order"), 2e3, 1e-6);
    near(value(&report, "back_band"), 2e3 / 2f64.sqrt(), 1e-6);
}

/// The point of the arm runs along a circle of 3 mm; a force of the second order runs along an ellipse over it.
#[test]
fn a_signal_over_another_one() {
    let ran = Ran::new(
        "report loops {
            figure circle \"Path\" = xy(steady.arm.x, steady.arm.y) as mm
            figure several = xy([turned.arm.x, turned.arm.y], [turned.ripple, turned.wave[1]], cycles: 1)
            figure one = xy(steady.arm.x, steady.wave[1..2]) as N
            figure two = xy(turned.arm.x, steady.ripple)
            figure late = xy(turned.arm.x, 2*last_cycle(turned.ripple))
            value later = rms(turned.ripple - last(turned.ripple, 90 deg))
        }",
        &["steady", "turned"],
    );
    let report = ran.report();
    let Figure::Xy(circle) = figure(&report, "circle") else {
        panic!("no xy");
    };
    assert_eq!(
        (circle.x.quantity.as_str(), circle.x.unit.as_str()),
        ("Arm x", "m")
    );
    assert_eq!(
        (circle.y.quantity.as_str(), circle.y.unit.as_str()),
        ("Arm y", "mm")
    );
    assert_eq!(
        (circle.x.frame.as_str(), circle.y.frame.as_str()),
        ("ground", "ground")
    );
    assert_eq!(circle.subtitle, "Spin, analysis steady, not filtered");
    let curve = &circle.curves[0];
    assert_eq!((curve.x.len(), curve.angle.len()), (721, 721));
    for ((x, y), angle) in curve.x.iter().zip(&curve.y).zip(&curve.angle) {
        let angle = angle.to_radians();
        assert!((1e3 * x - 3.0 * angle.cos()).abs() < 1e-4 && (y - 3.0 * angle.sin()).abs() < 1e-4);
    }
    // each signal over its own; of the last cycle
    let Figure::Xy(several) = figure(&report, "several") else {
        panic!("no xy");
    };
    assert_eq!(
        several.subtitle,
        "Spin, analysis turned, last cycle, not filtered"
    );
    let names: Vec<&str> = several.curves.iter().map(|c| c.name.as_str()).collect();
    assert_eq!(names, ["ripple", "wave[1]"]);
    let [ripple, wave] = several.curves.as_slice() else {
        panic!("two curves");
    };
    assert_eq!((ripple.x.len(), wave.x.len()), (1441, 1441));
    assert!((ripple.x[0] - 3e-3).abs() < 1e-8 && wave.x[0].abs() < 1e-7);
    let force = 2.0 * 1f64.cos() + 1.2;
    assert!((ripple.y[0] - 1e3 * force).abs() < 0.1, "{}", ripple.y[0]);
    // one abscissa for all, in the stated unit of the ordinate
    let Figure::Xy(one) = figure(&report, "one") else {
        panic!("no xy");
    };
    assert_eq!((one.curves.len(), one.y.unit.as_str()), (2, "N"));
    assert!((one.curves[0].y[0] - 1500.0).abs() < 1.0 && one.curves[1].x == one.curves[0].x);
    let two = error(&report, "two");
    assert!(
        two.contains("turned and steady have different samples"),
        "{two}"
    );
    let late = error(&report, "late");
    assert!(
        late.contains("turned.arm.x and last_cycle(turned.ripple) have different samples (2881 "),
        "{late}"
    );
    let later = report.values("later").expect_err("an error").to_string();
    assert!(
        later.contains("turned.ripple and last(turned.ripple, …) have different samples ("),
        "{later}"
    );
}

/// The zero of degC belongs to temperatures, not to their differences. One sample has extremes, but no frequencies.
#[test]
fn differences_of_points_and_single_samples() {
    let model = "
use std.joints.Revolute
model Warm {
    gravity = [0, 0, 0] m/s^2
    marker pivot = [0, 0, 0] mm
    body disc { mass = 1 kg; inertia = [1, 1, 1] g*m^2; marker hub = origin; start angular_velocity = [0, 0, 1]*1200 rpm }
    joint pin = Revolute(disc.hub, pivot)
    cycle angle = rotation(disc.hub, pivot) { period = 720 deg }
    output oil: Temperature = 80 degC + 5 K*cos(2*cycle.angle) as degC
    output still: Force = 0 N*cos(cycle.angle)
}
analysis turned = transient(Warm(), duration: 4 rev, sample: 1 deg)
analysis begin = assemble(Warm())
";
    let ran = Ran::of(
        model,
        "report warm {
            value mean = mean(last_cycle(turned.oil))
            value swing = peak_to_peak(turned.oil)
            value second = amplitude(turned.oil, 2)
            value less = maximum(turned.oil - mean(turned.oil))
            value ripple = maximum(high_pass(last_cycle(turned.oil), 1))
            value passed = maximum(low_pass(last_cycle(turned.oil), 4))
            value alternating = rms(turned.oil - 80 degC)
            figure lines = spectrum(last_cycle(turned.oil), up_to: 10, window: rectangular)
            figure shown = history(turned.oil)
            figure silence = spectrum(turned.still, up_to: 10, reference: 1 N)
            value first = maximum(begin.oil)
            value whole = rms(begin.still)
            value none = rms(low_pass(begin.oil - 80 degC, 1 kHz))
        }",
        &["turned", "begin"],
    );
    let report = ran.report();
    let text = eng::post::text(&report);
    let shown = |title: &str| -> (f64, String) {
        let line = text
            .lines()
            .find(|line| line.trim_start().starts_with(title));
        let mut words = line
            .unwrap_or_else(|| panic!("{title}: {text}"))
            .split_whitespace();
        let number = words.nth(1).expect("a number").parse().expect("a number");
        (number, words.collect::<Vec<_>>().join(" "))
    };
    for (title, due, unit) in [
        ("Mean", 80.0, "degC"),
        ("Swing", 10.0, "K"),
        ("Second", 5.0, "K"),
        ("Less", 5.0, "K"),
        ("Ripple", 5.0, "K"),
        ("Passed", 85.0, "degC"),
        ("Alternating", 3.536, "K"),
        ("First", 85.0, "degC"),
    ] {
        let (number, found) = shown(title);
        near(number, due, 1e-4);
        assert_eq!(found, unit, "{title}");
    }
    let lines = history(&report, "lines");
    assert_eq!(
        (lines.ordinate.unit.as_str(), lines.panels[0].x.len()),
        ("K", 21)
    );
    near(lines.panels[0].curves[0].values[4], 5.0, 1e-6);
    assert_eq!(history(&report, "shown").ordinate.unit, "°C");
    // the level of nothing is below any axis
    let silence = figure(&report, "silence").to_svg();
    assert!(!silence.contains("NaN") && !silence.contains("inf"));
    assert_eq!(value(&report, "whole"), 0.0);
    let few = report.values("none").expect_err("one sample").to_string();
    assert_eq!(
        few,
        "begin: frequencies need at least 4 samples, and there are 1"
    );
}

/// A bob of 2.5 kg on a spring of 9000 N/m beside a disc that turns.
const SHAKEN: &str = "
use std.joints.{Revolute, Translational}
use std.forces.Bushing
model Shaken {
    param speed: AngularVelocity = 1200 rpm
    gravity = [0, 0, 0] m/s^2
    marker pivot = [0, 0, 0] mm
    body disc { mass = 1 kg; inertia = [1, 1, 1] g*m^2; marker hub = origin; start angular_velocity = [0, 0, 1]*speed }
    joint pin = Revolute(disc.hub, pivot)
    cycle angle = rotation(disc.hub, pivot) { period = 360 deg }
    body bob { mass = 2.5 kg; inertia = [1, 1, 1] g*m^2; marker eye = origin }
    joint rail = Translational(bob.eye, pivot)
    force spring = Bushing(bob.eye, pivot, stiffness: [0, 0, 9000] N/m, damping: [0, 0, 40] N*s/m,
        torsional_stiffness: [0, 0, 0] N*m/rad, torsional_damping: [0, 0, 0] N*m*s/rad)
    output place = dot(bob.eye.origin - pivot.origin, ground.z) as mm
    output acceleration = dot(bob.eye.acceleration, ground.z)
    output wave: Force = 2 kN*cos(cycle.angle)
}
analysis runup[s in 300 rpm .. 900 rpm by 300 rpm] = transient(Shaken(speed: s), duration: 4 rev, sample: 1 deg)
analysis whirl[s in 300 rpm .. 900 rpm by 300 rpm] = linear(Shaken(speed: s))
analysis standing = linear(Shaken())
";

#[test]
fn reports_read_linear_analyses() {
    let ran = Ran::of(
        SHAKEN,
        "report modes {
            value frequency = mode(standing.frequency, 1)
            value near = mode(standing.damping_ratio, 9 Hz)
            value largest = maximum(standing.undamped_frequency)
            value share = mode(standing.kinetic.bob, 1)
            value stored = mode(standing.potential.spring, 1)
            value speed = mode(standing.cycle.speed, 1)
            value stiff = mode(standing.acceleration/standing.place, 1)
            value swept = mode(whirl[*].frequency, 1)
            value none = mode(standing.frequency, 2)
            value far = mode(standing.frequency, 200 Hz)
            figure swept_map = campbell(runup[*].wave, up_to: 100 Hz, orders: 1, modes: whirl[*])
            figure one_map = campbell(runup[*].wave, up_to: 100 Hz, modes: standing, scale: linear)
            figure plain_map = campbell(runup[*].wave)
        }",
        &[
            "runup[1]", "runup[2]", "runup[3]", "whirl[1]", "whirl[2]", "whirl[3]", "standing",
        ],
    );
    let report = ran.report();
    let (m, c, k) = (2.5_f64, 40.0_f64, 9000.0_f64);
    let undamped = (k / m).sqrt();
    let ratio = c / (2.0 * (k * m).sqrt());
    let frequency = undamped * (1.0 - ratio * ratio).sqrt() / TAU;
    near(value(&report, "frequency"), frequency, 1e-9);
    near(value(&report, "near"), ratio, 1e-9);
    near(value(&report, "largest"), undamped / TAU, 1e-9);
    near(value(&report, "share"), 1.0, 1e-9);
    near(value(&report, "stored"), 1.0, 1e-9);
    near(value(&report, "speed"), 40.0 * PI, 1e-9);
    near(value(&report, "stiff"), undamped * undamped, 1e-9);
    let swept = values(&report, "swept");
    assert_eq!(swept.len(), 3);
    swept.iter().for_each(|found| near(*found, frequency, 1e-9));
    let error = |name: &str| report.values(name).expect_err("an error").to_string();
    assert_eq!(error("none"), "standing has no mode 2: it has 1");
    assert_eq!(
        error("far"),
        "standing has no mode within 10 % of 200 Hz: the nearest has 9.464 Hz"
    );
    let campbell = |name: &str| match figure(&report, name) {
        Figure::Campbell(map) => map.clone(),
        other => panic!("{name}: {other:?}"),
    };
    let map = campbell("swept_map");
    assert!(map.natural_frequencies.is_empty());
    for ((speed, found), due) in map.modes.iter().zip([300.0, 600.0, 900.0]) {
        near(*speed, due, 1e-9);
        near(*found, frequency, 1e-9);
    }
    assert_eq!(map.modes.len(), 3);
    assert!(
        map.figure
            .subtitle
            .ends_with("natural frequencies of whirl[1] to whirl[3], damping below 20 %"),
        "{}",
        map.figure.subtitle
    );
    let map = campbell("one_map");
    assert_eq!(map.natural_frequencies[0].0, "mode 1");
    near(map.natural_frequencies[0].1, frequency, 1e-9);
    assert!(map.to_svg().contains("mode 1, 9 Hz"));
    let largest = |map: &eng_report::figure::Campbell| {
        let all = map.figure.map.amplitudes().iter().flatten();
        all.fold(f64::NEG_INFINITY, |most, a| most.max(*a))
    };
    assert_eq!(map.figure.unit, "N");
    let wave = largest(&map);
    // nothing stated: frequencies up to 30 orders, levels down to 80 dB below the largest, the first orders
    let map = campbell("plain_map");
    assert_eq!(map.orders, [1.0, 2.0, 3.0, 4.0]);
    near(map.figure.limit.expect("a limit"), 30.0 * 15.0, 1e-6);
    assert!(
        map.figure.unit.starts_with("dB re 1e-6 N"),
        "{}",
        map.figure.unit
    );
    near(largest(&map), 20.0 * (wave / 1e-6).log10(), 1e-9);
    let all = || map.figure.map.amplitudes().iter().flatten();
    let least = all().fold(f64::INFINITY, |least, a| least.min(*a));
    near(largest(&map) - least, 80.0, 1e-9);
}

#[test]
fn what_cannot_be_made_is_said_in_its_place() {
    let ran = Ran::new(
        "report doubtful {
            value fine = maximum(timed.wave[1])
            value absent = maximum(coarse.ripple)
            value differing = rms(timed.ripple - turned.ripple)
            value long = rms(last_cycle(turned.ripple, cycles: 3))
            value short = rms(last(timed.ripple, 1 s))
            value ratio = fine/(fine - fine)
            require fine < limit else \"{fine as kN} is too much\"
            require fine < 2 kN else \"the wave has {fine as kN}\"
            let peaks = maximum(timed.wave[1..2])
            require peaks < 5 kN else \"a wave has {peaks as kN}\"
            advise fine < 3 kN else \"the wave has {fine as kN}\"
        }",
        &["timed", "turned"],
    );
    let report = ran.report();
    let error = |name: &str| report.values(name).expect_err("an error").to_string();
    assert_eq!(
        error("absent"),
        "there are no results of coarse; run it first"
    );
    assert_eq!(
        error("differing"),
        "timed and turned have different samples (2001 samples against 2881); `resample(a, like: b)` gives the signal a at the samples of the signal b"
    );
    assert_eq!(
        error("long"),
        "turned: the results are shorter than the last 3 cycles"
    );
    assert_eq!(
        error("short"),
        "timed: the results are shorter than the last 1 s"
    );
    assert_eq!(error("ratio"), "Ratio is not a finite number");
    assert!(matches!(
        report.values("nothing"),
        Err(PostError::NoValue(_))
    ));
    let held: Vec<(bool, bool)> = report
        .entries
        .iter()
        .filter_map(|entry| match &entry.outcome {
            Ok(Outcome::Condition { holds, advise, .. }) => Some((*holds, *advise)),
            _ => None,
        })
        .collect();
    assert_eq!(
        held,
        [(true, false), (false, false), (false, false), (false, true)]
    );
    assert!(report.fails());
    let text = eng::post::text(&report);
    assert!(
        text.contains("  required: fine < 2 kN does not hold: the wave has 4.5 kN\n"),
        "{text}"
    );
    assert!(
        text.contains("peaks < 5 kN does not hold: a wave has 7.5 kN\n"),
        "of a list the first that fails: {text}"
    );
    assert!(text.contains("  Fine  4.5 kN\n"), "{text}");
}

fn command(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_eng"))
        .args(arguments)
        .current_dir(folder)
        .output()
        .expect("the command starts")
}

fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).expect("a folder");
    folder
}

/// The check does not know the samples of a periodic motion. A missing figure is an error with its place.
#[test]
fn a_run_whose_figure_is_not_made_fails() {
    let folder = folder("figure-not-made");
    let with = |report: &str| {
        let text = format!("{MODEL}{report}");
        std::fs::write(folder.join("spin.eng"), &text).expect("a file");
        text.lines().count()
    };
    let line = with("report loops {\n    figure both = xy(turned.arm.x, steady.ripple)\n}\n") - 1;
    let output = command(
        &folder,
        &[
            "run",
            "spin.eng",
            "--analysis",
            "turned",
            "--analysis",
            "steady",
        ],
    );
    assert_eq!(output.status.code(), Some(1));
    let errors = String::from_utf8_lossy(&output.stderr);
    let told = format!(
        "error: spin.eng:{line}: `both` of the report `loops` is not made: turned and steady have different samples"
    );
    assert!(errors.contains(&told), "{errors}");
    // samples that the user leaves out are no error
    with("report end { value level = rms(last(timed.ripple, 0.1 s)) }\n");
    let output = command(
        &folder,
        &["run", "spin.eng", "--analysis", "timed", "--last", "20ms"],
    );
    assert_eq!(output.status.code(), Some(0));
    let told = String::from_utf8_lossy(&output.stdout);
    assert!(told.contains("level is not made: "), "{told}");
}

#[test]
fn run_and_report_tell_it_from_memory_and_from_files() {
    let folder = folder("reports-of-a-text");
    let reports = "
/// What both runs say.
report waves \"Two waves\" {
    /// The first signal of both.
    figure both \"First wave\" = history(timed.wave[1], turned.wave[1])
    value peak \"Largest <wave>\" = maximum(timed.wave[1..2])
    value turn = amplitude(turned.ripple, 4, window: rectangular)
}
report bounds { require maximum(timed.wave[2]) < limit else \"too much\" }
";
    let text = format!("{MODEL}{reports}");
    std::fs::write(folder.join("spin.eng"), &text).expect("a file");
    let run = |analysis: &str| {
        let output = command(&folder, &["run", "spin.eng", "--analysis", analysis]);
        assert_eq!(
            output.status.code(),
            Some(0),
            "{}",
            String::from_utf8_lossy(&output.stderr)
        );
        String::from_utf8_lossy(&output.stdout).into_owned()
    };
    let first = run("timed");
    assert!(first.contains("report waves: Two waves\n"), "{first}");
    assert!(
        first.contains("  Largest <wave>, wave[1]  4.5 kN\n"),
        "{first}"
    );
    assert!(
        first.contains("  turn is not made: there are no results of turned; run it first\n"),
        "{first}"
    );
    assert!(!first.contains("waves-both.svg"), "{first}");
    // the other run finds the first one's file
    let second = run("turned");
    assert!(
        second.contains("  Largest <wave>, wave[2]   7.5 kN\n"),
        "{second}"
    );
    let told = |line: &str| line.split_whitespace().eq(["Turn", "2000", "N"]);
    assert!(second.lines().any(told), "{second}");
    let drawn =
        std::fs::read_to_string(folder.join("results/spin/waves-both.svg")).expect("a picture");
    assert!(drawn.contains("First wave") && drawn.contains("Crank angle"));

    let output = command(&folder, &["report", "spin.eng"]);
    assert_eq!(
        output.status.code(),
        Some(0),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let page = std::fs::read_to_string(folder.join("results/spin/report.html")).expect("a page");
    for shown in [
        "Two waves",
        "What both runs say.",
        "The first signal of both.",
        "Values: Two waves",
        "Largest &lt;wave&gt;, wave[1]",
        "amplitude(turned.ripple, 4, window: rectangular)",
    ] {
        assert!(page.contains(shown), "no {shown}");
    }

    // the results remain valid with another report, but not with another constant of the text
    let other = text.replace("What both runs say.", "What they say.");
    let other = other.replace("\"Largest <wave>\"", "\"Largest\"");
    std::fs::write(folder.join("spin.eng"), &other).expect("a file");
    let third = command(
        &folder,
        &["run", "spin.eng", "--analysis", "timed", "--no-plots"],
    );
    assert!(
        third.stderr.is_empty(),
        "{}",
        String::from_utf8_lossy(&third.stderr)
    );
    std::fs::write(
        folder.join("spin.eng"),
        text.replace("limit = 9 kN", "limit = 5 kN"),
    )
    .expect("a file");
    let output = command(
        &folder,
        &["run", "spin.eng", "--analysis", "timed", "-q", "--no-plots"],
    );
    let errors = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(1), "{errors}");
    assert!(
        errors.contains("maximum(timed.wave[2]) < limit does not hold: too much"),
        "{errors}"
    );
    assert!(
        errors.contains("the results of turned are of another text of the model"),
        "{errors}"
    );
}

/// A report that names no analysis is made, with a warning.
#[test]
fn a_report_without_an_analysis_is_not_left_out() {
    let folder = folder("report-without-analysis");
    let text = format!("{MODEL}report idle {{ value most = limit }}\n");
    std::fs::write(folder.join("spin.eng"), text).expect("a file");
    let output = command(
        &folder,
        &["run", "spin.eng", "--analysis", "coarse", "--no-plots"],
    );
    let (told, errors) = (
        String::from_utf8_lossy(&output.stdout).into_owned(),
        String::from_utf8_lossy(&output.stderr).into_owned(),
    );
    assert_eq!(output.status.code(), Some(0), "{errors}");
    assert!(
        errors.contains("warning[W0801]: the report `idle` names no analysis"),
        "{errors}"
    );
    assert!(told.contains("report idle: Idle\n"), "{told}");
    let row = |line: &str| line.split_whitespace().eq(["Most", "9000", "N"]);
    assert!(told.lines().any(row), "{told}");
}

/// The block of the reference is a report of the four-cylinder engine, and the examples' own blocks are
/// checked with them.
#[test]
fn the_examples_and_the_reference_report() {
    let document = include_str!("../docs/language.md");
    let (_, block) = document
        .split_once("```eng\n/// The dynamometer")
        .expect("the block");
    let (block, _) = block.split_once("```").expect("its end");
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/inline4");
    let text = std::fs::read_to_string(folder.join("inline4.eng")).expect("the example");
    let pressure = std::fs::read_to_string(folder.join("pressure.csv")).expect("the pressure");
    let sources = Sources::from_texts([
        (
            "inline4.eng".to_owned(),
            format!(
                "{text}\n///{}
                report drawn {{
                    figure orbits = orbit(fired.engine.main[1..5], cycles: 1)
                    figure orders = spectrum(last_cycle(fired.engine.main[5].force.x), axis: order, up_to: 20, window: rectangular)
                }}",
                block.replace("report bearings", "report again")
            ),
        ),
        ("pressure.csv".to_owned(), pressure),
    ]);
    let program = eng::check(&sources, "inline4.eng")
        .into_program()
        .unwrap_or_else(|report| panic!("{report}"));
    let names: Vec<&str> = program.reports().iter().map(|r| r.name.as_str()).collect();
    assert_eq!(names, ["bearings", "again", "drawn"]);
    let runs: Vec<(Results, Machine)> = ["unfired", "fired", "settled"]
        .iter()
        .map(|name| {
            let analysis = program.analysis(name).expect("an analysis");
            let outcome = analysis.run(&mut |_| {}).expect("a run");
            (outcome.results, analysis.machine().expect("its numbers"))
        })
        .collect();
    let runs: Vec<Run<'_>> = runs.iter().map(|(r, m)| Run::new(r, m)).collect();
    for report in program.reports() {
        let made = evaluate(report, &runs);
        for entry in &made.entries {
            assert!(entry.outcome.is_ok(), "{}: {:?}", entry.name, entry.outcome);
        }
        assert!(!made.fails(), "{}", eng::post::text(&made));
    }
    // loads of journals are against the forces on the pins: the tip points at the side that carries them
    let made = evaluate(&program.reports()[1], &runs);
    let Figure::Polar(load) = figure(&made, "load") else {
        panic!("no polar diagram");
    };
    assert!(load.subtitle.contains("load of the pins on their shells"));
    let unfired = program.analysis("unfired").expect("an analysis");
    let unfired = unfired.run(&mut |_| {}).expect("a run").results;
    let column = |path: &str| &unfired.column(path).expect("a column").values;
    let angle = column("cycle.angle");
    let (x, y) = (
        column("engine.main[2].force.x"),
        column("engine.main[2].force.y"),
    );
    let curve = &load.curves[1];
    let scale = if load.unit == "kN" { 1e3 } else { 1.0 };
    for k in (0..angle.len()).step_by(97) {
        let (sine, cosine) = angle[k].sin_cos();
        let size = x[k].hypot(y[k]);
        assert!((scale * curve.x[k] + x[k] * cosine + y[k] * sine).abs() < 1e-9 * size);
        assert!((scale * curve.y[k] + y[k] * cosine - x[k] * sine).abs() < 1e-9 * size);
    }
    let made = evaluate(&program.reports()[0], &runs);
    // inertia and gas: the fired engine's journals carry more than 10 kN, on films of some micrometres
    let peaks = values(&made, "peak");
    assert!(
        peaks.len() == 5 && peaks.iter().all(|p| (5e3..40e3).contains(p)),
        "{peaks:?}"
    );
    let films = values(&made, "film");
    assert!(
        films.iter().all(|f| (0.1e-6..10e-6).contains(f)),
        "{films:?}"
    );
    let drawn = evaluate(&program.reports()[2], &runs);
    let Figure::Orbits(orbits) = figure(&drawn, "orbits") else {
        panic!("no orbits");
    };
    assert!(
        orbits
            .orbits
            .iter()
            .all(|o| o.clearance == 27e-6 && o.angle.len() == 1441)
    );
    assert!((orbits.period - 2.0 * TAU.to_degrees()).abs() < 1e-9);
    // curves are named by journal, and the cylinders' dead centres are marked
    assert_eq!(orbits.orbits[4].name, "E engine.main[5]");
    let forces = history(&made, "forces");
    let curves = |panel: usize| forces.panels[panel].curves.iter().map(|c| c.name.as_str());
    for panel in 0..2 {
        let letters: Vec<&str> = curves(panel)
            .filter_map(|name| name.split(' ').next())
            .collect();
        assert_eq!(
            letters,
            ["A", "B", "C", "D", "E"],
            "{:?}",
            forces.panels[panel].title
        );
    }
    let mut fires: Vec<(f64, &str)> = forces
        .marks
        .iter()
        .map(|mark| (mark.at.round(), mark.label.as_str()))
        .collect();
    fires.sort_by(|a, b| a.0.total_cmp(&b.0));
    assert_eq!(
        fires,
        [
            (0.0, "TDC 1"),
            (180.0, "TDC 3"),
            (360.0, "TDC 4"),
            (540.0, "TDC 2")
        ]
    );
    // an order of a shaft at a known speed is a frequency; one journal alone has no letter
    let orders = history(&drawn, "orders");
    let Abscissa::OrderAt { speed } = orders.abscissa else {
        panic!("{:?}", orders.abscissa);
    };
    near(speed, 4000.0 / 60.0, 2e-3);
    assert_eq!(orders.panels[0].curves[0].name, "engine.main[5].force.x");
}

/// A line has no part of the mean, with any window. A condition that cannot be decided fails.
#[test]
fn amplitudes_leave_the_mean_out_and_undecided_conditions_fail() {
    let ran = Ran::new(
        "report q {
            value low = amplitude(turned.ripple + 100 kN, 0.25)
            value line = amplitude(turned.ripple + 100 kN, 4)
            require log(-1*mean(turned.ripple + 100 kN)/(1 N)) < 1 else \"no number\"
        }",
        &["turned"],
    );
    let report = ran.report();
    let number = |name: &str| report.values(name).expect("a value")[0].value;
    assert!(number("low") < 1.0, "{}", number("low"));
    assert!((number("line") - 2e3).abs() < 1e-2, "{}", number("line"));
    assert!(report.entries.iter().any(|entry| entry.undecided));
    assert!(report.fails());
    // of analyses that were not run nothing is asked
    let ran = Ran::new(
        "report q { require rms(coarse.ripple) < 1 N else \"large\" }",
        &["turned"],
    );
    let report = ran.report();
    assert!(!report.fails() && report.entries.iter().all(|entry| !entry.undecided));
}

/// A rotor that is driven at a speed of the text; no engine, no start.
const RIG: &str = "
use std.drives.ConstantSpeed
model Rig {
    param speed: AngularVelocity = 3000 rpm
    gravity = [0, 0, 0] m/s^2
    marker rail = [0, 0, 0] mm
    body rotor { mass = 1 kg; inertia = [1, 1, 1] g*m^2; marker hub = origin }
    drive turn = ConstantSpeed(rotor.hub, rail, speed: speed)
    cycle angle = rotation(rotor.hub, rail) { period = 360 deg }
    let phi = rotation(rotor.hub, rail)
    output p: Force = 10 N*sin(phi) + 1 N
    output two: Force = 10 N*sin(phi) + 4 N*cos(3*phi)
}
";

fn error(report: &EvaluatedReport, name: &str) -> String {
    let entry = report.entries.iter().find(|entry| entry.name == name);
    match &entry.expect("an entry").outcome {
        Err(error) => error.to_string(),
        other => panic!("{name}: {other:?}"),
    }
}

/// A line at a limit is half below and half above it, for every way to filter it.
#[test]
fn a_line_at_a_limit_is_halved() {
    let ran = Ran::of(
        RIG,
        "analysis round = periodic(Rig(), sample: 1 deg)
        analysis run = transient(Rig(), duration: 10 rev, sample: 1 deg)
        report exact {
            value low = rms(low_pass(round.two, 3))
            value high = rms(high_pass(round.two, 3))
            value above = rms(low_pass(round.two, 3.2))
            let parts = low_pass(round.two, 1) + band(round.two, 1, 3) + high_pass(round.two, 3)
            value sum = maximum(abs(parts - round.two))
            value last = rms(low_pass(last_cycle(run.two), 1))
            value share_low = rms(low_pass(run.p - 1 N, 1))/rms(run.p - 1 N)
            value share_high = rms(high_pass(run.p - 1 N, 1))/rms(run.p - 1 N)
            value whole = maximum(abs(low_pass(run.two, 2.9) + high_pass(run.two, 2.9) - run.two))
            value both = maximum(abs(low_pass(run.two, 3) + high_pass(run.two, 3) - run.two))
        }",
        &["round", "run"],
    );
    let report = ran.report();
    let root = 2f64.sqrt();
    near(value(&report, "low"), 104f64.sqrt() / root, 1e-6);
    near(value(&report, "high"), 2.0 / root, 1e-6);
    near(value(&report, "above"), 116f64.sqrt() / root, 1e-6);
    assert!(value(&report, "sum") < 1e-9);
    near(value(&report, "last"), 5.0 / root, 1e-6);
    for name in ["share_low", "share_high"] {
        println!("{name}: {:.4}", value(&report, name));
        near(value(&report, name), 0.5, 0.04);
    }
    assert!(value(&report, "whole") < 1e-9 && value(&report, "both") < 1e-9);
}

/// A sample that ends a run between two others does not change the results of the others.
#[test]
fn an_odd_last_sample_is_left_out() {
    let ran = Ran::of(
        RIG,
        "analysis turned = transient(Rig(), duration: 3603 deg + 0.2 deg, sample: 0.5 deg)
        analysis timed = transient(Rig(), duration: 100.04 ms, sample: 0.1 ms)
        report odd {
            value by_angle = amplitude(turned.p, 1)
            value by_time = amplitude(timed.p, 50 Hz)
            value passed = maximum(abs(low_pass(turned.p, 10) - turned.p))
            value other = maximum(abs(turned.p - low_pass(turned.p, 10)))
            value kept = maximum(turned.time)
            figure lines = spectrum(timed.p, axis: frequency, up_to: 100 Hz)
            figure along = order_track(turned.p, orders: 1, block: 2 rev)
        }",
        &["turned", "timed"],
    );
    let report = ran.report();
    near(value(&report, "by_angle"), 10.0, 2e-3);
    near(value(&report, "by_time"), 10.0, 1e-6);
    for name in ["passed", "other"] {
        println!("{name}: {:.1e}", value(&report, name));
        assert!(value(&report, name) < 1e-4, "{}", value(&report, name));
    }
    near(value(&report, "kept"), 3603.2 / 18000.0, 1e-9);
    // 1000 samples give lines every 10 Hz
    let lines = &history(&report, "lines").panels[0];
    assert_eq!(lines.x.len(), 11);
    near(lines.x[5], 50.0, 1e-9);
    near(lines.curves[0].values[5], 10.0, 1e-6);
    let along = &history(&report, "along").panels[0];
    assert!(
        along.curves[0]
            .values
            .iter()
            .all(|a| (a - 10.0).abs() < 1e-3)
    );
}

/// Exactly half of the sampling rate is refused: a sine sampled there may be zero at every sample.
#[test]
fn half_of_the_samples_is_refused() {
    let ran = Ran::of(
        RIG,
        "analysis run = transient(Rig(), duration: 2 rev, sample: 1 deg)
        report half {
            value at = amplitude(run.p, 180)
            value below = amplitude(run.p, 179)
            value passed = rms(high_pass(run.p, 180))
        }",
        &["run"],
    );
    let report = ran.report();
    for name in ["at", "passed"] {
        assert_eq!(
            error(&report, name),
            "run: order 180 is too fast for samples every 1 deg, which resolve less than order 180; run it with `sample: 0.9 deg` or less"
        );
    }
    assert!(value(&report, "below").abs() < 1e-2);
}

/// A last cycle is whole, for every position of its samples.
#[test]
fn a_last_cycle_between_samples_is_whole() {
    let ran = Ran::of(
        RIG,
        "analysis fine = transient(Rig(speed: 3300 rpm), duration: 100 ms, sample: 0.1 ms)
        analysis coarse = transient(Rig(speed: 3300 rpm), duration: 100 ms, sample: 1 ms)
        analysis back = transient(Rig(speed: -3300 rpm), duration: 100 ms, sample: 0.1 ms)
        report last {
            value mean = [mean(last_cycle(fine.p)), mean(last_cycle(coarse.p)), mean(last_cycle(fine.p, cycles: 3)), mean(last_cycle(back.p))]
            value effective = [rms(last_cycle(fine.p)), rms(last_cycle(coarse.p)), rms(last_cycle(coarse.p, cycles: 5)), rms(last_cycle(back.p))]
            value first = [amplitude(last_cycle(fine.p), 1, window: rectangular), amplitude(last_cycle(coarse.p), 1, window: rectangular), amplitude(last_cycle(back.p), 1, window: rectangular)]
            value passed = maximum(abs(low_pass(last_cycle(fine.two), 2) - 10 N*sin(last_cycle(fine.cycle.angle))))
            value turned = peak_to_peak(last_cycle(fine.cycle.angle))
            value begin = minimum(last_cycle(fine.cycle.angle))
        }",
        &["fine", "coarse", "back"],
    );
    let report = ran.report();
    for (name, due) in [("mean", 1.0), ("effective", 51f64.sqrt()), ("first", 10.0)] {
        println!("{name}: {:?}", values(&report, name));
        for found in values(&report, name) {
            near(found, due, 1e-3);
        }
    }
    assert!(value(&report, "passed") < 1e-3);
    near(value(&report, "turned"), TAU, 1e-9);
    // 5.5 revolutions: the last one begins at half a turn
    near(value(&report, "begin"), PI, 1e-6);
}

/// Over the speeds of a sweep each speed is one run.
#[test]
fn orders_of_equal_speeds_are_refused() {
    let ran = Ran::of(
        RIG,
        "analysis grid[s in [1000, 2000] rpm, q in [1, 2] deg] = transient(Rig(speed: s), duration: 2 rev, sample: q)
        report sweep {
            figure mixed = order_track(grid[*, *].p, orders: 1)
            figure apart = order_track(grid[*, 1].p, orders: 1)
        }",
        &["grid[1,1]", "grid[1,2]", "grid[2,1]", "grid[2,2]"],
    );
    let report = ran.report();
    assert_eq!(
        error(&report, "mixed"),
        "grid[1,1] and grid[1,2] both turn at 1000 rpm: a picture over the speed cannot separate them"
    );
    assert_eq!(history(&report, "apart").panels[0].x.len(), 2);
}

/// Messages about a finished cycle are the same when it is read again. A message reports other parameters.
#[test]
fn results_that_are_not_made_again_say_the_same() {
    let folder = folder("reports-of-finished-runs");
    let text = format!(
        "{RIG}
analysis round = periodic(Rig(), sample: 1 deg)
analysis other = transient(Rig(), duration: 1 rev, sample: 1 deg)
report same {{
    value place = maximum_at(round.p) as deg
    value low = rms(low_pass(round.p, 2.5))
    value apart = maximum(abs(round.p - other.p))
}}
report bare {{ let a = maximum(other.p) }}
"
    );
    std::fs::write(folder.join("spin.eng"), text).expect("a file");
    let run = |arguments: &[&str]| {
        let output = command(&folder, arguments);
        let (told, errors) = (
            String::from_utf8_lossy(&output.stdout).into_owned(),
            String::from_utf8_lossy(&output.stderr).into_owned(),
        );
        assert_eq!(output.status.code(), Some(0), "{errors}");
        let (_, report) = told.split_once("report same").expect("the report");
        (report.to_owned(), errors)
    };
    let (first, errors) = run(&["run", "spin.eng", "--no-plots"]);
    assert!(
        first.contains("Place") && !first.contains("not made"),
        "{first}"
    );
    assert!(
        errors.contains("warning[W0801]: the report `bare` shows nothing"),
        "{errors}"
    );
    let (again, _) = run(&["run", "spin.eng", "--no-plots", "--resume"]);
    assert_eq!(first, again);
    let (_, errors) = run(&[
        "run",
        "spin.eng",
        "--no-plots",
        "--analysis",
        "other",
        "--set",
        "speed=2000 rpm",
    ]);
    assert!(
        errors.contains(
            "warning: the results are of different parameters: speed is as the text states in those of round, set to 2000 rpm in those of other; run them again with equal parameters"
        ),
        "{errors}"
    );
    let page = command(&folder, &["report", "spin.eng"]);
    let errors = String::from_utf8_lossy(&page.stderr).into_owned();
    assert!(
        errors.contains("speed is as the text states in those of round, set to 2000 rpm"),
        "{errors}"
    );
}

/// The names of the elements of a list show their difference, for every way to make the list.
#[test]
fn members_of_a_list_have_short_names() {
    let ran = Ran::of(
        RIG.replace(
            "output p",
            "output v[k in 1..3]: Force = k*10 N*sin(phi) + speed/(1000 rpm)*1 N\n    output p",
        )
        .as_str(),
        "analysis a[s in [2000, 3000] rpm] = transient(Rig(speed: s), duration: 2 rev, sample: 1 deg)
        report names {
            let first = last_cycle(a[1].v[1..3])
            let second = last_cycle(a[2].v[1..3])
            value share = rms(first - second)/rms(second) as %
            value runs = maximum(a[*].v[1] - a[*].v[2])
        }",
        &["a[1]", "a[2]"],
    );
    let report = ran.report();
    let names = |name: &str| -> Vec<String> {
        let numbers = report.values(name).expect("numbers");
        numbers.iter().map(|number| number.name.clone()).collect()
    };
    assert_eq!(names("share"), ["v[1]", "v[2]", "v[3]"]);
    assert_eq!(names("runs"), ["a[1]", "a[2]"]);
    for (k, share) in values(&report, "share").into_iter().enumerate() {
        let amplitude = 10.0 * (k as f64 + 1.0);
        near(
            share,
            1.0 / (9.0 + amplitude * amplitude / 2.0).sqrt(),
            1e-6,
        );
    }
}

/// The channels of an equilibrium are numbers where a number is due: in a value, a condition, and beside
/// samples of a run.
#[test]
fn a_state_is_a_number() {
    let model = "
use std.joints.Translational
use std.forces.LinearSpring
model Hanging {
    gravity = [0, 0, -10] m/s^2
    marker wall = [0, 0, 0] mm
    body block { mass = 3 kg; inertia = [1, 1, 1] g*m^2; marker eye = origin }
    joint rail = Translational(block.eye, wall)
    force spring = LinearSpring(block.eye, wall, stiffness: 2 N/mm, damping: 30 N*s/m, free_length: 100 mm)
    start rail.travel = 90 mm
}
analysis rest = static(Hanging())
analysis swing = transient(Hanging(), duration: 20 ms, sample: 1 ms)
";
    let reports = "
report sag {
    value tip = rest.rail.travel as mm
    value same = mean(rest.rail.travel)
    value under = 100 mm - rest.rail.travel
    value most = maximum(abs(swing.rail.travel - rest.rail.travel))
    let force = rest.spring.tension
    require force < -29 N else \"the spring pushes with {force as N}\"
    require rest.rail.travel > 80 mm and rest.rail.travel < 84 mm else \"it hangs elsewhere\"
}";
    let ran = Ran::of(model, reports, &["rest", "swing"]);
    let report = ran.report();
    let one = |name: &str| values(&report, name)[0];
    // 2 N/mm (100 mm − z) = 30 N
    assert!((one("tip") - 0.085).abs() < 1e-9, "{}", one("tip"));
    assert_eq!(one("tip"), one("same"));
    assert!((one("under") - 0.015).abs() < 1e-9);
    assert!((one("most") - 0.005).abs() < 1e-9, "{}", one("most"));
}
