//! The deepest quantities that an output needs: positions, velocities or accelerations.

use super::differentiate::{Place, inputs_of};
use super::graph::{Graph, Node};
use eng_system::layout::InputLayout;
use eng_system::system::Depth;

/// The depth of an output of a class, without that of the channels that it reads.
pub fn depth(graph: &Graph, output: Node, layout: &InputLayout) -> Depth {
    let multipliers = layout.multiplier(0)..layout.multiplier(layout.rows);
    let solved = layout.len()..layout.signal(0);
    let of = |input: u32| {
        if multipliers.contains(&input) || solved.contains(&input) {
            return Depth::Acceleration;
        }
        match Place::of(layout, input) {
            Place::Velocity { .. } => Depth::Velocity,
            _ => Depth::Position,
        }
    };
    let depths = inputs_of(graph, &[output]).into_iter().map(of);
    depths.max().unwrap_or(Depth::Position)
}
