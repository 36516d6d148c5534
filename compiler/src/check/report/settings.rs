//! Options of filters and spectra.

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
use eng_system::report::{Averaging, Axis, Expression, Limit, SpectrumSettings, Window};
use eng_system::system::Extent;
use eng_system::{Dimension, DisplayUnit};

pub(super) const WINDOWS: [(&str, Window); 4] = [
    ("rectangular", Window::Rectangular),
    ("hann", Window::Hann),
    ("flat_top", Window::FlatTop),
    ("blackman_harris", Window::BlackmanHarris),
];
const AVERAGINGS: [(&str, Averaging); 3] = [
    ("rms", Averaging::RootMeanSquare),
    ("linear", Averaging::Linear),
    ("peak", Averaging::Peak),
];
const AXES: [(&str, Axis); 2] = [("order", Axis::Order), ("frequency", Axis::Frequency)];
const SCALES: [(&str, bool); 2] = [("linear", false), ("logarithmic", true)];
/// Whether places are told by time instead of crank angle.
pub(super) const OVER: [(&str, bool); 2] = [("crank_angle", false), ("time", true)];
const MEANS: [(&str, bool); 2] = [("removed", true), ("kept", false)];

fn frequency() -> Quantity {
    Quantity::hard(Dimension::ONE.over(Dimension::TIME))
}

impl<'a> Reporter<'a, '_> {
    /// Says that a number lies outside of what it may be.
    pub(super) fn refuse(&mut self, expr: &Expr, what: &str, due: &str) -> Option<()> {
        self.tell(
            Diagnostic::error(codes::REPORT_NUMBER, format!("{what} must be {due}"))
                .at(expr.span, "outside of this"),
        );
        None
    }

    /// One of several words; `None` inside where the argument is absent.
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
        if let Some(near) = nearest(word, words()) {
            message = message.meant(value.span, near);
        }
        self.tell(message);
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

    /// Whether the model behind each member has a cycle; `None` where a message was given.
    pub(super) fn has_cycle(&mut self, of: &Typed) -> Option<bool> {
        let mut all = true;
        for member in &of.members {
            let plan = self.models.plan(&member.analysis)?;
            all &= self.models.channels(plan)?.cycle;
        }
        Some(all)
    }

    /// Says where something needs a cycle that the model has not.
    pub(super) fn with_cycle(&mut self, expr: &Expr, of: &Typed, what: &str) -> Option<()> {
        if self.has_cycle(of)? {
            return Some(());
        }
        self.tell(
            Diagnostic::error(
                codes::NO_CYCLE,
                format!("{what} needs a cycle, and the model has none"),
            )
            .at(expr.span, "of which cycle?")
            .with_help(
                "state the cycle in the model: `cycle angle = rotation(a, ground) { period = 720 deg }`",
            ),
        );
        None
    }

    /// Says that something takes what is recorded in time, where a place is of modes.
    pub(super) fn samples_at(&mut self, expr: &Expr, place: &Found<'_>, name: &str) -> Option<()> {
        let found = Type::Int.in_rows(&place.rows());
        self.checker.of_samples(expr, &found, name)
    }

    /// Whether all members are of analyses whose cycle repeats, and whole.
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
    pub(super) fn overlap(&mut self, taken: &Bound<'a>) -> Option<f64> {
        let Some(expr) = taken.option("overlap") else {
            return Some(0.5);
        };
        let overlap = self.constant(expr, &Quantity::one(), "`overlap`")?;
        if !(0.0..1.0).contains(&overlap) {
            self.refuse(expr, "`overlap`", "from 0 to below 100 %")?;
        }
        Some(overlap)
    }

    /// The window as stated; else rectangular where the cycle repeats, Hann elsewhere.
    pub(super) fn window(&mut self, taken: &Bound<'a>, of: &Typed) -> Option<Window> {
        let stated = self.word(taken.option("window"), "`window`", &WINDOWS)?;
        Some(stated.unwrap_or(if self.repeats(of) {
            Window::Rectangular
        } else {
            Window::Hann
        }))
    }

    /// Everything about a spectrum of signals.
    pub(super) fn spectrum_settings(
        &mut self,
        taken: &Bound<'a>,
        of: &Typed,
    ) -> Option<SpectrumSettings> {
        let stated = self.word(taken.option("axis"), "`axis`", &AXES)?;
        let up_to = match taken.option("up_to") {
            Some(expr) => Some((expr, self.limit(expr, "`up_to`")?)),
            None => None,
        };
        let axis = match (stated, up_to) {
            (Some(axis), Some((expr, limit))) => {
                let same = matches!(
                    (axis, limit),
                    (Axis::Order, Limit::Order(_)) | (Axis::Frequency, Limit::Frequency(_))
                );
                if !same {
                    let due = match axis {
                        Axis::Order => "`up_to` ends an axis of orders: a plain number is due",
                        Axis::Frequency => "`up_to` ends an axis of frequencies: write `2 kHz`",
                    };
                    self.tell(
                        Diagnostic::error(codes::DIMENSION, due).at(expr.span, "of another axis"),
                    );
                    return None;
                }
                axis
            }
            (Some(axis), None) => axis,
            (None, Some((_, Limit::Order(_)))) => Axis::Order,
            (None, Some((_, Limit::Frequency(_)))) => Axis::Frequency,
            (None, None) if self.has_cycle(of)? => Axis::Order,
            (None, None) => Axis::Frequency,
        };
        if let (Axis::Order, Some(expr)) =
            (axis, taken.option("axis").or_else(|| taken.option("up_to")))
        {
            self.with_cycle(expr, of, "an axis of orders")?;
        }
        let block = match taken.option("block") {
            Some(expr) => Some(self.extent(expr, of, "`block`")?),
            None => None,
        };
        let reference = match taken.option("reference") {
            Some(expr) => Some(self.reference(expr, of)?),
            None => None,
        };
        let overlap = self.overlap(taken)?;
        let averaging = self.word(taken.option("averaging"), "`averaging`", &AVERAGINGS)?;
        let mean = self.word(taken.option("mean"), "`mean`", &MEANS)?;
        let scale = self.word(taken.option("scale"), "`scale`", &SCALES)?;
        let window = self.window(taken, of)?;
        Some(SpectrumSettings {
            window,
            axis,
            up_to: up_to.map(|(_, Limit::Order(x) | Limit::Frequency(x))| x),
            block,
            overlap,
            averaging: averaging.unwrap_or(Averaging::RootMeanSquare),
            remove_mean: mean.unwrap_or(true),
            logarithmic: scale.unwrap_or(false),
            reference,
        })
    }

    /// What a Campbell diagram takes where nothing is stated: frequencies, and levels over 1 µN or 1 µm/s² (ISO 1683), of other quantities
    /// over 1 of their unit.
    pub(super) fn campbell_settings(
        &mut self,
        taken: &Bound<'a>,
        settings: SpectrumSettings,
        of: &Typed,
        shown: &mut DisplayUnit,
    ) -> Option<SpectrumSettings> {
        let axis = match (taken.option("axis"), taken.option("up_to")) {
            (None, None) => Axis::Frequency,
            _ => settings.axis,
        };
        let scale = self.word(taken.option("scale"), "`scale`", &SCALES)?;
        let mut reference = settings.reference;
        if reference.is_none() && scale.unwrap_or(true) {
            let force = crate::check::scope::force_dimension();
            let acceleration = force.over(Dimension::MASS);
            let symbol = match of.quantity().dim.base {
                dimension if dimension == force => Some("N"),
                dimension if dimension == acceleration => Some("m/s^2"),
                _ => None,
            };
            reference = Some(match symbol {
                Some(symbol) => {
                    *shown = DisplayUnit {
                        symbol: symbol.to_owned(),
                        scale: 1.0,
                        offset: 0.0,
                    };
                    1e-6
                }
                None => shown.scale,
            });
        }
        Some(SpectrumSettings {
            axis,
            reference,
            ..settings
        })
    }

    /// The reference of a level: above zero, and of what it is a level of.
    pub(super) fn reference(&mut self, expr: &'a Expr, of: &Typed) -> Option<f64> {
        let value = self.constant(expr, &of.quantity(), "`reference`")?;
        if !(value > 0.0 && value.is_finite()) {
            self.refuse(expr, "`reference`", "above zero")?;
        }
        Some(value)
    }
}

/// Whether no part of a signal was selected.
fn whole(expression: &Expression) -> bool {
    !matches!(expression, Expression::Last(..)) && expression.parts().into_iter().all(whole)
}
