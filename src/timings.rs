//! Processor time of the phases of a check and of a run.
//!
//! On Unix a clock reads the processor time of its own thread, so analyses side by side do not count for each other. On
//! other systems it reads the time that passes.

use crate::counted::counted;
use std::time::Duration;

/// Processor time of the phases of an analysis in the thread that runs it. Threads that solve its films
/// beside this one do not count.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Timings {
    /// From the bound model to the first state in motion.
    pub start: Duration,
    /// Steps of the integrator; of an analysis without steps, its solution.
    pub steps: Duration,
    /// Channels between the steps, at the points of the results.
    pub samples: Duration,
    /// Samples and checkpoints on their way into files.
    pub files: Duration,
    /// Films on finer cells, which show the error of their own.
    pub cells: Duration,
}

impl Timings {
    /// The phases with their names, in their order.
    pub fn phases(&self) -> [(&'static str, Duration); 5] {
        [
            ("start", self.start),
            ("steps", self.steps),
            ("samples", self.samples),
            ("files", self.files),
            ("error of the cells", self.cells),
        ]
    }
}

/// Processor time of the phases of a check. A check runs in one thread.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CheckTimings {
    /// Reading and parsing of all files, with those of the library, and the meaning of their names.
    pub reading: Duration,
    /// Types and units.
    pub types: Duration,
    /// From definitions to the flat systems of the models.
    pub elaboration: Duration,
    /// Meshes: files, nodes of markers, mass.
    pub meshes: Duration,
    /// Names and units of reports.
    pub reports: Duration,
    /// Machine code of the models, and the rigid bodies in place of flexible ones.
    pub machine_code: Duration,
    /// Assembly of the analyses and the conditions at their starts.
    pub assembly: Duration,
    /// The turns of the machine without forces, with the lints of a turn.
    pub dry_turns: Duration,
    /// The number of these turns. Each analysis has one; the points of a sweep share one.
    pub turns: usize,
    /// All other lints.
    pub lints: Duration,
}

impl CheckTimings {
    /// The phases with their names, in their order.
    pub fn phases(&self) -> [(String, Duration); 9] {
        [
            ("reading".to_owned(), self.reading),
            ("types".to_owned(), self.types),
            ("elaboration".to_owned(), self.elaboration),
            ("meshes".to_owned(), self.meshes),
            ("reports".to_owned(), self.reports),
            ("machine code".to_owned(), self.machine_code),
            ("assembly".to_owned(), self.assembly),
            (
                counted(self.turns, "turn without forces", "turns without forces"),
                self.dry_turns,
            ),
            ("lints".to_owned(), self.lints),
        ]
    }
}

/// The line about phases: `processor time: start 0.002 s, steps 1.204 s`.
pub(crate) fn line<N: std::fmt::Display>(phases: &[(N, Duration)]) -> String {
    let phases: Vec<String> = (phases.iter())
        .map(|(name, spent)| format!("{name} {:.3} s", spent.as_secs_f64()))
        .collect();
    format!("processor time: {}", phases.join(", "))
}

/// A clock that measures the time since its last reading.
#[derive(Debug)]
pub(crate) struct Clock {
    #[cfg(unix)]
    last: Duration,
    #[cfg(not(unix))]
    last: crate::moment::Moment,
}

impl Clock {
    /// A clock of the present thread.
    pub fn new() -> Clock {
        Clock { last: now() }
    }

    /// The time since the last call, or since the clock was made. The caller is the thread of the clock.
    pub fn since(&mut self) -> Duration {
        let last = std::mem::replace(&mut self.last, now());
        #[cfg(unix)]
        return self.last.saturating_sub(last);
        #[cfg(not(unix))]
        return self.last.since(last);
    }
}

#[cfg(unix)]
fn now() -> Duration {
    let now = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
    // neither part is negative: the time begins with the thread
    let seconds = Duration::from_secs(u64::try_from(now.tv_sec).unwrap_or_default());
    seconds + Duration::from_nanos(u64::try_from(now.tv_nsec).unwrap_or_default())
}

#[cfg(not(unix))]
fn now() -> crate::moment::Moment {
    crate::moment::Moment::now()
}
