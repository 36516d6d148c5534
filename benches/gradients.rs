//! Processor time of gradients, in runs: the fired four-cylinder with one parameter, with four, and without, in turns.
//!
//! `cargo bench --bench gradients`. Each figure is the median of the ratios of neighbours: of the whole, and of the start, the
//! steps and the samples as shares of the run without gradients.

use eng::{Analysis, Sources};
use std::path::Path;

type Outcome<T> = Result<T, Box<dyn std::error::Error>>;

/// Rounds of runs.
const ROUNDS: usize = 5;
const PARAMETERS: [&str; 4] = [
    "main[3].radial_clearance",
    "oil_temperature",
    "combustion",
    "flywheel_mass",
];

/// The whole, start, steps and samples (s).
fn seconds(analysis: &Analysis) -> Outcome<[f64; 4]> {
    let outcome = analysis.run(&mut |_| {}).map_err(|failed| failed.error)?;
    let spent = outcome.timings.ok_or("an analysis without timings")?;
    let [start, steps, samples] =
        [spent.start, spent.steps, spent.samples].map(|phase| phase.as_secs_f64());
    Ok([start + steps + samples, start, steps, samples])
}

fn median(mut numbers: Vec<f64>) -> f64 {
    numbers.sort_by(f64::total_cmp);
    numbers[numbers.len() / 2]
}

fn main() -> Outcome<()> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/inline4");
    let read = |name: &str| std::fs::read_to_string(folder.join(name));
    let mut text = read("by_hand.eng")?;
    let samples = [("fine", "0.5 deg"), ("coarse", "5 deg")];
    for (name, sample) in samples {
        text += &format!(
            "\nanalysis {name} = transient(Inline4(), duration: 2 rev, sample: {sample})\n"
        );
    }
    let sources = Sources::from_texts([
        ("m.eng".to_owned(), text),
        ("pressure.csv".to_owned(), read("pressure.csv")?),
    ]);
    let program = eng::check(&sources, "m.eng").into_program()?;
    for (name, sample) in samples {
        let plain = program.analysis(name)?.timed();
        let cases = [1, PARAMETERS.len()].map(|count| (count, PARAMETERS.get(..count)));
        for (count, parameters) in cases {
            let with = plain.clone().gradients(parameters.unwrap_or_default())?;
            let mut ratios = [const { Vec::new() }; 4];
            let mut runs = Vec::new();
            for _ in 0..ROUNDS {
                let (without, with) = (seconds(&plain)?, seconds(&with)?);
                runs.push(without[0]);
                for (ratios, (a, b)) in ratios.iter_mut().zip(without.iter().zip(with)) {
                    ratios.push((b - a) / without[0] / count as f64);
                }
            }
            let [whole, start, steps, samples] = ratios.map(median);
            println!(
                "samples at {sample}, {count} parameters, a run of {:.2} s: each takes {whole:.2} runs more (start {start:.2}, steps \
                 {steps:.2}, samples {samples:.2})",
                median(runs)
            );
        }
    }
    Ok(())
}
