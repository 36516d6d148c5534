//! The runtime on hand-made element classes, whose derivatives come from nested dual numbers.

#![allow(clippy::needless_range_loop)]

mod assembly;
mod flexible;
mod jacobian;
mod linear;
mod mechanisms;
mod motion;
mod order;
mod runs;
mod start;
mod support;
mod turning;
