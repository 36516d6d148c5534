//! Results of earlier rounds.

use crate::cli::outcomes::{Made, Outcomes};
use crate::cli::post;
use crate::results::stem_of;
use crate::run::RunOutcome;
use crate::sources::Stamp;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// The analyses that have ended without a failure, and the reports that were shown.
#[derive(Debug, Default)]
pub(super) struct Earlier {
    runs: BTreeMap<String, EarlierRun>,
    /// The reports, without places in the text.
    reports: Vec<String>,
}

#[derive(Debug)]
struct EarlierRun {
    /// The hash of everything that decided its numbers.
    fingerprint: String,
    outcome: RunOutcome,
    /// Its file as the run left it.
    file: Option<Stamp>,
    /// Whether tables, figures and reports of several analyses contain it.
    concluded: bool,
}

impl Earlier {
    /// The reports that were shown.
    pub fn made(&self) -> Made {
        Made {
            reports: self.reports.clone(),
            ..Made::default()
        }
    }

    /// Moves an analysis to the outcomes of a round, if its fingerprint and its file are the same as before. Returns whether they
    /// are. Otherwise it is forgotten, because it will be run again.
    pub fn hand_over(
        &mut self,
        analysis: &str,
        fingerprint: &str,
        outcomes: &mut Outcomes<'_>,
    ) -> bool {
        let Some(run) = self.runs.remove(analysis) else {
            return false;
        };
        let now = Stamp::of(&file(outcomes.folder, analysis));
        let same = run.fingerprint == fingerprint && run.file.is_some() && run.file == now;
        if same {
            if run.concluded {
                outcomes.made.analyses.insert(analysis.to_owned());
            }
            outcomes.completed.push(run.outcome);
        }
        same
    }

    /// Keeps the analyses of a round that have ended without a failure. `fingerprints` has those of all.
    pub fn keep(
        &mut self,
        outcomes: Outcomes<'_>,
        concluded: bool,
        fingerprints: &BTreeMap<String, String>,
    ) {
        let Outcomes {
            program,
            folder,
            completed,
            made,
            ..
        } = outcomes;
        if concluded {
            self.reports = program.reports().iter().map(post::identity).collect();
        }
        for outcome in completed {
            let name = outcome.results.analysis().to_owned();
            let Some(fingerprint) = fingerprints.get(&name) else {
                continue;
            };
            let run = EarlierRun {
                fingerprint: fingerprint.clone(),
                file: Stamp::of(&file(folder, &name)),
                outcome,
                concluded: concluded || made.analyses.contains(&name),
            };
            self.runs.insert(name, run);
        }
    }
}

/// The file of the results of an analysis.
fn file(folder: &Path, analysis: &str) -> PathBuf {
    folder.join(format!("{}.parquet", stem_of(analysis, false)))
}
