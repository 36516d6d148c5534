//! The top-level names in the scope of each module. Own names hide those taken by `use`. Names taken one by
//! one hide those of `.*`. All of them hide the prelude's.

use super::PRELUDE;
use super::modules::{dotted, span_of};
use super::suggest::{listing, nearest};
use crate::codes;
use crate::program::{DefinitionId, Program};
use eng_grammar::ast::{File, ItemKind, Name, UseNames};
use eng_grammar::{Diagnostic, Diagnostics, Span};
use std::collections::{BTreeMap, BTreeSet};

/// The name that a top-level item gives to the scope of its file. Units have a table of their own.
pub(crate) fn defined_name(item: &ItemKind) -> Option<&Name> {
    match item {
        ItemKind::Unit(_) | ItemKind::Entry(_) => None,
        other => other.name(),
    }
}

pub(super) fn fill(program: &mut Program, diagnostics: &mut Diagnostics) {
    let own: Vec<BTreeMap<String, DefinitionId>> = program
        .modules
        .iter()
        .enumerate()
        .map(|(index, module)| own_names(index as u32, &module.file, diagnostics))
        .collect();
    let prelude = program.modules.iter().position(|m| m.path == PRELUDE);
    let mut scopes = Vec::new();
    let mut prelude_scope = BTreeMap::new();
    for index in 0..program.modules.len() {
        let scope = scope(program, &own, index, diagnostics);
        let mut whole = match prelude {
            // modules that the prelude itself uses come before it and do not see the prelude
            Some(at) if index > at => prelude_scope.clone(),
            _ => BTreeMap::new(),
        };
        whole.extend(scope);
        if prelude == Some(index) {
            prelude_scope = whole.clone();
        }
        scopes.push(whole);
    }
    for (module, scope) in program.modules.iter_mut().zip(scopes) {
        module.scope = scope;
    }
}

fn own_names(
    module: u32,
    file: &File,
    diagnostics: &mut Diagnostics,
) -> BTreeMap<String, DefinitionId> {
    let mut names: BTreeMap<String, DefinitionId> = BTreeMap::new();
    let mut places: BTreeMap<String, Span> = BTreeMap::new();
    for (item, kind) in file.items.iter().enumerate() {
        let Some(name) = defined_name(&kind.kind) else {
            continue;
        };
        if let Some(first) = places.get(&name.text) {
            diagnostics.push(
                Diagnostic::error(
                    codes::DEFINED_TWICE,
                    format!("`{}` is defined twice", name.text),
                )
                .at(name.span, "again here")
                .also(*first, "first here")
                .with_help("every name has one meaning in a file: rename one of them"),
            );
            continue;
        }
        places.insert(name.text.clone(), name.span);
        let item = item as u32;
        names.insert(name.text.clone(), DefinitionId { module, item });
    }
    names
}

fn scope(
    program: &Program,
    own: &[BTreeMap<String, DefinitionId>],
    index: usize,
    diagnostics: &mut Diagnostics,
) -> BTreeMap<String, DefinitionId> {
    let module = &program.modules[index];
    let mut all: BTreeMap<String, (DefinitionId, String)> = BTreeMap::new();
    let mut named: BTreeMap<String, (DefinitionId, Span)> = BTreeMap::new();
    for item in &module.file.items {
        let ItemKind::Use(used) = &item.kind else {
            continue;
        };
        let path = dotted(&used.path);
        let Some(from) = program.modules.iter().position(|m| m.path == path) else {
            continue; // reported when it was not found
        };
        match &used.names {
            UseNames::All => {
                for (name, id) in &own[from] {
                    match all.get(name) {
                        Some((other, other_path))
                            if other != id && !own[index].contains_key(name) =>
                        {
                            diagnostics.push(
                                Diagnostic::error(
                                    codes::AMBIGUOUS_USE,
                                    format!("both `{other_path}` and `{path}` have `{name}`"),
                                )
                                .at(span_of(used).unwrap_or(item.span), "the second one")
                                .with_help(format!(
                                    "take the names that are needed one by one: `use {path}.{{…}}`"
                                )),
                            );
                        }
                        _ => {
                            all.insert(name.clone(), (*id, path.clone()));
                        }
                    }
                }
            }
            UseNames::Some(names) => {
                for name in names {
                    import(program, own, (index, from), name, &mut named, diagnostics);
                }
            }
        }
    }
    let mut scope: BTreeMap<String, DefinitionId> = BTreeMap::new();
    scope.extend(all.into_iter().map(|(name, (id, _))| (name, id)));
    scope.extend(named.into_iter().map(|(name, (id, _))| (name, id)));
    scope.extend(own[index].iter().map(|(name, id)| (name.clone(), *id)));
    scope
}

/// Imports a name by `use path.{name}` from the module `from` into the module `index`.
fn import(
    program: &Program,
    own: &[BTreeMap<String, DefinitionId>],
    (index, from): (usize, usize),
    name: &Name,
    named: &mut BTreeMap<String, (DefinitionId, Span)>,
    diagnostics: &mut Diagnostics,
) {
    let path = &program.modules[from].path;
    let Some(id) = own[from].get(&name.text) else {
        let units: BTreeSet<&str> = program.modules[from]
            .file
            .items
            .iter()
            .filter_map(|item| match &item.kind {
                ItemKind::Unit(unit) => Some(unit.name.text.as_str()),
                _ => None,
            })
            .collect();
        if units.contains(name.text.as_str()) {
            return; // units are known everywhere; naming one is no mistake
        }
        let mut message = Diagnostic::error(
            codes::NOT_IN_MODULE,
            format!("`{path}` has no `{}`", name.text),
        )
        .at(name.span, "not in that module");
        if let Some(near) = nearest(&name.text, own[from].keys().map(String::as_str)) {
            message = message.meant(name.span, near);
        } else if let Some(elsewhere) = own.iter().position(|names| names.contains_key(&name.text))
        {
            message = message.with_help(format!(
                "`{}` is in `{}`",
                name.text, program.modules[elsewhere].path
            ));
        } else if let Some(elsewhere) = program.offered.get(&name.text) {
            message = message.with_help(format!("`{}` is in `{}`", name.text, elsewhere.module));
        } else {
            message = message.with_note(format!(
                "it has {}",
                listing(own[from].keys().map(String::as_str), 12)
            ));
        }
        diagnostics.push(message);
        return;
    };
    let mine = own[index]
        .get(&name.text)
        .and_then(|id| program.item(*id))
        .and_then(|item| defined_name(&item.kind));
    if let Some(mine) = mine {
        diagnostics.push(
            Diagnostic::error(
                codes::DEFINED_TWICE,
                format!(
                    "`{}` is taken from `{path}` and defined here too",
                    name.text
                ),
            )
            .at(mine.span, "defined here")
            .also(name.span, "taken here")
            .with_help("rename the one defined here, or do not take the other"),
        );
        return;
    }
    match named.get(&name.text) {
        Some((other, first)) if other != id => diagnostics.push(
            Diagnostic::error(
                codes::AMBIGUOUS_USE,
                format!("`{}` is taken from two modules", name.text),
            )
            .at(name.span, "again here")
            .also(*first, "first here")
            .with_help("take only one of them"),
        ),
        _ => {
            named.insert(name.text.clone(), (*id, name.span));
        }
    }
}
