//! Items, declarations and blocks.

use super::diagnose;
use super::{Builder, MAX_DEPTH};
use crate::ast::{
    Attribute, Binding, BindingKind, Block, Choice, Declaration, DimensionItem, Entry, EntryKind,
    Expr, ExprKind, Form, Function, Item, ItemKind, Kind, Name, Parameter, Report, Requirement,
    Statement, Table, Title, UnitItem, Use, UseNames,
};
use crate::codes;
use crate::diagnostic::Diagnostic;
use crate::grammar::Rule;
use crate::span::Span;
use pest::iterators::{Pair, Pairs};

/// The text of a `///` or `//!` line.
pub(crate) fn doc_text(line: &str) -> String {
    let text = line
        .strip_prefix("///")
        .or_else(|| line.strip_prefix("//!"))
        .unwrap_or(line);
    text.strip_prefix(' ')
        .unwrap_or(text)
        .trim_end()
        .to_string()
}

/// The `///` lines among the children of a pair.
pub(crate) fn docs(pair: &Pair<'_, Rule>) -> Vec<String> {
    pair.clone()
        .into_inner()
        .filter(|inner| inner.as_rule() == Rule::doc)
        .map(|inner| doc_text(inner.as_str()))
        .collect()
}

fn binding_kind(word: &str) -> BindingKind {
    match word {
        "const" => BindingKind::Const,
        "param" => BindingKind::Param,
        "input" => BindingKind::Input,
        "state" => BindingKind::State,
        "field" => BindingKind::Field,
        "output" => BindingKind::Output,
        _ => BindingKind::Let,
    }
}

/// Every kind of declaration with its word.
pub const KINDS: [(&str, Kind); 15] = [
    ("model", Kind::Model),
    ("component", Kind::Component),
    ("interface", Kind::Interface),
    ("record", Kind::Record),
    ("body", Kind::Body),
    ("flexible", Kind::Flexible),
    ("marker", Kind::Marker),
    ("joint", Kind::Joint),
    ("force", Kind::Force),
    ("journal", Kind::Journal),
    ("drive", Kind::Drive),
    ("part", Kind::Part),
    ("cycle", Kind::Cycle),
    ("analysis", Kind::Analysis),
    ("default", Kind::Default),
];

fn kind_of(word: &str) -> Option<Kind> {
    KINDS
        .iter()
        .find(|(text, _)| *text == word)
        .map(|(_, kind)| *kind)
}

impl<'t> Builder<'t, '_> {
    /// Of an `item`.
    pub(super) fn item(&mut self, pair: Pair<'t, Rule>, depth: usize) -> Item {
        let docs = docs(&pair);
        let Some(body) = pair
            .clone()
            .into_inner()
            .find(|inner| inner.as_rule() != Rule::doc)
        else {
            return Item {
                docs,
                span: self.place(&pair),
                kind: ItemKind::Error,
            };
        };
        let span = self.place(&body);
        if depth > MAX_DEPTH {
            self.too_deep(span);
            return Item {
                docs,
                span,
                kind: ItemKind::Error,
            };
        }
        let kind = match body.as_rule() {
            Rule::use_item => self.use_item(body, span),
            Rule::dimension_item => self.dimension(body, depth),
            Rule::unit_item => self.unit_item(body, depth),
            Rule::choice_item => self.choice_item(body),
            Rule::binding => ItemKind::Binding(self.binding(body, depth)),
            Rule::function => self.function(body, span, depth),
            Rule::table => self.table(body, span, depth),
            Rule::declaration | Rule::unknown_declaration => self.declaration(body, depth),
            Rule::attribute => self.attribute(body, span, depth),
            Rule::report => self.report_block(body, span, depth),
            Rule::entry => self.entry(body, span, depth),
            _ => match self.statement(body, depth) {
                Some(statement) => ItemKind::Statement(statement),
                None => ItemKind::Error,
            },
        };
        Item { docs, span, kind }
    }

    fn use_item(&mut self, pair: Pair<'t, Rule>, span: Span) -> ItemKind {
        let mut path = Vec::new();
        let mut names = None;
        for part in pair.into_inner() {
            match part.as_rule() {
                Rule::name => path.push(self.name(&part)),
                Rule::use_all => names = Some(UseNames::All),
                Rule::use_list => {
                    names = Some(UseNames::Some(self.names(part)));
                }
                _ => {}
            }
        }
        if let Some(names) = names {
            return ItemKind::Use(Use { path, names });
        }
        match path.pop() {
            Some(last) if !path.is_empty() => ItemKind::Use(Use {
                path,
                names: UseNames::Some(vec![last]),
            }),
            last => {
                let module = last.map_or_else(|| "module".to_string(), |name| name.text);
                let end = self.span_end(span);
                self.report(
                    Diagnostic::error(codes::UNEXPECTED, "`use` must list the names that it takes")
                        .at(span, "names a module only")
                        .with_help(format!(
                            "`use {module}.*` takes all names, `use {module}.{{A, B}}` some"
                        ))
                        .with_fix("take all names", end, ".*"),
                );
                ItemKind::Error
            }
        }
    }

    /// The names among the children of a pair.
    fn names(&self, pair: Pair<'t, Rule>) -> Vec<Name> {
        pair.into_inner()
            .filter(|part| part.as_rule() == Rule::name)
            .map(|part| self.name(&part))
            .collect()
    }

    fn span_end(&self, span: Span) -> Span {
        Span {
            start: span.end,
            ..span
        }
    }

    fn dimension(&mut self, pair: Pair<'t, Rule>, depth: usize) -> ItemKind {
        let mut item = DimensionItem {
            name: Name {
                text: String::new(),
                span: self.place(&pair),
            },
            definition: None,
            point: false,
        };
        for part in pair.into_inner() {
            match part.as_rule() {
                Rule::name => item.name = self.name(&part),
                Rule::word_point => item.point = true,
                Rule::type_expression => item.definition = Some(self.type_expression(part, depth)),
                _ => {}
            }
        }
        ItemKind::Dimension(item)
    }

    fn choice_item(&mut self, pair: Pair<'t, Rule>) -> ItemKind {
        let names = pair
            .into_inner()
            .filter(|part| part.as_rule() == Rule::name);
        let mut names = names.map(|part| self.name(&part));
        match names.next() {
            Some(name) => ItemKind::Choice(Choice {
                name,
                words: names.collect(),
            }),
            None => ItemKind::Error,
        }
    }

    fn unit_item(&mut self, pair: Pair<'t, Rule>, depth: usize) -> ItemKind {
        let mut item = UnitItem {
            name: Name {
                text: String::new(),
                span: self.place(&pair),
            },
            dimension: None,
            definition: None,
            offset: None,
        };
        for part in pair.into_inner() {
            match part.as_rule() {
                Rule::unit_def_name => item.name = self.name(&part),
                Rule::type_expression => item.dimension = Some(self.type_expression(part, depth)),
                Rule::expression => item.definition = Some(self.expression(part, depth)),
                Rule::unit_zero => item.offset = self.inner_expression(part, depth),
                _ => {}
            }
        }
        ItemKind::Unit(item)
    }

    /// The first expression among the children of a pair.
    fn inner_expression(&mut self, pair: Pair<'t, Rule>, depth: usize) -> Option<Expr> {
        pair.into_inner()
            .find(|part| part.as_rule() == Rule::expression)
            .map(|part| self.expression(part, depth))
    }

    fn limits(&mut self, pair: Pair<'t, Rule>, depth: usize) -> Option<(Expr, Expr)> {
        let mut ends = pair
            .into_inner()
            .filter(|part| part.as_rule() == Rule::expression);
        let (low, high) = ends.next().zip(ends.next())?;
        Some((self.expression(low, depth), self.expression(high, depth)))
    }

    fn binding(&mut self, pair: Pair<'t, Rule>, depth: usize) -> Binding {
        let mut binding = Binding {
            kind: BindingKind::Let,
            name: Name {
                text: String::new(),
                span: self.place(&pair),
            },
            index: Vec::new(),
            ty: None,
            value: None,
            frame: None,
            display: None,
            limits: None,
            scale: None,
            summary: None,
            interpolation: None,
        };
        let mut tails: Vec<Rule> = Vec::new();
        for part in pair.into_inner() {
            let rule = part.as_rule();
            let place = self.place(&part);
            if let Some(shown) = match rule {
                Rule::limits | Rule::frame => Some("in"),
                Rule::display => Some("as"),
                Rule::error_scale => Some("scale"),
                Rule::summary => Some("summary"),
                Rule::interpolation => Some("interpolation"),
                _ => None,
            } {
                if tails.contains(&rule) {
                    self.report(
                        Diagnostic::error(codes::UNEXPECTED, format!("`{shown}` is here twice"))
                            .at(place, "the second one")
                            .with_help("remove one of them"),
                    );
                    continue;
                }
                tails.push(rule);
            }
            match rule {
                Rule::binding_kind => binding.kind = binding_kind(part.as_str()),
                Rule::name => binding.name = self.name(&part),
                Rule::index => binding.index = self.binders(part, depth),
                Rule::type_expression => binding.ty = Some(self.type_expression(part, depth)),
                Rule::expression => binding.value = Some(self.expression(part, depth)),
                Rule::display => {
                    binding.display = part
                        .into_inner()
                        .find(|inner| inner.as_rule() == Rule::display_unit)
                        .map(|inner| self.unit(inner, depth));
                }
                Rule::limits
                    if matches!(binding.kind, BindingKind::Param | BindingKind::Input) =>
                {
                    binding.limits = self.limits(part, depth);
                }
                Rule::limits => self.report(
                    Diagnostic::error(codes::UNEXPECTED, "limits belong to a `param` or an `input`")
                        .at(place, "of neither")
                        .with_help("`require` checks a condition on any value"),
                ),
                Rule::error_scale if binding.kind == BindingKind::State => {
                    binding.scale = self.inner_expression(part, depth);
                }
                Rule::error_scale => self.report(
                    Diagnostic::error(codes::UNEXPECTED, "only a `state` has a `scale`")
                        .at(place, "not of a `state`")
                        .with_help("the scale is the size from which errors of a state matter"),
                ),
                Rule::summary if binding.kind == BindingKind::Output => {
                    binding.summary = self.names(part).pop();
                }
                Rule::summary => self.report(
                    Diagnostic::error(codes::UNEXPECTED, "only an `output` has a `summary`")
                        .at(place, "not of an `output`")
                        .with_help("it states which number of an output the tables of results show"),
                ),
                Rule::frame if binding.kind == BindingKind::Output => {
                    binding.frame = self.inner_expression(part, depth);
                }
                Rule::interpolation if binding.kind == BindingKind::Input => {
                    binding.interpolation = self.names(part).pop();
                }
                Rule::interpolation => self.report(
                    Diagnostic::error(codes::UNEXPECTED, "only an `input` has an `interpolation`")
                        .at(place, "not of an `input`")
                        .with_help("it gives the values between two points at which a program sets an input"),
                ),
                Rule::frame
                    if matches!(binding.kind, BindingKind::Param | BindingKind::Input) =>
                    self.report(
                    Diagnostic::error(codes::UNEXPECTED, "limits need a low and a high end")
                        .at(place, "expected `in (low, high)`")
                        .with_help("write both ends in parentheses: `in (10 mm, 500 mm)`"),
                ),
                Rule::frame => self.report(
                    Diagnostic::error(codes::UNEXPECTED, "only an `output` states axes with `in`")
                        .at(place, "not of an `output`")
                        .with_help("`local(v, m)` gives the components of v along m's axes"),
                ),
                _ => {}
            }
        }
        binding
    }

    fn parameters(&mut self, pair: Pair<'t, Rule>, depth: usize) -> Vec<Parameter> {
        let mut parameters = Vec::new();
        for part in pair.into_inner() {
            if part.as_rule() != Rule::parameter {
                continue;
            }
            let docs = docs(&part);
            let mut span = self.place(&part);
            let mut name = None;
            let mut ty = None;
            let mut default = None;
            let mut limits = None;
            for inner in part.into_inner() {
                match inner.as_rule() {
                    Rule::name => {
                        span.start = self.place(&inner).start;
                        name = Some(self.name(&inner));
                    }
                    Rule::type_expression => ty = Some(self.type_expression(inner, depth)),
                    Rule::expression => default = Some(self.expression(inner, depth)),
                    Rule::limits => limits = self.limits(inner, depth),
                    _ => {}
                }
            }
            if let (Some(name), Some(ty)) = (name, ty) {
                parameters.push(Parameter {
                    docs,
                    name,
                    ty,
                    default,
                    limits,
                    span,
                });
            }
        }
        parameters
    }

    fn function(&mut self, pair: Pair<'t, Rule>, span: Span, depth: usize) -> ItemKind {
        let mut function = Function {
            name: Name {
                text: String::new(),
                span,
            },
            bound: true,
            generics: Vec::new(),
            parameters: Vec::new(),
            result: None,
            lets: Vec::new(),
            requirements: Vec::new(),
            value: None,
        };
        for part in pair.into_inner() {
            match part.as_rule() {
                Rule::name => function.name = self.name(&part),
                Rule::generics => function.generics = self.names(part),
                Rule::parameters => {
                    function.bound = false;
                    function.parameters = self.parameters(part, depth);
                }
                Rule::type_expression => function.result = Some(self.type_expression(part, depth)),
                Rule::expression => function.value = Some(self.expression(part, depth)),
                Rule::function_block => self.function_block(part, depth, &mut function),
                _ => {}
            }
        }
        ItemKind::Function(function)
    }

    fn function_block(&mut self, pair: Pair<'t, Rule>, depth: usize, function: &mut Function) {
        let mut last: Option<usize> = None;
        for part in pair.into_inner() {
            if part.as_rule() == Rule::doc {
                continue;
            }
            let (start, end) = self.range(&part);
            if let Some(last) = last
                && !self.parted(last, start)
            {
                self.two_on_a_line(last, start, end);
            }
            last = Some(end);
            match part.as_rule() {
                Rule::function_let => {
                    for binding in part.into_inner() {
                        if binding.as_rule() == Rule::binding {
                            let binding = self.binding(binding, depth + 1);
                            function.lets.push(binding);
                        }
                    }
                }
                Rule::lint => {
                    if let Some(Statement::Require {
                        advise,
                        index,
                        name,
                        condition,
                        message,
                    }) = self.statement(part, depth + 1)
                    {
                        if let Some(binder) = index.first() {
                            self.report(
                                Diagnostic::error(
                                    codes::UNEXPECTED,
                                    "a condition of a function has no index",
                                )
                                .at(binder.name.span, "not here")
                                .with_help("compare the extremes: `require min(f(i) for i in 1..3) > 0 else \"…\"`"),
                            );
                        }
                        function.requirements.push(Requirement {
                            advise,
                            name,
                            condition,
                            message,
                        });
                    }
                }
                Rule::expression => function.value = Some(self.expression(part, depth + 1)),
                _ => {}
            }
        }
    }

    fn table(&mut self, pair: Pair<'t, Rule>, span: Span, depth: usize) -> ItemKind {
        let mut table = Table {
            name: Name {
                text: String::new(),
                span,
            },
            parameters: Vec::new(),
            result: None,
            source: Expr {
                span,
                kind: ExprKind::Error,
            },
        };
        for part in pair.into_inner() {
            match part.as_rule() {
                Rule::name => table.name = self.name(&part),
                Rule::parameters => table.parameters = self.parameters(part, depth),
                Rule::type_expression => table.result = Some(self.type_expression(part, depth)),
                Rule::expression => table.source = self.expression(part, depth),
                _ => {}
            }
        }
        ItemKind::Table(table)
    }

    fn attribute(&mut self, pair: Pair<'t, Rule>, span: Span, depth: usize) -> ItemKind {
        let mut inner = pair.into_inner();
        let name = self.next_name(&mut inner);
        let value = self.next_expression(&mut inner, span, depth);
        ItemKind::Attribute(Attribute { name, value })
    }

    fn next_expression(&mut self, pairs: &mut Pairs<'t, Rule>, span: Span, depth: usize) -> Expr {
        match pairs.find(|part| part.as_rule() == Rule::expression) {
            Some(part) => self.expression(part, depth),
            None => Expr {
                span,
                kind: ExprKind::Error,
            },
        }
    }

    fn statement(&mut self, pair: Pair<'t, Rule>, depth: usize) -> Option<Statement> {
        let span = self.place(&pair);
        let rule = pair.as_rule();
        let mut inner = pair.into_inner();
        Some(match rule {
            Rule::constrain => Statement::Constrain(self.next_expression(&mut inner, span, depth)),
            Rule::branch => Statement::Branch(self.next_expression(&mut inner, span, depth)),
            Rule::start | Rule::guess | Rule::change => {
                let target = inner.find(|part| part.as_rule() == Rule::postfix)?;
                let target = self.postfix(target, depth);
                let value = self.next_expression(&mut inner, span, depth);
                match rule {
                    Rule::start => Statement::Start { target, value },
                    Rule::guess => Statement::Guess { target, value },
                    _ => Statement::Change { target, value },
                }
            }
            Rule::apply => {
                let wrench = inner.find(|part| part.as_rule() == Rule::wrench_kind)?;
                let value = self.next_expression(&mut inner, span, depth);
                let on = self.next_expression(&mut inner, span, depth);
                let against = inner
                    .find(|part| part.as_rule() == Rule::against)
                    .and_then(|part| self.inner_expression(part, depth));
                Statement::Apply {
                    torque: wrench.as_str() == "torque",
                    value,
                    on,
                    against,
                }
            }
            Rule::lint => {
                let lint = inner.find(|part| part.as_rule() == Rule::lint_kind)?;
                let indexed = inner.peek().filter(|part| part.as_rule() == Rule::index);
                let index = indexed.map_or(Vec::new(), |part| {
                    inner.next();
                    self.binders(part, depth)
                });
                let named = inner
                    .peek()
                    .filter(|part| part.as_rule() == Rule::lint_name);
                let name = named.map(|part| self.next_name(&mut part.into_inner()));
                let condition = self.next_expression(&mut inner, span, depth);
                let text = inner.find(|part| part.as_rule() == Rule::string)?;
                let (start, end) = self.inside_quotes(&text);
                self.unescaped(start, end);
                let raw = self.text.get(start..end).unwrap_or("");
                Statement::Require {
                    advise: lint.as_str() == "advise",
                    index,
                    name,
                    condition,
                    message: Name {
                        text: raw.to_string(),
                        span: self.span(start, end),
                    },
                }
            }
            Rule::resolve => Statement::Resolve(self.next_expression(&mut inner, span, depth)),
            Rule::placing => {
                let mut markers = Vec::with_capacity(2);
                let mut height = None;
                for part in inner {
                    match part.as_rule() {
                        Rule::postfix => markers.push(self.postfix(part, depth)),
                        Rule::height => height = self.inner_expression(part, depth),
                        _ => {}
                    }
                }
                let on = markers.pop()?;
                let moving = markers.pop()?;
                Statement::Place { moving, on, height }
            }
            Rule::accept => Statement::Accept(
                inner
                    .filter(|part| part.as_rule() == Rule::name)
                    .map(|part| self.name(&part))
                    .collect(),
            ),
            Rule::rate => {
                let state = inner.find(|part| part.as_rule() == Rule::name)?;
                let state = self.name(&state);
                let value = self.next_expression(&mut inner, span, depth);
                Statement::Rate { state, value }
            }
            _ => return None,
        })
    }

    /// The byte range of the text of a string, without its quotes.
    fn inside_quotes(&self, pair: &Pair<'_, Rule>) -> (usize, usize) {
        let (start, end) = self.range(pair);
        (start + 1, end.saturating_sub(1))
    }

    fn title(&mut self, pair: &Pair<'t, Rule>) -> Title {
        let (start, end) = self.inside_quotes(pair);
        Title {
            text: self.unescaped(start, end),
            span: self.place(pair),
        }
    }

    fn report_block(&mut self, pair: Pair<'t, Rule>, span: Span, depth: usize) -> ItemKind {
        let (mut word, mut name, mut title, mut block) = (span, None, None, None);
        for part in pair.into_inner() {
            match part.as_rule() {
                Rule::word_report => word = self.place(&part),
                Rule::name => name = Some(self.name(&part)),
                Rule::string => title = Some(self.title(&part)),
                Rule::block => block = Some(self.block(part, diagnose::Place::Report, depth + 1)),
                _ => {}
            }
        }
        match (name, block) {
            (Some(name), Some(block)) => ItemKind::Report(Report {
                word,
                name,
                title,
                block,
            }),
            _ => ItemKind::Error,
        }
    }

    fn entry(&mut self, pair: Pair<'t, Rule>, span: Span, depth: usize) -> ItemKind {
        let mut kind = EntryKind::Value;
        let (mut word, mut name, mut title, mut value, mut display) =
            (span, None, None, None, None);
        for part in pair.into_inner() {
            match part.as_rule() {
                Rule::entry_kind => {
                    word = self.place(&part);
                    if part.as_str() == "figure" {
                        kind = EntryKind::Figure;
                    }
                }
                Rule::name => name = Some(self.name(&part)),
                Rule::string => title = Some(self.title(&part)),
                Rule::expression => value = Some(self.expression(part, depth)),
                Rule::display => {
                    display = part
                        .into_inner()
                        .find(|inner| inner.as_rule() == Rule::display_unit)
                        .map(|inner| self.unit(inner, depth));
                }
                _ => {}
            }
        }
        match (name, value) {
            (Some(name), Some(value)) => ItemKind::Entry(Entry {
                kind,
                word,
                name,
                title,
                value,
                display,
            }),
            _ => ItemKind::Error,
        }
    }

    fn declaration(&mut self, pair: Pair<'t, Rule>, depth: usize) -> ItemKind {
        let mut inner = pair.into_inner();
        let Some(word) = inner.next() else {
            return ItemKind::Error;
        };
        let kind_span = self.place(&word);
        let name = self.next_name(&mut inner);
        let kind = match kind_of(word.as_str()) {
            Some(kind) => Some(kind),
            None => {
                let diagnostic =
                    diagnose::unknown_kind(word.as_str(), kind_span, self.place_of_items);
                let kind = diagnostic
                    .fixes
                    .first()
                    .and_then(|fix| kind_of(&fix.replacement));
                self.report(diagnostic);
                kind
            }
        };
        let Some(body) = inner.next() else {
            return ItemKind::Error;
        };
        let mut index = Vec::new();
        let mut condition = None;
        let mut parameters = Vec::new();
        let mut interface = None;
        let mut value = None;
        let mut block = None;
        let mut changes = None;
        let rule = body.as_rule();
        // a cycle is written as a use is, and has a block of its own
        let place = match kind {
            Some(kind) if rule != Rule::instance_form || kind == Kind::Cycle => {
                diagnose::Place::Definition(kind)
            }
            _ => diagnose::Place::Use,
        };
        for part in body.into_inner() {
            match part.as_rule() {
                Rule::index => index = self.binders(part, depth + 1),
                Rule::parameters => parameters = self.parameters(part, depth + 1),
                Rule::name => interface = Some(self.name(&part)),
                Rule::condition => condition = self.inner_expression(part, depth + 1),
                Rule::expression => value = Some(self.expression(part, depth + 1)),
                Rule::changes => {
                    let inside = part.into_inner().find(|p| p.as_rule() == Rule::block);
                    changes = inside.map(|p| self.block(p, diagnose::Place::Use, depth + 1));
                }
                Rule::block => block = Some(self.block(part, place, depth + 1)),
                _ => {}
            }
        }
        let form = match (rule, value, block) {
            (Rule::class_form, _, Some(block)) => Form::Class {
                parameters,
                interface,
                block,
            },
            (Rule::instance_form, Some(value), block) => Form::Instance { value, block },
            (Rule::plain_form, _, Some(block)) => {
                if let (Some(kind), Some(name)) = (kind, &interface) {
                    self.fills_nothing(kind, word.as_str(), name);
                }
                match kind {
                    // a component without arguments is a class, too
                    Some(Kind::Component) => Form::Class {
                        parameters,
                        interface,
                        block,
                    },
                    _ => Form::Plain { interface, block },
                }
            }
            _ => return ItemKind::Error,
        };
        match kind {
            Some(kind) => {
                self.no_condition(kind, word.as_str(), condition.as_ref());
                ItemKind::Declaration(Declaration {
                    kind,
                    kind_span,
                    name,
                    index,
                    condition,
                    changes,
                    form,
                })
            }
            None => ItemKind::Error,
        }
    }

    /// Reports `if` after a name that is no part of a model.
    fn no_condition(&mut self, kind: Kind, word: &str, condition: Option<&Expr>) {
        let is_part = matches!(
            kind,
            Kind::Body
                | Kind::Flexible
                | Kind::Marker
                | Kind::Joint
                | Kind::Force
                | Kind::Journal
                | Kind::Drive
                | Kind::Part
        );
        if let Some(condition) = condition.filter(|_| !is_part) {
            let place = condition.span;
            self.report(
                Diagnostic::error(
                    codes::UNEXPECTED,
                    format!("`{word}` cannot have a condition"),
                )
                .at(place, "a condition")
                .with_help(
                    "bodies, markers, joints, forces, journals, drives and parts may have one",
                ),
            );
        }
    }

    /// Reports an interface after a declaration that cannot fill one.
    fn fills_nothing(&mut self, kind: Kind, word: &str, interface: &Name) {
        if matches!(kind, Kind::Interface | Kind::Record) {
            return;
        }
        self.report(
            Diagnostic::error(
                codes::UNEXPECTED,
                format!("a {word} without parameters fills no interface"),
            )
            .at(interface.span, "not here")
            .with_help("classes, records and interfaces may name an interface after a colon; a class has a list of parameters, which may be empty: `force Push() : Law { … }`"),
        );
    }

    /// Of a `block`.
    fn block(&mut self, pair: Pair<'t, Rule>, place: diagnose::Place, depth: usize) -> Block {
        let span = self.place(&pair);
        let outer = std::mem::replace(&mut self.place_of_items, place);
        let items = self.items(pair.into_inner(), depth);
        self.place_of_items = outer;
        Block { items, span }
    }
}
