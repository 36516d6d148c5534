//! The functions of the language: one table for the checker and elaboration.
//!
//! A function of one plain number needs only its row here. A function of another kind also has its type in
//! `check/builtin.rs` and its evaluation in `elaborate/builtin.rs`.

use crate::ir::{Node, Op};

/// A function of the language.
#[derive(Debug)]
pub(crate) struct BuiltIn {
    pub name: &'static str,
    /// Names of the parameters, for messages; empty if the function takes any number of arguments.
    pub parameters: &'static [&'static str],
    pub kind: Kind,
}

/// The kind of a function: its arguments and its result.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Kind {
    /// From a plain number to a plain number.
    Plain(fn(Node) -> Op),
    /// From an angle (rad) or a plain number to a plain number.
    OfAngle(fn(Node) -> Op),
    /// From a plain number to an angle (rad).
    ToAngle(fn(Node) -> Op),
    /// Numbers of any dimension.
    Numbers,
    /// Vectors, components and markers.
    Vectors,
    /// The numbers of a list.
    List,
    /// The time derivative.
    Rate,
}

const fn function(name: &'static str, parameters: &'static [&'static str], kind: Kind) -> BuiltIn {
    BuiltIn {
        name,
        parameters,
        kind,
    }
}

/// All functions.
pub(crate) static FUNCTIONS: [BuiltIn; 25] = [
    function("dot", &["a", "b"], Kind::Vectors),
    function("cross", &["a", "b"], Kind::Vectors),
    function("norm", &["v"], Kind::Vectors),
    function("local", &["v", "m"], Kind::Vectors),
    function("vector", &["c", "m"], Kind::Vectors),
    function("perpendicular", &["v"], Kind::Vectors),
    function("rotation", &["a", "b"], Kind::Vectors),
    function("der", &["x"], Kind::Rate),
    function("abs", &["x"], Kind::Numbers),
    function("sqrt", &["x"], Kind::Numbers),
    function("exp", &["x"], Kind::Plain(Op::Exp)),
    function("log", &["x"], Kind::Plain(Op::Log)),
    function("sin", &["x"], Kind::OfAngle(Op::Sin)),
    function("cos", &["x"], Kind::OfAngle(Op::Cos)),
    function("tan", &["x"], Kind::OfAngle(Op::Tan)),
    function("asin", &["x"], Kind::ToAngle(Op::Asin)),
    function("acos", &["x"], Kind::ToAngle(Op::Acos)),
    function("atan", &["x"], Kind::ToAngle(Op::Atan)),
    function("tanh", &["x"], Kind::Plain(Op::Tanh)),
    function("atan2", &["y", "x"], Kind::Numbers),
    function("min", &[], Kind::List),
    function("max", &[], Kind::List),
    function("sum", &["v"], Kind::List),
    function("length", &["v"], Kind::List),
    function("distinct", &["v"], Kind::List),
];

/// The function with a name.
pub(crate) fn find(name: &str) -> Option<&'static BuiltIn> {
    FUNCTIONS.iter().find(|function| function.name == name)
}

/// Their names.
pub(crate) fn names() -> impl Iterator<Item = &'static str> {
    FUNCTIONS.iter().map(|function| function.name)
}
