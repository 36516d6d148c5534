//! Machine code of every class of the library: its size is far below the instruction cache, and it gives the
//! interpreter's bits.
#![cfg(feature = "jit")]

use crate::support;
use crate::support::Random;
use eng_compiler::elaborate::{Elaborated, analyses, elaborate};
use eng_compiler::generate::compile_class;
use eng_compiler::library::LIBRARY;
use eng_compiler::resolve::resolve;
use eng_grammar::{Diagnostics, SourceMap};
use eng_system::code::{Function, Pair};
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

/// A model with an element of every class.
fn every_class() -> Elaborated {
    let (mut sources, mut diagnostics) = (SourceMap::new(), Diagnostics::new());
    let program = resolve(
        "every_class.eng",
        &Texts,
        LIBRARY,
        &mut sources,
        &mut diagnostics,
    );
    let typed = eng_compiler::check::check(program, &sources, &mut diagnostics);
    let plans = analyses(&typed, &mut sources, &Texts, &mut diagnostics);
    let plan = plans.first().expect("an analysis");
    elaborate(
        &typed,
        &mut sources,
        &Texts,
        plan.model,
        &plan.constants,
        &mut diagnostics,
    )
    .expect("a system")
}

#[test]
fn classes_of_the_library_are_smaller_than_the_instruction_cache() {
    // an engine has many films, which take most of its time; of gears, belts, cams and gas laws with valves it has few
    const FILM: usize = 16 * 1024;
    const OTHER: usize = 24 * 1024;
    let made = every_class();
    let mut missing = defined();
    let mut large = Vec::new();
    println!("{:22} bytes: sum, {:?}", "class", Function::ALL);
    for (class, functions) in made.system.classes.iter().zip(&made.classes) {
        let code = compile_class(functions, true).expect("machine code");
        if !missing.remove(&class.name) {
            continue;
        }
        // the functions of Newton's iteration share the instruction cache; kinks are evaluated once for each
        // step
        let bytes = code.code_bytes() - code.function_bytes(Function::Kinks);
        let each: Vec<usize> = Function::ALL
            .iter()
            .map(|f| code.function_bytes(*f))
            .collect();
        println!("{:22} {bytes:6} {each:?}", class.name);
        assert!(bytes > 0, "{}", class.name);
        let film = made.system.journals.iter().any(|journal| {
            let element = &made.system.elements[journal.element as usize];
            made.system.classes[element.class as usize].name == class.name
        });
        // a model by the mobility method has no other large class
        let given = class.name.ends_with("Mobility");
        if bytes >= if film && !given { FILM } else { OTHER } {
            large.push(format!("{}: {bytes}", class.name));
        }
    }
    assert!(
        missing.is_empty(),
        "no instance in every_class.eng: {missing:?}"
    );
    assert!(large.is_empty(), "{large:?}");
}

/// The order of angles, lengths and flags of the law does not matter here. The test uses any numbers, and
/// some values that are not numbers.
fn inputs(random: &mut Random, count: usize, special: bool) -> Vec<Pair> {
    let mut inputs: Vec<Pair> = (0..count).map(|_| [random.unit(), random.unit()]).collect();
    if special {
        let values = [f64::NAN, f64::INFINITY, -0.0, 0.0, 1e300, -1e-320];
        for (k, value) in values.into_iter().enumerate() {
            let place = random.bits() as usize % count.max(1);
            if let Some(pair) = inputs.get_mut(place) {
                pair[k % 2] = value;
            }
        }
    }
    inputs
}

#[test]
fn machine_code_of_the_library_has_the_interpreters_bits() {
    let made = every_class();
    let tables = support::tables();
    let mut random = Random(29);
    for functions in &made.classes {
        let machine = compile_class(functions, true).expect("machine code");
        let oracle = compile_class(functions, false).expect("an interpreter");
        for round in 0..60 {
            for which in Function::ALL {
                let (takes, gives) = oracle.shape(which);
                let inputs = inputs(&mut random, takes, round % 4 == 3);
                let (mut found, mut expected) = (vec![[0.5; 2]; gives], vec![[0.25; 2]; gives]);
                assert!(machine.call(which, &inputs, &mut found, &tables));
                assert!(oracle.call(which, &inputs, &mut expected, &tables));
                for (k, (x, y)) in found.iter().zip(&expected).enumerate() {
                    for (x, y) in x.iter().zip(y) {
                        assert!(
                            x.to_bits() == y.to_bits() || x.is_nan() && y.is_nan(),
                            "{} output {k}: {x} for {y}",
                            functions.get(which).name
                        );
                    }
                }
            }
        }
    }
}
