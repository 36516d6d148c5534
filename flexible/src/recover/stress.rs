//! Stresses by modes: those of each shape are computed once, those of a moment are their sum with its
//! amplitudes.

use super::{Recovery, check_length, wrong};
use crate::error::FlexibleError;
use crate::fe::stress::{Components, nodal_stresses, surface_stresses, von_mises};

/// Stresses of every mode at some nodes.
#[derive(Clone, Debug, PartialEq)]
pub struct ModalStress {
    nodes: Vec<u32>,
    modes: usize,
    /// End of each node's places among all places. A node of solids has one, a node of shells one on each of
    /// their surfaces.
    ends: Vec<usize>,
    /// Six components (Pa per unit of amplitude; xx, yy, zz, xy, yz, zx in body axes) by place and mode.
    values: Vec<f64>,
}

impl Recovery<'_> {
    /// Stresses of the modes at nodes, by index. Nodes of no solid and no shell have none and are left out.
    ///
    /// # Errors
    /// An index that the mesh does not have; a mesh that is not sound.
    pub fn stress_at_nodes(&self, nodes: &[u32]) -> Result<ModalStress, FlexibleError> {
        let mut wanted = vec![false; self.mesh.nodes.len()];
        for node in nodes {
            match wanted.get_mut(*node as usize) {
                Some(wanted) => *wanted = true,
                None => return Err(wrong(format!("the mesh has no node of index {node}"))),
            }
        }
        let (found, all) =
            nodal_stresses(self.mesh, self.freedoms, &self.rules, self.shapes, &wanted)?;
        let width = 6 * self.modes();
        let mut stress = ModalStress {
            nodes: Vec::new(),
            modes: self.modes(),
            ends: Vec::new(),
            values: Vec::new(),
        };
        let shells = surface_stresses(self.mesh, self.freedoms, &self.rules, self.shapes, &wanted)?;
        let mut places = 0;
        for &node in nodes {
            let at = node as usize;
            let before = places;
            if found.get(at) == Some(&true) {
                let own = all.get(at * width..(at + 1) * width);
                stress.values.extend_from_slice(own.unwrap_or(&[]));
                places += 1;
            }
            for surface in shells.get(&node).into_iter().flatten() {
                stress.values.extend_from_slice(surface);
                places += 1;
            }
            if places > before {
                stress.nodes.push(node);
                stress.ends.push(places);
            }
        }
        Ok(stress)
    }
}

impl ModalStress {
    /// The nodes, by index.
    pub fn nodes(&self) -> &[u32] {
        &self.nodes
    }

    /// σ = Σ a_k σ_k at each node (Pa; xx, yy, zz, xy, yz, zx in body axes), written over the contents of `out`. Of
    /// several surfaces of shells at a node it is the one with the largest von Mises stress.
    ///
    /// # Errors
    /// Another number of amplitudes than modes.
    pub fn stress(&self, a: &[f64], out: &mut Vec<Components>) -> Result<(), FlexibleError> {
        check_length(self.modes, a)?;
        out.clear();
        if self.modes == 0 {
            out.resize(self.nodes.len(), [0.0; 6]);
            return Ok(());
        }
        let mut places = self.values.chunks_exact(6 * self.modes);
        let mut before = 0;
        for end in &self.ends {
            let own = places.by_ref().take(end - before).map(|own| {
                let mut sum = [0.0; 6];
                for (mode, a) in own.chunks_exact(6).zip(a) {
                    for (x, y) in sum.iter_mut().zip(mode) {
                        *x += a * y;
                    }
                }
                sum
            });
            let worse = |first: Components, second: Components| match von_mises(&second)
                > von_mises(&first)
            {
                true => second,
                false => first,
            };
            out.push(own.reduce(worse).unwrap_or([0.0; 6]));
            before = *end;
        }
        Ok(())
    }
}

/// Largest von Mises stress over time at each place.
#[derive(Clone, Debug, PartialEq)]
pub struct Envelope {
    von_mises: Vec<f64>,
    time: Vec<f64>,
}

impl Envelope {
    /// The largest stress of each place (Pa; zero before the first moment), and when it was first reached (s).
    pub fn peaks(&self) -> impl Iterator<Item = (f64, f64)> {
        self.von_mises
            .iter()
            .copied()
            .zip(self.time.iter().copied())
    }

    /// The peaks of a number of places, before the first moment.
    pub fn new(places: usize) -> Envelope {
        Envelope {
            von_mises: vec![0.0; places],
            time: vec![f64::NAN; places],
        }
    }

    /// Takes in the stresses of a moment (s).
    ///
    /// # Errors
    /// Another number of stresses than places.
    pub fn update(&mut self, time: f64, stresses: &[Components]) -> Result<(), FlexibleError> {
        if stresses.len() != self.von_mises.len() {
            return Err(wrong(format!(
                "{} stresses for {} places",
                stresses.len(),
                self.von_mises.len()
            )));
        }
        for ((most, when), stress) in self.von_mises.iter_mut().zip(&mut self.time).zip(stresses) {
            let value = von_mises(stress);
            if value > *most || when.is_nan() {
                (*most, *when) = (value, time);
            }
        }
        Ok(())
    }
}

/// Principal stresses (Pa), the largest first, with their unit directions, by Jacobi's rotations (H.
/// Rutishauser, Numer. Math. 9, 1966), which keep all digits of equal ones.
pub fn principal(stress: &Components) -> [(f64, [f64; 3]); 3] {
    let [x, y, z, xy, yz, zx] = *stress;
    let mut s = [[x, xy, zx], [xy, y, yz], [zx, yz, z]];
    let mut axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    // quadratic convergence: six sweeps are more than enough for three rows
    for _ in 0..12 {
        for (p, q, r) in [(0, 1, 2), (1, 2, 0), (0, 2, 1)] {
            let off = s[p][q];
            if off == 0.0 {
                continue;
            }
            let theta = (s[q][q] - s[p][p]) / (2.0 * off);
            let t = if theta.is_finite() {
                theta.signum() / (theta.abs() + libm::sqrt(theta * theta + 1.0))
            } else {
                0.0
            };
            let c = 1.0 / libm::sqrt(t * t + 1.0);
            let sine = t * c;
            s[p][p] -= t * off;
            s[q][q] += t * off;
            (s[p][q], s[q][p]) = (0.0, 0.0);
            let (first, second) = (s[r][p], s[r][q]);
            s[r][p] = c * first - sine * second;
            s[r][q] = sine * first + c * second;
            (s[p][r], s[q][r]) = (s[r][p], s[r][q]);
            for axis in &mut axes {
                let (first, second) = (axis[p], axis[q]);
                axis[p] = c * first - sine * second;
                axis[q] = sine * first + c * second;
            }
        }
    }
    let direction = |k: usize| [axes[0][k], axes[1][k], axes[2][k]];
    let mut found = [0, 1, 2].map(|k: usize| (s[k][k], direction(k)));
    found.sort_by(|a, b| b.0.total_cmp(&a.0));
    found
}
