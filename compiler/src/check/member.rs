//! The named members of a definition and of its interfaces.

use super::Checker;
use super::scope::{BUILT_IN_NAMES, Scope};
use crate::codes;
use crate::program::DefinitionId;
use crate::resolve::suggest::nearest;
use crate::typed::lineage::{is_parameter, word_of_length};
use eng_grammar::ast::{
    Binding, BindingKind, Declaration, Form, Function, ItemKind, Kind, Name, Parameter, Statement,
    Table,
};
use eng_grammar::{Diagnostic, Span};
use std::collections::BTreeMap;
use std::rc::Rc;

/// A named member of a definition.
#[derive(Clone, Copy)]
pub(super) enum Member<'p> {
    Parameter(&'p Parameter),
    Binding(&'p Binding),
    Function(&'p Function),
    Table(&'p Table),
    /// A body, marker, element, part or cycle.
    Declaration(&'p Declaration),
    /// The reaction of a joint or drive; `true` for the torque.
    Reaction(bool),
    /// The length of an array that the argument decides, by its place.
    Length(Span),
}

impl Member<'_> {
    pub(super) fn span(&self) -> Option<Span> {
        match self {
            Member::Parameter(parameter) => Some(parameter.name.span),
            Member::Binding(binding) => Some(binding.name.span),
            Member::Function(function) => Some(function.name.span),
            Member::Table(table) => Some(table.name.span),
            Member::Declaration(declaration) => Some(declaration.name.span),
            Member::Reaction(_) => None,
            Member::Length(span) => Some(*span),
        }
    }
}

/// A member with the definition whose text has it: the class itself or one of its interfaces.
#[derive(Clone, Copy)]
pub(super) struct OwnedMember<'p> {
    pub(super) home: DefinitionId,
    pub(super) member: Member<'p>,
}

/// The named members of a definition, with those of its interfaces.
pub(super) struct ClassTable<'p> {
    pub(super) members: BTreeMap<&'p str, OwnedMember<'p>>,
}

impl<'p> Checker<'p> {
    /// The members of a definition and of its interfaces. If an interface only requires a member, the table has the
    /// member of the class. Making the table reports repeated names.
    pub(super) fn class_table(&mut self, id: DefinitionId) -> Rc<ClassTable<'p>> {
        if let Some(table) = self.tables.get(&id) {
            return table.clone();
        }
        let mut members: BTreeMap<&'p str, OwnedMember<'p>> = BTreeMap::new();
        for home in self.program.lineage(id) {
            let kind = self.declaration(home).map(|declaration| declaration.kind);
            // a class may give its own value of an output that its interface computes
            let anew = |own: Member<'p>, elder: Member<'p>| {
                kind != Some(Kind::Interface) && is_output(own) && is_output(elder)
            };
            let own = self.own_members(home);
            let counted = self.counted_members(home, &own, &members);
            let own = own
                .into_iter()
                .map(|(name, member)| (&name.text, name.span, member));
            for (name, place, member) in own.chain(counted) {
                let elder = members.get(name.as_str()).copied();
                if elder.is_none_or(|elder| {
                    elder.home != home
                        && (gives(member, elder.member) || anew(member, elder.member))
                }) {
                    members.insert(name, OwnedMember { home, member });
                } else if let Some(elder) = elder {
                    self.named_before(home, name, place, elder);
                }
            }
        }
        if self
            .declaration(id)
            .is_some_and(|d| matches!(d.kind, Kind::Joint | Kind::Drive))
        {
            for (name, torque) in [("force", false), ("torque", true)] {
                let reaction = Member::Reaction(torque);
                // a reaction is the output that an interface requires
                if members.get(name).is_none_or(|owned| is_asked(owned.member)) {
                    let owned = OwnedMember {
                        home: id,
                        member: reaction,
                    };
                    members.insert(name, owned);
                }
            }
        }
        self.reactions_are_taken(id, &members);
        let table = Rc::new(ClassTable { members });
        self.tables.insert(id, table.clone());
        table
    }

    /// The members in the text of a definition, in their order.
    pub(super) fn own_members(&self, id: DefinitionId) -> Vec<(&'p Name, Member<'p>)> {
        let mut found = Vec::new();
        let Some(declaration) = self.declaration(id) else {
            return found;
        };
        if let Form::Class { parameters, .. } = &declaration.form {
            let parameters = parameters.iter();
            found.extend(parameters.map(|p| (&p.name, Member::Parameter(p))));
        }
        for item in declaration.block().into_iter().flat_map(|b| &b.items) {
            match &item.kind {
                ItemKind::Binding(binding) => {
                    found.push((&binding.name, Member::Binding(binding)));
                }
                ItemKind::Function(function) => {
                    found.push((&function.name, Member::Function(function)));
                }
                ItemKind::Table(table) => found.push((&table.name, Member::Table(table))),
                ItemKind::Declaration(inner) if inner.kind != Kind::Cycle => {
                    found.push((&inner.name, Member::Declaration(inner)));
                }
                _ => {}
            }
        }
        found
    }

    /// The lengths that the arguments of a class decide: words in the types of its parameters that nothing
    /// else names. A word that is nearly the name of a count is a misspelt one.
    fn counted_members(
        &mut self,
        id: DefinitionId,
        own: &[(&'p Name, Member<'p>)],
        elder: &BTreeMap<&'p str, OwnedMember<'p>>,
    ) -> Vec<(&'p String, Span, Member<'p>)> {
        let mut found: Vec<(&'p String, Span, Member<'p>)> = Vec::new();
        for (_, member) in own {
            let ty = match member {
                Member::Parameter(parameter) => Some(&parameter.ty),
                Member::Binding(binding) if is_parameter(binding) => binding.ty.as_ref(),
                _ => None,
            };
            let Some((word, span)) = ty.and_then(word_of_length) else {
                continue;
            };
            // the length of an array of an interface is that of the class, too
            if matches!(elder.get(word.as_str()), Some(owned) if matches!(owned.member, Member::Length(_)))
            {
                self.findings.lengths.insert(span);
                continue;
            }
            let mut names = own.iter().map(|(name, _)| name.text.as_str());
            let counts = own.iter().filter(|(_, member)| is_count(*member));
            let known = self.program.lookup(id.module, word).is_some()
                || BUILT_IN_NAMES.contains(&word.as_str())
                || names.any(|name| name == word)
                || elder.contains_key(word.as_str())
                || nearest(word, counts.map(|(name, _)| name.text.as_str())).is_some();
            if known {
                continue;
            }
            self.findings.lengths.insert(span);
            if found.iter().all(|(name, ..)| *name != word) {
                found.push((word, span, Member::Length(span)));
            }
        }
        found
    }

    /// Reports a name that the definition or one of its interfaces has already.
    fn named_before(
        &mut self,
        home: DefinitionId,
        name: &str,
        place: Span,
        elder: OwnedMember<'p>,
    ) {
        let Some(first) = elder.member.span() else {
            return;
        };
        if elder.home == home {
            return self.defined_twice(name, place, first);
        }
        let (class, interface) = (self.class_name(home), self.class_name(elder.home));
        let (text, message) = (
            name,
            Diagnostic::error(
                codes::REPLACED,
                format!(
                    "`{}` of `{class}` is in its interface `{interface}` already",
                    name
                ),
            )
            .at(place, "again here"),
        );
        let message = if is_asked(elder.member) {
            message
                .also(first, "used here as something else")
                .with_help(format!(
                    "state the item that `{interface}` requires: {}",
                    kind_of(elder.member)
                ))
        } else {
            message
                .also(first, "it has its value here")
                .with_help(format!(
                    "a class adds to its interface and replaces nothing: give `{text}` another name, or remove it"
                ))
        };
        self.report(message);
    }

    /// Refuses members of joints and drives called `force` or `torque`: these names are their reactions.
    fn reactions_are_taken(
        &mut self,
        id: DefinitionId,
        members: &BTreeMap<&'p str, OwnedMember<'p>>,
    ) {
        let Some(declaration) = self.declaration(id) else {
            return;
        };
        let levels = crate::typed::lineage::levels(self.program, id);
        let constrains = levels
            .iter()
            .flat_map(|level| &level.block.items)
            .any(|item| matches!(item.kind, ItemKind::Statement(Statement::Constrain(_))));
        if !constrains || !matches!(declaration.kind, Kind::Joint | Kind::Drive) {
            return;
        }
        for name in ["force", "torque"] {
            let Some(own) = members.get(name).and_then(|owned| owned.member.span()) else {
                continue;
            };
            let word = super::describe::with_article(super::describe::kind_word(declaration.kind));
            self.report(
                Diagnostic::error(
                    codes::DEFINED_TWICE,
                    format!("`{name}` of {word} is the reaction of its constraints"),
                )
                .at(own, "another one")
                .with_note(
                    "every joint and drive that constrains has the outputs `force` and `torque`: the wrench on its first marker, in the second's axes",
                )
                .with_help(format!("give this a name of its own, such as `own_{name}`")),
            );
        }
    }

    pub(super) fn defined_twice(&mut self, name: &str, again: Span, first: Span) {
        self.report(
            Diagnostic::error(codes::DEFINED_TWICE, format!("`{name}` is defined twice"))
                .at(again, "again here")
                .also(first, "first here")
                .with_help("every name has one meaning in a definition: rename one of them"),
        );
    }

    /// Refuses a name that an index, a parameter or a `let` around it has already.
    pub(super) fn not_local(&mut self, scope: &Scope<'p>, name: &Name) {
        if let Some((first, _)) = scope.local(&name.text) {
            self.defined_twice(&name.text, name.span, first.span);
        }
    }

    /// Refuses an index with the name of an item of the definition around it.
    pub(super) fn not_member(&mut self, scope: &Scope<'p>, name: &Name) {
        for definition in [scope.at_use, scope.definition].into_iter().flatten() {
            let owned = self.owned_member(definition, &name.text);
            if let Some(first) = owned.and_then(|owned| owned.member.span()) {
                self.defined_twice(&name.text, name.span, first);
                return;
            }
        }
    }

    pub(super) fn member(&mut self, id: DefinitionId, name: &str) -> Option<Member<'p>> {
        self.owned_member(id, name).map(|owned| owned.member)
    }

    /// A member with the definition whose text has it.
    pub(super) fn owned_member(&mut self, id: DefinitionId, name: &str) -> Option<OwnedMember<'p>> {
        self.class_table(id).members.get(name).copied()
    }
}

/// Whether an interface only requires a member.
pub(super) fn is_asked(member: Member<'_>) -> bool {
    match member {
        Member::Binding(binding) => binding.value.is_none(),
        Member::Function(function) => function.value.is_none(),
        _ => false,
    }
}

/// Whether a member gives an item for which its interface asks. Their types are compared later.
fn gives(own: Member<'_>, elder: Member<'_>) -> bool {
    let given_by_use = |member: Member<'_>| match member {
        Member::Parameter(_) => true,
        Member::Binding(binding) => is_parameter(binding),
        _ => false,
    };
    is_asked(elder)
        && match elder {
            Member::Function(_) => matches!(own, Member::Function(_)),
            elder if given_by_use(elder) => given_by_use(own),
            elder => is_output(elder) && is_output(own),
        }
}

fn is_output(member: Member<'_>) -> bool {
    matches!(member, Member::Binding(binding) if binding.kind == BindingKind::Output)
}

/// Whether a member is a whole number by its declared type.
fn is_count(member: Member<'_>) -> bool {
    let ty = match member {
        Member::Parameter(parameter) => Some(&parameter.ty),
        Member::Binding(binding) => binding.ty.as_ref(),
        _ => None,
    };
    ty.is_some_and(crate::typed::lineage::is_int)
}

/// The kind of a member, for a message.
fn kind_of(member: Member<'_>) -> &'static str {
    match member {
        Member::Function(_) => "a function",
        Member::Binding(binding) if binding.kind == BindingKind::Output => "an output",
        _ => "a parameter",
    }
}
