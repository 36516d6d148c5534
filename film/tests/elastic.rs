//! Elastic surfaces: the ring of the reference under load, the tangent, and the rigid limit.

mod states;

use eng_film::{Cavitation, Elastic, Film, FilmSource, Inputs, Shape};
use states::{number, pair, reference};

/// Shapes that do not change across: a constant, and cosines and sines of 2 to `most` waves.
fn waves(most: u32) -> Vec<Shape> {
    let shape = |around, sine| Shape {
        around,
        sine,
        across: 0,
    };
    let pairs = (2..=most).flat_map(|k| [shape(k, false), shape(k, true)]);
    std::iter::once(shape(0, false)).chain(pairs).collect()
}

/// The film of the elastic reference, in units of R = c = μ = ω = 1.
fn film(cells: [usize; 2]) -> Film {
    let mut source = FilmSource::plain(1.0, 1.0, 1.0, Cavitation::Reynolds, cells);
    source.half_width = true;
    source.shapes = waves(8);
    Film::new(source).expect("a film")
}

/// The compliance of the reference's ring: its line load is of p over z, here of p over R θ and z.
fn reference_ring(state: &serde_json::Value) -> Vec<f64> {
    let count = 15;
    let mut compliance = vec![0.0; count * count];
    // q₀ = f₀/2π and q_k = f_k/π
    compliance[0] = number(state, "G0") / std::f64::consts::TAU;
    for k in 2..=8 {
        let g = number(&state["g"], &k.to_string()) / std::f64::consts::PI;
        for at in [2 * k - 3, 2 * k - 2] {
            compliance[at * count + at] = g;
        }
    }
    compliance
}

fn inputs(eccentricity: [f64; 2]) -> Vec<f64> {
    let inputs = Inputs {
        eccentricity,
        spin: 1.0,
        ..Inputs::still(1.0)
    };
    inputs.write()
}

/// Place, least gap, highest pressure and flow under the load, by Newton's method with the tangent; and its rounds.
fn under_load(elastic: &Elastic, load: [f64; 2]) -> ([f64; 5], usize) {
    let (mut work, mut y) = (elastic.work(), [0.0; 5]);
    let mut slopes = vec![0.0; 5 * elastic.inputs()];
    let mut e = [0.75, 0.3];
    for round in 1..40 {
        elastic
            .solve(&inputs(e), None, &[], &mut work, &mut y)
            .expect("a solution");
        elastic.tangent(&mut work, &mut slopes).expect("a tangent");
        let own = elastic.inputs();
        let [a, b, c, d] = [slopes[0], slopes[1], slopes[own], slopes[own + 1]];
        let miss = [y[0] + load[0], y[1] + load[1]];
        let size = a * d - b * c;
        let step = [
            (d * miss[0] - b * miss[1]) / size,
            (a * miss[1] - c * miss[0]) / size,
        ];
        let length = step[0].hypot(step[1]);
        if length < 1e-11 {
            let summary = elastic.film().summary(&work.film);
            let found = [
                e[0],
                e[1],
                summary.minimum_gap,
                summary.maximum_pressure,
                summary.outflow,
            ];
            return (found, round);
        }
        let share = (0.05 / length).min(1.0);
        e = [e[0] - share * step[0], e[1] - share * step[1]];
    }
    panic!("no place under the load");
}

#[test]
fn ring_under_load() {
    let all = reference();
    let state = all["elastic"]
        .as_array()
        .expect("states")
        .iter()
        .find(|state| state["id"] == "ehd_ring")
        .expect("the ring");
    let on = |cells| {
        let elastic = Elastic::new(film(cells), reference_ring(state)).expect("a surface");
        under_load(&elastic, pair(state, "load"))
    };
    let ((coarse, _), (fine, rounds)) = (on([144, 12]), on([288, 24]));
    // the last rounds are quadratic: the tangent is exact
    assert!(rounds < 20, "{rounds}");
    for (at, name) in ["eps_x", "eps_y", "h_min", "pmax", "q_out"]
        .iter()
        .enumerate()
    {
        let extrapolated = fine[at] + (fine[at] - coarse[at]) / 3.0;
        let exact = number(&state["value"], name);
        let error = extrapolated / exact - 1.0;
        println!(
            "{name}: {extrapolated:.6} {exact:.6} {error:.1e}, fine {:.1e}",
            fine[at] / exact - 1.0
        );
        assert!(error.abs() < 5e-3, "{name}: {extrapolated} {exact}");
    }
}

/// The tangent within a step is that of differences, and the memory carries the rate of the surface.
#[test]
fn tangent_of_a_yielding_surface() {
    let all = reference();
    let state = &all["elastic"][1];
    let elastic = Elastic::new(film([48, 6]), reference_ring(state)).expect("a surface");
    let mut work = elastic.work();
    let (mut memory, mut y) = (vec![0.0; elastic.memory()], [0.0; 5]);
    elastic
        .solve(&inputs([0.6, 0.1]), None, &[], &mut work, &mut y)
        .expect("a film");
    elastic.accept(&work, &mut memory);
    assert!(memory.iter().any(|amplitude| amplitude.abs() > 1e-3));
    let x = Inputs {
        eccentricity: [0.7, 0.2],
        rate: [0.3, 0.1],
        spin: 0.9,
        end_pressure: 0.2,
        ..Inputs::still(1.1)
    }
    .write();
    let step = Some(0.2);
    elastic
        .solve(&x, step, &memory, &mut work, &mut y)
        .expect("a film");
    let mut slopes = vec![0.0; 5 * elastic.inputs()];
    elastic.tangent(&mut work, &mut slopes).expect("a tangent");
    for input in [0, 1, 2, 3, 8, 10, 11] {
        let mut at = |by: f64| {
            let (mut moved, mut y) = (x.clone(), [0.0; 5]);
            moved[input] += by;
            elastic
                .solve(&moved, step, &memory, &mut work, &mut y)
                .expect("a film");
            y
        };
        let d = 1e-5;
        let (up, down, far, back) = (at(d), at(-d), at(2.0 * d), at(-2.0 * d));
        for output in [0, 1, 4] {
            let slope =
                (8.0 * (up[output] - down[output]) - (far[output] - back[output])) / (12.0 * d);
            let found = slopes[output * elastic.inputs() + input];
            let size = slope.abs().max(y[output].abs());
            assert!(
                (found - slope).abs() < 1e-7 * size,
                "{output} by {input}: {found} {slope}"
            );
        }
    }
}

/// A nearly rigid surface has the film of a rigid one, and the difference is proportional to its compliance.
#[test]
fn a_stiff_surface_is_the_rigid_one() {
    let all = reference();
    let soft = reference_ring(&all["elastic"][1]);
    let force = |share: f64| {
        let compliance = soft.iter().map(|c| share * c).collect();
        let elastic = Elastic::new(film([48, 6]), compliance).expect("a surface");
        let (mut work, mut y) = (elastic.work(), [0.0; 5]);
        elastic
            .solve(&inputs([0.7, 0.1]), None, &[], &mut work, &mut y)
            .expect("a film");
        y[0]
    };
    let (rigid, little, more) = (force(0.0), force(1e-4), force(2e-4));
    let change = little / rigid - 1.0;
    assert!(change.abs() > 1e-6 && change.abs() < 1e-3, "{change}");
    let ratio = (more - rigid) / (little - rigid);
    assert!((ratio - 2.0).abs() < 1e-2, "{ratio}");
}

/// The stated ring: an opposite pair of loads on a thin ring moves its ends by (π/4 − 2/π) P R³/(E I) (Timoshenko, Strength of
/// Materials II, 1956, art. 13), here as the sum of its waves.
#[test]
fn a_ring_bends_as_in_the_book() {
    let mut source = FilmSource::plain(0.05, 0.02, 5e-5, Cavitation::Reynolds, [24, 4]);
    source.shapes = waves(60);
    let film = Film::new(source).expect("a film");
    let (radius, modulus, area, inertia) = (0.05, 2.1e11, 1e-4, 1e-9);
    let compliance = Elastic::ring(&film, radius, modulus, area, inertia);
    let count = film.source().shapes.len();
    let load = 1000.0;
    let mut moved = 0.0;
    for (at, shape) in film.source().shapes.iter().enumerate() {
        // two outward loads at 0 and 180°: only even waves of the cosine
        if shape.sine || shape.around < 2 {
            continue;
        }
        let force = if shape.around % 2 == 0 {
            2.0 * load
        } else {
            0.0
        };
        moved += 2.0 * compliance[at * count + at] * force;
    }
    let pi = std::f64::consts::PI;
    let exact = (pi / 4.0 - 2.0 / pi) * load * radius.powi(3) / (modulus * inertia);
    assert!((moved / exact - 1.0).abs() < 1e-4, "{moved} {exact}");
}
