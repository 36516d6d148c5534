//! Derivatives of the channels of a motion by parameters, with the steps of the motion.
//!
//! The derivative of the state goes along with the motion ([`StepDerivative`]). Beside the motion stand simulations with the
//! parameter a little above and below its value. They never take a step: they give the derivatives of the start, of a
//! step's residual and of the outputs at a state of the motion. All these are central differences of fourth order,
//! `(8 (f(ε) − f(−ε)) − (f(2ε) − f(−2ε)))/12ε`. The motion itself does not change by a bit.

mod repeated;

pub(crate) use repeated::Units;

use super::{Simulation, Warning};
use crate::acceleration::Factors;
use crate::dynamics::Dynamics;
use crate::error::{Moment, RuntimeError};
use crate::integrator::{StepDerivative, Variation};
use crate::model::Model;
use crate::start::StartReport;
use crate::state::State;
use eng_system::code::Compiled;
use eng_system::dense::{add_scaled, largest, largest_scaled};
use eng_system::dimension::Dimension;
use eng_system::system::{Origin, Parameter};

/// Distances of a difference, in increments, and the weights of the values there.
const AROUND: [(f64, f64); 4] = [
    (1.0, 8.0 / 12.0),
    (-1.0, -8.0 / 12.0),
    (2.0, -1.0 / 12.0),
    (-2.0, 1.0 / 12.0),
];
/// Increment of a parameter, as a share of its size. It is a third of the fifth root of the rounding unit,
/// near which a difference of fourth order has its least error. Rounding leaves about 1e-9 of ∂R/∂p.
const SHARE: f64 = 2.5e-4;
/// Largest displacement of a marker by an increment, as a share of the model's position tolerance. The
/// tolerance is a thousandth of the smallest clearance, so forces are smooth over this displacement. A
/// quarter is a choice: differences use twice the increment.
const REACH: f64 = 0.25;
/// The same as a share of the model's length, if no class resolves a length. A choice: joints and springs are
/// smooth over a much longer way.
const REACH_OF_LENGTH: f64 = 1e-4;
/// Largest move of the state over the increment of a parameter, in multiples of the lengths above, at which
/// one difference of a sample serves the state and the parameter together. Times [`REACH`] it is the
/// tolerance of positions.
const JOINT: f64 = 4.0;
/// Largest change of a state by an increment, as a share of its size. A choice: laws of states are smooth
/// over this, and a difference keeps ten digits or more.
const STATES: f64 = 1e-4;
/// Largest difference between the derivatives of the start over one and over two increments: as a share of
/// the largest derivative, plus a share of the model's sizes per relative change of the parameter. Choices:
/// differences of fourth order agree far better where the start is smooth, and the second share is rounding.
const START: (f64, f64) = (1e-4, 1e-6);
/// Displacement over the model's length per relative change of a parameter. Above it a gradient predicts only
/// changes below a millionth of the parameter.
const SENSITIVE: f64 = 1e6;
/// Increment of the time of a sample, as a share of the step. A choice: the interpolation is a polynomial
/// over the step, so differences over a hundredth of it are exact but for rounding.
const MOMENT: f64 = 1e-2;
/// Numbers of the cycle behind the channels of a sample: its angle and its rate.
const CYCLE: usize = 2;

/// The derivatives by several parameters beside a simulation.
#[derive(Debug)]
pub struct Gradients {
    parameters: Vec<Beside>,
    step: StepDerivative,
    dynamics: Dynamics,
    /// The same model, for differences along the motion of the state.
    same: Box<Simulation>,
    /// The step (s) to which the auxiliary numbers belong.
    auxiliary_step: f64,
    /// Whether no step was followed yet.
    at_start: bool,
    /// How often the motion had begun again at a jump of accelerations before these derivatives.
    renewals: u64,
    /// How many of the parameters have samples.
    sampled: usize,
    /// Length (m) over which forces are smooth.
    reach: f64,
    /// Whether the warnings of a kink and of a sensitive motion were given.
    warned: [bool; 2],
}

/// The derivatives of a sample by a parameter (SI).
#[derive(Clone, Copy, Debug)]
pub struct SampleGradient<'s> {
    /// Derivative of its time; zero if the sample does not lie at a cycle angle. In a motion that repeats it is the derivative
    /// of the time since the beginning of the cycle.
    pub time: f64,
    /// Derivatives of the cycle angle and of its rate; zero without a cycle.
    pub cycle: [f64; 2],
    /// Derivatives of all channels.
    pub channels: &'s [f64],
}

/// The derivative by one parameter.
#[derive(Debug)]
struct Beside {
    /// The parameter.
    origin: Origin,
    /// Its size and its increment (SI).
    size: f64,
    increment: f64,
    /// Derivative of the time at which the derivatives of the state hold, constant over a cycle. It is zero but in a motion
    /// that repeats: see [`repeated`].
    clock: f64,
    /// The simulations at the distances of [`AROUND`]; none for a deviation that belongs to no parameter.
    around: Vec<Simulation>,
    /// At the beginning and at the end of the last step.
    before: Variation,
    now: Variation,
    /// Channels, cycle angle and its rate at the start.
    start: Vec<f64>,
}

fn refused(message: String) -> RuntimeError {
    RuntimeError::Options { message }
}

impl Gradients {
    /// The derivatives by parameters (indices in the system) beside a simulation at its start. `overrides` are the stated
    /// values of parameters of this simulation.
    ///
    /// # Errors
    /// A model or a parameter without derivatives; a start that is not smooth in a parameter; the errors of a
    /// start at values of a parameter nearby.
    pub fn new(
        compiled: &Compiled,
        overrides: &[Option<f64>],
        parameters: &[usize],
        base: &Simulation,
    ) -> Result<Gradients, RuntimeError> {
        let reach = reach(compiled, &base.model)?;
        let parameters = parameters.iter();
        let beside = parameters.map(|index| {
            let nearby = Nearby::new(compiled, overrides, *index, &base.model, reach)?;
            Beside::new(compiled, nearby, base)
        });
        Gradients::beside(beside.collect::<Result<_, _>>()?, base, reach)
    }

    /// Derivatives beside a simulation at its start.
    fn beside(
        parameters: Vec<Beside>,
        base: &Simulation,
        reach: f64,
    ) -> Result<Gradients, RuntimeError> {
        let model = &base.model;
        let state = base.integrator.current.clone();
        let mut same = Simulation::with_state(model.clone(), state, base.options)?;
        same.system.stand_beside();
        Ok(Gradients {
            sampled: parameters.len(),
            parameters,
            step: StepDerivative::new(model),
            dynamics: Dynamics::new(model),
            same: Box::new(same),
            auxiliary_step: base.integrator.auxiliary_step(),
            at_start: true,
            renewals: base.renewals,
            reach,
            warned: [false; 2],
        })
    }

    /// Carries the derivatives over the step (s) that the motion took last.
    ///
    /// # Errors
    /// A jump of accelerations; derivatives that are not finite.
    pub fn follow(&mut self, base: &mut Simulation, h: f64) -> Result<(), RuntimeError> {
        if base.renewals > self.renewals {
            return Err(refused(format!(
                "accelerations jump at {} s, and Eng has no gradients across such a jump yet: make the load smooth, or take a fixed `step`",
                base.integrator.previous.time
            )));
        }
        let model = &base.model;
        let from = &base.integrator;
        let ratio = h / self.auxiliary_step;
        let changed = !self.at_start && ratio != 1.0;
        if changed {
            self.find_defects(model, &from.previous)?;
        }
        let (start, end) = (&from.previous, &from.current);
        self.dynamics
            .place(model, end.time, &end.pose, &end.velocity);
        (self.dynamics).gather(model, &end.states, &end.multipliers, &start.rotations);
        self.dynamics.evaluate(model)?;
        self.step.make(model, &mut self.dynamics, from, h)?;
        let mut partial = vec![0.0; from.unknowns()];
        let mut residual = partial.clone();
        for beside in &mut self.parameters {
            partial.fill(0.0);
            for (simulation, (at, weight)) in beside.around.iter_mut().zip(AROUND) {
                let time = end.time + at * beside.increment * beside.clock;
                residual_at(simulation, end, time, &start.rotations, &mut residual)?;
                add_scaled(&mut partial, weight / beside.increment, &residual);
            }
            std::mem::swap(&mut beside.before, &mut beside.now);
            let share = match (self.at_start, changed) {
                (true, _) => ratio * ratio,
                (false, true) => ratio * ratio - 1.0,
                (false, false) => 0.0,
            };
            let mut old = beside.before.clone();
            add_scaled(&mut old.velocity, share, &beside.before.defect);
            let steps = (h, ratio);
            beside.now = self.step.advance(model, from, steps, &old, &partial);
            // after a kink the auxiliary numbers begin with the accelerations
            if from.auxiliary_step() != h {
                beside.now.auxiliary.clone_from(&beside.now.acceleration);
                beside.now.state_auxiliary.clone_from(&beside.now.rates);
            }
        }
        self.at_start = false;
        self.auxiliary_step = from.auxiliary_step();
        self.warn_of_kinks(base);
        self.warn_of_growth(base);
        Ok(())
    }

    /// Gives a warning if small changes decide the motion.
    fn warn_of_growth(&mut self, base: &mut Simulation) {
        let scales = base.model.velocity_scales();
        let grown = self
            .parameters
            .iter()
            .filter(|beside| !beside.around.is_empty())
            .find(|beside| largest_scaled(&beside.now.place, &scales) * beside.size > SENSITIVE);
        let Some(beside) = grown.filter(|_| !self.warned[1]) else {
            return;
        };
        self.warned[1] = true;
        let moment = base.moment();
        base.warnings.push(Warning {
            name: String::new(),
            origin: beside.origin.clone(),
            message: format!(
                "the motion is sensitive to {0}, as after impacts: from here on its gradients hold only for changes of {0} below a millionth",
                beside.origin.path
            ),
            label: "the motion is sensitive to it",
            moment,
        });
    }

    /// Gives a warning for the first state at which two sides of a load or a constraint are active.
    fn warn_of_kinks(&mut self, base: &mut Simulation) {
        let (time, factor) = (base.integrator.current.time, base.options.step.tolerance());
        let mut here = base.kinks.here(time, factor).into_iter();
        let kink = here.find(|kink| !base.kinks.is_moment(*kink));
        let Some(kink) = kink.filter(|_| !self.warned[0]) else {
            return;
        };
        self.warned[0] = true;
        let (origin, function) = base.kinks.place(&base.model, kink);
        let moment = base.moment();
        base.warnings.push(Warning {
            name: String::new(),
            origin,
            message: format!(
                "the motion stands at a kink of {function}: from here on the gradients are those of one of its two sides"
            ),
            label: "the motion stands at its kink",
            moment,
        });
    }

    /// The derivatives of the part of the velocity that violates the constraints, at the beginning of the last step.
    ///
    /// The part is `x = P Φ̇(q, v)` with `G P = 1`. P gives the least change of velocities in the measure of
    /// the step's matrix ([`StepDerivative::nearest_change`]). With the velocity `v̄ = v − x` without the
    /// part, the derivative is `P δΦ̇(q, v̄)`. The derivative of P is left out: it is a share of x in
    /// tangential directions, and x is of the size `C h² v̈`.
    fn find_defects(&mut self, model: &Model, start: &State) -> Result<(), RuntimeError> {
        let mut base = start.clone();
        let mut rates = rates_at(&mut self.dynamics, model, &base)?;
        let mut change = vec![0.0; model.velocities];
        for _ in 0..2 {
            self.step.nearest_change(model, &rates, &mut change);
            add_scaled(&mut base.velocity, -1.0, &change);
            rates = rates_at(&mut self.dynamics, model, &base)?;
        }
        for beside in &mut self.parameters {
            let mut sum = vec![0.0; model.rows];
            beside.add_rates(model, &mut self.dynamics, &base, self.reach, &mut sum)?;
            self.step
                .nearest_change(model, &sum, &mut beside.now.defect);
            self.dynamics.set_state(model, &base, &[]);
            let mut left = vec![0.0; model.rows];
            self.dynamics
                .constraints_along(model, &beside.now.defect, &mut left)?;
            for (left, sum) in left.iter_mut().zip(&sum) {
                *left = sum - *left;
            }
            self.step.nearest_change(model, &left, &mut change);
            add_scaled(&mut beside.now.defect, 1.0, &change);
        }
        Ok(())
    }

    /// Gives the derivatives at the sample that the simulation took last: calls `give` with the index of each parameter. A
    /// sample at a cycle angle has the derivatives at this angle.
    ///
    /// # Errors
    /// Outputs that are not defined nearby.
    pub fn sample(
        &mut self,
        base: &mut Simulation,
        angle: Option<f64>,
        give: &mut dyn FnMut(usize, SampleGradient<'_>),
    ) -> Result<(), RuntimeError> {
        if self.at_start {
            for (index, beside) in self.parameters.iter().enumerate() {
                if let [channels @ .., turned, speed] = beside.start.as_slice() {
                    let (time, cycle) = (0.0, [*turned, *speed]);
                    give(
                        index,
                        SampleGradient {
                            time,
                            cycle,
                            channels,
                        },
                    );
                }
            }
            return Ok(());
        }
        let sample = Sampled {
            moment: Moment {
                time: base.completed.time,
                cycle_angle: angle,
            },
            settles: base.completed.time < base.integrator.current.time,
            later: 0.0,
        };
        let rates = match angle {
            Some(_) => Some(self.rates_of_time(base, sample)?),
            None => None,
        };
        let mut sum = vec![0.0; base.outputs.values.len() + CYCLE];
        for index in 0..self.sampled {
            self.sample_one(base, index, sample, &mut sum)?;
            let mut time = 0.0;
            if let (Some(rates), [.., turned, _]) = (rates.as_deref(), sum.as_mut_slice())
                && let [.., speed, _] = rates
            {
                // the sample keeps its angle
                time = -*turned / speed;
                add_scaled(&mut sum, time, rates);
                if let [.., turned, _] = sum.as_mut_slice() {
                    *turned = 0.0;
                }
            }
            if let [channels @ .., turned, speed] = sum.as_slice() {
                let cycle = [*turned, *speed];
                give(
                    index,
                    SampleGradient {
                        time,
                        cycle,
                        channels,
                    },
                );
            }
        }
        Ok(())
    }

    /// The derivatives of all channels, of the cycle angle and of its rate (SI) by a parameter, at the time of a sample.
    fn sample_one(
        &mut self,
        base: &mut Simulation,
        index: usize,
        sample: Sampled,
        sum: &mut [f64],
    ) -> Result<(), RuntimeError> {
        let beside = &mut self.parameters[index];
        sum.fill(0.0);
        let ends = [&beside.before, &beside.now];
        let state = &base.integrator.current;
        let distance = distance(&base.model, state, ends, self.reach);
        // one difference serves both parts if the state moves little enough over the increment of the parameter
        let joint = !beside.around.is_empty()
            && distance.is_none_or(|distance| beside.increment <= JOINT * distance);
        let along = if joint { beside.increment } else { 0.0 };
        for (simulation, (at, weight)) in beside.around.iter_mut().zip(AROUND) {
            (simulation.integrator).stand_beside(&base.model, &base.integrator, ends, at * along);
            let later = at * beside.increment * beside.clock;
            let sample = Sampled { later, ..sample };
            sample_beside(simulation, base, sample, weight / beside.increment, sum)?;
        }
        let Some(distance) = distance.filter(|_| !joint) else {
            return Ok(());
        };
        for (at, weight) in AROUND {
            (self.same.integrator).stand_beside(&base.model, &base.integrator, ends, at * distance);
            sample_beside(&mut self.same, base, sample, weight / distance, sum)?;
        }
        Ok(())
    }

    /// The rates of all channels, of the cycle angle and of its rate (SI per second) at a sample.
    fn rates_of_time(
        &mut self,
        base: &mut Simulation,
        sample: Sampled,
    ) -> Result<Vec<f64>, RuntimeError> {
        let mut rates = vec![0.0; base.outputs.values.len() + CYCLE];
        let increment = MOMENT * (base.integrator.current.time - base.integrator.previous.time);
        let still = Variation::new(&base.model);
        (self.same.integrator).stand_beside(&base.model, &base.integrator, [&still; 2], 0.0);
        let mut rest = 0.0;
        for (at, weight) in AROUND {
            let mut there = sample;
            there.moment.time += at * increment;
            // divided by the increment that rounding leaves of the time
            let share = weight * at / (there.moment.time - sample.moment.time);
            sample_beside(&mut self.same, base, there, share, &mut rates)?;
            rest += share;
        }
        // the shares would sum to zero without rounding: the value at the sample itself takes the rest
        add_channels(base, -rest, &mut rates);
        Ok(rates)
    }
}

/// A sample in the last step.
#[derive(Clone, Copy, Debug)]
struct Sampled {
    moment: Moment,
    /// Whether it is settled: see [`crate::integrator::Integrator::settle`].
    settles: bool,
    /// How much later (s) the same place of the step is taken: the shift of the clock.
    later: f64,
}

/// A parameter, and values of it nearby.
struct Nearby {
    origin: Origin,
    /// Its index, value, size and increment (SI).
    index: usize,
    value: f64,
    size: f64,
    increment: f64,
    overrides: Vec<Option<f64>>,
}

impl Nearby {
    fn new(
        compiled: &Compiled,
        overrides: &[Option<f64>],
        index: usize,
        model: &Model,
        reach: f64,
    ) -> Result<Nearby, RuntimeError> {
        let system = &compiled.system;
        let (Some(parameter), Some(value)) =
            (system.parameters.get(index), model.parameters.get(index))
        else {
            return Err(refused(format!("there is no parameter {index}")));
        };
        let path = &parameter.origin.path;
        if system
            .inputs
            .iter()
            .any(|input| input.parameter as usize == index)
        {
            return Err(refused(format!(
                "{path} is an input, which may change during the run, and there are no gradients by inputs yet: declare it as `param`"
            )));
        }
        let mut overrides = overrides.to_vec();
        overrides.resize(system.parameters.len(), None);
        let increment = increment(model, parameter, *value)?;
        let mut nearby = Nearby {
            origin: parameter.origin.clone(),
            index,
            value: *value,
            size: increment / SHARE,
            increment,
            overrides,
        };
        let near = Model::bind(compiled, &nearby.at(1.0))?;
        if near
            .slots
            .iter()
            .zip(&model.slots)
            .all(|(a, b)| a.to_bits() == b.to_bits())
        {
            return Err(refused(format!(
                "{path} changes no number of the motion, so no channel has a derivative by it; constants and meshes do not follow a parameter"
            )));
        }
        nearby.increment *= (reach / moved_by(model, &near)).min(1.0);
        Ok(nearby)
    }

    /// The stated values of all parameters, with this one at a distance in increments.
    fn at(&self, distance: f64) -> Vec<Option<f64>> {
        let mut stated = self.overrides.clone();
        stated[self.index] = Some(self.value + distance * self.increment);
        stated
    }
}

impl Beside {
    fn new(compiled: &Compiled, nearby: Nearby, base: &Simulation) -> Result<Beside, RuntimeError> {
        let path = &nearby.origin.path;
        let mut around = Vec::with_capacity(AROUND.len());
        for (distance, _) in AROUND {
            let mut simulation = Simulation::new(compiled, &nearby.at(distance), base.options)?;
            simulation.same_start(base, path)?;
            simulation.system.stand_beside();
            around.push(simulation);
        }
        let path = path.clone();
        let mut beside = Beside::around(nearby, around, &base.model);
        beside.begin(base, &path)?;
        Ok(beside)
    }

    /// The derivative by a parameter before its start, beside simulations at its values nearby.
    fn around(nearby: Nearby, around: Vec<Simulation>, model: &Model) -> Beside {
        Beside {
            origin: nearby.origin,
            size: nearby.size,
            increment: nearby.increment,
            clock: 0.0,
            before: Variation::new(model),
            now: Variation::new(model),
            start: vec![0.0; model.compiled.system.channels.len() + CYCLE],
            around,
        }
    }

    /// Adds the derivative of Φ̇ at a state by the parameter, the clock, and along the present place, velocities and states.
    fn add_rates(
        &mut self,
        model: &Model,
        dynamics: &mut Dynamics,
        base: &State,
        reach: f64,
        sum: &mut [f64],
    ) -> Result<(), RuntimeError> {
        let mut moved = base.clone();
        for (simulation, (at, weight)) in self.around.iter_mut().zip(AROUND) {
            moved.time = base.time + at * self.increment * self.clock;
            let (dynamics, model) = (&mut simulation.dynamics, &simulation.model);
            let rates = rates_at(dynamics, model, &moved)?;
            add_scaled(sum, weight / self.increment, &rates);
        }
        let along = Variation {
            place: self.now.place.clone(),
            velocity: self.now.velocity.clone(),
            states: self.now.states.clone(),
            ..Variation::new(model)
        };
        if let Some(distance) = distance(model, base, [&along; 2], reach) {
            for (at, weight) in AROUND {
                along.moved(model, base, at * distance, &mut moved);
                let rates = rates_at(dynamics, model, &moved)?;
                add_scaled(sum, weight / distance, &rates);
            }
        }
        Ok(())
    }

    /// The derivatives of the start and of its channels.
    fn begin(&mut self, base: &Simulation, path: &str) -> Result<(), RuntimeError> {
        let model = &base.model;
        let mut values = self.start.clone();
        let mut short = Variation::new(model);
        let mut long = Variation::new(model);
        for (simulation, (distance, weight)) in self.around.iter_mut().zip(AROUND) {
            let share = weight / self.increment;
            let (own, from) = (&simulation.integrator, &base.integrator);
            self.now.add_difference(model, own, from, share);
            // the derivative over one increment, and that over two
            let one = if distance.abs() < 1.5 {
                &mut short
            } else {
                &mut long
            };
            one.add_difference(model, own, from, 0.5 / (distance * self.increment));
            if let [channels @ .., _, _] = values.as_mut_slice() {
                simulation.evaluate_channels(channels)?;
            }
            if let ([.., turned, speed], Some(cycle)) =
                (values.as_mut_slice(), simulation.sampled_cycle()?)
            {
                [*turned, *speed] = cycle;
            }
            add_scaled(&mut self.start, share, &values);
            // the simulation takes kept factors of the motion, whose rows have the scales of the motion
            let (length, mass) = (model.length, model.mass);
            (simulation.model.length, simulation.model.mass) = (length, mass);
        }
        self.before.clone_from(&self.now);
        let scales = model.velocity_scales();
        let size = 1.0 / self.size;
        let pairs = [
            (&short.place, &long.place, &scales),
            (&short.velocity, &long.velocity, &scales),
            (&short.states, &long.states, &model.state_scales),
        ];
        for (short, long, scales) in pairs {
            let differences: Vec<f64> = short.iter().zip(long).map(|(a, b)| a - b).collect();
            let differ = largest_scaled(&differences, scales);
            let largest = largest_scaled(short, scales);
            if differ > START.0 * largest + START.1 * size {
                return Err(refused(format!(
                    "the start is not a smooth function of {path}: its differences over one and over two increments of {:.2e} (SI) disagree by \
                     {:.1e} of their size; state `start: assembled`, or begin from a state that does not depend on {path}",
                    self.increment,
                    differ / largest
                )));
            }
        }
        Ok(())
    }
}

impl Simulation {
    /// Refuses a start of another kind than that of the base, at a value of a parameter nearby.
    fn same_start(&self, base: &Simulation, path: &str) -> Result<(), RuntimeError> {
        let kind = |start: &StartReport| std::mem::discriminant(start);
        if kind(&self.start) == kind(&base.start) {
            return Ok(());
        }
        Err(refused(format!(
            "the start is not a smooth function of {path}: a value nearby has another kind of start; state `start: assembled`"
        )))
    }
}

/// The length (m) over which the forces of a model are smooth.
///
/// # Errors
/// A model without derivatives.
fn reach(compiled: &Compiled, model: &Model) -> Result<f64, RuntimeError> {
    let mut fields = model.kernels.iter().zip(&compiled.system.elements);
    if let Some((_, element)) = fields.find(|(kernels, _)| !kernels.is_empty()) {
        return Err(refused(format!(
            "{} solves its film on cells, and Eng has no gradients of such a film yet: take a film whose force is a formula or a table, or \
             compare two runs",
            element.origin.path
        )));
    }
    Ok(match compiled.system.resolutions.is_empty() {
        true => REACH_OF_LENGTH * model.length,
        false => REACH * model.tolerance,
    })
}

/// The increment (SI) of a parameter, from its value, its limits and its dimension.
fn increment(model: &Model, parameter: &Parameter, value: f64) -> Result<f64, RuntimeError> {
    let (low, high) = parameter.limits;
    let size = match (value != 0.0, high - low) {
        (true, _) => value.abs(),
        (false, range) if range.is_finite() => range,
        (false, _) if parameter.dimension == Dimension::LENGTH => model.length,
        (false, _) if parameter.dimension == Dimension::ANGLE => 1.0,
        (false, _) => {
            return Err(refused(format!(
                "{} is zero and has no limits, so there is no measure for a small change of it: state limits, such as `in (-1, 1)`",
                parameter.origin.path
            )));
        }
    };
    // both limits are open
    let room = (high - value).min(value - low);
    // twice the increment must stay within the limits: 0.4 leaves a fifth of the room
    Ok((SHARE * size).min(0.4 * room))
}

/// The largest displacement (m) of a marker in its body between two models, or its rotation times the model's length.
fn moved_by(model: &Model, near: &Model) -> f64 {
    let pairs = model.markers.iter().zip(&near.markers);
    // a marker that the assembly places at another one has no position of its own
    let own = pairs.filter(|(_, near)| near.placed_at.is_none());
    own.fold(0.0_f64, |most, (a, b)| {
        let turned = (a.orientation - b.orientation).amax() * model.length;
        most.max((a.position - b.position).amax()).max(turned)
    })
}

/// The residual of a step at its end, unscaled, for the parameters of another simulation and at a time (s).
fn residual_at(
    simulation: &mut Simulation,
    end: &State,
    time: f64,
    rotations: &[f64],
    out: &mut [f64],
) -> Result<(), RuntimeError> {
    let (model, dynamics) = (&simulation.model, &mut simulation.dynamics);
    let (n, s) = (model.velocities, model.states);
    dynamics.place(model, time, &end.pose, &end.velocity);
    dynamics.gather(model, &end.states, &end.multipliers, rotations);
    dynamics.evaluate(model)?;
    out.fill(0.0);
    dynamics.add_inertia(model, &end.velocity, &end.acceleration, &mut out[..n]);
    dynamics.add_forces(model, -1.0, &mut out[..n]);
    for (r, rate) in out[n..n + s].iter_mut().zip(dynamics.rates()) {
        *r = -rate;
    }
    out[n + s..].copy_from_slice(dynamics.constraints());
    Ok(())
}

/// The rates Φ̇ of the constraints at a state. In SI: m/s or rad/s.
fn rates_at(
    dynamics: &mut Dynamics,
    model: &Model,
    state: &State,
) -> Result<Vec<f64>, RuntimeError> {
    dynamics.set_state(model, state, &[]);
    dynamics.rate_level(model)?;
    Ok(dynamics.constraint_rates().to_vec())
}

/// The increment of the parameter over which these derivatives of the state move nothing farther than forces
/// are smooth: places by `reach` (m), velocities and states by like shares of their sizes. `None` if all
/// derivatives are zero.
fn distance(model: &Model, state: &State, along: [&Variation; 2], reach: f64) -> Option<f64> {
    let scales = model.velocity_scales();
    let motion_rate = state.motion_rate(model);
    let sizes: Vec<f64> = (model.state_scales.iter().zip(&state.states))
        .map(|(scale, y)| scale.max(y.abs()))
        .collect();
    let shares = along.map(|change| {
        let place = largest_scaled(&change.place, &scales) * model.length / reach;
        let speed = largest_scaled(&change.velocity, &scales) * model.length / reach;
        let speed = if motion_rate > 0.0 {
            speed / motion_rate
        } else {
            0.0
        };
        let states = largest_scaled(&change.states, &sizes) / STATES;
        place.max(speed).max(states)
    });
    let share = shares[0].max(shares[1]);
    let others = along.iter().any(|change| {
        largest(&change.velocity) > 0.0
            || largest(&change.acceleration) > 0.0
            || largest(&change.rates) > 0.0
            || largest(&change.multipliers) > 0.0
    });
    if share > 0.0 {
        Some(1.0 / share)
    } else {
        // a choice for parameters that move no marker: a millionth of their size, far above rounding
        others.then_some(1e-6)
    }
}

/// Adds a multiple of the channels, of the cycle angle and of its rate (SI) at a time, for a simulation that
/// stands beside the motion. It solves with the kept factors of the motion.
fn sample_beside(
    simulation: &mut Simulation,
    base: &mut Simulation,
    sample: Sampled,
    factor: f64,
    sum: &mut [f64],
) -> Result<(), RuntimeError> {
    let mut exchange = |simulation: &mut Simulation| {
        (base.integrator).exchange_factors(&mut simulation.integrator);
        base.system.exchange_factors(&mut simulation.system);
    };
    exchange(simulation);
    let done = simulation.sample_near(sample);
    // the scales are the same, so the way back changes none
    exchange(simulation);
    done?;
    add_channels(simulation, factor, sum);
    Ok(())
}

/// Adds a multiple of the channels, of the cycle angle and of its rate (SI) of the last sample of a simulation.
fn add_channels(simulation: &Simulation, factor: f64, sum: &mut [f64]) {
    add_scaled(sum, factor, &simulation.outputs.values);
    if let ([.., turned, speed], Some(cycle)) = (sum, &simulation.cycle) {
        *turned += factor * cycle.watched_values[0];
        *speed += factor * cycle.watched_values[1];
    }
}

impl Simulation {
    /// Evaluates the outputs of a sample of the step beside which this simulation stands, and its cycle angle.
    fn sample_near(&mut self, sample: Sampled) -> Result<(), RuntimeError> {
        self.evaluated = None;
        let Sampled {
            moment,
            settles,
            later,
        } = sample;
        let (from, to) = (self.integrator.previous.time, self.integrator.current.time);
        let fraction = (moment.time - from) / (to - from);
        let (model, dynamics) = (&self.model, &mut self.dynamics);
        let state = &mut self.completed;
        (self.integrator).interpolate(model, fraction, &mut self.work, state);
        state.time = moment.time + later;
        self.system
            .project(model, dynamics, state, moment, Factors::Kept)?;
        let moment = (moment, settles);
        self.system
            .finish(model, dynamics, &mut self.integrator, state, moment)?;
        self.outputs.evaluate(model, dynamics, state)?;
        self.cycle_of_completed()?;
        Ok(())
    }
}
