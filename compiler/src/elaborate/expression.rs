//! Evaluation of expressions.

use super::binding::Part;
use super::scalar::{Flag, Scalar, Stage};
use super::value::{ScopeId, TableValue, Value};
use super::{Elaborator, Entry, Eval, Lazy};
use crate::codes;
use crate::ir::{Graph, Node, Op};
use eng_grammar::ast::{self, BinaryOp, Expr, ExprKind, UnaryOp};
use eng_grammar::{Diagnostic, Span};
use eng_system::Dimension;

/// Longest list or range.
const LONGEST: usize = 100_000;

impl<'a> Elaborator<'a, '_> {
    /// The value of an expression; a family as the list of its members.
    pub fn evaluate(&mut self, expr: &'a Expr, scope: ScopeId) -> Eval<Value<'a>> {
        Ok(match self.evaluate_family(expr, scope)? {
            Value::Family(members) => Value::List(members.into_iter().map(|(_, v)| v).collect()),
            other => other,
        })
    }

    fn evaluate_family(&mut self, expr: &'a Expr, scope: ScopeId) -> Eval<Value<'a>> {
        match &expr.kind {
            ExprKind::Error => Err(super::Reported),
            ExprKind::Number {
                value,
                integer,
                unit,
            } => match unit {
                None if *integer && value.abs() < 9e15 => Ok(Value::Int(*value as i64)),
                _ => self.number(*value, unit.as_ref()).map(Value::Scalar),
            },
            ExprKind::Text(text) => Ok(Value::Text(text.clone())),
            ExprKind::Bool(b) => Ok(Value::Bool(*b)),
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
                let mut value = self.evaluate_family(base, scope)?;
                for index in indices {
                    match index {
                        ast::IndexArgument::All(_) => {}
                        ast::IndexArgument::At(index_expr) => {
                            let index = self.integer(index_expr, scope)?;
                            value = self.element_of(value, index, index_expr.span)?;
                        }
                    }
                }
                Ok(value)
            }
            ExprKind::Unary { op, operand } => {
                let value = self.evaluate(operand, scope)?;
                match op {
                    UnaryOp::Negate => self.negate(value, operand.span),
                    UnaryOp::Not => match value {
                        Value::Bool(b) => Ok(Value::Bool(!b)),
                        Value::Flag(f) => Ok(Value::Flag(self.bench.not(f))),
                        other => Err(self.unfit(operand.span, "a truth value", &other)),
                    },
                }
            }
            ExprKind::Binary {
                op, left, right, ..
            } => {
                let a = self.evaluate(left, scope)?;
                let b = self.evaluate(right, scope)?;
                self.binary(*op, a, b, left.span, right.span)
            }
            ExprKind::If {
                condition,
                then,
                otherwise,
            } => match self.truth(condition, scope)? {
                Truth::Known(true) => self.evaluate(then, scope),
                Truth::Known(false) => self.evaluate(otherwise, scope),
                Truth::Later(flag) => {
                    let a = self.guarded(flag, |e| e.evaluate(then, scope))?;
                    let not = self.bench.not(flag);
                    let b = self.guarded(not, |e| e.evaluate(otherwise, scope))?;
                    self.select(flag, a, b, then.span, otherwise.span)
                }
            },
            ExprKind::Range { from, to, by } => self.range(from, to, by.as_deref(), scope),
        }
    }

    fn range(
        &mut self,
        from: &'a Expr,
        to: &'a Expr,
        by_expr: Option<&'a Expr>,
        scope: ScopeId,
    ) -> Eval<Value<'a>> {
        let a = self.evaluate(from, scope)?;
        let b = self.evaluate(to, scope)?;
        let step = match by_expr {
            Some(by) => Some(self.evaluate(by, scope)?),
            None => None,
        };
        if let (Value::Int(a), Value::Int(b), None | Some(Value::Int(_))) = (&a, &b, &step) {
            let by = match step {
                Some(Value::Int(s)) => s,
                _ => 1,
            };
            let span = from.span.to(by_expr.map_or(to.span, |e| e.span));
            if by == 0 {
                return Err(self.long_range(span, "its step is zero"));
            }
            // in 128 bits, where no difference of two 64-bit numbers overflows
            let (a, b, by) = (i128::from(*a), i128::from(*b), i128::from(by));
            if (b - a) / by > LONGEST as i128 {
                return Err(self.long_range(span, &too_long()));
            }
            let mut values = Vec::new();
            let mut i = a;
            while (by > 0 && i <= b) || (by < 0 && i >= b) {
                values.extend(i64::try_from(i).map(Value::Int));
                i += by;
            }
            return Ok(Value::List(values));
        }
        let a = self.as_scalar(a, from.span)?;
        let b = self.as_scalar(b, to.span)?;
        let by_span = by_expr.map_or(to.span, |e| e.span);
        let step = match step {
            Some(v) => self.as_scalar(v, by_span)?,
            None => {
                if a.dimension.is_one() && b.dimension.is_one() {
                    return Err(self.not_countable(from.span.to(to.span)));
                }
                return Err(self.internal(to.span, "a range of quantities without a step"));
            }
        };
        let known = (
            self.structural(a, from.span)?,
            self.structural(b, to.span)?,
            self.structural(step, by_span)?,
        );
        let (a_value, b_value, by_value) = known;
        let count = ((b_value - a_value) / by_value * (1.0 + 1e-12)).floor();
        let span = from.span.to(by_span);
        if by_value == 0.0 {
            return Err(self.long_range(span, "its step is zero"));
        }
        if count < 0.0 {
            return Err(self.long_range(span, "its step leads away from its end"));
        }
        if !(0.0..LONGEST as f64).contains(&count) {
            return Err(self.long_range(span, &too_long()));
        }
        Ok(Value::List(
            (0..=count as usize)
                .map(|i| {
                    Value::Scalar(
                        self.bench
                            .constant(a_value + i as f64 * by_value, a.dimension),
                    )
                })
                .collect(),
        ))
    }

    /// The checker has found a whole number, but its value is beyond those.
    fn not_countable(&mut self, span: Span) -> super::Reported {
        self.report(
            Diagnostic::error(
                codes::NOT_COUNTABLE,
                "a whole number is too large to count with",
            )
            .at(span, "beyond what a count or an index can be"),
        )
    }

    fn long_range(&mut self, span: Span, why: &str) -> super::Reported {
        self.report(
            Diagnostic::error(codes::LONG_RANGE, "this range is endless or too long").at(span, why),
        )
    }

    /// A number that is known while compiling.
    pub fn structural(&mut self, value: Scalar, span: Span) -> Eval<f64> {
        match self.bench.known(value) {
            Some(v) => Ok(v),
            None => Err(self.report(
                Diagnostic::error(codes::NOT_KNOWN, "this must be known while compiling")
                    .at(span, "depends on a `param` or on the motion")
                    .with_help("make the parameter a `const`: a change then compiles again"),
            )),
        }
    }

    pub fn integer(&mut self, expr: &'a Expr, scope: ScopeId) -> Eval<i64> {
        match self.evaluate(expr, scope)? {
            Value::Int(i) => Ok(i),
            Value::Scalar(s) => {
                self.structural(s, expr.span)?;
                Err(self.not_countable(expr.span))
            }
            other => Err(self.unfit(expr.span, "a whole number", &other)),
        }
    }

    /// The SI value of a literal.
    pub fn number(&mut self, value: f64, unit: Option<&ast::UnitExpr>) -> Eval<Scalar> {
        match unit {
            None => Ok(self.bench.constant(value, Dimension::ONE)),
            Some(unit) => {
                let unit = self.unit(unit)?;
                Ok(self
                    .bench
                    .constant(value * unit.scale + unit.offset, unit.dimension))
            }
        }
    }

    pub fn unit(&mut self, unit: &ast::UnitExpr) -> Eval<crate::program::Unit> {
        match self.program.unit(unit) {
            Ok(u) => Ok(u),
            Err((span, name)) => Err(self.internal(span, &format!("there is no unit `{name}`"))),
        }
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
        if let Value::List(items) = value {
            let scaled: Eval<Vec<_>> = items
                .into_iter()
                .map(|v| self.with_unit(v, unit, span))
                .collect();
            return scaled.map(Value::List);
        }
        let unit = self.unit(unit_expr)?;
        let number = self.as_scalar(value, span)?;
        let scale = self.bench.constant(unit.scale, unit.dimension);
        let mut scaled = self.bench.multiply(number, scale);
        if unit.offset != 0.0 {
            let offset = self.bench.constant(unit.offset, unit.dimension);
            scaled = self.bench.add(scaled, offset);
        }
        Ok(Value::Scalar(scaled))
    }

    pub fn as_scalar(&mut self, value: Value<'a>, span: Span) -> Eval<Scalar> {
        match value {
            Value::Scalar(s) => Ok(s),
            Value::Int(i) => Ok(self.bench.constant(i as f64, Dimension::ONE)),
            other => Err(self.unfit(span, "a number", &other)),
        }
    }

    /// The numbers of a list.
    pub fn as_components(&mut self, value: Value<'a>, span: Span) -> Eval<Vec<Scalar>> {
        match value {
            Value::Vector(v) => Ok(v.to_vec()),
            Value::List(items) => items.into_iter().map(|v| self.as_scalar(v, span)).collect(),
            other => Err(self.unfit(span, "a vector or a list of numbers", &other)),
        }
    }

    /// A vector in space; a list of three is read in ground axes.
    pub fn as_vector(&mut self, value: Value<'a>, span: Span) -> Eval<[Scalar; 3]> {
        let components = self.as_components(value, span)?;
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

    fn element_of(&mut self, value: Value<'a>, index: i64, span: Span) -> Eval<Value<'a>> {
        match value {
            Value::List(items) => {
                let count = items.len();
                match usize::try_from(index)
                    .ok()
                    .and_then(|i| i.checked_sub(1))
                    .and_then(|i| items.into_iter().nth(i))
                {
                    Some(v) => Ok(v),
                    None => Err(self.no_element(
                        index,
                        span,
                        match count {
                            0 => "the list is empty".to_owned(),
                            _ => format!("indices run from 1 to {count}"),
                        },
                    )),
                }
            }
            Value::Family(members) => {
                let shown: Vec<String> = members
                    .iter()
                    .filter_map(|(key, _)| key.first().map(usize::to_string))
                    .collect();
                let mut rest: Vec<(Vec<usize>, Value<'a>)> = members
                    .into_iter()
                    .filter(|(key, _)| key.first().is_some_and(|k| *k as i64 == index))
                    .map(|(key, v)| (key[1..].to_vec(), v))
                    .collect();
                match rest.pop() {
                    Some((key, value)) if key.is_empty() => Ok(value),
                    Some(last) => {
                        rest.push(last);
                        Ok(Value::Family(rest))
                    }
                    None => Err(self.no_element(index, span, known_indices(&shown))),
                }
            }
            other => Err(self.unfit(span, "an array", &other)),
        }
    }

    fn no_element(&mut self, index: i64, span: Span, known: String) -> super::Reported {
        self.report(
            Diagnostic::error(codes::INDEX_OUTSIDE, format!("there is no element {index}"))
                .at(span, format!("this is {index}; {known}")),
        )
    }

    /// Two lists that should be of one length.
    pub fn lengths(
        &mut self,
        first: usize,
        first_span: Span,
        second: usize,
        second_span: Span,
    ) -> super::Reported {
        self.report(
            Diagnostic::error(codes::LENGTHS, "two lists differ in length")
                .at(second_span, format!("{second} elements"))
                .also(first_span, format!("{first} elements")),
        )
    }

    fn negate(&mut self, value: Value<'a>, span: Span) -> Eval<Value<'a>> {
        match value {
            Value::Int(i) => match i.checked_neg() {
                Some(negative) => Ok(Value::Int(negative)),
                None => {
                    let number = self.bench.constant(i as f64, Dimension::ONE);
                    self.negate(Value::Scalar(number), span)
                }
            },
            Value::Scalar(s) => Ok(Value::Scalar(self.bench.negate(s))),
            Value::Vector(v) => Ok(Value::Vector(v.map(|s| self.bench.negate(s)))),
            Value::List(items) => items
                .into_iter()
                .map(|v| self.negate(v, span))
                .collect::<Eval<Vec<_>>>()
                .map(Value::List),
            other => Err(self.unfit(span, "a number or a vector", &other)),
        }
    }

    fn binary(
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
            B::Equal | B::NotEqual | B::Less | B::LessEqual | B::Greater | B::GreaterEqual => {
                return self.comparison(op, a, b, a_span, b_span);
            }
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
                        e.bench.add(x, y)
                    } else {
                        e.bench.subtract(x, y)
                    }
                };
                match (a, b) {
                    (a @ (Value::Vector(_) | Value::List(_)), b)
                    | (a, b @ (Value::Vector(_) | Value::List(_))) => {
                        let vector = matches!(a, Value::Vector(_)) || matches!(b, Value::Vector(_));
                        let x = self.as_components(a, a_span)?;
                        let y = self.as_components(b, b_span)?;
                        if x.len() != y.len() {
                            return Err(self.lengths(x.len(), a_span, y.len(), b_span));
                        }
                        let sums: Vec<Scalar> =
                            x.into_iter().zip(y).map(|(x, y)| f(self, x, y)).collect();
                        match <[Scalar; 3]>::try_from(sums) {
                            Ok(v) if vector => Ok(Value::Vector(v)),
                            Ok(v) => Ok(Self::list(&v)),
                            Err(sums) => Ok(Self::list(&sums)),
                        }
                    }
                    (a, b) => {
                        let x = self.as_scalar(a, a_span)?;
                        let y = self.as_scalar(b, b_span)?;
                        Ok(Value::Scalar(f(self, x, y)))
                    }
                }
            }
            B::Multiply => match (a, b) {
                (v @ (Value::Vector(_) | Value::List(_)), s) => {
                    let s = self.as_scalar(s, b_span)?;
                    self.scale(v, a_span, |e, x| e.bench.multiply(x, s))
                }
                (s, v @ (Value::Vector(_) | Value::List(_))) => {
                    let s = self.as_scalar(s, a_span)?;
                    self.scale(v, b_span, |e, x| e.bench.multiply(s, x))
                }
                (x, y) => {
                    let x = self.as_scalar(x, a_span)?;
                    let y = self.as_scalar(y, b_span)?;
                    Ok(Value::Scalar(self.bench.multiply(x, y)))
                }
            },
            B::Divide => {
                let y = self.as_scalar(b, b_span)?;
                if self.bench.known(y) == Some(0.0) {
                    return Err(self.report(
                        Diagnostic::error(codes::DIVISION_BY_ZERO, "a division by zero")
                            .at(b_span, "this is zero"),
                    ));
                }
                match a {
                    v @ (Value::Vector(_) | Value::List(_)) => {
                        self.scale(v, a_span, |e, x| e.bench.divide(x, y))
                    }
                    x => {
                        let x = self.as_scalar(x, a_span)?;
                        Ok(Value::Scalar(self.bench.divide(x, y)))
                    }
                }
            }
            _ => self.power(a, b, a_span, b_span),
        }
    }

    fn power(&mut self, a: Value<'a>, b: Value<'a>, a_span: Span, b_span: Span) -> Eval<Value<'a>> {
        let x = self.as_scalar(a, a_span)?;
        let y = self.as_scalar(b, b_span)?;
        let dimension = if x.dimension.is_one() {
            Dimension::ONE
        } else {
            let exponent = self.structural(y, b_span)?;
            let (n, d) = ratio(exponent).unwrap_or((1, 1));
            x.dimension.power(n, d).unwrap_or(Dimension::ONE)
        };
        Ok(Value::Scalar(self.bench.binary(
            x,
            y,
            dimension,
            Graph::power,
        )))
    }

    fn scale(
        &mut self,
        value: Value<'a>,
        span: Span,
        mut f: impl FnMut(&mut Self, Scalar) -> Scalar,
    ) -> Eval<Value<'a>> {
        match value {
            Value::Vector(v) => Ok(Value::Vector(v.map(|x| f(self, x)))),
            other => {
                let components = self.as_components(other, span)?;
                let scaled: Vec<Scalar> = components.into_iter().map(|x| f(self, x)).collect();
                Ok(Self::list(&scaled))
            }
        }
    }

    fn logic(
        &mut self,
        op: BinaryOp,
        a: Value<'a>,
        b: Value<'a>,
        a_span: Span,
        b_span: Span,
    ) -> Eval<Value<'a>> {
        let a = self.as_truth(a, a_span)?;
        let b = self.as_truth(b, b_span)?;
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
                Value::Flag(self.bench.logic(f, g, if and { Op::And } else { Op::Or }))
            }
        })
    }

    fn comparison(
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
            _ => {}
        }
        let x = self.as_scalar(a, a_span)?;
        let y = self.as_scalar(b, b_span)?;
        let flag = match op {
            B::Less => self.bench.compare(x, y, Graph::less),
            B::Greater => self.bench.compare(y, x, Graph::less),
            B::LessEqual => self.bench.compare(x, y, Graph::less_equal),
            B::GreaterEqual => self.bench.compare(y, x, Graph::less_equal),
            _ => self.bench.compare(x, y, |g, a, b| g.push(Op::Equal(a, b))),
        };
        let truth = match self.bench.known_flag(flag) {
            Some(known) => Value::Bool(known),
            None => Value::Flag(flag),
        };
        Ok(match (op, truth) {
            (B::NotEqual, Value::Bool(b)) => Value::Bool(!b),
            (B::NotEqual, Value::Flag(f)) => Value::Flag(self.bench.not(f)),
            (_, truth) => truth,
        })
    }

    fn select(
        &mut self,
        flag: Flag,
        a: Value<'a>,
        b: Value<'a>,
        a_span: Span,
        b_span: Span,
    ) -> Eval<Value<'a>> {
        match (a, b) {
            (a @ (Value::Vector(_) | Value::List(_)), b) => {
                let vector = matches!(a, Value::Vector(_)) || matches!(b, Value::Vector(_));
                let x = self.as_components(a, a_span)?;
                let y = self.as_components(b, b_span)?;
                if x.len() != y.len() {
                    return Err(self.lengths(x.len(), a_span, y.len(), b_span));
                }
                let chosen: Vec<Scalar> = x
                    .into_iter()
                    .zip(y)
                    .map(|(x, y)| self.bench.select(flag, x, y))
                    .collect();
                match <[Scalar; 3]>::try_from(chosen) {
                    Ok(v) if vector => Ok(Value::Vector(v)),
                    Ok(v) => Ok(Self::list(&v)),
                    Err(chosen) => Ok(Self::list(&chosen)),
                }
            }
            (a, b) => {
                let x = self.as_scalar(a, a_span)?;
                let y = self.as_scalar(b, b_span)?;
                Ok(Value::Scalar(self.bench.select(flag, x, y)))
            }
        }
    }

    pub fn truth(&mut self, expr: &'a Expr, scope: ScopeId) -> Eval<Truth> {
        let value = self.evaluate(expr, scope)?;
        self.as_truth(value, expr.span)
    }

    fn as_truth(&mut self, value: Value<'a>, span: Span) -> Eval<Truth> {
        match value {
            Value::Bool(b) => Ok(Truth::Known(b)),
            Value::Flag(f) => Ok(Truth::Later(f)),
            other => Err(self.unfit(span, "a truth value", &other)),
        }
    }

    fn call(
        &mut self,
        expr: &'a Expr,
        callee: &'a Expr,
        arguments: &'a [ast::Argument],
        scope: ScopeId,
    ) -> Eval<Value<'a>> {
        let function = match &callee.kind {
            ExprKind::Name(name) => match self.try_lookup(name, scope, callee.span)? {
                Some(value) => value,
                None => match super::builtin::find(name) {
                    Some(builtin) => Value::Builtin(builtin),
                    None => match crate::words::word(crate::words::Place::Modes, name) {
                        Some(term) => return self.mode_set(term, expr.span, arguments, scope),
                        None => return self.lookup(name, scope, callee.span),
                    },
                },
            },
            _ => self.evaluate(callee, scope)?,
        };
        match function {
            Value::Builtin(name) => self.builtin(name, expr.span, arguments, scope),
            Value::Closure(closure) => {
                let mut values = Vec::with_capacity(arguments.len());
                for argument in arguments {
                    let value = self.evaluate(&argument.value, scope)?;
                    values.push((argument.name.as_ref(), value));
                }
                self.apply(&closure, values, expr.span)
            }
            Value::Table(table) => {
                let Some(first) = arguments.first() else {
                    return Err(self.internal(expr.span, "a table without its argument"));
                };
                let value = self.evaluate(&first.value, scope)?;
                let x = self.as_scalar(value, first.value.span)?;
                Ok(Value::Scalar(self.look_up_table(table, x)))
            }
            Value::Definition(id) => self.construct(id, expr.span, arguments, scope),
            other => Err(self.unfit(callee.span, "a function", &other)),
        }
    }

    pub fn look_up_table(&mut self, table: TableValue, x: Scalar) -> Scalar {
        self.bench.table(table.handle, x, table.result)
    }

    /// Calls a function of the text.
    pub fn apply(
        &mut self,
        closure: &super::value::Closure<'a>,
        values: Vec<(Option<&'a ast::Name>, Value<'a>)>,
        span: Span,
    ) -> Eval<Value<'a>> {
        let function = closure.function;
        let module = self.scope(closure.scope).module;
        let inner = self.new_scope(Some(closure.scope), module, String::new());
        let mut position = 0;
        for (name, value) in values {
            let parameter = match name {
                Some(name) => name.text.clone(),
                None => {
                    position += 1;
                    match function.parameters.get(position - 1) {
                        Some(p) => p.name.text.clone(),
                        None => {
                            return Err(self.internal(span, "too many arguments"));
                        }
                    }
                }
            };
            self.define(inner, &parameter, Entry::Value(value));
        }
        for parameter in &function.parameters {
            if !self.scope(inner).entries.contains_key(&parameter.name.text) {
                if parameter.default.is_none() {
                    return Err(self.internal(
                        span,
                        &format!("argument `{}` is missing", parameter.name.text),
                    ));
                }
                self.define(
                    inner,
                    &parameter.name.text,
                    Entry::Lazy(Lazy::Default(parameter)),
                );
            }
        }
        for binding in &function.lets {
            self.define(
                inner,
                &binding.name.text,
                Entry::Lazy(Lazy::Binding(binding)),
            );
        }
        self.deeper(span, |e| {
            for requirement in &function.requirements {
                e.require_in_function(requirement, inner, span)?;
            }
            e.evaluate(&function.value, inner)
        })
    }

    /// Evaluates what counts only where a flag is true.
    fn guarded<T>(&mut self, flag: Flag, f: impl FnOnce(&mut Self) -> Eval<T>) -> Eval<T> {
        self.guards.push((flag, self.scopes.len()));
        let result = f(self);
        self.guards.pop();
        result
    }

    /// A `require` or `advise` of a function for one call: of parameters alone it is checked when they are set, else its element
    /// watches it.
    fn require_in_function(
        &mut self,
        requirement: &'a ast::Requirement,
        scope: ScopeId,
        call: Span,
    ) -> Eval<()> {
        let path = self.bench.bind.owner.clone();
        let found = self.requirement(
            requirement.advise,
            &requirement.condition,
            &requirement.message,
            scope,
            &path,
            Some(super::location(call)),
        )?;
        let Some((flag, message)) = found else {
            return Ok(());
        };
        let values = message.parts.iter().filter_map(|part| match part {
            Part::Value { value, .. } => Some((value.stage, value.node)),
            Part::Text(_) => None,
        });
        let seen: Vec<Node> = std::iter::once((flag.stage, flag.node))
            .chain(values)
            .filter(|(stage, _)| *stage == Stage::Motion)
            .map(|(_, node)| node)
            .collect();
        if let Some(element) = self.bench.element.as_mut() {
            if crate::ir::differentiate::known_in_outputs_only(
                &element.graph,
                &seen,
                &super::scalar::PROVISIONAL,
            ) {
                return Err(self.report(
                    Diagnostic::error(
                        codes::LATE_ACCELERATION,
                        "a function that asks for a condition is given what is known in outputs only",
                    )
                    .at(call, "an acceleration, a reaction or an output of another element stands in its condition")
                    .also(requirement.condition.span, "its condition is watched at every step")
                    .with_help("call it in the class that knows the value, or a function without `require`"),
                ));
            }
            element.asked.push(super::scalar::Asked {
                advise: requirement.advise,
                flag,
                message,
                span: requirement.condition.span,
            });
        }
        Ok(())
    }

    /// The bind node of a number of parameters alone.
    pub fn bind_node(&mut self, value: Scalar, span: Span) -> Eval<crate::ir::Node> {
        match value.stage {
            Stage::Bind => Ok(value.node),
            Stage::Motion => Err(self.report(
                Diagnostic::error(
                    codes::MOTION,
                    "a value of the motion stands where only parameters can",
                )
                .at(span, "depends on positions, velocities or time")
                .with_help("what moves is known in classes and outputs"),
            )),
        }
    }
}

fn too_long() -> String {
    format!("more than {LONGEST} values")
}

/// What indices there are, shortened where they are many.
fn known_indices(shown: &[String]) -> String {
    let mut distinct: Vec<&str> = Vec::new();
    for index in shown {
        if !distinct.contains(&index.as_str()) {
            distinct.push(index);
        }
    }
    match distinct.as_slice() {
        [] => "there are none".to_owned(),
        [first, .., last] if distinct.len() > 8 => {
            format!("there are {}, from {first} to {last}", distinct.len())
        }
        _ => format!("there are: {}", distinct.join(", ")),
    }
}

/// A condition.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Truth {
    Known(bool),
    Later(Flag),
}

/// A small ratio equal to a number.
pub(crate) fn ratio(x: f64) -> Option<(i32, i32)> {
    (1..=12).find_map(|d| {
        let n = x * f64::from(d);
        ((n - n.round()).abs() < 1e-12 && n.abs() < 1e6).then(|| (n.round() as i32, d))
    })
}
