//! Mechanisms that several tests use.

use crate::support::classes::*;
use crate::support::*;
use eng_system::code::Compiled;
use eng_system::system::Role;

pub const CRANK: f64 = 0.05;
pub const ROD: f64 = 0.16;

/// The drive of the crank of [`slider_crank`].
#[derive(Clone, Copy, PartialEq)]
pub enum Turn {
    /// A drive: angle = start + speed t.
    Driven { start: f64, speed: f64 },
    /// No drive: the crank starts with a speed and is then free.
    Free { start: f64, speed: f64 },
}

pub struct SliderCrank {
    pub compiled: Compiled,
    pub angle: usize,
    pub travel: usize,
}

fn plain(mass: f64, inertia: [f64; 3]) -> BodySpec {
    BodySpec {
        mass,
        center: [0.0; 3],
        inertia,
        place: None,
    }
}

/// Crank about z, rod on a revolute big end and a spherical small end with a roll-free piston pin, piston
/// along x. Rod and piston have no stated place.
pub fn slider_crank(turn: Turn, gravity: [f64; 3], extras: bool) -> SliderCrank {
    let mut b = Builder::new(gravity);
    let crank = b.body(
        "crank",
        BodySpec {
            mass: 2.0,
            center: [0.01, 0.002, 0.0],
            inertia: [2e-3, 2e-3, 3e-3],
            place: Some(([0.0; 3], IDENTITY)),
        },
    );
    let rod = b.body(
        "rod",
        BodySpec {
            mass: 0.6,
            center: [0.05, 0.0, 0.0],
            inertia: [1e-4, 1.5e-3, 1.5e-3],
            place: None,
        },
    );
    let piston = b.body("piston", plain(0.5, [3e-4, 3e-4, 3e-4]));
    let rail = b.marker("rail", None, [0.0; 3], IDENTITY);
    let bore = b.marker("bore", None, [0.0; 3], Z_ALONG_X);
    let main = b.marker("crank.main", Some(crank), [0.0; 3], IDENTITY);
    let pin = b.marker("crank.pin", Some(crank), [CRANK, 0.0, 0.0], IDENTITY);
    let big = b.marker("rod.big", Some(rod), [0.0; 3], IDENTITY);
    let small = b.marker("rod.small", Some(rod), [ROD, 0.0, 0.0], IDENTITY);
    let wrist = b.marker("piston.wrist", Some(piston), [0.0; 3], IDENTITY);
    let skirt = b.marker("piston.skirt", Some(piston), [0.0; 3], Z_ALONG_X);
    let revolute = b.class("Revolute", Revolute);
    let slide = b.class("Translational", Translational);
    let on_line = b.class("InPlane", InPlane);
    let drive = b.class("Drive", Drive);
    let angle = b.class("Angle", Angle);
    let start_angle = b.class("StartAngle", StartAngle);
    let start_spin = b.class("StartSpin", StartSpin);
    b.element("main", revolute, Role::Dynamic, &[main, rail], &[], &[]);
    b.element("big_end", revolute, Role::Dynamic, &[big, pin], &[], &[]);
    b.element(
        "small_end",
        on_line,
        Role::Dynamic,
        &[small, wrist],
        &[],
        &[],
    );
    let guide = b.element("guide", slide, Role::Dynamic, &[skirt, bore], &[0.0], &[]);
    match turn {
        Turn::Driven { start, speed } => {
            b.element(
                "drive",
                drive,
                Role::Dynamic,
                &[main, rail],
                &[start, speed, 0.0],
                &[],
            );
        }
        Turn::Free { start, speed } => {
            let exact = Role::StartPosition { exact: true };
            b.element("start", start_angle, exact, &[main, rail], &[start], &[]);
            let exact = Role::StartVelocity { exact: true };
            b.element("spin", start_spin, exact, &[main, rail], &[speed], &[]);
        }
    }
    if extras {
        let spring = b.class("Spring", Spring);
        let maxwell = b.class("Maxwell", Maxwell);
        let anchor = b.marker("anchor", None, [0.1, 0.15, 0.05], IDENTITY);
        b.element(
            "spring",
            spring,
            Role::Dynamic,
            &[wrist, anchor],
            &[800.0, 0.12, 5.0, 0.001],
            &[],
        );
        b.element(
            "maxwell",
            maxwell,
            Role::Dynamic,
            &[small, anchor],
            &[500.0, 0.01],
            &[0.15],
        );
    }
    let cycle = b.element("cycle", angle, Role::Output, &[main, rail], &[], &[]);
    b.cycle(cycle, 4.0 * std::f64::consts::PI);
    let angle = b.channels(cycle);
    let travel = b.channels(guide);
    SliderCrank {
        compiled: b.finish(),
        angle,
        travel,
    }
}

/// A chain of two bodies on spherical joints with springs, in gravity: three-dimensional, not driven.
pub fn spatial_chain() -> Compiled {
    let mut b = Builder::new([0.3, -0.5, -9.81]);
    let first = b.body(
        "first",
        BodySpec {
            mass: 1.2,
            center: [0.15, 0.02, -0.01],
            inertia: [0.002, 0.012, 0.011],
            place: Some(([0.0; 3], IDENTITY)),
        },
    );
    let second = b.body(
        "second",
        BodySpec {
            mass: 0.8,
            center: [0.1, 0.0, 0.03],
            inertia: [0.003, 0.008, 0.007],
            place: Some(([0.3, 0.0, 0.0], IDENTITY)),
        },
    );
    let ground = b.marker("ground", None, [0.0; 3], IDENTITY);
    let post = b.marker("post", None, [0.5, 0.4, -0.1], IDENTITY);
    let root = b.marker("first.root", Some(first), [0.0; 3], IDENTITY);
    let end = b.marker("first.end", Some(first), [0.3, 0.0, 0.0], IDENTITY);
    let joint = b.marker("second.joint", Some(second), [0.0; 3], Z_ALONG_X);
    let tip = b.marker("second.tip", Some(second), [0.25, 0.05, 0.02], IDENTITY);
    let spherical = b.class("Spherical", Spherical);
    let spring = b.class("Spring", Spring);
    let bushing = b.class("Bushing", Bushing);
    let maxwell = b.class("Maxwell", Maxwell);
    let velocity = b.class("StartRotation", StartRotation);
    let hold = b.element("hold", spherical, Role::Dynamic, &[root, ground], &[], &[]);
    b.element("link", spherical, Role::Dynamic, &[joint, end], &[], &[]);
    b.element(
        "spring",
        spring,
        Role::Dynamic,
        &[tip, post],
        &[60.0, 0.3, 0.8, 0.001],
        &[],
    );
    b.element(
        "bushing",
        bushing,
        Role::Dynamic,
        &[tip, end],
        &[20.0, 0.3, 0.4, 0.01],
        &[],
    );
    b.element(
        "maxwell",
        maxwell,
        Role::Dynamic,
        &[end, post],
        &[40.0, 0.05],
        &[0.4],
    );
    let exact = Role::StartVelocity { exact: true };
    b.element(
        "spin.first",
        velocity,
        exact,
        &[root],
        &[2.0, -1.0, 1.5],
        &[],
    );
    b.element(
        "spin.second",
        velocity,
        exact,
        &[tip],
        &[-1.0, 3.0, 2.0],
        &[],
    );
    b.channels(hold);
    b.finish()
}
