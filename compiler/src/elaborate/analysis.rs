//! Analyses of the root module.

use super::value::{ScopeId, Value};
use super::{Elaborator, Eval, Reported, body::index_text, finish::Structural, location};
use crate::codes;
use crate::program::DefinitionId;
use crate::typed::kind_words::kind_word;
use crate::typed::{TypedProgram, settable};
use eng_grammar::ast::{self, BindingKind, ExprKind, Form, ItemKind, Kind};
use eng_grammar::{Diagnostic, Diagnostics, SourceMap, Span};
use eng_system::analysis::{self, Argument, Given, Method, Start, Takes, Unplanned};
use eng_system::host::Host;
use eng_system::system::{Analysis, AnalysisKind, Extent, Origin, PointValue};
use eng_system::{Dimension, DisplayUnit};

/// An analysis and the model that it needs.
#[derive(Clone, Debug, PartialEq)]
pub struct AnalysisPlan {
    /// The analysis.
    pub analysis: Analysis,
    /// The model's definition.
    pub model: DefinitionId,
    /// Its structural arguments.
    pub constants: Vec<(String, Structural)>,
}

/// All analyses of the root module, in their order.
pub fn analyses(
    typed: &TypedProgram,
    sources: &mut SourceMap,
    host: &dyn Host,
    diagnostics: &mut Diagnostics,
) -> Vec<AnalysisPlan> {
    let program = &typed.program;
    let mut plans = Vec::new();
    let root = program.root();
    let Some(module) = program.modules.get(root as usize) else {
        return plans;
    };
    let mut elaborator = Elaborator::new(typed, sources, host, diagnostics);
    let scope = elaborator.module_scopes[root as usize];
    for (index, item) in module.file.items.iter().enumerate() {
        if let ItemKind::Declaration(d) = &item.kind
            && d.kind == Kind::Analysis
            && let Form::Instance { value, .. } = &d.form
        {
            // a message was given; the others still are planned
            let _ = elaborator.for_each(&d.index, scope, &mut |e, inner, position| {
                let name = format!("{}{}", d.name.text, index_text(position));
                let mut plan = e.plan(name, value, d.name.span, inner)?;
                let stop = e.stop_of(index as u32, value, &d.index, inner)?;
                plan.constants.extend(stop);
                for (binder, place) in d.index.iter().zip(position) {
                    let point = e.point(binder, *place, inner)?;
                    plan.analysis.point.push(point);
                }
                plans.push(plan);
                Ok(())
            });
        }
    }
    elaborator.report_advised();
    plans
}

/// The units written in an expression, in their order.
fn units_of<'e>(expr: &'e ast::Expr, found: &mut Vec<&'e ast::UnitExpr>) {
    match &expr.kind {
        ExprKind::Number { unit, .. } => found.extend(unit),
        ExprKind::List { items, unit } => {
            found.extend(unit);
            items.iter().for_each(|item| units_of(item, found));
        }
        ExprKind::Paren { inner, unit } => {
            found.extend(unit);
            units_of(inner, found);
        }
        ExprKind::Unary { operand, .. } => units_of(operand, found),
        ExprKind::Binary { left, right, .. } => {
            units_of(left, found);
            units_of(right, found);
        }
        ExprKind::Range { from, to, by } => {
            units_of(from, found);
            units_of(to, found);
            if let Some(by) = by {
                units_of(by, found);
            }
        }
        _ => {}
    }
}

fn named<'a>(arguments: &'a [ast::Argument], wanted: &str) -> Option<&'a ast::Argument> {
    arguments
        .iter()
        .find(|a| a.name.as_ref().is_some_and(|n| n.text == wanted))
}

impl<'a> Elaborator<'a, '_> {
    /// The value of a binder, shown in the first unit that its range states for this dimension.
    fn point(&mut self, binder: &'a ast::Binder, place: usize, scope: ScopeId) -> Eval<PointValue> {
        let value = self.lookup(&binder.name.text, scope, binder.name.span)?;
        let value = match value {
            Value::Scalar(s) => self.structural(s, binder.range.span)?,
            Value::Int(i) => i as f64,
            _ => place as f64,
        };
        let dimension = self.dimension_at(binder.range.span, scope)?;
        let mut units = Vec::new();
        units_of(&binder.range, &mut units);
        let mut display = self.natural_unit(dimension);
        for unit in units {
            let unit = self.unit(unit)?;
            if unit.dimension == dimension {
                display = DisplayUnit::from(unit);
                break;
            }
        }
        Ok(PointValue {
            name: binder.name.text.clone(),
            value,
            dimension,
            display,
        })
    }

    /// The condition that ends the runs of an analysis, for the elaboration of its model.
    fn stop_of(
        &mut self,
        item: u32,
        value: &'a ast::Expr,
        index: &'a [ast::Binder],
        scope: ScopeId,
    ) -> Eval<Option<(String, Structural)>> {
        let (_, arguments) = self.called(value)?;
        if named(arguments, analysis::STOP).is_none() {
            return Ok(None);
        }
        let mut indices = Vec::with_capacity(index.len());
        for ast::Binder { name, .. } in index {
            let value = self.lookup(&name.text, scope, name.span)?;
            indices.push((name.text.clone(), self.structural_of(value, name.span)?));
        }
        let stop = Structural::Stop { item, indices };
        Ok(Some((analysis::STOP.to_owned(), stop)))
    }

    /// The condition of an analysis of the root module that ends its runs.
    pub fn stop_condition(&self, item: u32) -> Option<&'a ast::Expr> {
        let module = self.program.modules.get(self.program.root() as usize)?;
        match &module.file.items.get(item as usize)?.kind {
            ItemKind::Declaration(declaration) => match &declaration.form {
                Form::Instance { value, .. } => match &value.kind {
                    ExprKind::Call { arguments, .. } => {
                        named(arguments, analysis::STOP).map(|argument| &argument.value)
                    }
                    _ => None,
                },
                _ => None,
            },
            _ => None,
        }
    }

    fn plan(
        &mut self,
        name: String,
        value: &'a ast::Expr,
        span: Span,
        scope: ScopeId,
    ) -> Eval<AnalysisPlan> {
        let (callee, arguments) = self.called(value)?;
        let kind = match &callee.kind {
            ExprKind::Name(name) => analysis::kind(name),
            _ => None,
        };
        let kind = self.checked(kind, callee.span, "no kind of analysis")?;
        let first = self.checked(arguments.first(), value.span, "an analysis of no model")?;
        let (model, constants, set) = self.model_call(&first.value, scope)?;
        let given = self.given(kind.arguments, arguments, scope)?;
        let kind = match (kind.plan)(&given) {
            Ok(kind) => kind,
            Err(reason) => self.unplanned(reason, arguments, value.span)?,
        };
        let model_name = match self.program.item(model).map(|i| &i.kind) {
            Some(ItemKind::Declaration(d)) => d.name.text.clone(),
            _ => String::new(),
        };
        Ok(AnalysisPlan {
            analysis: Analysis {
                origin: Origin {
                    path: name,
                    used_at: Some(location(span)),
                    defined_at: None,
                },
                model: model_name,
                point: Vec::new(),
                set,
                arguments: arguments
                    .iter()
                    .filter_map(|a| Some((a.name.as_ref()?.text.clone(), location(a.value.span))))
                    .collect(),
                kind,
            },
            model,
            constants,
        })
    }

    /// The arguments of an analysis, evaluated and within their limits.
    fn given(
        &mut self,
        rows: &[Argument],
        arguments: &'a [ast::Argument],
        scope: ScopeId,
    ) -> Eval<Given> {
        let mut given = Given::default();
        for row in rows {
            if let Some(argument) = named(arguments, row.name) {
                let value = self.argument(row, &argument.value, scope)?;
                given.state(row.name, value);
            }
        }
        Ok(given)
    }

    /// The meaning of a word, from the list of words with their meanings.
    fn word_of<T: Copy>(
        &mut self,
        named: &[(&str, T)],
        expr: &ast::Expr,
        missing: &str,
    ) -> Eval<T> {
        let found = match &expr.kind {
            ExprKind::Name(word) => named.iter().find(|(name, _)| name == word),
            _ => None,
        };
        self.checked(found.map(|(_, meaning)| *meaning), expr.span, missing)
    }

    fn argument(
        &mut self,
        row: &Argument,
        expr: &'a ast::Expr,
        scope: ScopeId,
    ) -> Eval<analysis::Value> {
        match row.takes {
            Takes::Start => {
                let start = self.word_of(&Start::NAMED, expr, "no start")?;
                Ok(analysis::Value::Start(start))
            }
            Takes::Method => {
                let method = self.word_of(&Method::NAMED, expr, "no method")?;
                Ok(analysis::Value::Method(method))
            }
            Takes::Condition => Ok(analysis::Value::Condition(
                self.sources.text(expr.span).to_owned(),
            )),
            Takes::Names(_) => {
                let mut names = Vec::new();
                self.names_of_channels(expr, scope, &mut names)?;
                Ok(analysis::Value::Names(names))
            }
            Takes::Switch => {
                let stated = self.evaluate(expr, scope)?;
                Ok(analysis::Value::Switch(self.read(stated, expr.span)?))
            }
            Takes::Extent(_) => {
                let value = self.limited(row, expr, scope)?;
                let dimension = self.dimension_at(expr.span, scope)?;
                if dimension == Dimension::TIME {
                    Ok(analysis::Value::Extent(Extent::Time(value)))
                } else if dimension == Dimension::ANGLE {
                    Ok(analysis::Value::Extent(Extent::Angle(value)))
                } else {
                    self.checked(None, expr.span, "neither a time nor an angle")
                }
            }
            Takes::Number | Takes::Count | Takes::Time | Takes::Angle | Takes::Frequency => {
                Ok(analysis::Value::Number(self.limited(row, expr, scope)?))
            }
        }
    }

    /// A number (SI) within the limits of its argument.
    fn limited(&mut self, row: &Argument, expr: &'a ast::Expr, scope: ScopeId) -> Eval<f64> {
        let value = self.evaluate(expr, scope)?;
        let value = self.as_scalar(value, expr.span)?;
        let value = self.structural(value, expr.span)?;
        let Some(limit) = row.limits.iter().find(|limit| !(limit.fits)(value)) else {
            return Ok(value);
        };
        let found = if value == 0.0 {
            "this is zero"
        } else if value < 0.0 {
            "this is negative"
        } else {
            "this is too large"
        };
        let label = limit.label_and_help.map_or(found, |(label, _)| label);
        let title = format!("`{}` must be {}", row.name, limit.due);
        let mut message = Diagnostic::error(codes::ANALYSIS_VALUE, title).at(expr.span, label);
        if let Some((_, help)) = limit.label_and_help {
            message = message.with_help(help);
        }
        Err(self.report(message))
    }

    /// Arguments that do not fit each other.
    fn unplanned(
        &mut self,
        reason: Unplanned,
        arguments: &'a [ast::Argument],
        span: Span,
    ) -> Eval<AnalysisKind> {
        match reason {
            Unplanned::Refused {
                argument,
                title,
                label,
                help,
            } => {
                let place = named(arguments, argument).map_or(span, |a| a.value.span);
                Err(self.report(
                    Diagnostic::error(codes::ANALYSIS_VALUE, title)
                        .at(place, label)
                        .with_help(help),
                ))
            }
            Unplanned::Absent(name) => self.checked(None, span, name),
        }
    }

    /// `Model(name: value)`: constants are structural, parameters are set.
    #[allow(clippy::type_complexity)]
    fn model_call(
        &mut self,
        expr: &'a ast::Expr,
        scope: ScopeId,
    ) -> Eval<(DefinitionId, Vec<(String, Structural)>, Vec<(String, f64)>)> {
        let (callee, arguments) = self.called(expr)?;
        let model = self.evaluate(callee, scope)?;
        let model = self.read(model, callee.span)?;
        let declaration = match self.program.item(model).map(|item| &item.kind) {
            Some(ItemKind::Declaration(declaration)) => Some(declaration),
            _ => None,
        };
        let declaration = self.checked(declaration, callee.span, "this is no model")?;
        let bindings: Vec<&ast::Binding> = settable(declaration).collect();
        let places = self.call_at(expr.span)?;
        let mut constants = Vec::new();
        let mut set = Vec::new();
        for (argument, place) in arguments.iter().zip(places.iter()) {
            let binding = bindings.get(*place as usize);
            let binding = self.checked(binding, argument.value.span, "no such value")?;
            let name = &binding.name;
            let value = self.evaluate(&argument.value, scope)?;
            if matches!(
                value,
                Value::Closure(_) | Value::Table(_) | Value::Partial(_)
            ) && binding.kind == BindingKind::Input
            {
                let signal = self.signal(&argument.value, &value, scope)?;
                constants.push((name.text.clone(), signal));
            } else if binding.kind == BindingKind::Const {
                constants.push((
                    name.text.clone(),
                    self.structural_of(value, argument.value.span)?,
                ));
            } else {
                let value = self.declared(value, binding.ty.as_ref())?;
                self.parameter_values(value, &name.text, argument.value.span, &mut set)?;
            }
        }
        Ok((model, constants, set))
    }

    fn parameter_values(
        &mut self,
        value: Value<'a>,
        path: &str,
        span: Span,
        set: &mut Vec<(String, f64)>,
    ) -> Eval<()> {
        match Self::without_axes(value) {
            Value::List(items) => {
                for (i, item) in items.into_iter().enumerate() {
                    self.parameter_values(item, &format!("{path}[{}]", i + 1), span, set)?;
                }
            }
            Value::Vector(parts) => {
                for (i, part) in parts.into_iter().enumerate() {
                    set.push((format!("{path}[{}]", i + 1), self.structural(part, span)?));
                }
            }
            Value::Record(id, scope) => {
                for name in self.fields_of(id) {
                    let value = self.entry(scope, &name, span)?;
                    self.parameter_values(value, &format!("{path}.{name}"), span, set)?;
                }
            }
            other => {
                let s = self.as_scalar(other, span)?;
                set.push((path.to_owned(), self.structural(s, span)?));
            }
        }
        Ok(())
    }

    fn structural_of(&mut self, value: Value<'a>, span: Span) -> Eval<Structural> {
        Ok(match Self::without_axes(value) {
            Value::Int(i) => Structural::Int(i),
            Value::Bool(b) => Structural::Bool(b),
            Value::Text(t) => Structural::Text(t),
            Value::Choice(id, word) => Structural::Choice(id, word),
            Value::ModeSet(parts) => Structural::ModeSet(parts.to_vec()),
            Value::Scalar(s) => Structural::Number(self.structural(s, span)?),
            Value::List(items) => Structural::List(
                items
                    .into_iter()
                    .map(|v| self.structural_of(v, span))
                    .collect::<Eval<Vec<_>>>()?,
            ),
            Value::Definition(id) => Structural::Class(id),
            Value::Bound(bound) => match bound.named {
                Some(id) => Structural::Class(id),
                None => return Err(self.class_without_a_name(bound.class, span)),
            },
            Value::Record(id, scope) => {
                let mut fields = Vec::new();
                for name in self.fields_of(id) {
                    let value = self.entry(scope, &name, span)?;
                    fields.push((name, self.structural_of(value, span)?));
                }
                Structural::Record(id, fields)
            }
            other => {
                let found = other.kind();
                return Err(self.report(
                    Diagnostic::error(
                        codes::NOT_HANDED_ON,
                        format!("an analysis cannot give {found} to a model"),
                    )
                    .at(span, format!("this is {found}"))
                    .with_help("numbers, texts, truth values, words of choices, mode sets, classes, records, and lists of these can be given; define it in the model or beside it"),
                ));
            }
        })
    }

    fn class_without_a_name(&mut self, class: DefinitionId, span: Span) -> Reported {
        let mut message = Diagnostic::error(
            codes::NOT_HANDED_ON,
            "an analysis passes a class to a model by its name",
        )
        .at(span, "a class with arguments, without a name");
        if let Some(class) = self.program.declaration(class) {
            let (kind, name) = (kind_word(class.kind), &class.name.text);
            message = message.with_help(format!(
                "define it at the top of the file: `{kind} Ours = {name}(…)`"
            ));
        }
        self.report(message)
    }

    /// Names of the values of a record.
    fn fields_of(&self, id: DefinitionId) -> Vec<String> {
        let declaration = match self.program.item(id).map(|item| &item.kind) {
            Some(ItemKind::Declaration(declaration)) => Some(declaration),
            _ => None,
        };
        let fields = declaration.into_iter().flat_map(settable);
        fields.map(|field| field.name.text.clone()).collect()
    }
}
