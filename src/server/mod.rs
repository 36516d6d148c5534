//! A language server: messages while typing, hover, definitions, completion, symbols, forms.
//!
//! It speaks the Language Server Protocol (3.17) with full texts and places in UTF-16. A text is checked when
//! its author pauses, with the unsaved texts of all open files. When it is opened or saved, its models are
//! assembled, too, as `eng check` does. Checks have threads of their own, so that answers do not wait for
//! them; findings about an earlier text are dropped. Questions about a text that does not parse are answered
//! from the parts that do. A panic in a check or an answer does not end the server. It becomes the message of
//! an internal error.
//!
//! Requests and answers are plain JSON: the server uses some twenty of the thousand types of the protocol.

mod checks;
mod completion;
mod document;
mod hover;
mod index;
mod messages;
mod place;
mod symbols;

use crate::Program;
use crate::sources::Sources;
use checks::{Checker, Found, Job};
use crossbeam_channel::{after, never, select};
use document::Document;
use index::{Index, Library};
use lsp_server::{
    Connection, ErrorCode, Message, Notification, ProtocolError, Request, RequestId, Response,
};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// A pause in typing after which a text is checked. A choice: shorter than a thought and longer than a key.
const PAUSE: Duration = Duration::from_millis(200);

/// The folders that a server may use.
#[derive(Clone, Debug, Default)]
pub struct Folders {
    /// The folder of reduced bodies.
    pub cache: Option<PathBuf>,
    /// The folder for copies of the library's texts, which editors open at a definition.
    pub library: Option<PathBuf>,
}

/// The reason for the end of a server.
#[derive(Debug, thiserror::Error)]
pub enum ServerError {
    /// The client breaks the protocol, or the connection breaks.
    #[error("the editor broke the protocol: {0}")]
    Protocol(#[from] ProtocolError),
    /// There is no thread for checks.
    #[error("no thread for checks: {0}")]
    Thread(#[from] std::io::Error),
}

/// Serves a client until it requests the end.
///
/// # Errors
/// The client breaks the protocol of the start or of the end, the connection breaks, or there is no thread left.
pub fn serve(connection: &Connection, folders: Folders) -> Result<(), ServerError> {
    let (id, _) = connection.initialize_start()?;
    let about = json!({
        "capabilities": capabilities(),
        "serverInfo": { "name": "eng", "version": env!("CARGO_PKG_VERSION") },
    });
    connection.initialize_finish(id, about)?;
    let mut server = Server {
        connection,
        folders,
        library: Library::read(),
        documents: BTreeMap::new(),
        editions: 0,
        texts: Checker::start()?,
        assemblies: Checker::start()?,
    };
    Ok(server.run()?)
}

fn capabilities() -> Value {
    json!({
        // full texts
        "textDocumentSync": { "openClose": true, "change": 1, "save": true },
        "hoverProvider": true,
        "definitionProvider": true,
        "documentSymbolProvider": true,
        "documentFormattingProvider": true,
        "codeActionProvider": { "codeActionKinds": ["quickfix"] },
        "completionProvider": { "triggerCharacters": [".", " ", "(", "{"] },
    })
}

/// A text with the findings about it.
struct Open {
    document: Document,
    /// The number of this text among all that came.
    edition: u64,
    /// When it is to be checked, and whether its models are to be assembled.
    due: Option<(Instant, bool)>,
    /// The number of the text whose models were last assembled.
    assembled: Option<u64>,
    /// The last program without errors.
    program: Option<Program>,
    /// The changes that its messages propose: range, title, new text.
    fixes: Vec<messages::Change>,
}

struct Server<'c> {
    connection: &'c Connection,
    folders: Folders,
    library: Library,
    documents: BTreeMap<String, Open>,
    /// The number of texts that came.
    editions: u64,
    /// Checks while typing.
    texts: Checker,
    /// Checks that assemble models, too: reading a mesh may take seconds, in which the user
    /// continues to type.
    assemblies: Checker,
}

/// The result of a piece of work, or the words of its panic.
fn guarded<T>(work: impl FnOnce() -> T) -> Result<T, String> {
    // the next check makes everything again that a panic could leave half-changed
    catch_unwind(AssertUnwindSafe(work)).map_err(|cause| {
        let words = cause.downcast_ref::<String>().map(String::as_str);
        let words = words.or_else(|| cause.downcast_ref::<&str>().copied());
        words.unwrap_or("a panic").to_owned()
    })
}

impl Server<'_> {
    fn run(&mut self) -> Result<(), ProtocolError> {
        loop {
            let timer = match self.next_due() {
                Some(at) => after(at.saturating_duration_since(Instant::now())),
                None => never(),
            };
            let message = select! {
                recv(self.connection.receiver) -> message => match message {
                    Ok(message) => message,
                    Err(_) => return Ok(()),
                },
                recv(self.texts.found) -> found => {
                    self.texts.busy = false;
                    self.show(found.ok());
                    continue;
                }
                recv(self.assemblies.found) -> found => {
                    self.assemblies.busy = false;
                    self.show(found.ok());
                    continue;
                }
                recv(timer) -> _ => {
                    self.check_due();
                    continue;
                }
            };
            match message {
                Message::Request(request) => {
                    if self.connection.handle_shutdown(&request)? {
                        return Ok(());
                    }
                    self.answer(request);
                }
                Message::Notification(notification) if notification.method == "exit" => {
                    return Ok(());
                }
                Message::Notification(notification) => self.notified(&notification),
                Message::Response(_) => {}
            }
        }
    }

    fn send(&self, message: impl Into<Message>) {
        // a client that is gone is noticed by the next receipt
        let _ = self.connection.sender.send(message.into());
    }

    fn notified(&mut self, notification: &Notification) {
        let at = &notification.params["textDocument"];
        let Some(uri) = at["uri"].as_str() else {
            return;
        };
        match notification.method.as_str() {
            "textDocument/didOpen" => {
                if let Some(text) = at["text"].as_str() {
                    self.change(uri, text, true);
                }
            }
            "textDocument/didChange" => {
                let changes = notification.params["contentChanges"].as_array();
                // each is a full text; the last one counts
                if let Some(text) = changes.and_then(|all| all.last()?["text"].as_str()) {
                    self.change(uri, text, false);
                }
            }
            "textDocument/didSave" => {
                // a change of this file may mend or break the files that use it
                let now = Instant::now();
                for open in self.documents.values_mut() {
                    open.due = Some((now, true));
                }
            }
            "textDocument/didClose" if self.documents.remove(uri).is_some() => {
                self.publish(uri, &[]);
            }
            _ => {}
        }
    }

    fn change(&mut self, uri: &str, text: &str, whole: bool) {
        let document = Document::new(uri, text);
        self.editions += 1;
        let edition = self.editions;
        let wait = if whole { Duration::ZERO } else { PAUSE };
        let due = Some((Instant::now() + wait, whole));
        match self.documents.get_mut(uri) {
            Some(open) => {
                open.document = document;
                open.edition = edition;
                open.due = due;
                // its ranges belong to the earlier text
                open.fixes.clear();
            }
            None => {
                let open = Open {
                    document,
                    edition,
                    due,
                    assembled: None,
                    program: None,
                    fixes: Vec::new(),
                };
                self.documents.insert(uri.to_owned(), open);
            }
        }
    }

    /// The text that is due first among those whose checker has nothing to do: its time, and its name.
    fn first_due(&self) -> Option<(Instant, &str)> {
        let due = self.documents.iter().filter_map(|(uri, open)| {
            let (at, whole) = open.due?;
            let checker = if whole { &self.assemblies } else { &self.texts };
            (!checker.busy).then_some((at, uri.as_str()))
        });
        due.min()
    }

    fn next_due(&self) -> Option<Instant> {
        self.first_due().map(|(at, _)| at)
    }

    /// Gives the text that has waited longest to its checker.
    fn check_due(&mut self) {
        let Some(uri) = self.first_due().map(|(_, uri)| uri.to_owned()) else {
            return;
        };
        let Some(open) = self.documents.get(&uri) else {
            return;
        };
        let (sources, name) = self.sources(&open.document);
        let job = Job {
            edition: open.edition,
            whole: open.due.is_some_and(|(_, whole)| whole),
            uri: uri.clone(),
            sources,
            name,
        };
        let checker = match job.whole {
            true => &mut self.assemblies,
            false => &mut self.texts,
        };
        checker.make(job);
        if let Some(open) = self.documents.get_mut(&uri) {
            open.due = None;
        }
    }

    /// Publishes the findings about a text, unless it has changed or was closed.
    fn show(&mut self, found: Option<Found>) {
        let Some(found) = found else {
            return;
        };
        let Some(open) = self.documents.get_mut(&found.uri) else {
            return;
        };
        // the findings of an assembly are those of a check while typing, and more
        let known = !found.whole && open.assembled == Some(found.edition);
        if open.edition != found.edition || known {
            return;
        }
        if found.whole {
            open.assembled = Some(found.edition);
        }
        open.fixes = found.messages.changes;
        open.program = found.program.or(open.program.take());
        self.publish(&found.uri, &found.messages.diagnostics);
    }

    /// The sources of a document, with all unsaved texts, and its name there.
    fn sources(&self, document: &Document) -> (Sources, String) {
        let memory = || {
            let name = "untitled.eng".to_owned();
            (
                Sources::from_text(name.clone(), document.text.as_str()),
                name,
            )
        };
        let Some(path) = &document.path else {
            return memory();
        };
        let name = path
            .file_name()
            .map(|name| name.to_string_lossy().into_owned());
        let folder = path.parent().map(Sources::folder);
        let (Some(name), Some(Ok(mut sources))) = (name, folder) else {
            return memory();
        };
        if let Some(cache) = &self.folders.cache {
            sources = sources.with_cache(cache);
        }
        let unsaved = self.documents.values().filter_map(|open| {
            let path = open.document.path.clone()?;
            Some((path, open.document.text.clone()))
        });
        (sources.with_unsaved(unsaved), name)
    }

    fn publish(&self, uri: &str, diagnostics: &[Value]) {
        let parameters = json!({ "uri": uri, "diagnostics": diagnostics });
        self.send(Notification::new(
            "textDocument/publishDiagnostics".to_owned(),
            parameters,
        ));
    }

    fn answer(&self, request: Request) {
        let Request { id, method, params } = request;
        let answered = guarded(|| self.answered(&method, &params));
        let response = match answered {
            Ok(Some(value)) => Response::new_ok(id, value),
            Ok(None) => refusal(
                id,
                ErrorCode::MethodNotFound,
                format!("there is no {method}"),
            ),
            Err(words) => refusal(id, ErrorCode::InternalError, words),
        };
        self.send(response);
    }

    /// The answer to a request; null for an empty answer. `None` for a method that the server does not have.
    fn answered(&self, method: &str, params: &Value) -> Option<Value> {
        let known = [
            "textDocument/hover",
            "textDocument/definition",
            "textDocument/completion",
            "textDocument/documentSymbol",
            "textDocument/formatting",
            "textDocument/codeAction",
        ];
        if !known.contains(&method) {
            return None;
        }
        let uri = params["textDocument"]["uri"].as_str().unwrap_or("");
        let Some(open) = self.documents.get(uri) else {
            return Some(Value::Null);
        };
        let document = &open.document;
        let place = document.byte(&params["position"]);
        let answer = match method {
            "textDocument/documentSymbol" => symbols::symbols(document),
            "textDocument/formatting" => formed(document),
            "textDocument/codeAction" => messages::actions(&open.fixes, &params["range"], uri),
            "textDocument/hover" => {
                let index = self.index(document);
                hover::hover(&index, document, open.program.as_ref(), place).unwrap_or(Value::Null)
            }
            "textDocument/definition" => self.definition(document, place).unwrap_or(Value::Null),
            _ => completion::completion(
                &self.index(document),
                document,
                open.program.as_ref(),
                place,
            ),
        };
        Some(answer)
    }

    /// The definitions that a document sees.
    fn index(&self, document: &Document) -> Index<'_> {
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
        let uri = match (&module.file_name, &document.path) {
            (None, _) if found.module == index.own() => document.uri.clone(),
            (Some(name), Some(path)) => document::uri(&path.parent()?.join(name)),
            _ => document::uri(&self.library_file(&module.path, &module.text)?),
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

/// The change that gives a text its form; none for a text with mistakes.
fn formed(document: &Document) -> Value {
    match eng_grammar::format(&document.text, eng_grammar::SourceId(0)) {
        Ok(formed) if formed != document.text => {
            let range = document::range(&document.text, 0, document.text.len());
            json!([{ "range": range, "newText": formed }])
        }
        _ => json!([]),
    }
}

#[cfg(test)]
mod tests {
    use super::guarded;

    #[test]
    fn a_panic_is_an_error_with_its_words() {
        assert_eq!(guarded(|| 3), Ok(3));
        let number = 4;
        let panicked: Result<(), String> = guarded(|| panic!("no {number}"));
        assert_eq!(panicked, Err("no 4".to_owned()));
    }
}
