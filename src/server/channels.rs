//! The recorded channels of an analysis, which a report can read.

use crate::Program;
use crate::program::Bodies;
use eng_compiler::elaborate::AnalysisPlan;
use eng_system::analysis::Rows;
use eng_system::recorded::{Recorded, of_kind, of_modes, recorded};
use eng_system::system::System;
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::rc::Rc;

/// The name of an analysis or a channel without its indices: `main.force.x` for `main[2].force.x`.
pub fn without_indices(path: &str) -> String {
    let mut depth = 0usize;
    let mut plain = String::with_capacity(path.len());
    for letter in path.chars() {
        match letter {
            '[' => depth += 1,
            ']' => depth = depth.saturating_sub(1),
            _ if depth == 0 => plain.push(letter),
            _ => {}
        }
    }
    plain
}

/// A recorded channel.
struct Channel {
    /// Its path without indices.
    path: String,
    /// The unit of its numbers.
    unit: String,
}

/// The channels of one program, by its analyses. They are kept, because the model is compiled for them.
#[derive(Default)]
pub(super) struct Channels {
    /// No channels for an analysis that the program does not have, and for one whose model cannot be compiled.
    known: RefCell<BTreeMap<String, Option<Rc<[Channel]>>>>,
}

impl Channels {
    /// The next names after a path in the results of an analysis, in the order of its columns, each with the unit of the
    /// channel that ends with it; no unit for one with further names. `None` if the program has no such analysis.
    pub fn next_names(
        &self,
        program: &Program,
        analysis: &str,
        path: &[String],
    ) -> Option<Vec<(String, Option<String>)>> {
        let mut names: Vec<(String, Option<String>)> = Vec::new();
        for channel in self.of(program, analysis)?.iter() {
            let mut parts = channel.path.split('.');
            if !path.iter().all(|name| parts.next() == Some(name.as_str())) {
                continue;
            }
            if let Some(name) = parts.next()
                && names.iter().all(|(known, _)| known != name)
            {
                let ends = parts.next().is_none();
                names.push((name.to_owned(), ends.then(|| channel.unit.clone())));
            }
        }
        Some(names)
    }

    fn of(&self, program: &Program, analysis: &str) -> Option<Rc<[Channel]>> {
        let known = self.known.borrow().get(analysis).cloned();
        known.unwrap_or_else(|| {
            let read: Option<Rc<[Channel]>> = channels(program, analysis).map(Rc::from);
            let mut known = self.known.borrow_mut();
            known.insert(analysis.to_owned(), read.clone());
            read
        })
    }
}

/// The channels of an analysis, in the order of its columns.
fn channels(program: &Program, analysis: &str) -> Option<Vec<Channel>> {
    let mut analyses = program.analyses().into_iter();
    let full = analyses.find(|full| without_indices(full) == analysis)?;
    let plan = program.plan(full).ok()?;
    let model = program
        .compile(plan.model, &plan.constants, Bodies::Rigid)
        .ok()?;
    let columns = columns(&model.compiled().system, plan);
    let channel = |column: Recorded| Channel {
        path: without_indices(&column.path),
        unit: column.display.symbol,
    };
    Some(columns.into_iter().map(channel).collect())
}

fn columns(system: &System, plan: &AnalysisPlan) -> Vec<Recorded> {
    let kind = &plan.analysis.kind;
    let own = of_kind(system, kind);
    own.unwrap_or_else(|| match kind.rows() {
        Rows::Modes => of_modes(system),
        _ => recorded(system),
    })
}
