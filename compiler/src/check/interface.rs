//! Interfaces: whether a class has the parameters and outputs that its interface promises.

use super::Checker;
use super::scope::Member;
use super::types::Type;
use crate::codes;
use crate::program::DefinitionId;
use crate::resolve::JOURNAL_LAW;
use crate::resolve::suggest::{listing, nearest};
use eng_grammar::Diagnostic;
use eng_grammar::ast::{Binding, BindingKind, Declaration, Form, ItemKind, Kind, Name};

impl<'p> Checker<'p> {
    /// Checks that a class fills its interface.
    pub(super) fn conformity(&mut self, id: DefinitionId, declaration: &'p Declaration) {
        let Form::Class { interface, .. } = &declaration.form else {
            return;
        };
        let Some(name) = interface else {
            self.is_film(id, declaration, None);
            return;
        };
        let Some(interface) = self.interface_of(id) else {
            match self.find_top(id.module, &name.text) {
                Some(other) => {
                    let message = Diagnostic::error(
                        codes::INTERFACE,
                        format!("`{}` is no interface", name.text),
                    )
                    .at(name.span, "an interface stands here");
                    let message = match self.declaration(other) {
                        Some(other) => message.also(other.name.span, "defined here"),
                        None => message,
                    };
                    self.report(message);
                }
                None => {
                    let mut interfaces: Vec<&str> = self
                        .program
                        .modules
                        .iter()
                        .flat_map(|module| &module.file.items)
                        .filter_map(|item| match &item.kind {
                            ItemKind::Declaration(d) if d.kind == Kind::Interface => {
                                Some(d.name.text.as_str())
                            }
                            _ => None,
                        })
                        .collect();
                    let mut message = Diagnostic::error(
                        codes::UNKNOWN_TYPE,
                        format!("there is no interface `{}`", name.text),
                    )
                    .at(name.span, "not known");
                    interfaces.extend(self.program.offered.keys().map(String::as_str));
                    if let Some(offered) = self.program.offered.get(&name.text) {
                        message = self.offer_use(message, id.module, &offered.module, &name.text);
                    } else if let Some(near) = nearest(&name.text, interfaces) {
                        message = message.meant(name.span, near);
                    }
                    self.report(message);
                }
            }
            return;
        };
        if !self.is_film(id, declaration, Some(interface)) {
            return;
        }
        for promise in self.promises(interface) {
            match self.kept(id, promise) {
                Some(member) => self.as_promised(id, declaration, interface, promise, member),
                None => {
                    let (word, text) = (word(promise), self.promise_text(promise));
                    let class = &declaration.name;
                    self.report(
                        Diagnostic::error(
                            codes::INTERFACE,
                            format!("`{}` lacks the {word} `{text}` of `{}`", class.text, name.text),
                        )
                        .at(class.span, format!("no {word} `{}`", promise.name.text))
                        .also(promise.name.span, "promised here")
                        .with_help(format!(
                            "a class of `{}` gives its {word}s the interface's names: it is known by them",
                            name.text
                        )),
                    );
                }
            }
        }
    }

    /// The parameters and outputs of an interface, in its order.
    fn promises(&mut self, interface: DefinitionId) -> Vec<&'p Binding> {
        let declaration = self.declaration(interface);
        let block = declaration.and_then(super::scope::block_of);
        block
            .into_iter()
            .flat_map(|block| &block.items)
            .filter_map(|item| match &item.kind {
                ItemKind::Binding(binding) => Some(binding),
                _ => None,
            })
            .collect()
    }

    /// `radial_clearance: Length`.
    fn promise_text(&self, promise: &Binding) -> String {
        let name = &promise.name.text;
        match &promise.ty {
            Some(ty) => format!("{name}: {}", self.sources.text(ty.span)),
            None => name.clone(),
        }
    }

    /// The member of a class with which it keeps a promise.
    fn kept(&mut self, class: DefinitionId, promise: &Binding) -> Option<Member<'p>> {
        let own = self.member(class, &promise.name.text)?;
        let fits = match (promise.kind, own) {
            (BindingKind::Output, Member::Binding(b)) => b.kind == BindingKind::Output,
            (BindingKind::Output, Member::Reaction(_)) => true,
            (_, own) => matches!(own, Member::Parameter(_)),
        };
        fits.then_some(own)
    }

    /// Reports a difference between a member and its promise.
    fn as_promised(
        &mut self,
        id: DefinitionId,
        declaration: &Declaration,
        interface: DefinitionId,
        promise: &'p Binding,
        own: Member<'p>,
    ) {
        let name = &promise.name.text;
        let wanted = Member::Binding(promise);
        let wanted_type = self.member_type(interface, name, wanted, promise.name.span);
        let own_span = own.span().unwrap_or(declaration.name.span);
        let own_type = self.member_type(id, name, own, own_span);
        if own_type.is_error() || wanted_type.is_error() {
            return;
        }
        let (class, interface) = (&declaration.name.text, self.class_name(interface));
        let word = word(promise);
        if !self.assignable(&own_type, &wanted_type) {
            let (own_text, wanted_text) = (self.describe(&own_type), self.describe(&wanted_type));
            self.report(
                Diagnostic::error(
                    codes::INTERFACE,
                    format!("the {word} `{name}` of `{class}` is {own_text}, not {wanted_text}"),
                )
                .at(own_span, format!("this is {own_text}"))
                .also(
                    promise.name.span,
                    format!("`{interface}` promises {wanted_text}"),
                ),
            );
            return;
        }
        let (Some(axes), Member::Binding(binding)) = (&promise.frame, own) else {
            return;
        };
        let due = self.sources.text(axes.span);
        let stated = binding
            .frame
            .as_ref()
            .map(|frame| self.sources.text(frame.span));
        if stated != Some(due) {
            let found = match (stated, &own_type) {
                (Some(stated), _) => format!("in the axes of `{stated}`"),
                (None, Type::Vector { .. }) => "in other axes".to_owned(),
                (None, _) => "without axes".to_owned(),
            };
            let message = Diagnostic::error(
                codes::INTERFACE,
                format!("the output `{name}` of `{class}` is {found}, not in those of `{due}`"),
            )
            .at(own_span, format!("needs `in {due}`"))
            .also(
                promise.name.span,
                format!("`{interface}` promises `in {due}`"),
            )
            .with_help(format!(
                "write `output {name} = … in {due}`: figures and tables read it so"
            ));
            self.report(message);
        }
    }

    /// Whether a class is not a journal, or a journal that fills the interface of films. Reports a journal
    /// that does not declare this interface.
    fn is_film(
        &mut self,
        id: DefinitionId,
        declaration: &Declaration,
        interface: Option<DefinitionId>,
    ) -> bool {
        let Some(law) = self.program.journal_law() else {
            return true;
        };
        if declaration.kind != Kind::Journal || interface == Some(law) {
            return true;
        }
        let Name { text, span } = &declaration.name;
        let promises = self.promises(law);
        let mut lacking = Vec::new();
        for promise in promises {
            if self.kept(id, promise).is_none() {
                lacking.push(self.promise_text(promise));
            }
        }
        let (module, name) = JOURNAL_LAW;
        let message = if lacking.is_empty() {
            Diagnostic::error(
                codes::NO_FILM,
                format!("the journal `{text}` does not say that it fills `{name}`"),
            )
            .at(*span, format!("`: {name}` is missing"))
        } else {
            let all = listing(lacking.iter().map(String::as_str), 20);
            Diagnostic::error(
                codes::NO_FILM,
                format!("the journal `{text}` lacks {all} of `{name}`"),
            )
            .at(
                *span,
                "a journal gives what tables, orbits and the start read of a film",
            )
        };
        let message = match interface {
            Some(other) => message.with_note(format!(
                "it fills `{}`, which is another interface",
                self.class_name(other)
            )),
            None => message,
        };
        self.report(message.with_help(format!(
            "give parameters and outputs these names and write `: {name}` after the parameters, with `use {module}.{name}`; what is no film is a `force`"
        )));
        false
    }
}

fn word(promise: &Binding) -> &'static str {
    match promise.kind {
        BindingKind::Output => "output",
        _ => "parameter",
    }
}
