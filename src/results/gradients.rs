//! The file of gradients: rows of samples, those of the first parameter first.
//!
//! Its columns are `parameter` and `parameter_unit` (texts), then time, cycle angle and speed if there is a cycle, and the
//! channels as 64-bit floats with the metadata of [`super::schema`]: each in its display unit per that of the parameter.

use super::parquet::{WriteError, write_batch};
use super::{Column, Results, ResultsError, file_stem, replace_file, schema};
use arrow_array::{ArrayRef, Float64Array, StringArray};
use arrow_schema::{DataType, Field, Schema};
use eng_system::DisplayUnit;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The end of the names of these files.
const ENDING: &str = ".gradients.parquet";
/// Names of the columns of texts.
const TEXTS: [&str; 2] = ["parameter", "parameter_unit"];

/// The derivatives of the channels of a run by a parameter, over its samples.
#[derive(Clone, Debug)]
pub struct Gradient {
    /// Path of the parameter.
    pub parameter: String,
    /// Its display unit.
    pub unit: DisplayUnit,
    /// Time, cycle, and the derivative of each channel under the channel's name.
    pub results: Results,
}

/// The file with the gradients of an analysis in a folder.
pub(crate) fn gradients_file(folder: &Path, analysis: &str) -> PathBuf {
    folder.join(format!("{}{ENDING}", file_stem(analysis)))
}

/// Whether a file has the name of one with gradients.
pub(super) fn is_gradients(path: &Path) -> bool {
    let name = path.file_name().map(|name| name.to_string_lossy());
    name.is_some_and(|name| name.ends_with(ENDING))
}

/// Why a file cannot be read as results, if it holds gradients.
pub(super) fn refusal(schema: &Schema) -> Option<String> {
    let first = schema.fields().first()?;
    (first.name() == TEXTS[0] && first.data_type() == &DataType::Utf8).then(|| {
        "it holds gradients, with the names of parameters beside the numbers; pandas, polars and pyarrow read it".to_owned()
    })
}

/// Writes the gradients of a run with its results, whole or not at all. Equal numbers give equal bytes.
pub(crate) fn write_gradients(
    path: &Path,
    gradients: &[Gradient],
    of: &Results,
) -> Result<(), ResultsError> {
    let Some(first) = gradients.first() else {
        return Ok(());
    };
    let mut header = first.results.without_columns();
    let one_unit = gradients.iter().all(|g| g.unit == first.unit);
    for column in first.results.columns() {
        let own = of.column(&column.path).map(|own| &own.display);
        // time and cycle are no derivatives
        let per = own.filter(|own| !one_unit && **own != column.display);
        let symbol = per.map(|own| format!("{}/{}", own.symbol, TEXTS[1]));
        header.push(Column {
            display: DisplayUnit {
                symbol: symbol.unwrap_or_else(|| column.display.symbol.clone()),
                ..column.display.clone()
            },
            values: Vec::new(),
            ..column.clone()
        })?;
    }
    let written = replace_file(path, |file: &mut File| write(file, &header, gradients));
    written.map_err(|error: WriteError| error.at(path.to_owned()))
}

fn write(file: &mut File, header: &Results, gradients: &[Gradient]) -> Result<(), WriteError> {
    let numbers = schema::schema(header);
    let texts = TEXTS.iter();
    let mut fields: Vec<Arc<Field>> = texts
        .map(|name| Arc::new(Field::new(*name, DataType::Utf8, false)))
        .collect();
    fields.extend(numbers.fields().iter().cloned());
    let schema = Arc::new(Schema::new_with_metadata(
        fields,
        numbers.metadata().clone(),
    ));
    let text = |of: fn(&Gradient) -> &str| -> ArrayRef {
        let rows = gradients
            .iter()
            .flat_map(|g| std::iter::repeat_n(of(g), g.results.samples()));
        Arc::new(StringArray::from_iter_values(rows))
    };
    let mut arrays = vec![text(|g| &g.parameter), text(|g| &g.unit.symbol)];
    for index in 0..header.columns().len() {
        let shown = gradients
            .iter()
            .filter_map(|g| g.results.columns().get(index));
        let values: Vec<f64> = shown.flat_map(Column::shown).collect();
        arrays.push(Arc::new(Float64Array::from(values)));
    }
    write_batch(file, header, schema, arrays)
}
