//! Errors of code generation.

/// A failure to make machine code.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CodegenError {
    /// No generator exists for this processor.
    #[error("no code can be generated for this machine: {0}")]
    Machine(String),
    /// The generator refused a function.
    #[error("no code can be generated for {function}: {message}")]
    Function {
        /// `Revolute.residual`.
        function: String,
        /// The generator's message.
        message: String,
    },
    /// The system gave no memory for the code, or did not make it executable.
    #[error("no memory for machine code: {0}")]
    Memory(String),
}
