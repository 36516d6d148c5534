//! Coefficients of the methods of integration, and steps of a grid.

use eng_runtime::integrator::Coefficients;
use eng_runtime::internals::radau::{A, BASIS, BASIS_INVERSE, COMPLEX, INVERSE, NODES, REAL};
use eng_runtime::internals::{FixedGrid, crossing_time, second_rate};
use eng_runtime::rotation::{V3, tangent};

#[test]
fn the_basis_divides_the_stages() {
    let product = |a: &[[f64; 3]; 3], b: &[[f64; 3]; 3]| -> [[f64; 3]; 3] {
        std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|k| a[i][k] * b[k][j]).sum()))
    };
    let near = |a: [[f64; 3]; 3], b: [[f64; 3]; 3]| {
        for (a, b) in a.iter().flatten().zip(b.iter().flatten()) {
            assert!((a - b).abs() < 1e-13, "{a} and not {b}");
        }
    };
    let one = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    near(product(&A, &INVERSE), one);
    near(product(&BASIS, &BASIS_INVERSE), one);
    let [a, b] = COMPLEX;
    let divided = [[REAL, 0.0, 0.0], [0.0, a, -b], [0.0, b, a]];
    near(product(&BASIS_INVERSE, &product(&INVERSE, &BASIS)), divided);
    for (row, node) in A.iter().zip(NODES) {
        assert!((row.iter().sum::<f64>() - node).abs() < 1e-15);
    }
}

/// Ratio of the lost to the counted energy of an undamped oscillator in steps of ωh, until it has lost
/// nearly all of its energy. By then the transient with which the scheme begins is small.
fn loss(rho: f64, step: f64) -> f64 {
    let c = Coefficients::new(rho);
    let stiffness = step * step;
    // derivative of the acceleration with respect to the increment of a step of 1
    let weight = (1.0 - c.alpha_m) / ((1.0 - c.alpha_f) * c.beta);
    let damping = (c.gamma - 0.5).powi(3);
    let energy = |q: f64, v: f64| 0.5 * (stiffness * q * q + v * v);
    let (mut q, mut v, mut rate) = (1.0, 0.0, -stiffness);
    let (mut a, mut counted) = (rate, 0.0);
    let begun = energy(q, v);
    for _ in 0..100_000 {
        let rest = q + v + (0.5 - c.beta) * a;
        let next = (c.alpha_f * rate - c.alpha_m * a - (1.0 - c.alpha_f) * stiffness * rest)
            / (1.0 - c.alpha_m + (1.0 - c.alpha_f) * stiffness * c.beta);
        q = rest + c.beta * next;
        v += (1.0 - c.gamma) * a + c.gamma * next;
        let change = -stiffness * q - rate;
        counted += damping * change * weight / (weight + stiffness) * change;
        (a, rate) = (next, -stiffness * q);
        if energy(q, v) < 0.01 * begun {
            break;
        }
    }
    (begun - energy(q, v)) / counted
}

#[test]
fn the_loss_of_followed_vibrations_is_counted() {
    for (rho, step) in [(0.5, 0.1), (0.5, 0.5), (0.8, 0.2), (0.8, 0.5), (0.9, 0.5)] {
        let ratio = loss(rho, step);
        assert!((0.9..1.1).contains(&ratio), "{rho}, {step}: {ratio}");
    }
}

#[test]
fn the_loss_of_others_is_not_overrated() {
    for step in [1.0, 3.0, 10.0, 100.0] {
        for rho in [0.5, 0.8] {
            let ratio = loss(rho, step);
            assert!((0.8..12.0).contains(&ratio), "{rho}, {step}: {ratio}");
        }
    }
}

#[test]
fn the_second_rate_is_that_of_a_difference() {
    // θ(t) with constant second rate: the angular velocity is T(θ) θ̇
    let (theta, w, second) = (
        V3::new(0.3, -0.2, 0.5),
        V3::new(1.0, 2.0, -0.7),
        V3::new(0.4, 0.1, 0.9),
    );
    let speed = |t: f64| {
        let at = theta + w * t + second * (0.5 * t * t);
        tangent(&at) * (w + second * t)
    };
    let e = 1e-4;
    let a = (speed(e) - speed(-e)) / (2.0 * e);
    let found = second_rate(&theta, &w, &a);
    assert!((found - second).norm() < 1e-7, "{found:?}");
}

#[test]
fn halves_come_back_to_the_grid() {
    let mut grid = FixedGrid::new(1.0);
    grid.advance();
    assert_eq!(grid.next(0.5), (0.5, 2.0));
    assert!(grid.halve() && grid.halve());
    assert_eq!(grid.next(0.5), (0.125, 1.625));
    grid.advance();
    assert_eq!(grid.next(0.5), (0.125, 1.75));
    grid.advance();
    assert_eq!(grid.next(0.5), (0.25, 2.0));
    grid.advance();
    assert_eq!(grid.next(0.5), (0.5, 2.5));
}

/// t³ − t over 1…3 s: the time of each value, by its own cubic.
#[test]
fn crossing_of_a_cubic() {
    let cubic = |t: f64| [t * t * t - t, 3.0 * t * t - 1.0];
    let ends = [cubic(1.0), cubic(3.0)];
    for t in [1.0, 1.0001, 1.5, 2.0, 2.9, 3.0] {
        let found = crossing_time(1.0, 3.0, ends, cubic(t)[0]);
        assert!((found - t).abs() < 1e-14, "{found} for {t}");
    }
    assert_eq!(crossing_time(1.0, 3.0, ends, -7.0), 1.0);
    assert_eq!(crossing_time(1.0, 3.0, ends, 99.0), 3.0);
    // a cycle that turns backwards
    let back = ends.map(|end| end.map(|x| -x));
    assert!((crossing_time(1.0, 3.0, back, -cubic(2.5)[0]) - 2.5).abs() < 1e-14);
}
