//! Readers of finite-element files. One module a family of formats; what they give is a [`crate::Mesh`] or matrices.

pub mod abaqus;
pub(crate) mod faces;
pub mod gmsh;
mod labels;
pub mod matrix;
pub mod nastran;
mod number;
mod source;
mod unread;
mod vector;

use std::io::{self, BufRead, BufReader, Read};

use crate::error::{FileProblem, FlexibleError, Place};
use crate::mesh::Mesh;

/// Gives the readers their files. Names are as the model writes them; a name inside a file (`INCLUDE`) is looked up relative to the
/// including file first, then beside the model.
pub trait Files {
    /// Opens a file.
    ///
    /// # Errors
    /// As the system gives them.
    fn open(&self, name: &str) -> io::Result<Box<dyn Read>>;
}

/// A format of finite-element meshes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum MeshFormat {
    /// Nastran bulk data.
    Nastran,
    /// Input of Abaqus.
    Abaqus,
    /// Input of CalculiX: read as that of Abaqus.
    CalculiX,
    /// A mesh of gmsh.
    Gmsh,
}

impl MeshFormat {
    /// Names that a model can state, with what they stand for.
    pub const NAMED: &[(&str, MeshFormat)] = &[
        ("nastran", MeshFormat::Nastran),
        ("abaqus", MeshFormat::Abaqus),
        ("calculix", MeshFormat::CalculiX),
        ("gmsh", MeshFormat::Gmsh),
    ];

    /// The format of this name.
    pub fn named(name: &str) -> Option<MeshFormat> {
        Self::NAMED
            .iter()
            .find(|(known, _)| *known == name)
            .map(|(_, format)| *format)
    }
}

/// Reads a mesh of a stated format with all files it includes. Units stay those of the file.
///
/// # Errors
/// As the reader of the format gives them.
pub fn read_mesh(files: &dyn Files, name: &str, format: MeshFormat) -> Result<Mesh, FlexibleError> {
    match format {
        MeshFormat::Nastran => nastran::read_bulk(files, name),
        MeshFormat::Abaqus | MeshFormat::CalculiX => abaqus::read_inp(files, name),
        MeshFormat::Gmsh => gmsh::read_msh(files, name),
    }
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
