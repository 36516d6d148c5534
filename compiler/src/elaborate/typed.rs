//! What the typed tree says of the expressions that are being evaluated.

use super::value::ScopeId;
use super::{Elaborator, Eval};
use crate::typed::types::{Solution, Type};
use eng_grammar::{MessagePart, Span};
use eng_system::Dimension;
use std::rc::Rc;

impl<'a> Elaborator<'a, '_> {
    /// The type of the expression, or the declared type, at a place.
    pub fn type_at(&mut self, place: Span) -> Eval<Type> {
        let later = self.later.types.get(&place);
        match later.or_else(|| self.typed.type_at(place)) {
            Some(ty) => Ok(ty.clone()),
            // Every expression of a definition is inferred and every declared type looked up, whether it is used or
            // not, and elaboration begins only after a check without errors.
            None => Err(self.internal(place, "it has no type")),
        }
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
        match self.typed.findings.messages.get(&place) {
            Some(parts) => Ok(parts),
            // The checker reads every message of a definition to infer what it shows.
            None => Err(self.internal(place, "its parts are not known")),
        }
    }
}
