//! Errors on the way from a finite-element file to a reduced body.

use eng_system::significant::fixed;
use thiserror::Error;

/// A place in a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Place {
    /// The file as a whole.
    File,
    /// A line, from 1.
    Line(u64),
    /// A record of a binary file, from 1, and its first byte.
    Record {
        /// Number of the record.
        record: u64,
        /// Byte where it starts.
        byte: u64,
    },
}

impl std::fmt::Display for Place {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Place::File => Ok(()),
            Place::Line(line) => write!(f, ":{line}"),
            Place::Record { record, byte } => write!(f, ": record {record} at byte {byte}"),
        }
    }
}

/// An unreadable file.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{file}{place}: {problem}")]
pub struct FileProblem {
    /// The file as the model names it.
    pub file: String,
    /// The place.
    pub place: Place,
    /// The problem, with the name of the card, keyword or matrix and the text found.
    pub problem: String,
    /// The remedy; empty without one.
    pub advice: String,
}

impl FileProblem {
    /// A problem at a line.
    pub fn at_line(
        file: &str,
        line: u64,
        problem: impl Into<String>,
        advice: impl Into<String>,
    ) -> Self {
        FileProblem {
            file: file.into(),
            place: Place::Line(line),
            problem: problem.into(),
            advice: advice.into(),
        }
    }
}

/// The part of a request that caused an error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// A marker, by its index in the request.
    Marker(usize),
    /// The stiffness matrix of another code.
    Stiffness,
    /// The mass matrix of another code.
    Mass,
    /// The matrix that recovers nodes.
    Recovery,
}

/// An error of this crate.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum FlexibleError {
    /// A problem in a file.
    #[error(transparent)]
    File(#[from] FileProblem),
    /// The mesh is no structure: an inverted element, a mechanism, no mass.
    #[error("{problem}")]
    Structure {
        /// The problem, with ids.
        problem: String,
        /// The remedy.
        advice: String,
    },
    /// A wrong matrix: not finite, not symmetric, of another size.
    #[error("{problem}")]
    Matrix {
        /// The problem.
        problem: String,
        /// The remedy.
        advice: String,
    },
    /// A matrix that must be regular is singular, or nearly singular, so its factor is useless.
    #[error("{problem}")]
    Singular {
        /// Row of the matrix, from 0, whose pivot vanished. Its freedom can move without resistance.
        row: usize,
        /// The problem, with the row's number. The caller has the node.
        problem: String,
        /// The remedy.
        advice: String,
    },
    /// A row of an interface cannot be held: it does not move, or only together with the others.
    #[error("{problem}")]
    Row {
        /// Number of the row, from 0. The caller has the marker.
        row: usize,
        /// The problem, with the row's label.
        problem: String,
        /// The remedy.
        advice: String,
    },
    /// A problem in a part of the request.
    #[error("{error}")]
    Of {
        /// The part.
        part: Part,
        /// The error.
        error: Box<FlexibleError>,
    },
    /// An iteration did not converge.
    #[error("{problem}")]
    Numerical {
        /// The problem.
        problem: String,
        /// The remedy.
        advice: String,
    },
}

impl FlexibleError {
    /// A mesh or a request that makes no structure.
    pub(crate) fn structure(problem: String, advice: &str) -> FlexibleError {
        FlexibleError::Structure {
            problem,
            advice: advice.into(),
        }
    }

    /// The remedy; empty without one.
    pub fn advice(&self) -> &str {
        match self {
            FlexibleError::File(problem) => &problem.advice,
            FlexibleError::Structure { advice, .. }
            | FlexibleError::Matrix { advice, .. }
            | FlexibleError::Singular { advice, .. }
            | FlexibleError::Row { advice, .. }
            | FlexibleError::Numerical { advice, .. } => advice,
            FlexibleError::Of { error, .. } => error.advice(),
        }
    }

    /// The part of the request that caused the error, if it is known.
    pub fn part(&self) -> Option<Part> {
        match self {
            FlexibleError::Of { part, .. } => Some(*part),
            _ => None,
        }
    }

    /// The same error with a part of the request. An error with a part keeps it.
    pub(crate) fn of(self, part: Part) -> Self {
        match self {
            FlexibleError::Of { .. } => self,
            error => FlexibleError::Of {
                part,
                error: Box::new(error),
            },
        }
    }
}

/// A length (m) in mm, to a tenth of a micrometre.
pub(crate) fn mm(length: f64) -> String {
    let text = fixed(1e3 * length, 4);
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// A place (m) in mm, with the unit.
pub(crate) fn place(at: &[f64]) -> String {
    let components: Vec<String> = at.iter().map(|x| mm(*x)).collect();
    format!("[{}] mm", components.join(", "))
}
