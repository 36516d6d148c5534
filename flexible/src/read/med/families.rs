//! Families: each node and each cell belongs to one, and a family belongs to any number of named groups.

use std::collections::{BTreeMap, BTreeSet};

use super::folder::{AGAIN, File, Folder, text};
use crate::error::FileProblem;

/// Bytes of the name of a group.
const NAME: usize = 80;

/// The groups of families by the number of the family.
#[derive(Debug, Default)]
pub(super) struct Families {
    /// Of nodes, with positive numbers.
    pub nodes: BTreeMap<i64, Vec<String>>,
    /// Of cells, with negative numbers.
    pub cells: BTreeMap<i64, Vec<String>>,
    /// The numbers of all families in the file, with groups or without.
    described: BTreeSet<i64>,
}

impl Families {
    /// Reads the families of a mesh. Since MED 2.3 those of nodes and of cells have a folder each.
    pub fn read(file: &File<'_>, folder: &Folder<'_>) -> Result<Self, FileProblem> {
        let mut families = Families::default();
        families.take(file, folder)?;
        for part in ["ELEME", "NOEUD"] {
            if let Some(folder) = file.open(folder, part)? {
                families.take(file, &folder)?;
            }
        }
        Ok(families)
    }

    /// Whether a node or a cell has a family that the file does not describe, so its groups are lost. Zero is no family.
    pub fn is_lost(&self, number: i64) -> bool {
        number != 0 && !self.described.contains(&number)
    }

    fn take(&mut self, file: &File<'_>, folder: &Folder<'_>) -> Result<(), FileProblem> {
        for name in folder.names() {
            if ["ELEME", "NOEUD"].contains(&name) {
                continue;
            }
            let Some(family) = file.open(folder, name)? else {
                continue;
            };
            let Some(number) = file.attribute(&family, "NUM")? else {
                return Err(file.problem(&family.path, "the family has no number NUM", AGAIN));
            };
            self.described.insert(number);
            let Some(groups) = file.open(&family, "GRO")? else {
                continue;
            };
            let letters = file.letters(&groups, "NOM")?.unwrap_or(&[]);
            // before version 2.3 a zero byte follows the names
            if letters.len() % NAME > 1 {
                let problem = "the names of its groups have no 80 letters each";
                return Err(file.problem(&family.path, problem, AGAIN));
            }
            let mut names: Vec<String> = letters.chunks_exact(NAME).map(text).collect();
            names.retain(|name| !name.is_empty());
            names.sort();
            names.dedup();
            let into = match number > 0 {
                true => &mut self.nodes,
                false => &mut self.cells,
            };
            if into.insert(number, names).is_some() {
                let problem = format!("another family has the number {number}, too");
                return Err(file.problem(&family.path, &problem, AGAIN));
            }
        }
        Ok(())
    }
}
