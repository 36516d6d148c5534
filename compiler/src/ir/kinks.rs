//! The kink functions of a class: where its loads, the rates of its states and its constraints are not smooth.
//!
//! A value has a kink where a comparison changes, where the arguments of `min` or `max` are equal, where the
//! argument of `abs` is zero, and at an end of a table of one argument. Each of these is a function of the
//! motion that changes its sign at the kink. The functions come from the graph of loads and constraints. So a kink
//! counts in the text of the class, of a function that it calls, and of a library. A function of constants alone
//! never changes and does not count. A constant that follows an input between two points of time changes.
//!
//! A kink in a branch that is not selected changes nothing. So each function has a number that is 1 while the value
//! of its operation is used, and 0 while each `if` on the way selects another branch. `min` and `max` use both arguments, because their own kink
//! depends on both.
//!
//! An operation on parameters alone is no part of this graph, because the class reads its value as a constant. If such a
//! value follows an input, the element has the kink function and its rate as two more constants ([`BoundKink`]).

use super::differentiate::{
    Accelerations, DifferentiateError, Place, inputs_of, known_in_outputs_only,
    time_derivative_with, uses_fields,
};
use super::graph::{Function, Graph, Node, Op};
use super::optimise::dependencies;
use eng_system::elementary::Elementary;
use eng_system::layout::InputLayout;
use std::collections::BTreeMap;

/// An operation with a kink, and which of its arguments this is; zero for all but tables.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct KinkPlace {
    /// A comparison, a minimum, a maximum, an amount or a table's value.
    pub node: Node,
    /// The argument of a table.
    pub argument: u8,
}

/// A kink of a constant that follows inputs: indices of constants of the class.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BoundKink {
    /// The function that changes its sign.
    pub value: u32,
    /// Its rate.
    pub rate: u32,
    /// The handle of the table whose argument the function is.
    pub table: Option<u32>,
}

/// The kind of a kink function.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct KinkKind {
    /// It is the argument of a table.
    pub table: bool,
    /// Constraints depend on it.
    pub constrains: bool,
    /// It jumps by a whole period where a `wrapped` angle begins anew.
    pub wraps: bool,
}

/// The kink functions of a class.
#[derive(Clone, Debug, Default)]
pub(crate) struct Kinks {
    /// The operation of each function of the motion. Those of constants follow, in the order of the class.
    pub places: Vec<KinkPlace>,
    /// The kind of each.
    pub kinds: Vec<KinkKind>,
    /// Values, rates, the handles of tables (−1 for others), and 1 where the operation is used, else 0.
    pub outputs: Vec<Node>,
    /// Whether the rates depend on accelerations.
    pub reads_accelerations: bool,
}

/// The function that changes its sign at the kink of an operation, and the handle of its table.
pub(crate) fn function_of(graph: &mut Graph, op: Op) -> Option<(Node, Option<Node>)> {
    match op {
        Op::Less(a, b) | Op::LessEqual(a, b) => Some((graph.subtract(b, a), None)),
        Op::Minimum(a, b) | Op::Maximum(a, b) => Some((graph.subtract(a, b), None)),
        Op::Abs(a) => Some((a, None)),
        // an equation holds at single moments, or where another kink begins: it changes no sign
        // tables of several arguments are charts of laws, which a motion leaves seldom: their ends cost more
        // than the law itself
        Op::Table(handle, arguments, orders) if orders.arguments() == 1 => {
            Some((arguments[0], Some(handle)))
        }
        _ => None,
    }
}

/// Finds the kink functions that constraints, loads and rates depend on, and adds their rates to the graph. The rate of a
/// state is that of the class; `changing` gives the rates of constants that follow inputs, by their inputs.
pub(crate) fn find(
    graph: &mut Graph,
    layout: &InputLayout,
    (rows, loads): (&[Node], &[Node]),
    (rates, changing): (&[Node], &BTreeMap<u32, Node>),
    (turns, wraps, bound): (&[Node], &[(Node, Node)], &[BoundKink]),
) -> Result<Kinks, DifferentiateError> {
    let watched: Vec<Node> = rows.iter().chain(loads).chain(rates).copied().collect();
    let count = graph.nodes().len();
    let used = uses(graph, &watched);
    let of_rows = smoothly_needed(graph, rows);
    let nowhere = graph.constant(-1.0);
    let mut kinks = Kinks::default();
    let mut values: Vec<Node> = Vec::new();
    let mut handles = Vec::new();
    let mut active: Vec<Node> = Vec::new();
    for node in (0..count as u32).map(Node) {
        let Some(used) = used[node.0 as usize].filter(|_| !turns.contains(&node)) else {
            continue;
        };
        let Some((value, handle)) = function_of(graph, graph.op(node)) else {
            continue;
        };
        let handle = handle.unwrap_or(nowhere);
        let constrains = of_rows[node.0 as usize];
        let mut pairs = values.iter().zip(&handles);
        if let Some(known) = pairs.position(|known| known == (&value, &handle)) {
            active[known] = either(graph, Some(active[known]), used);
            kinks.kinds[known].constrains |= constrains;
            continue;
        }
        if !moves(graph, layout, value, changing)
            || known_in_outputs_only(graph, &[value], layout)
            // the answers of a field have no known rate
            || uses_fields(graph, &[value], layout, false)
        {
            continue;
        }
        kinks.places.push(KinkPlace { node, argument: 0 });
        let parts = dependencies(graph, &[value]);
        kinks.kinds.push(KinkKind {
            table: handle != nowhere,
            constrains,
            // a count of turns is a sum of chosen constants
            wraps: (turns.iter())
                .any(|turn| parts[turn.0 as usize] && matches!(graph.op(*turn), Op::Select(..))),
        });
        values.push(value);
        handles.push(handle);
        active.push(used);
    }
    // where a `wrapped` angle begins anew, a constraint must not jump
    for (wrapped, value) in wraps {
        let Some(used) = used[wrapped.0 as usize].filter(|_| of_rows[wrapped.0 as usize]) else {
            continue;
        };
        let node = *wrapped;
        kinks.places.push(KinkPlace { node, argument: 0 });
        kinks.kinds.push(KinkKind {
            constrains: true,
            ..KinkKind::default()
        });
        values.push(*value);
        handles.push(nowhere);
        active.push(used);
    }
    if values.is_empty() && bound.is_empty() {
        return Ok(kinks);
    }
    let mut slopes = time_derivative_with(
        graph,
        layout,
        &values,
        (Some(rates), changing),
        Accelerations::Inputs,
    )?;
    kinks.reads_accelerations = inputs_of(graph, &slopes)
        .into_iter()
        .any(|input| Place::of(layout, input) == Place::Acceleration);
    let always = graph.constant(1.0);
    for kink in bound {
        let mut constant = |index: u32| graph.input(layout.constant(index));
        values.push(constant(kink.value));
        slopes.push(constant(kink.rate));
        handles.push(kink.table.map_or(nowhere, constant));
        active.push(always);
        kinks.kinds.push(KinkKind {
            table: kink.table.is_some(),
            ..KinkKind::default()
        });
    }
    let outputs = values.into_iter().chain(slopes).chain(handles);
    kinks.outputs = outputs.chain(active).collect();
    Ok(kinks)
}

/// For each operation a number that is 1 while values depend on it by the branches that `if` selects, else 0.
/// `None`: they never depend on it, or only through `held`, which passes no change on.
fn uses(graph: &mut Graph, watched: &[Node]) -> Vec<Option<Node>> {
    let (zero, one) = (graph.constant(0.0), graph.constant(1.0));
    let mut uses: Vec<Option<Node>> = vec![None; graph.nodes().len()];
    for node in watched {
        uses[node.0 as usize] = Some(one);
    }
    for index in (0..uses.len()).rev() {
        let Some(used) = uses[index] else {
            continue;
        };
        let mut pass = |graph: &mut Graph, to: Node, share: Node| {
            let place = to.0 as usize;
            uses[place] = Some(either(graph, uses[place], share));
        };
        let (flag, then, otherwise) = match graph.op(Node(index as u32)) {
            Op::Elementary(Elementary::Held, _) => continue,
            Op::Select(flag, then, otherwise) => {
                pass(graph, flag, used);
                (flag, then, otherwise)
            }
            op => {
                for operand in op.operands() {
                    pass(graph, operand, used);
                }
                continue;
            }
        };
        let share = graph.select(flag, used, zero);
        pass(graph, then, share);
        let share = graph.select(flag, zero, used);
        pass(graph, otherwise, share);
    }
    uses
}

/// The larger one of two numbers that are 0 or 1.
fn either(graph: &mut Graph, a: Option<Node>, b: Node) -> Node {
    let certain = |graph: &Graph, x: Node| graph.as_constant(x) == Some(1.0);
    match a {
        None => b,
        Some(a) if a == b || certain(graph, a) => a,
        Some(_) if certain(graph, b) => b,
        Some(a) => graph.maximum(a, b),
    }
}

/// The operations that values depend on, without those of iterations: `held` passes no change on.
pub(crate) fn smoothly_needed(graph: &Graph, watched: &[Node]) -> Vec<bool> {
    let mut needed = vec![false; graph.nodes().len()];
    for node in watched {
        needed[node.0 as usize] = true;
    }
    for (index, op) in graph.nodes().iter().enumerate().rev() {
        if needed[index] && !matches!(op, Op::Elementary(Elementary::Held, _)) {
            for operand in op.operands() {
                needed[operand.0 as usize] = true;
            }
        }
    }
    needed
}

/// Whether a value depends on the motion, on time or on a constant that changes.
fn moves(graph: &Graph, layout: &InputLayout, value: Node, changing: &BTreeMap<u32, Node>) -> bool {
    inputs_of(graph, &[value]).into_iter().any(|input| {
        changing.contains_key(&input)
            || matches!(
                Place::of(layout, input),
                Place::Time
                    | Place::Position { .. }
                    | Place::Orientation { .. }
                    | Place::Velocity { .. }
                    | Place::State(_)
            )
    })
}

impl Kinks {
    /// The function of the class's code.
    pub fn function(&self, class: &str, layout: &InputLayout, graph: &Graph) -> Function {
        Function {
            name: format!("{class}.kinks"),
            inputs: if self.reads_accelerations {
                layout.outputs_len()
            } else {
                layout.len()
            },
            graph: graph.clone(),
            outputs: self.outputs.clone(),
        }
    }
}
