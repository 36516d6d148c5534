//! Readers of finite-element files. One module a family of formats; what they give is a [`crate::Mesh`] or matrices.

pub mod matrix;
pub mod nastran;
mod number;

use std::io::{self, BufRead, BufReader, Read};

use crate::error::{FileProblem, Place};

/// Gives the readers their files. Names are as the model writes them; a name inside a file (`INCLUDE`) is looked up relative to the
/// including file first, then beside the model.
pub trait Files {
    /// Opens a file.
    ///
    /// # Errors
    /// As the system gives them.
    fn open(&self, name: &str) -> io::Result<Box<dyn Read>>;
}

/// Opens a file for reading in a stream; a gzip-compressed one is unpacked as it is read.
///
/// # Errors
/// When it can't be opened.
pub fn open(files: &dyn Files, name: &str) -> Result<Box<dyn BufRead>, FileProblem> {
    let failed = |error: io::Error| FileProblem {
        file: name.into(),
        place: Place::File,
        problem: format!("can't be opened: {error}"),
        advice: "check the name; paths count from the folder of the model".into(),
    };
    let mut buffered = BufReader::with_capacity(1 << 16, files.open(name).map_err(failed)?);
    let packed = buffered
        .fill_buf()
        .map_err(failed)?
        .starts_with(&[0x1f, 0x8b]);
    if packed {
        let unpacked = flate2::bufread::MultiGzDecoder::new(buffered);
        return Ok(Box::new(BufReader::with_capacity(1 << 16, unpacked)));
    }
    Ok(Box::new(buffered))
}
