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
//! | another angle than one of places and time alone | this tolerance over the model's length |
//! | another function of places and time alone | its change when a body moves by the tolerance of positions ([`slopes`]) |
//! | a time, or a function of time alone | rounding: a moment is known exactly |
//! | anything else | 1e-5 of the largest value of g so far, the share that errors of states may have |
//!
//! A factor on the tolerances multiplies all but times. A factor above 1 does not multiply a stated length.
//!
//! A function counts in a step that uses it at the beginning or at the end: it does not count while an `if`
//! selects a branch without it. An angle of `wrapped` or `atan2` begins anew after a turn, and its functions
//! jump with it. Such a jump is no change of sign.
//!
//! The changes of sign of a function of time alone are searched ahead of the steps, and its kink functions are
//! the times since them. So no step passes two of them unseen.

mod clocks;
pub(crate) mod crossing;
mod location;
pub(crate) mod neighbours;
mod overlooked;
mod points;
mod slopes;

use crate::dynamics::Dynamics;
use crate::elements::{self, Batch, Inputs};
use crate::error::RuntimeError;
use crate::inputs::Signals;
use crate::model::Model;
use crate::state::State;
use clocks::{Change, Clock, KEPT};
use crossing::same_side;
use eng_system::code::{Function, Pair};
use eng_system::dimension::Dimension;
use eng_system::layout::InputLayout;
use eng_system::system::{Course, Kink, Origin};
use neighbours::Neighbours;
pub use overlooked::Overlooked;
use points::Points;
use slopes::Sloped;
use std::ops::Range;

/// A step that passes a kink, or ends close before it, adds this number to the count of the kink. Any other
/// step subtracts 1. So a kink that less than one step in 33 passes, such as a stop that is hit now and then,
/// never reaches the limit. A choice: a smaller number would let more frequent passages go on without a
/// message, a larger one would report a stop that is hit now and then.
const PASSED: f64 = 32.0;
/// A step ends close before a kink if it is at most so many steps of its length away from it. A motion that
/// comes to a kink and passes it then counts some five times. The limit is a choice: with one step, a motion
/// that the error control slows down before a kink would not count.
const CLOSE: f64 = 4.0;
/// The count at which the motion may be held at a kink: after 8 steps that pass it or end close before it, or
/// a few more with other steps between. A choice: a contact that settles in a few strokes is passed less
/// often.
const OFTEN: f64 = 256.0;
/// Largest change (rad) in a step of the argument of a sine in a function of the motion. The cubic through values and rates differs
/// from a sine by 1e-5 then, the share that errors of states may have. Narrower tips may be missed.
const PHASE: f64 = 0.25;

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
    /// Whether it jumps where an angle begins anew.
    wraps: bool,
    /// Whether it is zero where such an angle begins anew.
    cut: bool,
    /// Whether it is the argument of a table less one of its points.
    of_table: bool,
    /// Whether a jump of a load may hold the motion at the kink. It cannot at a kink of time, nor at one of
    /// places, whose rates do not jump.
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
    /// Index among the batches of the dynamics, which gather the inputs.
    batch: usize,
    /// Own inputs, if the rates of the functions need accelerations.
    own: Option<Batch>,
    /// Index of the first item.
    first: usize,
    /// Ranges of its clocks, and of its functions of places in `sloped`.
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
    /// Indices of the functions that constraints depend on.
    constraining: Vec<usize>,
    /// Changes of the rates over the last accepted step (1/s); zero where it passed the kink.
    bends: Vec<f64>,
    /// Largest magnitudes at accepted states.
    peaks: Vec<f64>,
    /// Number of successive steps that passed each kink; infinite for a kink at which no more steps end.
    stays: Vec<f64>,
    /// Counts of passages: [`PASSED`] more for a step that passes the kink or ends close to it, 1 less for
    /// another step.
    passages: Vec<f64>,
    /// The kink whose count came to [`OFTEN`] with the last step.
    often: Option<usize>,
    /// A kink of the motion that the last step passed.
    passed: Option<usize>,
    neighbours: Neighbours,
    points: Points,
    clocks: Vec<Clock>,
    /// The inputs at the times at which clocks search; `None` if some have values between two points of
    /// time that a program gives later.
    signals: Option<Signals>,
    sloped: Vec<Sloped>,
    /// Slopes of the functions at the last accepted state and at the last evaluation; 1 for those that are not in `sloped`.
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
            passed: None,
            neighbours: Neighbours::default(),
            points: Points::default(),
            clocks: Vec::new(),
            signals: Some(Signals::new(model)).filter(Signals::are_known),
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
                    let course = course(kink, kinks.signals.is_some());
                    let limit = limit(model, element, kink, course);
                    let item = Item {
                        element,
                        kink: k,
                        limit,
                        constrains: kink.constrains,
                        wraps: kink.wraps,
                        cut: kink.cut,
                        of_table: kink.table.is_some(),
                        holds: course == Course::Motion && limit != Limit::Time,
                    };
                    let first = kinks.items.len();
                    let count = match (kink.table, course) {
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
        let known_ahead = self.signals.is_some();
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
            let mut clocks = group.clocks.clone().zip(&self.clocks[group.clocks.clone()]);
            let mut touched = Vec::new();
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
                            let changes = match course(kink, known_ahead) {
                                Course::Time => clocks.next(),
                                _ => None,
                            };
                            let Some((index, clock)) = changes else {
                                self.next[at] = timed(kink.course, [value, rate]);
                                at += 1;
                                continue;
                            };
                            if value == 0.0 {
                                touched.push(index);
                            }
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
            for clock in touched {
                self.touch(model, dynamics, (index, clock))?;
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
        let [accepted, time] = self.times;
        for index in self.groups[group].clocks.clone() {
            if !self.clocks[index].is_short_of(time) {
                continue;
            }
            self.with_clock(model, dynamics, (group, index), |clock, function| {
                clock.search([accepted, time], function)
            })?;
            let clock = &self.clocks[index];
            let functions = clock.functions(accepted);
            self.now[clock.first..clock.first + KEPT].copy_from_slice(&functions);
        }
        Ok(())
    }

    /// Makes the time of the last evaluation a moment of a clock of a group, if its function only touches zero there.
    fn touch(
        &mut self,
        model: &Model,
        dynamics: &Dynamics,
        (group, index): (usize, usize),
    ) -> Result<(), RuntimeError> {
        let [accepted, time] = self.times;
        // the first evaluation is that of the start
        let now = if accepted.is_finite() { accepted } else { time };
        let touches = self.with_clock(model, dynamics, (group, index), |clock, function| {
            clock.touch(now, time, function)
        })?;
        if touches {
            let clock = &self.clocks[index];
            let items = clock.first..clock.first + KEPT;
            self.now[items.clone()].copy_from_slice(&clock.functions(accepted));
            self.next[items].copy_from_slice(&clock.functions(time));
        }
        Ok(())
    }

    /// A time (s), or one just after it if a function of time alone touches zero there: loads have another
    /// value at this single time.
    pub fn beside_touch(
        &mut self,
        model: &Model,
        dynamics: &Dynamics,
        time: f64,
    ) -> Result<f64, RuntimeError> {
        let mut beside = time;
        for group in 0..self.groups.len() {
            for index in self.groups[group].clocks.clone() {
                let place = (group, index);
                let width = self.with_clock(model, dynamics, place, |clock, mut function| {
                    clock.touches(time, &mut function)
                })?;
                beside = width.map_or(beside, |width| beside.max(time + width));
            }
        }
        Ok(beside)
    }

    /// Calls `run` with a clock of a group and its function: value and rate at a time (s).
    fn with_clock<R>(
        &mut self,
        model: &Model,
        dynamics: &Dynamics,
        (group, index): (usize, usize),
        run: impl FnOnce(
            &mut Clock,
            &mut dyn FnMut(f64) -> Result<[f64; 2], RuntimeError>,
        ) -> Result<R, RuntimeError>,
    ) -> Result<R, RuntimeError> {
        let batch = self.groups[group].batch(dynamics);
        let class = &model.compiled.system.classes[batch.class];
        let count = class.kinks.len();
        let clock = &mut self.clocks[index];
        let [pair, lane, k] = clock.place;
        let (inputs, out) = (&mut self.inputs, &mut self.out[..class.kink_outputs()]);
        inputs.clear();
        inputs.extend_from_slice(batch.inputs(pair));
        let moving = &model.elements[self.items[clock.first].element].moving;
        let mut signals = self.signals.as_mut().filter(|_| !moving.is_empty());
        run(clock, &mut |time: f64| {
            inputs[InputLayout::TIME as usize] = [time; 2];
            if let Some(signals) = &mut signals {
                signals.follow(model, time);
                for (constant, slot) in moving {
                    let at = class.layout.constant(*constant as u32) as usize;
                    if let Some(value) = signals.values().get(*slot) {
                        inputs[at][lane] = *value;
                    }
                }
            }
            elements::call(model, batch.class, Function::Kinks, inputs, out)?;
            Ok([out[k][lane], out[count + k][lane]])
        })
    }

    /// Forgets the moments of functions of time alone, because inputs have changed.
    pub fn forget_moments(&mut self, signals: &Signals) {
        self.set_signals(signals);
        for clock in &mut self.clocks {
            clock.forget();
        }
    }

    /// Sets the inputs.
    pub fn set_signals(&mut self, signals: &Signals) {
        if let Some(known) = &mut self.signals {
            known.clone_from(signals);
        }
    }

    /// The change of sign from which the function of a clock counts; `None` for other functions.
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
        let mut changes = self.now.iter().zip(&self.next).enumerate();
        let passed = changes.find(|(item, (from, to))| {
            from[0] * to[0] < 0.0 && self.items[*item].limit != Limit::Time && self.used[*item]
        });
        self.passed = passed.map(|(item, _)| item);
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

    /// A kink of the motion that the last step passed.
    pub fn last_passed(&self) -> Option<usize> {
        self.passed
    }

    /// Whether the function of a kink is a length, an angle or another one of places.
    pub fn is_way(&self, item: usize) -> bool {
        self.items.get(item).is_some_and(Item::is_way)
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

    /// Sets the numbers of [`Kinks::numbers`] from a checkpoint.
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

/// The quantities on which a kink function depends. If all inputs are known ahead, one of inputs is one of time.
fn course(kink: &Kink, known_ahead: bool) -> Course {
    match kink.course {
        Course::Inputs if known_ahead && kink.table.is_none() => Course::Time,
        course => course,
    }
}

fn limit(model: &Model, element: usize, kink: &Kink, course: Course) -> Limit {
    if course.is_of_time() {
        return Limit::Time;
    }
    let resolves = &model.compiled.system.elements[element].resolves;
    let stated = resolves.iter().map(|slot| model.slot(*slot));
    match (kink.dimension, course) {
        (Some(Dimension::LENGTH), _) => {
            let stated = stated.min_by(f64::total_cmp);
            stated.map_or(Limit::Tolerance(model.tolerance), Limit::Stated)
        }
        // the length that a class resolves may be the whole range of its functions, as the clearance is for a film
        (_, Course::Position) => Limit::Tolerance(model.tolerance),
        (Some(Dimension::ANGLE), _) => Limit::Tolerance(model.tolerance / model.length),
        (Some(Dimension::TIME), _) => Limit::Time,
        _ => Limit::Share,
    }
}

/// Whether the function of a kink is a length, whose slope is 1. That of an angle may be much steeper, as of `atan2(x, 1 um)`.
pub(crate) fn is_length(kink: &Kink) -> bool {
    kink.dimension == Some(Dimension::LENGTH)
}

/// A function with its rate. If the function depends on time alone at a constant rate: the time since its
/// change of sign, with the rate 1.
fn timed(course: Course, [value, rate]: [f64; 2]) -> [f64; 2] {
    if course == Course::Uniform && rate != 0.0 {
        [value / rate, 1.0]
    } else {
        [value, rate]
    }
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
