//! The section of a sweep: what its points come to, side by side, and their spectra over speed.

use super::Entry;
use super::analyses::{acceleration, force};
use super::spectra::{Hertz, in_hertz};
use crate::post::{Natural, ORDERS, main_orders, over_speed, with_floor};
use crate::results::{Column, Results};
use crate::run::RunOutcome;
use crate::tables::sweep::{families, table};
use eng_report::figure::{
    Abscissa, Campbell, Curve, History, Ordinate, Panel, Scale, SweepFigure, Waterfall,
    journal_letter,
};
use eng_report::page::{self as pages, Cell, Section, Table};
use eng_report::readable_unit;
use eng_report::signal::{Level, Spectrum, sweep_map};
use eng_system::Dimension;
use std::f64::consts::TAU;

/// Fewer speeds than these make no map.
const SPEEDS: usize = 4;
/// As many points have a column each in their table.
const FEW: usize = 6;
/// Columns of the table of more points.
const COLUMNS: usize = 13;

/// A section a sweep. `cut` are the last cycles of the entries, `modes` the linear analyses.
pub(super) fn sections(entries: &[Entry], modes: &[Entry], cut: &[RunOutcome]) -> Vec<Section> {
    families(cut)
        .into_iter()
        .map(|family| {
            let points = table(&family);
            let mut section =
                Section::new(format!("Sweep {}", points.analysis())).table(shown(&points));
            for figure in over_points(&points, &family) {
                let state = family.first().is_some_and(|o| o.results.is_state());
                let of = match state {
                    true => "state",
                    false => "last cycle",
                };
                let caption = format!(
                    "{}, sweep {}. Of the {of} of each point.",
                    figure.title,
                    points.analysis()
                );
                section = section.figure(figure, caption);
            }
            let own = family.first().and_then(|first| {
                let name = first.results.analysis();
                entries.iter().find(|e| e.name() == name)
            });
            match own {
                Some(entry) => maps(section, entry, modes, &family),
                None => section,
            }
        })
        .collect()
}

/// The table of points: of few a column each, of many a row each, then with some of the quantities; the file has all.
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

/// Journals' and outputs' extremes over the only variable of the sweep: none where it has several, or one that is no number.
fn over_points(points: &Results, family: &[&RunOutcome]) -> Vec<History> {
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
    // the place in a list is no quantity
    let place = |(k, value): (usize, &f64)| *value == (k + 1) as f64;
    if variable.dimension == Dimension::ONE && x.values.iter().enumerate().all(place) {
        return Vec::new();
    }
    let (abscissa, x) = if variable.dimension == Dimension::ANGLE.over(Dimension::TIME) {
        let rpm = x.values.iter().map(|v| v * 60.0 / TAU).collect();
        (Abscissa::Speed, rpm)
    } else {
        let abscissa = Abscissa::Other {
            name: variable.name.replace('_', " "),
            unit: readable_unit(&x.display.symbol),
        };
        (abscissa, x.shown())
    };
    let letters: Vec<&str> = family.first().map_or_else(Vec::new, |o| {
        o.machine.journals.iter().map(|j| j.path.as_str()).collect()
    });
    let mut groups: Vec<(String, Vec<&Column>)> = Vec::new();
    for column in points.columns() {
        let Some((owner, taken)) = column.path.rsplit_once('.') else {
            continue;
        };
        let base = owner.split('[').next().unwrap_or(owner).replace('_', " ");
        let name = match taken {
            "smallest" => format!("Smallest {base}"),
            "largest" => format!("Largest {base}"),
            "peak_load" => format!("Peak load of {base}"),
            "minimum_film" => format!("Minimum film of {base}"),
            "friction" => format!("Friction of {base}"),
            _ => continue,
        };
        match groups.iter_mut().find(|(other, _)| *other == name) {
            Some((_, columns)) => columns.push(column),
            None => groups.push((name, vec![column])),
        }
    }
    groups
        .into_iter()
        .filter_map(|(name, columns)| {
            let display = &columns.first()?.display;
            Some(History {
                title: name.clone(),
                subtitle: format!("{}, sweep {}", points.model(), points.analysis()),
                abscissa: abscissa.clone(),
                ordinate: Ordinate {
                    quantity: name,
                    unit: readable_unit(&display.symbol),
                    frame: String::new(),
                },
                scale: Scale::Linear,
                marks: Vec::new(),
                panels: vec![Panel {
                    title: String::new(),
                    x: x.clone(),
                    curves: columns
                        .iter()
                        .map(|column| Curve {
                            name: match column.path.rsplit_once('.') {
                                Some((owner, _)) => lettered(owner, &letters),
                                None => column.path.clone(),
                            },
                            values: column.values.iter().map(|v| display.from_si(*v)).collect(),
                        })
                        .collect(),
                }],
            })
        })
        .collect()
}

/// `A main[1]` of the path of the first journal; other paths as they are.
fn lettered(path: &str, journals: &[&str]) -> String {
    match journals.iter().position(|journal| *journal == path) {
        Some(index) => format!("{} {path}", journal_letter(index)),
        None => path.to_owned(),
    }
}

/// A column of all points as spectra over the mean speed.
struct Spectra {
    column: Column,
    /// Speed (rpm) and spectrum (Hz).
    runs: Vec<(f64, Spectrum)>,
    made: String,
    largest: f64,
}

/// Waterfalls and Campbell diagrams of the model's own forces and accelerations: of those of one name and different index the one
/// with the largest amplitude at any speed.
fn maps(mut section: Section, entry: &Entry, modes: &[Entry], family: &[&RunOutcome]) -> Section {
    let Some(first) = family.first() else {
        return section;
    };
    let mut chosen: Vec<(String, Spectra)> = Vec::new();
    for column in first.results.columns() {
        if column.path.contains('.') || ![force(), acceleration()].contains(&column.dimension) {
            continue;
        }
        let found: Vec<Hertz> = family
            .iter()
            .filter_map(|point| {
                let column = point.results.column(&column.path)?;
                in_hertz(column, &point.results, entry.described.machine.periodic)
            })
            .collect();
        let made = found.first().map(|f| f.made.clone()).unwrap_or_default();
        let runs: Vec<(f64, Spectrum)> = found
            .into_iter()
            .map(|f| (60.0 * f.speed, f.spectrum))
            .collect();
        let largest = runs
            .iter()
            .flat_map(|(_, s)| &s.amplitudes)
            .fold(0.0f64, |most, a| most.max(*a));
        let spectra = Spectra {
            column: column.clone(),
            runs,
            made,
            largest,
        };
        let base = column.path.split('[').next().unwrap_or_default().to_owned();
        match chosen.iter_mut().find(|(name, _)| *name == base) {
            Some((_, other)) if other.largest < largest => *other = spectra,
            Some(_) => {}
            None => chosen.push((base, spectra)),
        }
    }
    for (_, spectra) in chosen {
        // speeds that are equal make no map
        let Ok(map) = sweep_map(&spectra.runs) else {
            continue;
        };
        if map.speeds.len() < SPEEDS {
            continue;
        }
        let limit = map.speeds.last().map(|speed| ORDERS * speed / 60.0);
        let name = first
            .results
            .analysis()
            .split('[')
            .next()
            .unwrap_or_default();
        let title = spectra.column.path.replace('_', " ");
        let figure = SweepFigure {
            title: format!("Waterfall: {title}"),
            subtitle: spectra.made,
            quantity: format!("{title}, 0-peak"),
            unit: readable_unit(&spectra.column.display.symbol),
            frame: spectra.column.frame.clone(),
            limit,
            map,
        };
        let natural = natural(modes, first.results.model());
        let described = &entry.described;
        let orders = main_orders(
            described.machine.cycle_period,
            described.machine.firing.len(),
        );
        let campbell = campbell(&figure, &spectra.column, &title, (orders, &natural));
        section = section.figure(
            Waterfall { figure },
            format!(
                "Waterfall of {title}, sweep {name}: spectra of the last cycle of each point, over its mean speed."
            ),
        );
        if let Some(campbell) = campbell {
            section = section.figure(
                campbell,
                format!(
                    "Campbell diagram of {title}, sweep {name}, with the lines of the main orders."
                ),
            );
        }
    }
    section
}

/// Natural frequencies of a model: of the first sweep of a linear analysis, else of the first linear analysis.
fn natural(modes: &[Entry], model: &str) -> Natural {
    let root = |entry: &Entry| entry.name().split('[').next().map(str::to_owned);
    let own = || modes.iter().filter(|m| m.outcome.results.model() == model);
    let first = own().find(|m| !m.point.is_empty()).or(own().next());
    let name = first.and_then(root);
    Natural::of_results(
        own()
            .filter(|m| root(m) == name)
            .map(|m| &m.outcome.results),
    )
}

/// Levels of a waterfall's amplitudes; the reference is 1 µm/s² or 1 µN (ISO 1683).
fn campbell(
    figure: &SweepFigure,
    column: &Column,
    title: &str,
    (orders, natural): (Vec<f64>, &Natural),
) -> Option<Campbell> {
    let unit = if column.dimension == force() {
        "N"
    } else {
        "m/s²"
    };
    let level = Level::new(1e-6, unit).ok()?;
    let mut figure = SweepFigure {
        title: format!("Campbell diagram: {title}"),
        quantity: format!("{title}, 0-peak"),
        unit: level.label(),
        ..figure.clone()
    };
    for shown in figure.map.amplitudes.iter_mut().flatten() {
        *shown = level.of(*shown * column.display.scale);
    }
    with_floor(&mut figure).then(|| over_speed(figure, orders, natural))
}
