//! Trees of the library's texts that are kept from one reading of a program to the next.

use eng_compiler::resolve::{Trees, resolve, resolve_with};
use eng_grammar::ast::File;
use eng_grammar::{Diagnostics, SourceMap};
use eng_system::host::{Host, HostError};

struct Root<'a>(&'a str);

impl Host for Root<'_> {
    fn read_text(&self, path: &str) -> Result<String, HostError> {
        match path {
            "root.eng" => Ok(self.0.to_owned()),
            _ => Err(HostError::NotFound(path.to_owned())),
        }
    }
}

/// The trees of all modules by their paths, and the messages.
fn read(
    root: &str,
    library: &[(&str, &str)],
    trees: Option<&mut Trees>,
) -> (Vec<(String, File)>, Diagnostics) {
    let (mut sources, mut messages) = (SourceMap::new(), Diagnostics::new());
    let host = Root(root);
    let program = match trees {
        Some(_) => resolve_with(
            "root.eng",
            &host,
            library,
            trees,
            &mut sources,
            &mut messages,
        ),
        None => resolve("root.eng", &host, library, &mut sources, &mut messages),
    };
    let modules = program.modules.into_iter();
    let files = modules.map(|module| (module.path, module.file)).collect();
    (files, messages)
}

fn tree<'a>(read: &'a (Vec<(String, File)>, Diagnostics), path: &str) -> &'a File {
    let mut modules = read.0.iter();
    let module = modules.find(|(known, _)| known == path);
    &module.expect("a module").1
}

#[test]
fn a_kept_tree_is_that_of_the_text() {
    // the words after `kN` belong to a unit or not, by the units of the texts that were read before
    let text = "unit kN = 1e3 N\nconst a = 3 kN*depth\n";
    let wrong = "const a = = 3\n";
    let no_unit = "const c = 1\n";
    let unit = "unit depth = 2 kg\n";
    // the root sees the units of the library in the tree of its own text
    let second = "use std.a.*\nunit lump = 3 kg\nconst b = 2 lump*kN\n";
    let third = "use std.first.*\nuse std.a.*\nunit lump = 3 kg\nconst b = 2 lump*kN\n";
    let mut trees = Trees::default();
    let mut all = Vec::new();
    for (root, first, text) in [
        (second, no_unit, text),
        (second, no_unit, text),
        (third, no_unit, text),
        (third, unit, text),
        (third, unit, text),
        (third, unit, wrong),
        (third, unit, wrong),
        (third, no_unit, text),
        (second, no_unit, text),
    ] {
        let library = [("std.first", first), ("std.a", text)];
        let found = read(root, &library, Some(&mut trees));
        let due = read(root, &library, None);
        assert_eq!(found, due);
        all.push(due);
    }
    // place, units before, and text make other trees
    assert_eq!(tree(&all[0], "std.a"), tree(&all[1], "std.a"));
    assert_ne!(tree(&all[1], "std.a"), tree(&all[2], "std.a"));
    assert_ne!(tree(&all[2], "std.a"), tree(&all[3], "std.a"));
    assert_ne!(tree(&all[4], "std.a"), tree(&all[5], "std.a"));
    assert_ne!(all[4].1, all[5].1);
    // the units of a library's text make another tree of the root
    let alone = read(second, &[("std.a", no_unit)], None);
    assert_ne!(tree(&alone, "root"), tree(&all[0], "root"));
}
