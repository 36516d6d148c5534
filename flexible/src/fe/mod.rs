//! The finite-element kernel: a mesh becomes stiffness and mass.
//!
//! ```text
//! Mesh (SI) ──check──▶ freedoms ─assemble─▶ Assembled { stiffness, mass } ─ties─▶ Reduction (full = T · free)
//! ```
//!
//! All quantities are in SI and in the basic frame. Supports, ties and springs are turned from their analysis
//! frames when they are read.

pub mod assemble;
mod averaging;
pub mod beam;
mod bubbles;
pub(crate) mod check;
mod connection;
mod elastic;
pub mod foreign;
pub mod form;
pub mod freedoms;
pub mod geometric;
mod hexahedron;
pub mod mass;
mod pattern;
pub mod quality;
pub mod reduction;
pub(crate) mod residual;
pub mod rules;
mod sheet;
mod shell;
pub mod solid;
pub mod stress;
pub(crate) mod surface;
pub mod ties;
pub(crate) mod vector;
pub mod volume;

pub use assemble::{Assembled, assemble, assemble_on};
pub use foreign::{ForeignStructure, NodalMatrix, from_matrices};
pub use form::Form;
pub use freedoms::FreedomMap;
pub use mass::{Mass, RigidMass};
pub use quality::{Inventory, Worst};
pub use reduction::Reduction;
pub use rules::{MassRule, Rules, StiffnessRule};
pub use ties::Constraints;
