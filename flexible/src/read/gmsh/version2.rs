//! Sections of format 2.2. Counts are text in binary files too. An element in several groups occurs once
//! for each group.

use super::content::Content;
use super::stream::Stream;
use super::version4::known_type;
use crate::error::FileProblem;

/// Reads `$Nodes`.
pub(super) fn nodes(stream: &mut Stream, content: &mut Content<'_>) -> Result<(), FileProblem> {
    for _ in 0..count(stream)? {
        let tag = number(stream, "the number of a node")?;
        let position = stream.vector("a coordinate of a node")?;
        content.node(stream, tag, position)?;
    }
    content.end_nodes(stream)
}

/// Reads `$Elements`: in text `number type count tags… nodes…`, in binary groups `type count-of-elements
/// count-of-tags` before `number tags… nodes…`. The first tag is the number of the group: zero without a
/// group, negative if the element is reversed.
pub(super) fn elements(stream: &mut Stream, content: &mut Content<'_>) -> Result<(), FileProblem> {
    let total = count(stream)?;
    let mut done = 0;
    let (mut tags, mut nodes) = (Vec::new(), Vec::new());
    while done < total {
        let mut own = 0;
        if !stream.binary {
            own = number(stream, "the number of an element")?;
        }
        let kind_number = stream.integer("the type of elements")?;
        let kind = known_type(stream, kind_number)?;
        let mut together = 1;
        if stream.binary {
            together = number(stream, "the number of elements of a group")?.max(1);
        }
        let tag_count = number(stream, "the number of tags")?;
        for _ in 0..together {
            if stream.binary {
                own = number(stream, "the number of an element")?;
            }
            tags.clear();
            for _ in 0..tag_count {
                let tag = stream.integer("a tag of an element")?;
                // entity and partitions follow the group
                if tags.is_empty() {
                    tags.push(i64::from(tag).abs());
                }
            }
            tags.retain(|group| *group != 0);
            nodes.clear();
            for _ in 0..kind.nodes {
                nodes.push(number(stream, "a node of an element")?);
            }
            content.element(stream, own, (kind_number, kind), &tags, &nodes, true)?;
        }
        done += together;
    }
    Ok(())
}

/// A count in a line of its own, text always.
fn count(stream: &mut Stream) -> Result<u64, FileProblem> {
    let line = stream.text_line()?.unwrap_or_default();
    line.parse().map_err(|_| {
        let found = line.chars().take(40).collect::<String>();
        stream.problem_of_line(
            format!("its count is \"{found}\", not a whole number"),
            "write the file again; it is damaged",
        )
    })
}

/// A whole number above or equal to zero.
fn number(stream: &mut Stream, what: &str) -> Result<u64, FileProblem> {
    let found = stream.integer(what)?;
    u64::try_from(found).map_err(|_| {
        stream.problem(
            format!("{what} is {found}"),
            "write the file again; it is damaged",
        )
    })
}
