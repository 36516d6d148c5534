//! The finite-element kernel: a mesh becomes stiffness and mass.
