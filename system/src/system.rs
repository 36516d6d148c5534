//! The flat system: the compiler makes it, and the runtime reads it.
//!
//! It contains no names to look up, no expressions and no units to convert. Numbers are SI and are in
//! *slots*, which the bind graph fills from the parameters. Every entry keeps its path and its places in the
//! text.

pub use crate::analysis::{
    Analysis, AnalysisKind, Extent, Integration, Kinematic, Linear, Method, Names, Periodic,
    PointValue, Response, Rows, Start, StepControl, Transient,
};
use crate::dimension::{Dimension, DisplayUnit};
use crate::layout::InputLayout;
pub use crate::place::{Location, Origin, Part};
use crate::table::Table;

pub mod summary;

/// Index into the bound values.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Slot(pub u32);

/// A body of [`System::bodies`], or the ground.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum BodyRef {
    /// The inertial frame.
    Ground,
    /// Index of a body.
    Body(u32),
}

/// Mass and its distribution.
#[derive(Clone, Debug, PartialEq)]
pub enum BodyInertia {
    /// A rigid body.
    Rigid {
        /// Mass (kg).
        mass: Slot,
        /// Centre of mass in the body frame (m).
        center_of_mass: [Slot; 3],
        /// Ixx, Iyy, Izz, Ixy, Iyz, Izx about the centre of mass, body axes (kg m²). The off-diagonal values
        /// are the tensor's entries (minus the integrals of products).
        inertia: [Slot; 6],
    },
    /// A flexible body: index of its reduction in the compiled model.
    Flexible(u32),
}

/// A body. Positions on it count from the origin of its reference frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Body {
    /// Path and places.
    pub origin: Origin,
    /// Mass and its distribution.
    pub inertia: BodyInertia,
    /// Stated or guessed position of the origin at the start (m, inertial).
    pub position: Option<[Slot; 3]>,
    /// Stated or guessed orientation at the start: rotation matrix body → inertial, row-major.
    pub orientation: Option<[Slot; 9]>,
    /// Places of a guess of one of the two.
    pub guessed_at: Vec<Location>,
}

/// A marker: an oriented point of a body.
#[derive(Clone, Debug, PartialEq)]
pub struct Marker {
    /// Path and places.
    pub origin: Origin,
    /// Its body.
    pub body: BodyRef,
    /// Position in the body frame (m).
    pub position: [Slot; 3],
    /// Rotation matrix marker → body, row-major.
    pub orientation: [Slot; 9],
    /// On a flexible body: index among the markers of its reduction, which gives the position; `position` is
    /// then ignored.
    pub shape: Option<u32>,
    /// For `ground` as an argument: the other marker with which this one coincides at the start; `position`
    /// and `orientation` are then ignored.
    pub placed_at: Option<u32>,
}

/// A number that can be set without compiling again.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// Path and places.
    pub origin: Origin,
    /// Its dimension.
    pub dimension: Dimension,
    /// Its display unit.
    pub display: DisplayUnit,
    /// Whether it is a point, such as a temperature, and not a difference. A point may be given in degC.
    pub point: bool,
    /// Open limits (SI); infinite if unstated.
    pub limits: (f64, f64),
}

/// The scale and the meaning of one constraint equation.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// The equation as written: `dot(b.z, a.x) == 0`; a vector equation has three rows, `… (x)`.
    pub text: String,
    /// Length for a distance, one or angle for a direction.
    pub dimension: Dimension,
    /// Place of the equation in the class.
    pub defined_at: Option<Location>,
}

/// An element's own unknown with a rate.
#[derive(Clone, Debug, PartialEq)]
pub struct StateInfo {
    /// Its name.
    pub name: String,
    /// Its dimension.
    pub dimension: Dimension,
}

/// The depth of an output in the equations, without the channels that it reads.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Depth {
    /// Positions, states and time.
    Position,
    /// Velocities too.
    Velocity,
    /// Accelerations, reactions and rates of states too.
    Acceleration,
}

/// One scalar output of a class.
#[derive(Clone, Debug, PartialEq)]
pub struct OutputInfo {
    /// `force.x`.
    pub name: String,
    /// Its dimension.
    pub dimension: Dimension,
    /// Its display unit.
    pub display: DisplayUnit,
    /// The axes of a component: `shell` (a parameter's name of the class), `ground`; empty for a scalar.
    pub frame: String,
    /// The quantities that it needs.
    pub depth: Depth,
}

/// The kind of a condition.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ConditionKind {
    /// Selects the assembly branch; checked at the start.
    Branch,
    /// Must hold at every accepted state; depends on the motion.
    Require,
    /// Should hold at every accepted state; a warning, given once.
    Advise,
    /// Ends the run where it begins to hold; depends on the motion.
    Stop,
    /// No condition, but a value in the message of a `require` or `advise`.
    Shown,
}

/// Part of the message of a condition.
#[derive(Clone, Debug, PartialEq)]
pub enum MessagePart {
    /// Plain text.
    Text(String),
    /// A value of the moment.
    Value {
        /// Index of the [`ConditionKind::Shown`] entry among the class's conditions that gives it (SI).
        index: u32,
        /// Its display unit.
        display: DisplayUnit,
    },
}

/// A quantity that must be positive, or that a message shows.
#[derive(Clone, Debug, PartialEq)]
pub struct Condition {
    /// Its kind.
    pub kind: ConditionKind,
    /// The name of an `advise` for `accept`; empty without a name.
    pub name: String,
    /// The condition as written, or the message of a `require` with its expressions as written.
    pub text: String,
    /// The message in parts; empty if `text` is the whole message.
    pub message: Vec<MessagePart>,
    /// Dimension of the value, if both compared sides have one.
    pub dimension: Option<Dimension>,
    /// Its place in the class.
    pub defined_at: Option<Location>,
}

impl Condition {
    /// The message with the values of the moment. `value` gives the number of an entry of the class's
    /// conditions (SI).
    pub fn message_with(&self, value: impl Fn(usize) -> f64) -> String {
        if self.message.is_empty() {
            return self.text.clone();
        }
        self.message
            .iter()
            .map(|part| match part {
                MessagePart::Text(text) => text.clone(),
                MessagePart::Value { index, display } => display.text(value(*index as usize)),
            })
            .collect()
    }
}

/// The kinks of a table along one argument: the points at which a derivative jumps although it must be continuous.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct TableKink {
    /// The argument.
    pub argument: u8,
    /// The highest derivative along the argument that must be continuous. For the value of a table in a load
    /// it is the first, in a constraint the second; for a derivative of the table it is higher by its order.
    pub smooth: u8,
}

/// The quantities on which a kink function depends.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Course {
    /// On velocities or states, or on an input beside positions.
    #[default]
    Motion,
    /// On inputs alone, and perhaps on time. It is a function of time if all inputs are known ahead.
    Inputs,
    /// On positions alone, and perhaps on time: `sin(place/(1 mm)) - 0.9`.
    Position,
    /// On time alone, at a constant rate: `time - 1 s`.
    Uniform,
    /// On time alone, at another rate: `sin(50 Hz*time) - 0.9`.
    Time,
}

impl Course {
    /// Whether it depends on time alone.
    pub fn is_of_time(self) -> bool {
        matches!(self, Course::Uniform | Course::Time)
    }
}

/// A function of the motion that changes its sign where a load, a rate or a constraint of a class is not smooth.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Kink {
    /// The expression with the kink as written: `max(depth, 0 mm)`; empty if no text states it.
    pub text: String,
    /// Dimension of the function, if the text shows it.
    pub dimension: Option<Dimension>,
    /// The table whose argument the function is; `None` for a function that is zero at the kink.
    pub table: Option<TableKink>,
    /// Whether constraints depend on it.
    pub constrains: bool,
    /// Whether it jumps where an angle begins anew: one of `wrapped`, or one of `atan2` at its cut.
    pub wraps: bool,
    /// Whether it is zero where such an angle begins anew.
    pub cut: bool,
    /// The quantities on which it depends.
    pub course: Course,
    /// Place of the expression.
    pub defined_at: Option<Location>,
}

/// Facts about the functions of a class of elements that spare their evaluation.
#[derive(Clone, Debug, PartialEq)]
pub struct ClassFacts {
    /// Whether the rates of kink functions depend on accelerations, rates of states or signals.
    pub kinks_read_accelerations: bool,
    /// Number of the arguments of sines whose rates (rad/s) follow the kink functions: those in kink functions of the
    /// motion.
    pub kink_phases: u32,
    /// Whether the wrenches depend on twists.
    pub uses_twist: bool,
    /// Whether the class applies forces besides its constraints.
    pub applies_load: bool,
    /// Whether its loads or the rates of its states depend on time itself, beside the motion.
    pub loads_over_time: bool,
    /// Whether its constraints depend on time.
    pub rows_over_time: bool,
    /// Whether its conditions depend on fields.
    pub conditions_read_fields: bool,
    /// Whether its loads, the rates of its states or the drives of its fields depend on each answer of its
    /// fields, so that the derivatives of this answer are needed. Outputs alone need its value.
    pub differentiated: Vec<bool>,
}

/// The data that all instances of one class of elements share. [`crate::code`] describes the functions of its
/// code.
#[derive(Clone, Debug, PartialEq)]
pub struct ElementClass {
    /// `Revolute`.
    pub name: String,
    /// The layout of its functions' inputs.
    pub layout: InputLayout,
    /// Constraint equations, one in each row.
    pub rows: Vec<Row>,
    /// Own unknowns.
    pub states: Vec<StateInfo>,
    /// Outputs in the order of the outputs function.
    pub outputs: Vec<OutputInfo>,
    /// Conditions in the order of the conditions function.
    pub conditions: Vec<Condition>,
    /// Kinks in the order of the kinks function.
    pub kinks: Vec<Kink>,
    /// Dependencies of its functions.
    pub facts: ClassFacts,
    /// Length of the tape between `linearize` and `tangent`.
    pub tape: u32,
}

impl ElementClass {
    /// Number of outputs of its kinks function: four for each kink function, and the rates of the arguments of sines.
    pub fn kink_outputs(&self) -> usize {
        4 * self.kinks.len() + self.facts.kink_phases as usize
    }
}

/// The role of an element.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Role {
    /// Part of the model: its rows constrain, its wrenches act.
    Dynamic,
    /// Rows that hold at the start only, on positions. `exact` from `start`, else from `guess`.
    StartPosition {
        /// Holds exactly.
        exact: bool,
    },
    /// Rows, affine in velocities, that hold at the start only.
    StartVelocity {
        /// Holds exactly.
        exact: bool,
    },
    /// It has only outputs.
    Output,
}

/// One instance of a class.
#[derive(Clone, Debug, PartialEq)]
pub struct Element {
    /// Path and places.
    pub origin: Origin,
    /// Index into [`System::classes`].
    pub class: u32,
    /// Its role.
    pub role: Role,
    /// Indices into [`System::markers`], as many as in the layout.
    pub markers: Vec<u32>,
    /// Slots of its constants, as many as in the layout.
    pub constants: Vec<Slot>,
    /// Start values of its states.
    pub state_start: Vec<Slot>,
    /// Scales of its states (positive), against which errors are measured.
    pub state_scale: Vec<Slot>,
    /// Lengths that positions at its markers must resolve, as its class states them.
    pub resolves: Vec<Slot>,
    /// Places of its parts that the assembly prefers, as its class states them.
    pub places: Vec<Placing>,
    /// Channels that its outputs read, as many as in the layout. Each is computed before those of this
    /// element.
    pub signals: Vec<u32>,
    /// Its unwrapped angles, as many as in the layout.
    pub rotations: Vec<Rotation>,
    /// Its fields. Their drives, answers and readings are one after the other.
    pub fields: Vec<FieldSource>,
}

/// `place a on b` of a class: a preference of the assembly, which the motion does not contain.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Placing {
    /// Index into the element's markers: the one that is placed.
    pub moving: u32,
    /// Index into the element's markers: the one at which it is placed.
    pub on: u32,
    /// Height of the first origin above the xy plane of the second (m). Without it the first origin is on the z
    /// axis of the second, and both z axes are parallel, as those of a pin in its shell.
    pub height: Option<Slot>,
}

/// A field of an element. The kernel is made of it when parameters are bound.
#[derive(Clone, Debug, PartialEq)]
pub struct FieldSource {
    /// Index into [`crate::field::KERNELS`].
    pub kernel: u32,
    /// Number of openings: the length of each list.
    pub openings: u32,
    /// Slots of the settings, by the name of the argument.
    pub settings: Vec<(&'static str, Vec<Slot>)>,
    /// Whole numbers by the name of the argument.
    pub wholes: Vec<(&'static str, i64)>,
    /// Words by the name of the argument.
    pub words: Vec<(&'static str, &'static str)>,
    /// The marker of the element whose surface the field presses on.
    pub surface: Option<u32>,
}

/// An unwrapped angle that an element measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rotation {
    /// Index into the element's markers: the one that turns.
    pub turning: u32,
    /// Index into the element's markers: the one about whose z axis, and from whose x axis, it is measured.
    pub reference: u32,
    /// In the rows of a start: the stated angle (rad).
    pub stated: Option<Slot>,
}

/// A column of the results: one output of one element.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    /// `main[5].force.x`.
    pub path: String,
    /// Index of the element.
    pub element: u32,
    /// Index into its class's outputs.
    pub output: u32,
    /// Its dimension.
    pub dimension: Dimension,
    /// Its display unit.
    pub display: DisplayUnit,
    /// The axes it is in, as a path (`block.main[5]`, `ground`); empty for a scalar.
    pub frame: String,
    /// Whether it reads only [continuous](crate::field::KernelResult::continuous) results of fields. Otherwise it
    /// need not repeat in a motion that repeats.
    pub continuous: bool,
}

/// The machine's cycle.
#[derive(Clone, Debug, PartialEq)]
pub struct Cycle {
    /// Path and places.
    pub origin: Origin,
    /// An [`Role::Output`] element whose output 0 is the unwrapped cycle angle (rad) and output 1 its rate
    /// (rad/s).
    pub element: u32,
    /// Angle after which the machine repeats (rad).
    pub period: Slot,
}

/// A length that positions must resolve.
#[derive(Clone, Debug, PartialEq)]
pub struct Resolution {
    /// Its element, with the place of the length in the class.
    pub origin: Origin,
    /// The length (m).
    pub length: Slot,
}

/// The firing of an element whose class fills `std.forces.GasLaw`.
#[derive(Clone, Debug, PartialEq)]
pub struct FiringInfo {
    /// Index of the element.
    pub element: u32,
    /// Cycle angle of its firing dead centre (rad).
    pub angle: Slot,
    /// The parameter that states this angle.
    pub stated_as: String,
    /// Bore (m).
    pub bore: Slot,
    /// Index into the element's markers: the piston.
    pub piston: u32,
    /// Index into the element's markers: the head.
    pub head: u32,
}

/// A journal: an element whose class fills `std.journals.JournalLaw`.
#[derive(Clone, Debug, PartialEq)]
pub struct JournalInfo {
    /// Index of the element.
    pub element: u32,
    /// Radial clearance (m).
    pub clearance: Slot,
    /// Index into the element's markers: the pin.
    pub pin: u32,
    /// Index into the element's markers: the shell.
    pub shell: u32,
    /// The channel of the x component of the force on the pin (N), along the shell's axes. Those of y and z
    /// follow.
    pub force: u32,
    /// The channel of the x component of the pin's eccentricity (m), along the shell's axes. That of y
    /// follows.
    pub eccentricity: u32,
}

/// A compiled model without its code.
#[derive(Clone, Debug, PartialEq)]
pub struct System {
    /// The model's name.
    pub name: String,
    /// Bodies that move.
    pub bodies: Vec<Body>,
    /// All markers.
    pub markers: Vec<Marker>,
    /// Parameters in the order of the bind graph.
    pub parameters: Vec<Parameter>,
    /// Parameters that may change during a run.
    pub inputs: Vec<crate::input::Input>,
    /// Slots that change with the inputs, ascending.
    pub moving: Vec<Slot>,
    /// Number of slots that a bind fills.
    pub slots: u32,
    /// Classes. Their code has the same indices.
    pub classes: Vec<ElementClass>,
    /// All instances: constraints and forces.
    pub elements: Vec<Element>,
    /// Columns of the results, without time and cycle angle.
    pub channels: Vec<Channel>,
    /// Interpolated tables; constants of table type hold the index.
    pub tables: Vec<Table>,
    /// Gravitational acceleration in ground axes (m/s²).
    pub gravity: [Slot; 3],
    /// The cycle, if the model states one.
    pub cycle: Option<Cycle>,
    /// Journals, for the start and the pictures.
    pub journals: Vec<JournalInfo>,
    /// Cylinders that fire, for figures and orders.
    pub firings: Vec<FiringInfo>,
    /// Tables of results by interface.
    pub summaries: Vec<summary::Summary>,
    /// Lengths (m) that positions must resolve, as the classes state them. The smallest is the unit of
    /// position errors.
    pub resolutions: Vec<Resolution>,
    /// Places of stated attributes, by path: `gravity`, `crank.inertia`. If an argument of a class is the
    /// name of a constant (`gas[2].firing`), it is the place of this constant.
    pub stated: std::collections::BTreeMap<String, Location>,
    /// Parts that the user's text makes of components of the library, in the order of their elaboration.
    pub parts: Vec<Part>,
    /// Indices of the items that the text repeats, by path without index. They include items whose condition does not hold.
    pub repeated: std::collections::BTreeMap<String, Vec<Vec<usize>>>,
    /// Quantities that lints follow through a turn without forces, in the order of their inputs of the bind graph.
    pub followed: Vec<crate::lint::Followed>,
    /// Lints that the text accepts.
    pub accepted: Vec<crate::lint::Accepted>,
}

impl System {
    /// The part of a component of the library in which an object is, if the user's text makes one around it.
    pub fn part_of(&self, object: &Origin) -> Option<&Part> {
        let holds = |part: &&Part| {
            let inside = object.path.strip_prefix(part.path.as_str());
            let inside = inside.is_some_and(|rest| rest.is_empty() || rest.starts_with('.'));
            inside && object.used_at != Some(part.made_at)
        };
        self.parts
            .iter()
            .filter(holds)
            .max_by_key(|part| part.path.len())
    }

    /// Paths of the inputs, channels or parameters, in their order.
    pub fn paths_of(&self, names: Names) -> Vec<&str> {
        match names {
            Names::Inputs => {
                let parameter = |k: u32| self.parameters.get(k as usize);
                let path = |k| parameter(k).map_or("", |p| p.origin.path.as_str());
                self.inputs.iter().map(|i| path(i.parameter)).collect()
            }
            Names::Channels => self.channels.iter().map(|c| c.path.as_str()).collect(),
            Names::Parameters => {
                let parameters = self.parameters.iter();
                parameters.map(|p| p.origin.path.as_str()).collect()
            }
        }
    }
}
