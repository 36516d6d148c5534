//! Smaller graphs with the same meaning: folding, common subexpressions, dead code, order.

use super::graph::{Function, Graph, Node, Op};

/// For each node, whether one of the given nodes depends on it or is it.
pub fn dependencies(graph: &Graph, nodes: &[Node]) -> Vec<bool> {
    dependencies_through(graph, nodes, |_| true)
}

/// The same, without the operands of operations that `passes` excludes.
pub(crate) fn dependencies_through(
    graph: &Graph,
    nodes: &[Node],
    passes: impl Fn(&Op) -> bool,
) -> Vec<bool> {
    let mut needed = vec![false; graph.nodes().len()];
    for node in nodes {
        needed[node.0 as usize] = true;
    }
    for (index, op) in graph.nodes().iter().enumerate().rev() {
        if needed[index] && passes(op) {
            for operand in op.operands() {
                needed[operand.0 as usize] = true;
            }
        }
    }
    needed
}

/// Copies nodes and their operands into another graph, through its folding builders. `input` makes the node
/// for an input: the same input, another index, or any expression.
pub(crate) fn copy_into(
    source: &Graph,
    nodes: &[Node],
    target: &mut Graph,
    input: &mut dyn FnMut(&mut Graph, u32) -> Node,
) -> Vec<Node> {
    let needed = dependencies(source, nodes);
    let mut copies = vec![Node(0); source.nodes().len()];
    for (index, op) in source.nodes().iter().enumerate() {
        if needed[index] {
            copies[index] = match *op {
                Op::Input(i) => input(target, i),
                op => {
                    let op = op.map_operands(|n| copies[n.0 as usize]);
                    target.build(op)
                }
            };
        }
    }
    nodes.iter().map(|n| copies[n.0 as usize]).collect()
}

/// The same function without dead, repeated or constant operations, with each value near its use.
pub fn optimise(function: &Function) -> Function {
    let mut outputs = function.outputs.clone();
    let mut graph = function.graph.clone();
    // a folded operand may allow its user to fold; the result is final after one or two rounds
    for _ in 0..3 {
        let mut folded = Graph::new();
        outputs = copy_into(&graph, &outputs, &mut folded, &mut |g, i| g.input(i));
        let settled = folded.nodes().len() == graph.nodes().len();
        graph = folded;
        if settled {
            break;
        }
    }
    let (graph, outputs) = order(&graph, &outputs);
    Function {
        name: function.name.clone(),
        inputs: function.inputs,
        graph,
        outputs,
    }
}

/// Puts operations in the order of a walk from the outputs, so that few values live at once. The operand that needs
/// more registers comes first (Sethi & Ullman 1970; exact for trees).
fn order(graph: &Graph, outputs: &[Node]) -> (Graph, Vec<Node>) {
    let mut registers = vec![1_u32; graph.nodes().len()];
    for (index, op) in graph.nodes().iter().enumerate() {
        let mut needs: Vec<u32> = op.operands().map(|n| registers[n.0 as usize]).collect();
        needs.sort_unstable_by(|a, b| b.cmp(a));
        registers[index] = needs
            .iter()
            .zip(0..)
            .map(|(need, held)| need + held)
            .max()
            .unwrap_or(1);
    }
    let mut ordered = Graph::new();
    let mut places: Vec<Option<Node>> = vec![None; graph.nodes().len()];
    let mut stack: Vec<(Node, bool)> = Vec::new();
    for output in outputs {
        stack.push((*output, false));
        while let Some((node, operands_done)) = stack.pop() {
            let index = node.0 as usize;
            if places[index].is_some() {
                continue;
            }
            let op = graph.op(node);
            if operands_done {
                let op = op.map_operands(|n| places[n.0 as usize].unwrap_or(n));
                places[index] = Some(ordered.push(op));
                continue;
            }
            stack.push((node, true));
            let mut operands: Vec<Node> = op.operands().collect();
            // the stack reverses the order, so the operand with the largest need of registers is pushed last
            operands.reverse();
            operands.sort_by_key(|n| registers[n.0 as usize]);
            stack.extend(operands.into_iter().map(|n| (n, false)));
        }
    }
    let outputs = outputs
        .iter()
        .map(|n| places[n.0 as usize].unwrap_or(*n))
        .collect();
    (ordered, outputs)
}
