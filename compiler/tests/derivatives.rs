//! Derivatives in time of every kind of input, and gradients at kinks.

use eng_compiler::internals::{time_derivative, uses_acceleration};
use eng_compiler::ir::{DifferentiateError, Function, Graph, Interpreter, Node, gradient};
use eng_system::elementary::Elementary;
use eng_system::layout::InputLayout;
use std::collections::BTreeMap;

fn layout() -> InputLayout {
    InputLayout {
        markers: 1,
        states: 1,
        rows: 1,
        rotations: 1,
        constants: 1,
        signals: 1,
        ..InputLayout::default()
    }
}

#[test]
fn rates_of_inputs() {
    let l = layout();
    let g = &mut Graph::new();
    let rate = |g: &mut Graph, input: u32, rates: Option<&[Node]>| {
        let node = g.input(input);
        time_derivative(g, &l, &[node], rates, &BTreeMap::new()).map(|d| d[0])
    };
    let zero = g.constant(0.0);
    let one = g.constant(1.0);
    assert_eq!(rate(g, InputLayout::TIME, None), Ok(one));
    let velocity = g.input(l.marker(0) + 13);
    assert_eq!(rate(g, l.marker(0) + 1, None), Ok(velocity));
    for axis in 0..6 {
        let acceleration = g.input(l.acceleration(0) + axis);
        assert_eq!(rate(g, l.marker(0) + 12 + axis, None), Ok(acceleration));
    }
    // (R ω~)₀₂ = R₀₀ ω₁ − R₀₁ ω₀
    let [r0, r1, w0, w1] = [3, 4, 15, 16].map(|i| g.input(l.marker(0) + i));
    let (p, q) = (g.multiply(r0, w1), g.multiply(r1, w0));
    let turned = g.subtract(p, q);
    assert_eq!(rate(g, l.marker(0) + 5, None), Ok(turned));
    let stated = g.input(l.state_rate(0));
    assert_eq!(rate(g, l.state(0), None), Ok(stated));
    assert_eq!(rate(g, l.state(0), Some(&[velocity])), Ok(velocity));
    for fixed in [l.multiplier(0), l.rotation(0), l.constant(0)] {
        assert_eq!(rate(g, fixed, None), Ok(zero));
    }
}

#[test]
fn rates_that_are_not_known() {
    let l = layout();
    let g = &mut Graph::new();
    for (input, error) in [
        (l.acceleration(0) + 2, DifferentiateError::Acceleration),
        (l.state_rate(0), DifferentiateError::Acceleration),
        (l.signal(0), DifferentiateError::Signal),
        (l.outputs_len(), DifferentiateError::Input(l.outputs_len())),
    ] {
        let node = g.input(input);
        let sum = g.add(node, node);
        assert_eq!(
            time_derivative(g, &l, &[sum], None, &BTreeMap::new()),
            Err(error)
        );
    }
    let node = g.input(0);
    let counts = DifferentiateError::Count {
        expected: 1,
        found: 0,
    };
    assert_eq!(
        time_derivative(g, &l, &[node], Some(&[]), &BTreeMap::new()),
        Err(counts)
    );
}

#[test]
fn accelerations_are_found() {
    let l = layout();
    let mut g = Graph::new();
    let velocity = g.input(l.marker(0) + 12);
    let rate = time_derivative(&mut g, &l, &[velocity], None, &BTreeMap::new()).expect("a rate");
    let sine = g.unary(Elementary::Sin, rate[0]);
    assert!(uses_acceleration(&g, &[sine], &l));
    assert!(!uses_acceleration(&g, &[velocity], &l));
}

#[test]
fn slopes_at_kinks() {
    let mut g = Graph::new();
    let (x, y) = (g.input(0), g.input(1));
    let (abs, least, most) = (g.abs(x), g.minimum(x, y), g.maximum(x, y));
    let nodes: Vec<Node> = [abs, least, most]
        .into_iter()
        .flat_map(|n| gradient(&mut g, n, &[0, 1]))
        .collect();
    let function = Function {
        name: "slopes".into(),
        inputs: 2,
        graph: g,
        outputs: nodes,
    };
    let mut out = [[0.0; 2]; 6];
    let interpreter = Interpreter::new(&function);
    assert!(interpreter.evaluate(&[[0.0, -1.0], [0.0, 2.0]], &mut out, &[], &mut Vec::new()));
    let lane = |k: usize| out.map(|p| p[k]);
    assert_eq!(lane(0), [1.0, 0.0, 1.0, 0.0, 1.0, 0.0]);
    assert_eq!(lane(1), [-1.0, 0.0, 1.0, 0.0, 0.0, 1.0]);
}
