//! Tables of a report: analyses, inputs, modes, summaries by interface, energy.

use super::Entry;
use super::describe::{InputValue, differ};
use crate::Reduction;
use crate::machine::{Machine, SummarisedElement};
use crate::post::capital;
use crate::results::{CYCLE_SPEED, Results, TIME};
use crate::tables::{Summarised, SummaryTable, in_words, readable};
use eng_report::figure::journal_letter;
use eng_report::page::{Cell, Column, EnergyAudit, Mode, Table, modes_table};
use eng_report::readable_unit;

fn code(text: &str) -> Cell {
    Cell::Code(text.to_owned())
}

/// The values of a state.
pub(super) fn state(entry: &Entry) -> Table {
    let columns = crate::tables::state::columns(&entry.outcome.results);
    Table {
        caption: format!("State of {}", entry.name()),
        columns: vec![
            Column::new("Channel"),
            Column::new("Value"),
            Column::new("Unit"),
        ],
        rows: columns
            .into_iter()
            .map(|column| {
                let value = column.shown().first().copied().unwrap_or(f64::NAN);
                let unit = column.display.symbol.as_str();
                vec![code(&column.path), Cell::number(value), unit.into()]
            })
            .collect(),
    }
}

/// Name, samples, time and speed of each analysis, and the condition that ended it.
pub(super) fn analyses(entries: &[Entry]) -> Table {
    let stopped = |entry: &Entry| entry.outcome.results.stopped().map(str::to_owned);
    let mut table = Table {
        caption: "Analyses".to_owned(),
        columns: vec![
            Column::new("Analysis"),
            Column::new("Point of a sweep"),
            Column::new("Samples"),
            Column::with_unit("End", "ms"),
            Column::with_unit("Mean speed", "rpm"),
            Column::new("Start"),
            Column::new("Cycles"),
        ],
        rows: entries
            .iter()
            .map(|entry| {
                let results = &entry.outcome.results;
                let end = results.column(TIME).and_then(|c| c.values.last());
                let speed = results.column(CYCLE_SPEED).map(|c| {
                    let shown = c.shown();
                    shown.iter().sum::<f64>() / shown.len().max(1) as f64
                });
                let point: Vec<String> = entry
                    .point
                    .iter()
                    .map(|(name, value)| format!("{name} = {value}"))
                    .collect();
                vec![
                    code(entry.name()),
                    point.join(", ").into(),
                    results.samples().to_string().into(),
                    end.map_or(Cell::Empty, |t| Cell::number(1e3 * t)),
                    speed.map_or(Cell::Empty, |value| Cell::Number { value, digits: 6 }),
                    results.metadata().get("start").map_or(Cell::Empty, |text| {
                        text.strip_prefix("start: ").unwrap_or(text).into()
                    }),
                    entry
                        .outcome
                        .periodic
                        .map_or(Cell::Empty, |(cycles, repeats)| {
                            match repeats {
                                true => format!("repeats after {cycles}"),
                                false => format!("does not repeat after {cycles}"),
                            }
                            .into()
                        }),
                ]
            })
            .collect(),
    };
    // most analyses have no condition that ends them
    if entries.iter().any(|entry| stopped(entry).is_some()) {
        table.columns.push(Column::new("Ended by"));
        for (row, entry) in table.rows.iter_mut().zip(entries) {
            row.push(stopped(entry).map_or(Cell::Empty, Cell::from));
        }
    }
    table
}

/// The inputs of a model: unit, limits, default, and one value for each analysis if any value differs from
/// the default.
pub(super) fn inputs(model: &str, entries: &[&Entry]) -> Table {
    let mut columns = vec![
        Column::new("Input"),
        Column::new("Unit"),
        Column::new("Limits"),
        Column::new("Default"),
        Column::new("Stated at"),
    ];
    columns.extend(entries.iter().map(|e| Column::new(e.name())));
    let first = entries.first().map_or(&[][..], |e| &e.described.inputs);
    let shown = |input: &InputValue, value: f64| {
        let value = input.display.from_si(value);
        if value.is_finite() {
            Cell::Short { value, digits: 6 }
        } else {
            Cell::Empty
        }
    };
    Table {
        caption: format!(
            "Inputs of {model}; a value where the analysis or the command line sets another than the default"
        ),
        columns,
        rows: first
            .iter()
            .map(|input| {
                let (low, high) = input.limits;
                let limit = |x: f64| match x.is_finite() {
                    true => format!("{}", input.display.from_si(x)),
                    false => "…".to_owned(),
                };
                let limits = if low.is_finite() || high.is_finite() {
                    format!("({}, {})", limit(low), limit(high))
                } else {
                    String::new()
                };
                let mut row = vec![
                    code(&input.path),
                    readable_unit(&input.display.symbol).into(),
                    limits.into(),
                    shown(input, input.default),
                    match input.of_library {
                        true => format!("library, {}", input.stated_at),
                        false => input.stated_at.clone(),
                    }
                    .into(),
                ];
                row.extend(entries.iter().map(|entry| {
                    let own = entry.described.inputs.iter().find(|i| i.path == input.path);
                    match own {
                        Some(own) if differ(own.value, own.default) => shown(own, own.value),
                        _ => Cell::Empty,
                    }
                }));
                row
            })
            .collect(),
    }
}

/// The results of a reduction.
pub(super) fn body_facts(reduction: &Reduction) -> Vec<(&'static str, Cell)> {
    let report = &reduction.stored.report;
    // a micrometre is shown, and no zero with a sign
    let [x, y, z] = report
        .body
        .centre
        .map(|x| libm::round(1e6 * x) * 1e-3 + 0.0);
    let inertia = report.body.inertia;
    vec![
        ("Nodes", report.nodes.to_string().into()),
        ("Elements", report.elements.to_string().into()),
        ("Freedoms", report.freedoms.to_string().into()),
        ("Modes", reduction.body.invariants.modes.to_string().into()),
        (
            "Frame",
            if report.supported {
                "held at its supports"
            } else {
                "mean axes of the free body"
            }
            .into(),
        ),
        ("Mass", format!("{:.6} kg", reduction.mass()).into()),
        (
            "Centre of mass",
            format!("({x:.3}, {y:.3}, {z:.3}) mm").into(),
        ),
        (
            "Inertia about it",
            format!(
                "xx {:.6}, yy {:.6}, zz {:.6} kg m²",
                inertia[0][0], inertia[1][1], inertia[2][2]
            )
            .into(),
        ),
    ]
}

/// The modes of a flexible body.
pub(super) fn modes(reduction: &Reduction) -> Table {
    let constants = &reduction.body.invariants;
    let n = constants.modes;
    let report = &reduction.stored.report;
    let modes: Vec<Mode> = report
        .modes
        .iter()
        .take(n)
        .enumerate()
        .map(|(i, mode)| {
            let omega = std::f64::consts::TAU * mode.frequency;
            let at = |block: &[f64]| block.get(i * n + i).copied();
            let mass = at(&constants.modal_mass);
            let damping = at(&constants.damping).zip(mass);
            let words: Vec<&str> = mode.description.split_whitespace().collect();
            let kind = ["static", "normal"].map(|kind| words.contains(&kind));
            Mode {
                number: i + 1,
                kind: match kind {
                    [true, true] => "static and normal",
                    [true, false] => "static",
                    [false, true] => "normal",
                    [false, false] => "",
                }
                .to_owned(),
                frequency: Some(mode.frequency),
                damping: damping
                    .filter(|(_, mass)| omega > 0.0 && *mass > 0.0)
                    .map(|(damping, mass)| damping / (2.0 * omega * mass)),
                mass,
                about: mode.description.clone(),
            }
        })
        .collect();
    modes_table(
        &format!(
            "Modes of {}; modal masses in kg for shapes in m",
            reduction.path()
        ),
        &modes,
    )
}

/// The summaries of an analysis, a table for each interface. Films have the letters of their curves.
pub(super) fn summaries(entry: &Entry) -> Vec<Table> {
    let machine = &entry.described.machine;
    let tables = machine.summaries.iter();
    tables
        .map(|summary| {
            let results = &entry.outcome.results;
            let table = SummaryTable::new(results, summary, machine.cycle_period);
            of_interface(&table, machine, entry.name())
        })
        .collect()
}

fn of_interface(table: &SummaryTable<'_>, machine: &Machine, analysis: &str) -> Table {
    let summary = table.of;
    let letter = |path: &str| {
        let place = machine.journals.iter().position(|j| j.path == path);
        place.map(journal_letter)
    };
    let words = capital(&in_words(&summary.interface));
    let has_letters = summary.elements.iter().any(|e| letter(&e.path).is_some());
    let mut columns = Vec::new();
    if has_letters {
        columns.push(Column::new("Curve"));
    }
    columns.push(Column::new(&words));
    for parameter in &summary.parameters {
        let unit = readable_unit(&parameter.display.symbol);
        columns.push(Column::with_unit(
            &capital(&readable(&parameter.name)),
            &unit,
        ));
    }
    for (index, (column, unit)) in summary.columns.iter().zip(&table.units).enumerate() {
        let heading = format!(
            "{} {}",
            capital(column.statistic.word()),
            readable(&column.output)
        );
        let unit = readable_unit(&unit.symbol);
        columns.push(Column::with_unit(&heading, &unit).about(&column.about));
        if table.shows_angles(index) {
            columns.push(Column::with_unit("at", "°CA"));
        }
    }
    let row = |(element, cells): (&SummarisedElement, &Vec<Option<Summarised>>)| {
        let mut row = Vec::new();
        if has_letters {
            row.push(letter(&element.path).map_or(Cell::Empty, Cell::Text));
        }
        row.push(code(&element.path));
        for (parameter, value) in summary.parameters.iter().zip(&element.parameters) {
            row.push(Cell::Short {
                value: parameter.display.from_si(*value),
                digits: 6,
            });
        }
        for (index, (cell, unit)) in cells.iter().zip(&table.units).enumerate() {
            row.push(cell.map_or(Cell::Empty, |cell| Cell::number(unit.from_si(cell.value))));
            if table.shows_angles(index) {
                let angle = cell.and_then(|cell| cell.angle);
                row.push(angle.map_or(Cell::Empty, |angle| Cell::Fixed {
                    value: angle.to_degrees(),
                    decimals: 1,
                }));
            }
        }
        row
    };
    Table {
        caption: format!("{words} {}, {analysis}", table.span()),
        columns,
        rows: summary.elements.iter().zip(&table.rows).map(row).collect(),
    }
}

/// The flow of energy between the first and the last sample; `None` if it was not recorded.
pub(super) fn energy(results: &Results) -> Option<EnergyAudit> {
    let gained = |name: &str| {
        let values = &results.column(&format!("energy.{name}"))?.values;
        Some(values.last()? - values.first()?)
    };
    let stored = gained("kinetic")? + gained("gravity")? + gained("strain").unwrap_or(0.0);
    Some(EnergyAudit {
        work: vec![
            (
                "forces: gas, films, springs, dampers".to_owned(),
                gained("work_of_loads")?,
            ),
            ("drives".to_owned(), gained("work_of_drives")?),
        ],
        // rigid bodies lose nothing
        losses: gained("damping")
            .filter(|lost| *lost != 0.0)
            .map(|lost| ("damping of flexible bodies".to_owned(), lost))
            .into_iter()
            .collect(),
        stored,
    })
}
