//! Elements of the mesh, with their sections.

use super::materials::Materials;
use super::model::Model;
use super::sections::{Family, Sections, direction};
use super::shapes::Shape;
use crate::error::FileProblem;
use crate::fe::vector::subtract;
use crate::mesh::{BeamAxes, Carries, ElementKind, Mesh, Variant};
use crate::read::builder::{NewElement, add_element};
use crate::read::unread::UnreadCards;
use crate::read::vector::{beam_axes, rotate};

/// Makes the elements of a mesh of those of a model. A beam of three nodes becomes two beams of the same
/// number.
pub(super) fn make(
    model: &mut Model,
    mesh: &mut Mesh,
    materials: &Materials,
    unread: &mut UnreadCards,
) -> Result<(), FileProblem> {
    let mut sections = Sections::new((&*model, mesh.code), materials, unread)?;
    let mut made = Vec::with_capacity(model.rows.len());
    for (index, row) in model.rows.iter().enumerate() {
        let index = index as u32; // counted when they were numbered
        let start = mesh.elements.len() as u32; // at most two a row
        let Some(family) = Family::of(row.shape) else {
            made.push((start, 0));
            continue;
        };
        let Some(property) = sections.property(index, family, model, materials, unread)? else {
            unread.note("line elements without section", &row.at, Carries::Unknown);
            made.push((start, 0));
            continue;
        };
        let nodes = model.row_nodes(row);
        let new = |kind, variant| NewElement {
            id: row.id,
            kind,
            variant,
            property,
            shell: None,
        };
        let beam = new(ElementKind::Beam2, Variant::Plain);
        match (row.shape, nodes) {
            (Shape::Solid(kind, variant), nodes) => {
                add_element(mesh, new(kind, variant), nodes, None).map_err(|e| e.at(&row.at))?;
            }
            (Shape::Shell(kind), nodes) => {
                let new = NewElement {
                    shell: sections.shape(index, property, (row, model), unread)?,
                    ..new(kind, Variant::Plain)
                };
                add_element(mesh, new, nodes, None).map_err(|e| e.at(&row.at))?;
            }
            (Shape::Membrane(kind) | Shape::Facet(kind), nodes) => {
                let new = new(kind, Variant::Plain);
                add_element(mesh, new, nodes, None).map_err(|e| e.at(&row.at))?;
            }
            (Shape::Truss, &[a, b]) => {
                let along = subtract(model.position(b), model.position(a)).map(f64::abs);
                let mut orientation = [0.0, 0.0, 1.0];
                if along[2] > along[0].min(along[1]) {
                    orientation = if along[0] <= along[1] {
                        [1.0, 0.0, 0.0]
                    } else {
                        [0.0, 1.0, 0.0]
                    };
                }
                line(model, mesh, row, beam, [a, b], orientation)?;
            }
            (Shape::Beam { nodes: count, .. }, nodes) => {
                let (ends, beyond) = nodes.split_at_checked(count).unwrap_or((nodes, &[]));
                let orientation = match (beyond.first(), ends.first(), sections.block(index)) {
                    (Some(pointer), Some(first), _) => {
                        subtract(model.position(*pointer), model.position(*first))
                    }
                    (None, _, Some((place, block))) => {
                        let motion = model.places.get(place).map(|placed| placed.motion());
                        let given = direction(block)?;
                        motion.map_or(given, |motion| rotate(&motion.rotation, given))
                    }
                    _ => continue,
                };
                for pair in ends.windows(2) {
                    if let [a, b] = *pair {
                        line(model, mesh, row, beam, [a, b], orientation)?;
                    }
                }
            }
            _ => {}
        }
        made.push((start, mesh.elements.len() as u32 - start));
    }
    mesh.properties = std::mem::take(&mut sections.properties.all);
    mesh.materials = std::mem::take(&mut sections.materials.all);
    mesh.laminates = std::mem::take(&mut sections.laminates);
    for (row, elements) in model.rows.iter_mut().zip(made) {
        row.elements = elements;
    }
    Ok(())
}

fn line(
    model: &Model,
    mesh: &mut Mesh,
    row: &super::model::Row,
    beam: NewElement,
    ends: [u32; 2],
    orientation: [f64; 3],
) -> Result<(), FileProblem> {
    let [a, b] = ends;
    let along = subtract(model.position(b), model.position(a));
    if beam_axes(along, orientation).is_none() {
        return Err(row.at.problem(
            format!(
                "element {} has no length, or its axis n1 is parallel to it",
                row.label
            ),
            "give a direction n1 across the beam, in the second line of its beam section",
        ));
    }
    let axes = BeamAxes {
        centroid: [0.0; 2],
        orientation,
        offsets: [[0.0; 3]; 2],
        released: [0; 2],
    };
    add_element(mesh, beam, &ends, Some(axes)).map_err(|e| e.at(&row.at))?;
    Ok(())
}
