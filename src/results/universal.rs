//! Universal files (SDRC, "universal dataset number 58", ASCII): one time response for each channel,
//! in SI.
//!
//! The records follow the University of Cincinnati's description of dataset 58. Dataset 164 before them
//! states SI. The abscissa is time. Evenly spaced samples are written as such (4E20.12); others as pairs,
//! whose abscissa the format gives only six digits (E13.5).

use super::{Column, Results, ResultsError, TIME, replace_file};
use eng_system::{Dimension, DisplayUnit};
use std::io::{self, BufWriter, Write};
use std::path::Path;

/// Codes of "specific data type".
const TYPE_GENERAL: u32 = 1;
const TYPE_TIME: u32 = 17;

impl Results {
    /// Writes a universal file; it appears whole or not at all. Needs a column of time.
    pub fn write_universal(&self, path: &Path) -> Result<(), ResultsError> {
        let time = self.column(TIME).ok_or_else(|| ResultsError::Format {
            format: "uff58",
            message: format!("{} has no time, which is the abscissa", self.analysis()),
        })?;
        let written = replace_file(path, |file| -> io::Result<()> {
            let mut writer = BufWriter::new(file);
            write_units(&mut writer)?;
            for column in self.columns().iter().filter(|c| c.path != TIME) {
                self.write_response(&mut writer, &time.values, column)?;
            }
            writer.flush()
        });
        written.map_err(|source| ResultsError::File {
            path: path.to_owned(),
            source,
        })
    }

    fn write_response(
        &self,
        writer: &mut impl Write,
        time: &[f64],
        column: &Column,
    ) -> io::Result<()> {
        let unit = DisplayUnit::si(column.dimension).symbol;
        write!(writer, "{:>6}\n{:>6}\n", -1, 58)?;
        for line in [
            column.path.as_str(),
            &format!("{} ({})", self.analysis(), self.model()),
            // the date would make the same run another file
            "NONE",
            &match column.frame.as_str() {
                "" => "scalar".to_owned(),
                frame => format!("along axes of {frame}"),
            },
            &format!("unit {}", if unit.is_empty() { "1" } else { &unit }),
        ] {
            writeln!(writer, "{}", field(line, 80).trim_end())?;
        }
        // function 1: time response; no node numbers, the path names the place
        writeln!(
            writer,
            "{:>5}{:>10}{:>5}{:>10} {}{:>10}{:>4} {}{:>10}{:>4}",
            1,
            0,
            1,
            0,
            field("NONE", 10),
            0,
            direction(column),
            field("NONE", 10),
            0,
            0
        )?;
        let even = even_spacing(time);
        let (first, step) = (time.first().copied().unwrap_or(0.0), even.unwrap_or(0.0));
        // 4: real, double precision
        writeln!(
            writer,
            "{:>10}{:>10}{:>10}{}{}{}",
            4,
            time.len(),
            u8::from(even.is_some()),
            exponent(first, 13, 5),
            exponent(step, 13, 5),
            exponent(0.0, 13, 5)
        )?;
        write_axis(writer, TYPE_TIME, [0; 3], "Time", "s")?;
        let (kind, exponents) = kind(column.dimension);
        write_axis(writer, kind, exponents, &column.path, &unit)?;
        write_axis(writer, 0, [0; 3], "NONE", "NONE")?;
        write_axis(writer, 0, [0; 3], "NONE", "NONE")?;
        match even {
            Some(_) => {
                for line in column.values.chunks(4) {
                    for value in line {
                        write!(writer, "{}", exponent(*value, 20, 12))?;
                    }
                    writeln!(writer)?;
                }
            }
            None => {
                let pairs: Vec<(f64, f64)> = time
                    .iter()
                    .copied()
                    .zip(column.values.iter().copied())
                    .collect();
                for line in pairs.chunks(2) {
                    for (time, value) in line {
                        let (time, value) = (exponent(*time, 13, 5), exponent(*value, 20, 12));
                        write!(writer, "{time}{value}")?;
                    }
                    writeln!(writer)?;
                }
            }
        }
        writeln!(writer, "{:>6}", -1)
    }
}

/// Dataset 164: code 1, SI.
fn write_units(writer: &mut impl Write) -> io::Result<()> {
    write!(writer, "{:>6}\n{:>6}\n", -1, 164)?;
    writeln!(
        writer,
        "{:>10}{}{:>10}",
        1,
        field("SI: Meter (newton)", 20),
        2
    )?;
    let one = exponent(1.0, 25, 16);
    writeln!(writer, "{one}{one}{one}")?;
    // offset from the absolute scale of temperature (K) to Celsius
    writeln!(writer, "{}", exponent(273.15, 25, 16))?;
    writeln!(writer, "{:>6}", -1)
}

/// A record of an axis: type, exponents of length, force and temperature, label, unit.
fn write_axis(
    writer: &mut impl Write,
    kind: u32,
    exponents: [i32; 3],
    label: &str,
    unit: &str,
) -> io::Result<()> {
    let [length, force, temperature] = exponents;
    writeln!(
        writer,
        "{kind:>10}{length:>5}{force:>5}{temperature:>5} {} {}",
        field(label, 20),
        field(if unit.is_empty() { "NONE" } else { unit }, 20)
    )
}

/// Exactly so many ASCII characters.
fn field(text: &str, width: usize) -> String {
    let ascii: String = text
        .chars()
        .take(width)
        .map(|c| {
            if c.is_ascii_graphic() || c == ' ' {
                c
            } else {
                '_'
            }
        })
        .collect();
    format!("{ascii:<width$}")
}

/// A number as C writes it with `%w.de`: `1.50000e-03`.
pub fn exponent(value: f64, width: usize, digits: usize) -> String {
    if !value.is_finite() {
        return format!("{:>width$}", format!("{value}"));
    }
    let text = format!("{value:.digits$e}");
    let text = match text.split_once('e') {
        Some((mantissa, power)) => match power.strip_prefix('-') {
            Some(power) => format!("{mantissa}e-{power:0>2}"),
            None => format!("{mantissa}e+{power:0>2}"),
        },
        None => text,
    };
    format!("{text:>width$}")
}

/// The spacing, if the grid from its six digits in the header is within a thousandth of a step of all
/// samples.
pub fn even_spacing(time: &[f64]) -> Option<f64> {
    let (first, last) = (*time.first()?, *time.last()?);
    let steps = time.len().checked_sub(1).filter(|n| *n > 0)?;
    let read = |value: f64| exponent(value, 13, 5).trim().parse::<f64>().ok();
    let step = read((last - first) / steps as f64)?;
    let first = read(first)?;
    let even = time
        .iter()
        .enumerate()
        // a choice: the file has six digits of the step, which a long run multiplies
        .all(|(index, t)| (t - (first + index as f64 * step)).abs() <= 1e-3 * step);
    (step > 0.0 && even).then_some(step)
}

/// 1, 2, 3 for a component along x, y, z; 0 for a scalar.
fn direction(column: &Column) -> u8 {
    if column.frame.is_empty() {
        return 0;
    }
    match column.path.rsplit('.').next() {
        Some("x") => 1,
        Some("y") => 2,
        Some("z") => 3,
        _ => 0,
    }
}

/// Specific data type of a dimension, and its exponents of length, force and temperature: kg^a m^b s^c K^d is
/// N^a m^(b−a) s^(c+2a) K^d.
fn kind(dimension: Dimension) -> (u32, [i32; 3]) {
    let (mass, length, time) = (Dimension::MASS, Dimension::LENGTH, Dimension::TIME);
    let velocity = length.over(time);
    let acceleration = velocity.over(time);
    let force = mass.times(acceleration);
    let known = [
        (length, 8, [1, 0, 0]),
        (velocity, 11, [1, 0, 0]),
        (acceleration, 12, [1, 0, 0]),
        (force, 13, [0, 1, 0]),
        (force.over(length).over(length), 15, [-2, 1, 0]),
        (mass, 16, [-1, 1, 0]),
        (time, TYPE_TIME, [0, 0, 0]),
        (force.times(length), TYPE_GENERAL, [1, 1, 0]),
        (force.times(velocity), TYPE_GENERAL, [1, 1, 0]),
        (Dimension::base(4), 5, [0, 0, 1]),
    ];
    known
        .iter()
        .find(|(of, _, _)| *of == dimension)
        .map_or((TYPE_GENERAL, [0; 3]), |(_, kind, exponents)| {
            (*kind, *exponents)
        })
}
