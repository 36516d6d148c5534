//! The functions of the page, called as the page calls them, in one program.

#![expect(unsafe_code, reason = "calls of the functions for the page")]

use eng_playground::edge;
use serde_json::{Value, json};

const STEPS: &str = include_str!("steps.eng");
const FAULTY: &str = include_str!("faulty.eng");
const IDLE: &str = include_str!("idle.eng");

/// An answer, read as the page reads it.
struct Answer {
    text: Value,
    numbers: Vec<f64>,
    /// The page about a run, before the answer is released.
    page: String,
}

fn text_of(answer: *const edge::Answer) -> String {
    // SAFETY: the answer is not released, and its text has as many bytes
    let bytes = unsafe {
        std::slice::from_raw_parts(
            edge::playground_text(answer),
            edge::playground_text_length(answer),
        )
    };
    String::from_utf8(bytes.to_vec()).expect("UTF-8")
}

fn called(
    function: unsafe extern "C" fn(*const u8, usize) -> *mut edge::Answer,
    request: &Value,
) -> Answer {
    let bytes = request.to_string().into_bytes();
    let room = edge::playground_allocate(bytes.len());
    // SAFETY: the room has as many bytes; room and answers are released once, below
    unsafe {
        room.copy_from_nonoverlapping(bytes.as_ptr(), bytes.len());
        let answer = function(room, bytes.len());
        edge::playground_release(room, bytes.len());
        let count = edge::playground_numbers_length(answer);
        let numbers = std::slice::from_raw_parts(edge::playground_numbers(answer), count).to_vec();
        let page = edge::playground_page(answer);
        let found = Answer {
            text: serde_json::from_str(&text_of(answer)).expect("JSON"),
            numbers,
            page: text_of(page),
        };
        edge::playground_release_answer(page);
        edge::playground_release_answer(answer);
        found
    }
}

fn check(name: &str, text: &str) -> Value {
    called(
        edge::playground_check,
        &json!({ "name": name, "text": text }),
    )
    .text
}

/// The document of `eng check --format json`, by the library.
fn by_library(name: &str, text: &str) -> Value {
    let checked = eng::check(&eng::Sources::from_text(name, text), name);
    let report = checked.report();
    let mut messages = report.diagnostics().clone();
    if let Some(program) = checked.program() {
        messages.extend(program.assemble().expect("memory").diagnostics);
    }
    let text = eng::render::json(&messages, report.texts());
    serde_json::from_str(&text).expect("JSON")
}

#[test]
fn messages_are_those_of_the_command() {
    for (text, errors, warnings) in [(FAULTY, 4, 0), (IDLE, 0, 1), (STEPS, 0, 0)] {
        let found = check("model.eng", text);
        let due = by_library("model.eng", text);
        assert_eq!(found["messages"], due);
        assert_eq!(due["errors"], errors, "{due}");
        assert_eq!(due["warnings"], warnings, "{due}");
    }
    let found = check("steps.eng", STEPS);
    assert_eq!(found["analyses"], json!(["steps"]));
}

#[test]
fn a_run_has_the_numbers_of_the_library() {
    let request = json!({ "name": "steps.eng", "text": STEPS });
    let Answer {
        text,
        numbers,
        page,
    } = called(edge::playground_run, &request);
    assert_eq!(text["stopped"], Value::Null);
    let analysis = &text["analyses"][0];
    assert_eq!(analysis["name"], "steps");
    assert_eq!(analysis["failure"], Value::Null);
    assert!(
        analysis["figures"][0]["svg"]
            .as_str()
            .expect("a figure")
            .starts_with("<svg")
    );
    let sources = eng::Sources::from_text("steps.eng", STEPS);
    let program = eng::check(&sources, "steps.eng")
        .into_program()
        .expect("a program");
    let run = program
        .analysis("steps")
        .expect("an analysis")
        .run(&mut |_| {});
    let due = run.expect("a run").results;
    assert_eq!(due.samples(), 1001);
    let columns = analysis["columns"].as_array().expect("columns");
    assert_eq!(columns.len(), due.columns().len());
    for (column, due) in columns.iter().zip(due.columns()) {
        assert_eq!(column["path"], due.path);
        assert_eq!(column["unit"], due.display.symbol);
        let first = column["first"].as_u64().expect("a place") as usize;
        let count = column["count"].as_u64().expect("a number") as usize;
        let bits = |numbers: &[f64]| numbers.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&numbers[first..first + count]), bits(&due.shown()));
    }
    assert!(page.starts_with("<!"), "{}", &page[..page.len().min(200)]);
}

#[test]
fn reports_are_evaluated() {
    let text = include_str!("../../examples/swing/swing.eng");
    let request = json!({ "name": "swing.eng", "text": text });
    let found = called(edge::playground_run, &request).text;
    let sweep = found["sweeps"][0].as_str().expect("a table");
    assert!(sweep.starts_with("release\n"), "{sweep}");
    let report = &found["reports"][0];
    assert_eq!(report["title"], "A swing");
    let entries = report["entries"].as_array().expect("entries");
    let kinds: Vec<_> = entries.iter().map(|entry| entry["kind"].as_str()).collect();
    let (figure, value) = (Some("figure"), Some("value"));
    assert_eq!(kinds, [figure, figure, value, value, value]);
    assert!(
        entries[0]["svg"]
            .as_str()
            .expect("a figure")
            .starts_with("<svg")
    );
    // √(2 m g l (1 - cos φ)/(m + J/l²)) at the lowest place, by energy; samples are 5 ms apart
    let (mass, length, gravity, inertia): (f64, f64, f64, f64) = (30.0, 2.0, 9.81, 1.5);
    let numbers = entries[3]["numbers"].as_array().expect("numbers");
    assert_eq!(numbers.len(), 3);
    for (number, begin) in numbers.iter().zip([10.0_f64, 60.0, 120.0]) {
        let height = length * (1.0 - begin.to_radians().cos());
        let due = (2.0 * mass * gravity * height / (mass + inertia / (length * length))).sqrt();
        let shown = number["shown"].as_str().expect("a text");
        let speed: f64 = shown
            .strip_suffix(" m/s")
            .expect("a speed")
            .parse()
            .expect("a number");
        assert!((speed / due - 1.0).abs() < 1e-3, "{shown}, {due}");
    }
}

#[test]
fn a_page_ends_a_run() {
    let request = eng_playground::request::Request {
        name: "steps.eng".to_owned(),
        text: STEPS.to_owned(),
        files: Default::default(),
    };
    let ran = eng_playground::run::run(&request, &mut |progress| progress.fraction < 0.5);
    let found: Value = serde_json::from_str(&ran.text).expect("JSON");
    let stopped = found["stopped"].as_str().expect("a reason");
    assert!(stopped.starts_with("stopped at 50.0 %"), "{stopped}");
    let analysis = &found["analyses"][0];
    assert_eq!(analysis["failure"], "stopped by the playground");
    let samples = analysis["columns"][0]["count"].as_u64().expect("a number");
    assert!((500..=502).contains(&samples), "{samples}");
    // no message of the runtime about options of the command
    assert_eq!(found["messages"]["errors"], 0);
}

#[test]
fn files_are_those_of_the_request() {
    let text = "table gas(turn: Angle) -> Pressure = csv(\"gas.csv\", columns: [\"turn [deg]\", \"p [bar]\"], periodic: 360 deg)
model Gas { output pressure = gas(1 rad) as bar }
";
    let found = check("model.eng", text);
    assert_eq!(found["messages"]["errors"], 1, "{found}");
    let message = found["messages"]["diagnostics"][0].to_string();
    assert!(
        message.contains("gas.csv") && message.contains("the playground has no files of yours"),
        "{message}"
    );
    let with = json!({ "name": "model.eng", "text": text,
        "files": { "gas.csv": "turn [deg],p [bar]\n0,1\n90,2\n180,3\n270,2\n360,1\n" } });
    let found = called(edge::playground_check, &with).text;
    assert_eq!(found["messages"]["errors"], 0, "{found}");
}

#[test]
fn wrong_requests_are_refused() {
    for (request, reason) in [
        (json!({ "name": "model.eng" }), "missing field `text`"),
        (
            json!({ "name": "a", "text": "", "steps": 3 }),
            "unknown field `steps`",
        ),
    ] {
        let found = called(edge::playground_check, &request).text;
        let refused = found["refused"].as_str().expect("a reason");
        assert!(refused.contains(reason), "{refused}");
        assert_eq!(called(edge::playground_run, &request).text, found);
    }
    let found = called(
        edge::playground_run,
        &json!({ "name": "a.eng", "text": "model A { }" }),
    );
    let refused = found.text["refused"].as_str().expect("a reason");
    assert!(refused.contains("no analysis"), "{refused}");
    assert!(found.page.contains("nothing has run"), "{}", found.page);
}
