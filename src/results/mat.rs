//! MAT-files of level 5, uncompressed (MathWorks, "MAT-File Format", version 5).
//!
//! Each channel is a column vector in its display unit under a legal name: `main[5].force.x` is
//! `main_5_force_x`. The structs `units`, `frames` and `paths` have the unit, axes and path of each name, and
//! `info` has the metadata of the run.

use super::{Results, ResultsError, replace_file};
use std::collections::BTreeSet;
use std::io::{self, BufWriter, Write};
use std::path::Path;

/// Length of the longest name in MATLAB.
const LONGEST: usize = 63;

/// The type of data of bytes.
pub const INT8: u32 = 1;
const UINT16: u32 = 4;
const INT32: u32 = 5;
const UINT32: u32 = 6;
const DOUBLE: u32 = 9;
const MATRIX: u32 = 14;

const CLASS_STRUCT: u32 = 2;
const CLASS_CHAR: u32 = 4;
const CLASS_DOUBLE: u32 = 6;

impl Results {
    /// Writes a MAT-file, whole or not at all.
    pub fn write_mat(&self, path: &Path) -> Result<(), ResultsError> {
        let names = legal_names(self.columns().iter().map(|c| c.path.as_str()), &RESERVED);
        // sizes are 32-bit numbers; the widest column decides
        if self.samples() as u64 * 8 > u64::from(i32::MAX as u32) {
            return Err(ResultsError::Format {
                format: "mat",
                message: format!(
                    "{} samples are more than a MAT-file can hold",
                    self.samples()
                ),
            });
        }
        let named = |value: &dyn Fn(&super::Column) -> String| -> Vec<(String, String)> {
            names
                .iter()
                .cloned()
                .zip(self.columns().iter().map(value))
                .collect()
        };
        let structs = [
            ("units", named(&|c| c.display.symbol.clone())),
            ("frames", named(&|c| c.frame.clone())),
            ("paths", named(&|c| c.path.clone())),
            ("info", self.info()),
        ];
        let written = replace_file(path, |file| -> io::Result<()> {
            let mut writer = BufWriter::new(file);
            writer.write_all(&header())?;
            for (name, column) in names.iter().zip(self.columns()) {
                writer.write_all(&vector(name, &column.shown()))?;
            }
            for (name, fields) in &structs {
                writer.write_all(&structure(name, fields))?;
            }
            writer.flush()
        });
        written.map_err(|source| ResultsError::File {
            path: path.to_owned(),
            source,
        })
    }

    fn info(&self) -> Vec<(String, String)> {
        let mut facts = vec![
            ("analysis".to_owned(), self.analysis().to_owned()),
            ("model".to_owned(), self.model().to_owned()),
        ];
        facts.extend(self.metadata().iter().map(|(k, v)| (k.clone(), v.clone())));
        let names = legal_names(facts.iter().map(|f| f.0.as_str()), &[]);
        names
            .into_iter()
            .zip(facts.into_iter().map(|f| f.1))
            .collect()
    }
}

/// Names of the arrays beside those of the columns.
pub const RESERVED: [&str; 4] = ["units", "frames", "paths", "info"];

/// Names that begin with a letter, hold letters, digits and `_`, are of at most `LONGEST` characters, and
/// differ.
pub fn legal_names<'a>(paths: impl Iterator<Item = &'a str>, reserved: &[&str]) -> Vec<String> {
    let mut taken: BTreeSet<String> = reserved.iter().map(|r| (*r).to_owned()).collect();
    paths
        .map(|path| {
            let mut name = String::new();
            for c in path.chars() {
                if c.is_ascii_alphanumeric() {
                    name.push(c);
                } else if !name.ends_with('_') {
                    name.push('_');
                }
            }
            let mut name = name.trim_matches('_').to_owned();
            if !name.starts_with(|c: char| c.is_ascii_alphabetic()) {
                name.insert(0, 'x');
            }
            name.truncate(LONGEST);
            let mut legal = name.clone();
            let mut number = 2;
            while !taken.insert(legal.clone()) {
                let ending = format!("_{number}");
                let room = LONGEST.saturating_sub(ending.len()).min(name.len());
                legal = format!("{}{ending}", name.get(..room).unwrap_or_default());
                number += 1;
            }
            legal
        })
        .collect()
}

/// The header of a file: text, no subsystem data, version 1, byte order.
pub fn header() -> Vec<u8> {
    let text = format!(
        "MATLAB 5.0 MAT-file, written by eng {}",
        env!("CARGO_PKG_VERSION")
    );
    let mut bytes = text.into_bytes();
    bytes.resize(116, b' ');
    bytes.extend([0; 8]);
    bytes.extend(0x0100_u16.to_le_bytes());
    bytes.extend(b"IM");
    bytes
}

/// A data element: tag, data, padding to eight bytes.
pub fn element(kind: u32, data: &[u8]) -> Vec<u8> {
    let mut bytes = kind.to_le_bytes().to_vec();
    bytes.extend((data.len() as u32).to_le_bytes());
    bytes.extend(data);
    bytes.resize(bytes.len().next_multiple_of(8), 0);
    bytes
}

/// Flags, dimensions and name: how every array begins.
fn array(class: u32, rows: usize, columns: usize, name: &str) -> Vec<u8> {
    let mut flags = class.to_le_bytes().to_vec();
    flags.extend([0; 4]);
    let mut dimensions = (rows as i32).to_le_bytes().to_vec();
    dimensions.extend((columns as i32).to_le_bytes());
    let mut bytes = element(UINT32, &flags);
    bytes.extend(element(INT32, &dimensions));
    bytes.extend(element(INT8, name.as_bytes()));
    bytes
}

/// An array of one column of numbers.
pub fn vector(name: &str, values: &[f64]) -> Vec<u8> {
    let mut bytes = array(CLASS_DOUBLE, values.len(), 1, name);
    let data: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
    bytes.extend(element(DOUBLE, &data));
    element(MATRIX, &bytes)
}

fn text(value: &str) -> Vec<u8> {
    let units: Vec<u16> = value.encode_utf16().collect();
    let mut bytes = array(CLASS_CHAR, usize::from(!units.is_empty()), units.len(), "");
    let data: Vec<u8> = units.iter().flat_map(|u| u.to_le_bytes()).collect();
    bytes.extend(element(UINT16, &data));
    element(MATRIX, &bytes)
}

/// A 1×1 struct of texts.
fn structure(name: &str, fields: &[(String, String)]) -> Vec<u8> {
    let width = LONGEST + 1;
    let mut bytes = array(CLASS_STRUCT, 1, 1, name);
    // the small form of an element: size and kind in one word
    bytes.extend((4_u32 << 16 | INT32).to_le_bytes());
    bytes.extend((width as i32).to_le_bytes());
    let mut names = Vec::with_capacity(width * fields.len());
    for (field, _) in fields {
        names.extend(field.as_bytes());
        names.resize(names.len().next_multiple_of(width).max(width), 0);
    }
    bytes.extend(element(INT8, &names));
    for (_, value) in fields {
        bytes.extend(text(value));
    }
    element(MATRIX, &bytes)
}
