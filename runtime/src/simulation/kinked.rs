//! Steps that end at kinks, and fixed steps that pass them.

use super::Simulation;
use super::beginning::differ;
use crate::acceleration::Factors;
use crate::error::{AccelerationJump, Moment, RuntimeError};
use crate::integrator::Trial;
use crate::kinks::Crossing;
use crate::model::STEP_SHARE;
use crate::state::State;

/// Most trials of a step that a kink may shorten. A choice: after these the step is accepted as it is, so
/// that a kink that is never met cannot stop a run.
const MOST_CUTS: usize = 14;
/// At a kink that is no length or angle: most trials that end at the zero of the cubic over the trial before.
/// A choice: secants of a smooth function meet it in four.
const SECANTS: usize = 4;
/// Share of the way to such a kink for the trials after these. A choice: a tenth leaves room for the error of
/// the cubic.
const SHORT: f64 = 0.9;
/// Share of the usual step below which the accelerations and multipliers of a step that ends at a kink are
/// not accurate. At a hundredth, rounding of positions makes 1e4 times the usual error of accelerations. A
/// choice.
const SHORT_STEP: f64 = 1e-2;
/// Shortest trial that ends at a kink (s). A kink nearer than this is at the beginning of the step. A choice
/// above the rounding of times of a run of some seconds.
const SHORTEST: f64 = 1e-12;
/// Share of the way to a kink by which the third trial ends before the kink, the factor of this share for
/// each further trial, and the largest share. A choice: the shares are 1e-5, 8e-5, 6e-4, 5e-3, 4e-2 and from
/// then on a tenth, so that a good prediction loses nothing and a bad one leads to an end before the kink.
const RETREAT: (f64, f64, f64) = (1e-5, 8.0, 0.1);
/// Share of the change of accelerations after a kink that a jump makes at the kink itself. A choice: of a
/// steep slope a small share appears there, of a jump nearly the whole.
const AT_ONCE: f64 = 0.5;
/// Distance after a kink, as a share of its limit, at which the motion starts again if forces jump there. A
/// choice: clear of rounding, and the load of the way across, with the step that ends a hundredth of the
/// limit before the kink ([`crate::kinks`]), remains below the limit.
const ACROSS: f64 = 1e-3;
/// Time from a kink to the states after it, as a share of the time in which the motion covers the model's
/// length or a radian. A choice: differences of accelerations over it have twelve digits, and stiff contacts
/// hardly deform in it.
const BEHIND: f64 = 1e-4;
/// Largest such time, as a share of the time to the next kink of the element. A choice: the second state is
/// at twice the time.
const BESIDE: f64 = 0.1;
/// Largest deviation of accelerations and rates after a kink from a straight line through the state at the
/// kink. A jump deviates by all of its size. A choice: a root deviates by about as much as it changes.
const STRAIGHT: f64 = 0.5;
/// Difference of accelerations or rates between both sides of a moment above which they jump, as a share of
/// the largest of them. A choice: between both sides pass some roundings of the time, in which nothing else
/// changes as much.
const JUMP: f64 = 1e-9;
/// Error of the velocity of a step after a kink that is allowed in any case, as a share of the largest
/// velocity. A choice: without it slow phases after a fast impact would take endless steps.
const VELOCITY: f64 = 1e-4;
/// Rounding of the increment of a step, as a share of the model's length: a hundred rounding units. Divided
/// by the step it is a rounding of the velocity.
const ROUNDING: f64 = 1e-14;
/// Share of the step that the error allows after a kink, and largest growth of the step there. After a kink a
/// force may grow as t^(3/2), as Hertz' contact does. The first step h then has an error of the velocity of
/// the order h^(5/2), which the error of positions does not show, and a long flight after the contact
/// multiplies it by its duration. With half of the step that the error allows in place of a fifth, this was
/// the largest error of a ball's path (`docs/theory.md`). The growth is a choice.
const FIRST: (f64, f64) = (0.2, 4.0);

impl Simulation {
    /// Evaluates the kink functions at the end of a fixed step h (s) and keeps the kink that it overlooks.
    pub(super) fn look_at_kinks(&mut self, h: f64) -> Result<(), RuntimeError> {
        let end = self.integrator.trial_state();
        self.kinks.evaluate(&self.model, &self.dynamics, end)?;
        let Some(found) = self.kinks.overlooked(&self.model, h, end.time) else {
            return Ok(());
        };
        let mut moment = self.moment();
        moment.time += h;
        let weight = found.depth / found.limit;
        self.keep_overlooked(&found, (h, moment), (weight, None));
        Ok(())
    }

    /// Keeps a kink within a fixed step h (s) that ends at a moment, if its weight, in units of its limit, is
    /// larger than that of the one before.
    pub(super) fn keep_overlooked(
        &mut self,
        passed: &Crossing,
        (h, end): (f64, Moment),
        (weight, jump): (f64, Option<AccelerationJump>),
    ) {
        let mut known = self.overlooked.iter();
        if known.all(|known| weight > known.weight) {
            self.overlooked = (self.kinks).named(&self.model, passed, (h, end), (weight, jump));
        }
    }

    /// The length (s) of the next trial and the kink at its end, if a trial of a step h passes a kink.
    ///
    /// The first shorter trial ends where the cubic over the trial says. The part of the trial after the kink
    /// has another force, which bends the cubic: after a stiff stop it says nothing. So the second one ends
    /// where the motion before the kink leads, if that is earlier, and each further one is shorter by a
    /// larger share. A trial without solution may come from a stiff stop after a kink, so it is repeated up
    /// to the kink that lies ahead.
    ///
    /// A step that begins at a kink and ends at another one, or at the next zero of the same function, sees no load that acts
    /// between them alone: a pulse in time, a thin sheet. So such a trial is first repeated up to the middle, where its end shows
    /// the load. A trial over which a distance may have come to its kink and gone again is repeated up to this place,
    /// where its end shows the distance. A trial that ends at a moment, except for rounding, is repeated up to just before it,
    /// because loads may jump there.
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
                passed.or_else(|| {
                    let kink = self.kinks.reached(begin + h, factor)?;
                    let begins = self.kinks.begins_at_kink(h, begin, factor);
                    (begins || self.kinks.is_moment(kink)).then_some((h, Some(kink)))
                })
            }
            Trial::Failed(_) => {
                let foreseen = self.kinks.foreseen(h, begin, factor);
                foreseen.map(|(at, kink)| (at, Some(kink)))
            }
        };
        let Some((at, kink)) = passed.filter(|_| *tries < MOST_CUTS) else {
            return Ok(None);
        };
        *tries += 1;
        let (at, kink) = match kink {
            None => (at, None),
            Some(_) if self.kinks.begins_at_kink(at, begin, factor) => (0.5 * at, None),
            Some(kink) => (self.before(kink, at, h, *tries, factor), Some(kink)),
        };
        if at >= h || at < SHORTEST || begin + at == begin {
            return Ok(None);
        }
        self.integrator.statistics.kinks += 1;
        Ok(Some((at, kink)))
    }

    /// The time (s) of a step that ends at a kink, which the last trial of h (s) finds after `at` (s). It ends before a
    /// moment, so that a load that begins or ends there has its value before it.
    fn before(&self, kink: usize, at: f64, h: f64, tries: usize, factor: f64) -> f64 {
        let begin = self.integrator.current.time;
        if self.kinks.is_moment(kink) {
            let moment = self.kinks.moment_at(kink, begin + h);
            let [just_before, _] = self.kinks.around(kink, moment);
            // by rounding, the time may be that of the moment itself
            return at.min(just_before - begin);
        }
        if !self.kinks.is_way(kink) {
            return if tries <= SECANTS { at } else { SHORT * at };
        }
        if tries < 2 {
            return at;
        }
        let expected = self.kinks.expected(kink, h, begin + h, factor);
        let at = expected.map_or(at, |expected| expected.min(at));
        let (first, growth, most) = RETREAT;
        match tries.checked_sub(3) {
            None => at,
            Some(more) => {
                let growths = std::iter::repeat_n(growth, more);
                at * (1.0 - (first * growths.product::<f64>()).min(most))
            }
        }
    }

    /// Starts the motion again after a kink if loads jump there, and then returns the time (s) that passes.
    /// The next step would end at the time `end` (s) at the latest.
    pub(super) fn after_jump(
        &mut self,
        kink: usize,
        end: f64,
    ) -> Result<Option<f64>, RuntimeError> {
        let jump = std::mem::take(&mut self.jump_at_kink);
        if self.kinks.is_moment(kink) {
            return self.after_jump_in_time(kink, end);
        }
        if jump > 0.0 {
            return self.after_jump_of_motion(kink, jump);
        }
        Ok(None)
    }

    /// Starts the motion again after a kink of the motion at which accelerations jump.
    ///
    /// The step before ends just before this kink. The motion continues across it with the accelerations
    /// before it, which takes about the time of a quarter of the limit. If it turns back there, as a sticking
    /// body does, or if the accelerations change by less than half of `jump` (their change at some distance
    /// from the kink), nothing is done.
    fn after_jump_of_motion(
        &mut self,
        kink: usize,
        jump: f64,
    ) -> Result<Option<f64>, RuntimeError> {
        let factor = self.options.step.tolerance();
        let here = self.integrator.current.time;
        let Some(time) = self.kinks.across(kink, ACROSS, here, factor) else {
            return Ok(None);
        };
        let moment = self.moment();
        let mut start = self.integrator.current.clone();
        let near = (self.system).accelerations(&self.model, &mut self.dynamics, &mut start, moment);
        // the next step reports the error
        let (Ok(()), Ok(behind)) = (near, self.ahead(&start, time)) else {
            return Ok(None);
        };
        let scales = self.model.velocity_scales();
        let changes = behind.acceleration.iter().zip(&start.acceleration);
        let change =
            (changes.zip(&scales)).fold(0.0_f64, |w, ((b, a), s)| w.max(((b - a) / s).abs()));
        if change < AT_ONCE * jump {
            return Ok(None);
        }
        let before = std::mem::replace(&mut self.integrator.current, behind);
        self.stand()?;
        (self.kinks).evaluate(&self.model, &self.dynamics, &self.integrator.current)?;
        let mut behind = std::mem::replace(&mut self.integrator.current, before);
        if !self.kinks.is_left(kink) {
            self.stand()?;
            return Ok(None);
        }
        // the motion across the kink leaves the constraints by the third power of its time, and the next
        // step, however short, would have to remove this gap
        let projected = self.system.project(
            &self.model,
            &mut self.dynamics,
            &mut behind,
            moment,
            Factors::Made,
        );
        // the next step reports the error
        if projected.is_err() {
            self.stand()?;
            return Ok(None);
        }
        self.begin_behind(&start, behind).map(Some)
    }

    /// Starts the motion again after a moment at which a load or the rate of a state jumps.
    ///
    /// The step before ends just before this moment, most often by some roundings of the time. The motion
    /// continues up to both sides of it with the accelerations before it. Without a jump it does so only if
    /// the next step would end between both sides, and so have no length.
    fn after_jump_in_time(&mut self, kink: usize, end: f64) -> Result<Option<f64>, RuntimeError> {
        let moment = self.moment();
        let time = self.integrator.current.time;
        let moment_of_kink = self.kinks.moment_here(kink, time);
        let [before, behind] = self.kinks.around(kink, moment_of_kink);
        let (before, behind) = (before.min(time), behind.max(time));
        let ends_here = end < behind + SHORTEST;
        let behind = if ends_here { behind.max(end) } else { behind };
        let mut start = self.integrator.current.clone();
        let mut near = start.clone();
        near.time = before;
        for state in [&mut start, &mut near] {
            let found = (self.system).accelerations(&self.model, &mut self.dynamics, state, moment);
            // the next step reports the error
            if found.is_err() {
                return Ok(None);
            }
        }
        // a motion may begin where a load has another value for this moment alone
        let alone = differ(&start.acceleration, &near.acceleration, JUMP)
            || differ(&start.rates, &near.rates, JUMP);
        start.acceleration.copy_from_slice(&near.acceleration);
        start.rates.copy_from_slice(&near.rates);
        let Ok(mut far) = self.ahead(&start, behind - time) else {
            return Ok(None);
        };
        far.time = behind;
        if !alone
            && !ends_here
            && !differ(&near.acceleration, &far.acceleration, JUMP)
            && !differ(&near.rates, &far.rates, JUMP)
        {
            return Ok(None);
        }
        self.begin_behind(&start, far).map(Some)
    }

    /// Starts the motion again at the state `behind`, which follows the present state `start`. Returns the
    /// time (s) between them.
    fn begin_behind(&mut self, start: &State, behind: State) -> Result<f64, RuntimeError> {
        let before = std::mem::replace(&mut self.integrator.current, behind);
        self.begin_anew()?;
        let time = self.integrator.current.time - before.time;
        // a sample may lie between the two states
        let motion = start.velocity.iter().zip(&start.acceleration);
        for (increment, (v, a)) in self.integrator.increment.iter_mut().zip(motion) {
            *increment = time * v + 0.5 * time * time * a;
        }
        self.integrator.previous.copy_from(&before);
        Ok(time)
    }

    /// Keeps the step (s) before a kink at which a step ends, until steps are as long again.
    pub(super) fn keep_step_before_kink(&mut self, step: f64) {
        if self.size.step >= self.before_kink {
            self.before_kink = 0.0;
        }
        // beside the kink of a valve states move infinitely fast, and no step shows a rate
        let followed = |kink: usize| self.kinks.is_way(kink) || self.kinks.is_moment(kink);
        if self.at_kink.is_some_and(followed) {
            self.before_kink = self.before_kink.max(step);
        }
    }

    /// A trial of h (s) after a kink, with the larger one of its errors of positions and of velocities.
    pub(super) fn with_velocity_error(&self, trial: Trial, h: f64, factor: f64) -> Trial {
        match trial {
            Trial::Solved { error } if self.before_kink > 0.0 => Trial::Solved {
                error: error.max(self.velocity_error(h, factor)),
            },
            other => other,
        }
    }

    /// The error of the velocities of the last trial of h (s), in units of its limit.
    ///
    /// The error of the positions does not show a short pulse between two kinks: within a microsecond nothing
    /// moves. But the error of the velocity remains, and over a step as long as that before the pulse it
    /// becomes an error of positions. The scheme integrates accelerations like the trapezoidal rule: the
    /// error of a step is `h³/12` times their second rate.
    fn velocity_error(&self, h: f64, factor: f64) -> f64 {
        let (begin, end) = (&self.integrator.current, self.integrator.trial_state());
        let scales = self.model.velocity_scales();
        let (mut error, mut speed) = (0.0_f64, 0.0_f64);
        for (i, scale) in scales.iter().enumerate() {
            let rate = (end.acceleration[i] - begin.acceleration[i]) / h;
            let change = rate - self.integrator.jerk[i];
            error = error.max((change / scale).abs());
            speed = speed.max((end.velocity[i] / scale).abs());
        }
        let shown =
            STEP_SHARE * self.model.tolerance * factor / (self.model.length * self.before_kink);
        let least = shown.max(VELOCITY * factor * speed).max(ROUNDING / h);
        h * h / 12.0 * error / least
    }

    /// Renews the rates of accelerations in the scheme, after a step h (s) that ended at a kink.
    ///
    /// The auxiliary a of the scheme belongs to the instant `t + (α_m − α_f) h`, so it contains the rate of the
    /// acceleration v̈. After a kink v̈ is another one. With the rate from before the kink every passage would
    /// cost an error of `h² Δv̈` in the velocity, as if the step had not ended there. The rate comes from
    /// accelerations at two states after the kink. The estimate of the error for this rate gives the next step.
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
        // the multipliers of such a step are inaccurate, and so is their power, which the energy of this step
        // and of the next one would take
        if self.options.energy {
            self.powers[1] = self.dynamics.powers(&self.model, &start.multipliers)?.1;
        }
        // the rounding of positions over the square of a short step is an error of accelerations, which the
        // scheme would carry on
        if h < SHORT_STEP * self.size.step {
            self.pass_defect(moment)?;
            self.integrator.take_accelerations(&start);
        }
        let motion_rate = start.motion_rate(&self.model);
        if motion_rate == 0.0 {
            return Ok(());
        }
        let e = (BEHIND / motion_rate).min(h.max(BEHIND * self.size.step));
        // the states must not lie behind the next kink, such as the other face of a thin sheet
        let beside = self.at_kink.map(|kink| self.kinks.time_beside(kink));
        let e = e.min(BESIDE * beside.unwrap_or(f64::INFINITY));
        let left = self.kinks.time_left(e);
        let way = self.at_kink.filter(|kink| self.kinks.is_way(*kink));
        let to_kink = way.map_or(0.0, |kink| self.kinks.time_to(kink));
        let first = e + left.max(to_kink);
        // a table may end after the kink; then the next step reports it
        let Ok([a, b]) = self.two_ahead(&start, [first, first + e]) else {
            return Ok(());
        };
        let rate = |a: &[f64], b: &[f64]| -> Vec<f64> {
            a.iter().zip(b).map(|(a, b)| (b - a) / e).collect()
        };
        let jerk = rate(&a.acceleration, &b.acceleration);
        let state_jerk = rate(&a.rates, &b.rates);
        // the value at the kink itself, from those after it
        let bent = |jerk: &[f64], near: &[f64], at: &[f64], scales: &[f64]| {
            let pairs = jerk.iter().zip(near).zip(at).zip(scales);
            pairs.fold((0.0_f64, 0.0_f64), |(miss, size), (((j, a), at), scale)| {
                (
                    miss.max(((a - j * (first - to_kink) - at) / scale).abs()),
                    size.max((j * (first - to_kink) / scale).abs()),
                )
            })
        };
        let scales = self.model.velocity_scales();
        let moves = bent(&jerk, &a.acceleration, &start.acceleration, &scales);
        let states = bent(
            &state_jerk,
            &a.rates,
            &start.rates,
            &self.model.state_scales,
        );
        let [moves, states] = [moves, states].map(|(miss, size)| miss <= STRAIGHT * size);
        if !moves && states {
            let changes = a.acceleration.iter().zip(&start.acceleration);
            let changes: Vec<f64> = changes.map(|(a, start)| a - start).collect();
            self.jump_at_kink = self.model.largest(&changes);
        }
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
        self.pass_defect(moment)?;
        let mut rates = vec![0.0; self.model.rows];
        self.dynamics
            .constraints_along(&self.model, &jerk, &mut rates)?;
        self.system.normal(&self.model, &rates, &mut self.work);
        (self.integrator).renew(&jerk, &self.work, &multiplier_rate, &state_jerk);
        let factor = self.options.step.tolerance();
        let error = self.integrator.coefficients.error.abs()
            * self.model.largest(&jerk)
            * self.model.length
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
