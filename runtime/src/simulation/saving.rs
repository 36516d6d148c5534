//! Checkpoints of a simulation.

use super::runaway::Runaway;
use super::{Energy, Options, Simulation, check};
use crate::checkpoint::{self, Reader, Writer};
use crate::control::{FixedGrid, StepSize};
use crate::error::RuntimeError;
use crate::model::Model;
use crate::state::State;
use eng_system::code::Compiled;

impl Simulation {
    /// The complete state for continuing, as bytes. This simulation, a resumed one and one that was never
    /// saved continue with the same bits, because the bytes include the matrix of the kept factors, and the matrices that
    /// elastic surfaces keep. (If [`Simulation::jacobian`] has overwritten that matrix, the factors are dropped, here and in
    /// the resumed simulation.)
    pub fn checkpoint(&mut self) -> Vec<u8> {
        let mut w = Writer::new(self.fingerprint());
        for marker in self.model.markers.iter().filter(|m| m.body.is_none()) {
            w.numbers(marker.position.as_slice());
            w.numbers(marker.orientation.as_slice());
        }
        self.integrator.save(&self.model, &mut w);
        w.numbers(&self.size.numbers());
        let (origin, counts) = self.grid.parts();
        w.number(origin);
        counts.iter().for_each(|c| w.integer(*c));
        let e = self.energy;
        w.numbers(&[
            e.kinetic,
            e.gravity,
            e.strain,
            e.damping,
            e.loads,
            e.constraints,
            e.start,
        ]);
        w.numbers(&self.powers);
        w.numbers(&self.earlier_powers);
        w.numbers(&[self.earlier_step, self.cycle_start, self.runaway.number()]);
        w.integer(u64::from(self.cycle_now.is_some()));
        w.numbers(&self.cycle_now.unwrap_or_default());
        let advised: Vec<f64> = self
            .advised
            .iter()
            .map(|a| f64::from(u8::from(*a)))
            .collect();
        w.numbers(&advised);
        w.numbers(&self.dynamics.signals().numbers());
        w.integer(self.at_kink.map_or(0, |kink| kink as u64 + 1));
        w.numbers(&[self.jump_at_kink, self.before_kink]);
        w.numbers(&self.kinks.numbers());
        w.numbers(&self.dynamics.memory().numbers());
        w.numbers(&self.dynamics.kept());
        if let Some(numbers) = self.stop_numbers() {
            w.numbers(&numbers);
        }
        w.finish()
    }

    /// Continues from a checkpoint of the same model with the same parameters.
    pub fn resume(
        compiled: &Compiled,
        overrides: &[Option<f64>],
        options: Options,
        bytes: &[u8],
    ) -> Result<Simulation, RuntimeError> {
        let mut model = Model::bind(compiled, overrides)?;
        check(&options, &model)?;
        let mut r = Reader::new(bytes, checkpoint::fingerprint(&model))?;
        for marker in model.markers.iter_mut().filter(|m| m.body.is_none()) {
            r.numbers(marker.position.as_mut_slice())?;
            r.numbers(marker.orientation.as_mut_slice())?;
            marker.placed_at = None;
        }
        let blank = State::new(&model);
        let mut simulation = Simulation::with_state(model, blank, options)?;
        simulation.warnings.clear();
        simulation.start = crate::start::StartReport::Resumed;
        simulation.integrator.restore(&simulation.model, &mut r)?;
        simulation.resume_steps_and_energy(&mut r)?;
        let has_cycle = r.integer()? == 1;
        let mut cycle = [0.0; 2];
        r.numbers(&mut cycle)?;
        simulation.cycle_now = has_cycle.then_some(cycle);
        let mut advised = vec![0.0; simulation.advised.len()];
        r.numbers(&mut advised)?;
        simulation.advised = advised.iter().map(|a| *a != 0.0).collect();
        simulation.resume_inputs_and_kinks(&mut r)?;
        if let Some(mut numbers) = simulation.stop_numbers() {
            r.numbers(&mut numbers)?;
            simulation.set_stop_numbers(numbers);
        }
        r.finish()?;
        Ok(simulation)
    }

    /// Reads the parts of a checkpoint about the length of steps, and energy and work.
    fn resume_steps_and_energy(&mut self, r: &mut Reader<'_>) -> Result<(), RuntimeError> {
        let mut size = [0.0; 2];
        r.numbers(&mut size)?;
        self.size = StepSize::from_numbers(size);
        let origin = r.number()?;
        let counts = [r.integer()?, r.integer()?, r.integer()?];
        self.grid = FixedGrid::from_parts(origin, counts);
        let mut energy = [0.0; 7];
        r.numbers(&mut energy)?;
        let [kinetic, gravity, strain, damping, loads, constraints, start] = energy;
        self.energy = Energy {
            kinetic,
            gravity,
            strain,
            damping,
            loads,
            constraints,
            start,
        };
        r.numbers(&mut self.powers)?;
        r.numbers(&mut self.earlier_powers)?;
        let mut rest = [0.0; 3];
        r.numbers(&mut rest)?;
        let [earlier_step, cycle_start, runaway] = rest;
        self.earlier_step = earlier_step;
        self.cycle_start = cycle_start;
        self.runaway = Runaway::from_number(runaway);
        Ok(())
    }

    /// Reads the parts of a checkpoint about inputs, kinks and the memory of fields.
    fn resume_inputs_and_kinks(&mut self, r: &mut Reader<'_>) -> Result<(), RuntimeError> {
        let mut segments = self.dynamics.signals().numbers();
        r.numbers(&mut segments)?;
        self.dynamics.signals_mut().set_numbers(&segments);
        self.at_kink = (r.integer()? as usize).checked_sub(1);
        let mut jump = [0.0; 2];
        r.numbers(&mut jump)?;
        [self.jump_at_kink, self.before_kink] = jump;
        let mut kinks = self.kinks.numbers();
        r.numbers(&mut kinks)?;
        self.kinks.set_numbers(&kinks);
        self.kinks.set_signals(self.dynamics.signals());
        let mut memory = self.dynamics.memory().numbers();
        r.numbers(&mut memory)?;
        self.dynamics.memory_mut().set_numbers(&memory);
        self.dynamics.keep(&r.all_numbers()?);
        Ok(())
    }
}
