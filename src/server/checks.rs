//! Checks of texts, in threads beside the one that answers requests. So no request waits for a check.

use super::guarded;
use super::messages::Messages;
use crate::Program;
use crate::sources::Sources;
use crossbeam_channel::{Receiver, Sender, unbounded};
use std::thread;

/// A check to be made.
pub(super) struct Job {
    pub uri: String,
    /// The number of the text, which its findings keep: a later text has another one.
    pub edition: u64,
    pub sources: Sources,
    /// The name of the text in the sources.
    pub name: String,
    /// Whether its models are assembled, too.
    pub whole: bool,
}

/// The findings of a check.
pub(super) struct Found {
    pub uri: String,
    pub edition: u64,
    /// Whether its models were assembled, too.
    pub whole: bool,
    pub messages: Messages,
    pub program: Option<Program>,
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
    pub fn start() -> std::io::Result<Checker> {
        let (jobs, waiting) = unbounded::<Job>();
        let (results, found) = unbounded();
        thread::Builder::new()
            .name("check".to_owned())
            .spawn(move || {
                for job in waiting {
                    // the receiver is gone after the end of the server
                    if results.send(checked(job)).is_err() {
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

fn checked(job: Job) -> Found {
    let (messages, program) =
        guarded(|| findings(&job)).unwrap_or_else(|words| (Messages::internal(&words), None));
    Found {
        uri: job.uri,
        edition: job.edition,
        whole: job.whole,
        messages,
        program,
    }
}

fn findings(job: &Job) -> (Messages, Option<Program>) {
    let checked = crate::check(&job.sources, &job.name);
    let report = checked.report();
    let mut messages = report.diagnostics().clone();
    if job.whole
        && let Some(program) = checked.program()
        && let Ok(assembled) = program.assemble()
    {
        messages.extend(assembled.diagnostics);
    }
    let messages = Messages::of(&messages, report.texts(), &job.name, &job.uri);
    (messages, checked.program().cloned())
}
