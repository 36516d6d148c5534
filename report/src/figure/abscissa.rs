//! The horizontal axis of a history.

use super::ticks::significant;

/// The quantity of a horizontal axis.
#[derive(Clone, Debug, PartialEq)]
pub enum Abscissa {
    /// Crank angle (°).
    CrankAngle,
    /// Time (s).
    Time,
    /// Frequency (Hz).
    Frequency,
    /// Frequency (Hz) with the orders above the panels: frequency over the shaft's mean speed.
    FrequencyAt {
        /// Mean speed (revolutions per second).
        speed: f64,
    },
    /// Order of the shaft: cycles per revolution.
    Order,
    /// The same with the frequency (Hz) above the panels: order times the shaft's mean speed.
    OrderAt {
        /// Mean speed (revolutions per second).
        speed: f64,
    },
    /// Speed of the shaft (rpm).
    Speed,
    /// Any other quantity, such as the variable of a sweep.
    Other {
        /// Its name.
        name: String,
        /// Its unit; empty for none.
        unit: String,
    },
}

/// A second axis. Its numbers are those of the first axis times a factor.
pub(super) struct Second {
    /// Its quantity, with the speed for which it holds.
    pub title: String,
    pub factor: f64,
    /// The name of the factor in the script of the page.
    pub key: &'static str,
}

impl Abscissa {
    /// The axis above the panels; `None` for a shaft at rest.
    pub(super) fn second(&self) -> Option<Second> {
        let (name, speed, factor, key) = match self {
            Abscissa::OrderAt { speed } => ("Frequency (Hz)", *speed, *speed, "data-speed"),
            Abscissa::FrequencyAt { speed } => (
                "Order (cycles a revolution)",
                *speed,
                1.0 / speed,
                "data-turn",
            ),
            _ => return None,
        };
        (speed > 0.0 && speed.is_finite() && factor.is_finite()).then(|| Second {
            title: format!("{name} at {} rpm", significant(60.0 * speed)),
            factor,
            key,
        })
    }

    pub(super) fn name_and_unit(&self) -> (&str, &str) {
        match self {
            Abscissa::CrankAngle => ("Crank angle", "°CA"),
            Abscissa::Time => ("Time", "s"),
            Abscissa::Frequency | Abscissa::FrequencyAt { .. } => ("Frequency", "Hz"),
            Abscissa::Order | Abscissa::OrderAt { .. } => ("Order", "cycles a revolution"),
            Abscissa::Speed => ("Speed", "rpm"),
            Abscissa::Other { name, unit } => (name, unit),
        }
    }
}
