//! Signals whose properties are known.

mod continuation;
mod difference;
mod extreme;
mod filter;
mod fourier;
mod harmonics;
mod level;
mod order;
mod resample;
mod sweep;
mod window;
