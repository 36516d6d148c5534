//! The pictures of an analysis.

use crate::machine::JournalGeometry;
use crate::plot::{Abscissa, Curve, History, Orbit, Orbits, Ordinate, Panel, Scale};
use crate::results::{CYCLE_ANGLE, Column, Results, TIME};
use crate::run::RunOutcome;
use eng_report::figure::{Mark, journal_letter};
use eng_report::readable_unit;
use eng_system::Dimension;

/// File names (without extension) and SVG texts: the forces and orbits of the journals, and the model's own
/// outputs.
pub(crate) fn of_analysis(outcome: &RunOutcome) -> Vec<(String, String)> {
    let mut figures: Vec<(String, String)> = histories(outcome)
        .into_iter()
        .map(|pictured| (pictured.name, pictured.figure.to_svg()))
        .collect();
    if let Some(orbits) = orbits(outcome) {
        let name = format!("{}-orbits", outcome.results.analysis());
        figures.push((name, orbits.to_svg()));
    }
    figures
}

/// A figure of histories, with its columns.
pub(crate) struct Pictured {
    pub dimension: Dimension,
    /// Name for a file.
    pub name: String,
    /// The columns, in the order of the curves.
    pub paths: Vec<String>,
    pub figure: History,
}

/// The model's outputs and the forces of its journals.
pub(crate) fn histories(outcome: &RunOutcome) -> Vec<Pictured> {
    let results = &outcome.results;
    let mut wanted = families(results);
    wanted.extend(["x", "y"].map(|axis| journal_forces(outcome, axis)));
    let one = [(String::new(), results)];
    wanted
        .iter()
        .filter_map(|family| {
            let dimension = family.columns(results).first()?.dimension;
            let figure = history(&about(results), family, &one, outcome)?;
            Some(Pictured {
                dimension,
                name: format!("{}-{}", results.analysis(), family.name),
                paths: family.paths.clone(),
                figure,
            })
        })
        .collect()
}

/// One figure for each family of model outputs that several analyses have. It has a panel for each analysis,
/// up to four of one model.
pub(crate) fn comparisons(outcomes: &[&RunOutcome]) -> Vec<(String, String)> {
    compared(outcomes)
        .into_iter()
        .map(|pictured| (pictured.name, pictured.figure.to_svg()))
        .collect()
}

/// The figures of [`comparisons`] before drawing.
pub(crate) fn compared(outcomes: &[&RunOutcome]) -> Vec<Pictured> {
    let Some(first) = outcomes.first() else {
        return Vec::new();
    };
    let compared: Vec<&Results> = outcomes
        .iter()
        .map(|o| &o.results)
        .filter(|r| r.model() == first.results.model())
        .collect();
    if !(2..=4).contains(&compared.len()) {
        return Vec::new();
    }
    let names: Vec<&str> = compared.iter().map(|r| r.analysis()).collect();
    let panels: Vec<(String, &Results)> = compared
        .iter()
        .map(|r| (r.analysis().to_owned(), *r))
        .collect();
    let subtitle = format!(
        "{}, {}, not filtered",
        first.results.model(),
        names.join(" and ")
    );
    let mut wanted = families(&first.results);
    wanted.push(journal_forces(first, "x"));
    wanted
        .iter()
        .filter(|family| {
            panels
                .iter()
                .all(|(_, r)| family.columns(r).len() == family.paths.len())
        })
        .filter_map(|family| {
            Some(Pictured {
                dimension: family.columns(&first.results).first()?.dimension,
                name: format!("{}-{}", names.join("-"), family.name),
                paths: family.paths.clone(),
                figure: history(&subtitle, family, &panels, first)?,
            })
        })
        .collect()
}

/// Columns that share a pair of axes.
struct Family {
    /// Name for the file.
    name: String,
    /// The drawn quantity.
    quantity: String,
    paths: Vec<String>,
}

impl Family {
    fn columns<'a>(&self, results: &'a Results) -> Vec<&'a Column> {
        self.paths
            .iter()
            .filter_map(|path| results.column(path))
            .collect()
    }
}

/// The model's own outputs (no dot in the path). Outputs with one name and different indices form a family.
fn families(results: &Results) -> Vec<Family> {
    let mut families: Vec<Family> = Vec::new();
    for column in results.columns() {
        if column.path.contains('.') || column.path == TIME {
            continue;
        }
        let name = column.path.split('[').next().unwrap_or_default();
        match families.iter_mut().find(|f| f.name == name) {
            Some(family) => family.paths.push(column.path.clone()),
            None => families.push(Family {
                name: name.to_owned(),
                quantity: name.replace('_', " "),
                paths: vec![column.path.clone()],
            }),
        }
    }
    families
}

/// A text that begins with a capital.
pub(crate) fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| {
        first.to_uppercase().chain(letters).collect()
    })
}

fn journal_forces(outcome: &RunOutcome, axis: &str) -> Family {
    Family {
        name: format!("journal-force-{axis}"),
        quantity: format!("Journal force {axis} on the pin"),
        paths: outcome
            .machine
            .journals
            .iter()
            .map(|journal| format!("{}.force.{axis}", journal.path))
            .collect(),
    }
}

pub(crate) fn about(results: &Results) -> String {
    format!(
        "{}, analysis {}, not filtered",
        results.model(),
        results.analysis()
    )
}

/// Letters of the journals, as in a paper, each with the axes of its forces.
pub(crate) fn letters(results: &Results, journals: &[JournalGeometry]) -> Vec<(String, String)> {
    let all: Vec<(String, String)> = journals
        .iter()
        .enumerate()
        .filter_map(|(index, journal)| {
            let force = format!("{}.force.x", journal.path);
            let frame = results.column(&force)?.frame.clone();
            Some((frame, journal_letter(index)))
        })
        .collect();
    // axes shared by several journals identify none of them
    let alone = |frame: &str| all.iter().filter(|(other, _)| other == frame).count() == 1;
    all.iter()
        .filter(|(frame, _)| alone(frame))
        .cloned()
        .collect()
}

/// Marks of firing dead centres in a cycle (rad).
pub(crate) fn firing_marks(firing: &[(Option<usize>, f64)], period: f64) -> Vec<Mark> {
    let period = period.to_degrees();
    firing
        .iter()
        .map(|(cylinder, angle)| Mark::firing_tdc(*cylinder, angle.to_degrees(), period))
        .collect()
}

/// A history of a family with a panel for each of the results; `None` if there is nothing to draw. A curve in
/// the axes of a journal's shell has the letter of the journal. Journals and firing dead centres come from
/// one outcome, because a model has one firing order.
fn history(
    subtitle: &str,
    family: &Family,
    panels: &[(String, &Results)],
    of: &RunOutcome,
) -> Option<History> {
    let letters = letters(&of.results, &of.machine.journals);
    let columns: Vec<&Column> = panels.iter().flat_map(|(_, r)| family.columns(r)).collect();
    let display = &columns.first()?.display;
    let with_angle = panels.iter().all(|(_, r)| r.column(CYCLE_ANGLE).is_some());
    let abscissa = if with_angle { CYCLE_ANGLE } else { TIME };
    let frames: Vec<&str> = columns.iter().map(|c| c.frame.as_str()).collect();
    let mut drawn = Vec::new();
    for (title, results) in panels {
        drawn.push(Panel {
            title: title.clone(),
            x: results.column(abscissa)?.shown(),
            curves: family
                .columns(results)
                .into_iter()
                .map(|column| Curve {
                    name: match letters.iter().find(|(frame, _)| *frame == column.frame) {
                        Some((_, letter)) => format!("{letter} {}", curve_name(&column.path)),
                        None => curve_name(&column.path),
                    },
                    values: column.values.iter().map(|v| display.from_si(*v)).collect(),
                })
                .collect(),
        });
    }
    Some(History {
        title: capital(&family.quantity),
        subtitle: subtitle.to_owned(),
        abscissa: if with_angle {
            Abscissa::CrankAngle
        } else {
            Abscissa::Time
        },
        ordinate: Ordinate {
            quantity: family.quantity.clone(),
            unit: readable_unit(&display.symbol),
            frame: common_frame(&frames),
        },
        scale: Scale::Linear,
        marks: match of.machine.cycle_period.filter(|_| with_angle) {
            Some(period) => firing_marks(&of.machine.firing, period),
            None => Vec::new(),
        },
        panels: drawn,
    })
}

/// `main[1]` of `main[1].force.x`.
fn curve_name(path: &str) -> String {
    path.split(".force.").next().unwrap_or(path).to_owned()
}

/// One name for the frames of several curves: `block.main[1…5]` if they differ in one number.
pub(crate) fn common_frame(frames: &[&str]) -> String {
    let mut distinct: Vec<&str> = Vec::new();
    for frame in frames {
        if !distinct.contains(frame) {
            distinct.push(frame);
        }
    }
    let (Some(first), Some(last)) = (distinct.first(), distinct.last()) else {
        return String::new();
    };
    if distinct.len() == 1 {
        return (*first).to_owned();
    }
    let around = |frame: &str| {
        let (head, rest) = frame.rsplit_once('[')?;
        let (index, tail) = rest.split_once(']')?;
        Some((head.to_owned(), index.to_owned(), tail.to_owned()))
    };
    match (around(first), around(last)) {
        (Some((head, from, tail)), Some((_, to, _)))
            if distinct
                .iter()
                .all(|f| around(f).is_some_and(|(h, _, t)| h == head && t == tail)) =>
        {
            format!("{head}[{from}…{to}]{tail}")
        }
        _ => distinct.join(", "),
    }
}

/// Orbits of the journals' pins, if the model has journals.
pub(crate) fn orbits(outcome: &RunOutcome) -> Option<Orbits> {
    let results = &outcome.results;
    let angle = results
        .column(CYCLE_ANGLE)
        .map_or_else(Vec::new, Column::shown);
    let orbits: Vec<Orbit> = outcome
        .machine
        .journals
        .iter()
        .enumerate()
        .filter_map(|(index, journal)| {
            let x = results.column(&format!("{}.eccentricity.x", journal.path))?;
            let y = results.column(&format!("{}.eccentricity.y", journal.path))?;
            Some(Orbit {
                name: format!("{} {}", journal_letter(index), journal.path),
                frame: x.frame.clone(),
                clearance: journal.radial_clearance,
                x: x.values.clone(),
                y: y.values.clone(),
                angle: angle.clone(),
            })
        })
        .collect();
    if orbits.is_empty() {
        return None;
    }
    Some(Orbits {
        title: "Orbits of the pins in their shells".to_owned(),
        // the orbits show the whole run, while the table of journals shows the last cycle
        subtitle: format!("{}; ε ≤: over the whole run", about(results)),
        period: outcome.machine.cycle_period.map_or(360.0, f64::to_degrees),
        upright: outcome.machine.upright,
        orbits,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_named_together() {
        assert_eq!(common_frame(&["ground", "ground"]), "ground");
        assert_eq!(common_frame(&["", ""]), "");
        let shells = ["block.main[1]", "block.main[2]", "block.main[5]"];
        assert_eq!(common_frame(&shells), "block.main[1…5]");
        assert_eq!(common_frame(&["a", "b"]), "a, b");
    }

    #[test]
    fn families_are_the_models_outputs() {
        let mut results = Results::new("a", "M");
        results.push(Column::time(vec![0.0])).unwrap();
        for path in [
            "vertical[1]",
            "vertical[2]",
            "crank_torque",
            "main[1].force.x",
        ] {
            let mut column = Column::time(vec![1.0]);
            column.path = path.to_owned();
            results.push(column).unwrap();
        }
        let found: Vec<(String, usize)> = families(&results)
            .into_iter()
            .map(|f| (f.quantity, f.paths.len()))
            .collect();
        assert_eq!(
            found,
            [("vertical".to_owned(), 2), ("crank torque".to_owned(), 1)]
        );
    }
}
