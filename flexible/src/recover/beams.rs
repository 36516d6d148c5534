//! Section forces of beams by modes.

use super::{Recovery, check_length, wrong};
use crate::error::FlexibleError;
use crate::fe::assemble::of_beam;
use crate::fe::beam;
use crate::fe::check::check_element;
use crate::mesh::ElementKind;

/// Forces and moments at the ends of beams.
#[derive(Clone, Debug, PartialEq)]
pub struct BeamForces {
    /// Indices of the beams.
    pub elements: Vec<u32>,
    /// Their axes x (along the beam), y, z in body axes.
    pub axes: Vec<[[f64; 3]; 3]>,
    modes: usize,
    /// Twelve numbers by beam and mode.
    values: Vec<f64>,
}

impl Recovery<'_> {
    /// End forces of the modes at beams, by index. Elements that are no beams have none.
    ///
    /// # Errors
    /// An index that the mesh does not have; a mesh that is not sound.
    pub fn beam_forces(&self, elements: &[u32]) -> Result<BeamForces, FlexibleError> {
        let size = self.freedoms.size().max(1);
        let mut found = BeamForces {
            elements: Vec::new(),
            axes: Vec::new(),
            modes: self.modes(),
            values: Vec::new(),
        };
        for &index in elements {
            let Some(element) = self.mesh.elements.get(index as usize) else {
                return Err(wrong(format!("the mesh has no element of index {index}")));
            };
            if element.kind != ElementKind::Beam2 {
                continue;
            }
            check_element(self.mesh, element)?;
            let unit = of_beam(self.mesh, element, beam::end_forces)?;
            let own: Vec<usize> = self
                .mesh
                .nodes_of(element)
                .iter()
                .flat_map(|&node| self.freedoms.of(node))
                .collect();
            if own.len() != 12 {
                return Err(wrong(format!(
                    "the nodes of beam {} don't turn",
                    element.id
                )));
            }
            found.elements.push(index);
            found.axes.push(unit.axes);
            for shape in self.shapes.chunks_exact(size) {
                for line in &unit.forces {
                    let terms = own.iter().zip(line);
                    let force = terms.map(|(f, k)| k * shape.get(*f).copied().unwrap_or(0.0));
                    found.values.push(force.sum());
                }
            }
        }
        Ok(found)
    }
}

impl BeamForces {
    /// What the nodes put on the ends of each beam (N, N m): force and moment at the first, then at the second end, along the
    /// beam's axes, written over what `out` holds. The tension is the seventh number.
    ///
    /// # Errors
    /// Another number of amplitudes than modes.
    pub fn forces(&self, a: &[f64], out: &mut Vec<[f64; 12]>) -> Result<(), FlexibleError> {
        check_length(self.modes, a)?;
        out.clear();
        if self.modes == 0 {
            out.resize(self.elements.len(), [0.0; 12]);
            return Ok(());
        }
        for own in self.values.chunks_exact(12 * self.modes) {
            let mut sum = [0.0; 12];
            for (mode, a) in own.chunks_exact(12).zip(a) {
                for (x, y) in sum.iter_mut().zip(mode) {
                    *x += a * y;
                }
            }
            out.push(sum);
        }
        Ok(())
    }
}
