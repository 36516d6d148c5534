//! The start and the steps of a simulation.

use super::step_limit::Limit;
use super::{Simulation, StepReport, Warning};
use crate::control::{FixedGrid, StepSize};
use crate::elements::Inputs;
use crate::error::{Moment, RuntimeError};
use crate::integrator::Trial;
use crate::model::STEP_SHARE;
use crate::rotation::V3;
use crate::state::{State, move_pose};
use eng_system::dense::largest_scaled;
use eng_system::system::{ConditionKind, Origin, StepControl};

/// Largest change of an acceleration in the first step, as a share of its size, so that the step excites no
/// ringing. A choice: a larger change is taken as a jump by the first step, and a much smaller one costs
/// steps at every beginning.
const FOLLOWED: f64 = 0.2;
/// This share of the largest acceleration is added to the size of each, so that an acceleration near zero
/// does not shorten the first step. A choice: a body with a ten-thousandth of the largest acceleration may
/// ring without an effect.
const REST: f64 = 1e-4;
/// Size of an acceleration that is rounding, as a share of the square of the motion's rate. Accelerations
/// have rounding errors of some 1e-16 of that square. Their rates are differences over 1e-4 of the time in
/// which the motion covers the model's length or a radian, and have errors of 1e-11 of the cube of its rate.
/// Smaller accelerations do not shorten the first step.
const ROUNDING: f64 = 1e-9;
/// Smallest first step, as a share of the step that the error allows. A choice: it costs thirteen more steps
/// at twofold growth, and changes within less time are those of films that follow at once.
const LAYER: f64 = 1e-4;

/// A cycle does not accelerate if its acceleration is at most this share of the model's largest. A choice above the
/// rounding of accelerations.
const STANDING: f64 = 1e-6;
/// Moments after the start (s) at which [`Simulation::cycle_stands`] computes this acceleration. A choice:
/// drives and loads over time that begin later are found if they act at one of these.
const LATER: [f64; 6] = [0.0, 1e-3, 1e-2, 0.1, 1.0, 10.0];
/// An error of a step below this share of the model's length may be a rounding error. The limit is larger
/// than the rounding error of a number near 1, because positions far from the origin and large angles have
/// larger rounding errors. A choice: a thousand times that of a number near 1.
const NOISE: f64 = 1e-11;

/// Largest turn of a body in a step under error control (rad). The dense output needs this limit. A choice, a
/// twenty-fifth of a turn: the dense output is a cubic of rotation vectors.
const TURN: f64 = 0.25;
/// Largest turn of a body in a stated step (rad). Two bodies that turn against each other then turn by at
/// most half a turn relative to each other, and up to there an angle can be followed.
const MOST_TURN: f64 = std::f64::consts::FRAC_PI_2;

/// Rates of a motion after its present state.
pub(super) struct FirstRates {
    /// Rates of the accelerations.
    pub jerk: Vec<f64>,
    /// Rates of the multipliers.
    pub multiplier_rate: Vec<f64>,
    /// Second rates of the states.
    pub state_jerk: Vec<f64>,
    /// Largest acceleration in units of the model's size (1/s²).
    pub acceleration: f64,
    /// One over the time in which the motion covers the model's length or a radian (1/s).
    pub motion_rate: f64,
}

impl Simulation {
    /// Computes consistent accelerations, their rates and the first step, and checks the conditions at the
    /// start.
    pub(super) fn begin(&mut self) -> Result<(), RuntimeError> {
        let moment = self.moment();
        let first = self.first_rates(moment)?;
        self.integrator.start(
            &first.jerk,
            &self.work,
            &first.multiplier_rate,
            &first.state_jerk,
        );
        if let StepControl::Tolerance(factor) = self.options.step {
            self.size = StepSize::new(self.first_step(&first, factor));
        }
        self.grid = FixedGrid::new(self.integrator.current.time);
        self.stand()?;
        self.dynamics.keep_memory(&self.model)?;
        self.kinks
            .evaluate(&self.model, &self.dynamics, &self.integrator.current)?;
        self.kinks.accept(&self.model, 0.0, None);
        self.at_kink = self.first_moment();
        self.observe_state()?;
        self.refuse_stop_at_start()?;
        self.compute_energy();
        let e = &mut self.energy;
        e.start = e.kinetic + e.gravity + e.strain;
        self.cycle_start = self.cycle_now.map_or(0.0, |c| c[0]);
        Ok(())
    }

    /// Accelerations and multipliers of the current state, and their rates after it. Writes the part of the rates
    /// of accelerations that is normal to the constraints into `work`.
    pub(super) fn first_rates(&mut self, moment: Moment) -> Result<FirstRates, RuntimeError> {
        self.system.accelerations(
            &self.model,
            &mut self.dynamics,
            &mut self.integrator.current,
            moment,
        )?;
        let speed = self.model.largest(&self.integrator.current.velocity);
        let acceleration = self.model.largest(&self.integrator.current.acceleration);
        // a ten-thousandth of the time in which the motion covers the model's length or a radian
        let motion_rate = speed.max(libm::sqrt(acceleration));
        // at rest nothing has a time; 10 µs is a choice
        let mut offset = if motion_rate > 0.0 {
            1e-4 / motion_rate
        } else {
            1e-5
        };
        if let Some(h) = self.options.step.fixed() {
            // a fixed step must not be left: a choice
            offset = offset.min(0.1 * h);
        }
        let mut ends = Vec::with_capacity(2);
        // Forwards only: the functions of a model need not be defined before its start.
        for factor in [1.0, 2.0] {
            let start = self.integrator.current.clone();
            ends.push(self.ahead(&start, factor * offset)?);
        }
        // (−3 f₀ + 4 f₁ − f₂)/2e: second order, from one side
        let rate = |start: &[f64], a: &[f64], b: &[f64]| -> Vec<f64> {
            start
                .iter()
                .zip(a.iter().zip(b))
                .map(|(f, (a, b))| (4.0 * (a - f) - (b - f)) / (2.0 * offset))
                .collect()
        };
        let start = &self.integrator.current;
        let jerk = rate(
            &start.acceleration,
            &ends[0].acceleration,
            &ends[1].acceleration,
        );
        let multiplier_rate = rate(
            &start.multipliers,
            &ends[0].multipliers,
            &ends[1].multipliers,
        );
        let state_jerk = rate(&start.rates, &ends[0].rates, &ends[1].rates);
        // The evaluations ahead left other values in the work space. At the start again, the jerk gives its
        // part along the normals of the constraints.
        self.system.accelerations(
            &self.model,
            &mut self.dynamics,
            &mut self.integrator.current,
            moment,
        )?;
        let mut rates = vec![0.0; self.model.rows];
        self.dynamics
            .constraints_along(&self.model, &jerk, &mut rates)?;
        self.system.normal(&self.model, &rates, &mut self.work);
        Ok(FirstRates {
            jerk,
            multiplier_rate,
            state_jerk,
            acceleration,
            motion_rate,
        })
    }

    /// The first step (s) of a motion under error control, with a factor on the tolerances.
    pub(super) fn first_step(&self, first: &FirstRates, factor: f64) -> f64 {
        let scales = self.model.velocity_scales();
        let largest = largest_scaled(&first.jerk, &scales);
        let error = self.integrator.coefficients.error.abs() * largest * self.model.length
            / (STEP_SHARE * self.model.tolerance * factor);
        let motion_rate = first.motion_rate;
        // a choice: a fiftieth of a radian, about 300 steps a turn, if the error does not limit the step; at
        // rest 10 µs
        let mut h = if motion_rate > 0.0 {
            0.02 / motion_rate
        } else {
            1e-5
        };
        if error > 0.0 {
            // half of the step that the error allows, a choice, because the rate of the first acceleration is
            // known at the start only
            h = h.min(0.5 * libm::cbrt(1.0 / error));
        }
        // The first response of films and stiff modes hardly moves anything, but the acceleration would
        // ring for many steps. So the first steps are short enough to follow it.
        let least = LAYER * h;
        let accelerations = &self.integrator.current.acceleration;
        for (a, (j, scale)) in accelerations.iter().zip(first.jerk.iter().zip(&scales)) {
            let (a, j) = ((a / scale).abs(), (j / scale).abs());
            if j > 0.0 {
                let own = (a + REST * first.acceleration).max(ROUNDING * motion_rate * motion_rate);
                h = h.min(FOLLOWED * own / j);
            }
        }
        h.max(least)
    }

    /// The state at a time e (s) after another one, along its velocities, accelerations and rates, with its own
    /// accelerations.
    pub(super) fn ahead(&mut self, from: &State, e: f64) -> Result<State, RuntimeError> {
        let moment = self.moment();
        let mut near = self.moved(from, e);
        self.system
            .accelerations(&self.model, &mut self.dynamics, &mut near, moment)?;
        Ok(near)
    }

    /// The state at a time e (s) after another one, along its velocities, accelerations and rates.
    pub(super) fn moved(&mut self, from: &State, e: f64) -> State {
        let mut near = from.clone();
        near.time += e;
        for i in 0..self.model.velocities {
            self.work[i] = e * near.velocity[i] + 0.5 * e * e * near.acceleration[i];
            near.velocity[i] += e * near.acceleration[i];
        }
        move_pose(&self.model, &from.pose, &self.work, 1.0, &mut near.pose);
        for i in 0..self.model.states {
            near.states[i] += e * near.rates[i];
        }
        near
    }

    /// Whether the cycle is at rest at the start and nothing will turn it: no force or drive accelerates it
    /// now or at some later moments.
    pub(crate) fn cycle_stands(&mut self) -> Result<bool, RuntimeError> {
        let current = &self.integrator.current;
        let Some([_, 0.0]) = self.cycle_now else {
            return Ok(false);
        };
        if current.rates.iter().any(|rate| *rate != 0.0) {
            return Ok(false);
        }
        let moment = self.moment();
        let mut stands = true;
        for later in LATER {
            let mut state = self.integrator.current.clone();
            state.time += later;
            let found =
                (self.system).accelerations(&self.model, &mut self.dynamics, &mut state, moment);
            // if the accelerations cannot be computed at that moment (a table may end before), the run
            // decides
            if found.is_err() || self.accelerates_cycle(state)? {
                stands = false;
                break;
            }
        }
        self.stand_with_cycle()?;
        Ok(stands)
    }

    /// Whether the accelerations here include one of the cycle.
    pub(crate) fn cycle_accelerates(&mut self) -> Result<bool, RuntimeError> {
        let accelerates = self.accelerates_cycle(self.integrator.current.clone())?;
        self.stand_with_cycle()?;
        Ok(accelerates)
    }

    /// Whether the accelerations of a state include one of the cycle. The dynamics are left elsewhere.
    fn accelerates_cycle(&mut self, mut state: State) -> Result<bool, RuntimeError> {
        let Some(cycle) = &mut self.cycle else {
            return Ok(false);
        };
        let largest = largest_scaled(&state.acceleration, &self.model.velocity_scales());
        // the cycle's rate is linear in the velocities, so accelerations in their place give the cycle's acceleration
        state.velocity.copy_from_slice(&state.acceleration);
        self.dynamics
            .place(&self.model, state.time, &state.pose, &state.velocity);
        cycle.evaluate(&self.model, &self.dynamics, &state)?;
        Ok(cycle.watched_values[1].abs() > STANDING * largest)
    }

    /// Evaluates the dynamics and the cycle at the current state.
    fn stand_with_cycle(&mut self) -> Result<(), RuntimeError> {
        self.stand()?;
        if let Some(cycle) = &mut self.cycle {
            cycle.evaluate(&self.model, &self.dynamics, &self.integrator.current)?;
        }
        Ok(())
    }

    /// Evaluates the dynamics at the current state.
    pub(super) fn stand(&mut self) -> Result<(), RuntimeError> {
        let state = &self.integrator.current;
        self.dynamics
            .set_state(&self.model, state, &state.multipliers);
        self.dynamics.evaluate(&self.model)
    }

    /// Updates turns, cycle, conditions and powers at the state of the dynamics.
    pub(super) fn observe_state(&mut self) -> Result<(), RuntimeError> {
        self.work.fill(0.0);
        let mut rotations = std::mem::take(&mut self.integrator.current.rotations);
        self.completed.rotations.copy_from_slice(&rotations);
        let from = Inputs {
            rotations: &self.completed.rotations,
            ..self.dynamics.inputs_at(&self.integrator.current)
        };
        let unwrapped = self.watch.unwrap(&self.model, &from, &mut rotations);
        self.integrator.current.rotations = rotations;
        unwrapped?;
        if let Some(cycle) = &mut self.cycle {
            cycle.evaluate(&self.model, &self.dynamics, &self.integrator.current)?;
            self.cycle_now = Some(cycle.watched_values);
        }
        self.check_inputs()?;
        let moment = self.moment();
        let state = &self.integrator.current;
        let from = self.dynamics.inputs_at(state);
        let (model, advised, warnings) = (&self.model, &mut self.advised, &mut self.warnings);
        let mut touch = None;
        self.watch.violations(
            model,
            &from,
            self.dynamics.batches(),
            |kind| matches!(kind, ConditionKind::Require | ConditionKind::Advise),
            |violation, values| {
                let condition = &model.class(violation.element).conditions[violation.condition];
                // the law's place is that of the condition
                let origin = || {
                    let origin = &model.compiled.system.elements[violation.element].origin;
                    Origin {
                        defined_at: condition.defined_at.or(origin.defined_at),
                        ..origin.clone()
                    }
                };
                if condition.kind == ConditionKind::Advise {
                    let first: usize = (0..violation.element)
                        .map(|e| model.class(e).conditions.len())
                        .sum();
                    let seen = &mut advised[first + violation.condition];
                    if !*seen {
                        *seen = true;
                        warnings.push(Warning {
                            name: condition.name.clone(),
                            origin: origin(),
                            message: condition.message_with(values),
                            label: super::FAILS,
                            moment,
                        });
                    }
                } else if touch.is_none() {
                    touch = Some(RuntimeError::Require {
                        origin: Box::new(origin()),
                        message: condition.message_with(values),
                        moment,
                        value: violation.value,
                        dimension: condition.dimension,
                    });
                }
            },
        )?;
        if let Some(error) = touch {
            return Err(error);
        }
        self.observe_stop()?;
        if self.options.energy {
            let (loads, constraints) = self
                .dynamics
                .powers(&self.model, &self.integrator.current.multipliers)?;
            self.powers[0] = loads;
            self.powers[1] = constraints;
        }
        Ok(())
    }

    /// Computes the energies at the state of the dynamics.
    pub(super) fn compute_energy(&mut self) {
        let [kinetic, gravity, strain, lost] = self
            .dynamics
            .energy(&self.model, &self.integrator.current.velocity);
        self.energy.kinetic = kinetic;
        self.energy.gravity = gravity;
        self.energy.strain = strain;
        self.powers[2] = lost;
    }

    /// The next step of the control (s).
    pub(crate) fn next_step(&self) -> f64 {
        self.options.step.fixed().unwrap_or(self.size.step)
    }

    /// Continues with a step (s) under error control, independent of the steps before.
    pub(crate) fn renew_steps(&mut self, step: f64) {
        self.size = StepSize::new(step);
        self.integrator.drop_factors();
    }

    /// One step.
    pub fn step(&mut self) -> Result<StepReport, RuntimeError> {
        self.step_within(f64::INFINITY)
    }

    /// One step that ends at `end` (s) at the latest. A step that comes near `end` ends exactly there, to the
    /// last bit.
    pub fn step_within(&mut self, end: f64) -> Result<StepReport, RuntimeError> {
        self.ends_known()?;
        let report = self.step_no_longer(end, f64::INFINITY)?;
        Ok(match self.stand_at_stop()? {
            true => self.report_of_stop(report),
            false => report,
        })
    }

    /// Like [`Simulation::step_within`], but under error control at most `longest` (s) is between two evaluations of the
    /// equations.
    pub(crate) fn step_no_longer(
        &mut self,
        end: f64,
        longest: f64,
    ) -> Result<StepReport, RuntimeError> {
        self.refuse_after_stop()?;
        let begin = self.integrator.current.time;
        if end.is_nan() || end <= begin {
            return Err(RuntimeError::Options {
                message: format!("a step must go forward: from {begin} s to {end} s"),
            });
        }
        self.after_jumps()?;
        self.refuse_jumps_here()?;
        if let Some(kink) = self.at_kink {
            let passed = self.after_jump(kink, end)?;
            let time = self.integrator.current.time;
            if passed.is_some() || time >= end {
                let step = passed.unwrap_or_default();
                return Ok(StepReport { time, step });
            }
        }
        self.dynamics.memory_mut().begin_step();
        // the powers before a kink are no measure of the power within the step after it
        let earlier_step = if self.at_kink.take().is_some() {
            0.0
        } else {
            self.earlier_step
        };
        let stepped = match self.options.step {
            StepControl::Fixed(nominal) | StepControl::FixedTo { step: nominal, .. } => {
                self.fixed_step(nominal, end)
            }
            StepControl::Tolerance(factor) => self.controlled_step(factor, end, longest),
        };
        let (h, time) = stepped.map_err(|error| self.explained(self.or_locked(error)))?;
        let tolerance = self.options.step.tolerance();
        self.integrator
            .look_at_vibrations(&self.model, &mut self.dynamics, h, tolerance);
        let passed = (self.kinks).constrains_within(h, time, tolerance);
        self.integrator.accept(&self.model, h, time);
        self.dynamics.keep_memory(&self.model)?;
        self.kinks.accept(&self.model, h, self.at_kink);
        self.refuse_jumps_within(&passed)?;
        self.refuse_held()?;
        self.evaluated = None;
        self.cycle_at_ends = None;
        if self.options.step.fixed().is_some() && time >= end {
            // a step is refused by the speed before it, so no further step would find a body that began at
            // rest in the last one
            self.turned_too_far(h)?;
        }
        let current = &self.integrator.current;
        if let Some((body, distance)) = self.runaway.after_step(&self.model, current) {
            return Err(RuntimeError::Runaway {
                moment: self.moment(),
                origin: Box::new(self.model.bodies[body].origin.clone()),
                distance,
                lengths: distance / self.model.length,
            });
        }
        let old = self.powers;
        self.observe_state()
            .map_err(|error| self.at_moment(error))?;
        self.compute_energy();
        let work_of_stages = match self.options.energy {
            true => self.integrator.work_of_stages(h, self.powers),
            false => None,
        };
        if self.at_kink.is_some() {
            self.renew_at_kink(h)?;
        }
        let work = |i: usize| {
            let powers = [self.earlier_powers[i], old[i], self.powers[i]];
            work_of_stages.map_or_else(|| work_of_step(h, powers, earlier_step), |work| work[i])
        };
        let (loads, constraints, damping) = (work(0), work(1), work(2));
        self.energy_before = [
            self.energy.loads,
            self.energy.constraints,
            self.energy.damping,
        ];
        self.energy.loads += loads;
        self.energy.constraints += constraints;
        self.energy.damping += damping;
        self.earlier_step = h;
        self.earlier_powers = old;
        Ok(StepReport { time, step: h })
    }

    /// Writes into `work` the part of the current velocity that violates the constraints, in the measure of
    /// the step's kept matrix, because the step caused it in this measure. `false` if no factors are kept.
    fn defect_of_step(&mut self) -> Result<bool, RuntimeError> {
        let state = &self.integrator.current;
        let (model, dynamics) = (&self.model, &mut self.dynamics);
        dynamics.set_state(model, state, &[]);
        dynamics.rate_level(model)?;
        let rates = dynamics.constraint_rates();
        if !self.integrator.nearest_change(model, rates, &mut self.work) {
            return Ok(false);
        }
        // the kept gradients belong to a nearby position, so the remaining violation is removed a second time
        dynamics.constraints_along(model, &self.work, &mut self.rows)?;
        for (left, rate) in self.rows.iter_mut().zip(dynamics.constraint_rates()) {
            *left = rate - *left;
        }
        if !self
            .integrator
            .nearest_change(model, &self.rows, &mut self.rest)
        {
            return Ok(false);
        }
        for (x, more) in self.work.iter_mut().zip(&self.rest) {
            *x += more;
        }
        Ok(true)
    }

    /// Gives the integrator the part of the current velocity that violates the constraints: of the step's kept
    /// matrix, else of the mass matrix.
    pub(super) fn pass_defect(&mut self, moment: Moment) -> Result<(), RuntimeError> {
        if !self.defect_of_step()? {
            self.system.velocity_defect(
                &self.model,
                &mut self.dynamics,
                &self.integrator.current,
                moment,
                &mut self.work,
            )?;
        }
        self.integrator.set_defect(&self.work);
        Ok(())
    }

    /// Replaces the error of a failed step by [`RuntimeError::Locked`], if the mechanism is locked there.
    fn or_locked(&self, error: RuntimeError) -> RuntimeError {
        match error {
            RuntimeError::StepTooSmall { .. }
            | RuntimeError::Newton { .. }
            | RuntimeError::Projection { .. } => {
                let state = &self.integrator.current;
                match crate::assembly::lock::near(&self.model, state, self.moment()) {
                    Ok(Some(locked)) => locked,
                    _ => error,
                }
            }
            other => other,
        }
    }

    fn trial(&mut self, h: f64, tolerance: Option<f64>) -> Result<Trial, RuntimeError> {
        let mut moment = self.moment();
        if self.integrator.needs_defect(h) {
            self.pass_defect(moment)?;
        }
        moment.time += h;
        let trial =
            self.integrator
                .try_step(&self.model, &mut self.dynamics, h, tolerance, moment)?;
        match trial {
            Trial::Solved { error } if self.integrator.is_radau() => {
                match self.complete_stages(h, error, moment) {
                    Ok(()) => Ok(trial),
                    Err(error @ RuntimeError::NotFinite { .. }) => {
                        Ok(Trial::Failed(Box::new(error)))
                    }
                    Err(error) => Err(error),
                }
            }
            trial => Ok(trial),
        }
    }

    /// Completes the end of a step h of Radau IIA: its velocity loses the part that violates the constraints, and its
    /// accelerations, multipliers and rates are those of the balance. The dynamics are evaluated there.
    ///
    /// This part is of third order in the step. The measure is that of the masses at the end itself: with the kept matrix of an
    /// earlier position a share of it would stay along the constraints, and the method would lose its order.
    fn complete_stages(&mut self, h: f64, error: f64, moment: Moment) -> Result<(), RuntimeError> {
        let (model, dynamics) = (&self.model, &mut self.dynamics);
        // a step with a larger error is rejected, and its work is not needed
        if self.options.energy && error <= 1.0 {
            self.integrator.observe_stages(model, dynamics, h)?;
        }
        let end = self.integrator.trial_state_mut();
        self.system
            .tangential_accelerations(model, dynamics, end, moment, &mut self.work)?;
        dynamics.set_state(model, end, &end.multipliers);
        dynamics.evaluate(model)
    }

    /// A fixed step. It is halved if Newton's iteration fails. Whole steps continue as soon as the time is on
    /// their grid again.
    fn fixed_step(&mut self, nominal: f64, end: f64) -> Result<(f64, f64), RuntimeError> {
        loop {
            let begin = self.integrator.current.time;
            let (mut h, mut time) = self.grid.next(nominal);
            // the end is on the grid but for rounding
            let last = time >= end - 1e-9 * nominal;
            if last {
                h = end - begin;
                time = end;
            }
            self.turned_too_far(h)?;
            match self.trial(h, None)? {
                Trial::Solved { .. } => {
                    self.look_at_kinks(h)?;
                    if last {
                        self.grid = FixedGrid::new(end);
                    } else {
                        self.grid.advance();
                    }
                    return Ok((h, time));
                }
                Trial::Failed(error) => {
                    self.integrator.statistics.failed += 1;
                    if !self.grid.halve() {
                        return Err(self.at_moment(*error));
                    }
                }
            }
        }
    }

    /// Refuses a fixed step in which a body turns too far at its present speed.
    fn turned_too_far(&self, h: f64) -> Result<(), RuntimeError> {
        let (speed, body) = self.fastest();
        if speed * h <= MOST_TURN {
            return Ok(());
        }
        Err(RuntimeError::TurnsTooFar {
            moment: self.moment(),
            degrees: (speed * h).to_degrees(),
            step: h,
            origin: Box::new(body.cloned().unwrap_or_default()),
        })
    }

    /// The largest angular speed (rad/s), and its body.
    fn fastest(&self) -> (f64, Option<&Origin>) {
        self.model
            .bodies
            .iter()
            .map(|body| {
                let v = &self.integrator.current.velocity[body.velocity + 3..body.velocity + 6];
                (V3::new(v[0], v[1], v[2]).norm(), Some(&body.origin))
            })
            .fold(
                (0.0, None),
                |most, next| if next.0 > most.0 { next } else { most },
            )
    }

    /// Whether an error of a step (relative to its tolerance) may be a rounding error.
    fn is_rounding(&self, error: f64, factor: f64) -> bool {
        error * STEP_SHARE * self.model.tolerance * factor <= NOISE * self.model.length
    }

    fn below_rounding(&self, error: f64, factor: f64) -> RuntimeError {
        RuntimeError::Rounding {
            moment: Some(self.moment()),
            tolerance: factor,
            // a choice: a decade above the rounding that was found
            least: 10.0 * error * factor,
        }
    }

    /// The longest step (s) that the sampling interval, the turn of bodies and fast sines permit, with the one of them
    /// that decides.
    fn allowed_step(&self, longest: f64) -> (f64, Limit) {
        let longest = longest * f64::from(self.options.method.samples_in_step());
        let mut allowed = (longest.min(self.options.max_step), Limit::Samples);
        let turning = self.fastest().0;
        if turning > 0.0 && TURN / turning < allowed.0 {
            allowed = (TURN / turning, Limit::Turn);
        }
        if self.kinks.longest_step() < allowed.0 {
            allowed = (self.kinks.longest_step(), Limit::Sines);
        }
        allowed
    }

    fn controlled_step(
        &mut self,
        factor: f64,
        end: f64,
        longest: f64,
    ) -> Result<(f64, f64), RuntimeError> {
        let begin = self.integrator.current.time;
        let rest = end - begin;
        let mut failures = 0;
        // the end of the next trial at a kink, and the number of trials that passed one
        let (mut cut, mut tries) = (None, 0);
        let mut first_rejected = None;
        let (allowed, mut limit) = self.allowed_step(longest);
        if self.size.step < allowed {
            limit = Limit::Error;
        }
        self.size.limit(allowed);
        let proposed = self.size.step;
        if let Some(time) = self.kinks.at_once(proposed, begin, factor) {
            self.size.limit(2.0 * time);
        }
        loop {
            let mut h = cut.map_or(self.size.step, |(at, _)| at);
            // a rest that differs by rounding is this step
            let last = cut.is_none() && h >= rest * (1.0 - 1e-9);
            if last {
                h = rest;
            } else if cut.is_none() && 2.0 * h > rest {
                h = 0.5 * rest;
            }
            // a choice: no load changes in this time, and times of a minute round to about as much
            if begin + h == begin || h < 1e-14 {
                // if a table ends here, it is the cause and not the motion
                if let Some(error) = self.undefined.take() {
                    return Err(self.at_moment(*error));
                }
                if let Some((_, error)) = first_rejected
                    && self.is_rounding(error, factor)
                {
                    return Err(self.below_rounding(error, factor));
                }
                let (origin, state, loads) = self.integrator.governing(&self.model);
                return Err(RuntimeError::StepTooSmall {
                    moment: self.moment(),
                    step: h,
                    origin: Box::new(origin),
                    state,
                    loads,
                });
            }
            let trial = self.trial(h, Some(factor))?;
            let (shortened, ends_at) = (cut.is_some(), cut.and_then(|(_, kink)| kink));
            cut = self.kink_within(h, factor, &trial, &mut tries)?;
            if cut.is_some() {
                continue;
            }
            let trial = self.with_velocity_error(trial, h, factor);
            match trial {
                Trial::Solved { error } if error <= 1.0 => {
                    if failures == 0 {
                        self.undefined = None;
                        self.limit = limit;
                    }
                    let near = |kink: &usize| {
                        !self.kinks.is_way(*kink) || self.kinks.is_near(*kink, begin + h, factor)
                    };
                    let reached = || self.kinks.reached_way(begin + h, factor);
                    self.at_kink = ends_at.filter(near).or_else(reached);
                    self.at_kink = self.at_kink.or_else(|| self.kinks.moment_behind(h));
                    self.size.accepted(h, error, self.integrator.error_order());
                    self.keep_step_before_kink(proposed);
                    if shortened {
                        // a step that was cut at a kink, or at the middle before it, is no measure of the
                        // next step
                        self.size.step = self.size.step.max(proposed);
                    }
                    return Ok((h, if last { end } else { begin + h }));
                }
                Trial::Solved { error } => {
                    self.integrator.statistics.rejected += 1;
                    let (longest, largest) = *first_rejected.get_or_insert((h, error));
                    // at a quarter of the step an error of third order would have fallen to a 64th
                    if h <= 0.25 * longest
                        // a choice, sixteen times what is left of a true error
                        && error > 0.25 * largest
                        && self.is_rounding(error, factor)
                    {
                        return Err(self.below_rounding(error, factor));
                    }
                    self.size.rejected(h, error, self.integrator.error_order());
                }
                Trial::Failed(error) => {
                    self.integrator.statistics.failed += 1;
                    failures += 1;
                    if matches!(
                        *error,
                        RuntimeError::NotFinite {
                            because: Some(_),
                            ..
                        }
                    ) {
                        self.undefined = Some(error.clone());
                    }
                    // a choice: a step that still fails after twelve halvings shows that the equations have
                    // no solution here
                    if failures > 12 {
                        return Err(self.at_moment(*error));
                    }
                    self.limit = Limit::Unsolved(error);
                    self.size.halved(h);
                }
            }
        }
    }
}

/// Work (J) of a step of `h` (s): the integral of the parabola through three powers (W), at the beginning of
/// the step before, at the beginning of this step and at its end. The step before took `earlier` (s). If
/// `earlier` is zero, there was none, and the integral is that of the trapezoid.
///
/// With the second divided difference `d`, `∫ = h (p₁ + p₂)/2 − d h³/6`; the error of a step falls as h⁴.
fn work_of_step(h: f64, powers: [f64; 3], earlier: f64) -> f64 {
    let trapezoid = 0.5 * h * (powers[1] + powers[2]);
    if earlier <= 0.0 {
        return trapezoid;
    }
    let curvature =
        ((powers[2] - powers[1]) / h - (powers[1] - powers[0]) / earlier) / (earlier + h);
    trapezoid - curvature * h * h * h / 6.0
}
