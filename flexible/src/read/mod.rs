//! Readers of finite-element files, with one module for each family of formats.
//!
//! They yield a [`crate::Mesh`] or matrices.

pub mod abaqus;
pub mod ansys;
mod builder;
pub(crate) mod content;
pub mod csv;
mod gmsh;
mod hdf5;
mod held;
mod labels;
pub mod matrix;
mod med;
pub mod nastran;
pub(crate) mod number;
pub(crate) mod source;
mod tied;
pub mod universal;
mod unread;
mod vector;

use std::io::{self, BufRead, BufReader, Read};

use crate::error::{FileProblem, FlexibleError, Place};
use crate::mesh::{Code, Mesh};
use content::{Content, Readable, explained};
pub use eng_system::mesh_files::MeshFormat;

/// Opens files for the readers. Names are those of the model's text. A name inside a file (`INCLUDE`) is
/// first relative to the including file, then to the model.
pub trait Files {
    /// Opens a file.
    ///
    /// # Errors
    /// Those of the system.
    fn open(&self, name: &str) -> io::Result<Box<dyn Read>>;
}

/// Groups of surfaces that are shells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShellGroups<'a> {
    /// Their names; in a file of gmsh also `physical:TAG` or `physical:2:TAG`. Only the last one names a group whose number a
    /// group of another dimension has too.
    pub groups: &'a [String],
    /// Their thickness, in the unit of length of the file.
    pub thickness: f64,
}

/// No shells.
const NO_SHELLS: ShellGroups<'static> = ShellGroups {
    groups: &[],
    thickness: 0.0,
};

impl Readable for MeshFormat {
    const READ_FOR: &'static str = "meshes";

    fn reads(self, content: Content) -> bool {
        match self {
            MeshFormat::Nastran => content == Content::NastranCards,
            MeshFormat::Abaqus | MeshFormat::CalculiX => content == Content::AbaqusDeck,
            MeshFormat::Gmsh => content == Content::GmshMesh,
            MeshFormat::Ansys => content == Content::AnsysArchive,
            MeshFormat::Universal => content == Content::UniversalFile,
            MeshFormat::Med => content == Content::Hdf5,
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
        MeshFormat::Gmsh => gmsh::read_msh(files, name, NO_SHELLS),
        MeshFormat::Ansys => ansys::read_cdb(files, name),
        MeshFormat::Universal => universal::read_unv(files, name),
        MeshFormat::Med => med::read_med(files, name, NO_SHELLS),
        MeshFormat::Csv => csv::read_nodes(files, name),
    };
    explained(files, name, format, read)
}

/// Reads a mesh of gmsh or a MED file, of which groups of triangles and quadrangles are shells. Its units are still those of
/// the file.
///
/// # Errors
/// Those of the reader, and a group without such surfaces. If the file has another format, the error names it. Files of other
/// formats have sections of their own for shells.
pub fn read_mesh_with_shells(
    files: &dyn Files,
    name: &str,
    format: MeshFormat,
    shells: ShellGroups<'_>,
) -> Result<Mesh, FlexibleError> {
    let read = match format {
        MeshFormat::Gmsh => gmsh::read_msh(files, name, shells),
        MeshFormat::Med => med::read_med(files, name, shells),
        _ => Err(source::whole(
            name,
            "the thickness of its shells is in the file, not in `shells`",
            "leave out `shells` and `thickness`",
        )
        .into()),
    };
    explained(files, name, format, read)
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
