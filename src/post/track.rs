//! Signals with their samples.

use super::PostError;
use crate::cycle::shifted;
use eng_report::signal::{Interpolation, SignalError, resample};
use eng_system::expression::Member;
use std::rc::Rc;

/// The samples of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Samples {
    /// The analysis.
    pub analysis: String,
    /// Time (s); the numbers of the modes for a linear analysis; the frequencies (Hz) of a response.
    pub time: Vec<f64>,
    /// Cycle angle (rad), if there is a cycle.
    pub angle: Option<Vec<f64>>,
    /// Rate of the cycle angle (rad/s), if there is a cycle.
    pub speed: Option<Vec<f64>>,
    /// Period of the cycle (rad), if there is a cycle.
    pub period: Option<f64>,
    /// Whether they are whole cycles: the last sample is the first of the next.
    pub whole: bool,
    /// Whether the irregular sample at the end of the run was left out.
    pub shortened: bool,
    /// The derivatives of the samples by a parameter, if signals have them.
    pub shifts: Option<Shifts>,
}

/// The derivatives of the places of samples by a parameter (SI).
#[derive(Clone, Debug, PartialEq)]
pub struct Shifts {
    /// Those of the times.
    pub time: Vec<f64>,
    /// Those of the cycle angles; empty without a cycle.
    pub angle: Vec<f64>,
}

/// Largest difference between the samples of two runs, as a share of the distance of samples. A choice, as
/// for the grid of a spectrum.
const ALIKE: f64 = 1e-4;

impl Samples {
    /// The samples from an index on.
    pub fn from(&self, first: usize) -> Samples {
        self.part(|values| values.get(first..).unwrap_or_default())
    }

    fn part(&self, of: impl Fn(&[f64]) -> &[f64]) -> Samples {
        let of = |values: &Vec<f64>| of(values).to_vec();
        Samples {
            analysis: self.analysis.clone(),
            time: of(&self.time),
            angle: self.angle.as_ref().map(of),
            speed: self.speed.as_ref().map(of),
            period: self.period,
            whole: false,
            shortened: self.shortened,
            shifts: self.shifts.as_ref().map(|shifts| Shifts {
                time: of(&shifts.time),
                angle: of(&shifts.angle),
            }),
        }
    }

    /// The same samples as whole cycles of a period (rad), with the whole `length` (rad). Their angle counts
    /// from the beginning of a cycle.
    pub fn of_cycles(mut self, period: f64, length: f64) -> Samples {
        self.angle = self.angle.map(|angle| shifted(angle, Some(period)));
        self.whole = self.cover(length);
        self
    }

    /// Whether they cover an angle (rad) within a thousandth of their distance. A choice: far above the
    /// rounding of an unwrapped angle, and far below a missing sample.
    pub fn cover(&self, angle: f64) -> bool {
        let Some(own) = &self.angle else { return false };
        let (Some(first), Some(last)) = (own.first(), own.last()) else {
            return false;
        };
        let step = angle / own.len().saturating_sub(1).max(1) as f64;
        ((last - first).abs() - angle).abs() <= 1e-3 * step
    }

    /// The difference of the samples of two runs; `None` if they have the same crank angles or the same
    /// times.
    pub fn differ(&self, other: &Samples) -> Option<String> {
        if self.time.len() != other.time.len() {
            return Some(format!(
                "{} samples against {}",
                self.time.len(),
                other.time.len()
            ));
        }
        let same = |a: &[f64], b: &[f64]| first_apart(a, b).is_none();
        if let (Some(a), Some(b)) = (&self.angle, &other.angle)
            && same(a, b)
        {
            return None;
        }
        let apart = first_apart(&self.time, &other.time)?;
        let at = |values: &[f64]| values.get(apart).copied().unwrap_or(f64::NAN);
        Some(format!(
            "sample {} at {:.6} s against {:.6} s{}",
            apart + 1,
            at(&self.time),
            at(&other.time),
            if self.angle.is_some() {
                ", and at other crank angles"
            } else {
                ""
            }
        ))
    }
}

/// The first index at which two lists differ by more than rounding.
fn first_apart(a: &[f64], b: &[f64]) -> Option<usize> {
    let span = match (a.first(), a.last()) {
        (Some(first), Some(last)) => (last - first).abs(),
        _ => return None,
    };
    let slack = ALIKE * span / a.len().saturating_sub(1).max(1) as f64;
    a.iter().zip(b).position(|(a, b)| (a - b).abs() > slack)
}

/// A signal.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Track {
    pub samples: Rc<Samples>,
    /// Values in SI, one for each sample.
    pub values: Vec<f64>,
}

impl Track {
    /// The part over the last angle `length` (rad), if no whole number of samples fills it. It has as many
    /// values as there are samples, at evenly spaced angles from beginning to end, by cubic Hermite
    /// interpolation over the angle (error O(h³) in the distance h of samples). `None` if the shaft changes
    /// its sense of rotation there.
    pub fn last_turned(&self, length: f64) -> Option<Track> {
        let samples = &self.samples;
        let angle = samples.angle.as_deref()?;
        let (first, last) = (angle.first()?, angle.last()?);
        // the angle may increase or decrease
        let sense = if last < first { -1.0 } else { 1.0 };
        let along: Vec<f64> = angle.iter().map(|angle| sense * angle).collect();
        let (begin, end) = (sense * last - length, sense * last);
        // the part begins one sample before the beginning, with the neighbours that the interpolation reads
        let from = along.iter().rposition(|angle| *angle <= begin).unwrap_or(0);
        let from = from.saturating_sub(2);
        let along = along.get(from..)?;
        let begin = begin.max(*along.first()?);
        let turned = along.last()? - along.first()?;
        let steps = (length / turned * along.len().checked_sub(1)? as f64).round();
        if steps.is_nan() || steps < 2.0 {
            return None;
        }
        let step = (end - begin) / steps;
        let grid: Vec<f64> = (0..=steps as usize)
            .map(|k| begin + step * k as f64)
            .collect();
        let at =
            |values: &[f64]| resample(along, values.get(from..)?, &grid, Interpolation::Cubic).ok();
        let filled = Samples {
            analysis: samples.analysis.clone(),
            time: at(&samples.time)?,
            angle: Some(grid.iter().map(|angle| sense * angle).collect()),
            speed: samples.speed.as_deref().and_then(at),
            period: samples.period,
            whole: false,
            shortened: samples.shortened,
            shifts: None,
        };
        Some(Track {
            values: at(&self.values)?,
            samples: Rc::new(filled),
        })
    }

    /// The first samples, without the irregular sample at the end of a run.
    pub fn first(self, count: usize) -> Track {
        if count >= self.values.len() {
            return self;
        }
        let mut samples = self
            .samples
            .part(|values| values.get(..count).unwrap_or(values));
        samples.shortened = true;
        Track {
            samples: Rc::new(samples),
            values: self.values.get(..count).unwrap_or_default().to_vec(),
        }
    }

    /// The error of an evaluation of the signal.
    pub fn refused(&self, source: SignalError) -> PostError {
        PostError::Signal {
            analysis: self.samples.analysis.clone(),
            source,
        }
    }
}

/// The names that distinguish members: their channels, their analyses, or both; empty for a single member.
pub(super) fn names(members: &[Member]) -> Vec<String> {
    if members.len() < 2 {
        return members.iter().map(|_| String::new()).collect();
    }
    distinct_names(
        members
            .iter()
            .map(|m| (m.analysis.as_str(), m.channel.as_str())),
    )
}

/// The names in which labels of several channels differ, each once: `vertical[2]` for
/// `a.vertical[2] - b.vertical[2]` beside `a.vertical[1] - b.vertical[1]`. `None` if a label is a single
/// channel, if the labels have different forms, or if these names do not distinguish them.
fn parts_apart(labels: &[&str]) -> Option<Vec<String>> {
    let made = |label: &&str| label.contains(' ');
    if labels.len() < 2 || !labels.iter().all(made) {
        return None;
    }
    let names = |label: &str| -> Vec<String> {
        let between = |c: char| c == '.' || c == ' ' || c == '(' || c == ')';
        label
            .split(between)
            .filter(|name| !name.is_empty())
            .map(str::to_owned)
            .collect()
    };
    let rows: Vec<Vec<String>> = labels.iter().map(|label| names(label)).collect();
    let first = rows.first()?;
    if rows.iter().any(|row| row.len() != first.len()) {
        return None;
    }
    let differs = |at: usize| rows.iter().any(|row| row.get(at) != first.get(at));
    let mut found: Vec<String> = Vec::with_capacity(rows.len());
    for row in &rows {
        let mut own: Vec<&str> = Vec::new();
        for (at, name) in row.iter().enumerate() {
            if differs(at) && !own.contains(&name.as_str()) {
                own.push(name);
            }
        }
        let own = own.join(" ");
        if own.is_empty() || found.contains(&own) {
            return None;
        }
        found.push(own);
    }
    Some(found)
}

/// The shortest names that distinguish analyses and channels.
pub fn distinct_names<'m>(
    members: impl Iterator<Item = (&'m str, &'m str)> + Clone,
) -> Vec<String> {
    if let Some(names) = parts_apart(&members.clone().map(|(_, c)| c).collect::<Vec<_>>()) {
        return names;
    }
    let first = members.clone().next();
    let one_analysis = members.clone().all(|(a, _)| Some(a) == first.map(|f| f.0));
    let one_channel = members.clone().all(|(_, c)| Some(c) == first.map(|f| f.1));
    // `main[1]` of `main[1].force.x` if all paths have the same end
    let ends = |tail: &&str| {
        let longer = |channel: &str| channel.len() > tail.len() && channel.ends_with(*tail);
        members.clone().all(|(_, channel)| longer(channel))
    };
    let path = first.map(|(_, channel)| channel);
    let path = path.filter(|path| !path.contains(' ')).unwrap_or("");
    let mut tails = path.match_indices('.').filter_map(|(at, _)| path.get(at..));
    let cut = tails.find(ends).filter(|_| !one_channel).unwrap_or("");
    members
        .map(|(a, c)| (a, c.strip_suffix(cut).unwrap_or(c)))
        .map(|(analysis, channel)| match (one_analysis, one_channel) {
            (true, _) => channel.to_owned(),
            (false, true) => analysis.to_owned(),
            (false, false) => format!("{analysis} {channel}"),
        })
        .collect()
}
