//! What stands on the horizontal axis of a history.

/// What stands on the horizontal axis.
#[derive(Clone, Debug, PartialEq)]
pub enum Abscissa {
    /// Crank angle (°).
    CrankAngle,
    /// Time (s).
    Time,
    /// Frequency (Hz).
    Frequency,
    /// Order of the shaft: cycles a revolution.
    Order,
    /// The same with the frequency (Hz) above the panels: order times the shaft's mean speed.
    OrderAt {
        /// Mean speed (revolutions a second).
        speed: f64,
    },
    /// Speed of the shaft (1/min).
    Speed,
    /// Any other quantity, such as the variable of a sweep.
    Other {
        /// What it is.
        name: String,
        /// Its unit; empty for none.
        unit: String,
    },
}

impl Abscissa {
    pub(super) fn name_and_unit(&self) -> (&str, &str) {
        match self {
            Abscissa::CrankAngle => ("Crank angle", "°CA"),
            Abscissa::Time => ("Time", "s"),
            Abscissa::Frequency => ("Frequency", "Hz"),
            Abscissa::Order | Abscissa::OrderAt { .. } => ("Order", "cycles a revolution"),
            Abscissa::Speed => ("Speed", "1/min"),
            Abscissa::Other { name, unit } => (name, unit),
        }
    }
}
