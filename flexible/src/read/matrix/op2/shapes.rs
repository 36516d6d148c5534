//! Mode shapes of an OP2: the table `OUGV1` and similar ones, with the eigenvalues of the table `LAMA`. A
//! table of shapes has pairs of records: an identification of 146 words, and data of 8 words for each
//! point. MSC and NX write one block for all modes, MYSTRAN one for each mode.
//!
//! Words of the identification, from 0: 0 run · 10 + device (2: modes), 1 code (7: eigenvector; thousands:
//! complex, sorted by point), 3 subcase, 4 mode, 5 eigenvalue, 9 words a point. Data: number · 10 + device,
//! kind (1: grid point), six reals. `LAMA`, second record: mode, order, eigenvalue, angular frequency,
//! frequency, generalised mass and stiffness.

use std::collections::BTreeMap;

use super::super::{COMPLEX, DOUBLE_DIGITS, ForeignModes, ShapeFrame};
use super::blocks::{Block, Blocks};
use crate::error::FileProblem;

/// Modes of normal modes analysis.
const MODES: i64 = 2;
/// Eigenvector.
const EIGENVECTOR: i64 = 7;

struct Shape {
    frame: ShapeFrame,
    subcase: i64,
    mode: u64,
    eigenvalue: f64,
    rows: Vec<(u64, [f64; 6])>,
}

/// Shapes and eigenvalues met.
#[derive(Default)]
pub(super) struct Shapes {
    shapes: Vec<Shape>,
    eigenvalues: BTreeMap<i64, f64>,
    scalar: u64,
}

impl Shapes {
    /// Reads a block, or passes over it.
    pub fn read(&mut self, blocks: &mut Blocks, block: &Block) -> Result<(), FileProblem> {
        let frame = match block.name.as_str() {
            "LAMA" | "LAMAS" => return self.read_eigenvalues(blocks),
            "OUGV1" | "OUGV1PAT" | "OUG1" | "OPHIG" => ShapeFrame::Analysis,
            "BOUGV1" | "BOUG1" | "BOPHIG" => ShapeFrame::Basic,
            _ => return Ok(()),
        };
        while let Some(identification) = blocks.next_table()? {
            let shape = begin(blocks, &identification, block, frame)?;
            let Some(data) = blocks.next_table()? else {
                break;
            };
            if let Some(mut shape) = shape {
                self.rows(blocks, block, &data, &mut shape.rows)?;
                self.shapes.push(shape);
            }
        }
        Ok(())
    }

    fn read_eigenvalues(&mut self, blocks: &mut Blocks) -> Result<(), FileProblem> {
        let mut index = 0;
        while let Some(data) = blocks.next_table()? {
            let key = blocks.key_bytes();
            // a table of one subcase: identification, modes
            if index == 1 && self.eigenvalues.is_empty() {
                for row in data.chunks_exact(7 * key) {
                    let mode = blocks.integers(row).first().copied();
                    let value = row.chunks_exact(key).nth(2).map(|bytes| blocks.real(bytes));
                    if let (Some(mode), Some(value)) = (mode, value.filter(|v| v.is_finite())) {
                        self.eigenvalues.entry(mode).or_insert(value);
                    }
                }
            }
            index += 1;
        }
        Ok(())
    }

    fn rows(
        &mut self,
        blocks: &Blocks,
        block: &Block,
        data: &[u8],
        rows: &mut Vec<(u64, [f64; 6])>,
    ) -> Result<(), FileProblem> {
        let key = blocks.key_bytes();
        if !data.len().is_multiple_of(8 * key) {
            return Err(blocks.problem(
                format!(
                    "the {1} bytes of {0} are not 8 words for each point",
                    block.name,
                    data.len()
                ),
                "write or copy the file again; it is damaged",
            ));
        }
        for point in data.chunks_exact(8 * key) {
            let words = blocks.integers(point);
            let mut reals = point
                .chunks_exact(key)
                .skip(2)
                .map(|bytes| blocks.real(bytes));
            let shape = std::array::from_fn(|_| reals.next().unwrap_or(0.0));
            match words.as_slice() {
                [id, 1, ..] if *id >= 10 && shape.iter().all(|x: &f64| x.is_finite()) => {
                    rows.push((id.unsigned_abs() / 10, shape));
                }
                [_, 2..=9, ..] => self.scalar += 1,
                _ => {
                    return Err(blocks.problem(
                        format!(
                            "{} has the values {shape:?} at point {:?}, of kind {:?}",
                            block.name,
                            words.first().map(|id| id / 10),
                            words.get(1)
                        ),
                        "write the file again; it is damaged, or the run that wrote it failed",
                    ));
                }
            }
        }
        Ok(())
    }

    /// The modes; those in analysis frames where both are there.
    pub fn finish(self, file: &str, key_bytes: usize) -> Result<ForeignModes, FileProblem> {
        let analysis = self
            .shapes
            .iter()
            .any(|shape| shape.frame == ShapeFrame::Analysis);
        let frame = if analysis {
            ShapeFrame::Analysis
        } else {
            ShapeFrame::Basic
        };
        let digits = if key_bytes == 4 { 7 } else { DOUBLE_DIGITS };
        let mut modes = ForeignModes::new(file, frame, digits);
        let subcase = self.shapes.first().map(|shape| shape.subcase);
        let mut passed = 0;
        for shape in self.shapes {
            if shape.frame != frame {
                continue;
            }
            if Some(shape.subcase) != subcase {
                passed += 1;
                continue;
            }
            let listed = i64::try_from(shape.mode)
                .ok()
                .and_then(|mode| self.eigenvalues.get(&mode));
            let own = Some(shape.eigenvalue).filter(|value| value.is_finite());
            modes.push(shape.mode, listed.copied().or(own), shape.rows)?;
        }
        if passed > 0 {
            modes.warnings.push(format!(
                "{file}: modes of later subcases than the first were not read: {passed}"
            ));
        }
        if self.scalar > 0 {
            modes.warnings.push(format!(
                "{file}: {} values of scalar points were not read",
                self.scalar
            ));
        }
        modes.finish("write shapes with VECTOR = ALL and PARAM,POST,-1 in a run of SOL 103")
    }
}

/// A shape from its identification; `None` for other results.
fn begin(
    blocks: &Blocks,
    identification: &[u8],
    block: &Block,
    frame: ShapeFrame,
) -> Result<Option<Shape>, FileProblem> {
    let words = blocks.integers(identification);
    let word = |i: usize| words.get(i).copied().unwrap_or(0);
    if word(0).div_euclid(10) != MODES || word(1).rem_euclid(1000) != EIGENVECTOR {
        return Ok(None);
    }
    if word(1).div_euclid(1000) % 2 == 1 || word(9) == 14 {
        return Err(blocks.problem(format!("{}: the shapes are complex", block.name), COMPLEX));
    }
    if word(1) > 1000 || word(9) != 8 {
        return Err(blocks.problem(
            format!(
                "{}: the shapes are sorted by point (code {}), or each point has {} words instead of 8",
                block.name,
                word(1),
                word(9)
            ),
            "write them with VECTOR(SORT1, REAL) = ALL",
        ));
    }
    let eigenvalue = identification
        .chunks_exact(blocks.key_bytes())
        .nth(5)
        .map_or(f64::NAN, |bytes| blocks.real(bytes));
    Ok(Some(Shape {
        frame,
        subcase: word(3),
        mode: u64::try_from(word(4)).unwrap_or(0),
        eigenvalue,
        rows: Vec::new(),
    }))
}
