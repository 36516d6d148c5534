//! Units as written.

use super::Checker;
use super::scope::Scope;
use super::types::{Dim, Kind, Quantity, Type};
use crate::codes;
use crate::program::{Unit, unit_text};
use crate::resolve::suggest::EXPLAINED;
use eng_grammar::ast::{BinaryOp, Expr, ExprKind, Name, UnitExpr, UnitFactor};
use eng_grammar::{Diagnostic, Span};

/// Prefixes of the SI. Micro is `u`.
const PREFIXES: [(&str, &str); 9] = [
    ("n", "1e-9"),
    ("u", "1e-6"),
    ("m", "1e-3"),
    ("c", "1e-2"),
    ("d", "1e-1"),
    ("h", "1e2"),
    ("k", "1e3"),
    ("M", "1e6"),
    ("G", "1e9"),
];

impl<'p> Checker<'p> {
    /// The size of a unit. Reports unknown names in it.
    pub(super) fn unit(&mut self, scope: &Scope<'p>, unit: &UnitExpr) -> Option<Unit> {
        for (place, factor) in unit.factors.iter().enumerate() {
            let name = &factor.name.text;
            self.used_units.insert((scope.module, name.clone()));
            let Some(known) = self.program.units.get(name) else {
                self.unknown_unit(scope, place, unit);
                return None;
            };
            if known.offset != 0.0
                && (unit.factors.len() > 1 || factor.numerator != 1 || factor.denominator != 1)
            {
                let plain = self
                    .program
                    .units
                    .values()
                    .find(|u| {
                        u.dimension == known.dimension && u.scale == known.scale && u.offset == 0.0
                    })
                    .map(|u| u.symbol.clone());
                let mut message = Diagnostic::error(
                    codes::AFFINE_UNIT,
                    format!("`{name}` has a shifted zero and cannot be combined with other units"),
                )
                .at(factor.name.span, "counts from a zero of its own");
                if let Some(plain) = plain {
                    message = message
                        .with_help(format!("a difference of one `{name}` is one `{plain}`"))
                        .with_fix(format!("write `{plain}`"), factor.name.span, plain);
                }
                self.report(message);
                return None;
            }
        }
        self.program.unit(unit).ok()
    }

    /// Reports a word after a unit that is neither a unit nor a value: `5 N*m/secnd`.
    pub(super) fn neither_unit_nor_value(
        &mut self,
        scope: &Scope<'p>,
        operator: (BinaryOp, Span),
        left: &Expr,
        right: &Expr,
    ) -> bool {
        let Some((name, place)) = base_name(right) else {
            return false;
        };
        if !behind_unit(operator, left, right)
            || super::scope::BUILT_IN_NAMES.contains(&name)
            || self.find(scope, name).is_some()
        {
            return false;
        }
        let factor = |span: Span| UnitFactor {
            name: Name {
                text: name.to_owned(),
                span,
            },
            numerator: 1,
            denominator: 1,
        };
        // the units before it do not matter, but a factor among others may have any dimension
        let whole = UnitExpr {
            span: left.span.to(place),
            factors: vec![factor(left.span), factor(place)],
        };
        self.unknown_unit(scope, 1, &whole);
        true
    }

    /// Reports units after values, where the text is a value, too: `3 N*depth/mm`. One message stands for all units
    /// of a product. Its remedy moves all of them, because remedies of single units would overlap.
    pub(super) fn units_behind_values(
        &mut self,
        scope: &Scope<'p>,
        (op, sign): (BinaryOp, Span),
        left: &Expr,
        right: &Expr,
    ) -> bool {
        if !self.is_only_unit(scope, right) || !behind_unit((op, sign), left, right) {
            return false;
        }
        let mut factors = vec![(sign, right)];
        let mut number = left;
        while let ExprKind::Binary {
            op_span,
            left,
            right,
            ..
        } = &number.kind
        {
            factors.push((*op_span, right));
            number = left;
        }
        factors.reverse();
        let (mut units, mut values) = (Vec::new(), Vec::new());
        let mut before: Option<Span> = None;
        for (sign, factor) in factors {
            if self.is_only_unit(scope, factor) {
                units.push((sign, factor));
                continue;
            }
            if units.is_empty() {
                before = Some(before.unwrap_or(factor.span).to(factor.span));
            }
            values.push((sign, factor));
        }
        let text = |span: Span| self.sources.text(span);
        let joined = |factors: &[(Span, &Expr)]| -> String {
            let each = factors.iter();
            each.map(|(sign, factor)| format!("{}{}", text(*sign), text(factor.span)))
                .collect()
        };
        let first = text(number.span);
        let mut places = units.iter().map(|(_, unit)| (unit.span, base_name(unit)));
        let Some((place, Some((name, _)))) = places.next() else {
            return false;
        };
        let message = Diagnostic::error(
            codes::UNKNOWN_NAME,
            format!("`{name}` is a unit, and here a value is expected"),
        )
        .at(place, "read as a value of this name");
        let message = places.fold(message, |message, (place, _)| {
            message.also(place, "and here")
        });
        let message = message.with_each(before.map(text), |message, value| {
            message.with_note(format!(
                "the unit of `{first}` ends before `{value}`, which is a value and no unit"
            ))
        });
        let message = message.with_fix(
            "write the whole unit before the values",
            number.span.to(right.span),
            format!("{first}{}{}", joined(&units), joined(&values)),
        );
        self.report(message);
        self.infer(scope, number);
        for (_, value) in values {
            self.infer(scope, value);
        }
        true
    }

    /// Whether an expression is the name of a unit that is no value here, or a power of one.
    fn is_only_unit(&mut self, scope: &Scope<'p>, factor: &Expr) -> bool {
        base_name(factor).is_some_and(|(name, _)| {
            self.program.units.contains_key(name)
                && !super::scope::BUILT_IN_NAMES.contains(&name)
                && self.find(scope, name).is_none()
        })
    }

    fn unknown_unit(&mut self, scope: &Scope<'p>, place: usize, whole: &UnitExpr) {
        let Some(factor) = whole.factors.get(place) else {
            return;
        };
        let (name, span) = (factor.name.text.as_str(), factor.name.span);
        let mut message =
            Diagnostic::error(codes::UNKNOWN_UNIT, format!("there is no unit `{name}`"))
                .at(span, "not known");
        if self.diagnostics.len() > EXPLAINED {
            return self.report(message);
        }
        let units = &self.program.units;
        let wanted = self.wanted.filter(|_| whole.factors.len() == 1);
        let fits = |known: &&String| {
            wanted.is_some_and(|wanted| units.get(*known).is_some_and(|u| u.dimension == wanted))
        };
        // `Nm` is N*m, `kgm2` is not guessed.
        let split = name.char_indices().skip(1).find_map(|(at, _)| {
            let (left, right) = name.split_at(at);
            let (a, b) = (units.get(left)?, units.get(right)?);
            let fitting = wanted.is_none_or(|wanted| a.dimension.times(b.dimension) == wanted);
            fitting.then(|| format!("{left}*{right}"))
        });
        let same_letters = |fitting: bool| {
            units
                .keys()
                .filter(|known| !fitting || fits(known))
                .find(|known| known.eq_ignore_ascii_case(name))
                .cloned()
        };
        // `uN`: a prefix before a unit of the library
        let prefixed = PREFIXES.iter().find_map(|(prefix, factor)| {
            let plain = name.strip_prefix(prefix)?;
            let unit = units.get(plain)?;
            let fitting = wanted.is_none_or(|wanted| unit.dimension == wanted);
            // `umm` is a misspelling: `mm` has a prefix already
            let has_one = |plain: &str| {
                let bare = |(prefix, _): &(&str, &str)| plain.strip_prefix(prefix);
                PREFIXES
                    .iter()
                    .filter_map(bare)
                    .any(|bare| units.contains_key(bare))
            };
            (fitting && unit.offset == 0.0 && !has_one(plain)).then(|| (plain.to_owned(), *factor))
        });
        let celsius =
            matches!(name, "C" | "degree" | "celsius" | "Celsius" | "dC").then_some("degC");
        let meant = celsius
            .filter(|unit| units.contains_key(*unit))
            .map(str::to_owned)
            .or_else(|| same_letters(true))
            .or(split);
        if let (None, Some((plain, factor))) = (&meant, prefixed) {
            self.report(message.with_help(format!(
                "write `{factor} {plain}` for one, or define it: `unit {name} = {factor} {plain}`"
            )));
            return;
        }
        let meant = meant
            .or_else(|| super::describe::nearest_unit(name, units.keys().filter(fits)))
            .or_else(|| same_letters(false))
            .or_else(|| super::describe::nearest_unit(name, units.keys()));
        if let Some(meant) = meant {
            message = message.meant(span, meant);
        } else if self.find(scope, name).is_some() {
            message = message.with_help(format!("a factor follows `*`: `5 * {name}`"));
        } else if let Some(wanted) = wanted
            && let Some(usual) = self.usual_unit(&Quantity::hard(wanted))
        {
            message = message.with_help(format!("a unit that fits here is `{usual}`"));
        }
        self.report(message);
    }

    /// The quantity of a number in this unit.
    pub(super) fn quantity_of(&mut self, scope: &Scope<'p>, unit: &UnitExpr) -> Option<Quantity> {
        let unit = self.unit(scope, unit)?;
        let kind = match unit.point {
            Some(point) => Kind::Point(point.as_str().into()),
            None => Kind::Any,
        };
        Some(Quantity {
            dim: Dim::known(unit.dimension),
            soft: false,
            kind,
        })
    }

    /// Whether a value can be shown in a unit: `x as kN`.
    pub(super) fn display(&mut self, scope: &Scope<'p>, ty: &Type, display: &UnitExpr) {
        let Some(unit) = self.quantity_of(scope, display) else {
            return;
        };
        let quantity = match ty {
            Type::Vector { quantity, .. } => Some(quantity.clone()),
            Type::List { element, .. } => match element.as_ref() {
                Type::List { .. } | Type::Vector { .. } => {
                    let element = element.as_ref().clone();
                    return self.display(scope, &element, display);
                }
                other => other.quantity(),
            },
            other => other.quantity(),
        };
        if ty.is_error() {
            return;
        }
        let Some(quantity) = quantity else {
            let what = self.describe(ty);
            self.report(
                Diagnostic::error(codes::DISPLAY, format!("{what} has no unit"))
                    .at(display.span, "only a number has a unit"),
            );
            return;
        };
        let affine = self
            .program
            .unit(display)
            .is_ok_and(|unit| unit.offset != 0.0);
        let fits = match quantity.fits(&unit) {
            Ok(()) => true,
            // In a unit without a shifted zero, a difference and a point show the same number.
            Err(super::types::Misfit::Point) => !affine,
            Err(_) => false,
        };
        if !fits {
            let message = Diagnostic::error(
                codes::DISPLAY,
                format!(
                    "{} cannot be shown in `{}`",
                    self.describe(ty),
                    unit_text(display)
                ),
            )
            .at(
                display.span,
                format!("a unit of {}", self.quantity_name(&unit)),
            )
            .with_note(format!(
                "the value is {}, the unit is one of {}",
                self.quantity_in_full(&quantity),
                self.quantity_in_full(&unit)
            ));
            let message = match self.usual_unit(&quantity) {
                Some(usual) if quantity.dim.is_known() => {
                    message.with_help(format!("for instance `as {usual}`"))
                }
                _ => message,
            };
            self.report(message);
        }
    }
}

/// The name in `mm` or `mm^2`, with its place.
fn base_name(factor: &Expr) -> Option<(&str, Span)> {
    let base = match &factor.kind {
        ExprKind::Binary {
            op: BinaryOp::Power,
            left,
            ..
        } => left,
        _ => factor,
    };
    match &base.kind {
        ExprKind::Name(name) => Some((name, base.span)),
        _ => None,
    }
}

/// Whether `right` was written as a factor of the unit at the end of `left`: no blank is between them.
fn behind_unit((op, sign): (BinaryOp, Span), left: &Expr, right: &Expr) -> bool {
    if !matches!(op, BinaryOp::Multiply | BinaryOp::Divide)
        || left.span.end != sign.start
        || sign.end != right.span.start
    {
        return false;
    }
    match &left.kind {
        ExprKind::Number { unit, .. }
        | ExprKind::List { unit, .. }
        | ExprKind::Comprehension { unit, .. }
        | ExprKind::Paren { unit, .. } => unit.is_some(),
        ExprKind::Binary {
            op,
            op_span,
            left,
            right,
        } => behind_unit((*op, *op_span), left, right),
        _ => false,
    }
}
