//! Mounts of `std.mounts`: frequency, damping and sag against the complex stiffness.

use crate::library_run::{Complex, close, column, integral, last, over, plus, root, run, times};
use eng::results::Results;
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

/// A box of 50 kg on a bushing with the loss factor 0.2 at 20 Hz, which is pushed along z and twisted about y.
const BUSHING: &str = "use std.mounts.RubberBushing
        force Shake(a: Marker, push: Force, twist: Torque) {
            apply force push*ground.z on a
            apply torque twist*ground.y on a
        }
        model Mount {
            input push: Force = 0 N
            input twist: Torque = 0 N*m
            gravity = [0, 0, -9.81] m/s^2
            marker floor = [0, 0, 0] mm
            body box { mass = 50 kg; inertia = [1, 2, 3] kg*m^2; marker foot = origin }
            force mount = RubberBushing(box.foot, floor, stiffness: [100, 200, 300] N/mm, torsional_stiffness: [300, 400, 500] N*m/rad,
                loss: 0.2, loss_at: 20 Hz, preload: [0, 0, 490.5] N)
            force shake = Shake(box.foot, push: push, twist: twist)
            output sag = dot(box.foot.origin - floor.origin, ground.z) as um
        }
        analysis rest = static(Mount(push: 30 N, twist: 2 N*m))
        analysis pushed = response(Mount(), to: push, of: [mount.force.z, mount.deflection.z], from: 2 Hz, up_to: 400 Hz)
        analysis twisted = response(Mount(), to: twist, of: [mount.torque.y, mount.twist.y], from: 2 Hz, up_to: 400 Hz)";

/// The share of the branch's stiffness and its rate for a loss factor of 0.2 at 20 Hz: half of both has the largest loss factor there.
const SHARE: f64 = 0.487_921_561_087_422_8;
const RATE: f64 = 2.0 * PI * 20.0 * 1.219_803_902_718_557;

/// Stiffness over that at rest.
fn stiffer(s: Complex) -> Complex {
    let branch = over(times((SHARE, 0.0), s), plus(s, (RATE, 0.0)));
    plus((1.0, 0.0), branch)
}

/// Amplitude and phase of a column of a response as a complex number.
fn answer(results: &Results, path: &str, row: usize) -> Complex {
    let (size, phase) = (
        column(results, path)[row],
        column(results, &format!("{path}.phase"))[row],
    );
    (size * phase.cos(), size * phase.sin())
}

#[test]
fn a_bushing_yields_by_its_static_stiffnesses() {
    let results = run(BUSHING, "rest");
    close("sag", last(&results, "sag"), 30.0 / 3e5, 1e-9);
    // the law takes the sine of the turn
    close("turn", last(&results, "mount.twist.y"), 2.0 / 400.0, 1e-9);
    close(
        "energy",
        last(&results, "mount.stored_energy"),
        0.5 * (30.0 * 1e-4 + 2.0 * 5e-3) - 490.5 * 1e-4,
        1e-9,
    );
}

/// Force over displacement, and the share of a load that reaches the floor, `K/(K + m s^2)`, at all frequencies; the loss factor.
#[test]
fn a_bushing_has_its_complex_stiffness() {
    let at = |hertz: f64| stiffer((0.0, 2.0 * PI * hertz));
    let factor = |hertz: f64| at(hertz).1 / at(hertz).0;
    close("loss", factor(20.0), 0.2, 1e-12);
    assert!(factor(19.5) < 0.2 && factor(20.5) < 0.2);
    close("beside", factor(10.0), 0.16, 1e-12);
    close(
        "dynamic",
        at(20.0).0,
        2.0 * (1.0 + SHARE) / (2.0 + SHARE),
        1e-12,
    );
    for (analysis, rest, mass, load, way) in [
        ("pushed", 3e5, 50.0, "mount.force.z", "mount.deflection.z"),
        ("twisted", 400.0, 2.0, "mount.torque.y", "mount.twist.y"),
    ] {
        let results = run(BUSHING, analysis);
        let mut worst = 0.0_f64;
        for (row, hertz) in column(&results, "frequency").iter().enumerate() {
            let s = (0.0, 2.0 * PI * hertz);
            let stiffness = times((rest, 0.0), stiffer(s));
            let passed = over(stiffness, plus(stiffness, times((mass, 0.0), times(s, s))));
            let found = answer(&results, load, row);
            let miss = plus(found, passed);
            worst = worst.max(miss.0.hypot(miss.1) / passed.0.hypot(passed.1));
            let found = over(found, answer(&results, way, row));
            let miss = plus(found, stiffness);
            worst = worst.max(miss.0.hypot(miss.1) / stiffness.0.hypot(stiffness.1));
        }
        println!("{analysis}: {worst:.1e}");
        assert!(worst < 1e-7, "{analysis}: {worst}");
    }
}

/// The heat of a cycle at 40 Hz is `pi Im(K) amplitude^2`.
#[test]
fn a_bushing_makes_the_heat_of_its_loop() {
    let text = "use std.mounts.RubberBushing
        use std.joints.Translational
        use std.drives.PrescribedTravel
        fn wave(t: Time) -> Length = 0.2 mm*sin(2*pi*40 rad/s * t)
        model Shaken {
            gravity = [0, 0, 0] m/s^2
            marker floor = [0, 0, 0] mm
            body box { mass = 5 kg; inertia = [1, 1, 1] g*m^2; marker foot = origin }
            joint guide = Translational(box.foot, floor)
            drive shake = PrescribedTravel(box.foot, floor, travel_at: wave)
            force mount = RubberBushing(box.foot, floor, stiffness: [100, 200, 300] N/mm, torsional_stiffness: [300, 400, 500] N*m/rad,
                loss: 0.2, loss_at: 20 Hz)
        }
        analysis run = transient(Shaken(), duration: 0.5 s, sample: 0.5 ms)";
    let results = run(text, "run");
    let last = 800..1001;
    let heat = integral(
        &column(&results, "time")[last.clone()],
        &column(&results, "mount.power_loss")[last],
    );
    let loss = 3e5 * stiffer((0.0, 2.0 * PI * 40.0)).1;
    close("heat", heat, 4.0 * PI * loss * 0.2e-3 * 0.2e-3, 1e-3);
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
