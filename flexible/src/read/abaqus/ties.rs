//! `*RIGID BODY`, `*MPC`, `*EQUATION`, `*TIE`, glued `*CONTACT PAIR`; couplings are in [`super::couplings`].

use std::collections::{BTreeMap, BTreeSet};

use super::couplings::bare;
use super::lines::{Row, key};
use super::mean_rotation::{MeanRotation, dependent};
use super::model::Model;
use super::rotations::Rotations;
use super::scope::{Block, label};
use super::shapes::Shape;
use super::surfaces::Surface;
use crate::error::FileProblem;
use crate::fe::vector::subtract;
use crate::mesh::{Carries, Code, Frame, Mesh, Tie};
use crate::read::tied::{Request, doubt, tied};
use crate::read::unread::UnreadCards;
use crate::read::vector::norm;

/// Components of a node as bits: the translations x, y, z from the lowest bit on, then the rotations.
pub(super) const ALL: u8 = 0b11_1111;
pub(super) const TRANSLATIONS: u8 = 0b00_0111;
pub(super) const ROTATIONS: u8 = 0b11_1000;

/// The ties found so far. Each new tie gets the next number.
pub(super) struct Ties<'m, 'u> {
    pub model: &'m Model,
    pub unread: &'u mut UnreadCards,
    /// Nodes whose rotations an element uses.
    pub turning: Vec<bool>,
    pub frames: &'m [Frame],
    /// Whose file it is.
    pub code: Code,
    /// The nodes that turn rigid bodies.
    rotations: &'m Rotations,
    pub made: Vec<Tie>,
    /// New places of nodes.
    moved: Vec<(u32, [f64; 3])>,
    pub doubts: Vec<String>,
    /// The `DCOUP3D` elements whose nodes follow others, as indices into the rows of the model.
    pub spread: BTreeSet<u32>,
}

/// The ties of a mesh, numbered in the order of the file from 1.
pub(super) fn make(
    model: &mut Model,
    mesh: &mut Mesh,
    (rotations, means): (&Rotations, &[MeanRotation]),
    unread: &mut UnreadCards,
) -> Result<(), FileProblem> {
    let mut ties = Ties {
        model,
        unread,
        turning: turning(model),
        frames: &mesh.frames,
        code: mesh.code,
        rotations,
        made: Vec::new(),
        moved: Vec::new(),
        doubts: Vec::new(),
        spread: BTreeSet::new(),
    };
    ties.read()?;
    ties.mean_rotations(means)?;
    ties.note_idle_elements();
    rotations.refuse_ties(&ties.made, ties.unread);
    let Ties {
        made,
        moved,
        doubts,
        ..
    } = ties;
    for (node, place) in moved {
        if let Some(node) = model.nodes.get_mut(node as usize) {
            node.position = place;
        }
    }
    mesh.ties = made;
    mesh.doubts.extend(doubts);
    Ok(())
}

/// Nodes of beams, shells and rotary inertias.
fn turning(model: &Model) -> Vec<bool> {
    let mut turning = vec![false; model.nodes.len()];
    for row in &model.rows {
        if matches!(
            row.shape,
            Shape::Beam { .. } | Shape::Shell(_) | Shape::Rotary
        ) {
            for node in model.row_nodes(row) {
                if let Some(turns) = turning.get_mut(*node as usize) {
                    *turns = true;
                }
            }
        }
    }
    turning
}

/// The manner in which surfaces are tied.
struct Glue {
    /// Largest distance, if stated.
    tolerance: Option<f64>,
    /// Whether nodes move onto the faces first.
    adjust: bool,
    /// Whether rotations follow.
    turns: bool,
    /// The remedy for surfaces that are too far from each other.
    words: &'static str,
}

/// The number of a parameter.
fn tolerance(block: &Block, parameter: &str, written: &str) -> Result<Option<f64>, FileProblem> {
    let keyword = &block.keyword;
    let Some(text) = keyword.get(parameter).filter(|text| !text.is_empty()) else {
        return Ok(None);
    };
    crate::read::number::real(text).map(Some).ok_or_else(|| {
        keyword.problem(
            &format!("{written} is \"{text}\", not a number"),
            format!("give a number, or remove {written}"),
        )
    })
}

/// Names of the surface interactions whose `*SURFACE BEHAVIOR` is tied.
fn glued(model: &Model) -> BTreeSet<String> {
    let mut names = BTreeSet::new();
    let mut open = None;
    for (_, block) in model.blocks() {
        let keyword = &block.keyword;
        match keyword.key.as_str() {
            "SURFACEINTERACTION" => open = keyword.get("NAME").map(key),
            "SURFACEBEHAVIOR" if keyword.choice("PRESSURE-OVERCLOSURE") == "TIED" => {
                names.extend(open.clone());
            }
            _ => {}
        }
    }
    names
}

impl Ties<'_, '_> {
    /// Reads all keywords of ties.
    fn read(&mut self) -> Result<(), FileProblem> {
        let mut waiting: Option<(usize, &Block)> = None;
        let model = self.model;
        let glued = glued(model);
        for (place, block) in model.blocks() {
            let keyword = &block.keyword;
            match keyword.key.as_str() {
                "KINEMATIC" | "DISTRIBUTING" => {
                    let Some((_, coupling)) = waiting.take().filter(|(of, _)| *of == place) else {
                        return Err(keyword.problem(
                            "no *COUPLING precedes it",
                            "put it right after its *COUPLING",
                        ));
                    };
                    self.coupling(place, coupling, block)?;
                    continue;
                }
                "COUPLING" => {
                    if let Some((_, coupling)) = waiting.replace((place, block)) {
                        return Err(bare(coupling));
                    }
                    continue;
                }
                "KINEMATICCOUPLING" => self.kinematic_by_nodes(place, block)?,
                "DISTRIBUTINGCOUPLING" => self.distributing_by_elements(place, block)?,
                "RIGIDBODY" => self.rigid_body(place, block)?,
                "MPC" => self.constraints(place, block)?,
                "EQUATION" => self.equations(place, block)?,
                "TIE" => self.tie(place, block)?,
                "CONTACTPAIR" => self.contact_pair(place, block, &glued)?,
                _ => continue,
            }
        }
        match waiting {
            Some((_, coupling)) => Err(bare(coupling)),
            None => Ok(()),
        }
    }

    pub fn id(&self) -> u64 {
        self.made.len() as u64 + 1
    }

    /// A surface, or a set of nodes, with a name.
    pub fn surface(&self, place: usize, name: &str, user: &Block) -> Result<Surface, FileProblem> {
        if name.is_empty() {
            return Err(user.keyword.problem(
                "a line names one surface",
                "name two surfaces: the one that follows, and the one that leads",
            ));
        }
        let found = self.model.search(place, name, |placed, name| {
            placed
                .surfaces
                .get(&key(name))
                .map(|(_, surface)| surface.clone())
        });
        found.ok_or_else(|| {
            user.keyword.problem(
                &format!("the surface {name} is missing"),
                "add its *SURFACE, or *INCLUDE the file that holds it",
            )
        })
    }

    /// `*TIE`: `slave surface, master surface`.
    fn tie(&mut self, place: usize, block: &Block) -> Result<(), FileProblem> {
        let keyword = &block.keyword;
        if ["CYCLICSYMMETRY", "MULTISTAGE", "MULTIPLIER"]
            .iter()
            .any(|parameter| keyword.has(parameter))
        {
            let name = "*TIE of a sector or a multiplier";
            self.unread.note(name, &keyword.at, Carries::Structure);
            return Ok(());
        }
        let glue = Glue {
            tolerance: tolerance(block, "POSITIONTOLERANCE", "POSITION TOLERANCE")?,
            adjust: keyword.choice("ADJUST") != "NO",
            turns: !keyword.has("NOROTATION"),
            words: "state a larger POSITION TOLERANCE",
        };
        self.glue(place, block, &glue)
    }

    /// `*CONTACT PAIR` of surfaces that are glued: `TIED` of Abaqus, or an interaction with tied
    /// pressure-overclosure of CalculiX. Rotations do not follow, and without `ADJUST` nodes keep their
    /// places.
    fn contact_pair(
        &mut self,
        place: usize,
        block: &Block,
        glued: &BTreeSet<String>,
    ) -> Result<(), FileProblem> {
        let keyword = &block.keyword;
        let interaction = keyword.get("INTERACTION").map(key);
        if !keyword.has("TIED") && !interaction.is_some_and(|name| glued.contains(&name)) {
            self.unread
                .note("*CONTACT PAIR", &keyword.at, Carries::Structure);
            return Ok(());
        }
        let stated = keyword.get("ADJUST").is_some_and(|text| !text.is_empty());
        let glue = Glue {
            tolerance: tolerance(block, "ADJUST", "ADJUST")?,
            adjust: stated,
            turns: false,
            words: "state a larger ADJUST",
        };
        self.glue(place, block, &glue)
    }

    /// Ties the surfaces of each line: the one that follows, and the one that leads.
    fn glue(&mut self, place: usize, block: &Block, glue: &Glue) -> Result<(), FileProblem> {
        let keyword = &block.keyword;
        for row in block.rows.iter().filter(|row| !row.is_blank()) {
            let [follows, leads] = [row.text(0), row.text(1)];
            let slave = self.surface(place, follows, block)?;
            let master = self.surface(place, leads, block)?;
            if master.faces.is_empty() {
                return Err(keyword.problem(
                    &format!("its second surface {leads} has no faces"),
                    "name a surface of element faces second; its nodes lead those of the first",
                ));
            }
            let nodes: Vec<u32> = slave.nodes.iter().map(|(node, _)| *node).collect();
            let request = Request {
                nodes: &nodes,
                faces: &master.faces,
                tolerance: glue.tolerance,
                adjust: glue.adjust,
                turning: glue.turns.then_some(self.turning.as_slice()),
                arms: None,
                facing: false,
            };
            let tied = tied(&self.model.nodes, self.frames, &request, self.id());
            if tied.far == nodes.len() {
                return Err(keyword.problem(
                    &format!("no node of {follows} is near enough to {leads}"),
                    format!("check the surfaces and the units, or {}", glue.words),
                ));
            }
            let at = &keyword.at;
            let place = format!("{}:{}", at.file, at.line);
            let reach = "position tolerance";
            self.doubts
                .extend(doubt(&place, follows, &tied, nodes.len(), reach));
            self.made.extend(tied.ties);
            self.moved.extend(tied.moved);
        }
        Ok(())
    }

    /// `*RIGID BODY, REF NODE=n` of `NSET`, `TIE NSET`, `PIN NSET` (translations only) or `ELSET`.
    fn rigid_body(&mut self, place: usize, block: &Block) -> Result<(), FileProblem> {
        let keyword = &block.keyword;
        let model = self.model;
        let reference = keyword.require("REFNODE", "REF NODE")?;
        let reference = model.node_of(place, reference, &keyword.at)?;
        if keyword.has("ANALYTICALSURFACE") {
            let name = "*RIGID BODY, ANALYTICAL SURFACE";
            self.unread.note(name, &keyword.at, Carries::Structure);
        }
        if keyword.choice("POSITION") == "CENTEROFMASS" {
            let name = "*RIGID BODY, POSITION=CENTER OF MASS";
            self.unread.note(name, &keyword.at, Carries::Unknown);
        }
        let mut components: BTreeMap<u32, u8> = BTreeMap::new();
        for (parameter, bits) in [("NSET", ALL), ("TIENSET", ALL), ("PINNSET", TRANSLATIONS)] {
            if let Some(set) = keyword.get(parameter) {
                for node in model.nodes_of(place, set, &keyword.at)? {
                    *components.entry(node).or_default() |= bits;
                }
            }
        }
        if let Some(set) = keyword.get("ELSET") {
            for node in model.nodes_of_rows(&model.rows_of(place, set, &keyword.at)?) {
                *components.entry(node).or_default() |= ALL;
            }
        }
        components.remove(&reference);
        if components.is_empty() {
            return Err(keyword.problem(
                "it has no nodes except its reference node",
                "give its nodes by NSET, TIE NSET, PIN NSET or ELSET",
            ));
        }
        self.made.push(Tie::Rigid {
            id: self.id(),
            independent: reference,
            dependent: components.into_iter().collect(),
        });
        Ok(())
    }

    /// `*MPC`: `BEAM, a, b`, `TIE, a, b`, `PIN, a, b`: the first node, or each of the first set, depends on
    /// the second. [`MeanRotation`] has `MEANROT`.
    fn constraints(&mut self, place: usize, block: &Block) -> Result<(), FileProblem> {
        let mut mean = false;
        for row in block.rows.iter().filter(|row| !row.is_blank()) {
            let kind = key(row.text(0));
            // they are read by themselves, with the lines after them that begin with 0
            mean = self.code == Code::CalculiX && (kind == "MEANROT" || mean && kind == "0");
            if mean {
                continue;
            }
            if !matches!(kind.as_str(), "BEAM" | "TIE" | "PIN") {
                let name = format!("*MPC {kind}");
                self.unread.note(&name, &row.at, Carries::Structure);
                continue;
            }
            let first = self.model.nodes_of(place, row.text(1), &row.at)?;
            let second = self.model.nodes_of(place, row.text(2), &row.at)?;
            for (a, b) in pairs(&[first, second], row)?
                .iter()
                .filter_map(|nodes| Some((*nodes.first()?, *nodes.get(1)?)))
            {
                let apart = norm(subtract(self.model.position(a), self.model.position(b)));
                match kind.as_str() {
                    "BEAM" => self.spider(b, &[a], ALL, block),
                    // for coincident nodes all three kinds constrain translations in the same way
                    "TIE" if apart == 0.0 => self.spider(b, &[a], ALL, block),
                    "TIE" => self.same(a, b, ALL),
                    _ => self.same(a, b, TRANSLATIONS),
                }
            }
        }
        Ok(())
    }

    /// Adds mean rotations, after the ties that may name their angles.
    fn mean_rotations(&mut self, means: &[MeanRotation]) -> Result<(), FileProblem> {
        let mut taken = dependent(&self.made);
        for mean in means {
            let model = (self.model, self.frames);
            let tie = mean.equation(self.id(), model, &taken, &mut self.doubts)?;
            taken.extend(dependent(std::slice::from_ref(&tie)));
            self.made.push(tie);
        }
        Ok(())
    }

    /// Makes components of a equal to those of b; rotations only where both nodes turn.
    fn same(&mut self, a: u32, b: u32, components: u8) {
        let turns = |node: u32| self.turning.get(node as usize).copied().unwrap_or(false);
        let both = turns(a) && turns(b);
        for freedom in 0..6_u8 {
            if components >> freedom & 1 == 1 && (freedom < 3 || both) {
                self.made.push(Tie::Equation {
                    id: self.id(),
                    terms: vec![(a, freedom, 1.0), (b, freedom, -1.0)],
                });
            }
        }
    }

    /// `*EQUATION`: number of terms, then `node or set, freedom, coefficient` over as many lines as needed.
    /// With sets, each node of the sets has an equation.
    fn equations(&mut self, place: usize, block: &Block) -> Result<(), FileProblem> {
        let mut rows = block.rows.iter().filter(|row| !row.is_blank());
        while let Some(head) = rows.next() {
            let count = label(head.text(0)).ok_or_else(|| {
                head.at.problem(
                    format!(
                        "*EQUATION: the number of terms is \"{}\", not a whole number above zero",
                        head.text(0)
                    ),
                    "write the number of terms on the first line of the equation",
                )
            })?;
            let (mut nodes, mut freedoms) = (Vec::new(), Vec::new());
            while (freedoms.len() as u64) < count {
                let Some(row) = rows.next() else {
                    return Err(head.at.problem(
                        format!("*EQUATION has only {} of its {count} terms", freedoms.len()),
                        "add the missing terms, or correct their number",
                    ));
                };
                let fields = row.fields().len();
                for i in (0..fields).step_by(3) {
                    nodes.push(self.model.nodes_of(place, row.text(i), &row.at)?);
                    freedoms.push((row.freedom(i + 1)?, row.real(i + 2, "a coefficient")?));
                }
            }
            if freedoms.len() as u64 != count {
                return Err(head.at.problem(
                    format!("*EQUATION has {} terms instead of {count}", freedoms.len()),
                    "correct the number of terms",
                ));
            }
            if freedoms.first().is_none_or(|(_, first)| *first == 0.0) {
                return Err(head.at.problem(
                    "*EQUATION: its first coefficient is zero",
                    "give a coefficient other than zero first: its freedom depends on the others",
                ));
            }
            for nodes in pairs(&nodes, head)? {
                let mut terms = Vec::with_capacity(nodes.len());
                for (node, (freedom, coefficient)) in nodes.into_iter().zip(&freedoms) {
                    let (node, freedom) = self.rotations.freedom(node, *freedom, &head.at)?;
                    terms.push((node, freedom, *coefficient));
                }
                self.made.push(Tie::Equation {
                    id: self.id(),
                    terms,
                });
            }
        }
        Ok(())
    }
}

/// Groups of corresponding nodes. The lists have equal lengths, or a list has one node for all groups.
fn pairs(lists: &[Vec<u32>], row: &Row) -> Result<Vec<Vec<u32>>, FileProblem> {
    let longest = lists.iter().map(Vec::len).max().unwrap_or(0);
    let fits = |list: &Vec<u32>| list.len() == longest || list.len() == 1;
    if !lists.iter().all(fits) {
        return Err(row.at.problem(
            "the sets of the terms have different numbers of nodes",
            "give sets with equal numbers of nodes; a single node goes with all nodes of the other sets",
        ));
    }
    Ok((0..longest)
        .map(|i| {
            lists
                .iter()
                .filter_map(|list| list.get(i).or(list.first()).copied())
                .collect()
        })
        .collect())
}
