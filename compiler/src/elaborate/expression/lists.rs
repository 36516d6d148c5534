//! Ranges and lists: their lengths and elements.

use super::super::value::{ScopeId, Value, present};
use super::super::{Elaborator, Eval};
use crate::codes;
use eng_grammar::ast::{Expr, IndexArgument};
use eng_grammar::{Diagnostic, Span};

impl<'a> Elaborator<'a, '_> {
    pub(super) fn range(
        &mut self,
        from: &'a Expr,
        to: &'a Expr,
        by_expr: Option<&'a Expr>,
        scope: ScopeId,
    ) -> Eval<Value<'a>> {
        let a = self.evaluate(from, scope)?;
        let b = self.evaluate(to, scope)?;
        let step = match by_expr {
            Some(by) => Some(self.evaluate(by, scope)?),
            None => None,
        };
        if let (Value::Int(a), Value::Int(b), None | Some(Value::Int(_))) = (&a, &b, &step) {
            let by = match step {
                Some(Value::Int(s)) => s,
                _ => 1,
            };
            let span = from.span.to(by_expr.map_or(to.span, |e| e.span));
            if by == 0 {
                return Err(self.wrong_step(span, "its step is zero"));
            }
            // 128 bits, because the difference of two 64-bit numbers can overflow
            let (a, b, by) = (i128::from(*a), i128::from(*b), i128::from(by));
            if (b - a) / by > LONGEST_LIST as i128 {
                return Err(self.long_range(span, &too_long()));
            }
            let mut values = Vec::new();
            let mut i = a;
            while (by > 0 && i <= b) || (by < 0 && i >= b) {
                values.extend(i64::try_from(i).map(Value::Int));
                i += by;
            }
            return Ok(Value::List(values));
        }
        let a = self.as_scalar(a, from.span)?;
        let b = self.as_scalar(b, to.span)?;
        let by_span = by_expr.map_or(to.span, |e| e.span);
        let step = match step {
            Some(v) => self.as_scalar(v, by_span)?,
            None => {
                // a range without a step has whole numbers
                return Err(self.not_countable(from.span.to(to.span)));
            }
        };
        let known = (
            self.structural(a, from.span)?,
            self.structural(b, to.span)?,
            self.structural(step, by_span)?,
        );
        let (a_value, b_value, by_value) = known;
        // a whole number of steps must not lose its last one by rounding
        let count = ((b_value - a_value) / by_value * (1.0 + 1e-12)).floor();
        let span = from.span.to(by_span);
        if by_value == 0.0 {
            return Err(self.wrong_step(span, "its step is zero"));
        }
        if count < 0.0 {
            return Err(self.wrong_step(span, "its step leads away from its end"));
        }
        if !(0.0..LONGEST_LIST as f64).contains(&count) {
            return Err(self.long_range(span, &too_long()));
        }
        Ok(Value::List(
            (0..=count as usize)
                .map(|i| Value::Scalar(self.graphs.constant(a_value + i as f64 * by_value)))
                .collect(),
        ))
    }

    /// Reports a whole number whose value is too large.
    pub(in crate::elaborate) fn not_countable(&mut self, span: Span) -> super::super::Reported {
        self.report(
            Diagnostic::error(
                codes::NOT_COUNTABLE,
                "a whole number is too large to count with",
            )
            .at(span, "too large for a count or an index"),
        )
    }

    pub(super) fn long_range(&mut self, span: Span, why: &str) -> super::super::Reported {
        self.report(endless_range(span, why))
    }

    /// Reports a range whose step does not reach its end.
    fn wrong_step(&mut self, span: Span, why: &str) -> super::super::Reported {
        self.report(endless_range(span, why).with_help(
            "state a positive step to a larger end, or a negative step to a smaller end",
        ))
    }

    /// The elements of a list or family. A range, a list of numbers or `*` selects several; the indices after
    /// it belong to each of these.
    pub(super) fn indexed(
        &mut self,
        value: Value<'a>,
        indices: &'a [IndexArgument],
        scope: ScopeId,
    ) -> Eval<Value<'a>> {
        let Some((first, rest)) = indices.split_first() else {
            return Ok(value);
        };
        let (places, span) = match first {
            // a family keeps its indices
            IndexArgument::All(_) if rest.is_empty() => return Ok(value),
            IndexArgument::All(span) => (all_places(&value), *span),
            IndexArgument::At(at) => match self.evaluate(at, scope)? {
                Value::List(items) => {
                    let mut places = Vec::with_capacity(items.len());
                    for item in items {
                        places.push(self.whole_number(item, at.span)?);
                    }
                    (places, at.span)
                }
                one => {
                    let place = self.whole_number(one, at.span)?;
                    let element = self.element_of(value, place, at.span)?;
                    return self.indexed(element, rest, scope);
                }
            },
        };
        let mut chosen = Vec::with_capacity(places.len());
        for place in places {
            let element = self.element_of(value.clone(), place, span)?;
            if let Value::Absent(declaration, path) = element {
                return Err(self.absent(declaration, &path, span));
            }
            chosen.push(match self.indexed(element, rest, scope)? {
                Value::Family(members) => Value::List(present(members).map(|(_, v)| v).collect()),
                other => other,
            });
        }
        Ok(Value::List(chosen))
    }

    /// The whole number of a count or an index.
    pub(in super::super) fn whole_number(&mut self, value: Value<'a>, span: Span) -> Eval<i64> {
        match value {
            Value::Int(place) => Ok(place),
            other => {
                let number = self.as_scalar(other, span)?;
                self.structural(number, span)?;
                Err(self.not_countable(span))
            }
        }
    }

    pub(super) fn element_of(
        &mut self,
        value: Value<'a>,
        index: i64,
        span: Span,
    ) -> Eval<Value<'a>> {
        match Self::without_axes(value) {
            Value::Family(members) => {
                let shown: Vec<String> = members
                    .iter()
                    .filter(|(_, member)| !member.is_absent())
                    .filter_map(|(key, _)| key.first().map(usize::to_string))
                    .collect();
                let mut rest: Vec<(Vec<usize>, Value<'a>)> = members
                    .into_iter()
                    .filter(|(key, _)| key.first().is_some_and(|k| *k as i64 == index))
                    .map(|(key, v)| (key[1..].to_vec(), v))
                    .collect();
                match rest.pop() {
                    Some((key, value)) if key.is_empty() => Ok(value),
                    Some(last) => {
                        rest.push(last);
                        Ok(Value::Family(rest))
                    }
                    None => Err(self.no_element(index, span, known_indices(&shown))),
                }
            }
            value => {
                let items: Vec<Value<'a>> = self.read(value, span)?;
                let count = items.len();
                match usize::try_from(index)
                    .ok()
                    .and_then(|i| i.checked_sub(1))
                    .and_then(|i| items.into_iter().nth(i))
                {
                    Some(v) => Ok(v),
                    None => Err(self.no_element(
                        index,
                        span,
                        match count {
                            0 => "the list is empty".to_owned(),
                            _ => format!("indices run from 1 to {count}"),
                        },
                    )),
                }
            }
        }
    }

    pub(super) fn no_element(
        &mut self,
        index: i64,
        span: Span,
        known: String,
    ) -> super::super::Reported {
        self.report(
            Diagnostic::error(codes::INDEX_OUTSIDE, format!("there is no element {index}"))
                .at(span, format!("this is {index}; {known}")),
        )
    }

    /// Checks that two lists have one length.
    pub fn lengths(
        &mut self,
        first: usize,
        first_span: Span,
        second: usize,
        second_span: Span,
    ) -> super::super::Reported {
        self.report(
            Diagnostic::error(codes::LENGTHS, "two lists differ in length")
                .at(second_span, format!("{second} elements"))
                .also(first_span, format!("{first} elements")),
        )
    }
}

/// All first indices of a list or family, in their order.
fn all_places(value: &Value<'_>) -> Vec<i64> {
    match value {
        Value::Family(members) => {
            let mut places: Vec<i64> = Vec::new();
            for (key, _) in members.iter().filter(|(_, member)| !member.is_absent()) {
                let place = key.first().map(|place| *place as i64);
                places.extend(place.filter(|place| !places.contains(place)));
            }
            places
        }
        Value::List(items) => (1..=items.len() as i64).collect(),
        Value::Components(items, _) => (1..=items.len() as i64).collect(),
        _ => Vec::new(),
    }
}

/// Longest list or range. A choice: each element of it may become an instance, and a longer one is mostly a mistake
/// in its step.
const LONGEST_LIST: usize = 100_000;

fn too_long() -> String {
    format!("more than {LONGEST_LIST} values")
}

/// The existing indices as text. A long list is shortened.
fn known_indices(shown: &[String]) -> String {
    let mut distinct: Vec<&str> = Vec::new();
    for index in shown {
        if !distinct.contains(&index.as_str()) {
            distinct.push(index);
        }
    }
    match distinct.as_slice() {
        [] => "there are none".to_owned(),
        [first, .., last] if distinct.len() > 8 => {
            format!("there are {}, from {first} to {last}", distinct.len())
        }
        _ => format!("there are: {}", distinct.join(", ")),
    }
}

fn endless_range(span: Span, why: &str) -> Diagnostic {
    Diagnostic::error(codes::LONG_RANGE, "this range is endless or too long").at(span, why)
}
