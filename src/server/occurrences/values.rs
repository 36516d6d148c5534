//! The names of expressions, types, units and messages, by the names in scope.

use super::super::index::{Found, is_kind};
use super::{Target, Token, Walk};
use eng_grammar::ast::{
    Argument, Expr, ExprKind, IndexArgument, Kind, Name, TypeExpr, TypeExprKind, UnitExpr,
};
use eng_grammar::{Diagnostics, MessagePart, Span, parse_message};

impl<'i> Walk<'i, '_> {
    /// A text with values in braces. Its span is that inside of the quotes.
    pub(super) fn message(&mut self, message: &Name) {
        if !message.text.contains('{') {
            return;
        }
        for part in parse_message(message, None, &mut Diagnostics::new()) {
            if let MessagePart::Value { value, unit, .. } = part {
                self.value(&value);
                self.unit(unit.as_ref());
            }
        }
    }

    pub(super) fn types<'t>(&mut self, types: impl IntoIterator<Item = &'t TypeExpr>) {
        types.into_iter().for_each(|ty| self.type_of(ty));
    }

    fn type_of(&mut self, ty: &TypeExpr) {
        match &ty.kind {
            TypeExprKind::Name(name) => {
                let own = self.inner.iter().rfind(|(text, _)| *text == name.text);
                let own = own.map(|(_, span)| span.start);
                if let Some(start) = own {
                    let module = self.number;
                    let of = Some(Target { module, start });
                    self.push(name.span, of, Token::Dimension, false);
                } else if let Some(found) = self.outer.get(name.text.as_str()).copied() {
                    self.refer(name.span, found);
                }
            }
            TypeExprKind::Generic(_, inner) => self.types(inner),
            TypeExprKind::Array(inner, length) => {
                self.type_of(inner);
                self.value(length);
            }
            TypeExprKind::Product(left, right) | TypeExprKind::Quotient(left, right) => {
                self.type_of(left);
                self.type_of(right);
            }
            TypeExprKind::Power(base, ..) => self.type_of(base),
            TypeExprKind::Function(arguments, result) => {
                self.types(arguments);
                self.type_of(result);
            }
            TypeExprKind::One | TypeExprKind::Error => {}
        }
    }

    /// A unit. The tree of a text by itself takes each word after a number for a unit, so a word that is none is a
    /// value: `2 N/m*depth`.
    pub(super) fn unit<'u>(&mut self, unit: impl IntoIterator<Item = &'u UnitExpr>) {
        for factor in unit.into_iter().flat_map(|unit| &unit.factors) {
            match self.units.get(factor.name.text.as_str()).copied() {
                Some(found) => self.refer(factor.name.span, found),
                None => {
                    self.name(&factor.name.text, factor.name.span);
                }
            }
        }
    }

    pub(super) fn values<'e>(&mut self, values: impl IntoIterator<Item = &'e Expr>) {
        for value in values {
            self.value(value);
        }
    }

    /// An expression. Returns the definition that it names.
    pub(super) fn value(&mut self, value: &Expr) -> Option<Found<'i>> {
        match &value.kind {
            ExprKind::Name(text) => return self.name(text, value.span),
            ExprKind::Field { base, name } => {
                let base = self.value(base);
                match base {
                    Some(base) => return self.member(base, name),
                    None => self.push(name.span, None, Token::Member, false),
                }
            }
            ExprKind::Index { base, indices } => {
                let base = self.value(base);
                self.indices(indices);
                return base;
            }
            ExprKind::Call { callee, arguments } => return self.call(callee, arguments),
            ExprKind::Paren { inner, unit } => {
                let found = self.value(inner);
                self.unit(unit);
                return found;
            }
            ExprKind::Number { unit, .. } => self.unit(unit),
            ExprKind::List { items, unit } => {
                self.values(items);
                self.unit(unit);
            }
            ExprKind::Comprehension {
                body,
                binders,
                unit,
            } => {
                let depth = self.inner.len();
                self.binders(binders);
                self.value(body);
                self.inner.truncate(depth);
                self.unit(unit);
            }
            ExprKind::Unary { operand, .. } => {
                self.value(operand);
            }
            ExprKind::Binary { left, right, .. } => {
                self.value(left);
                self.value(right);
            }
            ExprKind::If {
                condition,
                then,
                otherwise,
            } => {
                self.value(condition);
                self.value(then);
                if let Some(otherwise) = otherwise {
                    self.value(otherwise);
                }
            }
            ExprKind::Range { from, to, by } => {
                self.value(from);
                self.value(to);
                if let Some(by) = by {
                    self.value(by);
                }
            }
            ExprKind::Text(_) => {
                // as written, because the places count its escapes, too
                let (start, end) = (value.span.start + 1, value.span.end.saturating_sub(1));
                let text = self.text.get(start as usize..end as usize);
                let span = Span {
                    start,
                    end,
                    ..value.span
                };
                let text = text.unwrap_or("").to_owned();
                self.message(&Name { text, span });
            }
            ExprKind::Bool(_) | ExprKind::Error => {}
        }
        None
    }

    pub(super) fn indices(&mut self, indices: &[IndexArgument]) {
        for index in indices {
            if let IndexArgument::At(at) = index {
                self.value(at);
            }
        }
    }

    fn call(&mut self, callee: &Expr, arguments: &[Argument]) -> Option<Found<'i>> {
        let found = self.value(callee);
        if let (None, ExprKind::Name(_)) = (found, &callee.kind) {
            // a function of the language, or a kind of analysis or of figure
            self.push(callee.span, None, Token::Function, false);
        }
        let index = self.index;
        let parameters = found.map_or_else(Vec::new, |found| index.parameters(found));
        for argument in arguments {
            if let Some(name) = &argument.name {
                let mut parameters = parameters.iter().copied();
                match parameters.find(|parameter| parameter.name().text == name.text) {
                    Some(parameter) => self.refer(name.span, parameter),
                    None => self.push(name.span, None, Token::Member, false),
                }
            }
            self.value(&argument.value);
        }
        found
    }

    /// A name after a dot.
    pub(super) fn member(&mut self, base: Found<'i>, name: &Name) -> Option<Found<'i>> {
        let index = self.index;
        let mut members = index.members(base).into_iter();
        let found = members.find(|member| member.name().text == name.text);
        match found {
            Some(found) => self.refer(name.span, found),
            None => self.push(name.span, None, Token::Member, false),
        }
        found
    }

    /// A name without a dot before it.
    pub(super) fn name(&mut self, text: &str, span: Span) -> Option<Found<'i>> {
        let inner = self.inner.iter().rfind(|(name, _)| name == text);
        if let Some(start) = inner.map(|(_, span)| span.start) {
            let module = self.number;
            self.push(span, Some(Target { module, start }), Token::Value, false);
            return None;
        }
        let index = self.index;
        // the cycle of a model is read by the word `cycle`
        let named =
            |found: &Found<'i>| found.name().text == text && !is_kind(*found, &[Kind::Cycle]);
        let of_model = self
            .model
            .map_or_else(Vec::new, |model| index.members(model));
        let mut near = of_model.into_iter();
        let found = near.find(named).or_else(|| {
            let mut near = index.locals(span.start as usize).into_iter();
            near.find(named)
        });
        let found = found.or_else(|| self.outer.get(text).copied())?;
        self.refer(span, found);
        Some(found)
    }
}
