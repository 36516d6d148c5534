//! The presentation of results: signals, figures, animations, the page.
//!
//! It turns plain data into the text or bytes of files. May contain: arithmetic, drawing, markup. Must not
//! contain: files, models, the language. The same input gives the same bytes on every machine.
//!
//! A spectrum with its settings, drawn for a paper and on a page:
//!
//! ```
//! use eng_report::figure::{Ordinate, Scale, spectra};
//! use eng_report::page::{Page, Section};
//! use eng_report::signal::{Sampling, Signal, SpectrumOptions, Window, spectrum};
//!
//! // two revolutions, one sample for each degree: 3 N of the second order
//! let force: Vec<f64> = (0..720)
//!     .map(|degree| 3.0 * libm::cos(2.0 * f64::from(degree).to_radians()))
//!     .collect();
//! let signal = Signal { values: &force, sampling: Sampling::Angle { step: 1.0 } };
//! let options = SpectrumOptions { window: Window::FlatTop, ..SpectrumOptions::default() };
//! let found = spectrum(signal, options)?;
//! let top = found.peaks(1)[0];
//! assert!((top.position - 2.0).abs() < 1e-12 && (top.amplitude - 3.0).abs() < 1e-10);
//!
//! let force_x = Ordinate {
//!     quantity: "Force x, 0-peak".to_owned(),
//!     unit: "N".to_owned(),
//!     frame: "block".to_owned(),
//! };
//! let figure = spectra("Journal 5", "unfired", force_x, Scale::Linear, Some(20.0), &[("E".to_owned(), &found)]);
//! let svg = figure.to_svg();
//! assert!(svg.contains("flat-top window, resolution 0.5000 orders"));
//!
//! let page = Page::new("Engine").section(Section::new("Forces").figure(figure, "The second order alone."));
//! assert!(page.to_html()?.contains("<b>Figure 1.</b> The second order alone."));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! A bar that bends while it turns, as a glTF file and as a file for ParaView:
//!
//! ```
//! use eng_report::animation::{
//!     Animation, Films, FlexibleBody, ModeShape, Pose, Surface, Up, VtkEncoding, VtkFrame, vtu,
//! };
//!
//! let bar = FlexibleBody {
//!     name: "bar".to_owned(),
//!     surface: Surface {
//!         nodes: vec![[0.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.1, 0.0, 0.5]],
//!         triangles: vec![[0, 1, 2]],
//!     },
//!     shapes: vec![ModeShape {
//!         name: "bending".to_owned(),
//!         displacements: vec![[0.0; 3], [0.0; 3], [1.0, 0.0, 0.0]],
//!     }],
//!     poses: vec![Pose::HOME, Pose { position: [0.0; 3], rotation: [0.0, 0.0, 0.0, 1.0] }],
//!     amplitudes: vec![vec![0.0], vec![2e-6]],
//!     fields: Vec::new(),
//! };
//! let displacements = bar.displacements(1);
//! let frame = VtkFrame {
//!     time: 0.01,
//!     pose: bar.poses[1],
//!     displacements: &displacements,
//!     stress: &[],
//!     von_mises: &[],
//!     fields: &[],
//! };
//! let file = vtu(&bar.vtk(), &frame, VtkEncoding::Base64)?;
//! assert!(file.contains("Name=\"displacement\""));
//!
//! let animation = Animation {
//!     title: "Bar".to_owned(),
//!     times: vec![0.0, 0.01],
//!     angles: vec![0.0, 180.0],
//!     up: Up::X,
//!     scale: 1000.0,
//!     slowdown: 100.0,
//!     flexible: vec![bar],
//!     rigid: Vec::new(),
//!     films: Films::default(),
//! };
//! assert_eq!(&animation.to_glb()?[..4], b"glTF");
//! # Ok::<(), eng_report::animation::AnimationError>(())
//! ```

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

pub mod animation;
pub mod escape;
pub mod figure;
pub mod page;
pub mod signal;
mod unit;

pub use unit::readable_unit;

/// Parts that the tests of `tests/` check alone. No other crate may use them.
#[doc(hidden)]
pub mod internals {
    use crate::animation::{AnimationError, FilmSurface, Films, NodeField};
    use crate::figure::marks::marks;
    use crate::figure::palette::{Color, Theme};
    use crate::figure::plane::View;
    use crate::figure::svg::{CurveTag, Stroke, Svg, Target};
    use crate::figure::sweep::cells::Cells;
    use crate::figure::{Orbit, Upright};
    use crate::signal::SweepMap;

    pub use crate::animation::packed::{deflated, packed};
    pub use crate::animation::viewer::file_stem;
    pub use crate::figure::bode::continued as continued_phases;
    pub use crate::figure::decimate::{runs as curve_runs, thinned};
    pub use crate::figure::film::within_a_turn;
    pub use crate::figure::font::text_width;
    pub use crate::figure::svg::coordinate;
    pub use crate::figure::sweep::cells::{ROWS as MOST_ROWS, edges as speed_edges};

    /// Signals beyond their ends.
    pub mod continuation {
        pub use crate::signal::continuation::{Continued, GROWTH, continued, weight};
    }

    /// Numbers of tables, and the scripts of a page.
    pub mod page {
        pub use crate::page::table::{shortened, significant};

        /// The script of figures.
        pub const FIGURES: &str = crate::page::FIGURES;
        /// The script of animations.
        pub const VIEWER: &str = crate::animation::SCRIPT;
    }

    /// Marks of axes.
    pub mod ticks {
        pub use crate::figure::ticks::{
            Ticks, crank_angle, exponent, inside, number, power_of_ten, ratios, rounded, shortest,
        };
    }

    /// Surfaces of rigid bodies.
    pub mod solid {
        pub use crate::animation::solid::{SIDES, Solid};
    }

    /// Still pictures.
    pub mod image {
        pub use crate::animation::image::{Canvas, Vertex};
    }

    /// Colours of still pictures.
    pub mod poster {
        pub use crate::animation::poster::{LEVELS, Range, level};
    }

    /// Rotations of pictures.
    pub mod quaternion {
        pub use crate::animation::quaternion::{cross, dot, minus, nearer, normalised, rotated};
    }

    /// Angle (°) and place (µm) of each mark of an orbit's last cycle.
    pub fn orbit_marks(orbit: &Orbit, period: f64) -> Vec<(i64, f64, f64)> {
        marks(&orbit.cell(), period)
    }

    /// The pixel of a point in a cell of a plane figure whose origin is at the pixel (0, 0), one pixel a unit.
    pub fn upright_point(upright: Upright, x: f64, y: f64) -> (f64, f64) {
        let view = View {
            center: (0.0, 0.0),
            scale: 1.0,
            upright,
        };
        view.point(x, y)
    }

    /// A drawing of a page with one curve through points (pixels), with the crank angle of each point (°).
    pub fn page_curve(points: &[(f64, f64)], angles: Vec<f64>) -> String {
        let target = Target {
            theme: Theme::Page,
            id: "a",
        };
        let mut svg = Svg::new(10.0, 10.0, "", target);
        let tag = CurveTag {
            name: "A",
            angles,
            ..CurveTag::default()
        };
        svg.curve(points, Stroke::solid(Color::Ink, 1.0), &tag);
        svg.finish()
    }

    /// The amplitudes of each speed's column of cells up to a position.
    pub fn merged_cells(map: &SweepMap, reach: f64) -> Vec<Vec<f64>> {
        Cells::new(map, reach).values
    }

    /// The pressures of a film at a time (index).
    pub fn film_field(film: &FilmSurface, time: usize, unit: &str) -> NodeField {
        film.field(time, unit)
    }

    /// Lowest and highest pressure of all films.
    pub fn film_range(films: &Films) -> [f64; 2] {
        films.range()
    }

    /// Displacements of a film's nodes for its pressures (m).
    pub fn film_hill(films: &Films, film: &FilmSurface, pressures: &[f64]) -> Vec<[f64; 3]> {
        films.hill(film, pressures)
    }

    /// Refuses a film that does not fit an animation of so many times.
    ///
    /// # Errors
    /// If its moments, poses, directions or pressures do not fit.
    pub fn check_film(film: &FilmSurface, times: usize) -> Result<(), AnimationError> {
        film.check(times)
    }
}
