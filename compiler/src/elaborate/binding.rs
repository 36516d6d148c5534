//! Parameters: each number of the text that becomes one, with its path, unit and limits.

use super::element::is_structural;
use super::scalar::{Scalar, Stage};
use super::value::{ScopeId, Value};
use super::{Elaborator, Entry, Eval, location};
use crate::codes;
use crate::ir::Op;
use crate::program::{DefinitionId, Unit};
use crate::typed::settable;
use eng_grammar::ast;
use eng_grammar::{Diagnostic, Span};
use eng_system::system::{Location, Parameter};
use eng_system::{Dimension, DisplayUnit};

/// The text of a value that becomes a parameter.
#[derive(Clone, Copy)]
pub(crate) struct Stated<'a> {
    pub expr: &'a ast::Expr,
    /// Dimension of each number in the value.
    pub dimension: Dimension,
    pub limits: Option<&'a (ast::Expr, ast::Expr)>,
    /// The place of the parameter.
    pub span: Span,
    /// The scope of `expr` and `limits`.
    pub scope: ScopeId,
}

/// The span of a location.
pub(crate) fn span_of(place: Location) -> Span {
    Span {
        source: eng_grammar::SourceId(place.source),
        start: place.start,
        end: place.end,
    }
}

/// The expression of one element of a written list; the whole expression if it is not a list.
fn element(list: &ast::Expr, index: usize) -> &ast::Expr {
    match &list.kind {
        ast::ExprKind::List { items, unit: None } => items.get(index).unwrap_or(list),
        ast::ExprKind::Paren { inner, unit: None } => element(inner, index),
        _ => list,
    }
}

/// The argument of a call for a parameter with a name and a place among the parameters.
fn argument<'a>(call: &'a ast::Expr, name: &str, place: usize) -> Option<&'a ast::Expr> {
    let ast::ExprKind::Call { arguments, .. } = &call.kind else {
        return None;
    };
    let named = |argument: &&ast::Argument| argument.name.as_ref().is_some_and(|n| n.text == name);
    let by_place = || {
        arguments
            .get(place)
            .filter(|argument| argument.name.is_none())
    };
    let found = arguments.iter().find(named).or_else(by_place);
    found.map(|argument| &argument.value)
}

/// Whether two values are the same numbers.
fn is_same(a: &Value<'_>, b: &Value<'_>) -> bool {
    match (a, b) {
        (Value::Scalar(a), Value::Scalar(b)) => a == b,
        (Value::Int(a), Value::Int(b)) => a == b,
        (Value::Vector(a), Value::Vector(b)) => a == b,
        (Value::List(a), Value::List(b)) => {
            a.len() == b.len() && a.iter().zip(b).all(|(a, b)| is_same(a, b))
        }
        _ => false,
    }
}

impl<'a> Elaborator<'a, '_> {
    /// Makes a parameter of each number in a value. The value depends on parameters alone. So `--set` can set the
    /// number by its path, and it is no constant of the generated code.
    pub fn parameterise(
        &mut self,
        value: Value<'a>,
        path: &str,
        stated: Stated<'a>,
    ) -> Eval<Value<'a>> {
        let limited = stated.scope;
        match self.changed(path) {
            Some((expr, scope)) => {
                let found = self.dimension_at(expr.span, scope)?;
                if found != stated.dimension {
                    let title = format!("`{path}` is in {}, not in {found}", stated.dimension);
                    return Err(self.report(
                        Diagnostic::error(codes::CHANGE, title)
                            .at(expr.span, format!("this is in {found}"))
                            .also(stated.span, "the number that it changes"),
                    ));
                }
                let value = self.changed_value(&value, expr, scope)?;
                let stated = Stated {
                    expr,
                    span: expr.span,
                    scope,
                    ..stated
                };
                self.parameters_of(value, path, stated, limited)
            }
            None => self.parameters_of(value, path, stated, limited),
        }
    }

    /// The parameters of a value. The limits belong to another scope than the value if a use changes it.
    fn parameters_of(
        &mut self,
        value: Value<'a>,
        path: &str,
        stated: Stated<'a>,
        limited: ScopeId,
    ) -> Eval<Value<'a>> {
        let Stated {
            expr,
            dimension,
            limits,
            span,
            scope,
        } = stated;
        let member = |index| Stated {
            expr: element(expr, index),
            limits: None,
            ..stated
        };
        match value {
            Value::Int(i) => {
                let s = self.graphs.constant(i as f64);
                self.parameters_of(Value::Scalar(s), path, stated, limited)
            }
            Value::Scalar(s) if s.stage == Stage::Bind => {
                let display = self
                    .literal_unit(expr)
                    .or_else(|| self.unit_of_parameter(s, dimension))
                    .or_else(|| self.unit_within(expr, dimension))
                    .unwrap_or_else(|| self.usual_unit(dimension));
                let limits = match limits {
                    Some((low, high)) => {
                        let bound = |e: &mut Self, expr: &'a ast::Expr| -> Eval<f64> {
                            let v = e.evaluate(expr, limited)?;
                            let v = e.as_scalar(v, expr.span)?;
                            e.structural(v, expr.span)
                        };
                        let both = (bound(self, low)?, bound(self, high)?);
                        if both.0 >= both.1 {
                            return Err(self.report(
                                Diagnostic::error(
                                    codes::NO_LIMITS,
                                    format!("no number is within the limits of {path}"),
                                )
                                .at(low.span.to(high.span), "the first is not below the second")
                                .with_help("write the lower limit first: `in (10 mm, 500 mm)`"),
                            ));
                        }
                        both
                    }
                    None => (f64::NEG_INFINITY, f64::INFINITY),
                };
                if let Some(at) = self.named_by(expr, scope) {
                    self.draft.stated.insert(path.to_owned(), at);
                }
                let index = self.draft.parameters.len() as u32;
                self.draft.parameters.push(Parameter {
                    origin: eng_system::system::Origin {
                        path: path.to_owned(),
                        used_at: Some(location(span)),
                        defined_at: None,
                    },
                    dimension,
                    point: display.offset != 0.0,
                    display,
                    limits,
                });
                self.draft.parameter_defaults.push(s.node);
                let node = self.graphs.bind.graph.input(index);
                Ok(Value::Scalar(Scalar { node, ..s }))
            }
            value @ Value::Shown(_) => {
                let vector = self.in_space(value, span)?;
                self.parameters_of(vector, path, stated, limited)
            }
            value @ Value::Components(..) => {
                self.parameters_of(Self::without_axes(value), path, stated, limited)
            }
            Value::Vector(v) => {
                let mut out = v;
                for (i, s) in v.into_iter().enumerate() {
                    let name = format!("{path}[{}]", i + 1);
                    if let Value::Scalar(p) =
                        self.parameterise(Value::Scalar(s), &name, member(i))?
                    {
                        out[i] = p;
                    }
                }
                Ok(Value::Vector(out))
            }
            Value::List(items) => {
                let mut out = Vec::with_capacity(items.len());
                for (i, item) in items.into_iter().enumerate() {
                    let name = format!("{path}[{}]", i + 1);
                    out.push(self.parameterise(item, &name, member(i))?);
                }
                Ok(Value::List(out))
            }
            Value::Record(id, given) if !self.moves(&value) => {
                Ok(Value::Record(id, self.record_of(id, given, path, stated)?))
            }
            other => Ok(other),
        }
    }

    /// A record whose numbers are parameters below a path. A default of the record follows the parameters
    /// that it reads.
    fn record_of(
        &mut self,
        id: DefinitionId,
        given: ScopeId,
        path: &str,
        stated: Stated<'a>,
    ) -> Eval<ScopeId> {
        let fields: Vec<&'a ast::Binding> = match self.program.item(id).map(|item| &item.kind) {
            Some(ast::ItemKind::Declaration(record)) => settable(record).collect(),
            _ => Vec::new(),
        };
        let plain = self.record_scope(id);
        let made = self.record_scope(id);
        let makes = self.makes_record(stated.expr, id, stated.scope);
        for (index, field) in fields.into_iter().enumerate() {
            let name = &field.name.text;
            let written = match makes {
                true => argument(stated.expr, name, index),
                false => None,
            };
            let value = self.entry(given, name, stated.span)?;
            let default = match &field.value {
                Some(_) => Some(self.entry(plain, name, stated.span)?),
                None => None,
            };
            // a stated number remains, even that of the default
            let is_default = default.is_some_and(|default| is_same(&default, &value));
            let by_default = is_default && written.is_none();
            if !by_default {
                self.define(plain, name, Entry::Value(value.clone()));
            }
            let ty = field.ty.as_ref().map(|ty| ty.span);
            let place = ty.or(field.value.as_ref().map(|value| value.span));
            let place = self.checked(place, field.name.span, "a field without a type")?;
            let structural = match ty {
                Some(ty) => is_structural(&self.type_at(ty)?),
                None => false,
            };
            let value = match by_default {
                true => self.entry(made, name, stated.span)?,
                false => value,
            };
            let value = match structural {
                true => value,
                false => {
                    let expr = written.or(field.value.as_ref());
                    let of_field = Stated {
                        expr: expr.unwrap_or(stated.expr),
                        dimension: self.dimension_at(place, given)?,
                        limits: None,
                        ..stated
                    };
                    self.parameterise(value, &format!("{path}.{name}"), of_field)?
                }
            };
            self.define(made, name, Entry::Value(value));
        }
        Ok(made)
    }

    /// Whether an expression is a call of a record, so that its arguments are the record's fields.
    fn makes_record(&self, expr: &ast::Expr, record: DefinitionId, scope: ScopeId) -> bool {
        let ast::ExprKind::Call { callee, .. } = &expr.kind else {
            return false;
        };
        let called = match &callee.kind {
            ast::ExprKind::Name(name) => name,
            ast::ExprKind::Field { name, .. } => &name.text,
            _ => return false,
        };
        let module = self.scope(scope).module;
        match self.program.lookup(module, called) {
            Some(found) => found == record,
            // a record after the path of its module
            None => match self.program.item(record).map(|item| &item.kind) {
                Some(ast::ItemKind::Declaration(own)) => own.name.text == *called,
                _ => false,
            },
        }
    }

    /// The unit of a literal.
    pub fn literal_unit(&self, expr: &ast::Expr) -> Option<DisplayUnit> {
        self.unit_of_literal(expr).map(DisplayUnit::from)
    }

    fn unit_of_literal(&self, expr: &ast::Expr) -> Option<Unit> {
        let unit = match &expr.kind {
            ast::ExprKind::Number { unit: Some(u), .. }
            | ast::ExprKind::List { unit: Some(u), .. }
            | ast::ExprKind::Paren { unit: Some(u), .. } => u,
            ast::ExprKind::Paren { inner, unit: None } => return self.unit_of_literal(inner),
            ast::ExprKind::Unary { operand, .. } => return self.unit_of_literal(operand),
            _ => return None,
        };
        self.program.unit(unit).ok()
    }

    /// The place of the first constant that an expression names: `firing[i]`, `-offset`.
    fn named_by(&self, expr: &ast::Expr, scope: ScopeId) -> Option<Location> {
        let name = match &expr.kind {
            ast::ExprKind::Name(name) => name,
            ast::ExprKind::Index { base, .. } => return self.named_by(base, scope),
            ast::ExprKind::Paren { inner, .. } => return self.named_by(inner, scope),
            ast::ExprKind::Unary { operand, .. } => return self.named_by(operand, scope),
            ast::ExprKind::Binary { left, right, .. } => {
                let left = self.named_by(left, scope);
                return left.or_else(|| self.named_by(right, scope));
            }
            _ => return None,
        };
        let mut at = Some(scope);
        while let Some(id) = at {
            if self.scope(id).entries.contains_key(name) {
                return self
                    .draft
                    .named
                    .get(&(id.0 as usize, name.clone()))
                    .copied();
            }
            at = self.scope(id).parent;
        }
        None
    }

    /// The unit of the parameter in a value: `bore/2` has the unit of `bore`.
    fn unit_of_parameter(&self, value: Scalar, dimension: Dimension) -> Option<DisplayUnit> {
        let graph = &self.graphs.bind.graph;
        let mut waiting = vec![value.node];
        // a parameter deeper than this in the expression is hardly the quantity of the value
        for _ in 0..32 {
            let op = graph.op(waiting.pop()?);
            if let Op::Input(index) = op
                && let Some(parameter) = self.draft.parameters.get(index as usize)
                && parameter.dimension.without_angle() == dimension.without_angle()
            {
                return Some(parameter.display.clone());
            }
            waiting.extend(op.operands().rev());
        }
        None
    }

    /// The unit of a literal with this dimension in an expression: the millimetre for `2*27 mm`.
    fn unit_within(&self, expr: &ast::Expr, dimension: Dimension) -> Option<DisplayUnit> {
        if let Some(unit) = self.unit_of_literal(expr) {
            return (unit.dimension == dimension).then(|| DisplayUnit::from(unit));
        }
        match &expr.kind {
            ast::ExprKind::Binary { left, right, .. } => self
                .unit_within(left, dimension)
                .or_else(|| self.unit_within(right, dimension)),
            ast::ExprKind::If {
                then, otherwise, ..
            } => self
                .unit_within(then, dimension)
                .or_else(|| self.unit_within(otherwise.as_deref()?, dimension)),
            ast::ExprKind::Paren { inner, .. } => self.unit_within(inner, dimension),
            ast::ExprKind::Unary { operand, .. } => self.unit_within(operand, dimension),
            _ => None,
        }
    }

    /// The usual unit of a dimension.
    pub(super) fn usual_unit(&self, dimension: Dimension) -> DisplayUnit {
        if dimension.is_one() {
            return DisplayUnit::si(dimension);
        }
        match self.program.usual_unit(dimension) {
            Some(unit) => DisplayUnit::from(unit),
            None => self.natural_unit(dimension),
        }
    }

    /// The SI unit of a dimension, by its own name if it has one, and `deg` and `rpm`. Outputs without a stated unit
    /// have it. Parameters without one have a usual unit, if there is one.
    pub fn natural_unit(&self, dimension: Dimension) -> DisplayUnit {
        let plain = dimension.without_angle();
        // a unit with a name of its own, if there is one
        for symbol in ["N", "Pa", "W", "deg", "rpm", "Hz"] {
            if let Some(unit) = self.program.units.get(symbol) {
                let same = match symbol {
                    "deg" | "rpm" => unit.dimension == dimension,
                    _ => unit.dimension == plain && unit.dimension == dimension,
                };
                if same {
                    return DisplayUnit {
                        symbol: symbol.to_owned(),
                        scale: unit.scale,
                        offset: unit.offset,
                    };
                }
            }
        }
        if let (Some(n), Some(m)) = (self.program.units.get("N"), self.program.units.get("m"))
            && n.dimension.times(m.dimension) == plain
        {
            return DisplayUnit {
                symbol: "N*m".into(),
                scale: 1.0,
                offset: 0.0,
            };
        }
        // angle is soft: the unit shows it only if no other dimension is left
        if plain.is_one() {
            DisplayUnit::si(dimension)
        } else {
            DisplayUnit::si(plain)
        }
    }
}
