//! The functions 1 − ξ², 1 − η², 1 − ζ² inside an 8-node hexahedron: incompatible modes whose amplitudes are
//! freedoms with mass, as in the C3D8I of CalculiX.
//!
//! The idea is that of condensed modes ([`super::hexahedron`]), but the numbers differ. The modes' gradients
//! are −2 ξ_m ∂ξ_m/∂x with the Jacobian at the middle of the element and without the factor j₀/j, so that ∫ G
//! dV vanishes in parallelepipeds only. In other shapes a constant strain is not exact. Their displacements
//! have mass, coupled to that of the corners. At the 2³ points of the stiffness, where CalculiX also
//! evaluates the mass, all three functions have the value 2/3, so that only the sum of the amplitudes along
//! each axis has inertia.
//!
//! Source: CalculiX 2.20 (`shape8hu.f`, `e_c3d.f`), and its frequencies.

use crate::element::Shape;

/// Puts the functions and their slopes in the reference coordinates (–) after those of `nodes` nodes.
pub(super) fn put(shape: &mut Shape, nodes: usize, at: [f64; 3]) {
    for (axis, x) in at.into_iter().enumerate() {
        shape.values[nodes + axis] = 1.0 - x * x;
        shape.slopes[nodes + axis][axis] = -2.0 * x;
    }
}
