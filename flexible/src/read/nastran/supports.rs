//! Held freedoms and interface freedoms: `SPC`, `SPC1`, `SPCADD`, `PS` of grid points, `ASET`, `ASET1` and
//! similar cards.

use std::collections::{BTreeMap, BTreeSet};

use super::card::{Card, Ids};
use super::grids::{GridCard, Lookup};
use super::lines::At;
use super::sections::Selection;
use super::unread::UnreadCards;
use crate::error::FileProblem;
use crate::mesh::{Carries, Node, SCALAR, Support};
use crate::read::held::HoldingCards;

/// Most modal coordinates of a range; a card may state more numbers than there are points. A choice: far more
/// than the modes of any body, and their list still takes no room worth mention.
const MOST_MODAL: usize = 100_000;

#[derive(Clone, Debug)]
struct Entry {
    /// Set, if the card has one.
    set: u64,
    /// Points and their freedoms.
    parts: Vec<(Ids, u8)>,
    /// Whether the card moves its freedoms instead of holding them.
    moved: bool,
    name: String,
    at: At,
}

/// Cards of held and interface freedoms.
#[derive(Debug, Default)]
pub(super) struct Supports {
    held: Vec<Entry>,
    interface: Vec<Entry>,
    /// Sets of supports that combine other sets.
    support_sums: BTreeMap<u64, Vec<u64>>,
    /// Sets of equations that combine other sets.
    equation_sums: BTreeMap<u64, Vec<u64>>,
    equation_sets: BTreeSet<u64>,
    /// Scalar points of modal coordinates (`QSET`).
    modal: Vec<u64>,
    /// Points of an external superelement with their freedoms (`EXTRN`).
    external: Vec<(u64, u8)>,
    /// Points and freedoms of the rows of a recovery matrix (`DTI,TUG1`).
    recovered: Vec<(u64, u8)>,
    /// The first card that asks for a static condensation: its name and place.
    condensed: Option<(String, At)>,
}

impl Supports {
    /// Reads a card; `false` if it is none of these.
    pub fn read(&mut self, card: &Card) -> Result<bool, FileProblem> {
        match card.name.as_str() {
            "SPC" => {
                let mut parts = Vec::new();
                let mut moved = false;
                for i in [1, 4] {
                    if i > 1 && card.is_blank(i) {
                        continue;
                    }
                    card.id(i, "G")?;
                    parts.push((card.ids(i, i + 1, "G")?, components(card, i + 1)?));
                    moved |= card.real_or_zero(i + 2, "D")? != 0.0;
                }
                let mut entry = entry(card, card.id(0, "SID")?, parts);
                entry.moved = moved;
                self.held.push(entry);
            }
            "SPC1" => {
                let parts = vec![(list_of(card, 2)?, components(card, 1)?)];
                self.held.push(entry(card, card.id(0, "SID")?, parts));
            }
            "ASET" | "BSET" | "CSET" => {
                let mut parts = Vec::new();
                for i in [0, 2, 4, 6] {
                    if i == 0 || !card.is_blank(i) {
                        card.id(i, "ID")?;
                        parts.push((card.ids(i, i + 1, "ID")?, components(card, i + 1)?));
                    }
                }
                self.interface.push(entry(card, 0, parts));
            }
            "ASET1" | "BSET1" | "CSET1" => {
                let parts = vec![(list_of(card, 1)?, components(card, 0)?)];
                self.interface.push(entry(card, 0, parts));
            }
            "QSET" => {
                for i in [0, 2, 4, 6] {
                    if i == 0 || !card.is_blank(i) {
                        self.modal.push(card.id(i, "ID")?);
                    }
                }
            }
            "QSET1" => {
                for range in list_of(card, 1)?.ranges {
                    let step = usize::try_from(range.step).unwrap_or(usize::MAX).max(1);
                    let numbers = (range.from..=range.to).step_by(step);
                    self.modal.extend(numbers.take(MOST_MODAL));
                }
            }
            "EXTRN" => {
                let mut i = 0;
                while i < card.len() {
                    let id = card.id(i, "GID")?;
                    let components = match card.text(i + 1) {
                        "0" => 0,
                        _ => components(card, i + 1)?,
                    };
                    self.external.push((id, components));
                    i += 2;
                }
            }
            // record 2 lists the rows; the others repeat sizes and names
            "DTI" if card.text(0) == "TUG1" && card.text(1) == "2" => {
                self.recovered = recovered_rows(card)?;
            }
            "OMIT" | "OMIT1" => {
                self.condensed
                    .get_or_insert_with(|| (card.name.clone(), card.at.clone()));
                return Ok(false);
            }
            "SPCADD" => add_sum(&mut self.support_sums, card)?,
            "MPCADD" => add_sum(&mut self.equation_sums, card)?,
            "MPC" => {
                self.equation_sets.insert(card.id(0, "SID")?);
                return Ok(false);
            }
            _ => return Ok(false),
        }
        Ok(true)
    }

    /// The held freedoms of a mesh, node by node: those of the grid points themselves, and those of the
    /// selected set, or of all sets if case control selects none.
    pub fn supports(
        &self,
        grids: &[GridCard],
        lookup: &Lookup,
        selection: &Selection,
        scalars: &[u64],
        cards: &mut HoldingCards,
        unread: &mut UnreadCards,
    ) -> Result<Vec<Support>, FileProblem> {
        let mut bits: BTreeMap<u32, u8> = BTreeMap::new();
        for (index, grid) in grids.iter().enumerate() {
            if let Some(held) = grid.held.filter(|held| *held != 0) {
                bits.insert(index as u32, held); // as many as nodes, which are u32
                cards.note("PS of GRID", &grid.at, false);
            }
        }
        let sets = self.held.iter().map(|entry| entry.set).collect();
        let selected = chosen(selection, &self.support_sums, &sets, "SPC")?;
        for entry in &self.held {
            if selected
                .as_ref()
                .is_some_and(|sets| !sets.contains(&entry.set))
            {
                unread.note("SPC of sets not selected", &entry.at, Carries::Nothing);
                continue;
            }
            cards.note(&entry.name, &entry.at, entry.moved);
            collect(entry, lookup, &mut bits)?;
            let of_scalars = entry
                .parts
                .iter()
                .filter(|(_, components)| *components == 0);
            for (ids, _) in of_scalars {
                let named = (0u32..).zip(scalars).filter(|(_, id)| ids.holds(**id));
                bits.extend(named.map(|(index, _)| (SCALAR | index, 1)));
            }
        }
        Ok(list(bits))
    }

    /// The note about a static condensation (Guyan) that a deck of modes asks for by naming the freedoms that
    /// are omitted or kept.
    pub fn condensation(&self) -> Option<String> {
        let kept = self.interface.first();
        let (name, at) = (self.condensed.as_ref())
            .map(|(name, at)| (name, at))
            .or_else(|| kept.map(|entry| (&entry.name, &entry.at)))?;
        Some(format!(
            "{}:{}: {name} asks for modes of the kept freedoms alone (Guyan's condensation), and the modes here are those of all; their frequencies are lower",
            at.file, at.line
        ))
    }

    /// The interface freedoms of a mesh, node by node. Scalar points in these sets are modal coordinates and
    /// no nodes.
    pub fn interface(&self, lookup: &Lookup) -> Result<Vec<Support>, FileProblem> {
        let mut bits = BTreeMap::new();
        for entry in &self.interface {
            collect(entry, lookup, &mut bits)?;
        }
        Ok(list(bits))
    }

    /// The freedoms of matrices beside the deck, by ascending number: those of `EXTRN`, else those of the
    /// sets a and q. Empty if `EXTRN` has another order, because the order of the rows is not certain then.
    pub fn boundary(
        &self,
        interface: &[Support],
        nodes: &[Node],
        scalar: &Lookup,
    ) -> Vec<(u64, u8)> {
        let rows = |id: u64, components: u8| {
            let freedoms = (1..=6u8).filter(move |f| components >> (f - 1) & 1 == 1);
            freedoms
                .chain((components == 0).then_some(0))
                .map(move |f| (id, f))
        };
        let mut points = self.external.clone();
        if points.is_empty() {
            let modal = self.modal.iter().filter(|id| scalar.is_scalar(**id));
            let kept = interface.iter().filter_map(|support| {
                let node = nodes.get(support.node as usize)?;
                Some((node.id, support.components))
            });
            points.extend(kept.chain(modal.map(|id| (*id, 0))));
            points.sort_unstable();
        }
        match points.is_sorted() {
            true => points
                .into_iter()
                .flat_map(|(id, components)| rows(id, components))
                .collect(),
            false => Vec::new(),
        }
    }

    /// Points and freedoms of the rows of the recovery matrix of displacements.
    pub fn recovered(&self) -> Vec<(u64, u8)> {
        self.recovered.clone()
    }

    /// The sets of equations that apply; `None` means all.
    pub fn equations(&self, selection: &Selection) -> Result<Option<BTreeSet<u64>>, FileProblem> {
        chosen(selection, &self.equation_sums, &self.equation_sets, "MPC")
    }
}

/// First field of the list in record 2 of `DTI,TUG1`, after blank fields and two times the words TYPE, ID, COMP, ROW.
const FIRST_ROW: usize = 16;

/// The rows that record 2 of `DTI,TUG1` lists, as `EXTSEOUT` of MSC and NX Nastran writes it: TYPE (1 a grid point, 2 a scalar
/// point), ID, number of freedoms, number of the first row. pyYeti reads it in this way (`nastran.bulk.rddtipch`).
fn recovered_rows(card: &Card) -> Result<Vec<(u64, u8)>, FileProblem> {
    let mut rows = Vec::new();
    let mut i = FIRST_ROW;
    while i < card.len() && card.text(i) != "ENDREC" {
        let (kind, id) = (card.id(i, "TYPE")?, card.id(i + 1, "ID")?);
        let (count, row) = (card.id(i + 2, "COMP")?, card.id(i + 3, "ROW")?);
        if count > 6 || row != rows.len() as u64 + 1 {
            return Err(card.problem(
                &format!(
                    "point {id} has {count} freedoms from row {row} on, after {} rows",
                    rows.len()
                ),
                "write or copy the file again: points have six freedoms at most, and their rows follow each other",
            ));
        }
        rows.extend((1..=count as u8).map(|freedom| (id, if kind == 1 { freedom } else { 0 })));
        i += 4;
    }
    Ok(rows)
}

fn entry(card: &Card, set: u64, parts: Vec<(Ids, u8)>) -> Entry {
    Entry {
        set,
        parts,
        moved: false,
        name: card.name.clone(),
        at: card.at.clone(),
    }
}

/// Freedoms in a field. A blank field, as for scalar points, gives none.
fn components(card: &Card, field: usize) -> Result<u8, FileProblem> {
    Ok(card.optional_components(field, "C")?.unwrap_or(0))
}

/// The list of points from a field to the end, which can't be empty.
fn list_of(card: &Card, from: usize) -> Result<Ids, FileProblem> {
    let ids = card.ids(from, card.len(), "G")?;
    if ids.ranges.is_empty() {
        card.id(from, "G1")?;
    }
    Ok(ids)
}

pub(super) fn add_sum(sums: &mut BTreeMap<u64, Vec<u64>>, card: &Card) -> Result<(), FileProblem> {
    let mut parts = Vec::new();
    for i in 1..card.len() {
        parts.extend(card.optional_id(i, "S")?);
    }
    sums.entry(card.id(0, "SID")?).or_default().extend(parts);
    Ok(())
}

/// The sets of a selection; `None` without a selection.
pub(super) fn chosen(
    selection: &Selection,
    sums: &BTreeMap<u64, Vec<u64>>,
    sets: &BTreeSet<u64>,
    name: &str,
) -> Result<Option<BTreeSet<u64>>, FileProblem> {
    let (selected, at) = match selection {
        Selection::All => return Ok(None),
        Selection::Nothing => return Ok(Some(BTreeSet::new())),
        Selection::One(selected, at) => (selected, at),
    };
    let mut found = BTreeSet::new();
    let mut open = vec![*selected];
    while let Some(set) = open.pop() {
        if found.insert(set) {
            open.extend(sums.get(&set).into_iter().flatten());
        }
    }
    // a selection of equations is allowed even if the deck has no equations
    if found.is_disjoint(sets) && (name == "SPC" || !sets.is_empty()) {
        return Err(at.problem(
            format!("{name} = {selected} selects a set that is missing"),
            format!("add the {name} cards of this set; without a selection, all sets apply"),
        ));
    }
    Ok(Some(found))
}

fn collect(
    entry: &Entry,
    lookup: &Lookup,
    bits: &mut BTreeMap<u32, u8>,
) -> Result<(), FileProblem> {
    let user = || format!("{} card", entry.name);
    for (ids, components) in &entry.parts {
        if *components == 0 {
            // the numbers are scalar points, which need no card of their own; no grid point has one of them
            if lookup.existing(ids).0.is_empty() {
                continue;
            }
            return Err(entry.at.problem(
                format!("{} states no freedoms for its grid points", entry.name),
                "give the freedoms, each from 1 to 6",
            ));
        }
        for node in lookup.all(ids, &user, &entry.at)? {
            *bits.entry(node).or_default() |= components;
        }
    }
    Ok(())
}

fn list(bits: BTreeMap<u32, u8>) -> Vec<Support> {
    bits.into_iter()
        .map(|(node, components)| Support { node, components })
        .collect()
}
