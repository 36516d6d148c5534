//! Natural frequencies of linear analyses, for Campbell diagrams.

use super::PostError;
use super::evaluate::Evaluator;
use eng_system::recorded::{CYCLE_SPEED, DAMPING_RATIO, FREQUENCY};
use std::f64::consts::TAU;

/// Damping ratio above which a mode is left out, because no spectrum shows its peak. A choice: at a damping
/// ratio of 0.2 the peak is two and a half times the static value.
const DAMPED: f64 = 0.2;
/// Difference (rpm) below which speeds count as one. A choice: speeds are printed in whole rpm.
const SAME: f64 = 0.5;

/// An oscillation at the speed at which it was linearised.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Oscillation {
    /// Its mode, counted from 1.
    mode: usize,
    /// rpm.
    speed: f64,
    /// Hz.
    frequency: f64,
}

/// Lightly damped oscillations of one linear analysis, or of several at different speeds.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Natural {
    names: Vec<String>,
    oscillations: Vec<Oscillation>,
}

impl Natural {
    /// The oscillations of linear analyses with these names.
    pub(super) fn of(names: &[String], evaluator: &Evaluator<'_>) -> Result<Natural, PostError> {
        let mut natural = Natural::default();
        for name in names {
            let column = |path| evaluator.column(name, path);
            let (damping, speeds) = (column(DAMPING_RATIO)?, column(CYCLE_SPEED)?);
            natural.push(name, column(FREQUENCY)?, damping, speeds);
        }
        Ok(natural)
    }

    /// Adds the modes of an analysis: frequencies (Hz), damping ratios, and speeds (rad/s). Heavily damped modes are left out.
    pub fn push(&mut self, name: &str, frequencies: &[f64], damping: &[f64], speeds: &[f64]) {
        self.names.push(name.to_owned());
        for (row, ((frequency, damping), speed)) in
            frequencies.iter().zip(damping).zip(speeds).enumerate()
        {
            if *frequency > 0.0 && damping.abs() < DAMPED {
                self.oscillations.push(Oscillation {
                    mode: row + 1,
                    speed: (speed * 60.0 / TAU).abs(),
                    frequency: *frequency,
                });
            }
        }
    }

    /// The speed (rpm), if all have one.
    fn one_speed(&self) -> Option<f64> {
        let first = self.oscillations.first()?.speed;
        let same = |o: &Oscillation| (o.speed - first).abs() < SAME;
        self.oscillations.iter().all(same).then_some(first)
    }

    /// Name and frequency (Hz) of each, if all have one speed. They are drawn as lines over all speeds, where
    /// they are about the same.
    pub fn lines(&self) -> Vec<(String, f64)> {
        let modes = self.oscillations.iter();
        match self.one_speed() {
            Some(_) => modes
                .map(|o| (format!("mode {}", o.mode), o.frequency))
                .collect(),
            None => Vec::new(),
        }
    }

    /// Speed (rpm) and frequency (Hz) of each.
    pub fn marks(&self) -> Vec<(f64, f64)> {
        let modes = self.oscillations.iter();
        modes.map(|o| (o.speed, o.frequency)).collect()
    }

    /// The drawn lines or marks, in words; `None` without any.
    pub fn description(&self) -> Option<String> {
        let names = match self.names.as_slice() {
            [] => return None,
            [one] => one.clone(),
            [first, .., last] => format!("{first} to {last}"),
        };
        let at = match self.one_speed() {
            Some(speed) => format!(" at {speed:.0} rpm"),
            None => String::new(),
        };
        Some(format!(
            "natural frequencies of {names}{at}, damping below {:.0} %",
            100.0 * DAMPED
        ))
    }
}
