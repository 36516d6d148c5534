//! Blocks of models and components: parameters, bodies, parts, elements, starts, outputs.

use super::element::{Class, ClassScope};
use super::output::Columns;
use super::scalar::{ElementBuilder, Scalar, Stage};
use super::value::{ScopeId, Value};
use super::{CycleDraft, Elaborator, ElementSource, Entry, Eval, Lazy, body::index_text};
use crate::codes;
use crate::ir::{Node, Op};
use crate::program::DefinitionId;
use crate::typed::lineage::{has_cycle, used_class};
use crate::typed::settable;
use eng_grammar::ast::{self, BindingKind, Form, ItemKind, Kind, Statement};
use eng_grammar::{Diagnostic, Span};
use eng_system::Dimension;
use eng_system::elementary::Elementary;
use eng_system::system::Role;

/// The target of a start value.
#[derive(Clone, Debug)]
pub(crate) enum StartTarget {
    /// A body's origin.
    Position(u32),
    /// A body's orientation, with the stated matrix.
    Rotation(u32, [Node; 9]),
    Velocity(u32),
    AngularVelocity(u32),
}

/// An item that waits until all elements are known.
#[derive(Clone, Debug)]
pub(crate) enum Pending<'a> {
    Start {
        role: Role,
        target: StartTarget,
        value: &'a ast::Expr,
        scope: ScopeId,
    },
    /// `start`/`guess` of an expression. Lowering it shows whether it is a position or a velocity.
    StartExpression {
        exact: bool,
        target: &'a ast::Expr,
        value: &'a ast::Expr,
        scope: ScopeId,
    },
    Output {
        binding: &'a ast::Binding,
        scope: ScopeId,
    },
}

impl<'a> Elaborator<'a, '_> {
    pub fn pending_start(
        &mut self,
        role: Role,
        target: StartTarget,
        value: &'a ast::Expr,
        scope: ScopeId,
    ) {
        self.draft.pending.push(Pending::Start {
            role,
            target,
            value,
            scope,
        });
    }

    /// All items of a model's or component's block.
    pub fn block(&mut self, items: &'a [ast::Item], scope: ScopeId) {
        let path = self.scope(scope).path.clone();
        self.accepted_in(items, &path);
        self.register(items, scope);
        // outputs of a block are channels, not values inside it
        for item in items {
            if let ItemKind::Binding(b) = &item.kind {
                match b.kind {
                    BindingKind::Param if !self.scope(scope).entries.contains_key(&b.name.text) => {
                        self.define(scope, &b.name.text, Entry::Lazy(Lazy::Parameter(b)));
                    }
                    BindingKind::Output => self
                        .draft
                        .pending
                        .push(Pending::Output { binding: b, scope }),
                    _ => {}
                }
            }
        }
        let declarations = items.iter().filter_map(|i| match &i.kind {
            ItemKind::Declaration(d) => Some(d),
            _ => None,
        });
        for d in declarations.clone() {
            let lazy = match d.kind {
                Kind::Part => Some(Lazy::Part(d)),
                Kind::Body | Kind::Flexible => Some(Lazy::Body(d)),
                Kind::Marker => Some(Lazy::Marker(d)),
                Kind::Joint | Kind::Force | Kind::Journal | Kind::Drive => Some(Lazy::Element(d)),
                _ => None,
            };
            if let Some(lazy) = lazy {
                self.define(scope, &d.name.text, Entry::Lazy(lazy));
            }
        }
        for d in declarations.clone() {
            if d.kind == Kind::Cycle {
                self.cycle_of(d, scope);
            }
        }
        // after an error the other items are still elaborated, so that one run reports more errors
        for item in items {
            if let ItemKind::Binding(b) = &item.kind
                && b.kind == BindingKind::Param
            {
                let _ = self.entry(scope, &b.name.text, b.name.span);
            }
            if let ItemKind::Attribute(a) = &item.kind {
                let _ = self.model_attribute(a, scope);
            }
        }
        // bodies come before parts and parts before elements, because the later ones usually need the earlier
        // ones
        let rank = |kind| match kind {
            Kind::Body | Kind::Flexible | Kind::Marker => Some(0),
            Kind::Part => Some(1),
            Kind::Joint | Kind::Force | Kind::Journal | Kind::Drive => Some(2),
            _ => None,
        };
        // the part that states the cycle comes before whatever reads it
        let module = self.scope(scope).module;
        let parts = declarations.clone().filter(|d| d.kind == Kind::Part);
        for part in parts.filter(|part| {
            used_class(self.program, module, part).is_some_and(|id| has_cycle(self.program, id))
        }) {
            let _ = self.entry(scope, &part.name.text, part.name.span);
        }
        for turn in 0..3 {
            for d in declarations.clone() {
                if rank(d.kind) == Some(turn) {
                    let _ = self.entry(scope, &d.name.text, d.name.span);
                }
            }
        }
        for item in items {
            match &item.kind {
                ItemKind::Statement(Statement::Start { target, value }) => {
                    self.draft.pending.push(Pending::StartExpression {
                        exact: true,
                        target,
                        value,
                        scope,
                    });
                }
                ItemKind::Statement(Statement::Guess { target, value }) => {
                    self.draft.pending.push(Pending::StartExpression {
                        exact: false,
                        target,
                        value,
                        scope,
                    });
                }
                ItemKind::Statement(statement) => {
                    // the error was reported
                    let _ = self.condition_of_block(statement, scope, &path, None);
                }
                _ => {}
            }
        }
    }

    /// Evaluates a `require` or `advise` of a model or a component, or at the use of a component.
    fn condition_of_block(
        &mut self,
        statement: &'a Statement,
        scope: ScopeId,
        path: &str,
        used_at: Option<eng_system::system::Location>,
    ) -> Eval<()> {
        if let Statement::Require {
            advise,
            name,
            condition,
            message,
        } = statement
        {
            let asked = super::binding::Asked {
                advise: *advise,
                name: name.as_ref(),
                condition,
                message,
            };
            self.requirement(asked, scope, path, used_at)?;
        }
        Ok(())
    }

    fn cycle_of(&mut self, declaration: &'a ast::Declaration, scope: ScopeId) {
        if let Some(first) = &self.draft.cycle {
            let d = Diagnostic::error(codes::TWO_CYCLES, "a model has one cycle")
                .at(declaration.name.span, "a second one")
                .also(first.declaration.name.span, "the first")
                .with_help("a component that others use leaves the cycle to the model");
            self.diagnostics.push(d);
            return;
        }
        let mut period = None;
        if let Form::Instance {
            block: Some(block), ..
        } = &declaration.form
        {
            for item in &block.items {
                if let ItemKind::Attribute(a) = &item.kind
                    && a.name.text == "period"
                {
                    period = Some(a);
                }
            }
        }
        let Some(attribute) = period else {
            let _ = self.checked(period, declaration.name.span, "it has no period");
            self.draft.cycle_failed = true;
            return;
        };
        let node = self
            .evaluate(&attribute.value, scope)
            .and_then(|v| self.as_scalar(v, attribute.value.span))
            .and_then(|s| self.bind_node(s, attribute.value.span));
        if let Ok(period) = node {
            let span = attribute.value.span;
            match self.bench.bind.graph.as_constant(period) {
                Some(known) if known > 0.0 && known.is_finite() => {}
                Some(_) => {
                    self.report(
                        Diagnostic::error(codes::CYCLE_PERIOD, "the period of the cycle must be positive")
                            .at(span, "this is not")
                            .with_help("720 deg for a four-stroke engine, 360 deg for a two-stroke engine or a machine"),
                    );
                    self.draft.cycle_failed = true;
                    return;
                }
                None => {
                    let graph = &mut self.bench.bind.graph;
                    let zero = graph.constant(0.0);
                    let positive = graph.less(zero, period);
                    let text = "the period must be positive".to_owned();
                    let message = vec![super::MessagePart::Text(text)];
                    self.bind_check(positive, message, "cycle", span);
                }
            }
            self.draft.cycle = Some(CycleDraft {
                declaration,
                scope,
                period,
            });
        } else {
            self.draft.cycle_failed = true;
        }
    }

    fn model_attribute(&mut self, attribute: &'a ast::Attribute, scope: ScopeId) -> Eval<()> {
        match attribute.name.text.as_str() {
            "gravity" => {
                self.draft
                    .stated
                    .insert("gravity".to_owned(), super::location(attribute.value.span));
                self.draft.gravity = Some(self.bind_vector(&attribute.value, scope)?);
                Ok(())
            }
            _ => self.checked(None, attribute.name.span, "no attribute of a model"),
        }
    }

    /// `part name[index] = Component(arguments)`.
    pub fn part(&mut self, declaration: &'a ast::Declaration, scope: ScopeId) -> Eval<Value<'a>> {
        let (value, block) = self.instance(declaration)?;
        let base = self.path(scope, &declaration.name.text);
        self.instances_of(declaration, scope, &mut |e, inner, position| {
            e.count_instance(declaration.name.span)?;
            let path = format!("{base}{}", index_text(position));
            let (class, given) = e.class_used(declaration, value, inner)?;
            let bound = e.bind_arguments(&class, &given, &path)?;
            let source = ElementSource {
                definition: class.definition,
                arguments: bound,
            };
            if source
                .arguments
                .iter()
                .any(|(_, a)| matches!(a, super::Argument::Again(..)))
            {
                return Err(e.report(
                    Diagnostic::error(
                        codes::MOTION,
                        "arguments of a component depend on parameters alone",
                    )
                    .at(
                        value.span,
                        "one of these depends on positions, velocities or time",
                    )
                    .with_help("give the component the markers, and measure inside it"),
                ));
            }
            let place = declaration.name.span;
            let own = e.used_at(place, |e| {
                e.part_of_class(&source, &class, value, block, &path)
            })?;
            if let Some(block) = block {
                let at_use = e.use_scope(own, inner);
                let place = Some(super::location(declaration.name.span));
                for item in &block.items {
                    if let ItemKind::Statement(statement) = &item.kind {
                        e.condition_of_block(statement, at_use, &path, place)?;
                    }
                }
            }
            Ok(Value::Part(own))
        })
    }

    /// An instance of a component with its arguments.
    fn part_of_class(
        &mut self,
        source: &ElementSource<'a>,
        class: &Class<'a>,
        value: &'a ast::Expr,
        block: Option<&'a ast::Block>,
        path: &str,
    ) -> Eval<ScopeId> {
        let ClassScope { own, texts } = self.class_scope(source, class, path)?;
        for (_, scope) in &texts {
            self.lasting(*scope);
        }
        if let Some(block) = block {
            self.accepted_in(&block.items, path);
        }
        self.deeper(value.span, |e| {
            let outer = std::mem::replace(&mut e.context.in_part, true);
            for (items, scope) in &texts {
                e.block(items, *scope);
            }
            e.context.in_part = outer;
            Ok(())
        })?;
        Ok(own)
    }

    /// Makes the value of a record from its call.
    pub fn construct(
        &mut self,
        id: DefinitionId,
        span: Span,
        arguments: &'a [ast::Argument],
        scope: ScopeId,
    ) -> Eval<Value<'a>> {
        let is_record = |d: &&ast::Declaration| d.kind == Kind::Record;
        let record = self.program.declaration(id).filter(is_record);
        let declaration = self.checked(record, span, "a class is no value")?;
        let own = self.record_scope(id);
        let fields: Vec<&'a ast::Binding> = settable(declaration).collect();
        let places = self.call_at(span)?;
        for (argument, place) in arguments.iter().zip(places.iter()) {
            let field = fields.get(*place as usize).copied();
            let field = self.checked(field, argument.value.span, "no such field")?;
            let value = self.evaluate(&argument.value, scope)?;
            let value = self.declared(value, field.ty.as_ref())?;
            self.define(own, &field.name.text, Entry::Value(value));
        }
        // the length of one field may be another field
        for (argument, place) in arguments.iter().zip(places.iter()) {
            let Some(field) = fields.get(*place as usize) else {
                continue;
            };
            if let Some(ty) = &field.ty {
                let (name, place) = (&field.name.text, argument.value.span);
                let value = self.entry(own, name, place)?;
                let what = format!("`{name}` of `{}`", declaration.name.text);
                self.of_stated_length(&value, ty, own, &what, place)?;
            }
        }
        Ok(Value::Record(id, own))
    }

    /// Lowers starts and outputs.
    pub fn finish_pending(&mut self) {
        for pending in std::mem::take(&mut self.draft.pending) {
            self.bench.element = Some(ElementBuilder::default());
            let result = match pending {
                Pending::Start {
                    role,
                    target,
                    value,
                    scope,
                } => self.lower_start(role, &target, value, scope),
                Pending::StartExpression {
                    exact,
                    target,
                    value,
                    scope,
                } => {
                    self.context.in_start = true;
                    let lowered = self.lower_start_expression(exact, target, value, scope);
                    self.context.in_start = false;
                    lowered
                }
                Pending::Output { binding, scope } => self.lower_output(binding, scope),
            };
            // the error was reported
            let _ = result;
            self.bench.element = None;
            self.context.in_output = false;
        }
    }

    fn lower_start(
        &mut self,
        role: Role,
        target: &StartTarget,
        value: &'a ast::Expr,
        scope: ScopeId,
    ) -> Eval<()> {
        let (marker, name) = match target {
            StartTarget::Position(m) => (*m, "position"),
            StartTarget::Rotation(m, _) => (*m, "rotation"),
            StartTarget::Velocity(m) => (*m, "velocity"),
            StartTarget::AngularVelocity(m) => (*m, "angular_velocity"),
        };
        let path = self.draft.markers[marker as usize]
            .origin
            .path
            .replace(".origin", "");
        let path = format!("start of {path}.{name}");
        let local = self.local_marker(marker, Some(value.span))?;
        let (actual, dimension) = match target {
            StartTarget::Position(_) => (self.marker_origin(local), Dimension::LENGTH),
            StartTarget::Velocity(_) => (
                [0, 1, 2].map(|i| self.marker_input(local, 12 + i)),
                Dimension::LENGTH.over(Dimension::TIME),
            ),
            StartTarget::AngularVelocity(_) => {
                let w = [0, 1, 2].map(|i| self.marker_input(local, 15 + i));
                let per_time = Dimension::ANGLE.over(Dimension::TIME);
                (self.rotate(local, &w), per_time)
            }
            StartTarget::Rotation(_, matrix) => {
                // x·Y, y·Z, z·X of the actual axes x, y, z and the stated axes X, Y, Z all vanish at
                // alignment
                let column = |j: usize| {
                    [0, 1, 2].map(|i| Scalar {
                        stage: Stage::Bind,
                        node: matrix[3 * i + j],
                    })
                };
                let rows = [(0, 1), (1, 2), (2, 0)].map(|(a, b)| {
                    let axis = self.marker_axis(local, a);
                    self.bench.dot(&axis, &column(b as usize))
                });
                let rows = rows
                    .into_iter()
                    .map(|s| (s, "rotation".to_owned()))
                    .collect();
                return self.start_element(role, path, value.span, Dimension::ONE, rows);
            }
        };
        let v = self.evaluate(value, scope)?;
        let stated = self.as_vector(v, value.span)?;
        let text = self.sources.text(value.span).to_owned();
        let rows = [0, 1, 2]
            .map(|i| {
                (
                    self.bench.subtract(actual[i], stated[i]),
                    format!("{name}.{} == {text}", ["x", "y", "z"][i]),
                )
            })
            .to_vec();
        self.start_element(role, path, value.span, dimension, rows)
    }

    fn lower_start_expression(
        &mut self,
        exact: bool,
        target: &'a ast::Expr,
        value: &'a ast::Expr,
        scope: ScopeId,
    ) -> Eval<()> {
        let actual = self.evaluate(target, scope)?;
        let stated = self.evaluate(value, scope)?;
        let a = self.as_components(
            match actual {
                Value::Scalar(s) => Value::List(vec![Value::Scalar(s)]),
                other => other,
            },
            target.span,
        )?;
        if a.iter().all(|part| part.stage == Stage::Bind) {
            return Err(self.report(
                Diagnostic::error(codes::START, "only what moves can be set at the start")
                    .at(target.span, "this follows from parameters alone")
                    .with_help(
                        "a parameter has its value in the text; `--set` changes it for a run",
                    ),
            ));
        }
        let b = self.as_components(
            match stated {
                Value::Scalar(_) | Value::Int(_) => Value::List(vec![stated]),
                other => other,
            },
            value.span,
        )?;
        if a.len() != b.len() {
            return Err(self.lengths(a.len(), target.span, b.len(), value.span));
        }
        let rotation = |e: &Self, s: &Scalar| {
            let element = e.bench.element.as_ref()?;
            element.rotations.iter().position(|r| r.2 == s.node)
        };
        let text = format!(
            "{} == {}",
            self.sources.text(target.span),
            self.sources.text(value.span)
        );
        let mut rows = Vec::new();
        let mut velocity = false;
        for (x, y) in a.into_iter().zip(b) {
            let mut difference = self.bench.subtract(x, y);
            if let Some(index) = rotation(self, &x) {
                if y.stage != Stage::Motion {
                    let stated = self.bind_node(y, value.span)?;
                    if let Some(element) = self.bench.element.as_mut() {
                        element.stated.push((index as u32, stated));
                    }
                }
                // the sine closes the angle at any turn; the stated turns are counted afterwards
                let sine = self
                    .bench
                    .unary(difference, |g, n| g.unary(Elementary::Sin, n));
                let cosine = self
                    .bench
                    .unary(difference, |g, n| g.unary(Elementary::Cos, n));
                difference = self.bench.binary(sine, cosine, crate::ir::Graph::atan2);
            }
            velocity |= difference.stage == Stage::Motion && self.uses_twist(difference.node);
            rows.push((difference, text.clone()));
        }
        let role = if velocity {
            Role::StartVelocity { exact }
        } else {
            Role::StartPosition { exact }
        };
        let path = format!("start of {}", self.sources.text(target.span));
        let dimension = self.dimension_at(target.span, scope)?;
        self.start_element(role, path, target.span, dimension, rows)
    }

    /// Whether a value of the present element depends on a marker's twist.
    fn uses_twist(&self, node: Node) -> bool {
        let Some(element) = self.bench.element.as_ref() else {
            return false;
        };
        let mut stack = vec![node];
        let mut seen = vec![false; element.graph.nodes().len()];
        while let Some(n) = stack.pop() {
            if std::mem::replace(&mut seen[n.0 as usize], true) {
                continue;
            }
            match element.graph.op(n) {
                Op::Input(i) => {
                    let end = super::scalar::PROVISIONAL.state(0);
                    if (1..end).contains(&i) && (i - 1) % eng_system::layout::MARKER_WIDTH >= 12 {
                        return true;
                    }
                }
                op => stack.extend(op.operands()),
            }
        }
        false
    }

    fn lower_output(&mut self, binding: &'a ast::Binding, scope: ScopeId) -> Eval<()> {
        let name = &binding.name.text;
        let base = self.path(scope, name);
        let Some(expr) = &binding.value else {
            return Ok(());
        };
        let display = self.display_of(binding)?;
        let mut found = Vec::new();
        self.for_each(&binding.index, scope, &mut |e, inner, position| {
            e.bench.element = Some(ElementBuilder::default());
            e.context.in_output = true;
            let path = format!("{base}{}", index_text(position));
            e.bench.bind.owner.clone_from(&path);
            let place = binding.ty.as_ref().map_or(expr.span, |ty| ty.span);
            let shown = Columns {
                dimension: e.dimension_at(place, inner)?,
                display: display.clone(),
                declared: binding.ty.is_some(),
                frame: None,
            };
            let value = e.bound_value(binding, expr, inner)?;
            found.push((position.to_vec(), value.clone()));
            e.output_element(path, vec![(name.clone(), value, shown)], binding.name.span)?;
            e.bench.element = None;
            e.context.in_output = false;
            Ok(())
        })?;
        self.as_promised(binding, scope, &found)
    }

    /// The cycle's element: angle and its rate.
    pub fn lower_cycle(&mut self) -> Eval<Option<eng_system::system::Cycle>> {
        let Some(cycle) = self.draft.cycle.clone() else {
            return Ok(None);
        };
        let Form::Instance { value, .. } = &cycle.declaration.form else {
            return Ok(None);
        };
        self.bench.element = Some(ElementBuilder::default());
        self.context.in_output = true;
        let angle = self.evaluate(value, cycle.scope)?;
        let rate = self.rate_of(angle.clone(), value.span)?;
        let before = self.draft.channels.len();
        let values = vec![
            ("angle".to_owned(), angle, Columns::of(Dimension::ANGLE)),
            (
                "speed".to_owned(),
                rate,
                Columns::of(Dimension::ANGLE.over(Dimension::TIME)),
            ),
        ];
        let span = cycle.declaration.name.span;
        let element = self.output_element("cycle".into(), values, span)?;
        // time, angle and speed are columns of their own
        self.draft.channels.truncate(before);
        self.context.in_output = false;
        self.bench.element = None;
        self.bench.bind.owner = "cycle".into();
        let period = self.slot(cycle.period);
        Ok(Some(eng_system::system::Cycle {
            origin: eng_system::system::Origin {
                path: "cycle".into(),
                used_at: Some(super::location(cycle.declaration.name.span)),
                defined_at: None,
            },
            element,
            period,
        }))
    }
}
