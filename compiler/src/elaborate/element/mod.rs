//! Instances of joints, forces, journals and drives: each becomes a graph of its own.
//!
//! To *lower* a text means to write its values as nodes of such a graph.

mod arguments;
mod equations;
mod field;
mod laws;

pub(crate) use arguments::{is_marker, is_structural};

use super::scalar::{ElementBuilder, PROVISIONAL};
use super::value::{Axes, Given, ScopeId, Value};
use super::{Argument, Elaborator, ElementSource, Eval, OutputShape, body::index_text, location};
use crate::codes;
use crate::ir::Node;
use crate::program::DefinitionId;
use crate::typed::kind_words::{kind_word, with_article};
use crate::typed::lineage::{self, ClassParameter, Level};
use crate::typed::types::Type;
use eng_grammar::ast::{self, ExprKind, Form, Kind};
use eng_grammar::{Diagnostic, Span};
use eng_system::system::{Condition, ConditionKind, Origin, OutputInfo, Role};
use std::rc::Rc;

/// A class's parts, found in its definition and its interfaces.
#[derive(Clone)]
pub(crate) struct Class<'a> {
    pub definition: DefinitionId,
    pub declaration: &'a ast::Declaration,
    pub parameters: Rc<[ClassParameter<'a>]>,
    /// The texts of its interfaces, the eldest first, then its own.
    pub levels: Rc<[Level<'a>]>,
}

/// The names of one instance of a class.
pub(crate) struct ClassScope<'a> {
    /// The names in the class's own text, which has those of its interfaces.
    pub own: ScopeId,
    /// The items of each text with the scope of its names.
    pub texts: Vec<(&'a [ast::Item], ScopeId)>,
}

/// The data of an element while it is lowered.
#[derive(Default)]
pub(crate) struct Draft {
    pub conditions: Vec<(Node, Condition)>,
    pub outputs: Vec<Node>,
    pub infos: Vec<OutputInfo>,
    pub shapes: Vec<OutputShape>,
    /// The axes of each output, if the text states them.
    pub frames: Vec<Option<Axes>>,
    /// Frames of copied channels, by output.
    pub copied: Vec<(usize, String)>,
}

impl<'a> Elaborator<'a, '_> {
    pub fn class_of(&mut self, id: DefinitionId, span: Span) -> Eval<Class<'a>> {
        let program = self.program;
        let is_class = |d: &&ast::Declaration| matches!(d.form, Form::Class { .. });
        let declaration = program.declaration(id).filter(is_class);
        let found = declaration.map(|declaration| Class {
            definition: id,
            declaration,
            parameters: lineage::parameters(program, id).into(),
            levels: lineage::levels(program, id).into(),
        });
        self.checked(found, span, "this is no class")
    }

    /// The parts `= value { additions }` of a declaration.
    pub fn instance(
        &mut self,
        declaration: &'a ast::Declaration,
    ) -> Eval<(&'a ast::Expr, Option<&'a ast::Block>)> {
        let found = match &declaration.form {
            Form::Instance { value, block } => Some((value, block.as_ref())),
            Form::Class { .. } | Form::Plain { .. } => None,
        };
        self.checked(found, declaration.name.span, "it has no value")
    }

    /// The class of `Class(arguments)`, and the arguments: those that the class has already, then those of the
    /// call.
    pub fn class_called(
        &mut self,
        value: &'a ast::Expr,
        scope: ScopeId,
    ) -> Eval<(Class<'a>, Vec<Given<'a>>)> {
        let (callee, arguments) = self.called(value)?;
        let class = self.evaluate(callee, scope)?;
        let (class, mut given) = match class {
            Value::Bound(bound) => (bound.class, bound.given.clone()),
            other => (self.read(other, callee.span)?, Vec::new()),
        };
        given.push(Given {
            arguments,
            scope,
            call: value.span,
            interface: match self.type_at(callee.span)? {
                Type::ClassOf(interface) => Some(interface),
                _ => None,
            },
        });
        Ok((self.class_of(class, callee.span)?, given))
    }

    /// The class of an item with its arguments. A class that was passed on by its interface may be of another
    /// kind than the item.
    pub fn class_used(
        &mut self,
        declaration: &'a ast::Declaration,
        value: &'a ast::Expr,
        scope: ScopeId,
    ) -> Eval<(Class<'a>, Vec<Given<'a>>)> {
        let (class, given) = self.class_called(value, scope)?;
        let wanted = match declaration.kind {
            Kind::Part => Kind::Component,
            kind => kind,
        };
        let found = class.declaration.kind;
        if found == wanted {
            return Ok((class, given));
        }
        let (callee, _) = self.called(value)?;
        let (name, word) = (&class.declaration.name, kind_word(found));
        let message = Diagnostic::error(
            codes::KIND,
            format!(
                "`{}` is {}, not {}",
                name.text,
                with_article(word),
                with_article(kind_word(wanted))
            ),
        )
        .at(
            declaration.kind_span,
            format!("declared as {}", with_article(kind_word(declaration.kind))),
        );
        let message = message.also_if(self.passed_at(callee, scope), "passed here");
        let item = match found {
            Kind::Component => "part",
            _ => word,
        };
        let callee = self.sources.text(callee.span);
        let help = format!(
            "pass a {} to it, or write `{item} {} = {callee}(…)`",
            kind_word(wanted),
            declaration.name.text
        );
        let message = message.also(name.span, format!("defined as {}", with_article(word)));
        Err(self.report(message.with_help(help)))
    }

    /// The place of the argument that gave a parameter its class.
    fn passed_at(&self, callee: &ast::Expr, scope: ScopeId) -> Option<Span> {
        let name = match &callee.kind {
            ExprKind::Name(name) => name,
            ExprKind::Index { base, .. } => return self.passed_at(base, scope),
            ExprKind::Paren { inner, .. } => return self.passed_at(inner, scope),
            _ => return None,
        };
        let mut at = Some(scope);
        while let Some(id) = at {
            if self.scope(id).entries.contains_key(name) {
                return self.draft.passed.get(&self.path(id, name)).copied();
            }
            at = self.scope(id).parent;
        }
        None
    }

    /// The called expression and its arguments.
    pub fn called(&mut self, value: &'a ast::Expr) -> Eval<(&'a ast::Expr, &'a [ast::Argument])> {
        let found = match &value.kind {
            ExprKind::Call { callee, arguments } => Some((&**callee, arguments.as_slice())),
            _ => None,
        };
        self.checked(found, value.span, "it is no call")
    }

    /// The elements of `kind name[index] = Class(arguments) { additions }`.
    pub fn elements_of(
        &mut self,
        declaration: &'a ast::Declaration,
        scope: ScopeId,
    ) -> Eval<Value<'a>> {
        let (value, block) = self.instance(declaration)?;
        let name = &declaration.name.text;
        let base = self.path(scope, name);
        self.instances_of(declaration, scope, &mut |e, inner, position| {
            let path = format!("{base}{}", index_text(position));
            let element = e.element(declaration, value, block, inner, path);
            e.graphs.element = None;
            Ok(Value::Element(element?))
        })
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
        let (class, given) = self.class_used(declaration, value, scope)?;
        self.graphs.element = Some(ElementBuilder::default());
        self.graphs.bind.owner.clone_from(&path);
        let bound = self.bind_arguments(&class, &given, &path)?;
        let place = declaration.name.span;
        self.used_at(place, |e| {
            e.element_of_class(&class, bound, block, scope, path, place)
        })
    }

    /// An instance of a class with its arguments.
    pub fn element_of_class(
        &mut self,
        class: &Class<'a>,
        bound: Vec<(String, Argument<'a>)>,
        block: Option<&'a ast::Block>,
        scope: ScopeId,
        path: String,
        span: Span,
    ) -> Eval<u32> {
        self.graphs.element = Some(ElementBuilder::default());
        self.context.rates = None;
        self.graphs.bind.owner.clone_from(&path);
        let used_at = Some(location(span));
        if let Some(block) = block {
            self.accepted_in(&block.items, &path);
        }
        let source = ElementSource {
            definition: class.definition,
            arguments: bound,
        };
        let class_scope = self.class_scope(&source, class, &path)?;
        let ClassScope { own, texts } = &class_scope;
        let own = *own;
        // marker parameters come first, so that their local indices follow the order of the parameters
        for parameter in class.parameters.iter() {
            if is_marker(&self.type_at(parameter.ty.span)?) {
                let value = self.entry(own, &parameter.name.text, parameter.span)?;
                self.touch(value)?;
            }
        }
        for (items, scope) in texts {
            self.states(items, *scope, &path, used_at)?;
        }
        // a class reads the states of its interfaces
        if texts.len() > 1 {
            self.link(texts);
        }
        let at_use = block.map(|b| (b, self.use_scope(own, scope)));
        let mut draft = Draft::default();
        for (items, scope) in texts {
            self.equations(items, *scope, &path, used_at, &mut draft)?;
        }
        if let Some((b, use_scope)) = at_use {
            self.equations(&b.items, use_scope, &path, used_at, &mut draft)?;
        }
        let missing = self
            .graphs
            .element
            .as_ref()
            .and_then(|e| e.states.iter().find(|s| s.rate.is_none()))
            .map(|s| s.name.clone());
        if let Some(state) = missing {
            let span = class.declaration.name.span;
            return self.checked(None, span, &format!("state `{state}` has no rate"));
        }
        if let Some(element) = self.graphs.element.as_mut() {
            let zero = element.graph.constant(0.0);
            let mut rates: Vec<Node> = element.states.iter().filter_map(|s| s.rate).collect();
            rates.resize(PROVISIONAL.states as usize, zero);
            self.context.rates = Some(rates);
        }
        self.context.in_output = true;
        let outputs = texts
            .iter()
            .try_for_each(|(items, scope)| self.class_outputs(items, *scope, &mut draft))
            .and_then(|()| match at_use {
                Some((b, use_scope)) => self.class_outputs(&b.items, use_scope, &mut draft),
                None => Ok(()),
            })
            .and_then(|()| self.reaction_outputs(class, &mut draft));
        self.context.in_output = false;
        self.context.rates = None;
        outputs?;
        self.call_conditions(&mut draft);
        let known = self.by_interface(class, &class_scope)?;
        for (items, scope) in texts {
            self.resolutions(items, *scope, &path, used_at)?;
            self.placings(items, *scope)?;
        }
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
        self.note(known, class, index)?;
        Ok(index)
    }

    /// Adds the conditions of the functions that the element has called.
    pub fn call_conditions(&mut self, draft: &mut Draft) {
        let conditions = self
            .graphs
            .element
            .as_mut()
            .map(|element| std::mem::take(&mut element.call_conditions));
        for condition in conditions.into_iter().flatten() {
            let kind = if condition.advise {
                ConditionKind::Advise
            } else {
                ConditionKind::Require
            };
            self.condition(
                condition.flag,
                kind,
                &condition.name,
                condition.message,
                condition.span,
                draft,
            );
        }
    }
}
