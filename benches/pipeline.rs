//! Times of every stage on the four-cylinder example: text to callable code, residual, Jacobian, factorisation, step, whole run.
//!
//! `cargo bench --bench pipeline`. Each figure is the minimum and the median of several runs in this process.

use eng::Sources;
use eng_runtime::linear::{BlockLu, LinearSolver, PatternBuilder};
use std::time::{Duration, Instant};

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

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/inline4");
    let sources = Sources::folder(folder)?;
    println!("{:<46} {:>12} {:>12}", "µs a time", "minimum", "median");

    show(
        "check: text to checked program",
        1,
        time(7, || {
            std::hint::black_box(eng::check(&sources, "inline4.eng"));
        }),
    );
    let program = eng::check(&sources, "inline4.eng").into_program()?;
    show(
        "compile: checked program to machine code",
        1,
        time(7, || {
            let _ = std::hint::black_box(program.model("Inline4"));
        }),
    );
    let model = program.model("Inline4")?;
    for (class, bytes) in model.code_bytes() {
        if bytes > 4000 {
            println!("  {class}: {bytes} bytes of code");
        }
    }

    let step = 1e-5;
    show(
        "start: bind, assemble, first accelerations",
        1,
        time(5, || {
            let _ = std::hint::black_box(model.simulation().fixed_step(step).start());
        }),
    );
    let mut simulation = model.simulation().fixed_step(step).start()?;
    for _ in 0..1000 {
        simulation.step()?;
    }
    let runtime = simulation.runtime();
    let size = runtime.unknowns();
    let mut unknowns = vec![0.0; size];
    let mut residual = vec![0.0; size];
    runtime.predicted(step, &mut unknowns)?;
    show(
        "residual",
        200,
        time(21, || {
            for _ in 0..200 {
                let _ = runtime.residual(step, &unknowns, &mut residual);
            }
        }),
    );
    show(
        "residual and Jacobian",
        200,
        time(21, || {
            for _ in 0..200 {
                let _ = runtime.jacobian(step, &unknowns);
            }
        }),
    );
    let matrix = runtime.jacobian(step, &unknowns)?;
    let mut pattern = PatternBuilder::new(matrix.size);
    for column in 0..matrix.size {
        for k in matrix.columns[column]..matrix.columns[column + 1] {
            pattern.reserve(matrix.rows[k]..matrix.rows[k] + 1, column..column + 1);
        }
    }
    let pattern = pattern.finish();
    let mut solver = BlockLu::new(&pattern);
    println!("  {size} unknowns, {} entries", matrix.values.len());
    show(
        "factorisation",
        50,
        time(21, || {
            for _ in 0..50 {
                let _ = solver.factor(matrix.values);
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

    for name in ["unfired", "fired"] {
        let analysis = program.analysis(name)?;
        let mut steps = 0;
        let whole = time(3, || {
            if let Ok(outcome) = analysis.run(&mut |_| {})
                && let Some(summary) = outcome.summary
            {
                steps = summary.statistics.steps;
            }
        });
        show(
            &format!("whole run `{name}`, {steps} steps, 2881 samples"),
            1,
            whole,
        );
    }
    Ok(())
}
