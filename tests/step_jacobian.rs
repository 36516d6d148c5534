//! The exact matrix of a step against differences of its residual, in both examples, at the steps they are run with.
//!
//! A step of 20 µs makes 1 m/s out of 10 µm, and the films of the engine squeeze with some mm/s. So a difference over d
//! sees their forces bent from d = 1e-8 on, while below it the rounding of the residual, some 1e-16, is divided by too
//! small a d. A plain difference has no increment that is good to 1e-8; see [`plain_differences_err_both_ways`]. Here
//! the residual is developed in Chebyshev polynomials over an interval instead: they take the bend, many points average
//! the rounding, and the coefficients themselves give the error of the slope.

use eng::Sources;
use std::f64::consts::PI;
use std::path::Path;

const STEP: f64 = 2e-5;
/// Allowed deviation, as a share of the norm of a row.
const TOLERANCE: f64 = 1e-8;
/// Rounding, as a share of the exact entries.
const ROUNDING: f64 = 1e-12;

/// An example after some steps, and the exact matrix of its next one.
struct Case {
    simulation: eng::Simulation,
    step: f64,
    /// Predicted unknowns.
    at: Vec<f64>,
    /// Column-major.
    exact: Vec<Vec<f64>>,
    /// The norm of each row.
    norms: Vec<f64>,
}

impl Case {
    /// The case of a text in a folder, `examples/inline4/inline4`.
    fn new(path: &str, name: &str, steps: u32, step: f64) -> Case {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(path);
        let (folder, file) = (path.parent(), path.file_name().and_then(|f| f.to_str()));
        let sources = Sources::folder(folder.expect("a folder")).expect("the folder");
        let mut simulation = eng::check(&sources, &format!("{}.eng", file.expect("a file")))
            .into_program()
            .unwrap_or_else(|report| panic!("{report}"))
            .analysis(name)
            .unwrap_or_else(|error| panic!("{error}"))
            .model()
            .simulation()
            .fixed_step(STEP)
            .start()
            .unwrap_or_else(|error| panic!("{error}"));
        for _ in 0..steps {
            simulation.step().unwrap_or_else(|error| panic!("{error}"));
        }
        let runtime = simulation.runtime();
        let n = runtime.unknowns();
        let mut at = vec![0.0; n];
        // a longer step looks at the short move too: its velocities then change little against the squeeze of the films
        runtime.predicted(STEP, &mut at).expect("a prediction");
        let (pattern, values) = runtime.jacobian(step, &at).expect("a matrix");
        let mut exact = vec![vec![0.0; n]; n];
        for (row, column, value) in pattern.entries(values) {
            exact[column][row] = value;
        }
        let norms = (0..n)
            .map(|row| exact.iter().map(|c| c[row] * c[row]).sum::<f64>().sqrt())
            .collect();
        Case {
            simulation,
            step,
            at,
            exact,
            norms,
        }
    }

    /// `(f(x + d) − f(x − d))/2` along a column, corrected for the rounding of x ± d.
    fn odd_part(&mut self, column: usize, d: f64) -> Vec<f64> {
        let n = self.at.len();
        let mut x = self.at.clone();
        let (up, down) = (self.at[column] + d, self.at[column] - d);
        let (mut high, mut low) = (vec![0.0; n], vec![0.0; n]);
        let runtime = self.simulation.runtime();
        for (place, out) in [(up, &mut high), (down, &mut low)] {
            x[column] = place;
            runtime.residual(self.step, &x, out).expect("finite");
        }
        high.iter()
            .zip(&low)
            .map(|(a, b)| (a - b) * d / (up - down))
            .collect()
    }

    /// Slopes of all rows along a column with their errors, from the interval (−reach, reach).
    ///
    /// The odd part is `Σ a_j T_{2j+1}(d/reach)`; at the points `cos((2k − 1)π/4N)`, k = 1…N, the sums
    /// `a_j = 2/N Σ_k g_k T_{2j+1}(t_k)` are exact for polynomials below degree 4N (discrete orthogonality;
    /// Trefethen, Approximation Theory and Approximation Practice, ch. 3). Rounding appears as a level at which the
    /// coefficients stop falling: σ, the root mean square of their last half. Those above 4σ make the slope
    /// `Σ (−1)^j (2j + 1) a_j/reach`. Its error is that of all N coefficients wrong by 4σ in the worst way,
    /// `4σ N²/reach`: so it also holds if a kink makes them fall slowly. Where they have not come down to the level
    /// by half of N, there is no slope. Where all differences are lost in rounding, σ is not zero but that of a
    /// number of the row's size.
    fn chebyshev(&mut self, column: usize, reach: f64) -> Vec<Slope> {
        const POINTS: usize = 64;
        let n = self.at.len();
        let mut coefficients = vec![[0.0; POINTS]; n];
        for k in 0..POINTS {
            let angle = (2 * k + 1) as f64 * PI / (4 * POINTS) as f64;
            let part = self.odd_part(column, reach * angle.cos());
            for (a, g) in coefficients.iter_mut().zip(part) {
                for (j, a) in a.iter_mut().enumerate() {
                    *a += 2.0 / POINTS as f64 * g * ((2 * j + 1) as f64 * angle).cos();
                }
            }
        }
        coefficients
            .iter()
            .zip(&self.norms)
            .map(|(a, norm)| {
                let rest = &a[POINTS / 2..];
                let mut level =
                    (rest.iter().map(|x| x * x).sum::<f64>() / rest.len() as f64).sqrt();
                if level == 0.0 {
                    level = f64::EPSILON / 16.0 * norm;
                }
                let above = a[..POINTS / 2].iter().rposition(|x| x.abs() > 4.0 * level);
                let count = above.map_or(1, |j| j + 1);
                if count > POINTS / 2 - 4 {
                    return Slope::UNKNOWN;
                }
                let terms = a[..count].iter().enumerate().map(|(j, a)| {
                    let degree = (2 * j + 1) as f64;
                    if j % 2 == 0 { degree * a } else { -degree * a }
                });
                Slope {
                    value: terms.sum::<f64>() / reach,
                    error: 4.0 * level * (POINTS * POINTS) as f64 / reach,
                }
            })
            .collect()
    }

    /// The best slopes of a column over intervals of several sizes, each entry the one with the smallest error.
    fn slopes(&mut self, column: usize) -> Vec<Slope> {
        let mut best = vec![Slope::UNKNOWN; self.at.len()];
        for reach in [1e-3, 3e-5, 1e-6, 3e-7, 1e-7, 3e-8] {
            for (best, slope) in best.iter_mut().zip(self.chebyshev(column, reach)) {
                if slope.error < best.error {
                    *best = slope;
                }
            }
            let known = |(slope, norm): (&Slope, &f64)| slope.error <= 0.1 * TOLERANCE * norm;
            if best.iter().zip(&self.norms).all(known) {
                break;
            }
        }
        best
    }

    /// Largest deviation and largest estimated error of the slopes, as shares of the norms of the rows. No entry
    /// deviates by more than its estimated error.
    fn compare(&mut self) -> (f64, f64) {
        let (mut largest_miss, mut largest_error) = (0.0_f64, 0.0_f64);
        for column in 0..self.at.len() {
            let slopes = self.slopes(column);
            for (row, (slope, norm)) in slopes.iter().zip(&self.norms).enumerate() {
                let miss = (slope.value - self.exact[column][row]).abs() / norm;
                let error = slope.error / norm;
                assert!(
                    miss <= error + ROUNDING,
                    "row {row}, column {column}: {miss:.1e} where {error:.1e} is known"
                );
                largest_miss = largest_miss.max(miss);
                largest_error = largest_error.max(error);
            }
        }
        (largest_miss, largest_error)
    }

    /// Largest deviation of central differences over d, and of their extrapolation from d, d/2 and d/4 (sixth order).
    fn plain_miss(&mut self, d: f64) -> (f64, f64) {
        let (mut second, mut sixth) = (0.0_f64, 0.0_f64);
        for column in 0..self.at.len() {
            let [a, b, c] = [d, 0.5 * d, 0.25 * d].map(|d| (self.odd_part(column, d), d));
            for (row, norm) in self.norms.iter().enumerate() {
                let of = |(part, d): &(Vec<f64>, f64)| part[row] / d;
                let (one, two) = ((4.0 * of(&b) - of(&a)) / 3.0, (4.0 * of(&c) - of(&b)) / 3.0);
                let miss = |x: f64| (x - self.exact[column][row]).abs() / norm;
                second = second.max(miss(of(&a)));
                sixth = sixth.max(miss((16.0 * two - one) / 15.0));
            }
        }
        (second, sixth)
    }
}

#[derive(Clone, Copy)]
struct Slope {
    value: f64,
    error: f64,
}

impl Slope {
    const UNKNOWN: Slope = Slope {
        value: f64::NAN,
        error: f64::INFINITY,
    };
}

#[test]
fn the_steps_matrix_is_exact() {
    for (example, name, steps, step) in [
        ("examples/slider_crank/slider_crank", "inertia", 30, STEP),
        ("examples/slider_crank/slider_crank", "inertia", 30, 2e-4),
        ("examples/inline4/inline4", "fired", 30, STEP),
        ("examples/inline4/inline4", "fired", 300, STEP),
        ("examples/inline4/inline4", "fired", 30, 1e-3),
    ] {
        let (miss, error) = Case::new(example, name, steps, step).compare();
        println!(
            "{example}, {steps} steps, {step} s: {miss:.1e}, differences known to {error:.1e}"
        );
        assert!(
            error <= TOLERANCE,
            "{example}: differences known to {error:.1e} only"
        );
        assert!(miss <= TOLERANCE, "{example}: {miss:.1e} of the row norm");
    }
}

/// The deviation of plain differences over their increment is a V. Its two sides are their own errors: rounding,
/// which falls as 1/d, and truncation, which rises as d² (and as d⁶ after extrapolation). Its lowest point is above
/// the tolerance, so plain differences cannot decide. The matrix of the comparison is the same for all increments.
#[test]
fn plain_differences_err_both_ways() {
    let mut case = Case::new("examples/inline4/inline4", "fired", 30, STEP);
    let scan: Vec<(f64, f64, f64)> = (0..=24)
        .map(|k| {
            let d = 1e-12 * 10f64.powf(f64::from(k) / 4.0);
            let (second, sixth) = case.plain_miss(d);
            println!("{d:.1e}: {second:.1e} {sixth:.1e}");
            (d, second, sixth)
        })
        .collect();
    // slope in the double-logarithmic plot between two of the increments
    let slope = |from: usize, to: usize, of: fn(&(f64, f64, f64)) -> f64| {
        (of(&scan[to]) / of(&scan[from])).log10() / (scan[to].0 / scan[from].0).log10()
    };
    let rounding = slope(0, 8, |s| s.1);
    let truncation = slope(12, 16, |s| s.1);
    assert!(
        (rounding + 1.0).abs() < 0.4,
        "1e-12 to 1e-10: {rounding:.2}"
    );
    assert!(
        (truncation - 2.0).abs() < 0.1,
        "1e-9 to 1e-8: {truncation:.2}"
    );
    let truncation = slope(19, 21, |s| s.2);
    assert!(
        (truncation - 6.0).abs() < 1.5,
        "5.6e-8 to 1.8e-7: {truncation:.2}"
    );
    let least = |of: fn(&(f64, f64, f64)) -> f64| scan.iter().map(of).fold(f64::INFINITY, f64::min);
    assert!(least(|s| s.1) > TOLERANCE && least(|s| s.2) > TOLERANCE);
}

/// Films on cells, tilted, with a groove, a lemon bore and oil that thickens. Their forces have a kink where a cell
/// changes sides. So each entry needs an increment that changes no cell. The remaining error is rounding.
#[test]
fn the_matrix_of_films_on_cells_is_exact() {
    // the films of the second have a temperature; the third has a bore that yields, by the modes of its body
    // and beside them
    for (model, steps) in [
        ("tests/good/films", 10),
        ("tests/good/films", 60),
        ("tests/good/thermal", 20),
        ("tests/mesh/shell", 20),
    ] {
        let mut case = Case::new(model, "run", steps, STEP);
        for column in 0..case.at.len() {
            let mut least = vec![f64::INFINITY; case.at.len()];
            // noise of the search falls as 1/d until cells change, at another increment for each entry
            for d in [
                1e-12, 1e-11, 1e-10, 1e-9, 3e-9, 1e-8, 2e-8, 3e-8, 5e-8, 1e-7,
            ] {
                let part = case.odd_part(column, d);
                let rows = part.iter().zip(&case.exact[column]).zip(&case.norms);
                for (least, ((p, exact), norm)) in least.iter_mut().zip(rows) {
                    *least = least.min((p / d - exact).abs() / norm);
                }
            }
            let miss = least.into_iter().fold(0.0, f64::max);
            println!("{model}, {steps} steps, column {column}: {miss:.1e}");
            assert!(miss < 1e-7, "{miss:.1e}");
        }
    }
}
