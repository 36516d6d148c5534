//! Changes of the inside of a part: `part unit = Cylinder(…) with { shank.mass = 0.65 kg; start hinge.angle = 3 deg }`.
//!
//! A change waits under its path until elaboration makes the number of this path. So it replaces the text's own value
//! before anything reads it. If several changes have one path, that of the outermost part counts.

use super::body::index_text;
use super::pending::{Pending, StartTarget};
use super::repeat::does_not_exist;
use super::value::{ScopeId, Value};
use super::{Elaborator, Eval};
use crate::codes;
use crate::resolve::suggest::{listing, nearest};
use crate::typed::types::Type;
use crate::words::START_VALUES;
use eng_grammar::ast::{self, ExprKind, IndexArgument, ItemKind, Statement};
use eng_grammar::{Diagnostic, Span};
use std::rc::Rc;

/// A number that a use changes.
#[derive(Clone, Debug)]
pub(crate) struct Change<'a> {
    /// Its path in the model.
    path: String,
    value: &'a ast::Expr,
    /// The scope of the value.
    scope: ScopeId,
    /// The name of the part that states it.
    of: Span,
    at: Span,
    used: bool,
}

/// The array of a path whose index none of the known paths has, with the indices that they have.
fn without_index<'p>(path: &'p str, known: &[&'p str]) -> Option<(&'p str, String)> {
    path.match_indices('[').find_map(|(at, _)| {
        let array = path.get(..at)?;
        let index = |path: &'p str| {
            path.strip_prefix(array)?
                .strip_prefix('[')?
                .split(']')
                .next()
        };
        let mut indices: Vec<&str> = known.iter().filter_map(|path| index(path)).collect();
        indices.dedup();
        let lacks = !indices.is_empty() && !indices.contains(&index(path)?);
        lacks.then(|| (array, listing_plain(&indices)))
    })
}

/// `1, 2 and 3`.
fn listing_plain(indices: &[&str]) -> String {
    listing(indices.iter().copied(), 12).replace('`', "")
}

impl<'a> Elaborator<'a, '_> {
    /// Notes the numbers that a part changes inside of the part with this path.
    pub fn note_changes(
        &mut self,
        declaration: &'a ast::Declaration,
        path: &str,
        scope: ScopeId,
    ) -> Eval<()> {
        for item in declaration.changes.iter().flat_map(|block| &block.items) {
            let (inner, value, at) = match &item.kind {
                ItemKind::Attribute(a) => (a.name.text.clone(), &a.value, a.name.span),
                ItemKind::Statement(Statement::Change { target, value }) => {
                    (self.path_of(target, scope)?, value, target.span)
                }
                _ => continue,
            };
            let path = format!("{path}.{inner}");
            let twice = (self.draft.changes.iter())
                .find(|earlier| earlier.path == path && earlier.of == declaration.name.span);
            if let Some(earlier) = twice {
                let message =
                    Diagnostic::error(codes::CHANGE, format!("`{inner}` is changed twice"))
                        .at(at, "the second change")
                        .also(earlier.at, "the first")
                        .with_help("leave one of them out");
                // the part is not made, so it uses none of them
                for change in &mut self.draft.changes {
                    change.used |= change.of == declaration.name.span;
                }
                return Err(self.report(message));
            }
            self.draft.changes.push(Change {
                path,
                of: declaration.name.span,
                value,
                scope,
                at,
                used: false,
            });
        }
        Ok(())
    }

    /// The path that an expression writes, with the values of its indices.
    fn path_of(&mut self, expr: &'a ast::Expr, scope: ScopeId) -> Eval<String> {
        match &expr.kind {
            ExprKind::Name(name) => Ok(name.clone()),
            ExprKind::Field { base, name } => {
                Ok(format!("{}.{}", self.path_of(base, scope)?, name.text))
            }
            ExprKind::Index { base, indices } => {
                let base = self.path_of(base, scope)?;
                let mut position = Vec::with_capacity(indices.len());
                for index in indices {
                    let IndexArgument::At(index) = index else {
                        return Err(self.one_at_a_time(expr.span));
                    };
                    match self.evaluate(index, scope)? {
                        Value::Int(i) if i >= 0 => position.push(i as usize),
                        _ => return Err(self.one_at_a_time(index.span)),
                    }
                }
                Ok(format!("{base}{}", index_text(&position)))
            }
            _ => Err(self.one_at_a_time(expr.span)),
        }
    }

    fn one_at_a_time(&mut self, span: Span) -> super::Reported {
        self.report(
            Diagnostic::error(codes::CHANGE, "each line after `with` changes one number")
                .at(span, "no name or whole number")
                .with_help("write a line for each: `rod[1].mass = 0.6 kg; rod[2].mass = 0.6 kg`"),
        )
    }

    /// The value that a use gives to the number of a path, with its scope.
    pub fn changed(&mut self, path: &str) -> Option<(&'a ast::Expr, ScopeId)> {
        let mut found = None;
        for change in &mut self.draft.changes {
            if change.path == path {
                change.used = true;
                found = found.or(Some((change.value, change.scope)));
            }
        }
        found
    }

    /// The value of a change in the place of the text's own value.
    pub fn changed_value(
        &mut self,
        own: &Value<'a>,
        expr: &'a ast::Expr,
        scope: ScopeId,
    ) -> Eval<Value<'a>> {
        let value = self.evaluate(expr, scope)?;
        if self.moves(&value) {
            return Err(self.report(
                Diagnostic::error(codes::MOTION, "a change depends on parameters alone")
                    .at(expr.span, "this moves")
                    .with_help("give the component the markers, and measure inside it"),
            ));
        }
        if let (Value::List(own), Value::List(new)) = (own, &value)
            && own.len() != new.len()
        {
            return Err(self.report(
                Diagnostic::error(
                    codes::LENGTHS,
                    format!(
                        "a list of {} cannot replace one of {}",
                        new.len(),
                        own.len()
                    ),
                )
                .at(expr.span, format!("{} numbers", new.len()))
                .with_help("an argument decides the length of a list: give it to the part"),
            ));
        }
        Ok(value)
    }

    /// Drops the changes inside of a part that was not made.
    pub fn drop_changes(&mut self, part: &str) {
        self.draft.changes.retain(|change| {
            let inner = change.path.strip_prefix(part);
            !inner.is_some_and(|inner| inner.starts_with('.'))
        });
    }

    /// The absent item that a path leads into.
    fn absent_around(&self, path: &str) -> Option<(&'a ast::Declaration, Rc<str>)> {
        let around = |absent: &str| {
            path.strip_prefix(absent)
                .is_some_and(|inner| inner.starts_with('.'))
        };
        let mut absent = self.draft.absent.iter();
        absent.find(|(_, path)| around(path)).cloned()
    }

    /// Reports changes that reach no number.
    pub fn lost_changes(&mut self) {
        let lost = std::mem::take(&mut self.draft.changes).into_iter();
        for change in lost.filter(|change| !change.used) {
            if let Some((declaration, path)) = self.absent_around(&change.path) {
                let label = "this changes a number of it";
                let message = does_not_exist(declaration, &path, change.at, label);
                self.report(message.with_help("leave the change out, or let the condition hold"));
                continue;
            }
            let known: Vec<&str> = (self.draft.parameters.iter())
                .map(|parameter| parameter.origin.path.as_str())
                .collect();
            let part = change.path.rsplit_once('.').map_or("", |(base, _)| base);
            let beside = known.iter().filter(|path| {
                let rest = path
                    .strip_prefix(part)
                    .and_then(|rest| rest.strip_prefix('.'));
                rest.is_some_and(|rest| !rest.contains('.'))
            });
            let mut beside: Vec<&str> = beside.copied().collect();
            beside.extend(self.attributes_beside_mass(part));
            let title = format!("`{}` is no number that a use can change", change.path);
            let message = Diagnostic::error(codes::CHANGE, title).at(
                change.at,
                "not a parameter, nor an attribute that a body states",
            );
            if let Some((array, indices)) = without_index(&change.path, &known) {
                let note = format!("`{array}` has the indices {indices}");
                self.report(message.with_note(note));
                continue;
            }
            let message = match nearest(&change.path, known.iter().copied()) {
                Some(near) => message.with_help(format!("did you mean `{near}`?")),
                None if beside.is_empty() => message
                    .with_help("`eng explain MODEL.eng` lists the parts, `eng explain MODEL.eng PATH` the parameters of one"),
                None => message.with_note(format!("`{part}` has {}", listing(beside, 12))),
            };
            self.report(message);
        }
    }

    /// The paths of the attributes that the body at a path states. Its mass is not among them, because it is a
    /// parameter.
    fn attributes_beside_mass(&self, part: &str) -> Vec<&str> {
        if self
            .draft
            .bodies
            .iter()
            .all(|body| body.origin.path != part)
        {
            return Vec::new();
        }
        let stated = self.draft.stated.keys().map(String::as_str);
        let beside = stated.filter(|path| match path.rsplit_once('.') {
            Some((base, name)) => base == part && name != "mass",
            None => false,
        });
        beside.collect()
    }

    /// `start` and `guess` after `with`: the target is inside of the part, the value outside.
    pub fn starts_inside(
        &mut self,
        declaration: &'a ast::Declaration,
        own: ScopeId,
        scope: ScopeId,
    ) -> Eval<()> {
        for item in declaration.changes.iter().flat_map(|block| &block.items) {
            let (target, value, exact) = match &item.kind {
                ItemKind::Statement(Statement::Start { target, value }) => (target, value, true),
                ItemKind::Statement(Statement::Guess { target, value }) => (target, value, false),
                _ => continue,
            };
            self.start_of(exact, (target, own), (value, scope))?;
        }
        Ok(())
    }

    /// A `start` or `guess` of a model, a component or a use. It replaces the one that the text of an inner part
    /// states for the same target.
    pub fn start_of(
        &mut self,
        exact: bool,
        (target, scope): (&'a ast::Expr, ScopeId),
        (value, outside): (&'a ast::Expr, ScopeId),
    ) -> Eval<()> {
        if let ExprKind::Field { base, name } = &target.kind
            && START_VALUES.contains(&name.text.as_str())
            && let Ok(Type::Body(_)) = self.type_at(base.span)
            && let Value::Body(body) = self.evaluate(base, scope)?
        {
            let inside = self.draft.body_scopes.get(body as usize).copied();
            let inside = self.checked(inside, base.span, "a body without a scope")?;
            let origin = self.entry(inside, "origin", base.span)?;
            let origin = self.as_marker(origin, base.span)?;
            return self.body_start(
                body,
                origin,
                (&name.text, target.span),
                value,
                outside,
                exact,
            );
        }
        let own = self.target_path(target, scope);
        let depth = self.scope(scope).path.len();
        let mut pending = std::mem::take(&mut self.draft.pending);
        pending.retain(|earlier| match earlier {
            Pending::StartExpression {
                target: other,
                scope: at,
                ..
            } => {
                let inner = outside != scope || self.scope(*at).path.len() > depth;
                !inner || self.target_path(other, *at) != own
            }
            _ => true,
        });
        pending.push(Pending::StartExpression {
            exact,
            target,
            scope,
            value,
            outside,
        });
        self.draft.pending = pending;
        Ok(())
    }

    /// The text of a target with the path of its scope, to compare targets.
    fn target_path(&self, target: &ast::Expr, scope: ScopeId) -> String {
        let text = self.sources.text(target.span);
        let text: String = text.chars().filter(|c| !c.is_whitespace()).collect();
        self.path(scope, &text)
    }

    /// Drops the start values of a body that an inner text states.
    pub fn replaced_start(&mut self, target: &StartTarget) {
        self.draft.pending.retain(|earlier| {
            !matches!(earlier, Pending::Start { target: other, .. } if other.is_same(target))
        });
    }
}
