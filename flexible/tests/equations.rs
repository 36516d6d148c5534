//! Solutions of equations that hold freedoms.

use eng_flexible::internals::{eliminate, static_solution};
use eng_flexible::sparse::SymmetricMatrix;

#[test]
fn solutions_satisfy_all_equations_and_dependent_ones_are_dropped() {
    let equations = vec![
        vec![(0, 1.0), (1, 2.0), (2, 3.0)],
        vec![(1, 1.0), (2, -1.0), (5, 0.5)],
        // the sum of the first two
        vec![(0, 1.0), (1, 3.0), (2, 2.0), (5, 0.5)],
    ];
    let solution = eliminate(equations.clone());
    assert_eq!(solution.len(), 2);
    let value = |freedom: u32| match solution.get(&freedom) {
        Some(sum) => sum.iter().map(|&(f, x)| x * f64::from(f + 1)).sum::<f64>(),
        None => f64::from(freedom + 1),
    };
    for equation in equations {
        let sum: f64 = equation.iter().map(|&(f, x)| x * value(f)).sum();
        assert!(sum.abs() < 1e-14);
    }
    assert!(
        solution
            .values()
            .flatten()
            .all(|(f, _)| !solution.contains_key(f))
    );
}

#[test]
fn a_structure_that_is_held_everywhere_does_not_move() {
    let entries = [(0, 0, 1.0), (1, 1, 1.0)];
    let Ok(stiffness) = SymmetricMatrix::from_triplets(2, &entries) else {
        panic!("a matrix");
    };
    let mut loads = vec![1.0, 2.0, 3.0, 4.0];
    let solved = static_solution(&stiffness, &[true, true], &mut loads);
    assert!(solved.is_ok() && loads.iter().all(|x| *x == 0.0));
}
