//! Messages for people and for tools: excerpts, colours, control characters.

use codespan_reporting::files::Files;
use eng::internals::render::{Excerpt, Excerpts, visible, visible_json};
use eng::render::{Colors, human, json};
use eng_grammar::{Diagnostic, Diagnostics, SourceId, SourceMap, Span};

#[test]
fn short_lines_stay_and_long_ones_are_cut_around_places() {
    let long = format!("let a = {}HERE{}\n", "x + ".repeat(500), " + y".repeat(500));
    let text = format!("first\n{long}last\n");
    let at = text.find("HERE").unwrap();
    let place = at..at + 4;
    let excerpts = Excerpts(vec![Excerpt::new("a.eng", &text, &[place])]);
    let shown = excerpts.source(0).unwrap();
    assert!(shown.starts_with("first\nlet a = x + "), "{shown}");
    assert!(shown.ends_with("…\nlast\n"), "{shown}");
    assert!(shown.chars().count() < 400, "{}", shown.len());
    let place = excerpts.0[0].place(at);
    assert_eq!(&shown[place..place + 4], "HERE");
    let line = excerpts.line_index(0, place).unwrap();
    assert_eq!(line, 1);
    let range = excerpts.line_range(0, line).unwrap();
    assert!(shown[range].contains("HERE"));
    // the column counts in the whole text
    let column = text[..at].rsplit('\n').next().unwrap().chars().count() + 1;
    assert_eq!(excerpts.column_number(0, line, place).unwrap(), column);
    assert_eq!(
        excerpts.line_index(0, shown.find("last").unwrap()).unwrap(),
        2
    );
}

#[test]
fn control_characters_are_escaped_and_places_stay() {
    let text = "let a = x // \u{1b}[31m\u{9b}\r\nlet b = \u{202e}HERE";
    let at = text.find("HERE").unwrap();
    let place = at..at + 4;
    let excerpt = Excerpt::new("\u{7}.eng", text, &[place]);
    assert_eq!(
        excerpt.shown,
        "let a = x // \\u{1b}[31m\\u{9b}\r\nlet b = \\u{202e}HERE"
    );
    assert_eq!(excerpt.name, "\\u{7}.eng");
    let place = excerpt.place(at);
    assert_eq!(&excerpt.shown[place..], "HERE");
    assert_eq!(excerpt.original(place), at);
    let excerpts = Excerpts(vec![excerpt]);
    assert_eq!(excerpts.line_index(0, place).unwrap(), 1);
    assert_eq!(excerpts.column_number(0, 1, place).unwrap(), 10);
}

#[test]
fn letters_of_several_bytes_are_not_cut_apart() {
    let text = "µ".repeat(1000);
    for at in [0, 2, 500, 1998, 2000] {
        let place = at..at;
        let excerpt = Excerpt::new("a.eng", &text, &[place]);
        assert!(excerpt.shown.chars().all(|c| c == 'µ' || c == '…'));
        let place = excerpt.place(at);
        assert!(excerpt.shown.is_char_boundary(place));
        assert_eq!(excerpt.original(place), at);
    }
}

fn example() -> (Diagnostics, SourceMap) {
    let mut sources = SourceMap::new();
    let text =
        "model Slider {\n    // Länge in µm\n    param throw: Length = 54 m\n    body rod {}\n}\n";
    let id = sources.add("slider.eng", text);
    let at = |needle: &str| {
        let start = text.find(needle).unwrap();
        Span::new(id, start, start + needle.len())
    };
    let mut diagnostics = Diagnostics::new();
    diagnostics.push(
        Diagnostic::error("E0312", "throw is a length of 54 m")
            .at(at("54 m"), "54 m here")
            .also(at("Length"), "declared here")
            .with_note("throws of engines are 10 mm to 400 mm")
            .with_help("state the intended unit")
            .with_fix("perhaps", at("54 m"), "54 mm"),
    );
    diagnostics.push(
        Diagnostic::warning("W0002", "body rod has no mass")
            .at(at("rod"), "")
            .with_fix(
                "",
                Span::new(
                    id,
                    text.find("{}").unwrap() + 1,
                    text.find("{}").unwrap() + 1,
                ),
                " mass = 1 kg ",
            )
            .with_fix("", at("body rod {}"), ""),
    );
    (diagnostics, sources)
}

#[test]
fn plain_text() {
    let (diagnostics, sources) = example();
    insta::assert_snapshot!(human(&diagnostics, &sources, Colors::None));
}

#[test]
fn colours_are_escape_sequences_around_the_same_text() {
    let (diagnostics, sources) = example();
    let colored = human(&diagnostics, &sources, Colors::Ansi);
    let mut plain = String::new();
    let mut rest = colored.as_str();
    while let Some((before, after)) = rest.split_once('\u{1b}') {
        plain.push_str(before);
        rest = after.split_once('m').unwrap().1;
    }
    plain.push_str(rest);
    assert_ne!(colored, plain);
    let trimmed: Vec<&str> = plain.lines().map(str::trim_end).collect();
    let expected = human(&diagnostics, &sources, Colors::None);
    assert_eq!(trimmed, expected.lines().collect::<Vec<_>>());
}

#[test]
fn json_document() {
    let (diagnostics, sources) = example();
    insta::assert_snapshot!(json(&diagnostics, &sources));
}

#[test]
fn control_characters_are_shown() {
    let mut sources = SourceMap::new();
    let text = "let a = \u{1b}[31mx\n";
    let id = sources.add("a\u{9b}.eng", text);
    let mut diagnostics = Diagnostics::new();
    diagnostics.push(
        Diagnostic::error("E0001", "no \u{1b}]0;x\u{7}")
            .at(Span::new(id, 13, 14), "\u{202e}here")
            .with_note("\u{8}note")
            .with_help("help\r")
            .with_fix("", Span::new(id, 8, 13), "\u{1b}"),
    );
    let text = human(&diagnostics, &sources, Colors::None);
    assert!(
        !text.chars().any(|c| c != '\n' && c.is_control()),
        "{text:?}"
    );
    assert!(!text.contains('\u{202e}'), "{text}");
    assert!(text.contains(r"a\u{9b}.eng:1:14"), "{text}");
    let document = json(&diagnostics, &sources);
    assert!(
        !document.chars().any(|c| c != '\n' && c.is_control()),
        "{document:?}"
    );
    let value: serde_json::Value = serde_json::from_str(&document).unwrap();
    assert_eq!(value["diagnostics"][0]["file"], "a\u{9b}.eng");
}

#[test]
fn of_very_many_messages_a_hundred_are_shown_errors_first() {
    let mut diagnostics = Diagnostics::new();
    for i in 0..400 {
        diagnostics.push(Diagnostic::warning("W0001", format!("doubt {i}")));
    }
    for i in 0..99 {
        diagnostics.push(Diagnostic::error("E0001", format!("mistake {i}")));
    }
    let text = human(&diagnostics, &SourceMap::new(), Colors::None);
    assert_eq!(text.matches("warning[").count(), 1, "{text}");
    assert_eq!(text.matches("error[").count(), 99, "{text}");
    assert!(
        text.ends_with("… and 399 more messages\n99 errors, 400 warnings\n"),
        "{text}"
    );
}

#[test]
fn spans_that_lie_outside_do_no_harm() {
    let mut sources = SourceMap::new();
    let id = sources.add("a.eng", "µ");
    let mut diagnostics = Diagnostics::new();
    diagnostics.push(
        Diagnostic::error("E0001", "cut")
            .at(Span::new(id, 1, 1), "inside a character")
            .also(Span::new(id, 90, 7), "beyond")
            .also(Span::new(SourceId(7), 0, 1), "of no source")
            .with_fix("", Span::new(SourceId(7), 3, 4), "x"),
    );
    let text = human(&diagnostics, &sources, Colors::None);
    for message in [
        "inside a character",
        "beyond",
        "note: of no source",
        "insert `x`",
    ] {
        assert!(text.contains(message), "{text}");
    }
    let value: serde_json::Value = serde_json::from_str(&json(&diagnostics, &sources)).unwrap();
    assert_eq!(value["diagnostics"][0]["start"], 0);
    assert_eq!(
        value["diagnostics"][0]["labels"][2]["file"],
        serde_json::Value::Null
    );
}

#[test]
fn what_acts_is_shown_and_all_else_stays() {
    assert_eq!(visible("a\tb\nµ…°"), "a\tb\nµ…°");
    assert_eq!(
        visible("\u{1b}[31m\u{9b}0m\r\u{7}\u{202e}"),
        r"\u{1b}[31m\u{9b}0m\u{d}\u{7}\u{202e}"
    );
    assert_eq!(visible_json("\u{9b}\u{202e}"), r"\u009b\u202e");
}
