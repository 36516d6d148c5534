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
    /// The number of the last text.
    version: i64,
    /// Messages that came while an answer was due.
    told: Vec<Value>,
}

impl Editor {
    fn start(name: &str) -> Editor {
        let mut folder = Temporary::new(&format!("lsp-{name}"));
        folder.0 = folder.canonicalize().expect("a folder");
        let mut child = Command::new(env!("CARGO_BIN_EXE_eng"))
            .args(["lsp", "--stdio"])
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
            version: 1,
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
        self.change_by(uri, &json!([{ "text": text }]));
    }

    fn change_by(&mut self, uri: &str, changes: &Value) {
        self.version += 1;
        let document = json!({ "uri": uri, "version": self.version });
        self.tell(
            "textDocument/didChange",
            &json!({ "textDocument": document, "contentChanges": changes }),
        );
    }

    /// The next messages about a text, with its number.
    fn versioned(&mut self, uri: &str) -> (i64, Vec<Value>) {
        loop {
            let told = match self.told.is_empty() {
                true => self.receive(),
                false => self.told.remove(0),
            };
            let about = &told["params"];
            if told["method"] == "textDocument/publishDiagnostics" && about["uri"] == uri {
                let version = about["version"].as_i64().expect("a number");
                let list = about["diagnostics"].as_array().cloned();
                return (version, list.expect("a list"));
            }
        }
    }

    /// The next messages about a text.
    fn messages(&mut self, uri: &str) -> Vec<Value> {
        self.versioned(uri).1
    }

    /// Waits until the model of a text is known: the first place of `mark` has numbers.
    fn settled(&mut self, uri: &str, text: &str, mark: &str) {
        for _ in 0..300 {
            let hover = self.at("textDocument/hover", uri, text, mark, 1);
            let words = hover["contents"]["value"].as_str().unwrap_or("");
            if words.contains("```text") {
                return;
            }
            std::thread::sleep(Duration::from_millis(100));
        }
        panic!("the model does not come");
    }

    /// Asks about a text as a whole.
    fn whole(&mut self, method: &str, uri: &str) -> Value {
        let range = json!({ "start": place("", 0), "end": { "line": 9999, "character": 0 } });
        self.ask(
            &format!("textDocument/{method}"),
            &json!({ "textDocument": { "uri": uri }, "range": range }),
        )
    }

    /// Asks at the first place of `mark` in a text, `after` characters into it.
    fn at(&mut self, method: &str, uri: &str, text: &str, mark: &str, after: usize) -> Value {
        let position = place(text, of(text, mark) + after);
        self.ask(
            method,
            &json!({ "textDocument": { "uri": uri }, "position": position }),
        )
    }

    /// The response to another name for the one at the first place of `mark`.
    fn renamed(&mut self, uri: &str, text: &str, mark: &str, name: &str) -> Value {
        let position = place(text, of(text, mark) + 1);
        let params =
            json!({ "textDocument": { "uri": uri }, "position": position, "newName": name });
        self.response("textDocument/rename", &params)
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
                begin.elapsed() < Duration::from_secs(60),
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

/// The byte of the first place of a mark.
fn of(text: &str, mark: &str) -> usize {
    text.find(mark).unwrap_or_else(|| panic!("no {mark}"))
}

/// A position in the form of the protocol, in a text of ASCII letters.
fn place(text: &str, byte: usize) -> Value {
    let line = text[..byte].matches('\n').count();
    let character = byte - text[..byte].rfind('\n').map_or(0, |end| end + 1);
    json!({ "line": line, "character": character })
}

/// The bytes of a range in a text of ASCII letters.
fn bytes(text: &str, range: &Value) -> std::ops::Range<usize> {
    let byte = |position: &Value| {
        let number = |name: &str| position[name].as_u64().expect("a number") as usize;
        let lines = text.split_inclusive('\n').take(number("line"));
        lines.map(str::len).sum::<usize>() + number("character")
    };
    byte(&range["start"])..byte(&range["end"])
}

/// A text after the edits of the server.
fn edited(text: &str, edits: &Value) -> String {
    let mut text = text.to_owned();
    let mut edits = edits.as_array().expect("edits").clone();
    edits.sort_by_key(|edit| std::cmp::Reverse(bytes(&text, &edit["range"]).start));
    for edit in &edits {
        let range = bytes(&text, &edit["range"]);
        text.replace_range(range, edit["newText"].as_str().expect("a text"));
    }
    text
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
    // names and types do not wait for the assembly
    assert!(editor.messages(&slow).is_empty());
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

    // the units of the due dimension come first: of a line, of an argument
    for (line, mark) in [
        (SWING.replace("400 mm in", "400 "), "400 "),
        (SWING.replace("Swing(),", "Swing(length: 3 ,"), "length: 3 "),
        (SWING.replace("Swing(),", "Swing(3 ,"), "Swing(3 "),
    ] {
        editor.change(&uri, &line);
        let found = editor.at("textDocument/completion", &uri, &line, mark, mark.len());
        let order = |label: &str| {
            let items = found["items"].as_array().expect("a list");
            let item = items
                .iter()
                .find(|item| item["label"] == label)
                .expect("a unit");
            item["sortText"].as_str().expect("an order").to_owned()
        };
        assert!(order("mm") < order("kN"), "{mark}");
    }
    editor.end();
}

/// The names after a dot are those that can be read there, and no others.
#[test]
fn members_are_those_that_can_be_read() {
    let mut editor = Editor::start("members");
    let uri = editor.open("swing.eng", SWING);
    editor.messages(&uri);
    editor.settled(&uri, SWING, "length: Length");
    let report = "report numbers {\n    value here = ";
    let typed = |editor: &mut Editor, mark: &str| {
        let text = match mark.starts_with("swing") {
            true => format!("{SWING}{report}{mark}\n}}\n"),
            false => SWING.replace(
                "    start pin",
                &format!("    let it = {mark}\n    start pin"),
            ),
        };
        editor.change(&uri, &text);
        let line = format!("= {mark}");
        let mut labels = editor.labels(&uri, &text, &line);
        labels.sort();
        labels
    };
    let marker = [
        "acceleration",
        "angular_acceleration",
        "angular_velocity",
        "origin",
        "velocity",
        "x",
        "y",
        "z",
    ];
    let cases: [(&str, &[&str]); 14] = [
        ("pin.", &["a", "angle", "b", "force", "speed", "torque"]),
        ("pin.force.", &["x", "y", "z"]),
        ("pin.angle.", &[]),
        ("pin.a.", &marker),
        ("pin.a.origin.", &[]),
        ("bob.", &["mass", "origin", "top"]),
        ("bob.origin.", &marker),
        ("bob.mass.", &[]),
        ("ground.", &marker),
        ("ground.origin.", &[]),
        ("Swing.", &[]),
        ("swing.pin.", &["angle", "force", "speed", "torque"]),
        ("swing.pin.torque.", &["x", "y", "z"]),
        ("swing.bob.", &[]),
    ];
    for (mark, names) in cases {
        assert_eq!(typed(&mut editor, mark), names, "{mark}");
    }
    let all = typed(&mut editor, "swing.");
    for (name, there) in [
        ("time", true),
        ("height", true),
        ("pin", true),
        ("energy", true),
        ("length", false),
        ("pivot", false),
        ("bob", false),
    ] {
        assert_eq!(all.contains(&name.to_owned()), there, "{name} in {all:?}");
    }
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
            "references",
            "rangeFormatting",
            "codeLens",
            "inlayHint",
            "semanticTokens/full",
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
            "references",
            "rangeFormatting",
            "codeLens",
            "inlayHint",
            "semanticTokens/full",
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

/// Typing of a line letter by letter: each text has its messages, and none has more than a check of its names and one of
/// its models give.
#[test]
fn a_session_of_edits_ends_with_the_messages_of_its_text() {
    let mut editor = Editor::start("session");
    let uri = editor.open("swing.eng", SWING);
    assert!(editor.messages(&uri).is_empty());
    let mut text = SWING.to_owned();
    let line = "    output turns = pin.speed as rpm\n";
    let begin = of(&text, "    start pin");
    for (at, letter) in (begin..).zip(line.chars()) {
        let here = place(&text, at);
        let range = json!({ "start": here, "end": here });
        let change = json!([{ "range": range, "text": letter.to_string() }]);
        editor.change_by(&uri, &change);
        text.insert(at, letter);
    }
    let mut counts = std::collections::BTreeMap::new();
    let last = loop {
        let (version, list) = editor.versioned(&uri);
        *counts.entry(version).or_insert(0) += 1;
        if version == editor.version {
            break list;
        }
    };
    assert_eq!(last, Vec::<Value>::new());
    assert!(counts.values().all(|count| *count <= 2), "{counts:?}");
    // two changes in one message, the second in the text after the first
    let end = place(&text, text.len());
    let start = place("", 0);
    editor.change_by(
        &uri,
        &json!([
            { "range": { "start": end, "end": end }, "text": "const  spare=1\n" },
            { "range": { "start": start, "end": start }, "text": "\n" },
        ]),
    );
    let formed = editor.whole("formatting", &uri);
    assert_eq!(formed[0]["newText"], format!("{text}const spare = 1\n"));
    editor.end();
}

/// An error of the models comes after the pause, and only a change of the list is told.
#[test]
fn models_are_checked_after_a_pause() {
    let mut editor = Editor::start("pause");
    let uri = editor.open("swing.eng", SWING);
    assert!(editor.messages(&uri).is_empty());
    let missing = SWING.replace(
        "    start pin",
        "    table lift(t: Angle) -> Length = csv(\"missing.csv\", columns: [\"t [deg]\", \"h [mm]\"])
    output rise = lift(pin.angle) as mm
    start pin",
    );
    editor.change(&uri, &missing);
    assert_eq!(editor.versioned(&uri), (2, Vec::new()));
    let (version, list) = editor.versioned(&uri);
    assert_eq!((version, list.is_empty()), (2, false));
    editor.end();
}

#[test]
fn uses_and_new_names_go_through_all_texts() {
    let mut editor = Editor::start("uses");
    let part = "/// Two.\nfn twice(x: Length) -> Length = 2*x\n";
    let used = SWING
        .replace("use std", "use lengths.twice\nuse std")
        .replace("= 400 mm in (10 mm, 2 m)", "= twice(x: 200 mm)")
        .replace("Swing()", "Swing(length: twice(100 mm))");
    let part_uri = editor.open("lengths.eng", part);
    let uri = editor.open("swing.eng", &used);
    assert!(editor.messages(&uri).is_empty());
    // a file that no editor has opened
    let other = "use lengths.twice\nconst twin = twice(x: 1 mm)\n";
    std::fs::write(editor.folder.join("other.eng"), other).expect("a file");
    let texts = [
        (part_uri.clone(), part),
        (uri.clone(), used.as_str()),
        (editor.uri("other.eng"), other),
    ];

    let found = editor.at("textDocument/references", &uri, &used, "twice(x", 1);
    let mut counts = [0; 3];
    for location in found.as_array().expect("a list") {
        let (number, (_, text)) = texts
            .iter()
            .enumerate()
            .find(|(_, (uri, _))| location["uri"] == uri.as_str())
            .expect("a known text");
        assert_eq!(&text[bytes(text, &location["range"])], "twice");
        counts[number] += 1;
    }
    assert_eq!(counts, [1, 3, 2]);

    let mut renamed = |mark: &str, after: usize, name: &str| {
        let position = place(&used, of(&used, mark) + after);
        let params =
            json!({ "textDocument": { "uri": uri }, "position": position, "newName": name });
        editor.response("textDocument/rename", &params)
    };
    // a function of another file, and its parameter, which arguments name
    for (mark, after, expected) in [
        ("twice(x", 1, ["double", "double", "double"]),
        ("x: 200", 0, ["double: Length", "double: 200", "double: 1"]),
    ] {
        let response = renamed(mark, after, "double");
        for ((uri, text), expected) in texts.iter().zip(expected) {
            let edits = &response["result"]["changes"][uri.as_str()];
            let after = edited(text, edits);
            assert!(after.contains(expected), "{response}\n{after}");
        }
    }
    // a parameter: its use, and the argument with its name
    let response = renamed("length: Length", 1, "arm");
    let changes = &response["result"]["changes"];
    assert_eq!(
        changes.as_object().map(|all| all.len()),
        Some(1),
        "{response}"
    );
    let after = edited(&used, &changes[&uri]);
    let expected = used
        .replace("param length:", "param arm:")
        .replace("*length", "*arm")
        .replace("Swing(length:", "Swing(arm:");
    assert_eq!(after, expected);
    let response = renamed("pin.angle", 1, "hinge");
    let after = edited(&used, &response["result"]["changes"][&uri]);
    let expected = used
        .replace("joint pin", "joint hinge")
        .replace("start pin", "start hinge");
    assert_eq!(after, expected);
    // a name of the library, a word, a name that is taken, no name
    for (mark, after, name, reason) in [
        ("Revolute(", 1, "Hinge", "std.joints"),
        ("length: Length", 1, "model", "cannot be a name"),
        ("length: Length", 1, "2nd", "cannot be a name"),
        ("length: Length", 1, "bob", "another meaning"),
        ("1.2 kg", 1, "mass", "no name"),
    ] {
        let response = renamed(mark, after, name);
        let words = response["error"]["message"].as_str().expect("a refusal");
        assert!(words.contains(reason), "{name}: {words}");
    }
    let prepared = editor.at("textDocument/prepareRename", &uri, &used, "*length", 2);
    assert_eq!(prepared["placeholder"], "length");
    // a text with mistakes could hide a use
    editor.change(&part_uri, "fn twice(x: Length) -> Length = = 2*x\n");
    let position = place(&used, of(&used, "twice(x") + 1);
    let params =
        json!({ "textDocument": { "uri": uri }, "position": position, "newName": "double" });
    let refused = editor.response("textDocument/rename", &params);
    assert!(refused["error"]["message"].is_string(), "{refused}");
    editor.end();
}

/// A class states the functions that its interface requires under names of its own.
#[test]
fn a_new_name_keeps_texts_without_a_use() {
    let mut editor = Editor::start("interface");
    let stop = "interface Stop {
    param a: Marker
    param b: Marker
    fn push(depth: Length) -> Force
    let depth = dot(b.origin - a.origin, b.z)
    apply force push(depth)*b.z on a against b
    output load = push(depth) as N
}
";
    let class = "use stop.Stop
force LinearStop(stiffness: Stiffness) : Stop {
    fn push(depth: Length) -> Force = stiffness*depth
}
";
    // no editor has opened the class
    std::fs::write(editor.folder.join("class.eng"), class).expect("a file");
    let uri = editor.open("stop.eng", stop);
    assert!(editor.messages(&uri).is_empty());
    for (mark, name) in [("push(depth: ", "thrust"), ("load", "stiffness")] {
        let response = editor.renamed(&uri, stop, mark, name);
        let words = response["error"]["message"].as_str().expect("a refusal");
        assert!(words.contains("class.eng"), "{name}: {words}");
    }
    let response = editor.renamed(&uri, stop, "load", "reaction");
    let after = edited(stop, &response["result"]["changes"][&uri]);
    assert_eq!(after, stop.replace("load", "reaction"), "{response}");
    editor.end();
}

#[test]
fn a_name_with_uses_that_are_not_read_is_kept() {
    let mut editor = Editor::start("many");
    let part = "fn twice(x: Length) -> Length = 2*x\n";
    let deep = "a/b/c/d/e";
    std::fs::create_dir_all(editor.folder.join(deep)).expect("a folder");
    std::fs::write(editor.folder.join(deep).join("deep.eng"), part).expect("a file");
    let text = "use a.b.c.d.e.deep.twice\nconst three = 3 mm\nconst six = twice(x: three)\n";
    let uri = editor.open("main.eng", text);
    let response = editor.renamed(&uri, text, "twice(x", "double");
    let words = response["error"]["message"].as_str().expect("a refusal");
    assert!(words.contains("4 folders below"), "{words}");
    let response = editor.renamed(&uri, text, "three", "third");
    let after = edited(text, &response["result"]["changes"][&uri]);
    assert_eq!(after, text.replace("three", "third"), "{response}");

    for number in 0..500 {
        let file = editor.folder.join(format!("other_{number}.eng"));
        std::fs::write(file, "const one = 1\n").expect("a file");
    }
    let response = editor.renamed(&uri, text, "three", "third");
    let words = response["error"]["message"].as_str().expect("a refusal");
    assert!(words.contains("more than 500 texts"), "{words}");
    let found = editor.at("textDocument/references", &uri, text, "three", 1);
    assert_eq!(found.as_array().map(Vec::len), Some(2), "{found}");
    editor.end();
}

#[test]
fn names_taken_one_by_one_hide_those_of_whole_modules() {
    let mut editor = Editor::start("precedence");
    let single = "fn scaled(x: Length) -> Length = 3*x\n";
    let whole = "const short = 1 mm\nfn scaled(x: Length) -> Length = 2*x\n";
    for (name, text) in [("whole.eng", whole), ("single.eng", single)] {
        std::fs::write(editor.folder.join(name), text).expect("a file");
    }
    let text = "use whole.*\nuse single.scaled\nconst long = scaled(x: short)\n";
    let uri = editor.open("main.eng", text);
    assert!(editor.messages(&uri).is_empty());
    let found = editor.at("textDocument/definition", &uri, text, "scaled(x", 1);
    assert_eq!(found["uri"], editor.uri("single.eng").as_str(), "{found}");
    editor.end();
}

/// An editor that sends `exit` without `shutdown` gets to know that this was no proper end.
#[test]
fn an_end_without_shutdown_is_an_error() {
    let mut editor = Editor::start("exit");
    editor.tell("exit", &Value::Null);
    drop(editor.input.take());
    let status = editor.child.wait().expect("an end");
    let mut words = String::new();
    let errors = editor.child.stderr.as_mut().expect("an error output");
    errors.read_to_string(&mut words).expect("words");
    assert!(words.contains("without `shutdown`"), "{words}");
    assert_eq!(status.code(), Some(1));
}

#[test]
fn names_have_colours_by_their_meaning() {
    let mut editor = Editor::start("colours");
    let uri = editor.open("swing.eng", SWING);
    editor.messages(&uri);
    let data = editor.whole("semanticTokens/full", &uri)["data"].clone();
    let data: Vec<usize> = serde_json::from_value(data).expect("numbers");
    let kinds = [
        "namespace",
        "type",
        "class",
        "interface",
        "struct",
        "enum",
        "enumMember",
        "function",
        "parameter",
        "variable",
        "property",
        "number",
    ];
    let lines: Vec<&str> = SWING.lines().collect();
    let (mut line, mut column) = (0, 0);
    let mut found = Vec::new();
    for token in data.chunks(5) {
        let [lines_on, columns_on, length, kind, marks] = token else {
            panic!("five numbers");
        };
        line += lines_on;
        column = match lines_on {
            0 => column + columns_on,
            _ => *columns_on,
        };
        let name = &lines[line][column..column + length];
        found.push((line, name, kinds[*kind], *marks));
    }
    // bit 0: a definition; bit 1: of the library
    for wanted in [
        (0, "std", "namespace", 0),
        (0, "Revolute", "class", 2),
        (3, "Swing", "class", 1),
        (5, "length", "parameter", 1),
        (5, "Length", "type", 2),
        (5, "mm", "number", 2),
        (8, "bob", "variable", 1),
        (11, "top", "variable", 1),
        (11, "length", "parameter", 0),
        (13, "pin", "variable", 1),
        (13, "Revolute", "class", 2),
        (13, "top", "variable", 0),
        (14, "angle", "property", 2),
        (15, "height", "property", 1),
        (15, "dot", "function", 0),
        (17, "swing", "variable", 1),
        (17, "transient", "function", 0),
        (17, "Swing", "class", 0),
    ] {
        assert!(found.contains(&wanted), "{wanted:?} in {found:?}");
    }
    editor.end();
}

#[test]
fn types_and_runs_are_shown_beside_the_text() {
    let mut editor = Editor::start("hints");
    let text = SWING.replace(
        "    joint pin",
        "    let arm = 2*length\n    let weight = bob.mass*9.81 m/s^2\n    let turn = 3 deg\n    joint pin",
    );
    let uri = editor.open("swing.eng", &text);
    editor.messages(&uri);
    let hints = editor.whole("inlayHint", &uri);
    let hints: Vec<(Value, &str)> = hints
        .as_array()
        .expect("a list")
        .iter()
        .map(|hint| {
            let label = hint["label"].as_str().expect("a label");
            (hint["position"].clone(), label)
        })
        .collect();
    let at = |mark: &str| place(&text, of(&text, mark) + mark.len());
    assert_eq!(
        hints,
        [(at("let arm"), ": Length"), (at("let weight"), ": Force")]
    );

    let lenses = editor.whole("codeLens", &uri);
    let [lens] = lenses.as_array().expect("a list").as_slice() else {
        panic!("{lenses}");
    };
    assert_eq!(
        lens["command"],
        json!({ "title": "run", "command": "eng.run", "arguments": [uri, "swing"] })
    );
    assert_eq!(&text[bytes(&text, &lens["range"])], "swing");
    editor.end();
}

#[test]
fn the_items_of_a_range_get_their_form() {
    let mut editor = Editor::start("range");
    let messy = SWING
        .replace("    body bob {", "  body   bob{")
        .replace("    marker pivot", " marker  pivot")
        .replace("        mass = ", "    mass=");
    let uri = editor.open("swing.eng", &messy);
    let mut formed = |mark: &str| {
        let here = place(&messy, of(&messy, mark) + 1);
        let params = json!({
            "textDocument": { "uri": uri }, "options": {}, "range": { "start": here, "end": here },
        });
        let edits = editor.ask("textDocument/rangeFormatting", &params);
        edited(&messy, &edits)
    };
    let pivot = messy.replace(" marker  pivot", "    marker pivot");
    assert_eq!(formed("marker  pivot"), pivot);
    let mass = messy.replace("    mass=", "        mass = ");
    assert_eq!(formed("mass="), mass);
    assert_eq!(formed("output height"), messy);
    editor.end();
}

#[test]
fn line_ends_of_windows_stay() {
    let mut editor = Editor::start("returns");
    let text = SWING.replace('\n', "\r\n");
    let uri = editor.open("swing.eng", &text);
    assert!(editor.messages(&uri).is_empty());
    assert_eq!(editor.whole("formatting", &uri), json!([]));
    let messy = text.replace("    body bob {", "  body   bob{");
    editor.change(&uri, &messy);
    let edits = editor.whole("formatting", &uri);
    assert_eq!(edited(&messy, &edits), text);
    editor.end();
}

/// A body that is no message gets an error, and the session goes on; a length that cannot be ends it in words.
#[test]
fn broken_messages_are_refused() {
    let mut editor = Editor::start("broken");
    for (body, code) in [("{ \"id\": ", -32700), ("{ \"id\": 7 }", -32600)] {
        let input = editor.input.as_mut().expect("an open input");
        write!(input, "Content-Length: {}\r\n\r\n{body}", body.len()).expect("it reads");
        input.flush().expect("it reads");
        let answer = editor.receive();
        assert_eq!(answer["error"]["code"], code, "{answer}");
        assert!(answer["id"].is_null());
    }
    let uri = editor.open("swing.eng", SWING);
    assert!(editor.messages(&uri).is_empty());
    let input = editor.input.as_mut().expect("an open input");
    write!(input, "Content-Length: 99999999999999\r\n\r\n{{}}").expect("it reads");
    drop(editor.input.take());
    let status = editor.child.wait().expect("an end");
    assert_eq!(status.code(), Some(2));
    let mut words = String::new();
    let errors = editor.child.stderr.as_mut().expect("an error output");
    errors.read_to_string(&mut words).expect("words");
    assert!(words.contains("the length 99999999999999"), "{words}");
}
