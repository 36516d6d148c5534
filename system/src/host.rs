//! The interface through which the compiler reads files.
//!
//! The embedding program implements it.

/// A file that could not be read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum HostError {
    /// No such file.
    #[error("there is no file {0}")]
    NotFound(String),
    /// Outside the folders that a model may read.
    #[error("{0} is outside the model's folder")]
    Outside(String),
    /// The system's own message.
    #[error("{path}: {message}")]
    System {
        /// The file.
        path: String,
        /// The message of the operating system.
        message: String,
    },
}

/// Reads files for the compiler. Paths are relative to the model's folder, with `/`.
pub trait Host {
    /// A text file.
    fn read_text(&self, path: &str) -> Result<String, HostError>;
}
