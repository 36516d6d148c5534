//! Sections stacked along an axis, as the mesh of a flexible body.

use super::super::typed::RecordScope;
use super::super::value::{ScopeId, Value};
use super::super::{Elaborator, Eval, location};
use super::bare_word;
use crate::words::{AXES, Place, argument};
use eng_grammar::Span;
use eng_grammar::ast::{self, ExprKind};
use eng_system::flexible::StackSource;
use eng_system::stack::{Corner, Section, Stack};

impl<'a> Elaborator<'a, '_> {
    pub(super) fn stack_source(
        &mut self,
        value: &'a ast::Expr,
        scope: ScopeId,
    ) -> Eval<StackSource> {
        let (word, arguments) = self.worded(Place::Mesh, value)?;
        let get = |name: &str| argument(word, arguments, name);
        let axis = get("axis").map(bare_word);
        let axis = axis.and_then(|axis| AXES.iter().position(|known| *known == axis));
        let axis = self.checked(axis, value.span, "a stack without its axis")?;
        let size = self.checked(get("size"), value.span, "a stack without a size")?;
        let size = self.structural_number(size, scope)?;
        let begin = match get("begin") {
            Some(begin) => self.structural_number(begin, scope)?,
            None => 0.0,
        };
        let listed = self.checked(get("sections"), value.span, "a stack without sections")?;
        let sections = self.evaluate(listed, scope)?;
        let sections: Vec<Value<'a>> = self.read(sections, listed.span)?;
        // each section of a written list has its own place
        let places = match &listed.kind {
            ExprKind::List { items, .. } if items.len() == sections.len() => {
                items.iter().map(|item| location(item.span)).collect()
            }
            _ => vec![location(listed.span); sections.len()],
        };
        let sections: Eval<Vec<Section>> = sections
            .into_iter()
            .map(|section| self.section(section, listed.span))
            .collect();
        Ok(StackSource {
            stack: Stack {
                axis: axis as u8,
                begin,
                size,
                sections: sections?,
            },
            sections: places,
            at: location(value.span),
        })
    }

    /// The numbers of a section's record.
    fn section(&mut self, section: Value<'a>, span: Span) -> Eval<Section> {
        let RecordScope(record) = self.read(section, span)?;
        let length = self.number_of_record(record, "length", span)?;
        let corners = self.entry(record, "corners", span)?;
        let corners: Vec<Value<'a>> = self.read(corners, span)?;
        let corners: Eval<Vec<Corner>> = corners
            .into_iter()
            .map(|corner| {
                let RecordScope(corner) = self.read(corner, span)?;
                let place = self.entry(corner, "place", span)?;
                let place = self.as_components(place, span)?;
                let mut numbers = [0.0; 2];
                for (number, scalar) in numbers.iter_mut().zip(place) {
                    *number = self.structural(scalar, span)?;
                }
                Ok(Corner {
                    place: numbers,
                    bend: self.number_of_record(corner, "bend", span)?,
                })
            })
            .collect();
        Ok(Section {
            corners: corners?,
            length,
        })
    }

    fn number_of_record(&mut self, record: ScopeId, field: &str, span: Span) -> Eval<f64> {
        let value = self.entry(record, field, span)?;
        let scalar = self.as_scalar(value, span)?;
        self.structural(scalar, span)
    }
}
