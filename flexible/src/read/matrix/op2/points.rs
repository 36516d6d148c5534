//! Points of an OP2: their numbers and rows (`EQEXIN`), their places (`BGPDT`, else `GEOM1`).
//!
//! - `EQEXIN`, second record: pairs (number, 10 · first row + kind), kind 1 a grid point of six rows, 2 a scalar point of one; first record:
//!   pairs (number, place in the internal order).
//! - `BGPDT`: for each point in the internal order either (frame, x, y, z), frame −1 for a scalar point, or (frame, first row, number, kind,
//!   support, 0, x, y, z) with places in double precision.
//! - `GEOM1`: records (4501, 45, 1, then for each `GRID` number, input frame, x, y, z, output frame, support, superelement).

use super::super::whole;
use super::blocks::{Block, Blocks};
use crate::error::FileProblem;

/// What the tables say.
#[derive(Default)]
pub(super) struct Points {
    /// Number and code of each point.
    rows: Vec<(i64, i64)>,
    /// Number and place in the internal order.
    order: Vec<(i64, i64)>,
    /// Places in the internal order, with numbers where the table has them; `None`: a scalar point.
    basic: Vec<Option<(Option<i64>, [f64; 3])>>,
    /// Number, input frame, place.
    cards: Vec<(i64, i64, [f64; 3])>,
    /// How many points have an analysis frame of their own, by the table of places and by cards.
    turned: [usize; 2],
}

/// Codes of `GRID` in the table of geometry.
const GRID: [i64; 3] = [4501, 45, 1];

impl Points {
    /// Whether a block is one of these.
    pub fn wants(&self, block: &Block) -> bool {
        matches!(
            block.name.as_str(),
            "EQEXIN" | "EQEXINS" | "BGPDT" | "BGPDTS" | "GEOM1" | "GEOM1S"
        )
    }

    /// Reads a block.
    pub fn read(&mut self, blocks: &mut Blocks, block: &Block) -> Result<(), FileProblem> {
        let mut index = 0;
        while let Some(data) = blocks.next_table()? {
            match (block.name.as_str(), index) {
                ("EQEXIN" | "EQEXINS", 0) => self.order = pairs(&blocks.integers(&data)),
                ("EQEXIN" | "EQEXINS", 1) => self.rows = pairs(&blocks.integers(&data)),
                ("BGPDT" | "BGPDTS", 0) => self.places_of(blocks, block, &data)?,
                ("GEOM1" | "GEOM1S", _) => self.cards_of(blocks, &data),
                _ => {}
            }
            index += 1;
        }
        Ok(())
    }

    fn places_of(
        &mut self,
        blocks: &Blocks,
        block: &Block,
        data: &[u8],
    ) -> Result<(), FileProblem> {
        let key = blocks.key_bytes();
        let count = block.trailer.get(1).copied().unwrap_or(0);
        let count = usize::try_from(count).unwrap_or(0);
        let size = data.len().checked_div(count).unwrap_or(0);
        let (head, real) = if size == 4 * key {
            (key, key)
        } else if size == 6 * key + 24 {
            (6 * key, 8)
        } else {
            return Err(blocks.problem(
                format!(
                    "{} has {} bytes for {count} points, neither 4 words nor 6 and 3 in double precision each",
                    block.name,
                    data.len()
                ),
                "give the places of nodes by the bulk data instead",
            ));
        };
        self.basic = data
            .chunks_exact(size)
            .map(|point| {
                let (head, place) = point.split_at_checked(head)?;
                let words = blocks.integers(head);
                let number = words.get(2).copied();
                let frame = words.first().copied()?;
                self.turned[0] += usize::from(frame > 0);
                let mut reals = place.chunks_exact(real).map(|bytes| blocks.real(bytes));
                let place = [reals.next()?, reals.next()?, reals.next()?];
                (frame >= 0).then_some((number, place))
            })
            .collect();
        Ok(())
    }

    fn cards_of(&mut self, blocks: &Blocks, data: &[u8]) {
        let key = blocks.key_bytes();
        let (codes, cards) = data.split_at_checked(3 * key).unwrap_or((&[], &[]));
        if blocks.integers(codes) != GRID {
            return;
        }
        for card in cards.chunks_exact(8 * key) {
            let words = blocks.integers(card);
            let mut reals = card.chunks_exact(key).map(|bytes| blocks.real(bytes));
            let place = (reals.nth(2), reals.next(), reals.next());
            if let ([number, frame, ..], (Some(x), Some(y), Some(z))) = (words.as_slice(), place) {
                self.cards.push((*number, *frame, [x, y, z]));
                self.turned[1] += usize::from(words.get(5).is_some_and(|frame| *frame > 0));
            }
        }
    }

    /// How many grid points have an analysis frame other than the basic one.
    pub fn turned(&self) -> usize {
        if self.basic.is_empty() {
            self.turned[1]
        } else {
            self.turned[0]
        }
    }

    /// The freedom of each row of a matrix over all points; `None` where the table is missing or makes no sense.
    pub fn rows(&self) -> Option<Vec<(u64, u8)>> {
        let mut points = self
            .rows
            .iter()
            .map(|(number, code)| {
                let number = u64::try_from(*number).ok()?;
                Some((code.div_euclid(10), code.rem_euclid(10), number))
            })
            .collect::<Option<Vec<_>>>()?;
        points.sort_unstable();
        let mut rows = Vec::new();
        for (first, kind, number) in points {
            if usize::try_from(first).ok() != Some(rows.len() + 1) {
                return None;
            }
            match kind {
                1 => rows.extend((1..=6).map(|freedom| (number, freedom))),
                2 => rows.push((number, 0)),
                _ => return None,
            }
        }
        (!rows.is_empty()).then_some(rows)
    }

    /// Numbers and places of the grid points.
    pub fn places(&self, file: &str) -> Result<Vec<(u64, [f64; 3])>, FileProblem> {
        let mut internal = self.order.clone();
        internal.sort_unstable_by_key(|(_, place)| *place);
        let by_order = internal.len() == self.basic.len();
        let mut places = Vec::new();
        for (index, point) in self.basic.iter().enumerate() {
            let Some((number, place)) = point else {
                continue;
            };
            let listed = internal.get(index).filter(|_| by_order);
            match number.or(listed.map(|(number, _)| *number)) {
                Some(number) => places.push((number, *place)),
                None => {
                    places.clear(); // numbers are unknown
                    break;
                }
            }
        }
        if places.is_empty() {
            if let Some((number, frame, _)) = self.cards.iter().find(|card| card.1 != 0) {
                return Err(whole(
                    file,
                    format!("gives grid point {number} in frame {frame} and holds no usable BGPDT"),
                    "give the places of nodes by the bulk data",
                ));
            }
            places = self.cards.iter().map(|card| (card.0, card.2)).collect();
        }
        let found = places
            .into_iter()
            .map(|(number, place)| {
                let sound = place.iter().all(|x| x.is_finite());
                u64::try_from(number)
                    .ok()
                    .filter(|number| *number > 0 && sound)
                    .map(|number| (number, place))
                    .ok_or_else(|| {
                        whole(
                            file,
                            format!("gives grid point {number} the place {place:?}"),
                            "the file is damaged",
                        )
                    })
            })
            .collect::<Result<Vec<_>, _>>()?;
        if found.is_empty() {
            return Err(whole(
                file,
                "holds no places of grid points (BGPDT with EQEXIN, or GEOM1)",
                "write it with PARAM,POST,-1, or give the places of nodes by the bulk data",
            ));
        }
        Ok(found)
    }
}

/// Words two by two.
fn pairs(words: &[i64]) -> Vec<(i64, i64)> {
    let (whole, _) = words.as_chunks::<2>();
    whole.iter().map(|[a, b]| (*a, *b)).collect()
}
