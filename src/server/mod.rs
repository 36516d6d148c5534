//! A language server: messages while typing, hover, definitions, completion, symbols, forms.
//!
//! It speaks the Language Server Protocol (3.17) with changes of ranges and places in UTF-16. Syntax, names, units and
//! types of a text are checked at every key, with the unsaved texts of all open files. Its models are checked when its
//! author pauses. When it is opened or saved, they are assembled, too, as `eng check` does. Checks have threads of
//! their own, so that answers do not wait for them. The newest text is checked; findings about an earlier one are
//! dropped. Questions about a text that does not parse are answered from the parts that do. A panic in a check or an
//! answer does not end the server. It becomes the message of an internal error.
//!
//! Requests and answers are plain JSON: the server uses some twenty of the thousand types of the protocol.

pub(crate) mod channels;
mod checks;
mod completion;
pub(crate) mod document;
pub(crate) mod due;
pub(crate) mod forms;
mod hints;
mod hover;
mod index;
mod messages;
mod occurrences;
pub(crate) mod place;
mod references;
mod requests;
mod symbols;
mod tokens;
pub(crate) mod transport;

pub use transport::{Transport, standard};

use crate::Program;
use crate::sources::Sources;
use channels::Channels;
use checks::{Checker, Depth, Found, Job};
use crossbeam_channel::{after, never, select};
use document::Document;
use eng_compiler::typed::TypedProgram;
use index::Library;
use lsp_server::{Connection, Message, Notification, ProtocolError, RequestId, Response};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// A pause in typing after which the models of a text are checked. A choice: shorter than a thought and longer than
/// a key.
const PAUSE: Duration = Duration::from_millis(300);

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
    /// The client sends another message than `initialized` after the answer to its first one.
    #[error("the editor broke the protocol: it must send `initialized` before other messages")]
    NotInitialized,
    /// The client closes the connection before it has received the answer to its first message, or right after it.
    #[error("the editor closed the connection at its start")]
    Closed,
    /// The client sends `exit` without `shutdown`.
    #[error("the editor ended the server without `shutdown`")]
    Ended,
    /// There is no thread for checks.
    #[error("no thread for checks: {0}")]
    Thread(#[from] std::io::Error),
}

/// Serves a client until it requests the end.
///
/// # Errors
/// The client breaks the protocol of the start or of the end, the connection breaks, or there is no thread left.
pub fn serve(connection: &Connection, folders: Folders) -> Result<(), ServerError> {
    let (id, client) = connection.initialize_start()?;
    let about = json!({
        "capabilities": capabilities(),
        "serverInfo": { "name": "eng", "version": env!("CARGO_PKG_VERSION") },
    });
    initialized(connection, id, about)?;
    let mut server = Server {
        connection,
        folders,
        roots: roots(&client),
        library: Library::read(),
        documents: BTreeMap::new(),
        editions: 0,
        checkers: [
            Checker::start(Depth::Texts)?,
            Checker::start(Depth::Models)?,
            Checker::start(Depth::Assembly)?,
        ],
    };
    server.run()
}

/// Answers the first message of a client, and waits for its `initialized`. `Connection::initialize_finish` does the same,
/// but panics if the client has closed its end.
fn initialized(connection: &Connection, id: RequestId, about: Value) -> Result<(), ServerError> {
    let answer = Message::from(Response::new_ok(id, about));
    let sent = connection.sender.send(answer);
    sent.map_err(|_| ServerError::Closed)?;
    match connection.receiver.recv() {
        Ok(Message::Notification(one)) if one.method == "initialized" => Ok(()),
        Ok(Message::Notification(one)) if one.method == "exit" => Err(ServerError::Ended),
        Ok(_) => Err(ServerError::NotInitialized),
        Err(_) => Err(ServerError::Closed),
    }
}

fn capabilities() -> Value {
    json!({
        // changes of ranges
        "textDocumentSync": { "openClose": true, "change": 2, "save": true },
        "hoverProvider": true,
        "definitionProvider": true,
        "referencesProvider": true,
        "renameProvider": { "prepareProvider": true },
        "documentSymbolProvider": true,
        "documentFormattingProvider": true,
        "documentRangeFormattingProvider": true,
        "codeActionProvider": { "codeActionKinds": ["quickfix"] },
        "codeLensProvider": { "resolveProvider": false },
        "inlayHintProvider": true,
        "semanticTokensProvider": { "legend": tokens::legend(), "full": true },
        "completionProvider": { "triggerCharacters": [".", " ", "(", "{"] },
    })
}

/// The folders that the client has opened.
fn roots(client: &Value) -> Vec<PathBuf> {
    let folders = client["workspaceFolders"].as_array();
    let folders = folders.into_iter().flatten().map(|folder| &folder["uri"]);
    let uris = folders.chain([&client["rootUri"]]);
    uris.filter_map(|uri| document::path(uri.as_str()?))
        .collect()
}

/// A text with the findings about it.
struct Open {
    document: Document,
    /// The number of this text among all that came.
    edition: u64,
    /// When it is to be checked, for each depth.
    due: [Option<Instant>; Depth::ALL.len()],
    /// The number of the text and the depth of the findings that were last shown, with their messages.
    shown: Option<(u64, Depth, Vec<Value>)>,
    /// The last program without errors.
    program: Option<Program>,
    /// The recorded channels of this program.
    channels: Channels,
    /// Names, units and types of the last text that was checked.
    typed: Option<Arc<TypedProgram>>,
    /// The changes that its messages propose: range, title, new text.
    fixes: Vec<messages::Change>,
}

struct Server<'c> {
    connection: &'c Connection,
    folders: Folders,
    /// The folders that the client has opened.
    roots: Vec<PathBuf>,
    library: Library,
    documents: BTreeMap<String, Open>,
    /// The number of texts that came.
    editions: u64,
    /// One for each depth: reading a mesh or assembling a model may take seconds, in which the user continues to
    /// type.
    checkers: [Checker; Depth::ALL.len()],
}

/// What a server waits for.
enum Event {
    /// A message of the client; none at the end of the connection.
    Message(Option<Message>),
    /// A check is due.
    Due,
    /// The findings of a check; none if its thread has ended.
    Found(Depth, Option<Found>),
}

/// The result of a piece of work, or the words of its panic.
pub(crate) fn guarded<T>(work: impl FnOnce() -> T) -> Result<T, String> {
    // the next check makes everything again that a panic could leave half-changed
    catch_unwind(AssertUnwindSafe(work)).map_err(|cause| {
        let words = cause.downcast_ref::<String>().map(String::as_str);
        let words = words.or_else(|| cause.downcast_ref::<&str>().copied());
        words.unwrap_or("a panic").to_owned()
    })
}

impl Server<'_> {
    fn run(&mut self) -> Result<(), ServerError> {
        loop {
            let timer = match self.first_due() {
                Some((at, ..)) => after(at.saturating_duration_since(Instant::now())),
                None => never(),
            };
            let [texts, models, assemblies] = &self.checkers;
            let event = select! {
                recv(self.connection.receiver) -> message => Event::Message(message.ok()),
                recv(timer) -> _ => Event::Due,
                recv(texts.found) -> found => Event::Found(Depth::Texts, found.ok()),
                recv(models.found) -> found => Event::Found(Depth::Models, found.ok()),
                recv(assemblies.found) -> found => Event::Found(Depth::Assembly, found.ok()),
            };
            match event {
                Event::Message(None) => return Ok(()),
                Event::Message(Some(message)) => {
                    if !self.goes_on(message)? {
                        return Ok(());
                    }
                }
                Event::Due => self.check_due(),
                Event::Found(depth, found) => {
                    self.checkers[depth as usize].busy = false;
                    match found {
                        Some(found) => self.show(found),
                        // a channel without its thread would be ready for ever
                        None => self.checkers[depth as usize].found = never(),
                    }
                }
            }
        }
    }

    /// Handles a message. Returns whether further ones may come.
    fn goes_on(&mut self, message: Message) -> Result<bool, ServerError> {
        match message {
            Message::Request(request) => {
                if self.connection.handle_shutdown(&request)? {
                    return Ok(false);
                }
                self.answer(request);
            }
            Message::Notification(notification) if notification.method == "exit" => {
                return Err(ServerError::Ended);
            }
            Message::Notification(notification) => self.notified(&notification),
            Message::Response(_) => {}
        }
        Ok(true)
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
                    let mut document = Document::new(uri, text);
                    document.version = at["version"].as_i64();
                    self.opened(document);
                }
            }
            "textDocument/didChange" => {
                if let Some(changes) = notification.params["contentChanges"].as_array() {
                    self.changed(uri, at["version"].as_i64(), changes);
                }
            }
            "textDocument/didSave" => {
                // a change of this file may mend or break the files that use it
                let now = Instant::now();
                for open in self.documents.values_mut() {
                    open.due[Depth::Models as usize] = None;
                    open.due[Depth::Assembly as usize] = Some(now);
                }
            }
            "textDocument/didClose" if self.documents.remove(uri).is_some() => {
                self.publish(uri, None, &[]);
            }
            _ => {}
        }
    }

    fn opened(&mut self, document: Document) {
        self.editions += 1;
        let now = Some(Instant::now());
        let uri = document.uri.clone();
        let open = Open {
            document,
            edition: self.editions,
            due: [now, None, now],
            shown: None,
            program: None,
            channels: Channels::default(),
            typed: None,
            fixes: Vec::new(),
        };
        self.documents.insert(uri, open);
    }

    fn changed(&mut self, uri: &str, version: Option<i64>, changes: &[Value]) {
        let Some(open) = self.documents.get_mut(uri) else {
            return;
        };
        self.editions += 1;
        changes
            .iter()
            .for_each(|change| open.document.change(change));
        open.document.version = version;
        open.edition = self.editions;
        let now = Instant::now();
        open.due = [Some(now), Some(now + PAUSE), None];
        // its ranges belong to the earlier text
        open.fixes.clear();
    }

    /// The check that is due first among those whose checker has nothing to do: its time, its depth, and the name of
    /// the text.
    fn first_due(&self) -> Option<(Instant, Depth, &str)> {
        let due = self.documents.iter().flat_map(|(uri, open)| {
            Depth::ALL.into_iter().filter_map(move |depth| {
                let at = open.due[depth as usize]?;
                (!self.checkers[depth as usize].busy).then_some((at, depth, uri.as_str()))
            })
        });
        due.min()
    }

    /// Gives the text that has waited longest to its checker.
    fn check_due(&mut self) {
        let Some((at, depth, uri)) = self.first_due() else {
            return;
        };
        let uri = uri.to_owned();
        let Some(open) = self.documents.get(&uri).filter(|_| at <= Instant::now()) else {
            return;
        };
        let (sources, name) = self.sources(&open.document);
        let job = Job {
            edition: open.edition,
            uri: uri.clone(),
            sources,
            name,
        };
        self.checkers[depth as usize].make(job);
        if let Some(open) = self.documents.get_mut(&uri) {
            open.due[depth as usize] = None;
        }
    }

    /// Publishes the findings about a text, unless it has changed or was closed, or a deeper check has shown them.
    fn show(&mut self, found: Found) {
        let Some(open) = self.documents.get_mut(&found.uri) else {
            return;
        };
        if open.edition != found.edition {
            return;
        }
        open.typed = found.typed.or(open.typed.take());
        if let Some(program) = found.program {
            open.program = Some(program);
            open.channels = Channels::default();
        }
        if found.failed {
            // it would find the same mistakes
            open.due[Depth::Models as usize] = None;
        }
        let before = open.shown.take();
        let before = before.filter(|(edition, ..)| *edition == found.edition);
        if before
            .as_ref()
            .is_some_and(|(_, depth, _)| *depth > found.depth)
        {
            open.shown = before;
            return;
        }
        let diagnostics = found.messages.diagnostics;
        let again = before.is_some_and(|(_, _, shown)| shown == diagnostics);
        open.fixes = found.messages.changes;
        open.shown = Some((found.edition, found.depth, diagnostics.clone()));
        let version = open.document.version;
        if !again {
            self.publish(&found.uri, version, &diagnostics);
        }
    }

    /// The sources of a document, with all unsaved texts, and its name there.
    fn sources(&self, document: &Document) -> (Sources, String) {
        self.sources_with(document, &BTreeMap::new())
    }

    /// The same with other texts of some files.
    fn sources_with(
        &self,
        document: &Document,
        changed: &BTreeMap<PathBuf, String>,
    ) -> (Sources, String) {
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
        let changed = changed
            .iter()
            .map(|(path, text)| (path.clone(), text.clone()));
        (sources.with_unsaved(unsaved.chain(changed)), name)
    }

    /// Sends the messages about a text, with the client's number of this text.
    fn publish(&self, uri: &str, version: Option<i64>, diagnostics: &[Value]) {
        let mut parameters = json!({ "uri": uri, "diagnostics": diagnostics });
        if let Some(version) = version {
            parameters["version"] = json!(version);
        }
        self.send(Notification::new(
            "textDocument/publishDiagnostics".to_owned(),
            parameters,
        ));
    }
}
