//! FMI for co-simulation, versions 2.0 and 3.0: one state machine and the functions of each version.
//!
//! All functions of the standards are there, because importers look all of them up. Those that an FMU does not offer
//! refuse their call with a message.

mod instance;
mod saved;
mod slave;
pub mod three;
pub mod two;

pub use instance::Instance;
pub use saved::Saved;
