//! Statements of definitions and bodies.

use super::Checker;
use super::mismatch::Due;
use super::scope::{Scope, torque_dimension};
use super::types::{Quantity, Type};
use crate::codes;
use crate::resolve::suggest::{listing, nearest};
use crate::words::START_VALUES;
use eng_grammar::ast::{
    Attribute, Declaration, Expr, ExprKind, Form, ItemKind, Kind, Name, Statement,
};

use eng_grammar::{Diagnostic, Diagnostics, MessagePart, parse_message};
use eng_system::Dimension;

impl<'p> Checker<'p> {
    pub(super) fn statement(&mut self, scope: &Scope<'p>, statement: &Statement) {
        match statement {
            Statement::Constrain(equation) => self.equation(scope, equation),
            Statement::Branch(condition) => self.condition(scope, condition, "a branch"),
            Statement::Start { target, value } | Statement::Guess { target, value } => {
                self.start(scope, target, scope, value);
            }
            Statement::Apply {
                torque,
                value,
                on,
                against,
            } => {
                let (word, dimension) = if *torque {
                    ("torque", torque_dimension())
                } else {
                    ("force", Dimension::FORCE)
                };
                let due = Due::new(format!("the value of `apply {word}`"));
                self.expect(scope, value, &Type::vector(Quantity::hard(dimension)), &due);
                self.expect(scope, on, &Type::Marker, &Due::new("the value after `on`"));
                if let Some(against) = against {
                    let due = Due::new("the value after `against`");
                    self.expect(scope, against, &Type::Marker, &due);
                }
            }
            Statement::Accept(names) => self.accept(names),
            Statement::Resolve(length) => {
                let due = Due::new("the length after `resolve`");
                let length_type = Type::Scalar(Quantity::hard(Dimension::LENGTH));
                self.expect(scope, length, &length_type, &due);
            }
            // a change belongs after `with`, where `changes` checks it
            Statement::Change { .. } => {}
            Statement::Place { moving, on, height } => {
                self.placed_marker(scope, moving, "the value after `place`");
                self.placed_marker(scope, on, "the value after `on`");
                self.placed_on_itself(moving, on);
                if let Some(height) = height {
                    let length = Type::Scalar(Quantity::hard(Dimension::LENGTH));
                    self.expect(scope, height, &length, &Due::new("the height after `at`"));
                }
            }
            Statement::Require {
                advise,
                index,
                condition,
                message,
                ..
            } => {
                let word = if *advise { "advise" } else { "require" };
                let scope = &self.binders(scope, index);
                self.condition(scope, condition, &format!("the expression after `{word}`"));
                self.message(scope, message);
            }
            Statement::Rate { state, value } => {
                // another check reports a name that is not a state
                let found = self.find(scope, &state.text).is_some();
                let rate = match found.then(|| self.name(scope, &state.text, state.span)) {
                    Some(Type::Scalar(quantity)) => {
                        let time = Quantity::hard(Dimension::TIME);
                        Type::Scalar(Quantity {
                            soft: true,
                            ..quantity.over(&time)
                        })
                    }
                    _ => Type::Error,
                };
                let due = Due::new(format!("the rate of `{}`", state.text))
                    .declared(state.span, "a rate is the state's dimension in a time");
                self.expect(scope, value, &rate, &due);
            }
        }
    }

    /// Checks a marker of `place`. Its message lists the markers of the class.
    fn placed_marker(&mut self, scope: &Scope<'p>, marker: &Expr, what: &str) {
        let unknown = match &marker.kind {
            ExprKind::Name(name) => name != "ground" && self.find(scope, name).is_none(),
            _ => false,
        };
        let found = match unknown {
            true => None,
            false => Some(self.infer(scope, marker)),
        };
        if found
            .as_ref()
            .is_some_and(|ty| ty.is_error() || *ty == Type::Marker)
        {
            return;
        }
        let message = match found {
            None => Diagnostic::error(
                codes::UNKNOWN_NAME,
                format!("there is no `{}` here", self.sources.text(marker.span)),
            )
            .at(marker.span, "not known"),
            Some(ty) => {
                let found = self.describe(&ty);
                Diagnostic::error(
                    codes::WRONG_TYPE,
                    format!("{what} is a marker, not {found}"),
                )
                .at(marker.span, format!("this is {found}"))
            }
        };
        let mut known = Vec::new();
        if let Some(id) = scope.definition {
            let table = self.class_table(id);
            for (name, owned) in &table.members {
                match self.member_type(owned.home, name, owned.member, marker.span) {
                    Type::Marker => known.push((*name).to_owned()),
                    Type::List { element, .. } if *element == Type::Marker => {
                        known.push(format!("{name}[1]"));
                    }
                    _ => {}
                }
            }
        }
        let names = listing(known.iter().map(String::as_str), 12);
        self.report(
            message
                .with_note(match known.is_empty() {
                    true => "this class has no markers".to_owned(),
                    false => format!("the markers of this class: {names}"),
                })
                .with_help("`place` names two markers, the moving one first: `place pin on shell`"),
        );
    }

    fn placed_on_itself(&mut self, moving: &Expr, on: &Expr) {
        if let (ExprKind::Name(a), ExprKind::Name(b)) = (&moving.kind, &on.kind)
            && a == b
        {
            self.report(
                Diagnostic::error(codes::MISPLACED, format!("`place` puts `{a}` on itself"))
                    .at(moving.span.to(on.span), "one marker")
                    .with_help("name the two markers that should meet: `place pin on shell`"),
            );
        }
    }

    /// Checks `accept usual`: the name must be that of a lint of the texts or the language.
    fn accept(&mut self, names: &[Name]) {
        for name in names {
            if self.lints.contains(name.text.as_str()) {
                continue;
            }
            let mut message = Diagnostic::warning(
                codes::ACCEPT_UNKNOWN,
                format!("no lint is called `{}`", name.text),
            )
            .at(name.span, "accepts nothing");
            message = match nearest(&name.text, self.lints.iter().copied()) {
                Some(near) => message
                    .with_help(format!("did you mean `{near}`?"))
                    .with_fix(format!("write `{near}`"), name.span, near),
                None => {
                    message.with_help("a warning that can be accepted ends with its `accept NAME`")
                }
            };
            self.report(message);
        }
    }

    /// The `{expression as unit}` places of a message.
    pub(super) fn message(&mut self, scope: &Scope<'p>, message: &Name) {
        // the parser has reported unreadable parts of the message
        let mut found = Diagnostics::new();
        let parts = parse_message(
            message,
            Some(&|word| self.program.units.contains_key(word)),
            &mut found,
        );
        for part in &parts {
            let MessagePart::Value { value, unit, .. } = part else {
                continue;
            };
            let ty = self.infer(scope, value);
            if let Some(unit) = unit {
                self.display(scope, &ty, unit);
            }
        }
        self.findings.messages.insert(message.span, parts);
        self.diagnostics.extend(found);
    }

    /// `start target = value` in a model, or after `with`. After `with` the target is inside of the part, and the
    /// value is of the text around it.
    pub(super) fn start(
        &mut self,
        inside: &Scope<'p>,
        target: &Expr,
        scope: &Scope<'p>,
        value: &Expr,
    ) {
        if let ExprKind::Field { base, name } = &target.kind
            && START_VALUES.contains(&name.text.as_str())
        {
            match self.infer(inside, base) {
                Type::Body(_) => return self.start_of_a_body(scope, &name.text, target, value),
                Type::Error => {
                    self.infer(scope, value);
                    return;
                }
                _ => {}
            }
        }
        self.start_of = match &target.kind {
            ExprKind::Field { name, .. } => Some(name.span),
            _ => None,
        };
        let ty = self.infer(inside, target);
        self.start_of = None;
        match &ty {
            Type::Error => {
                self.infer(scope, value);
            }
            Type::Scalar(_) | Type::Vector { .. } => {
                let due = Due::new(format!("the start of `{}`", self.sources.text(target.span)))
                    .declared(target.span, "set here");
                self.expect(scope, value, &ty, &due);
            }
            other => {
                let found = self.describe(other);
                let name = self.sources.text(target.span);
                let help = match other {
                    Type::Body(_) => format!(
                        "a body has `{name}.position`, `{name}.rotation`, `{name}.velocity` and `{name}.angular_velocity`"
                    ),
                    Type::Marker => {
                        format!("for instance `start rotation({name}, ground) = 30 deg`")
                    }
                    Type::Instance(_) | Type::InstanceOf(_) => {
                        format!(
                            "name one of its quantities, such as `start {name}.angle = 30 deg` of a hinge"
                        )
                    }
                    _ => "for instance `start rotation(crank.main, ground) = 30 deg`".to_owned(),
                };
                self.report(
                    Diagnostic::error(
                        codes::START,
                        "only quantities of the motion can be set at the start",
                    )
                    .at(target.span, format!("this is {found}"))
                    .with_help(help),
                );
                self.infer(scope, value);
            }
        }
    }

    /// `gravity = …`.
    pub(super) fn model_attribute(
        &mut self,
        scope: &Scope<'p>,
        attribute: &'p Attribute,
        kind: Kind,
    ) {
        let name = &attribute.name;
        if name.text != "gravity" || kind != Kind::Model {
            let mut message = Diagnostic::error(
                codes::UNKNOWN_ATTRIBUTE,
                format!(
                    "{} has no attribute `{}`",
                    super::describe::with_article(super::describe::kind_word(kind)),
                    name.text
                ),
            )
            .at(name.span, "not known");
            let near = (kind == Kind::Model)
                .then(|| crate::resolve::suggest::nearest(&name.text, ["gravity"]))
                .flatten();
            if let Some(near) = near {
                message = message.meant(name.span, near);
            } else if kind == Kind::Component && name.text == "gravity" {
                message = message.with_help("gravity acts on the whole model: state it there");
            } else if let Some(offered) = self.offer_marker(message.clone(), name, &attribute.value)
            {
                self.report(offered);
                return;
            } else {
                message = message
                    .with_note("a model has the attribute `gravity`")
                    .with_help(format!("a named value is a `let`: `let {} = …`", name.text));
            }
            self.report(message);
            self.infer(scope, &attribute.value);
            return;
        }
        let acceleration = Dimension::LENGTH
            .over(Dimension::TIME)
            .over(Dimension::TIME);
        let mut due = Due::new("`gravity`");
        due.unit = Some("m/s^2".to_owned());
        self.expect(
            scope,
            &attribute.value,
            &Type::vector(Quantity::hard(acceleration)),
            &due,
        );
    }

    /// `cycle angle = rotation(crank.flange, ground) { period = 720 deg }`.
    pub(super) fn cycle(&mut self, scope: &Scope<'p>, declaration: &'p Declaration) {
        if declaration.name.text != "angle" {
            self.report(
                Diagnostic::error(
                    codes::UNKNOWN_ATTRIBUTE,
                    format!("the cycle has no `{}`", declaration.name.text),
                )
                .at(declaration.name.span, "a cycle is stated by its angle")
                .with_help(
                    "write `cycle angle = rotation(crank.main, ground) { period = 720 deg }`",
                )
                .with_fix("write `angle`", declaration.name.span, "angle"),
            );
        }
        let Form::Instance { value, block } = &declaration.form else {
            self.report(
                Diagnostic::error(codes::MISSING_VALUE, "the cycle needs its angle")
                    .at(declaration.name.span, "no value")
                    .with_help(
                        "write `cycle angle = rotation(crank.main, ground) { period = 720 deg }`",
                    ),
            );
            return;
        };
        let angle = Type::Scalar(Quantity::hard(Dimension::ANGLE));
        self.expect(scope, value, &angle, &Due::new("the angle of the cycle"));
        let mut period = false;
        for item in block.iter().flat_map(|block| &block.items) {
            match &item.kind {
                ItemKind::Attribute(attribute) if attribute.name.text == "period" => {
                    if period {
                        self.defined_twice("period", attribute.name.span, attribute.name.span);
                    }
                    period = true;
                    let mut due = Due::new("the period of the cycle");
                    due.unit = Some("deg".to_owned());
                    self.expect(scope, &attribute.value, &angle, &due);
                }
                ItemKind::Attribute(attribute) if attribute.name.text == "pistons" => {
                    self.not_built(attribute.name.span, "pistons of the cycle");
                }
                ItemKind::Attribute(attribute) => {
                    let mut message = Diagnostic::error(
                        codes::UNKNOWN_ATTRIBUTE,
                        format!("the cycle has no attribute `{}`", attribute.name.text),
                    )
                    .at(attribute.name.span, "not known");
                    if let Some(near) =
                        crate::resolve::suggest::nearest(&attribute.name.text, ["period"])
                    {
                        period = true;
                        message = message.meant(attribute.name.span, near);
                    }
                    self.report(message);
                }
                ItemKind::Error => {}
                _ => self.misplaced(
                    item.span,
                    "this",
                    "in a cycle",
                    "a cycle has the attribute `period`",
                ),
            }
        }
        if !period {
            self.report(
                Diagnostic::error(codes::MISSING_ATTRIBUTE, "the cycle needs its period")
                    .at(declaration.name.span, "no `period`")
                    .with_help("720 deg for a four-stroke engine: `{ period = 720 deg }`"),
            );
        }
    }
}
