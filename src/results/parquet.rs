//! One Parquet file an analysis.
//!
//! A column a channel, 64-bit floats in the DISPLAY unit. The metadata of a field hold `unit` (symbol), `si_scale` and
//! `si_offset` (`si = value*si_scale + si_offset`), `dimension` (SI base symbols) and `frame` (absent for a scalar).
//! The metadata of the file hold `eng.analysis`, `eng.model` and `eng.run.KEY` for what is known about the run;
//! `PANDAS_ATTRS` repeats units and frames as JSON, so that pandas has them in `DataFrame.attrs`.

use super::{Column, Results, ResultsError, dimension_text, file_stem, replace_file};
use arrow_array::{ArrayRef, Float64Array, RecordBatch};
use arrow_schema::{DataType, Field, Schema};
use eng_system::DisplayUnit;
use parquet::arrow::ArrowWriter;
use parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;
use parquet::basic::{Compression, Encoding};
use parquet::file::metadata::KeyValue;
use parquet::file::properties::{EnabledStatistics, WriterProperties};
use std::collections::{BTreeMap, HashMap};
use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;

const ANALYSIS: &str = "eng.analysis";
const MODEL: &str = "eng.model";
const RUN: &str = "eng.run.";
const PANDAS_ATTRIBUTES: &str = "PANDAS_ATTRS";

/// The system's or the library's refusal, before the path is known.
#[derive(Debug, thiserror::Error)]
enum WriteError {
    #[error(transparent)]
    File(#[from] io::Error),
    #[error("{0}")]
    Parquet(String),
}

impl Results {
    /// Writes `ANALYSIS.parquet` into a folder and returns its path. The file appears whole or not at all.
    pub fn write_parquet(&self, folder: impl AsRef<Path>) -> Result<PathBuf, ResultsError> {
        let path = folder
            .as_ref()
            .join(format!("{}.parquet", file_stem(self.analysis())));
        match replace_file(&path, |file: &mut File| self.write_parquet_to(file)) {
            Ok(()) => Ok(path),
            Err(WriteError::File(source)) => Err(ResultsError::File { path, source }),
            Err(WriteError::Parquet(message)) => Err(ResultsError::Parquet { path, message }),
        }
    }

    fn write_parquet_to(&self, file: &mut File) -> Result<(), WriteError> {
        let refused = |error: &dyn std::fmt::Display| WriteError::Parquet(error.to_string());
        let entries = self.file_metadata();
        let schema = Arc::new(Schema::new_with_metadata(
            self.columns().iter().map(field).collect::<Vec<_>>(),
            entries.clone().into_iter().collect::<HashMap<_, _>>(),
        ));
        // pyarrow and pandas read the schema's entries, other tools the file's
        let entries = entries
            .into_iter()
            .map(|(key, value)| KeyValue::new(key, value))
            .collect();
        let properties = WriterProperties::builder()
            .set_created_by(format!("eng {}", env!("CARGO_PKG_VERSION")))
            .set_compression(Compression::SNAPPY)
            // neighbouring samples share sign and exponent: streams of equal bytes, which then compress
            .set_dictionary_enabled(false)
            .set_encoding(Encoding::BYTE_STREAM_SPLIT)
            .set_statistics_enabled(EnabledStatistics::Chunk)
            .set_key_value_metadata(Some(entries))
            .build();
        let mut writer = ArrowWriter::try_new(file, Arc::clone(&schema), Some(properties))
            .map_err(|e| refused(&e))?;
        if !self.columns().is_empty() {
            let arrays = self
                .columns()
                .iter()
                .map(|column| Arc::new(Float64Array::from(column.shown())) as ArrayRef)
                .collect();
            let batch = RecordBatch::try_new(schema, arrays).map_err(|e| refused(&e))?;
            writer.write(&batch).map_err(|e| refused(&e))?;
        }
        writer.close().map_err(|e| refused(&e))?;
        Ok(())
    }

    fn file_metadata(&self) -> BTreeMap<String, String> {
        let mut entries = BTreeMap::from([
            (ANALYSIS.to_owned(), self.analysis().to_owned()),
            (MODEL.to_owned(), self.model().to_owned()),
        ]);
        for (key, value) in self.metadata() {
            entries.insert(format!("{RUN}{key}"), value.clone());
        }
        let units: BTreeMap<&str, &str> = self
            .columns()
            .iter()
            .map(|c| (c.path.as_str(), c.display.symbol.as_str()))
            .collect();
        let frames: BTreeMap<&str, &str> = self
            .columns()
            .iter()
            .filter(|c| !c.frame.is_empty())
            .map(|c| (c.path.as_str(), c.frame.as_str()))
            .collect();
        let attributes = serde_json::json!({
            "analysis": self.analysis(),
            "model": self.model(),
            "units": units,
            "frames": frames,
        });
        entries.insert(PANDAS_ATTRIBUTES.to_owned(), attributes.to_string());
        entries
    }

    /// Reads what [`Results::write_parquet`] wrote. Values return to SI within a rounding error of the unit's factor.
    pub fn read_parquet(path: impl AsRef<Path>) -> Result<Results, ResultsError> {
        let path = path.as_ref();
        let refused = |message: String| ResultsError::Parquet {
            path: path.to_owned(),
            message,
        };
        let file = File::open(path).map_err(|source| ResultsError::File {
            path: path.to_owned(),
            source,
        })?;
        let builder =
            ParquetRecordBatchReaderBuilder::try_new(file).map_err(|e| refused(e.to_string()))?;
        let entries: BTreeMap<String, String> = builder
            .metadata()
            .file_metadata()
            .key_value_metadata()
            .into_iter()
            .flatten()
            .filter_map(|entry| Some((entry.key.clone(), entry.value.clone()?)))
            .collect();
        let entry = |key: &str| {
            entries
                .get(key)
                .cloned()
                .ok_or_else(|| ResultsError::Foreign {
                    path: path.to_owned(),
                    message: format!("not a result file of eng: no {key} in its metadata"),
                })
        };
        let mut results = Results::new(entry(ANALYSIS)?, entry(MODEL)?);
        for (key, value) in &entries {
            if let Some(key) = key.strip_prefix(RUN) {
                results.set_metadata(key, value);
            }
        }
        let mut columns = Vec::new();
        for field in builder.schema().fields() {
            columns.push(column(field).ok_or_else(|| ResultsError::Foreign {
                path: path.to_owned(),
                message: format!(
                    "column {} does not state its unit and dimension",
                    field.name()
                ),
            })?);
        }
        let reader = builder.build().map_err(|e| refused(e.to_string()))?;
        for batch in reader {
            let batch = batch.map_err(|e| refused(e.to_string()))?;
            for (column, array) in columns.iter_mut().zip(batch.columns()) {
                let numbers = array
                    .as_any()
                    .downcast_ref::<Float64Array>()
                    .ok_or_else(|| ResultsError::Foreign {
                        path: path.to_owned(),
                        message: format!("column {} does not hold 64-bit floats", column.path),
                    })?;
                let display = &column.display;
                column.values.extend(
                    numbers
                        .iter()
                        .map(|shown| display.to_si(shown.unwrap_or(f64::NAN))),
                );
            }
        }
        for column in columns {
            results.push(column)?;
        }
        Ok(results)
    }
}

fn field(column: &Column) -> Field {
    let mut metadata = HashMap::from([
        ("unit".to_owned(), column.display.symbol.clone()),
        ("si_scale".to_owned(), column.display.scale.to_string()),
        ("si_offset".to_owned(), column.display.offset.to_string()),
        ("dimension".to_owned(), column.dimension.to_string()),
    ]);
    if !column.frame.is_empty() {
        metadata.insert("frame".to_owned(), column.frame.clone());
    }
    Field::new(&column.path, DataType::Float64, false).with_metadata(metadata)
}

fn column(field: &Field) -> Option<Column> {
    let metadata = field.metadata();
    Some(Column {
        path: field.name().clone(),
        dimension: dimension_text::parse(metadata.get("dimension")?)?,
        display: DisplayUnit {
            symbol: metadata.get("unit")?.to_owned(),
            scale: metadata.get("si_scale")?.parse().ok()?,
            offset: metadata.get("si_offset")?.parse().ok()?,
        },
        frame: metadata
            .get("frame")
            .map_or_else(String::new, |f| f.to_string()),
        values: Vec::new(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use eng_system::Dimension;

    fn folder(name: &str) -> PathBuf {
        let folder =
            std::env::temp_dir().join(format!("eng-parquet-{name}-{}", std::process::id()));
        let _ = std::fs::remove_dir_all(&folder);
        folder
    }

    fn sample() -> Results {
        let mut results = Results::new("sweep[3]", "Inline4");
        results.set_metadata("version", "0.1.0");
        results.set_metadata("parameter.speed", "4000 rpm");
        let times: Vec<f64> = (0..5000).map(|i| f64::from(i) * 1e-5).collect();
        results
            .push(Column::cycle_angle(
                times.iter().map(|t| t * 400.0).collect(),
            ))
            .unwrap();
        results
            .push(Column::cycle_speed(vec![400.0; 5000]))
            .unwrap();
        let force = Dimension::MASS
            .times(Dimension::LENGTH)
            .over(Dimension::TIME)
            .over(Dimension::TIME);
        results
            .push(Column {
                path: "main[5].force.x".to_owned(),
                dimension: force,
                display: DisplayUnit {
                    symbol: "kN".to_owned(),
                    scale: 1e3,
                    offset: 0.0,
                },
                frame: "block.main[5]".to_owned(),
                values: times.iter().map(|t| 1.0e4 * libm::sin(400.0 * t)).collect(),
            })
            .unwrap();
        results
            .push(Column {
                path: "oil".to_owned(),
                dimension: Dimension::base(4),
                display: DisplayUnit {
                    symbol: "degC".to_owned(),
                    scale: 1.0,
                    offset: 273.15,
                },
                frame: String::new(),
                values: times
                    .iter()
                    .map(|t| if *t == 0.0 { f64::NAN } else { 378.15 })
                    .collect(),
            })
            .unwrap();
        results
    }

    #[test]
    fn round_trip() {
        let folder = folder("round-trip");
        let written = sample();
        let path = written.write_parquet(&folder).unwrap();
        assert_eq!(path.file_name().unwrap(), "sweep[3].parquet");
        let read = Results::read_parquet(&path).unwrap();
        assert_eq!(read.analysis(), "sweep[3]");
        assert_eq!(read.model(), "Inline4");
        assert_eq!(read.metadata(), written.metadata());
        assert_eq!(read.samples(), 5000);
        for (a, b) in read.columns().iter().zip(written.columns()) {
            assert_eq!(
                (&a.path, a.dimension, &a.display, &a.frame),
                (&b.path, b.dimension, &b.display, &b.frame)
            );
            for (x, y) in a.values.iter().zip(&b.values) {
                assert!(
                    (x.is_nan() && y.is_nan()) || (x - y).abs() <= 4e-16 * y.abs().max(300.0),
                    "{x} {y}"
                );
            }
        }
        std::fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn same_results_same_bytes() {
        let (a, b) = (folder("bytes-a"), folder("bytes-b"));
        let first = std::fs::read(sample().write_parquet(&a).unwrap()).unwrap();
        let second = std::fs::read(sample().write_parquet(&b).unwrap()).unwrap();
        assert!(first == second);
        std::fs::remove_dir_all(&a).unwrap();
        std::fs::remove_dir_all(&b).unwrap();
    }

    #[test]
    fn no_columns_and_foreign_files() {
        let folder = folder("foreign");
        let path = Results::new("empty", "M").write_parquet(&folder).unwrap();
        let read = Results::read_parquet(&path).unwrap();
        assert_eq!((read.samples(), read.columns().len()), (0, 0));
        let other = folder.join("other.parquet");
        std::fs::write(&other, b"PAR1 is not enough").unwrap();
        assert!(matches!(
            Results::read_parquet(&other),
            Err(ResultsError::Parquet { .. })
        ));
        assert!(matches!(
            Results::read_parquet(folder.join("none")),
            Err(ResultsError::File { .. })
        ));
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
