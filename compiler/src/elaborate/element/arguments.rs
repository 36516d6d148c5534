//! Arguments of a class, and their scope.

use super::super::binding::Stated;
use super::super::lengths::{Texts, home};
use super::super::scalar::{Scalar, Stage};
use super::super::value::{Closure, Given, ScopeId, Value};
use super::super::{Argument, Elaborator, ElementSource, Entry, Eval, Lazy};
use super::{Class, ClassScope};
use crate::codes;
use crate::program::DefinitionId;
use crate::typed::lineage::{self, ClassParameter};
use crate::typed::types::Type;
use eng_grammar::ast::{BindingKind, ItemKind};
use eng_grammar::{Diagnostic, Span, ast};
use std::rc::Rc;

impl<'a> Elaborator<'a, '_> {
    /// Evaluates the arguments of a class. Numbers become parameters of the instance.
    pub fn bind_arguments(
        &mut self,
        class: &Class<'a>,
        given: &[Given<'a>],
        path: &str,
    ) -> Eval<Vec<(String, Argument<'a>)>> {
        let mut bound: Vec<(String, Argument<'a>)> = Vec::new();
        let mut grounds: Vec<(usize, Span)> = Vec::new();
        let mut partner = None;
        let mut arguments = Vec::new();
        for call in given {
            let places = self.call_at(call.call)?;
            // a use through an interface has the parameters of the interface, which the class has by name
            let of_interface: Option<Rc<[ClassParameter<'a>]>> = call
                .interface
                .map(|interface| lineage::parameters(self.program, interface).into());
            let parameters = of_interface.unwrap_or_else(|| class.parameters.clone());
            for (argument, place) in call.arguments.iter().zip(places.iter()) {
                let name = parameters.get(*place as usize).map(|p| &p.name.text);
                arguments.push((argument, name.cloned(), call.scope));
            }
        }
        for (argument, name, scope) in arguments {
            let mut parameters = class.parameters.iter();
            let parameter = parameters.find(|p| Some(&p.name.text) == name.as_ref());
            let parameter = self.checked(parameter, argument.value.span, "no such parameter")?;
            let name = parameter.name.text.clone();
            self.draft
                .passed
                .insert(format!("{path}.{name}"), argument.value.span);
            let ty = self.type_at(parameter.ty.span)?;
            let value = self.evaluate(&argument.value, scope)?;
            let value = match value {
                Value::Ground if is_marker(&ty) => {
                    grounds.push((bound.len(), argument.value.span));
                    Value::Ground
                }
                Value::Marker(m) => {
                    self.used_marker(m);
                    partner = partner.or(Some(m));
                    Value::Marker(m)
                }
                value @ (Value::Table(_) | Value::Partial(_)) => {
                    self.function_argument(value, &format!("{path}.{name}"))?
                }
                value if is_structural(&ty) => value,
                value => {
                    let stated = Stated {
                        expr: &argument.value,
                        dimension: self.dimension_at(parameter.ty.span, scope)?,
                        limits: parameter.limits,
                        span: argument.value.span,
                        scope,
                    };
                    self.parameterise(value, &format!("{path}.{name}"), stated)?
                }
            };
            let value = self.read_as(value, &ty);
            let moves = self.moves(&value);
            bound.push((
                name,
                if moves {
                    Argument::Again(&argument.value, scope)
                } else {
                    Argument::Value(value)
                },
            ));
        }
        for (index, ground_span) in grounds {
            let Some(partner) = partner else {
                return Err(self.report(
                    Diagnostic::error(codes::GROUND_ALONE, "`ground` needs another marker beside it")
                        .at(ground_span, "`ground` takes the place of the element's other marker, and the element has no other one")
                        .with_help("name a marker of the model, which is on the ground: `marker rail = [0, 0, 0] mm`"),
                ));
            };
            let marker = self.ground_at(partner, format!("ground at {path}"), ground_span);
            bound[index].1 = Argument::Value(Value::Marker(marker));
        }
        Ok(bound)
    }

    /// The names inside a class for one instance.
    pub fn class_scope(
        &mut self,
        source: &ElementSource<'a>,
        class: &Class<'a>,
        path: &str,
    ) -> Eval<ClassScope<'a>> {
        let mut texts = Vec::with_capacity(class.levels.len());
        for level in class.levels.iter() {
            let scope = self.new_scope(None, level.definition.module, path.to_owned());
            texts.push((level.block.items.as_slice(), scope));
        }
        let last = texts.last().map(|(_, scope)| *scope);
        let own = self.checked(last, class.declaration.name.span, "a class without a text")?;
        for (name, argument) in &source.arguments {
            let value = match argument {
                Argument::Value(v) => v.clone(),
                Argument::Again(expr, scope) => self.evaluate(expr, *scope)?,
            };
            let parameter = class.parameters.iter().find(|p| p.name.text == *name);
            let value = self.declared(value, parameter.map(|p| p.ty))?;
            let scope = parameter.map_or(own, |parameter| home(class, &texts, parameter));
            self.define(scope, name, Entry::Value(value));
        }
        for (items, scope) in &texts {
            self.register(items, *scope);
        }
        // a default may name any parameter, so it is evaluated at its first use
        for parameter in class.parameters.iter() {
            let scope = home(class, &texts, parameter);
            let name = &parameter.name.text;
            if parameter.default.is_some() && !self.scope(scope).entries.contains_key(name) {
                self.define(scope, name, Entry::Lazy(Lazy::DefaultOf(*parameter)));
            }
        }
        self.lengths_of_class(class, &texts)?;
        self.promises(&texts);
        self.link(&texts);
        // defaults become parameters of the model in the order of the class
        for parameter in class.parameters.iter() {
            let scope = home(class, &texts, parameter);
            if parameter.default.is_some() {
                self.entry(scope, &parameter.name.text, parameter.span)?;
            }
        }
        self.arrays_as_stated(class, &texts)?;
        Ok(ClassScope { own, texts })
    }

    /// The value of a parameter without an argument. It becomes a parameter of the instance.
    pub fn default_of(&mut self, parameter: &ClassParameter<'a>, own: ScopeId) -> Eval<Value<'a>> {
        let parameter_path = self.path(own, &parameter.name.text);
        let known = self
            .draft
            .parameters
            .iter()
            .position(|p| p.origin.path == parameter_path);
        if let Some(index) = known {
            let node = self.graphs.bind.graph.input(index as u32);
            return Ok(Value::Scalar(Scalar {
                stage: Stage::Bind,
                node,
            }));
        }
        let default = self.checked(parameter.default, parameter.span, "no default")?;
        let value = self.evaluate(default, own)?;
        let ty = self.type_at(parameter.ty.span)?;
        let value = if let Value::Partial(_) = value {
            self.function_argument(value, &parameter_path)?
        } else if is_structural(&ty) {
            value
        } else {
            let stated = Stated {
                expr: default,
                dimension: self.dimension_at(parameter.ty.span, own)?,
                limits: parameter.limits,
                span: parameter.span,
                scope: own,
            };
            self.parameterise(value, &parameter_path, stated)?
        };
        Ok(self.read_as(value, &ty))
    }

    /// Links the scopes of the texts of a class or record. A younger text sees all names of the elder ones. The text
    /// of an interface may use a name of its class only if the interface requires this name.
    pub(super) fn link(&mut self, texts: &Texts<'a>) {
        for (younger, (_, scope)) in texts.iter().enumerate() {
            for (_, elder) in texts.iter().take(younger).rev() {
                let names: Vec<String> = self.scope(*elder).entries.keys().cloned().collect();
                for name in names {
                    if !self.scope(*scope).entries.contains_key(&name) {
                        self.define(*scope, &name, Entry::In(*elder));
                    }
                }
            }
        }
        for (elder, (items, scope)) in texts.iter().enumerate() {
            // an interface also reads the items for which its own interface asks
            let asked = texts
                .iter()
                .take(elder + 1)
                .flat_map(|(items, _)| items.iter());
            for name in asked.filter_map(named) {
                let has = |e: &Self, scope: ScopeId| e.scope(scope).entries.contains_key(name);
                let mut younger = texts.iter().skip(elder + 1).map(|(_, scope)| *scope);
                if !has(self, *scope)
                    && let Some(gives) = younger.find(|younger| has(self, *younger))
                {
                    self.define(*scope, name, Entry::In(gives));
                }
            }
            // a class may give its own value of an output that its interface computes
            for name in items.iter().filter_map(output) {
                let gives = texts.iter().skip(elder + 1).find(|(younger, _)| {
                    let mut own = younger.iter().filter_map(output);
                    own.any(|own| own == name)
                });
                if let Some((_, gives)) = gives {
                    self.define(*scope, name, Entry::In(*gives));
                }
            }
        }
    }

    /// A scope with the functions and values of a record and its interface, before its fields are set.
    pub fn record_scope(&mut self, id: DefinitionId) -> ScopeId {
        let mut texts = Vec::new();
        for level in lineage::levels(self.program, id) {
            let module = level.definition.module;
            let around = self.module_scopes.get(module as usize).copied();
            let scope = self.new_scope(around, module, String::new());
            self.register(&level.block.items, scope);
            texts.push((level.block.items.as_slice(), scope));
        }
        self.link(&texts);
        match texts.last() {
            Some((_, own)) => *own,
            None => self.new_scope(None, id.module, String::new()),
        }
    }

    /// Registers lets, consts, outputs, functions and tables of a block. They are evaluated at their first
    /// use.
    pub fn register(&mut self, items: &'a [ast::Item], scope: ScopeId) {
        for item in items {
            match &item.kind {
                ItemKind::Binding(b)
                    if matches!(
                        b.kind,
                        BindingKind::Let
                            | BindingKind::Const
                            | BindingKind::Output
                            | BindingKind::Field
                    ) && b.value.is_some()
                        && !self.scope(scope).entries.contains_key(&b.name.text) =>
                {
                    self.define(scope, &b.name.text, Entry::Lazy(Lazy::Binding(b)));
                }
                ItemKind::Function(function) if function.bound => {
                    let lazy = Lazy::BoundFunction(function);
                    self.define(scope, &function.name.text, Entry::Lazy(lazy));
                }
                ItemKind::Function(function) if function.value.is_some() => self.define(
                    scope,
                    &function.name.text,
                    Entry::Value(Value::Closure(Closure {
                        function,
                        scope,
                        solution: None,
                    })),
                ),
                ItemKind::Table(t) => {
                    self.define(scope, &t.name.text, Entry::Lazy(Lazy::Table(t)));
                }
                _ => {}
            }
        }
    }

    /// A scope with the names of the class before those of the place of its use.
    pub fn use_scope(&mut self, own: ScopeId, caller: ScopeId) -> ScopeId {
        let module = self.scope(caller).module;
        let path = self.scope(own).path.clone();
        let inner = self.new_scope(Some(caller), module, path);
        let names: Vec<String> = self.scope(own).entries.keys().cloned().collect();
        for name in names {
            self.define(inner, &name, Entry::In(own));
        }
        inner
    }

    pub(super) fn touch(&mut self, value: Value<'a>) -> Eval<()> {
        match value {
            Value::Marker(m) => self.local_marker(m, None).map(|_| ()),
            Value::List(items) => items.into_iter().try_for_each(|v| self.touch(v)),
            _ => Ok(()),
        }
    }
}

/// The name of a value or function.
fn named(item: &ast::Item) -> Option<&str> {
    match &item.kind {
        ItemKind::Binding(binding) => Some(&binding.name.text),
        ItemKind::Function(function) => Some(&function.name.text),
        _ => None,
    }
}

fn output(item: &ast::Item) -> Option<&str> {
    match &item.kind {
        ItemKind::Binding(binding) if binding.kind == BindingKind::Output => {
            binding.value.as_ref().map(|_| binding.name.text.as_str())
        }
        _ => None,
    }
}

/// A marker, or several.
pub(crate) fn is_marker(ty: &Type) -> bool {
    match ty {
        Type::Marker => true,
        Type::List { element, .. } => is_marker(element),
        _ => false,
    }
}

/// Whether a class's code or layout depends on values of a type. Such values are no parameters of its
/// instances.
pub(crate) fn is_structural(ty: &Type) -> bool {
    match ty {
        Type::Int
        | Type::Bool
        | Type::Text
        | Type::Choice(_)
        | Type::Marker
        | Type::Body(_)
        | Type::ModeSet
        | Type::Function(_) => true,
        Type::List { element, .. } => is_structural(element),
        _ => false,
    }
}
