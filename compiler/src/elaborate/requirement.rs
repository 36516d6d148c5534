//! `require` and `advise`: their conditions, and the messages with the numbers of the model.

use super::bind_program::{Check, MessagePart};
use super::binding::span_of;
use super::scalar::{FIXED, Flag, Scalar, Stage};
use super::value::{ScopeId, Value};
use super::{Elaborator, Eval, expression::Truth, location};
use crate::codes;
use crate::ir::{Graph, Node, Op};
use eng_grammar::{Diagnostic, Span, ast};
use eng_system::system::Location;
use eng_system::{Dimension, DisplayUnit};
use std::collections::HashMap;

/// A `require` or `advise` as written.
#[derive(Clone, Copy)]
pub(crate) struct Requirement<'a> {
    pub advise: bool,
    /// Its name for `accept`.
    pub name: Option<&'a ast::Name>,
    pub condition: &'a ast::Expr,
    pub message: &'a ast::Name,
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

impl<'a> Elaborator<'a, '_> {
    /// Evaluates a `require` or `advise`. A condition of parameters alone becomes a check of the bind graph.
    /// Another condition is returned with its message.
    pub fn requirement(
        &mut self,
        requirement: Requirement<'a>,
        scope: ScopeId,
        path: &str,
        used_at: Option<Location>,
    ) -> Eval<Option<(Flag, Message)>> {
        let Requirement {
            advise,
            name,
            condition,
            message,
        } = requirement;
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
                let holds = self.graphs.flag_number(flag);
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
                // the line of the user's text, if the object is in the text of the library
                let at = used_at.map_or(condition.span, span_of);
                let program = &self.program;
                let mut uses = self.context.uses.iter().rev().map(|(place, _)| *place);
                let of_user = program
                    .is_library(at.source)
                    .then(|| uses.find(|place| !program.is_library(place.source)));
                let places = |diagnostic: Diagnostic| {
                    let diagnostic = match used_at.map(span_of) {
                        Some(place) => diagnostic
                            .at(place, "used here")
                            .also(condition.span, "this does not hold"),
                        None => diagnostic.at(condition.span, "this does not hold"),
                    };
                    match of_user.flatten() {
                        Some(part) => diagnostic.moved_to(part, "in this part"),
                        None => diagnostic,
                    }
                };
                // the text of a component does not show which part is wrong
                let part = self.context.uses.last().map(|(place, _)| *place);
                if let (false, None, Some(part)) = (advise, used_at, part) {
                    let message = Diagnostic::error(codes::REQUIRED, title(&[path]))
                        .at(part, "this part needs it")
                        .also(condition.span, "this does not hold");
                    return Err(self.report(message));
                }
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
    pub fn report_advised(&mut self) {
        for (mut message, paths) in std::mem::take(&mut self.draft.advised) {
            let paths: Vec<&str> = paths.iter().map(String::as_str).collect();
            message.title = titled(&message.title, &paths);
            self.diagnostics.push(message);
        }
    }

    /// A condition that is true if one of the surrounding `if`s takes its other side.
    pub(super) fn where_it_counts(&mut self, truth: Truth) -> Truth {
        let guards = self.context.guards.clone();
        guards.into_iter().fold(truth, |truth, (guard, _)| {
            let elsewhere = self.graphs.not(guard);
            Truth::Later(match truth {
                Truth::Later(flag) => self.graphs.logic(elsewhere, flag, Op::Or),
                Truth::Known(_) => elsewhere,
            })
        })
    }

    /// The value of a number with the stated values of the parameters; `None` if it follows from the motion or a table.
    fn stated(&self, value: Scalar) -> Option<f64> {
        if value.stage == Stage::Motion {
            return None;
        }
        let graph = &self.graphs.bind.graph;
        let (mut folded, mut known) = (Graph::default(), HashMap::new());
        let mut waiting = vec![value.node];
        while let Some(node) = waiting.last().copied() {
            let op = graph.op(node);
            let needed: Vec<Node> = match op {
                Op::Input(k) if k < FIXED => vec![*self.draft.parameter_defaults.get(k as usize)?],
                op => op.operands().collect(),
            };
            let open = waiting.len();
            waiting.extend(needed.iter().filter(|node| !known.contains_key(*node)));
            if waiting.len() > open {
                continue;
            }
            let found = match (op, needed.first().and_then(|node| known.get(node))) {
                (Op::Input(k), Some(default)) if k < FIXED => *default,
                (Op::Input(k), _) => {
                    let fixed = k
                        .checked_sub(FIXED)
                        .map(|k| self.graphs.bind.fixed.get(k as usize));
                    folded.constant(*fixed.flatten()?)
                }
                (op, _) => {
                    folded.build(op.map_operands(|node| known.get(&node).copied().unwrap_or(node)))
                }
            };
            known.insert(node, found);
            waiting.pop();
        }
        folded.as_constant(*known.get(&value.node)?)
    }

    /// A message with the numbers that are known while compiling, or that follow from the stated values of
    /// parameters. Other expressions appear as written.
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
                } => match self.stated(value) {
                    Some(known) => display.text(known),
                    None => self.sources.text(span).to_owned(),
                },
            })
            .collect()
    }

    /// The dimension of the numbers that a condition compares; `None` for another condition, and for one whose parts compare
    /// numbers of different dimensions.
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
            ast::ExprKind::Binary {
                op: B::And | B::Or,
                left,
                right,
                ..
            } => {
                let left = self.compared(left, scope)?;
                let right = self.compared(right, scope)?;
                Ok(left.filter(|_| left == right))
            }
            ast::ExprKind::Unary {
                op: ast::UnaryOp::Not,
                operand,
            } => self.compared(operand, scope),
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
            let shown = self.evaluate(value, scope)?;
            self.show(shown, (span, unit.as_ref()), scope, &mut found.parts)?;
        }
        Ok(found)
    }

    /// Adds a value to a message: a number with its unit, a text, a word, or a list of them.
    fn show(
        &mut self,
        shown: Value<'a>,
        (span, unit): (Span, Option<&'a ast::UnitExpr>),
        scope: ScopeId,
        parts: &mut Vec<Part>,
    ) -> Eval<()> {
        let value = match shown {
            Value::Scalar(number) => number,
            Value::Int(i) => self.graphs.constant(i as f64),
            Value::Text(text) => {
                parts.push(Part::Text(text));
                return Ok(());
            }
            Value::Choice(id, word) => {
                let word = self.program.word(id, word);
                let word = self.checked(word, span, "no such word")?;
                parts.push(Part::Text(word.to_owned()));
                return Ok(());
            }
            Value::List(values) => {
                parts.push(Part::Text("[".to_owned()));
                for (place, value) in values.into_iter().enumerate() {
                    if place > 0 {
                        parts.push(Part::Text(", ".to_owned()));
                    }
                    self.show(value, (span, unit), scope, parts)?;
                }
                parts.push(Part::Text("]".to_owned()));
                return Ok(());
            }
            other => return Err(self.not_shown(span, &other)),
        };
        let display = match unit {
            Some(unit) => DisplayUnit::from(self.unit(unit)?),
            None => {
                let dimension = self.dimension_at(span, scope)?;
                self.usual_unit(dimension)
            }
        };
        parts.push(Part::Value {
            value,
            display,
            span,
        });
        Ok(())
    }

    fn not_shown(&mut self, span: Span, found: &Value<'_>) -> super::Reported {
        self.report(
            Diagnostic::error(codes::MESSAGE_FORM, "a message shows numbers and texts")
                .at(span, format!("this is {}", found.kind())),
        )
    }
}
