//! `campbell`: colours over speed and frequency, with lines of orders and natural frequencies.

use super::argument::option;
use super::spectrum as of_spectra;
use super::{
    Axis, Figure, FigureRow, Given, Kind, Picture, Signals, SpectrumSettings, Takes, Unplanned,
    Value,
};
use crate::dimension::{Dimension, DisplayUnit};
use crate::expression::{Expression, Member};

/// Colours over speed and frequency with lines of orders and natural frequencies.
#[derive(Clone, Debug, PartialEq)]
pub struct Campbell {
    /// The signals, one of each run.
    pub members: Vec<Member>,
    /// Settings of their spectra.
    pub settings: SpectrumSettings,
    /// Orders with a line; `None` for the firing order and its multiples, or the first four.
    pub orders: Option<Vec<f64>>,
    /// Linear analyses whose natural frequencies are drawn.
    pub modes: Vec<String>,
}

pub(super) const ROW: FigureRow = FigureRow {
    name: "campbell",
    about: "levels over the mean speed of several runs and frequency, with lines of orders and natural frequencies",
    arguments: of_spectra::with_options![
        of_spectra::OF_RUNS,
        option(
            "orders",
            Takes::Orders,
            "orders with a line each; without it those of the firing, or the first four",
        ),
        option(
            "modes",
            Takes::LinearAnalyses,
            "linear analyses whose natural frequencies are drawn",
        ),
    ],
    plan,
};

/// Without options a Campbell diagram is over frequency, in levels over 1 µN or 1 µm/s² (ISO 1683), of other
/// quantities over 1 of their unit.
fn plan(given: &Given) -> Result<Figure, Unplanned> {
    let (of, mut settings) = SpectrumSettings::new(given)?;
    let mut display = of.shown.display.clone();
    if given.find("axis").is_none() && given.find("up_to").is_none() {
        settings.axis = Axis::Frequency;
    }
    if settings.reference.is_none() && of_spectra::logarithmic(given).unwrap_or(true) {
        let symbol = match of.shown.dimension {
            Dimension::FORCE => Some("N"),
            Dimension::ACCELERATION => Some("m/s^2"),
            _ => None,
        };
        settings.reference = Some(match symbol {
            Some(symbol) => {
                display = DisplayUnit {
                    symbol: symbol.to_owned(),
                    scale: 1.0,
                    offset: 0.0,
                };
                1e-6
            }
            None => display.scale,
        });
    }
    Ok(Figure {
        quantity: of.shown.quantity.clone(),
        display,
        picture: Picture::Campbell(Campbell {
            members: of.members.clone(),
            settings,
            orders: given.numbers("orders").map(<[f64]>::to_vec),
            modes: match given.find("modes") {
                Some(Value::Analyses(names)) => names.clone(),
                _ => Vec::new(),
            },
        }),
    })
}

impl Kind for Campbell {
    fn expressions(&self) -> Vec<&Expression> {
        Signals::expressions(&self.members)
    }

    fn analyses(&self) -> Vec<&str> {
        self.modes.iter().map(String::as_str).collect()
    }
}
