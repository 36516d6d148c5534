//! The bind graph: expressions of parameters alone, evaluated once for each parameter set.

use super::scalar::{FIXED, Flag, Scalar, Stage};
use super::value::{ScopeId, Value};
use super::{Elaborator, Eval, expression::Truth, location};
use crate::codes;
use crate::ir::{Function, Node, Op};
use crate::program::Unit;
use eng_grammar::ast;
use eng_grammar::{Diagnostic, Span};
use eng_system::code::{Advice, BindCode, BindError, Bound, Pair};
use eng_system::system::{Location, Origin, Parameter, Slot};
use eng_system::table::{Outside, Table};
use eng_system::{Dimension, DisplayUnit};
use std::collections::BTreeSet;

/// The largest number that a model may hold (SI): its square is still a number.
const LARGEST: f64 = 1e150;

/// The node with the default of a parameter.
pub type ParameterDefault = Node;

/// Part of a message with numbers in it.
#[derive(Clone, Debug, PartialEq)]
pub enum MessagePart {
    /// Plain text.
    Text(String),
    /// A value in a unit.
    Value(Node, DisplayUnit),
}

/// A `require` or `advise` on parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct Check {
    /// A number that is 1 if the condition holds.
    pub holds: Node,
    /// A lint.
    pub advise: bool,
    /// The name of a lint for `accept`; empty without a name.
    pub name: String,
    /// The author's message.
    pub message: Vec<MessagePart>,
    /// Path of the element.
    pub path: String,
    /// The user's line.
    pub used_at: Option<Location>,
    /// The law's line.
    pub defined_at: Option<Location>,
}

/// The bind graph as a program.
#[derive(Clone, Debug, Default)]
pub struct BindProgram {
    /// All operations, operands first; inputs below 2²⁴ are parameters, from there fixed numbers.
    pub function: Function,
    /// Fixed numbers.
    pub fixed: Vec<f64>,
    /// Path of the body, marker or element that each slot belongs to.
    pub slot_owners: Vec<String>,
    /// Defaults of the parameters.
    pub defaults: Vec<ParameterDefault>,
    /// Paths, units and limits of the parameters.
    pub parameters: Vec<Parameter>,
    /// Conditions.
    pub checks: Vec<Check>,
}

impl BindProgram {
    /// The first table that is evaluated outside its points, given the values of all nodes.
    fn outside(&self, values: &[Pair], tables: &[Table]) -> Option<Box<Outside>> {
        let nodes = self.function.graph.nodes();
        let [outside, _] = crate::ir::interpret::outside(nodes, values, tables);
        outside.map(Box::new)
    }

    /// Parameters in a node, ascending. A parameter whose default depends on others is replaced by these.
    fn leaves(&self, node: Node) -> Vec<u32> {
        let nodes = self.function.graph.nodes();
        let mut seen = vec![false; nodes.len()];
        let mut found = std::collections::BTreeSet::new();
        let mut open = vec![node];
        while let Some(node) = open.pop() {
            let at = node.0 as usize;
            let (Some(op), Some(seen)) = (nodes.get(at), seen.get_mut(at)) else {
                continue;
            };
            if std::mem::replace(seen, true) {
                continue;
            }
            match *op {
                Op::Input(k) if k >= FIXED => {}
                Op::Input(k) => {
                    let inner = match self.defaults.get(k as usize) {
                        Some(default) => self.leaves(*default),
                        None => Vec::new(),
                    };
                    if inner.is_empty() {
                        found.insert(k);
                    }
                    found.extend(inner);
                }
                op => open.extend(op.operands()),
            }
        }
        found.into_iter().collect()
    }
}

impl BindProgram {
    /// The parameters and tables that decide a value. A parameter whose default depends on others is replaced
    /// by these.
    fn decided_by(&self, value: Node, tables: &[Table]) -> Vec<Origin> {
        let graph = &self.function.graph;
        let mut waiting = vec![value];
        let mut seen = BTreeSet::new();
        let mut found: Vec<Origin> = Vec::new();
        let mut add = |origin: Origin| {
            if !found.iter().any(|known| known.used_at == origin.used_at) {
                found.push(origin);
            }
        };
        while let Some(node) = waiting.pop() {
            if !seen.insert(node) {
                continue;
            }
            match graph.op(node) {
                Op::Input(k) if k < FIXED => {
                    let (Some(parameter), Some(default)) = (
                        self.parameters.get(k as usize),
                        self.defaults.get(k as usize),
                    ) else {
                        continue;
                    };
                    match self.is_stated(*default) {
                        true => add(parameter.origin.clone()),
                        false => waiting.push(*default),
                    }
                }
                Op::Table(handle, ..) => {
                    let index = match graph.op(handle) {
                        Op::Input(k) if k >= FIXED => self.fixed.get((k - FIXED) as usize).copied(),
                        _ => graph.as_constant(handle),
                    };
                    let table = index.and_then(|index| tables.get(index as usize));
                    if let Some(table) = table {
                        add(Origin {
                            path: table.name().to_owned(),
                            used_at: table.stated_at(),
                            defined_at: None,
                        });
                    }
                    waiting.extend(graph.op(node).operands().skip(1));
                }
                op => waiting.extend(op.operands()),
            }
        }
        found.retain(|origin| origin.used_at.is_some());
        found.sort_by_key(|origin| origin.used_at.map(|at| (at.source, at.start)));
        found
    }

    /// Whether a default is a number of the text, without parameters or tables.
    fn is_stated(&self, default: Node) -> bool {
        let graph = &self.function.graph;
        let mut waiting = vec![default];
        while let Some(node) = waiting.pop() {
            match graph.op(node) {
                Op::Input(k) if k < FIXED => return false,
                Op::Table(..) => return false,
                op => waiting.extend(op.operands()),
            }
        }
        true
    }
}

impl BindCode for BindProgram {
    fn bind(&self, overrides: &[Option<f64>], tables: &[Table]) -> Result<Bound, BindError> {
        let nodes = self.function.graph.nodes();
        // both lanes hold the same number, so these are the operations of the generated code
        let mut values: Vec<Pair> = Vec::with_capacity(nodes.len());
        for op in nodes {
            let value = match *op {
                Op::Input(k) if k >= FIXED => self.fixed.get((k - FIXED) as usize).copied(),
                Op::Input(k) => {
                    let default = self
                        .defaults
                        .get(k as usize)
                        .and_then(|n| values.get(n.0 as usize))
                        .map(|pair| pair[0]);
                    overrides.get(k as usize).copied().flatten().or(default)
                }
                other => Some(crate::ir::interpret::operate(other, &values, tables)[0]),
            };
            values.push([value.unwrap_or(f64::NAN); 2]);
        }
        let at = |n: &Node| values.get(n.0 as usize).map_or(f64::NAN, |pair| pair[0]);
        let mut parameters = Vec::with_capacity(self.parameters.len());
        for (i, parameter) in self.parameters.iter().enumerate() {
            let value = match (overrides.get(i).copied().flatten(), self.defaults.get(i)) {
                (Some(v), _) => v,
                (None, Some(n)) => at(n),
                (None, None) => f64::NAN,
            };
            if !value.is_finite() {
                return Err(BindError::NotFinite {
                    path: parameter.origin.path.clone(),
                    outside: self.outside(&values, tables),
                });
            }
            let (low, high) = parameter.limits;
            if value <= low || value >= high {
                let d = &parameter.display;
                return Err(BindError::Limits {
                    path: parameter.origin.path.clone(),
                    value: d.text(value).into(),
                    low: d.text(low).into(),
                    high: d.text(high).into(),
                });
            }
            parameters.push(value);
        }
        let mut advice = Vec::new();
        for check in &self.checks {
            if at(&check.holds) == 1.0 {
                continue;
            }
            // a number that does not exist (beyond the end of a table, a root of a negative number) cannot be
            // shown
            let known = |part: &MessagePart| match part {
                MessagePart::Text(_) => true,
                MessagePart::Value(n, _) => at(n).is_finite(),
            };
            if check.advise && !check.message.iter().all(known) {
                continue;
            }
            let message: String = check
                .message
                .iter()
                .map(|part| match part {
                    MessagePart::Text(t) => t.clone(),
                    MessagePart::Value(n, unit) => unit.text(at(n)),
                })
                .collect();
            if check.advise {
                advice.push(Advice {
                    name: check.name.clone(),
                    origin: Origin {
                        path: check.path.clone(),
                        used_at: check.used_at,
                        defined_at: check.defined_at,
                    },
                    message,
                    decided_by: self.decided_by(check.holds, tables),
                });
            } else {
                return Err(BindError::Require {
                    path: check.path.clone(),
                    message,
                    used_at: check.used_at,
                    defined_at: check.defined_at,
                    parameters: self
                        .leaves(check.holds)
                        .into_iter()
                        .map(|k| (k, parameters.get(k as usize).copied().unwrap_or(f64::NAN)))
                        .collect(),
                });
            }
        }
        let slots: Vec<f64> = self.function.outputs.iter().map(at).collect();
        if let Some(i) = slots.iter().position(|v| !v.is_finite()) {
            return Err(BindError::NotFinite {
                path: self
                    .slot_owners
                    .get(i)
                    .unwrap_or(&self.function.name)
                    .clone(),
                outside: self.outside(&values, tables),
            });
        }
        if let Some(i) = slots.iter().position(|v| v.abs() > LARGEST) {
            return Err(BindError::TooLarge {
                path: self
                    .slot_owners
                    .get(i)
                    .unwrap_or(&self.function.name)
                    .clone(),
                value: slots[i],
            });
        }
        Ok(Bound {
            slots,
            parameters,
            advice,
        })
    }

    fn parameters_of(&self, slot: Slot) -> Vec<u32> {
        match self.function.outputs.get(slot.0 as usize) {
            Some(node) => self.leaves(*node),
            None => Vec::new(),
        }
    }
}

/// A `require` or `advise` as written.
#[derive(Clone, Copy)]
pub(crate) struct Asked<'a> {
    pub advise: bool,
    /// Its name for `accept`.
    pub name: Option<&'a ast::Name>,
    pub condition: &'a ast::Expr,
    pub message: &'a ast::Name,
}

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

/// The author's message of a `require` or `advise`, evaluated in the scope of the condition.
#[derive(Clone, Debug, Default)]
pub(crate) struct Message {
    /// The text, with its expressions as written.
    pub text: String,
    pub parts: Vec<Part>,
    /// Dimension of the two numbers that its condition compares, if it is a comparison.
    pub compared: Option<Dimension>,
}

/// Part of a message, before the stage of its numbers is known.
#[derive(Clone, Debug)]
pub(crate) enum Part {
    Text(String),
    Value {
        value: Scalar,
        display: DisplayUnit,
        span: Span,
    },
}

/// The title of a message about several paths.
fn titled(text: &str, paths: &[&str]) -> String {
    match paths {
        [] | [""] => text.to_owned(),
        paths => format!("{}: {text}", super::topology::listed(paths)),
    }
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

impl<'a> Elaborator<'a, '_> {
    /// Makes each number in a value that depends on parameters alone a parameter of its own. So `--set` can
    /// set it by its path, and it is no constant of the generated code.
    pub fn parameterise(
        &mut self,
        value: Value<'a>,
        path: &str,
        stated: Stated<'a>,
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
                let s = self.bench.constant(i as f64);
                self.parameterise(Value::Scalar(s), path, stated)
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
                            let v = e.evaluate(expr, scope)?;
                            let v = e.as_scalar(v, expr.span)?;
                            e.structural(v, expr.span)
                        };
                        (bound(self, low)?, bound(self, high)?)
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
                let node = self.bench.bind.graph.input(index);
                Ok(Value::Scalar(Scalar { node, ..s }))
            }
            value @ Value::Shown(_) => {
                let vector = self.in_space(value, span)?;
                self.parameterise(vector, path, stated)
            }
            value @ Value::Components(..) => {
                self.parameterise(Self::without_axes(value), path, stated)
            }
            Value::Vector(v) => {
                let mut out = v;
                for (i, s) in v.into_iter().enumerate() {
                    let name = format!("{path}.{}", ["x", "y", "z"][i]);
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
            other => Ok(other),
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
        let graph = &self.bench.bind.graph;
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
    fn usual_unit(&self, dimension: Dimension) -> DisplayUnit {
        if dimension.is_one() {
            return DisplayUnit::si(dimension);
        }
        match self.program.usual_unit(dimension) {
            Some(unit) => DisplayUnit::from(unit),
            None => self.natural_unit(dimension),
        }
    }

    /// The display unit of a dimension without a stated unit.
    pub fn natural_unit(&self, dimension: Dimension) -> DisplayUnit {
        let plain = dimension.without_angle();
        // a unit with a name of its own, if there is one
        for symbol in ["N", "Pa", "J", "W", "deg", "rpm", "Hz"] {
            if let Some(unit) = self.program.units.get(symbol) {
                let same = match symbol {
                    "deg" | "rpm" => unit.dimension == dimension,
                    "J" => false,
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

    /// Evaluates a `require` or `advise`. A condition of parameters alone becomes a check of the bind graph.
    /// Another condition is returned with its message.
    pub fn requirement(
        &mut self,
        asked: Asked<'a>,
        scope: ScopeId,
        path: &str,
        used_at: Option<Location>,
    ) -> Eval<Option<(Flag, Message)>> {
        let Asked {
            advise,
            name,
            condition,
            message,
        } = asked;
        let truth = self.truth(condition, scope)?;
        if let Truth::Known(true) = truth {
            return Ok(None);
        }
        let truth = self.where_it_counts(truth);
        let mut message = self.message(message, scope)?;
        message.compared = self.compared(condition, scope)?;
        match truth {
            Truth::Later(flag) if flag.stage == Stage::Motion => Ok(Some((flag, message))),
            Truth::Later(flag) => {
                let mut parts = Vec::with_capacity(message.parts.len());
                for part in message.parts {
                    parts.push(match part {
                        Part::Text(text) => MessagePart::Text(text),
                        Part::Value {
                            value,
                            display,
                            span,
                        } => MessagePart::Value(self.bind_node(value, span)?, display),
                    });
                }
                let holds = self.bench.flag_number(flag);
                self.draft.checks.push(Check {
                    holds,
                    advise,
                    name: name.map_or(String::new(), |name| name.text.clone()),
                    message: parts,
                    path: path.to_owned(),
                    used_at,
                    defined_at: Some(location(condition.span)),
                });
                Ok(None)
            }
            Truth::Known(_) => {
                if let Some(name) = name
                    && self.accepts(&name.text, path)
                {
                    return Ok(None);
                }
                let text = self.known_text(message);
                let title = |paths: &[&str]| titled(&text, paths);
                let places = |diagnostic: Diagnostic| match used_at.map(span_of) {
                    Some(place) => diagnostic
                        .at(place, "needed by the item used here")
                        .also(condition.span, "this does not hold"),
                    None => diagnostic.at(condition.span, "this does not hold"),
                };
                if !advise {
                    let message = places(Diagnostic::error(codes::REQUIRED, title(&[path])));
                    return Err(self.report(message));
                }
                let message = places(Diagnostic::warning(codes::ADVISED, text.clone()))
                    .acceptable(name.map_or("", |name| &name.text));
                // equal messages become one message about several paths
                match self
                    .draft
                    .advised
                    .iter_mut()
                    .find(|(known, _)| *known == message)
                {
                    Some((_, paths)) => paths.push(path.to_owned()),
                    None => self.draft.advised.push((message, vec![path.to_owned()])),
                }
                Ok(None)
            }
        }
    }

    /// Reports failed `advise`s on values known while compiling.
    pub fn tell_advised(&mut self) {
        for (mut message, paths) in std::mem::take(&mut self.draft.advised) {
            let paths: Vec<&str> = paths.iter().map(String::as_str).collect();
            message.title = titled(&message.title, &paths);
            self.diagnostics.push(message);
        }
    }

    /// A condition that is true if one of the surrounding `if`s takes its other side.
    fn where_it_counts(&mut self, truth: Truth) -> Truth {
        let guards = self.context.guards.clone();
        guards.into_iter().fold(truth, |truth, (guard, _)| {
            let elsewhere = self.bench.not(guard);
            Truth::Later(match truth {
                Truth::Later(flag) => self.bench.logic(elsewhere, flag, Op::Or),
                Truth::Known(_) => elsewhere,
            })
        })
    }

    /// A message with the numbers known while compiling. Other expressions appear as written.
    fn known_text(&self, message: Message) -> String {
        message
            .parts
            .into_iter()
            .map(|part| match part {
                Part::Text(text) => text,
                Part::Value {
                    value,
                    display,
                    span,
                } => match self.bench.known(value) {
                    Some(known) => display.text(known),
                    None => self.sources.text(span).to_owned(),
                },
            })
            .collect()
    }

    /// The dimension of the two numbers that a condition compares; `None` for another condition.
    pub(super) fn compared(
        &mut self,
        condition: &'a ast::Expr,
        scope: ScopeId,
    ) -> Eval<Option<Dimension>> {
        use ast::BinaryOp as B;
        match &condition.kind {
            ast::ExprKind::Paren { inner, unit: None } => self.compared(inner, scope),
            ast::ExprKind::Binary {
                op: B::Less | B::LessEqual | B::Greater | B::GreaterEqual | B::Equal,
                left,
                ..
            } => self.dimension_at(left.span, scope).map(Some),
            _ => Ok(None),
        }
    }

    fn message(&mut self, message: &'a ast::Name, scope: ScopeId) -> Eval<Message> {
        let mut found = Message::default();
        for part in self.message_at(message.span)? {
            let (value, unit) = match part {
                eng_grammar::MessagePart::Text(text) => {
                    found.text.push_str(text);
                    found.parts.push(Part::Text(text.clone()));
                    continue;
                }
                eng_grammar::MessagePart::Value { value, unit, .. } => (value, unit),
            };
            let span = value.span;
            found.text.push_str(self.sources.text(span));
            let number = match self.evaluate(value, scope)? {
                Value::Scalar(number) => number,
                Value::Int(i) => self.bench.constant(i as f64),
                Value::Text(text) => {
                    found.parts.push(Part::Text(text));
                    continue;
                }
                Value::Choice(id, word) => {
                    let word = self.program.word(id, word);
                    let word = self.checked(word, span, "no such word")?;
                    found.parts.push(Part::Text(word.to_owned()));
                    continue;
                }
                other => return Err(self.not_shown(span, &other)),
            };
            let display = match unit {
                Some(unit) => DisplayUnit::from(self.unit(unit)?),
                None => {
                    let dimension = self.dimension_at(span, scope)?;
                    self.natural_unit(dimension)
                }
            };
            found.parts.push(Part::Value {
                value: number,
                display,
                span,
            });
        }
        Ok(found)
    }

    fn not_shown(&mut self, span: Span, found: &Value<'_>) -> super::Reported {
        self.report(
            Diagnostic::error(codes::MESSAGE_FORM, "a message shows numbers and texts")
                .at(span, format!("this is {}", found.kind())),
        )
    }
}
