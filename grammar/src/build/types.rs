//! Types and units.

use super::{Builder, MAX_DEPTH};
use crate::ast::{Name, TypeExpr, TypeExprKind, UnitExpr, UnitFactor};
use crate::codes;
use crate::diagnostic::Diagnostic;
use crate::grammar::Rule;
use crate::span::Span;
use pest::iterators::Pair;

impl<'t> Builder<'t, '_> {
    /// Of a `type_expression`.
    pub(super) fn type_expression(&mut self, pair: Pair<'t, Rule>, depth: usize) -> TypeExpr {
        let span = self.place(&pair);
        let inner: Vec<_> = pair.into_inner().collect();
        let depth = depth + inner.len();
        if depth > MAX_DEPTH {
            self.too_deep(span);
            return error(span);
        }
        let mut result = error(span);
        for part in inner {
            let place = self.place(&part);
            match part.as_rule() {
                Rule::type_product => result = self.type_product(part, depth),
                Rule::function_type => {
                    let mut types: Vec<_> = part
                        .into_inner()
                        .filter(|inner| inner.as_rule() == Rule::type_expression)
                        .map(|inner| self.type_expression(inner, depth))
                        .collect();
                    if let Some(value) = types.pop() {
                        result = TypeExpr {
                            span: place,
                            kind: TypeExprKind::Function(types, Box::new(value)),
                        };
                    }
                }
                Rule::type_array => {
                    if let Some(length) = part.into_inner().next() {
                        let length = self.expression(length, depth);
                        result = TypeExpr {
                            span: result.span.to(place),
                            kind: TypeExprKind::Array(Box::new(result), Box::new(length)),
                        };
                    }
                }
                _ => {}
            }
        }
        result
    }

    fn type_product(&mut self, pair: Pair<'t, Rule>, depth: usize) -> TypeExpr {
        let span = self.place(&pair);
        let inner: Vec<_> = pair.into_inner().collect();
        let depth = depth + inner.len();
        if depth > MAX_DEPTH {
            self.too_deep(span);
            return error(span);
        }
        let mut result: Option<TypeExpr> = None;
        let mut divide = false;
        for part in inner {
            if part.as_rule() == Rule::type_operator {
                divide = part.as_str().starts_with('/');
                continue;
            }
            let factor = self.type_power(part, depth);
            result = Some(match result {
                None => factor,
                Some(left) => TypeExpr {
                    span: left.span.to(factor.span),
                    kind: if divide {
                        TypeExprKind::Quotient(Box::new(left), Box::new(factor))
                    } else {
                        TypeExprKind::Product(Box::new(left), Box::new(factor))
                    },
                },
            });
        }
        result.unwrap_or_else(|| error(span))
    }

    fn type_power(&mut self, pair: Pair<'t, Rule>, depth: usize) -> TypeExpr {
        let span = self.place(&pair);
        let mut result = error(span);
        for part in pair.into_inner() {
            let place = self.place(&part);
            match part.as_rule() {
                Rule::name => {
                    result = TypeExpr {
                        span: place,
                        kind: TypeExprKind::Name(self.name(&part)),
                    };
                }
                Rule::type_one => {
                    result = TypeExpr {
                        span: place,
                        kind: TypeExprKind::One,
                    };
                }
                Rule::type_generic => {
                    let mut inner = part.into_inner();
                    let name = self.next_name(&mut inner);
                    let types = inner
                        .filter(|inner| inner.as_rule() == Rule::type_expression)
                        .map(|inner| self.type_expression(inner, depth + 1))
                        .collect();
                    result = TypeExpr {
                        span: place,
                        kind: TypeExprKind::Generic(name, types),
                    };
                }
                Rule::type_paren => {
                    if let Some(inner) = part.into_inner().next() {
                        result = self.type_expression(inner, depth + 1);
                        result.span = place;
                    }
                }
                Rule::exponent => {
                    let (numerator, denominator) = self.exponent(part);
                    result = TypeExpr {
                        span,
                        kind: TypeExprKind::Power(Box::new(result), numerator, denominator),
                    };
                }
                _ => {}
            }
        }
        result
    }

    /// Numerator and positive denominator in lowest terms.
    pub(super) fn exponent(&mut self, pair: Pair<'t, Rule>) -> (i32, i32) {
        let span = self.place(&pair);
        let mut numbers = pair.into_inner().map(|part| part.as_str().parse::<i16>());
        let numerator = numbers.next().unwrap_or(Ok(1));
        let denominator = numbers.next().unwrap_or(Ok(1));
        match (numerator, denominator) {
            (Ok(numerator), Ok(denominator)) if denominator != 0 => {
                ratio(i32::from(numerator), i32::from(denominator))
            }
            _ => {
                self.report(
                    Diagnostic::error(codes::NUMBER, "this exponent cannot be used")
                        .at(span, "too large, or a division by zero")
                        .with_help("an exponent is a whole number or a ratio: `m^2`, `m^(1/2)`"),
                );
                (1, 1)
            }
        }
    }

    /// The factors of a `unit` or a `display_unit`.
    pub(crate) fn unit(&mut self, pair: Pair<'t, Rule>, depth: usize) -> UnitExpr {
        let span = self.place(&pair);
        self.unit_of(pair.into_inner(), span, depth)
    }

    /// A unit of factors and signs.
    pub(super) fn unit_of(
        &mut self,
        parts: impl IntoIterator<Item = Pair<'t, Rule>>,
        span: Span,
        depth: usize,
    ) -> UnitExpr {
        let mut factors = Vec::new();
        self.unit_factors(parts, span, (1, 1), depth, &mut factors);
        UnitExpr { span, factors }
    }

    /// Appends the factors of a product to the power `outer`.
    fn unit_factors(
        &mut self,
        parts: impl IntoIterator<Item = Pair<'t, Rule>>,
        span: Span,
        outer: (i32, i32),
        depth: usize,
        factors: &mut Vec<UnitFactor>,
    ) {
        if depth > MAX_DEPTH {
            self.too_deep(span);
            return;
        }
        let mut sign = 1;
        for part in parts {
            match part.as_rule() {
                Rule::unit_operator => sign = if part.as_str() == "/" { -1 } else { 1 },
                Rule::unit => self.unit_factors(part.into_inner(), span, outer, depth + 1, factors),
                Rule::unit_factor => {
                    let mut name: Option<Name> = None;
                    let mut group = None;
                    let mut power = (1, 1);
                    for inner in part.into_inner() {
                        match inner.as_rule() {
                            Rule::unit_name => name = Some(self.name(&inner)),
                            Rule::unit => group = Some(inner),
                            Rule::exponent => power = self.exponent(inner),
                            _ => {}
                        }
                    }
                    let exponent = self.power_of_power(outer, (sign * power.0, power.1), span);
                    if let Some(name) = name {
                        factors.push(UnitFactor {
                            name,
                            numerator: exponent.0,
                            denominator: exponent.1,
                        });
                    } else if let Some(group) = group {
                        let inside = self.place(&group);
                        self.unit_factors(group.into_inner(), inside, exponent, depth + 1, factors);
                    }
                }
                _ => {}
            }
        }
    }

    fn power_of_power(&mut self, outer: (i32, i32), inner: (i32, i32), span: Span) -> (i32, i32) {
        let product = outer
            .0
            .checked_mul(inner.0)
            .zip(outer.1.checked_mul(inner.1));
        match product {
            Some((numerator, denominator)) => ratio(numerator, denominator),
            None => {
                self.report(
                    Diagnostic::error(codes::NUMBER, "this exponent cannot be used")
                        .at(span, "the powers multiply to a number that is too large"),
                );
                (1, 1)
            }
        }
    }
}

fn error(span: Span) -> TypeExpr {
    TypeExpr {
        span,
        kind: TypeExprKind::Error,
    }
}

/// In lowest terms; the denominator is positive and not zero.
fn ratio(numerator: i32, denominator: i32) -> (i32, i32) {
    let (mut a, mut b) = (numerator.unsigned_abs(), denominator.unsigned_abs());
    while b != 0 {
        (a, b) = (b, a % b);
    }
    let divisor = i32::try_from(a.max(1)).unwrap_or(1);
    (numerator / divisor, denominator / divisor)
}
