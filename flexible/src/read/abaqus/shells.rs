//! Position, thickness and layers of shells: `OFFSET`, `*NODAL THICKNESS`, `COMPOSITE`.

use std::collections::BTreeMap;

use super::lines::{Keyword, Row};
use super::model::{self, Model};
use super::scope::Block;
use super::shapes::Shape;
use crate::error::FileProblem;
use crate::fe::vector::{cross, norm, subtract};
use crate::mesh::{Carries, ShellAxis, ShellShape};
use crate::read::number;
use crate::read::unread::UnreadCards;

/// Most corners of a shell.
const CORNERS: usize = 4;

/// Thickness at nodes, by their index.
#[derive(Debug, Default)]
pub(super) struct NodalThickness(BTreeMap<u32, f64>);

impl NodalThickness {
    /// Reads all `*NODAL THICKNESS`: `node or set, thickness`. The last value of a node counts.
    pub fn read(model: &Model, unread: &mut UnreadCards) -> Result<Self, FileProblem> {
        let mut found = BTreeMap::new();
        for (place, block) in model.blocks() {
            let keyword = &block.keyword;
            if keyword.key != "NODALTHICKNESS" {
                continue;
            }
            if keyword.has("GENERATE") {
                let name = "*NODAL THICKNESS, GENERATE";
                unread.note(name, &keyword.at, Carries::Structure);
                continue;
            }
            for row in block.rows.iter().filter(|row| !row.is_blank()) {
                let thickness = row.real(1, "the thickness")?;
                for node in model.nodes_of(place, row.text(0), &row.at)? {
                    found.insert(node, thickness);
                }
            }
        }
        Ok(NodalThickness(found))
    }

    /// Thickness at the corners of a shell.
    fn corners(&self, row: &model::Row, model: &Model) -> Result<Vec<f64>, FileProblem> {
        let corners = match row.shape {
            Shape::Shell(kind) => kind.corner_count(),
            _ => 0,
        };
        let corners = model.row_nodes(row).iter().take(corners);
        corners
            .map(|node| {
                self.0.get(node).copied().ok_or_else(|| {
                    let id = model.nodes.get(*node as usize).map_or(0, |node| node.id);
                    row.at.problem(
                        format!(
                            "element {} takes NODAL THICKNESS, but its node {id} has no thickness",
                            row.label
                        ),
                        "give the node a thickness in *NODAL THICKNESS",
                    )
                })
            })
            .collect()
    }
}

/// The share of the thickness by which the nodes lie above the middle surface: `OFFSET`.
fn offset(keyword: &Keyword, unread: &mut UnreadCards) -> f64 {
    match keyword.choice("OFFSET").as_str() {
        "" => 0.0,
        "SPOS" => 0.5,
        "SNEG" => -0.5,
        other => number::real(other).unwrap_or_else(|| {
            // a distribution over the elements
            let name = format!("*{}, OFFSET={other}", keyword.name);
            unread.note(&name, &keyword.at, Carries::Structure);
            0.0
        }),
    }
}

/// Whether the thickness is that of the nodes.
fn of_nodes(block: &Block) -> bool {
    block.keyword.has("NODALTHICKNESS")
}

/// The thickness in the data line of a section, or the mean of that of the element's nodes.
pub(super) fn thickness(
    block: &Block,
    line: Option<&Row>,
    (row, model): (&model::Row, &Model),
    nodes: &NodalThickness,
) -> Result<Option<f64>, FileProblem> {
    if of_nodes(block) {
        let own = nodes.corners(row, model)?;
        return Ok(Some(own.iter().sum::<f64>() / own.len().max(1) as f64));
    }
    line.map(|line| line.real(0, "the thickness")).transpose()
}

/// A layer: thickness, material, angle (rad).
pub(super) type LayerRow<'r> = (f64, &'r str, f64);

/// The layers of `*SHELL SECTION, COMPOSITE`: `thickness, points, material, angle`, from the lower surface to the
/// upper.
pub(super) fn layers<'r>(
    block: &'r Block,
    unread: &mut UnreadCards,
) -> Result<Vec<LayerRow<'r>>, FileProblem> {
    let keyword = &block.keyword;
    let mut found = Vec::new();
    for row in block.rows.iter().filter(|row| !row.is_blank()) {
        let material = row.text(2);
        if material.is_empty() {
            return Err(row.at.problem(
                "the layer has no material",
                "write the layer as: thickness, points, material, angle",
            ));
        }
        let written = row.text(3);
        let angle = match written.is_empty() {
            true => 0.0,
            false => number::real(written).unwrap_or_else(|| {
                let name = format!("*{}, COMPOSITE: layers with an orientation", keyword.name);
                unread.note(&name, &row.at, Carries::Structure);
                0.0
            }),
        };
        found.push((row.real(0, "the thickness")?, material, angle.to_radians()));
    }
    if found.is_empty() {
        return Err(keyword.problem(
            "the laminate has no layer",
            "write one line for each layer: thickness, points, material, angle",
        ));
    }
    if keyword.has("SYMMETRIC") {
        let mirrored: Vec<_> = found.iter().rev().copied().collect();
        found.extend(mirrored);
    }
    Ok(found)
}

/// The first axis of a directed section: the projection of x onto the surface, or of z where x is within 0.1° of
/// its normal. Other orientations are noted as not read.
fn axis(block: &Block, (row, model): (&model::Row, &Model), unread: &mut UnreadCards) -> ShellAxis {
    let keyword = &block.keyword;
    let turned = model
        .places
        .get(row.place)
        .is_some_and(|placed| placed.motion().turns());
    if keyword.has("ORIENTATION") || turned {
        let name = match turned {
            false => format!("*{}, ORIENTATION", keyword.name),
            true => "layers in a turned *INSTANCE".into(),
        };
        unread.note(&name, &keyword.at, Carries::Structure);
    }
    let mut corners = model
        .row_nodes(row)
        .iter()
        .map(|node| model.position(*node));
    let normal = match (corners.next(), corners.next(), corners.next()) {
        (Some(a), Some(b), Some(c)) => cross(subtract(b, a), subtract(c, a)),
        _ => [0.0; 3],
    };
    let x = [1.0, 0.0, 0.0];
    let tilt = norm(cross(x, normal));
    match tilt <= libm::sin(0.1f64.to_radians()) * norm(normal) {
        true => ShellAxis::Direction([0.0, 0.0, 1.0], 0.0),
        false => ShellAxis::Direction(x, 0.0),
    }
}

/// Position, thickness and axes of a shell whose section has this thickness; `None` if they are those of the
/// section. An isotropic section is not `directed`.
pub(super) fn shape(
    block: &Block,
    (of_section, directed): (f64, bool),
    (row, model): (&model::Row, &Model),
    nodes: &NodalThickness,
    unread: &mut UnreadCards,
) -> Result<Option<ShellShape>, FileProblem> {
    let share = offset(&block.keyword, unread);
    let varying = of_nodes(block);
    if share == 0.0 && !varying && !directed {
        return Ok(None);
    }
    let mut thickness = [of_section; CORNERS];
    if varying {
        for (own, found) in thickness.iter_mut().zip(nodes.corners(row, model)?) {
            *own = found;
        }
    }
    Ok(Some(ShellShape {
        offsets: thickness.map(|thickness| -share * thickness),
        thickness: varying.then_some(thickness),
        axis: match directed {
            true => axis(block, (row, model), unread),
            false => ShellAxis::Side(0.0),
        },
    }))
}
