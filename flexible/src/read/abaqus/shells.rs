//! Position and thickness of shells: `OFFSET`, `*NODAL THICKNESS`.

use std::collections::BTreeMap;

use super::lines::{Keyword, Row};
use super::model::{self, Model};
use super::scope::Block;
use super::shapes::Shape;
use crate::error::FileProblem;
use crate::mesh::{Carries, ShellShape};
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
                            "element {} has NODAL THICKNESS, and its node {id} has none",
                            row.label
                        ),
                        "give the node one in *NODAL THICKNESS",
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

/// Position and thickness of a shell whose section has this thickness; `None` if they are those of the section.
pub(super) fn shape(
    block: &Block,
    of_section: f64,
    (row, model): (&model::Row, &Model),
    nodes: &NodalThickness,
    unread: &mut UnreadCards,
) -> Result<Option<ShellShape>, FileProblem> {
    let share = offset(&block.keyword, unread);
    let varying = of_nodes(block);
    if share == 0.0 && !varying {
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
        ..ShellShape::default()
    }))
}
