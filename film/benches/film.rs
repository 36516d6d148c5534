//! Time of a solution and of its tangent: `cargo bench -p eng-film`. Least of many, µs, on one thread.

use eng_film::{Cavitation, Feed, Film, FilmSource, Inputs, Opening};
use std::time::Instant;

/// Least time of a call, µs.
fn least(mut call: impl FnMut()) -> f64 {
    let begin = Instant::now();
    let mut least = f64::INFINITY;
    while begin.elapsed().as_secs_f64() < 0.5 {
        let now = Instant::now();
        call();
        least = least.min(now.elapsed().as_secs_f64());
    }
    least * 1e6
}

/// A bearing of B/D 1/2 with a supply groove; of half width it is aligned.
fn film(rule: Cavitation, cells: [usize; 2], half: bool) -> Film {
    let mut source = FilmSource::plain(1.0, 1.0, 1.0, rule, cells);
    source.half_width = half;
    source.openings = vec![Opening {
        around: [2.8, 3.5],
        across: [-0.375, 0.375],
        feed: Feed::Pressure,
    }];
    Film::new(source).expect("a film")
}

fn main() {
    println!(
        "{:>10} {:>16} {:>10} {:>10} {:>10} {:>12}",
        "cells", "rule", "cold", "a step", "rounds", "tangent"
    );
    for (cells, half) in [([72, 7], true), ([72, 13], false), ([144, 25], false)] {
        for rule in [
            Cavitation::Reynolds,
            Cavitation::Half,
            Cavitation::MassConserving,
        ] {
            let film = film(rule, cells, half);
            let tilt = if half { 0.0 } else { 0.1 };
            // a degree of crank a step, as on a prescribed orbit
            let inputs = |turned: f64| {
                let (sin, cos) = turned.sin_cos();
                Inputs {
                    eccentricity: [0.8 * cos, 0.8 * sin],
                    rate: [-0.16 * sin, 0.16 * cos],
                    tilt: [tilt, -tilt],
                    spin: 1.0,
                    end_pressure: 0.02,
                    supply: &[0.2],
                    ..Inputs::still(1.0)
                }
                .write()
            };
            let (mut work, mut y) = (film.work(), vec![0.0; film.outputs()]);
            let mut memory = vec![1.0; film.memory()];
            film.start(&inputs(0.0), &mut work, &mut memory)
                .expect("a film");
            let cold = least(|| {
                film.forget(&mut work);
                film.solve(&inputs(0.0), None, &[], &mut work, &mut y)
                    .expect("a film");
            });
            let (mut turned, mut rounds, mut steps) = (0.0, 0, 0);
            let begin = Instant::now();
            while begin.elapsed().as_secs_f64() < 0.5 {
                turned += 0.2_f64.to_radians();
                film.solve(
                    &inputs(turned),
                    Some(1.0_f64.to_radians()),
                    &memory,
                    &mut work,
                    &mut y,
                )
                .expect("a film");
                film.accept(&work, &mut memory);
                rounds += film.summary(&work).rounds;
                steps += 1;
            }
            let step = begin.elapsed().as_secs_f64() / f64::from(steps) * 1e6;
            let mut tangent = vec![0.0; film.outputs() * film.inputs()];
            let slopes = least(|| film.tangent(&mut work, &mut tangent));
            let cells = format!("{} x {}", cells[0], cells[1]);
            let rounds = rounds as f64 / f64::from(steps);
            println!(
                "{cells:>10} {:>16} {cold:10.0} {step:10.0} {rounds:10.2} {slopes:12.0}",
                format!("{rule:?}")
            );
        }
    }
}
