//! The runtime on hand-made element classes, whose derivatives come from nested dual numbers, and its methods alone.

#![allow(clippy::needless_range_loop)]

mod angles;
mod assembly;
mod cycles;
mod flexible;
mod floquet;
mod inputs;
mod integrator;
mod jacobian;
mod kinks;
mod linear;
mod mechanisms;
mod motion;
mod order;
mod repetition;
mod rotation;
mod rows;
mod runs;
mod singular;
mod small_motions;
mod start;
mod support;
mod thread_pool;
mod turning;
mod whirl;
