//! The compiler and the runtime know no class of the library and no parameter or output of one: only the paths of
//! interfaces, and the members of these.

use eng_grammar::ast::{BindingKind, Form, ItemKind, Kind};
use eng_grammar::{Diagnostics, SourceId};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Modules of classes. Those of oils, materials and units define values.
const MODULES: [&str; 4] = ["joints", "drives", "forces", "journals"];

/// Files with names of the library, and these names. The paths of interfaces and of the weld are in `program.rs`, and
/// the members of the two interfaces that results read are in `laws.rs`.
const KNOWN: [(&str, &[&str]); 2] = [
    (
        "compiler/src/program.rs",
        &["JournalLaw", "GasLaw", "Fixed"],
    ),
    (
        "compiler/src/elaborate/element/laws.rs",
        &[
            "pin",
            "shell",
            "diameter",
            "width",
            "radial_clearance",
            "piston",
            "head",
            "bore",
            "firing",
        ],
    ),
];

/// Names of the library that are words of the language, too: members of reactions and of the cycle, attributes of
/// bodies and of meshes, words of flexible bodies and figures, operations, the parameters of the weld.
const WORDS: [&str; 13] = [
    "a",
    "b",
    "angle",
    "speed",
    "force",
    "torque",
    "damping",
    "stiffness",
    "length",
    "width",
    "load",
    "power",
    "scale",
];

/// Names of classes, interfaces, parameters and outputs of the library.
fn names() -> BTreeSet<String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("stdlib");
    let mut found = BTreeSet::new();
    for module in MODULES {
        let path = folder.join(format!("{module}.eng"));
        let text = std::fs::read_to_string(&path).expect("a module");
        let mut diagnostics = Diagnostics::new();
        for item in eng_grammar::parse(&text, SourceId(0), &mut diagnostics).items {
            let ItemKind::Declaration(declaration) = item.kind else {
                continue;
            };
            if declaration.kind == Kind::Record {
                continue;
            }
            found.insert(declaration.name.text);
            let (parameters, block) = match declaration.form {
                Form::Class {
                    parameters, block, ..
                } => (parameters, block),
                Form::Plain { block, .. } => (Vec::new(), block),
                Form::Instance { .. } => continue,
            };
            found.extend(parameters.into_iter().map(|parameter| parameter.name.text));
            for item in block.items {
                if let ItemKind::Binding(binding) = item.kind
                    && matches!(binding.kind, BindingKind::Param | BindingKind::Output)
                {
                    found.insert(binding.name.text);
                }
            }
        }
        assert!(!diagnostics.has_errors(), "{module}");
    }
    assert!(found.contains("Impedance") && found.contains("radial_clearance"));
    found
}

/// Files of a folder with their text, without comments and tests.
fn sources(folder: &Path) -> Vec<(PathBuf, String)> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            found.extend(sources(&path));
        } else if path.extension().is_some_and(|e| e == "rs") {
            let text = std::fs::read_to_string(&path).expect("a source");
            let code = text.split("#[cfg(test)]").next().unwrap_or_default();
            let lines = code
                .lines()
                .filter(|line| !line.trim_start().starts_with("//"));
            found.push((path, lines.collect::<Vec<_>>().join("\n")));
        }
    }
    found.sort();
    found
}

#[test]
fn the_compiler_knows_the_library_by_paths_of_interfaces_only() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let names = names();
    let mut wrong = Vec::new();
    let mut read = BTreeSet::new();
    for folder in ["compiler/src", "runtime/src"] {
        for (path, text) in sources(&root.join(folder)) {
            let file = path.strip_prefix(root).expect("inside").to_string_lossy();
            // examples of messages are texts for people
            if file.starts_with("compiler/src/codes/") {
                continue;
            }
            let known = KNOWN.iter().find(|(known, _)| *known == file);
            let known = known.map_or(&[] as &[&str], |(_, names)| names);
            for name in names
                .iter()
                .filter(|name| !WORDS.contains(&name.as_str()) || known.contains(&name.as_str()))
            {
                if !text.contains(&format!("\"{name}\"")) {
                    continue;
                }
                if known.contains(&name.as_str()) {
                    read.insert((file.to_string(), name.clone()));
                } else {
                    wrong.push(format!("{file}: {name}"));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
    // a name that is gone leaves the list
    for (file, names) in KNOWN {
        for name in names {
            assert!(
                read.contains(&(file.to_owned(), (*name).to_owned())),
                "{file}: {name}"
            );
        }
    }
}
