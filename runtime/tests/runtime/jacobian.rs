//! The step's matrix against Richardson differences of the whole residual.

use crate::mechanisms::*;
use eng_runtime::assembly::closing::Numbers;
use eng_runtime::{Options, Simulation};
use eng_system::code::Compiled;
use eng_system::system::StepControl;

/// The matrix of a step against differences, at a slightly changed state after a few steps of 1 ms.
pub fn check(compiled: &Compiled, step: f64, reach: f64) {
    let options = Options {
        step: StepControl::Fixed(1e-3),
        ..Options::default()
    };
    let mut simulation = Simulation::new(compiled, &[], options).unwrap();
    for _ in 0..5 {
        simulation.step().unwrap();
    }
    let n = simulation.unknowns();
    let mut numbers = Numbers::new(3);
    let mut at = vec![0.0; n];
    simulation.predicted(step, &mut at).unwrap();
    for x in &mut at {
        *x += reach * numbers.draw();
    }
    let mut exact = vec![vec![0.0; n]; n];
    let (pattern, values) = simulation.jacobian(step, &at).unwrap();
    for (row, column, value) in pattern.entries(values) {
        exact[row][column] = value;
    }
    let mut difference = vec![vec![0.0; n]; n];
    for c in 0..n {
        let mut central = |d: f64| {
            let mut out = vec![vec![0.0; n]; 2];
            for (sign, out) in [1.0, -1.0].iter().zip(&mut out) {
                let mut x = at.clone();
                x[c] += sign * d;
                simulation.residual(step, &x, out).unwrap();
            }
            (0..n)
                .map(|r| (out[0][r] - out[1][r]) / (2.0 * d))
                .collect::<Vec<f64>>()
        };
        let (coarse, middle, fine) = (central(8e-3), central(4e-3), central(2e-3));
        for r in 0..n {
            let first = (4.0 * middle[r] - coarse[r]) / 3.0;
            let second = (4.0 * fine[r] - middle[r]) / 3.0;
            difference[r][c] = (16.0 * second - first) / 15.0;
        }
    }
    for r in 0..n {
        let norm = exact[r].iter().map(|x| x * x).sum::<f64>().sqrt();
        assert!(norm > 0.0);
        for c in 0..n {
            let error = (exact[r][c] - difference[r][c]).abs() / norm;
            assert!(
                error < 1e-8,
                "row {r} column {c} of {n}: {} {} ({error:e})",
                exact[r][c],
                difference[r][c]
            );
        }
    }
}

#[test]
fn matrix_is_exact_on_a_spatial_chain() {
    // Steps so long that forces, gyroscopic and second-order terms weigh as much as the mass.
    check(&spatial_chain(), 0.15, 0.2);
    check(&spatial_chain(), 0.01, 0.05);
}

#[test]
fn matrix_is_exact_on_a_driven_slider_crank() {
    let turn = Turn::Driven {
        start: 0.7,
        speed: 30.0,
    };
    check(
        &slider_crank(turn, [0.0, -9.81, 0.0], true).compiled,
        0.02,
        0.1,
    );
}
