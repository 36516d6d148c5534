//! `*INITIAL CONDITIONS, TYPE=TEMPERATURE`: the temperature of the materials.

use super::model::{Model, Row};
use super::shapes::Shape;
use crate::error::FileProblem;

/// The temperature at the start of the nodes of all elements: 0 unless stated; `None` if it differs between nodes.
///
/// # Errors
/// A missing node or set, or text in the place of a temperature.
pub(super) fn initial(model: &Model) -> Result<Option<f64>, FileProblem> {
    let mut of_node = vec![0.0; model.nodes.len()];
    for (place, block) in model.blocks() {
        let keyword = &block.keyword;
        if keyword.key != "INITIALCONDITIONS" || keyword.choice("TYPE") != "TEMPERATURE" {
            continue;
        }
        if keyword.has("FILE") || keyword.has("USER") {
            return Ok(None);
        }
        for row in block.rows.iter().filter(|row| !row.is_blank()) {
            let temperature = row.real(1, "the temperature")?;
            for node in model.nodes_of(place, row.text(0), &row.at)? {
                if let Some(own) = of_node.get_mut(node as usize) {
                    *own = temperature;
                }
            }
        }
    }
    // nodes without a section, such as the ends of springs and masses, need no temperature
    let solid = |row: &&Row| {
        !matches!(
            row.shape,
            Shape::Mass | Shape::Rotary | Shape::Distributing | Shape::Spring(_)
        )
    };
    let rows = model.rows.iter().filter(solid);
    let mut used = rows
        .flat_map(|row| model.row_nodes(row))
        .filter_map(|node| of_node.get(*node as usize).copied());
    let first = used.next().unwrap_or(0.0);
    Ok(used.all(|own| own == first).then_some(first))
}
