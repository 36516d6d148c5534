//! How long a run will take, and whether anybody waits for it.

use std::time::Duration;

/// A run whose rest takes longer is stopped, unless it was asked for.
const LONGEST: Duration = Duration::from_secs(24 * 3600);
/// The first look at the pace.
const FIRST: Duration = Duration::from_secs(5);
/// Time from one look to the next, as a part of what has passed.
const LATER: f64 = 0.2;

/// What a look at a run finds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Look {
    /// It is too soon after the last one.
    Soon,
    /// The run goes on.
    Now,
    /// Nobody waits for the rest: it would take so many seconds (infinite where nothing goes on).
    Lost(f64),
}

/// Watches the pace of a run: two looks one after the other must find it hopeless.
#[derive(Clone, Debug)]
pub(crate) struct Patience {
    /// Time and done part at the last look.
    last: (Duration, f64),
    next: Duration,
    hopeless: bool,
}

impl Default for Patience {
    fn default() -> Patience {
        Patience {
            last: (Duration::ZERO, 0.0),
            next: FIRST,
            hopeless: false,
        }
    }
}

impl Patience {
    /// Takes the time since the start of the run and its done part, 0…1. From time to time it is worth a look.
    pub fn look(&mut self, passed: Duration, done: f64) -> Look {
        if passed < self.next {
            return Look::Soon;
        }
        let seconds = (passed - self.last.0).as_secs_f64();
        let rest = (1.0 - done) * seconds / (done - self.last.1).max(0.0);
        let was = self.hopeless;
        self.hopeless = rest > LONGEST.as_secs_f64();
        self.last = (passed, done);
        self.next = passed + FIRST.max(passed.mul_f64(LATER));
        match was && self.hopeless {
            true => Look::Lost(rest),
            false => Look::Now,
        }
    }
}

/// A time in words: `3 days`, `2.7e4 years`, `for ever`.
pub(crate) fn in_words(seconds: f64) -> String {
    const DAY: f64 = 24.0 * 3600.0;
    const YEAR: f64 = 365.25 * DAY;
    if !seconds.is_finite() {
        "for ever".to_owned()
    } else if seconds < 2.0 * YEAR {
        format!("about {:.0} days", seconds / DAY)
    } else if seconds < 1e4 * YEAR {
        format!("about {:.0} years", seconds / YEAR)
    } else {
        format!("about {:.0e} years", seconds / YEAR)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Looks every half second at a run whose done part is a function of time; when it is stopped, and what is left.
    fn stopped(done: impl Fn(f64) -> f64) -> Option<(f64, f64)> {
        let mut patience = Patience::default();
        (1..200_000).find_map(|half| {
            let passed = f64::from(half) * 0.5;
            match patience.look(Duration::from_secs_f64(passed), done(passed)) {
                Look::Lost(left) => Some((passed, left)),
                Look::Soon | Look::Now => None,
            }
        })
    }

    #[test]
    fn hopeless_runs_are_stopped_after_two_looks() {
        let (passed, left) = stopped(|t| 1e-9 * t).unwrap();
        assert_eq!(passed, 10.0);
        assert!((left - (1e9 - 10.0)).abs() < 1.0, "{left}");
        assert_eq!(stopped(|_| 0.0), Some((10.0, f64::INFINITY)));
        // One that comes to stand after an hour. The look that follows may still see a part of the motion, the two after it see
        // none, and each is a fifth later than the one before, at whole half seconds.
        let (passed, left) = stopped(|t| t.min(3600.0) / 7200.0).unwrap();
        let latest = 3600.0 * 1.2_f64.powi(3) + 3.0;
        assert!((3600.0..latest).contains(&passed), "{passed}");
        assert_eq!(left, f64::INFINITY);
    }

    #[test]
    fn runs_that_end_within_a_day_are_left_alone() {
        assert_eq!(stopped(|t| t / (20.0 * 3600.0)), None);
        // short first steps; a phase of nine seconds that is a thousand times as slow
        assert_eq!(stopped(|t| (t - 4.9).max(1e-9 * t) / 3600.0), None);
        assert_eq!(
            stopped(|t| (t.min(100.0) + (t - 109.0).max(0.0)) / 3600.0),
            None
        );
    }

    #[test]
    fn times_in_words() {
        for (seconds, words) in [
            (3.0 * 86400.0, "about 3 days"),
            (3.2e9, "about 101 years"),
            (1e20, "about 3e12 years"),
            (f64::INFINITY, "for ever"),
        ] {
            assert_eq!(in_words(seconds), words);
        }
    }
}
