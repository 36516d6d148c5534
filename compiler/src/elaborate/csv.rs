//! Columns of numbers from a CSV file.

use super::{Elaborator, Eval};
use crate::codes;
use eng_grammar::ast::{self, ExprKind};
use eng_grammar::{Diagnostic, Span};
use eng_system::delimited::{Delimited, name_and_unit};
use eng_system::{Dimension, DisplayUnit};

/// Columns of a file.
pub(super) struct Columns {
    /// Path of the file.
    pub path: String,
    /// Numbers (SI) of each column.
    pub numbers: Vec<Vec<f64>>,
    /// Unit of each column.
    pub units: Vec<DisplayUnit>,
    /// The line of each row.
    pub lines: Vec<usize>,
}

impl<'a> Elaborator<'a, '_> {
    /// Columns of a file; `due` gives the dimension of each and the text of its type.
    pub(super) fn read_csv(
        &mut self,
        file: &'a ast::Expr,
        columns: &'a ast::Expr,
        module: u32,
        due: &[(Dimension, String)],
    ) -> Eval<Columns> {
        let ExprKind::Text(name) = &file.kind else {
            return self.not_a_source(file.span);
        };
        let names: Vec<(&str, Span)> = match &columns.kind {
            ExprKind::List { items, .. } => items
                .iter()
                .filter_map(|i| match &i.kind {
                    ExprKind::Text(t) => Some((t.as_str(), i.span)),
                    _ => None,
                })
                .collect(),
            _ => Vec::new(),
        };
        if names.len() != due.len() {
            return self.checked(None, columns.span, "`columns` is no list of as many texts");
        }
        let (path, text) = self.text_of_file(name, file.span, module)?;
        let Some(table) = Delimited::read(&text) else {
            return Err(self.report(
                Diagnostic::error(codes::FILE_CONTENT, format!("{path} is empty"))
                    .at(file.span, "a file begins with the names of its columns"),
            ));
        };
        let header = &table.header;
        let mut wanted_columns: Vec<Wanted<'_>> = Vec::with_capacity(names.len());
        for ((wanted, span), due) in names.iter().zip(due) {
            let index = match header.iter().position(|h| h == wanted) {
                Some(i) => i,
                None => {
                    return Err(self.report(
                        Diagnostic::error(
                            codes::FILE_CONTENT,
                            format!("{path} has no column {wanted:?}"),
                        )
                        .at(*span, "not in its first row")
                        .with_note(format!("its first row is: {}", header.join(" | "))),
                    ));
                }
            };
            if header.iter().filter(|h| *h == wanted).count() > 1 {
                return Err(self.report(
                    Diagnostic::error(
                        codes::FILE_CONTENT,
                        format!("{path} has several columns {wanted:?}"),
                    )
                    .at(*span, "its first row names it more than once")
                    .with_note(format!("its first row is: {}", header.join(" | ")))
                    .with_help("give each column of the file a name of its own"),
                ));
            }
            let unit = self.column_unit(wanted, *span, due)?;
            wanted_columns.push(Wanted {
                name: wanted,
                unit,
                index,
            });
        }
        let (numbers, lines) = self.rows_of_csv(&path, &table, &wanted_columns, file.span)?;
        let units = wanted_columns
            .into_iter()
            .map(|column| column.unit)
            .collect();
        Ok(Columns {
            path,
            numbers,
            units,
            lines,
        })
    }

    /// Path and text of a file that a text names. The library's files are part of the program; names of other
    /// files are relative to the module's folder.
    fn text_of_file(&mut self, name: &str, place: Span, module: u32) -> Eval<(String, String)> {
        let module_path = &self.program.modules[module as usize].path;
        if module_path.starts_with("std.") {
            let file = crate::library::FILES
                .iter()
                .find(|(known, _)| *known == name);
            let (path, text) = self.checked(file, place, "the library has no such file")?;
            return Ok(((*path).to_owned(), (*text).to_owned()));
        }
        let path = match module_path.rsplit_once('.') {
            Some((folder, _)) => format!("{}/{name}", folder.replace('.', "/")),
            None => name.to_owned(),
        };
        match self.host.read_text(&path) {
            Ok(text) => Ok((path, text)),
            Err(error) => Err(self.report(
                Diagnostic::error(codes::FILE, format!("the file {path} cannot be read"))
                    .at(place, error.to_string())
                    .with_help(
                        "check the name; the file must be in the folder of the model or below it",
                    ),
            )),
        }
    }

    /// The numbers (SI) of the wanted columns, and the line of each row.
    fn rows_of_csv(
        &mut self,
        path: &str,
        table: &Delimited<'_>,
        wanted: &[Wanted<'_>],
        file: Span,
    ) -> Eval<(Vec<Vec<f64>>, Vec<usize>)> {
        let mut columns: Vec<Vec<f64>> = vec![Vec::new(); wanted.len()];
        for row in &table.rows {
            let number = row.line;
            if row.cells.len() > table.header.len() {
                let message = Diagnostic::error(
                    codes::FILE_CONTENT,
                    format!(
                        "{path}:{number} has {} cells, but the first row names {}",
                        row.cells.len(),
                        table.header.len()
                    ),
                )
                .at(file, format!("the line is {:?}", shortened(row.text)));
                return Err(self.report(if table.separator == ',' {
                    message.with_help(
                        "with commas between the cells numbers have a decimal point; with decimal commas, separate the cells by `;` or tabs",
                    )
                } else {
                    message.with_help("name each column in the first row")
                }));
            }
            for (Wanted { name, unit, index }, column) in wanted.iter().zip(&mut columns) {
                let cell = row.cells.get(*index).copied().unwrap_or_default();
                match table.number(cell) {
                    Some(v) if v.is_finite() => column.push(unit.to_si(v)),
                    _ => {
                        return Err(self.report(
                            Diagnostic::error(
                                codes::FILE_CONTENT,
                                format!("{path}:{number} does not hold a number"),
                            )
                            .at(
                                file,
                                if cell.is_empty() {
                                    format!("it is empty in the column {:?}", name)
                                } else {
                                    format!("its column {:?} holds {cell:?}", name)
                                },
                            ),
                        ));
                    }
                }
            }
        }
        Ok((columns, table.rows.iter().map(|row| row.line).collect()))
    }

    /// The unit of `theta [deg]`.
    fn column_unit(
        &mut self,
        header: &str,
        span: Span,
        (expected, type_text): &(Dimension, String),
    ) -> Eval<DisplayUnit> {
        let unit = name_and_unit(header).map_or("1", |(_, unit)| unit);
        if unit == "1" || unit.is_empty() {
            if !expected.without_angle().is_one() {
                return Err(self.report(
                    Diagnostic::error(
                        codes::COLUMN_UNIT,
                        format!("the column states no unit, but {type_text} has one"),
                    )
                    .at(span, "no unit in brackets")
                    .with_help("name the unit in the first row of the file and here: `p [bar]`"),
                ));
            }
            return Ok(DisplayUnit::si(Dimension::ONE));
        }
        let mut scratch = eng_grammar::Diagnostics::new();
        let source = self
            .sources
            .add(format!("unit of {header}"), format!("1 {unit}"));
        let parsed = eng_grammar::parse_expression(&format!("1 {unit}"), source, 0, &mut scratch);
        let Some(ast::Expr {
            kind:
                ExprKind::Number {
                    unit: Some(unit_expr),
                    ..
                },
            ..
        }) = parsed
        else {
            return Err(self.report(
                Diagnostic::error(codes::COLUMN_UNIT, format!("{unit:?} is not a unit"))
                    .at(span, "between the brackets of this column's name"),
            ));
        };
        let unit = match self.program.unit(&unit_expr) {
            Ok(u) => u,
            Err((_, name)) => {
                return Err(self.report(
                    Diagnostic::error(codes::COLUMN_UNIT, format!("there is no unit `{name}`"))
                        .at(span, "between the brackets of this column's name"),
                ));
            }
        };
        if unit.dimension.without_angle() != expected.without_angle() {
            return Err(self.report(
                Diagnostic::error(
                    codes::COLUMN_UNIT,
                    format!("a column in {} does not give {type_text}", unit.symbol),
                )
                .at(span, "the unit of this column does not fit"),
            ));
        }
        let declared = self.program.dimensions.get(type_text);
        if unit.offset != 0.0 && declared.is_none_or(|named| named.point_of.is_none()) {
            let point = unit.point.unwrap_or_default();
            return Err(self.report(
                Diagnostic::error(
                    codes::COLUMN_UNIT,
                    format!("a column in {} does not give {type_text}", unit.symbol),
                )
                .at(span, format!("of the points {point}, counted from a zero of their own"))
                .with_help(format!(
                    "if the numbers are differences, name a unit without its own zero in the file and here; otherwise declare {point}"
                )),
            ));
        }
        Ok(DisplayUnit::from(unit))
    }
}

/// A column to read: its name, its unit, its position in the rows.
struct Wanted<'r> {
    name: &'r str,
    unit: DisplayUnit,
    index: usize,
}

/// A line of a file, shortened for a message.
fn shortened(line: &str) -> String {
    // a choice: a message has room for it
    const SHOWN_CHARACTERS: usize = 40;
    let line = line.trim();
    match line.char_indices().nth(SHOWN_CHARACTERS) {
        Some((end, _)) => format!("{}…", &line[..end]),
        None => line.to_owned(),
    }
}
