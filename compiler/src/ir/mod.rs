//! The intermediate form: a typed graph of scalar operations, each of which is assigned once (SSA).
//!
//! A graph contains inputs by index, constants, scalar operations and table look-ups. It must not contain
//! vectors, names, units or instances. Nodes are created in topological order, and each exists once
//! (hash-consed).

mod class;
pub(crate) mod depth;
pub(crate) mod differentiate;
mod graph;
pub(crate) mod interpret;
pub(crate) mod kinks;
mod linearise;
pub(crate) mod look_up;
pub mod optimise;
mod print;

pub use class::{ClassBody, ClassFunctions};
pub(crate) use differentiate::inputs_of;
pub use differentiate::{DifferentiateError, forward, gradient};
pub use graph::{Function, Graph, Node, Op};
pub use interpret::{InterpretedClass, Interpreter};
pub use kinks::{BoundKink, KinkKind, KinkPlace};
pub use look_up::Orders;
pub use optimise::optimise;
pub(crate) use optimise::{copy_into, dependencies};
