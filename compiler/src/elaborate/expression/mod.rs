//! Evaluation of expressions.

mod calls;
mod conditions;
mod lists;
mod operators;

pub(crate) use conditions::Truth;

use super::scalar::Scalar;
use super::value::{ScopeId, Value, present};
use super::{Elaborator, Eval};
use crate::codes;
use eng_grammar::ast::{self, Expr, ExprKind, UnaryOp};
use eng_grammar::{Diagnostic, Span};

/// The error for a value that a change of parameters may not change.
pub(super) fn not_constant(span: Span, label: impl Into<String>) -> Diagnostic {
    Diagnostic::error(codes::NOT_KNOWN, "this value must be a constant")
        .at(span, label)
        .with_help("make the parameter a `const`: a change then compiles again")
}

impl<'a> Elaborator<'a, '_> {
    /// The value of an expression. A family becomes the list of its members.
    pub fn evaluate(&mut self, expr: &'a Expr, scope: ScopeId) -> Eval<Value<'a>> {
        Ok(match self.evaluate_family(expr, scope)? {
            function @ (Value::Closure(_) | Value::Partial(_)) => {
                self.with_solution(function, expr.span, scope)
            }
            Value::Family(members) => Value::List(present(members).map(|(_, v)| v).collect()),
            other => other,
        })
    }

    /// The value of an expression; a family keeps the indices of its members.
    fn evaluate_family(&mut self, expr: &'a Expr, scope: ScopeId) -> Eval<Value<'a>> {
        match self.evaluate_any(expr, scope)? {
            Value::Absent(declaration, path) => Err(self.absent(declaration, &path, expr.span)),
            value => Ok(value),
        }
    }

    fn evaluate_any(&mut self, expr: &'a Expr, scope: ScopeId) -> Eval<Value<'a>> {
        match &expr.kind {
            ExprKind::Error => Err(super::Reported),
            ExprKind::Number {
                value,
                integer,
                unit,
            } => match unit {
                // below 2⁵³, up to which each whole number has a double of its own
                None if *integer && value.abs() < 9e15 => Ok(Value::Int(*value as i64)),
                _ => self.number(*value, unit.as_ref()).map(Value::Scalar),
            },
            ExprKind::Text(text) => Ok(Value::Text(text.clone())),
            ExprKind::Bool(b) => Ok(Value::Bool(*b)),
            ExprKind::Name(_) | ExprKind::Field { .. }
                if let Some((choice, word)) = self.typed.findings.words.get(&expr.span) =>
            {
                Ok(Value::Choice(*choice, *word))
            }
            ExprKind::Name(name) => self.lookup(name, scope, expr.span),
            ExprKind::List { items, unit } => {
                let mut values = Vec::with_capacity(items.len());
                for item in items {
                    let value = self.evaluate(item, scope)?;
                    values.push(self.with_unit(value, unit.as_ref(), item.span)?);
                }
                Ok(Value::List(values))
            }
            ExprKind::Comprehension {
                body,
                binders,
                unit,
            } => {
                let mut values = Vec::new();
                self.for_each(binders, scope, &mut |e, inner, _| {
                    let value = e.evaluate(body, inner)?;
                    let value = e.with_unit(value, unit.as_ref(), body.span)?;
                    values.push(value);
                    Ok(())
                })?;
                Ok(Value::List(values))
            }
            ExprKind::Paren { inner, unit } => {
                let value = self.evaluate(inner, scope)?;
                self.with_unit(value, unit.as_ref(), inner.span)
            }
            ExprKind::Field { base, name } => {
                let base_value = self.evaluate_family(base, scope)?;
                self.field(base_value, name, base.span)
            }
            ExprKind::Call { callee, arguments } => self.call(expr, callee, arguments, scope),
            ExprKind::Index { base, indices } => {
                let value = self.evaluate_family(base, scope)?;
                self.indexed(value, indices, scope)
            }
            ExprKind::Unary { op, operand } => {
                let value = self.evaluate(operand, scope)?;
                match op {
                    UnaryOp::Negate => self.negate(value, operand.span),
                    UnaryOp::Not => match self.read(value, operand.span)? {
                        Truth::Known(known) => Ok(Value::Bool(!known)),
                        Truth::Later(flag) => Ok(Value::Flag(self.graphs.not(flag))),
                    },
                }
            }
            ExprKind::Binary {
                op, left, right, ..
            } => {
                let a = self.evaluate(left, scope)?;
                let b = self.evaluate(right, scope)?;
                let value = self.binary(*op, a, b, left.span, right.span)?;
                if let Value::Flag(flag) = value {
                    self.note_kink(flag.stage, flag.node, 0, left.span, expr.span, scope)?;
                }
                Ok(value)
            }
            ExprKind::If {
                condition,
                then,
                otherwise,
            } => match (self.truth(condition, scope)?, otherwise) {
                (Truth::Known(true), _) => self.evaluate(then, scope),
                (Truth::Known(false), Some(otherwise)) => self.evaluate(otherwise, scope),
                // a chain without `else` compares a value with all words of its choice
                (_, None) => self.checked(None, expr.span, "no case holds"),
                (Truth::Later(flag), Some(otherwise)) => {
                    let a = self.guarded(flag, |e| e.evaluate(then, scope))?;
                    let not = self.graphs.not(flag);
                    let b = self.guarded(not, |e| e.evaluate(otherwise, scope))?;
                    self.select(flag, a, b, then.span, otherwise.span)
                }
            },
            ExprKind::Range { from, to, by } => self.range(from, to, by.as_deref(), scope),
        }
    }

    /// A number that is known while compiling.
    pub fn structural(&mut self, value: Scalar, span: Span) -> Eval<f64> {
        match self.graphs.known(value) {
            Some(v) => Ok(v),
            None => {
                let label = "depends on a `param` or on the motion";
                Err(self.report(not_constant(span, label)))
            }
        }
    }

    pub fn integer(&mut self, expr: &'a Expr, scope: ScopeId) -> Eval<i64> {
        let value = self.evaluate(expr, scope)?;
        self.whole_number(value, expr.span)
    }

    /// The SI value of a literal.
    pub fn number(&mut self, value: f64, unit: Option<&ast::UnitExpr>) -> Eval<Scalar> {
        match unit {
            None => Ok(self.graphs.constant(value)),
            Some(unit) => {
                let unit = self.unit(unit)?;
                Ok(self.graphs.constant(value * unit.scale + unit.offset))
            }
        }
    }

    pub fn unit(&mut self, unit: &ast::UnitExpr) -> Eval<crate::program::Unit> {
        let found = self.program.unit(unit).ok();
        self.checked(found, unit.span, "there is no such unit")
    }

    fn with_unit(
        &mut self,
        value: Value<'a>,
        unit: Option<&ast::UnitExpr>,
        span: Span,
    ) -> Eval<Value<'a>> {
        let Some(unit_expr) = unit else {
            return Ok(value);
        };
        let value = Self::without_axes(value);
        if let Value::List(items) = value {
            let scaled: Eval<Vec<_>> = items
                .into_iter()
                .map(|v| self.with_unit(v, unit, span))
                .collect();
            return scaled.map(Value::List);
        }
        let unit = self.unit(unit_expr)?;
        let number = self.as_scalar(value, span)?;
        let scale = self.graphs.constant(unit.scale);
        let mut scaled = self.graphs.multiply(number, scale);
        if unit.offset != 0.0 {
            let offset = self.graphs.constant(unit.offset);
            scaled = self.graphs.add(scaled, offset);
        }
        Ok(Value::Scalar(scaled))
    }

    pub fn as_scalar(&mut self, value: Value<'a>, span: Span) -> Eval<Scalar> {
        match value {
            Value::Scalar(s) => Ok(s),
            Value::Int(i) => Ok(self.graphs.constant(i as f64)),
            other => self.read(other, span),
        }
    }

    /// The numbers of a list, or of a vector in ground axes.
    pub fn as_components(&mut self, value: Value<'a>, span: Span) -> Eval<Vec<Scalar>> {
        match self.in_space(value, span)? {
            Value::Vector(v) => Ok(v.to_vec()),
            Value::Components(c, _) => Ok(c),
            other => {
                let items: Vec<Value<'a>> = self.read(other, span)?;
                items.into_iter().map(|v| self.as_scalar(v, span)).collect()
            }
        }
    }

    /// A vector in space. A list of three numbers is read in ground axes.
    pub fn as_vector(&mut self, value: Value<'a>, span: Span) -> Eval<[Scalar; 3]> {
        let components = self.as_components(value, span)?;
        self.three(components, span)
    }

    /// Three numbers.
    pub fn three(&mut self, components: Vec<Scalar>, span: Span) -> Eval<[Scalar; 3]> {
        match <[Scalar; 3]>::try_from(components) {
            Ok(v) => Ok(v),
            Err(found) => Err(self.report(
                Diagnostic::error(codes::LENGTHS, "a vector has three components")
                    .at(span, format!("this has {}", found.len())),
            )),
        }
    }

    pub fn list(components: &[Scalar]) -> Value<'a> {
        Value::List(components.iter().map(|s| Value::Scalar(*s)).collect())
    }
}
