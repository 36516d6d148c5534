//! Mode shapes in the form of their files.

use super::{CUT, whole};
use crate::error::FileProblem;

/// The frame of written shapes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ShapeFrame {
    /// Each node's analysis frame.
    Analysis,
    /// The basic frame.
    Basic,
}

/// Digits of double precision, which need no warning.
pub(in crate::read) const DOUBLE_DIGITS: u32 = 15;

/// A mode.
#[derive(Clone, Debug, PartialEq)]
pub struct ForeignMode {
    /// The file's number.
    pub number: u64,
    /// Square of the angular frequency, in the file's unit of time; `None` if the file does not state it.
    pub eigenvalue: Option<f64>,
    /// For each node its three translations and three rotations, in the file's units and scaling.
    pub shape: Vec<[f64; 6]>,
}

/// The modes of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct ForeignModes {
    /// The file they are from.
    pub file: String,
    /// Numbers of the nodes in the order of the shapes.
    pub nodes: Vec<u64>,
    /// Modes in the order of the file.
    pub modes: Vec<ForeignMode>,
    /// The frame of the shapes.
    pub frame: ShapeFrame,
    /// Significant decimal digits of the shapes.
    pub digits: u32,
    /// Warnings for the user of the shapes: few digits, skipped parts.
    pub warnings: Vec<String>,
}

impl ForeignModes {
    /// None yet.
    pub(in crate::read) fn new(file: &str, frame: ShapeFrame, digits: u32) -> Self {
        ForeignModes {
            file: file.into(),
            nodes: Vec::new(),
            modes: Vec::new(),
            frame,
            digits,
            warnings: Vec::new(),
        }
    }

    /// Adds a mode with the node of each row; all modes must be on the same nodes.
    pub(in crate::read) fn push(
        &mut self,
        number: u64,
        eigenvalue: Option<f64>,
        rows: Vec<(u64, [f64; 6])>,
    ) -> Result<(), FileProblem> {
        let nodes = rows.iter().map(|(node, _)| *node);
        if self.modes.is_empty() {
            self.nodes = nodes.collect();
        } else if !nodes.eq(self.nodes.iter().copied()) {
            return Err(whole(
                &self.file,
                format!(
                    "mode {number} is stated at {} nodes, which are not the {} nodes of the modes before",
                    rows.len(),
                    self.nodes.len()
                ),
                format!("request the shapes of all nodes in every mode, or {CUT}"),
            ));
        }
        self.modes.push(ForeignMode {
            number,
            eigenvalue,
            shape: rows.into_iter().map(|(_, shape)| shape).collect(),
        });
        Ok(())
    }

    /// The modes, if there are any, with a warning about few digits.
    pub(in crate::read) fn finish(mut self, advice: &str) -> Result<Self, FileProblem> {
        if self.nodes.is_empty() || self.modes.is_empty() {
            return Err(whole(&self.file, "contains no mode shape", advice));
        }
        let mut sorted = self.nodes.clone();
        sorted.sort_unstable();
        let twice = sorted.windows(2).find(|pair| pair.first() == pair.last());
        if let Some([node, ..]) = twice {
            return Err(whole(
                &self.file,
                format!("lists node {node} twice in a mode"),
                "write the file again in one part; it is damaged, or it was written in parts",
            ));
        }
        let (file, digits) = (&self.file, self.digits);
        if digits < DOUBLE_DIGITS {
            let warning = format!(
                "{file}: shapes have {digits} digits, so invariants and orthogonality of modes have no more digits"
            );
            self.warnings.insert(0, warning);
        }
        Ok(self)
    }
}
