//! `Linearize` and `Tangent` against differences of `Residual`, taken in numbers of twice the precision;
//! reactions against G.

use super::evaluate::evaluate;
use super::instance::Instance;
use super::states::{doubles, slope};
use crate::support::magnitudes::{with_magnitudes, with_magnitudes_from};
use crate::support::{Random, call};
use eng_compiler::ir::ClassFunctions;
use eng_system::code::Function;

/// Increment of the differences, of a direction's natural size: truncation and rounding are both below 1e-15.
const INCREMENT: f64 = 1e-9;
/// Allowed deviation, as a share of the norm of a row over the directions of one kind, each of them in its natural
/// size.
const TOLERANCE: f64 = 1e-8;
/// Where the norm is below this part of the row's sum of magnitudes, the entries cancel (most are zero except for
/// rounding). They are then compared with the sum.
const CANCELLED: f64 = 1e-7;
/// Allowed deviation, as a share of that sum.
const ROUNDING: f64 = 1e-14;

/// Columns of the Jacobian by the generated code.
pub fn columns(instance: &Instance, state: &[f64]) -> Vec<Vec<f64>> {
    let directions = instance.layout.directions() as usize;
    let tape = call(
        &*instance.machine,
        Function::Linearize,
        state,
        &instance.tables,
    );
    (0..directions)
        .map(|d| {
            let mut inputs = tape.clone();
            inputs.extend((0..directions).map(|i| if i == d { 1.0 } else { 0.0 }));
            call(
                &*instance.machine,
                Function::Tangent,
                &inputs,
                &instance.tables,
            )
        })
        .collect()
}

/// The sum of magnitudes of each row, directions in their natural sizes.
pub fn row_magnitudes(instance: &Instance, functions: &ClassFunctions, state: &[f64]) -> Vec<f64> {
    let directions = instance.layout.directions() as usize;
    let (tape, sizes): (Vec<f64>, Vec<f64>) =
        with_magnitudes(&functions.linearize, state, &instance.tables)
            .into_iter()
            .unzip();
    let mut rows = vec![0.0; instance.layout.residual_len() as usize];
    for d in 0..directions {
        let seeds = (0..directions).map(|i| if i == d { 1.0 } else { 0.0 });
        let inputs: Vec<f64> = tape.iter().copied().chain(seeds.clone()).collect();
        let sizes: Vec<f64> = sizes.iter().copied().chain(seeds).collect();
        let column = with_magnitudes_from(&functions.tangent, &inputs, &sizes, &instance.tables);
        for (row, (_, size)) in rows.iter_mut().zip(column) {
            *row += size * instance.scale(d as u32);
        }
    }
    rows
}

/// Columns of the Jacobian by differences.
fn differences(instance: &Instance, state: &[f64]) -> Vec<Vec<f64>> {
    let state = doubles(state);
    (0..instance.layout.directions())
        .map(|d| {
            slope(INCREMENT * instance.scale(d), |h| {
                let moved = instance.moved(&state, d, h);
                evaluate(&instance.functions.residual, &moved, &instance.tables)
            })
        })
        .collect()
}

/// The largest deviation in a row, as a share of the norm of the row over the directions of one kind: lengths and
/// angles of poses, velocities and angular velocities of twists, states. Directions have their natural sizes, so that
/// no kind hides behind the units of another.
fn worst(instance: &Instance, state: &[f64], exact: &[Vec<f64>], numeric: &[Vec<f64>]) -> f64 {
    let magnitudes = row_magnitudes(instance, &instance.functions, state);
    let directions = instance.layout.directions();
    let twists = 6 * instance.layout.markers;
    let kind = |d: u32| match d {
        d if d < twists => d % 6 / 3,
        d if d < 2 * twists => 2 + d % 6 / 3,
        _ => 4,
    };
    let mut worst = 0.0_f64;
    for row in 0..instance.layout.residual_len() as usize {
        let entry = |d: u32| numeric[d as usize][row] * instance.scale(d);
        let norm = |keep: &dyn Fn(u32) -> bool| {
            (0..directions)
                .filter(|d| keep(*d))
                .map(|d| entry(d) * entry(d))
                .sum::<f64>()
                .sqrt()
        };
        for d in 0..directions {
            let miss = (exact[d as usize][row] * instance.scale(d) - entry(d)).abs();
            let block = norm(&|e| kind(e) == kind(d));
            let part = if block > CANCELLED * magnitudes[row] {
                miss / block
            } else if miss <= ROUNDING * magnitudes[row] {
                0.0
            } else {
                f64::INFINITY
            };
            worst = worst.max(if part.is_nan() { f64::INFINITY } else { part });
        }
    }
    worst
}

#[test]
fn jacobian_agrees_with_differences() {
    for instance in Instance::all() {
        let mut random = Random(41);
        let mut largest = 0.0_f64;
        let count = if instance.case.kind == "journal" {
            60
        } else {
            12
        };
        for _ in 0..count {
            let state = instance.state(&mut random);
            let exact = columns(&instance, &state);
            let miss = worst(&instance, &state, &exact, &differences(&instance, &state));
            assert!(
                miss <= TOLERANCE,
                "{}: {miss:.1e} of a row's norm",
                instance.case.class
            );
            largest = largest.max(miss);
        }
        println!("{}: {largest:.1e}", instance.case.class);
    }
}

/// The comparison sees a millionth of any entry that matters to its row.
#[test]
fn a_wrong_entry_is_seen() {
    let mut seen = 0;
    for instance in Instance::all() {
        let state = instance.state(&mut Random(41));
        let exact = columns(&instance, &state);
        let numeric = differences(&instance, &state);
        let magnitudes = row_magnitudes(&instance, &instance.functions, &state);
        for (d, column) in exact.iter().enumerate() {
            for (row, entry) in column.iter().enumerate() {
                if entry.abs() * instance.scale(d as u32) > 0.05 * magnitudes[row] {
                    let mut wrong = exact.clone();
                    wrong[d][row] += 1e-6 * entry;
                    let miss = worst(&instance, &state, &wrong, &numeric);
                    assert!(
                        miss > TOLERANCE,
                        "{} {row} {d}: {miss}",
                        instance.case.class
                    );
                    seen += 1;
                }
            }
        }
    }
    assert!(seen > 300, "{seen}");
}

/// The wrenches are the loads less Gᵀλ: linear in λ, with the tangent's G; also a reaction does the work of Φ
/// by differences.
#[test]
fn reactions_are_the_gradient_of_the_constraints() {
    for instance in Instance::all() {
        let layout = instance.layout;
        let rows = layout.rows as usize;
        let mut random = Random(43);
        for _ in 0..12 {
            let state = instance.state(&mut random);
            let residual = |state: &[f64]| {
                call(
                    &*instance.machine,
                    Function::Residual,
                    state,
                    &instance.tables,
                )
            };
            let mut free = state.clone();
            for row in 0..layout.rows {
                free[layout.multiplier(row) as usize] = 0.0;
            }
            let (with, without) = (residual(&state), residual(&free));
            let gradients = columns(&instance, &free);
            let state = doubles(&state);
            for d in 0..6 * layout.markers {
                let multiplier = |row: usize| state[layout.multiplier(row as u32) as usize].high;
                let terms: Vec<f64> = (0..rows)
                    .map(|row| multiplier(row) * gradients[d as usize][row])
                    .collect();
                let by_differences: f64 = slope(INCREMENT * instance.scale(d), |h| {
                    let moved = instance.moved(&state, d, h);
                    evaluate(&instance.functions.residual, &moved, &instance.tables)[..rows]
                        .to_vec()
                })
                .iter()
                .enumerate()
                .map(|(row, slope)| multiplier(row) * slope)
                .sum();
                let at = rows + d as usize;
                let reaction = with[at] - without[at];
                let size = terms.iter().map(|x| x.abs()).sum::<f64>() + without[at].abs();
                for work in [terms.iter().sum(), by_differences] {
                    let error = f64::abs(reaction + work);
                    assert!(
                        error <= 1e-11 * size,
                        "{} {d}: {reaction} {work}",
                        instance.case.class
                    );
                }
            }
        }
    }
}

/// No derivative is taken with respect to time. The effect of time is in the rate of Φ at rest.
#[test]
fn rates_at_rest_are_the_slope_over_time() {
    let mut moving = 0;
    for instance in Instance::all() {
        let layout = instance.layout;
        let rows = layout.rows as usize;
        let mut random = Random(47);
        for _ in 0..12 {
            let mut state = instance.state(&mut random);
            for marker in 0..layout.markers {
                let at = layout.marker(marker) as usize;
                state[at + 12..at + 18].fill(0.0);
            }
            let rates = call(
                &*instance.machine,
                Function::Velocity,
                &state,
                &instance.tables,
            );
            let start = doubles(&state);
            let slopes = slope(1e-11, |h| {
                let mut later = start.clone();
                later[0] = later[0] + h;
                evaluate(&instance.functions.residual, &later, &instance.tables)
            });
            for row in 0..rows {
                let size = slopes[row].abs();
                moving += usize::from(size > 0.0);
                assert!(
                    (rates[row] - slopes[row]).abs() <= 1e-9 * size,
                    "{} {row}: {} {}",
                    instance.case.class,
                    rates[row],
                    slopes[row]
                );
            }
        }
    }
    assert!(moving >= 48, "drives move with time");
}
