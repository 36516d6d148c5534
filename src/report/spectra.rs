//! The last cycle of results, and spectra of its histories in orders and in Hz.

use super::Entry;
use super::scene::shifted;
use crate::cli::RunOutcome;
use crate::cli::summary::last_cycle;
use crate::post::{on, sampled};
use crate::results::{CYCLE_ANGLE, Column, Results, ResultsError, TIME};
use eng_report::figure::{History, Ordinate, Scale, spectra};
use eng_report::signal::{Axis, Signal, Spectrum, SpectrumOptions, Window, spectrum};

/// Highest order that is drawn.
const ORDERS: f64 = 30.0;
/// Share of its size by which a signal must vary to have a spectrum.
const STILL: f64 = 1e-9;

/// The last whole cycle with its angles from 0 on; of results without a whole cycle all.
pub(super) fn of_last_cycle(entry: &Entry) -> Result<RunOutcome, ResultsError> {
    let results = &entry.outcome.results;
    let period = entry.described.cycle_period;
    let angle = results.column(CYCLE_ANGLE).map(|c| c.values.as_slice());
    let first = last_cycle(angle, period).unwrap_or(0);
    let mut cut = Results::new(results.analysis(), results.model());
    for column in results.columns() {
        let mut values = column.values.get(first..).unwrap_or_default().to_vec();
        if column.path == CYCLE_ANGLE {
            values = shifted(values, period);
        }
        cut.push(Column {
            values,
            ..column.clone()
        })?;
    }
    Ok(RunOutcome {
        results: cut,
        ..entry.outcome.clone()
    })
}

/// The spectra of a history of the last cycle, in orders and in Hz; none where samples are uneven.
///
/// Under the title stands what made the spectrum. The window is rectangular where the cycle repeats, else Hann. Hz are orders times the mean speed of the cycle.
pub(super) fn spectra_of(history: &History, cut: &Results, periodic: bool) -> Vec<History> {
    let angle = cut.column(CYCLE_ANGLE).map(|c| c.values.as_slice());
    let found = cut
        .column(TIME)
        .and_then(|time| sampled(&time.values, angle, Axis::Order));
    let Some(sampled) = found else {
        return Vec::new();
    };
    let options = SpectrumOptions {
        window: if periodic {
            Window::Rectangular
        } else {
            Window::Hann
        },
        remove_mean: true,
        ..SpectrumOptions::default()
    };
    let Some(panel) = history.panels.first() else {
        return Vec::new();
    };
    let found: Vec<(String, Spectrum)> = panel
        .curves
        .iter()
        .filter_map(|curve| {
            let signal = Signal {
                values: curve.values.get(..sampled.count)?,
                sampling: sampled.sampling,
            };
            let found = spectrum(signal, options).ok()?;
            // of a constant nothing is left but rounding
            let size = |values: &[f64]| values.iter().fold(0.0f64, |most, x| most.max(x.abs()));
            let moves = size(&found.amplitudes) > STILL * size(signal.values);
            moves.then(|| (curve.name.clone(), found))
        })
        .collect();
    if found.is_empty() {
        return Vec::new();
    }
    let ordinate = Ordinate {
        quantity: format!("{}, 0-peak", history.ordinate.quantity),
        ..history.ordinate.clone()
    };
    let mut figures = Vec::new();
    for axis in [Axis::Order, Axis::Frequency] {
        let shown: Vec<(String, Spectrum)> = found
            .iter()
            .filter_map(|(name, spectrum)| Some((name.clone(), on(axis, spectrum, sampled.speed)?)))
            .collect();
        let limit = match axis {
            Axis::Order => Some(ORDERS),
            Axis::Frequency => sampled.speed.map(|speed| ORDERS * speed.abs()),
        };
        let curves: Vec<(String, &Spectrum)> =
            shown.iter().map(|(name, s)| (name.clone(), s)).collect();
        if !curves.is_empty() {
            figures.push(spectra(
                &format!("Spectrum: {}", history.title),
                "",
                ordinate.clone(),
                Scale::Logarithmic,
                limit,
                &curves,
            ));
        }
    }
    figures
}

#[cfg(test)]
mod tests {
    use super::*;
    use eng_report::figure::{Abscissa, Curve, Panel};
    use std::f64::consts::TAU;

    #[test]
    fn a_wave_stands_at_its_order_and_its_frequency() {
        // one cycle of two revolutions at 3000 rpm, 5 N of the fourth order
        let angles: Vec<f64> = (0..=720).map(|i| f64::from(i).to_radians()).collect();
        let wave: Vec<f64> = angles
            .iter()
            .map(|a| 5.0 * libm::cos(4.0 * a) + 2.0)
            .collect();
        let mut cut = Results::new("a", "M");
        let times = angles.iter().map(|a| a / TAU / 50.0).collect();
        cut.push(Column::time(times)).unwrap();
        cut.push(Column::cycle_angle(angles)).unwrap();
        let history = History {
            title: "Force".to_owned(),
            subtitle: String::new(),
            abscissa: Abscissa::CrankAngle,
            ordinate: Ordinate {
                quantity: "Force".to_owned(),
                unit: "N".to_owned(),
                frame: String::new(),
            },
            scale: Scale::Linear,
            marks: Vec::new(),
            panels: vec![Panel {
                title: String::new(),
                x: Vec::new(),
                curves: vec![Curve {
                    name: "A".to_owned(),
                    values: wave,
                }],
            }],
        };
        let figures = spectra_of(&history, &cut, true);
        assert_eq!(figures.len(), 2);
        for (figure, place) in figures.iter().zip([4.0, 200.0]) {
            let panel = &figure.panels[0];
            let values = &panel.curves[0].values;
            let top = (0..values.len())
                .max_by(|a, b| values[*a].total_cmp(&values[*b]))
                .unwrap();
            assert!(
                (panel.x[top] - place).abs() < 1e-9 * place,
                "{}",
                panel.x[top]
            );
            assert!((values[top] - 5.0).abs() < 1e-10, "{}", values[top]);
        }
        assert!(
            figures[1]
                .subtitle
                .contains("rectangular window, resolution 25.0000 Hz")
        );
    }
}
