//! Repetition over the values of an index: bodies, elements, analyses, members of lists.

use super::value::{ScopeId, Value};
use super::{Elaborator, Entry, Eval};
use eng_grammar::ast;
use std::collections::BTreeSet;

/// The action for each combination of binders: it gets a scope with their values, and the combination's
/// index.
pub(crate) type Visit<'v, E> = dyn FnMut(&mut E, ScopeId, &[usize]) -> Eval<()> + 'v;

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
