//! Numbers with units, for programs that embed Eng.

use eng_compiler::program::Program;
use eng_grammar::ast::{Expr, ExprKind, UnaryOp};
use eng_grammar::{Diagnostics, SourceMap};
use eng_system::{Dimension, DisplayUnit};
use std::sync::OnceLock;

/// A value (SI) with its dimension.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quantity {
    si: f64,
    dimension: Dimension,
    /// Whether it was written in a unit with a shifted zero, such as degC. Then it is no difference.
    counted: bool,
}

/// A text that is not a number with a unit.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum QuantityError {
    /// Not of the form `12.5 mm`.
    #[error("{0:?} is not a number with a unit, such as `12.5 mm`")]
    Form(String),
    /// The unit is not in the standard library.
    #[error("there is no unit {0}")]
    Unit(String),
}

impl Quantity {
    /// A value in SI units.
    pub const fn si(value: f64, dimension: Dimension) -> Quantity {
        Quantity {
            si: value,
            dimension,
            counted: false,
        }
    }

    /// A pure number.
    pub const fn number(value: f64) -> Quantity {
        Quantity::si(value, Dimension::ONE)
    }

    /// An angle.
    pub fn degrees(value: f64) -> Quantity {
        Quantity::si(value.to_radians(), Dimension::ANGLE)
    }

    /// A time.
    pub fn seconds(value: f64) -> Quantity {
        Quantity::si(value, Dimension::TIME)
    }

    /// The value in SI units.
    pub fn value(self) -> f64 {
        self.si
    }

    /// The dimension.
    pub fn dimension(self) -> Dimension {
        self.dimension
    }

    /// Whether it was written in a unit with a shifted zero: 20 degC is a temperature and no difference of
    /// two.
    pub fn is_counted_from_a_zero(self) -> bool {
        self.counted
    }
}

/// Quantities of one dimension compare by their value. Others cannot be compared.
impl PartialOrd for Quantity {
    fn partial_cmp(&self, other: &Quantity) -> Option<std::cmp::Ordering> {
        if self.dimension != other.dimension {
            return None;
        }
        self.si.partial_cmp(&other.si)
    }
}

impl std::fmt::Display for Quantity {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if self.dimension.is_one() {
            write!(f, "{}", self.si)
        } else {
            write!(f, "{} {}", self.si, self.dimension)
        }
    }
}

/// The units of the standard library; read once.
fn standard_units() -> &'static Program {
    static UNITS: OnceLock<Program> = OnceLock::new();
    UNITS.get_or_init(|| {
        let mut sources = SourceMap::new();
        let mut diagnostics = Diagnostics::new();
        eng_compiler::resolve::resolve(
            "units",
            &crate::Sources::from_text("units", ""),
            eng_compiler::library::LIBRARY,
            &mut sources,
            &mut diagnostics,
        )
    })
}

/// A unit by its name, for many numbers in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct NamedUnit {
    scale: f64,
    offset: f64,
    dimension: Dimension,
}

impl NamedUnit {
    /// The unit of a program that a text names, such as `mm` or `N*m`; without a name the pure number.
    pub fn new(name: &str, units: &Program) -> Result<NamedUnit, QuantityError> {
        let form = || QuantityError::Unit(name.to_owned());
        let text = format!("1 {name}");
        let mut sources = SourceMap::new();
        let source = sources.add("unit", text.as_str());
        let mut diagnostics = Diagnostics::new();
        let expression = eng_grammar::parse_expression(text.trim(), source, 0, &mut diagnostics)
            .filter(|_| !diagnostics.has_errors())
            .ok_or_else(form)?;
        match expression.kind {
            ExprKind::Number { unit: None, .. } => Ok(NamedUnit {
                scale: 1.0,
                offset: 0.0,
                dimension: Dimension::ONE,
            }),
            ExprKind::Number {
                unit: Some(unit), ..
            } => {
                let unit = units.unit(&unit);
                let unit = unit.map_err(|(_, name)| QuantityError::Unit(name))?;
                Ok(NamedUnit {
                    scale: unit.scale,
                    offset: unit.offset,
                    dimension: unit.dimension,
                })
            }
            _ => Err(form()),
        }
    }

    /// The dimension.
    pub fn dimension(self) -> Dimension {
        self.dimension
    }

    /// As the unit of a column.
    pub fn display(self, name: &str) -> DisplayUnit {
        DisplayUnit {
            symbol: name.to_owned(),
            scale: self.scale,
            offset: self.offset,
        }
    }

    /// A number in this unit. It has the bits of the text `12.5 mm`.
    pub fn of(self, value: f64) -> Quantity {
        Quantity {
            counted: self.offset != 0.0,
            ..Quantity::si(value * self.scale + self.offset, self.dimension)
        }
    }
}

/// A number with a unit of the standard library: `"4000 rpm"`, `"-5 degC"`, `"0.3"`.
///
/// ```
/// let clearance: eng::Quantity = "27 um".parse()?;
/// assert!((clearance.value() - 27e-6).abs() < 1e-18);
/// assert!("27 furlong".parse::<eng::Quantity>().is_err());
/// # Ok::<(), eng::QuantityError>(())
/// ```
impl std::str::FromStr for Quantity {
    type Err = QuantityError;

    fn from_str(text: &str) -> Result<Quantity, QuantityError> {
        let form = || QuantityError::Form(text.to_owned());
        let mut sources = SourceMap::new();
        let source = sources.add("quantity", text);
        let mut diagnostics = Diagnostics::new();
        let expr = eng_grammar::parse_expression(text.trim(), source, 0, &mut diagnostics)
            .filter(|_| !diagnostics.has_errors())
            .ok_or_else(form)?;
        literal(&expr).unwrap_or_else(|| Err(form()))
    }
}

fn literal(expr: &Expr) -> Option<Result<Quantity, QuantityError>> {
    match &expr.kind {
        ExprKind::Number { value, unit, .. } => Some(match unit {
            None => Ok(Quantity::number(*value)),
            Some(unit) => match standard_units().unit(unit) {
                Ok(u) => Ok(Quantity {
                    counted: u.offset != 0.0,
                    ..Quantity::si(value * u.scale + u.offset, u.dimension)
                }),
                Err((_, name)) => Err(QuantityError::Unit(name)),
            },
        }),
        ExprKind::Unary {
            op: UnaryOp::Negate,
            operand,
        } => literal(operand).map(|r| r.map(|q| Quantity { si: -q.si, ..q })),
        _ => None,
    }
}
