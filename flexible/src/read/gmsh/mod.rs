//! Meshes of gmsh (`.msh`): formats 4.1 and 2.2, text and binary.
//!
//! Volumes become elements. Points, lines and surfaces only add their nodes to groups, except for groups of triangles and
//! quadrangles that are stated to be shells. A physical group becomes a set with its name and `physical:TAG`
//! (`physical:DIMENSION:TAG` if groups of several dimensions share the number). The file has no material, so the
//! properties, one for each group of volumes or shells, have none either; [`Mesh::set_material`] sets it.

mod content;
mod shapes;
mod stream;
mod version2;
mod version4;

use crate::error::{FileProblem, FlexibleError};
use crate::mesh::{Carries, Mesh};
use crate::read::source::whole;
use crate::read::{Files, ShellGroups};
use content::{Content, full_name};
use stream::Stream;

/// Reads a mesh of gmsh. A mesh with shells may have no volume. Values keep the units of the file.
///
/// # Errors
/// With file and line, or byte of a binary file: a file that can't be read or isn't a mesh of gmsh of format
/// 4.1 or 2.2, text in the place of a number, a missing node, elements of third order or with nodes inside,
/// a mesh in partitions, one without volumes and shells, a group of shells without triangles and quadrangles.
pub(super) fn read_msh(
    files: &dyn Files,
    name: &str,
    shells: ShellGroups<'_>,
) -> Result<Mesh, FlexibleError> {
    let mut stream = Stream::open(files, name)?;
    let mut content = Content::new(shells);
    let mut version = None;
    let mut seen = Vec::new();
    while let Some(section) = stream.next_section()? {
        let Some(format) = version else {
            if section != "MeshFormat" {
                return Err(stream
                    .problem_of_line(
                        "the file does not begin with $MeshFormat",
                        "give a mesh file of gmsh (.msh) of format 4.1 or 2.2",
                    )
                    .into());
            }
            version = Some(read_format(&mut stream)?);
            continue;
        };
        let place = stream.place();
        if ["Nodes", "Elements", "MeshFormat"].contains(&section.as_str()) {
            if seen.contains(&section) || section == "MeshFormat" {
                return Err(stream
                    .problem_of_line("this section appears twice", "write the file again")
                    .into());
            }
            seen.push(section.clone());
        }
        match (section.as_str(), format) {
            ("PhysicalNames", _) => {
                names(&mut stream, &mut content)?;
                continue;
            }
            ("Entities", Version::Four) => version4::entities(&mut stream, &mut content)?,
            ("Nodes", Version::Four) => version4::nodes(&mut stream, &mut content)?,
            ("Nodes", Version::Two) => version2::nodes(&mut stream, &mut content)?,
            ("Elements", Version::Four) => version4::elements(&mut stream, &mut content)?,
            ("Elements", Version::Two) => version2::elements(&mut stream, &mut content)?,
            ("PartitionedEntities" | "GhostElements" | "ParametricNodes", _) => {
                return Err(stream
                    .problem_of_line(
                        "the mesh has partitions or parametric nodes, which Eng does not read",
                        "remove the partitions, set Mesh.SaveParametric = 0 and write the mesh again",
                    )
                    .into());
            }
            (name, _) => {
                let lost = match name {
                    "NodeData"
                    | "ElementData"
                    | "ElementNodeData"
                    | "Comments"
                    | "Comment"
                    | "InterpolationScheme"
                    | "Parametrizations" => Carries::Nothing,
                    _ => Carries::Unknown,
                };
                content.unread(name, place, lost);
                stream.skip(name)?;
                continue;
            }
        }
        stream.end(&section)?;
    }
    check_shells(name, &content)?;
    if content.mesh.elements.is_empty() {
        return Err(whole(
            name,
            "the file has no volume elements",
            "mesh the volumes (gmsh -3); to save them, set Mesh.SaveAll = 1 or give them a physical group",
        )
        .into());
    }
    Ok(content.into_mesh())
}

/// Each stated group of shells has elements, and its name means one group.
fn check_shells(file: &str, content: &Content<'_>) -> Result<(), FileProblem> {
    if let Some(group) = content.group_without_shells() {
        let known = content.named_surfaces();
        let known = match known.is_empty() {
            true => "no group of surfaces has a name".to_owned(),
            false => format!("groups of surfaces are {}", known.join(", ")),
        };
        return Err(whole(
            file,
            format!("the group {group} has no triangle and no quadrangle; {known}"),
            "correct the name in `shells`, or give the surface a physical group before meshing",
        ));
    }
    if let Some((group, tag)) = content.number_of_several_groups() {
        return Err(whole(
            file,
            format!("groups of several dimensions have the number of {group} in `shells`"),
            format!("write {} for its surfaces", full_name((2, tag))),
        ));
    }
    Ok(())
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Version {
    Two,
    Four,
}

/// Reads `$MeshFormat`: version, text (0) or binary (1), bytes of a number. A binary file continues with the
/// integer 1, which shows the order of bytes.
fn read_format(stream: &mut Stream) -> Result<Version, FileProblem> {
    let version = match stream.word()?.as_str() {
        "4.1" => Version::Four,
        "2" | "2.0" | "2.1" | "2.2" => Version::Two,
        other => {
            let other = other.chars().take(20).collect::<String>();
            return Err(stream.problem(
                format!("Eng does not read format {other} of gmsh"),
                "write the mesh with Mesh.MshFileVersion = 4.1 or 2.2",
            ));
        }
    };
    let binary = stream.integer("whether the file is binary")? != 0;
    let size = stream.integer("the size of numbers")?;
    if size != 8 {
        return Err(stream.problem(
            format!("the file has numbers of {size} bytes instead of 8"),
            "write the mesh on a machine with numbers of 8 bytes",
        ));
    }
    if binary {
        stream.text_line()?;
        stream.binary = true;
        match stream.integer("the integer 1")? {
            1 => {}
            0x0100_0000 => stream.swapped = true,
            _ => {
                return Err(stream.problem(
                    "the order of bytes cannot be determined",
                    "copy the file again as binary; a copy as text damages it",
                ));
            }
        }
    }
    stream.end("MeshFormat")?;
    Ok(version)
}

/// Reads `$PhysicalNames`, text in binary files too: `dimension number "name"`.
fn names(stream: &mut Stream, content: &mut Content<'_>) -> Result<(), FileProblem> {
    let mut left = None;
    loop {
        let Some(line) = stream.text_line()? else {
            return stream.end("PhysicalNames");
        };
        if line == "$EndPhysicalNames" {
            return Ok(());
        }
        if left.is_none() {
            left = Some(line);
            continue;
        }
        let mut words = line.splitn(3, char::is_whitespace);
        let mut number = || words.next().and_then(|word| word.parse::<i64>().ok());
        let (dimension, tag) = (number(), number());
        let (Some(dimension @ 0..=3), Some(tag)) = (dimension, tag) else {
            return Err(stream.problem_of_line(
                format!(
                    "\"{}\" is no name of a group",
                    line.chars().take(40).collect::<String>()
                ),
                "write each line as: dimension, number, name in quotes",
            ));
        };
        let name = words.next().unwrap_or("").trim().trim_matches('"').trim();
        if !name.is_empty() {
            content
                .names
                .insert((dimension as u8, tag.abs()), name.to_string()); // 0 to 3
        }
    }
}
