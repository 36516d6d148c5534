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
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

/// A model with its constants.
#[derive(Debug)]
pub struct SharedModel {
    definition: DefinitionId,
    constants: Vec<(String, Structural)>,
    /// The flat system with its graphs.
    pub elaborated: Elaborated,
    code: OnceLock<Vec<Arc<dyn ElementCode>>>,
}

impl SharedModel {
    /// The code of each class, compiled at the first call.
    pub fn code(&self) -> Result<&[Arc<dyn ElementCode>], CodegenError> {
        if let Some(code) = self.code.get() {
            return Ok(code);
        }
        let classes = self.elaborated.classes.iter();
        let made: Result<Vec<_>, _> = classes.map(|class| compile_class(class, true)).collect();
        let made = made?;
        // another thread may have been faster, with the same code
        Ok(self.code.get_or_init(|| made))
    }
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
        let known = || self.known.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(model) = known().iter().find(same) {
            return Some(Arc::clone(model));
        }
        let elaborated = elaborate(typed, sources, host, definition, constants, diagnostics)?;
        let made = Arc::new(SharedModel {
            definition,
            constants: constants.to_vec(),
            elaborated,
            code: OnceLock::new(),
        });
        known().push(Arc::clone(&made));
        Some(made)
    }

    /// Checks the names of inputs and channels that analyses state. Other stages report a model with a mistake.
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
