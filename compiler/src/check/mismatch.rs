//! Whether a value fits an expected type, and the messages about one that does not.

use super::Checker;
use super::describe::with_article;
use super::types::{Kind, Misfit, Quantity, Type};
use crate::codes;
use crate::program::{DefinitionId, unit_text};
use eng_grammar::ast::{Expr, ExprKind, UnaryOp, UnitExpr};
use eng_grammar::{Diagnostic, Span};
use eng_system::Dimension;

/// The expected value in words, and the place of its declaration.
#[derive(Clone, Debug)]
pub(super) struct Due {
    /// "`width` of `Short`".
    pub what: String,
    /// The place of the type's declaration, with a label.
    pub declared: Option<(Span, String)>,
    /// The unit in the declaration itself.
    pub unit: Option<String>,
}

impl Due {
    pub(super) fn new(what: impl Into<String>) -> Due {
        Due {
            what: what.into(),
            declared: None,
            unit: None,
        }
    }

    pub(super) fn declared(mut self, span: Span, text: impl Into<String>) -> Due {
        self.declared = Some((span, text.into()));
        self
    }

    fn label(&self, message: Diagnostic) -> Diagnostic {
        message.with_each(&self.declared, |message, (span, text)| {
            message.also(*span, text.clone())
        })
    }
}

/// Whether an expression consists of numbers without units.
fn is_plain_literal(expr: &Expr) -> bool {
    match &expr.kind {
        ExprKind::Number { unit, .. } => unit.is_none(),
        ExprKind::List { items, unit } => {
            unit.is_none() && !items.is_empty() && items.iter().all(is_plain_literal)
        }
        ExprKind::Paren { inner, unit } => unit.is_none() && is_plain_literal(inner),
        ExprKind::Unary {
            op: UnaryOp::Negate,
            operand,
        } => is_plain_literal(operand),
        _ => false,
    }
}

/// The unit of a literal.
fn unit_of(expr: &Expr) -> Option<&eng_grammar::ast::UnitExpr> {
    match &expr.kind {
        ExprKind::Number { unit, .. }
        | ExprKind::List { unit, .. }
        | ExprKind::Comprehension { unit, .. } => unit.as_ref(),
        ExprKind::Paren { inner, unit } => unit.as_ref().or_else(|| unit_of(inner)),
        ExprKind::Unary { operand, .. } => unit_of(operand),
        _ => None,
    }
}

impl<'p> Checker<'p> {
    /// Infers `expr` and checks that it fits `expected`. Returns its type, read as the expected one.
    pub(super) fn expect(
        &mut self,
        scope: &super::scope::Scope<'p>,
        expr: &Expr,
        expected: &Type,
        due: &Due,
    ) -> Type {
        let found = self.infer_as(scope, expr, expected);
        self.fit(expr, &found, expected, due)
    }

    /// Infers `expr`. The expected type ranks the suggestions for unknown units.
    pub(super) fn infer_as(
        &mut self,
        scope: &super::scope::Scope<'p>,
        expr: &Expr,
        expected: &Type,
    ) -> Type {
        // only the expected list states the elements that an empty list could have
        if let (ExprKind::List { items, unit: None }, Type::List { element, .. }) =
            (&expr.kind, expected)
            && items.is_empty()
        {
            let ty = Type::List {
                element: element.clone(),
                length: Some(0),
                framed: false,
            };
            self.findings.types.insert(expr.span, ty.clone());
            return ty;
        }
        let dimension = match expected {
            Type::Vector { quantity, .. } => Some(quantity.clone()),
            Type::List { element, .. } => element.quantity(),
            other => other.quantity(),
        };
        let wanted = dimension
            .filter(|quantity| unit_of(expr).is_some() && quantity.dim.is_known())
            .map(|quantity| quantity.dim.base);
        let due = match expected {
            Type::List { element, .. } => element.as_ref(),
            expected => expected,
        };
        let choice_due = match due {
            Type::Choice(id) => Some(*id),
            _ => None,
        };
        let class_due = matches!(due, Type::ClassOf(_));
        let function_due = matches!(due, Type::Function(_));
        let outer = std::mem::replace(&mut self.wanted, wanted);
        let outer_class = std::mem::replace(&mut self.class_due, class_due);
        let outer_function = std::mem::replace(&mut self.function_due, function_due);
        let found = self.infer_due(scope, expr, choice_due);
        self.wanted = outer;
        self.class_due = outer_class;
        self.function_due = outer_function;
        found
    }

    /// Like [`Checker::expect`], for an inferred type.
    pub(super) fn fit(&mut self, expr: &Expr, found: &Type, expected: &Type, due: &Due) -> Type {
        if found.is_error() || expected.is_error() {
            return Type::Error;
        }
        match (expected, found) {
            (Type::Scalar(wanted), _) if found.quantity().is_some() => {
                let quantity = found.quantity().unwrap_or_default();
                match quantity.fits(wanted) {
                    Ok(()) => expected.clone(),
                    Err(misfit) => self.misfit(expr, misfit, &quantity, wanted, due),
                }
            }
            (
                Type::Vector {
                    quantity: wanted,
                    framed,
                },
                Type::Vector { quantity, .. },
            ) => match quantity.fits(wanted) {
                Ok(()) => Type::Vector {
                    quantity: wanted.clone(),
                    framed: *framed,
                },
                Err(misfit) => self.misfit(expr, misfit, quantity, wanted, due),
            },
            (
                Type::Vector {
                    quantity: wanted, ..
                },
                Type::List { length, framed, .. },
            ) if found.components().is_some() => {
                let quantity = found.components().map(|(q, _)| q).unwrap_or_default();
                if *framed {
                    self.report(
                        due.label(
                            Diagnostic::error(
                                codes::FRAME,
                                format!(
                                    "{} is a vector, not components along a marker's axes",
                                    due.what
                                ),
                            )
                            .at(expr.span, "components, whose axes would be lost"),
                        )
                        .with_note(
                            "a list of three is a vector only where it means the ground's axes",
                        )
                        .with_help("make a vector of it: `vector(components, marker)`"),
                    );
                    return Type::Error;
                }
                if !matches!(length, None | Some(3)) {
                    return self.wrong_length(expr, 3, length.unwrap_or(0), due);
                }
                match quantity.fits(wanted) {
                    Ok(()) => expected.clone(),
                    Err(misfit) => self.misfit(expr, misfit, &quantity, wanted, due),
                }
            }
            (
                Type::List {
                    element,
                    length: wanted,
                    framed,
                },
                Type::List {
                    element: inner,
                    length,
                    framed: found_framed,
                },
            ) => {
                if let (Some(wanted), Some(length)) = (wanted, length)
                    && wanted != length
                {
                    return self.wrong_length(expr, *wanted, *length, due);
                }
                if self.fit(expr, inner, element, due).is_error() {
                    return Type::Error;
                }
                Type::List {
                    element: element.clone(),
                    length: wanted.or(*length),
                    framed: *framed || *found_framed,
                }
            }
            (Type::Int, Type::Int)
            | (Type::Bool, Type::Bool)
            | (Type::Text, Type::Text)
            | (Type::Marker, Type::Marker)
            | (Type::Body(_), Type::Body(_))
            | (Type::Cycle, Type::Cycle)
            | (Type::ModeSet, Type::ModeSet) => found.clone(),
            (Type::Instance(a), Type::Instance(b)) if a == b => found.clone(),
            (Type::Choice(a), Type::Choice(b)) if a == b => found.clone(),
            (Type::InstanceOf(interface), Type::Instance(own) | Type::InstanceOf(own))
                if self.program.fills(*own, *interface) =>
            {
                expected.clone()
            }
            (Type::ClassOf(interface), Type::ClassOf(own))
                if self.program.fills(*own, *interface) =>
            {
                expected.clone()
            }
            (Type::ClassOf(interface), Type::Class(class)) => {
                self.class_for(expr, *interface, *class, &[], due)
            }
            (Type::ClassOf(interface), Type::Bound(bound)) => {
                self.class_for(expr, *interface, bound.class, &bound.given, due)
            }
            (Type::Function(wanted), Type::Function(given)) => {
                self.function_for(expr, wanted, given, due)
            }
            _ => {
                self.wrong_type(expr, found, expected, due);
                Type::Error
            }
        }
    }

    fn wrong_length(&mut self, expr: &Expr, wanted: u32, found: u32, due: &Due) -> Type {
        let text = self.sources.text(expr.span).as_bytes();
        let commas = text
            .windows(3)
            .filter(|c| c[1] == b',' && c[0].is_ascii_digit() && c[2].is_ascii_digit())
            .count();
        let mut message = due.label(
            Diagnostic::error(
                codes::LIST_LENGTH,
                format!("{} has {wanted} elements, not {found}", due.what),
            )
            .at(expr.span, format!("{found} elements")),
        );
        if found
            .checked_sub(wanted)
            .is_some_and(|more| more > 0 && more as usize == commas)
        {
            message = message.with_help("a decimal fraction is written with a point: `1.5`");
        }
        self.report(message);
        Type::Error
    }

    /// The message for a value of a wrong type. `due` is a sentence with the expected type.
    pub(super) fn mistyped(&self, span: Span, due: &str, found: &Type) -> Diagnostic {
        let found = self.describe(found);
        Diagnostic::error(codes::WRONG_TYPE, format!("{due}, not {found}"))
            .at(span, format!("this is {found}"))
    }

    pub(super) fn wrong_type(&mut self, expr: &Expr, found: &Type, expected: &Type, due: &Due) {
        let (expected_text, found_text) = (self.describe(expected), self.describe(found));
        let mut message = due.label(
            Diagnostic::error(
                codes::WRONG_TYPE,
                format!("{} is {expected_text}, not {found_text}", due.what),
            )
            .at(expr.span, format!("this is {found_text}")),
        );
        match (expected, found) {
            (Type::Marker, Type::Body(Some(body))) => {
                let markers = self.markers_of(body);
                if let Some(first) = markers.first() {
                    message = message.with_help(format!(
                        "say which marker of the body: {}",
                        crate::resolve::suggest::listing(markers.iter().map(String::as_str), 8)
                    ));
                    if markers.len() == 2 {
                        let text = format!("{}.{first}", self.sources.text(expr.span));
                        message = message.with_fix(format!("take `{first}`"), expr.span, text);
                    }
                }
            }
            (_, Type::List { element, .. })
                if self.assignable(element, expected)
                    && !matches!(expr.kind, ExprKind::List { .. }) =>
            {
                message = message.with_help(format!(
                    "say which one: `{}[1]`",
                    self.sources.text(expr.span)
                ));
            }
            (Type::Scalar(_), Type::Vector { .. }) => {
                message = message.with_help(
                    "a vector gives a number by `norm(v)`, `dot(v, m.z)` or a component `local(v, m).x`",
                );
            }
            (Type::Choice(id), _) => {
                message = message.with_note(format!("its words are {}", self.words_of(*id)));
            }
            (Type::Int, Type::Scalar(_)) => {
                message = message.with_note("a count is written without point, exponent and unit");
            }
            (Type::Instance(own), Type::Class(_) | Type::ClassOf(_) | Type::Bound(_)) => {
                let class = self.class_name(*own);
                message = message.with_help(self.class_as_type(&class, *own));
            }
            (_, Type::Function(signature)) if self.assignable(&signature.result, expected) => {
                message = message.with_help(format!("call it: `{}(…)`", signature.name));
            }
            _ => {}
        }
        self.report(message);
    }

    /// Advice for a parameter that has the name of a class as its type, in place of an interface.
    pub(super) fn class_as_type(&self, class: &str, id: DefinitionId) -> String {
        let interface = match self.program.interface_of(id) {
            Some(interface) => self.class_name(interface),
            None => "Interface".to_owned(),
        };
        format!(
            "the type `{class}` takes an element of this class; a parameter that takes a class has an interface as its type: `law: {interface}`"
        )
    }

    /// Whether types agree, without a message.
    pub(super) fn assignable(&self, found: &Type, expected: &Type) -> bool {
        match (expected, found) {
            (Type::Scalar(wanted), found) => found
                .quantity()
                .is_some_and(|quantity| quantity.fits(wanted).is_ok()),
            (
                Type::Vector {
                    quantity: wanted, ..
                },
                Type::Vector { quantity, .. },
            ) => quantity.fits(wanted).is_ok(),
            (
                Type::List {
                    element: a,
                    length: m,
                    ..
                },
                Type::List {
                    element: b,
                    length: n,
                    ..
                },
            ) => (m.is_none() || n.is_none() || m == n) && self.assignable(b, a),
            (Type::Body(_), Type::Body(_)) => true,
            (Type::Function(wanted), Type::Function(given)) => {
                wanted.parameters.len() == given.parameters.len()
                    && wanted
                        .parameters
                        .iter()
                        .zip(&given.parameters)
                        .all(|(wanted, given)| self.assignable(&wanted.ty, &given.ty))
                    && self.assignable(&given.result, &wanted.result)
            }
            (Type::ClassOf(interface), Type::ClassOf(own) | Type::Class(own))
            | (Type::InstanceOf(interface), Type::InstanceOf(own) | Type::Instance(own)) => {
                self.program.fills(*own, *interface)
            }
            (a, b) => a == b,
        }
    }

    /// Reports a number of the wrong quantity. Returns the error type.
    pub(super) fn misfit(
        &mut self,
        expr: &Expr,
        misfit: Misfit,
        found: &Quantity,
        wanted: &Quantity,
        due: &Due,
    ) -> Type {
        let plain = is_plain_literal(expr) && found.dim.is_one();
        let message = match misfit {
            _ if plain => self.unit_missing(expr, wanted, due),
            Misfit::Dimension => self.other_dimension(expr, found, wanted, due),
            Misfit::Angle => self.other_angle(expr, found, wanted, due),
            Misfit::Point => self.other_point(expr, found, wanted, due),
        };
        self.report(due.label(message));
        Type::Error
    }

    /// The message for a number without a unit.
    pub(super) fn unit_missing(&self, expr: &Expr, wanted: &Quantity, due: &Due) -> Diagnostic {
        let name = with_article(&self.quantity_name(wanted));
        let mut message = Diagnostic::error(
            codes::UNIT_MISSING,
            format!("{} needs a unit: it is {name}", due.what),
        )
        .at(expr.span, "a number without a unit");
        let unit = self.unit_for(due.unit.as_deref(), wanted);
        if let Some(unit) = unit {
            let mended = format!("{} {unit}", self.sources.text(expr.span));
            message = message
                .with_help(format!("write `{mended}`, or the intended unit"))
                .with_fix(format!("add the unit `{unit}`"), expr.span, mended);
        }
        message
    }

    fn other_dimension(
        &self,
        expr: &Expr,
        found: &Quantity,
        wanted: &Quantity,
        due: &Due,
    ) -> Diagnostic {
        let named = |quantity: &Quantity| match quantity.dim.is_one() {
            true => "a plain number".to_owned(),
            false => with_article(&self.quantity_name(quantity)),
        };
        let (wanted_text, found_text) = (named(wanted), named(found));
        let mut message = Diagnostic::error(
            codes::DIMENSION,
            format!("{} is {wanted_text}, not {found_text}", due.what),
        )
        .at(expr.span, format!("this is {found_text}"))
        .with_note(self.expected_and_found(wanted, found));
        if wanted.dim.is_known() && found.dim.is_known() {
            if wanted.dim.is_one() && unit_of(expr).is_some() {
                message = message.with_help("omit the unit");
            } else if let Some(unit) = unit_of(expr)
                && let Some(usual) = self.unit_for(due.unit.as_deref(), wanted)
            {
                message = message.with_help(self.other_unit(wanted, &usual, unit));
            } else if unit_of(expr).is_none() {
                if let Some(name) = self.surplus(wanted, found) {
                    message =
                        message.with_help(format!("a factor of the dimension {name} is missing"));
                } else if let Some(name) = self.surplus(found, wanted) {
                    message =
                        message.with_help(format!("a factor of the dimension {name} is too much"));
                }
            }
        }
        message
    }

    fn expected_and_found(&self, wanted: &Quantity, found: &Quantity) -> String {
        format!(
            "expected {}, found {}",
            self.quantity_in_full(wanted),
            self.quantity_in_full(found)
        )
    }

    fn other_unit(&self, wanted: &Quantity, usual: &str, stated: &UnitExpr) -> String {
        format!(
            "a unit of {} is `{usual}`, not `{}`",
            self.quantity_name(wanted),
            unit_text(stated)
        )
    }

    /// The message for `66 Hz` in place of an angular velocity, and for similar mistakes.
    pub(super) fn other_angle(
        &self,
        expr: &Expr,
        found: &Quantity,
        wanted: &Quantity,
        due: &Due,
    ) -> Diagnostic {
        let mut message = Diagnostic::error(
            codes::ANGLE,
            format!(
                "{} is {}, not {}",
                due.what,
                with_article(&self.quantity_name(wanted)),
                with_article(&self.quantity_name(found))
            ),
        )
        .at(expr.span, "differs by an angle")
        .with_note(format!(
            "{}; a computed value may drop its angle, a written or declared one keeps it",
            self.expected_and_found(wanted, found)
        ));
        let speed = Dimension::ANGLE.over(Dimension::TIME);
        match unit_of(expr) {
            Some(unit)
                if wanted.dim.base == speed && wanted.dim.is_known() && unit_text(unit) == "Hz" =>
            {
                message = message.with_help(
                    "turns per second are `rev/s`, turns per minute `rpm`; `rad/s` is the SI unit",
                );
                for replacement in ["rev/s", "rpm", "rad/s"] {
                    if self.known_units(replacement) {
                        message = message.with_fix(
                            format!("write `{replacement}`"),
                            unit.span,
                            replacement,
                        );
                    }
                }
            }
            Some(unit) => {
                message = message.help_if(
                    self.unit_for(due.unit.as_deref(), wanted)
                        .map(|usual| self.other_unit(wanted, &usual, unit)),
                );
            }
            None => {
                message = message.with_help("multiply or divide by `1 rad` if you intend that");
            }
        }
        message
    }

    fn known_units(&self, text: &str) -> bool {
        text.split(['*', '/'])
            .all(|name| self.program.units.contains_key(name))
    }

    fn other_point(
        &self,
        expr: &Expr,
        found: &Quantity,
        wanted: &Quantity,
        due: &Due,
    ) -> Diagnostic {
        let (found_name, wanted_name) = (self.quantity_name(found), self.quantity_name(wanted));
        let message = Diagnostic::error(
            codes::POINT,
            format!(
                "{} is {}, not {}",
                due.what,
                with_article(&wanted_name),
                with_article(&found_name)
            ),
        );
        match (&found.kind, &wanted.kind) {
            (Kind::Point(_), Kind::Point(_)) => message
                .at(expr.span, "counted from another zero")
                .with_help("take the difference to a reference, and add it to a reference of the other kind"),
            (Kind::Point(_), _) => {
                let message = message
                    .at(expr.span, "a point, counted from a zero")
                    .with_note(format!("{wanted_name} is a difference of two {found_name} values"))
                    .with_help("subtract the reference it is counted from");
                match unit_of(expr) {
                    Some(unit) if found.dim.base == Dimension::base(4) && unit_text(unit) == "degC" => {
                        message.with_fix("a difference in kelvin", unit.span, "K")
                    }
                    _ => message,
                }
            }
            _ => message
                .at(expr.span, "a difference of points")
                .with_note(format!("{found_name} is a difference of two {wanted_name} values"))
                .with_help("add it to the reference it is counted from"),
        }
    }
}
