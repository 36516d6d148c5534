//! Archives of ANSYS (`.cdb`, by `CDWRITE`): nodes, elements, materials, sections, masses, springs,
//! equations, supports and components become a [`Mesh`].
//!
//! The reader takes the blocked form and the commands that `CDWRITE` and HyperMesh write. A program of APDL
//! (`*DO`, parameters, selections) is refused. A component is a set with its name; `type:N` and `material:N`
//! are sets, too. A property has the name `TYPE:MATERIAL:CONSTANTS:SECTION`. `CERIG` and `RBE3` are equations
//! (`CE`) in an archive.
//!
//! Sources: ANSYS Mechanical APDL Command Reference and Element Reference, 18.2; files of
//! `ansys/pymapdl-reader`.
//!
//! ```text
//! lines ─▶ deck (contents by number) ─▶ elements, points ─▶ mesh
//! ```

mod deck;
mod elements;
mod lines;
mod points;
mod shapes;

use crate::error::FlexibleError;
use crate::mesh::{Code, Mesh, Set};
use crate::read::Files;
use crate::read::labels::Labels;
use crate::read::source::whole;
use deck::Deck;

/// Reads an archive of ANSYS. Values keep the units of the file.
///
/// # Errors
/// With file, line and command: a file that can't be read or isn't an archive, text in the place of a number, a
/// block that is cut, a missing or repeated node or element, a material that depends on the temperature or is
/// not isotropic, an option that changes an element into one that Eng does not compute.
pub fn read_cdb(files: &dyn Files, name: &str) -> Result<Mesh, FlexibleError> {
    let mut deck = Deck::read(files, name)?;
    if deck.nodes.is_empty() {
        return Err(whole(
            name,
            "the file has no node",
            "give an archive of ANSYS with NBLOCK and EBLOCK, as CDWRITE writes it",
        )
        .into());
    }
    let mut mesh = Mesh {
        code: Code::Ansys,
        nodes: std::mem::take(&mut deck.nodes),
        frames: std::mem::take(&mut deck.frames),
        units: deck.units.take(),
        ..Mesh::default()
    };
    let pairs = mesh.nodes.iter().zip(0_u32..);
    let labels = Labels::new(pairs.map(|(node, index)| (node.id, index)).collect());
    if let Some(node) = labels.repeated() {
        let problem = format!("node {node} is defined twice");
        let advice = "write the archive again by CDWRITE; each node needs its own number";
        return Err(whole(name, &problem, advice).into());
    }
    let (elements, rows) = elements::make(&mut deck, &mut mesh, &labels)?;
    if let Some(element) = elements.repeated() {
        let problem = format!("element {element} is defined twice");
        let advice = "write the archive again by CDWRITE; each element needs its own number";
        return Err(whole(name, &problem, advice).into());
    }
    points::make(&deck, rows, &mut mesh, &labels)?;
    points::ties(&deck, &mut mesh, &labels)?;
    points::supports(&deck, &mut mesh, &labels)?;
    for component in deck.components {
        let of_nodes = component.of_nodes;
        let known = if of_nodes { &labels } else { &elements };
        let members = component.ranges.iter();
        let members: Vec<u32> = members
            .flat_map(|(first, last)| known.range(*first, *last, 1, &[]))
            .collect();
        let set = match of_nodes {
            true => Set::new(members, Vec::new()),
            false => Set::new(mesh.nodes_of_all(&members), members),
        };
        mesh.sets.insert(component.name, set);
    }
    mesh.unread = deck.unread.into_list();
    mesh.doubts = deck.doubts;
    Ok(mesh)
}
