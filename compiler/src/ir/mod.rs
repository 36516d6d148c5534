//! The intermediate form: a typed graph of scalar operations, each of which is assigned once (SSA).
//!
//! A graph contains inputs by index, constants, scalar operations and table look-ups. It must not contain
//! vectors, names, units or instances. Nodes are created in topological order, and each exists once
//! (hash-consed).

pub mod class;
pub mod depth;
pub mod differentiate;
pub mod graph;
pub mod interpret;
pub(crate) mod kinks;
mod linearise;
pub mod look_up;
pub mod optimise;
mod print;

pub use class::{ClassBody, ClassFunctions};
pub use differentiate::{
    DifferentiateError, forward, gradient, inputs_of, time_derivative, uses_acceleration,
};
pub use graph::{Function, Graph, Node, Op};
pub use interpret::{InterpretedClass, Interpreter};
pub use kinks::{BoundKink, KinkKind, KinkPlace};
pub use look_up::Orders;
pub(crate) use optimise::dependencies;
pub use optimise::{copy_into, optimise};
