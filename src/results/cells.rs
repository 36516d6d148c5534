//! Cells of fields over the moments of a motion: a Parquet file with one list of 32-bit floats for each moment and
//! quantity.

use super::file::has_ending;
use super::parquet::{WriteError, write_batch};
use super::{Column, Results, ResultsError, file_stem, replace_file, schema};
use arrow_array::{ArrayRef, FixedSizeListArray, Float32Array, Float64Array};
use arrow_schema::{DataType, Field, Schema};
use eng_system::field::FieldGrid;
use eng_system::{Dimension, DisplayUnit};
use std::collections::HashMap;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A quantity in the cells of a field at all moments.
#[derive(Clone, Debug)]
pub(crate) struct CellColumn {
    /// `main[3].pressure`.
    pub path: String,
    pub dimension: Dimension,
    /// The unit of the values.
    pub display: DisplayUnit,
    /// The axes from which the angles count, as a path.
    pub frame: String,
    pub grid: FieldGrid,
    /// In the display unit, moment by moment; a cell has the number `column*rows + row`.
    pub values: Vec<f32>,
}

impl CellColumn {
    fn field(&self) -> Field {
        let rows = self.grid.across.len().saturating_sub(1);
        let lines = |lines: &[f64]| serde_json::json!(lines).to_string();
        let metadata = HashMap::from([
            ("unit".to_owned(), self.display.symbol.clone()),
            ("si_scale".to_owned(), self.display.scale.to_string()),
            ("si_offset".to_owned(), self.display.offset.to_string()),
            ("dimension".to_owned(), self.dimension.to_string()),
            ("frame".to_owned(), self.frame.clone()),
            ("rows".to_owned(), rows.to_string()),
            ("around_rad".to_owned(), lines(&self.grid.around)),
            ("across_m".to_owned(), lines(&self.grid.across)),
            (
                "openings_rad_m".to_owned(),
                serde_json::json!(self.grid.openings).to_string(),
            ),
        ]);
        Field::new(&self.path, self.kind(), false).with_metadata(metadata)
    }

    fn kind(&self) -> DataType {
        let item = Arc::new(Field::new("item", DataType::Float32, false));
        DataType::FixedSizeList(item, i32::try_from(self.grid.cells()).unwrap_or(i32::MAX))
    }
}

/// Whether a file has the name of one that holds cells.
pub(super) fn is_cells(path: &Path) -> bool {
    has_ending(path, ENDING)
}

/// The end of the names of files that hold cells.
const ENDING: &str = ".fields.parquet";

/// Why a file cannot be read as results, if it holds cells.
pub(super) fn refusal(schema: &Schema) -> Option<String> {
    let lists = |field: &&Arc<Field>| matches!(field.data_type(), DataType::FixedSizeList(..));
    let first = schema.fields().iter().find(lists)?;
    Some(format!(
        "it holds the cells of films, such as `{}`: one list of numbers a moment. pandas and pyarrow read it; the channels of its run are \
         in the file without `.fields`",
        first.name()
    ))
}

/// Writes `ANALYSIS.fields.parquet` into a folder, with the time and the cycle's angle of each moment and the
/// metadata of the run, and returns its path.
pub(crate) fn write_cells(
    folder: &Path,
    motion: &Results,
    analysis: &str,
    cells: Vec<CellColumn>,
) -> Result<PathBuf, ResultsError> {
    let path = folder.join(format!("{}{ENDING}", file_stem(analysis)));
    let written = replace_file(&path, |file: &mut File| write(file, motion, cells));
    match written {
        Ok(()) => Ok(path),
        Err(error) => Err(WriteError::at(error, path)),
    }
}

fn write(file: &mut File, motion: &Results, cells: Vec<CellColumn>) -> Result<(), WriteError> {
    let refused = |error: &dyn std::fmt::Display| WriteError::Parquet(error.to_string());
    let mut header = motion.without_columns();
    let known = [super::TIME, super::CYCLE_ANGLE];
    let moments: Vec<&Column> = known
        .iter()
        .filter_map(|path| motion.column(path))
        .collect();
    for column in &moments {
        let pushed = header.push((*column).clone());
        pushed.map_err(|error| refused(&error))?;
    }
    let plain = schema::schema(&header);
    let mut fields: Vec<Field> = plain.fields().iter().map(|f| f.as_ref().clone()).collect();
    fields.extend(cells.iter().map(CellColumn::field));
    let schema = Arc::new(Schema::new_with_metadata(fields, plain.metadata().clone()));
    let mut arrays: Vec<ArrayRef> = (moments.iter())
        .map(|column| Arc::new(Float64Array::from(column.shown())) as ArrayRef)
        .collect();
    for column in cells {
        let DataType::FixedSizeList(item, size) = column.kind() else {
            continue;
        };
        let values = Arc::new(Float32Array::from(column.values));
        let list = FixedSizeListArray::try_new(item, size, values, None);
        arrays.push(Arc::new(list.map_err(|error| refused(&error))?));
    }
    write_batch(file, &header, schema, arrays, |properties| properties)
}
