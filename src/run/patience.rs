//! Estimates of the remaining time of a run, and the decision to stop it.

use std::time::Duration;

/// Remaining time above which a run is stopped, unless the user states `--patient`. A choice: users who want to
/// wait longer than a day know this before.
const LONGEST: Duration = Duration::from_secs(24 * 3600);
/// Time of the first check of the progress. A choice: a person waits as long before they look.
const FIRST: Duration = Duration::from_secs(5);
/// Number of steps, or time, before which no rate of progress is known: the first steps of a run are short
/// and grow, and a step of elastic films may take a second. The numbers are choices.
const BEGINNING: (u64, Duration) = (30, Duration::from_secs(120));
/// Time between two checks, as a part of the time passed. A choice: two checks decide, so a run is stopped
/// after some 40 % more time.
const LATER: f64 = 0.2;

/// Least remaining time (s) for a warning about a growing one. A choice: nobody minds a shorter one.
const LONG: f64 = 600.0;
/// The least factor over the shortest earlier estimate for this warning. A choice: estimates of a cycle with
/// impacts vary by less.
const GROWN: f64 = 10.0;

/// The result of a check.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Estimate {
    /// Too soon after the last check.
    Soon,
    /// The run makes progress.
    Now,
    /// The run slows down. The rest would take this number of seconds, many times an earlier estimate.
    Slowing(f64),
    /// The rest would take too long: this number of seconds (infinite without progress).
    Lost(f64),
}

/// Watches the progress of a run. Two checks in a row must find it too slow, or slowing down.
#[derive(Clone, Debug)]
pub struct Patience {
    /// Time and finished part at the last check.
    last: (Duration, f64),
    next: Duration,
    hopeless: bool,
    /// The shortest remaining time (s) of all checks.
    shortest: f64,
    slowing: bool,
}

impl Default for Patience {
    fn default() -> Patience {
        Patience {
            last: (Duration::ZERO, 0.0),
            next: FIRST,
            hopeless: false,
            shortest: f64::INFINITY,
            slowing: false,
        }
    }
}

impl Patience {
    /// Takes the time since the start of the run, its finished part, 0…1, and its number of steps. It makes a check
    /// from time to time.
    pub fn check(&mut self, passed: Duration, done: f64, steps: u64) -> Estimate {
        let (few, short) = BEGINNING;
        let beginning = steps < few && passed < short;
        if passed < self.next || beginning {
            return Estimate::Soon;
        }
        let seconds = (passed - self.last.0).as_secs_f64();
        let rest = (1.0 - done) * seconds / (done - self.last.1).max(0.0);
        let (was, was_slowing) = (self.hopeless, self.slowing);
        self.shortest = self.shortest.min(rest);
        self.slowing = rest > LONG.max(GROWN * self.shortest);
        self.hopeless = rest > LONGEST.as_secs_f64();
        self.last = (passed, done);
        self.next = passed + FIRST.max(passed.mul_f64(LATER));
        if was && self.hopeless {
            Estimate::Lost(rest)
        } else if was_slowing && self.slowing {
            Estimate::Slowing(rest)
        } else {
            Estimate::Now
        }
    }
}

/// A time in words: `40 minutes`, `3 days`, `2.7e4 years`, `for ever`.
pub fn in_words(seconds: f64) -> String {
    const HOUR: f64 = 3600.0;
    const DAY: f64 = 24.0 * HOUR;
    const YEAR: f64 = 365.25 * DAY;
    if !seconds.is_finite() {
        "for ever".to_owned()
    } else if seconds < 2.0 * HOUR {
        format!("about {:.0} minutes", seconds / 60.0)
    } else if seconds < 2.0 * DAY {
        format!("about {:.0} hours", seconds / HOUR)
    } else if seconds < 2.0 * YEAR {
        format!("about {:.0} days", seconds / DAY)
    // longer numbers are not read digit by digit
    } else if seconds < 1e4 * YEAR {
        format!("about {:.0} years", seconds / YEAR)
    } else {
        format!("about {:.0e} years", seconds / YEAR)
    }
}
