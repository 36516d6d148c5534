//! Comma-separated values (RFC 4180): a row of paths, a row of units, then the numbers in these units.

use super::{Results, ResultsError, file_stem, replace_file};
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

impl Results {
    /// Writes `ANALYSIS.csv` into a folder and returns its path. pandas reads it with `header=[0, 1]`.
    pub fn write_csv(&self, folder: impl AsRef<Path>) -> Result<PathBuf, ResultsError> {
        let path = folder
            .as_ref()
            .join(format!("{}.csv", file_stem(self.analysis())));
        let written = replace_file(&path, |file: &mut File| {
            let mut writer = BufWriter::new(file);
            self.write_csv_to(&mut writer)?;
            writer.flush()
        });
        match written {
            Ok(()) => Ok(path),
            Err(source) => Err(ResultsError::File { path, source }),
        }
    }

    /// Writes the CSV text anywhere. Numbers read back to the same bits.
    pub fn write_csv_to(&self, writer: &mut impl Write) -> io::Result<()> {
        write_row(writer, self.columns().iter().map(|c| quoted(&c.path)))?;
        write_row(
            writer,
            self.columns().iter().map(|c| quoted(&c.display.symbol)),
        )?;
        for sample in 0..self.samples() {
            write_row(
                writer,
                self.columns().iter().map(|c| {
                    let si = c.values.get(sample).copied().unwrap_or(f64::NAN);
                    number(c.display.from_si(si))
                }),
            )?;
        }
        Ok(())
    }
}

fn write_row(writer: &mut impl Write, fields: impl Iterator<Item = String>) -> io::Result<()> {
    for (index, field) in fields.enumerate() {
        if index > 0 {
            writer.write_all(b",")?;
        }
        writer.write_all(field.as_bytes())?;
    }
    writer.write_all(b"\r\n")
}

fn quoted(field: &str) -> String {
    if field.contains([',', '"', '\r', '\n']) {
        format!("\"{}\"", field.replace('"', "\"\""))
    } else {
        field.to_owned()
    }
}

/// The shortest text that reads back to the same number.
fn number(value: f64) -> String {
    let magnitude = value.abs();
    if !value.is_finite() || magnitude == 0.0 || (1e-5..1e16).contains(&magnitude) {
        format!("{value}")
    } else {
        format!("{value:e}")
    }
}

#[cfg(test)]
mod tests {
    use super::super::Column;
    use super::*;
    use eng_system::{Dimension, DisplayUnit};

    #[test]
    fn header_units_and_numbers() {
        let mut results = Results::new("unfired", "Inline4");
        results.push(Column::time(vec![0.0, 1e-6, 0.5])).unwrap();
        results
            .push(Column {
                path: "odd,\"name\"".to_owned(),
                dimension: Dimension::LENGTH,
                display: DisplayUnit {
                    symbol: "mm".to_owned(),
                    scale: 1e-3,
                    offset: 0.0,
                },
                frame: String::new(),
                values: vec![0.054, -1.0, f64::NAN],
            })
            .unwrap();
        let mut text = Vec::new();
        results.write_csv_to(&mut text).unwrap();
        assert_eq!(
            String::from_utf8(text).unwrap(),
            "time,\"odd,\"\"name\"\"\"\r\ns,mm\r\n0,54\r\n1e-6,-1000\r\n0.5,NaN\r\n"
        );
    }

    #[test]
    fn numbers_read_back_to_the_same_bits() {
        for value in [0.1 + 0.2, -1.0 / 3.0, 1e-300, 6.02e23, f64::MAX, 5e-324] {
            assert_eq!(
                number(value).parse::<f64>().unwrap().to_bits(),
                value.to_bits()
            );
        }
    }
}
