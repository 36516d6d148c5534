//! Correct texts pass and get their types: the library, the examples, and special cases of the
//! language.

use crate::check_support::{Run, render, run, run_in};
use eng_compiler::library::LIBRARY;
use eng_compiler::program::{DefinitionId, ValueType};
use eng_system::Dimension;

fn clean(run: &Run) {
    assert!(run.diagnostics.is_empty(), "{}", render(run));
}

#[test]
fn every_file_of_the_library_is_clean() {
    for (path, text) in LIBRARY {
        let run = run(&format!("use {path}.*\n"));
        let messages = render(&run);
        assert!(!run.diagnostics.has_errors(), "{path}:\n{messages}");
        assert!(!text.is_empty());
    }
}

#[test]
fn the_examples_are_clean() {
    for name in ["inline4", "slider_crank"] {
        let folder = format!("{}/../examples/{name}", env!("CARGO_MANIFEST_DIR"));
        let file = format!("{name}.eng");
        let text = std::fs::read_to_string(format!("{folder}/{file}")).expect("an example");
        clean(&run_in(&folder, &file, &text));
    }
    let folder = format!("{}/tests/models", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(format!("{folder}/every_class.eng")).expect("a model");
    clean(&run_in(&folder, "every_class.eng", &text));
}

const RIGHT: &str = r#"
use std.joints.{Revolute, PointOnPlane}
use std.journals.{JournalLaw, Short, Impedance}
use std.drives.ConstantSpeed
use std.oils.SAE_10W40

const cylinders: Int = 2
const half = 0.5
param ambient: AbsolutePressure = 1 bar
table gas(theta: CrankAngle) -> AbsolutePressure =
    points([0, 360, 720] deg, [1, 60, 1] bar, periodic: 720 deg, interpolation: monotone)
table lift(x: Length) -> Force = points([0, 1, 2] mm, [0, 5, 20] N, extrapolation: linear)

// Generic in the dimension; roots and powers of it too.
fn lerp<D>(a: D, b: D, t: 1) -> D = a + t*(b - a)
fn clamp<D>(x: D, low: D, high: D) -> D = min(max(x, low), high)
fn hypotenuse<D>(a: D, b: D) -> D = sqrt(a^2 + b^2)
fn ratio<A, B>(a: A, b: B) -> A/B = a/b
fn mean<D>(values: D[n], n: Int) -> D = sum(values)/n

record Sample {
    let place: Length
    let rate: Velocity
    fn ahead(t: Time) -> Length = place + rate*t
}
fn sample(a: Marker, b: Marker) -> Sample {
    let height = dot(a.origin - b.origin, b.z)
    Sample(place: height, rate: der(height))
}

force Cushion(a: Marker, b: Marker, curve: fn(Length) -> Force, damping: Damping = 3 N*s/m, preload: Pressure = 0 Pa) {
    let seen = sample(a, b)
    let soon = seen.ahead(1 ms)
    state p: Pressure = 3 bar
    der(p) = (preload - p)/(10 ms)
    apply force (curve(soon) - damping*seen.rate + p*1 mm^2)*b.z on a against b
    apply torque -3 N*m*s/rad * (a.angular_velocity - b.angular_velocity) on a against b
    output force = curve(soon)*b.z in b as kN
    output jerk = der(seen.rate) as m/s^2
    output pressure = p as bar
    require damping > 0 N*s/m else "damping {damping as N*s/m}"
}

component Bearing(law: JournalLaw, pin: Marker[n], shell: Marker, n: Int, oil_temperature: Temperature) {
    param clearance: Length = 27 um in (1 um, 1 mm)
    let oil = SAE_10W40.viscosity(oil_temperature)
    journal film[i in 1..n] = law(pin: pin[i], shell: shell, diameter: 54 mm, width: 20 mm, radial_clearance: clearance, viscosity: oil)
    output thinnest[i in 1..n] = film[i].minimum_film as um
    output load[i in 1..n] = film[i].force.x as kN
}

model Engine {
    param speed: AngularVelocity = 66 rev/s
    param fine: Angle = 0.5 deg
    const law: JournalLaw = Short
    let surface = speed*27 mm                      // a velocity: the angle is dropped
    let again: AngularVelocity = surface/27 mm     // and taken up
    let warm: Temperature = 20 degC + 85 K
    let gap: TemperatureDifference = warm - 20 degC
    let hot = lerp(warm, 120 degC, half)
    gravity = [0, -9.81, 0] m/s^2
    body crank {
        mass = 12 kg
        inertia = [1, 1, 2]*mass*(10 mm)^2
        marker main[j in 1..cylinders] = [0 mm, 0 mm, (j - 1)*92 mm]
        marker turned = at([0, 0, 1] mm, x: [0, 1, 0], z: [1, 0, 0])
        start angular_velocity = [0, 0, 1]*speed
        guess position = [1, 0, 0] mm
    }
    body rod[i in 2..3] {
        mass = 1 kg
        inertia = [1, 1, 1] kg*m^2
        marker big = origin
        marker small = [0, 100, 0] mm
    }
    marker rail = at([0, 0, 0] mm, z: [1, 0, 0])
    joint big_end[i in 2..3] = Revolute(rod[i].big, crank.main[i - 1]) { branch angle > -90 deg }
    joint thrust = PointOnPlane(crank.origin, ground)
    part one = Bearing(law: law, pin: crank.main[*], shell: rail, n: cylinders, oil_temperature: warm)
    part two = Bearing(law: Impedance, pin: [crank.main[1]], shell: ground, n: 1, oil_temperature: 105 degC, )
    force cushion = Cushion(rod[2].small, rail, curve: lift)
    drive turn = ConstantSpeed(crank.turned, ground, speed: again)
    cycle angle = rotation(crank.origin, ground) { period = 720 deg }
    start rotation(crank.origin, rail) = 30 deg
    start big_end[2].speed = 0 rpm
    output pressure = gas(cycle.angle - fine) - ambient as bar
    output angles[i in 2..3] = big_end[i].angle as deg
    output fraction = clamp(cycle.angle/cycle.period, 0, 1) as %
    output height = local(rod[2].small.origin, rail).y as mm
    output place = rod[2].small.origin in rail as mm
    output bend = local(crank.turned.z, rail) in rail
    output spread = hypotenuse(3 mm, 4 mm)*ratio(1 m, 2 m) as mm
    output average = mean([1, 2, 3] mm, 3) as mm
    output rise = gap as K
    output oil = hot as degC
    output reaction = thrust.force.x as N
    output film = two.film[1].minimum_film as um
    output acceleration = rod[2].small.acceleration in rail as m/s^2
    output energy: Energy = 0.5*12 kg * dot(crank.origin.velocity, crank.origin.velocity) as J
    output largest = max([1 mm, 2 mm]) as mm
    output count = length(crank.main)
}
analysis run[s in 1000 rpm .. 2000 rpm by 500 rpm] = transient(Engine(speed: s), duration: 4 rev, sample: 0.5 deg, rho: 0.8)
analysis fixed[m in [Short, Impedance]] = transient(Engine(law: m), duration: 10 ms, sample: 1 ms, step: 10 us)
analysis standing = assemble(Engine())
"#;

#[test]
fn a_model_with_everything_is_clean() {
    clean(&run(RIGHT));
}

fn definition(run: &Run, name: &str) -> DefinitionId {
    let root = run.typed.program.root();
    run.typed.program.lookup(root, name).expect("a definition")
}

#[test]
fn types_are_handed_on() {
    let run = run(RIGHT);
    let engine = definition(&run, "Engine");
    let of = |name: &str| run.typed.of(engine, name).cloned();
    let speed = Dimension::ANGLE.over(Dimension::TIME);
    assert_eq!(of("speed"), Some(ValueType::Scalar(speed)));
    assert_eq!(of("again"), Some(ValueType::Scalar(speed)));
    let velocity = Dimension::LENGTH.over(Dimension::TIME);
    let dropped = of("surface").expect("a type");
    assert!(matches!(dropped, ValueType::Scalar(d) if d.without_angle() == velocity));
    assert_eq!(of("place"), Some(ValueType::Vector(Dimension::LENGTH)));
    assert_eq!(of("count"), Some(ValueType::Int));
    assert_eq!(of("bend"), Some(ValueType::Components(3, Dimension::ONE)));
    assert_eq!(
        of("angles"),
        Some(ValueType::Array(Box::new(ValueType::Scalar(
            Dimension::ANGLE
        ))))
    );
    let cushion = definition(&run, "Cushion");
    let force = Dimension::MASS.times(velocity).over(Dimension::TIME);
    assert_eq!(run.typed.of(cushion, "a"), Some(&ValueType::Marker));
    assert_eq!(
        run.typed.of(cushion, "force"),
        Some(&ValueType::Vector(force))
    );
    assert_eq!(run.typed.of(cushion, "seen"), Some(&ValueType::Other));
    assert_eq!(run.typed.of(cushion, "curve"), Some(&ValueType::Other));
    let bearing = definition(&run, "Bearing");
    let markers = ValueType::Array(Box::new(ValueType::Marker));
    assert_eq!(run.typed.of(bearing, "pin"), Some(&markers));
    let half = definition(&run, "half");
    assert_eq!(
        run.typed.of(half, ""),
        Some(&ValueType::Scalar(Dimension::ONE))
    );
}

#[test]
fn units_have_their_sizes() {
    let run = run(
        "unit furlong = 220*0.9144 m\nunit turn = 2*pi/1 rad\nunit slow: AngularVelocity = 2*pi/60 rad/s\n",
    );
    clean(&run);
    let size = |name: &str| run.typed.program.units.get(name).expect("a unit");
    let near = |a: f64, b: f64| assert!((a / b - 1.0).abs() < 1e-15, "{a} {b}");
    near(size("furlong").scale, 201.168);
    near(size("slow").scale, std::f64::consts::TAU / 60.0);
    assert_eq!(
        size("slow").dimension,
        Dimension::ANGLE.over(Dimension::TIME)
    );
    near(size("Hz").scale, 1.0);
    assert_eq!(
        size("Hz").dimension,
        Dimension::TIME.power(-1, 1).expect("1/s")
    );
    near(size("rpm").scale, std::f64::consts::TAU / 60.0);
    assert_eq!(size("degC").offset, 273.15);
    assert_eq!(size("degC").point.as_deref(), Some("Temperature"));
    assert_eq!(size("mm").point, None);
}

/// Nothing that can be read crashes the checker: every fixture and example with pieces taken out.
#[test]
fn broken_texts_do_not_crash() {
    let mut texts = vec![RIGHT.to_owned()];
    let base = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    for folder in [
        "tests/diagnostics/check",
        "tests/diagnostics/resolve",
        "../examples/inline4",
    ] {
        for entry in std::fs::read_dir(base.join(folder)).expect("a folder") {
            let path = entry.expect("an entry").path();
            if path.extension().is_some_and(|extension| extension == "eng") {
                texts.push(std::fs::read_to_string(path).expect("a text"));
            }
        }
    }
    let mut runs = 0;
    for text in &texts {
        let words: Vec<&str> = text
            .split_inclusive([' ', '\n', '(', ')', ',', '.', '{', '}'])
            .collect();
        let step = (words.len() / 12).max(1);
        for (start, width) in (0..words.len())
            .step_by(step)
            .zip([1, 2, 5].into_iter().cycle())
        {
            let broken: String = words
                .iter()
                .enumerate()
                .filter(|(at, _)| *at < start || *at >= start + width)
                .map(|(_, word)| *word)
                .collect();
            let run = run(&broken);
            for diagnostic in run.diagnostics.iter() {
                for label in &diagnostic.labels {
                    assert!(label.span.start <= label.span.end);
                }
            }
            runs += 1;
        }
    }
    assert!(runs > 300);
}
