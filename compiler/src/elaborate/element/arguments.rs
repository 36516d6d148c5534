//! Arguments of a class, and their scope.

use super::super::binding::Stated;
use super::super::scalar::{Scalar, Stage};
use super::super::value::{Closure, ScopeId, Value};
use super::super::{Argument, Elaborator, ElementSource, Entry, Eval, Lazy};
use super::Class;
use crate::codes;
use crate::typed::types::Type;
use eng_grammar::ast::{BindingKind, ItemKind};
use eng_grammar::{Diagnostic, Span, ast};

impl<'a> Elaborator<'a, '_> {
    /// Evaluates the arguments of a class. Numbers become parameters of the instance.
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
        let places = self.call_at(span)?;
        for (argument, place) in arguments.iter().zip(places.iter()) {
            let parameter = class.parameters.get(*place as usize);
            let parameter = self.checked(parameter, argument.value.span, "no such parameter")?;
            let name = parameter.name.text.clone();
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
                Value::Table(mut t) => {
                    // the handle is no constant of the code, so that instances with other tables share the
                    // code
                    if let Some(known) = self.bench.bind.graph.as_constant(t.handle) {
                        t.handle = self.bench.bind.fixed(known);
                    }
                    Value::Table(t)
                }
                value if is_structural(&ty) => value,
                value => {
                    let stated = Stated {
                        expr: &argument.value,
                        dimension: self.dimension_at(parameter.ty.span, scope)?,
                        limits: parameter.limits.as_ref(),
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
            let parameter = class.parameters.iter().find(|p| p.name.text == *name);
            let value = self.declared(value, parameter.map(|p| &p.ty))?;
            self.define(own, name, Entry::Value(value));
        }
        for parameter in class.parameters {
            let name = &parameter.name.text;
            if !self.scope(own).entries.contains_key(name) {
                // a default becomes a parameter of the instance at its first use
                let parameter_path = format!("{path}.{name}");
                let known = self
                    .parameters
                    .iter()
                    .position(|p| p.origin.path == parameter_path);
                if let Some(index) = known {
                    let node = self.bench.bind.graph.input(index as u32);
                    let value = Value::Scalar(Scalar {
                        stage: Stage::Bind,
                        node,
                    });
                    self.define(own, name, Entry::Value(value));
                } else if let Some(default) = &parameter.default {
                    let value = self.evaluate(default, own)?;
                    let ty = self.type_at(parameter.ty.span)?;
                    let value = if is_structural(&ty) {
                        value
                    } else {
                        let stated = Stated {
                            expr: default,
                            dimension: self.dimension_at(parameter.ty.span, own)?,
                            limits: parameter.limits.as_ref(),
                            span: parameter.span,
                            scope: own,
                        };
                        self.parameterise(value, &parameter_path, stated)?
                    };
                    let value = self.read_as(value, &ty);
                    self.define(own, name, Entry::Value(value));
                }
            }
        }
        self.register(&class.block.items, own);
        Ok(own)
    }

    /// Registers lets, consts, outputs, functions and tables of a block. They are evaluated at their first
    /// use.
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
fn is_structural(ty: &Type) -> bool {
    match ty {
        Type::Int
        | Type::Bool
        | Type::Text
        | Type::Marker
        | Type::Body(_)
        | Type::ModeSet
        | Type::Function(_) => true,
        Type::List { element, .. } => is_structural(element),
        _ => false,
    }
}
