//! Analyses of the root module.

use super::value::{ScopeId, Value};
use super::{Elaborator, Eval, body::index_text, finish::Structural, location};
use crate::codes;
use crate::program::DefinitionId;
use crate::typed::{TypedProgram, settable};
use eng_grammar::ast::{self, BindingKind, ExprKind, Form, ItemKind, Kind};
use eng_grammar::{Diagnostic, Diagnostics, SourceMap, Span};
use eng_system::host::Host;
use eng_system::system::{
    Analysis, AnalysisKind, Extent, Linear, Origin, Periodic, PointValue, Start, StepControl,
    Transient,
};
use eng_system::{Dimension, DisplayUnit};

/// Samples an analysis may take: all are kept in memory until it ends.
const MOST_SAMPLES: f64 = 1e7;

/// Samples of a duration without `sample`.
const PLAIN_SAMPLES: f64 = 1000.0;
/// Distance of samples over the cycle angle (rad) without `sample`: half a degree.
const PLAIN_ANGLE: f64 = std::f64::consts::PI / 360.0;
/// `change` and `cycles` of `periodic`, where they are not stated, and most cycles.
const PLAIN_CHANGE: f64 = 1e-3;
const PLAIN_CYCLES: u32 = 40;
const MOST_CYCLES: f64 = 1e5;

/// An analysis and the model that it needs.
#[derive(Clone, Debug, PartialEq)]
pub struct AnalysisPlan {
    /// What is done.
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
    for item in &module.file.items {
        if let ItemKind::Declaration(d) = &item.kind
            && d.kind == Kind::Analysis
            && let Form::Instance { value, .. } = &d.form
        {
            // a message was given; the others still are planned
            let _ = elaborator.for_each(&d.index, scope, &mut |e, inner, position| {
                let name = format!("{}{}", d.name.text, index_text(position));
                let mut plan = e.plan(name, value, d.name.span, inner)?;
                for (binder, place) in d.index.iter().zip(position) {
                    let point = e.point(binder, *place, inner)?;
                    plan.analysis.point.push(point);
                }
                plans.push(plan);
                Ok(())
            });
        }
    }
    elaborator.tell_advised();
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

    fn plan(
        &mut self,
        name: String,
        value: &'a ast::Expr,
        span: Span,
        scope: ScopeId,
    ) -> Eval<AnalysisPlan> {
        let (callee, arguments) = self.called(value)?;
        let kind = match &callee.kind {
            ExprKind::Name(n)
                if ["transient", "periodic", "linear", "assemble"].contains(&n.as_str()) =>
            {
                n.as_str()
            }
            _ => return self.checked(None, callee.span, "no kind of analysis"),
        };
        let first = self.checked(arguments.first(), value.span, "an analysis of no model")?;
        let (model, constants, set) = self.model_call(&first.value, scope)?;
        let kind = match kind {
            "assemble" => AnalysisKind::Assemble,
            "periodic" => AnalysisKind::Periodic(self.periodic(arguments, scope)?),
            "linear" => AnalysisKind::Linear(self.linear(arguments, scope)?),
            _ => AnalysisKind::Transient(self.transient(arguments, value.span, scope)?),
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

    /// An argument of an analysis: its value (SI), dimension and place.
    fn option(
        &mut self,
        arguments: &'a [ast::Argument],
        wanted: &str,
        scope: ScopeId,
    ) -> Eval<Option<(f64, Dimension, Span)>> {
        let Some(argument) = named(arguments, wanted) else {
            return Ok(None);
        };
        let v = self.evaluate(&argument.value, scope)?;
        let s = self.as_scalar(v, argument.value.span)?;
        let x = self.structural(s, argument.value.span)?;
        let dimension = self.dimension_at(argument.value.span, scope)?;
        Ok(Some((x, dimension, argument.value.span)))
    }

    /// Whether an argument of an analysis is true; `false` without it.
    fn switch(
        &mut self,
        arguments: &'a [ast::Argument],
        wanted: &str,
        scope: ScopeId,
    ) -> Eval<bool> {
        let Some(argument) = named(arguments, wanted) else {
            return Ok(false);
        };
        let stated = self.evaluate(&argument.value, scope)?;
        self.read(stated, argument.value.span)
    }

    fn transient(
        &mut self,
        arguments: &'a [ast::Argument],
        span: Span,
        scope: ScopeId,
    ) -> Eval<Transient> {
        let duration = self.option(arguments, "duration", scope)?;
        let sample = self.option(arguments, "sample", scope)?;
        let duration = self.checked(duration, span, "no duration")?;
        let duration = self.extent("duration", duration)?;
        let sample = match sample {
            Some(s) => {
                let extent = self.extent("sample", s)?;
                let many = match (duration, extent) {
                    (Extent::Time(whole), Extent::Time(part))
                    | (Extent::Angle(whole), Extent::Angle(part)) => whole / part > MOST_SAMPLES,
                    _ => false,
                };
                if many {
                    return Err(self.report(
                        Diagnostic::error(
                            codes::ANALYSIS_VALUE,
                            "`sample` must be at least a ten-millionth of `duration`",
                        )
                        .at(s.2, "more samples than memory holds")
                        .with_help("sample more coarsely, or run for a shorter time"),
                    ));
                }
                extent
            }
            None => match duration {
                Extent::Time(whole) => Extent::Time(whole / PLAIN_SAMPLES),
                Extent::Angle(_) => Extent::Angle(PLAIN_ANGLE),
            },
        };
        let (step, rho_infinity) = self.steps(arguments, scope)?;
        Ok(Transient {
            duration,
            sample,
            step,
            rho_infinity,
            start: self.start(arguments, Start::Automatic)?,
        })
    }

    /// The state of the start is a balance, unless something else is stated; a transient to a later one begins as others do.
    fn linear(&mut self, arguments: &'a [ast::Argument], scope: ScopeId) -> Eval<Linear> {
        let after = match self.option(arguments, "after", scope)? {
            Some(after) => Some(self.extent("after", after)?),
            None => None,
        };
        let number = match self.option(arguments, "number", scope)? {
            Some((x, _, s)) => {
                let due = "at least 1 and at most 100000; without it all modes are given";
                Some(self.fitting("number", x, (1.0..=1e5).contains(&x), due, s)? as u32)
            }
            None => None,
        };
        let up_to = match self.option(arguments, "up_to", scope)? {
            Some((x, _, s)) => {
                let fits = x > 0.0 && x.is_finite();
                Some(std::f64::consts::TAU * self.fitting("up_to", x, fits, "positive", s)?)
            }
            None => None,
        };
        let over = match self.option(arguments, "over", scope)? {
            Some(over) => Some(self.extent("over", over)?),
            None => None,
        };
        let frozen = self.switch(arguments, "frozen", scope)?;
        let (step, rho_infinity) = self.steps(arguments, scope)?;
        let unstated = match after {
            Some(_) => Start::Automatic,
            None => Start::QuasiStatic,
        };
        Ok(Linear {
            after,
            step,
            rho_infinity,
            start: self.start(arguments, unstated)?,
            number,
            up_to,
            over,
            frozen,
        })
    }

    fn periodic(&mut self, arguments: &'a [ast::Argument], scope: ScopeId) -> Eval<Periodic> {
        let sample = match self.option(arguments, "sample", scope)? {
            Some((x, _, s)) => {
                let fits = x > 0.0 && x.is_finite();
                self.fitting("sample", x, fits, "positive", s)?
            }
            None => PLAIN_ANGLE,
        };
        let change = match self.option(arguments, "change", scope)? {
            Some((x, _, s)) => {
                let due = "positive and below 1; 0.1 % is the default";
                self.fitting("change", x, x > 0.0 && x < 1.0, due, s)?
            }
            None => PLAIN_CHANGE,
        };
        let cycles = match self.option(arguments, "cycles", scope)? {
            Some((x, _, s)) if x < 2.0 => {
                return Err(self.report(
                    Diagnostic::error(codes::ANALYSIS_VALUE, "`cycles` must be at least 2")
                        .at(s, "too few to see one repeat")
                        .with_help(
                            "it is the number of cycles after which to give up; 40 is the default",
                        ),
                ));
            }
            Some((x, _, s)) => {
                let due = "at most 100000; 40 is the default";
                self.fitting("cycles", x, x <= MOST_CYCLES, due, s)? as u32
            }
            None => PLAIN_CYCLES,
        };
        let (step, rho_infinity) = self.steps(arguments, scope)?;
        Ok(Periodic {
            sample,
            step,
            rho_infinity,
            start: self.start(arguments, Start::Automatic)?,
            change,
            cycles,
        })
    }

    /// `step`, `tolerance` and `rho`.
    fn steps(
        &mut self,
        arguments: &'a [ast::Argument],
        scope: ScopeId,
    ) -> Eval<(StepControl, f64)> {
        let step = self.option(arguments, "step", scope)?;
        let tolerance = self.option(arguments, "tolerance", scope)?;
        let step = match step {
            Some((h, _, s)) => {
                let positive = h > 0.0 && h.is_finite();
                Some(self.fitting("step", h, positive, "positive", s)?)
            }
            None => None,
        };
        let tolerance = match tolerance {
            Some((t, _, s)) => {
                let due = "positive and at most 1e6; 1 is the default";
                let fits = t > 0.0 && t <= 1e6;
                Some(self.fitting("tolerance", t, fits, due, s)?)
            }
            None => None,
        };
        let step = match (step, tolerance) {
            (Some(step), Some(tolerance)) => StepControl::FixedTo { step, tolerance },
            (Some(step), None) => StepControl::Fixed(step),
            (None, tolerance) => StepControl::Tolerance(tolerance.unwrap_or(1.0)),
        };
        let rho_infinity = match self.option(arguments, "rho", scope)? {
            Some((r, _, s)) => {
                let due = "from 0 to below 1; 0.8 is the default";
                self.fitting("rho", r, (0.0..1.0).contains(&r), due, s)?
            }
            None => 0.8,
        };
        Ok((step, rho_infinity))
    }

    fn start(&mut self, arguments: &'a [ast::Argument], unstated: Start) -> Eval<Start> {
        let Some(argument) = named(arguments, "start") else {
            return Ok(unstated);
        };
        match &argument.value.kind {
            ExprKind::Name(n) if n == "quasi_static" => Ok(Start::QuasiStatic),
            ExprKind::Name(n) if n == "assembled" => Ok(Start::Assembled),
            _ => self.checked(None, argument.value.span, "no start"),
        }
    }

    /// A number that `fits`, else a message that says what would.
    fn fitting(&mut self, name: &str, value: f64, fits: bool, due: &str, span: Span) -> Eval<f64> {
        if fits {
            return Ok(value);
        }
        let found = if value == 0.0 {
            "zero"
        } else if value < 0.0 {
            "negative"
        } else {
            "too large"
        };
        Err(self.report(
            Diagnostic::error(codes::ANALYSIS_VALUE, format!("`{name}` must be {due}"))
                .at(span, format!("this is {found}")),
        ))
    }

    fn extent(
        &mut self,
        name: &str,
        (value, dimension, span): (f64, Dimension, Span),
    ) -> Eval<Extent> {
        let positive = value > 0.0 && value.is_finite();
        self.fitting(name, value, positive, "positive", span)?;
        if dimension == Dimension::TIME {
            Ok(Extent::Time(value))
        } else if dimension == Dimension::ANGLE {
            Ok(Extent::Angle(value))
        } else {
            self.checked(None, span, "neither a time nor an angle")
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
            if binding.kind == BindingKind::Const {
                constants.push((
                    name.text.clone(),
                    self.structural_of(value, argument.value.span)?,
                ));
            } else {
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
            Value::ModeSet(parts) => Structural::ModeSet(parts.to_vec()),
            Value::Scalar(s) => Structural::Number(self.structural(s, span)?),
            Value::List(items) => Structural::List(
                items
                    .into_iter()
                    .map(|v| self.structural_of(v, span))
                    .collect::<Eval<Vec<_>>>()?,
            ),
            Value::Definition(id) => Structural::Class(id),
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
                    .with_help("numbers, texts, truth values, mode sets, classes, records, and lists of these can be given; define it in the model or beside it"),
                ));
            }
        })
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
