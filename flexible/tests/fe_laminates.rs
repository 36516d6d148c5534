//! Layered shells against the closed forms of R. M. Jones, Mechanics of Composite Materials, 2nd ed., ch. 4 and 5.

use crate::fe_meshes::*;
use crate::shell_meshes::*;
use eng_flexible::Mesh;
use eng_flexible::fe::stress::surface_stresses;
use eng_flexible::fe::{Rules, assemble};
use eng_flexible::mesh::{
    Layer, Layup, Material, SheetElasticity, ShellAxis, ShellSection, ShellShape,
};
use std::f64::consts::PI;

/// E₁, E₂, ν₁₂, G₁₂ of a layer of carbon fibres.
const CARBON: [f64; 4] = [140e9, 10e9, 0.3, 5e9];

fn carbon(across: [f64; 2]) -> Material {
    Material {
        name: "carbon".into(),
        young: CARBON[0],
        poisson: CARBON[2],
        density: 1600.0,
        sheet: SheetElasticity::orthotropic(CARBON, across),
        solid: None,
    }
}

/// Q₁₁, Q₁₂, Q₂₂, Q₆₆.
fn stiffness([first, second, poisson, shear]: [f64; 4]) -> [f64; 4] {
    let rest = 1.0 - poisson * poisson * second / first;
    [first / rest, poisson * second / rest, second / rest, shear]
}

/// Gives a mesh these layers (angle in °, thickness) of its first material, along the sheet's x axis.
fn laminated(mesh: &mut Mesh, material: Material, layers: &[(f64, f64)], axis: [f64; 3]) {
    mesh.materials[0] = material;
    mesh.laminates = vec![
        layers
            .iter()
            .map(|(degrees, thickness)| Layer {
                material: 0,
                thickness: *thickness,
                angle: degrees.to_radians(),
            })
            .collect(),
    ];
    let section = pile(layers.iter().map(|(_, thickness)| thickness).sum());
    mesh.properties[0].section = eng_flexible::mesh::Section::Shell(section);
    let axis = ShellAxis::Direction(axis, 0.0);
    shaped(
        mesh,
        ShellShape {
            axis,
            ..ShellShape::default()
        },
    );
}

fn pile(thickness: f64) -> ShellSection {
    ShellSection {
        layup: Layup::Layers(0),
        ..ShellSection::plate(thickness)
    }
}

/// The energy and the stresses of a cross-ply under constant strains and curvatures: A₁₁ = (Q₁₁ + Q₂₂) t/2, B₁₁ =
/// −B₂₂ = (Q₂₂ − Q₁₁) t²/8, D₁₁ = (Q₁₁ + Q₂₂) t³/24.
#[test]
fn a_cross_ply_couples_bending_and_stretching() {
    let t = 0.004;
    let [q11, q12, q22, q66] = stiffness(CARBON);
    let (strain, curvature) = ([1e-3, -0.7e-3, 0.7e-3], [-0.4, -0.4, -0.4]);
    let mean = 0.5 * (q11 + q22);
    let form = |c: [[f64; 3]; 3], a: [f64; 3], b: [f64; 3]| -> f64 {
        (0..9).map(|k| a[k / 3] * c[k / 3][k % 3] * b[k % 3]).sum()
    };
    let even = [[mean, q12, 0.0], [q12, mean, 0.0], [0.0, 0.0, q66]];
    let b11 = (q22 - q11) * t * t / 8.0;
    let coupling = [[b11, 0.0, 0.0], [0.0, -b11, 0.0], [0.0; 3]];
    let exact = 0.24
        * 0.12
        * (0.5 * t * form(even, strain, strain)
            + form(coupling, strain, curvature)
            + 0.5 * t * t * t / 12.0 * form(even, curvature, curvature));
    let axes = turn();
    let along = [axes[0][0], axes[1][0], axes[2][0]];
    for kind in KINDS {
        let mut mesh = patch(kind, ShellSection::plate(t));
        laminated(
            &mut mesh,
            carbon([4e9, 3e9]),
            &[(0.0, 0.5 * t), (90.0, 0.5 * t)],
            along,
        );
        let structure = assemble(&mesh, &Rules::default()).unwrap();
        let full = motion(&mesh, &structure, |[x, y]| {
            (
                [
                    1e-3 * (x + 0.5 * y),
                    1e-3 * (0.2 * x - 0.7 * y),
                    0.2 * (x * x + x * y + y * y),
                ],
                [0.4 * (0.5 * x + y), -0.4 * (x + 0.5 * y), -0.15e-3],
            )
        });
        let force = times(&structure.stiffness, &full);
        let found = 0.5 * dot(&full, &force);
        assert!(agrees(found, exact, 1e-9), "{kind:?}: {found} {exact}");
        // the stress along x on both surfaces of both layers
        let wanted = vec![true; mesh.nodes.len()];
        let faces = surface_stresses(
            &mesh,
            &structure.freedoms,
            &Rules::default(),
            &full,
            &wanted,
        )
        .unwrap();
        let expected = [(q11, -0.5), (q11, 0.0), (q22, 0.0), (q22, 0.5)].map(|(own, height)| {
            let at = |k: usize| strain[k] + height * t * curvature[k];
            own * at(0) + q12 * at(1)
        });
        for node in faces.values() {
            assert_eq!(node.len(), 4);
            for (face, exact) in node.iter().zip(expected) {
                let [xx, yy, zz, xy, yz, zx] = *face.as_slice() else {
                    panic!("{face:?}");
                };
                let [a, b, c] = along;
                let found = xx * a * a
                    + yy * b * b
                    + zz * c * c
                    + 2.0 * (xy * a * b + yz * b * c + zx * c * a);
                assert!(
                    (found - exact).abs() < 1e-9 * 2e8,
                    "{kind:?}: {found} {exact}"
                );
            }
        }
    }
}

/// A pulled strip of two layers without Poisson's ratio bends by κ = −B₁₁ N/(A₁₁ D₁₁ − B₁₁²).
#[test]
fn a_pulled_strip_of_two_layers_bends() {
    let (length, width, t) = (0.5, 0.02, 0.004);
    let [e1, e2] = [140e9, 10e9];
    let mut layer = carbon([0.0, 0.0]);
    layer.sheet = SheetElasticity::orthotropic([e1, e2, 0.0, 5e9], [4e9, 3e9]);
    for kind in [QUAD, TRIANGLE, QUAD8, TRIANGLE6] {
        // of a shear that is h²/t² times as stiff as the bending
        let rounding = if is_quadratic(kind) { 1e-8 } else { 1e-9 };
        let mut mesh = sheet(kind, [10, 2], ShellSection::plate(t), |[i, j]| {
            [i * length / 10.0, j * width / 2.0, 0.0]
        });
        laminated(
            &mut mesh,
            layer.clone(),
            &[(0.0, 0.5 * t), (90.0, 0.5 * t)],
            [1.0, 0.0, 0.0],
        );
        let mut supports = held(&nodes_where(&mesh, |x| x[0] < rounding), 0b010101);
        // the layers narrow differently, so the edge must be free to turn about x
        supports.extend(held(&[at(&mesh, [0.0, 0.5 * width, 0.0])], 0b101010));
        supports.extend(held(&nodes_where(&mesh, |_| true), 0b001000));
        let end = |x: [f64; 3]| x[0] > length - 1e-9;
        let (tip, forces) = (middle(&mesh, end), along_edge(&mesh, end, 0, 100.0));
        let (structure, found) = pushed(&mesh, &supports, &forces);
        let (a, b, d) = (
            0.5 * (e1 + e2) * t,
            (e2 - e1) * t * t / 8.0,
            (e1 + e2) * t * t * t / 24.0,
        );
        let force = 100.0 / width;
        let curvature = -b * force / (a * d - b * b);
        let tip = |k: u8| found[structure.freedoms.freedom(tip, k).unwrap()];
        assert!(
            agrees(tip(2), -0.5 * curvature * length * length, rounding),
            "{kind:?}: {}",
            tip(2)
        );
        assert!(
            agrees(tip(0), d * force / (a * d - b * b) * length, rounding),
            "{kind:?}: {}",
            tip(0)
        );
    }
}

/// [0/60/−60] is isotropic in its plane: A₁₁ = t (3 Q₁₁ + 3 Q₂₂ + 2 Q₁₂ + 4 Q₆₆)/8, A₁₂ = t (Q₁₁ + Q₂₂ + 6
/// Q₁₂ − 4 Q₆₆)/8.
#[test]
fn layers_of_three_directions_stretch_alike_in_all() {
    let t = 0.003;
    let [q11, q12, q22, q66] = stiffness(CARBON);
    let a11 = t * (3.0 * (q11 + q22) + 2.0 * q12 + 4.0 * q66) / 8.0;
    let a12 = t * (q11 + q22 + 6.0 * q12 - 4.0 * q66) / 8.0;
    for kind in KINDS {
        for (angle, shear) in [(0.0, 0.0), (0.3, 0.0), (1.1, 1e-3)] {
            let mut mesh = patch(kind, ShellSection::plate(t));
            let (c, s) = f64::sin_cos(angle);
            let third = t / 3.0;
            laminated(
                &mut mesh,
                carbon([0.0, 0.0]),
                &[(0.0, third), (60.0, third), (-60.0, third)],
                turned([c, s, 0.0]),
            );
            let structure = assemble(&mesh, &Rules::default()).unwrap();
            let full = motion(&mesh, &structure, |[x, y]| {
                (
                    [1e-3 * x + shear * y, -0.4e-3 * y, 0.0],
                    [0.0, 0.0, -0.5 * shear],
                )
            });
            let found = 0.5 * dot(&full, &times(&structure.stiffness, &full));
            let (x, y) = (1e-3, -0.4e-3);
            let plane = a11 * (x * x + y * y) + 2.0 * a12 * x * y;
            let exact = 0.5 * 0.24 * 0.12 * (plane + 0.5 * (a11 - a12) * shear * shear);
            assert!(
                agrees(found, exact, 1e-9),
                "{kind:?} {angle}: {found} {exact}"
            );
        }
    }
}

/// A core that shears between stiff faces: S = G EI²/(t_c (E_f t_f d/2)²).
#[test]
fn a_sandwich_shears_in_its_core() {
    let (length, width, core, face) = (0.3, 0.05, 0.02, 0.001);
    let (young, modulus) = (70e9, 30e6);
    let d = core + face;
    let inertia = young * (face * face * face / 6.0 + 0.5 * face * d * d);
    let flow = young * face * 0.5 * d;
    let shear = modulus * inertia * inertia / (core * flow * flow);
    for kind in KINDS {
        let mut mesh = sheet(
            kind,
            [30, 2],
            ShellSection::plate(core + 2.0 * face),
            |[i, j]| [i * length / 30.0, j * width / 2.0, 0.0],
        );
        let soft = 1e-6 * young;
        laminated(
            &mut mesh,
            carbon([0.0, 0.0]),
            &[(0.0, face), (0.0, core), (0.0, face)],
            [1.0, 0.0, 0.0],
        );
        mesh.laminates[0][1].material = 1;
        mesh.materials[0].sheet =
            SheetElasticity::orthotropic([young, young, 0.0, 0.5 * young], [0.0, 0.0]);
        mesh.materials.push(Material {
            name: "core".into(),
            sheet: SheetElasticity::orthotropic([soft, soft, 0.0, 0.5 * soft], [modulus, modulus]),
            solid: None,
            ..mesh.materials[0].clone()
        });
        let clamped = held(&nodes_where(&mesh, |x| x[0] < 1e-9), 0b111111);
        let end = |x: [f64; 3]| x[0] > length - 1e-9;
        let (tip, forces) = (middle(&mesh, end), along_edge(&mesh, end, 2, 1.0));
        let (structure, found) = pushed(&mesh, &clamped, &forces);
        let moved = found[structure.freedoms.freedom(tip, 2).unwrap()];
        let exact = (length * length * length / (3.0 * inertia) + length / shear) / width;
        assert!(agrees(moved, exact, 2e-3), "{kind:?}: {}", moved / exact);
    }
}

/// Aluminium on steel: the centre of mass is beside the middle.
#[test]
fn layers_of_two_densities_weigh_beside_the_middle() {
    let (length, width, [low, high]) = (0.4, 0.3, [0.01, 0.03]);
    let [heavy, light] = [7850.0, 2700.0];
    for kind in KINDS {
        let mut mesh = sheet(kind, [3, 2], pile(low + high), |[i, j]| {
            [i * length / 3.0, j * width / 2.0, 0.0]
        });
        let steel = mesh.materials[0].clone();
        mesh.materials.push(Material {
            density: light,
            ..steel
        });
        let layer = |material, thickness| Layer {
            material,
            thickness,
            angle: 0.0,
        };
        mesh.laminates = vec![vec![layer(0, low), layer(1, high)]];
        let rigid = assemble(&mesh, &Rules::default())
            .unwrap()
            .mass
            .rigid(&mesh);
        let area = length * width;
        let [own_low, own_high] = [heavy * low * area, light * high * area];
        assert!(agrees(rigid.mass, own_low + own_high, 1e-12));
        let half = 0.5 * (low + high);
        let [z_low, z_high] = [0.5 * low - half, half - 0.5 * high];
        let centre = (own_low * z_low + own_high * z_high) / (own_low + own_high);
        assert!(
            agrees(rigid.centre()[2], centre, 1e-12),
            "{kind:?}: {rigid:?}"
        );
        let about_x = (own_low + own_high) * width * width / 3.0
            + own_low * (z_low * z_low + low * low / 12.0)
            + own_high * (z_high * z_high + high * high / 12.0);
        assert!(
            agrees(rigid.inertia[0][0], about_x, 1e-12),
            "{kind:?}: {rigid:?}"
        );
    }
}

/// ω² = π⁴/(ρ t) (D₁₁ (m/a)⁴ + 2 (D₁₂ + 2 D₆₆) (m n/a b)² + D₂₂ (n/b)⁴) of a thin simply supported plate.
#[test]
fn a_supported_cross_ply_has_its_frequencies() {
    let (length, width, t) = (1.0, 0.8, 0.004);
    let [q11, q12, q22, q66] = stiffness(CARBON);
    // [0/90/90/0]
    let cube = t * t * t / 12.0;
    let d11 = cube * (7.0 * q11 + q22) / 8.0;
    let d22 = cube * (q11 + 7.0 * q22) / 8.0;
    let mixed = 2.0 * cube * (q12 + 2.0 * q66);
    let frequency = |m: f64, n: f64| {
        let (x, y) = ((m / length).powi(2), (n / width).powi(2));
        0.5 * PI * ((d11 * x * x + mixed * x * y + d22 * y * y) / (1600.0 * t)).sqrt()
    };
    let mut exact = Vec::new();
    for m in 1..5 {
        for n in 1..5 {
            exact.push(frequency(f64::from(m), f64::from(n)));
        }
    }
    exact.sort_by(f64::total_cmp);
    for kind in KINDS {
        let errors = [8u32, 16, 32].map(|cells| {
            let cells = halved(kind, cells);
            let n = f64::from(cells);
            let mut mesh = sheet(kind, [cells; 2], ShellSection::plate(t), |[i, j]| {
                [length * i / n, width * j / n, 0.0]
            });
            let quarter = 0.25 * t;
            let layers = [
                (0.0, quarter),
                (90.0, quarter),
                (90.0, quarter),
                (0.0, quarter),
            ];
            laminated(&mut mesh, carbon([0.0, 0.0]), &layers, [1.0, 0.0, 0.0]);
            let edge = |x: f64, end: f64| x < 1e-9 || x > end - 1e-9;
            let mut supports = held(&nodes_where(&mesh, |x| edge(x[0], length)), 0b101111);
            supports.extend(held(&nodes_where(&mesh, |x| edge(x[1], width)), 0b110111));
            supports.extend(held(&nodes_where(&mesh, |_| true), 0b000011));
            let found = lowest(&mesh, &supports, 4);
            let errors = found.iter().zip(&exact).map(|(f, e)| (f / e - 1.0).abs());
            errors.fold(0.0, f64::max)
        });
        println!("{kind:?}: {errors:?}");
        assert!(errors[2] < 0.01, "{kind:?}: {errors:?}");
        assert!(errors.is_sorted_by(|a, b| a > b), "{kind:?}: {errors:?}");
    }
}

#[test]
fn a_layer_without_thickness_is_refused() {
    let mut mesh = patch(QUAD, ShellSection::plate(0.01));
    laminated(
        &mut mesh,
        carbon([0.0, 0.0]),
        &[(0.0, 0.01), (90.0, 0.0)],
        [1.0, 0.0, 0.0],
    );
    let text = problem(assemble(&mesh, &Rules::default()));
    assert!(text.contains("element 1 has a layer of 0 m"), "{text}");
}
