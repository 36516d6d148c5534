//! Times of every stage on the four-cylinder examples, the rigid one and the paper's flexible one: text to
//! callable code, residual, Jacobian, factorisation, step, whole run.
//!
//! `cargo bench --bench pipeline`. Each result is the minimum and the median of several runs in this process. A run
//! also shows its real-time factor: its own time over the time in the model.

use eng::Sources;
use eng_runtime::linear::{BlockLu, LinearSolver};
use std::path::Path;
use std::time::{Duration, Instant};

type Outcome<T> = Result<T, Box<dyn std::error::Error>>;

/// Minimum and median of the time of `work` over some runs.
fn time(runs: usize, mut work: impl FnMut()) -> (Duration, Duration) {
    let mut times: Vec<Duration> = (0..runs)
        .map(|_| {
            let begin = Instant::now();
            work();
            begin.elapsed()
        })
        .collect();
    times.sort();
    (times[0], times[runs / 2])
}

fn show(name: &str, repeat: u32, (least, median): (Duration, Duration)) {
    println!(
        "{name:<46} {:>12.2} {:>12.2}",
        least.as_secs_f64() * 1e6 / f64::from(repeat),
        median.as_secs_f64() * 1e6 / f64::from(repeat),
    );
}

/// Fixed step of the figures a step (s).
const STEP: f64 = 1e-5;

fn main() -> Outcome<()> {
    println!("{:<46} {:>12} {:>12}", "µs a time", "minimum", "median");
    measure("inline4", "Inline4", &["unfired", "fired"])?;
    measure("paper", "PaperEngine", &["unfired", "fired"])
}

/// All figures of an example.
fn measure(example: &str, model: &str, analyses: &[&str]) -> Outcome<()> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("examples")
        .join(example);
    let sources = Sources::folder(&folder)?;
    let file = format!("{example}.eng");
    println!("{example}");

    show(
        "check: text to checked program",
        1,
        time(7, || {
            std::hint::black_box(eng::check(&sources, &file));
        }),
    );
    let program = eng::check(&sources, &file).into_program()?;
    show(
        "compile: checked program to machine code",
        1,
        time(7, || {
            let _ = std::hint::black_box(program.model(model));
        }),
    );
    let model = program.model(model)?;
    for (class, bytes) in model.code_bytes() {
        if bytes > 4000 {
            println!("  {class}: {bytes} bytes of code");
        }
    }

    show(
        "start: bind, assemble, first accelerations",
        1,
        time(5, || {
            let _ = std::hint::black_box(model.simulation().fixed_step(STEP).start());
        }),
    );
    let mut simulation = model.simulation().fixed_step(STEP).start()?;
    for _ in 0..1000 {
        simulation.step()?;
    }
    let runtime = simulation.runtime();
    let size = runtime.unknowns();
    let mut unknowns = vec![0.0; size];
    let mut residual = vec![0.0; size];
    runtime.predicted(STEP, &mut unknowns)?;
    show(
        "residual",
        200,
        time(21, || {
            for _ in 0..200 {
                let _ = runtime.residual(STEP, &unknowns, &mut residual);
            }
        }),
    );
    show(
        "residual and Jacobian",
        200,
        time(21, || {
            for _ in 0..200 {
                let _ = runtime.jacobian(STEP, &unknowns);
            }
        }),
    );
    let (pattern, values) = runtime.jacobian(STEP, &unknowns)?;
    let mut solver = BlockLu::new(pattern);
    println!("  {size} unknowns, {} entries", values.len());
    show(
        "factorisation",
        50,
        time(21, || {
            for _ in 0..50 {
                let _ = solver.factor(values);
            }
        }),
    );
    show(
        "solution of one right-hand side",
        200,
        time(21, || {
            for _ in 0..200 {
                solver.solve(&mut residual);
            }
        }),
    );
    show(
        "step of 10 µs, 1000 steps",
        1000,
        time(5, || {
            for _ in 0..1000 {
                let _ = simulation.step();
            }
        }),
    );

    let steps = (0.06 / STEP) as u32;
    let fixed = time(3, || {
        if let Ok(mut simulation) = model.simulation().fixed_step(STEP).start() {
            for _ in 0..steps {
                let _ = simulation.step();
            }
        }
    });
    show("60 ms in steps of 10 µs, with the start", 1, fixed);
    println!("  real-time factor {:.1}", fixed.1.as_secs_f64() / 0.06);

    for name in analyses {
        let analysis = program.analysis(name)?;
        let mut run = (0, 0.0);
        let whole = time(3, || {
            if let Ok(outcome) = analysis.run(&mut |_| {})
                && let Some(summary) = outcome.summary
            {
                run = (summary.statistics.steps, summary.time);
            }
        });
        let (steps, passed) = run;
        show(&format!("whole run `{name}`, {steps} steps"), 1, whole);
        println!("  real-time factor {:.1}", whole.1.as_secs_f64() / passed);
    }
    Ok(())
}
