//! Matrices and mode shapes written by other codes: OP2, OP4, DMIG and punch files of Nastran, `.mtx` of
//! Abaqus, `.sti`, `.mas`, `.dof` and `.frd` of CalculiX.
//!
//! Each reader returns a [`ForeignMatrix`] in the form of the file; [`ForeignMatrix::to_symmetric`] checks
//! and completes it. Values keep the units of the file, and rows keep its order. [`ForeignFreedoms`] gives
//! the freedom of each row, if the file states it.
//!
//! ```text
//! bytes (Fortran records) ─▶ op4, op2 ─┐
//! text (lines) ─▶ op4, coordinate      ├─▶ ForeignMatrix ─▶ SymmetricMatrix
//! cards ─▶ DMIG ───────────────────────┘
//! op2, punch, frd, universal file ─▶ ForeignModes
//! ```

mod bytes;
mod check;
mod coordinate;
mod frd;
mod modes;
mod op2;
mod op4;
mod punch;
mod substructure;
mod table;
pub(super) mod text;

pub use super::nastran::read_dmig;
pub use super::universal::read_unv_modes;
pub(crate) use coordinate::of_pairs;
pub use coordinate::{read_abaqus_matrix, read_calculix_freedoms, read_calculix_matrix};
pub use frd::read_frd_modes;
pub(super) use modes::DOUBLE_DIGITS;
pub use modes::{ForeignMode, ForeignModes, ShapeFrame};
pub use op2::{read_op2_matrix, read_op2_modes};
pub use op4::read_op4;
pub use punch::read_punch_modes;
pub use table::read_dense_matrix;

use super::Files;
use super::content::{Content, Readable, explained};
pub(super) use crate::read::source::whole;

use crate::error::{FileProblem, FlexibleError};
use eng_system::mesh_files::Stated;
pub use eng_system::mesh_files::{MatrixFormat, ShapeFormat};

/// The kind of a matrix, for its checks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MatrixKind {
    /// Stiffness.
    Stiffness,
    /// Mass: its diagonal is not negative.
    Mass,
}

impl MatrixKind {
    /// Its name in Abaqus' files of substructures.
    pub(crate) const fn of_substructure(self) -> &'static str {
        match self {
            MatrixKind::Stiffness => "STIFFNESS",
            MatrixKind::Mass => "MASS",
        }
    }
}

/// The freedom of each row of a matrix.
#[derive(Clone, Debug, PartialEq, Eq, Default)]
pub struct ForeignFreedoms {
    /// For each row the node's number and the freedom 1…6 in its analysis frame; 0 for a scalar (modal)
    /// point.
    pub rows: Vec<(u64, u8)>,
}

/// A matrix in the form of its file.
#[derive(Clone, Debug, PartialEq)]
pub struct ForeignMatrix {
    /// Its file.
    pub file: String,
    /// Its name in the file; empty if the format has no names.
    pub name: String,
    /// Number of rows.
    pub rows: usize,
    /// Number of columns.
    pub columns: usize,
    /// Whether the file holds one triangle of a symmetric matrix. The other one is its mirror image.
    pub symmetric: bool,
    /// Row and column from 0, value; in the order of the file. Entries at the same place add; those of one
    /// triangle may lie on either side of the diagonal.
    pub entries: Vec<(u32, u32, f64)>,
    /// The freedoms of the rows, if the file states them.
    pub freedoms: Option<ForeignFreedoms>,
}

impl ForeignMatrix {
    /// The matrix with freedoms from another source.
    ///
    /// # Errors
    /// When the number of freedoms is not the number of rows.
    pub fn with_freedoms(mut self, freedoms: ForeignFreedoms) -> Result<Self, FlexibleError> {
        if freedoms.rows.len() != self.rows {
            return Err(self.problem(
                format!(
                    "has {} rows, but the list has {} freedoms",
                    self.rows,
                    freedoms.rows.len()
                ),
                "give the matrix and the list of freedoms of the same run",
            ));
        }
        self.freedoms = Some(freedoms);
        Ok(self)
    }

    /// Its name in messages.
    fn title(&self) -> String {
        if self.name.is_empty() {
            format!("{}: the matrix", self.file)
        } else {
            format!("{}: matrix {}", self.file, self.name)
        }
    }

    fn problem(&self, problem: impl std::fmt::Display, advice: &str) -> FlexibleError {
        FlexibleError::Matrix {
            problem: format!("{} {problem}", self.title()),
            advice: advice.into(),
        }
    }

    /// The name of a row (counted from 0) in messages.
    fn row_name(&self, row: usize) -> String {
        match self
            .freedoms
            .as_ref()
            .and_then(|freedoms| freedoms.rows.get(row))
        {
            Some((point, 0)) => format!("row {} (point {point})", row + 1),
            Some((node, freedom)) => format!("row {} (node {node}, freedom {freedom})", row + 1),
            None => format!("row {}", row + 1),
        }
    }
}

impl Readable for MatrixFormat {
    const READ_FOR: &'static str = "stiffness and mass";

    fn reads(self, content: Content) -> bool {
        match self {
            MatrixFormat::Op4 => content == Content::Op4,
            MatrixFormat::Op2 => content == Content::Op2,
            MatrixFormat::Dmig => content == Content::NastranCards,
            // the reader itself recognises matrices of substructures, which begin with a keyword
            MatrixFormat::Abaqus => matches!(
                content,
                Content::MatrixByFreedoms | Content::MatrixByRows | Content::AbaqusDeck
            ),
            MatrixFormat::CalculiX => content == Content::MatrixByRows,
            // the beginning of a dense matrix may look as any list of numbers
            MatrixFormat::Csv => content.is_numbers(),
        }
    }

    fn proposed(self, content: Content) -> bool {
        self != MatrixFormat::Csv && self.reads(content)
    }
}

/// Reads a matrix of a stated format. If the format has names, `name` selects the matrix. It may be empty if
/// the file holds a single matrix.
///
/// # Errors
/// The errors of the format's reader. For a file of another format the error names that format.
pub fn read_matrix(
    files: &dyn Files,
    file: &str,
    format: MatrixFormat,
    name: &str,
) -> Result<ForeignMatrix, FlexibleError> {
    let read = match format {
        MatrixFormat::Op4 => read_op4(files, file, name),
        MatrixFormat::Op2 => read_op2_matrix(files, file, name),
        MatrixFormat::Dmig => read_dmig(files, file, name),
        MatrixFormat::Abaqus => read_abaqus_matrix(files, file, name),
        MatrixFormat::CalculiX => read_calculix_matrix(files, file),
        MatrixFormat::Csv => read_dense_matrix(files, file),
    };
    explained(files, file, format, read.map_err(FlexibleError::from))
}

impl Readable for ShapeFormat {
    const READ_FOR: &'static str = "mode shapes";

    fn reads(self, content: Content) -> bool {
        match self {
            ShapeFormat::Op2 => content == Content::Op2,
            // for a punch file without shapes, its reader names the output to request in the run
            ShapeFormat::Punch => {
                matches!(content, Content::PunchedShapes | Content::NastranCards)
            }
            ShapeFormat::Frd => content == Content::Frd,
            ShapeFormat::Universal => content == Content::UniversalFile,
        }
    }

    fn written(name: &str) -> String {
        format!("`format: {name}`")
    }
}

/// The format of a file of mode shapes, by its beginning; `None` if it has the beginning of no such file.
pub fn shape_format(files: &dyn Files, file: &str) -> Option<ShapeFormat> {
    let content = Content::of(files, file)?;
    let mut formats = ShapeFormat::NAMED.iter().map(|(_, format)| *format);
    formats.find(|format| format.reads(content))
}

/// Reads mode shapes of a stated format.
///
/// # Errors
/// The errors of the format's reader. For a file of another format the error names that format.
pub fn read_modes(
    files: &dyn Files,
    file: &str,
    format: ShapeFormat,
) -> Result<ForeignModes, FlexibleError> {
    let read = match format {
        ShapeFormat::Op2 => read_op2_modes(files, file),
        ShapeFormat::Punch => read_punch_modes(files, file),
        ShapeFormat::Frd => read_frd_modes(files, file),
        ShapeFormat::Universal => read_unv_modes(files, file),
    };
    explained(files, file, format, read.map_err(FlexibleError::from))
}

/// A matrix of a file, for lists.
pub(super) struct Held {
    /// Name.
    pub name: String,
    /// Rows and columns.
    pub size: (usize, usize),
}

/// Selects a matrix of a file: by name, or the only one if the name is empty.
pub(super) fn chosen(
    file: &str,
    name: &str,
    held: &[Held],
    found: Option<ForeignMatrix>,
) -> Result<ForeignMatrix, FileProblem> {
    let list = held
        .iter()
        .map(|matrix| format!("{} ({} × {})", matrix.name, matrix.size.0, matrix.size.1))
        .collect::<Vec<_>>()
        .join(", ");
    let advice = if held.is_empty() {
        "the file contains no matrix".to_string()
    } else {
        format!("the file contains {list}")
    };
    let times = held
        .iter()
        .filter(|matrix| name.is_empty() || matrix.name.eq_ignore_ascii_case(name))
        .count();
    match found {
        Some(matrix) if times == 1 => Ok(matrix),
        Some(_) if name.is_empty() => Err(whole(
            file,
            "contains several matrices, and the model names none",
            format!("name one of them; {advice}"),
        )),
        Some(_) => Err(whole(
            file,
            format!("contains {times} matrices with the name {name}"),
            "write each with its own name or into its own file",
        )),
        None => Err(whole(
            file,
            if name.is_empty() {
                "contains no matrix".to_string()
            } else {
                format!("contains no matrix {name}")
            },
            advice,
        )),
    }
}

/// The remedy for a complex matrix, which Eng does not read.
pub(super) const COMPLEX: &str = "write real stiffness and mass: remove structural damping (GE, PARAM G), \
     aerodynamics and fluid from the run, and state damping at the body in the model";

/// The remedy for a file that ends too early.
pub(super) const CUT: &str =
    "copy or write the file again; it was cut, or the run that wrote it was stopped";
