//! Wrong texts and the messages about them.

use crate::common::{messages, parsed, tree};
use eng_grammar::CODES;
use eng_grammar::ast::ItemKind;
use std::collections::BTreeSet;

#[test]
fn wrong_files_and_their_messages() {
    insta::glob!("bad/*.eng", |path| {
        let text = std::fs::read_to_string(path).expect("a readable fixture");
        let (file, diagnostics) = parsed(&text);
        assert!(diagnostics.has_errors(), "{path:?} has no message");
        insta::assert_snapshot!(format!(
            "{}\n----\n{}\n----\n{}",
            text.trim_end(),
            messages(&text).trim_end(),
            tree(&file.items)
        ));
    });
}

/// One mistake for each line: it must have exactly one message, and the good lines around it must
/// remain.
#[test]
fn one_mistake_one_message() {
    let mut codes = BTreeSet::new();
    let mut report = String::new();
    for wrong in include_str!("one_line_mistakes.txt")
        .lines()
        .filter(|line| !line.is_empty())
    {
        let wrong = wrong.replace("\\n", "\n");
        let text = format!("let before = 1\n{wrong}\nlet after = 2\n");
        let (file, diagnostics) = parsed(&text);
        let found: Vec<_> = diagnostics.iter().collect();
        assert_eq!(found.len(), 1, "{wrong}\n{}", messages(&text));
        codes.insert(found[0].code);
        for item in [file.items.first(), file.items.last()] {
            assert!(
                matches!(item.map(|item| &item.kind), Some(ItemKind::Binding(_))),
                "{wrong}: a good line was lost\n{}",
                tree(&file.items)
            );
        }
        report += &format!("{}\n", messages(&text));
    }
    insta::assert_snapshot!(report);
    for code in codes {
        assert!(
            CODES.iter().any(|known| known.code == code),
            "{code} is not listed"
        );
    }
}

#[test]
fn a_misplaced_head_of_several_lines_has_one_message() {
    let text = "use std.joints.Revolute\n//! one\n//! two\n\n//! three\nmodel M { }\n";
    assert_eq!(parsed(text).1.iter().count(), 1, "{}", messages(text));
}

#[test]
fn every_code_has_a_wrong_text() {
    let mut shown = include_str!("one_line_mistakes.txt")
        .lines()
        .map(|line| line.replace("\\n", "\n"))
        .flat_map(|text| {
            parsed(&text)
                .1
                .iter()
                .map(|found| found.code)
                .collect::<Vec<_>>()
        })
        .collect::<BTreeSet<_>>();
    for text in [
        format!("let a = {}1{}", "(".repeat(300), ")".repeat(300)),
        "param 5\n".repeat(200),
        include_str!("bad/unclosed_block.eng").to_string(),
    ] {
        shown.extend(parsed(&text).1.iter().map(|found| found.code));
    }
    let listed: BTreeSet<_> = CODES.iter().map(|known| known.code).collect();
    assert_eq!(shown, listed);
}

/// Applying a fix must leave a text without that mistake.
#[test]
fn fixes_mend() {
    let mut fixed = 0;
    for wrong in include_str!("one_line_mistakes.txt").lines() {
        let wrong = wrong.replace("\\n", "\n");
        let (_, diagnostics) = parsed(&wrong);
        let Some(fix) = diagnostics.iter().find_map(|found| found.fixes.first()) else {
            continue;
        };
        let mut text = wrong.clone();
        text.replace_range(
            fix.span.start as usize..fix.span.end as usize,
            &fix.replacement,
        );
        let (_, after) = parsed(&text);
        assert!(after.is_empty(), "{wrong} -> {text}\n{}", messages(&text));
        fixed += 1;
    }
    assert!(fixed > 10, "only {fixed} fixes were tried");
}

/// The wrong example of an explanation has just the message that it explains, and the right example
/// has none.
#[test]
fn examples_of_the_codes_are_what_they_say() {
    for code in CODES {
        let found: Vec<_> = parsed(code.wrong)
            .1
            .iter()
            .map(|found| found.code)
            .collect();
        if code.wrong.is_empty() {
            assert_eq!(code.right, "", "{}", code.code);
        } else {
            assert_eq!(found, [code.code], "{}", code.wrong);
        }
        assert!(parsed(code.right).1.is_empty(), "{}", messages(code.right));
        assert!(!code.meaning.is_empty(), "{}", code.code);
    }
}
