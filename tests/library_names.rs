//! The Rust code of all crates names no class of the library, and no parameter or output of a class or interface: only the paths of
//! interfaces. It finds their members by order and type.

use eng_grammar::ast::{BindingKind, Form, ItemKind, Kind};
use eng_grammar::{Diagnostics, SourceId};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Paths of interfaces that Rust knows, each with its reason. No member of them is named.
const KNOWN: [(&str, &str); 3] = [
    // the start treats pins in films by rules of their own, and orbits are drawn of them
    ("compiler/src/program.rs", "JournalLaw"),
    // firing angles mark figures and give the orders of an engine; lints compare them with the dead centres
    ("compiler/src/program.rs", "GasLaw"),
    // `support` of a flexible body: no text states the joint to the ground, so elaboration makes it. An element needs a
    // class, and with the joint of the library that fills this interface its equations are written once
    ("compiler/src/program.rs", "Weld"),
];

/// Names of the library that are words of the language, too: members of reactions and of the cycle, attributes of
/// bodies and of meshes, words of flexible bodies and figures, operations, parameters of `dot`.
const WORDS: [&str; 14] = [
    "a",
    "b",
    "angle",
    "speed",
    "force",
    "torque",
    "damping",
    "stiffness",
    "length",
    "density",
    "width",
    "load",
    "power",
    "scale",
];

/// Names of parameters that messages use in examples of a user's text: `law: JournalLaw`, `rod[1].mass = 0.6 kg`.
const EXAMPLES: [&str; 2] = ["law", "rod"];

/// Files and folders whose words are not those of the library, each with its reason.
const OF_OTHER_WORDS: [(&str, &str); 10] = [
    (
        "compiler/src/codes/",
        "examples of messages are texts for people",
    ),
    ("src/codes.rs", "examples of messages are texts for people"),
    ("src/vocabulary.rs", "help on words of the language"),
    (
        "system/src/field.rs",
        "arguments and results of the kernels are words of the language, which a class passes on",
    ),
    ("src/fields.rs", "arguments and results of the kernels"),
    ("src/grid_error.rs", "results of the kernels"),
    ("src/recorded_field.rs", "drives and cells of the kernels"),
    (
        "film/src/",
        "this crate is the kernel: its errors name its own arguments",
    ),
    ("compiler/src/library.rs", "the names of the modules"),
    ("src/fmu/description.rs", "words of the standard of FMUs"),
];

/// Words that a name of the library happens to have, too: file, words, and their meaning there.
const HOMONYMS: [(&str, &[&str], &str); 8] = [
    (
        "system/src/lint.rs",
        &["bore", "firing"],
        "lints of the language",
    ),
    ("system/src/recorded.rs", &["phase"], "columns of responses"),
    (
        "system/src/figure/spectrum.rs",
        &["order"],
        "argument of figures of spectra",
    ),
    ("flexible/src/", &["spring"], "elements of meshes"),
    ("src/reduction/table.rs", &["spring"], "elements of meshes"),
    (
        "report/src/page/contents.rs",
        &["loss"],
        "a kind of row in the table of the power",
    ),
    (
        "report/src/signal/spectrum.rs",
        &["order"],
        "unit of an axis",
    ),
    (
        "report/src/animation/gltf.rs",
        &["height", "target"],
        "words of the format glTF",
    ),
];

/// Names of classes, interfaces, parameters and outputs of the library.
fn names() -> BTreeSet<String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("stdlib");
    let mut found = BTreeSet::new();
    for entry in std::fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.extension().is_none_or(|e| e != "eng") {
            continue;
        }
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
        assert!(!diagnostics.has_errors(), "{}", path.display());
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
        } else if path.extension().is_some_and(|e| e == "rs") && !path.ends_with("tests.rs") {
            let text = std::fs::read_to_string(&path).expect("a source");
            let code = text
                .split("#[cfg(test)]\nmod tests {")
                .next()
                .unwrap_or_default();
            let lines = code
                .lines()
                .filter(|line| !line.trim_start().starts_with("//"));
            found.push((path, lines.collect::<Vec<_>>().join("\n")));
        }
    }
    found.sort();
    found
}

/// The texts in quotes.
fn quoted(code: &str) -> Vec<String> {
    let mut found = Vec::new();
    let mut text: Option<String> = None;
    // a quote may also be a character
    let code = code.replace("'\"'", "");
    let mut letters = code.chars();
    while let Some(letter) = letters.next() {
        match (letter, &mut text) {
            ('\\', Some(text)) => text.extend(letters.next()),
            ('"', Some(_)) => found.extend(text.take()),
            ('"', None) => text = Some(String::new()),
            (letter, Some(text)) => text.push(letter),
            (_, None) => {}
        }
    }
    found
}

/// Whether a text is a name, or a path or a piece of code in backticks that contains it.
fn names_it(text: &str, name: &str) -> bool {
    text.match_indices(name).any(|(at, _)| {
        let before = text[..at].chars().next_back();
        let after = text[at + name.len()..].chars().next();
        let begins = matches!(before, None | Some('.' | '`'));
        begins && matches!(after, None | Some('.' | '[' | '`' | ':'))
    })
}

#[test]
fn names_are_found_in_paths_and_code() {
    for text in ["bore", "{}.bore", "{path}.bore.x", "give `bore:`", "`bore`"] {
        assert!(names_it(text, "bore"), "{text}");
    }
    for text in ["the bore of it", "bores", "a bore", "rebore"] {
        assert!(!names_it(text, "bore"), "{text}");
    }
    let code = r#"let a = "x\"y"; let b = '"'; f("z")"#;
    assert_eq!(quoted(code), ["x\"y", "z"]);
}

#[test]
fn rust_knows_the_library_by_paths_of_interfaces_only() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let names = names();
    let mut wrong = Vec::new();
    let (mut read, mut met) = (BTreeSet::new(), BTreeSet::new());
    for folder in [
        "grammar/src",
        "system/src",
        "compiler/src",
        "flexible/src",
        "film/src",
        "runtime/src",
        "report/src",
        "src",
        "python/src",
        "capi/src",
    ] {
        for (path, text) in sources(&root.join(folder)) {
            let file = path.strip_prefix(root).expect("inside").to_string_lossy();
            if OF_OTHER_WORDS.iter().any(|(at, _)| file.starts_with(at)) {
                continue;
            }
            let texts = quoted(&text);
            for name in &names {
                let known = KNOWN
                    .iter()
                    .find(|(at, known)| *at == file && known == name);
                let usual = |words: &[&str]| words.contains(&name.as_str());
                let own = |(at, words, _): &(&str, &[&str], &str)| {
                    file.starts_with(at) && words.contains(&name.as_str())
                };
                if known.is_none() && (usual(&WORDS) || usual(&EXAMPLES)) {
                    continue;
                }
                if !texts.iter().any(|text| names_it(text, name)) {
                    continue;
                }
                if let Some(place) = HOMONYMS.iter().position(own) {
                    met.insert((place, name.as_str()));
                    continue;
                }
                match known {
                    Some(known) => {
                        read.insert(*known);
                    }
                    None => wrong.push(format!("{file}: {name}")),
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
    // a name that is gone leaves the list
    for known in KNOWN {
        assert!(read.contains(&known), "{known:?}");
    }
    let unmet = HOMONYMS.iter().enumerate().flat_map(|(place, homonym)| {
        let words = homonym.1.iter().map(move |word| (place, *word));
        words.filter(|word| !met.contains(word))
    });
    assert_eq!(unmet.collect::<Vec<_>>(), []);
}
