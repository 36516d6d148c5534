//! The meaning of a name at a place.
//!
//! The search proceeds from inside out: binders and function parameters; markers of the surrounding body;
//! names of the class in whose use the block is; members of the surrounding definition; names of the module;
//! names of the language.

use super::body::states;
use super::member::{Member, OwnedMember};
use super::types::{BodyRef, Quantity, Type};
use super::{Checker, Progress};
use crate::codes;
use crate::program::{DefinitionId, interface_name};
use crate::resolve::suggest::{EXPLAINED, nearest};
use eng_grammar::ast::{BindingKind, Declaration, Form, ItemKind, Kind, Name};
use eng_grammar::{Diagnostic, Span};
use eng_system::Dimension;

/// The surroundings of a place that decide the meaning of names.
#[derive(Clone)]
pub(super) struct Scope<'p> {
    pub(super) module: u32,
    /// The surrounding model, class, component, interface or record.
    pub(super) definition: Option<DefinitionId>,
    /// The surrounding body.
    pub(super) body: Option<&'p Declaration>,
    /// The class in whose use the surrounding block is.
    pub(super) at_use: Option<DefinitionId>,
    /// Binders and function parameters, innermost last.
    pub(super) locals: Vec<(Name, Type)>,
    /// Dimension variables.
    pub(super) generics: Vec<(String, u32)>,
    /// Whether the place is inside an output.
    pub(super) output: bool,
}

/// The meaning found for a name.
pub(super) enum Found<'p> {
    Local(Type),
    BodyMarker(&'p Declaration),
    Member(DefinitionId, Member<'p>),
    Top(DefinitionId),
}

impl<'p> Scope<'p> {
    pub(super) fn top(module: u32) -> Scope<'p> {
        Scope {
            module,
            definition: None,
            body: None,
            at_use: None,
            locals: Vec::new(),
            generics: Vec::new(),
            output: false,
        }
    }

    pub(super) fn of(definition: DefinitionId) -> Scope<'p> {
        Scope {
            definition: Some(definition),
            ..Scope::top(definition.module)
        }
    }

    /// A binder or function parameter.
    pub(super) fn local(&self, name: &str) -> Option<&(Name, Type)> {
        self.locals.iter().rev().find(|(n, _)| n.text == name)
    }
}

/// Names of the language itself.
pub(super) const BUILT_IN_NAMES: [&str; 4] = ["pi", "time", "ground", "cycle"];

/// Truth values, also as other languages write them (`True`).
const BOOLEANS: [&str; 2] = ["true", "false"];

impl<'p> Checker<'p> {
    pub(super) fn declaration(&self, id: DefinitionId) -> Option<&'p Declaration> {
        self.program.declaration(id)
    }

    /// The meaning of a name, without the names of the language.
    pub(super) fn find(&mut self, scope: &Scope<'p>, name: &str) -> Option<Found<'p>> {
        if let Some((_, ty)) = scope.local(name) {
            self.read_locals.insert(name.to_owned());
            return Some(Found::Local(ty.clone()));
        }
        if let Some(marker) = scope.body.and_then(|body| marker_of(body, name)) {
            return Some(Found::BodyMarker(marker));
        }
        for definition in [scope.at_use, scope.definition].into_iter().flatten() {
            if let Some(OwnedMember { home, member }) = self.owned_member(definition, name) {
                self.used.insert((home, name.to_owned()));
                return Some(Found::Member(home, member));
            }
        }
        self.find_top(scope.module, name).map(Found::Top)
    }

    /// A top-level name.
    pub(super) fn find_top(&mut self, module: u32, name: &str) -> Option<DefinitionId> {
        let id = self.program.lookup(module, name)?;
        self.used_top.insert((module, id));
        Some(id)
    }

    /// The type of a name.
    pub(super) fn name(&mut self, scope: &Scope<'p>, name: &str, span: Span) -> Type {
        // In a body's block `mass` is a name, so that the inertia can use it.
        let local = scope.local(name).is_some();
        if name == "mass" && !local && scope.body.is_some_and(has_mass) {
            // `mass = mass` reads a parameter of this name
            self.find(scope, name);
            return Type::Scalar(Quantity::hard(Dimension::MASS));
        }
        if let Some(word) = self.due_word(name, span) {
            return word;
        }
        if let Some(found) = self.find(scope, name) {
            return match found {
                Found::Local(ty) => ty,
                Found::BodyMarker(marker) => self.arrayed(&marker.index, Type::Marker),
                Found::Member(definition, member) => {
                    self.member_type(definition, name, member, span)
                }
                Found::Top(id) => self.top_type(id, span),
            };
        }
        match name {
            "pi" => return Type::one(),
            "time" => {
                if scope.definition.is_none() && scope.at_use.is_none() {
                    self.report(
                        Diagnostic::error(
                            codes::MISPLACED,
                            "there is no time at the top of a file",
                        )
                        .at(span, "only classes and models may read it"),
                    );
                    return Type::Error;
                }
                return Type::Scalar(Quantity::hard(Dimension::TIME));
            }
            "ground" => return Type::Marker,
            "cycle" => return Type::Cycle,
            // Every body has the marker `origin`. Outside a body the name is a member of markers.
            "origin" if scope.body.is_some() => return Type::Marker,
            _ => {}
        }
        match self.choice_due {
            Some(choice) => self.no_word_of_choice(choice, name, span),
            None => self.unknown_name(scope, name, span),
        }
        Type::Error
    }

    /// Whether a definition or its interface names an interface that it cannot have. Some of its names are not
    /// known.
    pub(super) fn lacks_interface(&self, definition: Option<DefinitionId>) -> bool {
        let eldest = definition.and_then(|id| self.program.lineage(id).first().copied());
        let eldest = eldest.and_then(|eldest| self.declaration(eldest));
        eldest.and_then(interface_name).is_some()
    }

    fn unknown_name(&mut self, scope: &Scope<'p>, name: &str, span: Span) {
        // the message about the interface is enough: the name may be one of the interface
        if self.lacks_interface(scope.definition) {
            return;
        }
        // nobody reads a hundred suggestions, and each costs a comparison with all names
        if self.diagnostics.len() > EXPLAINED {
            let message =
                Diagnostic::error(codes::UNKNOWN_NAME, format!("there is no `{name}` here"));
            return self.report(message.at(span, "not known"));
        }
        let mut known: Vec<String> = scope.locals.iter().map(|(n, _)| n.text.clone()).collect();
        for definition in [scope.at_use, scope.definition].into_iter().flatten() {
            let table = self.class_table(definition);
            known.extend(table.members.keys().map(|n| (*n).to_owned()));
        }
        if let Some(module) = self.program.modules.get(scope.module as usize) {
            known.extend(
                module
                    .scope
                    .iter()
                    .filter(|(_, id)| {
                        !matches!(
                            self.program.item(**id).map(|item| &item.kind),
                            Some(ItemKind::Dimension(_))
                        )
                    })
                    .map(|(n, _)| n.clone()),
            );
        }
        known.extend(BUILT_IN_NAMES.iter().map(|n| (*n).to_owned()));
        known.extend(crate::functions::names().map(str::to_owned));
        let is_unit = self.program.units.contains_key(name)
            && crate::functions::find(name).is_none()
            && self.choice_with(scope.module, name).is_none()
            && self.module_of(name).is_none();
        if is_unit {
            return self.report(
                Diagnostic::error(
                    codes::UNKNOWN_NAME,
                    format!("`{name}` is a unit, and here a value is expected"),
                )
                .at(span, "no value has this name")
                .with_help(format!(
                    "a unit follows a number, a list or a parenthesis: `1 {name}`; `… as {name}` shows a value in it"
                )),
            );
        }
        let mut message =
            Diagnostic::error(codes::UNKNOWN_NAME, format!("there is no `{name}` here"))
                .at(span, "not known");
        let filling = scope.definition.and_then(|id| self.filling_with(id, name));
        let changed = self
            .changed
            .filter(|id| self.owned_member(*id, name).is_some());
        if let Some(class) = changed {
            message = message.with_help(format!(
                "`{}` has it, but a value after `with` belongs to the text around the part, as an argument does",
                self.class_name(class)
            ));
        } else if let Some(class) = filling {
            message = message.with_help(format!(
                "`{class}` has it, but an interface sees only its own names: declare `param {name}: …` in the interface, or a function without a body that each class gives"
            ));
        } else if let Some(choice) = self.choice_with(scope.module, name) {
            message = message.with_help(format!(
                "`{name}` is a word of the choice `{choice}`, which is not expected here: write `{choice}.{name}`"
            ));
        } else if let Some(path) = self.module_of(name) {
            message = self.offer_use(message, scope.module, &path, name);
        } else if crate::functions::find(name).is_some() {
            message = message.with_help(format!(
                "call this function of the language, `{name}(…)`; to pass it on, define one of your own: `fn own(…) = {name}(…)`"
            ));
        } else if let Some(word) = BOOLEANS.iter().find(|word| word.eq_ignore_ascii_case(name)) {
            message = message.meant(span, (*word).to_owned());
        } else if let Some(near) = nearest(name, known.iter().map(String::as_str)) {
            message = message.meant(span, near);
        } else if let Some((near, path)) =
            nearest(name, self.program.offered.keys().map(String::as_str))
                .and_then(|near| Some((near, self.program.offered.get(near)?)))
        {
            message = message.with_help(format!("did you mean `{near}` of `{}`?", path.module));
        }
        self.report(message);
    }

    /// A class that fills an interface and has a name that the interface lacks.
    fn filling_with(&mut self, interface: DefinitionId, name: &str) -> Option<String> {
        if self.declaration(interface)?.kind != Kind::Interface {
            return None;
        }
        let modules = self.program.modules.iter().enumerate();
        let all = modules.flat_map(|(module, m)| {
            (0..m.file.items.len()).map(move |item| DefinitionId {
                module: module as u32,
                item: item as u32,
            })
        });
        let fills = |id: &DefinitionId| *id != interface && self.program.fills(*id, interface);
        let filling: Vec<DefinitionId> = all.filter(fills).collect();
        let mut filling = filling.into_iter();
        let class = filling.find(|id| self.owned_member(*id, name).is_some())?;
        Some(self.class_name(class))
    }

    /// The module that defines an unknown name.
    pub(super) fn module_of(&self, name: &str) -> Option<String> {
        let elsewhere = self.program.modules.iter().find(|module| {
            module.file.items.iter().any(|item| {
                crate::resolve::defined_name(&item.kind).is_some_and(|n| n.text == name)
            })
        });
        elsewhere
            .map(|module| module.path.clone())
            .or_else(|| self.program.offered.get(name).map(|o| o.module.clone()))
    }

    /// Offers a `use` item for a name of a module.
    pub(super) fn offer_use(
        &self,
        message: Diagnostic,
        module: u32,
        path: &str,
        name: &str,
    ) -> Diagnostic {
        let message = message.with_help(format!("`{path}` has it: `use {path}.{name}`"));
        let first = self
            .program
            .modules
            .get(module as usize)
            .and_then(|m| m.file.items.first());
        match first {
            Some(item) => {
                let start = item.span.start as usize;
                let place = Span::new(item.span.source, start, start);
                message.with_fix("take it from there", place, format!("use {path}.{name}\n"))
            }
            None => message,
        }
    }

    /// The type of a top-level item.
    pub(super) fn top_type(&mut self, id: DefinitionId, span: Span) -> Type {
        let Some(item) = self.program.item(id) else {
            return Type::Error;
        };
        match &item.kind {
            ItemKind::Binding(_) => {
                self.used.insert((id, String::new()));
                self.top_value(id)
            }
            ItemKind::Function(function) => {
                Type::Function(self.function(&Scope::top(id.module), function))
            }
            ItemKind::Table(table) => Type::Function(self.table(&Scope::top(id.module), table)),
            ItemKind::Declaration(declaration) => match declaration.kind {
                Kind::Analysis | Kind::Default | Kind::Flexible => {
                    self.report(
                        Diagnostic::error(
                            codes::WRONG_TYPE,
                            format!("`{}` is no value", declaration.name.text),
                        )
                        .at(span, "a value is expected here")
                        .also(declaration.name.span, "defined here"),
                    );
                    Type::Error
                }
                kind if super::class::is_of_elements(kind)
                    && matches!(declaration.form, Form::Instance { .. }) =>
                {
                    self.remembered(id, "", span, |c| c.bound_by(id.module, declaration))
                }
                _ => Type::Class(id),
            },
            ItemKind::Choice(choice) => {
                let name = &choice.name.text;
                let word = choice.words.first().map_or("word", |word| &word.text);
                self.report(
                    Diagnostic::error(
                        codes::WRONG_TYPE,
                        format!("`{name}` is a choice, not a value"),
                    )
                    .at(span, "a value is expected here")
                    .also(choice.name.span, "defined here")
                    .with_help(format!("state one of its words: `{name}.{word}`")),
                );
                Type::Error
            }
            ItemKind::Report(report) => {
                self.report(
                    Diagnostic::error(
                        codes::WRONG_TYPE,
                        format!("`{}` is a report, not a value", report.name.text),
                    )
                    .at(span, "a value is expected here")
                    .also(report.name.span, "defined here"),
                );
                Type::Error
            }
            ItemKind::Dimension(dimension) => {
                self.report(
                    Diagnostic::error(
                        codes::WRONG_TYPE,
                        format!("`{}` is a dimension, not a value", dimension.name.text),
                    )
                    .at(span, "a value is expected here"),
                );
                Type::Error
            }
            _ => Type::Error,
        }
    }

    /// The type of a top-level `const`, `let` or `param`.
    pub(super) fn top_value(&mut self, id: DefinitionId) -> Type {
        let Some(ItemKind::Binding(binding)) = self.program.item(id).map(|item| &item.kind) else {
            return Type::Error;
        };
        let scope = Scope::top(id.module);
        self.remembered(id, "", binding.name.span, |checker| {
            checker.binding(&scope, binding)
        })
    }

    /// The type of a member, seen from inside the definition whose text has it.
    pub(super) fn member_type(
        &mut self,
        id: DefinitionId,
        name: &str,
        member: Member<'p>,
        span: Span,
    ) -> Type {
        let scope = Scope::of(id);
        match member {
            Member::Parameter(parameter) => {
                self.remembered(id, name, span, |c| c.parameter(&scope, parameter))
            }
            Member::Binding(binding) => {
                self.remembered(id, name, span, |c| c.binding(&scope, binding))
            }
            Member::Function(function) => Type::Function(self.function(&scope, function)),
            Member::Table(table) => Type::Function(self.table(&scope, table)),
            Member::Length(_) => Type::Int,
            Member::Reaction(torque) => Type::Vector {
                quantity: Quantity::hard(if torque {
                    torque_dimension()
                } else {
                    Dimension::FORCE
                }),
                framed: true,
            },
            Member::Declaration(declaration) => match declaration.kind {
                Kind::Body | Kind::Flexible => {
                    let body = Type::Body(Some(BodyRef {
                        definition: id,
                        name: name.to_owned(),
                    }));
                    self.arrayed(&declaration.index, body)
                }
                Kind::Marker => self.arrayed(&declaration.index, Type::Marker),
                Kind::Joint | Kind::Force | Kind::Journal | Kind::Drive | Kind::Part => self
                    .remembered(id, name, span, |c| {
                        let instance = c.element_type(&scope, declaration);
                        c.arrayed(&declaration.index, instance)
                    }),
                _ => Type::Error,
            },
        }
    }

    /// Infers a named value once. A value that depends on itself is an error.
    pub(super) fn remembered(
        &mut self,
        id: DefinitionId,
        name: &str,
        span: Span,
        infer: impl FnOnce(&mut Self) -> Type,
    ) -> Type {
        let key = (id, name.to_owned());
        match self.values.get(&key) {
            Some(Progress::Done(ty)) => return ty.clone(),
            Some(Progress::Open) => {
                self.report(value_circle(span));
                self.values.insert(key, Progress::Done(Type::Error));
                return Type::Error;
            }
            None => {}
        }
        if !self.deeper(span) {
            return Type::Error;
        }
        self.values.insert(key.clone(), Progress::Open);
        self.depth += 1;
        let ty = infer(self);
        self.depth -= 1;
        // If the value is in a circle, the inference has stored an error type meanwhile.
        let ty = match self.values.get(&key) {
            Some(Progress::Done(error)) => error.clone(),
            _ => ty,
        };
        self.values.insert(key, Progress::Done(ty.clone()));
        ty
    }

    /// `T` inside of one list for each binder.
    pub(super) fn arrayed(&self, index: &[eng_grammar::ast::Binder], ty: Type) -> Type {
        index.iter().rev().fold(ty, |ty, binder| {
            // Indices are the values of the binder: `pin[i in 2..4]` has no `pin[1]`.
            let from_one = super::expression::counts_from_one(&binder.range);
            let length = super::expression::literal_length(&binder.range).filter(|_| from_one);
            Type::list(ty, length)
        })
    }

    /// The type of `base.name` for an instance of a class, a part, or a record, seen from outside.
    pub(super) fn field_of_instance(
        &mut self,
        id: DefinitionId,
        name: &Name,
        by_interface: bool,
    ) -> Type {
        let Some(OwnedMember { home, member }) = self.owned_member(id, &name.text) else {
            let table = self.class_table(id);
            let class = self
                .declaration(id)
                .map_or(String::new(), |d| d.name.text.clone());
            let what = if by_interface {
                format!("the interface `{class}` has no `{}`", name.text)
            } else {
                format!("`{class}` has no `{}`", name.text)
            };
            self.no_member(what, name, table.members.keys().copied());
            return Type::Error;
        };
        self.used.insert((home, name.text.clone()));
        let ty = self.member_type(home, &name.text, member, name.span);
        // From outside, an output's vectors have the axes that the class states.
        match (member, ty) {
            (Member::Binding(binding), Type::Vector { quantity, .. })
                if binding.kind == BindingKind::Output =>
            {
                Type::Vector {
                    quantity,
                    framed: true,
                }
            }
            (
                Member::Binding(binding),
                Type::List {
                    element,
                    length,
                    framed,
                },
            ) if binding.kind == BindingKind::Output => {
                let element = match *element {
                    Type::Vector { quantity, .. } => Type::Vector {
                        quantity,
                        framed: true,
                    },
                    other => other,
                };
                Type::List {
                    element: Box::new(element),
                    length,
                    framed,
                }
            }
            (_, ty) => ty,
        }
    }

    pub(super) fn no_member<'a>(
        &mut self,
        title: String,
        name: &Name,
        known: impl IntoIterator<Item = &'a str>,
    ) {
        let known: Vec<&str> = known.into_iter().collect();
        let mut message =
            Diagnostic::error(codes::NO_MEMBER, title).at(name.span, "not among its members");
        if let Some(near) = nearest(&name.text, known.iter().copied()) {
            message = message.meant(name.span, near);
        } else if !known.is_empty() {
            message = message.with_note(format!(
                "it has {}",
                crate::resolve::suggest::listing(known, 12)
            ));
        }
        self.report(message);
    }
}

/// A marker in a body's block.
pub(super) fn marker_of<'p>(body: &'p Declaration, name: &str) -> Option<&'p Declaration> {
    body.block()?
        .items
        .iter()
        .find_map(|item| match &item.kind {
            ItemKind::Declaration(marker)
                if marker.kind == Kind::Marker && marker.name.text == name =>
            {
                Some(marker)
            }
            _ => None,
        })
}

fn has_mass(body: &Declaration) -> bool {
    body.kind == Kind::Body && states(body, "mass")
}

/// The message about a value that depends on itself.
pub(super) fn value_circle(span: Span) -> Diagnostic {
    Diagnostic::error(codes::VALUE_CIRCLE, "values are defined by each other")
        .at(span, "this value depends on itself")
        .with_help("the order of items does not matter, but no value may follow from itself")
}

/// N m.
pub(super) fn torque_dimension() -> Dimension {
    Dimension::FORCE.times(Dimension::LENGTH)
}
