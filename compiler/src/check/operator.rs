//! Binary operators.

use super::Checker;
use super::mismatch::Due;
use super::scope::Scope;
use super::types::{Kind, Misfit, Quantity, Type};
use crate::codes;
use eng_grammar::ast::{BinaryOp, Expr, ExprKind, UnaryOp};
use eng_grammar::{Diagnostic, Span};
use eng_system::Dimension;

/// The operator as written.
fn sign(op: BinaryOp) -> &'static str {
    match op {
        BinaryOp::Or => "or",
        BinaryOp::And => "and",
        BinaryOp::Equal => "==",
        BinaryOp::NotEqual => "!=",
        BinaryOp::Less => "<",
        BinaryOp::LessEqual => "<=",
        BinaryOp::Greater => ">",
        BinaryOp::GreaterEqual => ">=",
        BinaryOp::Add => "+",
        BinaryOp::Subtract => "-",
        BinaryOp::Multiply => "*",
        BinaryOp::Divide => "/",
        BinaryOp::Power => "^",
    }
}

impl<'p> Checker<'p> {
    pub(super) fn binary(
        &mut self,
        scope: &Scope<'p>,
        op: BinaryOp,
        op_span: Span,
        left: &Expr,
        right: &Expr,
    ) -> Type {
        if matches!(op, BinaryOp::And | BinaryOp::Or) {
            self.condition(scope, left, &format!("the left side of `{}`", sign(op)));
            self.condition(scope, right, &format!("the right side of `{}`", sign(op)));
            return Type::Bool;
        }
        if self.blank_in_unit(scope, op, left, right)
            || self.units_behind_values(scope, (op, op_span), left, right)
        {
            return Type::Error;
        }
        if matches!(op, BinaryOp::Equal | BinaryOp::NotEqual) {
            let (a, b) = self.sides_of_equality(scope, left, right);
            return self.operated(op, op_span, (left, &a), (right, &b));
        }
        let a = self.infer(scope, left);
        if self.neither_unit_nor_value(scope, (op, op_span), left, right) {
            return Type::Error;
        }
        let b = self.infer(scope, right);
        self.operated(op, op_span, (left, &a), (right, &b))
    }

    /// Reports a unit that a blank separates from the unit before it (`4 N*m *s/rad`), or a point in a unit
    /// (`4 kg*m.s`).
    fn blank_in_unit(
        &mut self,
        scope: &Scope<'p>,
        op: BinaryOp,
        left: &Expr,
        right: &Expr,
    ) -> bool {
        if !matches!(op, BinaryOp::Multiply | BinaryOp::Divide) {
            return false;
        }
        let mut left = left;
        let mut parts = vec![right];
        while let ExprKind::Binary {
            op: BinaryOp::Multiply | BinaryOp::Divide,
            left: inner,
            right,
            ..
        } = &left.kind
        {
            parts.push(right);
            left = inner;
        }
        let (ExprKind::Number {
            unit: Some(unit), ..
        }
        | ExprKind::List {
            unit: Some(unit), ..
        }
        | ExprKind::Paren {
            unit: Some(unit), ..
        }) = &left.kind
        else {
            return false;
        };
        let mut dotted = false;
        for part in parts {
            let mut names = Vec::new();
            let base = match &part.kind {
                ExprKind::Binary {
                    op: BinaryOp::Power,
                    left,
                    ..
                } => left,
                _ => part,
            };
            match &base.kind {
                ExprKind::Name(name) => names.push(name),
                ExprKind::Field { base, name } => {
                    dotted = true;
                    names.push(&name.text);
                    match &base.kind {
                        ExprKind::Name(name) => names.push(name),
                        _ => return false,
                    }
                }
                _ => return false,
            }
            let units = &self.program.units;
            if !names.iter().all(|name| units.contains_key(*name))
                || names.iter().any(|name| self.find(scope, name).is_some())
            {
                return false;
            }
        }
        let whole = unit.span.to(right.span);
        let text = self.sources.text(whole);
        let title = match text.contains(char::is_whitespace) {
            true => "a space is in a unit",
            false => "a product of units is written with `*`",
        };
        let mut joined: String = text.chars().filter(|c| !c.is_whitespace()).collect();
        if dotted {
            joined = joined.replace('.', "*");
        }
        self.report(
            Diagnostic::error(codes::UNKNOWN_UNIT, title)
                .at(whole, "read as a product of values")
                .with_fix(format!("write `{joined}`"), whole, joined),
        );
        true
    }

    /// The type of an operator between two sides of known types, except `and` and `or`.
    pub(super) fn operated(
        &mut self,
        op: BinaryOp,
        op_span: Span,
        (left, a): (&Expr, &Type),
        (right, b): (&Expr, &Type),
    ) -> Type {
        if a.is_error() || b.is_error() {
            // A comparison is a condition, even after an error in its sides.
            return match op.is_comparison() {
                true => Type::Bool,
                false => Type::Error,
            };
        }
        if [a, b]
            .iter()
            .any(|side| matches!(side, Type::Signal { .. }))
        {
            return self.operated_by_rows(op, op_span, (left, a), (right, b));
        }
        let sides = Sides {
            op,
            op_span,
            left,
            right,
        };
        match op {
            BinaryOp::Or | BinaryOp::And => Type::Bool,
            BinaryOp::Equal
            | BinaryOp::NotEqual
            | BinaryOp::Less
            | BinaryOp::LessEqual
            | BinaryOp::Greater
            | BinaryOp::GreaterEqual => {
                self.comparison(&sides, a, b);
                Type::Bool
            }
            BinaryOp::Add if *a == Type::ModeSet && *b == Type::ModeSet => Type::ModeSet,
            BinaryOp::Add | BinaryOp::Subtract => self.sum(&sides, a, b),
            BinaryOp::Multiply => self.product(&sides, a, b),
            BinaryOp::Divide => self.quotient(&sides, a, b),
            BinaryOp::Power => self.power(&sides, a, b),
        }
    }

    fn comparison(&mut self, sides: &Sides<'_>, a: &Type, b: &Type) {
        let equality = matches!(sides.op, BinaryOp::Equal | BinaryOp::NotEqual);
        match (a, b) {
            (Type::Text, Type::Text) | (Type::Bool, Type::Bool) if equality => {}
            (Type::Choice(of), Type::Choice(other)) if equality && of == other => {}
            _ => match (a.quantity(), b.quantity()) {
                (Some(p), Some(q)) => {
                    if let Err(misfit) = p.fits(&q) {
                        self.operands(sides, misfit, &p, &q);
                    }
                }
                _ => {
                    self.inapplicable(sides, a, b);
                }
            },
        }
    }

    /// Checks both sides of a constraint, which are scalars or vectors.
    pub(super) fn equation(&mut self, scope: &Scope<'p>, expr: &Expr) {
        let inner = strip(expr);
        let ExprKind::Binary {
            op: BinaryOp::Equal,
            op_span,
            left,
            right,
        } = &inner.kind
        else {
            let ty = self.infer(scope, inner);
            if matches!(inner.kind, ExprKind::Error) || ty.is_error() {
                return;
            }
            self.report(
                Diagnostic::error(codes::CONSTRAINT_FORM, "a constraint is an equation")
                    .at(expr.span, "no `==` here")
                    .with_help("write `constrain left == right`"),
            );
            return;
        };
        let a = self.infer(scope, left);
        let b = self.infer(scope, right);
        if a.is_error() || b.is_error() {
            return;
        }
        let sides = Sides {
            op: BinaryOp::Equal,
            op_span: *op_span,
            left,
            right,
        };
        let vector = |ty: &Type| match ty {
            Type::Vector { quantity, .. } => Some(quantity.clone()),
            _ => None,
        };
        let ground_list = |ty: &Type| match ty {
            Type::List {
                length: None | Some(3),
                framed: false,
                ..
            } => ty.components().map(|(quantity, _)| quantity),
            _ => None,
        };
        let pair = match (a.quantity(), b.quantity()) {
            (Some(p), Some(q)) => Some((p, q)),
            _ => match (vector(&a), vector(&b)) {
                (Some(p), Some(q)) => Some((p, q)),
                (Some(p), None) => ground_list(&b).map(|q| (p, q)),
                (None, Some(q)) => ground_list(&a).map(|p| (p, q)),
                (None, None) => None,
            },
        };
        match pair {
            Some((p, q)) => {
                if let Err(misfit) = p.fits(&q) {
                    self.operands(&sides, misfit, &p, &q);
                }
            }
            None => {
                let (text_a, text_b) = (self.describe(&a), self.describe(&b));
                self.report(
                    Diagnostic::error(
                        codes::CONSTRAINT_FORM,
                        "a constraint equates two numbers or two vectors",
                    )
                    .at(left.span, format!("this is {text_a}"))
                    .at(right.span, format!("this is {text_b}"))
                    .with_help(
                        "components are constrained one by one: `constrain dot(e, m.x) == 0 mm`",
                    ),
                );
            }
        }
    }

    fn sum(&mut self, sides: &Sides<'_>, a: &Type, b: &Type) -> Type {
        let minus = sides.op == BinaryOp::Subtract;
        if (a, b) == (&Type::Int, &Type::Int) {
            return Type::Int;
        }
        if let (Some(p), Some(q)) = (a.quantity(), b.quantity()) {
            return match p.plus(&q, minus) {
                Ok(quantity) => Type::Scalar(quantity),
                Err(misfit) => self.operands(sides, misfit, &p, &q),
            };
        }
        match (a, b) {
            (Type::Vector { quantity: p, .. }, Type::Vector { quantity: q, .. }) => {
                match p.plus(q, minus) {
                    Ok(quantity) => Type::vector(quantity),
                    Err(misfit) => self.operands(sides, misfit, p, q),
                }
            }
            // A list of three beside a vector is a vector in the ground's axes.
            (Type::Vector { quantity: p, .. }, Type::List { .. })
            | (Type::List { .. }, Type::Vector { quantity: p, .. }) => {
                let (list, expr) = if matches!(a, Type::List { .. }) {
                    (a, sides.left)
                } else {
                    (b, sides.right)
                };
                let due = Due::new("the other side of this sum");
                match self.fit(expr, list, &Type::vector(p.clone()), &due) {
                    Type::Error => Type::Error,
                    _ => Type::vector(p.clone()),
                }
            }
            (
                Type::List {
                    length: m,
                    framed: f,
                    ..
                },
                Type::List {
                    length: n,
                    framed: g,
                    ..
                },
            ) => {
                let (Some((p, _)), Some((q, _))) = (a.components(), b.components()) else {
                    return self.inapplicable(sides, a, b);
                };
                if let (Some(m), Some(n)) = (m, n)
                    && m != n
                {
                    self.report(
                        Diagnostic::error(
                            codes::LIST_LENGTH,
                            format!("a list of {m} and a list of {n} cannot be added"),
                        )
                        .at(sides.op_span, "element by element")
                        .also(sides.left.span, format!("{m} elements"))
                        .also(sides.right.span, format!("{n} elements")),
                    );
                    return Type::Error;
                }
                match p.plus(&q, minus) {
                    Ok(quantity) => Type::List {
                        element: Box::new(Type::Scalar(quantity)),
                        length: m.or(*n),
                        framed: *f || *g,
                    },
                    Err(misfit) => self.operands(sides, misfit, &p, &q),
                }
            }
            _ => self.inapplicable(sides, a, b),
        }
    }

    /// Whether these points have a unit with a shifted zero.
    pub(super) fn is_affine_point(&self, quantity: &Quantity) -> bool {
        match &quantity.kind {
            Kind::Point(name) => self
                .program
                .units
                .values()
                .any(|unit| unit.offset != 0.0 && unit.point.as_deref() == Some(name)),
            _ => false,
        }
    }

    pub(super) fn multiple_of_point(&mut self, quantity: &Quantity, span: Span, how: &str) -> Type {
        let name = self.quantity_name(quantity);
        self.report(
            Diagnostic::error(
                codes::POINT_ARITHMETIC,
                format!("a {name} cannot be {how}: its zero is arbitrary"),
            )
            .at(span, format!("this is a {name}"))
            .with_note("2 * 20 degC is 40 degC or 313 degC, depending on the zero")
            .with_help("take the difference to a reference first: `2*(t - reference)`"),
        );
        Type::Error
    }

    /// Refuses `2*T`.
    fn refuse_multiple(
        &mut self,
        (point, span): (&Quantity, Span),
        factor: &Quantity,
    ) -> Option<Type> {
        (factor.is_plain_number() && self.is_affine_point(point))
            .then(|| self.multiple_of_point(point, span, "multiplied"))
    }

    fn product(&mut self, sides: &Sides<'_>, a: &Type, b: &Type) -> Type {
        if (a, b) == (&Type::Int, &Type::Int) {
            return Type::Int;
        }
        if let (Some(p), Some(q)) = (a.quantity(), b.quantity()) {
            if let Some(error) = self.refuse_multiple((&p, sides.left.span), &q) {
                return error;
            }
            if let Some(error) = self.refuse_multiple((&q, sides.right.span), &p) {
                return error;
            }
            return Type::Scalar(p.times(&q));
        }
        match (a, b) {
            (Type::Vector { quantity, .. }, other) | (other, Type::Vector { quantity, .. })
                if other.quantity().is_some() =>
            {
                Type::vector(quantity.times(&other.quantity().unwrap_or_default()))
            }
            (list @ Type::List { length, framed, .. }, other)
            | (other, list @ Type::List { length, framed, .. })
                if other.quantity().is_some() && list.components().is_some() =>
            {
                let quantity = list.components().map(|(q, _)| q).unwrap_or_default();
                Type::List {
                    element: Box::new(Type::Scalar(
                        quantity.times(&other.quantity().unwrap_or_default()),
                    )),
                    length: *length,
                    framed: *framed,
                }
            }
            _ => self.inapplicable(sides, a, b),
        }
    }

    fn quotient(&mut self, sides: &Sides<'_>, a: &Type, b: &Type) -> Type {
        let Some(q) = b.quantity() else {
            return self.inapplicable(sides, a, b);
        };
        if let Some(p) = a.quantity() {
            if let Some(error) = self.refuse_multiple((&p, sides.left.span), &q) {
                return error;
            }
            return Type::Scalar(p.over(&q));
        }
        match a {
            Type::Vector { quantity, .. } => Type::vector(quantity.over(&q)),
            Type::List { length, framed, .. } if a.components().is_some() => {
                let quantity = a.components().map(|(p, _)| p).unwrap_or_default();
                Type::List {
                    element: Box::new(Type::Scalar(quantity.over(&q))),
                    length: *length,
                    framed: *framed,
                }
            }
            _ => self.inapplicable(sides, a, b),
        }
    }

    fn power(&mut self, sides: &Sides<'_>, a: &Type, b: &Type) -> Type {
        let (Some(base), Some(exponent)) = (a.quantity(), b.quantity()) else {
            return self.inapplicable(sides, a, b);
        };
        if !exponent.dim.is_plain() || !(exponent.soft || exponent.dim.is_one()) {
            let found = self.describe(b);
            self.report(
                Diagnostic::error(codes::POWER, "an exponent is a plain number")
                    .at(sides.right.span, format!("this is {found}")),
            );
            return Type::Error;
        }
        let ratio = ratio(sides.right);
        if let (Type::Int, Type::Int, Some((n, 1))) = (a, b, ratio)
            && n >= 0
        {
            return Type::Int;
        }
        if base.dim.is_one() && base.kind == Kind::Any {
            return Type::Scalar(base);
        }
        let Some((numerator, denominator)) = ratio else {
            self.report(
                Diagnostic::error(
                    codes::POWER,
                    format!(
                        "the exponent of {} must be written as a number",
                        self.describe(a)
                    ),
                )
                .at(sides.right.span, "known only later")
                .also(sides.left.span, "its dimension would be unknown")
                .with_help("make the base a plain number first, dividing it by a reference"),
            );
            return Type::Error;
        };
        match base.dim.power(numerator, denominator) {
            Some(dim) => Type::Scalar(Quantity::soft(dim)),
            None => {
                self.report(
                    Diagnostic::error(
                        codes::POWER,
                        "the exponent of a quantity must be a ratio of small whole numbers, such as 3/2",
                    )
                        .at(sides.right.span, "not such a ratio")
                        .also(sides.left.span, self.describe(a)),
                );
                Type::Error
            }
        }
    }

    /// The message for two sides that differ.
    fn operands(&mut self, sides: &Sides<'_>, misfit: Misfit, p: &Quantity, q: &Quantity) -> Type {
        let plain = |expr: &Expr| {
            matches!(strip(expr).kind, ExprKind::Number { unit: None, .. })
                || matches!(&strip(expr).kind, ExprKind::List { unit: None, items }
                    if items.iter().all(|item| matches!(item.kind, ExprKind::Number { unit: None, .. })))
        };
        let (in_full_a, in_full_b) = (self.quantity_in_full(p), self.quantity_in_full(q));
        // A bare number beside a quantity has no unit.
        for (expr, own, other, other_expr) in [
            (sides.right, q, p, sides.left),
            (sides.left, p, q, sides.right),
        ] {
            if misfit != Misfit::Point && own.dim.is_one() && plain(expr) {
                let due = Due::new("this number").declared(
                    other_expr.span,
                    format!(
                        "it is beside {}",
                        self.describe(&Type::Scalar(other.clone()))
                    ),
                );
                return self.misfit(strip(expr), Misfit::Dimension, own, other, &due);
            }
        }
        let verb = match sides.op {
            BinaryOp::Add => "added",
            BinaryOp::Subtract => "subtracted",
            BinaryOp::Equal if misfit != Misfit::Point => "equal",
            _ => "compared",
        };
        let (name_a, name_b) = (
            self.describe(&Type::Scalar(p.clone())),
            self.describe(&Type::Scalar(q.clone())),
        );
        let title = match misfit {
            Misfit::Point => format!("{name_a} and {name_b} cannot be {verb}"),
            Misfit::Dimension => format!("{name_a} and {name_b} cannot be {verb}"),
            Misfit::Angle => {
                format!("{name_a} and {name_b} differ by an angle and cannot be {verb}")
            }
        };
        let code = match misfit {
            Misfit::Dimension => codes::OPERANDS,
            Misfit::Angle => codes::ANGLE,
            Misfit::Point => codes::POINT_ARITHMETIC,
        };
        let mut message = Diagnostic::error(code, title)
            .at(sides.op_span, "the sides differ")
            .also(sides.left.span, format!("left: {in_full_a}"))
            .also(sides.right.span, format!("right: {in_full_b}"));
        match misfit {
            Misfit::Point => {
                message = message
                    .with_note(
                        "a point minus a point is a difference, and a point plus or minus a difference is a point; there is no other arithmetic of points",
                    )
                    .with_help("for a mean, write `a + (b - a)/2`");
            }
            Misfit::Angle => {
                message = message.with_note(
                    "a computed value may drop its angle, a written or declared one keeps it",
                );
            }
            Misfit::Dimension => {
                let more = self.surplus(p, q).map(|name| ("left", name, "right"));
                let less = self.surplus(q, p).map(|name| ("right", name, "left"));
                if let Some((side, name, other)) = more.or(less) {
                    message = message.with_note(format!(
                        "the {side} side has a factor of the dimension {name} more than the {other}"
                    ));
                }
            }
        }
        self.report(message);
        Type::Error
    }

    fn inapplicable(&mut self, sides: &Sides<'_>, a: &Type, b: &Type) -> Type {
        let (text_a, text_b) = (self.describe(a), self.describe(b));
        let mut message = Diagnostic::error(
            codes::OPERATOR,
            format!(
                "`{}` does not apply to {text_a} and {text_b}",
                sign(sides.op)
            ),
        )
        .at(sides.op_span, "no such operation")
        .also(sides.left.span, text_a)
        .also(sides.right.span, text_b);
        let vectors = matches!(a, Type::Vector { .. } | Type::List { .. })
            && matches!(b, Type::Vector { .. } | Type::List { .. });
        if vectors && sides.op == BinaryOp::Multiply {
            message =
                message.with_help("the products of vectors are `dot(a, b)` and `cross(a, b)`");
        } else if vectors && sides.op == BinaryOp::Equal {
            let quantity = match a {
                Type::Vector { quantity, .. } => Some(quantity.clone()),
                other => other.components().map(|(quantity, _)| quantity),
            };
            // for a length a value that is small beside any part, otherwise one of the usual unit
            let small = match quantity {
                Some(quantity) if quantity.dim.is_one() => "1e-6".to_owned(),
                Some(quantity) if quantity.dim.base == Dimension::LENGTH => "1 um".to_owned(),
                Some(quantity) => self
                    .usual_unit(&quantity)
                    .map_or_else(|| "…".to_owned(), |unit| format!("1 {unit}")),
                None => "…".to_owned(),
            };
            message =
                message.with_help(format!("compare a number of them: `norm(a - b) < {small}`"));
        } else if matches!(sides.op, BinaryOp::Power)
            && matches!(a, Type::Vector { .. } | Type::List { .. })
        {
            message = message.with_help("the square of a vector is `dot(a, a)`");
        }
        self.report(message);
        Type::Error
    }
}

/// The two sides of an operator.
struct Sides<'e> {
    op: BinaryOp,
    op_span: Span,
    left: &'e Expr,
    right: &'e Expr,
}

/// The expression without its parentheses.
fn strip(expr: &Expr) -> &Expr {
    match &expr.kind {
        ExprKind::Paren { inner, unit: None } => strip(inner),
        _ => expr,
    }
}

/// A written exponent as a ratio of integers: `2`, `-1`, `0.5`, `1/3`, `(3/2)`.
fn ratio(expr: &Expr) -> Option<(i32, i32)> {
    match &strip(expr).kind {
        ExprKind::Number {
            value, unit: None, ..
        } => {
            // Decimals of a dimension are multiples of 1/60.
            let sixtieths = value * 60.0;
            // a choice that fits an integer; dimensions have exponents below ten
            (sixtieths.fract() == 0.0 && sixtieths.abs() < 1e6)
                .then(|| reduced(sixtieths as i32, 60))
        }
        ExprKind::Unary {
            op: UnaryOp::Negate,
            operand,
        } => ratio(operand).map(|(n, d)| (-n, d)),
        ExprKind::Binary {
            op: BinaryOp::Divide,
            left,
            right,
            ..
        } => {
            let ((a, b), (c, d)) = (ratio(left)?, ratio(right)?);
            let (n, m) = (a.checked_mul(d)?, b.checked_mul(c)?);
            match m {
                0 => None,
                m if m < 0 => Some(reduced(-n, -m)),
                m => Some(reduced(n, m)),
            }
        }
        _ => None,
    }
}

fn reduced(n: i32, d: i32) -> (i32, i32) {
    let (mut a, mut b) = (n.abs(), d);
    while b != 0 {
        (a, b) = (b, a % b);
    }
    let g = a.max(1);
    (n / g, d / g)
}
