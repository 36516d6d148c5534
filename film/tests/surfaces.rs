//! Contact of asperities and slopes of rough surfaces and thinning oils, against integrals and differences.

use eng_film::internals::{Contact, Surfaces, moment};
use eng_film::{Roughness, Thinning};

/// F_{5/2} and F_{3/2}, its slope, at the eleven places of the reference, known to fifteen digits, and between the
/// nodes against the integral.
#[test]
fn asperities_by_the_exact_integral() {
    let contact = Contact::tabulated();
    let text = include_str!("reference/film_reference.json");
    let reference: serde_json::Value = serde_json::from_str(text).unwrap();
    let rows = reference["greenwood_tripp"]["rows"].as_array().unwrap();
    assert_eq!(rows.len(), 11);
    for row in rows {
        let [u, exact, _, slope] = [0, 1, 2, 3].map(|at| {
            let text = row[at].as_str().unwrap();
            text.parse::<f64>().unwrap()
        });
        let [value, found] = contact.at(u);
        assert!((value / exact - 1.0).abs() < 1e-10, "{value} at {u}");
        assert!((-found / 2.5 / slope - 1.0).abs() < 1e-8, "{found} at {u}");
    }
    for k in 0..197 {
        let u = -11.9 + 0.1003 * f64::from(k);
        let ([value, slope], exact) = (contact.at(u), moment(5, u));
        assert!(
            (value / exact - 1.0).abs() < 1e-10,
            "{value} {exact} at {u}"
        );
        let exact = -2.5 * moment(3, u);
        assert!((slope / exact - 1.0).abs() < 1e-8, "{slope} {exact} at {u}");
    }
}

/// All slopes are those of differences, on both sides of every limit.
#[test]
fn slopes_are_those_of_differences() {
    let rough = Roughness {
        deviation: 0.4e-6,
        direction: 3.0,
        asperity: 1e-3,
        modulus: 5e10,
        friction: 0.1,
    };
    let thinning = Thinning {
        second: 0.5,
        rate: 3e5,
        exponent: 0.8,
    };
    for rough in [Some(&rough), None] {
        let all = Surfaces::new(rough, Some(thinning), 0.1e-6, 27e-3);
        for gap in [-0.3e-6, 0.05e-6, 0.15e-6, 0.29e-6, 1e-6, 5e-6] {
            let d = 1e-12;
            let close = |found: f64, up: f64, down: f64, by: f64| {
                let slope = (up - down) / (2.0 * by);
                let size = slope.abs().max(1e-9 * up.abs() / by);
                assert!(
                    (found - slope).abs() <= 1e-5 * size,
                    "{found} {slope} at {gap}"
                );
            };
            let at = |gap: f64| all.carried(gap);
            let [value, slope, _] = at(gap);
            close(slope, at(gap + d)[0], at(gap - d)[0], d);
            assert!(value > 0.0);
            let [_, second] = all.squeezed(at(gap));
            if rough.is_some() {
                close(second, at(gap + d)[1], at(gap - d)[1], d);
            }
            let [_, touch] = all.touching(gap);
            close(touch, all.touching(gap + d)[0], all.touching(gap - d)[0], d);
            for across in [false, true] {
                let log = |gap: f64, spin: f64| {
                    libm::log(all.conducted(gap, at(gap), spin, across).value)
                };
                let found = all.conducted(gap, at(gap), 400.0, across);
                close(found.by_gap, log(gap + d, 400.0), log(gap - d, 400.0), d);
                close(found.by_spin, log(gap, 400.01), log(gap, 399.99), 0.01);
            }
            let shear = |gap: f64, spin: f64| all.sheared(at(gap), spin).value;
            let found = all.sheared(at(gap), 400.0);
            close(
                found.by_gap,
                shear(gap + d, 400.0),
                shear(gap - d, 400.0),
                d,
            );
            close(found.by_spin, shear(gap, 400.01), shear(gap, 399.99), 0.01);
        }
    }
}
