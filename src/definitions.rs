//! Definitions in words: the text of an item of a file or of the library, by its name.

use crate::indexed::base;
use eng_compiler::library::LIBRARY;
use eng_grammar::ast::{BindingKind, Expr, ExprKind, File, Form, Item, ItemKind, Kind, Statement};
use eng_grammar::{Diagnostics, SourceMap, parse};
use std::fmt::Write;

/// The text about a definition of the library: `Revolute`, `std.joints.Revolute`, `mm`, `Length`.
pub(crate) fn of_library(path: &str) -> Option<String> {
    with_library(|files, texts| of_modules(files.iter().map(|(m, f)| (*m, f)), path, texts))
}

/// Reads the library and looks something up in it.
fn with_library<T>(look: impl FnOnce(&[(&'static str, File)], &SourceMap) -> T) -> T {
    let mut texts = SourceMap::new();
    let mut unread = Diagnostics::new();
    let files: Vec<(&'static str, File)> = LIBRARY
        .iter()
        .map(|(module, text)| {
            let name = format!("{}.eng", module.replace('.', "/"));
            let source = texts.add(name, *text);
            (*module, parse(text, source, &mut unread))
        })
        .collect();
    look(&files, &texts)
}

/// The text about a definition of some modules: their paths and trees, in the order of the search. The name may have the path
/// of its module before it, or that of the definition around it: `Engine.stroke`.
pub(crate) fn of_modules<'a>(
    modules: impl Iterator<Item = (&'a str, &'a File)>,
    path: &str,
    texts: &SourceMap,
) -> Option<String> {
    let modules: Vec<(&str, &File)> = modules.collect();
    if let Some((module, file)) = modules.iter().find(|(module, _)| *module == path) {
        return Some(contents(module, file));
    }
    let mut trail = match path.contains('.') {
        true => along(&modules, path).unwrap_or_default(),
        false => Vec::new(),
    };
    let (path, item) = match trail.pop() {
        Some((_, item)) => (path, item),
        None => {
            // `pulley[2]` is `pulley`; `pulley[2].brush` is not
            let path = match path.contains('.') {
                true => path,
                false => base(path),
            };
            (path, by_name(&modules, path)?)
        }
    };
    let module = modules.iter().find(|(_, file)| {
        file.span.source == item.span.source && file.span.start <= item.span.start
    });
    let of = module.filter(|(module, _)| module.starts_with("std."));
    let of = of.map_or(String::new(), |(module, _)| format!(" of `{module}`"));
    Some(text((path, &of), item, &trail, texts))
}

/// An item by its name, after the path of its module or the name of the definition around it.
fn by_name<'a>(modules: &[(&'a str, &'a File)], path: &str) -> Option<&'a Item> {
    let (around, name) = path.rsplit_once('.').unwrap_or(("", path));
    let items = |(_, file): &(&'a str, &'a File)| file.items.iter();
    match around {
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
                let mut all = modules.iter().flat_map(items);
                let holder = all.find(|item| is_called(item, around))?;
                in_definition(modules, holder, name)
            })
        }
    }
}

/// The items on a path in a model, each with the path up to it: `rear` and `rear.pin` of
/// `part rear if tandem = Axle()`. The text alone decides, so items that a condition leaves out are among
/// them.
fn along<'a>(modules: &[(&'a str, &'a File)], path: &str) -> Option<Vec<(String, &'a Item)>> {
    let items = modules.iter().flat_map(|(_, file)| file.items.iter());
    let mut models = items.filter(|item| is_model(item));
    models.find_map(|model| {
        let mut around = model;
        let mut trail: Vec<(String, &Item)> = Vec::new();
        for part in path.split('.') {
            around = in_definition(modules, around, base(part))?;
            let so_far = match trail.last() {
                Some((before, _)) => format!("{before}.{part}"),
                None => part.to_owned(),
            };
            trail.push((so_far, around));
        }
        Some(trail)
    })
}

/// Most definitions above an item; a circle of them is a mistake that the checker reports. The number is a
/// choice.
const MOST_LEVELS: usize = 8;

/// An item of a definition or of a use: in its own block, in that of its class, or in that of an interface.
fn in_definition<'a>(
    modules: &[(&'a str, &'a File)],
    holder: &'a Item,
    name: &str,
) -> Option<&'a Item> {
    let levels = std::iter::successors(Some(holder), |level| {
        let above = above(level)?;
        let mut all = modules.iter().flat_map(|(_, file)| file.items.iter());
        all.find(|item| is_called(item, above))
    });
    let mut levels = levels.take(MOST_LEVELS);
    levels.find_map(|level| inside(level, name))
}

/// The name of the class of a use, or that of the interface of a definition.
fn above(item: &Item) -> Option<&str> {
    let ItemKind::Declaration(declaration) = &item.kind else {
        return None;
    };
    match &declaration.form {
        Form::Class { interface, .. } | Form::Plain { interface, .. } => {
            interface.as_ref().map(|name| name.text.as_str())
        }
        Form::Instance { value, .. } => class_name(value),
    }
}

/// The name of the class in `Axle`, `Axle(…)` and `parts.Axle(…)`.
fn class_name(value: &Expr) -> Option<&str> {
    match &value.kind {
        ExprKind::Call { callee, .. } => class_name(callee),
        ExprKind::Name(name) => Some(name),
        ExprKind::Field { name, .. } => Some(&name.text),
        _ => None,
    }
}

/// The condition of `joint pin if driven = …`.
fn condition(item: &Item) -> Option<&Expr> {
    match &item.kind {
        ItemKind::Declaration(declaration) => declaration.condition.as_ref(),
        _ => None,
    }
}

/// The names that a module defines, with the first sentences of their comments.
fn contents(module: &str, file: &File) -> String {
    let mut text = format!("{module}: a module of the library\n");
    for line in &file.docs {
        let _ = writeln!(text, "    {}", format!("//! {}", line.trim()).trim_end());
    }
    let mut table = crate::tables::Table::new(&[&["name", "is", "about"]]);
    for item in &file.items {
        let Some(name) = item.kind.name() else {
            continue;
        };
        let about = item.docs.first().map_or("", |line| line.trim());
        table.row(vec![
            name.text.clone(),
            is(item).to_owned(),
            about.to_owned(),
        ]);
    }
    let _ = write!(text, "\n{}", table.render_left(1));
    text
}

/// The lints of a name that classes of the library and of a program state, with the classes and the places.
pub(crate) fn lints<'a>(
    modules: impl Iterator<Item = (&'a str, &'a File)>,
    name: &str,
    texts: &SourceMap,
) -> Option<String> {
    let mut text = String::new();
    for item in modules.flat_map(|(_, file)| &file.items) {
        let (Some(class), Some(block)) = (item.kind.name(), item.kind.block()) else {
            continue;
        };
        for inner in &block.items {
            let ItemKind::Statement(Statement::Require {
                name: Some(own), ..
            }) = &inner.kind
            else {
                continue;
            };
            if own.text != name {
                continue;
            }
            let line = texts.line_column(inner.span.source, inner.span.start);
            let file = texts.get(inner.span.source);
            let _ = writeln!(
                text,
                "{name}: a lint of `{}`, stated at {}:{}",
                class.text,
                file.map_or("", |source| source.name.as_str()),
                line.map_or(0, |(line, _)| line)
            );
            for line in texts.text(inner.span).lines() {
                let _ = writeln!(text, "    {line}");
            }
        }
    }
    (!text.is_empty()).then_some(text)
}

/// The lints of the library with a name.
pub(crate) fn lints_of_library(name: &str) -> Option<String> {
    with_library(|files, texts| lints(files.iter().map(|(m, f)| (*m, f)), name, texts))
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

/// The text about an item with a path, of a module. `around` are the items on its path.
fn text(
    (path, of): (&str, &str),
    item: &Item,
    around: &[(String, &Item)],
    texts: &SourceMap,
) -> String {
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
    let own = [("it", item)];
    let around = around.iter().map(|(path, item)| (path.as_str(), *item));
    for (name, item) in around.chain(own) {
        if let Some(condition) = condition(item) {
            let condition = texts.text(condition.span);
            let _ = writeln!(text, "  {name} exists only where `{condition}` holds");
        }
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
