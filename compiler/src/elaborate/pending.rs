//! Starts and outputs of models and components, and the cycle. They wait until all elements are known.

use super::body::index_text;
use super::element::Draft;
use super::expression::Truth;
use super::output::Columns;
use super::requirement::Message;
use super::scalar::{ElementBuilder, Flag, Scalar, Stage};
use super::value::{ScopeId, Value};
use super::{Elaborator, Eval};
use crate::codes;
use crate::ir::optimise::dependencies;
use crate::ir::{Node, Op};
use eng_grammar::Diagnostic;
use eng_grammar::ast::{self, Form};
use eng_system::Dimension;
use eng_system::analysis::STOP;
use eng_system::elementary::Elementary;
use eng_system::layout::{MARKER_WIDTH, VELOCITY};
use eng_system::system::{ConditionKind, Origin, Role};

/// The target of a start value.
#[derive(Clone, Debug)]
pub(crate) enum StartTarget {
    /// A body's origin.
    Position(u32),
    /// A body's orientation, with the stated matrix.
    Rotation(u32, [Node; 9]),
    Velocity(u32),
    AngularVelocity(u32),
}

impl StartTarget {
    /// Whether it is the same quantity of the same marker.
    pub fn is_same(&self, other: &StartTarget) -> bool {
        use StartTarget::{AngularVelocity, Position, Rotation, Velocity};
        match (self, other) {
            (Position(a), Position(b))
            | (Velocity(a), Velocity(b))
            | (AngularVelocity(a), AngularVelocity(b))
            | (Rotation(a, _), Rotation(b, _)) => a == b,
            _ => false,
        }
    }
}

/// An item that waits until all elements are known.
#[derive(Clone, Debug)]
pub(crate) enum Pending<'a> {
    Start {
        role: Role,
        target: StartTarget,
        value: &'a ast::Expr,
        scope: ScopeId,
    },
    /// `start`/`guess` of an expression. Lowering it shows whether it is a position or a velocity.
    StartExpression {
        exact: bool,
        target: &'a ast::Expr,
        scope: ScopeId,
        value: &'a ast::Expr,
        /// The scope of the value.
        outside: ScopeId,
    },
    Output {
        binding: &'a ast::Binding,
        scope: ScopeId,
    },
    /// An `advise` of a model or component.
    Advice {
        statement: &'a ast::Statement,
        scope: ScopeId,
        path: String,
    },
    /// The condition of an analysis that ends its run.
    Stop {
        condition: &'a ast::Expr,
        scope: ScopeId,
    },
    /// The channel of an input.
    Input {
        binding: &'a ast::Binding,
        scope: ScopeId,
    },
}

impl<'a> Elaborator<'a, '_> {
    pub fn pending_start(
        &mut self,
        role: Role,
        target: StartTarget,
        value: &'a ast::Expr,
        scope: ScopeId,
    ) {
        self.replaced_start(&target);
        self.draft.pending.push(Pending::Start {
            role,
            target,
            value,
            scope,
        });
    }

    /// Lowers starts and outputs.
    pub fn finish_pending(&mut self) {
        for pending in std::mem::take(&mut self.draft.pending) {
            self.graphs.element = Some(ElementBuilder::default());
            let result = match pending {
                Pending::Start {
                    role,
                    target,
                    value,
                    scope,
                } => self.lower_start(role, &target, value, scope),
                Pending::StartExpression {
                    exact,
                    target,
                    scope,
                    value,
                    outside,
                } => {
                    self.context.in_start = true;
                    let lowered =
                        self.lower_start_expression(exact, (target, scope), (value, outside));
                    self.context.in_start = false;
                    lowered
                }
                Pending::Output { binding, scope } => self.lower_output(binding, scope),
                Pending::Input { binding, scope } => self.lower_input(binding, scope),
                Pending::Stop { condition, scope } => self.lower_stop(condition, scope),
                Pending::Advice {
                    statement,
                    scope,
                    path,
                } => {
                    self.graphs.element = None;
                    self.condition_of_block(statement, scope, &path, None)
                }
            };
            // the error was reported
            let _ = result;
            self.graphs.element = None;
            self.context.in_output = false;
        }
    }

    /// An element without loads, whose condition ends the run. The condition follows the motion, so it has kinks, and
    /// steps end at them.
    fn lower_stop(&mut self, condition: &'a ast::Expr, scope: ScopeId) -> Eval<()> {
        let refused = |label: &str, help: &str| {
            let title = "this condition cannot end a run";
            Diagnostic::error(codes::ANALYSIS_VALUE, title)
                .at(condition.span, label)
                .with_help(help)
        };
        let flag = match self.truth(condition, scope)? {
            Truth::Later(flag) if flag.stage == Stage::Motion => flag,
            _ => {
                return Err(self.report(refused(
                    "it does not change with the motion",
                    "name a position, a speed, a state or an output that follows from them",
                )));
            }
        };
        if self.is_exact(flag) {
            return Err(self.report(refused(
                "steps pass an exact value",
                "compare by `<` or `>`: the run ends where the comparison changes",
            )));
        }
        let text = self.sources.text(condition.span).to_owned();
        let message = Message {
            text,
            ..Message::default()
        };
        let mut draft = Draft::default();
        self.call_conditions(&mut draft);
        self.condition(
            flag,
            ConditionKind::Stop,
            "",
            message,
            condition.span,
            &mut draft,
        );
        let origin = Origin {
            path: STOP.to_owned(),
            used_at: Some(super::location(condition.span)),
            defined_at: None,
        };
        let class = STOP.to_owned();
        self.finish_element(origin, condition.span, Role::Dynamic, class, None, draft)?;
        Ok(())
    }

    /// Whether a condition of the present element compares by `==` or `!=`.
    fn is_exact(&self, flag: Flag) -> bool {
        let Some(element) = self.graphs.element.as_ref() else {
            return false;
        };
        let needed = dependencies(&element.graph, &[flag.node]);
        let mut operations = element.graph.nodes().iter().zip(needed);
        operations.any(|(op, needed)| needed && matches!(op, Op::Equal(..)))
    }

    fn lower_start(
        &mut self,
        role: Role,
        target: &StartTarget,
        value: &'a ast::Expr,
        scope: ScopeId,
    ) -> Eval<()> {
        let (marker, name) = match target {
            StartTarget::Position(m) => (*m, "position"),
            StartTarget::Rotation(m, _) => (*m, "rotation"),
            StartTarget::Velocity(m) => (*m, "velocity"),
            StartTarget::AngularVelocity(m) => (*m, "angular_velocity"),
        };
        let path = self.draft.markers[marker as usize]
            .origin
            .path
            .replace(".origin", "");
        let path = format!("start of {path}.{name}");
        let local = self.local_marker(marker, Some(value.span))?;
        let (actual, dimension) = match target {
            StartTarget::Position(_) => (self.marker_origin(local), Dimension::LENGTH),
            StartTarget::Velocity(_) => (
                [0, 1, 2].map(|i| self.marker_input(local, 12 + i)),
                Dimension::LENGTH.over(Dimension::TIME),
            ),
            StartTarget::AngularVelocity(_) => {
                let w = [0, 1, 2].map(|i| self.marker_input(local, 15 + i));
                let per_time = Dimension::ANGLE.over(Dimension::TIME);
                (self.rotate(local, &w), per_time)
            }
            StartTarget::Rotation(_, matrix) => {
                // x·Y, y·Z, z·X of the actual axes x, y, z and the stated axes X, Y, Z all vanish at
                // alignment
                let column = |j: usize| {
                    [0, 1, 2].map(|i| Scalar {
                        stage: Stage::Bind,
                        node: matrix[3 * i + j],
                    })
                };
                let rows = [(0, 1), (1, 2), (2, 0)].map(|(a, b)| {
                    let axis = self.marker_axis(local, a);
                    self.graphs.dot(&axis, &column(b as usize))
                });
                let rows = rows
                    .into_iter()
                    .map(|s| (s, "rotation".to_owned()))
                    .collect();
                return self.start_element(role, path, value.span, Dimension::ONE, rows);
            }
        };
        let v = self.evaluate(value, scope)?;
        let stated = self.as_vector(v, value.span)?;
        let text = self.sources.text(value.span).to_owned();
        let rows = [0, 1, 2]
            .map(|i| {
                (
                    self.graphs.subtract(actual[i], stated[i]),
                    format!("{name}.{} == {text}", ["x", "y", "z"][i]),
                )
            })
            .to_vec();
        self.start_element(role, path, value.span, dimension, rows)
    }

    fn lower_start_expression(
        &mut self,
        exact: bool,
        (target, scope): (&'a ast::Expr, ScopeId),
        (value, outside): (&'a ast::Expr, ScopeId),
    ) -> Eval<()> {
        let actual = self.evaluate(target, scope)?;
        let stated = self.evaluate(value, outside)?;
        let a = self.as_components(
            match actual {
                Value::Scalar(s) => Value::List(vec![Value::Scalar(s)]),
                other => other,
            },
            target.span,
        )?;
        if a.iter().all(|part| part.stage == Stage::Bind) {
            return Err(self.report(
                Diagnostic::error(
                    codes::START,
                    "only quantities of the motion can be set at the start",
                )
                .at(target.span, "this follows from parameters alone")
                .with_help("a parameter has its value in the text; `--set` changes it for a run"),
            ));
        }
        let b = self.as_components(
            match stated {
                Value::Scalar(_) | Value::Int(_) => Value::List(vec![stated]),
                other => other,
            },
            value.span,
        )?;
        if a.len() != b.len() {
            return Err(self.lengths(a.len(), target.span, b.len(), value.span));
        }
        let rotation = |e: &Self, s: &Scalar| {
            let element = e.graphs.element.as_ref()?;
            element.rotations.iter().position(|r| r.2 == s.node)
        };
        let text = format!(
            "{} == {}",
            self.sources.text(target.span),
            self.sources.text(value.span)
        );
        let mut rows = Vec::new();
        let mut velocity = false;
        for (x, y) in a.into_iter().zip(b) {
            let mut difference = self.graphs.subtract(x, y);
            if let Some(index) = rotation(self, &x) {
                if y.stage != Stage::Motion {
                    let stated = self.bind_node(y, value.span)?;
                    if let Some(element) = self.graphs.element.as_mut() {
                        element.stated.push((index as u32, stated));
                    }
                }
                // the sine closes the angle at any turn; the stated turns are counted afterwards
                let sine = self
                    .graphs
                    .unary(difference, |g, n| g.unary(Elementary::Sin, n));
                let cosine = self
                    .graphs
                    .unary(difference, |g, n| g.unary(Elementary::Cos, n));
                difference = self.graphs.binary(sine, cosine, crate::ir::Graph::atan2);
            }
            velocity |= difference.stage == Stage::Motion && self.uses_twist(difference.node);
            rows.push((difference, text.clone()));
        }
        let role = if velocity {
            Role::StartVelocity { exact }
        } else {
            Role::StartPosition { exact }
        };
        if matches!(role, Role::StartPosition { .. }) {
            self.refuse_coinciding(target)?;
        }
        let path = format!("start of {}", self.sources.text(target.span));
        let dimension = self.dimension_at(target.span, scope)?;
        self.start_element(role, path, target.span, dimension, rows)
    }

    /// Refuses the start or guess of a position against `ground` as an argument. This marker is placed on the other
    /// marker of its element after the assembly. So a stated position never holds, and a guess has no effect.
    fn refuse_coinciding(&mut self, target: &ast::Expr) -> Eval<()> {
        let Some(element) = self.graphs.element.as_ref() else {
            return Ok(());
        };
        let markers = &self.draft.markers;
        let mut placed = element.markers.iter().map(|i| &markers[*i as usize]);
        let Some(partner) = placed.find_map(|marker| marker.placed_at) else {
            return Ok(());
        };
        let other = markers[partner as usize].origin.path.clone();
        let message = Diagnostic::error(
            codes::START,
            format!("`ground` begins at `{other}`, so this cannot be set at the start"),
        )
        .at(target.span, "zero at the start, whatever is stated")
        .with_help(
            "name a marker of the model in place of `ground`: `marker pivot = [0, 0, 0] mm`",
        );
        Err(self.report(message))
    }

    /// Whether a value of the present element depends on a marker's twist.
    fn uses_twist(&self, node: Node) -> bool {
        let Some(element) = self.graphs.element.as_ref() else {
            return false;
        };
        let mut stack = vec![node];
        let mut seen = vec![false; element.graph.nodes().len()];
        while let Some(n) = stack.pop() {
            if std::mem::replace(&mut seen[n.0 as usize], true) {
                continue;
            }
            match element.graph.op(n) {
                Op::Input(i) => {
                    let end = super::scalar::PROVISIONAL.state(0);
                    if (1..end).contains(&i) && (i - 1) % MARKER_WIDTH >= VELOCITY {
                        return true;
                    }
                }
                op => stack.extend(op.operands()),
            }
        }
        false
    }

    fn lower_output(&mut self, binding: &'a ast::Binding, scope: ScopeId) -> Eval<()> {
        let name = &binding.name.text;
        let base = self.path(scope, name);
        let Some(expr) = &binding.value else {
            return Ok(());
        };
        let display = self.display_of(binding)?;
        let mut found = Vec::new();
        self.for_each(&binding.index, scope, &mut |e, inner, position| {
            e.graphs.element = Some(ElementBuilder::default());
            e.context.in_output = true;
            let path = format!("{base}{}", index_text(position));
            e.graphs.bind.owner.clone_from(&path);
            let place = binding.ty.as_ref().map_or(expr.span, |ty| ty.span);
            let shown = Columns {
                dimension: e.dimension_at(place, inner)?,
                display: display.clone(),
                declared: binding.ty.is_some(),
                frame: None,
            };
            let value = e.bound_value(binding, expr, inner)?;
            found.push((position.to_vec(), value.clone()));
            e.output_element(path, vec![(name.clone(), value, shown)], binding.name.span)?;
            e.graphs.element = None;
            e.context.in_output = false;
            Ok(())
        })?;
        self.as_promised(binding, scope, &found)
    }

    /// The cycle's element: angle and its rate.
    pub fn lower_cycle(&mut self) -> Eval<Option<eng_system::system::Cycle>> {
        let Some(cycle) = self.draft.cycle.clone() else {
            return Ok(None);
        };
        let Form::Instance { value, .. } = &cycle.declaration.form else {
            return Ok(None);
        };
        self.graphs.element = Some(ElementBuilder::default());
        self.context.in_output = true;
        let angle = self.evaluate(value, cycle.scope)?;
        let rate = self.rate_of(angle.clone(), value.span)?;
        let before = self.draft.channels.len();
        let values = vec![
            ("angle".to_owned(), angle, Columns::of(Dimension::ANGLE)),
            (
                "speed".to_owned(),
                rate,
                Columns::of(Dimension::ANGLE.over(Dimension::TIME)),
            ),
        ];
        let span = cycle.declaration.name.span;
        let element = self.output_element("cycle".into(), values, span)?;
        // time, angle and speed are columns of their own
        self.draft.channels.truncate(before);
        self.context.in_output = false;
        self.graphs.element = None;
        self.graphs.bind.owner = "cycle".into();
        let period = self.slot(cycle.period);
        Ok(Some(eng_system::system::Cycle {
            origin: eng_system::system::Origin {
                path: "cycle".into(),
                used_at: Some(super::location(cycle.declaration.name.span)),
                defined_at: None,
            },
            element,
            period,
        }))
    }
}
