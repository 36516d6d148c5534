//! `*MATERIAL` with `*ELASTIC` of an isotropic material, an anisotropic solid or a lamina, and `*DENSITY`.
//!
//! Constants of several temperatures are linear between their lines and constant beyond them, at the
//! temperature that `*INITIAL CONDITIONS, TYPE=TEMPERATURE` states for all nodes, else at 0 (manuals of CalculiX
//! and Abaqus). Of an anisotropic solid the stiffness is linear, as in CalculiX (`elastics.f`).

use std::collections::BTreeMap;

use super::anisotropic;
use super::lines::{Row, key};
use super::scope::Block;
use crate::elasticity::stiffness_fault;
use crate::error::FileProblem;
use crate::mesh::{Carries, LocalAxes, Material, SheetElasticity, SolidElasticity};
use crate::read::source::At;
use crate::read::unread::UnreadCards;

#[derive(Clone, Debug)]
struct Entry {
    name: String,
    /// Young's modulus and Poisson's ratio.
    elastic: Table<2>,
    /// Stiffness of an anisotropic solid: the constants of `TYPE=ANISO` in their order.
    solid: Table<21>,
    /// Of `TYPE=LAMINA`.
    sheet: Option<SheetElasticity>,
    density: Table<1>,
    at: At,
}

impl Entry {
    /// The keywords whose constants depend on the temperature, with their places.
    fn changing(&self) -> impl Iterator<Item = &(String, At)> {
        let elastic = (!self.elastic.is_constant()).then_some(&self.elastic.from);
        let solid = (!self.solid.is_constant()).then_some(&self.solid.from);
        let density = (!self.density.is_constant()).then_some(&self.density.from);
        [elastic, solid, density].into_iter().flatten().flatten()
    }

    fn read_density(
        &mut self,
        block: &Block,
        rows: &[&Row],
        unread: &mut UnreadCards,
    ) -> Result<(), FileProblem> {
        let rows = first_of(block, rows, (1, false), unread)?;
        self.density = Table::read(block, rows, |row| Ok([row.real(0, "the density")?]))?;
        Ok(())
    }

    /// Reads `*ELASTIC`. One of a type that is not known is left out; a section that uses it is an error.
    fn read_elasticity(
        &mut self,
        block: &Block,
        rows: &[&Row],
        unread: &mut UnreadCards,
    ) -> Result<(), FileProblem> {
        let keyword = &block.keyword;
        let kind = keyword.choice("TYPE");
        if let Some(lines) = anisotropic::lines(&kind) {
            let rows = first_of(block, rows, (lines, false), unread)?;
            let groups: Vec<&[&Row]> = rows.chunks(lines).collect();
            let place = anisotropic::place_of_temperature(lines);
            self.solid = Table::read_groups(block, &groups, place, |group| {
                anisotropic::constants(&kind, group)
            })?;
            return Ok(());
        }
        let rows = first_of(block, rows, (1, kind == "LAMINA"), unread)?;
        match kind.as_str() {
            "" | "ISO" | "ISOTROPIC" => {
                let blank = |row: &&Row| row.text(1).is_empty();
                if rows.iter().any(blank) {
                    // the codes take zero; of a metal shear and torsion then come out 30 % too stiff
                    let name = "*ELASTIC without Poisson's ratio";
                    unread.note(name, &keyword.at, Carries::Structure);
                }
                self.elastic = Table::read(block, rows, |row| {
                    let young = row.real(0, "Young's modulus")?;
                    Ok([young, row.real_or_zero(1, "Poisson's ratio")?])
                })?;
            }
            "LAMINA" => {
                if let Some(row) = rows.first() {
                    self.read_lamina(row)?;
                }
            }
            _ => {}
        }
        Ok(())
    }

    /// `*ELASTIC, TYPE=LAMINA`: `E1, E2, Nu12, G12, G13, G23`.
    fn read_lamina(&mut self, row: &Row) -> Result<(), FileProblem> {
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
        self.sheet = sheet;
        self.elastic = Table {
            lines: vec![(0.0, [e1, poisson])],
            from: None,
        };
        Ok(())
    }
}

/// The first lines of a keyword, as many as one temperature has, if the reader takes no others. Further ones are noted.
fn first_of<'r, 'b>(
    block: &Block,
    rows: &'r [&'b Row],
    (lines, alone): (usize, bool),
    unread: &mut UnreadCards,
) -> Result<&'r [&'b Row], FileProblem> {
    let keyword = &block.keyword;
    if rows.is_empty() {
        return Err(keyword.problem(
            "its data line is missing",
            "write its values on the next line",
        ));
    }
    if rows.len() <= lines || !(alone || keyword.has("DEPENDENCIES")) {
        return Ok(rows);
    }
    several(&keyword.name, &keyword.at, unread);
    Ok(rows.get(..lines).unwrap_or(rows))
}

/// Constants by temperature, in ascending order. One line has any temperature.
#[derive(Clone, Debug)]
struct Table<const N: usize> {
    lines: Vec<(f64, [f64; N])>,
    /// The name and the place of its keyword.
    from: Option<(String, At)>,
}

impl<const N: usize> Default for Table<N> {
    fn default() -> Self {
        Table {
            lines: Vec::new(),
            from: None,
        }
    }
}

impl<const N: usize> Table<N> {
    /// Reads the lines of a keyword, whose temperature is behind the constants.
    fn read(
        block: &Block,
        rows: &[&Row],
        constants: impl Fn(&Row) -> Result<[f64; N], FileProblem>,
    ) -> Result<Self, FileProblem> {
        let groups: Vec<&[&Row]> = rows.chunks(1).collect();
        Self::read_groups(block, &groups, N, |group| match group {
            [row, ..] => constants(row),
            [] => Ok([0.0; N]), // never: a chunk has a row
        })
    }

    /// Reads groups of lines. The temperature of each is the entry `place` of its last line.
    fn read_groups(
        block: &Block,
        groups: &[&[&Row]],
        place: usize,
        constants: impl Fn(&[&Row]) -> Result<[f64; N], FileProblem>,
    ) -> Result<Self, FileProblem> {
        let keyword = &block.keyword;
        let mut lines: Vec<(f64, [f64; N])> = Vec::with_capacity(groups.len());
        for group in groups {
            let Some(row) = group.last() else {
                continue;
            };
            let temperature = match groups.len() {
                1 => 0.0, // it does not matter
                _ => row.real(place, "the temperature")?,
            };
            if lines
                .last()
                .is_some_and(|(before, _)| *before >= temperature)
            {
                return Err(row.at.problem(
                    format!("the temperature {temperature} does not follow a lower one"),
                    "write the lines by ascending temperature",
                ));
            }
            lines.push((temperature, constants(group)?));
        }
        let from = Some((format!("*{}", keyword.name), keyword.at.clone()));
        Ok(Table { lines, from })
    }

    /// Whether the constants are the same at all temperatures.
    fn is_constant(&self) -> bool {
        let first = self.lines.first().map(|(_, values)| values);
        self.lines.iter().all(|(_, values)| Some(values) == first)
    }

    /// The constants at a temperature.
    fn at(&self, temperature: f64) -> Option<[f64; N]> {
        let after = self.lines.partition_point(|(at, _)| *at <= temperature);
        match (
            after.checked_sub(1).and_then(|i| self.lines.get(i)),
            self.lines.get(after),
        ) {
            (Some((low, a)), Some((high, b))) => {
                let share = (temperature - low) / (high - low);
                let between = a.iter().zip(b).map(|(a, b)| a + share * (b - a));
                let mut values = *a;
                values.iter_mut().zip(between).for_each(|(v, x)| *v = x);
                Some(values)
            }
            (Some((_, values)), None) | (None, Some((_, values))) => Some(*values),
            (None, None) => None,
        }
    }
}

/// The kind of section that uses a material.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Use {
    /// A solid, which may be anisotropic.
    Solid,
    /// A shell, which may be a lamina.
    Shell,
    /// A beam or truss.
    Line,
}

/// The materials of a file.
#[derive(Debug, Default)]
pub(super) struct Materials {
    entries: BTreeMap<String, Entry>,
    open: Option<String>,
    /// Temperature at the start of the first step.
    temperature: f64,
    /// Whether a step changes the temperature.
    heated: bool,
}

/// Keywords of steps that change the temperature, or may do so by a file that is not read.
const HEAT: &[&str] = &[
    "INCLUDE",
    "TEMPERATURE",
    "HEATTRANSFER",
    "COUPLEDTEMPERATURE-DISPLACEMENT",
    "UNCOUPLEDTEMPERATURE-DISPLACEMENT",
];

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
                elastic: Table::default(),
                solid: Table::default(),
                sheet: None,
                density: Table::default(),
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
                match keyword.key.as_str() {
                    "DENSITY" => entry.read_density(block, &rows, unread)?,
                    _ => entry.read_elasticity(block, &rows, unread)?,
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

    /// Notes a keyword of a step.
    pub fn step(&mut self, keyword: &str) {
        self.heated |= HEAT.contains(&keyword);
    }

    /// Whether constants depend on the temperature.
    pub fn depend_on_temperature(&self) -> bool {
        self.entries
            .values()
            .any(|entry| entry.changing().next().is_some())
    }

    /// Takes the constants at a temperature, which all nodes have at the start, and says so. Without one, or if
    /// a step changes it, constants that depend on it are noted as unread.
    pub fn heat(&mut self, temperature: Option<f64>, unread: &mut UnreadCards) -> Vec<String> {
        let found: Vec<(String, At)> = (self.entries.values())
            .flat_map(|entry| entry.changing().cloned())
            .collect();
        let Some(temperature) = temperature.filter(|_| !self.heated) else {
            for (name, at) in &found {
                several(name.trim_start_matches('*'), at, unread);
            }
            return Vec::new();
        };
        self.temperature = temperature;
        let said = found.iter().map(|(name, at)| {
            format!(
                "{}:{}: {name} depends on the temperature: its constants at {temperature} count, the temperature at the start",
                at.file, at.line
            )
        });
        said.collect()
    }

    /// Whether a material is an anisotropic solid.
    pub fn is_anisotropic(&self, name: &str) -> bool {
        let entry = self.entries.get(&key(name));
        entry.is_some_and(|entry| !entry.solid.lines.is_empty())
    }

    /// The material of a section. An anisotropic solid has the axes of `of` until it gets its own.
    pub fn find(&self, name: &str, user: &Block, of: Use) -> Result<Material, FileProblem> {
        let Some(entry) = self.entries.get(&key(name)) else {
            return Err(user.keyword.problem(
                &format!("the material {name} is missing"),
                "add its *MATERIAL, or *INCLUDE the file that holds it",
            ));
        };
        let density = entry.density.at(self.temperature);
        let isotropic = Material {
            name: entry.name.clone(),
            young: 0.0,
            poisson: 0.0,
            density: density.map_or(0.0, |[density]| density),
            sheet: entry.sheet,
            solid: None,
        };
        if let (Some(constants), Use::Solid) = (entry.solid.at(self.temperature), of) {
            let solid = SolidElasticity {
                stiffness: anisotropic::stiffness(&constants),
                axes: LocalAxes::BASIC,
            };
            if let Some(fault) = stiffness_fault(&solid.stiffness) {
                return Err(entry.at.problem(
                    format!("the material {name} has {fault}"),
                    "check its constants, and the TYPE and the lines of its *ELASTIC",
                ));
            }
            let [young, poisson] = solid.first_constants();
            return Ok(Material {
                young,
                poisson,
                sheet: None,
                solid: Some(solid),
                ..isotropic
            });
        }
        let known = entry.elastic.at(self.temperature);
        let Some([young, poisson]) = known.filter(|_| of == Use::Shell || entry.sheet.is_none())
        else {
            return Err(entry.at.problem(
                format!("a section uses the material {name}, which has no isotropic *ELASTIC"),
                "give it *ELASTIC with Young's modulus and Poisson's ratio; only shells can have TYPE=LAMINA, and only solids ENGINEERING CONSTANTS, ORTHO or ANISO",
            ));
        };
        Ok(Material {
            young,
            poisson,
            ..isotropic
        })
    }
}

/// Notes constants of several temperatures that Eng does not read.
fn several(name: &str, at: &At, unread: &mut UnreadCards) {
    let name = format!("*{name} at several temperatures");
    unread.note(&name, at, Carries::Unknown);
}
