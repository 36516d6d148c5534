//! The contents of the datasets, before the mesh is made of them.

use std::collections::BTreeMap;
use std::fmt::Display;
use std::rc::Rc;

use super::descriptors;
use super::lines::{AGAIN, Head, Lines, Record, short};
use crate::error::FileProblem;
use crate::mesh::{Carries, Node};
use crate::read::Files;
use crate::read::source::At;
use crate::read::unread::UnreadCards;

/// The type of a group's member that is a node.
const NODE: i64 = 7;
/// The type of a group's member that is an element.
const ELEMENT: i64 = 8;

/// Groups whose members have four numbers each.
const GROUPS_OF_FOUR: [u32; 4] = [2435, 2452, 2467, 2477];
/// Groups whose members have two numbers each.
const GROUPS_OF_TWO: [u32; 4] = [2417, 2429, 2430, 2432];

/// Datasets without stiffness, mass and constraints.
const NOTHING: [(u32, &str); 11] = [
    (55, "results at nodes"),
    (56, "results at elements"),
    (57, "results at nodes of elements"),
    (58, "functions"),
    (82, "lines for pictures"),
    (151, "header"),
    (1858, "headers of functions"),
    (2400, "header of a model"),
    (2414, "results"),
    (2416, "header of results"),
    (2419, "matrices of results"),
];

/// Datasets of materials, sections and constraints, which Eng does not read.
const STRUCTURE: [(u32, &str); 14] = [
    (71, "elements"),
    (250, "matrix"),
    (754, "constraints"),
    (755, "restraints"),
    (772, "physical properties"),
    (773, "materials"),
    (776, "sections of beams"),
    (789, "physical properties"),
    (791, "restraints"),
    (1703, "materials"),
    (1710, "materials"),
    (1716, "materials"),
    (2437, "physical properties"),
    (2448, "physical properties"),
];

/// A dataset and a line of it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Origin {
    pub dataset: u32,
    pub line: u64,
}

/// An element.
#[derive(Clone, Debug)]
pub(super) struct Row {
    pub id: u64,
    pub descriptor: u32,
    /// Numbers of its tables of physical properties and of materials.
    pub property: i64,
    pub material: i64,
    /// Its nodes in [`Deck::row_nodes`].
    pub nodes: std::ops::Range<usize>,
    pub origin: Origin,
}

/// A member of a group.
#[derive(Clone, Copy, Debug)]
pub(super) struct Member {
    /// Whether it is a node; else an element.
    pub is_node: bool,
    pub label: u64,
    pub origin: Origin,
}

/// A group of nodes and elements.
#[derive(Clone, Debug)]
pub(super) struct Group {
    pub number: i64,
    pub name: String,
    pub members: Vec<Member>,
}

/// The contents of a file.
#[derive(Debug)]
pub(super) struct Deck {
    pub file: Rc<str>,
    pub nodes: Vec<Node>,
    /// Of each node, its origin and the number of the system of its coordinates.
    pub places: Vec<(Origin, i64)>,
    pub rows: Vec<Row>,
    pub row_nodes: Vec<u64>,
    pub groups: Vec<Group>,
    /// Coordinate systems: whether each is the global one, and its line.
    pub systems: BTreeMap<i64, (bool, u64)>,
    /// Units by dataset 164: their name, and metres, kilograms, seconds.
    pub units: Option<(String, [f64; 3])>,
    /// Whether the file has tables of materials, properties or sections.
    pub tables: bool,
    pub unread: UnreadCards,
}

impl Deck {
    /// Reads a file.
    pub fn read(files: &dyn Files, name: &str) -> Result<Deck, FileProblem> {
        let mut lines = Lines::open(files, name)?;
        let mut deck = Deck {
            file: name.into(),
            nodes: Vec::new(),
            places: Vec::new(),
            rows: Vec::new(),
            row_nodes: Vec::new(),
            groups: Vec::new(),
            systems: BTreeMap::new(),
            units: None,
            tables: false,
            unread: UnreadCards::default(),
        };
        while let Some(head) = lines.next()? {
            deck.take(&head, &mut lines)?;
        }
        Ok(deck)
    }

    /// A line of the file.
    pub fn at(&self, origin: Origin) -> At {
        At {
            file: Rc::clone(&self.file),
            line: origin.line,
        }
    }

    /// A problem of an object of a dataset.
    pub fn problem(&self, origin: Origin, problem: impl Display, advice: &str) -> FileProblem {
        let problem = format!("dataset {}: {problem}", origin.dataset);
        self.at(origin).problem(problem, advice)
    }

    fn take(&mut self, head: &Head, lines: &mut Lines) -> Result<(), FileProblem> {
        match head.number {
            15 => self.nodes_on_one_line(lines),
            781 | 2411 => self.nodes(lines),
            780 => self.elements(lines, true),
            2412 => self.elements(lines, false),
            2420 => self.systems(lines),
            164 => self.units(head, lines),
            number if GROUPS_OF_FOUR.contains(&number) => self.groups(lines, 4),
            number if GROUPS_OF_TWO.contains(&number) => self.groups(lines, 2),
            number => {
                let named = |list: &[(u32, &'static str)]| {
                    let found = list.iter().find(|(known, _)| *known == number);
                    found.map(|(_, name)| *name)
                };
                let (name, carries) = match (named(&NOTHING), named(&STRUCTURE)) {
                    (Some(name), _) => (name, Carries::Nothing),
                    (None, Some(name)) => (name, Carries::Structure),
                    (None, None) => ("unknown dataset", Carries::Unknown),
                };
                self.tables |= carries == Carries::Structure;
                let name = format!("{number} ({name})");
                self.unread.note(&name, &head.at, carries);
                lines.skip(head)
            }
        }
    }

    /// Dataset 15: number, system of the coordinates, system of the displacements, colour, x, y, z.
    fn nodes_on_one_line(&mut self, lines: &mut Lines) -> Result<(), FileProblem> {
        while let Some(record) = lines.record()? {
            let ([id, system, ..], position) = record.point()?;
            self.node(&record, id, system, position)?;
        }
        Ok(())
    }

    /// Datasets 781 and 2411: the same with x, y, z on a line of their own.
    fn nodes(&mut self, lines: &mut Lines) -> Result<(), FileProblem> {
        while let Some(record) = lines.record()? {
            let [id, system, _, _] = record.head()?;
            let position = lines.more(&record, &format!("node {id}"))?.vector()?;
            self.node(&record, id, system, position)?;
        }
        Ok(())
    }

    fn node(
        &mut self,
        record: &Record,
        id: i64,
        system: i64,
        position: [f64; 3],
    ) -> Result<(), FileProblem> {
        let id = record.label(id, "a node")?;
        if u32::try_from(self.nodes.len()).is_err() {
            return Err(record.problem("more than 4e9 nodes", "divide the model"));
        }
        self.nodes.push(Node {
            id,
            position,
            frame: None,
        });
        self.places.push((record.origin(), system));
        Ok(())
    }

    /// Dataset 2412: number, descriptor, tables of properties and materials, colour, number of nodes; the
    /// nodes. Dataset 780 has a number of a bin before each table. Beams have the node of their orientation
    /// and two sections on a line before their nodes.
    fn elements(&mut self, lines: &mut Lines, bins: bool) -> Result<(), FileProblem> {
        while let Some(record) = lines.record()? {
            let (id, descriptor, property, material, count) = match bins {
                true => {
                    let [id, kind, _, property, _, material, _, count] = record.head()?;
                    (id, kind, property, material, count)
                }
                false => {
                    let [id, kind, property, material, _, count] = record.head()?;
                    (id, kind, property, material, count)
                }
            };
            let id = record.label(id, "an element")?;
            let descriptor = u32::try_from(descriptor).unwrap_or(0);
            let wanted = descriptors::node_count(descriptor);
            if count < 1 || wanted.is_some_and(|wanted| wanted as i64 != count) {
                let problem = match wanted {
                    Some(wanted) => format!(
                        "element {id} has {count} nodes, but elements with the descriptor {descriptor} have {wanted}"
                    ),
                    None => format!("element {id} has {count} nodes"),
                };
                return Err(record.problem(
                    problem,
                    "write it with the number of nodes of its descriptor",
                ));
            }
            let title = format!("element {id}");
            if descriptors::is_beam(descriptor) {
                lines.more(&record, &title)?.integers(3)?;
            }
            let first = self.row_nodes.len();
            let mut left = usize::try_from(count).unwrap_or(usize::MAX);
            while left > 0 {
                let now = left.min(8);
                let line = lines.more(&record, &title)?;
                for node in line.integers(now)? {
                    self.row_nodes
                        .push(line.label(node, &format!("a node of {title}"))?);
                }
                left -= now;
            }
            self.rows.push(Row {
                id,
                descriptor,
                property,
                material,
                nodes: first..self.row_nodes.len(),
                origin: record.origin(),
            });
        }
        Ok(())
    }

    /// Dataset 2420: a number and a name of the part; for each system its number, type and colour, its name,
    /// three rows of its axes and one of its origin.
    fn systems(&mut self, lines: &mut Lines) -> Result<(), FileProblem> {
        if lines.record()?.is_none() {
            return Ok(());
        }
        lines.name()?;
        while let Some(record) = lines.record()? {
            let [label, kind, _] = record.head()?;
            lines.name()?;
            let mut global = kind == 0;
            for row in 0..4 {
                let title = format!("coordinate system {label}");
                let values = lines.more(&record, &title)?.vector()?;
                for (column, value) in values.into_iter().enumerate() {
                    let identity = if row == column { 1.0 } else { 0.0 };
                    global &= (value - identity).abs() < 1e-12;
                }
            }
            self.systems.insert(label, (global, record.at.line));
        }
        Ok(())
    }

    /// Dataset 164: code and name of the units; factors of length, force and temperature, by which a value of
    /// the file is divided to yield SI. The unit of mass is that of force by that of acceleration.
    fn units(&mut self, head: &Head, lines: &mut Lines) -> Result<(), FileProblem> {
        let cut = || {
            let problem = "dataset 164: the factors of length and force are missing";
            head.at.problem(problem, "write the file again")
        };
        let record = lines.record()?.ok_or_else(cut)?;
        let text = record
            .text
            .trim_start_matches([' ', '0', '1', '2', '3', '4', '5', '6', '7', '8', '9']);
        // the last number is that of the temperature's mode
        let name = text.trim_end_matches(|c: char| c.is_ascii_digit());
        let name = match name.trim() {
            "" => "of dataset 164".to_owned(),
            name => short(name),
        };
        let factors = lines.record()?.ok_or_else(cut)?;
        let [length, force, _] = factors.vector()?;
        let units = [1.0 / length, length / force, 1.0];
        if units.iter().any(|unit| !unit.is_finite() || *unit <= 0.0) {
            return Err(factors.problem(
                format!("the factors of length and force are {length} and {force}"),
                "write factors above zero: 1000 and 1 for millimetres and newtons",
            ));
        }
        let same = |known: &(String, [f64; 3])| known.1 == units;
        if self.units.as_ref().is_some_and(|known| !same(known)) {
            return Err(factors.problem(
                "the file has other units in another dataset 164",
                "write the file again in one set of units",
            ));
        }
        self.units = Some((name, units));
        self.unread.note("164 (units)", &head.at, Carries::Nothing);
        lines.skip(head)
    }

    /// Groups: number, six numbers of sets, number of members; name; members of two or four numbers: type,
    /// label, and further ones.
    fn groups(&mut self, lines: &mut Lines, numbers: usize) -> Result<(), FileProblem> {
        while let Some(record) = lines.record()? {
            let [number, _, _, _, _, _, _, count] = record.head()?;
            let title = format!("group {number}");
            let Some(mut left) = usize::try_from(count)
                .ok()
                .and_then(|count| count.checked_mul(numbers))
            else {
                return Err(record.problem(format!("{title} has {count} members"), AGAIN));
            };
            let mut group = Group {
                number,
                name: lines.name()?,
                members: Vec::new(),
            };
            while left > 0 {
                let now = left.min(8);
                let line = lines.more(&record, &title)?;
                let found = line.integers(now)?;
                for member in found.chunks_exact(numbers) {
                    let (Some(kind), Some(label)) = (member.first(), member.get(1)) else {
                        continue;
                    };
                    if ![NODE, ELEMENT].contains(kind) {
                        let name = "members of groups that are no nodes and elements";
                        self.unread.note(name, &line.at, Carries::Nothing);
                        continue;
                    }
                    group.members.push(Member {
                        is_node: *kind == NODE,
                        label: line.label(*label, &format!("a member of {title}"))?,
                        origin: line.origin(),
                    });
                }
                left -= now;
            }
            self.groups.push(group);
        }
        Ok(())
    }
}
