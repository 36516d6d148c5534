//! The quasi-static start of a flexible shaft that turns, through the language: its weight bends it as at rest.

use eng::{Outcome, Program, Sources, StartReport, Turning};
use std::fmt::Write;

const YOUNG: f64 = 2.1e11;
const DENSITY: f64 = 7850.0;
const DIAMETER: f64 = 0.02;
const LENGTH: f64 = 0.4;
const PIECES: u32 = 8;

fn area() -> f64 {
    0.25 * std::f64::consts::PI * DIAMETER * DIAMETER
}

/// Of the section, about an axis across.
fn second_moment() -> f64 {
    std::f64::consts::PI * DIAMETER.powi(4) / 64.0
}

/// A round shaft along z.
fn deck() -> String {
    let (area, moment) = (area(), second_moment());
    let mut deck = format!(
        "BEGIN BULK\nMAT1,1,{YOUNG:e},,0.3,{DENSITY}\nPBAR,1,1,{area:.8e},{moment:.8e},{moment:.8e},{:.8e}\n",
        2.0 * moment
    );
    for node in 0..=PIECES {
        let z = LENGTH * f64::from(node) / f64::from(PIECES);
        writeln!(deck, "GRID,{},,0.,0.,{z:.4}", node + 1).expect("a line");
    }
    for piece in 1..=PIECES {
        writeln!(deck, "CBAR,{piece},1,{piece},{},1.,0.,0.", piece + 1).expect("a line");
    }
    deck + "ENDDATA\n"
}

fn run(speed: f64) -> Outcome {
    let text = format!(
        "use std.joints.{{Spherical, PointOnLine}}
         use std.drives.PrescribedRotation
         model Shaft {{
             gravity = [0, -9.81, 0] m/s^2
             marker left = [0, 0, 0] m
             marker right = [0, 0, {LENGTH}] m
             flexible shaft {{
                 mesh = nastran(\"shaft.bdf\", units: m_kg_s)
                 modes = static(at: [left, right, middle], freedoms: [x, y]) + normal(4)
                 damping = 0 %
                 geometric_stiffness = true
                 marker left = node(1)
                 marker middle = node(5)
                 marker right = node(9)
             }}
             joint fixed_bearing = Spherical(shaft.left, left)
             joint free_bearing = PointOnLine(shaft.right, right)
             drive turn = PrescribedRotation(shaft.left, left, speed: {speed} rad/s)
             output sag: Length = dot(shaft.middle.origin, ground.y)
             output aside: Length = dot(shaft.middle.origin, ground.x)
         }}
         analysis begins = transient(Shaft(), duration: 10 ms, sample: 0.1 ms, start: quasi_static)"
    );
    let sources = Sources::from_texts([
        ("shaft.eng".to_owned(), text),
        ("shaft.bdf".to_owned(), deck()),
    ]);
    let program: Program = eng::check(&sources, "shaft.eng")
        .into_program()
        .unwrap_or_else(|report| panic!("{report}"));
    program
        .analysis("begins")
        .unwrap_or_else(|error| panic!("{error}"))
        .run(&mut |_| {})
        .unwrap_or_else(|failed| panic!("{}", failed.error))
}

fn column<'r>(outcome: &'r Outcome, path: &str) -> &'r [f64] {
    &outcome.results.column(path).expect("a column").values
}

/// At 0.3 to 1.5 times its first frequency the shaft hangs through as at rest, at the start and for the first 10 ms.
#[test]
fn a_shaft_in_bearings_sags_as_at_rest() {
    let stiffness = YOUNG * second_moment();
    let weight = DENSITY * area() * 9.81;
    let beam = 5.0 * weight * LENGTH.powi(4) / (384.0 * stiffness);
    let frequency =
        (std::f64::consts::PI / LENGTH).powi(2) * (stiffness / (DENSITY * area())).sqrt();
    let rest = -column(&run(0.0), "sag")[0];
    println!("at rest {rest:e}, of a beam {beam:e}");
    assert!((rest / beam - 1.0).abs() < 0.02, "{rest:e} {beam:e}");
    for ratio in [0.3, 0.5, 0.8, 1.5] {
        let outcome = run(ratio * frequency);
        let Some(StartReport::QuasiStatic(found)) = &outcome.start else {
            panic!("{ratio}: {:?}", outcome.start);
        };
        assert!(
            matches!(found.turning, Some(Turning::Repeating { change, .. }) if change < 1e-6),
            "{ratio}: {found:?}"
        );
        let (sag, aside) = (column(&outcome, "sag"), column(&outcome, "aside"));
        let off = |y: f64, x: f64| (y + rest).hypot(x) / rest;
        let ringing = sag
            .iter()
            .zip(aside)
            .fold(0.0_f64, |w, (y, x)| w.max(off(*y, *x)));
        println!(
            "Ω/ω {ratio}: off by {:.2e}, in 10 ms {ringing:.2e}",
            off(sag[0], aside[0])
        );
        assert!(
            off(sag[0], aside[0]) < 1e-4,
            "{ratio}: {} {}",
            sag[0],
            aside[0]
        );
        assert!(ringing < 1e-2, "{ratio}: {ringing}");
    }
}
