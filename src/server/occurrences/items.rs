//! The names of items: the walk over declarations, bindings, functions and statements.

use super::super::index::Found;
use super::{Token, Walk, of_item};
use eng_grammar::ast::{
    Binder, Binding, Block, Declaration, Expr, ExprKind, Form, Function, Item, ItemKind, Kind,
    Name, Parameter, Statement, Use, UseNames,
};

impl<'i> Walk<'i, '_> {
    pub(super) fn items(&mut self, items: &'i [Item]) {
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
    pub(super) fn binders(&mut self, binders: &[Binder]) {
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
}
