//! Anisotropic solids: `MAT9` and `MAT11`, and their axes, CORDM of `PSOLID`.

use std::collections::BTreeMap;

use super::PropertyCard;
use crate::error::FileProblem;
use crate::mesh::{LocalAxes, SolidElasticity};
use crate::read::nastran::card::Card;
use crate::read::nastran::frames::Systems;
use crate::read::number;

/// CORDM of `PSOLID`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Axes {
    /// Blank, which is the basic system in MSC Nastran and NX Nastran, and in others the element's.
    Blank,
    /// A coordinate system; 0 is the basic one.
    System(u64),
    /// Those of the element: −1, or −2.
    Element,
    /// No number of a system.
    Unknown,
}

impl Axes {
    pub fn read(card: &Card) -> Self {
        let text = card.text(2);
        match (text, number::integer(text)) {
            ("", _) => Axes::Blank,
            (_, Some(-1 | -2)) => Axes::Element,
            (_, Some(id)) => u64::try_from(id).map_or(Axes::Unknown, Axes::System),
            (_, None) => Axes::Unknown,
        }
    }

    /// The number of the system; a blank one is the basic system.
    pub fn system(self) -> u64 {
        match self {
            Axes::System(id) => id,
            Axes::Blank | Axes::Element | Axes::Unknown => 0,
        }
    }

    /// The axes.
    ///
    /// # Errors
    /// The axes of the element, a system that is missing.
    pub fn placed(self, user: &PropertyCard, systems: &Systems) -> Result<LocalAxes, FileProblem> {
        let PropertyCard { name, at, .. } = user;
        match self {
            Axes::Blank => Ok(LocalAxes::BASIC),
            Axes::System(id) => systems.axes(id, &|| name.clone(), at),
            Axes::Element => Err(at.problem(
                format!("{name} has the axes of its anisotropic material along those of each element (CORDM of -1 or -2), and Eng does not make the axes of Nastran's solids"),
                "give CORDM the number of a coordinate system, 0 for the basic one",
            )),
            Axes::Unknown => Err(at.problem(
                format!("{name} has an anisotropic material, and its CORDM is no coordinate system"),
                "give CORDM the number of a coordinate system, 0 for the basic one",
            )),
        }
    }
}

/// What to say about the axes of anisotropic solids.
#[derive(Debug, Default)]
pub(in crate::read::nastran) struct AxesTold {
    /// Properties without CORDM: their number, and the first.
    blank: Option<(usize, String)>,
    /// Curvilinear systems, each with its first property.
    curvilinear: BTreeMap<u64, String>,
}

impl AxesTold {
    /// Notes the axes of a property.
    pub(super) fn note(&mut self, axes: Axes, placed: &LocalAxes, user: &PropertyCard) {
        let place = || format!("{}:{}: {}", user.at.file, user.at.line, user.name);
        match axes {
            Axes::Blank => self.blank.get_or_insert_with(|| (0, place())).0 += 1,
            Axes::System(id) if !placed.is_rectangular() => {
                self.curvilinear.entry(id).or_insert_with(place);
            }
            _ => {}
        }
    }

    /// The sentences.
    pub fn into_doubts(self) -> Vec<String> {
        let blank = self.blank.map(|(count, first)| {
            let others = match count {
                1 => String::new(),
                count => format!(" (as {} more)", count - 1),
            };
            format!(
                "{first}{others} has an anisotropic material and no CORDM: its axes are those of the basic system, as in MSC Nastran and NX Nastran"
            )
        });
        let curvilinear = self.curvilinear.into_iter().map(|(id, first)| {
            format!(
                "{first} has axes of its material in the curvilinear system {id}: Eng takes the axes at each point of integration, and no manual of Nastran states its rule"
            )
        });
        blank.into_iter().chain(curvilinear).collect()
    }
}

/// Constants of an anisotropic solid.
#[derive(Clone, Debug)]
pub(super) struct SolidConstants {
    /// Stiffness in the material's axes.
    pub stiffness: [[f64; 6]; 6],
    /// Density.
    pub density: f64,
}

impl SolidConstants {
    /// `MAT9 MID G11 G12 … G16 G22 / G23 … G36 / G44 … G66 RHO A1 …`: the upper triangle by rows, for stresses and
    /// engineering strains in the order xx, yy, zz, xy, yz, zx.
    pub fn anisotropic(card: &Card) -> Result<Self, FileProblem> {
        let mut stiffness = [[0.0; 6]; 6];
        let entries = (0..6).flat_map(|i| (i..6).map(move |j| (i, j)));
        for (field, (i, j)) in (1..).zip(entries) {
            let x = card.real_or_zero(field, &format!("G{}{}", i + 1, j + 1))?;
            (stiffness[i][j], stiffness[j][i]) = (x, x);
        }
        Ok(SolidConstants {
            stiffness,
            density: card.real_or_zero(22, "RHO")?,
        })
    }

    /// `MAT11 MID E1 E2 E3 NU12 NU13 NU23 G12 / G13 G23 RHO A1 …`.
    pub fn orthotropic(card: &Card) -> Result<Self, FileProblem> {
        let mut constants = [0.0; 9];
        let names = [
            "E1", "E2", "E3", "NU12", "NU13", "NU23", "G12", "G13", "G23",
        ];
        for ((field, constant), name) in (1..).zip(&mut constants).zip(names) {
            *constant = card.real_or_zero(field, name)?;
        }
        let [e1, e2, e3, n12, n13, n23, g12, g13, g23] = constants;
        let density = card.real_or_zero(10, "RHO")?;
        match SolidElasticity::orthotropic([e1, e2, e3], [n12, n13, n23], [g12, g13, g23]) {
            Some(stiffness) => Ok(SolidConstants { stiffness, density }),
            None => Err(card.problem(
                "no elastic solid has these constants",
                "E1, E2, E3 and the shear moduli must be above zero, and NU12 squared below E1/E2, NU13 squared below E1/E3, NU23 squared below E2/E3",
            )),
        }
    }
}
