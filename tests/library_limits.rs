//! Numbers that no machine has: one change at a time in correct models, and the message of each.

use eng::Sources;
use eng_grammar::Diagnostic;
use std::fmt::Write;

/// A pin that is held 15 um beside the middle of its shell.
const FILM: &str = "
use std.journals.*
use std.joints.Revolute
use std.drives.PrescribedRotation
fn pull(angle: CrankAngle) -> Vector2<Force> = [-1 kN, 1 kN*sin(angle - 0 deg)]
model Held {
    gravity = [0, 0, 0] m/s^2
    accept sampling
    marker seat = at([15, 0, 0] um)
    marker shell = origin
    body shaft { mass = 2 kg; inertia = [2, 2, 1] g*m^2; marker mid = origin; start angular_velocity = [0, 0, 3000] rpm }
    joint hinge = Revolute(shaft.mid, seat)
    drive turn = PrescribedRotation(shaft.mid, seat, speed: 3000 rpm)
    cycle angle = rotation(shaft.mid, seat) { period = 360 deg }
    journal main = Film(shaft.mid, shell, diameter: 50 mm, width: 25 mm, radial_clearance: 25 um, viscosity: 10 mPa*s,
        openings: [axial_groove(at: 90 deg, length: 15 mm, width: 8 mm, diameter: 50 mm, pressure: 4 bar)])
}
analysis run = transient(Held(), duration: 4 deg, sample: 2 deg, start: assembled)
";

/// A shaft along its axis on tapered pads.
const THRUST: &str = "
use std.thrust.*
use std.journals.Roughness
use std.joints.Cylindrical
use std.drives.PrescribedRotation
model Shaft {
    gravity = [0, 0, -9.81] m/s^2
    marker house = [0, 0, 0] mm
    body shaft { mass = 20 kg; inertia = [0.1, 0.1, 0.05] kg*m^2; marker collar = origin; start angular_velocity = [0, 0, 3000] rpm }
    joint bearing = Cylindrical(shaft.collar, house)
    drive turn = PrescribedRotation(shaft.collar, house, speed: 3000 rpm)
    force thrust = TaperLandThrust(shaft.collar, house, inner_diameter: 60 mm, outer_diameter: 80 mm, end_float: 200 um,
        viscosity: 10 mPa*s, pads: 4, pad_angle: 80 deg, depth: 25 um,
        roughness: Roughness(sigma: 0.5 um, asperity: 1e-4, modulus: 100 GPa, boundary_friction: 0.1))
}
analysis run = transient(Shaft(), duration: 1 ms, sample: 0.5 ms)
";

/// A single with a counterweight, a balance shaft and skirts.
const SINGLE: &str = "
use std.cylinder.{Rod, radial}
use std.engine.*
use std.forces.GasPressure
use std.journals.Impedance
use std.layouts.single
use std.liners.Skirt
use std.oils.SAE_10W40
use std.quick.QuickEngine
table indicated(theta: CrankAngle) -> AbsolutePressure = points([0, 90, 180, 540, 720] deg, [9, 2, 1, 1, 9] bar,
    interpolation: monotone, periodic: 720 deg)
model Machine {
    part engine = Engine(
        layout: single(), order: [1], numbered_from: timing_end, seen_from: timing_end, sense: clockwise,
        bore: 86 mm, stroke: 86 mm, rod_length: 143 mm, spacing: 92 mm,
        main_diameter: 54 mm, main_width: 20 mm, main_clearance: radial(27 um), big_ends: hinge, pin_diameter: 48 mm,
        law: Impedance, oil: SAE_10W40, oil_temperature: 90 degC, rod: Rod(mass: 0.6 kg, center: 41 mm, inertia: [0.1, 2.5, 2.6] g*m^2),
        piston_mass: 0.45 kg, crankshaft: Crank(mass: 20 kg, inertia: [250, 260, 42] g*m^2),
        counterweights: [Counterweight(throw: 1, mass: 0.6 kg, radius: 60 mm)],
        balance_shafts: [BalanceShaft(ratio: -1, moment: 13.3 kg*mm, angle: 180 deg, across: 80 mm, mass: 0.8 kg, inertia: 0.3 g*m^2)],
        piston_guide: skirt, skirt_law: Skirt(clearance: 40 um, bottom: -25 mm, top: 25 mm, width: 50 mm, layer: 20 MPa/mm, viscosity: 10 mPa*s),
        gas: GasPressure(pressure: indicated), flywheel_mass: 11 kg, flywheel_inertia: 112 g*m^2, block_mass: 70 kg,
        block_inertia: [2, 2, 1] kg*m^2, speed: 3000 rpm, drive_line: constant_speed,
    )
    gravity = engine.up*(-9.81 m/s^2)
}
analysis run = transient(Machine(), duration: 6 deg, sample: 2 deg, start: assembled)
";

/// The films of an engine by their loads.
const QUICK: &str = include_str!("../examples/concept/quick.eng");

/// A cam and its tappet.
const CAM: &str = "
use std.valvetrain.{FlatTappet, polynomial_lift, polydyne_lift, harmonic_lift, cycloidal_lift}
use std.joints.{Revolute, Translational}
use std.drives.PrescribedRotation
model Cam {
    gravity = [0, 0, 0] m/s^2
    marker guide = at([0, 0, 0] mm, z: [0, 1, 0])
    marker axle = [0, 0, 0] mm
    body cam { mass = 1 kg; inertia = [1, 1, 1] g*m^2; marker main = origin; start angular_velocity = [0, 0, 600] rpm }
    body tappet { mass = 0.1 kg; inertia = [10, 10, 10] mg*m^2; marker foot = at([0, 0, 0] mm, z: [0, 1, 0]) }
    joint hinge = Revolute(cam.main, axle)
    drive turn = PrescribedRotation(cam.main, axle, speed: 600 rpm)
    joint slide = Translational(tappet.foot, guide)
    force contact = FlatTappet(tappet.foot, guide, cam.main, axle, profile: polynomial_lift(lift: 9 mm, half: 65 deg),
        base_radius: 50 mm, face_radius: 18 mm, stiffness: 20 N/um)
}
analysis run = transient(Cam(), duration: 1 ms, sample: 0.5 ms)
";

/// A finger on a lash adjuster.
const FINGER: &str = "
use std.valvetrain.*
use std.drives.ConstantSpeed
model Train {
    gravity = [0, 0, 0] m/s^2
    marker socket = at([0, 0, 0] mm, z: [0, 1, 0])
    marker axle = [20, 29, 0] mm
    marker seat = at([42, -40, 0] mm, z: [0, 1, 0])
    body cam { mass = 1 kg; inertia = [0.5, 0.5, 0.5] g*m^2; marker main = origin }
    drive turn = ConstantSpeed(cam.main, axle, speed: 1000 rpm, initial: 180 deg)
    const shape = Lever(mass: 60 g, inertia: 20 kg*mm^2, center: [20, 3] mm, cam_side: [19, 5] mm, tip: [42, 8] mm, tip_radius: 10 mm)
    part valve = Valve(seat, valve_mass: 80 g, installed: 35 mm, stem_height: 38 mm, stiffness: 30 N/mm, free_length: 45 mm,
        seat_stiffness: 50 N/um)
    part finger = FingerFollower(socket, cam.main, valve.valve.stem, shape: shape, plunger_mass: 12 g, tip_stiffness: 50 N/um,
        cam_side: RollerCam(base: 24 mm, roller_radius: 9 mm, profile: polynomial_lift(lift: 5 mm, half: 60 deg), stiffness: 50 N/um, friction: 0),
        adjuster: HydraulicLashAdjuster(diameter: 11 mm, gap: 6 um, seal: 8 mm, volume: 0.3 cc, supply: 3 bar, viscosity: 10 mPa*s))
}
analysis run = transient(Train(), duration: 0.2 ms, sample: 0.1 ms)
";

/// A rocker arm on a pushrod that stands on the ground.
const PUSHROD: &str = "
use std.valvetrain.*
model Train {
    gravity = [0, 0, 0] m/s^2
    marker shaft = [0, 0, 0] mm
    marker socket = [-26, -150, 0] mm
    marker seat = at([36, -62, 0] mm, z: [0, 1, 0])
    const shape = Lever(mass: 90 g, inertia: 40 kg*mm^2, center: [3, 0] mm, cam_side: [-25, -3] mm, tip: [36, -4] mm, tip_radius: 12 mm)
    part valve = Valve(seat, valve_mass: 100 g, installed: 38 mm, stem_height: 45.8 mm, stiffness: 30 N/mm, free_length: 48 mm,
        seat_stiffness: 50 N/um)
    part rocker = RockerArm(shaft, socket, valve.valve.stem, shape: shape, tip_stiffness: 50 N/um,
        cam_side: Pushrod(length: 147 mm, stiffness: 50 N/um))
}
analysis run = transient(Train(), duration: 0.2 ms, sample: 0.1 ms)
";

/// A box on a bushing.
const BUSHING: &str = "
use std.mounts.RubberBushing
model Mounted {
    gravity = [0, 0, -9.81] m/s^2
    marker floor = [0, 0, 0] mm
    body box { mass = 50 kg; inertia = [1, 1, 1] kg*m^2; marker foot = origin; start rotation = [0, 0, 1] deg }
    force mount = RubberBushing(box.foot, floor, stiffness: [500, 500, 300] N/mm, torsional_stiffness: [90, 90, 120] N*m/rad,
        loss: 0.15, loss_at: 20 Hz)
}
analysis run = transient(Mounted(), duration: 2 ms, sample: 1 ms)
";

/// A disc behind a dual-mass flywheel, and a box on a hydraulic mount.
const FLYWHEEL: &str = "
use std.drivelines.DualMassFlywheel
use std.mounts.HydraulicMount
use std.joints.{Revolute, Translational}
model Flywheel {
    gravity = [0, 0, -9.81] m/s^2
    marker engine = [0, 0, 0] mm
    marker floor = [500, 0, 0] mm
    body disc { mass = 5 kg; inertia = [30, 30, 50] g*m^2; marker hub = origin }
    body box { mass = 50 kg; inertia = [1, 1, 1] kg*m^2; marker foot = origin; start position = [500, 0, 10] mm }
    joint bearing = Revolute(disc.hub, engine)
    joint guide = Translational(box.foot, floor)
    force springs = DualMassFlywheel(disc.hub, engine, stiffness: 690 N*m/rad, second_stiffness: 1400 N*m/rad, free_play: 0 deg,
        second_stage: 40 deg, friction: 12 N*m, creep: 1 rad/s)
    force mount = HydraulicMount(box.foot, floor, stiffness: 200 N/mm, damping: 100 N*s/m, free_length: 12 mm, piston: 30 cm^2,
        compliance: 3e-11 m^3/Pa, inertance: 4e6 Pa*s^2/m^3, resistance: 2e7 Pa*s/m^3)
}
analysis run = transient(Flywheel(), duration: 2 ms, sample: 1 ms)
";

/// A change of a model: a part of its text, the text in place of it, and a part of the message.
type Change = (&'static str, &'static str, &'static str);

const OF_FILMS: &[Change] = &[
    ("pressure: 4 bar", "pressure: 4 GPa", "opening 1 has 4000 MPa: oil is no fluid at 1000 MPa or more"),
    ("pressure: 4 bar", "pressure: 900 bar", "opening 1 has 900 bar, 500 bar or more"),
    ("openings:", "end_pressure: 2 GPa, openings:", "the pressure at the ends is 2000 MPa"),
    ("openings:", "end_pressure: 900 bar, openings:", "the pressure at the ends is 900 bar, 500 bar or more"),
    ("openings:", "profile: Profile(lemon: 6 mm), openings:", "changes the gap by 6 mm: Reynolds' equation holds"),
    ("openings:", "profile: Profile(relief: 300 um), openings:", "by 300 um, 10 clearances of 25 um or more"),
    (
        "openings:",
        "eye: Ring(waves: 1, thickness: 5 mm, width: 25 mm, modulus: 210 GPa), openings:",
        "Bending begins with 2 waves: take 8 at first, or 0",
    ),
    (
        "openings:",
        "eye: Ring(thickness: 5 mm, width: 25 mm, modulus: 210 GPa), openings:",
        "waves",
    ),
    (
        "openings:",
        "eye: Ring(waves: 2, thickness: 60 mm, width: 25 mm, modulus: 210 GPa), openings:",
        "60 mm thick, the diameter of 50 mm or more",
    ),
    (
        "openings:",
        "eye: Ring(waves: 2, thickness: 5 mm, width: 25 mm, modulus: 210 kPa), openings:",
        "has a modulus of 0.00021 GPa: that of plastics",
    ),
    (
        "openings:",
        "eye: Ring(waves: 2, thickness: 5 mm, width: 25 mm, modulus: 210 GPa, poisson: 0.7), openings:",
        "Poisson's ratio of the elastic ring is 0.7: it must be 0 to 0.5",
    ),
    (
        "openings:",
        "roughness: Roughness(sigma: 0.5 um, asperity: 1e-4, modulus: 100 GPa, boundary_friction: 10), openings:",
        "asperities with a friction of 10: that of oiled metals",
    ),
    ("[15, 0, 0] um", "[24.9, 0, 0] um", "the highest pressure of the oil is "),
    ("pressure: 4 bar", "pressure: 1 bar, content: 1.5", "opening 1 has a content of 1.5: it is the share"),
    ("width: 8 mm, diameter: 50 mm", "width: 8 mm, diameter: 51 mm", "made for a diameter of 51 mm"),
    ("openings:", "around: 2000, across: 500, openings:", "the matrices of a solution need 12 GB"),
    ("openings:", "around: 100, across: 40, openings:", "Each solution takes some 0.003"),
    ("openings:", "piezo: 2000 GPa^-1, openings:", "fifty times that at rest at 1.956 MPa, and the pressure passes that at"),
    ("[15, 0, 0] um", "[24.9875, 0, 0] um", "or more, 0.025 um, and the gap is 0.0125 um, at 0 deg and"),
    (
        "journal main",
        "journal wide = Reynolds(shaft.mid, shell, diameter: 50 mm, width: 100 mm, radial_clearance: 25 um, viscosity: 10 mPa*s)
    journal main",
        "the table of this law has 0.08 to 1.5: use Film",
    ),
    (
        "journal main",
        "journal wide = Impedance(shaft.mid, shell, diameter: 50 mm, width: 75 mm, radial_clearance: 25 um, viscosity: 10 mPa*s)
    journal main",
        "from 1.25 diameters on the load of this law is up to 25 % wrong",
    ),
    (
        "journal main",
        "journal wide = Mobility(shaft.mid, seat, diameter: 50 mm, width: 75 mm, radial_clearance: 25 um, viscosity: 10 mPa*s, load: pull)
    journal main",
        "25 % wrong: use SolvedMobility up to 1.5",
    ),
    ("accept sampling", "accept shape", "`accept sampling` in the model"),
];

const OF_THRUST: &[Change] = &[
    (
        "depth: 25 um,",
        "depth: 25 um, sense: -1,",
        "the collar turns against its pads, is `sense: 1` meant?",
    ),
    (
        "sigma: 0.5 um",
        "sigma: 1 mm",
        "the roughness of 1000 um is half of the end float of 200 um or more",
    ),
    (
        "sigma: 0.5 um",
        "sigma: 30 um",
        "a roughness of 30 um is an eighth of the end float of 200 um or more",
    ),
    (
        "sigma: 0.5 um, ",
        "",
        "asperities of surfaces without roughness carry nothing",
    ),
    (
        ", modulus: 100 GPa",
        "",
        "asperities carry `asperity` times `modulus`",
    ),
    (
        "asperity: 1e-4, modulus: 100 GPa, ",
        "",
        "the `boundary_friction` of asperities that carry nothing has no effect",
    ),
];

const OF_ENGINES: &[Change] = &[
    (
        "mass: 0.6 kg, radius: 60 mm",
        "mass: -0.6 kg, radius: 60 mm",
        "counterweight 1 has -0.6 kg at 60 mm: both must be positive",
    ),
    (
        "radius: 60 mm",
        "radius: -60 mm",
        "counterweight 1 has 0.6 kg at -60 mm: both must be positive",
    ),
    (
        "radius: 60 mm",
        "radius: 600 mm",
        "counterweight 1 is 600 mm from the axis of the crank",
    ),
    (
        "mass: 0.6 kg, radius: 60 mm",
        "mass: 600 kg, radius: 60 mm",
        "counterweight 1 has a moment of 36000 kg*mm",
    ),
    (
        "ratio: -1",
        "ratio: 1",
        "balance shaft 1 makes its order larger",
    ),
    (
        "width: 50 mm",
        "width: 400 mm",
        "half of the circumference at most, 135.1 mm",
    ),
    (
        "flywheel_mass:",
        "thrust_inner: 60 mm, flywheel_mass:",
        "state `axial: floating`",
    ),
    (
        "center: 41 mm",
        "center: 41 cm",
        "the rod's centre of mass is 410 mm from the big end",
    ),
    ("Rod(mass: 0.6 kg", "Rod(mass: -0.6 kg", "a rod of -600 g"),
];

const OF_QUICK_ENGINES: &[Change] = &[
    (
        "center: 41 mm",
        "center: 41 cm",
        "the rod's centre of mass is 410 mm from the big end",
    ),
    (
        "center: 41 mm",
        "center: -41 mm",
        "the rod's centre of mass is -41 mm from the big end",
    ),
    ("Rod(mass: 0.62 kg", "Rod(mass: -0.62 kg", "a rod of -620 g"),
    ("Rod(mass: 0.62 kg", "Rod(mass: 0 kg", "a rod of 0 g"),
    (
        "3.0, 3.1]",
        "3.0, -3.1]",
        "moments of inertia of 0.12 g*m^2, 3 g*m^2 and -3.1 g*m^2: all must be positive",
    ),
    (
        "piston_mass: 0.45 kg",
        "piston_mass: -0.45 kg",
        "a piston of -450 g: its mass must be positive",
    ),
    (
        "pressure: indicated,",
        "pressure: indicated, ambient: 0 bar,",
        "an ambient pressure of 0 bar: it is absolute and must be positive",
    ),
    (
        "pressure: indicated,",
        "pressure: indicated, ambient: -1 bar,",
        "an ambient pressure of -1 bar: it is absolute and must be positive",
    ),
];

const OF_CAMS: &[Change] = &[
    (
        "half: 65 deg",
        "half: 250 deg",
        "half of the opening is 250 deg: above 0, and at most the 180 deg",
    ),
    (
        "polynomial_lift(lift: 9 mm, half: 65 deg",
        "harmonic_lift(lift: 9 mm, half: 250 deg",
        "half of the opening is 250 deg",
    ),
    (
        "polynomial_lift(lift: 9 mm, half: 65 deg",
        "cycloidal_lift(lift: 9 mm, half: 250 deg",
        "half of the opening is 250 deg",
    ),
    (
        "half: 65 deg",
        "half: 65 deg, power: 2",
        "the power is 2: at least 3",
    ),
    (
        "polynomial_lift(lift: 9 mm, half: 65 deg",
        "polydyne_lift(lift: 9 mm, half: 65 deg, powers: [8, 8, 20]",
        "the powers are 8, 8 and 20: they must be above 2 and rise",
    ),
    (
        "lift: 9 mm",
        "lift: 9 cm",
        "the radius of curvature of this cam falls to -419",
    ),
];

const OF_FINGERS: &[Change] = &[
    (
        "tip: [42, 8] mm",
        "tip: [42, 8] cm",
        "the tip is 427.6 mm from the axis of the lever, the cam side 19.65 mm",
    ),
    (
        "cam_side: [19, 5] mm",
        "cam_side: [0, 0] mm",
        "both must be beside it",
    ),
    ("tip_radius: 10 mm", "tip_radius: 0 mm", "a tip of 0 mm"),
    (
        "plunger_mass: 12 g",
        "plunger_mass: -12 g",
        "a plunger of -12 g with a way of 2 mm",
    ),
    (
        "at([0, 0, 0] mm",
        "at([0, 6, 0] mm",
        "the ball begins -5.96",
    ),
    (
        "30 N/mm",
        "30 N/m",
        "the spring presses the closed valve with 0.3 N",
    ),
    (
        "installed: 35 mm",
        "installed: 55 mm",
        "an installed length of 55 mm, a free length of 45 mm",
    ),
    (
        "friction: 0",
        "friction: 10",
        "a coefficient of friction of 10",
    ),
    ("friction: 0", "friction: -0.1", "a friction of -0.1"),
];

const OF_PUSHRODS: &[Change] = &[
    (
        "length: 147 mm",
        "length: 14.7 mm",
        "at start of cam_contact.gap",
    ),
    ("length: 147 mm", "length: -147 mm", "a length of -147 mm"),
    (
        "tip: [36, -4] mm",
        "tip: [36, -1] mm",
        "the lash of valve trains is 0 to 0.5 mm",
    ),
];

const OF_BUSHINGS: &[Change] = &[
    ("loss: 0.15", "loss: 15", "a loss factor of 15"),
    ("loss: 0.15", "loss: -0.15", "adds energy to the motion"),
    (
        "loss_at: 20 Hz",
        "loss_at: 20 kHz",
        "the loss factor belongs to 20000 Hz",
    ),
    ("loss_at: 20 Hz", "loss_at: 0 Hz", "0 Hz must be positive"),
    (
        "120] N*m/rad",
        "120] kN*m/rad",
        "springs 489.9 mm from its middle",
    ),
    ("300] N/mm", "300] N/m", "springs 489.9 mm from its middle"),
    ("[0, 0, 1] deg", "[0, 0, 1] rad", "it is turned by 48.2"),
    (
        "floor = [0, 0, 0] mm",
        "floor = [0, 0, 90] mm",
        "its markers are 90 mm apart",
    ),
];

const OF_FLYWHEELS: &[Change] = &[
    (
        "stiffness: 690 N*m/rad",
        "stiffness: 12 N*m/rad",
        "the first stage ends at 8.378 N*m, and the friction is 12 N*m",
    ),
    (
        "compliance: 3e-11 m^3/Pa",
        "compliance: 3e-5 m^3/Pa",
        "the fluid in the channel swings on the soft walls at 0.01453 Hz",
    ),
];

/// All that is said of a text: by its check, its assembly, and its analysis `run` if it has one.
fn said(text: &str) -> String {
    let checked = eng::check(&Sources::from_text("m.eng", text), "m.eng");
    let mut said = checked.report().to_string();
    let Ok(program) = checked.into_program() else {
        return said;
    };
    let told = |said: &mut String, diagnostic: &Diagnostic| {
        let lines = std::iter::once(&diagnostic.title).chain(&diagnostic.notes);
        for line in lines {
            let _ = writeln!(said, "{line}");
        }
    };
    match program.assemble() {
        Ok(assembled) => assembled
            .diagnostics
            .iter()
            .for_each(|d| told(&mut said, d)),
        Err(error) => {
            let _ = writeln!(said, "{error}");
        }
    }
    let Ok(analysis) = program.analysis("run") else {
        return said;
    };
    match eng::run::run(&analysis, true, &mut |_| {}) {
        Ok(ran) => {
            ran.diagnostics.iter().for_each(|d| told(&mut said, d));
            said.push_str(&ran.facts.join("\n"));
        }
        Err(failed) => {
            let _ = writeln!(said, "{}", failed.error);
        }
    }
    said
}

#[test]
fn numbers_that_no_machine_has_are_told() {
    let models: [(&str, &[Change]); 9] = [
        (FILM, OF_FILMS),
        (THRUST, OF_THRUST),
        (SINGLE, OF_ENGINES),
        (QUICK, OF_QUICK_ENGINES),
        (CAM, OF_CAMS),
        (FINGER, OF_FINGERS),
        (PUSHROD, OF_PUSHRODS),
        (BUSHING, OF_BUSHINGS),
        (FLYWHEEL, OF_FLYWHEELS),
    ];
    for (model, changes) in models {
        let right = said(model);
        for (before, after, message) in changes {
            assert_eq!(model.matches(before).count(), 1, "{before}");
            let wrong = said(&model.replace(before, after));
            assert!(
                !right.contains(message),
                "{message} of the right model: {right}"
            );
            assert!(wrong.contains(message), "{after}: {message} in\n{wrong}");
        }
    }
}

/// A film at rest resists the motion of its pin under the rule `half`, too: its pressure is zero, but not cut.
#[test]
fn a_film_of_the_rule_half_holds_its_pin() {
    let text = "
use std.journals.Film
use std.joints.Planar
use std.drives.PrescribedRotation
model Rotor {
    gravity = [-9.81, 0, 0] m/s^2
    marker seat = origin
    body shaft { mass = 60 kg; inertia = [0.2, 0.2, 0.3] kg*m^2; marker mid = origin; start angular_velocity = [0, 0, 3000] rpm }
    joint plane = Planar(shaft.mid, seat)
    drive turn = PrescribedRotation(shaft.mid, seat, speed: 3000 rpm)
    journal main = Film(shaft.mid, seat, diameter: 54 mm, width: 24 mm, radial_clearance: 27 um, viscosity: 10 mPa*s, cavitation: half)
    cycle angle = rotation(shaft.mid, seat) { period = 360 deg }
}
analysis run = transient(Rotor(), duration: 4 deg, sample: 2 deg)
";
    let told = said(text);
    assert!(
        told.contains("the load at the same position of the pin is up to"),
        "{told}"
    );
    assert!(!told.contains("no joint, spring or film holds"), "{told}");
}

/// A pin in the middle of its shell carries nothing: its relative errors would be those of rounding.
#[test]
fn a_film_without_load_has_no_error_of_its_cells() {
    let centred = FILM.replace("at([15, 0, 0] um)", "origin");
    let centred = centred.replace("pressure: 4 bar", "pressure: 0 bar");
    let told = said(&centred);
    assert!(
        told.contains("no load at 3 moments, so the error of the cells is not known"),
        "{told}"
    );
    assert!(said(FILM).contains("the load at the same position of the pin is up to"));
}
