//! Repetition over the values of an index: bodies, elements, analyses, members of lists.

use super::body::index_text;
use super::expression::{Truth, not_constant};
use super::value::{ScopeId, Value};
use super::{Elaborator, Entry, Eval, Reported};
use crate::codes;
use eng_grammar::ast;
use eng_grammar::{Diagnostic, Span};
use std::collections::BTreeSet;
use std::rc::Rc;

/// The action for each combination of binders: it gets a scope with their values, and the combination's
/// index.
pub(crate) type Visit<'v, E> = dyn FnMut(&mut E, ScopeId, &[usize]) -> Eval<()> + 'v;

/// Makes the instance of one combination.
pub(crate) type Make<'v, 'a, E> = dyn FnMut(&mut E, ScopeId, &[usize]) -> Eval<Value<'a>> + 'v;

impl<'a> Elaborator<'a, '_> {
    /// Runs `f` for every combination of the binders' values, with a scope of these values and their index
    /// `[2,1]`.
    pub fn for_each(
        &mut self,
        binders: &'a [ast::Binder],
        scope: ScopeId,
        f: &mut Visit<'_, Self>,
    ) -> Eval<()> {
        self.for_each_from(binders, scope, &mut Vec::new(), f)
    }

    /// The instances of a declaration: one, or a family where it has an index. Instances whose condition fails are
    /// left out. If the only instance is left out, the value states that it is absent.
    pub fn instances_of(
        &mut self,
        declaration: &'a ast::Declaration,
        scope: ScopeId,
        make: &mut Make<'_, 'a, Self>,
    ) -> Eval<Value<'a>> {
        let mut made = Vec::new();
        self.for_each(&declaration.index, scope, &mut |e, inner, position| {
            if let Some(condition) = &declaration.condition
                && !e.known_truth(condition, &declaration.name.text, inner)?
            {
                // the error about a path to it shows the condition
                let path = e.path_in(scope, &declaration.name.text, position);
                e.draft.absent.push((declaration, path.clone()));
                made.push((position.to_vec(), Value::Absent(declaration, path)));
                return Ok(());
            }
            made.push((position.to_vec(), make(e, inner, position)?));
            Ok(())
        })?;
        if !declaration.index.is_empty() {
            let path = self.path(scope, &declaration.name.text);
            let indices = made.iter().map(|(position, _)| position.clone());
            self.draft.repeated.insert(path, indices.collect());
            return Ok(Value::Family(made));
        }
        // without an index there is one combination
        let only = made.pop().map(|(_, only)| only);
        self.checked(only, declaration.name.span, "an item without an instance")
    }

    /// The path of an item of a scope: `arm[2].ring`.
    fn path_in(&self, scope: ScopeId, name: &str, position: &[usize]) -> Rc<str> {
        let index = index_text(position);
        match self.scope(scope).path.as_str() {
            "" => format!("{name}{index}").into(),
            around => format!("{around}.{name}{index}").into(),
        }
    }

    /// The condition of a part, which parameters do not change.
    fn known_truth(&mut self, condition: &'a ast::Expr, part: &str, scope: ScopeId) -> Eval<bool> {
        match self.truth(condition, scope)? {
            Truth::Known(holds) => Ok(holds),
            Truth::Later(_) => {
                let label = format!("decides whether `{part}` exists");
                Err(self.report(not_constant(condition.span, label)))
            }
        }
    }

    /// The error for the use of a part, with its path, that does not exist.
    pub fn absent(&mut self, declaration: &ast::Declaration, path: &str, place: Span) -> Reported {
        let message = does_not_exist(declaration, path, place, "used here");
        self.report(message.with_help(match self.context.in_start {
            true => "a `start` has no condition: put the part and its start into a component, and give the part of this component the condition",
            false => "give the part that uses it the same condition; an output takes an index over a range that may be empty: `output x[k in 1..count] = …`",
        }))
    }

    fn for_each_from(
        &mut self,
        binders: &'a [ast::Binder],
        scope: ScopeId,
        position: &mut Vec<usize>,
        f: &mut Visit<'_, Self>,
    ) -> Eval<()> {
        let Some((first, rest)) = binders.split_first() else {
            return f(self, scope, position);
        };
        let range = self.evaluate(&first.range, scope)?;
        let values: Vec<Value<'a>> = self.read(Self::without_axes(range), first.range.span)?;
        // different whole numbers become the indices of the instances; other values give positions
        let mut named = Vec::with_capacity(values.len());
        for value in &values {
            match value {
                Value::Int(n) if *n >= 0 => named.push(*n as usize),
                _ => break,
            }
        }
        let distinct: BTreeSet<usize> = named.iter().copied().collect();
        let by_value = distinct.len() == values.len();
        for (i, value) in values.into_iter().enumerate() {
            self.count_instance(first.name.span)?;
            let module = self.scope(scope).module;
            let path = self.scope(scope).path.clone();
            let inner = self.new_scope(Some(scope), module, path);
            let shown = match named.get(i) {
                Some(number) if by_value => *number,
                _ => i + 1,
            };
            self.define(inner, &first.name.text, Entry::Value(value));
            position.push(shown);
            let result = self.for_each_from(rest, inner, position, f);
            position.pop();
            result?;
        }
        Ok(())
    }
}

/// The error about an item whose condition does not hold, at the place that names it.
pub(super) fn does_not_exist(
    declaration: &ast::Declaration,
    path: &str,
    place: Span,
    label: &str,
) -> Diagnostic {
    let title = format!("`{path}` does not exist");
    let message = Diagnostic::error(codes::ABSENT, title).at(place, label);
    message.also_if(
        declaration
            .condition
            .as_ref()
            .map(|condition| condition.span),
        "this does not hold",
    )
}
