//! The definitions that a place of the document sees, and the meaning of a path there.

use super::super::place::call_around;
use super::{Found, Index, What, of_items};
use eng_grammar::Span;
use eng_grammar::ast::{Binder, Form, Function, Item, ItemKind};

impl Index<'_> {
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
        let callee = call_around(&module.text, place)?;
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
}

fn holds(span: Span, place: usize) -> bool {
    (span.start as usize) <= place && place <= span.end as usize
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
