//! Blocks of models and components: parameters, bodies, parts, elements, starts, outputs.

use super::element::{Class, ClassScope};
use super::pending::Pending;
use super::value::{ScopeId, Value};
use super::{CycleDraft, Elaborator, ElementSource, Entry, Eval, Lazy, body::index_text};
use crate::codes;
use crate::program::DefinitionId;
use crate::typed::lineage::{has_cycle, used_class};
use crate::typed::settable;
use eng_grammar::ast::{self, BindingKind, Form, ItemKind, Kind, Statement};
use eng_grammar::{Diagnostic, Span};
use eng_system::significant::short;
use eng_system::system::{BodyRef, Part};

/// The `require`s of a block.
fn requires(items: &[ast::Item]) -> impl Iterator<Item = &Statement> {
    items.iter().filter_map(|item| match &item.kind {
        ItemKind::Statement(statement @ Statement::Require { advise: false, .. }) => {
            Some(statement)
        }
        _ => None,
    })
}

impl<'a> Elaborator<'a, '_> {
    /// All items of a model's or component's block. The `require`s of a component come before its bodies, parts and
    /// elements. A component that does not fit one makes nothing: errors of its items would only follow from it.
    pub fn block(&mut self, items: &'a [ast::Item], scope: ScopeId) -> Eval<()> {
        let path = self.scope(scope).path.clone();
        let waiting = self.draft.pending.len();
        self.accepted_in(items, &path);
        self.register(items, scope);
        // outputs of a block are channels, not values inside it
        for item in items {
            if let ItemKind::Binding(b) = &item.kind {
                if b.kind == BindingKind::Input {
                    self.draft
                        .pending
                        .push(Pending::Input { binding: b, scope });
                }
                match b.kind {
                    BindingKind::Param | BindingKind::Input
                        if !self.scope(scope).entries.contains_key(&b.name.text) =>
                    {
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
                Kind::Marker => Some(Lazy::Marker(d, BodyRef::Ground)),
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
                && matches!(b.kind, BindingKind::Param | BindingKind::Input)
            {
                let _ = self.entry(scope, &b.name.text, b.name.span);
            }
            if let ItemKind::Attribute(a) = &item.kind {
                let _ = self.model_attribute(a, scope);
            }
        }
        if !self.context.in_part {
            self.items_of_block(items, scope);
            for statement in requires(items) {
                // the error was reported
                let _ = self.condition_of_block(statement, scope, &path, None);
            }
            return Ok(());
        }
        path.clone_into(&mut self.graphs.bind.owner);
        let fits = requires(items).try_for_each(|s| self.condition_of_block(s, scope, &path, None));
        if fits.is_ok() {
            self.items_of_block(items, scope);
            return fits;
        }
        self.draft.pending.truncate(waiting);
        let cycle = &mut self.draft.cycle;
        if cycle.take_if(|cycle| cycle.scope == scope).is_some() {
            self.draft.cycle_failed = true;
        }
        fits
    }

    /// Bodies, parts, elements, start values and lints of a block.
    fn items_of_block(&mut self, items: &'a [ast::Item], scope: ScopeId) {
        let path = self.scope(scope).path.clone();
        let declarations = items.iter().filter_map(|i| match &i.kind {
            ItemKind::Declaration(d) => Some(d),
            _ => None,
        });
        // bodies come before parts and parts before elements, because the later ones usually need the earlier
        // ones
        let rank = |kind| match kind {
            Kind::Body | Kind::Flexible | Kind::Marker => Some(0),
            Kind::Part => Some(1),
            Kind::Joint | Kind::Force | Kind::Journal | Kind::Drive => Some(2),
            _ => None,
        };
        // the part that states the cycle comes before all items that read it
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
                    let _ = self.start_of(true, (target, scope), (value, scope));
                }
                ItemKind::Statement(Statement::Guess { target, value }) => {
                    let _ = self.start_of(false, (target, scope), (value, scope));
                }
                // a lint may follow outputs of elements that come later
                ItemKind::Statement(statement @ Statement::Require { advise: true, .. }) => {
                    self.draft.pending.push(Pending::Advice {
                        statement,
                        scope,
                        path: path.clone(),
                    });
                }
                _ => {}
            }
        }
    }

    /// Evaluates a `require` or `advise` of a model or a component, or at the use of a component.
    pub(super) fn condition_of_block(
        &mut self,
        statement: &'a Statement,
        scope: ScopeId,
        path: &str,
        used_at: Option<eng_system::system::Location>,
    ) -> Eval<()> {
        if let Statement::Require {
            advise,
            index,
            name,
            condition,
            message,
        } = statement
        {
            let requirement = super::requirement::Requirement {
                advise: *advise,
                name: name.as_ref(),
                condition,
                message,
            };
            self.for_each(index, scope, &mut |e, inner, _| {
                e.requirement(requirement, inner, path, used_at).map(|_| ())
            })?;
        }
        Ok(())
    }

    fn cycle_of(&mut self, declaration: &'a ast::Declaration, scope: ScopeId) {
        if let Some(first) = &self.draft.cycle {
            let d = Diagnostic::error(codes::TWO_CYCLES, "a model has one cycle")
                .at(declaration.name.span, "a second one")
                .also(first.declaration.name.span, "the first")
                .with_help("let the model alone state the cycle");
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
            match self.graphs.bind.graph.as_constant(period) {
                Some(known) if known > 0.0 && known.is_finite() => {}
                Some(known) => {
                    self.report(
                        Diagnostic::error(codes::CYCLE_PERIOD, "the period of the cycle must be positive")
                            .at(span, format!("this is {} deg", short(known.to_degrees(), 4)))
                            .with_help("720 deg for a four-stroke engine, 360 deg for a two-stroke engine or a machine"),
                    );
                    self.draft.cycle_failed = true;
                    return;
                }
                None => {
                    let graph = &mut self.graphs.bind.graph;
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
            e.note_changes(declaration, &path, inner)?;
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
            e.note_part(&class, &path, place);
            let own = e.used_at(place, |e| {
                e.part_of_class(&source, &class, value, block, &path)
            })?;
            e.starts_inside(declaration, own, inner)?;
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

    /// Notes a part that the user's text makes of a component of the library.
    fn note_part(&mut self, class: &Class<'a>, path: &str, place: Span) {
        let program = &self.program;
        let of_library = program.is_library(class.declaration.name.span.source);
        if of_library && !program.is_library(place.source) {
            self.draft.parts.push(Part {
                path: path.to_owned(),
                made_at: super::location(place),
            });
        }
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
            let mut texts = texts.iter();
            let made = texts.try_for_each(|(items, scope)| e.block(items, *scope));
            e.context.in_part = outer;
            if made.is_err() {
                e.drop_changes(path);
            }
            made
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
}
