//! Pictures of results, as SVG files for papers and in a page with a script.
//!
//! May contain: scales, ticks, colours, text placement. Must not contain: models, results files, printing.
//! The text of a picture depends on the data alone. Both kinds come from the same drawing. In a page a
//! picture has the colours of the page, and its groups have attributes with which the script zooms, reads
//! values and hides curves. Without the script the picture does not move.
//!
//! Lengths are in pixels of a sheet, mostly 1200 pixels wide. Places, gaps, sizes of text and widths of lines
//! in the drawings are choices by eye. Text beside a point lies 0.36 of its size lower: that is half the
//! height of a digit, so the digit is centred at the point.

mod abscissa;
mod axes;
pub(crate) mod bode;
pub(crate) mod decimate;
pub(crate) mod film;
pub(crate) mod font;
mod history;
mod key;
mod legend;
mod levels;
pub(crate) mod marks;
mod orbit;
pub(crate) mod palette;
pub(crate) mod plane;
mod polar;
mod spectra;
pub(crate) mod svg;
pub(crate) mod sweep;
pub(crate) mod ticks;
mod tornado;
mod xy;

pub use abscissa::Abscissa;
pub use axes::Scale;
pub use bode::{Bode, BodeCurve};
pub use film::{FilmMap, FilmPanel};
pub use font::FAMILY as FONT_FAMILY;
pub use history::{Curve, History, Mark, Ordinate, Panel, journal_letter};
pub use orbit::{Orbit, Orbits};
pub use plane::Upright;
pub use polar::{FixedTo, Polar, PolarCurve};
pub use spectra::spectra;
pub use sweep::{Campbell, SweepFigure, Waterfall};
pub use tornado::{Tornado, TornadoBar};
pub use xy::{Xy, XyCurve};

pub(crate) use ticks::significant;

use palette::Theme;
use svg::Target;

macro_rules! figures {
    ($($(#[$about:meta])* $kind:ident: $($title:ident).+),* $(,)?) => {
        /// Any picture.
        #[derive(Clone, Debug, PartialEq)]
        pub enum Figure {
            $($(#[$about])* $kind($kind)),*
        }

        impl Figure {
            /// Its title.
            pub fn title(&self) -> &str {
                match self {
                    $(Figure::$kind(figure) => &figure.$($title).+),*
                }
            }

            fn draw(&self, target: Target<'_>) -> String {
                match self {
                    $(Figure::$kind(figure) => figure.draw(target)),*
                }
            }
        }

        $(impl $kind {
            /// The figure as SVG, 1200 pixels wide, a file of its own.
            pub fn to_svg(&self) -> String {
                self.draw(Target::PAPER)
            }
        }

        impl From<$kind> for Figure {
            fn from(figure: $kind) -> Figure {
                Figure::$kind(figure)
            }
        })*
    };
}

// each kind with its title; it has a method `draw`
figures!(
    /// Curves.
    History: title,
    /// Paths of pins.
    Orbits: title,
    /// Polar diagrams.
    Polar: title,
    /// Spectra one behind the other.
    Waterfall: figure.title,
    /// Colours over speed and frequency.
    Campbell: figure.title,
    /// Amplitude and phase over frequency.
    Bode: title,
    /// Curves of one quantity over another one.
    Xy: title,
    /// Colours over angle and width of bearings.
    FilmMap: title,
    /// Bars of changes.
    Tornado: title,
);

impl Figure {
    /// A file of its own, for papers.
    pub fn to_svg(&self) -> String {
        self.draw(Target::PAPER)
    }

    /// A part of a page. `id` differs from that of every other drawing in the page.
    pub(crate) fn in_page(&self, id: &str) -> String {
        self.draw(Target {
            theme: Theme::Page,
            id,
        })
    }
}
