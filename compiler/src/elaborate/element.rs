//! Instances of joints, forces, journals and drives: each becomes a graph of its own.

use super::scalar::{
    ElementBuilder, PROVISIONAL, RowDraft, Scalar, Stage, StateDraft, compact_input,
};
use super::value::{Closure, ScopeId, Value};
use super::{
    Argument, ClassMeta, Elaborator, ElementDraft, ElementSource, Entry, Eval, Lazy, OutputShape,
    Reported, body::index_text, location,
};
use crate::ir::{ClassBody, Graph, Node, Op};
use crate::program::DefinitionId;
use eng_grammar::ast::{
    self, BindingKind, ExprKind, Form, ItemKind, Kind, Statement, TypeExprKind,
};
use eng_grammar::{Diagnostic, Span};
use eng_system::layout::InputLayout;
use eng_system::system::{
    Channel, Condition, ConditionKind, JournalInfo, Origin, OutputInfo, Role, Row, StateInfo,
};
use eng_system::{Dimension, DisplayUnit};

/// A class's parts, found in its definition.
#[derive(Clone, Copy)]
pub(crate) struct Class<'a> {
    pub definition: DefinitionId,
    pub declaration: &'a ast::Declaration,
    pub parameters: &'a [ast::Parameter],
    pub block: &'a ast::Block,
}

/// Conditions while an element is lowered.
struct Draft {
    conditions: Vec<(Node, Condition)>,
    outputs: Vec<Node>,
    infos: Vec<OutputInfo>,
    shapes: Vec<OutputShape>,
    frames: Vec<Option<u32>>,
    /// Frames of copied channels, by output.
    copied: Vec<(usize, String)>,
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
        Err(self
            .report(Diagnostic::error("E0500", "this is not a class").at(span, "used as a class")))
    }

    /// `kind name[index] = Class(arguments) { additions }`.
    pub fn elements_of(&mut self, declaration: &'a ast::Declaration, scope: ScopeId) -> Eval<()> {
        let Form::Instance { value, block } = &declaration.form else {
            return Err(self.report(
                Diagnostic::error("E0500", "an element is an instance of a class")
                    .at(declaration.name.span, "write `name = Class(…)`"),
            ));
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
        let value = if declaration.index.is_empty() {
            made.pop().ok_or(Reported)?.1
        } else {
            Value::Family(made)
        };
        self.define(scope, name, Entry::Value(value));
        Ok(())
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
            return Err(self.report(
                Diagnostic::error("E0500", "an element is made by calling a class")
                    .at(value.span, "not a call"),
            ));
        };
        let class = match self.evaluate(callee, scope)? {
            Value::Definition(id) => self.class_of(id, callee.span)?,
            other => return Err(self.unfit(callee.span, "a class", &other)),
        };
        self.bench.element = Some(ElementBuilder::default());
        self.rates = None;
        let used_at = Some(location(declaration.name.span));
        let bound = self.bind_arguments(class, arguments, scope, &path, value.span)?;
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
            return Err(self.report(
                Diagnostic::error("E0511", format!("state {state} has no rate")).at(
                    class.declaration.name.span,
                    format!("add `der({state}) = …`"),
                ),
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
            declaration.name.span,
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
                return Err(self.report(
                    Diagnostic::error("E0403", "the class has no such parameter")
                        .at(argument.value.span, "here")
                        .also(class.declaration.name.span, "the class"),
                ));
            };
            let name = parameter.name.text.clone();
            let value = self.evaluate(&argument.value, scope)?;
            let value = match value {
                Value::Ground if is_marker(&parameter.ty) => {
                    grounds.push((bound.len(), argument.value.span));
                    Value::Ground
                }
                Value::Marker(m) => {
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
                    Diagnostic::error("E0509", "`ground` needs a partner marker")
                        .at(ground_span, "no other marker in this call")
                        .with_help("name a marker of the model: `marker rail = [0, 0, 0] mm`"),
                ));
            };
            let marker = self.ground_at(partner, format!("ground at {path}"), ground_span);
            bound[index].1 = Argument::Value(Value::Marker(marker));
        }
        for parameter in class.parameters {
            if parameter.default.is_none() && !bound.iter().any(|(n, _)| *n == parameter.name.text)
            {
                return Err(self.report(
                    Diagnostic::error(
                        "E0402",
                        format!("argument {} is missing", parameter.name.text),
                    )
                    .at(span, "in this call")
                    .also(parameter.span, "the parameter"),
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
                return Err(self.report(
                    Diagnostic::error("E0511", format!("state {} has no start value", b.name.text))
                        .at(b.name.span, "add `= value`"),
                ));
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
                    Diagnostic::error("E0512", "a class has too many states")
                        .at(b.name.span, "the limit is reached here"),
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
                        let text = self.sources.text(expr.span).to_owned();
                        self.condition(flag, ConditionKind::Branch, text, expr.span, draft);
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
                    if let Some((flag, text)) =
                        self.requirement(*advise, condition, message, scope, path, used_at)?
                    {
                        let kind = if *advise {
                            ConditionKind::Advise
                        } else {
                            ConditionKind::Require
                        };
                        self.condition(flag, kind, text, condition.span, draft);
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
                                return Err(self.report(
                                    Diagnostic::error(
                                        "E0511",
                                        format!("there is no state {}", state.text),
                                    )
                                    .at(state.span, "not a state of this class"),
                                ));
                            }
                        }
                    }
                }
                Statement::Start { target, .. } | Statement::Guess { target, .. } => {
                    return Err(self.report(
                        Diagnostic::error("E0511", "start values stand in the model or in a body")
                            .at(target.span, "not in a class or at a use")
                            .with_help(
                                "write it as an item of the model: `start joint.angle = 30 deg`",
                            ),
                    ));
                }
            }
        }
        Ok(())
    }

    fn condition(
        &mut self,
        flag: super::scalar::Flag,
        kind: ConditionKind,
        text: String,
        span: Span,
        draft: &mut Draft,
    ) {
        let lifted = self.bench.lift_flag(flag);
        if let Some(element) = self.bench.element.as_mut() {
            let yes = element.graph.constant(1.0);
            let no = element.graph.constant(-1.0);
            let node = element.graph.select(lifted, yes, no);
            draft.conditions.push((
                node,
                Condition {
                    kind,
                    text,
                    defined_at: Some(location(span)),
                },
            ));
        }
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
            return Err(self.report(
                Diagnostic::error("E0511", "a constraint is an equation")
                    .at(expr.span, "write `left == right`"),
            ));
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
            return Err(self.report(
                Diagnostic::error("E0500", "both sides differ in length").at(expr.span, "here"),
            ));
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
                Diagnostic::error("E0511", "this equation does not depend on the motion")
                    .at(span, "nothing can move to fulfil it"),
            ));
        }
        let Some(element) = self.bench.element.as_mut() else {
            return Err(Reported);
        };
        if element.rows.len() as u32 >= PROVISIONAL.rows {
            return Err(self.report(
                Diagnostic::error("E0512", "a class has too many equations")
                    .at(span, "the limit is reached here"),
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

    fn class_outputs(
        &mut self,
        items: &'a [ast::Item],
        scope: ScopeId,
        draft: &mut Draft,
    ) -> Eval<()> {
        for item in items {
            let ItemKind::Binding(b) = &item.kind else {
                continue;
            };
            if b.kind != BindingKind::Output {
                continue;
            }
            let Some(expr) = &b.value else { continue };
            let value = if self.scope(scope).entries.contains_key(&b.name.text) {
                self.entry(scope, &b.name.text, b.name.span)?
            } else {
                self.evaluate(expr, scope)?
            };
            let frame = match &b.frame {
                Some(frame_expr) => {
                    let f = self.evaluate(frame_expr, scope)?;
                    match f {
                        Value::Ground => None,
                        other => {
                            let marker = self.as_marker(other, frame_expr.span)?;
                            Some((marker, self.sources.text(frame_expr.span).to_owned()))
                        }
                    }
                }
                None => None,
            };
            let display = match &b.display {
                Some(u) => {
                    let unit = self.unit(u)?;
                    Some(DisplayUnit {
                        symbol: unit.symbol,
                        scale: unit.scale,
                        offset: unit.offset,
                    })
                }
                None => None,
            };
            let declared = b.ty.as_ref().map(|t| self.dimension(t));
            self.add_output(
                &b.name.text,
                value,
                expr.span,
                frame,
                display,
                declared,
                draft,
            )?;
        }
        Ok(())
    }

    /// Adds an output: vectors become components along the frame's axes.
    #[allow(clippy::too_many_arguments)]
    fn add_output(
        &mut self,
        name: &str,
        value: Value<'a>,
        span: Span,
        frame: Option<(u32, String)>,
        display: Option<DisplayUnit>,
        declared: Option<Dimension>,
        draft: &mut Draft,
    ) -> Eval<()> {
        let is_vector = matches!(value, Value::Vector(_));
        let (components, single) = match value {
            Value::Vector(v) => match &frame {
                Some((marker, _)) => {
                    let local = self.local_marker(*marker, Some(span))?;
                    (self.along_axes(local, &v).to_vec(), false)
                }
                None => (v.to_vec(), false),
            },
            Value::List(_) => (self.as_components(value, span)?, false),
            Value::Flag(flag) => {
                let one = self.bench.constant(1.0, Dimension::ONE);
                let zero = self.bench.constant(0.0, Dimension::ONE);
                (vec![self.bench.select(flag, one, zero)], true)
            }
            other => (vec![self.as_scalar(other, span)?], true),
        };
        let first = draft.outputs.len() as u32;
        let frame_name = match (&frame, is_vector) {
            (Some((_, text)), _) => text.clone(),
            (None, true) => "ground".to_owned(),
            (None, false) => String::new(),
        };
        let count = components.len() as u32;
        for (i, s) in components.into_iter().enumerate() {
            let node = self.bench.lift(s.stage, s.node);
            let dimension = declared.unwrap_or(s.dimension);
            draft.outputs.push(node);
            draft.frames.push(frame.as_ref().map(|f| f.0));
            let suffix = match (single, ["x", "y", "z"].get(i)) {
                (true, _) => String::new(),
                (false, Some(axis)) if count <= 3 => format!(".{axis}"),
                _ => format!("[{}]", i + 1),
            };
            draft.infos.push(OutputInfo {
                name: format!("{name}{suffix}"),
                dimension,
                display: display
                    .clone()
                    .unwrap_or_else(|| self.natural_unit(dimension)),
                frame: frame_name.clone(),
            });
        }
        draft.shapes.push(OutputShape {
            name: name.to_owned(),
            first,
            count: if single { 1 } else { count },
        });
        Ok(())
    }

    /// Joints and drives: the wrench on the first marker from the constraints, at its origin, in the second marker's axes.
    fn reaction_outputs(&mut self, class: Class<'a>, draft: &mut Draft) -> Eval<()> {
        if !matches!(class.declaration.kind, Kind::Joint | Kind::Drive) {
            return Ok(());
        }
        let Some(element) = self.bench.element.as_mut() else {
            return Ok(());
        };
        if element.rows.is_empty() || element.markers.len() < 2 {
            return Ok(());
        }
        let g = &mut element.graph;
        let mut power = g.constant(0.0);
        for (i, row) in element.rows.iter().enumerate() {
            let lambda = g.input(PROVISIONAL.multiplier(i as u32));
            let p = g.multiply(lambda, row.node);
            power = g.add(power, p);
        }
        let first = PROVISIONAL.marker(0);
        let inputs: Vec<u32> = (first..first + 12).collect();
        let gradient = crate::ir::differentiate::gradient(g, power, &inputs);
        let scalar = |node, dimension| Scalar {
            stage: Stage::Motion,
            node,
            dimension,
        };
        let newton = Dimension::MASS
            .times(Dimension::LENGTH)
            .over(Dimension::TIME)
            .over(Dimension::TIME);
        let newton_metre = newton.times(Dimension::LENGTH);
        let force = [0, 1, 2].map(|i| {
            let n = g.negate(gradient[i]);
            scalar(n, newton)
        });
        // δR = R δπ~ : torque k in marker axes is Σ ∂/∂R_ij (R e_k~)_ij with (R e_k~) = columns of R crossed
        let r: Vec<Node> = (0..9).map(|i| g.input(first + 3 + i)).collect();
        let torque = [0usize, 1, 2].map(|k| {
            let (i1, i2) = ((k + 1) % 3, (k + 2) % 3);
            let mut sum = g.constant(0.0);
            for row in 0..3 {
                // column i1 of R e_k~ is column i2 of R; column i2 is minus column i1
                let p = g.multiply(gradient[3 + 3 * row + i1], r[3 * row + i2]);
                sum = g.add(sum, p);
                let q = g.multiply(gradient[3 + 3 * row + i2], r[3 * row + i1]);
                sum = g.subtract(sum, q);
            }
            let n = g.negate(sum);
            scalar(n, newton_metre)
        });
        let second = element.markers[1];
        let torque = self.rotate(0, &torque);
        let frame_name = class
            .parameters
            .iter()
            .filter(|p| is_marker(&p.ty))
            .nth(1)
            .map_or_else(|| "reference".to_owned(), |p| p.name.text.clone());
        for (name, vector) in [("force", force), ("torque", torque)] {
            if draft.shapes.iter().all(|s| s.name != name) {
                self.add_output(
                    name,
                    Value::Vector(vector),
                    class.declaration.name.span,
                    Some((second, frame_name.clone())),
                    None,
                    None,
                    draft,
                )?;
            }
        }
        Ok(())
    }

    fn journal_info(&mut self, own: ScopeId) -> Option<JournalInfo> {
        let number = |e: &mut Self, name: &str| match e.scope(own).entries.get(name) {
            Some(Entry::Value(Value::Scalar(s))) if s.stage == Stage::Bind => {
                let node = s.node;
                Some(e.slot(node))
            }
            _ => None,
        };
        let marker = |e: &mut Self, name: &str| match e.scope(own).entries.get(name) {
            Some(Entry::Value(Value::Marker(m))) => {
                let m = *m;
                let local = e
                    .bench
                    .element
                    .as_ref()
                    .and_then(|b| b.markers.iter().position(|x| *x == m));
                local.map(|i| i as u32)
            }
            _ => None,
        };
        Some(JournalInfo {
            element: 0,
            diameter: number(self, "diameter")?,
            width: number(self, "width")?,
            radial_clearance: number(self, "radial_clearance")?,
            pin: marker(self, "pin")?,
            shell: marker(self, "shell")?,
        })
    }

    /// Closes the element being lowered: compact layout, channels, draft of the class.
    fn finish_element(
        &mut self,
        origin: Origin,
        span: Span,
        role: Role,
        class_name: String,
        source: Option<ElementSource<'a>>,
        draft: Draft,
    ) -> Eval<u32> {
        let Some(mut element) = self.bench.element.take() else {
            return Err(Reported);
        };
        let layout = element.layout();
        let zero = element.graph.constant(0.0);
        element.loads.resize(element.markers.len(), [zero; 6]);
        if element.constants.len() as u32 > PROVISIONAL.constants
            || element.signals.len() as u32 > PROVISIONAL.signals
        {
            return Err(self.report(
                Diagnostic::error("E0512", "one element uses too many numbers")
                    .at(span, "the limit is reached here"),
            ));
        }
        let (graph, map) = compact(&element.graph, &layout);
        let at = |n: &Node| map[n.0 as usize];
        let body = ClassBody {
            name: class_name.clone(),
            layout,
            rows: element.rows.iter().map(|r| at(&r.node)).collect(),
            loads: element
                .loads
                .iter()
                .map(|l| [0, 1, 2, 3, 4, 5].map(|i| at(&l[i])))
                .collect(),
            rates: element
                .states
                .iter()
                .filter_map(|s| s.rate.as_ref().map(at))
                .collect(),
            outputs: draft.outputs.iter().map(at).collect(),
            conditions: draft.conditions.iter().map(|c| at(&c.0)).collect(),
            rotations: element.rotations.iter().map(|r| at(&r.2)).collect(),
            graph,
        };
        let index = self.elements.len() as u32;
        let first_channel = self.channels.len() as u32;
        if matches!(role, Role::Dynamic | Role::Output) {
            for (i, info) in draft.infos.iter().enumerate() {
                let copied = draft.copied.iter().find(|(output, _)| *output == i);
                let frame = match (copied, draft.frames[i]) {
                    (Some((_, path)), _) => path.clone(),
                    (None, Some(marker)) => self.markers[marker as usize].origin.path.clone(),
                    (None, None) => info.frame.clone(),
                };
                let path = match (role, info.name.as_str()) {
                    // a model's own output is its element
                    (Role::Output, name) => match name.find(['.', '[']) {
                        Some(at) => format!("{}{}", origin.path, &name[at..]),
                        None => origin.path.clone(),
                    },
                    (_, name) => format!("{}.{name}", origin.path),
                };
                self.channels.push(Channel {
                    path,
                    element: index,
                    output: i as u32,
                    dimension: info.dimension,
                    display: info.display.clone(),
                    frame,
                });
            }
        }
        let meta = ClassMeta {
            rows: element.rows.iter().map(|r| r.row.clone()).collect(),
            states: element
                .states
                .iter()
                .map(|s| StateInfo {
                    name: s.name.clone(),
                    dimension: s.dimension,
                })
                .collect(),
            outputs: draft.infos,
            conditions: draft.conditions.into_iter().map(|c| c.1).collect(),
        };
        self.elements.push(ElementDraft {
            origin,
            span,
            role,
            source,
            outputs: draft.shapes,
            first_channel,
            class_name,
            body,
            meta,
            markers: element.markers,
            constants: element.constants,
            state_start: element.states.iter().map(|s| s.start).collect(),
            signals: element.signals,
        });
        Ok(index)
    }

    /// `joint.output` and the names of its class.
    pub fn element_field(&mut self, index: u32, name: &ast::Name) -> Eval<Value<'a>> {
        let draft = &self.elements[index as usize];
        let shape = draft.outputs.iter().find(|s| s.name == name.text).cloned();
        let first_channel = draft.first_channel;
        let source = draft.source.clone();
        let path = draft.origin.path.clone();
        if let Some(shape) = shape
            && self.in_output
            && !self.in_rate
        {
            let mut scalars = Vec::new();
            for k in 0..shape.count {
                let channel = first_channel + shape.first + k;
                let dimension = self.channels[channel as usize].dimension;
                let Some(element) = self.bench.element.as_mut() else {
                    return Err(Reported);
                };
                scalars.push(Scalar {
                    stage: Stage::Motion,
                    node: element.signal(channel),
                    dimension,
                });
            }
            return Ok(match scalars.as_slice() {
                [one] if shape.count == 1 => Value::Scalar(*one),
                many => Self::list(many),
            });
        }
        let Some(source) = source else {
            return Err(Reported);
        };
        let class = self.class_of(source.definition, name.span)?;
        let own = self.class_scope(&source, class, &path)?;
        if self.scope(own).entries.contains_key(&name.text) {
            return self.entry(own, &name.text, name.span);
        }
        Err(self.report(
            Diagnostic::error("E0203", format!("{path} has no {}", name.text))
                .at(name.span, "no such output or parameter")
                .with_help(if self.in_rate {
                    "the rate of a reaction or a state is not known; only kinematic outputs have a `der`"
                } else {
                    "reactions and states of other elements are known in outputs only"
                }),
        ))
    }

    /// An element that is only a start condition: rows = value − target.
    pub fn start_element(
        &mut self,
        role: Role,
        path: String,
        span: Span,
        rows: Vec<(Scalar, String)>,
    ) -> Eval<()> {
        for (value, text) in rows {
            self.add_row(value, text, span)?;
        }
        let origin = Origin {
            path,
            used_at: Some(location(span)),
            defined_at: None,
        };
        self.finish_element(
            origin,
            span,
            role,
            "start".into(),
            None,
            Draft {
                conditions: Vec::new(),
                outputs: Vec::new(),
                infos: Vec::new(),
                shapes: Vec::new(),
                frames: Vec::new(),
                copied: Vec::new(),
            },
        )?;
        Ok(())
    }

    /// An element that has outputs only. The frame of a copied component is that of its channel.
    pub fn output_element(
        &mut self,
        path: String,
        declared: Option<Dimension>,
        values: Vec<(String, Value<'a>)>,
        frame: Option<(u32, String)>,
        display: Option<DisplayUnit>,
        span: Span,
    ) -> Eval<u32> {
        let mut draft = Draft {
            conditions: Vec::new(),
            outputs: Vec::new(),
            infos: Vec::new(),
            shapes: Vec::new(),
            frames: Vec::new(),
            copied: Vec::new(),
        };
        for (name, value) in values {
            self.add_output(
                &name,
                value,
                span,
                frame.clone(),
                display.clone(),
                declared,
                &mut draft,
            )?;
        }
        for (i, node) in draft.outputs.iter().enumerate() {
            if let Some(element) = self.bench.element.as_ref()
                && let Op::Input(input) = element.graph.op(*node)
                && input >= PROVISIONAL.signal(0)
            {
                let channel = element.signals[(input - PROVISIONAL.signal(0)) as usize];
                let copied = &self.channels[channel as usize];
                draft.copied.push((i, copied.frame.clone()));
                if display.is_none() && declared.is_none() {
                    draft.infos[i].display = copied.display.clone();
                }
            }
        }
        let origin = Origin {
            path,
            used_at: Some(location(span)),
            defined_at: None,
        };
        self.finish_element(origin, span, Role::Output, "output".into(), None, draft)
    }
}

fn is_marker(ty: &ast::TypeExpr) -> bool {
    match &ty.kind {
        TypeExprKind::Name(n) => n.text == "Marker",
        TypeExprKind::Array(inner, _) => is_marker(inner),
        _ => false,
    }
}

fn is_structural(ty: &ast::TypeExpr) -> bool {
    match &ty.kind {
        TypeExprKind::Name(n) => {
            matches!(n.text.as_str(), "Int" | "Bool" | "Text" | "Marker" | "Body")
        }
        TypeExprKind::Array(inner, _) => is_structural(inner),
        TypeExprKind::Function(..) => true,
        _ => false,
    }
}

/// Copies a graph with inputs at their places in the compact layout.
fn compact(graph: &Graph, layout: &InputLayout) -> (Graph, Vec<Node>) {
    let mut out = Graph::new();
    let mut map: Vec<Node> = Vec::with_capacity(graph.nodes().len());
    for op in graph.nodes() {
        let mapped = match *op {
            Op::Input(i) => Op::Input(compact_input(i, layout)),
            other => other.map_operands(|n| map[n.0 as usize]),
        };
        let node = out.push(mapped);
        map.push(node);
    }
    (out, map)
}
