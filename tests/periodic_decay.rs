//! Reports of `periodic` on motions that shrink, grow, repeat except for errors of the steps, or never repeat.

use crate::support::{Temporary, program};
use std::process::Command;

/// A disc that counts cycles of 0.1 s, and beside it a block of 1 kg on a spring:
/// `x = x₀ exp(−c t/2m) cos …`, so that a cycle takes its deviation to `exp(−0.05 s/kg c)` of itself, and its
/// power, which is quadratic, to the square of that.
fn oscillator(damping: &str, output: &str, analysis: &str) -> String {
    format!(
        "
use std.joints.{{Translational}}
use std.drives.ConstantSpeed
force Mount(a: Marker, b: Marker, k: Stiffness, c: Damping) {{
    let x = dot(a.origin - b.origin, b.z)
    let v = dot(a.velocity - b.velocity, b.z)
    apply force -(k*x + c*v)*b.z on a against b
    {output}
}}
model Beat {{
    gravity = [0, 0, 0] m/s^2
    marker hub = [0, 0, 0] mm
    marker wall = at([200, 0, 0] mm, z: [1, 0, 0])
    body disc {{ mass = 1 kg; inertia = [1, 1, 1] g*m^2 }}
    body block {{ mass = 1 kg; inertia = [1, 1, 1] g*m^2; marker eye = at(origin, z: [1, 0, 0]); start position = [205, 0, 0] mm }}
    drive turn = ConstantSpeed(disc.origin, hub, speed: 600 rpm)
    joint rail = Translational(block.eye, wall)
    force mount = Mount(block.eye, wall, k: 5 N/mm, c: {damping})
    cycle angle = rotation(disc.origin, hub) {{ period = 360 deg }}
}}
analysis steady = periodic(Beat(), start: assembled, sample: 10 deg{analysis})
"
    )
}

/// The output of the command for a text.
fn told(name: &str, text: &str) -> String {
    let folder = Temporary::new(&format!("decay-{name}"));
    std::fs::write(folder.join("m.eng"), text).expect("written");
    let output = Command::new(env!("CARGO_BIN_EXE_eng"))
        .args(["run", "m.eng", "--no-plots"])
        .current_dir(&folder)
        .output()
        .expect("eng runs");
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    format!("{}{}", text(&output.stdout), text(&output.stderr))
}

const POWER: &str = "output heat: Power = c*v*v as W";

#[test]
fn the_factor_is_that_of_the_motion_where_power_changes_most() {
    let text = oscillator("4 N*s/m", POWER, ", cycles: 12");
    let outcome = program(&text)
        .analysis("steady")
        .expect("an analysis")
        .run(&mut |_| {})
        .unwrap_or_else(|failed| panic!("{}", failed.error));
    let found = outcome.periodic.expect("a periodic analysis");
    let due = (-0.05_f64 * 4.0).exp();
    let decay = found.decay.expect("three cycles");
    let channel = outcome.results.columns().len();
    println!("{decay:?} of {channel}, {due}");
    let factor = decay.mode.expect("known").factor;
    assert!(
        (factor / due - 1.0).abs() < 2e-3,
        "{factor} instead of {due}"
    );
    let told = told("power", &text);
    assert!(
        told.contains("deviations of the motion shrink by the factor 0.81"),
        "{told}"
    );
}

/// Deviations of the block shrink by 0.82 in a cycle, so 35 cycles would pass until they are a thousandth. The motion
/// after a leap is the forced vibration `F/(k − m ω² + iωc)`.
#[test]
fn a_slow_decay_is_left_out() {
    let text = oscillator(
        "4 N*s/m",
        "output way: Length = x as mm
    apply force 50 N*sin(20*pi*time/(1 s))*b.z on a against b",
        "",
    );
    let outcome = program(&text)
        .analysis("steady")
        .expect("an analysis")
        .run(&mut |_| {})
        .unwrap_or_else(|failed| panic!("{}", failed.error));
    let found = outcome.periodic.expect("a periodic analysis");
    assert!(found.repeats && found.cycles <= 15, "{found:?}");
    let way = &outcome
        .results
        .column("mount.way")
        .expect("a channel")
        .values;
    let around = &way[1..];
    let part = |wave: fn(f64) -> f64| -> f64 {
        let count = around.len() as f64;
        let turn = |i: usize| std::f64::consts::TAU * i as f64 / count;
        let sum: f64 = around
            .iter()
            .enumerate()
            .map(|(i, x)| x * wave(turn(i)))
            .sum();
        2.0 * sum / count
    };
    let amplitude = part(f64::sin).hypot(part(f64::cos));
    let pace = 20.0 * std::f64::consts::PI;
    let due = 50.0 / (5000.0 - pace * pace).hypot(4.0 * pace);
    println!(
        "{amplitude} mm instead of {due} mm, {} cycles",
        found.cycles
    );
    assert!((amplitude / due - 1.0).abs() < 2e-3, "{amplitude} {due}");
}

/// A disc on a shaft to a motor of constant speed, under a load that varies with the disc's own turn. Deviations shrink
/// by 0.6 in a cycle. The disc ends its cycles earlier or later while they shrink, so a leap changes the time: otherwise
/// the motor would take the twist of the shaft with it. In the limit the mean twist balances the mean load,
/// 10 N m/(250 N m/rad), over time.
#[test]
fn a_leap_leaves_the_motor_at_its_place() {
    let text = "
use std.joints.Revolute
use std.drives.ConstantSpeed
use std.forces.TorsionSpring
force Load(a: Marker, b: Marker) {
    let turn = rotation(a, b)
    apply torque -10 N*m*(1 + 0.5*cos(2*turn))*b.z on a against b
}
model Line {
    gravity = [0, 0, 0] m/s^2
    marker bearing = [0, 0, 0] mm
    body disc { mass = 10 kg; inertia = [60, 60, 100] g*m^2; marker hub = origin; start angular_velocity = [0, 0, 10] rev/s }
    body motor { mass = 1 kg; inertia = [1, 1, 1] g*m^2; marker hub = origin }
    joint journal = Revolute(disc.hub, bearing)
    drive turn = ConstantSpeed(motor.hub, bearing, speed: 10 rev/s)
    force coupling = TorsionSpring(disc.hub, motor.hub, stiffness: 250 N*m/rad, damping: 1 N*m*s/rad)
    force load = Load(disc.hub, bearing)
    cycle angle = rotation(disc.hub, bearing) { period = 360 deg }
}
analysis steady = periodic(Line(), start: assembled, sample: 5 deg)
analysis long = periodic(Line(), start: assembled, sample: 5 deg, change: 1e-5, cycles: 100, step: 200 us)
";
    let run = |analysis: &str| {
        program(text)
            .analysis(analysis)
            .expect("an analysis")
            .run(&mut |_| {})
            .unwrap_or_else(|failed| panic!("{}", failed.error))
    };
    let (steady, long) = (run("steady"), run("long"));
    let twist = |outcome: &eng::Outcome| {
        let column = outcome.results.column("coupling.twist");
        column.expect("a channel").values.clone()
    };
    let (found, due) = (twist(&steady), twist(&long));
    let swing =
        due.iter().fold(f64::MIN, |w, x| w.max(*x)) - due.iter().fold(f64::MAX, |w, x| w.min(*x));
    let off = found.iter().zip(&due);
    let off = off.fold(0.0_f64, |w, (x, y)| w.max((x - y).abs())) / swing;
    let times = steady
        .results
        .column("time")
        .expect("a channel")
        .values
        .clone();
    let sum: f64 = (1..found.len())
        .map(|i| 0.5 * (found[i] + found[i - 1]) * (times[i] - times[i - 1]))
        .sum();
    let mean = sum.abs() / (times[times.len() - 1] - times[0]);
    let periodic = steady.periodic.as_ref().expect("a periodic analysis");
    println!("{off} of the swing, mean {mean}, {periodic:?}");
    assert!(periodic.repeats && periodic.cycles <= 12, "{periodic:?}");
    assert!(off < 2e-3, "{off}");
    // of fixed steps, whose grid begins anew at the other time
    let long = long.periodic.as_ref().expect("a periodic analysis");
    assert!(long.repeats && long.cycles < 29, "{long:?}");
    assert!((mean / 0.04 - 1.0).abs() < 1e-3, "{mean}");
}

#[test]
fn what_grows_is_said_to_grow() {
    let text = oscillator("-20 N*s/m", POWER, ", cycles: 6");
    let told = told("grows", &text);
    assert!(
        told.contains("deviations of the motion grow by the factor 2.7")
            && told.contains("more cycles do not help")
            && !told.contains("shrink"),
        "{told}"
    );
}

/// 0.8 % of the swing of a difference of two forces of 10¹⁴ N is rounding: it never repeats, but the motion does.
#[test]
fn a_small_difference_of_large_forces_ends_and_is_told() {
    let text = oscillator(
        "400 N*s/m",
        "let wave = 50 N*sin(20*pi*time/(1 s))
    apply force wave*b.z on a against b
    let large = 1e16 N/m * x + 1e14 N
    let other = (1e16 N/m - 1 N/mm) * x + 1e14 N
    output net: 1 = (large - other)/(1 N)",
        ", cycles: 20",
    )
    .replace("k: 5 N/mm", "k: 50 N/mm")
    .replace("[205, 0, 0]", "[200, 0, 0]");
    let outcome = program(&text)
        .analysis("steady")
        .expect("an analysis")
        .run(&mut |_| {})
        .unwrap_or_else(|failed| panic!("{}", failed.error));
    let found = outcome.periodic.expect("a periodic analysis");
    assert!(found.repeats && found.cycles < 10, "{found:?}");
    assert!(found.noise.is_some(), "{found:?}");
    let told = told("noise", &text);
    assert!(
        told.contains("warning[W0716]: mount.net changes by ")
            && told.contains("repeats but for the noise of its steps")
            && told.contains("`tolerance: 0.0"),
        "{told}"
    );
}

/// Reeds meet their stops a little earlier or later from turn to turn, by the errors of the steps. Of torques of 35 N m this
/// leaves 0.04 N m in those of the bolts across the crank, which have no larger swing.
#[test]
fn a_small_reaction_beside_impacts_is_noise_of_the_steps() {
    let place = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/examples/compressor/compressor.eng"
    );
    let text = std::fs::read_to_string(place).expect("the example");
    let model = text.split("/// The gas repeats").next().expect("a part");
    let found = program(&format!(
        "{model}\nanalysis steady = periodic(Compressor(), sample: 2 deg)\n"
    ))
    .analysis("steady")
    .expect("an analysis")
    .run(&mut |_| {})
    .unwrap_or_else(|failed| panic!("{}", failed.error))
    .periodic
    .expect("a periodic analysis");
    println!("{found:?}");
    assert!(found.noise.is_some() && found.repeats, "{found:?}");
    assert!(found.cycles < 30 && !found.erratic, "{found:?}");
}

/// Ueda's oscillator `ẍ + 0.05 ẋ + x³ = 7.5 cos τ` (mm, 62.83 rad/s) is chaotic: there is no factor, and no
/// advice to wait.
#[test]
fn what_never_repeats_is_not_said_to_shrink() {
    let text = oscillator(
        "3.1416 N*s/m",
        "let bent = x/(1 mm)
    apply force 3.94784 N*(7.5*sin(20*pi*time/(1 s)) - bent*bent*bent)*b.z on a against b",
        ", cycles: 20",
    )
    .replace("k: 5 N/mm", "k: 0 N/mm");
    let told = told("erratic", &text);
    assert!(
        told.contains("warning[W0713]") && told.contains("no two cycles are alike"),
        "{told}"
    );
    assert!(
        !told.contains("allow more") && !told.contains("by the factor"),
        "{told}"
    );
}

/// A disc on its coupling, and a state that keeps 0.882 of its deviation a cycle: every run that does not repeat has its
/// warning, however few cycles follow the wide ones or a leap.
#[test]
fn a_run_that_ends_beside_a_leap_is_told() {
    let text = "
use std.joints.Revolute
use std.forces.TorsionSpring
use std.drives.ConstantSpeed
force Load(a: Marker, b: Marker) {
    let turn = rotation(a, b)
    apply torque -10 N*m*(1 + 0.5*cos(2*turn))*b.z on a against b
}
force S(a: Marker, b: Marker) {
    let th = rotation(a, b)
    state x: 1 = 5 scale 1
    der(x) = (10*cos(th) + 3*sin(3*th) - x)/(0.8 s)*1
    output y: 1 = x
    apply torque 0 N*m*b.z on a against b
}
model M {
    gravity = [0, 0, 0] m/s^2
    marker bearing = [0, 0, 0] mm
    body disc { mass = 10 kg; inertia = [60, 60, 100] g*m^2; marker hub = origin; start angular_velocity = [0, 0, 10] rev/s }
    body motor { mass = 1 kg; inertia = [1, 1, 1] g*m^2; marker hub = origin }
    joint journal = Revolute(disc.hub, bearing)
    drive turn = ConstantSpeed(motor.hub, bearing, speed: 10 rev/s)
    force coupling = TorsionSpring(disc.hub, motor.hub, stiffness: 250 N*m/rad, damping: 4 N*m*s/rad)
    force load = Load(disc.hub, bearing)
    force s = S(disc.hub, bearing)
    cycle angle = rotation(disc.hub, bearing) { period = 360 deg }
    
}
analysis steady = periodic(M(), start: assembled, sample: 5 deg, cycles: CYCLES)
analysis long = transient(M(), start: assembled, duration: 400 rev, sample: 5 deg)
";
    for cycles in 5..=14 {
        let told = told("beside", &text.replace("CYCLES", &cycles.to_string()));
        let repeats = told.contains("repeats after") && !told.contains("does not repeat");
        assert!(
            repeats != told.contains("warning[W0713]"),
            "{cycles}: {told}"
        );
        assert!(cycles > 12 || !repeats, "{told}");
    }
}
