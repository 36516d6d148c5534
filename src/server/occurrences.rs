//! All names of a text with their meanings: for uses, other names, and colours.
//!
//! The tree is walked once. Names that nothing defines, such as components of vectors, keep their place without a
//! meaning.

use super::index::{Found, Index, What, is_kind};
use eng_grammar::ast::{
    Argument, Binder, Binding, BindingKind, Block, Declaration, Expr, ExprKind, Form, Function,
    IndexArgument, Item, ItemKind, Kind, Name, Parameter, Statement, TypeExpr, TypeExprKind,
    UnitExpr, Use, UseNames,
};
use eng_grammar::{Diagnostics, MessagePart, Span, parse_message};
use std::collections::BTreeMap;

/// The kind of a name, for its colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Token {
    Module,
    Dimension,
    Class,
    Interface,
    Record,
    Choice,
    Word,
    Function,
    Parameter,
    Value,
    Member,
    Unit,
}

/// A definition, by its module and the first byte of its name there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Target {
    pub module: usize,
    pub start: u32,
}

/// A name at a place of the document.
#[derive(Clone, Copy, Debug)]
pub(super) struct Occurrence {
    pub span: Span,
    /// Its definition; none for a name of the language, and for one that is not known.
    pub of: Option<Target>,
    pub token: Token,
    /// Whether it is the definition.
    pub defines: bool,
}

/// The names of the document of an index, in the order of their places.
pub(super) fn occurrences(index: &Index<'_>) -> Vec<Occurrence> {
    let number = index.own();
    let Some(module) = index.module(number) else {
        return Vec::new();
    };
    let (mut values, mut units) = (BTreeMap::new(), BTreeMap::new());
    for found in index.visible(number) {
        let names = match is_unit(found) {
            true => &mut units,
            false => &mut values,
        };
        names.entry(found.name().text.as_str()).or_insert(found);
    }
    let mut walk = Walk {
        index,
        number,
        outer: values,
        units,
        inner: Vec::new(),
        model: None,
        in_body: false,
        text: &module.text,
        found: Vec::new(),
    };
    walk.items(&module.file.items);
    let mut found = walk.found;
    found.sort_by_key(|one| (one.span.start, one.of.is_none()));
    found.dedup_by_key(|one| one.span.start);
    found
}

fn is_unit(found: Found<'_>) -> bool {
    matches!(found.item().map(|item| &item.kind), Some(ItemKind::Unit(_)))
}

struct Walk<'i, 'l> {
    index: &'i Index<'l>,
    number: usize,
    /// Names at the top level, without units.
    outer: BTreeMap<&'i str, Found<'i>>,
    units: BTreeMap<&'i str, Found<'i>>,
    /// Variables of lists and of dimensions around a place, the innermost last.
    inner: Vec<(String, Span)>,
    /// The model whose names an argument of an analysis states.
    model: Option<Found<'i>>,
    /// Whether a place is in the block of a body, whose attributes are names of the language.
    in_body: bool,
    text: &'i str,
    found: Vec<Occurrence>,
}

impl<'i> Walk<'i, '_> {
    fn push(&mut self, span: Span, of: Option<Target>, token: Token, defines: bool) {
        self.found.push(Occurrence {
            span,
            of,
            token,
            defines,
        });
    }

    /// A definition of the document itself.
    fn define(&mut self, name: &Name, token: Token) {
        let of = Target {
            module: self.number,
            start: name.span.start,
        };
        self.push(name.span, Some(of), token, true);
    }

    fn refer(&mut self, span: Span, found: Found<'i>) {
        let of = Target {
            module: found.module,
            start: found.name_span().start,
        };
        let token = self.token(found);
        self.push(span, Some(of), token, false);
    }

    fn token(&self, found: Found<'_>) -> Token {
        match found.what {
            What::Parameter(_) => Token::Parameter,
            What::Item(item, _) => of_item(&item.kind),
            What::Name(name) => {
                let is_word = |item: &Item| matches!(&item.kind, ItemKind::Choice(choice) if choice.words.contains(name));
                let module = self.index.module(found.module);
                match module.is_some_and(|module| module.file.items.iter().any(is_word)) {
                    true => Token::Word,
                    false => Token::Value,
                }
            }
        }
    }

    fn items(&mut self, items: &'i [Item]) {
        items.iter().for_each(|item| self.item(item));
    }

    fn item(&mut self, item: &'i Item) {
        if let Some(name) = item.kind.name() {
            self.define(name, of_item(&item.kind));
        }
        match &item.kind {
            ItemKind::Use(item) => self.used(item),
            ItemKind::Dimension(item) => self.types(item.definition.as_ref()),
            ItemKind::Unit(item) => {
                self.types(item.dimension.as_ref());
                self.values([&item.definition, &item.offset].into_iter().flatten());
            }
            ItemKind::Choice(item) => {
                let words = item.words.iter();
                words.for_each(|word| self.define(word, Token::Word));
            }
            ItemKind::Binding(item) => self.binding(item),
            ItemKind::Function(item) => self.function(item),
            ItemKind::Table(item) => {
                self.parameters(&item.parameters);
                self.types(item.result.as_ref());
                self.value(&item.source);
            }
            ItemKind::Statement(item) => self.statement(item),
            ItemKind::Declaration(item) => self.declaration(item),
            ItemKind::Attribute(item) => {
                self.value(&item.value);
            }
            ItemKind::Report(item) => self.items(&item.block.items),
            ItemKind::Entry(item) => {
                self.value(&item.value);
                self.unit(item.display.as_ref());
            }
            ItemKind::Error => {}
        }
    }

    fn used(&mut self, item: &Use) {
        for name in &item.path {
            self.push(name.span, None, Token::Module, false);
        }
        let path: Vec<&str> = item.path.iter().map(|name| name.text.as_str()).collect();
        let index = self.index;
        let module = index.numbered(&path.join("."));
        if let UseNames::Some(names) = &item.names {
            for name in names {
                // the last name may be that of a module
                match module.and_then(|module| index.look_up(module, &name.text)) {
                    Some(found) => self.refer(name.span, found),
                    None => self.push(name.span, None, Token::Module, false),
                }
            }
        }
    }

    fn binding(&mut self, item: &'i Binding) {
        let depth = self.inner.len();
        self.binders(&item.index);
        // an index of an item is among the names of its block
        self.inner.truncate(depth);
        self.types(item.ty.as_ref());
        self.values(
            [&item.value, &item.frame, &item.scale]
                .into_iter()
                .flatten(),
        );
        self.unit(item.display.as_ref());
        if let Some((low, high)) = &item.limits {
            self.values([low, high]);
        }
    }

    /// The variables of loops; they are known after it.
    fn binders(&mut self, binders: &[Binder]) {
        for binder in binders {
            self.value(&binder.range);
            self.define(&binder.name, Token::Value);
            self.inner
                .push((binder.name.text.clone(), binder.name.span));
        }
    }

    fn parameters(&mut self, parameters: &[Parameter]) {
        for parameter in parameters {
            self.define(&parameter.name, Token::Parameter);
            self.types([&parameter.ty]);
            self.values(&parameter.default);
            if let Some((low, high)) = &parameter.limits {
                self.values([low, high]);
            }
        }
    }

    fn function(&mut self, item: &'i Function) {
        let depth = self.inner.len();
        for name in &item.generics {
            self.define(name, Token::Dimension);
            self.inner.push((name.text.clone(), name.span));
        }
        self.parameters(&item.parameters);
        self.types(item.result.as_ref());
        for binding in &item.lets {
            self.define(&binding.name, Token::Value);
            self.binding(binding);
        }
        for requirement in &item.requirements {
            self.value(&requirement.condition);
            self.message(&requirement.message);
        }
        self.values(&item.value);
        self.inner.truncate(depth);
    }

    fn declaration(&mut self, item: &'i Declaration) {
        let depth = self.inner.len();
        self.binders(&item.index);
        self.inner.truncate(depth);
        self.values(&item.condition);
        match &item.form {
            Form::Class {
                parameters,
                interface,
                block,
            } => {
                self.parameters(parameters);
                self.interface(interface.as_ref());
                self.items(&block.items);
            }
            Form::Plain { interface, block } => {
                self.interface(interface.as_ref());
                let outside = self.in_body;
                self.in_body = matches!(item.kind, Kind::Body | Kind::Flexible);
                self.items(&block.items);
                self.in_body = outside;
            }
            Form::Instance { value, block } => {
                let class = match item.kind {
                    Kind::Analysis => {
                        self.analysis(value);
                        None
                    }
                    _ => self.value(value),
                };
                if let Some(block) = block {
                    self.items(&block.items);
                }
                if let (Some(class), Some(changes)) = (class, &item.changes) {
                    self.changes(class, changes);
                }
            }
        }
    }

    fn interface(&mut self, name: Option<&Name>) {
        if let Some(name) = name
            && let Some(found) = self.outer.get(name.text.as_str()).copied()
        {
            self.refer(name.span, found);
        }
    }

    /// The call of an analysis: its model, then arguments. Some of them state names of the model.
    fn analysis(&mut self, value: &Expr) {
        let ExprKind::Call { callee, arguments } = &value.kind else {
            self.value(value);
            return;
        };
        if self.value(callee).is_none() {
            self.push(callee.span, None, Token::Function, false);
        }
        let mut model = None;
        for (place, argument) in arguments.iter().enumerate() {
            if let Some(name) = &argument.name {
                self.push(name.span, None, Token::Member, false);
            }
            self.model = model;
            let found = self.value(&argument.value);
            self.model = None;
            if place == 0 {
                model = found;
            }
        }
    }

    /// The block after `with`: paths inside of a part, with values of the text around it.
    fn changes(&mut self, class: Found<'i>, block: &'i Block) {
        for item in &block.items {
            match &item.kind {
                ItemKind::Statement(
                    Statement::Change { target, value }
                    | Statement::Start { target, value }
                    | Statement::Guess { target, value },
                ) => {
                    self.within(class, target);
                    self.value(value);
                }
                ItemKind::Attribute(attribute) => {
                    self.member(class, &attribute.name);
                    self.value(&attribute.value);
                }
                _ => self.item(item),
            }
        }
    }

    /// A path that begins inside of a definition.
    fn within(&mut self, class: Found<'i>, path: &Expr) -> Option<Found<'i>> {
        match &path.kind {
            ExprKind::Name(text) => {
                let name = Name {
                    text: text.clone(),
                    span: path.span,
                };
                self.member(class, &name)
            }
            ExprKind::Field { base, name } => {
                let base = self.within(class, base);
                base.and_then(|base| self.member(base, name))
            }
            ExprKind::Index { base, indices } => {
                let base = self.within(class, base);
                self.indices(indices);
                base
            }
            _ => self.value(path),
        }
    }

    fn statement(&mut self, item: &'i Statement) {
        match item {
            Statement::Constrain(value) | Statement::Branch(value) | Statement::Resolve(value) => {
                self.value(value);
            }
            Statement::Start { target, value } | Statement::Guess { target, value } => {
                // `start position = …` in a body
                if !(self.in_body && matches!(target.kind, ExprKind::Name(_))) {
                    self.value(target);
                }
                self.value(value);
            }
            Statement::Change { target, value } => self.values([target, value]),
            Statement::Apply {
                value, on, against, ..
            } => {
                self.values([value, on]);
                self.values(against);
            }
            Statement::Require {
                index,
                condition,
                message,
                ..
            } => {
                let depth = self.inner.len();
                self.binders(index);
                self.value(condition);
                self.message(message);
                self.inner.truncate(depth);
            }
            Statement::Place { moving, on, height } => {
                self.values([moving, on]);
                self.values(height);
            }
            Statement::Rate { state, value } => {
                self.name(&state.text, state.span);
                self.value(value);
            }
            Statement::Accept(_) => {}
        }
    }

    /// A text with values in braces. Its span is that inside of the quotes.
    fn message(&mut self, message: &Name) {
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

    fn types<'t>(&mut self, types: impl IntoIterator<Item = &'t TypeExpr>) {
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
    fn unit<'u>(&mut self, unit: impl IntoIterator<Item = &'u UnitExpr>) {
        for factor in unit.into_iter().flat_map(|unit| &unit.factors) {
            match self.units.get(factor.name.text.as_str()).copied() {
                Some(found) => self.refer(factor.name.span, found),
                None => {
                    self.name(&factor.name.text, factor.name.span);
                }
            }
        }
    }

    fn values<'e>(&mut self, values: impl IntoIterator<Item = &'e Expr>) {
        for value in values {
            self.value(value);
        }
    }

    /// An expression. Returns the definition that it names.
    fn value(&mut self, value: &Expr) -> Option<Found<'i>> {
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

    fn indices(&mut self, indices: &[IndexArgument]) {
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
    fn member(&mut self, base: Found<'i>, name: &Name) -> Option<Found<'i>> {
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
    fn name(&mut self, text: &str, span: Span) -> Option<Found<'i>> {
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

/// The kind of the name of an item.
fn of_item(kind: &ItemKind) -> Token {
    match kind {
        ItemKind::Dimension(_) => Token::Dimension,
        ItemKind::Unit(_) => Token::Unit,
        ItemKind::Choice(_) => Token::Choice,
        ItemKind::Function(_) | ItemKind::Table(_) => Token::Function,
        ItemKind::Report(_) => Token::Module,
        ItemKind::Entry(_) => Token::Member,
        ItemKind::Binding(binding) => match binding.kind {
            BindingKind::Const | BindingKind::Param | BindingKind::Input => Token::Parameter,
            BindingKind::Output => Token::Member,
            BindingKind::Let | BindingKind::State | BindingKind::Field => Token::Value,
        },
        ItemKind::Declaration(declaration) => match (declaration.kind, &declaration.form) {
            (Kind::Interface, _) => Token::Interface,
            (Kind::Record, _) => Token::Record,
            (Kind::Model | Kind::Component, _) | (_, Form::Class { .. }) => Token::Class,
            _ => Token::Value,
        },
        ItemKind::Use(_) | ItemKind::Statement(_) | ItemKind::Attribute(_) | ItemKind::Error => {
            Token::Value
        }
    }
}
