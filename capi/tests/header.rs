//! The header describes exactly the functions of the library.

use std::collections::BTreeMap;
use std::path::Path;

/// The text between two marks after each `begin`.
fn declared<'a>(text: &'a str, begin: &str, end: &str) -> Vec<&'a str> {
    let parts = text.split(begin).skip(1);
    parts
        .filter_map(|part| Some(part.split_once(end)?.0))
        .collect()
}

/// Types of arguments and of the result in C of a function of the sources.
fn in_c(rust: &str) -> String {
    let rust = rust.trim();
    if let Some(to) = rust.strip_prefix("*const ") {
        return format!("const {} *", in_c(to));
    }
    if let Some(to) = rust.strip_prefix("*mut ") {
        return format!("{} *", in_c(to));
    }
    match rust {
        "" => "void",
        "c_char" => "char",
        "c_int" => "int",
        "usize" => "size_t",
        "u8" => "uint8_t",
        "f64" => "double",
        other => other,
    }
    .to_owned()
}

/// Result and arguments by the name of each function of the sources.
fn functions() -> BTreeMap<String, (String, Vec<String>)> {
    let mut found = BTreeMap::new();
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/c");
    for file in ["mod.rs", "program.rs", "model.rs", "simulation.rs"] {
        let text = std::fs::read_to_string(folder.join(file)).expect("a source");
        // a row of the macro gives a name for each of its functions
        let rows: Vec<Vec<&str>> = declared(&text, "names! {\n", "\n}")
            .iter()
            .flat_map(|rows| rows.lines())
            .filter_map(|row| {
                Some(
                    row.split_once(':')?
                        .1
                        .trim_end_matches(';')
                        .split(',')
                        .map(str::trim)
                        .collect(),
                )
            })
            .collect();
        for function in declared(&text, "extern \"C\" fn ", " {\n") {
            let (name, rest) = function.split_once('(').expect("arguments");
            let (arguments, result) = rest.rsplit_once(')').expect("their end");
            let arguments = arguments
                .split(',')
                .filter_map(|argument| Some(in_c(argument.split_once(':')?.1)));
            let signature = (
                in_c(result.trim().trim_start_matches("->")),
                arguments.collect::<Vec<_>>(),
            );
            let place = ["$count", "$path", "$unit", "$index"]
                .iter()
                .position(|known| *known == name);
            match place {
                None => drop(found.insert(name.to_owned(), signature)),
                Some(place) => {
                    for row in &rows {
                        found.insert(row[place].to_owned(), signature.clone());
                    }
                }
            }
        }
    }
    found
}

#[test]
fn the_header_has_each_function_with_its_types() {
    let header = Path::new(env!("CARGO_MANIFEST_DIR")).join("include/eng.h");
    let header = std::fs::read_to_string(header).expect("the header");
    let spaced = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
    let mut described = BTreeMap::new();
    for line in header
        .lines()
        .filter(|line| line.contains(" eng_") || line.contains("*eng_"))
    {
        let Some((head, arguments)) = line.trim_end_matches(");").split_once('(') else {
            continue;
        };
        let Some((result, name)) = head.rsplit_once("eng_").filter(|_| line.ends_with(");")) else {
            continue;
        };
        let typed = |argument: &str| {
            let end = argument.trim_end_matches(|c: char| c.is_alphanumeric() || c == '_');
            spaced(end)
        };
        let arguments = arguments
            .split(", ")
            .filter(|argument| *argument != "void")
            .map(typed);
        described.insert(
            format!("eng_{name}"),
            (spaced(result), arguments.collect::<Vec<_>>()),
        );
    }
    assert!(described.len() > 30, "{described:?}");
    assert_eq!(described, functions());
}
