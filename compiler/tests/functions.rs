//! The table of the language's functions and the table of their explanations.

use eng_compiler::functions::all_explained;
use eng_compiler::internals::function_names;

#[test]
fn every_function_is_explained() {
    let names: Vec<&str> = function_names().collect();
    let explained: Vec<&str> = all_explained().map(|(name, ..)| name).collect();
    assert_eq!(names, explained);
}
