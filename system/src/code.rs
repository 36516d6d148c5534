//! The functions of an element class, as the runtime calls them.
//!
//! Every number is a pair: lane 0 and lane 1 are two instances of the class (an odd tail repeats the last).
//! With K markers, m rows, s states (see [`InputLayout`](crate::layout::InputLayout)):
//!
//! | function | inputs | outputs |
//! | --- | --- | --- |
//! | `Residual` | common | Φ (m); wrench on each marker (6K): force in inertial axes, torque in MARKER axes, applied loads minus Gᵀλ; ẏ (s) |
//! | `Linearize` | common | tape |
//! | `Tangent` | tape, then one seed a direction | directional derivative of `Residual`'s outputs at fixed λ |
//! | `Velocity` | common | Φ̇ (m) at the given twists, Φ_t included; then γ (m): Φ̈ at zero accelerations with the sign turned, so that G v̇ = γ |
//! | `Outputs` | common, accelerations, rates, signals | outputs |
//! | `Conditions` | common | one number a condition, to be positive |
//! | `Rotations` | common | unwrapped angle of each rotation (rad) |
//!
//! G is the derivative of Φ along the pose directions: δx inertial, and δπ in the marker's axes with
//! δR = R δπ~. The twist (ẋ, ω in marker axes) is the rate of these. `∂W/∂λ = −Gᵀ`.

use crate::system::Slot;
use crate::table::{Outside, Table};

/// Which function of a class.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[allow(missing_docs)]
pub enum Function {
    Residual,
    Linearize,
    Tangent,
    Velocity,
    Outputs,
    Conditions,
    Rotations,
}

impl Function {
    /// All functions.
    pub const ALL: [Function; 7] = [
        Function::Residual,
        Function::Linearize,
        Function::Tangent,
        Function::Velocity,
        Function::Outputs,
        Function::Conditions,
        Function::Rotations,
    ];
}

/// Two instances of one number.
pub type Pair = [f64; 2];

/// The callable code of one element class, generated or interpreted.
pub trait ElementCode: Send + Sync + std::fmt::Debug {
    /// How many inputs and outputs a function has.
    fn shape(&self, function: Function) -> (usize, usize);

    /// Evaluates. `inputs` and `outputs` have at least the lengths of [`ElementCode::shape`], else nothing is
    /// written and `false` returned.
    fn call(
        &self,
        function: Function,
        inputs: &[Pair],
        outputs: &mut [Pair],
        tables: &[Table],
    ) -> bool;

    /// The first table that a function reads outside its points with these inputs, for each of the two instances.
    fn outside(
        &self,
        _function: Function,
        _inputs: &[Pair],
        _tables: &[Table],
    ) -> [Option<Outside>; 2] {
        [None, None]
    }

    /// Bytes of machine code of a function, its constants included; 0 where interpreted.
    fn function_bytes(&self, function: Function) -> usize;

    /// Bytes of machine code of all functions.
    fn code_bytes(&self) -> usize {
        Function::ALL.iter().map(|f| self.function_bytes(*f)).sum()
    }
}

/// The graph of expressions of parameters alone.
pub trait BindCode: Send + Sync + std::fmt::Debug {
    /// Fills the slots. `overrides` has one entry a parameter: a stated value (SI), or `None` for its default, which may
    /// depend on other parameters. Also returns the value of every parameter.
    fn bind(&self, overrides: &[Option<f64>], tables: &[Table]) -> Result<Bound, BindError>;

    /// Indices of the parameters that a slot is made of, rising: for messages. Those whose defaults are made of others are not named.
    fn parameters_of(&self, _slot: Slot) -> Vec<u32> {
        Vec::new()
    }
}

/// The values of one parameter set.
#[derive(Clone, Debug, PartialEq)]
pub struct Bound {
    /// One value a slot (SI).
    pub slots: Vec<f64>,
    /// One value a parameter (SI).
    pub parameters: Vec<f64>,
    /// What `advise`s that do not hold say.
    pub advice: Vec<Advice>,
}

/// An `advise` on parameters that does not hold.
#[derive(Clone, Debug, PartialEq)]
pub struct Advice {
    /// The name under which it is accepted; empty where it has none.
    pub name: String,
    /// The element and the place of the condition.
    pub origin: crate::system::Origin,
    /// The author's message with its numbers.
    pub message: String,
    /// The parameters and tables whose numbers decide it, where they are stated.
    pub decided_by: Vec<crate::system::Origin>,
}

/// A parameter set that cannot be used.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BindError {
    /// A `require` does not hold.
    #[error("{path}: {message}")]
    Require {
        /// Path of the element.
        path: String,
        /// The author's message with its numbers.
        message: String,
        /// Origin's place.
        used_at: Option<crate::system::Location>,
        /// Place of the `require`.
        defined_at: Option<crate::system::Location>,
        /// Indices and values (SI) of the parameters that the condition is made of.
        parameters: Vec<(u32, f64)>,
    },
    /// A value is not finite.
    #[error("{path} is not a finite number{}", read(outside))]
    NotFinite {
        /// Path of the slot or parameter.
        path: String,
        /// A table that is read outside its points.
        outside: Option<Box<Outside>>,
    },
    /// A value whose square is no number any more: lengths and energies cannot be computed.
    #[error("a number of {path} is {value:.1e} in SI units: no machine has such a number")]
    TooLarge {
        /// Path of the slot.
        path: String,
        /// The value (SI).
        value: f64,
    },
    /// A parameter leaves its limits.
    #[error("{path} = {value} is outside its limits: it lies between {low} and {high}")]
    Limits {
        /// Path of the parameter.
        path: String,
        /// The value with its unit.
        value: Box<str>,
        /// Lower limit.
        low: Box<str>,
        /// Upper limit.
        high: Box<str>,
    },
}

fn read(outside: &Option<Box<Outside>>) -> String {
    outside
        .as_ref()
        .map_or_else(String::new, |outside| format!(": {outside}"))
}

/// A compiled model: system, code of its classes (same indices), bind graph.
#[derive(Clone, Debug)]
pub struct Compiled {
    /// The flat system.
    pub system: std::sync::Arc<crate::system::System>,
    /// Code of each class.
    pub code: Vec<std::sync::Arc<dyn ElementCode>>,
    /// The bind graph.
    pub bind: std::sync::Arc<dyn BindCode>,
    /// Reductions of the flexible bodies.
    pub reduced: Vec<std::sync::Arc<crate::reduced::ReducedBody>>,
}
