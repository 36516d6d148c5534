//! Exact derivatives: forward, reverse, in time.
//!
//! Rules for places without a unique derivative:
//!
//! * `abs`, `min`, `max`, `select`: the derivative of the active branch. At the kink `abs` takes +1, `min`
//!   and `max` their first argument. A derivative of the other branch that is not finite does not spread:
//!   branches are chosen by `select`, never by multiplying with zero.
//! * `sqrt` and `log` at 0, and `asin` and `acos` at ±1, have an infinite slope, and `atan2` at (0, 0) has
//!   none. The result is not finite. Laws keep away from there by a floor.
//! * `power(b, e)`: the slope over b is e·power(b, e − 1), finite at b = 0 for e ≥ 1; the slope over e is
//!   power(b, e)·log b for b > 0 and taken as zero for b ≤ 0.
//! * `held` has no derivative: `solve` takes it after the last steps of its iteration.
//! * The fourth derivative of a table in one argument is zero.

use super::graph::{Graph, Node, Op};
use super::optimise::dependencies;
use eng_system::elementary::Elementary;
use eng_system::layout::{ANGULAR_VELOCITY, InputLayout, MARKER_WIDTH, ROTATION, VELOCITY};
use std::collections::BTreeMap;

/// A rate that cannot be formed.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum DifferentiateError {
    /// The value depends on an acceleration or on a state's rate.
    #[error("the rate of an acceleration is not known")]
    Acceleration,
    /// The value depends on a channel.
    #[error("the rate of another element's output is not known")]
    Signal,
    /// The value depends on a result of a field.
    #[error("the rate of a field's result is not known")]
    Field,
    /// The value depends on an input outside the layout.
    #[error("input {0} is not in the layout")]
    Input(u32),
    /// The number of rates differs from the states, or the number of loads from the markers.
    #[error("{found} values were given where {expected} are needed")]
    Count {
        /// The needed number.
        expected: usize,
        /// The given number.
        found: usize,
    },
}

/// The derivatives of an operation with respect to those of its operands that it depends on smoothly.
pub(crate) fn partials(graph: &mut Graph, node: Node) -> Vec<(Node, Node)> {
    let one = graph.constant(1.0);
    match graph.op(node) {
        Op::Input(_)
        | Op::Constant(_)
        | Op::Less(..)
        | Op::LessEqual(..)
        | Op::Equal(..)
        | Op::And(..)
        | Op::Or(..)
        | Op::Not(_)
        | Op::Elementary(Elementary::Held, _) => Vec::new(),
        Op::Add(a, b) => vec![(a, one), (b, one)],
        Op::Subtract(a, b) => {
            let minus = graph.constant(-1.0);
            vec![(a, one), (b, minus)]
        }
        Op::Multiply(a, b) => vec![(a, b), (b, a)],
        Op::Divide(a, b) => {
            let reciprocal = graph.divide(one, b);
            let slope = graph.multiply(node, reciprocal);
            let slope = graph.negate(slope);
            vec![(a, reciprocal), (b, slope)]
        }
        Op::Negate(a) => vec![(a, graph.constant(-1.0))],
        Op::Abs(a) => {
            let zero = graph.constant(0.0);
            let minus = graph.constant(-1.0);
            let negative = graph.less(a, zero);
            vec![(a, graph.select(negative, minus, one))]
        }
        Op::Sqrt(a) => {
            let half = graph.constant(0.5);
            vec![(a, graph.divide(half, node))]
        }
        Op::Minimum(a, b) => {
            let second = graph.less(b, a);
            choice(graph, second, b, a)
        }
        Op::Maximum(a, b) => {
            let second = graph.less(a, b);
            choice(graph, second, b, a)
        }
        Op::Elementary(function, a) => vec![(a, slope(graph, function, a, node))],
        Op::Atan2(y, x) => {
            let (xx, yy) = (graph.multiply(x, x), graph.multiply(y, y));
            let square = graph.add(xx, yy);
            let over_y = graph.divide(x, square);
            let over_x = graph.divide(y, square);
            vec![(y, over_y), (x, graph.negate(over_x))]
        }
        Op::Power(base, exponent) => {
            let zero = graph.constant(0.0);
            let less = graph.subtract(exponent, one);
            let power = graph.power(base, less);
            let over_base = graph.multiply(exponent, power);
            let mut list = vec![(base, over_base)];
            if graph.as_constant(exponent).is_none() {
                let positive = graph.less(zero, base);
                let log = graph.unary(Elementary::Log, base);
                let slope = graph.multiply(node, log);
                list.push((exponent, graph.select(positive, slope, zero)));
            }
            list
        }
        Op::Select(flag, then, otherwise) => choice(graph, flag, then, otherwise),
        Op::Table(handle, arguments, orders) => {
            let slope = |(k, argument): (usize, &Node)| {
                let slope = Op::Table(handle, arguments, orders.raised(k)?);
                Some((*argument, graph.push(slope)))
            };
            let list = arguments.iter().take(orders.arguments()).enumerate();
            list.filter_map(slope).collect()
        }
    }
}

/// The derivative of an elementary function at `a`, where its value is `node`.
fn slope(graph: &mut Graph, function: Elementary, a: Node, node: Node) -> Node {
    let one = graph.constant(1.0);
    match function {
        Elementary::Sin => graph.unary(Elementary::Cos, a),
        Elementary::Cos => {
            let sine = graph.unary(Elementary::Sin, a);
            graph.negate(sine)
        }
        Elementary::Tan => {
            let square = graph.multiply(node, node);
            graph.add(one, square)
        }
        Elementary::Asin | Elementary::Acos => {
            // near a corner of `acos(cos(x))` the difference 1 − cos² x has no digits left
            let root = match graph.op(a) {
                Op::Elementary(Elementary::Cos, x) => {
                    let sine = graph.unary(Elementary::Sin, x);
                    graph.abs(sine)
                }
                Op::Elementary(Elementary::Sin, x) => {
                    let cosine = graph.unary(Elementary::Cos, x);
                    graph.abs(cosine)
                }
                _ => {
                    let (below, above) = (graph.subtract(one, a), graph.add(one, a));
                    let square = graph.multiply(below, above);
                    graph.sqrt(square)
                }
            };
            let slope = graph.divide(one, root);
            match function {
                Elementary::Asin => slope,
                _ => graph.negate(slope),
            }
        }
        Elementary::Atan => {
            let square = graph.multiply(a, a);
            let sum = graph.add(one, square);
            graph.divide(one, sum)
        }
        Elementary::Tanh => {
            let (below, above) = (graph.subtract(one, node), graph.add(one, node));
            graph.multiply(below, above)
        }
        Elementary::Exp => node,
        Elementary::Log => graph.divide(one, a),
        Elementary::Held => graph.constant(0.0),
    }
}

/// Slopes of `select(flag, then, otherwise)`.
fn choice(graph: &mut Graph, flag: Node, then: Node, otherwise: Node) -> Vec<(Node, Node)> {
    let (zero, one) = (graph.constant(0.0), graph.constant(1.0));
    vec![
        (then, graph.select(flag, one, zero)),
        (otherwise, graph.select(flag, zero, one)),
    ]
}

/// Whether a slope may be zero by the choice of a branch. Such a zero must remain zero in every product.
fn is_guarded(graph: &Graph, node: Node, depth: u32) -> bool {
    // no law has a guard this deep; without it the result is still exact if all branches are finite
    if depth == 0 {
        return false;
    }
    let zero_or_guarded = |n| graph.as_constant(n) == Some(0.0) || is_guarded(graph, n, depth - 1);
    match graph.op(node) {
        Op::Select(_, a, b) => zero_or_guarded(a) || zero_or_guarded(b),
        Op::Negate(a) => is_guarded(graph, a, depth - 1),
        Op::Add(a, b) | Op::Subtract(a, b) => {
            is_guarded(graph, a, depth - 1) && is_guarded(graph, b, depth - 1)
        }
        _ => false,
    }
}

/// Most operations between a slope and the selection that may make it zero. The laws of the library have
/// fewer. A choice: a deeper search costs time at each product, and beyond the limit a branch that is not
/// selected may bring NaN into a slope.
const GUARD_DEPTH: u32 = 12;

/// Product of slopes in which the zero of an unselected branch has priority over infinity and NaN.
pub(crate) fn guarded_multiply(graph: &mut Graph, a: Node, b: Node) -> Node {
    if is_guarded(graph, a, GUARD_DEPTH) {
        distribute(graph, a, b)
    } else if is_guarded(graph, b, GUARD_DEPTH) {
        distribute(graph, b, a)
    } else {
        graph.multiply(a, b)
    }
}

fn distribute(graph: &mut Graph, guarded: Node, factor: Node) -> Node {
    match graph.op(guarded) {
        Op::Select(flag, a, b) => {
            let a = zero_or_product(graph, a, factor);
            let b = zero_or_product(graph, b, factor);
            graph.select(flag, a, b)
        }
        Op::Negate(a) => {
            let product = guarded_multiply(graph, a, factor);
            graph.negate(product)
        }
        Op::Add(a, b) => {
            let a = guarded_multiply(graph, a, factor);
            let b = guarded_multiply(graph, b, factor);
            graph.add(a, b)
        }
        Op::Subtract(a, b) => {
            let a = guarded_multiply(graph, a, factor);
            let b = guarded_multiply(graph, b, factor);
            graph.subtract(a, b)
        }
        _ => graph.multiply(guarded, factor),
    }
}

fn zero_or_product(graph: &mut Graph, a: Node, factor: Node) -> Node {
    if graph.as_constant(a) == Some(0.0) {
        a
    } else {
        guarded_multiply(graph, a, factor)
    }
}

/// Sum of slopes. Two selections by one flag become one.
pub(crate) fn guarded_add(graph: &mut Graph, a: Node, b: Node) -> Node {
    if let (Op::Select(f, a1, a2), Op::Select(g, b1, b2)) = (graph.op(a), graph.op(b))
        && f == g
        && is_guarded(graph, a, GUARD_DEPTH)
        && is_guarded(graph, b, GUARD_DEPTH)
    {
        let then = guarded_add(graph, a1, b1);
        let otherwise = guarded_add(graph, a2, b2);
        return graph.select(f, then, otherwise);
    }
    graph.add(a, b)
}

/// Directional derivatives of nodes. `seeds` gives the derivative of an input; `None` is zero. Only nodes
/// that depend on a seeded input are differentiated.
pub fn forward(
    graph: &mut Graph,
    outputs: &[Node],
    seeds: &dyn Fn(u32) -> Option<Node>,
) -> Vec<Node> {
    let needed = dependencies(graph, outputs);
    let mut tangents: Vec<Option<Node>> = vec![None; needed.len()];
    for index in 0..needed.len() {
        if !needed[index] {
            continue;
        }
        let node = Node(index as u32);
        let of = |n: Node| tangents[n.0 as usize];
        let op = graph.op(node);
        tangents[index] = match op {
            Op::Input(i) => seeds(i),
            Op::Select(flag, a, b) => chosen(graph, |_| flag, of(a), of(b)),
            Op::Minimum(a, b) => chosen(graph, |g| g.less(b, a), of(b), of(a)),
            Op::Maximum(a, b) => chosen(graph, |g| g.less(a, b), of(b), of(a)),
            op if op.operands().all(|n| of(n).is_none()) => None,
            _ => {
                let mut sum: Option<Node> = None;
                for (operand, slope) in partials(graph, node) {
                    let Some(tangent) = tangents[operand.0 as usize] else {
                        continue;
                    };
                    let term = guarded_multiply(graph, slope, tangent);
                    sum = Some(match sum {
                        Some(sum) => graph.add(sum, term),
                        None => term,
                    });
                }
                sum
            }
        };
    }
    let zero = graph.constant(0.0);
    outputs
        .iter()
        .map(|n| tangents[n.0 as usize].unwrap_or(zero))
        .collect()
}

fn chosen(
    graph: &mut Graph,
    flag: impl FnOnce(&mut Graph) -> Node,
    then: Option<Node>,
    otherwise: Option<Node>,
) -> Option<Node> {
    if then.is_none() && otherwise.is_none() {
        return None;
    }
    let zero = graph.constant(0.0);
    let flag = flag(graph);
    Some(graph.select(flag, then.unwrap_or(zero), otherwise.unwrap_or(zero)))
}

/// Derivatives of one node with respect to several inputs, in one reverse sweep.
pub fn gradient(graph: &mut Graph, output: Node, inputs: &[u32]) -> Vec<Node> {
    let zero = graph.constant(0.0);
    let count = output.0 as usize + 1;
    // a node is active if it depends on one of the inputs
    let mut active = vec![false; count];
    for index in 0..count {
        active[index] = match graph.op(Node(index as u32)) {
            Op::Input(i) => inputs.contains(&i),
            op => op.operands().any(|n| active[n.0 as usize]),
        };
    }
    let mut adjoints: Vec<Option<Node>> = vec![None; count];
    adjoints[output.0 as usize] = Some(graph.constant(1.0));
    let mut of_input: BTreeMap<u32, Node> = BTreeMap::new();
    for index in (0..count).rev() {
        let Some(adjoint) = adjoints[index].filter(|_| active[index]) else {
            continue;
        };
        let node = Node(index as u32);
        if let Op::Input(i) = graph.op(node) {
            let sum = match of_input.get(&i) {
                Some(before) => guarded_add(graph, *before, adjoint),
                None => adjoint,
            };
            of_input.insert(i, sum);
            continue;
        }
        for (operand, slope) in partials(graph, node) {
            let place = operand.0 as usize;
            if !active[place] {
                continue;
            }
            let term = guarded_multiply(graph, slope, adjoint);
            adjoints[place] = Some(match adjoints[place] {
                Some(sum) => guarded_add(graph, sum, term),
                None => term,
            });
        }
    }
    inputs
        .iter()
        .map(|i| of_input.get(i).copied().unwrap_or(zero))
        .collect()
}

/// The rates of velocities in a time derivative.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Accelerations {
    /// The acceleration inputs.
    Inputs,
    /// Zero, which leaves the part quadratic in velocities.
    Zero,
}

/// Rates along the motion: time runs at 1, x at ẋ, R at R ω~ (ω in marker axes), velocities at the
/// acceleration inputs, states at `rates` or else at their rate inputs, constants at `changing` by their
/// inputs. Rotation references, other constants and multipliers are constant.
pub fn time_derivative(
    graph: &mut Graph,
    layout: &InputLayout,
    nodes: &[Node],
    rates: Option<&[Node]>,
    changing: &BTreeMap<u32, Node>,
) -> Result<Vec<Node>, DifferentiateError> {
    time_derivative_with(
        graph,
        layout,
        nodes,
        (rates, changing),
        Accelerations::Inputs,
    )
}

pub(crate) fn time_derivative_with(
    graph: &mut Graph,
    layout: &InputLayout,
    nodes: &[Node],
    (rates, changing): (Option<&[Node]>, &BTreeMap<u32, Node>),
    accelerations: Accelerations,
) -> Result<Vec<Node>, DifferentiateError> {
    if let Some(rates) = rates
        && rates.len() != layout.states as usize
    {
        return Err(DifferentiateError::Count {
            expected: layout.states as usize,
            found: rates.len(),
        });
    }
    let mut seeds: BTreeMap<u32, Node> = BTreeMap::new();
    for input in inputs_of(graph, nodes) {
        let seed = match Place::of(layout, input) {
            Place::Time => Some(graph.constant(1.0)),
            Place::Position { marker, axis } => {
                Some(graph.input(layout.marker(marker) + VELOCITY + axis))
            }
            Place::Orientation {
                marker,
                row,
                column,
            } => Some(turned_entry(
                graph,
                layout,
                marker,
                row,
                column,
                layout.marker(marker) + ANGULAR_VELOCITY,
            )),
            Place::Velocity { marker, axis } => match accelerations {
                Accelerations::Inputs => Some(graph.input(layout.acceleration(marker) + axis)),
                Accelerations::Zero => None,
            },
            Place::State(state) => match rates {
                Some(rates) => Some(rates[state as usize]),
                None => Some(graph.input(layout.state_rate(state))),
            },
            Place::Fixed => changing.get(&input).copied(),
            Place::Answer(_) | Place::Reading(_) => return Err(DifferentiateError::Field),
            Place::Acceleration => return Err(DifferentiateError::Acceleration),
            Place::Signal(_) => return Err(DifferentiateError::Signal),
            Place::Outside => return Err(DifferentiateError::Input(input)),
        };
        if let Some(seed) = seed {
            seeds.insert(input, seed);
        }
    }
    Ok(forward(graph, nodes, &|i| seeds.get(&i).copied()))
}

/// An entry of R p~, where p are three inputs from `first` on.
fn turned_entry(
    graph: &mut Graph,
    layout: &InputLayout,
    marker: u32,
    row: u32,
    column: u32,
    first: u32,
) -> Node {
    // column j of R p~ is R (p × e_j): p₂ R₁ − p₁ R₂ for j = 0 with the columns R₁ and R₂ of R, and
    // cyclically
    let (next, last) = ((column + 1) % 3, (column + 2) % 3);
    let orientation = layout.marker(marker) + ROTATION + 3 * row;
    let a = graph.input(orientation + next);
    let b = graph.input(orientation + last);
    let p = graph.input(first + last);
    let q = graph.input(first + next);
    let ap = graph.multiply(a, p);
    let bq = graph.multiply(b, q);
    graph.subtract(ap, bq)
}

/// The inputs that nodes depend on, ascending.
pub(crate) fn inputs_of(graph: &Graph, nodes: &[Node]) -> Vec<u32> {
    let needed = dependencies(graph, nodes);
    let mut inputs: Vec<u32> = graph
        .nodes()
        .iter()
        .zip(&needed)
        .filter_map(|(op, needed)| match op {
            Op::Input(i) if *needed => Some(*i),
            _ => None,
        })
        .collect();
    inputs.sort_unstable();
    inputs.dedup();
    inputs
}

/// Whether nodes depend on accelerations or state rates.
pub fn uses_acceleration(graph: &Graph, nodes: &[Node], layout: &InputLayout) -> bool {
    inputs_of(graph, nodes)
        .into_iter()
        .any(|i| Place::of(layout, i) == Place::Acceleration)
}

/// Whether nodes depend on the results of fields; with `readings`, on their readings alone.
pub(crate) fn uses_fields(
    graph: &Graph,
    nodes: &[Node],
    layout: &InputLayout,
    readings: bool,
) -> bool {
    inputs_of(graph, nodes)
        .into_iter()
        .any(|i| match Place::of(layout, i) {
            Place::Answer(_) => !readings,
            Place::Reading(_) => true,
            _ => false,
        })
}

/// Whether a node depends on an input of a wanted kind.
pub(crate) fn reads(
    graph: &Graph,
    node: Node,
    layout: &InputLayout,
    wanted: impl Fn(Place) -> bool,
) -> bool {
    inputs_of(graph, &[node])
        .into_iter()
        .any(|i| wanted(Place::of(layout, i)))
}

/// Whether nodes depend on inputs that only outputs have: accelerations, rates of states, multipliers,
/// channels of other elements.
pub(crate) fn known_in_outputs_only(graph: &Graph, nodes: &[Node], layout: &InputLayout) -> bool {
    let multipliers = layout.multiplier(0)..layout.multiplier(layout.rows);
    inputs_of(graph, nodes)
        .into_iter()
        .any(|i| multipliers.contains(&i) || i >= layout.len())
}

/// The kind of an input of a layout.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Place {
    Time,
    Position {
        marker: u32,
        axis: u32,
    },
    Orientation {
        marker: u32,
        row: u32,
        column: u32,
    },
    /// Axes 0…2 are ẋ, 3…5 are ω.
    Velocity {
        marker: u32,
        axis: u32,
    },
    State(u32),
    /// An answer of a field.
    Answer(u32),
    /// A reading of a field.
    Reading(u32),
    /// Multipliers, rotation references, constants.
    Fixed,
    /// Accelerations and state rates.
    Acceleration,
    /// A channel of another element.
    Signal(u32),
    Outside,
}

impl Place {
    pub(crate) fn of(layout: &InputLayout, input: u32) -> Place {
        if input == InputLayout::TIME {
            return Place::Time;
        }
        if input < layout.state(0) {
            let (marker, component) = ((input - 1) / MARKER_WIDTH, (input - 1) % MARKER_WIDTH);
            return match component {
                0..ROTATION => Place::Position {
                    marker,
                    axis: component,
                },
                ROTATION..VELOCITY => Place::Orientation {
                    marker,
                    row: (component - ROTATION) / 3,
                    column: (component - ROTATION) % 3,
                },
                _ => Place::Velocity {
                    marker,
                    axis: component - VELOCITY,
                },
            };
        }
        if input < layout.multiplier(0) {
            Place::State(input - layout.state(0))
        } else if (layout.answer(0)..layout.reading(0)).contains(&input) {
            Place::Answer(input - layout.answer(0))
        } else if (layout.reading(0)..layout.constant(0)).contains(&input) {
            Place::Reading(input - layout.reading(0))
        } else if input < layout.len() {
            Place::Fixed
        } else if input < layout.signal(0) {
            Place::Acceleration
        } else if input < layout.outputs_len() {
            Place::Signal(input - layout.signal(0))
        } else {
            Place::Outside
        }
    }
}
