//! Rules between freedoms: `RBE2`, `RBE3`, `RBAR`, `RBAR1`, `RBE1`, `MPC`.

use super::card::{Card, Ids};
use super::grids::Lookup;
use super::lines::At;
use super::masses::distinct;
use super::number;
use super::unread::UnreadCards;
use crate::error::FileProblem;
use crate::mesh::{Carries, Tie};

const ALL: u8 = 0b11_1111;

#[derive(Clone, Debug)]
enum Kind {
    Rigid {
        independent: u64,
        dependent: Vec<(Ids, u8)>,
    },
    Averaging {
        reference: u64,
        components: u8,
        groups: Vec<(Ids, f64, u8)>,
    },
    /// Grid point, freedom, coefficient.
    Equation(Vec<(u64, Option<u8>, f64)>),
}

/// A card of a tie. The number of an equation is that of its set.
#[derive(Clone, Debug)]
struct TieCard {
    order: u64,
    id: u64,
    kind: Kind,
    name: String,
    at: At,
}

/// Cards of ties.
#[derive(Debug, Default)]
pub(super) struct Ties {
    cards: Vec<TieCard>,
}

impl Ties {
    /// Reads a card; `false` where it is none of these.
    pub fn read(&mut self, card: &Card) -> Result<bool, FileProblem> {
        let kind = match card.name.as_str() {
            "RBE2" => spider(card)?,
            "RBE3" => averaging(card)?,
            "RBAR" => bar(card)?,
            "RBAR1" => Kind::Rigid {
                independent: card.id(1, "GA")?,
                dependent: vec![(
                    card.ids(2, 3, "GB")?,
                    card.optional_components(3, "CB")?.unwrap_or(ALL),
                )],
            },
            "RBE1" => general(card)?,
            "MPC" => equation(card)?,
            _ => return Ok(false),
        };
        self.cards.push(TieCard {
            order: card.order,
            id: card.id(0, "EID")?,
            kind,
            name: card.name.clone(),
            at: card.at.clone(),
        });
        Ok(true)
    }

    /// The ties of a mesh; equations only of the sets that `selected` lets through.
    pub fn ties(
        &mut self,
        lookup: &Lookup,
        selected: &dyn Fn(u64) -> bool,
        unread: &mut UnreadCards,
    ) -> Result<Vec<Tie>, FileProblem> {
        self.cards.sort_by_key(|card| card.order);
        let rigid = |card: &&TieCard| !matches!(card.kind, Kind::Equation(_));
        distinct(
            "rigid element",
            self.cards
                .iter()
                .filter(rigid)
                .map(|card| (card.id, &card.at)),
        )?;
        let mut ties = Vec::with_capacity(self.cards.len());
        for card in &self.cards {
            if let Kind::Equation(_) = card.kind
                && !selected(card.id)
            {
                unread.note("MPC of sets not selected", &card.at, Carries::Nothing);
                continue;
            }
            ties.extend(tie(card, lookup, unread)?);
        }
        Ok(ties)
    }
}

fn tie(
    card: &TieCard,
    lookup: &Lookup,
    unread: &mut UnreadCards,
) -> Result<Option<Tie>, FileProblem> {
    let id = card.id;
    let user = || format!("{} {id}", card.name);
    Ok(match &card.kind {
        Kind::Rigid {
            independent,
            dependent,
        } => {
            let mut nodes = Vec::new();
            for (ids, components) in dependent {
                let found = lookup.all(ids, &user, &card.at)?;
                nodes.extend(found.into_iter().map(|node| (node, *components)));
            }
            Some(Tie::Rigid {
                id,
                independent: lookup.require(*independent, &user, &card.at)?,
                dependent: nodes,
            })
        }
        Kind::Averaging {
            reference,
            components,
            groups,
        } => {
            let mut nodes = Vec::new();
            for (ids, weight, components) in groups {
                let found = lookup.all(ids, &user, &card.at)?;
                nodes.extend(found.into_iter().map(|node| (node, *weight, *components)));
            }
            Some(Tie::Averaging {
                id,
                reference: lookup.require(*reference, &user, &card.at)?,
                reference_components: *components,
                independent: nodes,
            })
        }
        Kind::Equation(given) => {
            let mut terms = Vec::with_capacity(given.len());
            for &(grid, freedom, coefficient) in given {
                if lookup.find(grid).is_none() && lookup.is_scalar(grid) {
                    unread.note("MPC with scalar points", &card.at, Carries::Structure);
                    return Ok(None);
                }
                let node = lookup.require(grid, &user, &card.at)?;
                let freedom = freedom.ok_or_else(|| {
                    card.at.problem(
                        format!("MPC {id}: no freedom named at grid point {grid}"),
                        "give C1, C2, …, one of 1 to 6 each",
                    )
                })?;
                terms.push((node, freedom, coefficient));
            }
            Some(Tie::Equation { id, terms })
        }
    })
}

/// `RBE2 EID GN CM GM1 GM2 … [ALPHA [TREF]]`: reals at the end are no grid points.
fn spider(card: &Card) -> Result<Kind, FileProblem> {
    let mut end = card.len();
    while end > 3 && (number::is_real(card.text(end - 1)) || card.is_blank(end - 1)) {
        end -= 1;
    }
    let ids = card.ids(3, end, "GM")?;
    if ids.ranges.is_empty() {
        card.id(3, "GM1")?;
    }
    Ok(Kind::Rigid {
        independent: card.id(1, "GN")?,
        dependent: vec![(ids, card.components(2, "CM")?)],
    })
}

/// `RBE3 EID blank REFGRID REFC WT1 C1 G1,1 … WT2 C2 … [UM …] [ALPHA …]`: a real in the list begins a group. `UM` only says which
/// freedoms of the same equations Nastran eliminates, so that it needs no reading.
fn averaging(card: &Card) -> Result<Kind, FileProblem> {
    let reference = card.id(2, "REFGRID")?;
    let components = card.components(3, "REFC")?;
    let mut groups = Vec::new();
    let mut i = 4;
    let ends = |text: &str| matches!(text, "UM" | "ALPHA" | "TREF");
    while i < card.len() && !ends(card.text(i)) {
        if card.is_blank(i) {
            i += 1;
            continue;
        }
        let weight = card.real(i, "WT")?;
        let parts = card.components(i + 1, "C")?;
        i += 2;
        let first = i;
        while i < card.len() && !ends(card.text(i)) && !number::is_real(card.text(i)) {
            i += 1;
        }
        let ids = card.ids(first, i, "G")?;
        if ids.ranges.is_empty() {
            return Err(card.problem(
                "a weight has no grid points",
                "the list is weight, components, grid points; a real begins the next weight",
            ));
        }
        if weight < 0.0 {
            return Err(card.problem(
                &format!("the weight {weight} is negative"),
                "weights must be positive",
            ));
        }
        groups.push((ids, weight, parts));
    }
    if groups.is_empty() {
        card.real(4, "WT1")?;
    }
    Ok(Kind::Averaging {
        reference,
        components,
        groups,
    })
}

/// `RBAR EID GA GB CNA CNB CMA CMB`: all six independent freedoms at one end.
fn bar(card: &Card) -> Result<Kind, FileProblem> {
    let grids = [card.ids(1, 2, "GA")?, card.ids(2, 3, "GB")?];
    let [ga, gb] = [card.id(1, "GA")?, card.id(2, "GB")?];
    let part = |i: usize, name: &str| {
        Ok::<u8, FileProblem>(card.optional_components(i, name)?.unwrap_or(0))
    };
    let (cna, cnb) = (part(3, "CNA")?, part(4, "CNB")?);
    let (cma, cmb) = (part(5, "CMA")?, part(6, "CMB")?);
    let or_all = |components: u8| if components == 0 { ALL } else { components };
    let [a, b] = grids;
    match (cna, cnb) {
        (ALL, 0) => Ok(Kind::Rigid {
            independent: ga,
            dependent: vec![(b, or_all(cmb))],
        }),
        (0, ALL) => Ok(Kind::Rigid {
            independent: gb,
            dependent: vec![(a, or_all(cma))],
        }),
        _ => Err(card.problem(
            "its six independent freedoms are not all at one end",
            "give 123456 in CNA or CNB and leave the other blank",
        )),
    }
}

/// `RBE1 EID GN1 CN1 GN2 CN2 GN3 CN3 / … / UM GM1 CM1 …`: read where one grid point has all six independent freedoms.
fn general(card: &Card) -> Result<Kind, FileProblem> {
    let marker = (1..card.len()).find(|i| card.text(*i) == "UM");
    let Some(marker) = marker else {
        return Err(card.problem("\"UM\" is missing", "dependent freedoms follow the word UM"));
    };
    let others = (3..marker).any(|i| !card.is_blank(i));
    if others || card.components(2, "CN1")? != ALL {
        return Err(card.problem(
            "its six independent freedoms are not all at one grid point",
            "give 123456 at one grid point, or use RBE2",
        ));
    }
    let mut dependent = Vec::new();
    let mut i = marker + 1;
    while i < card.len() {
        if card.is_blank(i) {
            i += 1;
        } else if card.text(i).contains('.') {
            break;
        } else {
            dependent.push((card.ids(i, i + 1, "GM")?, card.components(i + 1, "CM")?));
            i += 2;
        }
    }
    Ok(Kind::Rigid {
        independent: card.id(1, "GN1")?,
        dependent,
    })
}

/// `MPC SID G1 C1 A1 G2 C2 A2 blank / blank G3 C3 A3 …`.
fn equation(card: &Card) -> Result<Kind, FileProblem> {
    let mut terms = Vec::new();
    for line in 0..card.len().div_ceil(8) {
        for i in [8 * line + 1, 8 * line + 4] {
            if card.is_blank(i) && card.is_blank(i + 2) {
                continue;
            }
            terms.push((
                card.id(i, "G")?,
                card.freedom(i + 1, "C")?,
                card.real(i + 2, "A")?,
            ));
        }
    }
    match terms.first() {
        Some((_, _, coefficient)) if *coefficient != 0.0 => Ok(Kind::Equation(terms)),
        _ => Err(card.problem(
            "the first coefficient is zero or missing",
            "the first freedom is the one that depends on the others",
        )),
    }
}
