//! `*COUPLING` with `*KINEMATIC` or `*DISTRIBUTING`, `*KINEMATIC COUPLING`, `*DISTRIBUTING COUPLING`.

use std::collections::BTreeMap;

use super::lines::Row;
use super::orientations::Orientation;
use super::scope::Block;
use super::shapes::Shape;
use super::supports::arbitrary;
use super::ties::{ALL, ROTATIONS, TRANSLATIONS, Ties};
use crate::error::FileProblem;
use crate::fe::vector::{cross, subtract};
use crate::mesh::{Carries, Code, Tie, along_axes};
use crate::read::vector::{Rotation, norm};

/// A coupling without the keyword of its kind.
pub(super) fn bare(coupling: &Block) -> FileProblem {
    coupling.keyword.problem(
        "neither *KINEMATIC nor *DISTRIBUTING follows",
        "add one of them right after it",
    )
}

/// Rows solved for one of their first three unknowns each, with its index. The unknown with the largest factor of all
/// is taken first, so the factors of perpendicular unit vectors stay of the size of 1.
fn eliminated(mut rows: Vec<[f64; 9]>) -> Vec<(usize, [f64; 9])> {
    let mut solved: Vec<(usize, [f64; 9])> = Vec::with_capacity(rows.len());
    while !rows.is_empty() {
        let (mut best, mut of, mut pivot) = (0.0, 0, 0);
        for (i, row) in rows.iter().enumerate() {
            for (k, factor) in row.iter().take(3).enumerate() {
                if factor.abs() > best {
                    (best, of, pivot) = (factor.abs(), i, k);
                }
            }
        }
        let row = rows.swap_remove(of);
        let divisor = row.get(pivot).copied().unwrap_or(1.0);
        let row = row.map(|x| x / divisor);
        for other in rows
            .iter_mut()
            .chain(solved.iter_mut().map(|(_, other)| other))
        {
            let factor = other.get(pivot).copied().unwrap_or(0.0);
            for (x, y) in other.iter_mut().zip(row) {
                *x -= factor * y;
            }
            if let Some(own) = other.get_mut(pivot) {
                *own = 0.0;
            }
        }
        solved.push((pivot, row));
    }
    solved
}

impl Ties<'_, '_> {
    /// `*COUPLING` with the keyword after it.
    pub fn coupling(
        &mut self,
        place: usize,
        coupling: &Block,
        kind: &Block,
    ) -> Result<(), FileProblem> {
        let keyword = &coupling.keyword;
        let reference = keyword.require("REFNODE", "REF NODE")?;
        let reference = self.model.node_of(place, reference, &keyword.at)?;
        let name = keyword.require("SURFACE", "SURFACE")?;
        let mut surface = self.surface(place, name, coupling)?;
        if let Some(radius) = keyword.get("INFLUENCERADIUS") {
            let Some(radius) = crate::read::number::real(radius) else {
                return Err(keyword.problem(
                    &format!("INFLUENCE RADIUS is \"{radius}\", not a number"),
                    "give a number, or remove INFLUENCE RADIUS",
                ));
            };
            let centre = self.model.position(reference);
            surface
                .nodes
                .retain(|(node, _)| norm(subtract(self.model.position(*node), centre)) <= radius);
        }
        surface.nodes.retain(|(node, _)| *node != reference);
        if surface.nodes.is_empty() {
            return Err(keyword.problem(
                &format!("its surface {name} has no nodes"),
                "check the surface and the influence radius",
            ));
        }
        let components = components(&kind.rows)?.unwrap_or(ALL);
        if kind.keyword.key == "KINEMATIC" {
            let nodes = surface
                .nodes
                .iter()
                .map(|(node, _)| *node)
                .collect::<Vec<_>>();
            return self.kinematic(place, reference, &nodes, components, coupling);
        }
        let method = kind.keyword.choice("WEIGHTINGMETHOD");
        if !matches!(method.as_str(), "" | "UNIFORM") {
            let name = "*DISTRIBUTING with weights by distance";
            self.unread.note(name, &keyword.at, Carries::Structure);
        }
        if kind.keyword.choice("COUPLING") == "STRUCTURAL" {
            let name = "*DISTRIBUTING, COUPLING=STRUCTURAL";
            self.unread.note(name, &keyword.at, Carries::Unknown);
        }
        // all translations always follow; rotations may be released
        let components = components | TRANSLATIONS;
        if keyword.has("ORIENTATION") && !full(components) {
            let name = "*DISTRIBUTING of some freedoms in own axes";
            self.unread.note(name, &keyword.at, Carries::Structure);
            return Ok(());
        }
        self.made.push(Tie::Averaging {
            id: self.id(),
            reference,
            reference_components: components,
            independent: surface
                .nodes
                .into_iter()
                .map(|(node, weight)| (node, weight, TRANSLATIONS))
                .collect(),
        });
        Ok(())
    }

    /// Adds nodes that follow a reference node rigidly, in the axes of an `ORIENTATION` if the keyword names one.
    fn kinematic(
        &mut self,
        place: usize,
        reference: u32,
        nodes: &[u32],
        components: u8,
        block: &Block,
    ) -> Result<(), FileProblem> {
        let keyword = &block.keyword;
        let name = keyword.get("ORIENTATION").filter(|name| !name.is_empty());
        let Some(name) = name.filter(|_| !full(components)) else {
            self.spider(reference, nodes, components, block);
            return Ok(());
        };
        let rotations = components & ROTATIONS;
        let turns = |node: &u32| self.turning.get(*node as usize) == Some(&true);
        if !full(rotations) && nodes.iter().any(turns) {
            let name = format!("*{} of some rotations in own axes", keyword.name);
            self.unread.note(&name, &keyword.at, Carries::Structure);
            return Ok(());
        }
        let Some(axes) = Orientation::named(
            (self.model, self.code),
            place,
            (name, None),
            block,
            self.unread,
        )?
        else {
            return Ok(());
        };
        let mut nodes = nodes.to_vec();
        nodes.sort_unstable();
        nodes.dedup();
        nodes.retain(|node| *node != reference);
        if full(rotations) && rotations != 0 && !nodes.is_empty() {
            self.spider(reference, &nodes, rotations, block);
        }
        let mut on_axis = Vec::new();
        for node in nodes {
            let place = self.model.position(node);
            let id = self
                .model
                .nodes
                .get(node as usize)
                .map_or(0, |node| node.id);
            let rotation = axes.at(place).or_else(|| {
                let rotation = axes.on_axis(place).filter(|_| self.code == Code::CalculiX);
                on_axis.extend(rotation.map(|_| id.to_string()));
                rotation
            });
            let Some(rotation) = rotation else {
                return Err(keyword.problem(
                    &format!("the points of the orientation {name} give no axes at node {id}"),
                    "choose points that form a triangle, and no axis through the node",
                ));
            };
            self.follow(reference, node, components & TRANSLATIONS, &rotation);
        }
        self.doubts
            .extend(arbitrary(keyword, &format!("the axis of {name}"), on_axis));
        Ok(())
    }

    /// Equations by which translations of a node along axes (the columns of a rotation) follow a reference node
    /// rigidly: along a unit vector a, at the place r from the reference, `a·u = a·U + (r × a)·Θ`.
    fn follow(&mut self, reference: u32, node: u32, components: u8, rotation: &Rotation) {
        let model = self.model;
        let arm = subtract(model.position(node), model.position(reference));
        let own = |node: u32, vector| along_axes(&model.nodes, self.frames, node, vector);
        let mut rows = Vec::with_capacity(3);
        for component in (0..3_usize).filter(|k| components >> k & 1 == 1) {
            let axis = rotation.map(|row| row[component]);
            let (left, shift) = (own(node, axis), own(reference, axis));
            let turn = own(reference, cross(arm, axis));
            let mut row = [0.0; 9];
            for k in 0..3 {
                row[k] = left[k];
                row[3 + k] = -shift[k];
                row[6 + k] = -turn[k];
            }
            rows.push(row);
        }
        for (pivot, row) in eliminated(rows) {
            let place = |k: usize| match k {
                0..3 => (node, k as u8),
                _ => (reference, (k - 3) as u8),
            };
            let mut terms = vec![(node, pivot as u8, 1.0)];
            for (k, factor) in row.into_iter().enumerate() {
                if k != pivot && factor != 0.0 {
                    let (node, freedom) = place(k);
                    terms.push((node, freedom, factor));
                }
            }
            self.made.push(Tie::Equation {
                id: self.id(),
                terms,
            });
        }
    }

    /// Adds nodes that follow a reference node rigidly. Components are along the global frame.
    pub fn spider(&mut self, reference: u32, nodes: &[u32], components: u8, block: &Block) {
        let turned = |node: &u32| {
            let node = self.model.nodes.get(*node as usize);
            node.is_some_and(|node| node.frame.is_some())
        };
        if !full(components) && nodes.iter().any(turned) {
            let name = format!("*{} of some freedoms in own axes", block.keyword.name);
            self.unread
                .note(&name, &block.keyword.at, Carries::Structure);
            return;
        }
        let mut dependent = nodes
            .iter()
            .filter(|node| **node != reference)
            .map(|node| (*node, components))
            .collect::<Vec<_>>();
        dependent.sort_unstable();
        dependent.dedup();
        if dependent.is_empty() {
            return;
        }
        self.made.push(Tie::Rigid {
            id: self.id(),
            independent: reference,
            dependent,
        });
    }

    /// `*DISTRIBUTING COUPLING, ELSET=e` of `DCOUP3D` elements: `node or set, weight`. In CalculiX the displacement of
    /// their node is the weighted mean of the others (so its manual, *DISTRIBUTING COUPLING), wherever it lies; in Abaqus
    /// the node also turns with the others.
    pub fn distributing_by_elements(
        &mut self,
        place: usize,
        block: &Block,
    ) -> Result<(), FileProblem> {
        let keyword = &block.keyword;
        let mut leading: Vec<(u32, f64)> = Vec::new();
        for row in block.rows.iter().filter(|row| !row.is_blank()) {
            let weight = row.real(1, "the weight")?;
            if !(weight > 0.0 && weight.is_finite()) {
                return Err(row.at.problem(
                    format!("*DISTRIBUTING COUPLING: the weight is {weight}"),
                    "give a weight above zero",
                ));
            }
            let nodes = self.model.nodes_of(place, row.text(0), &row.at)?;
            leading.extend(nodes.into_iter().map(|node| (node, weight)));
        }
        if leading.is_empty() {
            return Err(keyword.problem(
                "it has no nodes",
                "write a node or a set, and its weight, on each line",
            ));
        }
        let total: f64 = leading.iter().map(|(_, weight)| weight).sum();
        let set = keyword.require("ELSET", "ELSET")?;
        for index in self.model.rows_of(place, set, &keyword.at)? {
            let Some(element) = self.model.rows.get(index as usize) else {
                continue;
            };
            let (Shape::Distributing, &[reference]) =
                (element.shape, self.model.row_nodes(element))
            else {
                return Err(keyword.problem(
                    &format!(
                        "its set contains element {}, which is no DCOUP3D",
                        element.label
                    ),
                    "its set must contain only elements of the type DCOUP3D",
                ));
            };
            if !self.spread.insert(index) {
                return Err(keyword.problem(
                    &format!("element {} has two couplings", element.label),
                    "remove it from one of the two sets",
                ));
            }
            if self.code != Code::CalculiX {
                let independent = leading.iter().map(|(node, w)| (*node, *w, TRANSLATIONS));
                self.made.push(Tie::Averaging {
                    id: self.id(),
                    reference,
                    reference_components: ALL,
                    independent: independent.collect(),
                });
                continue;
            }
            for freedom in 0..3_u8 {
                let others = leading.iter().map(|(node, w)| (*node, freedom, -w));
                self.made.push(Tie::Equation {
                    id: self.id(),
                    terms: [(reference, freedom, total)]
                        .into_iter()
                        .chain(others)
                        .collect(),
                });
            }
        }
        Ok(())
    }

    /// Notes `DCOUP3D` elements without a coupling.
    pub fn note_idle_elements(&mut self) {
        for (index, row) in (0..).zip(&self.model.rows) {
            if row.shape == Shape::Distributing && !self.spread.contains(&index) {
                let name = "DCOUP3D elements without *DISTRIBUTING COUPLING";
                self.unread.note(name, &row.at, Carries::Structure);
            }
        }
    }

    /// `*KINEMATIC COUPLING, REF NODE=n`: `node or set, first, last`.
    pub fn kinematic_by_nodes(&mut self, place: usize, block: &Block) -> Result<(), FileProblem> {
        let keyword = &block.keyword;
        let reference = keyword.require("REFNODE", "REF NODE")?;
        let reference = self.model.node_of(place, reference, &keyword.at)?;
        let mut by_components: BTreeMap<u8, Vec<u32>> = BTreeMap::new();
        for row in block.rows.iter().filter(|row| !row.is_blank()) {
            let components = if row.text(1).is_empty() {
                ALL
            } else {
                row.freedom_range(1)?
            };
            let nodes = self.model.nodes_of(place, row.text(0), &row.at)?;
            by_components.entry(components).or_default().extend(nodes);
        }
        for (components, nodes) in by_components {
            self.kinematic(place, reference, &nodes, components, block)?;
        }
        Ok(())
    }
}

/// Whether the components contain all or no translations, and all or no rotations. Then their axes do not
/// matter.
fn full(components: u8) -> bool {
    [TRANSLATIONS, ROTATIONS]
        .iter()
        .all(|group| components & group == 0 || components & group == *group)
}

/// All freedoms named by lines `first, last`; `None` without any.
fn components(rows: &[Row]) -> Result<Option<u8>, FileProblem> {
    let mut all = None;
    for row in rows.iter().filter(|row| !row.text(0).is_empty()) {
        all = Some(all.unwrap_or(0) | row.freedom_range(0)?);
    }
    Ok(all)
}
