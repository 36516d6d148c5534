//! Triangles with drilling rotations that are too large for the curvature of their surface.

use std::collections::BTreeMap;

use crate::fe::check::{Role, role};
use crate::fe::vector::{Vector, cross, dot, norm, scale, subtract};
use crate::mesh::{Element, Mesh, Variant};

/// Cosine of the angle between neighbours beyond which their edge is a fold, not a curved surface: 30°. A
/// choice: a curved surface of useful triangles turns less from one to the next.
const FOLD: f64 = 0.866;

/// Share of the triangles from which the whole is reported. A choice: fewer stiffen a small part of the
/// surface.
const MANY: f64 = 0.1;

/// A warning for triangles whose membrane has rotations about the normal. On a surface of radius R the normals of
/// neighbouring facets differ by h/R. The rotations that they share stiffen the bending where `h²/R` exceeds the
/// thickness t. So the product of a triangle's longest side and the angle to a neighbour is compared with t. The
/// hemisphere of the tests has 99.5 % of its deflection if this product is below t, and 93 % if it is 3.4 t.
pub(in crate::fe) fn too_curved(mesh: &Mesh) -> Option<String> {
    let mut edges: BTreeMap<[u32; 2], Vec<Vector>> = BTreeMap::new();
    let mut triangles = Vec::new();
    for element in &mesh.elements {
        let Some(Role::Shell(sheet)) = role(mesh, element) else {
            continue;
        };
        let Some(normal) = normal(mesh, element) else {
            continue;
        };
        let nodes = corners(mesh, element);
        for (i, first) in nodes.iter().enumerate() {
            let second = nodes.get(i + 1).or(nodes.first()).unwrap_or(first);
            let edge = [*first.min(second), *first.max(second)];
            edges.entry(edge).or_default().push(normal);
        }
        if element.variant == Variant::Drilling && nodes.len() == 3 {
            triangles.push((element, normal, sheet.section.thickness));
        }
    }
    let locks = |(element, normal, thickness): &(&Element, Vector, f64)| {
        let nodes = corners(mesh, element);
        let mut longest = 0.0f64;
        let mut angle = 0.0f64;
        for (i, first) in nodes.iter().enumerate() {
            let second = nodes.get(i + 1).or(nodes.first()).unwrap_or(first);
            let side = place(mesh, *second).zip(place(mesh, *first));
            longest = longest.max(side.map_or(0.0, |(b, a)| norm(subtract(b, a))));
            let edge = [*first.min(second), *first.max(second)];
            for other in edges.get(&edge).into_iter().flatten() {
                let cosine = dot(*normal, *other).abs();
                if cosine > FOLD {
                    angle = angle.max(norm(cross(*normal, *other)));
                }
            }
        }
        longest * angle > *thickness
    };
    let count = triangles.iter().filter(|triangle| locks(triangle)).count();
    let all = triangles.len();
    (count as f64 > MANY * all as f64).then(|| {
        format!(
            "{count} of {all} CTRIAR are too large for their curved surface: longest side × angle to a neighbour exceeds the thickness, and they \
             bend too stiffly. Refine the mesh, or take CTRIA3 or CQUAD4"
        )
    })
}

fn corners<'a>(mesh: &'a Mesh, element: &Element) -> &'a [u32] {
    let nodes = mesh.nodes_of(element);
    nodes.get(..element.kind.corner_count()).unwrap_or(nodes)
}

fn place(mesh: &Mesh, node: u32) -> Option<Vector> {
    mesh.nodes.get(node as usize).map(|node| node.position)
}

/// The unit normal of an element, by its first three nodes.
fn normal(mesh: &Mesh, element: &Element) -> Option<Vector> {
    let [a, b, c] = *mesh.nodes_of(element).first_chunk()?;
    let [a, b, c] = [place(mesh, a)?, place(mesh, b)?, place(mesh, c)?];
    let normal = cross(subtract(b, a), subtract(c, a));
    let length = norm(normal);
    (length > 0.0).then(|| scale(1.0 / length, normal))
}
