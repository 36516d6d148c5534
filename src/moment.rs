//! Moments, for measured times. WebAssembly without a clock of its host measures zero.

use std::time::{Duration, Instant};

/// A moment.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Moment(Option<Instant>);

impl Moment {
    /// The present one.
    pub fn now() -> Moment {
        // the standard library panics there
        let clock = !cfg!(all(target_family = "wasm", target_os = "unknown"));
        Moment(clock.then(Instant::now))
    }

    /// The time from an earlier moment to this one.
    pub fn since(self, earlier: Moment) -> Duration {
        match (self.0, earlier.0) {
            (Some(now), Some(earlier)) => now.saturating_duration_since(earlier),
            _ => Duration::ZERO,
        }
    }

    /// The time from this moment to the present one.
    pub fn elapsed(self) -> Duration {
        Moment::now().since(self)
    }
}
