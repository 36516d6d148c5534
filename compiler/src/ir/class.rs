//! From the equations of a class to the functions that the runtime calls: the residual with the reactions of
//! its constraints, its tape and tangent, rates, outputs, conditions, angles and kinks.

use super::differentiate::{
    Accelerations, DifferentiateError, Place, gradient, guarded_multiply, inputs_of,
    time_derivative_with, uses_fields,
};
use super::graph::{Function, Graph, Node};
use super::kinks::{self, BoundKink, KinkKind, KinkPlace};
use super::linearise::linearise;
use super::optimise::optimise;
use eng_system::layout::{InputLayout, ROTATION, VELOCITY};
use eng_system::system::ClassFacts;
use std::collections::BTreeMap;

/// The lowered body of a class: values over the inputs of its [`InputLayout`].
#[derive(Clone, Debug, Default)]
pub struct ClassBody {
    /// The class's name.
    pub name: String,
    /// The layout of the inputs.
    pub layout: InputLayout,
    /// The graph of everything below.
    pub graph: Graph,
    /// Φ, one value for each constraint row.
    pub rows: Vec<Node>,
    /// Applied loads on each marker: force (inertial axes), torque (MARKER axes). As many as markers.
    pub loads: Vec<[Node; 6]>,
    /// ẏ, one value for each state.
    pub rates: Vec<Node>,
    /// Drives of the fields, in the order of the kernels' arguments.
    pub drives: Vec<Node>,
    /// Outputs; the only values that may use accelerations, state rates, signals and multipliers.
    pub outputs: Vec<Node>,
    /// Conditions, which must be positive.
    pub conditions: Vec<Node>,
    /// Unwrapped angles.
    pub rotations: Vec<Node>,
    /// Operations whose comparisons count turns. Values that follow from the count have no kink, because they repeat
    /// with the turn.
    pub turns: Vec<Node>,
    /// `wrapped` angles, and functions that are zero where they begin anew.
    pub wraps: Vec<(Node, Node)>,
    /// Conditions that end a run, as flags. Steps end where they change.
    pub stops: Vec<Node>,
    /// Constants that change with inputs between two points of time, and the constants that are their rates.
    /// Constraints read none of them.
    pub changing: Vec<(u32, u32)>,
    /// Kinks of these constants.
    pub bound_kinks: Vec<BoundKink>,
}

/// The functions of a class, described at [`eng_system::code`].
#[derive(Clone, Debug)]
#[allow(missing_docs)]
pub struct ClassFunctions {
    pub layout: InputLayout,
    pub residual: Function,
    pub linearize: Function,
    pub tangent: Function,
    pub velocity: Function,
    pub outputs: Function,
    pub conditions: Function,
    pub rotations: Function,
    pub kinks: Function,
    /// The operation of each kink function of the motion. Those of constants follow.
    pub kink_places: Vec<KinkPlace>,
    /// The kind of each kink function.
    pub kinds_of_kinks: Vec<KinkKind>,
    pub facts: ClassFacts,
}

/// Entries of a marker's inputs that are its pose: x, then R. The velocity is the first number after them.
const POSE: u32 = VELOCITY;

impl ClassBody {
    /// Differentiates and optimises: all functions of the class.
    pub fn functions(&self) -> Result<ClassFunctions, DifferentiateError> {
        let plain = self.functions_as_written()?;
        Ok(ClassFunctions {
            residual: optimise(&plain.residual),
            linearize: optimise(&plain.linearize),
            tangent: optimise(&plain.tangent),
            velocity: optimise(&plain.velocity),
            outputs: optimise(&plain.outputs),
            conditions: optimise(&plain.conditions),
            rotations: optimise(&plain.rotations),
            kinks: optimise(&plain.kinks),
            ..plain
        })
    }

    /// The functions without the optimiser, as the reference for its tests.
    pub fn functions_as_written(&self) -> Result<ClassFunctions, DifferentiateError> {
        let layout = self.layout;
        for (expected, found) in [
            (layout.rows, self.rows.len()),
            (layout.markers, self.loads.len()),
            (layout.states, self.rates.len()),
            (layout.rotations, self.rotations.len()),
            (layout.drives, self.drives.len()),
        ] {
            if expected as usize != found {
                return Err(DifferentiateError::Count {
                    expected: expected as usize,
                    found,
                });
            }
        }
        let mut graph = self.graph.clone();
        let residual = self.residual(&mut graph);
        let still = BTreeMap::new();
        let position_rates = time_derivative_with(
            &mut graph,
            &layout,
            &self.rows,
            (Some(&self.rates), &still),
            Accelerations::Zero,
        )?;
        let second = time_derivative_with(
            &mut graph,
            &layout,
            &position_rates,
            (Some(&self.rates), &still),
            Accelerations::Zero,
        )?;
        let mut velocity = position_rates;
        for node in second {
            velocity.push(graph.negate(node));
        }
        let (linearize, tangent) = linearise(&self.name, &layout, &graph, &residual);
        let common: Vec<Node> = residual
            .iter()
            .chain(&velocity)
            .chain(&self.conditions)
            .chain(&self.rotations)
            .copied()
            .collect();
        check_inputs(&graph, &common, layout.len())?;
        check_inputs(&graph, &self.outputs, layout.outputs_len())?;
        let uses_twist = inputs_of(&graph, &residual[layout.rows as usize..])
            .into_iter()
            .any(|i| matches!(Place::of(&layout, i), Place::Velocity { .. }));
        let applies_load = self
            .loads
            .iter()
            .flatten()
            .any(|n| graph.as_constant(*n) != Some(0.0));
        // the applied loads alone: `rows_over_time` states whether −Gᵀλ depends on time
        let own: Vec<Node> = self
            .loads
            .iter()
            .flatten()
            .chain(&self.rates)
            .chain(&self.drives)
            .copied()
            .collect();
        let over_time = |nodes: &[Node]| inputs_of(&graph, nodes).contains(&InputLayout::TIME);
        let loads_over_time = over_time(&own);
        let rows_over_time = over_time(&self.rows);
        let read = inputs_of(&graph, &residual);
        let differentiated = (0..layout.answers)
            .map(|answer| read.contains(&layout.answer(answer)))
            .collect();
        let conditions_read_fields = uses_fields(&graph, &self.conditions, &layout, false);
        let loads: Vec<Node> = (self.loads.iter().flatten())
            .chain(&self.drives)
            .chain(&self.stops)
            .copied()
            .collect();
        let changing: BTreeMap<u32, Node> = (self.changing.iter())
            .map(|(k, rate)| (layout.constant(*k), graph.input(layout.constant(*rate))))
            .collect();
        let known = (self.rates.as_slice(), &changing);
        let besides = (
            self.turns.as_slice(),
            self.wraps.as_slice(),
            self.bound_kinks.as_slice(),
        );
        let watched = (self.rows.as_slice(), loads.as_slice());
        let kinks = kinks::find(&mut graph, &layout, watched, known, besides)?;
        let function = |name: &str, inputs: u32, outputs: Vec<Node>| Function {
            name: format!("{}.{name}", self.name),
            inputs,
            graph: graph.clone(),
            outputs,
        };
        Ok(ClassFunctions {
            layout,
            residual: function("residual", layout.len(), residual),
            linearize,
            tangent,
            velocity: function("velocity", layout.len(), velocity),
            outputs: function("outputs", layout.outputs_len(), self.outputs.clone()),
            conditions: function("conditions", layout.len(), self.conditions.clone()),
            rotations: function("rotations", layout.len(), self.rotations.clone()),
            kinks: kinks.function(&self.name, &layout, &graph),
            kink_places: kinks.places,
            kinds_of_kinks: kinks.kinds,
            facts: ClassFacts {
                kinks_read_accelerations: kinks.reads_accelerations,
                kink_phases: kinks.phases,
                uses_twist,
                applies_load,
                loads_over_time,
                rows_over_time,
                conditions_read_fields,
                differentiated,
            },
        })
    }

    /// Φ, the wrench on each marker, ẏ. The part of the constraints in the wrenches is −Gᵀλ, the gradient of −λᵀΦ
    /// along the pose directions: force along x (inertial), torque along δπ with δR = R δπ~ (marker axes), by virtual
    /// work.
    fn residual(&self, graph: &mut Graph) -> Vec<Node> {
        let layout = &self.layout;
        let mut work = graph.constant(0.0);
        for (row, phi) in (0..).zip(&self.rows) {
            let multiplier = graph.input(layout.multiplier(row));
            let term = graph.multiply(multiplier, *phi);
            work = graph.add(work, term);
        }
        let poses: Vec<u32> = (0..layout.markers)
            .flat_map(|m| (0..POSE).map(move |c| (m, c)))
            .map(|(m, c)| layout.marker(m) + c)
            .collect();
        let slopes = gradient(graph, work, &poses);
        let mut residual = self.rows.clone();
        for ((marker, load), slope) in (0..)
            .zip(&self.loads)
            .zip(slopes.chunks_exact(POSE as usize))
        {
            let turn = turning_slope(graph, layout, marker, &slope[3..]);
            for (load, reaction) in load.iter().zip(slope[..3].iter().chain(&turn)) {
                residual.push(graph.subtract(*load, *reaction));
            }
        }
        residual.extend(&self.rates);
        residual.extend(&self.drives);
        residual
    }
}

/// The slope of a value along δπ, with δR = R δπ~, from its slopes over the entries of R: component k is Σᵢ
/// (g_ij R_il − g_il R_ij) with j = k+1, l = k+2 turned cyclically, and the sign of that order.
fn turning_slope(
    graph: &mut Graph,
    layout: &InputLayout,
    marker: u32,
    slopes: &[Node],
) -> [Node; 3] {
    let zero = graph.constant(0.0);
    let mut turn = [zero; 3];
    for (k, sum) in turn.iter_mut().enumerate() {
        let (j, l) = ((k + 1) % 3, (k + 2) % 3);
        for row in 0..3 {
            let entry = layout.marker(marker) + ROTATION + 3 * row as u32;
            // δR_ij = R_il δπ_k and δR_il = −R_ij δπ_k
            let (r_j, r_l) = (graph.input(entry + j as u32), graph.input(entry + l as u32));
            let plus = guarded_multiply(graph, slopes[3 * row + j], r_l);
            let minus = guarded_multiply(graph, slopes[3 * row + l], r_j);
            let difference = graph.subtract(plus, minus);
            *sum = graph.add(*sum, difference);
        }
    }
    turn
}

fn check_inputs(graph: &Graph, nodes: &[Node], count: u32) -> Result<(), DifferentiateError> {
    match inputs_of(graph, nodes).last() {
        Some(i) if *i >= count => Err(DifferentiateError::Input(*i)),
        _ => Ok(()),
    }
}

impl ClassFunctions {
    /// Whether every function has the same operations, so that the code of one class serves the other.
    pub(crate) fn same_code(&self, other: &ClassFunctions) -> bool {
        eng_system::code::Function::ALL.iter().all(|which| {
            let (own, other) = (self.get(*which), other.get(*which));
            own.inputs == other.inputs
                && own.outputs == other.outputs
                && own.graph.nodes() == other.graph.nodes()
        })
    }

    /// A function of the class.
    pub fn get(&self, function: eng_system::code::Function) -> &Function {
        use eng_system::code::Function as Which;
        match function {
            Which::Residual => &self.residual,
            Which::Linearize => &self.linearize,
            Which::Tangent => &self.tangent,
            Which::Velocity => &self.velocity,
            Which::Outputs => &self.outputs,
            Which::Conditions => &self.conditions,
            Which::Rotations => &self.rotations,
            Which::Kinks => &self.kinks,
        }
    }

    /// Length of the tape.
    pub fn tape(&self) -> u32 {
        self.linearize.outputs.len() as u32
    }
}
