//! Changes of the inside of a part: `part unit = Cylinder(…) with { shank.mass = 0.65 kg }`.

use super::Checker;
use super::body::ATTRIBUTES;
use super::class::item_place;
use super::mismatch::Due;
use super::scope::Scope;
use super::types::Type;
use crate::codes;
use crate::program::DefinitionId;
use crate::words::START_VALUES;
use eng_grammar::ast::{
    Declaration, Expr, ExprKind, IndexArgument, ItemKind, Kind, Name, Statement,
};
use eng_grammar::{Diagnostic, Span};

impl<'p> Checker<'p> {
    /// Checks the changes after `with`. Paths begin at the names of the class. Values are
    /// expressions of the text around.
    pub(super) fn changes(
        &mut self,
        scope: &Scope<'p>,
        declaration: &'p Declaration,
        class: DefinitionId,
    ) {
        let Some(changes) = &declaration.changes else {
            return;
        };
        if declaration.kind != Kind::Part {
            let word = super::describe::with_article(super::describe::kind_word(declaration.kind));
            return self.misplaced(
                changes.span,
                "`with`",
                &format!("at {word}"),
                "its numbers are its arguments; `with` changes numbers inside of a part",
            );
        }
        self.stated_once(&changes.items);
        let inside = Scope {
            at_use: Some(class),
            ..scope.clone()
        };
        for item in &changes.items {
            match &item.kind {
                ItemKind::Error => {}
                ItemKind::Attribute(change) => {
                    let ty = self.field_of_instance(class, &change.name, false);
                    self.changed = Some(class);
                    self.change(scope, &ty, &change.name, &change.value);
                    self.changed = None;
                }
                ItemKind::Statement(Statement::Change { target, value }) => {
                    self.changed_path(&inside, scope, target, value);
                }
                ItemKind::Statement(
                    Statement::Start { target, value } | Statement::Guess { target, value },
                ) => self.start(&inside, target, scope, value),
                _ => self.misplaced(
                    item_place(item),
                    "this",
                    "after `with`",
                    "it takes numbers by their paths (`rod.mass = 0.6 kg`), `start` and `guess`",
                ),
            }
        }
    }

    fn changed_path(&mut self, inside: &Scope<'p>, scope: &Scope<'p>, target: &Expr, value: &Expr) {
        if let Some(every) = every(target) {
            self.report(
                Diagnostic::error(codes::CHANGE, "each line after `with` changes one number")
                    .at(every, "this names several numbers")
                    .with_help(
                        "write a line for each: `rod[1].mass = 0.6 kg; rod[2].mass = 0.6 kg`",
                    ),
            );
            self.infer(scope, value);
            return;
        }
        if let Some((class, root)) = inside.at_use.zip(root(target))
            && self.owned_member(class, &root.text).is_none()
        {
            self.field_of_instance(class, &root, false);
            self.infer(scope, value);
            return;
        }
        if self.is_brought_along(inside, target) {
            self.infer(scope, value);
            return;
        }
        let ty = match &target.kind {
            ExprKind::Field { base, name } if ATTRIBUTES.contains(&name.text.as_str()) => {
                match self.infer(inside, base) {
                    Type::Body(_) => return self.attribute_of_a_body(scope, name, value),
                    Type::Error => Type::Error,
                    _ => self.infer(inside, target),
                }
            }
            ExprKind::Field { base, name } if START_VALUES.contains(&name.text.as_str()) => {
                if matches!(self.infer(inside, base), Type::Body(_)) {
                    let shown = self.sources.text(target.span).to_owned();
                    self.report(
                        Diagnostic::error(codes::CHANGE, format!("`{shown}` is a start value"))
                            .at(target.span, "no number of the part")
                            .with_help(format!("write `start {shown} = …`"))
                            .with_fix("make it a start value", start_of(target.span), "start "),
                    );
                    self.infer(scope, value);
                    return;
                }
                self.infer(inside, target)
            }
            _ => self.infer(inside, target),
        };
        let shown = Name {
            text: self.sources.text(target.span).to_owned(),
            span: target.span,
        };
        self.changed = match &target.kind {
            ExprKind::Field { base, .. } if !ty.is_error() => match self.infer(inside, base) {
                Type::Instance(id) | Type::InstanceOf(id) => Some(id),
                _ => inside.at_use,
            },
            _ => inside.at_use,
        };
        self.change(scope, &ty, &shown, value);
        self.changed = None;
    }

    /// Whether a path leads to numbers that a passed function, class or record has beyond its interface.
    /// Elaboration knows these numbers and their dimensions.
    fn is_brought_along(&mut self, inside: &Scope<'p>, path: &Expr) -> bool {
        match &path.kind {
            ExprKind::Index { base, .. } => self.is_brought_along(inside, base),
            ExprKind::Field { base, name } => {
                self.is_brought_along(inside, base)
                    || match self.infer(inside, base) {
                        Type::Function(_) => true,
                        // reported
                        Type::Error => true,
                        Type::InstanceOf(id) => self.owned_member(id, &name.text).is_none(),
                        _ => false,
                    }
            }
            _ => false,
        }
    }

    /// A value for a number inside of a part.
    fn change(&mut self, scope: &Scope<'p>, ty: &Type, shown: &Name, value: &Expr) {
        let known = match ty {
            Type::Error => {
                self.infer(scope, value);
                return;
            }
            Type::Scalar(_) | Type::Vector { .. } => true,
            Type::List { element, .. } => element.quantity().is_some(),
            _ => false,
        };
        if known {
            let due = Due::new(format!("`{}`", shown.text)).declared(shown.span, "changed here");
            self.expect(scope, value, ty, &due);
            return;
        }
        let found = self.describe(ty);
        self.report(
            Diagnostic::error(codes::CHANGE, "only numbers inside of a part can be changed")
                .at(shown.span, format!("this is {found}"))
                .with_help("classes, counts and words are arguments of the part: give its component a parameter for them"),
        );
        self.infer(scope, value);
    }
}

/// The first name of a path.
fn root(path: &Expr) -> Option<Name> {
    match &path.kind {
        ExprKind::Name(text) => Some(Name {
            text: text.clone(),
            span: path.span,
        }),
        ExprKind::Field { base, .. } | ExprKind::Index { base, .. } => root(base),
        _ => None,
    }
}

/// The place of the first `*` among the indices of a path.
fn every(path: &Expr) -> Option<Span> {
    match &path.kind {
        ExprKind::Field { base, .. } => every(base),
        ExprKind::Index { base, indices } => every(base).or_else(|| {
            indices.iter().find_map(|index| match index {
                IndexArgument::All(span) => Some(*span),
                IndexArgument::At(_) => None,
            })
        }),
        _ => None,
    }
}

/// The place before a text.
fn start_of(span: Span) -> Span {
    Span {
        end: span.start,
        ..span
    }
}
