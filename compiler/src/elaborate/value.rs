//! Values of expressions while a model is elaborated.

use super::scalar::{Flag, Scalar};
use crate::ir::Node;
use crate::program::DefinitionId;
use crate::typed::types::Solution;
use eng_grammar::{Span, ast};
use std::rc::Rc;

/// Index of a scope.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct ScopeId(pub u32);

/// A function of the text.
#[derive(Clone, Debug)]
pub(crate) struct Closure<'a> {
    pub function: &'a ast::Function,
    /// The scope of its free names.
    pub scope: ScopeId,
    /// For a function passed as a value: the dimensions of its variables.
    pub solution: Option<Rc<Solution>>,
}

/// A function with some of its arguments: `wiebe(shape: 2)`.
#[derive(Clone, Debug)]
pub(crate) struct Partial<'a> {
    /// A function or a table.
    pub function: Value<'a>,
    /// The derivative of the function in the place of its value.
    pub order: u8,
    pub given: Vec<GivenValue<'a>>,
}

/// An argument that a function has already.
#[derive(Clone, Debug)]
pub(crate) struct GivenValue<'a> {
    /// Its parameter, by the place in the function.
    pub place: u32,
    pub name: String,
    pub value: Value<'a>,
    pub expr: &'a ast::Expr,
    /// The scope of the expression.
    pub scope: ScopeId,
    /// Whether code depends on the value itself, as on a count.
    pub structural: bool,
}

/// A value.
#[derive(Clone, Debug)]
pub(crate) enum Value<'a> {
    Int(i64),
    Bool(bool),
    Text(String),
    Scalar(Scalar),
    Flag(Flag),
    /// A vector in space, as its components in ground axes.
    Vector([Scalar; 3]),
    /// A vector in space with the axes that an output states for it.
    Shown(Shown),
    List(Vec<Value<'a>>),
    /// Numbers along known axes. Only `vector(c, m)` makes a vector of them.
    Components(Vec<Scalar>, Axes),
    /// Values indexed by their binders: `pin[i in 2..4]`.
    Family(Vec<(Vec<usize>, Value<'a>)>),
    Marker(u32),
    /// `ground`, before its use decides whether it is an argument.
    Ground,
    Body(u32),
    /// Index into the elaborator's elements.
    Element(u32),
    /// Its definition and its names.
    Record(DefinitionId, ScopeId),
    Part(ScopeId),
    Closure(Closure<'a>),
    Table(TableValue),
    /// A function with some of its arguments.
    Partial(Rc<Partial<'a>>),
    /// A class, record, model or component, which is called with arguments.
    Definition(DefinitionId),
    /// A class with some of its arguments.
    Bound(Rc<BoundClass<'a>>),
    /// A part whose condition does not hold.
    Absent(&'a ast::Declaration, Rc<str>),
    Cycle,
    ModeSet(Rc<Vec<super::ModePart>>),
    /// A word of a choice, by its place among the words.
    Choice(DefinitionId, u32),
}

/// A class with some of its arguments. Each use evaluates them in the scope of their text.
#[derive(Clone, Debug)]
pub(crate) struct BoundClass<'a> {
    pub class: DefinitionId,
    pub given: Vec<Given<'a>>,
    /// Its definition, if it has one of its own.
    pub named: Option<DefinitionId>,
}

/// Arguments of one call of a class.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Given<'a> {
    pub arguments: &'a [ast::Argument],
    pub scope: ScopeId,
    /// The place of the call.
    pub call: Span,
    /// The interface through which the call uses the class.
    pub interface: Option<DefinitionId>,
}

/// The axes of components.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Axes {
    Ground,
    /// A marker's, by its global index.
    Marker(u32),
}

/// An output that is a vector. `.x` reads the shown component. All other operations use the vector in space.
#[derive(Clone, Debug)]
pub(crate) struct Shown {
    /// Components along the axes.
    pub components: [Scalar; 3],
    pub axes: Axes,
    /// The vector in ground axes, if it is known without turning the components back.
    pub space: Option<[Scalar; 3]>,
}

/// A table as a value.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TableValue {
    /// Its handle in the bind graph.
    pub handle: Node,
}

/// The existing members of a family: those whose condition holds.
pub(crate) fn present<'a>(
    members: Vec<(Vec<usize>, Value<'a>)>,
) -> impl Iterator<Item = (Vec<usize>, Value<'a>)> {
    members
        .into_iter()
        .filter(|(_, member)| !member.is_absent())
}

impl Value<'_> {
    /// Whether it is a part whose condition does not hold.
    pub fn is_absent(&self) -> bool {
        matches!(self, Value::Absent(..))
    }

    /// Whether it has several numbers: a vector or a list.
    pub fn is_several(&self) -> bool {
        matches!(
            self,
            Value::Vector(_) | Value::Shown(_) | Value::Components(..) | Value::List(_)
        )
    }

    /// The name of the kind in messages.
    pub fn kind(&self) -> &'static str {
        match self {
            Value::Int(_) => "a whole number",
            Value::Bool(_) | Value::Flag(_) => "a truth value",
            Value::Text(_) => "a text",
            Value::Scalar(_) => "a number",
            Value::Vector(_) | Value::Shown(_) => "a vector",
            Value::List(_) | Value::Components(..) | Value::Family(_) => "a list",
            Value::Marker(_) => "a marker",
            Value::Ground => "the ground",
            Value::Body(_) => "a body",
            Value::Element(_) => "an element",
            Value::Record(..) => "a record",
            Value::Part(_) => "a part",
            Value::Closure(_) | Value::Partial(_) => "a function",
            Value::Table(_) => "a table",
            Value::Definition(_) | Value::Bound(_) => "a class",
            Value::Absent(..) => "a part that is not there",
            Value::Cycle => "the cycle",
            Value::ModeSet(_) => "a mode set",
            Value::Choice(..) => "a word of a choice",
        }
    }
}
