//! The tests of the library for C and FMI, as one program.

#![expect(unsafe_code, reason = "calls of the functions for C")]

mod coupled;
mod fmu;
mod from_c;
mod header;
mod importer;

/// The text of a rotor with a brake.
const ROTOR: &str = include_str!("rotor.eng");
