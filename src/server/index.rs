//! Definitions by their names, from the syntax trees of a text, of the files that it uses and of the library. The trees
//! of texts with mistakes have the items that could be read.
//!
//! Here are the modules, and the definitions at their top level.

mod members;
mod scope;

pub(super) use members::OF_MARKERS;

use super::document::Document;
use crate::sources::Sources;
use eng_grammar::ast::{File, Item, ItemKind, Kind, Name, Parameter, UseNames};
use eng_grammar::{Diagnostics, SourceId, Span, parse};
use eng_system::host::Host;

/// Most modules that lead to a name: a circle of uses ends here. The number is a choice.
const DEEPEST: usize = 6;

/// A text with its tree.
pub(super) struct Module {
    /// `std.joints`.
    pub path: String,
    /// The file in the folder of the document; absent for the library and for the document itself.
    pub file_name: Option<String>,
    pub text: String,
    pub file: File,
}

fn module(path: &str, file_name: Option<String>, text: &str) -> Module {
    Module {
        path: path.to_owned(),
        file_name,
        text: text.to_owned(),
        file: parse(text, SourceId(0), &mut Diagnostics::new()),
    }
}

/// The modules of the library.
pub(super) struct Library(Vec<Module>);

impl Library {
    pub fn read() -> Library {
        let texts = eng_compiler::library::LIBRARY.iter();
        Library(texts.map(|(path, text)| module(path, None, text)).collect())
    }
}

pub(super) struct Index<'l> {
    library: &'l [Module],
    /// The files that the document uses, then the document.
    own: Vec<Module>,
}

/// A definition.
#[derive(Clone, Copy)]
pub(super) struct Found<'i> {
    /// The module that has it.
    pub module: usize,
    pub what: What<'i>,
}

#[derive(Clone, Copy)]
pub(super) enum What<'i> {
    Item(&'i Item, &'i Name),
    Parameter(&'i Parameter),
    /// A variable of an index, or a word of a choice.
    Name(&'i Name),
}

impl<'i> Found<'i> {
    pub fn name(&self) -> &'i Name {
        match self.what {
            What::Item(_, name) | What::Name(name) => name,
            What::Parameter(parameter) => &parameter.name,
        }
    }

    pub fn name_span(&self) -> Span {
        self.name().span
    }

    pub fn item(&self) -> Option<&'i Item> {
        match self.what {
            What::Item(item, _) => Some(item),
            _ => None,
        }
    }
}

/// Whether a definition is a declaration of one of some kinds.
pub(super) fn is_kind(found: Found<'_>, kinds: &[Kind]) -> bool {
    let kind = found.item().map(|item| &item.kind);
    matches!(kind, Some(ItemKind::Declaration(declaration)) if kinds.contains(&declaration.kind))
}

impl<'l> Index<'l> {
    pub fn new(library: &'l Library, document: &Document, sources: &Sources) -> Index<'l> {
        let mut own: Vec<Module> = Vec::new();
        let root = module("", None, &document.text);
        let mut waiting: Vec<(String, usize)> = uses(&root.file).map(|path| (path, 0)).collect();
        while let Some((path, depth)) = waiting.pop() {
            let known = own.iter().any(|module| module.path == path);
            if known || depth > DEEPEST || path.starts_with("std.") {
                continue;
            }
            let name = format!("{}.eng", path.replace('.', "/"));
            if let Ok(text) = sources.read_text(&name) {
                let read = module(&path, Some(name), &text);
                waiting.extend(uses(&read.file).map(|path| (path, depth + 1)));
                own.push(read);
            }
        }
        own.push(root);
        Index {
            library: &library.0,
            own,
        }
    }

    /// The number of the document's module.
    pub fn own(&self) -> usize {
        self.library.len() + self.own.len() - 1
    }

    pub fn module(&self, number: usize) -> Option<&Module> {
        match number.checked_sub(self.library.len()) {
            Some(own) => self.own.get(own),
            None => self.library.get(number),
        }
    }

    fn modules(&self) -> impl Iterator<Item = (usize, &Module)> {
        self.library.iter().chain(&self.own).enumerate()
    }

    /// Whether a module belongs to the library.
    pub fn is_library(&self, number: usize) -> bool {
        number < self.library.len()
    }

    /// The paths of all modules of the library.
    pub fn paths(&self) -> impl Iterator<Item = &str> {
        self.library.iter().map(|module| module.path.as_str())
    }

    /// The definitions of a module at its top level.
    pub fn top(&self, number: usize) -> Vec<Found<'_>> {
        let items = self
            .module(number)
            .map_or(&[][..], |module| &module.file.items);
        of_items(number, items)
    }

    /// The number of the module of a path.
    pub fn numbered(&self, path: &str) -> Option<usize> {
        let mut all = self.modules();
        all.find(|(_, module)| module.path == path && !path.is_empty())
            .map(|(number, _)| number)
    }

    /// All definitions at the top level that a module sees.
    pub fn visible(&self, number: usize) -> Vec<Found<'_>> {
        let mut found = self.top(number);
        for (module, names) in self.used(number) {
            let all = match module == number {
                true => Vec::new(),
                false => self.offered(module, 0),
            };
            found.extend(all.into_iter().filter(|one| takes(names, &one.name().text)));
        }
        found
    }

    /// The definitions that a module gives to a `use`: its own, and those of the modules that it takes whole.
    fn offered(&self, number: usize, depth: usize) -> Vec<Found<'_>> {
        let mut found = self.top(number);
        if depth < DEEPEST {
            for (module, names) in self.used(number) {
                if matches!(names, Some(UseNames::All)) {
                    found.extend(self.offered(module, depth + 1));
                }
            }
        }
        found
    }

    /// The modules that a module uses, with the names that it takes; no names for the prelude, which gives all. Names of
    /// the first ones hide those of the later ones.
    fn used(&self, number: usize) -> Vec<(usize, Option<&UseNames>)> {
        let mut used = Vec::new();
        let Some(module) = self.module(number) else {
            return used;
        };
        for item in &module.file.items {
            if let ItemKind::Use(item) = &item.kind {
                let path: Vec<&str> = item.path.iter().map(|name| name.text.as_str()).collect();
                used.extend(
                    self.numbered(&path.join("."))
                        .map(|found| (found, Some(&item.names))),
                );
            }
        }
        let prelude = self.numbered(eng_compiler::resolve::PRELUDE);
        used.extend(
            prelude
                .filter(|prelude| *prelude != number)
                .map(|found| (found, None)),
        );
        // as in the compiler: names taken one by one hide those of `.*`, and all of them hide the prelude's
        used.sort_by_key(|(_, names)| match names {
            Some(UseNames::Some(_)) => 0,
            Some(UseNames::All) => 1,
            None => 2,
        });
        used
    }

    /// The definition of a name at the top level of a module, or one that it uses.
    pub fn look_up(&self, number: usize, name: &str) -> Option<Found<'_>> {
        let all = self.visible(number);
        all.into_iter().find(|found| found.name().text == name)
    }
}

fn takes(names: Option<&UseNames>, name: &str) -> bool {
    match names {
        None | Some(UseNames::All) => true,
        Some(UseNames::Some(names)) => names.iter().any(|taken| taken.text == name),
    }
}

fn uses(file: &File) -> impl Iterator<Item = String> {
    file.items.iter().filter_map(|item| match &item.kind {
        ItemKind::Use(item) => {
            let path: Vec<&str> = item.path.iter().map(|name| name.text.as_str()).collect();
            Some(path.join("."))
        }
        _ => None,
    })
}

/// The definitions of items, with the words of their choices.
fn of_items(module: usize, items: &[Item]) -> Vec<Found<'_>> {
    let mut found = Vec::new();
    for item in items {
        if let Some(name) = item.kind.name() {
            found.push(Found {
                module,
                what: What::Item(item, name),
            });
        }
        if let ItemKind::Choice(choice) = &item.kind {
            let words = choice.words.iter().map(What::Name);
            found.extend(words.map(|what| Found { module, what }));
        }
    }
    found
}
