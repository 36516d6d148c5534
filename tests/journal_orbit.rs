//! The orbit of a loaded pin in a short bearing over a four-stroke cycle, against its recomputed orbit.

use eng::{Results, Sources};
use serde_json::Value;
use std::f64::consts::PI;
use std::fmt::Write;

fn numbers(value: &Value) -> Vec<f64> {
    let list = value.as_array().expect("a list").iter();
    list.map(|n| n.as_f64().expect("a number")).collect()
}

/// Bearing and load history of the reference (SI).
struct Case {
    viscosity: f64,
    width: f64,
    radius: f64,
    clearance: f64,
    /// Speed of the pin (rad/s).
    speed: f64,
    /// Cycle angle (°) and load along x (N), from before 0 to beyond 720.
    points: Vec<(f64, f64)>,
}

impl Case {
    fn new(reference: &Value) -> Case {
        let get = |key: &str| reference["bearing"][key].as_f64().expect("a number");
        let angles = numbers(&reference["load_deg"]);
        let loads = numbers(&reference["load_N"]);
        let given: Vec<(f64, f64)> = angles.into_iter().zip(loads).collect();
        let last = given[given.len() - 1];
        let before = std::iter::once((last.0 - 720.0, last.1));
        let after = given[..2].iter().map(|p| (p.0 + 720.0, p.1));
        Case {
            viscosity: get("mu_Pa_s"),
            width: get("L_m"),
            radius: 0.5 * get("D_m"),
            clearance: get("c_m"),
            speed: get("rpm") * std::f64::consts::TAU / 60.0,
            points: before.chain(given.iter().copied()).chain(after).collect(),
        }
    }

    /// The load on straight lines between the points (N).
    fn load(&self, angle: f64) -> f64 {
        let next = self.points.partition_point(|p| p.0 < angle).max(1);
        let ((a, x), (b, y)) = (self.points[next - 1], self.points[next]);
        x + (y - x) * (angle - a) / (b - a)
    }

    /// Every degree and every point, as a table.
    fn table(&self) -> String {
        let inner = &self.points[1..self.points.len() - 2];
        let mut at: Vec<f64> = (0..720).map(f64::from).collect();
        at.retain(|angle| inner.iter().all(|p| (p.0 - angle).abs() > 0.3));
        at.extend(inner.iter().map(|p| p.0).filter(|angle| *angle >= 0.0));
        at.sort_by(f64::total_cmp);
        let mut text = "theta [deg],force [N]\n".to_owned();
        for angle in at {
            writeln!(text, "{angle:?},{:?}", self.load(angle)).expect("text");
        }
        text
    }

    /// Orbit e/c of a pin without mass over the third cycle, every 5°. `mobility(x, y)` gives the velocity
    /// `v_s` along and across the load for e/c along and across it, in units of `|F| c²/(μ R B³)`;
    /// `ė = v_s + ½ ω × e`. Classical Runge–Kutta steps of half a degree.
    fn orbit(&self, mobility: impl Fn(f64, f64) -> [f64; 2]) -> Vec<[f64; 2]> {
        let unit = self.clearance.powi(2) / (self.viscosity * self.radius * self.width.powi(3));
        let rate = |e: [f64; 2], angle: f64| {
            let load = self.load(angle.rem_euclid(720.0));
            let sense = load.signum();
            let [along, across] = mobility(sense * e[0], sense * e[1]);
            let scale = load * unit;
            [
                scale * along - 0.5 * self.speed * e[1],
                scale * across + 0.5 * self.speed * e[0],
            ]
        };
        let step: f64 = 0.5;
        let h = step.to_radians() / self.speed;
        let moved = |e: [f64; 2], k: [f64; 2], h: f64| [e[0] + h * k[0], e[1] + h * k[1]];
        let mut e = [-0.7, -0.4];
        let mut orbit = Vec::new();
        for n in 0..3 * 1440 {
            if n >= 2 * 1440 && n % 10 == 0 {
                orbit.push(e);
            }
            let angle = step * f64::from(n);
            let a = rate(e, angle);
            let b = rate(moved(e, a, 0.5 * h), angle + 0.5 * step);
            let c = rate(moved(e, b, 0.5 * h), angle + 0.5 * step);
            let d = rate(moved(e, c, h), angle + step);
            for i in 0..2 {
                e[i] += h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]);
            }
        }
        orbit
    }
}

/// J. F. Booker's fit of the short bearing (J. Basic Eng. 87 (1965) 537).
fn booker(x: f64, y: f64) -> [f64; 2] {
    [
        2.0 * (1.0 - x).powf(2.5) / PI,
        -8.0 * y * (1.0 - x).powf(1.5) / (PI * PI),
    ]
}

/// Ocvirk's film itself: the direction of `v_s` in which the pressure of the squeezed half, `∝ −ḣ/h³`, has
/// its force along the load, by bisection; integrals by Simpson's rule.
fn film(x: f64, y: f64) -> [f64; 2] {
    let force = |direction: f64| {
        const PARTS: i32 = 400;
        let mut sum = [0.0; 2];
        for k in 0..=PARTS {
            let t = PI * (f64::from(k) / f64::from(PARTS) - 0.5);
            let weight = match k {
                0 | PARTS => 1.0,
                k if k % 2 == 1 => 4.0,
                _ => 2.0,
            };
            let (s, c) = (direction + t).sin_cos();
            let pressure = t.cos() / (1.0 - x * c - y * s).powi(3);
            sum[0] += weight * pressure * c;
            sum[1] += weight * pressure * s;
        }
        sum.map(|s| s * PI / (3.0 * f64::from(PARTS)))
    };
    let (mut low, mut high) = (-0.4999 * PI, 0.4999 * PI);
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        if force(middle)[1] < 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    let direction = 0.5 * (low + high);
    let speed = 1.0 / force(direction)[0];
    [speed * direction.cos(), speed * direction.sin()]
}

fn farthest(a: &[[f64; 2]], b: &[[f64; 2]]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter()
        .zip(b)
        .map(|(a, b)| (a[0] - b[0]).hypot(a[1] - b[1]))
        .fold(0.0, f64::max)
}

#[test]
fn a_loaded_pin_runs_on_the_orbit_of_ocvirks_film() {
    let reference: Value =
        serde_json::from_str(include_str!("reference/bigend_orbit.json")).expect("JSON");
    let case = Case::new(&reference);
    // The figures of the file are those of Booker's fit; they hold our integration to account.
    let published: Vec<[f64; 2]> = reference["results"]["booker"]["orbit"]
        .as_array()
        .expect("a list")
        .iter()
        .take(144)
        .map(|row| {
            let row = numbers(row);
            [row[1], row[2]]
        })
        .collect();
    let fitted = farthest(&case.orbit(booker), &published);
    assert!(fitted < 2e-5, "{fitted} of the clearance off");

    let run = Run::of(&case, "Short", "");
    let apart = farthest(&run.orbit, &case.orbit(film));
    assert!(apart < 1e-3, "{apart} of the clearance off");
    assert!(run.unbalanced < 1.0, "{} N", run.unbalanced);
}

/// The same pin under other laws.
struct Run {
    /// e/c every 5° of the cycle.
    orbit: Vec<[f64; 2]>,
    /// Largest difference of load and force (N), for the force carries the load: the pin has hardly any mass.
    unbalanced: f64,
}

impl Run {
    /// A run with this law, and more of its arguments.
    fn of(case: &Case, law: &str, more: &str) -> Run {
        let text = include_str!("benchmarks/loaded_bearing.eng");
        let text = text
            .replace("Short", law)
            .replace("4.16 mPa*s,", &format!("4.16 mPa*s{more},"));
        let results = steady(case, text);
        let column = |path: &str| results.column(path).expect(path).shown();
        let [along, across, given] = ["film.force.x", "film.force.y", "gas.given"].map(column);
        let missing = |k: usize| (1e3 * along[k] + given[k]).hypot(1e3 * across[k]);
        Run {
            orbit: orbit(&results),
            unbalanced: (0..145).map(missing).fold(0.0, f64::max),
        }
    }
}

/// The periodic results of a text.
fn steady(case: &Case, text: String) -> Results {
    let sources = Sources::from_texts([
        ("bearing.eng".to_owned(), text),
        ("load.csv".to_owned(), case.table()),
    ]);
    let program = match eng::check(&sources, "bearing.eng").into_program() {
        Ok(program) => program,
        Err(report) => panic!("{report}"),
    };
    let outcome = program
        .analysis("steady")
        .expect("an analysis")
        .run(&mut |_| {})
        .unwrap_or_else(|failed| panic!("{}", failed.error));
    assert!(outcome.periodic.is_some_and(|cycle| cycle.repeats));
    assert_eq!(outcome.results.samples(), 145);
    outcome.results
}

/// e/c every 5° of the cycle.
fn orbit(results: &Results) -> Vec<[f64; 2]> {
    let column = |path: &str| results.column(path).expect(path).shown();
    let [x, y] = ["film.eccentricity_ratio.x", "film.eccentricity_ratio.y"].map(column);
    (0..144).map(|k| [x[k], y[k]]).collect()
}

/// The mobility of a bearing of finite width, B/D 0.4 (Childs, Moes & van Leeuwen, J. Lubr. Technol. 99 (1977) 198).
fn moes(x: f64, y: f64) -> [f64; 2] {
    let slenderness: f64 = 0.4;
    let b = (1.0 - x) / slenderness.powi(2);
    let unit = 2.0 * slenderness.powi(2) * 0.150 * (1.0 - x).powf(1.5);
    let across = 3.0 * y * (1.0 + 3.60 * b) / (4.0 * (1.0 - x));
    [unit * (1.0 + 2.12 * b), -unit * across]
}

/// The mobility method integrates the orbit alone. `Mobility` follows its formula and is near the film of `Impedance`,
/// `SolvedMobility` is near the solved film.
#[test]
fn a_pin_with_a_given_load_needs_no_inertia() {
    let reference: Value =
        serde_json::from_str(include_str!("reference/bigend_orbit.json")).expect("JSON");
    let case = Case::new(&reference);
    let given = |law: &str| {
        let text = include_str!("benchmarks/given_load.eng").replace("Mobility", law);
        orbit(&steady(&case, text))
    };
    let formula = given("Mobility");
    let own = farthest(&formula, &case.orbit(moes));
    let film = farthest(&formula, &Run::of(&case, "Impedance", "").orbit);
    let solved = farthest(&given("SolvedMobility"), &solved_orbit());
    println!(
        "formula {own:.1e}, film of Impedance {film:.1e}, solved film {solved:.1e} of the clearance off"
    );
    assert!(own < 1e-3, "{own}");
    assert!(film < 6e-3, "{film}");
    assert!(solved < 2e-3, "{solved}");
}

/// The orbit in the solved film of finite width.
fn solved_orbit() -> Vec<[f64; 2]> {
    let solved: Value =
        serde_json::from_str(include_str!("reference/bigend_orbit_reynolds.json")).expect("JSON");
    let rows = solved["orbit"].as_array().expect("rows");
    rows.iter()
        .map(|row| [0, 1].map(|k| numbers(row)[k]))
        .collect()
}

/// The solved film of finite width, B/D 0.4: thinner than Ocvirk's by a fifth. The table of `Reynolds` has an
/// infinitely fine grid, the cells of `Film` come nearer with the square of their size.
#[test]
fn a_film_of_finite_width_is_thinner() {
    let reference: Value =
        serde_json::from_str(include_str!("reference/bigend_orbit.json")).expect("JSON");
    let case = Case::new(&reference);
    let due = solved_orbit();
    let apart = |law: &str, cells: &str| {
        let run = Run::of(&case, law, cells);
        assert!(run.unbalanced < 1.0, "{law}{cells}: {} N", run.unbalanced);
        let reach = |orbit: &[[f64; 2]]| {
            let ratios = orbit.iter().map(|e| e[0].hypot(e[1]));
            ratios.fold(0.0_f64, f64::max)
        };
        let (reach, due_reach) = (reach(&run.orbit), reach(&due));
        let apart = farthest(&run.orbit, &due);
        println!("{law}{cells}: largest ratio {reach:.4}, {apart:.1e} of the clearance off");
        [apart, (reach - due_reach).abs()]
    };
    assert!(apart("Reynolds", "").iter().all(|error| *error < 1e-3));
    let coarse = apart("Film", ", around: 36, across: 7");
    let fine = apart("Film", ", around: 72, across: 13");
    assert!(fine.iter().all(|error| *error < 1e-3), "{fine:?}");
    assert!(coarse[0] / fine[0] > 3.0, "{coarse:?} {fine:?}");
}
