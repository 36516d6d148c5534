//! Bores of finite-element bodies that yield to their films.

use eng::Sources;
use eng_film::inputs::{ECCENTRICITY, RATE, SPIN, VISCOSITY};
use eng_film::{Accuracy, Cavitation, Elastic, Film, FilmSource, Shape};

const MODEL: &str = include_str!("mesh/shell.eng");
const MESH: &str = include_str!("mesh/shell.inp");

fn checked(model: &str, mesh: &str) -> Result<eng::Program, String> {
    let texts = [("shell.eng", model), ("shell.inp", mesh)];
    let sources = Sources::from_texts(texts.map(|(name, text)| (name.to_owned(), text.to_owned())));
    let program = eng::check(&sources, "shell.eng").into_program();
    program.map_err(|report| report.to_string())
}

/// Means of columns (SI) over the last of four turns.
struct LastTurn(eng::Outcome);

impl LastTurn {
    fn of(model: &str, mesh: &str) -> LastTurn {
        let program = checked(model, mesh).unwrap_or_else(|report| panic!("{report}"));
        let outcome = program
            .analysis("run")
            .expect("an analysis")
            .run(&mut |_| {});
        LastTurn(outcome.unwrap_or_else(|failed| panic!("{}", failed.error)))
    }

    fn mean(&self, path: &str) -> f64 {
        let values = &self.0.results.column(path).expect("a column").values;
        values[values.len() - 36..].iter().sum::<f64>() / 36.0
    }
}

/// Modes move the bore, and what they lack follows the pressure at once. Under a steady load both parts
/// together are the same for any number of modes.
#[test]
fn the_film_does_not_depend_on_the_modes() {
    let with = |modes: &str| {
        let text = MODEL.replace("modes: Int = 6", &format!("modes: Int = {modes}"));
        LastTurn::of(&text, MESH)
    };
    let (few, many) = (with("2"), with("60"));
    for path in [
        "main.eccentricity.x",
        "main.eccentricity.y",
        "main.minimum_film",
        "main.maximum_pressure",
        "main.side_flow",
        "main.deflection",
    ] {
        let (x, y) = (few.mean(path), many.mean(path));
        println!("{path}: {x} {y}");
        assert!((x / y - 1.0).abs() < 2e-4, "{path}: {x} {y}");
    }
    // a rigid bore has another film
    let rigid = MODEL.replace(", surface: fourier(waves_around: 5, degree_across: 1)", "");
    let (rigid, y) = (LastTurn::of(&rigid, MESH), many.mean("main.eccentricity.x"));
    assert!((rigid.mean("main.eccentricity.x") / y - 1.0).abs() > 0.2);
    assert!(many.mean("main.deflection") > 3e-6);
}

/// Stiffness and damping are those of slow motions, which the modes of the bore follow, too: they do not depend on the
/// number of modes, and the stiffness is the difference of two balances.
#[test]
fn slow_coefficients_do_not_depend_on_the_modes() {
    let held = |modes: u32, place: [f64; 2]| {
        let [x, y] = place;
        let text = MODEL
            .replace("        support = foot\n", "")
            .replace("        marker foot = set(\"FOOT\", tie: rigid)\n", "")
            .replace("modes: Int = 6", &format!("modes: Int = {modes}"))
            .replace("{PointOnPlane, ParallelAxes}", "{Fixed, Revolute}")
            .replace(
                "marker seat = origin",
                &format!("marker seat = origin\n    marker place = [{x}, {y}, 0] um"),
            )
            .replace(
                "PointOnPlane(rotor.mid, seat)",
                "Revolute(rotor.mid, place)",
            )
            .replace(
                "joint flat = ParallelAxes(rotor.mid, seat)",
                "joint hold = Fixed(shell.bore, seat)",
            )
            .replace(
                "PrescribedRotation(rotor.mid, seat",
                "PrescribedRotation(rotor.mid, place",
            )
            .replace("rotation(rotor.mid, seat)", "rotation(rotor.mid, place)")
            .replace(
                "transient(Shell(), duration: 4 rev, sample: 10 deg)",
                "static(Shell(), turning: true)",
            );
        let program = checked(&text, MESH).unwrap_or_else(|report| panic!("{report}"));
        let outcome = (program.analysis("run").expect("an analysis")).run(&mut |_| {});
        let outcome = outcome.unwrap_or_else(|failed| panic!("{}", failed.error));
        move |path: &str| {
            let values = &outcome.results.column(path).expect("a column").values;
            *values.last().expect("a number")
        }
    };
    let place = [10.0, -18.0];
    let (few, many) = (held(2, place), held(40, place));
    let size = many("main.stiffness[4]").abs();
    for k in 1..=4 {
        let path = format!("main.stiffness[{k}]");
        let (x, y) = (few(&path), many(&path));
        println!("{path}: {x:e} {y:e}");
        assert!((x - y).abs() < 1e-3 * size, "{path}: {x} {y}");
        let path = format!("main.damping[{k}]");
        let (x, y) = (few(&path), many(&path));
        let size = many("main.damping[4]").abs();
        println!("{path}: {x:e} {y:e}");
        assert!((x - y).abs() < 1e-3 * size, "{path}: {x} {y}");
    }
    for axis in 0..2 {
        let at = |by: f64| {
            let mut place = place;
            place[axis] += by;
            held(40, place)
        };
        // so near that no cell changes sides
        let (up, down) = (at(0.002), at(-0.002));
        for (force, component) in ["x", "y"].iter().enumerate() {
            let path = format!("main.force.{component}");
            let slope = -(up(&path) - down(&path)) / 0.004e-6;
            let found = many(&format!("main.stiffness[{}]", 2 * force + axis + 1));
            println!("{component} {axis}: {found:e} {slope:e}");
            assert!(
                (found - slope).abs() < 2e-3 * size,
                "{component} {axis}: {found} {slope}"
            );
        }
    }
}

/// The drive gives what the film loses, with a bore that yields by a seventh of the clearance.
#[test]
fn an_elastic_bore_takes_no_energy() {
    let run = LastTurn::of(MODEL, MESH);
    let given = run.mean("main.friction_torque") * 100.0 * std::f64::consts::PI;
    let lost = run.mean("main.power_loss");
    assert!((given / lost - 1.0).abs() < 5e-3, "{given} {lost}");
}

/// Compliance of a ring in plane stress under a pressure of k waves on its inner wall (m/N), by Michell's
/// stress function: see `flexible/tests/elastic_surface.rs`.
fn exact(k: u32) -> f64 {
    let (a, b, width, young, nu) = (27e-3, 40e-3, 24e-3, 2.1e10, 0.3);
    if k == 0 {
        let deflection = a / young * ((b * b + a * a) / (b * b - a * a) + nu);
        return deflection / (2.0 * std::f64::consts::PI * a * width);
    }
    let kappa = (3.0 - nu) / (1.0 + nu);
    if k == 1 {
        let factor = -0.25 / (a - f64::powi(b, 4) / f64::powi(a, 3));
        let moved = factor * (kappa * a * a + f64::powi(b, 4) / (a * a)) * (1.0 + nu) / young;
        return moved / (std::f64::consts::PI * a * width);
    }
    let n = f64::from(k);
    let stresses = |r: f64| {
        [
            [
                -n * (n - 1.0) * r.powf(n - 2.0),
                n * (n - 1.0) * r.powf(n - 2.0),
            ],
            [
                -n * (n + 1.0) * r.powf(-n - 2.0),
                -n * (n + 1.0) * r.powf(-n - 2.0),
            ],
            [
                -(n + 1.0) * (n - 2.0) * r.powf(n),
                n * (n + 1.0) * r.powf(n),
            ],
            [
                -(n + 2.0) * (n - 1.0) * r.powf(-n),
                -n * (n - 1.0) * r.powf(-n),
            ],
        ]
    };
    let (inside, outside) = (stresses(1.0), stresses(b / a));
    let matrix = nalgebra::Matrix4::from_fn(|row, term| match row {
        0 | 1 => inside[term][row],
        _ => outside[term][row - 2],
    });
    let side = nalgebra::Vector4::new(-1.0, 0.0, 0.0, 0.0);
    let factors = matrix.lu().solve(&side).expect("a solution");
    let moved = nalgebra::Vector4::new(-n, n, kappa - n - 1.0, kappa + n - 1.0).dot(&factors);
    a * moved * (1.0 + nu) / young / (std::f64::consts::PI * a * width)
}

/// The model with a free ring, whose bore a joint holds by its mean motion.
fn free_ring() -> String {
    MODEL
        .replace("        support = foot\n", "")
        .replace(
            "use std.joints.{PointOnPlane,",
            "use std.joints.{Fixed, PointOnPlane,",
        )
        .replace(
            "        marker foot = set(\"FOOT\", tie: rigid)\n",
            "        accept loose\n",
        )
        .replace(
            "    joint thrust",
            "    joint hold = Fixed(shell.bore, seat)\n    joint thrust",
        )
}

/// A free ring whose bore a joint holds by its mean motion: at the place of the pin that the run finds, a
/// film on a ring with the exact compliance has the same pressure, gap and force.
#[test]
fn a_free_ring_is_the_exact_one() {
    let model = free_ring().replace(
        "fourier(waves_around: 5, degree_across: 1)",
        "fourier(waves_around: 5, degree_across: 0)",
    );
    let run = LastTurn::of(&model, MESH);
    let mut source = FilmSource::plain(27e-3, 24e-3, 27e-6, Cavitation::Reynolds, [36, 7]);
    let pairs = (1..=5).flat_map(|around| [(around, false), (around, true)]);
    let waves: Vec<(u32, bool)> = std::iter::once((0, false)).chain(pairs).collect();
    let shape = |(around, sine): &(u32, bool)| Shape {
        around: *around,
        sine: *sine,
        across: 0,
    };
    source.shapes = waves.iter().map(shape).collect();
    // for the iterates of the surface
    source.floor = 27e-9;
    let count = waves.len();
    let mut compliance = vec![0.0; count * count];
    for (at, (around, _)) in waves.iter().enumerate() {
        compliance[at * (count + 1)] = exact(*around);
    }
    let film = Film::new(source).expect("a film");
    let elastic = Elastic::new(film, compliance).expect("an elastic film");
    let mut work = elastic.work();
    let mut x = vec![0.0; elastic.inputs()];
    for (k, axis) in ["x", "y"].iter().enumerate() {
        x[ECCENTRICITY + k] = run.mean(&format!("main.eccentricity.{axis}"));
        x[RATE + k] = 0.0;
    }
    x[SPIN] = 100.0 * std::f64::consts::PI;
    x[VISCOSITY] = 8e-3;
    let mut loads = vec![0.0; elastic.outputs()];
    elastic
        .solve(&x, None, &[], Accuracy::Full, &mut work, &mut loads)
        .expect("a solution");
    let summary = elastic.film().summary(&work.film);
    let weight = 200.0 * 9.81;
    let pairs = [
        ("force", loads[1], weight),
        (
            "pressure",
            summary.maximum_pressure,
            run.mean("main.maximum_pressure"),
        ),
        ("gap", summary.minimum_gap, run.mean("main.minimum_film")),
        (
            "deflection",
            elastic.deflection(&work),
            run.mean("main.deflection"),
        ),
    ];
    for (name, by_hand, found) in pairs {
        println!("{name}: {by_hand} {found}");
        assert!(
            (by_hand / found - 1.0).abs() < 0.03,
            "{name}: {by_hand} {found}"
        );
    }
}

/// The stated ring of the law against the same ring of finite elements, under one load. Both stay straight across. The
/// ring is an annulus in plane stress; elements of any fineness have 0.7 % more pressure, and this coarse mesh 1.9 %.
#[test]
fn a_stated_ring_is_that_of_finite_elements() {
    let surface = "fourier(waves_around: 5, degree_across: 1)";
    let held = free_ring().replace(
        "transient(Shell(), duration: 4 rev, sample: 10 deg)",
        "static(Shell(), turning: true)",
    );
    let rigid = held.replace(&format!(", surface: {surface}"), "");
    let stated = rigid
        .replace("std.journals.Film", "std.journals.{Film, Ring}")
        .replace(
            "around: 36",
            "eye: Ring(waves: 5, thickness: 13 mm, width: 24 mm, modulus: 21 GPa), around: 36",
        );
    let mesh = held.replace(surface, "fourier(waves_around: 5, degree_across: 0)");
    let [rigid, stated, mesh] = [rigid, stated, mesh].map(|text| {
        let program = checked(&text, MESH).unwrap_or_else(|report| panic!("{report}"));
        let outcome = (program.analysis("run").expect("an analysis")).run(&mut |_| {});
        let outcome = outcome.unwrap_or_else(|failed| panic!("{}", failed.error));
        let of = |path: &str| outcome.results.column(path).expect("a column").values[0];
        [
            "main.maximum_pressure",
            "main.minimum_film",
            "main.side_flow",
        ]
        .map(of)
    });
    println!("rigid {rigid:?}, stated {stated:?}, finite elements {mesh:?}");
    for (at, (close, far)) in [(0.025, 0.4), (0.003, 0.05), (0.01, 0.3)]
        .into_iter()
        .enumerate()
    {
        let apart = |from: f64| (from / mesh[at] - 1.0).abs();
        assert!(apart(stated[at]) < close, "{at}: {stated:?} {mesh:?}");
        assert!(apart(rigid[at]) > far, "{at}: {rigid:?} {mesh:?}");
    }
}

/// A support that leaves the body no mode: the film and the rest of the deflection need none.
#[test]
fn a_body_without_a_free_mode_carries_a_film() {
    let held = MODEL
        .replace("support = foot", "support = bore")
        .replace(" + normal(modes)", "");
    assert_ne!(held, MODEL);
    let run = LastTurn::of(
        &held.replace("        marker foot = set(\"FOOT\", tie: rigid)\n", ""),
        MESH,
    );
    assert!((run.mean("main.force.y") / (200.0 * 9.81) - 1.0).abs() < 1e-3);
}

/// `eng check` or the bind of the run refuses a wrong surface.
#[test]
fn wrong_surfaces_are_refused() {
    let refused = |from: &str, to: &str| {
        let text = MODEL.replace(from, to);
        assert_ne!(text, MODEL, "{from}");
        match checked(&text, MESH) {
            Err(report) => report,
            Ok(program) => match program
                .analysis("run")
                .map(|analysis| analysis.run(&mut |_| {}))
            {
                Ok(Err(failed)) => failed.error.to_string(),
                Ok(Ok(_)) => panic!("{to}: the run has no error"),
                Err(error) => error.to_string(),
            },
        }
    };
    for (from, to, message) in [
        (
            "fourier(waves_around: 5,",
            "fourier(waves_around: 16,",
            "too coarse for 16 waves",
        ),
        ("across: 1)", "across: 6)", "too coarse for degree 6"),
        (
            "fourier(waves_around: 5,",
            "fourier(waves_around: -1,",
            "it must be 0 to 40",
        ),
        (
            "fourier(waves_around: 5, degree_across: 1)",
            "fourier(waves_around: 5)",
            "across",
        ),
        (
            "fourier(waves_around: 5, degree_across: 1)",
            "chebyshev(5)",
            "not the `surface` of a marker",
        ),
        (
            "across: 1))",
            "across: 1), tie: rigid)",
            "a rigid tie holds the surface round",
        ),
        (
            "width: 24 mm, radial",
            "width: 26 mm, radial",
            "it would press beside the surface",
        ),
        (
            "    cycle angle",
            "    journal second = Film(rotor.mid, shell.bore, diameter: 54 mm, width: 24 mm, radial_clearance: 27 um, viscosity: 8 mPa*s)\n    cycle angle",
            "presses on the same elastic surface",
        ),
        (
            "around: 36, across: 7",
            "around: 14, across: 7",
            "14 cells around cannot follow",
        ),
        (
            "diameter: 54 mm",
            "diameter: 84 mm",
            "and the surface of its shell one of 27 mm",
        ),
        (
            "diameter: 54 mm",
            "diameter: 54.2 mm",
            "the surface is that of the film, or up to 15 % larger",
        ),
        (
            "radius: 27 mm",
            "radius: 40 mm",
            "the surface is the outside of a shaft",
        ),
    ] {
        let report = refused(from, to);
        assert!(report.contains(message), "{to}: {report}");
    }
}

/// A run that continues from a checkpoint has the surface of the run that was never stopped, to the last bit.
#[test]
fn a_checkpoint_holds_the_surface() {
    let program = checked(MODEL, MESH).unwrap_or_else(|report| panic!("{report}"));
    let model = program.model("Shell").expect("a model");
    let mut through = model.simulation().start().expect("a start");
    for _ in 0..30 {
        through.step().expect("a step");
    }
    let saved = through.checkpoint();
    let mut resumed = model.simulation().resume(&saved).expect("a checkpoint");
    for _ in 0..30 {
        through.step().expect("a step");
        resumed.step().expect("a step");
    }
    for path in ["main.force.x", "main.deflection"] {
        let channel = model.channel(path).expect("a channel");
        let both = [&mut through, &mut resumed].map(|s| s.value(channel).expect("a value"));
        assert_eq!(both[0].to_bits(), both[1].to_bits(), "{path}");
        assert!(both[0] != 0.0, "{path}");
    }
}
