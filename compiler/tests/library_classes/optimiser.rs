//! Functions as they are compiled against the same without the optimiser, in a graph that neither folds nor shares.

use super::evaluate::plain;
use super::instance::Instance;
use super::jacobian::{columns, row_magnitudes};
use crate::support::magnitudes::with_magnitudes;
use crate::support::{Random, call};
use eng_compiler::generate::compile_class;
use eng_compiler::ir::{ClassBody, ClassFunctions};
use eng_system::code::Function;

/// Allowed deviation, as a share of the sum of magnitudes of a row.
const TOLERANCE: f64 = 1e-12;

fn as_written(instance: &Instance) -> ClassFunctions {
    ClassBody {
        graph: plain(&instance.body.graph),
        ..instance.body.clone()
    }
    .functions_as_written()
    .expect("a good class")
}

#[test]
fn optimised_functions_agree_with_those_as_written() {
    for instance in Instance::all() {
        let written = as_written(&instance);
        assert!(
            instance.functions.residual.graph.nodes().len() < written.residual.graph.nodes().len()
        );
        let mut random = Random(59);
        let mut largest = 0.0_f64;
        for _ in 0..20 {
            let state = instance.state(&mut random);
            for which in [
                Function::Residual,
                Function::Velocity,
                Function::Outputs,
                Function::Conditions,
                Function::Rotations,
            ] {
                let values = call(&*instance.machine, which, &state, &instance.tables);
                let expected = with_magnitudes(written.get(which), &state, &instance.tables);
                assert_eq!(values.len(), expected.len());
                for (row, (value, (expected, size))) in values.iter().zip(expected).enumerate() {
                    let error = (value - expected).abs();
                    assert!(
                        error <= TOLERANCE * size,
                        "{} {which:?} {row}: {value} {expected} of {size}",
                        instance.case.class
                    );
                    largest = largest.max(if error == 0.0 { 0.0 } else { error / size });
                }
            }
        }
        println!("{}: {largest:.1e}", instance.case.class);
    }
}

/// The tapes differ, because the elimination depends on the shared expressions. The Jacobians are
/// the same.
#[test]
fn optimised_jacobians_agree_with_those_as_written() {
    for mut instance in Instance::all() {
        let functions = as_written(&instance);
        let written = compile_class(&functions, false).expect("is ready");
        let mut random = Random(61);
        let mut largest = 0.0_f64;
        for _ in 0..10 {
            let state = instance.state(&mut random);
            let found = columns(&instance, &state);
            let machine = std::mem::replace(&mut instance.machine, written.clone());
            let expected = columns(&instance, &state);
            instance.machine = machine;
            let sizes = row_magnitudes(&instance, &functions, &state);
            for (row, size) in sizes.into_iter().enumerate() {
                for (d, (a, b)) in found.iter().zip(&expected).enumerate() {
                    let error = (a[row] - b[row]).abs() * instance.scale(d as u32);
                    assert!(
                        error <= TOLERANCE * size,
                        "{} row {row} direction {d}: {} {}",
                        instance.case.class,
                        a[row],
                        b[row]
                    );
                    largest = largest.max(if error == 0.0 { 0.0 } else { error / size });
                }
            }
        }
        println!("{}: {largest:.1e}", instance.case.class);
    }
}
