//! Matrices as cards: `DMIG` of a punch file (`EXTSEOUT(…, DMIGPCH)`, `PARAM,EXTOUT,DMIGPCH`) or of a deck.
//!
//! A head `DMIG name 0 IFO TIN TOUT POLAR – NCOL` (IFO 1 square, 6 symmetric with one triangle, 2 and 9
//! rectangular; TIN 1, 2 real, 3, 4 complex), then a card for each column:
//! `DMIG name GJ CJ – G1 C1 A1 B1 …`, with four fields for each entry. Rows are points and freedoms 1…6, 0
//! for a scalar point.

use std::collections::{BTreeMap, BTreeSet};

use super::card::Card;
use super::sections::read_cards;
use crate::error::FileProblem;
use crate::read::Files;
use crate::read::matrix::{COMPLEX, ForeignFreedoms, ForeignMatrix, Held, chosen};

/// A point and its freedom.
type Freedom = (u64, u8);

/// The form (IFO) of matrices whose columns are numbers instead of freedoms.
const NUMBERED: u64 = 9;

/// A matrix being read.
struct Matrix {
    form: u64,
    kind: u64,
    columns: Option<u64>,
    entries: Vec<(Freedom, Freedom, f64)>,
    seen: BTreeSet<Freedom>,
    column_points: BTreeSet<Freedom>,
}

/// Reads the matrix of this name from `DMIG` cards, or the only one where `name` is empty. Its rows are the
/// freedoms that it names, by points and freedoms in rising order; a freedom without any entry is not in it.
///
/// # Errors
/// With file and line of the card: a column before its head, a complex matrix, a point or freedom that
/// does not exist, text in the place of a number; a name that the file does not hold, with the names that
/// it holds.
pub fn read_dmig(files: &dyn Files, file: &str, name: &str) -> Result<ForeignMatrix, FileProblem> {
    let mut matrices: BTreeMap<String, Matrix> = BTreeMap::new();
    read_cards(files, file, |card| {
        if card.name != "DMIG" {
            return Ok(());
        }
        if let Some(lost) = card.lost_problem() {
            return Err(lost);
        }
        add(&card, name, &mut matrices)
    })?;
    let mut held = Vec::new();
    let mut found = None;
    for (own, matrix) in &matrices {
        let matrix = matrix.finish(file, own);
        held.push(Held {
            name: own.clone(),
            size: (matrix.rows, matrix.columns),
        });
        if name.is_empty() || own.eq_ignore_ascii_case(name) {
            found = Some(matrix);
        }
    }
    chosen(file, name, &held, found)
}

/// Adds the head or a column of a matrix.
fn add(
    card: &Card,
    name: &str,
    matrices: &mut BTreeMap<String, Matrix>,
) -> Result<(), FileProblem> {
    let own = card.text(0).to_string();
    if own.is_empty() {
        return Err(card.problem(
            "the name of the matrix is missing",
            "write the name in the first field",
        ));
    }
    if card.text(1) == "0" {
        let kind = card.id(3, "TIN")?;
        let form = card.id(2, "IFO")?;
        if matrices.contains_key(&own) {
            return Err(card.problem(
                "the matrix has two heads",
                "give each matrix its own name or its own file",
            ));
        }
        let columns = card.optional_id(7, "NCOL")?;
        if form == NUMBERED && columns.is_none() {
            return Err(card.problem(
                "NCOL is missing: the columns of this matrix are numbers",
                "write the number of columns in the last field of the head",
            ));
        }
        if columns.is_some_and(|count| u32::try_from(count).is_err()) {
            return Err(card.problem("NCOL is too large", "check the last field of the head"));
        }
        matrices.insert(
            own,
            Matrix {
                form,
                kind,
                columns,
                entries: Vec::new(),
                seen: BTreeSet::new(),
                column_points: BTreeSet::new(),
            },
        );
        return Ok(());
    }
    let Some(matrix) = matrices.get_mut(&own) else {
        return Err(card.problem(
            "this column comes before the head of its matrix",
            "write the head \"DMIG name 0 IFO TIN …\" before the columns; the file may have been cut",
        ));
    };
    let wanted = name.is_empty() || own.eq_ignore_ascii_case(name);
    if matrix.kind > 2 && wanted {
        return Err(card.problem(&format!("matrix {own} is complex"), COMPLEX));
    }
    let column = freedom(card, 1, "GJ", "CJ")?;
    let count = matrix.columns.unwrap_or(0);
    if matrix.is_numbered() && !(1..=count).contains(&column.0) {
        return Err(card.problem(
            &format!("column {} is beyond NCOL, which states {count}", column.0),
            "correct NCOL, the last field of the head",
        ));
    }
    matrix.column_points.insert(column);
    if matrix.form == 1 || matrix.form == 6 {
        matrix.seen.insert(column);
    }
    let mut i = 4;
    while i < card.len() {
        let row = freedom(card, i, "G", "C")?;
        let value = card.real(i + 2, "A")?;
        matrix.seen.insert(row);
        if wanted {
            matrix.entries.push((row, column, value));
        }
        i += 4;
    }
    Ok(())
}

/// A point and its freedom in two fields.
fn freedom(card: &Card, i: usize, point: &str, component: &str) -> Result<Freedom, FileProblem> {
    let id = card.id(i, point)?;
    let freedom = card.freedom(i + 1, component)?;
    Ok((id, freedom.map_or(0, |freedom| freedom + 1)))
}

impl Matrix {
    /// Whether columns are numbers 1…NCOL instead of freedoms.
    fn is_numbered(&self) -> bool {
        self.form == NUMBERED
    }

    fn finish(&self, file: &str, name: &str) -> ForeignMatrix {
        let rows = self.seen.iter().copied().collect::<Vec<_>>();
        let square = self.form == 1 || self.form == 6;
        let points = if square {
            rows.clone()
        } else {
            self.column_points.iter().copied().collect()
        };
        // the lists contain every such freedom, because the cards put it there; their lengths fit
        // in 32 bits
        let place = |list: &[Freedom], at: &Freedom| list.binary_search(at).unwrap_or(0) as u32;
        let count = match self.columns {
            Some(count) if self.is_numbered() => count as usize, // 32 bits, as its card was checked
            _ => points.len(),
        };
        let column = |freedom: &Freedom| {
            if self.is_numbered() {
                freedom.0 as u32 - 1 // from 1 to the number of columns, as cards were checked
            } else {
                place(&points, freedom)
            }
        };
        ForeignMatrix {
            file: file.into(),
            name: name.into(),
            rows: rows.len(),
            columns: count,
            symmetric: self.form == 6,
            entries: self
                .entries
                .iter()
                .map(|(row, at, value)| (place(&rows, row), column(at), *value))
                .collect(),
            freedoms: Some(ForeignFreedoms { rows }),
        }
    }
}
