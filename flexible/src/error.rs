//! What can go wrong between a finite-element file and a reduced body.

use thiserror::Error;

/// Where in a file something was found.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Place {
    /// The file as a whole.
    File,
    /// A line, from 1.
    Line(u64),
    /// A byte of a binary file, and which record this is, from 1.
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

/// A file that can't be read as what it should be.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{file}{place}: {problem}")]
pub struct FileProblem {
    /// The file as the model names it.
    pub file: String,
    /// Where.
    pub place: Place,
    /// What is wrong, with card, keyword or matrix name and the text found.
    pub problem: String,
    /// What to do; empty where nothing sensible can be said.
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

/// A part of a request that an error is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// A marker, by its index in the request.
    Marker(usize),
    /// The stiffness matrix of another code.
    Stiffness,
    /// The mass matrix of another code.
    Mass,
}

/// An error of this crate.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum FlexibleError {
    /// A file is not what it should be.
    #[error(transparent)]
    File(#[from] FileProblem),
    /// The mesh makes no sense as a structure: an inverted element, a mechanism, no mass.
    #[error("{problem}")]
    Structure {
        /// What is wrong, with ids.
        problem: String,
        /// What to do.
        advice: String,
    },
    /// A matrix is not what it should be: not finite, not symmetric, of the wrong size.
    #[error("{problem}")]
    Matrix {
        /// What is wrong.
        problem: String,
        /// What to do.
        advice: String,
    },
    /// A matrix that must be regular is singular, or so nearly that its factor means nothing.
    #[error("{problem}")]
    Singular {
        /// Row of the matrix, from 0, whose pivot vanished: one of the freedoms that can move without
        /// resistance.
        row: usize,
        /// What is wrong, by the row's number; the caller knows which node it is.
        problem: String,
        /// What to do.
        advice: String,
    },
    /// A row of an interface can't be held: nothing moves it, or only together with the others.
    #[error("{problem}")]
    Row {
        /// Number of the row, from 0; the caller knows which marker it is.
        row: usize,
        /// What is wrong, by the row's label.
        problem: String,
        /// What to do.
        advice: String,
    },
    /// What is wrong with a part of the request.
    #[error("{error}")]
    Of {
        /// Which part.
        part: Part,
        /// What is wrong.
        error: Box<FlexibleError>,
    },
    /// An iteration did not come to its end.
    #[error("{problem}")]
    Numerical {
        /// What did not work.
        problem: String,
        /// What to do.
        advice: String,
    },
}

impl FlexibleError {
    /// What to do about it; empty where nothing sensible can be said.
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

    /// The part of the request that it is about, where it is about one.
    pub fn part(&self) -> Option<Part> {
        match self {
            FlexibleError::Of { part, .. } => Some(*part),
            _ => None,
        }
    }

    /// As an error of a part of the request; one that has a part keeps it.
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
