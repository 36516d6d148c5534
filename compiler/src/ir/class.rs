//! From what a class's author wrote to the functions that the runtime calls.

use super::graph::{Function, Graph, Node};
use eng_system::layout::InputLayout;

/// What lowering makes of the text of a class: values over the inputs of its [`InputLayout`].
#[derive(Clone, Debug, Default)]
pub struct ClassBody {
    /// The class's name.
    pub name: String,
    /// Where inputs stand.
    pub layout: InputLayout,
    /// The graph of everything below.
    pub graph: Graph,
    /// Φ, one a constraint row.
    pub rows: Vec<Node>,
    /// Applied loads on each marker: force (inertial axes), torque (MARKER axes). As many as markers.
    pub loads: Vec<[Node; 6]>,
    /// ẏ, one a state.
    pub rates: Vec<Node>,
    /// Outputs; the only values that may use accelerations, state rates, signals and multipliers.
    pub outputs: Vec<Node>,
    /// Must be positive.
    pub conditions: Vec<Node>,
    /// Unwrapped angles.
    pub rotations: Vec<Node>,
}

/// The functions of a class, described at [`eng_system::code`].
#[derive(Clone, Debug)]
#[allow(missing_docs)]
pub struct ClassFunctions {
    pub layout: InputLayout,
    pub residual: Function,
    pub linearize: Function,
    pub tangent: Function,
    pub velocity: Function,
    pub outputs: Function,
    pub conditions: Function,
    pub rotations: Function,
    /// Whether the loads or rates depend on twists.
    pub uses_twist: bool,
    /// Whether any load is not zero.
    pub applies_load: bool,
}
