//! Marks of axes and their numbers.

use eng_report::internals::ticks::{
    crank_angle, exponent, inside, number, power_of_ten, ratios, rounded, shortest,
};
use proptest::prelude::*;

#[test]
fn ends_at_marks() {
    let ticks = rounded(-7.3, 12.1, 6);
    assert_eq!(ticks.range, (-10.0, 15.0));
    assert_eq!(ticks.values, vec![-10.0, -5.0, 0.0, 5.0, 10.0, 15.0]);
}

#[test]
fn crank_angles_by_quarters_and_halves() {
    let ticks = crank_angle(0.0, 720.0, 13);
    assert_eq!(
        ticks.values,
        (0..=8).map(|i| f64::from(i) * 90.0).collect::<Vec<_>>()
    );
    assert_eq!(crank_angle(0.0, 1440.0, 13).step, 90.0);
    assert_eq!(crank_angle(0.0, 2160.0, 13).step, 180.0);
    // samples that end a step early
    assert_eq!(crank_angle(0.0, 719.5, 13).range, (0.0, 720.0));
    assert_eq!(inside(0.0, 3985.0, 10).range, (0.0, 4000.0));
    assert_eq!(inside(0.0, 3900.0, 10).range, (0.0, 3900.0));
    assert_eq!(crank_angle(0.0, 72_000.0, 13).step % 720.0, 0.0);
}

#[test]
fn ratios_have_marks_at_one_two_and_five() {
    assert_eq!(
        ratios(10.0, 2000.0),
        [10.0, 20.0, 50.0, 100.0, 200.0, 500.0, 1000.0, 2000.0]
    );
    assert_eq!(ratios(0.15, 1.0), [0.2, 0.5, 1.0]);
    assert_eq!(ratios(1e-2, 1e6).len(), 9);
    assert_eq!(ratios(90.0, 110.0).first(), Some(&90.0));
    assert_eq!(shortest(1e6), "10⁶");
    assert_eq!(shortest(0.2), "0.2");
}

#[test]
fn numbers_read_well() {
    assert_eq!(number(-2.5, 2.5), "−2.5");
    assert_eq!(number(-0.0, 0.25), "0.00");
    assert_eq!(number(1e3, 500.0), "1000");
    assert_eq!(exponent((-2.0e6, 1.0)), 6);
    assert_eq!(exponent((0.0, 3.0e-5)), -6);
    assert_eq!(exponent((0.0, 0.5)), 0);
    assert_eq!(power_of_ten(-6), "10⁻⁶");
}

proptest! {
    #[test]
    fn few_marks_that_cover_the_data(a in -1e12f64..1e12, width in 0.0f64..1e12, count in 2usize..12) {
        let ticks = rounded(a, a + width, count);
        prop_assert!(ticks.values.len() >= 2 && ticks.values.len() <= 2 * count + 4);
        prop_assert!(ticks.range.0 <= a + 1e-6 * ticks.step && ticks.range.1 >= a + width - 1e-6 * ticks.step);
        let angle = crank_angle(a, a + width, count);
        prop_assert!(angle.values.len() <= count.max(2) + 1 || angle.step == 90.0 && angle.values.len() <= 17);
    }

    #[test]
    fn never_panics(a in proptest::num::f64::ANY, b in proptest::num::f64::ANY) {
        for ticks in [rounded(a, b, 6), inside(a, b, 6), crank_angle(a, b, 6)] {
            for value in &ticks.values {
                prop_assert!(!number(*value, ticks.step).is_empty());
            }
        }
    }
}
