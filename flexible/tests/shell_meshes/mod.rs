//! Sheets of shells, and their deflections and frequencies.

use std::collections::BTreeMap;

use crate::fe_meshes::*;
use eng_flexible::Mesh;
use eng_flexible::element::{Shape, quadrature};
use eng_flexible::fe::{Assembled, Reduction, Rules, assemble};
use eng_flexible::mesh::{
    Code, ElementKind, Property, Section, ShellSection, ShellShape, Support, Variant,
};
use eng_flexible::solve::{EigenOptions, Modes, lowest_modes};

pub const QUAD: Form = (ElementKind::Quadrilateral4, Variant::Plain);
pub const TRIANGLE: Form = (ElementKind::Triangle3, Variant::Plain);
pub const DRILLING: Form = (ElementKind::Triangle3, Variant::Drilling);
pub const QUAD8: Form = (ElementKind::Quadrilateral8, Variant::Plain);
pub const TRIANGLE6: Form = (ElementKind::Triangle6, Variant::Plain);
pub const KINDS: [Form; 5] = [QUAD, TRIANGLE, DRILLING, QUAD8, TRIANGLE6];

/// The forms with the code whose rules they follow. Nastran's quadrilaterals have its residual bending flexibility.
pub const RULED: [(Form, Code); 6] = [
    (QUAD, Code::None),
    (TRIANGLE, Code::None),
    (DRILLING, Code::None),
    (QUAD8, Code::None),
    (TRIANGLE6, Code::None),
    (QUAD, Code::Nastran),
];

pub type Form = (ElementKind, Variant);

/// Whether an element of this form has mid-side nodes.
pub fn is_quadratic((kind, _): Form) -> bool {
    kind != kind.linear()
}

/// Cells along the sides of a mesh with as many nodes along each side as one of elements of four nodes.
pub fn halved(form: Form, cells: u32) -> u32 {
    match is_quadratic(form) {
        true => cells / 2,
        false => cells,
    }
}

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
            match form.0.linear() == ElementKind::Triangle3 && length(b, d) < 0.999 * length(a, c) {
                true => add_cell(&mut mesh, form, 0, [b, c, d, a]),
                false => add_cell(&mut mesh, form, 0, [a, b, c, d]),
            }
        }
    }
    let cell = |node: u32| [node % across, node / across].map(f64::from);
    raise(&mut mesh, form, |_, [a, b]| {
        let ([i, j], [k, l]) = (cell(a), cell(b));
        place([0.5 * (i + k), 0.5 * (j + l)])
    });
    mesh
}

/// Gives shells mid-side nodes, if the form has some, at `place` of the ends of their side.
pub fn raise(mesh: &mut Mesh, (kind, _): Form, place: impl Fn(&Mesh, [u32; 2]) -> [f64; 3]) {
    if kind == kind.linear() {
        return;
    }
    let mut known: BTreeMap<[u32; 2], u32> = BTreeMap::new();
    let elements = std::mem::take(&mut mesh.elements);
    let connectivity = std::mem::take(&mut mesh.connectivity);
    for element in elements {
        let first = element.first as usize;
        let mut nodes = connectivity[first..first + element.kind.node_count()].to_vec();
        if element.kind == kind.linear() {
            for i in 0..nodes.len() {
                let (a, b) = (nodes[i], nodes[(i + 1) % element.kind.node_count()]);
                let node = *known
                    .entry([a.min(b), a.max(b)])
                    .or_insert_with(|| add_node(mesh, place(mesh, [a, b])));
                nodes.push(node);
            }
            add_element(mesh, kind, element.property, &nodes);
        } else {
            add_element(mesh, element.kind, element.property, &nodes);
        }
    }
}

/// The middle of two nodes.
pub fn between(mesh: &Mesh, ends: [u32; 2]) -> [f64; 3] {
    let [a, b] = ends.map(|node| mesh.nodes[node as usize].position);
    [0, 1, 2].map(|k: usize| 0.5 * (a[k] + b[k]))
}

/// A quadrilateral, or the two triangles along its diagonal from the first corner. They get mid-side nodes from
/// [`raise`].
pub fn add_cell(mesh: &mut Mesh, (kind, variant): Form, property: u32, [a, b, c, d]: [u32; 4]) {
    let first = mesh.elements.len();
    let kind = kind.linear();
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
) -> (Assembled, Vec<f64>) {
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

/// Forces of a load per area (N/m²) along a component, by the functions of the nodes.
pub fn spread(mesh: &Mesh, component: u8, load: f64) -> Vec<(u32, u8, f64)> {
    let mut forces = Vec::new();
    for element in &mesh.elements {
        let nodes = mesh.nodes_of(element);
        let rule = match element.kind.corner_count() {
            3 => quadrature::triangle(3),
            _ => quadrature::quadrilateral(3),
        };
        for point in rule {
            let shape = Shape::at(element.kind, point.at);
            let tangent = |axis: usize| -> [f64; 3] {
                let own = nodes.iter().zip(shape.slopes);
                own.fold([0.0; 3], |sum, (node, slope)| {
                    let place = mesh.nodes[*node as usize].position;
                    [0, 1, 2].map(|k: usize| sum[k] + slope[axis] * place[k])
                })
            };
            let (u, v) = (tangent(0), tangent(1));
            let n = [
                u[1] * v[2] - u[2] * v[1],
                u[2] * v[0] - u[0] * v[2],
                u[0] * v[1] - u[1] * v[0],
            ];
            let area = point.weight * dot(&n, &n).sqrt();
            let own = nodes.iter().zip(shape.values);
            forces.extend(own.map(|(node, value)| (*node, component, load * area * value)));
        }
    }
    forces
}

/// Forces of a line load with this sum (N) along a component, on the sides of shells whose nodes are all at such
/// places. The sides are of one length.
pub fn along_edge(
    mesh: &Mesh,
    on: impl Fn([f64; 3]) -> bool,
    component: u8,
    force: f64,
) -> Vec<(u32, u8, f64)> {
    let mut sides = Vec::new();
    let shells = mesh.elements.iter();
    for element in shells.filter(|element| !element.kind.is_solid()) {
        let nodes = mesh.nodes_of(element);
        let corners = element.kind.corner_count();
        for i in 0..corners {
            let mut side = vec![nodes[i], nodes[(i + 1) % corners]];
            side.extend(nodes.get(corners + i));
            if side
                .iter()
                .all(|node| on(mesh.nodes[*node as usize].position))
            {
                sides.push(side);
            }
        }
    }
    let share = force / sides.len() as f64;
    let mut forces = Vec::new();
    for side in sides {
        let shares: &[f64] = match side.len() {
            2 => &[0.5, 0.5],
            _ => &[1.0 / 6.0, 1.0 / 6.0, 2.0 / 3.0],
        };
        let own = side.into_iter().zip(shares);
        forces.extend(own.map(|(node, factor)| (node, component, share * factor)));
    }
    forces
}

/// The node nearest to the middle of those at such places.
pub fn middle(mesh: &Mesh, on: impl Fn([f64; 3]) -> bool) -> u32 {
    let nodes = nodes_where(mesh, on);
    let place = |node: u32| mesh.nodes[node as usize].position;
    let mean = [0, 1, 2].map(|k: usize| {
        let sum: f64 = nodes.iter().map(|node| place(*node)[k]).sum();
        sum / nodes.len() as f64
    });
    let distance = |node: u32| -> f64 {
        let p = place(node);
        (0..3).map(|k| (p[k] - mean[k]) * (p[k] - mean[k])).sum()
    };
    let nearest = nodes
        .into_iter()
        .min_by(|a, b| distance(*a).total_cmp(&distance(*b)));
    nearest.unwrap()
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
    raise(&mut mesh, form, between);
    mesh
}

/// A full vector of displacements and rotations that are given in the axes of the sheet. Inner nodes are where
/// they are in balance.
pub fn motion(
    mesh: &Mesh,
    structure: &Assembled,
    of: impl Fn([f64; 2]) -> ([f64; 3], [f64; 3]),
) -> Vec<f64> {
    let axes = turn();
    let mut full = vec![0.0; structure.freedoms.size()];
    for (index, node) in mesh.nodes.iter().enumerate() {
        let local = [0, 1].map(|k: usize| (0..3).map(|i| axes[i][k] * node.position[i]).sum());
        let (moved, rotated) = of(local);
        let own = structure.freedoms.of(index as u32);
        if own.is_empty() {
            continue;
        }
        let first = own.start;
        full[first..first + 3].copy_from_slice(&turned(moved));
        full[first + 3..first + 6].copy_from_slice(&turned(rotated));
    }
    let all: Vec<u32> = (0..mesh.nodes.len() as u32).collect();
    let last = structure.freedoms.of(*all.last().unwrap()).end;
    if last < full.len() {
        let reduction = Reduction::new(mesh, structure, &held(&all, 0b111111)).unwrap();
        let forces: Vec<f64> = times(&structure.stiffness, &full)
            .iter()
            .map(|x| -x)
            .collect();
        for (x, own) in full.iter_mut().zip(solve(structure, &reduction, &forces)) {
            *x += own;
        }
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
