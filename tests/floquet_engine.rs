//! Modes of engines over a cycle, by Floquet's multipliers, against the decay of their transients.

use crate::support::{outcome, program_of, recurrence};
use eng::{Coefficients, LinearModes, Mode, Program};
use nalgebra::Complex;
use std::f64::consts::TAU;

fn program(analyses: &str) -> Program {
    let text = include_str!("../examples/inline4/inline4.eng");
    let pressure = include_str!("../examples/inline4/pressure.csv");
    let text = format!("{text}\n{analyses}");
    program_of(&[("inline4.eng", &text), ("pressure.csv", pressure)])
}

fn modes(program: &Program, analysis: &str) -> LinearModes {
    outcome(program, analysis).modes.expect("modes")
}

/// μ of the oscillation of the values at the beginning of each cycle, from `y(k+2) = s y(k+1) − p y(k)`: the whirls
/// in the films have decayed after a cycle.
fn multiplier(values: &[f64]) -> Complex<f64> {
    let swing: Vec<f64> = values.windows(2).map(|w| w[1] - w[0]).collect();
    let (s, p) = recurrence(&swing);
    Complex::new(0.5 * s, (p - 0.25 * s * s).sqrt())
}

/// A four-cylinder engine on films over two turns, unfired and fired: the torsion of the drive line, the slowest
/// motion, decays from cycle to cycle as in the transient. The dynamometer holds the phase: no multiplier is
/// neutral.
#[test]
fn an_engine_over_a_cycle() {
    let program = program(
        "analysis unfired_cycle = linear(Inline4(combustion: 0), after: 2 rev, over: 2 rev)
        analysis fired_cycle = linear(Inline4(combustion: 1), after: 2 rev, over: 2 rev)
        analysis unfired_decay = transient(Inline4(combustion: 0), duration: 24 rev, sample: 720 deg)",
    );
    let results = outcome(&program, "unfired_decay").results;
    let torque = &results
        .column("engine.brake_torque")
        .expect("a column")
        .values;
    let due = multiplier(&torque[2..]);
    for name in ["unfired_cycle", "fired_cycle"] {
        let found = modes(&program, name);
        assert_eq!(found.coefficients, Coefficients::Periodic);
        assert_eq!(found.zeros, 0, "{found:?}");
        assert!(found.modes.iter().all(|m| !m.grows()), "{found:?}");
        let orbit = found.orbit.as_ref().expect("an orbit");
        // two turns at the dynamometer's 4000 rpm, though the crank's speed swings
        assert!((orbit.period / 30e-3 - 1.0).abs() < 1e-9, "{orbit:?}");
        let slowest = |a: &&Mode, b: &&Mode| a.value.re.total_cmp(&b.value.re);
        let torsion = found.modes.iter().max_by(slowest).expect("a mode");
        let found = (torsion.value * orbit.period).exp();
        println!("{name}: {found}, of the transient {due}; {}", torsion.value);
        let off = (found - due).norm().min((found.conj() - due).norm());
        // gas does not touch the drive line but by the speed's own swing
        let allowed = if name == "unfired_cycle" { 1e-3 } else { 1e-2 };
        assert!(off < allowed * due.norm(), "{name}: {found} {due} {off:e}");
        assert!((torsion.value.im / TAU - 56.1).abs() < 0.1);
    }
}
