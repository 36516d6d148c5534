//! One small model for every class of the library. The classes are found by reading the library, so a class
//! without a model fails the test.

use eng_compiler::library::LIBRARY;
use eng_grammar::ast::{Form, ItemKind, Kind};
use eng_grammar::{Diagnostics, SourceMap};
use std::collections::BTreeSet;
use std::path::Path;

/// The set from which random states of a class are drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Poses {
    /// Any two poses.
    Any,
    /// A pin in a shell: radial clearance (m).
    Film(f64),
    /// All z axes are that of the ground, and the motion is in its plane.
    Planar,
}

/// A class and its use in a model.
#[derive(Clone, Copy, Debug)]
pub struct Case {
    /// `std.joints`; empty for a class in `definitions`.
    pub module: &'static str,
    pub kind: &'static str,
    pub class: &'static str,
    /// The arguments besides the two markers.
    pub arguments: &'static str,
    pub definitions: &'static str,
    /// Further text that the model needs.
    pub parts: &'static str,
    pub poses: Poses,
    /// Whether the load has a reaction; else it is external.
    pub closed: bool,
}

/// Radial clearance of the journals below (m).
const CLEARANCE: f64 = 27e-6;

const PLAIN: Case = Case {
    module: "std.joints",
    kind: "joint",
    class: "",
    arguments: "a.m, b.m",
    definitions: "",
    parts: "",
    poses: Poses::Any,
    closed: true,
};

const fn joint(class: &'static str) -> Case {
    Case { class, ..PLAIN }
}

const fn drive(class: &'static str, arguments: &'static str, definitions: &'static str) -> Case {
    Case {
        module: "std.drives",
        kind: "drive",
        class,
        arguments,
        definitions,
        ..PLAIN
    }
}

const fn force(class: &'static str, arguments: &'static str, definitions: &'static str) -> Case {
    Case {
        module: "std.forces",
        kind: "force",
        class,
        arguments,
        definitions,
        ..PLAIN
    }
}

const fn external(class: &'static str, arguments: &'static str) -> Case {
    Case {
        closed: false,
        ..force(class, arguments, "")
    }
}

const fn journal(class: &'static str, arguments: &'static str) -> Case {
    Case {
        module: "std.journals",
        kind: "journal",
        class,
        arguments,
        poses: Poses::Film(CLEARANCE),
        ..PLAIN
    }
}

/// A crank whose angle is that of the cycle.
const CYCLE: &str = "body crank { mass = 1 kg; inertia = [1, 1, 1] kg*m^2; marker flange = at([3, 9, -5] mm, z: [1, -1, 3]) }
    cycle angle = rotation(crank.flange, ground) { period = 720 deg }";

/// A load over the cycle, and the angle of a shell.
const GIVEN: &str = "fn round(angle: CrankAngle) -> Vector2<Force> = [8 kN*cos(angle - 0 deg), 5 kN*sin(angle - 0 deg)]
fn swinging(angle: CrankAngle) -> Angle = 17 deg*sin(angle - 0 deg)";

const fn given_load(class: &'static str) -> Case {
    Case {
        definitions: GIVEN,
        parts: CYCLE,
        ..journal(
            class,
            "pin: a.m, shell: b.m, diameter: 54 mm, width: 20 mm, radial_clearance: 27 um, viscosity: 10.5 mPa*s, \
             load: round, lean: swinging",
        )
    }
}

/// Two markers on the ground.
const FRAMES: &str = "marker frame = at([3, 9, -5] mm, z: [1, -1, 3])
    marker base = at([40, 20, 10] mm, z: [2, 1, 1])";

const CAGE: &str = "body cage { mass = 1 kg; inertia = [1, 1, 1] kg*m^2; marker m = at([1, 2, 3] mm, z: [1, 1, 2]) }";

/// The z axis of the plane of motion.
const PLANE: &str = "marker frame = [0, 0, 0] mm";

const CRANK: &str = "body crank { mass = 1 kg; inertia = [1, 1, 1] kg*m^2; marker flange = at([3, 9, -5] mm, z: [1, -1, 3]) }
    cycle angle = rotation(crank.flange, ground) { period = 720 deg }";

const fn of(module: &'static str, class: &'static str, arguments: &'static str) -> Case {
    Case {
        module,
        ..force(class, arguments, "")
    }
}

/// A part of a drive line: its laws hold where all axes are parallel.
const fn rotary(class: &'static str, arguments: &'static str) -> Case {
    Case {
        parts: PLANE,
        poses: Poses::Planar,
        ..of("std.drivelines", class, arguments)
    }
}

/// Every class of the library, some of them twice, and a class with a state of a length.
pub const CASES: &[Case] = &[
    joint("Fixed"),
    joint("Revolute"),
    joint("Spherical"),
    joint("Cylindrical"),
    joint("Translational"),
    joint("PointOnLine"),
    joint("PointOnPlane"),
    joint("Universal"),
    joint("ParallelAxes"),
    Case {
        arguments: "a.m, b.m, length: 140 mm",
        ..joint("Distance")
    },
    joint("Planar"),
    Case {
        arguments: "a.m, b.m, lead: 8 mm",
        ..joint("Screw")
    },
    Case {
        arguments: "a.m, frame, b.m, base, gear_ratio: -0.4, phase: 20 deg",
        parts: FRAMES,
        ..joint("GearRatio")
    },
    Case {
        arguments: "a.m, frame, b.m, base, pinion_radius: 20 mm, offset: 3 mm",
        parts: FRAMES,
        ..joint("RackAndPinion")
    },
    Case {
        arguments: "a.m, b.m, cage.m, phase: 20 deg",
        parts: CAGE,
        ..joint("Differential")
    },
    Case {
        arguments: "a.m, b.m, length: 20 mm",
        ..joint("Bifilar")
    },
    joint("Perpendicular"),
    joint("Homokinetic"),
    Case {
        arguments: "a.m, frame, b.m, base, profile: wave, base: 3 mm",
        definitions: "fn wave(turn: Angle) -> Length = 40 mm*cos(3*turn)",
        parts: FRAMES,
        ..joint("GrooveCam")
    },
    drive(
        "PrescribedTravel",
        "a.m, b.m, travel_at: way",
        "fn way(t: Time) -> Length = 40 mm*sin(30 rad/s * t)",
    ),
    drive(
        "PrescribedRotation",
        "a.m, b.m, speed: 3000 rpm, initial: 20 deg",
        "",
    ),
    drive(
        "PrescribedAngle",
        "a.m, b.m, angle_at: sweep",
        "fn sweep(t: Time) -> Angle = 40 rad/s * t + 0.3 rad*sin(90 rad/s * t)",
    ),
    drive(
        "PrescribedAngle",
        "a.m, b.m, angle_at: measured",
        "table measured(t: Time) -> Angle = points([-1, -0.4, 0.3, 1.1, 2] s, [0, 70, 40, 190, 260] deg, extrapolation: linear)",
    ),
    drive(
        "ConstantSpeed",
        "a.m, b.m, speed: 3000 rpm, initial: -40 deg",
        "",
    ),
    force(
        "TorsionSpring",
        "a.m, b.m, stiffness: 700 N*m/rad, damping: 3 N*m*s/rad, free_angle: 25 deg",
        "",
    ),
    force(
        "LinearSpring",
        "a.m, b.m, stiffness: 90 N/mm, damping: 400 N*s/m, free_length: 80 mm",
        "",
    ),
    force(
        "Bushing",
        "a.m, b.m, stiffness: [60, 90, 140] N/mm, damping: [300, 200, 700] N*s/m,
        torsional_stiffness: [800, 800, 800] N*m/rad, torsional_damping: [3, 5, 2] N*m*s/rad",
        "",
    ),
    force(
        "Bushing",
        "a.m, b.m, stiffness: [60, 90, 140] N/mm, damping: [300, 200, 700] N*s/m,
        torsional_stiffness: [400, 800, 900] N*m/rad, torsional_damping: [3, 5, 2] N*m*s/rad",
        "",
    ),
    Case {
        parts: CYCLE,
        ..force(
            "GasPressure",
            "a.m, b.m, bore: 86 mm, pressure: p, firing: 180 deg, scale: 0.9",
            "table p(theta: CrankAngle) -> AbsolutePressure = points([0, 90, 200, 360, 540, 720] deg, [50, 20, 5, 1, 3, 50] bar, periodic: 720 deg)",
        )
    },
    external("ExternalForce", "a.m, load: [300, -200, 90] N"),
    external("ExternalTorque", "a.m, load: [30, -20, 9] N*m"),
    force(
        "Actuator",
        "a.m, b.m, thrust: pull",
        "fn pull(t: Time) -> Force = 300 N*sin(70 rad/s * t)",
    ),
    force(
        "Motor",
        "a.m, b.m, torque_at: twist",
        "fn twist(t: Time) -> Torque = 30 N*m*cos(70 rad/s * t)",
    ),
    Case {
        definitions: "use std.gas.wiebe",
        parts: CRANK,
        ..of(
            "std.gas",
            "ClosedCycle",
            "a.m, b.m, bore: 86 mm, firing: 180 deg, ambient: 1 bar, scale: 0.9, top: 180 mm, stroke: 80 mm, compression_ratio: 10,
            heat: 1 kJ, burnt: wiebe(begin: -300 deg, duration: 600 deg)",
        )
    },
    of(
        "std.gas",
        "IdealCompressor",
        "a.m, b.m, bore: 60 mm, top: 180 mm, clearance: 11 cc, suction: 1 bar, delivery: 5 bar,
        suction_port: 10 cm^2, delivery_port: 10 cm^2",
    ),
    Case {
        definitions: "use std.gas.PlateValve
const valve = PlateValve(plate: 4 cm^2, port: 3 cm^2, lift: 2 mm, mass: 2 g, stiffness: 3 N/mm, preload: 1 N, damping: 1 N*s/m, stop: 100 N/mm)",
        ..of(
            "std.gas",
            "PlateCompressor",
            "a.m, b.m, bore: 60 mm, top: 180 mm, clearance: 11 cc, suction: 1 bar, delivery: 5 bar,
        suction_valve: valve, delivery_valve: valve",
        )
    },
    of(
        "std.contacts",
        "HuntCrossley",
        "a.m, b.m, reach: 3 m, reference_load: 100 N, reference_depth: 10 mm, exponent: 1.4, loss: 1e-3 s/m",
    ),
    Case {
        definitions: "use std.materials.Steel",
        ..of(
            "std.contacts",
            "SphereOnPlane",
            "a.m, b.m, reach: 3 m, ball: Steel, plate: Steel, loss: 1e-3 s/m",
        )
    },
    Case {
        definitions: "use std.materials.Steel",
        ..of(
            "std.contacts",
            "SphereOnSphere",
            "a.m, b.m, radius_a: 2 m, radius_b: 3 m, ball_a: Steel, ball_b: Steel, loss: 1e-3 s/m",
        )
    },
    of(
        "std.contacts",
        "CylinderOnPlane",
        "a.m, b.m, reach: 3 m, length: 12 mm, loss: 1e-3 s/m",
    ),
    of(
        "std.contacts",
        "EndStop",
        "a.m, b.m, reach: 3 m, stiffness: 10 N/mm, damping: 5 N*s/m, soft_depth: 1 m",
    ),
    of(
        "std.contacts",
        "WayStops",
        "a.m, b.m, way: 0 m, stiffness: 10 N/mm, damping: 5 N*s/m, soft_depth: 1 m",
    ),
    Case {
        poses: Poses::Film(CLEARANCE),
        ..of(
            "std.contacts",
            "PinInBush",
            "a.m, b.m, diameter: 20 mm, width: 20 mm, clearance: 0.2 um, layer: 90 GPa/mm, loss: 1 s/m",
        )
    },
    of(
        "std.contacts",
        "Friction",
        "a.m, b.m, normal_load: 20 N, static_friction: 0.3, kinetic_friction: 0.1, stribeck_speed: 20 m/s, creep: 10 m/s",
    ),
    of(
        "std.contacts",
        "LuGre",
        "a.m, b.m, normal_load: 20 N, static_friction: 0.3, kinetic_friction: 0.1, stribeck_speed: 20 m/s,
        bristle_stiffness: 100 N/m, bristle_damping: 0.3 N*s/m, viscous: 0.4 N*s/m",
    ),
    rotary("RotationalDamper", "a.m, b.m, damping: 0.3 N*m*s/rad"),
    rotary(
        "RubberRing",
        "a.m, b.m, stiffness: 700 N*m/rad, branch_stiffness: [90, 50, 70] N*m/rad, relaxation: [0.3, 1, 3] ms",
    ),
    rotary(
        "ViscousDamper",
        "a.m, b.m, damping: 0.5 N*m*s/rad, stiffness: 900 N*m/rad",
    ),
    rotary(
        "DualMassFlywheel",
        "a.m, b.m, stiffness: 20 N*m/rad, second_stiffness: 60 N*m/rad, free_play: 2 deg, second_stage: 20 deg,
        friction: 3 N*m, creep: 100 rad/s",
    ),
    rotary("Clutch", "a.m, b.m, capacity: 30 N*m, creep: 100 rad/s"),
    rotary("OneWay", "a.m, b.m, stiffness: 2 kN*m/rad, lag: 3 deg"),
    Case {
        definitions: "fn falling(speed: AngularVelocity) -> Torque = 10 N*m - 0.05 N*m*s/rad*speed",
        ..rotary("TorqueCurve", "a.m, b.m, torque_at: falling")
    },
    rotary(
        "InductionMotor",
        "a.m, b.m, synchronous_speed: -1500 rpm, breakdown_torque: 20 N*m, breakdown_slip: 15 %",
    ),
    rotary(
        "Propeller",
        "a.m, b.m, torque_there: 5 N*m, speed_there: 100 rad/s",
    ),
    rotary(
        "Dyno",
        "a.m, b.m, target: 1000 rpm, proportional: 1 N*m*s/rad, integral: 20 N*m/rad",
    ),
    Case {
        definitions: "fn wave(turn: Angle) -> Length = 5 um*sin(20*turn)",
        ..rotary(
            "GearMesh",
            "a.m, b.m, frame, base_radius_a: 4 mm, base_radius_b: 6 mm, center_distance: 10 m, stiffness: 2 N/mm,
        backlash: 20 um, damping: 2 N*s/m, soft_depth: 1 m, tooth_error: wave",
        )
    },
    Case {
        definitions: "use std.drivelines.Side",
        ..rotary(
            "BeltSpan",
            "a.m, b.m, frame, radius_a: 5 mm, radius_b: -8 mm, center_distance: 300 mm, side: right, rigidity: 100 kN,
        preload: 1 MN, damping: 1 N*s/m",
        )
    },
    of(
        "std.mounts",
        "ElastomerMount",
        "a.m, b.m, stiffness: [60, 90, 140] N/mm, fast_stiffness: [50, 70, 80] N/mm, relaxation: 3 ms, preload: [10, 20, 30] N",
    ),
    of(
        "std.mounts",
        "ElastomerMount",
        "a.m, b.m, stiffness: [60, 90, 140] N/mm, fast_stiffness: [50, 70, 80] N/mm, relaxation: 3 ms,
        torsional_stiffness: [400, 800, 900] N*m/rad, torsional_damping: [3, 5, 2] N*m*s/rad",
    ),
    // without torsion, whose law holds for small turns, it accounts for its energy at any pose
    of(
        "std.mounts",
        "RubberBushing",
        "a.m, b.m, [60, 90, 140] N/mm, [0, 0, 0] N*m/rad, loss: 0.2, loss_at: 50 Hz, preload: [10, 20, 30] N",
    ),
    of(
        "std.mounts",
        "RubberBushing",
        "a.m, b.m, stiffness: [60, 90, 140] N/mm, torsional_stiffness: [400, 800, 900] N*m/rad, loss: 0.2, loss_at: 50 Hz,
        preload: [10, 20, 30] N, preload_torque: [3, 5, 2] N*m",
    ),
    of(
        "std.mounts",
        "HydraulicMount",
        "a.m, b.m, stiffness: 200 N/mm, damping: 100 N*s/m, free_length: 20 mm, piston: 30 cm^2, compliance: 3e-11 m^3/Pa,
        inertance: 4e6 Pa*s^2/m^3, resistance: 2e7 Pa*s/m^3, orifice: 1e9 Pa*s^2/m^6",
    ),
    Case {
        definitions: "use std.valvetrain.harmonic_lift",
        parts: FRAMES,
        ..of(
            "std.valvetrain",
            "FlatTappet",
            "a.m, frame, b.m, base, profile: harmonic_lift(lift: 9 mm, half: 170 deg), base_radius: 3 m, face_radius: 1 m, stiffness: 20 N/mm, damping: 3 N*s/m,
        soft_depth: 1 m, base: 3 m",
        )
    },
    Case {
        definitions: "use std.valvetrain.harmonic_lift",
        parts: PLANE,
        poses: Poses::Planar,
        ..of(
            "std.valvetrain",
            "RollerCam",
            "a.m, b.m, base: 3 m, roller_radius: 1 m, profile: harmonic_lift(lift: 400 mm, half: 170 deg), stiffness: 20 N/mm, damping: 3 N*s/m, soft_depth: 1 m",
        )
    },
    Case {
        definitions: "use std.valvetrain.harmonic_lift",
        parts: PLANE,
        poses: Poses::Planar,
        ..of(
            "std.valvetrain",
            "RollerCam",
            "a.m, b.m, base: 3 m, roller_radius: 1 m, profile: harmonic_lift(lift: 400 mm, half: 170 deg), stiffness: 20 N/mm, damping: 3 N*s/m,
        soft_depth: 1 m, friction: 0.2, creep: 100 m/s",
        )
    },
    of(
        "std.valvetrain",
        "Pushrod",
        "a.m, b.m, length: 3 m, stiffness: 20 N/mm, damping: 3 N*s/m, soft_depth: 1 m",
    ),
    of(
        "std.valvetrain",
        "HydraulicLashAdjuster",
        "a.m, b.m, diameter: 11 mm, gap: 6 um, seal: 8 mm, volume: 0.3 cc, supply: 3 bar, viscosity: 10 mPa*s",
    ),
    Case {
        definitions: "use std.journals.Roughness",
        ..of(
            "std.thrust",
            "PlainThrust",
            "a.m, b.m, inner_diameter: 1 m, outer_diameter: 2 m, end_float: 5 m, viscosity: 10 Pa*s,
        roughness: Roughness(sigma: 0.8 m, asperity: 1e-3, modulus: 1 kPa, boundary_friction: 0.1)",
        )
    },
    Case {
        definitions: "use std.journals.Roughness",
        ..of(
            "std.thrust",
            "TaperLandThrust",
            "a.m, b.m, inner_diameter: 1 m, outer_diameter: 2 m, end_float: 5 m, viscosity: 10 Pa*s,
        roughness: Roughness(sigma: 0.8 m, asperity: 1e-3, modulus: 1 kPa, boundary_friction: 0.1), pads: 6, pad_angle: 52 deg, depth: 650 mm, taper: 0.72",
        )
    },
    Case {
        module: "std.liners",
        ..joint("PistonPlane")
    },
    of(
        "std.liners",
        "Skirt",
        "a.m, b.m, bore: 6 m, side: -1, clearance: 10 mm, bottom: -400 mm, top: 200 mm, width: 300 mm, layer: 2000 Pa/m, heights: 2,
        roughness: 500 mm, loss: 0.1 s/m, viscosity: 10 Pa*s, boundary_friction: 0.1",
    ),
    journal(
        "Short",
        "pin: a.m, shell: b.m, diameter: 54 mm, width: 13 mm, radial_clearance: 27 um, viscosity: 10.5 mPa*s",
    ),
    journal(
        "Impedance",
        "pin: a.m, shell: b.m, diameter: 54 mm, width: 20 mm, radial_clearance: 27 um, viscosity: 10.5 mPa*s",
    ),
    journal(
        "Reynolds",
        "pin: a.m, shell: b.m, diameter: 54 mm, width: 20 mm, radial_clearance: 27 um, viscosity: 10.5 mPa*s, ring_groove: 3 mm",
    ),
    journal(
        "Film",
        "pin: a.m, shell: b.m, diameter: 54 mm, width: 20 mm, radial_clearance: 27 um, viscosity: 10.5 mPa*s",
    ),
    given_load("Mobility"),
    given_load("SolvedMobility"),
    // the states of these tests are near absolute zero, where no oil of the library is liquid
    Case {
        definitions: "use std.oils.VogelOil\nconst flat = VogelOil(a: 1 mPa*s, b: 100 K, zero: 100 K)",
        ..journal(
            "ThermalFilm",
            "pin: a.m, shell: b.m, diameter: 54 mm, width: 20 mm, radial_clearance: 27 um, viscosity: 10.5 mPa*s, oil: flat, \
             start_temperature: 300 K, supply_temperature: 290 K, density: 830 kg/m^3, specific_heat: 2.2 kJ/kg/K, capacity: 2 J/K, \
             into_walls: 10 %, conductance: 3 W/K, wall_temperature: 310 K",
        )
    },
    Case {
        module: "",
        ..force(
            "Maxwell",
            "a.m, b.m, stiffness: 90 N/mm, damping: 400 N*s/m",
            "force Maxwell(a: Marker, b: Marker, stiffness: Stiffness, damping: Damping) {
    let e = a.origin - b.origin
    let distance = norm(e, floor: 1 um)
    state creep: Length = 1 mm
    let pull = stiffness*(distance - creep)
    der(creep) = pull/damping
    apply force -pull/distance*e on a against b
    output power_loss: Power = pull*pull/damping as W
}",
        )
    },
];

impl Case {
    /// Whether the class acts on its markers. Laws of the mobility method follow a load that the text states.
    pub fn acts(&self) -> bool {
        !self.class.ends_with("Mobility")
    }

    /// The model. Markers are oblique and beside the origins of their bodies.
    pub fn text(&self) -> String {
        let Case {
            module,
            kind,
            class,
            arguments,
            definitions,
            parts,
            ..
        } = self;
        let import = if module.is_empty() {
            String::new()
        } else {
            format!("use {module}.{class}")
        };
        format!(
            "{import}
{definitions}
model Pair {{
    gravity = [0, 0, 0] m/s^2
    body a {{ mass = 1 kg; inertia = [1, 1, 1] kg*m^2; marker m = at([31, -17, 44] mm, x: [2, 1, -1], z: [1, 2, 2]) }}
    body b {{ mass = 1 kg; inertia = [1, 1, 1] kg*m^2; marker m = at([-12, 25, 8] mm, x: [1, 0, 3], z: [-2, 1, 1]) }}
    {parts}
    {kind} it = {class}({arguments})
}}
analysis start = assemble(Pair())
"
        )
    }
}

/// Names of the library's classes that elements can be made of: module, name.
fn classes() -> BTreeSet<(String, String)> {
    let (mut sources, mut diagnostics) = (SourceMap::new(), Diagnostics::new());
    let mut found = BTreeSet::new();
    for (module, text) in LIBRARY {
        let source = sources.add(*module, *text);
        for item in eng_grammar::parse(text, source, &mut diagnostics).items {
            let ItemKind::Declaration(declaration) = item.kind else {
                continue;
            };
            let element = matches!(
                declaration.kind,
                Kind::Joint | Kind::Force | Kind::Journal | Kind::Drive
            );
            if element && matches!(declaration.form, Form::Class { .. }) {
                found.insert(((*module).to_owned(), declaration.name.text));
            }
        }
    }
    assert!(!diagnostics.has_errors());
    found
}

#[test]
fn every_class_of_the_library_is_here() {
    let listed: BTreeSet<_> = CASES
        .iter()
        .filter(|c| !c.module.is_empty())
        .map(|c| (c.module.to_owned(), c.class.to_owned()))
        .collect();
    assert_eq!(classes(), listed);
    // and every file of the library is part of it
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../stdlib");
    let files: BTreeSet<_> = std::fs::read_dir(folder)
        .expect("the library's folder")
        .map(|entry| entry.expect("an entry").path())
        .filter(|path| path.extension().is_some_and(|e| e == "eng"))
        .map(|path| {
            format!(
                "std.{}",
                path.file_stem().expect("a name").to_string_lossy()
            )
        })
        .collect();
    let modules: BTreeSet<_> = LIBRARY.iter().map(|(m, _)| (*m).to_owned()).collect();
    assert_eq!(files, modules);
}
