//! Flexible bodies through the language: a rotating beam of the literature, objectivity, the rigid limit.

use crate::support::{column, outcome, program_of, slender_beam};
use eng::{Program, Results};
use eng_report::signal::{Sampling, Signal, SpectrumOptions, spectrum};
use nalgebra::{Rotation3, Vector3};
use serde_json::Value;
use std::fmt::Write;

fn program(text: String, deck: String) -> Program {
    program_of(&[("m.eng", &text), ("m.bdf", &deck)])
}

fn run(program: &Program, analysis: &str) -> Results {
    outcome(program, analysis).results
}

fn reference() -> Value {
    serde_json::from_str(include_str!("reference/rotating_angled_beam.json")).expect("JSON")
}

fn number(value: &Value) -> f64 {
    value.as_f64().expect("a number")
}

/// Bulk data of the two beams: ten pieces along x, four along y.
fn angled_beam(problem: &Value) -> String {
    let mut deck = String::from("BEGIN BULK\nGRID,1,,0.,0.,0.\n");
    let mut end = [0.0; 3];
    let mut node = 1;
    for (index, (name, axis, pieces)) in [("beam1", 0, 10), ("beam2", 1, 4)].into_iter().enumerate()
    {
        let own = &problem[name];
        let get = |key: &str| number(&own[key]);
        // h lies in the plane of the frame, w along z
        let (h, w) = (get("h"), get("w"));
        let property = index + 1;
        writeln!(
            deck,
            "MAT1,{property},{:e},,{},{}",
            get("E"),
            get("nu"),
            get("rho")
        )
        .expect("a line");
        // I1 bends in the plane of the axis and the orientation z, I2 across it; K: shear factors of a rectangle
        let (area, along_z, in_plane) = (h * w, h * w.powi(3) / 12.0, w * h.powi(3) / 12.0);
        let torsion = 0.1406 * h * h * w * w;
        let number = |x: f64| format!("{x:.8e}");
        writeln!(
            deck,
            "PBAR,{property},{property},{},{},{},{}\n,\n,0.8333333,0.8333333",
            number(area),
            number(along_z),
            number(in_plane),
            number(torsion)
        )
        .expect("lines");
        let start = end[axis];
        for piece in 1..=pieces {
            end[axis] = start + get("l") * f64::from(piece) / f64::from(pieces);
            node += 1;
            writeln!(deck, "GRID,{node},,{:.6},{:.6},0.", end[0], end[1]).expect("a line");
            writeln!(deck, "CBAR,{node},{property},{},{node},0.,0.,1.", node - 1).expect("a line");
        }
    }
    deck + "ENDDATA\n"
}

fn rotating(geometric: bool, speed: f64) -> String {
    format!(
        "use std.joints.Fixed
         use std.drives.ConstantSpeed
         model Rotating {{
             gravity = [0, 0, 0] m/s^2
             body hub {{
                 mass = 1 kg
                 inertia = [1, 1, 1] kg*m^2
                 start position = [0, 0, 0] mm
             }}
             flexible beam {{
                 mesh = nastran(\"m.bdf\", units: m_kg_s)
                 modes = normal(12, fixed: root)
                 damping = 0.1 %
                 geometric_stiffness = {geometric}
                 marker root = node(1)
                 marker tip = node(15)
             }}
             force push = Ring(beam.tip, hub.origin)
             joint clamp = Fixed(beam.root, hub.origin)
             drive turn = ConstantSpeed(hub.origin, ground, speed: {speed} rad/s)
             output across: Length = dot(beam.tip.origin - hub.origin.origin, hub.origin.y)
         }}
         /// A blow of 10 ms, whose spectrum reaches beyond the frequencies sought.
         force Ring(a: Marker, b: Marker) {{
             let push = if time < 10 ms then 1 N else 0 N
             apply force push*b.y on a against b
         }}
         analysis ring = transient(Rotating(), duration: 24 s, sample: 8 ms, step: 2 ms, rho: 0.95, start: assembled)"
    )
}

/// The frequency of the highest line near a wanted one, between lines by the parabola through the logarithms.
fn peak(values: &[f64], step: f64, near: f64) -> f64 {
    let signal = Signal {
        values,
        sampling: Sampling::Time { step },
    };
    let options = SpectrumOptions {
        remove_mean: true,
        ..SpectrumOptions::default()
    };
    let found = spectrum(signal, options).expect("a spectrum");
    let line = |f: f64| (f / found.step).round() as usize;
    let (from, to) = (line(0.85 * near), line(1.15 * near));
    let k = (from..=to)
        .max_by(|a, b| found.amplitudes[*a].total_cmp(&found.amplitudes[*b]))
        .expect("lines");
    let [a, b, c] = [k - 1, k, k + 1].map(|i| found.amplitudes[i].ln());
    found.step * (k as f64 + 0.5 * (a - c) / (a - 2.0 * b + c))
}

/// A bent cantilever is clamped by a joint to a hub at rest, and to one that turns. After a blow across it rings at
/// its published frequencies.
#[test]
fn an_angled_beam_rings_at_the_published_frequencies() {
    let reference = reference();
    let deck = angled_beam(&reference["problem"]);
    for (speed, key) in [(1e-6, "at_0"), (6.0, "at_6_rad_s")] {
        let results = run(&program(rotating(true, speed), deck.clone()), "ring");
        for wanted in reference["frequencies_hz"][key]
            .as_array()
            .expect("frequencies")
        {
            let wanted = number(wanted);
            let found = peak(column(&results, "across"), 8e-3, wanted);
            println!("{speed} rad/s: {found:.4} Hz, published {wanted}");
            assert!(
                (found / wanted - 1.0).abs() < number(&reference["tolerance"]),
                "{found} {wanted}"
            );
        }
    }
}

/// A slender beam of 1 m along x.
const YOUNG: f64 = 70e9;
const DENSITY: f64 = 2700.0;
const SIDE: f64 = 0.01;

/// √(E I/(ρ A L⁴)) of the slender beam (rad/s).
fn unit_frequency() -> f64 {
    (YOUNG / DENSITY / 12.0).sqrt() * SIDE
}

/// A straight cantilever without hub radius, clamped by a joint, that turns λ times the unit frequency: out
/// of the plane of rotation it rings at μ, in it at √(μ² − λ²). μ of the first mode: A. D. Wright, C. E.
/// Smith, R. W. Thresher, J. L. C. Wang, J. Appl. Mech. 49 (1982) 197. Without the joint's force in the
/// stiffness the beam would not stiffen.
#[test]
fn a_clamped_beam_stiffens_with_its_spin() {
    let unit = unit_frequency();
    for (spin, wright) in [(0.0, 3.5160), (2.0, 4.1373), (5.0, 6.4495)] {
        let text = rotating(true, f64::max(spin * unit, 1e-6))
            .replace("node(15)", "node(21)")
            .replace("push*b.y", "push*(b.y + b.z)")
            .replace(
                "output across",
                "output flap: Length = dot(beam.tip.origin - hub.origin.origin, hub.origin.z)
                 output across",
            )
            .replace(
                "duration: 24 s, sample: 8 ms, step: 2 ms",
                "duration: 6 s, sample: 4 ms, step: 0.5 ms",
            );
        let results = run(&program(text, slender_beam(SIDE, YOUNG, DENSITY)), "ring");
        let in_plane = (wright * wright - spin * spin).sqrt();
        for (path, wanted) in [("flap", wright), ("across", in_plane)] {
            let wanted = wanted * unit / std::f64::consts::TAU;
            let found = peak(column(&results, path), 4e-3, wanted);
            println!("λ = {spin}, {path}: {found:.4} Hz, Wright {wanted:.4}");
            assert!((found / wanted - 1.0).abs() < 5e-3, "{found} {wanted}");
        }
    }
}

/// The tip of a cantilever that is bent by a force H and pressed by P: it moves
/// `H L³/(3EI) · 3 (tan u − u)/u³` across, u = L√(P/EI) (S. Timoshenko, J. Gere, Theory of Elastic Stability,
/// 1961, chapter 1), and without P the bend pulls it back by 3δ²/(5L).
#[test]
fn a_pressed_cantilever_bends_more_and_a_bent_one_is_shorter() {
    let settled = |press: f64, push: f64| {
        let text = format!(
            "force Loads(a: Marker, b: Marker) {{
                 apply force {push} N*b.y - {press} N*b.x on a
             }}
             model Held {{
                 gravity = [0, 0, 0] m/s^2
                 marker wall = [0, 0, 0] mm
                 flexible beam {{
                     mesh = nastran(\"m.bdf\", units: m_kg_s)
                     support = root
                     modes = static(at: tip) + normal(6)
                     damping = 70 %
                     geometric_stiffness = true
                     marker root = node(1)
                     marker tip = node(21)
                 }}
                 force loads = Loads(beam.tip, wall)
                 output across: Length = dot(beam.tip.origin - wall.origin, wall.y)
                 output along: Length = dot(beam.tip.origin - wall.origin, wall.x)
             }}
             analysis settle = transient(Held(), duration: 2 s, sample: 0.1 s, step: 1 ms, start: assembled)"
        );
        let results = run(&program(text, slender_beam(SIDE, YOUNG, DENSITY)), "settle");
        ["across", "along"].map(|path| *column(&results, path).last().expect("a sample"))
    };
    let bending = YOUNG * SIDE.powi(4) / 12.0;
    let push = 0.5;
    let [across, along] = settled(0.0, push);
    assert!(
        (across / (push / (3.0 * bending)) - 1.0).abs() < 1e-3,
        "{across}"
    );
    let shorter = 1.0 - along;
    println!("shorter by {shorter:e} m, {:e}", 0.6 * across * across);
    assert!(
        (shorter / (0.6 * across * across) - 1.0).abs() < 2e-3,
        "{shorter:e}"
    );
    let press = 0.5 * std::f64::consts::PI.powi(2) * bending / 4.0;
    let u = (press / bending).sqrt();
    let exact = push / (3.0 * bending) * 3.0 * (u.tan() - u) / u.powi(3);
    let [pressed, _] = settled(press, push);
    println!("pressed: {pressed:e} m across, {exact:e}");
    assert!((pressed / exact - 1.0).abs() < 2e-3, "{pressed} {exact}");
}

/// Two bars on a spring and a soft joint, thrown; `turn` is the rotation of everything, `shift` its displacement (m).
fn pair(turn: Vector3<f64>, shift: Vector3<f64>) -> String {
    let rotation = Rotation3::new(turn);
    let list = |v: Vector3<f64>| format!("[{:.17e}, {:.17e}, {:.17e}]", v.x, v.y, v.z);
    let body = |name: &str, place: Vector3<f64>, velocity: Vector3<f64>, spin: Vector3<f64>| {
        format!(
            "flexible {name} {{
                 mesh = nastran(\"m.bdf\", units: mm_tonne_s)
                 modes = normal(7)
                 damping = 1 %
                 marker tip = patch(center: [0, 0, 200] mm, normal: z, radius: 15 mm)
                 marker foot = patch(center: [0, 0, 0] mm, normal: z, radius: 15 mm)
                 guess rotation = {} rad
                 start position = {} m
                 start velocity = {} m/s
                 start angular_velocity = {} rad/s
             }}",
            list(turn),
            list(rotation * place + shift),
            list(rotation * velocity),
            list(rotation * spin)
        )
    };
    format!(
        "use std.forces.{{LinearSpring, Bushing}}
         model Pair {{
             gravity = [0, 0, 0] m/s^2
             {}
             {}
             force spring = LinearSpring(one.tip, two.foot, stiffness: 2e7 N/m, damping: 100 N*s/m, free_length: 197 mm)
             force mount = Bushing(one.foot, two.tip, stiffness: [1e4, 2e4, 3e4] N/m, damping: [10, 20, 30] N*s/m,
                 torsional_stiffness: [1e3, 2e3, 3e3] N*m/rad, torsional_damping: [0, 0, 0] N*m*s/rad)
             output bend[k in 1..3]: Length = dot(one.tip.origin - one.foot.origin, [one.foot.x, one.foot.y, one.foot.z][k])
             output slope: 1 = dot(two.tip.z, two.foot.x)
         }}
         analysis fly = transient(Pair(), duration: 4 ms, sample: 0.1 ms, step: 10 us, start: assembled)",
        body("one", Vector3::zeros(), Vector3::new(1.0, -2.0, 0.5), Vector3::new(30.0, 40.0, 50.0)),
        body("two", Vector3::new(0.05, 0.02, 0.01), Vector3::new(-3.0, 1.0, 2.0), Vector3::new(-20.0, 10.0, 60.0)),
    )
}

/// The same motion, begun elsewhere and turned: the bars bend the same.
#[test]
fn flexible_bodies_do_not_know_where_they_are() {
    let deck = include_str!("mesh/bar.bdf");
    let here = run(
        &program(pair(Vector3::zeros(), Vector3::zeros()), deck.into()),
        "fly",
    );
    let there = run(
        &program(
            pair(Vector3::new(0.7, -1.1, 0.4), Vector3::new(3.0, -2.0, 5.0)),
            deck.into(),
        ),
        "fly",
    );
    for path in ["bend[1]", "bend[2]", "bend[3]", "slope"] {
        let (a, b) = (column(&here, path), column(&there, path));
        let mean = a.iter().sum::<f64>() / a.len() as f64;
        let swing = a.iter().fold(0.0_f64, |w, x| w.max((x - mean).abs()));
        let worst = a
            .iter()
            .zip(b)
            .fold(0.0_f64, |w, (x, y)| w.max((x - y).abs()));
        println!("{path}: {worst:.1e} of a swing of {swing:.1e}");
        assert!(swing > 1e-7 && a.len() > 30);
        // rounding of places of some metres stands above swings of micrometres
        assert!(worst < 1e-9 * swing + 1e-14, "{path}: {worst:e} {swing:e}");
    }
}

/// A bar a million times as stiff as steel tumbles as the rigid one.
#[test]
fn a_stiff_body_moves_as_the_rigid_one() {
    let start = "start angular_velocity = [300, 40, 500] rad/s
                 start velocity = [1, -2, 0.5] m/s";
    // a box of 20 x 20 x 200 mm
    let mass = 7850.0 * 0.02 * 0.02 * 0.2;
    let (across, along) = (
        mass * (0.2 * 0.2 + 0.02 * 0.02) / 12.0,
        mass * 2.0 * 0.02 * 0.02 / 12.0,
    );
    let text = format!(
        "model Stiff {{
             gravity = [0, 0, 0] m/s^2
             flexible bar {{
                 mesh = nastran(\"m.bdf\", units: mm_tonne_s)
                 modes = normal(7)
                 damping = 1 %
                 marker tip = patch(center: [0, 0, 200] mm, normal: z, radius: 15 mm)
                 {start}
             }}
             output place: Vector<Length> = bar.tip.origin - ground.origin in ground
             output velocity = bar.tip.velocity in ground
         }}
         model Rigid {{
             gravity = [0, 0, 0] m/s^2
             body bar {{
                 mass = {mass:e} kg
                 inertia = [{across:e}, {across:e}, {along:e}] kg*m^2
                 center_of_mass = [0, 0, 100] mm
                 marker tip = [0, 0, 200] mm
                 {start}
             }}
             output velocity = bar.tip.velocity in ground
         }}
         analysis stiff = transient(Stiff(), duration: 20 ms, sample: 1 ms, step: 20 us, start: assembled)
         analysis rigid = transient(Rigid(), duration: 20 ms, sample: 1 ms, step: 20 us, start: assembled)"
    )
    .replace("output place: Vector<Length> = bar.tip.origin - ground.origin in ground\n", "");
    let deck = include_str!("mesh/bar.bdf").to_owned();
    let stiff_deck = deck.replace("210000. ", "2.1+11  ");
    assert_ne!(deck, stiff_deck);
    let compare = |deck: String| {
        let program = program(text.clone(), deck);
        let (stiff, rigid) = (run(&program, "stiff"), run(&program, "rigid"));
        let mut worst = 0.0_f64;
        for axis in ["x", "y", "z"] {
            let path = format!("velocity.{axis}");
            let pairs = column(&stiff, &path).iter().zip(column(&rigid, &path));
            worst = pairs.fold(worst, |w, (a, b)| w.max((a - b).abs()));
        }
        worst
    };
    let (steel, stiff) = (compare(deck), compare(stiff_deck));
    println!(
        "tip's velocity against the rigid bar: steel {steel:.1e} m/s, a million times as stiff {stiff:.1e} m/s of 100"
    );
    assert!(stiff < 1e-5, "{stiff}");
    assert!(steel > 100.0 * stiff);
}
