//! Flexible bodies: finite-element files become a mesh, a mesh becomes matrices, and matrices become a few
//! modes with constant invariants. A time step needs only these invariants; it never uses a node.
//!
//! ```text
//! files ──read──▶ Mesh ──fe──▶ stiffness, mass ──solve──▶ static and normal modes ──modes──▶ invariants
//! ```
//!
//! Invariants of this crate:
//! - The crate uses no syntax trees, no elements of a multibody model and no terminal. It reads files through
//!   [`Files`].
//! - A [`Mesh`] is in the units of its file until [`Mesh::convert`]; everything after `read` is SI.
//! - No part of a file with mass, stiffness or a constraint is dropped silently. It is read, refused, or
//!   listed in [`Mesh::unread`].
//! - The same input gives the same bits, whatever the number of threads.
#![forbid(unsafe_code)]
// Tests may call the standard library's functions, to compare with them.
#![cfg_attr(not(test), deny(clippy::disallowed_methods))]
// no input may end the library in a panic
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

mod axes;
mod elasticity;
pub mod element;
mod error;
pub mod fe;
pub mod foreign;
mod geometric;
pub mod invariants;
pub mod markers;
pub mod mesh;
pub mod modes;
pub mod read;
pub mod recover;
pub mod reduce;
pub mod rotary;
pub mod small_motion;
pub mod solve;
pub mod sparse;
pub mod stack;
pub mod store;
mod surface;
pub mod units;
pub mod write;

pub use error::{FileProblem, FlexibleError, Part, Place};
pub use mesh::Mesh;
pub use read::{Files, MeshFormat, read_mesh};
