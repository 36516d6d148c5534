//! Rules between freedoms: `RBE2`, `RBE3`, `RBAR`, `RBAR1`, `RBE1`, `RTRPLT`, `RTRPLT1`, `RROD`, `RSPLINE`,
//! `MPC`.

use super::card::{Card, Ids};
use super::grids::Lookup;
use super::lines::At;
use super::masses::distinct;
use super::number;
use super::rigid::{Freedom, dependence, rod};
use super::spline::{Problem, equations};
use super::unread::UnreadCards;
use super::vector::norm;
use crate::error::FileProblem;
use crate::fe::vector::subtract;
use crate::mesh::{Carries, Frame, Node, Tie};

/// All components of a node as bits: three translations, then three rotations.
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
    /// Six independent freedoms at several grid points, and those that follow.
    Shared {
        independent: Vec<(u64, u8)>,
        dependent: Vec<(u64, u8)>,
    },
    /// Two grid points at a fixed distance, and the freedom that follows: its end and its direction 0…2.
    Rod {
        ends: [u64; 2],
        dependent: (usize, u8),
    },
    /// Grid points along a curve with the freedoms that follow it (none: the point is independent), and the
    /// diameter of its tube as a share of its length.
    Spline { points: Vec<(u64, u8)>, ratio: f64 },
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
    /// Reads a card; `false` if it is none of these.
    pub fn read(&mut self, card: &Card) -> Result<bool, FileProblem> {
        let kind = match card.name.as_str() {
            "RBE2" => spider(card)?,
            "RBE3" => averaging(card)?,
            "RBAR" => stated(card, &["A", "B"])?,
            "RTRPLT" => stated(card, &["A", "B", "C"])?,
            "RBAR1" => hanging(card, &[(2, 3, "B")])?,
            "RTRPLT1" => hanging(card, &[(2, 4, "B"), (3, 5, "C")])?,
            "RROD" => pinned(card)?,
            "RSPLINE" => spline(card)?,
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
        places: (&[Node], &[Frame]),
        selected: &dyn Fn(u64) -> bool,
        scalars: &mut Vec<u64>,
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
            tie(card, lookup, places, scalars, &mut ties)?;
        }
        Ok(ties)
    }
}

fn tie(
    card: &TieCard,
    lookup: &Lookup,
    (nodes, frames): (&[Node], &[Frame]),
    scalars: &mut Vec<u64>,
    ties: &mut Vec<Tie>,
) -> Result<(), FileProblem> {
    let id = card.id;
    let user = || format!("{} {id}", card.name);
    ties.push(match &card.kind {
        Kind::Rigid {
            independent,
            dependent,
        } => {
            let mut nodes = Vec::new();
            for (ids, components) in dependent {
                let found = lookup.all(ids, &user, &card.at)?;
                nodes.extend(found.into_iter().map(|node| (node, *components)));
            }
            Tie::Rigid {
                id,
                independent: lookup.require(*independent, &user, &card.at)?,
                dependent: nodes,
            }
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
            Tie::Averaging {
                id,
                reference: lookup.require(*reference, &user, &card.at)?,
                reference_components: *components,
                independent: nodes,
            }
        }
        Kind::Equation(given) => {
            let mut terms = Vec::with_capacity(given.len());
            for &(grid, freedom, coefficient) in given {
                let (node, freedom) = lookup.freedom(grid, freedom, scalars, &user, &card.at)?;
                terms.push((node, freedom, coefficient));
            }
            Tie::Equation { id, terms }
        }
        Kind::Rod { ends, dependent } => {
            let [first, second] = [ends[0], ends[1]].map(|grid| lookup.require(grid, &user, &card.at));
            let terms = rod([first?, second?], *dependent, nodes, frames);
            let Some(terms) = terms else {
                return Err(card.at.problem(
                    format!(
                        "the dependent translation of {} {id} is perpendicular to the rod, or its ends are at one place",
                        card.name
                    ),
                    "name a translation along the rod, which its length can decide",
                ));
            };
            Tie::Equation { id, terms }
        }
        Kind::Spline { points, ratio } => {
            let mut found = Vec::with_capacity(points.len());
            for (grid, freedoms) in points {
                found.push((lookup.require(*grid, &user, &card.at)?, *freedoms));
            }
            return splines(card, points, &found, *ratio, (nodes, frames), ties);
        }
        Kind::Shared {
            independent,
            dependent,
        } => {
            let freedoms = |list: &[(u64, u8)]| {
                let mut freedoms: Vec<Freedom> = Vec::new();
                for (grid, components) in list {
                    let node = lookup.require(*grid, &user, &card.at)?;
                    let named = (0..6).filter(|bit| components >> bit & 1 == 1);
                    freedoms.extend(named.map(|freedom| (node, freedom)));
                }
                Ok::<_, FileProblem>(freedoms)
            };
            let given = freedoms(independent)?;
            let mut following = freedoms(dependent)?;
            following.retain(|freedom| !given.contains(freedom));
            let rows = <&[Freedom; 6]>::try_from(given.as_slice())
                .ok()
                .and_then(|given| dependence(given, &following, nodes, frames));
            let Some(rows) = rows else {
                return Err(card.at.problem(
                    format!(
                        "the independent freedoms of {} {id} do not hold all rigid motions",
                        card.name
                    ),
                    "give 123456 at one grid point, or six freedoms that hold all motions of a rigid body",
                ));
            };
            for (freedom, row) in following.iter().zip(rows) {
                let others = given.iter().zip(row).filter(|(_, value)| *value != 0.0);
                ties.push(Tie::Equation {
                    id,
                    terms: [(freedom.0, freedom.1, 1.0)]
                        .into_iter()
                        .chain(others.map(|((node, freedom), value)| (*node, *freedom, -value)))
                        .collect(),
                });
            }
            return Ok(());
        }
    });
    Ok(())
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

/// `RBE3 EID blank REFGRID REFC WT1 C1 G1,1 … WT2 C2 … [UM …] [ALPHA …]`: a real in the list begins a group.
/// `UM` selects only the freedoms that Nastran eliminates from the same equations, so Eng need not read it.
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
                "no grid points follow a weight",
                "write a weight with a decimal point, then components, then grid points",
            ));
        }
        if weight < 0.0 {
            return Err(card.problem(
                &format!("the weight {weight} is negative"),
                "give a positive weight, or zero for grid points without influence",
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

/// `RBAR EID GA GB CNA CNB CMA CMB` and `RTRPLT EID GA GB GC CNA CNB CNC CMA CMB CMC`: six independent freedoms
/// (CN). The freedoms CM depend on them, or all others if CM is blank.
fn stated(card: &Card, points: &[&str]) -> Result<Kind, FileProblem> {
    let count = points.len();
    let (mut given, mut following) = (Vec::new(), Vec::new());
    for (i, point) in points.iter().enumerate() {
        let grid = card.id(1 + i, &format!("G{point}"))?;
        let part = |first: usize, name: &str| {
            let components = card.optional_components(first + i, &format!("{name}{point}"))?;
            Ok::<_, FileProblem>((grid, components.unwrap_or(0)))
        };
        given.push(part(1 + count, "CN")?);
        following.push(part(1 + 2 * count, "CM")?);
    }
    if following.iter().all(|(_, components)| *components == 0) {
        following = (given.iter())
            .map(|(grid, components)| (*grid, ALL & !components))
            .collect();
    }
    shared(card, given, following)
}

/// `RBAR1 EID GA GB CB` and `RTRPLT1 EID GA GB GC CB CC`: all freedoms of GA are independent. A blank C means all
/// freedoms.
fn hanging(card: &Card, points: &[(usize, usize, &str)]) -> Result<Kind, FileProblem> {
    let mut dependent = Vec::new();
    for (grid, components, point) in points {
        dependent.push((
            Ids::one(card.id(*grid, &format!("G{point}"))?),
            (card.optional_components(*components, &format!("C{point}"))?).unwrap_or(ALL),
        ));
    }
    Ok(Kind::Rigid {
        independent: card.id(1, "GA")?,
        dependent,
    })
}

/// `RROD EID GA GB CMA CMB`: one translation, of GA or of GB, follows from the distance of both.
fn pinned(card: &Card) -> Result<Kind, FileProblem> {
    let ends = [card.id(1, "GA")?, card.id(2, "GB")?];
    let mut named = Vec::new();
    for (end, (field, name)) in [(3, "CMA"), (4, "CMB")].into_iter().enumerate() {
        let components = card.optional_components(field, name)?.unwrap_or(0);
        named.extend(
            (0..6)
                .filter(|bit| components >> bit & 1 == 1)
                .map(|bit| (end, bit)),
        );
    }
    match *named.as_slice() {
        [dependent @ (_, 0..3)] => Ok(Kind::Rod { ends, dependent }),
        _ => Err(card.problem(
            "it does not name one dependent translation",
            "give 1, 2 or 3 as CMA or as CMB, and leave the other one blank",
        )),
    }
}

/// `RSPLINE EID D/L G1 G2 C2 G3 C3 … Gn`: a blank C means an independent point.
fn spline(card: &Card) -> Result<Kind, FileProblem> {
    let ratio = card.optional_real(1, "D/L")?.unwrap_or(0.1);
    if ratio.is_nan() || ratio <= 0.0 {
        return Err(card.problem(
            &format!("the ratio D/L is {ratio}"),
            "give the diameter of the tube as a share of its length, or leave D/L blank for 0.1",
        ));
    }
    let mut end = card.len();
    while end > 3 && card.is_blank(end - 1) {
        end -= 1;
    }
    let mut points = vec![(card.id(2, "G1")?, 0)];
    for i in (3..end).step_by(2) {
        let number = points.len() + 1;
        let grid = card.id(i, &format!("G{number}"))?;
        let freedoms = card.optional_components(i + 1, &format!("C{number}"))?;
        points.push((grid, freedoms.unwrap_or(0)));
    }
    match points.last() {
        Some((_, 0)) if points.iter().any(|(_, freedoms)| *freedoms != 0) => {
            Ok(Kind::Spline { points, ratio })
        }
        Some((grid, 1..)) => Err(card.problem(
            &format!("its last grid point {grid} depends on the spline"),
            "leave C of the last grid point blank: both ends of a spline are independent",
        )),
        _ => Err(card.problem(
            "no grid point between its ends has dependent freedoms",
            "give C of the grid points that follow the curve",
        )),
    }
}

/// The equations of the splines of a card, one from each independent point to the next. `points` has the
/// numbers of the grid points, `found` their nodes.
fn splines(
    card: &TieCard,
    points: &[(u64, u8)],
    found: &[(u32, u8)],
    ratio: f64,
    (nodes, frames): (&[Node], &[Frame]),
    ties: &mut Vec<Tie>,
) -> Result<(), FileProblem> {
    let place = |node: u32| (nodes.get(node as usize)).map_or([0.0; 3], |node| node.position);
    let length: f64 = (found.windows(2))
        .map(|pair| norm(subtract(place(pair[1].0), place(pair[0].0))))
        .sum();
    let mut first = 0;
    for last in 1..found.len() {
        let Some(part) = found.get(first..=last) else {
            continue;
        };
        if !matches!(part.last(), Some((_, 0))) {
            continue;
        }
        let rows = equations(part, ratio * length, nodes, frames).map_err(|problem| {
            let id = card.id;
            let grid = |i: usize| points.get(first + i).map_or(0, |(grid, _)| *grid);
            match problem {
                Problem::Together(i) => card.at.problem(
                    format!(
                        "grid points {} and {} of RSPLINE {id} are at one place",
                        grid(i - 1),
                        grid(i)
                    ),
                    "name each place of the curve once",
                ),
                Problem::Thin => card.at.problem(
                    format!("the tube of RSPLINE {id} is too thin: D/L is {ratio}"),
                    "state a larger ratio D/L: it hardly changes the curve (0.1 unless stated)",
                ),
            }
        })?;
        let id = card.id;
        ties.extend(rows.into_iter().map(|terms| Tie::Equation { id, terms }));
        first = last;
    }
    Ok(())
}

/// `RBE1 EID GN1 CN1 GN2 CN2 GN3 CN3 / … / UM GM1 CM1 …`: six independent freedoms before `UM`, dependent
/// ones after it.
fn general(card: &Card) -> Result<Kind, FileProblem> {
    let (mut given, mut following) = (Vec::new(), Vec::new());
    let mut behind = false;
    let mut i = 1;
    while i < card.len() && !number::is_real(card.text(i)) && card.text(i) != "ALPHA" {
        if card.is_blank(i) {
            i += 1;
        } else if card.text(i) == "UM" {
            behind = true;
            i += 1;
        } else {
            let list = if behind { &mut following } else { &mut given };
            list.push((card.id(i, "G")?, card.components(i + 1, "C")?));
            i += 2;
        }
    }
    if !behind {
        return Err(card.problem(
            "\"UM\" is missing",
            "write UM before the dependent freedoms",
        ));
    }
    shared(card, given, following)
}

/// A rigid element of the given independent and dependent freedoms: a spider where all independent ones are
/// at one grid point.
fn shared(
    card: &Card,
    mut given: Vec<(u64, u8)>,
    mut following: Vec<(u64, u8)>,
) -> Result<Kind, FileProblem> {
    given.retain(|(_, components)| *components != 0);
    following.retain(|(_, components)| *components != 0);
    if let [(independent, ALL)] = *given.as_slice() {
        following.retain(|(grid, _)| *grid != independent);
        return Ok(Kind::Rigid {
            independent,
            dependent: following
                .into_iter()
                .map(|(grid, components)| (Ids::one(grid), components))
                .collect(),
        });
    }
    let count: u32 = given
        .iter()
        .map(|(_, components)| components.count_ones())
        .sum();
    if count != 6 {
        return Err(card.problem(
            &format!("it has {count} independent freedoms instead of six"),
            "give 123456 at one grid point, or six freedoms that hold all motions of a rigid body",
        ));
    }
    Ok(Kind::Shared {
        independent: given,
        dependent: following,
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
            "give a coefficient other than zero first: its freedom depends on the others",
        )),
    }
}
