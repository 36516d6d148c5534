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
// tests compare with the standard library's functions
#![cfg_attr(not(test), deny(clippy::disallowed_methods))]
// no input may end the library in a panic
#![cfg_attr(
    not(test),
    deny(
        clippy::unwrap_used,
        clippy::expect_used,
        clippy::panic,
        clippy::unreachable,
        clippy::todo
    )
)]

pub mod animation;
pub mod escape;
pub mod figure;
pub mod page;
pub mod signal;
mod unit;

pub use unit::readable_unit;
