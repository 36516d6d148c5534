//! A torsional line of two wheels, divided at its coupling into two FMUs by FMI 2.0, against the whole line.
//!
//! The first FMU is a driven wheel, which takes the torque of the coupling. The second has the coupling and a wheel, and takes
//! angle and speed of the first. Both step side by side. Between two communication points each sees held inputs, or straight
//! lines with the slope of the last step. So the error falls with the first or with the second power of the distance of the
//! points.

use crate::importer::Fmu;
use eng::Sources;
use eng_c::fmi::Instance;
use eng_c::fmi::two::*;
use std::ffi::{CString, c_int};

/// Duration (s). The line swings 2.5 times.
const DURATION: f64 = 0.1;

fn line(interpolation: &str) -> String {
    let wheel = |name: &str, inertia: f64| {
        format!(
            "body {name} {{ mass = 5 kg; inertia = [1, 1, 1]*{inertia:?} kg*m^2; marker hub = origin }}
    joint bearing_{name} = Revolute({name}.hub, frame)"
        )
    };
    let (first, second) = (wheel("first", 0.4), wheel("second", 0.1));
    let head = "gravity = [0, 0, 0] m/s^2\n    marker frame = [0, 0, 0] mm";
    let drive = "force drive = Twist(first.hub, frame, torque: 50 N*m)";
    let run = "duration: 100 ms, sample: 1 ms, step: 10 us";
    format!(
        "
use std.forces.TorsionSpring
use std.joints.Revolute
force Twist(a: Marker, b: Marker, torque: Torque) {{ apply torque torque*b.z on a against b }}
force Driven(a: Marker, b: Marker, angle: Angle, speed: AngularVelocity) {{
    let rate = dot(a.angular_velocity - b.angular_velocity, b.z) - speed
    let moment = -(2 kN*m/rad*(rotation(a, b) - angle) + 4 N*m*s/rad*rate)
    apply torque moment*b.z on a against b
    output torque: Torque = moment as N*m
}}
model First {{
    input coupling: Torque = 0 N*m, interpolation: {interpolation}
    {head}
    {first}
    {drive}
    force coupled = Twist(first.hub, frame, torque: coupling)
    output angle = rotation(first.hub, frame)
    output speed = dot(first.hub.angular_velocity, frame.z)
}}
model Second {{
    input driving_angle: Angle = 0 rad, interpolation: {interpolation}
    input driving_speed: AngularVelocity = 0 rad/s, interpolation: {interpolation}
    {head}
    {second}
    force coupled = Driven(second.hub, frame, angle: driving_angle, speed: driving_speed)
    output angle = rotation(second.hub, frame)
}}
model Whole {{
    {head}
    {first}
    {second}
    {drive}
    force coupled = TorsionSpring(second.hub, first.hub, stiffness: 2 kN*m/rad, damping: 4 N*m*s/rad)
    output angle = rotation(second.hub, frame)
}}
analysis first = transient(First(), {run})
analysis second = transient(Second(), {run})
analysis whole = transient(Whole(), {run})
"
    )
}

/// An instance by FMI 2.0.
struct Two {
    instance: *mut Instance,
    fmu: Fmu,
}

impl Drop for Two {
    fn drop(&mut self) {
        // SAFETY: the instance is its own
        unsafe { fmi2FreeInstance(self.instance) }
    }
}

impl Two {
    fn new(fmu: Fmu) -> Two {
        let text = |text: &str| CString::new(text).expect("no zero byte");
        let (name, guid) = (text("one"), text(&fmu.attribute("guid")));
        let resources = text(&format!("file://{}", fmu.resources().display()));
        // SAFETY: all pointers live during the call; without functions the instance tells nothing
        let instance = unsafe {
            fmi2Instantiate(
                name.as_ptr(),
                1,
                guid.as_ptr(),
                resources.as_ptr(),
                std::ptr::null(),
                0,
                0,
            )
        };
        assert!(!instance.is_null());
        let two = Two { instance, fmu };
        two.begin();
        two
    }

    /// Begins the motion.
    fn begin(&self) {
        // SAFETY: the instance lives
        unsafe {
            assert_eq!(fmi2Reset(self.instance), 0);
            assert_eq!(fmi2SetupExperiment(self.instance, 0, 0.0, 0.0, 0, 0.0), 0);
            assert_eq!(fmi2EnterInitializationMode(self.instance), 0);
            assert_eq!(fmi2ExitInitializationMode(self.instance), 0);
        }
    }

    fn get(&self, name: &str) -> f64 {
        let mut value = f64::NAN;
        // SAFETY: the instance and the numbers live
        let status =
            unsafe { fmi2GetReal(self.instance, &self.fmu.reference(name), 1, &mut value) };
        assert_eq!(status, 0);
        value
    }

    /// Sets an input, and its rate if there is one.
    fn set(&self, name: &str, value: f64, rate: Option<f64>) {
        let (reference, order): (u32, c_int) = (self.fmu.reference(name), 1);
        // SAFETY: the instance and the numbers live
        assert_eq!(
            unsafe { fmi2SetReal(self.instance, &reference, 1, &value) },
            0
        );
        if let Some(rate) = rate {
            // SAFETY: as before
            let status =
                unsafe { fmi2SetRealInputDerivatives(self.instance, &reference, 1, &order, &rate) };
            assert_eq!(status, 0);
        }
    }

    fn step(&self, from: f64, length: f64) {
        // SAFETY: the instance lives
        assert_eq!(unsafe { fmi2DoStep(self.instance, from, length, 1) }, 0);
    }
}

/// Angles (rad) of the second wheel every 4 ms, with communication points at a distance (s).
fn divided(first: &Two, second: &Two, linear: bool, distance: f64) -> Vec<f64> {
    first.begin();
    second.begin();
    let steps = (DURATION / distance).round() as usize;
    let every = (4e-3 / distance).round() as usize;
    let (mut before, mut angles) = (None, Vec::new());
    for step in 0..steps {
        let now = [
            first.get("angle"),
            first.get("speed"),
            second.get("coupled.torque"),
        ];
        let rates = before
            .replace(now)
            .filter(|_| linear)
            .map(|before: [f64; 3]| [0, 1, 2].map(|at| (now[at] - before[at]) / distance));
        let rate = |at: usize| rates.map(|rates| rates[at]);
        second.set("driving_angle", now[0], rate(0));
        second.set("driving_speed", now[1], rate(1));
        first.set("coupling", -now[2], rate(2).map(|rate| -rate));
        let from = step as f64 * distance;
        first.step(from, distance);
        second.step(from, distance);
        if (step + 1) % every == 0 {
            angles.push(second.get("angle"));
        }
    }
    angles
}

/// The same angles of the whole line.
fn whole() -> Vec<f64> {
    let sources = Sources::from_text("line.eng", line("hold"));
    let program = eng::check(&sources, "line.eng")
        .into_program()
        .expect("a program");
    let analysis = program.analysis("whole").expect("an analysis");
    let angle = analysis.model().channel("angle").expect("a channel");
    let mut simulation = analysis
        .simulation()
        .expect("steps")
        .start()
        .expect("a start");
    let angles = (1..=25).map(|point| {
        simulation.advance(4e-3 * f64::from(point)).expect("a step");
        simulation.value(angle).expect("a value")
    });
    angles.collect()
}

#[test]
fn a_divided_line_converges_to_the_whole_one() {
    let exact = whole();
    for (interpolation, order) in [("hold", 1.0), ("linear", 2.0)] {
        let part = |name: &str, outputs: &str| {
            let text = line(interpolation);
            let words = ["--fmi", "2", "--analysis", name, "--outputs", outputs];
            Two::new(Fmu::of(
                &format!("divided_{interpolation}_{name}"),
                &text,
                &words,
            ))
        };
        let (first, second) = (
            part("first", "angle,speed"),
            part("second", "angle,coupled.torque"),
        );
        let mut errors: Vec<f64> = Vec::new();
        for distance in [1e-3, 0.5e-3, 0.25e-3, 0.125e-3] {
            let found = divided(&first, &second, interpolation == "linear", distance);
            let largest = found
                .iter()
                .zip(&exact)
                .map(|(a, b)| (a - b).abs())
                .fold(0.0, f64::max);
            let falls = errors
                .last()
                .map_or(f64::NAN, |last| (last / largest).log2());
            println!("{interpolation} {distance:.3e} s: {largest:.3e} rad, order {falls:.2}");
            if !errors.is_empty() {
                assert!(
                    (falls - order).abs() < 0.35,
                    "{interpolation} {distance} s: order {falls}"
                );
            }
            errors.push(largest);
        }
    }
}
