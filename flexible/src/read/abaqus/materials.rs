//! `*MATERIAL` with `*ELASTIC` of an isotropic material or a lamina, and `*DENSITY`.

use std::collections::BTreeMap;

use super::lines::key;
use super::scope::Block;
use crate::error::FileProblem;
use crate::mesh::{Carries, Material, SheetElasticity};
use crate::read::source::At;
use crate::read::unread::UnreadCards;

#[derive(Clone, Debug)]
struct Entry {
    name: String,
    /// Young's modulus and Poisson's ratio.
    elastic: Option<(f64, f64)>,
    /// Of `TYPE=LAMINA`.
    sheet: Option<SheetElasticity>,
    density: Option<f64>,
    at: At,
}

/// The materials of a file.
#[derive(Debug, Default)]
pub(super) struct Materials {
    entries: BTreeMap<String, Entry>,
    open: Option<String>,
}

/// Keywords of a material that do not change the linear structure.
const HARMLESS: &[&str] = &[
    "PLASTIC",
    "EXPANSION",
    "CONDUCTIVITY",
    "SPECIFICHEAT",
    "DAMPING",
    "DEPVAR",
    "CYCLICHARDENING",
    "CREEP",
    "RATEDEPENDENT",
    "FAILSTRESS",
    "FAILSTRAIN",
    "LATENTHEAT",
    "INELASTICHEATFRACTION",
    "ELECTRICALCONDUCTIVITY",
    "DAMAGEINITIATION",
    "DAMAGEEVOLUTION",
    "POTENTIAL",
];

impl Materials {
    /// Reads a block that belongs to a material; `false` for another block.
    pub fn read(&mut self, block: &Block, unread: &mut UnreadCards) -> Result<bool, FileProblem> {
        let keyword = &block.keyword;
        if keyword.key == "MATERIAL" {
            let name = keyword.require("NAME", "NAME")?;
            let entry = Entry {
                name: name.to_string(),
                elastic: None,
                sheet: None,
                density: None,
                at: keyword.at.clone(),
            };
            if let Some(first) = self.entries.insert(key(name), entry) {
                return Err(keyword.problem(
                    &format!(
                        "{name} is defined twice, first in {}, line {}",
                        first.at.file, first.at.line
                    ),
                    "rename or remove one of them",
                ));
            }
            self.open = Some(key(name));
            return Ok(true);
        }
        let entry = self
            .open
            .as_ref()
            .and_then(|name| self.entries.get_mut(name));
        let rows = block.rows.iter().filter(|row| !row.is_blank());
        let rows = rows.collect::<Vec<_>>();
        match keyword.key.as_str() {
            "ELASTIC" | "DENSITY" => {
                let Some(entry) = entry else {
                    return Err(keyword.problem(
                        "it belongs to no material",
                        "put it after the *MATERIAL that it describes",
                    ));
                };
                if rows.len() > 1 {
                    unread.note(
                        &format!("*{} at several temperatures", keyword.name),
                        &keyword.at,
                        Carries::Unknown,
                    );
                }
                let Some(row) = rows.first() else {
                    return Err(keyword.problem(
                        "its data line is missing",
                        "write its values on the next line",
                    ));
                };
                if keyword.key == "DENSITY" {
                    entry.density = Some(row.real(0, "the density")?);
                } else if matches!(keyword.choice("TYPE").as_str(), "" | "ISO" | "ISOTROPIC") {
                    let young = row.real(0, "Young's modulus")?;
                    let poisson = row.optional_real(1, "Poisson's ratio")?;
                    if poisson.is_none() {
                        // the codes take zero; of a metal shear and torsion then come out 30 % too stiff
                        let name = "*ELASTIC without Poisson's ratio";
                        unread.note(name, &keyword.at, Carries::Structure);
                    }
                    entry.elastic = Some((young, poisson.unwrap_or(0.0)));
                } else if keyword.choice("TYPE") == "LAMINA" {
                    let names = ["E1", "E2", "Nu12", "G12", "G13", "G23"];
                    let mut constants = [0.0; 6];
                    for ((i, constant), name) in constants.iter_mut().enumerate().zip(names) {
                        *constant = row.real(i, name)?;
                    }
                    let [e1, e2, poisson, g12, g13, g23] = constants;
                    let sheet = SheetElasticity::orthotropic([e1, e2, poisson, g12], [g13, g23]);
                    if sheet.is_none() {
                        return Err(row.at.problem(
                            "no elastic lamina has these constants",
                            "E1, E2 and the shear moduli must be above zero, and Nu12 squared below E1/E2",
                        ));
                    }
                    entry.sheet = sheet;
                    entry.elastic = Some((e1, poisson));
                }
            }
            known if entry.is_some() && HARMLESS.contains(&known) => {
                unread.note(&format!("*{}", keyword.name), &keyword.at, Carries::Nothing);
            }
            // other data of the material are listed with the other unread keywords
            _ => return Ok(false),
        }
        Ok(true)
    }

    /// The material of a section, which may be a lamina for a shell.
    pub fn find(&self, name: &str, user: &Block, shell: bool) -> Result<Material, FileProblem> {
        let Some(entry) = self.entries.get(&key(name)) else {
            return Err(user.keyword.problem(
                &format!("the material {name} is missing"),
                "add its *MATERIAL, or *INCLUDE the file that holds it",
            ));
        };
        let known = entry.elastic.filter(|_| shell || entry.sheet.is_none());
        let Some((young, poisson)) = known else {
            return Err(entry.at.problem(
                format!("a section uses the material {name}, which has no isotropic *ELASTIC"),
                "give it *ELASTIC with Young's modulus and Poisson's ratio; only shells can have TYPE=LAMINA",
            ));
        };
        Ok(Material {
            name: entry.name.clone(),
            young,
            poisson,
            density: entry.density.unwrap_or(0.0),
            sheet: entry.sheet,
        })
    }
}
