//! Conversion of columns and metadata to an Arrow schema and back. Parquet files and streams of a running
//! analysis share it.
//!
//! The metadata of a field hold `unit` (symbol), `si_scale` and `si_offset`
//! (`si = value*si_scale + si_offset`), `dimension` (SI base symbols) and `frame` (absent for a scalar). The
//! metadata of the file hold `eng.analysis`, `eng.model` and `eng.run.KEY` for the data of the run;
//! `PANDAS_ATTRS` repeats units and frames as JSON, so that pandas has them in `DataFrame.attrs`.

use super::{Column, Results, ResultsError, dimension_text};
use arrow_array::{Array, ArrayRef, Float64Array, RecordBatch};
use arrow_schema::{DataType, Field, Schema};
use eng_system::DisplayUnit;
use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;

const ANALYSIS: &str = "eng.analysis";
const MODEL: &str = "eng.model";
const RUN: &str = "eng.run.";
const PANDAS_ATTRIBUTES: &str = "PANDAS_ATTRS";

/// Fields and metadata of results, without their values.
pub(super) fn schema(results: &Results) -> Schema {
    Schema::new_with_metadata(
        results.columns().iter().map(field).collect::<Vec<_>>(),
        metadata(results).into_iter().collect::<HashMap<_, _>>(),
    )
}

/// The file's metadata.
pub(super) fn metadata(results: &Results) -> BTreeMap<String, String> {
    let mut entries = BTreeMap::from([
        (ANALYSIS.to_owned(), results.analysis().to_owned()),
        (MODEL.to_owned(), results.model().to_owned()),
    ]);
    for (key, value) in results.metadata() {
        entries.insert(format!("{RUN}{key}"), value.clone());
    }
    let units: BTreeMap<&str, &str> = results
        .columns()
        .iter()
        .map(|c| (c.path.as_str(), c.display.symbol.as_str()))
        .collect();
    let frames: BTreeMap<&str, &str> = results
        .columns()
        .iter()
        .filter(|c| !c.frame.is_empty())
        .map(|c| (c.path.as_str(), c.frame.as_str()))
        .collect();
    let attributes = serde_json::json!({
        "analysis": results.analysis(),
        "model": results.model(),
        "units": units,
        "frames": frames,
    });
    entries.insert(PANDAS_ATTRIBUTES.to_owned(), attributes.to_string());
    entries
}

/// Results without columns, and their columns without values, from a schema of [`schema`]. The error names
/// the missing metadata.
pub(super) fn header(
    entries: &BTreeMap<String, String>,
    schema: &Schema,
) -> Result<(Results, Vec<Column>), String> {
    let entry = |key: &str| {
        entries
            .get(key)
            .cloned()
            .ok_or_else(|| format!("not a result file of eng: no {key} in its metadata"))
    };
    let mut results = Results::new(entry(ANALYSIS)?, entry(MODEL)?);
    for (key, value) in entries {
        if let Some(key) = key.strip_prefix(RUN) {
            results.set_metadata(key, value);
        }
    }
    let mut columns = Vec::new();
    for field in schema.fields() {
        columns.push(column(field).ok_or_else(|| {
            format!(
                "column {} does not state its unit and dimension",
                field.name()
            )
        })?);
    }
    Ok((results, columns))
}

/// The numbers of a field, in its display unit.
pub(super) fn numbers<'a>(path: &str, array: &'a ArrayRef) -> Result<&'a Float64Array, String> {
    array
        .as_any()
        .downcast_ref::<Float64Array>()
        .ok_or_else(|| format!("column {path} does not hold 64-bit floats"))
}

/// Appends the numbers of a field to its column.
pub(super) fn extend(column: &mut Column, array: &ArrayRef) -> Result<(), String> {
    let shown = numbers(&column.path, array)?;
    let display = &column.display;
    column.values.extend(
        shown
            .iter()
            .map(|shown| display.to_si(shown.unwrap_or(f64::NAN))),
    );
    Ok(())
}

impl Results {
    /// The columns as one batch of Arrow in display units, with the fields and metadata of the Parquet file.
    ///
    /// # Errors
    /// Those of the Arrow library.
    pub fn record_batch(&self) -> Result<RecordBatch, ResultsError> {
        let arrays = self.columns().iter();
        let arrays = arrays.map(|column| Arc::new(Float64Array::from(column.shown())) as ArrayRef);
        let batch = RecordBatch::try_new(Arc::new(schema(self)), arrays.collect());
        batch.map_err(|error| ResultsError::Format {
            format: "Arrow",
            message: error.to_string(),
        })
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
