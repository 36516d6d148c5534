//! Readers of finite-element files, with one module for each family of formats.
//!
//! They yield a [`crate::Mesh`] or matrices.

pub mod abaqus;
pub mod ansys;
mod builder;
mod content;
pub mod csv;
pub mod gmsh;
mod held;
mod labels;
pub mod matrix;
pub mod nastran;
mod number;
mod source;
mod tied;
pub mod universal;
mod unread;
mod vector;

use std::io::{self, BufRead, BufReader, Read};

use crate::error::{FileProblem, FlexibleError, Place};
use crate::mesh::{Code, Mesh};
use content::{Content, Readable, explained};
pub use eng_system::mesh_files::MeshFormat;
use gmsh::ShellGroups;

/// Opens files for the readers. Names are those of the model's text. A name inside a file (`INCLUDE`) is
/// first relative to the including file, then to the model.
pub trait Files {
    /// Opens a file.
    ///
    /// # Errors
    /// Those of the system.
    fn open(&self, name: &str) -> io::Result<Box<dyn Read>>;
}

impl Readable for MeshFormat {
    const READ_FOR: &'static str = "meshes";

    fn reads(self, content: Content) -> bool {
        match self {
            MeshFormat::Nastran => content == Content::NastranCards,
            MeshFormat::Abaqus | MeshFormat::CalculiX => content == Content::AbaqusDeck,
            MeshFormat::Gmsh => content == Content::GmshMesh,
            MeshFormat::Ansys => content == Content::AnsysArchive,
            MeshFormat::Universal => content == Content::UniversalFile,
            // the beginning of a wrong table may look as any list of numbers
            MeshFormat::Csv => content.is_numbers(),
        }
    }

    fn proposed(self, content: Content) -> bool {
        match self {
            MeshFormat::Csv => content == Content::Nodes,
            _ => self.reads(content),
        }
    }
}

/// Reads a mesh of a stated format with all included files. Its units are still those of the file.
///
/// # Errors
/// Those of the reader of the format. If the file has another format, the error names it.
pub fn read_mesh(files: &dyn Files, name: &str, format: MeshFormat) -> Result<Mesh, FlexibleError> {
    let read = match format {
        MeshFormat::Nastran => nastran::read_bulk(files, name),
        MeshFormat::Abaqus => abaqus::read_inp(files, name, Code::Abaqus),
        MeshFormat::CalculiX => abaqus::read_inp(files, name, Code::CalculiX),
        MeshFormat::Gmsh => gmsh::read_msh(files, name),
        MeshFormat::Ansys => ansys::read_cdb(files, name),
        MeshFormat::Universal => universal::read_unv(files, name),
        MeshFormat::Csv => csv::read_nodes(files, name),
    };
    explained(files, name, format, read)
}

/// Reads a mesh of gmsh, of which groups of triangles and quadrangles are shells. Its units are still those of the file.
///
/// # Errors
/// Those of the reader, and a group without such surfaces. If the file has another format, the error names it.
pub fn read_mesh_of_gmsh(
    files: &dyn Files,
    name: &str,
    shells: ShellGroups<'_>,
) -> Result<Mesh, FlexibleError> {
    let read = gmsh::read_msh_with_shells(files, name, shells);
    explained(files, name, MeshFormat::Gmsh, read)
}

/// The damage of a gzip-compressed file, found by unpacking all of it. `None` for an undamaged or an unpacked
/// file.
fn damaged_packing(files: &dyn Files, name: &str) -> Option<String> {
    let mut packed = BufReader::new(files.open(name).ok()?);
    if !packed.fill_buf().ok()?.starts_with(&PACKED) {
        return None;
    }
    let mut unpacked = flate2::bufread::MultiGzDecoder::new(packed);
    let unpacking = io::copy(&mut unpacked, &mut io::sink());
    unpacking.err().map(|error| error.to_string())
}

/// First bytes of a gzip-compressed file (RFC 1952).
const PACKED: [u8; 2] = [0x1f, 0x8b];

/// Opens a file as a stream. A gzip-compressed file is unpacked during reading.
///
/// # Errors
/// When it can't be opened.
pub fn open(files: &dyn Files, name: &str) -> Result<Box<dyn BufRead>, FileProblem> {
    let failed = |error: io::Error| FileProblem {
        file: name.into(),
        place: Place::File,
        problem: format!("can't be opened: {error}"),
        advice: "check the name; paths are relative to the folder of the model".into(),
    };
    let mut buffered = BufReader::with_capacity(1 << 16, files.open(name).map_err(failed)?);
    let packed = buffered.fill_buf().map_err(failed)?.starts_with(&PACKED);
    if packed {
        let unpacked = flate2::bufread::MultiGzDecoder::new(buffered);
        return Ok(Box::new(BufReader::with_capacity(1 << 16, unpacked)));
    }
    Ok(Box::new(buffered))
}
