//! The end of a unit: a word that is not a unit ends it, and is the next factor.
//!
//! `2e6 N/m*depth^2` is the quantity 2e6 N/m, times `depth^2`. The grammar takes every word without blanks for a
//! unit, because the units belong to the whole program. So this module makes the factors of the pairs that the
//! recogniser found inside of the unit.

use super::Builder;
use super::expressions::{Part, error};
use crate::ast::{BinaryOp, Expr, ExprKind, UnaryOp, UnitExpr};
use crate::grammar::Rule;
use crate::span::Span;
use pest::iterators::Pair;

impl<'t> Builder<'t, '_> {
    /// The unit at the beginning of a `unit`. The factors from the first one that is no unit are kept for the chain of
    /// operators around the value. A first word that is no unit stays a unit, so that its message is about units.
    pub(super) fn unit_and_factors(&mut self, pair: Pair<'t, Rule>, depth: usize) -> UnitExpr {
        let whole = self.place(&pair);
        let parts: Vec<_> = pair.clone().into_inner().collect();
        if let (Some(is_unit), true) = (self.is_unit, parts.len() > 1) {
            let words = pair.clone().into_inner().flatten();
            let words = words.filter(|inner| inner.as_rule() == Rule::unit_name);
            let unknown = words
                .map(|word| word.as_str())
                .filter(|word| !is_unit(word));
            self.unknown_units.extend(unknown.map(str::to_owned));
        }
        let Some(end) = self.end_of_unit(&parts) else {
            return self.unit(pair, depth);
        };
        let mut parts = parts.into_iter();
        let unit_parts: Vec<_> = parts.by_ref().take(end).collect();
        let last = unit_parts.last().map_or(whole, |part| self.place(part));
        let span = Span::new(whole.source, whole.start as usize, last.end as usize);
        let unit = self.unit_of(unit_parts, span, depth);
        let mut factors = Vec::new();
        self.factor_parts(parts, depth, &mut factors);
        self.factors = factors;
        unit
    }

    /// The place, among the parts of a `unit`, of the sign before the first factor that is no unit.
    fn end_of_unit(&self, parts: &[Pair<'t, Rule>]) -> Option<usize> {
        let (first, others) = parts.split_first()?;
        let no_unit =
            |part: &Pair<'t, Rule>| part.as_rule() == Rule::unit_factor && !self.is_of_units(part);
        // signs and factors alternate, so the place without the first part is that of the sign
        others.iter().position(no_unit).filter(|_| !no_unit(first))
    }

    /// The number of operators that the factors after the unit of a `postfix` make.
    pub(super) fn operators_behind_unit(&self, postfix: &Pair<'t, Rule>) -> usize {
        let first = postfix.clone().into_inner().next();
        let after = first.and_then(|value| super::child(&value, Rule::unit_after));
        let unit = after.and_then(|after| super::child(&after, Rule::unit));
        let Some(unit) = unit else {
            return 0;
        };
        let parts: Vec<_> = unit.clone().into_inner().collect();
        let counts =
            |pair: &Pair<'t, Rule>| matches!(pair.as_rule(), Rule::unit_operator | Rule::exponent);
        match self.end_of_unit(&parts) {
            Some(_) => unit.into_inner().flatten().filter(counts).count(),
            None => 0,
        }
    }

    /// Whether all words of a `unit_factor` or `unit` are units.
    fn is_of_units(&self, pair: &Pair<'t, Rule>) -> bool {
        let Some(is_unit) = self.is_unit else {
            return true;
        };
        let words = pair.clone().into_inner().flatten();
        let mut words = words.filter(|inner| inner.as_rule() == Rule::unit_name);
        words.all(|word| is_unit(word.as_str()))
    }

    /// The signs and values of factors of a `unit`, in their order.
    fn factor_parts(
        &mut self,
        pairs: impl Iterator<Item = Pair<'t, Rule>>,
        depth: usize,
        parts: &mut Vec<Part<'t>>,
    ) {
        for pair in pairs {
            let span = self.place(&pair);
            if pair.as_rule() == Rule::unit_operator {
                let sign = if pair.as_str() == "/" { "/" } else { "*" };
                parts.push(Part::Sign(sign, span));
                continue;
            }
            for inner in pair.into_inner() {
                let span = self.place(&inner);
                match inner.as_rule() {
                    Rule::unit_name => {
                        let kind = ExprKind::Name(inner.as_str().to_owned());
                        parts.push(Part::Factor(Expr { span, kind }));
                    }
                    Rule::unit => {
                        let value = self.product_of_factors(inner, depth + 1);
                        let around = Span::new(
                            span.source,
                            (span.start as usize).saturating_sub(1),
                            span.end as usize + 1,
                        );
                        let kind = ExprKind::Paren {
                            inner: Box::new(value),
                            unit: None,
                        };
                        parts.push(Part::Factor(Expr { span: around, kind }));
                    }
                    Rule::exponent => {
                        let sign = Span::new(
                            span.source,
                            (span.start as usize).saturating_sub(1),
                            span.start as usize,
                        );
                        let (numerator, denominator) = self.exponent(inner);
                        parts.push(Part::Sign("^", sign));
                        parts.push(Part::Factor(ratio(numerator, denominator, span)));
                    }
                    _ => {}
                }
            }
        }
    }

    /// The value of a group of factors in parentheses.
    fn product_of_factors(&mut self, pair: Pair<'t, Rule>, depth: usize) -> Expr {
        let span = self.place(&pair);
        if depth > super::MAX_DEPTH {
            self.too_deep(span);
            return error(span);
        }
        let mut parts = Vec::new();
        self.factor_parts(pair.into_inner(), depth, &mut parts);
        self.climb(&mut parts.into(), 0, depth, span)
    }
}

/// An exponent as an expression.
fn ratio(numerator: i32, denominator: i32, span: Span) -> Expr {
    let whole = |value: i32| Expr {
        span,
        kind: ExprKind::Number {
            value: f64::from(value.abs()),
            integer: true,
            unit: None,
        },
    };
    let mut value = whole(numerator);
    if denominator != 1 {
        let kind = ExprKind::Binary {
            op: BinaryOp::Divide,
            op_span: span,
            left: Box::new(value),
            right: Box::new(whole(denominator)),
        };
        value = Expr { span, kind };
    }
    if numerator < 0 {
        let kind = ExprKind::Unary {
            op: UnaryOp::Negate,
            operand: Box::new(value),
        };
        value = Expr { span, kind };
    }
    value
}
