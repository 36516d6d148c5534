//! Parts of the language server.

use eng::internals::server::{
    Document, argument, begins_argument, body, call_around, formed_range, guarded, is_quiet,
    names_before, path, path_at, position, refuse, uri, without_indices,
};
use lsp_server::Message;
use serde_json::{Value, json};
use std::path::PathBuf;

#[test]
fn indices_are_left_out() {
    assert_eq!(without_indices("a.main[2].force[1,2].x"), "a.main.force.x");
    assert_eq!(without_indices("run[*"), "run");
}

#[test]
fn positions_count_utf16_units() {
    let document = Document::new("untitled:a", "a\u{1d70b}µ\r\nb");
    for (byte, line, character) in [
        (0, 0, 0),
        (1, 0, 1),
        (5, 0, 3),
        (7, 0, 4),
        (9, 1, 0),
        (10, 1, 1),
    ] {
        let place = json!({ "line": line, "character": character });
        assert_eq!(position(&document.text, byte), place);
        assert_eq!(document.byte(&place), byte, "{place}");
    }
    // in the middle of a character, after a line, after the text
    assert_eq!(document.byte(&json!({ "line": 0, "character": 2 })), 1);
    assert_eq!(document.byte(&json!({ "line": 0, "character": 99 })), 7);
    assert_eq!(document.byte(&json!({ "line": 9, "character": 0 })), 10);
    assert_eq!(document.byte(&json!({ "line": -1 })), 0);
}

#[test]
fn changes_follow_each_other() {
    let mut document = Document::new("untitled:a", "\u{1d70b}b\r\nc\n");
    let place = |line: u32, character: u32| json!({ "line": line, "character": character });
    let mut change = |start: Value, end: Value, text: &str| {
        let range = json!({ "start": start, "end": end });
        document.change(&json!({ "range": range, "text": text }));
        document.text.clone()
    };
    assert_eq!(change(place(0, 2), place(0, 3), "d"), "\u{1d70b}d\r\nc\n");
    assert_eq!(change(place(0, 3), place(1, 1), ""), "\u{1d70b}d\n");
    // beyond the text, and backwards
    assert_eq!(change(place(7, 0), place(9, 9), "e"), "\u{1d70b}d\ne");
    assert_eq!(change(place(1, 1), place(0, 0), "f"), "\u{1d70b}d\nef");
    document.change(&json!({ "text": "g" }));
    document.change(&json!({ "text": 3 }));
    assert_eq!(document.text, "g");
}

#[test]
fn paths_survive_a_uri() {
    let folder = std::env::temp_dir().canonicalize().expect("a folder");
    let file = folder.join("an engine %41 µ.eng");
    assert_eq!(path(&uri(&file)), Some(file));
    assert_eq!(path("untitled:Untitled-1"), None);
    if cfg!(unix) {
        let folder = PathBuf::from("/a:b/model.eng");
        assert_eq!(path("file:///a:b/model.eng"), Some(folder));
    }
}

#[test]
fn arguments_are_counted() {
    assert_eq!(
        argument("a.b, [1, 2] mm, f(c, d), width: 3 "),
        (3, " width: 3 ")
    );
    assert_eq!(argument(""), (0, ""));
    let text = "A(b, width: c";
    assert!(begins_argument(text, 3) && !begins_argument(text, text.len()));
    assert!(!begins_argument("a = b", 5));
}

#[test]
fn the_items_of_a_range_get_their_form() {
    let text = "const  a=1\nmodel M {\n  param b:Length=2 mm\n  const c=3; const  d=4\n}\n";
    let document = Document::new("untitled:a", text);
    let edits = |line: u32| {
        let place = json!({ "line": line, "character": 4 });
        let edits = formed_range(&document, &json!({ "start": place, "end": place }));
        let edits = edits.as_array().cloned().unwrap_or_default();
        let texts = edits.iter().map(|edit| edit["newText"].clone());
        texts.collect::<Vec<Value>>()
    };
    assert_eq!(edits(0), [json!("const a = 1")]);
    assert_eq!(edits(2), [json!("    param b: Length = 2 mm")]);
    let wrong = Document::new("untitled:a", "const  a = = 1\n");
    let all = json!({ "start": { "line": 0 }, "end": { "line": 9 } });
    assert_eq!(formed_range(&wrong, &all), json!([]));
}

#[test]
fn a_panic_is_an_error_with_its_words() {
    assert_eq!(guarded(|| 3), Ok(3));
    let number = 4;
    let panicked: Result<(), String> = guarded(|| panic!("no {number}"));
    assert_eq!(panicked, Err("no 4".to_owned()));
}

#[test]
fn paths_are_read_backwards() {
    let text = "let a = crank.main[3].force + f(b, c).x.";
    let found = path_at(text, text.find("orce").expect("there")).expect("a path");
    assert_eq!(
        (found.names.join("/"), found.written.as_str()),
        ("crank/main/force".into(), "crank.main[3].force")
    );
    assert_eq!(&text[found.start..found.end], "force");
    assert_eq!(names_before(text, text.len()), ["f", "x"]);
    assert!(path_at("a = 12", 5).is_none());
    assert!(path_at("", 3).is_none());
    let call = call_around("joint a = Revolute(b, [1, 2], ", 30).expect("a call");
    assert_eq!(call.names, ["Revolute"]);
    assert!(call_around("body a { (b) ", 13).is_none());
    assert!(is_quiet("a // b") && is_quiet("\"a // ") && !is_quiet("\"//\" a"));
}

#[test]
fn bodies_end_where_their_headers_say() {
    let text = "Content-Length: 2\r\nContent-Type: x\r\n\r\n{}content-length:3\r\n\r\n[1]";
    let mut input = text.as_bytes();
    assert_eq!(body(&mut input).expect("a body"), Some(b"{}".to_vec()));
    assert_eq!(body(&mut input).expect("a body"), Some(b"[1]".to_vec()));
    assert_eq!(body(&mut input).expect("the end"), None);
}

#[test]
fn wrong_headers_are_refused() {
    let long = format!("{}\r\n\r\n", "a".repeat(5000));
    for text in [
        "Content-Length: 99999999999999\r\n\r\n{}",
        "Content-Length: 99999999999999999999999\r\n\r\n{}",
        "Content-Length: -1\r\n\r\n{}",
        "Content-Length: 5\r\n\r\n{}",
        "Content-Length 5\r\n\r\n{}",
        "Accept: all\r\n\r\n{}",
        "Content-Length: 5",
        long.as_str(),
    ] {
        assert!(body(&mut text.as_bytes()).is_err(), "{text}");
    }
}

#[test]
fn a_body_that_is_no_message_gets_an_error() {
    for (text, code) in [("{ \"id\": 3", -32700), ("{ \"id\": 3 }", -32600)] {
        let error = serde_json::from_str::<Message>(text).expect_err("no message");
        let mut output: Vec<u8> = Vec::new();
        refuse(&mut output, text.as_bytes(), &error).expect("written");
        let body = body(&mut output.as_slice()).expect("a body").expect("one");
        let answer: serde_json::Value = serde_json::from_slice(&body).expect("JSON");
        assert_eq!(
            (&answer["error"]["code"], &answer["id"]),
            (&json!(code), &json!(null))
        );
    }
}
