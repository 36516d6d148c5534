//! The last cycle of results, and spectra of it.

use super::Entry;
use crate::post::{ORDERS, Sampled, on, sampled};
use crate::results::{CYCLE_ANGLE, Column, Results, ResultsError, TIME};
use crate::run::RunOutcome;
use crate::tables::{last_cycle, shifted};
use eng_report::figure::{Abscissa, History, Ordinate, Scale, spectra};
use eng_report::signal::{Axis, Signal, Spectrum, SpectrumOptions, Window, spectrum};

/// Share of its size by which a signal must vary to have a spectrum.
const STILL: f64 = 1e-9;

/// The last whole cycle with its angles from 0 on; of results without a whole cycle all.
pub(super) fn of_last_cycle(entry: &Entry) -> Result<RunOutcome, ResultsError> {
    let results = &entry.outcome.results;
    // a state has no cycle to cut
    if results.is_state() {
        return Ok(entry.outcome.clone());
    }
    let period = entry.described.machine.cycle_period;
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

/// How the last cycle was sampled.
fn sampled_evenly(cut: &Results) -> Option<Sampled> {
    let angle = cut.column(CYCLE_ANGLE).map(|c| c.values.as_slice());
    sampled(&cut.column(TIME)?.values, angle, Axis::Order)
}

/// What makes the spectra of the last cycle: the window is rectangular where the cycle repeats, else Hann.
fn options(periodic: bool) -> SpectrumOptions {
    SpectrumOptions {
        window: if periodic {
            Window::Rectangular
        } else {
            Window::Hann
        },
        remove_mean: true,
        ..SpectrumOptions::default()
    }
}

/// The spectrum of values of the last cycle; none of those that stand still or are uneven.
fn spectrum_of(values: &[f64], sampled: &Sampled, periodic: bool) -> Option<Spectrum> {
    let signal = Signal {
        values: values.get(..sampled.count)?,
        sampling: sampled.sampling,
    };
    let found = spectrum(signal, options(periodic)).ok()?;
    // of a constant nothing is left but rounding
    let size = |values: &[f64]| values.iter().fold(0.0f64, |most, x| most.max(x.abs()));
    (size(&found.amplitudes) > STILL * size(signal.values)).then_some(found)
}

/// The spectrum in Hz of a column of the last cycle in its display unit.
pub(super) struct Hertz {
    pub spectrum: Spectrum,
    /// The shaft's mean speed (1/s).
    pub speed: f64,
    /// What made it, in orders where samples lie evenly in angle.
    pub made: String,
}

/// See [`Hertz`]; none of what stands still, is uneven or does not turn.
pub(super) fn in_hertz(column: &Column, cut: &Results, periodic: bool) -> Option<Hertz> {
    let sampled = sampled_evenly(cut)?;
    let speed = sampled.speed?;
    let found = spectrum_of(&column.shown(), &sampled, periodic)?;
    Some(Hertz {
        spectrum: on(Axis::Frequency, &found, Some(speed))?,
        speed,
        made: found.description(),
    })
}

/// The spectrum of a history of the last cycle, in orders with the frequencies at the mean speed above, or of a model without cycle
/// in Hz; none where samples are uneven. Under the title stands what made it.
pub(super) fn spectra_of(history: &History, cut: &Results, periodic: bool) -> Option<History> {
    let sampled = sampled_evenly(cut)?;
    let panel = history.panels.first()?;
    let mut axis = Axis::Frequency;
    let mut shown: Vec<(String, Spectrum)> = Vec::new();
    for curve in &panel.curves {
        let Some(found) = spectrum_of(&curve.values, &sampled, periodic) else {
            continue;
        };
        match on(Axis::Order, &found, sampled.speed) {
            Some(found) => {
                axis = Axis::Order;
                shown.push((curve.name.clone(), found));
            }
            None => shown.push((curve.name.clone(), found)),
        }
    }
    let curves: Vec<(String, &Spectrum)> =
        shown.iter().map(|(name, s)| (name.clone(), s)).collect();
    if curves.is_empty() {
        return None;
    }
    let ordinate = Ordinate {
        quantity: format!("{}, 0-peak", history.ordinate.quantity),
        ..history.ordinate.clone()
    };
    let mut figure = spectra(
        &format!("Spectrum: {}", history.title),
        "",
        ordinate,
        Scale::Logarithmic,
        (axis == Axis::Order).then_some(ORDERS),
        &curves,
    );
    if let (Axis::Order, Some(speed)) = (axis, sampled.speed) {
        figure.abscissa = Abscissa::OrderAt { speed };
    }
    Some(figure)
}

#[cfg(test)]
mod tests {
    use super::*;
    use eng_report::figure::{Curve, Panel};
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
        let figure = spectra_of(&history, &cut, true).unwrap();
        assert_eq!(figure.abscissa, Abscissa::OrderAt { speed: 50.0 });
        let top = |x: &[f64], values: &[f64], place: f64| {
            let top = (0..values.len())
                .max_by(|a, b| values[*a].total_cmp(&values[*b]))
                .unwrap();
            assert!((x[top] - place).abs() < 1e-9 * place, "{}", x[top]);
            assert!((values[top] - 5.0).abs() < 1e-10, "{}", values[top]);
        };
        let panel = &figure.panels[0];
        top(&panel.x, &panel.curves[0].values, 4.0);
        assert!(
            figure
                .subtitle
                .contains("rectangular window, resolution 0.5000 orders")
        );
        let column = Column {
            values: history.panels[0].curves[0].values.clone(),
            ..Column::time(Vec::new())
        };
        let found = in_hertz(&column, &cut, true).unwrap();
        assert!((found.speed - 50.0).abs() < 1e-9);
        top(
            &found.spectrum.positions(),
            &found.spectrum.amplitudes,
            200.0,
        );
        assert!(found.made.contains("resolution 0.5000 orders"));
    }
}
