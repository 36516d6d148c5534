//! Points of an OP2: their numbers and rows (`EQEXIN`).
//!
//! The second record has pairs (number, 10 · first row + kind). Kind 1 is a grid point with six rows, and kind
//! 2 a scalar point with one row.

use super::blocks::{Block, Blocks};
use crate::error::FileProblem;

/// Numbers and codes of the points.
#[derive(Default)]
pub(super) struct Points(Vec<(i64, i64)>);

impl Points {
    /// Whether a block is one of these.
    pub fn wants(&self, block: &Block) -> bool {
        matches!(block.name.as_str(), "EQEXIN" | "EQEXINS")
    }

    /// Reads a block.
    pub fn read(&mut self, blocks: &mut Blocks) -> Result<(), FileProblem> {
        let mut index = 0;
        while let Some(data) = blocks.next_table()? {
            if index == 1 {
                self.0 = pairs(&blocks.integers(&data));
            }
            index += 1;
        }
        Ok(())
    }

    /// The freedom of each row of a matrix over all points; `None` if the table is missing or makes no sense.
    pub fn rows(&self) -> Option<Vec<(u64, u8)>> {
        let mut points = self
            .0
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
}

/// Words two by two.
fn pairs(words: &[i64]) -> Vec<(i64, i64)> {
    let (whole, _) = words.as_chunks::<2>();
    whole.iter().map(|[a, b]| (*a, *b)).collect()
}
