//! `assemble`: the start alone.

use super::{AnalysisKind, Kind, KindRow, Rows};

/// Positions and velocities that satisfy every constraint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Assemble;

pub(super) const ROW: KindRow = KindRow {
    name: "assemble",
    about: "the position of all bodies by the text and the joints",
    also_called: &[],
    needs_cycle: None,
    arguments: &[],
    apart: &[],
    plan: |_| Ok(AnalysisKind::Assemble(Assemble)),
};

impl Kind for Assemble {
    fn rows(&self) -> Rows {
        Rows::State
    }
}
