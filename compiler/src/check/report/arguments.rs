//! Arguments of a report's functions.

use super::Reporter;
use crate::codes;
use crate::resolve::suggest::{listing, nearest};
use eng_grammar::ast::{Argument, Expr, ExprKind};
use eng_grammar::{Diagnostic, Span};

/// What a function takes.
#[derive(Debug)]
pub(super) struct Form {
    /// Its name.
    pub name: &'static str,
    /// Arguments by place; each may be given by name too.
    pub required: &'static [&'static str],
    /// Whether more follow by place.
    pub many: bool,
    /// Arguments by name.
    pub options: &'static [&'static str],
}

impl Form {
    pub const fn new(
        name: &'static str,
        required: &'static [&'static str],
        options: &'static [&'static str],
    ) -> Form {
        Form {
            name,
            required,
            many: false,
            options,
        }
    }

    pub const fn of_many(
        name: &'static str,
        required: &'static [&'static str],
        options: &'static [&'static str],
    ) -> Form {
        Form {
            many: true,
            ..Form::new(name, required, options)
        }
    }
}

/// Arguments by their names; those beyond the required ones by place.
#[derive(Debug)]
pub(super) struct Taken<'a> {
    named: Vec<(&'static str, &'a Expr)>,
    /// What follows the required ones.
    pub more: Vec<&'a Expr>,
}

impl<'a> Taken<'a> {
    /// An argument that may be absent.
    pub fn option(&self, name: &str) -> Option<&'a Expr> {
        self.named
            .iter()
            .find(|(known, _)| *known == name)
            .map(|(_, value)| *value)
    }
}

impl<'a> Reporter<'a, '_> {
    /// Arguments as a form takes them; `None` where a message was given.
    pub(super) fn taken(
        &mut self,
        form: &'static Form,
        arguments: &'a [Argument],
        span: Span,
    ) -> Option<Taken<'a>> {
        let mut taken = Taken {
            named: Vec::new(),
            more: Vec::new(),
        };
        let all = || form.required.iter().chain(form.options);
        let mut ok = true;
        let mut place = 0;
        for argument in arguments {
            let value = &argument.value;
            let known = match &argument.name {
                Some(name) => {
                    let known = all().find(|known| **known == name.text);
                    if known.is_none() {
                        ok = false;
                        let message = Diagnostic::error(
                            codes::UNKNOWN_ARGUMENT,
                            format!("`{}` has no parameter `{}`", form.name, name.text),
                        )
                        .at(name.span, "no parameter of this name");
                        let message = match nearest(&name.text, all().copied()) {
                            Some(near) => message.meant(name.span, near),
                            None => message
                                .with_note(format!("it takes {}", listing(all().copied(), 12))),
                        };
                        self.tell(message);
                        continue;
                    }
                    known
                }
                None => {
                    let known = form.required.get(place);
                    place += 1;
                    known
                }
            };
            match known {
                Some(known) => {
                    if let Some(first) = taken.option(known) {
                        ok = false;
                        self.tell(
                            Diagnostic::error(
                                codes::ARGUMENT_TWICE,
                                format!("`{known}` is given twice"),
                            )
                            .at(value.span, "again here")
                            .also(first.span, "first here"),
                        );
                        continue;
                    }
                    taken.named.push((known, value));
                }
                None if form.many => taken.more.push(value),
                None => {
                    ok = false;
                    self.tell(
                        Diagnostic::error(
                            codes::TOO_MANY_ARGUMENTS,
                            format!("`{}` takes fewer arguments by place", form.name),
                        )
                        .at(value.span, "one too many")
                        .with_note(format!("it takes {}", listing(all().copied(), 12))),
                    );
                }
            }
        }
        let missing: Vec<&str> = form
            .required
            .iter()
            .filter(|name| taken.option(name).is_none())
            .copied()
            .collect();
        if ok && !missing.is_empty() {
            ok = false;
            let names = listing(missing, 12);
            self.tell(
                Diagnostic::error(
                    codes::MISSING_ARGUMENT,
                    format!("`{}` needs {names}", form.name),
                )
                .at(span, format!("without {names}")),
            );
        }
        ok.then_some(taken)
    }

    /// One of several words; `None` inside where the argument is absent.
    pub(super) fn word<T: Copy>(
        &mut self,
        value: Option<&Expr>,
        what: &str,
        known: &[(&'static str, T)],
    ) -> Option<Option<T>> {
        let Some(value) = value else {
            return Some(None);
        };
        let word = match &value.kind {
            ExprKind::Name(name) => name.as_str(),
            ExprKind::Bool(true) => "true",
            ExprKind::Bool(false) => "false",
            _ => "",
        };
        if let Some((_, meaning)) = known.iter().find(|(name, _)| *name == word) {
            return Some(Some(*meaning));
        }
        let words = || known.iter().map(|(name, _)| *name);
        let mut message = Diagnostic::error(
            codes::REPORT_WORD,
            format!("{what} is one of {}", listing(words(), 12)),
        )
        .at(value.span, "none of these words");
        if let Some(near) = nearest(word, words()) {
            message = message.meant(value.span, near);
        }
        self.tell(message);
        None
    }
}
