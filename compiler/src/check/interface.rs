//! Interfaces: whether a class gives the outputs and functions that its interface requires.

use super::Checker;
use super::class::{item_place, placing};
use super::describe::{kind_word, with_article};
use super::member::{Member, OwnedMember};
use super::scope::Scope;
use super::types::{Signature, Type};
use crate::codes;
use crate::program::{DefinitionId, interface_name};
use crate::resolve::JOURNAL_LAW;
use crate::resolve::suggest::{listing, nearest};
use crate::typed::lineage::{
    Level, asks, has_functions_only, is_parameter, levels, word_of_length,
};
use eng_grammar::ast::{
    Binding, BindingKind, Declaration, Function, ItemKind, Kind, Name, Statement, TypeExpr,
};
use eng_grammar::{Diagnostic, Span};

impl<'p> Checker<'p> {
    /// Checks that a class, record or interface fills the interface after its colon.
    pub(super) fn conformity(&mut self, id: DefinitionId, declaration: &'p Declaration) {
        let Some(name) = interface_name(declaration) else {
            self.is_film(id, declaration);
            return;
        };
        // the name counts as read, right or wrong
        let found = self.find_top(id.module, &name.text);
        let Some(interface) = self.program.interface_of(id) else {
            return self.no_interface(id, name, found);
        };
        if !self.is_film(id, declaration) || !self.may_fill(declaration, interface, name) {
            return;
        }
        let levels = levels(self.program, id);
        self.lints_once(&levels);
        for level in levels.iter().filter(|level| level.definition != id) {
            for item in &level.block.items {
                match &item.kind {
                    // a class may give its own value of an output, with the same type
                    ItemKind::Binding(stated)
                        if asks(&item.kind) || stated.kind == BindingKind::Output =>
                    {
                        self.bound_as_asked(id, declaration, *level, stated);
                    }
                    ItemKind::Function(asked) if asks(&item.kind) => {
                        self.function_as_asked(id, declaration, *level, asked);
                    }
                    _ => {}
                }
            }
        }
    }

    /// Reports a name after a colon that is no interface.
    fn no_interface(&mut self, id: DefinitionId, name: &Name, found: Option<DefinitionId>) {
        if let Some(other) = found {
            let message =
                Diagnostic::error(codes::INTERFACE, format!("`{}` is no interface", name.text))
                    .at(name.span, "an interface is expected here");
            let message = message.also_if(
                self.declaration(other).map(|other| other.name.span),
                "defined here",
            );
            return self.report(message);
        }
        let mut interfaces: Vec<&str> = self
            .program
            .modules
            .iter()
            .flat_map(|module| &module.file.items)
            .filter_map(|item| match &item.kind {
                ItemKind::Declaration(d) if d.kind == Kind::Interface => Some(d.name.text.as_str()),
                _ => None,
            })
            .collect();
        let mut message = Diagnostic::error(
            codes::UNKNOWN_TYPE,
            format!("there is no interface `{}`", name.text),
        )
        .at(name.span, "not known");
        let offered = self.program.offered.iter();
        let offered = offered.filter(|(_, offered)| offered.word == "interface");
        interfaces.extend(offered.map(|(name, _)| name.as_str()));
        if let Some(offered) = self.program.offered.get(&name.text) {
            message = self.offer_use(message, id.module, &offered.module, &name.text);
        } else if let Some(near) = nearest(&name.text, interfaces) {
            message = message.meant(name.span, near);
        }
        self.report(message);
    }

    /// Whether a definition of this kind can fill the interface. Reports one that cannot.
    fn may_fill(
        &mut self,
        declaration: &'p Declaration,
        interface: DefinitionId,
        name: &Name,
    ) -> bool {
        let kind = declaration.kind;
        let (class, kind_name) = (&declaration.name.text, with_article(kind_word(kind)));
        let elders = levels(self.program, interface);
        let message = Diagnostic::error(
            codes::INTERFACE,
            format!("`{class}` cannot fill `{}`", name.text),
        );
        let only_functions = has_functions_only(self.program, interface);
        let message = if kind == Kind::Interface {
            match elders.as_slice() {
                [own] if own.declaration.name.span == declaration.name.span => message
                    .at(name.span, "this is the interface itself")
                    .with_help("omit the colon"),
                [.., eldest, parent] => message
                    .at(
                        name.span,
                        format!("it extends `{}`", eldest.declaration.name.text),
                    )
                    .also(parent.declaration.name.span, "defined here")
                    .with_help(
                        "an interface can extend only an interface that extends no other: put the common items into it",
                    ),
                _ => return true,
            }
        } else if (kind == Kind::Record) != only_functions {
            let other = elders
                .iter()
                .flat_map(|level| &level.block.items)
                .find(|item| !matches!(item.kind, ItemKind::Function(_)));
            match other {
                Some(item) => message
                    .at(
                        name.span,
                        format!("`{}` has items other than functions, so a record cannot fill it", name.text),
                    )
                    .also(item_place(item), "for instance this")
                    .with_help("a record can fill only an interface of functions; an interface with parameters, loads or outputs needs a class"),
                None => message
                    .at(
                        name.span,
                        format!("`{}` has only functions, so only a record can fill it", name.text),
                    )
                    .with_help("a record fills such an interface: `record Name : Interface { … }`"),
            }
        } else {
            let misfit = elders
                .iter()
                .flat_map(|level| &level.block.items)
                .find_map(|item| {
                    let stands = matches!(&item.kind, ItemKind::Binding(b) if is_parameter(b));
                    // the rows of a table are elements, and a component is several
                    let has_summary =
                        matches!(&item.kind, ItemKind::Binding(b) if b.summary.is_some());
                    if kind == Kind::Component && has_summary {
                        return Some((item, "a summary"));
                    }
                    let (what, _) = placing(kind, &item.kind).filter(|_| !stands)?;
                    Some((item, what))
                });
            match misfit {
                Some((item, what)) => message
                    .at(name.span, format!("{kind_name} cannot have {what}"))
                    .also(item_place(item), "the interface has it here"),
                None => return true,
            }
        };
        self.report(message);
        false
    }

    /// Reports a lint that has the name of a lint of an interface.
    fn lints_once(&mut self, levels: &[Level<'p>]) {
        let mut known: Vec<(DefinitionId, &'p Name)> = Vec::new();
        for level in levels {
            for item in &level.block.items {
                let ItemKind::Statement(Statement::Require {
                    name: Some(name), ..
                }) = &item.kind
                else {
                    continue;
                };
                let elder = known
                    .iter()
                    .find(|(home, elder)| *home != level.definition && elder.text == name.text);
                if let Some((_, first)) = elder {
                    let first = first.span;
                    self.defined_twice(&name.text, name.span, first);
                }
                known.push((level.definition, name));
            }
        }
    }

    /// Checks the parameter or output that an interface requires.
    fn bound_as_asked(
        &mut self,
        id: DefinitionId,
        declaration: &'p Declaration,
        level: Level<'p>,
        asked: &'p Binding,
    ) {
        let Some(owned) = self.owned_member(id, &asked.name.text) else {
            return;
        };
        if owned.home != level.definition {
            return self.as_promised(declaration, level.definition, asked, owned);
        }
        // a parameter need not be repeated, and an interface leaves the items that it requires to its classes
        if is_parameter(asked) || asked.value.is_some() || declaration.kind == Kind::Interface {
            return;
        }
        let text = self.promise_text(asked);
        self.lacking(
            id,
            declaration,
            level,
            &asked.name,
            &format!("output `{text}`"),
        );
    }

    /// Reports an output or function that a class does not give.
    fn lacking(
        &mut self,
        id: DefinitionId,
        declaration: &Declaration,
        level: Level<'p>,
        asked: &Name,
        what: &str,
    ) {
        // a member of another kind with this name was reported
        let own = self.own_members(id);
        if own.iter().any(|(name, _)| name.text == asked.text) {
            return;
        }
        let (class, interface) = (&declaration.name, &level.declaration.name.text);
        let word = what.split(' ').next().unwrap_or_default();
        self.report(
            Diagnostic::error(
                codes::INTERFACE,
                format!("`{}` lacks the {what} of `{interface}`", class.text),
            )
            .at(class.span, format!("no {word} `{}`", asked.text))
            .also(asked.span, "promised here")
            .with_help(format!(
                "a class of `{interface}` gives its {word}s the names of the interface, because other texts read these names"
            )),
        );
    }

    /// Checks the function that an interface requires: the parameters and their types, and the value.
    fn function_as_asked(
        &mut self,
        id: DefinitionId,
        declaration: &'p Declaration,
        level: Level<'p>,
        asked: &'p Function,
    ) {
        let name = &asked.name;
        let text = self.sources.text(function_head(asked)).to_owned();
        let Some(OwnedMember {
            home,
            member: Member::Function(own),
        }) = self.owned_member(id, &name.text)
        else {
            return;
        };
        if home == level.definition {
            if declaration.kind != Kind::Interface {
                self.lacking(id, declaration, level, name, &format!("function `{text}`"));
            }
            return;
        }
        let wanted = self.function(&Scope::of(level.definition), asked);
        let given = self.function(&Scope::of(home), own);
        let fault = if !own.generics.is_empty() {
            Some((own.name.span, "it has dimension variables".to_owned()))
        } else if own.result.is_none() && !own.bound {
            Some((
                own.name.span,
                "it does not state the type of its value".to_owned(),
            ))
        } else {
            self.other_parameters(&wanted, &given, asked, own)
                .or_else(|| {
                    let fits = self.assignable(&given.result, &wanted.result);
                    let place = own.result.as_ref().map_or(own.name.span, |ty| ty.span);
                    let unknown = given.result.is_error() || wanted.result.is_error();
                    (!fits && !unknown).then(|| {
                        let found = self.describe(&given.result);
                        (place, format!("its value is {found}"))
                    })
                })
        };
        if let Some((place, fault)) = fault {
            let (class, interface) = (&declaration.name.text, &level.declaration.name.text);
            self.report(
                Diagnostic::error(
                    codes::INTERFACE,
                    format!(
                        "the function `{}` of `{class}` differs from that of `{interface}`",
                        name.text
                    ),
                )
                .at(place, fault)
                .also(function_head(asked), "required here")
                .with_help(format!("write `fn {text} = …`")),
            );
        }
    }

    /// The first parameter in which a function differs from the one that is asked for. The function may have
    /// more parameters, with defaults.
    fn other_parameters(
        &self,
        wanted: &Signature,
        given: &Signature,
        asked: &Function,
        own: &Function,
    ) -> Option<(Span, String)> {
        for (index, due) in wanted.parameters.iter().enumerate() {
            let types = asked.parameters.get(index).zip(own.parameters.get(index));
            let narrower = types.is_some_and(|(asked, own)| self.narrower(&own.ty, &asked.ty));
            let Some(found) = given.parameters.get(index) else {
                return Some((
                    own.name.span,
                    format!("it lacks the parameter `{}`", due.name),
                ));
            };
            let fault = if found.name != due.name {
                format!("it has `{}` in the place of `{}`", found.name, due.name)
            } else if !self.assignable(&due.ty, &found.ty)
                && !due.ty.is_error()
                && !found.ty.is_error()
            {
                format!("`{}` is {}", found.name, self.describe(&found.ty))
            } else if narrower {
                format!(
                    "`{}` has a fixed length, but the interface takes any length",
                    found.name
                )
            } else if due.optional && !found.optional {
                format!(
                    "`{}` has no default, and calls may leave it out",
                    found.name
                )
            } else {
                continue;
            };
            return Some((found.span, fault));
        }
        let more = given.parameters.iter().skip(wanted.parameters.len());
        let required = more.into_iter().find(|parameter| !parameter.optional)?;
        Some((
            required.span,
            format!(
                "it has one more parameter, `{}`, without a default",
                required.name
            ),
        ))
    }

    /// Whether a type states the length of an array where another type takes any length.
    fn narrower(&self, own: &TypeExpr, wanted: &TypeExpr) -> bool {
        let any = |ty: &TypeExpr| {
            let length = word_of_length(ty);
            length.is_some_and(|(_, place)| self.findings.lengths.contains(&place))
        };
        any(wanted) && !any(own)
    }

    /// `radial_clearance: Length`.
    fn promise_text(&self, promise: &Binding) -> String {
        let name = &promise.name.text;
        match &promise.ty {
            Some(ty) => format!("{name}: {}", self.sources.text(ty.span)),
            None => name.clone(),
        }
    }

    /// Reports a difference between a member and its promise.
    fn as_promised(
        &mut self,
        declaration: &Declaration,
        interface: DefinitionId,
        promise: &'p Binding,
        owned: OwnedMember<'p>,
    ) {
        let (home, own) = (owned.home, owned.member);
        let name = &promise.name.text;
        let wanted = Member::Binding(promise);
        let wanted_type = self.member_type(interface, name, wanted, promise.name.span);
        let own_span = own.span().unwrap_or(declaration.name.span);
        let own_type = self.member_type(home, name, own, own_span);
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
                    format!("`{interface}` states {wanted_text}"),
                ),
            );
            return;
        }
        let ty = match own {
            Member::Parameter(parameter) => Some(&parameter.ty),
            Member::Binding(binding) => binding.ty.as_ref(),
            _ => None,
        };
        if let (Some(ty), Some(wanted)) = (ty, &promise.ty)
            && self.narrower(ty, wanted)
        {
            let promised = self.promise_text(promise);
            self.report(
                Diagnostic::error(
                    codes::INTERFACE,
                    format!("the {word} `{name}` of `{class}` has a fixed length, but `{interface}` takes any length"),
                )
                .at(ty.span, "arrays of another length do not fit")
                .also(promise.name.span, "the argument decides the length here")
                .with_help(format!("write `{promised}`")),
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
                format!("`{interface}` states `in {due}`"),
            )
            .with_help(format!(
                "write `output {name} = … in {due}`: figures and tables read it so"
            ));
            self.report(message);
        }
    }

    /// Whether a class is not a journal, or a journal that fills the interface of films. Reports a journal
    /// that does not declare this interface.
    fn is_film(&mut self, id: DefinitionId, declaration: &Declaration) -> bool {
        let Some(law) = self.program.journal_law() else {
            return true;
        };
        if declaration.kind != Kind::Journal || self.program.fills(id, law) {
            return true;
        }
        let Name { text, span } = &declaration.name;
        let mut lacking = Vec::new();
        for level in levels(self.program, law) {
            for item in level.block.items.iter().filter(|item| asks(&item.kind)) {
                if let ItemKind::Binding(asked) = &item.kind
                    && !self.named_alike(id, asked)
                {
                    lacking.push(self.promise_text(asked));
                }
            }
        }
        let (module, name) = JOURNAL_LAW;
        let message = if lacking.is_empty() {
            Diagnostic::error(
                codes::NO_FILM,
                format!("the journal `{text}` does not state that it fills `{name}`"),
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
                "tables, orbits and the start read these items of every journal",
            )
        };
        let message = message.with_each(self.program.interface_of(id), |message, other| {
            message.with_note(format!(
                "it fills `{}`, which is another interface",
                self.class_name(other)
            ))
        });
        self.report(message.with_help(format!(
            "give parameters and outputs these names and write `: {name}` after the parameters, with `use {module}.{name}`; an element without a film is a `force`"
        )));
        false
    }

    /// Whether a class has a parameter or output of this name.
    fn named_alike(&mut self, class: DefinitionId, asked: &Binding) -> bool {
        match (asked.kind, self.member(class, &asked.name.text)) {
            (_, None) => false,
            (BindingKind::Output, Some(Member::Binding(b))) => b.kind == BindingKind::Output,
            (BindingKind::Output, Some(own)) => matches!(own, Member::Reaction(_)),
            (_, Some(own)) => matches!(own, Member::Parameter(_)),
        }
    }
}

fn word(promise: &Binding) -> &'static str {
    match promise.kind {
        BindingKind::Output => "output",
        _ => "parameter",
    }
}

/// `response(film: Attitude) -> Vector2<1>`, the head of a function.
fn function_head(function: &Function) -> Span {
    let last = function.parameters.last().map(|parameter| parameter.span);
    let end = function.result.as_ref().map(|ty| ty.span).or(last);
    end.map_or(function.name.span, |end| function.name.span.to(end))
}
