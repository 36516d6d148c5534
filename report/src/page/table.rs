//! Tables.

use crate::escape::escaped;
use std::fmt::Write;

/// The contents of a cell.
#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    /// A text.
    Text(String),
    /// A number with a stated number of significant digits.
    Number {
        /// Its value; a value that is not finite is shown as a dash.
        value: f64,
        /// Number of significant digits, 1 to 17.
        digits: usize,
    },
    /// A number with at most these significant digits, without trailing zeros, for numbers from a text.
    Short {
        /// Its value; a value that is not finite is shown as a dash.
        value: f64,
        /// Number of significant digits, 1 to 17.
        digits: usize,
    },
    /// A number with a stated number of decimals, for columns whose sum matters.
    Fixed {
        /// Its value; a value that is not finite is shown as a dash.
        value: f64,
        /// Digits after the point, at most 17.
        decimals: usize,
    },
    /// Text of a program: paths, hashes, commands.
    Code(String),
    /// No value.
    Empty,
}

impl Cell {
    /// A number with four significant digits.
    pub fn number(value: f64) -> Cell {
        Cell::Number { value, digits: 4 }
    }
}

impl From<&str> for Cell {
    fn from(text: &str) -> Cell {
        Cell::Text(text.to_owned())
    }
}

impl From<String> for Cell {
    fn from(text: String) -> Cell {
        Cell::Text(text)
    }
}

impl From<f64> for Cell {
    fn from(value: f64) -> Cell {
        Cell::number(value)
    }
}

/// Heading of a column.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// The text of the heading.
    pub heading: String,
    /// Its unit; empty for none.
    pub unit: String,
    /// An explanation of the column that appears when a reader points at the heading; may be empty.
    pub about: String,
}

impl Column {
    /// A column without a unit.
    pub fn new(heading: &str) -> Column {
        Column::with_unit(heading, "")
    }

    /// A column with a unit.
    pub fn with_unit(heading: &str, unit: &str) -> Column {
        Column {
            heading: heading.to_owned(),
            unit: unit.to_owned(),
            about: String::new(),
        }
    }

    /// The column with an explanation.
    pub fn about(self, about: &str) -> Column {
        Column {
            about: about.to_owned(),
            ..self
        }
    }
}

/// A table. The first cell of a row is its heading.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// The caption.
    pub caption: String,
    /// Headings.
    pub columns: Vec<Column>,
    /// Rows of as many cells; missing ones are empty, more are left out.
    pub rows: Vec<Vec<Cell>>,
}

/// Largest number of rows of a table that is kept on one sheet of paper. A choice: about a third of a sheet.
const SHORT: usize = 14;

impl Table {
    /// The markup; long tables scroll within themselves.
    pub(super) fn to_html(&self) -> String {
        let mut text = String::new();
        // writing to a String cannot fail
        let _ = write!(
            text,
            "<div class=\"table{short}\" tabindex=\"0\" role=\"region\" aria-label=\"{caption}\">\n<table>\n<caption>{caption}</caption>\n<thead><tr>",
            short = if self.rows.len() <= SHORT {
                " short"
            } else {
                ""
            },
            caption = escaped(&self.caption)
        );
        let numeric: Vec<bool> = (0..self.columns.len())
            .map(|column| {
                let mut cells = self.rows.iter().filter_map(|row| row.get(column));
                // a column of dashes is aligned as columns of numbers are
                cells.clone().any(Cell::is_number) || cells.all(|cell| *cell == Cell::Empty)
            })
            .collect();
        for (column, numeric) in self.columns.iter().zip(&numeric) {
            let class = if *numeric { " class=\"number\"" } else { "" };
            let title = match column.about.as_str() {
                "" => String::new(),
                about => format!(" title=\"{}\"", escaped(about)),
            };
            let _ = write!(
                text,
                "<th scope=\"col\"{class}{title}>{}",
                escaped(&column.heading)
            );
            if !column.unit.is_empty() {
                let _ = write!(
                    text,
                    " <span class=\"unit\">({})</span>",
                    escaped(&column.unit)
                );
            }
            text.push_str("</th>");
        }
        text.push_str("</tr></thead>\n<tbody>\n");
        for row in &self.rows {
            text.push_str("<tr>");
            for (index, numeric) in numeric.iter().enumerate() {
                let cell = row.get(index).unwrap_or(&Cell::Empty);
                let (open, close) = if index == 0 {
                    ("th scope=\"row\"", "th")
                } else {
                    ("td", "td")
                };
                let right = cell.is_number() || (*numeric && *cell == Cell::Empty);
                let class = if right { " class=\"number\"" } else { "" };
                let _ = write!(text, "<{open}{class}>{}</{close}>", cell.to_html());
            }
            text.push_str("</tr>\n");
        }
        text.push_str("</tbody>\n</table>\n</div>\n");
        text
    }
}

impl Cell {
    fn is_number(&self) -> bool {
        matches!(
            self,
            Cell::Number { .. } | Cell::Short { .. } | Cell::Fixed { .. }
        )
    }

    pub(super) fn to_html(&self) -> String {
        match self {
            Cell::Text(text) => escaped(text),
            Cell::Number { value, digits } => significant(*value, *digits),
            Cell::Short { value, digits } => shortened(&significant(*value, *digits)),
            Cell::Fixed { value, .. } if !value.is_finite() => "–".to_owned(),
            Cell::Fixed { value, decimals } => {
                let text = format!("{value:.*}", (*decimals).min(17));
                // a zero has no sign
                let zero = text.bytes().all(|b| matches!(b, b'-' | b'0' | b'.'));
                minus(if zero {
                    text.trim_start_matches('-')
                } else {
                    &text
                })
            }
            Cell::Code(text) => format!("<code>{}</code>", escaped(text)),
            Cell::Empty => "–".to_owned(),
        }
    }
}

/// A number with a stated number of significant digits and a true minus sign: plain from 10⁻³ to 10⁶,
/// otherwise with a power of ten.
pub fn significant(value: f64, digits: usize) -> String {
    if !value.is_finite() {
        return "–".to_owned();
    }
    let digits = digits.clamp(1, 17);
    // rounding first: 9.9996 with four digits is 10.00
    let text = format!("{value:.*e}", digits - 1);
    let Some((mantissa, exponent)) = text.split_once('e') else {
        return text;
    };
    let exponent: i32 = exponent.parse().unwrap_or(0);
    let plain = if value == 0.0 {
        "0".to_owned()
    } else if (-3..6).contains(&exponent) {
        let decimals = (digits as i32 - 1 - exponent).max(0) as usize;
        format!("{value:.decimals$}")
    } else {
        format!("{mantissa}·10<sup>{}</sup>", minus(&exponent.to_string()))
    };
    minus(&plain)
}

/// Without the zeros at the end of the decimals.
pub fn shortened(text: &str) -> String {
    let (number, power) = match text.split_once('·') {
        Some((number, power)) => (number, format!("·{power}")),
        None => (text, String::new()),
    };
    let number = match number.contains('.') {
        true => number.trim_end_matches('0').trim_end_matches('.'),
        false => number,
    };
    format!("{number}{power}")
}

fn minus(text: &str) -> String {
    match text.strip_prefix('-') {
        Some(rest) => format!("−{rest}"),
        None => text.to_owned(),
    }
}
