//! The part of HDF5 in which MED files are written: groups, attributes, and datasets in one piece.
//!
//! A file is bytes in memory. Nothing is copied before a dataset becomes numbers, and its length is compared with the
//! bytes first. So a damaged file cannot ask for more memory than a small multiple of its size. Compressed and chunked
//! datasets, shared types and links to other files are refused by name: the library of MED writes none of them.
//!
//! Source: HDF5 File Format Specification Version 3.0 (The HDF Group).
//!
//! ```text
//! file (superblock) ─▶ objects (headers with messages) ─┬▶ links ──────┬▶ tree, heap (many of them)
//!                                                       ├▶ attributes ─┘
//!                                                       └▶ values (types and numbers)
//! ```

mod attributes;
mod bytes;
mod file;
mod heap;
mod links;
mod objects;
mod tree;
mod values;

pub(super) use file::{Hdf5, SIGNATURE};
pub(super) use objects::Object;
pub(super) use values::Values;

use thiserror::Error;

/// The reason why contents of a file can't be read.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub(super) enum Trouble {
    /// An address is outside of the file.
    #[error("the file ends before its contents")]
    Cut,
    /// Bytes contradict the format.
    #[error("the file is damaged: {0}")]
    Damaged(&'static str),
    /// A part of HDF5 that MED files don't use.
    #[error("{0}, which Eng does not read")]
    NotRead(&'static str),
}
