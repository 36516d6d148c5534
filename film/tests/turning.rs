//! Openings of the pin, which turn over the cells: against openings of the shell, seen from the pin, and by
//! the balance of oil. The slopes of the factors and shares that they make.

use eng_film::internals::factors_and_shares;
use eng_film::{
    Cavitation, EdgeSlope, Feed, Film, FilmSource, Inputs, Opening, Part, Summary, inputs,
};
use std::f64::consts::TAU;

const CELLS: [usize; 2] = [48, 10];

/// Two openings that begin and end on lines of 48 equal cells while the pin has not turned.
fn openings(on: Part, turned: f64) -> Vec<Opening> {
    let cell = TAU / 48.0;
    let at = |from: f64, cells: f64, across: [f64; 2]| Opening {
        on,
        around: [from * cell + turned, (from + cells) * cell + turned],
        across,
        feed: Feed::Pressure,
    };
    vec![at(40.0, 3.0, [-0.12, 0.24]), at(11.0, 2.0, [-0.36, 0.0])]
}

fn source(rule: Cavitation, openings: Vec<Opening>, cells: [usize; 2]) -> FilmSource {
    let mut source = FilmSource::plain(1.0, 1.2, 1.0, rule, cells);
    source.openings = openings;
    source
}

/// The same with the slope of one cell at edges, which those of the pin always have.
fn alike(rule: Cavitation, openings: Vec<Opening>, cells: [usize; 2]) -> FilmSource {
    FilmSource {
        edges: EdgeSlope::OneCell,
        ..source(rule, openings, cells)
    }
}

/// A film of the pin's openings on lines that do not depend on them.
fn of_pin(rule: Cavitation, cells: [usize; 2]) -> Film {
    Film::new(alike(rule, openings(Part::Pin, 0.0), cells)).expect("a film")
}

const SUPPLY: [f64; 2] = [0.8, 0.35];

fn state<'a>(turn: f64) -> Inputs<'a> {
    Inputs {
        eccentricity: [-0.45, 0.3],
        rate: [0.12, 0.2],
        tilt: [0.1, 0.2],
        tilt_rate: [-0.05, 0.1],
        spin: 1.3,
        turn,
        end_pressure: 0.05,
        supply: &SUPPLY,
        ..Inputs::still(1.0)
    }
}

/// Outputs and results at inputs; with `filled` over a step from a film that is so full everywhere.
fn solved(film: &Film, x: &Inputs<'_>, filled: Option<f64>) -> (Vec<f64>, Summary, f64) {
    let (mut work, mut y) = (film.work(), vec![0.0; film.outputs()]);
    let memory = vec![filled.unwrap_or(1.0); film.memory()];
    film.solve(&x.write(), filled.map(|_| 0.05), &memory, &mut work, &mut y)
        .expect("a film");
    let summary = film.summary(&work);
    (y, summary, film.gathering(&work))
}

fn close(name: &str, found: f64, due: f64, size: f64, tolerance: f64) {
    let error = (found - due).abs() / size;
    assert!(error < tolerance, "{name}: {found} and {due}: {error:.1e}");
}

const RULES: [(Cavitation, Option<f64>); 3] = [
    (Cavitation::Reynolds, None),
    (Cavitation::Half, None),
    (Cavitation::MassConserving, Some(0.6)),
];

/// Where the edges lie on lines of the grid, an opening of the pin is one of the shell.
#[test]
fn on_the_lines_it_is_an_opening_of_the_shell() {
    for (rule, filled) in RULES {
        for cells_turned in [0.0, 7.0, 29.0] {
            let turn = cells_turned * TAU / 48.0;
            let pin = of_pin(rule, CELLS);
            let mut data = alike(rule, openings(Part::Shell, turn), CELLS);
            let lines = pin.lines().map(<[f64]>::to_vec);
            data.around = eng_film::Lines::At(lines[0].clone());
            data.across = eng_film::Lines::At(lines[1].clone());
            let shell = Film::new(data).expect("a film");
            let (a, results_a, gathered_a) = solved(&pin, &state(turn), filled);
            let (b, results_b, gathered_b) = solved(&shell, &state(turn), filled);
            for output in 0..a.len() {
                let size = b[output].abs().max(0.1);
                close(
                    &format!("{rule:?} {output}"),
                    a[output],
                    b[output],
                    size,
                    1e-6,
                );
            }
            // an opening of the pin fills the cells that it covers, one of the shell has filled them before
            let flows = [(results_a, gathered_a), (results_b, gathered_b)];
            let [found, due] =
                flows.map(|(r, gathered)| r.supply_flow.iter().sum::<f64>() - gathered);
            if rule == Cavitation::MassConserving {
                close("supply", found, due, 1.0, 1e-6);
            }
        }
    }
}

/// No oil flows through the gap from an opening to the end that it reaches over, on the pin as in the shell.
#[test]
fn over_an_end_it_is_an_opening_of_the_shell() {
    let cell = TAU / 48.0;
    let turn = 7.0 * cell;
    let over = |on: Part, from: f64| Opening {
        on,
        around: [from, from + 3.0 * cell],
        across: [-0.7, 0.24],
        feed: Feed::Pressure,
    };
    let rule = Cavitation::Reynolds;
    let pin = Film::new(alike(rule, vec![over(Part::Pin, 0.0)], CELLS)).expect("a film");
    let mut data = alike(rule, vec![over(Part::Shell, turn)], CELLS);
    data.around = eng_film::Lines::At(pin.lines()[0].to_vec());
    let shell = Film::new(data).expect("a film");
    let x = Inputs {
        supply: &SUPPLY[..1],
        ..state(turn)
    };
    let (a, ..) = solved(&pin, &x, None);
    let (b, ..) = solved(&shell, &x, None);
    for output in 0..a.len() {
        let size = b[output].abs().max(0.1);
        close(&format!("{output}"), a[output], b[output], size, 1e-6);
    }
}

/// Vector turned by an angle.
fn turned(v: [f64; 2], angle: f64) -> [f64; 2] {
    let (sin, cos) = angle.sin_cos();
    [v[0] * cos - v[1] * sin, v[0] * sin + v[1] * cos]
}

/// The state as the pin sees it: the shell turns around it.
fn seen_from_pin<'a>(x: &Inputs<'a>) -> Inputs<'a> {
    let back = |v: [f64; 2]| turned(v, -x.turn);
    let rate = |v: [f64; 2], dv: [f64; 2]| back([dv[0] + x.spin * v[1], dv[1] - x.spin * v[0]]);
    Inputs {
        eccentricity: back(x.eccentricity),
        rate: rate(x.eccentricity, x.rate),
        tilt: back(x.tilt),
        tilt_rate: rate(x.tilt, x.tilt_rate),
        spin: -x.spin,
        turn: 0.0,
        ..x.clone()
    }
}

/// Largest difference between a film whose pin has the openings and the same film seen from this pin, where
/// the openings rest: force, moment, torque, loss and side flow, over their sizes.
fn unlike(rule: Cavitation, cells: [usize; 2], turn: f64) -> f64 {
    let pin = of_pin(rule, cells);
    let resting = Film::new(alike(rule, openings(Part::Shell, 0.0), cells)).expect("a film");
    let x = state(turn);
    let (a, results, _) = solved(&pin, &x, None);
    let (b, _, _) = solved(&resting, &seen_from_pin(&x), None);
    let mut worst = 0.0_f64;
    for first in [inputs::FORCE, inputs::MOMENT] {
        let due = turned([b[first], b[first + 1]], turn);
        let error = (a[first] - due[0]).hypot(a[first + 1] - due[1]);
        worst = worst.max(error / due[0].hypot(due[1]));
    }
    // as seen from the pin the surfaces carry the oil the other way, so its torque has the shear with the other sign
    let torque = b[inputs::TORQUE] + 2.0 * results.shear_torque;
    worst = worst.max((a[inputs::TORQUE] - torque).abs() / torque.abs());
    for output in [inputs::LOSS, inputs::SIDE_FLOW] {
        worst = worst.max((a[output] - b[output]).abs() / b[output].abs());
    }
    worst
}

/// A pin with holes that turns in a resting shell is a shell with holes that turns around a resting pin.
#[test]
fn the_pin_sees_the_same_film() {
    for rule in [Cavitation::Reynolds, Cavitation::Half] {
        for cells_turned in [5.0, 22.0] {
            let error = unlike(rule, CELLS, cells_turned * TAU / 48.0);
            assert!(error < 1e-6, "{rule:?}: {error:.1e}");
        }
        // between the lines the error is that of the place of an edge, and falls with the size of the cells
        let worst = |cells: [usize; 2]| {
            let turns = (0..8).map(|k| (5.0 + f64::from(k) / 8.0) * TAU / 48.0);
            turns
                .map(|turn| unlike(rule, cells, turn))
                .fold(0.0, f64::max)
        };
        let errors = [1, 2, 4].map(|finer| worst(CELLS.map(|cells| cells * finer)));
        println!("{rule:?}, between the lines: {errors:.4?}");
        assert!(
            errors[2] < 0.5 * errors[0] && errors[2] < 0.02,
            "{errors:?}"
        );
    }
}

/// Oil that comes in by openings and ends gathers in the film or leaves at the ends.
#[test]
fn oil_is_conserved() {
    for turn in [0.0, 0.37, 1.01, 3.3] {
        let data = source(Cavitation::MassConserving, openings(Part::Pin, 0.0), CELLS);
        let film = Film::new(data).expect("a film");
        for filled in [0.3, 0.9] {
            let (_, results, gathered) = solved(&film, &state(turn), Some(filled));
            let came: f64 = results.supply_flow.iter().sum();
            let left: f64 = results.end_flow.iter().sum();
            assert!(
                (came - left - gathered).abs() < 1e-7,
                "{came} {left} {gathered}"
            );
            assert!(came > 0.1, "{came}");
        }
    }
}

/// The force changes steadily while an opening passes over the lines of the grid.
#[test]
fn no_line_of_the_grid_is_felt_as_a_jump() {
    let data = source(Cavitation::Reynolds, openings(Part::Pin, 0.0), CELLS);
    let film = Film::new(data).expect("a film");
    let cell = TAU / 48.0;
    let parts = 400;
    let at = |k: usize| solved(&film, &state(2.0 * cell * k as f64 / parts as f64), None).0;
    let forces: Vec<Vec<f64>> = (0..=parts).map(at).collect();
    let largest = forces[0][0].hypot(forces[0][1]);
    let steps: Vec<f64> = forces
        .windows(2)
        .map(|pair| (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1]) / largest)
        .collect();
    let most = steps.iter().fold(0.0_f64, |most, step| most.max(*step));
    println!("largest change of the force in 1/200 of a cell: {most:.1e}");
    assert!(most < 2e-3, "{most}");
    let bend = steps.windows(2).map(|pair| (pair[1] - pair[0]).abs());
    assert!(bend.fold(0.0, f64::max) < 4e-4);
}

/// A ring groove of the pin is one of the shell at every turn, and openings that no film can have are refused.
#[test]
fn ring_grooves_and_refusals() {
    let ring = |on| {
        let mut groove = Opening::ring_groove(0.0, TAU, 0.24, Feed::Pressure);
        groove.on = on;
        source(Cavitation::Reynolds, vec![groove], CELLS)
    };
    // a groove of the shell has one cell, which leaves more for its lands
    let lines = Film::new(ring(Part::Pin)).expect("a film").lines()[1].to_vec();
    let groove = |on| {
        let mut source = ring(on);
        source.across = eng_film::Lines::At(lines.clone());
        Film::new(source).expect("a film")
    };
    let x = Inputs {
        supply: &SUPPLY[..1],
        ..state(0.77)
    };
    let [(a, ..), (b, ..)] = [Part::Pin, Part::Shell].map(|on| solved(&groove(on), &x, None));
    for (a, b) in a.iter().zip(&b) {
        close("ring groove", *a, *b, b.abs().max(0.1), 1e-6);
    }
    let refused = |change: &dyn Fn(&mut Opening)| {
        let mut opening = Opening::hole(0.3, 0.0, 0.1, 1.0, Feed::Pressure);
        opening.on = Part::Pin;
        change(&mut opening);
        let source = source(Cavitation::MassConserving, vec![opening], CELLS);
        Film::new(source).expect_err("no film").to_string()
    };
    for text in [
        refused(&|opening| opening.around[1] = opening.around[0]),
        refused(&|opening| opening.feed = Feed::Content(0.5)),
    ] {
        assert!(text.contains("opening 1 of a film is on the pin"), "{text}");
    }
    let text = refused(&|opening| {
        opening.around = [0.0, TAU];
        opening.across = [-1.0, 1.0];
    });
    assert!(text.contains("cover the whole bearing"), "{text}");
    // nothing pushes oil out of an opening of the pin without pressure
    let film = of_pin(Cavitation::MassConserving, CELLS);
    let x = Inputs {
        supply: &[0.0, 0.0],
        end_pressure: 0.0,
        ..state(0.0)
    };
    let (mut work, mut y) = (film.work(), vec![0.0; film.outputs()]);
    let dry = film.solve(&x.write(), None, &[], &mut work, &mut y);
    assert!(dry.is_err_and(|error| error.to_string().contains("needs oil")));
}

/// The factors of all links, and the shares of all cells, over a turn.
#[test]
fn slopes_are_those_of_factors_and_shares() {
    let mut source = FilmSource::plain(1.0, 1.0, 1.0, Cavitation::Reynolds, [24, 5]);
    source.openings = [[0.31, 0.83], [1.6, 1.7]]
        .map(|around| Opening {
            on: Part::Pin,
            around,
            across: [-0.3, 0.3],
            feed: Feed::Pressure,
        })
        .to_vec();
    let film = Film::new(source).unwrap();
    let mut work = film.work();
    let mut at = |turn: f64| {
        let x = Inputs {
            turn,
            supply: &[1.0, 1.0],
            ..Inputs::still(1.0)
        };
        factors_and_shares(&film, &mut work, &x.write())
    };
    let step = 1e-6;
    let mut moving = 0;
    // the second opening is narrower than a cell, and ends on a line of the grid after the first turn
    for turn in [TAU / 24.0 * 8.0 - 1.7, 1.03, 4.2, -2.0] {
        let [down, middle, up] = [-step, 0.0, step].map(|shift| at(turn + shift));
        let covered: f64 = middle[1].iter().map(|covered| covered[0]).sum();
        let [down, middle, up] = [down, middle, up].map(|state| state.concat());
        for ((down, middle), up) in down.iter().zip(&middle).zip(&up) {
            let slope = (up[0] - down[0]) / (2.0 * step);
            // where an edge lies on a line, the slope has a bend, which the differences see
            let error = (slope - middle[1]).abs();
            assert!(error < 1e-3 * slope.abs().max(1.0), "{slope} {}", middle[1]);
            moving += usize::from(slope != 0.0);
        }
        assert!(
            (covered * TAU / 24.0 / 3.0 - 0.62).abs() < 0.05,
            "{covered}"
        );
    }
    assert!(moving > 20, "{moving}");
}
