//! Generated code against the interpreter: the same bits, also where the number of instances is odd.

use super::double::Double;
use super::evaluate::evaluate;
use super::instance::Instance;
use super::states::doubles;
use crate::support::Random;
use crate::support::magnitudes::with_magnitudes;
use eng_system::code::{Function, Pair};

/// Values of one instance by the interpreter, with the same inputs in both lanes.
fn alone(instance: &Instance, function: Function, inputs: &[f64]) -> Vec<f64> {
    crate::support::call(&*instance.interpreter, function, inputs, &instance.tables)
}

/// Values of several instances in pairs by generated code. The last of an odd number is in both
/// lanes.
fn in_pairs(instance: &Instance, function: Function, inputs: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let mut results = Vec::new();
    for pair in inputs.chunks(2) {
        let (first, second) = (&pair[0], &pair[pair.len() - 1]);
        let inputs: Vec<Pair> = first.iter().zip(second).map(|(a, b)| [*a, *b]).collect();
        let mut outputs = vec![[f64::NAN; 2]; instance.machine.shape(function).1];
        assert!(
            instance
                .machine
                .call(function, &inputs, &mut outputs, &instance.tables)
        );
        for lane in 0..pair.len() {
            results.push(outputs.iter().map(|p| p[lane]).collect());
        }
    }
    results
}

#[test]
fn machine_code_has_the_interpreters_bits() {
    for instance in Instance::all() {
        let layout = instance.layout;
        let mut random = Random(31);
        for count in [1, 2, 3, 5, 8, 13] {
            let states: Vec<Vec<f64>> = (0..count).map(|_| instance.state(&mut random)).collect();
            let mut tapes: Vec<Vec<f64>> = Vec::new();
            for function in Function::ALL {
                assert_eq!(
                    instance.machine.shape(function),
                    instance.interpreter.shape(function)
                );
                let inputs: Vec<Vec<f64>> = if function == Function::Tangent {
                    tapes
                        .iter()
                        .map(|tape| {
                            let seeds = (0..layout.directions()).map(|_| random.unit());
                            tape.iter().copied().chain(seeds).collect()
                        })
                        .collect()
                } else {
                    states.clone()
                };
                let generated = in_pairs(&instance, function, &inputs);
                assert_eq!(generated.len(), count);
                for (k, (found, inputs)) in generated.iter().zip(&inputs).enumerate() {
                    let expected = alone(&instance, function, inputs);
                    for (i, (a, b)) in found.iter().zip(&expected).enumerate() {
                        assert!(
                            a.to_bits() == b.to_bits() && a.is_finite(),
                            "{} {function:?} {i} of instance {k} of {count}: {a:e} {b:e}",
                            instance.case.class
                        );
                    }
                }
                if function == Function::Linearize {
                    tapes = generated;
                }
            }
        }
    }
}

/// The numbers in one lane do not depend on those in the other.
#[test]
fn lanes_do_not_see_each_other() {
    for instance in Instance::all() {
        let mut random = Random(37);
        let state = instance.state(&mut random);
        for other in [f64::NAN, f64::INFINITY, 0.0, -1e300] {
            for lane in 0..2 {
                let inputs: Vec<Pair> = state
                    .iter()
                    .map(|x| {
                        let mut pair = [other; 2];
                        pair[lane] = *x;
                        pair
                    })
                    .collect();
                for function in [
                    Function::Residual,
                    Function::Linearize,
                    Function::Velocity,
                    Function::Outputs,
                    Function::Conditions,
                    Function::Rotations,
                ] {
                    let mut outputs = vec![[f64::NAN; 2]; instance.machine.shape(function).1];
                    assert!(instance.machine.call(
                        function,
                        &inputs,
                        &mut outputs,
                        &instance.tables
                    ));
                    let expected = alone(&instance, function, &state);
                    for (found, expected) in outputs.iter().zip(&expected) {
                        assert_eq!(
                            found[lane].to_bits(),
                            expected.to_bits(),
                            "{} {function:?}",
                            instance.case.class
                        );
                    }
                }
            }
        }
    }
}

/// Both compute the values of the graph, which are evaluated in numbers of twice the precision.
#[test]
fn values_are_those_of_higher_precision() {
    for instance in Instance::all() {
        let mut random = Random(89);
        let mut largest = 0.0_f64;
        for _ in 0..20 {
            let state = instance.state(&mut random);
            for which in [
                Function::Residual,
                Function::Linearize,
                Function::Velocity,
                Function::Outputs,
                Function::Conditions,
                Function::Rotations,
            ] {
                let function = instance.functions.get(which);
                let found =
                    crate::support::call(&*instance.machine, which, &state, &instance.tables);
                let sizes = with_magnitudes(function, &state, &instance.tables);
                let exact = evaluate(function, &doubles(&state), &instance.tables);
                for (row, ((found, exact), (_, size))) in
                    found.iter().zip(&exact).zip(sizes).enumerate()
                {
                    let error = (Double::from(*found) - *exact).high.abs();
                    assert!(
                        error <= 1e-12 * size,
                        "{} {which:?} {row}: {found:e} {:e} of {size:e}",
                        instance.case.class,
                        exact.high
                    );
                    largest = largest.max(if error == 0.0 { 0.0 } else { error / size });
                }
            }
        }
        println!("{}: {largest:.1e}", instance.case.class);
    }
}
