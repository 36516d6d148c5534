//! The values of names and fields.

use super::scalar::{Scalar, Stage};
use super::value::{Axes, BoundClass, Closure, ScopeId, TableValue, Value, present};
use super::{Elaborator, Entry, Eval, Lazy, Reported};
use crate::codes;
use crate::program::DefinitionId;
use eng_grammar::ast::{self, BindingKind, ItemKind};
use eng_grammar::{Diagnostic, Span};
use eng_system::layout::InputLayout;
use std::rc::Rc;

impl<'a> Elaborator<'a, '_> {
    /// The value of a name. Reports a name without a value.
    pub fn lookup(&mut self, name: &str, scope: ScopeId, span: Span) -> Eval<Value<'a>> {
        match self.try_lookup(name, scope, span)? {
            Some(value) => Ok(value),
            // the checker accepts the reactions of a joint everywhere in it, but only its outputs have them
            None if matches!(name, "force" | "torque") => Err(self.report(
                Diagnostic::error(
                    codes::OUTPUTS_ONLY,
                    format!("the reaction `{name}` can be used in outputs only"),
                )
                .at(span, "used where it is not known yet"),
            )),
            None => self.checked(None, span, &format!("`{name}` is not defined")),
        }
    }

    /// The value of a name, if it has one.
    pub fn try_lookup(
        &mut self,
        name: &str,
        scope: ScopeId,
        span: Span,
    ) -> Eval<Option<Value<'a>>> {
        let mut at = Some(scope);
        while let Some(id) = at {
            if self.scope(id).entries.contains_key(name) {
                return self.entry(id, name, span).map(Some);
            }
            at = self.scope(id).parent;
        }
        let module = self.scope(scope).module;
        if let Some(definition) = self.program.lookup(module, name) {
            return self.definition(definition, span).map(Some);
        }
        match name {
            "pi" => Ok(Some(Value::Scalar(
                self.graphs.constant(std::f64::consts::PI),
            ))),
            "ground" => Ok(Some(Value::Ground)),
            "cycle" if self.draft.cycle.is_some() => Ok(Some(Value::Cycle)),
            "cycle" if self.draft.cycle_failed => Err(Reported),
            "cycle" => Err(self.no_cycle(span)),
            "time" => {
                let Some(element) = self.graphs.element.as_mut() else {
                    return Err(self.report(
                        Diagnostic::error(
                            codes::MOTION,
                            "time is known in classes and outputs only",
                        )
                        .at(span, "only parameters are allowed here"),
                    ));
                };
                let node = element.graph.input(InputLayout::TIME);
                Ok(Some(Value::Scalar(Scalar {
                    stage: Stage::Motion,
                    node,
                })))
            }
            _ => Ok(None),
        }
    }

    /// Reports a text that reads the cycle of a model without one.
    fn no_cycle(&mut self, span: Span) -> Reported {
        let message = Diagnostic::error(codes::NO_CYCLE, "the model has no cycle");
        let message = match self.context.uses.first() {
            Some((item, _)) => message.at(*item, "this needs one").also(span, "read here"),
            None => message.at(span, "of which cycle?"),
        };
        self.report(message.with_help(
            "for instance `cycle angle = rotation(crank.main, ground) { period = 720 deg }`",
        ))
    }

    /// The value of an entry of a scope, evaluated at its first use.
    pub fn entry(&mut self, scope: ScopeId, name: &str, span: Span) -> Eval<Value<'a>> {
        let found = self.scope(scope).entries.get(name).cloned();
        match found {
            None => self.checked(None, span, &format!("`{name}` is not defined")),
            Some(Entry::Value(value)) => Ok(value),
            Some(Entry::Failed) => Err(Reported),
            Some(Entry::In(other)) => self.entry(other, name, span),
            Some(Entry::Busy) => Err(self.circle(scope, name, span)),
            Some(Entry::Lazy(lazy)) => {
                if let Lazy::Binding(binding) = &lazy
                    && self.scope(scope).lasting
                {
                    let at = super::location(binding.name.span);
                    self.draft
                        .named
                        .insert((scope.0 as usize, name.to_owned()), at);
                }
                self.define(scope, name, Entry::Busy);
                let guards = self.context.guards.clone();
                self.context
                    .guards
                    .retain(|(_, scopes)| *scopes <= scope.0 as usize);
                let uses = self.context.uses.clone();
                self.context
                    .uses
                    .retain(|(_, scopes)| *scopes <= scope.0 as usize);
                self.context.open.push((scope, name.to_owned(), span));
                let result = self.deeper(span, |e| e.force(&lazy, scope));
                self.context.open.pop();
                self.context.guards = guards;
                self.context.uses = uses;
                let entry = match &result {
                    Ok(value) if self.scope(scope).lasting && self.moves(value) => {
                        Entry::Lazy(lazy)
                    }
                    Ok(value) => Entry::Value(value.clone()),
                    Err(_) => Entry::Failed,
                };
                self.define(scope, name, entry);
                result
            }
        }
    }

    /// Reports a name whose value needs itself, with the places that lead back to it.
    fn circle(&mut self, scope: ScopeId, name: &str, span: Span) -> Reported {
        let mut message = Diagnostic::error(codes::ENDLESS, format!("`{name}` needs itself"))
            .at(span, "the circle closes here");
        let open = &self.context.open;
        let first = open
            .iter()
            .rposition(|(at, known, _)| *at == scope && known == name);
        for (_, between, place) in open
            .iter()
            .skip(first.map_or(open.len(), |first| first + 1))
        {
            message = message.also(*place, format!("this needs `{between}`"));
        }
        self.report(message)
    }

    /// Whether a value depends on the motion, and so belongs to one element.
    pub fn moves(&self, value: &Value<'a>) -> bool {
        let motion = |s: &Scalar| s.stage == Stage::Motion;
        match value {
            Value::Scalar(s) => motion(s),
            Value::Flag(f) => f.stage == Stage::Motion,
            Value::Vector(v) => v.iter().any(motion),
            Value::Shown(shown) => {
                matches!(shown.axes, Axes::Marker(_)) || shown.components.iter().any(motion)
            }
            Value::Components(c, _) => c.iter().any(motion),
            Value::List(items) => items.iter().any(|v| self.moves(v)),
            Value::Family(items) => items.iter().any(|(_, v)| self.moves(v)),
            Value::Partial(partial) => {
                let mut given = partial.given.iter();
                self.moves(&partial.function) || given.any(|given| self.moves(&given.value))
            }
            Value::Record(_, scope) => {
                let mut fields = self.scope(*scope).entries.values();
                fields.any(|entry| matches!(entry, Entry::Value(v) if self.moves(v)))
            }
            _ => false,
        }
    }

    fn force(&mut self, lazy: &Lazy<'a>, scope: ScopeId) -> Eval<Value<'a>> {
        match lazy {
            Lazy::Binding(binding) => {
                // conditions of functions that it calls name its own part, and not the item that reads it first
                let path = self.scope(scope).path.clone();
                if path.is_empty() {
                    return self.binding_value(binding, scope);
                }
                let owner = std::mem::replace(&mut self.graphs.bind.owner, path);
                let value = self.binding_value(binding, scope);
                self.graphs.bind.owner = owner;
                value
            }
            Lazy::Parameter(binding) => self.changeable(binding, scope),
            Lazy::Default(parameter) => {
                let default = parameter.default.as_ref();
                let default = self.checked(default, parameter.span, "no argument, no default")?;
                let value = self.evaluate(default, scope)?;
                self.declared(value, Some(&parameter.ty))
            }
            Lazy::DefaultOf(parameter) => self.default_of(parameter, scope),
            Lazy::BoundFunction(function) => {
                let value = function.value.as_ref();
                let value =
                    self.checked(value, function.name.span, "a function without a value")?;
                self.evaluate(value, scope)
            }
            Lazy::LengthOf(parameter) => self.length_of_default(parameter, scope),
            Lazy::Table(table) => {
                let module = self.scope(scope).module;
                self.table_value(table, scope, module)
            }
            Lazy::Part(declaration) => self.part(declaration, scope),
            Lazy::Body(declaration) => self.bodies_of(declaration, scope),
            Lazy::Marker(declaration, body) => self.markers_of(declaration, *body, scope),
            Lazy::Element(declaration) => {
                // another element may be under construction at this first use, so it is set aside
                let element = self.graphs.element.take();
                let rates = self.context.rates.take();
                let in_output = std::mem::replace(&mut self.context.in_output, false);
                let in_rate = std::mem::replace(&mut self.context.in_rate, false);
                let made = self.elements_of(declaration, scope);
                self.graphs.element = element;
                self.context.rates = rates;
                self.context.in_output = in_output;
                self.context.in_rate = in_rate;
                made
            }
        }
    }

    fn binding_value(&mut self, binding: &'a ast::Binding, scope: ScopeId) -> Eval<Value<'a>> {
        let expr = binding.value.as_ref();
        let expr = self.checked(expr, binding.name.span, "a definition without a value")?;
        if binding.index.is_empty() {
            return self.bound_value(binding, expr, scope);
        }
        let mut values = Vec::new();
        self.for_each(&binding.index, scope, &mut |e, inner, position| {
            values.push((position.to_vec(), e.bound_value(binding, expr, inner)?));
            Ok(())
        })?;
        Ok(Value::Family(values))
    }

    /// A value of a definition, read as its declaration. An output has its stated axes.
    pub fn bound_value(
        &mut self,
        binding: &'a ast::Binding,
        expr: &'a ast::Expr,
        scope: ScopeId,
    ) -> Eval<Value<'a>> {
        if binding.kind == BindingKind::Field {
            return self.field_of_kernel(binding, expr, scope);
        }
        let value = self.evaluate(expr, scope)?;
        let value = self.declared(value, binding.ty.as_ref())?;
        self.binding_as_stated(binding, expr, &value, scope)?;
        match &binding.frame {
            Some(frame) => {
                let axes = self.axes(frame, scope)?;
                self.shown(value, axes, expr.span)
            }
            None => Ok(value),
        }
    }

    pub(super) fn binding_as_stated(
        &mut self,
        binding: &'a ast::Binding,
        expr: &ast::Expr,
        value: &Value<'a>,
        scope: ScopeId,
    ) -> Eval<()> {
        match &binding.ty {
            Some(ty) => {
                let what = format!("`{}`", binding.name.text);
                self.of_stated_length(value, ty, scope, &what, expr.span)
            }
            None => Ok(()),
        }
    }

    /// The value of a definition at the top level of a module.
    pub(super) fn definition(&mut self, id: DefinitionId, span: Span) -> Eval<Value<'a>> {
        let Some(item) = self.program.item(id) else {
            return Err(Reported);
        };
        let scope = self.module_scopes[id.module as usize];
        let lazy = match &item.kind {
            ItemKind::Binding(b) if matches!(b.kind, BindingKind::Param) => Lazy::Parameter(b),
            ItemKind::Binding(b) => Lazy::Binding(b),
            ItemKind::Table(t) => Lazy::Table(t),
            ItemKind::Function(function) if function.bound => Lazy::BoundFunction(function),
            ItemKind::Function(function) => {
                return Ok(Value::Closure(Closure {
                    function,
                    scope,
                    solution: None,
                }));
            }
            ItemKind::Declaration(_) => {
                return match self.bound_definition(id) {
                    Some(bound) => bound,
                    None => Ok(Value::Definition(id)),
                };
            }
            _ => return self.checked(None, span, "this is no value"),
        };
        let name = match &item.kind {
            ItemKind::Binding(b) => b.name.text.clone(),
            ItemKind::Table(t) => t.name.text.clone(),
            ItemKind::Function(function) => function.name.text.clone(),
            _ => return Err(Reported),
        };
        if !self.scope(scope).entries.contains_key(&name) {
            self.define(scope, &name, Entry::Lazy(lazy));
        }
        self.entry(scope, &name, span)
    }

    /// The value of a definition `journal OurMain = Impedance(viscosity: …)`; `None` for any other one.
    pub fn bound_definition(&mut self, id: DefinitionId) -> Option<Eval<Value<'a>>> {
        let declaration = self.program.declaration(id)?;
        let ast::Form::Instance { value, .. } = &declaration.form else {
            return None;
        };
        let scope = *self.module_scopes.get(id.module as usize)?;
        let given = self.deeper(value.span, |e| e.class_called(value, scope));
        Some(given.map(|(class, given)| {
            Value::Bound(Rc::new(BoundClass {
                class: class.definition,
                given,
                named: Some(id),
            }))
        }))
    }

    /// `base.name`.
    pub fn field(&mut self, base: Value<'a>, name: &ast::Name, span: Span) -> Eval<Value<'a>> {
        match base {
            Value::Marker(m) => self.marker_field(m, name),
            Value::Ground => {
                if let Some(i) = ["x", "y", "z"].iter().position(|n| *n == name.text) {
                    return Ok(Value::Vector(self.unit_vector(i)));
                }
                if name.text == "origin" {
                    let zero = self.graphs.constant(0.0);
                    return Ok(Value::Vector([zero; 3]));
                }
                let marker = self.ground_frame();
                self.marker_field(marker, name)
            }
            Value::Body(b) => {
                let scope = self.draft.body_scopes[b as usize];
                self.entry(scope, &name.text, name.span)
            }
            Value::Part(scope) | Value::Record(_, scope) => {
                self.entry(scope, &name.text, name.span)
            }
            Value::Element(e) => self.element_field(e, name),
            Value::Shown(shown) => {
                match ["x", "y", "z"]
                    .iter()
                    .zip(shown.components)
                    .find(|(n, _)| **n == name.text)
                {
                    Some((_, component)) => Ok(Value::Scalar(component)),
                    None => self.checked(None, name.span, "no component of a vector"),
                }
            }
            Value::Components(..) => self.field(Self::without_axes(base), name, span),
            Value::List(items) => {
                if let Some(i) = ["x", "y", "z"].iter().position(|n| *n == name.text)
                    && items.len() <= 3
                    && items
                        .iter()
                        .all(|v| matches!(v, Value::Scalar(_) | Value::Int(_)))
                {
                    return match items.into_iter().nth(i) {
                        Some(v) => Ok(v),
                        None => Err(self.report(
                            Diagnostic::error(
                                codes::INDEX_OUTSIDE,
                                format!("there is no component {}", name.text),
                            )
                            .at(name.span, "the list is too short"),
                        )),
                    };
                }
                // a field of every element: piston[*].pin
                let items = items
                    .into_iter()
                    .map(|v| (Vec::new(), v))
                    .collect::<Vec<_>>();
                self.field(Value::Family(items), name, span)
            }
            Value::Family(items) => present(items)
                .map(|(_, v)| self.field(v, name, span))
                .collect::<Eval<Vec<_>>>()
                .map(Value::List),
            Value::Cycle => match (name.text.as_str(), self.draft.cycle.clone()) {
                ("angle", Some(cycle)) => self.cycle_angle(&cycle),
                ("period", Some(cycle)) => Ok(Value::Scalar(Scalar {
                    stage: Stage::Bind,
                    node: cycle.period,
                })),
                _ => self.checked(None, name.span, "no field of the cycle"),
            },
            other => {
                let found = other.kind();
                self.checked(None, span, &format!("{found} has no `{}`", name.text))
            }
        }
    }

    pub fn unit_vector(&mut self, axis: usize) -> [Scalar; 3] {
        [0, 1, 2].map(|i| self.graphs.constant(if i == axis { 1.0 } else { 0.0 }))
    }

    /// The local index of a marker in the present element.
    pub fn local_marker(&mut self, marker: u32, span: Option<Span>) -> Eval<u32> {
        self.used_marker(marker);
        let local = match self.graphs.element.as_mut() {
            Some(element) => element.marker(marker),
            None => {
                let mut message = Diagnostic::error(
                    codes::MOTION,
                    "only parameters are allowed here, and this reads a marker, which moves",
                );
                message = message.at_if(span, "the marker is read here");
                return Err(self.report(message.with_help(
                        "measure it in a class, which reads its markers, or in an output; a condition on the motion belongs in a class or in the block of a use",
                    )));
            }
        };
        match local {
            Some(local) => Ok(local),
            None => {
                let mut message = Diagnostic::error(
                    codes::ELEMENT_TOO_LARGE,
                    format!(
                        "one element touches more than {} markers",
                        super::scalar::PROVISIONAL.markers
                    ),
                );
                message = message.at_if(span, "the limit is reached here");
                Err(self.report(message.with_help("divide it into several elements or outputs")))
            }
        }
    }

    pub fn marker_input(&mut self, local: u32, component: u32) -> Scalar {
        let node = match self.graphs.element.as_mut() {
            Some(element) => element.marker_input(local, component),
            None => self.graphs.bind.graph.constant(f64::NAN),
        };
        Scalar {
            stage: Stage::Motion,
            node,
        }
    }

    /// Column of a marker's rotation matrix, in ground axes.
    pub fn marker_axis(&mut self, local: u32, axis: u32) -> [Scalar; 3] {
        [0, 1, 2].map(|i| self.marker_input(local, 3 + 3 * i + axis))
    }

    pub fn marker_origin(&mut self, local: u32) -> [Scalar; 3] {
        [0, 1, 2].map(|i| self.marker_input(local, i))
    }

    /// Ground-axes components of a vector given along a marker's axes.
    pub fn rotate(&mut self, local: u32, v: &[Scalar; 3]) -> [Scalar; 3] {
        [0, 1, 2].map(|i| {
            let row = [0, 1, 2].map(|j| self.marker_input(local, 3 + 3 * i + j));
            self.graphs.dot(&row, v)
        })
    }

    /// Components of a vector along a marker's axes.
    pub fn along_axes(&mut self, local: u32, v: &[Scalar; 3]) -> [Scalar; 3] {
        [0, 1, 2].map(|j| {
            let axis = self.marker_axis(local, j);
            self.graphs.dot(&axis, v)
        })
    }

    fn marker_field(&mut self, marker: u32, name: &ast::Name) -> Eval<Value<'a>> {
        let local = self.local_marker(marker, Some(name.span))?;
        let vector = match name.text.as_str() {
            "origin" => self.marker_origin(local),
            "x" => self.marker_axis(local, 0),
            "y" => self.marker_axis(local, 1),
            "z" => self.marker_axis(local, 2),
            "velocity" => [0, 1, 2].map(|i| self.marker_input(local, 12 + i)),
            "angular_velocity" => {
                let w = [0, 1, 2].map(|i| self.marker_input(local, 15 + i));
                self.rotate(local, &w)
            }
            "acceleration" | "angular_acceleration" => {
                let base = ast::Name {
                    text: if name.text == "acceleration" {
                        "velocity".into()
                    } else {
                        "angular_velocity".into()
                    },
                    span: name.span,
                };
                let value = self.marker_field(marker, &base)?;
                return self.rate_of(value, name.span);
            }
            _ => {
                return self.checked(None, name.span, "no field of a marker");
            }
        };
        Ok(Value::Vector(vector))
    }

    fn cycle_angle(&mut self, cycle: &super::CycleDraft<'a>) -> Eval<Value<'a>> {
        match &cycle.declaration.form {
            ast::Form::Instance { value, .. } => {
                self.deeper(value.span, |e| e.evaluate(value, cycle.scope))
            }
            _ => Err(Reported),
        }
    }

    /// A table's handle as a value.
    pub fn table_handle(&mut self, index: usize) -> Value<'a> {
        let handle = self.graphs.bind.fixed(index as f64);
        Value::Table(TableValue { handle })
    }
}
