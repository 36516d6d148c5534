//! The statements of a class: states, conditions, constraints, loads.

use super::super::requirement::{Message, Part, Requirement};
use super::super::scalar::{Flag, PROVISIONAL, RowDraft, Scalar, Stage, StateDraft};
use super::super::value::{ScopeId, Value};
use super::super::{Check, Elaborator, Entry, Eval, MessagePart as CheckPart, Reported, location};
use super::Draft;
use crate::codes;
use crate::ir::Node;
use eng_grammar::ast::{BindingKind, ExprKind, ItemKind, Statement};
use eng_grammar::{Diagnostic, Span, ast};
use eng_system::Dimension;
use eng_system::system::{
    Condition, ConditionKind, Location, MessagePart, Origin, Resolution, Row,
};

impl<'a> Elaborator<'a, '_> {
    pub(super) fn states(
        &mut self,
        items: &'a [ast::Item],
        own: ScopeId,
        path: &str,
        used_at: Option<Location>,
    ) -> Eval<()> {
        for item in items {
            let ItemKind::Binding(b) = &item.kind else {
                continue;
            };
            if b.kind != BindingKind::State {
                continue;
            }
            let start = self.checked(
                b.value.as_ref(),
                b.name.span,
                "a state without a start value",
            )?;
            let value = self.evaluate(start, own)?;
            let s = self.as_scalar(value, start.span)?;
            let node = self.bind_node(s, start.span)?;
            let place = b.ty.as_ref().map_or(start.span, |ty| ty.span);
            let dimension = self.dimension_at(place, own)?;
            let scale = self.state_scale(b, node, own, path, used_at)?;
            let Some(element) = self.graphs.element.as_mut() else {
                return Err(Reported);
            };
            let index = element.states.len() as u32;
            if index >= PROVISIONAL.states {
                return Err(self.report(
                    Diagnostic::error(
                        codes::ELEMENT_TOO_LARGE,
                        format!("one element has more than {} states", PROVISIONAL.states),
                    )
                    .at(b.name.span, "the limit is reached here")
                    .with_help("divide it into several elements"),
                ));
            }
            element.states.push(StateDraft {
                name: b.name.text.clone(),
                dimension,
                start: node,
                scale,
                rate: None,
            });
            let input = element.graph.input(PROVISIONAL.state(index));
            self.define(
                own,
                &b.name.text,
                Entry::Value(Value::Scalar(Scalar {
                    stage: Stage::Motion,
                    node: input,
                })),
            );
        }
        Ok(())
    }

    /// The scale of a state, against which its errors are measured: the stated one, else its start. Either
    /// may be known only when parameters are set.
    fn state_scale(
        &mut self,
        state: &'a ast::Binding,
        start: Node,
        own: ScopeId,
        path: &str,
        used_at: Option<Location>,
    ) -> Eval<Node> {
        let name = &state.name.text;
        let (node, span, message) = match &state.scale {
            Some(scale) => {
                let value = self.evaluate(scale, own)?;
                let s = self.as_scalar(value, scale.span)?;
                let message = format!("the scale of the state `{name}` must be positive");
                (self.bind_node(s, scale.span)?, scale.span, message)
            }
            None => {
                let span = state.value.as_ref().map_or(state.name.span, |v| v.span);
                let message = format!(
                    "the state `{name}` starts at zero and has no scale; state the size from which it matters after its start: `… scale …`"
                );
                (self.graphs.bind.graph.abs(start), span, message)
            }
        };
        let graph = &mut self.graphs.bind.graph;
        if graph.as_constant(node).is_none_or(|size| size <= 0.0) {
            let zero = graph.constant(0.0);
            let flag = Flag {
                stage: Stage::Bind,
                node: graph.less(zero, node),
            };
            let holds = self.graphs.flag_number(flag);
            self.draft.checks.push(Check {
                holds,
                advise: false,
                name: String::new(),
                message: vec![CheckPart::Text(message)],
                path: path.to_owned(),
                used_at,
                defined_at: Some(location(span)),
            });
        }
        Ok(node)
    }

    pub(super) fn equations(
        &mut self,
        items: &'a [ast::Item],
        scope: ScopeId,
        path: &str,
        used_at: Option<eng_system::system::Location>,
        draft: &mut Draft,
    ) -> Eval<()> {
        for item in items {
            let ItemKind::Statement(statement) = &item.kind else {
                continue;
            };
            match statement {
                Statement::Constrain(expr) => self.constrain(expr, scope)?,
                Statement::Branch(expr) => {
                    if let super::super::expression::Truth::Later(flag) = self.truth(expr, scope)? {
                        self.refuse_branch_by_field(flag, expr.span)?;
                        let written = Message {
                            text: self.sources.text(expr.span).to_owned(),
                            parts: Vec::new(),
                            compared: self.compared(expr, scope)?,
                        };
                        self.condition(flag, ConditionKind::Branch, "", written, expr.span, draft);
                    }
                }
                Statement::Apply {
                    torque,
                    value,
                    on,
                    against,
                } => self.apply_load(*torque, value, on, against.as_ref(), scope)?,
                Statement::Require {
                    advise,
                    index,
                    name,
                    condition,
                    message,
                } => {
                    let requirement = Requirement {
                        advise: *advise,
                        name: name.as_ref(),
                        condition,
                        message,
                    };
                    self.for_each(index, scope, &mut |e, inner, _| {
                        e.required(requirement, (inner, path, used_at), draft)
                    })?;
                }
                // read before and after the equations
                Statement::Accept(_)
                | Statement::Resolve(_)
                | Statement::Place { .. }
                | Statement::Change { .. } => {}
                Statement::Rate { state, value } => {
                    let v = self.evaluate(value, scope)?;
                    let s = self.as_scalar(v, value.span)?;
                    self.refuse_readings(&[s], value.span)?;
                    let node = self.graphs.lift(s.stage, s.node);
                    let states = self.graphs.element.iter_mut().flat_map(|e| &mut e.states);
                    if let Some(draft) = states.into_iter().find(|d| d.name == state.text) {
                        draft.rate = Some(node);
                    }
                }
                Statement::Start { target, .. } | Statement::Guess { target, .. } => {
                    return self.checked(None, target.span, "a start value in a class");
                }
            }
        }
        Ok(())
    }

    /// A `require` or `advise` of an element: one of the motion becomes a condition of it.
    fn required(
        &mut self,
        requirement: Requirement<'a>,
        (scope, path, used_at): (ScopeId, &str, Option<Location>),
        draft: &mut Draft,
    ) -> Eval<()> {
        if let Some((flag, message)) = self.requirement(requirement, scope, path, used_at)? {
            let kind = if requirement.advise {
                ConditionKind::Advise
            } else {
                ConditionKind::Require
            };
            let name = requirement.name.map_or("", |name| &name.text);
            self.condition(flag, kind, name, message, requirement.condition.span, draft);
        }
        Ok(())
    }

    /// The lengths that positions at the markers of an element must resolve. They are read after the equations, so
    /// that the element's own message about the same number comes first.
    pub(super) fn resolutions(
        &mut self,
        items: &'a [ast::Item],
        scope: ScopeId,
        path: &str,
        used_at: Option<Location>,
    ) -> Eval<()> {
        for item in items {
            let ItemKind::Statement(Statement::Resolve(length)) = &item.kind else {
                continue;
            };
            let value = self.evaluate(length, scope)?;
            let number = self.as_scalar(value, length.span)?;
            let node = self.bind_node(number, length.span)?;
            let zero = self.graphs.bind.graph.constant(0.0);
            let positive = Flag {
                stage: Stage::Bind,
                node: self.graphs.bind.graph.less(zero, node),
            };
            let holds = self.graphs.flag_number(positive);
            let display = self.usual_unit(Dimension::LENGTH);
            self.draft.checks.push(Check {
                holds,
                advise: false,
                name: String::new(),
                message: vec![
                    CheckPart::Text("the length after `resolve` must be positive, not ".to_owned()),
                    CheckPart::Value(node, display),
                ],
                path: path.to_owned(),
                used_at,
                defined_at: Some(location(length.span)),
            });
            let slot = self.slot(node);
            self.draft.resolutions.push(Resolution {
                origin: Origin {
                    path: path.to_owned(),
                    used_at,
                    defined_at: Some(location(length.span)),
                },
                length: slot,
            });
            if let Some(element) = self.graphs.element.as_mut() {
                element.resolves.push(node);
            }
        }
        Ok(())
    }

    /// The places of its parts that an element states for the assembly.
    pub(super) fn placings(&mut self, items: &'a [ast::Item], scope: ScopeId) -> Eval<()> {
        for item in items {
            let ItemKind::Statement(Statement::Place { moving, on, height }) = &item.kind else {
                continue;
            };
            let mut markers = [0; 2];
            for (local, written) in markers.iter_mut().zip([moving, on]) {
                let value = self.evaluate(written, scope)?;
                let marker = self.as_marker(value, written.span)?;
                *local = self.local_marker(marker, Some(written.span))?;
            }
            let height = match height {
                Some(height) => {
                    let value = self.evaluate(height, scope)?;
                    let number = self.as_scalar(value, height.span)?;
                    Some(self.bind_node(number, height.span)?)
                }
                None => None,
            };
            let [moving, on] = markers;
            if let Some(element) = self.graphs.element.as_mut() {
                element.places.push((moving, on, height));
            }
        }
        Ok(())
    }

    pub(in crate::elaborate) fn condition(
        &mut self,
        flag: Flag,
        kind: ConditionKind,
        name: &str,
        message: Message,
        span: Span,
        draft: &mut Draft,
    ) {
        let lifted = self.graphs.lift_flag(flag);
        let Some(element) = self.graphs.element.as_mut() else {
            return;
        };
        if kind == ConditionKind::Stop {
            element.stops.push(lifted);
        }
        let node = element.graph.margin(lifted);
        // the values of the message come after the condition
        let mut next = draft.conditions.len() as u32 + 1;
        let mut parts = Vec::with_capacity(message.parts.len());
        let mut shown = Vec::new();
        for part in message.parts {
            parts.push(match part {
                Part::Text(text) => MessagePart::Text(text),
                Part::Value {
                    value,
                    display,
                    span,
                } => {
                    let entry = Condition {
                        kind: ConditionKind::Shown,
                        name: String::new(),
                        text: self.sources.text(span).to_owned(),
                        message: Vec::new(),
                        dimension: None,
                        defined_at: Some(location(span)),
                    };
                    shown.push((self.graphs.lift(value.stage, value.node), entry));
                    next += 1;
                    MessagePart::Value {
                        index: next - 1,
                        display,
                    }
                }
            });
        }
        draft.conditions.push((
            node,
            Condition {
                kind,
                name: name.to_owned(),
                text: message.text,
                message: parts,
                dimension: message.compared,
                defined_at: Some(location(span)),
            },
        ));
        draft.conditions.extend(shown);
    }

    pub fn constrain(&mut self, expr: &'a ast::Expr, scope: ScopeId) -> Eval<()> {
        let mut inner = expr;
        while let ExprKind::Paren {
            inner: i,
            unit: None,
        } = &inner.kind
        {
            inner = i;
        }
        let ExprKind::Binary {
            op: ast::BinaryOp::Equal,
            left,
            right,
            ..
        } = &inner.kind
        else {
            return self.checked(None, expr.span, "a constraint that is no equation");
        };
        let text = self.sources.text(expr.span).to_owned();
        let a = self.evaluate(left, scope)?;
        let b = self.evaluate(right, scope)?;
        let several = a.is_several() || b.is_several();
        let (x, y) = if several {
            (
                self.as_components(a, left.span)?,
                self.as_components(b, right.span)?,
            )
        } else {
            (
                vec![self.as_scalar(a, left.span)?],
                vec![self.as_scalar(b, right.span)?],
            )
        };
        if x.len() != y.len() {
            return Err(self.lengths(x.len(), left.span, y.len(), right.span));
        }
        let mut dimension = self.dimension_at(left.span, scope)?;
        if dimension.is_one() {
            dimension = self.dimension_at(right.span, scope)?;
        }
        for (i, (p, q)) in x.into_iter().zip(y).enumerate() {
            let difference = self.graphs.subtract(p, q);
            let text = if several {
                format!("{text} ({})", ["x", "y", "z"].get(i).unwrap_or(&"…"))
            } else {
                text.clone()
            };
            self.add_row(difference, dimension, text, expr.span)?;
        }
        Ok(())
    }

    pub fn add_row(
        &mut self,
        value: Scalar,
        dimension: Dimension,
        text: String,
        span: Span,
    ) -> Eval<()> {
        if value.stage == Stage::Bind {
            return Err(self.report(
                Diagnostic::error(
                    codes::UNMOVED,
                    "this constraint does not depend on the motion",
                )
                .at(span, "no motion changes it")
                .with_help("write a condition on parameters as `require`"),
            ));
        }
        let Some(element) = self.graphs.element.as_mut() else {
            return Err(Reported);
        };
        if element.rows.len() as u32 >= PROVISIONAL.rows {
            return Err(self.report(
                Diagnostic::error(
                    codes::ELEMENT_TOO_LARGE,
                    format!("one element has more than {} equations", PROVISIONAL.rows),
                )
                .at(span, "the limit is reached here")
                .with_help("divide it into several elements"),
            ));
        }
        element.rows.push(RowDraft {
            node: value.node,
            row: Row {
                text,
                dimension,
                defined_at: Some(location(span)),
            },
        });
        Ok(())
    }

    pub(super) fn apply_load(
        &mut self,
        torque: bool,
        value: &'a ast::Expr,
        on: &'a ast::Expr,
        against: Option<&'a ast::Expr>,
        scope: ScopeId,
    ) -> Eval<()> {
        let v = self.evaluate(value, scope)?;
        let v = self.as_vector(v, value.span)?;
        self.refuse_readings(&v, value.span)?;
        let on_value = self.evaluate(on, scope)?;
        let a = self.as_marker(on_value, on.span)?;
        let a = self.local_marker(a, Some(on.span))?;
        let b = match against {
            Some(expr) => {
                let value = self.evaluate(expr, scope)?;
                let b = self.as_marker(value, expr.span)?;
                Some(self.local_marker(b, Some(expr.span))?)
            }
            None => None,
        };
        if let Some(element) = self.graphs.element.as_mut() {
            element.applied.push((a, b));
        }
        let back = v.map(|s| self.graphs.negate(s));
        if torque {
            let on_axes = self.along_axes(a, &v);
            self.add_load(a, None, Some(on_axes));
            if let Some(b) = b {
                let back_axes = self.along_axes(b, &back);
                self.add_load(b, None, Some(back_axes));
            }
        } else {
            self.add_load(a, Some(v), None);
            if let Some(b) = b {
                let xa = self.marker_origin(a);
                let xb = self.marker_origin(b);
                let arm = [0, 1, 2].map(|i| self.graphs.subtract(xa[i], xb[i]));
                let moment = self.graphs.cross(&arm, &back);
                let moment_axes = self.along_axes(b, &moment);
                self.add_load(b, Some(back), Some(moment_axes));
            }
        }
        Ok(())
    }

    pub(super) fn add_load(
        &mut self,
        marker: u32,
        force: Option<[Scalar; 3]>,
        torque: Option<[Scalar; 3]>,
    ) {
        let lift = |e: &mut Self, v: Option<[Scalar; 3]>| {
            v.map(|v| v.map(|s| e.graphs.lift(s.stage, s.node)))
        };
        let force = lift(self, force);
        let torque = lift(self, torque);
        let Some(element) = self.graphs.element.as_mut() else {
            return;
        };
        let zero = element.graph.constant(0.0);
        while element.loads.len() <= marker as usize {
            element.loads.push([zero; 6]);
        }
        for (offset, v) in [(0, force), (3, torque)] {
            if let Some(v) = v {
                for (i, n) in v.into_iter().enumerate() {
                    let sum = element
                        .graph
                        .add(element.loads[marker as usize][offset + i], n);
                    element.loads[marker as usize][offset + i] = sum;
                }
            }
        }
    }
}
