//! Why a class gets no machine code.

/// Machine code that could not be made.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CodegenError {
    /// There is no generator for this kind of machine.
    #[error("no code can be generated for this machine: {0}")]
    Machine(String),
    /// The generator refused a function.
    #[error("no code can be generated for {function}: {message}")]
    Function {
        /// `Revolute.residual`.
        function: String,
        /// The generator's words.
        message: String,
    },
    /// Memory for the code could not be had or made executable.
    #[error("no memory for machine code: {0}")]
    Memory(String),
}
