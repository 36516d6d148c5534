//! Time of a solution and of its tangent: `cargo bench -p eng-film`. Least of many, µs, on one thread. `-- elastic`
//! runs the orbit in an elastic bore alone.

use eng_film::{
    Accuracy, Cavitation, Elastic, ElasticRing, ElasticWork, Feed, Film, FilmSource, Inputs,
    Opening, Part, Roughness, Shape, Thinning, inputs,
};
use std::time::Instant;

/// Steps of the orbit.
const STEPS: usize = 150;

/// Turn of the pin's centre within a step, rad.
const TURN: f64 = 0.2 * std::f64::consts::PI / 180.0;

/// The outputs that loads read: force, moment and torque.
const LOADS: [bool; inputs::SHAPE_FORCE] = [true, true, true, true, true, false, false];

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

/// A ring whose ovality yields by a tenth of the clearance, in units of R = c = μ = ω = 1.
fn soft_ring() -> ElasticRing {
    ElasticRing {
        thickness: 0.775,
        width: 1.29,
        modulus: 33.0,
        poisson: 0.3,
    }
}

/// A bearing of B/D 1/2 with a supply groove; of half width it is aligned.
fn film(rule: Cavitation, cells: [usize; 2], half: bool) -> Film {
    let mut source = FilmSource::plain(1.0, 1.0, 1.0, rule, cells);
    source.half_width = half;
    source.openings = vec![Opening {
        on: Part::Shell,
        around: [2.8, 3.5],
        across: [-0.375, 0.375],
        feed: Feed::Pressure,
    }];
    Film::new(source).expect("a film")
}

fn main() {
    if std::env::args().any(|argument| argument == "elastic") {
        return elastic_orbit();
    }
    println!(
        "{:>10} {:>16} {:>10} {:>10} {:>10} {:>10} {:>10} {:>10}",
        "cells", "rule", "cold", "a step", "rounds", "again", "tangent", "of loads"
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
            // the same steps several times: the least time of each
            let (mut steps, mut rounds) = ([f64::INFINITY; STEPS], 0);
            let (first, begin) = (memory.clone(), Instant::now());
            while begin.elapsed().as_secs_f64() < 1.0 {
                memory.copy_from_slice(&first);
                film.forget(&mut work);
                film.solve(&inputs(0.0), None, &[], &mut work, &mut y)
                    .expect("a film");
                rounds = 0;
                for (step, least) in steps.iter_mut().enumerate() {
                    let x = inputs((step as f64 + 1.0) * TURN);
                    let now = Instant::now();
                    film.solve(&x, Some(5.0 * TURN), &memory, &mut work, &mut y)
                        .expect("a film");
                    *least = least.min(now.elapsed().as_secs_f64());
                    film.accept(&work, &mut memory);
                    rounds += film.summary(&work).rounds;
                }
            }
            let step = steps.iter().sum::<f64>() / STEPS as f64 * 1e6;
            let rounds = rounds as f64 / STEPS as f64;
            // as in Newton's iterations: nearly the same gap, mostly with the same cavity
            let near = [0.0, 1e-6].map(|moved| {
                let mut x = inputs(STEPS as f64 * TURN);
                x[0] += moved;
                x
            });
            let mut call = 0;
            let again = least(|| {
                call += 1;
                film.solve(
                    &near[call % 2],
                    Some(5.0 * TURN),
                    &memory,
                    &mut work,
                    &mut y,
                )
                .expect("a film");
            });
            let mut tangent = vec![0.0; film.outputs() * film.inputs()];
            let slopes = least(|| film.tangent(&mut work, &mut tangent));
            let loads = least(|| film.tangent_of(&LOADS, &mut work, &mut tangent));
            let cells = format!("{} x {}", cells[0], cells[1]);
            println!(
                "{cells:>10} {:>16} {cold:10.0} {step:10.0} {rounds:10.2} {again:10.0} {slopes:10.0} {loads:10.0}",
                format!("{rule:?}")
            );
        }
    }
    surfaces();
    elastic_orbit();
}

/// Rough surfaces with thinning oil, and elastic surfaces of waves up to 8, on 72 × 13 cells: the same gap again.
fn surfaces() {
    println!(
        "\n{:>10} {:>16} {:>10} {:>10}",
        "cells", "surface", "again", "tangent"
    );
    let source = |rough: bool, waves: u32, degree: u32| {
        let mut source = film(Cavitation::Reynolds, [72, 13], false).source().clone();
        if rough {
            source.rough = Some(Roughness {
                deviation: 0.02,
                direction: 1.0,
                asperity: 1.0,
                modulus: 33.0,
                friction: 0.1,
            });
            source.thinning = Some(Thinning {
                second: 0.5,
                rate: 5.0,
                exponent: 0.8,
            });
        }
        let shape = |around, sine, across| Shape {
            around,
            sine,
            across,
        };
        source.shapes = (0..=degree)
            .flat_map(|l| (2..=waves).flat_map(move |k| [shape(k, false, l), shape(k, true, l)]))
            .collect();
        source
    };
    for (name, rough, waves, degree) in [
        ("plain", false, 0, 0),
        ("rough", true, 0, 0),
        ("14 shapes", false, 8, 0),
        ("42 shapes", false, 8, 2),
    ] {
        let film = Film::new(source(rough, waves, degree)).expect("a film");
        let compliance = soft_ring().compliance(&film);
        let elastic = Elastic::new(film, compliance).expect("a surface");
        let (mut work, mut y) = (elastic.work(), [0.0; inputs::SHAPE_FORCE]);
        let near = [0.0, 1e-6].map(|moved| {
            Inputs {
                eccentricity: [0.8 + moved, 0.1],
                rate: [-0.16, 0.1],
                tilt: [0.1, -0.1],
                spin: 1.0,
                end_pressure: 0.02,
                supply: &[0.2],
                ..Inputs::still(1.0)
            }
            .write()
        });
        let mut call = 0;
        let memory = vec![0.0; elastic.memory()];
        let mut solve = |work: &mut ElasticWork| {
            call += 1;
            let near = &near[call % 2];
            elastic
                .solve(near, Some(0.1), &memory, Accuracy::Full, work, &mut y)
                .expect("a film");
        };
        let again = least(|| solve(&mut work));
        let mut tangent = vec![0.0; inputs::SHAPE_FORCE * elastic.inputs()];
        let slopes = least(|| {
            // at a new solution: derivatives of the last one are kept
            solve(&mut work);
            elastic.tangent(&mut work, &mut tangent).expect("a tangent");
        });
        println!(
            "{:>10} {name:>16} {again:10.0} {:10.0}",
            "72 x 13",
            slopes - again
        );
    }
}

/// Steps of a loaded orbit in a bore of 51 shapes, five solutions each as in Newton's iterations: from an
/// error of a thousandth of the clearance down to 2e-9 of it.
fn elastic_orbit() {
    let (width, clearance, speed, step): (f64, f64, f64, f64) = (20e-3, 27e-6, 419.0, 2.2e-5);
    let mut source = FilmSource::plain(58e-3, width, clearance, Cavitation::Reynolds, [72, 13]);
    source.floor = 1e-3 * clearance;
    let shape = |around, sine, across| Shape {
        around,
        sine,
        across,
    };
    source.shapes = (0..=2)
        .flat_map(|l| {
            let waves = (1..=8).flat_map(move |k| [shape(k, false, l), shape(k, true, l)]);
            std::iter::once(shape(0, false, l)).chain(waves)
        })
        .collect();
    let shapes = source.shapes.clone();
    let film = Film::new(source).expect("a film");
    // a soft ring of aluminium, and the yielding of its face
    let mut compliance = ElasticRing {
        thickness: 8e-3,
        width: 25e-3,
        modulus: 110e9,
        poisson: 0.3,
    }
    .compliance(&film);
    for (at, shape) in shapes.iter().enumerate() {
        let face = 3e-10 / f64::from((1 + shape.around) * (1 + shape.across));
        let own = &mut compliance[at * shapes.len() + at];
        *own = 0.3 * *own + face;
    }
    let elastic = Elastic::new(film, compliance).expect("a surface");
    let inputs = |time: f64, off: f64| {
        let (sin, cos) = (speed * time / 2.0).sin_cos();
        let (swing, swung) = (1.7 * speed * time).sin_cos();
        let (ratio, opens) = (0.9 + 0.25 * swing + off, 0.25 * 1.7 * speed * swung);
        let (turns, moved) = (ratio * speed / 2.0, off * clearance / step);
        Inputs {
            eccentricity: [ratio * clearance * cos, ratio * clearance * sin],
            rate: [
                clearance * (opens * cos - turns * sin) + moved,
                clearance * (opens * sin + turns * cos) + moved,
            ],
            tilt: [1e-4 * cos, -1e-4],
            spin: speed,
            ..Inputs::still(8e-3)
        }
        .write()
    };
    let (mut work, mut y) = (elastic.work(), vec![0.0; elastic.outputs()]);
    let mut memory = vec![0.0; elastic.memory()];
    elastic
        .solve(
            &inputs(0.0, 0.0),
            None,
            &[],
            Accuracy::Full,
            &mut work,
            &mut y,
        )
        .expect("a film");
    elastic.accept(&work, &mut memory);
    let (mut rounds, begin) = (0, Instant::now());
    for k in 1..=STEPS {
        for off in [1e-3, 1e-4, 3e-6, 1e-7, 2e-9] {
            let x = inputs(step * k as f64, off);
            elastic
                .solve(
                    &x,
                    Some(step),
                    &memory,
                    Accuracy::Iterate,
                    &mut work,
                    &mut y,
                )
                .expect("a film");
            rounds += work.rounds;
        }
        elastic.accept(&work, &mut memory);
    }
    println!(
        "\norbit with 51 elastic shapes: {:.1} solutions of the film a step, {:.1} ms",
        rounds as f64 / STEPS as f64,
        begin.elapsed().as_secs_f64() * 1e3 / STEPS as f64
    );
}
