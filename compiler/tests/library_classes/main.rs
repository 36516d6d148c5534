//! Every class of the library, at random states of oblique markers: generated code, derivatives, mechanics.
#![allow(clippy::expect_used)]

mod catalogue;
mod code;
mod double;
mod evaluate;
mod instance;
mod jacobian;
mod mechanics;
mod motion;
mod optimiser;
mod states;
#[path = "../support/mod.rs"]
mod support;
