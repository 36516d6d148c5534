//! The equations along one period of a motion.
//!
//! A transient runs over the period from a state. At the stages of the integration its states, completed at
//! acceleration level, give the equations.

use super::super::constancy;
use super::super::equations::Equations;
use super::super::run::{Stretch, turn_by};
use super::harmonics::{Sight, seen};
use super::march::{March, radau};
use crate::error::{Moment, RuntimeError};
use crate::model::Model;
use crate::simulation::Simulation;
use crate::state::State;
use crate::transient::{Advance, Observer, follow};
use eng_system::system::{Extent, StepControl};
use nalgebra::{DMatrix, DVector};
use std::f64::consts::TAU;

/// Segments of the period: an odd number, see `multipliers`. Seven is a choice: with the limit of roots,
/// 1e-7, multipliers down to 10⁻⁴⁹ are found, and the effort grows with the cube of the number.
const SEGMENTS: usize = 7;
/// Largest size (of ξ, times segments) of the matrix for the eigenvalues. A choice: their time grows with the
/// cube of the size.
const LARGEST: usize = 1400;
/// Steps of the integration per turn of the fastest body, and the least and the most steps. Choices: the
/// scheme has order five, so 256 steps a turn are exact to many digits for the orders of a machine. The most
/// steps limit the time of a run.
const PER_TURN: f64 = 256.0;
const LEAST: usize = 256;
const MOST: usize = 8192;
/// Share of a step by which a period may exceed a whole power of two of steps. A choice: without it a period
/// that is longer by rounding would take twice as many steps.
const SPARE: f64 = 0.02;

/// The period of a motion.
#[derive(Clone, Copy, Debug)]
pub(super) struct Period {
    /// The period (s), or its first guess if it is free.
    pub time: f64,
    /// Whether the motion determines it.
    pub free: bool,
    /// The angle of the cycle (rad), if the analysis states one.
    pub angle: Option<f64>,
}

/// The period of an analysis's `over`, at a state of the motion.
pub(super) fn period_of(
    simulation: &Simulation,
    over: Extent,
    observer: &mut dyn Observer,
) -> Result<Period, RuntimeError> {
    let refuse = |message: &str| {
        Err(RuntimeError::NoPeriod {
            message: message.to_owned(),
        })
    };
    let state = simulation.sampled_state();
    match over {
        Extent::Time(time) => Ok(Period {
            time,
            free: false,
            angle: None,
        }),
        Extent::Angle(angle) if simulation.cycle_angle().is_some() => {
            let mut values = vec![0.0; simulation.model().compiled.system.channels.len()];
            let mut ahead = simulation.restarted(state.clone())?;
            turn_by(
                &mut ahead,
                angle,
                &mut values,
                &mut Stretch::new(observer, 0.0, 0.5),
            )?;
            Ok(Period {
                time: ahead.sampled_state().time - state.time,
                free: true,
                angle: Some(angle),
            })
        }
        Extent::Angle(angle) => {
            let fastest = constancy::fastest(simulation.model(), state);
            if fastest <= 0.0 {
                return refuse("`over` is an angle, but no body turns");
            }
            Ok(Period {
                time: angle / fastest,
                free: true,
                angle: None,
            })
        }
    }
}

/// The equations along one period, and their integration.
pub(super) struct Round {
    pub start: State,
    pub moment: Moment,
    pub first: Equations,
    pub last: Equations,
    pub end: State,
    /// The period (s).
    pub period: f64,
    /// Steps of the integration.
    pub steps: usize,
    pub fine: March,
    /// The integration with steps of double length, if the error is wanted.
    pub coarse: Option<March>,
    pub sights: Vec<Sight>,
}

fn power_of_two(count: f64) -> usize {
    let count = if count.is_finite() { count } else { 0.0 };
    (((1.0 - SPARE) * count).ceil() as usize)
        .clamp(LEAST, MOST)
        .next_power_of_two()
}

/// Step lengths of transient and integration.
#[derive(Clone, Copy, Debug)]
pub(super) struct StepLengths {
    /// The control stated in the analysis.
    pub control: StepControl,
    /// Factor of the default number of steps, a power of two. It does not change a stated step.
    pub finer: usize,
}

impl StepLengths {
    /// Number of integration steps over a time (s) from a state.
    pub fn steps(self, model: &Model, state: &State, time: f64) -> usize {
        match self.control.fixed() {
            Some(h) => power_of_two(time / h),
            None => {
                let turns = constancy::fastest(model, state) * time / TAU;
                (power_of_two(PER_TURN * turns) * self.finer).min(MOST)
            }
        }
    }

    /// Four times as many steps, after a round of `steps` whole steps; `None` for a stated step, or at the
    /// largest number.
    pub fn refined(self, steps: usize) -> Option<StepLengths> {
        (self.control.fixed().is_none() && 2 * steps < MOST).then_some(StepLengths {
            finer: 4 * self.finer,
            ..self
        })
    }
}

/// A period in progress: its transient, and the present equations.
struct Course<'a> {
    running: Simulation,
    model: Model,
    moment: Moment,
    /// End of the period (s).
    end: f64,
    /// Longest step of the transient (s).
    longest: f64,
    values: Vec<f64>,
    observer: &'a mut dyn Observer,
}

impl Course<'_> {
    /// The equations at a time (s), which must not be before the last one.
    fn at(&mut self, time: f64) -> Result<Equations, RuntimeError> {
        let time = time.min(self.end);
        while self.running.time() < time {
            self.running.step_no_longer(self.end, self.longest)?;
            self.running.refuse_jump_in_period()?;
        }
        self.running.sample_at(time, &mut self.values)?;
        Equations::new(&self.model, self.running.sampled_state(), self.moment)
    }

    /// Refuses a motion that began at a kink with unequal sides and is at one now. A motion may pass the kink at which it begins, but
    /// then it is elsewhere later.
    fn refuse_rest(&self, begun: Option<&RuntimeError>) -> Result<(), RuntimeError> {
        let now = || kinked(&self.model, self.running.sampled_state(), self.moment);
        match begun {
            Some(begun) if now().is_some() => Err(begun.clone()),
            _ => Ok(()),
        }
    }

    fn seen(&self, equations: &Equations) -> DMatrix<f64> {
        seen(&self.model, self.running.sampled_state(), equations)
    }

    fn report(&mut self, part: f64) -> Result<(), RuntimeError> {
        let advance = Advance::new(&self.running, part);
        follow(&self.running, self.observer, &advance, false)
    }
}

/// The refusal of a state at a kink with unequal sides.
fn kinked(model: &Model, state: &State, moment: Moment) -> Option<RuntimeError> {
    let error = Equations::of_both_sides(model, state, moment).err();
    error.filter(|error| matches!(error, RuntimeError::Kinked { .. }))
}

/// One period (s) from a state. With `halved`, the integration uses halved steps, stores the observed moves
/// at their ends, and runs once more with whole steps. Otherwise it uses whole steps only. The transient is
/// the same.
pub(super) fn round(
    simulation: &Simulation,
    state: &State,
    time: f64,
    lengths: StepLengths,
    halved: bool,
    observer: &mut dyn Observer,
) -> Result<Round, RuntimeError> {
    let mut values = vec![0.0; simulation.model().compiled.system.channels.len()];
    let mut running = simulation.restarted(state.clone())?;
    running.evaluate_channels(&mut values)?;
    let model = running.model().clone();
    let start = running.sampled_state().clone();
    let moment = Moment {
        time: start.time,
        cycle_angle: running.sampled_cycle()?.map(|c| c[0]),
    };
    let first = Equations::new(&model, &start, moment)?;
    let kinked = halved.then(|| kinked(&model, &start, moment)).flatten();
    let pairs = lengths.steps(&model, &start, time) / 2;
    let whole = time / pairs as f64;
    let size = first.first_order_size().max(1);
    let mut segments = (LARGEST / size).clamp(1, SEGMENTS);
    segments -= usize::from(segments.is_multiple_of(2));
    let [c, d, _] = radau().places;
    let mut fine = March::new(&first);
    let mut coarse = halved.then(|| March::new(&first));
    let mut sights = Vec::new();
    let mut last = first.clone();
    let no_step = || RuntimeError::Eigenvalues {
        size,
        what: "a step of the march has no solution".to_owned(),
    };
    let end = start.time + time;
    let mut course = Course {
        running,
        model,
        moment,
        end,
        longest: whole,
        values,
        observer,
    };
    let mut segment = 0;
    for pair in 0..pairs {
        let closing = pair + 1 == pairs;
        let begin = start.time + pair as f64 * whole;
        let after = |offset: f64| begin + offset * whole;
        let final_time = if closing { end } else { after(1.0) };
        last = match &mut coarse {
            None => {
                let stages = [
                    course.at(after(c))?,
                    course.at(after(d))?,
                    course.at(final_time)?,
                ];
                fine.step(stages.each_ref(), whole).ok_or_else(no_step)?;
                let [_, _, last] = stages;
                last
            }
            Some(coarse) => {
                let half = 0.5 * whole;
                // the stages of both step lengths, in the order of time
                let one = course.at(after(0.5 * c))?;
                let whole_one = course.at(after(c))?;
                let two = course.at(after(0.5 * d))?;
                let three = course.at(after(0.5))?;
                let middle = course.seen(&three);
                let four = course.at(after(0.5 + 0.5 * c))?;
                let whole_two = course.at(after(d))?;
                let five = course.at(after(0.5 + 0.5 * d))?;
                let six = course.at(final_time)?;
                let p = first.freedoms();
                let mut look = |fine: &March, view: DMatrix<f64>, index: usize| {
                    sights.push(Sight {
                        segment,
                        time: index as f64 * half,
                        seen: view * &fine.turn * fine.solution.rows(0, p),
                    });
                };
                fine.step([&one, &two, &three], half).ok_or_else(no_step)?;
                look(&fine, middle, 2 * pair + 1);
                fine.step([&four, &five, &six], half).ok_or_else(no_step)?;
                look(&fine, course.seen(&six), 2 * pair + 2);
                let stages = [&whole_one, &whole_two, &six];
                coarse.step(stages, whole).ok_or_else(no_step)?;
                six
            }
        };
        course.refuse_rest(kinked.as_ref().filter(|_| pair == pairs / 3))?;
        if !closing && (pair + 1) * segments >= (segment + 1) * pairs {
            fine.end_segment();
            coarse.iter_mut().for_each(March::end_segment);
            segment += 1;
        }
        course.report((pair + 1) as f64 / pairs as f64)?;
    }
    fine.close(&first);
    coarse.iter_mut().for_each(|march| march.close(&first));
    let Course {
        mut running,
        observer,
        ..
    } = course;
    for warning in running.take_warnings() {
        observer.warning(&warning);
    }
    Ok(Round {
        end: running.sampled_state().clone(),
        start,
        moment,
        first,
        last,
        period: time,
        steps: if halved { 2 * pairs } else { pairs },
        fine,
        coarse,
        sights,
    })
}

impl Round {
    /// `X_m … X_1`.
    pub fn monodromy(segments: &[DMatrix<f64>]) -> DMatrix<f64> {
        let mut all = segments.iter();
        let first = all.next().cloned().unwrap_or_else(|| DMatrix::zeros(0, 0));
        all.fold(first, |product, next| next * product)
    }

    /// Moves and rates as ξ at the start: x = NᵀM u, ẋ = NᵀM u̇.
    pub fn coordinates(
        &self,
        moves: &DVector<f64>,
        rates: &DVector<f64>,
        states: &[f64],
    ) -> DVector<f64> {
        let across = self.first.basis.transpose() * &self.first.mass;
        let (x, y) = (&across * moves, &across * rates);
        DVector::from_iterator(
            x.len() + y.len() + states.len(),
            x.iter().chain(y.iter()).chain(states).copied(),
        )
    }

    /// The direction of the motion itself, `(NᵀM v, NᵀM v̇, ż)`.
    pub fn along(&self) -> DVector<f64> {
        let ground = |x: &[f64]| self.first.in_ground_axes(DVector::from_column_slice(x));
        self.coordinates(
            &ground(&self.start.velocity),
            &ground(&self.start.acceleration),
            &self.start.rates,
        )
    }
}
