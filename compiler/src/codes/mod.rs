//! The registry of message codes: resolving (`02`), checking types and units (`03`), classes and their uses
//! (`04`), elaborating (`05`), reports (`08`).
//!
//! Some lints have a number of another stage. They are in the file of the stage that finds them: `W0550`,
//! `W0551` and `W0553` in checking, `W0760` in elaborating.
//!
//! A code has one meaning and never changes it. A test checks that a fixture raises each code.

mod checking;
mod classes;
mod elaborating;
mod reporting;
mod resolving;

pub use checking::*;
pub use classes::*;
pub use elaborating::*;
pub use eng_grammar::Code;
pub use reporting::*;
pub use resolving::*;

/// All codes of this crate, by group.
pub const GROUPS: [&[Code]; 5] = [RESOLVING, CHECKING, CLASSES, ELABORATING, REPORTING];

/// All codes of this crate, in order.
pub fn all() -> impl Iterator<Item = &'static Code> {
    GROUPS.into_iter().flatten()
}
