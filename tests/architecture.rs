//! The rules of the architecture: top-level modules of a crate have no circles, the library does not use the command
//! line, the crates below it neither print nor open files, functions are short, inner parts are for tests alone.
//!
//! Sources are read in the form of `cargo fmt`, without the tests inside of them.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// The crates with the folders of their sources.
const CRATES: [(&str, &str); 11] = [
    ("eng", "src"),
    ("eng-grammar", "grammar/src"),
    ("eng-system", "system/src"),
    ("eng-compiler", "compiler/src"),
    ("eng-flexible", "flexible/src"),
    ("eng-film", "film/src"),
    ("eng-runtime", "runtime/src"),
    ("eng-report", "report/src"),
    ("eng-python", "python/src"),
    ("eng-capi", "capi/src"),
    ("eng-playground", "playground/src"),
];

/// The crates whose unit tests stand in their folder `tests/`.
const WITH_INTERNALS: [&str; 8] = [
    "eng",
    "eng-grammar",
    "eng-system",
    "eng-compiler",
    "eng-flexible",
    "eng-film",
    "eng-runtime",
    "eng-report",
];

/// Most lines of a function.
const LONGEST: usize = 120;

/// All `.rs` files below a folder with their texts, without comments, contents of strings, and tests.
fn sources(folder: &Path) -> Vec<(PathBuf, String)> {
    let mut found = Vec::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).expect("a folder") {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == "rs") {
                let text = std::fs::read_to_string(&path).expect("a source");
                found.push((path, without_tests(&bare(&text))));
            }
        }
    }
    found.sort();
    found
}

/// A text of Rust whose comments, strings and characters are blank, line by line as long as before.
fn bare(text: &str) -> String {
    let letters: Vec<char> = text.chars().collect();
    let mut out = String::with_capacity(text.len());
    let mut at = 0;
    let blank = |from: usize, to: usize, out: &mut String| {
        for letter in letters.get(from..to).unwrap_or_default() {
            out.push(if *letter == '\n' { '\n' } else { ' ' });
        }
        to
    };
    let is = |at: usize, wanted: &str| {
        let mut place = at;
        wanted.chars().all(|letter| {
            place += 1;
            letters.get(place - 1) == Some(&letter)
        })
    };
    let find = |from: usize, wanted: &str| (from..letters.len()).find(|at| is(*at, wanted));
    while let Some(letter) = letters.get(at) {
        let word_before = at > 0
            && letters
                .get(at - 1)
                .is_some_and(|c| c.is_alphanumeric() || *c == '_');
        at = if is(at, "//") {
            let end = find(at, "\n").unwrap_or(letters.len());
            blank(at, end, &mut out)
        } else if is(at, "/*") {
            let end = find(at + 2, "*/").map_or(letters.len(), |end| end + 2);
            blank(at, end, &mut out)
        } else if *letter == 'r' && !word_before && (is(at, "r\"") || is(at, "r#")) {
            let hashes = letters[at + 1..].iter().take_while(|c| **c == '#').count();
            if letters.get(at + 1 + hashes) == Some(&'"') {
                let close = format!("\"{}", "#".repeat(hashes));
                let end = find(at + 2 + hashes, &close).map_or(letters.len(), |e| e + close.len());
                blank(at, end, &mut out)
            } else {
                out.push('r');
                at + 1
            }
        } else if *letter == '"' {
            let mut end = at + 1;
            while letters.get(end).is_some_and(|c| *c != '"') {
                end += if letters[end] == '\\' { 2 } else { 1 };
            }
            blank(at, (end + 1).min(letters.len()), &mut out)
        } else if *letter == '\'' && letters.get(at + 1) == Some(&'\\') {
            let end = find(at + 3, "'").map_or(letters.len(), |end| end + 1);
            blank(at, end, &mut out)
        } else if *letter == '\'' && letters.get(at + 2) == Some(&'\'') {
            blank(at, at + 3, &mut out)
        } else {
            out.push(*letter);
            at + 1
        };
    }
    out
}

/// A text without the modules that are compiled for tests alone: from `#[cfg(test)]` to the brace in the same column.
fn without_tests(text: &str) -> String {
    let mut kept: Vec<&str> = Vec::new();
    let mut lines = text.lines().peekable();
    while let Some(line) = lines.next() {
        let indent = line.len() - line.trim_start().len();
        if line.trim() == "#[cfg(test)]" {
            let end = format!("{}}}", " ".repeat(indent));
            for skipped in lines.by_ref() {
                let item = skipped.trim_end();
                if item == end
                    || (item.ends_with(';') && skipped.len() - skipped.trim_start().len() == indent)
                {
                    break;
                }
            }
        } else {
            kept.push(line);
        }
    }
    kept.join("\n")
}

/// Words and signs: names, `::`, and single signs.
fn tokens(text: &str) -> Vec<String> {
    let mut found: Vec<String> = Vec::new();
    let mut letters = text.chars().peekable();
    while let Some(letter) = letters.next() {
        if letter.is_alphanumeric() || letter == '_' {
            let mut word = String::from(letter);
            while let Some(next) = letters.next_if(|c| c.is_alphanumeric() || *c == '_') {
                word.push(next);
            }
            found.push(word);
        } else if letter == ':' && letters.next_if_eq(&':').is_some() {
            found.push("::".to_owned());
        } else if !letter.is_whitespace() {
            found.push(letter.to_string());
        }
    }
    found
}

/// The names after `head::` with the place after them; of `head::{a::b, c}` both `a` and `c`.
fn heads(tokens: &[String], at: usize) -> Vec<String> {
    match tokens.get(at).map(String::as_str) {
        Some("{") => {
            let (mut depth, mut found, mut place) = (1, Vec::new(), at + 1);
            let mut first = true;
            while depth > 0 {
                match tokens.get(place).map(String::as_str) {
                    None => break,
                    Some("{") => depth += 1,
                    Some("}") => depth -= 1,
                    Some(",") if depth == 1 => first = true,
                    Some(name) if depth == 1 && first => {
                        found.push(name.to_owned());
                        first = false;
                    }
                    _ => {}
                }
                place += 1;
            }
            found
        }
        Some(name) => vec![name.to_owned()],
        None => Vec::new(),
    }
}

/// The items of the crate's root that a text names, by `crate::` or by one `super::` for each level of its depth.
fn named(text: &str, depth: usize) -> Vec<String> {
    let tokens = tokens(text);
    let is = |at: usize, wanted: &str| tokens.get(at).is_some_and(|token| token == wanted);
    let mut found = Vec::new();
    let mut at = 0;
    while at < tokens.len() {
        if is(at, "crate") && is(at + 1, "::") {
            found.extend(heads(&tokens, at + 2));
        } else if is(at, "super") && (at == 0 || !is(at - 1, "::")) {
            let mut climbed = 0;
            while is(at + 2 * climbed, "super") && is(at + 2 * climbed + 1, "::") {
                climbed += 1;
            }
            if climbed >= depth {
                found.extend(heads(&tokens, at + 2 * climbed));
            }
        }
        at += 1;
    }
    found
}

/// The names that the root exports from modules: `pub use run::RunOutcome` gives `RunOutcome` → `run`.
fn handed_on(root: &str) -> BTreeMap<String, String> {
    let mut found = BTreeMap::new();
    for part in root.split("use ").skip(1) {
        let tokens = tokens(part.split(';').next().unwrap_or_default());
        let Some(module) = tokens.first() else {
            continue;
        };
        for pair in tokens.windows(2) {
            if pair[1] != "::" && pair[0] != "::" {
                found.insert(pair[0].clone(), module.clone());
            }
        }
        if let Some(last) = tokens.last() {
            found.insert(last.clone(), module.clone());
        }
    }
    found
}

/// The modules of a crate's root, and for each the others that it names.
fn modules(folder: &str) -> BTreeMap<String, BTreeSet<String>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
    let sources = sources(&folder);
    let mut texts: Vec<(String, usize, &String)> = Vec::new();
    let mut root = String::new();
    for (path, text) in &sources {
        let inside = path.strip_prefix(&folder).expect("below the folder");
        let mut parts: Vec<String> = inside
            .with_extension("")
            .iter()
            .map(|part| part.to_string_lossy().into_owned())
            .collect();
        parts.retain(|part| part != "mod");
        match parts.as_slice() {
            [only] if only == "lib" => root = text.clone(),
            [only] if only == "main" => {}
            [first, ..] => texts.push((first.clone(), parts.len(), text)),
            [] => {}
        }
    }
    let names: BTreeSet<String> = texts.iter().map(|(name, ..)| name.clone()).collect();
    // exports for tests are no way between modules
    let exports = root.split("pub mod internals {").next();
    let handed_on = handed_on(exports.unwrap_or_default());
    let mut graph: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for (name, depth, text) in texts {
        let edges = graph.entry(name.clone()).or_default();
        for item in named(text, depth) {
            let module = match names.contains(&item) {
                true => Some(&item),
                false => handed_on
                    .get(&item)
                    .filter(|module| names.contains(*module)),
            };
            edges.extend(module.filter(|module| **module != name).cloned());
        }
    }
    graph
}

/// All modules that a module reaches.
fn reached(graph: &BTreeMap<String, BTreeSet<String>>, from: &str) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    let mut open = vec![from.to_owned()];
    while let Some(module) = open.pop() {
        for next in graph.get(&module).into_iter().flatten() {
            if found.insert(next.clone()) {
                open.push(next.clone());
            }
        }
    }
    found
}

/// Groups of modules of which each reaches all others of its group.
fn circles(graph: &BTreeMap<String, BTreeSet<String>>) -> BTreeSet<Vec<String>> {
    graph
        .keys()
        .map(|module| {
            let own = reached(graph, module);
            let round = own
                .iter()
                .filter(|other| reached(graph, other).contains(module));
            round.cloned().collect::<Vec<String>>()
        })
        .filter(|group| group.len() > 1)
        .collect()
}

#[test]
fn modules_of_a_crate_have_no_circles() {
    let mut found: BTreeSet<(String, Vec<String>)> = BTreeSet::new();
    for (name, folder) in CRATES {
        let graph = modules(folder);
        assert!(graph.len() > 1, "{name}: no modules are seen in {folder}");
        for circle in circles(&graph) {
            for module in &circle {
                let inside: Vec<&String> = graph[module]
                    .iter()
                    .filter(|other| circle.contains(other))
                    .collect();
                println!("{name}: {module} names {inside:?}");
            }
            found.insert((name.to_owned(), circle));
        }
    }
    assert!(found.is_empty(), "{found:?}");
}

#[test]
fn the_library_does_not_know_the_command_line() {
    for (module, names) in modules("src") {
        assert!(!names.contains("cli"), "{module} names `cli`");
    }
}

/// The functions of a text with their numbers of lines: nothing for a function whose end is not found.
fn lengths(text: &str) -> Vec<(String, Option<usize>)> {
    let lines: Vec<&str> = text.lines().map(str::trim_end).collect();
    let mut found = Vec::new();
    for (begin, line) in lines.iter().enumerate() {
        let Some((_, name)) = line.split_once("fn ").filter(|(before, _)| {
            before.split_whitespace().all(|word| {
                word.starts_with("pub")
                    || ["const", "unsafe", "extern"].contains(&word)
                    || word.ends_with(')')
            })
        }) else {
            continue;
        };
        let indent = line.len() - line.trim_start().len();
        let close = format!("{}}}", " ".repeat(indent));
        let rest = &lines[begin..];
        let length = rest
            .iter()
            .position(|line| line.ends_with(['{', '}', ';']))
            .and_then(|head| match rest[head].ends_with('{') {
                true => rest.iter().position(|line| *line == close),
                // a method without a body, or a body in the same line
                false => Some(head),
            })
            .map(|end| end + 1);
        let name = name
            .chars()
            .take_while(|c| c.is_alphanumeric() || *c == '_');
        found.push((name.collect(), length));
    }
    found
}

#[test]
fn functions_are_short() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut found = Vec::new();
    for (_, folder) in CRATES {
        for (path, text) in sources(&root.join(folder)) {
            for (name, length) in lengths(&text) {
                if length.is_none_or(|length| length > LONGEST) {
                    found.push(format!("{}: {name} has {length:?} lines", path.display()));
                }
            }
        }
    }
    assert!(found.is_empty(), "{found:#?}");
}

/// A crate whose library is not compiled as tests has none in its sources: they would never run.
#[test]
fn libraries_without_tests_contain_none() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut without = Vec::new();
    for (name, folder) in CRATES {
        let manifest = root.join(folder).join("../Cargo.toml");
        let manifest = std::fs::read_to_string(manifest).expect("a manifest");
        let (_, library) = manifest.split_once("[lib]\n").unwrap_or_default();
        let library = library.split("\n[").next().unwrap_or_default();
        if !library.lines().any(|line| line == "test = false") {
            continue;
        }
        without.push(name);
        let mut folders = vec![root.join(folder)];
        while let Some(folder) = folders.pop() {
            for entry in std::fs::read_dir(&folder).expect("a folder") {
                let path = entry.expect("an entry").path();
                if path.is_dir() {
                    folders.push(path);
                } else if path.extension().is_some_and(|e| e == "rs") {
                    let text = bare(&std::fs::read_to_string(&path).expect("a source"));
                    assert!(!text.contains("cfg(test)"), "{}", path.display());
                }
            }
        }
    }
    for name in WITH_INTERNALS {
        assert!(without.contains(&name), "{without:?}");
    }
}

/// The uses of a hidden module `internals` in a text: `eng_film::internals`, `crate::internals`, `eng::{internals, check}`.
fn uses_of_internals(text: &str) -> usize {
    let tokens = tokens(text);
    let is = |at: usize, wanted: &str| tokens.get(at).is_some_and(|token| token == wanted);
    (0..tokens.len())
        .filter(|at| is(*at, "internals") && !(*at > 0 && is(at - 1, "mod")))
        .count()
}

/// Only the tests of a crate reach its inner parts.
#[test]
fn no_source_uses_internals() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut with_internals = Vec::new();
    for (name, folder) in CRATES {
        for (path, text) in sources(&root.join(folder)) {
            assert_eq!(uses_of_internals(&text), 0, "{}", path.display());
            if text.contains("pub mod internals {") {
                with_internals.push(name);
            }
        }
    }
    assert_eq!(with_internals, WITH_INTERNALS);
    // tests reach those of their own crate
    for (name, folder) in CRATES {
        let own = format!("{}::internals", name.replace('-', "_"));
        let folder = root.join(folder).join("../tests");
        for (path, text) in folder
            .is_dir()
            .then(|| sources(&folder))
            .into_iter()
            .flatten()
        {
            let uses = uses_of_internals(&text);
            assert_eq!(uses, text.matches(&own).count(), "{}", path.display());
        }
    }
}

/// The words of a text that print, or open a file.
fn effects(text: &str) -> Vec<String> {
    let tokens = tokens(text);
    let mut found = Vec::new();
    for (at, word) in tokens.iter().enumerate() {
        let next = tokens.get(at + 1).map_or("", String::as_str);
        let effect = match word.as_str() {
            "print" | "println" | "eprint" | "eprintln" | "dbg" => next == "!",
            "stdin" | "stdout" | "stderr" => next == "(",
            "std" if next == "::" => heads(&tokens, at + 2).iter().any(|head| head == "fs"),
            "fs" => next == "::",
            "File" => {
                next == "::"
                    && heads(&tokens, at + 2)
                        .iter()
                        .any(|head| ["open", "create", "create_new", "options"].contains(&&**head))
            }
            "OpenOptions" => true,
            _ => false,
        };
        if effect {
            found.push(word.clone());
        }
    }
    found
}

#[test]
fn crates_below_the_library_neither_print_nor_open_files() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut found = Vec::new();
    for (name, folder) in CRATES {
        if ["eng", "eng-python", "eng-capi"].contains(&name) {
            continue;
        }
        for (path, text) in sources(&root.join(folder)) {
            let inside = path.strip_prefix(root).expect("below the root");
            let inside = inside.to_string_lossy().replace('\\', "/");
            let effects = effects(&text);
            if !effects.is_empty() {
                found.push((inside, effects));
            }
        }
    }
    assert!(found.is_empty(), "{found:#?}");
}

#[test]
fn the_rules_can_fail() {
    let lines = "    let a = 1;\n".repeat(LONGEST);
    let text = format!(
        "trait A {{\n    fn a(&self);\n}}\nfn b() {{}}\npub(crate) fn c() {{\n{lines}}}\nfn d() {{\n    e();\n"
    );
    let due = [
        ("a", Some(1)),
        ("b", Some(1)),
        ("c", Some(LONGEST + 2)),
        ("d", None),
    ];
    assert_eq!(
        lengths(&text),
        due.map(|(name, length)| (name.to_owned(), length))
    );

    let uses = |pairs: &[(&str, &str)]| {
        let mut graph: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
        for (from, to) in pairs {
            let edges = graph.entry((*from).to_owned()).or_default();
            edges.insert((*to).to_owned());
        }
        graph
    };
    let straight = [("a", "b"), ("a", "c"), ("b", "c")];
    assert_eq!(circles(&uses(&straight)), BTreeSet::new());
    let circle = [("a", "b"), ("b", "c"), ("c", "b"), ("c", "d")];
    let due = ["b", "c"].map(str::to_owned).to_vec();
    assert_eq!(circles(&uses(&circle)), BTreeSet::from([due]));

    let text = "pub mod internals { } use eng_film::internals::Ring; use eng::{internals, check};";
    assert_eq!(uses_of_internals(text), 2);

    let text =
        "use std::{fs::File, io}; use std::io::Read; fn a(out: &mut dyn Write) { File::default();
        writeln!(out, \"println!\"); File::open(b); println!(); fs::read(c); }";
    assert_eq!(effects(&bare(text)), ["std", "fs", "File", "println", "fs"]);
    assert_eq!(
        effects("use std::io::Read; writeln!(out); File::default()").len(),
        0
    );
}

#[test]
fn paths_are_read_as_written() {
    let text =
        "use crate::{a::{b, c}, d}; use super::super::e::f; fn g() { crate::h(); super::i() }
        // crate::j
        let k = \"crate::l\"; let m = '\\''; let n: &'static str = r#\"crate::o\"#;
        #[cfg(test)]
        mod tests {
            use crate::p;
        }";
    let bare = without_tests(&bare(text));
    assert_eq!(named(&bare, 2), ["a", "d", "e", "h"]);
    assert_eq!(named(&bare, 1), ["a", "d", "e", "h", "i"]);
    let handed_on = handed_on("pub use a::{B, c::D}; pub use e::F;");
    assert_eq!(handed_on["D"], "a");
    assert_eq!(handed_on["F"], "e");
}

/// The first paragraph of a file's head, without links.
fn head(text: &str) -> String {
    let lines = text.lines().map_while(|line| line.strip_prefix("//!"));
    let paragraph: Vec<&str> = lines
        .map(str::trim)
        .take_while(|line| !line.is_empty())
        .collect();
    let text = paragraph.join(" ").replace("[`", "`").replace("`]", "`");
    text.replace('|', "\\|")
}

/// `docs/modules.md` has the heads of all top-level modules. A failure writes the right page beside the results of
/// the build.
#[test]
fn the_page_of_modules_has_their_heads() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut page = String::from(
        "# Modules\n\nThe top-level modules of all crates, from the heads of their files. `tests/architecture.rs` compares them.\n",
    );
    for (name, folder) in CRATES {
        page.push_str(&format!(
            "\n## `{name}`\n\n| module | contents |\n| --- | --- |\n"
        ));
        let mut rows = BTreeMap::new();
        for entry in std::fs::read_dir(root.join(folder)).expect("a folder") {
            let path = entry.expect("an entry").path();
            let file = match path.is_dir() {
                true => path.join("mod.rs"),
                false => path.clone(),
            };
            let module = path.file_stem().expect("a name").to_string_lossy();
            let text = match std::fs::read_to_string(&file) {
                Ok(text) if file.extension().is_some_and(|e| e == "rs") => text,
                // the folder of a module whose file is beside it, or the grammar
                _ => continue,
            };
            if module != "lib" && module != "main" {
                let place = file.strip_prefix(root).expect("below the root");
                let place = place.to_string_lossy().replace('\\', "/");
                let row = format!("| [`{module}`](../{place}) | {} |\n", head(&text));
                rows.insert(module.into_owned(), row);
            }
        }
        page.extend(rows.into_values());
    }
    let kept = std::fs::read_to_string(root.join("docs/modules.md")).unwrap_or_default();
    if kept != page {
        let place = Path::new(env!("CARGO_TARGET_TMPDIR")).join("modules.md");
        std::fs::write(&place, &page).expect("a file");
        panic!("docs/modules.md is not as {}", place.display());
    }
}
