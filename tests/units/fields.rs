//! The kernels of fields and their tables.

use eng::internals::Fields;
use eng_film::Inputs;
use eng_system::field::{Accuracy, FieldMaker, FieldNumbers, Kernel, drives};
use eng_system::system::FieldSource;

/// The drives of the table are the inputs of a film, and its answers the outputs, in the same order.
#[test]
fn the_table_and_the_film_agree() {
    let kernel = Kernel::named("reynolds").unwrap();
    let source = FieldSource {
        kernel: 0,
        openings: 1,
        settings: Vec::new(),
        wholes: vec![("around", 36), ("across", 7)],
        words: vec![("cavitation", "reynolds")],
        surface: None,
    };
    let setting = |name, value: f64| (name, vec![value]);
    let numbers = FieldNumbers {
        source: &source,
        surface: None,
        settings: vec![
            setting("diameter", 54e-3),
            setting("width", 24e-3),
            setting("radial_clearance", 27e-6),
            setting("opening_from", 3.0),
            setting("opening_to", 3.4),
            setting("opening_low", -5e-3),
            setting("opening_high", 5e-3),
        ],
    };
    let count: u32 = drives(kernel, 1).map(|(_, count)| count).sum();
    let inputs = Inputs {
        eccentricity: [15e-6, 4e-6],
        rate: [1e-3, -2e-3],
        spin: 400.0,
        supply: &[4e5],
        ..Inputs::still(8e-3)
    };
    let x = inputs.write();
    assert_eq!(x.len(), count as usize);
    let mut solver = Fields.make(&numbers).unwrap().solver(&[]);
    let mut answers = vec![0.0; kernel.answer_count() as usize];
    solver
        .solve(&x, None, Accuracy::Full, &mut answers)
        .unwrap();
    let mut readings = vec![f64::NAN; kernel.reading_count() as usize];
    solver.read(&mut readings, true);
    assert!(readings.iter().all(|number| number.is_finite()));
    // the thinnest gap lies towards e, and the shaft needs power
    let thinnest = 27e-6 - 15e-6_f64.hypot(4e-6);
    assert!((readings[0] - thinnest).abs() < 1e-12, "{}", readings[0]);
    assert!((readings[1] - 4.0_f64.atan2(15.0)).abs() < 1e-12);
    let power = kernel.result("shear_power").unwrap().1 as usize;
    assert!(readings[power] > 0.0);
    // stiffness and damping are differences of the force
    let step = 1e-9;
    for (first, input) in [("stiffness", 0), ("damping", 2)] {
        let at = kernel.result(first).unwrap().1 as usize;
        let mut at_end = |moved: f64| {
            let mut moved_inputs = x.clone();
            moved_inputs[input] += moved;
            let mut after = answers.clone();
            solver
                .solve(&moved_inputs, None, Accuracy::Full, &mut after)
                .unwrap();
            after
        };
        let (up, down) = (at_end(step), at_end(-step));
        for force in 0..2 {
            let slope = -(up[force] - down[force]) / (2.0 * step);
            let found = readings[at + 2 * force];
            assert!(
                (found - slope).abs() < 1e-4 * slope.abs(),
                "{found} {slope}"
            );
        }
    }
}
