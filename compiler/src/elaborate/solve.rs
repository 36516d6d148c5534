//! `solve(f, estimate)`: the zero of a function near an estimate, inside of one element.
//!
//! The operations are steps of Newton's method with the exact Jacobian matrix J, one after the other:
//! [`HELD_STEPS`] steps from the estimate, then two more. The result of the first steps is *held*: it has no
//! derivative. With x₀ held and near the zero, the error δ of x₀ becomes O(δ²) in x₁ = x₀ − J⁻¹f(x₀) and
//! O(δ⁴) in x₂, as functions of everything that f depends on. So the first three derivatives of x₂ are those
//! of the implicit function f(x) = 0, and the derivatives of a class cost two steps, not all of them.
//!
//! A class cannot iterate until something converges, because its code has no loops. The first step after the held
//! ones must be small. A condition of the element tests this.

use super::bind_program::{Check, MessagePart};
use super::expression::Truth;
use super::partial::Passed;
use super::requirement::{Message, Part};
use super::scalar::{Flag, Scalar, Stage};
use super::slope::Differentiated;
use super::value::Value;
use super::{Elaborator, Eval, location, scalar};
use crate::codes;
use crate::ir::{Graph, Node, copy_into, forward};
use crate::typed::types::Type;
use eng_grammar::{Diagnostic, Span};
use eng_system::elementary::Elementary;
use eng_system::{Dimension, DisplayUnit};

/// Steps whose result has no derivative. From an estimate with an error of a tenth of the distance over which the slope
/// changes, five reach rounding, because each squares the error. Three more serve estimates farther away.
const HELD_STEPS: usize = 8;
/// Most unknowns. A choice: Cramer's rule is written out, and its operations grow with the factorial of the
/// number.
const MOST_UNKNOWNS: usize = 3;
/// The search has ended if the correction after the held steps is at most this share of the sum of two sizes: that of
/// the unknown, and that of its way from the estimate. The error after this correction is about its square, 1e-12,
/// and one more step follows. A choice: a larger one would accept solutions with few digits, and one near the
/// rounding unit would refuse solutions that round.
const ENDED_CORRECTION: f64 = 1e-6;
/// The same correction in SI units, for a zero at zero. A choice: no length or angle of a machine is as
/// small.
const SMALL_CORRECTION: f64 = 1e-12;
/// Share of the sum of its products' magnitudes below which a determinant is rounding. The equations then do
/// not determine the unknowns, and the correction is meaningless. A choice: some hundred rounding units.
const SINGULAR_SHARE: f64 = 1e-13;

/// A function of the unknowns with its Jacobian matrix, as nodes of one graph.
struct NewtonSystem {
    stage: Stage,
    inputs: Vec<u32>,
    /// The values, then the rows of the matrix.
    nodes: Vec<Node>,
}

impl<'a> Elaborator<'a, '_> {
    /// The value of `solve(f, estimate)`.
    pub(super) fn solve(
        &mut self,
        differentiated: &Differentiated<'a, '_>,
        (written, estimate, place): (Span, Value<'a>, Span),
    ) -> Eval<Value<'a>> {
        let is_list = !matches!(estimate, Value::Scalar(_) | Value::Int(_));
        let from = match estimate {
            value @ (Value::Scalar(_) | Value::Int(_)) => vec![self.as_scalar(value, place)?],
            value => self.as_components(value, place)?,
        };
        if from.is_empty() || from.len() > MOST_UNKNOWNS {
            let title = format!(
                "`solve` finds 1 to {MOST_UNKNOWNS} unknowns, not {}",
                from.len()
            );
            return Err(self.report(
                Diagnostic::error(codes::LENGTHS, title)
                    .at(place, "the estimates")
                    .with_help(
                        "solve an equation that does not depend on the others in a call of its own",
                    ),
            ));
        }
        let system = self.system_of(differentiated, &from, is_list)?;
        let stage = system.stage;
        let begin: Vec<Node> = from.iter().map(|x| self.raised(*x, stage)).collect();
        let graph = self.graphs.graph(stage);
        let mut x = begin.clone();
        for _ in 0..HELD_STEPS {
            x = step(graph, &system, &x).next;
        }
        for x in &mut x {
            *x = graph.unary(Elementary::Held, *x);
        }
        let held = x.clone();
        let Step {
            next: near,
            values: residuals,
            determinant: [all, magnitudes],
        } = step(graph, &system, &x);
        let found = step(graph, &system, &near).next;
        let (size, share) = (graph.abs(all), graph.constant(SINGULAR_SHARE));
        let rounding = graph.multiply(share, magnitudes);
        let (determined, none) = (graph.less(rounding, size), graph.constant(0.0));
        let mut ended = determined;
        // |x₁ − x₀| ≤ ENDED_CORRECTION (|x₁| + |x₁ − estimate|) + SMALL_CORRECTION, and false if a number is NaN
        for ((held, near), begin) in held.iter().zip(&near).zip(&begin) {
            let correction = graph.subtract(*near, *held);
            let correction = graph.abs(correction);
            let way = graph.subtract(*near, *begin);
            let (size, way) = (graph.abs(*near), graph.abs(way));
            let size = graph.add(size, way);
            let (share, least) = (
                graph.constant(ENDED_CORRECTION),
                graph.constant(SMALL_CORRECTION),
            );
            let most = graph.multiply(share, size);
            let most = graph.add(most, least);
            // without a determinant the margin of the condition is the correction itself
            let most = graph.select(determined, most, none);
            let fits = graph.less_equal(correction, most);
            ended = graph.push(crate::ir::Op::And(ended, fits));
        }
        let node = ended;
        let numbers = |nodes: &[Node]| -> Vec<Scalar> {
            nodes
                .iter()
                .map(|node| Scalar { stage, node: *node })
                .collect()
        };
        self.watch_end(
            Flag { stage, node },
            differentiated,
            (written, place),
            [numbers(&held), numbers(&residuals)],
        )?;
        let mut found: Vec<Value<'a>> = numbers(&found).into_iter().map(Value::Scalar).collect();
        Ok(match (is_list, found.pop()) {
            (false, Some(only)) => only,
            (_, last) => {
                found.extend(last);
                Value::List(found)
            }
        })
    }

    /// A number as a node of the graph of a stage.
    fn raised(&mut self, x: Scalar, stage: Stage) -> Node {
        match stage {
            Stage::Bind => x.node,
            Stage::Motion => self.graphs.lift(x.stage, x.node),
        }
    }

    /// The function at unknown arguments, with its derivatives.
    fn system_of(
        &mut self,
        differentiated: &Differentiated<'a, '_>,
        from: &[Scalar],
        is_list: bool,
    ) -> Eval<NewtonSystem> {
        // the values at the estimate give the stage, and their call includes the function's conditions
        let known = self.values_of(differentiated, from, is_list)?;
        let moves = known.iter().chain(from).any(|s| s.stage == Stage::Motion);
        let stage = if moves { Stage::Motion } else { Stage::Bind };
        if known.len() != from.len() {
            let several = |count: usize| if count == 1 { "" } else { "s" };
            let title = format!(
                "`solve`: {} equation{} for {} unknown{}",
                known.len(),
                several(known.len()),
                from.len(),
                several(from.len())
            );
            return Err(self.report(Diagnostic::error(codes::LENGTHS, title).at(
                differentiated.call,
                "the function must give as many numbers as it takes",
            )));
        }
        let count = from.len() as u32;
        let inputs: Vec<u32> = (1..=count)
            .map(|k| u32::MAX - self.context.unknowns - k)
            .collect();
        self.context.unknowns += count;
        let unknowns: Vec<Scalar> = (inputs.iter())
            .map(|input| self.graphs.unknown(stage, *input))
            .collect();
        let values = self.values_of(differentiated, &unknowns, is_list);
        self.context.unknowns -= count;
        let mut nodes: Vec<Node> = (values?.into_iter())
            .map(|value| self.raised(value, stage))
            .collect();
        let graph = self.graphs.graph(stage);
        let one = graph.constant(1.0);
        let mut columns = Vec::with_capacity(inputs.len());
        for unknown in &inputs {
            columns.push(forward(graph, &nodes, &|input| {
                (input == *unknown).then_some(one)
            }));
        }
        let graph = self.graphs.graph(stage);
        let no_slope = |node: &Node| graph.as_constant(*node) == Some(0.0);
        let still = (0..inputs.len()).position(|row| {
            columns
                .iter()
                .filter_map(|column| column.get(row))
                .all(no_slope)
        });
        let unread = columns
            .iter()
            .position(|column| column.iter().all(no_slope));
        for row in 0..inputs.len() {
            nodes.extend(columns.iter().filter_map(|column| column.get(row)));
        }
        self.depends_on_unknowns(differentiated, [still, unread], inputs.len())?;
        Ok(NewtonSystem {
            stage,
            inputs,
            nodes,
        })
    }

    /// Refuses an equation that no unknown changes, and an unknown that changes no equation.
    fn depends_on_unknowns(
        &mut self,
        differentiated: &Differentiated<'a, '_>,
        [still, unread]: [Option<usize>; 2],
        count: usize,
    ) -> Eval<()> {
        let number = |k: usize| match count {
            1 => String::new(),
            _ => format!(" {}", k + 1),
        };
        let title = match (still, unread) {
            (Some(k), _) => format!(
                "the equation{} of `solve` does not depend on the unknown{}",
                number(k),
                if count > 1 { "s" } else { "" }
            ),
            (_, Some(k)) => format!("no equation of `solve` depends on the unknown{}", number(k)),
            (None, None) => return Ok(()),
        };
        Err(self.report(
            Diagnostic::error(codes::NO_UNKNOWN, title)
                .at(differentiated.call, "`solve` changes the argument of its function until the function is zero")
                .with_help("let the function read its argument: `fn distance(x: Length) -> Length = x - 3 mm`"),
        ))
    }

    fn values_of(
        &mut self,
        differentiated: &Differentiated<'a, '_>,
        x: &[Scalar],
        is_list: bool,
    ) -> Eval<Vec<Scalar>> {
        let mut numbers: Vec<Value<'a>> = x.iter().copied().map(Value::Scalar).collect();
        let value = match (is_list, numbers.pop()) {
            (false, Some(only)) => only,
            (_, last) => {
                numbers.extend(last);
                Value::List(numbers)
            }
        };
        let passed = vec![Passed {
            place: 0,
            value,
            span: differentiated.call,
            scope: differentiated.scope,
        }];
        match self.apply(
            differentiated.function,
            passed,
            differentiated.call,
            differentiated.scope,
        )? {
            value @ (Value::Scalar(_) | Value::Int(_)) => {
                Ok(vec![self.as_scalar(value, differentiated.call)?])
            }
            value => self.as_components(value, differentiated.call),
        }
    }

    /// Adds the condition that the search has ended.
    fn watch_end(
        &mut self,
        ended: Flag,
        differentiated: &Differentiated<'a, '_>,
        (written, place): (Span, Span),
        [held, residuals]: [Vec<Scalar>; 2],
    ) -> Eval<()> {
        // inside of another `solve` or `slope`: the same call at the argument itself has this condition
        // already
        if self.context.unknowns > 0 {
            return Ok(());
        }
        let of_unknowns = self.dimension_at(place, differentiated.scope)?;
        let of_values = match self.type_at(written) {
            Ok(Type::Function(signature)) => each(&signature.result),
            _ => None,
        };
        let name = self.sources.text(written).to_owned();
        let mut message = Message {
            text: name.clone(),
            parts: vec![Part::Text(format!(
                "`solve` finds no zero of `{name}` near its estimate: at its last value, "
            ))],
            compared: Some(of_unknowns),
        };
        let lists = [(held, Some(of_unknowns)), (residuals, of_values)];
        for (k, (numbers, dimension)) in lists.into_iter().enumerate() {
            if k > 0 {
                message
                    .parts
                    .push(Part::Text(", the function is ".to_owned()));
            }
            for (i, value) in numbers.into_iter().enumerate() {
                if i > 0 {
                    message.parts.push(Part::Text(", ".to_owned()));
                }
                message.parts.push(Part::Value {
                    value,
                    display: match dimension {
                        Some(dimension) => self.usual_unit(dimension),
                        None => DisplayUnit::si(Dimension::ONE),
                    },
                    span: differentiated.call,
                });
            }
        }
        let Truth::Later(flag) = self.where_it_counts(Truth::Later(ended)) else {
            return Ok(());
        };
        if flag.stage == Stage::Motion {
            let condition = scalar::CallCondition {
                advise: false,
                name: String::new(),
                flag,
                message,
                span: differentiated.call,
            };
            return self.watched(condition, differentiated.call);
        }
        let mut parts = Vec::with_capacity(message.parts.len());
        for part in message.parts {
            parts.push(match part {
                Part::Text(text) => MessagePart::Text(text),
                Part::Value { value, display, .. } => MessagePart::Value(value.node, display),
            });
        }
        let holds = self.graphs.flag_number(flag);
        self.draft.checks.push(Check {
            holds,
            advise: false,
            name: String::new(),
            message: parts,
            path: self.graphs.bind.owner.clone(),
            used_at: Some(location(differentiated.call)),
            defined_at: None,
        });
        Ok(())
    }
}

/// The dimension of a number or of each number in a list.
fn each(ty: &Type) -> Option<Dimension> {
    match ty {
        Type::List { element, .. } => each(element),
        other => {
            let quantity = other.quantity()?;
            (quantity.dim.is_known()).then_some(quantity.dim.base)
        }
    }
}

/// A step of Newton's method from x.
struct Step {
    /// The next x.
    next: Vec<Node>,
    /// The values at x.
    values: Vec<Node>,
    /// The determinant of the Jacobian matrix at x, and the sum of its products' magnitudes.
    determinant: [Node; 2],
}

fn step(graph: &mut Graph, system: &NewtonSystem, x: &[Node]) -> Step {
    let source = graph.clone();
    let nodes = copy_into(
        &source,
        &system.nodes,
        graph,
        &mut |graph, index| match system.inputs.iter().position(|input| *input == index) {
            Some(unknown) => x[unknown],
            None => graph.input(index),
        },
    );
    let (values, matrix) = nodes.split_at(x.len());
    let rows: Vec<&[Node]> = matrix.chunks(x.len()).collect();
    let all = determinant(graph, &rows);
    let magnitudes: Vec<Vec<Node>> = rows
        .iter()
        .map(|row| row.iter().map(|node| graph.abs(*node)).collect())
        .collect();
    let magnitudes: Vec<&[Node]> = magnitudes.iter().map(Vec::as_slice).collect();
    let magnitudes = sum_of_products(graph, &magnitudes, Graph::add);
    let next = (0..x.len())
        .map(|k| {
            // Cramer's rule: column k is replaced by the values
            let replaced: Vec<Vec<Node>> = (rows.iter().zip(values))
                .map(|(row, value)| {
                    let mut row = row.to_vec();
                    row[k] = *value;
                    row
                })
                .collect();
            let replaced: Vec<&[Node]> = replaced.iter().map(Vec::as_slice).collect();
            let part = determinant(graph, &replaced);
            let correction = graph.divide(part, all);
            graph.subtract(x[k], correction)
        })
        .collect();
    Step {
        next,
        values: values.to_vec(),
        determinant: [all, magnitudes],
    }
}

/// The determinant of a matrix of up to three rows.
fn determinant(graph: &mut Graph, rows: &[&[Node]]) -> Node {
    sum_of_products(graph, rows, Graph::subtract)
}

/// The sum of the products of a determinant, along its first row; `odd` joins each second product of a row to the sum.
fn sum_of_products(
    graph: &mut Graph,
    rows: &[&[Node]],
    odd: fn(&mut Graph, Node, Node) -> Node,
) -> Node {
    let Some((first, rest)) = rows.split_first() else {
        return graph.constant(1.0);
    };
    let mut sum = graph.constant(0.0);
    for (k, entry) in first.iter().enumerate() {
        let minor: Vec<Vec<Node>> = (rest.iter())
            .map(|row| {
                let others = row.iter().enumerate().filter(|(j, _)| *j != k);
                others.map(|(_, node)| *node).collect()
            })
            .collect();
        let minor: Vec<&[Node]> = minor.iter().map(Vec::as_slice).collect();
        let minor = sum_of_products(graph, &minor, odd);
        let term = graph.multiply(*entry, minor);
        sum = match k % 2 {
            0 => graph.add(sum, term),
            _ => odd(graph, sum, term),
        };
    }
    sum
}
