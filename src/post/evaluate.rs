//! Expressions over results.

use super::operation::{component_of, filtered, reduced, resampled};
use super::sampling_limits::{extent_text, limit_text};
use super::track::{Samples, Track};
use super::{PostError, Run};
use crate::cycle::{SLACK, shifted, since};
use crate::results::{CYCLE_ANGLE, CYCLE_SPEED, TIME};
use eng_system::expression::{Chosen, Expression, Function, Limit, Operator, Part};
use eng_system::recorded::{FREQUENCY, MODE, PHASE};
use eng_system::significant::short;
use eng_system::system::Extent;
use std::f64::consts::TAU;
use std::rc::Rc;

/// Largest logarithm of the ratio of two neighbours in a response between which values are interpolated. A
/// choice: points about a resonance differ by a tenth at most.
const STEEP: f64 = 0.2;
/// Share of a frequency within which a mode counts as near it. A choice: a tenth is the accuracy with which a
/// reader knows a frequency from a figure.
const NEAR: f64 = 0.1;

/// A value while it is evaluated.
#[derive(Clone)]
pub(super) enum Value {
    Number(f64),
    Signal(Track),
    Truth(bool),
}

impl Value {
    /// The error if the place needs another sort of value.
    pub fn instead_of(&self, due: &'static str) -> PostError {
        let found = match self {
            Value::Number(_) => "number",
            Value::Signal(_) => "signal",
            Value::Truth(_) => "condition",
        };
        PostError::Shape { due, found }
    }

    /// A function of each number.
    pub fn each(self, function: impl Fn(f64) -> f64) -> Result<Value, PostError> {
        match self {
            Value::Number(x) => Ok(Value::Number(function(x))),
            Value::Signal(mut track) => {
                track.values.iter_mut().for_each(|x| *x = function(*x));
                Ok(Value::Signal(track))
            }
            other => Err(other.instead_of("number")),
        }
    }
}

/// Evaluates over the results of runs.
#[derive(Clone, Copy, Debug)]
pub(super) struct Evaluator<'r> {
    runs: &'r [Run<'r>],
}

impl<'r> Evaluator<'r> {
    pub fn new(runs: &'r [Run<'r>]) -> Evaluator<'r> {
        Evaluator { runs }
    }

    /// The run of an analysis.
    pub fn run(&self, analysis: &str) -> Result<Run<'r>, PostError> {
        self.runs
            .iter()
            .find(|run| run.results.analysis() == analysis)
            .copied()
            .ok_or_else(|| PostError::NotRun(vec![analysis.to_owned()]))
    }

    /// A finite number.
    pub fn number(&self, expression: &Expression) -> Result<f64, PostError> {
        match self.value(expression)? {
            Value::Number(value) => Ok(value),
            other => Err(other.instead_of("number")),
        }
    }

    /// A condition.
    pub fn truth(&self, expression: &Expression) -> Result<bool, PostError> {
        match self.value(expression)? {
            Value::Truth(value) => Ok(value),
            other => Err(other.instead_of("condition")),
        }
    }

    /// A signal.
    pub fn track(&self, expression: &Expression) -> Result<Track, PostError> {
        match self.value(expression)? {
            Value::Signal(track) => Ok(track),
            other => Err(other.instead_of("signal")),
        }
    }

    /// The values (SI) of a column.
    pub fn column(&self, analysis: &str, path: &str) -> Result<&'r [f64], PostError> {
        let run = self.run(analysis)?;
        run.results
            .column(path)
            .map(|column| column.values.as_slice())
            .ok_or_else(|| PostError::NoChannel {
                analysis: analysis.to_owned(),
                path: path.to_owned(),
            })
    }

    /// The samples of a run. In a cycle that repeats the angle counts from its beginning.
    pub fn samples(&self, analysis: &str) -> Result<Samples, PostError> {
        let run = self.run(analysis)?;
        let (modes, responses) = (run.results.are_modes(), run.results.are_responses());
        let kept = |path: &str| match modes || responses {
            true => None,
            false => run.results.column(path).map(|c| c.values.clone()),
        };
        let rows = |path: &str| self.column(analysis, path).map(<[f64]>::to_vec);
        let mut samples = Samples {
            analysis: analysis.to_owned(),
            time: match (modes, run.results.column(TIME)) {
                _ if responses => rows(FREQUENCY)?,
                (true, _) => rows(MODE)?,
                (false, Some(_)) => rows(TIME)?,
                // rows of a table over the points of a sweep
                (false, None) => (0..run.results.samples()).map(|row| row as f64).collect(),
            },
            angle: kept(CYCLE_ANGLE),
            speed: kept(CYCLE_SPEED),
            period: run.machine.cycle_period,
            whole: false,
            shortened: false,
            shifts: None,
        };
        if let Some(period) = run.machine.cycle_period.filter(|_| run.machine.periodic) {
            samples.angle = samples.angle.map(|angle| shifted(angle, Some(period)));
            samples.whole = samples.cover(period);
        }
        Ok(samples)
    }

    pub fn channel(&self, analysis: &str, path: &str) -> Result<Track, PostError> {
        let samples = self.samples(analysis)?;
        let values = match (&samples.angle, path) {
            (Some(angle), CYCLE_ANGLE) => angle.clone(),
            _ => self.column(analysis, path)?.to_vec(),
        };
        Ok(Track {
            samples: Rc::new(samples),
            values,
        })
    }

    pub fn value(&self, expression: &Expression) -> Result<Value, PostError> {
        Ok(match expression {
            Expression::Number(value) => Value::Number(*value),
            Expression::Channel { analysis, path } => Value::Signal(self.channel(analysis, path)?),
            Expression::Map(function, of) => self.value(of)?.each(|x| mapped(*function, x))?,
            Expression::Binary(operator, left, right) => {
                let sides = (self.value(left)?, self.value(right)?);
                operated(*operator, sides.0, sides.1).map_err(|error| error.of(left, right))?
            }
            Expression::Not(of) => Value::Truth(!self.truth(of)?),
            Expression::Fold(operator, members) => {
                let Some((first, others)) = members.split_first() else {
                    return Ok(Value::Number(0.0));
                };
                let mut whole = self.value(first)?;
                for member in others {
                    whole = operated(*operator, whole, self.value(member)?)
                        .map_err(|error| error.of(first, member))?;
                }
                whole
            }
            Expression::Decibel(reference, of) => match self.value(of)? {
                Value::Number(0.0) => {
                    return Err(PostError::NotFinite("the level of 0".to_owned()));
                }
                value => value.each(|x| 20.0 * libm::log10(x.abs() / reference))?,
            },
            Expression::Last(part, of) => {
                Value::Signal(self.last_of(*part, of, self.track(of)?)?)
            }
            Expression::Filter(filter, of) => Value::Signal(filtered(filter, self.track(of)?)?),
            Expression::Resample(of, like) => {
                Value::Signal(resampled(&self.track(of)?, &self.track(like)?)?)
            }
            Expression::Reduce(reduction, of) => {
                Value::Number(reduced(*reduction, &self.track(of)?)?)
            }
            Expression::Amplitude(limit, window, of) => {
                let track = self.track(of)?;
                Value::Number(component_of(*limit, *window, &track)?.amplitude)
            }
            Expression::AtFrequency(frequency, of) => {
                Value::Number(self.at_frequency(*frequency, of)?)
            }
            Expression::Mode(chosen, of) => Value::Number(self.mode(*chosen, &self.track(of)?)?),
            Expression::Gradient { of, parameter } => self.gradient(of, parameter)?,
            Expression::Parameter { analysis, path } => {
                Value::Number(self.parameter(analysis, path)?)
            }
        })
    }

    /// The value (SI) of a parameter by which a run is differentiated.
    fn parameter(&self, analysis: &str, path: &str) -> Result<f64, PostError> {
        let run = self.run(analysis)?;
        let gradient = run.gradients.iter().find(|g| g.parameter == path);
        let text = run.results.metadata().get(&format!("parameter.{path}"));
        let number = text.and_then(|text| text.split(' ').next()?.parse().ok());
        match (gradient, number) {
            // a share of zero would be no change
            (Some(_), Some(0.0)) => Err(PostError::ZeroParameter {
                analysis: analysis.to_owned(),
                parameter: path.to_owned(),
            }),
            (Some(gradient), Some(number)) => Ok(gradient.unit.to_si(number)),
            _ => Err(PostError::NoGradient {
                analysis: analysis.to_owned(),
                parameter: path.to_owned(),
            }),
        }
    }

    /// The value of a column at a frequency (Hz). It lies on the cubic through the four neighbours over the logarithm
    /// of the frequency. An amplitude is interpolated in logarithms, too, and a phase goes the shorter way.
    fn at_frequency(&self, frequency: f64, of: &Expression) -> Result<f64, PostError> {
        let track = self.track(of)?;
        let (frequencies, values) = (&track.samples.time, &track.values);
        let (Some(low), Some(high)) = (frequencies.first(), frequencies.last()) else {
            return Err(PostError::Few {
                analysis: track.samples.analysis.clone(),
                count: 0,
            });
        };
        if !(*low..=*high).contains(&frequency) {
            return Err(PostError::OutsideResponse {
                analysis: track.samples.analysis.clone(),
                frequency: limit_text(Limit::Frequency(frequency)),
                range: format!("{} to {} Hz", short(*low, 6), short(*high, 6)),
            });
        }
        let next = frequencies.partition_point(|f| *f < frequency);
        let first = next
            .saturating_sub(2)
            .min(frequencies.len().saturating_sub(4));
        let near = first..(first + 4).min(frequencies.len()).min(values.len());
        let of_phase = matches!(of, Expression::Channel { path, .. } if path.ends_with(PHASE));
        let own = &values[near.clone()];
        let in_logarithms = !of_phase && own.iter().all(|y| *y > 0.0);
        let beside = |at: usize| values.get(at).copied().unwrap_or(f64::NAN);
        let (before, after) = (beside(next.saturating_sub(1)), beside(next));
        if in_logarithms && libm::log(after / before).abs() > STEEP {
            return Err(PostError::SteepResponse {
                analysis: track.samples.analysis.clone(),
                frequency: limit_text(Limit::Frequency(frequency)),
            });
        }
        let about = own.first().copied().unwrap_or(f64::NAN);
        let even = |y: f64| match (of_phase, in_logarithms) {
            (true, _) => y - TAU * ((y - about) / TAU).round(),
            (false, true) => libm::log(y),
            (false, false) => y,
        };
        let along: Vec<f64> = frequencies[near]
            .iter()
            .map(|f| libm::log(f / frequency))
            .collect();
        // Lagrange's polynomials at zero
        let mut found = 0.0;
        for (j, y) in own.iter().enumerate() {
            let others = along.iter().enumerate().filter(|(k, _)| *k != j);
            let weight: f64 = others.map(|(_, x)| x / (x - along[j])).product();
            found += weight * even(*y);
        }
        Ok(match (of_phase, in_logarithms) {
            (true, _) => found - TAU * (found / TAU).round(),
            (false, true) => libm::exp(found),
            (false, false) => found,
        })
    }

    /// The value in a column for one of the modes.
    fn mode(&self, chosen: Chosen, track: &Track) -> Result<f64, PostError> {
        let analysis = &track.samples.analysis;
        let numbers = &track.samples.time;
        let row = match chosen {
            Chosen::Number(number) => numbers
                .iter()
                .position(|other| *other == f64::from(number))
                .ok_or_else(|| PostError::NoMode {
                    analysis: analysis.clone(),
                    number,
                    count: numbers.len(),
                })?,
            Chosen::Near(frequency) => {
                let nearest = self
                    .column(analysis, FREQUENCY)?
                    .iter()
                    .enumerate()
                    .filter(|(_, own)| **own > 0.0)
                    .min_by(|(_, a), (_, b)| {
                        (*a - frequency).abs().total_cmp(&(*b - frequency).abs())
                    });
                let off = |own: f64| (own - frequency).abs() > NEAR * frequency;
                match nearest {
                    Some((row, own)) if !off(*own) => row,
                    nearest => {
                        return Err(PostError::NoModeNear {
                            analysis: analysis.clone(),
                            frequency: limit_text(Limit::Frequency(frequency)),
                            nearest: match nearest {
                                Some((_, own)) => {
                                    let own = limit_text(Limit::Frequency(*own));
                                    format!("the nearest has {own}")
                                }
                                None => "none oscillates".to_owned(),
                            },
                        });
                    }
                }
            }
        };
        Ok(track.values.get(row).copied().unwrap_or(f64::NAN))
    }

    /// The last part of a signal with its expression.
    pub fn last_of(&self, part: Part, of: &Expression, track: Track) -> Result<Track, PostError> {
        let mut last = self.last(part, track)?;
        // the angles of the other signals count from the beginning, too
        if let (Part::Cycles(_), Expression::Channel { path, .. }, Some(angle)) =
            (part, of, &last.samples.angle)
            && path == CYCLE_ANGLE
        {
            last.values.clone_from(angle);
        }
        Ok(last)
    }

    /// The last part of a signal.
    pub fn last(&self, part: Part, track: Track) -> Result<Track, PostError> {
        let short = |part: String| PostError::Short {
            analysis: track.samples.analysis.clone(),
            part,
        };
        let samples = &track.samples;
        let period = self.run(&samples.analysis)?.machine.cycle_period;
        let angle = samples.angle.as_deref().unwrap_or_default();
        let first = match part {
            Part::Extent(extent @ Extent::Time(length)) => {
                // rounding of sums of steps
                since(&samples.time, length, 1e-9 * length)
                    .ok_or_else(|| short(extent_text(extent)))?
            }
            Part::Extent(extent @ Extent::Angle(length)) => {
                since(angle, length, SLACK).ok_or_else(|| short(extent_text(extent)))?
            }
            Part::Cycles(count) => period
                .and_then(|period| since(angle, period * f64::from(count), SLACK))
                .ok_or_else(|| {
                    short(match count {
                        1 => "cycle".to_owned(),
                        count => format!("{count} cycles"),
                    })
                })?,
        };
        let mut cut = samples.from(first);
        if let (Part::Cycles(count), Some(period)) = (part, period) {
            let length = period * f64::from(count);
            if !cut.cover(length)
                && let Some(mut filled) = track.last_turned(length)
            {
                filled.samples = Rc::new(Samples::clone(&filled.samples).of_cycles(period, length));
                return Ok(filled);
            }
            cut = cut.of_cycles(period, length);
        }
        Ok(Track {
            samples: Rc::new(cut),
            values: track.values.get(first..).unwrap_or_default().to_vec(),
        })
    }
}

pub(super) fn mapped(function: Function, x: f64) -> f64 {
    match function {
        Function::Abs => x.abs(),
        Function::Sqrt => x.sqrt(),
        Function::Elementary(function) => function.value(x),
        Function::Negate => -x,
    }
}

/// An operator between numbers; `None` for one that gives a truth value.
pub(super) fn computed(operator: Operator, a: f64, b: f64) -> Option<f64> {
    Some(match operator {
        Operator::Add => a + b,
        Operator::Subtract => a - b,
        Operator::Multiply => a * b,
        Operator::Divide => a / b,
        Operator::Power => libm::pow(a, b),
        // NaN is neither smaller nor larger than a number
        Operator::Minimum | Operator::Maximum if a.is_nan() || b.is_nan() => f64::NAN,
        Operator::Minimum => a.min(b),
        Operator::Maximum => a.max(b),
        _ => return None,
    })
}

fn compared(operator: Operator, a: f64, b: f64) -> Option<bool> {
    Some(match operator {
        Operator::Equal => a == b,
        Operator::NotEqual => a != b,
        Operator::Less => a < b,
        Operator::LessEqual => a <= b,
        Operator::Greater => a > b,
        Operator::GreaterEqual => a >= b,
        _ => return None,
    })
}

impl PostError {
    /// The same error, in which signals of one run with other samples have their own names.
    pub(super) fn of(self, left: &Expression, right: &Expression) -> PostError {
        match self {
            PostError::Samples {
                first,
                second,
                detail,
            } if first == second => PostError::Samples {
                first: signal_text(left),
                second: signal_text(right),
                detail,
            },
            other => other,
        }
    }
}

/// The text of a signal up to the functions that change its samples. It is empty for a number.
fn signal_text(of: &Expression) -> String {
    match of {
        Expression::Channel { analysis, path } => format!("{analysis}.{path}"),
        Expression::Last(Part::Extent(_), of) => format!("last({}, …)", signal_text(of)),
        Expression::Last(Part::Cycles(_), of) => format!("last_cycle({})", signal_text(of)),
        Expression::Resample(_, like) => format!("resample(…, like: {})", signal_text(like)),
        other => {
            let mut parts = other.parts().into_iter().map(signal_text);
            parts.find(|text| !text.is_empty()).unwrap_or_default()
        }
    }
}

pub(super) fn operated(operator: Operator, left: Value, right: Value) -> Result<Value, PostError> {
    match (&left, &right) {
        (Value::Number(a), Value::Number(b)) if computed(operator, *a, *b).is_none() => {
            match compared(operator, *a, *b) {
                // NaN cannot be compared
                Some(_) if a.is_nan() || b.is_nan() => {
                    Err(PostError::NotFinite("a side of the comparison".to_owned()))
                }
                Some(truth) => Ok(Value::Truth(truth)),
                None => Err(left.instead_of("number")),
            }
        }
        (Value::Truth(a), Value::Truth(b)) => match operator {
            Operator::And => Ok(Value::Truth(*a && *b)),
            Operator::Or => Ok(Value::Truth(*a || *b)),
            _ => Err(left.instead_of("number")),
        },
        _ => zipped(left, right, |a, b| {
            computed(operator, a, b).unwrap_or(f64::NAN)
        }),
    }
}

/// A function of two numbers, sample by sample.
pub(super) fn zipped(
    left: Value,
    right: Value,
    each: impl Fn(f64, f64) -> f64,
) -> Result<Value, PostError> {
    Ok(match (left, right) {
        (Value::Number(a), Value::Number(b)) => Value::Number(each(a, b)),
        (signal @ Value::Signal(_), Value::Number(b)) => signal.each(|a| each(a, b))?,
        (Value::Number(a), signal @ Value::Signal(_)) => signal.each(|b| each(a, b))?,
        (Value::Signal(mut left), Value::Signal(mut right)) => {
            // if one signal has lost the irregular sample at its end, the other loses it, too
            if left.samples.shortened != right.samples.shortened {
                let both = left.values.len().min(right.values.len());
                (left, right) = (left.first(both), right.first(both));
            }
            if !Rc::ptr_eq(&left.samples, &right.samples)
                && let Some(detail) = left.samples.differ(&right.samples)
            {
                return Err(PostError::Samples {
                    first: left.samples.analysis.clone(),
                    second: right.samples.analysis.clone(),
                    detail,
                });
            }
            for (a, b) in left.values.iter_mut().zip(&right.values) {
                *a = each(*a, *b);
            }
            Value::Signal(left)
        }
        (other @ Value::Truth(_), _) | (_, other @ Value::Truth(_)) => {
            return Err(other.instead_of("number"));
        }
    })
}
