//! The kind of joint that the equations of a class make: a weld, a hinge, a guide, or another one.

use eng_system::dimension::Dimension;
use eng_system::system::ElementClass;

/// The relative motion that a class of elements allows its two bodies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Joint {
    /// None: six equations.
    Weld,
    /// A turn about one axis: three equations are lengths, two are angles.
    Hinge,
    /// A slide along one axis: two equations are lengths, three are angles.
    Guide,
    /// Another motion with more freedoms, or no joint.
    Other,
}

impl Joint {
    /// Finds the kind from the number of equations and the number of lengths among them. The name of the
    /// class does not matter, so classes of a user count too.
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
