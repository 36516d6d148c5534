//! The functions of the language: one table for the checker, elaboration and reports.
//!
//! An elementary function of one number needs its row here, its row in `system/src/elementary.rs`, and its derivative in
//! `ir/differentiate.rs`. A function of another kind also has its type in
//! `check/builtin.rs` and its evaluation in `elaborate/builtin.rs`. A number of a signal needs its row here,
//! a variant of `Reduction` in `system/src/expression.rs` and its evaluation in `src/post/operation.rs`.

use eng_system::elementary::Elementary;
use eng_system::expression::{Function, Operator, Reduction};

/// A function of the language.
#[derive(Debug)]
pub(crate) struct BuiltIn {
    pub name: &'static str,
    /// Names of the parameters that take arguments by place.
    pub parameters: &'static [&'static str],
    /// Whether more arguments by place may follow.
    pub more: bool,
    /// Names of the parameters that take an argument by name, or none.
    pub options: &'static [&'static str],
    pub kind: Kind,
    pub results: OfResults,
}

/// The kind of a function: its arguments and its result.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Kind {
    /// From a plain number to a plain number.
    Plain(Elementary),
    /// From an angle (rad) or a plain number to a plain number.
    OfAngle(Elementary),
    /// From a plain number to an angle (rad).
    ToAngle(Elementary),
    /// Numbers of any dimension.
    Numbers,
    /// Vectors, components and markers.
    Vectors,
    /// The numbers of a list.
    List,
    /// A function of one argument, and its argument.
    Functions,
    /// The time derivative.
    Rate,
    /// A function of results, in reports alone.
    Results,
}

/// The meaning of a function in reports.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum OfResults {
    /// None: reports do not have the function.
    Nothing,
    /// Its value at each number of a signal.
    Each(Function),
    /// One signal or number of several.
    Fold(Operator),
    /// The length of a recorded vector.
    Length,
    /// A number of a signal.
    Reduce(Reduction),
    /// The amplitude of an order or a frequency of a signal.
    Amplitude,
    /// The number of one mode.
    Mode,
    /// A band of a signal.
    Filter,
    /// The last part of a signal.
    Last,
    /// The last cycles of a signal.
    LastCycle,
    /// A signal at the samples of another.
    Resample,
    /// A level.
    Decibel,
}

impl BuiltIn {
    /// Adds the meaning in reports.
    const fn of(mut self, results: OfResults) -> BuiltIn {
        self.results = results;
        self
    }

    /// Adds parameters that take an argument by name.
    const fn with(mut self, options: &'static [&'static str]) -> BuiltIn {
        self.options = options;
        self
    }

    /// Allows further arguments by place.
    const fn and_more(mut self) -> BuiltIn {
        self.more = true;
        self
    }

    /// Whether it takes the modes of a linear analysis as well as samples of a run.
    pub fn takes_modes(&self) -> bool {
        match self.results {
            OfResults::Each(_) | OfResults::Fold(_) | OfResults::Mode | OfResults::Decibel => true,
            OfResults::Reduce(reduction) => matches!(
                reduction,
                Reduction::Minimum | Reduction::Maximum | Reduction::PeakToPeak
            ),
            _ => false,
        }
    }
}

const fn function(name: &'static str, parameters: &'static [&'static str], kind: Kind) -> BuiltIn {
    BuiltIn {
        name,
        parameters,
        more: false,
        options: &[],
        kind,
        results: OfResults::Nothing,
    }
}

/// An elementary function that reports have too.
const fn elementary(function_of: Elementary, kind: Kind) -> BuiltIn {
    function(function_of.name(), &["x"], kind)
        .of(OfResults::Each(Function::Elementary(function_of)))
}

/// A function that only reports have.
const fn of_results(
    name: &'static str,
    parameters: &'static [&'static str],
    results: OfResults,
) -> BuiltIn {
    function(name, parameters, Kind::Results).of(results)
}

const fn reduction(name: &'static str, reduction: Reduction) -> BuiltIn {
    of_results(name, &["signal"], OfResults::Reduce(reduction))
}

/// All functions.
static FUNCTIONS: [BuiltIn; 47] = [
    function("dot", &["a", "b"], Kind::Vectors),
    function("cross", &["a", "b"], Kind::Vectors),
    function("norm", &["v"], Kind::Vectors)
        .with(&["floor"])
        .of(OfResults::Length),
    function("local", &["v", "m"], Kind::Vectors),
    function("vector", &["c", "m"], Kind::Vectors),
    function("perpendicular", &["v"], Kind::Vectors),
    function("rotation", &["a", "b"], Kind::Vectors),
    function("der", &["x"], Kind::Rate),
    function("abs", &["x"], Kind::Numbers).of(OfResults::Each(Function::Abs)),
    function("sqrt", &["x"], Kind::Numbers).of(OfResults::Each(Function::Sqrt)),
    elementary(Elementary::Exp, Kind::Plain(Elementary::Exp)),
    elementary(Elementary::Log, Kind::Plain(Elementary::Log)),
    elementary(Elementary::Sin, Kind::OfAngle(Elementary::Sin)),
    elementary(Elementary::Cos, Kind::OfAngle(Elementary::Cos)),
    elementary(Elementary::Tan, Kind::OfAngle(Elementary::Tan)),
    function("asin", &["x"], Kind::ToAngle(Elementary::Asin)),
    function("acos", &["x"], Kind::ToAngle(Elementary::Acos)),
    function("atan", &["x"], Kind::ToAngle(Elementary::Atan)),
    function("tanh", &["x"], Kind::Plain(Elementary::Tanh)),
    function("atan2", &["y", "x"], Kind::Numbers),
    function("wrapped", &["angle", "period"], Kind::Numbers).with(&["from"]),
    function("min", &["x"], Kind::List)
        .and_more()
        .of(OfResults::Fold(Operator::Minimum)),
    function("max", &["x"], Kind::List)
        .and_more()
        .of(OfResults::Fold(Operator::Maximum)),
    function("sum", &["x"], Kind::List).of(OfResults::Fold(Operator::Add)),
    function("length", &["v"], Kind::List),
    function("distinct", &["v"], Kind::List),
    function("index_of", &["list", "value"], Kind::List),
    function("slope", &["f", "x"], Kind::Functions),
    function("curvature", &["f", "x"], Kind::Functions),
    function("period", &["f"], Kind::Functions),
    function("solve", &["f", "estimate"], Kind::Functions),
    reduction("minimum", Reduction::Minimum),
    reduction("maximum", Reduction::Maximum),
    // the checker replaces `false` if the place is a time: `over` and the model decide
    reduction("minimum_at", Reduction::MinimumAt(false)).with(&["over"]),
    reduction("maximum_at", Reduction::MaximumAt(false)).with(&["over"]),
    reduction("mean", Reduction::Mean),
    reduction("rms", Reduction::RootMeanSquare),
    reduction("peak_to_peak", Reduction::PeakToPeak),
    of_results("amplitude", &["signal", "at"], OfResults::Amplitude).with(&["window"]),
    of_results("mode", &["column", "at"], OfResults::Mode),
    of_results("low_pass", &["signal", "to"], OfResults::Filter).with(&["butterworth"]),
    of_results("high_pass", &["signal", "from"], OfResults::Filter).with(&["butterworth"]),
    of_results("band", &["signal", "from", "to"], OfResults::Filter).with(&["butterworth"]),
    of_results("last", &["signal", "part"], OfResults::Last),
    of_results("last_cycle", &["signal"], OfResults::LastCycle).with(&["cycles"]),
    of_results("resample", &["signal", "like"], OfResults::Resample),
    of_results("decibel", &["x", "reference"], OfResults::Decibel),
];

/// The function with a name, if any expression can call it.
pub(crate) fn find(name: &str) -> Option<&'static BuiltIn> {
    everywhere().find(|function| function.name == name)
}

/// The names of the functions that any expression can call.
pub(crate) fn names() -> impl Iterator<Item = &'static str> {
    everywhere().map(|function| function.name)
}

fn everywhere() -> impl Iterator<Item = &'static BuiltIn> {
    FUNCTIONS
        .iter()
        .filter(|function| !matches!(function.kind, Kind::Results))
}

/// The functions that reports have.
pub(crate) fn of_reports() -> impl Iterator<Item = &'static BuiltIn> {
    FUNCTIONS
        .iter()
        .filter(|function| function.results != OfResults::Nothing)
}

/// Whether only reports have the function or the figure of a name.
pub(crate) fn only_of_reports(name: &str) -> bool {
    let mut functions = of_reports().filter(|f| matches!(f.kind, Kind::Results));
    functions.any(|f| f.name == name) || eng_system::figure::kind(name).is_some()
}
