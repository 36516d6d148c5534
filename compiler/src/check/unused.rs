//! Warnings about names that are taken with `use` or defined, but not used.

use super::Checker;
use crate::codes;
use crate::program::DefinitionId;
use crate::resolve::PRELUDE;
use eng_grammar::Diagnostic;
use eng_grammar::ast::{BindingKind, ItemKind, Kind, UseNames};

pub(super) fn warn(checker: &mut Checker<'_>) {
    let program = checker.program;
    for (index, module) in program.modules.iter().enumerate() {
        // The library serves many programs, so an unused name in it is no mistake.
        if module.path == PRELUDE || module.path.starts_with("std.") {
            continue;
        }
        let module_index = index as u32;
        for (item_index, item) in module.file.items.iter().enumerate() {
            match &item.kind {
                ItemKind::Use(used) => unused_use(checker, module_index, item.span, used),
                ItemKind::Declaration(declaration)
                    if !matches!(declaration.kind, Kind::Record | Kind::Analysis) =>
                {
                    let id = DefinitionId {
                        module: module_index,
                        item: item_index as u32,
                    };
                    for inner in declaration.block().into_iter().flat_map(|b| &b.items) {
                        if let ItemKind::Binding(binding) = &inner.kind
                            && should_be_read(declaration.kind, binding.kind)
                            && !checker.used.contains(&(id, binding.name.text.clone()))
                        {
                            checker.report(
                                Diagnostic::warning(
                                    codes::UNUSED_LET,
                                    format!("`{}` is not used", binding.name.text),
                                )
                                .at(binding.name.span, "named, but never read")
                                .with_help(match binding.kind {
                                    BindingKind::Let | BindingKind::Field => {
                                        "remove it, or show it by an `output`"
                                    }
                                    _ => "its value has no effect: remove it, or use its name",
                                }),
                            );
                        }
                    }
                }
                _ => {}
            }
        }
    }
}

/// Whether a value has no effect if nothing in the text reads it. A class may repeat a parameter of its interface.
fn should_be_read(holder: Kind, binding: BindingKind) -> bool {
    match binding {
        BindingKind::Let | BindingKind::Field => true,
        BindingKind::Const | BindingKind::Param | BindingKind::Input => {
            matches!(holder, Kind::Model | Kind::Component)
        }
        BindingKind::State | BindingKind::Output => false,
    }
}

fn unused_use(
    checker: &mut Checker<'_>,
    module: u32,
    span: eng_grammar::Span,
    used: &eng_grammar::ast::Use,
) {
    let program = checker.program;
    let names: Vec<&str> = used.path.iter().map(|name| name.text.as_str()).collect();
    let path = names.join(".");
    let Some(from) = program.modules.iter().position(|m| m.path == path) else {
        return;
    };
    let reads_unit = |checker: &Checker<'_>, wanted: Option<&str>| {
        program.modules[from].file.items.iter().any(|item| {
            matches!(&item.kind, ItemKind::Unit(unit)
                if wanted.is_none_or(|wanted| wanted == unit.name.text)
                    && checker.used_units.contains(&(module, unit.name.text.clone())))
        })
    };
    match &used.names {
        UseNames::All => {
            let read = checker
                .used_top
                .iter()
                .any(|(reader, id)| *reader == module && id.module == from as u32);
            if !read && !reads_unit(checker, None) {
                checker.report(
                    Diagnostic::warning(codes::UNUSED_USE, format!("nothing of `{path}` is used"))
                        .at(span, "taken, but never read")
                        .with_help("remove the line"),
                );
            }
        }
        UseNames::Some(names) => {
            for name in names {
                let Some(id) = program.lookup(module, &name.text) else {
                    continue;
                };
                if id.module == from as u32
                    && !checker.used_top.contains(&(module, id))
                    && !reads_unit(checker, Some(&name.text))
                {
                    checker.report(
                        Diagnostic::warning(
                            codes::UNUSED_USE,
                            format!("`{}` is not used", name.text),
                        )
                        .at(name.span, format!("taken from `{path}`, but never read"))
                        .with_help("remove the name"),
                    );
                }
            }
        }
    }
}
