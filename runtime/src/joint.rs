//! The joint that the equations of a class make: a weld, a hinge, a guide, or another one.

use eng_system::dimension::Dimension;
use eng_system::system::ElementClass;

/// How a class of elements lets its two bodies move against each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Joint {
    /// Not at all: six equations.
    Weld,
    /// About one axis: three equations are lengths, two are angles.
    Hinge,
    /// Along one axis: two equations are lengths, three are angles.
    Guide,
    /// In another way: more freedoms, or none of a joint.
    Other,
}

impl Joint {
    /// By the number of equations and how many of them are lengths, whatever the class is called.
    pub fn of(class: &ElementClass) -> Joint {
        let lengths = class
            .rows
            .iter()
            .filter(|row| row.dimension == Dimension::LENGTH);
        match (lengths.count(), class.rows.len()) {
            (_, 6) => Joint::Weld,
            (3, 5) => Joint::Hinge,
            (2, 5) => Joint::Guide,
            _ => Joint::Other,
        }
    }
}
