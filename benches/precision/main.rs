//! Work and precision of generalised-α and Radau IIA: error over processor time, on three rigid and three flexible models.
//!
//! `cargo bench --bench precision`; `-- --svg PATH` also draws the curves. Each point is a run at a tolerance. Its time is the
//! least processor time of the steps of some runs, in which both methods take turns. Its error is the greatest difference of
//! positions at ten common moments, over the greatest position. The reference is Radau IIA at a tighter tolerance. The line
//! after the title states how far generalised-α is from it, extrapolated from fixed steps to steps of length zero.

mod picture;

use eng::{Method, Model, Sources, StepControl};
use std::path::Path;

type Outcome<T> = Result<T, Box<dyn std::error::Error>>;
/// The points of both methods, in the order of the tolerances.
type Curves = [[Point; TOLERANCES.len()]; 2];

const NAMES: [&str; 2] = ["generalised-α", "Radau IIA"];
const TOLERANCES: [f64; 6] = [1000.0, 100.0, 10.0, 1.0, 0.1, 0.01];
/// Tolerance of the reference.
const TIGHT: f64 = 1e-3;
/// Fixed steps of generalised-α whose values are extrapolated; twice as many follow.
const STEPS: f64 = 12_000.0;
const SAMPLES: usize = 10;
/// Runs of which the least time counts.
const RUNS: usize = 5;

/// A motion.
struct Case {
    title: &'static str,
    /// Folder, file and model.
    text: [&'static str; 3],
    /// Duration (s).
    duration: f64,
    /// Positions of one unit.
    channels: &'static [&'static str],
}

const CASES: [Case; 6] = [
    Case {
        title: "Squeezing mechanism",
        text: ["examples/squeezer", "squeezer.eng", "Andrews"],
        duration: 30e-3,
        channels: &["beta", "theta", "gamma", "phi", "delta", "omega", "epsilon"],
    },
    Case {
        title: "Car axis",
        text: ["tests/benchmarks", "car_axis.eng", "CarAxis"],
        duration: 3.0,
        channels: &["xl", "yl", "xr", "yr"],
    },
    Case {
        title: "Crank train with a rubber damper",
        text: ["examples/torsion_six", "torsion_six.eng", "Six"],
        duration: 60e-3,
        channels: &["twist"],
    },
    Case {
        title: "Flexible bar that flies freely",
        text: ["tests/mesh", "moving_bars.eng", "Flying"],
        duration: 5e-3,
        channels: &["tip.x", "tip.y", "tip.z"],
    },
    Case {
        title: "Flexible bar that turns on a pin",
        text: ["tests/mesh", "moving_bars.eng", "Turning"],
        duration: 20e-3,
        channels: &["across"],
    },
    Case {
        title: "Slider-crank with a flexible rod",
        text: ["tests/mesh", "moving_bars.eng", "Rod"],
        duration: 40e-3,
        channels: &["place"],
    },
];

/// Positions at each moment, number of steps, and the processor time of the steps (s).
type Run = (Vec<f64>, u64, f64);

#[derive(Clone, Copy, Default)]
struct Point {
    seconds: f64,
    steps: u64,
    error: f64,
}

fn main() -> Outcome<()> {
    let mut all = Vec::new();
    for case in &CASES {
        println!("{}", case.title);
        let found = curves(case)?;
        println!("  {:>33} {:>23}", NAMES[0], NAMES[1]);
        println!("  tolerance      ms   steps   error      ms   steps   error");
        for (k, tolerance) in TOLERANCES.iter().enumerate() {
            print!("  {tolerance:>9}");
            for points in &found {
                let p = points[k];
                let time = 1e3 * p.seconds;
                print!(" {time:>7.2} {:>7} {:>7.0e}", p.steps, p.error);
            }
            println!();
        }
        all.push((case.title, found));
    }
    let mut arguments = std::env::args().skip_while(|argument| argument != "--svg");
    if let Some(path) = arguments.nth(1) {
        std::fs::write(path, picture::drawn(&all)?)?;
    }
    Ok(())
}

fn curves(case: &Case) -> Outcome<Curves> {
    let [folder, file, name] = case.text;
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
    let checked = eng::check(&Sources::folder(folder)?, file);
    let model = checked.into_program()?.model(name)?;
    let (exact, ..) = run(&model, case, Method::Radau, StepControl::Tolerance(TIGHT))?;
    let fixed = |steps: f64| {
        let control = StepControl::Fixed(case.duration / steps);
        run(&model, case, Method::default(), control)
    };
    let ((coarse, ..), (fine, ..)) = (fixed(STEPS)?, fixed(2.0 * STEPS)?);
    let pairs = coarse.iter().zip(&fine);
    let extrapolated: Vec<f64> = pairs.map(|(a, b)| (4.0 * b - a) / 3.0).collect();
    println!("  reference: {:.0e}", error(&extrapolated, &exact));
    let mut found = Curves::default();
    for round in 0..RUNS {
        for (k, tolerance) in TOLERANCES.into_iter().enumerate() {
            let methods = [Method::default(), Method::Radau];
            for (method, points) in methods.into_iter().zip(&mut found) {
                let control = StepControl::Tolerance(tolerance);
                let (values, steps, seconds) = run(&model, case, method, control)?;
                let least = if round == 0 {
                    seconds
                } else {
                    points[k].seconds
                };
                points[k] = Point {
                    seconds: seconds.min(least),
                    steps,
                    error: error(&values, &exact),
                };
            }
        }
    }
    Ok(found)
}

fn run(model: &Model, case: &Case, method: Method, control: StepControl) -> Outcome<Run> {
    let channels = case.channels.iter().map(|path| model.channel(path));
    let channels = channels.collect::<Result<Vec<_>, _>>()?;
    let simulation = model.simulation().method(method).stepping(control);
    let mut simulation = simulation.start()?;
    let mut watch = simulation.watch(&channels)?;
    let mut values = vec![0.0; SAMPLES * channels.len()];
    let mut seconds = 0.0;
    for (k, sample) in values.chunks_exact_mut(channels.len()).enumerate() {
        let begin = now();
        simulation.advance(case.duration * (k + 1) as f64 / SAMPLES as f64)?;
        seconds += now() - begin;
        simulation.read(&mut watch, sample)?;
    }
    Ok((values, simulation.statistics().steps, seconds))
}

/// Processor time of this thread (s).
#[cfg(unix)]
fn now() -> f64 {
    let now = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
    now.tv_sec as f64 + 1e-9 * now.tv_nsec as f64
}

/// Time (s), where threads have no clock.
#[cfg(not(unix))]
fn now() -> f64 {
    let now = std::time::SystemTime::UNIX_EPOCH.elapsed();
    now.map_or(0.0, |time| time.as_secs_f64())
}

/// Greatest difference over the greatest value.
fn error(found: &[f64], exact: &[f64]) -> f64 {
    let size = exact.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    let misses = found.iter().zip(exact).map(|(a, b)| (a - b).abs());
    misses.fold(0.0, f64::max) / size
}
