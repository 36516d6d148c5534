//! Requests of the page, as JSON, and answers to requests that cannot be read.

use eng::Sources;
use serde::Deserialize;
use std::collections::BTreeMap;

/// Why a file of a text is not there.
const NO_FILES: &str =
    "the playground has no files of yours; run this model with the command `eng`";

/// The text of the editor.
///
/// ```text
/// { "name": "model.eng", "text": "…", "files": { "pressure.csv": "…" } }
/// ```
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Request {
    /// The name of the text's file, for messages.
    pub name: String,
    /// The text.
    pub text: String,
    /// Texts of further files that it may read, by their names.
    #[serde(default)]
    pub files: BTreeMap<String, String>,
}

impl Request {
    /// Reads a request. The error is an answer.
    pub fn read(bytes: &[u8]) -> Result<Request, String> {
        serde_json::from_slice(bytes).map_err(|error| refusal(&error.to_string()))
    }

    /// The texts.
    pub fn sources(&self) -> Sources {
        let mut texts = self.files.clone();
        texts.insert(self.name.clone(), self.text.clone());
        Sources::from_texts(texts).with_absence(NO_FILES)
    }
}

/// The answer to a request that cannot be served, `{ "refused": "…" }`.
pub fn refusal(reason: &str) -> String {
    serde_json::json!({ "refused": reason }).to_string()
}
