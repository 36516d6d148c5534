//! Models of a checked program, elaborated and compiled once for all analyses that share their constants.
//!
//! This module contains data that follow from the text and constants. It must not contain parameters, reduced
//! bodies or states.

use crate::elaborate::{AnalysisPlan, Elaborated, Structural, check_names, elaborate};
use crate::generate::{CodegenError, compile_class};
use crate::program::DefinitionId;
use crate::typed::TypedProgram;
use eng_grammar::{Diagnostics, SourceMap};
use eng_system::code::ElementCode;
use eng_system::host::Host;
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};

/// A model with its constants.
#[derive(Debug)]
pub struct SharedModel {
    definition: DefinitionId,
    constants: Vec<(String, Structural)>,
    /// The flat system with its graphs.
    pub elaborated: Elaborated,
    /// The code of each class, from the first call of [`SharedModels::code`] on.
    code: OnceLock<Vec<Arc<dyn ElementCode>>>,
}

/// The models of a program that were elaborated without an error.
#[derive(Debug, Default)]
pub struct SharedModels {
    known: Mutex<Vec<Arc<SharedModel>>>,
}

impl SharedModels {
    /// A model with its constants, elaborated at the first call. `None` after an error. Only the first
    /// elaboration reports messages.
    pub fn model(
        &self,
        typed: &TypedProgram,
        sources: &mut SourceMap,
        host: &dyn Host,
        definition: DefinitionId,
        constants: &[(String, Structural)],
        diagnostics: &mut Diagnostics,
    ) -> Option<Arc<SharedModel>> {
        let same = |model: &&Arc<SharedModel>| {
            model.definition == definition && model.constants == constants
        };
        if let Some(model) = self.known().iter().find(same) {
            return Some(Arc::clone(model));
        }
        let elaborated = elaborate(typed, sources, host, definition, constants, diagnostics)?;
        let made = Arc::new(SharedModel {
            definition,
            constants: constants.to_vec(),
            elaborated,
            code: OnceLock::new(),
        });
        self.known().push(Arc::clone(&made));
        Some(made)
    }

    /// The code of each class of a model, compiled at the first call. Models with other constants share the code of
    /// the classes that these constants do not change.
    pub fn code(&self, model: &SharedModel) -> Result<Vec<Arc<dyn ElementCode>>, CodegenError> {
        if let Some(code) = model.code.get() {
            return Ok(code.clone());
        }
        let known = self.known().clone();
        let compiled = || {
            (known.iter()).filter_map(|other| Some((&other.elaborated.classes, other.code.get()?)))
        };
        let classes = model.elaborated.classes.iter();
        let made: Result<Vec<_>, _> = classes
            .map(|class| {
                let alike = compiled().find_map(|(classes, code)| {
                    let at = classes.iter().position(|other| other.same_code(class))?;
                    code.get(at)
                });
                alike.map_or_else(|| compile_class(class, true), |code| Ok(Arc::clone(code)))
            })
            .collect();
        let made = made?;
        // another thread may have been faster, with the same code
        Ok(model.code.get_or_init(|| made).clone())
    }

    fn known(&self) -> MutexGuard<'_, Vec<Arc<SharedModel>>> {
        self.known.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Checks the names of inputs, channels and parameters that analyses state. Other stages report a model with a mistake.
    pub fn names(
        &self,
        typed: &TypedProgram,
        sources: &mut SourceMap,
        host: &dyn Host,
        plans: &[AnalysisPlan],
        diagnostics: &mut Diagnostics,
    ) {
        for plan in plans {
            let stated = plan.analysis.kind.named();
            if stated.iter().all(|(_, _, names)| names.is_empty()) {
                continue;
            }
            let (model, constants) = (plan.model, &plan.constants);
            let mut elsewhere = Diagnostics::new();
            let made = self.model(typed, sources, host, model, constants, &mut elsewhere);
            if let Some(made) = made {
                check_names(&plan.analysis, &made.elaborated.system, diagnostics);
            }
        }
    }
}
