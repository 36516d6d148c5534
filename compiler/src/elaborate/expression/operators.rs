//! Arithmetic.

use super::super::scalar::Scalar;
use super::super::value::Value;
use super::super::{Elaborator, Eval};
use crate::codes;
use crate::ir::Graph;
use eng_grammar::ast::BinaryOp;
use eng_grammar::{Diagnostic, Span};

impl<'a> Elaborator<'a, '_> {
    pub(super) fn negate(&mut self, value: Value<'a>, span: Span) -> Eval<Value<'a>> {
        match value {
            Value::Int(i) => match i.checked_neg() {
                Some(negative) => Ok(Value::Int(negative)),
                None => {
                    let number = self.graphs.constant(i as f64);
                    self.negate(Value::Scalar(number), span)
                }
            },
            v @ (Value::Vector(_) | Value::Shown(_) | Value::Components(..)) => {
                self.scale(v, span, |e, x| e.graphs.negate(x))
            }
            Value::List(items) => items
                .into_iter()
                .map(|v| self.negate(v, span))
                .collect::<Eval<Vec<_>>>()
                .map(Value::List),
            other => {
                let number = self.as_scalar(other, span)?;
                Ok(Value::Scalar(self.graphs.negate(number)))
            }
        }
    }

    pub(super) fn binary(
        &mut self,
        op: BinaryOp,
        a: Value<'a>,
        b: Value<'a>,
        a_span: Span,
        b_span: Span,
    ) -> Eval<Value<'a>> {
        use BinaryOp as B;
        match op {
            B::And | B::Or => return self.logic(op, a, b, a_span, b_span),
            _ if op.is_comparison() => return self.comparison(op, a, b, a_span, b_span),
            _ => {}
        }
        if let (Value::Int(x), Value::Int(y)) = (&a, &b) {
            let whole = match op {
                B::Add => x.checked_add(*y),
                B::Subtract => x.checked_sub(*y),
                B::Multiply => x.checked_mul(*y),
                B::Power => u32::try_from(*y).ok().and_then(|y| x.checked_pow(y)),
                _ => None,
            };
            if let Some(i) = whole {
                return Ok(Value::Int(i));
            }
        }
        if let (B::Add, Value::ModeSet(x), Value::ModeSet(y)) = (op, &a, &b) {
            let sum = x.iter().chain(y.iter()).cloned().collect();
            return Ok(Value::ModeSet(std::rc::Rc::new(sum)));
        }
        match op {
            B::Add | B::Subtract => {
                let f = |e: &mut Self, x: Scalar, y: Scalar| {
                    if op == B::Add {
                        e.graphs.add(x, y)
                    } else {
                        e.graphs.subtract(x, y)
                    }
                };
                if a.is_several() || b.is_several() {
                    return self.pairwise((a, a_span), (b, b_span), f);
                }
                let x = self.as_scalar(a, a_span)?;
                let y = self.as_scalar(b, b_span)?;
                Ok(Value::Scalar(f(self, x, y)))
            }
            B::Multiply => match (a, b) {
                (v, s) if v.is_several() => {
                    let s = self.as_scalar(s, b_span)?;
                    self.scale(v, a_span, |e, x| e.graphs.multiply(x, s))
                }
                (s, v) if v.is_several() => {
                    let s = self.as_scalar(s, a_span)?;
                    self.scale(v, b_span, |e, x| e.graphs.multiply(s, x))
                }
                (x, y) => {
                    let x = self.as_scalar(x, a_span)?;
                    let y = self.as_scalar(y, b_span)?;
                    Ok(Value::Scalar(self.graphs.multiply(x, y)))
                }
            },
            B::Divide => {
                let y = self.as_scalar(b, b_span)?;
                if self.graphs.known(y) == Some(0.0) {
                    return Err(self.report(
                        Diagnostic::error(codes::DIVISION_BY_ZERO, "a division by zero")
                            .at(b_span, "this is zero"),
                    ));
                }
                match a {
                    v if v.is_several() => self.scale(v, a_span, |e, x| e.graphs.divide(x, y)),
                    x => {
                        let x = self.as_scalar(x, a_span)?;
                        Ok(Value::Scalar(self.graphs.divide(x, y)))
                    }
                }
            }
            _ => self.power(a, b, a_span, b_span),
        }
    }

    pub(super) fn power(
        &mut self,
        a: Value<'a>,
        b: Value<'a>,
        a_span: Span,
        b_span: Span,
    ) -> Eval<Value<'a>> {
        let x = self.as_scalar(a, a_span)?;
        let y = self.as_scalar(b, b_span)?;
        Ok(Value::Scalar(self.graphs.binary(x, y, Graph::power)))
    }

    pub(super) fn scale(
        &mut self,
        value: Value<'a>,
        span: Span,
        mut f: impl FnMut(&mut Self, Scalar) -> Scalar,
    ) -> Eval<Value<'a>> {
        let (numbers, sort) = self.sorted(value, span)?;
        let scaled = numbers.into_iter().map(|x| f(self, x)).collect();
        Ok(Self::of_sort(scaled, sort))
    }
}
