//! The dataset of a study: a Parquet file with rows of points, their numbers and how they ended.
//!
//! Its columns are `point` (from 1), the numbers as nullable 64-bit floats in their display units with the metadata of
//! [`super::schema`], then the texts [`TEXTS`]. An absent number is null, in the file, and no number (NaN) in memory.

use super::file::has_ending;
use super::parquet::{WriteError, damage, entries, write_batch};
use super::{Results, ResultsError, replace_file, schema};
use crate::regular::open;
use arrow_array::{Array, ArrayRef, Float64Array, Int64Array, StringArray};
use arrow_schema::{DataType, Field, Schema};
use parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;
use parquet::basic::Encoding;
use parquet::schema::types::ColumnPath;
use serde::{Deserialize, Serialize};
use std::fs::File;
use std::path::Path;
use std::sync::Arc;

/// The end of the names of files with all points of a study.
pub(crate) const POINTS: &str = ".points.parquet";

/// Whether a file has the name of one that holds the points of a study.
pub(super) fn is_points(path: &Path) -> bool {
    has_ending(path, POINTS)
}

/// The reason why a file cannot be read as results, if it holds the points of a study.
pub(super) fn refusal(schema: &Schema) -> Option<String> {
    let first = schema
        .fields()
        .first()
        .filter(|field| field.name() == POINT)?;
    (first.data_type() == &DataType::Int64).then(|| {
        "it holds the points of a study, with texts beside the numbers; pandas, polars and pyarrow read it".to_owned()
    })
}

/// Name of the column with the number of the point.
const POINT: &str = "point";
/// Names of the columns of texts, in their order: those of [`PointRow`].
const TEXTS: [&str; 6] = ["state", "code", "message", "place", "warnings", "identity"];

/// A row of a point. A point has one row; one of modes or frequencies has several.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct PointRow {
    /// Its number, from 1.
    pub point: u64,
    /// How it ended: `complete`, `failed`, `stopped`.
    pub state: String,
    /// Code of the failure, such as `E0711`; empty without one.
    pub code: String,
    /// The failure in words; of a complete point the remarks of its reports.
    pub message: String,
    /// Its place: `engine.eng:12`.
    pub place: String,
    /// Codes of the warnings, separated by blanks.
    pub warnings: String,
    /// Hash of everything that decides the numbers.
    pub identity: String,
    /// Bits of the numbers in their display units, in the order of the columns.
    pub values: Vec<u64>,
}

/// Rows of points with their columns.
#[derive(Clone, Debug)]
pub(crate) struct PointTable {
    /// The columns of numbers without values, and the metadata of the study.
    pub header: Results,
    /// Rows in the order of their points.
    pub rows: Vec<PointRow>,
}

impl PointTable {
    /// Whether a name is that of a column of every table of points.
    pub fn is_reserved(name: &str) -> bool {
        name == POINT || TEXTS.contains(&name)
    }

    /// Writes the file, whole or not at all. Equal rows give equal bytes.
    pub fn write(&self, path: &Path) -> Result<(), ResultsError> {
        let written = replace_file(path, |file: &mut File| self.write_to(file));
        written.map_err(|error: WriteError| error.at(path.to_owned()))
    }

    fn schema(&self) -> Schema {
        let numbers = schema::schema(&self.header);
        let nullable = |field: &Arc<Field>| field.as_ref().clone().with_nullable(true);
        let mut fields = vec![Field::new(POINT, DataType::Int64, false)];
        fields.extend(numbers.fields().iter().map(nullable));
        let texts = TEXTS.iter();
        fields.extend(texts.map(|name| Field::new(*name, DataType::Utf8, true)));
        Schema::new_with_metadata(fields, numbers.metadata().clone())
    }

    fn write_to(&self, file: &mut File) -> Result<(), WriteError> {
        let schema = Arc::new(self.schema());
        let numbers = self.rows.iter().map(|row| row.point as i64);
        let mut arrays: Vec<ArrayRef> = vec![Arc::new(Int64Array::from_iter_values(numbers))];
        for index in 0..self.header.columns().len() {
            let values = self.rows.iter().map(|row| {
                let value = row.values.get(index).copied().map(f64::from_bits);
                value.filter(|value| !value.is_nan())
            });
            arrays.push(Arc::new(Float64Array::from_iter(values)));
        }
        for name in TEXTS {
            let texts = self.rows.iter().map(|row| {
                let text = row.text(name);
                Some(text).filter(|text| !text.is_empty())
            });
            arrays.push(Arc::new(StringArray::from_iter(texts)));
        }
        write_batch(file, &self.header, schema, arrays, |properties| {
            let mut properties = properties.set_dictionary_enabled(false);
            for column in self.header.columns() {
                let path = ColumnPath::new(vec![column.path.clone()]);
                properties = properties.set_column_encoding(path, Encoding::BYTE_STREAM_SPLIT);
            }
            for name in TEXTS {
                // most points have the same state and message
                let path = ColumnPath::new(vec![name.to_owned()]);
                properties = properties.set_column_dictionary_enabled(path, true);
            }
            properties
        })
    }

    /// Reads a file of [`PointTable::write`].
    pub fn read(path: &Path) -> Result<PointTable, ResultsError> {
        let file = open(path).map_err(|source| ResultsError::File {
            path: path.to_owned(),
            source,
        })?;
        // the library panics on some damaged files
        let read = std::panic::catch_unwind(|| read(file));
        match read {
            Ok(Ok(table)) => Ok(table),
            Ok(Err(Some(message))) => Err(ResultsError::Foreign {
                path: path.to_owned(),
                message,
            }),
            Ok(Err(None)) | Err(_) => Err(ResultsError::Damaged {
                path: path.to_owned(),
                problem: damage(path),
            }),
        }
    }
}

impl PointRow {
    fn text(&self, name: &str) -> &str {
        match name {
            "state" => &self.state,
            "code" => &self.code,
            "message" => &self.message,
            "place" => &self.place,
            "warnings" => &self.warnings,
            _ => &self.identity,
        }
    }
}

/// The table of a file. The error is a refusal, or `None` for damage.
fn read(file: File) -> Result<PointTable, Option<String>> {
    let builder = ParquetRecordBatchReaderBuilder::try_new(file).map_err(|_| None)?;
    let entries = entries(builder.metadata());
    let fields = builder.schema().fields();
    let foreign = || Some("this is no part of a study".to_owned());
    let numbers = fields
        .len()
        .checked_sub(1 + TEXTS.len())
        .ok_or_else(foreign)?;
    let own = Schema::new(
        fields
            .iter()
            .skip(1)
            .take(numbers)
            .cloned()
            .collect::<Vec<_>>(),
    );
    if fields.first().is_none_or(|field| field.name() != POINT) {
        return Err(foreign());
    }
    let (mut header, columns) = schema::header(&entries, &own).map_err(Some)?;
    for column in columns {
        let pushed = header.push(column);
        pushed.map_err(|error| Some(error.to_string()))?;
    }
    let mut rows = Vec::new();
    for batch in builder.build().map_err(|_| None)? {
        let batch = batch.map_err(|_| None)?;
        let column = |index: usize| batch.columns().get(index).ok_or(None);
        let points = column(0)?.as_any().downcast_ref::<Int64Array>();
        let points = points.ok_or_else(foreign)?;
        let values = (1..=numbers)
            .map(|index| {
                let array = column(index)?.as_any().downcast_ref::<Float64Array>();
                array.cloned().ok_or_else(foreign)
            })
            .collect::<Result<Vec<_>, _>>()?;
        let texts = (1 + numbers..batch.num_columns())
            .map(|index| {
                let array = column(index)?.as_any().downcast_ref::<StringArray>();
                array.cloned().ok_or_else(foreign)
            })
            .collect::<Result<Vec<_>, _>>()?;
        for (at, point) in points.iter().enumerate() {
            let number = |array: &Float64Array| match array.is_null(at) {
                true => f64::NAN.to_bits(),
                false => array.value(at).to_bits(),
            };
            let mut words = texts.iter().map(|array| match array.is_null(at) {
                true => String::new(),
                false => array.value(at).to_owned(),
            });
            let mut word = || words.next().unwrap_or_default();
            rows.push(PointRow {
                point: point
                    .and_then(|p| u64::try_from(p).ok())
                    .ok_or_else(foreign)?,
                state: word(),
                code: word(),
                message: word(),
                place: word(),
                warnings: word(),
                identity: word(),
                values: values.iter().map(number).collect(),
            });
        }
    }
    Ok(PointTable { header, rows })
}
