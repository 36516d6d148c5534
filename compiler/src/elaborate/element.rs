//! Instances of joints, forces, journals and drives: each becomes a graph of its own.

use super::binding::{Message, Part};
use super::scalar::{ElementBuilder, PROVISIONAL, RowDraft, Scalar, Stage, StateDraft};
use super::value::{Closure, ScopeId, Value};
use super::{
    Argument, Elaborator, ElementSource, Entry, Eval, Lazy, OutputShape, Reported,
    body::index_text, location,
};
use crate::codes;
use crate::ir::Node;
use crate::program::DefinitionId;
use eng_grammar::ast::{
    self, BindingKind, ExprKind, Form, ItemKind, Kind, Statement, TypeExprKind,
};
use eng_grammar::{Diagnostic, Span};
use eng_system::system::{Condition, ConditionKind, MessagePart, Origin, OutputInfo, Role, Row};

/// A class's parts, found in its definition.
#[derive(Clone, Copy)]
pub(crate) struct Class<'a> {
    pub definition: DefinitionId,
    pub declaration: &'a ast::Declaration,
    pub parameters: &'a [ast::Parameter],
    pub block: &'a ast::Block,
}

/// What is gathered while an element is lowered.
pub(crate) struct Draft {
    pub conditions: Vec<(Node, Condition)>,
    pub outputs: Vec<Node>,
    pub infos: Vec<OutputInfo>,
    pub shapes: Vec<OutputShape>,
    pub frames: Vec<Option<u32>>,
    /// Frames of copied channels, by output.
    pub copied: Vec<(usize, String)>,
}

impl<'a> Elaborator<'a, '_> {
    pub fn class_of(&mut self, id: DefinitionId, span: Span) -> Eval<Class<'a>> {
        if let Some(item) = self.program.item(id)
            && let ItemKind::Declaration(declaration) = &item.kind
            && let Form::Class {
                parameters, block, ..
            } = &declaration.form
        {
            return Ok(Class {
                definition: id,
                declaration,
                parameters,
                block,
            });
        }
        Err(self.internal(span, "this is no class"))
    }

    /// `kind name[index] = Class(arguments) { additions }`.
    pub fn elements_of(
        &mut self,
        declaration: &'a ast::Declaration,
        scope: ScopeId,
    ) -> Eval<Value<'a>> {
        let Form::Instance { value, block } = &declaration.form else {
            return Err(self.internal(declaration.name.span, "an element without a class"));
        };
        let name = &declaration.name.text;
        let base = self.path(scope, name);
        let mut made = Vec::new();
        self.for_each(&declaration.index, scope, &mut |e, inner, position| {
            let path = format!("{base}{}", index_text(position));
            let element = e.element(declaration, value, block.as_ref(), inner, path);
            e.bench.element = None;
            made.push((position.to_vec(), Value::Element(element?)));
            Ok(())
        })?;
        if declaration.index.is_empty() {
            made.pop().map(|m| m.1).ok_or(Reported)
        } else {
            Ok(Value::Family(made))
        }
    }

    fn element(
        &mut self,
        declaration: &'a ast::Declaration,
        value: &'a ast::Expr,
        block: Option<&'a ast::Block>,
        scope: ScopeId,
        path: String,
    ) -> Eval<u32> {
        self.count_instance(declaration.name.span)?;
        let ExprKind::Call { callee, arguments } = &value.kind else {
            return Err(self.internal(value.span, "an element that is not called into being"));
        };
        let class = match self.evaluate(callee, scope)? {
            Value::Definition(id) => self.class_of(id, callee.span)?,
            other => return Err(self.unfit(callee.span, "a class", &other)),
        };
        self.bench.element = Some(ElementBuilder::default());
        self.bench.bind.owner.clone_from(&path);
        let bound = self.bind_arguments(class, arguments, scope, &path, value.span)?;
        self.element_of_class(class, bound, block, scope, path, declaration.name.span)
    }

    /// An instance of a class with its arguments.
    pub fn element_of_class(
        &mut self,
        class: Class<'a>,
        bound: Vec<(String, Argument<'a>)>,
        block: Option<&'a ast::Block>,
        scope: ScopeId,
        path: String,
        span: Span,
    ) -> Eval<u32> {
        self.bench.element = Some(ElementBuilder::default());
        self.rates = None;
        self.bench.bind.owner.clone_from(&path);
        let used_at = Some(location(span));
        let source = ElementSource {
            definition: class.definition,
            arguments: bound,
            caller: scope,
        };
        let own = self.class_scope(&source, class, &path)?;
        // marker parameters come first, in their order
        for parameter in class.parameters {
            if is_marker(&parameter.ty) {
                let value = self.entry(own, &parameter.name.text, parameter.span)?;
                self.touch(value)?;
            }
        }
        self.states(class, own)?;
        let at_use = block.map(|b| (b, self.use_scope(own, scope)));
        let mut draft = Draft {
            conditions: Vec::new(),
            outputs: Vec::new(),
            infos: Vec::new(),
            shapes: Vec::new(),
            frames: Vec::new(),
            copied: Vec::new(),
        };
        self.equations(&class.block.items, own, &path, used_at, &mut draft)?;
        if let Some((b, use_scope)) = at_use {
            self.equations(&b.items, use_scope, &path, used_at, &mut draft)?;
        }
        let missing = self
            .bench
            .element
            .as_ref()
            .and_then(|e| e.states.iter().find(|s| s.rate.is_none()))
            .map(|s| s.name.clone());
        if let Some(state) = missing {
            return Err(self.internal(
                class.declaration.name.span,
                &format!("state `{state}` has no rate"),
            ));
        }
        if let Some(element) = self.bench.element.as_mut() {
            let zero = element.graph.constant(0.0);
            let mut rates: Vec<Node> = element.states.iter().filter_map(|s| s.rate).collect();
            rates.resize(PROVISIONAL.states as usize, zero);
            self.rates = Some(rates);
        }
        self.in_output = true;
        let outputs = self
            .class_outputs(&class.block.items, own, &mut draft)
            .and_then(|()| match at_use {
                Some((b, use_scope)) => self.class_outputs(&b.items, use_scope, &mut draft),
                None => Ok(()),
            })
            .and_then(|()| self.reaction_outputs(class, &mut draft));
        self.in_output = false;
        self.rates = None;
        outputs?;
        self.asked(&mut draft);
        let journal = if class.declaration.kind == Kind::Journal {
            self.journal_info(own)
        } else {
            None
        };
        let origin = Origin {
            path,
            used_at,
            defined_at: Some(location(class.declaration.name.span)),
        };
        let index = self.finish_element(
            origin,
            span,
            Role::Dynamic,
            class.declaration.name.text.clone(),
            Some(source),
            draft,
        )?;
        if let Some(mut info) = journal {
            info.element = index;
            self.journals.push(info);
        }
        Ok(index)
    }

    /// Evaluates the arguments of a class; numbers become parameters of the instance.
    pub fn bind_arguments(
        &mut self,
        class: Class<'a>,
        arguments: &'a [ast::Argument],
        scope: ScopeId,
        path: &str,
        span: Span,
    ) -> Eval<Vec<(String, Argument<'a>)>> {
        let mut bound: Vec<(String, Argument<'a>)> = Vec::new();
        let mut grounds: Vec<(usize, Span)> = Vec::new();
        let mut partner = None;
        let mut position = 0;
        for argument in arguments {
            let parameter = match &argument.name {
                Some(name) => class.parameters.iter().find(|p| p.name.text == name.text),
                None => {
                    position += 1;
                    class.parameters.get(position - 1)
                }
            };
            let Some(parameter) = parameter else {
                return Err(self.internal(argument.value.span, "no parameter of the class"));
            };
            let name = parameter.name.text.clone();
            let value = self.evaluate(&argument.value, scope)?;
            let value = match value {
                Value::Ground if is_marker(&parameter.ty) => {
                    grounds.push((bound.len(), argument.value.span));
                    Value::Ground
                }
                Value::Marker(m) => {
                    self.used_marker(m);
                    partner = partner.or(Some(m));
                    Value::Marker(m)
                }
                Value::Table(mut t) => {
                    // the handle stays out of the code, so that instances share it
                    if let Some(known) = self.bench.bind.graph.as_constant(t.handle) {
                        t.handle = self.bench.bind.fixed(known);
                    }
                    Value::Table(t)
                }
                value if is_structural(&parameter.ty) => value,
                value => self.parameterise(
                    value,
                    &format!("{path}.{name}"),
                    Some(&argument.value),
                    parameter.limits.as_ref(),
                    argument.value.span,
                    scope,
                )?,
            };
            let moves = value.moves();
            bound.push((
                name,
                if moves {
                    Argument::Again(&argument.value)
                } else {
                    Argument::Value(value)
                },
            ));
        }
        for (index, ground_span) in grounds {
            let Some(partner) = partner else {
                return Err(self.report(
                    Diagnostic::error(codes::GROUND_ALONE, "`ground` has no partner marker")
                        .at(ground_span, "it lies where the element's other marker is, but there is none")
                        .with_help("name a marker of the model, which is on the ground: `marker rail = [0, 0, 0] mm`"),
                ));
            };
            let marker = self.ground_at(partner, format!("ground at {path}"), ground_span);
            bound[index].1 = Argument::Value(Value::Marker(marker));
        }
        for parameter in class.parameters {
            if parameter.default.is_none() && !bound.iter().any(|(n, _)| *n == parameter.name.text)
            {
                return Err(self.internal(
                    span,
                    &format!("argument `{}` is missing", parameter.name.text),
                ));
            }
        }
        Ok(bound)
    }

    /// The names inside a class for one instance.
    pub fn class_scope(
        &mut self,
        source: &ElementSource<'a>,
        class: Class<'a>,
        path: &str,
    ) -> Eval<ScopeId> {
        let own = self.new_scope(None, class.definition.module, path.to_owned());
        for (name, argument) in &source.arguments {
            let value = match argument {
                Argument::Value(v) => v.clone(),
                Argument::Again(expr) => self.evaluate(expr, source.caller)?,
            };
            self.define(own, name, Entry::Value(value));
        }
        for parameter in class.parameters {
            let name = &parameter.name.text;
            if !self.scope(own).entries.contains_key(name) {
                // a default becomes a parameter of the instance the first time
                let parameter_path = format!("{path}.{name}");
                let known = self
                    .parameters
                    .iter()
                    .position(|p| p.origin.path == parameter_path);
                if let Some(index) = known {
                    let node = self.bench.bind.graph.input(index as u32);
                    let dimension = self.parameters[index].dimension;
                    let value = Value::Scalar(Scalar {
                        stage: Stage::Bind,
                        node,
                        dimension,
                    });
                    self.define(own, name, Entry::Value(value));
                } else if let Some(default) = &parameter.default {
                    let value = self.evaluate(default, own)?;
                    let value = if is_structural(&parameter.ty) {
                        value
                    } else {
                        self.parameterise(
                            value,
                            &parameter_path,
                            Some(default),
                            parameter.limits.as_ref(),
                            parameter.span,
                            own,
                        )?
                    };
                    self.define(own, name, Entry::Value(value));
                }
            }
        }
        self.register(&class.block.items, own);
        Ok(own)
    }

    /// Makes lets, consts, outputs, functions and tables of a block known; they are evaluated when asked for.
    pub fn register(&mut self, items: &'a [ast::Item], scope: ScopeId) {
        for item in items {
            match &item.kind {
                ItemKind::Binding(b)
                    if matches!(
                        b.kind,
                        BindingKind::Let | BindingKind::Const | BindingKind::Output
                    ) && !self.scope(scope).entries.contains_key(&b.name.text) =>
                {
                    self.define(scope, &b.name.text, Entry::Lazy(Lazy::Binding(b)));
                }
                ItemKind::Function(function) => self.define(
                    scope,
                    &function.name.text,
                    Entry::Value(Value::Closure(Closure { function, scope })),
                ),
                ItemKind::Table(t) => {
                    self.define(scope, &t.name.text, Entry::Lazy(Lazy::Table(t)));
                }
                _ => {}
            }
        }
    }

    /// Names of the class before those of the place where it is used.
    fn use_scope(&mut self, own: ScopeId, caller: ScopeId) -> ScopeId {
        let module = self.scope(caller).module;
        let path = self.scope(own).path.clone();
        let inner = self.new_scope(Some(caller), module, path);
        let names: Vec<String> = self.scope(own).entries.keys().cloned().collect();
        for name in names {
            self.define(inner, &name, Entry::In(own));
        }
        inner
    }

    fn touch(&mut self, value: Value<'a>) -> Eval<()> {
        match value {
            Value::Marker(m) => self.local_marker(m, None).map(|_| ()),
            Value::List(items) => items.into_iter().try_for_each(|v| self.touch(v)),
            _ => Ok(()),
        }
    }

    fn states(&mut self, class: Class<'a>, own: ScopeId) -> Eval<()> {
        for item in &class.block.items {
            let ItemKind::Binding(b) = &item.kind else {
                continue;
            };
            if b.kind != BindingKind::State {
                continue;
            }
            let Some(start) = &b.value else {
                return Err(self.internal(b.name.span, "a state without a start value"));
            };
            let value = self.evaluate(start, own)?;
            let s = self.as_scalar(value, start.span)?;
            let node = self.bind_node(s, start.span)?;
            let dimension = b.ty.as_ref().map_or(s.dimension, |t| self.dimension(t));
            let Some(element) = self.bench.element.as_mut() else {
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
                rate: None,
            });
            let input = element.graph.input(PROVISIONAL.state(index));
            self.define(
                own,
                &b.name.text,
                Entry::Value(Value::Scalar(Scalar {
                    stage: Stage::Motion,
                    node: input,
                    dimension,
                })),
            );
        }
        Ok(())
    }

    fn equations(
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
                    if let super::expression::Truth::Later(flag) = self.truth(expr, scope)? {
                        let written = Message {
                            text: self.sources.text(expr.span).to_owned(),
                            parts: Vec::new(),
                        };
                        self.condition(flag, ConditionKind::Branch, written, expr.span, draft);
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
                    condition,
                    message,
                } => {
                    if let Some((flag, message)) =
                        self.requirement(*advise, condition, message, scope, path, used_at)?
                    {
                        let kind = if *advise {
                            ConditionKind::Advise
                        } else {
                            ConditionKind::Require
                        };
                        self.condition(flag, kind, message, condition.span, draft);
                    }
                }
                Statement::Rate { state, value } => {
                    let v = self.evaluate(value, scope)?;
                    let s = self.as_scalar(v, value.span)?;
                    let node = self.bench.lift(s.stage, s.node);
                    if let Some(element) = self.bench.element.as_mut() {
                        match element.states.iter_mut().find(|d| d.name == state.text) {
                            Some(d) => d.rate = Some(node),
                            None => {
                                return Err(self.internal(state.span, "no state of this class"));
                            }
                        }
                    }
                }
                Statement::Start { target, .. } | Statement::Guess { target, .. } => {
                    return Err(self.internal(target.span, "a start value in a class"));
                }
            }
        }
        Ok(())
    }

    /// Conditions of the functions that the element has called.
    pub fn asked(&mut self, draft: &mut Draft) {
        let asked = self
            .bench
            .element
            .as_mut()
            .map(|element| std::mem::take(&mut element.asked));
        for asked in asked.into_iter().flatten() {
            let kind = if asked.advise {
                ConditionKind::Advise
            } else {
                ConditionKind::Require
            };
            self.condition(asked.flag, kind, asked.message, asked.span, draft);
        }
    }

    fn condition(
        &mut self,
        flag: super::scalar::Flag,
        kind: ConditionKind,
        message: Message,
        span: Span,
        draft: &mut Draft,
    ) {
        let lifted = self.bench.lift_flag(flag);
        let Some(element) = self.bench.element.as_mut() else {
            return;
        };
        let node = element.graph.margin(lifted);
        // the values that the message shows follow the condition
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
                        text: self.sources.text(span).to_owned(),
                        message: Vec::new(),
                        defined_at: Some(location(span)),
                    };
                    shown.push((self.bench.lift(value.stage, value.node), entry));
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
                text: message.text,
                message: parts,
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
            return Err(self.internal(expr.span, "a constraint that is no equation"));
        };
        let text = self.sources.text(expr.span).to_owned();
        let a = self.evaluate(left, scope)?;
        let b = self.evaluate(right, scope)?;
        let several = matches!(a, Value::Vector(_) | Value::List(_))
            || matches!(b, Value::Vector(_) | Value::List(_));
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
        for (i, (p, q)) in x.into_iter().zip(y).enumerate() {
            let mut difference = self.bench.subtract(p, q);
            if p.dimension.is_one() && !q.dimension.is_one() {
                difference.dimension = q.dimension;
            }
            let text = if several {
                format!("{text} ({})", ["x", "y", "z"].get(i).unwrap_or(&"…"))
            } else {
                text.clone()
            };
            self.add_row(difference, text, expr.span)?;
        }
        Ok(())
    }

    pub fn add_row(&mut self, value: Scalar, text: String, span: Span) -> Eval<()> {
        if value.stage == Stage::Bind {
            return Err(self.report(
                Diagnostic::error(
                    codes::UNMOVED,
                    "this constraint does not depend on the motion",
                )
                .at(span, "nothing can move to fulfil it")
                .with_help("what parameters must fulfil is a `require`"),
            ));
        }
        let Some(element) = self.bench.element.as_mut() else {
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
                dimension: value.dimension,
                defined_at: Some(location(span)),
            },
        });
        Ok(())
    }

    fn apply_load(
        &mut self,
        torque: bool,
        value: &'a ast::Expr,
        on: &'a ast::Expr,
        against: Option<&'a ast::Expr>,
        scope: ScopeId,
    ) -> Eval<()> {
        let v = self.evaluate(value, scope)?;
        let v = self.as_vector(v, value.span)?;
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
        let back = v.map(|s| self.bench.negate(s));
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
                let arm = [0, 1, 2].map(|i| self.bench.subtract(xa[i], xb[i]));
                let moment = self.bench.cross(&arm, &back);
                let moment_axes = self.along_axes(b, &moment);
                self.add_load(b, Some(back), Some(moment_axes));
            }
        }
        Ok(())
    }

    fn add_load(&mut self, marker: u32, force: Option<[Scalar; 3]>, torque: Option<[Scalar; 3]>) {
        let lift = |e: &mut Self, v: Option<[Scalar; 3]>| {
            v.map(|v| v.map(|s| e.bench.lift(s.stage, s.node)))
        };
        let force = lift(self, force);
        let torque = lift(self, torque);
        let Some(element) = self.bench.element.as_mut() else {
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

pub(crate) fn is_marker(ty: &ast::TypeExpr) -> bool {
    match &ty.kind {
        TypeExprKind::Name(n) => n.text == "Marker",
        TypeExprKind::Array(inner, _) => is_marker(inner),
        _ => false,
    }
}

fn is_structural(ty: &ast::TypeExpr) -> bool {
    match &ty.kind {
        TypeExprKind::Name(n) => {
            matches!(
                n.text.as_str(),
                "Int" | "Bool" | "Text" | "Marker" | "Body" | "ModeSet"
            )
        }
        TypeExprKind::Array(inner, _) => is_structural(inner),
        TypeExprKind::Function(..) => true,
        _ => false,
    }
}
