//! Kinks of loads, rates and constraints: places where a step must end.
//!
//! A stop, a backlash or a valve has a function g of the motion that changes its sign where the force bends:
//! the compiler derives these functions ([`Function::Kinks`]). The error of a step is estimated from its ends, so
//! a force that begins and ends within a step is invisible to it. Within a step g is Hermite's cubic through its
//! values and rates at both ends. If the cubic is deeper than a limit on one side and then changes its sign, the
//! step ends just before the first change, within the limit and on the side from which it comes. There the load
//! is still that of this side. A step that ended behind the kink, however little, would apply the load of the
//! other side over all of its length: a stiff stop, entered by a nanometre, would slow a body during its flight.
//!
//! | g is | its limit |
//! | --- | --- |
//! | a length, in an element whose class states `resolve` | the smallest length that it resolves |
//! | another length | the tolerance of positions, or a fiftieth of the constant distance from another kink of the element |
//! | an angle | this tolerance over the model's length |
//! | another function of places and time alone | its change when a body moves by the tolerance of positions ([`slopes`]) |
//! | a time, or a function of time alone | rounding: a moment is known exactly |
//! | anything else | 1e-5 of the largest value of g so far, the share that errors of states may have |
//!
//! A factor on the tolerances multiplies all but times. A factor above 1 does not multiply a stated length.
//!
//! A function counts in a step that uses it at the beginning or at the end: it does not count while an `if`
//! selects a branch without it. A function of a `wrapped` angle jumps by a whole period with this angle, and such
//! a jump is no change of sign.
//!
//! The changes of sign of a function of time alone are searched ahead of the steps, and its kink functions are
//! the times since them. So no step passes two of them unseen.

mod beside;
mod clocks;
mod crossing;
mod overlooked;
mod points;
mod slopes;

use crate::dynamics::Dynamics;
use crate::elements::{self, Batch, Inputs};
use crate::error::RuntimeError;
use crate::integrator::STATE_SHARE;
use crate::model::Model;
use crate::state::State;
use beside::Neighbours;
use clocks::{Change, Clock, KEPT};
use crossing::{crossing, roots, same_side};
use eng_system::code::{Function, Pair};
use eng_system::dimension::Dimension;
use eng_system::layout::InputLayout;
use eng_system::system::{Course, Kink, Origin};
pub use overlooked::Overlooked;
use points::Points;
use slopes::Sloped;
use std::ops::Range;

/// Distance before a kink at which a step ends, as a share of the limit. The motion starts again there as if it were at the
/// kink, so the load of this distance is an error.
const BEFORE: f64 = 0.01;
/// A state nearer to a kink than this number of these distances counts as at the kink. Nearer than the second one, rounding decides
/// the side.
const AT: f64 = 2.0;
const BESIDE: f64 = 0.5;
/// Share of the distance of two kinks of an element that limits both, and its least share of the limit. A jump of a load between
/// two kinks, such as on a thin sheet, acts over this distance alone. Two functions nearer to each other are one.
const APART: (f64, f64) = (0.02, 1e-4);
/// Difference of the rates of two functions whose kinks have a constant distance, as a share of their rates.
const PARALLEL: f64 = 1e-6;
/// Limit of a time, as a share of the time itself.
const MOMENT: f64 = 8.0 * f64::EPSILON;
/// Share of a step within which a kink counts as being at its beginning. Otherwise a function that is zero there
/// except for rounding would shorten the step to nothing.
const BEGIN: f64 = 1e-6;
/// Share of the limit of a function without a unit above which its sign is not due to rounding.
const SIGN: f64 = 1e-6;
/// Number of steps one after the other that pass one kink, from which on the motion stays at it: a valve whose
/// pressures have become equal, a body that sticks. Ending every step there would gain nothing.
const STAYS: f64 = 3.0;
/// A step that passes a kink, or ends close before it, adds this number to the count of the kink. Any other step subtracts 1.
const PASSED: f64 = 32.0;
/// Number of steps of equal length that an end close before a kink is from it at most. A motion that comes to a kink and passes it
/// counts some five times.
const CLOSE: f64 = 4.0;
/// The count at which the motion may be held at a kink: after 8 steps that pass it or end close before it, or a few more with others
/// between.
const OFTEN: f64 = 256.0;
/// Largest change (rad) in a step of the argument of a sine in a function of the motion. The cubic through values and rates differs
/// from a sine by 1e-5 then, the share that errors of states may have. Narrower tips may be missed.
const PHASE: f64 = 0.25;
/// Share of the change of a function over a step that its rates do not explain. Above it, a `wrapped` angle has jumped by a period.
const WRAPPED: f64 = 0.5;

/// The limit of a kink function; see the table above.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Limit {
    Stated(f64),
    Tolerance(f64),
    Time,
    Share,
}

/// One kink function of one element.
#[derive(Clone, Copy, Debug)]
struct Item {
    element: usize,
    kink: usize,
    limit: Limit,
    /// Whether constraints depend on it.
    constrains: bool,
    /// Whether it jumps where a `wrapped` angle begins anew.
    wraps: bool,
    /// Whether a jump of a load may hold the motion there: not at a moment, nor at a place, whose rate does not jump.
    holds: bool,
}

impl Item {
    /// Whether its function is a length, an angle or another one of places.
    fn is_way(&self) -> bool {
        matches!(self.limit, Limit::Stated(_) | Limit::Tolerance(_))
    }
}

/// Elements of one class with kinks.
#[derive(Clone, Debug)]
struct Group {
    /// Index among the batches of the dynamics, whose inputs serve.
    batch: usize,
    /// Own inputs, if the rates of the functions need accelerations.
    own: Option<Batch>,
    /// Index of the first item.
    first: usize,
    /// Its clocks, and its functions of places.
    clocks: Range<usize>,
    sloped: Range<usize>,
}

impl Group {
    /// The batch with the inputs of its elements.
    fn batch<'a>(&'a self, dynamics: &'a Dynamics) -> &'a Batch {
        (self.own.as_ref()).unwrap_or(&dynamics.batches()[self.batch])
    }
}

/// The kink functions of a model, at the beginning of a step and at the end of its last trial.
#[derive(Clone, Debug)]
pub struct Kinks {
    groups: Vec<Group>,
    items: Vec<Item>,
    /// Values and rates at the last accepted state.
    now: Vec<[f64; 2]>,
    /// Values and rates at the end of the last trial.
    next: Vec<[f64; 2]>,
    /// Whether selected branches use each function at the last accepted state, and at the end of the last trial.
    used: Vec<bool>,
    used_next: Vec<bool>,
    /// Those that constraints depend on.
    constraining: Vec<usize>,
    /// Changes of the rates over the last accepted step (1/s); zero where it passed the kink.
    bends: Vec<f64>,
    /// Largest magnitudes at accepted states.
    peaks: Vec<f64>,
    /// Number of steps one after the other that passed each kink.
    stays: Vec<f64>,
    /// Counts of passages that fall with each step without one.
    passages: Vec<f64>,
    often: Option<usize>,
    neighbours: Neighbours,
    points: Points,
    clocks: Vec<Clock>,
    sloped: Vec<Sloped>,
    /// Slopes of the functions at the last accepted state and at the last evaluation; 1 for lengths and angles.
    slopes: [Vec<f64>; 2],
    /// Times (s) of the last accepted state and of the last evaluation.
    times: [f64; 2],
    /// Largest rates (rad/s) of arguments of sines in functions of the motion, at the last accepted state and at the last evaluation.
    phase_rate: [f64; 2],
    out: Vec<Pair>,
    inputs: Vec<Pair>,
}

/// A kink within a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// Time from the beginning of the step (s).
    pub time: f64,
    /// Index of the kink function.
    pub item: usize,
    /// The largest distance of the function on the other side within the step, and its limit.
    pub depth: f64,
    /// See [`Crossing::depth`].
    pub limit: f64,
    /// Whether the step comes back to the first side or near it, so that its end does not show the kink.
    pub inside: bool,
}

impl Kinks {
    /// The kink functions of a model's dynamic elements. `batches` are those of its dynamics.
    pub fn new(model: &Model, batches: &[Batch]) -> Kinks {
        let system = &model.compiled.system;
        let mut kinks = Kinks {
            groups: Vec::new(),
            items: Vec::new(),
            now: Vec::new(),
            next: Vec::new(),
            used: Vec::new(),
            used_next: Vec::new(),
            constraining: Vec::new(),
            bends: Vec::new(),
            peaks: Vec::new(),
            stays: Vec::new(),
            passages: Vec::new(),
            often: None,
            neighbours: Neighbours::default(),
            points: Points::default(),
            clocks: Vec::new(),
            sloped: Vec::new(),
            slopes: [const { Vec::new() }; 2],
            times: [f64::NEG_INFINITY; 2],
            phase_rate: [0.0; 2],
            out: Vec::new(),
            inputs: Vec::new(),
        };
        for (index, batch) in batches.iter().enumerate() {
            let class = &system.classes[batch.class];
            if class.kinks.is_empty() {
                continue;
            }
            let members: Vec<usize> = (0..batch.pairs.len())
                .flat_map(|pair| batch.pairs[pair].into_iter().take(batch.lanes(pair)))
                .collect();
            kinks.groups.push(Group {
                batch: index,
                own: class
                    .facts
                    .kinks_read_accelerations
                    .then(|| elements::batches(model, &members, true))
                    .and_then(|made| made.into_iter().next()),
                first: kinks.items.len(),
                clocks: 0..0,
                sloped: 0..0,
            });
            let (clocks, sloped) = (kinks.clocks.len(), kinks.sloped.len());
            for (member, element) in members.into_iter().enumerate() {
                for (k, kink) in class.kinks.iter().enumerate() {
                    let limit = limit(model, element, kink);
                    let item = Item {
                        element,
                        kink: k,
                        limit,
                        constrains: kink.constrains,
                        wraps: kink.wraps,
                        holds: kink.course == Course::Motion && limit != Limit::Time,
                    };
                    let first = kinks.items.len();
                    let count = match (kink.table, kink.course) {
                        (Some(table), _) => kinks.points.add(first, table, kink.constrains),
                        (None, Course::Time) => {
                            kinks
                                .clocks
                                .push(Clock::new(first, [member / 2, member % 2, k]));
                            KEPT
                        }
                        (None, _) => 1,
                    };
                    if kink.course == Course::Position && item.is_way() && !is_length(kink) {
                        let place = [member / 2, member % 2, k];
                        kinks.sloped.push(Sloped::new(place, first..first + count));
                    }
                    kinks.items.extend(std::iter::repeat_n(item, count));
                }
            }
            if let Some(group) = kinks.groups.last_mut() {
                group.clocks = clocks..kinks.clocks.len();
                group.sloped = sloped..kinks.sloped.len();
            }
            kinks
                .out
                .resize(kinks.out.len().max(class.kink_outputs()), [0.0; 2]);
        }
        let count = kinks.items.len();
        kinks.now = vec![[0.0; 2]; count];
        kinks.next = vec![[0.0; 2]; count];
        kinks.used = vec![true; count];
        kinks.used_next = vec![true; count];
        let constraining = (0..count).filter(|item| kinks.items[*item].constrains);
        kinks.constraining = constraining.collect();
        kinks.slopes = [vec![1.0; count], vec![1.0; count]];
        kinks.bends = vec![0.0; count];
        kinks.peaks = vec![0.0; count];
        kinks.stays = vec![0.0; count];
        kinks.passages = vec![0.0; count];
        let kind = |item: &Item| {
            let dimension = model.class(item.element).kinks[item.kink].dimension;
            let tolerance = matches!(item.limit, Limit::Tolerance(_));
            tolerance.then_some((item.element, dimension))
        };
        let kinds: Vec<_> = kinks.items.iter().map(kind).collect();
        kinks.neighbours = Neighbours::new(&kinds);
        kinks
    }

    /// Evaluates the functions at a state at which the dynamics are placed and their inputs gathered.
    pub fn evaluate(
        &mut self,
        model: &Model,
        dynamics: &Dynamics,
        state: &State,
    ) -> Result<(), RuntimeError> {
        self.times[1] = state.time;
        self.phase_rate[1] = 0.0;
        for index in 0..self.groups.len() {
            let group = &mut self.groups[index];
            if let Some(own) = &mut group.own {
                let from = Inputs {
                    multipliers: &[],
                    memory: None,
                    ..dynamics.inputs_at(state)
                };
                elements::gather(model, own, &from);
                add_accelerations(model, dynamics, state, own);
            }
            self.search(model, dynamics, index)?;
            let group = &self.groups[index];
            let batch = group.batch(dynamics);
            let class = &model.compiled.system.classes[batch.class];
            let count = class.kinks.len();
            let out = &mut self.out[..class.kink_outputs()];
            let mut at = group.first;
            let mut clocks = self.clocks[group.clocks.clone()].iter();
            for pair in 0..batch.pairs.len() {
                elements::call(model, batch.class, Function::Kinks, batch.inputs(pair), out)?;
                for lane in 0..batch.lanes(pair) {
                    for phase in &out[4 * count..] {
                        self.phase_rate[1] = self.phase_rate[1].max(phase[lane].abs());
                    }
                    for (k, kink) in class.kinks.iter().enumerate() {
                        let [value, rate] = [out[k][lane], out[count + k][lane]];
                        let used = out[3 * count + k][lane] != 0.0;
                        self.used_next[at] = used;
                        let Some(table) = kink.table else {
                            let changes = match kink.course {
                                Course::Time => clocks.next(),
                                _ => None,
                            };
                            let Some(clock) = changes else {
                                self.next[at] = timed(kink.course, [value, rate]);
                                at += 1;
                                continue;
                            };
                            for function in clock.functions(state.time) {
                                self.next[at] = function;
                                self.used_next[at] = used;
                                at += 1;
                            }
                            continue;
                        };
                        let handle = out[2 * count + k][lane];
                        let functions =
                            (self.points).functions(model, (at, table), handle, [value, rate]);
                        for function in functions {
                            self.next[at] = timed(kink.course, function);
                            self.used_next[at] = used;
                            at += 1;
                        }
                    }
                }
            }
            self.measure_slopes(model, dynamics, index)?;
        }
        Ok(())
    }

    /// Searches the moments of the clocks of a group that may lie before the end of a step: up to the time of the last evaluation, and
    /// by as much further, so that not every step needs a search.
    fn search(
        &mut self,
        model: &Model,
        dynamics: &Dynamics,
        group: usize,
    ) -> Result<(), RuntimeError> {
        let group = &self.groups[group];
        let batch = group.batch(dynamics);
        let class = &model.compiled.system.classes[batch.class];
        let count = class.kinks.len();
        let [accepted, time] = self.times;
        let out = &mut self.out[..class.kink_outputs()];
        for clock in &mut self.clocks[group.clocks.clone()] {
            if !clock.is_short_of(time) {
                continue;
            }
            let [pair, lane, k] = clock.place;
            let inputs = &mut self.inputs;
            inputs.clear();
            inputs.extend_from_slice(batch.inputs(pair));
            let function = |time: f64| {
                inputs[InputLayout::TIME as usize] = [time; 2];
                elements::call(model, batch.class, Function::Kinks, inputs, out)?;
                Ok([out[k][lane], out[count + k][lane]])
            };
            clock.search([accepted, time], function)?;
            let functions = clock.functions(accepted);
            self.now[clock.first..clock.first + KEPT].copy_from_slice(&functions);
        }
        Ok(())
    }

    /// Forgets the moments of functions of time alone, because constants have changed.
    pub fn forget_moments(&mut self) {
        for clock in &mut self.clocks {
            clock.forget();
        }
    }

    /// The change of sign that a function counts from, if it is that of a clock.
    fn change(&self, item: usize) -> Option<Change> {
        let behind = self.clocks.partition_point(|clock| clock.first <= item);
        let clock = self.clocks.get(behind.checked_sub(1)?)?;
        clock.change(item - clock.first)
    }

    /// Makes the end of the last trial the beginning of the next step. The step had a length h (s), zero if the
    /// motion begins here. `ended` is the kink at which the step ended.
    pub fn accept(&mut self, model: &Model, h: f64, ended: Option<usize>) {
        let pairs = self.now.iter().zip(&self.next).enumerate();
        for ((item, (from, to)), (stay, bend)) in
            pairs.zip(self.stays.iter_mut().zip(&mut self.bends))
        {
            let passed = from[0] * to[0] < 0.0;
            *bend = if h > 0.0 && !passed {
                (to[1] - from[1]) / h
            } else {
                0.0
            };
            // a step that ends before a kink neither passes it nor leaves it
            let ended_before = ended == Some(item) && self.items[item].is_way();
            if passed || (ended == Some(item) && !ended_before) {
                *stay += 1.0;
            } else if stay.is_finite() && !ended_before {
                *stay = 0.0;
            }
        }
        self.often = None;
        let pairs = self.now.iter().zip(&self.next).enumerate();
        for ((item, (from, to)), passages) in pairs.zip(&mut self.passages) {
            let passed = from[0] * to[0] < 0.0;
            let close = to[0] * to[1] < 0.0 && to[0].abs() <= CLOSE * h * to[1].abs();
            let counts = (passed || close) && self.items[item].holds;
            *passages = (*passages + if counts { PASSED } else { -1.0 }).max(0.0);
            if *passages >= OFTEN {
                (*passages, self.often) = (0.0, Some(item));
            }
        }
        self.now.copy_from_slice(&self.next);
        self.used.copy_from_slice(&self.used_next);
        let [now, next] = &mut self.slopes;
        now.copy_from_slice(next);
        for (item, function) in self.points.follow(model) {
            [self.now[item], self.next[item]] = [function; 2];
            [self.stays[item], self.peaks[item]] = [0.0; 2];
        }
        self.times[0] = self.times[1];
        self.phase_rate[0] = self.phase_rate[1];
        for clock in &mut self.clocks {
            let items = clock.first..clock.first + KEPT;
            clock.follow(self.times[0]);
            for (item, function) in items.zip(clock.functions(self.times[0])) {
                [self.now[item], self.next[item]] = [function; 2];
                self.stays[item] = 0.0;
            }
        }
        for (peak, [value, _]) in self.peaks.iter_mut().zip(&self.now) {
            *peak = peak.max(value.abs());
        }
        self.measure_distances();
    }

    fn measure_distances(&mut self) {
        let (items, slopes) = (&self.items, &self.slopes[0]);
        let tolerance = |item: usize| match items[item].limit {
            Limit::Tolerance(tolerance) => tolerance * slopes[item],
            _ => 0.0,
        };
        self.neighbours.measure(&self.now, tolerance);
    }

    /// The limit of a function at a time (s), for a factor on the tolerances.
    fn limit(&self, item: usize, time: f64, factor: f64) -> f64 {
        // that of the end nearer to the kink, because both may differ much
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

    /// Ends no more steps at a kink.
    pub fn ignore(&mut self, item: usize) {
        if let Some(stay) = self.stays.get_mut(item) {
            *stay = f64::INFINITY;
        }
    }

    /// The longest step (s) in which sines in functions of the motion change so little that no change of sign is missed.
    pub fn longest_step(&self) -> f64 {
        PHASE / self.phase_rate[0]
    }

    /// A kink that many of the last steps have passed to and fro, or ended close to.
    pub fn often(&self) -> Option<usize> {
        self.often
    }

    /// The first kink that a trial of a step h (s) passes deeper than its limit. The trial ends at a time (s).
    pub fn passed(&self, h: f64, time: f64, factor: f64) -> Option<Crossing> {
        let mut first: Option<Crossing> = None;
        for (item, (from, to)) in self.now.iter().zip(&self.next).enumerate() {
            if !self.counts(item) || same_side(*from, *to, h) || self.stays[item] >= STAYS {
                continue;
            }
            let limit = self.limit(item, time, factor);
            // a moment is known exactly, and beside the kink of a valve states move infinitely fast; at a length rounding must
            // not decide which side an end is on
            let aim = BEFORE * limit;
            let (depths, aim) = match self.items[item].limit {
                Limit::Time | Limit::Share => ([limit; 2], 0.0),
                _ => ([AT * aim, -BESIDE * aim], aim),
            };
            if let Some(found) = self.crossing(item, h, depths, aim)
                && first.is_none_or(|first| found.time < first.time)
            {
                first = Some(Crossing { item, ..found });
            }
        }
        first
    }

    /// Whether a function counts in the last trial.
    fn counts(&self, item: usize) -> bool {
        self.used[item] || self.used_next[item]
    }

    /// The crossing of a function in the last trial of h (s), see [`crossing`].
    ///
    /// A function of a `wrapped` angle that jumps within the trial is continued by the jump, from its beginning and from its end:
    /// between them the rates at both ends say by how much it would change.
    fn crossing(&self, item: usize, h: f64, limits: [f64; 2], aim: f64) -> Option<Crossing> {
        let (from, to) = (self.now[item], self.next[item]);
        let change = to[0] - from[0];
        let jump = change - 0.5 * h * (from[1] + to[1]);
        if !self.items[item].wraps || jump.abs() <= WRAPPED * change.abs() {
            return crossing(from, to, h, limits, aim);
        }
        let before = crossing(from, [to[0] - jump, to[1]], h, limits, aim);
        let behind = || crossing([from[0] + jump, from[1]], to, h, limits, aim);
        before.or_else(behind)
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

    /// Whether the function of a kink is a length, an angle or another one of places.
    pub fn is_way(&self, item: usize) -> bool {
        self.items.get(item).is_some_and(Item::is_way)
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

    /// A kink in time less than a millionth of a step h (s) behind the end of the last trial: a step that began at the end
    /// would not end there.
    pub fn moment_behind(&self, h: f64) -> Option<usize> {
        let mut ends = self.next.iter().enumerate();
        ends.find(|(item, [value, rate])| {
            let time = -value / rate;
            let soon = time > 0.0 && time <= BEGIN * h;
            self.items[*item].limit == Limit::Time && soon && self.used_next[*item]
        })
        .map(|(item, _)| item)
    }

    /// The time (s) until the function of a kink is on its other side by a share of its limit, at its present rate at a time
    /// (s); `None` if the last step did not end at the kink, or if it does not come there.
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

    /// Whether a step begins at another kink than this one, at a time (s), and leaves it within the time `at` (s). A function that
    /// stays within its limit is not left, however far the step goes, and no load acts between it and this kink alone.
    pub fn begins_at_other(&self, kink: usize, at: f64, time: f64, factor: f64) -> bool {
        let mut functions = self.now.iter().enumerate();
        functions.any(|(item, [value, rate])| {
            let limit = self.limit(item, time, factor);
            let is_left = value.abs() <= limit && (value + rate * at).abs() > limit;
            item != kink && self.used[item] && is_left
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

    /// Those of constraints.
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

    /// A kink that the step before the last accepted state passed; the state has a time (s).
    pub fn at_end(&self, item: usize, time: f64) -> Crossing {
        Crossing {
            time: 0.0,
            item,
            depth: self.now[item][0].abs(),
            limit: self.limit(item, time, 1.0),
            inside: false,
        }
    }

    /// The element of a kink.
    pub fn element(&self, item: usize) -> usize {
        self.items[item].element
    }

    /// The value of a function at the last evaluated state.
    pub fn value(&self, item: usize) -> f64 {
        self.next[item][0]
    }

    /// The rate of a function at the last evaluated state (1/s).
    pub fn rate(&self, item: usize) -> f64 {
        self.next[item][1]
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

    /// The element and the place of a kink, and its expression.
    pub fn place(&self, model: &Model, item: usize) -> (Origin, String) {
        let Item { element, kink, .. } = self.items[item];
        let kink = &model.class(element).kinks[kink];
        let origin = &model.compiled.system.elements[element].origin;
        let origin = Origin {
            defined_at: kink.defined_at.or(origin.defined_at),
            ..origin.clone()
        };
        (origin, kink.text.clone())
    }

    /// Values and rates at the last accepted state, changes of rates, largest values so far, passages and uses, for a
    /// checkpoint.
    pub fn numbers(&self) -> Vec<f64> {
        let pairs = self.now.iter().flatten();
        let counts = pairs.chain(&self.bends).chain(&self.peaks);
        let used = self.used.iter().map(|used| f64::from(u8::from(*used)));
        let counts = counts.chain(&self.stays).chain(&self.passages);
        let counts = counts.copied().chain(used);
        let clocks = self.clocks.iter().flat_map(Clock::numbers);
        let counts = counts.chain(self.points.numbers()).chain(clocks);
        let counts = counts.chain([self.times[0], self.phase_rate[0]]);
        counts.chain(self.slopes[0].iter().copied()).collect()
    }

    /// Sets them from a checkpoint.
    pub fn set_numbers(&mut self, numbers: &[f64]) {
        let (pairs, rest) = numbers.split_at((2 * self.now.len()).min(numbers.len()));
        for (now, pair) in self.now.iter_mut().zip(pairs.as_chunks::<2>().0) {
            *now = *pair;
        }
        let (counts, used) = rest.split_at((4 * self.now.len()).min(rest.len()));
        let bends = self.bends.iter_mut();
        let places = bends.chain(&mut self.peaks).chain(&mut self.stays);
        let places = places.chain(&mut self.passages);
        for (place, number) in places.zip(counts) {
            *place = *number;
        }
        let (used, points) = used.split_at(self.used.len().min(used.len()));
        for (place, number) in self.used.iter_mut().zip(used) {
            *place = *number != 0.0;
        }
        let mut rest = self.points.set_numbers(points);
        for clock in &mut self.clocks {
            rest = clock.set_numbers(rest);
        }
        if let [time, phase_rate, slopes @ ..] = rest {
            [self.times[0], self.phase_rate[0]] = [*time, *phase_rate];
            for known in &mut self.slopes {
                for (place, slope) in known.iter_mut().zip(slopes) {
                    *place = *slope;
                }
            }
        }
        self.measure_distances();
    }
}

fn limit(model: &Model, element: usize, kink: &Kink) -> Limit {
    if kink.course.is_of_time() {
        return Limit::Time;
    }
    let resolves = &model.compiled.system.elements[element].resolves;
    let stated = resolves.iter().map(|slot| model.slot(*slot));
    match (kink.dimension, kink.course) {
        (Some(Dimension::LENGTH), _) => {
            let stated = stated.min_by(f64::total_cmp);
            stated.map_or(Limit::Tolerance(model.tolerance), Limit::Stated)
        }
        (Some(Dimension::ANGLE), _) => Limit::Tolerance(model.tolerance / model.length),
        // the length that a class resolves may be the whole range of its functions, as the clearance is for a film
        (_, Course::Position) => Limit::Tolerance(model.tolerance),
        (Some(Dimension::TIME), _) => Limit::Time,
        _ => Limit::Share,
    }
}

/// Whether the function of a kink is a length or an angle, whose slopes are 1.
pub(crate) fn is_length(kink: &Kink) -> bool {
    matches!(kink.dimension, Some(Dimension::LENGTH | Dimension::ANGLE))
}

/// A function with its rate; the time since its change of sign, if its rate is constant and the function depends on time alone.
fn timed(course: Course, [value, rate]: [f64; 2]) -> [f64; 2] {
    if course == Course::Uniform && rate != 0.0 {
        [value / rate, 1.0]
    } else {
        [value, rate]
    }
}

/// The moment (s) at which a function of time alone is zero, from its value and rate at a time (s).
fn moment(function: Option<&[f64; 2]>, time: f64) -> f64 {
    let found = function.map_or(time, |[value, rate]| time - value / rate);
    if found.is_finite() { found } else { time }
}

/// Adds accelerations and rates of states to the inputs of elements.
fn add_accelerations(model: &Model, dynamics: &Dynamics, state: &State, batch: &mut Batch) {
    let layout = model.compiled.system.classes[batch.class].layout;
    for pair in 0..batch.pairs.len() {
        let members = batch.pairs[pair];
        let inputs = batch.inputs_mut(pair);
        for (lane, index) in members.iter().enumerate() {
            let element = &model.elements[*index];
            for (k, marker) in element.markers.iter().enumerate() {
                let Some(b) = model.markers[*marker].body else {
                    continue;
                };
                let body = &model.bodies[b];
                let range = body.velocity..body.velocity + body.width();
                let bias = dynamics.marker_bias(model, *marker, &state.velocity[range.clone()]);
                let along = dynamics.marker_along(model, *marker, &state.acceleration[range]);
                let at = layout.acceleration(k as u32) as usize;
                for (i, (bias, along)) in bias.iter().zip(along).enumerate() {
                    inputs[at + i][lane] = bias + along;
                }
            }
            for k in 0..layout.states {
                let rate = state.rates[element.state + k as usize];
                inputs[layout.state_rate(k) as usize][lane] = rate;
            }
        }
    }
}
