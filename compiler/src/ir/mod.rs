//! The intermediate form: a typed SSA graph of scalar operations.
//!
//! May contain: inputs by index, constants, scalar operations, table look-ups. Must not contain: vectors, names to be
//! looked up, units, instances. Nodes are created in topological order, each once (hash-consed).

pub mod class;
pub mod graph;

pub use class::{ClassBody, ClassFunctions};
pub use graph::{Function, Graph, Node, Op};
