//! A simulation: one parameter set of a compiled model, its state, and everything to move it on.

use crate::acceleration::AccelerationSystem;
use crate::assembly;
use crate::checkpoint::{self, Reader, Writer};
use crate::control::{FixedGrid, StepSize};
use crate::dynamics::Dynamics;
use crate::elements::Inputs;
use crate::error::{Moment, RuntimeError};
use crate::integrator::{Integrator, Statistics, Trial, constraints_along};
use crate::linear::Pattern;
use crate::model::Model;
use crate::outputs::{Outputs, Watch};
use crate::rotation::{M3, V3};
use crate::state::{State, move_pose};
use crate::topology;
use eng_system::code::Compiled;
use eng_system::system::{ConditionKind, Origin, StepControl};

/// How a simulation integrates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Fixed steps, or a factor on the physical tolerances.
    pub step: StepControl,
    /// Spectral radius at infinite frequency, 0…1.
    pub rho_infinity: f64,
    /// Tolerance of Newton's iteration in scaled unknowns; `None`: 1e-4 of the position tolerance over the model's length, at most
    /// 1e-10.
    pub newton_tolerance: Option<f64>,
    /// Largest step under error control (s): a load that comes by time is not overslept.
    pub max_step: f64,
    /// Whether work is accumulated; one more evaluation a step.
    pub energy: bool,
}

impl Default for Options {
    fn default() -> Options {
        Options {
            step: StepControl::Tolerance(1.0),
            rho_infinity: 0.8,
            newton_tolerance: None,
            max_step: 0.01,
            energy: true,
        }
    }
}

/// One accepted step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepReport {
    /// Time reached (s).
    pub time: f64,
    /// Length of the step (s).
    pub step: f64,
}

/// Energy and work since the start (J).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Energy {
    /// Kinetic energy.
    pub kinetic: f64,
    /// Potential of gravity.
    pub gravity: f64,
    /// Work of the elements' loads on the bodies.
    pub loads: f64,
    /// Work of the constraints on the bodies: that of drives.
    pub constraints: f64,
    /// Kinetic energy plus gravity's potential at the start.
    pub start: f64,
}

impl Energy {
    /// Energy that appeared from nowhere: zero up to the integrator's error.
    pub fn imbalance(&self) -> f64 {
        self.kinetic + self.gravity - self.start - self.loads - self.constraints
    }
}

/// An `advise` that does not hold.
#[derive(Clone, Debug, PartialEq)]
pub struct Warning {
    /// The element; a path of the model for advice on parameters.
    pub origin: Origin,
    /// The author's message.
    pub message: String,
    /// When it was first seen.
    pub moment: Moment,
}

/// A square sparse matrix by columns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CscView<'a> {
    /// Rows and columns.
    pub size: usize,
    /// Begin of each column in `rows` and `values`, and the end.
    pub columns: &'a [usize],
    /// Row of each entry.
    pub rows: &'a [usize],
    /// Value of each entry.
    pub values: &'a [f64],
}

/// A simulation. It owns its state; two of them on two threads give the same bits.
#[derive(Debug)]
pub struct Simulation {
    model: Model,
    options: Options,
    integrator: Integrator,
    dynamics: Dynamics,
    system: AccelerationSystem,
    outputs: Outputs,
    cycle: Option<Outputs>,
    watch: Watch,
    /// The state of the last outputs, projected and completed.
    completed: State,
    /// Time of the state in `completed` whose outputs are evaluated.
    evaluated: Option<u64>,
    work: Vec<f64>,
    size: StepSize,
    grid: FixedGrid,
    energy: Energy,
    powers: (f64, f64),
    cycle_now: Option<[f64; 2]>,
    cycle_start: f64,
    advised: Vec<bool>,
    warnings: Vec<Warning>,
    fingerprint: u64,
}

impl Simulation {
    /// Binds parameters (one entry a parameter, `None` for its default; an empty slice for all defaults), assembles, and stands
    /// ready to step.
    pub fn new(
        compiled: &Compiled,
        overrides: &[Option<f64>],
        options: Options,
    ) -> Result<Simulation, RuntimeError> {
        let mut model = Model::bind(compiled, overrides)?;
        check(&options)?;
        let state = assembly::assemble(&mut model)?;
        let report = topology::analyze(&model, &state)?;
        if !report.redundant.is_empty() {
            return Err(RuntimeError::Redundant {
                groups: report.redundant,
            });
        }
        let mut simulation = Simulation::with_state(model, state, options)?;
        simulation.begin()?;
        Ok(simulation)
    }

    fn with_state(
        model: Model,
        state: State,
        options: Options,
    ) -> Result<Simulation, RuntimeError> {
        let newton = options
            .newton_tolerance
            .unwrap_or((1e-4 * model.tolerance / model.length).min(1e-10))
            .max(1e-13);
        let cycle = match &model.compiled.system.cycle {
            Some(c) => Some(Outputs::watching(&model, c.element as usize)?),
            None => None,
        };
        let conditions: usize = (0..model.elements.len())
            .map(|e| model.class(e).conditions.len())
            .sum();
        let mut warnings = Vec::new();
        for message in &model.advice {
            warnings.push(Warning {
                origin: Origin::default(),
                message: message.clone(),
                moment: Moment {
                    time: state.time,
                    cycle_angle: None,
                },
            });
        }
        use eng_system::system::Role;
        let roles: Vec<Role> = model
            .compiled
            .system
            .elements
            .iter()
            .map(|e| e.role)
            .collect();
        Ok(Simulation {
            integrator: Integrator::new(&model, &state, options.rho_infinity, newton)?,
            dynamics: Dynamics::new(&model),
            system: AccelerationSystem::new(&model)?,
            outputs: Outputs::all(&model)?,
            cycle,
            watch: Watch::new(&model, |e| matches!(roles[e], Role::Dynamic | Role::Output)),
            work: vec![0.0; model.velocities],
            size: StepSize::default(),
            grid: FixedGrid::default(),
            energy: Energy::default(),
            powers: (0.0, 0.0),
            cycle_now: None,
            cycle_start: 0.0,
            advised: vec![false; conditions],
            warnings,
            evaluated: None,
            fingerprint: checkpoint::fingerprint(&model),
            completed: state,
            options,
            model,
        })
    }

    /// Consistent accelerations, their rates, first step, first look at conditions.
    fn begin(&mut self) -> Result<(), RuntimeError> {
        let moment = self.moment();
        self.system.accelerations(
            &self.model,
            &mut self.dynamics,
            &mut self.integrator.current,
            moment,
        )?;
        let scales = self.model.velocity_scales();
        let largest = |x: &[f64]| {
            x.iter()
                .zip(&scales)
                .fold(0.0_f64, |w, (x, s)| w.max((x / s).abs()))
        };
        let speed = largest(&self.integrator.current.velocity);
        let acceleration = largest(&self.integrator.current.acceleration);
        // A ten-thousandth of the time in which the motion goes about its own size.
        let pace = speed.max(libm::sqrt(acceleration));
        let mut offset = if pace > 0.0 { 1e-4 / pace } else { 1e-5 };
        if let StepControl::Fixed(h) = self.options.step {
            offset = offset.min(0.1 * h);
        }
        let mut ends = Vec::with_capacity(2);
        for sign in [-1.0, 1.0] {
            let e = sign * offset;
            let mut near = self.integrator.current.clone();
            near.time += e;
            for i in 0..self.model.velocities {
                self.work[i] = e * near.velocity[i] + 0.5 * e * e * near.acceleration[i];
                near.velocity[i] += e * near.acceleration[i];
            }
            move_pose(
                &self.model,
                &self.integrator.current.pose,
                &self.work,
                1.0,
                &mut near.pose,
            );
            for i in 0..self.model.states {
                near.states[i] += e * near.rates[i];
            }
            self.system
                .accelerations(&self.model, &mut self.dynamics, &mut near, moment)?;
            ends.push(near);
        }
        let rate = |a: &[f64], b: &[f64]| -> Vec<f64> {
            a.iter()
                .zip(b)
                .map(|(a, b)| (b - a) / (2.0 * offset))
                .collect()
        };
        let jerk = rate(&ends[0].acceleration, &ends[1].acceleration);
        let multiplier_rate = rate(&ends[0].multipliers, &ends[1].multipliers);
        let state_jerk = rate(&ends[0].rates, &ends[1].rates);
        // Back at the start itself: the normal part of its jerk.
        self.system.accelerations(
            &self.model,
            &mut self.dynamics,
            &mut self.integrator.current,
            moment,
        )?;
        let mut rates = vec![0.0; self.model.rows];
        constraints_along(&self.model, &mut self.dynamics, &jerk, &mut rates)?;
        self.system.normal(&self.model, &rates, &mut self.work);
        self.integrator
            .start(&jerk, &self.work, &multiplier_rate, &state_jerk);
        if let StepControl::Tolerance(factor) = self.options.step {
            let error =
                self.integrator.coefficients.error.abs() * largest(&jerk) * self.model.length
                    / (self.model.tolerance * factor);
            let mut h = if pace > 0.0 { 0.02 / pace } else { 1e-5 };
            if error > 0.0 {
                h = h.min(0.5 * libm::cbrt(1.0 / error));
            }
            self.size = StepSize::new(h);
        }
        self.grid = FixedGrid::new(self.integrator.current.time);
        self.stand()?;
        self.observe_state()?;
        let (kinetic, gravity) = self
            .dynamics
            .energy(&self.model, &self.integrator.current.velocity);
        self.energy.kinetic = kinetic;
        self.energy.gravity = gravity;
        self.energy.start = kinetic + gravity;
        self.cycle_start = self.cycle_now.map_or(0.0, |c| c[0]);
        Ok(())
    }

    /// Evaluates the dynamics at the current state.
    fn stand(&mut self) -> Result<(), RuntimeError> {
        let state = &self.integrator.current;
        self.dynamics
            .place(&self.model, state.time, &state.pose, &state.velocity);
        self.dynamics.gather(
            &self.model,
            &state.states,
            &state.multipliers,
            &state.rotations,
        );
        self.dynamics.evaluate(&self.model)
    }

    /// At a state at which the dynamics stand: turns, cycle, conditions, powers.
    fn observe_state(&mut self) -> Result<(), RuntimeError> {
        let state = &mut self.integrator.current;
        self.work.fill(0.0);
        let before = std::mem::take(&mut state.rotations);
        self.completed.rotations.copy_from_slice(&before);
        state.rotations = before;
        let from = Inputs {
            time: state.time,
            markers: &self.dynamics.markers,
            states: &state.states,
            multipliers: &state.multipliers,
            rotations: &self.completed.rotations,
        };
        self.watch
            .unwrap(&self.model, &from, &mut state.rotations)?;
        if let Some(cycle) = &mut self.cycle {
            cycle.evaluate(&self.model, &self.dynamics, &self.integrator.current)?;
            self.cycle_now = Some(cycle.watched_values);
        }
        let moment = self.moment();
        let state = &self.integrator.current;
        let from = Inputs {
            time: state.time,
            markers: &self.dynamics.markers,
            states: &state.states,
            multipliers: &state.multipliers,
            rotations: &state.rotations,
        };
        let (model, advised, warnings) = (&self.model, &mut self.advised, &mut self.warnings);
        let mut touch = None;
        self.watch.violations(
            model,
            &from,
            |kind| *kind != ConditionKind::Branch,
            |violation| {
                let condition = &model.class(violation.element).conditions[violation.condition];
                let origin = &model.compiled.system.elements[violation.element].origin;
                if condition.kind == ConditionKind::Advise {
                    let first: usize = (0..violation.element)
                        .map(|e| model.class(e).conditions.len())
                        .sum();
                    let seen = &mut advised[first + violation.condition];
                    if !*seen {
                        *seen = true;
                        warnings.push(Warning {
                            origin: origin.clone(),
                            message: condition.text.clone(),
                            moment,
                        });
                    }
                } else if touch.is_none() {
                    touch = Some(RuntimeError::Require {
                        origin: origin.clone(),
                        message: condition.text.clone(),
                        moment,
                        value: violation.value,
                    });
                }
            },
        )?;
        if let Some(error) = touch {
            return Err(error);
        }
        if self.options.energy {
            self.powers = self
                .dynamics
                .powers(&self.model, &self.integrator.current.multipliers)?;
        }
        Ok(())
    }

    /// One step.
    pub fn step(&mut self) -> Result<StepReport, RuntimeError> {
        self.step_within(f64::INFINITY)
    }

    /// One step that does not go beyond `end` (s) and meets it to the last bit where it comes near.
    pub fn step_within(&mut self, end: f64) -> Result<StepReport, RuntimeError> {
        let begin = self.integrator.current.time;
        if !(end > begin) {
            return Err(RuntimeError::Options {
                message: format!("a step must go forward: from {begin} s to {end} s"),
            });
        }
        let (h, time) = match self.options.step {
            StepControl::Fixed(nominal) => self.fixed_step(nominal, end)?,
            StepControl::Tolerance(factor) => self.controlled_step(factor, end)?,
        };
        self.integrator.accept(&self.model, h, time);
        self.evaluated = None;
        let old = self.powers;
        self.observe_state()
            .map_err(|error| self.at_moment(error))?;
        let (kinetic, gravity) = self
            .dynamics
            .energy(&self.model, &self.integrator.current.velocity);
        self.energy.kinetic = kinetic;
        self.energy.gravity = gravity;
        self.energy.loads += 0.5 * h * (old.0 + self.powers.0);
        self.energy.constraints += 0.5 * h * (old.1 + self.powers.1);
        Ok(StepReport { time, step: h })
    }

    fn trial(&mut self, h: f64, tolerance: Option<f64>) -> Result<Trial, RuntimeError> {
        let mut moment = self.moment();
        if self.integrator.needs_defect(h) {
            self.system.velocity_defect(
                &self.model,
                &mut self.dynamics,
                &self.integrator.current,
                moment,
                &mut self.work,
            )?;
            self.integrator.set_defect(&self.work);
        }
        moment.time += h;
        self.integrator
            .try_step(&self.model, &mut self.dynamics, h, tolerance, moment)
    }

    /// A fixed step; halved where Newton fails, back to the grid of whole steps as soon as that is met again.
    fn fixed_step(&mut self, nominal: f64, end: f64) -> Result<(f64, f64), RuntimeError> {
        loop {
            let begin = self.integrator.current.time;
            let (mut h, mut time) = self.grid.next(nominal);
            let last = time >= end - 1e-9 * nominal;
            if last {
                h = end - begin;
                time = end;
            }
            match self.trial(h, None)? {
                Trial::Solved { .. } => {
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

    fn controlled_step(&mut self, factor: f64, end: f64) -> Result<(f64, f64), RuntimeError> {
        let begin = self.integrator.current.time;
        let rest = end - begin;
        let mut failures = 0;
        // The dense output and the unwrapped angles want less than a fraction of a turn a step.
        let turning = self.model.bodies.iter().fold(0.0_f64, |w, b| {
            let v = &self.integrator.current.velocity[b.velocity + 3..b.velocity + 6];
            w.max(V3::new(v[0], v[1], v[2]).norm())
        });
        self.size.limit(self.options.max_step);
        if turning > 0.0 {
            self.size.limit(0.25 / turning);
        }
        loop {
            let mut h = self.size.step;
            let last = h >= rest * (1.0 - 1e-9);
            if last {
                h = rest;
            } else if 2.0 * h > rest {
                h = 0.5 * rest;
            }
            if begin + h == begin || h < 1e-14 {
                return Err(RuntimeError::StepTooSmall {
                    moment: self.moment(),
                    step: h,
                    origin: self.integrator.worst_body(&self.model),
                });
            }
            match self.trial(h, Some(factor))? {
                Trial::Solved { error } if error <= 1.0 => {
                    self.size.accepted(h, error);
                    return Ok((h, if last { end } else { begin + h }));
                }
                Trial::Solved { error } => {
                    self.integrator.statistics.rejected += 1;
                    self.size.rejected(h, error);
                }
                Trial::Failed(error) => {
                    self.integrator.statistics.failed += 1;
                    failures += 1;
                    if failures > 12 {
                        return Err(self.at_moment(*error));
                    }
                    self.size.halved(h);
                }
            }
        }
    }

    fn moment(&self) -> Moment {
        Moment {
            time: self.integrator.current.time,
            cycle_angle: self.cycle_now.map(|c| c[0]),
        }
    }

    /// Adds the cycle angle to errors that know only the time.
    fn at_moment(&self, mut error: RuntimeError) -> RuntimeError {
        let angle = self.cycle_now.map(|c| c[0]);
        if let RuntimeError::NotFinite { moment, .. } = &mut error {
            moment.cycle_angle = angle;
        }
        error
    }

    /// Time of the last accepted state (s).
    pub fn time(&self) -> f64 {
        self.integrator.current.time
    }

    /// Unwrapped cycle angle (rad), where the model has a cycle.
    pub fn cycle_angle(&self) -> Option<f64> {
        self.cycle_now.map(|c| c[0])
    }

    /// Rate of the cycle angle (rad/s).
    pub fn cycle_rate(&self) -> Option<f64> {
        self.cycle_now.map(|c| c[1])
    }

    /// Cycle angle at the start (rad).
    pub fn cycle_start(&self) -> f64 {
        self.cycle_start
    }

    /// Value of a channel at the last accepted state (SI). Positions and velocities are projected for it; the integrator goes on
    /// with its own.
    pub fn value(&mut self, channel: usize) -> Result<f64, RuntimeError> {
        self.evaluate_current()?;
        self.outputs
            .values
            .get(channel)
            .copied()
            .ok_or_else(|| RuntimeError::Options {
                message: format!("there is no channel {channel}"),
            })
    }

    /// Values of all channels at the last accepted state (SI), into as many numbers as there are channels.
    pub fn evaluate_channels(&mut self, out: &mut [f64]) -> Result<(), RuntimeError> {
        self.evaluate_current()?;
        self.copy_channels(out)
    }

    fn copy_channels(&self, out: &mut [f64]) -> Result<(), RuntimeError> {
        if out.len() != self.outputs.values.len() {
            return Err(RuntimeError::Options {
                message: format!(
                    "room for {} channels, not {}",
                    out.len(),
                    self.outputs.values.len()
                ),
            });
        }
        out.copy_from_slice(&self.outputs.values);
        Ok(())
    }

    fn evaluate_current(&mut self) -> Result<(), RuntimeError> {
        let key = self.integrator.current.time.to_bits();
        if self.evaluated != Some(key) {
            self.completed.copy_from(&self.integrator.current);
            self.complete()?;
            self.evaluated = Some(key);
        }
        Ok(())
    }

    /// Projects and completes `self.completed` and evaluates the outputs there.
    fn complete(&mut self) -> Result<(), RuntimeError> {
        self.evaluated = None;
        let moment = Moment {
            time: self.completed.time,
            cycle_angle: self.cycle_now.map(|c| c[0]),
        };
        self.system
            .complete(&self.model, &mut self.dynamics, &mut self.completed, moment)
            .and_then(|()| {
                self.outputs
                    .evaluate(&self.model, &self.dynamics, &self.completed)
            })
            .map_err(|error| self.at_moment(error))
    }

    /// Values of all channels at a time within the last step, from the dense output; returns cycle angle and rate there.
    pub fn sample_at(
        &mut self,
        time: f64,
        out: &mut [f64],
    ) -> Result<Option<[f64; 2]>, RuntimeError> {
        self.interpolate_at(time)?;
        self.complete()?;
        self.copy_channels(out)?;
        self.cycle_of_completed()
    }

    /// Values of all channels where the cycle has an angle (rad) within the last step; returns the time, cycle angle and rate.
    ///
    /// The projection of the output moves the angle by what the interpolation missed; the time is set right until the projected
    /// state has the angle.
    pub fn sample_at_angle(
        &mut self,
        angle: f64,
        out: &mut [f64],
    ) -> Result<(f64, [f64; 2]), RuntimeError> {
        let (from, to) = (self.integrator.previous.time, self.integrator.current.time);
        let mut time = self.locate_angle(angle)?;
        for _ in 0..4 {
            self.interpolate_at(time)?;
            self.complete()?;
            let [now, rate] = self.cycle_of_completed()?.ok_or(RuntimeError::NoCycle)?;
            let miss = angle - now;
            let next = (time + miss / rate).clamp(from, to);
            if miss.abs() <= 1e-12 * angle.abs().max(1.0) || !next.is_finite() || next == time {
                break;
            }
            time = next;
        }
        let cycle = self.sample_at(time, out)?;
        Ok((time, cycle.ok_or(RuntimeError::NoCycle)?))
    }

    fn interpolate_at(&mut self, time: f64) -> Result<(), RuntimeError> {
        let (from, to) = (self.integrator.previous.time, self.integrator.current.time);
        if !(from..=to).contains(&time) {
            return Err(RuntimeError::OutsideStep { time, from, to });
        }
        self.evaluated = None;
        if time == to {
            self.completed.copy_from(&self.integrator.current);
        } else {
            let fraction = (time - from) / (to - from);
            self.integrator
                .interpolate(&self.model, fraction, &mut self.work, &mut self.completed);
        }
        self.completed.time = time;
        Ok(())
    }

    /// Cycle angle and rate of `self.completed`, at which the dynamics stand.
    fn cycle_of_completed(&mut self) -> Result<Option<[f64; 2]>, RuntimeError> {
        match &mut self.cycle {
            Some(cycle) => {
                cycle.evaluate(&self.model, &self.dynamics, &self.completed)?;
                Ok(Some(cycle.watched_values))
            }
            None => Ok(None),
        }
    }

    fn cycle_angle_at(&mut self, time: f64) -> Result<f64, RuntimeError> {
        self.interpolate_at(time)?;
        let state = &self.completed;
        self.dynamics
            .place(&self.model, state.time, &state.pose, &state.velocity);
        self.cycle_of_completed()?
            .map(|c| c[0])
            .ok_or(RuntimeError::NoCycle)
    }

    /// The time within the last step at which the cycle has an angle (rad), by false position (Illinois variant) on the dense
    /// output; an angle outside gives the nearer end.
    pub fn locate_angle(&mut self, angle: f64) -> Result<f64, RuntimeError> {
        let (mut from, mut to) = (self.integrator.previous.time, self.integrator.current.time);
        let mut at_from = self.cycle_angle_at(from)? - angle;
        let mut at_to = self.cycle_angle_at(to)? - angle;
        if at_to == 0.0 || from == to {
            return Ok(to);
        }
        if at_from == 0.0 {
            return Ok(from);
        }
        if (at_from > 0.0) == (at_to > 0.0) {
            return Ok(if at_from.abs() < at_to.abs() {
                from
            } else {
                to
            });
        }
        let mut side = 0;
        for _ in 0..80 {
            let middle = (from * at_to - to * at_from) / (at_to - at_from);
            let middle = middle.clamp(from, to);
            let value = self.cycle_angle_at(middle)? - angle;
            if value.abs() < 1e-14 * angle.abs().max(1.0)
                || to - from <= 4.0 * f64::EPSILON * to.abs()
            {
                return Ok(middle);
            }
            if (value > 0.0) == (at_to > 0.0) {
                to = middle;
                at_to = value;
                if side == 1 {
                    at_from *= 0.5;
                }
                side = 1;
            } else {
                from = middle;
                at_from = value;
                if side == -1 {
                    at_to *= 0.5;
                }
                side = -1;
            }
        }
        Ok(0.5 * (from + to))
    }

    /// Energy and work at the last accepted state.
    pub fn energy(&self) -> Energy {
        self.energy
    }

    /// Counts of work.
    pub fn statistics(&self) -> Statistics {
        self.integrator.statistics
    }

    /// Warnings since they were last taken.
    pub fn take_warnings(&mut self) -> Vec<Warning> {
        std::mem::take(&mut self.warnings)
    }

    /// The bound model: values of parameters, counts, scales.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// The last accepted state as the integrator has it.
    pub fn state(&self) -> &State {
        &self.integrator.current
    }

    /// The last accepted state projected on the constraints, with accelerations and multipliers of the acceleration-level
    /// system.
    pub fn output_state(&mut self) -> Result<&State, RuntimeError> {
        self.evaluate_current()?;
        Ok(&self.completed)
    }

    /// Largest |Φ| (m, rad) and |Φ̇| (m/s, rad/s) of the state of the last outputs.
    pub fn output_drift(&mut self) -> Result<(f64, f64), RuntimeError> {
        let state = &self.completed;
        self.dynamics
            .place(&self.model, state.time, &state.pose, &state.velocity);
        self.dynamics.gather(
            &self.model,
            &state.states,
            &state.multipliers,
            &state.rotations,
        );
        self.dynamics.evaluate(&self.model)?;
        self.dynamics.constraint_gradients(&self.model)?;
        self.dynamics.velocity_level(&self.model, &state.velocity)?;
        let largest = |x: &[f64]| x.iter().fold(0.0_f64, |w, x| w.max(x.abs()));
        Ok((
            largest(&self.dynamics.constraints),
            largest(&self.dynamics.constraint_rates),
        ))
    }

    /// Position (m) and orientation (body → inertial) of a body at the last accepted state.
    pub fn body_pose(&self, body: usize) -> Option<(V3, M3)> {
        let frame = self
            .model
            .bodies
            .get(body)?
            .frame(&self.integrator.current.pose);
        Some((frame.position, frame.rotation))
    }

    /// Unknowns of a step: scaled increments, states, multipliers.
    pub fn unknowns(&self) -> usize {
        self.integrator.unknowns()
    }

    /// The scaled unknowns that a step h (s) from here starts with.
    pub fn predicted(&mut self, step: f64, out: &mut [f64]) -> Result<(), RuntimeError> {
        self.room(out.len())?;
        self.integrator.predict(&self.model, step, true);
        out.copy_from_slice(self.integrator.trial());
        Ok(())
    }

    /// Scaled residual of a step h (s) from the last accepted state at scaled unknowns.
    pub fn residual(
        &mut self,
        step: f64,
        unknowns: &[f64],
        out: &mut [f64],
    ) -> Result<(), RuntimeError> {
        self.room(unknowns.len())?;
        self.room(out.len())?;
        self.integrator.predict(&self.model, step, true);
        self.integrator.set_trial(unknowns);
        self.integrator
            .evaluate(&self.model, &mut self.dynamics, step)?;
        out.copy_from_slice(self.integrator.last_residual());
        Ok(())
    }

    /// Derivative of [`Simulation::residual`] by the scaled unknowns.
    pub fn jacobian(&mut self, step: f64, unknowns: &[f64]) -> Result<CscView<'_>, RuntimeError> {
        self.room(unknowns.len())?;
        self.integrator.predict(&self.model, step, true);
        self.integrator.set_trial(unknowns);
        self.integrator
            .evaluate(&self.model, &mut self.dynamics, step)?;
        self.integrator
            .fill(&self.model, &mut self.dynamics, step)?;
        let Pattern {
            size,
            columns,
            rows,
        } = self.integrator.pattern();
        Ok(CscView {
            size: *size,
            columns,
            rows,
            values: self.integrator.values(),
        })
    }

    fn room(&self, length: usize) -> Result<(), RuntimeError> {
        if length == self.integrator.unknowns() {
            Ok(())
        } else {
            Err(RuntimeError::Options {
                message: format!(
                    "{length} unknowns are given; a step has {}",
                    self.integrator.unknowns()
                ),
            })
        }
    }

    /// Everything that goes on from here, as bytes. The kept factors are dropped here as well, so that this simulation and a resumed
    /// one go on with the same bits.
    pub fn checkpoint(&mut self) -> Vec<u8> {
        self.integrator.drop_factors();
        let mut w = Writer::new(self.fingerprint);
        for marker in self.model.markers.iter().filter(|m| m.body.is_none()) {
            w.numbers(marker.position.as_slice());
            w.numbers(marker.orientation.as_slice());
        }
        for state in [&self.integrator.current, &self.integrator.previous] {
            w.number(state.time);
            for part in [
                &state.pose,
                &state.velocity,
                &state.acceleration,
                &state.states,
                &state.rates,
                &state.multipliers,
                &state.rotations,
            ] {
                w.numbers(part);
            }
        }
        let i = &self.integrator;
        for part in [
            &i.increment,
            &i.auxiliary,
            &i.state_auxiliary,
            &i.jerk,
            &i.multiplier_rate,
            &i.state_jerk,
            &i.state_peak,
            &i.base_velocity,
            &i.defect,
        ] {
            w.numbers(part);
        }
        w.numbers(i.state_scales(&self.model));
        w.number(i.auxiliary_step);
        w.integer(u64::from(i.defect_known));
        let s = i.statistics;
        for count in [
            s.steps,
            s.rejected,
            s.failed,
            s.iterations,
            s.factorizations,
            s.residuals,
        ] {
            w.integer(count);
        }
        w.numbers(&self.size.numbers());
        let (origin, counts) = self.grid.parts();
        w.number(origin);
        counts.iter().for_each(|c| w.integer(*c));
        let e = self.energy;
        w.numbers(&[e.kinetic, e.gravity, e.loads, e.constraints, e.start]);
        w.numbers(&[self.powers.0, self.powers.1, self.cycle_start]);
        w.integer(u64::from(self.cycle_now.is_some()));
        w.numbers(&self.cycle_now.unwrap_or_default());
        let advised: Vec<f64> = self
            .advised
            .iter()
            .map(|a| f64::from(u8::from(*a)))
            .collect();
        w.numbers(&advised);
        w.finish()
    }

    /// Goes on from a checkpoint of the same model with the same parameters.
    pub fn resume(
        compiled: &Compiled,
        overrides: &[Option<f64>],
        options: Options,
        bytes: &[u8],
    ) -> Result<Simulation, RuntimeError> {
        let mut model = Model::bind(compiled, overrides)?;
        check(&options)?;
        let mut r = Reader::new(bytes, checkpoint::fingerprint(&model))?;
        for marker in model.markers.iter_mut().filter(|m| m.body.is_none()) {
            r.numbers(marker.position.as_mut_slice())?;
            r.numbers(marker.orientation.as_mut_slice())?;
            marker.placed_at = None;
        }
        let blank = State::new(&model);
        let mut simulation = Simulation::with_state(model, blank, options)?;
        simulation.warnings.clear();
        let i = &mut simulation.integrator;
        for state in [&mut i.current, &mut i.previous] {
            state.time = r.number()?;
            for part in [
                &mut state.pose,
                &mut state.velocity,
                &mut state.acceleration,
                &mut state.states,
                &mut state.rates,
                &mut state.multipliers,
                &mut state.rotations,
            ] {
                r.numbers(part)?;
            }
        }
        for part in [
            &mut i.increment,
            &mut i.auxiliary,
            &mut i.state_auxiliary,
            &mut i.jerk,
            &mut i.multiplier_rate,
            &mut i.state_jerk,
            &mut i.state_peak,
            &mut i.base_velocity,
            &mut i.defect,
        ] {
            r.numbers(part)?;
        }
        let states = i.state_peak.len();
        let mut scales = vec![0.0; states];
        r.numbers(&mut scales)?;
        i.set_state_scales(&simulation.model, &scales);
        i.auxiliary_step = r.number()?;
        i.defect_known = r.integer()? == 1;
        let s = &mut i.statistics;
        for count in [
            &mut s.steps,
            &mut s.rejected,
            &mut s.failed,
            &mut s.iterations,
            &mut s.factorizations,
            &mut s.residuals,
        ] {
            *count = r.integer()?;
        }
        let mut size = [0.0; 2];
        r.numbers(&mut size)?;
        simulation.size = StepSize::from_numbers(size);
        let origin = r.number()?;
        let counts = [r.integer()?, r.integer()?, r.integer()?];
        simulation.grid = FixedGrid::from_parts(origin, counts);
        let mut energy = [0.0; 5];
        r.numbers(&mut energy)?;
        let [kinetic, gravity, loads, constraints, start] = energy;
        simulation.energy = Energy {
            kinetic,
            gravity,
            loads,
            constraints,
            start,
        };
        let mut rest = [0.0; 3];
        r.numbers(&mut rest)?;
        simulation.powers = (rest[0], rest[1]);
        simulation.cycle_start = rest[2];
        let has_cycle = r.integer()? == 1;
        let mut cycle = [0.0; 2];
        r.numbers(&mut cycle)?;
        simulation.cycle_now = has_cycle.then_some(cycle);
        let mut advised = vec![0.0; simulation.advised.len()];
        r.numbers(&mut advised)?;
        simulation.advised = advised.iter().map(|a| *a != 0.0).collect();
        r.finish()?;
        Ok(simulation)
    }
}

fn check(options: &Options) -> Result<(), RuntimeError> {
    let refuse = |message: String| Err(RuntimeError::Options { message });
    if !(0.0..=1.0).contains(&options.rho_infinity) {
        return refuse(format!(
            "the spectral radius at infinite frequency is {}; it lies in 0…1",
            options.rho_infinity
        ));
    }
    let (name, value) = match options.step {
        StepControl::Fixed(h) => ("step", h),
        StepControl::Tolerance(factor) => ("tolerance", factor),
    };
    if !(options.max_step > 0.0) {
        return refuse(format!(
            "the largest step is {}; it must be positive",
            options.max_step
        ));
    }
    if !(value > 0.0 && value.is_finite()) {
        return refuse(format!("the {name} is {value}; it must be positive"));
    }
    Ok(())
}
