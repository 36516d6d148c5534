//! The types of fields: the name after a dot.

use super::Checker;
use super::scope::Scope;
use super::types::{Quantity, Type};
use crate::codes;
use crate::typed::lineage::has_cycle;
use crate::words::START_VALUES;
use eng_grammar::Diagnostic;
use eng_grammar::ast::{Declaration, Expr, ExprKind, IndexArgument, Kind, Name};
use eng_system::Dimension;

impl<'p> Checker<'p> {
    pub(super) fn field(&mut self, scope: &Scope<'p>, base: &Expr, name: &Name) -> Type {
        if let Some(word) = self.word_of_choice(scope, base, name) {
            return word;
        }
        let ty = self.infer_due(scope, base, None);
        // `rod[*].big`: of each element.
        if let (
            Type::List {
                element, length, ..
            },
            true,
        ) = (&ty, selects_all(base))
        {
            let inner = self.field_of(scope, element, base, name);
            return if inner.is_error() {
                Type::Error
            } else {
                Type::list(inner, *length)
            };
        }
        self.field_of(scope, &ty, base, name)
    }

    fn field_of(&mut self, scope: &Scope<'p>, ty: &Type, base: &Expr, name: &Name) -> Type {
        match ty {
            Type::Error => Type::Error,
            Type::Marker => self.field_of_marker(name),
            Type::Body(body) => self.field_of_body(body.as_ref(), name),
            Type::Vector { quantity, framed } => {
                self.field_of_vector(ty, (quantity, *framed), base, name)
            }
            Type::List {
                element, length, ..
            } => self.field_of_list(ty, (element, *length), base, name),
            Type::Instance(id) => self.field_of_instance(*id, name, false),
            Type::InstanceOf(id) => self.field_of_instance(*id, name, true),
            Type::Cycle => self.field_of_cycle(scope, name),
            other => {
                let what = self.describe(other);
                self.no_member(format!("{what} has no `{}`", name.text), name, []);
                Type::Error
            }
        }
    }

    /// A marker of a body, or its support; a body that is a parameter is not known.
    fn field_of_body(&mut self, body: Option<&super::types::BodyRef>, name: &Name) -> Type {
        if name.text == "origin" {
            return Type::Marker;
        }
        let Some(body) = body else {
            self.no_member(
                format!(
                    "the marker `{}` of a body that is a parameter is not known",
                    name.text
                ),
                name,
                ["origin"],
            );
            return Type::Error;
        };
        let declared = match self.member(body.definition, &body.name) {
            Some(super::member::Member::Declaration(declaration)) => declaration,
            _ => return Type::Error,
        };
        if let Some(marker) = super::scope::marker_of(declared, &name.text) {
            return self.arrayed(&marker.index, Type::Marker);
        }
        if name.text == "support"
            && super::flexible::has_support(declared)
            && let Some(weld) = self.program.weld()
        {
            return Type::Instance(weld);
        }
        if super::body::states(declared, &name.text) {
            return self.attribute_of_body(declared, name);
        }
        if name.text == "support" && declared.kind == eng_grammar::ast::Kind::Flexible {
            self.report(
                Diagnostic::error(
                    codes::NO_MEMBER,
                    format!("the body `{}` has no support", body.name),
                )
                .at(declared.name.span, "no `support = …` in its block")
                .also(name.span, "read here")
                .with_help("name the markers that hold it on the ground: `support = mount`"),
            );
            return Type::Error;
        }
        let markers = self.markers_of(body);
        let title = format!("the body `{}` has no `{}`", body.name, name.text);
        let markers = markers.iter().map(String::as_str);
        if self.start_of == Some(name.span) {
            // its members cannot be set
            self.no_member(title, name, START_VALUES);
            return Type::Error;
        }
        let mass = (declared.kind == Kind::Body).then_some("mass");
        self.no_member(title, name, markers.chain(mass));
        Type::Error
    }

    /// The mass of a body. Other attributes cannot be read.
    fn attribute_of_body(&mut self, declared: &Declaration, name: &Name) -> Type {
        let rigid = declared.kind == Kind::Body;
        if rigid && name.text == "mass" {
            return Type::Scalar(Quantity::hard(Dimension::MASS));
        }
        if rigid && !super::body::ATTRIBUTES.contains(&name.text.as_str()) {
            // the missing word `marker` is reported in the block of the body
            return Type::Error;
        }
        let body = &declared.name.text;
        let help = match rigid {
            true => format!(
                "give the value a name outside the body, and use it in both places: `let {body}_{} = …`",
                name.text
            ),
            false => "`eng reduce` prints mass, centre and inertia of a flexible body".to_owned(),
        };
        self.report(
            Diagnostic::error(
                codes::NO_MEMBER,
                format!("`{}` of the body `{body}` cannot be read", name.text),
            )
            .at(name.span, "an attribute, and no value of the model")
            .with_help(help),
        );
        Type::Error
    }

    /// A component of a vector, which needs axes.
    fn field_of_vector(
        &mut self,
        ty: &Type,
        (quantity, framed): (&Quantity, bool),
        base: &Expr,
        name: &Name,
    ) -> Type {
        if !matches!(name.text.as_str(), "x" | "y" | "z") {
            self.no_member(
                format!("a vector has no `{}`", name.text),
                name,
                if framed {
                    vec!["x", "y", "z"]
                } else {
                    Vec::new()
                },
            );
            return Type::Error;
        }
        if framed {
            return Type::Scalar(quantity.clone());
        }
        let text = self.sources.text(base.span);
        let shown = match base.kind {
            ExprKind::Binary { .. } | ExprKind::Unary { .. } => text.trim_matches(['(', ')']),
            _ => text,
        };
        let mended = format!("local({shown}, ground).{}", name.text);
        self.report(
            Diagnostic::error(
                codes::COMPONENT_WITHOUT_AXES,
                format!("`.{}` of a vector: along which axes?", name.text),
            )
            .at(name.span, "a vector carries no axes")
            .also(base.span, self.describe(ty))
            .with_help(format!(
                "say whose axes: `local({shown}, marker).{}`",
                name.text
            ))
            .with_fix("along the ground's axes", base.span.to(name.span), mended),
        );
        Type::Error
    }

    /// A component of a list of numbers; a field of other lists needs an index.
    fn field_of_list(
        &mut self,
        ty: &Type,
        (element, length): (&Type, Option<u32>),
        base: &Expr,
        name: &Name,
    ) -> Type {
        if matches!(name.text.as_str(), "x" | "y" | "z") && element.quantity().is_some() {
            let place = match name.text.as_str() {
                "x" => 1,
                "y" => 2,
                _ => 3,
            };
            if length.is_some_and(|length| place > length || length > 3) {
                self.no_member(
                    format!("{} has no `.{}`", self.describe(ty), name.text),
                    name,
                    [],
                );
                return Type::Error;
            }
            return match element {
                Type::Int => Type::one(),
                other => other.clone(),
            };
        }
        let shown = self.sources.text(base.span).to_owned();
        let found = self.describe(ty);
        self.report(
            Diagnostic::error(
                codes::INDEX,
                format!(
                    "`{shown}` is {found}: of which one is `{}` meant?",
                    name.text
                ),
            )
            .at(base.span, "an index is missing")
            .with_help(format!(
                "`{shown}[1].{}` is the value of the first, `{shown}[*].{}` a list of all",
                name.text, name.text
            )),
        );
        Type::Error
    }

    /// Names of a body's markers, `origin` last.
    pub(super) fn markers_of(&mut self, body: &super::types::BodyRef) -> Vec<String> {
        let mut names = Vec::new();
        if let Some(super::member::Member::Declaration(declared)) =
            self.member(body.definition, &body.name)
        {
            for item in declared.block().into_iter().flat_map(|b| &b.items) {
                if let eng_grammar::ast::ItemKind::Declaration(marker) = &item.kind
                    && marker.kind == eng_grammar::ast::Kind::Marker
                {
                    names.push(marker.name.text.clone());
                }
            }
        }
        names.push("origin".to_owned());
        names
    }

    fn field_of_marker(&mut self, name: &Name) -> Type {
        let per_second = |dimension: Dimension| dimension.over(Dimension::TIME);
        let dimension = match name.text.as_str() {
            "origin" => Dimension::LENGTH,
            "x" | "y" | "z" => Dimension::ONE,
            "velocity" => per_second(Dimension::LENGTH),
            "angular_velocity" => per_second(Dimension::ANGLE),
            "acceleration" => per_second(per_second(Dimension::LENGTH)),
            "angular_acceleration" => per_second(per_second(Dimension::ANGLE)),
            _ => {
                self.no_member(
                    format!("a marker has no `{}`", name.text),
                    name,
                    [
                        "origin",
                        "x",
                        "y",
                        "z",
                        "velocity",
                        "angular_velocity",
                        "acceleration",
                        "angular_acceleration",
                    ],
                );
                return Type::Error;
            }
        };
        // Axes are computed values, so their products and components may be small angles.
        let soft = matches!(name.text.as_str(), "x" | "y" | "z");
        Type::vector(Quantity {
            soft,
            ..Quantity::hard(dimension)
        })
    }

    /// The type of the cycle's angle.
    pub(super) fn cycle_angle(&self) -> Type {
        let point = self.program.dimensions.get("CrankAngle");
        let kind = match point {
            Some(named) if named.point_of.is_some() => {
                super::types::Kind::Point("CrankAngle".into())
            }
            _ => super::types::Kind::Any,
        };
        Type::Scalar(Quantity {
            kind,
            ..Quantity::hard(Dimension::ANGLE)
        })
    }

    fn field_of_cycle(&mut self, scope: &Scope<'p>, name: &Name) -> Type {
        if let Some(definition) = scope.definition
            && let Some(model) = self.declaration(definition)
            && model.kind == eng_grammar::ast::Kind::Model
            && !has_cycle(self.program, definition)
        {
            self.report(
                Diagnostic::error(
                    codes::NO_CYCLE,
                    format!("`{}` has no cycle", model.name.text),
                )
                .at(name.span, "of which cycle?")
                .also(model.name.span, "this model states none")
                .with_help("for instance `cycle angle = rotation(crank.main, ground) { period = 720 deg }`"),
            );
            return Type::Error;
        }
        match name.text.as_str() {
            "angle" => self.cycle_angle(),
            "period" => Type::Scalar(Quantity::hard(Dimension::ANGLE)),
            _ => {
                self.no_member(
                    format!("the cycle has no `{}`", name.text),
                    name,
                    ["angle", "period"],
                );
                Type::Error
            }
        }
    }
}

/// Whether the last index of an expression is `[*]`.
fn selects_all(expr: &Expr) -> bool {
    match &expr.kind {
        ExprKind::Index { indices, .. } => indices
            .iter()
            .any(|index| matches!(index, IndexArgument::All(_))),
        _ => false,
    }
}
