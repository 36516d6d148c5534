//! Writers of reduced bodies for other codes: OP4 and bulk data of Nastran, text of Abaqus, arrays of NumPy, data of
//! MBDyn's modal joint.
//!
//! Each writer makes the text or the bytes of one file. The readers in `read/matrix` read the first three back.

mod abaqus;
mod cards;
mod mbdyn;
pub(crate) mod number;
pub(crate) mod numpy;
mod op4;

use crate::small_motion::SmallMotion;

pub use abaqus::{abaqus_deck, abaqus_matrix};
pub use cards::bulk_data;
pub use mbdyn::modal_data;
pub use numpy::array;
pub use op4::op4;

/// A reduced body for a deck, whose points have numbers.
#[derive(Clone, Copy, Debug)]
pub struct NumberedBody<'a> {
    /// Its name: for comments and for the names of files.
    pub name: &'a str,
    /// Names and places (m) of its markers.
    pub markers: &'a [(String, [f64; 3])],
    /// Its equations.
    pub motion: &'a SmallMotion,
    /// Number of the first point. The points of the markers come first, then those that carry the coordinates.
    pub first: usize,
}
