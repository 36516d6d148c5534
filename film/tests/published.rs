//! Published tables of plain bearings: Butenschön 1976 in rotation and squeezed, Raimondi & Boyd 1958 in
//! rotation. Both put a line p = 0 at the widest gap.

use eng_film::{Cavitation, Feed, Film, FilmSource, Inputs, Lines, Opening, Part};
use serde_json::Value;
use std::f64::consts::PI;

/// A motion of the pin at an eccentricity ratio along −x: its rate along −x, and the spin.
#[derive(Clone, Copy)]
struct Motion {
    ratio: f64,
    rate: f64,
    spin: f64,
}

/// Cells of the half width, with the thinnest place at θ = π.
#[derive(Clone, Copy)]
enum Cells {
    Equal([usize; 2]),
    /// Dense at the thinnest place and at the end, over the length √(2 (1 − ε)) R on which the gap doubles;
    /// half of those around.
    Graded([usize; 2]),
}

/// Lines from 0 to `reach`, spaced as `least sinh`.
fn graded(reach: f64, least: f64, cells: usize) -> Vec<f64> {
    let rate = (reach / least).asinh();
    let line = |at: usize| least * (rate * at as f64 / cells as f64).sinh();
    (0..cells).map(line).chain([reach]).collect()
}

impl Cells {
    fn refined(self) -> Cells {
        match self {
            Cells::Equal(cells) => Cells::Equal(cells.map(|count| 2 * count)),
            Cells::Graded(cells) => Cells::Graded(cells.map(|count| 2 * count)),
        }
    }

    fn of(self, width: f64, ratio: f64) -> [Lines; 2] {
        match self {
            Cells::Equal(cells) => cells.map(Lines::Equal),
            Cells::Graded([around, across]) => {
                let length = (2.0 * (1.0 - ratio)).sqrt();
                let half = graded(PI, length, around);
                let before = half.iter().rev().map(|line| PI - line);
                let behind = half[1..].iter().map(|line| PI + line);
                let end = width / 2.0;
                let from_end = graded(end, length.min(end), across);
                [
                    Lines::At(before.chain(behind).collect()),
                    Lines::At(from_end.iter().rev().map(|line| end - line).collect()),
                ]
            }
        }
    }
}

/// A bearing of R = c = μ = 1: So, attitude (deg), side flow, shear torque, highest pressure over the mean one.
fn solved(slenderness: f64, motion: Motion, cells: Cells) -> [f64; 5] {
    let width = 2.0 * slenderness;
    let mut source = FilmSource::plain(1.0, width, 1.0, Cavitation::Reynolds, [0, 0]);
    [source.around, source.across] = cells.of(width, motion.ratio);
    source.half_width = true;
    // where the pin leaves its wall, the film is at the widest gap
    if motion.rate >= 0.0 {
        source.openings = vec![Opening {
            on: Part::Shell,
            around: [0.0, 0.0],
            across: [-width, width],
            feed: Feed::Pressure,
        }];
    }
    let supply = vec![0.0; source.openings.len()];
    let film = Film::new(source).expect("a film");
    let (mut work, mut y) = (film.work(), vec![0.0; film.outputs()]);
    let x = Inputs {
        eccentricity: [-motion.ratio, 0.0],
        rate: [-motion.rate, 0.0],
        spin: motion.spin,
        supply: &supply,
        ..Inputs::still(1.0)
    };
    film.solve(&x.write(), None, &[], &mut work, &mut y)
        .expect("a solution");
    let summary = film.summary(&work);
    let mean = y[0].hypot(y[1]) / (2.0 * width);
    [
        mean,
        (-y[1]).atan2(y[0]).to_degrees().abs(),
        summary.outflow,
        summary.shear_torque,
        summary.maximum_pressure / mean,
    ]
}

/// The same, extrapolated from these cells and twice as many with second order.
fn extrapolated(slenderness: f64, motion: Motion, cells: Cells) -> [f64; 5] {
    let coarse = solved(slenderness, motion, cells);
    let fine = solved(slenderness, motion, cells.refined());
    [0, 1, 2, 3, 4].map(|at| fine[at] + (fine[at] - coarse[at]) / 3.0)
}

fn table(text: &str) -> Value {
    serde_json::from_str(text).expect("a table")
}

fn at(value: &Value, row: usize) -> &Value {
    &value.as_array().expect("a list")[row]
}

fn number(value: &Value) -> f64 {
    value.as_f64().expect("a number")
}

/// A row of Butenschön's table: B/D, and these quantities there.
fn widths<const N: usize>(all: &Value, row: usize, names: [&str; N]) -> Vec<(f64, [f64; N])> {
    let widths = all["B_over_D"].as_array().expect("a list");
    let entry = |name: &str, column| number(at(at(&all[name], row), column));
    let columns = widths.iter().enumerate();
    columns
        .map(|(column, width)| (number(width), names.map(|name| entry(name, column))))
        .collect()
}

/// Half of the last digit of loads below 10.
const LAST: f64 = 5e-5;

/// Load, attitude and side flow in rotation, eight widths from B/D 1 to 1/8, ε 0.1 to 0.999.
#[test]
fn butenschoen_rotation() {
    let all = table(include_str!("reference/bearing_butenschoen1976.json"));
    let mut worst = [0.0_f64; 3];
    for (row, ratio) in all["eps_rotation"]
        .as_array()
        .expect("a list")
        .iter()
        .enumerate()
    {
        let ratio = number(ratio);
        for (slenderness, [due, angle, conveyed]) in
            widths(&all, row, ["So_rot", "beta_deg", "Q_rot"])
        {
            let motion = Motion {
                ratio,
                rate: 0.0,
                spin: 1.0,
            };
            let [load, attitude, flow, ..] =
                extrapolated(slenderness, motion, Cells::Graded([48, 10]));
            let errors = [
                ((load - due).abs() - LAST) / due,
                (attitude - angle).abs(),
                (flow / conveyed - 1.0).abs(),
            ];
            // three angles are off by 0.09 degrees, their neighbours by 0.03 at most; and this load is too
            // small by another solver, too
            let misprint = slenderness == 0.25 && [0.2, 0.3, 0.97].contains(&ratio);
            let small = slenderness == 1.0 && ratio == 0.99;
            let limits = [
                if small { 6e-3 } else { 5e-3 },
                if misprint { 0.1 } else { 0.03 },
                6e-3,
            ];
            assert!(
                errors
                    .iter()
                    .zip(limits)
                    .all(|(error, limit)| *error < limit),
                "B/D {slenderness}, ratio {ratio}: {errors:.5?}"
            );
            for (worst, error) in worst.iter_mut().zip(errors) {
                *worst = worst.max(error);
            }
        }
    }
    println!(
        "rotation: load {:.1e}, {:.3} deg, flow {:.1e}",
        worst[0], worst[1], worst[2]
    );
}

/// Load and flow out of the ends of a pin that moves towards its wall (positive ratios) or leaves it, ratios
/// to 0.99, eight widths.
#[test]
fn butenschoen_squeeze() {
    let all = table(include_str!("reference/bearing_butenschoen1976.json"));
    // B/D, ratio: a wrong digit, as the neighbours show
    let misprints = [
        (0.5, 0.1),
        (0.5, 0.2),
        (0.4, 0.8),
        (0.4, 0.96),
        (1.0 / 6.0, 0.99),
        (0.125, -0.95),
    ];
    let (mut worst, mut compared) = ([0.0_f64; 2], 0);
    for (row, ratio) in all["eps_squeeze"]
        .as_array()
        .expect("a list")
        .iter()
        .enumerate()
    {
        let ratio = number(ratio);
        for (slenderness, [due, conveyed]) in widths(&all, row, ["So_squeeze", "Q_squeeze"]) {
            let motion = Motion {
                ratio: ratio.abs(),
                rate: if ratio < 0.0 { -1.0 } else { 1.0 },
                spin: 0.0,
            };
            // away from the wall the pressure is highest at the widest gap
            let cells = if ratio > 0.0 {
                Cells::Graded([48, 10])
            } else {
                Cells::Equal([72, 7])
            };
            let [load, angle, flow, ..] = extrapolated(slenderness, motion, cells);
            let along = if ratio < 0.0 { 180.0 } else { 0.0 };
            assert!((angle - along).abs() < 1e-9, "{angle}");
            let errors = [
                ((load - due).abs() - LAST) / due,
                (flow / conveyed - 1.0).abs(),
            ];
            // flows of wide bearings are too small by another solver, too: by 0.8 % at B/D 1/2 and ratio 0.9,
            // 1.8 % at 1 and 0.8
            let limits = [
                if ratio > 0.98 { 8e-3 } else { 5e-3 },
                if slenderness > 0.4 { 0.025 } else { 4e-3 },
            ];
            let wrong = misprints
                .iter()
                .any(|(width, at)| (width - slenderness).abs() < 1e-9 && *at == ratio);
            assert_eq!(
                errors[0] > limits[0],
                wrong,
                "B/D {slenderness}, ratio {ratio}: {errors:.5?}"
            );
            assert!(
                errors[1] < limits[1],
                "B/D {slenderness}, ratio {ratio}: {errors:.5?}"
            );
            worst[1] = worst[1].max(errors[1]);
            if !wrong {
                worst[0] = worst[0].max(errors[0]);
                compared += 1;
            }
        }
    }
    println!(
        "squeeze, {compared} states: load {:.1e}, flow {:.1e}",
        worst[0], worst[1]
    );
    assert_eq!(compared, 226);
}

/// Sommerfeld number, attitude, side flow and highest pressure up to ε 0.9.
#[test]
fn raimondi_and_boyd() {
    let all = table(include_str!(
        "../../tests/reference/bearing_raimondi_boyd1958.json"
    ));
    let (mut worst, mut count) = ([0.0_f64; 4], 0);
    for entry in all["finite"].as_array().expect("entries") {
        let (slenderness, ratio) = (number(&entry["LD"]), number(&entry["eps"]));
        if ratio > 0.9 {
            continue;
        }
        let own = |name: &str| number(&entry["own"][name]);
        let [load, attitude, flow, _, peak] = extrapolated(
            slenderness,
            Motion {
                ratio,
                rate: 0.0,
                spin: 1.0,
            },
            Cells::Equal([144, 14]),
        );
        // N = ω/2π, and the length is 2 L/D
        let sommerfeld = 1.0 / (std::f64::consts::TAU * load);
        let side = flow * std::f64::consts::TAU / (2.0 * slenderness);
        let errors = [
            (sommerfeld / own("S") - 1.0).abs(),
            (attitude - own("phi")).abs(),
            (side / own("Qs_RcNL") - 1.0).abs(),
            (1.0 / peak / own("P_pmax") - 1.0).abs(),
        ];
        assert!(
            errors[0] < 2e-3 && errors[1] < 0.05 && errors[2] < 3e-3 && errors[3] < 5e-3,
            "{slenderness} {ratio}: {errors:.5?}"
        );
        // the printed table has three digits, and some entries are off by more
        let printed = number(&entry["pub"]["S"]);
        assert!(
            (sommerfeld / printed - 1.0).abs() < 0.025,
            "{sommerfeld} {printed}"
        );
        for (worst, error) in worst.iter_mut().zip(errors) {
            *worst = worst.max(error);
        }
        count += 1;
    }
    println!("Raimondi & Boyd, {count} states: {worst:.5?}");
    assert!(count >= 12, "{count}");
}
