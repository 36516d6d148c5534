//! Bodies and markers.

use super::Checker;
use super::mismatch::Due;
use super::scope::Scope;
use super::types::{Quantity, Type};
use crate::codes;
use crate::resolve::suggest::nearest;
use crate::words::{Place, START_VALUES, word};
use eng_grammar::ast::{
    Argument, Attribute, Declaration, Expr, ExprKind, Form, Item, ItemKind, Kind, Name, Statement,
};
use eng_grammar::{Diagnostic, Span};
use eng_system::Dimension;

pub(super) const ATTRIBUTES: [&str; 4] =
    ["mass", "inertia", "products_of_inertia", "center_of_mass"];
const RIGID: BodyKind = BodyKind {
    words: "body",
    word: "body",
    question: "of which mass?",
    block: "mass = …; inertia = …",
    attributes: &ATTRIBUTES,
    required: &[
        ("mass", "add `mass = 1 kg` with its value"),
        ("inertia", "add `inertia = [1, 1, 1] kg*m^2` with its value"),
    ],
};

/// The attributes and the texts of rigid or flexible bodies.
pub(super) struct BodyKind {
    /// The kind in words.
    pub words: &'static str,
    /// The word that begins a declaration.
    pub word: &'static str,
    /// The question to a body without a block.
    pub question: &'static str,
    /// The contents of a block, for a help.
    pub block: &'static str,
    pub attributes: &'static [&'static str],
    /// Required attributes, each with the help for a missing one.
    pub required: &'static [(&'static str, &'static str)],
}

/// Whether the block of a body assigns a value to a name: `big = [0, -41, 0] mm`.
pub(super) fn states(body: &Declaration, name: &str) -> bool {
    body.block().is_some_and(|block| {
        block
            .items
            .iter()
            .any(|item| matches!(&item.kind, ItemKind::Attribute(a) if a.name.text == name))
    })
}

fn moment_of_inertia() -> Dimension {
    Dimension::MASS
        .times(Dimension::LENGTH)
        .times(Dimension::LENGTH)
}

impl<'p> Checker<'p> {
    /// Adds the fix of writing `marker` before a name whose value is a place.
    pub(super) fn offer_marker(
        &self,
        message: Diagnostic,
        name: &Name,
        value: &Expr,
    ) -> Option<Diagnostic> {
        let place = match &value.kind {
            ExprKind::List { items, unit } => {
                let of = |unit| {
                    self.program
                        .unit(unit)
                        .is_ok_and(|unit| unit.dimension == Dimension::LENGTH)
                };
                items.len() == 3 && unit.as_ref().is_none_or(of)
            }
            ExprKind::Name(name) => name == "origin",
            ExprKind::Call { callee, .. } => matches!(&callee.kind, ExprKind::Name(called)
                if called == "at" || word(Place::Marker, called).is_some()),
            _ => false,
        };
        let start = Span {
            end: name.span.start,
            ..name.span
        };
        place.then(|| message.with_fix("a place is a marker", start, "marker "))
    }

    /// `if condition` after the name of a part.
    pub(super) fn condition_of(&mut self, scope: &Scope<'p>, declaration: &'p Declaration) {
        if let Some(condition) = &declaration.condition {
            let due = Due::new(format!("the condition of `{}`", declaration.name.text));
            self.expect(scope, condition, &Type::Bool, &due);
        }
    }

    pub(super) fn rigid(&mut self, outer: &Scope<'p>, declaration: &'p Declaration) {
        self.body(
            outer,
            declaration,
            &RIGID,
            Self::rigid_attribute,
            Self::marker,
        );
    }

    /// `body name[index] { … }` and `flexible name[index] { … }`.
    pub(super) fn body(
        &mut self,
        outer: &Scope<'p>,
        declaration: &'p Declaration,
        kind: &BodyKind,
        attribute: fn(&mut Self, &Scope<'p>, &'p Attribute),
        marker: fn(&mut Self, &Scope<'p>, &'p Declaration),
    ) {
        let scope = self.binders(outer, &declaration.index);
        self.condition_of(&scope, declaration);
        let name = &declaration.name.text;
        let BodyKind { words, word, .. } = kind;
        let (Form::Plain { .. }, Some(block)) = (&declaration.form, declaration.block()) else {
            self.report(
                Diagnostic::error(
                    codes::MISSING_VALUE,
                    format!("the {words} `{name}` needs a block"),
                )
                .at(declaration.name.span, kind.question)
                .with_help(format!("write `{word} {name} {{ {} }}`", kind.block)),
            );
            return;
        };
        let inner = Scope {
            body: Some(declaration),
            ..scope
        };
        let mut attributes: Vec<&'p Name> = Vec::new();
        let mut markers: Vec<&'p Name> = Vec::new();
        for item in &block.items {
            match &item.kind {
                ItemKind::Error => {}
                ItemKind::Attribute(stated) => {
                    self.name_once(&mut attributes, &stated.name);
                    attribute(self, &inner, stated);
                }
                ItemKind::Declaration(stated) if stated.kind == Kind::Marker => {
                    self.marker_name(&mut markers, stated);
                    marker(self, &inner, stated);
                }
                ItemKind::Statement(
                    Statement::Start { target, value } | Statement::Guess { target, value },
                ) => self.start_of_body(&inner, target, value),
                ItemKind::Statement(statement @ Statement::Accept(_)) => {
                    self.statement(&inner, statement);
                }
                _ => self.misplaced_in_body(item),
            }
        }
        for (wanted, help) in kind.required {
            let known = kind.attributes.iter().copied();
            let near = |given: &&&Name| {
                given.text == *wanted || nearest(&given.text, known.clone()) == Some(*wanted)
            };
            if attributes.iter().find(near).is_none() {
                self.report(
                    Diagnostic::error(
                        codes::MISSING_ATTRIBUTE,
                        format!("the {words} `{name}` needs its {wanted}"),
                    )
                    .at(declaration.name.span, format!("no `{wanted}`"))
                    .with_help(*help),
                );
            }
        }
    }

    /// Refuses a second marker with the same name.
    pub(super) fn marker_name(&mut self, known: &mut Vec<&'p Name>, marker: &'p Declaration) {
        if marker.name.text == "origin" {
            self.report(
                Diagnostic::error(codes::DEFINED_TWICE, "`origin` is a marker of every body")
                    .at(marker.name.span, "another one")
                    .with_help("give the marker a name of its own"),
            );
        } else if let Some(first) = known.iter().find(|n| n.text == marker.name.text) {
            let first = first.span;
            self.defined_twice(&marker.name.text, marker.name.span, first);
        }
        known.push(&marker.name);
    }

    fn mesh_without_body(&mut self, word: &str, span: Span) {
        self.report(
            Diagnostic::error(codes::MARKER, format!("`{word}` is a place on a mesh"))
                .at(span, "this body has none")
                .with_help("a body with a mesh is `flexible name { mesh = … }`; a marker of a rigid body has coordinates: `[0, 0, 0] mm`"),
        );
    }

    pub(super) fn misplaced_in_body(&mut self, item: &Item) {
        let (what, help) = match &item.kind {
            ItemKind::Binding(_) => (
                "a named value",
                "put it into the model; the body can read it there",
            ),
            ItemKind::Declaration(_) => {
                ("this part", "it belongs in the model; a body has markers")
            }
            _ => ("this", "a body has attributes, markers and start values"),
        };
        self.misplaced(item.span, what, "in a body", help);
    }

    fn rigid_attribute(&mut self, scope: &Scope<'p>, attribute: &'p Attribute) {
        self.attribute_of_a_body(scope, &attribute.name, &attribute.value);
    }

    /// An attribute of a rigid body, in its block or by its path.
    pub(super) fn attribute_of_a_body(&mut self, scope: &Scope<'p>, name: &Name, value: &Expr) {
        let (ty, unit) = match name.text.as_str() {
            "mass" => (Type::Scalar(Quantity::hard(Dimension::MASS)), "kg"),
            "inertia" | "products_of_inertia" => (
                Type::list(Type::Scalar(Quantity::hard(moment_of_inertia())), Some(3)),
                "kg*m^2",
            ),
            "center_of_mass" => (
                Type::list(Type::Scalar(Quantity::hard(Dimension::LENGTH)), Some(3)),
                "mm",
            ),
            _ => {
                let mut message = Diagnostic::error(
                    codes::UNKNOWN_ATTRIBUTE,
                    format!("a body has no attribute `{}`", name.text),
                )
                .at(name.span, "not known");
                message = match nearest(&name.text, ATTRIBUTES) {
                    Some(near) => message.meant(name.span, near),
                    None => match self.offer_marker(message.clone(), name, value) {
                        Some(offered) => {
                            self.report(offered);
                            return;
                        }
                        None => message.with_note(
                            "it has `mass`, `inertia`, `products_of_inertia` and `center_of_mass`",
                        ),
                    },
                };
                self.report(message);
                self.infer(scope, value);
                return;
            }
        };
        let mut due = Due::new(format!("`{}` of a body", name.text));
        due.unit = Some(unit.to_owned());
        self.expect(scope, value, &ty, &due);
    }

    pub(super) fn start_of_body(&mut self, scope: &Scope<'p>, target: &Expr, value: &Expr) {
        let name = match &target.kind {
            ExprKind::Name(name) => name.as_str(),
            ExprKind::Error => return,
            _ => "",
        };
        self.start_of_a_body(scope, name, target, value);
    }

    /// A start value of a body, in its block or by its path.
    pub(super) fn start_of_a_body(
        &mut self,
        scope: &Scope<'p>,
        name: &str,
        target: &Expr,
        value: &Expr,
    ) {
        let per_second = |dimension: Dimension| dimension.over(Dimension::TIME);
        let (ty, unit) = match name {
            "position" => (Type::vector(Quantity::hard(Dimension::LENGTH)), "mm"),
            "velocity" => (
                Type::vector(Quantity::hard(per_second(Dimension::LENGTH))),
                "m/s",
            ),
            "angular_velocity" => (
                Type::vector(Quantity::hard(per_second(Dimension::ANGLE))),
                "rpm",
            ),
            "rotation" => (Type::vector(Quantity::hard(Dimension::ANGLE)), "deg"),
            _ => {
                let shown = self.sources.text(target.span).to_owned();
                let mut message = Diagnostic::error(
                    codes::START,
                    format!("a body has no `{shown}` to set at the start"),
                )
                .at(target.span, "not known");
                message = match nearest(name, START_VALUES) {
                    Some(near) => message.meant(target.span, near),
                    None => message
                        .with_note(
                            "it has `position`, `rotation`, `velocity` and `angular_velocity`",
                        )
                        .with_help(
                            "other things are set in the model: `start rotation(a, b) = 30 deg`",
                        ),
                };
                self.report(message);
                self.infer(scope, value);
                return;
            }
        };
        let mut due = Due::new(format!("`{name}` of a body"));
        due.unit = Some(unit.to_owned());
        self.expect(scope, value, &ty, &due);
    }

    pub(super) fn marker(&mut self, outer: &Scope<'p>, declaration: &'p Declaration) {
        let scope = self.binders(outer, &declaration.index);
        self.condition_of(&scope, declaration);
        let name = &declaration.name.text;
        let Form::Instance { value, block } = &declaration.form else {
            self.report(
                Diagnostic::error(codes::MARKER, format!("the marker `{name}` needs a place"))
                    .at(declaration.name.span, "where?")
                    .with_help(format!("write `marker {name} = [0, 0, 0] mm`")),
            );
            return;
        };
        if let Some(block) = block {
            self.misplaced(
                block.span,
                "a block",
                "at a marker",
                "a marker has a place and axes, and nothing else",
            );
        }
        match &value.kind {
            ExprKind::Error => {}
            ExprKind::Call { callee, arguments } => match &callee.kind {
                ExprKind::Name(word) if word == "at" => {
                    self.place_with_axes(&scope, name, value, arguments);
                }
                ExprKind::Name(name) if word(Place::Marker, name).is_some() => {
                    self.mesh_without_body(name, callee.span);
                }
                _ => self.place(&scope, name, value, &[]),
            },
            _ => self.place(&scope, name, value, &[]),
        }
    }

    /// `origin`, or three lengths. The arguments are those of `at` around it.
    fn place(&mut self, scope: &Scope<'p>, name: &str, value: &Expr, arguments: &[Argument]) {
        if matches!(&value.kind, ExprKind::Name(word) if word == "origin") {
            return;
        }
        let ty = self.infer(scope, value);
        if ty == Type::Marker {
            let help = self.in_axes_of(value, arguments);
            self.report(
                Diagnostic::error(
                    codes::MARKER,
                    format!("the place of `{name}` is another marker"),
                )
                .at(value.span, "this is a marker")
                .with_help(help),
            );
            return;
        }
        let mut due = Due::new(format!("the place of the marker `{name}`"));
        due.unit = Some("mm".to_owned());
        self.fit(
            value,
            &ty,
            &Type::vector(Quantity::hard(Dimension::LENGTH)),
            &due,
        );
    }

    /// The remedy for a marker as the place of another.
    fn in_axes_of(&self, marker: &Expr, arguments: &[Argument]) -> String {
        let mut others = arguments.iter().filter_map(|a| a.name.as_ref()).peekable();
        if others.peek().is_none() {
            return "use that marker itself, or repeat its place: `[x, y, z] mm`".to_owned();
        }
        let mut form = format!("at([0, 0, 0] mm, in: {}", self.sources.text(marker.span));
        for name in others.filter(|name| name.text != "in") {
            form.push_str(&format!(", {}: …", name.text));
        }
        format!("`in:` names a marker of the same body: `{form})`")
    }

    fn place_with_axes(
        &mut self,
        scope: &Scope<'p>,
        name: &str,
        call: &Expr,
        arguments: &[Argument],
    ) {
        let mut place = None;
        let mut parts: Vec<&Name> = Vec::new();
        for argument in arguments {
            match &argument.name {
                None if place.is_none() => {
                    place = Some(());
                    self.place(scope, name, &argument.value, arguments);
                }
                None => {
                    self.report(
                        Diagnostic::error(codes::TOO_MANY_ARGUMENTS, "`at` takes one place")
                            .at(argument.value.span, "a second one")
                            .with_help("axes have names: `at(origin, z: [1, 0, 0])`"),
                    );
                }
                Some(part) if matches!(part.text.as_str(), "x" | "z" | "in" | "about" | "by") => {
                    if let Some(first) = parts.iter().find(|a| a.text == part.text) {
                        self.report(
                            Diagnostic::error(
                                codes::ARGUMENT_TWICE,
                                format!("`{}` is given twice", part.text),
                            )
                            .at(argument.value.span, "again here")
                            .also(first.span, "first here"),
                        );
                    }
                    parts.push(part);
                    self.part_of_place(scope, &part.text, &argument.value);
                }
                Some(other) => {
                    self.report(
                        Diagnostic::error(
                            codes::UNKNOWN_ARGUMENT,
                            format!("`at` has no parameter `{}`", other.text),
                        )
                        .at(other.span, "no parameter of this name")
                        .with_help("it takes a place, `x:` and `z:` for directions, `in:` for a marker, `about:` and `by:` for a turn"),
                    );
                    self.infer(scope, &argument.value);
                }
            }
        }
        let has = |name: &str| parts.iter().any(|part| part.text == name);
        if has("about") != has("by") {
            let missing = if has("by") { "about" } else { "by" };
            self.report(
                Diagnostic::error(
                    codes::MISSING_ARGUMENT,
                    format!("a turn needs `{missing}:`, too"),
                )
                .at(call.span, "one of two arguments")
                .with_help("for instance `at(origin, about: z, by: 30 deg)`"),
            );
        }
        if place.is_none() {
            self.report(
                Diagnostic::error(codes::MISSING_ARGUMENT, "`at` needs a place")
                    .at(call.span, "where?")
                    .with_help("for instance `at(origin, z: [1, 0, 0])`"),
            );
        }
    }

    /// An argument of `at` besides the place.
    fn part_of_place(&mut self, scope: &Scope<'p>, name: &str, value: &Expr) {
        match name {
            "in" => {
                let due = Due::new("`in` of `at`");
                self.expect(scope, value, &Type::Marker, &due);
            }
            "by" => {
                let angle = Type::Scalar(Quantity::hard(Dimension::ANGLE));
                self.expect(scope, value, &angle, &Due::new("`by` of `at`"));
            }
            "about" => {
                let is_axis = matches!(&value.kind, ExprKind::Name(axis) if matches!(axis.as_str(), "x" | "y" | "z"));
                if !is_axis {
                    self.report(
                        Diagnostic::error(codes::MARKER, "`about` names an axis of the marker")
                            .at(value.span, "expected `x`, `y` or `z`"),
                    );
                }
            }
            _ => {
                let due = Due::new(format!("the direction `{name}` of a marker"));
                self.expect(scope, value, &Type::vector(Quantity::one()), &due);
            }
        }
    }
}
