//! Bushings: `CBUSH` with the stiffness of `PBUSH`, and `CBUSH1D`, which acts along one axis, with that of `PBUSH1D`.

use std::collections::BTreeMap;

use super::beams::{Around, Orientation, across, orientation};
use super::card::Card;
use super::lines::At;
use super::unread::UnreadCards;
use super::vector::{Rotation, beam_axes, norm};
use crate::error::FileProblem;
use crate::fe::vector::{add, cross, scale, subtract};
use crate::mesh::{Carries, Frame, Spring, along_axes};

/// Length (of the deck's unit) below which the two ends are at one place: that of Nastran.
const COINCIDENT: f64 = 1e-4;
/// Sine of the angle between an axis and a line below which they count as parallel. A choice: that of coordinates
/// with five digits.
const ALONG: f64 = 1e-4;

/// The axes of a bushing.
#[derive(Clone, Debug)]
enum Given {
    /// Those of a coordinate system at end A.
    System(u64),
    /// As those of a bar.
    Orientation(Orientation),
    /// None but the line between the ends.
    Line,
}

/// Where a bushing acts.
#[derive(Clone, Copy, Debug)]
enum Place {
    /// At a share of the way from A to B.
    Share(f64),
    /// At coordinates in a system.
    Point(u64, [f64; 3]),
}

/// The card of a bushing's stiffness.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Of {
    Pbush,
    Pbush1d,
}

impl Of {
    fn name(self) -> &'static str {
        match self {
            Of::Pbush => "PBUSH",
            Of::Pbush1d => "PBUSH1D",
        }
    }
}

#[derive(Clone, Debug)]
struct BushCard {
    order: u64,
    id: u64,
    /// The card of its property.
    of: Of,
    property: u64,
    ends: [Option<u64>; 2],
    given: Given,
    place: Place,
    at: At,
}

/// Cards of bushings.
#[derive(Debug, Default)]
pub(super) struct Bushes {
    cards: Vec<BushCard>,
    stiffness: BTreeMap<(Of, u64), [f64; 6]>,
}

impl Bushes {
    /// Reads a card; `false` if it is none of these.
    pub fn read(&mut self, card: &Card, unread: &mut UnreadCards) -> Result<bool, FileProblem> {
        match card.name.as_str() {
            "CBUSH" => self.element(card)?,
            "PBUSH" => self.property(card, unread)?,
            "CBUSH1D" => self.axial_element(card)?,
            "PBUSH1D" => self.axial_property(card, unread)?,
            _ => return Ok(false),
        }
        Ok(true)
    }

    /// `CBUSH EID PID GA GB GO/X1 X2 X3 CID / S OCID S1 S2 S3`: a blank GB is the ground. An OCID of 0 or more places
    /// the bushing at S1 S2 S3 in this system, and S does not count.
    fn element(&mut self, card: &Card) -> Result<(), FileProblem> {
        let fields = [4, 5, 6].map(|i| card.text(i).to_string());
        let given = match card.optional_id(7, "CID")? {
            Some(system) => Given::System(system),
            None if fields.iter().all(String::is_empty) => Given::Line,
            None => Given::Orientation(orientation(card, &fields)?),
        };
        let place = match card.text(9) {
            "" | "-1" => Place::Share(card.optional_real(8, "S")?.unwrap_or(0.5)),
            _ => {
                let mut point = [0.0; 3];
                for (i, x) in point.iter_mut().enumerate() {
                    *x = card.real_or_zero(10 + i, &format!("S{}", i + 1))?;
                }
                Place::Point(card.optional_id(9, "OCID")?.unwrap_or(0), point)
            }
        };
        self.add(card, Of::Pbush, given, place)
    }

    /// `CBUSH1D EID PID GA GB CID`: along the x axis of CID, or the line from GA to GB. A blank GB is the ground.
    fn axial_element(&mut self, card: &Card) -> Result<(), FileProblem> {
        let system = card.optional_id(4, "CID")?;
        let given = system.map_or(Given::Line, Given::System);
        self.add(card, Of::Pbush1d, given, Place::Share(0.5))
    }

    /// Adds an element with the number, property and ends of its card.
    fn add(&mut self, card: &Card, of: Of, given: Given, place: Place) -> Result<(), FileProblem> {
        let id = card.id(0, "EID")?;
        let end = |i: usize, name: &str| {
            let id = card.optional_id(i, name)?;
            Ok::<_, FileProblem>(id.filter(|id| *id > 0))
        };
        self.cards.push(BushCard {
            order: card.order,
            id,
            of,
            property: card
                .optional_id(1, "PID")?
                .filter(|id| *id > 0)
                .unwrap_or(id),
            ends: [end(2, "GA")?, end(3, "GB")?],
            given,
            place,
            at: card.at.clone(),
        });
        Ok(())
    }

    /// `PBUSH PID K K1 … K6 / B … / GE … / RCV … / M mass`: each line names its numbers. Damping and the
    /// factors of stress recovery have no place in a mesh.
    fn property(&mut self, card: &Card, unread: &mut UnreadCards) -> Result<(), FileProblem> {
        let id = card.id(0, "PID")?;
        let mut stiffness = [0.0; 6];
        for line in (1..card.len()).step_by(8) {
            match card.text(line) {
                "" | "B" | "GE" | "RCV" => {}
                "K" => {
                    for (i, k) in stiffness.iter_mut().enumerate() {
                        if card.text(line + 1 + i) == "RIGID" {
                            unread.note("PBUSH with RIGID", &card.at, Carries::Structure);
                            continue;
                        }
                        *k = card.real_or_zero(line + 1 + i, &format!("K{}", i + 1))?;
                    }
                }
                "M" if card.real_or_zero(line + 1, "M")? == 0.0 => {}
                "M" => unread.note("mass of PBUSH", &card.at, Carries::Structure),
                other => {
                    return Err(card.problem(
                        &format!("a line of PBUSH begins with \"{other}\""),
                        "begin each line with K, B, GE, RCV or M",
                    ));
                }
            }
        }
        self.define(card, Of::Pbush, id, stiffness)
    }

    /// `PBUSH1D PID K C M SA SE`. The damping C and the factors of stress recovery have no place in a mesh. The lines
    /// SPRING, DAMPER, SHOCKA and GENER count in nonlinear solutions alone.
    fn axial_property(&mut self, card: &Card, unread: &mut UnreadCards) -> Result<(), FileProblem> {
        let id = card.id(0, "PID")?;
        let mut stiffness = [0.0; 6];
        stiffness[0] = card.real_or_zero(1, "K")?;
        if card.real_or_zero(3, "M")? != 0.0 {
            unread.note("mass of PBUSH1D", &card.at, Carries::Structure);
        }
        self.define(card, Of::Pbush1d, id, stiffness)
    }

    fn define(
        &mut self,
        card: &Card,
        of: Of,
        id: u64,
        stiffness: [f64; 6],
    ) -> Result<(), FileProblem> {
        if self.stiffness.insert((of, id), stiffness).is_some() {
            return Err(card.problem(
                &format!("property {id} of bushings is defined twice"),
                "renumber or remove one of them",
            ));
        }
        Ok(())
    }

    /// The springs of all bushings.
    pub fn springs(
        &mut self,
        around: &Around,
        frames: &[Frame],
    ) -> Result<Vec<Spring>, FileProblem> {
        self.cards.sort_by_key(|card| card.order);
        super::masses::distinct("bushing", self.cards.iter().map(|card| (card.id, &card.at)))?;
        let mut springs = Vec::new();
        for card in &self.cards {
            let Some(stiffness) = self.stiffness.get(&(card.of, card.property)) else {
                return Err(card.at.problem(
                    format!(
                        "bushing {} uses property {}, which is missing",
                        card.id, card.property
                    ),
                    format!(
                        "add its {} card, or INCLUDE the file that holds it",
                        card.of.name()
                    ),
                ));
            };
            card.springs(stiffness, around, frames, &mut springs)?;
        }
        Ok(springs)
    }
}

impl BushCard {
    /// Six springs at one place, on rigid arms from both ends.
    fn springs(
        &self,
        stiffness: &[f64; 6],
        around: &Around,
        frames: &[Frame],
        springs: &mut Vec<Spring>,
    ) -> Result<(), FileProblem> {
        let user = || format!("bushing {}", self.id);
        let mut ends = Vec::with_capacity(2);
        for (grid, sign) in self.ends.into_iter().zip([-1.0, 1.0]) {
            if let Some(grid) = grid {
                ends.push((around.lookup.require(grid, &user, &self.at)?, sign));
            }
        }
        let (along, start) = match *ends.as_slice() {
            [(a, _), (b, _)] => {
                let along = subtract(around.position(b), around.position(a));
                (along, around.position(a))
            }
            [(node, _)] => ([0.0; 3], around.position(node)),
            _ => {
                return Err(self.at.problem(
                    format!("bushing {} has no end at a grid point", self.id),
                    "give GA, GB or both",
                ));
            }
        };
        let place = match self.place {
            Place::Share(share) => add(start, scale(share, along)),
            Place::Point(system, point) => {
                (around.systems).place(system, point, &user, &self.at)?
            }
        };
        let Some(&(first, _)) = ends.first() else {
            return Ok(());
        };
        let axes = self.axes(stiffness, first, along, around)?;
        for (component, k) in stiffness.iter().enumerate().filter(|(_, k)| **k != 0.0) {
            let axis = axes.map(|row| row[component % 3]);
            let mut terms = Vec::with_capacity(12);
            for (node, sign) in &ends {
                let arm = subtract(place, around.position(*node));
                // e·(θ × r) = θ·(r × e)
                let (moved, turned) = match component {
                    0..3 => (axis, cross(arm, axis)),
                    _ => ([0.0; 3], axis),
                };
                for (freedom, vector) in [(0, moved), (3, turned)] {
                    let components = along_axes(around.nodes, frames, *node, vector);
                    for (k, factor) in (freedom..).zip(components) {
                        // rounding of cosines
                        if factor.abs() > 1e-12 * norm(vector) {
                            terms.push((*node, k, sign * factor));
                        }
                    }
                }
            }
            springs.push(Spring {
                id: self.id,
                stiffness: *k,
                terms,
                grounded: ends.len() == 1,
            });
        }
        Ok(())
    }

    /// The axes, as columns.
    fn axes(
        &self,
        stiffness: &[f64; 6],
        first: u32,
        along: [f64; 3],
        around: &Around,
    ) -> Result<Rotation, FileProblem> {
        let user = || format!("bushing {}", self.id);
        let orientation = match &self.given {
            Given::System(system) => {
                let place = around.position(first);
                let axes = around.systems.axes_at(*system, place, &user, &self.at)?;
                // Nastran's codes differ in the moments of such a force
                let off = norm(cross(axes.map(|row| row[0]), along));
                if self.of == Of::Pbush1d && off > ALONG * norm(along) + COINCIDENT {
                    return Err(self.at.problem(
                        format!(
                            "the x axis of system {system} of bushing {} is not along the line between its ends",
                            self.id
                        ),
                        "leave CID blank, so that it acts along this line; or write CBUSH and PBUSH",
                    ));
                }
                return Ok(axes);
            }
            _ if norm(along) < COINCIDENT => {
                return Err(self.at.problem(
                    format!(
                        "bushing {} has both ends at one place, or one end, and no axes",
                        self.id
                    ),
                    "give CID: 0 for the basic axes",
                ));
            }
            Given::Orientation(given) => around.direction(given, first, &user, &self.at)?,
            Given::Line => {
                let across_it = [1, 2, 4, 5].iter().any(|i| stiffness[*i] != 0.0);
                if across_it {
                    return Err(self.at.problem(
                        format!("bushing {} has K2, K3, K5 or K6, and no axes", self.id),
                        "give CID, GO or X1 X2 X3; without them only K1 and K4 are allowed",
                    ));
                }
                across(along)
            }
        };
        beam_axes(along, orientation).ok_or_else(|| {
            self.at.problem(
                format!("bushing {}: its orientation vector lies along it", self.id),
                "choose a vector across the line between its ends",
            )
        })
    }
}
