//! Sections of format 4.1; text and binary hold the same numbers in the same order.

use super::content::Content;
use super::shapes::Type;
use super::stream::Stream;
use crate::error::FileProblem;

/// Reads `$Entities`: the groups of each entity. The number of a group is negative if the entity is reversed
/// in it.
pub(super) fn entities(stream: &mut Stream, content: &mut Content<'_>) -> Result<(), FileProblem> {
    let mut counts = [0; 4];
    for count in &mut counts {
        *count = stream.size("the number of entities")?;
    }
    for (dimension, count) in (0_u8..).zip(counts) {
        for _ in 0..count {
            let tag = stream.integer("the number of an entity")?;
            // a point, or the corners of a box
            let coordinates = if dimension == 0 { 3 } else { 6 };
            for _ in 0..coordinates {
                stream.real("a coordinate of an entity")?;
            }
            let groups = stream.size("the number of groups of an entity")?;
            for _ in 0..groups {
                let group = i64::from(stream.integer("the number of a group")?).abs();
                let of = content.groups_of.entry((dimension, tag)).or_default();
                if !of.contains(&group) {
                    of.push(group);
                }
            }
            if dimension > 0 {
                let bounding = stream.size("the number of bounding entities")?;
                for _ in 0..bounding {
                    stream.integer("the number of a bounding entity")?;
                }
            }
        }
    }
    Ok(())
}

/// Reads `$Nodes`: blocks of numbers, then coordinates, perhaps with parameters on their entity.
pub(super) fn nodes(stream: &mut Stream, content: &mut Content<'_>) -> Result<(), FileProblem> {
    let blocks = head(stream)?;
    let mut tags = Vec::new();
    for _ in 0..blocks {
        let dimension = dimension(stream)?;
        stream.integer("the number of an entity")?;
        let parametric = stream.integer("whether nodes have parameters")? != 0;
        let count = stream.size("the number of nodes of a block")?;
        tags.clear();
        for _ in 0..count {
            tags.push(stream.size("the number of a node")?);
        }
        for tag in &tags {
            let position = stream.vector("a coordinate of a node")?;
            if parametric {
                for _ in 0..dimension {
                    stream.real("a parameter of a node")?;
                }
            }
            content.node(stream, *tag, position)?;
        }
    }
    content.end_nodes(stream)
}

/// Reads `$Elements`: blocks of elements of an entity and a type.
pub(super) fn elements(stream: &mut Stream, content: &mut Content<'_>) -> Result<(), FileProblem> {
    let blocks = head(stream)?;
    let mut nodes = Vec::new();
    for _ in 0..blocks {
        let dimension = dimension(stream)?;
        let entity = stream.integer("the number of an entity")?;
        let number = stream.integer("the type of elements")?;
        let kind = known_type(stream, number)?;
        let count = stream.size("the number of elements of a block")?;
        let groups = content
            .groups_of
            .get(&(dimension, entity))
            .cloned()
            .unwrap_or_default();
        for _ in 0..count {
            let tag = stream.size("the number of an element")?;
            nodes.clear();
            for _ in 0..kind.nodes {
                nodes.push(stream.size("a node of an element")?);
            }
            content.element(stream, tag, (number, kind), &groups, &nodes, false)?;
        }
    }
    Ok(())
}

/// The type of a number.
pub(super) fn known_type(stream: &Stream, number: i32) -> Result<Type, FileProblem> {
    Type::of(number).ok_or_else(|| {
        stream.problem(
            format!("gmsh has no elements of type {number} that Eng knows"),
            "mesh with elements of order 1 or 2, or write the file again if it is damaged",
        )
    })
}

/// Number of blocks; counts and smallest and largest numbers follow.
fn head(stream: &mut Stream) -> Result<u64, FileProblem> {
    let blocks = stream.size("the number of blocks")?;
    for what in ["a count", "the smallest number", "the largest number"] {
        stream.size(what)?;
    }
    Ok(blocks)
}

fn dimension(stream: &mut Stream) -> Result<u8, FileProblem> {
    match stream.integer("the dimension of an entity")? {
        found @ 0..=3 => Ok(found as u8), // 0 to 3
        found => Err(stream.problem(
            format!("the dimension of an entity is {found}, not 0 to 3"),
            "write the file again; it is damaged",
        )),
    }
}
