//! Derivatives by adjoints against differences, and stiffness and damping of the reference.

use crate::states::{number, pair, reference};
use eng_film::{
    Cavitation, EdgeSlope, Feed, Film, FilmSource, Inputs, Opening, Part, Profile, Quantity,
    Roughness, Shape, Thinning, inputs,
};

/// Derivatives of all outputs by an input: central differences of two steps, extrapolated. The steps are so
/// small that no cell changes sides.
fn differences(film: &Film, x: &[f64], input: usize, past: Option<(f64, &[f64])>) -> Vec<f64> {
    let mut work = film.work();
    let mut at = |shift: f64| {
        let mut moved = x.to_vec();
        moved[input] += shift;
        let mut outputs = vec![0.0; film.outputs()];
        let memory = past.map_or(&[][..], |(_, memory)| memory);
        film.solve(
            &moved,
            past.map(|(step, _)| step),
            memory,
            &mut work,
            &mut outputs,
        )
        .expect("a film");
        let (mut set, mut pressure) = (Vec::new(), vec![0.0; film.cells()[0] * film.cells()[1]]);
        film.cavity(&work, &mut set);
        // the rule `half` cuts pressures without a set
        film.field(Quantity::Pressure, &work, &mut pressure);
        set.extend(
            pressure
                .iter()
                .map(|pressure| f64::from(u8::from(*pressure > 0.0))),
        );
        (outputs, set)
    };
    let middle = at(0.0).1;
    // larger steps let the flow of an end face change its sign, which bends the side flow
    for share in [5e-5, 5e-6, 2e-6] {
        let step = share * x[input].abs().max(0.05);
        let points = [step, -step, step / 2.0, -step / 2.0].map(&mut at);
        if points.iter().any(|(_, set)| *set != middle) {
            continue;
        }
        let slope = |output: usize, up: usize, step: f64| {
            (points[up].0[output] - points[up + 1].0[output]) / (2.0 * step)
        };
        return (0..film.outputs())
            .map(|output| (4.0 * slope(output, 2, step / 2.0) - slope(output, 0, step)) / 3.0)
            .collect();
    }
    panic!("a cell changes sides at input {input}");
}

/// Largest difference of tangent and differences, relative to the largest derivative of the output by the
/// same input or to the output itself.
fn check(name: &str, source: FilmSource, x: &[f64], past: Option<(f64, Vec<f64>)>) {
    let film = Film::new(source).expect("a film");
    let mut work = film.work();
    let mut y = vec![0.0; film.outputs()];
    let past = past
        .as_ref()
        .map(|(step, memory)| (*step, memory.as_slice()));
    let memory = past.map_or(&[][..], |(_, memory)| memory);
    film.solve(x, past.map(|(step, _)| step), memory, &mut work, &mut y)
        .expect("a film");
    // the summary adds its powers and flows by itself
    let summary = film.summary(&work);
    let loss = summary.shear_power + summary.pressure_power + summary.boundary_power;
    assert!(
        (y[inputs::LOSS] - loss).abs() < 1e-13 * loss,
        "{name}: {loss}"
    );
    let flow = summary.outflow;
    assert!(
        (y[inputs::SIDE_FLOW] - flow).abs() < 1e-13 * flow,
        "{name}: {flow}"
    );
    let mut tangent = vec![0.0; film.outputs() * film.inputs()];
    film.tangent(&mut work, &mut tangent);
    let mut worst = 0.0_f64;
    for input in 0..film.inputs() {
        let exact: Vec<f64> = (0..film.outputs())
            .map(|output| tangent[output * film.inputs() + input])
            .collect();
        let size = exact
            .iter()
            .chain(&y)
            .fold(0.0_f64, |size, number| size.max(number.abs()));
        let measured = differences(&film, x, input, past);
        for (output, (exact, measured)) in exact.iter().zip(&measured).enumerate() {
            let error = (exact - measured).abs() / size;
            worst = worst.max(error);
            assert!(
                error < 1e-8,
                "{name}: output {output} by input {input}: {exact} and {measured}"
            );
        }
    }
    println!("{name}: {worst:.1e}");
}

/// A film with all optional data, in units of R = c = μ = 1.
fn everything(rule: Cavitation) -> FilmSource {
    let mut source = FilmSource::plain(1.0, 1.2, 1.0, rule, [36, 9]);
    source.openings = vec![
        Opening {
            on: Part::Shell,
            around: [2.6, 3.3],
            across: [-0.3, 0.35],
            feed: Feed::Pressure,
        },
        Opening {
            on: Part::Shell,
            around: [4.0, 4.2],
            across: [-0.1, 0.2],
            feed: Feed::Content(0.7),
        },
    ];
    source.profile = vec![
        Profile::Lemon {
            depth: 0.1,
            at: 0.3,
        },
        Profile::Barrel { depth: 0.05 },
    ];
    source.pin_profile = vec![
        Profile::Offset {
            distance: 0.03,
            at: 0.7,
        },
        Profile::Taper { depth: 0.02 },
        Profile::Lemon {
            depth: 0.04,
            at: 1.0,
        },
    ];
    source.shapes = vec![
        Shape {
            around: 2,
            sine: false,
            across: 0,
        },
        Shape {
            around: 3,
            sine: true,
            across: 2,
        },
    ];
    source
}

fn moving() -> Inputs<'static> {
    Inputs {
        eccentricity: [0.45, 0.2],
        rate: [0.05, -0.1],
        tilt: [0.1, -0.2],
        tilt_rate: [0.03, 0.05],
        spin: 0.9,
        turn: 0.4,
        viscosity: 1.1,
        end_pressure: 0.1,
        supply: &[0.5, 0.2],
        deflection: &[0.05, -0.03],
        deflection_rate: &[0.02, 0.03],
    }
}

/// The film with rough surfaces that touch, and oil that thins.
fn rough(source: FilmSource) -> FilmSource {
    FilmSource {
        rough: Some(Roughness {
            deviation: 0.15,
            direction: 3.0,
            asperity: 0.1,
            modulus: 20.0,
            friction: 0.1,
        }),
        thinning: Some(Thinning {
            second: 0.4,
            rate: 2.0,
            exponent: 1.3,
        }),
        ..source
    }
}

/// Oil by Barus' law of a film for iterates, part of which reaches fifty times its viscosity.
fn too_thick(source: FilmSource) -> FilmSource {
    let thick = FilmSource {
        piezo: 20.0,
        floor: 1e-3,
        ..source
    };
    let film = Film::new(thick.clone()).expect("a film");
    let (mut work, mut outputs) = (film.work(), vec![0.0; film.outputs()]);
    film.solve(&moving().write(), None, &[], &mut work, &mut outputs)
        .expect("a film");
    let mut pressure = vec![0.0; film.cells()[0] * film.cells()[1]];
    film.field(Quantity::Pressure, &work, &mut pressure);
    let limit = 50.0_f64.ln() / thick.piezo;
    let thickest = pressure.iter().filter(|p| **p > limit).count();
    assert!(thickest > 3 && pressure.iter().any(|p| *p > 0.1 * limit && *p < limit));
    thick
}

#[test]
fn tangent_is_the_derivative() {
    for rule in [
        Cavitation::Reynolds,
        Cavitation::Half,
        Cavitation::MassConserving,
    ] {
        check(
            &format!("{rule:?}"),
            everything(rule),
            &moving().write(),
            None,
        );
        let mut piezo = everything(rule);
        piezo.piezo = 0.3;
        check(&format!("{rule:?}, Barus"), piezo, &moving().write(), None);
        let thick = too_thick(everything(rule));
        check(&format!("{rule:?}, thick"), thick, &moving().write(), None);
        check(
            &format!("{rule:?}, rough"),
            rough(everything(rule)),
            &moving().write(),
            None,
        );
        let backwards = Inputs {
            spin: -0.7,
            ..moving()
        };
        check(
            &format!("{rule:?}, backwards"),
            everything(rule),
            &backwards.write(),
            None,
        );
    }
}

/// The film with openings of the pin, one of which lies in part over one of the shell.
fn fed_by_the_pin(mut source: FilmSource) -> FilmSource {
    source.openings.push(Opening {
        on: Part::Pin,
        around: [0.31, 0.83],
        across: [-0.3, 0.2],
        feed: Feed::Pressure,
    });
    source.openings.push(Opening {
        on: Part::Pin,
        around: [2.41, 2.56],
        across: [-0.1, 0.5],
        feed: Feed::Pressure,
    });
    source
}

#[test]
fn tangent_with_openings_of_the_pin_is_the_derivative() {
    let x = Inputs {
        supply: &[0.5, 0.2, 0.9, 0.7],
        ..moving()
    };
    for rule in [
        Cavitation::Reynolds,
        Cavitation::Half,
        Cavitation::MassConserving,
    ] {
        let source = fed_by_the_pin(everything(rule));
        check(&format!("{rule:?}, pin"), source.clone(), &x.write(), None);
        let mut piezo = rough(source);
        piezo.piezo = 0.3;
        check(&format!("{rule:?}, rough pin"), piezo, &x.write(), None);
    }
}

#[test]
fn tangent_within_a_step_is_the_derivative() {
    let source = everything(Cavitation::MassConserving);
    let film = Film::new(source.clone()).expect("a film");
    let mut memory = vec![1.0; film.memory()];
    let before = Inputs {
        eccentricity: [0.4, 0.1],
        ..moving()
    };
    film.start(&before.write(), &mut film.work(), &mut memory)
        .expect("a film");
    let past = Some((0.05, memory));
    check(
        "a rough step",
        rough(source.clone()),
        &moving().write(),
        past.clone(),
    );
    check("a step", source, &moving().write(), past);
}

#[test]
fn half_width_has_the_tangent_of_the_whole() {
    let mut source = everything(Cavitation::Reynolds);
    source.across = eng_film::Lines::Equal(10);
    source.openings = vec![Opening {
        on: Part::Shell,
        around: [2.6, 3.3],
        across: [-0.24, 0.24],
        feed: Feed::Pressure,
    }];
    source.pin_profile.remove(1);
    let x = Inputs {
        tilt: [0.0; 2],
        tilt_rate: [0.0; 2],
        supply: &[0.5],
        ..moving()
    }
    .write();
    let tangent = |half: bool| {
        let mut source = source.clone();
        source.half_width = half;
        if half {
            source.across = eng_film::Lines::Equal(5);
        }
        let film = Film::new(source).expect("a film");
        let (mut work, mut y) = (film.work(), vec![0.0; film.outputs()]);
        film.solve(&x, None, &[], &mut work, &mut y)
            .expect("a film");
        let mut tangent = vec![0.0; film.outputs() * film.inputs()];
        film.tangent(&mut work, &mut tangent);
        (film.inputs(), tangent)
    };
    let (inputs, whole) = tangent(false);
    for (at, (whole, half)) in whole.iter().zip(&tangent(true).1).enumerate() {
        let (output, input) = (at / inputs, at % inputs);
        let tilting = (inputs::TILT..inputs::SPIN).contains(&input)
            || (inputs::MOMENT..inputs::TORQUE).contains(&output);
        assert!(
            tilting || (whole - half).abs() < 1e-10 * (1.0 + whole.abs()),
            "{output} by {input}: {whole} and {half}"
        );
    }
}

/// A search that begins at the cavity of its own solution has nothing to search; one that begins at any other
/// finds the same.
#[test]
fn a_search_begins_at_a_stated_cavity() {
    let film = Film::new(everything(Cavitation::Reynolds)).expect("a film");
    let (mut work, mut y) = (film.work(), vec![0.0; film.outputs()]);
    let x = moving().write();
    film.solve(&x, None, &[], &mut work, &mut y)
        .expect("a film");
    let mut cavity = Vec::new();
    film.cavity(&work, &mut cavity);
    assert!(cavity.contains(&0.0) && cavity.contains(&1.0));
    cavity.push(7.0);
    let opposite: Vec<f64> = cavity.iter().map(|full| 1.0 - full).collect();
    for (numbers, fresh) in [(&cavity, true), (&opposite, false)] {
        let (mut other, mut again) = (film.work(), vec![0.0; film.outputs()]);
        // the numbers of the next film stay
        assert_eq!(film.begin_at(&mut other, numbers).len(), 1);
        film.solve(&x, None, &[], &mut other, &mut again)
            .expect("a film");
        assert_eq!(film.summary(&other).rounds == 1, fresh);
        for (a, b) in y.iter().zip(&again) {
            assert!((a - b).abs() < 1e-10 * (1.0 + a.abs()), "{a} {b}");
        }
    }
    assert!(film.begin_at(&mut work, &cavity[..3]).is_empty());
}

/// Rows of some outputs have the bits of all rows, and the rest is zero: whatever the number of adjoints that
/// are solved together.
#[test]
fn rows_of_some_outputs_are_those_of_all() {
    for rule in [Cavitation::Reynolds, Cavitation::MassConserving] {
        let film = Film::new(everything(rule)).expect("a film");
        let x = moving().write();
        let (mut work, mut y) = (film.work(), vec![0.0; film.outputs()]);
        film.solve(&x, None, &[], &mut work, &mut y)
            .expect("a film");
        let count = film.inputs();
        let mut all = vec![0.0; film.outputs() * count];
        film.tangent(&mut work, &mut all);
        for set in 0..1_u32 << inputs::SHAPE_FORCE {
            let wanted = std::array::from_fn(|output| set >> output & 1 == 1);
            // numbers of an earlier call must not remain
            let mut some = vec![f64::NAN; all.len()];
            film.tangent_of(&wanted, &mut work, &mut some);
            let rows = all.chunks_exact(count).zip(some.chunks_exact(count));
            for (output, (all, some)) in rows.enumerate() {
                let read = wanted.get(output).is_none_or(|wanted| *wanted);
                let bits = |row: &[f64]| row.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
                match read {
                    true => assert_eq!(bits(all), bits(some), "{set:b}: {output}"),
                    false => assert!(some.iter().all(|x| *x == 0.0), "{set:b}: {output}"),
                }
            }
        }
    }
}

/// Stiffness and damping on the usual cells and on twice as many, as shares of their largest entries: the documents state these
/// errors. The edge of the cavity moves from cell to cell, so they do not fall with the square of the cell size.
#[test]
fn errors_of_stiffness_and_damping_are_those_of_the_documents() {
    let of = |ratio: f64, slenderness: f64, cells: [usize; 2]| {
        let rule = Cavitation::Reynolds;
        let film = Film::new(FilmSource::plain(1.0, 2.0 * slenderness, 1.0, rule, cells));
        let film = film.expect("a film");
        let (mut work, mut y) = (film.work(), vec![0.0; film.outputs()]);
        let x = Inputs {
            eccentricity: [ratio, 0.0],
            spin: 1.0,
            ..Inputs::still(1.0)
        };
        film.solve(&x.write(), None, &[], &mut work, &mut y)
            .expect("a film");
        let mut tangent = vec![0.0; film.outputs() * film.inputs()];
        film.tangent(&mut work, &mut tangent);
        let at = |output: usize, input: usize| tangent[output * film.inputs() + input];
        [0, 2].map(|first| {
            [
                at(0, first),
                at(0, first + 1),
                at(1, first),
                at(1, first + 1),
            ]
        })
    };
    let mut worst = [[0.0_f64; 2]; 2];
    for slenderness in [0.25, 0.44, 0.5, 1.0] {
        for ratio in [0.3, 0.45, 0.6, 0.75, 0.9] {
            let fine = of(ratio, slenderness, [576, 40]);
            for (cells, worst) in [[72, 13], [144, 26]].into_iter().zip(&mut worst) {
                let found = of(ratio, slenderness, cells);
                for ((found, fine), worst) in found.iter().zip(&fine).zip(worst) {
                    let size = fine
                        .iter()
                        .fold(0.0_f64, |size, entry| size.max(entry.abs()));
                    let errors = found
                        .iter()
                        .zip(fine)
                        .map(|(found, fine)| (found - fine).abs());
                    *worst = errors.fold(*worst, |worst, error| worst.max(error / size));
                }
            }
        }
    }
    println!("K and C on 72 x 13 and 144 x 26: {worst:.4?}");
    for (worst, stated) in worst.into_iter().flatten().zip([0.04, 0.045, 0.01, 0.02]) {
        assert!(worst < stated, "{worst} and {stated}");
    }
}

#[test]
fn stiffness_and_damping_of_the_reference() {
    let mut worst = 0.0_f64;
    for row in reference()["coefficients"]["rows"]
        .as_array()
        .expect("rows")
    {
        let with = |edges: EdgeSlope, cells: [usize; 2]| {
            let mut source = crate::states::source(row, cells);
            (source.half_width, source.edges) = (true, edges);
            let film = Film::new(source).expect("a film");
            let (mut work, mut y) = (film.work(), vec![0.0; film.outputs()]);
            let mut x = crate::states::inputs(row, film.source().openings.len());
            x[0..2].copy_from_slice(&pair(row, "eps"));
            film.solve(&x, None, &[], &mut work, &mut y)
                .expect("a film");
            let mut tangent = vec![0.0; film.outputs() * film.inputs()];
            film.tangent(&mut work, &mut tangent);
            tangent
        };
        let on = |cells: [usize; 2]| with(EdgeSlope::TwoCells, cells);
        // content converges with first order
        let fine = if row["rule"] == "jfo" { 2 } else { 1 };
        let (coarse, fine) = (on([144 * fine, 12 * fine]), on([288 * fine, 24 * fine]));
        let inputs = coarse.len() / inputs::SHAPE_FORCE;
        for (name, place) in [("K", 0), ("C", 2)] {
            let entry = |output: usize, input: usize| {
                let at = output * inputs + place + input;
                -(4.0 * fine[at] - coarse[at]) / 3.0
            };
            let matrix =
                ["xx", "xy", "yx", "yy"].map(|key| number(&row["value"], &format!("{name}_{key}")));
            let size = matrix
                .iter()
                .fold(0.0_f64, |size, number| size.max(number.abs()));
            for (at, key) in ["xx", "xy", "yx", "yy"].iter().enumerate() {
                let trust = number(&row["uncertainty"], &format!("{name}_{key}"));
                let error = ((entry(at / 2, at % 2) - matrix[at]).abs() - trust).max(0.0) / size;
                worst = worst.max(error);
                assert!(
                    error < 5e-3,
                    "{name}_{key} {} and {}",
                    entry(at / 2, at % 2),
                    matrix[at]
                );
            }
        }
        // C_xy − C_yx over the largest entry: rounding with the slope of one cell, else an error of the cells
        let skew = |tangent: &[f64]| {
            let damping = [2, 3, inputs + 2, inputs + 3].map(|at| tangent[at]);
            let largest = damping
                .iter()
                .fold(0.0_f64, |largest, entry| largest.max(entry.abs()));
            (damping[1] - damping[2]).abs() / largest
        };
        let (rough, smooth) = (skew(&coarse), skew(&fine));
        match row["rule"].as_str() {
            Some("reynolds") => {
                let symmetric = skew(&with(EdgeSlope::OneCell, [144, 12]));
                println!(
                    "C_xy − C_yx: {symmetric:.1e} of one cell; of two {rough:.1e}, then {smooth:.1e}"
                );
                assert!(symmetric < 1e-12 && smooth < 5e-5 && smooth < rough / 3.0);
            }
            Some("guembel") => assert!(smooth > 0.05, "the rule `half` has no symmetric damping"),
            _ => {}
        }
    }
    println!("K and C beyond their uncertainty: {worst:.1e} of the largest entry");
}
