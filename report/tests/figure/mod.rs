//! Figures and their parts.

mod bode;
mod decimate;
mod drawing;
mod film;
mod history;
mod orbit;
mod polar;
mod spectra;
mod sweep;
mod ticks;
mod tornado;
mod xy;
