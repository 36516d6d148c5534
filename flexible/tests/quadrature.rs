//! Rules of integration against exact integrals of powers.

use eng_flexible::element::quadrature::{
    Point, hexahedron, pyramid, quadrilateral, tetrahedron, tetrahedron_1, tetrahedron_4, triangle,
    triangle_3, triangle_7, unit_interval, wedge,
};

fn integral(points: &[Point], f: impl Fn([f64; 3]) -> f64) -> f64 {
    points.iter().map(|p| p.weight * f(p.at)).sum()
}

fn power(x: f64, n: u32) -> f64 {
    (0..n).fold(1.0, |product, _| product * x)
}

fn factorial(n: u32) -> f64 {
    (1..=n).map(f64::from).product()
}

#[test]
fn line_rules_integrate_powers() {
    for n in 1..=6 {
        let points = unit_interval(n);
        assert_eq!(points.len(), n);
        for degree in 0..2 * n as u32 {
            let sum: f64 = points.iter().map(|&(t, w)| w * power(t, degree)).sum();
            assert!(
                (sum - 1.0 / f64::from(degree + 1)).abs() < 1e-15,
                "{n} {degree}"
            );
        }
    }
}

#[test]
fn simplex_rules_integrate_monomials_to_their_degree() {
    let mut rules: Vec<(Vec<Point>, u32)> = (1..=5)
        .map(|n| (tetrahedron(n), 2 * n as u32 - 1))
        .collect();
    rules.push((tetrahedron_1(), 1));
    rules.push((tetrahedron_4(), 2));
    for (rule, degree) in rules {
        for (a, b, c) in (0..=degree)
            .flat_map(|a| (0..=degree - a).map(move |b| (a, b)))
            .flat_map(|(a, b)| (0..=degree - a - b).map(move |c| (a, b, c)))
        {
            // ∫ rᵃ sᵇ tᶜ = a! b! c! / (a + b + c + 3)!
            let exact = factorial(a) * factorial(b) * factorial(c) / factorial(a + b + c + 3);
            let sum = integral(&rule, |[r, s, t]| power(r, a) * power(s, b) * power(t, c));
            assert!((sum - exact).abs() < 1e-15, "{degree}: {a} {b} {c}");
        }
    }
    let mut rules: Vec<(Vec<Point>, u32)> =
        (1..=5).map(|n| (triangle(n), 2 * n as u32 - 1)).collect();
    rules.push((triangle_3(), 2));
    rules.push((triangle_7(), 5));
    for (rule, degree) in rules {
        for (a, b) in (0..=degree).flat_map(|a| (0..=degree - a).map(move |b| (a, b))) {
            let exact = factorial(a) * factorial(b) / factorial(a + b + 2);
            let sum = integral(&rule, |[r, s, _]| power(r, a) * power(s, b));
            assert!((sum - exact).abs() < 1e-15, "{degree}: {a} {b}");
        }
    }
}

#[test]
fn product_rules_have_their_degree() {
    for n in 1..=5 {
        let degree = 2 * n as u32 - 1;
        let even = |d: u32| {
            if d.is_multiple_of(2) {
                2.0 / f64::from(d + 1)
            } else {
                0.0
            }
        };
        for d in 0..=degree {
            let e = degree - d;
            let sum = integral(&hexahedron(n), |[x, y, z]| {
                power(x, d) * power(y, e) * power(z, d)
            });
            assert!((sum - even(d) * even(e) * even(d)).abs() < 1e-14);
            let sum = integral(&quadrilateral(n), |[x, y, _]| power(x, d) * power(y, e));
            assert!((sum - even(d) * even(e)).abs() < 1e-14);
            // ∫ xᵈ yᵉ ζᵈ (1 − ζ)² : the last factor is 2 d!/(d + 3)!
            let sum = integral(&pyramid(n), |[x, y, z]| {
                power(x, d) * power(y, e) * power(z, d)
            });
            let exact = even(d) * even(e) * 2.0 * factorial(d) / factorial(d + 3);
            assert!((sum - exact).abs() < 1e-14);
            let sum = integral(&wedge(&triangle(n), n), |[r, _, t]| {
                power(r, d) * power(t, e)
            });
            let exact = factorial(d) / factorial(d + 2) * even(e);
            assert!((sum - exact).abs() < 1e-14);
        }
    }
}
