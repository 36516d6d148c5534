//! Interpolated tables of one argument.

/// How values between the points are found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Interpolation {
    /// Cubic spline, C² (natural ends, or periodic).
    Cubic,
    /// Monotone cubic (Fritsch–Carlson), C¹: no overshoot.
    Monotone,
}

/// What happens outside the range.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Extrapolation {
    /// The end value and zero slope.
    Hold,
    /// The end value and end slope.
    Linear,
}

/// A table of one argument: piecewise cubic, evaluated with its derivatives.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    name: String,
    x: Vec<f64>,
    /// Coefficients of each interval in powers of (x − x_i).
    coefficients: Vec<[f64; 4]>,
    period: Option<f64>,
    extrapolation: Extrapolation,
}

/// A table that cannot be built.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TableError {
    /// Fewer than two points.
    #[error("table {name} has {count} points; at least 2 are needed")]
    TooFew {
        /// Table.
        name: String,
        /// Points.
        count: usize,
    },
    /// Arguments do not rise.
    #[error(
        "table {name}: the argument does not rise at row {row}: {before} is followed by {after}"
    )]
    NotRising {
        /// Table.
        name: String,
        /// Row, from 1.
        row: usize,
        /// Argument before.
        before: f64,
        /// Argument there.
        after: f64,
    },
    /// A value is not finite.
    #[error("table {name}: row {row} is not a finite number")]
    NotFinite {
        /// Table.
        name: String,
        /// Row, from 1.
        row: usize,
    },
    /// First and last value differ although they are the same point of the period.
    #[error(
        "table {name}: the period closes at row {row}, but the values differ: {first} and {last}"
    )]
    NotPeriodic {
        /// Table.
        name: String,
        /// Row, from 1.
        row: usize,
        /// First value.
        first: f64,
        /// Last value.
        last: f64,
    },
    /// The points span more than a period.
    #[error("table {name}: the points span {span}, more than the period {period}")]
    PeriodTooShort {
        /// Table.
        name: String,
        /// Span of the arguments.
        span: f64,
        /// Period.
        period: f64,
    },
}
