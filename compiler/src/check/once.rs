//! Start values and places that a block states twice.

use super::Checker;
use crate::codes;
use eng_grammar::ast::{Expr, Item, ItemKind, Kind, Statement};
use eng_grammar::{Diagnostic, Span};
use std::collections::BTreeMap;

impl Checker<'_> {
    /// Refuses a second start value, guess or place of the same thing in a block. A body without an index states
    /// `position`, and the block around it `bob.position`: both are one thing.
    pub(super) fn stated_once(&mut self, items: &[Item]) {
        let mut first: BTreeMap<(&str, String), Span> = BTreeMap::new();
        self.once(items, "", &mut first);
    }

    fn once<'a>(
        &mut self,
        items: &'a [Item],
        body: &str,
        first: &mut BTreeMap<(&'a str, String), Span>,
    ) {
        for item in items {
            let (word, target, of) = match &item.kind {
                ItemKind::Statement(Statement::Start { target, .. }) => {
                    ("start", target, self.written(target))
                }
                ItemKind::Statement(Statement::Guess { target, .. }) => {
                    ("guess", target, self.written(target))
                }
                ItemKind::Statement(Statement::Place { moving, on, .. }) => {
                    let both = format!("{} on {}", self.written(moving), self.written(on));
                    ("place", moving, both)
                }
                ItemKind::Declaration(declaration)
                    if matches!(declaration.kind, Kind::Body | Kind::Flexible) =>
                {
                    let items = declaration.block().map_or(&[][..], |block| &block.items);
                    match declaration.index.is_empty() {
                        true => self.once(items, &declaration.name.text, first),
                        false => self.stated_once(items),
                    }
                    continue;
                }
                _ => continue,
            };
            let path = match body {
                "" => of,
                body => format!("{body}.{of}"),
            };
            if let Some(earlier) = first.get(&(word, path.clone())) {
                let (earlier, again) = match earlier.start < target.span.start {
                    true => (*earlier, target.span),
                    false => (target.span, *earlier),
                };
                self.report(
                    Diagnostic::error(
                        codes::DEFINED_TWICE,
                        format!("`{word} {path}` is stated twice"),
                    )
                    .at(again, "again here")
                    .also(earlier, "first here")
                    .with_help("keep one of them"),
                );
            } else {
                first.insert((word, path), target.span);
            }
        }
    }

    /// An expression as the text has it, without blanks.
    fn written(&self, expr: &Expr) -> String {
        let text = self.sources.text(expr.span);
        text.chars().filter(|c| !c.is_whitespace()).collect()
    }
}
