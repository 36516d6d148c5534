//! The syntax tree: the text in structured form, with its places.
//!
//! No name is looked up here.
//!
//! Every parse gives a tree. Unreadable text becomes [`ItemKind::Error`] or [`ExprKind::Error`]. Later stages
//! skip these nodes silently, because the parser has reported the error.

use crate::span::Span;

/// A name and its place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Name {
    /// The identifier.
    pub text: String,
    /// Its place.
    pub span: Span,
}

/// One file.
#[derive(Clone, Debug, PartialEq)]
pub struct File {
    /// `//!` lines at the head.
    pub docs: Vec<String>,
    /// Items in order.
    pub items: Vec<Item>,
    /// The whole text.
    pub span: Span,
}

/// One item of a file or a block.
#[derive(Clone, Debug, PartialEq)]
pub struct Item {
    /// `///` lines before it.
    pub docs: Vec<String>,
    /// The whole item.
    pub span: Span,
    /// Its kind.
    pub kind: ItemKind,
}

/// The items of `{ … }`.
#[derive(Clone, Debug, PartialEq)]
pub struct Block {
    /// Items in order.
    pub items: Vec<Item>,
    /// With its braces.
    pub span: Span,
}

/// The kinds of items.
// Bindings, the largest variant, are also the most frequent one.
#[allow(clippy::large_enum_variant)]
#[derive(Clone, Debug, PartialEq)]
pub enum ItemKind {
    /// `use std.joints.{Revolute, Fixed}`, `use std.units` (then all names of the module).
    Use(Use),
    /// `dimension Force = Mass*Acceleration`.
    Dimension(DimensionItem),
    /// `unit kN = 1e3 N`.
    Unit(UnitItem),
    /// `choice End = timing_end | driving_end`.
    Choice(Choice),
    /// `const`, `param`, `let`, `state`, `output`.
    Binding(Binding),
    /// `fn f(x: Length) -> Area = x^2`.
    Function(Function),
    /// `table p(theta: CrankAngle) -> AbsolutePressure = csv("p.csv", …)`.
    Table(Table),
    /// `constrain`, `branch`, `apply`, …
    Statement(Statement),
    /// `kind name …`: a class, an instance of a class, or a plain block.
    Declaration(Declaration),
    /// `mass = 0.62 kg` inside a block.
    Attribute(Attribute),
    /// `report bearings "Main bearings" { … }`: figures and values made from results.
    Report(Report),
    /// `figure name = …`, `value name = …` inside a report.
    Entry(Entry),
    /// Unreadable; the error was reported.
    Error,
}

impl ItemKind {
    /// The name of the item in its scope; `None` for an item that defines none.
    pub fn name(&self) -> Option<&Name> {
        match self {
            ItemKind::Dimension(dimension) => Some(&dimension.name),
            ItemKind::Unit(unit) => Some(&unit.name),
            ItemKind::Choice(choice) => Some(&choice.name),
            ItemKind::Binding(binding) => Some(&binding.name),
            ItemKind::Function(function) => Some(&function.name),
            ItemKind::Table(table) => Some(&table.name),
            ItemKind::Declaration(declaration) => Some(&declaration.name),
            ItemKind::Report(report) => Some(&report.name),
            ItemKind::Entry(entry) => Some(&entry.name),
            ItemKind::Use(_)
            | ItemKind::Statement(_)
            | ItemKind::Attribute(_)
            | ItemKind::Error => None,
        }
    }

    /// Its block, if it has one.
    pub fn block(&self) -> Option<&Block> {
        match self {
            ItemKind::Declaration(declaration) => declaration.block(),
            ItemKind::Report(report) => Some(&report.block),
            _ => None,
        }
    }
}

/// `use path.{names}`.
#[derive(Clone, Debug, PartialEq)]
pub struct Use {
    /// `std.joints` both for `use std.joints.{Revolute}` and for `use std.joints.Revolute`. For
    /// `use std.units.*` the path is `std.units`.
    pub path: Vec<Name>,
    /// The names taken.
    pub names: UseNames,
}

/// The names that a `use` takes.
#[derive(Clone, Debug, PartialEq)]
pub enum UseNames {
    /// `.*`: every name of the module.
    All,
    /// The last segment, or the list in braces.
    Some(Vec<Name>),
}

/// `dimension Length` (a base dimension), `dimension Force = Mass*Acceleration`,
/// `dimension Temperature = point TemperatureDifference` (positions whose differences are the right side).
#[derive(Clone, Debug, PartialEq)]
pub struct DimensionItem {
    /// The name it gives.
    pub name: Name,
    /// The right side; absent for a base dimension.
    pub definition: Option<TypeExpr>,
    /// Whether the word `point` is before the right side.
    pub point: bool,
}

/// `unit m: Length` (a base unit), `unit kN = 1e3 N`, `unit degC: Temperature = 1 K from 273.15 K`.
#[derive(Clone, Debug, PartialEq)]
pub struct UnitItem {
    /// The name it gives; may be `%` .
    pub name: Name,
    /// The dimension after `:`.
    pub dimension: Option<TypeExpr>,
    /// The size; absent for a base unit.
    pub definition: Option<Expr>,
    /// The zero of an affine unit, after `from`.
    pub offset: Option<Expr>,
}

/// `choice End = timing_end | driving_end`: values that are words.
#[derive(Clone, Debug, PartialEq)]
pub struct Choice {
    /// The name it gives.
    pub name: Name,
    /// Its words in order.
    pub words: Vec<Name>,
}

/// The kind of binding.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum BindingKind {
    /// A structural value. A change needs a new compilation.
    Const,
    /// A parameter. It can change without a new compilation.
    Param,
    /// A number that changes while the model runs.
    Input,
    /// A named value.
    Let,
    /// An unknown with a rate.
    State,
    /// The results of a solver of its own: `field film: FilmAnswer = reynolds(…)`.
    Field,
    /// A channel of the result.
    Output,
}

/// `param bore: Length = 86 mm in (10 mm, 500 mm)`,
/// `output force[j in 1..5]: Vector<Force> = F in shell as kN`.
#[derive(Clone, Debug, PartialEq)]
pub struct Binding {
    /// The kind of binding.
    pub kind: BindingKind,
    /// The name it gives.
    pub name: Name,
    /// `[j in 1..5]`.
    pub index: Vec<Binder>,
    /// After `:`.
    pub ty: Option<TypeExpr>,
    /// After `=`.
    pub value: Option<Expr>,
    /// `in shell`: the marker whose axes an output's components use. Outputs only.
    pub frame: Option<Expr>,
    /// `as kN`.
    pub display: Option<UnitExpr>,
    /// `in (low, high)`: open limits of a parameter or input.
    pub limits: Option<(Expr, Expr)>,
    /// `scale 0.1 mm`: the size against which errors of a state are measured. States only.
    pub scale: Option<Expr>,
    /// `summary largest`: the number that tables take of an output. Outputs only.
    pub summary: Option<Name>,
    /// `interpolation: linear`: an input between two points. Inputs only.
    pub interpolation: Option<Name>,
}

/// `j in 1..5`.
#[derive(Clone, Debug, PartialEq)]
pub struct Binder {
    /// The variable.
    pub name: Name,
    /// A range or a list.
    pub range: Expr,
}

/// `name: Type = default` in a parameter list.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// `///` lines before it.
    pub docs: Vec<String>,
    /// The name.
    pub name: Name,
    /// The type.
    pub ty: TypeExpr,
    /// The value without an argument.
    pub default: Option<Expr>,
    /// `in (low, high)`.
    pub limits: Option<(Expr, Expr)>,
    /// The whole parameter.
    pub span: Span,
}

/// `fn clamp<D>(x: D, low: D, high: D) -> D { let … ; value }`, `fn burn = wiebe(shape: 2)`.
#[derive(Clone, Debug, PartialEq)]
pub struct Function {
    /// The name.
    pub name: Name,
    /// Whether it has no list of parameters: its value is a function with some of its arguments.
    pub bound: bool,
    /// Dimension variables.
    pub generics: Vec<Name>,
    /// Parameters.
    pub parameters: Vec<Parameter>,
    /// After `->`.
    pub result: Option<TypeExpr>,
    /// `let`s of the block form, empty in the `=` form.
    pub lets: Vec<Binding>,
    /// Conditions on the arguments, in the block form.
    pub requirements: Vec<Requirement>,
    /// The value; absent in an interface whose classes give the function.
    pub value: Option<Expr>,
}

/// `require condition else "message"` in a function.
#[derive(Clone, Debug, PartialEq)]
pub struct Requirement {
    /// `advise`: a warning.
    pub advise: bool,
    /// The name of an `advise` for `accept`.
    pub name: Option<Name>,
    /// The condition.
    pub condition: Expr,
    /// The message if the condition fails.
    pub message: Name,
}

/// `table name(x: Type) -> Type = csv("file", columns: ["x [deg]", "y [bar]"], periodic: 720 deg,
/// interpolation: monotone)`.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// The name.
    pub name: Name,
    /// The argument.
    pub parameters: Vec<Parameter>,
    /// The type of its values.
    pub result: Option<TypeExpr>,
    /// The call that gives the numbers: `csv(…)` or `points([…], […])`.
    pub source: Expr,
}

/// Statements of bodies and classes.
#[derive(Clone, Debug, PartialEq)]
pub enum Statement {
    /// `constrain a == b`.
    Constrain(Expr),
    /// `branch a > b`.
    Branch(Expr),
    /// `start target = value`: holds exactly at the start.
    Start {
        /// The target.
        target: Expr,
        /// Its value.
        value: Expr,
    },
    /// `guess target = value`: helps the assembly.
    Guess {
        /// The target.
        target: Expr,
        /// Its value.
        value: Expr,
    },
    /// `apply force F on a against b`.
    Apply {
        /// `torque` instead of `force`.
        torque: bool,
        /// The vector.
        value: Expr,
        /// The marker it acts on.
        on: Expr,
        /// The marker that takes the reaction; absent for an external load.
        against: Option<Expr>,
    },
    /// `require condition else "message {x as mm}"`; `advise usual: condition else "…"` in the same form
    /// as a lint.
    Require {
        /// `advise` instead of `require`.
        advise: bool,
        /// `[k in 1..n]`: the condition holds for each.
        index: Vec<Binder>,
        /// The name of an `advise` for `accept`.
        name: Option<Name>,
        /// The condition.
        condition: Expr,
        /// The text with `{expression as unit}` places, and its span.
        message: Name,
    },
    /// `resolve radial_clearance`: the length that positions at the markers of a class must resolve.
    Resolve(Expr),
    /// `place a on b`, `place a on b at height`: where the assembly prefers the first marker of a class.
    Place {
        /// The marker that is placed.
        moving: Expr,
        /// The marker at which it is placed.
        on: Expr,
        /// The height above a plane; absent for a pin in its shell.
        height: Option<Expr>,
    },
    /// `shank.mass = 0.65 kg` after `with`: a number inside of a part.
    Change {
        /// Its path inside of the part.
        target: Expr,
        /// Its value.
        value: Expr,
    },
    /// `accept usual, short`: accepts the lints of these names here.
    Accept(Vec<Name>),
    /// `der(p) = expr`.
    Rate {
        /// The state.
        state: Name,
        /// Its rate.
        value: Expr,
    },
}

/// Kinds of declarations.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[allow(missing_docs)]
pub enum Kind {
    Model,
    Component,
    Interface,
    Record,
    Body,
    Flexible,
    Marker,
    Joint,
    Force,
    Journal,
    Drive,
    Part,
    Cycle,
    Analysis,
    Default,
}

/// `kind name[index] …`.
#[derive(Clone, Debug, PartialEq)]
pub struct Declaration {
    /// The kind.
    pub kind: Kind,
    /// Place of the kind's word.
    pub kind_span: Span,
    /// The name.
    pub name: Name,
    /// `[i in 1..4]`.
    pub index: Vec<Binder>,
    /// `if films`: the part exists only where this holds.
    pub condition: Option<Expr>,
    /// `with { shank.mass = 0.65 kg; start hinge.angle = 3 deg }`.
    pub changes: Option<Block>,
    /// Its form.
    pub form: Form,
}

impl Declaration {
    /// Its block, if it has one.
    pub fn block(&self) -> Option<&Block> {
        match &self.form {
            Form::Class { block, .. } | Form::Plain { block, .. } => Some(block),
            Form::Instance { block, .. } => block.as_ref(),
        }
    }
}

/// The three forms of a declaration.
#[derive(Clone, Debug, PartialEq)]
pub enum Form {
    /// `joint Revolute(a: Marker, b: Marker) : Interface { … }`.
    Class {
        /// Parameters.
        parameters: Vec<Parameter>,
        /// After `:`.
        interface: Option<Name>,
        /// The definition.
        block: Block,
    },
    /// `joint pin = Revolute(a, b) { branch … }`, `marker big = [0, -41, 0] mm`.
    Instance {
        /// The right side.
        value: Expr,
        /// Additions at the use.
        block: Option<Block>,
    },
    /// `body rod { … }`, `model Inline4 { … }`, `interface PiFilm : JournalLaw { … }`.
    Plain {
        /// After `:`. Only an interface or a record has it.
        interface: Option<Name>,
        /// The parts.
        block: Block,
    },
}

/// `name = value` inside a block.
#[derive(Clone, Debug, PartialEq)]
pub struct Attribute {
    /// The attribute.
    pub name: Name,
    /// Its value.
    pub value: Expr,
}

/// A text in quotes and its place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Title {
    /// Unescaped.
    pub text: String,
    /// Its place, with the quotes.
    pub span: Span,
}

/// `report bearings "Main bearings" { … }`.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// Place of the word.
    pub word: Span,
    /// The name.
    pub name: Name,
    /// Title of the section; absent if the name serves.
    pub title: Option<Title>,
    /// Figures, values, `let`s and `require`s.
    pub block: Block,
}

/// The kinds of entries of a report.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum EntryKind {
    /// A picture.
    Figure,
    /// A row of the table, or several.
    Value,
}

/// `value peak "Largest force" = maximum(run.force) as kN`.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    /// Its kind.
    pub kind: EntryKind,
    /// Place of the word.
    pub word: Span,
    /// The name.
    pub name: Name,
    /// Its title; absent if the name serves.
    pub title: Option<Title>,
    /// After `=`.
    pub value: Expr,
    /// `as kN`.
    pub display: Option<UnitExpr>,
}

/// A type or a dimension, as written.
#[derive(Clone, Debug, PartialEq)]
pub struct TypeExpr {
    /// Its place.
    pub span: Span,
    /// Its kind.
    pub kind: TypeExprKind,
}

/// The kinds of type expressions.
#[derive(Clone, Debug, PartialEq)]
pub enum TypeExprKind {
    /// `Length`, `Marker`, `D`.
    Name(Name),
    /// `1`: dimensionless.
    One,
    /// `Vector<Force>`, `Vector2<1>`.
    Generic(Name, Vec<TypeExpr>),
    /// `Marker[n]`, `Int[cylinders + 1]`.
    Array(Box<TypeExpr>, Box<Expr>),
    /// `Mass*Acceleration`.
    Product(Box<TypeExpr>, Box<TypeExpr>),
    /// `Force/Area`.
    Quotient(Box<TypeExpr>, Box<TypeExpr>),
    /// `Length^2`, exponent as a ratio of integers.
    Power(Box<TypeExpr>, i32, i32),
    /// `fn(CrankAngle) -> AbsolutePressure`.
    Function(Vec<TypeExpr>, Box<TypeExpr>),
    /// Could not be read.
    Error,
}

/// A unit as written: `N*m/rad`, `g*m^2`.
#[derive(Clone, Debug, PartialEq)]
pub struct UnitExpr {
    /// Its place.
    pub span: Span,
    /// Factors with exponent (ratio of integers; negative after `/`).
    pub factors: Vec<UnitFactor>,
}

/// `m^2` in a unit.
#[derive(Clone, Debug, PartialEq)]
pub struct UnitFactor {
    /// The unit's name.
    pub name: Name,
    /// Numerator of the exponent.
    pub numerator: i32,
    /// Denominator of the exponent, positive.
    pub denominator: i32,
}

/// An expression.
#[derive(Clone, Debug, PartialEq)]
pub struct Expr {
    /// Its place.
    pub span: Span,
    /// Its kind.
    pub kind: ExprKind,
}

/// Binary operators.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[allow(missing_docs)]
pub enum BinaryOp {
    Or,
    And,
    Equal,
    NotEqual,
    Less,
    LessEqual,
    Greater,
    GreaterEqual,
    Add,
    Subtract,
    Multiply,
    Divide,
    Power,
}

impl BinaryOp {
    /// Whether it compares two values.
    pub fn is_comparison(self) -> bool {
        matches!(
            self,
            BinaryOp::Equal
                | BinaryOp::NotEqual
                | BinaryOp::Less
                | BinaryOp::LessEqual
                | BinaryOp::Greater
                | BinaryOp::GreaterEqual
        )
    }
}

/// Unary operators.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[allow(missing_docs)]
pub enum UnaryOp {
    Negate,
    Not,
}

/// The kinds of expressions.
#[derive(Clone, Debug, PartialEq)]
pub enum ExprKind {
    /// `54`, `54 mm`, `5 %`. A sign directly before an affine literal belongs to it (`-5 degC`). So the
    /// parser puts the `-` of a unary minus into `value` if its operand is a literal with a unit. This does
    /// not concern the binary minus of `a - 5 degC`.
    Number {
        /// The written number, without the unit.
        value: f64,
        /// No `.` and no exponent.
        integer: bool,
        /// The unit.
        unit: Option<UnitExpr>,
    },
    /// `"text"`, unescaped.
    Text(String),
    /// `true`, `false`.
    Bool(bool),
    /// A name.
    Name(String),
    /// `[0, 0, -41] mm`.
    List {
        /// Elements.
        items: Vec<Expr>,
        /// The unit of every element.
        unit: Option<UnitExpr>,
    },
    /// `[f(i) for i in 1..4] mm`, and as a sole call argument `sum(f(i) for i in 1..4)`.
    Comprehension {
        /// The element.
        body: Box<Expr>,
        /// The loops, outermost first.
        binders: Vec<Binder>,
        /// The unit of every element.
        unit: Option<UnitExpr>,
    },
    /// `(a + b) mm`; parentheses without a unit leave only their span on the inner expression's `Paren`.
    Paren {
        /// Inside.
        inner: Box<Expr>,
        /// The unit.
        unit: Option<UnitExpr>,
    },
    /// `base.name`.
    Field {
        /// Left of the dot.
        base: Box<Expr>,
        /// Right of the dot.
        name: Name,
    },
    /// `callee(arguments)`.
    Call {
        /// The called expression.
        callee: Box<Expr>,
        /// Arguments in order.
        arguments: Vec<Argument>,
    },
    /// `base[indices]`.
    Index {
        /// The indexed expression.
        base: Box<Expr>,
        /// The indices.
        indices: Vec<IndexArgument>,
    },
    /// `-x`, `not x`.
    Unary {
        /// Operator.
        op: UnaryOp,
        /// Operand.
        operand: Box<Expr>,
    },
    /// `a + b`.
    Binary {
        /// Operator.
        op: BinaryOp,
        /// Place of the operator.
        op_span: Span,
        /// Left.
        left: Box<Expr>,
        /// Right.
        right: Box<Expr>,
    },
    /// `if c then a else b`.
    If {
        /// Condition.
        condition: Box<Expr>,
        /// Value if the condition holds.
        then: Box<Expr>,
        /// Value otherwise; absent at the end of a chain over all words of a choice.
        otherwise: Option<Box<Expr>>,
    },
    /// `1..5`, `1000 rpm .. 6000 rpm by 250 rpm`, including both ends.
    Range {
        /// First.
        from: Box<Expr>,
        /// Last.
        to: Box<Expr>,
        /// Step.
        by: Option<Box<Expr>>,
    },
    /// Could not be read; the message was given.
    Error,
}

/// `value` or `name: value`.
#[derive(Clone, Debug, PartialEq)]
pub struct Argument {
    /// The name before `:`.
    pub name: Option<Name>,
    /// The value.
    pub value: Expr,
}

/// An index.
#[derive(Clone, Debug, PartialEq)]
pub enum IndexArgument {
    /// `[3]`.
    At(Expr),
    /// `[*]`: all elements.
    All(Span),
}
