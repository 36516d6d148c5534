//! Records the motion of a run for its results: see [`crate::motion`].

use crate::cycle::SLACK;
use crate::machine::cycle_period;
use crate::motion::{SAMPLES, SUFFIX};
use crate::recorded_field::RecordedField;
use crate::results::{CYCLE_ANGLE, Column, Results, ResultsError, RowLog, display_unit};
use crate::{Analysis, Error};
use eng_runtime::Sample;
use eng_system::system::BodyInertia;
use eng_system::{Dimension, DisplayUnit};
use std::collections::{BTreeMap, VecDeque};

/// Positions, orientation, amplitudes and the numbers of fields during a run.
#[derive(Debug)]
pub(super) struct Motion {
    period: Option<f64>,
    kept: VecDeque<Moment>,
    /// All samples, if the run can be resumed.
    log: Option<RowLog>,
}

#[derive(Debug)]
struct Moment {
    time: f64,
    cycle_angle: Option<f64>,
    /// Poses of the bodies, then the numbers of the fields.
    numbers: Vec<f64>,
}

impl Moment {
    /// A moment from the numbers of a log.
    fn of_row(row: &[f64], with_cycle: bool) -> Moment {
        let (head, numbers) = row.split_at(row.len().min(1 + usize::from(with_cycle)));
        Moment {
            time: head.first().copied().unwrap_or(f64::NAN),
            cycle_angle: head.get(1).copied(),
            numbers: numbers.to_vec(),
        }
    }
}

impl Motion {
    /// The motion of a run that begins, or is resumed after a number of samples.
    pub fn begin(analysis: &Analysis, resumed: Option<u64>) -> Result<Motion, Error> {
        let mut motion = Motion::of(analysis);
        if let Some(folder) = analysis.recorded_to() {
            let header = log_columns_of(analysis)?;
            let with_cycle = analysis.model().compiled().system.cycle.is_some();
            let log = match resumed {
                None => RowLog::create(folder, &header)?,
                Some(samples) => RowLog::resume(folder, &header, samples, |row| {
                    motion.keep(Moment::of_row(row, with_cycle));
                })?,
            };
            motion.log = Some(log);
        }
        Ok(motion)
    }

    /// The motion of a complete run that was killed before its motion was written; `None` if it was written.
    pub fn left(
        analysis: &Analysis,
        metadata: &BTreeMap<String, String>,
    ) -> Result<Option<Results>, Error> {
        let Some(folder) = analysis.recorded_to() else {
            return Ok(None);
        };
        let mut motion = Motion::of(analysis);
        let with_cycle = analysis.model().compiled().system.cycle.is_some();
        let found = RowLog::left(folder, &name_of(analysis), |row| {
            motion.keep(Moment::of_row(row, with_cycle));
        })?;
        match found {
            true => motion.results(analysis, metadata).map(Some),
            false => Ok(None),
        }
    }

    fn of(analysis: &Analysis) -> Motion {
        // the run reports parameters that cannot be bound
        let bound = analysis.bound().ok();
        let period = bound.and_then(|b| cycle_period(&analysis.model().compiled().system, &b));
        Motion {
            period: period.filter(|p| *p > 0.0),
            kept: VecDeque::new(),
            log: None,
        }
    }

    /// Adds a sample.
    pub fn push(&mut self, sample: &Sample<'_>) -> Result<(), ResultsError> {
        if let Some(log) = &mut self.log {
            let row = std::iter::once(sample.time)
                .chain(sample.cycle_angle)
                .chain(sample.pose.iter().copied())
                .chain(sample.fields.iter().copied());
            log.push(row)?;
        }
        self.keep(Moment {
            time: sample.time,
            cycle_angle: sample.cycle_angle,
            numbers: [sample.pose, sample.fields].concat(),
        });
        Ok(())
    }

    /// Keeps a moment, and drops those more than a cycle earlier.
    fn keep(&mut self, moment: Moment) {
        if let (Some(period), Some(now)) = (self.period, moment.cycle_angle) {
            let old = |moment: &Moment| {
                moment
                    .cycle_angle
                    .is_some_and(|angle| (now - angle).abs() > period + SLACK)
            };
            while self.kept.front().is_some_and(old) {
                self.kept.pop_front();
            }
        }
        self.kept.push_back(moment);
    }

    /// Writes all samples to disk. It comes before a checkpoint that counts them, and before the results are
    /// complete.
    pub fn save(&mut self) -> Result<(), ResultsError> {
        match &mut self.log {
            Some(log) => log.save(),
            None => Ok(()),
        }
    }

    /// The motion as columns, with the metadata of the run. If the run has a folder, they are written there,
    /// and the log ends.
    pub fn results(
        mut self,
        analysis: &Analysis,
        metadata: &BTreeMap<String, String>,
    ) -> Result<Results, Error> {
        let samples = self.kept.len();
        let every = samples.saturating_sub(1).div_ceil(SAMPLES).max(1);
        let last = samples.saturating_sub(1);
        let kept: Vec<Moment> = self
            .kept
            .drain(..)
            .enumerate()
            .filter(|(index, _)| (last - index).is_multiple_of(every))
            .map(|(_, moment)| moment)
            .collect();
        let header = columns_of(analysis)?;
        let mut results = header.without_columns();
        for (key, value) in metadata {
            results.set_metadata(key, value);
        }
        let span = if self.period.is_some() {
            "the last cycle"
        } else {
            "the whole run"
        };
        let kept_samples = match every {
            1 => "every sample".to_owned(),
            every => format!("one of {every} samples"),
        };
        results.set_metadata("motion", format!("{span}, {kept_samples}"));
        let head = 1 + usize::from(header.column(CYCLE_ANGLE).is_some());
        for (index, column) in header.columns().iter().enumerate() {
            let value = |moment: &Moment| match index {
                0 => Some(moment.time),
                1 if head == 2 => moment.cycle_angle,
                _ => moment.numbers.get(index - head).copied(),
            };
            results.push(Column {
                values: kept
                    .iter()
                    .map(|moment| value(moment).unwrap_or(f64::NAN))
                    .collect(),
                ..column.clone()
            })?;
        }
        if let Some(folder) = analysis.recorded_to() {
            if results.samples() > 0 {
                results.write_parquet(folder)?;
            }
            drop(self.log.take());
            RowLog::remove(folder, &name_of(analysis))?;
        }
        Ok(results)
    }
}

fn name_of(analysis: &Analysis) -> String {
    format!("{}{SUFFIX}", analysis.name())
}

/// The columns without values: time, the cycle's angle, the columns of each body in the order of a pose, and
/// those of the fields.
fn columns_of(analysis: &Analysis) -> Result<Results, Error> {
    let compiled = analysis.model().compiled();
    let mut header = Results::new(name_of(analysis), analysis.model().name());
    header.push(Column::time(Vec::new()))?;
    if compiled.system.cycle.is_some() {
        header.push(Column::cycle_angle(Vec::new()))?;
    }
    for body in &compiled.system.bodies {
        let modes = match body.inertia {
            BodyInertia::Rigid { .. } => 0,
            BodyInertia::Flexible(index) => compiled
                .reduced
                .get(index as usize)
                .map_or(0, |reduced| reduced.invariants.modes),
        };
        let path = &body.origin.path;
        let mut push = |name: String, dimension: Dimension, unit: &str, frame: &str| {
            header.push(Column {
                path: format!("{path}.{name}"),
                dimension,
                display: display_unit(unit, 1.0),
                frame: frame.to_owned(),
                values: Vec::new(),
            })
        };
        for axis in ["x", "y", "z"] {
            push(format!("position.{axis}"), Dimension::LENGTH, "m", "ground")?;
        }
        for part in ["w", "x", "y", "z"] {
            push(format!("orientation.{part}"), Dimension::ONE, "1", "ground")?;
        }
        for mode in 1..=modes {
            push(format!("amplitude[{mode}]"), Dimension::ONE, "1", "")?;
        }
    }
    for (path, dimension) in analysis.fields()?.iter().flat_map(RecordedField::columns) {
        header.push(Column {
            path,
            dimension,
            display: DisplayUnit::si(dimension),
            frame: String::new(),
            values: Vec::new(),
        })?;
    }
    Ok(header)
}

/// [`columns_of`], all shown in SI.
fn log_columns_of(analysis: &Analysis) -> Result<Results, Error> {
    let header = columns_of(analysis)?;
    let mut plain = header.without_columns();
    for column in header.columns() {
        plain.push(Column {
            display: DisplayUnit::si(column.dimension),
            ..column.clone()
        })?;
    }
    Ok(plain)
}
