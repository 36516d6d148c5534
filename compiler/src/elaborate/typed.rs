//! Access to the typed tree during elaboration.

use super::expression::Truth;
use super::scalar::Scalar;
use super::value::{ScopeId, Value};
use super::{Elaborator, Eval, Reported};
use crate::codes;
use crate::program::DefinitionId;
use crate::typed::Callee;
use crate::typed::types::{Solution, Type};
use eng_grammar::{Diagnostic, MessagePart, Span};
use eng_system::Dimension;
use std::rc::Rc;
use std::sync::Arc;

impl<'a> Elaborator<'a, '_> {
    /// The type of the expression, or the declared type, at a place.
    pub fn type_at(&mut self, place: Span) -> Eval<Type> {
        let later = self.later.types.get(&place);
        let found = later.or_else(|| self.typed.type_at(place)).cloned();
        self.checked(found, place, "it has no type")
    }

    /// The dimension of each number in the value of the expression, or of the declared type, at a place. It
    /// is that of a plain number if the value has no numbers.
    pub fn dimension_at(&mut self, place: Span, scope: ScopeId) -> Eval<Dimension> {
        let quantity = self.type_at(place)?.each().unwrap_or_default();
        if quantity.dim.is_known() {
            return Ok(quantity.dim.base);
        }
        Ok(match self.solution(scope) {
            Some(solution) => quantity.with(&solution).dim.base,
            None => quantity.dim.base,
        })
    }

    /// The dimensions of the variables of the function that surrounds a scope.
    pub fn solution(&self, scope: ScopeId) -> Option<Rc<Solution>> {
        let mut at = Some(scope);
        while let Some(id) = at {
            let scope = self.scope(id);
            if let Some(solution) = &scope.solution {
                return Some(Rc::clone(solution));
            }
            at = scope.parent;
        }
        None
    }

    /// The dimensions of the variables of a generic function at a use: a call, or an expression that passes
    /// the function.
    pub fn solution_at(&self, place: Span, scope: ScopeId) -> Option<Rc<Solution>> {
        let later = self.later.solutions.get(&place);
        let found = later.or_else(|| self.typed.findings.solutions.get(&place))?;
        Some(Rc::new(match self.solution(scope) {
            Some(outer) => found.within(&outer),
            None => found.clone(),
        }))
    }

    /// The parts of a message, by the place inside its quotes.
    pub fn message_at(&mut self, place: Span) -> Eval<&'a [MessagePart]> {
        let found = self.typed.findings.messages.get(&place);
        let parts = self.checked(found, place, "its parts are not known")?;
        Ok(parts)
    }

    /// The function or term of the language that the call at a place calls; `None` if it calls a value.
    pub fn callee_at(&self, place: Span) -> Option<Callee> {
        let later = self.later.callees.get(&place);
        later
            .or_else(|| self.typed.findings.callees.get(&place))
            .copied()
    }

    /// The parameter of each argument of the call at a place.
    pub fn call_at(&mut self, place: Span) -> Eval<Arc<[u32]>> {
        let later = self.later.calls.get(&place);
        let found = later.or_else(|| self.typed.findings.calls.get(&place));
        let found = found.cloned();
        self.checked(found, place, "its arguments are not known")
    }

    /// An item that every program without errors has: a finding, a required part of a declaration, a known
    /// word.
    ///
    /// The item always exists. Elaboration begins only after a check without errors. The checker infers every
    /// expression and type of every definition, used or not, and reports each missing or unknown part. If the
    /// item is missing, the checker has a fault. No text may make the compiler panic or guess, so this is an
    /// error.
    pub fn checked<T>(&mut self, found: Option<T>, place: Span, what: &str) -> Eval<T> {
        found.ok_or_else(|| self.contradiction(place, what))
    }

    /// A value read as the kind that the checker found.
    ///
    /// The value always has this kind. The checker fits the type of an expression to its context. Each
    /// operation of the evaluator gives the kind of value that belongs to the type of its expression.
    pub fn read<T: Reading<'a>>(&mut self, value: Value<'a>, place: Span) -> Eval<T> {
        T::read(value).map_err(|found| {
            let (due, found) = (T::KIND, found.kind());
            self.contradiction(place, &format!("{due} is expected, but this is {found}"))
        })
    }

    fn contradiction(&mut self, place: Span, what: &str) -> Reported {
        self.report(
            Diagnostic::error(
                codes::INTERNAL,
                format!("the compiler contradicts itself: {what}"),
            )
            .at(
                place,
                "the checker accepted this, and elaboration cannot evaluate it",
            )
            .with_help("please report this together with the model"),
        )
    }
}

/// A kind of value that can be read. A value of another kind is returned as the error.
pub(crate) trait Reading<'a>: Sized {
    /// The name of the kind in messages.
    const KIND: &'static str;

    fn read(value: Value<'a>) -> Result<Self, Value<'a>>;
}

macro_rules! readings {
    ($($ty:ty, $kind:literal, $pattern:pat => $result:expr;)*) => {
        $(impl<'a> Reading<'a> for $ty {
            const KIND: &'static str = $kind;

            fn read(value: Value<'a>) -> Result<Self, Value<'a>> {
                match value {
                    $pattern => Ok($result),
                    other => Err(other),
                }
            }
        })*
    };
}

readings! {
    Scalar, "a number", Value::Scalar(number) => number;
    MarkerIndex, "a marker", Value::Marker(marker) => MarkerIndex(marker);
    bool, "true or false", Value::Bool(known) => known;
    String, "a text", Value::Text(text) => text;
    DefinitionId, "a class", Value::Definition(id) => id;
    Rc<Vec<super::ModePart>>, "a mode set", Value::ModeSet(parts) => parts;
    RecordScope, "a record", Value::Record(_, scope) => RecordScope(scope);
    Vec<Value<'a>>, "a list", Value::List(items) => items;
}

/// A marker of the system.
pub(crate) struct MarkerIndex(pub u32);

/// The names of a record.
pub(crate) struct RecordScope(pub ScopeId);

impl<'a> Reading<'a> for Truth {
    const KIND: &'static str = "a truth value";

    fn read(value: Value<'a>) -> Result<Self, Value<'a>> {
        match value {
            Value::Bool(known) => Ok(Truth::Known(known)),
            Value::Flag(flag) => Ok(Truth::Later(flag)),
            other => Err(other),
        }
    }
}
