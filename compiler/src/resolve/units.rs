//! The tables of dimensions and units, in the order of their definitions.

use super::definitions::{Definitions, Looked};
use super::suggest::{EXPLAINED, nearest};
use crate::codes;
use crate::program::{NamedDimension, Program, Unit, unit_text};
use eng_grammar::ast::{
    BinaryOp, DimensionItem, Expr, ExprKind, ItemKind, Name, TypeExpr, TypeExprKind, UnaryOp,
    UnitExpr, UnitItem,
};
use eng_grammar::{Diagnostic, Diagnostics};
use eng_system::Dimension;
use std::collections::BTreeMap;

/// The base dimensions in storage order, with the names that a library may give them.
const BASES: [&[&str]; eng_system::dimension::BASES] = [
    &["Length"],
    &["Mass"],
    &["Time"],
    &["Current", "ElectricCurrent"],
    &["TemperatureDifference"],
    &["Amount", "AmountOfSubstance"],
    &["LuminousIntensity"],
    &["Angle"],
];

struct Dimensions<'a> {
    definitions: Definitions<DimensionItem, NamedDimension>,
    diagnostics: &'a mut Diagnostics,
}

pub(super) fn dimensions(program: &mut Program, diagnostics: &mut Diagnostics) {
    let mut items: BTreeMap<String, DimensionItem> = BTreeMap::new();
    for module in &program.modules {
        for item in &module.file.items {
            if let ItemKind::Dimension(dimension) = &item.kind {
                match items.get(&dimension.name.text) {
                    // a repetition in one file is reported with the scopes
                    Some(first) if first.name.span.source != dimension.name.span.source => {
                        twice("dimension", &first.name, &dimension.name, diagnostics);
                    }
                    Some(_) => {}
                    None => {
                        items.insert(dimension.name.text.clone(), dimension.clone());
                    }
                }
            }
        }
    }
    let mut table = Dimensions {
        definitions: Definitions::new(items),
        diagnostics,
    };
    for name in table.definitions.names() {
        table.named(&name);
    }
    program.dimensions.extend(table.definitions.known());
}

fn twice(what: &str, first: &Name, again: &Name, diagnostics: &mut Diagnostics) {
    diagnostics.push(
        Diagnostic::error(
            codes::DEFINED_TWICE,
            format!("the {what} `{}` is defined twice", again.text),
        )
        .at(again.span, "again here")
        .also(first.span, "first here")
        .with_help(format!("a {what} has one meaning in a whole program")),
    );
}

/// Reports a name without a definition, with the nearest name that has one, unless there are many messages.
fn unknown<N: Into<String>>(
    code: &'static str,
    what: &str,
    name: &Name,
    near: impl FnOnce() -> Option<N>,
    diagnostics: &mut Diagnostics,
) {
    let near = (diagnostics.len() <= EXPLAINED).then(near).flatten();
    let title = format!("there is no {what} `{}`", name.text);
    let message = Diagnostic::error(code, title).at(name.span, "not known");
    diagnostics.push(message.meant_if(name.span, near));
}

impl Dimensions<'_> {
    fn named(&mut self, name: &str) -> Option<NamedDimension> {
        let item = match self.definitions.begin(name, self.diagnostics) {
            Looked::Known(known) => return known,
            Looked::New(item) => item,
        };
        let result = self.evaluate(&item);
        self.definitions.end(name, result)
    }

    fn evaluate(&mut self, item: &DimensionItem) -> Option<NamedDimension> {
        let Some(definition) = &item.definition else {
            let base = BASES
                .iter()
                .position(|names| names.contains(&item.name.text.as_str()));
            let Some(base) = base else {
                self.diagnostics.push(
                    Diagnostic::error(
                        codes::BAD_UNIT,
                        format!("`{}` is no base dimension", item.name.text),
                    )
                    .at(item.name.span, "has no definition")
                    .with_note(
                        "the base dimensions are Length, Mass, Time, Current, TemperatureDifference, Amount, \
                         LuminousIntensity and Angle",
                    )
                    .with_help("define it by these, for instance `dimension Force = Mass*Acceleration`"),
                );
                return None;
            };
            return Some(NamedDimension {
                dimension: Dimension::base(base),
                point_of: None,
            });
        };
        let dimension = self.expression(definition)?;
        if !item.point {
            return Some(NamedDimension {
                dimension,
                point_of: None,
            });
        }
        let TypeExprKind::Name(of) = &definition.kind else {
            self.diagnostics.push(
                Diagnostic::error(
                    codes::BAD_UNIT,
                    "a point dimension needs the name of its difference",
                )
                .at(definition.span, "not a name")
                .with_help("for instance `dimension Temperature = point TemperatureDifference`"),
            );
            return None;
        };
        Some(NamedDimension {
            dimension,
            point_of: Some(of.text.clone()),
        })
    }

    fn expression(&mut self, expr: &TypeExpr) -> Option<Dimension> {
        match &expr.kind {
            TypeExprKind::One => Some(Dimension::ONE),
            TypeExprKind::Name(name) => {
                if self.definitions.contains(&name.text) {
                    return self.named(&name.text).map(|named| named.dimension);
                }
                let near = || self.definitions.nearest(&name.text);
                unknown(
                    codes::UNKNOWN_TYPE,
                    "dimension",
                    name,
                    near,
                    self.diagnostics,
                );
                None
            }
            TypeExprKind::Product(left, right) => {
                let (left, right) = (self.expression(left), self.expression(right));
                Some(left?.times(right?))
            }
            TypeExprKind::Quotient(left, right) => {
                let (left, right) = (self.expression(left), self.expression(right));
                Some(left?.over(right?))
            }
            TypeExprKind::Power(base, numerator, denominator) => {
                let power = self.expression(base)?.power(*numerator, *denominator);
                if power.is_none() {
                    self.bad(expr, "this power is not one of a dimension");
                }
                power
            }
            TypeExprKind::Error => None,
            TypeExprKind::Generic(..) | TypeExprKind::Array(..) | TypeExprKind::Function(..) => {
                self.bad(expr, "a dimension is a product of dimensions");
                None
            }
        }
    }

    fn bad(&mut self, expr: &TypeExpr, text: &str) {
        self.diagnostics
            .push(Diagnostic::error(codes::BAD_UNIT, text).at(expr.span, "not a dimension"));
    }
}

/// A number with a dimension, in SI.
#[derive(Clone, Copy)]
struct Size {
    value: f64,
    dimension: Dimension,
}

struct Units<'a> {
    definitions: Definitions<UnitItem, Unit>,
    dimensions: &'a BTreeMap<String, NamedDimension>,
    diagnostics: &'a mut Diagnostics,
}

pub(super) fn units(program: &mut Program, diagnostics: &mut Diagnostics) {
    let mut items: BTreeMap<String, UnitItem> = BTreeMap::new();
    for module in &program.modules {
        for item in &module.file.items {
            if let ItemKind::Unit(unit) = &item.kind {
                if let Some(first) = items.get(&unit.name.text) {
                    twice("unit", &first.name, &unit.name, diagnostics);
                } else {
                    items.insert(unit.name.text.clone(), unit.clone());
                }
            }
        }
    }
    let mut table = Units {
        definitions: Definitions::new(items),
        dimensions: &program.dimensions,
        diagnostics,
    };
    for name in table.definitions.names() {
        table.named(&name);
    }
    let known = table.definitions.known();
    program.units.extend(known);
}

impl Units<'_> {
    fn named(&mut self, name: &str) -> Option<Unit> {
        let item = match self.definitions.begin(name, self.diagnostics) {
            Looked::Known(known) => return known,
            Looked::New(item) => item,
        };
        let result = self.evaluate(&item);
        self.definitions.end(name, result)
    }

    /// The declared dimension and, if it is a point, its name.
    fn declared(&mut self, ty: &TypeExpr) -> Option<(Dimension, Option<String>)> {
        if let TypeExprKind::Name(name) = &ty.kind {
            let Some(named) = self.dimensions.get(&name.text) else {
                let near = || nearest(&name.text, self.dimensions.keys().map(String::as_str));
                unknown(
                    codes::UNKNOWN_TYPE,
                    "dimension",
                    name,
                    near,
                    self.diagnostics,
                );
                return None;
            };
            let point = named.point_of.is_some().then(|| name.text.clone());
            return Some((named.dimension, point));
        }
        let dimension = product_of(ty, self.dimensions);
        if dimension.is_none() && !matches!(ty.kind, TypeExprKind::Error) {
            self.bad(ty.span, "this is not a dimension");
        }
        Some((dimension?, None))
    }

    fn bad(&mut self, span: eng_grammar::Span, text: impl Into<String>) {
        self.diagnostics.push(
            Diagnostic::error(codes::BAD_UNIT, text.into())
                .at(span, "cannot be a unit's size")
                .with_help(
                    "a unit is defined by another one, `unit mm = 1e-3 m`, or is the first of its dimension, `unit m: Length`",
                ),
        );
    }

    fn evaluate(&mut self, item: &UnitItem) -> Option<Unit> {
        let symbol = item.name.text.clone();
        let declared = match &item.dimension {
            Some(ty) => Some(self.declared(ty)?),
            None => None,
        };
        let Some(definition) = &item.definition else {
            let Some((dimension, point)) = declared else {
                self.bad(
                    item.name.span,
                    format!("the unit `{symbol}` has neither size nor dimension"),
                );
                return None;
            };
            return Some(Unit {
                symbol,
                scale: 1.0,
                offset: 0.0,
                dimension,
                point,
            });
        };
        let size = self.size(definition, declared.as_ref().map(|(d, _)| *d))?;
        if !(size.value.is_finite() && size.value > 0.0) {
            self.bad(
                definition.span,
                format!("the size of the unit `{symbol}` is not a positive number"),
            );
            return None;
        }
        if let Some((dimension, _)) = &declared
            && *dimension != size.dimension
        {
            self.bad(
                definition.span,
                format!(
                    "the unit `{symbol}` is declared with the dimension {dimension}, but its size has {}",
                    size.dimension
                ),
            );
            return None;
        }
        let point = declared.and_then(|(_, point)| point);
        let offset = match &item.offset {
            None => 0.0,
            Some(offset) => {
                if point.is_none() {
                    self.bad(
                        offset.span,
                        format!("the unit `{symbol}` has a shifted zero, but is no unit of points"),
                    );
                    return None;
                }
                let zero = self.size(offset, Some(size.dimension))?;
                if zero.dimension != size.dimension {
                    self.bad(
                        offset.span,
                        format!(
                            "the zero of the unit `{symbol}` has another dimension than its size"
                        ),
                    );
                    return None;
                }
                zero.value
            }
        };
        Some(Unit {
            symbol,
            scale: size.value,
            offset,
            dimension: size.dimension,
            point,
        })
    }

    /// The size of a definition. In `pi/180 rad` and `2*pi/60 rad/s` the unit at the end belongs to the whole
    /// number. If this does not give the declared dimension, the usual rule holds (`1/2 s` is 1/(2 s)).
    fn size(&mut self, expr: &Expr, declared: Option<Dimension>) -> Option<Size> {
        if let ExprKind::Binary {
            op: BinaryOp::Divide,
            left,
            right,
            ..
        } = &expr.kind
            && let ExprKind::Number {
                value,
                unit: Some(unit),
                ..
            } = &right.kind
        {
            let left = self.expression(left)?;
            let of = self.unit(unit)?;
            let common = Size {
                value: left.value / (value * of.value),
                dimension: left.dimension.over(of.dimension),
            };
            let whole = Size {
                value: left.value / value * of.value,
                dimension: left.dimension.times(of.dimension),
            };
            let as_read = match declared {
                Some(declared) => declared == whole.dimension,
                None => left.dimension.is_one() && *value != 1.0,
            };
            return Some(if as_read { whole } else { common });
        }
        self.expression(expr)
    }

    fn unit(&mut self, expr: &UnitExpr) -> Option<Size> {
        let mut size = Size {
            value: 1.0,
            dimension: Dimension::ONE,
        };
        for factor in &expr.factors {
            if !self.definitions.contains(&factor.name.text) {
                let name = &factor.name;
                let near = || self.definitions.nearest(&name.text);
                unknown(codes::UNKNOWN_UNIT, "unit", name, near, self.diagnostics);
                return None;
            }
            let unit = self.named(&factor.name.text)?;
            if unit.offset != 0.0 {
                self.bad(
                    expr.span,
                    format!(
                        "the unit `{}` has a shifted zero: no other unit can be defined by it",
                        unit.symbol
                    ),
                );
                return None;
            }
            let Some(dimension) = unit.dimension.power(factor.numerator, factor.denominator) else {
                self.bad(expr.span, format!("`{}` is not a unit", unit_text(expr)));
                return None;
            };
            size.value *= power(unit.scale, factor.numerator, factor.denominator);
            size.dimension = size.dimension.times(dimension);
        }
        Some(size)
    }

    fn expression(&mut self, expr: &Expr) -> Option<Size> {
        match &expr.kind {
            ExprKind::Number { value, unit, .. } => {
                let unit = match unit {
                    Some(unit) => self.unit(unit)?,
                    None => Size {
                        value: 1.0,
                        dimension: Dimension::ONE,
                    },
                };
                Some(Size {
                    value: value * unit.value,
                    dimension: unit.dimension,
                })
            }
            ExprKind::Name(name) if name == "pi" => Some(Size {
                value: std::f64::consts::PI,
                dimension: Dimension::ONE,
            }),
            ExprKind::Paren { inner, unit } => {
                let mut size = self.expression(inner)?;
                if let Some(unit) = unit {
                    let unit = self.unit(unit)?;
                    size.value *= unit.value;
                    size.dimension = size.dimension.times(unit.dimension);
                }
                Some(size)
            }
            ExprKind::Unary {
                op: UnaryOp::Negate,
                operand,
            } => {
                let size = self.expression(operand)?;
                Some(Size {
                    value: -size.value,
                    dimension: size.dimension,
                })
            }
            ExprKind::Binary {
                op: BinaryOp::Multiply,
                left,
                right,
                ..
            } => {
                let (left, right) = (self.expression(left), self.expression(right));
                let (left, right) = (left?, right?);
                Some(Size {
                    value: left.value * right.value,
                    dimension: left.dimension.times(right.dimension),
                })
            }
            ExprKind::Binary {
                op: BinaryOp::Divide,
                left,
                right,
                ..
            } => {
                let (left, right) = (self.expression(left), self.expression(right));
                let (left, right) = (left?, right?);
                Some(Size {
                    value: left.value / right.value,
                    dimension: left.dimension.over(right.dimension),
                })
            }
            ExprKind::Error => None,
            _ => {
                self.bad(
                    expr.span,
                    "the size of a unit is a product of numbers and units",
                );
                None
            }
        }
    }
}

/// A rational power. Whole exponents use multiplication, so that the square of 1e-3 has the same bits as the
/// written product.
fn power(base: f64, numerator: i32, denominator: i32) -> f64 {
    if denominator != 1 {
        return libm::pow(base, f64::from(numerator) / f64::from(denominator));
    }
    let whole = (0..numerator.unsigned_abs()).fold(1.0, |product, _| product * base);
    if numerator < 0 { 1.0 / whole } else { whole }
}

/// The dimension of a type that is a product of dimensions.
fn product_of(ty: &TypeExpr, dimensions: &BTreeMap<String, NamedDimension>) -> Option<Dimension> {
    match &ty.kind {
        TypeExprKind::One => Some(Dimension::ONE),
        TypeExprKind::Name(name) => dimensions.get(&name.text).map(|named| named.dimension),
        TypeExprKind::Product(left, right) => {
            Some(product_of(left, dimensions)?.times(product_of(right, dimensions)?))
        }
        TypeExprKind::Quotient(left, right) => {
            Some(product_of(left, dimensions)?.over(product_of(right, dimensions)?))
        }
        TypeExprKind::Power(base, numerator, denominator) => {
            product_of(base, dimensions)?.power(*numerator, *denominator)
        }
        TypeExprKind::Generic(..)
        | TypeExprKind::Array(..)
        | TypeExprKind::Function(..)
        | TypeExprKind::Error => None,
    }
}
