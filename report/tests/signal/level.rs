//! Levels in decibels.

use eng_report::signal::Level;

#[test]
fn ten_times_is_twenty_decibels() {
    let level = Level::new(1e-6, "m/s²").unwrap();
    assert!((level.of(-1e-5) - 20.0).abs() < 1e-12);
    assert_eq!(level.of(0.0), f64::NEG_INFINITY);
    assert_eq!(level.label(), "dB re 1e-6 m/s²");
    assert_eq!(Level::new(1.0, "N").unwrap().label(), "dB re 1 N");
    assert!(Level::new(0.0, "N").is_err());
}
