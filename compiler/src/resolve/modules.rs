//! Reading of files, in the order of their `use`s.

use super::PRELUDE;
use super::suggest::nearest;
use super::trees::Trees;
use crate::codes;
use crate::program::{Module, Offered, Program, is_library};
use eng_grammar::ast::{Form, Item, ItemKind, Kind, Use, UseNames};
use eng_grammar::{Diagnostic, Diagnostics, SourceMap, Span, UnitWords, parse_with_units};
use eng_system::host::{Host, HostError};
use std::collections::BTreeMap;

/// The target of a `use`: the path of a module, and whether the last segment belonged to the path.
pub(super) fn dotted(path: &[eng_grammar::ast::Name]) -> String {
    let names: Vec<&str> = path.iter().map(|name| name.text.as_str()).collect();
    names.join(".")
}

/// The path of a file's module: `inline4` for `inline4.eng`.
pub(super) fn path_of_file(file: &str) -> String {
    file.strip_suffix(".eng").unwrap_or(file).replace('/', ".")
}

/// Names that the library's modules define, from the beginnings of lines. This is cheap and good enough for a
/// hint.
pub(super) fn offered(library: &[(&str, &str)]) -> BTreeMap<String, Offered> {
    const WORDS: [&str; 10] = [
        "joint",
        "force",
        "journal",
        "drive",
        "component",
        "interface",
        "record",
        "choice",
        "const",
        "fn",
    ];
    let mut names = BTreeMap::new();
    for (path, text) in library {
        for line in text.lines() {
            let Some((word, rest)) = line.split_once(' ') else {
                continue;
            };
            let end = rest
                .find(|c: char| !(c.is_ascii_alphanumeric() || c == '_'))
                .unwrap_or(rest.len());
            if WORDS.contains(&word) && end > 0 {
                names
                    .entry(rest[..end].to_owned())
                    .or_insert_with(|| Offered {
                        module: (*path).to_owned(),
                        word: word.to_owned(),
                    });
            }
        }
    }
    names
}

/// What is wrong with a text that has a [`lone_return`].
pub const RETURN_ALONE: &str =
    "a line ends with a carriage return alone; lines end with LF or with CR LF";

/// The byte of the first carriage return without a line feed after it.
pub fn lone_return(text: &str) -> Option<usize> {
    let mut returns = text.match_indices('\r').map(|(at, _)| at);
    returns.find(|at| text.as_bytes().get(at + 1) != Some(&b'\n'))
}

/// Longest chain of files that use each other. A choice: the stack has room for this depth.
const DEEPEST_FILES: usize = 100;

struct Loader<'a> {
    host: &'a dyn Host,
    library: &'a [(&'a str, &'a str)],
    /// Trees of earlier readings.
    trees: Option<&'a mut Trees>,
    sources: &'a mut SourceMap,
    diagnostics: &'a mut Diagnostics,
    program: &'a mut Program,
    /// Modules being read, outermost first.
    open: Vec<String>,
    /// Unreadable modules, each reported once.
    missing: Vec<String>,
    /// The units of the modules read so far.
    units: &'a mut UnitWords,
    /// Those of the library alone.
    library_units: UnitWords,
}

/// Reads all modules. A word after a unit belongs to the unit if it is a unit itself. If the module of this second
/// unit is read later, which is rare, all modules are read once more.
pub(super) fn load(
    root: &str,
    host: &dyn Host,
    library: &[(&str, &str)],
    mut trees: Option<&mut Trees>,
    (sources, diagnostics, program): (&mut SourceMap, &mut Diagnostics, &mut Program),
) {
    let earlier = (sources.clone(), program.clone());
    let mut messages = Diagnostics::new();
    let mut units = UnitWords::default();
    read_all(
        root,
        host,
        library,
        trees.as_deref_mut(),
        (sources, &mut messages, program),
        &mut units,
    );
    if !units.unknown.is_disjoint(&units.known) {
        (*sources, *program) = earlier;
        messages = Diagnostics::new();
        read_all(
            root,
            host,
            library,
            trees,
            (sources, &mut messages, program),
            &mut units,
        );
    }
    diagnostics.extend(messages);
}

fn read_all(
    root: &str,
    host: &dyn Host,
    library: &[(&str, &str)],
    trees: Option<&mut Trees>,
    (sources, diagnostics, program): (&mut SourceMap, &mut Diagnostics, &mut Program),
    units: &mut UnitWords,
) {
    let mut loader = Loader {
        host,
        library,
        trees,
        sources,
        diagnostics,
        program,
        open: Vec::new(),
        missing: Vec::new(),
        units,
        library_units: UnitWords::default(),
    };
    if loader.text_of_library(PRELUDE).is_some() {
        loader.module(PRELUDE, None);
    }
    match host.read_text(root) {
        Ok(text) => {
            loader.text(&path_of_file(root), root, &text);
            loader.tell_empty(root);
        }
        Err(error) => loader.diagnostics.push(Diagnostic::error(
            codes::NO_MODULE,
            format!("the model cannot be read: {error}"),
        )),
    }
}

impl Loader<'_> {
    fn text_of_library(&self, path: &str) -> Option<&str> {
        self.library
            .iter()
            .find(|(name, _)| *name == path)
            .map(|(_, text)| *text)
    }

    /// Whether a module with this path exists, without reading it twice.
    fn exists(&self, path: &str) -> bool {
        path.split('.').all(|segment| !segment.is_empty())
            && (self.text_of_library(path).is_some()
                || self.program.modules.iter().any(|m| m.path == path)
                || (!is_library(path) && self.host.read_text(&file_of(path)).is_ok()))
    }

    fn module(&mut self, path: &str, used_at: Option<Span>) {
        if self.program.modules.iter().any(|m| m.path == path)
            || self.missing.iter().any(|m| m == path)
        {
            return;
        }
        if let Some(first) = self.open.iter().position(|open| open == path) {
            let mut circle: Vec<&str> = self.open[first..].iter().map(String::as_str).collect();
            circle.push(path);
            let mut message = Diagnostic::error(
                codes::USE_CIRCLE,
                format!("modules use each other in a circle: {}", circle.join(" → ")),
            );
            message = message.at_if(used_at, "this closes the circle");
            self.diagnostics.push(
                message.with_help("put the common definitions into a third file that uses neither"),
            );
            return;
        }
        if self.open.len() > DEEPEST_FILES {
            let mut message = Diagnostic::error(
                codes::NO_MODULE,
                format!("more than {DEEPEST_FILES} files use each other in a row"),
            );
            message = message.at_if(used_at, "not followed");
            self.diagnostics.push(message);
            return;
        }
        if let Some(text) = self.text_of_library(path).map(str::to_owned) {
            let name = file_of(path);
            self.text(path, &name, &text);
            return;
        }
        let found = if is_library(path) {
            Err(None)
        } else {
            self.host.read_text(&file_of(path)).map_err(Some)
        };
        match found {
            Ok(text) => self.text(path, &file_of(path), &text),
            Err(error) => {
                self.missing.push(path.to_owned());
                self.no_module(path, used_at, error.as_ref());
            }
        }
    }

    fn no_module(&mut self, path: &str, used_at: Option<Span>, error: Option<&HostError>) {
        let title = match error {
            None => format!("the library has no module `{path}`"),
            Some(HostError::NotFound(_)) => {
                format!("there is no module `{path}`: no file {}", file_of(path))
            }
            Some(error) => format!("the module `{path}` cannot be read: {error}"),
        };
        let mut message = Diagnostic::error(codes::NO_MODULE, title);
        if let Some(span) = used_at {
            message = message.at(span, "used here");
            let known = self
                .library
                .iter()
                .map(|(name, _)| *name)
                .filter(|name| *name != PRELUDE);
            if let Some(near) = nearest(path, known) {
                message = message.meant(span, near);
            } else if is_library(path) {
                let names = self.library.iter().map(|(name, _)| *name);
                let names: Vec<&str> = names.filter(|name| *name != PRELUDE).collect();
                message = message.with_note(format!(
                    "the library has {}",
                    super::suggest::listing(names, 30)
                ));
            }
        }
        self.diagnostics.push(message);
    }

    /// Tells that the root, which was read last, has no item.
    fn tell_empty(&mut self, root: &str) {
        let read = self.program.modules.last();
        if read.is_some_and(|module| module.file.items.is_empty()) && !self.diagnostics.has_errors()
        {
            self.diagnostics.push(
                Diagnostic::warning(codes::EMPTY_TEXT, format!("{root} has no item"))
                    .with_help("write a model, or get a first one by `eng new NAME`"),
            );
        }
    }

    fn text(&mut self, path: &str, file: &str, text: &str) {
        let source = self.sources.add(file, text);
        // with such line ends the first comment would go to the end of the text
        let text = match lone_return(text) {
            None => text,
            Some(at) => {
                let place = Span::new(source, at, at + 1);
                self.diagnostics.push(
                    Diagnostic::error(codes::RETURN_ALONE, RETURN_ALONE)
                        .at(place, "the first one")
                        .with_help("save the text with the line ends LF or CR LF"),
                );
                ""
            }
        };
        // the units of a user do not change the reading of the library's texts
        let mut tree = match (is_library(path), &mut self.trees) {
            (true, Some(trees)) => trees.read(
                path,
                text,
                source,
                &mut self.library_units,
                self.diagnostics,
            ),
            (true, None) => {
                parse_with_units(text, source, &mut self.library_units, self.diagnostics)
            }
            (false, _) => parse_with_units(text, source, self.units, self.diagnostics),
        };
        if is_library(path) {
            let known = &self.library_units.known;
            self.units.known.extend(known.iter().cloned());
        }
        self.open.push(path.to_owned());
        for item in &mut tree.items {
            if let ItemKind::Use(used) = &mut item.kind {
                self.settle(used);
                if !used.path.is_empty() {
                    let (path, span) = (dotted(&used.path), span_of(used));
                    self.module(&path, span);
                }
            }
        }
        let needed = [
            (super::WELD.0, tree.items.iter().any(has_support)),
            (super::JOURNAL_LAW.0, tree.items.iter().any(is_journal)),
        ];
        for (path, needed) in needed {
            if needed
                && self.text_of_library(path).is_some()
                && !self.open.iter().any(|p| p == path)
            {
                self.module(path, None);
            }
        }
        self.open.pop();
        self.program.modules.push(Module {
            path: path.to_owned(),
            source,
            file: tree,
            scope: BTreeMap::new(),
        });
    }

    /// `use oils` and `use std.units` name a module and take all of it: the tree has "item `units` of `std`"
    /// until the modules are known.
    fn settle(&self, used: &mut Use) {
        let UseNames::Some(names) = &used.names else {
            return;
        };
        let [last] = names.as_slice() else {
            return;
        };
        let base = dotted(&used.path);
        let whole = if base.is_empty() {
            last.text.clone()
        } else {
            format!("{base}.{}", last.text)
        };
        if base.is_empty() || (!self.exists(&base) && self.exists(&whole)) {
            let last = last.clone();
            used.path.push(last);
            used.names = UseNames::All;
        }
    }
}

/// Whether a model or component has a flexible body with supports.
fn has_support(item: &Item) -> bool {
    let ItemKind::Declaration(declaration) = &item.kind else {
        return false;
    };
    let (Form::Class { block, .. } | Form::Plain { block, .. }) = &declaration.form else {
        return false;
    };
    block.items.iter().any(|inner| match &inner.kind {
        ItemKind::Declaration(_) => has_support(inner),
        ItemKind::Attribute(a) => declaration.kind == Kind::Flexible && a.name.text == "support",
        _ => false,
    })
}

/// Whether an item defines a class of journals.
fn is_journal(item: &Item) -> bool {
    matches!(&item.kind, ItemKind::Declaration(d)
        if d.kind == Kind::Journal && matches!(d.form, Form::Class { .. }))
}

fn file_of(path: &str) -> String {
    format!("{}.eng", path.replace('.', "/"))
}

/// The place of a path.
pub(super) fn span_of(used: &Use) -> Option<Span> {
    let first = used.path.first()?;
    let last = used.path.last()?;
    Some(first.span.to(last.span))
}
