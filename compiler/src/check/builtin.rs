//! Types of the functions of the language.

use super::Checker;
use super::mismatch::Due;
use super::scope::Scope;
use super::types::{Quantity, Type};
use crate::codes;
use crate::functions::{BuiltIn, Kind};
use eng_grammar::ast::{Argument, Expr, ExprKind};
use eng_grammar::{Diagnostic, Span};
use eng_system::Dimension;

/// A vector or components, as an argument of a function of vectors.
struct Directed {
    quantity: Quantity,
    /// Whether it is a vector in space and not components.
    spatial: bool,
    framed: bool,
    length: Option<u32>,
}

impl<'p> Checker<'p> {
    pub(super) fn built_in(
        &mut self,
        scope: &Scope<'p>,
        function: &BuiltIn,
        span: Span,
        arguments: &[Argument],
    ) -> Type {
        if matches!(function.kind, Kind::Functions) {
            return self.of_function(scope, function, span, arguments);
        }
        let mut typed: Vec<(&Expr, Type)> = Vec::new();
        for argument in arguments {
            typed.push((&argument.value, self.infer(scope, &argument.value)));
        }
        let Some(bound) = self.bound(function, arguments, span, false) else {
            return Type::Error;
        };
        if typed.iter().any(|(_, ty)| ty.is_error()) {
            return Type::Error;
        }
        let option = function.options.iter().find_map(|name| bound.option(name));
        let (option, plain): (Vec<_>, Vec<_>) = typed
            .into_iter()
            .partition(|(expr, _)| Some(expr.span) == option.map(|option| option.span));
        let option = option.into_iter().next();
        match (function.name, plain.as_slice()) {
            ("norm", [v]) => self.norm(v, option),
            ("wrapped", [angle, period]) => self.wrapped(angle, period, option.as_ref()),
            _ => self.applied(function, &plain),
        }
    }

    /// The type of a call with arguments by place alone.
    pub(super) fn applied(&mut self, function: &BuiltIn, plain: &[(&Expr, Type)]) -> Type {
        if plain
            .iter()
            .any(|(_, ty)| matches!(ty, Type::Signal { .. }))
        {
            return self.applied_by_rows(function, plain);
        }
        match (function.kind, plain) {
            (Kind::Plain(_) | Kind::OfAngle(_), [x]) => {
                self.plain_argument(function.name, x, true, Quantity::one())
            }
            (Kind::ToAngle(_), [x]) => {
                let angle = Quantity {
                    soft: true,
                    ..Quantity::hard(Dimension::ANGLE)
                };
                self.plain_argument(function.name, x, false, angle)
            }
            (_, plain) => self.of_own_rule(function.name, plain),
        }
    }

    /// The type of a call of a function with a rule of its own.
    fn of_own_rule(&mut self, name: &str, plain: &[(&Expr, Type)]) -> Type {
        match (name, plain) {
            ("sqrt", [x]) => self.root(x),
            ("abs", [x]) => self.magnitude(x),
            ("atan2", [y, x]) => self.atan2(y, x),
            ("der", [x]) => self.rate(x),
            ("dot" | "cross", [a, b]) => self.vector_product(name, a, b),
            ("local" | "vector", [v, m]) => self.change_axes(name, v, m),
            ("perpendicular", [e]) => self.perpendicular(e),
            ("rotation", [a, b]) => {
                let a = self.marker_argument("the first argument of `rotation`", a);
                let b = self.marker_argument("the second argument of `rotation`", b);
                if a && b {
                    Type::Scalar(Quantity {
                        soft: true,
                        ..Quantity::hard(Dimension::ANGLE)
                    })
                } else {
                    Type::Error
                }
            }
            ("min" | "max", _) => self.extreme(name, plain),
            ("sum", [x]) => self.total(x),
            ("index_of", [list, value]) => self.index_of(list, value),
            ("largest" | "smallest" | "where_largest", [x]) => self.of_turn(name, x),
            ("length" | "distinct", [(expr, ty)]) => match ty {
                Type::List { .. } | Type::Range(_) if name == "length" => Type::Int,
                Type::List { element, .. } | Type::Range(element)
                    if element.quantity().is_some() =>
                {
                    Type::Bool
                }
                other => {
                    let other = other.clone();
                    let wanted = match name {
                        "length" => "a list",
                        _ => "a list of numbers",
                    };
                    self.not_a(expr, &other, &format!("the argument of `{name}`"), wanted)
                }
            },
            _ => Type::Error,
        }
    }

    /// A number of a turn without forces. Elaboration refuses it outside of lints.
    fn of_turn(&mut self, name: &str, (expr, ty): &(&Expr, Type)) -> Type {
        if !matches!(ty, Type::Int | Type::Scalar(_)) {
            let what = format!("the argument of `{name}`");
            return self.not_a(expr, ty, &what, "a number");
        }
        match name {
            "where_largest" => self.cycle_angle(),
            _ => Type::Scalar(ty.quantity().unwrap_or_default()),
        }
    }

    fn index_of(&mut self, list: &(&Expr, Type), value: &(&Expr, Type)) -> Type {
        let element = match &list.1 {
            Type::List { element, .. } | Type::Range(element) if element.quantity().is_some() => {
                element.as_ref().clone()
            }
            other => {
                let other = other.clone();
                return self.not_a(
                    list.0,
                    &other,
                    "the first argument of `index_of`",
                    "a list of numbers",
                );
            }
        };
        let due = Due::new("the second argument of `index_of`")
            .declared(list.0.span, "must be like these numbers");
        match self.fit(value.0, &value.1, &element, &due) {
            Type::Error => Type::Error,
            _ => Type::Int,
        }
    }

    pub(super) fn not_a(&mut self, expr: &Expr, found: &Type, what: &str, wanted: &str) -> Type {
        self.report(self.mistyped(expr.span, &format!("{what} is {wanted}"), found));
        Type::Error
    }

    pub(super) fn marker_argument(&mut self, what: &str, (expr, ty): &(&Expr, Type)) -> bool {
        !self
            .fit(expr, ty, &Type::Marker, &Due::new(what))
            .is_error()
    }

    /// Checks the argument of a function of a plain number. An angle may replace the number.
    fn plain_argument(
        &mut self,
        name: &str,
        (expr, ty): &(&Expr, Type),
        angle: bool,
        result: Quantity,
    ) -> Type {
        let what = format!("the argument of `{name}`");
        let Some(quantity) = ty.quantity() else {
            return self.not_a(expr, ty, &what, "a number");
        };
        let fits = quantity.dim.is_plain() && (angle || quantity.soft || quantity.dim.is_one());
        if fits {
            return Type::Scalar(Quantity {
                soft: true,
                ..result
            });
        }
        let wanted = match name {
            "sin" | "cos" | "tan" => Quantity::hard(Dimension::ANGLE),
            _ => Quantity::one(),
        };
        let misfit = quantity.fits(&wanted).err();
        match misfit {
            Some(misfit) => self.misfit(expr, misfit, &quantity, &wanted, &Due::new(what)),
            None => Type::Error,
        }
    }

    fn root(&mut self, (expr, ty): &(&Expr, Type)) -> Type {
        let Some(quantity) = ty.quantity() else {
            return self.not_a(expr, ty, "the argument of `sqrt`", "a number");
        };
        if quantity.dim.is_one() {
            return Type::Scalar(quantity);
        }
        match quantity.dim.power(1, 2) {
            Some(dim) => Type::Scalar(Quantity::soft(dim)),
            None => {
                self.report(
                    Diagnostic::error(codes::POWER, "this root has no dimension")
                        .at(expr.span, self.describe(ty)),
                );
                Type::Error
            }
        }
    }

    fn magnitude(&mut self, (expr, ty): &(&Expr, Type)) -> Type {
        match ty {
            Type::Int => Type::Int,
            Type::Scalar(quantity) => Type::Scalar(Quantity {
                kind: quantity.kind.of_size(),
                ..quantity.clone()
            }),
            Type::Vector { .. } => {
                self.report(
                    Diagnostic::error(
                        codes::WRONG_TYPE,
                        "the argument of `abs` is a number, not a vector",
                    )
                    .at(expr.span, self.describe(ty))
                    .with_help("the length of a vector is `norm(v)`"),
                );
                Type::Error
            }
            other => self.not_a(expr, other, "the argument of `abs`", "a number"),
        }
    }

    fn atan2(&mut self, (y, y_type): &(&Expr, Type), (x, x_type): &(&Expr, Type)) -> Type {
        let Some(p) = y_type.quantity() else {
            return self.not_a(y, y_type, "the first argument of `atan2`", "a number");
        };
        let Some(q) = x_type.quantity() else {
            return self.not_a(x, x_type, "the second argument of `atan2`", "a number");
        };
        if let Err(misfit) = q.fits(&p) {
            let due = Due::new("the second argument of `atan2`")
                .declared(y.span, "must be like the first");
            return self.misfit(x, misfit, &q, &p, &due);
        }
        Type::Scalar(Quantity {
            soft: true,
            ..Quantity::hard(Dimension::ANGLE)
        })
    }

    fn wrapped(
        &mut self,
        angle: &(&Expr, Type),
        period: &(&Expr, Type),
        from: Option<&(&Expr, Type)>,
    ) -> Type {
        let due = Type::Scalar(Quantity::hard(Dimension::ANGLE));
        let arguments = [
            ("the first argument of `wrapped`", Some(angle)),
            ("the period of `wrapped`", Some(period)),
            ("`from` of `wrapped`", from),
        ];
        for (what, argument) in arguments {
            if let Some((expr, found)) = argument
                && self.fit(expr, found, &due, &Due::new(what)).is_error()
            {
                return Type::Error;
            }
        }
        Type::Scalar(Quantity {
            soft: true,
            ..Quantity::hard(Dimension::ANGLE)
        })
    }

    fn rate(&mut self, (expr, ty): &(&Expr, Type)) -> Type {
        let time = Quantity::hard(Dimension::TIME);
        let per_time = |quantity: &Quantity| quantity.over(&time);
        match ty {
            Type::Int | Type::Scalar(_) => {
                Type::Scalar(per_time(&ty.quantity().unwrap_or_default()))
            }
            Type::Vector { quantity, .. } => Type::vector(per_time(quantity)),
            Type::List { length, framed, .. } if ty.components().is_some() => {
                let quantity = ty.components().map(|(q, _)| q).unwrap_or_default();
                Type::List {
                    element: Box::new(Type::Scalar(per_time(&quantity))),
                    length: *length,
                    framed: *framed,
                }
            }
            other => self.not_a(expr, other, "the argument of `der`", "a number or a vector"),
        }
    }

    fn directed(&mut self, what: &str, (expr, ty): &(&Expr, Type)) -> Option<Directed> {
        match ty {
            Type::Vector { quantity, .. } => Some(Directed {
                quantity: quantity.clone(),
                spatial: true,
                framed: false,
                length: Some(3),
            }),
            Type::List { framed, .. } if ty.components().is_some() => {
                let (quantity, length) = ty.components()?;
                Some(Directed {
                    quantity,
                    spatial: false,
                    framed: *framed,
                    length,
                })
            }
            other => {
                self.not_a(expr, other, what, "a vector");
                None
            }
        }
    }

    fn vector_product(&mut self, name: &str, a: &(&Expr, Type), b: &(&Expr, Type)) -> Type {
        let p = self.directed(&format!("the first argument of `{name}`"), a);
        let q = self.directed(&format!("the second argument of `{name}`"), b);
        let (Some(p), Some(q)) = (p, q) else {
            return Type::Error;
        };
        if p.spatial != q.spatial && (p.framed || q.framed) {
            let (components, vector) = if p.spatial { (b, a) } else { (a, b) };
            self.report(
                Diagnostic::error(
                    codes::FRAME,
                    format!("`{name}` of a vector and of components along a marker's axes"),
                )
                .at(components.0.span, "components, whose axes would be lost")
                .also(vector.0.span, "a vector")
                .with_help(
                    "bring both to one form: `local(v, marker)` or `vector(components, marker)`",
                ),
            );
            return Type::Error;
        }
        let lengths_differ = matches!((p.length, q.length), (Some(m), Some(n)) if m != n);
        let wrong = name == "cross" && (p.length.unwrap_or(3) != 3 || q.length.unwrap_or(3) != 3);
        if lengths_differ || wrong {
            let shown = |length: Option<u32>| length.map_or("?".to_owned(), |l| l.to_string());
            let mut message = Diagnostic::error(
                codes::LIST_LENGTH,
                if lengths_differ {
                    format!(
                        "`{name}` of {} and {} components",
                        shown(p.length),
                        shown(q.length)
                    )
                } else {
                    "`cross` needs three components".to_owned()
                },
            )
            .at(b.0.span, format!("{} components", shown(q.length)))
            .also(a.0.span, format!("{} components", shown(p.length)));
            if wrong && !lengths_differ {
                message = message.with_help("in a plane write `a.x*b.y - a.y*b.x`");
            }
            self.report(message);
            return Type::Error;
        }
        // A computed value may be an angle: components of axes are small angles, and products of axes occur
        // in torques.
        let quantity = Quantity {
            soft: true,
            ..p.quantity.times(&q.quantity)
        };
        match name {
            "dot" => Type::Scalar(quantity),
            _ if p.spatial || q.spatial => Type::vector(quantity),
            _ => Type::List {
                element: Box::new(Type::Scalar(quantity)),
                length: Some(3),
                framed: p.framed || q.framed,
            },
        }
    }

    fn norm(&mut self, v: &(&Expr, Type), floor: Option<(&Expr, Type)>) -> Type {
        let Some(directed) = self.directed("the argument of `norm`", v) else {
            return Type::Error;
        };
        if let Some((expr, ty)) = floor {
            let due = Due::new("`floor` of `norm`").declared(v.0.span, "must be like the vector");
            self.fit(expr, &ty, &Type::Scalar(directed.quantity.clone()), &due);
        }
        Type::Scalar(Quantity {
            soft: true,
            kind: directed.quantity.kind.of_size(),
            ..directed.quantity
        })
    }

    fn change_axes(&mut self, name: &str, v: &(&Expr, Type), m: &(&Expr, Type)) -> Type {
        let marker = self.marker_argument(&format!("the second argument of `{name}`"), m);
        let (expr, ty) = v;
        let what = format!("the first argument of `{name}`");
        let quantity = match (name, ty) {
            (_, Type::Vector { quantity, .. }) if name == "local" => quantity.clone(),
            (
                "local",
                Type::List {
                    framed: false,
                    length: None | Some(3),
                    ..
                },
            ) if ty.components().is_some() => ty.components().map(|(q, _)| q).unwrap_or_default(),
            ("local", Type::List { framed: true, .. }) => {
                self.report(
                    Diagnostic::error(
                        codes::FRAME,
                        "the argument of `local` is a list of components already",
                    )
                    .at(expr.span, "components along a marker's axes")
                    .with_help("make a vector of them first: `local(vector(c, a), b)`"),
                );
                return Type::Error;
            }
            (
                "vector",
                Type::List {
                    length: None | Some(3),
                    ..
                },
            ) if ty.components().is_some() => ty.components().map(|(q, _)| q).unwrap_or_default(),
            (
                "vector",
                Type::List {
                    length: Some(found),
                    ..
                },
            ) if ty.components().is_some() => {
                self.report(
                    Diagnostic::error(
                        codes::LIST_LENGTH,
                        format!("{what} has 3 elements, not {found}"),
                    )
                    .at(expr.span, format!("{found} elements")),
                );
                return Type::Error;
            }
            ("vector", Type::Vector { .. }) => {
                self.report(
                    Diagnostic::error(codes::FRAME, "the argument of `vector` is a vector already")
                        .at(expr.span, "a vector, not components")
                        .with_help("omit `vector(…)`, or take `local(v, m)` for its components"),
                );
                return Type::Error;
            }
            (name, other) => {
                let wanted = if name == "local" {
                    "a vector"
                } else {
                    "a list of three components"
                };
                return self.not_a(expr, other, &what, wanted);
            }
        };
        if !marker {
            return Type::Error;
        }
        if name == "vector" {
            Type::vector(quantity)
        } else {
            Type::List {
                element: Box::new(Type::Scalar(quantity)),
                length: Some(3),
                framed: true,
            }
        }
    }

    fn perpendicular(&mut self, (expr, ty): &(&Expr, Type)) -> Type {
        match ty {
            Type::List {
                length: None | Some(2),
                ..
            } if ty.components().is_some() => ty.clone(),
            Type::List {
                length: Some(found),
                ..
            } if ty.components().is_some() => {
                self.report(
                    Diagnostic::error(
                        codes::LIST_LENGTH,
                        format!("the argument of `perpendicular` has 2 elements, not {found}"),
                    )
                    .at(expr.span, format!("{found} elements")),
                );
                Type::Error
            }
            other => self.not_a(
                expr,
                other,
                "the argument of `perpendicular`",
                "a list of two components",
            ),
        }
    }

    fn extreme(&mut self, name: &str, arguments: &[(&Expr, Type)]) -> Type {
        let what = format!("the arguments of `{name}`");
        let mut result: Option<(Type, Span)> = None;
        for (expr, ty) in arguments {
            let element = match ty {
                Type::List { element, .. } | Type::Range(element) if arguments.len() == 1 => {
                    element.as_ref().clone()
                }
                other => other.clone(),
            };
            if element.quantity().is_none() {
                return self.not_a(
                    expr,
                    &element,
                    &format!("an argument of `{name}`"),
                    "a number",
                );
            }
            result = Some(match result {
                None => (element, expr.span),
                Some((known, span)) => {
                    let joined = self.extreme_of(&known, span, &element, expr, &what);
                    if joined.is_error() {
                        return Type::Error;
                    }
                    (joined, span)
                }
            });
        }
        result.map_or(Type::Error, |(ty, _)| ty)
    }

    /// The common type of two arguments of `min` or `max`. A bare number beside a quantity is an error.
    fn extreme_of(&mut self, known: &Type, span: Span, ty: &Type, expr: &Expr, what: &str) -> Type {
        if let (Some(p), Some(q)) = (known.quantity(), ty.quantity())
            && q.dim.is_one()
            && !p.dim.is_one()
            && matches!(expr.kind, ExprKind::Number { unit: None, .. })
            && let Err(misfit) = q.join(&p)
        {
            let due = Due::new("this argument").declared(span, "must be like the first");
            return self.misfit(expr, misfit, &q, &p, &due);
        }
        self.join((known, span), (ty, expr.span), what)
    }

    fn total(&mut self, (expr, ty): &(&Expr, Type)) -> Type {
        match ty {
            Type::List { element, .. } => match element.as_ref() {
                Type::Int => Type::Int,
                Type::Scalar(quantity) => {
                    if matches!(quantity.kind, super::types::Kind::Point(_)) {
                        return self.multiple_of_point(&quantity.clone(), expr.span, "summed");
                    }
                    Type::Scalar(quantity.clone())
                }
                other => {
                    let other = other.clone();
                    self.not_a(expr, &other, "an element of the list of `sum`", "a number")
                }
            },
            Type::Range(element) if **element == Type::Int => Type::Int,
            other => self.not_a(expr, other, "the argument of `sum`", "a list"),
        }
    }
}
