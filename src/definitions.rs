//! Definitions in words: the text of an item of a file or of the library, by its name.

use eng_compiler::library::LIBRARY;
use eng_grammar::ast::{BindingKind, File, Form, Item, ItemKind, Kind};
use eng_grammar::{Diagnostics, SourceMap, parse};
use std::fmt::Write;

/// The text about a definition of the library: `Revolute`, `std.joints.Revolute`, `mm`, `Length`.
pub(crate) fn of_library(path: &str) -> Option<String> {
    let mut texts = SourceMap::new();
    let mut unread = Diagnostics::new();
    let files: Vec<(&str, File)> = LIBRARY
        .iter()
        .map(|(module, text)| {
            let name = format!("{}.eng", module.replace('.', "/"));
            let source = texts.add(name, *text);
            (*module, parse(text, source, &mut unread))
        })
        .collect();
    let modules = files.iter().map(|(module, file)| (*module, file));
    of_modules(modules, path, &texts)
}

/// The text about a definition of some modules: their paths and trees, those that are looked at first before others.
/// The name may have the path of its module before it, or that of the definition around it: `Engine.stroke`.
pub(crate) fn of_modules<'a>(
    modules: impl Iterator<Item = (&'a str, &'a File)>,
    path: &str,
    texts: &SourceMap,
) -> Option<String> {
    let modules: Vec<(&str, &File)> = modules.collect();
    let path = path.split('[').next().unwrap_or_default();
    let (around, name) = path.rsplit_once('.').unwrap_or(("", path));
    let items = |(_, file): &(&'a str, &'a File)| file.items.iter();
    let found = match around {
        "" => {
            let top = || modules.iter().flat_map(items);
            let named = top().find(|item| is_called(item, name));
            named
                .or_else(|| top().find(|item| has_word(item, name)))
                .or_else(|| {
                    top()
                        .filter(|item| is_model(item))
                        .find_map(|item| inside(item, name))
                })
        }
        _ => {
            let of_module = modules.iter().filter(|(module, _)| *module == around);
            let named = of_module.flat_map(items).find(|item| is_called(item, name));
            named.or_else(|| {
                let mut holders = modules.iter().flat_map(items);
                inside(holders.find(|item| is_called(item, around))?, name)
            })
        }
    };
    let item = found?;
    let module = modules.iter().find(|(_, file)| {
        file.span.source == item.span.source && file.span.start <= item.span.start
    });
    let of = module.filter(|(module, _)| module.starts_with("std."));
    let of = of.map_or(String::new(), |(module, _)| format!(" of `{module}`"));
    Some(text(path, &of, item, texts))
}

/// Names of the definitions of a file.
pub(crate) fn names(file: &File) -> impl Iterator<Item = &str> {
    file.items
        .iter()
        .filter_map(|item| Some(item.kind.name()?.text.as_str()))
}

fn is_called(item: &Item, name: &str) -> bool {
    let own = match &item.kind {
        ItemKind::Attribute(attribute) => Some(&attribute.name),
        other => other.name(),
    };
    own.is_some_and(|own| own.text == name)
}

/// Whether an item is a choice with this word.
fn has_word(item: &Item, name: &str) -> bool {
    matches!(&item.kind, ItemKind::Choice(choice) if choice.words.iter().any(|word| word.text == name))
}

fn is_model(item: &Item) -> bool {
    matches!(&item.kind, ItemKind::Declaration(declaration) if declaration.kind == Kind::Model)
}

/// An item in the block of a definition. A cycle is found by the word `cycle`, too.
fn inside<'a>(item: &'a Item, name: &str) -> Option<&'a Item> {
    let mut items = item.kind.block()?.items.iter();
    items.find(|item| {
        let cycle = matches!(&item.kind, ItemKind::Declaration(d) if d.kind == Kind::Cycle);
        is_called(item, name) || (cycle && name == "cycle")
    })
}

/// What an item is: `a joint`, `a unit`.
fn is(item: &Item) -> &'static str {
    match &item.kind {
        ItemKind::Dimension(_) => "a dimension",
        ItemKind::Unit(_) => "a unit",
        ItemKind::Choice(_) => "a choice",
        ItemKind::Function(_) => "a function",
        ItemKind::Table(_) => "a table",
        ItemKind::Report(_) => "a report",
        ItemKind::Binding(binding) => match binding.kind {
            BindingKind::Const => "a constant",
            BindingKind::Param => "a parameter",
            BindingKind::Input => "an input",
            BindingKind::Let => "a value",
            BindingKind::State => "a state",
            BindingKind::Field => "a field",
            BindingKind::Output => "an output",
        },
        ItemKind::Declaration(declaration) => match declaration.kind {
            Kind::Joint => "a joint",
            Kind::Force => "a force",
            Kind::Journal => "a journal",
            Kind::Drive => "a drive",
            Kind::Component => "a component",
            Kind::Interface => "an interface",
            Kind::Record => "a record",
            Kind::Model => "a model",
            Kind::Analysis => "an analysis",
            Kind::Cycle => "the cycle of the model",
            Kind::Flexible | Kind::Body => "a body",
            Kind::Marker => "a marker",
            Kind::Part => "a part",
            Kind::Default => "a reserved word",
        },
        ItemKind::Entry(_) => "an entry of a report",
        _ => "an attribute of the model",
    }
}

fn text(path: &str, of: &str, item: &Item, texts: &SourceMap) -> String {
    let place = texts.line_column(item.span.source, item.span.start);
    let file = texts
        .get(item.span.source)
        .map_or("", |source| &source.name);
    let line = place.map_or(0, |(line, _)| line);
    let mut text = format!("{path}: {}{of}, stated at {file}:{line}\n", is(item));
    for line in &item.docs {
        let _ = writeln!(text, "    {}", format!("/// {line}").trim_end());
    }
    for line in texts.text(item.span).lines() {
        let _ = writeln!(text, "    {line}");
    }
    if let ItemKind::Declaration(declaration) = &item.kind
        && let Form::Instance { value, .. } = &declaration.form
        && declaration.kind == Kind::Analysis
    {
        let call = texts.text(value.span);
        let kind = call.split('(').next().unwrap_or_default();
        if let Some(row) = eng_system::analysis::kind(kind) {
            let _ = writeln!(
                text,
                "  `{kind}` computes {}; `eng explain {kind}` lists its arguments",
                row.about
            );
        }
    }
    text
}
