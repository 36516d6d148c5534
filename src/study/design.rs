//! Designs: tables of parameter values, a row for each point, from CSV and Parquet files.
//!
//! A column has the name of a parameter and its unit: `main[5].radial_clearance [um]`.

use crate::counted::counted;
use crate::regular;
use arrow_array::{Array, Float32Array, Float64Array, Int32Array, Int64Array, RecordBatch};
use arrow_schema::{DataType, Field, SchemaRef};
use eng_system::delimited::{Delimited, name_and_unit};
use parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;
use parquet::basic::Compression;
use std::fs::File;
use std::path::{Path, PathBuf};

/// A table of parameter values.
#[derive(Clone, Debug, PartialEq)]
pub struct Design {
    /// Its file.
    pub(crate) path: PathBuf,
    /// Its columns, all of one length.
    pub(crate) columns: Vec<DesignColumn>,
}

/// The values of a parameter.
#[derive(Clone, Debug, PartialEq)]
pub struct DesignColumn {
    /// Path of the parameter.
    pub path: String,
    /// Name of the unit; empty for a pure number.
    pub unit: String,
    /// Values in this unit.
    pub values: Vec<f64>,
}

/// A file that is no design.
#[derive(Debug, thiserror::Error)]
pub enum DesignError {
    /// The system refused.
    #[error("{}: {source}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// The error of the system.
        source: std::io::Error,
    },
    /// The contents are wrong.
    #[error("{}: {message}", path.display())]
    Content {
        /// The file.
        path: PathBuf,
        /// The mistake and the remedy.
        message: String,
    },
}

impl Design {
    /// Reads a design. A file whose name ends with `.parquet` is a Parquet file, any other is text with separators.
    ///
    /// # Errors
    /// A file that cannot be read, or whose cells are no numbers.
    pub fn read(path: &Path) -> Result<Design, DesignError> {
        let bytes = regular::read(path).map_err(|source| DesignError::File {
            path: path.to_owned(),
            source,
        })?;
        let ending = path.extension().unwrap_or_default();
        let columns = match ending.eq_ignore_ascii_case("parquet") {
            true => from_parquet(path),
            false => match String::from_utf8(bytes) {
                Ok(text) => from_text(&text),
                Err(_) => Err(
                    "it is no text in UTF-8; a Parquet file needs the ending .parquet".to_owned(),
                ),
            },
        };
        let columns = columns
            .and_then(whole)
            .map_err(|message| DesignError::Content {
                path: path.to_owned(),
                message,
            })?;
        Ok(Design {
            path: path.to_owned(),
            columns,
        })
    }

    /// Number of points.
    pub fn points(&self) -> usize {
        self.columns.first().map_or(0, |column| column.values.len())
    }
}

/// Refuses a table without rows, columns without a name, and two columns with one name.
pub fn whole(columns: Vec<DesignColumn>) -> Result<Vec<DesignColumn>, String> {
    for (index, column) in columns.iter().enumerate() {
        if column.path.is_empty() {
            return Err(format!(
                "column {} has no name; each column is a parameter. pandas writes such a column for its index: \
                 write the table by `to_csv(…, index=False)`",
                index + 1
            ));
        }
        if columns
            .iter()
            .take(index)
            .any(|other| other.path == column.path)
        {
            return Err(format!(
                "there are two columns of {}; keep one",
                column.path
            ));
        }
        if let Some(row) = column.values.iter().position(|value| !value.is_finite()) {
            return Err(format!(
                "{} of point {} is not a finite number",
                column.path,
                row + 1
            ));
        }
    }
    match columns.first() {
        Some(first) if !first.values.is_empty() => Ok(columns),
        Some(_) => Err("there are no points: only the names of the columns are here".to_owned()),
        None => Err("the table is empty".to_owned()),
    }
}

/// Path and unit of `main[5].clearance [um]`.
pub fn named(header: &str) -> (String, String) {
    let header = header.trim();
    let named = name_and_unit(header).filter(|_| header.ends_with(']'));
    match named {
        Some((path, "1")) => (path.to_owned(), String::new()),
        Some((path, unit)) => (path.to_owned(), unit.to_owned()),
        None => (header.to_owned(), String::new()),
    }
}

/// Columns of a text.
pub fn from_text(text: &str) -> Result<Vec<DesignColumn>, String> {
    let Some(table) = Delimited::read(text) else {
        return Err(
            "the file is empty; its first line names the parameters: length [mm]".to_owned(),
        );
    };
    let mut columns: Vec<DesignColumn> = (table.header.iter())
        .map(|name| {
            let (path, unit) = named(name);
            let values = Vec::new();
            DesignColumn { path, unit, values }
        })
        .collect();
    for row in &table.rows {
        let line = row.line;
        if row.cells.len() != columns.len() {
            return Err(format!(
                "line {line} has {}, and the first line names {}; a decimal comma needs `;` or tabs between the cells",
                counted(row.cells.len(), "cell", "cells"),
                counted(columns.len(), "column", "columns")
            ));
        }
        for (column, cell) in columns.iter_mut().zip(&row.cells) {
            column.values.push(table.number(cell).ok_or_else(|| {
                format!(
                    "line {line}: {cell:?} in the column {} is no number; units are in the first line: {} [mm]",
                    column.path, column.path
                )
            })?);
        }
    }
    Ok(columns)
}

/// Columns of a Parquet file. A field without a unit in its name may have it in its metadata, as results of Eng have.
fn from_parquet(path: &Path) -> Result<Vec<DesignColumn>, String> {
    let file = regular::open(path).map_err(|error| error.to_string())?;
    // the library panics on some damaged files
    let read = std::panic::catch_unwind(|| batches(file)).unwrap_or(Err(None));
    let damaged = || "the Parquet file is damaged".to_owned();
    let (schema, batches) = read.map_err(|refusal| refusal.unwrap_or_else(damaged))?;
    let mut columns: Vec<DesignColumn> = (schema.fields().iter())
        .map(|field| {
            let (path, unit) = named_by(field);
            let values = Vec::new();
            DesignColumn { path, unit, values }
        })
        .collect();
    for batch in &batches {
        for (column, array) in columns.iter_mut().zip(batch.columns()) {
            if let Some(row) = (0..array.len()).find(|row| array.is_null(*row)) {
                let point = column.values.len() + row + 1;
                return Err(format!("{} of point {point} is missing", column.path));
            }
            let numbers = numbers(array.as_ref()).ok_or_else(|| {
                let found = match array.data_type() {
                    DataType::Utf8 | DataType::LargeUtf8 | DataType::Utf8View => "texts".to_owned(),
                    other => other.to_string(),
                };
                format!(
                    "the column {} holds {found}, not numbers; leave it out of the design",
                    column.path
                )
            })?;
            column.values.extend(numbers);
        }
    }
    Ok(columns)
}

/// The schema and the rows of a Parquet file. The error is a refusal, or `None` for damage.
fn batches(file: File) -> Result<(SchemaRef, Vec<RecordBatch>), Option<String>> {
    let builder = ParquetRecordBatchReaderBuilder::try_new(file).map_err(|_| None)?;
    let groups = builder.metadata().row_groups().iter();
    let readable = [Compression::UNCOMPRESSED, Compression::SNAPPY];
    let mut compressions = groups
        .flat_map(|group| group.columns())
        .map(|c| c.compression());
    if let Some(other) = compressions.find(|found| !readable.contains(found)) {
        // without the level
        let name = format!("{other}");
        let name = name.split('(').next().unwrap_or_default();
        return Err(Some(format!(
            "it is compressed by {name}, which Eng does not read; write it with compression=\"snappy\""
        )));
    }
    let schema = builder.schema().clone();
    let batches = builder.build().map_err(|_| None)?;
    let batches = batches.collect::<Result<_, _>>().map_err(|_| None)?;
    Ok((schema, batches))
}

fn named_by(field: &Field) -> (String, String) {
    let (path, unit) = named(field.name());
    match field.metadata().get("unit") {
        Some(stated) if unit.is_empty() && stated != "1" => (path, stated.clone()),
        _ => (path, unit),
    }
}

/// The numbers of an array; `None` for one that holds something else.
fn numbers(array: &dyn Array) -> Option<Vec<f64>> {
    let any = array.as_any();
    if let Some(numbers) = any.downcast_ref::<Float64Array>() {
        return Some(numbers.values().to_vec());
    }
    if let Some(numbers) = any.downcast_ref::<Float32Array>() {
        return Some(numbers.values().iter().map(|x| f64::from(*x)).collect());
    }
    if let Some(numbers) = any.downcast_ref::<Int32Array>() {
        return Some(numbers.values().iter().map(|x| f64::from(*x)).collect());
    }
    let numbers = any.downcast_ref::<Int64Array>()?;
    Some(numbers.values().iter().map(|x| *x as f64).collect())
}
