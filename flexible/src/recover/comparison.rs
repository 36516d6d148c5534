//! The modes of a body beside those of another code.
//!
//! ```text
//! MAC = (φᵀ ψ)² / (φᵀφ · ψᵀψ)      over the translations of the nodes that both have
//! ```
//!
//! The modal assurance MAC is 1 for equal shapes and 0 for orthogonal ones. It depends neither on the scale of a shape nor on
//! its units.

use super::Recovery;
use crate::axes::rotate;
use crate::error::FlexibleError;
use crate::read::matrix::{ForeignMode, ForeignModes, ShapeFrame};

/// A mode of another code, and the mode of the body that is nearest to it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NearestMode {
    /// Number of the mode in its file.
    pub number: u64,
    /// Square of its angular frequency, in the file's unit of time; `None` if the file does not state it.
    pub eigenvalue: Option<f64>,
    /// Index of the mode of the body with the largest modal assurance.
    pub nearest: usize,
    /// Their modal assurance, from 0 to 1.
    pub assurance: f64,
}

/// All modes of a file beside those of a body.
#[derive(Clone, Debug, PartialEq)]
pub struct ModeComparison {
    /// Number of nodes of the file that the mesh has.
    pub common: usize,
    /// Number of nodes of the file.
    pub nodes: usize,
    /// The modes in the order of the file.
    pub modes: Vec<NearestMode>,
}

impl Recovery<'_> {
    /// Compares the modes of a file with those of this body. Nodes belong together by their numbers.
    ///
    /// # Errors
    /// A file without a node of the mesh, a body without modes, a shape with values missing.
    pub fn compare(&self, given: &ForeignModes) -> Result<ModeComparison, FlexibleError> {
        let index = self.mesh.node_index();
        let rows = given.nodes.iter().enumerate();
        let rows: Vec<(usize, u32)> = rows
            .filter_map(|(row, id)| Some((row, *index.get(id)?)))
            .collect();
        if rows.is_empty() {
            return Err(FlexibleError::structure(
                format!("{}: no node of its shapes is in the mesh", given.file),
                "give the shapes of a run with the same numbers of nodes",
            ));
        }
        let own: Vec<Shape> = (0..self.modes())
            .map(|mode| Shape::new(self.translations(mode, &rows)))
            .collect();
        let mut modes = Vec::with_capacity(given.modes.len());
        for mode in &given.modes {
            let shape = Shape::new(self.foreign_translations(given, mode, &rows)?);
            let assurances = own.iter().map(|own| own.assurance(&shape)).enumerate();
            let nearest = assurances.reduce(|best, next| if next.1 > best.1 { next } else { best });
            let Some((nearest, assurance)) = nearest else {
                return Err(FlexibleError::structure(
                    "the body has no modes to compare with".into(),
                    "state `modes = normal(…)`",
                ));
            };
            modes.push(NearestMode {
                number: mode.number,
                eigenvalue: mode.eigenvalue,
                nearest,
                assurance,
            });
        }
        Ok(ModeComparison {
            common: rows.len(),
            nodes: given.nodes.len(),
            modes,
        })
    }

    /// The translations of a mode of the body at nodes of the file.
    fn translations(&self, mode: usize, rows: &[(usize, u32)]) -> Vec<f64> {
        let start = mode * self.freedoms.size();
        let mut found = Vec::with_capacity(3 * rows.len());
        for (_, node) in rows {
            for component in 0..3 {
                let freedom = self.freedoms.freedom(*node, component);
                let value = freedom.and_then(|freedom| self.shapes.get(start + freedom));
                found.push(value.copied().unwrap_or(0.0));
            }
        }
        found
    }

    /// The same of a mode of the file, along the axes of the mesh.
    fn foreign_translations(
        &self,
        given: &ForeignModes,
        mode: &ForeignMode,
        rows: &[(usize, u32)],
    ) -> Result<Vec<f64>, FlexibleError> {
        let mut found = Vec::with_capacity(3 * rows.len());
        for (row, node) in rows {
            let values = mode.shape.get(*row);
            let Some([x, y, z, ..]) = values.filter(|values| values.iter().all(|x| x.is_finite()))
            else {
                return Err(FlexibleError::structure(
                    format!(
                        "{}: mode {} has values missing or not finite",
                        given.file, mode.number
                    ),
                    "write or copy the file again; it is damaged",
                ));
            };
            let frame = self
                .mesh
                .nodes
                .get(*node as usize)
                .and_then(|node| node.frame);
            let frame = frame.and_then(|frame| self.mesh.frames.get(frame as usize));
            let vector = [*x, *y, *z];
            found.extend(
                match frame.filter(|_| given.frame == ShapeFrame::Analysis) {
                    Some(frame) => rotate(&frame.rotation, vector),
                    None => vector,
                },
            );
        }
        Ok(found)
    }
}

/// A shape with the square of its length.
struct Shape {
    values: Vec<f64>,
    square: f64,
}

impl Shape {
    fn new(values: Vec<f64>) -> Self {
        let square = values.iter().map(|x| x * x).sum();
        Shape { values, square }
    }

    /// Zero for a shape without motion.
    fn assurance(&self, other: &Shape) -> f64 {
        let pairs = self.values.iter().zip(&other.values);
        let product: f64 = pairs.map(|(a, b)| a * b).sum();
        let scale = self.square * other.square;
        match scale > 0.0 {
            true => product * product / scale,
            false => 0.0,
        }
    }
}
