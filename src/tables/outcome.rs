//! The texts about runs: facts and tables of each, and the tables over the points of sweeps.

use super::{SummaryTable, modes, response, state, sweep};
use crate::results::Results;
use crate::run::RunOutcome;
use crate::timings;

/// Facts and tables of a run as text, as `eng run` prints them. A point of a sweep has no tables.
pub fn outcome_text(outcome: &RunOutcome) -> String {
    let results = &outcome.results;
    let mut text = format!("{} ({})\n", results.analysis(), results.model());
    let mut line = |line: &str| {
        text.push_str("  ");
        text.push_str(line);
        text.push('\n');
    };
    let point: Vec<String> = outcome
        .point
        .iter()
        .map(|p| format!("{} = {}", p.name, p.display.text(p.value)))
        .collect();
    if !point.is_empty() {
        line(&point.join(", "));
    }
    outcome.facts.iter().for_each(|fact| line(fact));
    if let Some(spent) = &outcome.timings {
        line(&timings::line(&spent.phases()));
    }
    if !outcome.point.is_empty() {
        return text;
    }
    if results.is_state() {
        text.push_str(&state::text(results));
        return text;
    }
    for summary in &outcome.machine.summaries {
        let table = SummaryTable::new(results, summary, outcome.machine.cycle_period);
        text.push_str(&table.text());
    }
    if results.are_modes() {
        text.push_str(&modes::table(results));
    } else if results.are_responses() {
        text.push_str(&response::text(results));
    }
    text
}

/// The table over the points of each sweep as text, as `eng run` prints it.
pub fn sweep_texts(outcomes: &[RunOutcome]) -> Vec<String> {
    let families = sweep::families(outcomes).into_iter();
    families.map(|family| over_points_of(&family).1).collect()
}

/// The table over the points of a sweep, also as text.
pub(crate) fn over_points_of(family: &[&RunOutcome]) -> (Results, String) {
    let name = sweep::name(family);
    if family.iter().all(|o| o.results.are_modes()) {
        let text = modes::campbell_text(name, family);
        (sweep::stacked(name, family), text)
    } else if family.iter().all(|o| o.results.are_responses()) {
        let text = response::text_of_sweep(name, family);
        (sweep::stacked(name, family), text)
    } else {
        let table = sweep::table(family);
        let text = sweep::text(&table);
        (table, text)
    }
}
