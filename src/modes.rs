//! Modes of a `linear` analysis as columns.
//!
//! Each row is a mode: oscillations first, then the others, each from slow to fast.
//!
//! | column | meaning |
//! | --- | --- |
//! | `mode` | counted from 1 |
//! | `frequency`, `undamped_frequency` | ω/2π, \|λ\|/2π (Hz) of λ = growth ± iω; the first is 0 for a motion without oscillation |
//! | `damping_ratio` | −Re λ/\|λ\| (shown and written in %): 1 for a decay, −1 for a growth, both without oscillation |
//! | `logarithmic_decrement` | −2π Re λ/ω; not a number for a motion without oscillation |
//! | `growth` | Re λ (1/s) |
//! | `cycle.speed` | speed of the cycle in the linearised state, for a model with a cycle |
//! | `kinetic.B` | share of body B in the kinetic energy; for a flexible body also `kinetic.B.rigid` and `kinetic.B.mode[k]` |
//! | `potential.P`, `lost.P` | share of flexible body or load P in the stored energy and in the lost power (negative: P feeds energy into the mode) |
//! | a channel's path, `….phase` | its amplitude while the mode has 1 J, and its phase against the mode's largest motion |

use crate::counted::counted;
use crate::results::{Column, MODES, ROWS, Results, ResultsError};
use eng_runtime::linearised::{
    Coefficients, LinearModes, Mode, Orbit, Part, Repeating, parts_of, stores,
};
use eng_runtime::model::Model;
use eng_system::recorded::{KINETIC, LOST, POTENTIAL, RIGID, Recorded, of_modes};
use eng_system::significant::short;
use std::f64::consts::PI;

/// Key of the metadata for the coefficients: see [`PERIODIC`] and [`FROZEN`].
const COEFFICIENTS: &str = "coefficients";
/// Value of [`COEFFICIENTS`] if the coefficients repeat with a period.
const PERIODIC: &str = "periodic";
/// Value of [`COEFFICIENTS`] if the analysis held changing coefficients at one moment.
const FROZEN: &str = "frozen";
/// The largest number of modes whose harmonics are listed. A choice: the file has all.
const MOST_HARMONICS: usize = 20;
/// A motion of at least this roundness (0…1) is called a whirl. A choice: below, one axis of the ellipse is
/// ten times the other or more.
const WHIRLS: f64 = 0.2;
/// The use of frozen modes, in words.
const FROZEN_PICTURE: &str = "frozen picture: the coefficients change while bodies turn or time passes, and were held at this moment; frequencies well above the speed are about right, whirl, damping and stability are not those of the motion";
/// Smallest uncertainty of eigenvalues, as a share of their size, that is reported. A choice: eigenvalues are
/// printed with fewer digits.
const LEAST_UNCERTAINTY: f64 = 1e-6;
/// The largest number of parts that a line of the table names. A choice: they fit in a line.
const NAMED: usize = 4;
/// The smallest share that a line of the table names. A choice: a smaller part hardly decides a mode, and
/// would lengthen the line.
const SMALLEST: f64 = 0.03;

/// The parts of each body: index of the first part, and their number.
fn bodies(parts: &[Part]) -> Vec<(usize, usize)> {
    let mut found: Vec<(usize, usize)> = Vec::new();
    for (index, part) in parts.iter().enumerate() {
        match found.last_mut() {
            Some((_, count)) if part.mode.is_some() => *count += 1,
            _ => found.push((index, 1)),
        }
    }
    found
}

/// Columns without values, in the order of [`row`].
pub(crate) fn push_columns(results: &mut Results, model: &Model) -> Result<(), ResultsError> {
    results.set_metadata(ROWS, MODES);
    let (parts, stores) = (parts_of(model), stores(model));
    let columns = of_modes(&model.compiled.system);
    // amplitude and phase of every channel come last
    let own = columns
        .len()
        .saturating_sub(2 * model.compiled.system.channels.len());
    for (place, recorded) in columns.into_iter().enumerate() {
        if place >= own {
            results.push(column(recorded))?;
            continue;
        }
        let path = recorded.path.as_str();
        let store = [POTENTIAL, LOST]
            .into_iter()
            .find_map(|kind| path.strip_prefix(kind));
        if store.is_some_and(|store| stores.iter().all(|known| known != store)) {
            continue;
        }
        let body = path
            .strip_prefix(KINETIC)
            .and_then(|path| path.strip_suffix(RIGID))
            .map(str::to_owned);
        let share = recorded.clone();
        let Some(body) = body else {
            results.push(column(recorded))?;
            continue;
        };
        let of_body = parts.iter().filter(|part| part.path == body);
        let modes: Vec<usize> = of_body.filter_map(|part| part.mode).collect();
        // a rigid body needs no column beside its share
        if modes.is_empty() {
            continue;
        }
        results.push(column(recorded))?;
        for mode in modes {
            results.push(column(Recorded {
                path: format!("{KINETIC}{body}.mode[{mode}]"),
                ..share.clone()
            }))?;
        }
    }
    Ok(())
}

fn column(recorded: Recorded) -> Column {
    Column {
        path: recorded.path,
        dimension: recorded.dimension,
        display: recorded.display,
        frame: recorded.frame,
        values: Vec::new(),
    }
}

/// The values (SI) of a mode, in the order of [`push_columns`].
pub(crate) fn row(modes: &LinearModes, index: usize, mode: &Mode) -> Vec<f64> {
    let mut row = vec![
        (index + 1) as f64,
        mode.frequency(),
        mode.undamped_frequency(),
        mode.damping_ratio(),
        mode.logarithmic_decrement(),
        mode.value.re,
    ];
    row.extend(modes.cycle_speed);
    let kinetic = &mode.shares.kinetic;
    for (first, count) in bodies(&modes.parts) {
        let own = kinetic.get(first..first + count).unwrap_or_default();
        row.push(own.iter().sum());
        if count > 1 {
            row.extend(own);
        }
    }
    row.extend(&mode.shares.potential);
    row.extend(&mode.shares.lost);
    for output in &mode.outputs {
        row.push(output.norm());
        row.push(libm::atan2(output.im, output.re));
    }
    row
}

/// Keys and values of the metadata: the moment, the state and the coefficients of the linearisation.
pub(crate) fn metadata(modes: &LinearModes) -> Vec<(&'static str, String)> {
    let mut known = vec![
        ("linearised", linearised_at(modes)),
        (COEFFICIENTS, coefficients(modes).to_owned()),
    ];
    if let Some(orbit) = &modes.orbit {
        known.push(("period", format!("{:.9e} s", orbit.period)));
    }
    known
}

/// The moment of the linearisation in words.
pub(crate) fn linearised_at(modes: &LinearModes) -> String {
    format!("at {}", modes.moment)
}

/// The kind of the coefficients as a word.
pub(crate) fn coefficients(modes: &LinearModes) -> &'static str {
    match modes.coefficients {
        Coefficients::Constant => "constant",
        Coefficients::Frozen => FROZEN,
        Coefficients::Periodic => PERIODIC,
    }
}

/// Whether results hold modes of a period.
pub(crate) fn are_of_a_period(results: &Results) -> bool {
    results.metadata().get(COEFFICIENTS).map(String::as_str) == Some(PERIODIC)
}

/// Whether results hold modes of changing coefficients that were held at one moment.
pub(crate) fn are_frozen(results: &Results) -> bool {
    results.metadata().get(COEFFICIENTS).map(String::as_str) == Some(FROZEN)
}

/// Lines about the whole analysis: its moment, the number of modes, zero eigenvalues and growing modes.
pub(crate) fn facts(modes: &LinearModes) -> Vec<String> {
    let count = modes.oscillations().count();
    let mut fact = format!(
        "linearised at {}: {}, {}, {}",
        modes.moment,
        counted(modes.freedoms, "freedom", "freedoms"),
        counted(count, "oscillation", "oscillations"),
        counted(modes.modes.len() - count, "decay", "decays")
    );
    if modes.states > 0 {
        fact.push_str(&format!(", {} states of elements", modes.states));
    }
    if modes.zeros > 0 && modes.orbit.is_none() {
        fact.push_str(&format!(
            "; {} (below {} Hz)",
            counted(modes.zeros, "eigenvalue is zero", "eigenvalues are zero"),
            short(modes.resolution / (2.0 * PI), 2)
        ));
    }
    if modes.left_out != [0, 0] {
        fact.push_str(&format!(
            "; {} oscillations and {} decays left out",
            modes.left_out[0], modes.left_out[1]
        ));
    }
    let mut facts = vec![fact];
    if modes.coefficients == Coefficients::Frozen {
        facts.push(FROZEN_PICTURE.to_owned());
    }
    if modes.variation > LEAST_UNCERTAINTY {
        facts.push(format!(
            "the coefficients change a little while bodies turn or time passes, and are held: eigenvalues are known to about {} of their size",
            short(modes.variation, 2)
        ));
    }
    if let Some(orbit) = &modes.orbit {
        facts.extend(of_orbit(modes, orbit));
    }
    for (index, mode) in modes.modes.iter().enumerate().filter(|(_, m)| m.grows()) {
        let named: Vec<(String, f64)> = mode
            .leading(NAMED)
            .into_iter()
            .filter_map(|(part, share)| Some((modes.parts.get(part)?.to_string(), share)))
            .collect();
        let verdict = match modes.coefficients {
            Coefficients::Constant | Coefficients::Periodic => "unstable",
            Coefficients::Frozen => "unstable in the frozen picture",
        };
        facts.push(format!(
            "{verdict}: mode {} ({} Hz) grows by {} 1/s: {}",
            index + 1,
            short(mode.frequency(), 4),
            short(mode.value.re, 4),
            listed(named)
        ));
    }
    facts
}

/// Lines about a repeating motion: its period, the errors of the motion and of its exponents, and omitted or
/// doubtful modes.
fn of_orbit(modes: &LinearModes, orbit: &Orbit) -> Vec<String> {
    let error = |mode: &Mode| mode.repeating.as_ref().map_or(0.0, |r| r.error);
    let worst = modes.modes.iter().map(error).fold(0.0, f64::max);
    let mut fact = format!(
        "modes of a period of {:.6} ms in {} steps: exponents change by at most {} 1/s with steps of double length; the state comes back within {} of the allowed distance",
        1e3 * orbit.period,
        orbit.steps,
        short(worst, 2),
        short(orbit.gap, 2)
    );
    if let Some(phase) = orbit.phase {
        fact.push_str(&format!(", its own direction within {}", short(phase, 2)));
    }
    let mut facts = vec![fact];
    if modes.zeros > 0 {
        facts.push(format!(
            "{} multipliers are neutral (within {} of 1): free turning or sliding, the phase of the motion, or an oscillation at a multiple of its frequency; they are judged neither stable nor unstable",
            modes.zeros,
            short(orbit.neutral, 2)
        ));
    }
    if orbit.lost > 0 {
        facts.push(format!(
            "{} motions decay faster than {} 1/s and are lost in rounding",
            orbit.lost,
            short(orbit.reach, 3)
        ));
    }
    let listed = |test: &dyn Fn(&Repeating) -> bool| -> String {
        let numbers: Vec<String> = modes
            .modes
            .iter()
            .enumerate()
            .filter(|(_, mode)| mode.repeating.as_ref().is_some_and(test))
            .map(|(index, _)| (index + 1).to_string())
            .collect();
        numbers.join(", ")
    };
    let unresolved = listed(&|r| !r.resolved);
    if !unresolved.is_empty() {
        facts.push(format!(
            "not resolved by the steps (|λ|h > 1): modes {unresolved}; state a shorter `step`"
        ));
    }
    let ambiguous = listed(&|r| r.harmonics.share < 0.5);
    if !ambiguous.is_empty() {
        facts.push(format!(
            "ambiguous frequency, for no harmonic holds half of the motion: modes {ambiguous}; growth is definite"
        ));
    }
    let round = |from: f64| {
        listed(&|r| {
            let clear = r.harmonics.share >= 0.5;
            r.harmonics
                .whirl
                .is_some_and(|w| clear && w * from >= WHIRLS)
        })
    };
    for (sense, which) in [("forward", round(1.0)), ("backward", round(-1.0))] {
        if !which.is_empty() {
            facts.push(format!("{sense} whirl: modes {which}"));
        }
    }
    for (index, mode) in modes.modes.iter().enumerate().take(MOST_HARMONICS) {
        if let Some(r) = &mode.repeating
            && !r.harmonics.further.is_empty()
        {
            let others: Vec<String> = r
                .harmonics
                .further
                .iter()
                .map(|(f, share)| format!("{:.0} % at {:.4} Hz", 100.0 * share, f / (2.0 * PI)))
                .collect();
            facts.push(format!(
                "mode {}: {:.0} % at {:.4} Hz, {}",
                index + 1,
                100.0 * r.harmonics.share,
                mode.frequency(),
                others.join(", ")
            ));
        }
    }
    facts
}

/// `62 % crank mode 3, 20 % block`, with the largest share first.
fn listed(mut shares: Vec<(String, f64)>) -> String {
    shares.sort_by(|a, b| b.1.total_cmp(&a.1));
    shares.truncate(NAMED);
    let named: Vec<String> = shares
        .into_iter()
        .enumerate()
        .filter(|(place, (_, share))| *place == 0 || *share >= SMALLEST)
        .map(|(_, (name, share))| format!("{:.0} % {name}", 100.0 * share))
        .collect();
    named.join(", ")
}

/// Values of a column, if it was kept.
pub(crate) fn values<'r>(results: &'r Results, path: &str) -> Option<&'r [f64]> {
    results.column(path).map(|c| c.values.as_slice())
}

/// The moving parts of a row: bodies by name, and for flexible bodies the rigid motion and each mode.
pub(crate) fn composition(results: &Results, row: usize) -> String {
    let columns = || {
        results.columns().iter().filter_map(|c| {
            let name = c.path.strip_prefix(KINETIC)?;
            Some((name, *c.values.get(row)?))
        })
    };
    let split: Vec<&str> = columns()
        .filter_map(|(name, _)| name.strip_suffix(".rigid"))
        .collect();
    let shares = columns()
        .filter(|(name, _)| !split.contains(name))
        .map(|(name, share)| {
            let name = match name.split_once(".mode[") {
                Some((body, mode)) => format!("{body} mode {}", mode.trim_end_matches(']')),
                None => name.replace(".rigid", " rigid"),
            };
            (name, share)
        })
        .collect();
    listed(shares)
}
