//! Lengths of arrays: those that arguments decide, those that types state, and those that interfaces promise.

use super::body::index_text;
use super::element::Class;
use super::value::{ScopeId, Value};
use super::{Elaborator, Entry, Eval, Lazy};
use crate::codes;
use crate::typed::lineage::{ClassParameter, word_of_length};
use eng_grammar::ast::{self, BindingKind, ItemKind, TypeExpr, TypeExprKind};
use eng_grammar::{Diagnostic, Span};

/// The texts of a class with the scopes of their names: those of its interfaces, the eldest first, then its
/// own.
pub(crate) type Texts<'a> = [(&'a [ast::Item], ScopeId)];

/// The number of elements of an array.
fn length_of(value: &Value<'_>) -> Option<usize> {
    match value {
        Value::List(items) => Some(items.len()),
        Value::Family(items) => {
            let absent = items.iter().filter(|(_, item)| item.is_absent());
            Some(items.len() - absent.count())
        }
        Value::Components(items, _) => Some(items.len()),
        _ => None,
    }
}

/// "1 element", "3 elements".
fn elements(count: usize) -> String {
    match count {
        1 => "1 element".to_owned(),
        count => format!("{count} elements"),
    }
}

impl<'a> Elaborator<'a, '_> {
    /// The word of a length that arguments decide: `n` of `values: Length[n]`.
    fn free_length(&self, ty: &'a TypeExpr) -> Option<(&'a String, Span)> {
        let lengths = &self.typed.findings.lengths;
        word_of_length(ty).filter(|(_, place)| lengths.contains(place))
    }

    /// Defines the length that the argument of an array decides, for a function. Arrays of one length must
    /// agree.
    pub fn count(&mut self, name: &str, ty: &'a TypeExpr, scope: ScopeId) -> Eval<()> {
        let Some((word, place)) = self.free_length(ty) else {
            return Ok(());
        };
        if !self.scope(scope).entries.contains_key(name) {
            return Ok(());
        }
        let Some(length) = length_of(&self.entry(scope, name, place)?) else {
            return Ok(());
        };
        match self.scope(scope).entries.get(word) {
            Some(Entry::Value(Value::Int(known))) if *known != length as i64 => {
                let known = *known;
                Err(self.other_length(name, length, (word, known), place, None))
            }
            _ => {
                self.define(scope, word, Entry::Value(Value::Int(length as i64)));
                Ok(())
            }
        }
    }

    /// Reports an array whose length differs from that of another one.
    fn other_length(
        &mut self,
        name: &str,
        length: usize,
        (word, known): (&str, i64),
        place: Span,
        argument: Option<Span>,
    ) -> super::Reported {
        let message = Diagnostic::error(
            codes::LENGTHS,
            format!("`{name}` has {}, and `{word}` is {known}", elements(length)),
        );
        let other = format!("`{word}` is {known}, the length of another array");
        let message = match argument {
            Some(argument) => message.at(argument, elements(length)).also(place, other),
            None => message.at(place, other),
        };
        self.report(message.with_help("arrays of one length have the same number of elements"))
    }

    /// Defines the lengths that the arguments of a class decide, in each text that states one. An array
    /// without an argument has that of its default.
    pub fn lengths_of_class(&mut self, class: &Class<'a>, texts: &Texts<'a>) -> Eval<()> {
        let mut known: Vec<(&'a str, ScopeId, Entry<'a>)> = Vec::new();
        let mut later: Vec<(&'a str, ScopeId, Entry<'a>)> = Vec::new();
        for parameter in class.parameters.iter() {
            let Some((word, _)) = self.free_length(parameter.ty) else {
                continue;
            };
            let scope = home(class, texts, parameter);
            match self.scope(scope).entries.get(&parameter.name.text) {
                Some(Entry::Value(value)) => {
                    let length = length_of(value).map(|length| Value::Int(length as i64));
                    known.extend(length.map(|length| (word.as_str(), scope, Entry::Value(length))));
                }
                Some(_) => later.push((word, scope, Entry::Lazy(Lazy::LengthOf(*parameter)))),
                None => {}
            }
        }
        known.extend(later);
        for (level, (items, scope)) in class.levels.iter().zip(texts) {
            let own = class.parameters.iter();
            let own = own
                .filter(|parameter| parameter.home == level.definition)
                .map(|parameter| parameter.ty);
            let of_interface = items.iter().filter_map(|item| match &item.kind {
                ItemKind::Binding(binding) => binding.ty.as_ref(),
                _ => None,
            });
            for ty in own.chain(of_interface) {
                let Some((word, _)) = self.free_length(ty) else {
                    continue;
                };
                let known = known.iter().find(|(known, ..)| known == word);
                if let Some((_, home, entry)) = known {
                    let entry = match entry {
                        Entry::Lazy(_) if home != scope => Entry::In(*home),
                        entry => entry.clone(),
                    };
                    self.define(*scope, word, entry);
                }
            }
        }
        Ok(())
    }

    /// The length of the default of an array.
    pub fn length_of_default(
        &mut self,
        parameter: &ClassParameter<'a>,
        scope: ScopeId,
    ) -> Eval<Value<'a>> {
        let value = self.entry(scope, &parameter.name.text, parameter.span)?;
        let length = length_of(&value).map(|length| Value::Int(length as i64));
        self.checked(length, parameter.span, "this is no array")
    }

    /// Checks the lengths of the arrays that a class gets against their types.
    pub fn arrays_as_stated(&mut self, class: &Class<'a>, texts: &Texts<'a>) -> Eval<()> {
        for parameter in class.parameters.iter() {
            let name = &parameter.name.text;
            let scope = home(class, texts, parameter);
            if !matches!(parameter.ty.kind, TypeExprKind::Array(..))
                || !self.scope(scope).entries.contains_key(name)
            {
                continue;
            }
            let value = self.entry(scope, name, parameter.span)?;
            let argument = self.draft.passed.get(&self.path(scope, name)).copied();
            if let (Some((word, place)), Some(length)) =
                (self.free_length(parameter.ty), length_of(&value))
                && let Value::Int(known) = self.entry(scope, word, place)?
                && known != length as i64
            {
                return Err(self.other_length(name, length, (word, known), place, argument));
            }
            let class_name = &class.declaration.name.text;
            let what = format!("`{name}` of `{class_name}`");
            let at = argument.unwrap_or(parameter.span);
            self.of_stated_length(&value, parameter.ty, scope, &what, at)?;
        }
        Ok(())
    }

    /// Checks that an array has the number of elements that its type states. The checker knows written numbers only.
    /// Here, constants and parameters are known. The scope is that of the type.
    pub fn of_stated_length(
        &mut self,
        value: &Value<'a>,
        ty: &'a TypeExpr,
        scope: ScopeId,
        what: &str,
        place: Span,
    ) -> Eval<()> {
        let (TypeExprKind::Array(element, length), Some(found)) = (&ty.kind, length_of(value))
        else {
            return Ok(());
        };
        if self.free_length(ty).is_none() {
            let wanted = self.integer(length, scope)?;
            if wanted != found as i64 {
                let written = self.sources.text(length.span).to_owned();
                let message = Diagnostic::error(
                    codes::LIST_LENGTH,
                    format!("{what} has {wanted} elements, not {found}"),
                )
                .at(place, elements(found))
                .also(length.span, format!("`{written}` is {wanted}"));
                return Err(self.report(message));
            }
        }
        if matches!(element.kind, TypeExprKind::Array(..))
            && let Value::List(items) = value
        {
            for item in items {
                self.of_stated_length(item, element, scope, what, place)?;
            }
        }
        Ok(())
    }

    /// Notes the arrays that the interfaces of a class require as outputs.
    pub fn promises(&mut self, texts: &Texts<'a>) {
        for (elder, (items, scope)) in texts.iter().enumerate() {
            for promise in items.iter().filter_map(output) {
                let array =
                    matches!(&promise.ty, Some(ty) if matches!(ty.kind, TypeExprKind::Array(..)));
                if promise.value.is_some() || promise.index.is_empty() && !array {
                    continue;
                }
                let younger = texts.iter().skip(elder + 1);
                let gives = younger.map(|(_, scope)| *scope).find(|younger| {
                    let entry = self.scope(*younger).entries.get(&promise.name.text);
                    matches!(entry, Some(Entry::Lazy(_)))
                });
                if let Some(own) = gives {
                    let key = (own.0, promise.name.text.clone());
                    self.draft.promised.insert(key, (promise, *scope));
                }
            }
        }
    }

    /// Checks the indices of an output against those that an interface promises. An output without an index must have
    /// the promised length.
    pub fn as_promised(
        &mut self,
        output: &'a ast::Binding,
        scope: ScopeId,
        found: &[(Vec<usize>, Value<'a>)],
    ) -> Eval<()> {
        let key = (scope.0, output.name.text.clone());
        let Some((promise, elder)) = self.draft.promised.get(&key).copied() else {
            return Ok(());
        };
        let name = &output.name;
        if let (Some(ty), [(_, value)]) = (&promise.ty, found) {
            let what = format!("the output `{}`", name.text);
            self.of_stated_length(value, ty, elder, &what, name.span)?;
        }
        if promise.index.is_empty() {
            return Ok(());
        }
        let mut wanted: Vec<Vec<usize>> = Vec::new();
        self.for_each(&promise.index, elder, &mut |_, _, position| {
            wanted.push(position.to_vec());
            Ok(())
        })?;
        let given: Vec<Vec<usize>> = match found {
            // an output without an index gives a list in its place
            [(position, value)] if position.is_empty() => (1..=length_of(value).unwrap_or(0))
                .map(|index| vec![index])
                .collect(),
            found => found.iter().map(|(position, _)| position.clone()).collect(),
        };
        if given == wanted {
            return Ok(());
        }
        let listed = |indices: &[Vec<usize>]| {
            let texts: Vec<String> = indices.iter().map(|index| index_text(index)).collect();
            let texts = texts.iter().map(String::as_str);
            match indices {
                [] => "none".to_owned(),
                _ => crate::resolve::suggest::listing(texts, 8),
            }
        };
        let (given, wanted) = (listed(&given), listed(&wanted));
        Err(self.report(
            Diagnostic::error(
                codes::INTERFACE,
                format!(
                    "the output `{}` has other indices than its interface states",
                    name.text
                ),
            )
            .at(name.span, format!("this has {given}"))
            .also(promise.name.span, format!("stated with {wanted}")),
        ))
    }
}

/// An output of a text.
fn output(item: &ast::Item) -> Option<&ast::Binding> {
    match &item.kind {
        ItemKind::Binding(binding) if binding.kind == BindingKind::Output => Some(binding),
        _ => None,
    }
}

/// The scope of the text that declares a parameter.
pub(crate) fn home<'a>(
    class: &Class<'a>,
    texts: &Texts<'a>,
    parameter: &ClassParameter<'a>,
) -> ScopeId {
    let levels = class.levels.iter().zip(texts);
    let mut at = levels.filter(|(level, _)| level.definition == parameter.home);
    let own = texts.last().map_or(ScopeId(0), |(_, scope)| *scope);
    at.next().map_or(own, |(_, (_, scope))| *scope)
}
