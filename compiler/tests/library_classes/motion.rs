//! Φ̇ and γ against Φ along smooth motions of the markers.

use super::evaluate::evaluate;
use super::instance::Instance;
use super::jacobian::columns;
use super::states::{curvature, doubles, slope};
use crate::support::{Random, call};
use eng_system::code::Function;

/// s. The markers turn with up to 150 rad/s: the motion's next terms are (ωt)² = 2e-16 of the first,
/// extrapolated away, and a second difference keeps 1e-31/1e-20 of Φ, in units of ω² below 1e-14.
const INTERVAL: f64 = 1e-10;
/// Allowed deviation, as a share of the sum of magnitudes of the terms; the values of the generated
/// code have their own rounding.
const TOLERANCE: f64 = 1e-9;

#[test]
fn rates_of_constraints_follow_the_motion() {
    let mut checked = 0;
    for instance in Instance::all() {
        let layout = instance.layout;
        let rows = layout.rows as usize;
        let mut random = Random(53);
        let mut largest = 0.0_f64;
        for _ in 0..20 {
            let state = instance.state(&mut random);
            let accelerations: Vec<[f64; 6]> = (0..layout.markers)
                .map(|_| [300.0, 300.0, 300.0, 1e4, 1e4, 1e4].map(|size: f64| size * random.unit()))
                .collect();
            let machine = |function| call(&*instance.machine, function, &state, &instance.tables);
            let rates = machine(Function::Velocity);
            assert_eq!(rates.len(), 2 * rows);
            let start = doubles(&state);
            let state_rates =
                doubles(&machine(Function::Residual)[rows + 6 * layout.markers as usize..]);
            let along = |t| {
                let later = instance.after(&start, &accelerations, &state_rates, t);
                evaluate(&instance.functions.residual, &later, &instance.tables)[..rows].to_vec()
            };
            let (first, second) = (slope(INTERVAL, along), curvature(INTERVAL, along));
            let gradients = columns(&instance, &state);
            for row in 0..rows {
                let entry =
                    |m: u32, k: usize| gradients[layout.pose_direction(m) as usize + k][row];
                let terms = |of: &dyn Fn(u32, usize) -> f64| -> Vec<f64> {
                    (0..layout.markers)
                        .flat_map(|m| (0..6).map(move |k| (m, k)))
                        .map(|(m, k)| entry(m, k) * of(m, k))
                        .collect()
                };
                let size = |terms: &[f64]| terms.iter().map(|x| x.abs()).sum::<f64>();
                let velocities = terms(&|m, k| state[layout.marker(m) as usize + 12 + k]);
                let pushed = terms(&|m, k| accelerations[m as usize][k]);
                // Φ̇ at the twists; Φ̈ = G v̇ − γ
                let gamma = rates[rows + row];
                let second_rate = pushed.iter().sum::<f64>() - gamma;
                for (found, expected, size) in [
                    (rates[row], first[row], size(&velocities) + first[row].abs()),
                    (second_rate, second[row], size(&pushed) + gamma.abs()),
                ] {
                    let error = (found - expected).abs() / size;
                    assert!(
                        error <= TOLERANCE,
                        "{} {row}: {found} {expected}, {error:.1e}",
                        instance.case.class
                    );
                    largest = largest.max(error);
                    checked += 1;
                }
            }
        }
        if rows > 0 {
            println!("{}: {largest:.1e}", instance.case.class);
        }
    }
    assert!(checked > 1000);
}
