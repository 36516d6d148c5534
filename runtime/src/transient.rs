//! A transient from start to end, with samples on a grid of time or cycle angle.

mod onwards;
mod renewal;

use crate::decay::CycleReport;
use crate::error::{Moment, RuntimeError};
use crate::integrator::{Damped, Statistics};
use crate::kinks::Overlooked;
use crate::simulation::{
    Energy, Gradients, Options, SampleGradient, Simulation, Slow, Stopped, Warning,
};
use crate::start::StartReport;
use eng_system::analysis::{Kind, Named, Names};
use eng_system::code::Compiled;
use eng_system::significant::short;
use eng_system::system::{Extent, StepControl, Transient};
pub(crate) use onwards::Onwards;
use renewal::Renewal;
use std::ops::ControlFlow;

/// One sample.
#[derive(Clone, Copy, Debug)]
pub struct Sample<'a> {
    /// Time (s).
    pub time: f64,
    /// Unwrapped cycle angle (rad), if there is a cycle.
    pub cycle_angle: Option<f64>,
    /// Its rate (rad/s).
    pub cycle_rate: Option<f64>,
    /// Channels (SI).
    pub values: &'a [f64],
    /// Energy at the sample.
    pub energy: Energy,
    /// e of every journal (m): the pin's origin from the shell's, along the shell's x and y.
    pub eccentricities: &'a [[f64; 2]],
    /// For each body in the order of the system: r (m), unit quaternion w, x, y, z from body to ground axes,
    /// modal amplitudes.
    pub pose: &'a [f64],
    /// For each body ṙ (m/s), ω (rad/s, body axes), modal rates.
    pub velocity: &'a [f64],
    /// States of elements (SI).
    pub states: &'a [f64],
    /// For each element with fields and outputs, in the order of the system, and for each of its fields: the
    /// drives (SI), the time since the beginning of the step (s; zero for a field in balance), and the memory
    /// at that beginning. A solver of the field's kernel gives the field at the sample with them.
    pub fields: &'a [f64],
}

/// The progress of a run after a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Advance {
    /// Finished part of the run, 0…1.
    pub fraction: f64,
    /// Time (s).
    pub time: f64,
    /// Unwrapped cycle angle (rad), if the model has a cycle.
    pub cycle_angle: Option<f64>,
    /// Steps since the start.
    pub steps: u64,
}

impl Advance {
    /// The progress of a simulation that has finished a part of its run.
    pub(crate) fn new(simulation: &Simulation, fraction: f64) -> Advance {
        Advance {
            fraction: fraction.clamp(0.0, 1.0),
            time: simulation.time(),
            cycle_angle: simulation.cycle_angle(),
            steps: simulation.statistics().steps,
        }
    }
}

/// The decision of an observer after a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Continue the run.
    GoOn,
    /// Call [`Observer::short_steps`] with the cause of the short steps, then continue the run.
    Explain,
    /// End the run with [`RuntimeError::Stopped`].
    Stop,
}

/// The changes at the end of a cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Renewed {
    /// Factor on the first step of a cycle.
    pub first_step: f64,
    /// Distance of the samples (rad), positive.
    pub sample: f64,
    /// Largest step, as an angle of the cycle (rad), positive.
    pub longest: f64,
    /// Whether the state has changed. Then the observer gets a sample there.
    pub leapt: bool,
}

/// Receives the samples and the progress of a run.
pub trait Observer {
    /// Takes the report on the start, once, before the first sample.
    fn started(&mut self, _report: &StartReport) {}
    /// Called at the end of every step, before its samples.
    fn stepped(&mut self) {}
    /// Called after every sample of a cycle that a periodic analysis compares with others. The analysis gives
    /// only the samples of its last cycle.
    fn sampled(&mut self) {}
    /// Takes a sample; `Break` ends the run after it.
    fn sample(&mut self, sample: &Sample<'_>) -> ControlFlow<()>;
    /// Takes the derivatives by one of the parameters of [`Transient::gradients`], in their order, at the sample that it took
    /// last.
    fn gradient(&mut self, _parameter: usize, _sample: SampleGradient<'_>) {}
    /// Called after every step. No verdict changes a bit of the results.
    fn progress(&mut self, _advance: &Advance) -> Verdict {
        Verdict::GoOn
    }
    /// Takes the cause of short steps, after [`Verdict::Explain`].
    fn short_steps(&mut self, _slow: &Slow) {}
    /// Takes a failed `advise`, each once.
    fn warning(&mut self, _warning: &Warning) {}
    /// Called at the start of a run by cycles. It may change the steps. Returns the distance of the samples and the largest
    /// step, as an angle of the cycle (rad), positive, if they differ from the stated ones.
    fn at_start(&mut self, _simulation: &mut Simulation) -> Result<Option<[f64; 2]>, RuntimeError> {
        Ok(None)
    }
    /// Called after every step of a run by cycles. It may change the steps of the simulation or its state.
    fn between_cycles(
        &mut self,
        _simulation: &mut Simulation,
    ) -> Result<Option<Renewed>, RuntimeError> {
        Ok(None)
    }
    /// Called after every whole cycle of a periodic analysis.
    fn cycle(&mut self, _cycle: &CycleReport) {}
    /// Whether the observer wants a checkpoint after this step.
    fn wants_checkpoint(&mut self) -> bool {
        false
    }
    /// Takes a checkpoint.
    fn checkpoint(&mut self, _bytes: Vec<u8>) {}
}

/// Summary of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct RunSummary {
    /// Time of the last sample (s).
    pub time: f64,
    /// Cycle angle of the last accepted state (rad).
    pub cycle_angle: Option<f64>,
    /// Number of samples given to the observer.
    pub samples: u64,
    /// Counts of steps, iterations and factorisations.
    pub statistics: Statistics,
    /// Energy at the end.
    pub energy: Energy,
    /// The body whose vibration the steps damped away.
    pub damped: Option<Damped>,
    /// The kink that a fixed step overlooked most.
    pub overlooked: Option<Overlooked>,
    /// The condition that ended the run early.
    pub stopped: Option<Stopped>,
    /// Whether the observer ended the run.
    pub interrupted: bool,
}

/// Steps without progress of the cycle after which a run by angle gives up. A choice: a cycle that waits some
/// seconds for its start takes fewer.
pub(crate) const PATIENCE: u64 = 200_000;
/// Share of the sample distance below which a grid point is the end itself. A choice: above the rounding of
/// sums of distances, and far below a distance that a figure shows.
const SAME: f64 = 1e-6;

/// Points of time or angle in their order.
#[derive(Clone, Copy, Debug)]
enum Points {
    Time { distance: f64 },
    Angle { start: f64, distance: f64 },
}

impl Points {
    fn at(self, index: u64) -> f64 {
        match self {
            Points::Time { distance } => index as f64 * distance,
            Points::Angle { start, distance } => start + index as f64 * distance,
        }
    }

    fn distance(self) -> f64 {
        match self {
            Points::Time { distance } | Points::Angle { distance, .. } => distance,
        }
    }

    /// The longest time between two evaluations of the equations at the present speed of the cycle (s), for the longest
    /// distance in the unit of the points. This is the distance of samples, so that the run sees every load that is as long.
    fn longest_step(self, longest: f64, simulation: &Simulation) -> f64 {
        match self {
            Points::Time { .. } => longest,
            Points::Angle { .. } => {
                let rate = simulation.cycle_rate().unwrap_or(0.0).abs();
                if rate > 0.0 {
                    longest / rate
                } else {
                    f64::INFINITY
                }
            }
        }
    }

    /// Distance of a simulation beyond the point, in the point's unit; negative before the point.
    fn passed(self, index: u64, simulation: &Simulation) -> f64 {
        match self {
            Points::Time { .. } => simulation.time() - self.at(index),
            Points::Angle { distance, .. } => {
                let angle = simulation.cycle_angle().unwrap_or(0.0);
                (angle - self.at(index)) * distance.signum()
            }
        }
    }
}

/// Most steps or samples of a run. Double precision still resolves a thousandth of so short a step at the end
/// of the run.
const MOST: f64 = 1e12;

/// Refuses an analysis with too many samples or steps, or without a positive length.
///
/// # Errors
/// A length or distance that is not positive, steps or samples of less than 10⁻¹² of the run.
pub fn countable(kind: &dyn Kind) -> Result<(), RuntimeError> {
    let Some((sample, duration)) = kind.sampling() else {
        return Ok(());
    };
    let refuse = |message: String| Err(RuntimeError::Options { message });
    let named = [(duration, "duration"), (Some(sample), "sampling interval")];
    for (extent, name) in named {
        let Some(Extent::Time(x) | Extent::Angle(x)) = extent else {
            continue;
        };
        if !(x > 0.0 && x.is_finite()) {
            return refuse(format!("the {name} is {x}; it must be positive"));
        }
    }
    let too_many = |part: f64, whole: f64, name: &str, unit: &str| {
        refuse(format!(
            "{name} of {} {unit} would be {} in a run of {whole} {unit}, more than Eng counts: state at least {} {unit}",
            short(part, 4),
            short(whole / part, 2),
            short(whole / MOST, 4)
        ))
    };
    match (duration, sample) {
        (Some(Extent::Time(whole)), Extent::Time(part)) if whole > MOST * part => {
            return too_many(part, whole, "samples", "s");
        }
        (Some(Extent::Angle(whole)), Extent::Angle(part)) if whole > MOST * part => {
            let [part, whole] = [part, whole].map(f64::to_degrees);
            return too_many(part, whole, "samples", "°");
        }
        _ => {}
    }
    match (duration, kind.step()) {
        (
            Some(Extent::Time(whole)),
            Some(StepControl::Fixed(part) | StepControl::FixedTo { step: part, .. }),
        ) if part > 0.0 && whole > MOST * part => too_many(part, whole, "steps", "s"),
        _ => Ok(()),
    }
}

/// Runs a transient, or continues it from a checkpoint of the same analysis.
pub fn run_transient(
    compiled: &Compiled,
    overrides: &[Option<f64>],
    transient: &Transient,
    observer: &mut dyn Observer,
    resume: Option<&[u8]>,
) -> Result<RunSummary, RuntimeError> {
    run(compiled, overrides, transient, observer, resume, None).map(|ran| ran.summary)
}

/// Runs a transient whose sequence of steps starts again with each cycle of a period (rad). If the
/// motion repeats, the steps and their errors repeat too. Returns the motion behind the last sample, too.
pub(crate) fn run_by_cycles(
    compiled: &Compiled,
    overrides: &[Option<f64>],
    transient: &Transient,
    observer: &mut dyn Observer,
    period: f64,
) -> Result<(RunSummary, Onwards), RuntimeError> {
    let ran = run(compiled, overrides, transient, observer, None, Some(period))?;
    let start = ran.simulation.cycle_start();
    let sense = ran.points.distance().signum();
    let renewal = (ran.renewal).unwrap_or_else(|| Renewal::new(start, sense * period));
    let onwards = Onwards::new(ran.simulation, renewal, ran.points.distance(), ran.longest);
    Ok((ran.summary, onwards))
}

/// A run at its end.
struct Ran {
    summary: RunSummary,
    simulation: Simulation,
    renewal: Option<Renewal>,
    points: Points,
    longest: f64,
}

/// The simulation at its start or at a checkpoint, and the sense in which its cycle turns.
fn begin(
    compiled: &Compiled,
    overrides: &[Option<f64>],
    transient: &Transient,
    resume: Option<&[u8]>,
) -> Result<(Simulation, f64), RuntimeError> {
    countable(transient)?;
    let options = Options::from(transient.integration);
    let mut simulation = match resume {
        Some(bytes) => Simulation::resume(compiled, overrides, options, bytes)?,
        None => Simulation::new(compiled, overrides, options)?,
    };
    let ends_by_angle = matches!(transient.duration, Extent::Angle(_));
    let by_angle = ends_by_angle || matches!(transient.sample, Extent::Angle(_));
    if by_angle && simulation.cycle_angle().is_none() {
        return Err(RuntimeError::NoCycle);
    }
    let start = simulation.cycle_start();
    if resume.is_none() && ends_by_angle && simulation.cycle_stands()? {
        return Err(RuntimeError::CycleStands {
            moment: Moment {
                time: simulation.time(),
                cycle_angle: Some(start),
            },
            angle: start,
        });
    }
    let turned = simulation.cycle_angle().unwrap_or(start) - start;
    let sense = if turned != 0.0 {
        turned.signum()
    } else if simulation.cycle_rate().unwrap_or(1.0) < 0.0 {
        -1.0
    } else {
        1.0
    };
    Ok((simulation, sense))
}

/// The derivatives that a transient asks for, beside its simulation at the start.
fn gradients(
    compiled: &Compiled,
    overrides: &[Option<f64>],
    transient: &Transient,
    simulation: &Simulation,
    resumes: bool,
) -> Result<Option<Gradients>, RuntimeError> {
    if transient.gradients.is_empty() {
        return Ok(None);
    }
    let refuse = |message: String| Err(RuntimeError::Options { message });
    if resumes {
        return refuse(
            "a checkpoint has no gradients, so a run with gradients cannot be resumed: start it again".into(),
        );
    }
    let parameters = parameters_of(compiled, &transient.gradients)?;
    Gradients::new(compiled, overrides, &parameters, simulation).map(Some)
}

/// The indices of the parameters that `gradients` of an analysis name.
pub(crate) fn parameters_of(
    compiled: &Compiled,
    gradients: &[Named],
) -> Result<Vec<usize>, RuntimeError> {
    let paths = compiled.system.paths_of(Names::Parameters);
    let found = Names::Parameters.indices(gradients, &paths);
    found.map_err(|_| RuntimeError::Options {
        message: "a path of `gradients` names no parameter, or the same one as another path".into(),
    })
}

/// The progress of a run towards its end.
struct Way {
    duration: Extent,
    start: f64,
    sense: f64,
    /// The farthest angle so far (rad), and the number of steps since then.
    farthest: f64,
    standing: u64,
}

impl Way {
    /// The time of the end (s), if it lies in the last step, and the finished share of the run.
    fn end(&mut self, simulation: &mut Simulation) -> Result<(Option<f64>, f64), RuntimeError> {
        let duration = match self.duration {
            Extent::Time(duration) => {
                let done = simulation.time();
                return Ok(((done >= duration).then_some(duration), done / duration));
            }
            Extent::Angle(duration) => duration,
        };
        let done = (simulation.cycle_angle().unwrap_or(self.start) - self.start) * self.sense;
        // progress of less than a billionth of a radian is rounding
        if done > self.farthest + 1e-9 {
            self.farthest = done;
            self.standing = 0;
        } else {
            self.standing += 1;
            if self.standing > PATIENCE {
                return Err(RuntimeError::CycleStands {
                    moment: Moment {
                        time: simulation.time(),
                        cycle_angle: simulation.cycle_angle(),
                    },
                    angle: self.start + self.sense * self.farthest,
                });
            }
        }
        let end = if done >= duration {
            Some(simulation.locate_angle(self.start + self.sense * duration)?)
        } else {
            None
        };
        Ok((end, done / duration))
    }
}

fn run(
    compiled: &Compiled,
    overrides: &[Option<f64>],
    transient: &Transient,
    observer: &mut dyn Observer,
    resume: Option<&[u8]>,
    period: Option<f64>,
) -> Result<Ran, RuntimeError> {
    // The samples follow the sense in which the machine turns.
    let (mut simulation, sense) = begin(compiled, overrides, transient, resume)?;
    let start = simulation.cycle_start();
    let points = match transient.sample {
        Extent::Time(distance) => Points::Time { distance },
        Extent::Angle(distance) => Points::Angle {
            start,
            distance: sense * distance,
        },
    };
    let mut run = Run {
        values: vec![0.0; simulation.model().compiled.system.channels.len()],
        gradients: gradients(
            compiled,
            overrides,
            transient,
            &simulation,
            resume.is_some(),
        )?,
        observer,
        points,
        longest: points.distance().abs(),
        next: 1,
        samples: 0,
        last: f64::NAN,
        stopped: None,
    };
    run.observer.started(simulation.start());
    if period.is_some() {
        run.begin_cycles(&mut simulation)?;
    }
    if resume.is_none() {
        simulation.evaluate_channels(&mut run.values)?;
        let cycle = simulation.cycle_angle().zip(simulation.cycle_rate());
        run.give_warnings(&mut simulation);
        let time = simulation.time();
        if run.give(&mut simulation, time, cycle, None)?.is_break() {
            return Ok(run.end(simulation, None, true));
        }
    } else {
        // The earlier run gave the points up to the checkpoint.
        while points.passed(run.next, &simulation) >= 0.0 {
            run.next += 1;
        }
    }

    let mut renewal = period.map(|period| Renewal::new(start, sense * period));
    let mut way = Way {
        duration: transient.duration,
        start,
        sense,
        farthest: f64::NEG_INFINITY,
        standing: 0,
    };
    let limit = match transient.duration {
        Extent::Time(duration) => duration,
        Extent::Angle(_) => f64::INFINITY,
    };
    loop {
        if simulation.time() < limit {
            let end = renewal
                .as_mut()
                .map_or(limit, |renewal| renewal.end(&simulation).min(limit));
            let longest = run.points.longest_step(run.longest, &simulation);
            let step = simulation.step_no_longer(end, longest)?.step;
            if let Some(gradients) = run.gradients.as_mut().filter(|_| step > 0.0) {
                gradients.follow(&mut simulation, step)?;
            }
            if let Some(renewal) = &mut renewal {
                renewal.after(&mut simulation, step);
            }
        }
        run.observer.stepped();
        run.give_warnings(&mut simulation);
        let (end, fraction) = way.end(&mut simulation)?;
        let stop = simulation.stop_time()?;
        let stop = stop.filter(|stop| end.is_none_or(|end| *stop < end));
        let end = stop.or(end);
        if run.give_passed(&mut simulation, end)?.is_break() {
            return Ok(run.end(simulation, renewal, true));
        }
        if let Some(renewal) = renewal.as_mut().filter(|_| end.is_none()) {
            run.renew(&mut simulation, renewal)?;
        }
        let advance = Advance::new(&simulation, fraction);
        follow(&simulation, run.observer, &advance, end.is_some())?;
        if let Some(end) = end {
            let (end, cycle, angle) = match transient.duration {
                _ if stop.is_some() => {
                    let cycle = simulation.sample_at(end, &mut run.values)?;
                    run.stopped = simulation.stopped_within(end)?;
                    (end, cycle, None)
                }
                Extent::Time(_) => (end, simulation.sample_at(end, &mut run.values)?, None),
                Extent::Angle(duration) => {
                    let angle = start + sense * duration;
                    let (time, cycle) = simulation.sample_at_angle(angle, &mut run.values)?;
                    (time, Some(cycle), Some(angle))
                }
            };
            // the run ends here anyway, so the observer's decision to stop makes no difference
            let _ = run.give(&mut simulation, end, cycle.map(|c| (c[0], c[1])), angle)?;
            return Ok(run.end(simulation, renewal, false));
        }
        if run.observer.wants_checkpoint() {
            let bytes = simulation.checkpoint();
            run.observer.checkpoint(bytes);
        }
    }
}

/// Reports the progress to an observer and follows its verdict. A run at its end is not stopped.
pub(crate) fn follow(
    simulation: &Simulation,
    observer: &mut dyn Observer,
    advance: &Advance,
    ends: bool,
) -> Result<(), RuntimeError> {
    match observer.progress(advance) {
        Verdict::Explain => observer.short_steps(&simulation.slow()),
        Verdict::Stop if !ends => return Err(RuntimeError::Stopped(simulation.slow())),
        Verdict::GoOn | Verdict::Stop => {}
    }
    Ok(())
}

struct Run<'a> {
    values: Vec<f64>,
    /// The derivatives by parameters, and their number.
    gradients: Option<Gradients>,
    observer: &'a mut dyn Observer,
    points: Points,
    /// Longest distance of a step, in the unit of the points.
    longest: f64,
    /// The next point.
    next: u64,
    samples: u64,
    last: f64,
    stopped: Option<Stopped>,
}

impl Run<'_> {
    /// Lets the observer change steps and samples at the start of a run by cycles.
    fn begin_cycles(&mut self, simulation: &mut Simulation) -> Result<(), RuntimeError> {
        let changed = self.observer.at_start(simulation)?;
        if let (Points::Angle { distance, .. }, Some([sample, longest])) =
            (&mut self.points, changed)
        {
            *distance = sample.copysign(*distance);
            self.longest = longest;
        }
        Ok(())
    }

    /// Lets the observer change steps, samples or state at the end of a cycle.
    fn renew(
        &mut self,
        simulation: &mut Simulation,
        renewal: &mut Renewal,
    ) -> Result<(), RuntimeError> {
        let Some(renewed) = self.observer.between_cycles(simulation)? else {
            return Ok(());
        };
        renewal.again(simulation, renewed.first_step);
        self.points = Points::Angle {
            start: renewal.begin(),
            distance: renewed.sample.copysign(self.points.distance()),
        };
        self.longest = renewed.longest;
        self.next = 1;
        if renewed.leapt {
            simulation.evaluate_channels(&mut self.values)?;
            let cycle = simulation.cycle_angle().zip(simulation.cycle_rate());
            let time = simulation.time();
            // no cycle ends with the sample at its beginning
            let _ = self.give(simulation, time, cycle, None)?;
        }
        Ok(())
    }

    /// Gives the samples inside the last step. A sample at the end of the run is left out, because the caller
    /// takes it exactly there.
    fn give_passed(
        &mut self,
        simulation: &mut Simulation,
        end: Option<f64>,
    ) -> Result<ControlFlow<()>, RuntimeError> {
        let points = self.points;
        while points.passed(self.next, simulation) >= 0.0 {
            let time = match points {
                Points::Time { .. } => points.at(self.next),
                Points::Angle { .. } => simulation.locate_angle(points.at(self.next))?,
            };
            if let Some(end) = end {
                let near = match points {
                    Points::Time { distance } => SAME * distance,
                    Points::Angle { .. } => {
                        // a cycle at rest: its time to the end must stay a number
                        let rate = simulation.cycle_rate().unwrap_or(0.0).abs().max(1e-12);
                        SAME * points.distance().abs() / rate
                    }
                };
                if time >= end - near {
                    break;
                }
            }
            let (time, cycle, angle) = match points {
                Points::Time { .. } => (time, simulation.sample_at(time, &mut self.values)?, None),
                Points::Angle { .. } => {
                    let angle = points.at(self.next);
                    let (time, cycle) = simulation.sample_at_angle(angle, &mut self.values)?;
                    (time, Some(cycle), Some(angle))
                }
            };
            self.next += 1;
            if self
                .give(simulation, time, cycle.map(|c| (c[0], c[1])), angle)?
                .is_break()
            {
                return Ok(ControlFlow::Break(()));
            }
        }
        Ok(ControlFlow::Continue(()))
    }

    /// Gives a sample, and the derivatives there; at a cycle angle, if the sample lies at one.
    fn give(
        &mut self,
        simulation: &mut Simulation,
        time: f64,
        cycle: Option<(f64, f64)>,
        angle: Option<f64>,
    ) -> Result<ControlFlow<()>, RuntimeError> {
        self.samples += 1;
        self.last = time;
        let taken = self.observer.sample(&Sample {
            time,
            cycle_angle: cycle.map(|c| c.0),
            cycle_rate: cycle.map(|c| c.1),
            values: &self.values,
            energy: simulation.sampled_energy(),
            eccentricities: &simulation.eccentricities(),
            pose: simulation.sampled_pose(),
            velocity: &simulation.sampled_state().velocity,
            states: &simulation.sampled_state().states,
            fields: &simulation.sampled_fields(),
        });
        if let Some(gradients) = &mut self.gradients {
            let observer = &mut self.observer;
            gradients.sample(simulation, angle, &mut |parameter, sample| {
                observer.gradient(parameter, sample);
            })?;
        }
        Ok(taken)
    }

    fn end(self, simulation: Simulation, renewal: Option<Renewal>, interrupted: bool) -> Ran {
        Ran {
            summary: self.summary(&simulation, interrupted),
            simulation,
            renewal,
            points: self.points,
            longest: self.longest,
        }
    }

    fn give_warnings(&mut self, simulation: &mut Simulation) {
        for warning in simulation.take_warnings() {
            self.observer.warning(&warning);
        }
    }

    fn summary(&self, simulation: &Simulation, interrupted: bool) -> RunSummary {
        RunSummary {
            time: self.last,
            cycle_angle: simulation.cycle_angle(),
            samples: self.samples,
            statistics: simulation.statistics(),
            energy: simulation.energy(),
            damped: simulation.damped(),
            overlooked: simulation.overlooked().cloned(),
            stopped: self.stopped.clone(),
            interrupted,
        }
    }
}
