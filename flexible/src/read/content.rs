//! The kind of contents of a file, found from its beginning. A message uses it if the file has another format
//! than the model states.

use std::io::Read;

use super::hdf5::SIGNATURE;
use super::{Files, number};
use crate::error::{FileProblem, FlexibleError, Place};
use eng_system::mesh_files::Stated;

/// The number of bytes read from the beginning. A choice: heads with comments are shorter.
const BEGINNING: u64 = 1 << 16;

/// Words that begin the first lines of a Nastran deck.
const NASTRAN_WORDS: [&str; 40] = [
    "ID", "NASTRAN", "INIT", "ASSIGN", "SOL", "TIME", "CEND", "TITLE", "SUBTITLE", "LABEL", "ECHO",
    "SUBCASE", "METHOD", "DISP", "BEGIN", "INCLUDE", "PARAM", "GRDSET", "GRID", "CORD1R", "CORD2R",
    "CORD2C", "CORD2S", "DMIG", "MAT1", "PSOLID", "PBAR", "PBEAM", "CTETRA", "CHEXA", "CPENTA",
    "CPYRAM", "CBAR", "CBEAM", "CQUAD4", "CTRIA3", "RBE2", "RBE3", "CONM2", "ENDDATA",
];

/// Beginnings of lines of an archive of ANSYS.
const ANSYS_WORDS: [&str; 4] = ["NBLOCK,", "EBLOCK,", "ETBLOCK,", "KEYOPT,"];

/// The contents of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Content {
    /// Cards of Nastran: a deck, or `DMIG`.
    NastranCards,
    /// Keywords of Abaqus or CalculiX.
    AbaqusDeck,
    /// A mesh of gmsh.
    GmshMesh,
    /// Commands of ANSYS.
    AnsysArchive,
    /// Datasets of I-deas.
    UniversalFile,
    /// Nastran's OP2.
    Op2,
    /// Nastran's OP4, binary or text.
    Op4,
    /// Lines `node, freedom, node, freedom, value`.
    MatrixByFreedoms,
    /// Lines `row column value`.
    MatrixByRows,
    /// Lines `node, x, y, z`.
    Nodes,
    /// Lines `node.direction`.
    Freedoms,
    /// Mode shapes of Nastran's punch file.
    PunchedShapes,
    /// Results of CalculiX.
    Frd,
    /// Data of HDF5: a MED file.
    Hdf5,
}

impl Content {
    /// Whether its lines hold numbers alone.
    pub(crate) fn is_numbers(self) -> bool {
        matches!(
            self,
            Content::Nodes | Content::MatrixByRows | Content::MatrixByFreedoms | Content::Freedoms
        )
    }

    /// For messages: "the file holds …".
    fn text(self) -> &'static str {
        match self {
            Content::NastranCards => "cards of Nastran",
            Content::AbaqusDeck => "keywords of an Abaqus or CalculiX input file",
            Content::GmshMesh => "a mesh of gmsh",
            Content::AnsysArchive => "commands of ANSYS",
            Content::UniversalFile => "datasets of a universal file",
            Content::Op2 => "data blocks of Nastran's OP2",
            Content::Op4 => "matrices of Nastran's OP4",
            Content::MatrixByFreedoms => {
                "a matrix of Abaqus, in lines \"node, freedom, node, freedom, value\""
            }
            Content::MatrixByRows => {
                "a matrix of Abaqus or CalculiX, in lines \"row column value\""
            }
            Content::Nodes => "places of nodes, in lines \"node, x, y, z\"",
            Content::Freedoms => "the freedoms of CalculiX's matrices, in lines \"node.direction\"",
            Content::PunchedShapes => "mode shapes of Nastran's punch file",
            Content::Frd => "results of CalculiX (.frd)",
            Content::Hdf5 => "HDF5 data, as the MED files of code_aster and Salome",
        }
    }

    /// The contents of a file, if its beginning shows them. A compressed file is unpacked.
    pub(crate) fn of(files: &dyn Files, file: &str) -> Option<Content> {
        let mut bytes = Vec::new();
        let mut beginning = super::open(files, file).ok()?.take(BEGINNING);
        // after an error, the bytes read so far are enough
        let _ = beginning.read_to_end(&mut bytes);
        Content::of_binary(&bytes).or_else(|| Content::of_text(&String::from_utf8_lossy(&bytes)))
    }

    /// Decides by the length of the first record, in either order of bytes.
    pub fn of_binary(bytes: &[u8]) -> Option<Content> {
        if bytes.starts_with(SIGNATURE) {
            return Some(Content::Hdf5);
        }
        let first = *bytes.first_chunk::<4>()?;
        [i32::from_le_bytes(first), i32::from_be_bytes(first)]
            .into_iter()
            .find_map(|length| match length {
                4 | 8 => Some(Content::Op2),
                24 | 48 => Some(Content::Op4),
                _ => None,
            })
    }

    /// Decides by the first lines.
    pub fn of_text(text: &str) -> Option<Content> {
        let mut lines = text.lines().filter(|line| !line.trim().is_empty());
        lines.find_map(|line| {
            let trimmed = line.trim();
            match trimmed.as_bytes() {
                b"-1" => Some(Content::UniversalFile),
                [b'$', ..] if trimmed == "$MeshFormat" || trimmed == "$NOD" => {
                    Some(Content::GmshMesh)
                }
                [b'$', ..] if trimmed.starts_with("$EIGENV") => Some(Content::PunchedShapes),
                // comments of Nastran and of Abaqus
                [b'$', ..] | [b'*', b'*', ..] => None,
                [b'*', letter, ..] if letter.is_ascii_alphabetic() => Some(Content::AbaqusDeck),
                [b'/', letter, ..] if letter.is_ascii_alphabetic() => Some(Content::AnsysArchive),
                _ if ANSYS_WORDS.iter().any(|word| trimmed.starts_with(word)) => {
                    Some(Content::AnsysArchive)
                }
                [b'1', b'C' | b'U', ..] if line.starts_with("    1") => Some(Content::Frd),
                _ => Content::of_numbers(line).or_else(|| Content::of_card(trimmed)),
            }
        })
    }

    fn of_numbers(line: &str) -> Option<Content> {
        let whole = |text: &&str| number::integer(text).is_some();
        // the head of a matrix: four whole numbers of eight columns each, then a name
        let column = |i: usize| line.get(8 * i..8 * i + 8).map_or("", str::trim);
        let name = line.get(32..40).map_or("", str::trim);
        if (0..4).all(|i| whole(&column(i))) && name.starts_with(|c: char| c.is_alphabetic()) {
            return Some(Content::Op4);
        }
        let fields: Vec<&str> = line
            .split([',', ' ', '\t'])
            .filter(|field| !field.is_empty())
            .collect();
        let (value, places) = fields.split_last()?;
        number::real(value)?;
        match (places.len(), places.iter().all(whole)) {
            (4, true) => Some(Content::MatrixByFreedoms),
            (2, true) => Some(Content::MatrixByRows),
            (3, _) if places.first().is_some_and(whole) && line.contains(',') => {
                Some(Content::Nodes)
            }
            (0, true) if value.contains('.') => Some(Content::Freedoms),
            _ => None,
        }
    }

    fn of_card(line: &str) -> Option<Content> {
        let word = line
            .split(|c: char| !c.is_ascii_alphanumeric())
            .next()?
            .to_ascii_uppercase();
        NASTRAN_WORDS
            .contains(&word.as_str())
            .then_some(Content::NastranCards)
    }
}

/// A format that a model states by a word, and that a reader reads.
pub(crate) trait Readable: Stated + PartialEq {
    /// The purpose of files of these formats: "meshes".
    const READ_FOR: &'static str;

    /// Whether the reader of this format reads such a file.
    fn reads(self, content: Content) -> bool;

    /// Whether a message proposes this format for such a file.
    fn proposed(self, content: Content) -> bool {
        self.reads(content)
    }

    /// The form in which a model states the format of this name.
    fn written(name: &str) -> String {
        format!("`{name}(…)`")
    }
}

/// The result of a reader, with two errors explained. A damaged packed file unpacks to bytes without meaning,
/// and the error is that of the packing. For a file of another format the message names both formats and the
/// word that reads the file.
pub(crate) fn explained<F: Readable, T>(
    files: &dyn Files,
    file: &str,
    stated: F,
    read: Result<T, FlexibleError>,
) -> Result<T, FlexibleError> {
    let problem = match read {
        Err(FlexibleError::File(problem)) => problem,
        other => return other,
    };
    if let Some(damage) = super::damaged_packing(files, &problem.file) {
        return Err(FileProblem {
            file: problem.file,
            place: Place::File,
            problem: format!("the compressed file is damaged: {damage}"),
            advice: "copy or compress the file again; `gzip -t` tests it".into(),
        }
        .into());
    }
    let content = Content::of(files, file).filter(|content| !stated.reads(*content));
    let Some(content) = content else {
        return Err(problem.into());
    };
    let names = |wanted: &dyn Fn(F) -> bool| -> Vec<String> {
        let fit = F::NAMED.iter().filter(|(_, format)| wanted(*format));
        fit.map(|(name, _)| F::written(name)).collect()
    };
    let others = names(&|format| format.proposed(content));
    let advice = match others.is_empty() {
        false => format!("write {} for this file", others.join(" or ")),
        true => format!(
            "Eng reads {} by {}",
            F::READ_FOR,
            names(&|_| true).join(", ")
        ),
    };
    Err(FileProblem {
        file: file.into(),
        place: Place::File,
        problem: format!(
            "the model states {}, but the file holds {}",
            names(&|format| format == stated).join(" or "),
            content.text()
        ),
        advice,
    }
    .into())
}
