//! Glued surfaces of NX Nastran: the pairs of `BGSET` and `BGADD`, and their regions `BSURF`, `BSURFS`, `BCPROP` and
//! `BCPROPS` (NX Nastran, Quick Reference Guide); glued bodies of MSC Nastran are in [`contact`].
//!
//! Nastran joins the surfaces by stiff springs. Here the nodes of the source region follow the faces of the target
//! region, as in [`crate::read::tied`], and keep their distance. On shells the rotations of the target's nodes turn
//! this distance.

mod contact;

use std::collections::{BTreeMap, BTreeSet};

use super::card::{Card, Ids};
use super::grids::Lookup;
use super::lines::At;
use super::sections::{CaseControl, Selection};
use super::supports::{add_sum, chosen};
use super::unread::UnreadCards;
use crate::element::around;
use crate::error::FileProblem;
use crate::mesh::{Element, Mesh, Section, Tie};
use crate::read::tied::{Face, Request, Tied, doubt, tied};
use contact::Contact;

/// Nastran's search distance (length of the deck) where the card states none.
const SEARCH: f64 = 10.0;

/// The elements whose faces make a region.
#[derive(Clone, Debug)]
enum Part {
    /// Shells by their numbers.
    Shells(Ids),
    /// A face of a solid: element, and three corners.
    Face(u64, [u64; 3]),
    /// Elements of properties: shells, or the outer faces of solids.
    Properties { ids: Ids, solid: bool },
}

/// A source and a target region that are glued.
#[derive(Clone, Debug)]
struct Pair {
    set: u64,
    source: u64,
    target: u64,
    search: f64,
    at: At,
}

/// The cards of regions. Contact uses them, too.
const REGIONS: [&str; 4] = ["BSURF", "BSURFS", "BCPROP", "BCPROPS"];

/// Cards of glue.
#[derive(Debug, Default)]
pub(super) struct Glue {
    regions: BTreeMap<u64, Vec<(Part, At)>>,
    /// Cards of regions that are wrong, by their numbers; `None` if even the number is. They matter for glue
    /// alone.
    wrong: BTreeMap<Option<u64>, FileProblem>,
    pairs: Vec<Pair>,
    sets: BTreeSet<u64>,
    sums: BTreeMap<u64, Vec<u64>>,
    contact: Contact,
}

/// Ties of all pairs, and the remarks of the reader about them.
pub(super) type Glued = (Vec<Tie>, Vec<String>);

impl Glue {
    /// Reads a card; `false` if it is none of these.
    pub fn read(&mut self, card: &Card) -> Result<bool, FileProblem> {
        match card.name.as_str() {
            "BGADD" => add_sum(&mut self.sums, card)?,
            "BGSET" => self.pairs(card)?,
            name if Self::is_region(name) => {
                let lost = card.lost_problem().map_or(Ok(()), Err);
                if let Err(problem) = lost.and_then(|()| self.regions_of(card)) {
                    let id = card.id(0, "ID").ok();
                    self.wrong.entry(id).or_insert(problem);
                }
            }
            _ => return self.contact.read(card),
        }
        Ok(true)
    }

    /// Whether a card states a region. A wrong one is no error of the deck, unless glue uses it.
    pub fn is_region(name: &str) -> bool {
        REGIONS.contains(&name)
    }

    fn regions_of(&mut self, card: &Card) -> Result<(), FileProblem> {
        match card.name.as_str() {
            "BSURF" => self.region(card, Part::Shells(card.ids(1, card.len(), "EID")?)),
            "BSURFS" => {
                for first in (4..card.len()).step_by(4) {
                    if (first..first + 4).all(|i| card.is_blank(i)) {
                        continue;
                    }
                    let mut corners = [0; 3];
                    for (i, corner) in (1..).zip(&mut corners) {
                        *corner = card.id(first + i, &format!("G{i}"))?;
                    }
                    self.region(card, Part::Face(card.id(first, "EID")?, corners))?;
                }
                Ok(())
            }
            name => {
                let ids = card.ids(1, card.len(), "IP")?;
                let solid = name == "BCPROPS";
                self.region(card, Part::Properties { ids, solid })
            }
        }
    }

    fn region(&mut self, card: &Card, part: Part) -> Result<(), FileProblem> {
        let parts = self.regions.entry(card.id(0, "ID")?).or_default();
        parts.push((part, card.at.clone()));
        Ok(())
    }

    /// `BGSET GSID SID1 TID1 SDIST1 blank EXT1 / blank SID2 TID2 SDIST2 …`: a pair on each line.
    fn pairs(&mut self, card: &Card) -> Result<(), FileProblem> {
        let set = card.id(0, "GSID")?;
        self.sets.insert(set);
        for line in (0..card.len()).step_by(8) {
            if line > 0 && (1..4).all(|i| card.is_blank(line + i)) {
                continue;
            }
            let search = card.optional_real(line + 3, "SDIST")?.unwrap_or(SEARCH);
            if search.is_nan() || search < 0.0 {
                return Err(card.problem(
                    &format!("the search distance is {search}"),
                    "state the largest distance between the surfaces, or leave SDIST blank for 10",
                ));
            }
            self.pairs.push(Pair {
                set,
                source: card.id(line + 1, "SID")?,
                target: card.id(line + 2, "TID")?,
                search,
                at: card.at.clone(),
            });
        }
        Ok(())
    }

    /// The ties of the pairs that case control selects. `properties` has the property card of each element.
    ///
    /// # Errors
    /// A selected set, region, element or face that is missing; surfaces that are too far apart.
    pub fn ties(
        &self,
        mesh: &Mesh,
        properties: &[u64],
        lookup: &Lookup,
        case: &CaseControl,
        unread: &mut UnreadCards,
    ) -> Result<Glued, FileProblem> {
        if self.pairs.is_empty() && self.contact.is_empty() {
            return Ok(Glued::default());
        }
        let mut joining = Joining {
            faces: Faces {
                mesh,
                properties,
                lookup,
                outer: None,
            },
            turning: turning(mesh),
            following: BTreeSet::new(),
            // equations of cards have the numbers of their sets
            next: mesh.ties.iter().map(Tie::id).max().unwrap_or(0) + 1,
            ties: Vec::new(),
            doubts: Vec::new(),
        };
        self.join(&mut joining, &case.bgset)?;
        self.contact.join(self, &mut joining, case, unread)?;
        Ok((joining.ties, joining.doubts))
    }

    /// Adds the ties of the selected `BGSET`.
    fn join(&self, joining: &mut Joining, selection: &Selection) -> Result<(), FileProblem> {
        let Some(first) = self.pairs.first() else {
            return Ok(());
        };
        if matches!(selection, Selection::Nothing) {
            joining.doubts.push(format!(
                "{}:{}: no BGSET = in case control selects the glue, and the surfaces stay apart, as in Nastran",
                first.at.file, first.at.line
            ));
            return Ok(());
        }
        let sets = chosen(selection, &self.sums, &self.sets, "BGSET")?;
        for pair in &self.pairs {
            if sets.as_ref().is_some_and(|sets| !sets.contains(&pair.set)) {
                continue;
            }
            let source = self.faces(pair.source, pair, &mut joining.faces)?;
            let target = self.faces(pair.target, pair, &mut joining.faces)?;
            let Some((tied, count)) = joining.tie([&source, &target], pair.search) else {
                continue;
            };
            pair.told(&tied, count, &mut joining.doubts)?;
            // a node has an equation for each direction
            let turned = tied
                .followers()
                .filter(|node| turns(&joining.turning, *node));
            let turned = turned.collect::<BTreeSet<_>>().len();
            pair.turned(turned, &mut joining.doubts);
            joining.keep(tied);
        }
        Ok(())
    }

    /// The parts of a region.
    ///
    /// # Errors
    /// A region that is missing or wrong.
    fn parts(&self, id: u64, at: &At, user: &str) -> Result<Vec<(Part, At)>, FileProblem> {
        let wrong = |id: Option<u64>| self.wrong.get(&id).map_or(Ok(()), |p| Err(p.clone()));
        wrong(Some(id))?;
        match self.regions.get(&id) {
            Some(parts) => Ok(parts.clone()),
            None => {
                wrong(None)?;
                Err(at.problem(
                    format!("{user} region {id}, which is missing or no surface"),
                    "add its BSURF, BSURFS, BCPROP or BCPROPS; Eng does not read glued edges (BLSEG)",
                ))
            }
        }
    }

    /// The faces of a region.
    fn faces(&self, id: u64, pair: &Pair, faces: &mut Faces) -> Result<Vec<Face>, FileProblem> {
        let parts = self.parts(id, &pair.at, &format!("BGSET {} glues", pair.set))?;
        let mut found = Vec::new();
        for (part, at) in &parts {
            let before = found.len();
            faces.add(part, at, &mut found)?;
            if found.len() == before {
                return Err(at.problem(
                    format!("region {id} has no face"),
                    "correct its numbers: BSURF and BCPROP take shells, BSURFS and BCPROPS take solids",
                ));
            }
        }
        Ok(found)
    }
}

impl Pair {
    /// What to say about a tie.
    ///
    /// # Errors
    /// No node is near enough.
    fn told(&self, tied: &Tied, count: usize, doubts: &mut Vec<String>) -> Result<(), FileProblem> {
        let Pair { source, target, .. } = self;
        let reach = format!("search distance of {} along its normals", self.search);
        if tied.far == count {
            return Err(self.at.problem(
                format!("no node of region {source} faces region {target} within the {reach}"),
                "check the regions and the units, or state a larger SDIST",
            ));
        }
        let place = format!("{}:{}", self.at.file, self.at.line);
        let name = format!("{source} of BGSET {}", self.set);
        doubts.extend(doubt(&place, &name, tied, count, &reach));
        Ok(())
    }

    /// Says that shells of the source region turn without the target, if `count` of its nodes have rotations.
    fn turned(&self, count: usize, doubts: &mut Vec<String>) {
        if count > 0 {
            doubts.push(format!(
                "{}:{}: BGSET {} ties the translations of region {} alone: the rotations of the {count} nodes of its shells do not follow region {}",
                self.at.file, self.at.line, self.set, self.source, self.target
            ));
        }
    }
}

/// The ties of pairs of surfaces, one pair after the other.
struct Joining<'a> {
    faces: Faces<'a>,
    /// Nodes whose rotations a shell uses.
    turning: Vec<bool>,
    /// Nodes that follow a face: a node follows one alone.
    following: BTreeSet<u32>,
    /// The number of the next tie.
    next: u64,
    ties: Vec<Tie>,
    doubts: Vec<String>,
}

impl Joining<'_> {
    /// The ties of the source's nodes that follow no face yet to the target, and the number of these nodes; `None` without
    /// such nodes.
    fn tie(&self, [source, target]: [&[Face]; 2], search: f64) -> Option<(Tied, usize)> {
        let nodes: BTreeSet<u32> = source.iter().flat_map(|face| face.nodes.clone()).collect();
        let nodes: Vec<u32> = nodes.difference(&self.following).copied().collect();
        if nodes.is_empty() {
            return None;
        }
        let request = Request {
            nodes: &nodes,
            faces: target,
            tolerance: Some(search),
            adjust: false,
            turning: None,
            arms: Some(&self.turning),
            facing: true,
        };
        let mesh = self.faces.mesh;
        Some((
            tied(&mesh.nodes, &mesh.frames, &request, self.next),
            nodes.len(),
        ))
    }

    /// Keeps the ties of a pair.
    fn keep(&mut self, tied: Tied) {
        self.next += tied.ties.len() as u64;
        self.following.extend(tied.followers());
        self.ties.extend(tied.ties);
    }
}

/// The faces of a mesh.
struct Faces<'a> {
    mesh: &'a Mesh,
    properties: &'a [u64],
    lookup: &'a Lookup,
    /// The sorted corners of the faces that belong to one solid alone, when they are needed.
    outer: Option<BTreeSet<Vec<u32>>>,
}

impl Faces<'_> {
    /// The outer faces of the solids of a body, and whether it has shells. All elements of its regions belong to it.
    fn body(&self, parts: &[(Part, At)]) -> (Vec<Face>, bool) {
        let is_part = |(element, property): &(&Element, &u64)| {
            parts.iter().any(|(part, _)| match part {
                Part::Shells(ids) => ids.holds(element.id),
                Part::Properties { ids, .. } => ids.holds(**property),
                Part::Face(id, _) => *id == element.id,
            })
        };
        let elements = self.mesh.elements.iter().zip(self.properties);
        let (mut solids, mut shells) = (Vec::new(), false);
        for (element, _) in elements.filter(is_part) {
            shells |= is_shell(element);
            if element.kind.is_solid() {
                solids.extend(faces_of(self.mesh, element));
            }
        }
        let mut counts: BTreeMap<Vec<u32>, usize> = BTreeMap::new();
        for face in &solids {
            *counts.entry(key(face)).or_default() += 1;
        }
        solids.retain(|face| counts.get(&key(face)) == Some(&1));
        (solids, shells)
    }

    fn add(&mut self, part: &Part, at: &At, found: &mut Vec<Face>) -> Result<(), FileProblem> {
        match part {
            Part::Face(id, corners) => {
                let missing = || {
                    at.problem(
                        format!("the mesh has no solid {id} with a face at three grid points of the card"),
                        "give the number of a solid, and three corners of one of its faces",
                    )
                };
                let mut wanted = [0; 3];
                for (node, grid) in wanted.iter_mut().zip(corners) {
                    *node = self.lookup.find(*grid).ok_or_else(missing)?;
                }
                let element = (self.mesh.elements.iter())
                    .find(|element| element.id == *id && element.kind.is_solid())
                    .ok_or_else(missing)?;
                let face = faces_of(self.mesh, element)
                    .into_iter()
                    .find(|face| wanted.iter().all(|node| face.nodes.contains(node)));
                found.push(face.ok_or_else(missing)?);
            }
            Part::Shells(ids) => {
                let own = self.mesh.elements.iter();
                let shells = own.filter(|element| is_shell(element) && ids.holds(element.id));
                found.extend(shells.flat_map(|element| faces_of(self.mesh, element)));
            }
            Part::Properties { ids, solid } => {
                let mesh = self.mesh;
                let own = mesh.elements.iter().zip(self.properties);
                let own = own.filter(|(element, property)| {
                    let fits = match solid {
                        true => element.kind.is_solid(),
                        false => is_shell(element),
                    };
                    fits && ids.holds(**property)
                });
                let faces = own.flat_map(|(element, _)| faces_of(mesh, element));
                if !solid {
                    found.extend(faces);
                    return Ok(());
                }
                let outer = self.outer.get_or_insert_with(|| outer(mesh));
                found.extend(faces.filter(|face| outer.contains(&key(face))));
            }
        }
        Ok(())
    }
}

fn turns(turning: &[bool], node: u32) -> bool {
    turning.get(node as usize).is_some_and(|turns| *turns)
}

/// For each node whether a shell that bends uses its rotations.
fn turning(mesh: &Mesh) -> Vec<bool> {
    let mut turning = vec![false; mesh.nodes.len()];
    for element in mesh.elements.iter().filter(|element| is_shell(element)) {
        let property = mesh.properties.get(element.property as usize);
        let section = property.map(|property| property.section);
        if matches!(section, Some(Section::Shell(section)) if !section.is_membrane()) {
            for node in mesh.nodes_of(element) {
                if let Some(turns) = turning.get_mut(*node as usize) {
                    *turns = true;
                }
            }
        }
    }
    turning
}

fn is_shell(element: &Element) -> bool {
    !element.kind.is_solid() && element.kind.corner_count() > 2
}

/// The faces of a solid, or the one of a shell.
fn faces_of(mesh: &Mesh, element: &Element) -> Vec<Face> {
    let nodes = mesh.nodes_of(element);
    let faces = element.kind.description().faces.iter();
    faces
        .filter_map(|corners| Face::new(&around(element.kind, nodes, corners)))
        .collect()
}

/// The corners of a face, sorted.
fn key(face: &Face) -> Vec<u32> {
    let mut corners = face.nodes[..face.kind.corner_count()].to_vec();
    corners.sort_unstable();
    corners
}

/// The faces that belong to one solid alone.
fn outer(mesh: &Mesh) -> BTreeSet<Vec<u32>> {
    let mut counts: BTreeMap<Vec<u32>, usize> = BTreeMap::new();
    for element in mesh
        .elements
        .iter()
        .filter(|element| element.kind.is_solid())
    {
        for face in faces_of(mesh, element) {
            *counts.entry(key(&face)).or_default() += 1;
        }
    }
    let single = counts.into_iter().filter(|(_, count)| *count == 1);
    single.map(|(key, _)| key).collect()
}
