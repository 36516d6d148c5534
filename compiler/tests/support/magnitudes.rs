//! The size of the terms whose sum is a value: the scale of its rounding.

use eng_compiler::ir::{Function, Interpreter, Node, Op};
use eng_system::code::Pair;
use eng_system::table::Table;

/// Values of every output with the sum of magnitudes that went into it. Where a sum cancels, its
/// magnitude exceeds its value. The slopes of later operations carry this excess on.
pub fn with_magnitudes(function: &Function, inputs: &[f64], tables: &[Table]) -> Vec<(f64, f64)> {
    let sizes: Vec<f64> = inputs.iter().map(|x| x.abs()).collect();
    with_magnitudes_from(function, inputs, &sizes, tables)
}

/// The same where the inputs come from sums of such magnitudes.
pub fn with_magnitudes_from(
    function: &Function,
    inputs: &[f64],
    input_sizes: &[f64],
    tables: &[Table],
) -> Vec<(f64, f64)> {
    let values = all_values(function, inputs, tables);
    let mut sizes: Vec<f64> = Vec::new();
    for (op, value) in function.graph.nodes().iter().zip(&values) {
        let m = |n: Node| sizes[n.0 as usize];
        let v = |n: Node| values[n.0 as usize];
        let of = |f: &dyn Fn(f64) -> f64, a: Node| {
            let h = 1e-7 * (1.0 + v(a).abs());
            f(v(a)).abs() + ((f(v(a) + h) - f(v(a) - h)) / (2.0 * h)).abs() * m(a)
        };
        let value = value.abs();
        let size = match *op {
            // the unknown of a slope is an input of a graph that is not folded, though nothing depends on it
            Op::Input(i) => input_sizes.get(i as usize).copied().unwrap_or(f64::NAN),
            Op::Add(a, b) | Op::Subtract(a, b) => m(a) + m(b),
            Op::Multiply(a, b) => v(a).abs() * m(b) + m(a) * v(b).abs() - value,
            Op::Divide(a, b) => (m(a) + value * (m(b) - v(b).abs())) / v(b).abs(),
            Op::Negate(a) | Op::Abs(a) => m(a),
            Op::Sqrt(a) => 0.5 * (value + m(a) / value),
            Op::Minimum(a, b) | Op::Maximum(a, b) => m(a).max(m(b)),
            Op::Select(f, a, b) => {
                if v(f) != 0.0 {
                    m(a)
                } else {
                    m(b)
                }
            }
            Op::Elementary(function, a) => of(&|x| function.value(x), a),
            Op::Atan2(y, x) => {
                value + (m(y) * v(x).abs() + m(x) * v(y).abs()) / (v(x) * v(x) + v(y) * v(y))
            }
            Op::Power(b, e) => {
                let slope = (v(e) * value / v(b)).abs() * m(b);
                value
                    + if slope.is_finite() { slope } else { 0.0 }
                    + (value * libm::log(v(b).abs())).abs() * m(e)
            }
            Op::Table(handle, arguments, orders) => {
                let count = orders.arguments();
                let x = &arguments.map(v)[..count];
                let mut size = value;
                for k in 0..count {
                    let mut raised = orders.each().to_vec();
                    raised[k] += 1;
                    let slope = tables
                        .get(v(handle) as usize)
                        .map_or(0.0, |t| t.evaluate(x, &raised));
                    size += slope.abs() * m(arguments[k]);
                }
                size
            }
            _ => value,
        };
        sizes.push(if size.is_nan() { value } else { size });
    }
    function
        .outputs
        .iter()
        .map(|n| (values[n.0 as usize], sizes[n.0 as usize]))
        .collect()
}

fn all_values(function: &Function, inputs: &[f64], tables: &[Table]) -> Vec<f64> {
    let mut all = function.clone();
    all.outputs = (0..function.graph.nodes().len() as u32).map(Node).collect();
    let pairs: Vec<Pair> = inputs.iter().map(|x| [*x, *x]).collect();
    let mut outputs = vec![[0.0; 2]; all.outputs.len()];
    assert!(Interpreter::new(&all).evaluate(&pairs, &mut outputs, tables, &mut Vec::new()));
    outputs.iter().map(|p| p[0]).collect()
}
