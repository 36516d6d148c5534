//! Interpolated tables of one to three arguments, and the error of a read outside of their points.

mod corners;
mod curve;
mod grid;
mod spline;

use crate::dimension::DisplayUnit;
use crate::place::Location;
use crate::significant::short;
pub use corners::{BESIDE as POINTS_BESIDE, Corners};
pub use curve::{Curve, Extrapolation, Interpolation, TableError};
pub use grid::{Argument, End, Ends, Grid, GridError};
use std::sync::Arc;

/// The largest number of arguments of a table. A choice: a table of four has too many values to be measured.
pub const MOST_ARGUMENTS: usize = 3;

/// Within this relative distance the last argument counts as the first plus the period, and their values
/// count as equal. It allows for the rounding error of unit conversion.
const CLOSURE: f64 = 1e-9;

/// An argument may be past an end by this share of the span and still has the value of the last interval. It
/// allows for the rounding error of positions over many steps.
const PAST_END: f64 = 1e-9;

/// A table: a function by its points, evaluated with its derivatives.
///
/// Arguments and value are plain numbers here (SI, by the compiler); a derivative has the unit of the value over
/// the product of the units of its arguments. A copy shares the numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    name: String,
    shape: Shape,
    /// Place in the texts and units of the arguments, for messages.
    written: Option<(Location, Vec<DisplayUnit>)>,
}

#[derive(Clone, Debug, PartialEq)]
enum Shape {
    /// One argument.
    Curve(Arc<Curve>),
    /// Two or three arguments.
    Grid(Arc<Grid>),
}

impl Table {
    /// A table of one argument; see [`Curve::new`].
    pub fn new(
        name: impl Into<String>,
        x: Vec<f64>,
        y: Vec<f64>,
        interpolation: Interpolation,
        extrapolation: Option<Extrapolation>,
        period: Option<f64>,
    ) -> Result<Table, TableError> {
        let name = name.into();
        let curve = Curve::new(&name, x, y, interpolation, extrapolation, period)?;
        Ok(Table {
            name,
            shape: Shape::Curve(Arc::new(curve)),
            written: None,
        })
    }

    /// A table of two or three arguments; see [`Grid::new`].
    pub fn grid(
        name: impl Into<String>,
        arguments: Vec<Argument>,
        values: Vec<f64>,
    ) -> Result<Table, GridError> {
        Ok(Table {
            name: name.into(),
            shape: Shape::Grid(Arc::new(Grid::new(arguments, values)?)),
            written: None,
        })
    }

    /// Adds its place in the texts and the units of its arguments.
    pub fn written(mut self, at: Location, arguments: Vec<DisplayUnit>) -> Table {
        self.written = Some((at, arguments));
        self
    }

    /// Its place in the text, if a text states it.
    pub fn stated_at(&self) -> Option<Location> {
        self.written.as_ref().map(|(at, _)| *at)
    }

    /// Its name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Number of its arguments.
    pub fn arguments(&self) -> usize {
        match &self.shape {
            Shape::Curve(_) => 1,
            Shape::Grid(grid) => grid.arguments(),
        }
    }

    /// The unit of an argument.
    fn unit(&self, argument: usize) -> Option<&DisplayUnit> {
        self.written.as_ref()?.1.get(argument)
    }

    /// The period over an argument, if it has one.
    pub fn period(&self, argument: usize) -> Option<f64> {
        match &self.shape {
            Shape::Curve(curve) if argument == 0 => curve.period(),
            Shape::Curve(_) => None,
            Shape::Grid(grid) => grid.period(argument),
        }
    }

    /// The points of an argument at which derivatives along it, up to the order `smooth`, are not continuous.
    pub fn kinks(&self, argument: usize, smooth: u8) -> Corners<'_> {
        match &self.shape {
            Shape::Curve(curve) if argument == 0 => curve.kinks(smooth),
            Shape::Curve(_) => Corners::default(),
            Shape::Grid(grid) => grid.kinks(argument, smooth),
        }
    }

    /// The periods over its arguments that are angles (rad).
    pub fn periods_of_angles(&self) -> impl Iterator<Item = f64> + '_ {
        (0..self.arguments()).filter_map(|argument| {
            let unit = self.unit(argument)?;
            let angle = matches!(unit.symbol.as_str(), "deg" | "rad" | "rev");
            self.period(argument).filter(|_| angle)
        })
    }

    /// The value, or a derivative: `orders` counts the derivatives with respect to each argument. An order above
    /// 3 gives zero.
    ///
    /// NaN for an argument that is not finite, for an argument outside the points where no continuation is
    /// stated, and for a wrong number of arguments. An argument within a billionth of the span past an end has
    /// the value of the last interval's polynomial.
    pub fn evaluate(&self, arguments: &[f64], orders: &[u8]) -> f64 {
        match (&self.shape, arguments, orders) {
            (Shape::Curve(curve), [x], [order]) => curve.evaluate(*x, *order),
            (Shape::Curve(_), ..) => f64::NAN,
            (Shape::Grid(grid), ..) => grid.evaluate(arguments, orders),
        }
    }

    /// The error for arguments without a value.
    pub fn outside(&self, arguments: &[f64]) -> Option<Outside> {
        let (index, of, domain) = match &self.shape {
            Shape::Curve(curve) => arguments
                .first()
                .filter(|x| curve.is_outside(**x))
                .map(|_| (0, None, curve.domain()))?,
            Shape::Grid(grid) => {
                let index = grid.outside(arguments)?;
                let (name, domain) = grid.argument(index)?;
                (index, Some(name.to_owned()), domain)
            }
        };
        Some(Outside {
            name: self.name.clone(),
            of,
            argument: arguments.get(index).copied()?,
            domain,
            unit: self.unit(index).cloned(),
            at: self.stated_at(),
        })
    }
}

/// A table that is read outside its points and states no continuation.
#[derive(Clone, Debug, PartialEq)]
pub struct Outside {
    /// Table.
    pub name: String,
    /// Name of the argument, in a table of several.
    pub of: Option<String>,
    /// The value of the argument at which it is read (in its unit).
    pub argument: f64,
    /// Its first and last point.
    pub domain: (f64, f64),
    /// The display of arguments; SI if it is not known.
    pub unit: Option<DisplayUnit>,
    /// Place in the texts.
    pub at: Option<Location>,
}

impl std::fmt::Display for Outside {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (first, last) = self.domain;
        let shown = |x: f64| match &self.unit {
            Some(unit) => unit.text(x),
            None => format!("{x}"),
        };
        let (side, end) = if self.argument < first {
            ("before its first point", first)
        } else {
            ("beyond its last point", last)
        };
        write!(f, "table {} is read {side}", self.name)?;
        if let Some(of) = &self.of {
            write!(f, " of `{of}`")?;
        }
        write!(f, ": ")?;
        let (at, end_text) = (shown(self.argument), shown(end));
        if at == end_text {
            // four digits do not distinguish them
            let scale = self.unit.as_ref().map_or(1.0, |unit| unit.scale);
            let symbol = self.unit.as_ref().map_or("", |unit| unit.symbol.as_str());
            let past = (self.argument - end).abs() / scale;
            write!(f, "{} {symbol} past {end_text}", short(past, 2))?;
        } else {
            write!(f, "at {at}")?;
        }
        write!(
            f,
            "; its points go from {} to {}",
            shown(first),
            shown(last)
        )
    }
}
