//! Whether the cycle of a periodic analysis repeats, as its results keep it.

use crate::codes;
use crate::failure::place;
use eng_grammar::Diagnostic;
use eng_runtime::PeriodicSummary;
use eng_system::system::{Origin, System};
use std::collections::BTreeMap;

const CYCLES: &str = "periodic.cycles";
const REPEATS: &str = "periodic.repeats";
const SLOWEST: &str = "periodic.slowest";
const CHANGE: &str = "periodic.change";
const FACTOR: &str = "periodic.factor";

/// Factor a cycle from which on more cycles don't help.
const HARDLY_SHRINKS: f64 = 0.98;

/// How a periodic analysis ended.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Repetition {
    /// Whole cycles.
    pub cycles: u32,
    /// Whether the last repeats the one before.
    pub repeats: bool,
    /// What changed most; absent without channels.
    pub slowest: Option<Slowest>,
}

/// The channel that changed most from the last cycle but one to the last.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Slowest {
    /// Its path.
    pub channel: String,
    /// Largest difference as a share of its swing within a cycle.
    pub change: f64,
    /// Factor by which the difference shrinks from cycle to cycle, where it could be estimated.
    pub factor: Option<f64>,
}

impl Repetition {
    /// From what the run found.
    pub fn new(found: &PeriodicSummary, system: &System) -> Repetition {
        Repetition {
            cycles: found.cycles,
            repeats: found.repeats,
            slowest: found.slowest.as_ref().and_then(|slowest| {
                Some(Slowest {
                    channel: system.channels.get(slowest.channel)?.path.clone(),
                    change: slowest.change,
                    factor: slowest.known.then_some(slowest.factor),
                })
            }),
        }
    }

    /// Of results; absent where they are of another kind of analysis.
    pub fn of(metadata: &BTreeMap<String, String>) -> Option<Repetition> {
        let number = |key: &str| metadata.get(key)?.parse::<f64>().ok();
        Some(Repetition {
            cycles: metadata.get(CYCLES)?.parse().ok()?,
            repeats: metadata.get(REPEATS)?.parse().ok()?,
            slowest: metadata
                .get(SLOWEST)
                .zip(number(CHANGE))
                .map(|(channel, change)| Slowest {
                    channel: channel.clone(),
                    change,
                    factor: number(FACTOR),
                }),
        })
    }

    /// Whether a key of the metadata is one of these.
    pub fn is_key(key: &str) -> bool {
        [CYCLES, REPEATS, SLOWEST, CHANGE, FACTOR].contains(&key)
    }

    /// Keys and values for the metadata; numbers to the last bit.
    pub fn metadata(&self) -> Vec<(&'static str, String)> {
        let mut pairs = vec![
            (CYCLES, self.cycles.to_string()),
            (REPEATS, self.repeats.to_string()),
        ];
        if let Some(slowest) = &self.slowest {
            pairs.push((SLOWEST, slowest.channel.clone()));
            pairs.push((CHANGE, slowest.change.to_string()));
            pairs.extend(slowest.factor.map(|factor| (FACTOR, factor.to_string())));
        }
        pairs
    }

    /// In words.
    pub fn text(&self) -> String {
        let repeats = match self.repeats {
            true => "repeats",
            false => "does not repeat",
        };
        let least = match &self.slowest {
            Some(Slowest {
                channel, change, ..
            }) => format!("; the last differs by {change:.2e} of its swing in {channel}"),
            None => String::new(),
        };
        format!("{repeats} after {} cycles{least}", self.cycles)
    }

    /// The warning of a cycle that does not repeat, at the line of its analysis.
    pub fn warning(&self, analysis: &Origin) -> Option<Diagnostic> {
        let slowest = self.slowest.as_ref().filter(|_| !self.repeats)?;
        let message = Diagnostic::warning(
            codes::NOT_PERIODIC,
            format!(
                "the cycle does not repeat after {} cycles: {} still changes by {:.3} % of its swing",
                self.cycles,
                slowest.channel,
                100.0 * slowest.change
            ),
        );
        let message = place(message, analysis, "the last cycle is kept");
        let more = "allow more: `cycles: 100`";
        Some(match slowest.factor {
            None => message
                .with_note("so few cycles don't tell how fast its change shrinks")
                .with_help(more),
            Some(factor) if factor < HARDLY_SHRINKS => message
                .with_note(format!("its change shrinks by the factor {factor:.3} a cycle"))
                .with_help(more),
            Some(factor) => message
                .with_note(format!("its change does not shrink: the factor is {factor:.3} a cycle"))
                .with_help("look for whirl, a resonance or a speed that creeps; if it is small it is the steps' own error, and `tolerance: 0.1` makes less of it; or accept more: `change: 1 %`"),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_metadata_give_it_back() {
        for (repeats, factor) in [(true, Some(0.1 + 0.2)), (false, None)] {
            let slowest = Some(Slowest {
                channel: "main[1].eccentricity.x".to_owned(),
                change: 1.0 / 3.0,
                factor,
            });
            for slowest in [slowest, None] {
                let found = Repetition {
                    cycles: 40,
                    repeats,
                    slowest,
                };
                let kept = found.metadata().into_iter();
                let kept: BTreeMap<String, String> =
                    kept.map(|(key, value)| (key.to_owned(), value)).collect();
                assert!(kept.keys().all(|key| Repetition::is_key(key)));
                assert_eq!(Repetition::of(&kept), Some(found));
            }
        }
        assert_eq!(Repetition::of(&BTreeMap::new()), None);
    }
}
