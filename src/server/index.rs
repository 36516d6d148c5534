//! Definitions by their names, from the syntax trees of a text, of the files that it uses and of the library. The trees
//! of texts with mistakes have the items that could be read.

use super::document::Document;
use crate::sources::Sources;
use eng_grammar::ast::{
    Binder, Declaration, Expr, ExprKind, File, Form, Function, Item, ItemKind, Kind, Name,
    Parameter, TypeExpr, TypeExprKind, UseNames,
};
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

/// The class that a value calls: `Revolute(a, b)`; for an analysis, `transient(Engine(), …)`, its model.
fn called(declaration: &Declaration) -> Option<&str> {
    let Form::Instance { value, .. } = &declaration.form else {
        return None;
    };
    let ExprKind::Call { callee, arguments } = &value.kind else {
        return None;
    };
    if declaration.kind == Kind::Analysis {
        return self::callee(&arguments.first()?.value);
    }
    word(callee)
}

/// The name that a call calls.
fn callee(value: &Expr) -> Option<&str> {
    match &value.kind {
        ExprKind::Call { callee, .. } => word(callee),
        _ => None,
    }
}

/// Whether a definition is a declaration of one of some kinds.
pub(super) fn is_kind(found: Found<'_>, kinds: &[Kind]) -> bool {
    let kind = found.item().map(|item| &item.kind);
    matches!(kind, Some(ItemKind::Declaration(declaration)) if kinds.contains(&declaration.kind))
}

fn word(value: &Expr) -> Option<&str> {
    match &value.kind {
        ExprKind::Name(name) => Some(name),
        _ => None,
    }
}

/// The name of a type, of its elements for an array.
fn type_name(ty: &TypeExpr) -> Option<&str> {
    match &ty.kind {
        TypeExprKind::Name(name) => Some(&name.text),
        TypeExprKind::Array(inner, _) => type_name(inner),
        _ => None,
    }
}

/// The members of a marker, with their meaning.
pub(super) const OF_MARKERS: [(&str, &str); 8] = [
    ("origin", "position of its origin"),
    ("x", "its first axis"),
    ("y", "its second axis"),
    ("z", "its third axis"),
    ("velocity", "velocity of its origin"),
    ("angular_velocity", "angular velocity"),
    ("acceleration", "acceleration of its origin"),
    ("angular_acceleration", "angular acceleration"),
];

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

    /// The definition of a path at a place of the document.
    pub fn resolve(&self, names: &[String], place: usize) -> Option<Found<'_>> {
        let (first, rest) = names.split_first()?;
        let first = self
            .in_scope(place)
            .into_iter()
            .find(|found| found.name().text == *first);
        let mut found = match first {
            Some(found) => found,
            None => return self.in_use(names, place),
        };
        for name in rest {
            found = self
                .members(found)
                .into_iter()
                .find(|member| member.name().text == *name)?;
        }
        Some(found)
    }

    /// The definition that the last name of a `use` means.
    fn in_use(&self, names: &[String], place: usize) -> Option<Found<'_>> {
        let (last, path) = names.split_last()?;
        if let Some(number) = self.numbered(&path.join(".")) {
            return self.look_up(number, last);
        }
        // a name in the braces of a `use`, or the name of an argument
        let module = self.module(self.own())?;
        let item = module
            .file
            .items
            .iter()
            .find(|item| holds(item.span, place))?;
        if let ItemKind::Use(item) = &item.kind {
            let path: Vec<&str> = item.path.iter().map(|name| name.text.as_str()).collect();
            return self.look_up(self.numbered(&path.join("."))?, last);
        }
        let callee = super::place::call_around(&module.text, place)?;
        let class = self.resolve(&callee.names, callee.start)?;
        let mut parameters = self.parameters(class).into_iter();
        parameters.find(|parameter| parameter.name().text == *last)
    }

    /// The definitions that a place of the document sees, the nearest first.
    pub fn in_scope(&self, place: usize) -> Vec<Found<'_>> {
        let mut found = self.locals(place);
        found.extend(self.visible(self.own()));
        found
    }

    /// The definitions of the blocks around a place of the document, the nearest first.
    pub fn locals(&self, place: usize) -> Vec<Found<'_>> {
        let number = self.own();
        let mut found = Vec::new();
        let items = self
            .module(number)
            .map_or(&[][..], |module| &module.file.items);
        let mut around: Vec<&Item> = Vec::new();
        let mut items = items;
        while let Some(item) = items.iter().find(|item| holds(item.span, place)) {
            around.push(item);
            items = item.kind.block().map_or(&[], |block| &block.items);
        }
        for item in around.into_iter().rev() {
            let inner: Vec<What<'_>> = match &item.kind {
                ItemKind::Declaration(declaration) => {
                    let binders = of_index(&declaration.index);
                    found.extend(self.inside(number, declaration));
                    // the block of a use sees the names of its class
                    let at_use = matches!(declaration.form, Form::Instance { .. });
                    let block = declaration.block();
                    if at_use && block.is_some_and(|block| holds(block.span, place)) {
                        found.extend(self.of_class(number, declaration));
                    }
                    binders
                }
                ItemKind::Function(function) => of_function(function),
                ItemKind::Table(table) => table.parameters.iter().map(What::Parameter).collect(),
                ItemKind::Binding(binding) => of_index(&binding.index),
                ItemKind::Report(report) => of_items(number, &report.block.items)
                    .into_iter()
                    .map(|f| f.what)
                    .collect(),
                _ => Vec::new(),
            };
            found.extend(inner.into_iter().map(|what| Found {
                module: number,
                what,
            }));
        }
        found
    }

    /// The class of a name that a module sees: a definition, or the one to which it gives some arguments.
    fn class(&self, number: usize, name: &str) -> Option<(usize, &Declaration)> {
        let mut at = self.look_up(number, name)?;
        for _ in 0..DEEPEST {
            let ItemKind::Declaration(declaration) = &at.item()?.kind else {
                return None;
            };
            match called(declaration) {
                Some(next) => at = self.look_up(at.module, next)?,
                None => return Some((at.module, declaration)),
            }
        }
        None
    }

    /// The definitions of the class that an instance uses; of an analysis, those of its model.
    fn of_class<'i>(&'i self, number: usize, declaration: &Declaration) -> Vec<Found<'i>> {
        let class = called(declaration).and_then(|name| self.class(number, name));
        class.map_or_else(Vec::new, |(module, class)| self.inside(module, class))
    }

    /// The definitions inside of a declaration: its parameters, its block, and those of its interfaces.
    fn inside<'i>(&'i self, number: usize, declaration: &'i Declaration) -> Vec<Found<'i>> {
        let mut found = Vec::new();
        let mut at = (number, declaration);
        for _ in 0..DEEPEST {
            let (number, declaration) = at;
            let interface = match &declaration.form {
                Form::Class {
                    parameters,
                    interface,
                    ..
                } => {
                    let parameters = parameters.iter().map(What::Parameter);
                    found.extend(parameters.map(|what| Found {
                        module: number,
                        what,
                    }));
                    interface.as_ref()
                }
                Form::Plain { interface, .. } => interface.as_ref(),
                Form::Instance { .. } => None,
            };
            if let Some(block) = declaration.block() {
                found.extend(of_items(number, &block.items));
            }
            let next = interface.and_then(|name| self.look_up(number, &name.text));
            match next {
                Some(Found {
                    module,
                    what: What::Item(item, _),
                }) => match &item.kind {
                    ItemKind::Declaration(declaration) => at = (module, declaration),
                    _ => break,
                },
                _ => break,
            }
        }
        found
    }

    /// The definitions after the dot of a definition.
    pub fn members<'i>(&'i self, found: Found<'i>) -> Vec<Found<'i>> {
        let module = found.module;
        let class = |name: &str| {
            let class = self.class(module, name);
            class.map_or_else(Vec::new, |(module, class)| self.inside(module, class))
        };
        let mut members = match found.what {
            What::Parameter(parameter) => type_name(&parameter.ty).map(class).unwrap_or_default(),
            What::Name(_) => Vec::new(),
            What::Item(item, _) => match &item.kind {
                ItemKind::Declaration(declaration) => match called(declaration) {
                    Some(_) => self.of_class(module, declaration),
                    None => self.inside(module, declaration),
                },
                ItemKind::Binding(binding) => {
                    // `const oil = Oil(…)` has no type in its text
                    let of_value = || binding.value.as_ref().and_then(callee);
                    let name = binding.ty.as_ref().and_then(type_name).or_else(of_value);
                    name.map(class).unwrap_or_default()
                }
                ItemKind::Choice(choice) => {
                    let words = choice.words.iter().map(What::Name);
                    words.map(|what| Found { module, what }).collect()
                }
                _ => Vec::new(),
            },
        };
        // the cycle of a model is read by the word `cycle`
        members.retain(|member| !is_kind(*member, &[Kind::Cycle]));
        members
    }

    /// Whether a definition has a reaction, `force` and `torque`: it is a joint or a drive.
    pub fn has_reaction(&self, found: Found<'_>) -> bool {
        is_kind(found, &[Kind::Joint, Kind::Drive])
    }

    /// Whether a definition is a marker, or a name for one.
    pub fn is_marker(&self, found: Found<'_>) -> bool {
        match found.what {
            What::Parameter(parameter) => type_name(&parameter.ty) == Some("Marker"),
            What::Name(_) => false,
            What::Item(item, _) => match &item.kind {
                ItemKind::Declaration(declaration) => declaration.kind == Kind::Marker,
                ItemKind::Binding(binding) => {
                    binding.ty.as_ref().and_then(type_name) == Some("Marker")
                }
                _ => false,
            },
        }
    }

    /// The parameters of a class, a model or a function.
    pub fn parameters<'i>(&'i self, found: Found<'i>) -> Vec<Found<'i>> {
        let mut found = found;
        // a function with some arguments of another one; a circle of them is a mistake
        for _ in 0..DEEPEST {
            let Some(ItemKind::Function(function)) = found.item().map(|item| &item.kind) else {
                break;
            };
            let name = function.value.as_ref().and_then(callee);
            let name = name.filter(|_| function.bound);
            match name.and_then(|name| self.look_up(found.module, name)) {
                Some(other) => found = other,
                None => break,
            }
        }
        let What::Item(item, _) = found.what else {
            return Vec::new();
        };
        match &item.kind {
            ItemKind::Function(function) => {
                let parameters = function.parameters.iter().map(What::Parameter);
                parameters
                    .map(|what| Found {
                        module: found.module,
                        what,
                    })
                    .collect()
            }
            ItemKind::Declaration(declaration) => {
                let bound = called(declaration).and_then(|name| self.class(found.module, name));
                let (module, class) = bound.unwrap_or((found.module, declaration));
                let mut inside = self.inside(module, class);
                inside.retain(|one| match one.what {
                    What::Parameter(_) => true,
                    What::Item(item, _) => is_parameter(item, class.kind),
                    What::Name(_) => false,
                });
                inside
            }
            _ => Vec::new(),
        }
    }
}

/// Whether an item in a block of a kind takes its value from an argument.
fn is_parameter(item: &Item, of: Kind) -> bool {
    use eng_grammar::ast::BindingKind;
    match &item.kind {
        ItemKind::Binding(binding) => match binding.kind {
            BindingKind::Param | BindingKind::Const | BindingKind::Input => true,
            BindingKind::Let => of == Kind::Record,
            _ => false,
        },
        _ => false,
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

fn holds(span: Span, place: usize) -> bool {
    (span.start as usize) <= place && place <= span.end as usize
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

fn of_index(index: &[Binder]) -> Vec<What<'_>> {
    let names = index.iter().map(|binder| &binder.name);
    names.map(What::Name).collect()
}

fn of_function(function: &Function) -> Vec<What<'_>> {
    let parameters = function.parameters.iter().map(What::Parameter);
    let lets = function
        .lets
        .iter()
        .map(|binding| What::Name(&binding.name));
    lets.chain(parameters).collect()
}
