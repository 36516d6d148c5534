//! The page: which sections, in which order.

use super::describe::Matter;
use super::scene::{Scene, scene};
use super::spectra::{of_last_cycle, spectra_of};
use super::{Entry, ReportError, tables};
use crate::Reduction;
use crate::cli::RunOutcome;
use crate::cli::figures::{compared, histories, orbits};
use crate::post::{self, Run, RunModel};
use eng_flexible::store::hexadecimal;
use eng_report::figure::{History, Mark};
use eng_report::page::{Page, Provenance, Section};
use eng_system::Dimension;
use eng_system::report::Report;

/// Animations of a page.
const ANIMATED: usize = 2;
/// About how many bytes of a page the pictures of flexible bodies take, all animations together.
const BUDGET: usize = 5_000_000;
/// More points of a sweep than these get no figures of their own.
const POINTS: usize = 4;

/// A page with what belongs to it.
#[derive(Clone, Debug)]
pub struct Made {
    /// The HTML file's text.
    pub html: String,
    /// The first animation as a binary glTF file, where something moves.
    pub gltf: Option<Vec<u8>>,
    /// What could not be shown, a sentence each.
    pub warnings: Vec<String>,
}

/// Makes the page of a model's results. `missing` are analyses without results, `reports` those of the text, `command` is what was
/// typed.
///
/// # Errors
/// Results and model that do not fit together.
pub fn make(
    file: &str,
    entries: &[Entry],
    missing: &[String],
    reports: &[Report],
    command: &str,
) -> Result<Made, ReportError> {
    let mut warnings = Vec::new();
    for entry in entries {
        if entry.outdated() {
            warnings.push(format!(
                "{}: the model's text is not that of the results; run it again",
                entry.name()
            ));
        }
        if entry.outcome.motion.is_none() {
            warnings.push(format!("{}: no motion was kept", entry.name()));
        }
    }
    let mut scenes: Vec<(&Entry, Scene)> = Vec::new();
    let animated: Vec<&Entry> = entries
        .iter()
        .filter(|e| e.outcome.motion.is_some())
        .take(ANIMATED)
        .collect();
    for entry in &animated {
        if let Some(motion) = &entry.outcome.motion {
            match scene(entry, motion, BUDGET / animated.len()) {
                Ok(made) => scenes.push((entry, made)),
                // the rest of the page is of use without it
                Err(error @ (ReportError::Modes { .. } | ReportError::Results(_))) => {
                    warnings.push(error.to_string());
                }
                Err(error) => return Err(error),
            }
        }
    }
    let gltf = match scenes.first() {
        Some((_, scene)) => Some(scene.animation.to_glb()?),
        None => None,
    };
    let cut: Vec<RunOutcome> = entries
        .iter()
        .map(of_last_cycle)
        .collect::<Result<_, _>>()?;
    let names: Vec<&str> = entries.iter().map(Entry::name).collect();
    let mut page = Page::new(format!("Report of {file}"))
        .subtitle(format!("analyses {}", names.join(", ")))
        .section(summary(entries, missing, &warnings));
    for section in reported(reports, entries) {
        page = page.section(section);
    }
    page = page.section(inputs(entries));
    if let Some(section) = flexible(entries) {
        page = page.section(section);
    }
    for (entry, cut) in entries.iter().zip(&cut) {
        page = page.section(analysis(entry, cut, entries)?);
    }
    if let Some(section) = comparison(entries, &cut) {
        page = page.section(section);
    }
    if let Some(section) = motion(scenes) {
        page = page.section(section);
    }
    let html = page.section(provenance(entries, command)).to_html()?;
    Ok(Made {
        html,
        gltf,
        warnings,
    })
}

fn summary(entries: &[Entry], missing: &[String], warnings: &[String]) -> Section {
    let mut section = Section::new("Summary").table(tables::analyses(entries));
    for warning in warnings {
        section = section.warning(warning);
    }
    if !missing.is_empty() {
        section = section.paragraph(format!("Without results: {}.", missing.join(", ")));
    }
    section
}

/// What the text itself reports.
fn reported(reports: &[Report], entries: &[Entry]) -> Vec<Section> {
    let models: Vec<RunModel> = entries
        .iter()
        .map(|entry| RunModel::from(&entry.described))
        .collect();
    let runs: Vec<Run<'_>> = entries
        .iter()
        .zip(&models)
        .map(|(entry, model)| Run::new(&entry.outcome.results, model))
        .collect();
    reports
        .iter()
        .map(|report| post::section(&post::evaluate(report, &runs)))
        .collect()
}

fn inputs(entries: &[Entry]) -> Section {
    let mut section = Section::new("Inputs");
    let mut models: Vec<&str> = Vec::new();
    for entry in entries {
        let model = entry.outcome.results.model();
        if models.contains(&model) {
            continue;
        }
        models.push(model);
        let own: Vec<&Entry> = entries
            .iter()
            .filter(|e| e.outcome.results.model() == model)
            .collect();
        section = section.table(tables::inputs(model, &own));
    }
    section
}

fn flexible(entries: &[Entry]) -> Option<Section> {
    let mut told: Vec<(&Reduction, Vec<&str>)> = Vec::new();
    for entry in entries {
        for body in &entry.described.bodies {
            let Matter::Flexible(reduction) = &body.matter else {
                continue;
            };
            let same = told.iter_mut().find(|(other, _)| {
                other.path() == reduction.path() && other.stored.key == reduction.stored.key
            });
            match same {
                Some((_, names)) => names.push(entry.name()),
                None => told.push((reduction, vec![entry.name()])),
            }
        }
    }
    if told.is_empty() {
        return None;
    }
    let mut section = Section::new("Flexible bodies");
    for (reduction, names) in told {
        let mut body = Section::new(format!("{} in {}", reduction.path(), names.join(", ")))
            .facts(tables::body_facts(reduction));
        for warning in &reduction.stored.report.warnings {
            body = body.warning(warning);
        }
        section = section.section(body.table(tables::modes(reduction)));
    }
    Some(section)
}

/// Whether an analysis is one of many points of a sweep.
fn one_of_many(entry: &Entry, entries: &[Entry]) -> bool {
    let root = |entry: &Entry| entry.name().split('[').next().map(str::to_owned);
    !entry.point.is_empty() && entries.iter().filter(|e| root(e) == root(entry)).count() > POINTS
}

fn force() -> Dimension {
    Dimension::MASS.times(acceleration())
}

fn acceleration() -> Dimension {
    Dimension::LENGTH
        .over(Dimension::TIME)
        .over(Dimension::TIME)
}

/// A history from 0 on with the firing dead centres.
fn marked(mut history: History, entry: &Entry) -> History {
    if let Some(period) = entry.described.cycle_period {
        history.marks = entry
            .described
            .firing
            .iter()
            .map(|(cylinder, angle)| {
                Mark::firing_tdc(*cylinder, angle.to_degrees(), period.to_degrees())
            })
            .collect();
    }
    history
}

fn analysis(entry: &Entry, cut: &RunOutcome, entries: &[Entry]) -> Result<Section, ReportError> {
    let span =
        if cut.results.samples() < entry.outcome.results.samples() || entry.described.periodic {
            "Last cycle"
        } else {
            "Whole run"
        };
    let mut section = Section::new(format!("Analysis {}", entry.name()));
    if let Some(table) = tables::journals(entry) {
        section = section.table(table);
    }
    if !one_of_many(entry, entries) {
        let mut spectra = Vec::new();
        for (dimension, _, history) in histories(cut) {
            // a sweep is compared point by point; its spectra would be most of the page
            let wanted = [force(), acceleration()].contains(&dimension);
            if wanted && entry.point.is_empty() {
                spectra.extend(spectra_of(&history, &cut.results, entry.described.periodic));
            }
            let caption = format!("{}, {}. {span}.", history.title, entry.name());
            section = section.figure(marked(history, entry), caption);
        }
        if let Some(orbits) = orbits(&entry.outcome) {
            let caption = format!(
                "{}, {}. The last cycle is drawn strongly; the circle is the clearance.",
                orbits.title,
                entry.name()
            );
            section = section.figure(orbits, caption);
        }
        for figure in spectra {
            let caption = format!("{}, {}. {span}.", figure.title, entry.name());
            section = section.figure(figure, caption);
        }
    }
    if let Some(audit) = tables::energy(&cut.results) {
        let caption = format!("Energy, {}: {}", entry.name(), span.to_lowercase());
        section = section.table(audit.table(&caption));
    }
    Ok(section)
}

/// Analyses of a model beside each other; and the points of a short sweep.
fn comparison(entries: &[Entry], cut: &[RunOutcome]) -> Option<Section> {
    let mut groups: Vec<(&str, Vec<&RunOutcome>)> = Vec::new();
    for (entry, cut) in entries.iter().zip(cut) {
        let group = if entry.point.is_empty() {
            ""
        } else {
            entry.name().split('[').next().unwrap_or_default()
        };
        match groups.iter_mut().find(|(name, _)| *name == group) {
            Some((_, members)) => members.push(cut),
            None => groups.push((group, vec![cut])),
        }
    }
    let mut section = Section::new("Comparisons");
    let mut any = false;
    for (_, members) in groups {
        for (_, figure) in compared(&members) {
            let names: Vec<&str> = members.iter().map(|m| m.results.analysis()).collect();
            let caption = format!("{}: {}. Last cycle.", figure.title, names.join(", "));
            section = section.figure(figure, caption);
            any = true;
        }
    }
    any.then_some(section)
}

fn motion(scenes: Vec<(&Entry, Scene)>) -> Option<Section> {
    if scenes.is_empty() {
        return None;
    }
    let mut section = Section::new("Motion and stress");
    for (entry, scene) in scenes {
        let mut own = Section::new(format!("Motion, {}", entry.name()));
        if !scene.animation.flexible.is_empty() {
            own = own.paragraph(
                "Flexible bodies move with the shapes of their modes; the slider scales their displacements only. Stresses are \
                 those of the modes, at nodes the mean of the elements that meet there, and an envelope over the times of the motion.",
            );
        }
        if !scene.animation.rigid.is_empty() {
            own = own.paragraph(
                "Rigid bodies are drawn as bars between their markers, or as the solid that has their mass and inertia; large discs as outlines.",
            );
        }
        for view in scene.views() {
            own = own.animation(view);
        }
        if !scene.notes.is_empty() {
            own = own.list(scene.notes);
        }
        for table in scene.maxima {
            own = own.table(table);
        }
        section = section.section(own);
    }
    Some(section)
}

fn provenance(entries: &[Entry], command: &str) -> Section {
    let mut versions = vec![(
        "eng, this report".to_owned(),
        env!("CARGO_PKG_VERSION").to_owned(),
    )];
    let mut hashes = Vec::new();
    if let Some(entry) = entries.first() {
        hashes.push((
            "texts of the model, now".to_owned(),
            format!("sha256:{}", entry.described.source_hash),
        ));
    }
    for entry in entries {
        let metadata = entry.outcome.results.metadata();
        if let Some(version) = metadata.get("version") {
            versions.push((format!("eng, {}", entry.name()), version.clone()));
        }
        if let Some(hash) = metadata.get("source_hash") {
            let name = format!("texts of the model, {}", entry.name());
            hashes.push((name, format!("sha256:{hash}")));
        }
        hashes.extend(
            entry
                .files
                .iter()
                .map(|(name, hash)| (name.clone(), format!("sha256:{hash}"))),
        );
        for body in &entry.described.bodies {
            let Matter::Flexible(reduction) = &body.matter else {
                continue;
            };
            let stored = &reduction.stored;
            let mut found = vec![(
                format!("reduction of {}, {}", body.path, entry.name()),
                hexadecimal(&stored.key.0),
            )];
            found.extend(
                stored
                    .provenance
                    .iter()
                    .filter(|(name, _)| name.starts_with("file "))
                    .cloned(),
            );
            for (name, hash) in found {
                let row = (name, format!("sha256:{hash}"));
                if !hashes.contains(&row) {
                    hashes.push(row);
                }
            }
        }
    }
    let provenance = Provenance {
        command: command.to_owned(),
        versions,
        hashes,
        notes: Vec::new(),
    };
    Section::new("Provenance").table(provenance.table("How this came to be"))
}
