//! Rocker arms, finger followers and pushrods of `std.valvetrain`: lift over the turn of the cam against the roots of the equations
//! of the geometry, forces against virtual work with inertia.

use crate::library_run::{close, column, largest, last, run};
use eng::Sources;
use eng::results::Results;
use std::f64::consts::{PI, TAU};

type Point = [f64; 2];

/// Places of the finger trains below (m): axis of the cam, end of the closed valve's stem, points of the finger in its drawing.
const AXLE: Point = [0.020, 0.029];
const STEM: f64 = -0.002;
const CAM_SIDE: Point = [0.019, 0.005];
const TIP: Point = [0.042, 0.008];
/// Radii of base circle and roller together, and of the tip.
const BASE: f64 = 0.024;
const TIP_RADIUS: f64 = 0.010;
/// Lift of the roller's path on the cam.
const LIFT: f64 = 0.005;
/// Stiffness (N/m) and load of the valve's spring on the closed valve (N).
const SPRING: f64 = 30e3;
const PRELOAD: f64 = 300.0;

fn plus(a: Point, b: Point) -> Point {
    [a[0] + b[0], a[1] + b[1]]
}

fn minus(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1]]
}

fn turned(a: Point, angle: f64) -> Point {
    let (sin, cos) = angle.sin_cos();
    [a[0] * cos - a[1] * sin, a[0] * sin + a[1] * cos]
}

/// The moment of a force at an arm.
fn moment(arm: Point, force: Point) -> f64 {
    arm[0] * force[1] - arm[1] * force[0]
}

/// The root of a function of one sign at each end, by halving.
fn root(f: &dyn Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    let sign = f(low).signum();
    assert!(sign != f(high).signum(), "no root between {low} and {high}");
    for _ in 0..100 {
        let mid = 0.5 * (low + high);
        if f(mid).signum() == sign {
            low = mid;
        } else {
            high = mid;
        }
    }
    0.5 * (low + high)
}

/// Lift and slope of `polynomial_lift` of power 4.
fn polynomial(angle: f64, lift: f64, half: f64) -> (f64, f64) {
    let angle = (angle + PI).rem_euclid(TAU) - PI;
    let inside = (1.0 - (angle / half).powi(2)).max(0.0);
    (
        lift * inside.powi(4),
        -8.0 * lift * angle / half.powi(2) * inside.powi(3),
    )
}

/// A finger whose ball is at a height on the y axis, under a cam of half an opening.
pub struct Finger {
    pub ball: f64,
    pub half: f64,
}

impl Finger {
    /// Turn of the finger at an angle of the cam, with a gap between roller and cam.
    fn turn(&self, cam: f64, gap: f64) -> f64 {
        let miss = |turn: f64| {
            let arm = self.arm_from_cam(turn);
            let (lift, _) = polynomial(arm[1].atan2(arm[0]) - cam, LIFT, self.half);
            arm[0].hypot(arm[1]) - BASE - lift - gap
        };
        root(&miss, -0.5, 0.1)
    }

    /// The roller's axis, seen from that of the cam.
    fn arm_from_cam(&self, turn: f64) -> Point {
        minus(plus([0.0, self.ball], turned(CAM_SIDE, turn)), AXLE)
    }

    fn lift(&self, cam: f64, gap: f64, tip_gap: f64) -> f64 {
        STEM + TIP_RADIUS + tip_gap - self.ball - turned(TIP, self.turn(cam, gap))[1]
    }

    /// Direction of the push of the cam on the roller.
    fn normal(&self, cam: f64, turn: f64) -> Point {
        let arm = self.arm_from_cam(turn);
        let distance = arm[0].hypot(arm[1]);
        let (_, slope) = polynomial(arm[1].atan2(arm[0]) - cam, LIFT, self.half);
        let lean = slope / distance;
        let steep = lean.hypot(1.0) * distance;
        [
            (arm[0] + lean * arm[1]) / steep,
            (arm[1] - lean * arm[0]) / steep,
        ]
    }

    /// Arms of the contact with the cam and of that with the valve about the ball.
    fn arms(&self, cam: f64, gap: f64) -> (f64, f64) {
        let turn = self.turn(cam, gap);
        (
            moment(turned(CAM_SIDE, turn), self.normal(cam, turn)),
            moment(turned(TIP, turn), [0.0, 1.0]),
        )
    }

    /// Turn of the finger with its rate and its acceleration, at a speed of the cam.
    fn motion(&self, cam: f64, speed: f64) -> [f64; 3] {
        let h = 1e-3;
        let f: [f64; 5] = std::array::from_fn(|k| self.turn(cam + (k as f64 - 2.0) * h, 0.0));
        let rate = speed * (f[0] - 8.0 * f[1] + 8.0 * f[3] - f[4]) / (12.0 * h);
        let bend =
            speed * speed * (16.0 * (f[1] + f[3]) - f[0] - f[4] - 30.0 * f[2]) / (12.0 * h * h);
        [f[2], rate, bend]
    }

    /// Loads between cam and roller and between tip and stem at a speed of the cam: the valve of 80 g, the finger of 60 g and 20 kg mm².
    fn loads(&self, cam: f64, speed: f64) -> [f64; 2] {
        let [turn, rate, bend] = self.motion(cam, speed);
        let tip = turned(TIP, turn);
        let sinking = tip[1] * rate * rate - tip[0] * bend;
        let on_tip = PRELOAD + SPRING * self.lift(cam, 0.0, 0.0) + 0.08 * sinking;
        let inertia = 20e-6 + 0.06 * (0.020_f64.powi(2) + 0.003_f64.powi(2));
        let (cam_arm, valve_arm) = self.arms(cam, 0.0);
        [(inertia * bend - on_tip * valve_arm) / cam_arm, on_tip]
    }

    /// Push of the ball on the finger along the adjuster: Newton's equation of the finger.
    pub fn ball_push(&self, cam: f64, speed: f64) -> f64 {
        let [turn, rate, bend] = self.motion(cam, speed);
        let center = turned([0.020, 0.003], turn);
        let rising = center[0] * bend - center[1] * rate * rate;
        let [on_roller, on_tip] = self.loads(cam, speed);
        0.06 * rising - on_roller * self.normal(cam, turn)[1] - on_tip
    }
}

/// A train with the finger: the marker that carries its ball, its class, further arguments of this class, stiffness of the contacts,
/// half the opening (deg), the analysis.
fn train(ball: &str, [class, more]: [&str; 2], contact: &str, half: f64, analysis: &str) -> String {
    format!(
        "use std.valvetrain.*
use std.drives.ConstantSpeed
model Train {{
    param speed: AngularVelocity = 1000 rpm
    gravity = [0, 0, 0] m/s^2
    marker ball = {ball}
    marker axle = [20, 29, 0] mm
    marker seat = at([42, -40, 0] mm, z: [0, 1, 0])
    body cam {{ mass = 1 kg; inertia = [0.5, 0.5, 0.5] g*m^2; marker main = origin }}
    drive turn = ConstantSpeed(cam.main, axle, speed: speed, initial: 180 deg)
    const finger = Lever(mass: 60 g, inertia: 20 kg*mm^2, center: [20, 3] mm, cam_side: [19, 5] mm, tip: [42, 8] mm, tip_radius: 10 mm)
    part valve = Valve(seat, valve_mass: 80 g, installed: 35 mm, stem_height: 38 mm, stiffness: 30 N/mm, free_length: 45 mm,
        seat_stiffness: {contact}, seat_damping: 2 kN*s/m)
    part train = {class}(ball, cam.main, valve.valve.stem, shape: finger,
        cam_side: RollerCam(base: 24 mm, roller_radius: 9 mm, profile: polynomial_lift(lift: 5 mm, half: {half} deg), stiffness: {contact},
            damping: 2 kN*s/m),
        tip_stiffness: {contact}, tip_damping: 2 kN*s/m{more})
    cycle angle = rotation(cam.main, axle) {{ period = 360 deg }}
}}
{analysis}
"
    )
}

/// The same train on a fixed ball at a height (mm).
fn fixed(height: f64, contact: &str, half: f64, analysis: &str) -> String {
    let ball = format!("[0, {height}, 0] mm");
    train(&ball, ["RockerArm", ""], contact, half, analysis)
}

/// Results of all points of an analysis of a text.
fn points(text: &str, analysis: &str, count: usize) -> Vec<Results> {
    let program = eng::check(&Sources::from_text("m.eng", text), "m.eng")
        .into_program()
        .unwrap_or_else(|report| panic!("{report}"));
    let point = |k| {
        let analysis = program
            .analysis(&format!("{analysis}[{k}]"))
            .unwrap_or_else(|error| panic!("{error}"));
        analysis
            .run(&mut |_| {})
            .unwrap_or_else(|failed| panic!("{}", failed.error))
            .results
    };
    (1..=count).map(point).collect()
}

/// At rest, with contacts of 1e6 N/µm: lift, load of the cam by the arms of force, and torque of the cam by virtual work.
#[test]
fn a_finger_opens_its_valve_as_its_geometry_says() {
    let analysis = "analysis rest[a in 180 deg .. 540 deg by 10 deg] = static(Train(), at: a)";
    let finger = Finger {
        ball: -0.04e-3,
        half: PI / 3.0,
    };
    let (mut opened, mut worst, mut with_gaps) = (0, 0.0_f64, 0.0_f64);
    let highest = 10.9e-3;
    for results in points(&fixed(-0.04, "1e6 N/um", 60.0, analysis), "rest", 37) {
        let value = |path: &str| last(&results, path);
        let (cam, lift) = (value("cycle.angle"), value("valve.lift"));
        let [gap, tip_gap] = ["train.cam_contact.gap", "train.tip_contact.gap"].map(value);
        if lift < 1e-6 {
            // the lash is not closed
            assert!(finger.lift(cam, 0.0, 0.0) < 1e-6, "{cam}");
            continue;
        }
        opened += 1;
        worst = worst.max((lift - finger.lift(cam, 0.0, 0.0)).abs());
        with_gaps = with_gaps.max((lift - finger.lift(cam, gap, tip_gap)).abs());
        let (cam_arm, valve_arm) = finger.arms(cam, gap);
        let pressed = PRELOAD + SPRING * lift;
        close(
            "load",
            value("train.cam_contact.load"),
            -pressed * valve_arm / cam_arm,
            1e-6,
        );
        close(
            "ratio",
            value("train.lever_ratio"),
            -valve_arm / cam_arm,
            1e-6,
        );
        let slope = (finger.lift(cam + 1e-5, 0.0, 0.0) - finger.lift(cam - 1e-5, 0.0, 0.0)) / 2e-5;
        let torque = value("turn.torque.z");
        assert!(
            (torque - pressed * slope).abs() < 1e-5 * 10.0,
            "{torque} {}",
            pressed * slope
        );
    }
    println!(
        "lift: {:.1e}, with the gaps {:.1e}",
        worst / highest,
        with_gaps / highest
    );
    assert_eq!(opened, 10);
    assert!(worst < 1e-6 * highest, "{worst}");
    assert!(with_gaps < 1e-12 * highest, "{with_gaps}");
}

/// A flat tappet, a rod and a rocker: the lift by the circle of the rod's end about the socket of the tappet.
#[test]
fn a_pushrod_opens_its_valve_as_its_geometry_says() {
    let text = "use std.valvetrain.*
use std.joints.Translational
use std.drives.ConstantSpeed
model Train {
    gravity = [0, 0, 0] m/s^2
    marker shaft = [0, 0, 0] mm
    marker axle = [-26, -210, 0] mm
    marker bore = at([-26, -170, 0] mm, z: [0, 1, 0])
    marker seat = at([36, -62, 0] mm, z: [0, 1, 0])
    body cam { mass = 1 kg; inertia = [0.5, 0.5, 0.5] g*m^2; marker main = at(origin, x: [0, 1, 0], z: [0, 0, 1]) }
    drive turn = ConstantSpeed(cam.main, axle, speed: 1000 rpm, initial: 180 deg)
    body tappet { mass = 60 g; inertia = [20, 20, 20] kg*mm^2; marker face = at(origin, z: [0, 1, 0]); marker socket = [0, 20, 0] mm }
    joint slide = Translational(tappet.face, bore)
    start slide.travel = 0 mm
    force follower = FlatTappet(tappet.face, bore, cam.main, axle, profile: polynomial_lift(lift: 6 mm, half: 60 deg),
        base_radius: 40 mm, face_radius: 16 mm, stiffness: 1e6 N/um)
    const arm = Lever(mass: 90 g, inertia: 40 kg*mm^2, center: [3, 0] mm, cam_side: [-25, -3] mm, tip: [36, -4] mm, tip_radius: 12 mm)
    part valve = Valve(seat, valve_mass: 100 g, installed: 38 mm, stem_height: 45.8 mm, stiffness: 30 N/mm, free_length: 48 mm,
        seat_stiffness: 1e6 N/um)
    part rocker = RockerArm(shaft, tappet.socket, valve.valve.stem, shape: arm,
        cam_side: Pushrod(length: 147 mm, stiffness: 1e6 N/um), tip_stiffness: 1e6 N/um)
    cycle angle = rotation(cam.main, axle) { period = 360 deg }
}
analysis rest[a in 310 deg .. 410 deg by 10 deg] = static(Train(), at: a)";
    let lift_at = |cam: f64| {
        let (lift, _) = polynomial(cam, 0.006, PI / 3.0);
        let socket = [-0.026, -0.150 + lift];
        let miss = |turn: f64| {
            let arm = minus(turned([-0.025, -0.003], turn), socket);
            arm[0].hypot(arm[1]) - 0.147
        };
        let turn = root(&miss, -0.6, 0.4);
        -0.0162 + 0.012 - turned([0.036, -0.004], turn)[1]
    };
    let (mut opened, mut worst) = (0, 0.0_f64);
    for results in points(text, "rest", 11) {
        let (cam, lift) = (last(&results, "cycle.angle"), last(&results, "valve.lift"));
        if lift < 1e-6 {
            continue;
        }
        opened += 1;
        worst = worst.max((lift - lift_at(cam)).abs());
        let slope = (lift_at(cam + 1e-5) - lift_at(cam - 1e-5)) / 2e-5;
        let torque = last(&results, "turn.torque.z");
        let due = (PRELOAD + SPRING * lift) * slope;
        assert!((torque - due).abs() < 1e-6 * 10.0, "{torque} {due}");
    }
    println!("lift: {:.1e}", worst / 8.2e-3);
    assert_eq!(opened, 9);
    assert!(worst < 1e-6 * 8.2e-3, "{worst}");
}

/// On the plunger of a lash adjuster, over two turns: the lift by the geometry at the present place of the ball.
#[test]
fn a_finger_on_an_adjuster_follows_the_place_of_its_ball() {
    let adjuster = ", adjuster: HydraulicLashAdjuster(diameter: 11 mm, gap: 6 um, seal: 8 mm, volume: 0.3 cc, supply: 3 bar,
            viscosity: 10 mPa*s), plunger_mass: 12 g";
    let text = train(
        "at([0, 0, 0] mm, z: [0, 1, 0])",
        ["FingerFollower", adjuster],
        "50 N/um",
        60.0,
        "analysis run = transient(Train(), duration: 2 rev, sample: 1 deg)",
    );
    let results = run(&text, "run");
    let cam = column(&results, "cycle.angle");
    let [lift, ball, gap, tip_gap] = [
        "valve.lift",
        "train.plunger_travel",
        "train.rocker.cam_contact.gap",
        "train.rocker.tip_contact.gap",
    ]
    .map(|path| column(&results, path));
    let mut worst = 0.0_f64;
    for (k, cam) in cam.iter().enumerate() {
        let finger = Finger {
            ball: ball[k],
            half: PI / 3.0,
        };
        worst = worst.max((lift[k] - finger.lift(*cam, gap[k], tip_gap[k])).abs());
    }
    println!("lift: {:.1e}", worst / largest(lift));
    assert!(
        largest(lift) > 10.8e-3 && worst < 1e-9 * largest(lift),
        "{worst}"
    );
    // oil leaves the chamber while the valve is open, and the ball returns with the next base circle
    assert!(largest(column(&results, "train.element.chamber_pressure")) > 60e5);
    assert!(
        (ball[ball.len() - 1] - ball[0]).abs() < 5e-6,
        "{}",
        ball[ball.len() - 1]
    );
}

/// At 300 rpm the load of the cam is that of inverse dynamics. The roller leaves the cam at the speed at which this load falls to zero.
#[test]
fn a_roller_leaves_its_cam_where_inertia_says() {
    let analysis = "analysis run[n in [300, 3200, 3350] rpm] = transient(Train(speed: n), duration: 1 rev, sample: 0.5 deg)";
    let finger = Finger {
        ball: -0.02e-3,
        half: 75.0_f64.to_radians(),
    };
    let least = |rpm: f64| {
        (380..700)
            .map(|k| f64::from(k).to_radians() / 2.0)
            .filter(|cam| finger.lift(*cam, 0.0, 0.0) > 0.5e-3)
            .map(|cam| finger.loads(cam, rpm * TAU / 60.0)[0])
            .fold(f64::MAX, f64::min)
    };
    let jump = root(&least, 2500.0, 4000.0);
    println!("jump: {jump:.0} rpm");
    assert!((3200.0..3350.0).contains(&jump), "{jump}");
    let runs = points(&fixed(-0.02, "200 N/um", 75.0, analysis), "run", 3);
    let opened = |results: &Results| {
        let (lift, gap) = (
            column(results, "valve.lift"),
            column(results, "train.cam_contact.gap"),
        );
        let raised = lift.iter().zip(gap).filter(|(lift, _)| **lift > 0.5e-3);
        raised.fold(f64::MIN, |most, (_, gap)| most.max(*gap))
    };
    let [slow, below, beyond] = &runs[..] else {
        panic!("three runs")
    };
    assert!(opened(below) < 0.0, "{}", opened(below));
    assert!(opened(beyond) > 1e-5, "{}", opened(beyond));
    let mut worst = 0.0_f64;
    for (cam, (lift, load)) in column(slow, "cycle.angle").iter().zip(
        column(slow, "valve.lift")
            .iter()
            .zip(column(slow, "train.cam_contact.load")),
    ) {
        if *lift > 0.5e-3 {
            worst = worst.max((load / finger.loads(*cam, 10.0 * PI)[0] - 1.0).abs());
        }
    }
    println!("load at 300 rpm: {worst:.1e}");
    assert!(worst < 2e-3, "{worst}");
}
