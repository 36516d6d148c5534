//! `report` blocks through the whole chain: from a text whose signals are known in closed form to values, figures, files and pages.

use eng::post::{EvaluatedReport, Outcome, PostError, Run, RunModel, evaluate};
use eng::{Program, Results, Sources};
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
    results: Vec<(Results, RunModel)>,
}

impl Ran {
    fn new(reports: &str, analyses: &[&str]) -> Ran {
        let text = format!("{MODEL}{reports}");
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
                let model = RunModel::of(&analysis).expect("its numbers");
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
    assert_eq!(fall.figure.map.speeds, [600.0, 1200.0, 1800.0]);
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

/// Of a cycle that repeats a band is exact; over angle 1 kHz at 1200 rpm is the 50th order.
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
        shown
            .subtitle
            .ends_with("low-pass 3 orders, brick-wall, zero phase, taken as periodic"),
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
    assert_eq!(error("absent"), "no results of coarse");
    assert_eq!(
        error("differing"),
        "timed and turned have other samples (2001 samples against 2881); `resample(a, like: b)` gives one at the other's samples"
    );
    assert_eq!(
        error("long"),
        "turned: the results are shorter than the last 3 cycles"
    );
    assert_eq!(
        error("short"),
        "timed: the results are shorter than the last 1 s"
    );
    assert_eq!(error("ratio"), "Ratio is no finite number");
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
        first.contains("  turn is not made: no results of turned\n"),
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

    // another report leaves the results what they are, another constant of the text does not
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

/// The block of the reference is a report of the four-cylinder engine, and the examples' own blocks are checked with them.
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
                "{text}\n///{}",
                block.replace("report bearings", "report again")
            ),
        ),
        ("pressure.csv".to_owned(), pressure),
    ]);
    let program = eng::check(&sources, "inline4.eng")
        .into_program()
        .unwrap_or_else(|report| panic!("{report}"));
    let names: Vec<&str> = program.reports().iter().map(|r| r.name.as_str()).collect();
    assert_eq!(names, ["bearings", "again"]);
    let runs: Vec<(Results, RunModel)> = ["unfired", "fired"]
        .iter()
        .map(|name| {
            let analysis = program.analysis(name).expect("an analysis");
            let outcome = analysis.run(&mut |_| {}).expect("a run");
            (
                outcome.results,
                RunModel::of(&analysis).expect("its numbers"),
            )
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
    let Figure::Orbits(orbits) = figure(&made, "orbits") else {
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
    assert_eq!(orbits.orbits[4].name, "E main[5]");
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
    let orders = history(&made, "orders");
    let Abscissa::OrderAt { speed } = orders.abscissa else {
        panic!("{:?}", orders.abscissa);
    };
    near(speed, 4000.0 / 60.0, 2e-3);
    assert_eq!(orders.panels[0].curves[0].name, "vertical[5]");
}

/// A line has no part of the mean, whatever the window; what cannot be decided does not pass.
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
