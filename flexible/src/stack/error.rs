//! Errors of stacked sections.

use crate::error::{mm, place};
use thiserror::Error;

/// A stack that makes no mesh. Sections count from 1; places are coordinates in the plane of the sections, in mm.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum StackError {
    /// There is no section.
    #[error("the stack has no section")]
    Empty,
    /// A number that no body has.
    #[error("{what} must be {due}, and is {value}")]
    Number {
        /// The quantity.
        what: String,
        /// The permitted values.
        due: &'static str,
        /// Its value with a unit.
        value: String,
        /// The section, if it belongs to one.
        section: Option<usize>,
    },
    /// Two corners that follow each other lie in one place.
    #[error("section {section}: corners {first} and {second} lie in one place, {}", place(.at))]
    SamePlace {
        /// The section.
        section: usize,
        /// A corner, from 1.
        first: usize,
        /// The next corner, from 1.
        second: usize,
        /// Their place (m).
        at: [f64; 2],
    },
    /// Lines of one outline meet elsewhere than in the corner between them.
    #[error("section {section}: the line after corner {first} meets the line after corner {second} at {}", place(.at))]
    Crossing {
        /// The section.
        section: usize,
        /// Number of the first line, from 1.
        first: usize,
        /// Number of the other line, from 1.
        second: usize,
        /// A common point (m).
        at: [f64; 2],
    },
    /// An outline with no area.
    #[error("section {section} has no area")]
    NoArea {
        /// The section.
        section: usize,
    },
    /// Neighbours have no common area.
    #[error("sections {first} and {} have no common area: the body falls apart there", .first + 1)]
    Apart {
        /// The lower of the two sections.
        first: usize,
    },
    /// Elements as large as a section is wide.
    #[error("the size {} mm is larger than the width of section {section}, which is about {} mm", mm(*.size), mm(*.width))]
    Coarse {
        /// The section.
        section: usize,
        /// The stated size (m).
        size: f64,
        /// Four times its area by its circumference (m).
        width: f64,
    },
    /// Straight edges in the place of arcs change a section too much.
    #[error("the straight edges of its mesh change section {section} too much: they enclose {:.2} % of the area of its outline", 100.0 * .share)]
    Faceted {
        /// The section.
        section: usize,
        /// Area of its elements by that of its outline.
        share: f64,
    },
    /// Outlines run too close to each other.
    #[error("outlines run within {} mm of each other near {} and make elements too thin", mm(*.gap), place(.at))]
    Close {
        /// A place (m).
        at: [f64; 2],
        /// The distance (m).
        gap: f64,
        /// A section that has an element there.
        section: usize,
    },
    /// Too many nodes.
    #[error("the mesh would have about {nodes:.0} nodes; {} is the limit", most)]
    Large {
        /// Estimated number.
        nodes: f64,
        /// The limit.
        most: usize,
    },
    /// Too many different corners.
    #[error("the outlines have {corners} different lines; {most} is the limit")]
    Corners {
        /// Number of lines.
        corners: usize,
        /// The limit.
        most: usize,
    },
    /// The triangulation failed. Only outlines that nearly coincide can cause this.
    #[error("the outlines cannot be triangulated near {}: {why}", place(.at))]
    Plane {
        /// A place (m).
        at: [f64; 2],
        /// The reason.
        why: String,
    },
}

impl StackError {
    /// The section that causes it, from 1.
    pub fn section(&self) -> Option<usize> {
        match self {
            StackError::Number { section, .. } => *section,
            StackError::SamePlace { section, .. }
            | StackError::Crossing { section, .. }
            | StackError::NoArea { section }
            | StackError::Coarse { section, .. }
            | StackError::Faceted { section, .. }
            | StackError::Close { section, .. } => Some(*section),
            StackError::Apart { first } => Some(first + 1),
            StackError::Empty
            | StackError::Large { .. }
            | StackError::Corners { .. }
            | StackError::Plane { .. } => None,
        }
    }

    /// The remedy.
    pub fn advice(&self) -> &'static str {
        match self {
            StackError::Empty => "give at least one section",
            StackError::Number { .. } => "check the number and its unit",
            StackError::SamePlace { .. } => {
                "remove one of them; the outline closes from the last corner to the first by itself"
            }
            StackError::Crossing { .. } => {
                "the corners must follow the outline once around; check their order and the signs of the bends"
            }
            StackError::NoArea { .. } => "an outline needs three corners, or two with a bend",
            StackError::Apart { .. } => {
                "let the outlines of neighbours overlap, or put a section between them that overlaps both"
            }
            StackError::Coarse { .. } | StackError::Faceted { .. } => "take a smaller `size`",
            StackError::Close { .. } | StackError::Plane { .. } => {
                "let the outlines coincide there, or move them apart"
            }
            StackError::Large { .. } => "take a larger `size`",
            StackError::Corners { .. } => "take fewer corners, and arcs for curves",
        }
    }
}
