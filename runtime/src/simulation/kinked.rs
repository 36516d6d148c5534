//! Steps that end at kinks, and fixed steps that pass them.

use super::Simulation;
use crate::error::RuntimeError;
use crate::integrator::{STEP_SHARE, Trial};
use crate::state::State;

/// Most trials of a step that end where the kink should be, and most trials that a kink may shorten.
const SECANTS: usize = 4;
const MOST_CUTS: usize = 12;
/// Share of the way to a kink for the trials after that.
const SHORT: f64 = 0.9;
/// Distance of the states behind a kink, as a share of the time in which the motion covers about its own size.
const BEHIND: f64 = 1e-4;
/// Largest deviation of accelerations and rates behind a kink from a straight line through the state at the
/// kink. A jump deviates by all of its size.
const STRAIGHT: f64 = 0.5;
/// Difference of accelerations or rates on both sides of a moment that is a jump, as a share of the largest of them.
const JUMP: f64 = 1e-9;
/// Share of the step that the error allows behind a kink, and largest growth of the step there. Behind a kink a force may grow
/// as t^(3/2), as Hertz' contact does. The first step h then has an error of the velocity of the order h^(5/2), which the
/// error of positions does not show, and a long flight after the contact multiplies it by its duration.
const FIRST: (f64, f64) = (0.2, 4.0);

impl Simulation {
    /// Evaluates the kink functions at the end of a fixed step h (s) and keeps the kink that it overlooks.
    pub(super) fn look_at_kinks(&mut self, h: f64) -> Result<(), RuntimeError> {
        let end = self.integrator.trial_state();
        self.kinks.evaluate(&self.model, &self.dynamics, end)?;
        let Some(found) = self.kinks.overlooked(&self.model, h, end.time) else {
            return Ok(());
        };
        let ratio = |depth: f64, limit: f64| depth / limit;
        let before = self.overlooked.as_ref();
        if before.is_none_or(|b| ratio(found.depth, found.limit) > ratio(b.depth, b.limit)) {
            let mut moment = self.moment();
            moment.time += h;
            self.overlooked = self.kinks.named(&self.model, &found, h, moment);
        }
        Ok(())
    }

    /// The length (s) of the next trial and the kink at its end, if a trial of a step h passes a kink.
    ///
    /// The kink is where the cubics over the trial say. The part of the trial behind it has another force, so a
    /// second or third trial may be necessary (the secant rule). If four of them do not end at the kink, the next
    /// ones end before it. A trial without solution may come from a stiff stop behind a kink, so it is repeated
    /// up to the kink that lies ahead.
    ///
    /// A step that begins at a kink and ends at another one sees no load that acts between them alone: a pulse in time, a thin
    /// sheet. So such a trial is first repeated up to the middle, where its end shows the load.
    pub(super) fn kink_within(
        &mut self,
        h: f64,
        factor: f64,
        trial: &Trial,
        tries: &mut usize,
    ) -> Result<Option<(f64, Option<usize>)>, RuntimeError> {
        let begin = self.integrator.current.time;
        let passed = match trial {
            Trial::Solved { .. } => {
                let end = self.integrator.trial_state();
                self.kinks.evaluate(&self.model, &self.dynamics, end)?;
                let passed = self.kinks.passed(h, begin + h, factor);
                let passed = passed.map(|passed| (passed.time, passed.item));
                passed.or_else(|| {
                    let kink = self.kinks.reached(begin + h, factor)?;
                    let begins = self.kinks.begins_at_other(kink, begin, factor);
                    begins.then_some((h, kink))
                })
            }
            Trial::Failed(_) => self.kinks.foreseen(h, begin, factor),
        };
        let Some((at, kink)) = passed.filter(|_| *tries < MOST_CUTS) else {
            return Ok(None);
        };
        *tries += 1;
        let at = if *tries <= SECANTS { at } else { SHORT * at };
        let (at, kink) = match self.kinks.begins_at_other(kink, begin, factor) {
            true => (0.5 * at, None),
            false => (self.before(kink, at), Some(kink)),
        };
        if at >= h || begin + at == begin {
            return Ok(None);
        }
        self.integrator.statistics.kinks += 1;
        Ok(Some((at, kink)))
    }

    /// The time (s) of a step that ends at a kink after `at` (s). It ends before a moment, so that a load that begins or ends there
    /// has its value before it.
    fn before(&self, kink: usize, at: f64) -> f64 {
        let begin = self.integrator.current.time;
        match self.kinks.is_moment(kink) {
            true => (begin + at).next_down().next_down() - begin,
            false => at,
        }
    }

    /// Starts the motion again behind a moment at which a load or the rate of a state jumps.
    ///
    /// The step before ends just before this moment. Both sides are some roundings of the time away from it.
    pub(super) fn after_jump_in_time(&mut self, kink: usize) -> Result<(), RuntimeError> {
        if !self.kinks.is_moment(kink) {
            return Ok(());
        }
        let moment = self.moment();
        let time = self.integrator.current.time;
        let behind = (0..4).fold(time, |time, _| time.next_up());
        let before = time.next_down();
        let mut sides = [before, behind].map(|time| {
            let mut state = self.integrator.current.clone();
            state.time = time;
            state
        });
        for state in &mut sides {
            let found = (self.system).accelerations(&self.model, &mut self.dynamics, state, moment);
            // the next step reports the error
            if found.is_err() {
                return Ok(());
            }
        }
        let [near, far] = &sides;
        let differ = |a: &[f64], b: &[f64]| {
            let size = a.iter().chain(b).fold(0.0_f64, |most, x| most.max(x.abs()));
            a.iter().zip(b).any(|(a, b)| (a - b).abs() > JUMP * size)
        };
        if differ(&near.acceleration, &far.acceleration) || differ(&near.rates, &far.rates) {
            self.integrator.current.time = behind;
            self.begin_anew()?;
        }
        Ok(())
    }

    /// Renews the rates of accelerations in the scheme, after a step h (s) that ended at a kink.
    ///
    /// The auxiliary a of the scheme belongs to the instant `t + (α_m − α_f) h`, so it contains the rate of the
    /// acceleration v̈. Behind a kink v̈ is another one. With the rate from before the kink every passage would
    /// cost an error of `h² Δv̈` in the velocity, as if the step had not ended there. The rate comes from
    /// accelerations at two states behind the kink. The estimate of the error for this rate gives the next step.
    ///
    /// If an acceleration jumps, or rises like a root, nothing is renewed. The steps of the error control then
    /// follow it. If the rate of a state does this, such as the flow `√Δp` of a valve, steps end at this kink no
    /// more: beside it a state moves infinitely fast, and the error control passes it in longer steps.
    pub(super) fn renew_at_kink(&mut self, h: f64) -> Result<(), RuntimeError> {
        let moment = self.moment();
        let mut start = self.integrator.current.clone();
        let found =
            (self.system).accelerations(&self.model, &mut self.dynamics, &mut start, moment);
        if found.is_err() {
            return Ok(());
        }
        let scales = self.model.velocity_scales();
        let largest = |x: &[f64]| {
            let pairs = x.iter().zip(&scales);
            pairs.fold(0.0_f64, |w, (x, s)| w.max((x / s).abs()))
        };
        let pace = largest(&start.velocity).max(libm::sqrt(largest(&start.acceleration)));
        if pace == 0.0 {
            return Ok(());
        }
        let e = (BEHIND / pace).min(h.max(BEHIND * self.size.step));
        let first = e + self.kinks.time_left(e);
        // a table may end behind the kink; then the next step reports it
        let Ok([a, b]) = self.two_ahead(&start, [first, first + e]) else {
            return Ok(());
        };
        let rate = |a: &[f64], b: &[f64]| -> Vec<f64> {
            a.iter().zip(b).map(|(a, b)| (b - a) / e).collect()
        };
        let jerk = rate(&a.acceleration, &b.acceleration);
        let state_jerk = rate(&a.rates, &b.rates);
        // the value at the kink itself, from those behind it
        let bent = |jerk: &[f64], near: &[f64], at: &[f64], scales: &[f64]| {
            let pairs = jerk.iter().zip(near).zip(at).zip(scales);
            pairs.fold((0.0_f64, 0.0_f64), |(miss, size), (((j, a), at), scale)| {
                let change = j * first;
                (
                    miss.max(((a - change - at) / scale).abs()),
                    size.max((change / scale).abs()),
                )
            })
        };
        let moves = bent(&jerk, &a.acceleration, &start.acceleration, &scales);
        let states = bent(
            &state_jerk,
            &a.rates,
            &start.rates,
            &self.model.state_scales,
        );
        let [moves, states] = [moves, states].map(|(miss, size)| miss <= STRAIGHT * size);
        if !states
            && let Some(kink) = self.at_kink
            && !self.kinks.is_moment(kink)
        {
            self.kinks.ignore(kink);
        }
        if !(moves && states) {
            return Ok(());
        }
        let multiplier_rate = rate(&a.multipliers, &b.multipliers);
        if !self.defect_of_step()? {
            let current = &self.integrator.current;
            self.system.velocity_defect(
                &self.model,
                &mut self.dynamics,
                current,
                moment,
                &mut self.work,
            )?;
        }
        self.integrator.set_defect(&self.work);
        let mut rates = vec![0.0; self.model.rows];
        self.dynamics
            .constraints_along(&self.model, &jerk, &mut rates)?;
        self.system.normal(&self.model, &rates, &mut self.work);
        (self.integrator).renew(&jerk, &self.work, &multiplier_rate, &state_jerk);
        let factor = self.options.step.tolerance();
        let error = self.integrator.coefficients.error.abs() * largest(&jerk) * self.model.length
            / (STEP_SHARE * self.model.tolerance * factor);
        let longest = FIRST.1 * self.size.step.max(h);
        let allowed = if error > 0.0 {
            (FIRST.0 * libm::cbrt(1.0 / error)).min(longest)
        } else {
            longest
        };
        self.size.renewed(allowed);
        Ok(())
    }

    fn two_ahead(&mut self, start: &State, times: [f64; 2]) -> Result<[State; 2], RuntimeError> {
        Ok([self.ahead(start, times[0])?, self.ahead(start, times[1])?])
    }
}
