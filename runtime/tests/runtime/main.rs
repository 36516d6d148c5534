//! The runtime on hand-made element classes, whose derivatives come from nested dual numbers.

mod assembly;
mod jacobian;
mod mechanisms;
mod motion;
mod order;
mod runs;
mod support;
