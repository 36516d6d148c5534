//! Laws that every solution obeys on every grid: energy, mass, whirl, symmetry, objectivity, no
//! allocation.

use crate::states::{Solved, solved};
use eng_film::{
    Beside, Cavitation, Feed, Film, FilmError, FilmSource, Inputs, Lines, Opening, Part, Profile,
    Shape, inputs,
};
use proptest::prelude::*;

const RULES: [Cavitation; 3] = [
    Cavitation::Reynolds,
    Cavitation::Half,
    Cavitation::MassConserving,
];

/// Power of the shaft and of the supply minus the loss, relative to the shear.
fn unbalanced(solved: &Solved, shapes: usize) -> f64 {
    let (x, y, summary) = (&solved.inputs, &solved.outputs, &solved.summary);
    let openings = x.len() - 12 - 2 * shapes;
    let first = 12 + openings + shapes;
    let moved: f64 = (0..shapes)
        .map(|shape| y[inputs::SHAPE_FORCE + shape] * x[first + shape])
        .sum();
    // −F·ė − M·(ẑ × ṫ) + T ω: the tilt rate ṫ is the angular velocity (−ṫ_y, ṫ_x); a deflection that rises
    // takes power out
    let shaft = -y[0] * x[2] - y[1] * x[3] + y[2] * x[7] - y[3] * x[6] + y[4] * x[8] - moved;
    (shaft + summary.pumping_power - y[inputs::LOSS]) / summary.shear_power
}

fn grooved(rule: Cavitation, cells: [usize; 2]) -> FilmSource {
    let mut source = FilmSource::plain(1.0, 1.2, 1.0, rule, cells);
    source.openings = vec![
        Opening {
            on: Part::Shell,
            around: [2.6, 3.3],
            across: [-0.3, 0.35],
            feed: Feed::Pressure,
        },
        Opening {
            on: Part::Shell,
            around: [5.0, 5.0],
            across: [-1.0, 1.0],
            feed: Feed::Pressure,
        },
    ];
    source
}

fn tilting<'a>() -> Inputs<'a> {
    Inputs {
        eccentricity: [0.4, 0.2],
        rate: [0.05, -0.1],
        tilt: [0.2, -0.3],
        tilt_rate: [0.05, 0.1],
        spin: 0.9,
        turn: 0.3,
        end_pressure: 0.1,
        supply: &[0.5, 0.2],
        ..Inputs::still(1.3)
    }
}

#[test]
fn energy_is_conserved() {
    let mut source = grooved(Cavitation::Reynolds, [36, 8]);
    source.profile = vec![
        Profile::Lemon {
            depth: 0.1,
            at: 0.4,
        },
        Profile::Relief {
            depth: 0.1,
            around: 0.4,
            at: 1.5,
        },
    ];
    source.pin_profile = vec![
        Profile::Lemon {
            depth: 0.05,
            at: 0.2,
        },
        Profile::Barrel { depth: 0.1 },
    ];
    source.shapes = vec![Shape {
        around: 2,
        sine: true,
        across: 1,
    }];
    let inputs = Inputs {
        deflection: &[0.05],
        deflection_rate: &[0.1],
        ..tilting()
    };
    // of the rule `reynolds` the discrete equations, multiplied by the pressure and summed, are the balance
    // itself
    let found = unbalanced(&solved(source, inputs.write()).expect("a film"), 1);
    assert!(found.abs() < 1e-13, "reynolds: {found:e}");
    // where content begins and ends, flow changes within a cell: the balance is one of the cell's size
    let error = |cells| {
        unbalanced(
            &solved(
                grooved(Cavitation::MassConserving, cells),
                tilting().write(),
            )
            .expect("a film"),
            0,
        )
        .abs()
    };
    let errors = [error([48, 10]), error([96, 20]), error([192, 40])];
    println!("energy, mass conserving: {errors:?}");
    assert!(
        errors[0] < 5e-3 && errors[2] < errors[0] / 3.5,
        "{errors:?}"
    );
}

#[test]
fn oil_is_conserved() {
    let of = |solved: &Solved| {
        let supply: f64 = solved.summary.supply_flow.iter().sum();
        (supply - solved.summary.end_flow[0] - solved.summary.end_flow[1]) / solved.summary.outflow
    };
    // only the spin moves the film: the flow from the openings leaves at the ends
    let still = Inputs {
        rate: [0.0; 2],
        tilt_rate: [0.0; 2],
        ..tilting()
    };
    let steady =
        solved(grooved(Cavitation::MassConserving, [48, 10]), still.write()).expect("a film");
    assert!(of(&steady).abs() < 1e-10, "{:e}", of(&steady));
    let source = FilmSource::plain(1.0, 1.0, 1.0, Cavitation::MassConserving, [48, 10]);
    let flooded = Inputs {
        eccentricity: [0.7, 0.0],
        spin: 1.0,
        end_pressure: 0.2,
        ..Inputs::still(1.0)
    };
    let flooded = solved(source, flooded.write()).expect("a film").summary;
    assert!(
        (flooded.inflow - flooded.outflow).abs() < 1e-10 * flooded.outflow
            && flooded.cavitated > 0.05
    );
}

#[test]
fn whirl_at_half_the_spin_has_no_force() {
    for rule in [Cavitation::Reynolds, Cavitation::Half] {
        let mut source = FilmSource::plain(1.0, 1.0, 1.0, rule, [30, 6]);
        source.profile = vec![Profile::Barrel { depth: 0.2 }];
        let (e, spin) = ([0.5, 0.3], 0.8);
        let inputs = Inputs {
            eccentricity: e,
            rate: [-spin / 2.0 * e[1], spin / 2.0 * e[0]],
            spin,
            ..Inputs::still(1.0)
        };
        let whirl = solved(source, inputs.write()).expect("a film");
        assert!(
            whirl.outputs[..4].iter().all(|output| output.abs() < 1e-13),
            "{:?}",
            whirl.outputs
        );
    }
    // content that fills the gap goes with the whirl: no cavity begins, and no pressure
    let mut source = FilmSource::plain(1.0, 1.0, 1.0, Cavitation::MassConserving, [30, 6]);
    source.profile = vec![Profile::Barrel { depth: 0.2 }];
    let film = Film::new(source).expect("a film");
    let (mut work, mut y) = (film.work(), vec![0.0; film.outputs()]);
    let mut memory = vec![1.0; film.memory()];
    for step in 1..=20 {
        let (sin, cos) = (0.4 * 0.05 * f64::from(step)).sin_cos();
        let e = [0.5 * cos - 0.3 * sin, 0.5 * sin + 0.3 * cos];
        let inputs = Inputs {
            eccentricity: e,
            rate: [-0.4 * e[1], 0.4 * e[0]],
            spin: 0.8,
            ..Inputs::still(1.0)
        };
        film.solve(&inputs.write(), Some(0.05), &memory, &mut work, &mut y)
            .expect("a film");
        film.accept(&work, &mut memory);
        assert!(y[..4].iter().all(|output| output.abs() < 1e-12), "{y:?}");
        assert!(memory.iter().all(|content| (content - 1.0).abs() < 1e-12));
    }
}

#[test]
fn mirrored_tilt_mirrors_the_moment() {
    for rule in RULES {
        let with = |sign: f64| {
            let base = tilting();
            let inputs = Inputs {
                tilt: base.tilt.map(|t| t * sign),
                tilt_rate: base.tilt_rate.map(|t| t * sign),
                ..base
            };
            let mut source = grooved(rule, [36, 8]);
            source.openings[0].across = [-0.3, 0.3];
            solved(source, inputs.write()).expect("a film").outputs
        };
        let (one, other) = (with(1.0), with(-1.0));
        for (output, sign) in [1.0, 1.0, -1.0, -1.0, 1.0].iter().enumerate() {
            assert!(
                (one[output] - sign * other[output]).abs() < 1e-11,
                "{rule:?} {output}"
            );
        }
    }
}

#[test]
fn a_turned_bearing_turns_its_force() {
    // by cells: openings, place and rates turned by five of 48 cells
    for rule in RULES {
        let turned = |cells: f64| {
            let angle = cells * std::f64::consts::TAU / 48.0;
            let turn = |v: [f64; 2]| {
                [
                    v[0] * angle.cos() - v[1] * angle.sin(),
                    v[0] * angle.sin() + v[1] * angle.cos(),
                ]
            };
            let mut source = FilmSource::plain(1.0, 1.2, 1.0, rule, [48, 8]);
            let edge = |cell: f64| (cell + cells) * std::f64::consts::TAU / 48.0;
            source.openings = vec![Opening {
                on: Part::Shell,
                around: [edge(20.0), edge(25.0)],
                across: [-0.3, 0.3],
                feed: Feed::Pressure,
            }];
            let base = tilting();
            let inputs = Inputs {
                eccentricity: turn(base.eccentricity),
                rate: turn(base.rate),
                tilt: turn(base.tilt),
                tilt_rate: turn(base.tilt_rate),
                supply: &[0.5],
                ..base
            };
            let y = solved(source, inputs.write()).expect("a film").outputs;
            let back = |v: [f64; 2]| {
                [
                    v[0] * angle.cos() + v[1] * angle.sin(),
                    v[1] * angle.cos() - v[0] * angle.sin(),
                ]
            };
            [back([y[0], y[1]]), back([y[2], y[3]]), [y[4], 0.0]].concat()
        };
        let (one, other) = (turned(0.0), turned(5.0));
        assert!(
            one.iter().zip(&other).all(|(a, b)| (a - b).abs() < 1e-11),
            "{rule:?}: {one:?} {other:?}"
        );
    }
}

#[test]
fn units_do_not_matter() {
    // a main bearing of an engine in SI is the film with R = c = μ = ω = 1
    let (radius, clearance, viscosity, spin) = (27e-3, 27e-6, 8e-3, 400.0);
    let plain = Inputs {
        eccentricity: [0.8, 0.1],
        rate: [0.1, 0.0],
        spin: 1.0,
        ..Inputs::still(1.0)
    };
    let one = solved(
        FilmSource::plain(1.0, 0.9, 1.0, Cavitation::Reynolds, [72, 12]),
        plain.write(),
    )
    .expect("a film");
    let real = Inputs {
        eccentricity: [0.8 * clearance, 0.1 * clearance],
        rate: [0.1 * clearance * spin, 0.0],
        spin,
        ..Inputs::still(viscosity)
    };
    let source = FilmSource::plain(
        radius,
        0.9 * radius,
        clearance,
        Cavitation::Reynolds,
        [72, 12],
    );
    let other = solved(source, real.write()).expect("a film");
    let pressure = viscosity * spin * radius * radius / (clearance * clearance);
    let force = pressure * radius * radius;
    assert!((other.outputs[0] / force / one.outputs[0] - 1.0).abs() < 1e-10);
    assert!((other.outputs[1] / force / one.outputs[1] - 1.0).abs() < 1e-10);
    assert!((other.outputs[4] / (force * clearance) / one.outputs[4] - 1.0).abs() < 1e-10);
    assert!(
        (other.summary.maximum_pressure / pressure / one.summary.maximum_pressure - 1.0).abs()
            < 1e-10
    );
    assert!((other.summary.minimum_gap / clearance / one.summary.minimum_gap - 1.0).abs() < 1e-10);
}

#[test]
fn a_solution_allocates_nothing() {
    for rule in RULES {
        let mut source = grooved(rule, [36, 8]);
        source.shapes = vec![Shape {
            around: 2,
            sine: false,
            across: 0,
        }];
        source.pin_profile = vec![Profile::Lemon {
            depth: 0.05,
            at: 0.2,
        }];
        let film = Film::new(source).expect("a film");
        let x = Inputs {
            deflection: &[0.05],
            deflection_rate: &[0.1],
            ..tilting()
        }
        .write();
        let mut memory = vec![1.0; film.memory()];
        let (mut work, mut y) = (film.work(), vec![0.0; film.outputs()]);
        let mut tangent = vec![0.0; film.outputs() * film.inputs()];
        let counted = allocation_counter::measure(|| {
            for _ in 0..3 {
                film.solve(&x, Some(0.05), &memory, &mut work, &mut y)
                    .expect("a film");
                film.tangent(&mut work, &mut tangent);
                film.accept(&work, &mut memory);
            }
        });
        assert_eq!(counted.count_total, 0, "{rule:?}");
    }
}

#[test]
fn profiles_move_the_surface() {
    // a bore beside the axis is an eccentricity the other way; a profile of the pin turns with it
    let plain = |e: [f64; 2], profile: Vec<Profile>, pin: Vec<Profile>, turn: f64| {
        let mut source = FilmSource::plain(1.0, 1.0, 1.0, Cavitation::Reynolds, [48, 8]);
        (source.profile, source.pin_profile) = (profile, pin);
        let inputs = Inputs {
            eccentricity: e,
            spin: 1.0,
            turn,
            ..Inputs::still(1.0)
        };
        solved(source, inputs.write()).expect("a film")
    };
    let moved = plain(
        [0.3, 0.0],
        vec![Profile::Offset {
            distance: 0.2,
            at: 1.0,
        }],
        vec![],
        0.0,
    );
    let same = plain(
        [0.3 - 0.2 * 1.0_f64.cos(), -0.2 * 1.0_f64.sin()],
        vec![],
        vec![],
        0.0,
    );
    assert!(
        (moved.outputs[0] - same.outputs[0]).abs() < 1e-12
            && (moved.outputs[1] - same.outputs[1]).abs() < 1e-12
    );
    assert!((moved.summary.minimum_gap - same.summary.minimum_gap).abs() < 2e-3);
    // the pin's offset by φ = 0.7 is a place at its angle that whirls with the full spin
    let offset = Profile::Offset {
        distance: 0.2,
        at: 0.3,
    };
    let turning = plain([0.3, 0.0], vec![], vec![offset], 0.7);
    let (sin, cos) = 1.0_f64.sin_cos();
    let mut source = FilmSource::plain(1.0, 1.0, 1.0, Cavitation::Reynolds, [48, 8]);
    source.clearance = 1.0;
    let whirling = Inputs {
        eccentricity: [0.3 - 0.2 * cos, -0.2 * sin],
        rate: [0.2 * sin, -0.2 * cos],
        spin: 1.0,
        ..Inputs::still(1.0)
    };
    let whirling = solved(source, whirling.write()).expect("a film");
    for axis in [0, 1] {
        assert!((turning.outputs[axis] - whirling.outputs[axis]).abs() < 1e-12);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    /// Every pose and motion has a solution, and the search finds the same one from every earlier cavity.
    #[test]
    fn every_state_is_solved(
        ratio in 0.0..0.99_f64, angle in 0.0..6.3_f64, tilt in 0.0..0.9_f64, tilt_angle in 0.0..6.3_f64,
        rate in prop::array::uniform2(-0.5..0.5_f64), tilt_rate in prop::array::uniform2(-0.3..0.3_f64),
        step in 0.001..0.2_f64, groove in 0.0..6.0_f64, content in prop::collection::vec(0.0..1.0_f64, 36*8), spin in -1.0..1.0_f64,
    ) {
        let reach = tilt*(1.0 - ratio)/0.5;
        let inputs = Inputs {
            eccentricity: [ratio*angle.cos(), ratio*angle.sin()],
            rate: rate.map(|rate| rate*(1.0 - ratio)),
            tilt: [reach*tilt_angle.cos(), reach*tilt_angle.sin()],
            tilt_rate: tilt_rate.map(|rate| rate*(1.0 - ratio)*(1.0 - tilt)),
            spin,
            supply: &[0.3],
            ..Inputs::still(1.0)
        };
        let x = inputs.write();
        for rule in [Cavitation::Reynolds, Cavitation::MassConserving] {
            let mut source = FilmSource::plain(1.0, 1.0, 1.0, rule, [36, 8]);
            source.openings = vec![Opening { on: Part::Shell, around: [groove, groove + 0.4], across: [-0.2, 0.2], feed: Feed::Pressure }];
            let film = Film::new(source).expect("a film");
            let memory = &content[..film.memory()];
            let solve = |work: &mut eng_film::Work| {
                let mut y = vec![0.0; film.outputs()];
                film.solve(&x, Some(step), memory, work, &mut y).map(|()| y)
            };
            let mut warm = film.work();
            let other = Inputs { eccentricity: [-0.5, 0.4], spin: 1.0, supply: &[0.1], ..Inputs::still(1.0) }.write();
            let mut y = vec![0.0; film.outputs()];
            film.solve(&other, Some(step), memory, &mut warm, &mut y).expect("a film");
            let (cold, warm) = (solve(&mut film.work()).expect("cold"), solve(&mut warm).expect("warm"));
            let size = cold.iter().fold(1e-3_f64, |size, number| size.max(number.abs()));
            prop_assert!(cold.iter().zip(&warm).all(|(a, b)| (a - b).abs() < 1e-9*size), "{rule:?} {cold:?} {warm:?}");
        }
    }
}

#[test]
fn data_out_of_range_are_refused() {
    let plain = || FilmSource::plain(27e-3, 24e-3, 27e-6, Cavitation::Reynolds, [24, 5]);
    let message = |change: &dyn Fn(&mut FilmSource)| {
        let mut source = plain();
        change(&mut source);
        Film::new(source).expect_err("wrong data").to_string()
    };
    let hole = |at: f64, low: f64, high: f64| Opening {
        on: Part::Shell,
        around: [at, at + 0.2],
        across: [low, high],
        feed: Feed::Pressure,
    };
    let openings =
        |openings: Vec<Opening>| message(&move |source| source.openings.clone_from(&openings));
    assert!(
        message(&|source| source.clearance = 0.0)
            .contains("radial clearance of a film is 0 um: it must be a positive number")
    );
    assert!(
        message(&|source| source.profile = vec![Profile::Barrel { depth: -30e-6 }])
            .contains("closes its gap: -12 mm from mid width the mean gap is -3 um")
    );
    assert!(
        openings(vec![hole(0.0, 13e-3, 15e-3)])
            .contains("lies beyond the ends of the bearing, whose width is 24 mm")
    );
    let all_around = Opening {
        on: Part::Shell,
        around: [0.0, std::f64::consts::TAU],
        ..hole(0.0, -13e-3, 13e-3)
    };
    assert!(openings(vec![all_around]).contains("so no film is left"));
    assert!(openings(vec![hole(0.0, 1e-3, 1e-3)]).contains("the second must lie above the first"));
    assert!(
        openings(vec![hole(0.0, 0.0, 2e-3), hole(6.2, 1e-3, 3e-3)])
            .contains("openings 1 and 2 of a film overlap")
    );
    assert!(
        message(&|source| source.around = Lines::Equal(2))
            .contains("2 cells around, but its openings need at least 4")
    );
    let turn = std::f64::consts::TAU;
    let lines =
        |places: Vec<f64>| message(&move |source| source.around = Lines::At(places.clone()));
    assert_eq!(
        lines(vec![0.0, 2.0, turn]),
        "a film has 3 lines around, but needs at least 5"
    );
    assert_eq!(
        lines(vec![0.0, 1.0, 0.25 * turn, 0.125 * turn, 3.0, turn]),
        "a line around of a film is at 45 deg: it must be above the one before it"
    );
    assert_eq!(
        lines(vec![0.0, 1.0, 2.0, 3.0, 0.5 * turn]),
        "a line around of a film is at 180 deg: it must be at the end of the film, because it is the first or the last line"
    );
    let half = message(&|source| {
        source.half_width = true;
        source.profile = vec![Profile::Taper { depth: 1e-6 }];
    });
    assert_eq!(
        half,
        "a film of half width needs profiles symmetric about mid width"
    );
    let content = Opening {
        feed: Feed::Content(1.5),
        ..hole(0.0, -1e-3, 1e-3)
    };
    assert!(
        openings(vec![content])
            .contains("content of an opening of a film is 1.5: it must be in 0 to 1")
    );
    // an edge beyond the end opens it
    let mut source = plain();
    source.openings = vec![hole(0.0, -13e-3, 0.0)];
    assert!(Film::new(source).is_ok());
    assert!(
        matches!(Film::new(plain()).map(|film| film.source().clone()), Ok(source) if source == plain())
    );
}

/// In a centred film at rest all cells are at the edge of the cavity. Each motion of the pin ruptures the
/// half that it leaves, so the force resists with the other half, and the derivative on a full film is twice
/// as large. A loaded film has a place for its cavity.
#[test]
fn a_film_without_pressure_has_no_derivative() {
    let film = |eccentricity: [f64; 2], rate: f64| {
        let source = FilmSource::plain(1.0, 1.0, 1.0, Cavitation::Reynolds, [48, 9]);
        let inputs = Inputs {
            eccentricity,
            rate: [rate, 0.0],
            spin: 1.0,
            ..Inputs::still(1.0)
        };
        solved(source, inputs.write()).expect("a film")
    };
    let mut centred = film([0.0; 2], 0.0);
    assert!((centred.film.undecided(&centred.work) - 1.0).abs() < 1e-12);
    let mut tangent = vec![0.0; centred.film.outputs() * centred.film.inputs()];
    centred.film.tangent(&mut centred.work, &mut tangent);
    let two_sided = (film([0.0; 2], 1e-6).outputs[0] - film([0.0; 2], -1e-6).outputs[0]) / 2e-6;
    let ratio = tangent[inputs::RATE] / two_sided;
    assert!((ratio - 2.0).abs() < 0.2, "{ratio}");
    let loaded = film([0.3, 0.1], 0.0);
    assert_eq!(loaded.film.undecided(&loaded.work), 0.0);
}

/// An opening at the pressure of the cavity is full of oil: it feeds a mass-conserving film as one slightly above does.
#[test]
fn an_opening_without_pressure_feeds() {
    let load = |pressure: f64| {
        let source = FilmSource {
            openings: vec![Opening {
                on: Part::Shell,
                around: [2.6, 3.3],
                across: [-0.3, 0.35],
                feed: Feed::Pressure,
            }],
            ..FilmSource::plain(1.0, 1.2, 1.0, Cavitation::MassConserving, [48, 12])
        };
        let supply = [pressure];
        let inputs = Inputs {
            eccentricity: [0.5, 0.2],
            spin: 1.0,
            supply: &supply,
            ..Inputs::still(1.0)
        };
        solved(source, inputs.write()).expect("a film").outputs
    };
    let (none, little) = (load(0.0), load(1e-7));
    for output in 0..inputs::SHAPE_FORCE {
        let off = (none[output] - little[output]).abs();
        assert!(
            off < 1e-5 * none[0].hypot(none[1]),
            "{output}: {none:?} {little:?}"
        );
    }
    assert!(none[0].hypot(none[1]) > 0.1, "{none:?}");
}

#[test]
fn inputs_out_of_range_are_refused() {
    let plain = |rule| FilmSource::plain(1.0, 1.0, 1.0, rule, [24, 5]);
    let error = |source: FilmSource, inputs: Inputs| {
        solved(source, inputs.write()).err().expect("wrong inputs")
    };
    let spinning = |ratio: f64| Inputs {
        eccentricity: [ratio, 0.0],
        spin: 1.0,
        ..Inputs::still(1.0)
    };
    let touching = error(plain(Cavitation::Reynolds), spinning(1.01));
    assert!(
        matches!(&touching, FilmError::NoGap { place, .. } if place.angle.sin().abs() < 1e-12),
        "{touching}"
    );
    assert!(
        touching
            .to_string()
            .starts_with("the surfaces touch: the gap is -10000 um"),
        "{touching}"
    );
    assert!(
        error(plain(Cavitation::Reynolds), spinning(f64::NAN))
            .to_string()
            .contains("the eccentricity (x) of a film is NaN")
    );
    let thin = Inputs {
        viscosity: 0.0,
        ..spinning(0.5)
    };
    assert!(
        error(plain(Cavitation::Reynolds), thin)
            .to_string()
            .contains("viscosity of a film is 0 mPa*s")
    );
    let drawn = Inputs {
        end_pressure: -0.1,
        ..spinning(0.5)
    };
    assert!(
        error(plain(Cavitation::Reynolds), drawn)
            .to_string()
            .contains("at least the cavitation pressure")
    );
    let mut half = plain(Cavitation::Reynolds);
    half.half_width = true;
    assert_eq!(
        error(
            half,
            Inputs {
                tilt: [0.1, 0.0],
                ..spinning(0.5)
            }
        ),
        FilmError::TiltOfHalf
    );
    let mut solid = plain(Cavitation::Reynolds);
    solid.piezo = 5.0;
    let solid = error(solid, spinning(0.9));
    assert!(
        matches!(&solid, FilmError::Piezo { reached, .. } if *reached >= 0.98),
        "{solid}"
    );
    assert!(
        solid
            .to_string()
            .contains("lower the load, or state a smaller pressure coefficient")
    );
}

#[test]
fn a_gap_that_closes_within_a_step_fills() {
    let source = FilmSource::plain(1.0, 1.0, 1.0, Cavitation::MassConserving, [24, 5]);
    let film = Film::new(source).expect("a film");
    let (mut work, mut y, mut memory) = (
        film.work(),
        vec![0.0; film.outputs()],
        vec![0.1; film.memory()],
    );
    // the side that the pin leaves keeps oil, the other side has no room for less than all of its gap
    let fast = Inputs {
        eccentricity: [0.5, 0.0],
        rate: [2.0, 0.0],
        ..Inputs::still(1.0)
    }
    .write();
    film.solve(&fast, Some(10.0), &memory, &mut work, &mut y)
        .expect("a film");
    film.accept(&work, &mut memory);
    assert!(
        y[0] < 0.0 && memory[..2].iter().all(|content| *content == 1.0),
        "{y:?}"
    );
    assert!(memory.iter().all(|content| (0.0..=1.0).contains(content)));
    assert!(memory[12 * 5] > 0.0 && memory[12 * 5] < 0.1);
}

/// An opening in a bearing of 24 mm width: edges around (rad) and across (mm).
fn opening(on: Part, around: [f64; 2], across: [f64; 2]) -> Opening {
    Opening {
        on,
        around,
        across: across.map(|edge| edge * 1e-3),
        feed: Feed::Pressure,
    }
}

/// The lands and corners of openings in a bearing of 54 mm diameter.
#[test]
fn lands_and_corners_are_found() {
    let turn = std::f64::consts::TAU;
    let of = |openings: &[Opening]| {
        let mut source = FilmSource::plain(27e-3, 24e-3, 27e-6, Cavitation::Reynolds, [24, 8]);
        source.openings = openings.to_vec();
        source
    };
    let groove = opening(Part::Shell, [0.2, 0.4], [-7.0, 7.0]);
    let lone = of(&[groove]);
    assert!(lone.corners().is_empty());
    let (land, at, beside) = lone.narrowest_land().expect("a land");
    assert!((land - 5e-3).abs() < 1e-12 && at == 0 && beside == Beside::End);
    for across in [[-12.0, 3.0], [-3.0, 13.0]] {
        for on in [Part::Shell, Part::Pin] {
            let open = of(&[opening(on, [0.2, 0.4], across)]);
            assert_eq!(open.corners(), [(0, Beside::End)]);
        }
    }
    let ring = |on: Part| opening(on, [0.0, turn], [-13.0, -8.0]);
    assert!(of(&[ring(Part::Shell)]).corners().is_empty());
    assert_eq!(of(&[ring(Part::Pin)]).corners(), [(0, Beside::End)]);
    // beside each other around, over the line of angle zero, and across
    let beside = [
        (
            opening(Part::Shell, [turn - 0.3, 0.2 + turn], [-5.0, 5.0]),
            None,
        ),
        (opening(Part::Shell, [0.5, 0.6], [-5.0, 5.0]), Some(2.7e-3)),
        (opening(Part::Shell, [0.3, 0.6], [7.5, 9.0]), Some(0.5e-3)),
        (opening(Part::Shell, [0.5, 0.6], [9.0, 10.0]), Some(2e-3)),
        (opening(Part::Pin, [0.45, 0.6], [-5.0, 5.0]), None),
    ];
    for (other, due) in beside {
        let source = of(&[groove, other]);
        let touches = other.around[0] > 5.0;
        let corners = source.corners();
        assert_eq!(
            corners.contains(&(1, Beside::Opening(0))),
            touches,
            "{other:?}"
        );
        let (land, ..) = source.narrowest_land().expect("a land");
        let due: f64 = due.unwrap_or(5e-3);
        assert!((land - due).abs() < 1e-12, "{land} {due}");
    }
}

/// A pin in the centre has the torque `2π μ R³ B ω/c` with the whole width B: the shear over an opening counts as that of a
/// land. Around a groove of the whole shell all cells serve the lands.
#[test]
fn openings_count_as_lands_in_shear() {
    let (radius, width, clearance) = (27e-3, 24e-3, 27e-6);
    let shear = |openings: &[Opening], turn: f64| {
        let rule = Cavitation::Reynolds;
        let mut source = FilmSource::plain(radius, width, clearance, rule, [48, 13]);
        source.openings = openings.to_vec();
        let film = Film::new(source).expect("a film");
        let x = Inputs {
            spin: 300.0,
            turn,
            supply: &[0.0],
            ..Inputs::still(8e-3)
        };
        let (mut work, mut y) = (film.work(), vec![0.0; film.outputs()]);
        film.solve(&x.write(), None, &[], &mut work, &mut y)
            .expect("a film");
        let lines = film.lines()[1].to_vec();
        (y[inputs::TORQUE], lines)
    };
    let turn = std::f64::consts::TAU;
    let whole = turn * 8e-3 * radius * radius * radius * 300.0 / clearance * width;
    let cell = turn / 48.0;
    for (opening, share) in [
        (opening(Part::Shell, [0.0, turn], [-2.0, 2.0]), 1.0 / 6.0),
        (
            opening(Part::Shell, [0.1, 0.1 + turn / 12.0], [-6.0, 6.0]),
            1.0 / 24.0,
        ),
        (opening(Part::Pin, [0.0, turn], [-2.0, 2.0]), 1.0 / 6.0),
        (
            opening(Part::Pin, [0.0, 4.0 * cell], [-6.0, 6.0]),
            1.0 / 24.0,
        ),
    ] {
        let (torque, lines) = shear(&[opening], 3.0 * cell);
        assert!((torque / whole - 1.0).abs() < 1e-12, "{opening:?}");
        if share == 1.0 / 6.0 && opening.on == Part::Shell {
            let groove: Vec<f64> = lines.into_iter().filter(|z| z.abs() < 2.1e-3).collect();
            assert_eq!(groove.len(), 2, "{groove:?}");
        }
    }
}
