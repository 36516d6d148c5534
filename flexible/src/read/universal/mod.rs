//! Universal files of I-deas (`.unv`, `.uff`): nodes, solids, rigid elements and groups become a [`Mesh`], normal modes
//! become [`crate::read::matrix::ForeignModes`].
//!
//! A group is a set with its name and `group:N`; `material:N` is a set, too. A property is a table of
//! physical properties and has its number as name. Materials and thicknesses are in tables that are not read,
//! so the properties have no material; [`Mesh::set_material`] sets it. Lines and surfaces on solids of a file
//! without such tables only add their nodes to groups.
//!
//! Sources: SDRC I-DEAS universal file formats, datasets 15, 164, 780, 781, 2411, 2412, 2420, 2467
//! (University of Cincinnati, Structural Dynamics Research Laboratory); order of nodes: files of gmsh 4.15.
//!
//! ```text
//! lines ─┬▶ deck (contents of datasets) ─▶ elements, groups ─▶ mesh
//!        └▶ modes
//! ```

mod deck;
mod descriptors;
mod lines;
mod modes;

pub use modes::read_unv_modes;

use std::collections::BTreeMap;

use crate::error::{FileProblem, FlexibleError};
use crate::mesh::{Carries, ElementKind, Mesh, Property, Section, Set, Tie, Variant};
use crate::read::Files;
use crate::read::builder::{NewElement, Once, add_element};
use crate::read::labels::Labels;
use crate::read::source::whole;
use deck::{Deck, Origin, Row};
use descriptors::Class;

/// Reads a universal file. Values keep the units of the file.
///
/// # Errors
/// With file, line and dataset: a file that can't be read or is cut, text in the place of a number, a missing
/// or repeated node or element, coordinates in a system that is not the global one, a file without solids.
pub fn read_unv(files: &dyn Files, name: &str) -> Result<Mesh, FlexibleError> {
    let mut deck = Deck::read(files, name)?;
    if deck.nodes.is_empty() {
        let advice = "write the mesh with its nodes (dataset 2411) and elements (dataset 2412)";
        return Err(whole(name, "the file has no node", advice).into());
    }
    in_global_axes(&deck)?;
    let labels = labels_of(&deck, true)?;
    let rows = labels_of(&deck, false)?;
    let mut mesh = Mesh {
        nodes: std::mem::take(&mut deck.nodes),
        units: deck.units.take(),
        ..Mesh::default()
    };
    let nodes = elements(&mut deck, &mut mesh, &labels)?;
    if mesh.elements.is_empty() {
        return Err(whole(
            name,
            "the file has no solid element",
            "mesh the volumes and write them; of beams and shells the file has no section that Eng reads",
        )
        .into());
    }
    groups(&deck, &mut mesh, (&labels, &rows), &nodes)?;
    mesh.unread = deck.unread.into_list();
    Ok(mesh)
}

/// Refuses nodes in a system of coordinates that is not the global one.
fn in_global_axes(deck: &Deck) -> Result<(), FileProblem> {
    for (node, (origin, system)) in deck.nodes.iter().zip(&deck.places) {
        let problem = match (deck.systems.get(system), system) {
            (Some((true, _)), _) | (None, 0 | 1) => continue,
            (Some((false, line)), system) => {
                format!("system {system} (line {line}), which is turned, moved or not Cartesian")
            }
            (None, system) => format!("system {system}, which dataset 2420 does not define"),
        };
        return Err(deck.problem(
            *origin,
            format!("node {} has coordinates of {problem}", node.id),
            "write the nodes in the global coordinate system",
        ));
    }
    Ok(())
}

/// The nodes or the elements by their numbers, each of which is unique.
fn labels_of(deck: &Deck, of_nodes: bool) -> Result<Labels, FileProblem> {
    let found: Vec<(u64, Origin)> = if of_nodes {
        let places = deck.nodes.iter().zip(&deck.places);
        places
            .map(|(node, (origin, _))| (node.id, *origin))
            .collect()
    } else {
        deck.rows.iter().map(|row| (row.id, row.origin)).collect()
    };
    let labels = Labels::new(found.iter().map(|(id, _)| *id).zip(0_u32..).collect());
    let Some(repeated) = labels.repeated() else {
        return Ok(labels);
    };
    let mut origins = found.iter().filter(|(id, _)| *id == repeated);
    let (Some((_, first)), Some((_, second))) = (origins.next(), origins.next()) else {
        return Ok(labels);
    };
    let kind = if of_nodes { "node" } else { "element" };
    Err(deck.problem(
        *second,
        format!(
            "{kind} {repeated} is defined again; line {} defines it first",
            first.line
        ),
        "write the file again; each node and each element needs its own number",
    ))
}

/// Makes the elements and rigid ties of a mesh. Returns for each row the index of its solid, or its nodes.
fn elements(
    deck: &mut Deck,
    mesh: &mut Mesh,
    labels: &Labels,
) -> Result<Vec<Result<u32, Vec<u32>>>, FileProblem> {
    let mut properties: Once<i64, Property> = Once::default();
    let mut of_materials: BTreeMap<i64, Vec<u32>> = BTreeMap::new();
    let mut solid = vec![false; mesh.nodes.len()];
    let mut made = Vec::with_capacity(deck.rows.len());
    let mut thin = Vec::new();
    for (place, row) in deck.rows.iter().enumerate() {
        let nodes = nodes_of(deck, row, labels)?;
        match descriptors::class(row.descriptor) {
            Class::Solid(kind) => {
                for node in &nodes {
                    if let Some(solid) = solid.get_mut(*node as usize) {
                        *solid = true;
                    }
                }
                let property = property(&mut properties, row.property);
                let nodes = ordered(kind, nodes);
                let new = NewElement {
                    id: row.id,
                    kind,
                    variant: Variant::Plain,
                    property,
                    shell: None,
                };
                let index = add_element(mesh, new, &nodes, None)
                    .map_err(|many| many.at(&deck.at(row.origin)))?;
                of_materials.entry(row.material).or_default().push(index);
                made.push(Ok(index));
                continue;
            }
            Class::Thin => thin.push(place),
            Class::Rigid => {
                if let Some((first, others)) = nodes.split_first() {
                    mesh.ties.push(Tie::Rigid {
                        id: row.id,
                        independent: *first,
                        dependent: others.iter().map(|node| (*node, 0b11_1111)).collect(),
                    });
                }
            }
            Class::Other(carries) => {
                let name = descriptors::name(row.descriptor);
                deck.unread.note(&name, &deck.at(row.origin), carries);
            }
        }
        made.push(Err(nodes));
    }
    // without tables of materials and properties, a shell on a solid can only be its face
    for place in thin {
        let (Some(row), Some(Err(nodes))) = (deck.rows.get(place), made.get(place)) else {
            continue;
        };
        let on_solid = |node: &u32| solid.get(*node as usize) == Some(&true);
        let face = !deck.tables && nodes.iter().all(on_solid);
        let (name, carries) = match face {
            true => ("lines and surfaces on solids".to_owned(), Carries::Nothing),
            false => (descriptors::name(row.descriptor), Carries::Structure),
        };
        deck.unread.note(&name, &deck.at(row.origin), carries);
    }
    mesh.properties = properties.all;
    for (material, elements) in of_materials {
        let set = Set::new(mesh.nodes_of_all(&elements), elements);
        mesh.sets.insert(format!("material:{material}"), set);
    }
    Ok(made)
}

/// The property of a number, which is made once.
fn property(properties: &mut Once<i64, Property>, number: i64) -> u32 {
    properties.find(&number).unwrap_or_else(|| {
        let property = Property {
            name: number.to_string(),
            material: None,
            section: Section::Solid,
        };
        properties.add(number, property)
    })
}

/// The indices of the nodes of an element, in the order of the file.
fn nodes_of(deck: &Deck, row: &Row, labels: &Labels) -> Result<Vec<u32>, FileProblem> {
    let title = || format!("element {}", row.id);
    let given = deck.row_nodes.get(row.nodes.clone()).unwrap_or(&[]);
    let mut nodes = Vec::with_capacity(given.len());
    for node in given {
        let index = labels.find(*node).ok_or_else(|| {
            deck.problem(
                row.origin,
                format!("{} uses node {node}, which is missing", title()),
                "write the whole mesh with all its nodes",
            )
        })?;
        if nodes.contains(&index) {
            return Err(deck.problem(
                row.origin,
                format!("{} uses node {node} twice", title()),
                "write a wedge or tetrahedron in place of a solid with collapsed edges",
            ));
        }
        nodes.push(index);
    }
    Ok(nodes)
}

/// The nodes of a solid in the order of its kind.
fn ordered(kind: ElementKind, nodes: Vec<u32>) -> Vec<u32> {
    match kind.description().names.universal_order {
        Some(order) => (order.iter())
            .filter_map(|place| nodes.get(*place).copied())
            .collect(),
        None => nodes,
    }
}

/// Makes the sets of the groups.
fn groups(
    deck: &Deck,
    mesh: &mut Mesh,
    (labels, rows): (&Labels, &Labels),
    made: &[Result<u32, Vec<u32>>],
) -> Result<(), FileProblem> {
    for group in &deck.groups {
        let (mut nodes, mut elements) = (Vec::new(), Vec::new());
        for member in &group.members {
            let (known, kind) = match member.is_node {
                true => (labels, "node"),
                false => (rows, "element"),
            };
            let index = known.find(member.label).ok_or_else(|| {
                deck.problem(
                    member.origin,
                    format!(
                        "group {} has {kind} {}, which is missing",
                        group.number, member.label
                    ),
                    "write the whole mesh, or the groups of the written part alone",
                )
            })?;
            match (member.is_node, made.get(index as usize)) {
                (true, _) => nodes.push(index),
                (false, Some(Ok(solid))) => elements.push(*solid),
                (false, Some(Err(others))) => nodes.extend(others),
                (false, None) => {}
            }
        }
        nodes.extend(mesh.nodes_of_all(&elements));
        let set = Set::new(nodes, elements);
        let named = Some(group.name.clone()).filter(|name| !name.is_empty());
        for name in named.into_iter().chain([format!("group:{}", group.number)]) {
            let into = mesh.sets.entry(name).or_default();
            *into = std::mem::take(into).joined(&set);
        }
    }
    Ok(())
}
