//! Every class of the library, at random states of oblique markers: generated code, derivatives, mechanics.

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
