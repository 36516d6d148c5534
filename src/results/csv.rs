//! Separated values (RFC 4180): a row of paths, a row of units, then the numbers in these units.

use super::{Results, ResultsError, replace_file};
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

/// The form of numbers and fields. The default is a decimal point and commas between fields.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CsvForm {
    separator: char,
    decimal: char,
}

impl Default for CsvForm {
    fn default() -> Self {
        CsvForm {
            separator: ',',
            decimal: '.',
        }
    }
}

impl CsvForm {
    /// Separator of fields, `,`, `;`, a tab, `|` or a blank; and the decimal sign, `.` or `,`. They differ.
    pub fn new(separator: char, decimal: char) -> Result<CsvForm, ResultsError> {
        let refused = |message: &str| {
            Err(ResultsError::Format {
                format: "csv",
                message: message.to_owned(),
            })
        };
        if ![',', ';', '\t', '|', ' '].contains(&separator) {
            return refused("the separator is one of `,` `;` `|`, a tab or a blank");
        }
        if !['.', ','].contains(&decimal) {
            return refused("the decimal sign is `.` or `,`");
        }
        if separator == decimal {
            return refused("separator and decimal sign are the same; take `--separator ';'`");
        }
        Ok(CsvForm { separator, decimal })
    }

    fn row(self, writer: &mut impl Write, fields: impl Iterator<Item = String>) -> io::Result<()> {
        for (index, field) in fields.enumerate() {
            if index > 0 {
                write!(writer, "{}", self.separator)?;
            }
            writer.write_all(field.as_bytes())?;
        }
        writer.write_all(b"\r\n")
    }

    fn quoted(self, field: &str) -> String {
        if field.contains([self.separator, '"', '\r', '\n']) {
            format!("\"{}\"", field.replace('"', "\"\""))
        } else {
            field.to_owned()
        }
    }

    fn number(self, value: f64) -> String {
        let text = number(value);
        match self.decimal {
            '.' => text,
            sign => text.replace('.', &sign.to_string()),
        }
    }
}

impl Results {
    /// Writes `ANALYSIS.csv` (for a failed run `ANALYSIS.failed.csv`) into a folder and returns its path.
    /// pandas reads it with `header=[0, 1]`.
    pub fn write_csv(&self, folder: impl AsRef<Path>) -> Result<PathBuf, ResultsError> {
        let path = folder.as_ref().join(format!("{}.csv", self.stem()));
        self.write_csv_as(&path, CsvForm::default())?;
        Ok(path)
    }

    /// Writes a file in any form, whole or not at all.
    pub fn write_csv_as(&self, path: &Path, form: CsvForm) -> Result<(), ResultsError> {
        let written = replace_file(path, |file: &mut File| -> io::Result<()> {
            let mut writer = BufWriter::new(file);
            self.write_csv_to(&mut writer, form)?;
            writer.flush()
        });
        written.map_err(|source| ResultsError::File {
            path: path.to_owned(),
            source,
        })
    }

    /// Writes the CSV text to a writer. Numbers read back to the same bits, except that a zero has no sign.
    pub fn write_csv_to(&self, writer: &mut impl Write, form: CsvForm) -> io::Result<()> {
        form.row(writer, self.columns().iter().map(|c| form.quoted(&c.path)))?;
        form.row(
            writer,
            self.columns()
                .iter()
                .map(|c| form.quoted(&c.display.symbol)),
        )?;
        for sample in 0..self.samples() {
            form.row(
                writer,
                self.columns().iter().map(|c| {
                    let si = c.values.get(sample).copied().unwrap_or(f64::NAN);
                    form.number(c.display.from_si(si))
                }),
            )?;
        }
        Ok(())
    }
}

/// The shortest text that reads back to the same number. A zero has no sign.
pub fn number(value: f64) -> String {
    let magnitude = value.abs();
    let value = if magnitude == 0.0 { 0.0 } else { value };
    // between these a number without an exponent is as short or nearly so
    if !value.is_finite() || magnitude == 0.0 || (1e-5..1e16).contains(&magnitude) {
        format!("{value}")
    } else {
        format!("{value:e}")
    }
}
