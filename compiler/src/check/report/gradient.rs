//! Derivatives by parameters: `gradient(moft, oil_temperature)`.

use super::Reporter;
use super::channel::{Step, steps};
use super::picture::last_name;
use super::value::Typed;
use crate::check::signal::Shape;
use crate::check::types::{Quantity, Type};
use crate::codes;
use crate::elaborate::AnalysisPlan;
use crate::resolve::suggest::{listing, nearest};
use eng_grammar::ast::{Expr, IndexArgument, UnitExpr};
use eng_grammar::{Diagnostic, Span};
use eng_system::DisplayUnit;
use eng_system::analysis::{Named, Names};
use eng_system::expression::{Expression, Member, Operator};
use eng_system::figure::Signals;
use eng_system::place::Location;
use eng_system::recorded::ENERGY;
use eng_system::system::Parameter;

/// Most parameters that a message lists. A choice: they fit in a line or two.
const SHOWN_PARAMETERS: usize = 12;

/// The analyses behind an expression, each once.
fn analyses(expression: &Expression, found: &mut Vec<String>) {
    expression.channels(&mut |analysis, _| {
        if !found.iter().any(|known| known == analysis) {
            found.push(analysis.to_owned());
        }
    });
}

impl<'a> Reporter<'a, '_> {
    /// The derivative of numbers or signals by a parameter, or by each of several.
    pub(super) fn gradient(&mut self, first: &'a Expr, of: Typed, by: &'a Expr) -> Option<Typed> {
        let what = "the first argument of `gradient`";
        if of.shape() == Shape::Truth {
            self.shaped(first, &of, Shape::Number, what)?;
        }
        let plans = self.differentiated(first, &of)?;
        self.without_energy(first, &of)?;
        let (names, many) = self.parameter_paths(by)?;
        let mut parameters = self.named_parameters(&plans, by.span, &names)?.into_iter();
        let like = parameters.next()?;
        let all: Vec<Parameter> = std::iter::once(like.clone()).chain(parameters).collect();
        if let Some(other) = all.iter().find(|p| p.dimension != like.dimension) {
            let label = format!(
                "`{}` differs from `{}`",
                other.origin.path, like.origin.path
            );
            self.diagnose(
                Diagnostic::error(
                    codes::LIST_ELEMENTS,
                    "the parameters of a list are of one dimension",
                )
                .at(by.span, label),
            );
            return None;
        }
        let count = match (of.list, many) {
            (true, true) if of.members.len() != all.len() => {
                let (values, parameters) = (of.members.len(), all.len());
                let title =
                    format!("a list of {values} is differentiated by a list of {parameters}");
                self.diagnose(
                    Diagnostic::error(codes::REPORT_RUNS, title).at(by.span, "element by element"),
                );
                return None;
            }
            (true, _) => of.members.len(),
            (_, true) => all.len(),
            _ => 1,
        };
        let mut members = Vec::with_capacity(count);
        for at in 0..count {
            let member = of.members.get(if of.list { at } else { 0 })?;
            let parameter = all.get(if many { at } else { 0 })?;
            let path = &parameter.origin.path;
            let mut derived = member.derivative(path);
            // several parameters of one value name the members
            if many && !of.list {
                derived.channel.clone_from(path);
            }
            members.push(derived);
        }
        let display = self.per(&of, &like);
        let change = of.quantity().difference();
        let quantity = change.over(&Quantity::hard(like.dimension));
        Some(Typed {
            members,
            list: of.list || many,
            ty: match of.ty {
                Type::Signal { rows, .. } => Type::Signal { quantity, rows },
                _ => Type::Scalar(quantity),
            },
            display: Some(display),
            level: None,
        })
    }

    /// Refuses the columns of energy, which a run does not differentiate.
    fn without_energy(&mut self, expr: &Expr, of: &Typed) -> Option<()> {
        let mut energy = None;
        for member in &of.members {
            member.expression.channels(&mut |_, path| {
                if ENERGY.contains(&path) {
                    energy = Some(path.to_owned());
                }
            });
        }
        let Some(path) = energy else { return Some(()) };
        self.diagnose(
            Diagnostic::error(codes::REPORT_GRADIENT, format!("`{path}` has no gradient"))
                .at(expr.span, "this uses a column of the energy audit")
                .with_help("make an output of the energy that you need"),
        );
        None
    }

    /// The unit of a value per that of a parameter.
    fn per(&self, of: &Typed, parameter: &Parameter) -> DisplayUnit {
        let own = match (&of.level, &of.display) {
            (Some(_), _) => DisplayUnit {
                symbol: "dB".to_owned(),
                scale: 1.0,
                offset: 0.0,
            },
            (None, Some(display)) => display.clone(),
            (None, None) => self.usual_display(&of.quantity().difference()),
        };
        own.over(&parameter.display)
    }

    /// The analyses of differentiated values: transients.
    pub(super) fn differentiated(
        &mut self,
        expr: &Expr,
        of: &Typed,
    ) -> Option<Vec<&'a AnalysisPlan>> {
        let mut names = Vec::new();
        for member in &of.members {
            analyses(&member.expression, &mut names);
        }
        if names.is_empty() {
            self.diagnose(
                Diagnostic::error(
                    codes::REPORT_SHAPE,
                    "a derivative needs a value made of results",
                )
                .at(expr.span, "this number is known before the run")
                .with_help("name a channel of a `transient` or `periodic` analysis"),
            );
            return None;
        }
        let mut plans = Vec::new();
        for name in names {
            let plan = self.models.plan(&name)?;
            if plan.analysis.kind.gradients().is_none() {
                self.diagnose(
                    Diagnostic::error(
                        codes::REPORT_GRADIENT,
                        format!("`{name}` has no gradients: they are of `transient` and `periodic` analyses"),
                    )
                    .at(expr.span, "made of its results")
                    .with_help("compare two runs with different values of the parameter"),
                );
                return None;
            }
            plans.push(plan);
        }
        Some(plans)
    }

    /// The paths of parameters that an expression names, and whether it means a list.
    fn parameter_paths(&mut self, by: &'a Expr) -> Option<(Vec<String>, bool)> {
        let Some((root, _, steps)) = steps(by) else {
            self.diagnose(
                Diagnostic::error(
                    codes::REPORT_SHAPE,
                    "the second argument of `gradient` is a parameter",
                )
                .at(by.span, "no path of a parameter")
                .with_help("such as `speed` or `rod[*].mass`"),
            );
            return None;
        };
        let (mut paths, mut many) = (vec![root.to_owned()], false);
        for step in steps {
            let ends: Vec<String> = match step {
                Step::Field(name) => vec![format!(".{}", name.text)],
                Step::Index([IndexArgument::All(_)], _) => {
                    many = true;
                    vec!["[*]".to_owned()]
                }
                Step::Index([IndexArgument::At(at)], _) => {
                    let (numbers, range) = self.index(at)?;
                    many |= range;
                    numbers.iter().map(|number| format!("[{number}]")).collect()
                }
                Step::Index(_, span) => {
                    self.diagnose(
                        Diagnostic::error(
                            codes::INDEX,
                            "a parameter of a report has single indices",
                        )
                        .at(span, "several at once"),
                    );
                    return None;
                }
            };
            let longer = |path: &String| -> Vec<String> {
                ends.iter().map(|end| format!("{path}{end}")).collect()
            };
            paths = paths.iter().flat_map(longer).collect();
        }
        Some((paths, many))
    }

    /// The named parameters of the first analysis. Each must be one of the `gradients` of all analyses.
    fn named_parameters(
        &mut self,
        plans: &[&'a AnalysisPlan],
        place: Span,
        names: &[String],
    ) -> Option<Vec<Parameter>> {
        let mut paths: Vec<String> = names.to_vec();
        let mut first: Option<Vec<Parameter>> = None;
        for plan in plans {
            let channels = self.models.channels(plan)?;
            let system = channels.system();
            let known = system.paths_of(Names::Parameters);
            let stated = stated(plan, &known);
            let mut found = Vec::new();
            for path in &paths {
                let Some(own) = indices(path, &known) else {
                    let title = format!("`{}` has no parameter `{path}`", system.name);
                    let mut message = Diagnostic::error(codes::NO_MEMBER, title)
                        .at(place, "no parameter of this name");
                    message = match nearest(path, known.iter().copied()) {
                        Some(near) if names.len() == 1 => message.meant(place, near),
                        _ => message.with_note(format!(
                            "parameters are {}",
                            listing(known.iter().copied(), SHOWN_PARAMETERS)
                        )),
                    };
                    self.diagnose(message);
                    return None;
                };
                if own.iter().any(|index| !stated.contains(index)) {
                    let name = &plan.analysis.origin.path;
                    let message = Diagnostic::error(
                        codes::REPORT_GRADIENT,
                        format!("`{name}` computes no gradient by `{path}`"),
                    );
                    self.diagnose(
                        message
                            .at(place, format!("not among the `gradients` of `{name}`"))
                            .with_help(format!("add it there: `gradients: [{path}]`")),
                    );
                    return None;
                }
                found.extend(
                    own.iter()
                        .filter_map(|i| system.parameters.get(*i))
                        .cloned(),
                );
            }
            // stars mean the same parameters in all analyses
            paths = found.iter().map(|p| p.origin.path.clone()).collect();
            first.get_or_insert(found);
        }
        first
    }

    /// Changes of values for a figure. With a share, every parameter of the analysis of one value changes by this
    /// share. Without one, the changes are those given.
    pub(super) fn changes(
        &mut self,
        expr: &'a Expr,
        share: Option<&'a Expr>,
        display: Option<&UnitExpr>,
    ) -> Option<Signals> {
        let of = self.expression(expr)?.settled();
        self.shaped(expr, &of, Shape::Number, "the argument of `tornado`")?;
        let name = of.members.first().map_or("", |member| &member.channel);
        let quantity = format!("change of {}", last_name(name));
        let members = match share {
            Some(share) => self.by_share(expr, &of, share)?,
            None => self.given_changes(expr, &of)?,
        };
        let changed = Typed {
            members,
            list: true,
            ty: Type::Scalar(of.quantity().difference()),
            ..of
        };
        let mut signals = self.shown(changed, display, expr)?;
        signals.shown.quantity = quantity;
        Some(signals)
    }

    /// The changes of a value by shares of the parameters of its analysis.
    fn by_share(&mut self, expr: &'a Expr, of: &Typed, share: &'a Expr) -> Option<Vec<Member>> {
        let place = share.span;
        let share = self.change(share, "`change`")?;
        let plans = self.differentiated(expr, of)?;
        self.without_energy(expr, of)?;
        let (false, [member], [plan]) = (of.list, of.members.as_slice(), plans.as_slice()) else {
            self.diagnose(
                Diagnostic::error(
                    codes::REPORT_RUNS,
                    "`tornado` with `change` draws one value of one analysis",
                )
                .at(expr.span, "these are several")
                .with_help("give one value of one analysis, or make a figure for each value"),
            );
            return None;
        };
        let name = &plan.analysis.origin.path;
        let parameters = self.parameters_of(plan)?;
        let title = match parameters.iter().find(|parameter| parameter.point) {
            Some(point) => Some((
                format!(
                    "a share of `{}` depends on the zero of its unit",
                    point.origin.path
                ),
                "this parameter cannot change by a share",
                format!(
                    "draw changes of your own: `tornado([gradient(…, {})*5 K, …])`",
                    point.origin.path
                ),
            )),
            None if parameters.is_empty() => Some((
                format!("`{name}` computes no gradients"),
                "there is no parameter to change",
                "name parameters in the analysis: `gradients: […]`".to_owned(),
            )),
            None => None,
        };
        if let Some((title, label, help)) = title {
            let message = Diagnostic::error(codes::REPORT_GRADIENT, title).at(place, label);
            self.diagnose(message.with_help(help));
            return None;
        }
        let of = parameters.iter().map(|parameter| {
            let path = &parameter.origin.path;
            let by = member.derivative(path);
            let change = Expression::Binary(
                Operator::Multiply,
                Box::new(Expression::Number(share)),
                Box::new(Expression::Parameter {
                    analysis: name.clone(),
                    path: path.clone(),
                }),
            );
            let sides = (Box::new(by.expression), Box::new(change));
            Member {
                channel: path.clone(),
                expression: Expression::Binary(Operator::Multiply, sides.0, sides.1),
                analysis: by.analysis,
            }
        });
        Some(of.collect())
    }

    /// Changes under the names of their parameters, and of their values where these names do not distinguish them.
    fn given_changes(&mut self, expr: &Expr, of: &Typed) -> Option<Vec<Member>> {
        let mut members = Vec::with_capacity(of.members.len());
        for member in &of.members {
            let mut names = Vec::new();
            parameters(&member.expression, &mut names);
            if names.is_empty() {
                self.diagnose(
                    Diagnostic::error(codes::REPORT_SHAPE, "`tornado` draws changes by parameters")
                        .at(expr.span, "a value, not a change of it")
                        .with_help(
                            "state `change: 1 %`, or give changes such as `gradient(moft, speed)*10 rpm`",
                        ),
                );
                return None;
            }
            members.push(Member {
                channel: names.join(", "),
                ..member.clone()
            });
        }
        let alike = |member: &Member| {
            let same = members
                .iter()
                .filter(|other| other.channel == member.channel);
            same.count() > 1
        };
        let apart = members.iter().zip(&of.members).map(|(member, own)| Member {
            channel: match alike(member) {
                true => format!("{} by {}", own.channel, member.channel),
                false => member.channel.clone(),
            },
            ..member.clone()
        });
        Some(apart.collect())
    }

    /// The parameters by which an analysis is differentiated.
    pub(super) fn parameters_of(&mut self, plan: &'a AnalysisPlan) -> Option<Vec<Parameter>> {
        let channels = self.models.channels(plan)?;
        let system = channels.system();
        let stated = stated(plan, &system.paths_of(Names::Parameters));
        let parameters = stated.iter().filter_map(|i| system.parameters.get(*i));
        Some(parameters.cloned().collect())
    }
}

/// The parameters by which parts of an expression are differentiated, each once.
fn parameters<'e>(expression: &'e Expression, found: &mut Vec<&'e str>) {
    if let Expression::Gradient { parameter, .. } = expression
        && !found.contains(&parameter.as_str())
    {
        found.push(parameter);
    }
    for part in expression.parts() {
        parameters(part, found);
    }
}

/// Indices of the parameters in the `gradients` of an analysis. The check of the analysis reports wrong names.
fn stated(plan: &AnalysisPlan, known: &[&str]) -> Vec<usize> {
    let stated = plan.analysis.kind.gradients();
    let found = stated.and_then(|stated| Names::Parameters.indices(stated, known).ok());
    found.unwrap_or_default()
}

/// Indices of the parameters with a path, in which `[*]` stands for every index.
fn indices(path: &str, known: &[&str]) -> Option<Vec<usize>> {
    let named = Named {
        path: path.to_owned(),
        at: Location {
            source: 0,
            start: 0,
            end: 0,
        },
    };
    Names::Parameters.indices(&[named], known).ok()
}
