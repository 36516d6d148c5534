//! The page: its sections and their order.

use super::analyses::Detail;
use super::describe::Matter;
use super::drawn::drawn;
use super::last_cycle::of_last_cycle;
use super::scene::{Scene, scene};
use super::{At, Entry, ReportError, analyses, mixed, provenance, sweeps, tables};
use crate::Reduction;
use crate::figures::{self, Wanted, distinct};
use crate::indexed::base;
use crate::post::{self, EvaluatedReport, Run};
use crate::repetition::Repetition;
use crate::run::RunOutcome;
use eng_report::page::{Page, Section};
use eng_system::report::Report;

/// Most animations of a page. A choice: each has megabytes.
const ANIMATED: usize = 2;
/// Approximate size in bytes of the pictures of flexible bodies in all animations of a page. A choice: mail
/// and browsers take such a page.
const BUDGET: usize = 5_000_000;
/// Largest number of points of a sweep with figures of their own. A choice: more have figures over the sweep.
const POINTS: usize = 4;

/// The contents of a page.
#[derive(Clone, Debug, Default)]
pub struct Request<'a> {
    /// The model's file.
    pub file: &'a str,
    /// The results.
    pub entries: &'a [Entry],
    /// Results of linear analyses, for the reports of the text and for Campbell diagrams.
    pub modes: &'a [Entry],
    /// Analyses without results.
    pub missing: &'a [String],
    /// The reports of the text.
    pub reports: &'a [Report],
    /// The command line.
    pub command: &'a str,
    /// Moments at which stresses are shown, besides those of the largest.
    pub stress_at: &'a [At],
    /// Whether the figures are wanted as files, too.
    pub drawn: bool,
}

/// A figure of the page as a file of its own.
#[derive(Clone, Debug)]
pub struct Drawn {
    /// `figure-07-orbits-of-the-pins-in-their-shells-unfired`.
    pub name: String,
    /// Its text.
    pub svg: String,
}

/// A page with its files.
#[derive(Clone, Debug)]
pub struct Made {
    /// The HTML file's text.
    pub html: String,
    /// The first animation as a binary glTF file, if there is one.
    pub gltf: Option<Vec<u8>>,
    /// The figures, if they were requested.
    pub figures: Vec<Drawn>,
    /// One sentence for each part that could not be shown.
    pub warnings: Vec<String>,
}

/// Makes the page of a model's results.
///
/// # Errors
/// Results and model that do not fit together.
pub fn make(request: Request<'_>) -> Result<Made, ReportError> {
    let Request {
        file,
        entries,
        modes,
        missing,
        reports,
        command,
        stress_at,
        drawn,
    } = request;
    let mut warnings = Vec::new();
    for entry in entries {
        if entry.outdated() {
            warnings.push(format!(
                "{}: the results are of another text of the model; run it again",
                entry.name()
            ));
        }
        let repetition = Repetition::of(entry.outcome.results.metadata());
        if let Some(found) = repetition.filter(|found| !found.repeats) {
            warnings.push(format!("{}: {}", entry.name(), found.text()));
        }
        if entry.outcome.motion.is_none() {
            warnings.push(format!("{}: the results have no motion", entry.name()));
        }
    }
    let all: Vec<_> = entries
        .iter()
        .chain(modes)
        .map(|e| (&e.outcome.results, &e.described))
        .collect();
    warnings.extend(mixed(&all));
    let mut scenes: Vec<(&Entry, Scene)> = Vec::new();
    let animated: Vec<&Entry> = entries
        .iter()
        .filter(|e| e.outcome.motion.is_some())
        .take(ANIMATED)
        .collect();
    for entry in &animated {
        if let Some(motion) = &entry.outcome.motion {
            match scene(entry, motion, BUDGET / animated.len(), stress_at) {
                Ok(made) => {
                    let own = made.warnings.iter();
                    warnings.extend(own.map(|w| format!("{}: {w}", entry.name())));
                    scenes.push((entry, made));
                }
                // the rest of the page is useful without it
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
    for made in reported(reports, &[entries, modes].concat()) {
        page = page.section(post::section(&made));
        // the section says it on the page
        warnings.extend(made.faults().map(|(entry, error)| {
            let (name, report) = (&entry.name, &made.name);
            format!("`{name}` of the report `{report}` is not made: {error}")
        }));
    }
    page = page.section(inputs(entries));
    if let Some(section) = flexible(entries) {
        page = page.section(section);
    }
    for section in sweeps::sections(modes, &cut) {
        page = page.section(section);
    }
    let compared = comparisons(entries, &cut);
    for (entry, own) in entries.iter().zip(&cut) {
        let detail = if one_of_many(entry, entries) {
            Detail::Numbers
        } else if entry.point.is_empty() {
            Detail::Whole
        } else {
            let titles = compared
                .iter()
                .filter(|c| c.names.iter().any(|n| n == entry.name()));
            Detail::Point(titles.map(|c| c.wanted.title.clone()).collect())
        };
        page = page.section(analyses::section(entry, own, &detail)?);
    }
    if !compared.is_empty() {
        page = page.section(comparison(compared, &cut));
    }
    if let Some(section) = motion(scenes) {
        page = page.section(section);
    }
    page = page.section(provenance::section(entries, command));
    let figures = if drawn { files(&page) } else { Vec::new() };
    Ok(Made {
        html: page.to_html()?,
        gltf,
        figures,
        warnings,
    })
}

/// The page's figures with names in the order of the page.
fn files(page: &Page) -> Vec<Drawn> {
    page.figures()
        .into_iter()
        .map(|figure| {
            // a figure without a name takes the first two parts of its caption: title and analysis
            let caption = figure.caption.split(". ").next().unwrap_or_default();
            let second = caption.match_indices(", ").nth(1);
            let parts = second.and_then(|(end, _)| caption.get(..end));
            let title = figure.name.as_deref().or(parts).unwrap_or(caption);
            let mut name = format!("figure-{:02}", figure.number);
            for word in title.split(|c: char| !c.is_ascii_alphanumeric()) {
                // a choice: names of files are limited to 255 bytes
                if !word.is_empty() && name.len() + word.len() < 100 {
                    name.push('-');
                    name.push_str(&word.to_ascii_lowercase());
                }
            }
            Drawn {
                name,
                svg: figure.svg,
            }
        })
        .collect()
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

/// The evaluated `report` blocks.
fn reported(reports: &[Report], entries: &[Entry]) -> Vec<EvaluatedReport> {
    let runs: Vec<Run<'_>> = entries
        .iter()
        .map(|entry| {
            Run::new(&entry.outcome.results, &entry.described.machine)
                .with_motion(entry.outcome.motion.as_ref())
                .with_gradients(&entry.outcome.gradients)
        })
        .collect();
    reports
        .iter()
        .map(|report| post::evaluate(report, &runs))
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
        let mut accepted: Vec<&String> = Vec::new();
        for line in own.iter().flat_map(|e| &e.described.accepted) {
            if !accepted.contains(&line) {
                accepted.push(line);
            }
        }
        if !accepted.is_empty() {
            section = section
                .paragraph(format!("The text of {model} accepts these lints:"))
                .list(accepted);
        }
    }
    section
}

fn flexible(entries: &[Entry]) -> Option<Section> {
    let mut reductions: Vec<(&Reduction, Vec<&str>)> = Vec::new();
    for entry in entries {
        for body in &entry.described.bodies {
            let Matter::Flexible(reduction) = &body.matter else {
                continue;
            };
            let same = reductions.iter_mut().find(|(other, _)| {
                other.path() == reduction.path() && other.stored.key == reduction.stored.key
            });
            match same {
                Some((_, names)) => names.push(entry.name()),
                None => reductions.push((reduction, vec![entry.name()])),
            }
        }
    }
    if reductions.is_empty() {
        return None;
    }
    let mut section = Section::new("Flexible bodies");
    for (reduction, names) in reductions {
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
    let own = |other: &&Entry| base(other.name()) == base(entry.name());
    !entry.point.is_empty() && entries.iter().filter(own).count() > POINTS
}

/// A figure of several analyses.
struct Compared {
    names: Vec<String>,
    wanted: Wanted,
}

/// Analyses of a model beside each other; and the points of a short sweep.
fn comparisons(entries: &[Entry], cut: &[RunOutcome]) -> Vec<Compared> {
    let mut groups: Vec<(&str, Vec<Run<'_>>)> = Vec::new();
    let moving = entries.iter().zip(cut);
    for (entry, cut) in moving.filter(|(_, cut)| !cut.results.is_state()) {
        let group = if entry.point.is_empty() {
            ""
        } else {
            base(entry.name())
        };
        let run = Run::new(&cut.results, &cut.machine);
        match groups.iter_mut().find(|(name, _)| *name == group) {
            Some((_, members)) => members.push(run),
            None => groups.push((group, vec![run])),
        }
    }
    let mut found = Vec::new();
    for (_, runs) in groups {
        let Some(results) = runs.first().map(|run| run.results) else {
            continue;
        };
        for wanted in distinct(figures::comparisons(&runs), results) {
            found.push(Compared {
                names: runs
                    .iter()
                    .filter(|run| run.results.model() == results.model())
                    .map(|run| run.results.analysis().to_owned())
                    .collect(),
                wanted,
            });
        }
    }
    found
}

fn comparison(compared: Vec<Compared>, cut: &[RunOutcome]) -> Section {
    let runs: Vec<Run<'_>> = cut
        .iter()
        .map(|cut| Run::new(&cut.results, &cut.machine))
        .collect();
    let captioned = compared.into_iter().map(|Compared { names, wanted }| {
        let names = names.join(", ");
        let caption = format!("{}: {names}. Last cycle.{}", wanted.title, wanted.same_as());
        (wanted, caption)
    });
    drawn(
        Section::new("Comparisons"),
        &captioned.collect::<Vec<_>>(),
        &runs,
    )
}

fn motion(scenes: Vec<(&Entry, Scene)>) -> Option<Section> {
    if scenes.is_empty() {
        return None;
    }
    let deforms = |scene: &Scene| !scene.animation.flexible.is_empty();
    let mut section = Section::new(if scenes.iter().any(|(_, scene)| deforms(scene)) {
        "Motion and stress"
    } else {
        "Motion"
    });
    for (entry, scene) in scenes {
        let mut own = Section::new(format!("Motion, {}", entry.name()));
        if deforms(&scene) {
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
