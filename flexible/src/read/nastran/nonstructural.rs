//! Non-structural mass: `NSM`, `NSM1`, `NSML`, `NSML1`, `NSMADD`. A value is a mass per area of shells or per length of
//! lines; `NSML` and `NSML1` state a mass, which all their elements share by area or length (MSC Nastran, Quick Reference
//! Guide).

use std::collections::{BTreeMap, BTreeSet};

use super::card::{Card, Ids};
use super::elements::{ElementCard, Extra, Family};
use super::lines::At;
use super::properties::Properties;
use super::sections::Selection;
use super::supports::{add_sum, chosen};
use crate::error::FileProblem;

/// The elements of an entry.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Target {
    /// By their own numbers.
    Elements,
    /// Those of `CONROD`, by their own numbers.
    Rods,
    /// By their property, whose card has this name; `PBARL` is `PBAR`, `PCOMP` and `PCOMPG` are `PSHELL`.
    Property(&'static str),
}

#[derive(Clone, Debug)]
struct Entry {
    set: u64,
    target: Target,
    value: f64,
    /// `None` means all.
    ids: Option<Ids>,
    /// Whether the value is a mass that the elements share.
    lumped: bool,
    at: At,
}

/// Entries of non-structural mass.
#[derive(Debug, Default)]
pub(super) struct NonStructural {
    entries: Vec<Entry>,
    sets: BTreeSet<u64>,
    sums: BTreeMap<u64, Vec<u64>>,
}

/// The area or length of an element.
pub(super) type Measure<'a> = &'a dyn Fn(&ElementCard) -> Result<f64, FileProblem>;

impl NonStructural {
    /// Reads a card; `false` if it is none of these.
    pub fn read(&mut self, card: &Card) -> Result<bool, FileProblem> {
        let lumped = matches!(card.name.as_str(), "NSML" | "NSML1");
        match card.name.as_str() {
            "NSMADD" => add_sum(&mut self.sums, card)?,
            "NSM" | "NSML" => {
                for pair in (2..card.len()).step_by(2) {
                    let ids = Ids::one(card.id(pair, "ID")?);
                    self.keep(card, card.real(pair + 1, "VALUE")?, Some(ids), lumped)?;
                }
            }
            "NSM1" | "NSML1" => {
                let ids = match card.text(3) {
                    "ALL" => None,
                    _ => Some(card.ids(3, card.len(), "ID")?),
                };
                self.keep(card, card.real(2, "VALUE")?, ids, lumped)?;
            }
            _ => return Ok(false),
        }
        Ok(true)
    }

    fn keep(
        &mut self,
        card: &Card,
        value: f64,
        ids: Option<Ids>,
        lumped: bool,
    ) -> Result<(), FileProblem> {
        let target = match card.text(1) {
            "ELEMENT" => Target::Elements,
            "CONROD" => Target::Rods,
            "PSHELL" | "PCOMP" | "PCOMPG" => Target::Property("PSHELL"),
            "PBAR" | "PBARL" => Target::Property("PBAR"),
            "PBEAM" | "PBEAML" => Target::Property("PBEAM"),
            "PROD" => Target::Property("PROD"),
            "PTUBE" => Target::Property("PTUBE"),
            other => {
                return Err(card.problem(
                    &format!("TYPE is \"{other}\", and Eng adds no mass to it"),
                    "write PSHELL, PCOMP, PBAR, PBARL, PBEAM, PBEAML, PROD, PTUBE, CONROD or ELEMENT, or give the mass in the property card",
                ));
            }
        };
        let set = card.id(0, "SID")?;
        self.sets.insert(set);
        self.entries.push(Entry {
            set,
            target,
            value,
            ids,
            lumped,
            at: card.at.clone(),
        });
        Ok(())
    }

    /// The added mass per area or length of each element, and a doubt about sets that no entry selects.
    ///
    /// # Errors
    /// A selected set that is missing; several sets without a selection; a mass for no element, for shells and lines at
    /// once, or twice for one element.
    pub fn added(
        &self,
        selection: &Selection,
        cards: &[ElementCard],
        properties: &Properties,
        measure: Measure,
    ) -> Result<(Vec<f64>, Option<String>), FileProblem> {
        let mut added = vec![0.0; cards.len()];
        let Some(first) = self.entries.first() else {
            return Ok((added, None));
        };
        let place = format!("{}:{}", first.at.file, first.at.line);
        if matches!(selection, Selection::Nothing) {
            let doubt = format!(
                "{place}: no NSM = in case control selects the non-structural mass, and it is not used, as in Nastran"
            );
            return Ok((added, Some(doubt)));
        }
        let sets = chosen(selection, &self.sums, &self.sets, "NSM")?;
        if sets.is_none() && (self.sets.len() > 1 || !self.sums.is_empty()) {
            return Err(first.at.problem(
                "several sets of non-structural mass, and no case control that selects one",
                "read the deck with its case control, with NSM = and the number of the set",
            ));
        }
        for entry in self
            .entries
            .iter()
            .filter(|entry| sets.as_ref().is_none_or(|sets| sets.contains(&entry.set)))
        {
            entry.add(cards, properties, measure, &mut added)?;
        }
        Ok((added, None))
    }
}

impl Entry {
    fn add(
        &self,
        cards: &[ElementCard],
        properties: &Properties,
        measure: Measure,
        added: &mut [f64],
    ) -> Result<(), FileProblem> {
        let mut found = Vec::new();
        let (mut shells, mut whole) = (0, 0.0);
        for (index, card) in cards.iter().enumerate() {
            let id = match self.target {
                Target::Elements if card.family == Family::Solid => continue,
                Target::Elements => card.id,
                Target::Rods if matches!(card.extra, Extra::Rod(..)) => card.id,
                Target::Property(name)
                    if properties.group(card.family, card.property) == Some(name) =>
                {
                    card.property
                }
                _ => continue,
            };
            let times = self.ids.as_ref().map_or(1, |ids| ids.times(id));
            if times > 1 && self.lumped {
                return Err(self.at.problem(
                    format!("the list of the mass has {id} more than once"),
                    "list each number once",
                ));
            }
            if times > 0 {
                found.push(index);
                if self.lumped {
                    whole += measure(card)?;
                }
                shells += usize::from(card.family == Family::Shell);
            }
        }
        // numbers without elements are ignored, but a mass must be somewhere
        if self.lumped && (found.is_empty() || whole <= 0.0) {
            return Err(self.at.problem(
                "the mass is that of no element of the deck",
                "correct the numbers, or INCLUDE the file with the elements",
            ));
        }
        if shells != 0 && shells != found.len() {
            return Err(self.at.problem(
                "one value for shells and for lines",
                "state a mass per area for the shells, and another one per length for the lines",
            ));
        }
        let value = if self.lumped {
            self.value / whole
        } else {
            self.value
        };
        for index in found {
            added[index] += value;
        }
        Ok(())
    }
}
