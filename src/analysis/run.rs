//! Runs of analyses: the solution of each kind, and its records.

use super::gradients::GradientColumns;
use super::motion::Motion;
use super::{Analysis, Failed, Outcome, Progress, Watch};
use crate::error::Error;
use crate::repetition::Repetition;
use crate::results::{
    Begun, Column, Gradient, KeptWarning, ONE_STATE, ROWS, Recording, Results, ResultsError,
    STOPPED, Table,
};
use crate::timings::{Clock, Timings};
use eng_runtime::linearised::FrequencyResponse;
use eng_runtime::{
    Advance, CycleReport, Determined, LinearModes, Moment, Observer, PeriodicSummary, RunSummary,
    RuntimeError, Sample, SampleGradient, Slow, StartReport, Verdict, Warning, run_assemble,
    run_kinematic, run_linear, run_periodic, run_response, run_static, run_transient,
};
use eng_system::analysis::STOP;
use eng_system::recorded::recorded;
use eng_system::system::{AnalysisKind, Location, Origin, Response, Rows, Transient};
use std::num::NonZeroUsize;
use std::ops::ControlFlow;
use std::time::Duration;

/// The solution, besides the samples in the recorder.
#[derive(Default)]
struct Solved {
    summary: Option<RunSummary>,
    periodic: Option<PeriodicSummary>,
    modes: Option<LinearModes>,
    response: Option<FrequencyResponse>,
    determined: Option<Determined>,
}

impl Analysis {
    /// Runs the analysis. `progress` is called after every step.
    pub fn run(&self, progress: &mut dyn FnMut(Progress)) -> Result<Outcome, Failed> {
        self.run_watched(&mut |now: Progress| {
            progress(now);
            Verdict::GoOn
        })
    }

    /// Runs the analysis as long as a watch allows. The watch is called after every step. A stopped run ends
    /// with [`RuntimeError::Stopped`], which has the cause of its short steps. Its files remain, so that it
    /// can be resumed. A finished run has the same bits as without a watch.
    pub fn run_watched(&self, watch: &mut dyn Watch) -> Result<Outcome, Failed> {
        self.run_on(self.threads, watch)
    }

    /// [`Analysis::run_watched`] with this number of threads for its fields.
    pub(crate) fn run_on(
        &self,
        threads: NonZeroUsize,
        watch: &mut dyn Watch,
    ) -> Result<Outcome, Failed> {
        let mut begun = self.begin(&self.recording)?;
        let mut gradients = Vec::new();
        if let Begun::Complete(results) = &begun {
            match self.gradients_left(results) {
                Some(left) => gradients = left,
                None => {
                    begun = self.begin(&Recording {
                        resume: false,
                        ..self.recording.clone()
                    })?;
                }
            }
        }
        let (table, point) = match begun {
            Begun::Fresh(table) => (table, None),
            Begun::Resumed(table, point) => (table, Some(point)),
            Begun::Complete(results) => return Ok(self.made_before(results, gradients)?),
        };
        let mut recorder = Recorder {
            table,
            audited: !self.plan.kind.is_prescribed(),
            refused: None,
            resumed: point.is_some(),
            warnings: point.iter().flat_map(|p| &p.warnings).map(given).collect(),
            motion: Motion::begin(self, point.as_ref().map(|p| p.samples))?,
            gradients: self.gradient_columns(),
            at: Vec::new(),
            start: None,
            cycles: None,
            last: None,
            clock: self.timed.then(|| (Clock::new(), Timings::default())),
            watch,
        };
        let state = point.as_ref().map(|p| p.state.as_slice());
        let solved = self.solve(&mut recorder, state, threads);
        self.finish(recorder, solved)
    }

    fn begin(&self, recording: &Recording) -> Result<Begun, Error> {
        Ok(Table::begin(self.header()?, recording, self.identity())?)
    }

    /// Solves the analysis by its kind.
    fn solve(
        &self,
        recorder: &mut Recorder<'_>,
        state: Option<&[u8]>,
        threads: NonZeroUsize,
    ) -> Result<Solved, RuntimeError> {
        let model = self.model.clone().threads(threads);
        let (compiled, overrides) = (model.compiled(), &self.overrides);
        let mut solved = Solved::default();
        match &self.plan.kind {
            AnalysisKind::Transient(transient) => {
                let summary = run_transient(compiled, overrides, transient, recorder, state)?;
                solved.summary = Some(summary);
            }
            AnalysisKind::Periodic(periodic) => {
                let found = run_periodic(compiled, overrides, periodic, recorder)?;
                solved.summary = Some(found.run.clone());
                solved.periodic = Some(found);
            }
            AnalysisKind::Linear(linear) => {
                let found = run_linear(compiled, overrides, linear, recorder)?;
                recorder.modes(&found);
                solved.modes = Some(found);
            }
            AnalysisKind::Response(response) => {
                let found = run_response(compiled, overrides, response, recorder)?;
                recorder.response(&found, response);
                solved.response = Some(found);
            }
            AnalysisKind::Static(wanted) => run_static(compiled, overrides, wanted, recorder)?,
            AnalysisKind::Kinematic(wanted) => {
                let found = run_kinematic(compiled, overrides, wanted, recorder)?;
                solved.determined = Some(found);
            }
            AnalysisKind::Assemble(_) => run_assemble(compiled, overrides, recorder)?,
        }
        Ok(solved)
    }

    /// The outcome of an analysis that an earlier run has completed.
    fn made_before(&self, results: Results, gradients: Vec<Gradient>) -> Result<Outcome, Error> {
        // its motion is on disk beside it, unless the run was killed between the two
        let motion = Motion::left(self, results.metadata())?;
        Ok(Outcome {
            motion: motion.unwrap_or_else(|| Results::new(self.name(), self.model.name())),
            results,
            warnings: Vec::new(),
            summary: None,
            start: None,
            periodic: None,
            modes: None,
            response: None,
            determined: None,
            gradients,
            made_before: true,
            timings: None,
        })
    }

    /// Completes table and motion of a finished or failed run.
    fn finish(
        &self,
        mut recorder: Recorder<'_>,
        solved: Result<Solved, RuntimeError>,
    ) -> Result<Outcome, Failed> {
        recorder.spent(|timings| &mut timings.steps);
        // a failure of the disk ended the run; its samples remain, so that it can be resumed
        if let Some(refused) = recorder.refused {
            return Err(Error::from(refused).into());
        }
        let (solved, cause) = match solved {
            Ok(solved) => (solved, None),
            Err(cause @ RuntimeError::Stopped(_)) if self.recorded_to().is_some() => {
                return Err(self.error(cause).into());
            }
            Err(cause) => (Solved::default(), Some(cause)),
        };
        if let Some(found) = &solved.periodic {
            let found = Repetition::new(found, &self.model.compiled().system);
            for (key, value) in found.metadata() {
                let stated = recorder.table.set_metadata(key, value);
                stated.map_err(Error::from)?;
            }
        }
        if let Some(stopped) = solved.summary.as_ref().and_then(|s| s.stopped.as_ref()) {
            let stated = recorder.table.set_metadata(STOPPED, stopped.to_string());
            stated.map_err(Error::from)?;
        }
        let failure = cause.as_ref().map(ToString::to_string);
        // after this, a run killed between its results and its motion has the whole motion on disk
        let saved = recorder.motion.save();
        if cause.is_none() {
            saved.map_err(Error::from)?;
        }
        let finished = recorder.table.finish(failure.as_deref());
        let stands = recorder.last.and_then(|last| self.stands(&last));
        let cause = cause.map(|cause| self.error_with(cause, stands));
        let results = match finished {
            Ok(results) => results,
            // the failure of the run is more informative than that of its table
            Err(error) => return Err(cause.unwrap_or_else(|| error.into()).into()),
        };
        let mut gradients = Vec::new();
        if cause.is_none() {
            self.write_matrices(solved.modes.as_ref())
                .map_err(Error::from)?;
            for columns in recorder.gradients {
                gradients.push(columns.finish(&results).map_err(Error::from)?);
            }
            self.write_gradients(&gradients, &results)
                .map_err(Error::from)?;
        }
        let motion = recorder.motion.results(self, results.metadata())?;
        if let Some((clock, spent)) = &mut recorder.clock {
            spent.files += clock.since();
        }
        let outcome = Outcome {
            results,
            motion,
            warnings: recorder.warnings,
            summary: solved.summary,
            start: recorder.start,
            periodic: solved.periodic,
            modes: solved.modes,
            response: solved.response,
            determined: solved.determined,
            gradients,
            made_before: false,
            timings: recorder.clock.map(|(_, spent)| spent),
        };
        match cause {
            None => Ok(outcome),
            Some(error) => Err(Failed {
                error: Box::new(error),
                partial: (outcome.results.samples() > 0).then(|| Box::new(outcome)),
            }),
        }
    }

    /// The channels that joints and drives determine, of a kinematic analysis.
    pub(super) fn determined(&self) -> Option<Result<Determined, Error>> {
        let AnalysisKind::Kinematic(kinematic) = &self.plan.kind else {
            return None;
        };
        let compiled = self.model.compiled();
        let found = eng_runtime::kinematic_columns(compiled, &self.overrides, kinematic);
        Some(found.map_err(|cause| self.error(cause)))
    }

    /// All columns without values, in the order of [`Recorder::sample`], with the metadata known before the
    /// run.
    pub(crate) fn header(&self) -> Result<Results, Error> {
        let system = &self.model.compiled().system;
        let mut results = Results::new(self.name(), self.model.name());
        if let AnalysisKind::Response(response) = &self.plan.kind {
            crate::response::push_columns(&mut results, system, response)?;
        } else if self.plan.kind.rows() == Rows::Modes {
            let bound = eng_runtime::model::Model::bind(self.model.compiled(), &self.overrides)
                .map_err(|cause| self.error(cause))?;
            crate::modes::push_columns(&mut results, &bound)?;
        } else if let Some(determined) = self.determined() {
            crate::kinematic::push_columns(&mut results, system, &determined?)?;
        } else {
            self.push_samples(&mut results)?;
        }
        if self.plan.kind.rows() == Rows::State {
            results.set_metadata(ROWS, ONE_STATE);
        }
        results.set_metadata("version", env!("CARGO_PKG_VERSION"));
        results.set_metadata("file", self.program.file());
        results.set_metadata("source_hash", self.program.source_hash());
        if let AnalysisKind::Transient(Transient {
            stop: Some(condition),
            ..
        }) = &self.plan.kind
        {
            results.set_metadata(STOP, condition);
        }
        if let Some((name, value)) = &self.stepped_here {
            results.set_metadata(format!("override.{name}"), value);
        }
        for (path, word, _) in &self.chosen {
            results.set_metadata(format!("override.{path}"), word);
        }
        for point in self.point() {
            results.set_metadata(
                format!("point.{}", point.name),
                point.display.exact_text(point.value),
            );
        }
        let bound = self.bound()?;
        for (parameter, value) in system.parameters.iter().zip(&bound.parameters) {
            let d = &parameter.display;
            results.set_metadata(
                format!("parameter.{}", parameter.origin.path),
                d.exact_text(*value),
            );
        }
        for input in &system.inputs {
            let stated = self.overrides.get(input.parameter as usize);
            let held = stated.copied().flatten().is_some();
            let signal = input.signal.as_ref().filter(|_| !held);
            if let (Some(signal), Some(parameter)) =
                (signal, system.parameters.get(input.parameter as usize))
            {
                results.set_metadata(
                    format!("input.{}", parameter.origin.path),
                    format!("{signal}(time)"),
                );
            }
        }
        Ok(results)
    }

    /// Columns of samples: time, cycle, channels, energy.
    fn push_samples(&self, results: &mut Results) -> Result<(), Error> {
        let system = &self.model.compiled().system;
        for column in recorded(system) {
            results.push(Column {
                path: column.path,
                dimension: column.dimension,
                display: column.display,
                frame: column.frame,
                values: Vec::new(),
            })?;
        }
        Ok(())
    }
}

/// The recorder between a run and its table.
struct Recorder<'a> {
    table: Table,
    /// Whether rows have the energy audit.
    audited: bool,
    /// The reason for samples or checkpoints that could not be kept.
    refused: Option<ResultsError>,
    /// Whether an earlier run reported the start.
    resumed: bool,
    warnings: Vec<Warning>,
    motion: Motion,
    /// The derivatives by parameters.
    gradients: Vec<GradientColumns>,
    /// Time and cycle at the last sample.
    at: Vec<f64>,
    start: Option<StartReport>,
    cycles: Option<(u32, Option<f64>)>,
    /// The last progress of the run.
    last: Option<Advance>,
    /// The clock of the phases, and their times so far.
    clock: Option<(Clock, Timings)>,
    watch: &'a mut dyn Watch,
}

impl Recorder<'_> {
    fn modes(&mut self, modes: &LinearModes) {
        for (key, value) in crate::modes::metadata(modes) {
            let stated = self.table.set_metadata(key, value);
            if self.keep(stated).is_break() {
                return;
            }
        }
        for (index, mode) in modes.modes.iter().enumerate() {
            let kept = self
                .table
                .push(crate::modes::row(modes, index, mode).into_iter());
            if self.keep(kept).is_break() {
                return;
            }
        }
    }

    fn response(&mut self, found: &FrequencyResponse, response: &Response) {
        for (key, value) in crate::response::metadata(found, response) {
            let stated = self.table.set_metadata(key, value);
            if self.keep(stated).is_break() {
                return;
            }
        }
        for row in crate::response::rows(found) {
            let kept = self.table.push(row.into_iter());
            if self.keep(kept).is_break() {
                return;
            }
        }
    }

    /// Counts the time since the last call for a phase.
    fn spent(&mut self, phase: impl FnOnce(&mut Timings) -> &mut Duration) {
        if let Some((clock, spent)) = &mut self.clock {
            *phase(spent) += clock.since();
        }
    }

    /// Records a row of the results and of the motion.
    fn record(&mut self, sample: &Sample<'_>) -> ControlFlow<()> {
        if self.refused.is_some() {
            return ControlFlow::Break(());
        }
        if let Err(error) = self.motion.push(sample) {
            return self.keep(Err(error));
        }
        if !self.gradients.is_empty() {
            self.at.clear();
            self.at.push(sample.time);
            self.at
                .extend(sample.cycle_angle.into_iter().chain(sample.cycle_rate));
        }
        let e = &sample.energy;
        let audit = [
            e.kinetic,
            e.gravity,
            e.strain,
            e.damping,
            e.loads,
            e.constraints,
            e.imbalance(),
        ];
        let row = std::iter::once(sample.time)
            .chain(sample.cycle_angle)
            .chain(sample.cycle_rate)
            .chain(sample.values.iter().copied())
            .chain(audit.into_iter().filter(|_| self.audited));
        let kept = self.table.push(row);
        self.keep(kept)
    }

    fn keep(&mut self, kept: Result<(), ResultsError>) -> ControlFlow<()> {
        match kept {
            Ok(()) => ControlFlow::Continue(()),
            Err(error) => {
                self.refused.get_or_insert(error);
                ControlFlow::Break(())
            }
        }
    }
}

/// A warning for a checkpoint.
fn kept(warning: &Warning) -> KeptWarning {
    let place = |at: Location| (at.source, at.start, at.end);
    KeptWarning {
        path: warning.origin.path.clone(),
        used_at: warning.origin.used_at.map(place),
        defined_at: warning.origin.defined_at.map(place),
        name: warning.name.clone(),
        message: warning.message.clone(),
        time: warning.moment.time.to_bits(),
        cycle_angle: warning.moment.cycle_angle.map(f64::to_bits),
    }
}

/// A warning from a checkpoint.
fn given(kept: &KeptWarning) -> Warning {
    let place = |(source, start, end)| Location { source, start, end };
    Warning {
        origin: Origin {
            path: kept.path.clone(),
            used_at: kept.used_at.map(place),
            defined_at: kept.defined_at.map(place),
        },
        name: kept.name.clone(),
        message: kept.message.clone(),
        // a run with gradients keeps no checkpoint
        label: eng_runtime::FAILS,
        moment: Moment {
            time: f64::from_bits(kept.time),
            cycle_angle: kept.cycle_angle.map(f64::from_bits),
        },
    }
}

impl Observer for Recorder<'_> {
    fn started(&mut self, report: &StartReport) {
        self.spent(|timings| &mut timings.start);
        if !self.resumed {
            let stated = self.table.set_metadata("start", report.to_string());
            // an error is noted, and the first sample then ends the run
            let _ = self.keep(stated);
            self.start = Some(report.clone());
        }
    }

    fn cycle(&mut self, cycle: &CycleReport) {
        self.cycles = Some((cycle.cycles, cycle.slowest.as_ref().map(|s| s.change)));
    }

    fn stepped(&mut self) {
        self.spent(|timings| &mut timings.steps);
    }

    fn sampled(&mut self) {
        self.spent(|timings| &mut timings.samples);
    }

    fn sample(&mut self, sample: &Sample<'_>) -> ControlFlow<()> {
        self.spent(|timings| &mut timings.samples);
        let taken = self.record(sample);
        self.spent(|timings| &mut timings.files);
        taken
    }

    fn gradient(&mut self, parameter: usize, sample: SampleGradient<'_>) {
        self.spent(|timings| &mut timings.samples);
        if let Some(columns) = self.gradients.get_mut(parameter) {
            columns.push(&self.at, sample);
        }
    }

    fn wants_checkpoint(&mut self) -> bool {
        // a checkpoint has no gradients
        self.refused.is_none() && self.gradients.is_empty() && self.table.wants_checkpoint()
    }

    fn checkpoint(&mut self, bytes: Vec<u8>) {
        self.spent(|timings| &mut timings.steps);
        let warnings = self.warnings.iter().map(kept).collect();
        let saved = self
            .motion
            .save()
            .and_then(|()| self.table.save(bytes, warnings));
        // an error is noted, and the next sample then ends the run
        let _ = self.keep(saved);
        self.spent(|timings| &mut timings.files);
    }

    fn progress(&mut self, advance: &Advance) -> Verdict {
        self.last = Some(*advance);
        self.watch.progress(Progress {
            fraction: advance.fraction,
            time: advance.time,
            steps: advance.steps,
            cycle_angle: advance.cycle_angle,
            cycles: self.cycles,
        })
    }

    fn short_steps(&mut self, slow: &Slow) {
        self.watch.short_steps(slow);
    }

    fn warning(&mut self, warning: &Warning) {
        self.warnings.push(warning.clone());
    }
}
