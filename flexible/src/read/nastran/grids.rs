//! Grid points and scalar points.

use super::card::{Card, IdRange, Ids};
use super::frames::Systems;
use super::lines::At;
use crate::error::FileProblem;
use crate::mesh::{Frame, Node, SCALAR};
use crate::read::labels::Labels;
use std::collections::BTreeMap;

/// A `GRID` card.
#[derive(Clone, Debug)]
pub(super) struct GridCard {
    /// Number in the deck.
    pub order: u64,
    /// Identification number.
    pub id: u64,
    /// System of its coordinates (`CP`).
    pub placement: Option<u64>,
    /// Coordinates.
    pub coordinates: [f64; 3],
    /// System of its displacements (`CD`).
    pub analysis: Option<u64>,
    /// Freedoms held for good (`PS`).
    pub held: Option<u8>,
    /// Place of the card.
    pub at: At,
}

/// Defaults of `GRDSET`.
#[derive(Clone, Debug, Default)]
pub(super) struct GridDefaults {
    placement: Option<u64>,
    analysis: Option<u64>,
    held: Option<u8>,
}

impl GridCard {
    /// Reads `GRID`.
    pub fn read(card: &Card) -> Result<Self, FileProblem> {
        let id = card.id(0, "ID")?;
        if card.text(5) == "-1" {
            return Err(card.problem(
                "the grid point belongs to a fluid (CD = -1)",
                "remove the fluid from the deck; Eng reads only structures",
            ));
        }
        Ok(GridCard {
            order: card.order,
            id,
            placement: card.optional_id(1, "CP")?,
            coordinates: card.vector(2, "X")?,
            analysis: card.optional_id(5, "CD")?,
            held: card.optional_components(6, "PS")?,
            at: card.at.clone(),
        })
    }

    /// Fills blank fields.
    pub fn complete(&mut self, defaults: &GridDefaults) {
        self.placement = self.placement.or(defaults.placement);
        self.analysis = self.analysis.or(defaults.analysis);
        self.held = self.held.or(defaults.held);
    }

    fn same(&self, other: &GridCard) -> bool {
        (self.placement, self.coordinates, self.analysis, self.held)
            == (
                other.placement,
                other.coordinates,
                other.analysis,
                other.held,
            )
    }
}

impl GridDefaults {
    /// Reads `GRDSET`.
    pub fn read(card: &Card) -> Result<Self, FileProblem> {
        Ok(GridDefaults {
            placement: card.optional_id(1, "CP")?,
            analysis: card.optional_id(5, "CD")?,
            held: card.optional_components(6, "PS")?,
        })
    }
}

/// Finds grid points by their numbers.
#[derive(Debug, Default)]
pub(super) struct Lookup {
    /// Number and index, sorted.
    ids: Labels,
    /// First and last of runs of scalar points, sorted.
    scalar: Vec<(u64, u64)>,
}

impl Lookup {
    /// Sorts the grid points; a point given twice in the same way counts once.
    pub fn new(grids: &mut Vec<GridCard>, scalar: Vec<IdRange>) -> Result<Self, FileProblem> {
        let mut first: Vec<(u64, usize)> = grids
            .iter()
            .enumerate()
            .map(|(i, grid)| (grid.id, i))
            .collect();
        first.sort_unstable();
        let mut repeated = Vec::new();
        for pair in first.windows(2) {
            let [(id, one), (other_id, two)] = *pair else {
                continue;
            };
            if id != other_id {
                continue;
            }
            if let (Some(one), Some(again)) = (grids.get(one), grids.get(two)) {
                if !one.same(again) {
                    return Err(again.at.problem(
                        format!(
                            "grid point {id} is defined twice, first in {}, line {}",
                            one.at.file, one.at.line
                        ),
                        "renumber or remove one of them",
                    ));
                }
                repeated.push(two);
            }
        }
        if !repeated.is_empty() {
            repeated.sort_unstable();
            let mut index = 0;
            grids.retain(|_| {
                let keep = repeated.binary_search(&index).is_err();
                index += 1;
                keep
            });
        }
        let mut ids = Vec::with_capacity(grids.len());
        for (index, grid) in grids.iter().enumerate() {
            let index = u32::try_from(index)
                .map_err(|_| grid.at.problem("too many grid points", "divide the model"))?;
            ids.push((grid.id, index));
        }
        Ok(Lookup {
            ids: Labels::new(ids),
            scalar: runs(&scalar),
        })
    }

    /// Index of a grid point.
    pub fn find(&self, id: u64) -> Option<u32> {
        self.ids.find(id)
    }

    /// Whether a number belongs to a scalar point.
    pub fn is_scalar(&self, id: u64) -> bool {
        let next = self.scalar.partition_point(|(from, _)| *from <= id);
        next.checked_sub(1)
            .and_then(|run| self.scalar.get(run))
            .is_some_and(|(_, to)| id <= *to)
    }

    /// Index of a grid point that `user` needs.
    pub fn require(&self, id: u64, user: &dyn Fn() -> String, at: &At) -> Result<u32, FileProblem> {
        self.find(id).ok_or_else(|| self.missing(id, &user(), at))
    }

    /// A freedom of a grid point, or the one of a scalar point, which joins those of the mesh. A number
    /// without a freedom that no grid point has is a scalar point, too.
    pub fn freedom(
        &self,
        id: u64,
        freedom: Option<u8>,
        scalars: &mut Vec<u64>,
        user: &dyn Fn() -> String,
        at: &At,
    ) -> Result<(u32, u8), FileProblem> {
        if self.find(id).is_none() && (freedom.is_none() || self.is_scalar(id)) {
            let place = scalars
                .iter()
                .position(|known| *known == id)
                .unwrap_or(scalars.len());
            if place == scalars.len() {
                scalars.push(id);
            }
            let index = u32::try_from(place).ok().filter(|index| *index < SCALAR);
            let index =
                index.ok_or_else(|| at.problem("too many scalar points", "divide the model"))?;
            return Ok((SCALAR | index, 0));
        }
        let node = self.require(id, user, at)?;
        let freedom = freedom.ok_or_else(|| {
            at.problem(
                format!("{} states no freedom of grid point {id}", user()),
                "give C1 and C2, each a freedom from 1 to 6",
            )
        })?;
        Ok((node, freedom))
    }

    /// The problem of a grid point that isn't there.
    pub fn missing(&self, id: u64, user: &str, at: &At) -> FileProblem {
        if self.is_scalar(id) {
            return at.problem(
                format!("{user} uses {id}, which is a scalar point, not a grid point"),
                "name a grid point; only springs, equations and sets of freedoms can use scalar points",
            );
        }
        at.problem(
            format!("{user} uses grid point {id}, which is missing"),
            "add its GRID card, or INCLUDE the file that holds it",
        )
    }

    /// Indices of the grid points of a list, in its order; numbers inside a `THRU` need not exist. Scalar
    /// points are passed over.
    pub fn all(
        &self,
        ids: &Ids,
        user: &dyn Fn() -> String,
        at: &At,
    ) -> Result<Vec<u32>, FileProblem> {
        let mut found = Vec::new();
        for range in &ids.ranges {
            if range.listed {
                match self.find(range.from) {
                    Some(index) => found.push(index),
                    None if self.is_scalar(range.from) => {}
                    None => return Err(self.missing(range.from, &user(), at)),
                }
            } else {
                found.extend(
                    self.ids
                        .range(range.from, range.to, range.step, &ids.except),
                );
            }
        }
        Ok(found)
    }

    /// Indices of the existing grid points of a list, and the number of named points that do not exist.
    pub fn existing(&self, ids: &Ids) -> (Vec<u32>, usize) {
        existing(&self.ids, ids)
    }
}

/// Ranges as runs that don't overlap.
fn runs(ranges: &[IdRange]) -> Vec<(u64, u64)> {
    let mut sorted = ranges
        .iter()
        .map(|range| (range.from, range.to))
        .collect::<Vec<_>>();
    sorted.sort_unstable();
    let mut runs: Vec<(u64, u64)> = Vec::new();
    for (from, to) in sorted {
        match runs.last_mut() {
            Some((_, end)) if from <= *end => *end = to.max(*end),
            _ => runs.push((from, to)),
        }
    }
    runs
}

/// Indices of the numbers of a list that are in a sorted table, and the number of named ones that are not.
pub(super) fn existing(table: &Labels, ids: &Ids) -> (Vec<u32>, usize) {
    let (mut found, mut lacking) = (Vec::new(), 0);
    for range in &ids.ranges {
        let before = found.len();
        found.extend(table.range(range.from, range.to, range.step, &ids.except));
        lacking += usize::from(range.listed && found.len() == before);
    }
    (found, lacking)
}

/// The nodes and analysis frames of a mesh. A rectangular system makes one frame, another one a frame for
/// each of its nodes.
pub(super) fn nodes(
    grids: &[GridCard],
    systems: &Systems,
) -> Result<(Vec<Node>, Vec<Frame>), FileProblem> {
    let mut nodes = Vec::with_capacity(grids.len());
    let mut frames = Vec::new();
    let mut shared: BTreeMap<u64, u32> = BTreeMap::new();
    for grid in grids {
        let user = || format!("GRID {}", grid.id);
        let position = systems.place(
            grid.placement.unwrap_or(0),
            grid.coordinates,
            &user,
            &grid.at,
        )?;
        if position.iter().any(|x| !x.is_finite()) {
            return Err(grid.at.problem(
                format!("the position of GRID {} is not finite", grid.id),
                "check its coordinates",
            ));
        }
        let analysis = grid.analysis.unwrap_or(0);
        let frame = match shared.get(&analysis) {
            _ if analysis == 0 => None,
            Some(&frame) => Some(frame),
            None => {
                let rotation = systems.axes_at(analysis, position, &user, &grid.at)?;
                let index = frames.len() as u32; // never more than nodes
                frames.push(Frame { rotation });
                if systems.is_rectangular(analysis) {
                    shared.insert(analysis, index);
                }
                Some(index)
            }
        };
        nodes.push(Node {
            id: grid.id,
            position,
            frame,
        });
    }
    Ok((nodes, frames))
}
