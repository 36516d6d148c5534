//! The analyses of a program with the channels that each of them records.

use super::axes::Frames;
use crate::elaborate::{AnalysisPlan, Structural};
use crate::models::{SharedModel, SharedModels};
use crate::program::DefinitionId;
use crate::typed::TypedProgram;
use eng_grammar::{Diagnostics, SourceMap};
use eng_system::host::Host;
use eng_system::recorded::{Recorded, of_kind, of_modes, recorded};
use eng_system::system::System;
use std::rc::Rc;
use std::sync::Arc;

/// The recorded channels of a model.
pub(super) struct Channels {
    /// One row for each sample.
    pub samples: Vec<Recorded>,
    /// In a linear analysis: one row for each mode.
    pub modes: Vec<Recorded>,
    pub journals: Vec<Journal>,
    pub cycle: bool,
    pub frames: Frames,
    model: Arc<SharedModel>,
}

/// A journal of a model.
pub(super) struct Journal {
    pub path: String,
    /// The channels of the force on its pin, along x and y of the shell.
    pub force: [String; 2],
    /// Whether it is solved on cells.
    pub cells: bool,
}

impl Channels {
    /// The model.
    pub fn system(&self) -> &System {
        &self.model.elaborated.system
    }

    /// The columns of an analysis whose kind has columns of its own.
    pub fn own(&self, plan: &AnalysisPlan) -> Option<Rc<[Recorded]>> {
        of_kind(self.system(), &plan.analysis.kind).map(Into::into)
    }

    /// The path of the marker along whose axes a component is recorded.
    pub fn frame(&self, path: &str) -> Option<&str> {
        let column = self.samples.iter().find(|column| column.path == path)?;
        (!column.frame.is_empty()).then_some(column.frame.as_str())
    }
}

/// The recorded channels of each analysis. A model is elaborated at its first use.
pub(super) struct Models<'a> {
    typed: &'a TypedProgram,
    shared: &'a SharedModels,
    sources: &'a SourceMap,
    host: &'a dyn Host,
    pub plans: &'a [AnalysisPlan],
    #[allow(clippy::type_complexity)]
    known: Vec<(
        DefinitionId,
        &'a [(String, Structural)],
        Option<Rc<Channels>>,
    )>,
    messages: Diagnostics,
}

impl<'a> Models<'a> {
    pub fn new(
        typed: &'a TypedProgram,
        shared: &'a SharedModels,
        sources: &'a SourceMap,
        host: &'a dyn Host,
        plans: &'a [AnalysisPlan],
    ) -> Models<'a> {
        Models {
            typed,
            shared,
            sources,
            host,
            plans,
            known: Vec::new(),
            messages: Diagnostics::new(),
        }
    }

    /// The new messages of the elaborations since the last call.
    pub fn messages(&mut self) -> Diagnostics {
        std::mem::take(&mut self.messages)
    }

    /// The recorded channels of an analysis; `None` if its model has a mistake.
    pub fn channels(&mut self, plan: &'a AnalysisPlan) -> Option<Rc<Channels>> {
        let same = self
            .known
            .iter()
            .find(|(model, constants, _)| *model == plan.model && *constants == plan.constants);
        if let Some((_, _, channels)) = same {
            return channels.clone();
        }
        let mut texts = self.sources.clone();
        let mut found = Diagnostics::new();
        let model = self.shared.model(
            self.typed,
            &mut texts,
            self.host,
            plan.model,
            &plan.constants,
            &mut found,
        );
        if found.has_errors() {
            self.messages.extend(found);
        }
        let channels = model.map(|model| {
            let system = &model.elaborated.system;
            Rc::new(Channels {
                samples: recorded(system),
                modes: of_modes(system),
                journals: system
                    .journals
                    .iter()
                    .filter_map(|j| {
                        let element = system.elements.get(j.element as usize)?;
                        let channel =
                            |index: u32| Some(system.channels.get(index as usize)?.path.clone());
                        Some(Journal {
                            path: element.origin.path.clone(),
                            force: [channel(j.force)?, channel(j.force + 1)?],
                            cells: !element.fields.is_empty(),
                        })
                    })
                    .collect(),
                cycle: system.cycle.is_some(),
                frames: Frames::of(system),
                model: Arc::clone(&model),
            })
        });
        self.known
            .push((plan.model, &plan.constants, channels.clone()));
        channels
    }

    /// The analyses with a name. Points of a sweep are in their order.
    pub fn named(&self, name: &str) -> Vec<&'a AnalysisPlan> {
        self.plans
            .iter()
            .filter(|plan| root(&plan.analysis.origin.path) == name)
            .collect()
    }

    /// The names of all analyses; a sweep has one name.
    pub fn names(&self) -> Vec<&'a str> {
        let mut names: Vec<&str> = Vec::new();
        for plan in self.plans {
            let name = root(&plan.analysis.origin.path);
            if !names.contains(&name) {
                names.push(name);
            }
        }
        names
    }

    /// The analysis with a full name.
    pub fn plan(&self, path: &str) -> Option<&'a AnalysisPlan> {
        self.plans.iter().find(|p| p.analysis.origin.path == path)
    }
}

fn root(path: &str) -> &str {
    path.split('[').next().unwrap_or_default()
}
