//! Colours of a still picture.

use eng_report::internals::poster::{LEVELS, Range, level};

#[test]
fn colours_run_from_blue_to_yellow() {
    assert_eq!(level(0.0), LEVELS[0]);
    assert_eq!(level(1.0), LEVELS[4]);
    assert_eq!(level(0.5), LEVELS[2]);
    assert_eq!(level(f64::NAN), LEVELS[0]);
    let range = |high| Range {
        name: String::new(),
        unit: String::new(),
        low: 1.0,
        high,
        largest: 9.0,
    };
    assert_eq!(range(3.0).share(2.0), 0.5);
    assert_eq!(range(3.0).share(9.0), 1.0);
    assert_eq!(range(1.0).share(9.0), 0.0);
}
