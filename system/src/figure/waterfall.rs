//! `waterfall`: spectra one behind the other, over speed.

use super::spectrum as of_spectra;
use super::{Figure, FigureRow, Given, Kind, Picture, Signals, SpectrumSettings, Unplanned};
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
    arguments: of_spectra::with_options![of_spectra::OF_RUNS,],
    plan,
};

fn plan(given: &Given) -> Result<Figure, Unplanned> {
    let (of, settings) = SpectrumSettings::new(given)?;
    Ok(Figure::of(
        &of.shown,
        Picture::Waterfall(Waterfall {
            members: of.members.clone(),
            settings,
        }),
    ))
}

impl Kind for Waterfall {
    fn expressions(&self) -> Vec<&Expression> {
        Signals::expressions(&self.members)
    }
}
