//! Random expressions: forward, reverse and tape derivatives against differences, machine code against the interpreter.

use crate::support::{Random, call, tables};
use eng_compiler::generate::compile_class;
use eng_compiler::ir::{
    ClassBody, Function, Graph, InterpretedClass, Interpreter, Node, forward, gradient,
};
use eng_system::code::Function as Which;
use eng_system::elementary::Elementary;
use eng_system::layout::InputLayout;

const INPUTS: u32 = 3;

/// A random expression over the inputs, and the values whose sign picks its branches.
fn expression(g: &mut Graph, random: &mut Random, layout: &InputLayout) -> (Node, Vec<Node>) {
    let mut kinks = Vec::new();
    let one = g.constant(1.0);
    let half = g.constant(0.5);
    let mut nodes: Vec<Node> = (0..INPUTS).map(|i| g.input(layout.state(i))).collect();
    let value = g.constant(random.unit());
    nodes.push(value);
    for _ in 0..14 {
        let pick = |random: &mut Random| nodes[random.bits() as usize % nodes.len()];
        let (a, b, c) = (pick(random), pick(random), pick(random));
        let square = g.multiply(b, b);
        let positive = g.add(one, square);
        let bounded = g.unary(Elementary::Tanh, a);
        let difference = g.subtract(a, b);
        let new = match random.bits() % 24 {
            0 => g.add(a, b),
            1 => g.subtract(a, b),
            2 => g.multiply(a, b),
            3 => g.divide(a, positive),
            4 => g.unary(Elementary::Sin, a),
            5 => g.unary(Elementary::Cos, a),
            6 => bounded,
            7 => g.unary(Elementary::Atan, a),
            8 => g.sqrt(positive),
            9 => g.unary(Elementary::Exp, bounded),
            10 => g.unary(Elementary::Log, positive),
            11 => g.atan2(a, positive),
            12 => g.power(positive, bounded),
            13 => {
                let x = g.multiply(half, bounded);
                g.unary(Elementary::Asin, x)
            }
            14 => {
                let x = g.multiply(half, bounded);
                g.unary(Elementary::Acos, x)
            }
            15 => {
                kinks.push(difference);
                g.minimum(a, b)
            }
            16 => {
                kinks.push(difference);
                g.maximum(a, b)
            }
            17 => {
                kinks.push(a);
                g.abs(a)
            }
            18 => {
                kinks.push(difference);
                let flag = g.less(a, b);
                g.select(flag, c, square)
            }
            19 => {
                // not finite where it is not chosen
                let zero = g.constant(0.0);
                kinks.push(a);
                let flag = g.less(zero, a);
                let (root, log) = (g.sqrt(a), g.unary(Elementary::Log, a));
                let p = g.multiply(root, log);
                g.select(flag, p, b)
            }
            20 => {
                let x = g.multiply(half, bounded);
                g.unary(Elementary::Tan, x)
            }
            21 => {
                let handle = g.constant(2.0);
                g.table(handle, &[a, b])
            }
            22 => {
                let handle = g.constant(3.0);
                g.table(handle, &[a, c, bounded])
            }
            _ => g.negate(a),
        };
        nodes.push(new);
    }
    let mut sum = nodes[nodes.len() - 1];
    for n in &nodes[nodes.len() - 4..nodes.len() - 1] {
        sum = g.add(sum, *n);
    }
    (sum, kinks)
}

#[test]
fn derivatives_of_random_expressions() {
    let layout = InputLayout {
        states: INPUTS,
        ..InputLayout::default()
    };
    let tables = tables();
    let (mut sharp, mut smooth) = (0, 0);
    for seed in 0..600 {
        let random = &mut Random(seed);
        let mut g = if seed % 5 == 0 {
            Graph::plain()
        } else {
            Graph::new()
        };
        let (output, kinks) = expression(&mut g, random, &layout);
        let evaluate = |g: &Graph, nodes: &[Node], x: &[f64]| -> Vec<f64> {
            let function = Function {
                name: "f".into(),
                inputs: layout.len(),
                graph: g.clone(),
                outputs: nodes.to_vec(),
            };
            let inputs: Vec<[f64; 2]> = x.iter().map(|x| [*x; 2]).collect();
            let mut outputs = vec![[0.0; 2]; nodes.len()];
            assert!(Interpreter::new(&function).evaluate(
                &inputs,
                &mut outputs,
                &tables,
                &mut Vec::new()
            ));
            outputs.iter().map(|p| p[0]).collect()
        };
        let inputs: Vec<u32> = (0..INPUTS).map(|i| layout.state(i)).collect();
        let reverse = gradient(&mut g, output, &inputs);
        let one = g.constant(1.0);
        let directions: Vec<Node> = inputs
            .iter()
            .map(|i| forward(&mut g, &[output], &|input| (input == *i).then_some(one))[0])
            .collect();
        let zero = g.constant(0.0);
        let body = ClassBody {
            name: "Random".into(),
            layout,
            graph: g.clone(),
            rates: vec![output, zero, output],
            ..ClassBody::default()
        };
        let functions = body.functions().expect("a good class");
        let oracle = InterpretedClass::new(&functions);
        let machine = compile_class(&functions, true).expect("compiles");
        let x: Vec<f64> = (0..layout.len()).map(|_| 1.5 * random.unit()).collect();
        // one expression, three derivatives
        let (r, f) = (evaluate(&g, &reverse, &x), evaluate(&g, &directions, &x));
        let size = r.iter().map(|r| r.abs()).fold(1e-3, f64::max);
        let tape = call(&oracle, Which::Linearize, &x, &tables);
        for d in 0..INPUTS as usize {
            let mut seeds = tape.clone();
            seeds.extend((0..INPUTS as usize).map(|i| if i == d { 1.0 } else { 0.0 }));
            let t = call(&oracle, Which::Tangent, &seeds, &tables);
            let on_machine = call(&*machine, Which::Tangent, &seeds, &tables);
            assert!(
                t.iter()
                    .zip(&on_machine)
                    .all(|(a, b)| a.to_bits() == b.to_bits())
            );
            for t in [t[0], t[2]] {
                assert!(
                    (t - f[d]).abs() <= 1e-10 * size,
                    "seed {seed}: tape {t}, forward {}",
                    f[d]
                );
            }
            assert_eq!(t[1], 0.0);
            assert!(
                (r[d] - f[d]).abs() <= 1e-10 * size,
                "seed {seed}: reverse {} forward {}",
                r[d],
                f[d]
            );
        }
        for which in [Which::Residual, Which::Linearize] {
            let (a, b) = (
                call(&oracle, which, &x, &tables),
                call(&*machine, which, &x, &tables),
            );
            assert!(
                a.iter()
                    .zip(&b)
                    .all(|(a, b)| a.to_bits() == b.to_bits() || a.is_nan() && b.is_nan())
            );
        }
        // against differences, where no kink lies between
        for d in 0..INPUTS as usize {
            let at = |h: f64| {
                let mut y = x.clone();
                y[layout.state(d as u32) as usize] += h;
                y
            };
            let step = 4e-3;
            let signs = |h: f64| -> Vec<bool> {
                evaluate(&g, &kinks, &at(h))
                    .iter()
                    .map(|k| *k > 0.0)
                    .collect()
            };
            let here = signs(0.0);
            if (-4..=4).any(|i| signs(step * f64::from(i) / 4.0) != here) {
                continue;
            }
            smooth += 1;
            let central = |h: f64| {
                (evaluate(&g, &[output], &at(h))[0] - evaluate(&g, &[output], &at(-h))[0])
                    / (2.0 * h)
            };
            let (c1, c2, c3) = (central(step), central(step / 2.0), central(step / 4.0));
            let (r1, r2) = (c2 + (c2 - c1) / 3.0, c3 + (c3 - c2) / 3.0);
            let best = r2 + (r2 - r1) / 15.0;
            let estimate = (r2 - r1).abs();
            let tolerance = 1e-8 * size + estimate;
            assert!(
                (best - f[d]).abs() <= tolerance,
                "seed {seed} {d}: {best} {}",
                f[d]
            );
            if tolerance <= 1e-7 * size {
                sharp += 1;
            }
        }
    }
    assert!(
        smooth > 1000 && sharp > smooth * 8 / 10,
        "{sharp} sharp of {smooth}"
    );
}

#[test]
fn the_side_not_chosen_does_not_spread() {
    // select(x > 0, √x·y, y²) + select(x > 1, log(x − 1), 0), all times y
    let mut g = Graph::new();
    let (x, y) = (g.input(0), g.input(1));
    let (zero, one) = (g.constant(0.0), g.constant(1.0));
    let root = g.sqrt(x);
    let then = g.multiply(root, y);
    let otherwise = g.multiply(y, y);
    let positive = g.less(zero, x);
    let a = g.select(positive, then, otherwise);
    let above = g.subtract(x, one);
    let log = g.unary(Elementary::Log, above);
    let large = g.less(one, x);
    let b = g.select(large, log, zero);
    let sum = g.add(a, b);
    let output = g.multiply(sum, y);
    let slopes = gradient(&mut g, output, &[0, 1]);
    let function = Function {
        name: "f".into(),
        inputs: 2,
        graph: g,
        outputs: slopes,
    };
    for function in [eng_compiler::ir::optimise(&function), function] {
        let mut out = [[0.0; 2]; 2];
        let inputs = [[-2.0, 0.25], [3.0, 3.0]];
        assert!(Interpreter::new(&function).evaluate(&inputs, &mut out, &[], &mut Vec::new()));
        // at x = −2: y³, slopes 0 and 3y²; at x = 1/4: √x y², slopes y²/(2√x) and 2√x y
        assert_eq!([out[0][0], out[1][0]], [0.0, 27.0]);
        assert!((out[0][1] - 9.0).abs() < 1e-14 && (out[1][1] - 3.0).abs() < 1e-14);
    }
}
