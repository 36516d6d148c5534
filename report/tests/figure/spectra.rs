//! Figures of spectra.

use eng_report::figure::{Ordinate, Scale, spectra};
use eng_report::signal::{Sampling, Signal, SpectrumOptions, spectrum};

#[test]
fn the_window_and_resolution_are_printed() {
    let values: Vec<f64> = (0..1000).map(|n| libm::sin(f64::from(n))).collect();
    let signal = Signal {
        values: &values,
        sampling: Sampling::Angle { step: 0.72 },
    };
    let found = spectrum(signal, SpectrumOptions::default()).unwrap();
    let figure = spectra(
        "Spectrum",
        "Model",
        Ordinate {
            quantity: "Force x".to_owned(),
            unit: "N".to_owned(),
            frame: "block".to_owned(),
        },
        Scale::Linear,
        Some(50.0),
        &[("E".to_owned(), &found)],
    );
    assert_eq!(figure.panels[0].x.len(), 101);
    assert!(
        figure
            .subtitle
            .contains("Hann window, resolution 0.5000 orders")
    );
    let svg = figure.to_svg();
    assert!(svg.contains("Order (cycles a revolution)") && svg.contains("axes of block"));
}
