//! The assembly of slider-cranks whose bore points anywhere.

use eng::{Sources, check};

/// Throw, length of the rod (mm), and the angle of the crank (°).
const THROW: f64 = 43.0;
const ROD: f64 = 143.0;
const TURNED: f64 = 40.0;

/// A crank, a rod and a piston in a bore. The rod begins along x, wherever the bore is.
const ENGINE: &str = "
use std.joints.{Translational, Revolute, PointOnLine, PointOnPlane}
use std.journals.Impedance
model V {
    param bank: Angle = 0 deg
    gravity = [0, 0, 0] m/s^2
    marker rail = [0, 0, 0] mm
    marker bore = at([0, 0, 0] mm, z: [cos(bank), sin(bank), 0])
    body crank { mass = 8 kg; inertia = [9, 9, 9] g*m^2; marker main = origin; marker pin = [43, 0, 0] mm }
    joint main = Revolute(crank.main, rail)
    body shank {
        mass = 0.5 kg; inertia = [0.1, 1.5, 1.5] g*m^2; center_of_mass = [40, 0, 0] mm
        marker big = origin; marker small = [143, 0, 0] mm
    }
    body crown { mass = 0.4 kg; inertia = [0.4, 0.4, 0.4] g*m^2; marker pin = origin; marker axis = at(origin, z: [1, 0, 0]) }
    JOINTS
    joint liner = Translational(crown.axis, bore) { branch travel > 0 mm }
    start rotation(crank.main, rail) = 40 deg
}
analysis placed[a in 0 deg .. 350 deg by 10 deg] = assemble(V(bank: a))
";

/// The piston's way from the crank's axis (mm) in each bank against `r cos α + √(l² − r² sin² α)`, with the angle α of
/// the crank from the bore.
fn check_all(joints: &str, tolerance: f64) {
    let text = ENGINE.replace("JOINTS", joints);
    let program = check(&Sources::from_texts([("v.eng".to_owned(), text)]), "v.eng")
        .into_program()
        .unwrap_or_else(|report| panic!("{report}"));
    for bank in 0..36_u8 {
        let analysis = program.analysis(&format!("placed[{}]", bank + 1)).unwrap();
        let outcome = analysis
            .run(&mut |_| {})
            .unwrap_or_else(|failed| panic!("{joints}, {}0 deg: {}", bank, failed.error));
        let travel = outcome.results.column("liner.travel").unwrap();
        let angle = (TURNED - 10.0 * f64::from(bank)).to_radians();
        let (sin, cos) = angle.sin_cos();
        let expected = THROW * cos + (ROD * ROD - THROW * THROW * sin * sin).sqrt();
        let found = 1e3 * travel.values[0];
        assert!(
            (found - expected).abs() < tolerance,
            "{joints}, {bank}0 deg: {found} and {expected}"
        );
    }
}

#[test]
fn hinged_rods_turn_into_every_bore() {
    check_all(
        "joint big = Revolute(shank.big, crank.pin); joint wrist = PointOnLine(shank.small, crown.pin)",
        1e-6,
    );
}

/// Films place pins in the middle of their shells.
#[test]
fn rods_in_films_turn_into_every_bore() {
    check_all(
        "journal big = Impedance(crank.pin, shank.big, diameter: 48 mm, width: 20 mm, radial_clearance: 25 um, viscosity: 10 mPa*s)
         journal wrist = Impedance(shank.small, crown.pin, diameter: 22 mm, width: 20 mm, radial_clearance: 10 um, viscosity: 10 mPa*s)
         joint side = PointOnPlane(shank.big, crank.pin)",
        1e-6,
    );
}
