//! Numbers and words of functions and figures.

use super::Reporter;
use super::channel::Found;
use super::value::Typed;
use crate::check::bound::Bound;
use crate::check::mismatch::Due;
use crate::check::types::{Quantity, Type};
use crate::codes;
use crate::resolve::suggest::{listing, nearest};
use eng_grammar::Diagnostic;
use eng_grammar::ast::{Expr, ExprKind};
use eng_system::Dimension;
use eng_system::expression::{Expression, Limit, WINDOWS, Window};
use eng_system::system::Extent;

/// The words of `over:`, and whether they mean time instead of crank angle.
pub(super) const OVER: [(&str, bool); 2] = [("crank_angle", false), ("time", true)];

fn frequency() -> Quantity {
    Quantity::hard(Dimension::ONE.over(Dimension::TIME))
}

impl<'a> Reporter<'a, '_> {
    /// Gives a message about a number outside of its range.
    pub(super) fn refuse(&mut self, expr: &Expr, what: &str, due: &str) -> Option<()> {
        self.diagnose(
            Diagnostic::error(codes::REPORT_NUMBER, format!("{what} must be {due}"))
                .at(expr.span, "outside of this"),
        );
        None
    }

    /// One of several words; `Some(None)` without the argument.
    pub(super) fn word<T: Copy>(
        &mut self,
        value: Option<&Expr>,
        what: &str,
        known: &[(&'static str, T)],
    ) -> Option<Option<T>> {
        let Some(value) = value else {
            return Some(None);
        };
        let word = match &value.kind {
            ExprKind::Name(name) => name.as_str(),
            ExprKind::Bool(true) => "true",
            ExprKind::Bool(false) => "false",
            _ => "",
        };
        if let Some((_, meaning)) = known.iter().find(|(name, _)| *name == word) {
            return Some(Some(*meaning));
        }
        let words = || known.iter().map(|(name, _)| *name);
        let mut message = Diagnostic::error(
            codes::REPORT_WORD,
            format!("{what} is one of {}", listing(words(), 12)),
        )
        .at(value.span, "none of these words");
        message = message.meant_if(value.span, nearest(word, words()));
        self.diagnose(message);
        None
    }

    /// A frequency, or as a plain number an order.
    pub(super) fn limit(&mut self, expr: &'a Expr, what: &str) -> Option<Limit> {
        let (quantity, value) = self.constant_of(expr, what)?;
        if !(value > 0.0 && value.is_finite()) {
            self.refuse(expr, what, "above zero")?;
        }
        if quantity.dim.is_one() {
            return Some(Limit::Order(value));
        }
        match quantity.fits(&frequency()) {
            Ok(()) => Some(Limit::Frequency(value)),
            Err(misfit) => {
                let due = Due {
                    unit: Some("Hz".to_owned()),
                    ..Due::new(what)
                };
                self.checker
                    .misfit(expr, misfit, &quantity, &frequency(), &due);
                None
            }
        }
    }

    /// A time or an angle of the cycle, above zero.
    pub(super) fn extent(&mut self, expr: &'a Expr, of: &Typed, what: &str) -> Option<Extent> {
        let (quantity, value) = self.constant_of(expr, what)?;
        if !(value > 0.0 && value.is_finite()) {
            self.refuse(expr, what, "above zero")?;
        }
        if quantity.dim.base == Dimension::ANGLE {
            self.with_cycle(expr, of, what)?;
            return Some(Extent::Angle(value));
        }
        let time = Quantity::hard(Dimension::TIME);
        match quantity.fits(&time) {
            Ok(()) => Some(Extent::Time(value)),
            Err(misfit) => {
                self.checker
                    .misfit(expr, misfit, &quantity, &time, &Due::new(what));
                None
            }
        }
    }

    /// Whether the model of each member has a cycle; `None` after a message.
    pub(super) fn has_cycle(&mut self, of: &Typed) -> Option<bool> {
        let mut all = true;
        for member in &of.members {
            let plan = self.models.plan(&member.analysis)?;
            all &= self.models.channels(plan)?.cycle;
        }
        Some(all)
    }

    /// Gives a message if an expression needs a cycle and the model has none.
    pub(super) fn with_cycle(&mut self, expr: &Expr, of: &Typed, what: &str) -> Option<()> {
        if self.has_cycle(of)? {
            return Some(());
        }
        self.no_cycle(expr, what);
        None
    }

    /// Says that something needs a cycle.
    pub(super) fn no_cycle(&mut self, expr: &Expr, what: &str) {
        self.diagnose(
            Diagnostic::error(
                codes::NO_CYCLE,
                format!("{what} needs a cycle, and the model has none"),
            )
            .at(expr.span, "of which cycle?")
            .with_help(
                "state the cycle in the model: `cycle angle = rotation(a, ground) { period = 720 deg }`",
            ),
        );
    }

    /// Gives a message if a function of samples gets modes.
    pub(super) fn samples_at(&mut self, expr: &Expr, place: &Found<'_>, name: &str) -> Option<()> {
        let found = Type::Int.in_rows(&place.rows());
        self.checker.of_samples(expr, &found, name)
    }

    /// Whether all members are whole signals of analyses whose cycle repeats.
    pub(super) fn repeats(&self, of: &Typed) -> bool {
        of.members.iter().all(|member| {
            whole(&member.expression)
                && self
                    .models
                    .plan(&member.analysis)
                    .is_some_and(|p| p.analysis.kind.rows() == eng_system::analysis::Rows::Cycle)
        })
    }

    /// A share from 0 to below 1.
    pub(super) fn share(&mut self, expr: &'a Expr, what: &str) -> Option<f64> {
        let share = self.constant(expr, &Quantity::one(), what)?;
        if !(0.0..1.0).contains(&share) {
            self.refuse(expr, what, "from 0 to below 100 %")?;
        }
        Some(share)
    }

    /// A share by which a parameter changes.
    pub(super) fn change(&mut self, expr: &'a Expr, what: &str) -> Option<f64> {
        let share = self.constant(expr, &Quantity::one(), what)?;
        if !(share > 0.0 && share <= 1.0) {
            self.refuse(expr, what, "above 0, up to 100 %")?;
        }
        Some(share)
    }

    /// The stated window; otherwise rectangular if the cycle repeats, and Hann if it does not.
    pub(super) fn window(&mut self, taken: &Bound<'a>, of: &Typed) -> Option<Window> {
        let stated = self.word(taken.option("window"), "`window`", &WINDOWS)?;
        Some(stated.unwrap_or(if self.repeats(of) {
            Window::Rectangular
        } else {
            Window::Hann
        }))
    }

    /// The reference of a level: above zero, with the dimension of the signal.
    pub(super) fn reference(&mut self, expr: &'a Expr, of: &Typed) -> Option<f64> {
        let value = self.constant(expr, &of.quantity(), "`reference`")?;
        if !(value > 0.0 && value.is_finite()) {
            self.refuse(expr, "`reference`", "above zero")?;
        }
        Some(value)
    }
}

/// Whether an expression uses whole signals.
fn whole(expression: &Expression) -> bool {
    !matches!(expression, Expression::Last(..)) && expression.parts().into_iter().all(whole)
}
