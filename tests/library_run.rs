//! What the tests of the library's laws share: runs of texts, integrals, an independent integrator, roots.

pub use crate::support::column;
use crate::support::{self, program};
use eng::results::Results;
use eng::{Outcome, Sources};

/// The outcome of an analysis of a text.
pub fn outcome(text: &str, analysis: &str) -> Outcome {
    support::outcome(&program(text), analysis)
}

/// Results of an analysis of a text.
pub fn run(text: &str, analysis: &str) -> Results {
    outcome(text, analysis).results
}

/// The message with which a text or its analysis is refused.
pub fn refusal(text: &str, analysis: &str) -> String {
    let program = match eng::check(&Sources::from_text("m.eng", text), "m.eng").into_program() {
        Ok(program) => program,
        Err(report) => return report.to_string(),
    };
    let analysis = match program.analysis(analysis) {
        Ok(analysis) => analysis,
        Err(error) => return error.to_string(),
    };
    match analysis.run(&mut |_| {}) {
        Ok(_) => panic!("accepted:\n{text}"),
        Err(failed) => failed.error.to_string(),
    }
}

pub fn last(results: &Results, path: &str) -> f64 {
    let values = column(results, path);
    values[values.len() - 1]
}

pub fn largest(values: &[f64]) -> f64 {
    values.iter().fold(f64::MIN, |m, x| m.max(*x))
}

/// Trapezoidal rule.
pub fn integral(x: &[f64], y: &[f64]) -> f64 {
    let steps = x.windows(2).zip(y.windows(2));
    steps
        .map(|(x, y)| (x[1] - x[0]) * (y[0] + y[1]) / 2.0)
        .sum()
}

/// Fails if a value departs from the due one by more than a share of it.
pub fn close(what: &str, found: f64, due: f64, tolerance: f64) {
    let miss = (found / due - 1.0).abs();
    println!("{what}: {found:.9e} for {due:.9e}, {miss:.1e}");
    assert!(miss <= tolerance, "{what}: {found} for {due}, {miss:.1e}");
}

/// The solution of y' = f(t, y) after `steps` steps of h, by the fifth-order formula of Dormand and Prince
/// (J. Comput. Appl. Math. 6 (1980) 19).
pub fn integrate<const N: usize>(
    f: &dyn Fn(f64, &[f64; N]) -> [f64; N],
    mut y: [f64; N],
    from: f64,
    h: f64,
    steps: usize,
) -> [f64; N] {
    const C: [f64; 6] = [0.0, 0.2, 0.3, 0.8, 8.0 / 9.0, 1.0];
    const A: [&[f64]; 6] = [
        &[],
        &[0.2],
        &[3.0 / 40.0, 9.0 / 40.0],
        &[44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0],
        &[
            19372.0 / 6561.0,
            -25360.0 / 2187.0,
            64448.0 / 6561.0,
            -212.0 / 729.0,
        ],
        &[
            9017.0 / 3168.0,
            -355.0 / 33.0,
            46732.0 / 5247.0,
            49.0 / 176.0,
            -5103.0 / 18656.0,
        ],
    ];
    const B: [f64; 6] = [
        35.0 / 384.0,
        0.0,
        500.0 / 1113.0,
        125.0 / 192.0,
        -2187.0 / 6784.0,
        11.0 / 84.0,
    ];
    let add = |y: &[f64; N], k: &[[f64; N]], a: &[f64]| {
        let mut sum = *y;
        for (k, a) in k.iter().zip(a) {
            for (s, k) in sum.iter_mut().zip(k) {
                *s += h * a * k;
            }
        }
        sum
    };
    for step in 0..steps {
        let t = from + step as f64 * h;
        let mut k = [[0.0; N]; 6];
        for stage in 0..6 {
            let at = add(&y, &k[..stage], A[stage]);
            k[stage] = f(t + C[stage] * h, &at);
        }
        y = add(&y, &k, &B);
    }
    y
}

/// Complex numbers for roots and vibrations: real and imaginary part.
pub type Complex = (f64, f64);

pub fn times(a: Complex, b: Complex) -> Complex {
    (a.0 * b.0 - a.1 * b.1, a.0 * b.1 + a.1 * b.0)
}

pub fn plus(a: Complex, b: Complex) -> Complex {
    (a.0 + b.0, a.1 + b.1)
}

pub fn over(a: Complex, b: Complex) -> Complex {
    let size = b.0 * b.0 + b.1 * b.1;
    times(a, (b.0 / size, -b.1 / size))
}

/// The root of an analytic function near a first value, by secants.
pub fn root(f: &dyn Fn(Complex) -> Complex, first: Complex) -> Complex {
    let (mut a, mut b) = (first, times(first, (1.0 + 1e-4, 1e-5)));
    for _ in 0..60 {
        let (fa, fb) = (f(a), f(b));
        let rise = plus(fb, (-fa.0, -fa.1));
        if rise == (0.0, 0.0) {
            break;
        }
        let step = over(times(fb, plus(b, (-a.0, -a.1))), rise);
        (a, b) = (b, plus(b, (-step.0, -step.1)));
    }
    b
}

/// Amplitude of a line at a phase: values against the phase, both ends of whole periods among them.
pub fn line(values: impl Iterator<Item = f64>, phases: &[f64]) -> nalgebra::Complex<f64> {
    let count = phases.len() - 1;
    let sum: nalgebra::Complex<f64> = values
        .zip(&phases[..count])
        .map(|(value, phase)| nalgebra::Complex::from_polar(value, -phase))
        .sum();
    sum * (2.0 / count as f64)
}

/// Push of a stop at a depth and its rate: stiffness, damping, depth of its begin.
pub fn stop(depth: f64, rate: f64, law: [f64; 3]) -> f64 {
    let depth = depth.max(0.0);
    depth * (law[0] + law[1] * rate / (depth * depth + law[2] * law[2]).sqrt()).max(0.0)
}

/// The figures reported for a motion that never repeats: the share of the time in contact, the number of contacts, the mean load and its
/// root mean square.
pub fn statistics(load: &[f64]) -> [f64; 4] {
    let count = load.len() as f64;
    let begun = load.windows(2).filter(|w| w[0] == 0.0 && w[1] != 0.0);
    [
        load.iter().filter(|x| **x != 0.0).count() as f64 / count,
        begun.count() as f64,
        load.iter().map(|x| x.abs()).sum::<f64>() / count,
        (load.iter().map(|x| x * x).sum::<f64>() / count).sqrt(),
    ]
}

/// Fails if statistics depart from the due ones by more than shares of them.
pub fn compared(found: [f64; 4], due: [f64; 4], tolerances: [f64; 4]) {
    for (k, name) in ["share", "contacts", "mean", "rms"].into_iter().enumerate() {
        close(name, found[k], due[k], tolerances[k]);
    }
}
