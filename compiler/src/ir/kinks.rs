//! The kink functions of a class: where its loads and the rates of its states are not smooth.
//!
//! A value has a kink where a comparison changes, where the arguments of `min` or `max` are equal, where the
//! argument of `abs` is zero, and at an end of a table of one argument. Each of these is a function of the
//! motion that changes its sign at the kink. The functions come from the graph of the loads. So a kink counts in
//! the text of the class, of a function that it calls, and of a library. A function of constants alone never
//! changes and does not count. A constant that follows an input between two points of time changes.
//!
//! An operation on parameters alone is no part of this graph, because the class reads its value as a constant. If such a
//! value follows an input, the element has the kink function and its rate as two more constants ([`BoundKink`]).

use super::differentiate::{
    Accelerations, DifferentiateError, Place, inputs_of, known_in_outputs_only,
    time_derivative_with, uses_fields,
};
use super::graph::{Function, Graph, Node, Op};
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

/// The kink functions of a class.
#[derive(Clone, Debug, Default)]
pub(crate) struct Kinks {
    /// The operation of each function of the motion. Those of constants follow, in the order of the class.
    pub places: Vec<KinkPlace>,
    /// Whether each is the argument of a table.
    pub tables: Vec<bool>,
    /// Values, rates, and the handles of tables (−1 for others).
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

/// Finds the kink functions that loads and rates depend on, and adds their rates to the graph. The rate of a
/// state is that of the class; `changing` gives the rates of constants that follow inputs, by their inputs.
pub(crate) fn find(
    graph: &mut Graph,
    layout: &InputLayout,
    loads: &[Node],
    (rates, changing): (&[Node], &BTreeMap<u32, Node>),
    (turns, bound): (&[Node], &[BoundKink]),
) -> Result<Kinks, DifferentiateError> {
    let watched: Vec<Node> = loads.iter().chain(rates).copied().collect();
    let needed = smoothly_needed(graph, &watched);
    let operations: Vec<(Node, Op)> = (0..)
        .map(Node)
        .zip(graph.nodes().iter().copied())
        .zip(&needed)
        .filter_map(|(found, needed)| (*needed && !turns.contains(&found.0)).then_some(found))
        .collect();
    let nowhere = graph.constant(-1.0);
    let mut kinks = Kinks::default();
    let mut values: Vec<Node> = Vec::new();
    let mut handles = Vec::new();
    for (node, op) in operations {
        let Some((value, handle)) = function_of(graph, op) else {
            continue;
        };
        let handle = handle.unwrap_or(nowhere);
        let known = values
            .iter()
            .zip(&handles)
            .any(|known| known == (&value, &handle));
        if known
            || !moves(graph, layout, value, changing)
            || known_in_outputs_only(graph, &[value], layout)
            // the answers of a field have no known rate
            || uses_fields(graph, &[value], layout, false)
        {
            continue;
        }
        kinks.places.push(KinkPlace { node, argument: 0 });
        kinks.tables.push(handle != nowhere);
        values.push(value);
        handles.push(handle);
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
    for kink in bound {
        let mut constant = |index: u32| graph.input(layout.constant(index));
        values.push(constant(kink.value));
        slopes.push(constant(kink.rate));
        handles.push(kink.table.map_or(nowhere, constant));
        kinks.tables.push(kink.table.is_some());
    }
    kinks.outputs = values.into_iter().chain(slopes).chain(handles).collect();
    Ok(kinks)
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
