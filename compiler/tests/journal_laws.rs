//! The film laws of `stdlib/journals.eng` against closed forms, tables and the balance of the pair.

use eng_compiler::elaborate::{analyses, elaborate};
use eng_compiler::generate::compile_class;
use eng_compiler::library::LIBRARY;
use eng_compiler::resolve::resolve;
use eng_grammar::{Diagnostics, SourceMap};
use eng_system::code::{BindCode, ElementCode, Function, Pair};
use eng_system::host::{Host, HostError};
use eng_system::layout::InputLayout;
use eng_system::table::Table;
use serde_json::Value;
use std::f64::consts::PI;
use std::sync::Arc;

struct Text(String);

impl Host for Text {
    fn read_text(&self, path: &str) -> Result<String, HostError> {
        (path == "pair.eng")
            .then(|| self.0.clone())
            .ok_or_else(|| HostError::NotFound(path.into()))
    }
}

const DIAMETER: f64 = 0.054;
const CLEARANCE: f64 = 27e-6;
const VISCOSITY: f64 = 0.0105;

/// A journal with its numbers bound.
struct Law {
    machine: Arc<dyn ElementCode>,
    interpreter: Arc<dyn ElementCode>,
    layout: InputLayout,
    constants: Vec<f64>,
    tables: Vec<Table>,
    names: Vec<String>,
    width: f64,
}

/// Position and motion of a marker that is turned about z by an angle.
#[derive(Clone, Copy, Default)]
struct Motion {
    x: [f64; 3],
    angle: f64,
    v: [f64; 3],
    spin: f64,
}

struct Film {
    /// Force on the pin, inertial axes.
    force: [f64; 3],
    /// Torque about z on the pin and on the shell.
    torque: [f64; 2],
    shell_force: [f64; 3],
}

impl Law {
    fn new(class: &str, slenderness: f64) -> Law {
        Law::with(class, slenderness * DIAMETER, "")
    }

    /// A law with more arguments after those of every film.
    fn with(class: &str, width: f64, more: &str) -> Law {
        let text = format!(
            "use std.journals.{class}
model Pair {{
    gravity = [0, 0, 0] m/s^2
    body pin {{ mass = 1 kg; inertia = [1, 1, 1] kg*m^2 }}
    body shell {{ mass = 1 kg; inertia = [1, 1, 1] kg*m^2 }}
    journal film = {class}(pin: pin.origin, shell: shell.origin, diameter: {DIAMETER} m, width: {width} m,
        radial_clearance: {CLEARANCE} m, viscosity: {VISCOSITY} Pa*s{more})
}}
analysis start = assemble(Pair())"
        );
        let host = Text(text);
        let (mut sources, mut diagnostics) = (SourceMap::new(), Diagnostics::new());
        let program = resolve("pair.eng", &host, LIBRARY, &mut sources, &mut diagnostics);
        let typed = eng_compiler::check::check(program, &sources, &mut diagnostics);
        let plans = analyses(&typed, &mut sources, &host, &mut diagnostics);
        let plan = plans.first().expect("an analysis");
        let made = elaborate(
            &typed,
            &mut sources,
            &host,
            plan.model,
            &plan.constants,
            &mut diagnostics,
        );
        let errors: Vec<_> = diagnostics.iter().filter(|d| d.is_error()).collect();
        assert!(errors.is_empty(), "{errors:#?}");
        let made = made.expect("a system");
        let bound = made
            .bind
            .bind(
                &vec![None; made.system.parameters.len()],
                &made.system.tables,
            )
            .expect("the numbers fit");
        let element = made
            .system
            .elements
            .iter()
            .find(|e| e.origin.path == "film")
            .expect("the journal");
        let class = element.class as usize;
        Law {
            machine: compile_class(&made.classes[class], true).expect("compiles"),
            interpreter: compile_class(&made.classes[class], false).expect("is ready"),
            layout: made.system.classes[class].layout,
            constants: element
                .constants
                .iter()
                .map(|s| bound.slots[s.0 as usize])
                .collect(),
            names: made.system.classes[class]
                .outputs
                .iter()
                .map(|o| o.name.clone())
                .collect(),
            tables: made.system.tables.clone(),
            width,
        }
    }

    fn inputs(&self, pin: Motion, shell: Motion) -> Vec<Pair> {
        let mut inputs = vec![[0.0; 2]; self.layout.outputs_len() as usize];
        for (k, m) in [pin, shell].into_iter().enumerate() {
            let (s, c) = m.angle.sin_cos();
            let numbers = [
                m.x[0], m.x[1], m.x[2], c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0, m.v[0], m.v[1],
                m.v[2], 0.0, 0.0, m.spin,
            ];
            for (i, x) in numbers.into_iter().enumerate() {
                inputs[self.layout.marker(k as u32) as usize + i] = [x; 2];
            }
        }
        for (i, x) in self.constants.iter().enumerate() {
            inputs[self.layout.constant(i as u32) as usize] = [*x; 2];
        }
        inputs
    }

    /// Values by the generated code; the interpreter gives the same bits.
    fn call(&self, function: Function, pin: Motion, shell: Motion) -> Vec<f64> {
        let inputs = self.inputs(pin, shell);
        let of = |code: &dyn ElementCode| {
            let mut out = vec![[f64::NAN; 2]; code.shape(function).1];
            assert!(code.call(function, &inputs, &mut out, &self.tables));
            out
        };
        let (generated, interpreted) = (of(&*self.machine), of(&*self.interpreter));
        for (a, b) in generated.iter().zip(&interpreted) {
            assert_eq!(a.map(f64::to_bits), b.map(f64::to_bits));
        }
        generated.iter().map(|p| p[0]).collect()
    }

    fn film(&self, pin: Motion, shell: Motion) -> Film {
        let out = self.call(Function::Residual, pin, shell);
        assert!(out.iter().all(|x| x.is_finite()));
        let at = |i: usize| out[i];
        Film {
            force: [at(0), at(1), at(2)],
            torque: [at(5), at(11)],
            shell_force: [at(6), at(7), at(8)],
        }
    }

    fn output(&self, name: &str, pin: Motion, shell: Motion) -> f64 {
        let out = self.call(Function::Outputs, pin, shell);
        let index = self
            .names
            .iter()
            .position(|n| n == name)
            .expect("an output of that name");
        out[index]
    }

    /// Force on a pin at a ratio with a squeeze velocity; nothing turns.
    fn squeeze(&self, ratio: [f64; 2], velocity: [f64; 2]) -> [f64; 2] {
        let pin = Motion {
            x: [ratio[0] * CLEARANCE, ratio[1] * CLEARANCE, 0.0],
            v: [velocity[0], velocity[1], 0.0],
            ..Motion::default()
        };
        let film = self.film(pin, Motion::default());
        [film.force[0], film.force[1]]
    }
}

fn polar(r: f64, angle: f64) -> [f64; 2] {
    [r * angle.cos(), r * angle.sin()]
}

fn number(value: &Value) -> f64 {
    value
        .as_f64()
        .or_else(|| value.as_str().and_then(|s| s.parse().ok()))
        .expect("a number")
}

fn reference(text: &str) -> Value {
    serde_json::from_str(text).expect("json")
}

fn impedance_file() -> Value {
    reference(include_str!(
        "../../tests/reference/bearing_impedance_mobility.json"
    ))
}

/// Compares a force with the impedance W and the load's direction, in three orientations of the whole.
fn compare(
    law: &Law,
    ratio: f64,
    eccentricity_from_velocity: f64,
    w: f64,
    load_from_velocity: f64,
) {
    let speed = 4e-3;
    for turned in [0.0, 1.3, -2.4] {
        let force = law.squeeze(
            polar(ratio, turned + eccentricity_from_velocity),
            polar(speed, turned),
        );
        let unit = 2.0 * VISCOSITY * law.width * (DIAMETER / (2.0 * CLEARANCE)).powi(3) * speed;
        let expected = polar(w * unit, turned + load_from_velocity);
        let error = (force[0] + expected[0]).hypot(force[1] + expected[1]) / (w * unit);
        assert!(error < 1e-9, "ratio {ratio}: {error}");
    }
}

#[test]
fn impedance_meets_the_samples_of_its_formula() {
    let file = impedance_file();
    let samples = file["moes_finite"]["implementation_samples"]
        .as_array()
        .expect("samples");
    assert_eq!(samples.len(), 105);
    let mut law = Law::new("Impedance", 1.0);
    for sample in samples {
        let n: Vec<f64> = (0..5).map(|i| number(&sample[i])).collect();
        if (law.width / DIAMETER - n[0]).abs() > 1e-12 {
            law = Law::new("Impedance", n[0]);
        }
        let alpha = n[2].to_radians();
        compare(&law, n[1], alpha, n[3], alpha - n[4].to_radians());
    }
}

#[test]
fn short_meets_the_exact_pi_film() {
    let file = impedance_file();
    let samples = file["ocvirk_pi_film_exact"]["samples"]
        .as_array()
        .expect("samples");
    assert_eq!(samples.len(), 45);
    for slenderness in [0.25, 0.4] {
        let law = Law::new("Short", slenderness);
        for sample in samples {
            let n: Vec<f64> = (0..4).map(|i| number(&sample[i])).collect();
            let velocity_from_e = n[1].to_radians();
            compare(
                &law,
                n[0],
                -velocity_from_e,
                n[2] * slenderness * slenderness,
                n[3].to_radians() - velocity_from_e,
            );
        }
    }
}

/// Ocvirk's load at steady rotation is the same for any speeds of the two surfaces with the same sum.
#[test]
fn steady_rotation_of_pin_shell_or_both_carries_ocvirks_load() {
    let law = Law::new("Short", 0.25);
    let file = reference(include_str!(
        "../../tests/reference/bearing_short_long_analytic.json"
    ));
    let rows = file["ocvirk"]["rows"].as_array().expect("rows");
    assert_eq!(rows.len(), 11);
    let omega = 400.0;
    for row in rows {
        let ratio = number(&row["eps"]);
        let unit = VISCOSITY * omega * DIAMETER / 2.0 * law.width.powi(3) / CLEARANCE.powi(2);
        let expected = [-number(&row["F_r"]) * unit, number(&row["F_t"]) * unit];
        for (pin_spin, shell_spin) in [
            (omega, 0.0),
            (0.0, omega),
            (0.5 * omega, 0.5 * omega),
            (1.5 * omega, -0.5 * omega),
        ] {
            let pin = Motion {
                x: [ratio * CLEARANCE, 0.0, 0.0],
                spin: pin_spin,
                angle: 0.7,
                ..Motion::default()
            };
            let shell = Motion {
                spin: shell_spin,
                angle: -0.3,
                ..Motion::default()
            };
            let f = law.film(pin, shell).force;
            let error =
                (f[0] - expected[0]).hypot(f[1] - expected[1]) / expected[0].hypot(expected[1]);
            assert!(
                error < 1e-9,
                "ratio {ratio}, speeds {pin_spin} {shell_spin}: {error}"
            );
        }
    }
}

/// Stiffness and damping of the steady film, by differences of the force.
#[test]
fn short_has_the_published_stiffness_and_damping() {
    let law = Law::new("Short", 0.25);
    let file = reference(include_str!(
        "../../tests/reference/bearing_short_coefficients.json"
    ));
    let rows = file["short_bearing_ocvirk"]["rows"]
        .as_array()
        .expect("rows");
    assert!(rows.len() > 5);
    let omega = 400.0;
    for row in rows {
        let (ratio, attitude) = (
            number(&row["eps"]),
            number(&row["attitude_deg"]).to_radians(),
        );
        let place = polar(ratio * CLEARANCE, attitude);
        let at = |dx: [f64; 2], v: [f64; 2]| {
            let pin = Motion {
                x: [place[0] + dx[0], place[1] + dx[1], 0.0],
                v: [v[0], v[1], 0.0],
                spin: omega,
                ..Motion::default()
            };
            law.film(pin, Motion::default()).force
        };
        let rest = at([0.0; 2], [0.0; 2]);
        let load = rest[0].hypot(rest[1]);
        assert!(
            rest[0] < 0.0 && (rest[1] / load).abs() < 1e-9,
            "the load is along x"
        );
        for (axis, letter) in ["x", "y"].into_iter().enumerate() {
            let along = |h: f64| if axis == 0 { [h, 0.0] } else { [0.0, h] };
            let h = 1e-5 * CLEARANCE * (1.0 - ratio) * ratio.min(0.1) * 10.0;
            let hv = h * omega;
            let (up, down) = (at(along(h), [0.0; 2]), at(along(-h), [0.0; 2]));
            let (faster, slower) = (at([0.0; 2], along(hv)), at([0.0; 2], along(-hv)));
            for (row_axis, row_letter) in ["x", "y"].into_iter().enumerate() {
                let k = -(up[row_axis] - down[row_axis]) / (2.0 * h) * CLEARANCE / load;
                let c =
                    -(faster[row_axis] - slower[row_axis]) / (2.0 * hv) * CLEARANCE * omega / load;
                let scale = number(&row["Cxx"]).abs();
                for (found, name) in [(k, "K"), (c, "C")] {
                    let expected = number(&row[format!("{name}{row_letter}{letter}")]);
                    assert!(
                        (found - expected).abs() < 2e-6 * scale,
                        "{name}{row_letter}{letter} at {ratio}: {found} {expected}"
                    );
                }
            }
        }
    }
}

/// Reference states of films, with R = c = μ = 1.
fn film_states() -> Value {
    reference(include_str!(
        "../../film/tests/reference/film_reference.json"
    ))
}

/// The speed that is 1 in the reference states, rad/s.
const SPEED: f64 = 400.0;

/// The force of a law at a reference state, in the units of the states. The eccentricity ratio and its rate differ
/// from the state's by these numbers.
fn at_state(law: &Law, state: &Value, more: [[f64; 2]; 2]) -> [f64; 2] {
    let pair = |key: &str, axis: usize| state[key][axis].as_f64().unwrap_or(0.0);
    let at = |axis: usize| CLEARANCE * (pair("eps", axis) + more[0][axis]);
    let rate = |axis: usize| CLEARANCE * SPEED * (pair("eps_rate", axis) + more[1][axis]);
    let pin = Motion {
        x: [at(0), at(1), 0.0],
        v: [rate(0), rate(1), 0.0],
        spin: 2.0 * number(&state["mean_surface_speed"]) * SPEED,
        ..Motion::default()
    };
    let unit = VISCOSITY * SPEED * (DIAMETER / 2.0).powi(4) / CLEARANCE.powi(2);
    let force = law.film(pin, Motion::default()).force;
    [force[0] / unit, force[1] / unit]
}

/// Forces of the plain, aligned films of an independent solver.
#[test]
fn reynolds_meets_the_states_of_another_solver() {
    let file = film_states();
    let (mut states, mut worst) = (0, 0.0_f64);
    for state in file["static"].as_array().expect("states") {
        let still = |key: &str| (0..2).all(|axis| number(&state[key][axis]) == 0.0);
        let plain = state["zero_line_deg"].is_null()
            && state["grooves"].as_array().is_some_and(Vec::is_empty)
            && still("tilt")
            && still("tilt_rate");
        if !plain || state["rule"] != "reynolds" {
            continue;
        }
        states += 1;
        let law = Law::new("Reynolds", number(&state["width_over_diameter"]));
        let found = at_state(&law, state, [[0.0; 2]; 2]);
        let expected = ["fx", "fy"].map(|key| number(&state["value"][key]));
        let error =
            (found[0] - expected[0]).hypot(found[1] - expected[1]) / expected[0].hypot(expected[1]);
        worst = worst.max(error);
        assert!(error < 2e-3, "{}: {error:.1e}", state["id"]);
    }
    println!("{states} states: {worst:.1e} at worst");
    assert_eq!(states, 27);
}

/// Stiffness and damping by differences of the law. Deviations from those of the other solver count beyond their
/// uncertainty.
#[test]
fn reynolds_has_stiffness_and_damping_of_another_solver() {
    let file = film_states();
    let (mut rows, mut worst) = (0, 0.0_f64);
    for row in file["coefficients"]["rows"].as_array().expect("rows") {
        if row["rule"] != "reynolds" || !row["grooves"].as_array().is_some_and(Vec::is_empty) {
            continue;
        }
        rows += 1;
        let law = Law::new("Reynolds", number(&row["width_over_diameter"]));
        for (kind, letter) in ["K", "C"].into_iter().enumerate() {
            let value = |of: &str, key: &str| number(&row[of][format!("{letter}_{key}")]);
            let size = ["xx", "xy", "yx", "yy"]
                .map(|key| value("value", key).abs())
                .into_iter()
                .fold(0.0, f64::max);
            for (column, along) in ["x", "y"].into_iter().enumerate() {
                let moved = |step: f64| {
                    let mut more = [[0.0; 2]; 2];
                    more[kind][column] = step;
                    at_state(&law, row, more)
                };
                let (up, down) = (moved(1e-5), moved(-1e-5));
                for (line, of) in ["x", "y"].into_iter().enumerate() {
                    let found = -(up[line] - down[line]) / 2e-5;
                    let key = format!("{of}{along}");
                    let error = (found - value("value", &key)).abs() - value("uncertainty", &key);
                    worst = worst.max(error / size);
                    assert!(error < 5e-3 * size, "{letter}_{key}: {found}");
                }
            }
        }
    }
    println!("{rows} films: {worst:.1e} of the largest entry beyond the uncertainty");
    assert!(rows > 1);
}

/// Between the points of its table the law is the solved film: 0.1 % rms and 0.5 % at worst, for ratios to 0.99 and
/// B/D 0.1 to 1.5.
#[test]
fn reynolds_is_the_solved_film_between_the_points_of_its_table() {
    let mut random = Random(19);
    let (mut worst, mut squares, mut count) = (0.0_f64, 0.0, 0.0);
    for _ in 0..10 {
        let slenderness = 0.8 + 0.7 * random.next();
        let law = Law::new("Reynolds", slenderness);
        for _ in 0..15 {
            let ratio = 1.0 - (-2.3 * (1.0 + random.next())).exp();
            let angle = PI * random.next();
            let cosine = angle.cos();
            let [along, across] =
                eng_film::impedance::solved_response(slenderness, ratio, cosine).expect("a film");
            // a mirrored film has the same response, except for the sign across; e is at `angle` from v_s
            let side = -angle.signum();
            let speed = 4e-3;
            let force = law.squeeze(polar(ratio, angle), [speed, 0.0]);
            let unit =
                -2.0 * VISCOSITY * law.width * (DIAMETER / (2.0 * CLEARANCE)).powi(3) * speed;
            let found = [force[0] / unit, force[1] / unit];
            let error = (found[0] - along).hypot(found[1] + side * across) / along.hypot(across);
            worst = worst.max(error);
            squares += error * error;
            count += 1.0;
            assert!(
                error < 5e-3,
                "B/D {slenderness}, {ratio} at {angle}: {error:.1e}"
            );
        }
    }
    let rms = (squares / count).sqrt();
    println!("{rms:.1e} rms, {worst:.1e} at worst");
    assert!(rms < 1e-3);
}

/// A ring groove leaves two bearings of one land each, with the friction of their width.
#[test]
fn a_ring_groove_makes_two_bearings() {
    let (width, land) = (0.028, 0.012);
    let whole = Law::with("Reynolds", width, ", ring_groove: 4 mm");
    let half = Law::with("Reynolds", land, "");
    let pin = Motion {
        x: [0.5 * CLEARANCE, -0.6 * CLEARANCE, 0.0],
        v: [3e-3, -1e-3, 0.0],
        spin: SPEED,
        ..Motion::default()
    };
    let (whole, half) = (
        whole.film(pin, Motion::default()),
        half.film(pin, Motion::default()),
    );
    for axis in 0..2 {
        let (found, twice) = (whole.force[axis], 2.0 * half.force[axis]);
        assert!(
            (found - twice).abs() < 1e-9 * twice.abs(),
            "{found} {twice}"
        );
    }
    let (found, twice) = (whole.torque[0], 2.0 * half.torque[0]);
    assert!(
        (found - twice).abs() < 1e-9 * twice.abs(),
        "{found} {twice}"
    );
}

/// A pin that whirls at the mean speed of the surfaces does not squeeze the film.
#[test]
fn free_whirl_at_the_mean_speed_carries_nothing() {
    for class in ["Short", "Impedance", "Reynolds"] {
        let law = Law::new(class, 0.37);
        let omega = 400.0;
        let e = 0.6 * CLEARANCE;
        let pin = Motion {
            x: [0.0, e, 0.0],
            v: [-e * omega / 2.0, 0.0, 0.0],
            spin: omega,
            ..Motion::default()
        };
        let whirling = law.film(pin, Motion::default()).force;
        let still = law
            .film(Motion { v: [0.0; 3], ..pin }, Motion::default())
            .force;
        assert!(whirling[0].hypot(whirling[1]) < 1e-9 * still[0].hypot(still[1]));
    }
}

/// Numbers in [-1, 1) without a dependency: a linear congruential generator (Knuth's MMIX).
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

/// Action and reaction, angular momentum of the pair, and heat that is never negative, in random motion; also
/// for iterates beyond the clearance.
#[test]
fn the_pair_balances_and_only_takes_energy() {
    let mut random = Random(7);
    for (class, slenderness) in [
        ("Short", 0.25),
        ("Impedance", 0.37),
        ("Impedance", 1.0),
        ("Reynolds", 0.37),
    ] {
        let law = Law::new(class, slenderness);
        for case in 0..500 {
            let reach = if case % 10 == 0 { 1.5 } else { 0.69 };
            let place = [random.next(), random.next()];
            let pin = Motion {
                x: [
                    0.1 + place[0] * reach * CLEARANCE,
                    0.2 + place[1] * reach * CLEARANCE,
                    0.3,
                ],
                angle: 3.0 * random.next(),
                v: [0.02 * random.next(), 0.02 * random.next(), 0.0],
                spin: 500.0 * random.next(),
            };
            let shell = Motion {
                x: [0.1, 0.2, 0.3],
                angle: 3.0 * random.next(),
                v: [0.02 * random.next(), 0.02 * random.next(), 0.0],
                spin: 500.0 * random.next(),
            };
            let film = law.film(pin, shell);
            let f = film.force;
            let size = f[0].hypot(f[1]);
            for (on_pin, on_shell) in f.iter().zip(&film.shell_force) {
                assert!((on_pin + on_shell).abs() <= 1e-12 * size);
            }
            // the reaction acts at the pin's place: seen at the shell's origin it has the moment of that arm
            let e = [pin.x[0] - shell.x[0], pin.x[1] - shell.x[1]];
            let about_shell = film.torque[0] + film.torque[1] + e[0] * f[1] - e[1] * f[0];
            assert!(
                about_shell.abs() <= 1e-9 * (size * CLEARANCE + film.torque[0].abs()),
                "{about_shell}"
            );
            let power = f[0] * pin.v[0]
                + f[1] * pin.v[1]
                + film.shell_force[0] * shell.v[0]
                + film.shell_force[1] * shell.v[1]
                + film.torque[0] * pin.spin
                + film.torque[1] * shell.spin;
            let heat = law.output("power_loss", pin, shell);
            assert!(heat >= 0.0, "{class}: {heat}");
            assert!(
                (power + heat).abs() <= 1e-9 * (heat + size * 1e-3),
                "{class}: {power} {heat}"
            );
        }
    }
}

/// At the centre the law is one damper for all directions, reached from every side.
#[test]
fn the_centre_is_smooth() {
    for (class, slenderness) in [("Short", 0.25), ("Impedance", 0.37), ("Reynolds", 0.37)] {
        let law = Law::new(class, slenderness);
        let centre = law.squeeze([0.0; 2], [3e-3, 1e-3]);
        assert!((centre[0] - 3.0 * centre[1]).abs() < 1e-12 * centre[0].abs());
        for k in 0..12 {
            let near = law.squeeze(polar(1e-10, f64::from(k) * PI / 6.0), [3e-3, 1e-3]);
            let jump = (near[0] - centre[0]).hypot(near[1] - centre[1]);
            assert!(jump < 1e-8 * centre[0].abs(), "{class}: {jump}");
        }
        // and at rest there is no force
        assert_eq!(law.squeeze([0.3, 0.2], [0.0; 2]), [0.0; 2]);
    }
}
