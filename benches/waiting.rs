//! Processor time that a user waits for: whole runs of both four-cylinder examples by phase, thirteen speeds
//! of the rigid one until their cycles repeat, the check and the steps of chains of up to two hundred bodies,
//! and both examples with five films on cells.
//!
//! `cargo bench --bench waiting`. Each figure is the least of some runs in one thread. The films take
//! minutes: `-- films` runs them alone, one run each.

use eng::timings::Timings;
use eng::{Program, Sources};
use std::fmt::Write;
use std::path::Path;
use std::time::{Duration, Instant};

type Outcome<T> = Result<T, Box<dyn std::error::Error>>;

/// Runs of which the least time counts.
const RUNS: usize = 3;
/// Step of the chains (s).
const STEP: f64 = 1e-4;

fn main() -> Outcome<()> {
    if std::env::args().any(|argument| argument == "films") {
        return films();
    }
    for example in ["inline4", "paper"] {
        let folder = folder(example);
        let sources = Sources::folder(&folder)?;
        let file = format!("{example}.eng");
        let check = least(|| {
            drop(eng::check(&sources, &file));
            Ok(())
        })?;
        println!("{example}: check {:.3} s", check.as_secs_f64());
        let program = eng::check(&sources, &file).into_program()?;
        for name in ["unfired", "fired"] {
            whole(&program, name, RUNS)?;
        }
    }
    sweep()?;
    for bodies in [25, 50, 100, 200] {
        chain(bodies)?;
    }
    films()
}

/// 720° at 4000 rpm with five films on 72 × 13 cells: the rigid engine, and the flexible one with rigid bores
/// and with 51 elastic shapes in each.
fn films() -> Outcome<()> {
    let inline = folder("inline4");
    let text = std::fs::read_to_string(inline.join("inline4.eng"))?.replace("Impedance", "Film")
        + "\nanalysis films = transient(Inline4(), duration: 2 rev, sample: 0.5 deg)\n";
    let pressure = std::fs::read_to_string(inline.join("pressure.csv"))?;
    let texts = [("inline4.eng", text), ("pressure.csv", pressure)];
    let sources = Sources::from_texts(texts.map(|(name, text)| (name.to_owned(), text)));
    println!("five films, inline4:");
    let program = eng::check(&sources, "inline4.eng").into_program()?;
    whole(&program, "films", 1)?;
    println!("five films, paper:");
    let sources = Sources::folder(folder("paper"))?;
    let program = eng::check(&sources, "films.eng").into_program()?;
    for name in ["film", "film_fired", "elastic", "elastic_fired"] {
        whole(&program, name, 1)?;
    }
    Ok(())
}

fn folder(example: &str) -> std::path::PathBuf {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    root.join("examples").join(example)
}

/// The least time of some calls.
fn least(mut work: impl FnMut() -> Outcome<()>) -> Outcome<Duration> {
    let mut least = Duration::MAX;
    for _ in 0..RUNS {
        let begin = Instant::now();
        work()?;
        least = least.min(begin.elapsed());
    }
    Ok(least)
}

/// A run with all its samples, by phase.
fn whole(program: &Program, name: &str, runs: usize) -> Outcome<()> {
    let analysis = program.analysis(name)?.timed();
    let mut best: Option<(Duration, Timings)> = None;
    let mut counts = None;
    for _ in 0..runs {
        let outcome = analysis.run(&mut |_| {}).map_err(|failed| failed.error)?;
        counts = outcome.summary.map(|summary| summary.statistics);
        let Some(t) = outcome.timings else { continue };
        let sum = t.start + t.steps + t.samples + t.files;
        if best.is_none_or(|(least, _)| sum < least) {
            best = Some((sum, t));
        }
    }
    if let (Some((sum, t)), Some(counts)) = (best, counts) {
        let [sum, start, steps, samples, files] =
            [sum, t.start, t.steps, t.samples, t.files].map(|d| d.as_secs_f64());
        println!(
            "  {name}: {sum:.2} s = start {start:.2} + steps {steps:.2} + samples {samples:.2} + files {files:.2}; \
             {} steps, {:.2} iterations a step, {} factorisations",
            counts.steps,
            counts.iterations as f64 / counts.steps as f64,
            counts.factorizations
        );
    }
    Ok(())
}

/// Thirteen speeds until the cycle repeats.
fn sweep() -> Outcome<()> {
    let folder = folder("inline4");
    let mut text = std::fs::read_to_string(folder.join("inline4.eng"))?;
    text.push_str(
        "\nanalysis speeds[n in [1000, 1500, 2000, 2500, 3000, 3500, 4000, 4500, 5000, 5500, 6000, 6500, 7000]] =\n    \
         periodic(Inline4(speed: n*(1 rpm)), sample: 2 deg, change: 1 %)\n",
    );
    let pressure = std::fs::read_to_string(folder.join("pressure.csv"))?;
    let texts = [("inline4.eng", text), ("pressure.csv", pressure)];
    let sources = Sources::from_texts(texts.map(|(name, text)| (name.to_owned(), text)));
    let program = eng::check(&sources, "inline4.eng").into_program()?;
    let names = program.analyses();
    let mut sum = Duration::ZERO;
    for name in names.iter().filter(|name| name.starts_with("speeds[")) {
        let outcome = program.analysis(name)?.timed().run(&mut |_| {});
        let outcome = outcome.map_err(|failed| failed.error)?;
        if let Some(t) = outcome.timings {
            sum += t.start + t.steps + t.samples + t.files;
        }
    }
    println!("thirteen speeds, periodic: {:.1} s", sum.as_secs_f64());
    Ok(())
}

/// A chain of bars that hangs from one end: its check, and a step.
fn chain(bodies: usize) -> Outcome<()> {
    let mut text = String::from(
        "use std.joints.Revolute\nmodel Chain {\n    gravity = [0, -9.81, 0] m/s^2\n    marker pivot = [0, 0, 0] mm\n",
    );
    write!(
        text,
        "    body bar[i in 1..{bodies}] {{\n        mass = 1 kg\n        inertia = [1, 1, 1] g*m^2\n        \
         marker begin = [-50, 0, 0] mm\n        marker end = [50, 0, 0] mm\n        start position = [100*i - 50, 0, 0] mm\n    }}\n    \
         joint first = Revolute(bar[1].begin, pivot)\n    \
         joint next[i in 2..{bodies}] = Revolute(bar[i].begin, bar[i - 1].end)\n}}\n\
         analysis swing = transient(Chain(), duration: 20 ms, sample: 1 ms)\n"
    )?;
    let sources = Sources::from_text("chain.eng", &text);
    let begin = Instant::now();
    let program = eng::check(&sources, "chain.eng").into_program()?;
    let check = begin.elapsed();
    let model = program.model("Chain")?;
    let mut simulation = model.simulation().fixed_step(STEP).start()?;
    simulation.step()?;
    let steps = least(|| {
        for _ in 0..50 {
            simulation.step()?;
        }
        Ok(())
    })?;
    println!(
        "chain of {bodies}: check {:.2} s, step {:.0} µs",
        check.as_secs_f64(),
        steps.as_secs_f64() * 1e6 / 50.0
    );
    Ok(())
}
