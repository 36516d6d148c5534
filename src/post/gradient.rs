//! Derivatives of numbers and signals by a parameter: a dual number at each sample.
//!
//! The gradients of a run are those of samples at a fixed angle if the text states samples in degrees, and at
//! a fixed time if it states them in seconds. So the least sample keeps its place, which is the envelope
//! theorem. At fixed angles the times of the samples follow the parameter, and a mean over time has their
//! derivatives as well. The parameter changes neither the samples of a part nor the choice of the least one.

use super::PostError;
use super::evaluate::{Evaluator, Value, computed, mapped, operated, zipped};
use super::operation::{
    component_of, filter_of, filtered, found_at, reduced, resampled, sampled_track,
};
use super::track::{Samples, Shifts, Track};
use crate::results::{TIME, derivative_of};
use crate::tables::mean;
use eng_report::signal::{Axis, Ends, Sampling};
use eng_system::elementary::Elementary;
use eng_system::expression::{Expression, Function, Limit, Operator, Part, Reduction, Window};
use eng_system::recorded::CYCLE_ANGLE;
use std::f64::consts::LN_10;
use std::rc::Rc;

/// An angle counts as held if its derivative is at most this share of the turn within the derivative of the
/// sample's time. A choice above the rounding of derivatives.
const HELD: f64 = 1e-6;

/// Largest difference of the derivatives of two equal samples, as a share of the largest derivative of the
/// signal. A choice above the rounding of derivatives.
const ALIKE: f64 = 1e-6;

/// A value and its derivative by a parameter (SI).
struct Dual {
    value: Value,
    slope: Value,
}

impl Evaluator<'_> {
    /// The derivative of a number or a signal by a parameter.
    pub(super) fn gradient(&self, of: &Expression, parameter: &str) -> Result<Value, PostError> {
        let by = By {
            evaluator: self,
            parameter,
        };
        Ok(by.dual(of)?.slope)
    }
}

/// Differentiates by a parameter.
struct By<'b> {
    evaluator: &'b Evaluator<'b>,
    parameter: &'b str,
}

fn unknown(function: &str, why: impl Into<String>) -> PostError {
    PostError::NoDerivative {
        function: function.to_owned(),
        why: why.into(),
    }
}

/// A signal; the checker refuses other arguments.
fn signal(value: Value) -> Result<Track, PostError> {
    match value {
        Value::Signal(track) => Ok(track),
        other => Err(other.instead_of("signal")),
    }
}

impl By<'_> {
    fn dual(&self, expression: &Expression) -> Result<Dual, PostError> {
        Ok(match expression {
            Expression::Number(value) => Dual {
                value: Value::Number(*value),
                slope: Value::Number(0.0),
            },
            Expression::Channel { analysis, path } => self.channel(analysis, path)?,
            Expression::Map(function, of) => {
                let Dual { value, slope } = self.dual(of)?;
                let chained = |x, dx| chained(slope_of(*function, x), dx);
                Dual {
                    slope: zipped(value.clone(), slope, chained)?,
                    value: value.each(|x| mapped(*function, x))?,
                }
            }
            Expression::Binary(operator, left, right) => {
                let sides = (self.dual(left)?, self.dual(right)?);
                binary(*operator, sides.0, sides.1).map_err(|error| error.of(left, right))?
            }
            Expression::Fold(operator, members) => {
                let Some((first, others)) = members.split_first() else {
                    return self.dual(&Expression::Number(0.0));
                };
                let mut whole = self.dual(first)?;
                for member in others {
                    whole = binary(*operator, whole, self.dual(member)?)
                        .map_err(|error| error.of(first, member))?;
                }
                whole
            }
            Expression::Decibel(_, of) => {
                let Dual { value, slope } = self.dual(of)?;
                Dual {
                    slope: zipped(value, slope, |x, dx| chained(20.0 / LN_10 / x, dx))?,
                    value: self.evaluator.value(expression)?,
                }
            }
            Expression::Last(part, of) => self.last(*part, of)?,
            Expression::Filter(filter, of) => {
                let (value, slope) = self.signals(of)?;
                let name = match (filter.from, filter.to) {
                    (Some(_), Some(_)) => "band",
                    (Some(_), None) => "high_pass",
                    _ => "low_pass",
                };
                if let Some((made, sampled)) = filter_of(filter, &value)? {
                    let limits = [filter.from, filter.to].into_iter().flatten();
                    held(name, &value, sampled.sampling, limits)?;
                    if made.ends != Ends::Periodic {
                        return Err(unknown(
                            name,
                            "of a part that is no whole cycle, because the filter continues it; filter `last_cycle(…)`",
                        ));
                    }
                }
                Dual {
                    value: Value::Signal(filtered(filter, value)?),
                    slope: Value::Signal(filtered(filter, slope)?),
                }
            }
            Expression::Resample(of, like) => {
                let ((value, slope), (like, _)) = (self.signals(of)?, self.signals(like)?);
                let by_angle = value.samples.angle.is_some() && like.samples.angle.is_some();
                for track in [&value, &like] {
                    let axis = if by_angle { Held::Angle } else { Held::Time };
                    holds("resample", track, axis)?;
                }
                Dual {
                    value: Value::Signal(resampled(&value, &like)?),
                    slope: Value::Signal(resampled(&slope, &like)?),
                }
            }
            Expression::Reduce(reduction, of) => {
                let (value, slope) = self.signals(of)?;
                Dual {
                    slope: Value::Number(reduced_slope(*reduction, &value, &slope)?),
                    value: Value::Number(reduced(*reduction, &value)?),
                }
            }
            Expression::Amplitude(limit, window, of) => {
                let (value, slope) = self.signals(of)?;
                amplitude(*limit, *window, &value, &slope)?
            }
            Expression::Mode(..) => {
                return Err(unknown(
                    "mode",
                    "by a parameter: take it out of `gradient(…)`",
                ));
            }
            Expression::AtFrequency(..) => {
                return Err(unknown(
                    "at_frequency",
                    "by a parameter: take it out of `gradient(…)`",
                ));
            }
            Expression::Gradient { .. } | Expression::Parameter { .. } => {
                return Err(unknown(
                    "gradient",
                    "by a second parameter: take the inner one out",
                ));
            }
            Expression::Not(of) => return Err(self.dual(of)?.value.instead_of("number")),
        })
    }

    /// A signal and its derivatives.
    fn signals(&self, of: &Expression) -> Result<(Track, Track), PostError> {
        let Dual { value, slope } = self.dual(of)?;
        Ok((signal(value)?, signal(slope)?))
    }

    fn channel(&self, analysis: &str, path: &str) -> Result<Dual, PostError> {
        let mut found = self.evaluator.run(analysis)?.gradients.iter();
        let gradient = found.find(|gradient| gradient.parameter == self.parameter);
        let Some(gradient) = gradient else {
            return Err(PostError::NoGradient {
                analysis: analysis.to_owned(),
                parameter: self.parameter.to_owned(),
            });
        };
        let column = |path: &str| {
            let column = gradient.results.column(derivative_of(path));
            column.map(|column| column.values.clone())
        };
        let no_channel = || PostError::NoChannel {
            analysis: analysis.to_owned(),
            path: path.to_owned(),
        };
        let track = self.evaluator.channel(analysis, path)?;
        let slopes = column(path).ok_or_else(no_channel)?;
        let samples = Rc::new(Samples {
            shifts: Some(Shifts {
                time: column(TIME).ok_or_else(no_channel)?,
                angle: column(CYCLE_ANGLE).unwrap_or_default(),
            }),
            ..Samples::clone(&track.samples)
        });
        let of = |values| {
            Value::Signal(Track {
                samples: Rc::clone(&samples),
                values,
            })
        };
        Ok(Dual {
            slope: of(slopes),
            value: of(track.values),
        })
    }

    /// The last part of a signal, of the same samples.
    fn last(&self, part: Part, of: &Expression) -> Result<Dual, PostError> {
        let (value, slope) = self.signals(of)?;
        let value = self.evaluator.last_of(part, of, value)?;
        let slope = self.evaluator.last(part, slope)?;
        if value.samples.shifts.is_none() {
            return Err(unknown(
                "last_cycle",
                "of samples that do not fill whole cycles; run it with a `sample:` in degrees",
            ));
        }
        Ok(Dual {
            value: Value::Signal(value),
            slope: Value::Signal(slope),
        })
    }
}

/// A derivative times a change. Without a change there is none, whatever the derivative.
fn chained(slope: f64, change: f64) -> f64 {
    if change == 0.0 { 0.0 } else { slope * change }
}

/// f′(x); NaN where it is not unique.
fn slope_of(function: Function, x: f64) -> f64 {
    match function {
        Function::Abs if x == 0.0 => f64::NAN,
        Function::Abs => x.signum(),
        Function::Sqrt => 0.5 / x.sqrt(),
        Function::Negate => -1.0,
        Function::Elementary(function) => match function {
            Elementary::Sin => libm::cos(x),
            Elementary::Cos => -libm::sin(x),
            Elementary::Tan => 1.0 + libm::tan(x) * libm::tan(x),
            Elementary::Asin => 1.0 / (1.0 - x * x).sqrt(),
            Elementary::Acos => -1.0 / (1.0 - x * x).sqrt(),
            Elementary::Atan => 1.0 / (1.0 + x * x),
            Elementary::Tanh => 1.0 - libm::tanh(x) * libm::tanh(x),
            Elementary::Exp => libm::exp(x),
            Elementary::Log => 1.0 / x,
            Elementary::Held => 0.0,
        },
    }
}

/// An operator between two numbers or signals.
fn binary(operator: Operator, left: Dual, right: Dual) -> Result<Dual, PostError> {
    let value = operated(operator, left.value.clone(), right.value.clone())?;
    let both = |operator, a: Value, b: Value| operated(operator, a, b);
    let slope = match operator {
        Operator::Add | Operator::Subtract => both(operator, left.slope, right.slope)?,
        Operator::Multiply => {
            let first = zipped(right.value, left.slope, chained)?;
            both(
                Operator::Add,
                first,
                zipped(left.value, right.slope, chained)?,
            )?
        }
        Operator::Divide => {
            let first = zipped(right.value.clone(), left.slope, |b, da| {
                chained(1.0 / b, da)
            })?;
            let part = zipped(left.value, right.value, |a, b| a / (b * b))?;
            both(
                Operator::Subtract,
                first,
                zipped(part, right.slope, chained)?,
            )?
        }
        Operator::Power => {
            let base = zipped(left.value.clone(), right.value.clone(), |a, b| {
                b * libm::pow(a, b - 1.0)
            })?;
            let exponent = zipped(left.value, right.value, |a, b| {
                libm::pow(a, b) * libm::log(a)
            })?;
            let first = zipped(base, left.slope, chained)?;
            both(
                Operator::Add,
                first,
                zipped(exponent, right.slope, chained)?,
            )?
        }
        Operator::Minimum | Operator::Maximum => {
            // the taken side: 1 left, -1 right, 0 both
            let side = zipped(left.value, right.value, |a, b| {
                let taken = computed(operator, a, b);
                f64::from(i8::from(taken == Some(a)) - i8::from(taken == Some(b)))
            })?;
            // of equal sides the derivative is unique if the sides have the same
            let one = zipped(left.slope.clone(), right.slope.clone(), |a, b| {
                if a == b { a } else { f64::NAN }
            })?;
            let of = |due: f64, slope: Value| {
                zipped(
                    side.clone(),
                    slope,
                    move |side, slope| {
                        if side == due { slope } else { 0.0 }
                    },
                )
            };
            let sides = both(Operator::Add, of(1.0, left.slope)?, of(-1.0, right.slope)?)?;
            both(Operator::Add, sides, of(0.0, one)?)?
        }
        _ => return Err(value.instead_of("number")),
    };
    Ok(Dual { value, slope })
}

/// The measure whose value at each sample a parameter does not change.
#[derive(Clone, Copy, PartialEq)]
enum Held {
    Angle,
    Time,
}

/// Refuses a function of samples whose angles or times follow the parameter.
fn holds(function: &str, track: &Track, axis: Held) -> Result<(), PostError> {
    let Some(Shifts { time, angle }) = &track.samples.shifts else {
        return Err(unknown(function, "of interpolated samples"));
    };
    let largest =
        |values: &mut dyn Iterator<Item = f64>| values.fold(0.0_f64, |most, x| most.max(x.abs()));
    let speeds = track.samples.speed.as_deref().unwrap_or_default();
    let turned = largest(&mut time.iter().zip(speeds).map(|(t, speed)| t * speed));
    let (moves, needed) = match axis {
        Held::Angle => (
            largest(&mut angle.iter().copied()) > HELD * turned,
            "degrees",
        ),
        Held::Time => (time.iter().any(|t| *t != 0.0), "milliseconds"),
    };
    match moves {
        true => Err(unknown(
            function,
            format!(
                "of these samples, whose places follow the parameter; run it with a `sample:` in {needed}"
            ),
        )),
        false => Ok(()),
    }
}

/// Refuses a function of frequencies or orders whose limits or samples follow the parameter through the speed.
fn held(
    function: &str,
    track: &Track,
    sampling: Sampling,
    mut limits: impl Iterator<Item = Limit>,
) -> Result<(), PostError> {
    let (axis, other) = match sampling {
        Sampling::Angle { .. } => (Held::Angle, "a frequency"),
        Sampling::Time { .. } => (Held::Time, "an order"),
    };
    let converted = |limit| match limit {
        Limit::Frequency(_) => axis == Held::Angle,
        Limit::Order(_) => axis == Held::Time,
    };
    if limits.any(converted) {
        let why = format!(
            "by {other} of these samples, because the speed follows the parameter; state an order of samples in \
             degrees, or a frequency of samples in milliseconds"
        );
        return Err(unknown(function, why));
    }
    holds(function, track, axis)
}

/// The amplitude |c| of a sinusoid: its derivative is that of c along c.
fn amplitude(
    limit: Limit,
    window: Window,
    value: &Track,
    slope: &Track,
) -> Result<Dual, PostError> {
    let axis = match limit {
        Limit::Frequency(_) => Axis::Frequency,
        Limit::Order(_) => Axis::Order,
    };
    let sampling = sampled_track(value, axis)?.sampling;
    held("amplitude", value, sampling, std::iter::once(limit))?;
    let (own, change) = (
        component_of(limit, window, value)?,
        component_of(limit, window, slope)?,
    );
    let turned = (change.phase - own.phase).to_radians();
    Ok(Dual {
        value: Value::Number(own.amplitude),
        slope: Value::Number(change.amplitude * libm::cos(turned)),
    })
}

/// The derivative of a number of a signal: see [`reduced`].
fn reduced_slope(reduction: Reduction, value: &Track, slope: &Track) -> Result<f64, PostError> {
    // refuses signals without a number
    let number = reduced(reduction, value)?;
    let (y, dy) = (&value.values, &slope.values);
    match reduction {
        Reduction::Minimum | Reduction::Maximum => extreme_slope(reduction, number, y, dy),
        Reduction::PeakToPeak => {
            let of = |reduction| {
                let number = reduced(reduction, value)?;
                extreme_slope(reduction, number, y, dy)
            };
            Ok(of(Reduction::Maximum)? - of(Reduction::Minimum)?)
        }
        Reduction::Mean => mean_slope(value, y, dy),
        Reduction::RootMeanSquare => {
            let squares: Vec<f64> = y.iter().map(|y| y * y).collect();
            let slopes: Vec<f64> = y.iter().zip(dy).map(|(y, dy)| 2.0 * y * dy).collect();
            Ok(mean_slope(value, &squares, &slopes)? / (2.0 * number))
        }
        Reduction::MinimumAt(by_time) | Reduction::MaximumAt(by_time) => {
            place_slope(reduction, by_time, value, dy)
        }
    }
}

/// The derivative of the least or largest sample at its place.
fn extreme_slope(
    reduction: Reduction,
    number: f64,
    values: &[f64],
    slopes: &[f64],
) -> Result<f64, PostError> {
    let mut there = values.iter().zip(slopes).filter(|(y, _)| **y == number);
    let slope = there.next().map_or(f64::NAN, |(_, slope)| *slope);
    let size = slopes
        .iter()
        .fold(0.0_f64, |most, slope| most.max(slope.abs()));
    if there.any(|(_, other)| (other - slope).abs() > ALIKE * size) {
        let why = "where several samples are the extreme one and have different derivatives";
        return Err(unknown(reduction.name(), why));
    }
    Ok(slope)
}

/// d(∫y dt/T) by the trapezoidal rule; the times change too.
fn mean_slope(track: &Track, values: &[f64], slopes: &[f64]) -> Result<f64, PostError> {
    let Some(shifts) = &track.samples.shifts else {
        return Err(unknown("mean", "of interpolated samples"));
    };
    let time = &track.samples.time;
    let whole = mean(time, values);
    let (Some([first, last]), Some([from, to])) = (ends(time), ends(&shifts.time)) else {
        return Ok(f64::NAN);
    };
    let moved = shifts.time.windows(2).zip(values.windows(2));
    let area: f64 = moved
        .map(|(t, y)| match (t, y) {
            ([from, to], [a, b]) => 0.5 * (a + b) * (to - from),
            _ => 0.0,
        })
        .sum();
    if last <= first {
        return Ok(mean(time, slopes));
    }
    Ok(mean(time, slopes) + (area - whole * (to - from)) / (last - first))
}

fn ends(values: &[f64]) -> Option<[f64; 2]> {
    Some([*values.first()?, *values.last()?])
}

/// The derivative of the place of an extreme. The place is the vertex x₁ − s/2c of the parabola through three samples, with
/// the slope s at the middle one and the curvature 2c.
fn place_slope(
    reduction: Reduction,
    by_time: bool,
    track: &Track,
    dy: &[f64],
) -> Result<f64, PostError> {
    let Some(shifts) = &track.samples.shifts else {
        return Err(unknown(reduction.name(), "of interpolated samples"));
    };
    let found = found_at(reduction, by_time, track)?;
    let (x, dx) = match (&track.samples.angle, by_time) {
        (Some(angle), false) => (angle, &shifts.angle),
        _ => (&track.samples.time, &shifts.time),
    };
    let y = &track.values;
    let middle = found.sample;
    let around = middle.saturating_sub(1)..middle + 2;
    let three = |values: &[f64]| match values.get(around.clone()) {
        Some([a, b, c]) => Some([*a, *b, *c]),
        _ => None,
    };
    let (Some(x), Some(dx3), Some(y), Some(dy)) = (three(x), three(dx), three(y), three(dy)) else {
        return Ok(dx.get(middle).copied().unwrap_or(f64::NAN));
    };
    if !found.refined {
        return Ok(dx3[1]);
    }
    // a difference quotient and its derivative
    let quotient = |at: usize| {
        let (width, change) = (x[at + 1] - x[at], dx3[at + 1] - dx3[at]);
        let rise = (y[at + 1] - y[at]) / width;
        (rise, (dy[at + 1] - dy[at] - rise * change) / width)
    };
    let ((left, dleft), (right, dright)) = (quotient(0), quotient(1));
    let (span, dspan) = (x[2] - x[0], dx3[2] - dx3[0]);
    let curvature = (right - left) / span;
    let dcurvature = (dright - dleft - curvature * dspan) / span;
    let (width, dwidth) = (x[1] - x[0], dx3[1] - dx3[0]);
    let slope = left + curvature * width;
    let dslope = dleft + dcurvature * width + curvature * dwidth;
    let shift = (slope * dcurvature / curvature - dslope) / (2.0 * curvature);
    Ok(dx3[1] + shift)
}
