//! Unit tests of the library. They reach inner parts through its hidden module `internals`.

mod analyses;
mod animations;
mod commands;
mod exports;
mod fields;
mod figures;
mod rendering;
mod reports;
mod results;
mod server;
mod studies;
mod tables;
mod texts;
mod watching;
