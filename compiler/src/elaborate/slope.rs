//! Functions of functions: `slope`, `curvature`, `period`; [`super::solve`] has the fourth.

use super::partial::Passed;
use super::scalar::{Scalar, Stage};
use super::value::{Partial, ScopeId, Value};
use super::{Elaborator, Eval};
use crate::codes;
use eng_grammar::{Diagnostic, Span};
use std::rc::Rc;

/// A function whose derivative is asked for.
pub(super) struct Differentiated<'a, 'c> {
    pub function: &'c Value<'a>,
    /// The call of `slope`, `curvature`, or of such a function, and its scope.
    pub call: Span,
    pub scope: ScopeId,
}

impl<'a> Elaborator<'a, '_> {
    pub(super) fn of_functions(
        &mut self,
        name: &str,
        values: Vec<(Value<'a>, Span)>,
        span: Span,
        scope: ScopeId,
    ) -> Eval<Value<'a>> {
        let mut values = values.into_iter();
        let (function, written) = self.checked(values.next(), span, "no function is given")?;
        if name == "period" {
            if let Value::Partial(partial) = &function
                && matches!(partial.function, Value::Table(_))
            {
                return Err(self.report(
                    Diagnostic::error(
                        codes::WRONG_TYPE,
                        "`period` of a table with some of its arguments is not known",
                    )
                    .at(written, "a table of several arguments")
                    .with_help("pass the period beside the table, as another number"),
                ));
            }
            return Ok(Value::Scalar(match function {
                Value::Table(table) => self.graphs.table_period(table.handle),
                // a function of the text states no period
                _ => self.graphs.constant(0.0),
            }));
        }
        if name == "solve" {
            let (estimate, place) = self.checked(values.next(), span, "no estimate is given")?;
            let differentiated = Differentiated {
                function: &function,
                call: span,
                scope,
            };
            return self.solve(&differentiated, (written, estimate, place));
        }
        let order = if name == "slope" { 1 } else { 2 };
        if self.typed.findings.bound.contains(&span) {
            return Ok(Value::Partial(Rc::new(Partial {
                function,
                order,
                given: Vec::new(),
            })));
        }
        let (x, place) = self.checked(values.next(), span, "no argument is given")?;
        let x = self.as_scalar(x, place)?;
        Ok(Value::Scalar(match function {
            Value::Table(table) => {
                let slope = self.graphs.slope_of_table(table.handle, x, order);
                self.note_kink(slope.stage, slope.node, 0, place, span, scope)?;
                slope
            }
            function @ (Value::Closure(_) | Value::Partial(_)) => {
                let differentiated = Differentiated {
                    function: &function,
                    call: span,
                    scope,
                };
                self.derivative(&differentiated, x, order)?
            }
            other => {
                let what = format!("`{name}` of {}", other.kind());
                return self.checked(None, span, &what);
            }
        }))
    }

    /// A derivative of a function at x.
    pub(super) fn derivative(
        &mut self,
        differentiated: &Differentiated<'a, '_>,
        x: Scalar,
        order: u8,
    ) -> Eval<Scalar> {
        // the value itself is not used, but its call evaluates the function's conditions and gives the
        // stage
        let stage = self.value_of(differentiated, x)?.stage;
        let x = match stage {
            Stage::Bind => x.node,
            Stage::Motion => self.graphs.lift(x.stage, x.node),
        };
        // The derivative is taken at an input that nothing else uses, because the parts of x may also reach the
        // function by other names.
        self.context.unknowns += 1;
        let input = u32::MAX - self.context.unknowns;
        let unknown = self.graphs.unknown(stage, input);
        let value = self.value_of(differentiated, unknown);
        self.context.unknowns -= 1;
        let mut value = value?;
        if stage == Stage::Motion {
            value = Scalar {
                stage,
                node: self.graphs.lift(value.stage, value.node),
            };
        }
        Ok(self.graphs.derivative_at(value, input, order, x))
    }

    fn value_of(&mut self, differentiated: &Differentiated<'a, '_>, x: Scalar) -> Eval<Scalar> {
        let passed = vec![Passed {
            place: 0,
            value: Value::Scalar(x),
            span: differentiated.call,
            scope: differentiated.scope,
        }];
        let value = self.apply(
            differentiated.function,
            passed,
            differentiated.call,
            differentiated.scope,
        )?;
        self.as_scalar(value, differentiated.call)
    }
}
