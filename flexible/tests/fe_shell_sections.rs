//! Shells beside their nodes, of varying thickness, and of several or anisotropic materials, against closed
//! forms.

use crate::fe_meshes::*;
use crate::shell_meshes::*;
use eng_flexible::Mesh;
use eng_flexible::fe::mass::rigid_motions;
use eng_flexible::fe::{Rules, assemble};
use eng_flexible::mesh::{
    Layup, Material, Section, SheetElasticity, ShellAxis, ShellSection, ShellShape,
};

fn offset(offset: f64) -> ShellShape {
    ShellShape {
        offsets: [offset; 4],
        ..ShellShape::default()
    }
}

/// A strip along x without Poisson's ratio.
fn strip(kind: Form, cells: u32, [length, width]: [f64; 2], section: ShellSection) -> Mesh {
    let n = f64::from(cells);
    let mut mesh = sheet(kind, [cells, 2], section, |[i, j]| {
        [i * length / n, j * width / 2.0, 0.0]
    });
    mesh.materials[0].poisson = 0.0;
    mesh
}

/// Displacements and rotations of the middle of the free end under a unit of the six loads there, spread as
/// the shape functions do.
fn tip(mesh: &Mesh, length: f64, component: u8, load: f64) -> [f64; 6] {
    let clamped = held(&nodes_where(mesh, |x| x[0] < 1e-9), 0b111111);
    let end = |x: [f64; 3]| x[0] > length - 1e-9;
    let forces = along_edge(mesh, end, component, load);
    let (structure, found) = pushed(mesh, &clamped, &forces);
    let tip = middle(mesh, end);
    std::array::from_fn(|k| found[structure.freedoms.freedom(tip, k as u8).unwrap()])
}

#[test]
fn an_offset_plate_has_the_mass_of_the_box_beside_its_nodes() {
    let (length, width, thickness, beside) = (0.4, 0.3, 0.05, 0.07);
    for kind in KINDS {
        let section = ShellSection {
            mass_per_area: 11.0,
            ..ShellSection::plate(thickness)
        };
        let mut mesh = sheet(kind, [3, 2], section, |[i, j]| {
            turned([i * length / 3.0, j * width / 2.0, 0.0])
        });
        shaped(&mut mesh, offset(beside));
        let structure = assemble(&mesh, &Rules::default()).unwrap();
        let rigid = structure.mass.rigid(&mesh);
        let own = DENSITY * thickness * length * width;
        let mass = own + 11.0 * length * width;
        assert!(agrees(rigid.mass, mass, 1e-12));
        let centre = turned([0.5 * length, 0.5 * width, beside]);
        for (found, exact) in rigid.centre().iter().zip(centre) {
            assert!((found - exact).abs() < 1e-12, "{kind:?}: {rigid:?}");
        }
        // in the axes of the sheet; the added mass is in the middle surface
        let [x, y, z] = [length, width, beside];
        let normal = own * thickness * thickness / 12.0;
        let local = [
            [
                mass * (y * y / 3.0 + z * z) + normal,
                -mass * x * y / 4.0,
                -mass * x * z / 2.0,
            ],
            [
                -mass * x * y / 4.0,
                mass * (x * x / 3.0 + z * z) + normal,
                -mass * y * z / 2.0,
            ],
            [
                -mass * x * z / 2.0,
                -mass * y * z / 2.0,
                mass * (x * x + y * y) / 3.0,
            ],
        ];
        let axes = turn();
        for i in 0..3 {
            for j in 0..3 {
                let found: f64 = (0..9)
                    .map(|k| axes[k / 3][i] * rigid.inertia[k / 3][k % 3] * axes[k % 3][j])
                    .sum();
                let error = (found - local[i][j]).abs();
                assert!(
                    error < 1e-12 * local[2][2],
                    "{kind:?} {i} {j}: {found} {}",
                    local[i][j]
                );
            }
        }
    }
}

#[test]
fn rigid_motions_of_offset_and_tapered_shells_cost_nothing() {
    for kind in KINDS {
        let mut mesh = empty();
        mesh.properties[0].section = Section::Shell(ShellSection::plate(0.02));
        for place in [
            [0.0, 0.0, 0.0],
            [1.0, 0.1, 0.1],
            [1.2, 0.9, -0.2],
            [-0.1, 0.8, 0.15],
        ] {
            add_node(&mut mesh, place);
        }
        add_cell(&mut mesh, kind, 0, [0, 1, 2, 3]);
        raise(&mut mesh, kind, between);
        let shape = ShellShape {
            offsets: [0.1, 0.05, -0.02, 0.03],
            thickness: Some([0.01, 0.02, 0.03, 0.015]),
            axis: ShellAxis::Side(0.3),
        };
        shaped(&mut mesh, shape);
        let structure = assemble(&mesh, &Rules::default()).unwrap();
        let size = structure.freedoms.size();
        let identity: Vec<f64> = (0..size * size)
            .map(|i| if i % (size + 1) == 0 { 1.0 } else { 0.0 })
            .collect();
        let most = largest(&times(&structure.stiffness, &identity));
        for motion in rigid_motions(&mesh, &structure.freedoms).chunks(size) {
            let force = largest(&times(&structure.stiffness, motion));
            assert!(force < 1e-12 * most, "{kind:?}: {force} of {most}");
        }
    }
}

/// A beam whose axis lies z above the clamped and pulled line: a force F along it bends by the moment −F z.
#[test]
fn an_offset_strip_is_a_beam_with_an_eccentric_axis() {
    let (length, width, thickness, beside) = (1.0, 0.05, 0.01, 0.03);
    let inertia = width * thickness * thickness * thickness / 12.0;
    let area = width * thickness;
    for kind in KINDS {
        let mut mesh = strip(kind, 8, [length, width], ShellSection::plate(thickness));
        shaped(&mut mesh, offset(beside));
        let force = 1000.0;
        let found = tip(&mesh, length, 0, force);
        let moment = -force * beside;
        // the axis bends about y: w'' = −θ' with θ' = M/(E I); the nodes move by z θ less than the axis
        let turn = moment * length / (YOUNG * inertia);
        let exact = [
            (0, force * length / (YOUNG * area) - beside * turn),
            (2, -0.5 * turn * length),
            (4, turn),
        ];
        for (component, exact) in exact {
            // drilling rotations of the membrane want moments at the end
            let tolerance = match kind {
                DRILLING => 1e-5,
                // rounding of a shear that is h²/t² times as stiff as the bending
                QUAD8 | TRIANGLE6 => 1e-8,
                _ => 1e-9,
            };
            assert!(
                agrees(found[component], exact, tolerance),
                "{kind:?}: {found:?} {component} {exact}"
            );
        }
    }
}

/// Two sheets at the same nodes, one above and one below: a beam with two flanges.
#[test]
fn two_offset_strips_bend_as_flanges() {
    let (length, width, thickness, beside) = (1.0, 0.05, 0.01, 0.03);
    let inertia = 2.0 * width * thickness * (thickness * thickness / 12.0 + beside * beside);
    for kind in KINDS {
        let flanges = |cells: u32| {
            let mut mesh = strip(kind, cells, [length, width], ShellSection::plate(thickness));
            shaped(&mut mesh, offset(beside));
            mesh.shell_shapes.push(offset(-beside));
            for element in mesh.elements.clone() {
                let nodes = mesh.nodes_of(&element).to_vec();
                add_element(&mut mesh, element.kind, 0, &nodes);
                if let Some(added) = mesh.elements.last_mut() {
                    added.variant = element.variant;
                    added.shell = Some(1);
                }
            }
            mesh
        };
        let shear = 0.5 * 1.2 * length / (0.5 * YOUNG * width * thickness);
        let exact = length * length * length / (3.0 * YOUNG * inertia) + shear;
        let errors = [16u32, 32, 64, 128].map(|cells| {
            let mesh = flanges(halved(kind, cells));
            let [_, _, found, ..] = tip(&mesh, length, 2, 1.0);
            (found / exact - 1.0).abs()
        });
        // the arms stand at the nodes: between them the flanges of triangles bend by themselves, along their
        // longest sides too, which the cells across keep
        println!("{kind:?}: {errors:?}");
        let tolerance = if kind == QUAD { 2e-5 } else { 6e-3 };
        assert!(errors[3] < tolerance, "{kind:?}: {errors:?}");
        // curved triangles bend between the arms on coarse meshes, too
        let falls = errors.is_sorted_by(|a, b| a > b);
        assert!(falls || kind == TRIANGLE6, "{kind:?}: {errors:?}");
    }
}

#[test]
fn a_tapered_strip_bends_and_weighs_as_its_thickness_says() {
    let (length, width, [first, last]) = (1.0, 0.05, [0.02, 0.01]);
    for kind in KINDS {
        let cells = 32;
        let mut mesh = strip(kind, cells, [length, width], ShellSection::plate(first));
        for (index, element) in mesh.elements.clone().iter().enumerate() {
            let nodes = mesh.nodes_of(element).to_vec();
            let mut own = [first; 4];
            for (own, node) in own.iter_mut().zip(nodes) {
                let x = mesh.nodes[node as usize].position[0];
                *own = first + (last - first) * x / length;
            }
            mesh.shell_shapes.push(ShellShape {
                thickness: Some(own),
                ..ShellShape::default()
            });
            mesh.elements[index].shell = Some(index as u32);
        }
        let mass = assemble(&mesh, &Rules::default())
            .unwrap()
            .mass
            .rigid(&mesh);
        let volume = 0.5 * (first + last) * length * width;
        assert!(agrees(mass.mass, DENSITY * volume, 1e-12));
        let third = (first + 2.0 * last) / (first + last) * length / 3.0;
        assert!(agrees(mass.centre()[0], third, 1e-12), "{kind:?}: {mass:?}");
        // ∫ 12 M/(E b t³) dx with t linear
        let moment = 3.0;
        let [.., found, _] = tip(&mesh, length, 4, moment);
        let squares = 1.0 / (last * last) - 1.0 / (first * first);
        let exact = 12.0 * moment / (YOUNG * width) * length / (first - last) * 0.5 * squares;
        assert!(agrees(found, exact, 1e-3), "{kind:?}: {}", found / exact);
    }
}

fn other(name: &str, young: f64) -> Material {
    Material {
        name: name.into(),
        young,
        poisson: 0.0,
        density: 1.0,
        sheet: None,
        solid: None,
    }
}

#[test]
fn materials_apart_stretch_bend_and_shear() {
    let (length, width, thickness) = (0.2, 0.05, 0.05);
    let (bending, shear) = (0.5 * YOUNG, 0.01 * YOUNG);
    for kind in KINDS {
        let section = ShellSection {
            layup: Layup::Apart {
                bending: Some(1),
                shear: Some(2),
            },
            ..ShellSection::plate(thickness)
        };
        let mut mesh = strip(kind, 32, [length, width], section);
        mesh.materials
            .extend([other("bends", bending), other("shears", shear)]);
        if kind != DRILLING {
            let [along, ..] = tip(&mesh, length, 0, 1.0);
            assert!(agrees(along, length / (YOUNG * width * thickness), 1e-9));
        }
        let [_, _, across, ..] = tip(&mesh, length, 2, 1.0);
        let inertia = width * thickness * thickness * thickness / 12.0;
        let exact = length * length * length / (3.0 * bending * inertia)
            + 1.2 * length / (0.5 * shear * width * thickness);
        assert!(agrees(across, exact, 1e-3), "{kind:?}: {}", across / exact);
        let mass = assemble(&mesh, &Rules::default())
            .unwrap()
            .mass
            .rigid(&mesh)
            .mass;
        assert!(agrees(mass, DENSITY * length * width * thickness, 1e-12));
    }
}

/// Off-axis tension: `1/E_x = c⁴/E₁ + (1/G₁₂ − 2 ν₁₂/E₁) c² s² + s⁴/E₂` (R. M. Jones, Mechanics of Composite
/// Materials, 2nd ed., eq. 2.97), and the shear that comes with it.
#[test]
fn an_orthotropic_sheet_stretches_along_any_axis() {
    let (length, width, thickness, angle) = (0.4, 0.1, 0.002, 0.5f64);
    let [e1, e2, poisson, g] = [140e9, 10e9, 0.3, 5e9];
    let (c, s) = (angle.cos(), angle.sin());
    let inverse = c.powi(4) / e1 + (1.0 / g - 2.0 * poisson / e1) * c * c * s * s + s.powi(4) / e2;
    let cross =
        poisson / e1 * (c.powi(4) + s.powi(4)) - (1.0 / e1 + 1.0 / e2 - 1.0 / g) * c * c * s * s;
    // drilling rotations of the membrane want moments at the ends: see the laminates for their energy
    for kind in [QUAD, TRIANGLE, QUAD8, TRIANGLE6] {
        let axes = [
            ShellAxis::Direction([c, s, 0.7], 0.0),
            ShellAxis::Direction([1.0, 0.0, -0.2], angle),
            ShellAxis::Side(angle),
        ];
        // the first sides of triangles have several directions
        for axis in &axes[..if kind.0.corner_count() == 4 { 3 } else { 2 }] {
            let mut mesh = sheet(kind, [4, 3], ShellSection::plate(thickness), |[i, j]| {
                [i * length / 4.0, j * width / 3.0, 0.0]
            });
            mesh.materials[0].sheet =
                SheetElasticity::orthotropic([e1, e2, poisson, g], [4e9, 3e9]);
            shaped(
                &mut mesh,
                ShellShape {
                    axis: *axis,
                    ..ShellShape::default()
                },
            );
            let mut supports = held(&[0], 0b000111);
            supports.extend(held(&[at(&mesh, [0.0, width, 0.0])], 0b000001));
            supports.extend(held(&nodes_where(&mesh, |_| true), 0b011100));
            let mut forces = Vec::new();
            for (end, sign) in [(0.0, -1.0), (length, 1.0)] {
                let edge = |x: [f64; 3]| (x[0] - end).abs() < 1e-9;
                forces.extend(along_edge(&mesh, edge, 0, sign * 1e3));
            }
            let (structure, found) = pushed(&mesh, &supports, &forces);
            let corner = at(&mesh, [length, width, 0.0]);
            let moved = |k: u8| found[structure.freedoms.freedom(corner, k).unwrap()];
            let stress = 1e3 / (width * thickness);
            let tolerance = 1e-9;
            let exact = stress * inverse * length;
            assert!(
                agrees(moved(0), exact, tolerance),
                "{kind:?} {axis:?} {}",
                moved(0) / exact
            );
            let top = at(&mesh, [0.0, width, 0.0]);
            let narrowed = found[structure.freedoms.freedom(top, 1).unwrap()];
            let exact = -stress * cross * width;
            assert!(
                agrees(narrowed, exact, tolerance),
                "{kind:?} {axis:?} {}",
                narrowed / exact
            );
        }
    }
}

#[test]
fn unsound_shapes_and_sheets_are_refused() {
    let plate = || strip(QUAD, 2, [1.0, 0.5], ShellSection::plate(0.01));
    let found = |mesh: &Mesh| problem(assemble(mesh, &Rules::default()));
    let membrane = Layup::Apart {
        bending: None,
        shear: None,
    };
    let mut mesh = plate();
    mesh.properties[0].section = Section::Shell(ShellSection {
        layup: membrane,
        ..ShellSection::plate(0.01)
    });
    shaped(&mut mesh, offset(0.1));
    let text = found(&mesh);
    assert!(
        text.contains("element 1 has an offset, but its section has no bending stiffness"),
        "{text}"
    );
    let mut mesh = plate();
    let thickness = Some([0.01, 0.0, 0.01, 0.01]);
    shaped(
        &mut mesh,
        ShellShape {
            thickness,
            ..ShellShape::default()
        },
    );
    let text = found(&mesh);
    assert!(
        text.contains("element 1 has a thickness of 0 m at a node"),
        "{text}"
    );
    let mut mesh = plate();
    mesh.materials[0].sheet = SheetElasticity::orthotropic([2e11, 1e11, 0.3, 5e10], [0.0, 0.0]);
    let axis = ShellAxis::Direction([0.0, 0.0, 1.0], 0.0);
    shaped(
        &mut mesh,
        ShellShape {
            axis,
            ..ShellShape::default()
        },
    );
    let text = found(&mesh);
    assert!(
        text.contains("a first axis of its material that is normal to its surface"),
        "{text}"
    );
    shaped(&mut mesh, ShellShape::default());
    if let Some(sheet) = &mut mesh.materials[0].sheet {
        sheet.plane[2][2] = 0.0;
    }
    let text = found(&mesh);
    assert!(
        text.contains("which is not symmetric and positive definite"),
        "{text}"
    );
    let mut mesh = bar(
        eng_flexible::mesh::ElementKind::Hexahedron8,
        [1, 1, 1],
        [1.0; 3],
    );
    mesh.materials[0].sheet = SheetElasticity::orthotropic([2e11, 1e11, 0.3, 5e10], [0.0, 0.0]);
    let text = found(&mesh);
    assert!(
        text.contains("element 1 is no shell, but its material"),
        "{text}"
    );
    assert_eq!(
        SheetElasticity::orthotropic([1e9, 1e11, 0.3, 5e10], [0.0, 0.0]),
        None
    );
}
