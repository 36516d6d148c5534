//! Divides an input file into parts, instances and the input outside of them.

use std::collections::BTreeMap;

use super::frames::{Motion, NodeSystem, STILL, system};
use super::lines::{Keyword, Line, Lines, Row, key, squeezed};
use super::materials::Materials;
use super::scope::{Block, ElementRow, Member, NodeRow, Scope, SetBlock, label, required_label};
use super::shapes::Shape;
use super::unread::{KEPT, carries};
use crate::error::FileProblem;
use crate::mesh::Carries;
use crate::read::Files;
use crate::read::source::At;
use crate::read::unread::UnreadCards;

/// An instance in the form of the file.
#[derive(Debug)]
pub(super) struct Instance {
    /// Its name.
    pub name: String,
    /// The name of its part.
    pub part: String,
    /// The motion that places the part.
    pub motion: Motion,
    /// Its additions to the part.
    pub own: Scope,
    /// Its place in the file.
    pub at: At,
}

/// The contents of a file.
#[derive(Debug, Default)]
pub(super) struct Deck {
    /// Parts by name (capitals).
    pub parts: BTreeMap<String, Scope>,
    /// Instances in their order.
    pub instances: Vec<Instance>,
    /// The input outside all parts.
    pub root: Scope,
    /// Materials.
    pub materials: Materials,
    /// Keywords that Eng does not read.
    pub unread: UnreadCards,
    /// Parts with their places.
    declared: Vec<(String, At)>,
    /// The scope that receives blocks.
    place: Place,
    /// Whether a `*STEP` is open.
    in_step: bool,
    /// Steps so far.
    steps: u32,
    /// The motion of the last `*SYSTEM`.
    system: Option<Motion>,
}

#[derive(Clone, Debug, Default, PartialEq, Eq)]
enum Place {
    #[default]
    Root,
    Part(String),
    Instance,
}

/// A block that is being read.
enum Open {
    Nodes {
        system: NodeSystem,
        set: Option<SetBlock>,
    },
    Elements {
        shape: Shape,
        name: String,
        set: Option<SetBlock>,
        pending: Vec<String>,
        at: Option<At>,
    },
    /// Elements of an unknown type, and what is lost with them.
    Lost(String, Carries),
    Set(SetBlock, bool),
    Block(Block),
    Skipped,
}

/// Reads a file and all its included files.
pub(super) fn read(files: &dyn Files, name: &str) -> Result<Deck, FileProblem> {
    let mut lines = Lines::open(files, name)?;
    let mut deck = Deck::default();
    let mut open = None;
    while let Some(line) = lines.next_line()? {
        match line {
            Line::Keyword(keyword) if keyword.key == "INCLUDE" => {
                // the included file may continue the block before it
                let file = keyword.require("INPUT", "INPUT")?;
                if deck.in_step {
                    deck.materials.step("INCLUDE");
                    let name = "*INCLUDE in a *STEP";
                    deck.unread.note(name, &keyword.at, Carries::Nothing);
                } else {
                    lines.include(file, &keyword.at)?;
                }
            }
            Line::Keyword(keyword) => {
                if let Some(block) = open.take() {
                    deck.close(block)?;
                }
                let input = keyword.get("INPUT").map(str::to_string);
                let at = keyword.at.clone();
                let block = deck.open(keyword)?;
                // the data of a keyword that is not read are not needed
                let needed = match &block {
                    Open::Skipped => false,
                    Open::Block(block) => KEPT.contains(&block.keyword.key.as_str()),
                    _ => true,
                };
                if let (Some(file), true) = (input, needed) {
                    lines.include(&file, &at)?;
                }
                open = Some(block);
            }
            Line::Row(row) => match &mut open {
                Some(block) => deck.row(block, row)?,
                None if row.is_blank() => {}
                None => {
                    return Err(row.at.problem(
                        "the file does not begin with a keyword",
                        "give an Abaqus or CalculiX input file, which begins with *HEADING, *NODE or another keyword",
                    ));
                }
            },
        }
    }
    if let Some(block) = open.take() {
        deck.close(block)?;
    }
    Ok(deck)
}

impl Deck {
    fn scope(&mut self) -> &mut Scope {
        match &self.place {
            Place::Part(name) => self.parts.entry(name.clone()).or_default(),
            Place::Instance => match self.instances.last_mut() {
                Some(instance) => &mut instance.own,
                None => &mut self.root,
            },
            Place::Root => &mut self.root,
        }
    }

    /// Begins the block of a keyword.
    fn open(&mut self, keyword: Keyword) -> Result<Open, FileProblem> {
        if self.in_step {
            return Ok(self.open_in_step(keyword));
        }
        match keyword.key.as_str() {
            "STEP" => {
                self.in_step = true;
                self.steps += 1;
                self.unread.note("*STEP", &keyword.at, Carries::Nothing);
                Ok(Open::Skipped)
            }
            "PART" => self.open_part(&keyword),
            "INSTANCE" => self.open_instance(keyword),
            "ENDPART" | "ENDINSTANCE" => {
                self.place = Place::Root;
                self.system = None;
                Ok(Open::Skipped)
            }
            "NODE" => Ok(Open::Nodes {
                system: NodeSystem::of(&keyword, self.system.unwrap_or(STILL))?,
                set: new_set(&keyword, "NSET", true),
            }),
            "ELEMENT" => self.open_elements(&keyword),
            "NSET" | "ELSET" => open_set(&keyword),
            _ => Ok(Open::Block(Block {
                keyword,
                rows: Vec::new(),
                step: 0,
            })),
        }
    }

    /// Begins the block of a keyword after `*STEP`. Eng reads only supports there.
    fn open_in_step(&mut self, keyword: Keyword) -> Open {
        match keyword.key.as_str() {
            "ENDSTEP" => self.in_step = false,
            "BOUNDARY" => {
                return Open::Block(Block {
                    keyword,
                    rows: Vec::new(),
                    step: self.steps,
                });
            }
            name => {
                self.materials.step(name);
                let lost = match name {
                    "MODELCHANGE" => Carries::Structure,
                    _ => Carries::Nothing,
                };
                let name = format!("*{} in a *STEP", keyword.name);
                self.unread.note(&name, &keyword.at, lost);
            }
        }
        Open::Skipped
    }

    fn open_part(&mut self, keyword: &Keyword) -> Result<Open, FileProblem> {
        let name = key(keyword.require("NAME", "NAME")?);
        self.enter(keyword)?;
        if self.parts.insert(name.clone(), Scope::default()).is_some() {
            return Err(keyword.problem(
                &format!("the part {name} is defined twice"),
                "rename or remove one of them",
            ));
        }
        self.declared.push((name.clone(), keyword.at.clone()));
        self.place = Place::Part(name);
        self.system = None;
        Ok(Open::Skipped)
    }

    /// Begins an instance. Its rows give its position.
    fn open_instance(&mut self, keyword: Keyword) -> Result<Open, FileProblem> {
        let name = keyword.require("NAME", "NAME")?.to_string();
        self.enter(&keyword)?;
        let mut others = self.instances.iter();
        if others.any(|other| key(&other.name) == key(&name)) {
            return Err(keyword.problem(
                &format!("the instance {name} is defined twice"),
                "rename or remove one of them",
            ));
        }
        if keyword.has("LIBRARY") {
            let name = "*INSTANCE of a LIBRARY";
            self.unread.note(name, &keyword.at, Carries::Structure);
        }
        self.instances.push(Instance {
            name,
            part: keyword.get("PART").unwrap_or("").to_string(),
            motion: STILL,
            own: Scope::default(),
            at: keyword.at.clone(),
        });
        self.place = Place::Instance;
        self.system = None;
        Ok(Open::Block(Block {
            keyword,
            rows: Vec::new(),
            step: 0,
        }))
    }

    fn open_elements(&mut self, keyword: &Keyword) -> Result<Open, FileProblem> {
        let name = squeezed(keyword.require("TYPE", "TYPE")?);
        let set = new_set(keyword, "ELSET", false);
        Ok(match Shape::of(&name) {
            Some(shape) => Open::Elements {
                shape,
                name,
                set,
                pending: Vec::new(),
                at: None,
            },
            None => {
                // the set exists even if it stays empty
                self.scope().sets.extend(set);
                let lost = match name.as_str() {
                    "DASHPOT1" | "DASHPOT2" | "DASHPOTA" => Carries::Nothing,
                    _ => Carries::Structure,
                };
                Open::Lost(format!("*ELEMENT, TYPE={name}"), lost)
            }
        })
    }

    /// Refuses a part or instance inside another.
    fn enter(&self, keyword: &Keyword) -> Result<(), FileProblem> {
        if self.place == Place::Root {
            return Ok(());
        }
        Err(keyword.problem(
            "the part or instance before this line is still open",
            "end it with *END PART or *END INSTANCE before this line",
        ))
    }

    fn row(&mut self, open: &mut Open, row: Row) -> Result<(), FileProblem> {
        match open {
            Open::Nodes { system, set } => {
                if row.is_blank() {
                    return Ok(());
                }
                let label = required_label(row.text(0), "a node", &row.at)?;
                let position = system.place(row.vector(1, "a coordinate")?);
                if position.iter().any(|x| !x.is_finite()) {
                    return Err(row.at.problem(
                        format!("the position of node {label} is not finite"),
                        "check its coordinates",
                    ));
                }
                if let Some(set) = set {
                    set.add(label);
                }
                self.scope().nodes.push(NodeRow {
                    label,
                    position,
                    at: row.at,
                });
            }
            Open::Elements {
                shape,
                name,
                set,
                pending,
                at,
            } => {
                if row.is_blank() {
                    return Ok(());
                }
                if pending.is_empty() {
                    *at = Some(row.at.clone());
                }
                let fields = row.fields();
                pending.extend(fields.iter().map(|field| field.to_string()));
                let needed = 1 + shape.node_count();
                // a beam may name one more node, for its direction
                let spare = usize::from(matches!(shape, Shape::Beam { .. }));
                if pending.len() > needed + spare {
                    return Err(row.at.problem(
                        format!(
                            "element {} has {} nodes; {name} has {}",
                            pending.first().map_or("", String::as_str),
                            pending.len() - 1,
                            shape.node_count()
                        ),
                        "check the TYPE of *ELEMENT; a line may be missing",
                    ));
                }
                if pending.len() >= needed {
                    let fields = std::mem::take(pending);
                    let label = self.element(*shape, &fields, &row.at)?;
                    if let Some(set) = set {
                        set.add(label);
                    }
                }
            }
            Open::Lost(name, lost) => {
                if !row.is_blank() {
                    self.unread.note(name, &row.at, *lost);
                }
            }
            Open::Set(set, generate) => set.row(&row, *generate)?,
            Open::Block(block) => {
                if KEPT.contains(&block.keyword.key.as_str()) {
                    block.rows.push(row);
                }
            }
            Open::Skipped => {}
        }
        Ok(())
    }

    fn element(&mut self, shape: Shape, fields: &[String], at: &At) -> Result<u64, FileProblem> {
        let scope = self.scope();
        let first = scope.labels.len();
        let Some((number, nodes)) = fields.split_first() else {
            return Ok(0); // never without fields
        };
        let number = required_label(number, "an element", at)?;
        for node in nodes {
            let place = scope.labels.len();
            match label(node) {
                Some(node) => scope.labels.push(node),
                None if node.contains('.') => {
                    scope.qualified.insert(place, node.clone());
                    scope.labels.push(0);
                }
                None => {
                    return Err(at.problem(
                        format!("element {number}: a node is \"{node}\""),
                        "write each node as a whole number above zero",
                    ));
                }
            }
        }
        scope.elements.push(ElementRow {
            label: number,
            shape,
            first,
            count: nodes.len(),
            at: at.clone(),
        });
        Ok(number)
    }

    fn close(&mut self, open: Open) -> Result<(), FileProblem> {
        match open {
            Open::Nodes { set, .. } => self.scope().sets.extend(set),
            Open::Elements {
                shape,
                name,
                set,
                pending,
                at,
            } => {
                if let (Some(at), Some(label)) = (at, pending.first()) {
                    return Err(at.problem(
                        format!(
                            "element {label} has {} of the {} nodes of {name}",
                            pending.len() - 1,
                            shape.node_count()
                        ),
                        "check the TYPE of *ELEMENT; a line may be missing",
                    ));
                }
                self.scope().sets.extend(set);
            }
            Open::Set(set, _) => self.scope().sets.push(set),
            Open::Block(block) => self.block(block)?,
            Open::Lost(..) | Open::Skipped => {}
        }
        Ok(())
    }

    fn block(&mut self, block: Block) -> Result<(), FileProblem> {
        if self.materials.read(&block, &mut self.unread)? {
            return Ok(());
        }
        let keyword = &block.keyword;
        match keyword.key.as_str() {
            "INSTANCE" => {
                let motion = Motion::read(&block.rows)?;
                if let Some(instance) = self.instances.last_mut() {
                    instance.motion = motion;
                }
            }
            "SYSTEM" => self.system = Some(system(&block.rows, &keyword.at)?),
            "ASSEMBLY" | "ENDASSEMBLY" | "HEADING" => {}
            // they give the temperature of the materials, and the axes of couplings and anisotropic solids
            "INITIALCONDITIONS" | "ORIENTATION" | "DISTRIBUTION" | "DISTRIBUTIONTABLE" => {
                let name = format!("*{}", keyword.name);
                self.unread.note(&name, &keyword.at, Carries::Nothing);
                self.scope().blocks.push(block);
            }
            name if KEPT.contains(&name) => self.scope().blocks.push(block),
            name => {
                let lost = carries(name);
                let name = format!("*{}", keyword.name);
                self.unread.note(&name, &keyword.at, lost);
            }
        }
        Ok(())
    }

    /// Instances with the contents of their parts. A part without an instance is listed.
    pub fn placed(&mut self) -> Result<Vec<(Instance, Scope)>, FileProblem> {
        let instances = std::mem::take(&mut self.instances);
        let mut uses: BTreeMap<String, usize> = BTreeMap::new();
        for instance in &instances {
            *uses.entry(key(&instance.part)).or_default() += 1;
        }
        let mut placed = Vec::with_capacity(instances.len());
        for mut instance in instances {
            let name = key(&instance.part);
            let left = uses.entry(name.clone()).or_default();
            *left = left.saturating_sub(1);
            let part = if *left == 0 {
                self.parts.remove(&name)
            } else {
                self.parts.get(&name).cloned()
            };
            let mut scope = match part {
                Some(part) => part,
                None if name.is_empty() => Scope::default(),
                None => {
                    return Err(instance.at.problem(
                        format!(
                            "*INSTANCE {}: the part {} is missing",
                            instance.name, instance.part
                        ),
                        "add its *PART, or *INCLUDE the file that contains it",
                    ));
                }
            };
            scope.append(std::mem::take(&mut instance.own));
            placed.push((instance, scope));
        }
        for (name, at) in &self.declared {
            if self.parts.contains_key(name) {
                let name = "*PART without *INSTANCE";
                self.unread.note(name, at, Carries::Structure);
            }
        }
        Ok(placed)
    }
}

/// Begins `*NSET` or `*ELSET`.
fn open_set(keyword: &Keyword) -> Result<Open, FileProblem> {
    let of_nodes = keyword.key == "NSET";
    keyword.require(&keyword.key, &keyword.key)?;
    let Some(mut set) = new_set(keyword, &keyword.key, of_nodes) else {
        return Ok(Open::Skipped);
    };
    set.instance = keyword.get("INSTANCE").map(str::to_string);
    // in CalculiX and Abaqus, `ELSET` makes a node set of the nodes of an element set
    if let Some(from) = keyword.get("ELSET").filter(|_| of_nodes) {
        set.members.push(Member::NodesOf(from.to_string()));
    }
    Ok(Open::Set(set, keyword.has("GENERATE")))
}

/// The set that a parameter names.
fn new_set(keyword: &Keyword, parameter: &str, of_nodes: bool) -> Option<SetBlock> {
    let name = keyword.get(parameter).filter(|name| !name.is_empty())?;
    Some(SetBlock {
        of_nodes,
        name: name.to_string(),
        instance: None,
        members: Vec::new(),
        at: keyword.at.clone(),
    })
}
