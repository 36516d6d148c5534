//! The integrator in a checkpoint.

use super::{Integrator, Vibration};
use crate::checkpoint::{Reader, Writer};
use crate::error::RuntimeError;
use crate::model::Model;
use crate::state::State;

impl State {
    fn save(&self, w: &mut Writer) {
        w.number(self.time);
        for part in [
            &self.pose,
            &self.velocity,
            &self.acceleration,
            &self.states,
            &self.rates,
            &self.multipliers,
            &self.rotations,
        ] {
            w.numbers(part);
        }
    }

    fn restore(&mut self, r: &mut Reader<'_>) -> Result<(), RuntimeError> {
        self.time = r.number()?;
        for part in [
            &mut self.pose,
            &mut self.velocity,
            &mut self.acceleration,
            &mut self.states,
            &mut self.rates,
            &mut self.multipliers,
            &mut self.rotations,
        ] {
            r.numbers(part)?;
        }
        Ok(())
    }
}

impl Integrator {
    /// Writes all that later steps depend on, the matrix of the kept factors included. If another matrix was filled since,
    /// the factors are dropped, here and so in the restored integrator, because their matrix is gone.
    pub(crate) fn save(&mut self, model: &Model, w: &mut Writer) {
        if self.factored_step.is_none() || !self.factored_values {
            self.drop_factors();
        }
        self.current.save(w);
        self.previous.save(w);
        for part in [
            &self.increment,
            &self.auxiliary,
            &self.state_auxiliary,
            &self.jerk,
            &self.multiplier_rate,
            &self.state_jerk,
            &self.state_peak,
            &self.base_velocity,
            &self.defect,
        ] {
            w.numbers(part);
        }
        w.numbers(self.state_scales(model));
        w.number(self.auxiliary_step);
        w.integer(u64::from(self.defect_known));
        w.integer(u64::from(self.factored_step.is_some()));
        if let Some(step) = self.factored_step {
            w.number(step);
            w.integer(u64::from(self.contraction.is_some()));
            w.number(self.contraction.unwrap_or_default());
            w.numbers(&self.values);
            w.numbers(&self.secants.numbers());
        }
        let s = self.statistics;
        for count in [
            s.steps,
            s.rejected,
            s.failed,
            s.iterations,
            s.factorizations,
            s.residuals,
            s.fallbacks,
            s.kinks,
        ] {
            w.integer(count);
        }
        for vibration in &self.vibrations {
            w.numbers(&vibration.numbers());
        }
        if let Some(radau) = &self.radau {
            w.numbers(&radau.numbers());
        }
    }

    /// Reads the numbers that [`Integrator::save`] wrote, into an integrator of the same model.
    pub(crate) fn restore(
        &mut self,
        model: &Model,
        r: &mut Reader<'_>,
    ) -> Result<(), RuntimeError> {
        self.current.restore(r)?;
        self.previous.restore(r)?;
        for part in [
            &mut self.increment,
            &mut self.auxiliary,
            &mut self.state_auxiliary,
            &mut self.jerk,
            &mut self.multiplier_rate,
            &mut self.state_jerk,
            &mut self.state_peak,
            &mut self.base_velocity,
            &mut self.defect,
        ] {
            r.numbers(part)?;
        }
        r.numbers(&mut self.scales[model.velocities..model.velocities + model.states])?;
        self.auxiliary_step = r.number()?;
        self.defect_known = r.integer()? == 1;
        if r.integer()? == 1 {
            self.restore_factors(r)?;
        }
        let s = &mut self.statistics;
        for count in [
            &mut s.steps,
            &mut s.rejected,
            &mut s.failed,
            &mut s.iterations,
            &mut s.factorizations,
            &mut s.residuals,
            &mut s.fallbacks,
            &mut s.kinks,
        ] {
            *count = r.integer()?;
        }
        for vibration in &mut self.vibrations {
            let mut numbers = [0.0; 8];
            r.numbers(&mut numbers)?;
            *vibration = Vibration::from_numbers(numbers);
        }
        if let Some(radau) = &mut self.radau {
            let mut numbers = radau.numbers();
            r.numbers(&mut numbers)?;
            if !radau.set_numbers(&numbers, self.factored_step.is_some()) {
                return Err(RuntimeError::Checkpoint {
                    reason: "its matrix of stages has no factors".into(),
                });
            }
        }
        Ok(())
    }

    /// Makes the kept factors again from their matrix, to the same bits. This changes no count, because the first
    /// factorisation was counted.
    fn restore_factors(&mut self, r: &mut Reader<'_>) -> Result<(), RuntimeError> {
        let step = r.number()?;
        let has_contraction = r.integer()? == 1;
        let contraction = r.number()?;
        r.numbers(&mut self.values)?;
        let mut secants = self.secants.numbers();
        r.numbers(&mut secants)?;
        self.secants.set_numbers(&secants);
        if self.solver.factor(&self.values).is_err() {
            return Err(RuntimeError::Checkpoint {
                reason: "its matrix has no factors".into(),
            });
        }
        self.factored_values = true;
        self.factored_step = Some(step);
        self.contraction = has_contraction.then_some(contraction);
        Ok(())
    }
}
