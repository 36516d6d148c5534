//! Checks reports: figures and values of the channels that runs record.
//!
//! The check comes after the elaboration of all models. So a report can name every recorded channel with its
//! indices, and no other. Lists are expanded here, so later stages get single channels.
//!
//! This module contains names, types and constants. It must not contain results.

mod axes;
mod channel;
mod function;
mod gradient;
mod picture;
mod recorded;
mod settings;
mod value;

use super::Checker;
use super::scope::{Scope, value_circle};
use super::signal::Shape;
use super::types::Quantity;
use crate::codes;
use crate::elaborate::{AnalysisPlan, Constants, location};
use crate::models::SharedModels;
use crate::typed::TypedProgram;
use eng_grammar::ast::{self, BindingKind, Expr, ItemKind, Statement};
use eng_grammar::{Diagnostic, Diagnostics, MessagePart, SourceMap, Span, parse_message};
use eng_system::DisplayUnit;
use eng_system::host::Host;
use eng_system::report as plan;
use recorded::Models;
use std::collections::BTreeMap;
use value::Typed;

/// The reports of the root module. Reports with a mistake are left out, with messages.
pub fn reports(
    typed: &TypedProgram,
    sources: &SourceMap,
    host: &dyn Host,
    plans: &[AnalysisPlan],
    models: &SharedModels,
    diagnostics: &mut Diagnostics,
) -> Vec<plan::Report> {
    let program = &typed.program;
    let root = program.modules.get(program.root() as usize);
    let items = root.map_or(&[][..], |module| &module.file.items);
    let written: Vec<(&[String], &ast::Report)> = items
        .iter()
        .filter_map(|item| match &item.kind {
            ItemKind::Report(report) => Some((item.docs.as_slice(), report)),
            _ => None,
        })
        .collect();
    if written.is_empty() {
        return Vec::new();
    }
    let mut texts = sources.clone();
    let mut of_constants = Diagnostics::new();
    let mut made = Vec::new();
    let mut messages = Diagnostics::new();
    if let Some(constants) = Constants::new(typed, &mut texts, host, &mut of_constants) {
        let mut reporter = Reporter {
            checker: Checker::new(program, sources),
            constants,
            models: Models::new(typed, models, sources, host, plans),
            scope: Scope::top(program.root()),
            names: BTreeMap::new(),
        };
        for (docs, report) in written {
            let span = report.name.span;
            if let Some(report) = reporter.report(docs, report) {
                if report.entries.iter().all(|e| e.analyses().is_empty()) {
                    let idle = |title| Diagnostic::warning(codes::REPORT_IDLE, title);
                    let message = match report.entries.is_empty() {
                        true => idle(format!("the report `{}` shows nothing", report.name))
                            .at(span, "it has neither a figure nor a value nor a condition")
                            .with_help("a `let` only names; write `value` to show it"),
                        false => idle(format!("the report `{}` names no analysis", report.name))
                            .at(span, "no entry uses results")
                            .with_help(
                                "name channels after their analysis: `unfired.main[1].force.x`",
                            ),
                    };
                    reporter.diagnose(message);
                }
                made.push(report);
            }
        }
        messages.extend(reporter.models.messages());
        messages.extend(reporter.checker.diagnostics);
    }
    diagnostics.extend(of_constants);
    diagnostics.extend(super::in_order_of_place(&messages));
    made
}

/// A name of a report.
#[derive(Clone)]
enum Named<'a> {
    /// Not evaluated before its first use.
    Lazy(&'a Expr),
    /// Being evaluated.
    Busy,
    /// Its value; `None` after a message.
    Done(Option<Typed>),
}

/// The state of checking reports.
struct Reporter<'a, 'd> {
    checker: Checker<'a>,
    constants: Constants<'a, 'd>,
    models: Models<'a>,
    scope: Scope<'a>,
    /// `let`s and values of the present report.
    names: BTreeMap<&'a str, (Span, Named<'a>)>,
}

impl<'a> Reporter<'a, '_> {
    fn diagnose(&mut self, diagnostic: Diagnostic) {
        self.checker.report(diagnostic);
    }

    fn report(&mut self, docs: &[String], report: &'a ast::Report) -> Option<plan::Report> {
        self.names.clear();
        let mut entries: Vec<(&'a ast::Item, &'a str, Span)> = Vec::new();
        let mut whole = true;
        for item in &report.block.items {
            let (name, value) = match &item.kind {
                ItemKind::Statement(Statement::Require { index, .. }) => {
                    if let Some(binder) = index.first() {
                        whole = false;
                        self.checker.misplaced(
                            binder.name.span,
                            "an index",
                            "at a condition of a report",
                            "a list of signals or numbers has the condition for each",
                        );
                    }
                    continue;
                }
                ItemKind::Error => continue,
                ItemKind::Entry(entry) => (&entry.name, Some(&entry.value)),
                ItemKind::Binding(binding)
                    if binding.kind == BindingKind::Let && binding.index.is_empty() =>
                {
                    (&binding.name, binding.value.as_ref())
                }
                _ => {
                    whole = false;
                    self.checker.misplaced(
                        super::class::item_place(item),
                        "this",
                        "in a report",
                        "it takes `figure`, `value`, `let`, `require` and `advise`",
                    );
                    continue;
                }
            };
            if let Some((_, _, first)) = entries.iter().find(|(_, known, _)| *known == name.text) {
                whole = false;
                self.diagnose(
                    Diagnostic::error(
                        codes::DEFINED_TWICE,
                        format!("`{}` is defined twice", name.text),
                    )
                    .at(name.span, "again here")
                    .also(*first, "first here"),
                );
                continue;
            }
            entries.push((item, &name.text, name.span));
            let figure =
                matches!(&item.kind, ItemKind::Entry(e) if e.kind == ast::EntryKind::Figure);
            match value {
                Some(value) if !figure => {
                    self.names
                        .insert(&name.text, (name.span, Named::Lazy(value)));
                }
                Some(_) => {}
                None => {
                    whole = false;
                    self.diagnose(
                        Diagnostic::error(
                            codes::MISSING_VALUE,
                            format!("`{}` has no value", name.text),
                        )
                        .at(name.span, "named, but not given"),
                    );
                }
            }
        }
        let mut made = Vec::new();
        for item in &report.block.items {
            let kind = match &item.kind {
                ItemKind::Entry(entry) => self.entry(entry).map(Some),
                ItemKind::Binding(binding) if binding.value.is_some() => {
                    // a mistake gives a message even if nothing reads the value
                    self.named(&binding.name.text, binding.name.span)
                        .map(|_| None)
                }
                ItemKind::Statement(Statement::Require {
                    advise,
                    condition,
                    message,
                    ..
                }) => self.require(*advise, condition, message).map(Some),
                _ => continue,
            };
            match kind {
                Some(Some(kind)) => made.push(self.planned(item, kind)),
                Some(None) => {}
                None => whole = false,
            }
        }
        whole.then(|| plan::Report {
            name: report.name.text.clone(),
            title: title(report.title.as_ref(), &report.name.text),
            text: docs.join("\n"),
            place: location(report.name.span),
            entries: made,
        })
    }

    fn planned(&self, item: &ast::Item, kind: plan::EntryKind) -> plan::Entry {
        let written = |span: Span| self.checker.sources.text(span).to_owned();
        let (name, title, written, place) = match &item.kind {
            ItemKind::Entry(entry) => (
                entry.name.text.clone(),
                title(entry.title.as_ref(), &entry.name.text),
                written(entry.value.span),
                entry.name.span,
            ),
            ItemKind::Statement(Statement::Require {
                condition, advise, ..
            }) => (
                if *advise { "advise" } else { "require" }.to_owned(),
                written(condition.span),
                written(condition.span),
                condition.span,
            ),
            _ => (String::new(), String::new(), String::new(), item.span),
        };
        plan::Entry {
            name,
            title,
            text: item.docs.join("\n"),
            written,
            place: location(place),
            kind,
        }
    }

    fn entry(&mut self, entry: &'a ast::Entry) -> Option<plan::EntryKind> {
        if entry.kind == ast::EntryKind::Figure {
            return self
                .figure(&entry.value, entry.display.as_ref())
                .map(plan::EntryKind::Figure);
        }
        let typed = self.named(&entry.name.text, entry.name.span)?.settled();
        self.shaped(&entry.value, &typed, Shape::Number, "a value")?;
        let display = self.display(&typed, entry.display.as_ref(), &entry.value)?;
        Some(plan::EntryKind::Value {
            members: typed.members,
            display,
        })
    }

    /// The unit of a number: the stated one, that of the channels, or a usual one.
    fn display(
        &mut self,
        typed: &Typed,
        stated: Option<&ast::UnitExpr>,
        value: &Expr,
    ) -> Option<DisplayUnit> {
        if let Some(reference) = &typed.level {
            if let Some(stated) = stated {
                self.diagnose(
                    Diagnostic::error(codes::DISPLAY, "a level is shown in dB")
                        .at(stated.span, "another unit")
                        .also(value.span, "this is a level")
                        .with_help("omit `as`"),
                );
                return None;
            }
            return Some(DisplayUnit {
                symbol: format!("dB re {reference}"),
                scale: 1.0,
                offset: 0.0,
            });
        }
        if let Some(stated) = stated {
            let before = self.checker.diagnostics.len();
            self.checker.display(&self.scope, &typed.ty.row(), stated);
            if self.checker.diagnostics.len() > before {
                return None;
            }
            let unit = self.checker.program.unit(stated).ok()?;
            return Some(DisplayUnit::from(unit));
        }
        // only points use the zero of a unit
        let quantity = typed.quantity();
        let point = matches!(quantity.kind, super::types::Kind::Point(_));
        if let Some(display) = &typed.display
            && (point || display.offset == 0.0)
        {
            return Some(display.clone());
        }
        Some(self.usual_display(&quantity))
    }

    fn usual_display(&self, quantity: &Quantity) -> DisplayUnit {
        let dimension = quantity.dim.base;
        let usual = self.checker.usual_unit(quantity);
        let program = self.checker.program;
        let unit = usual.and_then(|text| {
            let own = program.units.get(&text).cloned();
            own.or_else(|| program.unit_of_text(&text))
        });
        match unit.filter(|unit| unit.dimension == dimension && !dimension.is_one()) {
            Some(usual) => usual.into(),
            None => DisplayUnit::si(dimension),
        }
    }

    fn require(
        &mut self,
        advise: bool,
        condition: &'a Expr,
        message: &'a ast::Name,
    ) -> Option<plan::EntryKind> {
        let word = if advise { "advise" } else { "require" };
        let found = self.expression(condition)?;
        self.shaped(
            condition,
            &found,
            Shape::Truth,
            &format!("the expression after `{word}`"),
        )?;
        let mut planned = Vec::new();
        let mut of_message = Diagnostics::new();
        let units = &self.checker.program.units;
        let is_unit = |word: &str| units.contains_key(word);
        let parts = parse_message(message, Some(&is_unit), &mut of_message);
        let failed = of_message.has_errors();
        for diagnostic in of_message.iter() {
            self.diagnose(diagnostic.clone());
        }
        for part in parts {
            match part {
                MessagePart::Text(text) => planned.push(plan::MessagePart::Text(text)),
                MessagePart::Value { value, unit, span } => {
                    let name = match &value.kind {
                        ast::ExprKind::Name(name) if self.names.contains_key(name.as_str()) => {
                            name.clone()
                        }
                        _ => {
                            self.diagnose(
                                Diagnostic::error(
                                    codes::MESSAGE_FORM,
                                    "a message of a report shows its values by their names",
                                )
                                .at(span, "no name of this report")
                                .with_help("give it a name with `let` or `value`"),
                            );
                            return None;
                        }
                    };
                    let typed = self.named(&name, span)?.settled();
                    self.shaped(&value, &typed, Shape::Number, "a value in a message")?;
                    let display = self.display(&typed, unit.as_ref(), &value)?;
                    let shown: Vec<_> = typed.members.into_iter().map(|m| m.expression).collect();
                    if shown.len() > 1 && shown.len() != found.members.len() {
                        self.diagnose(
                            Diagnostic::error(
                                codes::REPORT_RUNS,
                                format!("a message shows {} values at one place", shown.len()),
                            )
                            .at(span, "a list of another length than the condition")
                            .with_help(format!("show one of them: `{name}[1]` by a `let`")),
                        );
                        return None;
                    }
                    planned.push(plan::MessagePart::Value(shown, display));
                }
            }
        }
        (!failed).then_some(plan::EntryKind::Require {
            members: found.members.into_iter().map(|m| m.expression).collect(),
            message: planned,
            advise,
        })
    }

    /// A `let` or value of the report.
    fn named(&mut self, name: &str, span: Span) -> Option<Typed> {
        let (known, state) = self
            .names
            .get_key_value(name)
            .map(|(known, (place, state))| ((*known, *place), state.clone()))?;
        match state {
            Named::Done(typed) => typed,
            Named::Busy => {
                self.diagnose(value_circle(span));
                self.names.insert(known.0, (known.1, Named::Done(None)));
                None
            }
            Named::Lazy(expr) => {
                if !self.checker.deeper(span) {
                    return None;
                }
                self.names.insert(known.0, (known.1, Named::Busy));
                self.checker.depth += 1;
                let mut typed = self.expression(expr);
                self.checker.depth -= 1;
                // a circle has already given its message
                if let Some((_, Named::Done(None))) = self.names.get(name) {
                    typed = None;
                }
                self.names
                    .insert(known.0, (known.1, Named::Done(typed.clone())));
                typed
            }
        }
    }
}

impl<'p> Checker<'p> {
    /// Counts the names that a report reads as used.
    pub(super) fn names_of_report(&mut self, module: u32, report: &'p ast::Report) {
        let mut names = Vec::new();
        for item in &report.block.items {
            match &item.kind {
                ItemKind::Entry(entry) => super::declare::collect_names(&entry.value, &mut names),
                ItemKind::Binding(ast::Binding {
                    value: Some(value), ..
                })
                | ItemKind::Statement(Statement::Require {
                    condition: value, ..
                }) => super::declare::collect_names(value, &mut names),
                _ => {}
            }
        }
        for (name, _) in names {
            if let Some(id) = self.find_top(module, &name) {
                self.used.insert((id, String::new()));
            }
        }
    }
}

/// The stated title, or the name as words.
fn title(stated: Option<&ast::Title>, name: &str) -> String {
    match stated {
        Some(title) => title.text.clone(),
        None => {
            let words = name.replace('_', " ");
            let mut letters = words.chars();
            let first = letters.next().into_iter().flat_map(char::to_uppercase);
            first.chain(letters).collect()
        }
    }
}
