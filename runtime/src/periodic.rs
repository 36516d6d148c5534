//! Running until the cycle repeats; the last cycle is the result.
//!
//! After every cycle each channel is compared, sample by sample, with the cycle before ([`repetition`]). The
//! complex factor λ describes how differences shrink and turn from cycle to cycle, and `change |λ/(1 − λ)|`
//! estimates the distance to the limit. The analysis ends when the largest change and this distance are below
//! the requested change.
//!
//! Where one slow motion decays over many cycles, the analysis leaps towards its limit ([`leap`]) and compares the
//! cycles after it.
//!
//! The reported factor of decay is that of the motion itself ([`motion`]). If the motion repeats within the
//! tolerance of the steps while an output still changes irregularly, this change is noise of the steps, and
//! the summary reports it. The orbits of the journals show half-speed whirl ([`whirl`]), which does not
//! repeat with the cycle.
//!
//! Derivatives by parameters follow the repeated motion behind its last cycle ([`gradients`]).

mod gradients;
pub mod leap;
pub mod motion;
pub mod repetition;
pub mod whirl;
pub(crate) mod wide;

use crate::body::BodyModel;
use crate::decay::{CycleReport, Decay, Mode};
use crate::error::RuntimeError;
use crate::linearised::Wanted;
use crate::model::Model;
use crate::simulation::{Energy, Gradients, Section, Simulation, Slow, Warning};
use crate::start::{StartReport, Unstable};
use crate::transient::{
    Advance, Observer, Onwards, Renewed, RunSummary, Sample, Verdict, parameters_of, run_by_cycles,
};
use eng_system::code::Compiled;
use eng_system::significant::short;
use eng_system::system::{Extent, Periodic, StepControl, Transient};
use gradients::{Repeated, Row, Rows};
use leap::Leaps;
use motion::{Motion, Moved};
use repetition::{Comparison, Growth};
use std::collections::VecDeque;
use std::ops::ControlFlow;
use whirl::Whirl;
use wide::{Wide, distance_of_two};

/// Number of cycles whose orbits are searched for whirl. A choice: eight cycles show its order and its
/// growth.
const ORBITS: usize = 8;
/// Share of the requested change below which a change needs no estimate of the distance. A choice: the rest
/// is then below the requested change for factors up to 0.99.
const PLAIN: f64 = 1e-2;
/// Least swing of lengths, in position tolerances. A position tolerance is a thousandth of the smallest
/// clearance, so this is the clearance itself.
const TOLERANCES: f64 = 1e3;
/// Multiple of the requested change above which a change comes from the engine and not from errors of the
/// steps. A choice: users request a change near these errors.
const ABOVE: f64 = 3.0;
/// Exponent of the growth of a small deviation in a cycle, below which a steady motion counts as stable. A
/// choice above the rounding of eigenvalues: a deviation takes a thousand cycles for a factor e.
const GROWTH: f64 = 1e-3;
/// Share of a difference that does not follow from the earlier ones, above which it counts as noise; and the
/// number of consecutive cycles with such a share. Choices: a decay leaves nearly nothing, noise nearly all,
/// and a single cycle may leave much by chance.
const UNPREDICTED: f64 = 0.3;
const NOISY_CYCLES: usize = 3;
/// Share of the least change so far, above which the changes of the last cycles no longer shrink. A choice:
/// noise varies by a factor of two.
const STANDSTILL: f64 = 0.5;
/// Least number of cycles after which a motion can count as erratic. A choice: four in each half have a
/// median.
const ERRATIC_CYCLES: usize = 8;
/// Ratio up to which the differences in the second half of the cycles count as equal to those in the first
/// half. A choice: medians of four numbers of chance differ by as much.
const ALIKE: f64 = 2.0;
/// Ratio beyond which a factor contradicts such equality. A choice well above [`ALIKE`].
const UNLIKE: f64 = 5.0;
/// Least number of plain cycles after a leap: two differences show whether the changes shrink.
const PLAIN_CYCLES: usize = 3;
/// Least number of cycles with gradients: derivatives follow a cycle without samples, and then two are compared.
const LEAST_FOR_GRADIENTS: u32 = 3;
/// Most samples of a cycle. A choice: the samples of a cycle are kept in memory.
const MOST_SAMPLES: f64 = 1e6;

/// Summary of a periodic analysis.
#[derive(Clone, Debug, PartialEq)]
pub struct PeriodicSummary {
    /// The run.
    pub run: RunSummary,
    /// Whole cycles.
    pub cycles: u32,
    /// Leaps over the decay of a slow motion.
    pub leaps: u32,
    /// Whether the last cycle repeats the one before within the requested change.
    pub repeats: bool,
    /// The channel that changed most from the last cycle but one to the last.
    pub slowest: Option<Decay>,
    /// The channel of slowest decay while changes were well above the requested one: it shows the engine's
    /// slow mode. Factor and turn are those of the motion.
    pub decay: Option<Decay>,
    /// Factor and turn of the deviations of the motion in the last cycle.
    pub motion: Option<Mode>,
    /// Present if the motion repeats and the slowest channel's change is noise of the steps.
    pub noise: Option<Remedy>,
    /// Whether the differences from cycle to cycle remain equally large, as with impacts. Then the factor of
    /// the last two differences is random and predicts nothing.
    pub erratic: bool,
    /// Channels that grow by the same amount in every cycle. They need not repeat.
    pub growing: Vec<Growth>,
    /// Motion of pins at about half the shaft's speed that does not repeat, by journal; empty after few
    /// cycles.
    pub whirl: Vec<Whirl>,
    /// Present if only the cycle's angle changes in the motion and a small deviation from it grows. Such a
    /// motion repeats only as long as no disturbance occurs.
    pub unstable: Option<Unstable>,
}

/// A setting that would reduce the noise of an output below the requested change.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Remedy {
    /// A factor on the tolerances.
    Tolerance(f64),
    /// A fixed step (s).
    Step(f64),
}

impl Remedy {
    /// `share` is the permitted share of the noise. The local error of a second-order scheme is proportional
    /// to h³ and its global error to h². So errors follow the step to the power 2 and the tolerance to the
    /// power 2/3.
    fn of(step: StepControl, share: f64) -> Remedy {
        match step.fixed() {
            Some(h) => Remedy::Step(h * libm::sqrt(share)),
            None => Remedy::Tolerance(step.tolerance() * libm::pow(share, 1.5)),
        }
    }
}

/// Runs until the cycle repeats, or up to the largest number of cycles. The observer gets the samples of the
/// last cycle. If the run fails, it gets those of the cycle with the failure.
pub fn run_periodic(
    compiled: &Compiled,
    overrides: &[Option<f64>],
    periodic: &Periodic,
    observer: &mut dyn Observer,
) -> Result<PeriodicSummary, RuntimeError> {
    let system = &compiled.system;
    let Some(cycle) = &system.cycle else {
        return Err(RuntimeError::NoCycle);
    };
    let model = Model::bind(compiled, overrides)?;
    let period = model.slot(cycle.period);
    let refuse = |message: String| Err(RuntimeError::Options { message });
    // a whole number of samples does not get one more by rounding
    let samples = libm::ceil(period / periodic.sample - 1e-6);
    if !(periodic.sample > 0.0 && (1.0..=MOST_SAMPLES).contains(&samples)) {
        return refuse(format!(
            "samples {}° apart do not fit a cycle of {}°: state a distance from a millionth of the cycle to the whole cycle",
            short(periodic.sample.to_degrees(), 4),
            short(period.to_degrees(), 6)
        ));
    }
    if !(periodic.change > 0.0 && periodic.change.is_finite()) {
        return refuse(format!(
            "`change` is {}, and must be positive: it is the largest share by which two equal cycles differ, such as 1e-3",
            periodic.change
        ));
    }
    if periodic.cycles < 2 {
        return refuse(format!(
            "`cycles` is {}, and must be at least 2: a cycle repeats the one before",
            periodic.cycles
        ));
    }
    if !periodic.gradients.is_empty() {
        if periodic.cycles < LEAST_FOR_GRADIENTS {
            return refuse(format!(
                "`cycles` is {}, and must be at least {LEAST_FOR_GRADIENTS} with `gradients`: their derivatives repeat behind a first cycle",
                periodic.cycles
            ));
        }
        let parameters = parameters_of(compiled, &periodic.gradients)?;
        Gradients::refuse_early(compiled, overrides, &parameters, &model)?;
    }
    let mut cycles = Cycles::new(&model, periodic, samples as usize, period, observer);
    cycles.wide = Wide::of(periodic, samples).filter(|_| !system.channels.is_empty());
    let transient = Transient {
        duration: Extent::Angle(period * f64::from(periodic.cycles)),
        sample: Extent::Angle(period / samples),
        integration: periodic.integration,
        // they follow the motion that repeats
        gradients: Vec::new(),
        stop: None,
    };
    let mut run = run_by_cycles(compiled, overrides, &transient, &mut cycles, period);
    let failed = matches!(&run, Err(error) if !matches!(error, RuntimeError::Stopped(_)));
    if failed && cycles.wide.is_some() && cycles.begun {
        // the error may be that of the wide steps
        let (warned, observer) = (cycles.warned, cycles.observer);
        cycles = Cycles::new(&model, periodic, samples as usize, period, observer);
        cycles.warned = warned;
        cycles.begun = true;
        run = run_by_cycles(compiled, overrides, &transient, &mut cycles, period);
    }
    let (run, mut onwards) = match run {
        Ok(ran) => ran,
        Err(error) => {
            cycles.give(&[]);
            return Err(error);
        }
    };
    let unstable = if cycles.repeats && cycles.comparison.stands() {
        left_by(&mut onwards.simulation, period)
    } else {
        Ok(None)
    };
    let gradients = match &unstable {
        Ok(_) => cycles.gradients(compiled, overrides, &mut onwards),
        Err(_) => Ok(Vec::new()),
    };
    cycles.give(gradients.as_deref().unwrap_or_default());
    let unstable = unstable?;
    gradients?;
    let (erratic, motion) = (cycles.erratic(), cycles.mode());
    Ok(PeriodicSummary {
        run: RunSummary {
            stopped: None,
            interrupted: false,
            ..run
        },
        cycles: cycles.done,
        leaps: cycles.leapt,
        repeats: cycles.repeats,
        slowest: cycles.slowest,
        decay: cycles.decay,
        motion,
        noise: cycles.noise,
        erratic,
        growing: cycles.growing,
        whirl: whirl::find(cycles.orbits.make_contiguous(), period),
        unstable,
    })
}

/// The fastest growth of a steady motion whose linearised modes grow. If the coefficients are not
/// constant, the result is `None`, because the modes of one moment do not decide about stability.
fn left_by(simulation: &mut Simulation, period: f64) -> Result<Option<Unstable>, RuntimeError> {
    let Some(rate) = simulation.cycle_rate() else {
        return Ok(None);
    };
    let modes = match simulation.sampled_modes(Wanted::default()) {
        Err(
            RuntimeError::Turning { .. }
            | RuntimeError::Unsteady { .. }
            | RuntimeError::OverTime { .. }
            | RuntimeError::Remembers { .. },
        ) => return Ok(None),
        modes => modes?,
    };
    let fastest = modes
        .modes
        .iter()
        .max_by(|a, b| a.value.re.total_cmp(&b.value.re))
        .filter(|mode| mode.value.re * (period / rate).abs() > GROWTH);
    let model = simulation.model();
    Ok(fastest.and_then(|mode| {
        let share = |body: &BodyModel| mode.place.rows(body.velocity, body.width()).norm();
        let body = model
            .bodies
            .iter()
            .max_by(|a, b| share(a).total_cmp(&share(b)))?;
        Some(Unstable {
            origin: body.origin.clone(),
            time: 1.0 / mode.value.re,
        })
    }))
}

/// Samples of a cycle, including both ends.
#[derive(Clone, Debug, Default)]
struct Record {
    /// Time (s), cycle angle (rad) and its rate (rad/s), and energy of each sample.
    heads: Vec<(f64, Option<f64>, Option<f64>, Energy)>,
    values: Vec<f64>,
    orbits: Vec<Vec<[f64; 2]>>,
    poses: Vec<f64>,
    /// Velocities and states.
    motion: Vec<f64>,
    fields: Vec<f64>,
}

impl Record {
    fn push(&mut self, sample: &Sample<'_>) {
        self.heads.push((
            sample.time,
            sample.cycle_angle,
            sample.cycle_rate,
            sample.energy,
        ));
        self.values.extend_from_slice(sample.values);
        self.orbits.push(sample.eccentricities.to_vec());
        self.poses.extend_from_slice(sample.pose);
        self.motion.extend_from_slice(sample.velocity);
        self.motion.extend_from_slice(sample.states);
        self.fields.extend_from_slice(sample.fields);
    }
}

fn section(sample: &Sample<'_>) -> Section {
    Section {
        time: sample.time,
        pose: sample.pose.to_vec(),
        velocity: sample.velocity.to_vec(),
        states: sample.states.to_vec(),
    }
}

fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.get(sorted.len() / 2).copied().unwrap_or(0.0)
}

/// Watches a transient cycle by cycle.
struct Cycles<'a> {
    /// Samples of a cycle with the stated ones, and of the present cycle.
    samples: usize,
    grid: usize,
    channels: usize,
    limit: Periodic,
    comparison: Comparison,
    motion: Motion,
    moved: Moved,
    /// For each cycle the largest change, and the share of it that did not follow from earlier cycles.
    changes: Vec<(f64, f64)>,
    /// For each cycle from the second on: the distance of the motion from the cycle before, in units of the
    /// error that the tolerance leaves.
    differences: Vec<f64>,
    velocities: usize,
    noise: Option<Remedy>,
    now: Record,
    last: Record,
    orbits: VecDeque<whirl::Orbits>,
    /// Clearance of each journal (m).
    clearances: Vec<f64>,
    done: u32,
    repeats: bool,
    slowest: Option<Decay>,
    decay: Option<Decay>,
    /// The factor that the last difference of the slowest channel shows by itself, and whether a cycle in which films settled
    /// is before the cycles that count.
    within: Option<f64>,
    settled: bool,
    growing: Vec<Growth>,
    leaps: Leaps,
    /// Number of leaps.
    leapt: u32,
    /// Whether leaps are of use: no film whirls, and each leap came closer to repetition than cycles without it.
    leaping: bool,
    /// The mode of the motion in the cycles before those that count, and the change of the last one before a leap.
    left: Option<Left>,
    /// Cycles since the last leap.
    since: Option<usize>,
    /// Whether a cycle has just ended.
    ended: bool,
    /// Present in the first cycles, if their tolerance is wider than the stated one.
    wide: Option<Wide>,
    period: f64,
    /// Whether the observer knows the start, and the warnings that it knows. A run that failed with wide steps starts
    /// again.
    begun: bool,
    warned: Vec<Warning>,
    progress: Progress,
    observer: &'a mut dyn Observer,
}

/// What is known of the cycles that are forgotten.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Left {
    /// Mode of the motion.
    mode: Mode,
    /// The change before a leap; infinite without one.
    change: f64,
}

/// Progress towards a number of cycles that is predicted again after each cycle.
#[derive(Clone, Copy, Debug, Default)]
pub struct Progress {
    /// Cycles so far.
    run: f64,
    /// Finished part, 0…1.
    fraction: f64,
}

impl Progress {
    /// The finished part after `run` cycles of `expected` ones. It grows with every step, even if the
    /// prediction rises: a constant part would look like a run without an end, which the watch would stop.
    pub fn advance(&mut self, run: f64, expected: f64) -> f64 {
        let rest = expected - self.run;
        if rest > 0.0 {
            self.fraction += (1.0 - self.fraction) * ((run - self.run) / rest).clamp(0.0, 1.0);
        }
        self.run = run;
        self.fraction
    }
}

/// The cycles that a run may take, of which `done` are finished and `more` are predicted. An output in the noise of the steps
/// misses each prediction, and a run that is finished by the prediction would look like one without an end. So it counts as one
/// that takes one cycle more, and then a quarter of all. The quarter is a choice.
pub fn foreseen(done: u32, more: f64, limit: u32) -> f64 {
    let done = f64::from(done);
    (done + 1.0 + more.max(0.25 * (done + 1.0))).min(f64::from(limit))
}

impl Observer for Cycles<'_> {
    fn started(&mut self, report: &StartReport) {
        if !std::mem::replace(&mut self.begun, true) {
            self.observer.started(report);
        }
    }

    fn stepped(&mut self) {
        self.observer.stepped();
    }

    fn at_start(&mut self, simulation: &mut Simulation) -> Result<Option<[f64; 2]>, RuntimeError> {
        self.begin_wide(simulation)
    }

    fn sample(&mut self, sample: &Sample<'_>) -> ControlFlow<()> {
        self.observer.sampled();
        self.now.push(sample);
        if self.now.heads.len() <= self.grid {
            return ControlFlow::Continue(());
        }
        self.done += 1;
        self.ended = true;
        self.leaps.push(section(sample));
        self.compare();
        self.observer.cycle(&CycleReport {
            cycles: self.done,
            slowest: self.slowest.clone(),
        });
        self.last = std::mem::take(&mut self.now);
        // the end of a cycle is the beginning of the next
        self.now.push(sample);
        if self.repeats {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    }

    fn between_cycles(
        &mut self,
        simulation: &mut Simulation,
    ) -> Result<Option<Renewed>, RuntimeError> {
        let ended = std::mem::take(&mut self.ended);
        if self.wide.is_some_and(|wide| wide.settles) {
            return Ok(self.settle(simulation, ended));
        }
        if !ended {
            return Ok(None);
        }
        if self.wide.is_none() && self.grid < self.samples {
            return Ok(Some(self.with_samples(self.samples)));
        }
        let Some(slowest) = self.slowest.clone() else {
            return Ok(None);
        };
        let far = slowest.change / self.limit.change;
        // a whirl is no decay, and its limit cycle goes round the state to which a leap leads
        let whirls = self.whirls();
        self.leaping &= !whirls;
        if let Some(next) = self.limit_of(&slowest, far, simulation)
            && simulation.leap(&next)?
        {
            self.left = self.moved.mode.map(|mode| Left {
                mode,
                change: slowest.change,
            });
            self.since = Some(0);
            self.leapt += 1;
            self.forget();
            self.now = Record::default();
            return Ok(Some(self.renewed(simulation, true)));
        }
        if self.wide.is_some() && (wide::ends(far, self.done) || whirls) {
            let known = self.moved.mode.filter(|mode| leap::is_known(*mode));
            self.left = known.map(|mode| Left {
                mode,
                change: f64::INFINITY,
            });
            self.forget();
            return Ok(Some(self.renewed(simulation, false)));
        }
        Ok(None)
    }

    fn progress(&mut self, advance: &Advance) -> Verdict {
        let share = match self.limit.gradients.is_empty() {
            true => 1.0,
            false => gradients::OF_MOTION,
        };
        let run = advance.fraction * f64::from(self.limit.cycles);
        let expected = match &self.slowest {
            Some(Decay {
                change,
                mode: Some(mode),
                ..
            }) if mode.factor > 0.0 && mode.factor < 1.0 => foreseen(
                self.done,
                mode.cycles(change / self.limit.change),
                self.limit.cycles,
            ),
            _ => f64::from(self.limit.cycles),
        };
        self.observer.progress(&Advance {
            fraction: share * self.progress.advance(run, expected),
            ..*advance
        })
    }

    fn short_steps(&mut self, slow: &Slow) {
        self.observer.short_steps(slow);
    }

    fn warning(&mut self, warning: &Warning) {
        let same = |known: &Warning| {
            (&known.name, &known.origin, &known.message)
                == (&warning.name, &warning.origin, &warning.message)
        };
        if !self.warned.iter().any(same) {
            self.warned.push(warning.clone());
            self.observer.warning(warning);
        }
    }
}

impl<'a> Cycles<'a> {
    fn new(
        model: &Model,
        periodic: &Periodic,
        samples: usize,
        period: f64,
        observer: &'a mut dyn Observer,
    ) -> Cycles<'a> {
        Cycles {
            samples,
            grid: samples,
            channels: model.compiled.system.channels.len(),
            limit: periodic.clone(),
            comparison: Comparison::new(
                &model.compiled.system,
                TOLERANCES * model.tolerance,
                [model.mass, model.length, 0.0],
            ),
            motion: Motion::new(
                model,
                // the tolerance of a fixed step limits Newton's iteration and not the error of the step
                match periodic.integration.step {
                    StepControl::Tolerance(factor) => factor,
                    StepControl::Fixed(_) | StepControl::FixedTo { .. } => 1.0,
                },
            ),
            moved: Moved::default(),
            changes: Vec::new(),
            differences: Vec::new(),
            velocities: model.velocities,
            noise: None,
            now: Record::default(),
            last: Record::default(),
            orbits: VecDeque::new(),
            clearances: (model.compiled.system.journals.iter())
                .map(|journal| model.slot(journal.clearance))
                .collect(),
            done: 0,
            repeats: false,
            slowest: None,
            decay: None,
            within: None,
            settled: false,
            growing: Vec::new(),
            leaps: Leaps::default(),
            leapt: 0,
            leaping: true,
            left: None,
            since: None,
            ended: false,
            wide: None,
            period,
            begun: false,
            warned: Vec::new(),
            progress: Progress::default(),
            observer,
        }
    }
}

impl Cycles<'_> {
    fn compare(&mut self) {
        let now = &self.now.values[self.channels..];
        if let Some(pace) = self.now.heads.first().and_then(|head| head.2) {
            self.comparison.goes_at(pace.abs());
        }
        let verdict = self.comparison.next(now);
        self.slowest = verdict.slowest;
        self.within = verdict.within;
        self.growing = verdict.growing;
        if let (Some(slowest), Some(left)) = (&mut self.slowest, self.left) {
            slowest.mode = slowest.mode.or(Some(left.mode));
            // channels that grow are known from the third cycle on
            if self.since.is_some_and(|cycles| cycles + 1 == PLAIN_CYCLES) {
                let otherwise = libm::pow(left.mode.factor, PLAIN_CYCLES as f64);
                self.leaping &= slowest.change < left.change * otherwise;
            }
        }
        self.since = self.since.map(|cycles| cycles + 1);
        let width = self.now.motion.len() / self.now.heads.len().max(1);
        let pose_width = self.now.poses.len() / self.now.heads.len().max(1);
        self.moved = self
            .motion
            .next(&self.now.poses[pose_width..], &self.now.motion[width..]);
        if self.done > 1 {
            self.differences.push(self.moved.beyond);
        }
        if let Some(now) = &self.slowest
            && now.mode.is_some()
            && (now.change > ABOVE * self.limit.change || self.decay.is_none())
        {
            self.decay = Some(Decay {
                mode: self.mode().or(now.mode),
                ..now.clone()
            });
        }
        self.repeats = self.wide.is_none()
            && match &self.slowest {
                Some(decay) => {
                    (decay.change <= PLAIN * self.limit.change && !decay.grows())
                        || (decay.change <= self.limit.change
                            && self.distance(decay) <= self.limit.change
                            && self.since.is_none_or(|cycles| cycles >= PLAIN_CYCLES))
                }
                // a model without channels has nothing to compare
                None => self.channels == 0 && self.done > 1,
            };
        if self.wide.is_none() && !self.repeats && self.only_noise() {
            self.repeats = true;
            let change = self.slowest.as_ref().map_or(0.0, |s| s.change);
            self.noise = Some(Remedy::of(
                self.limit.integration.step,
                self.limit.change / change,
            ));
        }
        let angles: Vec<f64> = self.now.heads[1..]
            .iter()
            .map(|h| h.1.unwrap_or(0.0))
            .collect();
        let forward = angles.last() >= angles.first();
        self.orbits.push_back(whirl::Orbits {
            angles,
            forward,
            eccentricities: self.now.orbits[1..].to_vec(),
        });
        if self.orbits.len() > ORBITS {
            self.orbits.pop_front();
        }
    }

    /// Mode of the motion. Until three differences show a turn, it is that of the cycles before a leap or with wider
    /// steps: the factor of two differences may be random.
    fn mode(&self) -> Option<Mode> {
        let left = self.left.filter(|_| !self.moved.turns);
        left.map(|left| left.mode).or(self.moved.mode)
    }

    /// Estimated distance to the limit. Until three differences show a mode, the motion that a leap left out may decay as
    /// slowly as before, at worst without a turn: then its future differences sum up to `f/(1 − f)`.
    fn distance(&self, decay: &Decay) -> f64 {
        if decay.mode.is_none() && self.settled {
            let shown = self.within.zip(self.moved.within);
            let factor = shown.map_or(1.0, |(channel, motion)| channel.max(motion));
            let moved = self.moved.beyond * self.motion.share_of_clearance();
            return distance_of_two(decay.change, factor, moved);
        }
        let left = self.left.filter(|_| !self.moved.turns);
        let before = left.map_or(0.0, |left| {
            decay.change * left.mode.factor / (1.0 - left.mode.factor)
        });
        decay.distance().max(before)
    }

    /// The state to which to leap, if a leap is of use.
    fn limit_of(&self, slowest: &Decay, far: f64, simulation: &Simulation) -> Option<Section> {
        let saves = |mode: Option<Mode>| mode.is_some_and(|mode| leap::saves(mode, far));
        let fit = self.moved.fit.filter(|fit| {
            self.leaping && self.moved.turns && leap::saves(fit.mode, far) && saves(slowest.mode)
        })?;
        // the cycles after a leap decide whether the motion repeats
        if self.done + PLAIN_CYCLES as u32 > self.limit.cycles {
            return None;
        }
        self.leaps.next(simulation.model(), &fit)
    }

    /// Whether the orbit of a journal shows a sustained whirl in the cycles that count.
    fn whirls(&mut self) -> bool {
        let found = whirl::find(self.orbits.make_contiguous(), self.period);
        let seen = |whirl: &whirl::Whirl| {
            let clearance = self.clearances.get(whirl.journal);
            whirl.is_sustained() && clearance.is_some_and(|clearance| whirl.is_seen(*clearance))
        };
        found.iter().any(seen)
    }

    /// Forgets the cycles that do not count.
    fn forget(&mut self) {
        self.comparison.forget();
        self.motion.forget();
        self.leaps.forget();
        self.moved = Moved::default();
        self.changes.clear();
        self.differences.clear();
        self.orbits.clear();
    }

    /// Whether the motion repeats within the tolerance of its steps, now and by its own estimate, while the
    /// change of an output neither shrinks nor follows from earlier cycles.
    fn only_noise(&mut self) -> bool {
        let Some(slowest) = &self.slowest else {
            return false;
        };
        self.changes
            .push((slowest.change, slowest.mode.map_or(0.0, |m| m.unpredicted)));
        let (earlier, last) = self
            .changes
            .split_at(self.changes.len().saturating_sub(NOISY_CYCLES));
        let least = |of: &[(f64, f64)]| of.iter().fold(f64::INFINITY, |w, x| w.min(x.0));
        !earlier.is_empty()
            && last.iter().all(|(_, share)| *share > UNPREDICTED)
            && least(last) > STANDSTILL * least(earlier)
            && self.moved.repeats(UNPREDICTED)
    }

    /// Whether the motion differs between cycles of the second half as much as between those of the first,
    /// although the factor of its last two differences predicts much less or more. Then this factor is
    /// random.
    fn erratic(&self) -> bool {
        let (earlier, later) = self.differences.split_at(self.differences.len() / 2);
        let enough = !self.repeats && self.differences.len() >= ERRATIC_CYCLES;
        let Some(mode) = self.moved.mode.filter(|_| enough) else {
            return false;
        };
        let measured = median(later) / median(earlier);
        let claimed = libm::pow(mode.factor, later.len() as f64);
        let far = |ratio: f64, most: f64| ratio < 1.0 / most || ratio > most;
        // a difference within the tolerance is noise of the steps
        median(later) > 1.0 && !far(measured, ALIKE) && far(claimed, UNLIKE)
    }

    /// The derivatives that the analysis asks for, at the samples of the last cycle.
    fn gradients(
        &mut self,
        compiled: &Compiled,
        overrides: &[Option<f64>],
        onwards: &mut Onwards,
    ) -> Result<Rows, RuntimeError> {
        if self.limit.gradients.is_empty() {
            return Ok(Vec::new());
        }
        if !self.repeats {
            return Err(RuntimeError::Options {
                message: format!(
                    "the motion does not repeat within {} cycles, so it has no gradients: state larger `cycles`, or compare two runs",
                    self.done
                ),
            });
        }
        let repeated = Repeated {
            compiled,
            limit: &self.limit,
            period: self.period,
            samples: self.samples,
            values: &self.last.values,
            growing: &self.growing,
            moving: self.moving(),
            length: TOLERANCES * onwards.simulation.model().tolerance,
        };
        repeated.gradients(overrides, onwards, self.observer)
    }

    /// The states that differ between the beginning and the end of the last cycle, by more than the requested change of their
    /// swing.
    fn moving(&self) -> Vec<bool> {
        let samples = self.last.heads.len();
        let width = self.last.motion.len() / samples.max(1);
        let of = |index: usize| {
            let mut values = self.last.motion.iter().skip(index).step_by(width);
            let first = *values.next()?;
            let extremes = values.fold((first, first, first), |(low, high, _), x| {
                (x.min(low), x.max(high), *x)
            });
            Some((first, extremes))
        };
        (self.velocities..width)
            .map(|index| {
                let moves = of(index).map(|(first, (low, high, last))| {
                    (last - first).abs() > self.limit.change * (high - low)
                });
                moves.unwrap_or(false)
            })
            .collect()
    }

    /// Gives the last whole cycle to the observer, with the derivatives at its samples. If the run ended within a cycle, it
    /// gives that part.
    fn give(&mut self, gradients: &[Vec<Row>]) {
        let whole = self.now.heads.len() <= 1 && !self.last.heads.is_empty();
        let record = if whole { &self.last } else { &self.now };
        let width = record.poses.len() / record.heads.len().max(1);
        let motion = record.motion.len() / record.heads.len().max(1);
        let fields = record.fields.len() / record.heads.len().max(1);
        for (i, (time, cycle_angle, cycle_rate, energy)) in record.heads.iter().enumerate() {
            let flow = self.observer.sample(&Sample {
                time: *time,
                cycle_angle: *cycle_angle,
                cycle_rate: *cycle_rate,
                values: &record.values[i * self.channels..(i + 1) * self.channels],
                energy: *energy,
                eccentricities: &record.orbits[i],
                pose: &record.poses[i * width..(i + 1) * width],
                velocity: &record.motion[i * motion..i * motion + self.velocities],
                states: &record.motion[i * motion + self.velocities..(i + 1) * motion],
                fields: &record.fields[i * fields..(i + 1) * fields],
            });
            if flow.is_break() {
                return;
            }
            for (parameter, rows) in gradients.iter().enumerate() {
                if let Some(row) = rows.get(i) {
                    self.observer.gradient(parameter, row.sample());
                }
            }
        }
    }
}
