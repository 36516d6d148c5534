//! The file of gradients: rows of samples, those of the first parameter first.
//!
//! Its columns are `parameter` and `parameter_unit` (texts), then time, cycle angle and speed if there is a cycle, and the
//! derivatives of these and of the channels. Numbers are 64-bit floats with the metadata of [`super::schema`]. A
//! derivative is in the display unit of its channel per display unit of the parameter.

use super::gradient::{Gradient, derived_from, gradients_file};
use super::parquet::{WriteError, entries, is_sound, write_batch};
use super::{Column, Results, ResultsError, replace_file, schema};
use crate::regular::open;
use arrow_array::{Array, ArrayRef, Float64Array, RecordBatch, StringArray};
use arrow_schema::{DataType, Field, Schema};
use eng_system::DisplayUnit;
use parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;
use std::fs::File;
use std::path::Path;
use std::sync::Arc;

/// Names of the columns of texts.
const TEXTS: [&str; 2] = ["parameter", "parameter_unit"];

/// Prefix of a key in the metadata. The path of a parameter follows; the value is the SI value of its unit.
const SCALE: &str = "gradient.";

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
    for gradient in gradients {
        let key = format!("{SCALE}{}", gradient.parameter);
        header.set_metadata(key, gradient.unit.scale.to_string());
    }
    for column in first.results.columns() {
        let own = derived_from(&column.path).and_then(|path| of.column(path));
        let per = own.map(|own| &own.display).filter(|_| !one_unit);
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
    write_batch(file, header, schema, arrays, |properties| properties)
}

/// Reads the gradients that a run wrote into a folder with its results; none without their file. Values return to SI
/// within a rounding error of the factor of their unit.
///
/// # Errors
/// A file that cannot be read, or that belongs to other results.
pub(crate) fn read_gradients(folder: &Path, of: &Results) -> Result<Vec<Gradient>, ResultsError> {
    let path = gradients_file(folder, of.analysis());
    if !path.is_file() {
        return Ok(Vec::new());
    }
    let system = |source| ResultsError::File {
        path: path.clone(),
        source,
    };
    let file = open(&path).map_err(system)?;
    let length = file.metadata().map_err(system)?.len();
    // the library panics on some damaged files: see `Results::read_parquet`
    let read = std::panic::catch_unwind(|| read(file, length, of));
    read.unwrap_or(None).ok_or_else(|| ResultsError::Damaged {
        path: path.clone(),
        problem: format!(
            "the file is damaged, or it holds no gradients of these results of {}",
            of.analysis()
        ),
    })
}

fn read(file: File, length: u64, of: &Results) -> Option<Vec<Gradient>> {
    let builder = ParquetRecordBatchReaderBuilder::try_new(file).ok()?;
    if refusal(builder.schema()).is_none() || !is_sound(builder.metadata(), length) {
        return None;
    }
    let fields = builder.schema().fields().iter().skip(TEXTS.len()).cloned();
    let numbers = Schema::new(fields.collect::<Vec<_>>());
    let (header, columns) = schema::header(&entries(builder.metadata()), &numbers).ok()?;
    let mut made: Vec<(Gradient, Vec<Column>)> = Vec::new();
    for batch in builder.build().ok()? {
        add(&batch.ok()?, (&header, &columns), of, &mut made)?;
    }
    let own = |key: &str| key == "source_hash" || key.starts_with("parameter.");
    let mut decided = of.metadata().iter().filter(|(key, _)| own(key));
    if !decided.all(|(key, value)| header.metadata().get(key) == Some(value)) {
        return None;
    }
    let whole = made.into_iter().map(|(mut gradient, columns)| {
        for column in columns {
            gradient.results.push(column).ok()?;
        }
        (gradient.results.samples() == of.samples()).then_some(gradient)
    });
    whole.collect()
}

/// Adds the rows of a batch to the gradients by its parameters.
fn add(
    batch: &RecordBatch,
    (header, columns): (&Results, &[Column]),
    of: &Results,
    made: &mut Vec<(Gradient, Vec<Column>)>,
) -> Option<()> {
    let texts = |at: usize| {
        batch
            .columns()
            .get(at)?
            .as_any()
            .downcast_ref::<StringArray>()
    };
    let (parameters, symbols) = (texts(0)?, texts(1)?);
    let numbers = batch.columns().iter().skip(TEXTS.len());
    let numbers = numbers.map(|array| array.as_any().downcast_ref::<Float64Array>());
    let numbers: Vec<&Float64Array> = numbers.collect::<Option<_>>()?;
    for row in 0..batch.num_rows() {
        let parameter = parameters.value(row);
        if made
            .last()
            .is_none_or(|(last, _)| last.parameter != parameter)
        {
            let scale = header.metadata().get(&format!("{SCALE}{parameter}"))?;
            let unit = DisplayUnit {
                symbol: symbols.value(row).to_owned(),
                scale: scale.parse().ok()?,
                offset: 0.0,
            };
            let own = columns.iter().map(|column| {
                let display = match derived_from(&column.path) {
                    Some(path) => of.column(path)?.display.over(&unit),
                    None => column.display.clone(),
                };
                Some(Column {
                    display,
                    ..column.clone()
                })
            });
            let own = own.collect::<Option<Vec<_>>>()?;
            let results = of.without_columns();
            let parameter = parameter.to_owned();
            made.push((
                Gradient {
                    parameter,
                    unit,
                    results,
                },
                own,
            ));
        }
        let (_, own) = made.last_mut()?;
        for (column, array) in own.iter_mut().zip(&numbers) {
            column.values.push(column.display.to_si(array.value(row)));
        }
    }
    Some(())
}
