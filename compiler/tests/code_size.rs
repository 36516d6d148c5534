//! Bytes of machine code of every class of the library: each stays far below the instruction cache.
#![allow(clippy::expect_used)]

use eng_compiler::elaborate::{analyses, elaborate};
use eng_compiler::generate::compile_class;
use eng_compiler::library::LIBRARY;
use eng_compiler::resolve::resolve;
use eng_grammar::{Diagnostics, SourceMap};
use eng_system::code::Function;
use eng_system::host::{Host, HostError};
use std::collections::BTreeSet;

struct Texts;

impl Host for Texts {
    fn read_text(&self, path: &str) -> Result<String, HostError> {
        (path == "every_class.eng")
            .then(|| include_str!("models/every_class.eng").into())
            .ok_or_else(|| HostError::NotFound(path.into()))
    }
}

/// Names of the classes that the library's texts define.
fn defined() -> BTreeSet<String> {
    let words = ["joint ", "drive ", "force ", "journal "];
    LIBRARY
        .iter()
        .flat_map(|(_, text)| text.lines())
        .filter_map(|line| words.iter().find_map(|word| line.strip_prefix(word)))
        .map(|rest| {
            rest.split(['(', ' ', '{'])
                .next()
                .unwrap_or_default()
                .to_owned()
        })
        .collect()
}

#[test]
fn every_class_of_the_library_takes_less_than_16_kilobytes() {
    const LIMIT: usize = 16 * 1024;
    let (mut sources, mut diagnostics) = (SourceMap::new(), Diagnostics::new());
    let program = resolve(
        "every_class.eng",
        &Texts,
        LIBRARY,
        &mut sources,
        &mut diagnostics,
    );
    let plans = analyses(&program, &mut sources, &Texts, &mut diagnostics);
    let plan = plans.first().expect("an analysis");
    let made = elaborate(
        &program,
        &mut sources,
        &Texts,
        plan.model,
        &plan.constants,
        &mut diagnostics,
    )
    .expect("a system");
    let mut missing = defined();
    let mut large = Vec::new();
    println!("{:22} bytes: sum, {:?}", "class", Function::ALL);
    for (class, functions) in made.system.classes.iter().zip(&made.classes) {
        let code = compile_class(functions.clone(), true).expect("machine code");
        if !missing.remove(&class.name) {
            continue;
        }
        let bytes = code.code_bytes();
        let each: Vec<usize> = Function::ALL
            .iter()
            .map(|f| code.function_bytes(*f))
            .collect();
        println!("{:22} {bytes:6} {each:?}", class.name);
        if bytes >= LIMIT {
            large.push(format!("{}: {bytes}", class.name));
        }
    }
    assert!(
        missing.is_empty(),
        "no instance in every_class.eng: {missing:?}"
    );
    assert!(large.is_empty(), "more than {LIMIT} bytes: {large:?}");
}
