//! A table of nodes as text: a line `node, x, y, z` for each, the mesh of a body whose stiffness and mass
//! come from matrices.

use super::Files;
use super::matrix::text::{NUMBERS, Text, count, real};
use super::source::whole;
use crate::error::FlexibleError;
use crate::mesh::{Mesh, Node};
use std::collections::BTreeMap;

/// The fields of a line, parted by commas, semicolons or blanks.
pub(super) fn fields(line: &str) -> Vec<&str> {
    let apart = |c: char| matches!(c, ',' | ';') || c.is_ascii_whitespace();
    line.split(apart)
        .filter(|field| !field.is_empty())
        .collect()
}

/// Reads the nodes. Values keep the units of the file. A first line of words is the heading; lines that begin
/// with `#` are comments.
///
/// # Errors
/// With file and line: a line that is no node, a repeated number; a file without nodes.
pub fn read_nodes(files: &dyn Files, file: &str) -> Result<Mesh, FlexibleError> {
    let mut text = Text::open(files, file)?;
    let mut nodes: Vec<Node> = Vec::new();
    let mut lines: BTreeMap<u64, u64> = BTreeMap::new();
    let mut heading = true;
    while let Some(line) = text.next_line()? {
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        let fields = fields(line);
        let words = fields.iter().all(|field| real(field).is_none());
        if std::mem::take(&mut heading) && words {
            if let [node, x, y, z] = fields.as_slice()
                && ["x", "y", "z"]
                    .iter()
                    .zip([x, y, z])
                    .all(|(a, b)| b.trim_matches('"').eq_ignore_ascii_case(a))
                && !node.is_empty()
            {
                continue;
            }
            return Err(text
                .wrong(
                    "the heading \"node,x,y,z\"",
                    "name the columns node, x, y, z, or leave the heading out",
                )
                .into());
        }
        let node = match fields.as_slice() {
            [id, x, y, z] => count(id)
                .filter(|id| *id > 0)
                .zip(real(x))
                .zip(real(y).zip(real(z)))
                .map(|((id, x), (y, z))| (id, [x, y, z])),
            _ => None,
        };
        let Some((id, position)) = node else {
            return Err(text.wrong("a node \"number, x, y, z\"", NUMBERS).into());
        };
        if let Some(first) = lines.insert(id, text.line()) {
            return Err(text
                .problem(
                    format!("node {id} is in line {first}, too"),
                    "give each node one line",
                )
                .into());
        }
        nodes.push(Node {
            id,
            position,
            frame: None,
        });
    }
    if nodes.is_empty() {
        return Err(whole(
            file,
            "the file has no node",
            "write a line `node, x, y, z` for each node of the interface",
        )
        .into());
    }
    Ok(Mesh {
        nodes,
        ..Mesh::default()
    })
}
