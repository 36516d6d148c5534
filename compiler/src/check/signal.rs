//! Types of signals in reports: a rule for numbers holds in each row of a signal.

use super::Checker;
use super::types::{SignalRows, Type};
use crate::codes;
use crate::functions::BuiltIn;
use eng_grammar::ast::{BinaryOp, Expr};
use eng_grammar::{Diagnostic, Span};

/// The sorts of values that reports distinguish.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Shape {
    Signal,
    Number,
    Truth,
}

impl Shape {
    pub fn of(ty: &Type) -> Shape {
        match ty {
            Type::Signal { .. } => Shape::Signal,
            Type::Bool => Shape::Truth,
            _ => Shape::Number,
        }
    }

    fn words(self) -> &'static str {
        match self {
            Shape::Signal => "a signal",
            Shape::Number => "a number",
            Shape::Truth => "a condition",
        }
    }
}

impl Checker<'_> {
    /// Reports a value of another shape than the place needs.
    pub(super) fn shaped(
        &mut self,
        expr: &Expr,
        found: &Type,
        due: Shape,
        what: &str,
    ) -> Option<()> {
        let shape = Shape::of(found);
        if shape == due {
            return Some(());
        }
        let mut message = Diagnostic::error(
            codes::REPORT_SHAPE,
            format!("{what} must be {}, not {}", due.words(), shape.words()),
        )
        .at(expr.span, format!("this is {}", shape.words()));
        let text = self.sources.text(expr.span);
        message = match (found, due) {
            (Type::Signal { rows: SignalRows::Modes(_), .. }, Shape::Number) => message
                .with_note("a column of a linear analysis has a number for each mode")
                .with_help(format!(
                    "take one of them: `mode({text}, 1)`, `mode({text}, 100 Hz)`, `minimum({text})`, …"
                )),
            (Type::Signal { rows: SignalRows::Frequencies(_), .. }, Shape::Number) => message
                .with_note("a column of a response has a number at each frequency")
                .with_help(format!(
                    "take one of them: `at_frequency({text}, 100 Hz)`, `maximum({text})`, …"
                )),
            (Type::Signal { .. }, Shape::Number) => message
                .with_note("a signal is a number at each sample of a run")
                .with_help(format!(
                    "make a number of it: `maximum({text})`, `rms({text})`, `mean({text})`, …"
                )),
            (_, Shape::Signal) => message.with_note("a signal is a number at each sample of a run"),
            (_, Shape::Truth) => message.with_help("compare it with something: `x < 5 %`"),
            _ => message,
        };
        self.report(message);
        None
    }

    /// Reports a signal of modes or frequencies in a function that needs samples of a run.
    pub(super) fn of_samples(&mut self, expr: &Expr, found: &Type, name: &str) -> Option<()> {
        let Type::Signal { rows, .. } = found else {
            return Some(());
        };
        let (Some(analysis), words) = (rows.of_analysis(), rows.words()) else {
            return Some(());
        };
        let text = self.sources.text(expr.span);
        let message = Diagnostic::error(
            codes::REPORT_SHAPE,
            format!("`{name}` takes samples of a run, and `{analysis}` gives {words}"),
        );
        let message = match rows {
            SignalRows::Frequencies(_) => message
                .at(expr.span, "a row for each frequency, not for each sample")
                .with_note("for a response there are `at_frequency`, `minimum`, `maximum`, `maximum_at`, operators and the figures `bode` and `xy`")
                .with_help(format!("for instance `at_frequency({text}, 100 Hz)`")),
            _ => message
                .at(expr.span, "a row for each mode, not for each sample")
                .with_note("for modes there are `mode`, `minimum`, `maximum`, operators and, in a `campbell`, `modes:`")
                .with_help(format!("for instance `mode({text}, 1)`, or of that near a frequency `mode({text}, 100 Hz)`")),
        };
        self.report(message);
        None
    }

    /// The common rows of two values, of which one is a signal. A number holds in every row. `None` after an error:
    /// samples and modes, or modes of two analyses, have no common rows.
    pub(super) fn common_rows(&mut self, span: Span, a: &Type, b: &Type) -> Option<SignalRows> {
        let (title, label) = match (a, b) {
            (Type::Signal { rows: first, .. }, Type::Signal { rows: second, .. }) => {
                match (first, second) {
                    (first, second) if first == second => return Some(first.clone()),
                    (SignalRows::Modes(first), SignalRows::Modes(second)) => (
                        format!("modes of `{first}` are combined with modes of `{second}`"),
                        "mode 3 of one analysis need not be mode 3 of the other",
                    ),
                    (SignalRows::Frequencies(first), SignalRows::Frequencies(second)) => (
                        format!("frequencies of `{first}` are combined with those of `{second}`"),
                        "each response has frequencies of its own about its resonances",
                    ),
                    (SignalRows::Frequencies(_), _) | (_, SignalRows::Frequencies(_)) => (
                        format!("{} are combined with {}", first.words(), second.words()),
                        "their rows are of different kinds",
                    ),
                    _ => (
                        "modes are combined with samples".to_owned(),
                        "one side has a row for each mode, the other for each sample",
                    ),
                }
            }
            (Type::Signal { rows, .. }, _) | (_, Type::Signal { rows, .. }) => {
                return Some(rows.clone());
            }
            _ => return None,
        };
        self.report(
            Diagnostic::error(codes::REPORT_SHAPE, title)
                .at(span, label)
                .with_help("make numbers of both before: `mode(x, 100 Hz)`, `at_frequency(x, 100 Hz)`, `rms(y)`"),
        );
        None
    }

    /// The type of an operator with a signal on one side: its type for the numbers of one row, in all rows.
    pub(super) fn operated_by_rows(
        &mut self,
        op: BinaryOp,
        op_span: Span,
        (left, a): (&Expr, &Type),
        (right, b): (&Expr, &Type),
    ) -> Type {
        let of_row = self.operated(op, op_span, (left, &a.row()), (right, &b.row()));
        if of_row == Type::Bool {
            // only numbers are compared; sides of different dimensions have their message already
            if let (Some(p), Some(q)) = (a.each(), b.each())
                && p.fits(&q).is_ok()
            {
                let what = "a side of a comparison";
                let _ = self
                    .shaped(left, a, Shape::Number, what)
                    .and_then(|()| self.shaped(right, b, Shape::Number, what));
            }
            return Type::Error;
        }
        match self.common_rows(op_span, a, b) {
            Some(rows) => of_row.in_rows(&rows),
            None => Type::Error,
        }
    }

    /// The type of a function of signals: its type for the numbers of one row, in all rows.
    pub(super) fn applied_by_rows(
        &mut self,
        function: &BuiltIn,
        arguments: &[(&Expr, Type)],
    ) -> Type {
        let mut whole = Type::Int;
        for (expr, ty) in arguments {
            if Shape::of(&whole) == Shape::Signal || Shape::of(ty) == Shape::Signal {
                match self.common_rows(expr.span, &whole, ty) {
                    Some(rows) => whole = Type::Int.in_rows(&rows),
                    None => return Type::Error,
                }
            }
        }
        let of_row: Vec<_> = arguments.iter().map(|(e, ty)| (*e, ty.row())).collect();
        let ty = self.applied(function, &of_row);
        match whole {
            Type::Signal { rows, .. } => ty.in_rows(&rows),
            _ => ty,
        }
    }
}
