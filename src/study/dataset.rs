//! The folder of a study: its parts, the parts that are computed, and all points together.

use super::journal::{self, Begun};
use super::numbers::COMPLETE;
use super::{Manifest, StudyError};
use crate::regular;
use crate::results::{
    POINTS, PointRow, PointTable, Results, ResultsError, file_stem, replace_file,
};
use std::collections::BTreeMap;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime, UNIX_EPOCH};

const MANIFEST: &str = "study.json";
const PART: &str = "part-";
const WHOLE: &str = ".parquet";
const BEGUN: &str = ".points";

/// The folder of a study.
#[derive(Clone, Debug)]
pub struct Dataset {
    /// The folder around it, with the results of the model.
    around: PathBuf,
    folder: PathBuf,
    analysis: String,
    pub(super) manifest: Manifest,
}

/// A file of a part, whole or begun.
#[derive(Clone, Debug)]
pub(super) struct PartFile {
    pub path: PathBuf,
    pub from: u64,
    pub to: u64,
    pub whole: bool,
}

/// The rows of points, by the point.
pub(super) type Rows = BTreeMap<u64, Vec<PointRow>>;

/// How far a study is.
#[derive(Clone, Debug)]
pub struct Standing {
    /// The analysis and its model's file.
    pub analysis: String,
    /// The model's file.
    pub file: String,
    /// All points.
    pub points: usize,
    /// Points that ended well.
    pub complete: usize,
    /// Points that failed or were stopped, by code and message, the most frequent first.
    pub failures: Vec<Failure>,
    /// Parts that are computed, or whose process was killed.
    pub workers: Vec<Worker>,
    /// Ranges of the points that have not ended, each from its first to its last.
    pub missing: Vec<(u64, u64)>,
    /// Time until all have ended at the rate so far, while a process computes.
    pub left: Option<Duration>,
}

/// Points that failed alike.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Failure {
    /// `E0711`.
    pub code: String,
    /// Message of the first of them.
    pub message: String,
    /// Place of the first of them.
    pub place: String,
    /// The points.
    pub points: Vec<u64>,
}

/// A process that computes a part.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Worker {
    /// First and last point of its part.
    pub range: (u64, u64),
    /// Points of it that have ended.
    pub ended: usize,
    /// Whether it runs, as far as locks show; else it was killed or stopped.
    pub runs: bool,
    /// The machine and the number of the process.
    pub place: Option<(String, u32)>,
}

/// A collected study.
#[derive(Clone, Debug)]
pub struct Collected {
    /// The written file.
    pub path: PathBuf,
    /// Points in it.
    pub points: usize,
    /// Points in it that failed or were stopped.
    pub failures: Vec<Failure>,
}

fn file_error(path: &Path) -> impl FnOnce(io::Error) -> StudyError + '_ {
    move |source| {
        let path = path.to_owned();
        ResultsError::File { path, source }.into()
    }
}

impl Dataset {
    /// The folder of an analysis's study among results.
    fn place(around: &Path, analysis: &str) -> PathBuf {
        around.join(file_stem(analysis))
    }

    /// Opens the folder of a study, and makes it if there is none.
    ///
    /// # Errors
    /// A folder with another study.
    pub(super) fn of_study(around: &Path, manifest: &Manifest) -> Result<Dataset, StudyError> {
        let dataset = Dataset {
            around: around.to_owned(),
            folder: Dataset::place(around, &manifest.analysis),
            analysis: manifest.analysis.clone(),
            manifest: manifest.clone(),
        };
        let path = dataset.folder.join(MANIFEST);
        match read_manifest(&path)? {
            Some(found) if found.identity == manifest.identity => {}
            Some(found) => {
                return Err(StudyError::Other {
                    path: dataset.folder,
                    message: format!(
                        "it has points of another study: {}; choose another folder by --out, or remove this one",
                        difference(&found, manifest)
                    ),
                });
            }
            None => {
                let text = serde_json::to_vec_pretty(manifest);
                let text = text.map_err(|error| file_error(&path)(error.into()))?;
                // processes that begin together write the same bytes
                replace_file(&path, |file| file.write_all(&text)).map_err(file_error(&path))?;
            }
        }
        Ok(dataset)
    }

    /// Opens the folder of a study that was begun.
    ///
    /// # Errors
    /// No study of this analysis in the folder.
    pub fn open(around: &Path, analysis: &str) -> Result<Dataset, StudyError> {
        let folder = Dataset::place(around, analysis);
        let manifest = read_manifest(&folder.join(MANIFEST))?;
        let Some(manifest) = manifest else {
            let known = Dataset::all(around)?;
            let message = match known.is_empty() {
                true => "no study was begun in this folder; `eng run … --slice 1/N` begins one"
                    .to_owned(),
                false => format!("it has no study of {analysis}; it has {}", known.join(", ")),
            };
            let path = around.to_owned();
            return Err(StudyError::Other { path, message });
        };
        Ok(Dataset {
            around: around.to_owned(),
            folder,
            analysis: manifest.analysis.clone(),
            manifest,
        })
    }

    /// The analyses with a study in a folder.
    pub fn all(around: &Path) -> Result<Vec<String>, StudyError> {
        let mut found = Vec::new();
        for entry in std::fs::read_dir(around).map_err(file_error(around))? {
            let path = entry.map_err(file_error(around))?.path().join(MANIFEST);
            if let Some(manifest) = read_manifest(&path)? {
                found.push(manifest.analysis);
            }
        }
        found.sort();
        Ok(found)
    }

    /// The file of a whole part.
    pub(super) fn part(&self, from: u64, to: u64) -> PathBuf {
        self.folder.join(format!("{PART}{from:05}-{to:05}{WHOLE}"))
    }

    /// The file of a part that is computed.
    pub(super) fn journal(&self, from: u64, to: u64) -> PathBuf {
        self.folder.join(format!("{PART}{from:05}-{to:05}{BEGUN}"))
    }

    /// The files of parts, in the order of their first points.
    pub(super) fn files(&self) -> Result<Vec<PartFile>, StudyError> {
        let mut files = Vec::new();
        for entry in std::fs::read_dir(&self.folder).map_err(file_error(&self.folder))? {
            let path = entry.map_err(file_error(&self.folder))?.path();
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            let range = |ending: &str| {
                let (from, to) = name
                    .strip_prefix(PART)?
                    .strip_suffix(ending)?
                    .split_once('-')?;
                Some((from.parse().ok()?, to.parse().ok()?))
            };
            let whole = range(WHOLE);
            if let Some((from, to)) = whole.or_else(|| range(BEGUN)) {
                let whole = whole.is_some();
                files.push(PartFile {
                    path,
                    from,
                    to,
                    whole,
                });
            }
        }
        files.sort_by_key(|file| (file.from, file.to, file.whole));
        Ok(files)
    }

    /// The rows of a part, and its columns if it is whole. A part that was replaced in between has none.
    pub(super) fn rows(
        &self,
        file: &PartFile,
    ) -> Result<(Vec<PointRow>, Option<Results>), StudyError> {
        let other = |message: String| StudyError::Other {
            path: file.path.clone(),
            message,
        };
        if !file.whole {
            let contents = match journal::read(&file.path) {
                Err(_) if !file.path.exists() => return Ok((Vec::new(), None)),
                read => read?,
            };
            let study = contents.begun.map(|begun| begun.study);
            if study.is_some_and(|study| study != self.manifest.identity) {
                return Err(other(self.foreign("")));
            }
            let rows = contents.points.into_iter().flat_map(|point| point.rows);
            return Ok((rows.collect(), None));
        }
        let table = match PointTable::read(&file.path) {
            Err(_) if !file.path.exists() => return Ok((Vec::new(), None)),
            // a run does not replace a part that it cannot read
            Err(
                ResultsError::Damaged { problem, .. }
                | ResultsError::Foreign {
                    message: problem, ..
                },
            ) => {
                let (from, to) = (file.from, file.to);
                return Err(other(format!(
                    "{problem}; remove this file, and run the points {from}..{to} again"
                )));
            }
            read => read?,
        };
        let metadata = table.header.metadata();
        if metadata.get("study") != Some(&self.manifest.identity) {
            let differs = [
                ("version", &self.manifest.version),
                ("source_hash", &self.manifest.source_hash),
            ];
            let reason = differs
                .iter()
                .find(|(key, value)| metadata.get(*key) != Some(value));
            return Err(other(self.foreign(match reason {
                Some(("version", _)) => ", of another version of Eng",
                Some(_) => ", of another text of the model",
                None => ", with other points or settings",
            })));
        }
        Ok((table.rows, Some(table.header)))
    }

    fn foreign(&self, detail: &str) -> String {
        format!(
            "this is a part of another study{detail}; move it away, and run its points again for {}",
            self.analysis
        )
    }

    /// The rows of all points that have ended, and the columns of the whole parts. If several parts have a point, the row that
    /// ended well counts.
    ///
    /// # Errors
    /// Parts of another study; two rows that differ.
    fn all_rows(&self) -> Result<(Rows, Option<Results>), StudyError> {
        let (mut rows, mut header): (Rows, Option<Results>) = (Rows::new(), None);
        for file in self.files()? {
            let (found, columns) = self.rows(&file)?;
            let same = |known: &Results, own: &Results| known.columns() == own.columns();
            match (&header, columns) {
                (Some(known), Some(own)) if !same(known, &own) => {
                    return Err(StudyError::Other {
                        path: file.path,
                        message: self.foreign(", with other columns"),
                    });
                }
                (None, Some(own)) => header = Some(own),
                _ => {}
            }
            merge(&mut rows, found).map_err(|point| StudyError::Other {
                path: file.path.clone(),
                message: format!(
                    "point {point} has other numbers here than in another part; move one of both away"
                ),
            })?;
        }
        Ok((rows, header))
    }

    /// The progress of the study, from its files alone.
    ///
    /// # Errors
    /// Files that cannot be read.
    pub fn standing(&self) -> Result<Standing, StudyError> {
        let (rows, _) = self.all_rows()?;
        let mut workers = Vec::new();
        let mut ends: Vec<u64> = Vec::new();
        for file in self.files()? {
            if file.whole {
                let written = std::fs::metadata(&file.path).and_then(|found| found.modified());
                ends.extend(written.ok().and_then(seconds));
                continue;
            }
            let Ok(contents) = journal::read(&file.path) else {
                continue;
            };
            ends.extend(contents.points.iter().map(|point| point.at));
            let place = |begun: Begun| (begun.host, begun.process);
            workers.push(Worker {
                range: (file.from, file.to),
                ended: contents.points.len(),
                runs: journal::is_running(&file.path),
                place: contents.begun.map(place),
            });
        }
        let begun =
            std::fs::metadata(self.folder.join(MANIFEST)).and_then(|found| found.modified());
        let points = self.manifest.points;
        let missing = ranges((1..=points).filter(|point| !rows.contains_key(point)));
        let rest = points - rows.len() as u64;
        let left = match (begun.ok().and_then(seconds), ends.iter().max()) {
            (Some(begun), Some(last))
                if *last > begun && workers.iter().any(|worker| worker.runs) =>
            {
                let pace = (last - begun) as f64 / rows.len().max(1) as f64;
                Some(Duration::from_secs_f64(pace * rest as f64))
            }
            _ => None,
        };
        let failures = failures(&rows);
        let failed: usize = failures.iter().map(|failure| failure.points.len()).sum();
        Ok(Standing {
            analysis: self.analysis.clone(),
            file: self.manifest.file.clone(),
            points: points as usize,
            complete: rows.len() - failed,
            failures,
            workers,
            missing,
            left: left.filter(|_| rest > 0),
        })
    }

    /// Writes `ANALYSIS.points.parquet` with all points in their order. `partial` allows missing points.
    ///
    /// # Errors
    /// Missing points; parts of another study; failures of the disk.
    pub fn collect(&self, partial: bool) -> Result<Collected, StudyError> {
        let (rows, header) = self.all_rows()?;
        let points = self.manifest.points;
        let missing = (1..=points).filter(|point| !rows.contains_key(point));
        let missing: Vec<u64> = missing.collect();
        if !missing.is_empty() && !partial {
            return Err(StudyError::Missing {
                missing: missing.len(),
                points: points as usize,
                ranges: in_words(&ranges(missing.iter().copied())),
            });
        }
        let Some(header) = header else {
            return Err(StudyError::Points(format!(
                "{}: no part of {} has ended yet",
                self.folder.display(),
                self.analysis
            )));
        };
        let path = self
            .around
            .join(format!("{}{POINTS}", file_stem(&self.analysis)));
        let collected = Collected {
            path: path.clone(),
            points: rows.len(),
            failures: failures(&rows),
        };
        let rows = rows.into_values().flatten().collect();
        PointTable { header, rows }.write(&path)?;
        Ok(collected)
    }
}

/// Adds rows of points. The error is a point with other numbers before.
pub(super) fn merge(rows: &mut Rows, found: Vec<PointRow>) -> Result<(), u64> {
    let mut added = Rows::new();
    for row in found {
        added.entry(row.point).or_default().push(row);
    }
    for (point, own) in added {
        let complete = |rows: &[PointRow]| rows.iter().all(|row| row.state == COMPLETE);
        match rows.get(&point) {
            Some(known) if complete(known) && complete(&own) && *known != own => return Err(point),
            Some(known) if complete(known) => {}
            _ => {
                rows.insert(point, own);
            }
        }
    }
    Ok(())
}

/// The points that did not end well, by code, the most frequent first.
pub(super) fn failures(rows: &Rows) -> Vec<Failure> {
    let mut found: Vec<Failure> = Vec::new();
    for row in rows.values().filter_map(|rows| rows.first()) {
        if row.state == COMPLETE {
            continue;
        }
        let known = found.iter_mut().find(|failure| failure.code == row.code);
        match known {
            Some(failure) => failure.points.push(row.point),
            None => found.push(Failure {
                code: row.code.clone(),
                message: row.message.clone(),
                place: row.place.clone(),
                points: vec![row.point],
            }),
        }
    }
    found.sort_by_key(|failure| std::cmp::Reverse(failure.points.len()));
    found
}

/// Ranges of neighbouring points.
fn ranges(points: impl Iterator<Item = u64>) -> Vec<(u64, u64)> {
    let mut found: Vec<(u64, u64)> = Vec::new();
    for point in points {
        match found.last_mut() {
            Some((_, last)) if *last + 1 == point => *last = point,
            _ => found.push((point, point)),
        }
    }
    found
}

/// Most ranges that a message names. A choice.
const MOST_RANGES: usize = 8;

/// `1..64, 80`.
pub(crate) fn in_words(ranges: &[(u64, u64)]) -> String {
    let shown = ranges.iter().take(MOST_RANGES);
    let mut texts: Vec<String> = shown
        .map(|(from, to)| match from == to {
            true => from.to_string(),
            false => format!("{from}..{to}"),
        })
        .collect();
    if ranges.len() > MOST_RANGES {
        texts.push("…".to_owned());
    }
    texts.join(", ")
}

/// `1..64, 80`, of points in their order.
pub(crate) fn points_in_words(points: &[u64]) -> String {
    in_words(&ranges(points.iter().copied()))
}

fn seconds(at: SystemTime) -> Option<u64> {
    Some(at.duration_since(UNIX_EPOCH).ok()?.as_secs())
}

fn read_manifest(path: &Path) -> Result<Option<Manifest>, StudyError> {
    let absent = [io::ErrorKind::NotFound, io::ErrorKind::NotADirectory];
    let bytes = match regular::read(path) {
        Err(error) if absent.contains(&error.kind()) => return Ok(None),
        read => read.map_err(file_error(path))?,
    };
    let manifest = serde_json::from_slice(&bytes);
    manifest.map(Some).map_err(|error| StudyError::Other {
        path: path.to_owned(),
        message: format!(
            "it is damaged ({error}); run a slice with another --out, or restore the file"
        ),
    })
}

/// The difference between two studies in words.
fn difference(found: &Manifest, own: &Manifest) -> String {
    if found.version != own.version {
        return format!(
            "version {} of Eng made them, this is {}",
            found.version, own.version
        );
    }
    if found.source_hash != own.source_hash {
        return "the text of the model has changed".to_owned();
    }
    if found.points != own.points {
        return format!("there were {} points and are {}", found.points, own.points);
    }
    match own.design.is_some() {
        true => "values of the design, settings or meshes have changed".to_owned(),
        false => "settings or meshes have changed".to_owned(),
    }
}
