//! The section of one analysis: journals, histories, orbits and loads, spectra, energy.

use super::{Entry, ReportError, loads, spectra::spectra_of, tables};
use crate::figures::{Pictured, histories, orbits};
use crate::results::Results;
use crate::run::RunOutcome;
use eng_report::page::Section;
use eng_system::Dimension;

pub(super) fn force() -> Dimension {
    Dimension::MASS.times(acceleration())
}

pub(super) fn acceleration() -> Dimension {
    Dimension::LENGTH
        .over(Dimension::TIME)
        .over(Dimension::TIME)
}

/// Whether two figures show the same columns' values.
fn same(a: &Pictured, b: &Pictured, results: &Results) -> bool {
    let column = |path: &String| results.column(path).map(|c| &c.values);
    let pairs = || a.paths.iter().zip(&b.paths);
    a.dimension == b.dimension
        && a.paths.len() == b.paths.len()
        && pairs().all(|(a, b)| column(a).is_some() && column(a) == column(b))
}

/// `main[1].force.x` to `main[5].force.x`.
fn range(paths: &[String]) -> String {
    match paths {
        [] => String::new(),
        [only] => only.clone(),
        [first, .., last] => format!("{first} to {last}"),
    }
}

/// Figures of the same values once: what else each of them shows stands under its title. A force that is an output of the model, too,
/// is drawn as that.
pub(super) fn distinct(pictured: Vec<Pictured>, results: &Results) -> Vec<Pictured> {
    let mut shown: Vec<(Pictured, Vec<String>)> = Vec::new();
    for pictured in pictured {
        match shown.iter_mut().find(|(s, _)| same(s, &pictured, results)) {
            Some((_, others)) => others.push(range(&pictured.paths)),
            None => shown.push((pictured, Vec::new())),
        }
    }
    shown
        .into_iter()
        .map(|(mut pictured, others)| {
            if !others.is_empty() {
                let subtitle = &mut pictured.figure.subtitle;
                *subtitle = format!("{subtitle}; the same as {}", others.join(", "));
            }
            pictured
        })
        .collect()
}

/// Which figures an analysis has of its own.
pub(super) enum Detail {
    /// All.
    Whole,
    /// Those that do not stand beside those of the other points of its sweep, which have these titles.
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
    if let Some(table) = tables::journals(entry) {
        section = section.table(table);
    }
    let elsewhere: &[String] = match detail {
        Detail::Point(titles) => titles,
        _ => &[],
    };
    if !matches!(detail, Detail::Numbers) {
        let mut spectra = Vec::new();
        for pictured in distinct(histories(cut), results) {
            let history = pictured.figure;
            if elsewhere.contains(&history.title) {
                continue;
            }
            // a sweep is compared point by point; its spectra would be most of the page
            let wanted = [force(), acceleration()].contains(&pictured.dimension);
            if wanted && entry.point.is_empty() {
                spectra.extend(spectra_of(
                    &history,
                    results,
                    entry.described.machine.periodic,
                ));
            }
            let caption = format!("{}, {}. {span}.", history.title, entry.name());
            section = section.figure(history, caption);
        }
        if let Some(orbits) = orbits(&entry.outcome) {
            let caption = format!(
                "{}, {}, seen against their z. The last cycle is drawn strongly; the circle is the radial clearance.",
                orbits.title,
                entry.name()
            );
            section = section.figure(orbits, caption);
        }
        if entry.point.is_empty() {
            for polar in loads::polar(entry, cut)? {
                let caption = format!(
                    "{}, {}, in the axes above each diagram, seen against their z. The tip points at the side that carries the load. {span}.",
                    polar.title,
                    entry.name()
                );
                section = section.figure(polar, caption);
            }
        }
        if !elsewhere.is_empty() {
            section = section.paragraph(
                "Its other histories stand beside those of the other points, under Comparisons.",
            );
        }
        for figure in spectra {
            let caption = format!("{}, {}. {span}.", figure.title, entry.name());
            section = section.figure(figure, caption);
        }
    }
    if let Some(audit) = tables::energy(results) {
        let caption = format!("Energy, {}: {}", entry.name(), span.to_lowercase());
        section = section.table(audit.table(&caption));
    }
    Ok(section)
}
