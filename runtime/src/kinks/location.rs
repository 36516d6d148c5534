//! Where kinks lie about a step: within its last trial, ahead of the last accepted state, and at both.

use super::clocks::Change;
use super::crossing::{BEGIN, crossing, roots, same_side, tip};
use super::neighbours::APART;
use super::{Crossing, Item, Kinks, Limit};
use crate::integrator::STATE_SHARE;

/// Distance before a kink at which a step ends, as a share of the limit. The motion starts again there as if
/// it were at the kink, so the load of this distance is an error. A hundredth of the limit makes this error
/// small beside those that the limit allows; a smaller share would come near the rounding of positions.
const BEFORE: f64 = 0.01;
/// A state nearer to a kink than this many times the distance of [`BEFORE`] counts as at the kink. A step
/// that aims there misses by the error of its cubic, so twice the distance leaves room on both sides.
const AT: f64 = 2.0;
/// Nearer to a kink than this many times the distance of [`BEFORE`], rounding decides the side of a state. A
/// step that aims at the distance itself ends beyond this one.
const BESIDE: f64 = 0.5;
/// Limit of a time, as a share of the time itself. Sums of steps round by a few units of the last place.
const MOMENT: f64 = 8.0 * f64::EPSILON;
/// Share of the limit of a function without a unit above which its sign is not due to rounding. With the
/// share 1e-5 of [`STATE_SHARE`] it is 1e-11 of the largest value: some decades above the rounding of the
/// function, which may be a difference.
const SIGN: f64 = 1e-6;
/// Number of successive steps that pass one kink after which the motion counts as staying there: a valve
/// whose pressures have become equal, a body that sticks. Ending every step there would gain nothing. Three
/// is a choice: two steps may pass the same kink to and fro by chance.
const STAYS: f64 = 3.0;
/// Share of the change of a function over a step that its rates do not explain. Above it, the function has
/// jumped with its angle. A choice: a jump is nearly the whole change, and the rates of a smooth function
/// explain most of it.
const WRAPPED: f64 = 0.5;

impl Kinks {
    /// The limit of a function at a time (s), for a factor on the tolerances.
    pub(super) fn limit(&self, item: usize, time: f64, factor: f64) -> f64 {
        // the slope at the end nearer to the kink, because the slopes at both ends may differ much
        let nearer = self.next[item][0].abs() < self.now[item][0].abs();
        let slope = self.slopes[usize::from(nearer)][item];
        // where the slope vanishes, rounding must not decide the side
        let least = match slope {
            1.0 => 0.0,
            _ => SIGN * STATE_SHARE * self.peaks[item],
        };
        match self.items[item].limit {
            Limit::Stated(length) => (slope * length * factor.min(1.0)).max(least),
            Limit::Tolerance(tolerance) => {
                let limit = (slope * tolerance * factor).max(least);
                limit.min((APART.0 * self.neighbours.apart(item)).max(APART.1 * limit))
            }
            Limit::Time => {
                let width = self.change(item).map_or(0.0, |change| change.width);
                (MOMENT * time.abs()).max(2.0 * width)
            }
            Limit::Share => STATE_SHARE * factor * self.peaks[item],
        }
    }

    /// The distance of a function from its kink up to which a step ends there.
    fn end(&self, item: usize, time: f64, factor: f64) -> f64 {
        let limit = self.limit(item, time, factor);
        match self.items[item].limit {
            Limit::Time | Limit::Share => limit,
            _ => AT * BEFORE * limit,
        }
    }

    /// The time (s) of the first kink that a trial of a step h (s) passes deeper than its limit, with the kink. The trial ends at a
    /// time (s). Without a kink, the trial does not show whether a function passes its kink before this time and comes back.
    pub fn passed(&self, h: f64, time: f64, factor: f64) -> Option<(f64, Option<usize>)> {
        let mut first: Option<(f64, Option<usize>)> = None;
        for (item, (from, to)) in self.now.iter().zip(&self.next).enumerate() {
            if !self.counts(item) || self.stays[item] >= STAYS {
                continue;
            }
            let crossing = match same_side(*from, *to, h) {
                true => None,
                false => self.crossing_deeper(item, h, time, factor),
            };
            let found = match crossing {
                Some(found) => Some((found.time, Some(item))),
                None => self.tip(item, h, time, factor).map(|time| (time, None)),
            };
            if let Some(found) = found
                && first.is_none_or(|first| found.0 < first.0)
            {
                first = Some(found);
            }
        }
        first
    }

    /// The crossing of a function in the last trial of h (s), deeper than its limit. The trial ends at a time (s).
    fn crossing_deeper(&self, item: usize, h: f64, time: f64, factor: f64) -> Option<Crossing> {
        let limit = self.limit(item, time, factor);
        // The end aims at the kink itself at a moment, which is known exactly, and at the kink of a valve,
        // beside which states move infinitely fast. At a length it aims before the kink, because rounding
        // must not decide its side.
        let aim = BEFORE * limit;
        let (depths, aim) = match self.items[item].limit {
            Limit::Time | Limit::Share => ([limit; 2], 0.0),
            _ => ([AT * aim, -BESIDE * aim], aim),
        };
        self.crossing(item, h, depths, aim)
    }

    /// The time (s) at which a distance may have passed its kink unseen in the last trial of h (s), see [`tip`].
    fn tip(&self, item: usize, h: f64, time: f64, factor: f64) -> Option<f64> {
        if self.items[item].wraps || !self.items[item].is_way() {
            return None;
        }
        let limit = || self.limit(item, time, factor);
        tip(self.now[item], self.next[item], h, limit)
    }

    /// Whether a function counts in the last trial.
    pub(super) fn counts(&self, item: usize) -> bool {
        self.used[item] || self.used_next[item]
    }

    /// The crossing of a function in the last trial of h (s), see [`crossing`].
    ///
    /// A function of an angle that begins anew within the trial is continued by its jump, from its beginning and from its end:
    /// between them the rates at both ends say by how much it would change.
    pub(super) fn crossing(
        &self,
        item: usize,
        h: f64,
        limits: [f64; 2],
        aim: f64,
    ) -> Option<Crossing> {
        let (from, to) = (self.now[item], self.next[item]);
        let change = to[0] - from[0];
        let jump = change - 0.5 * h * (from[1] + to[1]);
        if jump.abs() <= WRAPPED * change.abs() || !self.begins_anew(item) {
            return crossing(from, to, h, limits, aim);
        }
        let before = crossing(from, [to[0] - jump, to[1]], h, limits, aim);
        let behind = || crossing([from[0] + jump, from[1]], to, h, limits, aim);
        before.or_else(behind)
    }

    /// Whether an angle on which a function depends may begin anew in the last trial. An angle that only tables read has no function
    /// that is zero there, because no step needs to end there.
    fn begins_anew(&self, item: usize) -> bool {
        let Item {
            element,
            wraps,
            of_table,
            ..
        } = self.items[item];
        let passes = |cut: usize| (self.now[cut][0] < 0.0) != (self.next[cut][0] < 0.0);
        let mut items = self.items.iter().enumerate();
        let mut passed = || {
            items.any(|(cut, other)| {
                other.cut && other.element == element && self.counts(cut) && passes(cut)
            })
        };
        wraps && (of_table || passed())
    }

    /// The time (s) after which a function is before its kink, if its rate keeps changing as in the last step;
    /// `None` if it does not come there within h (s).
    ///
    /// The trials of a step do not decide this. An implicit step across a stiff stop ends at the stop, whatever its
    /// length is.
    pub fn expected(&self, item: usize, h: f64, time: f64, factor: f64) -> Option<f64> {
        let [value, rate] = self.now[item];
        let aim = BEFORE * self.limit(item, time, factor) * value.signum();
        let mut times = roots(0.5 * self.bends[item], rate, value - aim);
        times.sort_by(f64::total_cmp);
        times.into_iter().find(|time| *time > 0.0 && *time < h)
    }

    /// The place or moment that a trial reaches at its end, at a time (s). Other functions, such as the pressure at a
    /// valve, may stay within their limit.
    pub fn reached_way(&self, time: f64, factor: f64) -> Option<usize> {
        let reached = self.reached(time, factor);
        reached.filter(|item| self.items[*item].limit != Limit::Share)
    }

    /// Whether the last trial, which ends at a time (s), ends at a kink.
    pub fn is_near(&self, item: usize, time: f64, factor: f64) -> bool {
        let limit = self.end(item, time, factor);
        (self.next.get(item)).is_some_and(|[value, _]| value.abs() <= limit)
    }

    /// The time (s) until the function of a kink changes its sign at its present rate; zero if it does not.
    pub fn time_to(&self, item: usize) -> f64 {
        let time = self
            .now
            .get(item)
            .map_or(0.0, |[value, rate]| -value / rate);
        if time > 0.0 && time.is_finite() {
            time
        } else {
            0.0
        }
    }

    /// The time (s) from a kink to the next one of its element, if their distance is constant, at its present rate, or to the next
    /// zero of its own function, if the rate keeps changing as in the last step; infinite without them.
    pub fn time_beside(&self, item: usize) -> f64 {
        let (rate, bend) = (self.now[item][1], self.bends[item]);
        let back = if rate * bend < 0.0 {
            -2.0 * rate / bend
        } else {
            f64::INFINITY
        };
        back.min(self.neighbours.apart(item) / rate.abs())
    }

    /// The first time (s) of a step h (s) in which a function changes its sign at its present rate, if a step of h would
    /// take this for its beginning. The function is not within its limit, and its kink is beside another one.
    pub fn at_once(&self, h: f64, time: f64, factor: f64) -> Option<f64> {
        let far = self.now.iter().enumerate().filter(|(item, [value, _])| {
            let far = value.abs() > self.end(*item, time, factor);
            self.used[*item] && self.neighbours.apart(*item).is_finite() && far
        });
        far.map(|(_, [value, rate])| -value / rate)
            .filter(|time| *time > 0.0 && *time <= 2.0 * BEGIN * h)
            .min_by(f64::total_cmp)
    }

    /// Whether the functions of the last evaluation have another sign at a kink than at the last accepted state, and go on
    /// to leave it.
    pub fn is_left(&self, item: usize) -> bool {
        let (Some([before, _]), Some([behind, rate])) = (self.now.get(item), self.next.get(item))
        else {
            return false;
        };
        before * behind <= 0.0 && behind * rate > 0.0
    }

    /// The moment (s) of a kink in time at the end of the last trial, which ends at a time (s).
    pub fn moment_at(&self, item: usize, time: f64) -> f64 {
        moment(self.next.get(item), time)
    }

    /// The same at the last accepted state, which is at a time (s).
    pub fn moment_here(&self, item: usize, time: f64) -> f64 {
        moment(self.now.get(item), time)
    }

    /// The times (s) just before and just behind the moment (s) of a kink: loads are those of one side there.
    pub fn around(&self, item: usize, moment: f64) -> [f64; 2] {
        match self.change(item) {
            Some(Change { time, width }) => [time - width, time + width],
            None => [moment.next_down().next_down(), moment.next_up().next_up()],
        }
    }

    /// A kink in time less than a millionth of a step h (s) after the end of the last trial: a step that
    /// began at this end would not end at the kink.
    pub fn moment_behind(&self, h: f64) -> Option<usize> {
        let mut ends = self.next.iter().enumerate();
        ends.find(|(item, [value, rate])| {
            let time = -value / rate;
            let soon = time > 0.0 && time <= BEGIN * h;
            self.items[*item].limit == Limit::Time && soon && self.used_next[*item]
        })
        .map(|(item, _)| item)
    }

    /// The time (s) until the function of a kink is on its other side by a share of its limit, if it keeps
    /// its present rate. `None` if the last step did not end at the kink, or if the function does not come
    /// there.
    pub fn across(&self, item: usize, share: f64, time: f64, factor: f64) -> Option<f64> {
        let [value, rate] = self.now.get(item)?;
        if value.abs() > self.end(item, time, factor) {
            return None;
        }
        let further = share * self.limit(item, time, factor) / rate.abs();
        (self.time_to(item) > 0.0 || *value == 0.0)
            .then_some(self.time_to(item) + further)
            .filter(|time| time.is_finite() && *time > 0.0)
    }

    /// The longest time (s) below `most` in which a function changes its sign at its present rate.
    pub fn time_left(&self, most: f64) -> f64 {
        let used = self.now.iter().zip(&self.used).filter(|(_, used)| **used);
        let times = used.map(|([value, rate], _)| -value / rate);
        let soon = times.filter(|time| *time > 0.0 && *time < most);
        soon.fold(0.0, f64::max)
    }

    /// The least size of a function at a time (s) that is not due to rounding, so that its sign tells the side of its kink.
    pub fn side(&self, item: usize, time: f64, factor: f64) -> f64 {
        match self.items[item].limit {
            Limit::Share => SIGN * self.limit(item, time, factor),
            _ => self.end(item, time, factor),
        }
    }

    /// Whether a kink is a moment, at which loads may jump whatever the motion is.
    pub fn is_moment(&self, item: usize) -> bool {
        (self.items.get(item)).is_some_and(|item| item.limit == Limit::Time)
    }

    /// A kink that a trial reaches at its end, at a time (s), and not before.
    pub fn reached(&self, time: f64, factor: f64) -> Option<usize> {
        let mut pairs = self.now.iter().zip(&self.next).enumerate();
        let found = pairs.find(|(item, (from, to))| {
            let limit = self.end(*item, time, factor);
            let comes = to[0].abs() <= limit && from[0].abs() > limit;
            self.used_next[*item] && to[1] != 0.0 && comes
        });
        found.map(|(item, _)| item)
    }

    /// Whether a step begins at a kink, at a time (s), and leaves it within the time `at` (s). A function that
    /// stays within its limit is not left, however far the step goes, and no load acts between it and the next kink alone.
    pub fn begins_at_kink(&self, at: f64, time: f64, factor: f64) -> bool {
        let mut functions = self.now.iter().enumerate();
        functions.any(|(item, [value, rate])| {
            let limit = self.limit(item, time, factor);
            let is_left = value.abs() <= limit && (value + rate * at).abs() > limit;
            self.used[item] && is_left
        })
    }

    /// The first time within a step h (s) at which a function would change its sign at its present rate. The step
    /// begins at a time (s). A function within its limit is at its kink already.
    pub fn foreseen(&self, h: f64, time: f64, factor: f64) -> Option<(f64, usize)> {
        let far = (self.now.iter().enumerate()).filter(|(item, [value, _])| {
            self.used[*item] && value.abs() > self.limit(*item, time, factor)
        });
        far.map(|(item, [value, rate])| (-value / rate, item))
            .filter(|(time, _)| *time > BEGIN * h && *time < h)
            .min_by(|a, b| a.0.total_cmp(&b.0))
    }

    /// The kinks at which the last accepted state is, at a time (s), except those at which it rests.
    pub fn here(&self, time: f64, factor: f64) -> Vec<usize> {
        let items = 0..self.items.len();
        items
            .filter(|item| self.is_here(*item, time, factor))
            .collect()
    }

    /// The kinks of constraints among [`Kinks::here`].
    pub fn constrains_here(&self, time: f64, factor: f64) -> Vec<usize> {
        let items = self.constraining.iter().copied();
        items
            .filter(|item| self.is_here(*item, time, factor))
            .collect()
    }

    fn is_here(&self, item: usize, time: f64, factor: f64) -> bool {
        let [value, rate] = self.now[item];
        self.used[item] && rate != 0.0 && value.abs() <= self.end(item, time, factor)
    }

    /// The kinks of constraints that the last trial of h (s) passes, with the time (s) from its beginning. The trial ends at
    /// a time (s).
    pub fn constrains_within(&self, h: f64, time: f64, factor: f64) -> Vec<(usize, f64)> {
        let passed = self.constraining.iter().filter_map(|item| {
            let (from, to) = (self.now[*item], self.next[*item]);
            if !self.counts(*item) || same_side(from, to, h) {
                return None;
            }
            let found = self.crossing(*item, h, [self.end(*item, time, factor); 2], 0.0)?;
            Some((*item, found.time))
        });
        passed.collect()
    }

    /// The crossing of a kink that the step before the last accepted state passed. The state has a time (s).
    pub fn at_end(&self, item: usize, time: f64) -> Crossing {
        Crossing {
            time: 0.0,
            item,
            depth: self.now[item][0].abs(),
            limit: self.limit(item, time, 1.0),
            inside: false,
        }
    }

    /// The time (s), with its sign, from the last evaluated state to a kink, and the time in which its function changes by
    /// its limit, both at its present rate. The state has a time (s).
    pub fn times_to(&self, item: usize, time: f64, factor: f64) -> [f64; 2] {
        let [value, rate] = self.next[item];
        let limit = self
            .limit(item, time, factor)
            .max(self.end(item, time, factor));
        [-value / rate, limit / rate.abs()]
    }
}

/// The moment (s) at which a function of time alone is zero, from its value and rate at a time (s).
fn moment(function: Option<&[f64; 2]>, time: f64) -> f64 {
    let found = function.map_or(time, |[value, rate]| time - value / rate);
    if found.is_finite() { found } else { time }
}
