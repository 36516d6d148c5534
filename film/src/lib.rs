//! Oil films of journal bearings: Reynolds' equation on cells of the unwrapped gap.
//!
//! A [`Film`] is made of plain numbers ([`FilmSource`]). [`Film::solve`] turns inputs (place of the pin, its
//! rates, spin, viscosity, pressures) into force, moment and torque on the pin; [`Film::tangent`] gives their
//! exact derivatives, and [`Film::summary`] the pressures, flows and powers. All numbers are SI and in the
//! shell's frame; `docs/theory.md` has the equations with their signs.
//!
//! ```
//! use eng_film::{Cavitation, Film, FilmSource, Inputs};
//!
//! let film = Film::new(FilmSource::plain(27e-3, 24e-3, 27e-6, Cavitation::Reynolds, [72, 13]))?;
//! let mut work = film.work();
//! let mut outputs = vec![0.0; film.outputs()];
//! let inputs = Inputs { eccentricity: [20e-6, 0.0], spin: 400.0, ..Inputs::still(8e-3) };
//! film.solve(&inputs.write(), None, &[], &mut work, &mut outputs)?;
//! assert!(outputs[0] < 0.0 && outputs[1] > 0.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Invariants of this crate:
//! - The crate has no markers, bodies, elements, files, threads or integrators. The caller passes the length of a
//!   step and calls [`Film::accept`] after it.
//! - A film keeps no state. A solution uses the memory in [`Work`] and allocates none.
//! - The same input gives the same bits.
#![forbid(unsafe_code)]
#![deny(clippy::disallowed_methods)]
// no input may end the library in a panic
#![deny(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::unreachable,
    clippy::todo
)]

mod active;
mod annulus;
mod block;
mod edge;
mod elastic;
mod error;
mod feedback;
mod film;
mod gap;
mod grid;
pub mod impedance;
pub mod inputs;
mod results;
mod ring;
mod source;
mod surfaces;
mod tangent;
mod turning;
mod waves;

pub use annulus::ElasticRing;
pub use elastic::{Elastic, ElasticWork};
pub use eng_system::field::Accuracy;
pub use eng_system::surface::SurfaceShape as Shape;
pub use error::{FilmError, Place, SourceError};
pub use film::{Film, Work};
pub use inputs::Inputs;
pub use results::{Quantity, Summary};
pub use source::{
    Beside, Cavitation, EdgeSlope, Ends, Feed, FilmSource, Lines, Opening, Part, Profile,
};
pub use surfaces::{Roughness, Thinning};

/// Parts for the tests in `tests/` alone. No other crate may use them.
#[doc(hidden)]
pub mod internals {
    pub use crate::ring::{EAST, HIGH, LOW, OWN, RingMatrix, WEST};
    pub use crate::surfaces::{Contact, Surfaces, moment};
    pub use crate::turning::factors_and_shares;
}
