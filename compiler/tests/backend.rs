//! Derivatives, optimiser, interpreter and machine code against each other and against differences.

use crate::support;
use crate::support::magnitudes::with_magnitudes;
use crate::support::{Random, call, cases, product, rotation, tables};
use eng_compiler::generate::compile_class;
use eng_compiler::ir::{ClassFunctions, Graph, InterpretedClass, Node, Op, optimise};
use eng_system::code::{ElementCode, Function, Pair};
use eng_system::elementary::Elementary;
use eng_system::layout::InputLayout;
use eng_system::table::Table;

fn functions(build: fn(bool) -> eng_compiler::ir::ClassBody) -> ClassFunctions {
    build(false).functions().expect("a good class")
}

/// The state after a step along a direction of the layout, on the manifold.
fn moved(layout: &InputLayout, state: &[f64], direction: u32, step: f64) -> Vec<f64> {
    let mut s = state.to_vec();
    for marker in 0..layout.markers {
        let m = layout.marker(marker) as usize;
        let pose = direction.wrapping_sub(layout.pose_direction(marker));
        let twist = direction.wrapping_sub(layout.twist_direction(marker));
        match pose {
            0..3 => s[m + pose as usize] += step,
            3..6 => {
                let mut turn = [0.0; 3];
                turn[pose as usize - 3] = step;
                turn_marker(&mut s, m, turn);
            }
            _ => {}
        }
        if twist < 6 {
            s[m + 12 + twist as usize] += step;
        }
    }
    if direction >= layout.state_direction(0) {
        s[(layout.state(0) + direction - layout.state_direction(0)) as usize] += step;
    }
    s
}

fn turn_marker(s: &mut [f64], m: usize, turn: [f64; 3]) {
    let mut r = [0.0; 9];
    r.copy_from_slice(&s[m + 3..m + 12]);
    s[m + 3..m + 12].copy_from_slice(&product(&r, &rotation(turn)));
}

/// Richardson's extrapolation of central differences, three steps: sixth order.
fn richardson(f: impl Fn(f64) -> Vec<f64>, step: f64) -> Vec<f64> {
    let central = |h: f64| -> Vec<f64> {
        f(h).iter()
            .zip(f(-h))
            .map(|(a, b)| (a - b) / (2.0 * h))
            .collect()
    };
    let (d1, d2, d3) = (central(step), central(step / 2.0), central(step / 4.0));
    d1.iter()
        .zip(&d2)
        .zip(&d3)
        .map(|((a, b), c)| {
            let (ab, bc) = (b + (b - a) / 3.0, c + (c - b) / 3.0);
            bc + (bc - ab) / 15.0
        })
        .collect()
}

fn norm(row: impl Iterator<Item = f64>) -> f64 {
    row.map(|x| x * x).sum::<f64>().sqrt()
}

/// The tangent in every direction: columns of the Jacobian.
fn jacobian(
    code: &dyn ElementCode,
    layout: &InputLayout,
    state: &[f64],
    tables: &[Table],
) -> Vec<Vec<f64>> {
    let tape = call(code, Function::Linearize, state, tables);
    (0..layout.directions() as usize)
        .map(|d| {
            let mut inputs = tape.clone();
            inputs
                .extend((0..layout.directions() as usize).map(|i| if i == d { 1.0 } else { 0.0 }));
            call(code, Function::Tangent, &inputs, tables)
        })
        .collect()
}

/// A kink of the bushing, or a point of the cam's table where its third derivative jumps, lies near: differences would
/// cross it.
fn near_a_kink(name: &str, layout: &InputLayout, s: &[f64]) -> bool {
    let (a, b) = (layout.marker(0) as usize, layout.marker(1) as usize);
    if name == "Cam" {
        let along = |k: usize| -> f64 {
            (0..3)
                .map(|i| s[a + 3 + 3 * i] * s[b + 3 + 3 * i + k])
                .sum()
        };
        let (c, s) = (along(0), along(1));
        let points = libm::atan2(s, c) * 12.0 / core::f64::consts::TAU;
        // the angle turns faster where a.x is nearly normal to the plane
        return (points - points.round()).abs() < 0.02 / (c * c + s * s).sqrt()
            || c * c + s * s < 0.05;
    }
    if name != "Bushing" {
        return false;
    }
    let local = |first: usize| -> [f64; 3] {
        [0, 1, 2].map(|k| {
            (0..3)
                .map(|i| (s[a + first + i] - s[b + first + i]) * s[b + 3 + 3 * i + k])
                .sum()
        })
    };
    let (d, v) = (local(0), local(12));
    let (y0, y1) = (s[layout.state(0) as usize], s[layout.state(1) as usize]);
    let points = [-1.0, -0.3, 0.1, 0.9, 2.0];
    [
        d[0],
        d[1] - d[2],
        v[0] - v[1],
        v[2],
        y0 * y1 + v[1] - y1,
        d[1] - core::f64::consts::FRAC_PI_2,
        d[1] + core::f64::consts::FRAC_PI_2,
    ]
    .into_iter()
    .chain(points.map(|p| d[1] - p))
    .any(|distance| distance.abs() < 0.06)
}

#[test]
fn jacobian_agrees_with_richardson_differences() {
    let tables = tables();
    for case in cases() {
        let functions = functions(case.build);
        let layout = functions.layout;
        let code = InterpretedClass::new(&functions);
        let mut random = Random(11);
        let mut checked = 0;
        while checked < 25 {
            let state = case.state(&layout, &mut random);
            if near_a_kink(case.name, &layout, &state) {
                continue;
            }
            checked += 1;
            let exact = jacobian(&code, &layout, &state, &tables);
            let step = if case.film { 2e-4 } else { 4e-3 };
            let differences: Vec<Vec<f64>> = (0..layout.directions())
                .map(|d| {
                    richardson(
                        |h| {
                            call(
                                &code,
                                Function::Residual,
                                &moved(&layout, &state, d, h),
                                &tables,
                            )
                        },
                        step,
                    )
                })
                .collect();
            for row in 0..layout.residual_len() as usize {
                let size = norm(exact.iter().map(|c| c[row]));
                assert!(size.is_finite(), "{} row {row}", case.name);
                for (d, (e, n)) in exact.iter().zip(&differences).enumerate() {
                    let error = (e[row] - n[row]).abs();
                    assert!(
                        error <= 1e-8 * size + 1e-13,
                        "{} row {row} direction {d}: {} against {}, row norm {size}",
                        case.name,
                        e[row],
                        n[row]
                    );
                }
            }
        }
    }
}

#[test]
fn reactions_are_the_gradient_of_the_constraints() {
    let tables = tables();
    for case in cases() {
        let functions = functions(case.build);
        let layout = functions.layout;
        if layout.rows == 0 {
            continue;
        }
        let code = InterpretedClass::new(&functions);
        let mut random = Random(5);
        for _ in 0..20 {
            let state = case.state(&layout, &mut random);
            let residual = call(&code, Function::Residual, &state, &tables);
            for direction in 0..6 * layout.markers {
                let work = richardson(
                    |h| {
                        let r = call(
                            &code,
                            Function::Residual,
                            &moved(&layout, &state, direction, h),
                            &tables,
                        );
                        let sum = (0..layout.rows)
                            .map(|i| state[layout.multiplier(i) as usize] * r[i as usize])
                            .sum();
                        vec![sum]
                    },
                    4e-3,
                )[0];
                let reaction = residual[(layout.rows + direction) as usize];
                assert!(
                    (reaction + work).abs() < 1e-9,
                    "{} {direction}: {reaction} {work}",
                    case.name
                );
            }
        }
    }
}

#[test]
fn velocity_and_gamma_follow_the_motion() {
    let tables = tables();
    for case in cases() {
        let functions = functions(case.build);
        let layout = functions.layout;
        let code = InterpretedClass::new(&functions);
        let rows = layout.rows as usize;
        let mut random = Random(7);
        for _ in 0..30 {
            let state = case.state(&layout, &mut random);
            if near_a_kink(case.name, &layout, &state) {
                continue;
            }
            // constant ẋ and, in marker axes, constant ω: the motion with zero accelerations
            let at = |t: f64| {
                let mut s = state.clone();
                s[0] += t;
                for marker in 0..layout.markers {
                    let m = layout.marker(marker) as usize;
                    for i in 0..3 {
                        s[m + i] += t * state[m + 12 + i];
                    }
                    turn_marker(&mut s, m, [0, 1, 2].map(|i| t * state[m + 15 + i]));
                }
                s
            };
            let velocity = call(&code, Function::Velocity, &state, &tables);
            assert_eq!(velocity.len(), 2 * rows);
            let first = richardson(
                |t| call(&code, Function::Residual, &at(t), &tables)[..rows].to_vec(),
                4e-3,
            );
            let second = richardson(
                |t| call(&code, Function::Velocity, &at(t), &tables)[..rows].to_vec(),
                4e-3,
            );
            for i in 0..rows {
                assert!(
                    (velocity[i] - first[i]).abs() < 1e-8,
                    "{}: {} {}",
                    case.name,
                    velocity[i],
                    first[i]
                );
                let gamma = velocity[rows + i];
                assert!(
                    (gamma + second[i]).abs() < 1e-8,
                    "{}: {gamma} {}",
                    case.name,
                    second[i]
                );
            }
            // Φ̇ is G v + Φ_t: the tangent of Φ along the twist, plus the rate at rest
            let columns = jacobian(&code, &layout, &state, &tables);
            let mut rest = state.clone();
            for marker in 0..layout.markers {
                let m = layout.marker(marker) as usize;
                rest[m + 12..m + 18].fill(0.0);
            }
            let partial = call(&code, Function::Velocity, &rest, &tables);
            for i in 0..rows {
                let along: f64 = (0..layout.markers)
                    .flat_map(|m| (0..6).map(move |k| (m, k)))
                    .map(|(m, k)| {
                        columns[(layout.pose_direction(m) + k) as usize][i]
                            * state[(layout.marker(m) + 12 + k) as usize]
                    })
                    .sum();
                assert!(
                    (velocity[i] - partial[i] - along).abs() < 1e-12,
                    "{}",
                    case.name
                );
            }
        }
    }
}

#[test]
fn sharing_folding_and_dead_code() {
    let mut graph = Graph::plain();
    let (x, y) = (graph.input(0), graph.input(1));
    let zero = graph.constant(0.0);
    let one = graph.constant(1.0);
    let dead = graph.unary(Elementary::Sin, y);
    let _ = graph.add(dead, x);
    let a = graph.multiply(x, y);
    let b = graph.multiply(y, x);
    let a = graph.add(a, zero);
    let b = graph.multiply(b, one);
    let sum = graph.subtract(a, b);
    let sum = graph.add(sum, a);
    let function = eng_compiler::ir::Function {
        name: "f".into(),
        inputs: 2,
        graph,
        outputs: vec![sum],
    };
    let small = optimise(&function);
    assert_eq!(small.graph.nodes().len(), 3);
    assert_eq!(
        small.graph.op(small.outputs[0]),
        Op::Multiply(Node(0), Node(1))
    );
}

#[test]
fn optimised_functions_agree_with_those_as_written() {
    let tables = tables();
    for case in cases() {
        let optimised = functions(case.build);
        let written = (case.build)(true)
            .functions_as_written()
            .expect("a good class");
        let layout = optimised.layout;
        assert!(optimised.residual.graph.nodes().len() < written.residual.graph.nodes().len());
        let code = InterpretedClass::new(&optimised);
        let plain = InterpretedClass::new(&written);
        let mut random = Random(3);
        for _ in 0..40 {
            let state = case.state(&layout, &mut random);
            for which in [
                Function::Residual,
                Function::Velocity,
                Function::Outputs,
                Function::Conditions,
                Function::Rotations,
            ] {
                let values = call(&code, which, &state, &tables);
                let expected = with_magnitudes(written.get(which), &state, &tables);
                for (row, (value, (expected, size))) in values.iter().zip(expected).enumerate() {
                    assert!(
                        (value - expected).abs() <= 1e-12 * size,
                        "{} {which:?} {row}: {value} {expected} of {size}",
                        case.name
                    );
                }
            }
            let (a, b) = (
                jacobian(&code, &layout, &state, &tables),
                jacobian(&plain, &layout, &state, &tables),
            );
            for row in 0..layout.residual_len() as usize {
                let size = norm(b.iter().map(|c| c[row]));
                for (x, y) in a.iter().zip(&b) {
                    assert!(
                        (x[row] - y[row]).abs() <= 1e-12 * size,
                        "{} row {row}",
                        case.name
                    );
                }
            }
        }
    }
}

/// The same bits; any NaN equals any NaN.
fn same(a: f64, b: f64) -> bool {
    a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan())
}

#[test]
fn machine_code_has_the_interpreters_bits() {
    let tables = tables();
    for case in cases() {
        let functions = functions(case.build);
        let layout = functions.layout;
        let machine = compile_class(&functions, true).expect("compiles");
        let oracle = InterpretedClass::new(&functions);
        let mut random = Random(17);
        for round in 0..200 {
            let (a, b) = (
                case.state(&layout, &mut random),
                case.state(&layout, &mut random),
            );
            let mut common: Vec<Pair> = a.iter().zip(&b).map(|(a, b)| [*a, *b]).collect();
            if round % 10 == 0 {
                // anything at all, in one lane
                let special = [f64::NAN, f64::INFINITY, -0.0, 0.0, 1e300, -1e-320];
                for k in 0..4 {
                    let place = random.bits() as usize % common.len();
                    common[place][k % 2] = special[(round / 10 + k) % special.len()];
                }
            }
            let mut tape: Vec<Pair> = Vec::new();
            for which in Function::ALL {
                let inputs = if which == Function::Tangent {
                    let mut inputs = tape.clone();
                    inputs.extend((0..layout.directions()).map(|_| [random.unit(), random.unit()]));
                    inputs
                } else {
                    common.clone()
                };
                assert_eq!(machine.shape(which), oracle.shape(which));
                let count = oracle.shape(which).1;
                let (mut x, mut y) = (vec![[0.5; 2]; count], vec![[0.25; 2]; count]);
                assert!(machine.call(which, &inputs, &mut x, &tables));
                assert!(oracle.call(which, &inputs, &mut y, &tables));
                for (i, (x, y)) in x.iter().zip(&y).enumerate() {
                    for lane in 0..2 {
                        assert!(
                            same(x[lane], y[lane]),
                            "{} {which:?} {i} lane {lane}: {} {}",
                            case.name,
                            x[lane],
                            y[lane]
                        );
                    }
                }
                if which == Function::Linearize {
                    tape = y;
                }
            }
        }
    }
}

#[cfg(feature = "jit")]
#[test]
fn code_of_every_class_is_below_16_kilobytes() {
    for case in cases() {
        let functions = functions(case.build);
        let class = eng_compiler::jit::JitClass::new(&functions).expect("compiles");
        println!(
            "{}: {} bytes, tape {}, {:?}",
            case.name,
            class.code_bytes(),
            functions.tape(),
            Function::ALL.map(|f| class.function_bytes(f))
        );
        assert!(
            class.code_bytes() > 0 && class.code_bytes() < 16 * 1024,
            "{}",
            case.name
        );
    }
}

#[test]
fn short_slices_are_refused() {
    for use_jit in [true, false] {
        let code = compile_class(&functions(support::revolute), use_jit).expect("compiles");
        let (takes, gives) = code.shape(Function::Residual);
        let mut outputs = vec![[0.0; 2]; gives];
        assert!(!code.call(
            Function::Residual,
            &vec![[0.0; 2]; takes - 1],
            &mut outputs,
            &[]
        ));
        assert!(!code.call(
            Function::Residual,
            &vec![[0.0; 2]; takes],
            &mut outputs[1..],
            &[]
        ));
        assert!(outputs.iter().all(|p| *p == [0.0; 2]));
    }
}

#[test]
fn a_missing_table_is_not_a_number() {
    let functions = functions(support::cam);
    let layout = functions.layout;
    let case = &cases()[1];
    for use_jit in [true, false] {
        let code = compile_class(&functions, use_jit).expect("compiles");
        let mut state = case.state(&layout, &mut Random(1));
        for handle in [2.0, -1.0, f64::NAN, f64::INFINITY] {
            state[layout.constant(2) as usize] = handle;
            let residual = call(&*code, Function::Residual, &state, &tables());
            assert!(residual[2].is_nan() && residual[0].is_finite());
        }
    }
}

#[test]
fn twists_and_loads_are_found() {
    let f = |build| {
        let f: ClassFunctions = functions(build);
        (f.facts.uses_twist, f.facts.applies_load)
    };
    assert_eq!(f(support::revolute), (false, false));
    assert_eq!(f(support::film), (true, true));
    assert_eq!(f(support::bushing), (true, true));
}

#[test]
fn threads_get_the_same_bits() {
    let tables = tables();
    for use_jit in [true, false] {
        let functions = functions(support::film);
        let layout = functions.layout;
        let code = compile_class(&functions, use_jit).expect("compiles");
        let case = &cases()[2];
        let run = || {
            let mut random = Random(23);
            let mut sums = Vec::new();
            for _ in 0..200 {
                let state = case.state(&layout, &mut random);
                sums.extend(
                    call(&*code, Function::Residual, &state, &tables)
                        .iter()
                        .map(|x| x.to_bits()),
                );
            }
            sums
        };
        let results: Vec<Vec<u64>> = std::thread::scope(|scope| {
            let handles: Vec<_> = (0..4).map(|_| scope.spawn(run)).collect();
            handles
                .into_iter()
                .map(|h| h.join().expect("no panic"))
                .collect()
        });
        assert!(results.iter().all(|r| *r == results[0]));
    }
}

#[test]
fn code_memory_is_used_and_freed_many_times() {
    let functions = functions(support::revolute);
    let state = cases()[0].state(&functions.layout, &mut Random(2));
    let expected = call(
        &InterpretedClass::new(&functions),
        Function::Residual,
        &state,
        &[],
    );
    for _ in 0..50 {
        let code = compile_class(&functions, true).expect("compiles");
        assert_eq!(call(&*code, Function::Residual, &state, &[]), expected);
    }
}

#[test]
fn a_function_of_thousands_of_operations_compiles() {
    use eng_compiler::ir::{ClassBody, Graph};
    let layout = InputLayout {
        states: 4,
        ..InputLayout::default()
    };
    let mut g = Graph::new();
    let mut y: Vec<_> = (0..4).map(|i| g.input(layout.state(i))).collect();
    for step in 0..1500 {
        let (a, b) = (step % 4, (step * 7 + 1) % 4);
        let p = g.multiply(y[a], y[b]);
        let c = g.constant(0.3 + 1e-3 * step as f64);
        let q = g.add(p, c);
        let r = if step % 50 == 0 {
            g.unary(Elementary::Sin, q)
        } else {
            g.abs(q)
        };
        let one = g.constant(1.0);
        let s = g.add(one, r);
        y[a] = g.divide(q, s);
    }
    let body = ClassBody {
        name: "Long".into(),
        layout,
        graph: g,
        rates: y,
        ..ClassBody::default()
    };
    let functions = body.functions().expect("a good class");
    assert!(functions.residual.graph.nodes().len() > 7000);
    let state: Vec<f64> = (0..layout.len()).map(|i| 0.1 * f64::from(i)).collect();
    let code = compile_class(&functions, true).expect("compiles");
    let oracle = InterpretedClass::new(&functions);
    for which in [Function::Residual, Function::Linearize] {
        let (a, b) = (
            call(&*code, which, &state, &[]),
            call(&oracle, which, &state, &[]),
        );
        assert!(a.iter().zip(&b).all(|(a, b)| same(*a, *b)));
        assert!(a.iter().all(|x| x.is_finite()));
    }
}

#[test]
fn printed_text_of_a_revolute() {
    let functions = functions(support::revolute);
    insta::assert_snapshot!("revolute_residual", functions.residual);
    insta::assert_snapshot!("revolute_tangent", functions.tangent);
    insta::assert_snapshot!("revolute_velocity", functions.velocity);
}

#[test]
fn a_film_is_cut_where_it_is_narrow() {
    let functions = functions(support::film);
    let count = |f: &eng_compiler::ir::Function| {
        f.graph
            .nodes()
            .iter()
            .filter(|op| !matches!(op, Op::Input(_) | Op::Constant(_)))
            .count()
    };
    let (residual, tangent) = (count(&functions.residual), count(&functions.tangent));
    println!(
        "film: residual {residual}, linearize {}, tangent {tangent}, tape {}",
        count(&functions.linearize),
        functions.tape()
    );
    // a dense Jacobian of the law would take 24 × 12 multiplications
    assert!(tangent < 288 && functions.tape() < 120);
}

/// A row of a start condition: the speed about z is 3 rad/s.
fn speed_row(plain: bool) -> eng_compiler::ir::ClassBody {
    let layout = InputLayout {
        markers: 1,
        rows: 1,
        ..InputLayout::default()
    };
    let mut b = support::Builder::new(layout, plain);
    let spin = b.spin(0);
    let spin = b.inertial(spin, 0);
    let (three, zero) = (b.c(3.0), b.c(0.0));
    let row = b.g.subtract(spin[2], three);
    b.body("Speed", vec![row], vec![[zero; 6]], vec![], vec![])
}

#[test]
fn rows_may_be_affine_in_velocities() {
    let functions = functions(speed_row);
    let layout = functions.layout;
    let code = compile_class(&functions, true).expect("compiles");
    let state = support::state(&layout, &mut Random(4), false);
    let columns = jacobian(&*code, &layout, &state, &[]);
    let m = layout.marker(0) as usize;
    for k in 0..3 {
        let slope = columns[(layout.twist_direction(0) + 3) as usize + k][0];
        assert_eq!(slope, state[m + 3 + 6 + k]);
    }
    // Ṙ ω = R (ω × ω) = 0: no rate at zero acceleration
    let velocity = call(&*code, Function::Velocity, &state, &[]);
    assert!(velocity.iter().all(|x| x.abs() < 1e-14));
}

#[test]
fn bodies_that_do_not_fit_their_layout_are_refused() {
    use eng_compiler::ir::DifferentiateError;
    let mut body = support::revolute(false);
    body.rows.pop();
    assert_eq!(
        body.functions().err(),
        Some(DifferentiateError::Count {
            expected: 5,
            found: 4
        })
    );
    let mut body = support::revolute(false);
    let acceleration = body.graph.input(body.layout.acceleration(0));
    body.loads[0][0] = acceleration;
    assert_eq!(
        body.functions().err(),
        Some(DifferentiateError::Input(body.layout.acceleration(0)))
    );
    let mut body = support::revolute(false);
    let beyond = body.graph.input(body.layout.outputs_len());
    body.outputs.push(beyond);
    assert_eq!(
        body.functions().err(),
        Some(DifferentiateError::Input(body.layout.outputs_len()))
    );
}
