//! The kink functions of a class: where its loads, the rates of its states and its constraints are not smooth.
//!
//! A value has a kink where a comparison changes, where the arguments of `min` or `max` are equal, where the argument
//! of `abs` is zero, at points of a table, in constraints at the cut of `atan2`, and where `acos(cos(x))` or
//! `asin(sin(x))` turns back. For each of these there is a function of the motion that changes its sign at the kink.
//! The functions come from the graph of loads and constraints. So a kink counts in the text of the class, of a
//! function that it calls, and of a library. A function of constants alone never changes and does not count, except
//! where a constant follows an input between two points of time.
//!
//! Which points of a table are kinks depends on its numbers, so the runtime finds them. The kink function is the argument of
//! the table, and [`TableKink`] states the smoothness that the table must have there.
//!
//! A kink in a branch that is not selected changes nothing. So each function has a number that is 1 while the value
//! of its operation is used, and 0 while each `if` on the way selects another branch. `min` and `max` use
//! both arguments, because their own kink depends on both.
//!
//! An operation on parameters alone is no part of this graph, because the class reads its value as a
//! constant. If such a value follows an input, the element has the kink function and its rate as two more
//! constants ([`BoundKink`]).

use super::differentiate::{
    Accelerations, DifferentiateError, Place, inputs_of, known_in_outputs_only,
    time_derivative_with, uses_fields,
};
use super::graph::{Function, Graph, Node, Op};
use super::look_up::Orders;
use super::optimise::{dependencies, dependencies_through};
use eng_system::elementary::Elementary;
use eng_system::layout::InputLayout;
use eng_system::system::{Course, TableKink};
use std::collections::BTreeMap;

/// Highest derivative of a load that must be continuous. Without it the load bends.
const OF_LOADS: u8 = 1;
/// Highest derivative of a constraint that must be continuous. Without it the required acceleration jumps.
const OF_CONSTRAINTS: u8 = 2;

/// An operation with a kink. For a table also the index of the argument, else zero.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct KinkPlace {
    /// A comparison, a minimum, a maximum, an absolute value, an angle or a table's value.
    pub node: Node,
    /// The argument of a table.
    pub argument: u8,
}

/// A kink of a constant that follows inputs: indices of constants of the class.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BoundKink {
    /// The function that changes its sign.
    pub value: u32,
    /// The function's rate.
    pub rate: u32,
    /// The constant with the handle of the table whose argument the function is.
    pub table: Option<(u32, TableKink)>,
}

/// The kind of a kink function.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct KinkKind {
    /// It is the argument of a table.
    pub table: Option<TableKink>,
    /// Constraints depend on it.
    pub constrains: bool,
    /// It jumps where an angle begins anew: one of `wrapped`, or one of `atan2` at its cut.
    pub wraps: bool,
    /// It is zero where such an angle begins anew.
    pub cut: bool,
    /// The quantities on which it depends.
    pub course: Course,
}

/// The kink functions of a class.
#[derive(Clone, Debug, Default)]
pub(crate) struct Kinks {
    /// The operation of each function of the motion. Those of constants follow, in the order of the class.
    pub places: Vec<KinkPlace>,
    /// The kind of each.
    pub kinds: Vec<KinkKind>,
    /// For all functions: their values; their rates; the handles of their tables (−1 without one); 1 where the
    /// operation is used, else 0. Then the rates of the arguments of sines in functions of the motion.
    pub outputs: Vec<Node>,
    /// Number of these arguments.
    pub phases: u32,
    /// Whether the rates depend on accelerations.
    pub reads_accelerations: bool,
}

/// A function that changes its sign at the kink of an operation, or the argument of a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct KinkFunction {
    /// Its value.
    pub value: Node,
    /// The handle of the table, and the orders of the look-up.
    pub table: Option<(Node, TableKink)>,
    /// It has a kink only while this number is negative.
    pub below: Option<Node>,
}

/// The kink functions of an operation. A table has one for each argument, with the derivatives that loads need.
pub(crate) fn functions_of(graph: &mut Graph, op: Op) -> Vec<KinkFunction> {
    let mut below = None;
    let value = match op {
        // `==` holds at single moments only, so its difference changes no sign that matters
        Op::Less(a, b) | Op::LessEqual(a, b) => graph.subtract(b, a),
        Op::Minimum(a, b) | Op::Maximum(a, b) => graph.subtract(a, b),
        Op::Abs(a) => a,
        // the cut is the half-plane x < 0 of y = 0
        Op::Atan2(y, x) => {
            below = Some(x);
            y
        }
        // a triangular wave, whose corners are where the argument is ±1
        Op::Elementary(Elementary::Acos | Elementary::Asin, of) => match graph.op(of) {
            Op::Elementary(Elementary::Cos, x) => graph.unary(Elementary::Sin, x),
            Op::Elementary(Elementary::Sin, x) => graph.unary(Elementary::Cos, x),
            _ => return Vec::new(),
        },
        Op::Table(handle, arguments, orders) => {
            let each = arguments.iter().zip(orders.each()).enumerate();
            let function = |(k, (value, order)): (usize, (&Node, &u8))| KinkFunction {
                value: *value,
                table: Some((
                    handle,
                    TableKink {
                        argument: k as u8,
                        smooth: order + OF_LOADS,
                    },
                )),
                below: None,
            };
            return each.map(function).collect();
        }
        _ => return Vec::new(),
    };
    vec![KinkFunction {
        value,
        table: None,
        below,
    }]
}

/// The operation whose text names a kink. For a derivative of a table it is the look-up of the value, if the text has
/// one.
fn named(graph: &Graph, node: Node) -> Node {
    match graph.op(node) {
        Op::Table(handle, arguments, orders) => {
            let value = Op::Table(handle, arguments, Orders::of_value(orders.arguments()));
            graph.known(&value).unwrap_or(node)
        }
        _ => node,
    }
}

/// The kink functions found so far, in their order.
#[derive(Default)]
struct Found {
    places: Vec<KinkPlace>,
    kinds: Vec<KinkKind>,
    values: Vec<Node>,
    /// Handles of tables; −1 for others.
    handles: Vec<Node>,
    /// 1 where the operation is used, else 0.
    active: Vec<Node>,
}

impl Found {
    fn add(&mut self, (place, kind): (KinkPlace, KinkKind), [value, handle, used]: [Node; 3]) {
        self.places.push(place);
        self.kinds.push(kind);
        self.values.push(value);
        self.handles.push(handle);
        self.active.push(used);
    }

    /// Merges equal functions of two operations. The result counts where either counts, and has the stricter
    /// requirement. `false` if no known function is equal.
    fn join(
        &mut self,
        graph: &mut Graph,
        (place, kind): (KinkPlace, KinkKind),
        [value, handle, used]: [Node; 3],
    ) -> bool {
        let mut known = (self.values.iter().zip(&self.handles)).zip(&self.places);
        let Some(known) = known.position(|((its_value, its_handle), its_place)| {
            *its_value == value && *its_handle == handle && its_place.argument == place.argument
        }) else {
            return false;
        };
        self.active[known] = either(graph, Some(self.active[known]), used);
        let known = &mut self.kinds[known];
        known.constrains |= kind.constrains;
        known.cut |= kind.cut;
        if let (Some(known), Some(table)) = (&mut known.table, kind.table) {
            known.smooth = known.smooth.max(table.smooth);
        }
        true
    }
}

/// Finds the kink functions that constraints, loads and rates depend on, and adds their rates to the graph.
/// The rate of a state is that of the class; `changing` gives the rates of constants that follow inputs, by
/// their inputs.
pub(crate) fn find(
    graph: &mut Graph,
    layout: &InputLayout,
    (rows, loads): (&[Node], &[Node]),
    (rates, changing): (&[Node], &BTreeMap<u32, Node>),
    (turns, wraps, bound): (&[Node], &[(Node, Node)], &[BoundKink]),
) -> Result<Kinks, DifferentiateError> {
    let watched: Vec<Node> = rows.iter().chain(loads).chain(rates).copied().collect();
    let used = uses(graph, &watched);
    let of_rows = smoothly_needed(graph, rows);
    let (nowhere, zero) = (graph.constant(-1.0), graph.constant(0.0));
    let mut found = Found::default();
    for (index, used) in used.iter().enumerate() {
        let node = Node(index as u32);
        let Some(used) = used.filter(|_| !turns.contains(&node)) else {
            continue;
        };
        let constrains = of_rows[index];
        let op = graph.op(node);
        for function in functions_of(graph, op) {
            let used = match function.below {
                // `add_cuts` adds the cut of a load, which counts only where a condition on the angle changes
                Some(_) if !constrains => continue,
                Some(below) => {
                    let cut = graph.less(below, zero);
                    graph.select(cut, used, zero)
                }
                None => used,
            };
            if used == zero {
                continue;
            }
            let more = if constrains {
                OF_CONSTRAINTS - OF_LOADS
            } else {
                0
            };
            let table = function.table.map(|(_, kind)| TableKink {
                smooth: kind.smooth + more,
                ..kind
            });
            let value = function.value;
            let place = KinkPlace {
                node: named(graph, node),
                argument: table.map_or(0, |kind| kind.argument),
            };
            let kind = KinkKind {
                table,
                constrains,
                cut: function.below.is_some(),
                ..KinkKind::default()
            };
            let handle = function.table.map_or(nowhere, |(handle, _)| handle);
            if found.join(graph, (place, kind), [value, handle, used])
                || !changes(graph, layout, value, changing)
            {
                continue;
            }
            let course = course(graph, layout, value, changing);
            let kind = KinkKind {
                wraps: !course.is_of_time() && jumps_with_angles(graph, value, turns),
                course,
                ..kind
            };
            found.add((place, kind), [value, handle, used]);
        }
    }
    add_cuts(
        graph,
        layout,
        &mut found,
        (&used, &of_rows),
        (wraps, changing),
    );
    with_rates(graph, layout, found, (rates, changing), bound)
}

/// Adds the functions that are zero where an angle begins anew. There a constraint must not jump, and a load jumps if a condition on
/// this angle changes. At the cut of `atan2` those of constraints are known already.
fn add_cuts(
    graph: &mut Graph,
    layout: &InputLayout,
    found: &mut Found,
    (used, of_rows): (&[Option<Node>], &[bool]),
    (wraps, changing): (&[(Node, Node)], &BTreeMap<u32, Node>),
) {
    let (nowhere, zero) = (graph.constant(-1.0), graph.constant(0.0));
    let of_atan2 = used.iter().enumerate().filter_map(|(index, used)| {
        let node = Node(index as u32);
        match graph.op(node) {
            Op::Atan2(y, x) if used.is_some() && !of_rows[index] => Some((node, y, Some(x))),
            _ => None,
        }
    });
    let of_atan2: Vec<_> = of_atan2.collect();
    let wrapped = wraps.iter().map(|(node, ends)| (*node, *ends, None));
    for (node, value, below) in wrapped.chain(of_atan2) {
        let index = node.0 as usize;
        let constrains = of_rows[index];
        let Some(mut used) = used[index] else {
            continue;
        };
        if !(constrains || compares(graph, found, node)) {
            continue;
        }
        if let Some(below) = below {
            let cut = graph.less(below, zero);
            used = graph.select(cut, used, zero);
            if used == zero || !changes(graph, layout, value, changing) {
                continue;
            }
        }
        let place = KinkPlace { node, argument: 0 };
        let kind = KinkKind {
            constrains,
            cut: true,
            course: match below {
                Some(_) => course(graph, layout, value, changing),
                None => Course::default(),
            },
            ..KinkKind::default()
        };
        if !found.join(graph, (place, kind), [value, nowhere, used]) {
            found.add((place, kind), [value, nowhere, used]);
        }
    }
}

/// Whether a function changes with the motion, and its rate is known.
fn changes(
    graph: &Graph,
    layout: &InputLayout,
    value: Node,
    changing: &BTreeMap<u32, Node>,
) -> bool {
    moves(graph, layout, value, changing)
        && !known_in_outputs_only(graph, &[value], layout)
        // the answers of a field have no known rate
        && !uses_fields(graph, &[value], layout, false)
}

/// The quantities on which a function depends, beside constants that no input changes. Its rate shows later whether a function of
/// time has a constant rate.
fn course(
    graph: &Graph,
    layout: &InputLayout,
    value: Node,
    changing: &BTreeMap<u32, Node>,
) -> Course {
    let constants = layout.constant(0)..layout.len();
    let turns = layout.rotation(0)..layout.answer(0);
    let (mut of_time, mut of_places, mut of_inputs) = (true, true, true);
    for input in inputs_of(graph, &[value]) {
        let constant = constants.contains(&input) && !changing.contains_key(&input);
        let placed = matches!(
            Place::of(layout, input),
            Place::Position { .. } | Place::Orientation { .. }
        );
        let timed = constant || input == InputLayout::TIME;
        of_time &= timed;
        of_places &= timed || placed || turns.contains(&input);
        of_inputs &= timed || constants.contains(&input);
    }
    match (of_time, of_places, of_inputs) {
        (true, _, _) => Course::Time,
        (false, true, _) => Course::Position,
        (false, false, true) => Course::Inputs,
        (false, false, false) => Course::Motion,
    }
}

/// The arguments of sines, cosines and tangents that change in kink functions of the motion. Such a function may
/// change its sign twice in each period, so a step must be short in comparison with a period.
fn phases(
    graph: &Graph,
    layout: &InputLayout,
    (values, kinds): (&[Node], &[KinkKind]),
    changing: &BTreeMap<u32, Node>,
) -> Vec<Node> {
    let of_motion = values.iter().zip(kinds);
    let of_motion: Vec<Node> = of_motion
        .filter(|(_, kind)| !kind.course.is_of_time() || kind.table.is_some())
        .map(|(value, _)| *value)
        .collect();
    let needed = dependencies(graph, &of_motion);
    let operations = graph.nodes().iter().zip(&needed);
    let mut found: Vec<Node> = operations
        .filter_map(|(op, needed)| match op {
            Op::Elementary(Elementary::Sin | Elementary::Cos | Elementary::Tan, of) if *needed => {
                Some(*of)
            }
            _ => None,
        })
        .filter(|argument| changes(graph, layout, *argument, changing))
        .collect();
    found.sort_unstable();
    found.dedup();
    found
}

/// Whether a kink function of the motion depends on an operation.
fn compares(graph: &Graph, found: &Found, node: Node) -> bool {
    let functions = found.values.iter().zip(&found.kinds);
    let mut of_motion = functions
        .filter(|(_, kind)| !kind.course.is_of_time() && kind.table.is_none())
        .map(|(value, _)| *value);
    of_motion.any(|value| dependencies(graph, &[value])[node.0 as usize])
}

/// Whether a function jumps where an angle begins anew: it depends on a count of turns, which is a sum of chosen constants, or on
/// an angle of `atan2`.
fn jumps_with_angles(graph: &Graph, value: Node, turns: &[Node]) -> bool {
    let parts = dependencies(graph, &[value]);
    let mut turns = turns.iter();
    let mut angles = graph.nodes().iter().zip(&parts);
    turns.any(|turn| parts[turn.0 as usize] && matches!(graph.op(*turn), Op::Select(..)))
        || angles.any(|(op, part)| *part && matches!(op, Op::Atan2(..)))
}

/// The functions with their rates, and those of constants after them.
fn with_rates(
    graph: &mut Graph,
    layout: &InputLayout,
    found: Found,
    (rates, changing): (&[Node], &BTreeMap<u32, Node>),
    bound: &[BoundKink],
) -> Result<Kinks, DifferentiateError> {
    let Found {
        places,
        mut kinds,
        mut values,
        mut handles,
        mut active,
    } = found;
    if values.is_empty() && bound.is_empty() {
        return Ok(Kinks::default());
    }
    let phases = phases(graph, layout, (&values, &kinds), changing);
    let mut slopes = time_derivative_with(
        graph,
        layout,
        &[values.as_slice(), phases.as_slice()].concat(),
        (Some(rates), changing),
        Accelerations::Inputs,
    )?;
    let reads_accelerations = inputs_of(graph, &slopes)
        .into_iter()
        .any(|input| Place::of(layout, input) == Place::Acceleration);
    let phase_rates = slopes.split_off(values.len());
    for (kind, slope) in kinds.iter_mut().zip(&slopes) {
        if kind.course != Course::Time {
            continue;
        }
        if !inputs_of(graph, &[*slope]).contains(&InputLayout::TIME) {
            kind.course = Course::Uniform;
        } else if kind.table.is_some() {
            // the functions of a table's points are its argument less each point; these are not searched
            // ahead
            kind.course = Course::Motion;
        }
    }
    let (nowhere, always) = (graph.constant(-1.0), graph.constant(1.0));
    for kink in bound {
        let mut constant = |index: u32| graph.input(layout.constant(index));
        values.push(constant(kink.value));
        slopes.push(constant(kink.rate));
        handles.push(kink.table.map_or(nowhere, |(handle, _)| constant(handle)));
        active.push(always);
        kinds.push(KinkKind {
            table: kink.table.map(|(_, kind)| kind),
            course: Course::Inputs,
            ..KinkKind::default()
        });
    }
    let outputs = values.into_iter().chain(slopes).chain(handles);
    Ok(Kinks {
        places,
        kinds,
        outputs: outputs.chain(active).chain(phase_rates).collect(),
        phases: phases.len() as u32,
        reads_accelerations,
    })
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
    dependencies_through(graph, watched, |op| {
        !matches!(op, Op::Elementary(Elementary::Held, _))
    })
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
