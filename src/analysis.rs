//! Running the analyses of a program.

use crate::model::{Model, Parameter};
use crate::motion::Motion;
use crate::results::{Column, Results};
use crate::simulation::run_error;
use crate::{Error, Program, Quantity, RuntimeError};
use eng_runtime::{
    CycleReport, Observer, PeriodicSummary, RunSummary, Sample, StartReport, Warning, run_periodic,
    run_transient,
};
use eng_system::system::{AnalysisKind, PointValue};
use eng_system::{Dimension, DisplayUnit};
use std::ops::ControlFlow;

/// An analysis, ready to run.
#[derive(Clone, Debug)]
pub struct Analysis {
    model: Model,
    plan: eng_system::system::Analysis,
    program: Program,
    overrides: Vec<Option<f64>>,
}

/// How far a run is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// Done part, 0…1.
    pub fraction: f64,
    /// Unwrapped cycle angle (rad), if the model has a cycle.
    pub cycle_angle: Option<f64>,
    /// Of a periodic analysis: whole cycles so far, and the largest change from the last to this one as a share of its swing.
    pub cycles: Option<(u32, Option<f64>)>,
}

/// What a run made.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// All columns.
    pub results: Results,
    /// Where the bodies were in the last cycle, thinned: see [`crate::motion`].
    pub motion: Results,
    /// `advise`s that did not hold.
    pub warnings: Vec<Warning>,
    /// Steps and energy; absent where only the start was asked for, or the run failed.
    pub summary: Option<RunSummary>,
    /// How the motion began; absent where it did not.
    pub start: Option<StartReport>,
    /// Cycles, decay and whirl of a periodic analysis; absent where it failed.
    pub periodic: Option<PeriodicSummary>,
}

/// A run that failed, with what was computed before.
#[derive(Debug)]
pub struct Failed {
    /// Why.
    pub error: Box<Error>,
    /// Samples up to the failure, if there are any.
    pub partial: Option<Box<Outcome>>,
}

impl Analysis {
    pub(crate) fn new(
        model: Model,
        plan: eng_system::system::Analysis,
        program: Program,
    ) -> Result<Analysis, Error> {
        let mut overrides = vec![None; model.compiled().system.parameters.len()];
        for (path, value) in &plan.set {
            overrides[model.parameter(path)?.index] = Some(*value);
        }
        Ok(Analysis {
            model,
            plan,
            program,
            overrides,
        })
    }

    /// Its name.
    pub fn name(&self) -> &str {
        &self.plan.origin.path
    }

    /// Hash of the texts of its program.
    pub(crate) fn source_hash(&self) -> String {
        self.program.source_hash()
    }

    /// Its place in the text.
    pub(crate) fn origin(&self) -> &eng_system::system::Origin {
        &self.plan.origin
    }

    /// Where it stands in its sweep; empty for one without an index.
    pub fn point(&self) -> &[PointValue] {
        &self.plan.point
    }

    /// Its compiled model.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// What is done.
    pub fn kind(&self) -> &AnalysisKind {
        &self.plan.kind
    }

    /// Sets a parameter, over what the analysis sets.
    pub fn set(mut self, parameter: Parameter, value: Quantity) -> Result<Self, Error> {
        self.overrides[parameter.index] = Some(self.model.checked(parameter, value)?);
        Ok(self)
    }

    /// The values of all slots for this analysis's parameters: what the summary needs of journals and cycle.
    pub(crate) fn bound(&self) -> Result<eng_system::code::Bound, Error> {
        let compiled = self.model.compiled();
        compiled
            .bind
            .bind(&self.overrides, &compiled.system.tables)
            .map_err(|e| run_error(&self.model, e.into()))
    }

    /// Assembles the model as the analysis begins, and counts its freedoms.
    pub fn topology(&self) -> Result<eng_runtime::TopologyReport, Error> {
        let (compiled, overrides) = (self.model.compiled(), &self.overrides);
        // the start has conditions of its own: clearances, velocities that fit each other
        eng_runtime::Simulation::new(compiled, overrides, eng_runtime::Options::default())
            .and_then(|_| eng_runtime::topology(compiled, overrides))
            .map_err(|cause| run_error(&self.model, cause))
    }

    /// Runs. `progress` is called after every step.
    pub fn run(&self, progress: &mut dyn FnMut(Progress)) -> Result<Outcome, Failed> {
        let compiled = self.model.compiled();
        let mut recorder = Recorder {
            time: Vec::new(),
            cycle_angle: Vec::new(),
            cycle_rate: Vec::new(),
            energy: Default::default(),
            channels: vec![Vec::new(); compiled.system.channels.len()],
            warnings: Vec::new(),
            motion: Motion::new(self.bound().ok().and_then(|b| cycle_period(compiled, &b))),
            start: None,
            cycles: None,
            progress,
        };
        let ran = match &self.plan.kind {
            AnalysisKind::Transient(t) => {
                run_transient(compiled, &self.overrides, t, &mut recorder, None)
                    .map(|summary| (Some(summary), None))
            }
            AnalysisKind::Periodic(p) => run_periodic(compiled, &self.overrides, p, &mut recorder)
                .map(|found| (Some(found.run.clone()), Some(found))),
            AnalysisKind::Assemble => self.assembled(&mut recorder).map(|()| (None, None)),
        };
        let (recorded, cause) = match ran {
            Ok((summary, periodic)) => (recorder.finish(self, summary, periodic), None),
            Err(cause) => (
                recorder.finish(self, None, None),
                Some(run_error(&self.model, cause)),
            ),
        };
        match (recorded, cause) {
            (Ok(outcome), None) => Ok(outcome),
            (Ok(outcome), Some(error)) => {
                let partial = (outcome.results.samples() > 0).then(|| Box::new(outcome));
                Err(Failed {
                    error: Box::new(error),
                    partial,
                })
            }
            (Err(error), None) | (_, Some(error)) => Err(Failed {
                error: Box::new(error),
                partial: None,
            }),
        }
    }

    fn assembled(&self, recorder: &mut Recorder<'_>) -> Result<(), RuntimeError> {
        let mut simulation = eng_runtime::Simulation::new(
            self.model.compiled(),
            &self.overrides,
            eng_runtime::Options::default(),
        )?;
        let mut values = vec![0.0; recorder.channels.len()];
        simulation.evaluate_channels(&mut values)?;
        let _ = recorder.sample(&Sample {
            time: simulation.time(),
            cycle_angle: simulation.cycle_angle(),
            cycle_rate: simulation.cycle_rate(),
            values: &values,
            energy: simulation.energy(),
            eccentricities: &[],
            pose: simulation.sampled_pose(),
        });
        Ok(())
    }
}

/// The period of the cycle (rad), if the model has one.
pub(crate) fn cycle_period(
    compiled: &eng_system::code::Compiled,
    bound: &eng_system::code::Bound,
) -> Option<f64> {
    let cycle = compiled.system.cycle.as_ref()?;
    bound.slots.get(cycle.period.0 as usize).copied()
}

/// Columns while a run goes on.
struct Recorder<'a> {
    time: Vec<f64>,
    cycle_angle: Vec<f64>,
    cycle_rate: Vec<f64>,
    energy: [Vec<f64>; 7],
    channels: Vec<Vec<f64>>,
    warnings: Vec<Warning>,
    motion: Motion,
    start: Option<StartReport>,
    cycles: Option<(u32, Option<f64>)>,
    progress: &'a mut dyn FnMut(Progress),
}

/// Paths of the energy audit's columns.
const ENERGY: [&str; 7] = [
    "energy.kinetic",
    "energy.gravity",
    "energy.strain",
    "energy.damping",
    "energy.work_of_loads",
    "energy.work_of_drives",
    "energy.imbalance",
];

impl Observer for Recorder<'_> {
    fn started(&mut self, report: &StartReport) {
        self.start = Some(report.clone());
    }

    fn cycle(&mut self, cycle: &CycleReport) {
        self.cycles = Some((cycle.cycles, cycle.slowest.as_ref().map(|s| s.change)));
    }

    fn sample(&mut self, sample: &Sample<'_>) -> ControlFlow<()> {
        self.time.push(sample.time);
        self.motion.push(sample);
        if let (Some(angle), Some(rate)) = (sample.cycle_angle, sample.cycle_rate) {
            self.cycle_angle.push(angle);
            self.cycle_rate.push(rate);
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
        for (column, value) in self.energy.iter_mut().zip(audit) {
            column.push(value);
        }
        for (column, value) in self.channels.iter_mut().zip(sample.values) {
            column.push(*value);
        }
        ControlFlow::Continue(())
    }

    fn progress(&mut self, fraction: f64, cycle_angle: Option<f64>) {
        (self.progress)(Progress {
            fraction,
            cycle_angle,
            cycles: self.cycles,
        });
    }

    fn warning(&mut self, warning: &Warning) {
        self.warnings.push(warning.clone());
    }
}

impl Recorder<'_> {
    fn finish(
        self,
        analysis: &Analysis,
        summary: Option<RunSummary>,
        periodic: Option<PeriodicSummary>,
    ) -> Result<Outcome, Error> {
        let mut results = Results::new(analysis.name(), analysis.model.name());
        let samples = self.time.len();
        results.push(Column::time(self.time))?;
        if samples > 0 && self.cycle_angle.len() == samples {
            results.push(Column::cycle_angle(self.cycle_angle))?;
            results.push(Column::cycle_speed(self.cycle_rate))?;
        }
        let system = &analysis.model.compiled().system;
        for (channel, values) in system.channels.iter().zip(self.channels) {
            results.push(Column {
                path: channel.path.clone(),
                dimension: channel.dimension,
                display: channel.display.clone(),
                frame: channel.frame.clone(),
                values,
            })?;
        }
        let energy = Dimension::MASS
            .times(Dimension::LENGTH)
            .times(Dimension::LENGTH)
            .over(Dimension::TIME)
            .over(Dimension::TIME);
        for (path, values) in ENERGY.iter().zip(self.energy) {
            results.push(Column {
                path: (*path).to_owned(),
                dimension: energy,
                display: DisplayUnit {
                    symbol: "J".into(),
                    scale: 1.0,
                    offset: 0.0,
                },
                frame: String::new(),
                values,
            })?;
        }
        results.set_metadata("version", env!("CARGO_PKG_VERSION"));
        results.set_metadata("file", analysis.program.file());
        results.set_metadata("source_hash", analysis.program.source_hash());
        if let Some(start) = &self.start {
            results.set_metadata("start", start.to_string());
        }
        for point in analysis.point() {
            results.set_metadata(
                format!("point.{}", point.name),
                point.display.text(point.value),
            );
        }
        let bound = analysis.bound()?;
        for (parameter, value) in system.parameters.iter().zip(&bound.parameters) {
            let d = &parameter.display;
            results.set_metadata(
                format!("parameter.{}", parameter.origin.path),
                format!("{} {}", d.from_si(*value), d.symbol),
            );
        }
        let motion = self.motion.results(analysis, results.metadata())?;
        Ok(Outcome {
            results,
            motion,
            warnings: self.warnings,
            summary,
            start: self.start,
            periodic,
        })
    }
}
