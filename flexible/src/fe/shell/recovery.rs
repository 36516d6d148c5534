//! Stress of shells on their surfaces.
//!
//! The stress at the height z above the middle surface is `Q_s ε + z Q_b κ` in its plane; across it there is none.
//! A homogeneous section has stresses on its lower and its upper surface, a laminate on both surfaces of each
//! layer, a membrane in its middle. Values at the points of the stiffness are carried to the nodes as those of
//! solids. At a node the mean is over the elements of one property whose normals differ by less than 20°: at a
//! fold, and where properties meet, each side keeps its own.

use std::collections::BTreeMap;

use super::{Plate, Rotations, STRAINS, Shell, ShellPoint, WIDTH, folded, law::Face};
use crate::element::Shape;
use crate::error::FlexibleError;
use crate::fe::check::{self, Role, role};
use crate::fe::form;
use crate::fe::freedoms::FreedomMap;
use crate::fe::rules::Rules;
use crate::fe::sheet::Sheet;
use crate::fe::solid::Present;
use crate::fe::stress::{Components, nodal_extrapolation};
use crate::fe::vector::{Vector, dot};
use crate::mesh::{Element, Layup, Mesh, Variant};

/// Cosine of the angle between normals beyond which elements have no common mean: 20°. A choice: components
/// in two planes differ by about the square of this angle, 12 %.
const FOLD: f64 = 0.94;

/// The shells of one property and direction at a node.
struct Group {
    property: u32,
    normal: Vector,
    count: f64,
    /// Six components for each face and vector.
    sums: Vec<f64>,
}

/// Stresses (Pa; xx, yy, zz, xy, yz, zx in basic axes) from several full vectors of displacements, one after the
/// other, at the nodes that are `wanted`: for each node one list for each surface, with 6 × vectors numbers.
///
/// # Errors
/// A mesh that is not sound, a folded shell.
pub(in crate::fe) fn shell_stresses(
    mesh: &Mesh,
    freedoms: &FreedomMap,
    rules: &Rules,
    full: &[f64],
    wanted: &[bool],
) -> Result<BTreeMap<u32, Vec<Vec<f64>>>, FlexibleError> {
    let size = freedoms.size();
    let vectors = full.len().checked_div(size).unwrap_or(0);
    let rotations = form::rotations(mesh, rules.stiffness);
    let mut groups: BTreeMap<u32, Vec<Group>> = BTreeMap::new();
    for element in &mesh.elements {
        let mut own = mesh.nodes_of(element).iter();
        if !own.any(|node| wanted.get(*node as usize) == Some(&true)) {
            continue;
        }
        check::check_element(mesh, element)?;
        let Some(Role::Shell(sheet)) = role(mesh, element) else {
            continue;
        };
        let recovery = Recovery::new(mesh, element, rotations, &sheet)?;
        let layered = matches!(sheet.section.layup, Layup::Layers(_));
        let stresses: Vec<_> = full
            .chunks_exact(size.max(1))
            .map(|full| recovery.at_nodes(freedoms, full))
            .collect();
        for (local, &node) in recovery.nodes.iter().enumerate() {
            if wanted.get(node as usize) != Some(&true) {
                continue;
            }
            let own = groups.entry(node).or_default();
            let along = |group: &Group| dot(group.normal, recovery.normal);
            let joins = |group: &Group| {
                let cosine = if layered {
                    along(group)
                } else {
                    along(group).abs()
                };
                group.property == element.property && cosine > FOLD
            };
            let index = own.iter().position(joins).unwrap_or_else(|| {
                own.push(Group {
                    property: element.property,
                    normal: recovery.normal,
                    count: 0.0,
                    sums: vec![0.0; 6 * vectors * recovery.faces],
                });
                own.len() - 1
            });
            let Some(group) = own.get_mut(index) else {
                continue;
            };
            let reversed = along(group) < 0.0;
            group.count += 1.0;
            for (face, sums) in group
                .sums
                .chunks_exact_mut((6 * vectors).max(1))
                .enumerate()
            {
                let face = if reversed {
                    recovery.faces - 1 - face
                } else {
                    face
                };
                for (sum, stresses) in sums.chunks_exact_mut(6).zip(&stresses) {
                    for (sum, x) in sum.iter_mut().zip(stresses[local][face]) {
                        *sum += x;
                    }
                }
            }
        }
    }
    let mean = |group: Group| -> Vec<Vec<f64>> {
        let faces = group.sums.chunks_exact((6 * vectors).max(1));
        faces
            .map(|face| face.iter().map(|x| x / group.count).collect())
            .collect()
    };
    Ok(groups
        .into_iter()
        .map(|(node, groups)| (node, groups.into_iter().flat_map(mean).collect()))
        .collect())
}

/// A shell, ready for recovery.
struct Recovery {
    nodes: Vec<u32>,
    /// The start of its nodes in the mesh's connectivity, by which its inner node is found.
    first: u32,
    normal: Vector,
    /// Number of surfaces.
    faces: usize,
    points: Vec<(ShellPoint, Vec<Face>)>,
    /// A line for each node: values at the points, times these, are the node's.
    extrapolation: Vec<Vec<f64>>,
}

impl Recovery {
    fn new(
        mesh: &Mesh,
        element: &Element,
        rotations: Rotations,
        sheet: &Sheet<'_>,
    ) -> Result<Self, FlexibleError> {
        let present = Present::new(element.kind, mesh.nodes_of(element));
        let places = present.places(mesh);
        let plate = Plate::new(sheet);
        let drilling = element.variant == Variant::Drilling;
        let shell = Shell::new(element.kind, &present, &places, drilling, rotations, &plate);
        let points = shell
            .points()
            .map_err(|area| folded(&[(element.id, area)]))?;
        let at: Vec<[f64; 3]> = points
            .iter()
            .map(|point| [point.at[0], point.at[1], 0.0])
            .collect();
        let with_faces = |point: ShellPoint| {
            let [r, s] = point.at;
            let shape = Shape::at(element.kind.linear(), [r, s, 0.0]);
            let faces = plate.faces(&shape.values, &point.axes, point.side);
            (point, faces)
        };
        let points: Vec<_> = points.into_iter().map(with_faces).collect();
        let first = points.first();
        Ok(Recovery {
            nodes: present.nodes().to_vec(),
            first: element.first,
            normal: first.map_or([0.0; 3], |(point, _)| point.axes[2]),
            faces: first.map_or(0, |(_, faces)| faces.len()),
            points,
            extrapolation: nodal_extrapolation(element.kind, mesh.nodes_of(element), &at),
        })
    }

    /// Stresses (Pa) by node and face.
    fn at_nodes(&self, freedoms: &FreedomMap, full: &[f64]) -> Vec<Vec<Components>> {
        let mut own = [0.0; WIDTH];
        let nodes = self.nodes.iter().copied();
        let all = nodes.chain(freedoms.inner_of(self.first));
        for (node, own) in all.zip(own.chunks_exact_mut(6)) {
            for (x, freedom) in own.iter_mut().zip(freedoms.of(node)) {
                *x = full.get(freedom).copied().unwrap_or(0.0);
            }
        }
        let at_points: Vec<Vec<Components>> = self
            .points
            .iter()
            .map(|(point, faces)| {
                let mut strains = [0.0; STRAINS];
                for (strain, row) in strains.iter_mut().zip(&point.rows) {
                    *strain = row.iter().zip(&own).map(|(b, u)| b * u).sum();
                }
                faces
                    .iter()
                    .map(|face| in_space(&point.axes, stress(face, &strains)))
                    .collect()
            })
            .collect();
        self.extrapolation
            .iter()
            .map(|line| {
                let mut node = vec![[0.0; 6]; self.faces];
                for (factor, faces) in line.iter().zip(&at_points) {
                    for (sum, value) in node.iter_mut().zip(faces) {
                        for (x, y) in sum.iter_mut().zip(value) {
                            *x += factor * y;
                        }
                    }
                }
                node
            })
            .collect()
    }
}

/// Stress (Pa) 11, 22, 12 of a face.
fn stress(face: &Face, strains: &[f64; STRAINS]) -> [f64; 3] {
    std::array::from_fn(|i| {
        (0..3)
            .map(|j| {
                face.stretching[i][j] * strains[j]
                    + face.height * face.bending[i][j] * strains[3 + j]
            })
            .sum()
    })
}

/// A stress in the plane of two tangents as one in space.
fn in_space(axes: &[Vector; 3], [first, second, shear]: [f64; 3]) -> Components {
    let [a, b, _] = axes;
    let entry = |i: usize, j: usize| {
        first * a[i] * a[j] + second * b[i] * b[j] + shear * (a[i] * b[j] + b[i] * a[j])
    };
    [
        entry(0, 0),
        entry(1, 1),
        entry(2, 2),
        entry(0, 1),
        entry(1, 2),
        entry(2, 0),
    ]
}
