//! `spectrum`: amplitudes over order or frequency; and the options of all spectra.

use super::argument::{option, place, words};
use super::{Argument, Figure, FigureRow, Given, Kind, Picture, Signals, Takes, Unplanned};
use crate::analysis::Extent;
use crate::expression::{Expression, Limit, Member, WINDOWS, Window};

/// Spectra as curves.
#[derive(Clone, Debug, PartialEq)]
pub struct Spectrum {
    /// The signals.
    pub members: Vec<Member>,
    /// Settings of their spectra.
    pub settings: SpectrumSettings,
}

/// The way from the spectra of blocks to one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum Averaging {
    Linear,
    RootMeanSquare,
    Peak,
}

/// The horizontal axis of a spectrum.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// Hz.
    Frequency,
    /// Cycles per revolution.
    Order,
}

/// Settings of spectra.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpectrumSettings {
    /// Weight of a block.
    pub window: Window,
    /// The quantity of the lines.
    pub axis: Axis,
    /// The end of the axis (Hz, or orders).
    pub up_to: Option<f64>,
    /// Length of a block; `None` for one block of all samples.
    pub block: Option<Extent>,
    /// Share of a block that the next block repeats.
    pub overlap: f64,
    /// The way to one spectrum from the spectra of blocks.
    pub averaging: Averaging,
    /// Whether the mean of each block is subtracted.
    pub remove_mean: bool,
    /// Whether the ordinate is logarithmic.
    pub logarithmic: bool,
    /// Reference of the decibels; `None` for amplitudes.
    pub reference: Option<f64>,
}

/// The words of [`Averaging`].
pub const AVERAGINGS: [(&str, Averaging); 3] = [
    ("rms", Averaging::RootMeanSquare),
    ("linear", Averaging::Linear),
    ("peak", Averaging::Peak),
];
const AXES: [(&str, Axis); 2] = [("order", Axis::Order), ("frequency", Axis::Frequency)];
const SCALES: [(&str, bool); 2] = [("linear", false), ("logarithmic", true)];
const MEANS: [(&str, bool); 2] = [("removed", true), ("kept", false)];

pub(super) const WINDOW: Argument = option(
    "window",
    Takes::Word(&words(&WINDOWS)),
    "the weight of a block; `rectangular` if the cycle repeats, else `hann`",
);
pub(super) const OVERLAP: Argument = option(
    "overlap",
    Takes::Share,
    "the share of a block that the next one repeats, 50 % by default",
);

/// The options of every spectrum.
pub(super) const AXIS: Argument = option(
    "axis",
    Takes::Word(&words(&AXES)),
    "the abscissa; orders if the models have a cycle, else frequency",
);
pub(super) const UP_TO: Argument = option(
    "up_to",
    Takes::Limit,
    "the end of the abscissa; a plain number is an order",
);
pub(super) const BLOCK: Argument = option(
    "block",
    Takes::Extent,
    "the length of a block; without it one block holds the whole signal",
);
pub(super) const AVERAGING: Argument = option(
    "averaging",
    Takes::Word(&words(&AVERAGINGS)),
    "the mean over the blocks, `rms` by default",
);
pub(super) const MEAN: Argument = option(
    "mean",
    Takes::Word(&words(&MEANS)),
    "whether the mean of a block is taken away, `removed` by default",
);
pub(super) const SCALE: Argument = option(
    "scale",
    Takes::Word(&words(&SCALES)),
    "the ordinate, `linear` by default; of a Campbell diagram levels by default",
);
pub(super) const REFERENCE: Argument = option(
    "reference",
    Takes::Reference,
    "the reference of levels in dB; without it amplitudes are drawn",
);

/// The argument of figures with a spectrum of each run.
pub(super) const OF_RUNS: Argument = place(
    "signals",
    Takes::AmplitudesOfRuns,
    "one signal of several runs",
);

/// The arguments of a figure of spectra: its own, then the options of every spectrum.
macro_rules! with_options {
    ($($own:expr),* $(,)?) => {
        &[
            $($own,)*
            $crate::figure::spectrum::AXIS,
            $crate::figure::spectrum::UP_TO,
            $crate::figure::spectrum::WINDOW,
            $crate::figure::spectrum::BLOCK,
            $crate::figure::spectrum::OVERLAP,
            $crate::figure::spectrum::AVERAGING,
            $crate::figure::spectrum::MEAN,
            $crate::figure::spectrum::SCALE,
            $crate::figure::spectrum::REFERENCE,
        ]
    };
}
pub(super) use with_options;

pub(super) const ROW: FigureRow = FigureRow {
    name: "spectrum",
    about: "amplitudes (0-peak) over order or frequency",
    arguments: with_options![place("signals", Takes::Amplitudes, "the signals"),],
    plan,
};

fn plan(given: &Given) -> Result<Figure, Unplanned> {
    let (of, settings) = SpectrumSettings::new(given)?;
    Ok(Figure::of(
        &of.shown,
        Picture::Spectrum(Spectrum {
            members: of.members.clone(),
            settings,
        }),
    ))
}

impl SpectrumSettings {
    /// The signals of a figure of spectra, and how their spectra are made.
    pub(super) fn new(given: &Given) -> Result<(&Signals, SpectrumSettings), Unplanned> {
        let of = given.signals("signals")?;
        let (stated, up_to) = (given.word("axis", &AXES), given.limit("up_to"));
        let axis = match (stated, up_to) {
            (Some(Axis::Order), Some(Limit::Frequency(_))) => {
                return Err(other_axis("orders: a plain number is expected"));
            }
            (Some(Axis::Frequency), Some(Limit::Order(_))) => {
                return Err(other_axis("frequencies: write `2 kHz`"));
            }
            (Some(axis), _) => axis,
            (None, Some(Limit::Order(_))) => Axis::Order,
            (None, Some(Limit::Frequency(_))) => Axis::Frequency,
            (None, None) if of.cycle => Axis::Order,
            (None, None) => Axis::Frequency,
        };
        if axis == Axis::Order && !of.cycle {
            let by = if stated.is_some() { "axis" } else { "up_to" };
            return Err(Unplanned::NoCycle(by, "an axis of orders"));
        }
        let settings = SpectrumSettings {
            window: window(given, of),
            axis,
            up_to: up_to.map(|(Limit::Order(x) | Limit::Frequency(x))| x),
            block: given.extent("block"),
            overlap: overlap(given),
            averaging: given
                .word("averaging", &AVERAGINGS)
                .unwrap_or(Averaging::RootMeanSquare),
            remove_mean: given.word("mean", &MEANS).unwrap_or(true),
            logarithmic: logarithmic(given).unwrap_or(false),
            reference: given.number("reference"),
        };
        Ok((of, settings))
    }
}

fn other_axis(due: &str) -> Unplanned {
    let title = format!("`up_to` ends an axis of {due}");
    Unplanned::OtherAxis("up_to", title, "of another axis")
}

/// The stated scale.
pub(super) fn logarithmic(given: &Given) -> Option<bool> {
    given.word("scale", &SCALES)
}

/// The window as stated; else rectangular if the cycle repeats, and Hann elsewhere.
pub(super) fn window(given: &Given, of: &Signals) -> Window {
    let stated = given.word("window", &WINDOWS);
    stated.unwrap_or(match of.repeats {
        true => Window::Rectangular,
        false => Window::Hann,
    })
}

pub(super) fn overlap(given: &Given) -> f64 {
    given.number("overlap").unwrap_or(0.5)
}

impl Kind for Spectrum {
    fn expressions(&self) -> Vec<&Expression> {
        Signals::expressions(&self.members)
    }
}
