//! Tables of the elements whose classes fill one interface: a number of each output for which the interface
//! states a summary.

use super::Table;
use crate::cycle::{SLACK, cycle_angle, last_cycle};
use crate::machine::{InterfaceSummary, SummarisedElement};
use crate::results::{CYCLE_ANGLE, Results, TIME};
use eng_system::DisplayUnit;
use eng_system::significant::significant;
use eng_system::system::summary::{Statistic, SummaryColumn};

/// A number of a summary.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Summarised {
    /// Its value (SI).
    pub value: f64,
    /// For an extreme of a machine with a cycle: the crank angle (rad, within the cycle).
    pub angle: Option<f64>,
}

/// The numbers of the elements of one interface. They cover the last cycle if the run has a whole cycle,
/// otherwise the whole run.
#[derive(Clone, Debug, PartialEq)]
pub struct SummaryTable<'m> {
    /// The interface with its columns and elements.
    pub of: &'m InterfaceSummary,
    /// A row for each element, a cell for each column; `None` for a column that is absent or has no number.
    pub rows: Vec<Vec<Option<Summarised>>>,
    /// The unit of each column, which the first element decides.
    pub units: Vec<DisplayUnit>,
    /// Whether the values cover the last whole cycle.
    pub last_cycle: bool,
}

impl<'m> SummaryTable<'m> {
    /// The table of the results of a run. `cycle_period` in rad.
    pub fn new(results: &Results, of: &'m InterfaceSummary, cycle_period: Option<f64>) -> Self {
        let angle = results.column(CYCLE_ANGLE).map(|c| c.values.as_slice());
        let whole = last_cycle(angle, cycle_period);
        let first = whole.unwrap_or(0);
        let time = results.column(TIME).map(|c| c.values.as_slice());
        let number = |column: &SummaryColumn, channel: Option<&String>| {
            let values = results.column(channel?)?.values.as_slice();
            let found = match column.statistic {
                Statistic::Least => extreme(values, first, |a, b| a < b),
                Statistic::Largest => extreme(values, first, |a, b| a > b),
                Statistic::Mean => {
                    let value = mean(time?.get(first..)?, values.get(first..)?);
                    return value
                        .is_finite()
                        .then_some(Summarised { value, angle: None });
                }
            };
            let (index, value) = found?;
            Some(Summarised {
                value,
                angle: angle
                    .and_then(|angle| angle.get(index))
                    .map(|angle| cycle_angle(*angle, cycle_period)),
            })
        };
        let row = |element: &SummarisedElement| {
            let channels = element.channels.iter();
            let cells = of.columns.iter().zip(channels);
            cells
                .map(|(column, channel)| number(column, channel.as_ref()))
                .collect()
        };
        let unit = |index: usize| {
            let channels = of.elements.iter().filter_map(|e| e.channels.get(index));
            let mut columns = channels.flatten().filter_map(|path| results.column(path));
            let first = columns.next();
            first.map_or_else(
                || DisplayUnit::si(eng_system::Dimension::ONE),
                |column| column.display.clone(),
            )
        };
        SummaryTable {
            of,
            rows: of.elements.iter().map(row).collect(),
            units: (0..of.columns.len()).map(unit).collect(),
            last_cycle: whole.is_some(),
        }
    }

    /// Whether a column shows the angles of its extremes. It does not if the column before it has the same angles.
    pub fn shows_angles(&self, column: usize) -> bool {
        let angles = |column: usize| -> Vec<Option<f64>> {
            let cells = self
                .rows
                .iter()
                .map(|row| row.get(column).copied().flatten());
            cells.map(|cell| cell.and_then(|cell| cell.angle)).collect()
        };
        let is_extreme = |column: &usize| {
            let column = self.of.columns.get(*column);
            column.is_some_and(|column| column.statistic != Statistic::Mean)
        };
        let own = angles(column);
        let before = (0..column).rev().find(is_extreme).map(angles);
        let before = before.unwrap_or_else(|| vec![None; own.len()]);
        let differ = |own: f64, before: Option<f64>| {
            before.is_none_or(|before| (own - before).abs() > SLACK)
        };
        let mut both = own.iter().zip(&before);
        both.any(|(own, before)| own.is_some_and(|own| differ(own, *before)))
    }

    /// The part of the run that the values cover.
    pub fn span(&self) -> &'static str {
        match self.last_cycle {
            true => "over the last cycle",
            false => "over the samples of the whole run",
        }
    }

    /// The table as text.
    pub(crate) fn text(&self) -> String {
        let mut heads = [
            vec![in_words(&self.of.interface)],
            vec![String::new()],
            vec![String::new()],
        ];
        let mut cells: Vec<Vec<String>> = (self.of.elements.iter())
            .map(|element| vec![element.path.clone()])
            .collect();
        for (index, (column, unit)) in self.of.columns.iter().zip(&self.units).enumerate() {
            let own = || {
                self.rows
                    .iter()
                    .map(|row| row.get(index).copied().flatten())
            };
            let shown = own().map(|cell| cell.map(|cell| unit.from_si(cell.value)));
            let mut texts = vec![alike(&shown.collect::<Vec<_>>())];
            let unit = eng_report::readable_unit(&unit.symbol);
            heads[0].push(readable(&column.output));
            heads[1].push(column.statistic.word().to_owned());
            heads[2].push(unit);
            if self.shows_angles(index) {
                heads[0].push("at".to_owned());
                heads[1].push(String::new());
                heads[2].push("°CA".to_owned());
                let angle = |cell: Summarised| Some(format!("{:.1}", cell.angle?.to_degrees()));
                let angles = own().map(|cell| cell.and_then(angle));
                texts.push(angles.map(|text| text.unwrap_or_else(dash)).collect());
            }
            for texts in texts {
                for (cells, text) in cells.iter_mut().zip(texts) {
                    cells.push(text);
                }
            }
        }
        let heads = heads
            .each_ref()
            .map(|row| row.iter().map(String::as_str).collect());
        let heads: [Vec<&str>; 3] = heads;
        let mut table = Table::new(&heads.each_ref().map(Vec::as_slice));
        for row in cells {
            table.row(row);
        }
        format!("{}  {}\n", table.render(), self.span())
    }
}

fn dash() -> String {
    "–".to_owned()
}

/// `radial load` of `radial_load`.
pub(crate) fn readable(name: &str) -> String {
    name.replace('_', " ")
}

/// `journal law` of `JournalLaw`.
pub fn in_words(name: &str) -> String {
    let mut words = String::new();
    let mut before = None;
    for letter in name.chars() {
        // a row of capitals is one word
        let begins = letter.is_uppercase() && before.is_some_and(|b: char| !b.is_uppercase());
        if letter == '_' || begins {
            words.push(' ');
        }
        if letter != '_' {
            words.extend(letter.to_lowercase());
        }
        before = Some(letter);
    }
    words
}

/// Numbers of one column with the same decimals: the largest has four significant digits.
pub fn alike(values: &[Option<f64>]) -> Vec<String> {
    let sizes = values.iter().flatten().map(|value| value.abs());
    let largest = sizes.filter(|size| size.is_finite()).fold(0.0, f64::max);
    // 1e-30 is a clear zero in any unit that a table shows
    let exponent = libm::floor(libm::log10(largest.max(1e-30)));
    let shown = |value: f64| match exponent {
        _ if largest == 0.0 => "0".to_owned(),
        exponent if (-3.0..=8.0).contains(&exponent) => {
            // between 0 and 6
            let decimals = (3.0 - exponent).max(0.0) as usize;
            format!("{value:.decimals$}")
        }
        _ => significant(value, 4),
    };
    let cells = values.iter();
    cells.map(|value| value.map_or_else(dash, shown)).collect()
}

/// Index and value of the best finite value from `first` on, by `better`.
fn extreme(
    values: &[f64],
    first: usize,
    better: impl Fn(f64, f64) -> bool,
) -> Option<(usize, f64)> {
    values
        .iter()
        .copied()
        .enumerate()
        .skip(first)
        .filter(|(_, value)| value.is_finite())
        .reduce(|best, next| if better(next.1, best.1) { next } else { best })
}

/// Mean over time (s) by the trapezoidal rule; the value itself for a single sample, NaN for none.
pub(crate) fn mean(time: &[f64], values: &[f64]) -> f64 {
    let pairs = || {
        time.iter()
            .zip(time.iter().skip(1))
            .zip(values.iter().zip(values.iter().skip(1)))
    };
    let duration: f64 = pairs().map(|((from, to), _)| to - from).sum();
    if duration <= 0.0 {
        return values.first().copied().unwrap_or(f64::NAN);
    }
    let area: f64 = pairs()
        .map(|((from, to), (a, b))| 0.5 * (a + b) * (to - from))
        .sum();
    area / duration
}
