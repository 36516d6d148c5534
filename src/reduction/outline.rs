//! Flexible bodies of a model that is only checked: read, not reduced.

use super::{Files, mesh_of, reduction_failed, request, sense};
use crate::Sources;
use eng_flexible::reduce::{Outline, outline};
use eng_grammar::Diagnostic;
use eng_system::flexible::FlexibleSource;
use std::sync::{Arc, Mutex, PoisonError};

/// Outlines of the bodies of a program, each made once, however many models and analyses have it.
#[derive(Debug, Default)]
pub(crate) struct Outlines {
    known: Mutex<Vec<(String, Arc<Outline>)>>,
}

impl Outlines {
    /// Reads a body's mesh and matrices. `turned` says which markers an element turns.
    pub(crate) fn outline(
        &self,
        sources: &Sources,
        source: &FlexibleSource,
        turned: &[bool],
    ) -> Result<Arc<Outline>, Box<Diagnostic>> {
        let key = format!("{} {:?}", request::text(source), request::files(source));
        let known = {
            let known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
            let found = known.iter().find(|(text, _)| *text == key);
            found.map(|(_, outline)| Arc::clone(outline))
        };
        let found = match known {
            Some(found) => found,
            None => {
                let files: &dyn Files = sources;
                let mesh = mesh_of(files, source)?;
                if let Some(refusal) = sense::refusal(&mesh, source) {
                    return Err(refusal);
                }
                let request = request::request(source, files)?;
                let made = outline(mesh, &request).map_err(|e| reduction_failed(&e, source))?;
                let made = Arc::new(made);
                let mut known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
                known.push((key, Arc::clone(&made)));
                made
            }
        };
        sense::bare_markers(&found.turns, source, turned)?;
        Ok(found)
    }
}
