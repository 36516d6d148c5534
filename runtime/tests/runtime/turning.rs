//! The quasi-static start of turning flexible bodies: loads that are fixed in space and loads that turn, against
//! closed forms.

use crate::flexible::Nodes;
use crate::support::classes::*;
use crate::support::*;
use eng_runtime::start::Turning;
use eng_runtime::{Options, Simulation, StartReport};
use eng_system::code::Compiled;
use eng_system::system::{Role, Start, StepControl};
use nalgebra::{Complex, DMatrix, DVector};

const GRAVITY: f64 = 9.81;
/// The disc's mass (kg).
const DISC: f64 = 2.0;
/// Frequency of the round shaft between stiff bearings (rad/s).
const OMEGA: f64 = 200.0;
/// A quarter turn.
const I: Complex<f64> = Complex::new(0.0, 1.0);

/// A massless shaft along z whose disc is a point, off the axis by `offset`; it moves along x and y against the frame.
#[derive(Clone, Copy)]
struct Rotor {
    /// Squares of the disc's frequencies along the shaft's x and y (1/s²).
    squares: [f64; 2],
    /// c/m of the shaft (1/s).
    damping: f64,
    offset: f64,
    gravity: f64,
    speed: f64,
}

impl Rotor {
    fn round(ratio: f64) -> Rotor {
        Rotor {
            squares: [OMEGA * OMEGA; 2],
            damping: 0.0,
            offset: 0.0,
            gravity: GRAVITY,
            speed: ratio * OMEGA,
        }
    }

    fn nodes(&self) -> (Nodes, DMatrix<f64>, DMatrix<f64>) {
        let still = vec![[0.0; 3]; 2];
        let nodes = Nodes::lumped(&[
            ([0.0, 0.0, -0.3], 0.5, still.clone()),
            ([0.0, 0.0, 0.3], 0.5, still.clone()),
            ([0.1, 0.0, 0.0], 0.25, still.clone()),
            ([-0.1, 0.0, 0.0], 0.25, still.clone()),
            ([0.0, 0.1, 0.0], 0.25, still.clone()),
            ([0.0, -0.1, 0.0], 0.25, still),
            (
                [self.offset, 0.0, 0.0],
                DISC,
                vec![[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
            ),
        ]);
        let diagonal = |x: [f64; 2]| DMatrix::from_diagonal(&DVector::from_row_slice(&x));
        (
            nodes,
            diagonal(self.squares.map(|s| DISC * s)),
            diagonal([DISC * self.damping; 2]),
        )
    }

    /// The rotor in stiff bearings, or with each end on a spring (N/m) across the axis.
    fn compiled(&self, bearing: Option<f64>) -> Compiled {
        let (nodes, stiffness, damping) = self.nodes();
        let mut b = Builder::new([0.0, -self.gravity, 0.0]);
        let axes = vec![IDENTITY; nodes.places.len()];
        let body = nodes.reduced(&stiffness, &damping);
        let (_, markers) = b.flexible("shaft", body, ([0.0; 3], IDENTITY), &axes);
        let ends = [-0.3, 0.3].map(|z| b.marker("end", None, [0.0, 0.0, z], IDENTITY));
        match bearing {
            None => {
                let revolute = b.class("Revolute", Revolute);
                let element = [markers[0], ends[0]];
                b.element("hinge", revolute, Role::Dynamic, &element, &[], &[]);
            }
            Some(k) => {
                let bushing = b.class("Bushing", Bushing);
                for (marker, end) in markers.iter().zip(ends) {
                    let constants = [k, 0.0, 0.0, 0.0];
                    b.element(
                        "bearing",
                        bushing,
                        Role::Dynamic,
                        &[*marker, end],
                        &constants,
                        &[],
                    );
                }
            }
        }
        let drive = b.class("Drive", Drive);
        let constants = [0.0, self.speed, 0.0];
        b.element(
            "turn",
            drive,
            Role::Dynamic,
            &[markers[0], ends[0]],
            &constants,
            &[],
        );
        b.finish()
    }

    /// The disc's place and velocity across the axis at the start, seen in space, x + iy, in stiff bearings:
    /// `z̈ + c(ż − iΩz) + ω₀² z + Δ z* e^{2iΩt} = −ig + ω-forces of the offset`.
    fn due(&self) -> (Complex<f64>, Complex<f64>) {
        let mean = 0.5 * (self.squares[0] + self.squares[1]);
        let half = 0.5 * (self.squares[0] - self.squares[1]);
        let w = self.speed;
        let (still, twice) = if half == 0.0 {
            (
                -I * self.gravity / (mean - I * w * self.damping),
                Complex::default(),
            )
        } else {
            let d = mean * (mean - 4.0 * w * w) - half * half;
            (
                -I * self.gravity * (mean - 4.0 * w * w) / d,
                -I * self.gravity * half / d,
            )
        };
        // the offset lies along the shaft's x
        let turning = if self.offset == 0.0 {
            Complex::default()
        } else {
            Complex::from(self.offset * w * w / (self.squares[0] - w * w))
        };
        (still + twice + turning, I * w * (twice * 2.0 + turning))
    }
}

fn begin(compiled: &Compiled, step: f64) -> Simulation {
    let options = Options {
        step: StepControl::Fixed(step),
        start: Start::QuasiStatic,
        ..Options::default()
    };
    Simulation::new(compiled, &[], options).unwrap()
}

/// The disc's move against the frame's axis, seen in space, and its rate there where the frame turns about z alone.
fn disc(s: &Simulation) -> (Complex<f64>, Complex<f64>) {
    let state = s.state();
    let (_, rotation) = s.body_pose(0).unwrap();
    let turned = |x: &[f64]| {
        let [a, b] = [x[0], x[1]];
        Complex::new(
            rotation[(0, 0)] * a + rotation[(0, 1)] * b,
            rotation[(1, 0)] * a + rotation[(1, 1)] * b,
        )
    };
    let place = turned(&state.pose[7..]);
    let rate = turned(&state.velocity[6..]) + I * state.velocity[5] * place;
    (place, rate)
}

fn change(s: &Simulation) -> f64 {
    let StartReport::QuasiStatic(found) = s.start() else {
        panic!("{}", s.start());
    };
    let Some(Turning::Repeating { change, .. }) = &found.turning else {
        panic!("{}", s.start());
    };
    *change
}

/// Compares the motion with the closed form: at the start to 1e-6, and in the first 10 ms.
fn follows(rotor: Rotor) {
    let mut s = begin(&rotor.compiled(None), 2e-5);
    let (place, rate) = rotor.due();
    let sag = GRAVITY / (OMEGA * OMEGA);
    let at_once = disc(&s);
    let ratio = rotor.speed / OMEGA;
    assert!(
        (at_once.0 - place).norm() < 1e-6 * sag,
        "{ratio}: {} {place}",
        at_once.0
    );
    assert!(
        (at_once.1 - rate).norm() < 1e-6 * sag * rotor.speed,
        "{ratio}: {} {rate}",
        at_once.1
    );
    assert!(change(&s) < 1e-8, "{}", s.start());
    // bodies at rest stay at rest, and turning ones turn on
    let turning = rate / (I * rotor.speed);
    let mut worst = 0.0_f64;
    while s.time() < 0.01 {
        s.step_within(0.01).unwrap();
        let along = (I * rotor.speed * s.time()).exp();
        let due = if rotor.squares[0] == rotor.squares[1] {
            place - turning + turning * along
        } else {
            place - turning * 0.5 + turning * 0.5 * along * along
        };
        worst = worst.max((disc(&s).0 - due).norm());
    }
    assert!(worst < 1e-4 * sag, "{ratio}: rings by {:e}", worst / sag);
}

/// A load that is fixed in space bends a round shaft as at rest, at every speed.
#[test]
fn a_round_shaft_sags_as_at_rest() {
    for ratio in [0.3, 0.5, 0.8, 1.0, 1.5] {
        let rotor = Rotor::round(ratio);
        let sag = -I * GRAVITY / (OMEGA * OMEGA);
        assert!((rotor.due().0 - sag).norm() < 1e-12 * sag.norm());
        follows(rotor);
    }
}

/// A load that turns with it bends it by 1/(1 − Ω²/ω²) of the static bending.
#[test]
fn an_unbalance_bends_by_the_resonance_curve() {
    for ratio in [0.3, 0.5, 0.8, 1.5] {
        follows(Rotor {
            gravity: 0.0,
            offset: 1e-4,
            ..Rotor::round(ratio)
        });
    }
}

/// If both loads act, each has its own bending.
#[test]
fn sag_and_unbalance_at_once() {
    for ratio in [0.3, 0.5, 0.8, 1.5] {
        follows(Rotor {
            offset: 1e-4,
            ..Rotor::round(ratio)
        });
    }
}

/// Damping of the shaft turns the sag sideways: sag/(1 − 2iζΩ/ω).
#[test]
fn damping_of_the_shaft_turns_the_sag() {
    let rotor = Rotor {
        damping: 2.0 * 0.02 * OMEGA,
        ..Rotor::round(0.48285)
    };
    let share = rotor.due().0 / (-I * GRAVITY / (OMEGA * OMEGA));
    assert!(
        (share - Complex::new(0.999_627, 0.019_307)).norm() < 1e-6,
        "{share}"
    );
    follows(rotor);
}

/// A shaft of unequal stiffness moves at twice its speed under gravity, by the closed form; both numbers of it at
/// 30 rad/s.
#[test]
fn an_unequal_shaft_sags_and_moves_at_twice_its_speed() {
    let rotor = |speed: f64| Rotor {
        squares: [110.0 * 110.0, 90.0 * 90.0],
        speed,
        ..Rotor::round(0.0)
    };
    let (place, rate) = rotor(30.0).due();
    let twice = rate / (2.0 * I * 30.0);
    assert!((twice.norm() / GRAVITY - 3.244_120e-5).abs() < 1e-11);
    assert!(((place - twice).norm() / GRAVITY - 1.054_339e-4).abs() < 1e-10);
    for speed in [30.0, 70.0, 130.0] {
        follows(rotor(speed));
    }
}

/// Ends on springs, stiffer up than sideways: the frame moves too. Gravity lowers it and bends the shaft as
/// at rest; under the unbalance both run in ellipses, each axis by its own two equations.
#[test]
fn a_shaft_on_springs_takes_its_frame_along() {
    let spring = 3e4;
    for ratio in [0.3, 0.6, 1.5] {
        let rotor = Rotor {
            offset: 1e-4,
            ..Rotor::round(ratio)
        };
        let s = begin(&rotor.compiled(Some(spring)), 2e-5);
        let (frame, shaft, speed) = (2.0, DISC, rotor.speed);
        let (k, squared) = (DISC * OMEGA * OMEGA, speed * speed);
        // the bushing's stiffness along its x and y
        let supports = [2.0 * spring, 2.0 * 1.7 * spring];
        // of frame and bending
        let [across, up] = supports.map(|support| {
            let matrix = nalgebra::Matrix2::new(
                support - (frame + shaft) * squared,
                -shaft * squared,
                -shaft * squared,
                k - shaft * squared,
            );
            let force = shaft * rotor.offset * squared;
            matrix
                .lu()
                .solve(&nalgebra::Vector2::new(force, force))
                .unwrap()
        });
        let drop = (frame + shaft) * GRAVITY / supports[1];
        let sag = shaft * GRAVITY / k;
        let state = s.state();
        let (place, rate) = disc(&s);
        let due = Complex::from(across[1]) - I * sag;
        assert!((place - due).norm() < 1e-6 * sag, "{ratio}: {place} {due}");
        let due = I * speed * up[1];
        assert!(
            (rate - due).norm() < 1e-6 * sag * speed,
            "{ratio}: {rate} {due}"
        );
        let near =
            |a: f64, b: f64, size: f64| assert!((a - b).abs() < 1e-6 * size, "{ratio}: {a} {b}");
        near(state.pose[0], across[0], drop);
        near(state.pose[1], -drop, drop);
        near(state.velocity[1], speed * up[0], drop * speed);
        near(state.velocity[0], 0.0, drop * speed);
        assert!(change(&s) < 1e-6, "{}", s.start());
    }
}

/// An unbalance at the critical speed has no repeating motion without damping. The message names shape, order and
/// speed.
#[test]
fn resonance_is_told() {
    let rotor = Rotor {
        offset: 1e-6,
        ..Rotor::round(1.0)
    };
    let s = begin(&rotor.compiled(None), 2e-5);
    let told = s.start().to_string();
    assert!(
        told.contains("loads of order 0.000 in the axes of shaft"),
        "{told}"
    );
    assert!(told.contains("are in resonance with its shape "), "{told}");
    assert!(told.contains(" at 1909.9 rpm"), "{told}");
}

/// Beside a second shaft of another speed a motion repeats when both have made whole turns, or a message states that it
/// does not.
#[test]
fn a_motion_without_period_is_told() {
    let with = |second: f64| {
        let rotor = Rotor::round(0.5);
        let (nodes, stiffness, damping) = rotor.nodes();
        let mut b = Builder::new([0.0, -GRAVITY, 0.0]);
        let axes = vec![IDENTITY; nodes.places.len()];
        let revolute = b.class("Revolute", Revolute);
        let drive = b.class("Drive", Drive);
        for (name, x, speed) in [
            ("first", 0.0, rotor.speed),
            ("second", 1.0, second * rotor.speed),
        ] {
            let body = nodes.reduced(&stiffness, &damping);
            let (_, markers) = b.flexible(name, body, ([x, 0.0, 0.0], IDENTITY), &axes);
            let end = b.marker("end", None, [x, 0.0, -0.3], IDENTITY);
            let pair = [markers[0], end];
            b.element(name, revolute, Role::Dynamic, &pair, &[], &[]);
            b.element(name, drive, Role::Dynamic, &pair, &[0.0, speed, 0.0], &[]);
        }
        begin(&b.finish(), 2e-5)
    };
    let s = with(1.5);
    let sag = GRAVITY / (OMEGA * OMEGA);
    assert!(change(&s) < 1e-8, "{}", s.start());
    let state = s.state();
    for amplitude in [state.pose[8], state.pose[17]] {
        assert!((amplitude + sag).abs() < 1e-6 * sag, "{amplitude}");
    }
    let told = with(std::f64::consts::FRAC_1_SQRT_2).start().to_string();
    assert!(told.contains("does not repeat within 20 turns"), "{told}");
}
