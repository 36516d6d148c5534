//! Answers to the requests of a client.

use super::document::{self, Document};
use super::index::Index;
use super::references::{Home, home};
use super::{Server, completion, forms, guarded, hints, hover, messages, place, symbols, tokens};
use lsp_server::{ErrorCode, Request, RequestId, Response};
use serde_json::{Value, json};
use std::path::PathBuf;

/// The methods of the server, after `textDocument/`.
const METHODS: [&str; 13] = [
    "hover",
    "definition",
    "references",
    "prepareRename",
    "rename",
    "completion",
    "documentSymbol",
    "formatting",
    "rangeFormatting",
    "codeAction",
    "codeLens",
    "inlayHint",
    "semanticTokens/full",
];

impl Server<'_> {
    pub(super) fn answer(&self, request: Request) {
        let Request { id, method, params } = request;
        let response = match guarded(|| self.answered(&method, &params)) {
            Ok(Some(Ok(value))) => Response::new_ok(id, value),
            Ok(Some(Err(words))) => refusal(id, ErrorCode::RequestFailed, words),
            Ok(None) => refusal(
                id,
                ErrorCode::MethodNotFound,
                format!("there is no {method}"),
            ),
            Err(words) => refusal(id, ErrorCode::InternalError, words),
        };
        self.send(response);
    }

    /// The answer to a request, null for an empty one, or the reason of a refusal. `None` for a method that the server
    /// does not have.
    fn answered(&self, method: &str, params: &Value) -> Option<Result<Value, String>> {
        let name = method.strip_prefix("textDocument/")?;
        if !METHODS.contains(&name) {
            return None;
        }
        let uri = params["textDocument"]["uri"].as_str().unwrap_or("");
        let Some(open) = self.documents.get(uri) else {
            return Some(Ok(Value::Null));
        };
        let document = &open.document;
        let (program, typed) = (open.program.as_ref(), open.typed.as_deref());
        let place = document.byte(&params["position"]);
        let answer = match name {
            "documentSymbol" => symbols::symbols(document),
            "formatting" => forms::formed(document),
            "rangeFormatting" => forms::formed_range(document, &params["range"]),
            "codeAction" => messages::actions(&open.fixes, &params["range"], uri),
            "codeLens" => hints::lenses(document),
            "inlayHint" => hints::hints(document, typed, &params["range"]),
            "semanticTokens/full" => tokens::tokens(&self.index(document), document),
            "hover" => {
                let index = self.index(document);
                hover::hover(&index, document, program, place).unwrap_or(Value::Null)
            }
            "definition" => self.definition(document, place).unwrap_or(Value::Null),
            "references" => {
                let with = params["context"]["includeDeclaration"].as_bool();
                self.references(document, place, with.unwrap_or(true))
            }
            "prepareRename" => return Some(self.renamable(document, place)),
            "rename" => {
                let name = params["newName"].as_str().unwrap_or("");
                return Some(self.renamed(document, place, name));
            }
            _ => {
                let known = completion::Known {
                    program,
                    channels: &open.channels,
                    typed,
                };
                completion::completion(&self.index(document), document, known, place)
            }
        };
        Some(Ok(answer))
    }

    /// The definitions that a document sees.
    pub(super) fn index(&self, document: &Document) -> Index<'_> {
        let (sources, _) = self.sources(document);
        Index::new(&self.library, document, &sources)
    }

    fn definition(&self, document: &Document, place: usize) -> Option<Value> {
        let index = self.index(document);
        let path = place::path_at(&document.text, place)?;
        let found = index.resolve(&path.names, place)?;
        let module = index.module(found.module)?;
        let span = found.name_span();
        let range = document::range(&module.text, span.start as usize, span.end as usize);
        let uri = match home(&index, document, found.module)? {
            _ if found.module == index.own() => document.uri.clone(),
            Home::Text(uri) => uri,
            Home::File(path) => document::uri(&path),
            Home::Library(path) => document::uri(&self.library_file(&path, &module.text)?),
        };
        Some(json!({ "uri": uri, "range": range }))
    }

    /// A file with a text of the library.
    fn library_file(&self, path: &str, text: &str) -> Option<PathBuf> {
        let folder = self.folders.library.as_ref()?;
        let file = folder.join(format!("{}.eng", path.replace('.', "/")));
        if std::fs::read_to_string(&file).ok().as_deref() != Some(text) {
            crate::results::replace_file(&file, |file| {
                std::io::Write::write_all(file, text.as_bytes())
            })
            .ok()?;
        }
        Some(file)
    }
}

fn refusal(id: RequestId, code: ErrorCode, words: String) -> Response {
    Response::new_err(id, code as i32, words)
}
