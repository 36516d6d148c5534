//! The one form of a text: it reads as the same tree, loses nothing, and is its own form.

use crate::common::{parsed, tree};
use eng_grammar::{FormatError, SourceId, format};
use proptest::prelude::*;
use std::path::{Path, PathBuf};

/// All `.eng` files of the repository.
fn files() -> Vec<(PathBuf, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"))
        .parent()
        .expect("the repository");
    let mut found = Vec::new();
    let mut folders = vec![root.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).expect("a folder") {
            let path = entry.expect("an entry").path();
            let name = path
                .file_name()
                .and_then(|name| name.to_str())
                .unwrap_or("");
            if path.is_dir() && !name.starts_with('.') && name != "target" && name != "results" {
                folders.push(path);
            } else if name.ends_with(".eng") {
                // fixtures of encodings are no texts
                if let Ok(text) = std::fs::read_to_string(&path) {
                    found.push((path, text));
                }
            }
        }
    }
    found.sort();
    found
}

/// All characters except blanks, line ends and byte order marks.
fn dense(text: &str) -> String {
    text.chars()
        .filter(|letter| !letter.is_whitespace() && *letter != '\u{FEFF}')
        .collect()
}

/// Formats a text that reads without a mistake. Checks the result without the formatter's own checks.
fn formed(name: &str, text: &str) -> String {
    let formed = match format(text, SourceId(0)) {
        Ok(formed) => formed,
        Err(error) => panic!("{name}: {error}\n{text}"),
    };
    assert_eq!(dense(text), dense(&formed), "{name}");
    let (before, _) = parsed(text);
    let (after, messages) = parsed(&formed);
    assert!(!messages.has_errors(), "{name}: {formed}");
    assert_eq!(tree(&before.items), tree(&after.items), "{name}");
    assert_eq!(before.docs, after.docs, "{name}");
    let again = format(&formed, SourceId(0)).expect("the form of a text has a form");
    assert_eq!(formed, again, "{name}: the second pass differs");
    formed
}

#[test]
fn texts_of_the_repository_keep_their_meaning() {
    let mut count = 0;
    for (path, text) in files() {
        let name = path.display().to_string();
        if parsed(&text).1.has_errors() {
            let refused = format(&text, SourceId(0));
            assert!(matches!(refused, Err(FormatError::Unreadable(_))), "{name}");
        } else {
            let formed = formed(&name, &text);
            let ends = formed
                .lines()
                .all(|line| line == line.trim_end() && !line.contains('\t'));
            assert!(
                ends || text.contains('\t'),
                "{name} has blanks at the ends of lines"
            );
            count += 1;
        }
    }
    assert!(count > 300, "{count} files");
}

const HANGING: [&str; 4] = [
    include_str!("../../examples/inline4/inline4.eng"),
    include_str!("../../examples/inline4/by_hand.eng"),
    include_str!("../../examples/slider_crank/slider_crank.eng"),
    include_str!("../../examples/big_end/big_end.eng"),
];

/// These texts have no lines that their author aligned, so the columns of their lines carry nothing.
#[test]
fn indents_come_back() {
    for text in HANGING {
        let text = formed("with indents", text);
        let flat: Vec<&str> = text.lines().map(str::trim_start).collect();
        assert_eq!(formed("without indents", &flat.join("\n")), text);
    }
}

#[test]
fn messes_are_tidied() {
    let text = include_str!("messy/messy.eng");
    insta::assert_snapshot!(formed("messy", text));
}

#[test]
fn mistakes_give_their_messages() {
    match format("let a = (b\n", SourceId(3)) {
        Err(FormatError::Unreadable(messages)) => {
            let span = messages
                .iter()
                .next()
                .and_then(|m| m.labels.first())
                .map(|l| l.span);
            assert_eq!(span.map(|span| span.source), Some(SourceId(3)));
        }
        other => panic!("{other:?}"),
    }
    assert_eq!(format("", SourceId(0)).expect("nothing is no mistake"), "");
    assert_eq!(
        format("\n\n // c \n\n\n", SourceId(0)).expect("a comment"),
        "// c\n"
    );
}

/// A check-out on Windows has other line ends than the repository, and stays in its form.
#[test]
fn the_first_line_end_is_that_of_all_lines() {
    let text =
        "// of one\nparam  bore:Length=86mm // wide\n\n\n/// Stroke.\nparam stroke: Length = 80 mm";
    let tidy = formed("line feeds", text);
    let returns = tidy.replace('\n', "\r\n");
    assert_eq!(formed("returns", &text.replace('\n', "\r\n")), returns);
    assert_eq!(formed("its own form", &returns), returns);
    assert_eq!(
        formed("first a return", &text.replacen('\n', "\r\n", 1)),
        returns
    );
    let last = text.replace("\n/// Stroke", "\r\n/// Stroke");
    assert_eq!(formed("last a return", &last), tidy);
}

/// A text whose blanks and line ends are others: `choices` decides for each in turn.
fn stirred(text: &str, choices: &[u8]) -> String {
    let mut out = String::new();
    let mut choices = choices.iter().cycle();
    for line in text.lines() {
        let mut rest = line.trim_start();
        let quiet = |line: &str| line.starts_with("//");
        if quiet(rest) {
            out.push_str(rest);
            out.push('\n');
            continue;
        }
        out.push_str(
            ["", " ", "\t", "        "][usize::from(choices.next().copied().unwrap_or(0) % 4)],
        );
        let mut inside = false;
        while let Some(letter) = rest.chars().next() {
            if !inside && quiet(rest) {
                break;
            }
            if letter == '"' {
                inside = !inside;
            }
            let choice = choices.next().copied().unwrap_or(0);
            let after_comma = out.ends_with(',');
            match letter {
                // the list of outputs that `accept` and `interpolation` continue takes line ends as well
                ' ' if !inside && after_comma && choice < 24 => out.push('\n'),
                ' ' if !inside && after_comma && choice < 40 => out.push_str(" // why\n\n\n"),
                ' ' if !inside => out.push_str([" ", "  ", " \t ", "\t"][usize::from(choice % 4)]),
                _ => out.push(letter),
            }
            rest = &rest[letter.len_utf8()..];
        }
        out.push_str(rest);
        let choice = choices.next().copied().unwrap_or(0);
        out.push_str(match choice % 8 {
            0 if rest.is_empty() => " // end\n",
            1 if rest.is_empty() => "\n// own\n",
            2 => "\r\n",
            3 => "\n\n\n",
            4 => "  \n",
            _ => "\n",
        });
    }
    out
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 500, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn stirred_texts_keep_their_meaning(
        which in any::<prop::sample::Index>(),
        choices in prop::collection::vec(any::<u8>(), 64..512),
    ) {
        thread_local! {
            static GOOD: Vec<String> = files()
                .into_iter()
                .map(|(_, text)| text)
                .filter(|text| text.len() < 1500 && !parsed(text).1.has_errors())
                .collect();
        }
        GOOD.with(|good| {
            let text = stirred(which.get::<String>(good), &choices);
            // a line end may have cut an item in two
            if !parsed(&text).1.has_errors() {
                formed("stirred", &text);
            }
        });
    }

    /// No text ends the formatter in a panic or in a fault of its own.
    #[test]
    fn any_text_is_formatted_or_refused(
        which in 0..HANGING.len(),
        place in 0.0..1.0f64,
        length in 0usize..12,
        insert in "[ \\n(){}\\[\\],;:=*/^.\"a1<>|-]{0,4}",
    ) {
        let mut characters: Vec<char> = HANGING[which].chars().collect();
        let at = (place*characters.len() as f64) as usize;
        let end = (at + length).min(characters.len());
        characters.splice(at..end, insert.chars());
        let text: String = characters.into_iter().collect();
        match format(&text, SourceId(0)) {
            Ok(formed) => prop_assert_eq!(dense(&text), dense(&formed)),
            Err(FormatError::Unreadable(messages)) => prop_assert!(messages.has_errors()),
            Err(error) => prop_assert!(false, "{}\n{}", error, text),
        }
    }
}
