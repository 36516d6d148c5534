//! The contents of a mesh file: nodes, volumes, shells, groups.

use std::collections::{BTreeMap, HashMap};

use super::shapes::Type;
use super::stream::Stream;
use crate::error::FileProblem;
use crate::mesh::{
    Carries, ElementKind, Mesh, Node, Property, Section, Set, ShellSection, Unread, Variant,
};
use crate::read::ShellGroups;
use crate::read::builder::{NewElement, Once, TooMany, add_element};
use crate::read::labels::Labels;

/// Dimension and number of a physical group.
pub(super) type Group = (u8, i64);

/// The name of a group by its number.
fn short_name(tag: i64) -> String {
    format!("physical:{tag}")
}

/// The name of a group whose number groups of other dimensions share.
pub(super) fn full_name((dimension, tag): Group) -> String {
    format!("physical:{dimension}:{tag}")
}

/// Whether a group of another dimension has the number of this one.
fn is_shared(used: &[Group], (dimension, tag): Group) -> bool {
    let mut used = used.iter();
    used.any(|(other, same)| *same == tag && *other != dimension)
}

/// The contents read so far.
#[derive(Debug)]
pub(super) struct Content<'s> {
    /// The surfaces that are shells.
    shells: ShellGroups<'s>,
    /// Names of groups.
    pub names: BTreeMap<Group, String>,
    /// Groups of each entity (dimension, number).
    pub groups_of: BTreeMap<(u8, i32), Vec<i64>>,
    /// The mesh so far.
    pub mesh: Mesh,
    labels: Option<Labels>,
    /// Nodes and elements of the groups.
    sets: BTreeMap<Group, (Vec<u32>, Vec<u32>)>,
    /// Properties by the dimension and the group that gives their name.
    properties: Once<(u8, Option<i64>), Property>,
    /// Elements by their nodes, for files that repeat an element for each of its groups.
    by_nodes: HashMap<Vec<u32>, u32>,
    lower: Option<Unread>,
}

impl<'s> Content<'s> {
    /// Of a file that is not read yet.
    pub fn new(shells: ShellGroups<'s>) -> Self {
        Content {
            shells,
            names: BTreeMap::new(),
            groups_of: BTreeMap::new(),
            mesh: Mesh::default(),
            labels: None,
            sets: BTreeMap::new(),
            properties: Once::default(),
            by_nodes: HashMap::new(),
            lower: None,
        }
    }

    /// A stated group of shells to which no element belongs.
    pub fn group_without_shells(&self) -> Option<&'s str> {
        let made = |name: &str| self.surfaces_named(name).next().is_some();
        let mut groups = self.shells.groups.iter().map(String::as_str);
        groups.find(|name| !made(name))
    }

    /// A stated `physical:TAG` that names a group of shells and groups of other dimensions, with its tag.
    pub fn number_of_several_groups(&self) -> Option<(&'s str, i64)> {
        let used = self.used_groups();
        let mut groups = self.shells.groups.iter().map(String::as_str);
        groups.find_map(|name| {
            let mut tags = self.surfaces_named(name);
            let by_number = |tag: &i64| {
                let own = self.names.get(&(2, *tag));
                own.is_none_or(|own| own != name) && name == short_name(*tag)
            };
            let tag = tags.find(|tag| by_number(tag) && is_shared(&used, (2, *tag)))?;
            Some((name, tag))
        })
    }

    /// The groups with shells that have this name or number. Each element is in all of its groups, also if another one gives
    /// its property.
    fn surfaces_named(&self, name: &str) -> impl Iterator<Item = i64> {
        let shells = self
            .sets
            .iter()
            .filter(|((dimension, _), (_, elements))| *dimension == 2 && !elements.is_empty());
        let tags = shells.map(|((_, tag), _)| *tag);
        tags.filter(move |tag| self.is_named(*tag, name))
    }

    /// Whether a group of surfaces has this name or number.
    fn is_named(&self, tag: i64, name: &str) -> bool {
        let own = self.names.get(&(2, tag)).map(String::as_str);
        own == Some(name) || name == short_name(tag) || name == full_name((2, tag))
    }

    /// All groups of the file, with elements or a name.
    fn used_groups(&self) -> Vec<Group> {
        let named = self.names.keys();
        self.sets.keys().chain(named).copied().collect()
    }

    /// The names of groups of surfaces.
    pub fn named_surfaces(&self) -> Vec<&str> {
        let surfaces = self
            .names
            .iter()
            .filter(|((dimension, _), _)| *dimension == 2);
        surfaces.map(|(_, name)| name.as_str()).collect()
    }

    /// The first of the groups of an element whose surfaces are shells, with its stated name.
    fn shell_group(&self, dimension: u8, groups: &[i64]) -> Option<(i64, &'s str)> {
        if dimension != 2 || self.shells.groups.is_empty() {
            return None;
        }
        groups.iter().find_map(|group| {
            let mut wanted = self.shells.groups.iter();
            let found = wanted.find(|name| self.is_named(*group, name))?;
            Some((*group, found.as_str()))
        })
    }

    /// Keeps a node.
    pub fn node(
        &mut self,
        stream: &Stream,
        tag: u64,
        position: [f64; 3],
    ) -> Result<(), FileProblem> {
        if tag == 0 || u32::try_from(self.mesh.nodes.len()).is_err() {
            return Err(stream.problem(
                format!("the number of a node is {tag}, or the mesh has more than 4e9 nodes"),
                "give nodes numbers from 1, and divide a model with more than 4e9 nodes",
            ));
        }
        self.mesh.nodes.push(Node {
            id: tag,
            position,
            frame: None,
        });
        Ok(())
    }

    /// Ends the nodes.
    pub fn end_nodes(&mut self, stream: &Stream) -> Result<(), FileProblem> {
        let pairs = self.mesh.nodes.iter().zip(0_u32..);
        let labels = Labels::new(pairs.map(|(node, index)| (node.id, index)).collect());
        if let Some(tag) = labels.repeated() {
            return Err(stream.problem(
                format!("node {tag} is defined twice"),
                "write the file again; each node needs its own number",
            ));
        }
        self.labels = Some(labels);
        Ok(())
    }

    /// Keeps an element of these groups with its nodes in the file's order.
    pub fn element(
        &mut self,
        stream: &Stream,
        tag: u64,
        (number, kind): (i32, Type),
        groups: &[i64],
        tags: &[u64],
        repeated: bool,
    ) -> Result<(), FileProblem> {
        let Some(labels) = &self.labels else {
            return Err(stream.problem(
                "this element comes before the nodes",
                "write the file again with $Nodes before $Elements",
            ));
        };
        let mut nodes = Vec::with_capacity(tags.len());
        for node in tags {
            nodes.push(labels.find(*node).ok_or_else(|| {
                stream.problem(
                    format!("element {tag} uses node {node}, which is missing"),
                    "write the whole mesh with all its nodes",
                )
            })?);
        }
        let shell = self.shell_group(kind.dimension, groups);
        if kind.dimension < 3 && shell.is_none() {
            for group in groups {
                let set = self.sets.entry((kind.dimension, *group)).or_default();
                set.0.extend(&nodes);
            }
            self.lower
                .get_or_insert_with(|| Unread {
                    name: "elements of points, lines and surfaces".into(),
                    count: 0,
                    first: stream.place(),
                    carries: Carries::Nothing,
                })
                .count += 1;
            return Ok(());
        }
        let dimension = kind.dimension;
        let Some(kind) = kind.kind else {
            let shape = match shell {
                Some(_) => "a surface",
                None => "a volume",
            };
            return Err(stream.problem(
                format!("element {tag} is {shape} of type {number}, which Eng does not read"),
                "mesh with order 1, or with order 2 and Mesh.SecondOrderIncomplete = 1",
            ));
        };
        if let Some(order) = kind.description().names.gmsh_order {
            nodes = order
                .iter()
                .filter_map(|place| nodes.get(*place).copied())
                .collect();
        }
        let index = match self.by_nodes.get(&nodes) {
            Some(index) if repeated => *index,
            _ => {
                let property = match shell {
                    Some((group, name)) => self.property_of_shells(group, name),
                    None => self.property_of_volumes(groups.first().copied()),
                };
                self.keep(stream, (tag, kind), property, nodes, repeated)?
            }
        };
        for group in groups {
            let set = self.sets.entry((dimension, *group)).or_default();
            set.1.push(index);
        }
        Ok(())
    }

    /// The property of the shells of a group.
    fn property_of_shells(&mut self, group: i64, name: &str) -> u32 {
        let by = (2, Some(group));
        if let Some(made) = self.properties.find(&by) {
            return made;
        }
        let property = Property {
            name: name.into(),
            material: None,
            section: Section::Shell(ShellSection::plate(self.shells.thickness)),
        };
        self.properties.add(by, property)
    }

    /// The property of the volumes whose first group this is.
    fn property_of_volumes(&mut self, group: Option<i64>) -> u32 {
        let by = (3, group);
        if let Some(made) = self.properties.find(&by) {
            return made;
        }
        let name = match group {
            Some(group) => self.names.get(&(3, group)).cloned(),
            None => Some("volumes".into()),
        };
        let property = Property {
            name: name.unwrap_or_else(|| short_name(group.unwrap_or(0))),
            material: None,
            section: Section::Solid,
        };
        self.properties.add(by, property)
    }

    /// Keeps an element of the mesh.
    fn keep(
        &mut self,
        stream: &Stream,
        (tag, kind): (u64, ElementKind),
        property: u32,
        nodes: Vec<u32>,
        repeated: bool,
    ) -> Result<u32, FileProblem> {
        let new = NewElement {
            id: tag,
            kind,
            variant: Variant::Plain,
            property,
            shell: None,
        };
        let index = add_element(&mut self.mesh, new, &nodes, None).map_err(|_| {
            let (problem, advice) = TooMany::WORDS;
            stream.problem(problem, advice)
        })?;
        if repeated {
            self.by_nodes.insert(nodes, index);
        }
        Ok(index)
    }

    /// Adds a section to the list of unread ones.
    pub fn unread(&mut self, name: &str, place: (String, u64), carries: Carries) {
        let name = format!("${name}");
        match self.mesh.unread.iter_mut().find(|known| known.name == name) {
            Some(known) => known.count += 1,
            None => self.mesh.unread.push(Unread {
                name,
                count: 1,
                first: place,
                carries,
            }),
        }
    }

    /// The mesh. A group is a set with its name and `physical:TAG`. Groups of several dimensions with one
    /// number have the names `physical:DIMENSION:TAG`; groups with one name are one set.
    pub fn into_mesh(mut self) -> Mesh {
        let mut sets: BTreeMap<String, Set> = BTreeMap::new();
        let used = self.used_groups();
        for ((dimension, tag), (mut nodes, elements)) in std::mem::take(&mut self.sets) {
            nodes.extend(self.mesh.nodes_of_all(&elements));
            let set = Set::new(nodes, elements);
            let number = match is_shared(&used, (dimension, tag)) {
                true => full_name((dimension, tag)),
                false => short_name(tag),
            };
            let name = self.names.get(&(dimension, tag)).cloned();
            for name in name.into_iter().chain([number]) {
                let into = sets.entry(name).or_default();
                *into = std::mem::take(into).joined(&set);
            }
        }
        self.mesh.sets = sets;
        self.mesh.properties = self.properties.all;
        self.mesh.unread.extend(self.lower);
        self.mesh.unread.sort_by(|a, b| a.name.cmp(&b.name));
        self.mesh
    }
}
