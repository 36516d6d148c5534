//! Coordinate systems: rectangular, cylindrical and spherical, by points in another system or by three grid
//! points, chained in any order.

use std::collections::BTreeMap;

use super::card::Card;
use super::grids::{GridCard, Lookup};
use super::lines::At;
use super::vector::{Rotation, from_axes, norm, rotate, unit};
use crate::error::FileProblem;
use crate::fe::vector::{add, cross, subtract};
pub(super) use crate::mesh::Coordinates as Shape;
use crate::mesh::LocalAxes;

/// Origin, a point on the z axis, a point in the x–z plane.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Points {
    /// In another system.
    In(u64, [[f64; 3]; 3]),
    /// Grid points.
    Grids([u64; 3]),
}

/// A `CORDxx` card.
#[derive(Clone, Debug)]
pub(super) struct SystemCard {
    id: u64,
    shape: Shape,
    points: Points,
    at: At,
}

/// Reads `CORD2R`, `CORD2C`, `CORD2S`.
pub(super) fn read_by_points(card: &Card, shape: Shape) -> Result<SystemCard, FileProblem> {
    let reference = card.optional_id(1, "RID")?.unwrap_or(0);
    let points = [
        card.vector(2, "A")?,
        card.vector(5, "B")?,
        card.vector(8, "C")?,
    ];
    if card.len() < 9 {
        // a blank C may mean the origin, but far more often its line was lost
        card.real(8, "C1")?;
    }
    Ok(SystemCard {
        id: card.id(0, "CID")?,
        shape,
        points: Points::In(reference, points),
        at: card.at.clone(),
    })
}

/// Reads `CORD1R`, `CORD1C`, `CORD1S`, with one or two systems on a card.
pub(super) fn read_by_grids(card: &Card, shape: Shape) -> Result<Vec<SystemCard>, FileProblem> {
    let one = |i: usize| {
        Ok(SystemCard {
            id: card.id(i, "CID")?,
            shape,
            points: Points::Grids([
                card.id(i + 1, "G1")?,
                card.id(i + 2, "G2")?,
                card.id(i + 3, "G3")?,
            ]),
            at: card.at.clone(),
        })
    };
    let mut systems = vec![one(0)?];
    if !card.is_blank(4) {
        systems.push(one(4)?);
    }
    Ok(systems)
}

/// The position in the basic frame of a point in the coordinates of a system (angles in degrees).
fn place_in(system: &LocalAxes, x: [f64; 3]) -> [f64; 3] {
    let radians = std::f64::consts::PI / 180.0;
    let local = match system.coordinates {
        Shape::Rectangular => x,
        Shape::Cylindrical => {
            let angle = x[1] * radians;
            [x[0] * libm::cos(angle), x[0] * libm::sin(angle), x[2]]
        }
        Shape::Spherical => {
            let (polar, azimuth) = (x[1] * radians, x[2] * radians);
            let r = x[0] * libm::sin(polar);
            [
                r * libm::cos(azimuth),
                r * libm::sin(azimuth),
                x[0] * libm::cos(polar),
            ]
        }
    };
    add(system.origin, rotate(&system.rotation, local))
}

/// All coordinate systems of a deck.
#[derive(Debug, Default)]
pub(super) struct Systems {
    placed: BTreeMap<u64, LocalAxes>,
}

impl Systems {
    /// Places all systems that grid points or cards may use. `CORD1x` systems form chains through
    /// the `CP` of their grid points.
    pub fn place_all(
        cards: &[SystemCard],
        grids: &[GridCard],
        lookup: &Lookup,
    ) -> Result<Self, FileProblem> {
        let mut by_id: BTreeMap<u64, &SystemCard> = BTreeMap::new();
        for card in cards {
            if let Some(first) = by_id.insert(card.id, card)
                && (first.points != card.points || first.shape != card.shape)
            {
                return Err(card.at.problem(
                    format!(
                        "coordinate system {} is defined twice, first in {}, line {}",
                        card.id, first.at.file, first.at.line
                    ),
                    "remove one of them",
                ));
            }
        }
        let mut systems = Systems::default();
        for card in cards {
            systems.place_one(card, &by_id, grids, lookup)?;
        }
        Ok(systems)
    }

    /// Places a system, after the systems that define it.
    fn place_one(
        &mut self,
        card: &SystemCard,
        by_id: &BTreeMap<u64, &SystemCard>,
        grids: &[GridCard],
        lookup: &Lookup,
    ) -> Result<(), FileProblem> {
        let mut stack = vec![card];
        while let Some(&card) = stack.last() {
            if self.placed.contains_key(&card.id) {
                stack.pop();
                continue;
            }
            let needed = match card.points {
                Points::In(reference, _) => vec![reference],
                Points::Grids(ids) => ids
                    .iter()
                    .map(|id| Ok(grid(*id, card, grids, lookup)?.placement.unwrap_or(0)))
                    .collect::<Result<Vec<_>, FileProblem>>()?,
            };
            let missing = needed
                .iter()
                .find(|id| **id != 0 && !self.placed.contains_key(id));
            if let Some(id) = missing {
                let Some(next) = by_id.get(id) else {
                    return Err(unknown_system(
                        *id,
                        &format!("coordinate system {}", card.id),
                        &card.at,
                    ));
                };
                if stack.iter().any(|open| open.id == *id) {
                    let circle = stack
                        .iter()
                        .skip_while(|open| open.id != *id)
                        .map(|open| open.id.to_string())
                        .chain([id.to_string()])
                        .collect::<Vec<_>>()
                        .join(" → ");
                    return Err(card.at.problem(
                        format!("coordinate systems refer to each other in a circle: {circle}"),
                        "define one of them in the basic system",
                    ));
                }
                stack.push(next);
                continue;
            }
            let [a, b, c] = match card.points {
                Points::In(reference, points) => {
                    let system = self.find(reference).unwrap_or(LocalAxes::BASIC);
                    points.map(|point| place_in(&system, point))
                }
                Points::Grids(ids) => {
                    let mut places = [[0.0; 3]; 3];
                    for (place, id) in places.iter_mut().zip(ids) {
                        let grid = grid(id, card, grids, lookup)?;
                        let system = self.find(grid.placement.unwrap_or(0));
                        *place = place_in(&system.unwrap_or(LocalAxes::BASIC), grid.coordinates);
                    }
                    places
                }
            };
            let axes = unit(subtract(b, a)).and_then(|z| {
                let in_plane = subtract(c, a);
                let y = cross(z, in_plane);
                // a choice above rounding, for points on one line but for the last digits of a file
                if norm(y) <= 1e-10 * norm(in_plane) {
                    return None;
                }
                let y = unit(y)?;
                Some(from_axes(cross(y, z), y, z))
            });
            let Some(rotation) = axes else {
                return Err(card.at.problem(
                    format!(
                        "coordinate system {}: its three points lie on one line",
                        card.id
                    ),
                    "move a point: the origin, the point on the z axis and the point in the x-z plane must form a triangle",
                ));
            };
            self.placed.insert(
                card.id,
                LocalAxes {
                    coordinates: card.shape,
                    origin: a,
                    ..LocalAxes::fixed(rotation)
                },
            );
            stack.pop();
        }
        Ok(())
    }

    fn find(&self, id: u64) -> Option<LocalAxes> {
        if id == 0 {
            return Some(LocalAxes::BASIC);
        }
        self.placed.get(&id).copied()
    }

    /// The position in the basic frame for coordinates in a system.
    pub fn place(
        &self,
        id: u64,
        x: [f64; 3],
        user: &dyn Fn() -> String,
        at: &At,
    ) -> Result<[f64; 3], FileProblem> {
        self.find(id)
            .map(|system| place_in(&system, x))
            .ok_or_else(|| unknown_system(id, &user(), at))
    }

    /// The axes of a system at a position in the basic frame.
    pub fn axes_at(
        &self,
        id: u64,
        position: [f64; 3],
        user: &dyn Fn() -> String,
        at: &At,
    ) -> Result<Rotation, FileProblem> {
        Ok(self.axes(id, user, at)?.at(position))
    }

    /// The axes of a system as a function of the place.
    pub fn axes(
        &self,
        id: u64,
        user: &dyn Fn() -> String,
        at: &At,
    ) -> Result<LocalAxes, FileProblem> {
        self.find(id).ok_or_else(|| unknown_system(id, &user(), at))
    }

    /// Whether a system has the same axes everywhere.
    pub fn is_rectangular(&self, id: u64) -> bool {
        self.find(id).is_none_or(|system| system.is_rectangular())
    }
}

fn grid<'g>(
    id: u64,
    card: &SystemCard,
    grids: &'g [GridCard],
    lookup: &Lookup,
) -> Result<&'g GridCard, FileProblem> {
    lookup
        .find(id)
        .and_then(|index| grids.get(index as usize))
        .ok_or_else(|| lookup.missing(id, &format!("coordinate system {}", card.id), &card.at))
}

fn unknown_system(id: u64, user: &str, at: &At) -> FileProblem {
    at.problem(
        format!("{user} uses coordinate system {id}, which is missing"),
        "add its CORD card, or INCLUDE the file that holds it",
    )
}
