//! Tables of several arguments: exactness, order of the error, ends, bad points.

use eng_system::table::{Argument, End, Ends, Grid, GridError};

fn argument(points: Vec<f64>, ends: Ends) -> Argument {
    Argument {
        name: "x".to_owned(),
        points,
        ends,
    }
}

fn even_steps(from: f64, to: f64, count: usize) -> Vec<f64> {
    let step = (to - from) / (count - 1) as f64;
    (0..count).map(|i| from + step * i as f64).collect()
}

/// A grid through the values of a function.
fn sampled(arguments: Vec<Argument>, f: &dyn Fn(&[f64]) -> f64) -> Grid {
    let mut places: Vec<Vec<f64>> = vec![Vec::new()];
    for argument in &arguments {
        let extend = |place: &Vec<f64>| {
            let longer = |x: &f64| place.iter().copied().chain([*x]).collect();
            argument
                .points
                .iter()
                .map(longer)
                .collect::<Vec<Vec<f64>>>()
        };
        places = places.iter().flat_map(extend).collect();
    }
    let values = places.iter().map(|place| f(place)).collect();
    Grid::new(arguments, values).expect("a grid")
}

const OPEN: Ends = Ends::Each([End::Open; 2]);

#[test]
fn polynomials_of_third_degree_are_exact_with_all_derivatives() {
    // p(x) q(y) r(z), points at uneven distances
    let p = |x: f64| {
        [
            1.0 - 2.0 * x + 0.5 * x * x + 0.25 * x * x * x,
            -2.0 + x + 0.75 * x * x,
            1.0 + 1.5 * x,
        ]
    };
    let q = |y: f64| [0.3 + y * y * y, 3.0 * y * y, 6.0 * y];
    let r = |z: f64| [2.0 - z + z * z, -1.0 + 2.0 * z, 2.0];
    let grid = sampled(
        vec![
            argument(vec![-1.0, -0.4, 0.1, 0.9, 2.0], OPEN),
            argument(vec![0.0, 0.5, 0.7, 1.5], OPEN),
            argument(vec![-2.0, 0.0, 1.0], OPEN),
        ],
        &|v| p(v[0])[0] * q(v[1])[0] * r(v[2])[0],
    );
    for (x, y, z) in [
        (-0.9, 0.1, -1.7),
        (0.1, 0.6, 0.3),
        (1.7, 1.4, 0.99),
        (2.0, 1.5, 1.0),
    ] {
        for (i, j, k) in [
            (0, 0, 0),
            (1, 0, 0),
            (0, 1, 0),
            (0, 0, 1),
            (1, 1, 0),
            (2, 0, 1),
            (1, 1, 1),
            (2, 2, 2),
        ] {
            let exact = p(x)[i] * q(y)[j] * r(z)[k];
            let found = grid.evaluate(&[x, y, z], &[i as u8, j as u8, k as u8]);
            assert!(
                (found - exact).abs() < 1e-11 * (1.0 + exact.abs()),
                "{x} {y} {z}, {i}{j}{k}: {found} {exact}"
            );
        }
    }
}

/// A function with a period in its first argument, even and odd in its second, plain in its third.
fn wave(v: &[f64]) -> f64 {
    libm::exp(libm::sin(v[0])) * libm::cos(v[1])
        + 0.3 * libm::cos(2.0 * v[0]) * libm::cos(3.0 * v[1]) * libm::exp(0.4 * v[2])
}

fn wave_grid(n: usize) -> Grid {
    use core::f64::consts::{FRAC_PI_2, TAU};
    sampled(
        vec![
            argument(
                even_steps(0.0, TAU, 2 * n + 1)[..2 * n].to_vec(),
                Ends::Periodic(TAU),
            ),
            argument(
                even_steps(0.0, FRAC_PI_2, n + 1),
                Ends::Each([End::Even, End::Odd]),
            ),
            argument(even_steps(-1.0, 1.0, n + 1), OPEN),
        ],
        &wave,
    )
}

fn largest_error(grid: &Grid) -> f64 {
    let mut worst = 0.0_f64;
    for k in 0..4000_u32 {
        // a sequence that fills the box evenly (Roberts: powers of the plastic number's inverse)
        let place = |g: f64| (0.5 + g * f64::from(k)) % 1.0;
        let v = [
            20.0 * place(0.8191725134) - 10.0,
            20.0 * place(0.6710436067) - 10.0,
            2.0 * place(0.5497004779) - 1.0,
        ];
        worst = worst.max((grid.evaluate(&v, &[0, 0, 0]) - wave(&v)).abs());
    }
    worst
}

#[test]
fn the_error_is_of_fourth_order_with_every_kind_of_end() {
    let [coarse, fine] = [8, 16].map(|n| largest_error(&wave_grid(n)));
    let order = libm::log2(coarse / fine);
    assert!(
        fine < 2e-3 && order > 3.7,
        "{coarse:e} {fine:e}: order {order}"
    );
}

#[test]
fn derivatives_agree_with_differences_and_join_at_mirrors_and_points() {
    let grid = wave_grid(8);
    for v in [
        [0.3, 0.2, 0.1],
        [-7.0, 4.0, -0.9],
        [11.0, -6.1, 0.7],
        [2.0, 1.7, 0.0],
    ] {
        for orders in [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 0]] {
            for (k, h) in [(0, 1e-5), (1, 1e-5), (2, 1e-5)] {
                let at = |s: f64| {
                    let mut moved = v;
                    moved[k] += s;
                    grid.evaluate(&moved, &orders)
                };
                let mut raised = orders;
                raised[k] += 1;
                let exact = grid.evaluate(&v, &raised);
                let difference = (at(h) - at(-h)) / (2.0 * h);
                assert!(
                    (difference - exact).abs() < 1e-6,
                    "{v:?} {orders:?} {k}: {difference} {exact}"
                );
            }
        }
    }
    // C² at points, at both mirrors and where the period closes
    use core::f64::consts::{FRAC_PI_2, TAU};
    for v in [
        [TAU, 0.4, 0.2],
        [TAU / 16.0, 0.4, 0.2],
        [0.3, 0.0, 0.2],
        [0.3, FRAC_PI_2, 0.2],
        [0.3, -FRAC_PI_2, 0.2],
        [0.3, 0.4, 0.25],
    ] {
        for k in 0..3 {
            for order in 0..3 {
                let at = |s: f64| {
                    let (mut moved, mut orders) = (v, [0; 3]);
                    moved[k] += s;
                    orders[k] = order;
                    grid.evaluate(&moved, &orders)
                };
                let (left, right) = (at(-1e-9), at(1e-9));
                assert!(
                    (left - right).abs() < 1e-6,
                    "{v:?} {k} {order}: {left} {right}"
                );
            }
        }
    }
}

#[test]
fn values_are_those_of_scipy() {
    // SciPy 1.17.1: make_interp_spline(k=3) along each axis in turn: not-a-knot; bc_type='periodic'; first
    // derivative zero at the first point and second derivative zero at the last
    use core::f64::consts::{PI, TAU};
    let arguments = vec![
        argument(vec![0.0, 0.7, 1.1, 2.0, 3.2, 4.0], OPEN),
        argument(vec![0.0, 0.9, 2.1, 3.0, 4.2], Ends::Periodic(5.0)),
        argument(vec![0.0, 0.4, 1.0, 1.5], Ends::Each([End::Even, End::Odd])),
    ];
    let grid = sampled(arguments, &|v| {
        let (a, b, c) = (v[0], TAU * v[1] / 5.0, PI * v[2]);
        (libm::sin(1.3 * a) + 0.2 * a) * libm::exp(libm::cos(b)) * libm::cos(c / 3.0)
            + 0.1 * a * libm::sin(2.0 * b) * libm::cos(c)
    });
    for (place, orders, exact) in [
        ([0.3, 1.2, 0.2], [0, 0, 0], 0.4825261014660062),
        ([3.7, 4.9, 1.3], [0, 0, 0], -0.12370704097264654),
        ([2.5, 12.4, 0.7], [0, 0, 0], 0.1497785841395977),
        ([1.5, 3.3, 0.9], [1, 0, 0], -0.18323118142635456),
        ([1.5, 3.3, 0.9], [0, 1, 1], -0.5252221721809751),
        ([0.1, 0.4, 1.45], [0, 2, 0], -0.013675673843286752),
        ([3.9, 2.2, 0.5], [2, 0, 1], -0.5328927818583504),
    ] {
        let found = grid.evaluate(&place, &orders);
        assert!((found - exact).abs() < 1e-13, "{place:?}: {found} {exact}");
    }
}

#[test]
fn few_points_take_the_lowest_degree() {
    use End::{Even, Odd, Open};
    // ends, points, values, place, value there by hand
    let cases: [(_, &[f64], &[f64], f64, f64); 8] = [
        ([Open, Open], &[0.0, 2.0], &[1.0, 5.0], 0.5, 2.0),
        ([Open, Open], &[0.0, 1.0, 3.0], &[0.0, 1.0, 9.0], 2.0, 4.0),
        ([Even, Open], &[0.0, 2.0], &[0.0, 4.0], 1.0, 1.0),
        ([Open, Even], &[-2.0, 0.0], &[4.0, 0.0], -1.0, 1.0),
        ([Even, Even], &[0.0, 1.0], &[1.0, 0.0], 0.5, 0.5),
        ([Odd, Odd], &[0.0, 1.0], &[0.0, 0.0], 0.5, 0.0),
        // x³ − 3 x has slope zero at ±1 and no second derivative at 0
        ([Odd, Even], &[0.0, 1.0], &[0.0, -2.0], 0.5, -1.375),
        (
            [Odd, Even],
            &[0.0, 0.5, 1.0],
            &[0.0, -1.375, -2.0],
            0.25,
            0.015625 - 0.75,
        ),
    ];
    for (ends, points, values, x, exact) in cases {
        let made = Grid::new(
            vec![argument(points.to_vec(), Ends::Each(ends))],
            values.to_vec(),
        );
        let found = made.expect("a grid").evaluate(&[x], &[0]);
        assert!(
            (found - exact).abs() < 1e-14,
            "{ends:?} {points:?}: {found} {exact}"
        );
    }
    // x² (3 − 2x) by three points, free at one end and level at the other: any cubic is met
    for (ends, mirror) in [([Even, Open], 1.0), ([Open, Even], -1.0)] {
        let f = |x: f64| x * x * (3.0 - 2.0 * mirror * x);
        let mut points = [0.0, 0.7, 2.0].map(|x| mirror * x).to_vec();
        points.sort_by(f64::total_cmp);
        let grid = sampled(vec![argument(points, Ends::Each(ends))], &|v| f(v[0]));
        for x in [0.3, 1.5].map(|x| mirror * x) {
            assert!(
                (grid.evaluate(&[x], &[0]) - f(x)).abs() < 1e-13,
                "{ends:?} {x}"
            );
        }
    }
}

#[test]
fn outside_follows_each_end() {
    let ends = |a, b| Ends::Each([a, b]);
    let grid = sampled(
        vec![
            argument(vec![0.0, 1.0, 2.0, 3.0], ends(End::Hold, End::Linear)),
            argument(vec![0.0, 1.0, 2.0], ends(End::Odd, End::Open)),
        ],
        &|v| (1.0 + v[0]) * v[1],
    );
    let value = |x, y| grid.evaluate(&[x, y], &[0, 0]);
    assert!((value(-5.0, 1.5) - 1.5).abs() < 1e-13);
    assert_eq!(grid.evaluate(&[-5.0, 1.5], &[1, 0]), 0.0);
    assert!((value(7.0, 1.5) - 12.0).abs() < 1e-12);
    assert!((grid.evaluate(&[7.0, 1.5], &[1, 1]) - 1.0).abs() < 1e-12);
    assert_eq!(grid.evaluate(&[7.0, 1.5], &[2, 0]), 0.0);
    assert!((value(2.0, -1.5) + 4.5).abs() < 1e-13);
    assert!(value(2.0, 2.1).is_nan() && value(2.0, -2.1).is_nan() && value(f64::NAN, 1.0).is_nan());
    assert_eq!(grid.outside(&[2.0, 2.1]), Some(1));
    assert_eq!(grid.outside(&[20.0, 2.0 + 1e-12]), None);
    assert!(value(2.0, 2.0 + 1e-12).is_finite() && value(2.0, -2.0 - 1e-12).is_finite());
    assert!(grid.evaluate(&[1.0], &[0]).is_nan());
}

#[test]
fn wrong_grids_are_refused() {
    let good = || argument(vec![0.0, 1.0], OPEN);
    let build = |arguments: Vec<Argument>, values: &[f64]| Grid::new(arguments, values.to_vec());
    assert!(matches!(build(vec![], &[]), Err(GridError::Arguments(0))));
    assert!(matches!(
        build(vec![good(), good()], &[1.0; 3]),
        Err(GridError::Count {
            points: 4,
            values: 3
        })
    ));
    assert!(matches!(
        build(vec![good(), argument(vec![1.0], OPEN)], &[1.0; 2]),
        Err(GridError::TooFew { count: 1, .. })
    ));
    for bad in [0.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(
            build(vec![good(), argument(vec![0.0, bad], OPEN)], &[1.0; 4]),
            Err(GridError::NotRising { index: 1, .. })
        ));
    }
    assert!(matches!(
        build(vec![good(), good()], &[1.0, 2.0, f64::NAN, 4.0]),
        Err(GridError::NotFinite { row: 2 })
    ));
    for period in [0.5, -1.0, f64::NAN] {
        assert!(matches!(
            build(
                vec![good(), argument(vec![0.0, 1.0], Ends::Periodic(period))],
                &[1.0; 4]
            ),
            Err(GridError::PeriodTooShort { index: 1, .. })
        ));
    }
    assert!(matches!(
        build(
            vec![good(), argument(vec![0.0, 1.0], Ends::Periodic(1.0))],
            &[1.0, 1.0, 1.0, 2.0]
        ),
        Err(GridError::NotPeriodic { row: 3, .. })
    ));
    let odd = Ends::Each([End::Odd, End::Open]);
    assert!(matches!(
        build(
            vec![argument(vec![0.0, 1.0], odd), good()],
            &[0.0, 0.1, 1.0, 1.0]
        ),
        Err(GridError::NotOdd { row: 1, .. })
    ));
}
