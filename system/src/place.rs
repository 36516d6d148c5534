//! The origin of bodies, elements, parameters and channels: their paths, and places in the texts.

/// A range of bytes in a source of the compiler's source map.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Location {
    /// Index of the source.
    pub source: u32,
    /// First byte.
    pub start: u32,
    /// One past the last byte.
    pub end: u32,
}

/// The path and the places of a body, element, parameter or channel.
#[derive(Clone, Debug, PartialEq, Eq, Default)]
pub struct Origin {
    /// `cylinder[2].rod`.
    pub path: String,
    /// The user's line.
    pub used_at: Option<Location>,
    /// The line of the class that defines it, if there is one.
    pub defined_at: Option<Location>,
}

/// A part that the user's text makes of a component of the library.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Part {
    /// `engine`, `cylinder[2]`.
    pub path: String,
    /// The line of the user's text.
    pub made_at: Location,
}
