//! A summary of each journal: loads, film, friction.

use super::Table;
use crate::machine::JournalGeometry;
use crate::results::{CYCLE_ANGLE, Results, TIME};

/// A journal's row of the table. It covers the last cycle if the run has a whole cycle, otherwise the whole
/// run.
#[derive(Clone, Debug, PartialEq)]
pub struct JournalSummary {
    /// `main[1]`.
    pub name: String,
    /// Largest magnitude of the force across the shaft (N).
    pub peak_load: Option<f64>,
    /// Crank angle of the peak load (rad, within the cycle).
    pub peak_load_angle: Option<f64>,
    /// Peak load over diameter times width (Pa).
    pub specific_load: Option<f64>,
    /// Smallest film thickness (m).
    pub minimum_film: Option<f64>,
    /// Crank angle of the smallest film thickness (rad, within the cycle).
    pub minimum_film_angle: Option<f64>,
    /// Friction power, mean over time (W).
    pub friction_power: Option<f64>,
    /// Whether the values cover the last whole cycle.
    pub last_cycle: bool,
}

impl JournalSummary {
    /// The summary of a journal's columns. [`JournalGeometry`] describes their names. `cycle_period` in rad.
    pub fn new(results: &Results, journal: &JournalGeometry, cycle_period: Option<f64>) -> Self {
        let column = |output: &str| {
            results
                .column(&format!("{}.{output}", journal.path))
                .map(|c| c.values.as_slice())
        };
        let angle = results.column(CYCLE_ANGLE).map(|c| c.values.as_slice());
        let whole = last_cycle(angle, cycle_period);
        let first = whole.unwrap_or(0);
        let cycle_angle = |index: usize| {
            let angle = *angle?.get(index)?;
            match cycle_period {
                // a crank angle of 719.999999999° is 0°
                Some(period) if period > 0.0 => {
                    Some(angle - period * ((angle + 1e-9) / period).floor())
                }
                _ => Some(angle),
            }
        };
        let load = match (column("force.x"), column("force.y")) {
            (Some(x), Some(y)) => extreme(
                x.iter().zip(y).map(|(x, y)| libm::hypot(*x, *y)),
                first,
                |a, b| a > b,
            ),
            _ => None,
        };
        let film = column("minimum_film")
            .and_then(|film| extreme(film.iter().copied(), first, |a, b| a < b));
        let friction_power = match (results.column(TIME), column("power_loss")) {
            (Some(time), Some(power)) => mean(
                time.values.get(first..).unwrap_or_default(),
                power.get(first..).unwrap_or_default(),
            ),
            _ => None,
        };
        let area = journal.diameter * journal.width;
        JournalSummary {
            name: journal.path.clone(),
            peak_load: load.map(|(_, value)| value),
            peak_load_angle: load.and_then(|(index, _)| cycle_angle(index)),
            specific_load: load.map(|(_, value)| value / area),
            minimum_film: film.map(|(_, value)| value),
            minimum_film_angle: film.and_then(|(index, _)| cycle_angle(index)),
            friction_power,
            last_cycle: whole.is_some(),
        }
    }
}

/// Subtracts whole cycles from the angles, so that the first angle lies in the first cycle.
pub(crate) fn shifted(mut angles: Vec<f64>, period: Option<f64>) -> Vec<f64> {
    if let (Some(period), Some(first)) = (period.filter(|p| *p > 0.0), angles.first().copied()) {
        let whole = period * ((first + 1e-6) / period).floor();
        angles.iter_mut().for_each(|angle| *angle -= whole);
    }
    angles
}

/// Index of the first sample of the last whole cycle, if there is one. The angle may decrease, because a
/// shaft can turn either way.
pub(crate) fn last_cycle(angle: Option<&[f64]>, period: Option<f64>) -> Option<usize> {
    let (angle, period) = (angle?, period?);
    let (first, last) = (angle.first()?, angle.last()?);
    let turned = (last - first).abs();
    if period > 0.0 && turned >= period - 1e-6 {
        // samples that the angle passes again on its way back also belong to the last cycle
        let before = angle
            .iter()
            .rposition(|angle| (last - angle).abs() > period + 1e-6);
        Some(before.map_or(0, |index| index + 1))
    } else {
        None
    }
}

/// Index and value of the best finite value from `first` on, by `better`.
fn extreme(
    values: impl Iterator<Item = f64>,
    first: usize,
    better: impl Fn(f64, f64) -> bool,
) -> Option<(usize, f64)> {
    values
        .enumerate()
        .skip(first)
        .filter(|(_, value)| value.is_finite())
        .reduce(|best, next| if better(next.1, best.1) { next } else { best })
}

/// Mean over time by the trapezoidal rule.
fn mean(time: &[f64], values: &[f64]) -> Option<f64> {
    let duration = time.last()? - time.first()?;
    if duration <= 0.0 {
        return values.first().copied();
    }
    let area: f64 = time
        .windows(2)
        .zip(values.windows(2))
        .map(|(t, v)| 0.5 * (v[0] + v[1]) * (t[1] - t[0]))
        .sum();
    Some(area / duration)
}

/// The table of all journals; empty without journals.
pub fn journal_table(journals: &[JournalSummary]) -> String {
    if journals.is_empty() {
        return String::new();
    }
    let mut table = Table::new(&[
        &[
            "journal",
            "peak load",
            "at",
            "specific load",
            "min. film",
            "at",
            "friction",
        ],
        &["", "N", "°CA", "MPa", "µm", "°CA", "W"],
    ]);
    let shown = |value: Option<f64>, scale: f64, decimals: usize| match value {
        Some(value) => format!("{:.decimals$}", value * scale),
        None => "–".to_owned(),
    };
    let degrees = 180.0 / std::f64::consts::PI;
    for journal in journals {
        table.row(vec![
            journal.name.clone(),
            shown(journal.peak_load, 1.0, 0),
            shown(journal.peak_load_angle, degrees, 1),
            shown(journal.specific_load, 1e-6, 2),
            shown(journal.minimum_film, 1e6, 2),
            shown(journal.minimum_film_angle, degrees, 1),
            shown(journal.friction_power, 1.0, 1),
        ]);
    }
    let span = if journals.iter().all(|j| j.last_cycle) {
        "over the last cycle"
    } else {
        "over the whole run"
    };
    format!("{}  {span}; specific load = F/(D·B)\n", table.render())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::Column;
    use eng_system::{Dimension, DisplayUnit};
    use std::f64::consts::PI;

    fn journal() -> JournalGeometry {
        JournalGeometry {
            path: "main[1]".to_owned(),
            diameter: 0.054,
            width: 0.020,
            radial_clearance: 27e-6,
        }
    }

    fn results(samples: &[(f64, f64, f64)]) -> Results {
        let mut results = Results::new("unfired", "Inline4");
        let column = |path: &str, values: Vec<f64>| Column {
            path: path.to_owned(),
            dimension: Dimension::ONE,
            display: DisplayUnit::si(Dimension::ONE),
            frame: String::new(),
            values,
        };
        let time: Vec<f64> = (0..samples.len()).map(|i| i as f64 * 0.01).collect();
        let angle = samples.iter().map(|s| s.0.to_radians()).collect();
        results.push(Column::time(time)).unwrap();
        results.push(Column::cycle_angle(angle)).unwrap();
        let forces: Vec<f64> = samples.iter().map(|s| s.1).collect();
        let y = forces.iter().map(|f| f * 4.0 / 3.0).collect();
        let films: Vec<f64> = samples.iter().map(|s| s.2).collect();
        let power = films.iter().map(|f| f * 1e6).collect();
        results.push(column("main[1].force.x", forces)).unwrap();
        results.push(column("main[1].force.y", y)).unwrap();
        results.push(column("main[1].minimum_film", films)).unwrap();
        results.push(column("main[1].power_loss", power)).unwrap();
        results
    }

    #[test]
    fn takes_the_last_cycle() {
        // the start-up peak of 9 kN and the film of 1 µm lie before the last 720°
        let samples = [
            (0.0, 9e3, 1e-6),
            (360.0, 300.0, 5e-6),
            (720.0, 600.0, 4e-6),
            (900.0, -1200.0, 3e-6),
            (1080.0, 300.0, 5e-6),
        ];
        let summary = JournalSummary::new(&results(&samples), &journal(), Some(4.0 * PI));
        assert!(summary.last_cycle);
        assert!((summary.peak_load.unwrap() - 2000.0).abs() < 1e-9);
        assert!((summary.specific_load.unwrap() - 2000.0 / 0.00108).abs() < 1e-6);
        assert!((summary.peak_load_angle.unwrap().to_degrees() - 180.0).abs() < 1e-9);
        assert_eq!(summary.minimum_film, Some(3e-6));
        // trapezoid over 5, 4, 3, 5 W
        assert!((summary.friction_power.unwrap() - 4.0).abs() < 1e-12);
        let whole = JournalSummary::new(&results(&samples), &journal(), Some(8.0 * PI));
        assert!(!whole.last_cycle);
        assert!((whole.peak_load.unwrap() - 15_000.0).abs() < 1e-9);
        insta::assert_snapshot!(journal_table(&[summary, whole]));
    }

    #[test]
    fn absent_columns_are_dashes() {
        let mut bare = Results::new("a", "M");
        bare.push(Column::time(vec![0.0, 1.0])).unwrap();
        let summary = JournalSummary::new(&bare, &journal(), None);
        let table = journal_table(&[summary]);
        assert_eq!(table.matches('–').count(), 6, "{table}");
        assert_eq!(journal_table(&[]), "");
    }
}
