//! The check of a text, with the messages and facts of `eng check`.

use crate::request::{Request, refusal};
use eng::render::{Document, document};
use eng::{Checked, Program};
use eng_grammar::Diagnostics;
use serde::Serialize;

/// The answer to a check.
#[derive(Debug, Serialize)]
struct Answer<'a> {
    /// The document of `eng check --format json`.
    messages: Document<'a>,
    /// Lines about models and analyses.
    facts: &'a [String],
    /// Names of the analyses, in the order of the text; none if there is an error.
    analyses: Vec<&'a str>,
}

/// A text with all messages of its check.
pub(crate) struct Found {
    checked: Checked,
    pub messages: Diagnostics,
    facts: Vec<String>,
}

impl Found {
    /// Checks a text and assembles its models, as `eng check` does.
    pub fn new(request: &Request) -> Result<Found, String> {
        let checked = eng::check(&request.sources(), &request.name);
        let mut messages = checked.report().diagnostics().clone();
        let mut facts = Vec::new();
        if let Some(program) = checked.program() {
            let assembled = program
                .assemble()
                .map_err(|error| refusal(&error.to_string()))?;
            messages.extend(assembled.diagnostics);
            facts = assembled.facts;
        }
        Ok(Found {
            checked,
            messages,
            facts,
        })
    }

    /// The messages of the text alone, and the texts that all messages point into.
    pub fn report(&self) -> eng::Report {
        self.checked.report()
    }

    /// The program, if it can run.
    pub fn program(&self) -> Option<&Program> {
        self.checked
            .program()
            .filter(|_| !self.messages.has_errors())
    }
}

/// Checks the text of a request. The answer is JSON.
pub fn check(request: &Request) -> String {
    let found = match Found::new(request) {
        Ok(found) => found,
        Err(refused) => return refused,
    };
    let report = found.report();
    let program = found.checked.program();
    let answer = Answer {
        messages: document(&found.messages, report.texts()),
        facts: &found.facts,
        analyses: program.map_or_else(Vec::new, Program::analyses),
    };
    serde_json::to_string(&answer).unwrap_or_else(|error| refusal(&error.to_string()))
}
