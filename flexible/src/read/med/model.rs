//! The mesh of the contents of a file.

use std::collections::{BTreeMap, BTreeSet};

use super::cells::Cells;
use super::families::Families;
use super::folder::{AGAIN, File, Folder, fits};
use crate::error::FileProblem;
use crate::mesh::{
    Carries, ElementKind, Mesh, Node, Property, Section, Set, ShellSection, Unread, Variant,
};
use crate::read::ShellGroups;
use crate::read::builder::{NewElement, Once, TooMany, add_element};
use crate::read::labels::Labels;

/// The most members of all groups for each node, on average. A choice: without it a small file could ask for much memory.
const MOST_GROUPS: usize = 100;

/// Folders of a file without stiffness, mass and constraints: fields, steps, profiles, joints, localisations, links.
const NOTHING: [&str; 9] = [
    "CHA",
    "PROFILS",
    "GAUSS",
    "LIENS",
    "INTERP",
    "NUMERICAL_DATA",
    "SUPPORTS",
    "JNT",
    "FILE_COMMENT",
];
/// Folders that are read.
const READ: [&str; 3] = ["INFOS_GENERALES", "ENS_MAA", "FAS"];

/// The contents read so far.
pub(super) struct Model<'f, 's> {
    file: &'s File<'f>,
    shells: ShellGroups<'s>,
    families: Families,
    mesh: Mesh,
    /// Nodes and elements of the groups.
    sets: BTreeMap<String, (Vec<u32>, Vec<u32>)>,
    members: usize,
    properties: Once<(bool, String), Property>,
    /// Groups of surfaces with their elements that are shells.
    found: BTreeSet<String>,
    surfaces: BTreeSet<String>,
    unread: BTreeMap<String, (u64, Carries)>,
}

impl<'f, 's> Model<'f, 's> {
    /// Of a file that is not read yet.
    pub fn new(file: &'s File<'f>, shells: ShellGroups<'s>, families: Families) -> Self {
        Model {
            file,
            shells,
            families,
            mesh: Mesh::default(),
            sets: BTreeMap::new(),
            members: 0,
            properties: Once::default(),
            found: BTreeSet::new(),
            surfaces: BTreeSet::new(),
            unread: BTreeMap::new(),
        }
    }

    /// Reads the nodes. Coordinates are all x, then all y, then all z.
    pub fn nodes(&mut self, mesh: &Folder<'f>, step: &Folder<'f>) -> Result<(), FileProblem> {
        let file = self.file;
        let missing = || file.problem(&step.path, "the mesh has no nodes NOE/COO", AGAIN);
        let folder = file.open(step, "NOE")?.ok_or_else(missing)?;
        // before version 3 the axes are an attribute of the coordinates
        let axes = match file.attribute(mesh, "REP")? {
            Some(axes) => axes,
            None => file
                .attribute_of_dataset(&folder, "COO", "REP")?
                .unwrap_or(0),
        };
        if axes != 0 {
            let problem = "the nodes have cylindrical or spherical coordinates";
            let advice = "write the mesh with Cartesian coordinates";
            return Err(file.problem(&folder.path, problem, advice));
        }
        if file.count(&folder, "GLB")?.is_some() {
            return Err(file.problem(
                &folder.path,
                "the mesh is a part of a mesh that was divided for several processors",
                "give the whole mesh",
            ));
        }
        let places = file.reals(&folder, "COO")?.ok_or_else(missing)?;
        let stated = file.attribute_of_dataset(&folder, "COO", "NBR")?;
        let count = match stated {
            Some(count) => usize::try_from(count).unwrap_or(0),
            None => places.len() / 3,
        };
        let numbers = file.integers(&folder, "NUM")?.unwrap_or_default();
        let families = file.integers(&folder, "FAM")?.unwrap_or_default();
        let dimension = places.len().checked_div(count).unwrap_or(0);
        if !(1..=3).contains(&dimension)
            || dimension * count != places.len()
            || u32::try_from(count).is_err()
            || !fits(&numbers, count)
            || !fits(&families, count)
        {
            let problem = format!(
                "it has {} coordinates, {} numbers and {} families of {count} nodes",
                places.len(),
                numbers.len(),
                families.len()
            );
            return Err(file.problem(&folder.path, &problem, AGAIN));
        }
        self.mesh.nodes.reserve_exact(count);
        for index in 0..count {
            let along = |axis: usize| match axis < dimension {
                true => places.get(axis * count + index).copied().unwrap_or(0.0),
                false => 0.0,
            };
            let own = numbers.get(index).copied().unwrap_or(index as i64 + 1);
            let id = u64::try_from(own).ok().filter(|id| *id > 0);
            let id = id.ok_or_else(|| {
                let problem = format!("the number of a node is {own}");
                file.problem(&folder.path, &problem, "give nodes numbers from 1")
            })?;
            self.mesh.nodes.push(Node {
                id,
                position: [along(0), along(1), along(2)],
                frame: None,
            });
        }
        let pairs = self.mesh.nodes.iter().zip(0_u32..);
        let labels = Labels::new(pairs.map(|(node, index)| (node.id, index)).collect());
        if let Some(number) = labels.repeated() {
            let problem = format!("two nodes have the number {number}");
            return Err(file.problem(&folder.path, &problem, AGAIN));
        }
        self.doubt_lost("nodes", families.iter().copied());
        for (index, family) in (0_u32..).zip(&families) {
            let groups = self.families.nodes.get(family).cloned().unwrap_or_default();
            for group in groups {
                self.member(1)?;
                self.sets.entry(group).or_default().0.push(index);
            }
        }
        Ok(())
    }

    /// Counts members of a group.
    fn member(&mut self, count: usize) -> Result<(), FileProblem> {
        self.members += count;
        let most = MOST_GROUPS.saturating_mul(self.mesh.nodes.len().max(1000));
        match self.members > most {
            true => Err(self.file.problem(
                "FAS",
                "the groups have more than a hundred times as many members as the mesh has nodes",
                "remove groups that the model does not use",
            )),
            false => Ok(()),
        }
    }

    /// Reads the cells.
    pub fn cells(&mut self, step: &Folder<'f>) -> Result<(), FileProblem> {
        let file = self.file;
        let Some(folder) = file.open(step, "MAI")? else {
            return Ok(());
        };
        let mut all = Vec::new();
        for name in folder.names() {
            let Some(own) = file.open(&folder, name)? else {
                continue;
            };
            match Cells::read(file, &own, name)? {
                Some(cells) => all.push(cells),
                None if name.starts_with("PO") => {
                    return Err(file.problem(
                        &own.path,
                        "the mesh has polygons or polyhedra",
                        "mesh with tetrahedra, wedges, pyramids and hexahedra",
                    ));
                }
                None => self.note(&format!("cells {name}"), 1, Carries::Unknown),
            }
        }
        let of_cells = |cells: &Cells| -> Vec<i64> {
            (0..cells.count).map(|cell| cells.family(cell)).collect()
        };
        self.doubt_lost("cells", all.iter().flat_map(of_cells));
        let first = first_numbers(&all);
        let mut on_solid = vec![false; self.mesh.nodes.len()];
        for (cells, first) in all.iter().zip(&first) {
            if cells.dimension == 3 {
                self.solids(cells, *first, &mut on_solid)?;
            }
        }
        for (cells, first) in all.iter().zip(&first) {
            if cells.dimension < 3 {
                self.thin(cells, *first, &on_solid)?;
            }
        }
        Ok(())
    }

    fn solids(
        &mut self,
        cells: &Cells,
        first: Option<u64>,
        on_solid: &mut [bool],
    ) -> Result<(), FileProblem> {
        let Some(kind) = cells.kind else {
            return Err(self.not_read(cells));
        };
        for cell in 0..cells.count {
            let nodes = cells.nodes_of(self.file, cell, &self.mesh.nodes)?;
            for node in &nodes {
                if let Some(on) = on_solid.get_mut(*node as usize) {
                    *on = true;
                }
            }
            let groups = self.groups_of(cells, cell);
            let name = groups.first().map_or("volumes", String::as_str).to_owned();
            let property = self.property((false, name), Section::Solid);
            self.keep(cells, (kind, cell, first), property, &nodes, groups)?;
        }
        Ok(())
    }

    /// Shells of the stated groups. Other points, lines and surfaces add their nodes to groups.
    fn thin(
        &mut self,
        cells: &Cells,
        first: Option<u64>,
        on_solid: &[bool],
    ) -> Result<(), FileProblem> {
        for cell in 0..cells.count {
            let nodes = cells.nodes_of(self.file, cell, &self.mesh.nodes)?;
            let groups = self.groups_of(cells, cell);
            if cells.dimension == 2 {
                self.surfaces.extend(groups.iter().cloned());
                let stated = |group: &&String| self.shells.groups.contains(group);
                let shell = groups.iter().find(stated).cloned();
                if let Some(group) = shell {
                    let Some(kind) = cells.kind else {
                        return Err(self.not_read(cells));
                    };
                    self.found.extend(groups.iter().cloned());
                    let section = Section::Shell(ShellSection::plate(self.shells.thickness));
                    let property = self.property((true, group), section);
                    self.keep(cells, (kind, cell, first), property, &nodes, groups)?;
                    continue;
                }
            }
            // without a solid below, a point may carry a mass, a line may be a beam, a surface may be a shell
            let face = nodes
                .iter()
                .all(|node| on_solid.get(*node as usize) == Some(&true));
            match face {
                true => self.note("points, lines and surfaces on solids", 1, Carries::Nothing),
                false => {
                    let name = format!("{} without solids", cells.geometry);
                    self.note(&name, 1, Carries::Structure);
                }
            }
            for group in groups {
                self.member(nodes.len())?;
                self.sets.entry(group).or_default().0.extend(&nodes);
            }
        }
        Ok(())
    }

    fn not_read(&self, cells: &Cells) -> FileProblem {
        let problem = format!("Eng does not read cells {}", cells.geometry);
        let advice =
            "mesh with order 1, or with order 2 without nodes in the middle of faces and volumes";
        self.file.problem(&cells.path, &problem, advice)
    }

    fn groups_of(&self, cells: &Cells, cell: usize) -> Vec<String> {
        let groups = self.families.cells.get(&cells.family(cell));
        groups.cloned().unwrap_or_default()
    }

    fn property(&mut self, (shell, name): (bool, String), section: Section) -> u32 {
        let key = (shell, name.clone());
        if let Some(made) = self.properties.find(&key) {
            return made;
        }
        let property = Property {
            name,
            material: None,
            section,
        };
        self.properties.add(key, property)
    }

    fn keep(
        &mut self,
        cells: &Cells,
        (kind, cell, first): (ElementKind, usize, Option<u64>),
        property: u32,
        nodes: &[u32],
        groups: Vec<String>,
    ) -> Result<(), FileProblem> {
        let own = cells.numbers.get(cell).and_then(|n| u64::try_from(*n).ok());
        let new = NewElement {
            id: match first {
                Some(first) => first + cell as u64,
                None => own.unwrap_or(0),
            },
            kind,
            variant: Variant::Plain,
            property,
            shell: None,
        };
        let index = add_element(&mut self.mesh, new, nodes, None).map_err(|_| {
            let (problem, advice) = TooMany::WORDS;
            self.file.problem(&cells.path, problem, advice)
        })?;
        for group in groups {
            self.member(1)?;
            self.sets.entry(group).or_default().1.push(index);
        }
        Ok(())
    }

    fn note(&mut self, name: &str, count: u64, carries: Carries) {
        let unread = self.unread.entry(name.to_owned());
        unread.or_insert((0, carries)).0 += count;
    }

    /// Notes the nodes or cells of these families whose groups are lost.
    fn doubt_lost(&mut self, members: &str, families: impl Iterator<Item = i64>) {
        let count = families
            .filter(|family| self.families.is_lost(*family))
            .count();
        if count > 0 {
            self.mesh.doubts.push(format!(
                "the file does not describe the families of some {members} ({count}), so their groups are lost"
            ));
        }
    }

    /// Notes the folders of the file beside those of the mesh.
    pub fn others(&mut self, root: &Folder<'f>) {
        for name in root.names().filter(|name| !READ.contains(name)) {
            let carries = match NOTHING.contains(&name) {
                true => Carries::Nothing,
                false => Carries::Unknown,
            };
            self.note(&format!("folder {name}"), 1, carries);
        }
    }

    /// The mesh.
    pub fn into_mesh(mut self) -> Result<Mesh, FileProblem> {
        let missing = self.shells.groups.iter().find(|g| !self.found.contains(*g));
        if let Some(group) = missing {
            let known: Vec<&str> = self.surfaces.iter().map(String::as_str).collect();
            let known = match known.is_empty() {
                true => "no surface is in a group".to_owned(),
                false => format!("groups of surfaces are {}", known.join(", ")),
            };
            return Err(self.file.problem(
                "",
                &format!("the group {group} has no triangle and no quadrangle; {known}"),
                "correct the name in `shells`, or put the surface into a group",
            ));
        }
        if self.mesh.elements.is_empty() {
            return Err(self.file.problem(
                "",
                "the file has no solid element",
                "mesh the volumes, or name the groups of surfaces that are shells: `shells: [\"COVER\"], thickness: 3 mm`",
            ));
        }
        for (name, (mut nodes, elements)) in std::mem::take(&mut self.sets) {
            nodes.extend(self.mesh.nodes_of_all(&elements));
            self.mesh.sets.insert(name, Set::new(nodes, elements));
        }
        self.mesh.properties = self.properties.all;
        let first = (self.file.name.to_owned(), 0);
        let unread = self
            .unread
            .into_iter()
            .map(|(name, (count, carries))| Unread {
                name,
                count,
                first: first.clone(),
                carries,
            });
        self.mesh.unread = unread.collect();
        Ok(self.mesh)
    }
}

/// For each geometry the number of its first cell if cells must be counted, because a geometry has no numbers or a number
/// occurs twice; else `None` each.
fn first_numbers(all: &[Cells]) -> Vec<Option<u64>> {
    let numbered = all.iter().all(|cells| cells.numbers.len() == cells.count);
    let numbers = all.iter().flat_map(|cells| &cells.numbers);
    let positive = numbers.clone().all(|number| *number > 0);
    let unsigned = numbers.map(|number| number.unsigned_abs());
    let labels = Labels::new(unsigned.map(|number| (number, 0)).collect());
    let own = numbered && positive && labels.repeated().is_none();
    let mut next = 1;
    let mut first = Vec::with_capacity(all.len());
    for cells in all {
        first.push((!own).then_some(next));
        next += cells.count as u64;
    }
    first
}
