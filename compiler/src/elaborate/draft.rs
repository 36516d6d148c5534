//! The model as far as elaboration has built it.

use super::bind_program::Check;
use super::change::Change;
use super::flexible;
use super::scalar::FieldDraft;
use super::turn::FollowedDraft;
use super::value::{self, ScopeId, Value};
use crate::ir::{self, KinkPlace, Node};
use crate::program::DefinitionId;
use eng_grammar::{Diagnostic, Span, ast};
use eng_system::input::Input;
use eng_system::lint::Accepted;
use eng_system::system::summary::Summary;
use eng_system::system::{
    Body, Channel, Condition, FiringInfo, JournalInfo, Kink, Location, Marker, Origin, OutputInfo,
    Parameter, Part, Resolution, Role, Row, StateInfo,
};
use eng_system::table::Table;
use std::collections::{BTreeMap, HashMap};
use std::rc::Rc;

/// Bodies, elements and values of a model in the order of the text. Elements do not share classes yet.
#[derive(Default)]
pub(crate) struct Draft<'a> {
    pub bodies: Vec<Body>,
    pub body_scopes: Vec<ScopeId>,
    pub flexible: Vec<Option<flexible::FlexibleDraft>>,
    pub markers: Vec<Marker>,
    pub used_markers: Vec<bool>,
    pub parameters: Vec<Parameter>,
    pub parameter_defaults: Vec<Node>,
    pub inputs: Vec<Input>,
    /// Elements and outputs of the quantities that lints of models and components follow through a turn.
    pub turned: BTreeMap<String, (u32, u32)>,
    /// Rates of the defaults of parameters, as far as they were asked for; `None` for a constant.
    pub parameter_rates: BTreeMap<u32, Option<Node>>,
    /// Functions of time that the analysis gives to inputs, by the name of the input.
    pub signals: BTreeMap<String, DefinitionId>,
    pub checks: Vec<Check>,
    /// Quantities that lints follow through a turn.
    pub followed: Vec<FollowedDraft>,
    pub tables: Vec<Table>,
    pub elements: Vec<ElementDraft<'a>>,
    pub channels: Vec<Channel>,
    pub journals: Vec<JournalInfo>,
    pub firings: Vec<FiringInfo>,
    /// Tables of results by the interface that defines them.
    pub summaries: Vec<(DefinitionId, Summary)>,
    /// Lengths that positions must resolve.
    pub resolutions: Vec<Resolution>,
    pub accepted: Vec<Accepted>,
    /// Failed `advise`s on values known while compiling, with the paths of their subjects.
    pub advised: Vec<(Diagnostic, Vec<String>)>,
    /// Places of stated attributes, by path. If an argument of a class is the name of a constant, it is the
    /// place of this constant.
    pub stated: BTreeMap<String, Location>,
    /// Parts that the user's text makes of components of the library.
    pub parts: Vec<Part>,
    /// Places of the arguments of classes, by path.
    pub passed: HashMap<String, Span>,
    /// Arrays that interfaces require, each with its scope, by the scope and name of the output that gives
    /// it.
    pub promised: HashMap<(u32, String), (&'a ast::Binding, ScopeId)>,
    /// Places of the `let`s and `const`s of models and components, by scope and name.
    pub named: HashMap<(usize, String), Location>,
    /// Numbers that uses of parts change, by their paths.
    pub changes: Vec<Change<'a>>,
    /// Indices of repeated items, by path without index.
    pub repeated: BTreeMap<String, Vec<Vec<usize>>>,
    /// Items whose condition does not hold, with their paths.
    pub absent: Vec<(&'a ast::Declaration, Rc<str>)>,
    pub gravity: Option<[Node; 3]>,
    pub cycle: Option<CycleDraft<'a>>,
    /// A cycle has an error, which was reported.
    pub cycle_failed: bool,
    pub pending: Vec<super::pending::Pending<'a>>,
}

/// A finished element, before elements share classes.
#[derive(Debug)]
pub(crate) struct ElementDraft<'a> {
    pub origin: Origin,
    pub span: Span,
    pub role: Role,
    /// The definition and arguments, to evaluate its names again in another element.
    pub source: Option<ElementSource<'a>>,
    /// Outputs: name, first scalar, shape.
    pub outputs: Vec<OutputShape>,
    /// First channel of its outputs.
    pub first_channel: u32,
    pub class_name: String,
    pub body: ir::ClassBody,
    pub meta: ClassMeta,
    pub markers: Vec<u32>,
    pub constants: Vec<Node>,
    pub state_start: Vec<Node>,
    pub state_scale: Vec<Node>,
    /// Lengths that positions at its markers must resolve.
    pub resolves: Vec<Node>,
    /// Places of its parts that the assembly prefers: local markers, and the bind node of the height.
    pub places: Vec<(u32, u32, Option<Node>)>,
    pub signals: Vec<u32>,
    /// Its fields.
    pub fields: Vec<FieldDraft>,
    /// Pairs of local markers, and the bind node of a stated angle.
    pub rotations: Vec<(u32, u32, Option<Node>)>,
    /// The local markers of each `apply`: on, against.
    pub applied: Vec<(u32, Option<u32>)>,
}

/// The facts of a class besides its graph.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct ClassMeta {
    pub rows: Vec<Row>,
    pub states: Vec<StateInfo>,
    pub outputs: Vec<OutputInfo>,
    pub conditions: Vec<Condition>,
    /// Texts of operations that may have a kink.
    pub kinks: BTreeMap<KinkPlace, Kink>,
    /// Texts of the kinks of constants that follow inputs.
    pub bound_kinks: Vec<Kink>,
}

/// The data to evaluate an element's names once more.
#[derive(Clone, Debug)]
pub(crate) struct ElementSource<'a> {
    pub definition: DefinitionId,
    /// Evaluated arguments; those of the motion stage are evaluated again.
    pub arguments: Vec<(String, Argument<'a>)>,
}

#[derive(Clone, Debug)]
pub(crate) enum Argument<'a> {
    Value(Value<'a>),
    /// A value of the motion, evaluated again in its scope for each element.
    Again(&'a ast::Expr, ScopeId),
}

/// An output's scalars.
#[derive(Clone, Debug)]
pub(crate) struct OutputShape {
    pub name: String,
    /// Its index, for one of several with a name: `many[2]`.
    pub index: Vec<usize>,
    pub first: u32,
    /// 1 for a scalar, else the number of components.
    pub count: u32,
    /// The axes of the components, if the text states them.
    pub axes: Option<value::Axes>,
    /// A vector in space rather than components.
    pub vector: bool,
}

#[derive(Clone, Debug)]
pub(crate) struct CycleDraft<'a> {
    pub declaration: &'a ast::Declaration,
    pub scope: ScopeId,
    pub period: Node,
}
