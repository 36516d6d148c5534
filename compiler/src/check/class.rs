//! Definitions (models, components, classes, interfaces, records) and the uses of classes in them.

use super::Checker;
use super::describe::{kind_word, with_article};
use super::scope::Scope;
use super::types::Type;
use crate::codes;
use crate::program::DefinitionId;
use crate::resolve::suggest::nearest;
use eng_grammar::ast::{
    BindingKind, Declaration, Expr, ExprKind, Form, Item, ItemKind, Kind, Name, Statement,
};
use eng_grammar::{Diagnostic, Span};

/// The definition around an item, by the properties on which the permitted items depend.
#[derive(Clone, Copy)]
struct Holder {
    /// A model or a component.
    parts: bool,
    /// A class of elements, or an interface. An interface may have the items of any class. Another check decides
    /// which kind of class can fill it.
    class: bool,
    /// May restrict motions.
    constrains: bool,
    record: bool,
    interface: bool,
}

/// Whether an item may be in a definition, its name in messages, and advice.
type Placing = (bool, &'static str, &'static str);

const ANYWHERE: Placing = (true, "", "");
const AT_THE_TOP: &str = "it belongs at the top of the file";

/// The name of an item in messages if the item must not be in a definition of this kind, with advice.
pub(super) fn placing(kind: Kind, item: &ItemKind) -> Option<(&'static str, &'static str)> {
    let interface = kind == Kind::Interface;
    let elements = matches!(
        kind,
        Kind::Joint | Kind::Force | Kind::Journal | Kind::Drive
    );
    let holder = Holder {
        parts: matches!(kind, Kind::Model | Kind::Component),
        class: elements || interface,
        constrains: matches!(kind, Kind::Joint | Kind::Drive) || interface,
        record: kind == Kind::Record,
        interface,
    };
    let (allowed, what, help) = match item {
        ItemKind::Error | ItemKind::Function(_) => ANYWHERE,
        ItemKind::Use(_) => (false, "a `use`", AT_THE_TOP),
        ItemKind::Dimension(_) | ItemKind::Unit(_) => (false, "a dimension or unit", AT_THE_TOP),
        ItemKind::Choice(_) => (false, "a choice", AT_THE_TOP),
        ItemKind::Table(_) => (
            holder.parts || holder.class,
            "a table",
            "it belongs in a model or a class, or at the top of the file",
        ),
        ItemKind::Binding(binding) => placing_of_binding(holder, binding.kind),
        ItemKind::Report(_) => (false, "a report", AT_THE_TOP),
        ItemKind::Entry(_) => (
            false,
            "a figure or value of results",
            "it belongs in a `report`; a recorded quantity is an `output`",
        ),
        ItemKind::Attribute(_) => (holder.parts, "an attribute", "a named value is a `let`"),
        ItemKind::Statement(statement) => placing_of_statement(holder, statement),
        ItemKind::Declaration(declaration) => placing_of_declaration(holder, declaration),
    };
    (!allowed).then_some((what, help))
}

fn placing_of_binding(holder: Holder, kind: BindingKind) -> Placing {
    const OF_RECORDS: &str = "the values of a record are its `let`s";
    match kind {
        BindingKind::Const => (!holder.record, "a `const`", OF_RECORDS),
        BindingKind::Param => (
            holder.parts || holder.interface,
            "a `param`",
            if holder.record {
                OF_RECORDS
            } else {
                "the parameters of a class are in the parentheses after its name"
            },
        ),
        BindingKind::Input => (
            holder.parts,
            "an `input`",
            "it belongs in a model or a component, which gives its value to classes as an argument",
        ),
        BindingKind::Let => ANYWHERE,
        BindingKind::State => (holder.class, "a state", "it belongs in a class"),
        BindingKind::Field => (holder.class, "a field", "it belongs in a class"),
        BindingKind::Output => (!holder.record, "an output", OF_RECORDS),
    }
}

fn placing_of_statement(holder: Holder, statement: &Statement) -> Placing {
    let of_joints = if holder.class {
        "only a joint or a drive constrains: define it as a `joint`"
    } else {
        "it belongs in a joint; a branch also into the block of a use"
    };
    match statement {
        Statement::Constrain(_) => (holder.constrains, "a constraint", of_joints),
        Statement::Branch(_) => (holder.constrains, "a branch", of_joints),
        Statement::Apply { .. } | Statement::Rate { .. } => (
            holder.class,
            "this statement",
            "it belongs in a joint, force, journal or drive",
        ),
        Statement::Resolve(_) => (
            holder.class,
            "a `resolve`",
            "it belongs in a class: it states the length that matters at the markers of the class",
        ),
        Statement::Change { .. } => (
            false,
            "a change",
            "a number inside of a part is changed where the part is used: `part unit = Cylinder(…) with { rod.mass = 0.6 kg }`",
        ),
        Statement::Place { .. } => (
            holder.class,
            "a `place`",
            "it belongs in a class; a body is placed by `start` or `guess`",
        ),
        Statement::Start { .. } | Statement::Guess { .. } => (
            holder.parts,
            "a start value",
            "it belongs in a model or a body: `start joint.angle = 30 deg`",
        ),
        Statement::Require { .. } => (
            holder.parts || holder.class,
            "a requirement",
            "it belongs in a model or a class",
        ),
        Statement::Accept(_) => (
            holder.parts,
            "an `accept`",
            "it belongs in a model, a component, a body, or the block of a use: `journal main = Impedance(…) { accept usual }`",
        ),
    }
}

fn placing_of_declaration(holder: Holder, declaration: &Declaration) -> Placing {
    match declaration.kind {
        Kind::Default => ANYWHERE,
        Kind::Model | Kind::Component | Kind::Interface | Kind::Record | Kind::Analysis => {
            (false, "a definition", AT_THE_TOP)
        }
        Kind::Body
        | Kind::Flexible
        | Kind::Marker
        | Kind::Joint
        | Kind::Force
        | Kind::Journal
        | Kind::Drive
        | Kind::Part
        | Kind::Cycle => match declaration.form {
            Form::Class { .. } if holder.parts => (
                false,
                "a class",
                "define it at the top of the file, and use it here",
            ),
            _ => (
                holder.parts,
                "a part",
                "bodies, markers and elements belong in a model or a component",
            ),
        },
    }
}

/// Whether a class of this kind makes elements or parts.
pub(super) fn is_of_elements(kind: Kind) -> bool {
    matches!(
        kind,
        Kind::Joint | Kind::Force | Kind::Journal | Kind::Drive | Kind::Component
    )
}

impl<'p> Checker<'p> {
    pub(super) fn misplaced(&mut self, span: Span, what: &str, place: &str, help: &str) {
        self.report(
            Diagnostic::error(codes::MISPLACED, format!("{what} does not belong {place}"))
                .at(span, "not here")
                .with_help(help),
        );
    }

    /// Checks a definition with everything in it.
    pub(super) fn definition(&mut self, id: DefinitionId, declaration: &'p Declaration) {
        let kind = declaration.kind;
        if !declaration.index.is_empty() {
            self.misplaced(
                declaration.name.span,
                "an index",
                "at a definition",
                "write the index where the class is used: `joint pin[i in 1..4] = Name(…)`",
            );
        }
        if matches!(
            kind,
            Kind::Body | Kind::Flexible | Kind::Marker | Kind::Part | Kind::Cycle
        ) {
            self.misplaced(
                declaration.kind_span,
                &with_article(kind_word(kind)),
                "at the top of a file",
                "put it into a model; a class of parts is a `component`",
            );
            return;
        }
        let class_form = matches!(declaration.form, Form::Class { .. });
        if class_form && matches!(kind, Kind::Model | Kind::Interface | Kind::Record) {
            self.misplaced(
                declaration.name.span,
                "a list of parameters",
                &format!("at {}", with_article(kind_word(kind))),
                if kind == Kind::Record {
                    "its values are `let`s in the block: `let a: Length`"
                } else {
                    "its parameters are `param`s in the block: `param speed: AngularVelocity`"
                },
            );
        }
        let table = self.class_table(id);
        for (name, owned) in &table.members {
            if let Some(span) = owned.member.span() {
                self.member_type(owned.home, name, owned.member, span);
            }
        }
        let scope = Scope::of(id);
        let Some(block) = declaration.block() else {
            return;
        };
        let mut cycles: Option<Span> = None;
        let mut attributes: Vec<&'p Name> = Vec::new();
        for item in &block.items {
            if let Some((what, help)) = placing(kind, &item.kind) {
                let place = format!("in {}", with_article(kind_word(kind)));
                self.misplaced(item_place(item), what, &place, help);
                continue;
            }
            match &item.kind {
                ItemKind::Statement(statement) => self.statement(&scope, statement),
                ItemKind::Attribute(attribute) => {
                    self.name_once(&mut attributes, &attribute.name);
                    self.model_attribute(&scope, attribute, kind);
                }
                ItemKind::Declaration(inner) => match inner.kind {
                    Kind::Flexible => self.flexible(&scope, inner),
                    Kind::Default => self.not_built(inner.kind_span, "`default` blocks"),
                    Kind::Body => self.rigid(&scope, inner),
                    Kind::Marker => self.marker(&scope, inner),
                    Kind::Cycle => {
                        if let Some(first) = cycles {
                            self.defined_twice("cycle", inner.kind_span, first);
                        }
                        cycles = Some(inner.kind_span);
                        self.cycle(&scope, inner);
                    }
                    _ => self.element(&scope, inner),
                },
                _ => {}
            }
        }
        self.stated_once(&block.items);
        self.states_and_rates(id, declaration);
        self.conformity(id, declaration);
        self.summaries(id, declaration);
    }

    pub(super) fn name_once(&mut self, seen: &mut Vec<&'p Name>, name: &'p Name) {
        if let Some(first) = seen.iter().find(|n| n.text == name.text) {
            let first = first.span;
            self.defined_twice(&name.text, name.span, first);
        }
        seen.push(name);
    }

    /// Reports an unknown class, with the known classes of the needed kind.
    fn unknown_class(&mut self, module: u32, kind: Kind, name: &str, span: Span) {
        let word = match kind {
            Kind::Part => "component",
            other => kind_word(other),
        };
        let message = Diagnostic::error(
            codes::UNKNOWN_NAME,
            format!("there is no {word} `{name}` here"),
        )
        .at(span, "not known");
        if let Some(path) = self.module_of(name) {
            let message = self.offer_use(message, module, &path, name);
            self.report(message);
            return;
        }
        let scope = self.program.modules.get(module as usize);
        let mut known: Vec<&str> = scope
            .iter()
            .flat_map(|module| &module.scope)
            .filter(|(_, id)| {
                self.declaration(**id)
                    .is_some_and(|declaration| kind_word(declaration.kind) == word)
            })
            .map(|(name, _)| name.as_str())
            .collect();
        let near = nearest(name, known.iter().copied()).map(str::to_owned);
        let offered = || {
            let offered = self.program.offered.iter();
            offered.filter(|(_, offered)| offered.word == word)
        };
        let message = match (
            near,
            nearest(name, offered().map(|(name, _)| name.as_str())),
        ) {
            (Some(near), _) => message.meant(span, near),
            (None, Some(near)) => match self.program.offered.get(near) {
                Some(of) => message.with_help(format!("did you mean `{near}` of `{}`?", of.module)),
                None => message,
            },
            (None, None) => {
                known.extend(offered().map(|(name, _)| name.as_str()));
                known.sort_unstable();
                known.dedup();
                let message = match known.is_empty() {
                    true => message,
                    false => message.with_note(format!(
                        "the {word}s of this file and of the library are {}",
                        crate::resolve::suggest::listing(known, 24)
                    )),
                };
                message.with_help(format!(
                    "a class of your own is at the top of the file: `{word} {name}(…) {{ … }}`"
                ))
            }
        };
        self.report(message);
    }

    /// The type of the element that `kind name = Class(…)` makes. Reports a wrong class.
    pub(super) fn element_type(&mut self, scope: &Scope<'p>, declaration: &'p Declaration) -> Type {
        let scope = self.binders(scope, &declaration.index);
        let kind = declaration.kind;
        let word = kind_word(kind);
        let Form::Instance { value, .. } = &declaration.form else {
            if matches!(declaration.form, Form::Plain { .. }) {
                self.report(
                    Diagnostic::error(
                        codes::MISSING_VALUE,
                        format!("the {word} `{}` needs a class", declaration.name.text),
                    )
                    .at(declaration.name.span, "of which class?")
                    .with_help(format!(
                        "write `{word} {} = Class(…)`",
                        declaration.name.text
                    )),
                );
            }
            return Type::Error;
        };
        let ExprKind::Call { callee, .. } = &value.kind else {
            return self.not_a_use(&scope, declaration, value);
        };
        let ty = match &callee.kind {
            ExprKind::Name(name)
                if crate::functions::find(name).is_some() && self.find(&scope, name).is_none() =>
            {
                self.report(
                    Diagnostic::error(
                        codes::KIND,
                        format!("`{name}` is a function, not {}", with_article(word)),
                    )
                    .at(
                        callee.span,
                        format!("a class of the kind `{word}` is expected"),
                    ),
                );
                return Type::Error;
            }
            ExprKind::Name(name) if self.find(&scope, name).is_none() => {
                self.unknown_class(scope.module, kind, name, callee.span);
                return Type::Error;
            }
            _ => self.infer(&scope, callee),
        };
        let ty = match ty {
            Type::Bound(bound) => Type::Class(bound.class),
            other => other,
        };
        match ty {
            Type::Class(id) => self.instance_of(declaration, id),
            Type::ClassOf(interface) => Type::InstanceOf(interface),
            Type::Error => Type::Error,
            other => {
                let found = self.describe(&other);
                let message = Diagnostic::error(
                    codes::KIND,
                    format!("`{}` needs a class, not {found}", declaration.name.text),
                )
                .at(callee.span, format!("this is {found}"))
                .also(
                    declaration.kind_span,
                    format!("a class of the kind `{word}` is expected"),
                );
                self.report(match other {
                    Type::Instance(id) => {
                        let class = self.class_name(id);
                        message.with_help(self.class_as_type(&class, id))
                    }
                    _ => message,
                });
                Type::Error
            }
        }
    }

    /// The type of an element of a class. Reports a class of another kind than the declaration's.
    fn instance_of(&mut self, declaration: &Declaration, id: DefinitionId) -> Type {
        let kind = declaration.kind;
        let wanted = if kind == Kind::Part {
            Kind::Component
        } else {
            kind
        };
        let found = self.declaration(id).map(|d| d.kind);
        if found == Some(wanted) {
            return Type::Instance(id);
        }
        let class = self.class_name(id);
        let found_word = found.map_or("class", kind_word);
        let right = match found {
            Some(Kind::Component) => Some("part"),
            Some(Kind::Joint | Kind::Force | Kind::Journal | Kind::Drive) => Some(found_word),
            _ => None,
        };
        let mut message = Diagnostic::error(
            codes::KIND,
            format!(
                "`{class}` is {}, not {}",
                with_article(found_word),
                with_article(kind_word(wanted))
            ),
        )
        .at(
            declaration.kind_span,
            format!("declared as {}", with_article(kind_word(kind))),
        );
        message = message.also_if(
            self.declaration(id).map(|declared| declared.name.span),
            format!("defined as {}", with_article(found_word)),
        );
        if let Some(right) = right {
            let title = format!("write `{right} {} = {class}(…)`", declaration.name.text);
            message = message.with_fix(title, declaration.kind_span, right);
        }
        self.report(message);
        // the intended class is certain, so its members can be checked
        match right {
            Some(_) => Type::Instance(id),
            None => Type::Error,
        }
    }

    fn not_a_use(&mut self, scope: &Scope<'p>, declaration: &Declaration, value: &Expr) -> Type {
        let ty = self.infer(scope, value);
        if ty.is_error() {
            return Type::Error;
        }
        let word = kind_word(declaration.kind);
        let shown = self.sources.text(value.span).to_owned();
        let message = match ty {
            Type::Class(_) | Type::ClassOf(_) | Type::Bound(_) => Diagnostic::error(
                codes::MISSING_ARGUMENT,
                format!("`{shown}` needs its arguments"),
            )
            .at(value.span, "the name alone")
            .with_help(format!(
                "write `{word} {} = {shown}(…)`",
                declaration.name.text
            )),
            other => {
                let found = self.describe(&other);
                Diagnostic::error(
                    codes::KIND,
                    format!("`{}` needs a class, not {found}", declaration.name.text),
                )
                .at(value.span, format!("this is {found}"))
                .with_help(format!(
                    "write `{word} {} = Class(…)`",
                    declaration.name.text
                ))
            }
        };
        self.report(message);
        Type::Error
    }

    /// Checks a use of a class: its arguments and its block.
    fn element(&mut self, outer: &Scope<'p>, declaration: &'p Declaration) {
        let ty = self.element_type(outer, declaration);
        let scope = self.binders(outer, &declaration.index);
        self.condition_of(&scope, declaration);
        let Form::Instance { value, block } = &declaration.form else {
            return;
        };
        let ExprKind::Call { callee, arguments } = &value.kind else {
            return;
        };
        let class = match ty {
            Type::Instance(id) | Type::InstanceOf(id) => id,
            _ => {
                for argument in arguments {
                    self.infer(&scope, &argument.value);
                }
                return;
            }
        };
        let given = match self.infer(&scope, callee) {
            Type::Bound(bound) => bound.given.clone(),
            _ => Vec::new(),
        };
        self.arguments_of_class(&scope, class, &given, arguments, value.span);
        self.changes(&scope, declaration, class);
        let Some(block) = block else {
            return;
        };
        let inner = Scope {
            at_use: Some(class),
            ..scope
        };
        for item in &block.items {
            match &item.kind {
                ItemKind::Error => {}
                ItemKind::Statement(
                    statement @ (Statement::Branch(_)
                    | Statement::Require { .. }
                    | Statement::Accept(_)),
                ) => {
                    if matches!(statement, Statement::Branch(_))
                        && !matches!(declaration.kind, Kind::Joint | Kind::Drive)
                    {
                        self.misplaced(
                            item.span,
                            "a branch",
                            &format!("at {}", with_article(kind_word(declaration.kind))),
                            "only joints and drives restrict motions, so only they have branches",
                        );
                        continue;
                    }
                    self.statement(&inner, statement);
                }
                _ => self.misplaced(
                    item_place(item),
                    "this",
                    "in the block of a use",
                    "it takes `branch`, `require`, `advise` and `accept`; start values belong to the model: `start joint.angle = 30 deg`",
                ),
            }
        }
    }
}

/// The beginning of an item, as the place of a message.
pub(super) fn item_place(item: &Item) -> Span {
    match &item.kind {
        ItemKind::Binding(binding) => binding.name.span,
        ItemKind::Function(function) => function.name.span,
        ItemKind::Table(table) => table.name.span,
        ItemKind::Declaration(declaration) => declaration.kind_span.to(declaration.name.span),
        ItemKind::Attribute(attribute) => attribute.name.span,
        ItemKind::Report(report) => report.word.to(report.name.span),
        ItemKind::Entry(entry) => entry.word.to(entry.name.span),
        ItemKind::Dimension(dimension) => dimension.name.span,
        ItemKind::Unit(unit) => unit.name.span,
        ItemKind::Choice(choice) => choice.name.span,
        ItemKind::Use(_) | ItemKind::Statement(_) | ItemKind::Error => item.span,
    }
}
