//! The causes of short steps.

use super::{Jump, Jumping, Simulation, Slow, StepLimit};
use crate::dynamics::Dynamics;
use crate::error::RuntimeError;
use crate::model::Model;
use crate::state::{State, move_pose};
use eng_system::Dimension;

/// The reason for the length of the last step.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) enum Limit {
    /// The sampling interval.
    #[default]
    Samples,
    /// The turn of a body.
    Turn,
    /// The phase of a sine in a condition.
    Sines,
    /// The estimated error.
    Error,
    /// A trial without solution.
    Unsolved(Box<RuntimeError>),
}

/// Moments, in units of the last step from the present state, between which jumps are searched. A choice:
/// near ones for a motion that is held at the kink, and up to 64 steps for one that passes it in longer
/// steps.
const MOMENTS: [f64; 11] = [
    -64.0, -16.0, -4.0, -1.0, -0.25, 0.0, 0.25, 1.0, 4.0, 16.0, 64.0,
];
/// Least change between two moments, relative to the value's own size, for the search of a jump. A choice: a
/// jump below a twentieth of a load holds no motion.
const NOTABLE: f64 = 0.05;
/// Rounding of an element's wrench, relative to its largest force. A choice some decades above the rounding
/// unit, for torques that are small differences.
const ROUNDING: f64 = 1e-9;
/// Halvings of the time between two moments. With more of them rounding would end the search within a zero at which a sign has a
/// third value, `if v > 0 then -f else (if v < 0 then f else 0)`, and find half of the jump.
const HALVINGS: usize = 40;
/// Part of a change that remains after all halvings if it is a jump. Of a steep slope nothing remains, and of
/// a jump in two parts a half. The limit is a choice between them.
const LEFT: f64 = 0.4;
/// Part of a change below which the search ends: it is no jump. A continuous change comes here after a few
/// halvings, and each evaluates all loads. The limit is a choice.
const GONE: f64 = 0.05;
/// Longest time across a kink that holds the motion, in steps. A choice: that of [`MOMENTS`].
const NEAR: f64 = 64.0;
/// Most elements in the search. A choice: those with the largest changes come first.
const LOOKED_AT: usize = 8;

/// The kind of the numbers of a part.
#[derive(Clone, Copy, PartialEq)]
enum Numbers {
    Force,
    Torque,
    Rates,
}

/// A part of an element's wrenches or rates: its first number, the count, the kind.
struct Part {
    element: usize,
    first: usize,
    count: usize,
    numbers: Numbers,
}

impl Part {
    /// Largest change that is rounding of the element's wrenches, from the evaluation in `loads`.
    fn rounding(&self, model: &Model, loads: &[f64]) -> f64 {
        // factor from a force to a number of this part
        let arm = match self.numbers {
            Numbers::Force => 1.0,
            Numbers::Torque => model.length,
            Numbers::Rates => return 0.0,
        };
        let Some(element) = model.elements.get(self.element) else {
            return 0.0;
        };
        let wrenches = loads.iter().skip(element.wrench).copied();
        let wrenches: Vec<f64> = wrenches.take(6 * element.markers.len()).collect();
        let strength = |wrench: &[f64]| {
            let (force, torque) = wrench.split_at(3);
            let of = |x: &[f64]| size(x.iter().copied());
            of(force).max(of(torque) / model.length)
        };
        let strengths = wrenches.chunks_exact(6).map(strength);
        ROUNDING * arm * strengths.fold(0.0, f64::max)
    }
}

impl Simulation {
    /// The cause that limits the steps.
    fn limit(&self) -> StepLimit {
        if self.options.step.fixed().is_some() {
            return StepLimit::Stated;
        }
        match self.limit {
            Limit::Samples => return StepLimit::Samples,
            Limit::Turn => return StepLimit::Turn,
            Limit::Sines => return StepLimit::Sines,
            Limit::Error | Limit::Unsolved(_) => {}
        }
        if let Some(jump) = self.jump(self.step_here()) {
            return StepLimit::Jump(jump);
        }
        match &self.limit {
            Limit::Unsolved(error) => match error.as_ref() {
                RuntimeError::Newton {
                    origin, equation, ..
                } => StepLimit::Unsolved {
                    origin: origin.clone(),
                    equation: equation.clone(),
                },
                RuntimeError::NotFinite { origin, .. } => StepLimit::Unsolved {
                    origin: origin.clone(),
                    equation: "no number".to_owned(),
                },
                _ => self.error_allows(),
            },
            _ => self.error_allows(),
        }
    }

    fn error_allows(&self) -> StepLimit {
        let (origin, state, _) = self.integrator.governing(&self.model);
        StepLimit::Error {
            origin: Box::new(origin),
            state,
        }
    }

    /// The length of the steps, and its cause.
    pub(crate) fn slow(&self) -> Slow {
        Slow {
            moment: self.moment(),
            step: self.step_here(),
            limit: Box::new(self.limit()),
        }
    }

    /// Length of the last step (s), or of the next one where the motion began anew behind a kink and no step is
    /// before.
    fn step_here(&self) -> f64 {
        if self.earlier_step > 0.0 {
            self.earlier_step
        } else {
            self.size.step
        }
    }

    /// The error of a failed step, or the jump that caused it.
    pub(super) fn explained(&self, error: RuntimeError) -> RuntimeError {
        let (moment, step) = match &error {
            RuntimeError::StepTooSmall { moment, step, .. }
            | RuntimeError::Newton { moment, step, .. } => (*moment, *step),
            _ => return error,
        };
        match self.jump(step) {
            Some(jump) => RuntimeError::Jumps { moment, step, jump },
            None => error,
        }
    }

    /// Refuses a motion that is held at a kink where a load or a rate jumps, because it has no solution after
    /// the jump. Many of the last steps have passed the kink to and fro or ended close to it, because longer ones
    /// have no solution, and on both sides the motion comes towards it.
    pub(super) fn refuse_held(&mut self) -> Result<(), RuntimeError> {
        let Some(kink) = self.kinks.often() else {
            return Ok(());
        };
        let found = self.refuse_held_at(kink);
        self.stand()?;
        found
    }

    fn refuse_held_at(&mut self, kink: usize) -> Result<(), RuntimeError> {
        let mut start = self.integrator.current.clone();
        let moment = self.moment();
        let solved =
            (self.system).accelerations(&self.model, &mut self.dynamics, &mut start, moment);
        // the next step reports the error
        if solved.is_err() || !self.comes_to(kink, &start)? {
            return Ok(());
        }
        let across = 2.0 * -self.kinks.value(kink) / self.kinks.rate(kink);
        if across > NEAR * self.earlier_step {
            return Ok(());
        }
        let Ok(other) = self.ahead(&start, across) else {
            return Ok(());
        };
        let (side, held) = (self.kinks.value(kink), self.comes_to(kink, &other)?);
        let crossed = self.kinks.value(kink) * side < 0.0;
        self.place_kinks(&start)?;
        if !(held && crossed) {
            return Ok(());
        }
        let path = &self.model.compiled.system.elements[self.kinks.element(kink)]
            .origin
            .path;
        match self.jump(self.earlier_step) {
            Some(jump) if jump.origin.path == *path => Err(RuntimeError::Jumps {
                moment,
                step: self.earlier_step,
                jump,
            }),
            _ => Ok(()),
        }
    }

    /// Refuses a repeating motion whose last step passed a kink at which a load or rate of its element jumps.
    pub(crate) fn refuse_jump_in_period(&self) -> Result<(), RuntimeError> {
        match self.jump_on_the_way() {
            Some(jump) => Err(RuntimeError::JumpsInPeriod {
                moment: self.moment(),
                jump,
            }),
            None => Ok(()),
        }
    }

    fn jump_on_the_way(&self) -> Option<Jump> {
        let kink = self.kinks.last_passed()?;
        let jump = self.jump(self.step_here() / MOMENTS[MOMENTS.len() - 1])?;
        let element = &self.model.compiled.system.elements[self.kinks.element(kink)];
        (jump.origin.path == element.origin.path).then_some(jump)
    }

    /// Whether the function of a kink goes to zero at a motion with its accelerations.
    fn comes_to(&mut self, kink: usize, motion: &State) -> Result<bool, RuntimeError> {
        self.place_kinks(motion)?;
        Ok(self.kinks.value(kink) * self.kinks.rate(kink) < 0.0)
    }

    /// The load or rate with the largest jump along the motion near the present state. `step` (s) is the
    /// distance of the search.
    ///
    /// The time between two moments with different values is halved again and again, towards the larger
    /// change. The change of a continuous value, however steep, shrinks with the time. The change of a jump
    /// remains.
    fn jump(&self, step: f64) -> Option<Jump> {
        let mut dynamics = Dynamics::new(&self.model);
        let moments: Vec<Vec<f64>> = MOMENTS
            .iter()
            .map(|at| self.loads_at(at * step, &mut dynamics))
            .collect::<Option<_>>()?;
        let mut found: Vec<(f64, usize, Part)> = Vec::new();
        for part in self.parts() {
            let pairs = moments.windows(2).enumerate();
            let changes = pairs.filter_map(|(index, pair)| match pair {
                [a, b] => Some((self.relative_change(a, b, &part), index)),
                _ => None,
            });
            if let Some((change, index)) = changes.max_by(|a, b| a.0.total_cmp(&b.0))
                && change > NOTABLE
            {
                found.push((change, index, part));
            }
        }
        found.sort_by(|a, b| b.0.total_cmp(&a.0));
        found
            .into_iter()
            .take(LOOKED_AT)
            .find_map(|(_, index, part)| {
                let ends = [MOMENTS.get(index)?, MOMENTS.get(index + 1)?];
                let loads = [moments.get(index)?, moments.get(index + 1)?];
                self.halved(
                    ends.map(|at| at * step),
                    loads.map(Clone::clone),
                    part,
                    &mut dynamics,
                )
            })
    }

    /// The change of a part as a share of its own size; zero if it is within the rounding of the element's
    /// wrenches.
    fn relative_change(&self, a: &[f64], b: &[f64], part: &Part) -> f64 {
        let own = |x: &[f64]| size(x.iter().skip(part.first).take(part.count).copied());
        let by = change(a, b, part);
        if by
            > part
                .rounding(&self.model, a)
                .max(part.rounding(&self.model, b))
        {
            by / own(a).max(own(b))
        } else {
            0.0
        }
    }

    /// Parts of the elements' wrenches, with forces and torques separate, and of rates of states.
    fn parts(&self) -> Vec<Part> {
        let mut parts = Vec::new();
        for (element, info) in self.model.elements.iter().enumerate() {
            if !info.dynamic {
                continue;
            }
            let part = |first, count, numbers| Part {
                element,
                first,
                count,
                numbers,
            };
            for marker in 0..info.markers.len() {
                let first = info.wrench + 6 * marker;
                parts.push(part(first, 3, Numbers::Force));
                parts.push(part(first + 3, 3, Numbers::Torque));
            }
            let states = self.model.class(element).states.len();
            if states > 0 {
                let first = self.model.wrenches + info.state;
                parts.push(part(first, states, Numbers::Rates));
            }
        }
        parts
    }

    /// Wrenches and rates at a time (s) after the present state, along its motion; `None` if a value is no
    /// number.
    fn loads_at(&self, time: f64, dynamics: &mut Dynamics) -> Option<Vec<f64>> {
        let model = &self.model;
        let current = &self.integrator.current;
        let mut near = current.clone();
        near.time += time;
        let motion = current.velocity.iter().zip(&current.acceleration);
        let increment: Vec<f64> = motion.map(|(v, a)| time * (v + 0.5 * time * a)).collect();
        move_pose(model, &current.pose, &increment, 1.0, &mut near.pose);
        for (v, a) in near.velocity.iter_mut().zip(&current.acceleration) {
            *v += time * a;
        }
        for (state, rate) in near.states.iter_mut().zip(&near.rates) {
            *state += time * rate;
        }
        dynamics.set_state(model, &near, &near.multipliers);
        dynamics.evaluate(model).ok()?;
        Some([dynamics.wrenches(), dynamics.rates()].concat())
    }

    /// The jump of a part between two moments, if it is one.
    fn halved(
        &self,
        mut ends: [f64; 2],
        mut loads: [Vec<f64>; 2],
        part: Part,
        dynamics: &mut Dynamics,
    ) -> Option<Jump> {
        let begun = change(&loads[0], &loads[1], &part);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (ends[0] + ends[1]);
            if middle == ends[0] || middle == ends[1] {
                break;
            }
            let between = self.loads_at(middle, dynamics)?;
            if change(&loads[0], &between, &part) > change(&between, &loads[1], &part) {
                (ends[1], loads[1]) = (middle, between);
            } else {
                (ends[0], loads[0]) = (middle, between);
            }
            if change(&loads[0], &loads[1], &part) <= GONE * begun {
                return None;
            }
        }
        let by = change(&loads[0], &loads[1], &part);
        if by <= LEFT * begun {
            return None;
        }
        let (by, of) = match part.numbers {
            Numbers::Force => (by, Jumping::Force),
            Numbers::Torque => (by, Jumping::Torque),
            Numbers::Rates => self.jumping_rate(&part, &loads)?,
        };
        let element = self.model.compiled.system.elements.get(part.element)?;
        Some(Jump {
            origin: Box::new(element.origin.clone()),
            by,
            of,
        })
    }

    /// The rate of an element's states that jumps most, as a share of the scale of its state.
    fn jumping_rate(&self, part: &Part, loads: &[Vec<f64>; 2]) -> Option<(f64, Jumping)> {
        let first = self.model.elements.get(part.element)?.state;
        let states = self.model.class(part.element).states.iter().enumerate();
        let jumps = states.filter_map(|(k, state)| {
            let [a, b] = [&loads[0], &loads[1]].map(|x| x.get(part.first + k).copied());
            let by = (b? - a?).abs();
            let scale = self.model.state_scales.get(first + k)?;
            Some((by / scale, by, state))
        });
        let (_, by, state) = jumps.max_by(|a, b| a.0.total_cmp(&b.0))?;
        let of = Jumping::Rate {
            state: state.name.clone(),
            dimension: state.dimension.over(Dimension::TIME),
        };
        Some((by, of))
    }
}

fn size(numbers: impl Iterator<Item = f64>) -> f64 {
    libm::sqrt(numbers.map(|x| x * x).sum())
}

/// Length of the difference of a part.
fn change(a: &[f64], b: &[f64], part: &Part) -> f64 {
    let of = |x: &[f64]| {
        x.iter()
            .skip(part.first)
            .take(part.count)
            .copied()
            .collect()
    };
    let (a, b): (Vec<f64>, Vec<f64>) = (of(a), of(b));
    size(a.iter().zip(&b).map(|(a, b)| b - a))
}
