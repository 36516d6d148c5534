//! Finds the parameter of each argument of a call. Calls are of functions, classes, words of flexible bodies
//! and functions of the language.

use super::Checker;
use crate::codes;
use crate::functions::BuiltIn;
use crate::resolve::suggest::{listing, nearest};
use eng_grammar::ast::{Argument, Expr, Name};
use eng_grammar::{Diagnostic, Span};

/// A parameter as a call sees it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Parameter<'s> {
    pub name: &'s str,
    pub required: bool,
    pub by_place: bool,
    pub by_name: bool,
}

/// Names of parameters as messages show them. Those of a function type have no names; `argument 2` is no code.
pub(super) fn as_shown(names: &str) -> String {
    match names.contains("`argument ") {
        true => names.replace('`', ""),
        false => names.to_owned(),
    }
}

/// The name and the parameters of a function, class or word that a text calls.
#[derive(Debug)]
pub(super) struct Called<'s> {
    pub name: &'s str,
    pub parameters: Vec<Parameter<'s>>,
    /// Whether more arguments by place may follow.
    pub more: bool,
    /// An example of a call, for messages.
    pub example: Option<&'static str>,
}

impl Called<'_> {
    fn names(&self) -> impl Iterator<Item = &str> + Clone {
        self.parameters.iter().map(|parameter| parameter.name)
    }

    /// Adds a note with the names of all parameters.
    fn takes(&self, message: Diagnostic) -> Diagnostic {
        let message = message.with_note(format!("it takes {}", listing(self.names(), 12)));
        self.shown(message)
    }

    fn shown(&self, message: Diagnostic) -> Diagnostic {
        let shown = |example| format!("for instance `{example}`");
        message.help_if(self.example.map(shown))
    }

    /// The message for parameters that have no argument.
    pub fn missing(&self, missing: &[usize], span: Span) -> Diagnostic {
        let names = missing.iter().filter_map(|at| self.parameters.get(*at));
        let names = match self.more {
            true => "at least one argument".to_owned(),
            false => as_shown(&listing(names.map(|parameter| parameter.name), 12)),
        };
        let title = format!("`{}` needs {names}", self.name);
        let message = Diagnostic::error(codes::MISSING_ARGUMENT, title);
        self.shown(message.at(span, format!("without {names}")))
    }
}

/// The arguments of a call.
#[derive(Debug, Default)]
pub(super) struct Given<'e> {
    /// Each with the number of its parameter. Further arguments by place have no number.
    pub arguments: Vec<(Option<usize>, &'e Expr)>,
    /// Arguments without a parameter, and second arguments of one parameter. Each has its message.
    pub odd: Vec<&'e Expr>,
    /// The parameters that lack an argument.
    pub missing: Vec<usize>,
}

/// The arguments of a call of a built-in function, by the names of their parameters.
#[derive(Debug)]
pub(super) struct Bound<'e> {
    names: Vec<&'static str>,
    arguments: Vec<(Option<usize>, &'e Expr)>,
}

impl<'e> Bound<'e> {
    /// An argument that may be absent.
    pub fn option(&self, name: &str) -> Option<&'e Expr> {
        let at = self.names.iter().position(|known| *known == name);
        let found = self.arguments.iter().find(|(other, _)| *other == at);
        found.filter(|_| at.is_some()).map(|(_, value)| *value)
    }

    /// The further arguments by place.
    pub fn more(&self) -> impl Iterator<Item = &'e Expr> {
        let beyond = self.arguments.iter().filter(|(at, _)| at.is_none());
        beyond.map(|(_, value)| *value)
    }
}

impl Checker<'_> {
    /// Finds the parameter of each argument. The caller reports parameters that lack one.
    pub(super) fn given<'e>(
        &mut self,
        called: &Called<'_>,
        arguments: &'e [Argument],
    ) -> Given<'e> {
        let mut given = Given::default();
        let mut meant: Vec<usize> = Vec::new();
        let mut places = called
            .parameters
            .iter()
            .enumerate()
            .filter(|(_, parameter)| parameter.by_place);
        for argument in arguments {
            let value = &argument.value;
            let number = match &argument.name {
                Some(name) => {
                    let known = |p: &Parameter<'_>| p.by_name && p.name == name.text;
                    called.parameters.iter().position(known)
                }
                None => places.next().map(|(number, _)| number),
            };
            let first = given
                .arguments
                .iter()
                .find(|(other, _)| number.is_some() && *other == number);
            match (number, first, &argument.name) {
                (Some(number), Some((_, first)), _) => {
                    let name = called.parameters.get(number).map_or("", |p| p.name);
                    self.report(
                        Diagnostic::error(
                            codes::ARGUMENT_TWICE,
                            format!("`{name}` is given twice"),
                        )
                        .at(value.span, "again here")
                        .also(first.span, "first here"),
                    );
                    given.odd.push(value);
                }
                (Some(_), None, _) => given.arguments.push((number, value)),
                (None, _, None) if called.more => given.arguments.push((None, value)),
                (None, _, None) => {
                    self.one_too_many(called, value.span);
                    given.odd.push(value);
                }
                (None, _, Some(name)) => {
                    // a misspelled argument is not reported a second time as a missing one
                    meant.extend(self.no_parameter(called, name));
                    given.odd.push(value);
                }
            }
        }
        given.missing = (0..called.parameters.len())
            .filter(|at| called.parameters[*at].required && !meant.contains(at))
            .filter(|at| given.arguments.iter().all(|(other, _)| *other != Some(*at)))
            .collect();
        given
    }

    /// The arguments of a call of a built-in function; `None` after an error. With `by_name` a text may name every
    /// parameter. Without it, a text may name the optional ones only.
    pub(super) fn bound<'e>(
        &mut self,
        function: &BuiltIn,
        arguments: &'e [Argument],
        span: Span,
        by_name: bool,
    ) -> Option<Bound<'e>> {
        let places = function.parameters.iter().map(|name| (*name, true));
        let options = function.options.iter().map(|name| (*name, false));
        let called = Called {
            name: function.name,
            parameters: places
                .chain(options)
                .map(|(name, by_place)| Parameter {
                    name,
                    required: by_place,
                    by_place,
                    by_name: by_name || !by_place,
                })
                .collect(),
            more: function.more,
            example: None,
        };
        self.bound_to(&called, arguments, span)
    }

    /// The arguments of a call by the names of their parameters; `None` after an error.
    pub(super) fn bound_to<'e>(
        &mut self,
        called: &Called<'static>,
        arguments: &'e [Argument],
        span: Span,
    ) -> Option<Bound<'e>> {
        let given = self.given(called, arguments);
        if !given.odd.is_empty() {
            return None;
        }
        if !given.missing.is_empty() {
            self.report(called.missing(&given.missing, span));
            return None;
        }
        Some(Bound {
            names: called.parameters.iter().map(|p| p.name).collect(),
            arguments: given.arguments,
        })
    }

    /// Reports a name that no parameter has. Returns the parameter with the most similar name.
    fn no_parameter(&mut self, called: &Called<'_>, name: &Name) -> Option<usize> {
        let by_name = called.parameters.iter().filter(|p| p.by_name);
        let near = nearest(&name.text, by_name.clone().map(|p| p.name));
        let message = Diagnostic::error(
            codes::UNKNOWN_ARGUMENT,
            format!("`{}` has no parameter `{}`", called.name, name.text),
        )
        .at(name.span, "no parameter of this name");
        let place = called.parameters.iter().position(|p| p.name == name.text);
        self.report(match near {
            _ if place.is_some() => {
                let number = place.map_or(0, |place| place + 1);
                message.with_help(format!(
                    "it is argument {number} and has no name: give its value alone"
                ))
            }
            Some(near) => message.meant(name.span, near),
            None if by_name.count() == 0 && !called.parameters.is_empty() => {
                message.with_help("its arguments have no names")
            }
            None => called.takes(message),
        });
        let near = near?;
        called.names().position(|known| known == near)
    }

    fn one_too_many(&mut self, called: &Called<'_>, span: Span) {
        let count = called.parameters.iter().filter(|p| p.by_place).count();
        let title = match count {
            0 if !called.parameters.is_empty() => {
                format!("the arguments of `{}` have names", called.name)
            }
            1 => format!("`{}` takes 1 argument", called.name),
            _ => format!("`{}` takes {count} arguments", called.name),
        };
        let by_place = match count {
            0 => "",
            count if count < called.parameters.len() => " by place",
            _ => "",
        };
        let message = Diagnostic::error(codes::TOO_MANY_ARGUMENTS, title + by_place);
        let message = called.takes(message.at(span, "one too many"));
        self.report(message);
    }
}
