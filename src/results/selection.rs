//! The kept part of a run: channels by patterns, and its last part.

use super::{CYCLE_ANGLE, CYCLE_SPEED, Results, ResultsError, TIME};
use eng_system::Dimension;

/// The last part of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Last {
    /// A time (s).
    Time(f64),
    /// An angle of the cycle (rad).
    Angle(f64),
}

impl Last {
    /// Makes it from a quantity in SI. It must be a positive time or angle.
    pub fn new(value: f64, dimension: Dimension) -> Result<Last, ResultsError> {
        let refused = |what: &str| {
            Err(ResultsError::Last(format!(
                "the last part is {what}: give an angle or a time above zero, such as `2 rev` or `50 ms`"
            )))
        };
        if value.is_nan() || value <= 0.0 {
            return refused("not positive");
        }
        if dimension == Dimension::TIME {
            Ok(Last::Time(value))
        } else if dimension == Dimension::ANGLE {
            Ok(Last::Angle(value))
        } else {
            refused("neither an angle nor a time")
        }
    }

    /// The column that measures it.
    pub(super) fn path(self) -> &'static str {
        match self {
            Last::Time(_) => TIME,
            Last::Angle(_) => CYCLE_ANGLE,
        }
    }

    /// Whether a sample belongs to the part. `value` is the column's value at the sample, `end` its value at
    /// the end. A millionth of the part is allowed for rounding errors.
    pub(crate) fn holds(self, value: f64, end: f64) -> bool {
        let (Last::Time(part) | Last::Angle(part)) = self;
        (end - value).abs() <= part * (1.0 + 1e-6)
    }
}

/// Channels by patterns. `*` matches any characters, `?` matches one, and every other character matches
/// itself. Without patterns all channels are selected.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Selection {
    patterns: Vec<String>,
}

impl Selection {
    /// A selection by patterns. Each text may hold several patterns, with commas between them.
    pub fn new<'a>(patterns: impl IntoIterator<Item = &'a str>) -> Selection {
        Selection {
            patterns: patterns
                .into_iter()
                .flat_map(|text| text.split(','))
                .map(str::trim)
                .filter(|text| !text.is_empty())
                .map(str::to_owned)
                .collect(),
        }
    }

    /// The patterns.
    pub fn patterns(&self) -> &[String] {
        &self.patterns
    }

    /// Whether each column is kept. Time and cycle are always kept, and the frequencies of modes and responses too. A
    /// pattern that matches no column is an error.
    pub fn of(&self, results: &Results) -> Result<Vec<bool>, ResultsError> {
        let modes = results.are_modes();
        let responses = results.are_responses();
        let paths = || results.columns().iter().map(|c| c.path.as_str());
        for pattern in &self.patterns {
            if !paths().any(|path| matches(pattern, path)) {
                let alike = |path: &str| strsim::jaro_winkler(pattern, path);
                return Err(ResultsError::NoChannel {
                    pattern: pattern.clone(),
                    nearest: paths()
                        .map(|path| (alike(path), path))
                        // a choice: names with a mistake or two are as alike, others are not
                        .filter(|(likeness, _)| *likeness > 0.8)
                        .max_by(|a, b| a.0.total_cmp(&b.0))
                        .map(|(_, path)| path.to_owned()),
                    known: results.columns().len(),
                });
            }
        }
        Ok(paths()
            .map(|path| {
                self.patterns.is_empty()
                    || [TIME, CYCLE_ANGLE, CYCLE_SPEED].contains(&path)
                    || (modes && super::COLUMNS_OF_MODES.contains(&path))
                    || (responses && path == super::FREQUENCY)
                    || self.patterns.iter().any(|pattern| matches(pattern, path))
            })
            .collect())
    }

    /// The results with the selected columns only.
    pub fn apply(&self, results: &Results) -> Result<Results, ResultsError> {
        let mut selected = results.without_columns();
        for (column, kept) in results.columns().iter().zip(self.of(results)?) {
            if kept {
                selected.push(column.clone())?;
            }
        }
        Ok(selected)
    }
}

/// Whether a path matches a pattern. On a mismatch the match returns to the last `*`, which then takes one
/// more character.
pub fn matches(pattern: &str, path: &str) -> bool {
    let pattern: Vec<char> = pattern.chars().collect();
    let path: Vec<char> = path.chars().collect();
    let (mut p, mut t) = (0, 0);
    let mut star: Option<(usize, usize)> = None;
    while let Some(here) = path.get(t) {
        match pattern.get(p) {
            Some('*') => {
                star = Some((p, t));
                p += 1;
            }
            Some(c) if *c == '?' || c == here => {
                p += 1;
                t += 1;
            }
            _ => match &mut star {
                Some((at, taken)) => {
                    *taken += 1;
                    (p, t) = (*at + 1, *taken);
                }
                None => return false,
            },
        }
    }
    pattern
        .get(p..)
        .is_some_and(|rest| rest.iter().all(|c| *c == '*'))
}
