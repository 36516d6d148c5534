//! Definitions that use each other in any order. Each is evaluated once, and circles are reported.

use super::suggest::nearest;
use crate::codes;
use eng_grammar::ast::{DimensionItem, Name, UnitItem};
use eng_grammar::{Diagnostic, Diagnostics};
use std::collections::BTreeMap;

/// Most definitions that depend on each other in a chain. A choice: texts have some ten, and the stack has
/// room for this depth.
const DEEPEST_DEFINITIONS: u32 = 100;

/// A definition under a name.
pub(super) trait Defined: Clone {
    /// The kind, for messages.
    const WHAT: &'static str;

    fn name(&self) -> &Name;
}

impl Defined for DimensionItem {
    const WHAT: &'static str = "dimension";

    fn name(&self) -> &Name {
        &self.name
    }
}

impl Defined for UnitItem {
    const WHAT: &'static str = "unit";

    fn name(&self) -> &Name {
        &self.name
    }
}

/// The state of a definition.
enum Entry<T> {
    /// Under evaluation. Another use is a circle.
    Open,
    /// Wrong; the error was reported.
    Bad,
    Done(T),
}

/// Definitions by name, and the results of those evaluated so far.
pub(super) struct Definitions<I, T> {
    items: BTreeMap<String, I>,
    done: BTreeMap<String, Entry<T>>,
    depth: u32,
}

/// The result of looking up a name.
pub(super) enum Looked<I, T> {
    /// Evaluated, or wrong and reported.
    Known(Option<T>),
    /// To be evaluated, and given to [`Definitions::end`].
    New(I),
}

impl<I: Defined, T: Clone> Definitions<I, T> {
    pub fn new(items: BTreeMap<String, I>) -> Definitions<I, T> {
        Definitions {
            items,
            done: BTreeMap::new(),
            depth: 0,
        }
    }

    pub fn names(&self) -> Vec<String> {
        self.items.keys().cloned().collect()
    }

    pub fn contains(&self, name: &str) -> bool {
        self.items.contains_key(name)
    }

    /// The defined name most like this one.
    pub fn nearest(&self, name: &str) -> Option<&str> {
        nearest(name, self.items.keys().map(String::as_str))
    }

    /// Looks a name up. A new one is under evaluation until [`Definitions::end`].
    pub fn begin(&mut self, name: &str, diagnostics: &mut Diagnostics) -> Looked<I, T> {
        match self.done.get(name) {
            Some(Entry::Done(known)) => return Looked::Known(Some(known.clone())),
            Some(Entry::Bad) => return Looked::Known(None),
            Some(Entry::Open) => {
                if let Some(item) = self.items.get(name) {
                    diagnostics.push(
                        Diagnostic::error(
                            codes::UNIT_CIRCLE,
                            format!("the {} `{name}` is defined by itself", I::WHAT),
                        )
                        .at(item.name().span, "its definition leads back to it"),
                    );
                }
                self.done.insert(name.to_owned(), Entry::Bad);
                return Looked::Known(None);
            }
            None => {}
        }
        let Some(item) = self.items.get(name).cloned() else {
            return Looked::Known(None);
        };
        if self.depth > DEEPEST_DEFINITIONS {
            diagnostics.push(
                Diagnostic::error(codes::BAD_UNIT, "the definitions are nested too deeply")
                    .at(item.name().span, "here it is too deep"),
            );
            return Looked::Known(None);
        }
        self.depth += 1;
        self.done.insert(name.to_owned(), Entry::Open);
        Looked::New(item)
    }

    /// Ends the evaluation of a name. After a circle it is wrong.
    pub fn end(&mut self, name: &str, result: Option<T>) -> Option<T> {
        self.depth -= 1;
        let open = matches!(self.done.get(name), Some(Entry::Open));
        let entry = match &result {
            Some(value) if open => Entry::Done(value.clone()),
            _ => Entry::Bad,
        };
        self.done.insert(name.to_owned(), entry);
        result
    }

    /// The definitions without error.
    pub fn known(self) -> impl Iterator<Item = (String, T)> {
        self.done
            .into_iter()
            .filter_map(|(name, entry)| match entry {
                Entry::Done(value) => Some((name, value)),
                _ => None,
            })
    }
}
