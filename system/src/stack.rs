//! A body of plane sections stacked along an axis: the compiler writes it, and the crate `flexible` makes a mesh of it.
//!
//! Numbers are SI; all are known while compiling.

/// Sections stacked along an axis, each as a prism.
///
/// The plane of the sections has the coordinates (x, y) if they are stacked along z, (y, z) along x, and (z,
/// x) along y.
#[derive(Clone, Debug, PartialEq)]
pub struct Stack {
    /// The axis along which the sections are stacked: 0, 1, 2 for x, y, z.
    pub axis: u8,
    /// Coordinate along the axis of the first section's first face (m).
    pub begin: f64,
    /// Largest length of the elements' edges (m).
    pub size: f64,
    /// The sections, in the direction of the axis. Each begins where the one before ends.
    pub sections: Vec<Section>,
}

/// A prism: a closed outline and its length along the axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Section {
    /// Corners of the outline in either sense. The last is joined with the first.
    pub corners: Vec<Corner>,
    /// Length along the axis (m).
    pub length: f64,
}

/// A corner of an outline and the line to the next corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Corner {
    /// Position in the plane of the sections (m).
    pub place: [f64; 2],
    /// Angle by which the line to the next corner turns (rad): zero for a straight line, positive for a circular arc
    /// that turns from the plane's first axis to its second, and negative for one in the other sense. It is between
    /// −2π and 2π.
    pub bend: f64,
}
