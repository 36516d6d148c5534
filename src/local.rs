//! The command line's engine: this process compiles and runs.

use crate::analysis::{Failed, Outcome};
use crate::cli::{
    AssemblyOutcome, CheckOutcome, Engine, EngineError, JournalGeometry, Progress, RunOutcome,
    Setting,
};
use crate::plot::Upright;
use crate::{Analysis, Error, Program, Quantity, Sources};
use eng_grammar::Diagnostics;
use std::path::Path;

/// Compiles and runs models of this machine's folders.
#[derive(Debug, Default)]
pub struct Local {
    program: Option<Program>,
}

impl Local {
    /// Nothing checked yet.
    pub fn new() -> Local {
        Local::default()
    }
}

impl Engine for Local {
    fn check(&mut self, model: &Path) -> Result<CheckOutcome, EngineError> {
        let system = |message: String| EngineError::System(message);
        let file = model
            .file_name()
            .and_then(|n| n.to_str())
            .ok_or_else(|| system(format!("{} is not a file", model.display())))?;
        let folder = match model.parent() {
            Some(p) if !p.as_os_str().is_empty() => p,
            _ => Path::new("."),
        };
        if !model.is_file() {
            return Err(system(format!("there is no file {}", model.display())));
        }
        let sources = Sources::folder(folder).map_err(|e| system(e.to_string()))?;
        let checked = crate::check(&sources, file);
        let report = checked.report();
        self.program = checked.program().cloned();
        let mut facts = Vec::new();
        if let Some(program) = &self.program {
            for name in program.models() {
                facts.push(program.model(name).map_err(engine_error)?.summary());
            }
        }
        Ok(CheckOutcome {
            sources: report.texts().clone(),
            diagnostics: report.diagnostics().clone(),
            analyses: self
                .program
                .as_ref()
                .map(|p| p.analyses().iter().map(ToString::to_string).collect())
                .unwrap_or_default(),
            facts,
        })
    }

    fn assemble(&mut self) -> Result<AssemblyOutcome, EngineError> {
        let Some(program) = &self.program else {
            return Err(EngineError::System("no model was checked".into()));
        };
        let mut found = AssemblyOutcome::default();
        let mut told = Vec::new();
        for name in program.analyses() {
            let analysis = program.analysis(name).map_err(engine_error)?;
            match analysis.topology() {
                Ok(report) => found.facts.push(format!(
                    "{name}: assembles; {} velocities, {} constraint equations, {} freedoms",
                    report.velocities, report.equations, report.freedom
                )),
                Err(Error::Run { report, .. } | Error::Report(report)) => {
                    // analyses of one model fail alike: each mistake once
                    for diagnostic in report.diagnostics().iter() {
                        if !told.contains(diagnostic) {
                            told.push(diagnostic.clone());
                            found.diagnostics.push(diagnostic.clone());
                        }
                    }
                }
                Err(other) => return Err(engine_error(other)),
            }
        }
        Ok(found)
    }

    fn run(
        &mut self,
        analysis: &str,
        settings: &[Setting],
        progress: &mut dyn FnMut(Progress),
    ) -> Result<RunOutcome, EngineError> {
        let Some(program) = &self.program else {
            return Err(EngineError::System("no model was checked".into()));
        };
        let mut analysis = program.analysis(analysis).map_err(engine_error)?;
        for setting in settings {
            let usage = |e: Error| EngineError::Usage(format!("--set {}: {e}", setting.path));
            let parameter = analysis.model().parameter(&setting.path).map_err(usage)?;
            let value: Quantity = setting
                .value
                .parse()
                .map_err(|e: crate::QuantityError| usage(e.into()))?;
            analysis = analysis.set(parameter, value).map_err(usage)?;
        }
        let ran = analysis.run(&mut |p| {
            progress(Progress {
                fraction: p.fraction,
                time: 0.0,
                cycle_angle: p.cycle_angle,
                cycles: p.cycles,
            });
        });
        match ran {
            Ok(outcome) => run_outcome(&analysis, outcome).map_err(engine_error),
            Err(Failed { error, partial }) => {
                let partial = partial.and_then(|o| run_outcome(&analysis, *o).ok());
                Err(match engine_error(*error) {
                    EngineError::Model { diagnostics, .. } => EngineError::Model {
                        diagnostics,
                        partial: partial.map(Box::new),
                    },
                    other => other,
                })
            }
        }
    }
}

fn engine_error(error: Error) -> EngineError {
    match error {
        Error::Report(report) | Error::Run { report, .. } => EngineError::Model {
            diagnostics: report.diagnostics().clone(),
            partial: None,
        },
        Error::Results(e) => EngineError::System(e.to_string()),
        Error::Code(e) => EngineError::System(e.to_string()),
        other => EngineError::Usage(other.to_string()),
    }
}

fn run_outcome(analysis: &Analysis, outcome: Outcome) -> Result<RunOutcome, Error> {
    let system = &analysis.model().compiled().system;
    let bound = analysis.bound()?;
    let at =
        |slot: eng_system::system::Slot| bound.slots.get(slot.0 as usize).copied().unwrap_or(0.0);
    let mut diagnostics = Diagnostics::new();
    for advice in &bound.advice {
        diagnostics.push(crate::failure::parameter_advice(advice));
    }
    for warning in &outcome.warnings {
        // a run repeats what its parameters are advised at its start
        let repeated = |advice: &eng_system::code::Advice| {
            advice.origin == warning.origin && advice.message == warning.message
        };
        if !bound.advice.iter().any(repeated) {
            diagnostics.push(crate::failure::advice(warning));
        }
    }
    let gravity = system.gravity.map(at);
    let mut facts = Vec::new();
    if let Some(start) = &outcome.start {
        facts.push(start.to_string());
        crate::failure::start_advice(start)
            .into_iter()
            .for_each(|d| diagnostics.push(d));
    }
    if let Some(periodic) = &outcome.periodic {
        let (told, warnings) = crate::failure::periodic(periodic, analysis, &bound);
        facts.extend(told);
        warnings.into_iter().for_each(|d| diagnostics.push(d));
    }
    if let Some(summary) = &outcome.summary {
        let s = &summary.statistics;
        facts.push(format!(
            "{} steps, {} rejected, {} Newton iterations, {} factorisations",
            s.steps, s.rejected, s.iterations, s.factorizations
        ));
        let e = &summary.energy;
        facts.push(format!(
            "energy: {:.6} J kinetic, {:.3e} J out of balance",
            e.kinetic,
            e.imbalance()
        ));
    }
    Ok(RunOutcome {
        journals: system
            .journals
            .iter()
            .map(|j| JournalGeometry {
                path: system.elements[j.element as usize].origin.path.clone(),
                diameter: at(j.diameter),
                width: at(j.width),
                radial_clearance: at(j.radial_clearance),
            })
            .collect(),
        cycle_period: system.cycle.as_ref().map(|c| at(c.period)),
        // orbits are drawn with gravity downwards
        upright: if gravity[0].abs() > gravity[1].abs() {
            Upright::X
        } else {
            Upright::Y
        },
        diagnostics,
        facts,
        results: outcome.results,
    })
}
