//! The parts of a step's time: rigid four- and twelve-cylinder engines, and the four-cylinder engine with a flexible
//! crankshaft (28 modes) and a flexible block (20 modes).
//!
//! `cargo bench --bench step`. Each figure is the minimum and the median of several runs; the two
//! factorisations alternate. `-- laws` compares the laws of the main bearings alone.

use eng::Sources;
use eng_runtime::linear::{BlockLu, LinearSolver, SparseLu};
use eng_runtime::{Options, Simulation};
use eng_system::code::Compiled;
use eng_system::reduced::{Invariants, ReducedBody, ReducedMarker};
use eng_system::system::{BodyInertia, BodyRef, StepControl};
use nalgebra::{DMatrix, Matrix3, Vector3};
use std::sync::Arc;
use std::time::Instant;

type Outcome<T> = Result<T, Box<dyn std::error::Error>>;

/// Step of the fixed-step figures (s).
const STEP: f64 = 1e-5;
/// A revolution of the engine (s).
const REVOLUTION: f64 = 60.0 / 4000.0;

fn clock(repeat: u32, work: &mut dyn FnMut()) -> f64 {
    let begin = Instant::now();
    for _ in 0..repeat {
        work();
    }
    begin.elapsed().as_secs_f64() * 1e6 / f64::from(repeat)
}

/// Minimum and median.
fn figures(mut times: Vec<f64>) -> (f64, f64) {
    times.sort_by(f64::total_cmp);
    (times[0], times[times.len() / 2])
}

fn show(name: &str, times: Vec<f64>) {
    let (least, median) = figures(times);
    println!("  {name:<44} {least:>10.2} {median:>10.2}");
}

/// Many short runs: the shortest are those without other load.
const RUNS: u32 = 301;

fn time(name: &str, repeat: u32, mut work: impl FnMut()) {
    show(name, (0..RUNS).map(|_| clock(repeat, &mut work)).collect());
}

/// Two ways to the same result, alternating. The ratio is the median of the ratios of neighbours.
fn compare(names: [&str; 2], repeat: u32, a: &mut dyn FnMut(), b: &mut dyn FnMut()) {
    let mut times = [Vec::new(), Vec::new()];
    let mut ratios = Vec::new();
    for _ in 0..RUNS {
        let (x, y) = (clock(repeat, a), clock(repeat, b));
        ratios.push(y / x);
        times[0].push(x);
        times[1].push(y);
    }
    let [x, y] = times;
    show(names[0], x);
    show(names[1], y);
    println!("    paired ratio {:.3}", figures(ratios).1);
}

/// The example's text with another number of cylinders in line.
fn text(cylinders: usize) -> Outcome<String> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/inline4/by_hand.eng");
    let mut text = std::fs::read_to_string(folder)?;
    let list = |of: &dyn Fn(usize) -> String| -> String {
        (0..cylinders).map(of).collect::<Vec<_>>().join(", ")
    };
    let middle = (cylinders as f64 + 1.0) / 2.0;
    for (old, new) in [
        ("in 1..4", format!("in 1..{cylinders}")),
        ("in 1..5", format!("in 1..{}", cylinders + 1)),
        (
            "[1, -1, -1, 1]",
            format!("[{}]", list(&|i| ["1", "-1", "-1", "1"][i % 4].into())),
        ),
        (
            "[0, 540, 180, 360] deg",
            format!("[{}] deg", list(&|i| format!("{}", (540 * i) % 720))),
        ),
        ("(i - 2.5)", format!("(i - {middle})")),
        ("(j - 3)", format!("(j - {})", middle + 0.5)),
        ("2.5*spacing]", format!("{}*spacing]", middle)),
        ("main[3]", format!("main[{}]", cylinders / 2 + 1)),
        ("mass = 20.1 kg", format!("mass = {} kg", 5 * cylinders)),
        (
            "[0 mm, 0 mm, 4*spacing]",
            format!("[0 mm, 0 mm, {}*spacing]", cylinders),
        ),
    ] {
        text = text.replace(old, &new);
    }
    Ok(text)
}

fn compiled(text: String) -> Outcome<Compiled> {
    let csv = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/inline4/pressure.csv");
    let sources = Sources::from_texts([
        ("engine.eng".to_string(), text),
        ("pressure.csv".to_string(), std::fs::read_to_string(csv)?),
    ]);
    let program = eng::check(&sources, "engine.eng").into_program()?;
    let mut simulation = program
        .model("Inline4")?
        .simulation()
        .fixed_step(STEP)
        .start()?;
    Ok(simulation.runtime().model().compiled.clone())
}

/// Smooth shapes along the crankshaft's axis on points of mass at the markers and at an outer ring, without
/// rigid content (mean axes), orthonormal in mass; frequencies spread evenly in ratio.
fn reduced(
    places: &[Vector3<f64>],
    mass: f64,
    radius: f64,
    modes: usize,
    frequencies: [f64; 2],
) -> ReducedBody {
    let mut points: Vec<Vector3<f64>> = places.to_vec();
    let stations = 14;
    for k in 0..stations {
        for corner in 0..4 {
            let angle = f64::from(corner) * 1.3 + f64::from(k) * 0.4;
            points.push(Vector3::new(
                radius * angle.cos(),
                radius * angle.sin(),
                0.24 * (2.0 * f64::from(k) / f64::from(stations - 1) - 1.0),
            ));
        }
    }
    let count = points.len();
    let point_mass = mass / count as f64;
    let wave = |mode: usize, p: &Vector3<f64>| {
        let order = (mode / 4 + 1) as f64;
        let phase = 6.5 * order * (p.z + 0.27) + 0.3 * mode as f64;
        match mode % 4 {
            0 => Vector3::new(phase.cos(), 0.1 * phase.sin(), -p.x * phase.sin()),
            1 => Vector3::new(0.05 * phase.sin(), phase.cos(), -p.y * phase.sin()),
            2 => Vector3::new(-p.y, p.x, 0.0) * (10.0 * phase.cos()),
            _ => Vector3::new(p.x * phase.sin(), p.y * phase.cos(), phase.sin()),
        }
    };
    let shapes = DMatrix::from_fn(3 * count, modes, |i, m| wave(m, &points[i / 3])[i % 3]);
    let skew = |v: &Vector3<f64>| v.cross_matrix();
    let mut rigid = DMatrix::zeros(3 * count, 6);
    for (i, p) in points.iter().enumerate() {
        rigid
            .view_mut((3 * i, 0), (3, 3))
            .copy_from(&Matrix3::identity());
        rigid.view_mut((3 * i, 3), (3, 3)).copy_from(&-skew(p));
    }
    let inverse = (rigid.transpose() * &rigid)
        .try_inverse()
        .unwrap_or_else(|| DMatrix::identity(6, 6));
    let free = &inverse * rigid.transpose() * &shapes;
    let shapes = &shapes - &rigid * &free;
    let root = (shapes.transpose() * &shapes * point_mass)
        .cholesky()
        .map(|c| c.l())
        .unwrap_or_else(|| DMatrix::identity(modes, modes));
    let change = root
        .transpose()
        .try_inverse()
        .unwrap_or_else(|| DMatrix::identity(modes, modes));
    let shapes = &shapes * &change;
    let rigid_part = &free * &change;
    let turned = |k: usize| {
        let e = skew(&Vector3::ith(k, 1.0));
        let mut out = shapes.clone();
        for i in 0..count {
            let block = e * shapes.rows(3 * i, 3);
            out.rows_mut(3 * i, 3).copy_from(&block);
        }
        out
    };
    let e: Vec<_> = (0..3).map(turned).collect();
    let flat = |m: &DMatrix<f64>| -> Vec<f64> { m.transpose().as_slice().to_vec() };
    let (t, r) = (rigid.columns(0, 3), rigid.columns(3, 3));
    let moment = r.transpose() * t * point_mass;
    let inertia = r.transpose() * r * point_mass;
    let centrifugal = |j: usize, k: usize| {
        let h = e[j].transpose() * &e[k] * point_mass;
        flat(&((&h + h.transpose()) * 0.5))
    };
    let ratio = (frequencies[1] / frequencies[0]).powf(1.0 / (modes as f64 - 1.0));
    let frequencies: Vec<f64> = (0..modes)
        .map(|m| frequencies[0] * ratio.powi(m as i32))
        .collect();
    let diagonal = |of: &dyn Fn(f64) -> f64| {
        flat(&DMatrix::from_fn(modes, modes, |i, j| {
            if i == j {
                of(frequencies[i] * std::f64::consts::TAU)
            } else {
                0.0
            }
        }))
    };
    let invariants = Invariants {
        modes,
        mass,
        first_moment: [moment[(2, 1)], moment[(0, 2)], moment[(1, 0)]],
        inertia: std::array::from_fn(|i| std::array::from_fn(|j| inertia[(i, j)])),
        translation: flat(&(t.transpose() * &shapes * point_mass)),
        rotation: flat(&(r.transpose() * &shapes * point_mass)),
        rotation_by_shape: std::array::from_fn(|k| flat(&(r.transpose() * &e[k] * point_mass))),
        coriolis: std::array::from_fn(|k| flat(&(shapes.transpose() * &e[k] * point_mass))),
        centrifugal: [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0)]
            .map(|(j, k)| centrifugal(j, k)),
        modal_mass: diagonal(&|_| 1.0),
        stiffness: diagonal(&|w| w * w),
        damping: diagonal(&|w| 0.04 * w),
        ..Invariants::default()
    };
    // rotation at a marker: half the curl of the shapes
    let at = |place: &Vector3<f64>| {
        let d = 1e-4;
        let column = |m: usize| {
            let rate = |k: usize| {
                let step = Vector3::ith(k, d);
                (wave(m, &(place + step)) - wave(m, &(place - step))) / (2.0 * d)
            };
            let (x, y, z) = (rate(0), rate(1), rate(2));
            Vector3::new(y.z - z.y, z.x - x.z, x.y - y.x) * 0.5
        };
        let wide = DMatrix::from_fn(3, modes, |i, m| column(m)[i]);
        flat(&(wide * &change - rigid_part.rows(3, 3)))
    };
    let markers = places
        .iter()
        .enumerate()
        .map(|(i, place)| ReducedMarker {
            name: format!("marker[{i}]"),
            position: (*place).into(),
            translation: flat(&shapes.rows(3 * i, 3).clone_owned()),
            rotation: at(place),
        })
        .collect();
    ReducedBody {
        invariants,
        frequencies,
        markers,
        surfaces: Vec::new(),
    }
}

/// Bends a body of the system.
fn bend(
    compiled: &mut Compiled,
    simulation: &Simulation,
    path: &str,
    modes: usize,
    frequencies: [f64; 2],
    radius: f64,
) -> Outcome<()> {
    let mut system = (*compiled.system).clone();
    let index = system
        .bodies
        .iter()
        .position(|b| b.origin.path == path)
        .ok_or("no such body")?;
    let mut places = Vec::new();
    for (marker, numbers) in system.markers.iter_mut().zip(&simulation.model().markers) {
        let name = marker.origin.path.clone();
        let bends = ["main", "pin", "liner", "flange"]
            .iter()
            .any(|n| name.starts_with(&format!("{path}.{n}")));
        if marker.body == BodyRef::Body(index as u32) && bends {
            marker.shape = Some(places.len() as u32);
            places.push(numbers.position);
        }
    }
    let mass = simulation.model().bodies[index].mass();
    system.bodies[index].inertia = BodyInertia::Flexible(compiled.reduced.len() as u32);
    compiled
        .reduced
        .push(Arc::new(reduced(&places, mass, radius, modes, frequencies)));
    compiled.system = Arc::new(system);
    Ok(())
}

fn options(step: StepControl) -> Options {
    Options {
        step,
        ..Options::default()
    }
}

fn measure(name: &str, compiled: &Compiled) -> Outcome<()> {
    println!("{name}");
    let mut simulation = Simulation::new(compiled, &[], options(StepControl::Fixed(STEP)))?;
    for _ in 0..500 {
        simulation.step()?;
    }
    let size = simulation.unknowns();
    let mut unknowns = vec![0.0; size];
    let mut residual = vec![0.0; size];
    simulation.predicted(STEP, &mut unknowns)?;
    time("residual", 10, || {
        let _ = simulation.residual(STEP, &unknowns, &mut residual);
    });
    time("residual and Jacobian", 2, || {
        let _ = simulation.jacobian(STEP, &unknowns);
    });
    let (pattern, values) = simulation.jacobian(STEP, &unknowns)?;
    let (pattern, values) = (pattern.clone(), values.to_vec());
    println!("  {size} unknowns, {} entries", values.len());
    let mut general = SparseLu::new(&pattern)?;
    let mut blocks = BlockLu::new(&pattern);
    compare(
        ["factorisation, general sparse", "factorisation by blocks"],
        1,
        &mut || general.factor(&values).unwrap_or_default(),
        &mut || blocks.factor(&values).unwrap_or_default(),
    );
    let mut other = residual.clone();
    compare(
        ["solution, general sparse", "solution by blocks"],
        10,
        &mut || general.solve(&mut residual),
        &mut || blocks.solve(&mut other),
    );
    println!("  blocks gave up {} times", blocks.fallbacks());
    for (kind, step) in [
        ("10 us", StepControl::Fixed(STEP)),
        ("error control", StepControl::Tolerance(1.0)),
    ] {
        let mut simulation = Simulation::new(compiled, &[], options(step))?;
        for _ in 0..200 {
            simulation.step()?;
        }
        let (before, from) = (simulation.statistics(), simulation.time());
        let times = (0..100)
            .map(|_| {
                clock(10, &mut || {
                    let _ = simulation.step();
                })
            })
            .collect();
        show(&format!("step, {kind}"), times);
        let after = simulation.statistics();
        let to = simulation.time();
        let steps = (after.steps - before.steps) as f64;
        let per = |a: u64, b: u64| (a - b) as f64 / steps;
        let counted = allocation_counter::measure(|| {
            for _ in 0..100 {
                let _ = simulation.step();
            }
        });
        println!("    100 more steps allocate {} times", counted.count_total);
        println!(
            "    a step: {:.1} us, {:.2} iterations, {:.2} residuals, {:.3} factorisations, {:.3} rejected, {:.3} failed; {} fallbacks",
            (to - from) / steps * 1e6,
            per(after.iterations, before.iterations),
            per(after.residuals, before.residuals),
            per(after.factorizations, before.factorizations),
            per(after.rejected, before.rejected),
            per(after.failed, before.failed),
            after.fallbacks,
        );
    }
    Ok(())
}

/// The law of five main bearings: time of a step in alternating runs, and how long the step keeps its matrix.
fn laws() -> Outcome<()> {
    println!("rigid, 4 cylinders, laws of the main bearings");
    let with = |law: &str| compiled(text(4)?.replace("Impedance", law));
    for (kind, step) in [
        ("10 us", StepControl::Fixed(STEP)),
        ("error control", StepControl::Tolerance(1.0)),
    ] {
        let run = |law: &str| -> Outcome<Simulation> {
            let mut simulation = Simulation::new(&with(law)?, &[], options(step))?;
            for _ in 0..200 {
                simulation.step()?;
            }
            Ok(simulation)
        };
        let (mut formula, mut table) = (run("Impedance")?, run("Reynolds")?);
        let (mut first, mut second) = (Ok(()), Ok(()));
        compare(
            [
                &format!("step, {kind}, Impedance"),
                &format!("step, {kind}, Reynolds"),
            ],
            20,
            &mut || first = formula.step().map(drop),
            &mut || second = table.step().map(drop),
        );
        first?;
        second?;
    }
    for law in ["Impedance", "Reynolds", "Film"] {
        let control = StepControl::Tolerance(1.0);
        let mut simulation = Simulation::new(&with(law)?, &[], options(control))?;
        while simulation.time() < REVOLUTION {
            simulation.step()?;
        }
        let counts = simulation.statistics();
        let steps = counts.steps as f64;
        println!(
            "  {law}: {:.2} iterations and {:.3} factorisations a step",
            counts.iterations as f64 / steps,
            counts.factorizations as f64 / steps
        );
    }
    Ok(())
}

fn main() -> Outcome<()> {
    println!("  {:<44} {:>10} {:>10}", "us a time", "minimum", "median");
    if std::env::args().any(|argument| argument == "laws") {
        return laws();
    }
    let four = compiled(text(4)?)?;
    measure("rigid, 4 cylinders", &four)?;
    measure("rigid, 12 cylinders", &compiled(text(12)?)?)?;
    let rigid = Simulation::new(&four, &[], options(StepControl::Fixed(STEP)))?;
    let mut flexible = four.clone();
    bend(&mut flexible, &rigid, "crank", 28, [350.0, 30_000.0], 0.05)?;
    bend(&mut flexible, &rigid, "block", 20, [600.0, 20_000.0], 0.2)?;
    measure("flexible crank and block, 28 + 20 modes", &flexible)?;
    laws()
}
