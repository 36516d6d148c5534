//! Newton's third law and the first law of thermodynamics: wrenches balance, work has a source, and heat is never
//! negative.

use super::catalogue::Case;
use super::double::Double;
use super::evaluate::evaluate;
use super::instance::Instance;
use super::states::{Motion, cross, doubles, slope, turned};
use crate::support::{Random, call};
use eng_system::code::Function;

/// Rounding, as a share of the sum of magnitudes of the terms.
const ROUNDING: f64 = 1e-12;

/// The wrench on a marker and the marker's motion.
struct Loaded {
    motion: Motion,
    force: [f64; 3],
    /// Torque in inertial axes.
    torque: [f64; 3],
}

impl Loaded {
    /// Terms of the power: of each component of force and torque.
    fn power(&self) -> [f64; 6] {
        let spin = turned(&self.motion.r, self.motion.w);
        let at = |k: usize| match k {
            0..3 => self.force[k] * self.motion.v[k],
            _ => self.torque[k - 3] * spin[k - 3],
        };
        [0, 1, 2, 3, 4, 5].map(at)
    }
}

fn loaded(instance: &Instance, state: &[f64]) -> Vec<Loaded> {
    let layout = instance.layout;
    let residual = call(
        &*instance.machine,
        Function::Residual,
        state,
        &instance.tables,
    );
    (0..layout.markers)
        .map(|m| {
            let motion = Motion::read(state, layout.marker(m) as usize);
            let at = (layout.rows + 6 * m) as usize;
            Loaded {
                motion,
                force: [0, 1, 2].map(|i| residual[at + i]),
                torque: turned(&motion.r, [3, 4, 5].map(|i| residual[at + i])),
            }
        })
        .collect()
}

fn sum(terms: &[f64]) -> f64 {
    terms.iter().sum()
}

fn magnitude(terms: &[f64]) -> f64 {
    terms.iter().map(|x| x.abs()).sum()
}

/// Sum of forces and of moments about the origin, and the size of each one's terms.
fn resultant(wrenches: &[Loaded]) -> [(f64, f64); 6] {
    let arms: Vec<[f64; 3]> = wrenches
        .iter()
        .map(|w| cross(w.motion.x, w.force))
        .collect();
    // a component of a sum is as exact as the largest of its terms
    let force_size: f64 = wrenches.iter().map(|w| magnitude(&w.force)).sum();
    let moment_size: f64 = wrenches
        .iter()
        .map(|w| magnitude(&w.torque) + magnitude(&w.force) * magnitude(&w.motion.x))
        .sum();
    [0, 1, 2, 3, 4, 5].map(|k| match k {
        0..3 => (wrenches.iter().map(|w| w.force[k]).sum(), force_size),
        _ => {
            let i = k - 3;
            let moments = wrenches.iter().zip(&arms).map(|(w, a)| w.torque[i] + a[i]);
            (moments.sum(), moment_size)
        }
    })
}

/// Puts a's origin on b's.
fn meet(instance: &Instance, state: &mut [f64]) {
    if let Some(Two { a, b }) = Two::of_pair(instance) {
        state.copy_within(b..b + 3, a);
    }
}

/// For reactions and for loads: a wrench on one marker has its opposite on the others. External loads are those that
/// the model states.
#[test]
fn wrenches_balance() {
    for instance in Instance::all() {
        let mut random = Random(67);
        let mut loads = 0;
        for _ in 0..50 {
            let mut state = instance.state(&mut random);
            // equations between origins are written along the ground's axes: their reactions balance where they hold
            if instance
                .rows
                .iter()
                .any(|r| r.starts_with("a.origin == b.origin"))
            {
                meet(&instance, &mut state);
            }
            let wrenches = loaded(&instance, &state);
            let resultant = resultant(&wrenches);
            let load = match instance.case.class {
                "ExternalForce" => {
                    let force = [300.0, -200.0, 90.0];
                    let x = wrenches[0].motion.x;
                    (force, cross(x, force))
                }
                "ExternalTorque" => ([0.0; 3], [30.0, -20.0, 9.0]),
                _ => ([0.0; 3], [0.0; 3]),
            };
            assert_eq!(instance.case.closed, load == ([0.0; 3], [0.0; 3]));
            let load = [load.0, load.1].concat();
            for ((found, size), expected) in resultant.iter().zip(&load) {
                assert!(
                    (found - expected).abs() <= ROUNDING * size,
                    "{}: {found} for {expected}",
                    instance.case.class
                );
            }
            // and the sums are not empty; a freewheel turns freely in some states, and a fan nearly stands
            let loaded = |w: &Loaded| magnitude(&w.force) + magnitude(&w.torque) > 1e-3;
            loads += usize::from(wrenches.iter().any(loaded));
        }
        let class = instance.case.class;
        let least = match class {
            "OneWay" => 10,
            "Propeller" => 40,
            _ if !instance.case.acts() => 0,
            _ => 50,
        };
        assert!(loads >= least, "{class}: {loads}");
    }
}

/// Reactions work only on the motion that the constraints themselves impose: `P = −λᵀ(Φ̇ − Φ_t)`.
#[test]
fn reactions_work_against_the_constraints_alone() {
    for instance in Instance::all() {
        let layout = instance.layout;
        let rows = layout.rows as usize;
        if rows == 0 {
            continue;
        }
        let mut random = Random(71);
        for _ in 0..50 {
            let state = instance.state(&mut random);
            let mut rest = state.clone();
            for marker in 0..layout.markers {
                let at = layout.marker(marker) as usize;
                rest[at + 12..at + 18].fill(0.0);
            }
            let rates = |s: &[f64]| {
                call(&*instance.machine, Function::Velocity, s, &instance.tables)[..rows].to_vec()
            };
            let expected: Vec<f64> = rates(&state)
                .iter()
                .zip(rates(&rest))
                .zip(0..)
                .map(|((moving, still), row)| {
                    -state[layout.multiplier(row) as usize] * (moving - still)
                })
                .collect();
            let terms: Vec<f64> = loaded(&instance, &state)
                .iter()
                .flat_map(Loaded::power)
                .collect();
            let size = magnitude(&terms) + magnitude(&expected);
            assert!(
                (sum(&terms) - sum(&expected)).abs() <= ROUNDING * size,
                "{}: {} {}",
                instance.case.class,
                sum(&terms),
                sum(&expected)
            );
        }
    }
}

type Vector = [Double; 3];

/// A vector along the axes of a marker.
fn local(s: &[Double], at: usize, v: Vector) -> Vector {
    [0, 1, 2].map(|k| (0..3).fold(Double::ZERO, |sum, i| sum + s[at + 3 + 3 * i + k] * v[i]))
}

fn squares(v: Vector) -> Double {
    v[0] * v[0] + v[1] * v[1] + v[2] * v[2]
}

/// Places of the two markers in the inputs, and the arm from b to a.
struct Two {
    a: usize,
    b: usize,
}

impl Two {
    /// The pair of an element that has both.
    fn of_pair(instance: &Instance) -> Option<Two> {
        let at = |path: &str| {
            let k = instance.marker(path)?;
            Some(instance.layout.marker(k as u32) as usize)
        };
        Some(Two {
            a: at("a.m")?,
            b: at("b.m")?,
        })
    }

    fn arm(&self, s: &[Double]) -> Vector {
        [0, 1, 2].map(|i| s[self.a + i] - s[self.b + i])
    }

    fn axis(&self, s: &[Double], marker: usize, axis: usize) -> Vector {
        [0, 1, 2].map(|i| s[marker + 3 + 3 * i + axis])
    }

    /// b_i · a_j.
    fn product(&self, s: &[Double], i: usize, j: usize) -> Double {
        local(s, self.b, self.axis(s, self.a, j))[i]
    }

    fn distance(&self, s: &[Double]) -> Double {
        (squares(self.arm(s)) + 1e-12.into()).sqrt()
    }

    /// Spin of a against b along b's axes.
    fn spin(&self, s: &[f64]) -> [f64; 3] {
        let (a, b) = (Motion::read(s, self.a), Motion::read(s, self.b));
        let (wa, wb) = (turned(&a.r, a.w), turned(&b.r, b.w));
        super::states::turned_back(&b.r, [0, 1, 2].map(|i| wa[i] - wb[i]))
    }
}

fn half(stiffness: f64, square: Double) -> Double {
    square * (0.5 * stiffness).into()
}

/// The energy that an element holds (J), by its own formula with the numbers of the catalogue, up to a constant; for
/// a torsion spring its angle (rad), because only the element counts the turns.
fn energy(case: &Case, two: &Two, s: &[Double], state_at: usize) -> Option<Double> {
    match case.class {
        "LinearSpring" => {
            let stretch = two.distance(s) - 0.08.into();
            Some(half(9e4, stretch * stretch))
        }
        "TorsionSpring" => Some(two.product(s, 1, 0).atan2(two.product(s, 0, 0))),
        "Bushing" => {
            let e = local(s, two.b, two.arm(s));
            let along = half(6e4, e[0] * e[0]) + half(9e4, e[1] * e[1]) + half(14e4, e[2] * e[2]);
            // −trace grows at twice the rate of the turn that the law takes
            let trace = two.product(s, 0, 0) + two.product(s, 1, 1) + two.product(s, 2, 2);
            Some(along - half(800.0, trace))
        }
        "Maxwell" => {
            let stretch = two.distance(s) - s[state_at];
            Some(half(9e4, stretch * stretch))
        }
        _ => None,
    }
}

/// The rate of the energy held, the heat by the element's own formula, and the work done on the markers sum to zero.
#[test]
fn springs_give_back_what_is_not_turned_to_heat() {
    let mut classes = Vec::new();
    for instance in Instance::all() {
        let case = instance.case;
        let Some(two) = Two::of_pair(&instance) else {
            continue;
        };
        let state_at = instance.layout.state(0) as usize;
        let mut random = Random(73);
        // a bushing whose three torsional stiffnesses differ holds no energy at large angles
        if case.arguments.contains("[400, 800, 900]") {
            continue;
        }
        for _ in 0..50 {
            // the angle of a torsion spring is the integral of the spin where the axes are parallel
            let state = if case.class == "TorsionSpring" {
                instance.aligned_state(&mut random)
            } else {
                instance.state(&mut random)
            };
            let start = doubles(&state);
            if energy(case, &two, &start, state_at).is_none() {
                break;
            }
            let markers = instance.layout.markers as usize;
            let residual = call(
                &*instance.machine,
                Function::Residual,
                &state,
                &instance.tables,
            );
            let rates = doubles(&residual[6 * markers..]);
            let rate = slope(1e-10, |t| {
                let later = instance.after(&start, &vec![[0.0; 6]; markers], &rates, t);
                energy(case, &two, &later, state_at).into_iter().collect()
            })[0];
            let output = |name: &str| {
                let index = instance.output(name)?;
                let values = call(
                    &*instance.machine,
                    Function::Outputs,
                    &state,
                    &instance.tables,
                );
                Some(values[index])
            };
            let spin = two.spin(&state);
            let stored = match output("twist") {
                Some(twist) => 700.0 * twist * rate,
                None => rate,
            };
            let heat = match case.class {
                "TorsionSpring" => 3.0 * spin[2] * spin[2],
                "LinearSpring" => {
                    let speed = slope(1e-10, |t| {
                        let later = instance.after(&start, &vec![[0.0; 6]; markers], &rates, t);
                        vec![two.distance(&later)]
                    })[0];
                    400.0 * speed * speed
                }
                "Bushing" => {
                    let v = slope(1e-10, |t| {
                        let later = instance.after(&start, &vec![[0.0; 6]; markers], &rates, t);
                        local(&later, two.b, two.arm(&later)).to_vec()
                    });
                    let squares = [v[0], v[1], v[2], spin[0], spin[1], spin[2]].map(|x| x * x);
                    [300.0, 200.0, 700.0, 3.0, 5.0, 2.0]
                        .iter()
                        .zip(squares)
                        .map(|(c, v)| c * v)
                        .sum()
                }
                // the heat of the damper is the whole power into it
                _ => {
                    let stretch = two.distance(&start).high - state[state_at];
                    (9e4 * stretch) * (9e4 * stretch) / 400.0
                }
            };
            assert!(heat >= 0.0);
            if let Some(stated) = output("power_loss") {
                assert!(stated >= 0.0 && (stated - heat).abs() <= 1e-9 * heat);
            }
            let terms: Vec<f64> = loaded(&instance, &state)
                .iter()
                .flat_map(Loaded::power)
                .chain([stored, heat])
                .collect();
            assert!(
                sum(&terms).abs() <= ROUNDING * magnitude(&terms),
                "{}: {} of {}",
                case.class,
                sum(&terms),
                magnitude(&terms)
            );
            classes.push(case.class);
        }
    }
    classes.dedup();
    assert_eq!(
        classes,
        ["TorsionSpring", "LinearSpring", "Bushing", "Maxwell"]
    );
}

/// An element that states its heat and its stored energy accounts for its power: that of its wrenches is
/// minus the heat, minus the rate of the energy. The heat is never negative, apart from that of laws whose
/// bristles may give back more than they hold.
#[test]
fn heat_and_stored_energy_account_for_the_power() {
    let mut classes = Vec::new();
    for instance in Instance::all() {
        let (Some(heat_at), Some(energy_at)) = (
            instance.output("power_loss"),
            instance.output("stored_energy"),
        ) else {
            continue;
        };
        let case = instance.case;
        // laws of a geometry that random poses do not have: an axis that the guide meets, a turn of small angles
        if case.class == "FlatTappet" || case.arguments.contains("torsional_stiffness") {
            continue;
        }
        let markers = instance.layout.markers as usize;
        let rows = instance.layout.rows as usize;
        let mut random = Random(97);
        let mut largest = 0.0_f64;
        for _ in 0..50 {
            let state = instance.state(&mut random);
            let value = |which| call(&*instance.machine, which, &state, &instance.tables);
            let heat = value(Function::Outputs)[heat_at];
            let start = doubles(&state);
            let rates = doubles(&value(Function::Residual)[rows + 6 * markers..]);
            let stored = slope(1e-10, |t| {
                let later = instance.after(&start, &vec![[0.0; 6]; markers], &rates, t);
                let outputs = evaluate(&instance.functions.outputs, &later, &instance.tables);
                vec![outputs[energy_at]]
            })[0];
            assert!(
                heat >= 0.0 || case.class == "LuGre",
                "{}: {heat}",
                case.class
            );
            let terms: Vec<f64> = loaded(&instance, &state)
                .iter()
                .flat_map(Loaded::power)
                .chain([stored, heat])
                .collect();
            let (miss, size) = (sum(&terms).abs(), magnitude(&terms));
            assert!(miss <= 1e-10 * size, "{}: {terms:?}", case.class);
            largest = largest.max(if miss > 0.0 { miss / size } else { 0.0 });
        }
        println!("{}: {largest:.1e}", case.class);
        classes.push(case.class);
    }
    classes.dedup();
    assert_eq!(
        classes,
        [
            "HuntCrossley",
            "SphereOnPlane",
            "SphereOnSphere",
            "CylinderOnPlane",
            "EndStop",
            "WayStops",
            "PinInBush",
            "Friction",
            "LuGre",
            "RotationalDamper",
            "RubberRing",
            "ViscousDamper",
            "DualMassFlywheel",
            "Clutch",
            "OneWay",
            "GearMesh",
            "BeltSpan",
            "ElastomerMount",
            "RubberBushing",
            "HydraulicMount",
            "RollerCam",
            "Pushrod",
            "HydraulicLashAdjuster",
            "PlainThrust",
            "TaperLandThrust",
            "Skirt"
        ]
    );
}

/// The heat of a film is the power that the journal takes from pin and shell. It is never negative.
#[test]
// the power of a film on cells is that of its kernel: tests/films.rs
fn films_only_take_energy() {
    let mut classes = Vec::new();
    let films = Instance::all()
        .filter(|i| i.case.kind == "journal" && i.case.acts() && i.layout.answers == 0);
    for instance in films {
        let heat_at = instance.output("power_loss").expect("an output");
        let mut random = Random(79);
        for _ in 0..400 {
            let state = instance.state(&mut random);
            let outputs = call(
                &*instance.machine,
                Function::Outputs,
                &state,
                &instance.tables,
            );
            let heat = outputs[heat_at];
            assert!(heat >= 0.0, "{}: {heat}", instance.case.class);
            let terms: Vec<f64> = loaded(&instance, &state)
                .iter()
                .flat_map(Loaded::power)
                .chain([heat])
                .collect();
            assert!(
                sum(&terms).abs() <= ROUNDING * magnitude(&terms),
                "{}: {} of {}",
                instance.case.class,
                sum(&terms),
                magnitude(&terms)
            );
        }
        classes.push(instance.case.class);
    }
    assert_eq!(classes, ["Short", "Impedance", "Reynolds"]);
}

/// Gas, actuator and motor work on the motion along their load: the travel along b.z, seen from b, or the spin about
/// it.
#[test]
fn thrusts_work_along_their_travel() {
    let mut classes = Vec::new();
    for instance in Instance::all() {
        let (name, sign, turns) = match instance.case.class {
            "GasPressure" => ("thrust", -1.0, false),
            "Actuator" => ("load", 1.0, false),
            "Motor" => ("load", 1.0, true),
            _ => continue,
        };
        let Some(two) = Two::of_pair(&instance) else {
            panic!("two markers")
        };
        let thrust_at = instance.output(name).expect("an output");
        let mut random = Random(83);
        for _ in 0..50 {
            let state = instance.state(&mut random);
            let outputs = call(
                &*instance.machine,
                Function::Outputs,
                &state,
                &instance.tables,
            );
            let start = doubles(&state);
            let markers = instance.layout.markers as usize;
            let travel = slope(1e-10, |t| {
                let later = instance.after(&start, &vec![[0.0; 6]; markers], &[], t);
                vec![local(&later, two.b, two.arm(&later))[2]]
            })[0];
            let speed = if turns { two.spin(&state)[2] } else { travel };
            let work = sign * outputs[thrust_at] * speed;
            let terms: Vec<f64> = loaded(&instance, &state)
                .iter()
                .flat_map(Loaded::power)
                .chain([-work])
                .collect();
            assert!(
                sum(&terms).abs() <= ROUNDING * magnitude(&terms),
                "{}: {} of {}",
                instance.case.class,
                sum(&terms),
                magnitude(&terms)
            );
        }
        classes.push(instance.case.class);
    }
    assert_eq!(classes, ["GasPressure", "Actuator", "Motor"]);
}
