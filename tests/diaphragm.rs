//! A bearing with a thin diaphragm in its wall: N. O. Freund, A thermo-elasto-hydrodynamic study of journal bearings, thesis,
//! University of Wollongong, 1995, tables 6 and 7, figure 46b; numbers of the curves as in test 10 of `mbdyn_post_ehd_load_output` of
//! github.com/octave-user/mboct-mbdyn-pkg. The pin stands at an eccentricity ratio of 0.3 and turns.

use super::films::maps_of;
use eng::Sources;
use eng_report::figure::FilmPanel;
use std::collections::BTreeMap;
use std::f64::consts::{PI, TAU};
use std::fmt::Write;

const TEXT: &str = "use std.journals.{Film, axial_groove}
use std.joints.Revolute
use std.drives.PrescribedRotation
model Diaphragm {
    gravity = [0, 0, 0] m/s^2
    const waves: Int = 8
    marker seat = [-45, 0, 0] um
    flexible shell {
        mesh = calculix(\"diaphragm.inp\", units: m_kg_s)
        support = outside
        modes = static(at: bore, freedoms: [x, y, z, rx, ry, rz]) + normal(6)
        damping = 5 %
        marker bore = ring(center: [0, 0, 0] mm, axis: z, radius: 100 mm, width: 200 mm,
                           surface: fourier(waves_around: waves, degree_across: 8))
        marker outside = set(\"OUTSIDE\", tie: rigid)
    }
    body rotor {
        mass = 2 kg
        inertia = [1, 1, 1] g*m^2
        marker mid = origin
        start angular_velocity = [0, 0, 280.4] rad/s
    }
    joint hold = Revolute(rotor.mid, seat)
    drive turn = PrescribedRotation(rotor.mid, seat, speed: 280.4 rad/s)
    journal main = Film(rotor.mid, shell.bore, diameter: 200 mm, width: 200 mm, radial_clearance: 150 um, viscosity: 9.29 mPa*s,
        openings: [axial_groove(at: 0 deg, length: 220 mm, width: 1 mm, diameter: 200 mm, pressure: 0 bar)],
        cavitation: mass_conserving, around: 72, across: 17)
    cycle angle = rotation(rotor.mid, seat) { period = 360 deg }
}
analysis run = transient(Diaphragm(), duration: 1 deg, sample: 1 deg)
report maps {
    figure pressed = film(run.main, pressure, at: 1 deg)
    figure gap = film(run.main, gap, at: 1 deg)
}
";

/// Pressure at mid width (°, kPa) and outward deflection there (°, µm).
const PRESSURE: [(f64, f64); 21] = [
    (0.0, 0.0),
    (10.0, 100.0),
    (20.0, 200.0),
    (30.0, 300.0),
    (40.0, 375.0),
    (50.0, 425.0),
    (60.0, 525.0),
    (70.0, 650.0),
    (80.0, 750.0),
    (90.0, 875.0),
    (100.0, 975.0),
    (110.0, 1100.0),
    (120.0, 1175.0),
    (130.0, 1175.0),
    (140.0, 1050.0),
    (150.0, 925.0),
    (160.0, 700.0),
    (170.0, 450.0),
    (180.0, 200.0),
    (190.0, 50.0),
    (200.0, 0.0),
];
const DEFLECTION: [(f64, f64); 14] = [
    (0.0, 195.0),
    (10.0, 122.0),
    (20.0, 65.0),
    (30.0, 28.0),
    (40.0, 18.0),
    (50.0, 20.0),
    (60.0, 30.0),
    (70.0, 40.0),
    (80.0, 48.0),
    (90.0, 50.0),
    (100.0, 60.0),
    (110.0, 45.0),
    (120.0, 30.0),
    (130.0, 0.0),
];

/// Elements around: on the diaphragm and on the rest.
const AROUND: [usize; 2] = [16, 18];
/// Elements across: beside the diaphragm, on it, beside it.
const ACROSS: [usize; 3] = [2, 8, 2];
/// Elements of the wall: the diaphragm of 1 mm, and the rest.
const RADII: [f64; 3] = [0.1, 0.101, 0.1495];
/// Half of the slot at which the diaphragm begins, and its length (rad).
const SLOT: f64 = 0.5e-3 / 0.1;
const LENGTH: f64 = 132.0 * PI / 180.0;

/// Edges of the elements around. The slot is the first element.
fn angles() -> Vec<f64> {
    let [plate, rest] = AROUND;
    let end = SLOT + LENGTH;
    let on_plate = (1..=plate).map(|k| SLOT + LENGTH * k as f64 / plate as f64);
    let beside = (1..=rest).map(|k| end + (TAU - SLOT - end) * k as f64 / rest as f64);
    [-SLOT, SLOT]
        .into_iter()
        .chain(on_plate)
        .chain(beside)
        .collect()
}

/// Edges of the elements across at an angle: the sides of the diaphragm come together from 128 to 15 mm, and go apart on the rest.
fn heights(angle: f64) -> Vec<f64> {
    let (wide, narrow) = (0.064, 0.0075);
    let end = SLOT + LENGTH;
    let share = if angle <= end {
        (angle - SLOT).max(0.0) / LENGTH
    } else {
        (TAU - SLOT - angle) / (TAU - SLOT - end)
    };
    let half = wide + (narrow - wide) * share;
    let ends = [-0.1, -half, half, 0.1];
    let parts = ACROSS.iter().zip(ends.windows(2));
    let lines = parts.flat_map(|(count, ends)| {
        let (from, to) = (ends[0], ends[1]);
        (0..*count).map(move |k| from + (to - from) * k as f64 / *count as f64)
    });
    lines.chain([0.1]).collect()
}

/// A line of nodes: edges of elements, and their middles.
fn between(edges: &[f64], at: usize) -> f64 {
    let edge = edges[at / 2];
    if at.is_multiple_of(2) {
        edge
    } else {
        0.5 * (edge + edges[at / 2 + 1])
    }
}

/// A steel ring of 20-node hexahedra. The wall behind the diaphragm and the slot at its wide end are empty; the outside is held.
fn mesh() -> String {
    let edges = angles();
    let around = edges.len() - 1;
    let corners = [(0, 0), (0, 2), (2, 2), (2, 0)];
    let middles = [(0, 1), (1, 2), (2, 1), (1, 0)];
    let levels = [
        (corners, 0),
        (corners, 2),
        (middles, 0),
        (middles, 2),
        (corners, 1),
    ];
    let number = |[i, j, k]: [usize; 3]| 1 + i + 2 * around * (j + 5 * k);
    let (mut nodes, mut elements) = (BTreeMap::new(), String::new());
    let mut count = 0;
    for k in 0..ACROSS.iter().sum() {
        let inside = (ACROSS[0]..ACROSS[0] + ACROSS[1]).contains(&k);
        for (j, i) in (0..2).flat_map(|j| (0..around).map(move |i| (j, i))) {
            if inside && (i == 0 || (j == 1 && i <= AROUND[0])) {
                continue;
            }
            let places = levels.iter().flat_map(|(places, up)| {
                places.map(|(a, b)| [(2 * i + a) % (2 * around), 2 * j + b, 2 * k + up])
            });
            let mut numbers = Vec::new();
            for place in places {
                nodes.insert(number(place), place);
                numbers.push(number(place).to_string());
            }
            count += 1;
            let (first, rest) = numbers.split_at(10);
            writeln!(
                elements,
                "{count}, {},\n{}",
                first.join(", "),
                rest.join(", ")
            )
            .expect("text");
        }
    }
    let (mut text, mut held) = ("*NODE\n".to_owned(), "*NSET, NSET=OUTSIDE\n".to_owned());
    for (number, [i, j, k]) in nodes {
        let (angle, radius) = (between(&edges, i), between(&RADII, j));
        let (x, y, z) = (
            radius * angle.cos(),
            radius * angle.sin(),
            between(&heights(angle), k),
        );
        writeln!(text, "{number}, {x:.9}, {y:.9}, {z:.9}").expect("text");
        if j == 4 {
            writeln!(held, "{number},").expect("text");
        }
    }
    text + "*ELEMENT, TYPE=C3D20, ELSET=ALL\n"
        + &elements
        + &held
        + "*MATERIAL, NAME=STEEL\n*ELASTIC\n2.0e11, 0.3\n*DENSITY\n7850.\n*SOLID SECTION, ELSET=ALL, MATERIAL=STEEL\n"
}

/// A quantity at mid width, linear between the middles of the cells.
fn at_mid_width(panel: &FilmPanel, angle: f64) -> f64 {
    let rows = panel.across.len() - 1;
    let middle = |column: usize| 0.5 * (panel.around[column] + panel.around[column + 1]);
    let columns = panel.around.len() - 1;
    let turned = middle(0) + (angle - middle(0)).rem_euclid(360.0);
    let west = (0..columns)
        .rfind(|column| middle(*column) <= turned)
        .expect("a column");
    let (east, next) = match west + 1 {
        east if east < columns => (east, middle(east)),
        _ => (0, middle(0) + 360.0),
    };
    let share = (turned - middle(west)) / (next - middle(west));
    let value = |column: usize| panel.values[column * rows + rows / 2];
    (1.0 - share) * value(west) + share * value(east)
}

/// Largest and mean distance from a curve, as shares of its highest point. The first points do not count.
fn apart(curve: &[(f64, f64)], skipped: usize, found: &dyn Fn(f64) -> f64) -> [f64; 2] {
    let highest = curve.iter().fold(0.0_f64, |most, point| most.max(point.1));
    let errors = curve
        .iter()
        .skip(skipped)
        .map(|(angle, due)| (found(*angle) - due).abs() / highest);
    let errors: Vec<f64> = errors.collect();
    let sum: f64 = errors.iter().sum();
    [
        errors.iter().copied().fold(0.0, f64::max),
        sum / errors.len() as f64,
    ]
}

/// Distances of pressure and deflection from the published curves.
fn distances(text: &str, mesh: &str) -> [[f64; 2]; 2] {
    let texts = [("m.eng", text), ("diaphragm.inp", mesh)];
    let sources = Sources::from_texts(texts.map(|(name, text)| (name.to_owned(), text.to_owned())));
    let (_, maps) = maps_of(&sources);
    let [pressed, gap] = maps.as_slice() else {
        panic!("{} maps", maps.len());
    };
    let panel = |map: &Result<_, String>| {
        let map: &eng_report::figure::FilmMap =
            map.as_ref().unwrap_or_else(|told| panic!("{told}"));
        map.panels[0].clone()
    };
    let (pressed, gap) = (panel(pressed), panel(gap));
    let pressure = |angle: f64| 1e3 * at_mid_width(&pressed, angle);
    // the pin is 45 µm beside the middle
    let rigid = |angle: f64| 150.0 + 45.0 * angle.to_radians().cos();
    let deflection = |angle: f64| at_mid_width(&gap, angle) - rigid(angle);
    // waves do not follow the step at the slot
    [
        apart(&PRESSURE, 0, &pressure),
        apart(&DEFLECTION, 1, &deflection),
    ]
}

/// The diaphragm yields by more than the clearance, and the highest pressure is half as large again as in a rigid bore.
#[test]
fn pressure_on_freunds_diaphragm() {
    let mesh = mesh();
    let [pressure, deflection] = distances(TEXT, &mesh);
    println!("pressure {pressure:.3?}, deflection {deflection:.3?}");
    assert!(
        pressure[0] < 0.12 && pressure[1] < 0.04,
        "pressure {pressure:?}"
    );
    assert!(
        deflection[0] < 0.11 && deflection[1] < 0.06,
        "deflection {deflection:?}"
    );
    let rigid = TEXT.replace("waves: Int = 8", "waves: Int = 0");
    let [rigid, _] = distances(&rigid, &mesh);
    assert!(rigid[0] > 0.3 && rigid[1] > 0.1, "rigid {rigid:?}");
}
