//! Lints that no class of the library states: their names, the acceptances of a text, and the numbers of a turn without
//! forces that lints use.

use crate::place::Location;

/// A number that has no place in an engine: an inertia that does not fit the size of its body.
pub const INERTIA: &str = "inertia";
/// A gravity that is neither 0 nor that of the earth.
pub const GRAVITY: &str = "gravity";
/// Modal damping above 20 % over all frequencies.
pub const DAMPING: &str = "damping";
/// A body that nothing holds in some direction.
pub const LOOSE: &str = "loose";
/// Markers of one element that are far apart.
pub const APART: &str = "apart";
/// Markers in each other's places: a shell turns and its pin does not, or a guide takes the load of its part.
pub const SWAPPED: &str = "swapped";
/// Axes of an angle or a film that are not parallel.
pub const ASKEW: &str = "askew";
/// A force between bodies that do not move against each other.
pub const IDLE: &str = "idle";
/// A fixed step that is long for the speed of the cycle.
pub const STEP: &str = "step";
/// Samples that are far apart for the speed of the cycle, or a run that ends before it has turned.
pub const SAMPLING: &str = "sampling";
/// A spring that is too soft for the weight it carries, or pushes along gravity.
pub const SAG: &str = "sag";
/// An angle of many turns.
pub const TURNS: &str = "turns";
/// A value with the name of a unit.
pub const UNIT_NAME: &str = "unit_name";

/// A table of another period than the cycle.
pub const PERIOD: &str = "period";
/// Gas that fires at no dead centre, or in all cylinders at once.
pub const FIRING: &str = "firing";
/// A bore that does not fit the stroke.
pub const BORE: &str = "bore";
/// A piston on the other side of its crank.
pub const MIRRORED: &str = "mirrored";

/// A cycle whose angle swings, or falls under a gas trace.
pub const CYCLE: &str = "cycle";

/// A marker of a static term of a flexible body that no element loads.
pub const UNLOADED: &str = "unloaded";

/// All of them.
pub const BUILT_IN: [&str; 19] = [
    INERTIA, GRAVITY, DAMPING, LOOSE, APART, SWAPPED, ASKEW, IDLE, STEP, SAMPLING, SAG, TURNS,
    UNIT_NAME, PERIOD, FIRING, BORE, MIRRORED, CYCLE, UNLOADED,
];

/// Lints about the whole model, its cycle or an analysis, which have no block for an acceptance.
pub const OF_MODEL: [&str; 4] = [GRAVITY, STEP, SAMPLING, CYCLE];

/// `accept usual` in the block of a use, of a body, of a component or of the model.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Accepted {
    /// The lint's name.
    pub name: String,
    /// Path of its element, body or part; empty for the whole model.
    pub path: String,
    /// Place of the name.
    pub at: Location,
    /// Whether a lint with this name appeared during compilation.
    pub used: bool,
}

impl Accepted {
    /// Whether it accepts a lint of a name about the object of a path.
    pub fn covers(&self, name: &str, path: &str) -> bool {
        !name.is_empty()
            && self.name == name
            && (self.path.is_empty()
                || path
                    .strip_prefix(self.path.as_str())
                    .is_some_and(|rest| rest.is_empty() || rest.starts_with(['.', '['])))
    }
}

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
