//! The derivatives of a motion that repeats by parameters.
//!
//! The state x at an angle of the cycle obeys `x = F(x, p)`, with F the motion over a cycle. So its derivative obeys
//! `δx = F_x δx + F_p`. Derivatives that follow the motion over cycles obey the recursion `δx(k+1) = F_x δx(k) + F_p`. It
//! shrinks deviations like the motion itself, because F_x is the same. The analysis carries the derivatives over cycles behind
//! the last one, until those of all channels repeat at the samples of the cycle. The motion goes on there as it was.
//!
//! **Acceleration.** The recursion is linear, and F_x is common to all parameters. So the differences of consecutive states
//! and those of their images show parts of F_x, whichever parameter they belong to. With them the least residual leads towards
//! the limit (D. G. Anderson, J. ACM 12 (1965) 547; for a linear recursion it is GMRES: H. F. Walker, P. Ni, SIAM J. Numer.
//! Anal. 49 (2011) 1715). At least two plain cycles decide about repetition.
//!
//! **What the motion keeps.** If a deviation neither decays nor grows, such as a turn of a free body, F_x has the eigenvalue 1.
//! Then the start decides this part of the motion, and the equation for δx does not. A random deviation goes along and
//! shows such a part: it is refused if it changes a channel.
//!
//! **States that grow.** A state that nothing reads, such as a work, may grow by the same amount in each cycle. It is left out of
//! all sizes and comparisons, and its channels have the derivatives of their growth since the beginning of the cycle.

use super::PLAIN;
use super::repetition::{Growth, slowest};
use crate::decay::SUSTAINED;
use crate::error::{Moment, RuntimeError};
use crate::integrator::Variation;
use crate::model::Model;
use crate::simulation::{Gradients, SampleGradient, Units, Warning};
use crate::transient::{Advance, Observer, Onwards, follow, parameters_of};
use eng_system::code::Compiled;
use eng_system::dense::{dot, largest};
use eng_system::dimension::Dimension;
use eng_system::significant::short;
use eng_system::system::Periodic;
use nalgebra::{DMatrix, DVector};
use std::collections::VecDeque;

/// Multiple of the requested change at which the derivatives of the state count as near their limit, so that all samples of
/// the next cycle are of use. A choice: this cycle and the next one bring them nearer. If channels then change too much, the
/// multiple falls by as much, within these limits: a channel may be a small difference of large numbers.
const NEAR: f64 = 3.0;
const NEARER: [f64; 2] = [1e-2, 0.3];
/// Share of a residual above which it counts as slow, so that an acceleration is of use; and the largest share that an
/// acceleration may leave. Choices: a tenth is lost in each plain cycle, and a fit that leaves more than half is none.
const SLOW: f64 = 0.1;
const LEFT: f64 = 0.5;
/// Cycles in which no derivative comes nearer to its limit, after which the samples decide. A choice: an acceleration may
/// fail once or twice.
const STANDING: u32 = 3;
/// Differences that are kept, and the share of the largest singular value below which a part of them is rounding.
const KEPT: usize = 24;
const SINGULAR: f64 = 1e-9;
/// Largest number of a random deviation that is left when it has decayed; the largest share by which it changes in a cycle if it
/// does not decay; and the share that a fit to a decay may leave, of the deviation and of its unit. Choices: its numbers begin
/// between −1 and 1, so a part that stays is seldom below a hundredth, however many bodies there are; and a decay by less than
/// two per cent a cycle would take hundreds of cycles.
const DECAYED: f64 = 1e-2;
const KEEPS: f64 = 0.02;
const DESCRIBED: f64 = 0.03;
/// Share of the size of a channel, for a deviation by the size of the model, below which this deviation does not change the
/// channel; and the rounding of positions as a share of the model's length. Choices: the first is far below all that counts, and
/// the second is ten rounding units.
const UNTOUCHED: f64 = 1e-6;
const ROUNDING: f64 = 1e-15;
/// Least size of a derivative: as a share of the largest one of the same dimension (except lengths), and of the size of
/// channels of this dimension over the parameter. Choices: the first is that of swings of channels, and a derivative below
/// the second changes a channel by less than a hundredth if the parameter doubles.
const LEAST: [f64; 2] = [1e-2, 1e-2];
/// Share of the least change so far above which the changes of derivatives no longer shrink, the number of such cycles, and the
/// largest change that may then be noise of the steps. Choices: those of the motion itself, and a tenth is still of use.
const STANDSTILL: f64 = 0.5;
const NOISY_CYCLES: u32 = 3;
const NOISE: f64 = 0.1;
/// The part of the progress that the motion takes, if derivatives follow.
pub(super) const OF_MOTION: f64 = 0.5;

/// The derivatives at a sample by a parameter (SI).
#[derive(Clone, Debug, Default)]
pub(super) struct Row {
    time: f64,
    cycle: [f64; 2],
    channels: Vec<f64>,
}

impl Row {
    fn of(sample: &SampleGradient<'_>) -> Row {
        Row {
            time: sample.time,
            cycle: sample.cycle,
            channels: sample.channels.to_vec(),
        }
    }

    pub(super) fn sample(&self) -> SampleGradient<'_> {
        SampleGradient {
            time: self.time,
            cycle: self.cycle,
            channels: &self.channels,
        }
    }
}

/// The derivatives by each parameter at each sample of a cycle, with both ends.
pub(super) type Rows = Vec<Vec<Row>>;

/// The last cycle of a motion that repeats.
pub(super) struct Repeated<'a> {
    pub compiled: &'a Compiled,
    pub limit: &'a Periodic,
    pub period: f64,
    /// Samples of a cycle, without its beginning.
    pub samples: usize,
    /// Channels at the samples of the last cycle.
    pub values: &'a [f64],
    /// Channels that grow in each cycle.
    pub growing: &'a [Growth],
    /// The states that differ between the beginning and the end of the last cycle.
    pub moving: Vec<bool>,
    /// The smallest length that the model resolves (m).
    pub length: f64,
}

/// Derivatives by a parameter, or of the deviation, at the beginning and at the end of a cycle.
#[derive(Clone, Debug, Default)]
struct Carried {
    /// At the beginning of the present cycle.
    begin: Variation,
    /// At the end of the cycle before, without an acceleration.
    end: Variation,
    /// The change over the last cycle (in units), which is the residual, and its norm in the cycle before.
    residual: Vec<f64>,
    before: Option<f64>,
    /// Plain cycles since the last acceleration.
    plain: usize,
}

impl Carried {
    /// The factor by which the residual shrinks in a plain cycle.
    fn factor(&self) -> Option<f64> {
        let now = norm(&self.residual);
        self.before
            .filter(|before| self.plain > 1 && *before > 0.0)
            .map(|before| now / before)
    }
}

/// A difference of two states, and that of their images.
#[derive(Clone, Debug)]
struct Pair {
    /// The image less the state, in units.
    residual: Vec<f64>,
    image: Variation,
}

fn norm(x: &[f64]) -> f64 {
    libm::sqrt(dot(x, x))
}

fn refused(message: String) -> RuntimeError {
    RuntimeError::Options { message }
}

impl Repeated<'_> {
    /// The derivatives by the parameters of an analysis. `onwards` is the motion behind the last cycle.
    ///
    /// # Errors
    /// A model, a parameter or a motion without derivatives; derivatives that do not repeat.
    pub(super) fn gradients(
        &self,
        overrides: &[Option<f64>],
        onwards: &mut Onwards,
        observer: &mut dyn Observer,
    ) -> Result<Rows, RuntimeError> {
        let parameters = parameters_of(self.compiled, &self.limit.gradients)?;
        let simulation = &mut onwards.simulation;
        let gradients = Gradients::of_repeated(self.compiled, overrides, &parameters, simulation)?;
        let units = Units::of(simulation);
        let count = gradients.count();
        // an increment displaces markers by `reach`; the share of rounding in a difference of films is
        // that of the positions in the film, over that of the increment in the model
        let size = simulation.model().length;
        let rounding = ROUNDING * (size / self.length) * (size / gradients.reach());
        let mut cycles = Cycles {
            of: self,
            gradients,
            units,
            integrals: self.moving.clone(),
            untouched: UNTOUCHED.max(rounding),
            carried: vec![Carried::default(); count],
            pairs: Vec::new(),
            deviations: VecDeque::new(),
            done: 0,
            near: NEAR,
            least: f64::INFINITY,
            standing: 0,
            ends: Vec::new(),
            progress: OF_MOTION,
        };
        cycles.run(onwards, observer)
    }

    /// The largest value of all numbers with the dimension of each channel, from the largest value of each.
    fn alike(&self, largest: &[f64]) -> Vec<f64> {
        let channels = &self.compiled.system.channels;
        let mut sizes: Vec<(Dimension, f64)> = Vec::new();
        for (channel, size) in channels.iter().zip(largest) {
            match sizes.iter_mut().find(|(of, _)| *of == channel.dimension) {
                Some((_, most)) => *most = most.max(*size),
                None => sizes.push((channel.dimension, *size)),
            }
        }
        let size = |of: Dimension| sizes.iter().find(|(known, _)| *known == of);
        let found = channels.iter().map(|channel| size(channel.dimension));
        found
            .map(|size| size.map_or(0.0, |(_, most)| *most))
            .collect()
    }

    /// The size of each channel: of lengths the smallest resolved one, of angles a radian, of other dimensions the largest
    /// value.
    fn sizes(&self) -> Vec<f64> {
        let channels = &self.compiled.system.channels;
        let count = channels.len().max(1);
        let mut most = vec![0.0_f64; channels.len()];
        for sample in self.values.chunks(count) {
            for (most, x) in most.iter_mut().zip(sample) {
                *most = most.max(x.abs());
            }
        }
        let mut sizes = self.alike(&most);
        for (size, channel) in sizes.iter_mut().zip(channels) {
            if channel.dimension == Dimension::LENGTH {
                *size = self.length;
            } else if channel.dimension == Dimension::ANGLE {
                *size = 1.0;
            }
        }
        sizes
    }
}

/// What deviations of the motion do from cycle to cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Deviation {
    /// They decay; the sum of all later changes is this multiple of a change.
    Decays(f64),
    /// They grow.
    Grows,
    /// A part of them stays.
    Stays,
    /// The cycles do not show it yet.
    Open,
}

/// Derivatives that follow the motion over cycles.
struct Cycles<'a> {
    of: &'a Repeated<'a>,
    gradients: Gradients,
    units: Units,
    /// The states that grow and that nothing reads; in the first cycle those of which this is still possible.
    integrals: Vec<bool>,
    /// The share of the size of channels that a deviation by a unit may change without an effect.
    untouched: f64,
    /// Of each parameter, and of the deviation behind them.
    carried: Vec<Carried>,
    pairs: Vec<Pair>,
    /// The deviation at the ends of the last cycles (in units), the newest first.
    deviations: VecDeque<Vec<f64>>,
    done: u32,
    /// The multiple of the requested change at which the state is near its limit.
    near: f64,
    /// The least residual so far as a share of the derivatives, and the number of cycles since then.
    least: f64,
    standing: u32,
    /// The samples at the end of the last cycle.
    ends: Vec<Row>,
    progress: f64,
}

/// The channel whose derivative by a parameter changes most, and its change from cycle to cycle as a share of its size.
#[derive(Clone, Copy, Debug)]
struct Slowest {
    parameter: usize,
    channel: usize,
    change: f64,
    /// The same with the estimated distance to the limit.
    distance: f64,
}

impl Cycles<'_> {
    /// Carries the derivatives over cycles until they repeat.
    fn run(
        &mut self,
        onwards: &mut Onwards,
        observer: &mut dyn Observer,
    ) -> Result<Rows, RuntimeError> {
        let parameters = self.carried.len() - 1;
        let mut before: Option<Rows> = None;
        let mut slowest = None;
        // the least change of channels so far, and the number of cycles without a smaller one
        let (mut least, mut noisy) = (f64::INFINITY, 0);
        while self.done < self.of.limit.cycles {
            let last = self.done + 2 >= self.of.limit.cycles && self.done > 0;
            let whole = last || self.near();
            let watched = whole && !matches!(self.deviation(), Deviation::Decays(_));
            let mut rows = self.cycle(onwards, observer, whole, watched)?;
            self.done += 1;
            self.refuse_infinite(onwards)?;
            if !whole {
                before = None;
                self.accelerate();
                continue;
            }
            let decays = matches!(self.deviation(), Deviation::Decays(_));
            let decided = !watched || decays || self.untouched(rows.last());
            rows.truncate(parameters);
            self.since_the_beginning(&mut rows);
            if let Some(before) = &before {
                slowest = self.slowest(before, &rows);
                let limit = self.of.limit.change;
                let repeats = slowest.is_none_or(|slowest| {
                    slowest.change <= PLAIN * limit
                        || (slowest.change <= limit && slowest.distance <= limit)
                });
                if repeats && decided {
                    return Ok(rows);
                }
                if repeats && self.deviation() == Deviation::Stays {
                    break;
                }
                if let Some(slowest) = slowest.filter(|_| !repeats) {
                    let shrinks = slowest.change <= STANDSTILL * least;
                    noisy = if shrinks { 0 } else { noisy + 1 };
                    least = least.min(slowest.change);
                    if decays && noisy >= NOISY_CYCLES && slowest.change <= NOISE {
                        self.warn_of_noise(onwards, observer, slowest);
                        return Ok(rows);
                    }
                    let [most, least] = NEARER;
                    self.near *= (limit / slowest.change.max(slowest.distance)).clamp(most, least);
                    if !self.near() {
                        self.accelerate();
                    }
                }
            }
            before = Some(rows);
        }
        Err(self.without_end(onwards, slowest))
    }

    /// Carries all derivatives over a cycle. Returns the samples of the whole cycle, or none. `watched` samples the
    /// deviation, too.
    fn cycle(
        &mut self,
        onwards: &mut Onwards,
        observer: &mut dyn Observer,
        whole: bool,
        watched: bool,
    ) -> Result<Rows, RuntimeError> {
        let last = self.of.samples as u64;
        let mut rows: Rows = self.ends.iter().map(|row| vec![row.clone()]).collect();
        let mut values = vec![0.0; self.of.compiled.system.channels.len()];
        let from = onwards.simulation.cycle_angle().unwrap_or(0.0);
        let mut turned = 0.0;
        loop {
            while let Some((index, angle)) = onwards.passed() {
                let ends = index >= last;
                if !whole && !ends {
                    continue;
                }
                let simulation = &mut onwards.simulation;
                simulation.sample_at_angle(angle, &mut values)?;
                observer.sampled();
                self.gradients.sample_deviation(watched || ends);
                let mut sampled = Vec::with_capacity(rows.len());
                (self.gradients).sample(simulation, Some(angle), &mut |_, sample| {
                    sampled.push(Row::of(&sample));
                })?;
                for (rows, row) in rows.iter_mut().zip(&sampled) {
                    rows.push(row.clone());
                }
                if ends {
                    self.end(onwards, sampled);
                    onwards.begin_cycle(angle);
                    return Ok(if whole { rows } else { Vec::new() });
                }
            }
            let step = onwards.step()?;
            if step > 0.0 {
                self.gradients.follow(&mut onwards.simulation, step)?;
                let some = self.done == 0 && self.integrals.contains(&true);
                if some && self.gradients.reads(&onwards.simulation, &self.integrals)? {
                    self.integrals.fill(false);
                }
            }
            onwards.stepped(step);
            observer.stepped();
            for warning in onwards.simulation.take_warnings() {
                observer.warning(&warning);
            }
            let now = onwards.simulation.cycle_angle().unwrap_or(from) - from;
            let part = (now.abs() - turned) / self.of.period;
            turned = now.abs();
            // a part of the rest, so that it grows in every cycle
            self.progress += (1.0 - self.progress) * (0.25 * part).clamp(0.0, 0.25);
            let advance = Advance::new(&onwards.simulation, self.progress);
            follow(&onwards.simulation, observer, &advance, false)?;
        }
    }

    /// Keeps the derivatives at the end of a cycle, and what they differ from those at its beginning.
    fn end(&mut self, onwards: &Onwards, sampled: Vec<Row>) {
        let times: Vec<f64> = sampled.iter().map(|row| row.time).collect();
        let sections = self.gradients.sections(&onwards.simulation, &times);
        let deviation = self.carried.len() - 1;
        let first = self.ends.is_empty();
        if first {
            self.units.leave_out(&self.integrals);
        }
        for (index, (carried, section)) in self.carried.iter_mut().zip(sections).enumerate() {
            let image = self.units.numbers(&section);
            if !first {
                let begin = self.units.numbers(&carried.begin);
                let residual: Vec<f64> = image.iter().zip(&begin).map(|(a, b)| a - b).collect();
                carried.before = (!carried.residual.is_empty()).then(|| norm(&carried.residual));
                if index == deviation {
                    // without a parameter the state itself is a difference of two
                    self.pairs.push(Pair {
                        residual: residual.clone(),
                        image: section.clone(),
                    });
                } else if !carried.residual.is_empty() {
                    let between = residual.iter().zip(&carried.residual);
                    let mut image = section.clone();
                    image.add(-1.0, &carried.end);
                    self.pairs.push(Pair {
                        residual: between.map(|(a, b)| a - b).collect(),
                        image,
                    });
                }
                carried.residual = residual;
                carried.plain += 1;
            }
            if index == deviation {
                self.deviations.push_front(image);
                self.deviations.truncate(3);
            }
            carried.begin.clone_from(&section);
            carried.end = section;
        }
        let surplus = self.pairs.len().saturating_sub(KEPT);
        self.pairs.drain(..surplus);
        self.ends = sampled;
        // the clocks now hold there
        for row in &mut self.ends {
            row.time = 0.0;
        }
    }

    /// Leads derivatives that approach their limit slowly towards it. Counts the cycles in which none comes nearer.
    fn accelerate(&mut self) {
        let left = self.carried.iter().map(|carried| {
            norm(&carried.residual) / norm(&self.units.numbers(&carried.end)).max(f64::MIN_POSITIVE)
        });
        let left = left.take(self.carried.len() - 1).fold(0.0, f64::max);
        if left > 0.0 && left < self.least {
            self.least = left;
            self.standing = 0;
        } else if self.least.is_finite() {
            self.standing += 1;
        }
        // the samples at the end of a cycle begin the next one, so an acceleration must not lie between two whole cycles
        if self.standing >= STANDING || self.done + 2 >= self.of.limit.cycles {
            return;
        }
        let near = self.near * self.of.limit.change;
        let deviation = self.carried.len() - 1;
        for (index, carried) in self.carried.iter_mut().enumerate().take(deviation) {
            let left = norm(&carried.residual);
            let size = norm(&self.units.numbers(&carried.end));
            let slow = carried.before.is_some_and(|before| left > SLOW * before);
            if !slow || left <= near * size {
                continue;
            }
            let Some(weights) = least(&self.pairs, &carried.residual) else {
                continue;
            };
            for (pair, weight) in self.pairs.iter().zip(&weights) {
                carried.begin.add(-weight, &pair.image);
                self.gradients.move_section(index, -weight, &pair.image);
            }
            carried.plain = 0;
        }
    }

    /// Whether the derivatives of the state are near their limit, or come no nearer, so that the next cycle may be the result.
    fn near(&self) -> bool {
        if self.standing >= STANDING {
            return true;
        }
        let deviation = self.carried.len() - 1;
        let reach = self.reach();
        self.carried.iter().take(deviation).all(|carried| {
            let size = norm(&self.units.numbers(&carried.end));
            let left = norm(&carried.residual) * reach.max(1.0);
            !carried.residual.is_empty()
                && carried.plain > 0
                && left <= self.near * self.of.limit.change * size
        })
    }

    /// The sum of all later changes of a deviation over its last one; zero if the cycles do not show it.
    fn reach(&self) -> f64 {
        match self.deviation() {
            Deviation::Decays(reach) => reach,
            Deviation::Grows | Deviation::Stays | Deviation::Open => 0.0,
        }
    }

    /// What the random deviation shows.
    fn deviation(&self) -> Deviation {
        let (Some(now), Some(before)) = (self.deviations.front(), self.deviations.get(1)) else {
            return Deviation::Open;
        };
        let oldest = self.deviations.get(2).map_or(&[][..], |oldest| oldest);
        let size = norm(now);
        let differs = |by: &dyn Fn(usize) -> f64| {
            let rest: Vec<f64> = now.iter().enumerate().map(|(i, x)| x - by(i)).collect();
            norm(&rest)
        };
        let fit = slowest([now, before, oldest], 1);
        if let Some(fit) = fit {
            let [a, b] = fit.recurrence;
            let left = differs(&|i| a * before[i] + b * oldest.get(i).unwrap_or(&0.0));
            let apart = (1.0 - a - b).abs();
            if apart > KEEPS && left <= DESCRIBED * apart * size {
                // a part that stays is of the size of the units, however large the rest is
                if fit.mode.factor < 1.0 && left <= DESCRIBED * apart {
                    return Deviation::Decays(fit.mode.reach());
                }
                if fit.mode.factor > SUSTAINED {
                    return Deviation::Grows;
                }
            }
        }
        if largest(now) <= DECAYED {
            let factor = fit.map_or(0.0, |fit| fit.mode.factor.min(0.5));
            return Deviation::Decays(factor / (1.0 - factor));
        }
        if differs(&|i| before[i]) <= KEEPS * size {
            return Deviation::Stays;
        }
        Deviation::Open
    }

    /// Whether the deviation, by its samples, changes no channel.
    fn untouched(&self, rows: Option<&Vec<Row>>) -> bool {
        let (Some(rows), Some(deviation)) = (rows, self.carried.last()) else {
            return true;
        };
        let most = self.untouched * largest(&self.units.numbers(&deviation.end));
        let sizes = self.of.sizes();
        rows.iter().all(|row| {
            let pairs = row.channels.iter().zip(&sizes);
            pairs.clone().all(|(x, size)| x.abs() <= most * size)
        })
    }

    /// Refuses derivatives that are not finite.
    fn refuse_infinite(&self, onwards: &Onwards) -> Result<(), RuntimeError> {
        let infinite = |of: &Carried| !norm(&self.units.numbers(&of.end)).is_finite();
        let Some(index) = self.carried.iter().position(infinite) else {
            return Ok(());
        };
        if index + 1 == self.carried.len() {
            return Err(refused(self.grows(onwards)));
        }
        let parameter = self.gradients.parameter(index);
        Err(refused(format!(
            "the gradients by {} grow beyond all numbers from cycle to cycle: the motion is unstable; compare two runs",
            parameter.map_or("a parameter", |(origin, _)| origin.path.as_str())
        )))
    }

    /// The part of the motion that deviates most: the path of a body or of an element with states.
    fn deviating<'m>(&'m self, model: &'m Model) -> &'m str {
        let mut known = self.deviations.iter();
        let finite = |numbers: &&Vec<f64>| norm(numbers).is_finite();
        let numbers = known.find(finite).map_or(&[][..], |numbers| numbers);
        let share = |from: usize, count: usize| numbers.get(from..from + count).map_or(0.0, norm);
        let bodies = model.bodies.iter().map(|body| {
            let places = share(body.velocity, body.width());
            let velocities = share(model.velocities + body.velocity, body.width());
            (places.max(velocities), body.origin.path.as_str())
        });
        let system = &self.of.compiled.system;
        let elements = model.elements.iter().zip(&system.elements);
        let elements = elements.map(|(element, info)| {
            let states = system
                .classes
                .get(element.class)
                .map_or(0, |c| c.states.len());
            let states = share(2 * model.velocities + element.state, states);
            (states, info.origin.path.as_str())
        });
        let most = bodies.chain(elements).max_by(|a, b| a.0.total_cmp(&b.0));
        most.map_or("a state", |(_, path)| path)
    }

    /// The reason of a motion that is unstable.
    fn grows(&self, onwards: &Onwards) -> String {
        format!(
            "the motion has no gradients: a deviation of {} grows from cycle to cycle, so the motion is unstable; damp this motion, or compare \
             two runs",
            self.deviating(onwards.simulation.model())
        )
    }

    /// Derivatives of channels that grow in each cycle are those of their growth since its beginning: the channel's value
    /// depends on the number of cycles. Angles and lengths keep their own derivatives, unless these grow too: such a derivative
    /// is that of a place at the cycle's angle. Times are those since the beginning of the cycle.
    fn since_the_beginning(&self, rows: &mut Rows) {
        for rows in rows {
            let (Some(first), Some(last)) = (rows.first().cloned(), rows.last().cloned()) else {
                continue;
            };
            for row in rows.iter_mut() {
                row.time -= first.time;
            }
            for growth in self.of.growing {
                let value = |row: &Row| row.channels.get(growth.channel).copied().unwrap_or(0.0);
                let size = rows
                    .iter()
                    .fold(0.0_f64, |most, row| most.max(value(row).abs()));
                let grows = (value(&last) - value(&first)).abs() > self.of.limit.change * size;
                let channel = self.of.compiled.system.channels.get(growth.channel);
                let place = channel.is_some_and(|channel| {
                    [Dimension::ANGLE, Dimension::LENGTH].contains(&channel.dimension)
                });
                if place && !grows {
                    continue;
                }
                for row in rows.iter_mut() {
                    if let Some(x) = row.channels.get_mut(growth.channel) {
                        *x -= value(&first);
                    }
                }
            }
        }
    }

    /// The derivative that changes most from a cycle to the next one.
    fn slowest(&self, before: &Rows, now: &Rows) -> Option<Slowest> {
        let channels = &self.of.compiled.system.channels;
        let sizes = self.of.sizes();
        let mut slowest: Option<Slowest> = None;
        for (parameter, (before, now)) in before.iter().zip(now).enumerate() {
            let size = self.gradients.parameter(parameter).map_or(1.0, |p| p.1);
            let mut changes = vec![0.0_f64; channels.len()];
            let mut most = changes.clone();
            for (before, now) in before.iter().zip(now) {
                for (channel, (a, b)) in before.channels.iter().zip(&now.channels).enumerate() {
                    changes[channel] = changes[channel].max((a - b).abs());
                    most[channel] = most[channel].max(b.abs());
                }
            }
            let alike = self.of.alike(&most);
            // a small residual may be that of a faster motion, or rounding: the deviation shows the slowest motion
            let factor = (self.carried.get(parameter)).and_then(Carried::factor);
            let reach = match (self.deviation(), factor) {
                (Deviation::Decays(reach), _) => reach,
                (_, Some(factor)) if factor < 1.0 => factor / (1.0 - factor),
                (_, Some(_)) => f64::INFINITY,
                (_, None) => 1.0,
            };
            for (channel, info) in channels.iter().enumerate().filter(|(_, c)| c.continuous) {
                let alike = if info.dimension == Dimension::LENGTH {
                    0.0
                } else {
                    LEAST[0] * alike[channel]
                };
                let least = alike.max(LEAST[1] * sizes[channel] / size);
                let change = changes[channel] / most[channel].max(least).max(f64::MIN_POSITIVE);
                if slowest.is_none_or(|slowest| change > slowest.change) {
                    let distance = if change > 0.0 { change * reach } else { 0.0 };
                    slowest = Some(Slowest {
                        parameter,
                        channel,
                        change,
                        distance,
                    });
                }
            }
        }
        slowest
    }

    /// Gives a warning for derivatives that repeat but for noise of the steps.
    fn warn_of_noise(&self, onwards: &Onwards, observer: &mut dyn Observer, slowest: Slowest) {
        let Some((origin, _)) = self.gradients.parameter(slowest.parameter) else {
            return;
        };
        let channel = self.of.compiled.system.channels.get(slowest.channel);
        let simulation = &onwards.simulation;
        observer.warning(&Warning {
            name: String::new(),
            origin: origin.clone(),
            message: format!(
                "the gradients by {} repeat but for noise of the steps: the derivative of {} changes by {} % of its size from cycle to cycle; \
                 state a smaller `tolerance`",
                origin.path,
                channel.map_or("a channel", |channel| channel.path.as_str()),
                short(100.0 * slowest.change, 2)
            ),
            label: "the derivatives by it have noise",
            moment: Moment {
                time: simulation.time(),
                cycle_angle: simulation.cycle_angle(),
            },
        });
    }

    /// The reason for derivatives that do not repeat.
    fn without_end(&self, onwards: &Onwards, slowest: Option<Slowest>) -> RuntimeError {
        let system = &self.of.compiled.system;
        let deviating = self.deviating(onwards.simulation.model());
        match self.deviation() {
            Deviation::Decays(_) => {}
            Deviation::Grows => return refused(self.grows(onwards)),
            Deviation::Stays => {
                return refused(format!(
                    "the motion has no gradients: a deviation of {deviating} does not decay from cycle to cycle, so its start decides the \
                     repeated motion and not the parameters alone; hold or damp this motion, or compare two runs"
                ));
            }
            Deviation::Open => {
                return refused(format!(
                    "the motion has no gradients: {} cycles do not show whether a deviation of {deviating} decays; state larger `cycles`, damp \
                     this motion, or compare two runs",
                    self.done
                ));
            }
        }
        let parameter = slowest.and_then(|slowest| self.gradients.parameter(slowest.parameter));
        let channel = slowest.and_then(|slowest| system.channels.get(slowest.channel));
        let change = slowest.map_or(f64::NAN, |slowest| slowest.change.max(slowest.distance));
        refused(format!(
            "the gradients by {} do not repeat within {} cycles: the derivative of {} is still {} % of its size away from its limit; state \
             larger `cycles`, or compare two runs",
            parameter.map_or("a parameter", |(origin, _)| origin.path.as_str()),
            self.done,
            channel.map_or("a channel", |channel| channel.path.as_str()),
            short(100.0 * change, 2)
        ))
    }
}

/// The weights with which differences leave the least residual; `None` if much of it is left.
fn least(pairs: &[Pair], residual: &[f64]) -> Option<Vec<f64>> {
    if pairs.is_empty() {
        return None;
    }
    let columns: Vec<DVector<f64>> = pairs
        .iter()
        .map(|pair| DVector::from_column_slice(&pair.residual))
        .collect();
    // each difference counts by its direction
    let norms: Vec<f64> = columns
        .iter()
        .map(|c| c.norm().max(f64::MIN_POSITIVE))
        .collect();
    let scaled: Vec<DVector<f64>> = columns.iter().zip(&norms).map(|(c, n)| c / *n).collect();
    let matrix = DMatrix::from_columns(&scaled);
    let wanted = DVector::from_column_slice(residual);
    let found = matrix
        .clone()
        .svd(true, true)
        .solve(&wanted, SINGULAR)
        .ok()?;
    let left = (matrix * &found - &wanted).norm();
    let weights: Vec<f64> = found.iter().zip(&norms).map(|(x, n)| x / n).collect();
    let fits = left <= LEFT * wanted.norm() && weights.iter().all(|x| x.is_finite());
    fits.then_some(weights)
}
