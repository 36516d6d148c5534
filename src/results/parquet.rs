//! One Parquet file for each analysis.
//!
//! Each channel is a column of 64-bit floats in the DISPLAY unit. [`schema`] describes the metadata.

use super::{Column, Results, ResultsError, replace_file, schema};
use crate::regular::open;
use arrow_array::{ArrayRef, Float64Array, RecordBatch};
use arrow_schema::Schema;
use parquet::arrow::ArrowWriter;
use parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;
use parquet::basic::{Compression, Encoding};
use parquet::file::metadata::{KeyValue, ParquetMetaData};
use parquet::file::properties::{EnabledStatistics, WriterProperties, WriterPropertiesBuilder};
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Number of rows written at a time. It does not depend on the portions in which rows come, so the same rows
/// give the same bytes. A choice: some megabytes for a hundred columns.
const CHUNK: usize = 16_384;
/// Rows of a row group, the smallest part that a reader loads. A choice: larger groups compress a little
/// better and take more memory while they are written, smaller ones make the file's index long.
const ROW_GROUP: usize = 4 * CHUNK;

/// An error of the system or of the library, before the path is known.
#[derive(Debug, thiserror::Error)]
pub(super) enum WriteError {
    #[error(transparent)]
    File(#[from] io::Error),
    #[error("{0}")]
    Parquet(String),
}

impl WriteError {
    /// Adds the path.
    pub fn at(self, path: PathBuf) -> ResultsError {
        match self {
            WriteError::File(source) => ResultsError::File { path, source },
            WriteError::Parquet(message) => ResultsError::Parquet { path, message },
        }
    }
}

fn refused(error: impl std::fmt::Display) -> WriteError {
    WriteError::Parquet(error.to_string())
}

/// Writes rows that come in any portions. Memory holds at most [`CHUNK`] rows and one compressed row group.
pub(super) struct ParquetRows<'a> {
    writer: ArrowWriter<&'a mut File>,
    schema: Arc<Schema>,
    rows: Vec<Vec<f64>>,
    sum: Sum,
}

impl<'a> ParquetRows<'a> {
    /// Begins a file with the columns and metadata of results. It does not use their values.
    pub fn new(file: &'a mut File, header: &Results) -> Result<Self, WriteError> {
        let entries = schema::metadata(header);
        let schema = Arc::new(schema::schema(header));
        let sum = Sum::new(&entries, &schema);
        // pyarrow and pandas read the entries of the schema, other tools read those of the file
        let entries = entries
            .into_iter()
            .map(|(key, value)| KeyValue::new(key, value))
            .collect();
        let properties = WriterProperties::builder()
            .set_created_by(format!("eng {}", env!("CARGO_PKG_VERSION")))
            .set_compression(Compression::SNAPPY)
            // neighbouring samples share sign and exponent, so the streams of bytes hold runs of equal bytes,
            // which compress well
            .set_dictionary_enabled(false)
            .set_encoding(Encoding::BYTE_STREAM_SPLIT)
            .set_statistics_enabled(EnabledStatistics::Chunk)
            .set_max_row_group_row_count(Some(ROW_GROUP))
            .set_key_value_metadata(Some(entries))
            .build();
        Ok(ParquetRows {
            writer: ArrowWriter::try_new(file, Arc::clone(&schema), Some(properties))
                .map_err(refused)?,
            schema,
            rows: vec![Vec::new(); header.columns().len()],
            sum,
        })
    }

    /// Adds rows: one slice for each column, all of the same length, in display units.
    pub fn push(&mut self, columns: &[&[f64]]) -> Result<(), WriteError> {
        let length = columns.first().map_or(0, |c| c.len());
        let mut from = 0;
        while from < length {
            let held = self.rows.first().map_or(0, Vec::len);
            let to = length.min(from + (CHUNK - held));
            for (row, column) in self.rows.iter_mut().zip(columns) {
                row.extend_from_slice(column.get(from..to).unwrap_or_default());
            }
            if held + (to - from) == CHUNK {
                self.write()?;
            }
            from = to;
        }
        Ok(())
    }

    fn write(&mut self) -> Result<(), WriteError> {
        for (index, row) in self.rows.iter().enumerate() {
            self.sum.add(index, row);
        }
        let arrays = self
            .rows
            .iter_mut()
            .map(|row| Arc::new(Float64Array::from(std::mem::take(row))) as ArrayRef)
            .collect();
        let batch = RecordBatch::try_new(Arc::clone(&self.schema), arrays).map_err(refused)?;
        self.writer.write(&batch).map_err(refused)
    }

    /// Writes the remaining rows and the end of the file.
    pub fn close(mut self) -> Result<(), WriteError> {
        if self.rows.first().is_some_and(|row| !row.is_empty()) {
            self.write()?;
        }
        let sum = KeyValue::new(SUM.to_owned(), self.sum.text());
        self.writer.append_key_value_metadata(sum);
        self.writer.close().map_err(refused)?;
        Ok(())
    }
}

/// Key of the checksum over the whole contents of a file. Files of earlier versions have none and can still
/// be read.
const SUM: &str = "eng.sha256";
/// Key under which the library keeps the schema itself. The checksum covers its fields instead.
const SCHEMA: &str = "ARROW:schema";

/// SHA-256 of the metadata, the names and units of the columns, and their numbers. It is needed because the
/// pages of the file have no checksums of their own. Each column has its own sum, so that the portions in
/// which rows come do not matter.
struct Sum {
    header: Sha256,
    columns: Vec<Sha256>,
}

impl Sum {
    fn new(entries: &BTreeMap<String, String>, schema: &Schema) -> Sum {
        let mut header = Sha256::new();
        let mut text = |text: &str| {
            header.update((text.len() as u64).to_le_bytes());
            header.update(text);
        };
        for (key, value) in entries {
            if key != SUM && key != SCHEMA {
                text(key);
                text(value);
            }
        }
        for field in schema.fields() {
            text(field.name());
            let metadata: BTreeMap<&String, &String> = field.metadata().iter().collect();
            for (key, value) in metadata {
                text(key);
                text(value);
            }
        }
        Sum {
            header,
            columns: vec![Sha256::new(); schema.fields().len()],
        }
    }

    /// Adds numbers of the column with an index.
    fn add(&mut self, index: usize, numbers: &[f64]) {
        if let Some(column) = self.columns.get_mut(index) {
            for number in numbers {
                column.update(number.to_le_bytes());
            }
        }
    }

    fn text(self) -> String {
        let mut all = self.header;
        for column in self.columns {
            all.update(column.finalize());
        }
        all.finalize().iter().map(|b| format!("{b:02x}")).collect()
    }
}

impl Results {
    /// Writes `ANALYSIS.parquet` (of a failed run `ANALYSIS.failed.parquet`) into a folder and returns its
    /// path. The file appears whole or not at all.
    pub fn write_parquet(&self, folder: impl AsRef<Path>) -> Result<PathBuf, ResultsError> {
        let path = folder.as_ref().join(format!("{}.parquet", self.stem()));
        match replace_file(&path, |file: &mut File| self.write_parquet_to(file)) {
            Ok(()) => Ok(path),
            Err(error) => Err(error.at(path)),
        }
    }

    fn write_parquet_to(&self, file: &mut File) -> Result<(), WriteError> {
        let mut writer = ParquetRows::new(file, self)?;
        let shown: Vec<Vec<f64>> = self.columns().iter().map(Column::shown).collect();
        writer.push(&shown.iter().map(Vec::as_slice).collect::<Vec<_>>())?;
        writer.close()
    }

    /// Reads a file of [`Results::write_parquet`]. Values return to SI within a rounding error of the unit's
    /// factor.
    pub fn read_parquet(path: impl AsRef<Path>) -> Result<Results, ResultsError> {
        let path = path.as_ref();
        let system = |source| ResultsError::File {
            path: path.to_owned(),
            source,
        };
        let file = open(path).map_err(system)?;
        let length = file.metadata().map_err(system)?.len();
        // the library panics on some damaged files: on bad sizes and offsets, which `read` checks first, and
        // perhaps on other damage
        let read = std::panic::catch_unwind(|| read(file, length));
        match read.unwrap_or(Err(Refused::Damage)) {
            Ok(results) => Ok(results),
            Err(Refused::Damage) => Err(ResultsError::Damaged {
                path: path.to_owned(),
                problem: damage(path),
            }),
            Err(Refused::Foreign(message)) => Err(ResultsError::Foreign {
                path: path.to_owned(),
                message,
            }),
        }
    }
}

/// The reason why a file cannot be read.
enum Refused {
    /// The library reports damage.
    Damage,
    /// It is a Parquet file, but not one that Eng wrote.
    Foreign(String),
}

/// Writes a table of one batch with the entries of a header. `encoded` sets the encodings of its columns.
pub(super) fn write_batch(
    file: &mut File,
    header: &Results,
    schema: Arc<Schema>,
    arrays: Vec<ArrayRef>,
    encoded: impl FnOnce(WriterPropertiesBuilder) -> WriterPropertiesBuilder,
) -> Result<(), WriteError> {
    let refused = |error: &dyn std::fmt::Display| WriteError::Parquet(error.to_string());
    let batch = RecordBatch::try_new(Arc::clone(&schema), arrays);
    let batch = batch.map_err(|error| refused(&error))?;
    // tools other than pyarrow read the entries of the file, as with all results
    let entries = schema::metadata(header).into_iter();
    let entries = entries.map(|(key, value)| KeyValue::new(key, value));
    let properties = WriterProperties::builder()
        .set_created_by(format!("eng {}", env!("CARGO_PKG_VERSION")))
        .set_compression(Compression::SNAPPY)
        .set_key_value_metadata(Some(entries.collect()));
    let writer = ArrowWriter::try_new(file, schema, Some(encoded(properties).build()));
    let mut writer = writer.map_err(|error| refused(&error))?;
    writer.write(&batch).map_err(|error| refused(&error))?;
    writer.close().map_err(|error| refused(&error))?;
    Ok(())
}

/// The named texts in the metadata of a file.
pub(super) fn entries(metadata: &ParquetMetaData) -> BTreeMap<String, String> {
    metadata
        .file_metadata()
        .key_value_metadata()
        .into_iter()
        .flatten()
        .filter_map(|entry| Some((entry.key.clone(), entry.value.clone()?)))
        .collect()
}

fn read(file: File, length: u64) -> Result<Results, Refused> {
    let damaged = |_: parquet::errors::ParquetError| Refused::Damage;
    let builder = ParquetRecordBatchReaderBuilder::try_new(file).map_err(damaged)?;
    let refusal = super::cells::refusal(builder.schema());
    let refusal = refusal.or_else(|| super::points::refusal(builder.schema()));
    if let Some(refusal) = refusal.or_else(|| super::gradients::refusal(builder.schema())) {
        return Err(Refused::Foreign(refusal));
    }
    if !is_sound(builder.metadata(), length) {
        return Err(Refused::Damage);
    }
    let entries = entries(builder.metadata());
    let (mut results, mut columns) =
        schema::header(&entries, builder.schema()).map_err(Refused::Foreign)?;
    let mut sum = Sum::new(&entries, builder.schema());
    let reader = builder.build().map_err(damaged)?;
    for batch in reader {
        let batch = batch.map_err(|_| Refused::Damage)?;
        for (index, (column, array)) in columns.iter_mut().zip(batch.columns()).enumerate() {
            let numbers = schema::numbers(&column.path, array).map_err(Refused::Foreign)?;
            sum.add(index, numbers.values());
            schema::extend(column, array).map_err(Refused::Foreign)?;
        }
    }
    if entries.get(SUM).is_some_and(|stated| *stated != sum.text()) {
        return Err(Refused::Damage);
    }
    for column in columns {
        results
            .push(column)
            .map_err(|error| Refused::Foreign(error.to_string()))?;
    }
    Ok(results)
}

/// Whether the offsets and sizes of columns lie within a file of this length.
pub(super) fn is_sound(metadata: &ParquetMetaData, length: u64) -> bool {
    metadata.row_groups().iter().all(|group| {
        group.num_rows() >= 0
            && group.columns().iter().all(|column| {
                let start = column
                    .dictionary_page_offset()
                    .unwrap_or(column.data_page_offset());
                let end = start.checked_add(column.compressed_size());
                start >= 0
                    && column.data_page_offset() >= start
                    && column.compressed_size() >= 0
                    && column.uncompressed_size() >= 0
                    && column.num_values() == group.num_rows()
                    && end.is_some_and(|end| u64::try_from(end).is_ok_and(|end| end <= length))
            })
    })
}

/// The mark at both ends of a Parquet file.
const MARK: [u8; 4] = *b"PAR1";

/// The damage of a file that the library cannot read, as far as both ends of the file show it.
pub(super) fn damage(path: &Path) -> String {
    let ends = || -> io::Result<(u64, [u8; 4], [u8; 4])> {
        let mut file = open(path)?;
        let length = file.metadata()?.len();
        let (mut head, mut tail) = ([0; 4], [0; 4]);
        if length >= 8 {
            file.read_exact(&mut head)?;
            file.seek(SeekFrom::End(-4))?;
            file.read_exact(&mut tail)?;
        }
        Ok((length, head, tail))
    };
    match ends() {
        Ok((0, ..)) => "the file is empty".to_owned(),
        Ok((length, MARK, tail)) if tail != MARK => {
            format!("the end of the file is missing: it was cut after {length} bytes")
        }
        Ok((_, MARK, _)) => "the file is damaged inside".to_owned(),
        Ok(_) => "this is no Parquet file".to_owned(),
        Err(error) => format!("the file can't be read: {error}"),
    }
}
