//! Shells in NAFEMS' benchmarks (The Standard NAFEMS Benchmarks, Rev. 3, 1990; Selected Benchmarks for Natural
//! Frequency Analysis, R0015).

use crate::fe_meshes::*;
use crate::shell_meshes::*;
use eng_flexible::Mesh;
use eng_flexible::mesh::{Code, Section, ShellSection};
use std::collections::BTreeMap;
use std::f64::consts::FRAC_PI_4;

/// The material of the vibrating plates.
fn plate(
    (form, code): (Form, Code),
    cells: [u32; 2],
    thickness: f64,
    place: impl Fn([f64; 2]) -> [f64; 2],
) -> Mesh {
    let [n, m] = cells.map(f64::from);
    let mut mesh = sheet(form, cells, ShellSection::plate(thickness), |[i, j]| {
        let [x, y] = place([i / n, j / m]);
        [x, y, 0.0]
    });
    mesh.materials[0].young = 200e9;
    mesh.materials[0].density = 8000.0;
    mesh.code = code;
    mesh
}

/// The found frequencies by the published ones, on meshes of rising fineness.
fn compare(
    name: &str,
    published: &[f64],
    tolerance: [f64; 6],
    found: impl Fn((Form, Code), u32) -> Vec<f64>,
) {
    for (kind, tolerance) in RULED.into_iter().zip(tolerance) {
        for cells in [8, 16, 32] {
            let found = found(kind, halved(kind.0, cells));
            let shares: Vec<f64> = found.iter().zip(published).map(|(f, e)| f / e).collect();
            println!("{name} {kind:?} {cells}: {shares:.4?}");
            let worst = shares.iter().map(|x| (x - 1.0).abs()).fold(0.0, f64::max);
            assert!(
                cells < 32 || worst < tolerance,
                "{name} {kind:?}: {shares:?}"
            );
        }
    }
}

/// FV12, a free thin square plate. NAFEMS states 4.233 and 7.416 Hz for the fourth and sixth frequency, upper
/// bounds of a Ritz series; here are the limits of longer series, λ² = ω a² √(ρ t/D) = 34.801 and 61.093.
#[test]
fn a_free_thin_square_plate() {
    let published = [1.622, 2.360, 2.922, 4.190, 4.190, 7.356];
    compare(
        "FV12",
        &published,
        [0.006, 0.006, 0.006, 0.002, 0.002, 0.006],
        |kind, cells| {
            let mesh = plate(kind, [cells; 2], 0.05, |[x, y]| [10.0 * x, 10.0 * y]);
            let flat = held(&nodes_where(&mesh, |_| true), 0b100011);
            lowest(&mesh, &flat, 9)[3..].to_vec()
        },
    );
}

/// FV16, a cantilevered thin square plate. The published numbers are upper bounds of a Ritz series: the limits here are
/// 0.3 to 0.9 % below them.
#[test]
fn a_cantilevered_thin_square_plate() {
    let published = [0.421, 1.029, 2.582, 3.306, 3.753, 6.555];
    compare("FV16", &published, [0.01; 6], |kind, cells| {
        let mesh = plate(kind, [cells; 2], 0.05, |[x, y]| [10.0 * x, 10.0 * y]);
        let mut supports = held(&nodes_where(&mesh, |_| true), 0b100011);
        supports.extend(held(&nodes_where(&mesh, |x| x[0] < 1e-9), 0b111111));
        lowest(&mesh, &supports, 6)
    });
}

/// FV22, a clamped thick rhombic plate of 45°.
#[test]
fn a_clamped_thick_rhombic_plate() {
    let published = [133.95, 201.41, 265.81, 282.74, 334.45];
    compare(
        "FV22",
        &published,
        [0.022, 0.022, 0.022, 0.01, 0.01, 0.022],
        |kind, cells| {
            let lean = FRAC_PI_4.cos();
            let mesh = plate(kind, [cells; 2], 1.0, |[x, y]| {
                [10.0 * (x + lean * y), 10.0 * lean * y]
            });
            let edge = |x: [f64; 3]| {
                let (along, up) = (x[0] - x[1], x[1]);
                let inside = |x: f64, end: f64| (1e-6..=end - 1e-6).contains(&x);
                !inside(along, 10.0) || !inside(up, 10.0 * lean)
            };
            let mut supports = held(&nodes_where(&mesh, |_| true), 0b100011);
            supports.extend(held(&nodes_where(&mesh, edge), 0b111111));
            lowest(&mesh, &supports, 5)
        },
    );
}

/// FV32, a cantilevered tapered membrane.
#[test]
fn a_cantilevered_tapered_membrane() {
    let published = [44.623, 130.03, 162.70, 246.05, 379.90, 391.44];
    compare(
        "FV32",
        &published,
        [0.003, 0.012, 0.006, 0.002, 0.002, 0.003],
        |kind, cells| {
            let mesh = plate(kind, [2 * cells, cells], 0.05, |[x, y]| {
                [10.0 * x, (y - 0.5) * (5.0 - 4.0 * x)]
            });
            let mut supports = held(&nodes_where(&mesh, |_| true), 0b011100);
            supports.extend(held(&nodes_where(&mesh, |x| x[0] < 1e-9), 0b111111));
            lowest(&mesh, &supports, 6)
        },
    );
}

/// LE3: a quarter of a hemisphere of radius 10 m, pulled out and pushed in by 2 kN at its edge.
#[test]
fn a_hemisphere_with_point_loads() {
    for ((kind, code), tolerance) in RULED
        .into_iter()
        .zip([0.006, 0.01, 0.02, 0.006, 0.01, 0.006])
    {
        for cells in [4u32, 8, 16] {
            let mut mesh = octant(kind, halved(kind, cells));
            mesh.code = code;
            let mut supports = held(&nodes_where(&mesh, |x| x[1].abs() < 1e-9), 0b101010);
            supports.extend(held(&nodes_where(&mesh, |x| x[0].abs() < 1e-9), 0b110001));
            supports.extend(held(&[at(&mesh, [0.0, 0.0, 10.0])], 0b000100));
            let (out, inward) = (at(&mesh, [10.0, 0.0, 0.0]), at(&mesh, [0.0, 10.0, 0.0]));
            let (structure, found) =
                pushed(&mesh, &supports, &[(out, 0, 2000.0), (inward, 1, -2000.0)]);
            let share = found[structure.freedoms.freedom(out, 0).unwrap()] / 0.185;
            println!("LE3 {kind:?} {code:?} {cells}: {share:.4}");
            assert!(
                cells < 16 || (share - 1.0).abs() < tolerance,
                "{kind:?}: {share}"
            );
        }
    }
}

/// An octant of a sphere in three patches around its centre, each of cells².
fn octant(form: Form, cells: u32) -> Mesh {
    let mut mesh = empty();
    mesh.properties[0].section = Section::Shell(ShellSection::plate(0.04));
    mesh.materials[0].young = 68.25e9;
    let mut known: BTreeMap<[i64; 3], u32> = BTreeMap::new();
    let centre = [1.0f64; 3];
    for turn in 0..3 {
        let corner = std::array::from_fn(|k| if k == turn { 1.0 } else { 0.0 });
        let sides = [1, 2].map(|step: usize| {
            let other = (turn + step) % 3;
            std::array::from_fn(|k| if k == turn || k == other { 1.0 } else { 0.0 })
        });
        let mut node = |i: u32, j: u32| {
            let [r, s] = [i, j].map(|k| f64::from(k) / f64::from(cells));
            let between = |a: [f64; 3], b: [f64; 3], x: f64| -> [f64; 3] {
                let unit = |p: [f64; 3]| p.map(|x| x / dot(&p, &p).sqrt());
                let (a, b) = (unit(a), unit(b));
                let angle = dot(&a, &b).clamp(-1.0, 1.0).acos();
                let [p, q] = [1.0 - x, x].map(|x| (x * angle).sin() / angle.sin());
                std::array::from_fn(|k| p * a[k] + q * b[k])
            };
            let low = between(corner, sides[0], r);
            let high = between(sides[1], centre, r);
            let place = between(low, high, s).map(|x| 10.0 * x);
            let key = place.map(|x| (1e6 * x).round() as i64);
            *known
                .entry(key)
                .or_insert_with(|| add_node(&mut mesh, place))
        };
        let mut quads = Vec::new();
        for i in 0..cells {
            for j in 0..cells {
                quads.push([
                    node(i, j),
                    node(i + 1, j),
                    node(i + 1, j + 1),
                    node(i, j + 1),
                ]);
            }
        }
        for quad in quads {
            add_cell(&mut mesh, form, 0, quad);
        }
    }
    raise(&mut mesh, form, |mesh, ends| {
        let place = between(mesh, ends);
        let radius = dot(&place, &place).sqrt();
        place.map(|x| 10.0 * x / radius)
    });
    mesh
}
