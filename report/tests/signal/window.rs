//! Windows of spectra.

use eng_report::signal::Window;

#[test]
fn noise_bandwidths_are_the_published_ones() {
    // Harris (1978), table 1; Heinzel, Rüdiger and Schilling (2002) for the flat top
    for (window, expected) in [
        (Window::Rectangular, 1.0),
        (Window::Hann, 1.5),
        (Window::FlatTop, 3.7702),
        (Window::BlackmanHarris, 2.0044),
    ] {
        let found = window.noise_bandwidth(1000);
        assert!((found - expected).abs() < 1e-4, "{window:?}: {found}");
    }
}

#[test]
fn short_blocks_are_finite() {
    for window in [Window::Hann, Window::FlatTop, Window::BlackmanHarris] {
        assert!(window.weights(0).is_empty());
        assert!(window.weights(1).iter().all(|w| w.is_finite()));
    }
}
