//! Checks of texts, in threads beside the one that answers requests. So no request waits for a check.

use super::guarded;
use super::messages::Messages;
use crate::Program;
use crate::sources::Sources;
use crossbeam_channel::{Receiver, Sender, unbounded};
use eng_compiler::resolve::{Trees, resolve_with};
use eng_compiler::typed::TypedProgram;
use eng_grammar::{Diagnostics, SourceMap};
use std::sync::Arc;
use std::thread;

/// The depth of a check. Each depth has the findings of those before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Depth {
    /// Syntax, names, units and types: at every key.
    Texts,
    /// The models and reports: paths, indices, files. When the author pauses.
    Models,
    /// The assembly of the models, as `eng check` does it: when a text is opened or saved.
    Assembly,
}

impl Depth {
    pub const ALL: [Depth; 3] = [Depth::Texts, Depth::Models, Depth::Assembly];
}

/// A check to be made.
pub(super) struct Job {
    pub uri: String,
    /// The number of the text, which its findings keep: a later text has another one.
    pub edition: u64,
    pub sources: Sources,
    /// The name of the text in the sources.
    pub name: String,
}

/// The findings of a check.
pub(super) struct Found {
    pub uri: String,
    pub edition: u64,
    pub depth: Depth,
    pub messages: Messages,
    /// Whether there is an error, so that a deeper check finds nothing else.
    pub failed: bool,
    /// The program, if a check of its models finds no error.
    pub program: Option<Program>,
    /// Names, units and types, of a text with mistakes as far as they are known. Only a check of texts has them.
    pub typed: Option<Arc<TypedProgram>>,
}

/// A thread that makes one check after the other. It is never joined: the end of the process ends its check.
pub(super) struct Checker {
    jobs: Sender<Job>,
    pub found: Receiver<Found>,
    /// Whether a check is being made.
    pub busy: bool,
}

impl Checker {
    /// # Errors
    /// The operating system has no thread left.
    pub fn start(depth: Depth) -> std::io::Result<Checker> {
        let (jobs, waiting) = unbounded::<Job>();
        let (results, found) = unbounded();
        thread::Builder::new()
            .name("check".to_owned())
            .spawn(move || {
                let mut trees = Trees::default();
                for job in waiting {
                    // the receiver is gone after the end of the server
                    if results.send(checked(job, depth, &mut trees)).is_err() {
                        return;
                    }
                }
            })?;
        Ok(Checker {
            jobs,
            found,
            busy: false,
        })
    }

    pub fn make(&mut self, job: Job) {
        self.busy = self.jobs.send(job).is_ok();
    }
}

fn checked(job: Job, depth: Depth, trees: &mut Trees) -> Found {
    let found = guarded(|| match depth {
        Depth::Texts => of_texts(&job, trees),
        Depth::Models | Depth::Assembly => of_models(&job, depth),
    });
    found.unwrap_or_else(|words| Found {
        messages: Messages::internal(&words),
        uri: job.uri,
        edition: job.edition,
        depth,
        failed: true,
        program: None,
        typed: None,
    })
}

fn of_texts(job: &Job, trees: &mut Trees) -> Found {
    let mut texts = SourceMap::new();
    let mut messages = Diagnostics::new();
    let typed = typed(job, Some(trees), &mut texts, &mut messages);
    Found {
        uri: job.uri.clone(),
        edition: job.edition,
        depth: Depth::Texts,
        messages: Messages::of(&messages, &texts, &job.name, &job.uri),
        failed: messages.has_errors(),
        program: None,
        typed: typed.map(Arc::new),
    }
}

/// Reads a text and finds its types. A text that cannot be read has the messages about that alone; its types are
/// those of its readable parts.
fn typed(
    job: &Job,
    trees: Option<&mut Trees>,
    texts: &mut SourceMap,
    messages: &mut Diagnostics,
) -> Option<TypedProgram> {
    let library = eng_compiler::library::LIBRARY;
    let resolved = resolve_with(&job.name, &job.sources, library, trees, texts, messages);
    if !messages.has_errors() {
        return Some(eng_compiler::check::check(resolved, texts, messages));
    }
    let mut beside = messages.clone();
    guarded(|| eng_compiler::check::check(resolved, texts, &mut beside)).ok()
}

/// The number of errors of a text, its models left out.
pub(super) fn errors(sources: Sources, name: String) -> usize {
    let job = Job {
        uri: String::new(),
        edition: 0,
        sources,
        name,
    };
    let mut messages = Diagnostics::new();
    typed(&job, None, &mut SourceMap::new(), &mut messages);
    messages.iter().filter(|message| message.is_error()).count()
}

fn of_models(job: &Job, depth: Depth) -> Found {
    let checked = crate::check(&job.sources, &job.name);
    let report = checked.report();
    let mut messages = report.diagnostics().clone();
    let failed = messages.has_errors();
    if depth == Depth::Assembly
        && let Some(program) = checked.program()
        && let Ok(assembled) = program.assemble()
    {
        messages.extend(assembled.diagnostics);
    }
    Found {
        uri: job.uri.clone(),
        edition: job.edition,
        depth,
        messages: Messages::of(&messages, report.texts(), &job.name, &job.uri),
        failed,
        program: checked.program().cloned(),
        typed: None,
    }
}
