//! The generated recogniser; `eng.pest` is its source.
#![allow(missing_docs)]

#[derive(pest_derive::Parser)]
#[grammar = "eng.pest"]
pub(crate) struct EngGrammar;
