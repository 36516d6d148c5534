//! Meshes made in code, meshes of the test data, and linear solutions on them.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, Read};
use std::path::PathBuf;
use std::sync::Arc;

use eng_flexible::fe::stress::{Components, ElementRecovery, nodal_stresses, stress};
use eng_flexible::fe::{Assembled, FreedomMap, Reduction, Rules};
use eng_flexible::mesh::{
    BeamAxes, Element, ElementKind, Material, Mesh, Node, Property, Section, Support, Variant,
};
use eng_flexible::read::nastran::read_bulk;
use eng_flexible::solve::{Analysis, Definiteness, Factorization};
use eng_flexible::sparse::{SymmetricMatrix, SymmetricOperator};
use eng_flexible::{Files, FlexibleError};
use eng_system::reduced::ReducedBody;

pub const SOLIDS: [ElementKind; 8] = [
    ElementKind::Tetrahedron4,
    ElementKind::Tetrahedron10,
    ElementKind::Hexahedron8,
    ElementKind::Hexahedron20,
    ElementKind::Wedge6,
    ElementKind::Wedge15,
    ElementKind::Pyramid5,
    ElementKind::Pyramid13,
];

pub const YOUNG: f64 = 210e9;
pub const POISSON: f64 = 0.3;
pub const DENSITY: f64 = 7850.0;

/// A place among cells of four units a side; mid-side nodes fall on whole numbers.
type Key = [i32; 3];

const CORNERS: [Key; 8] = [
    [0, 0, 0],
    [4, 0, 0],
    [4, 4, 0],
    [0, 4, 0],
    [0, 0, 4],
    [4, 0, 4],
    [4, 4, 4],
    [0, 4, 4],
];
const CENTRE: Key = [2, 2, 2];

fn corner_sets(kind: ElementKind) -> Vec<Vec<Key>> {
    let pick = |local: &[usize]| local.iter().map(|&i| CORNERS[i]).collect::<Vec<_>>();
    match kind.linear() {
        ElementKind::Hexahedron8 => vec![CORNERS.to_vec()],
        ElementKind::Wedge6 => vec![pick(&[0, 1, 2, 4, 5, 6]), pick(&[0, 2, 3, 4, 6, 7])],
        // along the diagonal 0–6, so that the faces of neighbours match
        ElementKind::Tetrahedron4 => [[1, 2], [2, 3], [3, 7], [7, 4], [4, 5], [5, 1]]
            .iter()
            .map(|[a, b]| pick(&[0, *a, *b, 6]))
            .collect(),
        ElementKind::Pyramid5 => [
            [0, 1, 2, 3],
            [4, 7, 6, 5],
            [0, 4, 5, 1],
            [1, 5, 6, 2],
            [2, 6, 7, 3],
            [3, 7, 4, 0],
        ]
        .iter()
        .map(|base| {
            let mut nodes = pick(base);
            nodes.push(CENTRE);
            nodes
        })
        .collect(),
        other => panic!("{other:?} fills no box"),
    }
}

/// A mesh of steel without elements.
pub fn empty() -> Mesh {
    Mesh {
        properties: vec![Property {
            name: "solid".into(),
            material: Some(0),
            section: Section::Solid,
        }],
        materials: vec![Material {
            name: "steel".into(),
            young: YOUNG,
            poisson: POISSON,
            density: DENSITY,
            sheet: None,
            solid: None,
        }],
        ..Mesh::default()
    }
}

pub fn add_node(mesh: &mut Mesh, position: [f64; 3]) -> u32 {
    let index = mesh.nodes.len() as u32;
    mesh.nodes.push(Node {
        id: u64::from(index) + 1,
        position,
        frame: None,
    });
    index
}

pub fn add_element(mesh: &mut Mesh, kind: ElementKind, property: u32, nodes: &[u32]) {
    assert_eq!(nodes.len(), kind.node_count());
    let element = Element {
        id: mesh.elements.len() as u64 + 1,
        kind,
        variant: Variant::Plain,
        property,
        first: mesh.connectivity.len() as u32,
        beam: None,
        shell: None,
    };
    mesh.connectivity.extend_from_slice(nodes);
    mesh.elements.push(element);
}

pub fn add_beam(mesh: &mut Mesh, section: Section, axes: BeamAxes, nodes: [u32; 2]) {
    let property = mesh.properties.len() as u32;
    mesh.properties.push(Property {
        name: "beam".into(),
        material: Some(0),
        section,
    });
    let index = mesh.beam_axes.len() as u32;
    mesh.beam_axes.push(axes);
    add_element(mesh, ElementKind::Beam2, property, &nodes);
    if let Some(element) = mesh.elements.last_mut() {
        element.beam = Some(index);
    }
}

/// A grid of boxes cut into elements. `place` maps coordinates that count cells to metres; mid-side nodes are
/// mapped too where `curved`, else half-way between their corners.
pub fn grid(
    kind: ElementKind,
    cells: [i32; 3],
    curved: bool,
    place: impl Fn([f64; 3]) -> [f64; 3],
) -> Mesh {
    let mut mesh = empty();
    let mut known: BTreeMap<Key, u32> = BTreeMap::new();
    let at = |key: Key| place(key.map(|x| f64::from(x) / 4.0));
    for k in 0..cells[2] {
        for j in 0..cells[1] {
            for i in 0..cells[0] {
                for corners in corner_sets(kind) {
                    let keys: Vec<Key> = corners
                        .iter()
                        .map(|c| [c[0] + 4 * i, c[1] + 4 * j, c[2] + 4 * k])
                        .collect();
                    let mut nodes = Vec::new();
                    for key in &keys {
                        let mesh = &mut mesh;
                        nodes.push(
                            *known
                                .entry(*key)
                                .or_insert_with(|| add_node(mesh, at(*key))),
                        );
                    }
                    for [a, b] in kind.midside_edges() {
                        let key = [0, 1, 2].map(|x: usize| (keys[*a][x] + keys[*b][x]) / 2);
                        let (p, q) = (at(keys[*a]), at(keys[*b]));
                        let middle = if curved {
                            at(key)
                        } else {
                            [0, 1, 2].map(|x: usize| 0.5 * (p[x] + q[x]))
                        };
                        let mesh = &mut mesh;
                        nodes.push(*known.entry(key).or_insert_with(|| add_node(mesh, middle)));
                    }
                    add_element(&mut mesh, kind, 0, &nodes);
                }
            }
        }
    }
    mesh
}

/// A straight box from the origin.
pub fn bar(kind: ElementKind, cells: [i32; 3], size: [f64; 3]) -> Mesh {
    grid(kind, cells, false, |x| {
        [0, 1, 2].map(|i: usize| x[i] * size[i] / f64::from(cells[i]))
    })
}

/// A unit cube of 2³ cells whose inner places are shifted about.
pub fn distorted(kind: ElementKind, curved: bool) -> Mesh {
    grid(kind, [2, 2, 2], curved, |x| {
        let inside: f64 = x.iter().map(|t| t * (2.0 - t)).product();
        [
            0.5 * x[0] + 0.06 * inside * (1.0 + 0.7 * x[1]),
            0.5 * x[1] - 0.05 * inside * (1.0 - 0.4 * x[2]),
            0.5 * x[2] + 0.07 * inside * (0.6 + 0.5 * x[0]),
        ]
    })
}

/// Nodes on the surface of the unit cube.
pub fn on_cube(position: [f64; 3]) -> bool {
    position
        .iter()
        .any(|x| x.abs() < 1e-9 || (x - 1.0).abs() < 1e-9)
}

pub fn nodes_where(mesh: &Mesh, test: impl Fn([f64; 3]) -> bool) -> Vec<u32> {
    (0..mesh.nodes.len() as u32)
        .filter(|node| test(mesh.nodes[*node as usize].position))
        .collect()
}

pub fn held(nodes: &[u32], components: u8) -> Vec<Support> {
    nodes
        .iter()
        .map(|&node| Support { node, components })
        .collect()
}

/// A full vector with this displacement at each node (rotations zero).
pub fn field(
    mesh: &Mesh,
    structure: &Assembled,
    displacement: impl Fn([f64; 3]) -> [f64; 3],
) -> Vec<f64> {
    let mut full = vec![0.0; structure.freedoms.size()];
    for (index, node) in mesh.nodes.iter().enumerate() {
        let range = structure.freedoms.of(index as u32);
        for (x, u) in full[range].iter_mut().zip(displacement(node.position)) {
            *x = u;
        }
    }
    full
}

pub fn times(matrix: &impl SymmetricOperator, x: &[f64]) -> Vec<f64> {
    let mut y = vec![0.0; x.len()];
    matrix.apply(x.len() / matrix.size(), x, &mut y);
    y
}

pub fn dot(x: &[f64], y: &[f64]) -> f64 {
    x.iter().zip(y).map(|(a, b)| a * b).sum()
}

pub fn largest(x: &[f64]) -> f64 {
    x.iter().fold(0.0, |most, value| most.max(value.abs()))
}

/// Full displacements under full forces.
pub fn solve(structure: &Assembled, reduction: &Reduction, forces: &[f64]) -> Vec<f64> {
    let stiffness = reduction.reduce_stiffness(&structure.stiffness).unwrap();
    let mut x = reduction.gather(1, forces);
    factor(&stiffness).solve_in_place(&mut x).unwrap();
    reduction.expand(1, &x)
}

pub fn factor(stiffness: &SymmetricMatrix) -> Factorization {
    let analysis = Arc::new(Analysis::fill_reducing(stiffness).unwrap());
    Factorization::new(&analysis, stiffness, Definiteness::Positive).unwrap()
}

/// Frequencies [Hz] of eigenvalues; rounding around zero is zero.
pub fn frequencies(eigenvalues: &[f64]) -> Vec<f64> {
    eigenvalues
        .iter()
        .map(|x| x.max(0.0).sqrt() / (2.0 * std::f64::consts::PI))
        .collect()
}

/// Whether two numbers agree to `tolerance` of the second.
pub fn agrees(x: f64, y: f64, tolerance: f64) -> bool {
    (x - y).abs() <= tolerance * y.abs()
}

struct Data;

impl Files for Data {
    fn open(&self, name: &str) -> io::Result<Box<dyn Read>> {
        let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/data");
        match name.strip_prefix("deck:") {
            Some(text) => Ok(Box::new(io::Cursor::new(text.as_bytes().to_vec()))),
            None => Ok(Box::new(File::open(folder.join(name))?)),
        }
    }
}

/// A mesh of the test data.
pub fn read(name: &str) -> Mesh {
    read_bulk(&Data, name).unwrap_or_else(|error| panic!("{error}"))
}

/// The message of a structure's error.
pub fn problem<T>(result: Result<T, FlexibleError>) -> String {
    match result {
        Ok(_) => panic!("no error"),
        Err(FlexibleError::Of { error, .. }) => problem::<T>(Err(*error)),
        Err(
            FlexibleError::Structure { problem, advice }
            | FlexibleError::Row {
                problem, advice, ..
            },
        ) => {
            assert!(!advice.is_empty(), "{problem}: no advice");
            problem
        }
        Err(other) => panic!("another error: {other}"),
    }
}

/// Stress (Pa) at each node from a full vector of displacements; `None` for nodes of no solid.
pub fn nodal_stress(
    mesh: &Mesh,
    freedoms: &FreedomMap,
    rules: &Rules,
    full: &[f64],
) -> Vec<Option<Components>> {
    let all = vec![true; mesh.nodes.len()];
    let (found, values) = nodal_stresses(mesh, freedoms, rules, full, &all).unwrap();
    let (values, rest) = values.as_chunks::<6>();
    assert!(rest.is_empty());
    found
        .iter()
        .zip(values)
        .map(|(found, value)| found.then_some(*value))
        .collect()
}

/// Strain energy ½ ∫ σ:ε dV (J) of the solids, from the strains at their integration points.
pub fn energy_of_solids(mesh: &Mesh, freedoms: &FreedomMap, rules: &Rules, full: &[f64]) -> f64 {
    let mut energy = 0.0;
    for element in &mesh.elements {
        let Some(recovery) = ElementRecovery::new(mesh, element, rules).unwrap() else {
            continue;
        };
        let displacements = recovery.displacements(freedoms, full);
        for (point, strain) in recovery.points.iter().zip(recovery.strains(&displacements)) {
            let stress = stress(&recovery.material, point.place, &strain);
            energy += 0.5 * point.volume * dot(&stress, &strain);
        }
    }
    energy
}

/// Strain energy ½ aᵀ k a (J) of a reduced body.
pub fn modal_energy(body: &ReducedBody, a: &[f64]) -> f64 {
    let rows = body.invariants.stiffness.chunks_exact(a.len());
    rows.zip(a).map(|(row, x)| 0.5 * x * dot(row, a)).sum()
}
