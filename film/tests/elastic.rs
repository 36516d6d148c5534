//! Elastic surfaces: the ring of the reference under load, the tangent, and the rigid limit.

use crate::states::{number, pair, reference};
use eng_film::{
    Accuracy, Cavitation, Elastic, ElasticRing, ElasticWork, Film, FilmSource, Inputs, Quantity,
    Shape, inputs,
};
use serde_json::Value;

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

/// A ring whose ovality yields by a tenth of the clearance, in units of R = c = μ = ω = 1.
fn soft_ring() -> ElasticRing {
    ElasticRing {
        thickness: 0.775,
        width: 1.29,
        modulus: 33.0,
        poisson: 0.3,
    }
}

fn inputs(eccentricity: [f64; 2]) -> Vec<f64> {
    let inputs = Inputs {
        eccentricity,
        spin: 1.0,
        ..Inputs::still(1.0)
    };
    inputs.write()
}

/// The numbers of [`under_load`], and their limits relative to those of the reference.
const OF_LOAD: [(&str, f64); 8] = [
    ("eps_x", 3e-3),
    ("eps_y", 3e-3),
    ("h_min", 3e-3),
    // the series of shapes ends at 16 waves and the degree 10
    ("h_mid", 5e-3),
    ("h_end", 3e-3),
    ("pmax", 3e-3),
    ("q_out", 3e-3),
    ("couette_full", 3e-3),
];

/// Compares numbers under load with the reference, extrapolated from cells and from half as large cells. The place of the
/// highest pressure is that of the smaller cells, in degrees.
fn compare(state: &Value, coarse: &Loaded, fine: &Loaded) {
    let exact = &state["value"];
    for ((name, limit), (coarse, fine)) in
        OF_LOAD.iter().zip(coarse.numbers.iter().zip(fine.numbers))
    {
        let extrapolated = fine + (fine - coarse) / 3.0;
        let exact = number(exact, name);
        let error = extrapolated / exact - 1.0;
        println!(
            "{name}: {extrapolated:.6} {exact:.6} {error:.1e}, fine {:.1e}",
            fine / exact - 1.0
        );
        assert!(error.abs() < *limit, "{name}: {extrapolated} {exact}");
    }
    let (place, exact) = (fine.highest.to_degrees(), number(exact, "theta_pmax"));
    println!("theta_pmax: {place:.4} {exact:.4}");
    assert!((place - exact).abs() < 0.15, "{place} {exact}");
}

/// A pin under load: the numbers of [`OF_LOAD`], and the angle of the highest pressure.
struct Loaded {
    numbers: [f64; 8],
    highest: f64,
    rounds: usize,
}

/// The least gap around, by a parabola through three columns; `of` takes it from the gaps in the cells of a column.
fn thinnest(elastic: &Elastic, work: &ElasticWork, of: impl Fn(&[f64]) -> f64) -> f64 {
    let film = elastic.film();
    let [around, across] = film.cells();
    let mut gaps = vec![0.0; around * across];
    film.field(Quantity::Gap, &work.film, &mut gaps);
    let row: Vec<f64> = gaps.chunks(across).map(of).collect();
    let least = (0..around)
        .min_by(|a, b| row[*a].total_cmp(&row[*b]))
        .expect("a cell");
    let [before, behind] = [around - 1, 1].map(|step| row[(least + step) % around]);
    let (slope, bend) = ((behind - before) / 2.0, before + behind - 2.0 * row[least]);
    row[least] - slope * slope / (2.0 * bend)
}

/// A pin under the load, by Newton's method with the tangent.
fn under_load(elastic: &Elastic, load: [f64; 2]) -> Loaded {
    let (mut work, mut y) = (elastic.work(), [0.0; inputs::SHAPE_FORCE]);
    let mut slopes = vec![0.0; inputs::SHAPE_FORCE * elastic.inputs()];
    let mut e = [0.75, 0.3];
    for round in 1..40 {
        elastic
            .solve(&inputs(e), None, &[], Accuracy::Full, &mut work, &mut y)
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
            let numbers = [
                e[0],
                e[1],
                summary.minimum_gap,
                // even functions of z from the middle on; a straight line to the end
                thinnest(elastic, &work, |h| (9.0 * h[0] - h[1]) / 8.0),
                thinnest(elastic, &work, |h| {
                    1.5 * h[h.len() - 1] - 0.5 * h[h.len() - 2]
                }),
                summary.maximum_pressure,
                summary.outflow,
                summary.shear_torque,
            ];
            let highest = summary.maximum_pressure_at.angle;
            return Loaded {
                numbers,
                highest,
                rounds: round,
            };
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
    let (coarse, fine) = (on([144, 12]), on([288, 24]));
    // the last rounds are quadratic: the tangent is exact
    assert!(fine.rounds < 20, "{}", fine.rounds);
    compare(state, &coarse, &fine);
}

/// A shell that yields at each place by the pressure there (Winkler), as a sum of waves and even polynomials:
/// place, gaps, highest pressure, flow, shear. The gap is least at the ends, where there is no pressure. The
/// polynomials need some cells each: with degree 14 on 16 cells of the half the gap there is 2 % off.
#[test]
fn winkler_shell_under_load() {
    let all = reference();
    let state = &all["elastic"][0];
    assert_eq!(state["id"], "ehd_winkler");
    let on = |cells: [usize; 2]| {
        let mut source = FilmSource::plain(1.0, 1.0, 1.0, Cavitation::Reynolds, cells);
        source.half_width = true;
        for across in (0..=10).step_by(2) {
            for around in 0..=16 {
                for sine in [false, true] {
                    if around > 0 || !sine {
                        source.shapes.push(Shape {
                            around,
                            sine,
                            across,
                        });
                    }
                }
            }
        }
        // w = C p is b = C G⁻¹ f, with G = ∫ ψ² dA over the width 1
        let size = |shape: &Shape| {
            let around = if shape.around == 0 { 2.0 } else { 1.0 };
            around * std::f64::consts::PI / f64::from(2 * shape.across + 1)
        };
        let sizes: Vec<f64> = source.shapes.iter().map(size).collect();
        let mut compliance = vec![0.0; sizes.len() * sizes.len()];
        for (at, size) in sizes.iter().enumerate() {
            compliance[at * sizes.len() + at] = number(state, "C") / size;
        }
        let film = Film::new(source).expect("a film");
        under_load(
            &Elastic::new(film, compliance).expect("a surface"),
            pair(state, "load"),
        )
    };
    compare(state, &on([72, 16]), &on([144, 32]));
}

/// The tangent within a step is that of differences, and the memory carries the rate of the surface.
#[test]
fn tangent_of_a_yielding_surface() {
    let all = reference();
    let state = &all["elastic"][1];
    let elastic = Elastic::new(film([48, 6]), reference_ring(state)).expect("a surface");
    let mut work = elastic.work();
    let (mut memory, mut y) = (vec![0.0; elastic.memory()], [0.0; inputs::SHAPE_FORCE]);
    elastic
        .solve(
            &inputs([0.6, 0.1]),
            None,
            &[],
            Accuracy::Full,
            &mut work,
            &mut y,
        )
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
        .solve(&x, step, &memory, Accuracy::Full, &mut work, &mut y)
        .expect("a film");
    let mut slopes = vec![0.0; inputs::SHAPE_FORCE * elastic.inputs()];
    elastic.tangent(&mut work, &mut slopes).expect("a tangent");
    for input in [0, 1, 2, 3, 8, 10, 11] {
        let mut at = |by: f64| {
            let (mut moved, mut y) = (x.clone(), [0.0; inputs::SHAPE_FORCE]);
            moved[input] += by;
            elastic
                .solve(&moved, step, &memory, Accuracy::Full, &mut work, &mut y)
                .expect("a film");
            y
        };
        let d = 1e-4;
        let (up, down, far, back) = (at(d), at(-d), at(2.0 * d), at(-2.0 * d));
        for output in 0..inputs::SHAPE_FORCE {
            let slope =
                (8.0 * (up[output] - down[output]) - (far[output] - back[output])) / (12.0 * d);
            let found = slopes[output * elastic.inputs() + input];
            let size = slope.abs().max(y[output].abs());
            assert!(
                (found - slope).abs() <= 1e-8 * size,
                "{output} by {input}: {found} {slope}"
            );
        }
    }
}

/// Memory that leaves out the derivatives of some outputs changes neither values nor the derivatives of
/// others by more than the last change of a surface.
#[test]
fn some_derivatives_are_those_of_all() {
    let all = reference();
    let elastic =
        Elastic::new(film([48, 6]), reference_ring(&all["elastic"][1])).expect("a surface");
    let rigid = Elastic::new(film([48, 6]), vec![0.0; 225]).expect("a surface");
    let mut wanted = [false; inputs::SHAPE_FORCE];
    wanted[inputs::TORQUE] = true;
    for (elastic, error) in [(&elastic, 1e-9), (&rigid, 0.0)] {
        let [(y, slopes, slow), (some_y, some, some_slow)] =
            [elastic.work(), elastic.work_for(&wanted)].map(|mut work| {
                let mut y = [0.0; inputs::SHAPE_FORCE];
                let x = inputs([0.6, 0.1]);
                elastic
                    .solve(&x, None, &[], Accuracy::Full, &mut work, &mut y)
                    .expect("a film");
                let slow = elastic.stiffness_and_damping(&mut work).expect("slopes");
                let mut slopes = vec![f64::NAN; inputs::SHAPE_FORCE * elastic.inputs()];
                elastic.tangent(&mut work, &mut slopes).expect("a tangent");
                (y, slopes, slow)
            });
        let near = |a: f64, b: f64| (a - b).abs() <= error * a.abs().max(1.0);
        assert!(y.iter().zip(&some_y).all(|(a, b)| near(*a, *b)));
        // the forces are always there: stiffness and damping need them
        assert!(slow.iter().zip(&some_slow).all(|(a, b)| near(*a, *b)));
        let rows = slopes.chunks_exact(elastic.inputs());
        for (output, (all, some)) in rows.zip(some.chunks_exact(elastic.inputs())).enumerate() {
            match output {
                0 | 1 | inputs::TORQUE => {
                    assert!(all.iter().zip(some).all(|(a, b)| near(*a, *b)), "{output}");
                }
                _ => assert!(some.iter().all(|x| *x == 0.0), "{output}"),
            }
        }
        assert!(slopes[inputs::LOSS * elastic.inputs() + inputs::SPIN] != 0.0);
    }
}

/// An iterate has an error far below the change since the last one, and takes fewer rounds.
#[test]
fn iterates_approach_the_solution() {
    let film = film([48, 5]);
    let ring = soft_ring().compliance(&film);
    let elastic = Elastic::new(film, ring).expect("a surface");
    let memory = vec![0.0; elastic.memory()];
    let solve = |accuracy: Accuracy, x: f64, work: &mut ElasticWork| {
        let mut y = [0.0; inputs::SHAPE_FORCE];
        let e = inputs([0.7 + x, 0.2]);
        let step = Some(0.1);
        elastic
            .solve(&e, step, &memory, accuracy, work, &mut y)
            .expect("a film");
        y[inputs::FORCE]
    };
    let (mut iterated, mut rounds) = (elastic.work(), [0, 0]);
    let mut last = solve(Accuracy::Full, 0.1, &mut iterated);
    for x in [1e-2, 1e-3, 1e-4, 1e-6, 1e-8] {
        let mut fresh = elastic.work();
        let exact = solve(Accuracy::Full, x, &mut fresh);
        let mut other = iterated.clone();
        solve(Accuracy::Full, x, &mut other);
        let found = solve(Accuracy::Iterate, x, &mut iterated);
        let (error, change) = ((found - exact).abs(), (exact - last).abs());
        assert!(error < 1e-3 * change, "{error:e} of {change:e}");
        rounds = [rounds[0] + iterated.rounds, rounds[1] + other.rounds];
        last = exact;
    }
    println!("rounds of iterates and of solutions: {rounds:?}");
    assert!(rounds[0] < rounds[1]);
}

/// A search that begins at the numbers of another one has its bits.
#[test]
fn a_search_continues_elsewhere() {
    let film = film([48, 5]);
    let ring = soft_ring().compliance(&film);
    let elastic = Elastic::new(film, ring).expect("a surface");
    let (mut work, mut y) = (elastic.work(), [0.0; inputs::SHAPE_FORCE]);
    let mut memory = vec![0.0; elastic.memory()];
    let turned = |angle: f64| inputs([0.8 * angle.cos(), 0.8 * angle.sin()]);
    for at in 0..3 {
        let x = turned(0.02 * f64::from(at));
        elastic
            .solve(&x, Some(0.1), &memory, Accuracy::Full, &mut work, &mut y)
            .expect("a film");
        elastic.accept(&work, &mut memory);
    }
    let mut numbers = Vec::new();
    elastic.kept(&work, &mut numbers);
    let mut other = elastic.work();
    assert!(elastic.keep(&mut other, &numbers).is_empty());
    let mut z = y;
    for off in [0.0, 1e-3] {
        let x = turned(0.06 + off);
        for (work, y) in [(&mut work, &mut y), (&mut other, &mut z)] {
            elastic
                .solve(&x, Some(0.1), &memory, Accuracy::Full, work, y)
                .expect("a film");
        }
        assert_eq!(y.map(f64::to_bits), z.map(f64::to_bits));
    }
    // the same inputs once more: the search is at its end
    let mut third = elastic.work();
    numbers.clear();
    elastic.kept(&work, &mut numbers);
    elastic.keep(&mut third, &numbers);
    elastic
        .solve(
            &turned(0.061),
            Some(0.1),
            &memory,
            Accuracy::Full,
            &mut third,
            &mut z,
        )
        .expect("a film");
    assert_eq!(third.rounds, 1);
    // too few numbers: the search begins anew
    elastic.keep(&mut third, &numbers[..numbers.len() / 2]);
    elastic
        .solve(
            &turned(0.06),
            Some(0.1),
            &memory,
            Accuracy::Full,
            &mut third,
            &mut z,
        )
        .expect("a film");
}

/// However short a step is, the search finds the surface, from its place at the beginning of the step. In a
/// short step a small change of an amplitude is a fast one, and Newton's way from the surface at rest would
/// leave the film behind.
#[test]
fn short_steps_find_their_place() {
    let mut source = FilmSource::plain(24e-3, 22e-3, 25e-6, Cavitation::Reynolds, [36, 5]);
    source.shapes = waves(10);
    source.floor = 25e-9;
    let film = Film::new(source).expect("a film");
    let compliance = ElasticRing {
        thickness: 16e-3,
        width: 22e-3,
        modulus: 210e9,
        poisson: 0.3,
    }
    .compliance(&film);
    let elastic = Elastic::new(film, compliance).expect("a surface");
    let (mut memory, mut y) = (vec![0.0; elastic.memory()], [0.0; inputs::SHAPE_FORCE]);
    let mut state = 12345_u64;
    let mut draw = || {
        state = state
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (state >> 33) as f64 / (1_u64 << 31) as f64
    };
    let turn = std::f64::consts::TAU;
    let mut most = 0;
    for trial in 0..150 {
        let (ratio, angle) = (1.02 * draw().sqrt(), turn * draw());
        let place = [ratio * 25e-6 * angle.cos(), ratio * 25e-6 * angle.sin()];
        let mut at = Inputs {
            eccentricity: place,
            spin: 419.0,
            ..Inputs::still(7e-3)
        };
        let mut work = elastic.work();
        elastic
            .solve(&at.write(), None, &[], Accuracy::Full, &mut work, &mut y)
            .expect("a steady film");
        elastic.accept(&work, &mut memory);
        for step in [1e-3, 1e-4, 1e-5, 1e-6, 1e-8, 1e-10, 1e-5] {
            let (speed, angle) = (0.2 * draw() * draw(), turn * draw());
            at.rate = [speed * angle.cos(), speed * angle.sin()];
            let moved = f64::min(step, 1e-5);
            at.eccentricity = [place[0] + moved * at.rate[0], place[1] + moved * at.rate[1]];
            let solved = elastic.solve(
                &at.write(),
                Some(step),
                &memory,
                Accuracy::Full,
                &mut work,
                &mut y,
            );
            assert!(
                solved.is_ok(),
                "{trial} ratio {ratio}, step {step}: {solved:?}"
            );
            most = most.max(work.rounds);
        }
    }
    println!("{most} rounds at most");
}

/// A surface that is twice as wide as the film has half of a cone's slope in the film.
#[test]
fn a_surface_may_be_wider_than_its_film() {
    let solved = |wider: f64| {
        let mut source = FilmSource::plain(1.0, 1.0, 1.0, Cavitation::Reynolds, [48, 8]);
        source.shapes = vec![Shape {
            around: 2,
            sine: false,
            across: 1,
        }];
        source.shape_width = wider;
        let film = Film::new(source).expect("a film");
        let (mut work, mut y) = (film.work(), vec![0.0; film.outputs()]);
        let x = Inputs {
            eccentricity: [0.5, 0.2],
            spin: 1.0,
            deflection: &[0.1 * wider],
            deflection_rate: &[0.0],
            ..Inputs::still(1.0)
        };
        film.solve(&x.write(), None, &[], &mut work, &mut y)
            .expect("a solution");
        let summary = film.summary(&work);
        y.truncate(5);
        y.extend([summary.minimum_gap, summary.maximum_pressure]);
        y
    };
    for (same, wider) in solved(1.0).iter().zip(solved(2.0)) {
        assert!(
            (same - wider).abs() < 1e-10 * same.abs().max(1e-3),
            "{same} {wider}"
        );
    }
}

/// Stiffness and damping for slow motions are those of differences of films whose surface follows, and depend
/// on no step.
#[test]
fn slow_motions_see_the_surface_follow() {
    let all = reference();
    let state = &all["elastic"][1];
    let elastic = Elastic::new(film([48, 6]), reference_ring(state)).expect("a surface");
    let place = [0.6, 0.1];
    let mut work = elastic.work();
    let (mut memory, mut y) = (vec![0.0; elastic.memory()], [0.0; inputs::SHAPE_FORCE]);
    elastic
        .solve(&inputs(place), None, &[], Accuracy::Full, &mut work, &mut y)
        .expect("a film");
    let found = elastic.stiffness_and_damping(&mut work).expect("slopes");
    elastic.accept(&work, &mut memory);
    for step in [1e-3, 0.2] {
        elastic
            .solve(
                &inputs(place),
                Some(step),
                &memory,
                Accuracy::Full,
                &mut work,
                &mut y,
            )
            .expect("a film");
        let again = elastic.stiffness_and_damping(&mut work).expect("slopes");
        for (x, y) in found.iter().zip(&again) {
            assert!((x - y).abs() < 1e-8 * x.abs().max(1.0), "{step}: {x} {y}");
        }
    }
    for axis in 0..2 {
        let mut steady = |by: f64| {
            let (mut at, mut y) = (place, [0.0; inputs::SHAPE_FORCE]);
            at[axis] += by;
            elastic
                .solve(&inputs(at), None, &[], Accuracy::Full, &mut work, &mut y)
                .expect("a film");
            y
        };
        let d = 1e-4;
        let (up, down) = (steady(d), steady(-d));
        // some steps of constant speed, the last of which ends at the place
        let mut passing = |speed: f64| {
            let (step, mut y) = (1.0, [0.0; inputs::SHAPE_FORCE]);
            for k in (0..40).rev() {
                let mut at = place;
                at[axis] -= f64::from(k) * step * speed;
                let mut x = inputs(at);
                x[2 + axis] = speed;
                let past = (k < 39).then_some(step);
                elastic
                    .solve(&x, past, &memory, Accuracy::Full, &mut work, &mut y)
                    .expect("a film");
                elastic.accept(&work, &mut memory);
            }
            y
        };
        let v = 1e-6;
        let (ahead, back) = (passing(v), passing(-v));
        for force in 0..2 {
            let stiffness = -(up[force] - down[force]) / (2.0 * d);
            let damping = -(ahead[force] - back[force]) / (2.0 * v);
            for (name, slope, value) in [
                ("stiffness", stiffness, found[2 * force + axis]),
                ("damping", damping, found[4 + 2 * force + axis]),
            ] {
                println!("{name} {force} {axis}: {value} {slope}");
                assert!(
                    (value - slope).abs() < 1e-5 * slope.abs().max(1.0),
                    "{name} {force} {axis}: {value} {slope}"
                );
            }
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
        let (mut work, mut y) = (elastic.work(), [0.0; inputs::SHAPE_FORCE]);
        elastic
            .solve(
                &inputs([0.7, 0.1]),
                None,
                &[],
                Accuracy::Full,
                &mut work,
                &mut y,
            )
            .expect("a film");
        y[0]
    };
    let (rigid, little, more) = (force(0.0), force(2e-4), force(4e-4));
    let change = little / rigid - 1.0;
    assert!(change.abs() > 1e-6 && change.abs() < 1e-3, "{change}");
    let ratio = (more - rigid) / (little - rigid);
    assert!((ratio - 2.0).abs() < 1e-2, "{ratio}");
}

/// The stated ring of a thin section: an opposite pair of loads moves its ends by (π/4 − 2/π) P R³/(E I)
/// (Timoshenko, Strength of Materials II, 1956, art. 13), here as the sum of its waves.
#[test]
fn a_thin_ring_bends_as_in_the_book() {
    let mut source = FilmSource::plain(0.05, 0.02, 5e-5, Cavitation::Reynolds, [24, 4]);
    source.shapes = waves(60);
    let film = Film::new(source).expect("a film");
    let ring = ElasticRing {
        thickness: 2e-5,
        width: 0.02,
        modulus: 2.1e11,
        poisson: 0.3,
    };
    let compliance = ring.compliance(&film);
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
    let radius: f64 = 0.05 + ring.thickness / 2.0;
    let inertia = ring.width * ring.thickness.powi(3) / 12.0;
    let exact = (pi / 4.0 - 2.0 / pi) * load * radius.powi(3) / (ring.modulus * inertia);
    assert!((moved / exact - 1.0).abs() < 1e-4, "{moved} {exact}");
}

/// The ring of `examples/big_end`, whose thickness is two thirds of its radius: compliances of one-dimensional quadratic
/// finite elements over the thickness for each wave (40 elements, plane stress, an own program). The thin ring has
/// 1/1.21, 1/1.22, 1/1.61, 1/2.31, 1/3.46 and 1/5.23 of them.
#[test]
fn a_thick_ring_is_a_plane_stress_annulus() {
    let mut source = FilmSource::plain(24e-3, 22e-3, 25e-6, Cavitation::Reynolds, [24, 4]);
    source.shapes = waves(6);
    let film = Film::new(source).expect("a film");
    let ring = ElasticRing {
        thickness: 16e-3,
        width: 22e-3,
        modulus: 210e9,
        poisson: 0.3,
    };
    let compliance = ring.compliance(&film);
    let count = film.source().shapes.len();
    let own = |at: usize| compliance[at * (count + 1)];
    let elements = [
        8.35391205e-11,
        8.97579018e-10,
        1.66193266e-10,
        6.78280919e-11,
        3.97630177e-11,
        2.82597495e-11,
    ];
    for (k, exact) in elements.into_iter().enumerate() {
        // the cosine of k + 1 waves
        let found = if k == 0 { own(0) } else { own(2 * k - 1) };
        assert!(
            (found / exact - 1.0).abs() < 1e-6,
            "{k}: {found:e} {exact:e}"
        );
    }
    let thin = |k: f64| {
        let (radius, inertia): (f64, f64) = (32e-3, 22e-3 * 16e-3_f64.powi(3) / 12.0);
        radius.powi(3) / (std::f64::consts::PI * ring.modulus * inertia * (k * k - 1.0).powi(2))
    };
    for (k, ratio) in [(2, 1.22), (3, 1.61), (4, 2.31), (5, 3.46), (6, 5.23)] {
        let found = own(2 * k - 3) / thin(k as f64);
        assert!((found - ratio).abs() < 0.01, "{k}: {found}");
    }
}

/// A bore that stays straight across states the share that the degree 1 would have. Here the surface yields alike
/// to both degrees, by so little that the pressure stays that of a stiff bore.
#[test]
fn a_straight_bore_lacks_the_degree_that_a_tilted_pin_needs() {
    let on = |degree: u32, tilt: [f64; 2]| {
        let mut source = FilmSource::plain(24e-3, 22e-3, 25e-6, Cavitation::Reynolds, [36, 8]);
        let shape = |across| {
            [false, true].map(|sine| Shape {
                around: 1,
                sine,
                across,
            })
        };
        source.shapes = (0..=degree).flat_map(shape).collect();
        let count = source.shapes.len();
        let mut compliance = vec![0.0; count * count];
        for (at, shape) in source.shapes.iter().enumerate() {
            // a pressure `P_l(ζ)` does the work 2/(2l + 1) on its own shape
            compliance[at * (count + 1)] = 1e-16 * f64::from(2 * shape.across + 1);
        }
        let film = Film::new(source).expect("a film");
        let elastic = Elastic::carried(film, compliance.clone(), compliance).expect("a surface");
        let at = Inputs {
            eccentricity: [15e-6, 0.0],
            tilt,
            spin: 300.0,
            ..Inputs::still(8e-3)
        };
        let (mut x, mut work) = (vec![0.0; elastic.inputs()], elastic.work());
        let own = at.write();
        x[..own.len()].copy_from_slice(&own);
        let mut y = vec![0.0; elastic.outputs()];
        elastic
            .solve(&x, None, &[], Accuracy::Full, &mut work, &mut y)
            .expect("a solution");
        elastic.last_degrees(&work)
    };
    assert!(on(0, [0.0; 2]) < 1e-9);
    for tilt in [
        [0.1e-3, 0.0],
        [0.6e-3, 0.0],
        [0.0, 0.4e-3],
        [0.2e-3, -0.3e-3],
    ] {
        let (stated, found) = (on(0, tilt), on(1, tilt));
        println!("{tilt:?}: {stated:.3} {found:.3}");
        assert!((stated / found - 1.0).abs() < 1e-6, "{stated} {found}");
    }
    assert!(on(0, [0.6e-3, 0.0]) > 0.1);
}
