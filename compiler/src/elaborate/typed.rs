//! What the typed tree says of the expressions that are being evaluated.

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

    /// The dimension of each number in the value of the expression, or in values of the declared type, at a place;
    /// none for what is no number.
    pub fn dimension_at(&mut self, place: Span, scope: ScopeId) -> Eval<Dimension> {
        let quantity = self.type_at(place)?.each().unwrap_or_default();
        if quantity.dim.variables.is_empty() {
            return Ok(quantity.dim.base);
        }
        Ok(match self.solution(scope) {
            Some(solution) => quantity.with(&solution).dim.base,
            None => quantity.dim.base,
        })
    }

    /// What the dimension variables of the function around a scope stand for.
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

    /// What the dimension variables of a generic function stand for at a use of it, a call or an expression that hands
    /// it on.
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

    /// The function or term of the language that the call at a place calls; none where it calls a value.
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

    /// Something that a program without errors has: a finding, a required part of a declaration, one of the known words.
    ///
    /// It is always there: elaboration begins only after a check without errors; the checker infers every expression and
    /// type of every definition, whether it is used or not, and reports each missing or unknown part. A text that shows
    /// otherwise has found a mistake of the checker, and no text may make the compiler stop or guess.
    pub fn checked<T>(&mut self, found: Option<T>, place: Span, what: &str) -> Eval<T> {
        found.ok_or_else(|| self.contradiction(place, what))
    }

    /// A value read as what the checker found it to be.
    ///
    /// It is of that kind: the checker fits the type of an expression to the place where it stands, and each operation
    /// of the evaluator gives the kind of value that the type of its expression says.
    pub fn read<T: Reading<'a>>(&mut self, value: Value<'a>, place: Span) -> Eval<T> {
        T::read(value).map_err(|found| {
            let (due, found) = (T::KIND, found.kind());
            self.contradiction(place, &format!("{due} is due, but this is {found}"))
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
                "not understood here, though it was found to be right",
            )
            .with_help("please report this together with the model"),
        )
    }
}

/// What a value can be read as; a value of another kind comes back.
pub(crate) trait Reading<'a>: Sized {
    /// For messages.
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
