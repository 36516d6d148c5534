//! Sheets of shells, and their deflections and frequencies.

use crate::fe_meshes::*;
use eng_flexible::Mesh;
use eng_flexible::fe::{Reduction, Rules, Structure, assemble};
use eng_flexible::mesh::{
    ElementKind, Property, Section, ShellSection, ShellShape, Support, Variant,
};
use eng_flexible::solve::{EigenOptions, Modes, lowest_modes};

pub const QUAD: Form = (ElementKind::Quadrilateral4, Variant::Plain);
pub const TRIANGLE: Form = (ElementKind::Triangle3, Variant::Plain);
pub const DRILLING: Form = (ElementKind::Triangle3, Variant::Drilling);
pub const KINDS: [Form; 3] = [QUAD, TRIANGLE, DRILLING];

pub type Form = (ElementKind, Variant);

/// A sheet of cells; `place` maps coordinates that count cells to metres. Triangles cut each cell along the
/// shorter diagonal, and along the one from its first corner if both are alike.
pub fn sheet(
    form: Form,
    cells: [u32; 2],
    section: ShellSection,
    place: impl Fn([f64; 2]) -> [f64; 3],
) -> Mesh {
    let mut mesh = empty();
    mesh.properties[0] = Property {
        name: "sheet".into(),
        material: Some(0),
        section: Section::Shell(section),
    };
    for j in 0..=cells[1] {
        for i in 0..=cells[0] {
            add_node(&mut mesh, place([f64::from(i), f64::from(j)]));
        }
    }
    let across = cells[0] + 1;
    for j in 0..cells[1] {
        for i in 0..cells[0] {
            let [a, b] = [j * across + i, j * across + i + 1];
            let (c, d) = (b + across, a + across);
            let length = |p: u32, q: u32| -> f64 {
                let (p, q) = (
                    mesh.nodes[p as usize].position,
                    mesh.nodes[q as usize].position,
                );
                (0..3).map(|k: usize| (p[k] - q[k]) * (p[k] - q[k])).sum()
            };
            match form.0 == ElementKind::Triangle3 && length(b, d) < 0.999 * length(a, c) {
                true => add_cell(&mut mesh, form, 0, [b, c, d, a]),
                false => add_cell(&mut mesh, form, 0, [a, b, c, d]),
            }
        }
    }
    mesh
}

/// A quadrilateral, or the two triangles along its diagonal from the first corner.
pub fn add_cell(mesh: &mut Mesh, (kind, variant): Form, property: u32, [a, b, c, d]: [u32; 4]) {
    let first = mesh.elements.len();
    match kind {
        ElementKind::Triangle3 => {
            add_element(mesh, kind, property, &[a, b, c]);
            add_element(mesh, kind, property, &[a, c, d]);
        }
        _ => add_element(mesh, kind, property, &[a, b, c, d]),
    }
    for element in &mut mesh.elements[first..] {
        element.variant = variant;
    }
}

/// A place turned out of the planes of the axes.
pub fn turned(x: [f64; 3]) -> [f64; 3] {
    let axes = turn();
    [0, 1, 2].map(|i: usize| (0..3).map(|k| axes[i][k] * x[k]).sum())
}

/// Turns vectors of a sheet into space: columns are the axes.
pub fn turn() -> [[f64; 3]; 3] {
    let (a, b) = (0.7f64, 0.4f64);
    let (ca, sa, cb, sb) = (a.cos(), a.sin(), b.cos(), b.sin());
    [
        [ca, -sa * cb, sa * sb],
        [sa, ca * cb, -ca * sb],
        [0.0, sb, cb],
    ]
}

/// Displacements under forces at nodes (node, component, force).
pub fn pushed(
    mesh: &Mesh,
    supports: &[Support],
    forces: &[(u32, u8, f64)],
) -> (Structure, Vec<f64>) {
    let structure = assemble(mesh, &Rules::default()).unwrap();
    let reduction = Reduction::new(mesh, &structure, supports).unwrap();
    let mut full = vec![0.0; structure.freedoms.size()];
    for (node, component, force) in forces {
        full[structure.freedoms.freedom(*node, *component).unwrap()] += force;
    }
    let found = solve(&structure, &reduction, &full);
    (structure, found)
}

pub fn at(mesh: &Mesh, place: [f64; 3]) -> u32 {
    let near = |p: [f64; 3]| (0..3).all(|k| (p[k] - place[k]).abs() < 1e-6);
    nodes_where(mesh, near)[0]
}

/// Forces of a load per area (N/m²) along a component, by the shares of the corners of each element.
pub fn spread(mesh: &Mesh, component: u8, load: f64) -> Vec<(u32, u8, f64)> {
    let mut forces = Vec::new();
    for element in &mesh.elements {
        let nodes = mesh.nodes_of(element);
        let p = |i: usize| mesh.nodes[nodes[i] as usize].position;
        let area = |a: usize, b: usize, c: usize| {
            let u = [0, 1, 2].map(|k: usize| p(b)[k] - p(a)[k]);
            let v = [0, 1, 2].map(|k: usize| p(c)[k] - p(a)[k]);
            let n = [
                u[1] * v[2] - u[2] * v[1],
                u[2] * v[0] - u[0] * v[2],
                u[0] * v[1] - u[1] * v[0],
            ];
            0.5 * dot(&n, &n).sqrt()
        };
        let whole = match nodes.len() {
            3 => area(0, 1, 2),
            _ => area(0, 1, 2) + area(0, 2, 3),
        };
        for node in nodes {
            forces.push((*node, component, load * whole / nodes.len() as f64));
        }
    }
    forces
}

/// The lowest frequencies (Hz) of a held mesh.
pub fn lowest(mesh: &Mesh, supports: &[Support], count: usize) -> Vec<f64> {
    let structure = assemble(mesh, &Rules::default()).unwrap();
    let reduction = Reduction::new(mesh, &structure, supports).unwrap();
    let stiffness = reduction.reduce_stiffness(&structure.stiffness).unwrap();
    let mass = reduction.reduce_mass(&structure.mass).unwrap();
    let options = EigenOptions::default();
    let found = lowest_modes(&stiffness, &mass, Modes::Count(count), &options).unwrap();
    frequencies(&found.eigenvalues)
}

/// MacNeal's and Harder's patch: 0.24 m × 0.12 m with four nodes inside.
pub fn patch(form: Form, section: ShellSection) -> Mesh {
    let mut mesh = empty();
    mesh.properties[0].section = Section::Shell(section);
    for [x, y] in [
        [0.0, 0.0],
        [0.24, 0.0],
        [0.24, 0.12],
        [0.0, 0.12],
        [0.04, 0.02],
        [0.18, 0.03],
        [0.16, 0.08],
        [0.08, 0.08],
    ] {
        add_node(&mut mesh, turned([x, y, 0.0]));
    }
    for [a, b, c, d] in [
        [0, 1, 5, 4],
        [1, 2, 6, 5],
        [2, 3, 7, 6],
        [3, 0, 4, 7],
        [4, 5, 6, 7],
    ] {
        add_cell(&mut mesh, form, 0, [a, b, c, d]);
    }
    mesh
}

/// A full vector of displacements and rotations that are given in the axes of the sheet.
pub fn motion(
    mesh: &Mesh,
    structure: &Structure,
    of: impl Fn([f64; 2]) -> ([f64; 3], [f64; 3]),
) -> Vec<f64> {
    let axes = turn();
    let mut full = vec![0.0; structure.freedoms.size()];
    for (index, node) in mesh.nodes.iter().enumerate() {
        let local = [0, 1].map(|k: usize| (0..3).map(|i| axes[i][k] * node.position[i]).sum());
        let (moved, rotated) = of(local);
        let first = structure.freedoms.of(index as u32).start;
        full[first..first + 3].copy_from_slice(&turned(moved));
        full[first + 3..first + 6].copy_from_slice(&turned(rotated));
    }
    full
}

/// Gives all shells of a mesh this shape.
pub fn shaped(mesh: &mut Mesh, shape: ShellShape) {
    mesh.shell_shapes = vec![shape];
    for element in &mut mesh.elements {
        element.shell = Some(0);
    }
}
