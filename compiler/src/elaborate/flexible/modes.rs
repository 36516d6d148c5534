//! Mode sets: their terms, and the markers of these terms.

use super::super::value::{ScopeId, Value};
use super::super::{Elaborator, Eval, Reported};
use super::{MarkerName, ModePart, PartKind, TermDraft, TermKind, bare_word, meaning};
use crate::codes;
use crate::resolve::suggest::{listing, nearest};
use crate::words::{Word, argument};
use eng_grammar::ast::{ExprKind, IndexArgument};
use eng_grammar::{Diagnostic, Span, ast};
use eng_system::flexible::{FREEDOM_NAMES, Freedoms, ModeCount};
use eng_system::significant::short;
use std::rc::Rc;

impl<'a> Elaborator<'a, '_> {
    /// The value of `static(…)` and of similar terms.
    pub fn mode_set(
        &mut self,
        word: &'static Word,
        span: Span,
        arguments: &'a [ast::Argument],
        scope: ScopeId,
    ) -> Eval<Value<'a>> {
        let get = |name: &str| argument(word, arguments, name);
        let names = |e: &mut Self, name: &str| -> Eval<Vec<MarkerName>> {
            match get(name) {
                Some(expr) => e.marker_names(expr, scope),
                None => Ok(Vec::new()),
            }
        };
        let freedoms = get("freedoms").map(freedoms_of);
        let part = |kind, at| ModePart {
            kind,
            at,
            freedoms,
            span,
        };
        let parts = match word.word {
            "static" => vec![part(PartKind::Static, names(self, "at")?)],
            "constraint" => vec![part(PartKind::Constraint, names(self, "at")?)],
            "normal" => {
                let count = self.mode_count(word, span, arguments, scope)?;
                vec![part(PartKind::Normal(count), names(self, "fixed")?)]
            }
            "craig_bampton" => {
                let count = self.mode_count(word, span, arguments, scope)?;
                let at = names(self, "at")?;
                vec![
                    part(PartKind::Constraint, at.clone()),
                    part(PartKind::Normal(count), at),
                ]
            }
            _ => {
                let file = self.text_of(get("file"), scope)?;
                let format = get("format").and_then(meaning);
                let file = self.checked(file, span, "shapes without a file")?;
                let format = self.checked(format, span, "shapes without a format")?;
                vec![part(PartKind::Given { format, file }, Vec::new())]
            }
        };
        Ok(Value::ModeSet(Rc::new(parts)))
    }

    pub(super) fn mode_count(
        &mut self,
        word: &'static Word,
        span: Span,
        arguments: &'a [ast::Argument],
        scope: ScopeId,
    ) -> Eval<ModeCount> {
        if let Some(expr) = argument(word, arguments, "number") {
            let n = self.integer(expr, scope)?;
            return match u32::try_from(n) {
                // a choice: a body with more modes is slower than its mesh
                Ok(n) if (1..=2000).contains(&n) => Ok(ModeCount::Number(n)),
                _ => Err(self.report(
                    Diagnostic::error(
                        codes::FLEXIBLE_NUMBER,
                        "the number of modes must be 1 to 2000",
                    )
                    .at(expr.span, format!("this is {n}")),
                )),
            };
        }
        let expr = argument(word, arguments, "up_to");
        let expr = self.checked(expr, span, "neither a number of modes nor a frequency")?;
        let frequency = self.structural_number(expr, scope)?;
        if frequency > 0.0 && frequency.is_finite() {
            return Ok(ModeCount::UpTo(frequency));
        }
        Err(self.report(
            Diagnostic::error(codes::FLEXIBLE_NUMBER, "`up_to` must be positive")
                .at(expr.span, format!("this is {} Hz", short(frequency, 4))),
        ))
    }

    pub(super) fn marker_names(
        &mut self,
        expr: &'a ast::Expr,
        scope: ScopeId,
    ) -> Eval<Vec<MarkerName>> {
        match &expr.kind {
            ExprKind::List { items, unit: None } => {
                let mut names = Vec::new();
                for item in items {
                    names.extend(self.marker_names(item, scope)?);
                }
                Ok(names)
            }
            ExprKind::Name(name) => Ok(vec![MarkerName {
                name: name.clone(),
                index: None,
                span: expr.span,
            }]),
            ExprKind::Index { base, indices } => {
                let mut names = self.marker_names(base, scope)?;
                for index in indices {
                    let IndexArgument::At(at) = index else {
                        continue;
                    };
                    let chosen = match self.evaluate(at, scope)? {
                        Value::Int(i) => vec![i],
                        several => self
                            .read::<Vec<Value<'a>>>(several, at.span)?
                            .iter()
                            .filter_map(|v| match v {
                                Value::Int(i) => Some(*i),
                                _ => None,
                            })
                            .collect(),
                    };
                    for name in &mut names {
                        name.index = Some(chosen.clone());
                        name.span = expr.span;
                    }
                }
                Ok(names)
            }
            ExprKind::Error => Err(Reported),
            _ => self.checked(None, expr.span, "no marker's name"),
        }
    }

    /// Indices of the markers with a name.
    pub(super) fn found(
        &mut self,
        wanted: &MarkerName,
        known: &[(String, Vec<usize>)],
        path: &str,
    ) -> Eval<Vec<u32>> {
        let of_name = |(i, (name, position)): (usize, &(String, Vec<usize>))| {
            (*name == wanted.name).then(|| (i as u32, position.clone()))
        };
        let family: Vec<(u32, Vec<usize>)> = known.iter().enumerate().filter_map(of_name).collect();
        if family.is_empty() {
            let names = || known.iter().map(|(name, _)| name.as_str());
            let mut message = Diagnostic::error(
                codes::MODE_MARKER,
                format!("{path} has no marker `{}`", wanted.name),
            )
            .at(wanted.span, "not among its markers");
            message = match nearest(&wanted.name, names()) {
                Some(near) => message.meant(wanted.span, near),
                None => {
                    let mut distinct: Vec<&str> = names().collect();
                    distinct.dedup();
                    message.with_note(format!("it has {}", listing(distinct, 12)))
                }
            };
            return Err(self.report(message));
        }
        let Some(chosen) = &wanted.index else {
            return Ok(family.into_iter().map(|(i, _)| i).collect());
        };
        let mut found = Vec::with_capacity(chosen.len());
        for index in chosen {
            let marker = family
                .iter()
                .find(|(_, position)| position.iter().map(|p| *p as i64).eq([*index]));
            match marker {
                Some((i, _)) => found.push(*i),
                None => {
                    return Err(self.report(
                        Diagnostic::error(
                            codes::MODE_MARKER,
                            format!("{path} has no marker `{}[{index}]`", wanted.name),
                        )
                        .at(wanted.span, "no such index")
                        .with_note(format!("there are {} of this name", family.len())),
                    ));
                }
            }
        }
        Ok(found)
    }

    pub(super) fn term(
        &mut self,
        part: &ModePart,
        known: &[(String, Vec<usize>)],
        path: &str,
    ) -> Eval<TermDraft> {
        let mut at = Vec::new();
        for name in &part.at {
            at.extend(self.found(name, known, path)?);
        }
        Ok(TermDraft {
            kind: match &part.kind {
                PartKind::Static => TermKind::Static,
                PartKind::Constraint => TermKind::Constraint,
                PartKind::Normal(count) => TermKind::Normal(*count),
                PartKind::Given { format, file } => TermKind::Given {
                    format: *format,
                    file: file.clone(),
                },
            },
            at,
            freedoms: part.freedoms,
            span: part.span,
        })
    }
}

pub(super) fn freedoms_of(expr: &ast::Expr) -> Freedoms {
    let bit = |e: &ast::Expr| {
        let name = bare_word(e);
        FREEDOM_NAMES
            .iter()
            .position(|n| *n == name)
            .map_or(0, |i| 1 << i)
    };
    match &expr.kind {
        ExprKind::List { items, .. } => items.iter().fold(0, |bits, e| bits | bit(e)),
        _ => bit(expr),
    }
}
