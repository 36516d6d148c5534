//! The functions of an element class that the runtime calls.
//!
//! Every number is a pair: lane 0 and lane 1 are two instances of the class (an odd tail repeats the last).
//! With K markers, m rows, s states (see [`InputLayout`](crate::layout::InputLayout)):
//!
//! | function | inputs | outputs |
//! | --- | --- | --- |
//! | `Residual` | common | Φ (m); wrench on each marker (6K): force in inertial axes, torque in MARKER axes, applied loads minus Gᵀλ; ẏ (s); drives of fields |
//! | `Linearize` | common | tape |
//! | `Tangent` | tape, then one seed for each direction | directional derivative of `Residual`'s outputs at fixed λ; the answers of fields are directions of their own |
//! | `Velocity` | common | Φ̇ (m) at the given twists, Φ_t included; then γ (m): Φ̈ at zero accelerations with the sign turned, so that G v̇ = γ |
//! | `Outputs` | common, accelerations, rates, signals | outputs |
//! | `Conditions` | common | one number for each condition, which must be positive |
//! | `Rotations` | common | unwrapped angle of each rotation (rad) |
//! | `Kinks` | common; with accelerations, rates and signals if the class states this | each kink function; its rate; the handle of its table, or −1; 1 while selected branches use it, else 0 |
//!
//! G is the derivative of Φ along the pose directions: δx in inertial axes, and δπ in the marker's axes with
//! δR = R δπ~. The twist (ẋ, ω in marker axes) is the rate of these. `∂W/∂λ = −Gᵀ`.

use crate::significant::short;
use crate::system::Slot;
use crate::table::{Outside, Table};

/// A function of a class.
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
    Kinks,
}

impl Function {
    /// All functions.
    pub const ALL: [Function; 8] = [
        Function::Residual,
        Function::Linearize,
        Function::Tangent,
        Function::Velocity,
        Function::Outputs,
        Function::Conditions,
        Function::Rotations,
        Function::Kinks,
    ];
}

/// Two instances of one number.
pub type Pair = [f64; 2];

/// The callable code of one element class, generated or interpreted.
pub trait ElementCode: Send + Sync + std::fmt::Debug {
    /// Numbers of inputs and outputs of a function.
    fn shape(&self, function: Function) -> (usize, usize);

    /// Evaluates a function. `inputs` and `outputs` must have at least the lengths of [`ElementCode::shape`].
    /// Otherwise nothing is written, and the result is `false`.
    fn call(
        &self,
        function: Function,
        inputs: &[Pair],
        outputs: &mut [Pair],
        tables: &[Table],
    ) -> bool;

    /// The first table that a function evaluates outside its points with these inputs, for each of the two
    /// instances.
    fn outside(
        &self,
        _function: Function,
        _inputs: &[Pair],
        _tables: &[Table],
    ) -> [Option<Outside>; 2] {
        [None, None]
    }

    /// Bytes of machine code of a function, including its constants; 0 for the interpreter.
    fn function_bytes(&self, function: Function) -> usize;

    /// Bytes of machine code of all functions.
    fn code_bytes(&self) -> usize {
        Function::ALL.iter().map(|f| self.function_bytes(*f)).sum()
    }
}

/// The graph of expressions of parameters alone.
pub trait BindCode: Send + Sync + std::fmt::Debug {
    /// Computes the slots. `overrides` has one entry for each parameter: a stated value (SI), or `None` for
    /// its default, which may depend on other parameters. Also returns the value of every parameter.
    fn bind(&self, overrides: &[Option<f64>], tables: &[Table]) -> Result<Bound, BindError>;

    /// Indices of the parameters that decide a slot, ascending, for messages. A parameter whose default
    /// depends on others is replaced by these.
    fn parameters_of(&self, _slot: Slot) -> Vec<u32> {
        Vec::new()
    }

    /// Computes again the values that change with the inputs. `overrides` are those of [`BindCode::bind`], with the
    /// present values of the inputs that a program sets, and `rates` are the rates of these inputs (1/s), one for each
    /// parameter. Inputs that the text drives have their values and rates at `time` (s). Writes one value for
    /// each slot of [`System::moving`](crate::system::System::moving). A value that does not exist is NaN.
    fn renew(
        &self,
        _nodes: &mut [Pair],
        (_overrides, _rates): (&[Option<f64>], &[f64]),
        _time: f64,
        _tables: &[Table],
        _moving: &mut [f64],
    ) {
    }

    /// The failed `advise`s on numbers of a turn without forces, one for each of
    /// [`System::followed`](crate::system::System::followed).
    fn after_turn(
        &self,
        _overrides: &[Option<f64>],
        _followed: &[f64],
        _tables: &[Table],
    ) -> Vec<Advice> {
        Vec::new()
    }

    /// Checks limits and conditions of parameters with the values of [`BindCode::renew`]. Returns the failed
    /// `advise`s.
    fn check(&self, _nodes: &[Pair], _tables: &[Table]) -> Result<Vec<Advice>, BindError> {
        Ok(Vec::new())
    }
}

/// The values of one parameter set.
#[derive(Clone, Debug, PartialEq)]
pub struct Bound {
    /// One value for each slot (SI).
    pub slots: Vec<f64>,
    /// One value for each parameter (SI).
    pub parameters: Vec<f64>,
    /// The failed `advise`s.
    pub advice: Vec<Advice>,
    /// The values of all operations, for [`BindCode::renew`]; empty for a system without inputs.
    pub nodes: Vec<Pair>,
}

/// A failed `advise` on parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct Advice {
    /// Its name for `accept`; empty without a name.
    pub name: String,
    /// The element and the place of the condition.
    pub origin: crate::system::Origin,
    /// The author's message with its numbers.
    pub message: String,
    /// The parameters and tables whose numbers decide it, with their places.
    pub decided_by: Vec<crate::system::Origin>,
}

/// A parameter set that cannot be used.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BindError {
    /// A failed `require`.
    #[error("{path}: {message}")]
    Require {
        /// Path of the element.
        path: String,
        /// The author's message with its numbers.
        message: String,
        /// Place of the use.
        used_at: Option<crate::system::Location>,
        /// Place of the `require`.
        defined_at: Option<crate::system::Location>,
        /// Indices and values (SI) of the parameters in the condition.
        parameters: Vec<(u32, f64)>,
    },
    /// A value is not finite.
    #[error("{path} is not a finite number{}", read(outside))]
    NotFinite {
        /// Path of the slot or parameter.
        path: String,
        /// A table that is evaluated outside its points.
        outside: Option<Box<Outside>>,
    },
    /// A value whose square is too large for a number, so that lengths and energies cannot be computed.
    #[error("{path} has the number {} in SI units, which is too large to compute with", short(*value, 2))]
    TooLarge {
        /// Path of the slot.
        path: String,
        /// The value (SI).
        value: f64,
    },
    /// A parameter leaves its limits.
    #[error("{path} = {value} is outside its limits: it must be above {low} and below {high}")]
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
    /// Makes the kernels of the fields.
    pub fields: std::sync::Arc<dyn crate::field::FieldMaker>,
    /// Number of threads that may solve the fields of one model side by side. It changes no bit of a result.
    pub threads: std::num::NonZeroUsize,
}
