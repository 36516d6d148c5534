//! Glued bodies of MSC Nastran: `BCTABLE`, or `BCTABL1` with `BCONECT` and `BCONPRG`, and their bodies `BCBODY` and
//! `BCBODY1` (MSC Nastran, Quick Reference Guide).
//!
//! The nodes of the secondary body's outer faces follow the primary body where these are within ERROR of each other. Nodes
//! keep their distance. Contact that is not glued, bodies of shells, whose distance MSC counts from their surfaces, and
//! pairs without ERROR are noted as not read.

use std::collections::{BTreeMap, BTreeSet};

use super::{Glue, Joining};
use crate::error::FileProblem;
use crate::mesh::Carries;
use crate::read::nastran::card::{Card, Ids};
use crate::read::nastran::lines::At;
use crate::read::nastran::sections::{CaseControl, Selection};
use crate::read::nastran::unread::UnreadCards;
use crate::read::number;

/// How two bodies touch.
#[derive(Clone, Copy, Debug, Default)]
struct Parameters {
    /// IGLUE: zero is contact that opens.
    glue: i64,
    /// ERROR.
    search: Option<f64>,
}

/// Bodies that follow others.
#[derive(Clone, Debug)]
struct Pairs {
    /// `BCTABLE 2`.
    name: String,
    secondary: Vec<u64>,
    primary: Vec<u64>,
    parameters: Parameters,
    /// `BCONPRG` of a `BCONECT`.
    geometry: Option<u64>,
    at: At,
}

/// A `BCBODY`.
#[derive(Clone, Debug)]
struct Body {
    surface: u64,
    /// Its behaviour, if it does not deform.
    rigid: Option<String>,
    at: At,
}

/// Cards of contact bodies.
#[derive(Debug, Default)]
pub(super) struct Contact {
    bodies: BTreeMap<u64, Body>,
    /// Pairs of `BCTABLE`.
    tables: BTreeMap<u64, Vec<Pairs>>,
    /// The numbers of `BCONECT` in each `BCTABL1`.
    lists: BTreeMap<u64, Ids>,
    connections: BTreeMap<u64, Pairs>,
    parameters: BTreeMap<u64, Parameters>,
    /// ERROR of `BCPARA`.
    search: Option<f64>,
}

impl Contact {
    /// Reads a card; `false` if it is none of these.
    pub fn read(&mut self, card: &Card) -> Result<bool, FileProblem> {
        match card.name.as_str() {
            "BCBODY" => self.body(card, 2, 3)?,
            "BCBODY1" => self.body(card, 3, 4)?,
            "BCTABLE" => self.table(card)?,
            "BCTABL1" => {
                let ids = card.ids(1, card.len(), "ID")?;
                let list = self.lists.entry(number_or_zero(card, "BCID")?).or_default();
                list.ranges.extend(ids.ranges);
            }
            "BCONECT" => self.connection(card)?,
            "BCONPRG" => {
                let mut parameters = Parameters::default();
                for name in (2..card.len()).step_by(2) {
                    match card.text(name) {
                        "IGLUE" => parameters.glue = whole_number(card, name + 1, "IGLUE")?,
                        "ERROR" => parameters.search = card.optional_real(name + 1, "ERROR")?,
                        _ => {}
                    }
                }
                self.parameters.insert(card.id(0, "BCGPID")?, parameters);
            }
            "BCPARA" => {
                let named = (1..card.len()).find(|i| card.text(*i) == "ERROR");
                if let Some(name) = named {
                    self.search = card.optional_real(name + 1, "ERROR")?;
                }
            }
            _ => return Ok(false),
        }
        Ok(true)
    }

    /// Whether the deck has neither bodies nor pairs of them.
    pub fn is_empty(&self) -> bool {
        self.bodies.is_empty()
            && self.tables.is_empty()
            && self.lists.is_empty()
            && self.connections.is_empty()
    }

    /// `BCBODY BID DIM BEHAV BSID` and `BCBODY1 BID BPID DIM BEHAV BSID`.
    fn body(&mut self, card: &Card, behaviour: usize, surface: usize) -> Result<(), FileProblem> {
        let rigid = match card.text(behaviour) {
            "" | "DEFORM" => None,
            other => Some(other.to_string()),
        };
        let body = Body {
            surface: card.optional_id(surface, "BSID")?.unwrap_or(0),
            rigid,
            at: card.at.clone(),
        };
        self.bodies.insert(card.id(0, "BID")?, body);
        Ok(())
    }

    /// `BCTABLE ID IDSCND IDPRIM NGROUP / SECNDRY IDSEC1 ERROR FNTOL FRIC CINTERF IGLUE / … / PRIMARY IDPRIM1 … IDPRIM7 /
    /// blank IDPRIM8 …`. Older decks write SLAVE and MASTERS. IDSCND and IDPRIM are a pair with all defaults.
    fn table(&mut self, card: &Card) -> Result<(), FileProblem> {
        let id = number_or_zero(card, "ID")?;
        let pairs = |secondary: Vec<u64>, parameters| Pairs {
            name: format!("BCTABLE {id}"),
            secondary,
            primary: Vec::new(),
            parameters,
            geometry: None,
            at: card.at.clone(),
        };
        let mut found: Vec<Pairs> = Vec::new();
        let both = [
            card.optional_id(1, "IDSCND")?,
            card.optional_id(2, "IDPRIM")?,
        ];
        if let [Some(secondary @ 1..), Some(primary @ 1..)] = both {
            found.push(Pairs {
                primary: vec![primary],
                ..pairs(vec![secondary], Parameters::default())
            });
        }
        let mut listing = false;
        for line in (8..card.len()).step_by(8) {
            match Word::of(card.text(line)) {
                Word::Secondary => {
                    let parameters = Parameters {
                        glue: whole_number(card, line + 6, "IGLUE")?,
                        search: card.optional_real(line + 2, "ERROR")?,
                    };
                    found.push(pairs(vec![card.id(line + 1, "IDSEC1")?], parameters));
                    listing = false;
                }
                Word::Primary => listing = true,
                // parameters of contact between the two
                Word::Blank => {}
                Word::Other => {
                    return Err(card.problem(
                        &format!("\"{}\" begins no list of bodies", card.text(line)),
                        "write SECNDRY (or SLAVE) and PRIMARY (or MASTERS) before their bodies",
                    ));
                }
            }
            if let (true, Some(last)) = (listing, found.last_mut()) {
                last.primary.extend(listed(card, line)?);
            }
        }
        if found.is_empty() {
            found.push(pairs(Vec::new(), Parameters::default()));
        }
        self.tables.entry(id).or_default().extend(found);
        Ok(())
    }

    /// `BCONECT ID BCGPID BCPPID IDSCND IDPRIM / SECNDRY IDSEC1 … / PRIMARY IDPRIM1 …`.
    fn connection(&mut self, card: &Card) -> Result<(), FileProblem> {
        let id = number_or_zero(card, "ID")?;
        let mut pairs = Pairs {
            name: format!("BCONECT {id}"),
            secondary: card
                .optional_id(3, "IDSCND")?
                .filter(|id| *id > 0)
                .into_iter()
                .collect(),
            primary: card
                .optional_id(4, "IDPRIM")?
                .filter(|id| *id > 0)
                .into_iter()
                .collect(),
            parameters: Parameters::default(),
            geometry: card.optional_id(1, "BCGPID")?.filter(|id| *id > 0),
            at: card.at.clone(),
        };
        let stated = [!pairs.secondary.is_empty(), !pairs.primary.is_empty()];
        let mut primary = false;
        for line in (8..card.len()).step_by(8) {
            match Word::of(card.text(line)) {
                Word::Secondary => primary = false,
                Word::Primary => primary = true,
                Word::Blank => {}
                Word::Other => continue,
            }
            let own = listed(card, line)?;
            match primary {
                false if !stated[0] => pairs.secondary.extend(own),
                true if !stated[1] => pairs.primary.extend(own),
                _ => {}
            }
        }
        self.connections.insert(id, pairs);
        Ok(())
    }

    /// The pairs that case control selects.
    fn selected(&self, selection: &Selection) -> Result<Vec<Pairs>, FileProblem> {
        let with_parameters = |pairs: &Pairs| {
            let own = pairs.geometry.and_then(|id| self.parameters.get(&id));
            Pairs {
                parameters: own.copied().unwrap_or(pairs.parameters),
                ..pairs.clone()
            }
        };
        let of_list = |ids: &Ids| {
            let own = self.connections.iter().filter(|(id, _)| ids.holds(**id));
            own.map(|(_, pairs)| with_parameters(pairs))
                .collect::<Vec<_>>()
        };
        let (number, at) = match selection {
            Selection::Nothing => return Ok(Vec::new()),
            Selection::All => {
                let mut all: Vec<Pairs> = self.tables.values().flatten().cloned().collect();
                all.extend(self.connections.values().map(with_parameters));
                return Ok(all);
            }
            Selection::One(number, at) => (number, at),
        };
        let found = match (self.tables.get(number), self.lists.get(number)) {
            (Some(table), _) => table.clone(),
            (None, Some(list)) => of_list(list),
            (None, None) => of_list(&Ids::one(*number)),
        };
        match found.is_empty() {
            false => Ok(found),
            true => Err(at.problem(
                format!("BCONTACT = {number} selects no pair of bodies"),
                "add the BCTABLE, or the BCTABL1 with its BCONECT",
            )),
        }
    }

    /// Adds the ties of the selected pairs.
    ///
    /// # Errors
    /// A selected table, body or region that is missing, a body without a face.
    pub fn join(
        &self,
        glue: &Glue,
        joining: &mut Joining,
        case: &CaseControl,
        unread: &mut UnreadCards,
    ) -> Result<(), FileProblem> {
        if let (Some(at), false) = (&case.all_contact, self.bodies.is_empty()) {
            unread.note("BCONTACT = ALLBODY", at, Carries::Structure);
            return Ok(());
        }
        if matches!(case.bcontact, Selection::Nothing) {
            let first = self
                .tables
                .values()
                .flatten()
                .chain(self.connections.values());
            joining.doubts.extend(first.take(1).map(|pairs| {
                format!(
                    "{}:{}: no BCONTACT = in case control selects bodies, and they stay apart, as in Nastran",
                    pairs.at.file, pairs.at.line
                )
            }));
            return Ok(());
        }
        let mut joined: BTreeSet<[u64; 2]> = BTreeSet::new();
        for pairs in self.selected(&case.bcontact)? {
            if !matches!(pairs.parameters.glue, 1..=4) {
                let name = "contact of bodies without IGLUE (BCTABLE, BCONECT)";
                unread.note(name, &pairs.at, Carries::Structure);
                continue;
            }
            let Some(search) = pairs.parameters.search.or(self.search) else {
                let name = "glued bodies without ERROR (BCTABLE, BCONPRG, BCPARA)";
                unread.note(name, &pairs.at, Carries::Structure);
                continue;
            };
            if search.is_nan() || search < 0.0 {
                return Err(pairs.at.problem(
                    format!("{}: ERROR is {search}", pairs.name),
                    "state the largest distance between the glued bodies",
                ));
            }
            for secondary in &pairs.secondary {
                for primary in &pairs.primary {
                    // the same surfaces the other way around are glued already
                    let known = joined.contains(&[*primary, *secondary]);
                    if secondary != primary && !known && joined.insert([*secondary, *primary]) {
                        let bodies = [*secondary, *primary];
                        self.pair(glue, joining, (&pairs, bodies, search), unread)?;
                    }
                }
            }
        }
        Ok(())
    }

    /// Ties a body to another.
    fn pair(
        &self,
        glue: &Glue,
        joining: &mut Joining,
        (pairs, bodies, search): (&Pairs, [u64; 2], f64),
        unread: &mut UnreadCards,
    ) -> Result<(), FileProblem> {
        let mut faces = [Vec::new(), Vec::new()];
        for (faces, id) in faces.iter_mut().zip(bodies) {
            let Some(body) = self.bodies.get(&id) else {
                return Err(pairs.at.problem(
                    format!("{} glues body {id}, which is missing", pairs.name),
                    "add its BCBODY or BCBODY1",
                ));
            };
            if let Some(rigid) = &body.rigid {
                return Err(body.at.problem(
                    format!("{} glues body {id}, which is {rigid}", pairs.name),
                    "glue bodies that deform; a body on a rigid surface needs supports",
                ));
            }
            let parts = glue.parts(body.surface, &body.at, &format!("body {id} has"))?;
            let (own, shells) = joining.faces.body(&parts);
            if shells {
                let name = "glued bodies of shells (BCBODY)";
                unread.note(name, &body.at, Carries::Structure);
                return Ok(());
            }
            if own.is_empty() {
                return Err(body.at.problem(
                    format!("body {id} has no solid"),
                    "give the numbers of its elements in BSURF, or of its properties in BCPROP",
                ));
            }
            *faces = own;
        }
        let [secondary, primary] = bodies;
        let place = format!("{}:{}: {}", pairs.at.file, pairs.at.line, pairs.name);
        let [source, target] = &faces;
        let followers = joining.tie([source, target], search).map(|(tied, _)| {
            let followers: BTreeSet<u32> = tied.followers().collect();
            let gap = tied.gap;
            joining.keep(tied);
            (followers.len(), gap)
        });
        joining.doubts.push(match followers {
            None | Some((0, _)) => format!(
                "{place} glues no node of body {secondary} to body {primary}: none is free within ERROR = {search}, and they stay apart"
            ),
            Some((count, gap)) => format!(
                "{place} glues {count} nodes of body {secondary} to body {primary}, within ERROR = {search} and over a gap of up to {gap:.3e} (units of the file)"
            ),
        });
        Ok(())
    }
}

/// The first word of a line.
enum Word {
    Secondary,
    Primary,
    Blank,
    Other,
}

impl Word {
    fn of(text: &str) -> Self {
        match text {
            "" => Word::Blank,
            text if text.starts_with("SEC") || text.starts_with("SLAV") => Word::Secondary,
            text if text.starts_with("PRIM") || text.starts_with("MAST") => Word::Primary,
            _ => Word::Other,
        }
    }
}

/// The bodies in a line after its first field.
fn listed(card: &Card, line: usize) -> Result<Vec<u64>, FileProblem> {
    let own = (line + 1..line + 8).map(|i| card.optional_id(i, "ID of a body"));
    let own = own.collect::<Result<Vec<_>, _>>()?;
    Ok(own.into_iter().flatten().filter(|id| *id > 0).collect())
}

/// The number of a table, which may be 0 or blank.
fn number_or_zero(card: &Card, field: &str) -> Result<u64, FileProblem> {
    Ok(card.optional_id(0, field)?.unwrap_or(0))
}

fn whole_number(card: &Card, i: usize, field: &str) -> Result<i64, FileProblem> {
    match card.text(i) {
        "" => Ok(0),
        text => number::integer(text).ok_or_else(|| {
            card.problem(
                &format!("{field} is \"{text}\", no whole number"),
                "write 0 for contact, or 1 to 4 for glue",
            )
        }),
    }
}
