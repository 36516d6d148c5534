//! Values of a function's graph in numbers of twice the precision, and the distance of its kinks.

use super::double::Double;
use eng_compiler::ir::optimise::dependencies;
use eng_compiler::ir::{Function, Graph, Node, Op};
use eng_system::elementary::Elementary;
use eng_system::table::Table;

/// All values that the outputs need; the others are zero.
fn values(function: &Function, inputs: &[Double], tables: &[Table]) -> Vec<Double> {
    let needed = dependencies(&function.graph, &function.outputs);
    let mut values: Vec<Double> = Vec::with_capacity(needed.len());
    for (op, needed) in function.graph.nodes().iter().zip(&needed) {
        let value = if *needed {
            operate(*op, &values, inputs, tables)
        } else {
            Double::ZERO
        };
        values.push(value);
    }
    values
}

fn operate(op: Op, values: &[Double], inputs: &[Double], tables: &[Table]) -> Double {
    let of = |n: Node| values[n.0 as usize];
    let flag = |set: bool| if set { Double::ONE } else { Double::ZERO };
    let is_set = |n: Node| of(n).high != 0.0;
    match op {
        Op::Input(i) => inputs[i as usize],
        Op::Constant(bits) => f64::from_bits(bits).into(),
        Op::Add(a, b) => of(a) + of(b),
        Op::Subtract(a, b) => of(a) - of(b),
        Op::Multiply(a, b) => of(a) * of(b),
        Op::Divide(a, b) => of(a) / of(b),
        Op::Negate(a) => -of(a),
        Op::Abs(a) => of(a).abs(),
        Op::Sqrt(a) => of(a).sqrt(),
        Op::Minimum(a, b) => {
            if of(b).less(of(a)) {
                of(b)
            } else {
                of(a)
            }
        }
        Op::Maximum(a, b) => {
            if of(a).less(of(b)) {
                of(b)
            } else {
                of(a)
            }
        }
        Op::Elementary(Elementary::Sin, a) => of(a).sin_cos().0,
        Op::Elementary(Elementary::Cos, a) => of(a).sin_cos().1,
        Op::Elementary(Elementary::Tan, a) => {
            let (s, c) = of(a).sin_cos();
            s / c
        }
        Op::Elementary(Elementary::Asin, a) => of(a).asin(),
        Op::Elementary(Elementary::Acos, a) => of(a).acos(),
        Op::Elementary(Elementary::Atan, a) => of(a).atan2(Double::ONE),
        Op::Elementary(Elementary::Tanh, a) => of(a).tanh(),
        Op::Elementary(Elementary::Exp, a) => of(a).exp(),
        Op::Elementary(Elementary::Log, a) => of(a).log(),
        Op::Elementary(Elementary::Held, a) => of(a),
        Op::Atan2(y, x) => of(y).atan2(of(x)),
        Op::Power(base, exponent) => of(base).power(of(exponent)),
        Op::Less(a, b) => flag(of(a).less(of(b))),
        Op::LessEqual(a, b) => flag(!of(b).less(of(a))),
        Op::Equal(a, b) => flag(of(a) == of(b)),
        Op::And(a, b) => flag(is_set(a) && is_set(b)),
        Op::Or(a, b) => flag(is_set(a) || is_set(b)),
        Op::Not(a) => flag(!is_set(a)),
        Op::Select(f, a, b) => {
            if is_set(f) {
                of(a)
            } else {
                of(b)
            }
        }
        Op::Table(handle, arguments, orders) => {
            let arguments = arguments.map(of);
            let (table, x) = (
                &tables[of(handle).high as usize],
                &arguments[..orders.arguments()],
            );
            cubic(table, x, orders.each(), &mut Vec::new())
        }
    }
}

/// Points through which the cubic around an argument is taken: the grid does not move with the argument's
/// last digits, so that the rounding of the four values does not enter a difference.
fn grid(x: f64) -> [f64; 4] {
    const SPACING: f64 = 1.0 / 1024.0;
    let start = (x / SPACING).round() * SPACING;
    [-1.0, 0.0, 1.0, 2.0].map(|k| start + k * SPACING)
}

/// A table's value by the cubic through four of its own values along each argument (Lagrange); derivatives
/// are taken by the table itself. `fixed` holds the points of the first arguments.
fn cubic(table: &Table, x: &[Double], orders: &[u8], fixed: &mut Vec<f64>) -> Double {
    let Some(here) = x.get(fixed.len()) else {
        return Double::from(table.evaluate(fixed, orders));
    };
    let points = grid(here.high);
    let mut sum = Double::ZERO;
    for (i, a) in points.iter().enumerate() {
        fixed.push(*a);
        let mut term = cubic(table, x, orders, fixed);
        fixed.pop();
        for (j, b) in points.iter().enumerate() {
            if i != j {
                term = term * (*here - (*b).into()) / (a - b).into();
            }
        }
        sum = sum + term;
    }
    sum
}

/// The outputs of a function.
pub fn evaluate(function: &Function, inputs: &[Double], tables: &[Table]) -> Vec<Double> {
    let values = values(function, inputs, tables);
    function
        .outputs
        .iter()
        .map(|n| values[n.0 as usize])
        .collect()
}

/// The smallest relative distance to a kink or a jump: of compared numbers over their size, of an angle to
/// the cut of its branch, of an arcus to the end of its domain. Zero where a table's points are near.
pub fn nearest_kink(function: &Function, inputs: &[Double], tables: &[Table]) -> f64 {
    let needed = dependencies(&function.graph, &function.outputs);
    let values = values(function, inputs, tables);
    let of = |n: Node| values[n.0 as usize].high;
    let mut nearest = f64::INFINITY;
    for (op, needed) in function.graph.nodes().iter().zip(needed) {
        if !needed {
            continue;
        }
        let distance = match *op {
            Op::Less(a, b)
            | Op::LessEqual(a, b)
            | Op::Equal(a, b)
            | Op::Minimum(a, b)
            | Op::Maximum(a, b) => (of(a) - of(b)).abs() / of(a).abs().max(of(b).abs()),
            Op::Abs(a) => of(a).abs(),
            Op::Atan2(y, x) if of(x) < 0.0 => of(y).abs() / of(x).abs(),
            Op::Elementary(Elementary::Asin, a) | Op::Elementary(Elementary::Acos, a) => {
                1.0 - of(a).abs()
            }
            Op::Table(handle, arguments, orders) => {
                let table = &tables[of(handle) as usize];
                let arguments = arguments.map(of);
                let x = &arguments[..orders.arguments()];
                let one_piece = |k: usize| {
                    let mut third = vec![0; x.len()];
                    third[k] = 3;
                    let here = table.evaluate(x, &third);
                    let mut moved = x.to_vec();
                    grid(x[k]).iter().all(|p| {
                        moved[k] = *p;
                        table.evaluate(&moved, &third).to_bits() == here.to_bits()
                    })
                };
                if (0..x.len()).all(one_piece) {
                    f64::INFINITY
                } else {
                    0.0
                }
            }
            _ => f64::INFINITY,
        };
        // a comparison of two zeros is no number: as near as can be
        nearest = nearest.min(if distance.is_nan() { 0.0 } else { distance });
    }
    nearest
}

/// The same operations in the same order in a graph that neither folds nor shares.
pub fn plain(graph: &Graph) -> Graph {
    let mut copy = Graph::plain();
    for op in graph.nodes() {
        copy.push(*op);
    }
    copy
}
