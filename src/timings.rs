//! Processor time of the phases of a run.
//!
//! On Unix a clock reads the processor time of its own thread, so analyses side by side do not count for each other. On
//! other systems it reads the time that passes.

use std::time::Duration;

/// Processor time of the phases of an analysis. The analysis runs in one thread.
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
}

/// A clock that tells the time since it was read last.
#[derive(Debug)]
pub(crate) struct Clock {
    #[cfg(unix)]
    last: Duration,
    #[cfg(not(unix))]
    last: std::time::Instant,
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
        return self.last.saturating_duration_since(last);
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
fn now() -> std::time::Instant {
    std::time::Instant::now()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A thread that sleeps takes no processor time, and one that computes does.
    #[test]
    #[cfg(unix)]
    fn only_computing_counts() {
        let mut clock = Clock::new();
        std::thread::sleep(Duration::from_millis(50));
        let asleep = clock.since();
        let mut sum = 0.0_f64;
        while clock.last + Duration::from_millis(20) > now() {
            sum += std::hint::black_box(1.0);
        }
        let awake = clock.since();
        assert!(sum > 0.0);
        assert!(asleep < Duration::from_millis(10), "{asleep:?}");
        assert!(awake >= Duration::from_millis(20), "{awake:?}");
    }
}
