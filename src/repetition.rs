//! The repetition of a periodic analysis's cycle, as stored in its results.

use crate::codes;
use crate::places::place;
use eng_grammar::Diagnostic;
use eng_runtime::{PeriodicSummary, Remedy};
use eng_system::significant::{short, significant};
use eng_system::system::{Origin, System};
use std::collections::BTreeMap;

const CYCLES: &str = "periodic.cycles";
const REPEATS: &str = "periodic.repeats";
const SLOWEST: &str = "periodic.slowest";
const CHANGE: &str = "periodic.change";
const FACTOR: &str = "periodic.factor";
const NOISE: &str = "periodic.noise";
const ERRATIC: &str = "periodic.erratic";

/// The remedy of too few cycles.
const MORE: &str = "allow more: `cycles: 100`";

/// Factor per cycle above which more cycles hardly help. A choice: a hundred cycles win less than a digit.
pub(crate) const HARDLY_SHRINKS: f64 = 0.98;
/// Factor per cycle above which deviations grow. It is the limit of the runtime (`SUSTAINED`).
const HARDLY_GROWS: f64 = 1.02;

/// The end of a periodic analysis.
#[derive(Clone, Debug, PartialEq)]
pub struct Repetition {
    /// Whole cycles.
    pub cycles: u32,
    /// Whether the last cycle repeats the one before.
    pub repeats: bool,
    /// The channel that changed most; absent without channels.
    pub slowest: Option<Slowest>,
    /// Present if the motion repeats and that change is noise of the steps: the argument of the analysis that
    /// would reduce it below the requested change.
    pub noise: Option<String>,
    /// Whether the differences from cycle to cycle neither shrink nor follow from those before.
    pub erratic: bool,
}

/// The channel that changed most from the last cycle but one to the last.
#[derive(Clone, Debug, PartialEq)]
pub struct Slowest {
    /// Its path.
    pub channel: String,
    /// Largest difference as a share of its swing within a cycle.
    pub change: f64,
    /// Factor by which deviations of the motion shrink from cycle to cycle, if there is an estimate.
    pub factor: Option<f64>,
}

impl Repetition {
    /// The repetition from the summary of a run.
    pub fn new(found: &PeriodicSummary, system: &System) -> Repetition {
        Repetition {
            cycles: found.cycles,
            repeats: found.repeats,
            slowest: found.slowest.as_ref().and_then(|slowest| {
                Some(Slowest {
                    channel: system.channels.get(slowest.channel)?.path.clone(),
                    change: slowest.change,
                    factor: found
                        .motion
                        .or(slowest.mode)
                        .filter(|_| !found.erratic)
                        .map(|mode| mode.factor),
                })
            }),
            noise: found.noise.map(|remedy| match remedy {
                Remedy::Tolerance(factor) => format!("tolerance: {}", rounded_down(factor)),
                Remedy::Step(step) => format!("step: {} s", rounded_down(step)),
            }),
            erratic: found.erratic,
        }
    }

    /// The repetition from the metadata of results; `None` for another kind of analysis.
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
            noise: metadata.get(NOISE).cloned(),
            erratic: metadata.contains_key(ERRATIC),
        })
    }

    /// Whether a key of the metadata belongs to the repetition.
    pub fn is_key(key: &str) -> bool {
        [CYCLES, REPEATS, SLOWEST, CHANGE, FACTOR, NOISE, ERRATIC].contains(&key)
    }

    /// Keys and values for the metadata, with numbers to the last bit.
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
        pairs.extend(self.noise.clone().map(|noise| (NOISE, noise)));
        pairs.extend(self.erratic.then(|| (ERRATIC, true.to_string())));
        pairs
    }

    /// The repetition in words.
    pub fn text(&self) -> String {
        let repeats = match (self.repeats, &self.noise) {
            (true, None) => "repeats",
            (true, Some(_)) => "repeats but for the noise of its steps",
            (false, _) => "does not repeat",
        };
        let least = match &self.slowest {
            Some(Slowest {
                channel, change, ..
            }) => format!(
                "; the last differs by {} of the peak-to-peak value of {channel}",
                short(*change, 3)
            ),
            None => String::new(),
        };
        format!("{repeats} after {} cycles{least}", self.cycles)
    }

    /// The warning about a last cycle that no other one precedes.
    fn uncompared(&self, analysis: &Origin) -> Diagnostic {
        let message = Diagnostic::warning(
            codes::NOT_PERIODIC,
            format!("the cycle does not repeat after {} cycles", self.cycles),
        );
        place(message, analysis, "the last cycle is kept")
            .with_note("no cycle before the last one has its steps and continues into it, so nothing shows how much it changes")
            .with_help(MORE)
    }

    /// The warning about a cycle that does not repeat, or about an output that is lost in the noise of the
    /// steps, at the line of its analysis.
    pub fn warning(&self, analysis: &Origin) -> Option<Diagnostic> {
        let Some(slowest) = &self.slowest else {
            return (!self.repeats).then(|| self.uncompared(analysis));
        };
        let share = format!("{} %", significant(100.0 * slowest.change, 3));
        if let Some(remedy) = &self.noise {
            let message = Diagnostic::warning(
                codes::NOISE,
                format!(
                    "{} changes by {share} of its peak-to-peak value from cycle to cycle, which is the noise of the steps",
                    slowest.channel
                ),
            );
            return Some(
                place(message, analysis, "the motion repeats to within the tolerance")
                    .with_note("a small difference of large values, or a derivative of a small motion, shows the errors of the steps enlarged")
                    .with_help(format!(
                        "`{remedy}` brings the errors of the steps below `change`; if rounding of the large values is the cause, no tolerance helps: leave such an output out"
                    )),
            );
        }
        if self.repeats {
            return None;
        }
        let message = Diagnostic::warning(
            codes::NOT_PERIODIC,
            format!(
                "the cycle does not repeat after {} cycles: {} still changes by {share} of its peak-to-peak value",
                self.cycles, slowest.channel
            ),
        );
        let message = place(message, analysis, "the last cycle is kept");
        if self.erratic {
            return Some(
                message
                    .with_note("its changes do not shrink, nor do they follow from those of the cycles before: no two cycles are alike")
                    .with_help("impacts, stops and dry friction make such motions, and more cycles do not help: look at the forces of this part, take the mean of many cycles of a `transient`, or accept more: `change`"),
            );
        }
        Some(match slowest.factor {
            None => message
                .with_note("so few cycles don't tell how fast its change shrinks")
                .with_help(MORE),
            Some(factor) => {
                let message = message.with_note(format!(
                    "deviations of the motion {}",
                    decay_in_words(factor)
                ));
                if factor < HARDLY_SHRINKS {
                    message.with_help(MORE)
                } else if factor <= HARDLY_GROWS {
                    message.with_help("look for whirl, a resonance or a speed that creeps; if it is small it is the steps' own error, and `tolerance: 0.1` makes less of it; or accept more: `change: 1 %`")
                } else {
                    message.with_help("the motion is unstable, and more cycles do not help: look for whirl, a resonance, negative damping")
                }
            }
        })
    }
}

/// The growth or decay of deviations from cycle to cycle, as words after a plural.
pub(crate) fn decay_in_words(factor: f64) -> String {
    if factor < HARDLY_SHRINKS {
        format!("shrink by the factor {factor:.3} per cycle")
    } else if factor <= HARDLY_GROWS {
        format!("do not shrink: the factor is {factor:.3} per cycle")
    } else {
        format!("grow by the factor {factor:.3} per cycle")
    }
}

/// A number with one digit, rounded down.
fn rounded_down(value: f64) -> String {
    let power = libm::pow(10.0, libm::floor(libm::log10(value)));
    // a digit that is exact but for rounding stays
    significant(libm::floor(value / power * (1.0 + 1e-9)) * power, 1)
}
