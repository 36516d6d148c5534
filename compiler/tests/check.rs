//! What is right passes: the library, the examples, and the subtle things of the language; and gets its types.

mod check_support;

use check_support::{Run, render, run, run_in};
use eng_compiler::library::LIBRARY;
use eng_compiler::program::{DefinitionId, ValueType};
use eng_system::Dimension;

fn clean(run: &Run) {
    assert!(run.diagnostics.is_empty(), "{}", render(run));
}

#[test]
fn every_file_of_the_library_is_clean() {
    for (path, text) in LIBRARY {
        let run = run(&format!("use {path}.*\n"));
        let messages = render(&run);
        assert!(!run.diagnostics.has_errors(), "{path}:\n{messages}");
        assert!(!text.is_empty());
    }
}

#[test]
fn the_examples_are_clean() {
    for name in ["inline4", "slider_crank"] {
        let folder = format!("{}/../examples/{name}", env!("CARGO_MANIFEST_DIR"));
        let file = format!("{name}.eng");
        let text = std::fs::read_to_string(format!("{folder}/{file}")).expect("an example");
        clean(&run_in(&folder, &file, &text));
    }
}
