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
pub(crate) enum Estimate {
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
pub(crate) struct Patience {
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
pub(crate) fn in_words(seconds: f64) -> String {
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Looks every half second at a run whose done part is a function of time; the time of the stop, and the
    /// remaining time.
    fn stopped(done: impl Fn(f64) -> f64) -> Option<(f64, f64)> {
        let mut patience = Patience::default();
        (1..200_000).find_map(|half| {
            let passed = f64::from(half) * 0.5;
            match patience.check(Duration::from_secs_f64(passed), done(passed), 1000) {
                Estimate::Lost(left) => Some((passed, left)),
                Estimate::Soon | Estimate::Now | Estimate::Slowing(_) => None,
            }
        })
    }

    /// The time of the first warning about a run that slows down.
    fn slowed(done: impl Fn(f64) -> f64) -> Option<f64> {
        let mut patience = Patience::default();
        (1..20_000).find_map(|half| {
            let passed = f64::from(half) * 0.5;
            let estimate = patience.check(Duration::from_secs_f64(passed), done(passed), 1000);
            matches!(estimate, Estimate::Slowing(_)).then_some(passed)
        })
    }

    /// The pace falls e-fold every half minute, and the end is never reached.
    #[test]
    fn runs_whose_steps_shrink_are_noticed() {
        let shrinking = |t: f64| 0.25 * (1.0 - libm::exp(-t / 30.0));
        assert!(slowed(shrinking).is_some_and(|passed| passed < 150.0));
        // at one pace, however long it takes; and with a phase that is slow, but no minute long
        assert_eq!(slowed(|t| t / 36_000.0), None);
        assert_eq!(
            slowed(|t| (t.min(20.0) + (t - 29.0).max(0.0)) / 300.0),
            None
        );
    }

    #[test]
    fn hopeless_runs_are_stopped_after_two_checks() {
        let (passed, left) = stopped(|t| 1e-9 * t).unwrap();
        assert_eq!(passed, 10.0);
        assert!((left - (1e9 - 10.0)).abs() < 1.0, "{left}");
        assert_eq!(stopped(|_| 0.0), Some((10.0, f64::INFINITY)));
        // This run makes no progress after an hour. The next check may still see a part of the motion, and
        // the two checks after it see none. Each check is a fifth later than the one before, at whole half
        // seconds.
        let (passed, left) = stopped(|t| t.min(3600.0) / 7200.0).unwrap();
        let latest = 3600.0 * 1.2_f64.powi(3) + 3.0;
        assert!((3600.0..latest).contains(&passed), "{passed}");
        assert_eq!(left, f64::INFINITY);
    }

    /// Steps of a second whose first is a ten-millionth of the run, each 1.5 times as long as the one before: the first
    /// ten say nothing about the pace.
    #[test]
    fn short_first_steps_are_no_pace() {
        let mut patience = Patience::default();
        let (mut done, mut step) = (0.0, 1e-7);
        for steps in 1..=60 {
            let estimate = patience.check(Duration::from_secs(steps), done, steps);
            assert!(!matches!(estimate, Estimate::Lost(_)), "{steps}");
            done += step;
            step = (1.5 * step).min(1e-3);
        }
        // without a step for minutes there is a pace: none
        let mut patience = Patience::default();
        let stopped = (1..400).find(|passed| {
            let estimate = patience.check(Duration::from_secs(*passed), 0.0, 3);
            matches!(estimate, Estimate::Lost(_))
        });
        assert_eq!(stopped, Some(144));
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
            (900.0, "about 15 minutes"),
            (4.0 * 3600.0, "about 4 hours"),
            (3.0 * 86400.0, "about 3 days"),
            (3.2e9, "about 101 years"),
            (1e20, "about 3e12 years"),
            (f64::INFINITY, "for ever"),
        ] {
            assert_eq!(in_words(seconds), words);
        }
    }
}
