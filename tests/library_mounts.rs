//! Mounts of `std.mounts`: frequency, damping and sag against the complex stiffness.

use crate::library_run::{Complex, close, column, last, over, plus, root, run, times};
use std::f64::consts::PI;

/// The slowest oscillation of a linear analysis against the root of m s² + K(s).
fn rings(text: &str, mass: f64, stiffness: &dyn Fn(Complex) -> Complex, first: &[f64]) {
    let results = run(text, "modes");
    let (frequency, damping) = (
        column(&results, "frequency"),
        column(&results, "damping_ratio"),
    );
    for guess in first {
        let balance = |s: Complex| plus(times((mass, 0.0), times(s, s)), stiffness(s));
        let pole = root(&balance, (-0.05 * guess * 2.0 * PI, guess * 2.0 * PI));
        let due = pole.1 / (2.0 * PI);
        let nearest = (0..frequency.len())
            .min_by(|a, b| {
                (frequency[*a] - due)
                    .abs()
                    .total_cmp(&(frequency[*b] - due).abs())
            })
            .expect("a mode");
        close("frequency", frequency[nearest], due, 1e-7);
        close(
            "damping",
            damping[nearest],
            -pole.0 / pole.0.hypot(pole.1),
            1e-6,
        );
    }
}

#[test]
fn a_rubber_mount_rings_and_sags() {
    let text = "use std.mounts.ElastomerMount
        use std.joints.Translational
        model Mount {
            gravity = [0, 0, -9.81] m/s^2
            marker floor = [0, 0, 0] mm
            body box { mass = 50 kg; inertia = [1, 1, 1] kg*m^2; marker foot = origin }
            joint guide = Translational(box.foot, floor)
            force mount = ElastomerMount(box.foot, floor, stiffness: [100, 200, 300] N/mm, fast_stiffness: [50, 50, 80] N/mm,
                relaxation: 3 ms, preload: [0, 0, 100] N)
        }
        analysis settle = transient(Mount(), duration: 8 s, sample: 0.1 s)
        analysis rest = static(Mount())
        analysis modes = linear(Mount())";
    let sag = -(490.5 - 100.0) / 3e5;
    close("sag", last(&run(text, "settle"), "guide.travel"), sag, 1e-6);
    close(
        "balance",
        last(&run(text, "rest"), "guide.travel"),
        sag,
        1e-9,
    );
    let stiffness = |s: Complex| {
        let x = times(s, (3e-3, 0.0));
        plus((3e5, 0.0), times((8e4, 0.0), over(x, plus((1.0, 0.0), x))))
    };
    rings(text, 50.0, &stiffness, &[12.5]);
}

/// Both oscillations of a mass on a hydraulic mount: the roots of
/// `m s² + k + c s + A² s (I s + R)/(1 + s C (I s + R))`.
#[test]
fn a_hydraulic_mount_has_two_oscillations() {
    let text = "use std.mounts.HydraulicMount
        use std.joints.Translational
        model Mount {
            gravity = [0, 0, -9.81] m/s^2
            marker floor = [0, 0, 0] mm
            body box { mass = 50 kg; inertia = [1, 1, 1] kg*m^2; marker foot = origin }
            joint guide = Translational(box.foot, floor)
            force mount = HydraulicMount(box.foot, floor, stiffness: 200 N/mm, damping: 100 N*s/m, free_length: 10 mm, piston: 30 cm^2,
                compliance: 3e-11 m^3/Pa, inertance: 4e6 Pa*s^2/m^3, resistance: 2e7 Pa*s/m^3, orifice: 1e12 Pa*s^2/m^6)
        }
        analysis rest = static(Mount())
        analysis modes = linear(Mount())";
    close(
        "sag",
        last(&run(text, "rest"), "guide.travel"),
        0.01 - 490.5 / 2e5,
        1e-9,
    );
    let channel = |s: Complex| plus(times((4e6, 0.0), s), (2e7, 0.0));
    let stiffness = |s: Complex| {
        let below = plus((1.0, 0.0), times(times(s, (3e-11, 0.0)), channel(s)));
        let fluid = over(times(times((9e-6, 0.0), s), channel(s)), below);
        plus(plus((2e5, 0.0), times((100.0, 0.0), s)), fluid)
    };
    rings(text, 50.0, &stiffness, &[8.0, 20.0]);
}
