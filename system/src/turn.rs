//! Numbers of a turn of the machine without forces, which lints use: `largest(x)`, `smallest(x)`, `where_largest(x)`.

/// The number that is taken of a quantity over the turn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extreme {
    /// Its largest value.
    Largest,
    /// Its smallest value.
    Smallest,
    /// The angle of the cycle (rad) at which it is largest.
    WhereLargest,
}

impl Extreme {
    /// The name of each in a text.
    pub const NAMED: [(&'static str, Extreme); 3] = [
        ("largest", Extreme::Largest),
        ("smallest", Extreme::Smallest),
        ("where_largest", Extreme::WhereLargest),
    ];
}

/// A quantity that a lint follows through the turn. Its number is an input of the bind graph.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Followed {
    /// Index of the element that computes it.
    pub element: u32,
    /// Index into the outputs of the element's class.
    pub output: u32,
    /// The number that is taken.
    pub extreme: Extreme,
}
