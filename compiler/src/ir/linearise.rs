//! From a function to its tape and its tangent.
//!
//! The linearised graph has a vertex for every value that depends on a direction, and an edge for every
//! slope. Vertices are eliminated as long as this makes the remaining graph cheaper (Markowitz; Griewank &
//! Walther, Evaluating Derivatives, ch. 9–10). So products of slopes are formed once, in `linearize`, and a
//! law is divided where the fewest values connect its two parts. The remaining graph is a linear
//! straight-line function of the seeds. Its slopes are constants or come from the tape.

use super::differentiate::{Place, guarded_add, guarded_multiply, partials};
use super::graph::{Function, Graph, Node, Op};
use super::optimise::dependencies;
use eng_system::layout::{InputLayout, ROTATION};
use std::collections::{BTreeMap, BTreeSet};

/// Cost of an operation of the tangent, in operations of `linearize`. A tangent is called once for each
/// direction, some twenty times for one linearisation, so time alone would suggest twenty. But the code of
/// both must stay in the cache, where both need the same space. At 3 most tangents have reached their least
/// length, and the code of the library's largest class is a twentieth larger than without eliminating groups.
const TANGENT_WEIGHT: i64 = 3;

/// Edges into and out of every vertex. Numbers of vertices rise along the edges.
#[derive(Clone, Debug, Default)]
struct Edges {
    /// Slope of each edge, by its start vertex.
    into: Vec<BTreeMap<usize, Node>>,
    from: Vec<BTreeSet<usize>>,
}

impl Edges {
    fn add(&mut self, graph: &mut Graph, start: usize, end: usize, slope: Node) {
        let sum = match self.into[end].get(&start) {
            Some(before) => sum_of_slopes(graph, *before, slope),
            None => slope,
        };
        if graph.as_constant(sum) == Some(0.0) {
            self.into[end].remove(&start);
            self.from[start].remove(&end);
        } else {
            self.into[end].insert(start, sum);
            self.from[start].insert(end);
        }
    }

    /// Work of an edge: an addition, and a multiplication unless the slope is ±1.
    fn work(graph: &Graph, slope: Node) -> i64 {
        if matches!(graph.as_constant(slope), Some(1.0 | -1.0)) {
            1
        } else {
            2
        }
    }

    /// Weighted operations of the tangent, plus the operations that make its slopes.
    fn total(&self, graph: &Graph) -> i64 {
        let slopes: Vec<Node> = self
            .into
            .iter()
            .flat_map(|into| into.values().copied())
            .collect();
        let tangent: i64 = slopes.iter().map(|slope| Self::work(graph, *slope)).sum();
        let needed = dependencies(graph, &slopes);
        let made = needed.iter().filter(|needed| **needed).count();
        TANGENT_WEIGHT * tangent + made as i64
    }

    /// Change of the work by the elimination of a vertex.
    fn change(&self, graph: &Graph, vertex: usize) -> i64 {
        let mut change = 0;
        for end in &self.from[vertex] {
            let slope = self.into[*end][&vertex];
            let last = Self::work(graph, slope);
            change -= last;
            for (start, first) in &self.into[vertex] {
                let work = if last == 1 {
                    Self::work(graph, *first)
                } else {
                    2
                };
                change += match self.into[*end].get(start) {
                    Some(present) => 2 - Self::work(graph, *present),
                    None => work,
                };
            }
        }
        change
            - self.into[vertex]
                .values()
                .map(|s| Self::work(graph, *s))
                .sum::<i64>()
    }

    fn eliminate(&mut self, graph: &mut Graph, vertex: usize) {
        let into = std::mem::take(&mut self.into[vertex]);
        let from = std::mem::take(&mut self.from[vertex]);
        for start in into.keys() {
            self.from[*start].remove(&vertex);
        }
        for end in from {
            let Some(last) = self.into[end].remove(&vertex) else {
                continue;
            };
            for (start, first) in &into {
                let slope = guarded_multiply(graph, last, *first);
                self.add(graph, *start, end, slope);
            }
        }
    }
}

/// A sum of slopes. For two negatives it is the negative of a sum, because the law itself may have formed
/// this sum already.
fn sum_of_slopes(graph: &mut Graph, a: Node, b: Node) -> Node {
    match (graph.op(a), graph.op(b)) {
        (Op::Negate(a), Op::Negate(b)) => {
            let sum = guarded_add(graph, a, b);
            graph.negate(sum)
        }
        _ => guarded_add(graph, a, b),
    }
}

/// `linearize` and `tangent` of values over a class's common inputs: derivatives along the pose, twist and
/// state directions of the layout, all other inputs fixed.
pub(crate) fn linearise(
    name: &str,
    layout: &InputLayout,
    source: &Graph,
    outputs: &[Node],
) -> (Function, Function) {
    let mut graph = source.clone();
    let directions = layout.directions() as usize;
    let needed = dependencies(&graph, outputs);
    let mut vertex_of: Vec<Option<usize>> = vec![None; needed.len()];
    let mut edges = Edges {
        into: vec![BTreeMap::new(); directions],
        from: vec![BTreeSet::new(); directions],
    };
    for index in 0..needed.len() {
        if !needed[index] {
            continue;
        }
        let node = Node(index as u32);
        let slopes: Vec<(usize, Node)> = match graph.op(node) {
            Op::Input(i) => input_slopes(&mut graph, layout, i),
            op if op.operands().any(|n| vertex_of[n.0 as usize].is_some()) => {
                partials(&mut graph, node)
                    .into_iter()
                    .filter_map(|(operand, slope)| Some((vertex_of[operand.0 as usize]?, slope)))
                    .collect()
            }
            _ => continue,
        };
        if slopes.is_empty() {
            continue;
        }
        let vertex = edges.into.len();
        edges.into.push(BTreeMap::new());
        edges.from.push(BTreeSet::new());
        vertex_of[index] = Some(vertex);
        for (start, slope) in slopes {
            edges.add(&mut graph, start, vertex, slope);
        }
    }
    let inner_end = edges.into.len();
    let one = graph.constant(1.0);
    for output in outputs {
        let vertex = edges.into.len();
        edges.into.push(BTreeMap::new());
        edges.from.push(BTreeSet::new());
        if let Some(start) = vertex_of[output.0 as usize] {
            edges.add(&mut graph, start, vertex, one);
        }
    }
    eliminate_while_it_pays(&mut graph, &mut edges, directions..inner_end);
    eliminate_groups(&mut graph, &mut edges, directions..inner_end);
    write_functions(name, layout, graph, &edges, inner_end)
}

/// Slopes of an input along the directions.
fn input_slopes(graph: &mut Graph, layout: &InputLayout, input: u32) -> Vec<(usize, Node)> {
    let one = graph.constant(1.0);
    match Place::of(layout, input) {
        Place::Position { marker, axis } => {
            vec![((layout.pose_direction(marker) + axis) as usize, one)]
        }
        Place::Velocity { marker, axis } => {
            vec![((layout.twist_direction(marker) + axis) as usize, one)]
        }
        Place::State(state) => vec![(layout.state_direction(state) as usize, one)],
        Place::Answer(answer) => vec![(layout.answer_direction(answer) as usize, one)],
        // δR = R δπ~: δR_i0 = R_i1 δπ₂ − R_i2 δπ₁, and cyclically
        Place::Orientation {
            marker,
            row,
            column,
        } => {
            let (next, last) = ((column + 1) % 3, (column + 2) % 3);
            let entries = layout.marker(marker) + ROTATION + 3 * row;
            let turn = layout.pose_direction(marker) + 3;
            let a = graph.input(entries + next);
            let b = graph.input(entries + last);
            let minus_b = graph.negate(b);
            vec![
                ((turn + last) as usize, a),
                ((turn + next) as usize, minus_b),
            ]
        }
        _ => Vec::new(),
    }
}

fn eliminate_while_it_pays(graph: &mut Graph, edges: &mut Edges, inner: std::ops::Range<usize>) {
    let mut known: BTreeMap<usize, i64> = BTreeMap::new();
    let mut queue: BTreeSet<(i64, usize)> = BTreeSet::new();
    for vertex in inner.clone() {
        let change = edges.change(graph, vertex);
        known.insert(vertex, change);
        queue.insert((change, vertex));
    }
    while let Some((change, vertex)) = queue.pop_first() {
        if change > 0 {
            break;
        }
        known.remove(&vertex);
        // the elimination may have changed edges of vertices that share a start or an end with this vertex
        let mut touched: BTreeSet<usize> = BTreeSet::new();
        for start in edges.into[vertex].keys() {
            touched.insert(*start);
            touched.extend(&edges.from[*start]);
        }
        for end in &edges.from[vertex] {
            touched.insert(*end);
            touched.extend(edges.into[*end].keys());
        }
        edges.eliminate(graph, vertex);
        for neighbour in touched {
            let Some(before) = known.get(&neighbour).copied() else {
                continue;
            };
            let after = edges.change(graph, neighbour);
            if after != before {
                queue.remove(&(before, neighbour));
                queue.insert((after, neighbour));
                known.insert(neighbour, after);
            }
        }
    }
}

/// Eliminates groups of vertices with the same neighbours on one side. They share the edges that their
/// elimination makes, so it may be cheaper for all of them although it is not for the first. The entries of a
/// column of R, which depend on the same two rotations, are such vertices.
fn eliminate_groups(graph: &mut Graph, edges: &mut Edges, inner: std::ops::Range<usize>) {
    let mut least = edges.total(graph);
    loop {
        let before = least;
        for group in groups(edges, inner.clone()) {
            // an earlier group may have eliminated a member
            if group.iter().any(|v| edges.into[*v].is_empty()) {
                continue;
            }
            let (mut trial_graph, mut trial) = (graph.clone(), edges.clone());
            for vertex in group {
                trial.eliminate(&mut trial_graph, vertex);
            }
            if trial.total(&trial_graph) >= least {
                continue;
            }
            eliminate_while_it_pays(&mut trial_graph, &mut trial, inner.clone());
            let total = trial.total(&trial_graph);
            if total < least {
                least = total;
                *graph = trial_graph;
                *edges = trial;
            }
        }
        if least == before {
            return;
        }
    }
}

/// Vertices with the same starts, and those with the same ends.
fn groups(edges: &Edges, inner: std::ops::Range<usize>) -> BTreeSet<Vec<usize>> {
    let mut by_start: BTreeMap<Vec<usize>, Vec<usize>> = BTreeMap::new();
    let mut by_end: BTreeMap<Vec<usize>, Vec<usize>> = BTreeMap::new();
    for vertex in inner {
        let starts: Vec<usize> = edges.into[vertex].keys().copied().collect();
        let ends: Vec<usize> = edges.from[vertex].iter().copied().collect();
        if !starts.is_empty() && !ends.is_empty() {
            by_start.entry(starts).or_default().push(vertex);
            by_end.entry(ends).or_default().push(vertex);
        }
    }
    let lists = by_start.into_values().chain(by_end.into_values());
    lists.filter(|group| group.len() > 1).collect()
}

/// The tape: a slot for each slope that is no constant. Equal and opposite slopes share a slot.
#[derive(Debug, Default)]
struct Tape {
    slots: BTreeMap<Node, u32>,
    values: Vec<Node>,
}

impl Tape {
    /// The slot, and whether the slope is minus the slot's value.
    fn place(&mut self, graph: &mut Graph, slope: Node) -> (u32, bool) {
        if let Some(slot) = self.slots.get(&slope) {
            return (*slot, false);
        }
        let opposite = graph.negate(slope);
        if let Some(slot) = self.slots.get(&opposite) {
            return (*slot, true);
        }
        let (value, turned) = match graph.op(slope) {
            Op::Negate(_) => (opposite, true),
            _ => (slope, false),
        };
        let slot = self.values.len() as u32;
        self.slots.insert(value, slot);
        self.values.push(value);
        (slot, turned)
    }
}

fn write_functions(
    name: &str,
    layout: &InputLayout,
    mut graph: Graph,
    edges: &Edges,
    inner_end: usize,
) -> (Function, Function) {
    let directions = layout.directions() as usize;
    let mut tape = Tape::default();
    // slopes get their slots first, because the seeds come after the tape
    let mut terms: Vec<Vec<(usize, Slope)>> = Vec::new();
    for vertex in directions..edges.into.len() {
        let mut list = Vec::new();
        for (start, slope) in &edges.into[vertex] {
            let slope = match graph.as_constant(*slope) {
                Some(value) => Slope::Constant(value),
                None => {
                    let (slot, minus) = tape.place(&mut graph, *slope);
                    Slope::Tape(slot, minus)
                }
            };
            list.push((*start, slope));
        }
        terms.push(list);
    }
    let mut tangent = Graph::new();
    let first_seed = tape.values.len() as u32;
    let mut values: Vec<Node> = (0..directions as u32)
        .map(|d| tangent.input(first_seed + d))
        .collect();
    let zero = tangent.constant(0.0);
    for list in terms {
        let mut sum = zero;
        for (start, slope) in list {
            let value = values[start];
            match slope {
                Slope::Constant(c) => {
                    let c = tangent.constant(c);
                    let term = tangent.multiply(c, value);
                    sum = tangent.add(sum, term);
                }
                Slope::Tape(slot, minus) => {
                    let slot = tangent.input(slot);
                    let term = tangent.multiply(slot, value);
                    sum = if minus {
                        tangent.subtract(sum, term)
                    } else {
                        tangent.add(sum, term)
                    };
                }
            }
        }
        values.push(sum);
    }
    let outputs = values.split_off(inner_end);
    let tangent = Function {
        name: format!("{name}.tangent"),
        inputs: first_seed + layout.directions(),
        graph: tangent,
        outputs,
    };
    let linearize = Function {
        name: format!("{name}.linearize"),
        inputs: layout.len(),
        graph,
        outputs: tape.values,
    };
    (linearize, tangent)
}

/// The slope of an edge, as the tangent reads it.
#[derive(Clone, Copy, Debug)]
enum Slope {
    /// A number.
    Constant(f64),
    /// The value of a slot of the tape, and whether the slope is minus this value.
    Tape(u32, bool),
}
