//! `eng lsp` as an editor drives it: the real command, over its standard input and output.

use crate::support::Temporary;
use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Read, Write};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::time::{Duration, Instant};

const SWING: &str = "use std.joints.Revolute

/// A bob on an arm.
model Swing {
    /// From the pivot to the bob.
    param length: Length = 400 mm in (10 mm, 2 m)
    gravity = [0, -9.81, 0] m/s^2
    marker pivot = [0, 0, 0] mm
    body bob {
        mass = 1.2 kg
        inertia = [2, 2, 2] g*m^2
        marker top = [0, 1, 0]*length
    }
    joint pin = Revolute(bob.top, pivot)
    start pin.angle = 30 deg
    output height = dot(bob.origin.origin, ground.y) as mm
}
analysis swing = transient(Swing(), duration: 5 s, sample: 10 ms)
";

/// An editor with one folder.
struct Editor {
    child: Child,
    input: Option<ChildStdin>,
    output: BufReader<ChildStdout>,
    folder: Temporary,
    next: i64,
    /// Messages that came while an answer was due.
    told: Vec<Value>,
}

impl Editor {
    fn start(name: &str) -> Editor {
        let mut folder = Temporary::new(&format!("lsp-{name}"));
        folder.0 = folder.canonicalize().expect("a folder");
        let mut child = Command::new(env!("CARGO_BIN_EXE_eng"))
            .arg("lsp")
            .env("ENG_CACHE", folder.join("cache"))
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("the command starts");
        let output = BufReader::new(child.stdout.take().expect("an output"));
        let mut editor = Editor {
            input: child.stdin.take(),
            output,
            child,
            folder,
            next: 0,
            told: Vec::new(),
        };
        let about = editor.ask(
            "initialize",
            &json!({ "capabilities": {}, "processId": null, "rootUri": null }),
        );
        assert_eq!(about["serverInfo"]["name"], "eng");
        assert_eq!(about["capabilities"]["hoverProvider"], true);
        editor.tell("initialized", &json!({}));
        editor
    }

    fn send(&mut self, message: &Value) {
        let body = message.to_string();
        let input = self.input.as_mut().expect("an open input");
        write!(input, "Content-Length: {}\r\n\r\n{body}", body.len()).expect("the server reads");
        input.flush().expect("the server reads");
    }

    fn tell(&mut self, method: &str, params: &Value) {
        self.send(&json!({ "jsonrpc": "2.0", "method": method, "params": params }));
    }

    fn receive(&mut self) -> Value {
        let mut length = 0;
        loop {
            let mut line = String::new();
            assert!(
                self.output.read_line(&mut line).expect("the server writes") > 0,
                "it has ended"
            );
            match line.trim() {
                "" => break,
                line => {
                    if let Some(count) = line.strip_prefix("Content-Length: ") {
                        length = count.parse().expect("a number");
                    }
                }
            }
        }
        let mut body = vec![0; length];
        self.output.read_exact(&mut body).expect("a body");
        serde_json::from_slice(&body).expect("JSON")
    }

    /// The whole response to a request.
    fn response(&mut self, method: &str, params: &Value) -> Value {
        self.next += 1;
        let id = self.next;
        self.send(&json!({ "jsonrpc": "2.0", "id": id, "method": method, "params": params }));
        loop {
            let message = self.receive();
            if message["id"] == id {
                return message;
            }
            self.told.push(message);
        }
    }

    fn ask(&mut self, method: &str, params: &Value) -> Value {
        let response = self.response(method, params);
        assert!(response["error"].is_null(), "{method}: {response}");
        response["result"].clone()
    }

    fn uri(&self, name: &str) -> String {
        format!("file://{}", self.folder.join(name).display())
    }

    fn open(&mut self, name: &str, text: &str) -> String {
        std::fs::write(self.folder.join(name), text).expect("a file");
        let uri = self.uri(name);
        let document = json!({ "uri": uri, "languageId": "eng", "version": 1, "text": text });
        self.tell("textDocument/didOpen", &json!({ "textDocument": document }));
        uri
    }

    fn change(&mut self, uri: &str, text: &str) {
        let document = json!({ "uri": uri, "version": 2 });
        self.tell(
            "textDocument/didChange",
            &json!({ "textDocument": document, "contentChanges": [{ "text": text }] }),
        );
    }

    /// The next messages about a text.
    fn messages(&mut self, uri: &str) -> Vec<Value> {
        loop {
            let told = match self.told.is_empty() {
                true => self.receive(),
                false => self.told.remove(0),
            };
            if told["method"] == "textDocument/publishDiagnostics" && told["params"]["uri"] == uri {
                return told["params"]["diagnostics"]
                    .as_array()
                    .cloned()
                    .expect("a list");
            }
        }
    }

    /// Asks at the first place of `mark` in a text, `after` characters into it.
    fn at(&mut self, method: &str, uri: &str, text: &str, mark: &str, after: usize) -> Value {
        let byte = text.find(mark).unwrap_or_else(|| panic!("no {mark}")) + after;
        let line = text[..byte].matches('\n').count();
        let character = byte - text[..byte].rfind('\n').map_or(0, |end| end + 1);
        let position = json!({ "line": line, "character": character });
        self.ask(
            method,
            &json!({ "textDocument": { "uri": uri }, "position": position }),
        )
    }

    /// The labels that come next in a text with `mark` at the place.
    fn labels(&mut self, uri: &str, text: &str, mark: &str) -> Vec<String> {
        let found = self.at("textDocument/completion", uri, text, mark, mark.len());
        let items = found["items"].as_array().expect("a list");
        items
            .iter()
            .map(|item| item["label"].as_str().expect("a label").to_owned())
            .collect()
    }

    fn end(mut self) {
        self.ask("shutdown", &Value::Null);
        self.tell("exit", &Value::Null);
        drop(self.input.take());
        let begin = Instant::now();
        loop {
            if let Some(status) = self.child.try_wait().expect("a process") {
                assert!(status.success(), "{status}");
                break;
            }
            assert!(
                begin.elapsed() < Duration::from_secs(20),
                "the server does not end"
            );
            std::thread::sleep(Duration::from_millis(10));
        }
    }
}

impl Drop for Editor {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

#[test]
fn messages_follow_the_text() {
    let mut editor = Editor::start("messages");
    let uri = editor.open("swing.eng", SWING);
    assert_eq!(editor.messages(&uri), Vec::<Value>::new());

    // an unknown unit, with the change that mends it
    let wrong = SWING.replace("400 mm", "400 mn");
    editor.change(&uri, &wrong);
    let found = editor.messages(&uri);
    let message = found.first().expect("a message");
    assert_eq!(
        (&message["severity"], &message["source"]),
        (&json!(1), &json!("eng"))
    );
    assert_eq!(
        message["range"]["start"],
        json!({ "line": 5, "character": 31 })
    );
    let range = &message["range"];
    let context =
        json!({ "textDocument": { "uri": uri }, "range": range, "context": { "diagnostics": [] } });
    let actions = editor.ask("textDocument/codeAction", &context);
    let edit = &actions[0]["edit"]["changes"][&uri][0];
    assert_eq!(edit["newText"], "mm", "{actions}");
    assert_eq!(
        edit["range"]["start"],
        json!({ "line": 5, "character": 31 })
    );

    editor.change(&uri, SWING);
    assert_eq!(editor.messages(&uri), Vec::<Value>::new());
    editor.end();
}

/// A chain whose assembly takes a second or more.
fn chain(links: usize) -> String {
    format!(
        "use std.joints.Revolute
model Chain {{
    gravity = [0, -9.81, 0] m/s^2
    body link[i in 1..{links}] {{
        mass = 1 kg
        inertia = [1, 1, 1] g*m^2
        marker left = [-50, 0, 0] mm
        marker right = [50, 0, 0] mm
    }}
    joint first = Revolute(link[1].left, ground)
    joint next[i in 2..{links}] = Revolute(link[i].left, link[i - 1].right)
    output end = dot(link[{links}].right.origin, ground.y) as mm
}}
analysis fall = transient(Chain(), duration: 1 ms)
"
    )
}

#[test]
fn answers_do_not_wait_for_an_assembly() {
    let mut editor = Editor::start("waiting");
    let uri = editor.open("swing.eng", SWING);
    assert!(editor.messages(&uri).is_empty());
    let long = chain(400);
    let slow = editor.open("chain.eng", &long);
    std::thread::sleep(Duration::from_millis(200));
    let hover = editor.at("textDocument/hover", &uri, SWING, "length: Length", 2);
    assert!(!hover.is_null());
    assert_eq!(editor.told, Vec::<Value>::new(), "the assembly has ended");
    // typing goes on, and its findings are told before those of the assembly, which are about an earlier text
    editor.change(&slow, &long.replace("1 ms", "1 mss"));
    assert!(!editor.messages(&slow).is_empty());
    editor.change(&slow, &long);
    assert!(editor.messages(&slow).is_empty());
    // the end waits for no assembly either
    editor.end();
}

#[test]
fn unsaved_texts_of_other_files_count() {
    let mut editor = Editor::start("unsaved");
    let part = "fn twice(x: Length) -> Length = 2*x\n";
    let used = SWING
        .replace("use std", "use lengths.twice\nuse std")
        .replace("= 400 mm in (10 mm, 2 m)", "= twice(200 mm)");
    let part_uri = editor.open("lengths.eng", part);
    assert!(editor.messages(&part_uri).is_empty());
    let uri = editor.open("swing.eng", &used);
    assert_eq!(editor.messages(&uri), Vec::<Value>::new());
    // the name changes in the editor alone; a save of any file makes a check of all
    editor.change(&part_uri, "fn thrice(x: Length) -> Length = 3*x\n");
    editor.tell(
        "textDocument/didSave",
        &json!({ "textDocument": { "uri": uri } }),
    );
    let message = editor.messages(&uri).first().cloned().expect("a message");
    assert!(
        message["message"]
            .as_str()
            .expect("a text")
            .contains("twice"),
        "{message}"
    );
    let place = editor.at("textDocument/definition", &uri, &used, "twice", 1);
    assert_eq!(place, Value::Null, "the definition is gone");
    editor.end();
}

#[test]
fn names_have_definitions_and_words() {
    let mut editor = Editor::start("names");
    let uri = editor.open("swing.eng", SWING);
    editor.messages(&uri);
    let place = |editor: &mut Editor, mark: &str, after: usize| {
        let found = editor.at("textDocument/definition", &uri, SWING, mark, after);
        let own = found["uri"] == uri.as_str();
        (
            own,
            found["range"]["start"]["line"].as_u64(),
            found["uri"].as_str().unwrap_or("").to_owned(),
        )
    };
    // a marker of a body, a parameter, the model of an analysis
    assert_eq!(place(&mut editor, "bob.top, ", 5).1, Some(11));
    assert_eq!(place(&mut editor, "*length", 2).1, Some(5));
    assert_eq!(place(&mut editor, "Swing()", 1).1, Some(3));
    // a class of the library: a copy of its text
    for mark in ["Revolute(", "Revolute\n"] {
        let (own, line, library) = place(&mut editor, mark, 1);
        assert!(!own && library.ends_with("std/joints.eng"), "{library}");
        let path = library.strip_prefix("file://").expect("a file");
        let text = std::fs::read_to_string(path).expect("a copy");
        let line = usize::try_from(line.expect("a line")).expect("small");
        assert!(
            text.lines()
                .nth(line)
                .expect("a line")
                .starts_with("joint Revolute(")
        );
    }

    let words = |editor: &mut Editor, mark: &str, after: usize| {
        let found = editor.at("textDocument/hover", &uri, SWING, mark, after);
        found["contents"]["value"].as_str().unwrap_or("").to_owned()
    };
    let length = words(&mut editor, "*length", 3);
    for part in [
        "param length: Length",
        "From the pivot to the bob.",
        "400 mm",
    ] {
        assert!(length.contains(part), "{part} in\n{length}");
    }
    assert!(words(&mut editor, "Revolute(", 2).contains("joint Revolute("));
    assert!(words(&mut editor, "mm in", 1).contains("unit mm"));
    assert!(words(&mut editor, "dot(", 1).contains("dot("));
    assert!(words(&mut editor, "transient", 1).contains("duration"));
    assert!(words(&mut editor, "pin.angle", 1).contains("Revolute"));
    assert_eq!(words(&mut editor, "1.2 kg", 1), "");
    editor.end();
}

#[test]
fn words_come_next() {
    let mut editor = Editor::start("next");
    let uri = editor.open("swing.eng", SWING);
    editor.messages(&uri);
    // half a line is a text with mistakes; its answers come from the rest
    let typed = |editor: &mut Editor, line: &str| {
        let text = SWING.replace("    joint pin", &format!("    {line}\n    joint pin"));
        editor.change(&uri, &text);
        editor.labels(&uri, &text, line)
    };
    let has = |labels: &[String], wanted: &[&str]| {
        for word in wanted {
            assert!(
                labels.iter().any(|label| label == word),
                "{word} in {labels:?}"
            );
        }
    };
    has(&typed(&mut editor, "start bob."), &["top", "origin"]);
    has(&typed(&mut editor, "let a = bob.top."), &["velocity", "z"]);
    has(
        &typed(&mut editor, "joint more = Revolute("),
        &["a:", "b:", "pivot", "bob"],
    );
    let units = typed(&mut editor, "param width: Length = 3 ");
    has(&units, &["mm", "kN"]);
    assert!(
        !units.iter().any(|label| label == "bob"),
        "units alone: {units:?}"
    );
    has(&typed(&mut editor, "le"), &["let", "length", "dot"]);
    assert!(typed(&mut editor, "// bob.").is_empty());
    let text = format!("use std.\n{SWING}");
    editor.change(&uri, &text);
    has(&editor.labels(&uri, &text, "use std."), &["joints", "oils"]);
    let text = format!("use std.drives.\n{SWING}");
    editor.change(&uri, &text);
    has(
        &editor.labels(&uri, &text, "use std.drives."),
        &["ConstantSpeed"],
    );

    // the units of the due dimension come first
    let text = SWING.replace("400 mm in", "400 ");
    editor.change(&uri, &text);
    let found = editor.at("textDocument/completion", &uri, &text, "400 ", 4);
    let order = |label: &str| {
        let items = found["items"].as_array().expect("a list");
        let item = items
            .iter()
            .find(|item| item["label"] == label)
            .expect("a unit");
        item["sortText"].as_str().expect("an order").to_owned()
    };
    assert!(order("mm") < order("kN"));
    editor.end();
}

#[test]
fn a_text_has_an_outline_and_a_form() {
    let mut editor = Editor::start("outline");
    let messy = SWING.replace("    body bob {", "  body   bob{");
    let uri = editor.open("swing.eng", &messy);
    let document = json!({ "textDocument": { "uri": uri }, "options": { "tabSize": 8 } });
    let symbols = editor.ask("textDocument/documentSymbol", &document);
    let names = |list: &Value| -> Vec<String> {
        let list = list.as_array().expect("a list");
        list.iter()
            .map(|one| one["name"].as_str().expect("a name").to_owned())
            .collect()
    };
    assert_eq!(names(&symbols), ["Swing", "swing"]);
    assert_eq!(
        names(&symbols[0]["children"]),
        ["length", "pivot", "bob", "pin", "height"]
    );
    assert_eq!(names(&symbols[0]["children"][2]["children"]), ["top"]);

    let edits = editor.ask("textDocument/formatting", &document);
    assert_eq!(edits[0]["newText"], SWING);
    assert_eq!(edits[0]["range"]["end"]["line"], SWING.lines().count());
    // neither a text in its form nor one with mistakes is changed
    for text in [SWING.to_owned(), SWING.replace("= Revolute(", "= = (")] {
        editor.change(&uri, &text);
        assert_eq!(editor.ask("textDocument/formatting", &document), json!([]));
    }
    editor.end();
}

#[test]
fn wrong_requests_and_half_texts_do_not_end_the_server() {
    let mut editor = Editor::start("wrong");
    let uri = editor.open("swing.eng", SWING);
    let code = |response: &Value| response["error"]["code"].clone();
    assert_eq!(
        code(&editor.response("textDocument/nothing", &json!({}))),
        -32601
    );
    for params in [
        Value::Null,
        json!([1, 2]),
        json!({ "textDocument": 3 }),
        json!({ "position": "x" }),
    ] {
        for method in [
            "hover",
            "definition",
            "completion",
            "documentSymbol",
            "formatting",
            "codeAction",
        ] {
            let response = editor.response(&format!("textDocument/{method}"), &params);
            assert!(response["error"].is_null(), "{response}");
        }
    }
    editor.tell(
        "textDocument/didChange",
        &json!({ "textDocument": { "uri": uri }, "contentChanges": 3 }),
    );
    editor.tell("$/unheard", &Value::Null);
    editor.tell(
        "textDocument/didClose",
        &json!({ "textDocument": { "uri": "file:///no/where.eng" } }),
    );

    // every beginning of a line of the text, asked for everything at its end
    let cuts: Vec<usize> = (0..SWING.len())
        .filter(|cut| SWING.is_char_boundary(*cut))
        .collect();
    for cut in cuts.into_iter().step_by(7) {
        let text = &SWING[..cut];
        editor.change(&uri, text);
        let line = text.matches('\n').count();
        let character = cut - text.rfind('\n').map_or(0, |end| end + 1);
        let position = json!({ "line": line, "character": character });
        let params = json!({ "textDocument": { "uri": uri }, "position": position, "range": { "start": position, "end": position } });
        for method in [
            "hover",
            "definition",
            "completion",
            "documentSymbol",
            "formatting",
            "codeAction",
        ] {
            editor.ask(&format!("textDocument/{method}"), &params);
        }
    }
    editor.told.clear();
    editor.change(&uri, &SWING.replace("angle = 30", "angel = 30"));
    loop {
        let found = editor.messages(&uri);
        // messages about the texts before may still come
        if found.iter().any(|message| {
            message["message"]
                .as_str()
                .is_some_and(|text| text.contains("angel"))
        }) {
            break;
        }
    }
    // a text that is no file
    let document = json!({ "uri": "untitled:Untitled-1", "languageId": "eng", "version": 1, "text": "let a = 3 mn\n" });
    editor.tell("textDocument/didOpen", &json!({ "textDocument": document }));
    assert!(!editor.messages("untitled:Untitled-1").is_empty());
    editor.end();
}
