//! The functions of the language: one table for the checker, elaboration and reports.
//!
//! An elementary function of one number needs its row here, its row in `system/src/elementary.rs`, and its
//! derivative in `ir/differentiate.rs`. A function of another kind also has its type in `check/builtin.rs`
//! and its evaluation in `elaborate/builtin.rs`. A number of a signal needs its row here, a variant of
//! `Reduction` with its name in `system/src/expression.rs`, and its evaluation in `src/post/operation.rs`.

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
    /// A number of a turn of the machine without forces, in lints alone.
    Turn,
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
    /// The number of a response at a frequency.
    AtFrequency,
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
    /// A derivative by a parameter.
    Gradient,
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

const fn reduction(reduction: Reduction) -> BuiltIn {
    of_results(reduction.name(), &["signal"], OfResults::Reduce(reduction))
}

/// All functions.
static FUNCTIONS: [BuiltIn; 52] = [
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
    function("largest", &["x"], Kind::Turn),
    function("smallest", &["x"], Kind::Turn),
    function("where_largest", &["x"], Kind::Turn),
    reduction(Reduction::Minimum),
    reduction(Reduction::Maximum),
    // the checker replaces `false` if the place is a time: `over` and the model decide
    reduction(Reduction::MinimumAt(false)).with(&["over"]),
    reduction(Reduction::MaximumAt(false)).with(&["over"]),
    reduction(Reduction::Mean),
    reduction(Reduction::RootMeanSquare),
    reduction(Reduction::PeakToPeak),
    of_results("amplitude", &["signal", "at"], OfResults::Amplitude).with(&["window"]),
    of_results("mode", &["column", "at"], OfResults::Mode),
    of_results("at_frequency", &["column", "at"], OfResults::AtFrequency),
    of_results("low_pass", &["signal", "to"], OfResults::Filter).with(&["butterworth"]),
    of_results("high_pass", &["signal", "from"], OfResults::Filter).with(&["butterworth"]),
    of_results("band", &["signal", "from", "to"], OfResults::Filter).with(&["butterworth"]),
    of_results("last", &["signal", "part"], OfResults::Last),
    of_results("last_cycle", &["signal"], OfResults::LastCycle).with(&["cycles"]),
    of_results("resample", &["signal", "like"], OfResults::Resample),
    of_results("decibel", &["x", "reference"], OfResults::Decibel),
    of_results("gradient", &["x", "parameter"], OfResults::Gradient),
];

/// The forms of a call and the meaning of each function.
static ABOUT: [(&str, &str, &str); 52] = [
    (
        "dot",
        "dot(a, b)",
        "the scalar product of two vectors or of components",
    ),
    (
        "cross",
        "cross(a, b)",
        "the vector product of two vectors or of components",
    ),
    (
        "norm",
        "norm(v), norm(v, floor: f)",
        "the length of a vector; with a floor it is sqrt(v·v + f²), smooth at zero and never below f. In reports: the length of a recorded vector",
    ),
    (
        "local",
        "local(v, m)",
        "the components of a vector along the axes of a marker",
    ),
    (
        "vector",
        "vector(c, m)",
        "the vector with components c along the axes of a marker",
    ),
    (
        "perpendicular",
        "perpendicular(e)",
        "[-e.y, e.x]: e turned by +90 deg",
    ),
    (
        "rotation",
        "rotation(a, b)",
        "the angle of marker a about b.z, from b.x to a.x, seen from b, counted over turns",
    ),
    (
        "der",
        "der(x)",
        "the exact time derivative of an expression of poses, states and time; only outputs may differentiate a velocity",
    ),
    ("abs", "abs(x)", "the magnitude of a number"),
    ("sqrt", "sqrt(x)", "the square root"),
    (
        "exp",
        "exp(x)",
        "the exponential function of a plain number",
    ),
    ("log", "log(x)", "the natural logarithm of a plain number"),
    (
        "sin",
        "sin(angle)",
        "the sine of an angle, or of a plain number in rad",
    ),
    (
        "cos",
        "cos(angle)",
        "the cosine of an angle, or of a plain number in rad",
    ),
    (
        "tan",
        "tan(angle)",
        "the tangent of an angle, or of a plain number in rad",
    ),
    (
        "asin",
        "asin(x)",
        "the angle whose sine is x, from -90 to 90 deg",
    ),
    (
        "acos",
        "acos(x)",
        "the angle whose cosine is x, from 0 to 180 deg",
    ),
    (
        "atan",
        "atan(x)",
        "the angle whose tangent is x, from -90 to 90 deg",
    ),
    (
        "tanh",
        "tanh(x)",
        "the hyperbolic tangent of a plain number",
    ),
    (
        "atan2",
        "atan2(y, x)",
        "the angle of the point (x, y), from -180 to 180 deg",
    ),
    (
        "wrapped",
        "wrapped(angle, period, from: -180 deg)",
        "the angle less whole periods, in [from, from + period). It jumps at the ends: a force that does not vanish there jumps",
    ),
    ("min", "min(a, b, …), min(list)", "the least of numbers"),
    ("max", "max(a, b, …), max(list)", "the largest of numbers"),
    (
        "sum",
        "sum(list)",
        "the sum of the numbers of a list; `sum(f(i) for i in 1..4)` makes the list",
    ),
    ("length", "length(list)", "the number of elements of a list"),
    (
        "distinct",
        "distinct(list)",
        "whether all numbers of a list differ",
    ),
    (
        "index_of",
        "index_of(list, value)",
        "the place of a number in a list, from 1; both are known when the model is compiled",
    ),
    (
        "slope",
        "slope(f, x)",
        "the first derivative of a table or function of one argument at x, exact; as an argument that is a function, slope(f) is the derivative",
    ),
    (
        "curvature",
        "curvature(f, x)",
        "the second derivative of a table or function of one argument at x, exact",
    ),
    (
        "period",
        "period(f)",
        "the period of a table; zero without one",
    ),
    (
        "solve",
        "solve(f, estimate)",
        "the x with f(x) = 0 near an estimate, with exact derivatives; up to three unknowns are a list",
    ),
    (
        "largest",
        "largest(x)",
        "the largest value of a quantity of positions and velocities while the machine turns through its cycle without forces; for `advise` alone",
    ),
    (
        "smallest",
        "smallest(x)",
        "the smallest value of a quantity while the machine turns through its cycle without forces; for `advise` alone",
    ),
    (
        "where_largest",
        "where_largest(x)",
        "the angle of the cycle at which a quantity is largest while the machine turns without forces; for `advise` alone",
    ),
    ("minimum", "minimum(x)", "the least sample of a signal"),
    ("maximum", "maximum(x)", "the largest sample of a signal"),
    (
        "minimum_at",
        "minimum_at(x), minimum_at(x, over: time)",
        "the cycle angle or the time of the least sample, by a parabola",
    ),
    (
        "maximum_at",
        "maximum_at(x), maximum_at(x, over: time)",
        "the cycle angle or the time of the largest sample, by a parabola",
    ),
    ("mean", "mean(x)", "the mean of a signal over time"),
    (
        "rms",
        "rms(x)",
        "the root of the mean square of a signal over time",
    ),
    (
        "peak_to_peak",
        "peak_to_peak(x)",
        "the difference of the extremes of a signal",
    ),
    (
        "amplitude",
        "amplitude(x, 2), amplitude(x, 150 Hz)",
        "the amplitude of an order or a frequency, from zero to peak",
    ),
    (
        "mode",
        "mode(column, 3), mode(column, 160 Hz)",
        "the value of a column in one mode of a linear analysis",
    ),
    (
        "at_frequency",
        "at_frequency(column, 160 Hz)",
        "the value of a column of a response at a frequency",
    ),
    (
        "low_pass",
        "low_pass(x, to), low_pass(x, to, butterworth: 4)",
        "the signal below a frequency or an order",
    ),
    (
        "high_pass",
        "high_pass(x, from), high_pass(x, from, butterworth: 4)",
        "the signal above a frequency or an order",
    ),
    (
        "band",
        "band(x, from, to), band(x, from, to, butterworth: 4)",
        "the signal between two frequencies or orders",
    ),
    (
        "last",
        "last(x, 2 rev), last(x, 10 ms)",
        "the last part of a signal",
    ),
    (
        "last_cycle",
        "last_cycle(x), last_cycle(x, cycles: 2)",
        "the last whole cycles of a signal, with their angle from 0",
    ),
    ("resample", "resample(a, like: b)", "a at the samples of b"),
    (
        "decibel",
        "decibel(v, reference: r)",
        "20 lg of the magnitude over the reference",
    ),
    (
        "gradient",
        "gradient(x, oil_temperature), gradient(x, main[*].radial_clearance)",
        "the derivative of a number or signal of motions by a parameter that the `gradients` of their analyses name",
    ),
];

/// The forms of a call and the meaning of a function, for people.
pub fn explained(name: &str) -> Option<(&'static str, &'static str)> {
    let row = ABOUT.iter().find(|(known, ..)| *known == name)?;
    Some((row.1, row.2))
}

/// The functions with their names, forms and meanings, for people.
pub fn all_explained() -> impl Iterator<Item = (&'static str, &'static str, &'static str)> {
    ABOUT.iter().copied()
}

/// The names of all functions, in the order of the table.
pub(crate) fn all_names() -> impl Iterator<Item = &'static str> {
    FUNCTIONS.iter().map(|function| function.name)
}

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
