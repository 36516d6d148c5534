//! Eng for programs in C, and the functions of FMI in every FMU.
//!
//! It translates calls, values and errors, and has no rules of its own. `include/eng.h` describes the functions for C.
//! Unsafe code reads and writes the memory of the caller ([`edge`]). No panic leaves a function.
#![deny(clippy::undocumented_unsafe_blocks, unsafe_op_in_unsafe_fn)]
// Tests may call the standard library's functions, to compare with them.
#![cfg_attr(not(test), deny(clippy::disallowed_methods))]
// no input may end the program around in a panic
#![cfg_attr(
    not(test),
    deny(
        clippy::unwrap_used,
        clippy::expect_used,
        clippy::panic,
        clippy::unreachable,
        clippy::todo
    )
)]

pub mod c;
pub mod edge;
pub mod fmi;
