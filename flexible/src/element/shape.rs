//! Shape functions and their derivatives in the reference domains of [`super::quadrature`].
//!
//! Nodes are in the order of [`ElementKind`]. Shape functions sum to one, each is one at its node and zero at
//! the others, and they hold all linear functions exactly.

use super::ElementKind;

/// The most nodes an element has.
pub const MOST_NODES: usize = 20;

/// Shape functions at a point: one entry for each node of the element, then zeros.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shape {
    /// Values (–).
    pub values: [f64; MOST_NODES],
    /// Derivatives in the reference coordinates (–); for a pyramid in ξ, η, ζ, not in the collapsed ones.
    pub slopes: [[f64; 3]; MOST_NODES],
}

impl Shape {
    fn zero() -> Self {
        Shape {
            values: [0.0; MOST_NODES],
            slopes: [[0.0; 3]; MOST_NODES],
        }
    }

    /// The functions of an element of this kind at a point of its reference domain (a pyramid's in collapsed
    /// coordinates). A beam has none here: the result is zero.
    pub fn at(kind: ElementKind, point: [f64; 3]) -> Self {
        let mut shape = Shape::zero();
        (kind.description().shape)(&mut shape, point);
        shape
    }

    /// Removes a mid-side node: the edge becomes straight and linear, because each of its corners gets half
    /// of the removed function. The other functions still sum to one and represent linear functions, because
    /// the place of the removed node is then the mean of its corners.
    pub fn remove_midside(&mut self, kind: ElementKind, local: usize) {
        let Some(edge) = local
            .checked_sub(kind.corner_count())
            .and_then(|k| kind.midside_edges().get(k))
        else {
            return;
        };
        let (value, slope) = (self.values[local], self.slopes[local]);
        for &corner in edge {
            self.values[corner] += 0.5 * value;
            for (sum, s) in self.slopes[corner].iter_mut().zip(slope) {
                *sum += 0.5 * s;
            }
        }
        self.values[local] = 0.0;
        self.slopes[local] = [0.0; 3];
    }
}
