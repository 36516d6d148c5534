//! Derivatives of a motion that repeats with its cycle.
//!
//! A parameter p changes the period T of such a motion, and all its states at given angles of the cycle. The derivatives follow
//! the motion over whole cycles, until they repeat at the angles of the cycle: see `periodic::gradients`. At the beginning
//! they are those of a state x that satisfies the constraints Φ and does not move otherwise,
//!
//! ```text
//! δq = −P (∂Φ/∂p + Φ_t δt)      δv = −P δΦ̇      G P = 1
//! ```
//!
//! with the least change P in the mass norm. A drive that turns by the clock has `∂Φ/∂p = −t`, which is large after many
//! cycles. So the state with the derivative δx stands at another time: its clock differs by δt. At the beginning and at the end
//! of each cycle this δt leaves the angle θ of the cycle where it is: `δt` changes by `−δθ/θ̇`, and δx by `−ẋ δθ/θ̇`.
//!
//! A deviation without a parameter goes along: it shows whether deviations decay. It is random, but the same in every run.

use super::{AROUND, Beside, Gradients, Nearby, distance, reach, residual_at};
use crate::error::RuntimeError;
use crate::integrator::Variation;
use crate::model::Model;
use crate::simulation::{Simulation, assembled};
use crate::state::State;
use eng_system::code::Compiled;
use eng_system::dense::add_scaled;
use eng_system::system::Origin;

/// Multiplier and increment of the random numbers (D. E. Knuth, The Art of Computer Programming 2, 3.3.4, line 26).
const RANDOM: [u64; 2] = [6_364_136_223_846_793_005, 1_442_695_040_888_963_407];

/// The units of the derivatives of a state: the model's length and radian, their rates in the motion, and the scales of states.
#[derive(Clone, Debug)]
pub(crate) struct Units {
    place: Vec<f64>,
    velocity: Vec<f64>,
    states: Vec<f64>,
}

impl Units {
    /// The units of the present motion of a simulation.
    pub fn of(simulation: &Simulation) -> Units {
        let model = &simulation.model;
        let place = model.velocity_scales();
        let rate = simulation.integrator.current.motion_rate(model);
        // a motion at rest repeats no cycle, but a state has a unit there, too
        let rate = if rate > 0.0 { rate } else { 1.0 };
        Units {
            velocity: place.iter().map(|unit| unit * rate).collect(),
            place,
            states: model.state_scales.clone(),
        }
    }

    /// The derivatives of places, velocities and states, in these units.
    pub fn numbers(&self, of: &Variation) -> Vec<f64> {
        let [places, velocities, states] = [
            (&of.place, &self.place),
            (&of.velocity, &self.velocity),
            (&of.states, &self.states),
        ]
        .map(|(numbers, units)| numbers.iter().zip(units).map(|(x, unit)| x / unit));
        places.chain(velocities).chain(states).collect()
    }

    /// Leaves states out: their numbers become zero.
    pub fn leave_out(&mut self, states: &[bool]) {
        let left_out = self.states.iter_mut().zip(states).filter(|(_, out)| **out);
        left_out.for_each(|(unit, _)| *unit = f64::INFINITY);
    }
}

impl Gradients {
    /// Refuses a bound model or parameters (indices in the system) without derivatives, before a run.
    pub(crate) fn refuse_early(
        compiled: &Compiled,
        overrides: &[Option<f64>],
        parameters: &[usize],
        model: &Model,
    ) -> Result<(), RuntimeError> {
        let reach = reach(compiled, model)?;
        let mut near = parameters.iter();
        near.try_for_each(|index| Nearby::new(compiled, overrides, *index, model, reach).map(drop))
    }

    /// The derivatives by parameters (indices in the system) from the present state of a simulation on, whose motion repeats.
    /// Behind them is a deviation that belongs to no parameter.
    ///
    /// # Errors
    /// A model or a parameter without derivatives; an assembly that fails at a value of a parameter nearby.
    pub(crate) fn of_repeated(
        compiled: &Compiled,
        overrides: &[Option<f64>],
        parameters: &[usize],
        base: &mut Simulation,
    ) -> Result<Gradients, RuntimeError> {
        let reach = reach(compiled, &base.model)?;
        let mut besides = Vec::with_capacity(parameters.len() + 1);
        for index in parameters {
            let nearby = Nearby::new(compiled, overrides, *index, &base.model, reach)?;
            let mut around = Vec::with_capacity(AROUND.len());
            for (at, _) in AROUND {
                let (mut model, _) = assembled(compiled, &nearby.at(at), &base.options)?;
                // the simulation takes kept factors of the motion, whose rows have the scales of the motion
                (model.length, model.mass) = (base.model.length, base.model.mass);
                let state = base.integrator.current.clone();
                let mut simulation = Simulation::with_state(model, state, base.options)?;
                simulation.system.stand_beside();
                around.push(simulation);
            }
            besides.push(Beside::around(nearby, around, &base.model));
        }
        besides.push(Beside::random(&base.model, &Units::of(base)));
        let mut gradients = Gradients::beside(besides, base, reach)?;
        let state = base.integrator.current.clone();
        let mut defect = vec![0.0; base.model.velocities];
        let moment = base.moment();
        // leaves the factors of the least changes
        (base.system).velocity_defect(
            &base.model,
            &mut base.dynamics,
            &state,
            moment,
            &mut defect,
        )?;
        for beside in &mut gradients.parameters {
            beside.begin_repeated(base, &mut gradients.same, &state, gradients.reach)?;
        }
        Ok(gradients)
    }

    /// Moves the clocks by the derivatives `times` of the time of a sample in the last step, so that derivatives at a time are
    /// derivatives at the cycle angle of this sample. Returns those of the present state by each parameter.
    pub(crate) fn sections(&mut self, base: &Simulation, times: &[f64]) -> Vec<Variation> {
        let [at_begin, at_end] = base.integrator.rates_of_change(&base.model);
        let pairs = self.parameters.iter_mut().zip(times);
        let sections = pairs.map(|(beside, time)| {
            beside.clock += time;
            beside.before.add(*time, &at_begin);
            beside.now.add(*time, &at_end);
            beside.now.clone()
        });
        sections.collect()
    }

    /// Whether anything in the motion reads one of some states. A shift of these states by their scales then changes a bit of a
    /// load, a rate or a constraint at the end of the last step.
    ///
    /// # Errors
    /// A load that is not defined at the state.
    pub(crate) fn reads(
        &mut self,
        base: &Simulation,
        states: &[bool],
    ) -> Result<bool, RuntimeError> {
        let (from, model) = (&base.integrator, &base.model);
        let mut shifted = from.current.clone();
        for ((y, scale), of) in (shifted.states.iter_mut().zip(&model.state_scales)).zip(states) {
            if *of {
                *y += scale;
            }
        }
        let mut bits = |state: &State| {
            let mut residual = vec![0.0; from.unknowns()];
            let rotations = &from.previous.rotations;
            residual_at(&mut self.same, state, state.time, rotations, &mut residual)?;
            let bits = residual.into_iter().map(f64::to_bits);
            Ok::<Vec<u64>, RuntimeError>(bits.collect())
        };
        Ok(bits(&from.current)? != bits(&shifted)?)
    }

    /// The length (m) over which the forces of the model are smooth.
    pub(crate) fn reach(&self) -> f64 {
        self.reach
    }

    /// Adds a multiple of a difference of two sections to the derivatives by a parameter.
    pub(crate) fn move_section(&mut self, parameter: usize, factor: f64, by: &Variation) {
        if let Some(beside) = self.parameters.get_mut(parameter) {
            beside.now.add(factor, by);
        }
    }

    /// Takes samples of the parameters alone, or also of the deviation behind them.
    pub(crate) fn sample_deviation(&mut self, also: bool) {
        self.sampled = self.parameters.len() - usize::from(!also);
    }

    /// The number of derivatives that go along.
    pub(crate) fn count(&self) -> usize {
        self.parameters.len()
    }

    /// The parameter's path and size (SI).
    pub(crate) fn parameter(&self, index: usize) -> Option<(&Origin, f64)> {
        let beside = self.parameters.get(index)?;
        Some((&beside.origin, beside.size))
    }
}

impl Beside {
    /// A deviation of random numbers from −1 to 1, in units.
    fn random(model: &Model, units: &Units) -> Beside {
        let mut state = 1_u64;
        let mut next = || {
            state = state.wrapping_mul(RANDOM[0]).wrapping_add(RANDOM[1]);
            // 52 bits are a number from 1 to 2
            2.0 * f64::from_bits(0x3ff0_0000_0000_0000 | (state >> 12)) - 3.0
        };
        let mut now = Variation::new(model);
        for (numbers, units) in [
            (&mut now.place, &units.place),
            (&mut now.velocity, &units.velocity),
            (&mut now.states, &units.states),
        ] {
            for (x, unit) in numbers.iter_mut().zip(units) {
                *x = next() * unit;
            }
        }
        Beside {
            origin: Origin::default(),
            size: 1.0,
            increment: 1.0,
            clock: 0.0,
            around: Vec::new(),
            before: Variation::new(model),
            now,
            start: Vec::new(),
        }
    }

    /// Brings the derivatives of a state, at which the factors of the simulation stand, onto the constraints, and chooses
    /// the clock.
    fn begin_repeated(
        &mut self,
        base: &mut Simulation,
        same: &mut Simulation,
        state: &State,
        reach: f64,
    ) -> Result<(), RuntimeError> {
        let model = &base.model;
        let mut change = vec![0.0; model.velocities];
        let guess = self.now.place.clone();
        for with_clock in [false, true] {
            if with_clock {
                let Some(rate) = base.cycle_rate().filter(|rate| *rate != 0.0) else {
                    break;
                };
                if self.around.is_empty() {
                    break;
                }
                self.clock = -self.turned(model, same, state, reach)? / rate;
            }
            let mut violated = vec![0.0; model.rows];
            base.dynamics.set_state(model, state, &[]);
            base.dynamics
                .constraints_along(model, &guess, &mut violated)?;
            for (simulation, (at, weight)) in self.around.iter_mut().zip(AROUND) {
                let mut there = state.clone();
                there.time += at * self.increment * self.clock;
                let (dynamics, model) = (&mut simulation.dynamics, &simulation.model);
                dynamics.set_state(model, &there, &[]);
                dynamics.evaluate_constraints(model)?;
                add_scaled(
                    &mut violated,
                    weight / self.increment,
                    dynamics.constraints(),
                );
            }
            base.system.normal(model, &violated, &mut change);
            self.now.place.copy_from_slice(&guess);
            add_scaled(&mut self.now.place, -1.0, &change);
        }
        let mut rates = vec![0.0; model.rows];
        self.add_rates(model, &mut base.dynamics, state, reach, &mut rates)?;
        base.system.normal(model, &rates, &mut change);
        add_scaled(&mut self.now.velocity, -1.0, &change);
        self.before.clone_from(&self.now);
        Ok(())
    }

    /// The derivative of the cycle's angle at a state by the parameter and along the derivatives of the place.
    fn turned(
        &mut self,
        model: &Model,
        same: &mut Simulation,
        state: &State,
        reach: f64,
    ) -> Result<f64, RuntimeError> {
        let mut sum = 0.0;
        for (simulation, (_, weight)) in self.around.iter_mut().zip(AROUND) {
            sum += weight / self.increment * cycle_angle_at(simulation, state)?;
        }
        if let Some(distance) = distance(model, state, [&self.now; 2], reach) {
            let mut moved = state.clone();
            for (at, weight) in AROUND {
                (self.now).moved(model, state, at * distance, &mut moved);
                sum += weight / distance * cycle_angle_at(same, &moved)?;
            }
        }
        Ok(sum)
    }
}

/// The cycle angle (rad) of a simulation's model at a state; zero without a cycle.
fn cycle_angle_at(simulation: &mut Simulation, state: &State) -> Result<f64, RuntimeError> {
    let (model, dynamics) = (&simulation.model, &mut simulation.dynamics);
    dynamics.place(model, state.time, &state.pose, &state.velocity);
    let Some(cycle) = &mut simulation.cycle else {
        return Ok(0.0);
    };
    cycle.evaluate(model, dynamics, state)?;
    Ok(cycle.watched_values[0])
}
