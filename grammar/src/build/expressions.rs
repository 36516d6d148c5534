//! Expressions.

use super::{Builder, MAX_DEPTH};
use crate::ast::{Argument, BinaryOp, Binder, Expr, ExprKind, IndexArgument, UnaryOp, UnitExpr};
use crate::codes;
use crate::diagnostic::Diagnostic;
use crate::grammar::Rule;
use crate::span::Span;
use crate::strings;
use pest::iterators::Pair;
use std::collections::VecDeque;

/// A part of a chain of operators.
#[derive(Debug)]
pub(super) enum Part<'t> {
    /// A `prefix`, `infix` or `postfix` of the grammar.
    Read(Pair<'t, Rule>),
    /// A sign between a unit and a factor that is no unit, or before the exponent of such a factor.
    Sign(&'static str, Span),
    /// Such a factor, or its exponent.
    Factor(Expr),
}

impl Part<'_> {
    fn is(&self, rule: Rule) -> bool {
        matches!(self, Part::Read(pair) if pair.as_rule() == rule)
    }

    /// The infix sign and its strength.
    fn infix(&self) -> Option<(Infix, u8)> {
        match self {
            Part::Read(pair) => infix(pair.as_str()),
            Part::Sign(sign, _) => infix(sign),
            Part::Factor(_) => None,
        }
    }
}

type Operands<'t> = VecDeque<Part<'t>>;

/// The expression that an infix sign makes.
#[derive(Clone, Copy)]
enum Infix {
    Binary(BinaryOp),
    Range,
    Step,
}

/// Binding strengths that more than one rule needs: see [`infix`].
const NOT: u8 = 3;
const COMPARE: u8 = 4;
const NEGATE: u8 = 8;
const POWER: u8 = 9;

/// Binding strength: a larger one binds tighter.
fn infix(text: &str) -> Option<(Infix, u8)> {
    use BinaryOp::*;
    Some(match text {
        "or" => (Infix::Binary(Or), 1),
        "and" => (Infix::Binary(And), 2),
        "==" => (Infix::Binary(Equal), COMPARE),
        "!=" => (Infix::Binary(NotEqual), COMPARE),
        "<" => (Infix::Binary(Less), COMPARE),
        "<=" => (Infix::Binary(LessEqual), COMPARE),
        ">" => (Infix::Binary(Greater), COMPARE),
        ">=" => (Infix::Binary(GreaterEqual), COMPARE),
        ".." => (Infix::Range, 5),
        "by" => (Infix::Step, 5),
        "+" => (Infix::Binary(Add), 6),
        "-" => (Infix::Binary(Subtract), 6),
        "*" => (Infix::Binary(Multiply), 7),
        "/" => (Infix::Binary(Divide), 7),
        "^" => (Infix::Binary(Power), POWER),
        _ => return None,
    })
}

fn has_unit(value: &Expr) -> bool {
    match &value.kind {
        ExprKind::Number { unit, .. }
        | ExprKind::List { unit, .. }
        | ExprKind::Comprehension { unit, .. }
        | ExprKind::Paren { unit, .. } => unit.is_some(),
        _ => false,
    }
}

impl<'t> Builder<'t, '_> {
    /// Of an `expression`.
    pub(crate) fn expression(&mut self, pair: Pair<'t, Rule>, depth: usize) -> Expr {
        let span = self.place(&pair);
        let parts: Vec<_> = pair.into_inner().collect();
        // A chain of operators may lean to one side, so each of them counts as a level.
        let operators: usize = parts
            .iter()
            .map(|part| match part.as_rule() {
                Rule::postfix => self.operators_behind_unit(part),
                _ => 1,
            })
            .sum();
        let conditional = parts
            .first()
            .is_some_and(|part| part.as_rule() == Rule::conditional);
        let depth = depth + operators + usize::from(conditional);
        if depth > MAX_DEPTH {
            self.too_deep(span);
            return error(span);
        }
        let mut parts: Operands<'t> = parts.into_iter().map(Part::Read).collect();
        match parts.pop_front() {
            Some(Part::Read(first)) if conditional => self.conditional(first, depth),
            Some(first) => {
                parts.push_front(first);
                self.climb(&mut parts, 0, depth, span)
            }
            None => error(span),
        }
    }

    fn conditional(&mut self, pair: Pair<'t, Rule>, depth: usize) -> Expr {
        let span = self.place(&pair);
        let mut values = pair
            .into_inner()
            .filter(|part| part.as_rule() == Rule::expression);
        match (values.next(), values.next()) {
            (Some(condition), Some(then)) => Expr {
                span,
                kind: ExprKind::If {
                    condition: Box::new(self.expression(condition, depth)),
                    then: Box::new(self.expression(then, depth)),
                    otherwise: values
                        .next()
                        .map(|otherwise| Box::new(self.expression(otherwise, depth))),
                },
            },
            _ => error(span),
        }
    }

    /// Precedence climbing: takes operators that bind at least as tight as `least`.
    pub(super) fn climb(
        &mut self,
        parts: &mut Operands<'t>,
        least: u8,
        depth: usize,
        whole: Span,
    ) -> Expr {
        let mut left = match parts.pop_front() {
            Some(Part::Read(first)) if first.as_rule() == Rule::prefix => {
                self.prefixed(first, parts, depth, whole)
            }
            Some(Part::Read(first)) => {
                let value = self.postfix(first, depth);
                // the factors after its unit are operands of this chain, so that their precedence is the usual one
                for factor in self.factors.drain(..).rev() {
                    parts.push_front(factor);
                }
                value
            }
            Some(Part::Factor(value)) => value,
            Some(Part::Sign(..)) | None => return error(whole),
        };
        loop {
            let Some((what, strength)) = parts.front().and_then(Part::infix) else {
                return left;
            };
            if strength < least {
                return left;
            }
            let op_span = match parts.pop_front() {
                Some(Part::Read(sign)) => self.place(&sign),
                Some(Part::Sign(_, span)) => span,
                Some(Part::Factor(_)) | None => return left,
            };
            let right_least = if strength == POWER {
                POWER
            } else {
                strength + 1
            };
            let right = self.climb(parts, right_least, depth, whole);
            left = self.combine(what, op_span, left, right);
        }
    }

    fn prefixed(
        &mut self,
        sign: Pair<'t, Rule>,
        parts: &mut Operands<'t>,
        depth: usize,
        whole: Span,
    ) -> Expr {
        let sign_span = self.place(&sign);
        let (op, strength) = if sign.as_str() == "-" {
            (UnaryOp::Negate, NEGATE)
        } else {
            (UnaryOp::Not, NOT)
        };
        let literal = parts.front().is_some_and(|next| next.is(Rule::postfix));
        let operand = self.climb(parts, strength, depth, whole);
        let span = sign_span.to(operand.span);
        // `-5 degC` is one literal: an affine unit applies to the signed number.
        if let (UnaryOp::Negate, true, ExprKind::Number { unit: Some(_), .. }) =
            (op, literal, &operand.kind)
            && let ExprKind::Number {
                value,
                integer,
                unit,
            } = operand.kind
        {
            return Expr {
                span,
                kind: ExprKind::Number {
                    value: -value,
                    integer,
                    unit,
                },
            };
        }
        Expr {
            span,
            kind: ExprKind::Unary {
                op,
                operand: Box::new(operand),
            },
        }
    }

    fn combine(&mut self, what: Infix, op_span: Span, left: Expr, right: Expr) -> Expr {
        let span = left.span.to(right.span);
        match what {
            Infix::Binary(op) => {
                if op.is_comparison()
                    && let ExprKind::Binary {
                        op: first,
                        op_span: first_span,
                        ..
                    } = &left.kind
                    && first.is_comparison()
                {
                    self.report(
                        Diagnostic::error(codes::CHAIN, "comparisons do not chain")
                            .at(op_span, "a second comparison of one chain")
                            .also(*first_span, "the first")
                            .with_help("write `a < b and b < c`"),
                    );
                    return error(span);
                }
                if op == BinaryOp::Power && left.span.end == op_span.start && has_unit(&left) {
                    self.report(
                        Diagnostic::error(
                            codes::NUMBER,
                            "the exponent of a unit is a whole number or a ratio",
                        )
                        .at(right.span, "not a number")
                        .also(left.span, "ends with a unit")
                        .with_help("`(2 m)^n` raises the quantity; `m^2` and `m^(1/2)` are units"),
                    );
                    return error(span);
                }
                Expr {
                    span,
                    kind: ExprKind::Binary {
                        op,
                        op_span,
                        left: Box::new(left),
                        right: Box::new(right),
                    },
                }
            }
            Infix::Range => {
                if matches!(left.kind, ExprKind::Range { .. }) {
                    self.report(
                        Diagnostic::error(codes::UNEXPECTED, "a range has two ends")
                            .at(op_span, "a second `..`")
                            .with_help("write `first .. last by step`"),
                    );
                    return error(span);
                }
                Expr {
                    span,
                    kind: ExprKind::Range {
                        from: Box::new(left),
                        to: Box::new(right),
                        by: None,
                    },
                }
            }
            Infix::Step => match left.kind {
                ExprKind::Range { from, to, by: None } => Expr {
                    span,
                    kind: ExprKind::Range {
                        from,
                        to,
                        by: Some(Box::new(right)),
                    },
                },
                _ => {
                    self.report(
                        Diagnostic::error(codes::UNEXPECTED, "`by` gives the step of a range")
                            .at(op_span, "no range is before it")
                            .with_help("write `first .. last by step`"),
                    );
                    error(span)
                }
            },
        }
    }

    /// Of a `postfix`.
    pub(super) fn postfix(&mut self, pair: Pair<'t, Rule>, depth: usize) -> Expr {
        let span = self.place(&pair);
        self.factors.clear();
        let parts: Vec<_> = pair.into_inner().collect();
        // the parts after the first one: fields, calls, indices
        let depth = depth + parts.len().saturating_sub(1);
        if depth > MAX_DEPTH {
            self.too_deep(span);
            return error(span);
        }
        let mut result = error(span);
        for (i, part) in parts.into_iter().enumerate() {
            let place = self.place(&part);
            result = match part.as_rule() {
                Rule::field => Expr {
                    span: result.span.to(place),
                    kind: ExprKind::Field {
                        base: Box::new(result),
                        name: self.next_name(&mut part.into_inner()),
                    },
                },
                Rule::call => Expr {
                    span: result.span.to(place),
                    kind: ExprKind::Call {
                        callee: Box::new(result),
                        arguments: self.arguments(part, depth),
                    },
                },
                Rule::subscript => Expr {
                    span: result.span.to(place),
                    kind: ExprKind::Index {
                        base: Box::new(result),
                        indices: self.places(part, depth),
                    },
                },
                _ if i == 0 => self.primary(part, depth),
                _ => result,
            };
        }
        result
    }

    fn primary(&mut self, pair: Pair<'t, Rule>, depth: usize) -> Expr {
        let span = self.place(&pair);
        let kind = match pair.as_rule() {
            Rule::name => ExprKind::Name(pair.as_str().to_string()),
            Rule::boolean => ExprKind::Bool(pair.as_str() == "true"),
            Rule::string => {
                let (start, end) = self.range(&pair);
                ExprKind::Text(self.unescaped(start + 1, end.saturating_sub(1)))
            }
            Rule::quantity => self.quantity(pair, depth),
            Rule::scaled_list | Rule::scaled_paren => self.scaled(pair, depth),
            _ => ExprKind::Error,
        };
        // the factors after its unit are no part of the value
        let span = match self.factors.first() {
            Some(Part::Sign(_, sign)) => {
                Span::new(span.source, span.start as usize, sign.start as usize)
            }
            _ => span,
        };
        Expr { span, kind }
    }

    /// The text between two bytes with its escapes resolved; an unknown escape is a mistake.
    pub(super) fn unescaped(&mut self, start: usize, end: usize) -> String {
        let (text, unknown) = strings::unescape(self.text.get(start..end).unwrap_or(""));
        for at in unknown {
            let span = self.span(start + at, start + at + 2);
            self.report(strings::unknown_escape(span));
        }
        text
    }

    fn quantity(&mut self, pair: Pair<'t, Rule>, depth: usize) -> ExprKind {
        let mut kind = ExprKind::Error;
        for part in pair.into_inner() {
            match part.as_rule() {
                Rule::number => {
                    let text = part.as_str();
                    let value: f64 = text.parse().unwrap_or(f64::INFINITY);
                    if !value.is_finite() {
                        let span = self.place(&part);
                        self.report(
                            Diagnostic::error(codes::NUMBER, "this number is too large")
                                .at(span, "the largest number is about 1.8e308"),
                        );
                        return ExprKind::Error;
                    }
                    kind = ExprKind::Number {
                        value,
                        integer: text.bytes().all(|b| b.is_ascii_digit()),
                        unit: None,
                    };
                }
                Rule::unit_after => {
                    let after = self.unit_after(part, depth);
                    if let ExprKind::Number { unit, .. } = &mut kind {
                        *unit = after;
                    }
                }
                _ => {}
            }
        }
        kind
    }

    fn unit_after(&mut self, pair: Pair<'t, Rule>, depth: usize) -> Option<UnitExpr> {
        let unit = pair
            .into_inner()
            .find(|part| part.as_rule() == Rule::unit)?;
        Some(self.unit_and_factors(unit, depth))
    }

    fn scaled(&mut self, pair: Pair<'t, Rule>, depth: usize) -> ExprKind {
        let mut kind = ExprKind::Error;
        for part in pair.into_inner() {
            match part.as_rule() {
                Rule::paren => {
                    if let Some(inner) = part.into_inner().next() {
                        kind = ExprKind::Paren {
                            inner: Box::new(self.expression(inner, depth + 1)),
                            unit: None,
                        };
                    }
                }
                Rule::list => kind = self.list(part, depth + 1),
                Rule::unit_after => {
                    let after = self.unit_after(part, depth);
                    if let ExprKind::Paren { unit, .. }
                    | ExprKind::List { unit, .. }
                    | ExprKind::Comprehension { unit, .. } = &mut kind
                    {
                        *unit = after;
                    }
                }
                _ => {}
            }
        }
        kind
    }

    fn list(&mut self, pair: Pair<'t, Rule>, depth: usize) -> ExprKind {
        let mut items = Vec::new();
        for part in pair.into_inner() {
            match part.as_rule() {
                Rule::expression => items.push(self.expression(part, depth)),
                Rule::comprehension => {
                    let binders = self.binders(part, depth);
                    if let Some(body) = items.pop() {
                        return ExprKind::Comprehension {
                            body: Box::new(body),
                            binders,
                            unit: None,
                        };
                    }
                }
                _ => {}
            }
        }
        ExprKind::List { items, unit: None }
    }

    fn arguments(&mut self, pair: Pair<'t, Rule>, depth: usize) -> Vec<Argument> {
        let mut arguments: Vec<Argument> = Vec::new();
        for part in pair.into_inner() {
            match part.as_rule() {
                Rule::argument => {
                    let mut name = None;
                    for inner in part.into_inner() {
                        match inner.as_rule() {
                            Rule::argument_name => {
                                name = inner.into_inner().next().map(|word| self.name(&word));
                            }
                            _ => arguments.push(Argument {
                                name: name.take(),
                                value: self.expression(inner, depth),
                            }),
                        }
                    }
                }
                Rule::comprehension => {
                    let end = self.place(&part);
                    let binders = self.binders(part, depth + 1);
                    if let Some(Argument { name, value }) = arguments.pop() {
                        arguments.push(Argument {
                            name,
                            value: Expr {
                                span: value.span.to(end),
                                kind: ExprKind::Comprehension {
                                    body: Box::new(value),
                                    binders,
                                    unit: None,
                                },
                            },
                        });
                    }
                }
                _ => {}
            }
        }
        arguments
    }

    fn places(&mut self, pair: Pair<'t, Rule>, depth: usize) -> Vec<IndexArgument> {
        let mut places = Vec::new();
        for part in pair.into_inner().flat_map(Pair::into_inner) {
            match part.as_rule() {
                Rule::every => places.push(IndexArgument::All(self.place(&part))),
                Rule::expression => {
                    places.push(IndexArgument::At(self.expression(part, depth)));
                }
                _ => {}
            }
        }
        places
    }

    /// The binders among the children of an `index` or a `comprehension`.
    pub(super) fn binders(&mut self, pair: Pair<'t, Rule>, depth: usize) -> Vec<Binder> {
        let mut binders = Vec::new();
        for part in pair.into_inner() {
            if part.as_rule() != Rule::binder {
                continue;
            }
            let mut inner = part.into_inner();
            let name = self.next_name(&mut inner);
            if let Some(range) = inner.find(|part| part.as_rule() == Rule::expression) {
                binders.push(Binder {
                    name,
                    range: self.expression(range, depth + 1),
                });
            }
        }
        binders
    }
}

pub(super) fn error(span: Span) -> Expr {
    Expr {
        span,
        kind: ExprKind::Error,
    }
}
