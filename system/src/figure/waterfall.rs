//! `waterfall`: spectra one behind the other, over speed.

use super::argument::place;
use super::spectrum as of_spectra;
use super::{Figure, FigureRow, Given, Kind, Picture, Signals, SpectrumSettings, Takes, Unplanned};
use crate::expression::{Expression, Member};

/// Spectra one behind the other.
#[derive(Clone, Debug, PartialEq)]
pub struct Waterfall {
    /// The signals, one of each run.
    pub members: Vec<Member>,
    /// Settings of their spectra.
    pub settings: SpectrumSettings,
}

pub(super) const ROW: FigureRow = FigureRow {
    name: "waterfall",
    about: "spectra of several runs one behind the other, over the mean speed of their cycles",
    arguments: &[
        place(
            "signals",
            Takes::AmplitudesOfRuns,
            "one signal of several runs",
        ),
        of_spectra::AXIS,
        of_spectra::UP_TO,
        of_spectra::WINDOW,
        of_spectra::BLOCK,
        of_spectra::OVERLAP,
        of_spectra::AVERAGING,
        of_spectra::MEAN,
        of_spectra::SCALE,
        of_spectra::REFERENCE,
    ],
    plan,
};

fn plan(given: &Given) -> Result<Figure, Unplanned> {
    let (of, settings) = SpectrumSettings::new(given)?;
    Ok(Figure {
        quantity: of.shown.quantity.clone(),
        display: of.shown.display.clone(),
        picture: Picture::Waterfall(Waterfall {
            members: of.members.clone(),
            settings,
        }),
    })
}

impl Kind for Waterfall {
    fn expressions(&self) -> Vec<&Expression> {
        Signals::expressions(&self.members)
    }
}
