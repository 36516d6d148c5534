//! Comparisons, `and`, `or`, `if`.

use super::super::location;
use super::super::scalar::{Flag, Stage};
use super::super::value::{ScopeId, Value};
use super::super::{Elaborator, Eval};
use crate::codes;
use crate::ir::{Graph, KinkPlace, Node, Op};
use eng_grammar::ast::{BinaryOp, Expr};
use eng_grammar::{Diagnostic, Span};
use eng_system::system::Kink;

impl<'a> Elaborator<'a, '_> {
    pub(super) fn logic(
        &mut self,
        op: BinaryOp,
        a: Value<'a>,
        b: Value<'a>,
        a_span: Span,
        b_span: Span,
    ) -> Eval<Value<'a>> {
        let a: Truth = self.read(a, a_span)?;
        let b: Truth = self.read(b, b_span)?;
        let and = op == BinaryOp::And;
        Ok(match (a, b) {
            (Truth::Known(x), Truth::Known(y)) => Value::Bool(if and { x && y } else { x || y }),
            (Truth::Known(x), Truth::Later(f)) | (Truth::Later(f), Truth::Known(x)) => {
                if x == and {
                    Value::Flag(f)
                } else {
                    Value::Bool(!and)
                }
            }
            (Truth::Later(f), Truth::Later(g)) => {
                Value::Flag(self.graphs.logic(f, g, if and { Op::And } else { Op::Or }))
            }
        })
    }

    pub(super) fn comparison(
        &mut self,
        op: BinaryOp,
        a: Value<'a>,
        b: Value<'a>,
        a_span: Span,
        b_span: Span,
    ) -> Eval<Value<'a>> {
        use BinaryOp as B;
        match (&a, &b, op) {
            (Value::Text(x), Value::Text(y), B::Equal) => return Ok(Value::Bool(x == y)),
            (Value::Text(x), Value::Text(y), B::NotEqual) => return Ok(Value::Bool(x != y)),
            (Value::Bool(x), Value::Bool(y), B::Equal) => return Ok(Value::Bool(x == y)),
            (Value::Bool(x), Value::Bool(y), B::NotEqual) => return Ok(Value::Bool(x != y)),
            (Value::Choice(_, x), Value::Choice(_, y), B::Equal) => return Ok(Value::Bool(x == y)),
            (Value::Choice(_, x), Value::Choice(_, y), B::NotEqual) => {
                return Ok(Value::Bool(x != y));
            }
            _ => {}
        }
        let x = self.as_scalar(a, a_span)?;
        let y = self.as_scalar(b, b_span)?;
        let flag = match op {
            B::Less => self.graphs.compare(x, y, Graph::less),
            B::Greater => self.graphs.compare(y, x, Graph::less),
            B::LessEqual => self.graphs.compare(x, y, Graph::less_equal),
            B::GreaterEqual => self.graphs.compare(y, x, Graph::less_equal),
            _ => self.graphs.compare(x, y, |g, a, b| g.push(Op::Equal(a, b))),
        };
        let truth = match self.graphs.known_flag(flag) {
            Some(known) => Value::Bool(known),
            None => Value::Flag(flag),
        };
        Ok(match (op, truth) {
            (B::NotEqual, Value::Bool(b)) => Value::Bool(!b),
            (B::NotEqual, Value::Flag(f)) => Value::Flag(self.graphs.not(f)),
            (_, truth) => truth,
        })
    }

    pub(super) fn select(
        &mut self,
        flag: Flag,
        a: Value<'a>,
        b: Value<'a>,
        a_span: Span,
        b_span: Span,
    ) -> Eval<Value<'a>> {
        if matches!(a, Value::Choice(..)) {
            return Err(self.report(
                Diagnostic::error(codes::NOT_KNOWN, "a word must be a constant")
                    .at(a_span, "one of two words, by a condition that can change")
                    .with_help("make the condition one of constants, or compute two numbers"),
            ));
        }
        if a.is_several() || b.is_several() {
            return self.pairwise((a, a_span), (b, b_span), |e, x, y| {
                e.graphs.select(flag, x, y)
            });
        }
        if [&a, &b]
            .iter()
            .all(|side| matches!(side, Value::Bool(_) | Value::Flag(_)))
        {
            let other = Value::Flag(self.graphs.not(flag));
            let then = self.logic(BinaryOp::And, Value::Flag(flag), a, a_span, a_span)?;
            let otherwise = self.logic(BinaryOp::And, other, b, b_span, b_span)?;
            return self.logic(BinaryOp::Or, then, otherwise, a_span, b_span);
        }
        let x = self.as_scalar(a, a_span)?;
        let y = self.as_scalar(b, b_span)?;
        Ok(Value::Scalar(self.graphs.select(flag, x, y)))
    }

    /// Keeps the text and the dimension of an operation that may have a kink: `of` is an expression with the
    /// dimension of its kink function, `text` the whole expression.
    pub fn note_kink(
        &mut self,
        stage: Stage,
        node: Node,
        argument: u8,
        of: Span,
        text: Span,
        scope: ScopeId,
    ) -> Eval<()> {
        // a number that cannot change has no kink
        if stage == Stage::Bind && self.graphs.bind.graph.as_constant(node).is_some() {
            return Ok(());
        }
        let dimension = Some(self.dimension_at(of, scope)?);
        let text_as_written = self.sources.text(text).to_owned();
        let kinks = match stage {
            Stage::Bind => Some(&mut self.graphs.bind.kinks),
            Stage::Motion => self.graphs.element.as_mut().map(|e| &mut e.kinks),
        };
        if let Some(kinks) = kinks {
            // the first text of an operation counts: later uses of the same operation share it
            (kinks.entry(KinkPlace { node, argument })).or_insert(Kink {
                text: text_as_written,
                dimension,
                defined_at: Some(location(text)),
                ..Kink::default()
            });
        }
        Ok(())
    }

    pub fn truth(&mut self, expr: &'a Expr, scope: ScopeId) -> Eval<Truth> {
        let value = self.evaluate(expr, scope)?;
        self.read(value, expr.span)
    }
}

/// A condition.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Truth {
    Known(bool),
    Later(Flag),
}
