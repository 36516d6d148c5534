//! Runs a slice of a study.

use super::dataset::{Dataset, PartFile, Rows, failures, merge};
use super::journal::{Journal, is_running};
use super::numbers::{COMPLETE, identity};
use super::{Failure, Prepare, Study, StudyError};
use crate::analysis::Analysis;
use crate::results::{PointTable, remove_leftovers};
use crate::run::{Event, run_many};
use std::collections::BTreeSet;
use std::num::NonZeroUsize;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

/// Settings of a slice that change no number.
#[derive(Clone, Copy, Debug)]
pub struct SliceOptions {
    /// Compute the points that failed or were stopped, too.
    pub again: bool,
    /// See [`crate::run::run`].
    pub patient: bool,
    /// Points at the same time.
    pub threads: NonZeroUsize,
}

/// Gets the events of a slice's runs: their number from 0, and the name of the point.
pub type OnEvent<'e> = &'e mut dyn FnMut(usize, &str, &Event);

/// A computed part.
#[derive(Clone, Debug)]
pub struct PartOutcome {
    /// The written file; absent if all points were in parts before.
    pub path: Option<PathBuf>,
    /// First and last point.
    pub range: (u64, u64),
    /// Points that were computed now.
    pub computed: usize,
    /// Points that failed or were stopped.
    pub failures: Vec<Failure>,
}

impl Study {
    /// Begins or continues the study in a folder of results.
    ///
    /// # Errors
    /// Points of another study in the folder; a folder that cannot be written.
    pub fn dataset(&self, around: &Path) -> Result<Dataset, StudyError> {
        Dataset::of_study(around, &self.manifest)
    }

    /// The points of slice `index` of `count`, from 1. The slices have equal lengths up to one point.
    pub fn slice(&self, index: usize, count: usize) -> (usize, usize) {
        let count = count.max(1) as u128;
        let bound = |slices: usize| (slices as u128 * self.points() as u128 / count) as usize;
        (bound(index.saturating_sub(1)) + 1, bound(index))
    }

    /// A part by its first and last point, counted from 1.
    ///
    /// # Errors
    /// Points that the study does not have.
    pub fn part(&self, from: usize, to: usize) -> Result<(usize, usize), StudyError> {
        let (name, all) = (self.analysis(), self.points());
        match from >= 1 && from <= to && to <= all {
            true => Ok((from, to)),
            false => Err(StudyError::Points(format!(
                "{name} has the points 1..{all}, not {from}..{to}"
            ))),
        }
    }

    /// The parts of a study with points that failed or were stopped.
    pub fn failed_parts(&self, dataset: &Dataset) -> Result<Vec<(usize, usize)>, StudyError> {
        let mut found = Vec::new();
        for file in dataset.files()?.iter().filter(|file| file.whole) {
            let (rows, _) = dataset.rows(file)?;
            if rows.iter().any(|row| row.state != COMPLETE) {
                found.push((file.from as usize, file.to as usize));
            }
        }
        Ok(found)
    }

    /// Computes the points `from..=to` that are not there, and writes their part. `again` computes also those that failed.
    /// A killed call leaves the points that have ended, and the next one takes them.
    ///
    /// # Errors
    /// A failure of the system, a part that another process computes, parts of another study; those of `prepare`. A
    /// point that fails is no error.
    pub fn run<E: From<StudyError>>(
        &self,
        dataset: &Dataset,
        (from, to): (usize, usize),
        options: SliceOptions,
        prepare: Prepare<'_, E>,
        on_event: OnEvent<'_>,
    ) -> Result<PartOutcome, E> {
        self.part(from, to)?;
        let analyses = self.analyses(from, to, prepare)?;
        let slice = Slice {
            study: self,
            dataset,
            first: from as u64,
            last: to as u64,
            identities: analyses.iter().map(identity).collect(),
            again: options.again,
        };
        Ok(slice.run(&analyses, options, on_event)?)
    }
}

/// The points of a part.
struct Slice<'s> {
    study: &'s Study,
    dataset: &'s Dataset,
    first: u64,
    last: u64,
    /// Identities of its points.
    identities: Vec<String>,
    again: bool,
}

impl Slice<'_> {
    fn run(
        &self,
        analyses: &[Analysis],
        options: SliceOptions,
        on_event: OnEvent<'_>,
    ) -> Result<PartOutcome, StudyError> {
        let (dataset, first, last) = (self.dataset, self.first, self.last);
        let mut outcome = PartOutcome {
            path: None,
            range: (first, last),
            computed: 0,
            failures: Vec::new(),
        };
        let (rows, whole) = self.known()?;
        if whole {
            outcome.failures = failures(&rows);
            return Ok(outcome);
        }
        let study = &self.study.manifest.identity;
        let mut journal = Journal::open(&dataset.journal(first, last), study)?;
        // another process may have ended this part before the lock was taken
        let (mut rows, _) = self.known()?;
        let due: Vec<usize> = (0..analyses.len())
            .filter(|index| !rows.contains_key(&(first + *index as u64)))
            .collect();
        let runs = due.iter().filter_map(|index| analyses.get(*index));
        let runs: Vec<Analysis> = runs.cloned().collect();
        let mut refused = None;
        run_many(
            &runs,
            options.patient,
            options.threads,
            &mut |index, event| {
                let (Some(analysis), Some(due)) = (runs.get(index), due.get(index)) else {
                    return ControlFlow::Break(());
                };
                let point = first + *due as u64;
                on_event(index, &format!("point {point}"), &event);
                let Event::Done(ended) = event else {
                    return ControlFlow::Continue(());
                };
                let own = self.study.rows(point, analysis, *ended);
                let kept = own.and_then(|own| {
                    journal.push(own.clone())?;
                    rows.insert(point, own);
                    Ok(())
                });
                match kept {
                    Ok(()) => ControlFlow::Continue(()),
                    Err(error) => {
                        refused.get_or_insert(error);
                        ControlFlow::Break(())
                    }
                }
            },
        );
        if let Some(error) = refused {
            return Err(error);
        }
        outcome.computed = runs.len();
        outcome.failures = failures(&rows);
        let table = PointTable {
            header: self.study.header.clone(),
            rows: rows.into_values().flatten().collect(),
        };
        let path = dataset.part(first, last);
        table.write(&path)?;
        remove_leftovers(&path);
        outcome.path = Some(path);
        journal.remove()?;
        self.remove_inside()?;
        Ok(outcome)
    }

    /// The rows that are there for its points, and whether whole parts have all of them.
    fn known(&self) -> Result<(Rows, bool), StudyError> {
        let (first, last) = (self.first, self.last);
        let (mut known, mut whole) = (Rows::new(), BTreeSet::new());
        for file in self.dataset.files()? {
            if file.to < first || file.from > last {
                continue;
            }
            let (mut rows, _) = self.dataset.rows(&file)?;
            rows.retain(|row| {
                let due = self.again && row.state != COMPLETE;
                (first..=last).contains(&row.point) && !due
            });
            let other = |point: u64, message: &str| StudyError::Other {
                path: file.path.clone(),
                message: format!("point {point} {message}; move it away, and run its points again"),
            };
            for row in &rows {
                let own = self.identities.get((row.point - first) as usize);
                if own.is_some_and(|own| *own != row.identity) {
                    return Err(other(row.point, "was computed from other files than now"));
                }
            }
            if file.whole {
                whole.extend(rows.iter().map(|row| row.point));
            }
            merge(&mut known, rows)
                .map_err(|point| other(point, "has other numbers here than in another part"))?;
        }
        Ok((known, whole.len() == self.identities.len()))
    }

    /// Removes the parts of other slicings whose points a part has.
    fn remove_inside(&self) -> Result<(), StudyError> {
        let (first, last) = (self.first, self.last);
        let inside = |file: &PartFile| {
            let same = (file.from, file.to) == (first, last);
            !same
                && file.from >= first
                && file.to <= last
                && (file.whole || !is_running(&file.path))
        };
        for file in self.dataset.files()?.iter().filter(|file| inside(file)) {
            // one that stays has the same rows
            let _ = std::fs::remove_file(&file.path);
        }
        Ok(())
    }
}
