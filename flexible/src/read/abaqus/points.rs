//! `*MASS`, `*ROTARY INERTIA` and `*SPRING`.

use super::model::{Model, Row};
use super::scope::Block;
use super::shapes::{Shape, SpringKind};
use crate::error::FileProblem;
use crate::fe::vector::{scale, subtract};
use crate::mesh::{Carries, Mesh, PointMass, Spring, along_axes};
use crate::read::unread::UnreadCards;
use crate::read::vector::{from_axes, norm, product};

/// Makes the point masses and springs of a mesh.
pub(super) fn make(
    model: &Model,
    mesh: &mut Mesh,
    unread: &mut UnreadCards,
) -> Result<(), FileProblem> {
    let mut given = vec![false; model.rows.len()];
    for (place, block) in model.blocks() {
        let wanted = |shape: Shape| match block.keyword.key.as_str() {
            "MASS" => shape == Shape::Mass,
            "ROTARYINERTIA" => shape == Shape::Rotary,
            _ => matches!(shape, Shape::Spring(_)),
        };
        if !matches!(
            block.keyword.key.as_str(),
            "MASS" | "ROTARYINERTIA" | "SPRING"
        ) {
            continue;
        }
        let keyword = &block.keyword;
        let set = keyword.require("ELSET", "ELSET")?;
        for index in model.rows_of(place, set, &keyword.at)? {
            let Some(row) = model.rows.get(index as usize) else {
                continue;
            };
            if !wanted(row.shape) {
                return Err(keyword.problem(
                    &format!(
                        "its set contains element {}, which has another type",
                        row.label
                    ),
                    "its set must contain only elements of its own type: MASS, ROTARYI or SPRING",
                ));
            }
            if let Some(seen) = given.get_mut(index as usize)
                && std::mem::replace(seen, true)
            {
                return Err(keyword.problem(
                    &format!("element {} has two sets of values", row.label),
                    "remove it from one of the two sets",
                ));
            }
            match row.shape {
                Shape::Spring(kind) => spring(model, mesh, block, row, kind, unread)?,
                _ => mass(model, mesh, block, row, unread)?,
            }
        }
    }
    for (row, given) in model.rows.iter().zip(given) {
        let name = match row.shape {
            Shape::Mass => "MASS elements without *MASS",
            Shape::Rotary => "ROTARYI elements without *ROTARY INERTIA",
            Shape::Spring(_) => "SPRING elements without *SPRING",
            _ => continue,
        };
        if !given {
            unread.note(name, &row.at, Carries::Structure);
        }
    }
    Ok(())
}

/// A mass, or the inertia tensor `I11, I22, I33, I12, I13, I23` about the node in the axes of the part;
/// products are given as entries of the tensor, I12 = −∫ x y dm (Abaqus Analysis User's Guide, Rotary
/// inertia).
fn mass(
    model: &Model,
    mesh: &mut Mesh,
    block: &Block,
    row: &Row,
    unread: &mut UnreadCards,
) -> Result<(), FileProblem> {
    let keyword = &block.keyword;
    if keyword.has("ORIENTATION") || keyword.choice("TYPE") == "ANISOTROPIC" {
        let name = format!("*{} in own axes", keyword.name);
        unread.note(&name, &row.at, Carries::Structure);
        return Ok(());
    }
    let Some(values) = block.rows.iter().find(|row| !row.is_blank()) else {
        return Err(keyword.problem(
            "its data line is missing",
            "write the mass or the inertia on the next line",
        ));
    };
    let mut matrix = [[0.0; 6]; 6];
    if row.shape == Shape::Mass {
        let mass = values.real(0, "the mass")?;
        for (i, line) in matrix.iter_mut().take(3).enumerate() {
            line[i] = mass;
        }
    } else {
        let [i11, i22, i33] = values.vector(0, "a moment of inertia")?;
        let [i12, i13, i23] = values.vector(3, "a product of inertia")?;
        let tensor = [[i11, i12, i13], [i12, i22, i23], [i13, i23, i33]];
        let rotation = model
            .places
            .get(row.place)
            .map(|placed| placed.motion())
            .unwrap_or(super::frames::STILL)
            .rotation;
        let [x, y, z] = rotation;
        let turned = product(&product(&rotation, &tensor), &from_axes(x, y, z));
        for (line, values) in matrix.iter_mut().skip(3).zip(turned) {
            line[3..].copy_from_slice(&values);
        }
    }
    for &node in model.row_nodes(row) {
        mesh.point_masses.push(PointMass {
            id: row.id,
            node,
            matrix,
        });
    }
    Ok(())
}

/// `*SPRING`: freedoms (none for an axial spring), then the stiffness. Freedoms are those of the nodes, in
/// their own frames.
fn spring(
    model: &Model,
    mesh: &mut Mesh,
    block: &Block,
    row: &Row,
    kind: SpringKind,
    unread: &mut UnreadCards,
) -> Result<(), FileProblem> {
    let keyword = &block.keyword;
    let turned = model
        .places
        .get(row.place)
        .is_some_and(|placed| placed.motion().turns());
    if keyword.has("NONLINEAR") || keyword.has("COMPLEXSTIFFNESS") || keyword.has("ORIENTATION") {
        let name = "*SPRING that isn't linear or has own axes";
        unread.note(name, &row.at, Carries::Structure);
        return Ok(());
    }
    let [freedoms, values] = block
        .rows
        .get(..2)
        .and_then(|rows| <&[_; 2]>::try_from(rows).ok())
        .ok_or_else(|| {
            keyword.problem(
                "it has less than two data lines",
                "write the freedoms on the first line (for SPRINGA, an empty line) and the stiffness on the second",
            )
        })?;
    let stiffness = values.real(0, "the stiffness")?;
    let spring = match (kind, model.row_nodes(row)) {
        (SpringKind::Ground, &[node]) if !turned => {
            Spring::between(row.id, stiffness, (node, freedoms.freedom(0)?), None)
        }
        (SpringKind::Freedoms, &[a, b]) if !turned => {
            let first = freedoms.freedom(0)?;
            let second = if freedoms.text(1).is_empty() {
                first
            } else {
                freedoms.freedom(1)?
            };
            Spring::between(row.id, stiffness, (a, first), Some((b, second)))
        }
        (SpringKind::Axial, &[a, b]) => {
            let along = subtract(model.position(b), model.position(a));
            let length = norm(along);
            if length == 0.0 {
                return Err(row.at.problem(
                    format!("the spring {} has no length, and so no axis", row.label),
                    "move one of its nodes, or write a SPRING2 with its freedoms",
                ));
            }
            Spring {
                id: row.id,
                stiffness,
                terms: axial(
                    (model, &*mesh),
                    scale(1.0 / length, along),
                    [(a, 1.0), (b, -1.0)],
                ),
                grounded: false,
            }
        }
        _ => {
            let name = "*SPRING in a turned instance";
            unread.note(name, &row.at, Carries::Structure);
            return Ok(());
        }
    };
    mesh.springs.push(spring);
    Ok(())
}

/// The displacements of nodes along an axis, each times its sign.
fn axial(
    (model, mesh): (&Model, &Mesh),
    axis: [f64; 3],
    ends: [(u32, f64); 2],
) -> Vec<(u32, u8, f64)> {
    let mut terms = Vec::with_capacity(6);
    for (node, sign) in ends {
        let components = along_axes(&model.nodes, &mesh.frames, node, axis);
        for (k, factor) in (0_u8..).zip(components) {
            // rounding of cosines
            if factor.abs() > 1e-12 {
                terms.push((node, k, sign * factor));
            }
        }
    }
    terms
}
