//! The differences of a cycle from the one before, and the rate at which they shrink.

use crate::decay::{Decay, Mode};
use eng_system::dense::largest;
use eng_system::dimension::{BASES, Dimension};
use eng_system::system::System;
use std::borrow::Cow;
use std::collections::VecDeque;
use std::f64::consts::PI;

/// Share of the largest value of a dimension (for angles: of the largest swing) below which a channel's own
/// swing does not count, because the error of the steps is as large. A choice: with a much smaller share the
/// error of the steps in a small channel would pass for a change from cycle to cycle, with a larger one a
/// real change in it would be overlooked.
const LEAST_SWING: f64 = 1e-2;
/// Least swing of an angle (rad). A choice: a swing below 0.006° is that of a body that hardly turns.
const LEAST_ANGLE: f64 = 1e-4;
/// Share of the loads that follow from a model's mass, size and speed, below which a load is rounding. A
/// choice some decades above the rounding unit, because reactions are differences.
const ROUNDING: f64 = 1e-9;
/// Share of a growth by which it may vary within a cycle and from the last cycle. A choice: a count or a sum
/// grows equally, and a decaying channel does not.
const STEADY: f64 = 1e-3;
/// Share of a counted swing below which a channel counts as constant. A choice: if every channel stays below
/// it, the cycle says nothing about a motion. A larger share would take a small real motion for rest.
const STANDING: f64 = 1e-3;
/// Squared sine between two differences below which they have one direction: 1.8°. A choice: the fit to two
/// differences of one direction would divide by noise.
const PARALLEL: f64 = 1e-3;
/// Number of samples below which a difference says nothing about its prediction. A choice: two factors fit
/// two samples exactly, and of four they leave half.
const FEW_SAMPLES: f64 = 4.0;
/// Number of parts of a cycle, of which the first and the last show the decay within the cycle. A choice: a part of 45° of
/// 720° contains no single zero of a vibration alone, and what a film loses in it is not much.
const WINDOWS: usize = 16;

/// A channel that grows by the same amount every cycle.
#[derive(Clone, Debug, PartialEq)]
pub struct Growth {
    /// Index of the channel.
    pub channel: usize,
    /// Per cycle (SI).
    pub by: f64,
}

/// The result of a comparison.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Verdict {
    /// The channel that changes most; absent after the first cycle and without channels.
    pub slowest: Option<Decay>,
    /// The factor that its last difference shows by itself ([`within`]).
    pub within: Option<f64>,
    /// Channels that grow.
    pub growing: Vec<Growth>,
}

/// Compares cycles of samples, each `channels` numbers long.
#[derive(Clone, Debug)]
pub struct Comparison {
    dimensions: Vec<Dimension>,
    /// Whether a channel is continuous. Others need not repeat.
    continuous: Vec<bool>,
    /// Least swing of a length (m). The largest length, such as a stroke, would be no measure for a film.
    length: f64,
    /// Mass (kg) and size (m) of the model and the rate of its cycle (rad/s), which determine its loads.
    scale: [f64; 3],
    before: Vec<f64>,
    /// Differences of the last cycles, the newest first.
    differences: VecDeque<Vec<f64>>,
}

impl Comparison {
    /// A comparison for the channels of a system. `length` is the least swing of a length (m), such as a
    /// bearing's clearance; `scale` mass (kg), size (m) and speed (rad/s) of the model.
    pub fn new(system: &System, length: f64, scale: [f64; 3]) -> Comparison {
        let dimensions = system.channels.iter().map(|c| c.dimension).collect();
        Comparison {
            scale,
            continuous: system.channels.iter().map(|c| c.continuous).collect(),
            ..Comparison::of(dimensions, length)
        }
    }

    /// A comparison for continuous channels of these dimensions.
    pub fn of(dimensions: Vec<Dimension>, length: f64) -> Comparison {
        Comparison {
            continuous: vec![true; dimensions.len()],
            dimensions,
            length,
            scale: [0.0; 3],
            before: Vec::new(),
            differences: VecDeque::new(),
        }
    }

    /// Forgets all cycles: the next one does not continue them.
    pub fn forget(&mut self) {
        self.before.clear();
        self.differences.clear();
    }

    /// Sets the rate of the cycle (rad/s).
    pub fn goes_at(&mut self, pace: f64) {
        self.scale[2] = pace;
    }

    /// Compares the next cycle, with its samples one after the other.
    pub fn next(&mut self, values: &[f64]) -> Verdict {
        let count = self.dimensions.len();
        let before = std::mem::replace(&mut self.before, values.to_vec());
        let known = thinned(values, count, before.len());
        let Some(compared) = known.filter(|_| count > 0) else {
            return Verdict::default();
        };
        let difference: Vec<f64> = compared
            .iter()
            .zip(&before)
            .enumerate()
            .map(|(i, (now, before))| {
                let d = now - before;
                if self.dimensions[i % count] == Dimension::ANGLE {
                    // unwrapped angles advance by whole turns
                    d - 2.0 * PI * libm::round(d / (2.0 * PI))
                } else {
                    d
                }
            })
            .collect();
        self.differences.push_front(difference);
        self.differences.truncate(3);
        let swings = self.swings(values);
        let mut verdict = Verdict::default();
        let mut worst = None;
        for (channel, swing) in swings.iter().enumerate() {
            let newest = self.column(0, channel);
            let most = largest(&newest);
            if most == 0.0 || !self.continuous[channel] {
                continue;
            }
            if let Some(by) = self.growth(channel) {
                verdict.growing.push(Growth { channel, by });
                continue;
            }
            let change = most / swing;
            if worst.is_none_or(|(_, most)| change > most) {
                worst = Some((channel, change));
            }
        }
        let (channel, change) = worst.unwrap_or((0, 0.0));
        verdict.within = within(&self.column(0, channel), 1);
        verdict.slowest = Some(Decay {
            channel,
            change,
            mode: self.shrinking(channel),
        });
        verdict
    }

    fn column(&self, age: usize, channel: usize) -> Vec<f64> {
        let count = self.dimensions.len();
        self.differences.get(age).map_or_else(Vec::new, |d| {
            d.iter().skip(channel).step_by(count).copied().collect()
        })
    }

    /// Whether only revolving angles change within the last cycle, except for a small share of the counting
    /// swings.
    pub fn stands(&self) -> bool {
        let values = &self.before;
        !self.dimensions.is_empty()
            && values.len() >= self.dimensions.len()
            && self
                .own_swings(values)
                .iter()
                .zip(self.swings(values))
                .all(|(own, counted)| *own <= STANDING * counted)
    }

    /// Largest minus smallest value of each channel within a cycle. For a revolving angle the line through
    /// its ends is subtracted first.
    fn own_swings(&self, values: &[f64]) -> Vec<f64> {
        let count = self.dimensions.len();
        let samples = values.len() / count;
        (0..count)
            .map(|channel| {
                let at = |i: usize| values[i * count + channel];
                let whole = at(samples - 1) - at(0);
                let slope = if self.dimensions[channel] == Dimension::ANGLE && whole.abs() > PI {
                    whole / (samples - 1).max(1) as f64
                } else {
                    0.0
                };
                let level = (0..samples).map(|i| at(i) - slope * i as f64);
                let (low, high) = level.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| {
                    (l.min(x), h.max(x))
                });
                high - low
            })
            .collect()
    }

    /// [`Comparison::own_swings`], but at least a small share of the largest value of their dimension; for
    /// lengths at least a given length.
    fn swings(&self, values: &[f64]) -> Vec<f64> {
        let count = self.dimensions.len();
        let mut swings = self.own_swings(values);
        // largest swing of each dimension (of angles), and largest value (of the others): once for a dimension, because
        // each of hundreds of channels would read the values of all channels of its kind
        let mut floors: Vec<(Dimension, f64)> = Vec::new();
        for (channel, swing) in swings.iter().enumerate() {
            let dimension = self.dimensions[channel];
            let size = if dimension == Dimension::LENGTH {
                continue;
            } else if dimension == Dimension::ANGLE {
                LEAST_ANGLE.max(LEAST_SWING * swing)
            } else {
                let samples = values.iter().skip(channel).step_by(count);
                samples.fold(self.rounding(dimension), |w, x| {
                    w.max(LEAST_SWING * x.abs())
                })
            };
            match floors.iter_mut().find(|(known, _)| *known == dimension) {
                Some((_, floor)) => *floor = floor.max(size),
                None => floors.push((dimension, size)),
            }
        }
        for (swing, dimension) in swings.iter_mut().zip(&self.dimensions) {
            let known = floors.iter().find(|(known, _)| known == dimension);
            let floor = known.map_or(self.length, |(_, floor)| *floor);
            *swing = swing.max(floor).max(f64::MIN_POSITIVE);
        }
        swings
    }

    /// For a mechanical dimension: the value below which all is rounding in a model of this mass, size and
    /// speed.
    fn rounding(&self, dimension: Dimension) -> f64 {
        let [mass, size, pace] = self.scale;
        let of_bases = (0..BASES).fold(ROUNDING, |value, base| {
            let unit = match Dimension::base(base) {
                Dimension::LENGTH => size,
                Dimension::MASS => mass,
                Dimension::TIME => 1.0 / pace,
                Dimension::ANGLE => 1.0,
                _ => f64::NAN,
            };
            match dimension.exponent(base) {
                (0, _) => value,
                (up, down) => value * libm::pow(unit, f64::from(up) / f64::from(down)),
            }
        });
        if of_bases.is_finite() { of_bases } else { 0.0 }
    }

    /// The growth per cycle of a channel whose difference is equal over the whole cycle and equal to that of
    /// the cycle before.
    fn growth(&self, channel: usize) -> Option<f64> {
        let mean_and_spread = |age: usize| {
            let d = self.column(age, channel);
            let mean = d.iter().sum::<f64>() / d.len().max(1) as f64;
            let spread = d.iter().fold(0.0_f64, |w, x| w.max((x - mean).abs()));
            (!d.is_empty()).then_some((mean, spread))
        };
        let (now, spread) = mean_and_spread(0)?;
        let (before, _) = mean_and_spread(1)?;
        let same = |x: f64| x.abs() <= STEADY * now.abs();
        (same(spread) && same(now - before)).then_some(now)
    }

    /// The decay that follows from the last three differences of a channel.
    fn shrinking(&self, channel: usize) -> Option<Mode> {
        let columns = [0, 1, 2].map(|age| self.column(age, channel));
        slowest(columns.each_ref().map(Vec::as_slice), 1).map(|fit| fit.mode)
    }
}

/// A fit of the last difference by the two before it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fit {
    /// Its slower mode.
    pub mode: Mode,
    /// a and b of `d₀ = a d₁ + b d₂`.
    pub recurrence: [f64; 2],
}

/// The slower of the two modes that fit the last of three differences best, `d₀ = a d₁ + b d₂`. With only two
/// known differences, or with differences of one direction, there is one mode. `None` if earlier differences
/// are unknown or zero. Each difference has `width` numbers for each sample.
///
/// Two unknowns fit any difference at one or two samples. So if the cycles differ at few samples, the
/// difference counts as not predicted.
pub fn slowest(differences: [&[f64]; 3], width: usize) -> Option<Fit> {
    let known = differences.iter().filter(|d| !d.is_empty());
    let least = known.map(|d| d.len()).min()?;
    let alike = differences.map(|d| thinned(d, width, least).unwrap_or_default());
    let [d0, d1, d2] = alike.each_ref().map(|d| d.as_ref());
    let dot = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(x, y)| x * y).sum::<f64>();
    let (s00, s11) = (dot(d0, d0), dot(d1, d1));
    if d1.is_empty() || s11 == 0.0 {
        return None;
    }
    let (r1, r2) = (dot(d0, d1), dot(d0, d2));
    let few = samples_of(d0, width) < FEW_SAMPLES;
    let share = |explained: f64| {
        if few {
            1.0
        } else if s00 > 0.0 {
            (1.0 - explained / s00).clamp(0.0, 1.0)
        } else {
            0.0
        }
    };
    let single = r1 / s11;
    let alone = Fit {
        mode: Mode {
            factor: single.abs(),
            turn: if single < 0.0 { PI } else { 0.0 },
            unpredicted: share(r1 * single),
        },
        recurrence: [single, 0.0],
    };
    let (s12, s22) = (dot(d1, d2), dot(d2, d2));
    let determinant = s11 * s22 - s12 * s12;
    if d2.is_empty() || determinant <= PARALLEL * s11 * s22 {
        return Some(alone);
    }
    let a = (r1 * s22 - r2 * s12) / determinant;
    let b = (r2 * s11 - r1 * s12) / determinant;
    let discriminant = 0.25 * a * a + b;
    let (factor, turn) = if discriminant < 0.0 {
        let factor = libm::sqrt(-b);
        (factor, libm::acos((0.5 * a / factor).clamp(-1.0, 1.0)))
    } else {
        let root = libm::sqrt(discriminant);
        let (high, low) = (0.5 * a + root, 0.5 * a - root);
        let slow = if high.abs() >= low.abs() { high } else { low };
        (slow.abs(), if slow < 0.0 { PI } else { 0.0 })
    };
    Some(Fit {
        mode: Mode {
            factor,
            turn,
            unpredicted: share(a * r1 + b * r2),
        },
        recurrence: [a, b],
    })
}

/// The samples of a cycle that stand at those of a cycle with fewer samples, which are `length` numbers. Each sample has
/// `width` numbers. `None` if the samples of the other cycle are no part of these.
pub fn thinned(values: &[f64], width: usize, length: usize) -> Option<Cow<'_, [f64]>> {
    if values.is_empty() || values.len() == length {
        return Some(Cow::Borrowed(values));
    }
    if width == 0 || length == 0 || !values.len().is_multiple_of(length) {
        return None;
    }
    let every = values.len() / length;
    let samples = values.chunks(width).skip(every - 1).step_by(every);
    Some(Cow::Owned(samples.flatten().copied().collect()))
}

/// The factor by which a difference of two cycles shrinks within the cycle: the size of its last part over that of its first
/// one. The end of a cycle is the beginning of the next, so both parts stand beside each other, and nearly a cycle lies
/// between them. `None` without a difference in the first part.
pub fn within(difference: &[f64], width: usize) -> Option<f64> {
    let part = (difference.len() / width.max(1)).div_ceil(WINDOWS) * width;
    let square = |part: &[f64]| part.iter().map(|d| d * d).sum::<f64>();
    let first = square(difference.get(..part)?);
    let last = square(difference.get(difference.len() - part..)?);
    (first > 0.0).then(|| libm::sqrt(last / first))
}

/// Number of samples over which a difference is spread, `(Σ e)²/Σ e²` with e the sum of squares of a sample:
/// 1 if one sample differs, n if n samples differ alike. Infinite without differences.
fn samples_of(difference: &[f64], width: usize) -> f64 {
    let squares = difference
        .chunks(width)
        .map(|sample| sample.iter().map(|x| x * x).sum::<f64>());
    let (sum, square) = squares.fold((0.0, 0.0), |(sum, square), e| (sum + e, square + e * e));
    if square > 0.0 {
        sum * sum / square
    } else {
        f64::INFINITY
    }
}
