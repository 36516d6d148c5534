//! Types of expressions.

use super::Checker;
use super::mismatch::Due;
use super::scope::Scope;
use super::types::{Misfit, Quantity, SignalRows, Type};
use crate::codes;
use crate::program::{DefinitionId, unit_text};
use eng_grammar::ast::{Binder, Expr, ExprKind, IndexArgument, Kind, UnaryOp, UnitExpr};
use eng_grammar::{Diagnostic, Span};

/// The number of elements of a range or list, if it is written in plain numbers.
pub(super) fn literal_length(range: &Expr) -> Option<u32> {
    let whole = |expr: &Expr| match &expr.kind {
        ExprKind::Number {
            value,
            integer: true,
            unit: None,
        } => Some(*value as i64),
        _ => None,
    };
    match &range.kind {
        ExprKind::Range { from, to, by: None } => u32::try_from(whole(to)? - whole(from)? + 1).ok(),
        ExprKind::List { items, .. } => u32::try_from(items.len()).ok(),
        _ => None,
    }
}

/// Whether a range is `1..n`.
pub(super) fn counts_from_one(range: &Expr) -> bool {
    match &range.kind {
        ExprKind::Range { from, .. } => matches!(
            from.kind,
            ExprKind::Number {
                value: 1.0,
                integer: true,
                unit: None
            }
        ),
        _ => false,
    }
}

impl<'p> Checker<'p> {
    /// The type of an expression. Stores it in the findings.
    pub(super) fn infer(&mut self, scope: &Scope<'p>, expr: &Expr) -> Type {
        let outer = self.function_due;
        // a function is due in the parts of these expressions only
        self.function_due &= matches!(
            expr.kind,
            ExprKind::Paren { .. }
                | ExprKind::List { .. }
                | ExprKind::Comprehension { .. }
                | ExprKind::If { .. }
                | ExprKind::Call { .. }
        );
        let ty = self.type_of(scope, expr);
        self.function_due = outer;
        self.findings.types.insert(expr.span, ty.clone());
        ty
    }

    fn type_of(&mut self, scope: &Scope<'p>, expr: &Expr) -> Type {
        match &expr.kind {
            ExprKind::Error => Type::Error,
            ExprKind::Number {
                value,
                integer,
                unit,
            } => match unit {
                Some(unit) => match self.quantity_of(scope, unit) {
                    Some(quantity) => {
                        self.many_turns(scope, *value, unit, expr.span);
                        Type::Scalar(quantity)
                    }
                    None => Type::Error,
                },
                None if *integer => Type::Int,
                None => Type::one(),
            },
            ExprKind::Text(_) => Type::Text,
            ExprKind::Bool(_) => Type::Bool,
            ExprKind::Name(name) => self.name(scope, name, expr.span),
            ExprKind::List { items, unit } => {
                if let Some(unit) = unit {
                    for item in items {
                        if let ExprKind::Number { value, .. } = &item.kind {
                            self.many_turns(scope, *value, unit, item.span);
                        }
                    }
                }
                self.list(scope, items, unit.as_ref(), expr.span)
            }
            ExprKind::Comprehension {
                body,
                binders,
                unit,
            } => self.comprehension(scope, body, binders, unit.as_ref()),
            ExprKind::Paren { inner, unit } => {
                let ty = self.infer(scope, inner);
                match unit {
                    Some(unit) => self.scaled(scope, ty, unit, inner.span),
                    None => ty,
                }
            }
            ExprKind::Field { base, name } => self.field(scope, base, name),
            ExprKind::Call { callee, arguments } => self.call(scope, expr.span, callee, arguments),
            ExprKind::Index { base, indices } => self.index(scope, base, indices, expr.span),
            ExprKind::Unary { op, operand } => self.unary(scope, *op, operand),
            ExprKind::Binary {
                op,
                op_span,
                left,
                right,
            } => self.binary(scope, *op, *op_span, left, right),
            ExprKind::If {
                condition,
                then,
                otherwise,
            } => self.conditional(scope, (condition, then, otherwise.as_deref()), &[]),
            ExprKind::Range { from, to, by } => self.range(scope, from, to, by.as_deref()),
        }
    }

    /// Checks an expression that must be true or false.
    pub(super) fn condition(&mut self, scope: &Scope<'p>, expr: &Expr, what: &str) {
        let outer = std::mem::replace(&mut self.function_due, false);
        let ty = self.infer_due(scope, expr, None);
        self.function_due = outer;
        if ty.is_error() || ty == Type::Bool {
            return;
        }
        let found = self.describe(&ty);
        self.report(
            Diagnostic::error(
                codes::CONDITION,
                format!("{what} must be true or false, not {found}"),
            )
            .at(expr.span, format!("this is {found}"))
            .with_help("compare it with something: `x > 0 mm`"),
        );
    }

    /// The type of a list or parenthesis with a unit after it. The numbers inside must be plain.
    fn scaled(&mut self, scope: &Scope<'p>, ty: Type, unit: &UnitExpr, inside: Span) -> Type {
        let Some(quantity) = self.quantity_of(scope, unit) else {
            return Type::Error;
        };
        match ty {
            Type::Error => Type::Error,
            Type::Int => Type::Scalar(quantity),
            Type::Scalar(inner) if inner.dim.is_plain() && (inner.soft || inner.dim.is_one()) => {
                Type::Scalar(quantity)
            }
            Type::List {
                element,
                length,
                framed,
            } => {
                let element = self.scaled(scope, *element, unit, inside);
                Type::List {
                    element: Box::new(element),
                    length,
                    framed,
                }
            }
            other => {
                let found = self.describe(&other);
                self.report(
                    Diagnostic::error(
                        codes::UNIT_TWICE,
                        format!("the unit `{}` follows {found}", unit_text(unit)),
                    )
                    .at(unit.span, "a unit makes a quantity of a plain number")
                    .also(inside, format!("this is {found} already"))
                    .with_help(
                        "omit the unit; a product of values is written with spaces and a number: `x * 1 mm`",
                    ),
                );
                Type::Error
            }
        }
    }

    fn list(
        &mut self,
        scope: &Scope<'p>,
        items: &[Expr],
        unit: Option<&UnitExpr>,
        span: Span,
    ) -> Type {
        let Some(first) = items.first() else {
            self.report(
                Diagnostic::error(codes::LIST_LENGTH, "a list needs an element")
                    .at(span, "an empty list has no type"),
            );
            return Type::Error;
        };
        let types: Vec<Type> = items.iter().map(|item| self.infer(scope, item)).collect();
        if types.iter().any(Type::is_error) || self.lacks_units(items, &types, span) {
            return Type::Error;
        }
        let mut element = types.first().cloned().unwrap_or(Type::Error);
        for (ty, item) in types.iter().zip(items).skip(1) {
            let (a, b) = ((&element, first.span), (ty, item.span));
            element = self.join(a, b, "the elements of a list");
            if element.is_error() {
                return Type::Error;
            }
        }
        if matches!(element, Type::Range(_)) {
            self.report(
                Diagnostic::error(codes::RANGE, "a range is in a list")
                    .at(span, "a range is a list itself: omit the brackets"),
            );
            return Type::Error;
        }
        let list = Type::list(element, u32::try_from(items.len()).ok());
        match unit {
            Some(unit) => self.scaled(scope, list, unit, span),
            None => list,
        }
    }

    /// Reports bare numbers beside quantities in a list: `[0, 0, bore]`. Returns whether there are any.
    fn lacks_units(&mut self, items: &[Expr], types: &[Type], span: Span) -> bool {
        let quantity = types
            .iter()
            .zip(items)
            .filter_map(|(ty, item)| Some((ty.quantity()?, item)))
            .find(|(quantity, _)| !quantity.dim.is_plain());
        let Some((wanted, other)) = quantity else {
            return false;
        };
        let bare: Vec<&Expr> = items.iter().filter(|item| is_bare(item)).collect();
        let Some(first) = bare.first() else {
            return false;
        };
        let unit = super::declare::written_unit(other).or_else(|| self.usual_unit(&wanted));
        let due = Due {
            what: "an element of this list".to_owned(),
            declared: Some((
                other.span,
                format!(
                    "this element is {}",
                    self.describe(&Type::Scalar(wanted.clone()))
                ),
            )),
            unit: unit.clone(),
        };
        if bare.len() == 1 {
            self.misfit(first, Misfit::Dimension, &Quantity::one(), &wanted, &due);
            return true;
        }
        let name = super::describe::with_article(&self.quantity_name(&wanted));
        let mut message = Diagnostic::error(
            codes::UNIT_MISSING,
            format!(
                "{} elements of this list need a unit: each is {name}",
                bare.len()
            ),
        );
        for expr in &bare {
            message = message.at(expr.span, "a number without a unit");
        }
        if let Some((place, text)) = due.declared {
            message = message.also(place, text);
        }
        if let Some(unit) = unit {
            let source = self.sources.text(span).to_owned();
            let mut mended = source.clone();
            for expr in bare.iter().rev() {
                let at = expr.span.end.saturating_sub(span.start) as usize;
                if mended.is_char_boundary(at) {
                    mended.insert_str(at, &format!(" {unit}"));
                }
            }
            message = message
                .with_help(format!("write `{mended}`, or the intended unit"))
                .with_fix(format!("add the unit `{unit}`"), span, mended);
        }
        self.report(message);
        true
    }

    /// The common type of two alternatives.
    pub(super) fn join(
        &mut self,
        (a, a_span): (&Type, Span),
        (b, b_span): (&Type, Span),
        what: &str,
    ) -> Type {
        if a.is_error() || b.is_error() {
            return Type::Error;
        }
        let joined = match (a, b) {
            (Type::Int, Type::Int) => return Type::Int,
            (Type::Signal { rows, .. }, Type::Signal { rows: others, .. }) => {
                // a list may hold modes, or frequencies, of several analyses
                let alike = matches!(
                    (rows, others),
                    (SignalRows::Modes(_), SignalRows::Modes(_))
                        | (SignalRows::Frequencies(_), SignalRows::Frequencies(_))
                );
                if !alike && self.common_rows(b_span, a, b).is_none() {
                    return Type::Error;
                }
                let of_row = self.join((&a.row(), a_span), (&b.row(), b_span), what);
                return of_row.in_rows(rows);
            }
            (Type::Vector { quantity: p, .. }, Type::Vector { quantity: q, .. }) => {
                p.join(q).map(Type::vector)
            }
            (
                Type::List {
                    element: e,
                    length: m,
                    framed: f,
                },
                Type::List {
                    element: g,
                    length: n,
                    framed: h,
                },
            ) if m.is_none() || n.is_none() || m == n => {
                let element = self.join((e, a_span), (g, b_span), what);
                if element.is_error() {
                    return Type::Error;
                }
                return Type::List {
                    element: Box::new(element),
                    length: m.or(*n),
                    framed: *f || *h,
                };
            }
            (Type::Body(_), Type::Body(_)) if a != b => return Type::Body(None),
            (Type::Bound(bound), other) | (other, Type::Bound(bound)) => {
                let class = Type::Class(bound.class);
                // two classes with arguments differ even if they are one class
                let (own, other) = match other {
                    Type::Bound(other) => (bound.class, other.class),
                    Type::Class(other) | Type::ClassOf(other) => (bound.class, *other),
                    _ => return self.join((&class, a_span), (b, b_span), what),
                };
                match self.common_interface(own, other) {
                    Some(interface) => return Type::ClassOf(interface),
                    None => Err(Misfit::Dimension),
                }
            }
            // A choice between classes or records has the type of their most specific common interface.
            (Type::Class(c) | Type::ClassOf(c), Type::Class(d) | Type::ClassOf(d)) if c != d => {
                match self.common_interface(*c, *d) {
                    Some(interface) => return Type::ClassOf(interface),
                    None => Err(Misfit::Dimension),
                }
            }
            (Type::Instance(c) | Type::InstanceOf(c), Type::Instance(d) | Type::InstanceOf(d))
                if c != d =>
            {
                match self.common_interface(*c, *d) {
                    Some(interface) => return Type::InstanceOf(interface),
                    None => Err(Misfit::Dimension),
                }
            }
            _ => match (a.quantity(), b.quantity()) {
                (Some(p), Some(q)) => p.join(&q).map(Type::Scalar),
                _ if a == b => return a.clone(),
                _ => Err(Misfit::Dimension),
            },
        };
        match joined {
            Ok(ty) => ty,
            Err(misfit) => {
                let (text_a, text_b) = (self.describe(a), self.describe(b));
                let title = match misfit {
                    Misfit::Angle => format!("{what} differ by an angle: {text_a} and {text_b}"),
                    Misfit::Dimension | Misfit::Point => {
                        format!("{what} differ: {text_a} and {text_b}")
                    }
                };
                self.report(
                    Diagnostic::error(codes::LIST_ELEMENTS, title)
                        .at(b_span, format!("this is {text_b}"))
                        .also(a_span, format!("this is {text_a}")),
                );
                Type::Error
            }
        }
    }

    /// The most specific common interface of two definitions.
    fn common_interface(&self, a: DefinitionId, b: DefinitionId) -> Option<DefinitionId> {
        let of_b = self.program.lineage(b);
        let is_interface = |id: &DefinitionId| {
            self.declaration(*id)
                .is_some_and(|d| d.kind == Kind::Interface)
        };
        let of_a = self.program.lineage(a).into_iter().rev();
        of_a.filter(is_interface).find(|id| of_b.contains(id))
    }

    /// The scope with the names of binders.
    pub(super) fn binders(&mut self, scope: &Scope<'p>, binders: &[Binder]) -> Scope<'p> {
        let mut inner = scope.clone();
        for binder in binders {
            let ty = self.infer(&inner, &binder.range);
            let element = match ty {
                Type::Range(element) => *element,
                Type::List { element, .. } => *element,
                Type::Error => Type::Error,
                other => {
                    let found = self.describe(&other);
                    self.report(
                        Diagnostic::error(
                            codes::RANGE,
                            format!("`{}` must run over a range or a list", binder.name.text),
                        )
                        .at(binder.range.span, format!("this is {found}"))
                        .with_help("for instance `i in 1..4`"),
                    );
                    Type::Error
                }
            };
            if !element.is_error() {
                self.structural(&inner, &binder.range);
            }
            self.hides_word(&binder.name, &element);
            self.not_local(&inner, &binder.name);
            self.not_member(&inner, &binder.name);
            inner.locals.push((binder.name.clone(), element));
        }
        inner
    }

    fn comprehension(
        &mut self,
        scope: &Scope<'p>,
        body: &Expr,
        binders: &[Binder],
        unit: Option<&UnitExpr>,
    ) -> Type {
        let inner = self.binders(scope, binders);
        let element = self.infer(&inner, body);
        if element.is_error() {
            return Type::Error;
        }
        let length = match binders {
            [one] => literal_length(&one.range),
            _ => None,
        };
        let list = Type::list(element, length);
        match unit {
            Some(unit) => self.scaled(scope, list, unit, body.span),
            None => list,
        }
    }

    fn range(&mut self, scope: &Scope<'p>, from: &Expr, to: &Expr, by: Option<&Expr>) -> Type {
        let a = self.infer(scope, from);
        let b = self.infer(scope, to);
        let step = by.map(|by| (by, self.infer(scope, by)));
        if a.is_error() || b.is_error() || step.as_ref().is_some_and(|(_, ty)| ty.is_error()) {
            return Type::Error;
        }
        for (ty, expr) in [(&a, from), (&b, to)] {
            if ty.quantity().is_none() {
                let found = self.describe(ty);
                self.report(
                    Diagnostic::error(codes::RANGE, "a range runs from a number to a number")
                        .at(expr.span, format!("this is {found}")),
                );
                return Type::Error;
            }
        }
        let element = self.join((&a, from.span), (&b, to.span), "the ends of a range");
        if element.is_error() {
            return Type::Error;
        }
        match step {
            None if element.quantity().is_some_and(|q| q.dim.is_one()) && element != Type::Int => {
                let (end, ty) = if a == Type::Int { (to, &b) } else { (from, &a) };
                let found = self.describe(ty);
                self.report(
                    Diagnostic::error(
                        codes::RANGE,
                        "a range without a step counts in whole numbers",
                    )
                    .at(end.span, format!("this is {found}"))
                    .with_help(
                        "a count is an `Int`; a range of numbers has a step: `0 .. 1 by 0.1`",
                    ),
                );
                Type::Error
            }
            None if element != Type::Int => {
                self.report(
                    Diagnostic::error(codes::RANGE, "a range of quantities needs a step")
                        .at(from.span.to(to.span), "which values lie between?")
                        .with_help("for instance `1000 rpm .. 6000 rpm by 250 rpm`"),
                );
                Type::Error
            }
            None => Type::Range(Box::new(element)),
            Some((by, ty)) => {
                let (Some(quantity), Some(whole)) = (ty.quantity(), element.quantity()) else {
                    let found = self.describe(&ty);
                    self.report(
                        Diagnostic::error(codes::RANGE, "the step of a range is a number")
                            .at(by.span, format!("this is {found}")),
                    );
                    return Type::Error;
                };
                // The step is a difference even if the ends are points.
                let ends = Quantity {
                    kind: super::types::Kind::Difference,
                    ..whole
                };
                if let Err(misfit) = quantity.fits(&ends) {
                    let due = Due::new("the step of this range")
                        .declared(from.span.to(to.span), "the range");
                    return self.misfit(by, misfit, &quantity, &ends, &due);
                }
                if element == Type::Int && ty != Type::Int {
                    return Type::Range(Box::new(Type::one()));
                }
                Type::Range(Box::new(element))
            }
        }
    }

    fn index(
        &mut self,
        scope: &Scope<'p>,
        base: &Expr,
        indices: &[IndexArgument],
        span: Span,
    ) -> Type {
        let mut ty = self.infer(scope, base);
        let mut taken: Vec<Option<u32>> = Vec::new();
        for index in indices {
            if let IndexArgument::At(at) = index {
                let found = self.infer(scope, at);
                let slice = matches!(&found, Type::Range(inner) if **inner == Type::Int);
                if slice {
                    taken.push(literal_length(at));
                    ty = match ty {
                        Type::List { element, .. } => *element,
                        other => self.not_indexed(base, &other, span),
                    };
                    continue;
                }
                if !found.is_error() && found != Type::Int {
                    let text = self.describe(&found);
                    self.report(
                        Diagnostic::error(
                            codes::INDEX,
                            "an index is a whole number, counted from 1",
                        )
                        .at(at.span, format!("this is {text}")),
                    );
                    ty = Type::Error;
                }
                if found.is_error() {
                    ty = Type::Error;
                }
                if let (
                    Type::List {
                        length: Some(length),
                        ..
                    },
                    ExprKind::Number { value, .. },
                ) = (&ty, &at.kind)
                    && (*value < 1.0 || *value > f64::from(*length))
                {
                    let shown = self.sources.text(base.span).to_owned();
                    self.report(
                        Diagnostic::error(
                            codes::INDEX,
                            format!("`{shown}` has {length} elements, and none at {value}"),
                        )
                        .at(at.span, format!("counts from 1 to {length}")),
                    );
                    ty = Type::Error;
                }
            }
            ty = match ty {
                Type::List {
                    element, length, ..
                } => {
                    if matches!(index, IndexArgument::All(_)) {
                        taken.push(length);
                    }
                    *element
                }
                Type::Error => Type::Error,
                other => self.not_indexed(base, &other, span),
            };
        }
        if ty.is_error() {
            return Type::Error;
        }
        taken.into_iter().rev().fold(ty, Type::list)
    }

    fn not_indexed(&mut self, base: &Expr, ty: &Type, span: Span) -> Type {
        if ty.is_error() {
            return Type::Error;
        }
        let found = self.describe(ty);
        let shown = self.sources.text(base.span).to_owned();
        let mut message = Diagnostic::error(
            codes::INDEX,
            format!("`{shown}` has no such index: it is {found}"),
        )
        .at(span, "one index too many");
        if matches!(ty, Type::Vector { .. }) {
            message = message.with_help("components are taken by `local(v, marker).x`");
        }
        self.report(message);
        Type::Error
    }

    fn unary(&mut self, scope: &Scope<'p>, op: UnaryOp, operand: &Expr) -> Type {
        let ty = self.infer(scope, operand);
        self.signed(op, operand, ty)
    }

    /// The type of `-` or `not` before an operand of known type.
    pub(super) fn signed(&mut self, op: UnaryOp, operand: &Expr, ty: Type) -> Type {
        match (op, &ty) {
            (_, Type::Signal { rows, .. }) => self.signed(op, operand, ty.row()).in_rows(rows),
            (_, Type::Error) => Type::Error,
            (UnaryOp::Not, Type::Bool) => Type::Bool,
            (UnaryOp::Negate, Type::Int) => Type::Int,
            (UnaryOp::Negate, Type::Scalar(quantity)) => {
                if self.is_affine_point(quantity) {
                    return self.multiple_of_point(quantity, operand.span, "negated");
                }
                Type::Scalar(Quantity {
                    kind: quantity.kind.of_size(),
                    ..quantity.clone()
                })
            }
            (UnaryOp::Negate, Type::Vector { quantity, .. }) => Type::vector(quantity.clone()),
            (UnaryOp::Negate, Type::List { .. }) if ty.components().is_some() => ty,
            _ => {
                let found = self.describe(&ty);
                let (sign, wants) = match op {
                    UnaryOp::Not => ("not", "true or false"),
                    UnaryOp::Negate => ("-", "a number or a vector"),
                };
                self.report(
                    Diagnostic::error(
                        codes::OPERATOR,
                        format!("`{sign}` does not apply to {found}"),
                    )
                    .at(operand.span, format!("needs {wants}")),
                );
                Type::Error
            }
        }
    }
}

/// Whether an expression is a number without a unit.
fn is_bare(expr: &Expr) -> bool {
    match &expr.kind {
        ExprKind::Number { unit: None, .. } => true,
        ExprKind::Unary {
            op: UnaryOp::Negate,
            operand,
        } => is_bare(operand),
        _ => false,
    }
}
