//! Kinks of functions of time alone: their moments, which are found before a step comes to them.
//!
//! A step sees a function by its value and rate at both ends. Several pulses of `sin(314 rad/s*time) > 0.9` may lie between them
//! without a trace. But a function of time is known at every time without the motion. So its changes of sign are searched ahead of the
//! steps, and the kink functions are the times since these moments: the last one before the step and the next two.
//!
//! The search goes forward by intervals. In an interval the function must be Hermite's cubic through its values and rates at both ends,
//! which is tested at points within; otherwise the interval is halved. A function that is narrow itself, such as
//! `exp(-((time - 1 s)/(1 ms))^2) - 0.5`, may pass all points.
//!
//! A function may touch zero without a change of sign, as `(time - 1 s)^2` does. Nothing lasts there, so the search passes it. But if a
//! step ends there, to the last bit, this time becomes a moment, too.

use super::crossing::same_side;
use crate::error::RuntimeError;

/// Number of moments that are kept, and how many of them may lie ahead.
pub(super) const KEPT: usize = 3;
const AHEAD: usize = 2;
/// A function that never changes: there is no moment.
const NONE: [f64; 2] = [1.0, 0.0];
/// Places within an interval at which the function is compared with the cubic: (3 − √5)/4, 1/√6, (√5 − 1)/2
/// and sin 1. They are no simple shares, because a function with a period may agree at those.
const WITHIN: [f64; 4] = [0.190_983, 0.408_248, 0.618_034, 0.841_471];
/// Difference from the cubic that is allowed, as a share of the distance from zero, or of the function's
/// largest value if it comes near zero. Choices: a quarter of the distance leaves room for an error between
/// the four places. Near zero the difference moves the change of sign in time alone, and bisection with the
/// function itself finds it; the cubic need only show that there is one.
const CLEAR: f64 = 0.25;
const NEAR: f64 = 1e-3;
/// Number of first intervals of a search. A choice: the test of an interval compares four points, so the
/// search begins with 32 points; more would slow down functions that never change.
const FIRST: f64 = 8.0;
/// The shortest interval, as a share of a search, and in roundings of the time. A choice: a function that
/// jumps is never a cubic, and its interval is halved down to these, 27 times. Shorter ones would have equal
/// times at their ends and within.
const SHORTEST: f64 = 1e-9;
const ROUNDINGS: f64 = 16.0;
/// Largest number of intervals of a search. Where it ends, a step ends, too. A choice: a function with more
/// changes than this in a step would otherwise keep the run from moving on.
const MOST: usize = 100_000;
/// The shortest distance (s) from a moment, and the largest multiple of this distance at which both sides of
/// the moment may be clear of rounding. The first is for the time zero, which has no last place. The second
/// is 29 doublings: with two last places of a time these are about 2e-7 of it. There the square of a function
/// that touches zero is some 1e-14, clear of rounding.
const LEAST: f64 = 1e-20;
const DOUBLED: f64 = (1_u64 << 29) as f64;
/// Largest distance (s) from a zero near the time zero at which a function that touches it may be clear of rounding: `1 - cos(t/(1 s))` is
/// zero up to 1e-8 s.
const TOUCHES: f64 = 1e-7;

/// A change of sign, or a zero at which the end of a step would lie.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Change {
    /// Its time (s).
    pub time: f64,
    /// The distance (s) at which the sign on either side is not due to rounding.
    pub width: f64,
}

/// The moments of one kink function.
#[derive(Clone, Debug)]
pub(super) struct Clock {
    /// Index of the first of its functions.
    pub first: usize,
    /// The pair of elements among those of its batch, the lane, and the index of the function in the class.
    pub place: [usize; 3],
    changes: [Option<Change>; KEPT],
    /// The time (s) up to which all changes are known, with value and rate of the function there; NaN before the first search.
    known_to: f64,
    last: [f64; 2],
    /// Length (s) of the next interval.
    interval: f64,
}

impl Clock {
    /// A clock whose moments are not known yet.
    pub fn new(first: usize, place: [usize; 3]) -> Clock {
        Clock {
            first,
            place,
            changes: [None; KEPT],
            known_to: f64::NAN,
            last: [f64::NAN; 2],
            interval: f64::INFINITY,
        }
    }

    /// Forgets all moments, because the function has changed.
    pub fn forget(&mut self) {
        *self = Clock::new(self.first, self.place);
    }

    /// Values and rates of its functions at a time (s).
    pub fn functions(&self, time: f64) -> [[f64; 2]; KEPT] {
        self.changes
            .map(|change| change.map_or(NONE, |change| [time - change.time, 1.0]))
    }

    /// The change of sign of one of its functions.
    pub fn change(&self, function: usize) -> Option<Change> {
        self.changes.get(function).copied().flatten()
    }

    /// Whether moments up to a time (s) may be unknown.
    pub fn is_short_of(&self, time: f64) -> bool {
        self.known_to.is_nan() || self.known_to < time
    }

    /// Moves on to a time (s): of the moments that have passed, only the last one is kept.
    pub fn follow(&mut self, time: f64) {
        let times = self.changes.iter().flatten().map(|change| change.time);
        let last = times.filter(|at| *at <= time).fold(f64::MIN, f64::max);
        for slot in &mut self.changes {
            if slot.is_some_and(|change| change.time < last) {
                *slot = None;
            }
        }
    }

    /// Searches the changes of a function that may lie before the end of a step, until two lie ahead. The step begins and ends at
    /// given times (s).
    pub fn search(
        &mut self,
        [now, end]: [f64; 2],
        mut function: impl FnMut(f64) -> Result<[f64; 2], RuntimeError>,
    ) -> Result<(), RuntimeError> {
        // the first evaluation is that of the start
        let now = if now.is_finite() { now } else { end };
        if self.known_to.is_nan() {
            self.begin(now, &mut function)?;
        }
        if self.known_to >= end {
            return Ok(());
        }
        // by as much further, so that not every step needs a search
        let to = end + (end - self.known_to);
        let shortest = SHORTEST * (to - self.known_to);
        self.interval = self.interval.min((to - self.known_to) / FIRST);
        let mut intervals = 0;
        while self.known_to < to && self.free_slot(now).is_some() {
            let begin = self.known_to;
            intervals += 1;
            if intervals > MOST {
                let width = 2.0 * (begin.next_up() - begin);
                self.keep(now, Change { time: begin, width });
                break;
            }
            let rounding = ROUNDINGS * f64::EPSILON * begin.abs();
            let h = self.interval.max(shortest).max(rounding);
            let end = if begin + h < to { begin + h } else { to };
            let at_end = function(end)?;
            let shortest = end - begin <= 2.0 * shortest.max(rounding);
            let known = self.last.iter().chain(&at_end).all(|x| x.is_finite());
            if known && !shortest && !is_cubic([begin, end], [self.last, at_end], &mut function)? {
                self.interval = 0.5 * (end - begin);
                continue;
            }
            if self.last[0] * at_end[0] < 0.0 || (at_end[0] == 0.0 && self.last[0] != 0.0) {
                let change = locate([begin, end], self.last[0], &mut function)?;
                if let Some(change) = change {
                    self.keep(now, change);
                    self.known_to = change.time + 2.0 * change.width;
                    self.last = function(self.known_to)?;
                    continue;
                }
            }
            self.known_to = end;
            self.last = at_end;
            self.interval = 2.0 * (end - begin);
        }
        Ok(())
    }

    /// Begins a search at a time (s), which may be a moment itself.
    fn begin(
        &mut self,
        time: f64,
        function: &mut impl FnMut(f64) -> Result<[f64; 2], RuntimeError>,
    ) -> Result<(), RuntimeError> {
        let change = Change {
            time,
            width: width(time, Sides::Opposite, function)?.unwrap_or(0.0),
        };
        if change.width > 0.0 {
            self.changes[0] = Some(change);
        }
        self.known_to = time + 2.0 * change.width;
        self.last = function(self.known_to)?;
        Ok(())
    }

    /// The distance (s) on both sides of a time (s) from which on the function is no zero, if it touches zero at this time.
    pub fn touches(
        &self,
        time: f64,
        function: &mut impl FnMut(f64) -> Result<[f64; 2], RuntimeError>,
    ) -> Result<Option<f64>, RuntimeError> {
        let mut known = self.changes.iter().flatten();
        if known.any(|change| (time - change.time).abs() <= change.width)
            || function(time)?[0] != 0.0
        {
            return Ok(None);
        }
        width(time, Sides::Equal, function)
    }

    /// Makes a time (s), at which the function is zero, one of the moments if the function touches zero there. Otherwise a step that ends
    /// exactly there would see a load of no duration over all of its length. Returns whether it is one now.
    pub fn touch(
        &mut self,
        now: f64,
        time: f64,
        mut function: impl FnMut(f64) -> Result<[f64; 2], RuntimeError>,
    ) -> Result<bool, RuntimeError> {
        let Some(width) = self.touches(time, &mut function)? else {
            return Ok(false);
        };
        // later ones are found again
        for slot in &mut self.changes {
            *slot = slot.filter(|change| change.time < time);
        }
        self.keep(now, Change { time, width });
        self.known_to = time + 2.0 * width;
        self.last = function(self.known_to)?;
        Ok(true)
    }

    /// A slot for one more change, if fewer than two lie ahead of a time (s).
    fn free_slot(&self, now: f64) -> Option<usize> {
        let ahead = |slot: &Option<Change>| slot.is_some_and(|change| change.time > now);
        if self.changes.iter().filter(|slot| ahead(slot)).count() >= AHEAD {
            return None;
        }
        let empty = self.changes.iter().position(Option::is_none);
        // a long step may pass more moments than are kept: the earliest behind it gives way
        let earliest = || {
            let slots = self.changes.iter().enumerate();
            let behind = slots.filter_map(|(slot, change)| Some((slot, change.as_ref()?.time)));
            let behind = behind.filter(|(_, time)| *time <= now);
            behind
                .min_by(|a, b| a.1.total_cmp(&b.1))
                .map(|(slot, _)| slot)
        };
        empty.or_else(earliest)
    }

    fn keep(&mut self, now: f64, change: Change) {
        if let Some(slot) = self.free_slot(now) {
            self.changes[slot] = Some(change);
        }
    }

    /// Its numbers for a checkpoint.
    pub fn numbers(&self) -> impl Iterator<Item = f64> + '_ {
        let changes = self
            .changes
            .iter()
            .flat_map(|change| change.map_or([f64::NAN; 2], |change| [change.time, change.width]));
        changes.chain([self.known_to, self.last[0], self.last[1], self.interval])
    }

    /// Sets them from a checkpoint, and returns the others.
    pub fn set_numbers<'a>(&mut self, numbers: &'a [f64]) -> &'a [f64] {
        let (changes, rest) = numbers.split_at((2 * KEPT).min(numbers.len()));
        for (slot, [time, width]) in self.changes.iter_mut().zip(changes.as_chunks::<2>().0) {
            *slot = (!time.is_nan()).then_some(Change {
                time: *time,
                width: *width,
            });
        }
        let Some(([known_to, value, rate, interval], rest)) = rest.split_first_chunk() else {
            return rest;
        };
        self.known_to = *known_to;
        self.last = [*value, *rate];
        self.interval = *interval;
        rest
    }
}

/// Whether a function is the cubic through its values and rates at both ends of an interval: so nearly that the cubic shows whether
/// and where it changes its sign. Where the cubic leaves this open, the interval is too long.
fn is_cubic(
    [begin, end]: [f64; 2],
    [from, to]: [[f64; 2]; 2],
    function: &mut impl FnMut(f64) -> Result<[f64; 2], RuntimeError>,
) -> Result<bool, RuntimeError> {
    let h = end - begin;
    let points = [
        from[0],
        from[0] + h * from[1] / 3.0,
        to[0] - h * to[1] / 3.0,
        to[0],
    ];
    let (mut error, mut largest) = (0.0_f64, from[0].abs().max(to[0].abs()));
    for s in WITHIN {
        let value = function(begin + s * h)?[0];
        let r = 1.0 - s;
        let cubic = r * r * (r * points[0] + 3.0 * s * points[1])
            + s * s * (3.0 * r * points[2] + s * points[3]);
        error = error.max((value - cubic).abs());
        largest = largest.max(value.abs());
    }
    let clear = points
        .iter()
        .fold(f64::INFINITY, |least, x| least.min(x.abs()));
    Ok(match same_side(from, to, h) {
        true => error <= CLEAR * clear,
        // both ends on one side: the cubic may come back
        false => from[0] * to[0] <= 0.0 && error <= NEAR * largest,
    })
}

/// The change of sign between two times (s), at the first of which the function has a value; `None` if both signs are rounding, as
/// where a function touches zero.
fn locate(
    [mut low, mut high]: [f64; 2],
    before: f64,
    function: &mut impl FnMut(f64) -> Result<[f64; 2], RuntimeError>,
) -> Result<Option<Change>, RuntimeError> {
    loop {
        let middle = low + 0.5 * (high - low);
        if middle <= low || middle >= high {
            break;
        }
        if function(middle)?[0] * before > 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    let width = width(high, Sides::Opposite, function)?;
    Ok(width.map(|width| Change { time: high, width }))
}

/// How the signs of a function on both sides of a zero are related.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Sides {
    Opposite,
    /// The function touches zero.
    Equal,
}

/// The distance (s) from a time at which a function has one sign before and the other one, or the same, behind, clear of rounding: the
/// signs at half of it and at twice of it are the same. `None` if the function does not do this.
fn width(
    time: f64,
    sides: Sides,
    function: &mut impl FnMut(f64) -> Result<[f64; 2], RuntimeError>,
) -> Result<Option<f64>, RuntimeError> {
    let (sign, least) = match sides {
        Sides::Opposite => (-1.0, 0.0),
        Sides::Equal => (1.0, TOUCHES),
    };
    let mut distance = (2.0 * (time.next_up() - time)).max(LEAST);
    let most = (DOUBLED * distance).max(least);
    let mut clear = |distance: f64| -> Result<bool, RuntimeError> {
        let before = function(time - distance)?[0];
        let behind = function(time + distance)?[0];
        Ok(sign * before * behind > 0.0)
    };
    // a function that stays at zero touches it nowhere
    if sides == Sides::Equal && !clear(most)? {
        return Ok(None);
    }
    while distance <= most {
        if clear(distance)? && clear(0.5 * distance)? && clear(2.0 * distance)? {
            return Ok(Some(distance));
        }
        distance *= 2.0;
    }
    Ok(None)
}
