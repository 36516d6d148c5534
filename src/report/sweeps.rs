//! The section of a sweep: the results of its points side by side, and their spectra over speed.

use super::Entry;
use super::drawn::drawn;
use crate::figures::{Wanted, campbell, over_variable, waterfall};
use crate::indexed::base;
use crate::post::{ORDERS, Run, capital};
use crate::results::{CYCLE_ANGLE, Column, Results, TIME};
use crate::run::RunOutcome;
use crate::tables::readable;
use crate::tables::sweep::{families, table};
use eng_report::figure::Figure;
use eng_report::page::{self as pages, Cell, Section, Table};
use eng_report::readable_unit;
use eng_system::Dimension;
use std::f64::consts::TAU;

/// Least number of speeds of a map. A choice: with fewer speeds, single spectra show more.
const SPEEDS: usize = 4;
/// Largest number of points with one column each in their table. A choice: the width of a page.
const FEW: usize = 6;
/// Columns of the table of more points. A choice: the width of a page.
const COLUMNS: usize = 13;

/// A section for each sweep. `cut` are the last cycles of the analyses, `modes` the linear analyses.
pub(super) fn sections(modes: &[Entry], cut: &[RunOutcome]) -> Vec<Section> {
    families(cut)
        .into_iter()
        .map(|family| {
            let points = table(&family);
            let mut section =
                Section::new(format!("Sweep {}", points.analysis())).table(shown(&points));
            let runs: Vec<Run<'_>> = family
                .iter()
                .map(|o| Run::new(&points, &o.machine))
                .take(1)
                .collect();
            section = drawn(section, &over_points(&points, &family), &runs);
            maps(section, modes, &family)
        })
        .collect()
}

/// The table of points. Few points have one column each. Many points have one row each, with some of the
/// quantities; the file has all of them.
fn shown(points: &Results) -> Table {
    let all = points.columns();
    let cell = |column: &Column, row: usize| match column.values.get(row) {
        Some(value) => Cell::Short {
            value: column.display.from_si(*value),
            digits: 5,
        },
        None => Cell::Empty,
    };
    let name = points.analysis();
    if points.samples() <= FEW {
        let mut columns = vec![pages::Column::new("Quantity"), pages::Column::new("Unit")];
        columns.extend((1..=points.samples()).map(|k| pages::Column::new(&format!("{name}[{k}]"))));
        return Table {
            caption: format!("Points of {name}, of the last cycle"),
            columns,
            rows: all
                .iter()
                .map(|c| {
                    let mut row = vec![
                        Cell::Code(c.path.clone()),
                        readable_unit(&c.display.symbol).into(),
                    ];
                    row.extend((0..points.samples()).map(|k| cell(c, k)));
                    row
                })
                .collect(),
        };
    }
    let few = all.get(..COLUMNS.min(all.len())).unwrap_or_default();
    Table {
        caption: match all.len() - few.len() {
            0 => format!("Points of {name}, of the last cycle"),
            more => format!(
                "Points of {name}, of the last cycle; {more} more quantities are in {name}.parquet"
            ),
        },
        columns: few
            .iter()
            .map(|c| {
                let heading = c.path.replace('_', " ");
                pages::Column::with_unit(&heading, &readable_unit(&c.display.symbol))
            })
            .collect(),
        rows: (0..points.samples())
            .map(|row| few.iter().map(|c| cell(c, row)).collect())
            .collect(),
    }
}

/// The summaries of elements and the extremes of outputs over the variable of the sweep, with captions. A
/// sweep of several variables, or of one that is no number, has none.
fn over_points(points: &Results, family: &[&RunOutcome]) -> Vec<(Wanted, String)> {
    let Some([variable]) = family.first().map(|o| o.point.as_slice()) else {
        return Vec::new();
    };
    let places = family.iter().map(|o| o.point.first().map(|p| p.value));
    let increasing = places
        .collect::<Vec<_>>()
        .windows(2)
        .all(|pair| matches!(pair, [Some(a), Some(b)] if a < b));
    let Some(x) = points.column(&variable.name).filter(|_| increasing) else {
        return Vec::new();
    };
    // the index in a list is no quantity
    let place = |(k, value): (usize, &f64)| *value == (k + 1) as f64;
    if variable.dimension == Dimension::ONE && x.values.iter().enumerate().all(place) {
        return Vec::new();
    }
    let mut groups: Vec<(String, Vec<&Column>)> = Vec::new();
    for column in points.columns() {
        let Some((owner, taken)) = column.path.rsplit_once('.') else {
            continue;
        };
        let taken = capital(taken);
        // an output of the model has no dot in its name
        let name = match owner.rsplit_once('.') {
            Some((element, output)) => format!(
                "{taken} {} of {}",
                readable(output),
                readable(base(element))
            ),
            None => format!("{taken} {}", readable(base(owner))),
        };
        match groups.iter_mut().find(|(other, _)| *other == name) {
            Some((_, columns)) => columns.push(column),
            None => groups.push((name, vec![column])),
        }
    }
    let of = match family.first().is_some_and(|o| o.results.is_state()) {
        true => "state",
        false => "last cycle",
    };
    let sweep = points.analysis();
    let figures = groups.into_iter().map(|(title, columns)| {
        let caption = format!("{title}, sweep {sweep}. Of the {of} of each point.");
        (over_variable(sweep, title, x, &columns), caption)
    });
    figures.collect()
}

/// Waterfalls and Campbell diagrams of the model's own forces and accelerations over the speeds of the
/// points. Of outputs with one name and different indices, the one with the largest amplitude at any speed is
/// shown.
fn maps(section: Section, modes: &[Entry], family: &[&RunOutcome]) -> Section {
    let speeds: Vec<f64> = family
        .iter()
        .filter_map(|o| mean_speed(&o.results))
        .collect();
    let highest = speeds.iter().copied().fold(0.0, f64::max);
    // a sweep of another variable than the speed has no maps; one rpm is no difference of speeds
    let apart = |(k, speed): (usize, &f64)| {
        let mut before = speeds.iter().take(k);
        before.all(|other| (other - speed).abs() > 1.0 / 60.0)
    };
    let all_apart = speeds.len() == family.len() && speeds.iter().enumerate().all(apart);
    let Some(first) = family
        .first()
        .filter(|_| all_apart && speeds.len() >= SPEEDS)
    else {
        return section;
    };
    let natural = natural(modes, first.results.model());
    let runs: Vec<Run<'_>> = family
        .iter()
        .map(|o| Run::new(&o.results, &o.machine))
        .chain(
            modes
                .iter()
                .map(|m| Run::new(&m.outcome.results, &m.outcome.machine)),
        )
        .collect();
    let points = runs.get(..family.len()).unwrap_or_default();
    let mut chosen: Vec<(&str, f64, &str)> = Vec::new();
    for column in first.results.columns() {
        let path = column.path.as_str();
        if path.contains('.') {
            continue;
        }
        let Some(wanted) = waterfall(path, points, None) else {
            continue;
        };
        let largest = match wanted.draw(&runs) {
            Ok(Figure::Waterfall(drawn)) => {
                let amplitudes = drawn.figure.map.amplitudes().iter().flatten();
                amplitudes.copied().fold(0.0, f64::max)
            }
            // the drawing refuses it again, with the reason
            _ => 0.0,
        };
        let family = base(path);
        match chosen.iter_mut().find(|(name, ..)| *name == family) {
            Some(known) if known.1 < largest => *known = (family, largest, path),
            Some(_) => {}
            None => chosen.push((family, largest, path)),
        }
    }
    let name = base(first.results.analysis());
    let mut figures = Vec::new();
    for (_, _, path) in chosen {
        let title = path.replace('_', " ");
        if let Some(wanted) = waterfall(path, points, Some(ORDERS * highest)) {
            let caption = format!(
                "Waterfall of {title}, sweep {name}: spectra of the last cycle of each point, over its mean speed."
            );
            figures.push((wanted, caption));
        }
        if let Some(wanted) = campbell(path, points, natural.clone()) {
            let caption = format!(
                "Campbell diagram of {title}, sweep {name}, with the lines of the main orders."
            );
            figures.push((wanted, caption));
        }
    }
    drawn(section, &figures, &runs)
}

/// The mean speed of the cycle (revolutions per second), if it turns.
fn mean_speed(results: &Results) -> Option<f64> {
    let span = |path| {
        let values = &results.column(path)?.values;
        Some(values.last()? - values.first()?)
    };
    let speed = (span(CYCLE_ANGLE)? / span(TIME)? / TAU).abs();
    (speed > 0.0 && speed.is_finite()).then_some(speed)
}

/// Linear analyses for the natural frequencies of a model: its first sweep of a linear analysis, else its
/// first linear analysis.
fn natural(modes: &[Entry], model: &str) -> Vec<String> {
    let own = || modes.iter().filter(|m| m.outcome.results.model() == model);
    let first = own().find(|m| !m.point.is_empty()).or(own().next());
    let name = first.map(|entry| base(entry.name()));
    own()
        .filter(|m| Some(base(m.name())) == name)
        .map(|m| m.name().to_owned())
        .collect()
}
