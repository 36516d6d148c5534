//! Inputs while a model runs: their values over time, and the constants of elements that follow them.
//!
//! A program sets inputs at points of time. Between two points an input follows a segment: a value that is held, a
//! straight line, or Hermite's cubic. A function of time in the text drives others. The bind graph turns the values
//! at a time into the slots that depend on them, and these replace constants of elements.
//!
//! We compared two ways. *A new kind of input of the element code*, beside markers and time, would give exact rates
//! of inputs, but an input could then not be an argument of a class: arguments are numbers of the bind graph. *Slots
//! that change*, the present way, leave code, layouts and derivatives as they are, and a model whose inputs stay at
//! their defaults has the bits of one with parameters in their places.

use crate::error::{Moment, RuntimeError, Undefined};
use crate::model::Model;
use eng_system::code::{Advice, BindError, Pair};
use eng_system::input::{Input, Interpolation};

/// Value and rate of an input at a point of time (SI).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Point {
    /// The value.
    pub value: f64,
    /// Its rate (1/s). Only inputs with `interpolation: cubic` have one.
    pub rate: f64,
}

impl From<f64> for Point {
    fn from(value: f64) -> Point {
        Point { value, rate: 0.0 }
    }
}

/// An input between two points of time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Segment {
    /// Time of the left point (s).
    pub from: f64,
    pub left: Point,
    /// Time of the right point (s), if its value is given.
    pub to: f64,
    pub right: Option<Point>,
}

impl Segment {
    fn held(from: f64, left: Point) -> Segment {
        Segment {
            from,
            left,
            to: f64::INFINITY,
            right: None,
        }
    }

    /// Value and rate at a time (s) of the segment. Outside it is the nearer end.
    pub fn at(&self, interpolation: Interpolation, time: f64) -> Point {
        let Some(right) = self.right.filter(|_| self.to.is_finite()) else {
            return self.left;
        };
        let h = self.to - self.from;
        let (a, b) = (self.left, right);
        let rise = b.value - a.value;
        if time >= self.to {
            // the rate of a line at its end is that before it
            return match interpolation {
                Interpolation::Linear => Point {
                    rate: rise / h,
                    ..right
                },
                _ => right,
            };
        }
        let s = ((time - self.from) / h).max(0.0);
        match interpolation {
            Interpolation::Hold => a,
            Interpolation::Linear => Point {
                value: a.value + s * rise,
                rate: rise / h,
            },
            // Hermite: a + (3s² − 2s³)(b − a) + h s (1 − s) ((1 − s) ȧ − s ḃ), and its derivative
            Interpolation::Cubic => {
                let (r, q) = (1.0 - s, s * (1.0 - s));
                Point {
                    value: a.value
                        + s * s * (3.0 - 2.0 * s) * rise
                        + h * q * (r * a.rate - s * b.rate),
                    rate: 6.0 * q * rise / h
                        + r * (1.0 - 3.0 * s) * a.rate
                        + s * (3.0 * s - 2.0) * b.rate,
                }
            }
        }
    }
}

/// The inputs of one simulation, and the slots that follow them at one time.
#[derive(Clone, Debug, Default)]
pub struct Signals {
    inputs: Vec<Input>,
    /// Whether a function of time in the text drives each input.
    driven: Vec<bool>,
    now: Vec<Segment>,
    /// The segments before the last points.
    before: Vec<Segment>,
    /// Stated parameters, with the values of the inputs at `time`.
    overrides: Vec<Option<f64>>,
    /// Rates of the parameters that are inputs which a program sets, at `time` (1/s).
    rates: Vec<f64>,
    /// Values of the bind graph at `time`.
    nodes: Vec<Pair>,
    /// Values of the slots that move, at `time`.
    values: Vec<f64>,
    /// Time of the values (s); `None` before the first and after a change.
    time: Option<f64>,
}

impl Signals {
    /// The inputs of a model at its start.
    pub fn new(model: &Model) -> Signals {
        let system = &model.compiled.system;
        if system.inputs.is_empty() {
            return Signals::default();
        }
        let overrides = model.overrides.clone();
        let stated = |k: u32| overrides.get(k as usize).copied().flatten().is_some();
        let start = |input: &Input| {
            let value = model.parameters.get(input.parameter as usize);
            Segment::held(0.0, Point::from(value.copied().unwrap_or(f64::NAN)))
        };
        let now: Vec<Segment> = system.inputs.iter().map(start).collect();
        let moving = system.moving.iter().map(|slot| model.slot(*slot));
        Signals {
            driven: (system.inputs.iter())
                .map(|input| input.signal.is_some() && !stated(input.parameter))
                .collect(),
            inputs: system.inputs.clone(),
            before: now.clone(),
            now,
            rates: vec![0.0; overrides.len()],
            overrides,
            nodes: model.nodes.clone(),
            values: moving.collect(),
            time: None,
        }
    }

    /// Values of the slots of [`eng_system::system::System::moving`] at the last time.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// Computes the slots that follow the inputs at a time (s).
    pub fn follow(&mut self, model: &Model, time: f64) {
        if self.inputs.is_empty() || self.time == Some(time) {
            return;
        }
        let mut same = self.time.is_some();
        for k in 0..self.inputs.len() {
            if self.driven[k] {
                same = false;
                continue;
            }
            let Point { value, rate } = self.at(k, time);
            let parameter = self.inputs[k].parameter as usize;
            let places = (self.overrides.get_mut(parameter)).zip(self.rates.get_mut(parameter));
            if let Some((stated, changing)) = places {
                same &= stated.map(f64::to_bits) == Some(value.to_bits());
                same &= changing.to_bits() == rate.to_bits();
                (*stated, *changing) = (Some(value), rate);
            }
        }
        self.time = Some(time);
        if same {
            return;
        }
        let (bind, tables) = (&model.compiled.bind, &model.compiled.system.tables);
        bind.renew(
            &mut self.nodes,
            (&self.overrides, &self.rates),
            time,
            tables,
            &mut self.values,
        );
    }

    /// Value and rate of an input that a program sets.
    fn at(&self, index: usize, time: f64) -> Point {
        let segment = match self.now[index] {
            now if time < now.from => self.before[index],
            now => now,
        };
        segment.at(self.inputs[index].interpolation, time)
    }

    /// Whether a function of time drives an input.
    pub fn is_driven(&self, index: usize) -> bool {
        self.driven.get(index).copied().unwrap_or(false)
    }

    /// Whether all inputs are known at any later time, until a program sets one: functions of time drive them, or they hold their
    /// values.
    pub fn are_known(&self) -> bool {
        let mut inputs = self.driven.iter().zip(&self.inputs);
        inputs.all(|(driven, input)| *driven || input.interpolation == Interpolation::Hold)
    }

    /// The stated parameters, with the values of the inputs that a program sets at a time (s); `None` without such
    /// inputs. Functions of time continue to drive the others.
    pub fn stated_at(&self, time: f64) -> Option<Vec<Option<f64>>> {
        if self.driven.iter().all(|driven| *driven) {
            return None;
        }
        let mut stated = self.overrides.clone();
        for (k, input) in self
            .inputs
            .iter()
            .enumerate()
            .filter(|(k, _)| !self.driven[*k])
        {
            if let Some(place) = stated.get_mut(input.parameter as usize) {
                *place = Some(self.at(k, time).value);
            }
        }
        Some(stated)
    }

    /// The error of slots without a value at the last time, which names the input that has none.
    pub fn defined(&self, model: &Model) -> Result<(), RuntimeError> {
        if self.values.iter().all(|value| value.is_finite()) {
            return Ok(());
        }
        let (bind, system) = (&model.compiled.bind, &model.compiled.system);
        let Err(BindError::NotFinite { path, outside }) = bind.check(&self.nodes, &system.tables)
        else {
            // an expression of inputs has no value; the error of the element that reads it reports this
            return Ok(());
        };
        let found = system.parameters.iter().find(|p| p.origin.path == path);
        let origin = found.map(|parameter| parameter.origin.clone());
        Err(RuntimeError::NotFinite {
            origin: Box::new(origin.unwrap_or_default()),
            because: outside.map(|outside| Box::new(Undefined::Table(*outside))),
            moment: Moment {
                time: self.time.unwrap_or_default(),
                cycle_angle: None,
            },
        })
    }

    /// Checks limits of parameters and their conditions at the last time. Returns the failed `advise`s.
    pub fn check(&self, model: &Model) -> Result<Vec<Advice>, BindError> {
        if self.inputs.is_empty() {
            return Ok(Vec::new());
        }
        let tables = &model.compiled.system.tables;
        model.compiled.bind.check(&self.nodes, tables)
    }

    fn refuse<T>(
        &self,
        model: &Model,
        index: usize,
        message: impl Into<String>,
    ) -> Result<T, RuntimeError> {
        let parameter = (self.inputs.get(index)).and_then(|input| {
            model
                .compiled
                .system
                .parameters
                .get(input.parameter as usize)
        });
        Err(RuntimeError::Input {
            origin: Box::new(parameter.map(|p| p.origin.clone()).unwrap_or_default()),
            message: message.into(),
        })
    }

    /// The error of an input that a function of time drives.
    pub fn refuse_driven(&self, model: &Model, index: usize) -> Result<(), RuntimeError> {
        self.refuse(
            model,
            index,
            "the analysis drives it by a function of time, so a program cannot set it",
        )
    }

    /// Checks a value for an input that a program sets.
    fn settable(&self, model: &Model, index: usize, point: Point) -> Result<Input, RuntimeError> {
        let Some(input) = self.inputs.get(index).cloned() else {
            return Err(RuntimeError::Options {
                message: format!(
                    "there is no input {index}: the model has {}",
                    self.inputs.len()
                ),
            });
        };
        if self.driven[index] {
            self.refuse_driven(model, index)?;
        }
        let finite = point.value.is_finite() && point.rate.is_finite();
        if !finite {
            return self.refuse(
                model,
                index,
                format!(
                    "its value {} or rate {} is no number",
                    point.value, point.rate
                ),
            );
        }
        if point.rate != 0.0 && input.interpolation != Interpolation::Cubic {
            return self.refuse(
                model,
                index,
                format!(
                    "it has no rate: it is declared with `interpolation: {}`, and only `cubic` takes rates",
                    input.interpolation.word()
                ),
            );
        }
        if let Some(parameter) = (model.compiled.system.parameters).get(input.parameter as usize) {
            let (low, high) = parameter.limits;
            if point.value <= low || point.value >= high {
                let shown = |x: f64| parameter.display.text(x);
                return self.refuse(
                    model,
                    index,
                    format!(
                        "{} is outside its limits: it must be above {} and below {}",
                        shown(point.value),
                        shown(low),
                        shown(high)
                    ),
                );
            }
        }
        Ok(input)
    }

    /// Sets an input from a time (s) on. `started` is false before the first step.
    pub fn set(
        &mut self,
        model: &Model,
        index: usize,
        point: Point,
        time: f64,
        started: bool,
    ) -> Result<(), RuntimeError> {
        let input = self.settable(model, index, point)?;
        if input.interpolation == Interpolation::Cubic && started {
            let now = self.at(index, time);
            if point != now {
                return self.refuse(
                    model,
                    index,
                    format!(
                        "an input with `interpolation: cubic` has no jump: at {time} s it is {} with the rate {} per second; give value and rate of the next point instead",
                        now.value, now.rate
                    ),
                );
            }
        }
        if self.now[index].from < time {
            self.before[index] = self.now[index];
        }
        self.now[index] = Segment::held(time, point);
        self.time = None;
        Ok(())
    }

    /// Gives the value of an input at the next point.
    pub fn aim(
        &mut self,
        model: &Model,
        index: usize,
        point: Point,
        time: f64,
    ) -> Result<(), RuntimeError> {
        let input = self.settable(model, index, point)?;
        if input.interpolation == Interpolation::Hold {
            return self.refuse(
                model,
                index,
                "it holds its value between two points; declare it with `interpolation: linear` or `cubic`",
            );
        }
        if self.now[index].from < time {
            let left = self.at(index, time);
            self.before[index] = self.now[index];
            self.now[index] = Segment::held(time, left);
        }
        self.now[index].right = Some(point);
        Ok(())
    }

    /// Whether a value at the next point is given, which the program has not reached.
    pub fn aims(&self) -> bool {
        self.now.iter().any(|segment| segment.right.is_some())
    }

    /// The next point is at a time (s).
    pub fn towards(&mut self, model: &Model, to: f64) -> Result<(), RuntimeError> {
        for (index, segment) in self.now.iter_mut().enumerate() {
            if segment.right.is_some() {
                segment.to = to;
                self.time = None;
            } else if segment.left.rate != 0.0 {
                return self.refuse(
                    model,
                    index,
                    "it has a rate, so it needs value and rate of the next point",
                );
            }
        }
        Ok(())
    }

    /// The next point is reached. From here on the rates are those of the next segments.
    pub fn arrive(&mut self) {
        if self.aims() {
            self.time = None;
        }
        for (now, before) in self.now.iter_mut().zip(&mut self.before) {
            if let Some(right) = now.right {
                *before = *now;
                *now = Segment::held(now.to, right);
            }
        }
    }

    /// Whether an input jumps at a time (s), or the rate of one whose rate is read.
    pub fn jumps(&self, time: f64) -> bool {
        let pairs = self.now.iter().zip(&self.before).zip(&self.inputs);
        let mut pairs = pairs.filter(|((now, before), _)| now.from == time && before != now);
        pairs.any(|((now, before), input)| {
            let [before, now] = [before, now].map(|segment| segment.at(input.interpolation, time));
            before.value != now.value || input.differentiated && before.rate != now.rate
        })
    }

    /// Forgets the jumps at the last points, after the motion has started again there.
    pub fn accept_jumps(&mut self) {
        self.before.clone_from(&self.now);
    }

    /// All segments, for a checkpoint.
    pub fn numbers(&self) -> Vec<f64> {
        let segments = self.now.iter().chain(&self.before);
        segments
            .flat_map(|s| {
                let right = s.right.unwrap_or_default();
                let known = f64::from(u8::from(s.right.is_some()));
                [
                    s.from,
                    s.left.value,
                    s.left.rate,
                    s.to,
                    known,
                    right.value,
                    right.rate,
                ]
            })
            .collect()
    }

    /// Sets the segments from a checkpoint.
    pub fn set_numbers(&mut self, numbers: &[f64]) {
        let segments = self.now.iter_mut().chain(&mut self.before);
        for (segment, numbers) in segments.zip(numbers.as_chunks::<7>().0) {
            let [from, value, rate, to, known, right, right_rate] = *numbers;
            *segment = Segment {
                from,
                left: Point { value, rate },
                to,
                right: (known == 1.0).then_some(Point {
                    value: right,
                    rate: right_rate,
                }),
            };
        }
        self.time = None;
    }
}
