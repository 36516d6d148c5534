//! Analyses of the root module.

use super::value::{ScopeId, Value};
use super::{Elaborator, Eval, body::index_text, finish::Structural, location};
use crate::codes;
use crate::program::{DefinitionId, Program};
use eng_grammar::ast::{self, BindingKind, ExprKind, Form, ItemKind, Kind};
use eng_grammar::{Diagnostic, Diagnostics, SourceMap, Span};
use eng_system::Dimension;
use eng_system::host::Host;
use eng_system::system::{Analysis, AnalysisKind, Extent, Origin, StepControl, Transient};

/// Samples an analysis may take: all are kept in memory until it ends.
const MOST_SAMPLES: f64 = 1e7;

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
    program: &Program,
    sources: &mut SourceMap,
    host: &dyn Host,
    diagnostics: &mut Diagnostics,
) -> Vec<AnalysisPlan> {
    let mut plans = Vec::new();
    let root = program.root();
    let Some(module) = program.modules.get(root as usize) else {
        return plans;
    };
    let mut elaborator = Elaborator::new(program, sources, host, diagnostics);
    let scope = elaborator.module_scopes[root as usize];
    for item in &module.file.items {
        if let ItemKind::Declaration(d) = &item.kind
            && d.kind == Kind::Analysis
            && let Form::Instance { value, .. } = &d.form
        {
            // a message was given; the others still are planned
            let _ = elaborator.for_each(&d.index, scope, &mut |e, inner, position| {
                let name = format!("{}{}", d.name.text, index_text(position));
                plans.push(e.plan(name, value, d.name.span, inner)?);
                Ok(())
            });
        }
    }
    plans
}

impl<'a> Elaborator<'a, '_> {
    fn plan(
        &mut self,
        name: String,
        value: &'a ast::Expr,
        span: Span,
        scope: ScopeId,
    ) -> Eval<AnalysisPlan> {
        let ExprKind::Call { callee, arguments } = &value.kind else {
            return Err(self.not_an_analysis(value.span));
        };
        let kind = match &callee.kind {
            ExprKind::Name(n) if n == "transient" || n == "assemble" => n.as_str(),
            _ => return Err(self.not_an_analysis(callee.span)),
        };
        let Some(first) = arguments.first() else {
            return Err(self.not_an_analysis(value.span));
        };
        let (model, constants, set) = self.model_call(&first.value, scope)?;
        let number = |e: &mut Self, wanted: &str| -> Eval<Option<(f64, Dimension, Span)>> {
            let Some(argument) = arguments
                .iter()
                .find(|a| a.name.as_ref().is_some_and(|n| n.text == wanted))
            else {
                return Ok(None);
            };
            let v = e.evaluate(&argument.value, scope)?;
            let s = e.as_scalar(v, argument.value.span)?;
            let x = e.structural(s, argument.value.span)?;
            Ok(Some((x, s.dimension, argument.value.span)))
        };
        let duration = number(self, "duration")?;
        let sample = number(self, "sample")?;
        let step = number(self, "step")?;
        let tolerance = number(self, "tolerance")?;
        let rho = number(self, "rho")?;
        let kind = if kind == "assemble" {
            AnalysisKind::Assemble
        } else {
            let Some(duration) = duration else {
                return Err(self.internal(value.span, "no duration"));
            };
            let duration = self.extent("duration", duration)?;
            let sample = match sample {
                Some(s) => {
                    let extent = self.extent("sample", s)?;
                    let many = match (duration, extent) {
                        (Extent::Time(whole), Extent::Time(part))
                        | (Extent::Angle(whole), Extent::Angle(part)) => {
                            whole / part > MOST_SAMPLES
                        }
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
                None => return Err(self.internal(value.span, "no distance of samples")),
            };
            let step = match (step, tolerance) {
                (Some((h, _, s)), None) => {
                    let positive = h > 0.0 && h.is_finite();
                    StepControl::Fixed(self.fitting("step", h, positive, "positive", s)?)
                }
                (None, Some((t, _, s))) => {
                    let due = "positive and at most 1e6; 1 is the default";
                    let fits = t > 0.0 && t <= 1e6;
                    StepControl::Tolerance(self.fitting("tolerance", t, fits, due, s)?)
                }
                (None, None) => StepControl::Tolerance(1.0),
                (Some((_, _, s)), Some(_)) => {
                    return Err(self.internal(s, "a fixed step and a tolerance"));
                }
            };
            let rho_infinity = match rho {
                Some((r, _, s)) => {
                    let due = "from 0 to below 1; 0.8 is the default";
                    self.fitting("rho", r, (0.0..1.0).contains(&r), due, s)?
                }
                None => 0.8,
            };
            AnalysisKind::Transient(Transient {
                duration,
                sample,
                step,
                rho_infinity,
            })
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
                set,
                kind,
            },
            model,
            constants,
        })
    }

    fn not_an_analysis(&mut self, span: Span) -> super::Reported {
        self.internal(
            span,
            "neither `transient(Model(…), …)` nor `assemble(Model(…))`",
        )
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
            Err(self.internal(span, "neither a time nor an angle"))
        }
    }

    /// `Model(name: value)`: constants are structural, parameters are set.
    #[allow(clippy::type_complexity)]
    fn model_call(
        &mut self,
        expr: &'a ast::Expr,
        scope: ScopeId,
    ) -> Eval<(DefinitionId, Vec<(String, Structural)>, Vec<(String, f64)>)> {
        let ExprKind::Call { callee, arguments } = &expr.kind else {
            return Err(self.internal(expr.span, "the first argument is no model"));
        };
        let model = match self.evaluate(callee, scope)? {
            Value::Definition(id) => id,
            other => return Err(self.unfit(callee.span, "a model", &other)),
        };
        let items = match self.program.item(model).map(|i| &i.kind) {
            Some(ItemKind::Declaration(ast::Declaration {
                kind: Kind::Model,
                form: Form::Plain { block },
                ..
            })) => &block.items,
            _ => {
                return Err(self.internal(callee.span, "this is no model"));
            }
        };
        let mut constants = Vec::new();
        let mut set = Vec::new();
        for argument in arguments {
            let Some(name) = &argument.name else {
                return Err(
                    self.internal(argument.value.span, "an argument of a model has no name")
                );
            };
            let binding = items.iter().find_map(|i| match &i.kind {
                ItemKind::Binding(b)
                    if b.name.text == name.text
                        && matches!(b.kind, BindingKind::Const | BindingKind::Param) =>
                {
                    Some(b)
                }
                _ => None,
            });
            let Some(binding) = binding else {
                return Err(self.internal(name.span, "no `param` or `const` of the model"));
            };
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
        match value {
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
        Ok(match value {
            Value::Int(i) => Structural::Int(i),
            Value::Bool(b) => Structural::Bool(b),
            Value::Text(t) => Structural::Text(t),
            Value::ModeSet(parts) => Structural::ModeSet(parts.to_vec()),
            Value::Scalar(s) => Structural::Number(self.structural(s, span)?, s.dimension),
            Value::List(items) => Structural::List(
                items
                    .into_iter()
                    .map(|v| self.structural_of(v, span))
                    .collect::<Eval<Vec<_>>>()?,
            ),
            other => return Err(self.unfit(span, "a structural value", &other)),
        })
    }
}
