//! Texts of numbers in columns, such as CSV files.

/// Columns of a text. Its first line has their names. Empty lines and lines that begin with `#` are left out.
/// The cells are separated by `;`, tabs or commas. Empty cells at the end of a line are no cells.
#[derive(Clone, Debug, PartialEq)]
pub struct Delimited<'t> {
    /// The sign between the cells.
    pub separator: char,
    /// The names of the columns, each with its unit.
    pub header: Vec<&'t str>,
    /// The lines after the first.
    pub rows: Vec<Row<'t>>,
}

/// One line of numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Row<'t> {
    /// The number of the line in the text, from 1.
    pub line: usize,
    /// The line.
    pub text: &'t str,
    /// Its cells, without quotes.
    pub cells: Vec<&'t str>,
}

impl<'t> Delimited<'t> {
    /// Reads a text; `None` if it is empty.
    pub fn read(text: &'t str) -> Option<Delimited<'t>> {
        let text = text.trim_start_matches('\u{feff}');
        let mut lines = text
            .lines()
            .enumerate()
            .filter(|(_, line)| !line.trim().is_empty() && !line.trim_start().starts_with('#'));
        let (_, header) = lines.next()?;
        let separator = [';', '\t'].into_iter().find(|sign| header.contains(*sign));
        let separator = separator.unwrap_or(',');
        Some(Delimited {
            separator,
            header: cells(header, separator),
            rows: lines
                .map(|(index, text)| Row {
                    line: index + 1,
                    text,
                    cells: cells(text, separator),
                })
                .collect(),
        })
    }

    /// The number of a cell; `None` if it is none. A comma is a decimal sign if it does not separate cells.
    pub fn number(&self, cell: &str) -> Option<f64> {
        match self.separator != ',' && cell.contains(',') {
            true => cell.replace(',', ".").parse().ok(),
            false => cell.parse().ok(),
        }
    }
}

fn cells(line: &str, separator: char) -> Vec<&str> {
    let cells = line.split(separator);
    let mut cells: Vec<&str> = cells
        .map(|cell| cell.trim().trim_matches('"').trim())
        .collect();
    while cells.last().is_some_and(|cell| cell.is_empty()) {
        cells.pop();
    }
    cells
}

/// Name and unit of a column, such as `theta` and `deg` of `theta [deg]`; `None` without a unit. A whole number in
/// brackets without a blank before them is an index: `main[5]`.
pub fn name_and_unit(header: &str) -> Option<(&str, &str)> {
    let (name, rest) = header.rsplit_once('[')?;
    let (unit, _) = rest.split_once(']')?;
    let unit = unit.trim();
    let is_number = !unit.is_empty() && unit.bytes().all(|sign| sign.is_ascii_digit());
    let is_index = is_number && !name.ends_with(char::is_whitespace);
    (!is_index).then_some((name.trim(), unit))
}
