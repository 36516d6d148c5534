//! Free motions with states of elements: their zeros, responses by the dynamic stiffness, and slow growth.

use crate::support::{outcome, program};
use eng::{Error, RuntimeError};
use eng_runtime::LinearModes;
use nalgebra::{Complex, DMatrix, DVector};
use std::f64::consts::TAU;

fn modes(text: &str) -> LinearModes {
    outcome(&program(text), "small").modes.expect("modes")
}

fn assert_near(found: f64, due: f64, share: f64) {
    println!("{found} for {due}");
    assert!(
        (found / due - 1.0).abs() < share,
        "{found} instead of {due}"
    );
}

/// A train that turns freely, with a rubber of three lags, and a weak spring to the ground.
fn train(holds: &str) -> String {
    format!(
        "use std.joints.Revolute
        use std.drivelines.RubberRing
        use std.forces.TorsionSpring
        force Moment(a: Marker, b: Marker, load: Torque) {{ apply torque load*b.z on a against b }}
        force Weak(a: Marker, b: Marker, stiffness: TorsionalStiffness) {{
            apply torque -stiffness*rotation(a, b)*b.z on a against b
        }}
        force Leaking(a: Marker, b: Marker, rate: Frequency) {{
            state z: Angle = 0 deg scale 1 deg
            der(z) = rate*z
            apply torque 1e-9 N*m/rad*z*b.z on a against b
        }}
        model Train {{
            input pulse: Torque = 0 N*m
            gravity = [0, 0, 0] m/s^2
            marker axis = [0, 0, 0] mm
            body d[k in 1..8] {{
                mass = 10 kg
                inertia = [1, 1, 1]*([0.005, 0.02, 0.03, 0.02, 0.03, 0.03, 0.02, 0.3][k]*(1 kg*m^2))
                marker hub = origin
            }}
            joint j[k in 1..8] = Revolute(d[k].hub, axis)
            force rubber = RubberRing(d[1].hub, d[2].hub, stiffness: 8 kN*m/rad, branch_stiffness: [1, 1, 1] kN*m/rad,
                relaxation: [0.3, 1, 5] ms)
            force s[k in 2..7] = TorsionSpring(d[k].hub, d[k + 1].hub, stiffness: 700 kN*m/rad, damping: 1 N*m*s/rad)
            force t = Moment(d[4].hub, axis, load: pulse)
            {holds}
        }}
        analysis small = linear(Train())
        analysis shaken = response(Train(), to: pulse, of: [j[2].angle], from: 1 Hz, up_to: 1 kHz)"
    )
}

const INERTIAS: [f64; 8] = [0.005, 0.02, 0.03, 0.02, 0.03, 0.03, 0.02, 0.3];

/// The turn of disc 2 (rad) per torque on disc 4, by the dynamic stiffness.
fn turn(f: f64) -> Complex<f64> {
    let s = Complex::new(0.0, TAU * f);
    let rubber = [3e-4, 1e-3, 5e-3]
        .iter()
        .map(|tau| s * *tau / (s * *tau + 1.0) * 1e3);
    let rubber = rubber.sum::<Complex<f64>>() + 8e3;
    let mut matrix = DMatrix::from_fn(8, 8, |i, j| {
        if i == j {
            s * s * INERTIAS[i]
        } else {
            0.0.into()
        }
    });
    for k in 0..7 {
        let spring = if k == 0 { rubber } else { s + 7e5 };
        for (i, j, sign) in [
            (k, k, 1.0),
            (k + 1, k + 1, 1.0),
            (k, k + 1, -1.0),
            (k + 1, k, -1.0),
        ] {
            matrix[(i, j)] += spring * sign;
        }
    }
    let load = DVector::from_fn(8, |i, _| Complex::new(f64::from(u8::from(i == 3)), 0.0));
    matrix.lu().solve(&load).expect("a solution")[1]
}

/// The free turning of the train is a double zero, and no growth: the response is that of the dynamic stiffness.
#[test]
fn a_free_train_with_rubber_turns_and_does_not_grow() {
    let text = train("");
    let found = modes(&text);
    assert_eq!(found.zeros, 2);
    assert!(
        !found.modes.iter().any(|mode| mode.grows()),
        "{:?}",
        found.modes
    );
    assert_eq!((found.oscillations().count(), found.modes.len()), (7, 10));
    let program = program(&text);
    let outcome = program
        .analysis("shaken")
        .expect("an analysis")
        .run(&mut |_| {});
    let results = match outcome {
        Ok(outcome) => outcome.results,
        Err(failed) => panic!("{}", failed.error),
    };
    let column = |path: &str| results.column(path).expect("a column").values.clone();
    let (frequency, size, phase) = (
        column("frequency"),
        column("j[2].angle"),
        column("j[2].angle.phase"),
    );
    let mut worst = 0.0_f64;
    for (row, f) in frequency.iter().enumerate() {
        let found = Complex::from_polar(size[row], phase[row]);
        worst = worst.max((found - turn(*f)).norm() / turn(*f).norm());
    }
    println!("off by {worst:.1e} at {} frequencies", frequency.len());
    assert!(worst < 1e-6, "{worst}");
}

/// Two trains that nothing joins turn freely, each with a double zero.
#[test]
fn free_parts_of_a_train_have_zeros_of_their_own() {
    let text = train("").replace("s[k in 2..7]", "s[k in [2, 3, 5, 6, 7]]");
    let found = modes(&text);
    assert_eq!(found.zeros, 4);
    assert!(
        !found.modes.iter().any(|mode| mode.grows()),
        "{:?}",
        found.modes
    );
}

/// Slow growth is told: a spring of negative stiffness, `sqrt(k/J)`, and a state that grows by itself.
#[test]
fn slow_growth_beside_fast_modes_is_told() {
    let inertia: f64 = INERTIAS.iter().sum();
    for growth in [1e-1, 1e-2, 3e-3] {
        let stiffness = growth * growth * inertia;
        let holds = format!("force w = Weak(d[8].hub, axis, stiffness: -{stiffness:e} N*m/rad)");
        let found = modes(&train(&holds));
        let most = found
            .modes
            .iter()
            .find(|mode| mode.grows())
            .expect("a growing mode");
        assert_near(most.value.re, growth, 1e-2);
        assert_eq!(found.zeros, 0);
    }
    let found = modes(&train("force w = Leaking(d[8].hub, axis, rate: 1e-6 Hz)"));
    let most = found
        .modes
        .iter()
        .find(|mode| mode.grows())
        .expect("a growing mode");
    assert_near(most.value.re, 1e-6, 1e-6);
    let text = train("force w = Weak(d[8].hub, axis, stiffness: -1e-4 N*m/rad)");
    let failed = program(&text)
        .analysis("shaken")
        .expect("an analysis")
        .run(&mut |_| {});
    match *failed.expect_err("it grows").error {
        Error::Run { cause, .. } => {
            assert!(matches!(*cause, RuntimeError::Grows { .. }), "{cause}")
        }
        other => panic!("{other}"),
    }
}
