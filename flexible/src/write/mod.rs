//! Writers of matrices for other codes: OP4 and bulk data of Nastran, text of Abaqus, arrays of NumPy.
//!
//! Each writer makes the text or the bytes of one file. The readers in `read/matrix` read the first three back.

mod abaqus;
mod cards;
mod number;
mod numpy;
mod op4;

pub use abaqus::{AbaqusBody, abaqus_deck, abaqus_matrix};
pub use cards::{NastranBody, bulk_data};
pub use numpy::array;
pub use op4::op4;
