//! Any text is a program or has an error. A program assembles or has a message. A line `%%` ends the program;
//! the data file `data` follows it, so that tables and meshes are reached too.
#![no_main]

use eng::{Sources, check};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    let (program, data) = text.split_once("\n%%\n").unwrap_or((text, ""));
    let files = [("model.eng", program), ("data", data)];
    let files = files.map(|(name, content)| (name.to_owned(), content.to_owned()));
    let sources = Sources::from_texts(files);
    let checked = check(&sources, "model.eng");
    let shown = checked.report().to_string();
    match checked.program() {
        None => assert!(!shown.is_empty()),
        Some(program) => {
            // an error of assembly is a report with text; anything else is a defect of the program
            if let Err(error) = program.assemble() {
                assert!(!error.to_string().is_empty());
            }
        }
    }
});
