//! The section of one analysis: summaries, histories, orbits and loads, spectra, energy.

use super::drawn::drawn;
use super::{Entry, ReportError, tables};
use crate::figures::{distinct, histories, loads, orbits, spectrum};
use crate::grid_error::{GridError, grid_errors};
use crate::post::Run;
use crate::run::RunOutcome;
use eng_report::page::Section;

/// The figures that an analysis has of its own.
pub(super) enum Detail {
    /// All.
    Whole,
    /// All but the figures with these titles. The section of the sweep shows them beside those of its other points.
    Point(Vec<String>),
    /// None: one of many points of a sweep.
    Numbers,
}

/// The section. `cut` is the last cycle.
pub(super) fn section(
    entry: &Entry,
    cut: &RunOutcome,
    detail: &Detail,
) -> Result<Section, ReportError> {
    let results = &cut.results;
    let whole = results.samples() == entry.outcome.results.samples();
    let span = if whole && !entry.described.machine.periodic {
        "Whole run"
    } else {
        "Last cycle"
    };
    let mut section = Section::new(format!("Analysis {}", entry.name()));
    if results.is_state() {
        return Ok(match detail {
            Detail::Numbers => section.paragraph("Its values are in the table of its sweep."),
            _ => section.table(tables::state(entry)),
        });
    }
    for table in tables::summaries(entry) {
        section = section.table(table);
    }
    let motion = entry.outcome.motion.as_ref();
    if let Some(motion) = motion.filter(|_| !matches!(detail, Detail::Numbers)) {
        let errors = grid_errors(&entry.described.machine, motion);
        if !errors.is_empty() {
            section = section.list(errors.iter().map(GridError::text));
        }
    }
    let elsewhere: &[String] = match detail {
        Detail::Point(titles) => titles,
        _ => &[],
    };
    if !matches!(detail, Detail::Numbers) {
        let run = Run::new(results, &cut.machine);
        let histories: Vec<_> = distinct(histories(&run), results)
            .into_iter()
            .filter(|history| !elsewhere.contains(&history.title))
            .collect();
        let captioned = |title: &str| format!("{title}, {}. {span}.", entry.name());
        let mut figures = Vec::new();
        for history in &histories {
            let caption = captioned(&history.title) + &history.same_as();
            figures.push((history.clone(), caption));
        }
        section = drawn(section, &figures, &[run]);
        let whole = Run::new(&entry.outcome.results, &cut.machine);
        if let Some(orbits) = orbits(&whole) {
            let caption = format!(
                "{}, {}, seen against their z. The last cycle is drawn strongly; the circle is the radial clearance, and ε is the largest of the whole run.",
                orbits.title,
                entry.name()
            );
            section = drawn(section, &[(orbits, caption)], &[whole]);
        }
        // a sweep is compared point by point; its loads and spectra would be most of the page
        if entry.point.is_empty() {
            let mut figures = Vec::new();
            for load in loads(&run) {
                let caption = format!(
                    "{}, {}, in the axes above each diagram, seen against their z. The tip points at the side that carries the load. {span}.",
                    load.title,
                    entry.name()
                );
                figures.push((load, caption));
            }
            for spectrum in histories.iter().filter_map(|of| spectrum(of, &run)) {
                let caption = captioned(&spectrum.title);
                figures.push((spectrum, caption));
            }
            section = drawn(section, &figures, &[run]);
        }
        if !elsewhere.is_empty() {
            section = section.paragraph(
                "Its other histories are beside those of the other points, under Comparisons.",
            );
        }
    }
    if let Some(audit) = tables::energy(results) {
        let caption = format!("Energy, {}: {}", entry.name(), span.to_lowercase());
        section = section.table(audit.table(&caption));
    }
    Ok(section)
}
