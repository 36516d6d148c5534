//! Figures: the table of their kinds, and the trees that are drawn.
//!
//! Each kind has a file here. It holds a struct with the signals and numbers of the kind, an implementation of
//! [`Kind`], and a [`FigureRow`] with the name, the arguments and the function that makes the tree of them. The
//! checker reads the row and names no kind. `src/post/picture` draws each kind.

mod argument;
mod bode;
mod campbell;
mod film;
mod history;
mod orbit;
mod order_track;
mod polar;
mod spectrum;
mod tornado;
mod waterfall;
mod xy;

pub use argument::{Argument, Given, Journals, Recorded, Signals, Takes, Unplanned, Value};
pub use bode::Bode;
pub use campbell::Campbell;
pub use film::FilmMap;
pub use history::History;
pub use orbit::Orbit;
pub use order_track::OrderTrack;
pub use polar::{Polar, Vector};
pub use spectrum::{AVERAGINGS, Averaging, Axis, Spectrum, SpectrumSettings};
pub use tornado::Tornado;
pub use waterfall::Waterfall;
pub use xy::Xy;

use crate::dimension::DisplayUnit;
use crate::expression::Expression;
use crate::kinds::dereferences;

/// The kinds that a text can name, in the order in which messages list them.
pub const KINDS: &[FigureRow] = &[
    history::ROW,
    spectrum::ROW,
    orbit::ROW,
    polar::ROW,
    order_track::ROW,
    waterfall::ROW,
    campbell::ROW,
    xy::ROW,
    bode::ROW,
    film::ROW,
    tornado::ROW,
];

/// The kind with a name.
pub fn kind(name: &str) -> Option<&'static FigureRow> {
    KINDS.iter().find(|row| row.name == name)
}

/// The name and the arguments of a kind in a text, and the function that makes a tree of them.
#[derive(Debug)]
pub struct FigureRow {
    /// `history`.
    pub name: &'static str,
    /// The drawn content, for messages and `eng explain`.
    pub about: &'static str,
    /// Its arguments: those by place, then those by name.
    pub arguments: &'static [Argument],
    /// Makes the tree from the stated arguments.
    pub plan: fn(&Given) -> Result<Figure, Unplanned>,
}

/// A figure of one kind.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// The name of the ordinate.
    pub quantity: String,
    /// The unit of the ordinate.
    pub display: DisplayUnit,
    /// Its kind, with the drawn signals.
    pub picture: Picture,
}

impl Figure {
    /// A figure whose ordinate has the name and the unit of a signal.
    pub(crate) fn of(shown: &Recorded, picture: Picture) -> Figure {
        Figure {
            quantity: shown.quantity.clone(),
            display: shown.display.clone(),
            picture,
        }
    }
}

/// The properties of a figure that every stage reads.
pub trait Kind {
    /// The signals that it reads.
    fn expressions(&self) -> Vec<&Expression>;

    /// The analyses that it reads beside those of its signals.
    fn analyses(&self) -> Vec<&str> {
        Vec::new()
    }

    /// Signals that it draws one over the other, so that whole runs must have the same samples.
    fn paired(&self) -> Vec<(&Expression, &Expression)> {
        Vec::new()
    }
}

/// A figure of one kind, with its signals and numbers. It dereferences to its [`Kind`].
#[derive(Clone, Debug, PartialEq)]
pub enum Picture {
    /// Curves over crank angle or time.
    History(History),
    /// Spectra.
    Spectrum(Spectrum),
    /// Paths of pins.
    Orbit(Orbit),
    /// Vectors.
    Polar(Polar),
    /// Orders over speed.
    OrderTrack(OrderTrack),
    /// Spectra one behind the other.
    Waterfall(Waterfall),
    /// Colours over speed and frequency.
    Campbell(Campbell),
    /// Signals over other signals.
    Xy(Xy),
    /// Amplitudes and phases over frequency.
    Bode(Bode),
    /// Cells of films.
    Film(FilmMap),
    /// Changes of a value.
    Tornado(Tornado),
}

dereferences!(Picture to Kind: History Spectrum Orbit Polar OrderTrack Waterfall Campbell Xy Bode Film Tornado);
