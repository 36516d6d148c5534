//! Reference frames of bodies, and factors on the derivatives by velocity and acceleration.

use crate::rotation::{M3, V3};

/// Position and orientation of a body's reference frame, and its shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyFrame<'a> {
    /// Origin (m, inertial).
    pub position: V3,
    /// Body → inertial.
    pub rotation: M3,
    /// Modal amplitudes.
    pub amplitudes: &'a [f64],
}

/// Factors on the derivatives by acceleration and by velocity in a matrix.
#[derive(Clone, Copy, Debug)]
pub struct Weights {
    /// dv̇/du (1/s²).
    pub acceleration: f64,
    /// dv/du (1/s).
    pub velocity: f64,
}
