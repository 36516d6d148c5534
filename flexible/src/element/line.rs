//! Lines: beams, whose functions are those of [`crate::fe::beam`].

use super::{Description, ElementKind, Names, no_points};

/// The beam of two nodes.
pub(super) const BEAM2: Description = Description {
    nodes: 2,
    corners: 2,
    dimension: 1,
    linear: ElementKind::Beam2,
    edges: &[[0, 1]],
    faces: &[],
    simplices: &[&[0, 1]],
    corner_edges: (&[], 1.0),
    centre: [0.0; 3],
    shape: |_, _| {},
    stiffness: no_points,
    reduced: no_points,
    mass: no_points,
    mass_of_abaqus: no_points,
    // cards of beams and rods have fields of their own
    names: Names::NONE,
};
