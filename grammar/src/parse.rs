//! Entry points of this crate: parsing a file, an expression, a place in a message.

use crate::ast::{Expr, File, Item, ItemKind, UnitExpr};
use crate::build::{Builder, diagnose, items::doc_text};
use crate::codes;
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::grammar::{EngGrammar, Rule};
use crate::span::SourceId;
use pest::Parser;
use pest::iterators::{Pair, Pairs};
use std::collections::BTreeSet;

/// Reads a file. It always returns a tree. Unreadable text is [`ItemKind::Error`] in it, with a message.
///
/// ```
/// use eng_grammar::{Diagnostics, SourceMap, parse};
///
/// let mut sources = SourceMap::new();
/// let mut diagnostics = Diagnostics::new();
/// let id = sources.add("bore.eng", "param bore = 86 mm\nlet area = pi/4*bore^");
/// let file = parse(&sources.get(id).unwrap().text, id, &mut diagnostics);
/// assert_eq!(file.items.len(), 2);
/// assert_eq!(diagnostics.iter().next().unwrap().title, "expected a value after `^`");
/// ```
///
/// Every word after a number counts as a unit here; [`parse_with_units`] knows the units of a program.
pub fn parse(text: &str, source: SourceId, diagnostics: &mut Diagnostics) -> File {
    read(text, source, None, diagnostics)
}

/// The words that are units of a program.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct UnitWords {
    /// The names of all units that were read.
    pub known: BTreeSet<String>,
    /// The words among the factors after numbers that were no known units.
    pub unknown: BTreeSet<String>,
}

/// Reads a file like [`parse`]. A word that is no unit ends the unit before it: `2e6 N/m*depth` is 2e6 N/m
/// times `depth`. The units that the file defines are added to the known ones first, and words that are not
/// units are noted.
pub fn parse_with_units(
    text: &str,
    source: SourceId,
    units: &mut UnitWords,
    diagnostics: &mut Diagnostics,
) -> File {
    read(text, source, Some(units), diagnostics)
}

fn read(
    text: &str,
    source: SourceId,
    units: Option<&mut UnitWords>,
    diagnostics: &mut Diagnostics,
) -> File {
    let mut builder = Builder::new(text, source, 0, diagnostics);
    let whole = builder.span(0, text.len());
    let unread = |docs: Vec<String>| File {
        docs,
        items: vec![Item {
            docs: Vec::new(),
            span: whole,
            kind: ItemKind::Error,
        }],
        span: whole,
    };
    if let Some(diagnostic) = diagnose::nesting(&builder) {
        builder.report(diagnostic);
        return unread(Vec::new());
    }
    let pairs = match EngGrammar::parse(Rule::file, text) {
        Ok(pairs) => pairs,
        // the rule `file` accepts any text, so only the limit of the stack can cause an error
        Err(_) => {
            builder.report(
                Diagnostic::error(codes::NESTED, "this file is nested too deep to be read")
                    .at(whole, "somewhere in here")
                    .with_help("name parts of long expressions with `let`"),
            );
            return unread(Vec::new());
        }
    };
    let (known, unknown) = match units {
        Some(UnitWords { known, unknown }) => {
            known.extend(defined_units(pairs.clone()));
            (Some(&*known), Some(unknown))
        }
        None => (None, None),
    };
    let is_unit = known.map(|known| move |word: &str| known.contains(word));
    builder.is_unit = is_unit
        .as_ref()
        .map(|is_unit| is_unit as &dyn Fn(&str) -> bool);
    diagnose::braces(&mut builder);
    let mut file = File {
        docs: Vec::new(),
        items: Vec::new(),
        span: whole,
    };
    for pair in pairs {
        let inner = pair.into_inner();
        file.docs = inner
            .clone()
            .filter(|part| part.as_rule() == Rule::file_doc)
            .map(|part| doc_text(part.as_str()))
            .collect();
        file.items = builder.items(inner, 0);
    }
    if let Some(unknown) = unknown {
        unknown.append(&mut builder.unknown_units);
    }
    file
}

/// The names of the units that a file defines.
fn defined_units<'t>(file: Pairs<'t, Rule>) -> impl Iterator<Item = String> + 't {
    file.flat_map(Pair::into_inner)
        .filter(|item| item.as_rule() == Rule::item)
        .flat_map(Pair::into_inner)
        .filter(|item| item.as_rule() == Rule::unit_item)
        .flat_map(Pair::into_inner)
        .filter(|part| part.as_rule() == Rule::unit_def_name)
        .map(|name| name.as_str().to_owned())
}

/// Reads one expression, which begins at byte `offset` of `source`.
pub fn parse_expression(
    text: &str,
    source: SourceId,
    offset: usize,
    diagnostics: &mut Diagnostics,
) -> Option<Expr> {
    let rule = Rule::single_expression;
    expression(text, source, offset, None, diagnostics, rule).map(|(value, _)| value)
}

/// Reads `expression as unit`, or an expression alone: the contents of braces in a message. `is_unit` ends units as
/// [`parse_with_units`] does.
pub fn parse_placeholder(
    text: &str,
    source: SourceId,
    offset: usize,
    is_unit: Option<&dyn Fn(&str) -> bool>,
    diagnostics: &mut Diagnostics,
) -> Option<(Expr, Option<UnitExpr>)> {
    expression(
        text,
        source,
        offset,
        is_unit,
        diagnostics,
        Rule::placeholder,
    )
}

fn expression(
    text: &str,
    source: SourceId,
    offset: usize,
    is_unit: Option<&dyn Fn(&str) -> bool>,
    diagnostics: &mut Diagnostics,
    rule: Rule,
) -> Option<(Expr, Option<UnitExpr>)> {
    let mut builder = Builder::new(text, source, offset, diagnostics);
    builder.is_unit = is_unit;
    if let Some(diagnostic) = diagnose::nesting(&builder) {
        builder.report(diagnostic);
        return None;
    }
    let pairs = match EngGrammar::parse(rule, text) {
        Ok(pairs) => pairs,
        Err(_) => {
            let diagnostic = diagnose::expression(&builder, rule);
            builder.report(diagnostic);
            return None;
        }
    };
    let mut value = None;
    let mut unit = None;
    for part in pairs.flat_map(|pair| pair.into_inner()) {
        match part.as_rule() {
            Rule::expression => value = Some(builder.expression(part, 0)),
            Rule::display_unit => unit = Some(builder.unit(part, 0)),
            _ => {}
        }
    }
    value.map(|value| (value, unit))
}
