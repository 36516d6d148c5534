//! The command line's engine: this process compiles and runs.

use crate::analysis::{Failed, Outcome};
use crate::cli::{
    AssemblyOutcome, CheckOutcome, Engine, EngineError, JournalGeometry, Progress, RunOutcome,
    Setting,
};
use crate::plot::Upright;
use crate::{Analysis, Error, Program, Quantity, Sources};
use eng_grammar::Diagnostics;
use std::ffi::OsString;
use std::path::{Path, PathBuf};

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
        let mut sources = Sources::folder(folder).map_err(|e| system(e.to_string()))?;
        if let Some(cache) = cache_folder(|name| std::env::var_os(name)) {
            sources = sources.with_cache(cache);
        }
        let checked = crate::check(&sources, file);
        let report = checked.report();
        self.program = checked.program().cloned();
        let mut facts = Vec::new();
        let mut diagnostics = report.diagnostics().clone();
        if let Some(program) = &self.program {
            for name in program.models() {
                match program.model(name) {
                    Ok(model) => facts.push(model.summary()),
                    // a mesh that reads well may still make no structure
                    Err(Error::Report(report)) => diagnostics.extend(report.diagnostics().clone()),
                    Err(other) => return Err(engine_error(other)),
                }
            }
        }
        Ok(CheckOutcome {
            sources: report.texts().clone(),
            diagnostics,
            analyses: self
                .program
                .as_ref()
                .map(|p| p.analyses().iter().map(ToString::to_string).collect())
                .unwrap_or_default(),
            facts,
        })
    }

    fn reduce(&mut self) -> Result<Vec<String>, EngineError> {
        let Some(program) = &self.program else {
            return Err(EngineError::System("no model was checked".into()));
        };
        let mut texts = Vec::new();
        for name in program.models() {
            let model = program.model(name).map_err(engine_error)?;
            for reduction in model.reductions() {
                let text = reduction.text();
                if !texts.contains(&text) {
                    texts.push(text);
                }
            }
        }
        Ok(texts)
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

/// Where reduced bodies are kept: `ENG_CACHE` (empty: nowhere), else a folder of the user's caches.
fn cache_folder(variable: impl Fn(&str) -> Option<OsString>) -> Option<PathBuf> {
    if let Some(folder) = variable("ENG_CACHE") {
        return (!folder.is_empty()).then(|| PathBuf::from(folder));
    }
    let set = |name: &str| variable(name).filter(|v| !v.is_empty()).map(PathBuf::from);
    set("XDG_CACHE_HOME")
        .or_else(|| set("LOCALAPPDATA"))
        .or_else(|| {
            let home = set("HOME")?;
            Some(if cfg!(target_os = "macos") {
                home.join("Library").join("Caches")
            } else {
                home.join(".cache")
            })
        })
        .map(|folder| folder.join("eng"))
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
