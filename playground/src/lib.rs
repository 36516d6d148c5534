//! Eng for a page in a browser: it checks a text, runs its analyses, and gives messages, figures and tables as data.
//!
//! It translates calls and values, and has no rules of its own. The module `edge` has the functions that the page
//! calls; the others are safe code.
#![deny(clippy::undocumented_unsafe_blocks, unsafe_op_in_unsafe_fn)]
// Tests may call the standard library's functions, to compare with them.
#![cfg_attr(not(test), deny(clippy::disallowed_methods))]
// no input may end the program in a panic
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

pub mod check;
pub mod edge;
pub mod request;
pub mod run;
