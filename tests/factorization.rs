//! The step's matrices of real engines: elimination by blocks against dense elimination, over a turn.

use eng::Sources;
use eng_runtime::linear::{BlockLu, LinearError, LinearSolver, Pattern, SparseLu};
use nalgebra::{DMatrix, DVector};
use std::path::Path;

fn simulation(example: &str, model: &str, step: f64) -> eng::Simulation {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("examples")
        .join(example);
    let sources = Sources::folder(&folder).expect("the example's folder");
    eng::check(&sources, &format!("{example}.eng"))
        .into_program()
        .unwrap_or_else(|report| panic!("{report}"))
        .model(model)
        .unwrap_or_else(|error| panic!("{error}"))
        .simulation()
        .fixed_step(step)
        .start()
        .unwrap_or_else(|error| panic!("{error}"))
}

fn matrix(simulation: &mut eng::Simulation, step: f64) -> (Pattern, Vec<f64>) {
    let runtime = simulation.runtime();
    let mut unknowns = vec![0.0; runtime.unknowns()];
    runtime.predicted(step, &mut unknowns).unwrap();
    let (pattern, values) = runtime.jacobian(step, &unknowns).unwrap();
    (pattern.clone(), values.to_vec())
}

fn dense(pattern: &Pattern, values: &[f64]) -> DMatrix<f64> {
    let mut a = DMatrix::zeros(pattern.size(), pattern.size());
    for (row, column, value) in pattern.entries(values) {
        a[(row, column)] = value;
    }
    a
}

fn check(example: &str, model: &str, step: f64, between: usize, places: usize) {
    let mut simulation = simulation(example, model, step);
    for place in 0..places {
        let (pattern, values) = matrix(&mut simulation, step);
        let a = dense(&pattern, &values);
        let mut blocks = BlockLu::new(&pattern);
        blocks.factor(&values).unwrap();
        assert_eq!(blocks.fallbacks(), 0, "{example}, place {place}");
        let reference = a.clone().full_piv_lu();
        let b = DVector::from_fn(pattern.size(), |i, _| ((7 * i + 3) % 11) as f64 - 5.0);
        let expected = reference.solve(&b).expect("a sound matrix");
        let mut x = b.clone();
        blocks.solve(x.as_mut_slice());
        let residual = &a * &x - &b;
        let size = a.abs() * x.abs() + b.abs();
        let worst = residual.iter().zip(size.iter());
        let worst = worst.fold(0.0_f64, |w, (r, s)| w.max(r.abs() / s));
        assert!(worst < 1e-12, "{example}, place {place}: {worst:e}");
        let miss = (&x - &expected).amax() / expected.amax();
        assert!(miss < 1e-8, "{example}, place {place}: {miss:e}");

        // an equation stated twice is refused by both methods
        let columns_of = |row: usize| -> Vec<usize> {
            (0..pattern.size())
                .filter(|c| pattern.rows_of(*c).contains(&row))
                .filter(|c| *c != row && *c + 1 != row && *c != row + 1)
                .collect()
        };
        let second = (1..pattern.size())
            .rev()
            .find(|row| columns_of(*row) == columns_of(row - 1))
            .expect("a joint of two equations");
        let first = second - 1;
        let mut twice = a.clone();
        let row = twice.row(first).clone_owned();
        twice.set_row(second, &row);
        let twice: Vec<f64> = pattern
            .places()
            .map(|(_, row, column)| twice[(row, column)])
            .collect();
        assert_eq!(blocks.factor(&twice), Err(LinearError::Singular));
        let mut general = SparseLu::new(&pattern).unwrap();
        assert_eq!(general.factor(&twice), Err(LinearError::Singular));

        for _ in 0..between {
            simulation.step().unwrap_or_else(|error| panic!("{error}"));
        }
    }
    assert_eq!(simulation.statistics().fallbacks, 0);
}

/// A turn takes 15 ms; the step meets dead centres.
#[test]
fn four_cylinders_over_a_turn() {
    check("inline4", "Inline4", 2.5e-5, 50, 13);
}

#[test]
fn a_slider_crank_over_a_turn() {
    check("slider_crank", "SliderCrank", 1e-4, 40, 10);
}

/// A part whose markers all lie within a micron is measured by its inertia: a slider with a little offset of
/// its centre of mass falls as any other, and its guide carries the moment of the offset.
#[test]
fn a_tiny_offset_is_no_measure_of_a_model() {
    for offset in ["0", "1e-9", "2e-8", "4e-7", "1e-5", "1e-3", "0.1"] {
        let text = format!(
            "use std.joints.Translational
            model Fall {{
                gravity = [0, 0, -9.81] m/s^2
                body slider {{
                    mass = 2 kg
                    inertia = [1, 1, 1] g*m^2
                    center_of_mass = [0, 1, 0]*{offset}*1 m
                    marker pin = origin
                }}
                force push = Push(slider.pin)
                joint guide = Translational(slider.pin, ground)
                output fallen: Length = dot(slider.pin.origin, ground.z)
                output moment: Torque = guide.torque.x
            }}
            force Push(a: Marker) {{ apply force 3 N*ground.z on a }}
            analysis fall = transient(Fall(), duration: 0.1 s)"
        );
        let outcome = eng::check(&Sources::from_text("fall.eng", text), "fall.eng")
            .into_program()
            .unwrap_or_else(|report| panic!("{report}"))
            .analysis("fall")
            .unwrap_or_else(|error| panic!("{error}"))
            .run(&mut |_| {})
            .unwrap_or_else(|failed| panic!("{offset} m: {}", failed.error));
        let last = |path: &str| *outcome.results.column(path).unwrap().values.last().unwrap();
        let acceleration = 1.5 - 9.81;
        let fallen = last("fallen") - 0.5 * acceleration * 0.01;
        assert!(fallen.abs() < 1e-9, "{offset} m: {fallen:e}");
        // the push goes through the origin, inertia and weight through the centre: 2 kg · offset · (a + g)
        let moment = 2.0 * offset.parse::<f64>().unwrap() * (acceleration + 9.81);
        assert!(
            (last("moment") - moment).abs() < 1e-9,
            "{offset} m: {} {moment}",
            last("moment")
        );
    }
}
